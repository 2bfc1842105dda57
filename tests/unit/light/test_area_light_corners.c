/* Lamps that rays hit, and that are sampled from points where their formulas degenerate: inside them, on them, in their
 * plane, infinitely far away. The expected values are independent geometry. */
#include "light/light_mesh.h"
#include "tests/harness.h"
#include "tests/unit/random_makers.h"

#include <math.h>

static struct ray part_of(struct vec3 origin, struct vec3 direction, double t_min, double t_max) {
    return (struct ray){.origin = origin, .direction = direction, .t_min = t_min, .t_max = t_max};
}

TEST(a_lamp_that_is_a_ball_is_met_where_the_ray_goes_in_else_where_it_comes_out) {
    struct light ball = {.kind = LIGHT_SPHERE, .position = {1, 2, 3}, .radius = 2};
    struct light_hit met;
    struct ray ray = part_of(vec3_make(1, 2, 13), vec3_make(0, 0, -2), 0, INFINITY);
    CHECK(light_meets_ray(&ball, &ray, &met));
    CHECK_NEAR(met.t, 4, 1e-14);
    ray.t_min = 5; /* from inside */
    CHECK(light_meets_ray(&ball, &ray, &met));
    CHECK_NEAR(met.t, 6, 1e-14);
    ray.t_max = 5.5; /* it ends inside, too */
    CHECK(!light_meets_ray(&ball, &ray, &met));
    ray = part_of(vec3_make(1, 2, 13), vec3_make(0, 0, -2), 0, 3.5);
    CHECK(!light_meets_ray(&ball, &ray, &met));
    ray = part_of(vec3_make(1, 2, 13), vec3_make(0, 0, -2), 7, INFINITY);
    CHECK(!light_meets_ray(&ball, &ray, &met));
    ray = part_of(vec3_make(3.5, 2, 13), vec3_make(0, 0, -2), 0, INFINITY);
    CHECK(!light_meets_ray(&ball, &ray, &met));
}

TEST(flat_lamps_are_met_in_their_outline_from_the_side_that_shines) {
    struct light disc = {.kind = LIGHT_DISC, .position = {0, 4, 0}, .direction = {0, -1, 0}, .radius = 1};
    struct light writer = {.kind = LIGHT_PARALLELOGRAM, .corner = {-1, 4, -1}, .edge1 = {2, 0, 0}, .edge2 = {1, 0, 2}};
    struct light *const area_lights[] = {&disc, &writer};
    struct light_hit met;
    for (int k = 0; k < 2; k++) {
        CHECK(light_prepare(area_lights[k], NULL, NULL, NULL));
        struct ray below = part_of(vec3_make(0.2, 0, 0.2), vec3_make(0, 2, 0), 0, INFINITY);
        struct ray above = part_of(vec3_make(0.2, 9, 0.2), vec3_make(0, -1, 0), 0, INFINITY);
        CHECK(light_meets_ray(area_lights[k], &below, &met) && met.t == 2);
        CHECK(light_meets_ray(area_lights[k], &above, &met) && met.t == 5);
        area_lights[k]->one_sided =
            true; /* they shine downwards: the normal of the disc, edge1 x edge2 of the rectangle */
        CHECK(light_meets_ray(area_lights[k], &below, &met) && !light_meets_ray(area_lights[k], &above, &met));
        below.t_max = 1.5;
        CHECK(!light_meets_ray(area_lights[k], &below, &met));
        below.t_min = 2.5, below.t_max = INFINITY;
        CHECK(!light_meets_ray(area_lights[k], &below, &met));
        struct ray level = part_of(vec3_make(-9, 4, 0), vec3_make(1, 0, 0), 0, INFINITY);
        CHECK(!light_meets_ray(area_lights[k], &level, &met));
    }
    /* Inside or outside the outline, at random. */
    struct test_random random = {9};
    for (int i = 0; i < 2000; i++) {
        double x = test_uniform(&random, -2.5, 2.5), z = test_uniform(&random, -2.5, 2.5), v = (z + 1) / 2;
        struct ray ray = part_of(vec3_make(x, 0, z), vec3_make(0, 1, 0), 0, INFINITY);
        CHECK(light_meets_ray(&disc, &ray, &met) == (x * x + z * z < 1));
        CHECK(light_meets_ray(&writer, &ray, &met) == (v >= 0 && v <= 1 && x + 1 - v >= 0 && x + 1 - v <= 2));
    }
    struct light mesh = {.kind = LIGHT_MESH}, sky = {.kind = LIGHT_SKY};
    struct ray ray = part_of(vec3_all(0), vec3_make(0, 1, 0), 0, INFINITY);
    CHECK(!light_meets_ray(&mesh, &ray, &met) && !light_meets_ray(&sky, &ray, &met));
}

/* Every target is on the ball, seen from outside on its near side. From a point on the ball there is none. */
TEST(a_ball_is_aimed_at_from_any_distance_and_from_inside) {
    struct light ball = {.kind = LIGHT_SPHERE, .position = {0, 0, 0}, .radius = 1, .emissive = true};
    struct light_context context;
    for (int i = 0; i < 25 && light_context_make(&ball, vec3_make(0.5, 0, 0), vec3_make(0.5, 0, 0), &context); i++) {
        struct light_sample sample = light_sample(&ball, &context, (struct sample2){i % 5 / 4.0, (i - i % 5) / 20.0});
        CHECK_NEAR(vec3_length(sample.target.at), 1, 1e-14);
        CHECK_NEAR(sample.pdf, 1 / (4 * 3.14159265358979323846), 1e-15);
    }
    CHECK(context.weight > 0 && !context.single);
    ball.emissive = false; /* shaded as from its centre */
    CHECK(light_context_make(&ball, vec3_make(0.5, 0, 0), vec3_make(0.5, 0, 0), &context) && context.single);
    ball.emissive = true;
    CHECK(!light_context_make(&ball, vec3_make(1, 0, 0), vec3_make(1, 0, 0), &context));
    for (double distance = 1 + 1e-9; distance < 1e12; distance = 1 + 10 * (distance - 1)) {
        struct vec3 from = {0, 0, distance};
        if (!light_context_make(&ball, from, from, &context))
            continue;
        for (int i = 0; i <= 4; i++)
            for (int j = 0; j <= 4; j++) {
                struct vec3 target = light_target_at(&ball, &context, (struct sample2){i / 4.0, j / 4.0});
                CHECK_NEAR(vec3_length(target), 1, 1e-7 + 1e-15 * distance);
                CHECK(target.z > -1e-6 * distance);
            }
        struct vec3 middle = light_target_at(&ball, &context, (struct sample2){0.5, 0.5});
        CHECK_NEAR(middle.z, 1, 1e-15 * distance + 1e-7);
    }
}

/* A point on the lamp, or in its plane, gets no light, and not an infinite amount. */
TEST(a_lamp_gives_nothing_to_points_in_its_own_plane) {
    struct light writer = {.kind = LIGHT_PARALLELOGRAM,
                           .corner = {0, 0, 0},
                           .edge1 = {1, 0, 0},
                           .edge2 = {0.5, 1, 0}, /* not at right angles: sampled by area */
                           .colour = {1, 1, 1},
                           .emissive = true};
    struct light_triangle triangle = {.corner = {0, 0, 0}, .edge1 = {1, 0, 0}, .edge2 = {0, 1, 0}, .normal = {0, 0, 1}};
    triangle.intensity = colour_all(1);
    const double until[] = {1};
    struct light_mesh mesh = {.count = 1, .triangles = &triangle, .until = until, .one_sided = true};
    struct light area_light = {.kind = LIGHT_MESH, .mesh = &mesh, .colour = {1, 1, 1}, .emissive = true};
    struct light_context context;
    const struct vec3 points[] = {{0.75, 0.5, 0}, {5, 0, 0}, {0, 0, 0}};
    CHECK(light_prepare(&writer, NULL, NULL, NULL));
    for (size_t i = 0; i < sizeof points / sizeof points[0]; i++)
        for (int k = 0; k < 9; k++) {
            struct sample2 xi = {k / 8.0, (8 - k) / 8.0};
            (void)light_context_make(&writer, points[i], points[i], &context);
            struct light_sample sample = light_sample(&writer, &context, xi);
            CHECK(sample.intensity.r == 0 && vec3_finite(sample.target.at));
            (void)light_context_make(&area_light, points[i], points[i], &context);
            sample = light_sample(&area_light, &context, xi);
            CHECK(sample.intensity.r == 0 && vec3_finite(sample.target.at));
        }
    /* Behind and in front of a lamp that shines to one side. */
    struct light_sample sample;
    struct vec3 behind = {0.2, 0.2, -1}, before = {0.2, 0.2, 1};
    (void)light_context_make(&area_light, behind, behind, &context);
    sample = light_sample(&area_light, &context, (struct sample2){0.3, 0.3});
    CHECK(sample.intensity.r == 0);
    mesh.one_sided = false;
    sample = light_sample(&area_light, &context, (struct sample2){0.3, 0.3});
    CHECK(sample.intensity.r > 0);
    (void)light_context_make(&area_light, before, before, &context);
    sample = light_sample(&area_light, &context, (struct sample2){0.3, 0.3});
    CHECK(sample.intensity.r > 0);
}
