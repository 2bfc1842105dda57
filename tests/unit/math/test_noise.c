/* Noise and the patterns: the values of docs/language.md 5.6, continuity, bounds, and coordinates that are difficult to
 * convert.
 */
#include <math.h>

#include "math/elementary.h"
#include "math/noise.h"
#include "tests/harness.h"

static const double pi = 0x1.921fb54442d18p+1;

TEST(noise_is_perlins_reference_with_interpolation_0) {
    CHECK(noise_perlin(3.14, 42.0, 7.0, 0) == 0.13691995878400012);
}

TEST(noise_mixes_by_cosine_with_interpolation_1) {
    CHECK_NEAR(noise_perlin(3.14, 42.0, 7.0, 1), 0.13983287, 1e-8);
}

TEST(noise_cosine_mix_meets_both_ends_and_the_middle) {
    CHECK(noise_cosine_mix(0.0, 3.0, 5.0) == 3.0);
    CHECK(noise_cosine_mix(1.0, 3.0, 5.0) == 5.0);
    CHECK_NEAR(noise_cosine_mix(0.5, 3.0, 5.0), 4.0, 1e-15);
    CHECK_NEAR(noise_cosine_mix(1.0 / 3, 0.0, 1.0), 0.25, 1e-15);
}

TEST(noise_is_zero_at_lattice_points_and_repeats_after_256) {
    struct test_random random = {7};
    for (int i = 0; i < 2000; i++) {
        double x = test_uniform(&random, -300, 300), y = test_uniform(&random, -300, 300);
        double z = test_uniform(&random, -300, 300);
        CHECK(noise_perlin(floor(x), floor(y), floor(z), i & 1) == 0.0);
        /* a multiple of 2^-20 survives the shift without rounding */
        x = floor(x * 0x1.0p20) * 0x1.0p-20;
        CHECK(noise_perlin(x, y, z, i & 1) == noise_perlin(x + 256.0, y, z, i & 1));
        CHECK(noise_perlin(x, y, z, i & 1) == noise_perlin(x - 0x1.0p32, y, z, i & 1));
    }
}

TEST(noise_stays_in_bounds_and_is_continuous) {
    struct test_random random = {11};
    double low = 0, high = 0, jump = 0;
    for (int i = 0; i < 100000; i++) {
        double x = test_uniform(&random, -20, 20), y = test_uniform(&random, -20, 20),
               z = test_uniform(&random, -20, 20);
        if (i % 4 == 0)
            x = floor(x); /* the seams between cells */
        double value = noise_perlin(x, y, z, i & 1);
        double beside = noise_perlin(x - 1e-7, y, z, i & 1);
        low = fmin(low, value);
        high = fmax(high, value);
        jump = fmax(jump, fabs(value - beside));
    }
    CHECK(low >= -1.05 && high <= 1.05);
    CHECK(low < -0.6 && high > 0.6);
    CHECK(jump < 1e-6);
}

TEST(noise_is_defined_for_every_double) {
    static const double odd[] = {NAN,       INFINITY, -INFINITY, 1e300,  -1e300, 0x1.0p31,
                                 -0x1.0p31, 0x1.0p53, -0x1.0p63, 0x1p63, 5e-324, -5e-324,
                                 -0.0,      1e17,     -4e18,     255.5,  -255.5, 2147483647.5};
    int count = (int)(sizeof odd / sizeof *odd);
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            for (int k = 0; k < count; k++) {
                double value = noise_perlin(odd[i], odd[j], odd[k], (i + j) & 1);
                CHECK(value >= -1.05 && value <= 1.05);
                double wood = noise_wood(odd[i], odd[j], odd[k], 1e10, odd[(i + j + k) % count], k & 1);
                double marble = noise_marble(vec3_make(odd[i], odd[j], odd[k]), 0.5, odd[(i + k) % count], 3.0, k & 1);
                CHECK(wood >= 0.0 && wood <= 1.0);
                CHECK(marble >= 0.0 && marble <= 1.0);
            }
        }
    }
    CHECK(noise_perlin(NAN, 0.5, 0.5, 0) == 0.0);
}

TEST(noise_wood_is_the_formula_of_the_language) {
    struct test_random random = {3};
    for (int i = 0; i < 500; i++) {
        double x = test_uniform(&random, -5, 5), y = test_uniform(&random, -5, 5), z = test_uniform(&random, -5, 5);
        double t = 11.0 * noise_perlin(0.7 * x, 0.7 * y, 0.7 * z, i & 1);
        t = t - floor(t);
        double want = (1 - el_cos(pi * (0.5 + 0.5 * t))) / 2;
        CHECK_NEAR(noise_wood(x, y, z, 0.7, 11.0, i & 1), want, 1e-15);
    }
}

TEST(noise_marble_is_the_formula_of_the_language) {
    struct test_random random = {5};
    for (int i = 0; i < 500; i++) {
        double x = test_uniform(&random, -5, 5), y = test_uniform(&random, -5, 5), z = test_uniform(&random, -5, 5);
        double sum = noise_perlin(2 * x, 2 * y, 2 * z, i & 1) + noise_perlin(8 * x, 8 * y, 8 * z, i & 1) / 4 +
                     noise_perlin(32 * x, 32 * y, 32 * z, i & 1) / 16 +
                     noise_perlin(128 * x, 128 * y, 128 * z, i & 1) / 64;
        double want = (1 - el_cos(pi * (1 + el_cos(6 * y + 3 * sum)) / 2)) / 2;
        CHECK_NEAR(noise_marble(vec3_make(x, y, z), 2.0, 3.0, 6.0, i & 1), want, 1e-14);
    }
}
