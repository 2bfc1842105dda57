/* Small bright discs in skies, beside the irradiance of a disc: pi sin^2(radius) cos(angle to the normal). */
#include "shape/planar.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/function_makers.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

/* A sky that is black but for a disc. */
struct sun {
    struct vec3 middle; /* unit */
    double radius;      /* radians */
    double radiance;
};

static bool in_sun(const struct sun *sun, struct vec3 d) {
    return vec3_length(vec3_sub(d, sun->middle)) < 2 * sin(sun->radius / 2);
}

/* As scenes write it: d:dot(sun) > cos(radius), or (d - sun):length() < chord. */
static const struct expr_program *sun_function(const struct sun *sun, bool by_distance, struct arena *arena) {
    struct function_maker m;
    function_begin(&m);
    uint32_t dot = EXPR_NONE, is_in;
    for (int k = 0; k < 3; k++) {
        uint32_t part = fn_scaled(&m, vec3_get(sun->middle, k), m.p[k]);
        dot = k ? fn_add(&m, dot, part) : part;
    }
    if (by_distance)
        is_in = fn_two(&m, EXPR_LESS, fn_ball(&m, sun->middle, 2 * sin(sun->radius / 2), true), fn_number(&m, 0));
    else
        is_in = fn_two(&m, EXPR_LESS, fn_number(&m, cos(sun->radius)), dot);
    uint32_t value = expr_operation(&m.graph, EXPR_SELECT, is_in, fn_number(&m, sun->radiance), fn_number(&m, 0));
    return function_end(&m, value, arena);
}

enum { MAP_WIDTH = 2048, MAP_HEIGHT = 1024 };

static struct vec3 map_direction(double x, double y) {
    double turn = (x / MAP_WIDTH - 0.5) * 2 * pi, down = y / MAP_HEIGHT * pi;
    return vec3_make(sin(down) * sin(turn), cos(down), -sin(down) * cos(turn));
}

/* Every texel has the fraction of the disc that it covers. */
static struct image *sun_map(const struct sun *sun) {
    float *texels = calloc((size_t)MAP_WIDTH * MAP_HEIGHT * 4, sizeof *texels);
    const int parts = sun->radius > 0.02 ? 4 : 32; /* along the side of a texel */
    double down = acos(sun->middle.y) / pi * MAP_HEIGHT, rows = (sun->radius + 0.01) / pi * MAP_HEIGHT;
    for (int y = 0; y < MAP_HEIGHT; y++) {
        for (int x = 0; x < MAP_WIDTH; x++) {
            float *texel = &texels[((size_t)y * MAP_WIDTH + (size_t)x) * 4];
            texel[3] = 1;
            if (fabs(y + 0.5 - down) > rows ||
                vec3_length(vec3_sub(map_direction(x + 0.5, y + 0.5), sun->middle)) > sun->radius + 0.01)
                continue;
            int inside = 0;
            for (int k = 0; k < parts * parts; k++)
                inside += in_sun(sun, map_direction(x + (k % parts + 0.5) / parts, y + (k / parts + 0.5) / parts));
            texel[0] = texel[1] = texel[2] = (float)(sun->radiance * inside / (parts * parts));
        }
    }
    struct error error;
    struct image *image = image_create("sun", MAP_WIDTH, MAP_HEIGHT, 32, texels, &error);
    free(texels);
    CHECK(image != NULL);
    return image;
}

/* The integral of radiance times cosine around the disc, in rings. */
static double irradiance(const struct sky *sky, const struct sun *sun) {
    enum { RINGS = 600, SPOKES = 900 };
    struct vec3 side = vec3_normalize(vec3_cross(sun->middle, vec3_make(0.3, 0.2, 0.9)));
    struct vec3 up = vec3_cross(side, sun->middle);
    double sum = 0, rim = sun->radius + 0.008;
    for (int i = 0; i < RINGS; i++) {
        double angle = (i + 0.5) / RINGS * rim, ring = 0;
        for (int k = 0; k < SPOKES; k++) {
            double turn = 2 * pi * (k + 0.5) / SPOKES;
            struct vec3 out = vec3_add(vec3_scale(side, cos(turn)), vec3_scale(up, sin(turn)));
            struct vec3 d = vec3_add(vec3_scale(sun->middle, cos(angle)), vec3_scale(out, sin(angle)));
            ring += fmax(d.y, 0) * sky_colour(sky, d, 0).r;
        }
        sum += ring / SPOKES * 2 * pi * sin(angle) * rim / RINGS;
    }
    return sum;
}

/* A white floor below a sky: 9 x 8 pixels of 256 samples each. */
static void check_floor(const struct sky *sky, const struct sun *sun, double expected, const char *form, int seeds) {
    struct stage s;
    stage_begin(&s, 1);
    s.camera = (struct camera){{0, 4, 0}, {0, -1, 0}, {0, 0, -1}, 40};
    struct node *floor = stage_sphere(&s, s.root, stage_phong(&s, colour_all(1), colour_all(0), 1));
    floor->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar_plane(vec3_make(0, 1, 0), 0)};
    s.lights[s.light_count++] = (struct light){.kind = LIGHT_SKY, .emissive = true, .colour = {1, 1, 1}, .sky = sky};
    s.settings.integrator = INTEGRATOR_PATH;
    s.settings.path_samples = 256;
    s.settings.max_depth = 1;
    for (int seed = 1; seed <= seeds; seed++) {
        double sum = 0, worst = 0;
        s.settings.seed = (uint64_t)seed;
        CHECK(stage_render(&s, 9, 8));
        for (uint32_t i = 0; i < 72; i++) {
            double value = stage_pixel(&s, i % 9, i / 9).r / expected;
            sum += value / 72;
            worst = fmax(worst, fabs(value - 1));
        }
        if (!(fabs(sum - 1) < 0.01 && worst < 0.1))
            test_fail(__FILE__, __LINE__, "a sun of %g degrees at {%g, %g, %g} in a %s, seed %d: mean %g, worst %g",
                      sun->radius * 360 / pi, sun->middle.x, sun->middle.y, sun->middle.z, form, seed, sum, worst);
    }
    stage_end(&s);
}

/* A function, and the same turned away and back, half as bright and doubled. */
static void check_function(const struct sun *sun, bool is_turned, int seeds) {
    struct arena arena = {0};
    struct error error;
    struct sky sky;
    struct sun other = *sun;
    if (is_turned) {
        other.radiance = sun->radiance / 2;
        other.middle.x = 0.8 * sun->middle.x - 0.6 * sun->middle.z;
        other.middle.z = 0.6 * sun->middle.x + 0.8 * sun->middle.z;
    }
    CHECK(sky_from_function(sun_function(&other, is_turned, &arena), &sky, &error));
    if (is_turned) {
        sky_turn(&sky, 0.6, 0.8);
        sky.intensity = 2;
    }
    check_floor(&sky, sun, pow(sin(sun->radius), 2) * sun->middle.y * sun->radiance, "function", seeds);
    arena_destroy(&arena);
}

static void check_map(const struct sun *sun, int seeds) {
    struct sky sky = {.kind = SKY_MAP, .image = sun_map(sun)};
    check_floor(&sky, sun, irradiance(&sky, sun) / pi, "map", seeds);
    image_release(sky.image);
}

/* Near and at the pole, at both seams (of longitude and of the map), on the border of cells, and anywhere. */
static const struct vec3 middles[] = {{0.3, 0.8, 0.5},  {0, 1, 0},        {0.01, 1, 0.02}, {1, 0.6, 0},
                                      {1, 0.5, -0.001}, {-0.002, 0.7, 1}, {-1, 0.25, 0.1}, {-0.4, 1.2, -0.9}};
static const double diameters[] = {20, 5, 1, 0.5, 0.2, 0.05};

TEST_TIMES(a_sun_of_any_size_in_a_sky_lights_a_floor_without_noise, 24) {
    enum { MIDDLES = sizeof middles / sizeof *middles, DIAMETERS = sizeof diameters / sizeof *diameters };
    for (int i = 0; i < DIAMETERS; i++) {
        for (int k = 0; k < (times > 1 ? MIDDLES : 1); k++) {
            struct sun sun = {vec3_normalize(middles[times > 1 ? k : i]), diameters[i] * pi / 360, 0};
            sun.radiance = 0.8 / pow(sin(sun.radius), 2);
            check_function(&sun, false, times > 1 ? 3 : 1);
            check_function(&sun, true, times > 1 ? 3 : 1);
            check_map(&sun, times > 1 ? 3 : 1);
        }
    }
}

/* In the middle of the upper face, at its corner, and at the edge of another one. */
TEST(single_bright_texels_of_six_pictures_light_a_floor_without_noise) {
    enum { SIDE = 256 };
    static const struct {
        int face, x, y;
        struct vec3 middle;
    } bright[] = {{3, 128, 128, {0, 1, 0}}, {3, 0, 0, {1, 1, -1}}, {5, 100, 0, {0.2, 1, 1}}};
    static float texels[SIDE * SIDE * 4];
    for (int k = 0; k < 3; k++) {
        struct sky sky;
        struct error error;
        struct image *faces[6];
        for (int face = 0; face < 6; face++) {
            for (int i = 0; i < SIDE * SIDE * 4; i++)
                texels[i] = i % 4 == 3;
            for (int c = 0; c < 3 && face == bright[k].face; c++)
                texels[(bright[k].y * SIDE + bright[k].x) * 4 + c] = 30000;
            faces[face] = image_create("face", SIDE, SIDE, 32, texels, &error);
        }
        CHECK(sky_from_faces(faces, &sky, &error));
        struct sun sun = {vec3_normalize(bright[k].middle), 0.1, 0};
        double expected = irradiance(&sky, &sun) / pi;
        CHECK(expected > 0.05);
        check_floor(&sky, &sun, expected, "cube", 1);
        for (int face = 0; face < 6; face++)
            image_release(faces[face]);
    }
}
