/* Solutions of radiosity that are kept in files. */
#include "tests/harness.h"

#include "base/error.h"
#include "base/mem.h"
#include "output/solution_file_internal.h"
#include "radiosity/radiosity.h"
#include "tests/stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char scene[] =
    "local s = gr.node('s')\n"
    "local function add(shape) s:add_child(shape) end\n"
    "local w = gr.material{kd = {.7, .7, .6}, two_sided = true}\n"
    "add(gr.rectangle{material = w, corner = {0, 0, 0}, along = {6, 0, 0}, up = {0, 0, -5}})\n"
    "add(gr.rectangle{material = w, corner = {0, 0, -5}, along = {6, 0, 0}, up = {0, 3, 0}})\n"
    "add(gr.box{material = gr.material{kd = {.8, .2, KD}}, min = {2, 0, -4}, max = {3, 1, -3}})\n"
    "add(gr.sphere{material = gr.material{kd = {.2, .4, .6}}, centre = {4, .5, -3}, radius = .5})\n"
    "gr.render{node = s, integrator = 'radiosity', radiosity_patches = 600, file = 'x.png', width = 64, height = 48,\n"
    "  eye = {EYE, 1.5, 2}, target = {3, 1, -4}, lights = {gr.light{position = {1, 2.5, -1}, colour = {1, 1, 1}}}}\n";

static void put_scene(const char *kd, const char *eye) {
    char text[2048], line[256];
    (void)snprintf(line, sizeof line, "KD, EYE = %s, %s\n", kd, eye);
    (void)snprintf(text, sizeof text, "%s%s", line, scene);
    test_write_text(test_path("scene.lua"), text);
}

/* The other picture is not solved: its file would differ in the light of another seed. */
TEST(a_solution_in_a_file_gives_the_bytes_of_one_that_is_computed_also_for_other_cameras) {
    put_scene(".1", "3");
    test_shell_errors("$gray -q scene.lua -o plain.png && $gray -q scene.lua -j 1 --radiosity-file auto && "
                      "cmp x.png plain.png && cp x.png.radiosity kept && "
                      "$gray -q scene.lua --radiosity-file x.png.radiosity --resume && cmp x.png plain.png && "
                      "rm x.png.radiosity && $gray -q scene.lua -j 3 --checkpoint auto && cmp x.png.radiosity kept",
                      0, NULL);
    put_scene(".1", "3.5");
    test_shell_errors(
        "$gray -q scene.lua -o plain.png && rm x.png && chmod 400 kept && "
        "$gray -q scene.lua --radiosity-file kept --resume && cmp x.png plain.png && cmp x.png.radiosity kept",
        0, NULL);
}

TEST(parts_of_a_picture_share_a_solution) {
    put_scene(".1", "3");
    test_shell_errors("$gray -q scene.lua -o plain.png && for i in 1 2 3; do "
                      "$gray -q scene.lua --shard $i/3 --radiosity-file auto || exit; done; "
                      "$gray merge -q x.png.*.part && cmp x.png plain.png",
                      0, NULL);
}

TEST(a_changed_scene_is_refused_with_resume_and_solved_again_without) {
    put_scene(".1", "3");
    test_shell_errors("$gray -q scene.lua --radiosity-file kept", 0, NULL);
    put_scene(".11", "3");
    test_shell_errors("$gray -q scene.lua -o plain.png && cp kept old && "
                      "if $gray -q scene.lua --radiosity-file kept --resume -o a.png; then exit 9; fi; cmp kept old",
                      0, "kept: cannot be resumed: the scene, an option of radiosity or gray has changed");
    test_shell_errors(
        "$gray -q scene.lua --radiosity-file kept -o a.png && cmp a.png plain.png && ! cmp -s kept old && "
        "$gray -q scene.lua --radiosity-file kept --resume -o a.png && cmp a.png plain.png",
        0, NULL);
    test_shell_errors(
        "if $gray -q scene.lua --radiosity-file kept --radiosity-patches 500 --resume -o a.png; then exit "
        "9; fi",
        0, "kept: cannot be resumed");
}

/* A file of an animation whose frames have one solution, and one of frames that move. */
TEST(an_animation_keeps_the_solution_of_its_first_frame) {
    static const char frames[] = "EYE = 3; gr.frames{count = 3, draw = function(t) KD = .1 + t * MOVES\n%s end}\n";
    char text[2048];
    (void)snprintf(text, sizeof text, frames, scene);
    memcpy(strstr(text, "gr.render{"), "return   {", strlen("return   {"));
    char *file = strstr(text, "file = 'x.png', ");
    memset(file, ' ', strlen("file = 'x.png', "));
    test_write_text(test_path("body.lua"), text);
    test_shell_errors("for moves in 0 .3; do (echo MOVES = $moves; cat body.lua) >scene.lua; "
                      "$gray -q scene.lua -o plain-%d.png && for again in 1 2; do "
                      "$gray -q scene.lua -o x-%d.png --radiosity-file kept || exit; "
                      "for i in 1 2 3; do cmp x-$i.png plain-$i.png || exit; done; done; done",
                      0, NULL);
}

static void check_kill(int moments) {
    char line[1024];
    put_scene(".1", "3");
    (void)snprintf(line, sizeof line,
                   "$gray -q scene.lua -o plain.png --radiosity-file whole && for i in $(seq %d); do rm -f x.png*; "
                   "m=$(echo \"$i * 0.4 / %d\" | bc -l); $gray -q scene.lua --checkpoint auto --checkpoint-every 0 "
                   "2>said.txt & p=$!; sleep $m; kill -KILL $p 2>kill.txt; wait $p 2>kill.txt; "
                   "! test -e x.png.radiosity || cmp x.png.radiosity whole || exit 3; "
                   "$gray -q scene.lua --checkpoint auto $(test -e x.png.checkpoint && echo --resume) && "
                   "cmp x.png plain.png && cmp x.png.radiosity whole || exit 4; done",
                   moments, moments);
    test_need_tools("bc");
    test_shell_errors(line, 0, NULL);
}

TEST(a_run_that_is_killed_while_it_solves_goes_on_to_the_same_bytes) {
    check_kill(5);
}

TEST_LONG(a_run_that_is_killed_at_any_of_200_moments_goes_on_to_the_same_bytes) {
    check_kill(200);
}

/* --- files that are no solutions --- */

static const struct digest depends = {3, 4};

static bool read_kept(const void *bytes, size_t size, struct error *error) {
    struct share out = {0};
    test_write_file(test_path("kept"), bytes, size);
    bool ok = solution_file_read(test_path("kept"), depends, 1 << 20, &out, error);
    share_destroy(&out);
    return ok;
}

TEST(damaged_cut_and_foreign_files_of_solutions_are_refused_with_one_line) {
    struct share bytes, out;
    struct error error = {0};
    size_t size;
    CHECK(share_create(&bytes, 300, &error));
    for (int i = 0; i < 300; i++)
        ((uint8_t *)bytes.block)[i] = (uint8_t)(7 * i);
    CHECK(solution_file_write(FILE_AT(test_path("kept")), depends, &bytes, &error));
    CHECK(solution_file_read(test_path("kept"), depends, 1 << 20, &out, &error) && out.size == 300 &&
          memcmp(out.block, bytes.block, 300) == 0);
    share_destroy(&out);
    CHECK(solution_file_read(test_path("kept"), (struct digest){3, 5}, 1 << 20, &out, &error) && !out.block);
    CHECK(!solution_file_read(test_path("kept"), depends, 200, &out, &error) && error.limit);
    char *file = test_read_file(test_path("kept"), &size);
    for (size_t cut = 0; cut < size; cut++)
        CHECK(!read_kept(file, cut, &error));
    CHECK(!read_kept(file, size + 1, &error)); /* the zero behind it */
    for (size_t i = 0; i < size; i++) {
        file[i] = (char)(file[i] ^ 1 << i % 8);
        bool other_scene = i >= 8 && i < 24;
        CHECK(read_kept(file, size, &error) == other_scene);
        CHECK(other_scene || !strchr(error.text, '\n'));
        file[i] = (char)(file[i] ^ 1 << i % 8);
    }
    CHECK(read_kept(file, size, &error));
    free(file);
    share_destroy(&bytes);
}

static void begin_ball(struct stage *s) {
    stage_begin(s, 1);
    (void)stage_sphere(s, s->root, stage_phong(s, colour_all(0.5), colour_all(0), 1));
    s->sky.colour = colour_all(1);
    CHECK(stage_build(s, s->root, ACCEL_AUTO));
}

/* Each byte of the head and of some patches, and random ones. */
TEST(bytes_that_are_no_solution_are_refused_or_harmless) {
    struct stage s;
    struct radiosity radiosity, again = {0};
    struct list bytes = {0};
    struct test_random random = {1};
    begin_ball(&s);
    const struct radiosity_input input = {.world = &s.world, .background = true, .limit = 100, .pool = s.pool};
    CHECK(radiosity_prepare(&radiosity, &input, &s.error) && radiosity_finish(&radiosity, 0.01, s.pool, &s.error));
    CHECK(radiosity_write(&radiosity, &bytes));
    CHECK(radiosity_read(&again, &input, &bytes, &s.error));
    CHECK(memcmp(again.sides, radiosity.sides, 2 * radiosity.patches.vertices.count * sizeof *again.sides) == 0);
    uint8_t *at = bytes.items;
    for (size_t i = 0; i < 4000; i++) {
        size_t offset = i < 400 ? i : (size_t)test_uniform(&random, 0, (double)bytes.count);
        const struct hit hit = {.point = {0, 0, 1}, .normal_geometric = {0, 0, 1}, .front = true};
        struct colour light;
        uint8_t before = at[offset];
        radiosity_destroy(&again);
        at[offset] = (uint8_t)test_uniform(&random, 0, 256);
        if (radiosity_read(&again, &input, &bytes, &s.error))
            (void)radiosity_light(&again, &hit, &light);
        else
            CHECK(strstr(s.error.text, "is damaged"));
        at[offset] = before;
    }
    for (size_t cut = 0; cut < 100; cut++) {
        const struct list less = {bytes.items, bytes.count - 1 - cut * (bytes.count / 100), bytes.count};
        radiosity_destroy(&again);
        CHECK(!radiosity_read(&again, &input, &less, &s.error));
    }
    radiosity_destroy(&again);
    radiosity_destroy(&radiosity);
    list_destroy(&bytes);
    stage_end(&s);
}
