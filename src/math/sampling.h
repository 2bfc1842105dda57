/* Points in squares. */
#ifndef GRAY_MATH_SAMPLING_H
#define GRAY_MATH_SAMPLING_H

#include "base/random.h"

#include <stdint.h>

struct sample2 {
    double x, y;
};

/* A point of cell (i, j) of the n x n cells of the unit square, jittered inside the cell; a function of its arguments. */
static inline struct sample2 sample_cell(uint64_t key, uint32_t i, uint32_t j, uint32_t n) {
    uint64_t bits = random_combine(key, (uint64_t)j * n + i);
    double x = random_unit(bits), y = random_unit(random_mix(bits + UINT64_C(0x9e3779b97f4a7c15)));
    return (struct sample2){((double)i + x) / (double)n, ((double)j + y) / (double)n};
}

#endif
