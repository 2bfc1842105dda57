/* Sizes of memory and files in words: "64 MiB", and back from "64M". */
#ifndef GRAY_BASE_SIZE_H
#define GRAY_BASE_SIZE_H

#include <stdbool.h>
#include <stdint.h>

#define KIBIBYTE (UINT64_C(1) << 10)
#define MEBIBYTE (UINT64_C(1) << 20)
#define GIBIBYTE (UINT64_C(1) << 30)

enum { SIZE_WORDS = 32 };
/* "64 MiB": in MiB, or in the unit above or below where that is a whole number of few digits. Returns `out`. */
const char *size_words(uint64_t bytes, char out[SIZE_WORDS]);
/* A whole number and a unit: K, M, G or T, powers of 1024, in either case, with or without "B" or "iB" behind it; a
 * blank may be between them. A plain number is in MiB. False for anything else, and for what exceeds 64 bits. */
bool size_parse(const char *text, uint64_t *bytes);

#endif
