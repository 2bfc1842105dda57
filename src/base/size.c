/* Units are powers of 1024, with "B" and with "iB": one letter has one meaning. */
#include "base/size.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

const char *size_words(uint64_t bytes, char out[SIZE_WORDS]) {
    static const char *const units[] = {"bytes", "KiB", "MiB", "GiB", "TiB"};
    int unit = 2;
    while (unit > 0 && bytes % (UINT64_C(1) << 10 * unit) != 0)
        unit--;
    while (unit >= 2 && unit < 4 && bytes >> 10 * unit > 9999 && bytes % (UINT64_C(1) << 10 * (unit + 1)) == 0)
        unit++;
    (void)snprintf(out, SIZE_WORDS, "%llu %s", (unsigned long long)(bytes >> 10 * unit), units[unit]);
    return out;
}

/* The power of 1024 of a unit; -1 for what is none. */
static int unit_power(const char *text) {
    static const char letters[] = "kmgt";
    if (text[0] == '\0')
        return 2;
    const char *letter = strchr(letters, text[0] | ' ');
    bool known = letter && (text[1] == '\0' || strcasecmp(text + 1, "b") == 0 || strcasecmp(text + 1, "ib") == 0);
    return known ? (int)(letter - letters) + 1 : -1;
}

bool size_parse(const char *text, uint64_t *bytes) {
    size_t digits = strspn(text, "0123456789");
    const char *unit = text + digits + (digits > 0 && text[digits] == ' ');
    int power = unit == text + digits + 1 && *unit == '\0' ? -1 : unit_power(unit);
    uint64_t number = 0;
    if (digits == 0 || power < 0)
        return false;
    for (size_t i = 0; i < digits; i++) {
        if (__builtin_mul_overflow(number, UINT64_C(10), &number) ||
            __builtin_add_overflow(number, (uint64_t)(text[i] - '0'), &number))
            return false;
    }
    return !__builtin_mul_overflow(number, UINT64_C(1) << 10 * power, bytes);
}
