/* 64-bit hash of bytes, for content keys and checks, not against attackers. FNV-1a's idea on 8-byte words with
 * splitmix64's finaliser; the value is part of no file format. */
#ifndef GRAY_BASE_HASH_H
#define GRAY_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

uint64_t hash_bytes(const void *data, size_t size, uint64_t seed);

#endif
