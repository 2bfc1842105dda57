/* Stages over the whole picture. Each stage is one pool_run over blocks or rows and writes planes that the next
 * stage reads: colours without outliers, their variance, features without noise, then regressions.
 *
 * In a window around a centre p, the regression fits the colour of one half of the samples to a linear function of
 * the features. The weight of each pixel is its similarity to p in the other half (cross-filtering): weights and
 * colours then have independent errors, so noise does not select pixels that agree with it. Each regression also
 * predicts the other pixels of its window, and these predictions are averaged (collaborative filtering), so centres
 * on every second row and column are enough, and every second of these where colours count: they are like the black
 * squares of a chess board. This is done for several windows and weights, and each pixel prefers those with the
 * smallest error. A large window in which similar colours count more is for surfaces. Smaller windows and weights by
 * the similarity of features are for silhouettes, small objects and the rims of glass, where few pixels are alike; the
 * noisy colour itself is the last candidate. Regressions for details are made only where features change. Where colours
 * do not count, both halves have the same weights, and one matrix serves both.
 *
 * A window cannot remove noise that is wider than itself. So the picture is also denoised at half of its width and
 * height. The result for each mean of four pixels corrects these pixels (M. Delbracio et al., "Boosting Monte Carlo
 * Rendering by Ray Histogram Fusion", ACM Transactions on Graphics 2014, section 5).
 *
 * At silhouettes few pixels are alike, and these estimates lose contrast. The residuals, colours minus estimates, show
 * it: their weighted means are larger than noise explains, and the two halves agree. There they are added, twice (J.
 * Tukey, "Exploratory Data Analysis", 1977: twicing).
 *
 * Numbers are floats and sums have a fixed order: the result does not depend on blocks, threads or instruction sets. */
#include "denoise/denoise.h"

#include "base/isa.h"
#include "base/mem.h"
#include "denoise/denoise_residuals_internal.h"
#include "denoise/denoise_run_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum {
    BLOCK = DENOISE_BLOCK,
    LOCAL = DENOISE_LOCAL,
    MARGIN = DENOISE_MARGIN,
    CHOICE = DENOISE_CHOICE,
    REGRESSIONS = DENOISE_REGRESSIONS,
    CANDIDATES = DENOISE_CANDIDATES,
    ALIGNMENT = 4,       /* of blocks in the whole picture: steps between centres divide it */
    ROWS = 16,           /* that are finished together */
    STRIP = 128,         /* pixels of a row of which the sums of columns are kept */
    VARIANCE_WINDOW = 4, /* radius of the mean that compares two estimates of the variance */
    RESIDUAL_PASSES = 2,
};
/* Two pixels of the coarser level and the pixels that they depend on; levels begin at even pixels of finer ones. */
_Static_assert((int)LEVELS == 2 && 2 * ((int)MARGIN + 1) + 2 + (int)VARIANCE_WINDOW + 1 +
                                           (int)RESIDUAL_PASSES * (int)DENOISE_RESIDUAL_WINDOW +
                                           (int)DENOISE_EVIDENCE_WINDOW + 1 <=
                                       (int)DENOISE_RIM,
               "the rim is less than what a pixel depends on");
_Static_assert((int)DENOISE_FEATURE_WINDOW + 2 <= (int)DENOISE_PATCH + (int)VARIANCE_WINDOW + 1,
               "the same of features and glow");

/* Found by measurement (bench/denoise.sh). */
static const struct denoise_regression regressions[REGRESSIONS] = {{DENOISE_WINDOW, 2, 2.4F, 0, .details = false},
                                                                   {4, 2, 5, 0.5F, .details = true},
                                                                   {DENOISE_WINDOW, 4, 0, 0.3F, .details = false},
                                                                   {2, 2, 0, 0, .details = true}};
static const float correction_limit = 0.3F; /* of squared differences to a coarser pixel, in units of its variance */
static const float support_errors = 4;      /* of pixels that are brighter or darker than all neighbours */
static const float albedo_errors = 2;       /* of albedo, of which a detail is no more than noise */
static const float same_depth = 0.03F;      /* relative difference of depths on one surface */
static const float choice_slope = 4;        /* how strongly the candidate with the smallest error is preferred */

static void copy_plane(const struct level *d, const float *plane, int x0, int y0, int side, float *local) {
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++)
            local[y * side + x] = plane[nearest_at(d, x0 + x, y0 + y)];
}

/* The part of such a square that is in the picture. */
static struct film_rectangle bounds_of(const struct level *d, int x0, int y0, int side) {
    return (struct film_rectangle){(uint32_t)clamp_int(-x0, 0, side), (uint32_t)clamp_int(-y0, 0, side),
                                   (uint32_t)clamp_int(d->width - x0, 0, side),
                                   (uint32_t)clamp_int(d->height - y0, 0, side)};
}

/* Limits all numbers so that sums of their squares stay finite. */
static float bounded(float x) {
    const float limit = 1e15F;
    return fabsf(x) <= limit ? x : x > limit ? limit : x < -limit ? -limit : 0;
}

/* The pixels of a row; slot 0 to 2: of the rows that the worker keeps, the one that is replaced. */
static const struct denoise_pixel *get_row(struct denoise_run *d, uint32_t y, int worker, int slot) {
    struct denoise_pixel *row = d->rows + (3 * (size_t)worker + (size_t)slot) * (size_t)d->levels[0].width;
    d->source->row(d->source->context, y, row);
    return row;
}

/* --- colours: outliers and variance --- */

/* Reads a row of the source: the colours, their variance, and the features. */
static void load_row(void *context, uint32_t y, int worker) {
    struct denoise_run *d = context;
    const struct denoise_pixel *row = get_row(d, y, worker, 0);
    for (int x = 0; x < d->level->width; x++) {
        size_t at = pixel_at(d->level, x, (int)y);
        for (int c = 0; c < 3; c++) {
            for (int h = 0; h < 2; h++)
                d->loaded[h][c][at] = bounded(row[x].colour[h][c] - row[x].glow[h][c]);
            d->sampled[c][at] = 2 * fabsf(bounded(row[x].variance[c]));
        }
        for (int f = 0; f < DENOISE_FEATURES; f++) {
            float a = bounded(row[x].features[0][f]), b = bounded(row[x].features[1][f]);
            d->mean[f][at] = 0.5F * (a + b);
            d->noise[f][at] = 0.25F * (a - b) * (a - b);
        }
        for (int c = 0; c < 3; c++) {
            float a = bounded(row[x].glow[0][c]), b = bounded(row[x].glow[1][c]);
            d->mean[GLOW + c][at] = row[x].share * a + (1 - row[x].share) * b;
            d->glow[c][at] = 0.25F * (a - b) * (a - b);
        }
    }
}

static float brightness(float *const colour[3], size_t at) {
    return fabsf(colour[0][at]) + fabsf(colour[1][at]) + fabsf(colour[2][at]);
}

/* The brightest value that supports the brightness of a pixel of one half: the same pixel of the other half, its
 * neighbours in the other half, and all neighbours in its own half except the brightest one. */
static float brightest_support(const struct denoise_run *d, int half, int x, int y) {
    size_t at = pixel_at(d->level, x, y);
    float first = 0, second = 0, others = brightness(d->loaded[1 - half], at);
    for (int j = -1; j <= 1; j++) {
        for (int i = -1; i <= 1; i++) {
            size_t q = nearest_at(d->level, x + i, y + j);
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

/* Scales pixels down that are more than twice as bright as their support: single improbable paths would become
 * blotches. */
static void remove_outliers(void *context, uint32_t y, int worker) {
    struct denoise_run *d = context;
    (void)worker;
    for (int x = 0; x < d->level->width; x++) {
        size_t at = pixel_at(d->level, x, (int)y);
        for (int h = 0; h < 2; h++) {
            float limit = 2 * brightest_support(d, h, x, (int)y), own = brightness(d->loaded[h], at);
            float scale = own > limit ? limit / own : 1;
            for (int c = 0; c < 3; c++) {
                d->level->colour[h][c][at] = scale * d->loaded[h][c][at];
                d->sampled[c][at] *= scale * scale;
            }
        }
    }
}

/* For nine rows around row y, from column x0 on, the sums of: half the squared difference of the halves, the
 * variance of samples, and the latter smoothed over five rows. */
static void sum_columns(const struct denoise_run *d, int c, int x0, int y, float sums[3][STRIP + 2 * VARIANCE_WINDOW]) {
    static const float kernel[2 * VARIANCE_WINDOW + 1] = {0, 0, 0.0625F, 0.25F, 0.375F, 0.25F, 0.0625F, 0, 0};
    memset(sums, 0, 3 * sizeof *sums);
    for (int j = 0; j <= 2 * VARIANCE_WINDOW; j++) {
        for (int i = 0; i < STRIP + 2 * VARIANCE_WINDOW; i++) {
            size_t q = nearest_at(d->level, x0 + i, y + j - VARIANCE_WINDOW);
            float difference = d->level->colour[0][c][q] - d->level->colour[1][c][q], sampled = d->sampled[c][q];
            sums[0][i] += 0.5F * difference * difference;
            sums[1][i] += sampled;
            sums[2][i] += kernel[j] * sampled;
        }
    }
}

/* The variance estimated from samples has little noise, but it treats the samples as independent, while points of
 * low discrepancy have less error. So it is scaled by the mean of half the squared differences of the halves, which
 * are unbiased, and smoothed. */
static void estimate_variance(void *context, uint32_t y, int worker) {
    const float largest = 1e30F; /* its square may overflow, its sums do not */
    struct denoise_run *d = context;
    (void)worker;
    for (int item = 0; item < 3 * ((d->level->width + STRIP - 1) / STRIP); item++) {
        float sums[3][STRIP + 2 * VARIANCE_WINDOW];
        int c = item % 3, x0 = item / 3 * STRIP;
        sum_columns(d, c, x0 - VARIANCE_WINDOW, (int)y, sums);
        for (int x = 0; x < STRIP && x0 + x < d->level->width; x++) {
            const float *smooth = sums[2] + x + 2;
            float halves = 0, samples = 0;
            for (int i = 0; i <= 2 * VARIANCE_WINDOW; i++) {
                halves += sums[0][x + i];
                samples += sums[1][x + i];
            }
            float variance = 0.0625F * (smooth[0] + smooth[4]) + 0.25F * (smooth[1] + smooth[3]) + 0.375F * smooth[2];
            variance = samples > 0 ? variance * (halves / samples) : 0;
            d->level->variance[c][pixel_at(d->level, x0 + x, (int)y)] = variance < largest ? variance : largest;
        }
    }
}

/* --- features and glow: non-local means by their own variance --- */

/* The noise of glow is the mean around: a pixel beside a lamp that no sample met would have none. */
static void smooth_noise(void *context, uint32_t y, int worker) {
    const struct denoise_run *d = context;
    (void)worker;
    for (int x = 0; x < d->level->width; x++)
        for (int c = 0; c < 3; c++) {
            float sum = 0;
            for (int i = 0; i < 9; i++)
                sum += d->glow[c][nearest_at(d->level, x + i % 3 - 1, (int)y + i / 3 - 1)];
            d->noise[GLOW + c][pixel_at(d->level, x, (int)y)] = sum / 9;
        }
}

/* Whether the pixels of a square from (x, y) on have no noise. */
static bool is_quiet(const struct denoise_scratch *s, int group, int x, int y, int side) {
    for (int i = 0; i < group; i++)
        for (int row = y; row < y + side; row++)
            for (int column = x; column < x + side; column++)
                if (s->feature_noise[i][row * DENOISE_FEATURE_LOCAL + column] > 0)
                    return false;
    return true;
}

/* Glow stays as it is where a window around it has no noise: the edges of lamps in focus keep their bits. */
static void filter_features(void *context, uint32_t item, int worker) {
    enum { WINDOW = DENOISE_FEATURE_WINDOW, SIDE = DENOISE_FEATURE_LOCAL, WINDOW_OF_GLOW = 2 * (WINDOW + 1) + 1 };
    struct denoise_run *d = context;
    struct denoise_scratch *s = d->scratch + worker;
    int across = (d->level->width + BLOCK - 1) / BLOCK, bx = (int)item % across * BLOCK,
        by = (int)item / across * BLOCK;
    for (int i = 0; i < d->group; i++) {
        copy_plane(d->level, d->mean[d->first_feature + i], bx - WINDOW - 1, by - WINDOW - 1, SIDE, s->feature_mean[i]);
        copy_plane(d->level, d->noise[d->first_feature + i], bx - WINDOW - 1, by - WINDOW - 1, SIDE,
                   s->feature_noise[i]);
    }
    bool keeps = d->first_feature == GLOW, quiet = keeps && is_quiet(s, d->group, 0, 0, SIDE);
    if (!quiet)
        d->kernels->filter_features(s, d->group, d->first_feature >= DENOISE_DEPTH,
                                    bounds_of(d->level, bx - WINDOW - 1, by - WINDOW - 1, SIDE));
    for (int y = 0; y < BLOCK && by + y < d->level->height; y++)
        for (int x = 0; x < BLOCK && bx + x < d->level->width; x++) {
            size_t at = pixel_at(d->level, bx + x, by + y);
            bool kept = quiet || (keeps && is_quiet(s, d->group, x, y, WINDOW_OF_GLOW));
            for (int i = 0; i < d->group; i++)
                d->filtered[i][at] = kept ? d->mean[d->first_feature + i][at]
                                          : s->feature_sums[i][y * BLOCK + x] / s->feature_sums[3][y * BLOCK + x];
        }
}

/* --- regressions --- */

/* The position of a pixel of the block in the planes of the scratch. */
static int local_of(int x, int y) {
    return (y + MARGIN) * LOCAL + x + MARGIN;
}

/* For one half: the mean of the predictions. A pixel without predictions keeps its colour. */
static void keep_estimates(struct denoise_scratch *s, int regression, int half) {
    const float own = 0.01F, few = 2, many = 8;
    for (int c = 0; c < 3; c++) {
        for (int y = -CHOICE; y < BLOCK + CHOICE; y++) {
            for (int at = local_of(-CHOICE, y); at < local_of(BLOCK + CHOICE, y); at++) {
                float colour = s->colour[half][c][at];
                float value = (s->sums[half][c][at] + own * colour) / (s->weight_sums[at] + own);
                s->estimates[regression][half][c][at] = isfinite(value) ? value : colour;
            }
        }
    }
    for (int at = 0; at < LOCAL * LOCAL; at++)
        s->support[regression][half][at] = s->weight_sums[at] < few     ? DENOISE_FEW
                                           : s->weight_sums[at] <= many ? DENOISE_SOME
                                                                        : DENOISE_MANY;
}

/* Denoises the halves of the samples in a block; the other half determines the similarity of colours. */
static void estimate_halves(const struct denoise_run *d, struct denoise_scratch *s, struct film_rectangle bounds) {
    for (int half = 0; half < 2; half++) {
        d->kernels->compare(s, 1 - half, bounds);
        for (int b = 0; b < REGRESSIONS && !pool_cancelled(d->pool); b++) {
            if (regressions[b].colours > 0) {
                d->kernels->regress(s, half, regressions[b], bounds);
                keep_estimates(s, b, half);
            }
        }
    }
    for (int b = 0; b < REGRESSIONS && !pool_cancelled(d->pool); b++) {
        if (regressions[b].colours > 0)
            continue;
        d->kernels->regress(s, 0, regressions[b], bounds);
        for (int half = 0; half < 2; half++)
            keep_estimates(s, b, half);
    }
}

/* --- choice of the candidate --- */

/* The weights of the candidates at the pixels of a row of the block: the larger the score, the smaller the weight. */
static void choose_candidates(const struct denoise_run *d, struct denoise_scratch *s, int y,
                              float shares[CANDIDATES][BLOCK]) {
    d->kernels->score_candidates(s, y, shares);
    for (int x = 0; x < BLOCK; x++) {
        float smallest = shares[0][x], sum = 0;
        for (int b = 1; b < CANDIDATES; b++)
            smallest = shares[b][x] < smallest ? shares[b][x] : smallest;
        for (int b = 0; b < CANDIDATES; b++) {
            float share = 1 - choice_slope * (shares[b][x] - smallest);
            shares[b][x] = share > 0 ? share : 0;
            sum += shares[b][x];
        }
        for (int b = 0; b < CANDIDATES; b++)
            shares[b][x] = sum > 0 ? shares[b][x] / sum : 1.0F / CANDIDATES;
    }
}

/* The half that speaks for a half at a pixel: the other one if few pixels were like it there, since a bright path made
 * the other one unlike all. */
static int supported_half(const struct denoise_scratch *s, int regression, int half, int at) {
    bool unsupported =
        s->support[regression][half][at] == DENOISE_FEW && s->support[regression][1 - half][at] == DENOISE_MANY;
    return unsupported ? 1 - half : half;
}

static void store_pixel(const struct level *level, const struct denoise_scratch *s, int from, size_t to,
                        float (*shares)[BLOCK], int x) {
    for (int half = 0; half < 2; half++) {
        float sum[3] = {0};
        for (int b = 0; b < REGRESSIONS; b++) {
            int speaker = supported_half(s, b, half, from);
            for (int c = 0; c < 3; c++)
                sum[c] += shares[b][x] * s->estimates[b][speaker][c][from];
        }
        for (int c = 0; c < 3; c++)
            level->estimate[half][c][to] = sum[c] + shares[REGRESSIONS][x] * s->colour[half][c][from];
    }
}

/* Blocks begin where coordinates in the whole picture are multiples of ALIGNMENT, and so do centres. */
static void regress_block(void *context, uint32_t item, int worker) {
    struct denoise_run *d = context;
    struct denoise_scratch *s = d->scratch + worker;
    float shares[CANDIDATES][BLOCK];
    /* The first block may begin outside of the picture. */
    int left = -(int)(d->level->x0 % ALIGNMENT), top = -(int)(d->level->y0 % ALIGNMENT);
    int across = (d->level->width - left + BLOCK - 1) / BLOCK;
    int bx = left + (int)item % across * BLOCK, by = top + (int)item / across * BLOCK;
    int x0 = bx - MARGIN, y0 = by - MARGIN;
    const struct film_rectangle bounds = bounds_of(d->level, x0, y0, LOCAL);
    for (int c = 0; c < 3; c++) {
        copy_plane(d->level, d->level->colour[0][c], x0, y0, LOCAL, s->colour[0][c]);
        copy_plane(d->level, d->level->colour[1][c], x0, y0, LOCAL, s->colour[1][c]);
        copy_plane(d->level, d->level->variance[c], x0, y0, LOCAL, s->variance[c]);
    }
    for (int f = 0; f < DENOISE_FEATURES; f++)
        copy_plane(d->level, d->level->feature[f], x0, y0, LOCAL, s->feature[f]);
    d->kernels->find_changes(s);
    /* Estimates of all candidates, then the best mixture for each pixel. */
    estimate_halves(d, s, bounds);
    if (pool_cancelled(d->pool))
        return;
    d->kernels->compare_candidates(s);
    for (int y = by > 0 ? by : 0; y < by + BLOCK && y < d->level->height; y++) {
        choose_candidates(d, s, y - by, shares);
        for (int x = bx > 0 ? bx : 0; x < bx + BLOCK && x < d->level->width; x++)
            store_pixel(d->level, s, local_of(x - bx, y - by), pixel_at(d->level, x, y), shares, x - bx);
    }
}

/* --- scales --- */

/* The first pixel of the finer level in a coarse column or row, and the number of its pixels. */
static int finer_from(int coarse, uint32_t coarse0, uint32_t finer0, int limit, int *count) {
    int from = (int)(2 * ((int64_t)coarse0 + coarse) - (int64_t)finer0), to = from + 2;
    from = from > 0 ? from : 0;
    *count = (to < limit ? to : limit) - from;
    return from;
}

/* The mean of a plane over the pixels of the finer level that a coarse pixel covers. */
static float mean_of(const struct level *level, const float *plane, int x, int y, int across, int down) {
    float sum = 0;
    for (int j = 0; j < down; j++)
        for (int i = 0; i < across; i++)
            sum += plane[pixel_at(level, x + i, y + j)];
    return sum / (float)(across * down);
}

/* Compute a row of the level from the level before. */
static void shrink_features(void *context, uint32_t y, int worker) {
    const struct denoise_run *d = context;
    const struct level *level = d->level, *finer = level - 1;
    int down, across, fy = finer_from((int)y, level->y0, finer->y0, finer->height, &down);
    (void)worker;
    for (int x = 0; x < level->width; x++) {
        int fx = finer_from(x, level->x0, finer->x0, finer->width, &across);
        size_t at = pixel_at(level, x, (int)y);
        for (int f = 0; f < DENOISE_FEATURES; f++)
            level->feature[f][at] = mean_of(finer, finer->feature[f], fx, fy, across, down);
    }
}

static void shrink_colours(void *context, uint32_t y, int worker) {
    const struct denoise_run *d = context;
    const struct level *level = d->level, *finer = level - 1;
    int down, across, fy = finer_from((int)y, level->y0, finer->y0, finer->height, &down);
    (void)worker;
    for (int x = 0; x < level->width; x++) {
        int fx = finer_from(x, level->x0, finer->x0, finer->width, &across);
        size_t at = pixel_at(level, x, (int)y);
        for (int c = 0; c < 3; c++) {
            for (int half = 0; half < 2; half++)
                level->colour[half][c][at] = mean_of(finer, finer->colour[half][c], fx, fy, across, down);
            level->variance[c][at] = mean_of(finer, finer->variance[c], fx, fy, across, down) / (float)(across * down);
        }
    }
}

/* Subtracts the finer level: the estimates become differences to its means, and the colours become these means. */
static void subtract_finer(void *context, uint32_t y, int worker) {
    const struct denoise_run *d = context;
    const struct level *level = d->level, *finer = level - 1;
    int down, across, fy = finer_from((int)y, level->y0, finer->y0, finer->height, &down);
    (void)worker;
    for (int x = 0; x < level->width; x++) {
        int fx = finer_from(x, level->x0, finer->x0, finer->width, &across);
        for (int c = 0; c < 3; c++)
            for (int half = 0; half < 2; half++) {
                size_t at = pixel_at(level, x, (int)y);
                float mean = mean_of(finer, finer->estimate[half][c], fx, fy, across, down);
                level->colour[half][c][at] = mean;
                level->estimate[half][c][at] -= mean;
            }
    }
}

/* Adds the correction of one pixel of the level, weighted by its similarity to the pixel of the finer level:
 * corrections from the other side of an edge do not count. */
static void add_correction(const struct level *level, int half, size_t from, const float own[3], float factor,
                           float sum[3]) {
    float above = 0, below = FLT_MIN;
    for (int c = 0; c < 3; c++) {
        float difference = own[c] - level->colour[half][c][from];
        above += difference * difference;
        below += level->variance[c][from];
    }
    float like = 1 - above / (correction_limit * below);
    for (int c = 0; c < 3 && like > 0; c++)
        sum[c] += factor * like * level->estimate[half][c][from];
}

/* Adds the interpolated corrections of the level to a row of the finer level; they at most double or halve a value. */
static void correct_finer(void *context, uint32_t y, int worker) {
    const struct denoise_run *d = context;
    const struct level *level = d->level, *finer = level - 1;
    uint32_t whole_y = finer->y0 + y;
    int near_y = (int)(whole_y / 2 - level->y0), far_y = near_y + (whole_y % 2 ? 1 : -1);
    (void)worker;
    for (int x = 0; x < finer->width; x++) {
        uint32_t whole_x = finer->x0 + (uint32_t)x;
        int near_x = (int)(whole_x / 2 - level->x0), far_x = near_x + (whole_x % 2 ? 1 : -1);
        size_t at = pixel_at(finer, x, (int)y);
        for (int half = 0; half < 2; half++) {
            /* Bilinear interpolation: 3/4 and 1/4 along each axis. */
            float sum[3] = {0};
            const float own[3] = {finer->estimate[half][0][at], finer->estimate[half][1][at],
                                  finer->estimate[half][2][at]};
            add_correction(level, half, nearest_at(level, near_x, near_y), own, 0.5625F, sum);
            add_correction(level, half, nearest_at(level, far_x, near_y), own, 0.1875F, sum);
            add_correction(level, half, nearest_at(level, near_x, far_y), own, 0.1875F, sum);
            add_correction(level, half, nearest_at(level, far_x, far_y), own, 0.0625F, sum);
            for (int c = 0; c < 3; c++) {
                float limit = fabsf(own[c]), value = sum[c] < limit ? sum[c] : limit;
                finer->estimate[half][c][at] += value > -0.5F * limit ? value : -0.5F * limit;
            }
        }
    }
}

/* --- the last step --- */

/* Without noise. */
static float albedo_at(const struct level *level, int c, size_t at) {
    const float black = 0.02F, albedo = level->feature[DENOISE_ALBEDO + c][at];
    return albedo > 0 ? albedo + black : black;
}

/* The mean of the halves. A pixel that is brighter or darker than all of its neighbours is so in both of them, by more
 * than its samples explain: few bright paths in a pixel bring a mean that is hardly larger than its standard error,
 * a detail of the scene is found by many. A pixel that no bright path found has a small error itself, so a dark one
 * must stand out from the errors of its neighbours. A detail of a texture is as bright as its neighbours would be on
 * average with its albedo, give or take the error of this mean of eight; neighbours at another depth are not of its
 * texture, and what the noise of albedo explains is no detail. Among millions of pixels, some have a mean of their few
 * bright paths that is two standard errors too large. rows: those around the pixel. */
static float supported_mean(const struct denoise_run *d, const struct denoise_pixel *const rows[3], int c, int x,
                            int y) {
    const struct level *level = d->level;
    const float *depth = level->feature[DENOISE_DEPTH];
    size_t at = pixel_at(level, x, y);
    float a = level->colour[0][c][at], b = level->colour[1][c][at], mean = mean_of_halves(level, c, at);
    float darkest = mean_of_halves(level, c, nearest_at(level, x > 0 ? x - 1 : x + 1, y)), brightest = darkest;
    float albedo = albedo_at(level, c, at), like = 0, neighbour_mean = 0, variance = 0, noise = 0;
    for (int j = -1; j <= 1; j++) {
        for (int i = -1; i <= 1; i++) {
            int qx = clamp_int(x + i, 0, level->width - 1), qy = clamp_int(y + j, 0, level->height - 1);
            const float(*halves)[DENOISE_FEATURES] = rows[1 + j][qx].features;
            float difference = bounded(halves[0][DENOISE_ALBEDO + c]) - bounded(halves[1][DENOISE_ALBEDO + c]);
            noise += 0.25F / 9 * difference * difference;
            if (i == 0 && j == 0)
                continue;
            size_t q = pixel_at(level, qx, qy);
            float other = mean_of_halves(level, c, q);
            bool same = fabsf(depth[at] - depth[q]) <= same_depth * depth[at];
            neighbour_mean += 0.125F * other;
            like += 0.125F * other * (same ? albedo / albedo_at(level, c, q) : 1);
            variance += 0.125F * fabsf(bounded(rows[1 + j][qx].variance[c]));
            if (qx == x && qy == y)
                continue;
            brightest = other > brightest ? other : brightest;
            darkest = other < darkest ? other : darkest;
        }
    }
    /* A pixel between these bounds stays; one beyond them is moved to the bound. */
    float own = fabsf(bounded(rows[1][x].variance[c])), others = variance > own ? variance : own;
    float high = (a < b ? a : b) - support_errors * sqrtf(own);
    float low = (a < b ? b : a) + support_errors * sqrtf(others);
    float doubt = albedo_errors * sqrtf(noise) / albedo * neighbour_mean, detail = fabsf(like - neighbour_mean);
    detail = detail > doubt ? detail - doubt : 0;
    like = like > neighbour_mean ? neighbour_mean + detail : neighbour_mean - detail;
    float error = sqrtf(0.125F * variance);
    error = detail < error ? detail : error;
    high = brightest > high ? brightest : high;
    high = like + error > high ? like + error : high;
    low = darkest < low ? darkest : low;
    low = like - error < low ? like - error : low;
    return mean > high ? high : mean < low ? low : mean;
}

/* No sample of the pixel met a surface: it has no noise, and no neighbour knows better. */
static bool is_empty(const struct denoise_pixel *pixel) {
    for (int half = 0; half < 2; half++) {
        for (int f = 0; f < DENOISE_FEATURES; f++)
            if (pixel->features[half][f] != 0)
                return false;
        for (int c = 0; c < 3; c++)
            if (pixel->colour[half][c] != pixel->glow[half][c])
                return false;
    }
    return true;
}

/* The mean of the halves, plus glow, of a row; rows: those around it. */
static void finish_row(const struct denoise_run *d, const struct denoise_pixel *const rows[3], int y) {
    for (int x = 0; x < d->level->width; x++) {
        const struct denoise_pixel *pixel = &rows[1][x];
        bool empty = is_empty(pixel);
        for (int c = 0; c < 3; c++) {
            size_t at = pixel_at(d->level, x, y);
            d->out[at][c] = (empty ? 0 : supported_mean(d, rows, c, x, y)) + d->glow[c][at];
        }
    }
}

static void finish_rows(void *context, uint32_t item, int worker) {
    struct denoise_run *d = context;
    int from = (int)item * ROWS, last = d->level->height - 1;
    const struct denoise_pixel *rows[3] = {get_row(d, (uint32_t)clamp_int(from - 1, 0, last), worker, 0),
                                           get_row(d, (uint32_t)from, worker, 1), NULL};
    for (int y = from; y < from + ROWS && y <= last; y++) {
        rows[2] = get_row(d, (uint32_t)clamp_int(y + 1, 0, last), worker, (y - from + 2) % 3);
        finish_row(d, rows, y);
        rows[0] = rows[1];
        rows[1] = rows[2];
    }
}

/* --- the whole --- */

static bool make_plane(const struct level *level, float **plane) {
    *plane = mem_alloc((size_t)level->width * (size_t)level->height * sizeof **plane);
    return *plane != NULL;
}

static void free_plane(float **plane) {
    mem_free(*plane);
    *plane = NULL;
}

static void free_level(struct level *level) {
    for (int c = 0; c < 3; c++) {
        for (int half = 0; half < 2; half++) {
            free_plane(&level->colour[half][c]);
            free_plane(&level->estimate[half][c]);
        }
        free_plane(&level->variance[c]);
    }
    for (int f = 0; f < DENOISE_FEATURES; f++)
        free_plane(&level->feature[f]);
}

static bool run(struct denoise_run *d, uint32_t count, pool_function *fn, struct error *error) {
    return pool_run(d->pool, count, fn, d) || error_set(error, ERROR_CANCELLED, "stopped while denoising");
}

static bool no_memory(struct error *error) {
    return error_no_memory(error, "a picture that is denoised");
}

static bool load_source(struct denoise_run *d, struct error *error) {
    for (int c = 0; c < 3; c++)
        if (!make_plane(d->level, &d->loaded[0][c]) || !make_plane(d->level, &d->loaded[1][c]) ||
            !make_plane(d->level, &d->sampled[c]))
            return no_memory(error);
    for (int f = 0; f < GLOW + 3; f++)
        if (!make_plane(d->level, &d->mean[f]) || !make_plane(d->level, &d->noise[f]))
            return no_memory(error);
    for (int c = 0; c < 3; c++)
        if (!make_plane(d->level, &d->glow[c]))
            return no_memory(error);
    return run(d, d->source->height, load_row, error);
}

static bool denoise_colours(struct denoise_run *d, struct error *error) {
    for (int c = 0; c < 3; c++)
        if (!make_plane(d->level, &d->level->colour[0][c]) || !make_plane(d->level, &d->level->colour[1][c]) ||
            !make_plane(d->level, &d->level->variance[c]))
            return no_memory(error);
    if (!run(d, d->source->height, remove_outliers, error) || !run(d, d->source->height, estimate_variance, error))
        return false;
    for (int c = 0; c < 3; c++) {
        free_plane(&d->loaded[0][c]);
        free_plane(&d->loaded[1][c]);
        free_plane(&d->sampled[c]);
    }
    return true;
}

static bool filter_group(struct denoise_run *d, int first, int count, float *out[], struct error *error) {
    uint32_t blocks = (d->source->width + BLOCK - 1) / BLOCK * ((d->source->height + BLOCK - 1) / BLOCK);
    d->first_feature = first;
    d->group = count;
    d->filtered = out;
    if (!run(d, blocks, filter_features, error))
        return false;
    for (int f = first; f < first + count; f++) {
        free_plane(&d->mean[f]);
        free_plane(&d->noise[f]);
    }
    return true;
}

static bool denoise_features(struct denoise_run *d, struct error *error) {
    static const int groups[][2] = {{DENOISE_ALBEDO, 3}, {DENOISE_NORMAL, 3}, {DENOISE_DEPTH, 1}};
    if (!run(d, d->source->height, smooth_noise, error) || !filter_group(d, GLOW, 3, d->glow, error))
        return false;
    for (int g = 0; g < 3; g++) {
        float **planes = d->level->feature + groups[g][0];
        for (int i = 0; i < groups[g][1]; i++)
            if (!make_plane(d->level, &planes[i]))
                return no_memory(error);
        if (!filter_group(d, groups[g][0], groups[g][1], planes, error))
            return false;
    }
    return true;
}

static const struct denoise_kernels *choose_kernels(void) {
#if CPU_ISA_CHOICE
    if (cpu_isa() == CPU_ISA_AVX512)
        return &denoise_kernels_avx512;
    if (cpu_isa() == CPU_ISA_AVX2)
        return &denoise_kernels_avx2;
#endif
    return &denoise_kernels_base;
}

static bool make_estimates(struct denoise_run *d, struct error *error) {
    for (int c = 0; c < 3; c++)
        for (int half = 0; half < 2; half++)
            if (!make_plane(d->level, &d->level->estimate[half][c]))
                return no_memory(error);
    uint32_t width = (uint32_t)d->level->width, height = (uint32_t)d->level->height;
    uint32_t across = (width + d->level->x0 % ALIGNMENT + BLOCK - 1) / BLOCK;
    uint32_t down = (height + d->level->y0 % ALIGNMENT + BLOCK - 1) / BLOCK;
    return run(d, across * down, regress_block, error);
}

/* The planes that a level computes from the one before. */
static bool make_coarse(struct denoise_run *d, struct error *error) {
    struct level *level = d->level;
    for (int f = 0; f < DENOISE_FEATURES; f++)
        if (!make_plane(level, &level->feature[f]))
            return no_memory(error);
    if (!run(d, (uint32_t)level->height, shrink_features, error))
        return false;
    for (int c = 0; c < 3; c++)
        if (!make_plane(level, &level->colour[0][c]) || !make_plane(level, &level->colour[1][c]) ||
            !make_plane(level, &level->variance[c]))
            return no_memory(error);
    return run(d, (uint32_t)level->height, shrink_colours, error);
}

static bool denoise_all(struct denoise_run *d, struct error *error) {
    const struct denoise_source *source = d->source;
    size_t workers = (size_t)pool_workers(d->pool);
    d->rows = mem_alloc_zero(3 * workers * source->width, sizeof *d->rows);
    d->scratch = mem_alloc_zero(workers, sizeof *d->scratch);
    if (!d->rows || !d->scratch)
        return no_memory(error);
    for (size_t i = 0; i < workers; i++)
        d->scratch[i].pool = d->pool;
    if (!load_source(d, error) || !denoise_colours(d, error) || !denoise_features(d, error) ||
        !make_estimates(d, error))
        return false;
    /* From fine to coarse, and the corrections back. */
    while (d->level < d->levels + LEVELS - 1) {
        d->level++;
        if (!make_coarse(d, error) || !make_estimates(d, error))
            return false;
    }
    for (; d->level > d->levels; d->level--) {
        if (!run(d, (uint32_t)d->level->height, subtract_finer, error) ||
            !run(d, (uint32_t)d->level[-1].height, correct_finer, error))
            return false;
        free_level(d->level);
    }
    /* What the estimates have lost at silhouettes. */
    if (!make_plane(d->level, &d->evidence) || !make_plane(d->level, &d->agreement))
        return no_memory(error);
    for (; d->pass < RESIDUAL_PASSES; d->pass++)
        if (!run(d, source->height, denoise_find_residuals, error) ||
            !run(d, source->height, denoise_add_residuals, error))
            return false;
    return run(d, (source->height + ROWS - 1) / ROWS, finish_rows, error);
}

/* The size and the position of the next level. */
static struct level coarser(const struct level *level) {
    struct level next = {0};
    next.x0 = level->x0 / 2;
    next.y0 = level->y0 / 2;
    next.width = (int)((level->x0 + (uint32_t)level->width + 1) / 2 - next.x0);
    next.height = (int)((level->y0 + (uint32_t)level->height + 1) / 2 - next.y0);
    return next;
}

bool denoise(const struct denoise_source *source, struct pool *pool, float (*out)[3], struct error *error) {
    struct denoise_run d = {.source = source, .out = out, .pool = pool, .kernels = choose_kernels()};
    d.levels[0].width = (int)source->width;
    d.levels[0].height = (int)source->height;
    d.levels[0].x0 = source->x0;
    d.levels[0].y0 = source->y0;
    /* Each level has half of the width and height of the one before. */
    for (int i = 1; i < LEVELS; i++)
        d.levels[i] = coarser(&d.levels[i - 1]);
    d.level = d.levels;
    bool ok = denoise_all(&d, error);
    for (int c = 0; c < 3; c++) {
        mem_free(d.loaded[0][c]);
        mem_free(d.loaded[1][c]);
        mem_free(d.sampled[c]);
    }
    for (int f = 0; f < GLOW + 3; f++) {
        mem_free(d.mean[f]);
        mem_free(d.noise[f]);
    }
    for (int c = 0; c < 3; c++)
        mem_free(d.glow[c]);
    mem_free(d.evidence);
    mem_free(d.agreement);
    for (int i = 0; i < LEVELS; i++)
        free_level(&d.levels[i]);
    mem_free(d.rows);
    mem_free(d.scratch);
    return ok;
}
