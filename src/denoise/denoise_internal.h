/* The parts of the denoiser that are compiled for each instruction set (denoise_kernel_internal.h), and the
 * declarations that they share with denoise.c. They compute with vectors, but their order of additions does not
 * depend on the vector width: the bits are the same. */
#ifndef GRAY_DENOISE_DENOISE_INTERNAL_H
#define GRAY_DENOISE_DENOISE_INTERNAL_H

#include "denoise/denoise.h"
#include "film/film.h"

enum {
    DENOISE_BLOCK = 192, /* side of the squares that a worker takes */
    DENOISE_WINDOW = 6,  /* radius of a regression */
    DENOISE_SIDE = 2 * DENOISE_WINDOW + 1,
    DENOISE_LANES = 16,                                 /* of a row of a window, of which the last does not count */
    DENOISE_PATCH = 3,                                  /* radius of the patches that are compared */
    DENOISE_STEP = 2,                                   /* between centres of regressions */
    DENOISE_CHOICE = 3,                                 /* radius of the mean that chooses between candidates */
    DENOISE_INNER = DENOISE_BLOCK + 2 * DENOISE_CHOICE, /* side of a block with what this mean reads */
    DENOISE_MARGIN = DENOISE_CHOICE + 2 * DENOISE_WINDOW + DENOISE_PATCH,
    DENOISE_LOCAL = DENOISE_BLOCK + 2 * DENOISE_MARGIN, /* side of a block with everything that it reads */
    /* Centres that a block needs: their first coordinate, and how many are on a side. */
    DENOISE_EXTENT = DENOISE_CHOICE + DENOISE_WINDOW,
    DENOISE_FIRST = DENOISE_MARGIN - DENOISE_EXTENT / DENOISE_STEP * DENOISE_STEP,
    DENOISE_CENTRES = (DENOISE_MARGIN + DENOISE_BLOCK - 1 + DENOISE_EXTENT - DENOISE_FIRST) / DENOISE_STEP + 1,
    DENOISE_COMPARED = (DENOISE_CENTRES - 1) * DENOISE_STEP + 1 + 2 * DENOISE_PATCH,
    DENOISE_COMPARED_ROWS = 8,                    /* that are kept: at least those of a patch */
    DENOISE_TERMS = 1 + DENOISE_FEATURES + 2,     /* of the linear function: constant, position, features */
    DENOISE_COLUMNS = DENOISE_TERMS + 6,          /* and the colours of the halves that it explains */
    DENOISE_FEATURE_WINDOW = 3,                   /* radius of the filter of features */
    DENOISE_FEATURE_COMPARED = DENOISE_BLOCK + 2, /* for patches of 3 x 3 pixels */
    DENOISE_FEATURE_LOCAL = DENOISE_FEATURE_COMPARED + 2 * DENOISE_FEATURE_WINDOW,
    DENOISE_REGRESSIONS = 4,
    DENOISE_WIDE = 2,  /* this one uses a large window and needs no margin where candidates are compared */
    DENOISE_SMALL = 3, /* this one the smallest window, and all pixels there alike */
    DENOISE_CANDIDATES = DENOISE_REGRESSIONS + 1, /* the last one is the noisy colour */
};

/* Factors of squared differences of features: their sum is the distance. That of the depth is a relative one. */
static const float albedo_unit = 50, normal_unit = 10, depth_unit = 400;

/* A regression: its window, and how it weights the pixels there. */
struct denoise_regression {
    int radius;     /* of the window, at most DENOISE_WINDOW */
    int step;       /* between centres, a multiple of DENOISE_STEP that divides DENOISE_BLOCK */
    float colours;  /* scale of the distances between patches: at every second centre; 0: they do not count */
    float features; /* the same of the distances between features */
    bool details;   /* of details: only at centres with changing features in their windows */
};

typedef float denoise_plane[DENOISE_LOCAL * DENOISE_LOCAL];
typedef float denoise_feature_plane[DENOISE_FEATURE_LOCAL * DENOISE_FEATURE_LOCAL];
typedef float denoise_window[DENOISE_SIDE][DENOISE_LANES];

/* How many pixels made an estimate: the sum of their weights. */
enum denoise_support { DENOISE_FEW, DENOISE_SOME, DENOISE_MANY };

/* Memory of a worker. A block takes long: where the pool is cancelled, its kernels end, and what they leave is not
 * used. */
struct denoise_scratch {
    const struct pool *pool;
    denoise_plane colour[2][3], variance[3], feature[DENOISE_FEATURES];
    denoise_plane total_variance, unit;    /* of pixels that are compared: sums over the channels */
    denoise_plane sums[2][3], weight_sums; /* of weighted colours of the halves, and of weights */
    denoise_plane estimates[DENOISE_REGRESSIONS][2][3];
    uint8_t support[DENOISE_REGRESSIONS][2][DENOISE_LOCAL * DENOISE_LOCAL]; /* enum denoise_support */
    /* Of the candidates: the error minus that of the first one, and the variance of this difference. */
    float errors[DENOISE_CANDIDATES][DENOISE_INNER][DENOISE_INNER];
    float doubts[DENOISE_CANDIDATES][DENOISE_INNER][DENOISE_INNER];
    float relative[3][DENOISE_INNER][DENOISE_INNER]; /* variance of a half around a pixel, by squared colours */
    uint8_t change[DENOISE_LOCAL * DENOISE_LOCAL];   /* columns to the next pixel where features change */
    uint8_t near[DENOISE_CENTRES * DENOISE_CENTRES]; /* of centres: the radius of the window that reaches one */
    denoise_window distances[DENOISE_CENTRES * DENOISE_CENTRES / 2 + 1]; /* between patches, of every second centre */
    float unlikeness[DENOISE_COMPARED_ROWS][DENOISE_COMPARED]
                    [DENOISE_LANES]; /* of pixels and their windows: last rows */
    denoise_feature_plane feature_mean[3], feature_noise[3];
    float feature_unlikeness[DENOISE_FEATURE_COMPARED * DENOISE_FEATURE_COMPARED];
    float feature_sums[4][DENOISE_BLOCK * DENOISE_BLOCK]; /* of weighted features, and of weights */
    /* Of one regression. */
    denoise_window columns[DENOISE_COLUMNS], weights;
};

/* bounds: the picture, as far as it is in the planes of the scratch, in their coordinates. */
struct denoise_kernels {
    /* Adds up the features of a block, weighted by the likeness of patches; group: how many there are. */
    void (*filter_features)(struct denoise_scratch *s, int group, bool relative, struct film_rectangle bounds);
    /* The distances of all centres from their windows, in the colours of a half. */
    void (*compare)(struct denoise_scratch *s, int half, struct film_rectangle bounds);
    /* Fills `near` from the features. */
    void (*find_changes)(struct denoise_scratch *s);
    /* Adds up what the regressions of all centres say about the colours of a half; of both if colours do not count. */
    void (*regress)(struct denoise_scratch *s, int half, struct denoise_regression regression,
                    struct film_rectangle bounds);
    /* Fills errors and doubts from the estimates. */
    void (*compare_candidates)(struct denoise_scratch *s);
    /* The scores of the candidates at the pixels of a row of the block: the smallest is the best. */
    void (*score_candidates)(const struct denoise_scratch *s, int y, float scores[DENOISE_CANDIDATES][DENOISE_BLOCK]);
};

extern const struct denoise_kernels denoise_kernels_base, denoise_kernels_avx2, denoise_kernels_avx512;

#endif
