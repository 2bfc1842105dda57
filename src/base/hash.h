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

/* The digest of a sequence of words. Zero-initialise; digest_sum_end gives the result. Two sums of products of pairs of
 * words (W. Wang, "wyhash", and Y. Collet, "XXH3": a product of 64 x 64 bits, folded); each position has separate
 * constants. */
enum { DIGEST_SUM_WORDS = 64 };
struct digest_sum {
    struct digest before;
    uint64_t words[DIGEST_SUM_WORDS];
    uint32_t count;
};

__extension__ typedef unsigned __int128 digest_product;

static inline uint64_t digest_fold(uint64_t a, uint64_t b) {
    digest_product product = (digest_product)a * b;
    return (uint64_t)product ^ (uint64_t)(product >> 64);
}

static inline void digest_sum_flush(struct digest_sum *sum) {
    uint64_t a = sum->count, b = sum->count, key = UINT64_C(0x9e3779b97f4a7c15);
    if (sum->count % 2 == 1)
        sum->words[sum->count] = 0;
    for (uint32_t i = 0; i < sum->count; i += 2, key += UINT64_C(0x3c6ef372fe94f82a)) {
        uint64_t x = sum->words[i], y = sum->words[i + 1];
        a += digest_fold(x ^ key, y ^ ~key * UINT64_C(0xbf58476d1ce4e5b9));
        b += digest_fold(x + key * UINT64_C(0x94d049bb133111eb), y - key) ^ x;
    }
    sum->before = (struct digest){random_mix(sum->before.a * UINT64_C(0x100000001b3) + a),
                                  random_mix((sum->before.b ^ b) + UINT64_C(0xd1342543de82ef95))};
    sum->count = 0;
}

static inline void digest_sum_add(struct digest_sum *sum, uint64_t word) {
    sum->words[sum->count++] = word;
    if (sum->count == DIGEST_SUM_WORDS)
        digest_sum_flush(sum);
}

/* Numbers are compared by their bits: 0 and -0 differ. */
static inline void digest_sum_add_numbers(struct digest_sum *sum, const double *numbers, size_t count) {
    if (count < DIGEST_SUM_WORDS - sum->count) { /* one copy */
        memcpy(&sum->words[sum->count], numbers, count * sizeof *numbers);
        sum->count += (uint32_t)count;
        return;
    }
    for (size_t i = 0; i < count; i++) {
        uint64_t word;
        memcpy(&word, &numbers[i], sizeof word);
        digest_sum_add(sum, word);
    }
}

static inline void digest_sum_add_digest(struct digest_sum *sum, struct digest digest) {
    digest_sum_add(sum, digest.a);
    digest_sum_add(sum, digest.b);
}

static inline struct digest digest_sum_end(struct digest_sum *sum) {
    digest_sum_flush(sum);
    return sum->before;
}

static inline bool digest_equal(struct digest x, struct digest y) {
    return x.a == y.a && x.b == y.b;
}

static inline bool digest_is_zero(struct digest x) {
    return x.a == 0 && x.b == 0;
}

#endif
