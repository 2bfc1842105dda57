/* An image and a bump map on every shape, by its material or by the node: both give the same bytes, and not those of
 * the plain shape. Meshes without texture coordinates give a warning and stay plain. */
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name, *shape; /* m: its material */
} shapes[] = {{"sphere", "gr.sphere(m)"},
              {"cube", "gr.cube(m)"},
              {"cylinder", "gr.cylinder{material = m}"},
              {"cone", "gr.cone{material = m}"},
              {"paraboloid", "gr.paraboloid{material = m}"},
              {"hyperboloid", "gr.hyperboloid{material = m}"},
              {"ellipsoid", "gr.ellipsoid{material = m, radii = {1, 0.5, 1}}"},
              {"quadric", "gr.quadric{material = m, xx = 1, yy = 2, zz = 1, constant = -1}"},
              {"torus", "gr.torus{material = m}"},
              {"superellipsoid", "gr.superellipsoid{material = m, e = 0.5, n = 0.5}"},
              {"plane", "gr.plane{material = m, distance = -2}"},
              {"disc", "gr.disc{material = m, normal = {0, 0, 1}}"},
              {"rectangle", "gr.rectangle{material = m}"},
              {"triangle", "gr.triangle{material = m, a = {-1, -1, 0}, b = {1, -1, 0}, c = {0, 1, 0}}"},
              {"polygon", "gr.polygon{material = m, points = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}}"},
              {"lathe", "gr.lathe(m, {{0, -1}, {1, -1}, {1, 1}, {0, 1}})"},
              {"prism", "gr.prism{material = m, outline = {{-1, -1}, {1, -1}, {0, 1}}}"},
              {"sweep", "gr.sweep(m, {{-1, 0, 0}, {1, 1, 0}}, 0.4)"},
              {"height_field", "gr.height_field(m, {{0, 1}, {1, 0}})"},
              {"blob", "gr.blob(m, {{0, 0, 0, 1}, {0.5, 0, 0, 1}})"},
              {"curve", "gr.curve(m, {{-1, 0, 0}, {1, 1, 0}, {2, 0, 1}}, 0.3)"},
              {"mesh", "gr.mesh{material = m, verts = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, faces = {{0, 1, 2}}, uvs = "
                       "{{0, 0}, {1, 0}, {0, 1}}}"},
              {"bare", "gr.mesh{material = m, verts = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, faces = {{0, 1, 2}}}"}};
enum { SHAPES = sizeof shapes / sizeof shapes[0] };

static const char head[] =
    "local red = gr.material({0.8, 0.5, 0.6}, {0, 0, 0}, 30)\n"
    "local bump = gr.bump{file = 'spots.pfm', height = 0.2}\n"
    "local function show(n, f) local r = gr.node('r') r:add_child(n)\n"
    "  gr.render{node = r, file = f, width = 24, height = 24, eye = {0.5, 1, 5}, target = {0, 0, 0}, fov = 40,\n"
    "    ambient = {0.3, 0.3, 0.3}, lights = {gr.light({3, 6, 8}, {0.6, 0.6, 0.6}, {1, 0, 0})}} end\n"
    "local function all(name, make)\n"
    "  show(make(red), name .. '-plain.png')\n"
    "  show(make(red):set_texture('spots.pfm'), name .. '-node.png')\n"
    "  show(make(gr.image_material{material = red, image = 'spots.pfm'}), name .. '-material.png')\n"
    "  show(make(red):set_bump(bump), name .. '-bumps.png')\n"
    "  show(make(gr.bump_material{material = red, image = bump}), name .. '-relief.png') end\n";

static char *bytes_of(const char *name, const char *route, size_t *size) {
    char path[600];
    (void)snprintf(path, sizeof path, "%s/%s-%s.png", test_folder(), name, route);
    return test_read_file(path, size);
}

static bool same_picture(const char *name, const char *route, const char *other) {
    size_t size = 0, other_size = 1;
    char *a = bytes_of(name, route, &size), *b = bytes_of(name, other, &other_size);
    bool same = a && b && size == other_size && memcmp(a, b, size) == 0;
    CHECK(a && b);
    free(a);
    free(b);
    return same;
}

TEST(every_shape_shows_pictures_and_bumps_by_its_material_and_by_its_node) {
    char text[8192], path[600], picture[64 + 4 * 4 * 12];
    int used = snprintf(picture, sizeof picture, "PF\n4 4\n-1.0\n");
    for (int i = 0; i < 16; i++) {
        float spot[3] = {(float)(i * 7 % 5) / 4, (float)(i * 3 % 4) / 3, (float)(i % 2)};
        memcpy(picture + used, spot, sizeof spot);
        used += (int)sizeof spot;
    }
    (void)snprintf(path, sizeof path, "%s/spots.pfm", test_folder());
    test_write_file(path, picture, (size_t)used);
    strcpy(text, head);
    for (int i = 0; i < SHAPES; i++)
        (void)snprintf(text + strlen(text), sizeof text - strlen(text), "all('%s', function(m) return %s end)\n",
                       shapes[i].name, shapes[i].shape);
    struct test_result result = test_gray_scene(text, "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.err, "has a texture, but its mesh has no texture coordinates"));
    CHECK(strstr(result.err, "has a bump map, but its mesh has no texture coordinates"));
    for (int i = 0; i < SHAPES; i++) {
        const char *name = shapes[i].name;
        bool bare = strcmp(name, "bare") == 0,
             ball = strcmp(name, "sphere") == 0; /* its node uses the classic mapping */
        if (same_picture(name, "plain", "node") != bare || same_picture(name, "plain", "material") != bare)
            test_fail(__FILE__, __LINE__, "%s: the picture is%s shown", name, bare ? "" : " not");
        if (same_picture(name, "plain", "bumps") != bare || same_picture(name, "plain", "relief") != bare)
            test_fail(__FILE__, __LINE__, "%s: the bumps are%s shown", name, bare ? "" : " not");
        if (!ball && (!same_picture(name, "node", "material") || !same_picture(name, "bumps", "relief")))
            test_fail(__FILE__, __LINE__, "%s: node and material differ", name);
    }
    test_free_result(&result);
}
