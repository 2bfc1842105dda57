/* Scenes in JSON (docs/json.md): read as written by hand, and written by gray with the bytes of their scripts. */
#include "tests/harness.h"


#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SPHERE "{\"type\": \"sphere\"}"
#define NODES(nodes) "{\"gray\": 1, \"nodes\": [" nodes "]}"

TEST(a_scene_in_json_is_the_picture_of_the_script_with_its_calls) {
    test_need_json();
    test_write_text(
        test_path("a.json"),
        "\xef\xbb\xbf{\"gray\": 1, \"define\": {\"red\": {\"type\": \"material\", \"kd\": [0.8, 0.2, 0.1]}},\n"
        "\"nodes\": [{\"type\": \"sphere\", \"material\": {\"ref\": \"red\"}, \"radius\": 1.5, \"transform\":\n"
        " [{\"scale\": [1, 0.5, 1]}, {\"rotate\": [\"z\", 30]}, {\"translate\": {\"x\": 1, \"y\": 0, \"z\": 0}}],\n"
        " \"children\": [{\"type\": \"cube\", \"transform\": [{\"rotate_axis\": [[1, 1, 0], 20]}]}]}, {\"ref\": "
        "\"box\"},\n"
        " {\"type\": \"plane\", \"normal\": [0, 1, 0], \"distance\": -2}],\n"
        "\"picture\": {\"width\": 48, \"height\": 36, \"eye\": [0, 2, 8], \"view\": [0, -0.2, -1],\n"
        " \"lights\": [{\"type\": \"light\", \"position\": {\"x\": 3, \"y\": 5, \"z\": 8}, \"colour\": [0.9, 0.9, "
        "0.9]}]}}\n");
    char *text = test_read_file(test_path("a.json"), NULL);
    char *define = strstr(text, "\"define\": {");
    FILE *file = fopen(test_path("a.json"), "w");
    (void)fprintf(file, "%.*s\"box\": {\"type\": \"cube\", \"material\": {\"ref\": \"red\"}}, %s",
                  (int)(define + 11 - text), text, define + 11);
    (void)fclose(file);
    free(text);
    test_write_text(
        test_path("a.lua"),
        "local red = gr.material{kd = {0.8, 0.2, 0.1}}\n"
        "local ball = gr.sphere{material = red, radius = 1.5}:scale(1, 0.5, 1):rotate('z', 30):translate(1, 0, 0)\n"
        "ball:add_child(gr.cube{}:rotate_axis({1, 1, 0}, 20))\n"
        "gr.render{file = 'b.png', node = gr.node{children = {ball, gr.cube{material = red},\n"
        "  gr.plane{normal = {0, 1, 0}, distance = -2}}}, width = 48, height = 36, eye = {0, 2, 8},\n"
        "  view = {0, -0.2, -1}, lights = {gr.light({3, 5, 8}, {0.9, 0.9, 0.9})}}\n");
    test_shell("$gray -q a.json && $gray -q a.lua && cmp a.png b.png", 0, "");
}

TEST(a_mistake_in_json_is_one_line_with_its_position_and_a_suggestion) {
    static const char *const cases[][2] = {
        {NODES(SPHERE ", {\"type\": \"sphere\", \"material\": {\"type\": \"material\", \"kd\": [1, 2, \"x\"]}}"),
         "x.json: nodes[1].material.kd[2]: gr.material: kd[2] must be a number, not a string\n"},
        {NODES("{\"type\": \"sphere\", \"radus\": 2}"),
         "x.json: nodes[0].radus: gr.sphere: unknown field 'radus'; did you mean 'radius'?\n"},
        {NODES("{\"type\": \"spere\"}"), "x.json: nodes[0]: the type 'spere' does not exist; did you mean 'sphere'?\n"},
        {NODES("{\"type\": \"sphere\", \"transform\": [{\"rotat\": [\"y\", 2]}]}"),
         "x.json: nodes[0].transform[0].rotat: the method 'rotat' does not exist; did you mean 'rotate'?\n"},
        {NODES("{\"type\": \"sphere\", \"transform\": [{\"rotate\": {\"axis\": \"y\"}}]}"),
         "x.json: nodes[0].transform[0].rotate.angle: node:rotate: angle is missing (node 'sphere')\n"},
        {NODES("{\"type\": \"sphere\", \"transform\": [{\"rotate\": [\"y\", 2, 3]}]}"),
         "x.json: nodes[0].transform[0].rotate: node:rotate: there are arguments after angle (node 'sphere')\n"},
        {NODES("{\"type\": \"sphere\", \"transform\": {\"rotate\": [\"y\", 2]}}"),
         "x.json: nodes[0].transform: it must be a list such as [{\"translate\": [1, 0, 0]}]\n"},
        {NODES("{\"type\": \"mesh\", \"verts\": [[0, 0, 0], [1, 0]], \"faces\": []}"),
         "x.json: nodes[0].verts[1]: gr.mesh: verts[1] must have 3 numbers, not 2\n"},
        {NODES("{\"type\": \"sphere\", \"material\": {\"ref\": \"red\"}}"),
         "x.json: nodes[0].material: the name 'red' is not in define\n"},
        {"{\"gray\": 1, \"define\": {\"a\": {\"type\": \"node\", \"children\": [{\"ref\": \"a\"}]}}, \"nodes\": "
         "[{\"ref\": \"a\"}]}",
         "x.json: define.a.children[0]: 'a' would be a part of itself\n"},
        {"{\"gray\": 1, \"nods\": [" SPHERE "]}", "x.json: the field 'nods' does not exist; did you mean 'nodes'?\n"},
        {"{\"gray\": 2, \"nodes\": [" SPHERE "]}", "x.json: it is of version 2; this gray reads version 1\n"},
        {"{\"nodes\": [" SPHERE "]}", "x.json: it is no scene of gray: \"gray\": 1 is missing at the top\n"},
        {"{\"gray\": 1, \"nodes\": [" SPHERE "], \"picture\": {\"fov\": 200}}",
         "x.json: picture.fov: gr.render: fov must be > 0 and < 180\n"},
        {"{\"gray\": 1, \"nodes\": [" SPHERE "], \"picture\": {\"lights\": [{\"type\": \"light\"}]}}",
         "x.json: picture.lights[0].colour: gr.light: colour is missing\n"},
        {"{\"gray\": 1, \"nodes\": [" SPHERE "], \"picture\": {\"eye\": [0, 0, null]}}",
         "x.json: picture.eye[2]: null is no value; leave the field out\n"},
        {"{\"gray\": 1,\n\"nodes\": [" SPHERE "], \"picture\": {\"eye\": [0, 0, NaN]}}",
         "x.json:2: broken JSON: invalid token near 'NaN' (column 60); words are only true, false and null, and "
         "numbers are finite\n"},
        {"{\"gray\": 1, \"nodes\": [" SPHERE "], \"picture\": {\"eye\": [0, 0, 1e400]}}",
         "x.json:1: broken JSON: real number overflow near '1e400' (column 74)\n"},
        {"{\"gray\": 1, \"gray\": 1, \"nodes\": [" SPHERE "]}",
         "x.json:1: broken JSON: duplicate object key near '\"gray\"' (column 18)\n"},
        {"[1]", "x.json: its JSON: an object must be at the top\n"},
        {"{\n// a scene\n\"gray\": 1}",
         "x.json:2: broken JSON: string or '}' expected near '/' (column 1); JSON has no comments\n"},
        {NODES(SPHERE ","), "x.json:1: broken JSON: unexpected token near ']' (column 42); a comma may be too many\n"},
        {"\xff\xfe{", "x.json:1: broken JSON: unable to decode byte 0xff (column 0); the text must be UTF-8\n"},
        {"", "x.json:1: broken JSON: '[' or '{' expected near end of file (column 0)\n"},
        {NODES("{\"radius\": 2}"),
         "x.json: nodes[0]: it must be a node, such as {\"type\": \"sphere\"}, not an object without a type\n"},
        {NODES(SPHERE ", {\"type\": \"light\", \"position\": [1, 2, 3], \"colour\": [1, 1, 1]}"),
         "x.json: nodes[1]: it must be a node, such as {\"type\": \"sphere\"}, not a light\n"},
        {NODES("{\"type\": 3}"), "x.json: nodes[0]: type and ref must be words, as in {\"type\": \"sphere\"}\n"},
        {NODES("{\"type\": \"sphere\", \"material\": {\"kd\": [1, 0, 0]}}"),
         "x.json: nodes[0].material: it must have a type, as in {\"type\": \"material\"}\n"},
        {"{\"gray\": 1, \"nodes\": " SPHERE "}",
         "x.json: nodes must be a list of at least one node, as in \"nodes\": [{\"type\": \"sphere\"}]\n"},
        {"{\"gray\": 1, \"nodes\": [" SPHERE "], \"eye\": [0, 0, 5]}", "x.json: the field 'eye' belongs in picture\n"},
        {"{\"gray\": 1, \"nodes\": [" SPHERE "], \"define\": {\"a\": {\"type\": \"spher\"}}}",
         "x.json: define.a: the type 'spher' does not exist; did you mean 'sphere'?\n"},
        {"{\"gray\": 1, \"nodes\": [" SPHERE "], \"transform_order\": \"newest\"}",
         "x.json: transform_order must be \"new\", \"old\" or \"separate\"\n"},
        {NODES("{\"type\": \"mesh\", \"file\": \"/etc/passwd\"}"),
         "x.json: nodes[0]: gr.mesh: '/etc/passwd' lies outside the folders that scenes may read (--allow-read DIR "
         "adds "
         "one)\n"},
        {NODES("{\"type\": \"sphere\", \"material\": {\"type\": \"material\", \"kd\": {\"type\": \"program\", "
               "\"code\": \"v0 = p.x; v1 = add v0 v2; result v1\"}}}"),
         "x.json: nodes[0].material.kd.code: gr.program: code: v1: this value is not known here, at 'v2'\n"},
    };
    test_need_json();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        test_write_text(test_path("x.json"), cases[i][0]);
        struct test_result result = test_gray(NULL, "-q --size 8x8 x.json");
        CHECK_EQ_INT(result.status, 1);
        CHECK_TEXT(result.err, cases[i][1]);
        test_free_result(&result);
    }
}

TEST(json_that_is_nested_without_end_or_too_large_is_refused) {
    test_need_json();
    test_write_text(
        test_path("make.sh"),
        "r() { printf \"$1%.0s\" $(seq $2); }\n"
        "(printf '{\"gray\": 1, \"nodes\": ['; r '[' 3000; r ']' 3000; echo ']}') >deep.json\n"
        "(printf '{\"gray\": 1, \"nodes\": ['; r '{\"type\": \"node\", \"children\": [' 600; "
        "r ']}' 600; echo ']}') >nodes.json\n"
        "(printf '{\"gray\": 1, \"define\": {\"n0\": " SPHERE "'; for i in $(seq 2000); do printf "
        "',\\n\"n%d\": {\"type\": \"node\", \"children\": [{\"ref\": \"n%d\"}]}' $i $((i - 1)); done; "
        "echo '}, \"nodes\": [{\"ref\": \"n2000\"}]}') >chain.json\n"
        "(printf '{\"gray\": 1, \"nodes\": [['; yes '[],' | head -8400000 | tr -d '\\n'; echo '[]]]}') >wide.json\n");
    CHECK_EQ_INT(test_run_shell("sh make.sh", ""), 0);
    test_shell_errors("$gray -q deep.json", 1, "deep.json:1: broken JSON: maximum parsing depth reached near '['");
    test_shell_errors("$gray -q nodes.json", 1, ": more than 1000 values are in each other");
    test_shell_errors("$gray -q chain.json", 1, ": more than 1000 values are in each other");
    test_shell_errors("$gray -q wide.json", 1,
                      "wide.json: its JSON: more than 8388608 lists and objects or 16777216 values");
}

static void copy_demos(void) {
    char line[512];
    (void)snprintf(line, sizeof line, "cp -r data textures '%s'", test_folder());
    CHECK_EQ_INT(system(line), 0);
}

/* Renders a scene of data/, what is written of it, and the script that is written of that. */
static void compare(const char *scene, const char *options) {
    char line[2048];
    (void)snprintf(line, sizeof line,
                   "cd '%s' && rm -rf out && mkdir out && gray='%s' && o='--size 32x24 -ss 1 --spp 1' && "
                   "$gray -q %s -o out/x%%d.json %s && $gray -q $o %s -o out/a%%d.png %s && "
                   "for f in out/x*.json; do n=${f#out/x}; n=${n%%.json}; "
                   "$gray -q $o -o out/b.png $f && cmp out/b.png out/a$n.png || exit 1; "
                   "$gray -q --to-json $f >out/again.json && cmp out/again.json $f || exit 1; "
                   "grep -q '\"time\"' $f || { $gray -q $f -o out/b.lua && $gray -q $o -o out/b.png out/b.lua && "
                   "cmp out/b.png out/a$n.png || exit 1; }; done",
                   test_folder(), test_program(), options, scene, options, scene);
    if (system(line) != 0)
        test_fail(__FILE__, __LINE__, "%s: another picture, or other bytes of its own scene", scene);
}

TEST(a_written_scene_is_the_same_picture_and_is_written_again_with_the_same_bytes) {
    static const char *const scenes[] = {"csg/chess", "functions/lamp", "functions/landscape", "light"};
    test_need_json();
    copy_demos();
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        char scene[64];
        (void)snprintf(scene, sizeof scene, "data/%s.lua", scenes[i]);
        compare(scene, "");
    }
    compare("data/animation/walker.lua", "--frames 2-2");
}

/* Scenes that were once written wrongly. */
TEST(scenes_of_other_programs_and_empty_pictures_are_written_with_the_same_picture) {
    static const char *const scenes[] = {
        "gr.render{node = gr.sphere{}}",
        "gr.render(gr.sphere('s'), 't.png', 33 / 2, 9, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50, {1, 1, 1}, {})",
        "gr.render{node = gr.sphere{medium = gr.medium{scattering = {2, 2, 2}, corner = {-1, -1, -1}, size = 2, cells "
        "= {2, "
        "1, 3}, type = 'uint8', density = 'plain.raw'}}, eye = {0, 0, 4}, background = {1, 1, 1}, integrator = 'path'}",
        "gr.render{node = gr.sphere{}} gr.render(gr.sphere('b'), 'x.png', 9, 9, {0, 0, 5}, {0, 0, -1}, {0, 1, 0}, 50)",
    };
    test_need_json();
    test_write_file(test_path("plain.raw"), "\1\2\3\4\5\6", 6);
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        test_write_text(test_path("s.lua"), scenes[i]);
        compare("s.lua", "");
    }
}

TEST_LONG(two_hundred_scenes_of_the_tests_are_written_with_the_same_picture) {
    char line[1024], *text;
    int count = 0;
    test_need_json();
    (void)snprintf(line, sizeof line, "mkdir '%s/trip' && tools/scene_round_trip.py '%s' '%s/trip' >'%s/list'",
                   test_folder(), test_program(), test_folder(), test_folder());
    CHECK_EQ_INT(system(line), 0);
    text = test_read_file(test_path("list"), NULL);
    CHECK(sscanf(text, "%d scenes are the same", &count) == 1 && count >= 200);
    free(text);
}

TEST_LONG(every_demo_that_is_written_as_json_and_as_a_script_is_the_same_picture) {
    test_need_json();
    copy_demos();
    CHECK_EQ_INT(test_run_shell("find data -name '*.lua' ! -name 'make*' ! -name 'gallery*' | sort >list", ""), 0);
    char *list = test_read_file(test_path("list"), NULL), *at = list;
    for (char *name; (name = strsep(&at, "\n")) && name[0];) {
        char *text = test_read_file(test_path(name), NULL);
        compare(name, strstr(text, "gr.frames") ? "--frames 2-2" : "");
        free(text);
    }
    free(list);
}

TEST(a_scene_in_json_has_the_same_bytes_in_parts_and_with_any_number_of_threads) {
    test_need_json();
    copy_demos();
    test_shell("$gray -q data/csg/chess.lua -o x.json && $gray -q --size 64x48 data/csg/chess.lua -o a.png && "
               "$gray -q -j 1 --size 64x48 x.json -o b.png && cmp a.png b.png && "
               "for i in 1 2 3; do $gray -q --size 64x48 --shard $i/3 x.json -o p.png; done && "
               "$gray merge -q p.*.part -o c.png && cmp a.png c.png",
               0, "");
}

TEST(frames_of_an_animation_are_a_scene_each_and_other_pictures_need_a_number_in_the_name) {
    test_need_json();
    test_write_text(test_path("f.lua"),
                    "local wheel = gr.cube{}:spin('z', 90)\n"
                    "gr.frames{count = 3, fps = 2, shutter = {0, 0.5}, draw = function(t)\n"
                    "  wheel:reset():translate(t, 0, 0)\n"
                    "  return {node = wheel, eye = {0, 1, 5}, view = {0, 0, -1}, width = 32, height = 24}\n"
                    "end}\n");
    test_shell("$gray -q f.lua -o x%d.json && $gray -q f.lua -o a%d.png && for i in 1 2 3; do "
               "$gray -q x$i.json -o b.png && cmp a$i.png b.png || exit 1; done && grep '\"time\": 1' x3.json",
               0, "\"time\": 1");
    test_shell_errors("$gray -q f.lua -o y.json", 2,
                      "gray: --to-json: more than one picture is rendered; -o scene%d.json");
    CHECK(access(test_path("y.json"), F_OK) != 0);
}

TEST(the_numbers_of_a_written_scene_are_the_shortest_that_are_read_as_the_same) {
    test_need_json();
    test_write_text(test_path("n.lua"), "gr.render{node = gr.sphere{centre = {0.1, 1/3, -0.0}, radius = 1e-20,\n"
                                        "  material = gr.material{kd = {0.1 + 0.2, 100, 1e25}}}, eye = {0, 5, 9007199254740993}}\n");
    test_shell("$gray --to-json n.lua", 0,
               "{\"gray\": 1,\n \"nodes\": [\n  {\n   \"centre\": [0.1, 0.3333333333333333, -0.0],\n   \"material\": "
               "{\"kd\": [0.30000000000000004, 100, 1e+25], \"type\": \"material\"},\n   \"radius\": 1e-20, \"type\": "
               "\"sphere\"\n  }\n ],\n \"picture\": {\"eye\": [0, 5, 9007199254740992]}\n}\n");
}

TEST(the_schema_accepts_what_gray_writes_and_refuses_other_fields) {
    test_need_json();
    if (system("python3 -c 'import jsonschema' 2>/dev/null") != 0)
        test_lacks("python3-jsonschema is not installed");
    copy_demos();
    test_write_text(test_path("check.py"), "import json, sys, jsonschema\n"
                                           "schema = json.load(open('schema.json'))\n"
                                           "jsonschema.Draft202012Validator.check_schema(schema)\n"
                                           "checker = jsonschema.Draft202012Validator(schema)\n"
                                           "for name in sys.argv[1:]:\n"
                                           "    scene = json.load(open(name))\n"
                                           "    checker.validate(scene)\n"
                                           "    scene['nodes'].append({'type': 'sphere', 'radus': 1})\n"
                                           "    assert not checker.is_valid(scene)\n"
                                           "    scene['nodes'][-1] = {'type': 'sphere', 'radius': 'x'}\n"
                                           "    assert not checker.is_valid(scene)\n");
    test_shell("$gray --json-schema >schema.json && for s in functions/lamp csg/bottle; do "
               "$gray -q data/$s.lua -o x_${s#*/}_%d.json || exit 1; done && python3 check.py x_*.json",
               0, "");
}

TEST(what_json_cannot_have_is_an_error_that_names_it_and_writes_nothing) {
    static const char *const cases[][2] = {
        {"gr.render{node = gr.sphere{}, tone = function(x) return x end}",
         "gr.render: tone is a function that is not recorded, so it cannot be written"},
        {"gr.render{node = gr.sphere{name = '\\xff'}}", "a text is not UTF-8, so JSON cannot have it"},
        {"gr.change_exposure{picture = 'x.png', stops = 1}\ngr.render{node = gr.sphere{}, file = 'x.png'}",
         "a scene with saved edits cannot be written"},
        {"local m = gr.mesh{verts = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, faces = {{0, 1, 2}}}\nlocal n = "
         "gr.node{children "
         "= {m}}:displace{f = function(p) return p.x end, level = 1}\nm:displace{f = function(p) return p.y end, level "
         "= 1}\ngr.render{node = n}",
         "a node below a displaced one was displaced, or has got a child, after it"},
        {"gr.change_material(1, {1, 0, 0})\nlocal m = gr.material{kd = {0, 0, 1}}\ngr.render{node = gr.sphere{material "
         "= m}}",
         "a scene with saved edits cannot be written"},
        {"local n = gr.sphere{}:scale(1, 2, 1)\ngr.transform_order('old')\ngr.render{node = n:translate(1, 0, 0)}",
         "gr.transform_order changes within the scene, which cannot be written"},
    };
    test_need_json();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        test_write_text(test_path("s.lua"), cases[i][0]);
        test_shell_errors("$gray -q s.lua -o x.json", 1, cases[i][1]);
        CHECK(access(test_path("x.json"), F_OK) != 0);
    }
    test_shell_errors("$gray -q s.lua --to-json -o x.png", 2, "--to-json -o x.png: the name must end in .json");
    test_shell_errors("$gray -q s.lua --to-json --lenient", 2, "--to-json renders nothing: it cannot be combined");
    test_write_text(test_path("own.json"), "[1]");
    test_write_text(test_path("s.lua"), "gr.render{node = gr.sphere{}}");
    test_shell_errors("$gray -q s.lua -o own.json", 1, "own.json");
    test_shell("cat own.json", 0, "[1]");
}

TEST(a_scene_in_json_becomes_a_script_that_a_reader_can_follow) {
    test_need_json();
    test_write_text(
        test_path("a.json"),
        "{\"gray\": 1, \"define\": {\"m\": {\"type\": \"material\", \"kd\": [0.1, 0.2, 0.30000000000000004]},"
        " \"w\": {\"type\": \"torus\", \"name\": \"end\", \"minor\": 0.2, \"material\": {\"ref\": \"m\"}}},"
        "\"nodes\": [{\"ref\": \"w\"}, {\"type\": \"node\", \"name\": \"it's\", \"children\": [{\"ref\": \"w\"}], "
        "\"transform\": [{\"translate\": [1, 0, -0.5]}, {\"rotate\": {\"axis\": \"y\", \"angle\": 30}}]},"
        "{\"type\": \"sphere\", \"children\": [{\"type\": \"cube\", \"material\": {\"ref\": \"m\"}}]}],"
        "\"picture\": {\"eye\": [0, 2, 8], \"width\": 32, \"height\": 24, \"file\": \"a.png\"}}");
    test_shell("$gray -q --to-lua a.json", 0,
               "-- A scene written by gray\n"
               "local material = gr.material{kd = {0.1, 0.2, 0.30000000000000004}}\n"
               "local end_2 = gr.torus{name = 'end', material = material, minor = 0.2}\n"
               "local scene = gr.node{\n"
               "  name = 'scene',\n"
               "  children = {\n"
               "    end_2,\n"
               "    gr.node{name = \"it's\", children = {end_2}}:translate(1, 0, -0.5):rotate('y', 30),\n"
               "    gr.sphere{}:add_child(gr.cube{material = material})\n"
               "  }\n"
               "}\n"
               "gr.render{file = 'a.png', node = scene, width = 32, height = 24, eye = {0, 2, 8}}\n");
}

TEST(a_script_for_more_names_than_lua_has_locals_is_the_same_picture) {
    test_need_json();
    test_write_text(
        test_path("many.lua"),
        "local s = gr.node('s')\n"
        "for i = 1, 400 do\n"
        "  local b = gr.sphere{name = 'b' .. i, radius = 0.4, material = gr.material{kd = {i / 400, 0.5, 0}}}\n"
        "  s:add_child(gr.node{children = {b}}:translate(i % 20 - 10, i // 20 - 10, 0))\n"
        "  s:add_child(gr.node{children = {b}}:translate(i % 20 - 9.5, i // 20 - 10, 1))\n"
        "end\n"
        "for i = 1, 100 do s = gr.node{children = {s}}:rotate('z', 0.1) end\n"
        "gr.render(s, 'many.png', 48, 36, {0, 0, 30}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2},\n"
        "          {gr.light({9, 9, 30}, {1, 1, 1})})\n");
    test_shell("$gray -q many.lua && $gray -q many.lua -o b.lua && $gray -q b.lua -o b.png && cmp many.png b.png", 0,
               "");
}

#define LIGHT                                                                                                          \
    "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":%d}},\"rotation\":[0.1,0.2,0.05,0.97],\"translation\":[%s]}"

TEST(models_and_their_lights_are_written_as_json_and_scripts_with_the_same_picture) {
    char text[4096];
    test_need_json();
    (void)snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_lights_punctual\"],\"extensions\":"
        "{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"directional\",\"intensity\":2000},{\"type\":\"point\","
        "\"intensity\":3000,\"color\":[1,0.5,0.2]},{\"type\":\"spot\",\"intensity\":9000,\"spot\":"
        "{\"innerConeAngle\":0.3,\"outerConeAngle\":0.71}}]}},\"scenes\":[{\"nodes\":[0,1,2,3,4]}],"
        "\"nodes\":[{\"mesh\":0},{\"camera\":0,\"translation\":[0,0.5,5]}," LIGHT "," LIGHT "," LIGHT "],"
        "\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.5,\"znear\":1}}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
        "\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"
        "AACAvwAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}",
        0, "0,0,0", 1, "1,1.5,2", 2, "-1,1,2.5");
    test_write_text(test_path("g.gltf"), text);
    test_write_text(test_path("o.obj"), "v -1 0 0\nv 1 0 0\nv 0 1 0.3\nv 0 0 1\nf 1 2 3\nf 1 4 3\n");
    test_write_text(test_path("s.stl"), "solid s\nfacet normal 0 0 1\nouter loop\nvertex -1 0 0\nvertex 1 0 0\n"
                                        "vertex 0 1 1\nendloop\nendfacet\nendsolid s\n");
    test_write_text(test_path("l.lua"),
                    "local m = gr.model('g.gltf')\nlocal c = m.cameras[1]\n"
                    "gr.render{node = m, eye = c.eye, view = c.view, up = c.up, fov = c.fov, lights = m.lights}\n");
    test_shell("for m in g.gltf o.obj s.stl l.lua; do o='-q --size 48x27 --spp 2'; $gray $o $m -o a.png && "
               "$gray $o $m -o x.json && $gray $o x.json -o b.png && cmp a.png b.png && "
               "$gray $o $m -o x.lua && $gray $o x.lua -o b.png && cmp a.png b.png || exit 1; done",
               0, "");
}
