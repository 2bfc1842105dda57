/* Reading binary numbers at any address, in either byte order. */
#ifndef GRAY_FORMATS_SCAN_INTERNAL_H
#define GRAY_FORMATS_SCAN_INTERNAL_H

#include "base/unreachable.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum number_type {
    NUMBER_I8,
    NUMBER_U8,
    NUMBER_I16,
    NUMBER_U16,
    NUMBER_I32,
    NUMBER_U32,
    NUMBER_F32,
    NUMBER_F64,
    NUMBER_TYPES
};

static inline unsigned number_size(enum number_type type) {
    static const uint8_t sizes[NUMBER_TYPES] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[type];
}

static inline uint16_t scan_u16(const uint8_t *p, bool big) {
    uint16_t x;
    memcpy(&x, p, 2);
    return big == (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) ? x : __builtin_bswap16(x);
}

static inline uint32_t scan_u32(const uint8_t *p, bool big) {
    uint32_t x;
    memcpy(&x, p, 4);
    return big == (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) ? x : __builtin_bswap32(x);
}

static inline uint64_t scan_u64(const uint8_t *p, bool big) {
    uint64_t x;
    memcpy(&x, p, 8);
    return big == (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__) ? x : __builtin_bswap64(x);
}

static inline double scan_f32(const uint8_t *p, bool big) {
    uint32_t bits = scan_u32(p, big);
    float x;
    memcpy(&x, &bits, 4);
    return (double)x;
}

static inline double scan_number(const uint8_t *p, enum number_type type, bool big) {
    switch (type) {
    case NUMBER_I8:
        return (double)(int8_t)p[0];
    case NUMBER_U8:
        return (double)p[0];
    case NUMBER_I16:
        return (double)(int16_t)scan_u16(p, big);
    case NUMBER_U16:
        return (double)scan_u16(p, big);
    case NUMBER_I32:
        return (double)(int32_t)scan_u32(p, big);
    case NUMBER_U32:
        return (double)scan_u32(p, big);
    case NUMBER_F32:
        return scan_f32(p, big);
    case NUMBER_F64: {
        uint64_t bits = scan_u64(p, big);
        double x;
        memcpy(&x, &bits, 8);
        return x;
    }
    case NUMBER_TYPES:
        break;
    }
    UNREACHABLE("a number of no type");
}

#endif
