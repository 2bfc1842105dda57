/* The albedo under a surface for a colour, against half spaces that are solved in other ways than for its table. */
#include "tests/harness.h"

#include "material/bsdf_select.h"
#include "material/phase.h"
#include "material/subsurface.h"
#include "tests/unit/surface_makers.h"

#include <math.h>

static const double colours[] = {0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99};
enum { COLOURS = sizeof colours / sizeof *colours, NODES = 400 };

/* What an isotropic half space reflects of light from all sides: 1 - 2 sqrt(1 - a) times the first moment of H, whose
 * integral equation is iterated (Chandrasekhar, "Radiative Transfer", 1950, sections 38 and 39). Nodes lie dense at the
 * horizon. */
static double chandrasekhar(double albedo) {
    double h[NODES], mu[NODES], weight[NODES], moment = 0;
    for (int i = 0; i < NODES; i++) {
        double x = (i + 0.5) / NODES;
        mu[i] = x * x * (3 - 2 * x);
        weight[i] = 6 * x * (1 - x) / NODES;
        h[i] = 1;
    }
    for (int turn = 0; turn < 200; turn++)
        for (int i = 0; i < NODES; i++) {
            double sum = 0;
            for (int k = 0; k < NODES; k++)
                sum += mu[k] * h[k] / (mu[i] + mu[k]) * weight[k];
            h[i] = 1 / (sqrt(1 - albedo) + albedo / 2 * sum);
        }
    for (int i = 0; i < NODES; i++)
        moment += h[i] * mu[i] * weight[i];
    return 1 - 2 * sqrt(1 - albedo) * moment;
}

TEST(an_isotropic_half_space_of_the_albedo_for_a_colour_has_it_by_chandrasekhars_functions) {
    CHECK_NEAR(chandrasekhar(0.9), 0.4780, 5e-5);
    for (int i = 0; i < COLOURS; i++)
        CHECK_NEAR(chandrasekhar(subsurface_albedo(colours[i], 0)), colours[i], fmax(1e-3 * colours[i], 2e-4));
}

/* The share of light from all sides that comes back from a half space, with its standard error. */
static double brought_back(double albedo, double g, int walks, struct test_random *random, double *error) {
    const struct phase phase = {.g = g};
    double sum = 0, squares = 0;
    for (int i = 0; i < walks; i++) {
        double z = 0, weight = 1, height = sqrt(test_uniform(random, 0, 1));
        struct vec3 d = {sqrt(1 - height * height), 0, -height};
        while (weight > 1e-3) {
            z += d.z * -log(1 - test_uniform(random, 0, 1));
            if (z > 0)
                break;
            weight *= albedo;
            d = phase_sample(&phase, vec3_negate(d),
                             (struct sample2){test_uniform(random, 0, 1), test_uniform(random, 0, 1)});
        }
        weight = z > 0 ? weight : 0;
        sum += weight;
        squares += weight * weight;
    }
    *error = sqrt((squares / walks - sum / walks * sum / walks) / walks);
    return sum / walks;
}

TEST_TIMES(walks_in_a_half_space_of_the_albedo_for_a_colour_reflect_it, 100) {
    static const double g[] = {-0.9, -0.5, 0.3, 0.8, 0.9};
    struct test_random random = {5};
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < COLOURS - 2; k++) {
            double error;
            double found = brought_back(subsurface_albedo(colours[k], g[i]), g[i], 4000 * times, &random, &error);
            CHECK_NEAR(found, colours[k], 4 * error + fmax(0.005 * colours[k], 0.001));
        }
}

/* What denoisers take for the colour of a surface. */
TEST(the_guide_of_a_surface_with_light_under_it_has_its_colour) {
    struct openpbr layers = openpbr_defaults();
    struct material wax = {.kind = MATERIAL_OPENPBR, .depth = 1, .openpbr = &layers};
    const struct material_context context = {.walks = true};
    const struct vec3 up = {0, 0, 1};
    struct hit hit = {.view = up, .front = true, .dpdu = {1, 0, 0}, .normal = up, .normal_geometric = up};
    struct bsdf bsdf;
    layers.subsurface_weight = 1;
    layers.subsurface_colour = colour_make(0.25, 0.5, 0.75);
    layers.specular_weight = 0;
    surface_eval(&wax, &hit, NULL, &context, &bsdf);
    struct bsdf_guide guide = bsdf_guide(&bsdf, colour_all(0));
    CHECK(guide.scatters && bsdf.count == 1 && bsdf.lobes[0].kind == LOBE_SUBSURFACE);
    CHECK(colour_equal(guide.albedo, layers.subsurface_colour));
    CHECK(colour_equal(bsdf.albedo, layers.subsurface_colour));
}

TEST(the_guide_of_a_surface_has_the_colours_under_its_gloss_and_those_of_its_metal) {
    struct openpbr layers = openpbr_defaults();
    struct material paint = {.kind = MATERIAL_OPENPBR, .depth = 1, .openpbr = &layers};
    const struct material_context context = {0};
    const struct vec3 up = {0, 0, 1};
    const struct colour colours_of[] = {{0.8, 0.5, 0.2}, {0.1, 0.3, 0.6}};
    struct hit hit = {.view = up, .front = true, .dpdu = {1, 0, 0}, .normal = up, .normal_geometric = up};
    layers.film_thickness = 0.5;
    for (int kind = 0; kind < 4; kind++)
        for (int i = 0; i < 2; i++) {
            struct bsdf bsdf;
            layers.base_metalness = kind % 2;
            layers.film_weight = kind / 2 * 0.2;
            paint.phong = (struct phong){.kd = colours_of[i], .ks = colour_all(1), .roughness = 0.3};
            surface_eval(&paint, &hit, NULL, &context, &bsdf);
            struct colour found = bsdf_guide(&bsdf, colour_all(0)).albedo;
            CHECK_NEAR(found.r, paint.phong.kd.r, 0.12);
            CHECK_NEAR(found.g, paint.phong.kd.g, 0.12);
            CHECK_NEAR(found.b, paint.phong.kd.b, 0.12);
            /* A gloss adds its white, with a film and without one. */
            CHECK(kind % 2 == 1 || i == 0 || found.r > paint.phong.kd.r + 0.01);
        }
}

TEST(white_is_scattered_alone_and_black_never) {
    for (double g = -0.99; g < 1; g += 0.33) {
        CHECK(subsurface_albedo(0, g) == 0);
        CHECK(subsurface_albedo(1, g) == 1);
        double below = 0;
        for (double colour = 0; colour <= 1; colour += 0x1p-6) {
            double albedo = subsurface_albedo(colour, g);
            CHECK(albedo >= below && albedo <= 1);
            below = albedo;
        }
    }
}
