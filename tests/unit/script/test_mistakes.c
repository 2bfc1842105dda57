/* Typical mistakes of the first days: other programs' words, values of a wrong type, files that are no scenes, names of
 * nothing. What a message must contain is in a table here; a larger one lies beside the checkout in some places. */
#include "tests/harness.h"

#include "base/arena.h"
#include "base/document.h"
#include "script/document.h"
#include "settings/foreign_words.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* After `local red, scene`; the first line of the answer starts with the place, and has all the words. */
static const struct {
    const char *text, *words[3];
} mistakes[] = {
    /* Fields. */
    {"gr.sphere{color = {1, 0, 0}}", {"'color'", "use material = gr.material{kd = "}},
    {"gr.material{diffuseColour = {1, 0, 0}}", {"'diffuseColour'", "did you mean 'kd'?"}},
    {"gr.sphere{material = red, translate = {1, 0, 0}}", {"'translate'", "use n:translate(x, y, z)"}},
    {"gr.light{position = {0, 9, 0}, colour = {1, 1, 1}, energy = 3}", {"'energy'", "'intensity'"}},
    {"gr.cylinder{material = red, height = 2}", {"'height'", "'from' and 'to'"}},
    {"gr.render{node = scene, lookAt = {0, 0, 0}}", {"'lookAt'", "did you mean 'target'?"}},
    {"gr.render{node = scene, qqqqq = 1}", {"'qqqqq'", "the nearest fields are "}},
    {"gr.frames{frames = 3}", {"'frames'", "'count'"}},
    /* Functions and methods. */
    {"gr.pointLight({0, 1, 0})", {"gr.pointLight does not exist", "use gr.light{"}},
    {"gr.linear_extrude()", {"use gr.prism"}},
    {"scene:rotateX(30)", {"node:rotateX does not exist", "use node:rotate('y', degrees)"}},
    {"scene:append(gr.cube(red))", {"use node:add_child(n)"}},
    /* Wrong types. */
    {"gr.sphere{material = 'red'}", {"material must be a material, not a string", "gr.material{kd = "}},
    {"gr.material{kd = 'wood.png'}", {"kd must be", "gr.texture('wood.png')"}},
    {"gr.material{kd = 'red'}", {"kd must be", "{1, 0, 0} or '#ff0000'"}},
    {"gr.uniform_fog{density = 1, colour = 0.5}", {"colour must be", "white is {1, 1, 1}"}},
    {"gr.render{node = scene, file = 'a.png', width = 4, height = 4, eye = {0, 0, 5}, fog = {1, 1, 1}}",
     {"fog must be", "gr.uniform_fog{"}},
    {"scene:add_child({gr.cube(red), gr.cube(red)})", {"not a table", "gr.node{children = {...}}"}},
    {"scene:add_child(gr.light({0, 5, 0}, {1, 1, 1}))", {"not a light", "the field lights of gr.render"}},
    {"scene:add_child({{0, 0, 0}})", {"not a table", "gr.mesh(material, verts, faces)"}},
    /* Calls of no form. */
    {"gr:cube(red)", {"called with a dot, as in gr.cube(...), not gr:cube(...)"}},
    {"gr.sphere{red, radius = 2}", {"all fields need names", "gr.sphere{material = ..., "}},
    {"gr.sphere({1, 0, 0}, 2)", {"not a table", "centre = ..., radius = ..."}},
    {"gr.cube(red):scale(2)", {"y is missing", "node:scale(x, y, z)"}},
    {"gr.vec(gr.vec(1, 2, 3), 4)", {"gr.vec takes three numbers or one vector"}},
    /* Names of nothing. */
    {"gr.node{name = 'n', children = {gr.cube(red), missing}}", {"children[2] is nil", "'missing' is nil"}},
    {"scene:add_child(gr.union{gr.cube(red), gr.sphere(red), missing})", {"operands[3] is nil", "'missing' is nil"}},
    {"gr.node{gr.cube(red)}", {"name must be a string", "gr.node{children = {...}}"}},
    {"gr.mesh(red, '~/bunny.obj')", {"'~/bunny.obj'", "'~' is not expanded"}},
    {"gr.frames{count = 2, draw = function(t) gr.render{node = scene, width = 4, height = 4, eye = {0, 0, 5}} end}",
     {"draw returns the table of fields"}},
};

TEST(a_mistake_is_answered_with_what_to_write) {
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        char text[1024];
        (void)snprintf(text, sizeof text, "local red, scene = gr.material{kd = {1, 0, 0}}, gr.node('scene')\n%s\n",
                       mistakes[i].text);
        struct test_result result = test_gray_scene(text, "scene.lua", NULL);
        result.err[strcspn(result.err, "\n")] = '\0';
        bool said = result.status == 1 && strncmp(result.err, "scene.lua:2: ", 13) == 0;
        for (int k = 0; k < 3 && mistakes[i].words[k]; k++)
            said = said && strstr(result.err, mistakes[i].words[k]);
        if (!said)
            test_fail(__FILE__, __LINE__, "%s: status %d: %s", mistakes[i].text, result.status, result.err);
        test_free_result(&result);
    }
}

#define BEGIN "local red, scene = gr.material{kd = {1, 0, 0}}, gr.node{name = 'scene', children = {}}\n"
#define PICTURE "gr.render{node = scene, file = 'a.png', width = 4, height = 4, eye = {x = 0, y = 0, z = 8}}\n"

static void warns(const char *text, const char *words) {
    struct test_result result = test_gray_scene(text, "scene.lua", NULL);
    if (result.status != 0 || (words ? !strstr(result.err, words) : strstr(result.err, "warning") != NULL))
        test_fail(__FILE__, __LINE__, "%s: status %d: %s", text, result.status, result.err);
    test_free_result(&result);
}

TEST(names_of_coordinates_and_of_arguments_are_taken) {
    warns(BEGIN
          "scene:add_child(gr.cube(red):translate{x = 1, y = 0, z = 0}:scale{1, 2, 3}:rotate{axis = 'y', angle = 9})\n"
          "scene:add_child(gr.cube(gr.material{kd = {r = 1, g = 0, b = 0}}))\n" PICTURE,
          NULL);
    struct test_result result = test_gray_scene(BEGIN "scene:translate{x = 1, z = 0}", "scene.lua", NULL);
    CHECK(result.status == 1 && strstr(result.err, "y is missing"));
    test_free_result(&result);
}

TEST(a_value_that_is_probably_not_meant_is_a_warning) {
    warns(BEGIN "scene:add_child(gr.sphere{material = red, radius = big})\n" PICTURE,
          "scene.lua:2: warning: gr.sphere: radius is nil and has its default; 'big' is nil");
    warns(BEGIN "local options = {}\nscene:add_child(gr.sphere{material = red, radius = options.radius})\n" PICTURE,
          NULL);
    warns(BEGIN "scene:add_child(gr.sphere(2))\n" PICTURE,
          "scene.lua:2: warning: gr.sphere: 2 is the name of the node");
    warns(BEGIN "gr.material({1, 0, 0}, {0, 0, 0}, 10, 0.5)\n" PICTURE,
          "arguments after shininess are ignored; with names: ");
    warns(BEGIN "gr.render{node = scene, file = 'a.png', width = 4, height = 4, eye = {0, 8, 0}, view = {0, -1, 0}}\n",
          "warning: scene.lua:2: gr.render: up is parallel to view");
}

TEST(files_that_are_no_scenes_and_scenes_that_are_not_there_are_named) {
    test_write_text(test_path("ball.lua"), "gr.sphere{}");
    test_write_text(test_path("m.stl"), "solid x\n");
    test_write_text(test_path("a.scad"), "cube([1, 2, 3]);\n");
    test_shell("printf '\\211PNG' >p; $gray p", 1, "p: is a picture, not a scene");
    test_shell("$gray m.stl", 1, "m.stl: no triangles in this STL text");
    test_shell("$gray a.scad", 1, "a.scad: is a file of another program");
    test_shell("cp ball.lua script.txt; $gray script.txt", 0, "no picture was rendered");
    test_shell("$gray bal.lua", 1, "did you mean 'ball.lua'?");
    test_shell("$gray ball", 1, "did you mean 'ball.lua'?");
    test_shell("$gray help", 1, "gray --help lists the options");
    test_shell("$gray ball.lua x.png", 1, "-o FILE names the picture to write");
}

static void model_says(const char *name, const char *content, const char *words) {
    char scene[256];
    (void)snprintf(scene, sizeof scene, "gr.mesh(gr.material{kd = {1, 1, 1}}, '%s')", name);
    test_write_text(test_path(name), content);
    struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
    CHECK(result.status == 1);
    if (!strstr(result.err, words))
        test_fail(__FILE__, __LINE__, "%s: %s", name, result.err);
    test_free_result(&result);
}

TEST(a_file_that_is_no_model_is_named) {
    model_says("m.fbx", "Kaydara FBX Binary  x",
               "m.fbx: no faces in this file; gray reads OBJ, PLY, STL and glTF files");
    model_says("m.stl", "<!DOCTYPE html><html>404</html>", "m.stl: is a web page (HTML), not a model");
    model_says("m.obj", "version https://git-lfs.github.com/spec/v1\n", "m.obj: is a pointer of Git LFS");
    model_says("e.obj", "v 0 0 0\n", "e.obj: no faces in this file\n");
}

TEST(foreign_words_are_found_in_every_spelling_and_only_where_they_fit) {
    CHECK(strstr(foreign_option("num_threads", 11), "-j N"));
    CHECK(strstr(foreign_option("samples", 7), "--spp"));
    CHECK(!foreign_option("", 0) && !foreign_option("zebra", 5));
    CHECK(strstr(foreign_function("PointLight"), "gr.light"));
    CHECK(strstr(foreign_method("setColour"), "set_material") && strstr(foreign_method("set_color"), "set_material"));
    CHECK(!foreign_method("a_name_that_is_much_longer_than_any_word_of_the_table"));
}

/* Each NAME after `before` in a text has to be in the manual, with a bracket after it. */
static void check_names(const char *use, const char *before, const char *manual) {
    for (const char *at = use; (at = strstr(at, before)) != NULL; at += strlen(before)) {
        char name[64];
        size_t length = strspn(at + strlen(before), "abcdefghijklmnopqrstuvwxyz_");
        (void)snprintf(name, sizeof name, "%s%.*s(", before, (int)length, at + strlen(before));
        if (!strstr(manual, name))
            test_fail(__FILE__, __LINE__, "'%s': the manual has no %s", use, name);
    }
}

TEST(what_foreign_words_lead_to_exists) {
    struct arena arena = {0};
    struct document document = {.arena = &arena};
    script_describe_function(&document, NULL);
    const char *manual = document.text;
    CHECK(!document.failed && manual);
    for (const char *const *row = foreign_words_txt; manual && *row; row += FOREIGN_COLUMNS) {
        check_names(row[FOREIGN_USE], "gr.", manual);
        check_names(row[FOREIGN_USE], "node:", manual);
    }
    arena_destroy(&arena);
}

/* A case that fails; not because of a library that this build lacks. */
static void check_line(const char *line) {
    char text[2000];
    (void)snprintf(text, sizeof text, "%.*s", (int)strcspn(line, "\n"), line);
    if (!strstr(text, "this build cannot read"))
        test_fail(__FILE__, __LINE__, "%s", text);
}

/* The larger table: each line before the last one is a case that fails. */
TEST(the_mistakes_beside_the_checkout_are_answered) {
    char script[4096], command[4200];
    if (!realpath("../shared/cases/mistakes/check.py", script))
        test_skip("../shared/cases/mistakes is not there");
    (void)snprintf(command, sizeof command, "python3 '%s' $gray; true", script);
    test_shell(command, 0, " of ");
    char *output = test_read_file(test_path("out.txt"), NULL), *line = output;
    for (; line && strncmp(line, "FAIL ", 5) == 0; line = strchr(line, '\n') + 1)
        check_line(line);
    free(output);
}
