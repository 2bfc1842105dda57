/* See sort.h. */
#include "base/sort.h"

static void sift_down(uint64_t *items, size_t root, size_t count) {
    for (size_t child; (child = 2 * root + 1) < count; root = child) {
        if (child + 1 < count && items[child + 1] > items[child])
            child++;
        if (items[root] >= items[child])
            return;
        uint64_t swap = items[root];
        items[root] = items[child];
        items[child] = swap;
    }
}

void sort_words(uint64_t *items, size_t count) {
    if (count <= 24) {
        for (size_t i = 1; i < count; i++) {
            uint64_t item = items[i];
            size_t j = i;
            for (; j > 0 && items[j - 1] > item; j--)
                items[j] = items[j - 1];
            items[j] = item;
        }
        return;
    }
    for (size_t root = count / 2; root-- > 0;)
        sift_down(items, root, count);
    for (size_t last = count - 1; last > 0; last--) {
        uint64_t swap = items[0];
        items[0] = items[last];
        items[last] = swap;
        sift_down(items, 0, last);
    }
}
