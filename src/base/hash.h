/* 64-bit hash of bytes, for content keys and checks, not against attackers. FNV-1a's idea on 8-byte words with
 * splitmix64's finaliser; the value is part of no file format. */
#ifndef GRAY_BASE_HASH_H
#define GRAY_BASE_HASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

uint64_t hash_bytes(const void *data, size_t size, uint64_t seed);

/* 128 bits, to detect changes; the value is part of tile files (render/tile_file.h),
 * whose readers check the version of the program that wrote them. */
struct digest {
    uint64_t a, b;
};

/* `before`: the digest of what comes before these bytes; zero at the start. */
struct digest digest_bytes(const void *data, size_t size, struct digest before);
bool digest_equal(struct digest x, struct digest y);

#endif
