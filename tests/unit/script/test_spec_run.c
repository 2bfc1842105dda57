/* The promises of the command line and the renderer (docs/language.md 10, 12.3, 13), each recomputed or counted here.
 */
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const uint8_t *pixel(const struct test_picture *p, uint32_t x, uint32_t y) {
    return p->rgb + 3 * ((size_t)y * p->width + x);
}

static void renders(const char *scene, const char *arguments) {
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "status %d: %s", result.status, result.err);
    test_free_result(&result);
}

/* --- anti-aliasing --- */

#define MANY_BALLS                                                                                                     \
    "local root = gr.node('root')\n"                                                                                   \
    "for i = 1, 40 do local c = {math.random(), math.random(), math.random()}\n"                                       \
    "root:add_child(gr.nh_sphere(gr.material(c, {.3,.3,.3}, 20), {math.random()*6-3, math.random()*4-2, "              \
    "math.random()*2-1}, .2+math.random()*.4)) end\n"                                                                  \
    "gr.render(root, 't.png', 117, 83, {0,0,8}, {0,0,-1}, {0,1,0}, 35, {.3,.3,.3}, {gr.light({3,5,6}, {.8,.8,.8}, "    \
    "{1,0,0}), gr.area_light({-5,4,4}, {1,0,0}, {0,1,0}, {.3,.3,.3}, {1,0,0})})\n"

/* Bytes are rounded: the squared distance of two colours lies between these bounds. */
static void bounds(const uint8_t *a, const uint8_t *b, double *low, double *high) {
    *low = *high = 0;
    for (int k = 0; k < 3; k++) {
        int d = abs(a[k] - b[k]);
        *low += d > 0 ? (d - 1) * (d - 1) / 65025.0 : 0;
        *high += (d + 1) * (d + 1) / 65025.0;
    }
}

static void check_marks(const char *options, double side, double corner) {
    char arguments[300];
    (void)snprintf(arguments, sizeof arguments,
                   "--aa-pattern grid -write-pre-aa pre- -write-aa-targets aim- %s scene.lua", options);
    renders(MANY_BALLS, arguments);
    struct test_picture pre = test_read_picture(test_path("pre-t.png")),
                        aim = test_read_picture(test_path("aim-t.png")), done = test_read_picture(test_path("t.png"));
    int wrong = 0, sure = 0, touched = 0;
    for (int y = 0; y < 83; y++) {
        for (int x = 0; x < 117; x++) {
            const uint8_t *own = pixel(&pre, (uint32_t)x, (uint32_t)y), *t = pixel(&aim, (uint32_t)x, (uint32_t)y);
            bool must = false, may = false, red = t[0] == 255 && t[1] == 0 && t[2] == 0;
            for (int k = 0; k < 9; k++) {
                int nx = x + k % 3 - 1, ny = y + k / 3 - 1;
                double low, high, tolerance = k % 2 ? side : corner;
                if (k == 4 || nx < 0 || ny < 0 || nx >= 117 || ny >= 83)
                    continue;
                bounds(own, pixel(&pre, (uint32_t)nx, (uint32_t)ny), &low, &high);
                must = must || low > tolerance;
                may = may || high > tolerance;
            }
            sure += must == may;
            wrong += (must && !red) || (!may && red);
            touched += !red && memcmp(own, pixel(&done, (uint32_t)x, (uint32_t)y), 3) != 0;
        }
    }
    CHECK_EQ_INT(wrong, 0);
    CHECK_EQ_INT(touched, 0);
    CHECK(sure > 5000);
    free(pre.rgb);
    free(aim.rgb);
    free(done.rgb);
}

TEST(marked_pixels_are_those_of_the_rule_recomputed_from_the_first_pass) {
    check_marks("", 0.005, 0.01);
    check_marks("-side-tolerance 0.05 -corner-tolerance 0.002", 0.05, 0.002);
    check_marks("-side-tolerance 0.3 -corner-tolerance 0.3", 0.3, 0.3);
}

/* The right edge of a white square runs through the pixels of column 10 at the fraction 0.3 of their width. */
TEST(samples_of_a_pixel_are_the_centres_of_n_by_n_cells) {
    static const struct { int n, covered; } cases[] = {{1, 0}, {2, 1}, {3, 1}, {4, 1}, {6, 2}, {10, 3}};
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        for (int full = 0; full < 2; full++) {
            char arguments[100];
            (void)snprintf(arguments, sizeof arguments, "--aa-pattern grid -ss %d %s scene.lua", cases[k].n,
                           full ? "-full" : "");
            renders("local r = gr.node('r') r:add_child(gr.nh_box(gr.material({1,1,1},{0,0,0},1), {-99.7, -50, -100}, "
                    "100))\n"
                    "gr.render{node=r, file='t.png', width=20, height=20, eye={0,0,10}, fov=90, ambient={1,1,1}, "
                    "background={0,0,0}}\n",
                    arguments);
            struct test_picture p = test_read_picture(test_path("t.png"));
            double share = (double)cases[k].covered / cases[k].n;
            CHECK_EQ_INT(pixel(&p, 10, 5)[1], (int)floor(255 * share + 0.5));
            CHECK_EQ_INT(pixel(&p, 9, 5)[1], 255);
            CHECK_EQ_INT(pixel(&p, 11, 5)[1], 0);
            free(p.rgb);
        }
    }
}

TEST(the_corner_of_a_pixel_is_where_old_programs_took_their_sample) {
    renders("local r = gr.node('r') r:add_child(gr.nh_box(gr.material({1,1,1},{0,0,0},1), {-99.7, -50, -100}, 100))\n"
            "gr.render{node=r, file='t.png', width=20, height=20, eye={0,0,10}, fov=90, ambient={1,1,1}, "
            "background={0,0,0}, side_tolerance=9, corner_tolerance=9}\n",
            "--pixel-sample corner scene.lua");
    struct test_picture p = test_read_picture(test_path("t.png"));
    CHECK_EQ_INT(pixel(&p, 10, 5)[0], 255);
    CHECK_EQ_INT(pixel(&p, 11, 5)[0], 0);
    free(p.rgb);
}

TEST(bytes_are_255_c_rounded_at_the_half_after_clamping) {
    renders("for i = 0, 9 do local c = {(i * 28 + 0.49) / 255, (i * 28 + 0.51) / 255, i == 0 and -3 or i}\n"
            "gr.render{node=gr.node('r'), file=i .. '.png', width=1, height=1, eye={0,0,0}, background=c} end\n",
            "scene.lua");
    for (int i = 0; i < 10; i++) {
        char name[20];
        (void)snprintf(name, sizeof name, "%d.png", i);
        struct test_picture p = test_read_picture(test_path(name));
        CHECK_EQ_INT(pixel(&p, 0, 0)[0], i * 28);
        CHECK_EQ_INT(pixel(&p, 0, 0)[1], i * 28 + 1);
        CHECK_EQ_INT(pixel(&p, 0, 0)[2], i == 0 ? 0 : 255);
        free(p.rgb);
    }
}

/* --- area lights --- */

/* A post casts the penumbra of a long light on the ground: every pixel sees k of the N x N cells, and k differs from
 * the closed form by at most one column of cells (a ray never leaves its cell). */
TEST(the_share_of_an_area_light_is_counted_in_cells_and_true_to_one_column) {
    static const int sizes[] = {1, 2, 4, 8, 16};
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        char arguments[200];
        int n = sizes[s], fractions = 0, wrong = 0, off = 0;
        (void)snprintf(arguments, sizeof arguments, "-al-samples %d -side-tolerance 9 -corner-tolerance 9 scene.lua",
                       n);
        /* Ground y = 0, wall x < 0 from y = 4 to 5, light x in [-1, 1] at y = 10: at ground x the wall's edge (0, 4 or
         * 5) covers the light's part below x_l = x - x * 10 / 4 (seen past the lower edge) ... and to the right of it.
         */
        renders("local r = gr.node('r') local m = gr.material({1,1,1},{0,0,0},1)\n"
                "r:add_child(gr.nh_box(m, {-50,-100,-50}, 100))\n"
                "r:add_child(gr.nh_box(m, {-60,4,-30}, {60,1,60}))\n"
                "gr.render{node=r, file='t.png', width=101, height=3, eye={0,3,0}, view={0,-1,0}, up={0,0,-1}, "
                "fov=2, background={0,0,0}, lights={gr.area_light({-1,10,-1}, {2,0,0}, {0,0,2}, {1,1,1}, {0,0,0})}}\n",
                arguments);
        struct test_picture p = test_read_picture(test_path("t.png"));
        for (uint32_t x = 0; x < 101 && p.rgb; x++) {
            /* the pixel's place on the ground and the light's visible part: rays pass right of (0, 4) and of (0, 5) */
            double half = tan(3.14159265358979323846 / 180), at = (x + .5 - 50.5) * 2 * half / 3 * 3;
            double edge4 = at - at * 10 / 4, edge5 = at - at * 10 / 5, edge = fmax(edge4, edge5);
            double share = fmin(1, fmax(0, (1 - edge) / 2)), full = 10 / sqrt(at * at + 100);
            double cells = pixel(&p, x, 1)[1] / 255.0 / full * n * n;
            fractions += cells > 0.5 && cells < n * n - 0.5;
            wrong += fabs(cells - round(cells)) > 0.01 * n * n;
            off += fabs(round(cells) - share * n * n) > n + 1e-9;
        }
        CHECK_EQ_INT(wrong, 0);
        CHECK_EQ_INT(off, 0);
        CHECK(n == 1 || fractions > 3);
        free(p.rgb);
    }
}

/* --- the same bytes --- */

#define MATHS                                                                                                          \
    "local r = gr.node('r')\n"                                                                                         \
    "local base = gr.rr_material({.9,.8,.3}, {.5,.5,.5}, math.sin(3)*10 + 20, .3, 0, 1)\n"                             \
    "local looks = {gr.marble_pnd_material(base, 1.3, 4, 5, 1, {.1,.2,.3}), gr.wood_pnd_material(base, 2^0.5, 7, 0, "  \
    "{.2,.1,.05}), gr.difresnel_material(gr.rr_material({0,0,0}, {1,1,1}, 100, 1, 1, 1.5))}\n"                         \
    "for i = 1, 30 do r:add_child(gr.nh_sphere(looks[i % 3 + 1], {math.sin(i)*3, math.cos(i*1.7)*2, "                  \
    "math.exp(-i/10)*3 - 2^(i/20)}, .3 + math.log(i)/9 + math.pow(i, .3)/20 + math.random()/5)) end\n"                 \
    "r:rotate('y', 33)\n"                                                                                              \
    "for i = 1, 60 do local x = i*0.37 - 9 for _, f in ipairs{math.sin, math.cos, math.tan, math.exp, math.atan} do "  \
    "io.write(string.format('%a ', f(x))) end io.write(string.format('%a %a\\n', math.abs(x)^3.3, "                    \
    "math.log(math.abs(x), 10))) end\n"                                                                                \
    "gr.render(r, 'w.png', 90, 60, {0,1,12}, {0,-.1,-1}, {0,1,0}, 40, {.3,.3,.3}, {gr.area_light({-5,7,3}, {2,0,0}, "  \
    "{0,0,2}, {.9,.9,.9}, {1,0,0})})\n"

TEST(a_processor_without_fused_operations_gives_the_same_bytes_in_script_and_picture) {
    static const char *const environments[] = {NULL, "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2",
                                               "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2,-AVX,-FMA4,-AVX512F"};
    char path[600], *first = NULL, *said = NULL;
    size_t size = 0;
    (void)snprintf(path, sizeof path, "%s/w.png", test_folder());
    for (int k = 0; k < 3; k++) {
        struct test_result result = test_gray_scene(MATHS, "scene.lua", environments[k]);
        CHECK_EQ_INT(result.status, 0);
        size_t here = 0;
        char *bytes = test_read_file(path, &here);
        if (k == 0) {
            first = bytes, said = result.out, size = here;
            CHECK(size > 1000 && strlen(said) > 5000);
        } else {
            CHECK(here == size && bytes && memcmp(bytes, first, size) == 0);
            CHECK_TEXT(result.out, said);
            free(bytes);
            free(result.out);
        }
        free(result.err);
    }
    free(first);
    free(said);
}

/* --- what does not change is not built again --- */

static double number_after(const char *text, const char *word) {
    const char *at = strstr(text, word);
    return at ? strtod(at + strlen(word), NULL) : NAN;
}

TEST(three_hundred_pictures_with_one_moving_node_build_the_mesh_once) {
    struct test_result result = test_gray_scene(
        "local v, f = {}, {}\n"
        "for i = 0, 199 do for j = 0, 199 do v[#v+1] = {i/199, math.sin(i*j/500)*.2, j/199} end end\n"
        "for i = 0, 198 do for j = 0, 198 do local a = i*200+j f[#f+1] = {a, a+1, a+201, a+200} end end\n"
        "local m, r = gr.material({1,0,0},{0,0,0},1), gr.node('r')\n"
        "local ball = gr.sphere('b') ball:set_material(m)\n"
        "for k = 1, 300 do ball:translate(.01,0,0)\n"
        "if k <= 2 or k == 150 then r = gr.node('r') local n = gr.mesh('g', v, f) n:set_material(m) r:add_child(n) "
        "r:add_child(ball) end\n"
        "gr.render(r, 'p.png', 8, 8, {.5,2,3}, {0,-.7,-1}, {0,1,0}, 50, {1,1,1}, {}) end\n",
        "-q --stats=json --transform-order new scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    double first = number_after(result.out, "\"build_seconds\":"), rest = 0;
    int pictures = 0;
    for (const char *line = result.out; (line = strstr(line, "\"build_seconds\":")); line++, pictures++)
        rest += pictures ? number_after(line, "\"build_seconds\":") : 0;
    CHECK_EQ_INT(pictures, 300);
    CHECK(rest < 299 * first / 20); /* each of the other renders takes less than a twentieth */
    CHECK(number_after(result.out, "\"triangles\":") == 2 * 199 * 199);
    test_free_result(&result);
}

TEST(a_hundred_thousand_nodes_are_scripted_and_drawn) {
    struct test_result result =
        test_gray_scene("local m, r = gr.material({1,0,0},{0,0,0},1), gr.node('r')\n"
                        "for i = 1, 100000 do local n = gr.sphere('s'..i) n:set_material(m) n:scale(.4,.4,.4) "
                        "n:translate(i%300 - 150, i//300 - 150, -300) r:add_child(n) end\n"
                        "gr.render(r, 'p.png', 64, 64, {0,0,0}, {0,0,-1}, {0,1,0}, 50, {1,1,1}, {})\n",
                        "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
}

/* --- names and files --- */

TEST(the_library_works_in_scripts_that_use_the_names_of_luas_own_libraries) {
    test_write_text(test_path("tetra.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    renders(
        "table = gr.node('table')\n"
        "local load, say = require, print\n"
        "for _, n in ipairs{'string','math','io','os','package','debug','ipairs','pairs','tostring','type','error',"
        "'assert','select','next','setmetatable','tonumber','pcall','print','unpack','rawget','require'} do "
        "_G[n] = nil end\n"
        "local names = {'readobj','bezier','carve','font','knot','lathe','meshes','noise','picture','png','polyhedra',"
        "'sweep','teapot','archimedean','check','colour','conway','easing','fractals','gear','loft','lsystem',"
        "'random','scatter','terrain','polygon','text'}\n"
        "for i = 1, #names do load(names[i]) end\n"
        "local vertices, faces = readobj('tetra.obj')\n"
        "local thing = gr.mesh('thing', vertices, faces) thing:set_material(gr.material({1,0,0},{0,0,0},1))\n"
        "table:add_child(thing)\n"
        "gr.render(table, 't.png', 8, 8, {0,0,5}, {0,0,-1}, {0,1,0}, 50, {1,1,1}, {})\n"
        "if string ~= nil or math ~= nil then gr.node(gr) end\n",
        "-q --transform-order new scene.lua");
}

TEST(the_library_finds_its_own_modules_where_the_script_has_files_of_their_names) {
    char path[600];
    (void)snprintf(path, sizeof path, "%s/meshes.lua", test_folder());
    test_write_text(path, "return {mine = true}\n");
    (void)snprintf(path, sizeof path, "%s/check.lua", test_folder());
    test_write_text(path, "error('the wrong file')\n");
    renders("local lathe, again = require 'lathe', require 'knot'\n"
            "if require 'meshes'.mine ~= true then gr.node(1) end\n"
            "local verts, normals, faces, face_normals = lathe.turn{{0, 0}, {1, 0}, {0, 1}}\n"
            "local red = gr.material({1, 0, 0}, {0, 0, 0}, 1)\n"
            "gr.render(gr.vn_mesh(red, verts, normals, faces, face_normals), 't.png', 8, 8, {0, 0, 5}, {0, 0, -1}, {0, "
            "1, 0}, 50, {1, 1, 1}, {})\n",
            "-q scene.lua");
}

TEST(missing_folders_are_made_and_whole_numbers_in_names_lose_their_fraction) {
    struct test_result result = test_gray_scene(
        "for i = 1, 3 do gr.render{node=gr.node('r'), file='a/b' .. i/1 .. '/x' .. i/1 .. '.png', width=2, "
        "height=2, eye={0,0,0}} end\n",
        "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    const char *notice = strstr(result.err, "lose their .0");
    CHECK(notice && !strstr(notice + 1, "lose their .0"));
    struct test_picture p = test_read_picture(test_path("a/b3/x3.png"));
    CHECK(p.width == 2);
    free(p.rgb);
    test_free_result(&result);
}

TEST(check_reports_every_picture_that_cannot_be_made_with_the_line_of_its_call) {
    struct test_result result = test_gray_scene(
        "local flap = {{0,0,0},{1,0,0},{0,1,0}}\n"
        "local d = gr.difference('d', gr.cube('a'), gr.node('g'):add_child(gr.mesh('open', flap, {{0,1,2}})))\n"
        "gr.render(d, '1.png', 8, 8, {0,0,5}, {0,0,-1}, {0,1,0}, 50, {1,1,1}, {})\n"
        "gr.render{node=gr.node('n'), file='2.png', width=8, height=8, eye={0,0,5}, target={0,0,5}}\n"
        "gr.render(gr.node('n'), '3.png', 8, 8, {0,0,5}, {0,0,1}, {0,1,0}, 50, {1,1,1}, {})\n"
        "gr.sphere(false)\n",
        "-q --check scene.lua", NULL);
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.err, "scene.lua:3: gr.render: node 'open' is an operand of CSG but its mesh is open"));
    CHECK(strstr(result.err, "scene.lua:4: gr.render: view: the point to look at must differ from the eye\n"));
    CHECK(strstr(result.err, "scene.lua:6: gr.sphere: "));
    CHECK(access(test_path("3.png"), F_OK) != 0);
    test_free_result(&result);
}

/* --- large meshes --- */

TEST_LONG(an_obj_of_a_million_triangles_is_a_picture_in_seconds_and_200_bytes_a_triangle) {
    enum { SIDE = 709 };
    size_t room = (size_t)80 << 20, used = 0;
    char *text = malloc(room);
    if (!text)
        return;
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < SIDE; j++)
            used += (size_t)snprintf(text + used, room - used, "v %.5f %.5f %.5f\n", (double)i / SIDE - .5,
                                     .05 * sin(i * .05) * cos(j * .07), (double)j / SIDE - .5);
    for (int i = 0; i + 1 < SIDE; i++)
        for (int j = 0; j + 1 < SIDE; j++) {
            int a = i * SIDE + j + 1;
            used += (size_t)snprintf(text + used, room - used, "f %d %d %d\nf %d %d %d\n", a, a + 1, a + SIDE + 1, a,
                                     a + SIDE + 1, a + SIDE);
        }
    test_write_file(test_path("big.obj"), text, used);
    free(text);
    struct test_result result = test_gray_scene(
        "local r, s = gr.node('r'), gr.mesh('h', 'big.obj') s:set_material(gr.material({1,0,0},{.5,.5,.5},20)) "
        "r:add_child(s)\n"
        "gr.render(r, 'big.png', 200, 150, {0,1,1}, {0,-1,-1}, {0,1,0}, 50, {.3,.3,.3}, {gr.light({0,5,5}, {1,1,1}, "
        "{1,0,0})})\n",
        "--stats=json scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    double triangles = number_after(result.out, "\"triangles\":"), peak = number_after(result.out, "\"peak_bytes\":");
    CHECK(triangles > 1e6);
    if (!strstr(GRAY_CONFIG, "san"))
        CHECK(peak < 200 * triangles); /* the complete process, including reading the text */
    test_free_result(&result);
}

static void write_in(const char *name, const char *text) {
    test_write_text(test_path(name), text);
}

static void make_folder(const char *name) {
    CHECK(mkdir(test_path(name), 0777) == 0);
}

/* Each folder gets a mesh file with as many triangles as its rank: the count shows which file was read. */
TEST(files_are_looked_for_beside_the_scene_then_here_then_in_assets_then_by_their_bare_name) {
    static const char *const files[] = {"a/s/m/x.obj", "m/x.obj", "a/s/Assets/m/x.obj", "a/Assets/m/x.obj",
                                        "a/s/x.obj"};
    static const char *const folders[] = {"a",          "a/s",          "a/s/m",    "m",
                                          "a/s/Assets", "a/s/Assets/m", "a/Assets", "a/Assets/m"};
    for (size_t k = 0; k < sizeof folders / sizeof folders[0]; k++)
        make_folder(folders[k]);
    write_in("a/s/scene.lua", "local n = gr.mesh('n', 'm/x.obj') n:set_material(gr.material({1,0,0},{0,0,0},1))\n"
                              "gr.render{node=n, file='t.png', width=2, height=2, eye={0,0,5}}\n");
    for (size_t k = 0; k < 5; k++) {
        char text[400] = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
        for (size_t i = 0; i <= k; i++)
            strcat(text, "f 1 2 3\n");
        write_in(files[k], text);
    }
    for (size_t k = 0; k < 5; k++) {
        struct test_result result = test_gray(NULL, "--stats=json a/s/scene.lua");
        CHECK_EQ_INT(result.status, 0);
        CHECK_EQ_INT((int)number_after(result.out, "\"triangles\":"), (int)k + 1);
        test_free_result(&result);
        char path[600];
        (void)snprintf(path, sizeof path, "%s/%s", test_folder(), files[k]);
        CHECK(unlink(path) == 0);
    }
}

TEST(pictures_can_be_named_after_their_script) {
    write_in("ball.lua",
             "#!/usr/bin/env gray\n"
             "local me = debug.getinfo(1, 'S').source\n"
             "local name = string.gsub(string.gsub(me, '@', ''), '.lua', '')\n"
             "gr.render(gr.node('n'), name .. '.png', 3, 2, {0,0,5}, {0,0,-1}, {0,1,0}, 50, {0,0,0}, {})\n");
    struct test_result result = test_gray(NULL, "ball.lua");
    CHECK_EQ_INT(result.status, 0);
    struct test_picture p = test_read_picture(test_path("ball.png"));
    CHECK(p.width == 3 && p.height == 2);
    free(p.rgb);
    test_free_result(&result);
}

TEST(a_name_that_no_picture_can_have_is_an_error_of_the_scene_at_its_line) {
    struct test_result result = test_gray_scene(
        "local n = gr.node('n')\n"
        "print(pcall(gr.render, n, 'scene.lua/x.png', 2, 2, {0,0,5}, {0,0,-1}, {0,1,0}, 50, {0,0,0}, {}))\n"
        "print(pcall(gr.render, n, 'scene.lua/y/x.png', 2, 2, {0,0,5}, {0,0,-1}, {0,1,0}, 50, {0,0,0}, {}))\n"
        "gr.render(n, 'scene.lua/x.png', 2, 2, {0,0,5}, {0,0,-1}, {0,1,0}, 50, {0,0,0}, {})\n",
        "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.out, "false\tscene.lua:2: gr.render: scene.lua/x.png: "));
    CHECK(strstr(result.out, "false\tscene.lua:3: gr.render: scene.lua/y/x.png: "));
    CHECK(strncmp(result.err, "scene.lua:4: gr.render: scene.lua/x.png: ", 41) == 0);
    test_free_result(&result);
}
