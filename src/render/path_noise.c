/* The noise of a tile is the square root of the mean over pixels and channels of Var / (mean^2 + .01), where Var is the
 * variance of the pixel's mean from the two halves of its samples. Three things make it an upper estimate where a few
 * rare bright paths cause most of the error:
 *
 * - mean. A pixel that such a path met is bright because of this path, so its own mean hides its error. A mean that is
 *   known badly is replaced by that of the neighbours: the mean is at most the median of 3 x 3 pixels, but at least the
 *   own mean minus its standard error.
 * - Var. Two rare paths, one in each half, cancel. So the variance from the samples replaces that from the halves in so
 *   far as the mean is known badly: in proportion to the square of its relative standard error, which is 1 after a
 *   single path and 1/k after k of them. Stratification does not reduce such variances.
 * - Few pixels. In a tile of the rim, the sum over pixels is known less well than in a whole tile. With K of 1,024
 *   pixels, 1 - K / 1024 times its standard error is added, and K / 1024 times what exceeds a usual one: a few pixels
 *   can make most of the noise of a whole tile, too.
 *
 * With the brightness of the surroundings in the denominator, the estimate of a tile with few rare paths is almost
 * its real error, since most of the error is in the pixels that met one. What no sample met remains unknown. So a tile
 * needs more samples for less noise in any case. */
#include "render/path_noise_internal.h"

#include <math.h>

static const double dark = 0.01; /* the square of a value that counts as black */

/* One channel of a pixel: the absolute value of its mean, and the variance of its mean, from halves and from
 * samples. */
struct channel {
    double mean, halves, samples;
};

static struct channel channel_of(double mean, double halves, double samples) {
    return (struct channel){fabs(mean), halves, samples};
}

static void load_pixel(const struct film *film, size_t at, struct channel out[3]) {
    struct path_pixel pixel = path_film_load(film, at);
    struct colour mean = path_pixel_mean(&pixel), halves = path_pixel_variance_of_halves(&pixel),
                  samples = path_pixel_variance_of_samples(&pixel);
    out[0] = channel_of(mean.r, halves.r, samples.r);
    out[1] = channel_of(mean.g, halves.g, samples.g);
    out[2] = channel_of(mean.b, halves.b, samples.b);
}

static void order(double *a, double *b) {
    double less = *a < *b ? *a : *b, more = *a < *b ? *b : *a;
    *a = less;
    *b = more;
}

/* Smith, "Implementing median filters in XC4000E FPGAs", 1996. Changes the values. */
static double median_of_9(double v[9]) {
    order(&v[1], &v[2]);
    order(&v[4], &v[5]);
    order(&v[7], &v[8]);
    order(&v[0], &v[1]);
    order(&v[3], &v[4]);
    order(&v[6], &v[7]);
    order(&v[1], &v[2]);
    order(&v[4], &v[5]);
    order(&v[7], &v[8]);
    order(&v[0], &v[3]);
    order(&v[5], &v[8]);
    order(&v[4], &v[7]);
    order(&v[3], &v[6]);
    order(&v[1], &v[4]);
    order(&v[2], &v[5]);
    order(&v[4], &v[7]);
    order(&v[4], &v[2]);
    order(&v[6], &v[4]);
    order(&v[4], &v[2]);
    return v[4];
}

enum { SIDE = FILM_TILE };

/* The median of 3 x 3 means; the border of the tile is repeated outwards. */
static double median_of_neighbours(struct channel (*pixels)[3], struct film_rectangle size, uint32_t x, uint32_t y,
                                   int c) {
    double means[9];
    uint32_t xs[3] = {x > 0 ? x - 1 : 0, x, x + 1 < size.x1 ? x + 1 : x};
    uint32_t ys[3] = {y > 0 ? y - 1 : 0, y, y + 1 < size.y1 ? y + 1 : y};
    for (int i = 0; i < 9; i++)
        means[i] = pixels[ys[i / 3] * SIDE + xs[i % 3]][c].mean;
    return median_of_9(means);
}

/* The relative variance of a channel. */
static double relative_variance(const struct channel *of, double median) {
    double low = of->mean - sqrt(of->samples), mean = math_min(of->mean, math_max(low, median));
    double square = of->mean * of->mean, unsure = of->samples < square ? of->samples / square : 1;
    return (of->halves + (of->samples - of->halves) * unsure) * (1 / (mean * mean + dark));
}

/* The standard error of the sum over a whole tile is added as far as it exceeds `usual` times that of equal pixels,
 * which is the mean divided by the square root of their number. */
static const double usual = 3;

/* From the sums over pixels of their relative variances and of the squares of these. */
static double noise_of(double sum, double squares, double pixels) {
    double mean = sum / pixels, error = sqrt(squares) / pixels, share = pixels / (SIDE * SIDE);
    double excess = math_max(error - usual * mean / sqrt(pixels), 0);
    return sqrt(mean + (1 - share) * error + share * excess);
}

double path_tile_noise(const struct film *film, struct film_rectangle tile) {
    struct channel pixels[SIDE * SIDE][3];
    const struct film_rectangle size = {0, 0, tile.x1 - tile.x0, tile.y1 - tile.y0};
    double sum = 0, squares = 0;
    for (uint32_t y = 0; y < size.y1; y++) {
        for (uint32_t x = 0; x < size.x1; x++)
            load_pixel(film, (size_t)(tile.y0 + y - film->y0) * film->width + (tile.x0 + x - film->x0),
                       pixels[y * SIDE + x]);
    }
    for (uint32_t y = 0; y < size.y1; y++) {
        for (uint32_t x = 0; x < size.x1; x++) {
            double pixel = 0;
            for (int c = 0; c < 3; c++)
                pixel += relative_variance(&pixels[y * SIDE + x][c], median_of_neighbours(pixels, size, x, y, c)) / 3;
            sum += pixel;
            squares += pixel * pixel;
        }
    }
    return noise_of(sum, squares, (double)size.x1 * size.y1);
}

/* --- the number of samples --- */

uint32_t path_next_check(uint32_t samples) {
    uint32_t power = 16;
    while (power <= samples / 2)
        power *= 2;
    return samples < power ? power : samples < power + power / 2 ? power + power / 2 : 2 * power;
}

bool path_is_check(uint32_t samples) {
    return samples >= 16 && path_next_check(samples - 1) == samples;
}

uint32_t path_samples_kept(const struct film *film, struct film_rectangle tile, uint32_t limit) {
    uint32_t all = 0;
    for (uint32_t y = tile.y0; y < tile.y1; y++) {
        for (uint32_t x = tile.x0; x < tile.x1; x++) {
            uint32_t samples = path_film_load(film, (size_t)(y - film->y0) * film->width + (x - film->x0)).samples;
            if (all > 0 && samples != all)
                return 0;
            all = samples;
        }
    }
    return path_is_check(all) && all < limit ? all : 0;
}

uint32_t path_minimum_samples(double wanted) {
    return (uint32_t)math_min(math_max(16, ceil(1.25 / wanted)), PATH_SAMPLES_MAX);
}

uint32_t path_samples_expected(uint32_t samples, double noise, double wanted, uint32_t limit) {
    double ratio = noise / wanted, needed = samples * ratio * ratio;
    if (samples < 2 || samples >= limit || !(needed < limit))
        return samples < 2 ? 0 : limit;
    uint32_t count = samples;
    while (count < math_max(needed, path_minimum_samples(wanted)) && count < limit)
        count = path_next_check(count);
    return count < limit ? count : limit;
}
