/* Corner cases of the film: impossible sizes, parts outside the picture, the contents of each view, tiles whose bytes
 * do not fit; and the light layer for every kind of light. */
#include "light/light.h"
#include "render/aov_values_internal.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

TEST(films_of_impossible_sizes_are_refused) {
    static const uint32_t sizes[][2] = {{0, 5},       {5, 0}, {0, 0}, {65536, 65536}, {UINT32_MAX, UINT32_MAX},
                                        {1u << 31, 2}};
    struct error error;
    size_t bytes = 0, layered = 0;
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        CHECK(!film_size(sizes[i][0], sizes[i][1], stage_record(INTEGRATOR_WHITTED), &bytes, &error));
        CHECK(error.kind == ERROR_SCENE && strstr(error.text, "is more than gray can hold"));
        CHECK(!film_size_layered(sizes[i][0], sizes[i][1], stage_record(INTEGRATOR_WHITTED), 3, &bytes, &error));
    }
    CHECK(film_size(40, 30, stage_record(INTEGRATOR_WHITTED), &bytes, &error) &&
          film_size_layered(40, 30, stage_record(INTEGRATOR_WHITTED), 2, &layered, &error));
    CHECK(bytes >= 40 * 30 * film_record_size(stage_record(INTEGRATOR_WHITTED)) &&
          layered >= bytes + 2 * 40 * 30 * sizeof(float[3]));
}

TEST(parts_outside_of_the_picture_are_refused) {
    static const int crops[][4] = {{-1, 0, 5, 5}, {0, -1, 5, 5}, {0, 0, 0, 5},  {0, 0, 5, 0},   {40, 0, 1, 1},
                                   {0, 30, 1, 1}, {1, 0, 40, 5}, {0, 1, 5, 30}, {39, 29, 2, 1}, {39, 29, 1, 2}};
    struct render_area area;
    char warning[256];
    struct error error;
    struct render_job job = {.width = 40, .height = 30, .settings = settings_default()};
    job.camera = (struct camera){{0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50};
    job.settings.cropped = true;
    for (size_t i = 0; i < sizeof crops / sizeof crops[0]; i++) {
        struct settings *s = &job.settings;
        s->crop_x = crops[i][0], s->crop_y = crops[i][1], s->crop_width = crops[i][2], s->crop_height = crops[i][3];
        CHECK(!render_prepare(&job, &area, warning, &error));
    }
    job.settings.crop_x = 39, job.settings.crop_y = 29, job.settings.crop_width = job.settings.crop_height = 1;
    CHECK(render_prepare(&job, &area, warning, &error));
    CHECK(area.x0 == 39 && area.y0 == 29 && area.width == 1 && area.height == 1);
}

/* Two pixels, the second one marked: red among the targets, whatever the number of bits. */
TEST(views_of_a_film_show_what_they_are_called) {
    struct error error;
    struct film film = {.full_width = 2, .full_height = 1};
    const struct tone tone = {.exposure = 1};
    size_t bytes;
    uint8_t eight[6];
    uint16_t sixteen[6];
    float linear[6];
    CHECK(film_size(2, 1, stage_record(INTEGRATOR_WHITTED), &bytes, &error));
    void *block = calloc(1, bytes);
    film_layout(&film, block, 2, 1, stage_record(INTEGRATOR_WHITTED));
    for (int i = 0; i < 2; i++)
        for (int c = 0; c < 3; c++) {
            film.pixels[i].rgb[c] = 0.25F;
            film.floats[3 * i + c] = 0.125F;
        }
    film.marked[1] = 1;
    for (int view = FILM_FINAL; view <= FILM_TARGETS; view++) {
        double value = view == FILM_FINAL ? 0.25 : 0.125;
        film_row_toned(&film, (enum film_view)view, &tone, 0, eight);
        film_row_16(&film, (enum film_view)view, &tone, 0, sixteen);
        film_row_linear(&film, (enum film_view)view, 0, linear);
        for (int c = 0; c < 6; c++) {
            bool red = view == FILM_TARGETS && c >= 3;
            double shown = red ? c == 3 : 2 * value, kept = red ? c == 3 : value;
            CHECK_NEAR(eight[c], 255 * shown, 0.5 + 1e-9);
            CHECK_NEAR(sixteen[c], 65535 * shown, 0.5 + 1e-9);
            CHECK_NEAR(linear[c], kept, 0);
        }
    }
    uint8_t packed[FILM_PACKED_LIMIT];
    size_t size = film_tile_pack(&film, 0, packed);
    CHECK(!film_tile_unpack(&film, 0, packed, size - 1) && !film_tile_unpack(&film, 0, packed, 0));
    CHECK(film_tile_unpack(&film, 0, packed, size));
    free(block);
}

TEST(names_of_layers_are_read_or_refused) {
    uint32_t mask;
    CHECK(aov_parse("all", &mask) && mask == AOV_ALL);
    CHECK(aov_parse("depth,uv", &mask) && aov_layers(mask) == 2);
    static const char *const wrong[] = {"", "alt", "depth,", ",uv", "depths", "uv,,uv", "al"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        CHECK(!aov_parse(wrong[i], &mask));
}

/* A floor, a light with centre (0, 5, 0) (or at the given height), a small cube half way: its shadow is directly below
 * it. */
TEST(the_layer_of_lights_has_the_middle_of_every_kind_of_light) {
    enum { SIZE = 21 };
    static const struct light all[] = {
        {.kind = LIGHT_POINT, .position = {0, 5, 0}},
        {.kind = LIGHT_SPOT, .position = {0, 5, 0}, .direction = {0, -1, 0}, .cos_inner = 0.5, .cos_outer = 0.1},
        {.kind = LIGHT_DIRECTIONAL, .direction = {0, -1, 0}},
        {.kind = LIGHT_DISC, .position = {0, 5, 0}, .direction = {0, -1, 0}, .radius = 0.5},
        {.kind = LIGHT_SPHERE, .position = {0, 5, 0}, .radius = 0.5},
        {.kind = LIGHT_PARALLELOGRAM,
         .position = {0, 5, 0},
         .corner = {-1, 5, -1},
         .edge1 = {2, 0, 0},
         .edge2 = {0, 0, 2}}};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        struct stage s;
        stage_floor(&s);
        struct node *cube = stage_cube(&s, s.root, stage_phong(&s, colour_all(0.5), colour_all(0), 1));
        stage_move(&s, cube, -0.5, -0.5, -0.5);
        stage_scale(&s, cube, 0.4, 0.4, 0.4);
        stage_move(&s, cube, 0, 2.5, 0);
        s.lights[0] = all[i];
        s.lights[0].colour = colour_all(1);
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        struct world_scratch scratch;
        CHECK(world_scratch_init(&scratch, &s.world));
        for (int k = 0; k < SIZE; k++) {
            double x = (k - SIZE / 2) * 0.3;
            float layers[AOV_COUNT][3];
            struct ray ray = {.origin = {x, 0.5, 0.01}, .direction = {0, -1, 0}, .t_max = INFINITY};
            aov_surface(&s.world, &ray, AOV_ALL, &scratch, layers);
            /* Seen from the floor the cube covers 0.2 / 2.7 .. 0.2 / 2.3 of the height. */
            double inner = s.lights[0].kind == LIGHT_DIRECTIONAL ? 0.19 : 0.36, outer = inner * 1.25;
            if (fabs(x) < inner)
                CHECK(layers[AOV_LIGHTS][0] == 0);
            if (fabs(x) > outer)
                CHECK(layers[AOV_LIGHTS][0] == 1);
        }
        world_scratch_destroy(&scratch);
        stage_end(&s);
    }
}
