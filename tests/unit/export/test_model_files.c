/* -o MODEL, node:export and --check-print, and the files that they write. */
#define _GNU_SOURCE
#include "base/file.h"
#include "base/mem.h"
#include "formats/model.h"
#include "image/zlib_memory.h"
#include "math/elementary.h"
#include "tests/harness.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <linux/ptrace.h>

static const char part[] =
    "local red = gr.material({0.8, 0.2, 0.1}, {0, 0, 0}, 20)\n"
    "local part = gr.difference{gr.box{material = red, min = {0, 0, 0}, max = {40, 30, 5}},\n"
    "    gr.cylinder{name = 'drill', from = {20, 15, -1}, to = {20, 15, 6}, radius = 8}, name = 'part'}\n";

/* The part with more lines after it. */
static const char *part_and(const char *more) {
    static char text[4096];
    (void)snprintf(text, sizeof text, "%s%s", part, more);
    return text;
}

static void expect(const char *scene, const char *options, int status, const char *words) {
    struct test_result result = test_gray_scene(scene, options, NULL);
    CHECK_EQ_INT(result.status, status);
    if (words && !strstr(result.err, words) && !strstr(result.out, words))
        test_fail(__FILE__, __LINE__, "no '%s' in '%s%s'", words, result.err, result.out);
    test_free_result(&result);
}

static double volume_of(const struct mesh *mesh) {
    double volume = 0;
    for (uint32_t i = 0; i < mesh_triangle_count(mesh); i++) {
        struct vec3 c[3];
        uint32_t slot;
        mesh_triangle(mesh, i, c, &slot);
        volume += vec3_dot(c[0], vec3_cross(c[1], c[2])) / 6;
    }
    return volume;
}

TEST(models_are_read_again_with_their_volume_and_are_closed) {
    static const char *const names[] = {"part.stl", "text.stl", "part.obj", "part.ply"};
    expect(part_and("part:export('part.stl')\npart:export('text.stl', {text = true})\npart:export('part.obj')\n"
                    "part:export('part.ply', {tolerance = 0.1})\n"),
           "scene.lua", 0, NULL);
    for (int i = 0; i < 4; i++) {
        struct model model = {0};
        struct model_options options = {0};
        struct error error = {0};
        if (!model_read(&model, test_path(names[i]), &options, &error)) {
            test_fail(__FILE__, __LINE__, "%s", error.text);
            continue;
        }
        const struct mesh *mesh = model_meshes(&model)[0].mesh;
        CHECK(mesh_is_closed(mesh) && mesh_is_outward(mesh));
        CHECK_NEAR(volume_of(mesh), 6000 - PI * 320, 0.1 * 2 * PI * 40);
        if (i == 2) { /* the cut has the material of the drill */
            CHECK_EQ_INT(model.materials.count, 2);
            CHECK_NEAR(model_materials(&model)[0].kd.r + model_materials(&model)[1].kd.r, 1.3, 1e-6);
        }
        model_destroy(&model);
    }
    /* A model is a scene, whose ground is no part of it. */
    struct test_result result = test_gray(test_folder(), "-q part.obj -o again.stl");
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    struct model model = {0};
    struct model_options options = {0};
    struct error error = {0};
    CHECK(model_read(&model, test_path("again.stl"), &options, &error));
    CHECK_NEAR(volume_of(model_meshes(&model)[0].mesh), 6000 - PI * 320, 0.1 * 2 * PI * 40);
    model_destroy(&model);
}

static uint32_t little(const char *bytes, int count) {
    uint32_t number = 0;
    for (int i = count; i-- > 0;)
        number = number << 8 | (uint8_t)bytes[i];
    return number;
}

/* A file of a zip, inflated; NULL: there is none of this name. */
static char *out_of_zip(const char *path, const char *name, size_t *length_of) {
    size_t size = 0;
    char *bytes = test_read_file(path, &size), *at = bytes, *out = NULL;
    while (!out && bytes && at + 30 < bytes + size && memcmp(at, "PK\3\4", 4) == 0) {
        uint32_t packed = little(at + 18, 4), whole = little(at + 22, 4), length = little(at + 26, 2);
        z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
        const char *data = at + 30 + length;
        at = bytes + (data - bytes) + packed;
        if (length != strlen(name) || memcmp(data - length, name, length) != 0)
            continue;
        out = mem_alloc_zero(whole + 1, 1);
        CHECK(inflateInit2(&stream, -15) == Z_OK);
        stream.next_in = (const Bytef *)data;
        stream.avail_in = packed;
        stream.next_out = (Bytef *)out;
        stream.avail_out = whole;
        CHECK(inflate(&stream, Z_FINISH) == Z_STREAM_END && stream.total_out == whole);
        (void)inflateEnd(&stream);
        *length_of = whole;
    }
    free(bytes);
    return out;
}

static char *model_of_zip(const char *path) {
    size_t size = 0;
    char *xml = out_of_zip(path, "3D/3dmodel.model", &size);
    CHECK(xml);
    return xml;
}

TEST(a_3mf_file_has_units_names_and_colours) {
    expect(part_and("gr.union{part, gr.sphere{name = 'ball', centre = {100, 0, 0}, radius = 3}}"
                    ":export('part.3mf', {unit = 'in'})\n"),
           "scene.lua", 0, NULL);
    expect("local root = gr.node 'root'\nroot:add_child(gr.sphere{name = 'left & \"right\"', radius = 1})\n"
           "root:add_child(gr.sphere{name = 'other', centre = {5, 0, 0}, radius = 1})\nroot:export('two.3mf')\n",
           "scene.lua", 0, NULL);
    char *xml = model_of_zip(test_path("part.3mf"));
    CHECK(strstr(xml, "unit=\"inch\"") && strstr(xml, "displaycolor=\"#CC331A\""));
    mem_free(xml);
    xml = model_of_zip(test_path("two.3mf"));
    CHECK(strstr(xml, "name=\"left &amp; &quot;right&quot;\"") && strstr(xml, "name=\"other\""));
    CHECK(strstr(xml, "<item objectid=\"3\"/>"));
    mem_free(xml);
}

/* The colour of a point is its place. */
TEST(textures_colour_the_corners_of_3mf_files_and_the_faces_of_ply_files) {
    expect("local place = gr.material{kd = function(p) return {p[1], p[2], p[3]} end}\n"
           "local cube = gr.box{material = place, min = {0, 0, 0}, max = {1, 1, 1}}\n"
           "cube:export('cube.3mf')\ncube:export('cube.ply')\n",
           "scene.lua", 0, NULL);
    char *xml = model_of_zip(test_path("cube.3mf"));
    unsigned seen = 0, colour;
    for (const char *at = xml; at && (at = strstr(at, "<m:color color=\"#")); at++) {
        CHECK_EQ_INT(sscanf(at + 17, "%6x", &colour), 1);
        for (int k = 0; k < 24; k += 8) /* a hundredth inside of the triangles */
            CHECK((colour >> k & 255) < 4 || (colour >> k & 255) > 251);
        seen |= 1U << ((colour >> 23 & 1) | (colour >> 14 & 2) | (colour >> 5 & 4));
    }
    CHECK_EQ_INT(seen, 255);
    CHECK(xml && strstr(xml, "<m:colorgroup id=\"3\">") && strstr(xml, " pid=\"3\" p1=\""));
    mem_free(xml);
    size_t size = 0;
    char *ply = test_read_file(test_path("cube.ply"), &size);
    CHECK(ply && size > 192);
    for (int i = 0; ply && size > 192 && i < 12; i++) /* 13 bytes and a colour each: thirds of a corner's */
        for (int k = 0; k < 3; k++)
            CHECK_NEAR(fmod((uint8_t)ply[size - 192 + 16 * (size_t)i + 13 + (size_t)k] + 3, 85), 3, 3);
    free(ply);
}

static struct test_picture thumbnail_of(const char *path) {
    size_t size = 0;
    char *png = out_of_zip(path, "Metadata/thumbnail.png", &size);
    if (png)
        test_write_file(test_path("small.png"), png, size);
    mem_free(png);
    return test_read_picture(test_path("small.png"));
}

/* Two balls beside each other: which one is on the left of the thumbnail? */
static void expect_on_the_left(const char *call, const char *options, int channel) {
    char text[1024];
    (void)snprintf(
        text, sizeof text,
        "local function ball(x, colour)\n"
        "    return gr.sphere{centre = {x, 0, 0}, radius = 1, material = gr.material{kd = colour}}\n"
        "end\n"
        "local balls = gr.node{name = 'balls', children = {ball(-1.5, {1, 0, 0}), ball(1.5, {0, 0, 1})}}\n%s",
        call);
    expect(text, options, 0, NULL);
    struct test_picture picture = thumbnail_of(test_path("balls.3mf"));
    CHECK(picture.width == 256 && picture.height == 256 && picture.rgb[0] == 229);
    const uint8_t *left = picture.rgb + (size_t)3 * (128 * 256 + 64);
    CHECK(left[channel] > 200 && left[1] == 0 && left[2 - channel] == 0);
    free(picture.rgb);
}

TEST(a_3mf_file_has_a_picture_of_the_model_from_the_side_of_the_camera) {
    expect_on_the_left("balls:export('balls.3mf')\n", "scene.lua", 0);
    expect_on_the_left("gr.render{node = balls, file = 'x.png', width = 8, eye = {0, 0, 9}, target = {0, 0, 0}}\n",
                       "-o balls.3mf scene.lua", 0);
    expect_on_the_left("gr.render{node = balls, file = 'x.png', width = 8, eye = {0, 0, -9}, target = {0, 0, 0}}\n",
                       "-o balls.3mf scene.lua", 2);
}

TEST(a_3mf_file_that_is_written_with_its_picture_has_it_as_its_thumbnail) {
    expect(part_and("gr.render(gr.studio{node = part, file = 'x.png', width = 64, height = 40})\n"),
           "-o part.3mf -o small_picture.png scene.lua", 0, NULL);
    struct test_picture picture = test_read_picture(test_path("small_picture.png"));
    struct test_picture thumbnail = thumbnail_of(test_path("part.3mf"));
    CHECK(thumbnail.width == 64 && thumbnail.height == 40);
    CHECK(memcmp(picture.rgb, thumbnail.rgb, (size_t)3 * 64 * 40) == 0);
    free(picture.rgb);
    free(thumbnail.rgb);
    /* A larger one is reduced: the mean of its pixels. */
    expect(part_and("gr.render{node = part, file = 'x.png', width = 1024, height = 512, eye = {20, 15, 90}, "
                    "target = {20, 15, 0}, background = {1, 1, 1}, ambient = {.4, .4, .4}}\n"),
           "-o part.3mf -o picture.png scene.lua --picture 1", 0, NULL);
    picture = test_read_picture(test_path("picture.png"));
    thumbnail = thumbnail_of(test_path("part.3mf"));
    CHECK(thumbnail.width == 256 && thumbnail.height == 128);
    for (int i = 0; i < 256 * 128; i++) {
        int sum = 0;
        for (int k = 0; k < 16; k++)
            sum += picture.rgb[3 * (1024 * (4 * (i / 256) + k / 4) + 4 * (i % 256) + k % 4)];
        CHECK(abs(sum / 16 - thumbnail.rgb[3 * i]) <= 1);
    }
    free(picture.rgb);
    free(thumbnail.rgb);
}

TEST(the_studio_is_no_part_of_a_model_and_a_node_that_is_called_model_is_all_of_it) {
    static const char *const calls[] = {
        "gr.render(gr.studio{node = part, file = 'x.png', width = 8})\n",
        "local all = gr.node{children = {part, gr.plane{normal = {0, 0, 1}}}}\n"
        "gr.render{node = all, model = part, file = 'x.png', width = 8}\n",
    };
    for (int i = 0; i < 2; i++) {
        struct test_result result = test_gray_scene(part_and(calls[i]), "--check-print scene.lua", NULL);
        CHECK(result.status == 0 && strstr(result.out, "size: 40 x 30 x 5"));
        test_free_result(&result);
    }
}

TEST(a_mesh_that_touches_nothing_keeps_its_triangles) {
    expect("gr.mesh(gr.material({1, 1, 1}, {0, 0, 0}, 1), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, "
           "{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}):export('four.stl')\n",
           "scene.lua", 0, NULL);
    size_t size = 0;
    char *bytes = test_read_file(test_path("four.stl"), &size);
    CHECK_EQ_INT(size, 84 + 4 * 50);
    free(bytes);
}

/* Vertices farther from the drill's axis than .1: their number, and how many of them are none of the others. */
static uint32_t vertices_far_from_drill(const struct mesh *mesh, const struct mesh *other, uint32_t *different) {
    uint32_t count, other_count, far = 0;
    const double(*at)[3] = mesh_vertices(mesh, &count), (*others)[3] = mesh_vertices(other, &other_count);
    *different = 0;
    for (uint32_t i = 0; i < count; i++) {
        double nearest = INFINITY, x = at[i][0] - 0.52, y = at[i][1] - 0.05;
        if (x * x + y * y < 0.01)
            continue;
        for (uint32_t k = 0; k < other_count; k++)
            nearest =
                fmin(nearest,
                     vec3_length(vec3_make(at[i][0] - others[k][0], at[i][1] - others[k][1], at[i][2] - others[k][2])));
        far++;
        *different += !(nearest < 1e-6);
    }
    return far;
}

TEST(letters_and_bevelled_meshes_that_are_cut_keep_their_corners_elsewhere_and_get_no_vertices_there) {
    static const char *const names[] = {"prism.stl", "cut_prism.stl", "mesh.stl", "cut_mesh.stl"};
    expect(
        "local polygon = require 'polygon'\n"
        "local e = {{.1, 0}, {.57, 0}, {.57, .08}, {.2, .08}, {.2, .35}, {.54, .35}, {.54, .43}, {.2, .43}, {.2, .65}, "
        "{.56, .65}, {.56, .73}, {.1, .73}}\n"
        "local drill = gr.cylinder{from = {.52, .05, -1}, to = {.52, .05, 1}, radius = .02}\n"
        "local prism = gr.prism{outline = e, from = -.2, to = 0}:rotate('x', -90)\n"
        "local mesh = gr.vn_mesh(gr.material({1, 1, 1}), polygon.extrude({e}, .2, {bevel = .02, back = true}))\n"
        "prism:export('prism.stl')\ngr.difference(prism, drill):export('cut_prism.stl')\n"
        "mesh:export('mesh.stl')\ngr.difference(mesh, drill):export('cut_mesh.stl')\n",
        "scene.lua", 0, NULL);
    struct model models[4] = {0};
    for (int i = 0; i < 4; i++) {
        struct model_options options = {0};
        struct error error = {0};
        if (!model_read(&models[i], test_path(names[i]), &options, &error))
            test_fail(__FILE__, __LINE__, "%s", error.text);
    }
    for (int i = 0; i < 4; i += 2) {
        const struct mesh *whole = model_meshes(&models[i])[0].mesh, *cut = model_meshes(&models[i + 1])[0].mesh;
        uint32_t lost, added;
        CHECK_EQ_INT(vertices_far_from_drill(whole, cut, &lost), vertices_far_from_drill(cut, whole, &added));
        CHECK(lost == 0 && added == 0 && mesh_is_closed(cut));
        CHECK(mesh_triangle_count(cut) > mesh_triangle_count(whole));
    }
    CHECK_EQ_INT(mesh_triangle_count(model_meshes(&models[0])[0].mesh), 4 * 12 - 4);
    for (int i = 0; i < 4; i++)
        model_destroy(&models[i]);
}

TEST(a_mesh_whose_surfaces_meet_in_a_point_has_a_notice) {
    expect("gr.mesh{name = 'pair', verts = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, "
           "{0, 0, -1}}, faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, "
           "{4, 6, 5}}}:export('x.stl')\n",
           "scene.lua", 0, "node 'pair': surfaces of its mesh meet in edges or vertices");
}

TEST(a_model_of_the_command_line_is_the_scene_of_the_only_picture_or_of_a_chosen_one) {
    static const char two[] = "gr.render{node = gr.sphere{name = 'a', radius = 1}, file = 'a.png', width = 8}\n"
                              "gr.render{node = gr.sphere{name = 'b', radius = 2}, file = 'b.png', width = 8}\n";
    expect(part_and("gr.render{node = part, file = 'x.png', width = 8}\n"), "-o one.stl scene.lua", 0, NULL);
    CHECK(file_is_regular(test_path("one.stl")) && !file_is_regular(test_path("x.png")));
    expect(part_and("gr.render{node = part, file = 'x.png', width = 8}\n"), "-o both.stl -o y.png scene.lua", 0, NULL);
    CHECK(file_is_regular(test_path("both.stl")) && file_is_regular(test_path("y.png")));
    expect(two, "-o two.stl scene.lua", 2, "1 a.png, 2 b.png; --picture N chooses one");
    CHECK(!file_is_regular(test_path("two.stl")));
    expect(two, "-o two.stl --picture 2 scene.lua", 0, NULL);
    expect(two, "-o two.stl --picture 3 scene.lua", 2, "the script renders 2 pictures");
    expect(two, "-o b.stl --picture 2 --node c scene.lua", 1, "--node c: the scene has no node of this name");
    expect("gr.frames{count = 2, draw = function() return {node = gr.sphere{radius = 1}, width = 8} end}\n",
           "-o frame.stl scene.lua", 1, "--frames N-N chooses it");
    expect("gr.frames{count = 2, draw = function() return {node = gr.sphere{radius = 1}, width = 8} end}\n",
           "-o frame.stl --frames 2-2 scene.lua", 0, NULL);
    expect(two, "-o one.stl -o two.stl scene.lua", 2, "a run writes one model");
    expect("print(1)\n", "-o none.stl scene.lua", 2, "the script renders no picture");
}

TEST(what_is_no_solid_is_an_error_that_names_the_node_and_writes_nothing) {
    expect("gr.rectangle{name = 'sheet'}:export('x.stl')\n", "scene.lua", 1,
           "node 'sheet' is no solid, because it is flat");
    expect("gr.plane{name = 'ground', normal = {0, 0, 1}}:export('x.stl')\n", "scene.lua", 1,
           "node 'ground' has no end");
    expect("gr.mesh{name = 'hole', verts = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, faces = {{0, 1, 2}}}"
           ":export('x.stl')\n",
           "scene.lua", 1, "node 'hole' is no solid, because its mesh is open");
    expect("gr.node('nothing'):export('x.stl')\n", "scene.lua", 1, "node 'nothing' is empty");
    expect("gr.intersection(gr.sphere{}, gr.sphere{centre = {5, 0, 0}, name = 'far'}):export('x.stl')\n", "scene.lua",
           1, "node 'csg' is empty");
    expect("gr.difference(gr.sphere{}, gr.sphere{radius = 2}):export('x.stl')\n", "scene.lua", 1,
           "node 'csg' is empty");
    CHECK(!file_is_regular(test_path("x.stl")));
}

TEST(models_follow_the_rules_of_pictures_for_names_and_replaced_files) {
    expect(part_and("part:export('../x.stl')\n"), "scene.lua", 1,
           "models of scripts must be below the working directory");
    expect(part_and("part:export('x.png')\n"), "scene.lua", 1,
           "the name of a model ends in .stl .obj .ply .gltf .glb .3mf");
    test_write_text(test_path("mine.stl"), "my notes\n");
    expect(part_and("part:export('mine.stl')\n"), "scene.lua", 1, "exists already and is not a model");
    expect(part_and("gr.render{node = part, width = 8}\n"), "-o mine.stl scene.lua", 1, "--force replaces it");
    expect(part_and("gr.render{node = part, width = 8}\n"), "-o mine.stl --force scene.lua", 0, NULL);
    expect(part_and("part:export('mine.stl')\npart:export('mine.stl')\n"), "scene.lua", 0, NULL);
    expect(part_and("part:export('checked.stl')\n"), "--check scene.lua", 0, NULL);
    CHECK(!file_is_regular(test_path("checked.stl")));
    expect(part_and("part:export('x.stl')\n"), "--tolerance 1 scene.lua", 2, "--tolerance is only for -o MODEL");
}

TEST(the_bytes_of_a_model_depend_on_no_number_of_threads) {
    expect(part_and("part:export('one.3mf')\n"), "-j 1 scene.lua", 0, NULL);
    expect(part_and("part:export('three.3mf')\n"), "-j 3 scene.lua", 0, NULL);
    size_t one = 0, three = 0;
    char *a = test_read_file(test_path("one.3mf"), &one), *b = test_read_file(test_path("three.3mf"), &three);
    CHECK(a && b && one == three && memcmp(a, b, one) == 0);
    free(a);
    free(b);
}

/* Numbers after a word of the report. */
static double number_after(const char *text, const char *word) {
    const char *at = strstr(text, word);
    return at ? strtod(at + strlen(word), NULL) : NAN;
}

static double thinnest(const char *solid) {
    char scene[1024];
    (void)snprintf(scene, sizeof scene, "gr.render{node = %s, width = 8}\n", solid);
    struct test_result result = test_gray_scene(scene, "--check-print scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    double wall = number_after(result.out, "thinnest wall: ");
    test_free_result(&result);
    return wall;
}

TEST(the_thinnest_wall_of_a_shell_a_tube_and_two_plates_is_found_within_2_percent) {
    CHECK_NEAR(thinnest("gr.difference{gr.sphere{radius = 10}, gr.sphere{radius = 9.8}}"), 0.2, 0.004);
    CHECK_NEAR(thinnest("gr.difference{gr.cylinder{from = {0, 0, 0}, to = {0, 0, 30}, radius = 5}, "
                        "gr.cylinder{from = {0, 0, -1}, to = {0, 0, 31}, radius = 4.5}}"),
               0.5, 0.01);
    CHECK_NEAR(
        thinnest("gr.union{gr.box{min = {0, 0, 0}, max = {20, 20, 2}}, gr.box{min = {0, 0, 2}, max = {1, 20, 20}}}"), 1,
        0.02);
}

TEST(a_model_of_a_frame_has_the_pose_of_its_time) {
    expect("local b = gr.box{min = {0, 0, 0}, max = {4, 1, 2}}\nb:spin({0, 0, 1}, 90)\n"
           "gr.frames{count = 11, draw = function() return {node = b, width = 8, eye = {0, 0, 9}, view = {0, 0, -1}} "
           "end}\n",
           "--check-print --frames 11-11 --fps 10 scene.lua", 0, "size: 1 x 4 x 2");
}

TEST(check_print_reports_volume_overhang_and_contact) {
    struct test_result result = test_gray_scene(
        "local t = gr.union{gr.box{min = {4, 4, 0}, max = {6, 6, 8}}, gr.box{min = {0, 0, 8}, max = {10, 10, 10}}}\n"
        "gr.render{node = t, width = 8}\n",
        "--check-print scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.out, "closed: yes") && strstr(result.out, "size: 10 x 10 x 10"));
    CHECK_NEAR(number_after(result.out, "volume: "), 232, 1e-3);
    CHECK_NEAR(number_after(result.out, "steepest overhang: "), 90, 1e-3);
    CHECK_NEAR(number_after(result.out, "area above 45 degrees: "), 96, 1e-3);
    CHECK_NEAR(number_after(result.out, "contact area "), 4, 1e-3);
    CHECK(strstr(result.out, "stands on the plate: yes"));
    test_free_result(&result);
    result = test_gray_scene("gr.render{node = gr.union{gr.box{min = {0, 0, 0}, max = {1, 1, 2}}, "
                             "gr.box{min = {0, 0, 2}, max = {9, 1, 3}}}, width = 8}\n",
                             "--check-print scene.lua", NULL);
    CHECK(strstr(result.out, "stands on the plate: no"));
    test_free_result(&result);
    result = test_gray_scene("for i = 1, 2 do gr.render{node = gr.sphere{}, file = i .. '.png', width = 8} end\n",
                             "-q --check-print scene.lua", NULL);
    CHECK(result.status == 2 && strcmp(result.out, "") == 0);
    CHECK_TEXT(result.err, "gray: --check-print: the script renders several pictures, 1 1.png, 2 2.png; --picture N "
                           "chooses one\n");
    test_free_result(&result);
}

/* A sphere of this radius as x.KIND. */
static const char *sphere_as(const char *kind, int radius) {
    static char text[256];
    if (strcmp(kind, "json") == 0) {
        (void)snprintf(text, sizeof text, "gr.render{node = gr.sphere{radius = %d}}\n", radius);
        return text;
    }
    (void)snprintf(text, sizeof text, "gr.sphere{radius = %d}:export('x.%s', {tolerance = 0.1})\n", radius, kind);
    return text;
}

static bool may_change_files(const struct ptrace_syscall_info *info) {
    switch (info->entry.nr) {
    case SYS_openat:
        return (info->entry.args[2] & (O_CREAT | O_TMPFILE)) != 0;
    case SYS_write:
    case SYS_ftruncate:
    case SYS_fsync:
    case SYS_linkat:
    case SYS_renameat2:
    case SYS_unlinkat:
    case SYS_close:
        return true;
    default:
        return false;
    }
}

/* Runs scene.lua, which writes itself to x.json if `json` is set, and kills the supervisor before the call `at` of
 * those that may change files. The number of these calls, or -1: it was killed. */
static int run_until(bool json, int at) {
    int status = 0, calls = 0;
    pid_t child = fork();
    if (child == 0) {
        if (chdir(test_folder()) == 0 && ptrace(PTRACE_TRACEME, 0, NULL, NULL) == 0)
            (void)execl(test_program(), "gray", "-q", "scene.lua", json ? "-o" : NULL, "x.json", (char *)NULL);
        _exit(99);
    }
    CHECK(waitpid(child, &status, 0) == child && WIFSTOPPED(status));
    (void)ptrace(PTRACE_SETOPTIONS, child, NULL, (void *)(PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL));
    for (long signal = 0; ptrace(PTRACE_SYSCALL, child, NULL, (void *)signal) == 0;) {
        struct ptrace_syscall_info info = {0};
        if (waitpid(child, &status, 0) != child || !WIFSTOPPED(status))
            break;
        signal = WSTOPSIG(status) == SIGTRAP ? 0 : WSTOPSIG(status);
        if (signal != (SIGTRAP | 0x80))
            continue;
        signal = 0;
        (void)ptrace(PTRACE_GET_SYSCALL_INFO, child, (void *)sizeof info, &info);
        if (info.op != PTRACE_SYSCALL_INFO_ENTRY || !may_change_files(&info) || calls++ != at)
            continue;
        (void)kill(child, SIGKILL);
        (void)waitpid(child, &status, 0);
        return -1;
    }
    CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    return calls;
}

/* Each file is the old one or the new one. */
static void check_files(const char *const *names, int count, int at) {
    for (int i = 0; i < count; i++) {
        char old[32], new[32];
        (void)snprintf(old, sizeof old, "old-%s", names[i]);
        (void)snprintf(new, sizeof new, "new-%s", names[i]);
        if (!test_same_files(names[i], old) && !test_same_files(names[i], new))
            test_fail(__FILE__, __LINE__, "killed before call %d: %s is neither the old nor the new file", at,
                      names[i]);
    }
}

/* step: of how many calls one is tried. */
static void kill_writer(const char *kind, int step) {
    static const char *const files[][2] = {{"x.stl"}, {"x.obj", "x.mtl"}, {"x.ply"}, {"x.3mf"}, {"x.json"}, {"x.glb"}};
    int which = 0;
    while (strcmp(files[which][0] + 2, kind) != 0)
        which++;
    int count = which == 1 ? 2 : 1;
    bool json = strcmp(kind, "json") == 0;
    const char *arguments = json ? "scene.lua -o x.json" : "scene.lua";
    expect(sphere_as(kind, 2), arguments, 0, NULL);
    CHECK_EQ_INT(test_run_shell("for f in x.*; do mv $f new-$f; done", ""), 0);
    expect(sphere_as(kind, 1), arguments, 0, NULL);
    CHECK_EQ_INT(test_run_shell("for f in x.*; do cp $f old-$f; done", ""), 0);
    test_write_text(test_path("scene.lua"), sphere_as(kind, 2));
    int calls = run_until(json, -1);
    CHECK(calls > 10);
    for (int at = calls - 1; at >= 0 && at > calls - 101; at -= step) {
        CHECK_EQ_INT(test_run_shell("for f in old-*; do cp $f ${f#old-}; done", ""), 0);
        (void)run_until(json, at);
        check_files(files[which], count, at);
    }
}

TEST_TIMES(a_killed_writer_leaves_the_old_model_or_the_new_one, 9) {
    static const char *const kinds[] = {"stl", "obj", "ply", "3mf", "json", "glb"};
    for (int i = 0; i < 6; i++) {
        kill_writer(kinds[i], times > 1 ? 1 : 9);
        CHECK_EQ_INT(test_run_shell("rm -f x.* old-* new-*", ""), 0);
    }
}

TEST(a_model_that_does_not_fit_on_the_disk_leaves_the_old_model_and_its_materials) {
    static const char scene[] =
        "gr.sphere{radius = 1, material = gr.material{kd = {%d, 0, 0}}}:export('x.obj', {tolerance = 0.1})\n";
    char text[256];
    (void)snprintf(text, sizeof text, scene, 0);
    expect(text, "scene.lua", 0, NULL);
    CHECK_EQ_INT(test_run_shell("cp x.obj old.obj && cp x.mtl old.mtl", ""), 0);
    (void)snprintf(text, sizeof text, scene, 1);
    test_write_text(test_path("scene.lua"), text);
    test_shell_errors("ulimit -f 2; $gray -q scene.lua", 3, "File too large");
    CHECK(test_same_files("x.obj", "old.obj") && test_same_files("x.mtl", "old.mtl"));
    expect(text, "--script-memory 1 scene.lua", 1, "--script-memory is the limit");
    CHECK(test_same_files("x.obj", "old.obj") && test_same_files("x.mtl", "old.mtl"));
}

/* 16 solids in other programs (docs/export.md). */
static void open_in(const char *program) {
    char line[8192];
    test_need_tools(program);
    (void)snprintf(line, sizeof line, "GRAY='%s' tools/check_exports.sh %s >'%s' 2>&1", test_program(), program,
                   test_path("said.txt"));
    int status = system(line);
    char *said = test_read_file(test_path("said.txt"), NULL);
    if (status != 0)
        test_fail(__FILE__, __LINE__, "%s", said ? said : program);
    free(said);
}

TEST_LONG(admesh_opens_models_without_repair) {
    open_in("admesh");
}

TEST_LONG(openscad_takes_models_as_exact_polyhedra) {
    open_in("openscad");
}

TEST_LONG(blender_finds_models_manifold) {
    open_in("blender");
}

TEST_LONG(prusa_slicer_slices_models_without_repair) {
    open_in("prusa-slicer");
}
