/* Stages over the whole picture, each one pool_run over blocks or rows, each writing planes that the next one reads:
 * colours without outliers, their variance, features without noise, then regressions.
 *
 * The regression of a centre p fits, in a window round it, the colour of one half of the samples to a linear function
 * of the features; pixels count by their likeness to p in the other half (cross-filtering: weights and colours have
 * independent errors, so that noise does not choose the pixels that agree with it). What a regression says about each
 * pixel of its window is taken into account there (collaborative filtering), so centres on every second row and column
 * are enough. This is done for two bandwidths of the likeness; each place takes the one with the smaller error.
 *
 * Numbers are floats and sums have a fixed order: the result does not depend on blocks, threads or instruction sets. */
#include "render/denoise.h"

#include "base/mem.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum {
    BLOCK = 64,
    WINDOW = 8, /* radius of a regression */
    WINDOW_SIDE = 2 * WINDOW + 1,
    WINDOW_PIXELS = WINDOW_SIDE * WINDOW_SIDE,
    PATCH = 3,  /* radius of the patches that are compared */
    STEP = 2,   /* between centres */
    CHOICE = 4, /* radius of the mean that chooses between bandwidths */
    INNER = BLOCK + 2 * CHOICE,
    MARGIN = CHOICE + 2 * WINDOW + PATCH,
    LOCAL = BLOCK + 2 * MARGIN,            /* side of a block with everything that it reads */
    CENTRES = (INNER + 2 * WINDOW) / STEP, /* on a side of a block */
    COMPARED = INNER + 2 * WINDOW + 2 * PATCH,
    TERMS = 1 + DENOISE_FEATURES + 2, /* of the linear function: constant, features, position */
    PADDED_PIXELS = WINDOW_PIXELS + 8,
    BANDWIDTHS = 2,
    FEATURE_WINDOW = 4, /* radius of the filter of features */
    FEATURE_LOCAL = BLOCK + 2 * FEATURE_WINDOW + 2,
};
_Static_assert((int)MARGIN + 3 <= (int)DENOISE_RIM, "the rim is less than what a pixel depends on");
_Static_assert(2 * (int)WINDOW + (int)FEATURE_WINDOW + 1 <= (int)DENOISE_RIM, "the same of features");

/* Found by measurement (bench/denoise.sh). */
static const float noise_scale = 1.44F;  /* of the variance in distances of patches: k^2 */
static const float colour_noise = 1e-3F; /* the same of the square of colours */
static const struct bandwidth {
    int radius;  /* of the window, at most WINDOW */
    float scale; /* of distances */
} bandwidths[BANDWIDTHS] = {{WINDOW, 1}, {5, 4}};
static const double ridge = 5e-4;     /* of the sum of weights */
static const float choice_slope = 12; /* how firmly the smaller error is chosen */

/* A picture as planes of floats. */
struct denoiser {
    int width, height;
    const struct denoise_source *source;
    struct pool *pool;
    float (*out)[3];
    float *loaded[2][3]; /* light of the halves without glow */
    float *colour[2][3]; /* the same without outliers */
    float *variance[3];  /* of a half */
    float *feature[DENOISE_FEATURES];
    float *mean[3], *noise[3];  /* of a group of features: what was measured, and its variance */
    int first_feature, group;   /* which, and how many */
    struct denoise_pixel *rows; /* one of each worker */
    struct scratch *scratch;
};

/* Of a worker. */
struct scratch {
    float colour[2][3][LOCAL * LOCAL], variance[3][LOCAL * LOCAL], feature[DENOISE_FEATURES][LOCAL * LOCAL];
    float feature_mean[3][FEATURE_LOCAL * FEATURE_LOCAL], feature_noise[3][FEATURE_LOCAL * FEATURE_LOCAL];
    float unlikeness[COMPARED * COMPARED];
    float distances[CENTRES * CENTRES][WINDOW_PIXELS]; /* between patches */
    float sums[4][INNER * INNER];                      /* of colours and weights */
    float estimates[BANDWIDTHS][2][3][INNER * INNER];
    float errors[INNER * INNER];
    /* Of one regression: the pixels that count, then pixels of weight 0 up to a multiple of 8. */
    float terms[TERMS][PADDED_PIXELS], values[3][PADDED_PIXELS];
    float weight[PADDED_PIXELS], weighted[PADDED_PIXELS];
    int at[PADDED_PIXELS];
};

static int max_int(int a, int b) {
    return a > b ? a : b;
}

static int min_int(int a, int b) {
    return a < b ? a : b;
}

static int clamp_int(int x, int low, int high) {
    return x < low ? low : x > high ? high : x;
}

static size_t pixel_at(const struct denoiser *d, int x, int y) {
    return (size_t)y * (size_t)d->width + (size_t)x;
}

/* The nearest pixel of the picture. */
static size_t nearest_at(const struct denoiser *d, int x, int y) {
    return pixel_at(d, clamp_int(x, 0, d->width - 1), clamp_int(y, 0, d->height - 1));
}

/* A square of a plane; outside of the picture its nearest pixel. */
static void copy_plane(const struct denoiser *d, const float *plane, int x0, int y0, int side, float *local) {
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++)
            local[y * side + x] = plane[nearest_at(d, x0 + x, y0 + y)];
}

/* Whatever comes in, squares of sums stay finite. */
static float bounded(float x) {
    const float limit = 1e15F;
    return fabsf(x) <= limit ? x : x > limit ? limit : x < -limit ? -limit : 0;
}

/* The pixels of a row. */
static const struct denoise_pixel *get_row(struct denoiser *d, uint32_t y, int worker) {
    struct denoise_pixel *row = d->rows + (size_t)worker * (size_t)d->width;
    d->source->row(d->source->context, y, row);
    return row;
}

/* --- colours: outliers and variance --- */

static void load_colours(void *context, uint32_t y, int worker) {
    struct denoiser *d = context;
    const struct denoise_pixel *row = get_row(d, y, worker);
    for (int x = 0; x < d->width; x++)
        for (int h = 0; h < 2; h++)
            for (int c = 0; c < 3; c++)
                d->loaded[h][c][pixel_at(d, x, (int)y)] = bounded(row[x].colour[h][c] - row[x].glow[h][c]);
}

static float brightness(float *const colour[3], size_t at) {
    return fabsf(colour[0][at]) + fabsf(colour[1][at]) + fabsf(colour[2][at]);
}

/* The brightest that speaks for the brightness of a pixel of one half: the other half there, its neighbours in the
 * other half, and all but the brightest of its neighbours in its own. */
static float brightest_support(const struct denoiser *d, int half, int x, int y) {
    size_t at = pixel_at(d, x, y);
    float first = 0, second = 0, others = brightness(d->loaded[1 - half], at);
    for (int j = -1; j <= 1; j++) {
        for (int i = -1; i <= 1; i++) {
            size_t q = nearest_at(d, x + i, y + j);
            if (q == at)
                continue;
            float own = brightness(d->loaded[half], q), other = brightness(d->loaded[1 - half], q);
            others = other > others ? other : others;
            second = own > first ? first : own > second ? own : second;
            first = own > first ? own : first;
        }
    }
    return second > others ? second : others;
}

/* What is more than twice as bright as all that speaks for it is scaled down to that: single paths of little chance
 * would become blotches. */
static void remove_outliers(void *context, uint32_t y, int worker) {
    struct denoiser *d = context;
    (void)worker;
    for (int x = 0; x < d->width; x++) {
        size_t at = pixel_at(d, x, (int)y);
        for (int h = 0; h < 2; h++) {
            float limit = 2 * brightest_support(d, h, x, (int)y), own = brightness(d->loaded[h], at);
            float scale = own > limit ? limit / own : 1;
            for (int c = 0; c < 3; c++)
                d->colour[h][c][at] = scale * d->loaded[h][c][at];
        }
    }
}

/* Half the squared difference of the halves, smoothed. */
static void estimate_variance(void *context, uint32_t y, int worker) {
    static const float kernel[5] = {0.0625F, 0.25F, 0.375F, 0.25F, 0.0625F};
    struct denoiser *d = context;
    (void)worker;
    for (int x = 0; x < d->width; x++) {
        float sums[3] = {0};
        for (int j = -2; j <= 2; j++) {
            for (int i = -2; i <= 2; i++) {
                size_t q = nearest_at(d, x + i, (int)y + j);
                float w = 0.5F * kernel[j + 2] * kernel[i + 2];
                for (int c = 0; c < 3; c++) {
                    float difference = d->colour[0][c][q] - d->colour[1][c][q];
                    sums[c] += w * difference * difference;
                }
            }
        }
        for (int c = 0; c < 3; c++)
            d->variance[c][pixel_at(d, x, (int)y)] = sums[c];
    }
}

/* --- features: non-local means by their own variance --- */

static void load_features(void *context, uint32_t y, int worker) {
    struct denoiser *d = context;
    const struct denoise_pixel *row = get_row(d, y, worker);
    for (int x = 0; x < d->width; x++) {
        size_t at = pixel_at(d, x, (int)y);
        for (int i = 0; i < d->group; i++) {
            float a = bounded(row[x].features[0][d->first_feature + i]);
            float b = bounded(row[x].features[1][d->first_feature + i]);
            d->mean[i][at] = 0.5F * (a + b);
            d->noise[i][at] = 0.25F * (a - b) * (a - b);
        }
    }
}

/* exp(-x) of a distance x, nearly; 0 from 8 on. */
static float weight_of(float distance) {
    float x = 1 - (distance > 0 ? distance : 0) * 0.125F;
    x = x > 0 ? x : 0;
    x *= x;
    x *= x;
    return x * x;
}

/* Squared differences of the block and what lies (dx, dy) farther, less what noise explains, in units of noise; noise
 * is at least 0.003 of the range of albedo and normals, and 0.001 of a depth. */
static void compare_features(const struct denoiser *d, struct scratch *s, int dx, int dy) {
    bool depth = d->first_feature == DENOISE_DEPTH;
    for (int y = 0; y < BLOCK + 2; y++) {
        int p = (FEATURE_WINDOW + y) * FEATURE_LOCAL + FEATURE_WINDOW, q = p + dy * FEATURE_LOCAL + dx;
        float above[BLOCK + 2] = {0}, below[BLOCK + 2] = {0};
        for (int i = 0; i < d->group; i++) {
            const float *mean = s->feature_mean[i], *noise = s->feature_noise[i];
            float relative = depth ? 1e-6F : 0;
            for (int x = 0; x < BLOCK + 2; x++) {
                float vp = noise[p + x], vq = noise[q + x], u = mean[p + x], delta = u - mean[q + x];
                above[x] += delta * delta - (vp + (vp < vq ? vp : vq));
                below[x] += vp + vq + relative * u * u;
            }
        }
        for (int x = 0; x < BLOCK + 2; x++)
            s->unlikeness[y * (BLOCK + 2) + x] = above[x] / (below[x] + 1e-5F);
    }
}

/* Adds what lies (dx, dy) farther by the likeness of patches of 3 x 3 pixels. */
static void add_features(const struct denoiser *d, struct scratch *s, int dx, int dy, const int bounds[4]) {
    for (int y = 0; y < BLOCK; y++) {
        const float *above = s->unlikeness + y * (BLOCK + 2), *row = above + BLOCK + 2, *under = row + BLOCK + 2;
        int q = (FEATURE_WINDOW + 1 + y + dy) * FEATURE_LOCAL + FEATURE_WINDOW + 1 + dx;
        float columns[BLOCK + 2];
        if (y + dy < bounds[1] || y + dy >= bounds[3])
            continue;
        for (int x = 0; x < BLOCK + 2; x++)
            columns[x] = above[x] + row[x] + under[x];
        for (int x = 0; x < BLOCK; x++) {
            bool inside = x + dx >= bounds[0] && x + dx < bounds[2];
            float w = weight_of((columns[x] + columns[x + 1] + columns[x + 2]) / 9);
            w = inside ? (dx == 0 && dy == 0 ? 1 : w) : 0;
            s->sums[3][y * BLOCK + x] += w;
            for (int i = 0; i < d->group; i++)
                s->sums[i][y * BLOCK + x] += w * s->feature_mean[i][q + x];
        }
    }
}

static void filter_features(void *context, uint32_t item, int worker) {
    struct denoiser *d = context;
    struct scratch *s = d->scratch + worker;
    int across = (d->width + BLOCK - 1) / BLOCK, bx = (int)item % across * BLOCK, by = (int)item / across * BLOCK;
    const int bounds[4] = {-bx, -by, d->width - bx, d->height - by}; /* of the picture, from the block */
    for (int i = 0; i < d->group; i++) {
        copy_plane(d, d->mean[i], bx - FEATURE_WINDOW - 1, by - FEATURE_WINDOW - 1, FEATURE_LOCAL, s->feature_mean[i]);
        copy_plane(d, d->noise[i], bx - FEATURE_WINDOW - 1, by - FEATURE_WINDOW - 1, FEATURE_LOCAL,
                   s->feature_noise[i]);
    }
    memset(s->sums, 0, sizeof s->sums);
    for (int dy = -FEATURE_WINDOW; dy <= FEATURE_WINDOW; dy++) {
        for (int dx = -FEATURE_WINDOW; dx <= FEATURE_WINDOW; dx++) {
            compare_features(d, s, dx, dy);
            add_features(d, s, dx, dy, bounds);
        }
    }
    for (int y = 0; y < BLOCK && by + y < d->height; y++)
        for (int x = 0; x < BLOCK && bx + x < d->width; x++)
            for (int i = 0; i < d->group; i++)
                d->feature[d->first_feature + i][pixel_at(d, bx + x, by + y)] =
                    s->sums[i][y * BLOCK + x] / s->sums[3][y * BLOCK + x];
}

/* --- regressions --- */

/* How unlike the pixels of the block are those that lie (dx, dy) farther: squared difference of colours less what
 * variance explains, in units of variance (Rousselle et al. 2012, equation 9). */
static void compare(struct scratch *s, float *const colour[3], int dx, int dy) {
    enum { FIRST = WINDOW };
    for (int y = 0; y < COMPARED; y++) {
        int p = (FIRST + y) * LOCAL + FIRST, q = p + dy * LOCAL + dx;
        float *out = s->unlikeness + y * COMPARED;
        for (int x = 0; x < COMPARED; x++) {
            float above = 0, below = FLT_MIN;
            for (int c = 0; c < 3; c++) {
                float u = colour[c][p + x], v = colour[c][q + x], delta = u - v;
                float vp = s->variance[c][p + x], vq = s->variance[c][q + x];
                above += delta * delta - (vp + (vp < vq ? vp : vq));
                below += noise_scale * (vp + vq) + colour_noise * (u * u + v * v);
            }
            out[x] = above / below;
        }
    }
}

static void average_patches(struct scratch *s, int k) {
    float columns[COMPARED];
    for (int j = 0; j < CENTRES; j++) {
        memset(columns, 0, sizeof columns);
        for (int v = 0; v < 2 * PATCH + 1; v++) {
            const float *row = s->unlikeness + (j * STEP + v) * COMPARED;
            for (int x = 0; x < COMPARED; x++)
                columns[x] += row[x];
        }
        for (int i = 0; i < CENTRES; i++) {
            float sum = 0;
            for (int u = 0; u < 2 * PATCH + 1; u++)
                sum += columns[i * STEP + u];
            s->distances[j * CENTRES + i][k] = sum / ((2 * PATCH + 1) * (2 * PATCH + 1));
        }
    }
}

typedef float four __attribute__((vector_size(16)));

/* n is a multiple of 8. */
static float dot(const float *a, const float *b, int n) {
    four s = {0}, t = {0};
    for (int i = 0; i < n; i += 8) {
        four u, v, w, x;
        memcpy(&u, a + i, sizeof u);
        memcpy(&v, b + i, sizeof v);
        memcpy(&w, a + i + 4, sizeof w);
        memcpy(&x, b + i + 4, sizeof x);
        s += u * v;
        t += w * x;
    }
    s += t;
    return (s[0] + s[1]) + (s[2] + s[3]);
}

/* Cholesky; the matrix is symmetric and positive. Solves for three right sides in place. */
static bool solve(double m[TERMS][TERMS], double r[TERMS][3], int n) {
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = m[i][j];
            for (int k = 0; k < j; k++)
                sum -= m[i][k] * m[j][k];
            if (i == j) {
                if (!(sum > 0))
                    return false;
                m[i][i] = sqrt(sum);
            } else {
                m[i][j] = sum / m[j][j];
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        for (int i = 0; i < n; i++) {
            double sum = r[i][c];
            for (int k = 0; k < i; k++)
                sum -= m[i][k] * r[k][c];
            r[i][c] = sum / m[i][i];
        }
        for (int i = n - 1; i >= 0; i--) {
            double sum = r[i][c];
            for (int k = i + 1; k < n; k++)
                sum -= m[k][i] * r[k][c];
            r[i][c] = sum / m[i][i];
        }
    }
    return true;
}

/* The pixels of the window of a centre that count, without those outside of the picture. */
static int gather(struct scratch *s, const float *distances, struct bandwidth bandwidth, int cx, int cy,
                  const int bounds[4]) {
    int count = 0, radius = bandwidth.radius;
    int x0 = max_int(cx - radius, bounds[0]), x1 = min_int(cx + radius + 1, bounds[2]);
    int y0 = max_int(cy - radius, bounds[1]), y1 = min_int(cy + radius + 1, bounds[3]);
    for (int y = y0; y < y1; y++) {
        const float *row = distances + (y - cy + WINDOW) * WINDOW_SIDE + WINDOW - cx;
        for (int x = x0; x < x1; x++) {
            float w = weight_of(bandwidth.scale * row[x]);
            s->at[count] = y * LOCAL + x;
            s->weight[count] = w;
            count += w > 1e-3F;
        }
    }
    for (int i = count; i % 8 != 0; i++) {
        s->at[i] = cy * LOCAL + cx;
        s->weight[i] = 0;
    }
    return count;
}

/* Differences to the centre, in units of the largest one in the window, or of a small one if that is larger: 0.02 of
 * albedo and normals, 1/200 of a depth. */
static void fill_feature(struct scratch *s, int feature, int centre, int padded) {
    float *term = s->terms[1 + feature], middle = s->feature[feature][centre], largest = 0;
    for (int i = 0; i < padded; i++) {
        term[i] = s->feature[feature][s->at[i]] - middle;
        float size = fabsf(term[i]);
        largest = size > largest ? size : largest;
    }
    float smallest = feature == DENOISE_DEPTH ? 0.005F * fabsf(middle) + FLT_MIN : 0.02F;
    float scale = 1 / (largest > smallest ? largest : smallest);
    for (int i = 0; i < padded; i++)
        term[i] *= scale;
}

static void fill_terms(struct scratch *s, float *const colour[3], int cx, int cy, int padded) {
    for (int i = 0; i < padded; i++) {
        s->terms[0][i] = 1;
        s->terms[TERMS - 2][i] = (float)(s->at[i] % LOCAL - cx) * (1.0F / WINDOW);
        s->terms[TERMS - 1][i] = (float)(s->at[i] / LOCAL - cy) * (1.0F / WINDOW);
    }
    for (int f = 0; f < DENOISE_FEATURES; f++)
        fill_feature(s, f, cy * LOCAL + cx, padded);
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < padded; i++)
            s->values[c][i] = colour[c][s->at[i]];
}

/* The coefficients of the terms for each channel by weighted least squares; the ridge keeps terms small that the window
 * does not determine. */
static bool fit(struct scratch *s, int padded, double coefficients[TERMS][3]) {
    double matrix[TERMS][TERMS];
    for (int i = 0; i < TERMS; i++) {
        for (int k = 0; k < padded; k++)
            s->weighted[k] = s->weight[k] * s->terms[i][k];
        for (int j = 0; j <= i; j++)
            matrix[i][j] = (double)dot(s->weighted, s->terms[j], padded);
        for (int c = 0; c < 3; c++)
            coefficients[i][c] = (double)dot(s->weighted, s->values[c], padded);
    }
    for (int i = 1; i < TERMS; i++)
        matrix[i][i] += ridge * matrix[0][0];
    return solve(matrix, coefficients, TERMS);
}

/* Adds what a regression says about its pixels to those of the block. */
static void predict(struct scratch *s, double coefficients[TERMS][3], int count, int padded) {
    for (int c = 0; c < 3; c++) {
        float *value = s->values[c];
        memset(value, 0, (size_t)padded * sizeof *value);
        for (int i = 0; i < TERMS; i++) {
            float b = (float)coefficients[i][c];
            for (int k = 0; k < padded; k++)
                value[k] += b * s->terms[i][k];
        }
    }
    for (int k = 0; k < count; k++) {
        int x = s->at[k] % LOCAL - (MARGIN - CHOICE), y = s->at[k] / LOCAL - (MARGIN - CHOICE);
        if (x < 0 || y < 0 || x >= INNER || y >= INNER)
            continue;
        for (int c = 0; c < 3; c++)
            s->sums[c][y * INNER + x] += s->weight[k] * s->values[c][k];
        s->sums[3][y * INNER + x] += s->weight[k];
    }
}

/* Where a pixel of the inner part is in the planes of the scratch. */
static int local_of(int inner) {
    return (inner / INNER + MARGIN - CHOICE) * LOCAL + inner % INNER + MARGIN - CHOICE;
}

/* What both halves have measured at a pixel and its eight neighbours. */
static void local_range(const struct scratch *s, int channel, int local, float *low, float *high) {
    *low = *high = s->colour[0][channel][local];
    for (int half = 0; half < 2; half++) {
        for (int k = 0; k < 9; k++) {
            float value = s->colour[half][channel][local + (k / 3 - 1) * LOCAL + k % 3 - 1];
            *low = value < *low ? value : *low;
            *high = value > *high ? value : *high;
        }
    }
}

/* Of one half: the mean of what the regressions say. A pixel that is like no centre keeps its colour. Nothing is
 * darker or brighter than all that was measured there: regressions overshoot beside lights. */
static float estimate(const struct scratch *s, int half, int channel, int at) {
    const float own = 0.01F;
    int local = local_of(at);
    float colour = s->colour[half][channel][local], low, high;
    float value = (s->sums[channel][at] + own * colour) / (s->sums[3][at] + own);
    if (!isfinite(value))
        return colour;
    local_range(s, channel, local, &low, &high);
    return value < low ? low : value > high ? high : value;
}

/* All regressions that the block reads, for one bandwidth. */
static void regress_all(struct scratch *s, float *const colour[3], struct bandwidth bandwidth, const int bounds[4]) {
    memset(s->sums, 0, sizeof s->sums);
    for (int i = 0; i < CENTRES * CENTRES; i++) {
        int cx = WINDOW + PATCH + i % CENTRES * STEP, cy = WINDOW + PATCH + i / CENTRES * STEP;
        double coefficients[TERMS][3];
        if (cx < bounds[0] || cy < bounds[1] || cx >= bounds[2] || cy >= bounds[3])
            continue;
        int count = gather(s, s->distances[i], bandwidth, cx, cy, bounds), padded = (count + 7) / 8 * 8;
        fill_terms(s, colour, cx, cy, padded);
        if (fit(s, padded, coefficients))
            predict(s, coefficients, count, padded);
    }
}

/* One half of the samples in a block; bounds: of the picture, in the coordinates of the block with its margin. */
static void regress_half(struct scratch *s, int half, const int bounds[4]) {
    float *colour[3], *other[3];
    for (int c = 0; c < 3; c++) {
        colour[c] = s->colour[half][c];
        other[c] = s->colour[1 - half][c];
    }
    for (int k = 0; k < WINDOW_PIXELS; k++) {
        compare(s, other, k % WINDOW_SIDE - WINDOW, k / WINDOW_SIDE - WINDOW);
        average_patches(s, k);
    }
    for (int b = 0; b < BANDWIDTHS; b++) {
        regress_all(s, colour, bandwidths[b], bounds);
        for (int c = 0; c < 3; c++)
            for (int at = 0; at < INNER * INNER; at++)
                s->estimates[b][half][c][at] = estimate(s, half, c, at);
    }
}

/* --- choice of the bandwidth --- */

/* What a half says beyond the other one has the error of both; so the difference of two such squares is that of the
 * errors of two estimates (Bitterli et al. 2016, section 5.4). Here of the narrow and the wide bandwidth, in units of
 * the variance. */
static void compare_bandwidths(struct scratch *s) {
    for (int at = 0; at < INNER * INNER; at++) {
        int local = local_of(at);
        float error = 0, scale = FLT_MIN;
        for (int c = 0; c < 3; c++) {
            for (int h = 0; h < 2; h++) {
                float other = s->colour[1 - h][c][local];
                float wide = s->estimates[0][h][c][at] - other, narrow = s->estimates[1][h][c][at] - other;
                error += narrow * narrow - wide * wide;
                scale += s->variance[c][local] + colour_noise * other * other;
            }
        }
        s->errors[at] = error / scale;
    }
}

/* The share of the narrow bandwidth at a pixel of the block. */
static float narrow_share(const struct scratch *s, int x, int y) {
    float sum = 0;
    for (int j = 0; j <= 2 * CHOICE; j++)
        for (int i = 0; i <= 2 * CHOICE; i++)
            sum += s->errors[(y + j) * INNER + x + i];
    float share = 0.5F - choice_slope * sum / ((2 * CHOICE + 1) * (2 * CHOICE + 1));
    return share > 1 ? 1 : share > 0 ? share : 0;
}

static void store_pixel(const struct scratch *s, int x, int y, float out[3]) {
    int at = (y + CHOICE) * INNER + x + CHOICE;
    float share = narrow_share(s, x, y);
    for (int c = 0; c < 3; c++) {
        float wide = 0.5F * (s->estimates[0][0][c][at] + s->estimates[0][1][c][at]);
        float narrow = 0.5F * (s->estimates[1][0][c][at] + s->estimates[1][1][c][at]);
        out[c] = wide + share * (narrow - wide);
    }
}

/* Blocks begin where centres have even coordinates in the whole picture. */
static void regress_block(void *context, uint32_t item, int worker) {
    struct denoiser *d = context;
    struct scratch *s = d->scratch + worker;
    int left = -(int)(d->source->x0 % STEP), top = -(int)(d->source->y0 % STEP);
    int across = (d->width - left + BLOCK - 1) / BLOCK;
    int bx = left + (int)item % across * BLOCK, by = top + (int)item / across * BLOCK;
    int x0 = bx - MARGIN, y0 = by - MARGIN;
    const int bounds[4] = {-x0, -y0, d->width - x0, d->height - y0};
    for (int c = 0; c < 3; c++) {
        copy_plane(d, d->colour[0][c], x0, y0, LOCAL, s->colour[0][c]);
        copy_plane(d, d->colour[1][c], x0, y0, LOCAL, s->colour[1][c]);
        copy_plane(d, d->variance[c], x0, y0, LOCAL, s->variance[c]);
    }
    for (int f = 0; f < DENOISE_FEATURES; f++)
        copy_plane(d, d->feature[f], x0, y0, LOCAL, s->feature[f]);
    for (int half = 0; half < 2 && !pool_cancelled(d->pool); half++)
        regress_half(s, half, bounds);
    compare_bandwidths(s);
    for (int y = by > 0 ? by : 0; y < by + BLOCK && y < d->height; y++)
        for (int x = bx > 0 ? bx : 0; x < bx + BLOCK && x < d->width; x++)
            store_pixel(s, x - bx, y - by, d->out[pixel_at(d, x, y)]);
}

static void add_glow(void *context, uint32_t y, int worker) {
    struct denoiser *d = context;
    const struct denoise_pixel *row = get_row(d, y, worker);
    for (int x = 0; x < d->width; x++) {
        float *out = d->out[pixel_at(d, x, (int)y)], share = row[x].share;
        for (int c = 0; c < 3; c++)
            out[c] += share * row[x].glow[0][c] + (1 - share) * row[x].glow[1][c];
    }
}

/* --- the whole --- */

static bool make_plane(const struct denoiser *d, float **plane) {
    *plane = mem_alloc((size_t)d->width * (size_t)d->height * sizeof **plane);
    return *plane != NULL;
}

static void free_plane(float **plane) {
    mem_free(*plane);
    *plane = NULL;
}

static bool run(struct denoiser *d, uint32_t count, pool_function *fn, struct error *error) {
    return pool_run(d->pool, count, fn, d) || error_set(error, ERROR_CANCELLED, "stopped while denoising");
}

static bool no_memory(struct error *error) {
    return error_no_memory(error, "a picture that is denoised");
}

static bool denoise_colours(struct denoiser *d, struct error *error) {
    for (int c = 0; c < 3; c++)
        if (!make_plane(d, &d->loaded[0][c]) || !make_plane(d, &d->loaded[1][c]) || !make_plane(d, &d->colour[0][c]) ||
            !make_plane(d, &d->colour[1][c]) || !make_plane(d, &d->variance[c]))
            return no_memory(error);
    uint32_t rows = d->source->height;
    if (!run(d, rows, load_colours, error) || !run(d, rows, remove_outliers, error) ||
        !run(d, rows, estimate_variance, error))
        return false;
    for (int c = 0; c < 3; c++) {
        free_plane(&d->loaded[0][c]);
        free_plane(&d->loaded[1][c]);
    }
    return true;
}

static bool denoise_features(struct denoiser *d, struct error *error) {
    static const int groups[][2] = {{DENOISE_ALBEDO, 3}, {DENOISE_NORMAL, 3}, {DENOISE_DEPTH, 1}};
    for (int i = 0; i < 3; i++)
        if (!make_plane(d, &d->mean[i]) || !make_plane(d, &d->noise[i]))
            return no_memory(error);
    uint32_t blocks = (d->source->width + BLOCK - 1) / BLOCK * ((d->source->height + BLOCK - 1) / BLOCK);
    for (int g = 0; g < 3; g++) {
        d->first_feature = groups[g][0];
        d->group = groups[g][1];
        for (int i = 0; i < d->group; i++)
            if (!make_plane(d, &d->feature[d->first_feature + i]))
                return no_memory(error);
        if (!run(d, d->source->height, load_features, error) || !run(d, blocks, filter_features, error))
            return false;
    }
    for (int i = 0; i < 3; i++) {
        free_plane(&d->mean[i]);
        free_plane(&d->noise[i]);
    }
    return true;
}

static bool denoise_all(struct denoiser *d, struct error *error) {
    const struct denoise_source *source = d->source;
    size_t workers = (size_t)pool_workers(d->pool);
    d->rows = mem_alloc_zero(workers * source->width, sizeof *d->rows);
    d->scratch = mem_alloc_zero(workers, sizeof *d->scratch);
    if (!d->rows || !d->scratch)
        return no_memory(error);
    if (!denoise_colours(d, error) || !denoise_features(d, error))
        return false;
    uint32_t across = (source->width + source->x0 % STEP + BLOCK - 1) / BLOCK;
    uint32_t down = (source->height + source->y0 % STEP + BLOCK - 1) / BLOCK;
    return run(d, across * down, regress_block, error) && run(d, source->height, add_glow, error);
}

bool denoise(const struct denoise_source *source, struct pool *pool, float (*out)[3], struct error *error) {
    struct denoiser d = {.source = source, .out = out, .pool = pool};
    d.width = (int)source->width;
    d.height = (int)source->height;
    bool ok = denoise_all(&d, error);
    for (int c = 0; c < 3; c++) {
        for (int half = 0; half < 2; half++) {
            mem_free(d.loaded[half][c]);
            mem_free(d.colour[half][c]);
        }
        mem_free(d.variance[c]);
        mem_free(d.mean[c]);
        mem_free(d.noise[c]);
    }
    for (int f = 0; f < DENOISE_FEATURES; f++)
        mem_free(d.feature[f]);
    mem_free(d.rows);
    mem_free(d.scratch);
    return ok;
}
