/* Conversion of decimal numbers to doubles, correctly rounded (to nearest, ties to even).
 *
 * A number is w * 10^e with an integer w. There are three methods, each exact up to one final rounding:
 *
 * 1. w < 2^53 and |e| <= 22: w and 10^|e| are doubles, and one multiplication or division rounds once (W. D.
 * Clinger, "How to read floating point numbers accurately", PLDI 1990). Nearly every number in mesh files is of this
 * kind.
 *
 * 2. w of up to 19 digits and -27 <= e < 0 (doubles printed with 17 digits): w / 5^-e in integers of 128 bits. The
 * quotient has ten bits more than a double keeps; a remainder sets its last bit.
 *
 * 3. All other numbers: the C library's strtod on a copy of the token. */
#include "formats/decimal_internal.h"

#include <assert.h>
#include <locale.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

__extension__ typedef unsigned __int128 wide;

enum { MAX_DIGITS = 19, MAX_POWER_OF_TEN = 22, MAX_POWER_OF_FIVE = 27, TOKEN_LIMIT = 1200 };

static const double powers_of_ten[MAX_POWER_OF_TEN + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                           1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                           1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* w / 5^n * 2^-n for w > 0, 0 < n <= 27. With both numbers shifted to have their highest bit set, the quotient
 * (w' * 2^63) / d' has 63 or 64 bits. */
static double divide_by_power_of_ten(uint64_t w, int n) {
    uint64_t d = 1;
    for (int i = 0; i < n; i++)
        d *= 5;
    int shift_w = __builtin_clzll(w), shift_d = __builtin_clzll(d);
    wide numerator = (wide)(w << shift_w) << 63;
    uint64_t divisor = d << shift_d;
    uint64_t quotient = (uint64_t)(numerator / divisor);
    if (numerator % divisor != 0)
        quotient |= 1;
    return ldexp((double)quotient, shift_d - shift_w - 63 - n);
}

/* strtod needs a NUL after the token, and the decimal point of the locale in it. */
static bool read_slowly(const char *at, size_t length, double *out) {
    char token[TOKEN_LIMIT + 1];
    if (length > TOKEN_LIMIT)
        return false;
    memcpy(token, at, length);
    token[length] = '\0';
    char *point = strchr(token, '.');
    if (point)
        *point = localeconv()->decimal_point[0];
    char *rest;
    *out = strtod(token, &rest);
    assert(*rest == '\0'); /* strtod accepts every token that was recognised as a number */
    return isfinite(*out);
}

const char *decimal_read(const char *at, const char *end, double *out) {
    const char *p = at;
    bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+'))
        p++;

    /* Reads digits into w while they surely fit; leading zeros do not count. */
    uint64_t w = 0;
    int digits = 0, exponent = 0;
    bool any = false, fits = true, after_point = false;
    for (; p < end; p++) {
        unsigned digit = (unsigned)(unsigned char)*p - '0';
        if (digit > 9) {
            if (*p != '.' || after_point)
                break;
            after_point = true;
            continue;
        }
        any = true;
        if (after_point && exponent > -100000)
            exponent--;
        if (digits < MAX_DIGITS) {
            w = w * 10 + digit;
            digits += w != 0;
        } else {
            fits = false;
        }
    }
    if (!any)
        return NULL;

    if (p < end && (*p == 'e' || *p == 'E')) {
        const char *q = p + 1;
        bool down = q < end && *q == '-';
        if (q < end && (*q == '-' || *q == '+'))
            q++;
        int shift = 0;
        const char *first = q;
        for (; q < end && (unsigned)(unsigned char)*q - '0' <= 9; q++)
            if (shift < 100000)
                shift = shift * 10 + (*q - '0');
        if (q > first) { /* otherwise the e belongs to the next word */
            exponent += down ? -shift : shift;
            p = q;
        }
    }

    double value;
    if (fits && w == 0)
        value = 0;
    else if (fits && w <= (UINT64_C(1) << 53) && exponent >= -MAX_POWER_OF_TEN && exponent <= MAX_POWER_OF_TEN)
        value = exponent < 0 ? (double)w / powers_of_ten[-exponent] : (double)w * powers_of_ten[exponent];
    else if (fits && exponent < 0 && exponent >= -MAX_POWER_OF_FIVE)
        value = divide_by_power_of_ten(w, -exponent);
    else {
        if (!read_slowly(at, (size_t)(p - at), out))
            return NULL;
        return p;
    }
    *out = negative ? -value : value;
    return p;
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

const char *decimal_skip_not_finite(const char *at, const char *end) {
    const char *p = at;
    double ignored;
    if (p < end && (*p == '-' || *p == '+'))
        p++;
    if (end - p < 3)
        return NULL;
    bool named = strncasecmp(p, "nan", 3) == 0 || strncasecmp(p, "inf", 3) == 0 || memcmp(p, "1.#", 3) == 0;
    bool beyond = (is_digit(*p) || (*p == '.' && is_digit(p[1]))) && !decimal_read(at, end, &ignored);
    if (!named && !beyond)
        return NULL;
    while (p < end && (unsigned char)*p > ' ')
        p++;
    return p;
}
