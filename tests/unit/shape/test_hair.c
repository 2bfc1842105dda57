/* Hair lets light through as if it were not there: it is a ribbon that faces each ray, and what goes on through it
 * stays on the line of the ray. */
#include "material/microfacet_internal.h"
#include "shape/curve.h"
#include "shape/planar.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "world/world.h"

#include <math.h>
#include <string.h>

enum { SIZE = 48, STRIPES = 37, HAIRS = 8 };

struct hairy {
    struct stage stage;
    struct arena arena;
    struct test_random random;
};

/* Stripes behind the origin, which the camera at (0, 0, 10) sees; all lengths times `unit`. */
static void hairy_begin(struct hairy *h, double unit) {
    struct stage *s = &h->stage;
    stage_begin(s, 1);
    h->arena = (struct arena){0};
    h->random = (struct test_random){7};
    for (int i = 0; i < STRIPES; i++) {
        struct material *glow = stage_phong(s, colour_all(0), colour_all(0), 1);
        glow->phong.emission = colour_make(test_uniform(&h->random, 0, 1), i % 2, test_uniform(&h->random, 0, 1));
        glow->phong.two_sided = true;
        double width = 20.0 / STRIPES * unit;
        struct node *node = stage_sphere(s, s->root, glow);
        node->shape =
            (struct shape){.kind = SHAPE_PLANAR,
                           .planar = planar_parallelogram(vec3_make((i - STRIPES / 2.0) * width, -10 * unit, -6 * unit),
                                                          vec3_make(width, 2 * unit, 0), vec3_make(0, 20 * unit, 0))};
    }
    s->settings.full = true;
    s->settings.samples = s->settings.path_samples = 2;
    s->settings.reflect_limit = s->settings.refract_limit = s->settings.max_depth = 1000;
    s->settings.roulette_depth = 1000;
    s->camera.eye.z = 10 * unit;
}

static void hairy_end(struct hairy *h) {
    stage_end(&h->stage);
    arena_destroy(&h->arena);
}

static struct material *hairy_holes(struct hairy *h, double opacity) {
    struct material *holes = stage_phong(&h->stage, colour_all(0), colour_all(0), 1);
    holes->inputs[INPUT_OPACITY] = texture_keep(&h->stage.scene.arena, texture_number(opacity), &h->stage.error);
    return holes;
}

/* A curl about the origin, or a straight hair, in a stretched space. */
static struct node *hairy_add(struct hairy *h, const struct material *material, bool flat, bool straight, double unit) {
    double points[4][3], widths[4];
    for (int k = 0; k < 12; k++)
        points[k / 3][k % 3] = test_uniform(&h->random, -4, 4) * unit;
    for (int k = 0; k < 4; k++)
        widths[k] = straight && k > 0 ? widths[0] : test_uniform(&h->random, 0.2, 2) * unit;
    const struct curve_input in = {.kind = straight ? SPLINE_LINEAR : SPLINE_BEZIER,
                                   .points = (const double(*)[3])points,
                                   .widths = widths,
                                   .count = straight ? 2 : 4,
                                   .flat = flat};
    struct node *node = stage_sphere(&h->stage, h->stage.root, material);
    node->shape = (struct shape){.kind = SHAPE_CURVE, .curve = curve_build(&h->arena, &in, &h->stage.error)};
    CHECK(node->shape.curve != NULL);
    return node;
}

static void hairy_fill(struct hairy *h, const struct material *material, bool flat, double unit) {
    for (int i = 0; i < HAIRS; i++) {
        struct node *node = hairy_add(h, material, flat, false, unit);
        stage_scale(&h->stage, node, 1, i % 3 == 0 ? 2 : 1, i % 3 == 1 ? 0.5 : 1);
        stage_rotate(&h->stage, node, i % 3, 40 * i);
    }
}

/* --- pictures --- */

/* Pixels that differ from those of the scene without hair by more than rounding. */
static int hairy_changes(struct hairy *h, const struct colour *bare) {
    int changed = 0;
    CHECK(stage_render(&h->stage, SIZE, SIZE));
    for (uint32_t i = 0; i < SIZE * SIZE; i++)
        changed += !(colour_max_abs(colour_sub(stage_pixel(&h->stage, i % SIZE, i / SIZE), bare[i])) < 1e-5);
    return changed;
}

static void check_invisible(bool flat, bool glass, enum integrator_kind integrator) {
    static struct colour bare[SIZE * SIZE];
    struct hairy h;
    hairy_begin(&h, 1);
    h.stage.settings.integrator = integrator;
    CHECK(stage_render(&h.stage, SIZE, SIZE));
    for (uint32_t i = 0; i < SIZE * SIZE; i++)
        bare[i] = stage_pixel(&h.stage, i % SIZE, i / SIZE);
    hairy_fill(&h, glass ? stage_glass(&h.stage, 0, 1, 1) : hairy_holes(&h, 0), flat, 1);
    int changed = hairy_changes(&h, bare);
    if (changed > 0)
        test_fail(__FILE__, __LINE__, "%s %s, integrator %d: %d of %d pixels change", flat ? "flat" : "round",
                  glass ? "glass of index 1" : "opacity 0", (int)integrator, changed, SIZE * SIZE);
    hairy_end(&h);
}

TEST(hair_of_opacity_0_changes_no_pixel) {
    for (int flat = 0; flat < 2; flat++) {
        check_invisible(flat, false, INTEGRATOR_WHITTED);
        check_invisible(flat, false, INTEGRATOR_PATH);
    }
}

TEST(hair_of_glass_with_index_1_changes_no_pixel) {
    for (int flat = 0; flat < 2; flat++) {
        check_invisible(flat, true, INTEGRATOR_WHITTED);
        check_invisible(flat, true, INTEGRATOR_PATH);
    }
}

/* Holes, refraction and mirrors. */
TEST(pictures_of_translucent_hair_scale_by_powers_of_two_bit_by_bit) {
    for (int flat = 0; flat < 2; flat++) {
        struct hairy h[2];
        for (int i = 0; i < 2; i++) {
            double unit = i == 0 ? 1 : 0x1p-30;
            hairy_begin(&h[i], unit);
            hairy_fill(&h[i], hairy_holes(&h[i], 0.5), flat, unit);
            hairy_fill(&h[i], stage_glass(&h[i].stage, 0.5, 0.5, 1.3), flat, unit);
            h[i].stage.settings.integrator = INTEGRATOR_PATH;
            CHECK(stage_render(&h[i].stage, SIZE, SIZE));
        }
        CHECK(memcmp(h[0].stage.film.pixels, h[1].stage.film.pixels, SIZE * SIZE * sizeof *h[0].stage.film.pixels) ==
              0);
        hairy_end(&h[0]);
        hairy_end(&h[1]);
    }
}

/* --- single rays --- */

static struct vec3 within(struct test_random *random, double size) {
    double x = test_uniform(random, -size, size), y = test_uniform(random, -size, size);
    return vec3_make(x, y, test_uniform(random, -size, size));
}

static struct ray ray_through_the_middle(struct test_random *random, double size) {
    struct vec3 o = within(random, 20), to = within(random, size);
    return (struct ray){.origin = o, .direction = vec3_sub(to, o), .t_max = INFINITY};
}

/* The crossings of the whole ray, each found behind the one before, against those of rays that go on. */
TEST(a_ray_that_goes_on_through_hair_meets_each_crossing_once) {
    for (int flat = 0; flat < 2; flat++) {
        struct hairy h;
        struct world_scratch scratch;
        hairy_begin(&h, 1);
        for (int i = 0; i < 3; i++)
            hairy_fill(&h, hairy_holes(&h, 0.5), flat, 1);
        CHECK(stage_build(&h.stage, h.stage.root, ACCEL_AUTO) && world_scratch_init(&scratch, &h.stage.world));
        long crossings = 0, wrong = 0;
        for (int i = 0; i < 3000; i++) {
            struct ray whole = ray_through_the_middle(&h.random, 3), on = whole;
            struct hit hit;
            int expected = 0, found = 0;
            for (; expected < 99 && world_nearest(&h.stage.world, &whole, &scratch, &hit); expected++)
                whole.t_min = hit.t;
            for (; found < 99 && world_nearest(&h.stage.world, &on, &scratch, &hit); found++)
                on = hit_ray(&hit, &on, vec3_negate(hit.view), NULL);
            crossings += expected;
            wrong += found != expected;
        }
        CHECK(crossings > 10000);
        CHECK_EQ_INT(wrong, 0);
        world_scratch_destroy(&scratch);
        hairy_end(&h);
    }
}

/* Reflected to any side, or, if the space is not stretched, refracted with an index of up to 2. */
TEST(light_leaves_a_straight_hair_without_meeting_it_again) {
    for (int i = 0; i < 400; i++) {
        struct hairy h;
        struct world_scratch scratch;
        stage_begin(&h.stage, 1);
        h.arena = (struct arena){0};
        h.random = (struct test_random){(uint64_t)i};
        struct node *node = hairy_add(&h, stage_phong(&h.stage, colour_all(0), colour_all(0), 1), i % 2, true, 1);
        double stretch = i % 3 == 0 ? exp(test_uniform(&h.random, -4, 4)) : 1;
        stage_scale(&h.stage, node, 1, 1, stretch);
        CHECK(stage_build(&h.stage, h.stage.root, ACCEL_AUTO) && world_scratch_init(&scratch, &h.stage.world));
        long met = 0, reflected = 0, refracted = 0;
        for (int k = 0; k < 200; k++) {
            struct ray ray = ray_through_the_middle(&h.random, 2);
            struct hit hit, next;
            if (!world_nearest(&h.stage.world, &ray, &scratch, &hit))
                continue;
            met++;
            struct vec3 out, off = within(&h.random, 1);
            if (vec3_dot(off, hit.normal_geometric) < 0)
                off = vec3_negate(off);
            struct ray on = hit_ray(&hit, &ray, off, NULL);
            reflected += world_nearest(&h.stage.world, &on, &scratch, &next);
            if (i % 3 == 0 ||
                !dielectric_refract(hit.normal_geometric, hit.view, test_uniform(&h.random, 0.5, 1), &out))
                continue;
            on = hit_ray(&hit, &ray, out, NULL);
            refracted += world_nearest(&h.stage.world, &on, &scratch, &next);
        }
        if (reflected > 0 || refracted > 0)
            test_fail(__FILE__, __LINE__, "hair %d (stretch %g): of %ld rays, %ld reflected and %ld refracted ones", i,
                      stretch, met, reflected, refracted);
        world_scratch_destroy(&scratch);
        hairy_end(&h);
    }
}
