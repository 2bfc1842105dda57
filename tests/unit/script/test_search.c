/* Files that are not where a scene names them (docs/language.md 12.3), and what the search must not do. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char triangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

static const char *in(const char *name) {
    static char path[1200];
    (void)snprintf(path, sizeof path, "%s/%s", test_folder(), name);
    return path;
}

static void folder(const char *name) {
    CHECK(mkdir(in(name), 0777) == 0);
}

static void file(const char *name, const char *text) {
    test_write_file(in(name), text, strlen(text));
}

#define PICTURE(root) "gr.render{node = " root ", file = 't.png', width = 2, height = 2, eye = {0, 0, 5}}\n"

/* Runs s/scene.lua below the folder w. */
static struct test_result run(const char *scene, const char *options) {
    char text[200];
    file("w/s/scene.lua", scene);
    (void)snprintf(text, sizeof text, "%s s/scene.lua", options);
    return test_gray(in("w"), text);
}

static void says(const char *scene, const char *options, int status, const char *line) {
    struct test_result result = run(scene, options);
    if (result.status != status || !strstr(result.err, line))
        test_fail(__FILE__, __LINE__, "status %d, not %d; printed: %s; expected: %s", result.status, status, result.err,
                  line);
    test_free_result(&result);
}

static void begin(void) {
    folder("w");
    folder("w/s");
}

#define WITH_PICTURE(name)                                                                                             \
    "local m = gr.material{kd = gr.texture{file = '" name "'}}\n"                                                      \
    "gr.render{node = gr.sphere('s'):set_material(m), file = 't.png', width = 2, height = 2, eye = {0, 0, 5}, "        \
    "ambient = {1, 1, 1}}\n"

/* Their folder stands beside lua/, or below share/gray where gray is installed. */
TEST(pictures_that_come_with_gray_are_found_last_and_from_any_folder) {
    begin();
    struct test_result result = run(WITH_PICTURE("painting.png"), "");
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    test_free_result(&result);
    says(WITH_PICTURE("no.png"), "", 1, "cannot find 'no.png'");
    says(WITH_PICTURE("../../lua/painting.png"), "", 1, "lies outside the folders that scenes may read");
    folder("w/s/more");
    file("w/s/more/painting.png", "of the scene");
    says(WITH_PICTURE("painting.png"), "", 1, "'painting.png' was found as 's/more/painting.png'");
}

TEST(a_mesh_is_found_below_the_scene_and_above_it_with_one_notice) {
    begin();
    folder("w/s/Assets");
    folder("w/s/Assets/Obj");
    file("w/s/Assets/Obj/plane.obj", triangle);
    struct test_result result =
        run("local n = gr.mesh('a', 'plane.obj') n:add_child(gr.mesh('b', 'plane.obj'))\n" PICTURE("n"), "");
    CHECK_EQ_INT(result.status, 0);
    const char *notice = strstr(result.err, "s/scene.lua:1: 'plane.obj' was found as 's/Assets/Obj/plane.obj'");
    CHECK(notice && !strstr(notice + 40, "was found as"));
    test_free_result(&result);
    folder("w/meshes");
    file("w/meshes/cow.obj", triangle);
    says("local n = gr.mesh('a', '/u/cs488/data/cow.obj')\n" PICTURE("n"), "", 0, "was found as 's/../meshes/cow.obj'");
    says("local n = gr.mesh('a', 'data\\\\cow.obj')\n" PICTURE("n"), "", 0, "was found as 's/../meshes/cow.obj'");
}

TEST(the_case_of_a_name_counts_only_if_a_file_has_it) {
    begin();
    folder("w/s/Assets");
    file("w/s/Assets/Cow.obj", triangle);
    says("local n = gr.mesh('a', 'cow.OBJ')\n" PICTURE("n"), "", 0, "'cow.OBJ' was found as 's/Assets/Cow.obj'");
    says("local n = gr.mesh('a', 'assets\\\\COW')\n" PICTURE("n"), "", 0, "was found as 's/Assets/Cow.obj'");
    folder("w/far");
    file("w/far/cow.OBJ", triangle);
    says("local n = gr.mesh('a', 'cow.OBJ')\n" PICTURE("n"), "", 0, "'cow.OBJ' was found as 's/../far/cow.OBJ'");
}

TEST(fractions_of_sizes_by_position_are_dropped_with_a_warning) {
    begin();
    says("gr.render(gr.sphere('s'), 't.png', 33 / 2, 7 / 2, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {1, 1, 1}, {})", "",
         0, "gr.render: width is 16.5: fractions of pixels are dropped");
    says("gr.render{node = gr.sphere('s'), file = 't.png', width = 33 / 2, height = 3}", "", 1,
         "width must be a whole number");
}

/* A picture of one texel. */
static void dot(const char *name) {
    static const char text[] = "PF\n1 1\n-1.0\n\0\0\0\0\0\0\0\0\0\0\0";
    test_write_file(in(name), text, sizeof text);
}

TEST(materials_and_pictures_that_mesh_files_name_are_found_too) {
    begin();
    folder("w/s/tex");
    folder("w/s/mats");
    folder("w/art");
    file("w/s/m.obj", "mtllib paint.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3\n");
    file("w/s/mats/paint.mtl", "newmtl a\nmap_Kd C:\\art\\wood.pfm\nmap_Ks ../../../secret.pfm\nmap_d none.pfm\n");
    dot("w/s/tex/wood.pfm");
    dot("w/s/tex/secret.pfm"); /* not looked for */
    struct test_result result = run("local n = gr.mesh('a', 'm.obj')\n" PICTURE("n"), "");
    CHECK_EQ_INT(result.status, 0);
    static const char *const lines[] = {
        "s/scene.lua:1: 'paint.mtl' was found as 's/mats/paint.mtl'",
        "s/scene.lua:1: 'C:/art/wood.pfm' was found as 's/tex/wood.pfm'",
        "the picture '../../../secret.pfm' lies outside the folders that scenes may read (--allow-read DIR adds one)",
        "the picture 'none.pfm' is not there"};
    for (int i = 0; i < 4; i++)
        if (!strstr(result.err, lines[i]))
            test_fail(__FILE__, __LINE__, "%s is not in %s", lines[i], result.err);
    test_free_result(&result);
#ifdef HAVE_JANSSON
    file("w/s/m.gltf",
         "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0}]}],"
         "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}}],"
         "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"maps/leaf.pfm\"}],"
         "\"buffers\":[{\"uri\":\"numbers.bin\",\"byteLength\":36}],"
         "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
         "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
         "\"min\":[0,0,0],\"max\":[1,1,0]}]}");
    const float numbers[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    test_write_file(in("w/s/tex/numbers.bin"), numbers, sizeof numbers);
    dot("w/art/leaf.pfm");
    says("local n = gr.mesh('a', 'm.gltf')\n" PICTURE("n"), "", 0, "'numbers.bin' was found as 's/tex/numbers.bin'");
    says("local n = gr.mesh('a', 'm.gltf')\n" PICTURE("n"), "", 0, "'maps/leaf.pfm' was found as 's/../art/leaf.pfm'");
#endif
}

TEST(of_a_folder_with_too_many_files_the_first_in_byte_order_are_searched) {
    begin();
    folder("w/s/many");
    file("w/s/many/zzz.obj", triangle);
    for (int i = 10100; i > 0; i--) {
        char name[64];
        (void)snprintf(name, sizeof name, "w/s/many/f%05d.txt", i);
        file(name, "");
    }
    file("w/s/many/aaa.obj", triangle);
    says("local n = gr.mesh('a', 'aaa.obj')\n" PICTURE("n"), "", 0, "'aaa.obj' was found as 's/many/aaa.obj'");
    says("local n = gr.mesh('a', 'zzz.obj')\n" PICTURE("n"), "", 1, "cannot find 'zzz.obj'");
}

TEST(modules_and_pictures_are_found_by_name_too) {
    begin();
    folder("w/s/lib");
    folder("w/s/lib/shapes");
    file("w/s/lib/shapes/ball.lua", "return {make = function() return gr.sphere('ball') end}");
    says("local n = require('shapes.ball').make()\n" PICTURE("n"), "", 0, "was found as 's/lib/shapes/ball.lua'");
    says("local n = require 'ball' .make()\n" PICTURE("n"), "", 0, "was found as 's/lib/shapes/ball.lua'");
    says("require 'shapes.bal'", "", 1, "cannot find module 'shapes.bal' (no such file on package.path)");
    says("require 'bsll'", "", 1, "did you mean 'ball'?");
    says("require 'meshs'", "", 1, "did you mean 'meshes'?");
    says("gr.texture('brik.png')", "", 1, "cannot find 'brik.png'");
    file("w/s/lib/brick.png", "no picture");
    says("gr.texture('brik.png')", "", 1, "; did you mean 'brick.png'?");
    says("gr.texture('tex/brick.png')", "", 1, "s/lib/brick.png: ");
}

TEST(the_longest_end_wins_then_the_nearest_then_byte_order) {
    static const char *const folders[] = {"w/s/a", "w/s/b", "w/s/b/Obj", "w/s/b/Obj/deep", "w/Obj"};
    static const struct {
        const char *file, *found;
    } steps[] = {
        {"w/Obj/x.obj", "s/../Obj/x.obj"},
        {"w/s/b/Obj/deep/x.obj", "s/../Obj/x.obj"}, /* two parts beat one */
        {"w/s/b/Obj/x.obj", "s/b/Obj/x.obj"},
    };
    begin();
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++)
        folder(folders[i]);
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        file(steps[i].file, triangle);
        char line[200];
        (void)snprintf(line, sizeof line, "was found as '%s'", steps[i].found);
        says("local n = gr.mesh('a', 'm/Obj/x.obj')\n" PICTURE("n"), "", 0, line);
    }
    says("local n = gr.mesh('a', 'elsewhere/x.obj')\n" PICTURE("n"), "", 0, "was found as 's/b/Obj/x.obj'");
    file("w/s/b/x.obj", triangle);
    says("local n = gr.mesh('a', 'elsewhere/x.obj')\n" PICTURE("n"), "", 0, "was found as 's/b/x.obj'");
    file("w/s/a/x.obj", triangle);
    says("local n = gr.mesh('a', 'elsewhere/x.obj')\n" PICTURE("n"), "", 0, "was found as 's/a/x.obj'");
}

TEST(the_search_ends_four_levels_down_and_passes_hidden_folders) {
    begin();
    folder("w/s/1"), folder("w/s/1/2"), folder("w/s/1/2/3"), folder("w/s/1/2/3/4"), folder("w/s/1/2/3/4/5");
    folder("w/s/.hidden");
    file("w/s/1/2/3/4/four.obj", triangle);
    file("w/s/1/2/3/4/5/five.obj", triangle);
    file("w/s/.hidden/secret.obj", triangle);
    file("w/s/1/.secret.obj", triangle);
    says("local n = gr.mesh('a', 'four.obj')\n" PICTURE("n"), "", 0, "was found as 's/1/2/3/4/four.obj'");
    says("gr.mesh('a', 'five.obj')", "", 1, "cannot find 'five.obj'");
    says("gr.mesh('a', 'secret.obj')", "", 1, "cannot find 'secret.obj'");
    says("gr.mesh('a', 'x/.secret.obj')", "", 1, "lies outside the folders");
}

TEST(names_that_lead_out_are_refused_alike_with_and_without_a_file_there) {
    static const char *const names[] = {"../../out/%s.obj", "link/%s.obj", "none/../../../out/%s.obj", "%s_link.obj"};
    begin();
    folder("out");
    file("out/there.obj", triangle);
    folder("w/s/sub");
    file("w/s/x.obj", triangle);
    CHECK(symlink("../../out", in("w/s/link")) == 0 && symlink("../../out/there.obj", in("w/s/there_link.obj")) == 0);
    CHECK(symlink("../../out/gone.obj", in("w/s/gone_link.obj")) == 0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char name[100], scene[200], here[200], there[2][400];
        for (int k = 0; k < 2; k++) {
            const char *word = k ? "there" : "gone";
            (void)snprintf(name, sizeof name, names[i], word);
            (void)snprintf(scene, sizeof scene, "gr.mesh('a', '%s')", name);
            /* A file of that name inside does not help. */
            (void)snprintf(here, sizeof here, "w/s/sub/%s.obj", word);
            file(here, triangle);
            struct test_result result = run(scene, "");
            CHECK_EQ_INT(result.status, 1);
            char *at = strstr(result.err, name);
            CHECK(at && strstr(at, "lies outside the folders that scenes may read"));
            (void)snprintf(there[k], sizeof there[k], "%.300s", at ? at + strlen(name) : "");
            test_free_result(&result);
            CHECK(unlink(in(here)) == 0);
        }
        CHECK_TEXT(there[0], there[1]);
    }
    /* A found file that is a link to the outside is passed. */
    folder("w/s/d");
    CHECK(symlink("../../../out/there.obj", in("w/s/d/y.obj")) == 0);
    says("gr.mesh('a', 'y.obj')", "", 1, "cannot find 'y.obj'");
}

TEST(link_loops_pipes_and_closed_folders_do_not_stop_the_search) {
    begin();
    folder("w/s/a"), folder("w/s/b"), folder("w/s/closed"), folder("w/s/z");
    CHECK(symlink(".", in("w/s/a/self")) == 0 && symlink("../b", in("w/s/a/b")) == 0);
    CHECK(symlink("../a", in("w/s/b/a")) == 0 && symlink("x.obj", in("w/s/b/x.obj")) == 0);
    CHECK(mkfifo(in("w/s/a/x.obj"), 0666) == 0 && mkdir(in("w/s/closed/x.obj"), 0777) == 0);
    CHECK(chmod(in("w/s/closed"), 0) == 0);
    file("w/s/z/x.obj", triangle);
    says("local n = gr.mesh('a', 'm/x.obj')\n" PICTURE("n"), "", 0, "was found as 's/z/x.obj'");
    CHECK(unlink(in("w/s/z/x.obj")) == 0);
    says("gr.mesh('a', 'm/x.obj')", "", 1, "cannot find 'm/x.obj'");
    CHECK(chmod(in("w/s/closed"), 0777) == 0);
}

/* The search gives up after 10,000 entries, whichever they are. */
TEST_TIMES(a_folder_of_many_entries_costs_no_more_than_its_share, 4) {
    begin();
    folder("w/s/many"), folder("w/s/many/sub");
    for (int i = 0; i < 25000 * times; i++) {
        char name[100];
        (void)snprintf(name, sizeof name, "w/s/many/%06d.obj", i);
        CHECK(symlink("seed", in(name)) == 0);
    }
    file("w/s/near.obj", triangle);
    says("gr.mesh('a', 'nowhere.obj')", "--script-memory 16 --script-time 20", 1, "cannot find 'nowhere.obj'");
    says("local n = gr.mesh('a', 'x/near.obj')\n" PICTURE("n"), "--script-memory 16", 0, "");
}
