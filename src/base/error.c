/* Filling of struct error. Text that does not fit ends in "...", never in half a UTF-8 character. It is always one
 * line, whatever characters the names of files and nodes contain. */
#include "base/error.h"

#include "base/mem.h"
#include "base/terminal_text.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static void cut_text(char *text, size_t size) {
    size_t end = size - 4;
    while (end > 0 && ((unsigned char)text[end] & 0xc0) == 0x80)
        end--;
    memcpy(text + end, "...", 4);
}

static bool fill(struct error *error, enum error_kind kind, const char *format, va_list arguments) {
    int length = vsnprintf(error->text, sizeof error->text, format, arguments);
    if (length >= (int)sizeof error->text)
        cut_text(error->text, sizeof error->text);
    for (char *end = error->text; (end = strpbrk(end, "\n\r"));)
        *end = '?';
    /* A name at the beginning must not look like a message of the program; the format shows who wrote it. */
    const char *mark = strncmp(format, "gray:", 5) == 0 ? "" : scene_mark(error->text);
    if (mark[0] != '\0') {
        char text[sizeof error->text];
        memcpy(text, error->text, sizeof text);
        length = snprintf(error->text, sizeof error->text, "%s%s", mark, text);
        if (length >= (int)sizeof error->text)
            cut_text(error->text, sizeof error->text);
    }
    error->kind = kind;
    error->elsewhere = false;
    error->refused = false;
    error->limit = false;
    return false;
}

bool error_set(struct error *error, enum error_kind kind, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    (void)fill(error, kind, format, arguments);
    va_end(arguments);
    return false;
}

bool error_set_limit(struct error *error, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    (void)fill(error, ERROR_SCENE, format, arguments);
    va_end(arguments);
    error->limit = true;
    return false;
}

bool error_elsewhere(struct error *error) {
    error->elsewhere = true;
    return false;
}

bool error_no_memory(struct error *error, const char *what) {
    if (mem_refusals() > 0)
        return error_set_limit(error, "out of memory for %s: %s", what, mem_charged()->words);
    return error_set(error, ERROR_MACHINE, "out of memory for %s", what);
}

enum error_kind error_kind_of_reading(int number) {
    switch (number) {
    case EMFILE:
    case ENFILE:
    case ENOMEM:
    case ENOBUFS:
        return ERROR_MACHINE;
    default:
        return ERROR_SCENE;
    }
}

bool error_of_file(struct error *error, const char *path, uint64_t before) {
    const struct mem_account *account = mem_charged();
    char size[SIZE_WORDS];
    if (mem_refusals() == before)
        return false;
    return error_set_limit(error, "%s: needs more than the %s of %s", path, size_words(account->limit, size),
                           account->option);
}

bool error_prefix(struct error *error, const char *format, ...) {
    char text[sizeof error->text], prefix[sizeof error->text];
    bool limit = error->limit;
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(prefix, sizeof prefix, format, arguments);
    va_end(arguments);
    memcpy(text, error->text, sizeof text);
    bool elsewhere = error->elsewhere;
    (void)error_set(error, error->kind, "%s: %s", prefix, text);
    error->limit = limit;
    error->elsewhere = elsewhere;
    return false;
}

/* Units are powers of 1024, with "B" as well as with "iB". */

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

/* The power of 1024 of a unit; -1 for an unknown one. */
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
