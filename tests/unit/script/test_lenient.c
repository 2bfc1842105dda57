/* --lenient: every scene gives a picture (docs/language.md 12.5). tests/lenient has scenes that deviate in one way
 * each; make.py there writes them. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *in(const char *name) {
    static char path[1200];
    (void)snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    return path;
}

static bool is_there(const char *format, const char *name) {
    char file[300];
    (void)snprintf(file, sizeof file, format, name);
    return access(in(file), F_OK) == 0;
}

static int is_scene(const struct dirent *entry) {
    const char *dot = strrchr(entry->d_name, '.');
    return dot && (strcmp(dot, ".lua") == 0 || strcmp(dot, ".obj") == 0);
}

/* Scenes first to first + 49 of the folder in one run. */
static void render_some(struct dirent **names, int first, int count) {
    char arguments[4000] = "-q --lenient -j 1 -ss 1 --size 8x8";
    for (int k = first; k < count && k < first + 50; k++)
        if (strstr(names[k]->d_name, ".lua"))
            (void)snprintf(arguments + strlen(arguments), sizeof arguments - strlen(arguments), " %s",
                           names[k]->d_name);
    struct test_result result = test_gray(test_folder(), arguments);
    if (strstr(result.err, "crashed") || strstr(result.err, "runtime error"))
        test_fail(__FILE__, __LINE__, "%s", result.err);
    for (int k = first; k < count && k < first + 50; k++) {
        char name[100];
        (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(names[k]->d_name, "."), names[k]->d_name);
        if (strstr(names[k]->d_name, ".lua") && !is_there("%s.png", name) && !is_there("%s-lenient.png", name))
            test_fail(__FILE__, __LINE__, "%s gives no picture", names[k]->d_name);
    }
    test_free_result(&result);
}

TEST(every_scene_of_another_program_gives_a_picture_under_lenient) {
    struct dirent **names;
    int count = scandir("tests/lenient", &names, is_scene, alphasort), scenes = 0;
    for (int k = 0; k < count; k++) {
        char from[400];
        size_t size = 0;
        (void)snprintf(from, sizeof from, "tests/lenient/%.200s", names[k]->d_name);
        char *bytes = test_read_file(from, &size);
        test_write_file(in(names[k]->d_name), bytes, size);
        free(bytes);
        scenes += strstr(names[k]->d_name, ".lua") != NULL;
    }
    CHECK(scenes >= 200);
    for (int k = 0; k < count; k += 50)
        render_some(names, k, count);
    for (int k = 0; k < count; k++)
        free(names[k]);
    free(names);
}

static void says(const char *scene, const char *options, int status, const char *text) {
    struct test_result result = test_gray_scene(scene, options, NULL);
    if (result.status != status || !strstr(result.err, text))
        test_fail(__FILE__, __LINE__, "status %d, not %d; printed: %s; expected: %s", result.status, status, result.err,
                  text);
    test_free_result(&result);
}

#define BALL "local r = gr.node('r') r:add_child(gr.sphere('ball'))\n"

TEST(a_picture_appears_after_an_error_of_lua_and_replaces_none) {
    says(BALL "nothing.x = 1\n", "--lenient --size 8x8 scene.lua", 1, "scene.lua:2: attempt to index a nil value");
    CHECK(is_there("%s-lenient.png", "scene"));
    says(BALL "nothing.x = 1\n", "--lenient --size 8x8 scene.lua", 1, "scene-lenient.png: exists, and is not replaced");
    says(BALL "nothing.x = 1\n", "--lenient --size 8x8 -o own.png scene.lua", 1, "shows node 'r'");
    CHECK(is_there("%s.png", "own"));
    says(BALL "nothing.x = 1\n", "--lenient --size 8x8 -o own.png scene.lua", 1,
         "own.png: exists, and is not replaced");
    says("syntax error\n", "--lenient --size 8x8 -o none.png scene.lua", 1, "scene.lua:1: syntax error");
    says("nothing.x = 1\n", "--lenient --size 8x8 -o none.png scene.lua", 1, "attempt to index");
    CHECK(!is_there("%s.png", "none"));
}

TEST(an_error_says_that_lenient_would_get_over_it_where_it_would_and_the_scene_renders_by_positions) {
    static const char hint[] = "--lenient gets over this error";
    static const char by_positions[] =
        "\nfunction draw(n) gr.render(n, 'x.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {1, 1, 1}, {}) end";
    static const char by_fields[] = "\nfunction draw(n) gr.render{node = n} end";
    static const struct {
        const char *scene;
        bool is_forgivable;
    } rows[] = {
        {"gr.sphere{radius = -1}", true},
        {"gr.spheer('s')", true},
        {"gr.node('n'):bend()", true},
        {"gr.mesh('m', 'nowhere.obj')", true},
        {"require 'nowhere'", true},
        {"nothing.x = 1", false},
        {"x = = 1", false},
        {"error('gr.sphere: radius')", false},
        {"pcall(gr.sphere, 3) error('other')", false},
        {"gr.render(gr.node('n'), '../../x.png', 2, 2, {0, 0, 1}, {0, 0, -1}, {0, 1, 0}, 50, {1, 1, 1}, {})", false}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        for (int fields = 0; fields < 2; fields++) {
            char scene[400];
            (void)snprintf(scene, sizeof scene, "%s%s", rows[i].scene, fields ? by_fields : by_positions);
            struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
            CHECK_EQ_INT(result.status, 1);
            if ((strstr(result.err, hint) != NULL) != (rows[i].is_forgivable && !fields))
                test_fail(__FILE__, __LINE__, "%s: %s", scene, result.err);
            test_free_result(&result);
        }
    }
}

TEST(fractional_indices_and_a_view_of_zero_are_survived_with_one_warning_each) {
    struct test_result result = test_gray_scene(
        "for k = 1, 3 do local m = gr.mesh('m', {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0.5, 1.5, 2.5}})\n"
        "m:set_material(gr.material({1, 1, 1}, {0, 0, 0}, 1))\n"
        "gr.render(m, 'x' .. k .. '.png', 2, 2, {0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 50, {1, 1, 1}, {}) end\n",
        "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    const char *index = strstr(result.err, "fractions of indices are dropped"),
               *view = strstr(result.err, "view is zero");
    CHECK(index && !strstr(index + 1, "fractions of indices"));
    CHECK(view && !strstr(view + 1, "view is zero"));
    test_free_result(&result);
}

/* Also in a function that is recorded. */
TEST(functions_of_numbers_and_vectors_warn_under_lenient_and_take_0_for_what_they_refuse) {
    static const char scene[] = "assert(gr.noise(10.5, 10) == gr.noise(10.5, 10, 0))\n"
                                "assert(gr.turbulence(.1, .2, .3, 99) == 0 and gr.lookup({}, 1) == 0)\n"
                                "assert(gr.clamp(7, 2, nil) == 0 and select('#', gr.cells(1, 1)) == 3)\n"
                                "local f = gr.fn(function(p) return gr.noise(p.x, p.y) end)\n"
                                "assert(not pcall(gr.loop, 2, 1, function() error('mine') end))\n";
    struct test_result result = test_gray_scene(scene, "--lenient scene.lua", NULL);
    CHECK(strstr(result.err, "scene.lua:1: warning: gr.noise: argument 3: a number or a vector is needed: it is 0\n"));
    CHECK(strstr(result.err, "scene.lua:2: warning: gr.turbulence: argument 4: "));
    CHECK(strstr(result.err, "scene.lua:2: warning: gr.lookup: argument 1: table expected, got number: the result is"));
    CHECK(strstr(result.err, "scene.lua:4: warning: gr.noise: argument 3: "));
    CHECK(!strstr(result.err, "assertion failed"));
    free(result.out);
    free(result.err);
}

/* One scene that only deviates gives the bytes of the scene that it means. */
TEST(arguments_in_another_order_mean_the_same_under_lenient) {
    static const char *const pairs[][2] = {
        {"gr.nh_sphere('s', {1, 0, 0}, 0.5)", "gr.nh_sphere(0.5, {1, 0, 0}, 's')"},
        {"gr.nh_sphere('s', {1, 0, 0}, 0.5)", "gr.nh_sphere('s', 1, 0, 0, 0.5)"},
        {"gr.joint('s', {0, 10, 20}, {0, 30, 40}):add_child(gr.cube('c'))",
         "gr.joint('s', 0, 10, 20, 0, 30, 40):add_child(gr.cube('c'))"},
        {"gr.cube('c'):rotate('y', 30):scale(2, 2, 2)", "gr.cube('c'):rotate(30, 'y'):scale(2)"},
        {"gr.cube('c'):translate(1, 0, 0)", "gr.cube('c'):translate({1}):set_glow(3)"},
        {"gr.node('n')", "gr.nh_sphere('s', {0, 0, 0}, -1)"},
        {"gr.sphere(gr.material({1, 0, 0}))", "gr.sphere('s', gr.material({1, 0, 0}))"},
        {"gr.node('n'):add_child(gr.cube('c'))", "gr.unknown('n', 3, {gr.cube('c')}):spin(3)"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        size_t sizes[2] = {0, 0};
        char *bytes[2];
        for (int k = 0; k < 2; k++) {
            char scene[600];
            (void)snprintf(
                scene, sizeof scene,
                "gr.render(gr.node('r'):add_child(%s), 'x.png', 16, 16, {1, 2, 5}, {0, -0.3, -1}, {0, 1, 0}, "
                "50, {0.2, 0.2, 0.2}, {gr.light({3, 5, 8}, {1, 1, 1}, {1, 0, 0})})",
                pairs[i][k]);
            struct test_result result = test_gray_scene(scene, "-q --lenient scene.lua", NULL);
            CHECK_EQ_INT(result.status, 0);
            test_free_result(&result);
            bytes[k] = test_read_file(in("x.png"), &sizes[k]);
        }
        if (!bytes[0] || !bytes[1] || sizes[0] != sizes[1] || memcmp(bytes[0], bytes[1], sizes[0]) != 0)
            test_fail(__FILE__, __LINE__, "%s differs", pairs[i][1]);
        free(bytes[0]);
        free(bytes[1]);
    }
}

TEST(fields_of_other_names_are_taken_by_their_type_under_lenient) {
    static const char *const calls[] = {"gr.render{node = ball, file = 'x.png', lights = {lamp}",
                                        "gr.render{world = ball, filename = 'x.png', lamps = {lamp}"};
    size_t sizes[2] = {0, 0};
    char *bytes[2];
    for (int k = 0; k < 2; k++) {
        char scene[600];
        (void)snprintf(scene, sizeof scene,
                       "local ball = gr.sphere{material = gr.material{kd = {1, 0, 0}}}\n"
                       "local lamp = gr.light({3, 5, 8}, {1, 1, 1}, {1, 0, 0})\n"
                       "%s, width = 8, height = 8, eye = {0, 0, 5}}",
                       calls[k]);
        struct test_result result = test_gray_scene(scene, "-q --lenient scene.lua", NULL);
        CHECK_EQ_INT(result.status, 0);
        test_free_result(&result);
        bytes[k] = test_read_file(in("x.png"), &sizes[k]);
        CHECK(bytes[k] && remove(in("x.png")) == 0);
    }
    CHECK(bytes[0] && bytes[1] && sizes[0] == sizes[1] && memcmp(bytes[0], bytes[1], sizes[0]) == 0);
    free(bytes[0]);
    free(bytes[1]);
}

TEST(lenient_reports_frames_that_an_animation_does_not_have_once) {
    static const char scene[] = "local s = gr.sphere('s')\n"
                                "gr.frames{count=3, draw=function() gr.render{node=s, file='x.png'} end}\n";
    struct test_result result = test_gray_scene(scene, "--lenient --frames 7-9 --size 8x8 scene.lua", NULL);
    const char *warning = strstr(result.err, "--frames selects frame 9, but the last frame is 3");
    CHECK(warning && !strstr(warning + 1, "--frames selects"));
    test_free_result(&result);
}
