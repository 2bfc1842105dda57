/* See hash.h: eight bytes at a time, mixed with multiplications; the tail is padded with zeros and the length mixed in.
 */
#include "base/hash.h"

#include "base/random.h"

#include <string.h>

uint64_t hash_bytes(const void *data, size_t size, uint64_t seed) {
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

struct digest digest_bytes(const void *data, size_t size, struct digest before) {
    return (struct digest){hash_bytes(data, size, before.a), hash_bytes(data, size, before.b ^ ~UINT64_C(0))};
}

bool digest_equal(struct digest x, struct digest y) {
    return x.a == y.a && x.b == y.b;
}
