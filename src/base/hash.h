/* 64-bit hash of bytes, for content keys and checks, not against attackers. FNV-1a's idea on 8-byte words with
 * splitmix64's finaliser; the value is part of no file format. */
#ifndef GRAY_BASE_HASH_H
#define GRAY_BASE_HASH_H

#include "base/random.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Eight bytes at a time, mixed with multiplications; the tail is padded with zeros and the length mixed in. */
static inline uint64_t hash_bytes(const void *data, size_t size, uint64_t seed) {
    const unsigned char *bytes = data;
    uint64_t h = random_mix(seed + UINT64_C(0x9e3779b97f4a7c15) + size);
    size_t at = 0;
    for (; size - at >= 8; at += 8) {
        uint64_t word;
        memcpy(&word, bytes + at, 8);
        h = (h ^ random_mix(word)) * UINT64_C(0x100000001b3) + (h >> 47);
    }
    uint64_t tail = 0;
    if (size > at)
        memcpy(&tail, bytes + at, size - at);
    return random_mix(h ^ tail);
}

/* 128 bits, to detect changes; the value is part of tile files (film/tile_file.h),
 * whose readers check the version of the program that wrote them. */
struct digest {
    uint64_t a, b;
};

/* `before`: the digest of what comes before these bytes; zero at the start. */
static inline struct digest digest_bytes(const void *data, size_t size, struct digest before) {
    return (struct digest){hash_bytes(data, size, before.a), hash_bytes(data, size, before.b ^ ~UINT64_C(0))};
}

static inline bool digest_equal(struct digest x, struct digest y) {
    return x.a == y.a && x.b == y.b;
}

static inline bool digest_is_zero(struct digest x) {
    return x.a == 0 && x.b == 0;
}

#endif
