/* Pairs of scenes that have the same light for different reasons: path tracing gives them the same picture. */
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A white floor and a ball, with `body`; `first` and `second` are fields of gr.render. */
struct pair {
    const char *body, *first, *second;
};

static const char frame[] =
    "local root, white = gr.node('root'), gr.material{kd={.7,.6,.5}, two_sided=true}\n"
    "local function add(n) root:add_child(n) return n end\n"
    "local function rectangle(m, corner, along, up)\n"
    "  return add(gr.rectangle{material=m, corner=corner, along=along, up=up})\nend\n"
    "rectangle(white, {-3,0,3}, {6,0,0}, {0,0,-6})\n"
    "add(gr.sphere{material=white, centre={.6,.5,0}, radius=.5})\n"
    "local function mesh(m) return gr.mesh(m, {{0,0,0},{1,0,0},{0,1,0},{0,0,1}}, {{0,2,1},{0,1,3},{1,2,3},{0,3,2}}) "
    "end\n"
    "%s\n"
    "for name, t in pairs{a={%s}, b={%s}} do\n"
    "  t.node, t.file, t.width, t.height, t.integrator, t.spp = t.node or root, name..'.pfm', 8, 8, 'path', 64\n"
    "  t.eye, t.view, t.background = {0,3,1}, {0,-1,.2}, t.background or {0,0,0}\n"
    "  gr.render(t)\nend\n";

struct pictures {
    char *a, *b;
    size_t size;
};

static struct pictures pictures_of(const struct pair *pair) {
    char scene[4096];
    int length = snprintf(scene, sizeof scene, frame, pair->body, pair->first, pair->second);
    CHECK(length > 0 && (size_t)length < sizeof scene);
    struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    struct pictures p;
    size_t size;
    p.a = test_read_file(test_path("a.pfm"), &p.size);
    p.b = test_read_file(test_path("b.pfm"), &size);
    CHECK(p.a && p.b && size == p.size);
    return p;
}

static void pictures_end(struct pictures *p) {
    free(p->a);
    free(p->b);
}

static void check_equal(const struct pair *pair) {
    struct pictures p = pictures_of(pair);
    CHECK(memcmp(p.a, p.b, p.size) == 0);
    pictures_end(&p);
}

/* The first picture is the second one times `factor`, but for this share of a value. */
static void check_multiple(const struct pair *pair, double factor, double share) {
    enum { COUNT = 3 * 8 * 8 };
    struct pictures p = pictures_of(pair);
    float a[COUNT], b[COUNT];
    CHECK(p.size > sizeof a);
    memcpy(a, p.a + p.size - sizeof a, sizeof a);
    memcpy(b, p.b + p.size - sizeof b, sizeof b);
    double light = 0;
    for (int i = 0; i < COUNT; i++) {
        CHECK_NEAR(a[i], factor * (double)b[i], fmax(1e-6, share * fabs((double)b[i])));
        light += fabs((double)a[i]);
    }
    CHECK(light / COUNT > 0.001);
    pictures_end(&p);
}

static void check_near(const struct pair *pair) {
    check_multiple(pair, 1, 1e-3);
}

static void check_opposite(const struct pair *pair) {
    check_multiple(pair, -1, 0);
}

/* A black ceiling above the camera, turned about x, and a lamp a gap below it. */
#define CEILING                                                                                                        \
    "local function turned(v, angle)\n"                                                                                \
    "  local c, s = math.cos(math.rad(angle)), math.sin(math.rad(angle))\n"                                            \
    "  return {v[1], c * v[2] - s * v[3], s * v[2] + c * v[3]}\nend\n"                                                 \
    "local angle, black = 17, gr.material{kd={0,0,0}}\n"                                                               \
    "local function at(v) local p = turned(v, angle) return {p[1], p[2] + 5, p[3]} end\n"

/* The ray that finds such a lamp ends at the ceiling, at the same t but for rounding. */
TEST(a_lamp_in_a_ceiling_has_the_light_of_one_just_below_it) {
    static const char *const ceilings[] = {
        "local c = gr.box(black, {-3,0,-3}, {3,1,3}) c:rotate('x', angle) c:translate(0,5,0) add(c)\n",
        "add(gr.mesh(black, {at{-3,0,-3}, at{3,0,-3}, at{3,0,3}, at{-3,0,3}}, {{0,1,2,3}}))\n",
        "add(gr.disc{material=black, centre=at{0,0,0}, normal=turned({0,1,0}, angle), radius=4})\n"};
    static const char *const lamps[] = {
        "local function lamp(gap) return gr.area_light{corner=at{-1,-gap,-1}, v1={2,0,0}, v2=turned({0,0,2}, angle), "
        "emission={1,1,1}} end\n",
        "local function lamp(gap) return gr.disc_light{position=at{0,-gap,0}, normal=turned({0,-1,0}, angle), "
        "radius=1, "
        "emission={1,1,1}} end\n",
        "local function lamp(gap) return gr.mesh_light{emission={1,1,1}, mesh=gr.mesh(black, {at{-1,-gap,-1}, "
        "at{1,-gap,-1}, at{1,-gap,1}, at{-1,-gap,1}}, {{0,1,2,3}})} end\n"};
    for (size_t c = 0; c < sizeof ceilings / sizeof *ceilings; c++) {
        for (size_t l = 0; l < sizeof lamps / sizeof *lamps; l++) {
            char body[2048];
            (void)snprintf(body, sizeof body, CEILING "%s%s", ceilings[c], lamps[l]);
            check_near(&(struct pair){body, "lights={lamp(0)}", "lights={lamp(1e-6)}"});
        }
    }
}

TEST(a_material_that_is_not_lit_lights_the_scene_as_one_whose_emission_is_its_colour) {
    check_near(&(struct pair){"local function with(m)\n"
                              "  local n = gr.node('with') n:add_child(root)\n"
                              "  n:add_child(gr.rectangle{material=m, corner={-1,4,1}, along={2,0,0}, up={0,0,-2}})\n"
                              "  return n\nend\n",
                              "node=with(gr.material{kd={.8,.7,.6}, emission={.1,.1,.1}, lit=false})",
                              "node=with(gr.material{kd={0,0,0}, emission={.9,.8,.7}})"});
}

/* The ray met the lamp where it entered, and its continuation behind the hole began inside. */
TEST(holes_inside_a_spherical_lamp_do_not_count_its_light_twice) {
    check_near(&(struct pair){
        "local clear = gr.material{kd={0,0,0}, opacity=0}\n"
        "local holes, lamp = gr.node('holes'), gr.spherical_light{position={0,5,0}, radius=1.4, emission={1,1,1}}\n"
        "holes:add_child(root)\n"
        "for i = -1, 1 do\n"
        "  holes:add_child(gr.rectangle{material=clear, corner={-4,5+.4*i,4}, along={8,0,0}, up={0,0,-8}})\nend\n",
        "lights={lamp}, node=holes", "lights={lamp}"});
}

/* Whitted's highlights stand for lamps that mirrors do not show. Scattered rays find them in mirrors. */
TEST(scattered_rays_find_lamps_in_mirrors_once_whether_they_are_visible_or_not) {
    static const char mirror[] = "local m = gr.material{kd={0,0,0}, ks={.9,.9,.9}, shininess=20, reflect=1}\n"
                                 "rectangle(m, {-2,0,-2}, {4,0,0}, {0,2,0})";
    static const char *const lamps[] = {
        "gr.spherical_light{position={0,1,-1}, radius=.3, emission={5,4,3}, visible=%s}",
        "gr.disc_light{position={0,1,-1}, normal={0,-.2,-1}, radius=.3, emission={5,4,3}, visible=%s}",
        "gr.area_light{corner={-.5,1,-1}, v1={1,0,0}, v2={0,.5,0}, emission={5,4,3}, visible=%s}"};
    for (size_t i = 0; i < sizeof lamps / sizeof *lamps; i++) {
        char lights[2][256];
        for (int visible = 0; visible < 2; visible++) {
            int n = snprintf(lights[visible], sizeof lights[visible], "lights={");
            n +=
                snprintf(lights[visible] + n, sizeof lights[visible] - (size_t)n, lamps[i], visible ? "true" : "false");
            (void)snprintf(lights[visible] + n, sizeof lights[visible] - (size_t)n, "}");
        }
        check_equal(&(struct pair){mirror, lights[0], lights[1]});
    }
    static const char mesh[] =
        "local m = gr.material{kd={0,0,0}, ks={.9,.9,.9}, shininess=20, reflect=1}\n"
        "rectangle(m, {-2,0,-2}, {4,0,0}, {0,2,0})\n"
        "local glow = add(mesh(gr.material{kd={.2,.2,.2}, emission={3,2,1}}):translate(-.3,.7,-1))";
    check_equal(&(struct pair){mesh, "lights={gr.mesh_light{mesh=glow, emission={3,2,1}}}", ""});
}

TEST(a_mesh_light_over_a_moving_mesh_has_the_light_of_all_its_positions) {
    static const char still[] = "local glow = mesh(gr.material{kd={.2,.2,.2}, emission={3,2,1}})\n"
                                "add(glow):scale(.6,.6,.6):translate(-1,.6,0):velocity(.8,.3,0)";
    check_equal(&(struct pair){still, "", "lights={gr.mesh_light{mesh=glow}}"});
    check_equal(&(struct pair){still, "", "lights={gr.mesh_light{mesh=glow, emission={3,2,1}}}"});
    check_equal(&(struct pair){still, "lights={gr.mesh_light{mesh=glow, emission={6,0,3}}}",
                               "lights={gr.mesh_light{mesh=glow, colour={2,0,3}}}"});
    static const char parts[] = "local group, glow = gr.node('group'), gr.material{kd={.2,.2,.2}, emission={3,2,1}}\n"
                                "add(group):add_child(mesh(glow):scale(.6,.6,.6):translate(-1,.6,0))\n"
                                "group:add_child(mesh(glow):scale(.3,.3,.3):translate(1,.6,0):velocity(.8,.3,0))";
    check_equal(&(struct pair){parts, "lights={gr.mesh_light{mesh=group}}",
                               "lights={gr.mesh_light{mesh=group, emission={3,2,1}}}"});
    /* The first of several. */
    check_equal(&(struct pair){still, "lights={gr.mesh_light{mesh=glow, emission={6,0,3}}}",
                               "lights={gr.mesh_light{mesh=glow, emission={6,0,3}}, gr.mesh_light{mesh=glow}}"});
}

/* Its emission replaces that of the materials, also if it is black or negative. */
TEST(a_mesh_light_of_black_or_negative_emission_replaces_the_emission_of_its_materials) {
    static const char mesh[] =
        "local glow = add(mesh(gr.material{kd={.2,.2,.2}, emission={3,2,1}}):translate(-1,.7,0))";
    check_equal(&(struct pair){mesh, "lights={gr.mesh_light{mesh=glow, emission={0,0,0}}}",
                               "lights={gr.mesh_light{mesh=glow, colour={0,0,0}}}"});
    check_equal(&(struct pair){mesh, "lights={gr.mesh_light{mesh=glow, emission={-1,2,-3}}}",
                               "lights={gr.mesh_light{mesh=glow, emission={1,-2,3}, colour={-1,-1,-1}}}"});
    check_equal(&(struct pair){mesh, "lights={gr.mesh_light{mesh=glow, emission={-3,-2,-1}}}",
                               "lights={gr.mesh_light{mesh=glow, colour={-1,-1,-1}}}"});
}

TEST(negative_light_is_the_negative_of_positive_light) {
    static const struct pair pairs[] = {
        {"", "background={1,.5,.2}", "background={-1,-.5,-.2}"},
        {"", "lights={gr.sky_light{sky={1,.5,.2}}}", "lights={gr.sky_light{sky={-1,-.5,-.2}}}"},
        {"", "background=gr.sky_gradient{{-1,.2,0,1},{1,1,.5,0}}",
         "background=gr.sky_gradient{{-1,-.2,0,-1},{1,-1,-.5,0}}"},
        {"", "lights={gr.light{position={-1,2,0}, colour={1,2,3}}}",
         "lights={gr.light{position={-1,2,0}, colour={-1,-2,-3}}}"},
        {"", "lights={gr.area_light{corner={-1,2,0}, v1={1,0,0}, v2={0,0,1}, emission={1,2,3}}}",
         "lights={gr.area_light{corner={-1,2,0}, v1={1,0,0}, v2={0,0,1}, emission={-1,-2,-3}}}"},
        {"local glow = add(mesh(gr.material{kd={.2,.2,.2}}):translate(-1,.7,0))",
         "lights={gr.mesh_light{mesh=glow, emission={3,2,1}}}",
         "lights={gr.mesh_light{mesh=glow, emission={-3,-2,-1}}}"}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        check_opposite(&pairs[i]);
}

/* gr.image_material and files cover the emission of a base material. Without samples of the light the pictures would
 * have fifty times the noise. */
TEST(a_mesh_whose_emission_is_a_picture_over_its_material_is_sampled_as_one_with_a_texture) {
    static const char quad[] =
        "local function one(m)\n"
        "  local quad = gr.mesh{verts={{0,0,0},{1,0,0},{1,1,0},{0,1,0}}, uvs={{0,0},{1,0},{1,1},{0,1}},\n"
        "                       faces={{0,1,2,3}}, material=m}\n"
        "  return gr.node{children={root, quad:scale(.5,.5,.5):translate(-1,.9,0)}}\nend\n"
        "local direct = one(gr.material{kd={0,0,0}, emission=gr.texture('glow.png')})\n"
        "local dark = gr.material{kd={0,0,0}}\n"
        "local covered = one(gr.image_material{material=dark, image='glow.png', channel='emission'})";
    size_t size;
    char *bytes = test_read_file("textures/parquet.png", &size);
    test_write_file(test_path("glow.png"), bytes, size);
    free(bytes);
    check_equal(&(struct pair){quad, "node=direct", "node=covered"});
}
