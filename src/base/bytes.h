/* Numbers as bytes of a file, little-endian. The position moves behind them. */
#ifndef GRAY_BASE_BYTES_H
#define GRAY_BASE_BYTES_H

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

#endif
