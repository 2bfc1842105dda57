/* Light fields: the file, and new views by their closed forms. */
#include "image/light_field_view.h"
#include "math/elementary.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A grid of views of a plane at a distance, whose colours are linear functions of the point: linear interpolation is
 * exact. distance 0: other numbers for each pixel. is_pattern: a colour for each square that is a pixel wide. */
struct plane {
    struct light_field_head head;
    double distance;
    bool is_pattern;
};

static double pixel_side(const struct light_field_head *head) {
    return 2 * el_tan(head->fov * (PI / 360)) / head->height;
}

static double camera_at(uint32_t index, uint32_t count, const struct light_field_head *head) {
    return (index - (count - 1) / 2.0) * head->spacing;
}

/* The point of the plane at x pixels from the middle of the picture of an eye. */
static double point_of(const struct plane *plane, double eye, double from_middle) {
    return eye * (1 - plane->distance / plane->head.screen) + plane->distance * from_middle * pixel_side(&plane->head);
}

static void colour_of(double x, double y, float out[3]) {
    out[0] = (float)(0.5 + 0.1 * x);
    out[1] = (float)(0.5 - 0.07 * y);
    out[2] = (float)(0.4 + 0.02 * x + 0.03 * y);
}

static void pattern_at(double x, double y, float out[3]) {
    struct test_random random = {.state = (uint64_t)(int64_t)(floor(x) * 1000 + floor(y))};
    for (int c = 0; c < 3; c++)
        out[c] = (float)test_uniform(&random, 0, 1);
}

static void plane_row(void *context, uint32_t y, float *line) {
    const struct plane *plane = context;
    const struct light_field_head *head = &plane->head;
    uint32_t row = y / head->height % head->rows;
    for (uint32_t x = 0; x < head->columns * head->width; x++) {
        struct test_random random = {.state = (uint64_t)y << 20 | x};
        float *out = line + (size_t)3 * x;
        if (y >= head->rows * head->height) {
            out[0] = out[1] = out[2] = plane->distance > 0 ? (float)plane->distance : (float)(x % 7 + 1);
        } else if (plane->distance > 0) {
            double px = point_of(plane, camera_at(x / head->width, head->columns, head),
                                 x % head->width + 0.5 - head->width / 2.0);
            double py = point_of(plane, camera_at(row, head->rows, head), y % head->height + 0.5 - head->height / 2.0);
            double square = plane->distance * pixel_side(head);
            if (plane->is_pattern)
                pattern_at(px / square, py / square, out);
            else
                colour_of(px, py, out);
        } else {
            for (int c = 0; c < 3; c++)
                out[c] = (float)test_uniform(&random, -2, 9);
        }
    }
}

static struct plane make_plane(double distance, bool depth) {
    return (struct plane){
        {.columns = 5, .rows = 3, .width = 24, .height = 20, .depth = depth, .spacing = 0.1, .screen = 4, .fov = 40},
        distance,
        false};
}

static void open_field(struct plane *plane, struct light_field *field, struct pool **pool) {
    const struct light_field_head *head = &plane->head;
    struct picture_source source = {.width = head->columns * head->width,
                                    .height = head->rows * head->height * (1 + head->depth),
                                    .light = plane_row,
                                    .context = plane,
                                    .field = head};
    struct error error = {0};
    char warning[256];
    *pool = pool_create(2, warning);
    CHECK(light_field_write(FILE_AT(test_path("x.lf")), &source, *pool, &error));
    CHECK(light_field_open(field, test_path("x.lf"), &error));
}

TEST(an_eye_at_a_camera_of_a_light_field_gives_the_bytes_of_its_view) {
    for (int depth = 0; depth < 2; depth++) {
        struct plane plane = make_plane(0, depth);
        const struct light_field_head *head = &plane.head;
        struct light_field field;
        struct pool *pool;
        struct error error;
        open_field(&plane, &field, &pool);
        float(*out)[3] = malloc(sizeof *out * head->width * head->height), *line = malloc(3 * sizeof *line * 5 * 24);
        for (uint32_t view = 0; view < head->columns * head->rows; view++) {
            uint32_t column = view % head->columns, row = view / head->columns;
            /* As a user writes it: three tenths are not three times a tenth. */
            char text[32];
            (void)snprintf(text, sizeof text, "%.12g", camera_at(column, head->columns, head));
            struct light_field_camera camera = {
                strtod(text, NULL), -camera_at(row, head->rows, head), 0, 3.3, 0, head->width, head->height, false};
            CHECK(!light_field_clamp(head, &camera));
            CHECK(light_field_draw(&field, &camera, pool, out, &error));
            for (uint32_t y = 0; y < head->height; y++) {
                plane_row(&plane, row * head->height + y, line);
                CHECK(memcmp(out + y * head->width, line + (size_t)3 * column * head->width,
                             head->width * sizeof *out) == 0);
            }
        }
        free(out);
        free(line);
        light_field_close(&field);
        pool_destroy(pool);
    }
}

/* The largest error of the pixels that all cameras see. */
static double error_of(struct light_field *field, const struct plane *plane, struct pool *pool,
                       struct light_field_camera camera) {
    enum { BORDER = 6 };
    struct error error;
    float(*out)[3] = malloc(sizeof *out * camera.width * camera.height), expected[3];
    double largest = 0, ratio = (double)plane->head.width / camera.width;
    CHECK(light_field_draw(field, &camera, pool, out, &error));
    for (uint32_t y = BORDER; y + BORDER < camera.height; y++) {
        for (uint32_t x = BORDER; x + BORDER < camera.width; x++) {
            double at[2] = {x + 0.5 - camera.width / 2.0, y + 0.5 - camera.height / 2.0};
            double eye[2] = {camera.x, -camera.y};
            for (int k = 0; k < 2; k++) {
                double slope = at[k] * ratio * pixel_side(&plane->head) - eye[k] / plane->head.screen;
                at[k] = eye[k] + (plane->distance - camera.z) * slope;
            }
            colour_of(at[0], at[1], expected);
            for (int c = 0; c < 3; c++)
                largest = fmax(largest, fabs((double)out[y * camera.width + x][c] - (double)expected[c]));
        }
    }
    free(out);
    return largest;
}

TEST(a_plane_in_focus_is_exact_from_any_eye_of_a_light_field) {
    struct test_random random = {.state = 5};
    struct plane plane = make_plane(3, false);
    struct light_field field;
    struct pool *pool;
    open_field(&plane, &field, &pool);
    for (int i = 0; i < 40; i++) {
        double z = i % 2 ? test_uniform(&random, -0.2, 0.2) : 0;
        struct light_field_camera camera = {test_uniform(&random, -0.12, 0.12),
                                            test_uniform(&random, -0.04, 0.04),
                                            z,
                                            plane.distance - z,
                                            0,
                                            24,
                                            20,
                                            false};
        if (i % 4 == 3)
            camera.width = 48, camera.height = 40;
        CHECK(error_of(&field, &plane, pool, camera) < 1e-6);
    }
    light_field_close(&field);
    pool_destroy(pool);
}

/* Neighbouring cameras show the pattern two pixels apart, so an eye between them shows it one pixel apart. */
TEST(a_pattern_in_focus_is_sharp_to_the_pixel_between_two_cameras) {
    struct plane plane = make_plane(1, false);
    const struct light_field_head *head = &plane.head;
    plane.is_pattern = true;
    plane.distance = 1 / (1 / head->screen + 2 * pixel_side(head) / head->spacing);
    struct light_field field;
    struct pool *pool;
    struct error error;
    open_field(&plane, &field, &pool);
    float(*out)[3] = malloc(sizeof *out * head->width * head->height), expected[3];
    for (int i = -4; i <= 4; i++) {
        for (int blurred = 0; blurred < 2; blurred++) {
            struct light_field_camera camera = {i * head->spacing / 2,
                                                i / 2 * head->spacing / 2,
                                                0,
                                                blurred ? 1.3 * plane.distance : plane.distance,
                                                0,
                                                head->width,
                                                head->height,
                                                false};
            double largest = 0;
            CHECK(light_field_draw(&field, &camera, pool, out, &error));
            for (uint32_t y = 4; y + 4 < head->height; y++) {
                for (uint32_t x = 8; x + 8 < head->width; x++) {
                    pattern_at(x + 0.5 - head->width / 2.0 + i, y + 0.5 - head->height / 2.0 - i / 2, expected);
                    for (int c = 0; c < 3; c++)
                        largest = fmax(largest, fabs((double)out[y * head->width + x][c] - (double)expected[c]));
                }
            }
            /* Out of focus two cameras disagree, unless the eye is at one of them. */
            CHECK(blurred ? i % 2 == 0 || largest > 0.2 : largest < 1e-5);
        }
    }
    free(out);
    light_field_close(&field);
    pool_destroy(pool);
}

TEST(depths_of_a_light_field_make_a_plane_exact_without_focus) {
    struct test_random random = {.state = 6};
    struct plane plane = make_plane(3, true);
    struct light_field field;
    struct pool *pool;
    open_field(&plane, &field, &pool);
    for (int i = 0; i < 40; i++) {
        double z = i % 2 ? test_uniform(&random, -0.2, 0.2) : 0;
        struct light_field_camera camera = {
            test_uniform(&random, -0.12, 0.12), test_uniform(&random, -0.04, 0.04), z, 2, 0, 24, 20, false};
        CHECK(error_of(&field, &plane, pool, camera) < 1e-6);
    }
    light_field_close(&field);
    pool_destroy(pool);
}

TEST(a_lens_keeps_what_is_in_focus_and_has_the_mean_of_the_rest) {
    struct plane plane = make_plane(3, false);
    struct light_field field;
    struct pool *pool;
    open_field(&plane, &field, &pool);
    for (int i = 0; i < 2; i++) {
        struct light_field_camera camera = {0.02, 0, i * 1e-9, plane.distance, 0.08, 24, 20, false};
        CHECK(error_of(&field, &plane, pool, camera) < 1e-6);
        /* The mean of a linear function is its value in the middle of the lens. */
        camera.focus = 2;
        CHECK(error_of(&field, &plane, pool, camera) < 4e-3);
    }
    light_field_close(&field);
    pool_destroy(pool);
}

TEST(an_eye_outside_of_a_light_field_is_moved_to_its_border) {
    const struct light_field_head head = make_plane(3, false).head;
    struct light_field_camera inside = {0.2, -0.1, 0, 4, 0, 24, 20, false},
                              outside = {0.3, -0.5, 0, 4, 0, 24, 20, false}, behind = {0, 0, -2, 4, 0, 24, 20, false};
    CHECK(!light_field_clamp(&head, &inside));
    CHECK(light_field_clamp(&head, &outside));
    CHECK(outside.x == 2 * head.spacing && outside.y == -head.spacing);
    CHECK(light_field_clamp(&head, &behind));
}

/* Every cut and every changed byte is refused with one line, or gives a field. */
TEST(damaged_light_fields_are_refused_with_one_line) {
    struct plane plane = make_plane(3, true);
    plane.head.columns = plane.head.rows = 2;
    plane.head.width = plane.head.height = 8;
    struct light_field field;
    struct pool *pool;
    open_field(&plane, &field, &pool);
    light_field_close(&field);
    size_t size, refused = 0;
    char *bytes = test_read_file(test_path("x.lf"), &size);
    const char *path = test_path("y.lf");
    for (size_t at = 0; at < 2 * size; at++) {
        const struct light_field_part all = {0, 0, 2, 2};
        struct error error = {0};
        char old = at < size ? bytes[at] : 0;
        if (at < size)
            bytes[at] = (char)(bytes[at] ^ 0x55);
        test_write_file(path, bytes, at < size ? size : at - size);
        bool ok = light_field_open(&field, path, &error);
        if (ok && (uint64_t)field.head.columns * field.head.rows == 4)
            ok = light_field_load_part(&field, &all, pool, &error);
        CHECK(ok || (strstr(error.text, path) && !strchr(error.text, '\n')));
        refused += !ok;
        light_field_close(&field);
        if (at < size)
            bytes[at] = old;
    }
    CHECK(refused >= 2 * size - 60); /* numbers of the head have other values */
    free(bytes);
    pool_destroy(pool);
}
