/* Pictures of CSG that must be equal, byte for byte if two scripts describe the same solid. */
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* show(node, file, ...) renders it over a floor, before a gradient, with a point light and an area light. */
#define STAGE                                                                                                          \
    "red = gr.rr_material({.8,.2,.1},{.3,.3,.3},30,.2,0,1) blue = gr.material({.1,.2,.8},{.3,.3,.3},30)\n"             \
    "white = gr.material({.8,.8,.7},{0,0,0},1) glass = gr.rr_material({0,0,0},{.9,.9,.9},60,.1,.9,1.5)\n"              \
    "thin = gr.material{kd={.8,.7,.2}, ks={.2,.2,.2}, shininess=20, two_sided=true}\n"                                 \
    "function show(n, f, eye) local r = gr.node('r') r:add_child(n)\n"                                                 \
    "r:add_child(gr.box{min={-9,-2.2,-9}, max={9,-2,9}, material=white})\n"                                            \
    "gr.render{node=r, file=f, width=48, height=36, eye=eye or {2.5,2.2,6}, target={0,0,0}, fov=40,\n"                 \
    "ambient={.3,.3,.3}, lights={gr.light({5,8,6},{.6,.6,.6},{1,0,0}),\n"                                              \
    "gr.area_light({-5,7,2},{2,0,0},{0,0,2},{.5,.5,.4},{1,0,0})}} end\n"                                               \
    "function ball(m, x, y, z, r) return gr.sphere{material=m, centre={x,y,z}, radius=r} end\n"

static void renders(const char *text) {
    struct test_result result = test_gray_scene(text, "scene.lua", NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s\n%s", text, result.err);
    test_free_result(&result);
}

/* Pixels in which two pictures differ by more than `levels`. */
static uint32_t differing(const char *name_a, const char *name_b, int levels) {
    struct test_picture a = test_read_picture(test_path(name_a)), b = test_read_picture(test_path(name_b));
    uint32_t count = 0, size = a.width * a.height;
    CHECK(a.rgb && b.rgb && a.width == b.width && a.height == b.height);
    for (uint32_t i = 0; a.rgb && b.rgb && i < size; i++) {
        const uint8_t *in_a = &a.rgb[3 * i], *in_b = &b.rgb[3 * i];
        int max = 0;
        for (int k = 0; k < 3; k++)
            max = abs(in_a[k] - in_b[k]) > max ? abs(in_a[k] - in_b[k]) : max;
        count += max > levels;
    }
    free(a.rgb);
    free(b.rgb);
    return count;
}

/* The number of pixels that differ from the first one. */
static uint32_t varied(const char *name) {
    struct test_picture p = test_read_picture(test_path(name));
    uint32_t count = 0;
    for (uint32_t i = 0; p.rgb && i < p.width * p.height; i++)
        count += memcmp(p.rgb, p.rgb + 3 * i, 3) != 0;
    free(p.rgb);
    return count;
}

TEST(de_morgan_pictures_are_equal) {
    renders(STAGE
            "local function a() return ball(red,-.5,0,0,1.2):scale(1,.8,1):rotate('z',20) end\n"
            "local function b() return gr.box{min={-.4,-1,-1}, max={1.6,.6,1}, material=blue}:rotate('y',30) end\n"
            "show(gr.csg_intersection('i', a(), b()), 'a.png')\n"
            "show(gr.inverse('n', gr.union('u', gr.inverse(a()), gr.inverse(b()))), 'b.png')\n"
            "show(gr.union('u', a(), b()), 'c.png')\n"
            "show(gr.csg_inverse{name='n', a=gr.csg_intersection{gr.inverse(a()), gr.inverse(b())}}, 'd.png')\n"
            "show(gr.difference('d', a(), b()), 'e.png')\n"
            "show(gr.intersection('d', a(), gr.inverse('n', b())), 'f.png')\n"
            "show(gr.inverse(gr.inverse(gr.difference(a(), b()))), 'g.png')\n");
    CHECK_EQ_INT(differing("a.png", "b.png", 0), 0);
    CHECK_EQ_INT(differing("c.png", "d.png", 0), 0);
    CHECK_EQ_INT(differing("e.png", "f.png", 0), 0);
    CHECK_EQ_INT(differing("e.png", "g.png", 0), 0);
    CHECK(differing("a.png", "c.png", 8) > 150 && differing("a.png", "e.png", 8) > 150);
}

TEST(a_merge_is_the_union_and_renders_as_a_group_from_outside) {
    renders(STAGE "local function parts(m) local t = {}\n"
                  "for k = 1, 7 do t[k] = ball(m, math.sin(k), math.cos(2 * k) / 2, math.cos(k), .5 + k / 15) end\n"
                  "return t end\n"
                  "show(gr.merge{name='m', table.unpack(parts(blue))}, 'merge.png')\n"
                  "show(gr.csg_merge('m', table.unpack(parts(blue))), 'csg_merge.png')\n"
                  "show(gr.union{operands=parts(blue)}, 'union.png')\n"
                  "show(gr.node{children=parts(blue)}, 'group.png')\n"
                  "show(gr.merge(table.unpack(parts(glass))), 'glass_merge.png')\n"
                  "show(gr.node{children=parts(glass)}, 'glass_group.png')\n");
    CHECK_EQ_INT(differing("merge.png", "csg_merge.png", 0), 0);
    CHECK_EQ_INT(differing("merge.png", "union.png", 0), 0);
    CHECK(differing("merge.png", "group.png", 1) <= 7); /* a thousandth: pixels at the edges of shadows */
    CHECK(differing("glass_merge.png", "glass_group.png", 8) > 60);
}

TEST(merged_glass_has_no_walls_inside) {
    renders(STAGE "local function slab(from, to) return gr.box{min={from,-1,-.5}, max={to,1,.5}, material=glass} end\n"
                  "show(slab(-1.5, 1.5), 'whole.png')\n"
                  "show(gr.merge('m', slab(-1.5, 0.2), slab(-.3, 1.5)), 'over.png')\n"
                  "show(gr.merge('m', slab(-1.5, 0), slab(0, .7), slab(.7, 1.5)), 'touch.png')\n"
                  "show(gr.node{children={slab(-1.5, 0.2), slab(-.3, 1.5)}}, 'group.png')\n");
    CHECK_EQ_INT(differing("whole.png", "over.png", 0), 0);
    CHECK_EQ_INT(differing("whole.png", "touch.png", 0), 0);
    CHECK(differing("whole.png", "group.png", 8) > 10);
}

TEST(a_union_in_parts_gives_the_bytes_of_the_whole) {
    /* After subtraction of a distant solid the root is no union, and the solid is not divided. */
    renders(STAGE "local far = ball(white, 0, -100, 0, .1)\n"
                  "local bark = gr.marble_pnd_material(blue, 2.2, 6, 7, 1, {.9,.8,.7})\n"
                  "local function many(m) local t, k = {}, 0\n"
                  "for i = -2, 2 do for j = -2, 2 do k = k + 1\n"
                  "local b = ball(m[k % #m + 1], 0, 0, 0, .35)\n"
                  "if k % 3 == 0 then b = gr.difference(b, gr.cube(m[1])) end\n"
                  "t[k] = b:rotate('x', 20 * k):translate(.8 * i, .3 * j, .8 * j) end end return t end\n"
                  "for k, m in ipairs{{red, blue, bark}, {glass}, {red, glass}} do\n"
                  "local u = gr.union{operands=many(m)}\n"
                  "show(u, 'parts' .. k .. '.png') show(gr.difference(u, far), 'whole' .. k .. '.png')\n"
                  "show(u, 'in' .. k .. '.png', {-1.6,-.6,-1.6})\n"
                  "show(gr.difference(u, far), 'within' .. k .. '.png', {-1.6,-.6,-1.6}) end\n");
    const char *const pairs[][2] = {{"parts1.png", "whole1.png"}, {"parts2.png", "whole2.png"},
                                    {"parts3.png", "whole3.png"}, {"in1.png", "within1.png"},
                                    {"in2.png", "within2.png"},   {"in3.png", "within3.png"}};
    for (int k = 0; k < 6; k++) {
        CHECK_EQ_INT(differing(pairs[k][0], pairs[k][1], 0), 0);
        CHECK(k > 2 || varied(pairs[k][0]) > 300);
    }
}

TEST(a_bounding_solid_changes_nothing_where_it_is_true) {
    renders(STAGE "local function crystal(m) local t = {}\n" /* only of half-spaces */
                  "for k = 0, 5 do local a = k * math.pi / 3\n"
                  "t[#t + 1] = gr.plane{normal={math.cos(a),.5,math.sin(a)}, distance=1, material=m}\n"
                  "t[#t + 1] = gr.plane{normal={math.cos(a),-.5,math.sin(a)}, distance=1, material=m} end\n"
                  "return gr.intersection{operands=t} end\n"
                  "local function box() return gr.box{min={-2.6,-2.6,-2.6}, max={2.6,2.6,2.6}} end\n"
                  "local hole = ball(blue, .8, .5, .8, .7)\n"
                  "show(crystal(red), 'a.png')\n"
                  "show(gr.bounded_by('b', crystal(red), box()), 'b.png')\n"
                  "show(gr.difference('d', crystal(glass), hole), 'c.png')\n"
                  "show(gr.difference('d', gr.bounded_by{object=crystal(glass), by=box()}, hole), 'd.png')\n"
                  "show(gr.bounded_by(gr.difference('d', crystal(glass), hole), gr.inverse(hole)), 'e.png')\n");
    CHECK_EQ_INT(differing("a.png", "b.png", 0), 0);
    CHECK_EQ_INT(differing("c.png", "d.png", 0), 0);
    CHECK_EQ_INT(differing("c.png", "e.png", 0), 0);
    CHECK(differing("a.png", "c.png", 8) > 150);
}

TEST(a_clipped_solid_is_cut_open) {
    renders(STAGE "local function clip() return gr.plane{normal={0,0,1}, distance=.3} end\n"
                  "show(gr.clipped_by('c', ball(thin,0,0,0,1.5), clip()), 'ball.png')\n"
                  "show(gr.clipped_by(gr.node{children={ball(thin,0,0,0,1.5)}}, gr.inverse(gr.inverse(clip()))), "
                  "'group.png')\n"
                  "local bowl = gr.lathe{material=thin, open=true, points={{0,-1.5},{1.3,-.75},{1.3,.75},{0,1.5}}}\n"
                  "show(gr.clipped_by(bowl, clip()), 'bowl.png')\n"
                  "show(gr.intersection('i', ball(thin,0,0,0,1.5), clip()), 'capped.png')\n"
                  "local twice = gr.clipped_by(gr.clipped_by(ball(thin,0,0,0,1.5), clip()), gr.plane{normal={1,0,0}})\n"
                  "show(twice, 'twice.png')\n"
                  "show(gr.clipped_by(ball(thin,0,0,0,1.5), gr.intersection(clip(), gr.plane{normal={1,0,0}})), "
                  "'both.png')\n");
    CHECK_EQ_INT(differing("ball.png", "group.png", 0), 0);
    CHECK_EQ_INT(differing("twice.png", "both.png", 0), 0);
    CHECK(differing("ball.png", "capped.png", 8) > 150 && differing("ball.png", "twice.png", 8) > 150);
    CHECK(differing("ball.png", "bowl.png", 8) > 60);
}

TEST(the_material_and_the_transform_of_a_clipped_node_apply_to_its_children) {
    renders(STAGE "local function half() return gr.plane{normal={0,0,1}, distance=.3} end\n"
                  "local a = gr.clipped_by('c', gr.sphere('s'), half()):set_material(thin)\n"
                  "local b = gr.clipped_by('c', gr.sphere('s'):set_material(thin):scale(1.5,1,1), "
                  "half():scale(1.5,1,1))\n"
                  "show(a:scale(1.5,1,1):rotate('y',40), 'a.png') show(b:rotate('y',40), 'b.png')\n"
                  "local c = gr.bounded_by('c', gr.sphere('s'), gr.box{min={-1,-1,-1}, max={1,1,1}})\n"
                  "c:set_material(thin) show(c, 'c.png') show(gr.sphere(thin), 'd.png')\n");
    CHECK(differing("a.png", "b.png", 1) <= 7);
    CHECK_EQ_INT(differing("c.png", "d.png", 0), 0);
}

TEST(a_camera_inside_of_a_solid_renders_its_inner_side) {
    renders(STAGE
            "local function inside(n, f) show(gr.node{children={n, ball(red,-.3,-.3,-.3,.2)}}, f, {.1,.2,.3}) end\n"
            "inside(ball(glass,0,0,0,1.5), 'ball.png')\n"
            "inside(gr.merge('m', ball(glass,0,0,0,1.5), ball(glass,.2,0,0,1)), 'merge.png')\n"
            "inside(gr.difference('d', gr.box{min={-2,-2,-2}, max={2,2,2}, material=glass}, "
            "gr.inverse(ball(glass,0,0,0,1.5))), 'less.png')\n"
            "inside(gr.difference('d', gr.box{min={-2,-2,-2}, max={2,2,2}, material=thin}, "
            "ball(thin,0,0,0,1.5)), 'hollow.png')\n"
            "inside(gr.inverse(ball(thin,0,0,0,1.5)), 'inverse.png')\n");
    CHECK_EQ_INT(differing("ball.png", "merge.png", 0), 0);
    CHECK_EQ_INT(differing("ball.png", "less.png", 0), 0);
    CHECK_EQ_INT(differing("hollow.png", "inverse.png", 0), 0);
    CHECK(varied("ball.png") > 100 && varied("hollow.png") > 20);
}

/* A glass ball around the camera looks like glass everywhere except in a cave: the view is refracted into the cave.
 */
TEST(what_is_far_away_is_inside_of_an_inverse) {
    renders(STAGE "local cave = gr.inverse(ball(glass, 0, 0, 0, 1))\n"
                  "local sea = gr.difference(ball(glass, 0, 0, 0, 1000), ball(glass, 0, 0, 0, 1))\n"
                  "show(cave, 'a.png') show(sea, 'b.png')\n"
                  "show(gr.union('u', cave, ball(red, 0, 0, 0, .5)), 'c.png')\n");
    struct test_picture a = test_read_picture(test_path("a.png")), b = test_read_picture(test_path("b.png"));
    /* In both, rays that never leave the sea end in the background; those through the cave are the same. */
    uint32_t same = 0, size = a.width * a.height;
    for (uint32_t i = 0; a.rgb && b.rgb && i < size; i++)
        same += memcmp(a.rgb + 3 * i, b.rgb + 3 * i, 3) == 0;
    CHECK(same > size / 4);
    CHECK(differing("a.png", "c.png", 8) > 10);
    free(a.rgb);
    free(b.rgb);
}

TEST(operands_keep_their_image_coordinates) {
    renders(STAGE "local function globe() return gr.sphere('s'):set_material(white):set_texture('square.png') end\n"
                  "show(gr.sphere(white), 'square.png', {0,0,1.5})\n"
                  "show(globe():rotate('y', 30), 'a.png')\n"
                  "show(gr.union('u', globe(), ball(red,0,0,0,.1)):rotate('y', 30), 'b.png')\n"
                  "show(gr.clipped_by('c', globe(), gr.box{min={-2,-2,-2}, max={2,2,2}}):rotate('y', 30), 'c.png')\n"
                  "show(gr.sphere(white):rotate('y', 30), 'd.png')\n");
    CHECK(differing("a.png", "b.png", 1) <= 7);
    CHECK(differing("a.png", "c.png", 1) <= 7);
    CHECK(differing("a.png", "d.png", 8) > 40);
}

TEST(solids_of_any_number_of_operands_are_those_of_two_by_two) {
    renders(STAGE "local a, b, c, d = ball(red,-.6,0,0,1), ball(blue,.6,0,0,1), ball(white,0,.7,.2,.9), "
                  "gr.cube(glass)\n"
                  "show(gr.union('u', a, b, c, d), '1.png')\n"
                  "show(gr.union('u', gr.union('v', gr.union('w', a, b), c), d), '2.png')\n"
                  "show(gr.difference('u', a, b, c, d), '3.png')\n"
                  "show(gr.difference('u', gr.difference('v', gr.difference('w', a, b), c), d), '4.png')\n"
                  "show(gr.difference{a=a, b=b, c, d}, '5.png')\n"
                  "show(gr.csg_intersection(a, b, c), '6.png')\n"
                  "show(gr.csg_intersection{name='i', a, b, c}, '7.png')\n"
                  "show(gr.csg_intersection{name='i', operands={a, gr.csg_intersection{b, c}}}, '8.png')\n"
                  "show(gr.csg_union{a}, '9.png') show(a, '10.png')\n");
    const char *const pairs[][2] = {
        {"1.png", "2.png"}, {"3.png", "4.png"}, {"3.png", "5.png"}, {"6.png", "7.png"}, {"6.png", "8.png"}};
    for (int k = 0; k < 5; k++)
        CHECK_EQ_INT(differing(pairs[k][0], pairs[k][1], 0), 0);
    CHECK(differing("9.png", "10.png", 1) <= 7);
    CHECK(differing("1.png", "3.png", 8) > 150 && differing("3.png", "6.png", 8) > 40);
}

/* Empty: a mesh without faces, a node scaled to zero thickness, a solid of such operands. Everything: the inverse of
 * the empty solid. */
#define NOTHINGS                                                                                                       \
    "function hollow() return gr.mesh{verts={{0,0,0}}, faces={}} end\n"                                                \
    "function squashed() return ball(blue, 0, 0, 0, 9):scale(0, 1, 1) end\n"                                           \
    "function all(n) return gr.inverse(n) end\n"

TEST(solids_of_nothing_and_of_everything_are_what_sets_are) {
    static const struct {
        const char *solid, *same; /* NULL: it is invisible */
    } all[] = {{"gr.union('u', a(), hollow())", "a()"},
               {"gr.union('u', squashed(), a(), hollow())", "a()"},
               {"gr.union('u', hollow(), squashed())", NULL},
               {"gr.union('u', a(), all(hollow()))", NULL},
               {"gr.union('u', all(squashed()), a())", NULL},
               {"gr.intersection('i', a(), hollow())", NULL},
               {"gr.intersection('i', hollow(), a())", NULL},
               {"gr.intersection('i', a(), all(hollow()))", "a()"},
               {"gr.intersection('i', all(hollow()), a(), b())", "gr.intersection('i', a(), b())"},
               {"gr.difference('d', a(), hollow())", "a()"},
               {"gr.difference('d', hollow(), a())", NULL},
               {"gr.difference('d', a(), all(hollow()))", NULL},
               {"gr.difference('d', a(), b(), squashed())", "gr.difference('d', a(), b())"},
               {"gr.difference('d', all(hollow()), a())", "gr.inverse(a())"},
               {"gr.inverse(gr.inverse(gr.union('u', a(), hollow())))", "a()"},
               {"gr.union('u', gr.node{children={a(), hollow()}}, squashed())", "a()"},
               {"gr.union('u', gr.instances{of=a(), at={{-1,0,0}, {1,0,0}}}, hollow())",
                "gr.union('u', a():translate(-1,0,0), a():translate(1,0,0))"},
               {"gr.difference('d', gr.bounded_by{object=a(), by=gr.cube{corner={-3,-3,-3}, size=6}}, b())",
                "gr.difference('d', a(), b())"},
               {"gr.bounded_by{object=gr.union('u', a(), b()), by=hollow()}", "gr.union('u', a(), b())"},
               {"gr.clipped_by{object=a(), by=hollow()}", NULL},
               {"gr.clipped_by{object=a(), by=all(hollow())}", "a()"},
               {"gr.clipped_by{object=gr.clipped_by{object=a(), by=b()}, by=all(squashed())}",
                "gr.clipped_by{object=a(), by=b()}"}};
    char text[16000] = STAGE NOTHINGS "local function a() return ball(red,-.5,0,0,1.2) end\n"
                                      "local function b() return ball(blue,.6,.3,0,.9) end\n"
                                      "show(gr.node('none'), 'none.png')\n";
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        size_t used = strlen(text);
        (void)snprintf(text + used, sizeof text - used, "show(%s, 'x%zu.png')\n", all[i].solid, i);
        used = strlen(text);
        if (all[i].same)
            (void)snprintf(text + used, sizeof text - used, "show(%s, 'y%zu.png')\n", all[i].same, i);
    }
    renders(text);
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        char have[32], wanted[32];
        (void)snprintf(have, sizeof have, "x%zu.png", i);
        (void)snprintf(wanted, sizeof wanted, all[i].same ? "y%zu.png" : "none.png", i);
        uint32_t wrong = differing(have, wanted, 0);
        if (wrong > 0)
            test_fail(__FILE__, __LINE__, "%s: %u pixels are not those of %s", all[i].solid, wrong,
                      all[i].same ? all[i].same : "nothing");
    }
}
