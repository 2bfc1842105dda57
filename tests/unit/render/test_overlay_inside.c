/* Overlay lines on a picture whose camera is among the boxes: edges that pass the camera, boxes behind it, unbounded
 * boxes. The lines must be those of edges projected point by point. */
#include "render/camera.h"
#include "render/overlay.h"
#include "shape/planar.h"
#include "tests/harness.h"
#include "tests/stage.h"
#include "tests/unit/random_makers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 60, HEIGHT = 45, CUBES = 9, POINTS = 800 };

/* Marks the pixels that points of the edges of a box fall on. */
static void mark(const struct camera_frame *frame, const struct box *box, uint8_t *marked) {
    for (int i = 0; i < 8; i++)
        for (int axis = 1; axis <= 4; axis *= 2) {
            if (i & axis)
                continue;
            int j = i | axis;
            struct vec3 a = {i & 1 ? box->max.x : box->min.x, i & 2 ? box->max.y : box->min.y,
                             i & 4 ? box->max.z : box->min.z};
            struct vec3 b = {j & 1 ? box->max.x : box->min.x, j & 2 ? box->max.y : box->min.y,
                             j & 4 ? box->max.z : box->min.z};
            for (int k = 0; k <= POINTS; k++) {
                struct vec3 p = vec3_add_scaled(a, vec3_sub(b, a), (double)k / POINTS);
                double x, y;
                bool behind = frame->lens.projection <= PROJECTION_ORTHOGRAPHIC &&
                              vec3_dot(vec3_sub(p, frame->eye), frame->forward) <= 0;
                if (!behind && camera_project(frame, p, &x, &y) && x >= 0 && y >= 0 && x < WIDTH && y < HEIGHT)
                    marked[(int)y * WIDTH + (int)x] = 1;
            }
        }
}

static bool near_marked(const uint8_t *marked, int x, int y) {
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++)
            if (x + dx >= 0 && y + dy >= 0 && x + dx < WIDTH && y + dy < HEIGHT && marked[(y + dy) * WIDTH + x + dx])
                return true;
    return false;
}

static void prepare(struct stage *s, struct test_random *random) {
    stage_begin(s, 2);
    struct material *material = stage_phong(s, colour_all(0.5), colour_all(0), 1);
    for (int i = 0; i < CUBES; i++) {
        struct node *cube = stage_cube(s, s->root, material);
        struct vec3 p = random_vec3(random, 2);
        stage_move(s, cube, p.x, p.y, p.z);
        stage_scale(s, cube, 1.3, 0.9, 1.1);
    }
    struct node *floor = stage_cube(s, s->root, material);
    floor->shape = (struct shape){.kind = SHAPE_PLANAR, .planar = planar_plane(vec3_make(0.1, 1, 0), -9)};
}

TEST(edges_around_the_camera_are_drawn_where_their_points_are) {
    static float lines[WIDTH * HEIGHT][4];
    struct test_random random = {12};
    for (int turn = 0; turn < 8; turn++) {
        struct stage s;
        static uint8_t wanted[WIDTH * HEIGHT], drawn[WIDTH * HEIGHT];
        char warning[256];
        struct camera_frame frame;
        prepare(&s, &random);
        s.camera = (struct camera){random_vec3(&random, 1.5), random_vec3(&random, 1), {0.1, 1, 0.2}, 70};
        s.settings.lens.projection = (enum projection)(turn % 4);
        s.settings.full = true;
        s.settings.samples = 1;
        CHECK(stage_render(&s, WIDTH, HEIGHT));
        struct render_job job = stage_job(&s, WIDTH, HEIGHT);
        const struct overlay_request request = {OVERLAY_OF_BOXES, OVERLAY_BOXES, 1};
        CHECK(overlay_lines(&job, s.pool, &request, lines, &s.error));
        CHECK(camera_prepare(&s.camera, &s.settings, (struct picture_size){WIDTH, HEIGHT}, &frame, warning, &s.error));
        memset(wanted, 0, sizeof wanted);
        for (uint32_t i = 0; i < s.world.primitive_count; i++)
            if (vec3_finite(s.world.boxes[i].min) && vec3_finite(s.world.boxes[i].max))
                mark(&frame, &s.world.boxes[i], wanted);
        int false_ink = 0, missing = 0, inked = 0;
        for (int i = 0; i < WIDTH * HEIGHT; i++)
            drawn[i] = lines[i][3] < 1;
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                inked += drawn[y * WIDTH + x];
                false_ink += drawn[y * WIDTH + x] && !near_marked(wanted, x, y);
                missing += wanted[y * WIDTH + x] && !near_marked(drawn, x, y);
            }
        /* A piece that crosses the seam of a panorama is left out, 1/32 of an edge. */
        int left_out = s.settings.lens.projection == PROJECTION_PANORAMA ? 15 : 0;
        if (false_ink > 0 || missing > left_out || inked < 20)
            test_fail(__FILE__, __LINE__, "turn %d: %d dots, %d where no edge is, %d missing", turn, inked, false_ink,
                      missing);
        stage_end(&s);
    }
}

TEST(lines_may_be_stopped_and_some_boxes_represent_all) {
    static float all[WIDTH * HEIGHT][4], some[WIDTH * HEIGHT][4];
    static const enum accel_kind kinds[] = {ACCEL_AUTO, ACCEL_GRID, ACCEL_BVH, ACCEL_KDTREE};
    struct test_random random = {12};
    struct stage s;
    prepare(&s, &random);
    for (int k = 0; k < 8; k++) {
        s.settings.accel = kinds[k % 4];
        CHECK(stage_render(&s, WIDTH, HEIGHT));
        struct render_job job = stage_job(&s, WIDTH, HEIGHT);
        const struct overlay_request whole = {k < 4 ? OVERLAY_OF_BOXES : OVERLAY_OF_GRID, OVERLAY_BOXES, 1},
                                     part = {whole.kind, 3, 4};
        CHECK(overlay_lines(&job, s.pool, &whole, all, &s.error) && overlay_lines(&job, s.pool, &part, some, &s.error));
        int more = 0, fewer = 0;
        for (int i = 0; i < WIDTH * HEIGHT; i++) {
            more += all[i][3] < 1 && !(some[i][3] < 1);
            fewer += some[i][3] < 1 && !(all[i][3] < 1);
        }
        CHECK(fewer == 0 && (k >= 4 || more > 10));
        pool_cancel(s.pool);
        CHECK(!overlay_lines(&job, s.pool, &whole, all, &s.error) && s.error.kind == ERROR_CANCELLED);
        pool_reset_cancel(s.pool);
    }
    stage_end(&s);
}
