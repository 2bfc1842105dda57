/* The record of path-traced pixels: halves, sums that do not depend on passes, estimates of the error. */
#include "base/random.h"
#include "film/path_film.h"
#include "render/sampler.h"
#include "tests/harness.h"

#include <float.h>
#include <math.h>
#include <string.h>

static float floats[2 * FILM_RECORD_FLOATS];
static struct film_pixel pixels[2];

static struct film two_pixels(void) {
    memset(floats, 0, sizeof floats);
    memset(pixels, 0, sizeof pixels);
    return (struct film){.width = 2, .height = 1, .record = path_film_record(0), .pixels = pixels, .floats = floats};
}

static struct colour sample_of(uint64_t seed, uint64_t number) {
    double u = random_unit(random_combine(seed, number));
    return colour_make(u * u, exp(20 * u), number % 7 == 0 ? -3 * u : 1e-9 * u);
}

TEST(the_sums_of_a_pixel_do_not_depend_on_how_its_samples_are_cut_into_passes) {
    for (uint64_t seed = 0; seed < 50; seed++) {
        struct film film = two_pixels();
        struct path_pixel straight = {0};
        for (uint64_t k = 0; k < 200; k++) {
            path_pixel_add(&straight, sample_of(seed, k), 0, 1);
            struct path_pixel cut = path_film_load(&film, 1);
            CHECK_EQ_INT(cut.samples, k);
            path_pixel_add(&cut, sample_of(seed, k), 0, 1);
            path_film_store(&film, 1, &cut);
        }
        path_film_store(&film, 0, &straight);
        CHECK(memcmp(&floats[0], &floats[film.record.floats], film.record.floats * sizeof(float)) == 0);
        CHECK(memcmp(&pixels[0], &pixels[1], sizeof pixels[0]) == 0);
    }
}

TEST(the_mean_of_a_pixel_is_that_of_its_samples_and_of_its_halves) {
    struct path_pixel pixel = {0};
    struct colour sums[2] = {{0, 0, 0}, {0, 0, 0}};
    for (uint64_t k = 0; k < 1000; k++) {
        path_pixel_add(&pixel, sample_of(7, k), 0, 1);
        sums[k % 2] = colour_add(sums[k % 2], sample_of(7, k));
    }
    struct colour mean = path_pixel_mean(&pixel);
    CHECK_NEAR(mean.r, (sums[0].r + sums[1].r) / 1000, 1e-12);
    CHECK_NEAR(mean.g, (sums[0].g + sums[1].g) / 1000, 1e-11 * mean.g);
    for (int half = 0; half < 2; half++)
        CHECK_NEAR(path_pixel_half(&pixel, half).b, sums[half].b / 500, 1e-12);
}

TEST(the_mean_of_a_pixel_of_large_samples_stays_finite) {
    struct film film = two_pixels();
    struct path_pixel pixel = {0};
    for (int k = 0; k < 9; k++)
        path_pixel_add(&pixel, colour_make((double)FLT_MAX, -(double)FLT_MAX, 1), 0, 1);
    path_film_store(&film, 0, &pixel);
    for (uint32_t i = 0; i < film.record.floats; i++)
        CHECK(isfinite(floats[i]));
    CHECK(isfinite(pixels[0].rgb[0]) && isfinite(pixels[0].rgb[1]) && pixels[0].rgb[2] == 1);
}

/* x is the mean of mapped samples b c / (1 + b c); its variance gives that of x / (1 - x) / b. */
TEST(bright_pixels_are_the_mean_of_mapped_samples_mapped_back_in_any_passes) {
    enum { COUNT = 400 };
    const double bright = 4;
    struct film film = two_pixels();
    film.record = path_film_record(PATH_PART_BRIGHT);
    struct path_pixel straight = {.bright = bright};
    double sum = 0, squares = 0;
    for (uint64_t k = 0; k < COUNT; k++) {
        double c = k % 3 == 0 ? 1000 : random_unit(random_combine(5, k)), x = bright * c / (1 + bright * c);
        struct path_pixel cut = path_film_load(&film, 1);
        cut.bright = bright;
        path_pixel_add(&straight, colour_all(c), 0, 1);
        path_pixel_add(&cut, colour_all(c), 0, 1);
        path_film_store(&film, 1, &cut);
        sum += x;
        squares += x * x;
    }
    path_film_store(&film, 0, &straight);
    CHECK(memcmp(&floats[0], &floats[film.record.floats], film.record.floats * sizeof(float)) == 0);
    double x = sum / COUNT, slope = 1 / ((1 - x) * (1 - x) * bright);
    CHECK_NEAR(path_pixel_mean(&straight).r, x / (1 - x) / bright, 1e-9);
    CHECK_NEAR(path_pixel_variance_of_samples(&straight).r / (slope * slope * (squares / COUNT - x * x) / (COUNT - 1)),
               1, 1e-4);
}

TEST(negative_weights_of_a_filter_cancel_where_the_light_is_even) {
    struct path_pixel pixel = {0};
    for (int k = 0; k < 64; k++)
        path_pixel_add(&pixel, colour_make(0.7, 2, 0), 0, k % 9 == 4 ? -1 : 1);
    CHECK_NEAR(path_pixel_mean(&pixel).r, 0.7, 1e-12);
    CHECK_NEAR(path_pixel_half(&pixel, 1).g, 2, 1e-12);
}

/* Of n independent samples with variance 1/12 the mean has the variance 1/12n. */
TEST(both_variances_of_a_pixel_are_those_of_its_mean_where_samples_are_independent) {
    enum { PIXELS = 4000, COUNT = 32 };
    double halves = 0, samples = 0, truth = 1.0 / 12 / COUNT;
    for (uint64_t p = 0; p < PIXELS; p++) {
        struct path_pixel pixel = {0};
        for (uint64_t k = 0; k < COUNT; k++)
            path_pixel_add(&pixel, colour_all(random_unit(random_combine(p, k))), 0, 1);
        halves += path_pixel_variance_of_halves(&pixel).r / PIXELS;
        samples += path_pixel_variance_of_samples(&pixel).g / PIXELS;
    }
    CHECK_NEAR(halves, truth, 4 * truth * sqrt(2.0 / PIXELS));
    CHECK_NEAR(samples, truth, 0.02 * truth);
}

/* The points of a half are strata of one another, those of the other half are not: only the difference of the halves
 * measures what the strata gain. */
TEST(the_halves_of_a_pixel_are_scrambled_independently) {
    enum { PIXELS = 4000, COUNT = 32 };
    double halves = 0, samples = 0, truth = 0;
    for (uint64_t p = 0; p < PIXELS; p++) {
        struct path_pixel pixel = {0};
        for (uint64_t k = 0; k < COUNT; k++) {
            struct sampler sampler = sampler_make_sobol(1, p, k);
            struct sample2 point = sampler_point(&sampler, SAMPLER_FIRST_VERTEX);
            path_pixel_add(&pixel, colour_all(point.x * point.x + point.y > 1 ? 1 : 0), 0, 1);
        }
        double error = path_pixel_mean(&pixel).r - 1.0 / 3;
        truth += error * error / PIXELS;
        halves += path_pixel_variance_of_halves(&pixel).r / PIXELS;
        samples += path_pixel_variance_of_samples(&pixel).r / PIXELS;
    }
    CHECK_NEAR(halves, truth, 6 * truth * sqrt(2.0 / PIXELS));
    CHECK(samples > 3 * truth);
}

TEST(a_pixel_without_samples_is_black_and_has_no_variance) {
    const struct path_pixel none = {0};
    CHECK(colour_max_abs(path_pixel_mean(&none)) == 0 && colour_max_abs(path_pixel_half(&none, 1)) == 0);
    CHECK(colour_max_abs(path_pixel_variance_of_halves(&none)) == 0);
    CHECK(colour_max_abs(path_pixel_variance_of_samples(&none)) == 0);
}
