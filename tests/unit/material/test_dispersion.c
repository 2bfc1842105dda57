/* Indices of refraction by the wavelength: the numbers of the catalogue, Abbe's number, and the deviation of a prism.
 */
#include "tests/harness.h"
#include "tests/unit/surface_makers.h"

#include "material/dispersion.h"
#include "material/glasses.h"
#include "material/material_inputs.h"
#include "material/openpbr.h"

#include <math.h>
#include <string.h>

static const double line_d = 0.5875618, line_f = 0.4861327, line_c = 0.6562725;

#define NAME(name, ...) name,
static const char *const names[] = {GLASSES(NAME)};
#undef NAME
enum { GLASS_COUNT = sizeof names / sizeof *names };

static uint32_t glass_named(const char *name) {
    uint32_t i = 0;
    while (i < GLASS_COUNT && strcmp(names[i], name) != 0)
        i++;
    return i + 1;
}

static double index_at(uint32_t glass, double wavelength) {
    return dispersion_ior((struct dispersion){1, glass}, glass_ior(glass), wavelength);
}

/* As SCHOTT prints them; of the others, the authors' or usual numbers. */
TEST(glasses_have_the_indices_and_the_abbe_numbers_of_their_catalogue) {
    static const struct {
        const char *name;
        double ior, abbe, ior_error, abbe_error;
    } rows[] = {
        {"N-BK7", 1.51680, 64.17, 6e-6, 6e-3},   {"N-BK10", 1.49782, 66.95, 6e-6, 6e-3},
        {"N-K5", 1.52249, 59.48, 6e-6, 6e-3},    {"N-FK5", 1.48749, 70.41, 6e-6, 6e-3},
        {"N-FK51A", 1.48656, 84.47, 6e-6, 6e-3}, {"N-BAK4", 1.56883, 55.98, 6e-6, 6e-3},
        {"N-SK16", 1.62041, 60.32, 6e-6, 6e-3},  {"N-BAF10", 1.67003, 47.11, 6e-6, 6e-3},
        {"N-LASF9", 1.85025, 32.17, 6e-6, 6e-3}, {"F2", 1.62004, 36.37, 6e-6, 6e-3},
        {"N-F2", 1.62005, 36.43, 6e-6, 6e-3},    {"N-SF5", 1.67271, 32.25, 6e-6, 6e-3},
        {"N-SF10", 1.72828, 28.53, 6e-6, 6e-3},  {"N-SF11", 1.78472, 25.68, 6e-6, 6e-3},
        {"SF11", 1.78472, 25.76, 6e-6, 6e-3},    {"SF10", 1.72825, 28.41, 6e-6, 6e-3},
        {"N-SF6", 1.80518, 25.36, 6e-6, 6e-3},   {"N-SF66", 1.92286, 20.88, 6e-6, 6e-3},
        {"silica", 1.45846, 67.82, 6e-6, 6e-3},  {"fluorite", 1.43385, 95.0, 1e-5, 0.05},
        {"sapphire", 1.7682, 72.2, 1e-4, 0.3},   {"diamond", 2.4175, 55.3, 1e-4, 0.1},
        {"water", 1.3334, 55.8, 1e-4, 0.2},
    };
    CHECK_EQ_INT((int)(sizeof rows / sizeof *rows), GLASS_COUNT);
    for (int i = 0; i < GLASS_COUNT; i++) {
        uint32_t glass = glass_named(rows[i].name);
        double d = index_at(glass, line_d), f = index_at(glass, line_f), c = index_at(glass, line_c);
        CHECK_NEAR(d, rows[i].ior, rows[i].ior_error);
        CHECK_NEAR((d - 1) / (f - c), rows[i].abbe, rows[i].abbe_error);
        CHECK_NEAR(index_at(glass, 0), d, 1e-15);
    }
}

TEST(the_law_of_cauchy_has_the_abbe_number_that_the_material_states) {
    for (double abbe = 10; abbe < 100; abbe += 17) {
        for (double scale = 0.5; scale < 3; scale *= 2) {
            struct dispersion law = {scale / abbe, 0};
            double d = dispersion_ior(law, 1.6, line_d);
            CHECK_NEAR(d, 1.6, 1e-15);
            CHECK_NEAR((d - 1) / (dispersion_ior(law, 1.6, line_f) - dispersion_ior(law, 1.6, line_c)), abbe / scale,
                       1e-9);
        }
    }
    CHECK_NEAR(dispersion_ior((struct dispersion){0, 0}, 1.6, 0.4), 1.6, 0);
    CHECK(dispersion_ior((struct dispersion){1e30, 0}, 1.6, 0.7) > 0); /* no index is 0 or below */
}

/* --- a prism --- */

struct prism {
    const struct material *material;
    struct medium medium;
};

/* Through a face with this outer normal; *ray and the media change. False: total reflection. */
static bool pass(const struct prism *prism, struct vec3 normal, struct vec3 *ray, struct medium_stack *media) {
    struct hit hit = {.view = vec3_negate(*ray), .front = vec3_dot(*ray, normal) < 0, .primitive = 4};
    const struct material_context context = {.total_reflection = true};
    struct bsdf bsdf;
    hit.normal = hit.normal_geometric = normal;
    surface_eval(prism->material, &hit, media, &context, &bsdf);
    *ray = bsdf.through;
    medium_stack_cross(media, &bsdf.boundary);
    return bsdf.transmits;
}

/* The angle by which two faces with an angle of 60 degrees between them turn light of a wavelength. */
static double deviation(struct prism *prism, double incidence, double wavelength) {
    static const struct solid solid = {4, 0};
    const struct media inside = {&solid, &prism->medium, 0};
    struct medium_stack media = {.media = &inside, .wavelength = (float)wavelength};
    struct vec3 in = {-cos(M_PI / 6), sin(M_PI / 6), 0}, out = {cos(M_PI / 6), sin(M_PI / 6), 0};
    struct vec3 along = {sin(M_PI / 6), cos(M_PI / 6), 0};
    struct vec3 ray = vec3_add_scaled(vec3_scale(in, -cos(incidence)), along, sin(incidence)), first = ray;
    if (!pass(prism, in, &ray, &media) || !pass(prism, out, &ray, &media))
        return INFINITY;
    CHECK_EQ_INT((int)media.count, 0);
    return acos(vec3_dot(first, ray));
}

static double smallest_deviation(struct prism *prism, double wavelength) {
    double min = INFINITY;
    for (int i = 0; i < 2000; i++)
        min = fmin(min, deviation(prism, 0.75 + 0.4 * i / 2000, wavelength));
    return min;
}

/* D = 2 asin(n sin 30) - 60 degrees, of classic and of layered glass. */
TEST(a_prism_turns_three_wavelengths_by_the_smallest_deviation_of_their_indices) {
    static const struct {
        const char *name;
        double wavelength, ior; /* of the catalogue */
    } rows[] = {{"N-BK7", 0.4861327, 1.52238},  {"N-BK7", 0.5875618, 1.51680},  {"N-BK7", 0.6562725, 1.51432},
                {"N-SF11", 0.4861327, 1.80651}, {"N-SF11", 0.5875618, 1.78472}, {"N-SF11", 0.6562725, 1.77596}};
    for (int layered = 0; layered < 2; layered++) {
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            struct openpbr numbers = openpbr_defaults();
            struct material material = {.kind = MATERIAL_PHONG, .depth = 1};
            struct dispersion dispersion = {1, glass_named(rows[i].name)};
            double ior = numbers.specular_ior = glass_ior(dispersion.glass);
            material.openpbr = layered ? &numbers : NULL;
            material.phong = (struct phong){.ks = colour_all(1), .refract = 1, .ior = ior, .has_ior = true};
            material.phong.dispersion = dispersion;
            struct prism prism = {&material,
                                  medium_inside(ior, colour_all(1), &(struct medium_input){.scattering = {0, 0, 0}})};
            prism.medium.dispersion = dispersion;
            double expected = 2 * asin(rows[i].ior / 2) - M_PI / 3;
            CHECK_NEAR(smallest_deviation(&prism, rows[i].wavelength), expected, 1e-4);
            if (i == 1)
                CHECK_NEAR(smallest_deviation(&prism, 0), expected, 1e-4);
        }
    }
}
