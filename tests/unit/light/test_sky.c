/* The sky: letters on every face, edges without seams, corners that do not bleed. */
#include "image/image.h"
#include "light/sky.h"
#include "tests/harness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIZE = 24 };

struct cross {
    uint32_t width, height; /* of a face */
    uint8_t *texels;
};

static struct cross cross_make(uint32_t width, uint32_t height) {
    return (struct cross){width, height, calloc((size_t)width * height * 12, 4)};
}

static void cross_set(struct cross *cross, uint32_t column, uint32_t row, uint32_t x, uint32_t y, uint8_t r, uint8_t g,
                      uint8_t b) {
    uint8_t *t = cross->texels + 4 * ((size_t)(row * cross->height + y) * cross->width * 4 + column * cross->width + x);
    t[0] = r, t[1] = g, t[2] = b, t[3] = 255;
}

/* Destroys the texels. */
static struct sky cross_sky(struct cross *cross, bool mirror) {
    struct error error = {0};
    struct sky sky = {0};
    struct image *image = image_create("sky.png", cross->width * 4, cross->height * 3, 8, cross->texels, &error);
    if (!image || !sky_from_cross(image, mirror, &sky, &error)) {
        test_fail(__FILE__, __LINE__, "%s", error.text);
        abort();
    }
    free(cross->texels);
    return sky;
}

/* Letters, 5 x 7, drawn on the faces; those that look the same mirrored or turned are told apart by the checks below.
 */
struct letter {
    char name;
    uint32_t column, row;
    struct vec3 view, up; /* a viewer who looks at this face and sees it upright */
    const char *rows[7];
};

static const struct letter letters[6] = {
    {'T', 1, 0, {0, 1, 0}, {0, 0, -1}, {"#####", "#.#.#", "..#..", "..#..", "..#..", "..#..", ".##.."}},
    {'L', 0, 1, {1, 0, 0}, {0, 1, 0}, {"#....", "#....", "#....", "#....", "#....", "#....", "#####"}},
    {'F', 1, 1, {0, 0, 1}, {0, 1, 0}, {"#####", "#....", "#....", "####.", "#....", "#....", "#...."}},
    {'R', 2, 1, {-1, 0, 0}, {0, 1, 0}, {"####.", "#...#", "#...#", "####.", "#.#..", "#..#.", "#...#"}},
    {'K', 3, 1, {0, 0, -1}, {0, 1, 0}, {"#...#", "#..#.", "#.#..", "##...", "#.#..", "#..#.", "#...#"}},
    {'B', 1, 2, {0, -1, 0}, {0, 0, 1}, {"####.", "#...#", "#...#", "####.", "#...#", "#...#", "####."}},
};

static struct cross lettered(void) {
    struct cross cross = cross_make(5 * 4, 7 * 4);
    for (int k = 0; k < 6; k++)
        for (uint32_t y = 0; y < cross.height; y++)
            for (uint32_t x = 0; x < cross.width; x++) {
                uint8_t ink = letters[k].rows[y / 4][x / 4] == '#' ? 255 : 40;
                cross_set(&cross, letters[k].column, letters[k].row, x, y, ink, (uint8_t)(k * 20), 0);
            }
    return cross;
}

static void check_letters(bool mirror) {
    struct cross cross = lettered();
    struct sky sky = cross_sky(&cross, mirror);
    for (int k = 0; k < 6; k++) {
        const struct letter *letter = &letters[k];
        struct vec3 view = letter->view, right = vec3_cross(view, letter->up);
        if (mirror && view.x != 0) /* left and right are exchanged */
            view.x = -view.x, right = vec3_cross(view, letter->up);
        char read[7][6] = {{0}};
        for (int y = 0; y < 7; y++) {
            for (int x = 0; x < 5; x++) {
                struct vec3 d = vec3_add_scaled(view, right, 2 * (x + 0.5) / 5 - 1);
                d = vec3_normalize(vec3_add_scaled(d, letter->up, 1 - 2 * (y + 0.5) / 7));
                struct colour c = sky_colour(&sky, d, 0);
                CHECK_NEAR(c.g, k * 20 / 255.0, 1e-12);
                read[y][mirror ? 4 - x : x] = c.r > 0.9 ? '#' : '.';
            }
            CHECK_TEXT(read[y], letter->rows[y]);
        }
    }
    image_release(sky.image);
}

TEST(sky_letters_on_every_face_read_correctly) {
    check_letters(false);
}

TEST(sky_letters_are_mirrored_on_demand) {
    check_letters(true);
}

TEST(sky_faces_lie_where_the_contract_says) {
    struct cross cross = cross_make(SIZE, SIZE);
    for (uint32_t k = 0; k < 6; k++)
        for (uint32_t i = 0; i < SIZE * SIZE; i++)
            cross_set(&cross, letters[k].column, letters[k].row, i % SIZE, i / SIZE, (uint8_t)letters[k].name, 0, 0);
    struct sky sky = cross_sky(&cross, false);
    static const struct {
        char name;
        struct vec3 direction;
    } faces[] = {{'F', {0, 0, 1}}, {'R', {-1, 0, 0}}, {'K', {0, 0, -1}},
                 {'L', {1, 0, 0}}, {'T', {0, 1, 0}},  {'B', {0, -1, 0}}};
    for (int k = 0; k < 6; k++)
        CHECK_NEAR(sky_colour(&sky, faces[k].direction, 0).r, faces[k].name / 255.0, 1e-12);
    image_release(sky.image);
}

/* Every texel of T and B at F's edges has its column as colour: it must be F's column. */
TEST(sky_top_and_bottom_join_the_front_face) {
    struct cross cross = cross_make(SIZE, SIZE);
    for (uint32_t y = 0; y < SIZE; y++)
        for (uint32_t x = 0; x < SIZE; x++) {
            cross_set(&cross, 1, 1, x, y, (uint8_t)(x * 10), (uint8_t)(y * 10), 0);
            cross_set(&cross, 1, 0, x, y, (uint8_t)(x * 10), (uint8_t)((SIZE - 1 - y) * 10), 255);
            cross_set(&cross, 1, 2, x, y, (uint8_t)(x * 10), (uint8_t)((SIZE - 1 - y) * 10), 255);
        }
    struct sky sky = cross_sky(&cross, false);
    for (int x = 1; x < SIZE - 1; x++) {
        double right = 2 * (x + 0.5) / SIZE - 1, inset = 1 - 1.0 / SIZE;
        struct colour top = sky_colour(&sky, vec3_normalize(vec3_make(-right, 1, inset)), 0);
        CHECK_NEAR(top.r, x * 10 / 255.0, 1e-9);
        CHECK_NEAR(top.g, 0, 1e-9);
        CHECK_NEAR(top.b, 1, 1e-9);
        struct colour bottom = sky_colour(&sky, vec3_normalize(vec3_make(-right, -1, inset)), 0);
        CHECK_NEAR(bottom.r, x * 10 / 255.0, 1e-9);
        CHECK_NEAR(bottom.g, (SIZE - 1) * 10 / 255.0, 1e-9);
        struct colour upper = sky_colour(&sky, vec3_normalize(vec3_make(-right, inset, 1)), 0);
        CHECK_NEAR(upper.r, x * 10 / 255.0, 1e-9);
        CHECK_NEAR(upper.g, 0, 1e-9);
    }
    image_release(sky.image);
}

static struct sky random_sky(uint32_t width, uint32_t height, uint64_t seed) {
    struct test_random random = {seed};
    struct cross cross = cross_make(width, height);
    for (uint32_t k = 0; k < 6; k++)
        for (uint32_t i = 0; i < width * height; i++) {
            uint8_t r = (uint8_t)test_uniform(&random, 0, 256), g = (uint8_t)test_uniform(&random, 0, 256);
            cross_set(&cross, letters[k].column, letters[k].row, i % width, i / width, r, g, 128);
        }
    return cross_sky(&cross, false);
}

TEST(sky_has_no_seams_at_edges_and_corners) {
    struct test_random random = {3};
    for (uint32_t size = 1; size <= 33; size += 8) {
        struct sky sky = random_sky(size, size, size);
        for (int i = 0; i < 4000; i++) {
            /* A point on an edge of the cube, or close to a corner, and neighbours at a tiny distance on both sides. */
            double s[3] = {test_uniform(&random, -1, 1) > 0 ? 1 : -1, test_uniform(&random, -1, 1) > 0 ? 1 : -1,
                           i % 4 == 0 ? (i % 8 ? 1 : -1) : test_uniform(&random, -1, 1)};
            int axis = i % 3;
            struct vec3 p = vec3_make(s[axis], s[(axis + 1) % 3], s[(axis + 2) % 3]);
            double spread = i % 5 ? test_uniform(&random, 0, 1) : 0;
            struct colour c = sky_colour(&sky, vec3_normalize(p), spread);
            for (int k = 0; k < 6; k++) {
                struct vec3 q = p;
                double *parts[3] = {&q.x, &q.y, &q.z};
                *parts[k / 2] *= k % 2 ? 1 + 1e-9 : 1 - 1e-9;
                struct colour d = sky_colour(&sky, vec3_normalize(q), spread);
                CHECK_NEAR(c.r, d.r, 1e-6);
                CHECK_NEAR(c.g, d.g, 1e-6);
                CHECK_NEAR(c.b, 128 / 255.0, 1e-5);
            }
        }
        image_release(sky.image);
    }
}

TEST(sky_corners_of_the_picture_never_show) {
    static const uint32_t sizes[][2] = {{24, 24}, {25, 25}, {7, 31}, {1, 1}, {50, 3}};
    struct test_random random = {4};
    for (size_t n = 0; n < sizeof sizes / sizeof sizes[0]; n++) {
        struct cross cross = cross_make(sizes[n][0], sizes[n][1]); /* transparent black */
        for (uint32_t k = 0; k < 6; k++)
            for (uint32_t i = 0; i < sizes[n][0] * sizes[n][1]; i++)
                cross_set(&cross, letters[k].column, letters[k].row, i % sizes[n][0], i / sizes[n][0], 255, 255, 255);
        struct sky sky = cross_sky(&cross, n % 2);
        for (int i = 0; i < 4000; i++) {
            struct vec3 d =
                vec3_make(test_uniform(&random, -1, 1), test_uniform(&random, -1, 1), test_uniform(&random, -1, 1));
            struct colour c = sky_colour(&sky, vec3_normalize(d), i % 2 ? test_uniform(&random, 0, 3) : 0);
            CHECK_NEAR(c.r, 1, 1e-15);
            CHECK_NEAR(c.g, 1, 1e-15);
            CHECK_NEAR(c.b, 1, 1e-15);
        }
        image_release(sky.image);
    }
}

TEST(sky_wide_cones_blur) {
    struct sky sky = random_sky(64, 64, 5);
    struct test_random random = {6};
    double sharp = 0, blurred = 0;
    for (int i = 0; i < 2000; i++) {
        struct vec3 d = vec3_normalize(vec3_make(test_uniform(&random, -1, 1), test_uniform(&random, -1, 1), 1));
        sharp += fabs(sky_colour(&sky, d, 0).r - 0.5);
        blurred += fabs(sky_colour(&sky, d, 0.5).r - 0.5);
    }
    CHECK(blurred < sharp / 8);
    image_release(sky.image);
}

TEST(sky_survives_directions_that_are_none) {
    struct sky sky = random_sky(4, 4, 7);
    static const struct vec3 bad[] = {{0, 0, 0}, {NAN, 0, 1}, {INFINITY, 1, 1}, {1, -INFINITY, NAN}};
    for (int i = 0; i < 4; i++) {
        struct colour c = sky_colour(&sky, bad[i], i % 2 ? NAN : INFINITY);
        CHECK(c.r == 0 && c.g == 0 && c.b == 0);
        c = sky_colour(&sky, vec3_make(1, 0, 0), i % 2 ? NAN : INFINITY);
        CHECK(c.r >= 0 && c.r <= 1);
    }
    image_release(sky.image);
}

TEST(sky_gradient_and_constant_follow_their_formulas) {
    struct sky gradient = {.kind = SKY_GRADIENT}, constant = {.kind = SKY_CONSTANT, .colour = {3, 2, -1}};
    struct colour c = sky_colour(&gradient, vec3_make(0.6, 0.8, 0), 0.1);
    CHECK(c.r == 0 && c.g == 0 && c.b == (1 + 0.8) / 2);
    c = sky_colour(&gradient, vec3_make(0, -1, 0), 0);
    CHECK(c.r == 0 && c.g == 0 && c.b == 0);
    c = sky_colour(&constant, vec3_make(0, -1, 0), 0);
    CHECK(c.r == 3 && c.g == 2 && c.b == -1);
}

TEST(sky_proportions_are_checked) {
    static const struct {
        uint32_t width, height;
        bool good;
    } sizes[] = {{4, 3, true}, {8, 3, true}, {12, 9, true}, {10, 9, false}, {12, 10, false}, {2, 3, false}};
    uint8_t *texels = calloc(12 * 10, 4);
    for (int i = 0; i < 6; i++) {
        struct error error = {0};
        struct sky sky;
        struct image *image = image_create("sky.png", sizes[i].width, sizes[i].height, 8, texels, &error);
        CHECK(sky_from_cross(image, false, &sky, &error) == sizes[i].good);
        if (!sizes[i].good)
            CHECK(strncmp(error.text, "sky.png: ", 9) == 0 && error.kind == ERROR_SCENE);
        image_release(image);
    }
    free(texels);
}
