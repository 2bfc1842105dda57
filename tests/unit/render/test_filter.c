/* Reconstruction filters: the density of their samples, and what they make of a picture. */
#include "base/list.h"
#include "math/elementary.h"
#include "render/filter_internal.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <string.h>

/* From their definitions: the radius, and the value at a distance from the centre. */
static double radius_of(enum filter_kind kind) {
    static const double radii[] = {0.5, 1, 1.5, 2};
    return radii[kind];
}

static double value_of(enum filter_kind kind, double x) {
    x = fabs(x);
    if (x >= radius_of(kind))
        return 0;
    switch (kind) {
    case FILTER_BOX:
        return 1;
    case FILTER_TENT:
        return 1 - x;
    case FILTER_GAUSSIAN:
        return exp(-2 * x * x) - exp(-2 * 1.5 * 1.5);
    case FILTER_MITCHELL:
        return x < 1 ? (16.0 / 3 + x * x * (7 * x - 12)) / 6 : (32.0 / 3 + x * (-20 + x * (12 - 7.0 / 3 * x))) / 6;
    }
    return 0;
}

/* The integral of the filter over an interval, of all 1. */
static double share_of(enum filter_kind kind, double from, double to, bool absolute) {
    enum { STEPS = 20000 };
    double inside = 0, all = 0, radius = radius_of(kind);
    for (int i = 0; i < STEPS; i++) {
        double x = radius * (2 * (i + 0.5) / STEPS - 1), value = value_of(kind, x);
        value = absolute ? fabs(value) : value;
        all += value;
        inside += x >= from && x < to ? value : 0;
    }
    return inside / all;
}

TEST(samples_of_a_filter_have_its_density_and_its_sign) {
    enum { SIDE = 1000, BINS = 20 };
    for (int kind = 0; kind < LIST_COUNT(FILTERS); kind++) {
        struct filter filter;
        double counts[BINS] = {0}, weights[BINS] = {0}, sum = 0, radius = radius_of((enum filter_kind)kind);
        filter_init(&filter, (enum filter_kind)kind);
        for (int i = 0; i < SIDE; i++) {
            for (int k = 0; k < 16; k++) {
                struct filter_sample sample =
                    filter_sample(&filter, (struct sample2){(i + 0.5) / SIDE, (k + 0.5) / 16});
                int bin = (int)floor((sample.x - 0.5 + radius) / (2 * radius) * BINS);
                CHECK(fabs(sample.x - 0.5) <= radius && fabs(sample.y - 0.5) <= radius && fabs(sample.weight) == 1);
                counts[bin < BINS ? bin : BINS - 1]++;
                weights[bin < BINS ? bin : BINS - 1] += sample.weight;
                sum += sample.weight;
            }
        }
        for (int bin = 0; bin < BINS; bin++) {
            double from = radius * (2.0 * bin / BINS - 1), to = radius * (2.0 * (bin + 1) / BINS - 1);
            CHECK_NEAR(counts[bin] / (SIDE * 16.0), share_of((enum filter_kind)kind, from, to, true), 0.0025);
            CHECK_NEAR(weights[bin] / sum, share_of((enum filter_kind)kind, from, to, false), 0.004);
        }
    }
}

TEST(the_middle_of_the_square_is_the_centre_of_every_filter) {
    for (int kind = 0; kind < LIST_COUNT(FILTERS); kind++) {
        struct filter filter;
        filter_init(&filter, (enum filter_kind)kind);
        struct filter_sample sample = filter_sample(&filter, (struct sample2){0.5, 0.5});
        CHECK_NEAR(sample.x, 0.5, 1e-15);
        CHECK_NEAR(sample.y, 0.5, 1e-15);
        CHECK(sample.weight == 1);
    }
}

/* The right half of the picture glows; nothing is in the left one. */
static void begin_edge(struct stage *s, enum integrator_kind integrator, enum filter_kind filter) {
    stage_begin(s, 2);
    struct material *glowing = stage_phong(s, colour_all(0.5), colour_all(0), 1);
    glowing->phong.emission = colour_all(1);
    glowing->phong.two_sided = true;
    struct node *cube = stage_cube(s, s->root, glowing);
    stage_move(s, cube, 0, -0.5, -1);
    stage_scale(s, cube, 200, 200, 1);
    s->camera = (struct camera){{0, 0, 10}, {0, 0, -1}, {0, 1, 0}, 50};
    s->settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
    s->settings.lens.view_height = 16;
    s->settings.integrator = integrator;
    s->settings.filter = filter;
    s->settings.full = true;
    s->settings.samples = 64;
    s->settings.path_samples = 4096;
}

TEST(an_edge_has_the_profile_of_the_filter_s_integral_with_every_integrator) {
    enum { SIDE = 16 };
    for (int integrator = 0; integrator < LIST_COUNT(INTEGRATORS); integrator++) {
        for (int kind = 0; kind < LIST_COUNT(FILTERS); kind++) {
            struct stage s;
            begin_edge(&s, (enum integrator_kind)integrator, (enum filter_kind)kind);
            s.settings.cropped = true;
            s.settings.crop_x = 4;
            s.settings.crop_y = 7;
            s.settings.crop_width = 8;
            s.settings.crop_height = 2;
            CHECK(stage_render(&s, SIDE, SIDE));
            for (uint32_t x = 0; x < 8; x++) {
                double edge = 8 - (x + 4.5), want = share_of((enum filter_kind)kind, edge, 10, false);
                CHECK_NEAR(stage_pixel(&s, x, 0).r, want, 0.02);
            }
            stage_end(&s);
        }
    }
}

/* Also of the filter whose weights are negative. */
TEST(an_even_picture_stays_even_under_every_filter) {
    for (int integrator = 0; integrator < LIST_COUNT(INTEGRATORS); integrator++) {
        for (int kind = 0; kind < LIST_COUNT(FILTERS); kind++) {
            struct stage s;
            begin_edge(&s, (enum integrator_kind)integrator, (enum filter_kind)kind);
            s.settings.path_samples = 16;
            s.settings.samples = 5;
            s.camera.eye.x = 60;
            CHECK(stage_render(&s, 8, 8));
            for (uint32_t i = 0; i < 64; i++)
                CHECK_NEAR((double)s.film.pixels[i].rgb[1], 1, 1e-6);
            stage_end(&s);
        }
    }
}
