/* Surfaces beyond Phong: roughness, absorption, emission, by closed forms. */
#include "material/microfacet_internal.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>

static double centre_of(struct stage *s, uint32_t size) {
    CHECK(stage_render(s, size, size));
    return stage_pixel(s, size / 2, size / 2).r;
}

TEST(light_decays_exponentially_with_the_distance_inside_glass) {
    static const double thickness[] = {0.25, 1, 4};
    for (int i = 0; i < 3; i++) {
        for (int inside = 0; inside < 2; inside++) {
            struct stage s;
            stage_begin(&s, 1);
            struct material *glass = stage_glass(&s, 0, 1, 1.5);
            glass->phong.absorption = colour_make(0.7, 0.1, 0);
            struct node *slab = stage_cube(&s, s.root, glass);
            stage_move(&s, slab, -0.5, -0.5, -1);
            stage_scale(&s, slab, 100, 100, thickness[i]);
            s.sky.colour = colour_all(1);
            s.settings.samples = 1;
            s.camera.fov = 0.01;
            double route = thickness[i];
            if (inside) {
                s.camera.eye.z = -0.25 * thickness[i];
                route *= 0.75;
            }
            CHECK_NEAR(centre_of(&s, 1), exp(-0.7 * route), 1e-6);
            CHECK_NEAR(stage_pixel(&s, 0, 0).g, exp(-0.1 * route), 1e-6);
            CHECK_NEAR(stage_pixel(&s, 0, 0).b, 1, 1e-6);
            stage_end(&s);
        }
    }
}

/* The share of uniform light that a rough mirror reflects: the mean over facets of the light that leaves the surface
 * directly. */
static double albedo_of(double cosine, double alpha) {
    enum { N = 64 };
    struct vec3 up = {0, 0, 1}, view = {sqrt(1 - cosine * cosine), 0, cosine};
    double sum = 0;
    for (int i = 0; i < N * N; i++) {
        uint64_t key = random_combine(11, (uint64_t)i); /* the few steep facets lie in the corners of cells */
        struct sample2 u = {(i % N + random_unit(key)) / N, (i / N + random_unit(random_combine(key, 1))) / N};
        struct vec3 h = microfacet_normal(up, view, alpha, u);
        double out = 2 * vec3_dot(view, h) * h.z - view.z;
        sum += out > 0 ? microfacet_escape(cosine, out, alpha) : 0;
    }
    return sum / (N * N);
}

/* Only light that meets a second facet is lost. */
TEST(a_rough_mirror_loses_in_uniform_light_what_its_facets_mask) {
    for (int i = 0; i <= 4; i++) {
        struct stage s;
        stage_begin(&s, 2);
        struct material *metal = stage_glass(&s, 1, 0, 1);
        metal->phong.roughness = 0.25 * i;
        metal->phong.glossy_samples = 8;
        (void)stage_sphere(&s, s.root, metal);
        enum { SIZE = 25 };
        s.camera.fov = 14;
        s.settings.samples = 1;
        s.sky.colour = colour_all(1);
        CHECK(stage_render(&s, SIZE, SIZE));
        double alpha = 0.0625 * i * i, step = 2 * tan(7 * M_PI / 180) / SIZE, worst = 0, off = 0;
        int met = 0;
        for (int p = 0; p < SIZE * SIZE; p++) {
            double x = (p % SIZE - SIZE / 2) * step, y = (p / SIZE - SIZE / 2) * step;
            struct vec3 d = vec3_normalize(vec3_make(x, y, -1));
            double b = -10 * d.z, discriminant = b * b - 99,
                   seen = stage_pixel(&s, (uint32_t)p % SIZE, (uint32_t)p / SIZE).r;
            double cosine = discriminant > 0 ? sqrt(discriminant) : 0; /* of a ball of radius 1 */
            CHECK(seen < 1 + 1e-6);
            if (i == 0 || discriminant <= 0)
                worst = fmax(worst, fabs(seen - 1));
            else if (cosine > 0.1) {
                off += seen - albedo_of(cosine, alpha);
                met++;
            }
        }
        CHECK(worst < 1e-6);
        CHECK_NEAR(off / fmax(met, 1), 0, 2e-3);
        stage_end(&s);
    }
}

/* Polished glass is invisible in uniform light; rough glass is darker by the light that its facets mask, which is not
 * compensated (docs/limits.md). */
TEST(glass_in_uniform_light_loses_what_its_facets_mask) {
    static const double left[] = {1, 0.980, 0.833};
    for (int i = 0; i <= 2; i++) {
        struct stage s;
        stage_begin(&s, 2);
        struct material *glass = stage_glass(&s, 0, 1, 1.5);
        glass->phong.roughness = 0.3 * i;
        glass->phong.glossy_samples = 2;
        struct material *dielectric = scene_material(&s.scene, MATERIAL_FRESNEL, glass, &s.error);
        (void)stage_sphere(&s, s.root, dielectric);
        s.camera.fov = 14;
        s.settings.samples = 1;
        s.settings.reflect_limit = s.settings.refract_limit = 100;
        s.sky.colour = colour_all(1);
        CHECK(stage_render(&s, 12, 12));
        double sum = 0;
        for (uint32_t p = 0; p < 12 * 12; p++)
            sum += stage_pixel(&s, p % 12, p / 12).r / 144;
        CHECK_NEAR(sum, left[i],
                   i ? 0.01 : 1e-3); /* the light missing from 1 is reflected inside more than 100 times */
        stage_end(&s);
    }
}

/* A visible disc over a rough floor, both seen from the axis: the rays that meet the disc are those of facets tilted by
 * less than half its angle, minus their masked light. */
TEST(rough_reflection_spreads_as_its_distribution_says) {
    static const double roughness[] = {0.2, 0.4, 0.7};
    for (int i = 0; i < 3; i++) {
        struct stage s;
        stage_begin(&s, 1);
        struct material *metal = stage_glass(&s, 1, 0, 1);
        metal->phong.roughness = roughness[i];
        metal->phong.glossy_samples = 32;
        struct node *floor_node = stage_cube(&s, s.root, metal);
        stage_move(&s, floor_node, -0.5, -1, -0.5);
        stage_scale(&s, floor_node, 100, 1, 100);
        double radius = 0.9, height = 2, flat = tan(atan(radius / height) / 2), alpha = roughness[i] * roughness[i];
        s.lights[0] = (struct light){.kind = LIGHT_DISC,
                                     .position = {0, height, 0},
                                     .direction = {0, -1, 0},
                                     .radius = radius,
                                     .colour = {1, 1, 1},
                                     .emissive = true,
                                     .visible = true};
        s.light_count = 1;
        metal->phong.ks = colour_make(1, 0, 0);
        s.camera = (struct camera){{0, 1, 0}, {0, -1, 0}, {0, 0, -1}, 1e-3};
        s.settings.area_samples = 1;
        s.settings.samples = 1;
        s.authored[0].include = (const struct node *const[]){NULL}; /* visible, but lights nothing */
        double expected = 0, before = 0;
        for (int k = 1; k <= 1000; k++) {
            double slope = flat * k / 1000, share = slope * slope / (alpha * alpha + slope * slope);
            expected += (share - before) * microfacet_escape(1, cos(2 * atan(slope - flat / 2000)), alpha);
            before = share;
        }
        CHECK_NEAR(centre_of(&s, 1), expected, 8e-3);
        stage_end(&s);
    }
}

TEST(facets_are_seen_from_the_view_and_have_the_mean_of_the_normal) {
    struct vec3 normal = vec3_normalize(vec3_make(1, 2, -3)), sum = {0, 0, 0};
    for (uint32_t i = 0; i < 64 * 64; i++) {
        struct sample2 xi = sample_cell(7, i % 64, i / 64, 64);
        struct vec3 h = microfacet_normal(normal, normal, 0.5, xi);
        CHECK(vec3_dot(h, normal) > 0);
        sum = vec3_add(sum, vec3_sub(h, vec3_scale(normal, vec3_dot(h, normal))));
        struct vec3 grazing = vec3_normalize(vec3_make(2, -1, 0.01));
        h = microfacet_normal(normal, grazing, 0.5, xi);
        CHECK(vec3_dot(h, normal) >= 0 && vec3_dot(h, grazing) >= -1e-12);
    }
    CHECK(vec3_length(sum) / 4096 < 1e-3);
}

TEST(an_unlit_surface_shows_kd_and_emission_adds) {
    struct stage s;
    stage_begin(&s, 1);
    struct material *material = stage_phong(&s, colour_make(0.3, 0.4, 0.5), colour_all(1), 10);
    (void)stage_sphere(&s, s.root, material);
    stage_point_light(&s, vec3_make(0, 0, 20), colour_all(1));
    s.ambient = colour_all(0.7);
    s.camera.fov = 5;
    material->phong.unlit = true;
    CHECK_NEAR(centre_of(&s, 3), 0.3, 1e-7);
    material->phong.emission = colour_make(2, 0, 0);
    CHECK_NEAR(centre_of(&s, 3), 2.3, 1e-6);
    CHECK_EQ_INT(s.statistics.shadow_rays, 0);
    material->phong.unlit = false;
    double lit = centre_of(&s, 3);
    material->phong.emission = colour_all(0);
    CHECK_NEAR(lit - centre_of(&s, 3), 2, 1e-6);
    stage_end(&s);
}

TEST(blinn_of_a_material_is_blinn_of_the_picture) {
    double of_material[3], of_picture[3];
    for (int highlight = 0; highlight < 3; highlight++) {
        for (int picture = 0; picture < 2; picture++) {
            struct stage s;
            stage_begin(&s, 1);
            struct material *material = stage_phong(&s, colour_all(0), colour_all(1), 20);
            material->phong.highlight = (enum material_highlight)highlight;
            (void)stage_sphere(&s, s.root, material);
            stage_point_light(&s, vec3_make(9, 3, 9), colour_all(1));
            s.settings.specular = picture ? SPECULAR_BLINN : SPECULAR_PHONG;
            s.camera.fov = 5;
            (picture ? of_picture : of_material)[highlight] = centre_of(&s, 3);
            stage_end(&s);
        }
    }
    CHECK(of_material[HIGHLIGHT_PHONG] == of_material[HIGHLIGHT_AS_SET]);
    CHECK(of_picture[HIGHLIGHT_BLINN] == of_picture[HIGHLIGHT_AS_SET]);
    CHECK(of_picture[HIGHLIGHT_PHONG] == of_material[HIGHLIGHT_PHONG]);
    CHECK(of_material[HIGHLIGHT_BLINN] == of_picture[HIGHLIGHT_BLINN]);
    CHECK(of_material[HIGHLIGHT_BLINN] != of_material[HIGHLIGHT_PHONG]);
}
