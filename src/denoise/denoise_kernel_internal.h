/* The loops of the denoiser over vectors of floats, for the instruction set of the file that includes this one. The
 * window of a centre has DENOISE_SIDE rows of DENOISE_LANES pixels. Sums over it are first sums of columns, which
 * are then added in a fixed order. */
#include "denoise/denoise_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum {
    LOCAL = DENOISE_LOCAL,
    COMPARED = DENOISE_COMPARED,
    LANES = DENOISE_LANES,
    SMALL_LANES = 8, /* of windows with a radius of at most 3 */
    TERMS = DENOISE_TERMS,
    COLUMNS = DENOISE_COLUMNS,
    FIRST_FEATURE = 3, /* terms before the features: constant, x, y */
#if defined(__AVX512F__)
    WIDTH = 16
#elif defined(__AVX2__)
    WIDTH = 8
#else
    WIDTH = 4
#endif
};
typedef float vector __attribute__((vector_size(WIDTH * sizeof(float))));

/* Found by measurement (bench/denoise.sh). */
static const float noise_scale = 1.44F;  /* factor of the variance in distances of patches: k^2 */
static const float colour_noise = 1e-3F; /* the same for the square of colours */
/* A patch beside an edge resembles patches without one, but a pixel that differs strongly itself is not similar. */
static const float unlikeness_limit = 4; /* of each pixel of a patch */
static const float own_limit = 4,
                   own_share = 0.5F;       /* of the pixel itself: the threshold of its distance, and its weight */
static const double ridge = 5e-4;          /* of the sum of weights */
static const float feature_change = 1e-4F; /* the ridge suppresses albedo and normals that change less */
/* Two pixels count half for each other if their features have this distance. */
static const float similar_limit = 10;
/* Half of `detail_margin` remains where the largest distance between the features around a pixel is this. */
static const float change_limit = 0.22F;
static const float change_seen = 0.05F;  /* neighbours whose features have this distance differ */
static const float detail_margin = 1;    /* added to the error of candidates that use few pixels */
static const float small_margin = 0.25F; /* added to that of the candidate that uses the fewest, everywhere */
static const float colour_margin = 1;    /* added to that of the noisy colour */
static const float doubt_errors = 1.4F;  /* standard errors that are added to the error of a candidate */

typedef int32_t mask __attribute__((vector_size(WIDTH * sizeof(int32_t)))); /* -1 for true, 0 */

static inline vector load(const float *from) {
    vector v;
    memcpy(&v, from, sizeof v);
    return v;
}

static inline void store(float *to, vector v) {
    memcpy(to, &v, sizeof v);
}

static inline vector all(float x) {
    return (vector){0} + x;
}

static inline vector choose(mask m, vector yes, vector no) {
    return (vector)((m & (mask)yes) | (~m & (mask)no));
}

static inline vector smaller(vector a, vector b) {
    return choose(a < b, a, b);
}

static inline vector larger(vector a, vector b) {
    return choose(a > b, a, b);
}

/* An approximation of exp(-x) for a distance x; 0 from 8 on. */
static inline float weight_of(float distance) {
    float x = 1 - (distance > 0 ? distance : 0) * 0.125F;
    x = x > 0 ? x : 0;
    x *= x;
    x *= x;
    return x * x;
}

/* --- features --- */

/* Squared differences between the block and the pixels at an offset of (dx, dy), minus the part that noise explains,
 * in units of the noise. The noise is at least 0.003 of the range of albedo and normals, and 0.001 of a depth. */
static void compare_features(struct denoise_scratch *s, int group, bool relative, int dx, int dy) {
    enum { SIDE = DENOISE_FEATURE_COMPARED, FIRST = DENOISE_FEATURE_WINDOW, STRIDE = DENOISE_FEATURE_LOCAL };
    float smallest = relative ? 1e-6F : 0;
    for (int y = 0; y < SIDE; y++) {
        int p = (FIRST + y) * STRIDE + FIRST, q = p + dy * STRIDE + dx;
        float above[SIDE] = {0}, below[SIDE] = {0}, *out = s->feature_unlikeness + y * SIDE;
        for (int i = 0; i < group; i++) {
            const float *mean = s->feature_mean[i], *noise = s->feature_noise[i];
            for (int x = 0; x < SIDE; x++) {
                float vp = noise[p + x], vq = noise[q + x], u = mean[p + x], delta = u - mean[q + x];
                above[x] += delta * delta - (vp + (vp < vq ? vp : vq));
                below[x] += vp + vq + smallest * u * u;
            }
        }
        for (int x = 0; x < SIDE; x++)
            out[x] = above[x] / (below[x] + 1e-5F);
    }
}

/* Adds the pixels at an offset of (dx, dy), weighted by the similarity of patches of 3 x 3 pixels. */
static void add_features(struct denoise_scratch *s, int group, int dx, int dy, struct film_rectangle bounds) {
    enum { SIDE = DENOISE_FEATURE_COMPARED, FIRST = DENOISE_FEATURE_WINDOW + 1, STRIDE = DENOISE_FEATURE_LOCAL };
    int x0 = (int)bounds.x0 - FIRST - dx, x1 = (int)bounds.x1 - FIRST - dx;
    int y0 = (int)bounds.y0 - FIRST - dy, y1 = (int)bounds.y1 - FIRST - dy;
    for (int y = 0; y < DENOISE_BLOCK; y++) {
        const float *above = s->feature_unlikeness + y * SIDE, *row = above + SIDE, *under = row + SIDE;
        int q = (FIRST + y + dy) * STRIDE + FIRST + dx, at = y * DENOISE_BLOCK;
        float columns[SIDE], weights[DENOISE_BLOCK];
        if (y < y0 || y >= y1)
            continue;
        for (int x = 0; x < SIDE; x++)
            columns[x] = above[x] + row[x] + under[x];
        for (int x = 0; x < DENOISE_BLOCK; x++) {
            float w = weight_of((columns[x] + columns[x + 1] + columns[x + 2]) / 9);
            weights[x] = x >= x0 && x < x1 ? w : 0;
        }
        for (int x = 0; x < DENOISE_BLOCK; x++)
            s->feature_sums[3][at + x] += weights[x];
        for (int i = 0; i < group; i++)
            for (int x = 0; x < DENOISE_BLOCK; x++)
                s->feature_sums[i][at + x] += weights[x] * s->feature_mean[i][q + x];
    }
}

static void filter_features(struct denoise_scratch *s, int group, bool relative, struct film_rectangle bounds) {
    enum { WINDOW = DENOISE_FEATURE_WINDOW };
    memset(s->feature_sums, 0, sizeof s->feature_sums);
    for (int dy = -WINDOW; dy <= WINDOW && !pool_cancelled(s->pool); dy++) {
        for (int dx = -WINDOW; dx <= WINDOW; dx++) {
            compare_features(s, group, relative, dx, dy);
            add_features(s, group, dx, dy, bounds);
        }
    }
}

/* --- distances of patches --- */

/* The sums over the channels that distances need of each pixel: its variance, and its part of their unit. */
static void sum_channels(struct denoise_scratch *s, int half) {
    for (int x = 0; x < LOCAL * LOCAL; x++) {
        float total = 0, unit = 0;
        for (int c = 0; c < 3; c++) {
            float u = s->colour[half][c][x], v = s->variance[c][x];
            total += v;
            unit += noise_scale * v + colour_noise * (u * u);
        }
        s->total_variance[x] = total;
        s->unit[x] = unit;
    }
}

/* The dissimilarity between the pixels of a row of the block and those of their windows that are dy below: squared
 * difference of colours minus the part that variance explains, in units of the variance (Rousselle et al. 2012,
 * equation 9). */
static void compare_row(struct denoise_scratch *s, int half, int y, int dy) {
    enum { FIRST = DENOISE_FIRST - DENOISE_PATCH };
    const float *r = s->colour[half][0], *g = s->colour[half][1], *b = s->colour[half][2];
    const float *vr = s->variance[0], *vg = s->variance[1], *vb = s->variance[2];
    float(*out)[LANES] = s->unlikeness[y % DENOISE_COMPARED_ROWS];
    for (int x = 0; x < COMPARED; x++) {
        int p = (FIRST + y) * LOCAL + FIRST + x;
        for (int at = 0; at < LANES; at += WIDTH) {
            int q = p + dy * LOCAL - DENOISE_WINDOW + at;
            vector dr = r[p] - load(r + q), dg = g[p] - load(g + q), db = b[p] - load(b + q);
            vector lr = smaller(all(vr[p]), load(vr + q)), lg = smaller(all(vg[p]), load(vg + q));
            vector lb = smaller(all(vb[p]), load(vb + q));
            vector above = ((dr * dr - lr) + (dg * dg - lg)) + ((db * db - lb) - s->total_variance[p]);
            store(out[x] + at, above / (s->unit[p] + load(s->unit + q) + FLT_MIN));
        }
    }
}

/* The mean over the patches around every second centre of a row, for a row of their windows. */
static void average_patches(struct denoise_scratch *s, int j, int row) {
    enum { SIDE = 2 * DENOISE_PATCH + 1 };
    float columns[COMPARED][LANES];
    float(*rows[SIDE])[LANES];
    for (int y = 0; y < SIDE; y++)
        rows[y] = s->unlikeness[(j * DENOISE_STEP + y) % DENOISE_COMPARED_ROWS];
    for (int x = 0; x < COMPARED; x++)
        for (int at = 0; at < LANES; at += WIDTH) {
            vector c[SIDE];
            for (int y = 0; y < SIDE; y++)
                c[y] = smaller(load(rows[y][x] + at), all(unlikeness_limit));
            store(columns[x] + at, ((c[0] + c[1]) + (c[2] + c[3])) + ((c[4] + c[5]) + c[6]));
        }
    for (int i = j % 2; i < DENOISE_CENTRES; i += 2) {
        float *to = s->distances[(j * DENOISE_CENTRES + i) / 2][row];
        for (int at = 0; at < LANES; at += WIDTH) {
            vector c[SIDE], own = load(rows[DENOISE_PATCH][i * DENOISE_STEP + DENOISE_PATCH] + at) - own_limit;
            for (int x = 0; x < SIDE; x++)
                c[x] = load(columns[i * DENOISE_STEP + x] + at);
            store(to + at, (((c[0] + c[1]) + (c[2] + c[3])) + ((c[4] + c[5]) + c[6])) / (SIDE * SIDE) +
                               own_share * larger(own, all(0)));
        }
    }
}
_Static_assert(DENOISE_CENTRES % 2 == 1, "centres of even numbers are like the black squares of a chess board");
_Static_assert((int)DENOISE_PATCH == 3, "the sums of average_patches are of seven numbers");

static void compare(struct denoise_scratch *s, int half, struct film_rectangle bounds) {
    /* The lowest blocks of a picture are often half empty. */
    int inside = ((int)bounds.y1 - DENOISE_FIRST + DENOISE_STEP - 1) / DENOISE_STEP;
    int centres = inside < DENOISE_CENTRES ? inside : DENOISE_CENTRES;
    sum_channels(s, half);
    for (int row = 0; row < DENOISE_SIDE && !pool_cancelled(s->pool); row++) {
        int y = 0;
        for (int j = 0; j < centres; j++) {
            for (; y <= j * DENOISE_STEP + 2 * DENOISE_PATCH; y++)
                compare_row(s, half, y, row - DENOISE_WINDOW);
            average_patches(s, j, row);
        }
    }
}

/* --- regressions --- */

/* The halves of the samples that a regression is for, and the lanes of its windows: a small window needs fewer. */
struct extent {
    int first, halves, lanes;
};

/* The columns before the centre of a window. */
static inline int before(struct extent e) {
    return e.lanes < LANES ? e.lanes / 2 - 1 : DENOISE_WINDOW;
}

/* The rows of a window that are in the picture, and the lanes in these rows. */
struct window {
    int x, y; /* the centre */
    int left; /* the column of the first lane */
    int row0, row1;
    float inside[LANES]; /* 1 or 0 */
    /* How much a prediction for a lane or a row counts: less towards the rim. Otherwise columns that are in more
     * windows than their neighbours are streaks. */
    float lane_share[LANES], row_share[DENOISE_SIDE];
};

/* Small windows need all their pixels. A wider rim costs the contrast of edges. */
static float share_at(int distance, int radius) {
    const float rim = 3;
    float share = (float)(radius + 1 - (distance < 0 ? -distance : distance)) / rim;
    return radius < SMALL_LANES / 2 || share > 1 ? 1 : share > 0 ? share : 0;
}

static struct window find_window(int cx, int cy, int radius, struct extent e, struct film_rectangle bounds) {
    struct window w = {.x = cx, .y = cy, .left = cx - before(e)};
    int x0 = (int)bounds.x0, y0 = (int)bounds.y0, x1 = (int)bounds.x1, y1 = (int)bounds.y1;
    int low = cy - radius > y0 ? cy - radius : y0;
    int high = cy + radius + 1 < y1 ? cy + radius + 1 : y1;
    w.row0 = low - cy + DENOISE_WINDOW;
    w.row1 = high - cy + DENOISE_WINDOW;
    for (int l = 0; l < LANES; l++) {
        int x = w.left + l, dx = x - cx;
        w.inside[l] = dx >= -radius && dx <= radius && x >= x0 && x < x1 ? 1 : 0;
        w.lane_share[l] = share_at(dx, radius);
    }
    for (int r = w.row0; r < w.row1; r++)
        w.row_share[r] = share_at(r - DENOISE_WINDOW, radius);
    return w;
}

/* The start of a row of a window in a plane. */
static inline int row_at(const struct window *w, int row) {
    return (w->y + row - DENOISE_WINDOW) * LOCAL + w->left;
}

/* By the distances between patches. Weights below a thousandth count as zero. */
static void weigh(struct denoise_scratch *s, const struct window *w, denoise_window *distances, float scale) {
    const vector none = {0};
    for (int at = 0; at < LANES; at += WIDTH) {
        vector inside = load(w->inside + at);
        for (int r = w->row0; r < w->row1; r++) {
            vector x = 1 - larger(scale * load((*distances)[r] + at), none) * 0.125F;
            x = larger(x, none);
            x *= x;
            x *= x;
            x *= x * inside;
            store(s->weights[r] + at, choose(x > 1e-3F, x, none));
        }
    }
}

/* All pixels alike. */
static void weigh_alike(struct denoise_scratch *s, const struct window *w, struct extent e) {
    for (int at = 0; at < e.lanes; at += WIDTH)
        for (int r = w->row0; r < w->row1; r++)
            store(s->weights[r] + at, load(w->inside + at));
}

/* The smaller one of the differences to the pixels before and after. */
static float slope_of(const float *plane, int at, int step) {
    float before = fabsf(plane[at] - plane[at - step]), after = fabsf(plane[at + step] - plane[at]);
    return before < after ? before : after;
}

/* Multiplies the weights by the similarity of features. A plane is similar to itself at any angle: the depth at a
 * distance of some pixels may differ by as much as the slope explains. */
static void weigh_features(struct denoise_scratch *s, const struct window *w, float scale) {
    const vector none = {0};
    int centre = w->y * LOCAL + w->x;
    const float *depth = s->feature[DENOISE_DEPTH];
    float z = depth[centre], across = 2 * slope_of(depth, centre, 1), down = 2 * slope_of(depth, centre, LOCAL);
    for (int at = 0; at < LANES; at += WIDTH) {
        vector dx = load(s->columns[1][0] + at) * (DENOISE_WINDOW * across);
        for (int r = w->row0; r < w->row1; r++) {
            float dy = (float)(r - DENOISE_WINDOW) * down;
            vector sum = none;
            for (int f = 0; f < DENOISE_DEPTH; f++) {
                vector difference = load(s->feature[f] + row_at(w, r) + at) - s->feature[f][centre];
                sum += difference * difference * (f < DENOISE_NORMAL ? albedo_unit : normal_unit);
            }
            vector difference = load(depth + row_at(w, r) + at) - z;
            sum += difference * difference / (dx * dx + (dy * dy + z * z / depth_unit + FLT_MIN));
            vector x = larger(1 - scale * sum * 0.125F, none);
            x *= x;
            x *= x;
            x *= x * load(s->weights[r] + at);
            store(s->weights[r] + at, choose(x > 1e-3F, x, none));
        }
    }
}

/* Differences of a feature to the centre; returns whether they are more than `feature_change` where there is a weight.
 */
static inline __attribute__((always_inline)) bool fill_feature(struct denoise_scratch *s, const struct window *w,
                                                               struct extent e, int feature, int column) {
    const float *plane = s->feature[feature];
    vector middle = all(plane[w->y * LOCAL + w->x]);
    mask found = {0};
    for (int r = w->row0; r < w->row1; r++) {
        for (int at = 0; at < e.lanes; at += WIDTH) {
            vector difference = load(plane + row_at(w, r) + at) - middle;
            store(s->columns[column][r] + at, difference);
            found |= ((difference > feature_change) | (difference < -feature_change)) & (load(s->weights[r] + at) > 0);
        }
    }
    int32_t any = 0;
    for (int l = 0; l < WIDTH; l++)
        any |= found[l];
    return any != 0;
}

/* The range of the colours among the pixels with a weight. */
static inline __attribute__((always_inline)) void find_range(const struct denoise_scratch *s, const struct window *w,
                                                             struct extent e, int half, int channel, float range[2]) {
    const float *plane = s->colour[half][channel];
    float middle = plane[w->y * LOCAL + w->x], lowest[LANES], highest[LANES];
    vector lows[LANES / WIDTH], highs[LANES / WIDTH];
    for (int at = 0; at < e.lanes; at += WIDTH) {
        vector low = all(middle), high = low;
        for (int r = w->row0; r < w->row1; r++) {
            vector value = load(plane + row_at(w, r) + at);
            vector counting = choose(load(s->weights[r] + at) > 0, value, low);
            low = smaller(counting, low);
            high = larger(counting, high);
        }
        lows[at / WIDTH] = low;
        highs[at / WIDTH] = high;
    }
    memcpy(lowest, lows, sizeof lowest);
    memcpy(highest, highs, sizeof highest);
    range[0] = range[1] = middle;
    for (int l = 0; l < e.lanes; l++) {
        range[0] = lowest[l] < range[0] ? lowest[l] : range[0];
        range[1] = highest[l] > range[1] ? highest[l] : range[1];
    }
}

/* The sums over the window of weight * column i * column j, by lane, for terms j from i to below `terms` and for the
 * colours of the halves. */
static inline __attribute__((always_inline)) void multiply(const struct denoise_scratch *s, const struct window *w,
                                                           struct extent e, int i, int terms,
                                                           float sums[COLUMNS][LANES]) {
    const int columns = TERMS + 3 * e.halves;
    for (int at = 0; at < e.lanes; at += WIDTH) {
        vector sum[COLUMNS];
        for (int j = i; j < columns; j++)
            sum[j] = (vector){0};
        for (int r = w->row0; r < w->row1; r++) {
            int from = row_at(w, r) + at;
            vector weighted = load(s->weights[r] + at) * load(s->columns[i][r] + at);
            for (int j = i; j < terms; j++)
                sum[j] += weighted * load(s->columns[j][r] + at);
            for (int c = 0; c < 3 * e.halves; c++)
                sum[TERMS + c] += weighted * load(s->colour[e.first + c / 3][c % 3] + from);
        }
        for (int j = i; j < columns; j++)
            store(sums[j] + at, sum[j]);
    }
}

typedef float four __attribute__((vector_size(16)));

static inline float sum_lanes(struct extent e, const float lanes[LANES]) {
    four a[4];
    memcpy(a, lanes, sizeof a);
    four sum = e.lanes == LANES ? (a[0] + a[2]) + (a[1] + a[3]) : a[0] + a[1];
    return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/* The normal equations: the upper triangle of a symmetric matrix, and the right sides: three for each half. */
typedef double four_doubles __attribute__((vector_size(32)));
enum { FOURS = (TERMS + 3) / 4 };
struct equations {
    union {
        double at[4 * FOURS];
        four_doubles fours[FOURS];
    } matrix[TERMS];
    four_doubles right[TERMS][2];
};

/* The terms of features are in units of `scale`: twice their mean difference to the centre, but at least what
 * `scale` is before. */
static inline __attribute__((always_inline)) void build_equations(const struct denoise_scratch *s,
                                                                  const struct window *w, struct extent e, int terms,
                                                                  double scale[TERMS], struct equations *out) {
    float sums[TERMS][COLUMNS][LANES];
#define MULTIPLY(i)                                                                                                    \
    if (i < terms)                                                                                                     \
    multiply(s, w, e, i, terms, sums[i])
    MULTIPLY(0);
    MULTIPLY(1);
    MULTIPLY(2);
    MULTIPLY(3);
    MULTIPLY(4);
    MULTIPLY(5);
    MULTIPLY(6);
    MULTIPLY(7);
    MULTIPLY(8);
    MULTIPLY(9);
#undef MULTIPLY
    _Static_assert((int)TERMS == 10, "a line for each term");
    for (int i = FIRST_FEATURE; i < terms; i++) {
        double mean = 2 * sqrt((double)sum_lanes(e, sums[i][i]) / (double)sum_lanes(e, sums[0][0]));
        scale[i] = 1 / (mean > scale[i] ? mean : scale[i]);
    }
    memset(out, 0, sizeof *out);
    for (int i = 0; i < terms; i++) {
        for (int j = i; j < terms; j++)
            out->matrix[i].at[j] = (double)sum_lanes(e, sums[i][j]) * scale[i] * scale[j];
        for (int c = 0; c < 3 * e.halves; c++)
            out->right[i][c / 3][c % 3] = (double)sum_lanes(e, sums[i][TERMS + c]) * scale[i];
    }
}

/* Cholesky; the matrix is positive. Solves for the right sides in place. Each row is subtracted from all later ones
 * before the next, by fours of elements: those before the diagonal do not count. */
static inline __attribute__((always_inline)) bool solve(int terms, int halves, struct equations *e) {
    const int fours = (terms + 3) / 4;
    double inverse[TERMS]; /* of the diagonal */
    for (int i = 0; i < terms; i++) {
        if (!(e->matrix[i].at[i] > 0))
            return false;
        inverse[i] = 1 / sqrt(e->matrix[i].at[i]);
        for (int j = i / 4; j < fours; j++)
            e->matrix[i].fours[j] *= inverse[i];
        for (int h = 0; h < halves; h++)
            e->right[i][h] *= inverse[i];
        for (int k = i + 1; k < terms; k++) {
            for (int j = k / 4; j < fours; j++)
                e->matrix[k].fours[j] -= e->matrix[i].at[k] * e->matrix[i].fours[j];
            for (int h = 0; h < halves; h++)
                e->right[k][h] -= e->matrix[i].at[k] * e->right[i][h];
        }
    }
    for (int h = 0; h < halves; h++)
        for (int i = terms - 1; i >= 0; i--) {
            for (int k = i + 1; k < terms; k++)
                e->right[i][h] -= e->matrix[i].at[k] * e->right[k][h];
            e->right[i][h] *= inverse[i];
        }
    return true;
}

/* Of a channel: the factors of the terms, and the lowest and highest colour that the regression used. */
struct prediction {
    float factors[TERMS], range[2];
};

/* Adds the predictions of a regression for the pixels of its window. They are limited to the range of the pixels
 * that it used, because regressions overshoot beside lights. */
static inline __attribute__((always_inline)) void predict(const struct denoise_scratch *s, const struct window *w,
                                                          struct extent e, int terms, const struct prediction *by,
                                                          float *sums) {
    vector factor[TERMS], low = all(by->range[0]), high = all(by->range[1]);
    for (int i = 0; i < terms; i++)
        factor[i] = all(by->factors[i]);
    for (int r = w->row0; r < w->row1; r++) {
        float *to = sums + row_at(w, r);
        for (int at = 0; at < e.lanes; at += WIDTH) {
            vector value = factor[0];
            for (int i = 1; i < terms; i++)
                value += factor[i] * load(s->columns[i][r] + at);
            store(to + at, load(to + at) + load(s->weights[r] + at) * smaller(larger(value, low), high));
        }
    }
}

/* Fills the columns of the depth, and of albedo and normals that change in the window. Returns the number of terms, and
 * their smallest units: 0.02 for albedo and normals, 1/200 of a depth. */
static inline __attribute__((always_inline)) int fill_features(struct denoise_scratch *s, const struct window *w,
                                                               struct extent e, double scale[TERMS]) {
    static const int groups[][2] = {{DENOISE_ALBEDO, 3}, {DENOISE_NORMAL, 3}, {DENOISE_DEPTH, 1}};
    int terms = FIRST_FEATURE;
    for (int g = 0; g < 3; g++) {
        bool changes = g == 2;
        for (int i = 0; i < groups[g][1]; i++) {
            int f = groups[g][0] + i;
            float middle = s->feature[f][w->y * LOCAL + w->x];
            changes = fill_feature(s, w, e, f, terms + i) || changes;
            scale[terms + i] = (double)(f == DENOISE_DEPTH ? 0.005F * fabsf(middle) + FLT_MIN : 0.02F);
        }
        terms += changes ? groups[g][1] : 0;
    }
    return terms;
}

/* The regression with a number of terms that the compiler knows. */
static inline __attribute__((always_inline)) void fit(struct denoise_scratch *s, const struct window *w,
                                                      struct extent e, int terms, double scale[TERMS]) {
    struct equations equations;
    struct prediction by[6];
    for (int c = 0; c < 3 * e.halves; c++)
        find_range(s, w, e, e.first + c / 3, c % 3, by[c].range);
    build_equations(s, w, e, terms, scale, &equations);
    for (int i = 1; i < terms; i++) /* keeps terms small that the window does not determine */
        equations.matrix[i].at[i] += ridge * equations.matrix[0].at[0];
    if (!solve(terms, e.halves, &equations))
        return;
    for (int r = w->row0; r < w->row1; r++)
        for (int at = 0; at < e.lanes; at += WIDTH)
            store(s->weights[r] + at, load(s->weights[r] + at) * (w->row_share[r] * load(w->lane_share + at)));
    for (int c = 0; c < 3 * e.halves; c++) {
        for (int i = 0; i < terms; i++)
            by[c].factors[i] = (float)(equations.right[i][c / 3][c % 3] * scale[i]);
        predict(s, w, e, terms, &by[c], s->sums[e.first + c / 3][c % 3]);
    }
    for (int r = w->row0; r < w->row1; r++) {
        float *to = s->weight_sums + row_at(w, r);
        for (int at = 0; at < e.lanes; at += WIDTH)
            store(to + at, load(to + at) + load(s->weights[r] + at));
    }
}

/* Most windows are on one surface, where only the depth changes, and need a fifth of the multiplications. */
static inline __attribute__((always_inline)) void fit_features(struct denoise_scratch *s, const struct window *w,
                                                               struct extent e) {
    double scale[TERMS] = {1, 1, 1};
    int terms = fill_features(s, w, e, scale);
    if (terms == TERMS)
        fit(s, w, e, TERMS, scale);
    else if (terms == TERMS - 3)
        fit(s, w, e, TERMS - 3, scale);
    else
        fit(s, w, e, TERMS - 6, scale);
}

/* With halves and lanes that the compiler knows. */
static void regress_half(struct denoise_scratch *s, int half, const struct window *w) {
    fit_features(s, w, (struct extent){half, 1, LANES});
}

static void regress_halves(struct denoise_scratch *s, const struct window *w) {
    fit_features(s, w, (struct extent){0, 2, LANES});
}

static void regress_small(struct denoise_scratch *s, const struct window *w) {
    fit_features(s, w, (struct extent){0, 2, SMALL_LANES});
}

/* Marks pixels whose features differ from those to the right or below. */
static void mark_changes(struct denoise_scratch *s) {
    memset(s->change, 0, sizeof s->change);
    for (int y = 0; y < LOCAL - 1; y++) {
        for (int step = 1; step <= LOCAL; step += LOCAL - 1) {
            float sums[LOCAL];
            int p = y * LOCAL, q = p + step;
            for (int x = 0; x < LOCAL - 1; x++) {
                float z = s->feature[DENOISE_DEPTH][p + x], difference = s->feature[DENOISE_DEPTH][q + x] - z;
                sums[x] = difference * difference / (z * z / depth_unit + FLT_MIN);
            }
            for (int f = 0; f < DENOISE_DEPTH; f++) {
                float unit = f < DENOISE_NORMAL ? albedo_unit : normal_unit;
                for (int x = 0; x < LOCAL - 1; x++) {
                    float difference = s->feature[f][q + x] - s->feature[f][p + x];
                    sums[x] += difference * difference * unit;
                }
            }
            for (int x = 0; x < LOCAL - 1; x++)
                s->change[p + x] |= sums[x] >= change_seen;
        }
    }
}

/* From the marks of a row, the columns to the nearest mark, up to a limit. */
static void nearest_changes(uint8_t row[LOCAL], int limit) {
    int last = limit;
    for (int x = 0; x < LOCAL; x++) {
        last = row[x] ? 0 : last < limit ? last + 1 : limit;
        row[x] = (uint8_t)last;
    }
    for (int x = LOCAL - 1; x >= 0; x--) {
        last = row[x] <= last ? row[x] : last < limit ? last + 1 : limit;
        row[x] = (uint8_t)last;
    }
}

static void find_changes(struct denoise_scratch *s) {
    const int limit = DENOISE_WINDOW + 1;
    mark_changes(s);
    for (int y = 0; y < LOCAL; y++)
        nearest_changes(s->change + y * LOCAL, limit);
    for (int i = 0; i < DENOISE_CENTRES * DENOISE_CENTRES; i++) {
        int cx = DENOISE_FIRST + i % DENOISE_CENTRES * DENOISE_STEP;
        int cy = DENOISE_FIRST + i / DENOISE_CENTRES * DENOISE_STEP, nearest = limit;
        for (int dy = -DENOISE_WINDOW; dy <= DENOISE_WINDOW; dy++) {
            int across = s->change[(cy + dy) * LOCAL + cx], down = dy < 0 ? -dy : dy;
            int radius = across > down ? across : down;
            nearest = radius < nearest ? radius : nearest;
        }
        s->near[i] = (uint8_t)nearest;
    }
}

/* Whether the regression is made at a centre. */
static bool is_made_at(const struct denoise_scratch *s, struct denoise_regression regression, int centre) {
    int i = (DENOISE_FIRST - DENOISE_MARGIN) / DENOISE_STEP + centre % DENOISE_CENTRES;
    int j = (DENOISE_FIRST - DENOISE_MARGIN) / DENOISE_STEP + centre / DENOISE_CENTRES;
    if (i * DENOISE_STEP % regression.step != 0 || j * DENOISE_STEP % regression.step != 0)
        return false;
    if (regression.colours > 0 && centre % 2 != 0)
        return false;
    return !regression.details || s->near[centre] <= regression.radius;
}

static void regress(struct denoise_scratch *s, int half, struct denoise_regression regression,
                    struct film_rectangle bounds) {
    bool coloured = regression.colours > 0, small = !coloured && regression.radius < SMALL_LANES / 2;
    const struct extent e = {coloured ? half : 0, coloured ? 1 : 2, small ? SMALL_LANES : LANES};
    memset(s->sums[e.first], 0, (size_t)e.halves * sizeof s->sums[0]);
    memset(s->weight_sums, 0, sizeof s->weight_sums);
    for (int r = 0; r < DENOISE_SIDE; r++) {
        for (int l = 0; l < LANES; l++) {
            s->columns[0][r][l] = 1;
            s->columns[1][r][l] = (float)(l - before(e)) / DENOISE_WINDOW;
            s->columns[2][r][l] = (float)(r - DENOISE_WINDOW) / DENOISE_WINDOW;
        }
    }
    for (int i = 0; i < DENOISE_CENTRES * DENOISE_CENTRES; i++) {
        int cx = DENOISE_FIRST + i % DENOISE_CENTRES * DENOISE_STEP;
        int cy = DENOISE_FIRST + i / DENOISE_CENTRES * DENOISE_STEP;
        if (i % DENOISE_CENTRES == 0 && pool_cancelled(s->pool))
            return;
        if (!is_made_at(s, regression, i) || cx < (int)bounds.x0 || cy < (int)bounds.y0 || cx >= (int)bounds.x1 ||
            cy >= (int)bounds.y1)
            continue;
        struct window w = find_window(cx, cy, regression.radius, e, bounds);
        if (coloured)
            weigh(s, &w, &s->distances[i / 2], regression.colours);
        else
            weigh_alike(s, &w, e);
        if (regression.features > 0)
            weigh_features(s, &w, regression.features);
        if (coloured)
            regress_half(s, half, &w);
        else if (small)
            regress_small(s, &w);
        else
            regress_halves(s, &w);
    }
}

/* --- choice of the candidate --- */

/* The position of a pixel of the inner part in the planes of the scratch. */
static int local_of(int x, int y) {
    return (y + DENOISE_MARGIN - DENOISE_CHOICE) * LOCAL + x + DENOISE_MARGIN - DENOISE_CHOICE;
}

/* The mean of the variance over the window of a regression, in units of the mean square of the colours there: the
 * product of the halves has no noise of its own in its mean, and it is at least the square of the mean. Where no sample
 * found a rare bright path, pixels are dark and their own variance is small: both would speak for a candidate that is
 * too dark, and leave smears. */
static void find_relative_variance(struct denoise_scratch *s) {
    enum { SIDE = DENOISE_INNER, WINDOW = DENOISE_WINDOW, WIDE = SIDE + 2 * WINDOW };
    const float pixels = DENOISE_SIDE * DENOISE_SIDE;
    for (int item = 0; item < 3 * SIDE; item++) {
        int c = item % 3, y = item / 3;
        float variances[WIDE] = {0}, products[WIDE] = {0}, colours[WIDE] = {0};
        for (int j = -WINDOW; j <= WINDOW; j++) {
            int from = local_of(-WINDOW, y + j);
            const float *a = s->colour[0][c] + from, *b = s->colour[1][c] + from;
            for (int x = 0; x < WIDE; x++) {
                variances[x] += s->variance[c][from + x];
                products[x] += a[x] * b[x];
                colours[x] += 0.5F * (a[x] + b[x]);
            }
        }
        for (int x = 0; x < SIDE; x++) {
            float variance = 0, product = 0, colour = 0;
            for (int i = 0; i < DENOISE_SIDE; i++) {
                variance += variances[x + i];
                product += products[x + i];
                colour += colours[x + i];
            }
            float lowest = colour * colour / pixels + FLT_MIN;
            s->relative[c][y][x] = variance / (product > lowest ? product : lowest);
        }
    }
}

/* The variance of a channel of a half in a row: at least that of the pixels around, scaled to the first estimate. */
static void floor_variance(const struct denoise_scratch *s, int half, int c, int y, float out[DENOISE_INNER]) {
    const float *own = s->variance[c] + local_of(0, y), *first = s->estimates[0][half][c] + local_of(0, y);
    const float *relative = s->relative[c][y], largest = 1e30F;
    for (int x = 0; x < DENOISE_INNER; x++) {
        float scaled = relative[x] * (first[x] * first[x]), variance = own[x] > scaled ? own[x] : scaled;
        out[x] = variance < largest ? variance : largest;
    }
}

/* The difference between an estimate of one half and the values of the other half contains the errors of both. So
 * the difference of two such squares is the difference of the squared errors of two estimates (Bitterli et al. 2016,
 * section 5.4). Here they are those of each candidate and of the first one, in units of the variance. Its noise is that
 * of the other half times twice the difference of the estimates. */
static void compare_candidates(struct denoise_scratch *s) {
    enum { SIDE = DENOISE_INNER };
    find_relative_variance(s);
    for (int y = 0; y < SIDE; y++) {
        int from = local_of(0, y);
        float scale[SIDE], variance[3][2][SIDE];
        /* The unit of errors: the variance of both halves. */
        for (int x = 0; x < SIDE; x++)
            scale[x] = FLT_MIN;
        for (int c = 0; c < 3; c++)
            for (int h = 0; h < 2; h++) {
                floor_variance(s, h, c, y, variance[c][h]);
                for (int x = 0; x < SIDE; x++) {
                    float other = s->colour[1 - h][c][from + x];
                    scale[x] += variance[c][h][x] + colour_noise * other * other;
                }
            }
        /* The error of each candidate beyond that of the first one, and its variance. */
        for (int b = 0; b < DENOISE_CANDIDATES; b++) {
            float *errors = s->errors[b][y], *doubts = s->doubts[b][y];
            memset(errors, 0, SIDE * sizeof *errors);
            memset(doubts, 0, SIDE * sizeof *doubts);
            for (int c = 0; c < 3; c++) {
                for (int h = 0; h < 2; h++) {
                    const float *own = b < DENOISE_REGRESSIONS ? s->estimates[b][h][c] : s->colour[h][c];
                    const float *first = s->estimates[0][h][c], *other = s->colour[1 - h][c];
                    for (int x = 0; x < SIDE; x++) {
                        float a = own[from + x] - other[from + x], e = first[from + x] - other[from + x];
                        errors[x] += (a * a - e * e) / scale[x];
                        doubts[x] += 4 * (a - e) * (a - e) / scale[x] * (variance[c][h][x] / scale[x]);
                    }
                }
            }
        }
    }
}

/* The distances between the features of the pixels of a row of the block and those at an offset. */
static void compare_surfaces(const struct denoise_scratch *s, int y, int dx, int dy, float distances[DENOISE_BLOCK]) {
    int p = local_of(DENOISE_CHOICE, y + DENOISE_CHOICE), q = p + dy * LOCAL + dx;
    for (int x = 0; x < DENOISE_BLOCK; x++) {
        float z = s->feature[DENOISE_DEPTH][p + x], difference = s->feature[DENOISE_DEPTH][q + x] - z;
        distances[x] = difference * difference / (z * z / depth_unit + FLT_MIN);
    }
    for (int f = 0; f < DENOISE_DEPTH; f++) {
        float unit = f < DENOISE_NORMAL ? albedo_unit : normal_unit;
        for (int x = 0; x < DENOISE_BLOCK; x++) {
            float difference = s->feature[f][q + x] - s->feature[f][p + x];
            distances[x] += difference * difference * unit;
        }
    }
}

/* Means of errors over 7 x 7 pixels, in which pixels with other features count less. Two additions prevent that noise
 * chooses: the standard error of the mean, and a margin for candidates that use few pixels where the features do not
 * change, since such candidates are for silhouettes and small objects. */
static void score_candidates(const struct denoise_scratch *s, int y, float scores[DENOISE_CANDIDATES][DENOISE_BLOCK]) {
    enum { SIDE = 2 * DENOISE_CHOICE + 1 };
    static const float kernel[SIDE] = {1, 6, 15, 20, 15, 6, 1};
    float sums[DENOISE_BLOCK] = {0}, squares[DENOISE_CANDIDATES][DENOISE_BLOCK] = {0}, largest[DENOISE_BLOCK] = {0};
    /* Weighted sums over the window. */
    memset(scores, 0, DENOISE_CANDIDATES * sizeof *scores);
    for (int i = 0; i < SIDE * SIDE; i++) {
        int dx = i % SIDE, dy = i / SIDE;
        float distances[DENOISE_BLOCK], weights[DENOISE_BLOCK];
        compare_surfaces(s, y, dx - DENOISE_CHOICE, dy - DENOISE_CHOICE, distances);
        for (int x = 0; x < DENOISE_BLOCK; x++) {
            float distance = distances[x] / similar_limit;
            weights[x] = kernel[dx] * kernel[dy] / (1 + distance * distance);
            largest[x] = distances[x] > largest[x] ? distances[x] : largest[x];
            sums[x] += weights[x];
        }
        for (int b = 1; b < DENOISE_CANDIDATES; b++) {
            const float *errors = s->errors[b][y + dy] + dx, *doubts = s->doubts[b][y + dy] + dx;
            for (int x = 0; x < DENOISE_BLOCK; x++) {
                scores[b][x] += weights[x] * errors[x];
                squares[b][x] += weights[x] * weights[x] * doubts[x];
            }
        }
    }
    /* The mean error, its standard error and the margin. */
    for (int b = 1; b < DENOISE_CANDIDATES; b++) {
        float margin = b == DENOISE_WIDE ? 0 : detail_margin;
        float always = b == DENOISE_REGRESSIONS ? colour_margin : b == DENOISE_SMALL ? small_margin : 0;
        for (int x = 0; x < DENOISE_BLOCK; x++) {
            float change = largest[x] / change_limit;
            scores[b][x] = (scores[b][x] + doubt_errors * sqrtf(squares[b][x])) / sums[x] +
                           margin / (1 + change * change) + always;
        }
    }
}
_Static_assert((int)DENOISE_CHOICE == 3, "the kernel of score_candidates has seven numbers");

const struct denoise_kernels KERNELS = {filter_features,    compare,         find_changes, regress,
                                        compare_candidates, score_candidates};
