/* For the targets that read files of tiles: corrects the checksums of all records; otherwise hardly any input would
 * pass them. */
#ifndef GRAY_TESTS_FUZZ_TILE_BYTES_H
#define GRAY_TESTS_FUZZ_TILE_BYTES_H

#include "base/hash.h"

#include <stddef.h>
#include <stdint.h>

static inline uint64_t tile_bytes_number(const uint8_t *bytes, int count) {
    uint64_t value = 0;
    for (int i = count - 1; i >= 0; i--)
        value = value << 8 | bytes[i];
    return value;
}

static inline void tile_bytes_repair(uint8_t *bytes, size_t size) {
    uint64_t position = 0;
    for (size_t at = 16; size >= at && size - at >= 24; position++) {
        uint64_t kind = tile_bytes_number(bytes + at, 4), length = tile_bytes_number(bytes + at + 8, 8);
        if (length > size - at - 24)
            return;
        uint64_t check = hash_bytes(bytes + at + 16, (size_t)length, position * 64 + kind);
        for (size_t i = 0; i < 8; i++)
            bytes[at + 16 + length + i] = (uint8_t)(check >> (8 * i));
        at += 24 + (size_t)length;
    }
}

#endif
