/* Corner cases of the window's parts that need no window: cameras in any direction, edit steps and watched files
 * without memory. */
#include "base/fault.h"
#include "host/file_watch.h"
#include "render/fly_camera.h"
#include "scene/edits.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* For any view direction, also straight up and with an up vector parallel to it. */
TEST(the_fly_camera_begins_in_the_direction_of_the_camera) {
    const struct box box = {{-1, -1, -1}, {1, 1, 1}}, endless = {{-INFINITY, -1, -1}, {1, 1, 1}},
                     nothing = {{1, 1, 1}, {-1, -1, -1}}, above = {{-1, -1, -1}, {1, INFINITY, 1}};
    const struct box *const boxes[] = {&box, &endless, &nothing, &above};
    for (int x = -1; x <= 1; x++)
        for (int y = -1; y <= 1; y++)
            for (int z = -1; z <= 1; z++)
                for (int k = 0; k < 4; k++) {
                    struct vec3 view = {x, y, z}, up = k == 3 ? view : vec3_make(k == 1, k == 0, k == 2);
                    if (x == 0 && y == 0 && z == 0)
                        continue;
                    const struct camera camera = {{3, 4, 5}, view, up, 40};
                    struct fly_camera fly_camera;
                    fly_camera_begin(&fly_camera, &camera, boxes[(x + y + z + 3) % 4]);
                    struct camera now = fly_camera_current(&fly_camera);
                    struct vec3 have = vec3_normalize(now.view), wanted = vec3_normalize(view);
                    CHECK(vec3_length(vec3_sub(have, wanted)) < 1e-9);
                    CHECK(fabs(vec3_dot(vec3_normalize(now.up), have)) < 1e-9);
                    CHECK(now.eye.x == 3 && now.eye.y == 4 && now.eye.z == 5);
                    CHECK(fly_camera.speed > 0 && isfinite(fly_camera.speed));
                    fly_camera.down[FLY_FORWARD] = true;
                    CHECK(!fly_camera_step(&fly_camera, 0) && fly_camera_step(&fly_camera, 1));
                    struct vec3 route = vec3_normalize(vec3_sub(fly_camera_current(&fly_camera).eye, now.eye));
                    CHECK(vec3_length(vec3_sub(route, wanted)) < 1e-9);
                    fly_camera.down[FLY_BACK] = true; /* both: nowhere */
                    CHECK(!fly_camera_step(&fly_camera, 1));
                }
    struct fly_camera fly_camera;
    const struct camera camera = {{0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 40};
    fly_camera_begin(&fly_camera, &camera, &box);
    fly_camera_zoom(&fly_camera, 1000);
    CHECK_NEAR(fly_camera_current(&fly_camera).fov, 0.01, 1e-12);
    fly_camera_zoom(&fly_camera, -2000);
    CHECK_NEAR(fly_camera_current(&fly_camera).fov, 170, 1e-9);
}

/* --- steps --- */

static bool put_until(void *context, const char *line) {
    int *left = context;
    CHECK(line[0] != '\0');
    return --*left >= 0;
}

TEST(edits_are_written_as_lua_until_the_writer_stops) {
    struct edits edits = {0};
    struct change change = {.kind = CHANGE_GONE, .serial = 3};
    strcpy(change.name, "it's \\ a\x7f\nname");
    for (int i = 0; i < 40; i++, change.serial++)
        CHECK(edits_make(&edits, &change, true, false));
    const struct camera camera = {{1, 2, 3}, {0, 0, -1}, {0, 1, 0}, 30};
    const double exposure = 1.5;
    int lines = 1000;
    CHECK(edits_write_lua(&edits.now, "a.png", &camera, &exposure, put_until, &lines));
    int all = 1000 - lines;
    for (int room = 0; room < all; room++) {
        lines = room;
        CHECK(!edits_write_lua(&edits.now, "a.png", &camera, &exposure, put_until, &lines));
    }
    lines = 1000;
    CHECK(edits_write_lua(&edits.now, "a.png", NULL, NULL, put_until, &lines));
    CHECK(1000 - lines < all);
    edits_destroy(&edits);
}

#ifdef GRAY_FAULTS
TEST(edits_and_watched_files_survive_any_allocation_that_fails) {
    for (uint64_t k = 1, over = 0; !over; k++) {
        struct edits edits = {0};
        struct change change = {.kind = CHANGE_GONE}, target;
        uint64_t before = fault_count(FAULT_OF_ALLOCATION);
        int made = 0, undone = 0;
        fault_at(FAULT_OF_ALLOCATION, k);
        for (int i = 0; i < 100; i++, change.serial++)
            made += edits_make(&edits, &change, true, i % 3 == 0);
        for (int i = 0; i < 100; i++)
            undone += edits_undo(&edits, &target);
        for (int i = 0; i < 100; i++)
            undone -= edits_redo(&edits, &target);
        fault_at(FAULT_OF_ALLOCATION, 0);
        over = fault_count(FAULT_OF_ALLOCATION) - before < k;
        CHECK(made >= 99 && (!over || (made == 100 && undone == 0)));
        edits_destroy(&edits);
    }
    CHECK(chdir(test_folder()) == 0);
    test_write_text("a.lua", "x");
    CHECK(symlink("a.lua", "link.lua") == 0);
    for (uint64_t k = 1, over = 0; !over; k++) {
        struct watch watch = {0};
        struct error error;
        uint64_t before = fault_count(FAULT_OF_ALLOCATION);
        bool ok = watch_open(&watch, &error);
        CHECK(ok);
        fault_at(FAULT_OF_ALLOCATION, k);
        for (int i = 0; ok && i < 40; i++) {
            char name[32];
            (void)snprintf(name, sizeof name, "file%d.lua", i);
            ok = watch_add(&watch, name, NULL, 0);
        }
        ok = ok && watch_add(&watch, "link.lua", NULL, 0) && watch_add(&watch, "", NULL, 0);
        fault_at(FAULT_OF_ALLOCATION, 0);
        over = fault_count(FAULT_OF_ALLOCATION) - before < k;
        CHECK(ok == (bool)over);
        watch_close(&watch);
    }
}
#endif
