/* gr.light_field and gray view, by the program. */
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Three columns and two rows of views that are no whole number of tiles; thin rods, a mirror, a textured floor. */
static const char scene[] =
    "local r = gr.node('root')\n"
    "r:add_child(gr.sphere{material = gr.material{kd = {0.8, 0.3, 0.2}, reflect = 0.3}})\n"
    "for i = 1, 6 do r:add_child(gr.cylinder{from = {i / 3 - 1.2, -2, 1}, to = {i / 3 - 1, 2, 1}, radius = 0.01}) end\n"
    "r:add_child(gr.plane{distance = -1, normal = {0, 1, 0}, material = gr.material{kd = gr.wood_texture(2, "
    "3)}})\n"
    "gr.light_field{node = r, rows = 2, columns = 3, size = {75, 50}, spacing = 0.2, eye = {0, 0.5, 5},\n"
    "  target = {0, 0, 0}, fov = 40, lights = {gr.light{position = {3, 4, 5}, colour = {0.9, 0.9, 0.9}, falloff = {1, "
    "0, 0}}}, background = {0.2, 0.3, 0.4}, ";

static void put_scene(const char *fields) {
    char text[2048];
    (void)snprintf(text, sizeof text, "%s%s}\n", scene, fields);
    test_write_text(test_path("scene.lua"), text);
}

TEST(a_light_field_divided_over_eight_runs_equals_the_whole) {
    put_scene("depth = true");
    test_shell_errors("$gray -q scene.lua -j 1 && mv scene.lf whole.lf && "
                      "for i in 1 2 3 4 5 6 7 8; do $gray -q scene.lua -j $((i % 3 + 1)) --shard $i/8 || exit; done; "
                      "$gray merge -q scene.lf.*.part && cmp scene.lf whole.lf",
                      0, NULL);
}

TEST(a_light_field_of_paths_divided_over_eight_runs_equals_the_whole) {
    put_scene("depth = true, integrator = 'path', spp = 16, denoise = true, filter = 'mitchell'");
    test_shell_errors("$gray -q scene.lua && mv scene.lf whole.lf && "
                      "for i in 1 2 3 4 5 6 7 8; do $gray -q scene.lua --shard $i/8 || exit; done; "
                      "$gray merge -q scene.lf.*.part && cmp scene.lf whole.lf",
                      0, NULL);
}

TEST(a_light_field_that_is_interrupted_goes_on_to_the_bytes_of_one_run) {
    put_scene("depth = true, full = true");
    test_shell_errors(
        "$gray -q scene.lua -o whole.lf; for m in 0.1 0.3 0.5; do rm -f scene.lf; "
        "$gray -q scene.lua --checkpoint c.tiles --checkpoint-every 0 2>said.txt & p=$!; sleep $m; "
        "kill -KILL $p 2>kill.txt; wait $p 2>kill.txt; test -e scene.lf && ! cmp scene.lf whole.lf && exit 1; "
        "$gray -q scene.lua --checkpoint c.tiles $(test -e c.tiles && echo --resume) && "
        "cmp scene.lf whole.lf || exit 2; rm -f c.tiles; done",
        0, NULL);
}

/* The numbers of a view in the picture of all views. */
static void check_view(const struct test_picture *all, uint32_t column, uint32_t row, const char *name) {
    struct test_picture view = test_read_picture(test_path(name));
    CHECK(view.width == 75 && view.height == 50);
    for (uint32_t y = 0; y < 50 && view.rgb; y++)
        CHECK(memcmp(view.rgb + (size_t)3 * 75 * y, all->rgb + 3 * ((size_t)225 * (row * 50 + y) + column * 75), 225) ==
              0);
    free(view.rgb);
}

TEST(captured_views_are_exact_and_all_in_one_picture) {
    for (int depth = 0; depth < 2; depth++) {
        put_scene(depth ? "depth = true, tone = function(x) return x / (x + 0.7) end, srgb = true" : "tone = 'filmic'");
        test_shell_errors(
            "rm -f *.lf *.png; $gray -q scene.lua && $gray -q scene.lua -o all.png && "
            "$gray view scene.lf -o sheet.png --contact-sheet && cmp sheet.png all.png && "
            "$gray view scene.lf -o a.png --eye=-0.2,0.1,0 && $gray view scene.lf -o b.png --eye 0,-0.1 && "
            "$gray view scene.lf -o c-%d.png --eye=-0.2,-0.1:0.2,-0.1 --frames 3",
            0, NULL);
        struct test_picture all = test_read_picture(test_path("all.png"));
        check_view(&all, 0, 0, "a.png");
        check_view(&all, 1, 1, "b.png");
        check_view(&all, 0, 1, "c-1.png");
        check_view(&all, 1, 1, "c-2.png");
        check_view(&all, 2, 1, "c-3.png");
        free(all.rgb);
    }
}

/* A post near the cameras at the right border is blurred over a part of the picture. */
TEST(a_lens_over_depths_has_the_same_pixels_whatever_is_blurred_elsewhere) {
    static const char text[] =
        "local function f(p) return gr.vec(0.5 + 0.4 * math.sin(7 * p.x), 0.5 + 0.4 * math.sin(9 * p.y), 0.3) end\n"
        "local r = gr.node('r')\n"
        "r:add_child(gr.rectangle{corner = {-9, -9, 0}, along = {18, 0, 0}, up = {0, 18, 0},\n"
        "  material = gr.material{emission = f, kd = {0, 0, 0}}})\n"
        "if POST then r:add_child(gr.box{min = {0.6, -1, 2.5}, max = {0.7, 1, 2.6}, material = gr.material{\n"
        "  emission = {1, 0, 0}, kd = {0, 0, 0}}}) end\n"
        "gr.light_field{node = r, eye = {0, 0, 4}, target = {0, 0, 0}, fov = 30, size = {96, 48}, rows = 3,\n"
        "  columns = 3, spacing = 0.1, depth = true, samples = 1, background = {0, 0, 0}}\n";
    struct test_picture views[2];
    for (int post = 0; post < 2; post++) {
        char whole[2048], line[256];
        (void)snprintf(whole, sizeof whole, "POST = %s\n%s", post ? "true" : "false", text);
        (void)snprintf(line, sizeof line,
                       "$gray -q scene.lua && $gray view scene.lf -o %d.png --focus 4 --aperture 0.1", post);
        test_write_text(test_path("scene.lua"), whole);
        test_shell_errors(line, 0, NULL);
        (void)snprintf(line, sizeof line, "%d.png", post);
        views[post] = test_read_picture(test_path(line));
    }
    int differ = 0;
    for (int i = 0; i < 3 * 96 * 48 && views[0].rgb && views[1].rgb; i++) {
        bool same = views[0].rgb[i] == views[1].rgb[i];
        differ += !same;
        CHECK(same || i / 3 % 96 >= 32);
    }
    CHECK(differ > 100);
    free(views[0].rgb);
    free(views[1].rgb);
}

/* The rows and columns at the borders of views, too: what a view shows does not depend on its neighbours. */
static void check_same_views(const char *fields) {
    put_scene(fields);
    test_shell_errors("rm -f *.png; $gray -q scene.lua --aa-pattern grid -o all.png", 0, NULL);
    struct test_picture all = test_read_picture(test_path("all.png"));
    for (uint32_t y = 0; y < 100 && all.rgb; y++)
        for (uint32_t column = 1; column < 3; column++)
            CHECK(memcmp(all.rgb + (size_t)3 * 225 * y, all.rgb + 3 * ((size_t)225 * y + column * 75), 225) == 0);
    free(all.rgb);
}

TEST(pixels_of_a_light_field_do_not_depend_on_the_view_beside_them) {
    /* With cameras at one place all views are equal, if the samples of a pixel do not depend on its number. */
    check_same_views("spacing = 0, samples = 3, filter = 'tent', bloom = 0.5, vignette = 0.5, line_width = 3");
    check_same_views("spacing = 0, samples = 3, fxaa = true, side_tolerance = 0.3, corner_tolerance = 0.3");
}

/* All cameras see the same rectangle of the plane in focus. */
TEST(a_textured_plane_at_the_distance_in_focus_is_a_render_of_it_from_any_eye) {
    test_write_text(
        test_path("scene.lua"),
        "local function f(p) return gr.vec(0.5 + 0.4 * math.sin(7 * p.x), 0.5 + 0.4 * math.sin(9 * p.y), 0.3) end\n"
        "local r = gr.rectangle{corner = {-9, -9, 0}, along = {18, 0, 0}, up = {0, 18, 0},\n"
        "  material = gr.material{emission = f, kd = {0, 0, 0}}}\n"
        "local c = {node = r, eye = {0, 0, 4}, target = {0, 0, 0}, fov = 30, width = 64, height = 48,\n"
        "  samples = 1, background = {0, 0, 0}}\n"
        "c.file = 'one.png'; gr.render(c)\n"
        "c.file = 'x.lf'; c.rows = 3; c.columns = 3; c.spacing = 0.2; gr.light_field(c)\n");
    test_shell_errors(
        "$gray -q scene.lua && for e in 0.1,0.05,0 -0.13,0.2,0 0.07,0,0; do "
        "$gray view x.lf -o v.png --eye=$e && $gray compare --threshold 2 v.png one.png || exit 3; "
        "$gray view x.lf -o v.png --eye=$e --aperture 0.2 && $gray compare --threshold 2 v.png one.png || "
        "exit 3; done; $gray view x.lf -o v.png --eye 0.1,0,0 --focus 2 && "
        "$gray compare --threshold 9 v.png one.png",
        1, NULL);
}

TEST(an_eye_outside_of_a_light_field_is_one_warning) {
    put_scene("");
    test_shell_errors("$gray -q scene.lua && $gray view scene.lf -o %d.png --eye 0,0,0:5,0,0:7,0,0 --frames 9 && "
                      "test -e 9.png && ! test -e 10.png",
                      0, "--eye: rays from outside of the field are taken from its border");
    size_t size;
    char *said = test_read_file(test_path("err.txt"), &size);
    CHECK(strchr(said, '\n') == said + size - 1);
    free(said);
    test_shell_errors("$gray view scene.lf -o e.png --eye 0.2,0.1,0", 0, NULL);
}

TEST(gray_view_refuses_what_it_cannot_show_with_one_line) {
    put_scene("");
    test_shell_errors("$gray -q scene.lua; head -c 5000 scene.lf >cut.lf; $gray view cut.lf -o x.png", 1,
                      "cut.lf: is damaged: it has no table of its views");
    test_shell_errors("cp scene.lua foreign.lf; $gray view foreign.lf -o x.png", 1, "foreign.lf: is no light field");
    test_shell_errors("$gray view nothing.lf -o x.png", 1, "nothing.lf: cannot be read");
    test_shell_errors("$gray -q scene.lua -o p.png; $gray view p.png -o x.png", 1,
                      "p.png: is 225 x 100; a panorama is twice as wide as high, or a 4 x 3 cross of six faces");
    test_shell_errors("$gray view scene.lf", 2, "view needs -o FILE");
    test_shell_errors("$gray view -o x.png", 2, "view needs one light field or panorama");
    test_shell_errors("$gray view scene.lf -o x.png --eye 1", 2,
                      "--eye 1: needs X,Y or X,Y,Z, and ':' between several");
    test_shell_errors("$gray view scene.lf -o x.png --eye 1,a", 2, "--eye 1,a: needs numbers with commas between them");
    test_shell_errors("$gray view scene.lf -o x.png --eye 0,0,9", 2, "--eye: 9 is behind the plane in focus");
    test_shell_errors("$gray view scene.lf -o x.png --direction 1,2", 2,
                      "--direction is not for scene.lf, which is a light field");
    test_shell_errors("$gray view scene.lf -o x.png --frames 3", 2, "frames need an animation, such as x.gif");
    test_shell_errors("$gray view scene.lf -o x.png --spp 3", 2, "view cannot be combined with --spp");
    test_shell_errors("$gray scene.lua --eye 1,2", 2, "--eye is for gray view");
    test_shell_errors("$gray view scene.lf --force -o scene.lf", 1, "scene.lf");
    test_shell_errors("test -e x.png", 1, NULL);
}

TEST(fields_that_a_light_field_cannot_have_are_one_line) {
    put_scene("aperture = 0.1");
    test_shell_errors("$gray scene.lua", 1, "the views of a light field are perspective pictures through pinholes");
    put_scene("width = 20");
    test_shell_errors("$gray scene.lua", 1, "size and width, height exclude each other");
    put_scene("overlay = 1");
    test_shell_errors("$gray scene.lua", 1, "overlay");
    put_scene("");
    test_shell_errors("$gray scene.lua --crop 0,0,9,9", 1, "a light field cannot be combined with --crop or --overlay");
    test_shell_errors("$gray -q scene.lua --turntable 2 -o x.gif", 0, NULL);
    put_scene("depth = true");
    test_shell_errors("$gray scene.lua --turntable 2 -o x.gif", 1,
                      "a light field with depths cannot be a frame of an animation");
    put_scene("");
    test_shell_errors("$gray scene.lua --size 500000x9", 1,
                      "a light field of 1500000 x 18 pixels; its grid has at most 1048576 on a side");
}

/* Denoising and finishing treat a view as the picture that it is. */
TEST(a_light_field_of_one_view_is_the_picture_of_its_camera) {
    static const char *const fields[] = {"samples = 3, line_width = 2, bloom = 0.4, fxaa = true",
                                         "integrator = 'path', spp = 8, denoise = true, vignette = 0.5"};
    for (int i = 0; i < 2; i++) {
        char text[512];
        (void)snprintf(
            text, sizeof text,
            "local s = gr.sphere{material = gr.material{kd = {0.8, 0.3, 0.2}, ks = {0.3, 0.3, 0.3}}}\n"
            "for _, file in ipairs{'a.png', 'b.png'} do gr.render{node = s, file = file, width = 90, height = 70,\n"
            "  eye = {1, 2, 5}, target = {0, 0, 0}, %s, rows = file == 'b.png' and 1 or nil} end\n",
            fields[i]);
        test_write_text(test_path("scene.lua"), text);
        test_shell_errors("$gray -q scene.lua && cmp a.png b.png", 0, NULL);
    }
}

/* A panorama of a scene, and a perspective picture of it from the same place. */
TEST(a_view_of_a_panorama_is_the_perspective_picture_there) {
    test_write_text(test_path("scene.lua"),
                    "local function f(d) return gr.vec(0.5 + 0.4 * d.x, 0.5 + 0.4 * d.y, 0.5 + 0.4 * d.z) end\n"
                    "local s = gr.node('nothing')\n"
                    "local c = {node = s, eye = {0, 0, 0}, background = f, width = 800, height = 400, samples = 1}\n"
                    "c.file = 'pano.png'; c.projection = 'panorama'; c.view = {0, 0, -1}; gr.render(c)\n"
                    "c.projection = nil; c.width = 64; c.height = 48; c.fov = 60\n"
                    "for i, v in ipairs{{0, 0, -1}, {1, 0, 0}, {0, 0.5, -0.75 ^ 0.5}, {-0.5, -0.5, -0.5 ^ 0.5}} do\n"
                    "  c.file = 'one' .. i .. '.png'; c.view = v; gr.render(c) end\n");
    test_shell_errors("$gray -q scene.lua && i=0; for d in 0,0 90,0 0,30 -35.26438968,-30; do i=$((i + 1)); "
                      "$gray view pano.png -o v.png --size 64x48 --fov 60 --direction=$d && "
                      "$gray compare --threshold 3 v.png one$i.png || exit; done; "
                      "$gray view pano.png -o turn.gif --size 32x24 --direction 0,0:360,0 --frames 4 --loop",
                      0, NULL);
}

TEST(a_view_of_six_faces_is_the_picture_with_that_sky) {
    size_t size;
    char *bytes = test_read_file("textures/sky_letters.png", &size);
    test_write_file(test_path("cross.png"), bytes, size);
    free(bytes);
    test_write_text(test_path("scene.lua"),
                    "for i, v in ipairs{{0, 0, 1}, {-1, 0, 0}, {0.5, 0, -0.75 ^ 0.5}, {0, 1, 0.01}} do\n"
                    "  gr.render{node = gr.node('nothing'), file = 'one' .. i .. '.png', sky = 'cross.png', view = v,\n"
                    "    eye = {0, 0, 0}, width = 64, height = 48, fov = 60, samples = 1} end\n");
    test_shell_errors("$gray -q scene.lua && i=0; for d in 0,0 90,0 -150,0 0,89.4271; do i=$((i + 1)); "
                      "$gray view cross.png -o v.png --size 64x48 --fov 60 --direction=$d && "
                      "$gray compare --threshold 2 v.png one$i.png || exit; done",
                      0, NULL);
}
