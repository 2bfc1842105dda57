/* Which transform order the text of a scene implies (docs/language.md 12.4), and the effect of each order.
 */
#include "compat/order.h"
#include "tests/unit/script_host.h"

#include <sys/stat.h>

static struct order_finding order_of(const char *text) {
    struct order_finding finding;
    order_of_text(text, strlen(text), &finding);
    return finding;
}

static void expect(enum transform_order order, const char *reason, const char *text) {
    struct order_finding finding = order_of(text);
    if (finding.order != order || strcmp(finding.reason, reason) != 0)
        test_fail(__FILE__, __LINE__, "%s: order %d because \"%s\"", text, (int)finding.order, finding.reason);
}

TEST(names_of_the_project_dialect_mean_new) {
    static const char *const names[] = {
        "fast_mesh",         "vn_mesh",          "fast_vn_mesh",       "rr_material",        "marble_pnd_material",
        "wood_pnd_material", "td_cube_material", "td_sphere_material", "difresnel_material", "geometry",
        "csg_union",         "csg_difference",   "csg_intersection",   "area_light",         "render_skybox"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++) {
        char text[200];
        (void)snprintf(text, sizeof text, "local x = unpack(t)\nx = gr.%s(a, b)", names[k]);
        expect(TRANSFORM_ORDER_NEW, "it uses names of the project dialect (line 2)", text);
    }
}

TEST(the_text_shows_whether_all_pictures_are_named_and_without_a_background) {
    static const char *const named[] = {"gr.render{node = n}",
                                        "gr.render({node = n})",
                                        "n:render{file = 'x.png'}",
                                        "-- gr.render(n)\ngr.render {node = n, file = 'background = 1'}",
                                        "gr.frames{count = 2, draw = draw}",
                                        "gr.frames(2, draw) gr.render{node = n}"};
    static const char *const others[] = {"gr.render(n, 'x.png')",
                                         "gr.render{node = n} gr.render(n)",
                                         "local r = gr.render r{}",
                                         "gr.render{node = n, background = {1, 1, 1}}",
                                         "gr.render{node = n, sky = 'x'}",
                                         "gr.render_skybox{node = n} gr.render{node = n}",
                                         "n:render('x.png')",
                                         "g['render']{node = n}",
                                         "gr.frames{count = 2, draw = function() return {background = {1, 1, 1}} end}",
                                         "gr.frames(2, draw) gr.render(n)",
                                         "frames{count = 2}",
                                         ""};
    for (size_t i = 0; i < sizeof named / sizeof *named; i++)
        if (!order_of(named[i]).only_named_pictures)
            test_fail(__FILE__, __LINE__, "%s: not only named pictures", named[i]);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (order_of(others[i]).only_named_pictures)
            test_fail(__FILE__, __LINE__, "%s: only named pictures", others[i]);
}

TEST(the_text_shows_whether_there_are_several_pictures) {
    static const char *const several[] = {"gr.render{node = n} gr.render{node = m}",
                                          "gr.render(n, 'x.png') n:render{}",
                                          "for i = 1, 3 do gr.render{node = n} end",
                                          "while f() do if g() then gr.render{node = n} end end",
                                          "repeat gr.render{node = n} until true",
                                          "for i = 1, 3 do local f = function() return 1 end gr.render{node = n} end"};
    static const char *const one[] = {"gr.render{node = n}",
                                      "gr.render({node = n})",
                                      "for i = 1, 3 do n:add_child(m) end gr.render{node = n}",
                                      "do gr.render{node = n} end",
                                      "function f() gr.render{node = n} end f()",
                                      "repeat x = x + 1 until x > 3 if x then gr.render{node = n} end",
                                      "while f() do g() end do n:render{} end",
                                      ""};
    for (size_t i = 0; i < sizeof several / sizeof *several; i++)
        if (!order_of(several[i]).several_pictures)
            test_fail(__FILE__, __LINE__, "%s: not several pictures", several[i]);
    for (size_t i = 0; i < sizeof one / sizeof *one; i++)
        if (order_of(one[i]).several_pictures)
            test_fail(__FILE__, __LINE__, "%s: several pictures", one[i]);
}

TEST(other_signs_of_the_new_order) {
    expect(TRANSFORM_ORDER_NEW, "it uses tables with named fields (line 1)", "gr.sphere{radius = 1} readobj()");
    expect(TRANSFORM_ORDER_NEW, "it uses tables with named fields (line 1)", "gr.sphere({radius = 1}) readobj()");
    expect(TRANSFORM_ORDER_NEW, "it calls gr.transform_order (line 1)", "gr.transform_order('old') readobj()");
    expect(TRANSFORM_ORDER_NEW, "gr.mesh reads a file (line 1)", "c = gr.mesh('cow', 'cow.obj') unpack(x)");
    expect(TRANSFORM_ORDER_NEW, "gr.mesh reads a file (line 1)", "c = gr.mesh('cow', \"cow\" .. n .. '.obj')");
    expect(TRANSFORM_ORDER_NEW, "it uses table.unpack (line 1)", "local unpack = table.unpack or unpack");
    expect(TRANSFORM_ORDER_NEW, "a primitive is given its material (line 2)",
           "m = gr.material(a, b, 1)\ns = gr.sphere(m)");
    expect(TRANSFORM_ORDER_NEW, "gr.mesh is given a material (line 2)",
           "m = gr.material(a, b, 1)\nx = gr.mesh(m, {{0, 0, 0}}, {})");
}

TEST(signs_of_the_old_order) {
    expect(TRANSFORM_ORDER_OLD, "it uses readobj (line 2)", "-- cow\ncow = gr.mesh('cow', readobj('cow.obj'))");
    expect(TRANSFORM_ORDER_OLD, "it calls unpack, not table.unpack (line 1)", "n:translate(unpack(p))");
    expect(TRANSFORM_ORDER_OLD, "gr.mesh is given vertex tables (line 1)",
           "p = gr.mesh('p', {{0, 0, 0}}, {{0, 1, 2}})");
    expect(TRANSFORM_ORDER_OLD, "gr.mesh is given vertex tables (line 1)", "p = gr.mesh('p', verts, faces)");
    expect(TRANSFORM_ORDER_OLD, "gr.mesh is given vertex tables (line 1)",
           "p = gr.mesh(name('p', 1), make(1, 2), faces)");
}

TEST(scenes_without_signs_are_new) {
    expect(TRANSFORM_ORDER_NEW, "", "");
    expect(TRANSFORM_ORDER_NEW, "", "s = gr.sphere('s') s:scale(1, 2, 3) s:translate(1, 0, 0)");
    expect(TRANSFORM_ORDER_NEW, "", "c = gr.mesh('c', load_it())");
    expect(TRANSFORM_ORDER_NEW, "", "c = gr.mesh('c', name)");
}

TEST(comments_and_strings_are_no_signs) {
    expect(TRANSFORM_ORDER_NEW, "",
           "-- readobj unpack gr.vn_mesh\n--[[ readobj\nunpack ]] --[==[ ]] readobj ]==]\nx = 1");
    expect(TRANSFORM_ORDER_NEW, "",
           "x = 'readobj(1)' y = \"unpack \\\" unpack\" z = [[ unpack ]] w = [=[ ]] readobj ]=]");
    expect(TRANSFORM_ORDER_NEW, "", "#!readobj\nx = a.unpack(1) y = a:unpack(2) z = my.readobj(3)");
    expect(TRANSFORM_ORDER_OLD, "it uses readobj (line 4)", "x = 'a\\\nb' --[[\n]]\ny = 1 readobj()");
    expect(TRANSFORM_ORDER_NEW, "", "x = 'never closed\n y = [[ never closed unpack");
    expect(TRANSFORM_ORDER_NEW, "", "--[==[ never closed readobj");
    expect(TRANSFORM_ORDER_OLD, "it calls unpack, not table.unpack (line 1)", "a[b[1]] = unpack(x)");
}

static void write_in(const char *folder, const char *name, const char *text) {
    char path[1000];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    test_write_text(path, text);
}

static void expect_file(const char *name, const char *library, enum transform_order order, const char *reason) {
    struct order_finding finding;
    struct error error;
    CHECK(order_detect(test_path(name), library, NULL, &finding, &error));
    CHECK_EQ_INT(finding.order, order);
    CHECK_TEXT(finding.reason, reason);
}

TEST(required_files_are_read_too) {
    const char *folder = test_folder();
    write_in(folder, "a.lua", "require 'helper'\nlocal s = gr.sphere('s')\n");
    write_in(folder, "helper.lua", "require('deeper')\nrequire 'a'\n");
    write_in(folder, "deeper.lua", "\nfunction place(n, p) n:translate(unpack(p)) end\n");
    expect_file("a.lua", NULL, TRANSFORM_ORDER_OLD, "it calls unpack, not table.unpack (line 2)");
    write_in(folder, "b.lua", "dofile('deeper.lua') g = gr.geometry('g', p)\n");
    expect_file("b.lua", NULL, TRANSFORM_ORDER_NEW, "it uses names of the project dialect (line 1)");
}

TEST(the_library_says_nothing_about_a_scene) {
    char lua[600];
    const char *folder = test_folder();
    (void)snprintf(lua, sizeof lua, "%s/lua", folder);
    CHECK(mkdir(lua, 0777) == 0);
    write_in(lua, "thing.lua", "return readobj\n");
    write_in(folder, "a.lua", "require 'thing'\nlocal s = gr.sphere('s')\n");
    expect_file("a.lua", lua, TRANSFORM_ORDER_NEW, "");
    expect_file("a.lua", NULL, TRANSFORM_ORDER_OLD, "it uses readobj (line 1)");
}

TEST(neighbours_decide_when_the_scene_says_nothing) {
    const char *folder = test_folder();
    write_in(folder, "a.lua", "local s = gr.sphere('s')\n");
    expect_file("a.lua", NULL, TRANSFORM_ORDER_NEW, "");
    write_in(folder, "no_scene.lua", "print(unpack(x))\n");
    expect_file("a.lua", NULL, TRANSFORM_ORDER_NEW, "");
    write_in(folder, "cow.lua", "gr.mesh('cow', readobj('cow.obj'))\n");
    expect_file("a.lua", NULL, TRANSFORM_ORDER_OLD, "of its neighbour cow.lua: it uses readobj (line 1)");
    write_in(folder, "new.lua", "gr.mesh('cow', 'cow.obj')\n");
    expect_file("a.lua", NULL, TRANSFORM_ORDER_NEW, "");
}

/* The world position of the point (1,0,0) of the root's first child. */
static void expect_point(enum script_order order, const char *text, double x, double y, double z) {
    struct listener listener = {.renders = 0};
    struct script_options options = {.transform_order = order};
    struct error error;
    char scene[2000];
    (void)snprintf(scene, sizeof scene,
                   "local root, n = gr.node('root'), gr.node('n')\nroot:add_child(n)\n%s\n"
                   "gr.render(root, 'x.png', 8, 8, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {0, 0, 0}, {})\n",
                   text);
    CHECK(listen_to_text(&listener, scene, &options, &error));
    struct vec3 p = affine_point(&listener.first_child[0], (struct vec3){1, 0, 0});
    if (fabs(p.x - x) > 1e-12 || fabs(p.y - y) > 1e-12 || fabs(p.z - z) > 1e-12)
        test_fail(__FILE__, __LINE__, "order %d, %s: {%g, %g, %g}, not {%g, %g, %g}", (int)order, text, p.x, p.y, p.z,
                  x, y, z);
}

TEST(each_order_composes_as_it_says) {
    const char *scale_then_move = "n:scale(2, 2, 2) n:translate(1, 0, 0)";
    expect_point(SCRIPT_ORDER_NEW, scale_then_move, 3, 0, 0);
    expect_point(SCRIPT_ORDER_OLD, scale_then_move, 4, 0, 0);
    expect_point(SCRIPT_ORDER_SEPARATE, scale_then_move, 3, 0, 0);
    const char *move_turn_scale = "n:translate(5, 0, 0) n:rotate('z', 90) n:scale(3, 1, 1)";
    expect_point(SCRIPT_ORDER_NEW, move_turn_scale, 0, 6, 0);
    expect_point(SCRIPT_ORDER_OLD, move_turn_scale, 5, 3, 0);
    expect_point(SCRIPT_ORDER_SEPARATE, move_turn_scale, 5, 3, 0);
    const char *twice = "n:scale(2, 1, 1) n:rotate('z', 90) n:translate(1, 1, 1) n:rotate('z', 90) n:scale(2, 1, 1)";
    expect_point(SCRIPT_ORDER_SEPARATE, twice, -3, 1, 1);
}

/* The image of {0.3, -0.2, 0.9} under a node's calls. */
static struct vec3 point_after(enum script_order order, const char *calls) {
    char text[1000];
    struct listener listener = {.renders = 0};
    struct script_options options = {.transform_order = order};
    struct error error;
    (void)snprintf(text, sizeof text,
                   "local n, root = gr.sphere('n'), gr.node('root')\nroot:add_child(n)\n%s\n"
                   "gr.render(root, 'x.png', 1, 1, {0,0,5}, {0,0,-1}, {0,1,0}, 50, {0,0,0}, {})\n",
                   calls);
    CHECK(listen_to_text(&listener, text, &options, &error));
    CHECK_TEXT(error.text, "");
    return affine_point(&listener.first_child[0], vec3_make(0.3, -0.2, 0.9));
}

TEST(turns_by_axis_and_by_quaternion_are_turns_about_x_y_and_z_in_every_order) {
    static const char *const same[][2] = {
        {"n:rotate('x', 37)", "n:rotate_axis({2, 0, 0}, 37)"},
        {"n:rotate('y', -112)", "n:rotate_axis({0, 0.1, 0}, -112)"},
        {"n:rotate('z', 37)", "n:rotate_axis({0, 0, -1e-200}, -37)"},
        {"n:rotate('x', 90)", "n:rotate_quat(1, 1, 0, 0)"},
        {"n:rotate('y', 90)", "n:rotate_quat{5, 0, 5, 0}"},
        {"n:rotate('z', -90)", "n:rotate_quat(-1e-170, 0, 0, 1e-170)"},
        {"n:rotate('z', 180)", "n:rotate_quat({0, 0, 0, -3})"},
        {"n:rotate('z', 50)", "n:rotate_quat(math.cos(math.rad(25)), 0, 0, math.sin(math.rad(25)))"},
        {"", "n:rotate_quat(-2, 0, 0, 0)"},
        {"n:rotate_axis({1, 1, 1}, 120)", "n:rotate_quat(1, 1, 1, 1)"},
        {"n:rotate('x', 90) n:rotate('y', 90)", "n:rotate('x', 90) n:rotate_axis({0, 7, 0}, 90)"},
        {"n:translate(1, 2, 3) n:rotate('x', 20) n:scale(2, 1, 1) n:rotate('y', 30)",
         "n:translate(1, 2, 3) n:rotate_axis({3, 0, 0}, 20) n:scale(2, 1, 1) n:rotate_axis({0, 1, 0}, 30)"},
        {"n:scale(2, 1, 1) n:rotate('z', 90) n:translate(1, 1, 1) n:rotate('x', 90)",
         "n:scale(2, 1, 1) n:rotate_quat(1, 0, 0, 1) n:translate(1, 1, 1) n:rotate_quat({1, 1, 0, 0})"},
    };
    static const enum script_order orders[] = {SCRIPT_ORDER_NEW, SCRIPT_ORDER_OLD, SCRIPT_ORDER_SEPARATE};
    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++)
        for (int k = 0; k < 3; k++) {
            struct vec3 a = point_after(orders[k], same[i][0]), b = point_after(orders[k], same[i][1]);
            CHECK_NEAR(vec3_length(vec3_sub(a, b)), 0, 1e-14);
        }
    /* (1, 1, 1) and 120 degrees: x to y to z to x. The product of quaternions rotates by the right one first. */
    struct vec3 p = point_after(SCRIPT_ORDER_NEW, "n:rotate_quat(1, 1, 1, 1)");
    CHECK_NEAR(vec3_length(vec3_sub(p, vec3_make(0.9, 0.3, -0.2))), 0, 1e-15);
    struct vec3 one_by_one = point_after(SCRIPT_ORDER_NEW, "n:rotate_quat(1, 2, 3, 4) n:rotate_quat(2, -1, 0.5, 3)");
    struct vec3 product = point_after(SCRIPT_ORDER_NEW, "local function times(a, b)\n"
                                                        "  return {a[1]*b[1] - a[2]*b[2] - a[3]*b[3] - a[4]*b[4],\n"
                                                        "          a[1]*b[2] + a[2]*b[1] + a[3]*b[4] - a[4]*b[3],\n"
                                                        "          a[1]*b[3] - a[2]*b[4] + a[3]*b[1] + a[4]*b[2],\n"
                                                        "          a[1]*b[4] + a[2]*b[3] - a[3]*b[2] + a[4]*b[1]}\n"
                                                        "end\n"
                                                        "n:rotate_quat(times({2, -1, 0.5, 3}, {1, 2, 3, 4}))");
    CHECK_NEAR(vec3_length(vec3_sub(one_by_one, product)), 0, 1e-14);
    CHECK_NEAR(vec3_length(one_by_one), sqrt(0.09 + 0.04 + 0.81), 1e-14);
}

TEST(an_explicit_call_wins_over_the_text) {
    expect_point(SCRIPT_ORDER_AUTO, "gr.transform_order('old') n:scale(2, 2, 2) n:translate(1, 0, 0)", 4, 0, 0);
    expect_point(SCRIPT_ORDER_AUTO, "gr.transform_order('separate') n:translate(1, 0, 0) n:scale(2, 2, 2)", 3, 0, 0);
    expect_point(SCRIPT_ORDER_AUTO, "n:translate(unpack({1, 0, 0})) n:scale(2, 2, 2)", 3, 0, 0);
    expect_point(SCRIPT_ORDER_NEW, "n:translate(unpack({1, 0, 0})) n:scale(2, 2, 2)", 4, 0, 0);
}

TEST(auto_says_why_and_how_to_pin_it) {
    struct listener listener = {.renders = 0};
    struct script_options options = {.transform_order = SCRIPT_ORDER_AUTO};
    struct error error;
    CHECK(listen_to_text(&listener, "local x = 1\nlocal a = unpack({1})\n", &options, &error));
    CHECK(strstr(listener.said, "scene.lua: old transform order, because it calls unpack, not table.unpack (line 2); "
                                "set it with --transform-order old or gr.transform_order('old')\n"));
    listener = (struct listener){.renders = 0};
    CHECK(listen_to_text(&listener, "local a = gr.sphere('s')\n", &options, &error));
    CHECK_EQ_INT(listener.messages, 0);
    options.transform_order = SCRIPT_ORDER_OLD;
    CHECK(listen_to_text(&listener, "local a = unpack({1})\n", &options, &error));
    CHECK_EQ_INT(listener.messages, 0);
}
