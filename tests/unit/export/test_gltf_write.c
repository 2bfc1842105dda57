/* Scenes as glTF: what gray reads back from the files that it writes. Tests with jansson, which reads them. */
#include "base/file.h"
#include "formats/model.h"
#include "math/elementary.h"
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef HAVE_JANSSON

static void expect(const char *scene, const char *options, int status, const char *words) {
    struct test_result result = test_gray_scene(scene, options, NULL);
    if (result.status != status)
        test_fail(__FILE__, __LINE__, "status %d: %s", result.status, result.err);
    if (words && !strstr(result.err, words) && !strstr(result.out, words))
        test_fail(__FILE__, __LINE__, "no '%s' in '%s%s'", words, result.err, result.out);
    test_free_result(&result);
}

static void read_file(struct model *model, const char *name, double time) {
    const struct model_options options = {.animated = time >= 0, .time = time};
    struct error error = {0};
    *model = (struct model){0};
    if (!model_read(model, test_path(name), &options, &error))
        test_fail(__FILE__, __LINE__, "%s: %s", name, error.text);
    for (int i = 0; i < model->warning_count; i++)
        test_fail(__FILE__, __LINE__, "%s", model->warnings[i]);
}

/* From the node to the model. */
static struct affine whole_map(const struct model *model, uint32_t node) {
    struct affine map = model_nodes(model)[node].parent_from_node.forward;
    for (uint32_t at = model_nodes(model)[node].parent; at != MODEL_NONE; at = model_nodes(model)[at].parent)
        map = affine_compose(&model_nodes(model)[at].parent_from_node.forward, &map);
    return map;
}

/* The last node of that name: of several in a row it is the innermost. */
static uint32_t find_node(const struct model *model, const char *name) {
    uint32_t found = MODEL_NONE;
    for (uint32_t i = 0; i < model->nodes.count; i++)
        found = strcmp(model_nodes(model)[i].name, name) == 0 ? i : found;
    if (found == MODEL_NONE)
        test_fail(__FILE__, __LINE__, "no node '%s'", name);
    return found == MODEL_NONE ? 0 : found;
}

static double volume_under(const struct mesh *mesh, const struct affine *map) {
    double volume = 0;
    for (uint32_t i = 0; i < mesh_triangle_count(mesh); i++) {
        struct vec3 c[3];
        uint32_t slot;
        mesh_triangle(mesh, i, c, &slot);
        for (int k = 0; k < 3; k++)
            c[k] = affine_point(map, c[k]);
        volume += vec3_dot(c[0], vec3_cross(c[1], c[2])) / 6;
    }
    return volume;
}

static double volume_of(const struct model *model, const char *name) {
    uint32_t node = find_node(model, name);
    struct affine map = whole_map(model, node);
    const uint32_t mesh = model_nodes(model)[node].mesh;
    if (mesh == MODEL_NONE)
        test_fail(__FILE__, __LINE__, "'%s' has no mesh", name);
    return mesh == MODEL_NONE ? 0 : fabs(volume_under(model_meshes(model)[mesh].mesh, &map));
}

static void check_near(const char *what, double value, double wanted) {
    if (!(fabs(value - wanted) <= 0.02 * fabs(wanted) + 1e-6))
        test_fail(__FILE__, __LINE__, "%s is %g, not %g", what, value, wanted);
}

static void check_colour(const char *what, struct colour value, double r, double g, double b) {
    check_near(what, value.r, r);
    check_near(what, value.g, g);
    check_near(what, value.b, b);
}

TEST(layers_come_back_from_a_glb_within_2_percent) {
    struct model model;
    expect(
        "local function ball(m) return gr.sphere{radius = 1, material = gr.openpbr_material(m)} end\n"
        "gr.render{width = 8, height = 8, colour = 'linear', node = gr.node{children = {\n"
        "ball{base_color = {0.8, 0.1, 0.3}, specular_roughness = 0.35, specular_ior = 1.4, specular_weight = 0.5,\n"
        "    specular_color = {1, 0.5, 0.25}},\n"
        "ball{base_color = {1, 0.8, 0.3}, base_metalness = 0.75, specular_roughness = 0.2},\n"
        "ball{transmission_weight = 0.9, specular_ior = 1.7, transmission_depth = 2, transmission_color = {0.9, 0.5, "
        "0.7}, transmission_dispersion_scale = 1, transmission_dispersion_abbe_number = 30},\n"
        "ball{coat_weight = 0.6, coat_roughness = 0.1, fuzz_weight = 0.5, fuzz_color = {0.2, 0.4, 1}, "
        "fuzz_roughness = 0.7},\n"
        "ball{thin_film_weight = 0.5, thin_film_thickness = 0.3, thin_film_ior = 1.6},\n"
        "ball{emission_luminance = 5, emission_color = {1, 0.5, 0}, geometry_opacity = 0.5},\n"
        "ball{specular_weight = 2}}}}\n",
        "-o x.glb scene.lua", 0, NULL);
    read_file(&model, "x.glb", -1);
    const struct model_material *m = model_materials(&model);
    if (model.materials.count == 8) { /* the last one is that of primitives without one */
        check_colour("base_color", m[0].kd, 0.8, 0.1, 0.3);
        check_near("roughness", m[0].roughness, 0.35);
        check_near("specular_ior", m[0].layers.specular_ior, 1.4);
        check_near("specular_weight", m[0].layers.specular_weight, 0.5);
        check_colour("specular_color", m[0].ks, 1, 0.5, 0.25);
        check_near("metalness", m[1].layers.base_metalness, 0.75);
        check_near("transmission", m[2].transmission, 0.9);
        check_near("index", m[2].layers.specular_ior, 1.7);
        check_near("dispersion", m[2].dispersion, 1.0 / 30);
        check_colour("absorption", m[2].absorption, -el_log(0.9) / 2, -el_log(0.5) / 2, -el_log(0.7) / 2);
        CHECK(!m[2].layers.thin_walled && m[0].layers.thin_walled);
        check_near("coat_weight", m[3].layers.coat_weight, 0.6);
        check_near("coat_roughness", m[3].layers.coat_roughness, 0.1);
        check_colour("fuzz", colour_scale(m[3].layers.fuzz_colour, m[3].layers.fuzz_weight), 0.1, 0.2, 0.5);
        check_near("fuzz_roughness", m[3].layers.fuzz_roughness, 0.7);
        check_near("film_weight", m[4].layers.film_weight, 0.5);
        check_near("film_thickness", m[4].layers.film_thickness, 0.3);
        check_near("film_ior", m[4].layers.film_ior, 1.6);
        check_colour("emission", m[5].ke, 5, 2.5, 0);
        check_near("opacity", m[5].dissolve, 0.5);
        check_near("largest specular_weight", m[6].layers.specular_weight, 1);
        check_near("index of twice the reflectance", m[6].layers.specular_ior, (1 + sqrt(0.08)) / (1 - sqrt(0.08)));
    } else {
        test_fail(__FILE__, __LINE__, "%zu materials", model.materials.count);
    }
    model_destroy(&model);
}

TEST(solids_and_open_surfaces_keep_their_volume_and_their_bounds_in_a_glb) {
    struct model model;
    expect(
        "gr.node{children = {gr.sphere{name = 'ball', radius = 2}, gr.box{name = 'box', min = {1, 2, 3}, max = {2, 4, "
        "6}},\n"
        "gr.torus{name = 'ring', major = 2, minor = 0.5}, gr.cone{name = 'cone', from = {0, 0, 0}, to = {0, 3, 0}, "
        "from_radius = 1, radius = 0},\n"
        "gr.cylinder{name = 'post', from = {0, 0, 0}, to = {3, 3, 0}, radius = 0.5},\n"
        "gr.difference{name = 'bored', gr.box{min = {0, 0, 0}, max = {4, 4, 4}}, gr.cylinder{from = {2, 2, -1}, to = "
        "{2, 2, 5}, radius = 1}},\n"
        "gr.disc{name = 'disc', radius = 3, normal = {0, 1, 0}},\n"
        "gr.cylinder{name = 'tube', from = {0, 0, 0}, to = {0, 1, 0}, radius = 5, open = true}}}:export('x.gltf')\n",
        "scene.lua", 0, NULL);
    read_file(&model, "x.gltf", -1);
    check_near("ball", volume_of(&model, "ball"), 4 * PI * 8 / 3);
    check_near("box", volume_of(&model, "box"), 6);
    check_near("ring", volume_of(&model, "ring"), 2 * PI * PI * 2 * 0.25);
    check_near("cone", volume_of(&model, "cone"), PI);
    check_near("post", volume_of(&model, "post"), PI * 0.25 * sqrt(18));
    check_near("bored", volume_of(&model, "bored"), 64 - 4 * PI);
    struct box disc = mesh_bounds(model_meshes(&model)[model_nodes(&model)[find_node(&model, "disc")].mesh].mesh);
    struct box tube = mesh_bounds(model_meshes(&model)[model_nodes(&model)[find_node(&model, "tube")].mesh].mesh);
    check_near("disc", disc.max.x - disc.min.x, 6);
    check_near("disc", disc.max.y - disc.min.y, 0);
    check_near("tube", tube.max.z - tube.min.z, 10);
    check_near("tube", tube.max.y - tube.min.y, 1);
    model_destroy(&model);
}

TEST(instances_share_a_mesh_and_the_tree_keeps_its_poses) {
    struct model model;
    expect("local ball = gr.sphere{name = 'ball', radius = 1}\n"
           "local arm = gr.node{name = 'arm', children = {ball}}\narm:translate(0, 2, 0)\n"
           "local all = {}\n"
           "for i = 1, 50 do local n = gr.node{name = 'n' .. i, children = {arm}}\nn:rotate('z', 7 * i)\nn:scale(1, 2, "
           "1)\n all[i] = n end\n"
           "gr.node{children = all}:export('x.glb')\n",
           "scene.lua", 0, NULL);
    read_file(&model, "x.glb", -1);
    CHECK_EQ_INT(model.meshes.count, 1);
    uint32_t count = 0;
    for (uint32_t i = 0; i < model.nodes.count; i++) {
        if (model_nodes(&model)[i].mesh == MODEL_NONE)
            continue;
        struct affine map = whole_map(&model, i);
        struct vec3 at = affine_point(&map, vec3_all(0));
        double angle = 7 * ++count * PI / 180;
        CHECK_NEAR(at.x, -2 * el_sin(angle), 1e-12); /* turned, then stretched along the parent's y */
        CHECK_NEAR(at.y, 4 * el_cos(angle), 1e-12);
    }
    CHECK_EQ_INT(count, 50);
    model_destroy(&model);
}

TEST(positions_of_instances_are_nodes_with_their_numbers_and_one_mesh) {
    struct model model;
    expect("gr.instances{name = 'row', of = gr.sphere{name = 'ball'}, at = {{1, 0, 0}, {3, 0, -2}}}:export('x.glb')\n",
           "scene.lua", 0, NULL);
    read_file(&model, "x.glb", -1);
    CHECK_EQ_INT(model.meshes.count, 1);
    struct affine first = whole_map(&model, find_node(&model, "row [1]")),
                  second = whole_map(&model, find_node(&model, "row [2]"));
    check_near("x of the first", first.m[0][3], 1);
    check_near("x of the second", second.m[0][3], 3);
    check_near("z of the second", second.m[2][3], -2);
    model_destroy(&model);
}

TEST(the_camera_and_the_lights_come_back_from_a_glb) {
    struct model model;
    const double lumens = 683 * PI;
    expect("gr.render{node = gr.sphere{radius = 1}, width = 300, height = 200, eye = {1, 2, 9}, view = {0, 0, -1}, fov "
           "= 40,"
           " colour = 'linear', lights = {\n"
           "gr.light{position = {1, 2, 3}, colour = {1, 0.5, 0.25}, falloff = {0, 0, 0.5}},\n"
           "gr.directional_light{direction = {0, -1, 0}, colour = {0.5, 1, 2}},\n"
           "gr.spot_light{position = {0, 5, 0}, direction = {1, 0, 0}, inner = 20, outer = 30, colour = {3, 3, 3}, "
           "intensity = 2}}}\n",
           "-o x.glb scene.lua", 0, NULL);
    read_file(&model, "x.glb", -1);
    const struct model_light *light = model_lights(&model);
    const struct model_camera *camera = model.cameras.items;
    if (model.lights.count == 3 && model.cameras.count == 1) {
        check_colour("point", light[0].intensity, 2 * lumens, lumens, lumens / 2);
        check_colour("sun", light[1].intensity, lumens / 2, lumens, 2 * lumens);
        check_colour("spot", light[2].intensity, 6 * lumens, 6 * lumens, 6 * lumens);
        check_near("inner", light[2].inner, 20 * PI / 180);
        check_near("outer", light[2].outer, 30 * PI / 180);
        struct vec3 along = affine_vector(&light[1].model_from_light, vec3_make(0, 0, -1));
        CHECK_NEAR(along.y, -1, 1e-12);
        along = affine_vector(&light[2].model_from_light, vec3_make(0, 0, -1));
        CHECK_NEAR(along.x, 1, 1e-12);
        struct vec3 eye = affine_point(&camera->model_from_camera, vec3_all(0));
        CHECK(fabs(eye.x - 1) < 1e-12 && fabs(eye.y - 2) < 1e-12 && fabs(eye.z - 9) < 1e-12);
        CHECK_NEAR(camera->vertical_angle, 40 * PI / 180, 1e-12);
        CHECK_NEAR(camera->aspect, 1.5, 1e-12);
    } else {
        test_fail(__FILE__, __LINE__, "%zu lights, %zu cameras", model.lights.count, model.cameras.count);
    }
    model_destroy(&model);
}

TEST(a_ball_of_light_is_a_point_light_in_its_middle_in_a_glb) {
    struct model model;
    const double lumens = 683 * PI;
    expect("gr.render{node = gr.sphere{}, width = 8, height = 8, colour = 'linear', lights = {\n"
           "gr.spherical_light{position = {1, 2, 3}, radius = 0.5, emission = {4, 2, 1}}}}\n",
           "-o x.glb scene.lua", 0, "a light with an extent is a point in its middle");
    read_file(&model, "x.glb", -1);
    const struct model_light *light = model_lights(&model);
    CHECK_EQ_INT(model.lights.count, 1);
    if (model.lights.count == 1) {
        struct vec3 at = affine_point(&light->model_from_light, vec3_all(0));
        check_colour("ball", light->intensity, lumens, lumens / 2, lumens / 4);
        CHECK(at.x == 1 && at.y == 2 && at.z == 3);
    }
    model_destroy(&model);
}

TEST(an_area_light_without_area_is_left_out_of_a_glb) {
    struct model model;
    expect("gr.render{node = gr.sphere{}, width = 8, height = 8, lights = {\n"
           "gr.area_light{corner = {0, 3, 0}, v1 = {1, 0, 0}, v2 = {2, 0, 0}, emission = {1, 1, 1}}}}\n",
           "-o x.glb scene.lua", 0, NULL);
    read_file(&model, "x.glb", -1);
    CHECK_EQ_INT(model.lights.count, 0);
    model_destroy(&model);
}

static struct vec3 position_of(const char *file, const char *name, double time) {
    struct model model;
    read_file(&model, file, time);
    struct affine map = whole_map(&model, find_node(&model, name));
    struct vec3 at = affine_point(&map, vec3_make(1, 0, 0));
    model_destroy(&model);
    return at;
}

TEST(velocities_and_spins_are_animations_with_the_same_positions) {
    expect("local n = gr.sphere{name = 'mover', radius = 1}\nn:translate(1, 0, 0)\nn:velocity({2, -3, 1})\n"
           "local s = gr.torus{name = 'spinner', major = 1, minor = 0.2}\ns:scale(2, 1, 1)\ns:spin({0, 0, 1}, 250)\n"
           "gr.node{children = {n, s}}:export('x.glb')\n",
           "scene.lua", 0, NULL);
    for (int i = 0; i <= 10; i++) {
        double t = i / 10.0, angle = 250 * t * PI / 180;
        struct vec3 mover = position_of("x.glb", "mover", t), spinner = position_of("x.glb", "spinner", t);
        CHECK(fabs(mover.x - 2 - 2 * t) < 1e-5 && fabs(mover.y + 3 * t) < 1e-5 && fabs(mover.z - t) < 1e-5);
        CHECK_NEAR(spinner.x, 2 * el_cos(angle), 1e-5);
        CHECK_NEAR(spinner.y, el_sin(angle), 1e-5);
    }
}

TEST(the_frames_of_an_animation_are_the_keys_of_a_glb) {
    expect("local hand = gr.box{name = 'hand', min = {0, 0, 0}, max = {1, 1, 1}}\n"
           "gr.frames{count = 11, fps = 10, draw = function(t)\n"
           "hand:reset()\nhand:rotate('z', 90 * t)\nhand:translate(5 * t * t, 0, 0)\n"
           "return {node = gr.node{children = {hand}}, width = 8, height = 8, eye = {0, 0, 9 + t}, view = {0, 0, -1}} "
           "end}\n",
           "-o x.glb scene.lua", 0, NULL);
    for (int i = 0; i <= 10; i++) {
        double t = i / 10.0;
        struct vec3 hand = position_of("x.glb", "hand", t), camera = position_of("x.glb", "camera", t);
        CHECK_NEAR(hand.x, 5 * t * t + el_cos(PI / 2 * t), 1e-5);
        CHECK_NEAR(hand.y, el_sin(PI / 2 * t), 1e-5);
        CHECK_NEAR(camera.z, 9 + t, 1e-5);
    }
}

/* A rectangle with the picture of a script. */
static void check_copied_picture(void) {
    struct model model;
    expect("gr.render{node = gr.sphere{}, width = 8, height = 6, file = 'ball.png'}\n", "scene.lua", 0, NULL);
    expect("local ball = gr.texture{file = 'ball.png', encoding = 'srgb'}\n"
           "gr.render{width = 8, height = 8, colour = 'linear', node = gr.rectangle{\n"
           "    material = gr.openpbr_material{base_color = ball}}}\n",
           "-o copied.glb scene.lua", 0, NULL);
    struct test_picture ball = test_read_picture(test_path("ball.png"));
    read_file(&model, "copied.glb", -1);
    const struct image *image = model_materials(&model)[0].map_kd.image;
    CHECK(image && image_width(image) == 8 && image_height(image) == 6);
    for (uint32_t i = 0; image && i < 48; i++) {
        struct rgba texel = image_texel(image, i % 8, i / 8);
        CHECK_NEAR(255 * texel.r, ball.rgb[3 * i], 1e-6);
        CHECK_NEAR(255 * texel.b, ball.rgb[3 * i + 2], 1e-6);
    }
    free(ball.rgb);
    model_destroy(&model);
}

/* Shapes of one colour that no light changes (KHR_materials_unlit), before others; one sample for a pixel. */
TEST(a_glb_that_gray_reads_back_has_the_outlines_of_the_script) {
    static const char scene[] =
        "local red = gr.material{kd = {1, 0, 0}, lit = false}\n"
        "local function at(i, node) return node:set_material(red):translate(3 * (i % 4) - 4.5, 3 * (i // 4) - 3, 0) "
        "end\n"
        "gr.render{eye = {3, 4, 16}, target = {0, 0, 0}, fov = 36, node = gr.node{children = {at(0, gr.sphere{}),\n"
        "    at(1, gr.torus{major = .8, minor = .3}), at(2, gr.cone{from = {0, 1, 0}, to = {0, -1, 0}}),\n"
        "    at(3, gr.difference{gr.sphere{}, gr.box{min = {0, 0, 0}, max = {2, 2, 2}}}),\n"
        "    at(4, gr.cylinder{from = {0, -1, 0}, to = {.5, 1, 0}, radius = .6}), at(5, gr.disc{radius = 1, normal = "
        "{0, 1, 1}}),\n"
        "    at(6, gr.prism{outline = {{-1, -1}, {1, -1}, {0, 1}}, to = .5}), at(7, gr.box{min = {-1, -.5, -.5}, max = "
        "{1, .5, .5}}:rotate('z', 30)),\n"
        "    at(8, gr.height_field{heights = {{.2, .8, .3}, {.5, .1, .9}}}), at(9, gr.sweep{points = {{-1, 0, 0}, {0, "
        "1, 0}, {1, 0, 0}}, radii = .2}),\n"
        "    at(10, gr.ellipsoid{radii = {1, .5, .7}}), at(11, gr.polygon{points = {{-1, -1, 0}, {1, -1, 0}, {0, .2, "
        "0}, {1, 1, 0}, {-1, 1, 0}}})}}}\n";
    expect(scene, "-ss 1 --size 160x120 -o script.png scene.lua", 0, NULL);
    expect(scene, "-o x.glb scene.lua", 0, NULL);
    expect(scene, "-ss 1 --integrator whitted --size 160x120 -o back.png x.glb", 0, NULL);
    struct test_picture a = test_read_picture(test_path("script.png")), b = test_read_picture(test_path("back.png"));
    int covered = 0, differ = 0;
    for (int i = 0; i < 160 * 120; i++) {
        bool first = a.rgb[3 * i + 1] == 0, second = b.rgb[3 * i + 1] == 0;
        covered += first;
        differ += first != second;
    }
    if (covered < 3000 || differ > 0.01 * covered)
        test_fail(__FILE__, __LINE__, "%d of %d pixels differ", differ, covered);
    free(a.rgb);
    free(b.rgb);
}

TEST(patterns_and_functions_are_baked_and_pictures_are_copied) {
    struct model model;
    check_copied_picture();
    expect("local function stripes(p) if p.x > 0 then return {1, 0, 0} end return {0, 0, 1} end\n"
           "gr.render{width = 8, height = 8, colour = 'linear', node = gr.box{min = {-1, -1, -1}, max = {1, 1, 1},\n"
           "    material = gr.openpbr_material{base_color = stripes}}}\n",
           "-o x.glb scene.lua", 0, NULL);
    read_file(&model, "x.glb", -1);
    const struct model_material *m = model_materials(&model);
    CHECK(model.materials.count == 2 && m[0].map_kd.image);
    if (m[0].map_kd.image) {
        uint32_t size = image_width(m[0].map_kd.image), red = 0, blue = 0;
        CHECK_EQ_INT(size, 1024);
        for (uint32_t i = 0; i < size * size; i++) {
            struct rgba texel = image_texel(m[0].map_kd.image, i % size, i / size);
            red += texel.r == 1 && texel.b == 0;
            blue += texel.b == 1 && texel.r == 0;
        }
        CHECK(red + blue > 0.95 * size * size && fabs((double)red - blue) < 0.01 * size * size);
    }
    model_destroy(&model);
}

TEST(a_material_whose_bumps_alone_are_baked_is_no_metal) {
    struct model model;
    expect("local m = gr.openpbr_material{base_color = {0.5, 0.5, 0.5}, specular_roughness = 0.4}\n"
           "gr.render{width = 8, height = 8, colour = 'linear', node = gr.sphere{radius = 1,\n"
           "    material = m}:set_bump(gr.bump(function(p) return 0.1 * gr.step(p.x, 0) end))}\n",
           "-o x.glb scene.lua", 0, NULL);
    read_file(&model, "x.glb", -1);
    CHECK(model.materials.count > 0);
    if (model.materials.count > 0) {
        check_near("metalness", model_materials(&model)[0].layers.base_metalness, 0);
        check_near("roughness", model_materials(&model)[0].roughness, 0.4);
    }
    model_destroy(&model);
}

TEST(what_gltf_lacks_is_left_out_with_one_warning_each) {
    expect("gr.node{children = {gr.plane{name = 'ground', normal = {0, 1, 0}}, gr.plane{name = 'wall', normal = {1, 0, "
           "0}}, gr.sphere{}}}:export('x.glb')\n",
           "scene.lua", 0, "warning: 'ground' and 1 more: has no end");
    expect("gr.node{children = {gr.sphere{}, gr.intersection('gap', gr.sphere{}, gr.sphere{centre = {3, 0, 0}}),\n"
           "gr.intersection('hole', gr.sphere{}, gr.difference(gr.sphere{radius = 5}, gr.sphere{radius = "
           "4}))}}:export('x.glb')\n",
           "scene.lua", 0, "warning: 'gap' and 1 more: is empty");
    expect("gr.render{node = gr.sphere{}, width = 8, height = 8, ambient = {0.1, 0.1, 0.1}}\n", "-o y.glb scene.lua", 0,
           "gr.render: warning: the ambient light is left out");
    expect("gr.node('nothing'):export('z.glb')\n", "scene.lua", 0, NULL);
    CHECK(file_is_regular(test_path("z.glb")));
    expect("gr.sphere{}:export('../x.glb')\n", "scene.lua", 1, "models of scripts must be below the working directory");
    expect("gr.render{node = gr.sphere{}, width = 8, height = 8}\n", "--check-print -o x.glb scene.lua", 2,
           "--check-print is for solids");
    test_write_text(test_path("mine.glb"), "my notes\n");
    expect("gr.sphere{}:export('mine.glb')\n", "scene.lua", 1, "exists already and is not a model");
}

TEST(equal_solids_share_a_mesh_unless_a_tolerance_is_finer_for_the_larger_one) {
    static const char scene[] =
        "local function cap(r) return gr.intersection{gr.sphere{radius = 1}, gr.box{min = {-2, -2, 0}, max = {2, 2, "
        "2}}}:scale(r, r, r) end\n"
        "gr.node{children = {cap(1), cap(1):translate(3, 0, 0), cap(1.5):translate(16, 0, 0)}}:export('x.glb'%s)\n";
    for (uint32_t i = 0; i < 2; i++) {
        char text[512];
        struct model model;
        (void)snprintf(text, sizeof text, scene, i == 0 ? "" : ", {tolerance = 0.01}");
        expect(text, "scene.lua", 0, NULL);
        read_file(&model, "x.glb", -1);
        CHECK_EQ_INT(model.meshes.count, i + 1);
        model_destroy(&model);
    }
}

/* Of a solid with details of all sizes, a Julia set of quaternions. */
TEST_LONG(a_fractal_has_a_coarser_mesh_in_a_glb_and_a_warning) {
    struct model model;
    expect("local function f(p)\n"
           "    local _, x, y, z, w, slope = gr.loop(6, 1, p.x, p.y, p.z, 0.0, 1.0, function(_, _, x, y, z, w, slope)\n"
           "        local square = x * x + y * y + z * z + w * w\n"
           "        if square > 256 then return 0, x, y, z, w, slope end\n"
           "        return 1, x * x - y * y - z * z - w * w - 0.2, 2 * x * y + 0.6, 2 * x * z + 0.2, 2 * x * w + 0.2,\n"
           "            2 * math.sqrt(square) * slope\n"
           "    end)\n"
           "    local square = x * x + y * y + z * z + w * w\n"
           "    return gr.max(0.25 * math.log(square) * math.sqrt(square) / slope, 0.0) - 0.001\n"
           "end\n"
           "gr.implicit{name = 'julia', f = f, radius = 1.6, distance = true}:export('x.glb')\n",
           "scene.lua", 0, "'julia': has finer details than its mesh");
    read_file(&model, "x.glb", -1);
    const double volume = volume_of(&model, "julia");
    CHECK(volume > 1 && volume < 4);
    model_destroy(&model);
}

TEST(the_bytes_of_a_glb_depend_on_no_number_of_threads) {
    static const char scene[] =
        "gr.node{children = {gr.difference{gr.sphere{radius = 2}, gr.box{min = {0, 0, 0}, max = {3, 3, 3}}},\n"
        "gr.sphere{radius = 1, material = gr.marble_pnd_material(gr.material({1, 1, 1}, {0, 0, 0}, 1), 1, 5, 3, 0, {1, "
        "0, 0})}}}:export('%s.glb')\n";
    char text[512];
    (void)snprintf(text, sizeof text, scene, "one");
    expect(text, "-j 1 scene.lua", 0, NULL);
    (void)snprintf(text, sizeof text, scene, "three");
    expect(text, "-j 3 scene.lua", 0, NULL);
    CHECK(test_same_files("one.glb", "three.glb"));
}

/* What other programs say (docs/export.md); a program that is not installed is left out. */
static void check_by(const char *program) {
    char line[8192];
    (void)snprintf(line, sizeof line, "GRAY='%s' tools/check_gltf.sh %s >'%s' 2>&1", test_program(), program,
                   test_path("said.txt"));
    int status = system(line);
    char *said = test_read_file(test_path("said.txt"), NULL);
    if (said && strstr(said, "is not installed"))
        test_skip("%s is not installed", program);
    if (status != 0)
        test_fail(__FILE__, __LINE__, "%s", said ? said : program);
    free(said);
}

TEST_LONG(the_khronos_validator_finds_nothing_in_the_demos_as_gltf) {
    check_by("validator");
}

TEST_LONG(blender_draws_gltf_files_with_the_outlines_and_the_colours_of_gray) {
    check_by("blender");
}

#endif
