/* Sorting in place. Never allocates; at most n log n steps for every input. Not stable: callers that need a unique
 * result use a total order. */
#ifndef GRAY_BASE_SORT_H
#define GRAY_BASE_SORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Whether *a comes before *b. */
typedef bool sort_before(const void *a, const void *b);

enum { SORT_ITEM_MAX = 256 }; /* bytes */

/* Moves item `root` of a heap down until no child comes after it. */
static inline __attribute__((always_inline)) void sort_sift_down(unsigned char *items, size_t root, size_t count,
                                                                 size_t size, sort_before *before) {
    unsigned char moved[SORT_ITEM_MAX];
    memcpy(moved, items + root * size, size);
    for (size_t child; (child = 2 * root + 1) < count; root = child) {
        if (child + 1 < count && before(items + child * size, items + (child + 1) * size))
            child++;
        if (!before(moved, items + child * size))
            break;
        memcpy(items + root * size, items + child * size, size);
    }
    memcpy(items + root * size, moved, size);
}

/* Heap sort (Williams 1964) of items of `size` bytes, at most SORT_ITEM_MAX. Inline, so that the comparison is, too. */
static inline __attribute__((always_inline)) void sort_items(void *items, size_t count, size_t size,
                                                             sort_before *before) {
    unsigned char *bytes = items;
    for (size_t root = count / 2; root-- > 0;)
        sort_sift_down(bytes, root, count, size, before);
    for (size_t last = count; last-- > 1;) {
        unsigned char first[SORT_ITEM_MAX];
        memcpy(first, bytes, size);
        memcpy(bytes, bytes + last * size, size);
        memcpy(bytes + last * size, first, size);
        sort_sift_down(bytes, 0, last, size, before);
    }
}

static inline bool sort_word_before(const void *a, const void *b) {
    const uint64_t *x = a, *y = b;
    return *x < *y;
}

/* Words, ascending: by insertion if they are few. */
static inline void sort_words(uint64_t *items, size_t count) {
    if (count > 24) {
        sort_items(items, count, sizeof *items, sort_word_before);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        uint64_t item = items[i];
        size_t j = i;
        for (; j > 0 && items[j - 1] > item; j--)
            items[j] = items[j - 1];
        items[j] = item;
    }
}

#endif
