/* Which pixels show a node. */
#include "inspect/pick.h"
#include "preview/view_overlay_internal.h"
#include "render/camera.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <string.h>

enum { WIDTH = 80, HEIGHT = 60 };

static bool path_of_second(void *context, uint32_t first, uint32_t count, const struct scene_step *steps,
                           uint32_t depth) {
    (void)count;
    if (first == 1)
        *(uint64_t *)context = route_hash(steps, depth);
    return true;
}

TEST(a_node_shows_where_the_ray_through_the_middle_of_a_pixel_meets_it_first) {
    static uint8_t shows[WIDTH * HEIGHT];
    struct stage s;
    stage_begin(&s, 2);
    struct material *material = stage_phong(&s, colour_all(0.5), colour_all(0), 1);
    struct node *front = stage_sphere(&s, s.root, material);
    stage_move(&s, front, 0.5, 0, 2);
    struct node *behind = stage_sphere(&s, s.root, material);
    stage_move(&s, behind, -0.4, 0.2, 0);
    s.camera = (struct camera){{0, 0, 8}, {0, 0, -1}, {0, 1, 0}, 35};
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    struct render_job job = stage_job(&s, WIDTH, HEIGHT);
    struct view_overlay_buffers buffers = {.shows = shows};
    uint64_t route = 0;
    CHECK(world_visit_node_paths(&s.world, s.root, path_of_second, &route, &s.error));
    for (int by_path = 0; by_path < 2; by_path++) {
        const struct view_overlay_request request = {
            .outline = true, .serial = behind->serial, .route = by_path ? route : 0};
        struct view_overlay overlay;
        memset(shows, 7, sizeof shows);
        CHECK(view_overlay_make(&(struct view_overlay_scene){&job, s.root, s.pool}, &request, &buffers, &overlay,
                                &s.error));
        CHECK(overlay.has_outline && !overlay.has_lines && !overlay.stopped);
        int seen = 0;
        for (uint32_t y = 0; y < HEIGHT; y++) {
            for (uint32_t x = 0; x < WIDTH; x++) {
                /* Distances of the line to the centres, and the first hit. */
                double half = tan(17.5 * M_PI / 180), px = (x + 0.5 - WIDTH / 2.0) / (HEIGHT / 2.0) * half;
                double py = (HEIGHT / 2.0 - y - 0.5) / (HEIGHT / 2.0) * half;
                struct vec3 d = vec3_normalize(vec3_make(px, py, -1)), a = {0.5, 0, -6}, b = {-0.4, 0.2, -8};
                double apart_a = vec3_length(vec3_sub(a, vec3_scale(d, vec3_dot(a, d))));
                double apart_b = vec3_length(vec3_sub(b, vec3_scale(d, vec3_dot(b, d))));
                bool inside = x >= overlay.outline.x0 && x < overlay.outline.x1 && y >= overlay.outline.y0 &&
                              y < overlay.outline.y1;
                bool expected = apart_b < 1 && apart_a > 1;
                CHECK_EQ_INT(inside && shows[y * WIDTH + x], expected);
                CHECK(inside || shows[y * WIDTH + x] == 7);
                seen += expected;
            }
        }
        CHECK(seen > 100);
        CHECK(overlay.outline.x1 - overlay.outline.x0 < 40); /* only a part of the picture was requested */
    }
    const struct view_overlay_request nobody = {.outline = true, .serial = 12345};
    struct view_overlay none;
    CHECK(view_overlay_make(&(struct view_overlay_scene){&job, s.root, s.pool}, &nobody, &buffers, &none, &s.error));
    CHECK(none.has_outline && none.outline.x1 == 0);
    stage_end(&s);
}

TEST(an_operand_shows_where_its_surface_is_that_of_the_solid) {
    static uint8_t shows[WIDTH * HEIGHT];
    struct stage s;
    stage_begin(&s, 2);
    struct material *material = stage_phong(&s, colour_all(0.5), colour_all(0), 1);
    struct node *shelf = stage_group(&s, s.root);
    struct node *large = stage_sphere(&s, shelf, material), *hollow = stage_sphere(&s, shelf, material);
    struct node *lump = stage_sphere(&s, shelf, material);
    shelf->singular = true;
    stage_move(&s, hollow, 0.2, 0.1, 0.9);
    stage_move(&s, lump, 0.9, 0, 0);
    struct node *first[2] = {large, lump};
    struct node *operands[2] = {scene_combine(&s.scene, "both", NODE_UNION, first, 2, &s.error), hollow};
    struct node *cut = scene_combine(&s.scene, "cut", NODE_DIFFERENCE, operands, 2, &s.error);
    CHECK(node_add_child(&s.scene, s.root, cut, &s.error));
    s.camera = (struct camera){{0, 0, 8}, {0, 0, -1}, {0, 1, 0}, 35};
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    struct render_job job = stage_job(&s, WIDTH, HEIGHT);
    struct view_overlay_buffers buffers = {.shows = shows};
    struct picked picked;
    struct view_overlay overlay;
    /* The middle is in the hollow; a click on its outline selects it. */
    for (int32_t down = 0; down <= 1; down++) {
        int seen = 0;
        CHECK(pick_at(&job, s.root, (struct pick_query){WIDTH / 2.0, HEIGHT / 2.0, -down}, &picked, &s.error));
        CHECK_EQ_INT(picked.serial, down ? hollow->serial : cut->serial);
        const struct view_overlay_request request = {
            .outline = true, .serial = picked.serial, .route = picked.route, .solid = picked.solid};
        memset(shows, 0, sizeof shows);
        CHECK(view_overlay_make(&(struct view_overlay_scene){&job, s.root, s.pool}, &request, &buffers, &overlay,
                                &s.error));
        for (uint32_t y = 0; y < HEIGHT; y++) {
            for (uint32_t x = 0; x < WIDTH; x++) {
                CHECK(pick_at(&job, s.root, (struct pick_query){x + 0.5, y + 0.5, -down}, &picked, &s.error));
                bool expected = picked.hit && picked.serial == request.serial;
                CHECK_EQ_INT(shows[y * WIDTH + x] != 0, expected);
                seen += expected;
            }
        }
        CHECK(seen > 100);
    }
    stage_end(&s);
}
