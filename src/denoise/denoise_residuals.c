#include "denoise/denoise_residuals_internal.h"

#include "denoise/denoise_run_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Found by measurement (bench/denoise.sh). */
/* A silhouette has a neighbour with this relative difference of depths and this distance of features. */
static const float edge_depth = 0.05F, edge_distance = 8;
/* Residuals count half at these distances of features, and relative squared differences of colours. */
static const float residual_distance = 10, residual_colour = 0.2F;
/* How much of the mean residual is added: more than 1, since the mean of 7 x 7 pixels itself is blurred. */
static const float residual_gain = 2.6F;
/* The evidence that is necessary, and how fast the share then grows: beside fog, chance reaches 1. And the product of
 * the halves, in units of the evidence, which is negative if the residuals are noise: of a bright path that one half
 * found. */
static const float evidence_limit = 0.6F, evidence_slope = 2, agreement_limit = -0.2F;

static float surface_distance(const struct level *level, size_t p, size_t q) {
    float z = level->feature[DENOISE_DEPTH][p], difference = level->feature[DENOISE_DEPTH][q] - z;
    float sum = difference * difference / (z * z / depth_unit + FLT_MIN);
    for (int f = 0; f < DENOISE_DEPTH; f++) {
        difference = level->feature[f][q] - level->feature[f][p];
        sum += difference * difference * (f < DENOISE_NORMAL ? albedo_unit : normal_unit);
    }
    return sum;
}

static bool is_silhouette(const struct level *level, int x, int y) {
    size_t at = pixel_at(level, x, y);
    float z = level->feature[DENOISE_DEPTH][at];
    for (int i = 0; i < 9; i++) {
        size_t q = nearest_at(level, x + i % 3 - 1, y + i / 3 - 1);
        float other = level->feature[DENOISE_DEPTH][q];
        if (fabsf(z - other) > edge_depth * (z < other ? z : other) && surface_distance(level, at, q) > edge_distance)
            return true;
    }
    return false;
}

/* The weight of the residual of a pixel for another one. */
static float residual_weight(const struct level *level, size_t p, size_t q) {
    float difference = 0, size = 1e-4F;
    for (int c = 0; c < 3; c++) {
        float a = mean_of_halves(level, c, p), b = mean_of_halves(level, c, q);
        difference += (a - b) * (a - b);
        size += a * a + b * b;
    }
    float distance = surface_distance(level, p, q) / residual_distance + difference / size / residual_colour;
    return 1 / (1 + distance * distance);
}

/* The mean residual around a pixel, how far it exceeds the noise, and whether both halves have it. The noise of a pixel
 * is at least its own residual: a single bright path is no evidence. */
struct residual {
    float mean[3], evidence, agreement;
};

static struct residual find_residual(const struct level *level, int x, int y) {
    static const float kernel[DENOISE_RESIDUAL_WINDOW + 1] = {1, 0.8948F, 0.6412F, 0.3679F}; /* exp(-x^2/9) */
    float sums[2][3] = {{0}}, weights = 0, square = 0, product = 0, noise = FLT_MIN;
    size_t at = pixel_at(level, x, y);
    for (int j = -DENOISE_RESIDUAL_WINDOW; j <= DENOISE_RESIDUAL_WINDOW; j++) {
        for (int i = -DENOISE_RESIDUAL_WINDOW; i <= DENOISE_RESIDUAL_WINDOW; i++) {
            if (x + i < 0 || y + j < 0 || x + i >= level->width || y + j >= level->height)
                continue;
            size_t q = pixel_at(level, x + i, y + j);
            float weight = kernel[i < 0 ? -i : i] * kernel[j < 0 ? -j : j] * residual_weight(level, at, q);
            weights += weight;
            for (int c = 0; c < 3; c++) {
                float residuals[2], expected = 0.5F * level->variance[c][q];
                for (int half = 0; half < 2; half++) {
                    residuals[half] = level->colour[half][c][q] - mean_of_halves(level, c, q);
                    sums[half][c] += weight * residuals[half];
                }
                float mean = 0.5F * (residuals[0] + residuals[1]), found = mean * mean;
                noise += weight * weight * (found > expected ? found : expected);
            }
        }
    }
    struct residual found;
    for (int c = 0; c < 3; c++) {
        float mean = 0.5F * (sums[0][c] + sums[1][c]);
        found.mean[c] = mean / weights;
        square += mean * mean;
        product += sums[0][c] * sums[1][c];
    }
    float largest = 100, unit = square < largest * noise ? noise : square / largest;
    found.evidence = square / unit;
    found.agreement = product / unit;
    return found;
}
_Static_assert((int)DENOISE_RESIDUAL_WINDOW == 3, "the kernel of find_residual has four numbers");

void denoise_find_residuals(void *context, uint32_t y, int worker) {
    struct denoise_run *d = context;
    (void)worker;
    for (int x = 0; x < d->level->width; x++) {
        size_t at = pixel_at(d->level, x, (int)y);
        if (d->pass == 0)
            d->evidence[at] = is_silhouette(d->level, x, (int)y) ? 0 : -1;
        if (d->evidence[at] < 0)
            continue;
        struct residual found = find_residual(d->level, x, (int)y);
        memcpy(d->out[at], found.mean, sizeof found.mean);
        d->evidence[at] = found.evidence;
        d->agreement[at] = found.agreement;
    }
}

/* The mean of the evidence around a silhouette: that of one pixel would select noise. 0 if the halves disagree. */
static float mean_evidence(const struct denoise_run *d, int x, int y) {
    float sum = 0, agreement = 0, count = 0;
    for (int j = -DENOISE_EVIDENCE_WINDOW; j <= DENOISE_EVIDENCE_WINDOW; j++) {
        for (int i = -DENOISE_EVIDENCE_WINDOW; i <= DENOISE_EVIDENCE_WINDOW; i++) {
            if (x + i < 0 || y + j < 0 || x + i >= d->level->width || y + j >= d->level->height)
                continue;
            size_t q = pixel_at(d->level, x + i, y + j);
            if (d->evidence[q] < 0)
                continue;
            sum += d->evidence[q];
            agreement += d->agreement[q];
            count++;
        }
    }
    return agreement < agreement_limit * sum ? 0 : sum / count;
}

void denoise_add_residuals(void *context, uint32_t y, int worker) {
    struct denoise_run *d = context;
    (void)worker;
    for (int x = 0; x < d->level->width; x++) {
        size_t at = pixel_at(d->level, x, (int)y);
        float evidence = d->evidence[at] >= 0 ? mean_evidence(d, x, (int)y) : 0;
        if (!(evidence > evidence_limit))
            continue;
        float share = evidence_slope * (1 - evidence_limit / evidence);
        share = residual_gain * (share < 1 ? share : 1);
        for (int c = 0; c < 3; c++) {
            for (int half = 0; half < 2; half++) {
                float *value = &d->level->estimate[half][c][at], lowest = -0.75F * fabsf(*value);
                *value += share * d->out[at][c] > lowest ? share * d->out[at][c] : lowest;
            }
        }
    }
}
