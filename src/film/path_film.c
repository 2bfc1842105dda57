/* The record of a path-traced pixel. Each sum is stored as two floats, the nearest float and the remainder. That is
 * 48 bits, so 2^24 samples can be added without a visible loss. See path_film.h. */
#include "film/path_film.h"

#include <float.h>
#include <string.h>

enum {
    RECORD_SUMS,                         /* three channels of each half */
    RECORD_RESTS = RECORD_SUMS + 6,      /* the remainders of the floats of RECORD_SUMS */
    RECORD_WEIGHTS = RECORD_RESTS + 6,   /* of each half */
    RECORD_SAMPLES = RECORD_WEIGHTS + 2, /* at most PATH_SAMPLES_MAX = 2^24, which a float represents exactly */
    RECORD_SQUARES = RECORD_SAMPLES + 1, /* three channels */
    RECORD_FLOATS = RECORD_SQUARES + 3,
    FEATURE_FLOATS = 2 * PATH_FEATURES,
    LIGHT_FLOATS = 2 * 3 * PATH_LIGHT_GROUPS, /* first all sums, then all remainders */
    ALPHA_FLOATS = 2,                         /* seen_through: the sum and its remainder */
    BRIGHT_FLOATS = 4,                        /* the divisors of the halves, each with its remainder */
};
/* After RECORD_FLOATS: the features, then the layers of light, then the sum for alpha, then the divisors, then the
 * line. */
_Static_assert((int)RECORD_FLOATS + (int)FEATURE_FLOATS + (int)LIGHT_FLOATS + (int)ALPHA_FLOATS + (int)BRIGHT_FLOATS +
                       1 <=
                   (int)FILM_RECORD_FLOATS,
               "a tile cannot carry the record of a path-traced pixel");

struct film_record path_film_record(unsigned parts) {
    uint32_t floats = RECORD_FLOATS;
    floats += parts & PATH_PART_FEATURES ? FEATURE_FLOATS : 0;
    floats += parts & PATH_PART_LIGHT ? LIGHT_FLOATS : 0;
    floats += parts & PATH_PART_ALPHA ? ALPHA_FLOATS : 0;
    floats += parts & PATH_PART_BRIGHT ? BRIGHT_FLOATS : 0;
    floats += parts & PATH_PART_LINE ? 1 : 0;
    return (struct film_record){.floats = floats, .marks = 0};
}

unsigned path_film_parts(struct film_record record) {
    for (unsigned parts = 0; parts <= PATH_PARTS; parts++)
        if (film_record_equal(record, path_film_record(parts)))
            return parts;
    return 0;
}

/* --- what a record can hold --- */

static double in_range(double x) {
    return x > (double)FLT_MAX ? (double)FLT_MAX : x < -(double)FLT_MAX ? -(double)FLT_MAX : x;
}

/* Rounds to the nearest number that two floats can represent, as path_film_store does. */
static double rounded_sum(double x) {
    double near = (double)(float)in_range(x), rest = in_range(x) - near;
    return near + (double)(float)rest;
}

static double rounded_float(double x) {
    return (double)(float)in_range(x);
}

static struct colour nearest_floats(struct colour c) {
    return colour_make(rounded_float(c.r), rounded_float(c.g), rounded_float(c.b));
}

/* --- in the film --- */

static struct colour load_sum(const float *sum, const float *rest) {
    return colour_make((double)sum[0] + (double)rest[0], (double)sum[1] + (double)rest[1],
                       (double)sum[2] + (double)rest[2]);
}

/* A record that was damaged may have any number. */
static uint32_t sample_count(float number) {
    return number > 0 && number <= (float)PATH_SAMPLES_MAX ? (uint32_t)number : 0;
}

struct path_pixel path_film_load(const struct film *film, size_t at) {
    const float *record = &film->floats[at * film->record.floats], *squares = record + RECORD_SQUARES;
    struct path_pixel pixel = {.samples = sample_count(record[RECORD_SAMPLES])};
    for (int half = 0; half < 2; half++) {
        pixel.sums[half] = load_sum(record + RECORD_SUMS + 3 * half, record + RECORD_RESTS + 3 * half);
        pixel.weights[half] = pixel.divisors[half] = (double)record[RECORD_WEIGHTS + half];
    }
    pixel.squares = colour_make((double)squares[0], (double)squares[1], (double)squares[2]);
    unsigned parts = path_film_parts(film->record);
    const float *more = record + RECORD_FLOATS;
    if (parts & PATH_PART_FEATURES) {
        memcpy(pixel.features, more, sizeof pixel.features);
        more += FEATURE_FLOATS;
    }
    for (int i = 0; i < PATH_LIGHT_GROUPS && parts & PATH_PART_LIGHT; i++)
        pixel.light[i] = load_sum(more + 3 * i, more + LIGHT_FLOATS / 2 + 3 * i);
    more += parts & PATH_PART_LIGHT ? LIGHT_FLOATS : 0;
    if (parts & PATH_PART_ALPHA)
        pixel.seen_through = (double)more[0] + (double)more[1];
    more += parts & PATH_PART_ALPHA ? ALPHA_FLOATS : 0;
    for (int half = 0; half < 2 && parts & PATH_PART_BRIGHT; half++)
        pixel.divisors[half] = (double)more[2 * half] + (double)more[2 * half + 1];
    if (parts & PATH_PART_LINE)
        pixel.line = record[film->record.floats - 1];
    return pixel;
}

static void store_colour(float out[3], struct colour colour) {
    out[0] = (float)colour.r;
    out[1] = (float)colour.g;
    out[2] = (float)colour.b;
}

/* A sum and what it leaves. */
static void store_sum(float *sum, float *rest, struct colour value) {
    struct colour near = nearest_floats(value);
    store_colour(sum, near);
    store_colour(rest, colour_sub(value, near));
}

static void store_number(float out[2], double value) {
    out[0] = (float)value;
    out[1] = (float)(value - (double)out[0]);
}

void path_film_store(struct film *film, size_t at, const struct path_pixel *pixel) {
    float *record = &film->floats[at * film->record.floats];
    for (int half = 0; half < 2; half++) {
        store_sum(record + RECORD_SUMS + 3 * half, record + RECORD_RESTS + 3 * half, pixel->sums[half]);
        record[RECORD_WEIGHTS + half] = (float)pixel->weights[half];
    }
    record[RECORD_SAMPLES] = (float)pixel->samples;
    store_colour(record + RECORD_SQUARES, pixel->squares);
    unsigned parts = path_film_parts(film->record);
    float *more = record + RECORD_FLOATS;
    if (parts & PATH_PART_FEATURES) {
        memcpy(more, pixel->features, sizeof pixel->features);
        more += FEATURE_FLOATS;
    }
    for (int i = 0; i < PATH_LIGHT_GROUPS && parts & PATH_PART_LIGHT; i++)
        store_sum(more + 3 * i, more + LIGHT_FLOATS / 2 + 3 * i, pixel->light[i]);
    more += parts & PATH_PART_LIGHT ? LIGHT_FLOATS : 0;
    if (parts & PATH_PART_ALPHA)
        store_number(more, pixel->seen_through);
    more += parts & PATH_PART_ALPHA ? ALPHA_FLOATS : 0;
    for (int half = 0; half < 2 && parts & PATH_PART_BRIGHT; half++)
        store_number(more + 2 * half, pixel->divisors[half]);
    if (parts & PATH_PART_LINE)
        record[film->record.floats - 1] = pixel->line;
    store_colour(film->pixels[at].rgb, path_pixel_below_line(pixel, path_pixel_mean(pixel)));
}

/* --- sums --- */

static struct colour rounded_sums(struct colour sum) {
    return colour_make(rounded_sum(sum.r), rounded_sum(sum.g), rounded_sum(sum.b));
}

/* By how much a sample counts less. */
static double share_of(const struct path_pixel *pixel, struct colour c) {
    return pixel->bright > 0 ? 1 / (1 + pixel->bright * fabs(0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b)) : 1;
}

void path_pixel_add_parts(struct path_pixel *pixel, const struct path_parts *parts, struct colour radiance,
                          double weight) {
    float *features = pixel->features[pixel->samples % 2];
    weight *= share_of(pixel, radiance);
    for (int i = 0; i < PATH_FEATURES; i++)
        features[i] = (float)in_range((double)features[i] + weight * (double)parts->features[i]);
    for (int i = 0; i < PATH_LIGHT_GROUPS; i++)
        pixel->light[i] = rounded_sums(colour_add(pixel->light[i], colour_scale(parts->light[i], weight)));
}

void path_pixel_add(struct path_pixel *pixel, struct colour radiance, double seen_through, double weight) {
    unsigned half = pixel->samples % 2;
    double counted = weight * share_of(pixel, radiance);
    struct colour value = colour_scale(radiance, counted), sum = colour_add(pixel->sums[half], value);
    pixel->sums[half] = rounded_sums(sum);
    pixel->squares = nearest_floats(colour_add(pixel->squares, colour_mul(value, value)));
    pixel->seen_through = rounded_sum(pixel->seen_through + counted * seen_through);
    pixel->weights[half] += weight;
    pixel->divisors[half] = pixel->bright > 0 ? rounded_sum(pixel->divisors[half] + counted) : pixel->weights[half];
    pixel->samples++;
}

/* --- means and variances --- */

static struct colour over(struct colour sum, double weight) {
    return weight == 0 ? colour_all(0) : colour_scale(sum, 1 / weight);
}

struct colour path_pixel_mean(const struct path_pixel *pixel) {
    struct colour mean = over(colour_add(pixel->sums[0], pixel->sums[1]), pixel->divisors[0] + pixel->divisors[1]);
    return colour_make(in_range(mean.r), in_range(mean.g), in_range(mean.b));
}

struct colour path_pixel_half(const struct path_pixel *pixel, int half) {
    return over(pixel->sums[half], pixel->divisors[half]);
}

struct colour path_pixel_below_line(const struct path_pixel *pixel, struct colour colour) {
    return pixel->line > 0 ? colour_scale(colour, 1 - (double)pixel->line) : colour;
}

double path_pixel_feature(const struct path_pixel *pixel, int half, int feature) {
    double weight = pixel->divisors[half];
    return weight == 0 ? 0 : (double)pixel->features[half][feature] / weight;
}

struct colour path_pixel_light(const struct path_pixel *pixel, enum path_light_group group) {
    return over(pixel->light[group], pixel->divisors[0] + pixel->divisors[1]);
}

/* The mean of both halves has half of the variance of one half; their difference has twice that variance. */
struct colour path_pixel_variance_of_halves(const struct path_pixel *pixel) {
    if (pixel->samples < 2)
        return colour_all(0);
    struct colour difference = colour_sub(path_pixel_half(pixel, 0), path_pixel_half(pixel, 1));
    return colour_scale(colour_mul(difference, difference), 0.25);
}

/* With PATH_PART_BRIGHT the mean is x / (1 - x) of a mean x of weighted grey samples, and the derivative of that is the
 * square of weights / divisors; else they are equal. */
struct colour path_pixel_variance_of_samples(const struct path_pixel *pixel) {
    double count = (double)pixel->samples, divisor = pixel->divisors[0] + pixel->divisors[1];
    double ratio = divisor == 0 ? 1 : (pixel->weights[0] + pixel->weights[1]) / divisor;
    if (pixel->samples < 2)
        return colour_all(0);
    struct colour mean = colour_scale(path_pixel_mean(pixel), 1 / ratio);
    struct colour variance = colour_sub(colour_scale(pixel->squares, 1 / count), colour_mul(mean, mean));
    return colour_scale(colour_max(variance, colour_all(0)), ratio * ratio * ratio * ratio / (count - 1));
}

/* The record of the integrator whitted has it after the first pass (whitted_record). */
static const struct film_record whitted_alpha = {.floats = 4, .marks = 1};

bool film_has_alpha(struct film_record record) {
    return film_record_equal(record, whitted_alpha) || path_film_parts(record) & PATH_PART_ALPHA;
}

float film_alpha(const struct film *film, size_t at) {
    if (film->record.marks)
        return film->floats[at * film->record.floats + 3];
    const struct path_pixel pixel = path_film_load(film, at);
    double seen = over(colour_all(pixel.seen_through), pixel.divisors[0] + pixel.divisors[1]).r;
    double open = (seen > 1 ? 1 : seen > 0 ? seen : 0) * (1 - (double)pixel.line);
    return (float)(1 - open);
}

void path_film_draw_lines(const struct film *film, float (*colours)[3]) {
    if (!(path_film_parts(film->record) & PATH_PART_LINE))
        return;
    for (size_t i = 0; i < (size_t)film->width * film->height; i++) {
        float line = film->floats[i * film->record.floats + film->record.floats - 1];
        for (int c = 0; c < 3 && line > 0; c++)
            colours[i][c] *= 1 - line;
    }
}
