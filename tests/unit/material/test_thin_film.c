/* Films that show colours of interference, against Airy's formula with complex amplitudes at each wavelength. */
#include "tests/harness.h"

#include "material/microfacet_internal.h"
#include "material/thin_film.h"
#include "math/elementary.h"
#include "math/spectrum.h"

#include <complex.h>
#include <math.h>

/* Cosines by Snell, imaginary where light cannot enter. */
static double complex cosine_in(double before, double n, double cosine) {
    return csqrt(1 - before * before / (n * n) * (1 - cosine * cosine));
}

/* Amplitudes between two media; along: in the plane of incidence. */
static double complex amplitude(double a, double b, double complex cos_a, double complex cos_b, bool along) {
    return along ? (a * cos_b - b * cos_a) / (a * cos_b + b * cos_a)
                 : (a * cos_a - b * cos_b) / (a * cos_a + b * cos_b);
}

/* The unpolarised reflectance of a film of index f between media of a and b at one wavelength. */
static double airy_of(double a, double f, double b, double thickness, double cosine, double wavelength) {
    double complex in = cosine_in(a, f, cosine), out = cosine_in(a, b, cosine);
    double complex turn = cexp(4 * M_PI * I * f * thickness * in / wavelength);
    double sum = 0;
    for (int along = 0; along < 2; along++) {
        double complex outer = amplitude(a, f, cosine, in, along), inner = amplitude(f, b, in, out, along);
        double size = cabs((outer + inner * turn) / (1 + outer * inner * turn));
        sum += size * size / 2;
    }
    return sum;
}

static double unit(double x) {
    return fmin(fmax(x, 0), 1);
}

static struct colour seen(double a, double f, double b, double thickness, double cosine) {
    enum { STEPS = 3000 };
    struct colour sum = {0, 0, 0};
    const double step = (SPECTRUM_MAX - SPECTRUM_MIN) / STEPS;
    for (int i = 0; i < STEPS; i++) {
        double wavelength = SPECTRUM_MIN + (i + 0.5) * step;
        sum =
            colour_add_scaled(sum, spectrum_colour(wavelength), step * airy_of(a, f, b, thickness, cosine, wavelength));
    }
    return colour_make(unit(sum.r), unit(sum.g), unit(sum.b));
}

static bool agrees(struct colour a, struct colour b, double share) {
    for (int c = 0; c < 3; c++) {
        double x = colour_get(a, c), y = colour_get(b, c);
        if (!(fabs(x - y) <= share * fmax(y, 0.01)))
            return false;
    }
    return true;
}

/* Soap in air, oil on water, a coating on glass from both sides, dense oxides. */
TEST_TIMES(a_film_reflects_airy_s_formula_as_the_observer_sees_it, 20) {
    struct test_random random = {5};
    for (int k = 0; k < 100 * times; k++) {
        double a = k % 4 == 0 ? 1.5 : 1, b = k % 4 == 0 ? 1 : k % 4 == 1 ? 1 : test_uniform(&random, 1.2, 2.6);
        double f = test_uniform(&random, 1.2, 2.2), cosine = test_uniform(&random, 0.05, 1);
        double thickness = test_uniform(&random, 0, 1) * test_uniform(&random, 0, 6);
        if (a * sqrt(1 - cosine * cosine) > 0.999 * fmin(f, b))
            continue;
        const struct thin_film film = {1, thickness, f, a, 0};
        struct colour found = thin_film_boundary(&film, cosine, a / b), expected = seen(a, f, b, thickness, cosine);
        if (!agrees(found, expected, 0.01))
            test_fail(__FILE__, __LINE__, "%g %g %g, %g um, cosine %g: %g %g %g, not %g %g %g", a, f, b, thickness,
                      cosine, found.r, found.g, found.b, expected.r, expected.g, expected.b);
    }
}

TEST(light_of_one_wavelength_has_the_interference_of_that_wavelength) {
    for (int k = 0; k < 200; k++) {
        double wavelength = 0.38 + 0.002 * k, cosine = 0.1 + 0.0045 * k, thickness = 0.01 * k;
        const struct thin_film film = {1, thickness, 1.33, 1, wavelength};
        struct colour found = thin_film_boundary(&film, cosine, 1 / 1.7);
        CHECK_NEAR(found.g, airy_of(1, 1.33, 1.7, thickness, cosine, wavelength), 1e-12);
        CHECK(found.r == found.g && found.b == found.g);
    }
}

/* Of glass from both sides, at total reflection too, and of metal, whatever its colour. */
TEST(a_film_without_thickness_changes_nothing) {
    for (int k = 0; k < 200; k++) {
        double cosine = (k + 1) / 200.0, eta = k % 3 == 0 ? 1.5 : k % 3 == 1 ? 1 / 1.5 : 1;
        const struct thin_film film = {1, 0, 1.4, eta > 1 ? eta : 1, 0};
        struct colour bare = {0.9, 0.5, 0.04}, metal = thin_film_metal(&film, cosine, bare);
        CHECK_NEAR(thin_film_boundary(&film, cosine, eta).r, dielectric_fresnel(cosine, eta), 1e-9);
        CHECK_NEAR(metal.r, bare.r, 1e-9);
        CHECK_NEAR(metal.b, bare.b, 1e-9);
    }
}

/* Metal as a reflection that turns the phase by half a period: its amplitude below the film is the one that leaves the
 * bare reflectance where the film has no thickness. */
TEST(a_film_on_metal_reflects_airy_s_formula_of_its_amplitude) {
    for (int k = 0; k < 60; k++) {
        enum { STEPS = 3000 };
        double cosine = 0.1 + 0.015 * k, thickness = 0.02 * k, f = 1.4 + 0.01 * k;
        const double bare[3] = {0.95, 0.6, 0.3}, step = (SPECTRUM_MAX - SPECTRUM_MIN) / STEPS;
        const struct thin_film film = {1, thickness, f, 1, 0};
        double in = creal(cosine_in(1, f, cosine)), expected[3];
        for (int c = 0; c < 3; c++) {
            double sum = 0;
            for (int i = 0; i < STEPS; i++) {
                double wavelength = SPECTRUM_MIN + (i + 0.5) * step;
                double complex turn = cexp(4 * M_PI * I * f * thickness * in / wavelength);
                for (int along = 0; along < 2; along++) {
                    double outer = creal(amplitude(1, f, cosine, in, along)), whole = -sqrt(bare[c]);
                    double inner = (whole - outer) / (1 - whole * outer);
                    double size = cabs((outer + inner * turn) / (1 + outer * inner * turn));
                    sum += step * size * size / 2 * colour_get(spectrum_colour(wavelength), c);
                }
            }
            expected[c] = unit(sum);
        }
        struct colour found = thin_film_metal(&film, cosine, colour_make(bare[0], bare[1], bare[2]));
        if (!agrees(found, colour_make(expected[0], expected[1], expected[2]), 0.01))
            test_fail(__FILE__, __LINE__, "%g um, cosine %g: %g %g %g, not %g %g %g", thickness, cosine, found.r,
                      found.g, found.b, expected[0], expected[1], expected[2]);
        CHECK_NEAR(thin_film_metal(&film, cosine, colour_all(1)).g, 1, 1e-9);
    }
}

/* Two sides of glass reflect 2 F / (1 + F); a wall of the index of air is one film of soap. */
TEST(a_wall_without_another_index_is_its_film_alone) {
    const struct thin_film film = {1, 0.4, 1.33, 1, 0};
    struct colour soap = seen(1, 1.33, 1, 0.4, 0.8), side = thin_film_boundary(&film, 0.8, 1 / 1.5);
    CHECK(agrees(thin_film_pane(&film, 0.8, 1), soap, 0.01));
    CHECK_NEAR(thin_film_pane(&film, 0.8, 1 / 1.5).r, 2 * side.r / (1 + side.r), 1e-12);
}

TEST(extreme_films_reflect_between_nothing_and_all) {
    static const double values[] = {0, 1e-30, 1e-3, 1, 1e3, 1e30, INFINITY};
    for (int k = 0; k < 7 * 7 * 4; k++) {
        const struct thin_film film = {1, values[k % 7], fmax(values[k / 7 % 7], 0.01), 1, k / 49 % 2 ? 0.5 : 0};
        double cosine = k / 98 ? 1 : 1e-12;
        struct colour glass = thin_film_boundary(&film, cosine, 1 / 1.5);
        struct colour metal = thin_film_metal(&film, cosine, colour_make(1, 0.5, 0));
        for (int c = 0; c < 3; c++)
            if (!(colour_get(glass, c) >= 0 && colour_get(glass, c) <= 1 && colour_get(metal, c) >= 0 &&
                  colour_get(metal, c) <= 1))
                test_fail(__FILE__, __LINE__, "film %d: %g, %g", k, colour_get(glass, c), colour_get(metal, c));
    }
}
