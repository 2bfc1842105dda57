/* Layered materials: the layers by closed forms, the tables of albedos by sums over facets, and white materials in
 * uniform light, from which all of it has to come back. */
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/colour_length.h"
#include "tests/unit/path_estimate.h"
#include "tests/unit/surface_makers.h"

#include "material/albedo_internal.h"
#include "material/material_inputs.h"
#include "material/metals.h"
#include "material/microfacet_internal.h"
#include "material/openpbr.h"
#include "material/rough_lobes_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A material with numbers of its own, white, polished and without any layer but the base. */
struct layers {
    struct openpbr numbers;
    struct material material;
};

static void layers_init(struct layers *layers) {
    *layers = (struct layers){.numbers = openpbr_defaults(), .material = {.kind = MATERIAL_OPENPBR, .depth = 1}};
    layers->material.openpbr = &layers->numbers;
    layers->material.phong.kd = layers->material.phong.ks = colour_all(1);
    layers->material.phong.two_sided = true;
}

/* The surface z = 0, seen at a cosine from outside or from inside. */
static struct bsdf seen(const struct layers *layers, double cosine, bool front) {
    struct hit hit = {.view = {sqrt(1 - cosine * cosine), 0, front ? cosine : -cosine}, .front = front, .primitive = 4};
    struct medium medium = {.ior = layers->numbers.specular_ior};
    const struct media media = {&(struct solid){4, 0}, &medium, 0};
    struct medium_stack inside = {.media = &media};
    struct bsdf bsdf;
    hit.normal = hit.normal_geometric = vec3_make(0, 0, 1);
    medium_stack_enter(&inside, 0);
    const struct material_context context = {.total_reflection = true};
    surface_eval(&layers->material, &hit, front ? NULL : &inside, &context, &bsdf);
    return bsdf;
}

static struct vec3 view_of(double cosine, bool front) {
    return vec3_make(sqrt(1 - cosine * cosine), 0, front ? cosine : -cosine);
}

/* The share of light that comes back or goes on. */
static struct estimate albedo_of(const struct bsdf *bsdf, uint32_t lobes, struct vec3 wo, uint64_t key, uint32_t n) {
    double sum = 0, sum2 = 0;
    for (uint32_t i = 0; i < n * n; i++) {
        struct bsdf_sample sample;
        struct sample2 u = sample_cell(key, i % n, i / n, n);
        double x = bsdf_sample(bsdf, lobes, BSDF_IMPORTANCE, wo, u, &sample) ? sample.weight.g : 0;
        sum += x;
        sum2 += x * x;
    }
    double count = (double)n * n, mean = sum / count;
    return (struct estimate){mean, sqrt(fmax(sum2 / count - mean * mean, 0) / count)};
}

/* --- albedos --- */

/* One lobe alone, with the weight 1. */
static struct bsdf one_lobe(const struct layers *layers, enum lobe_kind kind, double cosine, bool front) {
    struct bsdf bsdf = seen(layers, cosine, front);
    for (int i = 0; i < bsdf.count; i++) {
        if (bsdf.lobes[i].kind != kind)
            continue;
        bsdf.lobes[0] = bsdf.lobes[i];
        bsdf.lobes[0].weight = colour_all(1);
        bsdf.count = 1;
        return bsdf;
    }
    bsdf.count = 0;
    return bsdf;
}

TEST_TIMES(tables_of_albedos_are_sums_over_facets, 20) {
    struct test_random random = {3};
    for (int k = 0; k < 20 * times; k++) {
        struct layers glass, metal;
        double cosine = test_uniform(&random, 0.1, 1), roughness = test_uniform(&random, 0.1, 1);
        double ior = test_uniform(&random, 1.1, 2.6);
        bool front = k & 1;
        layers_init(&glass);
        layers_init(&metal);
        glass.material.phong.roughness = metal.material.phong.roughness = roughness;
        glass.material.phong.refract = metal.numbers.base_metalness = 1;
        glass.numbers.specular_ior = ior;
        double eta = front ? 1 / ior : ior, mirrored, reflected, through;
        struct vec3 wo = view_of(cosine, front);
        struct bsdf bsdf = one_lobe(&metal, LOBE_METAL, cosine, front);
        mirrored = albedo_of(&bsdf, BSDF_ALL, wo, 7, 150).mean;
        CHECK_NEAR(albedo_mirror(cosine, roughness), mirrored, 2e-3);
        bsdf = one_lobe(&glass, LOBE_GLOSS, cosine, front);
        reflected = albedo_of(&bsdf, BSDF_ALL, wo, 8, 150).mean;
        bsdf = one_lobe(&glass, LOBE_GLASS, cosine, front);
        through = albedo_of(&bsdf, BSDF_ALL, wo, 9, 150).mean;
        CHECK_NEAR(albedo_boundary(cosine, roughness, eta), reflected + through, front ? 3e-3 : 1.5e-2);
        CHECK_NEAR(albedo_reflection(cosine, roughness, eta), reflected, front ? 1e-3 : 5e-2);
    }
}

TEST(averages_of_albedos_are_integrals_of_their_tables) {
    enum { N = 400 };
    for (double roughness = 0.1; roughness <= 1; roughness += 0.1) {
        double mirror = 0, outside = 0, inside = 0;
        for (int i = 0; i < N; i++) {
            double c = (i + 0.5) / N;
            mirror += 2 * c / N * albedo_mirror(c, roughness);
            outside += 2 * c / N * albedo_boundary(c, roughness, 1 / 1.5);
            inside += 2 * c / N * albedo_boundary(c, roughness, 1.5);
        }
        CHECK_NEAR(albedo_mirror_average(roughness), mirror, 1e-3);
        CHECK_NEAR(albedo_boundary_average(roughness, 1 / 1.5), outside, 1e-3);
        CHECK_NEAR(albedo_boundary_average(roughness, 1.5), inside, 3e-3);
    }
}

/* Facets of the width 1, seen head on, send 1 - ln 2 on where they reflect all. */
TEST(the_widest_facets_send_on_one_minus_the_logarithm_of_two) {
    struct layers metal;
    layers_init(&metal);
    metal.numbers.base_metalness = metal.material.phong.roughness = 1;
    struct bsdf bsdf = one_lobe(&metal, LOBE_METAL, 1, true);
    CHECK_EQ_INT(bsdf.count, 1);
    estimate_check("GGX, one scattering, alpha 1, head on, F = 1", 1 - log(2),
                   albedo_of(&bsdf, BSDF_ALL, view_of(1, true), 1, 1250), 1, 0.001);
    CHECK_NEAR(albedo_mirror(1, 1), 1 - log(2), 5e-4);
}

TEST(the_mean_of_fresnel_s_formula_is_its_integral) {
    enum { N = 20000 };
    for (double n = 1.01; n < 4; n *= 1.3) {
        double outside = 0, inside = 0;
        for (int i = 0; i < N; i++) {
            double c = (i + 0.5) / N;
            outside += 2 * c / N * dielectric_fresnel(c, 1 / n);
            inside += 2 * c / N * dielectric_fresnel(c, n);
        }
        CHECK_NEAR(dielectric_fresnel_average(1 / n), outside, 1e-6);
        CHECK_NEAR(dielectric_fresnel_average(n), inside, 1e-5);
    }
}

TEST(fuzz_reflects_what_its_table_says_and_never_more_than_arrives) {
    for (double roughness = 0; roughness <= 1; roughness += 0.125) {
        for (double cosine = 0.05; cosine <= 1; cosine += 0.19) {
            struct layers fuzz;
            layers_init(&fuzz);
            fuzz.numbers.fuzz_weight = 1;
            fuzz.numbers.fuzz_roughness = roughness;
            struct bsdf bsdf = one_lobe(&fuzz, LOBE_FUZZ, cosine, true);
            double albedo = albedo_of(&bsdf, BSDF_ALL, view_of(cosine, true), 4, 150).mean;
            CHECK_NEAR(albedo, albedo_fuzz(cosine, roughness), 3e-3);
            CHECK(albedo < 1);
        }
    }
}

/* --- metals --- */

TEST(metals_reflect_what_they_were_measured_to_reflect_head_on_and_at_82_degrees) {
    struct bsdf_facets facets;
    struct colour f0 = {0.9, 0.5, 0.1}, tint = {0.9, 1, 0.7};
    bsdf_facets_shape(&facets, vec3_make(0, 0, 1), vec3_all(0), 0.5, 0);
    bsdf_facets_metal(&facets, f0, tint);
    struct colour head_on = bsdf_metal_fresnel(&facets, 1), at_82 = bsdf_metal_fresnel(&facets, 1.0 / 7);
    CHECK_NEAR(head_on.r, 0.9, 1e-15);
    CHECK_NEAR(head_on.b, 0.1, 1e-15);
    double fifth = pow(6.0 / 7, 5);
    CHECK_NEAR(at_82.r, 0.9 * (0.9 + 0.1 * fifth), 1e-14);
    CHECK_NEAR(at_82.b, 0.7 * (0.1 + 0.9 * fifth), 1e-14);
    struct colour sum = {0, 0, 0};
    for (int i = 0; i < 10000; i++)
        sum = colour_add_scaled(sum, bsdf_metal_fresnel(&facets, (i + 0.5) / 10000), 2 * (i + 0.5) / 1e8);
    struct colour average = bsdf_metal_fresnel_average(&facets);
    CHECK_NEAR(average.r, sum.r, 1e-7);
    CHECK_NEAR(average.g, sum.g, 1e-7);
    CHECK_NEAR(average.b, sum.b, 1e-7);
}

TEST(facets_that_lose_nothing_are_seen_to_lose_nothing_whatever_the_memory_held) {
    int lossless = 0;
    for (int i = 0; i < 20; i++)
        for (int k = 0; k < 30; k++) {
            struct bsdf_facets facets;
            memset(&facets, 0xff, sizeof facets);
            bsdf_facets_shape(&facets, vec3_make(0, 0, 1), vec3_all(0), exp(-i / 3.0), 0);
            bsdf_facets_glass(&facets, exp((k - 14.5) / 16));
            bsdf_facets_see(&facets, vec3_make(0.6, 0, 0.8));
            CHECK(facets.lack > 0 ? facets.lack_seen >= 0 && facets.lack_seen < 1 : facets.lack_seen == 0);
            lossless += !(facets.lack > 0);
        }
    CHECK(lossless > 0);
}

/* Silver at 549 nm has n = 0.06 + 3.586 i (Johnson and Christy 1972); gold and copper lack blue, in this order. */
TEST(the_table_of_metals_has_the_colours_of_metals) {
    struct metal {
        const char *name;
        double colour[3], tint[3];
    };
#define ROW(name, r, g, b, tint_r, tint_g, tint_b) {name, {r, g, b}, {tint_r, tint_g, tint_b}},
    static const struct metal metals[] = {METALS(ROW)};
#undef ROW
    int known = 0;
    for (size_t i = 0; i < sizeof metals / sizeof *metals; i++) {
        const double *c = metals[i].colour, *t = metals[i].tint;
        for (int k = 0; k < 3; k++)
            CHECK(c[k] > 0.3 && c[k] <= 1 && t[k] > 0.6 && t[k] * (c[k] + (1 - c[k]) * pow(6.0 / 7, 5)) < 1);
        if (strcmp(metals[i].name, "silver") == 0)
            CHECK_NEAR(c[1], (pow(0.06 - 1, 2) + 3.586 * 3.586) / (pow(0.06 + 1, 2) + 3.586 * 3.586), 0.005);
        if (strcmp(metals[i].name, "gold") == 0)
            CHECK(c[0] > 0.98 && c[1] > 0.7 && c[1] < 0.8 && c[2] < 0.4);
        known++;
    }
    CHECK(known >= 10);
}

TEST(the_albedo_bound_counts_the_colours_of_coat_fuzz_and_transmission_that_are_there) {
    struct layers l;
    layers_init(&l);
    l.material.phong.kd = colour_all(0.8);
    l.numbers.coat_colour = l.numbers.transmission_colour = l.numbers.fuzz_colour = colour_make(0.5, 3, 0.5);
    CHECK_NEAR(surface_albedo_bound_of(&l.material), 1, 0); /* the highlight; no layer has a weight */
    l.numbers.fuzz_weight = 0.5;
    CHECK_NEAR(surface_albedo_bound_of(&l.material), 3, 0);
    l.numbers.fuzz_weight = 0;
    l.numbers.coat_weight = 0.5;
    CHECK_NEAR(surface_albedo_bound_of(&l.material), 3, 0);
    l.material.phong.refract = 0.5;
    CHECK_NEAR(surface_albedo_bound_of(&l.material), 9, 0);
    l.numbers.deep = true; /* that colour is the absorption now */
    CHECK_NEAR(surface_albedo_bound_of(&l.material), 3, 0);
}

/* Tints above 1 (gold, brass) reflect no more light than arrives, if the colour leaves room for them. */
TEST(the_albedo_bound_of_metal_is_above_1_only_where_its_fresnel_reflectance_is) {
    const struct {
        double colour, tint;
    } cases[] = {{0.4225, 1.0212}, {0.73, 1.0037}, {1, 0.9895}, {0.9, 1.1},
                 {0.99, 1.1},      {1, 1.01},      {0.5, 1.3},  {1.2, 1}};
#define ROW(name, r, g, b, tint_r, tint_g, tint_b) {{r, g, b}, {tint_r, tint_g, tint_b}},
    static const double metals[][2][3] = {METALS(ROW)};
#undef ROW
    struct layers metal;
    layers_init(&metal);
    metal.numbers.base_metalness = 1;
    for (size_t i = 0; i < sizeof metals / sizeof *metals; i++) {
        const double *colour = metals[i][0], *tint = metals[i][1];
        metal.material.phong.kd = colour_make(colour[0], colour[1], colour[2]);
        metal.material.phong.ks = colour_make(tint[0], tint[1], tint[2]);
        CHECK(surface_albedo_bound_of(&metal.material) <= 1);
    }
    int gains = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct bsdf_facets facets = {.roughness = 1};
        double largest = 0;
        metal.material.phong.kd = colour_all(cases[i].colour);
        metal.material.phong.ks = colour_all(cases[i].tint);
        bsdf_facets_metal(&facets, metal.material.phong.kd, metal.material.phong.ks);
        for (int k = 0; k <= 4000; k++)
            largest = fmax(largest, bsdf_metal_fresnel(&facets, k / 4000.0).r);
        CHECK((largest > 1 + 1e-12) == (surface_albedo_bound_of(&metal.material) > 1));
        gains += largest > 1 + 1e-12;
    }
    CHECK_EQ_INT(gains, 5);
}

/* --- closed forms of layers --- */

static struct colour weight_of(const struct bsdf *bsdf, enum lobe_kind kind) {
    struct colour sum = {0, 0, 0};
    for (int i = 0; i < bsdf->count; i++)
        if (bsdf->lobes[i].kind == kind)
            sum = colour_add(sum, bsdf->lobes[i].weight);
    return sum;
}

/* Fresnel outside R = 0.0918 on average and inside 1 - (1 - R) / n^2: R + (1 - R) (1 - S) a / (1 - S a). */
TEST(a_clear_coat_over_a_matt_base_reflects_what_reflections_between_them_add_up_to) {
    struct layers lacquer;
    layers_init(&lacquer);
    lacquer.numbers.coat_weight = 1;
    lacquer.numbers.coat_ior = 1.5;
    lacquer.numbers.specular_weight = 0;
    lacquer.material.phong.kd = colour_all(0.8);
    enum { N = 2000 };
    double sum = 0;
    for (int i = 0; i < N; i++) {
        double c = (i + 0.5) / N;
        struct bsdf bsdf = seen(&lacquer, c, true);
        sum += 2 * c / N * (weight_of(&bsdf, LOBE_MIRROR).r + weight_of(&bsdf, LOBE_DIFFUSE).r);
    }
    CHECK_NEAR(sum, 0.65264, 2e-5);
    estimate_record("coat of index 1.5 over Lambert .8", 0.65264, (struct estimate){sum, 0}, 1);
}

/* F (metal) below f (coat), both smooth: f + (1 - f)^2 F / (1 - f F). */
TEST(a_clear_coat_over_polished_metal_reflects_the_sum_of_a_series) {
    struct layers coated;
    layers_init(&coated);
    coated.numbers.coat_weight = coated.numbers.base_metalness = 1;
    coated.material.phong.kd = colour_all(0.6);
    for (double c = 0.1; c < 1; c += 0.2) {
        struct bsdf bsdf = seen(&coated, c, true);
        double f = dielectric_fresnel(c, 1 / 1.6), metal = 0.6 + 0.4 * pow(1 - c, 5), series = f,
               passes = (1 - f) * (1 - f);
        struct bsdf_facets facets;
        bsdf_facets_shape(&facets, vec3_make(0, 0, 1), vec3_all(0), 0.5, 0);
        bsdf_facets_metal(&facets, colour_all(0.6), colour_all(1));
        double mean = bsdf_metal_fresnel_average(&facets).r;
        /* The specification takes the mean of the metal for the reflections between them. */
        series += passes * metal / (1 - f * mean);
        CHECK_NEAR(weight_of(&bsdf, LOBE_MIRROR).r, series, 1e-12);
    }
}

TEST(a_pane_reflects_and_passes_light_with_all_reflections_between_its_sides) {
    struct layers pane;
    layers_init(&pane);
    pane.numbers.thin_walled = true;
    pane.material.phong.refract = 1;
    struct bsdf bsdf = seen(&pane, 1, true);
    CHECK_NEAR(weight_of(&bsdf, LOBE_MIRROR).r, 1.0 / 13, 1e-14);
    CHECK_NEAR(weight_of(&bsdf, LOBE_REFRACTION).r, 12.0 / 13, 1e-14);
    bsdf = seen(&pane, 0.3, true);
    struct bsdf_sample sample;
    uint32_t through = bsdf_lobes_with(&bsdf, BSDF_TRANSMITS);
    CHECK(bsdf_sample(&bsdf, through, BSDF_RADIANCE, view_of(0.3, true), (struct sample2){0.5, 0.5}, &sample));
    CHECK_NEAR(sample.direction.x, -sqrt(1 - 0.09), 1e-15);
    CHECK_NEAR(sample.weight.r, weight_of(&bsdf, LOBE_REFRACTION).r, 1e-15);
    struct medium_stack stack = {.count = 0};
    medium_stack_cross(&stack, &bsdf.boundary);
    CHECK_EQ_INT((int)stack.count, 0);
}

TEST(rough_glass_of_the_index_of_air_is_invisible) {
    for (int thin = 0; thin < 2; thin++) {
        struct layers glass;
        layers_init(&glass);
        glass.numbers.specular_ior = 1;
        glass.numbers.thin_walled = thin;
        glass.material.phong.refract = 1;
        glass.material.phong.roughness = 0.5;
        for (double c = 0.1; c <= 1; c += 0.3) {
            struct bsdf bsdf = seen(&glass, c, true);
            struct bsdf_sample sample;
            CHECK(bsdf_sample(&bsdf, BSDF_ALL, BSDF_RADIANCE, view_of(c, true), (struct sample2){0.3, 0.3}, &sample));
            CHECK_NEAR(vec3_length(vec3_add(sample.direction, view_of(c, true))), 0, 1e-15);
            CHECK_NEAR(sample.weight.r, 1, 1e-15);
            CHECK(sample.flags & BSDF_DELTA);
        }
    }
}

/* --- the normal of the coat --- */

static void make_metal_below_a_coat(struct layers *l) {
    l->numbers.coat_weight = l->numbers.base_metalness = 1;
    l->material.phong.roughness = 0.3;
}

/* Seen with a normal map for the coat, of this colour everywhere. */
static struct bsdf coated(struct layers *layers, struct colour map) {
    struct texture texture = texture_constant(map);
    struct bump bump = {.kind = MATERIAL_NORMAL, .height = 1, .texture = &texture, .of_coat = true};
    struct hit hit = {.view = view_of(0.8, true), .front = true, .primitive = 4, .dpdu = {1, 0, 0}, .dpdv = {0, 1, 0}};
    const struct material_context context = {.total_reflection = true};
    struct bsdf bsdf;
    hit.normal = hit.normal_geometric = vec3_make(0, 0, 1);
    layers->material.bump = &bump;
    surface_eval(&layers->material, &hit, NULL, &context, &bsdf);
    layers->material.bump = NULL;
    return bsdf;
}

TEST(a_coat_reflects_about_its_own_normal_and_its_base_about_that_of_the_surface) {
    struct layers layers;
    layers_init(&layers);
    layers.numbers.coat_weight = 1;
    const struct vec3 wo = view_of(0.8, true), tilted = vec3_normalize(vec3_make(0.2, 0, 1));
    struct bsdf bsdf = coated(&layers, colour_make(0.6, 0.5, 1));
    int found = 0;
    for (int i = 0; i < bsdf.count; i++) {
        struct bsdf_sample sample;
        bool is_coat = bsdf.lobes[i].kind == LOBE_COAT;
        if (!is_coat && bsdf.lobes[i].kind != LOBE_MIRROR)
            continue;
        CHECK(bsdf_sample(&bsdf, 1U << i, BSDF_RADIANCE, wo, (struct sample2){0.5, 0.5}, &sample));
        struct vec3 expected = dielectric_mirror(is_coat ? tilted : vec3_make(0, 0, 1), wo);
        CHECK_NEAR(vec3_length(vec3_sub(sample.direction, expected)), 0, 1e-12);
        if (is_coat)
            CHECK_NEAR(sample.weight.g, dielectric_fresnel(vec3_dot(tilted, wo), 1 / 1.6), 1e-12);
        found++;
    }
    CHECK_EQ_INT(found, 2);
    layers.numbers.coat_roughness = layers.material.phong.roughness = 0.4;
    bsdf = coated(&layers, colour_make(0.6, 0.5, 1));
    CHECK_NEAR(bsdf.facets[0].distribution.normal.x, tilted.x, 1e-12);
    CHECK_NEAR(bsdf.facets[1].distribution.normal.x, 0, 0);
}

TEST(a_flat_normal_map_of_the_coat_changes_no_light) {
    struct layers layers;
    layers_init(&layers);
    make_metal_below_a_coat(&layers);
    for (int rough = 0; rough < 2; rough++) {
        layers.numbers.coat_roughness = rough ? 0.3 : 0;
        struct bsdf with = coated(&layers, colour_make(0.5, 0.5, 1)), without = seen(&layers, 0.8, true);
        struct colour mirror = colour_add(weight_of(&with, LOBE_MIRROR), weight_of(&with, LOBE_COAT));
        CHECK_NEAR(mirror.g, weight_of(&without, LOBE_MIRROR).g, 1e-15);
        CHECK_NEAR(weight_of(&with, LOBE_METAL).g, weight_of(&without, LOBE_METAL).g, 1e-15);
        CHECK_NEAR(weight_of(&with, LOBE_GLOSS).g, weight_of(&without, LOBE_GLOSS).g, 1e-15);
    }
}

/* --- the furnace --- */

struct furnace {
    const char *name;
    void (*make)(struct layers *layers);
    bool solid; /* light gets inside */
    double anisotropy;
};

static void make_lambert(struct layers *l) {
    l->numbers.specular_weight = 0;
}
static void make_oren_nayar(struct layers *l) {
    l->numbers.specular_weight = 0;
    l->numbers.base_diffuse_roughness = 0.8;
}
static void make_metal(struct layers *l) {
    l->numbers.base_metalness = 1;
}
static void make_plastic(struct layers *l) {
    (void)l;
}
static void make_glass(struct layers *l) {
    l->material.phong.refract = 1;
}
static void make_half_glass(struct layers *l) {
    l->material.phong.refract = 0.5;
}
static void make_coat(struct layers *l) {
    l->numbers.coat_weight = 1;
    l->numbers.coat_roughness = l->material.phong.roughness;
}
static void make_fuzz(struct layers *l) {
    l->numbers.fuzz_weight = 1;
    l->numbers.fuzz_roughness = l->material.phong.roughness;
}
static void make_wall(struct layers *l) {
    l->numbers.thin_walled = true;
    l->material.phong.refract = 1;
}
static void add_film(struct layers *l) {
    l->numbers.film_weight = 0.9;
    l->numbers.film_thickness = 0.45;
}
static void make_filmed_plastic(struct layers *l) {
    add_film(l);
}
static void make_filmed_metal(struct layers *l) {
    add_film(l);
    make_metal(l);
}
static void make_filmed_glass(struct layers *l) {
    add_film(l);
    make_glass(l);
}
static void make_filmed_wall(struct layers *l) {
    add_film(l);
    make_wall(l);
}
static void make_all(struct layers *l) {
    l->numbers.coat_weight = l->numbers.fuzz_weight = 0.5;
    l->numbers.base_metalness = 0.4;
    l->numbers.base_diffuse_roughness = 0.3;
    l->numbers.coat_roughness = 0.2;
    l->material.phong.refract = 0.5;
}
static void make_all_filmed(struct layers *l) {
    add_film(l);
    make_all(l);
}
static const struct furnace furnaces[] = {
    {"Lambert", make_lambert, false, 0},
    {"rough diffuse", make_oren_nayar, false, 0},
    {"metal", make_metal, false, 0},
    {"plastic", make_plastic, false, 0},
    {"glass", make_glass, true, 0},
    {"half of it glass", make_half_glass, true, 0},
    {"coat", make_coat, false, 0},
    {"fuzz", make_fuzz, false, 0},
    {"thin wall", make_wall, false, 0},
    {"all together", make_all, true, 0},
    {"film on plastic", make_filmed_plastic, false, 0},
    {"film on metal", make_filmed_metal, false, 0},
    {"film on glass", make_filmed_glass, true, 0},
    {"film on a thin wall", make_filmed_wall, false, 0},
    {"all with a film", make_all_filmed, true, 0},
};

/* In light that is 1 from everywhere a white surface sends 1 everywhere: a loss below half a percent, an excess below
 * four standard errors, in the mean over views. Rounding counts as an error of 1e-9. */
static struct estimate furnace_mean(const struct furnace *furnace, double roughness, bool front, uint32_t views,
                                    uint32_t n, uint32_t seed) {
    double sum = 0, variance = 0;
    for (uint32_t i = 0; i < views; i++) {
        struct layers layers;
        double cosine = sqrt((i + 0.5) / views);
        layers_init(&layers);
        layers.material.phong.roughness = roughness;
        layers.numbers.specular_anisotropy = layers.numbers.coat_anisotropy = furnace->anisotropy;
        layers.numbers.tangent = layers.numbers.coat_tangent = vec3_make(cos(2.4 * i), sin(2.4 * i), 0);
        furnace->make(&layers);
        struct bsdf bsdf = seen(&layers, cosine, front);
        struct estimate e = albedo_of(&bsdf, BSDF_ALL, view_of(cosine, front), i + seed, n);
        sum += e.mean / views;
        variance += e.error * e.error / ((double)views * views);
    }
    return (struct estimate){sum, sqrt(variance)};
}

/* Returns the smallest mean, of both sides and all roughnesses. */
static struct estimate check_furnace(const struct furnace *furnace, double step, uint32_t views, uint32_t n,
                                     uint32_t seed, double precision) {
    struct estimate min = {INFINITY, 0};
    for (int front = 1; front >= (furnace->solid ? 0 : 1); front--) {
        for (double roughness = 0; roughness <= 1; roughness += step) {
            struct estimate e = furnace_mean(furnace, roughness, front, views, n, seed);
            min = e.mean < min.mean ? e : min;
            if (!(e.mean > 0.995 && e.mean < 1 + 4 * fmax(e.error, 1e-9) && e.error <= precision))
                test_fail(__FILE__, __LINE__, "%s of roughness %g, from %s: %.5f +- %.5f", furnace->name, roughness,
                          front ? "outside" : "inside", e.mean, e.error);
        }
    }
    return min;
}

TEST(white_layered_surfaces_send_all_light_back_or_on) {
    for (size_t i = 0; i < sizeof furnaces / sizeof *furnaces; i++)
        (void)check_furnace(&furnaces[i], 0.25, 24, 24, 11, 1);
}

/* Inside of glass the albedo of little roughness jumps at the angle of total reflection. */
TEST(white_glass_of_little_roughness_sends_all_light_back_or_on_from_inside) {
    for (size_t i = 0; i < sizeof furnaces / sizeof *furnaces; i++) {
        for (double roughness = 0.0625; roughness < 0.2 && furnaces[i].solid; roughness += 0.0625) {
            struct estimate e = furnace_mean(&furnaces[i], roughness, false, 100, 20, 5);
            if (!(e.mean > 0.995 && e.mean < 1 + 4 * e.error))
                test_fail(__FILE__, __LINE__, "%s of roughness %g: %.5f +- %.5f", furnaces[i].name, roughness, e.mean,
                          e.error);
        }
    }
}

/* Light that hits more than one facet is that of tables for metal and thin walls, of sums over facets for boundaries.
 */
TEST_TIMES(white_facets_of_two_widths_send_all_light_back_or_on, 10) {
    static const double anisotropies[] = {0.4, 0.9, 1}, roughnesses[] = {0.3, 0.55, 0.8, 1};
    struct furnace kinds[] = {{"metal", make_metal, false, 0},
                              {"plastic", make_plastic, false, 0},
                              {"coat", make_coat, false, 0},
                              {"thin wall", make_wall, false, 0},
                              {"glass", make_glass, true, 0}};
    for (size_t i = 0; i < 5 * 3 * 4; i++) {
        struct furnace *kind = &kinds[i / 12];
        double roughness = roughnesses[i % 4];
        kind->anisotropy = anisotropies[i / 4 % 3];
        for (int front = 1; front >= (kind->solid ? 0 : 1); front--) {
            struct estimate e = furnace_mean(kind, roughness, front, 60 * (uint32_t)times, 12, 3);
            if (!(fabs(e.mean - 1) < 0.005 + 3 * e.error && e.error < (times > 1 ? 0.005 : 0.01)))
                test_fail(__FILE__, __LINE__, "%s of roughness %g, anisotropy %g, %d: %.5f +- %.5f", kind->name,
                          roughness, kind->anisotropy, front, e.mean, e.error);
        }
    }
}

TEST_LONG(white_layered_surfaces_send_all_light_back_or_on_at_every_roughness) {
    for (size_t i = 0; i < sizeof furnaces / sizeof *furnaces; i++) {
        for (uint32_t seed = 1; seed <= 3; seed++) {
            struct estimate min = check_furnace(&furnaces[i], 0.0625, 200, 60, 1000 * seed, 0.001);
            char claim[64];
            (void)snprintf(claim, sizeof claim, "furnace, %s: smallest mean", furnaces[i].name);
            estimate_record(claim, 1, min, (int)seed);
        }
    }
}

/* --- under Whitted --- */

enum { BALL_SIZE = 25 };
/* A ball of gloss alone, of glossy_samples x glossy_samples rays, seen from far away. */
static void render_gloss(struct stage *s, const struct layers *layers, int glossy_samples) {
    struct material *gloss = stage_glass(s, 0, 0, 1);
    *gloss = layers->material;
    gloss->phong.glossy_samples = glossy_samples;
    (void)stage_sphere(s, s->root, gloss);
    s->camera.fov = 14;
    s->settings.samples = 1;
    CHECK(stage_render(s, BALL_SIZE, BALL_SIZE));
}

static void gloss_init(struct layers *layers) {
    layers_init(layers);
    layers->material.phong.kd = colour_all(0);
    layers->material.phong.roughness = 0.5;
}

TEST(gloss_in_uniform_light_has_the_albedo_of_its_table_in_every_pixel) {
    static const int samples[] = {1, 4, 7};
    struct layers layers;
    gloss_init(&layers);
    for (int i = 0; i < 3; i++) {
        struct stage s;
        stage_begin(&s, 1);
        s.sky.colour = colour_all(1);
        render_gloss(&s, &layers, samples[i]);
        const double step = 2 * tan(7 * M_PI / 180) / BALL_SIZE;
        for (int p = 0; p < BALL_SIZE * BALL_SIZE; p++) {
            const double x = (p % BALL_SIZE - BALL_SIZE / 2) * step, y = (p / BALL_SIZE - BALL_SIZE / 2) * step;
            const double b = 10 / sqrt(1 + x * x + y * y), discriminant = b * b - 99;
            if (discriminant < 0.01)
                continue;
            const double cosine = sqrt(discriminant);
            const struct bsdf bsdf = seen(&layers, cosine, true);
            CHECK_NEAR(stage_pixel(&s, (uint32_t)p % BALL_SIZE, (uint32_t)p / BALL_SIZE).r, bsdf.facets[0].reflected,
                       1e-6);
        }
        stage_end(&s);
    }
}

TEST(gloss_of_few_rays_has_the_light_of_many) {
    static const double stops[2][4] = {{-0.2, 0.1, 0.2, 0.3}, {0.2, 1, 0.8, 0.6}};
    static const int samples[] = {32, 2, 4};
    double mean[3] = {0, 0, 0};
    struct layers layers;
    gloss_init(&layers);
    for (int i = 0; i < 3; i++) {
        struct stage s;
        stage_begin(&s, 1);
        s.sky = (struct sky){.kind = SKY_STOPS, .stops = stops, .stop_count = 2};
        render_gloss(&s, &layers, samples[i]);
        for (int p = 0; p < BALL_SIZE * BALL_SIZE; p++)
            mean[i] += stage_pixel(&s, (uint32_t)p % BALL_SIZE, (uint32_t)p / BALL_SIZE).r / (BALL_SIZE * BALL_SIZE);
        stage_end(&s);
    }
    CHECK(mean[0] > 0.02);
    CHECK_NEAR(mean[1], mean[0], 2e-3);
    CHECK_NEAR(mean[2], mean[0], 1e-3);
}

/* --- inputs --- */

TEST(a_texture_replaces_every_number_of_a_layered_material) {
    static const enum material_input inputs[] = {
        INPUT_BASE_WEIGHT,         INPUT_DIFFUSE_ROUGHNESS, INPUT_METALNESS,           INPUT_SPECULAR_WEIGHT,
        INPUT_SPECULAR_ANISOTROPY, INPUT_SPECULAR_IOR,      INPUT_TRANSMISSION_COLOUR, INPUT_COAT_WEIGHT,
        INPUT_COAT_COLOUR,         INPUT_COAT_ROUGHNESS,    INPUT_COAT_ANISOTROPY,     INPUT_COAT_IOR,
        INPUT_COAT_DARKENING,      INPUT_FUZZ_WEIGHT,       INPUT_FUZZ_COLOUR,         INPUT_FUZZ_ROUGHNESS,
        INPUT_FILM_WEIGHT,         INPUT_FILM_THICKNESS};
    struct texture value = texture_number(0.7);
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++) {
        struct layers with, without;
        layers_init(&without);
        make_all_filmed(&without);
        without.material.phong.kd = colour_make(0.5, 0.6, 0.7);
        without.material.phong.roughness = 0.4;
        without.numbers.specular_anisotropy = without.numbers.coat_anisotropy = 0.2;
        with = without;
        with.material.openpbr = &with.numbers;
        with.material.inputs[inputs[i]] = &value;
        struct bsdf a = seen(&with, 0.6, true), b = seen(&without, 0.6, true);
        double change = 0;
        for (int k = 0; k < 50; k++) {
            struct vec3 wi = vec3_normalize(vec3_make(sin(k), cos(3 * k), 0.3 + (k % 5) * (k & 1 ? -1 : 1)));
            struct vec3 wo = view_of(0.6, true);
            change += colour_length(colour_sub(bsdf_eval(&a, BSDF_ALL, BSDF_RADIANCE, wo, wi),
                                               bsdf_eval(&b, BSDF_ALL, BSDF_RADIANCE, wo, wi)));
        }
        if (!(change > 1e-6))
            test_fail(__FILE__, __LINE__, "input %d has no effect", (int)inputs[i]);
    }
}
