/* Numbers as bytes of a file, little-endian (the position moves behind them), and bytes as base64. */
#ifndef GRAY_BASE_BYTES_H
#define GRAY_BASE_BYTES_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline void bytes_put(uint8_t **at, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++)
        *(*at)++ = (uint8_t)(value >> (8 * i));
}

static inline void bytes_put_number(uint8_t **at, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    bytes_put(at, bits, 8);
}

static inline uint64_t bytes_get(const uint8_t **at, int bytes) {
    uint64_t value = 0;
    for (int i = 0; i < bytes; i++)
        value |= (uint64_t) * (*at)++ << (8 * i);
    return value;
}

static inline double bytes_get_number(const uint8_t **at) {
    uint64_t bits = bytes_get(at, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The characters for the first three of `left` bytes, at least one; those without a byte are '=' (RFC 4648). */
static inline void bytes_base64(const uint8_t *bytes, size_t left, char out[4]) {
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uint32_t word = 0;
    for (size_t k = 0; k < 3; k++)
        word = word << 8 | (k < left ? bytes[k] : 0U);
    for (size_t k = 0; k < 4; k++)
        out[k] = '=';
    for (size_t k = 0; k < 4 && k <= left; k++)
        out[k] = letters[word >> (18 - 6 * k) & 63];
}

#endif
