/* The points of path samples: scrambled (0,2)-sequences, each point uniform in the unit square. */
#include "render/sampler.h"
#include "tests/harness.h"

#include <math.h>
#include <string.h>

/* Of points first to first + 2^m - 1 each elementary interval 2^-i by 2^(i-m) holds one. */
static void check_net(uint64_t seed, uint32_t first, uint32_t m) {
    static uint8_t taken[1 << 12];
    uint32_t count = UINT32_C(1) << m;
    for (uint32_t i = 0; i <= m; i++) {
        memset(taken, 0, count);
        for (uint32_t k = 0; k < count; k++) {
            struct sample2 p = sobol_point(first + k, seed);
            uint32_t column = (uint32_t)(p.x * (UINT32_C(1) << i)), row = (uint32_t)(p.y * (UINT32_C(1) << (m - i)));
            taken[column << (m - i) | row]++;
        }
        for (uint32_t k = 0; k < count; k++)
            CHECK_EQ_INT(taken[k], 1);
    }
}

TEST(points_of_paths_are_a_zero_two_sequence) {
    for (uint64_t seed = 0; seed < 8; seed++) {
        uint64_t key = random_combine(9, seed);
        check_net(key, 0, 12);
        check_net(key, 0, 7);
        for (uint32_t block = 1; block < 20; block++)
            check_net(key, block << 5, 5);
    }
}

/* Joe and Kuo 2008, dimensions 1 and 2: v_k = 2^-k, and v_k = v_(k-1) xor v_(k-1) / 2. */
TEST(the_sequence_is_that_of_the_direction_numbers_of_joe_and_kuo) {
    for (uint32_t index = 0; index < 5000; index += 3) {
        uint32_t x = 0, y = 0, u = UINT32_C(1) << 31, v = u;
        for (uint32_t bits = index; bits; bits >>= 1, u >>= 1, v ^= v >> 1) {
            x ^= bits & 1 ? u : 0;
            y ^= bits & 1 ? v : 0;
        }
        CHECK_EQ_INT(sobol_reversed(index), x);
        CHECK_EQ_INT(sobol_reversed(sobol_pascal(index)), y);
    }
}

/* Every point of a scrambled sequence is uniform over the seeds, and so is a pair of them. */
TEST(scrambled_points_are_unbiased) {
    enum { SEEDS = 20000, CELLS = 8 };
    for (uint32_t index = 0; index < 5; index++) {
        static int counts[CELLS * CELLS];
        double sum = 0, chi = 0, expected = (double)SEEDS / (CELLS * CELLS);
        memset(counts, 0, sizeof counts);
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            struct sample2 p = sobol_point(index, random_combine(4711, seed));
            CHECK(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
            counts[(int)(p.x * CELLS) * CELLS + (int)(p.y * CELLS)]++;
            sum += p.x * p.x + exp(p.y);
        }
        for (int i = 0; i < CELLS * CELLS; i++)
            chi += (counts[i] - expected) * (counts[i] - expected) / expected;
        CHECK(chi < 63 + 5 * sqrt(2 * 63.0)); /* 63 degrees of freedom */
        CHECK_NEAR(sum / SEEDS, 1.0 / 3 + exp(1) - 1, 5 * 0.6 / sqrt((double)SEEDS));
    }
}

/* Mean square error of the mean of f over n points: white noise has Var / n. */
TEST(the_error_of_a_smooth_mean_falls_faster_than_that_of_random_points) {
    double error[2] = {0, 0};
    const int counts[2] = {64, 1024};
    for (int c = 0; c < 2; c++) {
        for (uint64_t seed = 0; seed < 200; seed++) {
            double sum = 0;
            for (uint32_t i = 0; i < (uint32_t)counts[c]; i++) {
                struct sample2 p = sobol_point(i, random_combine(5, seed));
                sum += p.x * p.y + sin(3 * p.x);
            }
            double e = sum / counts[c] - (0.25 + (1 - cos(3)) / 3);
            error[c] += e * e / 200;
        }
    }
    CHECK(error[0] < 0.1 / 64 / 20);
    CHECK(error[1] < error[0] / 256); /* sixteen times the points: at least 1 / n^2 */
}

/* Two dimensions of one sample, and one dimension of two pixels, are independent. */
TEST(dimensions_and_pixels_are_independent) {
    enum { PIXELS = 4000 };
    double dimensions = 0, pixels = 0;
    for (uint64_t pixel = 0; pixel < PIXELS; pixel++) {
        struct sampler a = sampler_make_sobol(1, pixel, 5), b = sampler_make_sobol(1, pixel + 1, 5);
        dimensions += (sampler_point(&a, 3).x - 0.5) * (sampler_point(&a, 4).x - 0.5);
        pixels += (sampler_point(&a, 3).y - 0.5) * (sampler_point(&b, 3).y - 0.5);
    }
    CHECK_NEAR(dimensions / PIXELS, 0, 5.0 / 12 / sqrt((double)PIXELS));
    CHECK_NEAR(pixels / PIXELS, 0, 5.0 / 12 / sqrt((double)PIXELS));
}
