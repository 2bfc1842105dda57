/* Values that are valid alone and wrong together, or valid and rarely used: each call of the first table is refused
 * with its message, line and function; each of the second table runs, also with failing allocations. */
#include "base/fault.h"
#include "tests/unit/file_makers.h"
#include "tests/unit/script_host.h"

static const char preparation[] =
    "glass = gr.rr_material({1, 1, 1}, {1, 1, 1}, 10, 0.5, 0.5, 1.5)\n"
    "verts, faces = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}\n"
    "ball, box, sheet = gr.sphere('ball'), gr.cube('box'), gr.mesh(glass, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, "
    "2}})\n"
    "cut = gr.difference('cut', ball, box) lamp = gr.light({0, 0, 0}, {1, 1, 1}, {1, 0, 0})\n";
enum { LINE = 5 };

struct wrong {
    const char *call, *words;
};

static const struct wrong wrongs[] = {
    {"gr.cylinder{from = {1, 2, 3}, to = {1, 2, 3}}", "from and to are the same point"},
    {"gr.cylinder{from = {1e40, 0, 0}}", "must be between -1e+30 and 1e+30"},
    {"gr.cylinder{to = {1e40, 0, 0}}", "must be between -1e+30 and 1e+30"},
    {"gr.cylinder{from = {0, 0, 0}, to = {1e-40, 0, 0}}", "the distance of from and to is too small: 1e-40"},
    {"gr.cylinder{radius = 1e-40}", "radius is too small: 1e-40"},
    {"gr.cone{from = {0, 0, 0}, to = {0, 0, 0}}", "from and to are the same point"},
    {"gr.cone{radius = 1e40}", "must be between -1e+30 and 1e+30"},
    {"gr.paraboloid{radius = 1e40}", "must be between -1e+30 and 1e+30"},
    {"gr.paraboloid{height = 1e-40}", "height is too small"},
    {"gr.hyperboloid{radius = 1e40}", "must be between -1e+30 and 1e+30"},
    {"gr.hyperboloid{height = 1e40}", "must be between -1e+30 and 1e+30"},
    {"gr.hyperboloid{gap = 0.1, sheets = 1}", "gap is for two sheets: with sheets=1 give waist"},
    {"gr.hyperboloid{waist = 0.1, sheets = 2}", "waist is for one sheet: with sheets=2 give gap"},
    {"gr.hyperboloid{gap = 2, height = 1}", "gap must be smaller than height: 2, 1"},
    {"gr.hyperboloid{waist = 1e-40, radius = 1}", "waist is too small"},
    {"gr.hyperboloid{gap = 1e-40, height = 1}", "gap is too small"},
    {"gr.ellipsoid{radii = {0, 1, 1}}", "radii must all be positive"},
    {"gr.ellipsoid{radii = {1, -1, 1}}", "radii must all be positive"},
    {"gr.ellipsoid{radii = {1, 1, 0}}", "radii must all be positive"},
    {"gr.ellipsoid{centre = {0, 1e40, 0}}", "must be between -1e+30 and 1e+30"},
    {"gr.ellipsoid{radii = {1e40, 1, 1}}", "must be between -1e+30 and 1e+30"},
    {"gr.ellipsoid{radii = {1, 1e40, 1}}", "must be between -1e+30 and 1e+30"},
    {"gr.ellipsoid{radii = {1, 1, 1e-40}}", "the third of radii is too small"},
    {"gr.quadric{xx = 1e40}", "must be between -1e+30 and 1e+30"},
    {"gr.quadric{xx = 0}", "at least one of xx, yy, zz"},
    {"gr.quadric{xx = 1, min = {0, 0, 0}, max = {0, 1, 1}}", "min must be smaller than max"},
    {"gr.quadric{xx = 1, min = {0, 0, 0}, max = {1, 0, 1}}", "min must be smaller than max"},
    {"gr.quadric{xx = 1, min = {0, 0, 0}, max = {1, 1, 0}}", "min must be smaller than max"},
    {"gr.torus{minor = 1e-40}", "minor is too small"},
    {"gr.torus{major = 1e40}", "must be between -1e+30 and 1e+30"},
    {"gr.torus{major = 1, minor = 1e-9}", "minor must be at least a millionth of major"},
    {"gr.box{min = {0, 0, 0}, max = {0, 1, 1}}", "min and max must differ along every axis"},
    {"gr.box{min = {0, 0, 0}, max = {1, 0, 1}}", "min and max must differ along every axis"},
    {"gr.box{min = {0, 0, 0}, max = {1, 1, 0}}", "min and max must differ along every axis"},
    {"gr.box{min = {-1e40, 0, 0}, max = {1, 1, 1}}", "must be between -1e+30 and 1e+30"},
    {"gr.box{min = {0, 0, 0}, max = {1e40, 1, 1}}", "must be between -1e+30 and 1e+30"},
    {"gr.plane{distance = 1e40}", "must be between -1e+30 and 1e+30"},
    {"gr.rectangle{along = {1, 0, 0}, up = {2, 0, 0}}", "along and up are parallel"},
    {"gr.rectangle{corner = {1e40, 0, 0}}", "must be between -1e+30 and 1e+30"},
    {"gr.rectangle{along = {1e-40, 0, 0}}", "the length of an edge is too small"},
    {"gr.rectangle{along = {1e40, 0, 0}}", "must be between -1e+30 and 1e+30"},
    {"gr.rectangle{up = {0, 1e40, 0}}", "must be between -1e+30 and 1e+30"},
    {"gr.triangle{a = {0, 0, 0}, b = {1, 0, 0}, c = {2, 0, 0}}", "a, b and c lie on one line"},
    {"gr.disc{radius = 1e40}", "must be between -1e+30 and 1e+30"},
    {"gr.disc{centre = {1e40, 0, 0}}", "must be between -1e+30 and 1e+30"},
    {"gr.disc{inner = 2, radius = 1}", "inner must be smaller than radius"},
    {"gr.polygon{points = {{1e40, 0, 0}, {1, 0, 0}, {0, 1, 0}}}", "must be between -1e+30 and 1e+30"},
    {"gr.polygon{points = verts, outlines = {{0, 1, 9}}}", "outlines has the index 9, but there are 4 points"},
    {"gr.polygon{points = verts, outlines = {{0, 1, 2}, {0, 1}}}", "outlines[2] has 2 corners, not 3 or more"},
    {"gr.cube{corner = {1e30, 0, 0}}", "size is too small for this corner"},
    {"gr.cube{corner = {0, 1e30, 0}}", "size is too small for this corner"},
    {"gr.cube{corner = {0, 0, 1e30}}", "size is too small for this corner"},
    {"gr.cube{corner = {1.7e308, 0, 0}, size = {1.7e308, 1, 1}}", "must be between -1e+30 and 1e+30"},
    {"gr.cube{corner = {-1.7e308, 0, 0}, size = {-1.7e308, 1, 1}}", "must be between -1e+30 and 1e+30"},
    {"gr.geometry('g', gr.node('n'))", "primitive must be a shape, not the plain node 'n'"},
    {"gr.instances{of = ball, at = {{1, 2}}}", "at[1] has 2 numbers, not 3 or 12"},
    {"gr.instances{of = ball, at = {{1, 2, 3}, {1, 2}}}", "at[2] has 2 numbers, not 3 as those before"},
    {"gr.instances{of = ball, at = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, {1, 2, 3}}}",
     "at[2] has 3 numbers, not 12 as those before"},
    {"gr.instances{of = ball, at = {{1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0}}}", "it has no inverse"},
    {"gr.instances{of = ball, at = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}, turn = 5}", "turn and size need positions"},
    {"gr.instances{of = ball, at = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}, size = 5}", "turn and size need positions"},
    {"gr.instances{of = ball, at = {{1, 2, 3}}, turn = {1, 2}}", "turn has 2 numbers for 1 places"},
    {"gr.instances{of = ball, at = {{1, 2, 3}}, size = {1, 2}}", "size has 2 numbers for 1 places"},
    {"gr.union{}", "a is missing"},
    {"gr.union{operands = {}}", "operands"},
    {"gr.union('u', ball, gr.plane('p'))", "'p' "},
    {"gr.union('u', ball, sheet)", "is not closed"},
    {"gr.inverse(sheet)", "is not closed"},
    {"gr.clipped_by{object = ball, by = sheet}", "is not closed"},
    {"gr.intersection('i', gr.clipped_by{object = ball, by = box}, box)", "is clipped, cut open without caps"},
    {"gr.light{position = {0, 0, 0}, colour = {1, 1, 1}, range = 2, intensity = 3}", "exclude each other"},
    {"gr.light{position = {0, 0, 0}, colour = {1, 1, 1}, range = 2, falloff = {1, 0, 0}}", "exclude each other"},
    {"gr.directional_light{direction = {0, 0, 0}, colour = {1, 1, 1}}", "direction"},
    {"gr.spot_light{position = {0, 0, 0}, colour = {1, 1, 1}, direction = {0, 1, 0}, target = {0, 0, 1}}",
     "direction and target exclude each other"},
    {"gr.spot_light{position = {0, 0, 1}, colour = {1, 1, 1}, target = {0, 0, 1}}",
     "the direction to target must not be zero"},
    {"gr.spot_light{position = {0, 0, 1}, colour = {1, 1, 1}, inner = 50, outer = 20}", "inner must be at most outer"},
    {"gr.spot_light{position = {0, 0, 1}, colour = {1, 1, 1}, range = 1, intensity = 1}", "exclude each other"},
    {"gr.disc_light{radius = 1, position = {0, 0, 1}, colour = {1, 1, 1}, normal = {0, 0, 0}}", "normal"},
    {"gr.spherical_light{radius = 1, position = {0, 0, 1}}", "colour is missing"},
    {"gr.spherical_light{radius = 1, position = {0, 0, 1}, emission = {1, 1, 1}, range = 1}",
     "a light with emission has no falloff, range or intensity"},
    {"gr.spherical_light{radius = 1, position = {0, 0, 1}, emission = {1, 1, 1}, falloff = {1, 0, 0}}",
     "a light with emission has no falloff, range or intensity"},
    {"gr.spherical_light{radius = 1, position = {0, 0, 1}, emission = {1, 1, 1}, intensity = 1}",
     "a light with emission has no falloff, range or intensity"},
    {"gr.spherical_light{radius = 1, position = {0, 0, 1}, colour = {1, 1, 1}, range = 1, intensity = 1}",
     "exclude each other"},
    {"gr.sky_gradient{stops = {}}", "stops must not be empty"},
    {"gr.sky_gradient{stops = {{1, 0, 0, 0}, {0, 0, 0, 0}}}", "stops[2][1] must be at least the height before it"},
    {"gr.clear_sky{sun = {0, 1, 0}, hour = 5}", "sun excludes time"},
    {"gr.clear_sky{sun = {0, 0, 0}}", "sun"},
    {"gr.sun_light{sun = {0, 1, 0}, zone = 1, colour = {1, 1, 1}}", "sun excludes time"},
    {"gr.sky_faces{front = 'cross.png', right = 'cross.png', back = 'cross.png', left = 'cross.png', top = "
     "'cross.png', bottom = 'cross.png'}",
     "square"},
    {"gr.sky_cross{image = 'square.png'}", "4 x 3"},
    {"gr.linear_fog{near = 2, far = 1}", "near must be at most far"},
    {"gr.fog_profile{profile = {}}", "profile must not be empty"},
    {"gr.fog_profile{profile = {{0, -1}}}", "profile[1][2] must be >= 0"},
    {"gr.fog_profile{profile = {{1, 1}, {0, 1}}}", "profile[2][1] must be at least the height before it"},
    {"gr.fog_grid{corner = {0, 0, 0}, size = {1, 1, 1}, cells = {1.5, 1, 1}, densities = 1}",
     "cells[1] must be a whole"},
    {"gr.fog_grid{corner = {0, 0, 0}, size = {1, 1, 1}, cells = {2, 1, 1}, densities = {1, 2, 3}}",
     "must have 2 numbers"},
    {"gr.lathe{points = {{1, 1}}}", "points has 1 entries, not 2 or more"},
    {"gr.sweep{points = {{1, 1, 1}}, radii = 1}", "points has 1 entries, not 2 or more"},
    {"gr.curve{points = {{1, 1, 1}}, widths = 1}", "points has 1 entries, not 2 or more"},
    {"gr.sweep{points = {{1, 1, 1}, {2, 2, 2}}, radii = {1, 2, 3}}", "radii has 3 entries, but points has 2"},
    {"gr.height_field{heights = {}}", "heights needs 2 rows of 2 numbers at least"},
    {"gr.height_field{heights = {{1, 2}}}", "heights needs 2 rows of 2 numbers at least"},
    {"gr.height_field{heights = {{1}, {2}}}", "heights needs 2 rows of 2 numbers at least"},
    {"gr.height_field{heights = {{1, 2}, {2}}}", "heights[2] has 1 numbers, but heights[1] has 2"},
    {"gr.height_field{}", "heights is missing"},
    {"gr.height_field{image = 'gone.png'}", "cannot find 'gone.png'"},
    {"gr.height_field{heights = {{1, 2}, {1, 2}}, image = 'square.png'}", "exclude each other"},
    {"gr.blob{spheres = {{0, 0, 0, 0}}}", "spheres[1] has the radius 0"},
    {"gr.blob{spheres = {{0, 0, 0, 1, 0}}}", "the strength 0"},
    {"gr.blob{spheres = {{0, 0, 0}}}", "spheres[1] has 3 numbers, not 4 or 5"},
    {"gr.blob{}", "spheres is missing (or cylinders)"},
    {"gr.patch{points = {}}", "points has 0 entries, not 16 for each patch"},
    {"gr.patch{points = verts}", "points has 4 entries, not 16 for each patch"},
    {"gr.patch{points = verts, patches = {{0, 1, 2}}}", "patches[1] has 3 indices, not 16"},
    {"gr.patch{points = verts, patches = {{0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 9}}}", "patches[1][16] is 9"},
    {"gr.mesh{faces = faces}", "verts is missing"},
    {"gr.mesh{verts = verts}", "faces is missing"},
    {"gr.mesh{file = 'flag.obj', faces = faces}", "file and verts exclude each other"},
    {"gr.mesh{file = 'flag.obj', face_materials = {1}}", "face_materials goes with faces, not with a file"},
    {"gr.mesh{file = 'flag.obj', materials = {glass}}", "materials of a file have names"},
    {"gr.mesh{file = 'flag.obj', materials = {paiint = glass}}", "has no part 'paiint'; did you mean 'paint'?"},
    {"gr.mesh{file = 'flag.obj', materials = {zzzzzzzzzz = glass}}", "has no part 'zzzzzzzzzz'"},
    {"gr.mesh{verts = {}, faces = {{0, 1, 2}}}", "faces[1][1] is 0, but verts is empty"},
    {"gr.mesh{verts = verts, faces = {{0, 1}}}", "faces[1] has 2 corners, not 3 or more"},
    {"gr.mesh{verts = verts, faces = faces, materials = {glass}}", "face_materials is missing"},
    {"gr.mesh{verts = verts, faces = faces, face_materials = {1, 1, 1, 1}}", "materials must be a list"},
    {"gr.mesh{verts = verts, faces = faces, materials = {a = glass}, face_materials = {1, 1, 1, 1}}",
     "materials must be a list"},
    {"gr.mesh{verts = verts, faces = faces, materials = {glass}, face_materials = 1}", "entries, but faces has 4"},
    {"gr.mesh{verts = verts, faces = faces, materials = {glass}, face_materials = {1, 1}}",
     "2 entries, but faces has 4"},
    {"gr.mesh{verts = verts, faces = faces, materials = {glass}, face_materials = {1, 1, 2, 1}}",
     "face_materials[3] is 2, but materials has 1 entries"},
    {"gr.mesh{verts = verts, faces = faces, materials = {glass}, face_materials = {0, 1, 1, 1}}", "face_materials[1]"},
    {"gr.mesh{verts = verts, faces = faces, materials = {glass, glass}, face_materials = {1.5, 1, 1, 1}}", "1.5"},
    {"gr.mesh{verts = verts, faces = faces, normals = verts, face_normals = {{0, 1, 2}}}", "but faces has 4"},
    {"gr.mesh{verts = verts, faces = faces, uvs = {{0, 0}}}", "uvs ends with number 0"},
    {"ball:faces()", "the node is not a mesh"},
    {"cut:faces()", "the node is not a mesh"},
    {"gr.node('empty'):bounds()", "no shape is below this node"},
    {"cut:set_texture('square.png')", "a combined solid has no texture"},
    {"cut:set_bump('square.png')", "a combined solid has no bump map"},
    {"ball:rotate({0, 0, 0}, 20)", "axis"},
    {"gr.material{kd = {1, 1, 1}, ks = {1, 1, 1}, refract = 0.5}", "ior is missing"},
    {"gr.image_material{material = glass, image = 'broken.png'}", "broken.png: "},
    {"gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, view = {0, 0, 1}, target = {0, 0, "
     "0}}",
     "view and target exclude each other"},
    {"gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, sky = 'cross.png', background = "
     "{0, 0, 1}}",
     "sky and background exclude each other"},
    {"gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, sky = 'square.png'}", "4 x 3"},
    {"gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, focus = 2, focus_point = {0, 0, "
     "0}}",
     "focus and focus_point exclude each other"},
    {"gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, target = {0, 0, 0}, view_to = {0, "
     "0, 1}}",
     "view_to needs view"},
    {"gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, target_to = {0, 0, 1}}",
     "target_to needs target"},
};

/* Rarely used and valid. */
static const char *const rights[] = {
    "gr.mesh{verts = verts, faces = faces, materials = {glass, glass}, face_materials = {1, 2, 1, 2}}",
    "gr.mesh{verts = verts, faces = faces, smooth = 60, weld = true, flip = true}",
    "gr.mesh{file = 'flag.obj', materials = {}}",
    "gr.mesh{file = 'flag.obj', materials = {paint = glass}, smooth = 30}",
    "gr.instances{of = ball, at = {}}",
    "gr.geometry('g', cut)",
    "gr.geometry('g', gr.mesh{file = 'flag.obj'})",
    "gr.transform_order('separate') local n = gr.sphere(glass) n:scale(1, 2, 3) n:add_child(box) gr.geometry('g', n)",
    "local b = gr.union('u', ball, box):bounds() assert(b.max or b[2])",
    "gr.difference('d', ball, box):bounds()",
    "gr.inverse(ball):bounds()",
    "local far = gr.sphere{centre = {9, 9, 9}} gr.union{operands = {ball, far, box}}:bounds()",
    "gr.instances{of = ball, at = {{1, 2, 3}, {3, 2, 1}}}:bounds()",
    "sheet:bounds()",
    "local n = gr.node('n') n:add_child(ball) local flat = gr.cube('flat') flat:scale(1, 1, 0) n:add_child(flat) "
    "n:bounds()",
    "ball:scale(1, 1, 0)",
    "gr.fog_grid{corner = {0, 0, 0}, size = {1, 1, 1}, cells = {2, 1, 1}, densities = 0.5}",
    "gr.fog_grid{corner = {0, 0, 0}, size = {1, 1, 1}, cells = {2, 1, 1}, densities = {1, 2}}",
    "gr.light{position = {0, 0, 0}, colour = {1, 1, 1}, falloff = {1, 1, 0}}",
    "gr.light{position = {0, 0, 0}, colour = {1, 1, 1}, intensity = 4}",
    "gr.spot_light{position = {0, 0, 1}, colour = {1, 1, 1}, target = {0, 0, 0}}",
    "gr.spot_light{position = {0, 0, 1}, colour = {1, 1, 1}, inner = 50}",
    "gr.spot_light{position = {0, 0, 1}, colour = {1, 1, 1}, inner = 20}",
    "gr.spherical_light{radius = 1, position = {0, 0, 1}, emission = {1, 1, 1}}",
    "gr.spherical_light{radius = 1, position = {0, 0, 1}, colour = {1, 0, 0}, emission = {1, 1, 1}}",
    "gr.clear_sky{hour = 5}",
    "gr.clear_sky{day = 5} gr.clear_sky{latitude = 5} gr.clear_sky{longitude = 5} gr.clear_sky{zone = 5}",
    "gr.sun_light{colour = {1, 1, 1}, hour = 5}",
    "gr.sky_light{sky = 'gradient'} gr.sky_light{sky = {1, 1, 1}} gr.sky_light{sky = gr.sky_map('square.png')}",
    "gr.material{kd = {1, 1, 1}, ks = {1, 1, 1}, highlight = 'blinn'}",
    "gr.material{kd = {1, 1, 1}, ks = {1, 1, 1}, highlight = 'phong', ior = 1.5, refract = 0.5}",
    "local t = gr.texture{file = 'square.png', tiles = 2} gr.image_material{material = glass, image = t, tiles = 3}",
    "local b = gr.bump{file = 'square.png', kind = 'normal'} ball:set_bump(b) "
    "gr.bump_material{material = glass, image = b, kind = 'bump'}",
    "local i = gr.geometry('g', sheet) i:set_texture('square.png')",
    "gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, target = {0, 0, 0}, target_to = "
    "{1, 0, 0}}",
    "gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, target = {0, 0, 9}}",
    "gr.render{node = ball, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, background = 'gradient'}",
};

static void write_files(void) {
    char path[512];
    write_white_png("cross.png", 8, 6);
    write_white_png("square.png", 8, 8);
    (void)snprintf(path, sizeof path, "%s/broken.png", test_folder());
    test_write_text(path, "\x89PNG");
    (void)snprintf(path, sizeof path, "%s/flag.obj", test_folder());
    test_write_text(path, "v 0 0 0\nv 1 0 0\nv 0 1 0\ng paint\nf 1 2 3\ng other\nf 1 3 2\n");
}

static bool run_after_preparation(const char *call, struct listener *listener, struct error *error) {
    char text[4096];
    *error = (struct error){0};
    (void)snprintf(
        text, sizeof text, "%s%s%s\n", preparation,
        listener->fail_at ? "gr.render{node = ball, file = 'first.png', width = 4, height = 4, eye = {0, 0, 9}} " : "",
        call);
    return listen_to_text(listener, text, NULL, error);
}

TEST(values_that_are_wrong_together_are_errors_that_name_the_line) {
    write_files();
    for (size_t i = 0; i < sizeof wrongs / sizeof wrongs[0]; i++) {
        struct error error;
        struct listener listener = {.renders = 0};
        char position[32];
        (void)snprintf(position, sizeof position, "scene.lua:%d: ", LINE);
        if (run_after_preparation(wrongs[i].call, &listener, &error))
            test_fail(__FILE__, __LINE__, "%s is accepted", wrongs[i].call);
        else if (error.kind != ERROR_SCENE || !strstr(error.text, position) || !strstr(error.text, wrongs[i].words))
            test_fail(__FILE__, __LINE__, "%s: kind %d: %s", wrongs[i].call, (int)error.kind, error.text);
    }
}

TEST(calls_that_are_rarely_made_run) {
    write_files();
    for (size_t i = 0; i < sizeof rights / sizeof rights[0]; i++) {
        struct error error;
        struct listener listener = {.renders = 0};
        if (!run_after_preparation(rights[i], &listener, &error))
            test_fail(__FILE__, __LINE__, "%s: %s", rights[i], error.text);
    }
}

TEST(memory_may_end_in_calls_that_are_rarely_made) {
#ifndef GRAY_FAULTS
    test_skip("allocations fail on demand only in builds with GRAY_FAULTS");
#endif
    write_files();
    for (size_t i = 0; i < sizeof rights / sizeof rights[0]; i++)
        for (uint64_t k = 1, over = 0; !over; k++) {
            struct error error;
            struct listener listener = {.fail_at = k};
            bool done = run_after_preparation(rights[i], &listener, &error);
            over = fault_count(FAULT_OF_ALLOCATION) < listener.failing || listener.failing == 0;
            fault_at(FAULT_OF_ALLOCATION, 0);
            if (!done && error.kind != ERROR_MACHINE)
                test_fail(__FILE__, __LINE__, "allocation %llu of %s: kind %d: %s", (unsigned long long)k, rights[i],
                          (int)error.kind, error.text);
        }
}
