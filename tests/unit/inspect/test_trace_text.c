/* Pixel traces and scene dumps as text: a scene with one object of every kind produces the words for every kind, and
 * the bytes at the end of a trace are those of the picture. */
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char scene[] =
    "local plain = gr.material({0.6, 0.5, 0.4}, {0.4, 0.4, 0.4}, 20)\n"
    "local root, x = gr.node('root'), -13\n"
    "local function put(node) node:translate(x, 0, 0) root:add_child(node) x = x + 2 return node end\n"
    /* a rough mirror with light of its own */
    "put(gr.sphere{name = 'rough', radius = 0.8, material = gr.rr_material{kd = {0.2, 0.2, 0.2}, ks = {1, 1, 1}, "
    "shininess = 9, reflect = 0.6, refract = 0, ior = 1.3, roughness = 0.3, emission = {0.1, 0, 0}}})\n"
    /* glass around glass */
    "local glass = gr.rr_material({0, 0, 0}, {1, 1, 1}, 50, 0.3, 0.9, 1.5)\n"
    "put(gr.sphere{name = 'shell', radius = 0.9, material = gr.difresnel_material(glass)}):add_child(gr.sphere{name = "
    "'core', radius = 0.6, material = gr.rr_material({0, 0, 0}, {1, 1, 1}, 50, 0, 0.9, 1.2)})\n"
    /* without Fresnel's formulas, at an angle beyond the critical one */
    "put(gr.cube{name = 'block', corner = {-0.6, -0.6, -0.6}, size = 1.2, material = glass}:rotate('y', 30))\n"
    "put(gr.cube{name = 'prism', corner = {-0.6, -0.6, -0.6}, size = 1.2, material = "
    "gr.difresnel_material(glass)}:rotate('y', 40))\n"
    /* a combined solid */
    "put(gr.difference('cut', gr.sphere{material = plain, radius = 0.9}, gr.cube{corner = {0, 0, 0}, material = "
    "plain}))\n"
    /* a mesh from a file: names of materials, coordinates, interpolated normals */
    "put(gr.mesh{name = 'file', file = 'roof.obj', smooth = 180})\n"
    /* holes, and a decorator that changes nothing */
    "put(gr.rectangle{name = 'lace', corner = {-0.8, -0.8, 0}, along = {1.6, 0, 0}, up = {0, 1.6, 0}, material = "
    "gr.image_material{material = plain, image = 'holes.pfm', channel = 'opacity'}})\n"
    "put(gr.sphere{name = 'black', radius = 0.8, material = gr.image_material{material = plain, image = 'black.pfm', "
    "channel = 'emission'}})\n"
    /* seen from behind */
    "put(gr.mesh{name = 'back', material = plain, verts = {{-0.8, -0.8, 0}, {0, 0.8, 0}, {0.8, -0.8, 0}}, faces = {{0, "
    "1, 2}}})\n"
    "put(gr.mesh{name = 'both', material = gr.material{kd = {0.5, 0.5, 0.5}, ks = {0, 0, 0}, shininess = 1, two_sided "
    "= "
    "true}, verts = {{-0.8, -0.8, 0}, {0, 0.8, 0}, {0.8, -0.8, 0}}, faces = {{0, 1, 2}}})\n"
    "put(gr.cube{name = 'fast', corner = {-0.5, -0.5, -0.5}, material = plain}):velocity(0, 0.4, 0)\n"
    "put(gr.sphere{name = 'nothing', radius = 0.7, material = gr.material({0, 0, 0}, {0, 0, 0}, 1)})\n"
    "local bulb = gr.mesh{name = 'bulb', material = gr.material{kd = {0, 0, 0}, ks = {0, 0, 0}, shininess = 1, "
    "emission "
    "= {1, 1, 1}}, verts = {{-2, 4, 0}, {0, 4, 1}, {2, 4, 0}}, faces = {{0, 1, 2}}}\n"
    "root:add_child(bulb)\n"
    "local sky = gr.sky_gradient{stops = {{-1, 0.2, 0.2, 0.3}, {1, 0.4, 0.5, 0.7}}}\n"
    "local lights = {gr.light({0, 9, 9}, {0.5, 0.5, 0.5}, {1, 0, 0}),\n"
    "  gr.directional_light{direction = {-1, -0.05, -0.2}, colour = {0.3, 0.3, 0.3}},\n"
    "  gr.spot_light{position = {0, 0, 9}, direction = {0, 0, -1}, colour = {0.2, 0.2, 0.2}, inner = 5, outer = 60},\n"
    "  gr.light{position = {0, -9, 9}, colour = {0.1, 0.1, 0.2}, exclude = {root}},\n"
    "  gr.light{position = {0, 0, -9}, colour = {0.1, 0.1, 0.2}},\n"
    "  gr.spherical_light{position = {11, 0, 0}, radius = 0.6, emission = {2, 2, 2}, visible = true, samples = 2},\n"
    "  gr.mesh_light{mesh = bulb, samples = 1}, gr.sky_light{sky = sky, samples = 1}}\n"
    "gr.render{node = root, file = 'out.png', width = 64, height = 6, eye = {0, 0, 30}, fov = 5, ambient = {0.1, 0.1, "
    "0.1}, lights = lights, background = sky, fog = gr.uniform_fog{density = 0.01, colour = {0.5, 0.5, 0.5}}}\n";

static const char roof[] =
    "mtllib roof.mtl\nv -0.8 -0.8 0\nv 0.8 -0.8 0\nv 0 0 0.8\nv 0 0.8 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
    "usemtl tiles\nf 1/1 2/2 3/3\nusemtl wood\nf 1/1 3/3 4/2\nf 2/1 4/2 3/3\n";
static const char roof_materials[] =
    "newmtl tiles\nKd 0.8 0.3 0.2\nKs 0.2 0.2 0.2\nNs 9\nnewmtl wood\nKd 0.5 0.4 0.2\n";

static void put(const char *name, const void *data, size_t size) {
    test_write_file(test_path(name), data, size);
}

static void put_picture(const char *name, const float values[12]) {
    char bytes[64];
    int head = snprintf(bytes, sizeof bytes, "PF\n2 2\n-1.0\n");
    memcpy(bytes + head, values, 48);
    put(name, bytes, (size_t)head + 48);
}

static void write_files(void) {
    static const float holes[12] = {0, 0, 0, 1, 1, 1, 0.5F, 0.5F, 0.5F, 0.25F, 0.25F, 0.25F}, black[12] = {0};
    put("roof.obj", roof, strlen(roof));
    put("roof.mtl", roof_materials, strlen(roof_materials));
    put_picture("holes.pfm", holes);
    put_picture("black.pfm", black);
}

static void says(const char *reported, const char *const *words, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!strstr(reported, words[i]))
            test_fail(__FILE__, __LINE__, "nowhere it says \"%s\"", words[i]);
}
#define SAYS(reported, words) says(reported, words, sizeof(words) / sizeof((words)[0]))

/* The traces of two rows of pixels; checks that each ends with the bytes of the picture. The caller frees the text. */
static char *print_trace(const char *options) {
    enum { WIDTH = 64 };
    char line[4096], path[600];
    (void)snprintf(line, sizeof line, "-q %s scene.lua", options);
    struct test_result result = test_gray_scene(scene, line, NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s: %s", line, result.err);
    test_free_result(&result);
    (void)snprintf(path, sizeof path, "%s/out.png", test_folder());
    struct test_picture picture = test_read_picture(path);
    for (unsigned k = 0; k < 2 * WIDTH; k++)
        (void)snprintf(line + strlen(line), sizeof line - strlen(line), " --pixel %u,%u", k % WIDTH, 2 + k / WIDTH);
    result = test_gray_scene(NULL, line, NULL);
    CHECK_EQ_INT(result.status, 0);
    unsigned count = 0, wrong = 0;
    for (const char *at = result.out; picture.rgb && (at = strstr(at, ", pixel ")); at++) {
        unsigned x = 999, y = 999, rgb[3] = {999, 999, 999};
        const char *end = strstr(at, "times 255, rounded: ");
        if (sscanf(at, ", pixel %u,%u", &x, &y) != 2 || !end || x >= WIDTH || y >= 6 ||
            sscanf(end, "times 255, rounded: %u %u %u", &rgb[0], &rgb[1], &rgb[2]) != 3)
            break;
        const uint8_t *have = picture.rgb + 3 * ((size_t)y * picture.width + x);
        wrong += rgb[0] != have[0] || rgb[1] != have[1] || rgb[2] != have[2];
        count++;
    }
    CHECK_EQ_INT(count, 2 * WIDTH);
    CHECK_EQ_INT(wrong, 0);
    free(picture.rgb);
    free(result.err);
    return result.out;
}

TEST(a_pixel_trace_of_a_scene_with_one_of_everything_has_words_for_all_of_it) {
    static const char *const always[] = {"meets root#",
                                         ", interpolated (",
                                         ", uv (",
                                         "operand 2 of 2, box",
                                         "'tiles'",
                                         "'wood'",
                                         "opacity 0",
                                         "through the hole, weight (",
                                         " changes nothing here",
                                         "own light: (",
                                         ", rough (alpha ",
                                         ": total reflection",
                                         "fresnel: ",
                                         ", inside of 1, index 1.5",
                                         ", inside of 2, index 1.2",
                                         ", from inside, at distance ",
                                         "seen from behind, where no light counts",
                                         " two-sided",
                                         "directional light along (-0.979",
                                         "spot light at ",
                                         ": does not light this",
                                         ": the surface reflects none of it to the viewer",
                                         "shadow rays arrive",
                                         ", blocked by root",
                                         ", seen: (",
                                         "hits a visible ",
                                         "hits nothing: background, ",
                                         " and fog adds (",
                                         ", time ",
                                         "not traced, the limit is reached",
                                         "caustics: (",
                                         "exposure 1, tone reinhard, sRGB: (",
                                         "samples, as all pixels have"};
    write_files();
    char *reported =
        print_trace("-ss 1 --cutoff 0 --caustics 3000 --tone reinhard --exposure 1 --srgb -use-tir -reflect-limit 1");
    SAYS(reported, always);
    free(reported);
}

TEST(a_pixel_trace_of_a_draft_names_the_rays_it_left_out) {
    static const char *const words[] = {"it cannot change the pixel (--cutoff)", ", blinn (", "the hit at distance ",
                                        "one sample: no neighbour"};
    write_files();
    char *reported = print_trace("--quick --specular blinn --cutoff 0.2");
    SAYS(reported, words);
    free(reported);
}

TEST(a_dumped_scene_with_one_of_everything_lists_its_kinds) {
    static const char *const words[] = {"moves",     "a lamp",     "directional light", " along (-0.979",
                                        "sky light", "mesh light", "spot light",        "'tiles'"};
    static const char *const json[] = {"\"direction\":[-0.979", "\"lamp\":true", "\"operands\":[", "\"triangles\":3",
                                       "\"name\":\"tiles\""};
    write_files();
    struct test_result result = test_gray_scene(scene, "-q --dump-scene scene.lua", NULL);
    SAYS(result.out, words);
    test_free_result(&result);
    result = test_gray_scene(scene, "-q --dump-scene --json scene.lua", NULL);
    SAYS(result.out, json);
    test_free_result(&result);
}
