/* Render layers (AOVs) against closed forms, and statistics that must agree with one another. */
#include "film/aov.h"
#include "output/layers_internal.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef HAVE_EXR
#include <openexr.h>
#endif

static const float *layer(const struct stage *s, enum aov aov, uint32_t x, uint32_t y) {
    size_t pixels = (size_t)s->film.width * s->film.height;
    return s->film.layers[aov_layer(s->film.layer_mask, aov) * pixels + (size_t)y * s->film.width + x];
}

static double layer_sum(const struct stage *s, enum aov aov) {
    double sum = 0;
    for (uint32_t y = 0; y < s->film.height; y++)
        for (uint32_t x = 0; x < s->film.width; x++)
            sum += fabs((double)layer(s, aov, x, y)[0]);
    return sum;
}

/* A ball at the origin seen from z = 10 through an odd number of pixels: one ray goes through its middle. */
TEST(layers_of_a_ball_are_their_closed_forms) {
    enum { SIZE = 41 };
    struct stage s;
    stage_begin(&s, 2);
    stage_sphere(&s, s.root, stage_phong(&s, colour_make(0.2, 0.4, 0.6), colour_all(0), 1));
    stage_point_light(&s, vec3_make(0, 0, 20), colour_all(1));
    stage_point_light(&s, vec3_make(0, 0, -20), colour_all(1));
    s.settings.aov = AOV_ALL;
    CHECK(stage_render(&s, SIZE, SIZE));
    double step = 2 * tan(25 * M_PI / 180) / SIZE, worst = 0;
    int met = 0;
    for (uint32_t y = 0; y < SIZE; y++)
        for (uint32_t x = 0; x < SIZE; x++) {
            struct vec3 d = vec3_normalize(vec3_make((x - 20.0) * step, (20.0 - y) * step, -1));
            double b = -10 * d.z, discriminant = b * b - 99, depth = discriminant > 0 ? b - sqrt(discriminant) : 0;
            struct vec3 n = depth > 0 ? vec3_add_scaled(vec3_make(0, 0, 10), d, depth) : vec3_all(0);
            const float *normal = layer(&s, AOV_NORMAL, x, y), *albedo = layer(&s, AOV_ALBEDO, x, y);
            worst = fmax(worst, fabs((double)layer(&s, AOV_DEPTH, x, y)[0] - depth));
            for (int c = 0; c < 3; c++)
                worst = fmax(worst, fabs((double)normal[c] - vec3_get(n, c)));
            worst = fmax(worst, fabs((double)albedo[2] - (depth > 0 ? 0.6 : 0)));
            CHECK(layer(&s, AOV_NODE, x, y)[0] == (depth > 0 ? 2.0f : 0.0f)); /* made after the root */
            CHECK(layer(&s, AOV_MATERIAL, x, y)[1] == (depth > 0 ? 1.0f : 0.0f));
            CHECK(layer(&s, AOV_LIGHTS, x, y)[0] == (depth > 0 ? 0.5f : 0.0f)); /* the other one is behind it */
            const float *uv = layer(&s, AOV_UV, x, y);
            if (depth > 0) { /* around the y axis, and upwards from the south pole */
                worst = fmax(worst, fabs((double)uv[0] - (0.5 + atan2(n.z, n.x) / (2 * M_PI))));
                worst = fmax(worst, fabs((double)uv[1] - (0.5 + asin(n.y) / M_PI)));
            }
            CHECK(uv[2] == (depth > 0 ? 1.0f : 0.0f));
            met += depth > 0;
        }
    CHECK(met > 20);
    CHECK(worst < 1e-5);
    for (enum aov aov = 0; aov < AOV_RAW; aov++) {
        if (!(layer_sum(&s, aov) > 0))
            test_fail(__FILE__, __LINE__, "the layer %s has no values", aov_name(aov));
    }
    stage_end(&s);
}

#ifdef HAVE_EXR
/* One channel of a file by OpenEXR itself; from malloc. */
static float *read_channel(const char *path, const char *name, int *width, int *height) {
    exr_context_t context;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_attr_box2i_t window;
    int step = 0;
    bool begun = false, met = false;
    if (exr_start_read(&context, path, &init) != EXR_ERR_SUCCESS)
        return NULL;
    (void)exr_get_data_window(context, 0, &window);
    (void)exr_get_scanlines_per_chunk(context, 0, &step);
    *width = window.max.x + 1;
    *height = window.max.y + 1;
    float *out = calloc((size_t)*width * (size_t)*height, sizeof *out);
    for (int y = 0; y < *height; y += step) {
        exr_chunk_info_t chunk;
        CHECK(exr_read_scanline_chunk_info(context, 0, y, &chunk) == EXR_ERR_SUCCESS);
        CHECK((begun ? exr_decoding_update(context, 0, &chunk, &decoder)
                     : exr_decoding_initialize(context, 0, &chunk, &decoder)) == EXR_ERR_SUCCESS);
        for (int i = 0; i < decoder.channel_count; i++) {
            exr_coding_channel_info_t *channel = &decoder.channels[i];
            bool wanted = strcmp(channel->channel_name, name) == 0;
            met = met || wanted;
            channel->decode_to_ptr = wanted ? (uint8_t *)(out + (size_t)y * (size_t)*width) : NULL;
            channel->user_bytes_per_element = 4;
            channel->user_data_type = EXR_PIXEL_FLOAT;
            channel->user_pixel_stride = 4;
            channel->user_line_stride = *width * 4;
        }
        CHECK(begun || exr_decoding_choose_default_routines(context, 0, &decoder) == EXR_ERR_SUCCESS);
        begun = true;
        CHECK(exr_decoding_run(context, 0, &decoder) == EXR_ERR_SUCCESS);
    }
    (void)exr_decoding_destroy(context, &decoder);
    (void)exr_finish(&context);
    if (!met)
        test_fail(__FILE__, __LINE__, "%s has no channel %s", path, name);
    return out;
}
#endif

TEST(an_exr_picture_has_its_layers_in_itself_with_every_value) {
#ifdef HAVE_EXR
    static const struct {
        const char *name;
        enum aov aov;
        int component;
    } channels[] = {{"depth.Z", AOV_DEPTH, 0},
                    {"normal.X", AOV_NORMAL, 0},
                    {"normal.Y", AOV_NORMAL, 1},
                    {"normal.Z", AOV_NORMAL, 2},
                    {"albedo.R", AOV_ALBEDO, 0},
                    {"albedo.G", AOV_ALBEDO, 1},
                    {"albedo.B", AOV_ALBEDO, 2},
                    {"uv.U", AOV_UV, 0},
                    {"uv.V", AOV_UV, 1},
                    {"node.N", AOV_NODE, 0},
                    {"material.N", AOV_MATERIAL, 0},
                    {"cost.N", AOV_COST, 0},
                    {"samples.N", AOV_SAMPLES, 0},
                    {"lights.N", AOV_LIGHTS, 0}};
    struct stage s;
    int width, height;
    const char *path = test_path("out.exr");
    stage_begin(&s, 2);
    stage_sphere(&s, s.root, stage_phong(&s, colour_make(0.2, 0.4, 0.6), colour_all(0), 1));
    stage_point_light(&s, vec3_make(0, 5, 20), colour_all(1));
    s.settings.aov = AOV_ALL;
    CHECK(stage_render(&s, 53, 37));
    CHECK(layers_write_exr(FILE_AT(path), &s.film, NULL, &s.error));
    for (size_t i = 0; i < sizeof channels / sizeof *channels; i++) {
        float *values = read_channel(path, channels[i].name, &width, &height);
        CHECK(values && width == 53 && height == 37);
        for (uint32_t y = 0; values && y < 37; y++)
            for (uint32_t x = 0; x < 53; x++)
                CHECK(values[y * 53 + x] == layer(&s, channels[i].aov, x, y)[channels[i].component]);
        free(values);
    }
    float *red = read_channel(path, "R", &width, &height);
    for (int i = 0; red && i < 53 * 37; i++)
        CHECK(red[i] == s.film.pixels[i].rgb[0]);
    free(red);
    stage_end(&s);
#else
    test_lacks("gray was built without OpenEXR");
#endif
}

TEST(layers_change_nothing_in_the_picture_and_its_statistics) {
    unsigned char *reference = NULL;
    uint64_t rays = 0;
    size_t size = (size_t)60 * 50 * film_record_size(stage_record(INTEGRATOR_WHITTED));
    for (int i = 0; i < 2; i++) {
        struct stage s;
        stage_begin(&s, 2);
        stage_sphere(&s, s.root, stage_glass(&s, 0.4, 0.6, 1.5));
        stage_move(&s, stage_cube(&s, s.root, stage_phong(&s, colour_all(0.7), colour_all(0.2), 9)), -2, -1, -2);
        stage_point_light(&s, vec3_make(4, 6, 8), colour_all(1));
        s.settings.aov = i ? AOV_ALL : 0;
        CHECK(stage_render(&s, 60, 50));
        if (i)
            CHECK(memcmp(reference, s.film.pixels, size) == 0 && rays == s.statistics.camera_rays);
        else
            reference = memcpy(malloc(size), s.film.pixels, size);
        rays = s.statistics.camera_rays;
        stage_end(&s);
    }
    free(reference);
}

/* No ray hits anything, and without an accelerator every ray tests every box: the cost is known. */
TEST(the_cost_of_a_ray_that_tests_everything_is_the_number_of_primitives) {
    enum { OBJECTS = 37 };
    struct stage s;
    stage_begin(&s, 1);
    for (int i = 0; i < OBJECTS; i++)
        stage_move(&s, stage_sphere(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1)), 3 * i, 0, 30);
    s.settings.accel = ACCEL_NONE;
    s.settings.aov = UINT32_C(1) << AOV_COST | UINT32_C(1) << AOV_SAMPLES;
    CHECK(stage_render(&s, 20, 10));
    for (uint32_t y = 0; y < 10; y++)
        for (uint32_t x = 0; x < 20; x++) {
            CHECK(layer(&s, AOV_COST, x, y)[0] == OBJECTS);
            CHECK(layer(&s, AOV_SAMPLES, x, y)[0] == 1);
        }
    stage_end(&s);
}

static void crowd(struct stage *s) {
    struct material *shiny = stage_glass(s, 0.3, 0.5, 1.3),
                    *plain = stage_phong(s, colour_all(0.8), colour_all(0.1), 5);
    for (int i = 0; i < 40; i++) {
        struct node *ball = stage_sphere(s, s->root, i % 3 ? plain : shiny);
        stage_scale(s, ball, 0.4, 0.4, 0.4);
        stage_move(s, ball, i % 8 - 3.5, i / 8 - 2, -(i % 5));
    }
    stage_point_light(s, vec3_make(4, 6, 8), colour_all(1));
}

/* Rays outside packets are measured while they are traced, so the parts add up to the total. */
TEST(the_costs_of_all_pixels_are_those_of_the_statistics) {
    struct stage s;
    stage_begin(&s, 2);
    crowd(&s);
    s.settings.full = true;
    s.settings.samples = 2;
    s.settings.lens.projection = PROJECTION_ORTHOGRAPHIC;
    s.settings.lens.view_height = 7;
    s.settings.accel = ACCEL_GRID;
    s.settings.aov = UINT32_C(1) << AOV_COST | UINT32_C(1) << AOV_SAMPLES;
    CHECK(stage_render(&s, 40, 30));
    CHECK(layer_sum(&s, AOV_SAMPLES) == (double)s.statistics.camera_rays);
    const struct render_statistics *t = &s.statistics;
    uint64_t work = t->box_tests + t->shape_tests + t->triangle_tests + t->voxels + t->hierarchy_steps;
    /* A shadow ray first tests the occluder of the previous one, which differs when pixels are measured. */
    CHECK(fabs(layer_sum(&s, AOV_COST) - (double)work) < 0.02 * (double)work);
    stage_end(&s);
}

TEST(every_accelerator_sends_the_same_rays) {
    struct render_statistics first = {0};
    static const enum accel_kind kinds[] = {ACCEL_NONE, ACCEL_AUTO, ACCEL_GRID, ACCEL_BVH, ACCEL_KDTREE};
    for (int i = 0; i < 5; i++) {
        struct stage s;
        stage_begin(&s, 2);
        crowd(&s);
        s.settings.accel = kinds[i];
        CHECK(stage_render(&s, 60, 40));
        const struct render_statistics *t = &s.statistics;
        if (i == 0)
            first = *t;
        CHECK(t->camera_rays == first.camera_rays && t->reflected_rays == first.reflected_rays);
        CHECK(t->refracted_rays == first.refracted_rays && t->shadow_rays == first.shadow_rays);
        CHECK(t->samples == t->camera_rays && t->pixels == 60 * 40 && t->marked_pixels == first.marked_pixels);
        /* Without an accelerator the most primitives are tested; a tree must visit nodes and a grid must visit voxels.
         */
        CHECK(i == 0 || t->shape_tests <= first.shape_tests);
        CHECK((t->hierarchy_steps > 0) ==
              (kinds[i] == ACCEL_AUTO || kinds[i] == ACCEL_BVH || kinds[i] == ACCEL_KDTREE));
        CHECK((t->voxels > 0) == (kinds[i] == ACCEL_GRID || kinds[i] == ACCEL_KDTREE));
        CHECK(t->triangle_tests == 0);
        stage_end(&s);
    }
}

TEST(colours_of_layers_are_their_encodings) {
    static const struct {
        enum aov aov;
        float value[3];
        double rgb[3];
    } cases[] = {{AOV_DEPTH, {4, 4, 4}, {0.5, 0.5, 0.5}},
                 {AOV_DEPTH, {0, 0, 0}, {0, 0, 0}},
                 {AOV_NORMAL, {0, 1, -1}, {0.5, 1, 0}},
                 {AOV_NORMAL, {0, 0, 0}, {0, 0, 0}},
                 {AOV_UV, {1.25f, -0.25f, 1}, {0.25, 0.75, 1}},
                 {AOV_ALBEDO, {0.5f, 2, 0}, {0.5, 1, 0}},
                 {AOV_COST, {1, 1, 1}, {0, 0, 0}},
                 {AOV_COST, {1024, 1024, 1024}, {1, 0, 0}},
                 {AOV_COST, {32, 32, 32}, {0, 0, 1}},
                 {AOV_COST, {1 << 20, 0, 0}, {1, 1, 1}},
                 {AOV_SAMPLES, {4, 4, 4}, {0.4, 0.4, 0.4}},
                 {AOV_LIGHTS, {0.5f, 0.5f, 0.5f}, {0.5, 0.5, 0.5}}};
    const struct aov_scale scale = {2, 10};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double rgb[3];
        aov_colour(cases[i].aov, &scale, cases[i].value, rgb);
        for (int c = 0; c < 3; c++)
            CHECK(fabs(rgb[c] - cases[i].rgb[c]) < 1e-9);
    }
    double one[3], other[3];
    aov_colour(AOV_NODE, &scale, (const float[3]){1, 1, 1}, one);
    aov_colour(AOV_NODE, &scale, (const float[3]){2, 2, 2}, other);
    CHECK(memcmp(one, other, sizeof one) != 0 && one[0] >= 0.25);
    uint32_t mask = 0;
    CHECK(aov_parse("depth,lights", &mask) && aov_layers(mask) == 2 && aov_layer(mask, AOV_LIGHTS) == 1);
    CHECK(aov_parse("all", &mask) && mask == AOV_ALL);
    CHECK(!aov_parse("depth,,uv", &mask) && !aov_parse("", &mask) && !aov_parse("depth,", &mask));
}
