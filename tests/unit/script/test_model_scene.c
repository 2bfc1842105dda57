/* Models on the command line, and the cameras and lights of gr.model. */
#include "tests/harness.h"

#include "image/picture_file.h"
#include "session/options.h"

#include <stdio.h>

#define SMALL " -q --size 48x27 --spp 1 --denoise=none "
#define TRIANGLE "v -1 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"

/* A triangle with a camera in front of it and a light; its numbers are between the lines. */
static void write_gltf(const char *name, const char *nodes) {
    char text[4096];
    (void)snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"extensionsUsed\":[\"KHR_lights_punctual\"],"
        "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"directional\",\"intensity\":2000,"
        "\"name\":\"Sun\"}]}},\"scenes\":[{\"nodes\":[0,1,2,3]}],"
        "\"nodes\":[{\"mesh\":0},{\"camera\":0,\"translation\":[0,0.5,5]},{\"camera\":1,\"translation\":[0,0.25,4]},"
        "%s],\"cameras\":[{\"name\":\"Near\",\"type\":\"perspective\",\"perspective\":{\"yfov\":0.5,\"znear\":1}},"
        "{\"name\":\"Flat\",\"type\":\"orthographic\",\"orthographic\":{\"xmag\":2,\"ymag\":1,\"znear\":1,\"zfar\":9}}]"
        ","
        "\"materials\":[{\"name\":\"Paint\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0}]}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","
        "\"min\":[-1,0,0],\"max\":[1,1,0]}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
        "\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"
        "AACAvwAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}",
        nodes);
    test_write_text(test_path(name), text);
}
#define LIGHT_NODE "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}"

TEST(a_model_is_a_picture_of_its_name_whatever_its_kind) {
    test_need_json();
    test_write_text(test_path("o.obj"), TRIANGLE);
    test_write_text(
        test_path("p.PLY"),
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n-1 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    test_write_text(test_path("s.stl"), "solid s\nfacet normal 0 0 1\nouter loop\nvertex -1 0 0\nvertex 1 0 0\n"
                                        "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n");
    write_gltf("g.gltf", LIGHT_NODE);
    test_shell("gzip -c o.obj >z.v1.obj.gz; mkdir sub; cp o.obj sub/below.obj", 0, "");
    test_shell("$gray" SMALL "o.obj p.PLY s.stl g.gltf z.v1.obj.gz sub/below.obj && ls *.png | tr '\\n' ' '", 0,
               "below.png g.png o.png p.png s.png z.v1.png ");
}

TEST(a_model_is_path_traced_and_denoised_at_960_by_540_unless_options_say_otherwise) {
    test_write_text(test_path("o.obj"), TRIANGLE);
    test_shell("$gray --check o.obj", 0, "o.png: 960 x 540");
    test_shell("$gray --check --size 64x64 -o other.png o.obj", 0, "other.png: 64 x 64");
    test_write_text(test_path("as.lua"), "gr.render{node = gr.mesh{file = 'o.obj'}}");
    test_shell("$gray -q --size 64x36 o.obj && mv o.png a.png && $gray -q --size 64x36 --integrator path --denoise "
               "--spp 24 o.obj && cmp a.png o.png",
               0, "");
    test_shell("$gray --size 64x36 --integrator whitted o.obj", 0, "");
}

TEST(a_model_that_is_scaled_or_moved_has_the_same_picture) {
    test_write_text(test_path("one.obj"), "v -1 0 0\nv 1 0 0\nv 0 1 0.5\nv 0 0 1\nf 1 2 3\nf 1 4 2\n");
    test_write_text(test_path("huge.obj"), "v -1048576 0 0\nv 1048576 0 0\nv 0 1048576 524288\nv 0 0 1048576\n"
                                           "f 1 2 3\nf 1 4 2\n");
    test_write_text(test_path("tiny.obj"), "v -0.0001220703125 0 0\nv 0.0001220703125 0 0\n"
                                           "v 0 0.0001220703125 0.00006103515625\nv 0 0 0.0001220703125\n"
                                           "f 1 2 3\nf 1 4 2\n");
    test_write_text(test_path("far.obj"),
                    "v 1023 -64 0\nv 1025 -64 0\nv 1024 -63 0.5\nv 1024 -64 1\nf 1 2 3\nf 1 4 2\n");
    test_shell("$gray" SMALL "one.obj huge.obj tiny.obj far.obj && cmp one.png huge.png && cmp one.png tiny.png && "
               "$gray compare -q --threshold 2 one.png far.png",
               0, "");
}

TEST(the_ground_of_a_model_has_the_colour_of_the_background_but_for_the_shadow) {
    /* 0.3 of light is 149 of 255. */
    test_write_text(test_path("o.obj"), TRIANGLE);
    test_write_text(test_path("corner.lua"), "local m = gr.texture{file = 'o.png'}\nlocal sum = 0\n"
                                             "for y = 0, 1, 0.125 do sum = sum + m:at(0.03, y).x end\n"
                                             "print(math.abs(sum / 9 * 255 - 149) < 2)");
    test_shell("$gray -q --size 96x54 --spp 64 o.obj && $gray -q corner.lua", 0, "true");
}

TEST(z_is_up_in_stl_files_and_where_up_says_so) {
    test_write_text(test_path("y.obj"), "v -1 0 0\nv 1 0 0\nv 0 1 0.5\nf 1 2 3\n");
    test_write_text(test_path("z.obj"), "v -1 0 0\nv 1 0 0\nv 0 -0.5 1\nf 1 2 3\n");
    test_write_text(test_path("z.stl"), "solid s\nfacet normal 0 0 1\nouter loop\nvertex -1 0 0\nvertex 1 0 0\n"
                                        "vertex 0 -0.5 1\nendloop\nendfacet\nendsolid s\n");
    test_shell("$gray" SMALL "y.obj z.stl && cmp y.png z.png && $gray" SMALL
               "--up z -o up.png z.obj && cmp y.png up.png "
               "&& $gray" SMALL "--up y -o lies.png z.stl && ! cmp -s y.png lies.png",
               0, "");
}

TEST(a_name_that_is_taken_becomes_one_of_a_render) {
    test_write_text(test_path("tex.mtl"), "newmtl a\nKd 1 1 1\nmap_Kd tex.png\n");
    test_write_text(test_path("tex.obj"),
                    "mtllib tex.mtl\nusemtl a\nv -1 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                    "f 1/1 2/2 3/3\n");
    test_write_text(test_path("tex.lua"), "gr.render{node = gr.sphere{}, width = 8, height = 8}");
    test_shell("$gray -q tex.lua && cp tex.png kept.png && $gray" SMALL "tex.obj && cmp tex.png kept.png && "
               "ls tex-render.png",
               0, "tex-render.png");
    test_write_text(test_path("a.obj"), TRIANGLE);
    test_shell("mkdir b; cp a.obj b; gzip -c a.obj >a.obj.gz; $gray" SMALL "a.obj b/a.obj a.obj.gz && ls a*.png | "
               "tr '\\n' ' '",
               0, "a-render-2.png a-render.png a.png");
}

TEST(a_model_of_the_command_line_has_its_own_camera_and_lights) {
    test_need_json();
    write_gltf("g.gltf", LIGHT_NODE);
    /* Whatever the light of the lights is, the model scene has the exposure and the background from it. */
    test_write_text(
        test_path("as.lua"),
        "local m, light = gr.model('g.gltf'), 2000 / (683 * math.pi)\n"
        "gr.render{node = m, eye = {0, 0.5, 5}, view = {0, 0, -1}, up = {0, 1, 0}, fov = 0.5 * (180 / math.pi),\n"
        "    lights = {m.lights.Sun}, background = {light / 10, light / 10, light / 10},\n"
        "    integrator = 'path', exposure = math.log(1 / light, 2)}");
    test_shell("$gray" SMALL "g.gltf as.lua && cmp g.png as.png", 0, "");
    test_write_text(
        test_path("flat.lua"),
        "local m, light = gr.model('g.gltf'), 2000 / (683 * math.pi)\nlocal c = m.cameras[2]\n"
        "print(c.name, m.cameras.Flat == c, #m.cameras, #m.lights)\n"
        "gr.render{node = m, eye = c.eye, view = c.view, up = c.up, projection = c.projection,\n"
        "    view_height = c.view_height, lights = m.lights, background = {light / 10, light / 10, light / 10},\n"
        "    integrator = 'path', exposure = math.log(1 / light, 2)}");
    test_shell("$gray" SMALL "--camera Flat g.gltf && mv g.png a.png && $gray" SMALL
               "--camera 2 g.gltf && cmp a.png g.png"
               " && $gray" SMALL "flat.lua && cmp g.png flat.png",
               0, "Flat\ttrue\t2\t1");
}

/* A triangle that rises by 4 within a second, and sinks within another. */
TEST(the_fitted_camera_of_an_animated_model_does_not_move) {
    test_need_json();
    test_write_text(
        test_path("up.gltf"),
        "{\"asset\":{\"version\":\"2.0\"},\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}],"
        "\"samplers\":[{\"input\":1,\"output\":2}]}],\"accessors\":["
        "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[-1,0,0],\"max\":[1,1,0]},"
        "{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"SCALAR\",\"min\":[0],\"max\":[2]},"
        "{\"bufferView\":2,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],\"bufferViews\":["
        "{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":12},"
        "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":36}],"
        "\"buffers\":[{\"byteLength\":84,\"uri\":\"data:application/octet-stream;base64,"
        "AACAvwAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAABAAAAAAAAAAAAAAAAAAAAAAAAAgEAAAAAA"
        "AAAAAAAAAAAAAAAA\"}]}");
    test_shell("$gray" SMALL "--integrator whitted --fps 1 --frames 3 up.gltf && cmp up.0001.png up.0003.png &&"
               " ! cmp up.0001.png up.0002.png",
               0, "up.0001.png up.0002.png differ");
}

TEST(check_lists_what_a_model_has) {
    test_need_json();
    write_gltf("g.gltf", LIGHT_NODE);
    test_shell("$gray --check g.gltf", 0,
               "g.gltf: cameras: 'Near', 'Flat'\ng.gltf: lights: 'Sun'\ng.gltf: materials: 'Paint'\n"
               "g.gltf: animations: none\n");
}

TEST(a_camera_that_is_not_there_is_wrong_usage_and_names_those_that_are) {
    test_need_json();
    write_gltf("g.gltf", LIGHT_NODE);
    test_write_text(test_path("o.obj"), TRIANGLE);
    test_write_text(test_path("a.lua"), "gr.render{node = gr.sphere{}}");
    test_shell("$gray --camera Far g.gltf", 2, "--camera: g.gltf has no camera 'Far': it has 1 'Near', 2 'Flat'");
    test_shell("$gray --camera 3 g.gltf", 2, "it has 1 'Near', 2 'Flat'");
    test_shell("$gray --camera 1 o.obj", 2, "--camera: o.obj has no camera '1': it has no cameras");
    test_shell("$gray --camera Near o.obj a.lua", 2, "a.lua is a script: the field eye of its gr.render");
    test_shell("$gray --up z a.lua", 2, "a.lua is a script: the field up of its gr.render");
}

TEST(cameras_and_lights_that_nothing_uses_are_one_notice) {
    test_need_json();
    write_gltf("g.gltf", LIGHT_NODE);
    const char *says =
        "a.lua: g.gltf has 2 cameras and 1 light that nothing uses: the field cameras and the field lights of "
        "gr.model\n";
    test_write_text(test_path("a.lua"), "gr.mesh{file = 'g.gltf'} gr.model('g.gltf')");
    test_shell("$gray --check a.lua 2>&1 | grep -c uses", 0, "1\n");
    test_shell("$gray --check a.lua", 0, says);
    test_write_text(test_path("a.lua"), "gr.mesh{file = 'g.gltf'} print(#gr.model('g.gltf').lights)");
    test_shell("$gray --check a.lua 2>&1 | grep -c uses", 1, "0\n");
}

TEST(a_file_without_a_model_is_one_line_and_status_1) {
    test_write_text(test_path("empty.obj"), "");
    test_write_text(test_path("line.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    test_write_text(test_path("b.obj"), "v 0 0\n");
    test_shell("$gray empty.obj", 1, "empty.obj: no faces in this file\n");
    test_shell("$gray line.obj", 1, "line.obj: no face of this file has an area\n");
    test_shell("$gray b.obj 2>&1 | wc -l", 0, "1\n");
    test_shell("$gray none.glb", 1, "none.glb: cannot be read");
}

TEST(a_model_whose_nodes_are_nested_too_deeply_has_a_message_that_says_so) {
    test_need_json();
    write_gltf("g.gltf", LIGHT_NODE);
    test_shell(
        "awk '{ for (i = 4; i < 2100; i++) s = s \",{\\\"children\\\":[\" i + 1 \"],\\\"mesh\\\":0}\"; "
        "sub(/0,1,2,3/, \"0,1,2,3,4\"); sub(/],\"cameras/, s \",{}&\"); print }' g.gltf >deep.gltf; $gray deep.gltf",
        1, "deep.gltf: nodes are nested more than 2000 deep, or in a cycle\n");
}

TEST(a_sky_of_the_command_line_lights_models_and_scripts) {
    test_write_text(test_path("o.obj"), TRIANGLE);
    test_write_text(test_path("sky.lua"),
                    "gr.render{node = gr.sphere{radius = 0.01}, eye = {0, 0, 5}, view = {0, 0, -1},\n"
                    "    projection = 'panorama', width = 64, height = 32, background = {0.2, 0.3, 0.9}}");
    test_write_text(test_path("own.lua"), "gr.render{node = gr.sphere{}, sky = 'sky.hdr'}");
    test_write_text(test_path("other.lua"),
                    "gr.render{node = gr.sphere{}, background = {1, 0, 0}, file = 'other.png'}");
    test_shell("$gray -q -o sky.hdr sky.lua && $gray" SMALL "--integrator path own.lua && $gray" SMALL
               "--integrator path --sky sky.hdr other.lua && cmp own.png other.png && $gray" SMALL
               "--sky sky.hdr o.obj",
               0, "");
    test_shell("$gray --sky none.hdr o.obj", 1, "--sky: cannot find 'none.hdr'");
}

TEST(every_ending_that_gray_writes_is_written_and_others_are_wrong_usage_that_lists_them) {
    test_need_exr();
    static const char *const pictures[] = {PICTURE_FORMATS(LIST_WORD)};
    static const char *const others[] = {"part.step", "x.bmp",     "x.txt",     "x%d.jpg",
                                         "x##.tif",   "dir/x.svg", "x.png.bmp", "x."};
    char command[256];
    test_write_text(test_path("a.lua"), "gr.render{node = gr.sphere{}, width = 8, height = 8}");
    for (size_t i = 0; i < sizeof pictures / sizeof *pictures; i++) {
        (void)snprintf(command, sizeof command, "$gray -q -o x%s a.lua && ls x%s", pictures[i], pictures[i]);
        test_shell(command, 0, pictures[i]);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        (void)snprintf(command, sizeof command, "$gray -q -o %s a.lua", others[i]);
        test_shell(command, 2, "a name ends in .png, .pfm, .hdr, .exr or .lf, or for animations in .apng, .gif");
    }
    /* Also where a file has that name. */
    test_shell("touch e.bmp; $gray -q -o e.bmp a.lua", 2, "gray writes no .bmp files");
    test_shell("$gray -q a.lua && cp a.png t.bmp; $gray -q -o t.bmp a.lua", 2, "gray writes no .bmp files");
    test_write_text(test_path("b.lua"), "gr.render{node = gr.sphere{}, width = 8, height = 8, file = 'x.bmp'}");
    test_shell("$gray -q b.lua", 1, "the name of a picture ends in .png, .pfm, .hdr, .exr or .lf");
    test_shell("test -s e.bmp || ls *.bmp *.step 2>/dev/null | tr '\\n' ' '", 0, "e.bmp t.bmp");
}
