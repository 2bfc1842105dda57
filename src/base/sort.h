/* Sorting of 64-bit words, ascending, in place: insertion for a few, heap sort for more. Never allocates, never slower
 * than n log n whatever the order. */
#ifndef GRAY_BASE_SORT_H
#define GRAY_BASE_SORT_H

#include <stddef.h>
#include <stdint.h>

void sort_words(uint64_t *items, size_t count);

#endif
