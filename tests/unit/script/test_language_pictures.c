/* Pictures recomputed pixel by pixel from the formulas of the language (docs/language.md 2 to 6): a small independent
 * tracer for spheres with light, mirrors, glass and nested media; images on spheres and cubes; the materials of
 * combined solids. It uses nothing of src/ except the noise. */
#include "math/noise.h"
#include "tests/harness.h"

#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The claims are of colours at the centres of pixels, in pictures so small that all of a scene is small. */
static void renders(const char *scene, const char *options) {
    char arguments[400];
    (void)snprintf(arguments, sizeof arguments, "-q --aa-pattern grid %s scene.lua", options);
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "status %d: %s", result.status, result.err);
    test_free_result(&result);
}

static const uint8_t *pixel(const struct test_picture *p, uint32_t x, uint32_t y) {
    return p->rgb + 3 * ((size_t)y * p->width + x);
}

/* --- a tracer of spheres --- */

struct v {
    double x, y, z;
};
struct sphere_material {
    struct v kd, ks;
    double shininess, reflect, refract, ior;
    bool fresnel;
};
struct ball {
    int sphere_material;
    struct v centre;
    double radius;
};
struct medium {
    int ball;
    double ior;
};
struct stack {
    int count;
    struct medium entries[32];
};
struct area_light {
    struct v position, colour;
    double falloff[3];
};

static const struct sphere_material sphere_materials[] = {
    {{.8, .3, .2}, {.5, .4, .3}, 12, 0, 0, 1, false},        {{.1, .1, .1}, {.9, .8, .7}, 40, .8, 0, 1, false},
    {{.02, .05, .1}, {.9, .95, 1}, 90, .15, .8, 1.5, false}, {{0, .02, .05}, {1, 1, .9}, 50, .1, .85, 1.33, false},
    {{.01, 0, 0}, {1, .9, 1}, 120, .3, .3, 1.7, true},       {{0, 0, 0}, {1, 1, 1}, 10, 0, 1, 1, false},
};
/* Glass in glass, a bubble in glass, two overlapping balls, one that protrudes, mirrors and a ground. */
static const struct ball balls[] = {
    {0, {-2.2, -.3, -1}, .9}, {1, {2.1, .2, -1.5}, 1.1}, {2, {0, 0, 0}, 1.2},     {3, {-1.1, 1.5, .6}, .7},
    {4, {1.1, -1.2, 1}, .6},  {5, {.2, .1, .1}, .5},     {4, {0, -.7, .1}, .25},  {0, {0, -31.8, 0}, 30},
    {0, {-.4, .4, .2}, .2},   {2, {-1.1, 1.4, .7}, .3},  {3, {2.2, -.9, .4}, .5}, {2, {2.5, -.9, .3}, .45},
};
static const struct area_light area_lights[] = {
    {{4, 6, 5}, {.9, .8, .7}, {1, .05, .002}},
    {{-6, 3, 2}, {.4, .4, .5}, {0, 0, 0}},
};
static const struct v ambient = {.25, .2, .3};
enum { BALLS = sizeof balls / sizeof balls[0], AREA_LIGHTS = 2 };

struct limits {
    int reflect, refract;
    bool use_tir;
};

static struct v add(struct v a, struct v b, double s) {
    return (struct v){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static double dot(struct v a, struct v b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static struct v times(struct v a, struct v b) {
    return (struct v){a.x * b.x, a.y * b.y, a.z * b.z};
}
static struct v unit(struct v a) {
    double s = 1 / sqrt(dot(a, a));
    return (struct v){a.x * s, a.y * s, a.z * s};
}
static struct v cross(struct v a, struct v b) {
    return (struct v){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static int nearest(struct v o, struct v d, double limit, double *t) {
    int found = -1;
    *t = limit;
    for (int i = 0; i < BALLS; i++) {
        struct v from = add(o, balls[i].centre, -1);
        double b = dot(from, d), q = b * b - dot(from, from) + balls[i].radius * balls[i].radius;
        if (q <= 0)
            continue;
        for (int side = -1; side <= 1; side += 2) {
            double s = -b + side * sqrt(q);
            if (s > 1e-7 && s < *t)
                *t = s, found = i;
        }
    }
    return found;
}

static double current(const struct stack *stack) {
    return stack->count ? stack->entries[stack->count - 1].ior : 1;
}

static struct v own_light(const struct sphere_material *m, struct v p, struct v n, struct v v, bool front,
                          double refract) {
    struct v sum = times(ambient, m->kd);
    for (int k = 0; k < AREA_LIGHTS && front; k++) {
        struct v to = add(area_lights[k].position, p, -1);
        double d = sqrt(dot(to, to)), blocked;
        struct v l = unit(to);
        double n_l = dot(n, l);
        if (n_l <= 0 || nearest(p, l, d, &blocked) >= 0)
            continue;
        const double *c = area_lights[k].falloff;
        double attenuation = c[0] == 0 && c[1] == 0 && c[2] == 0 ? 1 : c[0] + c[1] * d + c[2] * d * d;
        struct v r = add((struct v){-l.x, -l.y, -l.z}, n, 2 * n_l);
        double r_v = dot(r, v), h = r_v > 0 ? pow(r_v, m->shininess) : 0;
        struct v lobes = add((struct v){n_l * m->kd.x, n_l * m->kd.y, n_l * m->kd.z}, m->ks, (1 - refract) * h);
        sum = add(sum, times(area_lights[k].colour, lobes), 1 / attenuation);
    }
    return sum;
}

static struct v trace(struct v o, struct v d, int reflections, int refractions, const struct stack *stack,
                      const struct limits *limits) {
    double t;
    int hit = nearest(o, d, 1e30, &t);
    if (hit < 0)
        return (struct v){0, 0, (1 + d.y) / 2};
    const struct sphere_material *m = &sphere_materials[balls[hit].sphere_material];
    struct v p = add(o, d, t), n = unit(add(p, balls[hit].centre, -1)), v = {-d.x, -d.y, -d.z};
    bool front = dot(n, v) > 0;
    struct v side = front ? n : (struct v){-n.x, -n.y, -n.z};
    struct stack behind = *stack;
    if (front) {
        behind.entries[behind.count++] = (struct medium){hit, m->ior};
    } else {
        int k = stack->count - 1;
        while (k >= 0 && stack->entries[k].ball != hit)
            k--;
        for (int i = k; k >= 0 && i + 1 < stack->count; i++)
            behind.entries[i] = stack->entries[i + 1];
        behind.count -= k >= 0;
    }
    double n1 = current(stack), n2 = current(&behind), c1 = dot(side, v), sin2 = n1 / n2 * (n1 / n2) * (1 - c1 * c1);
    bool total = sin2 >= 1;
    double c2 = total ? 0 : sqrt(1 - sin2), reflect = m->reflect, refract = m->refract;
    if (m->fresnel) {
        double rs = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2), rp = (n1 * c2 - n2 * c1) / (n1 * c2 + n2 * c1);
        reflect = total ? 1 : (rs * rs + rp * rp) / 2;
        refract = 1 - reflect;
    }
    struct v colour = own_light(m, p, n, v, front, refract);
    if (total && limits->use_tir)
        reflect += refract;
    if (reflect > 0 && reflections < limits->reflect) {
        struct v r = unit(add(d, side, 2 * c1));
        colour = add(colour, times(m->ks, trace(p, r, reflections + 1, refractions, stack, limits)), reflect);
    }
    if (refract > 0 && !total && refractions < limits->refract) {
        struct v r = add((struct v){d.x * n1 / n2, d.y * n1 / n2, d.z * n1 / n2}, side, n1 / n2 * c1 - c2);
        colour = add(colour, times(m->ks, trace(p, unit(r), reflections, refractions + 1, &behind, limits)), refract);
    }
    return colour;
}

enum { TEXT = 8192 };

static const char *spheres_scene(char text[TEXT]) {
    int used = snprintf(text, TEXT, "local r, m = gr.node('r'), {}\n");
    for (size_t k = 0; k < sizeof sphere_materials / sizeof sphere_materials[0]; k++) {
        const struct sphere_material *m = &sphere_materials[k];
        used += snprintf(text + used, (size_t)(TEXT - used),
                         "m[%zu] = gr.rr_material({%g,%g,%g}, {%g,%g,%g}, %g, %g, %g, %g)\n", k, m->kd.x, m->kd.y,
                         m->kd.z, m->ks.x, m->ks.y, m->ks.z, m->shininess, m->reflect, m->refract, m->ior);
        if (m->fresnel)
            used += snprintf(text + used, (size_t)(TEXT - used), "m[%zu] = gr.difresnel_material(m[%zu])\n", k, k);
    }
    for (int k = 0; k < BALLS; k++)
        used += snprintf(text + used, (size_t)(TEXT - used), "r:add_child(gr.nh_sphere(m[%d], {%g,%g,%g}, %g))\n",
                         balls[k].sphere_material, balls[k].centre.x, balls[k].centre.y, balls[k].centre.z,
                         balls[k].radius);
    (void)snprintf(text + used, (size_t)(TEXT - used),
                   "local l = {gr.light({4,6,5}, {.9,.8,.7}, {1,.05,.002}), gr.light({-6,3,2}, {.4,.4,.5}, {0,0,0})}\n"
                   "gr.render(r, 'out.png', 80, 60, {.3,.2,7}, {-.05,-.03,-2}, {.1,1,.2}, 38, {.25,.2,.3}, l)\n"
                   "gr.render(r, 'in.png', 80, 60, {.05,.25,.9}, {-.05,-.03,-2}, {.1,1,.2}, 80, {.25,.2,.3}, l)\n");
    return text;
}

static void compare(const char *name, struct v eye, double fov, const struct stack *stack,
                    const struct limits *limits) {
    struct test_picture p = test_read_picture(test_path(name));
    struct v view = unit((struct v){-.05, -.03, -2}), right = unit(cross(view, (struct v){.1, 1, .2}));
    struct v up = cross(right, view);
    double half = tan(fov * 3.14159265358979323846 / 360);
    int wrong = 0;
    for (uint32_t y = 0; y < 60 && p.rgb; y++) {
        for (uint32_t x = 0; x < 80; x++) {
            struct v d = add(add(view, right, (x + .5 - 40) * half / 30), up, -(y + .5 - 30) * half / 30);
            struct v c = trace(eye, unit(d), 0, 0, stack, limits);
            double want[3] = {c.x, c.y, c.z};
            for (int k = 0; k < 3; k++)
                wrong += fabs(fmin(1, fmax(0, want[k])) * 255 - pixel(&p, x, y)[k]) > 0.51;
        }
    }
    CHECK_EQ_INT(wrong, 0);
    free(p.rgb);
}

TEST(light_mirrors_glass_and_nested_media_are_the_formulas_at_every_pixel) {
    static const struct {
        const char *options;
        struct limits limits;
    } runs[] = {
        {"", {2, 4, false}},
        {"-use-tir", {2, 4, true}},
        {"-use-tir -reflect-limit 0 -refract-limit 7", {0, 7, true}},
        {"-reflect-limit 4 -refract-limit 1", {4, 1, false}},
    };
    char text[TEXT];
    for (size_t k = 0; k < sizeof runs / sizeof runs[0]; k++) {
        char options[200];
        (void)snprintf(options, sizeof options, "-side-tolerance 9 -corner-tolerance 9 %s", runs[k].options);
        renders(spheres_scene(text), options);
        struct stack air = {0}, glass = {.count = 1, .entries = {{2, 1.5}}};
        compare("out.png", (struct v){.3, .2, 7}, 38, &air, &runs[k].limits);
        compare("in.png", (struct v){.05, .25, .9}, 80, &glass, &runs[k].limits);
    }
}

/* --- combined solids --- */

#define CSG                                                                                                            \
    "local red, green, blue = gr.material({1,0,0},{0,0,0},1), gr.material({0,1,0},{0,0,0},1), "                        \
    "gr.material({0,0,1},{0,0,0},1)\n"                                                                                 \
    "local function show(n, f) local r = gr.node('r') r:add_child(n) gr.render{node=r, file=f, width=32, height=32, "  \
    "eye={.5,.5,5}, fov=30, ambient={1,1,1}, background={0,0,0}} end\n"                                                \
    "local function hole(m) return gr.nh_sphere(m, {.5,.5,1}, .2) end\n"

static void expect_colours(const char *name, uint32_t inner, uint32_t outer) {
    struct test_picture p = test_read_picture(test_path(name));
    const uint8_t *in = pixel(&p, 16, 16), *out = pixel(&p, 12, 12);
    uint32_t found_in = (uint32_t)in[0] << 16 | (uint32_t)in[1] << 8 | in[2];
    uint32_t found_out = (uint32_t)out[0] << 16 | (uint32_t)out[1] << 8 | out[2];
    if (found_in != inner || found_out != outer)
        test_fail(__FILE__, __LINE__, "%s: hole %06x, face %06x", name, found_in, found_out);
    free(p.rgb);
}

TEST(a_cut_face_shows_the_material_of_the_solid_that_cut_it) {
    renders(CSG "show(gr.csg_difference('d', gr.cube(red), hole(green)), 'a.png')\n"
                "local g = gr.node('g') g:add_child(hole(blue))\n"
                "show(gr.csg_difference('d', gr.cube(red), g), 'b.png')\n"
                "show(gr.csg_intersection('i', gr.cube(red), gr.csg_difference('e', gr.nh_box(blue, {-1,-1,-1}, 4), "
                "hole(green))), 'c.png')\n",
            "");
    expect_colours("a.png", 0x00ff00, 0xff0000);
    expect_colours("b.png", 0x0000ff, 0xff0000);
    expect_colours("c.png", 0x00ff00, 0xff0000);
}

TEST(the_material_of_a_combined_solid_is_that_of_its_operands_without_one) {
    renders(CSG
            "local a, b = gr.cube('a'), gr.nh_sphere('b', {.5,.5,1}, .2)\n"
            "local d = gr.difference('d', a, b)\n"
            "d:set_material(red) show(d, '1.png')\n"
            "d:set_material(blue) show(d, '2.png')\n"
            "a:set_material(green) show(d, '3.png')\n"
            "local g = gr.node('g') g:add_child(gr.cube('c'))\n"
            "local e = gr.difference('e', g, gr.nh_sphere('b', {.5,.5,1}, .2)) e:set_material(red) show(e, '4.png')\n"
            "local inner = gr.difference('f', gr.cube('c'), gr.nh_sphere('s', {.5,.5,1}, .2)) "
            "inner:set_material(green)\n"
            "local outer = gr.union('u', inner, gr.nh_box('x', {.4,.4,.5}, .2)) outer:set_material(blue) "
            "show(outer, '5.png')\n",
            "");
    expect_colours("1.png", 0xff0000, 0xff0000);
    expect_colours("2.png", 0x0000ff, 0x0000ff);
    expect_colours("3.png", 0x0000ff, 0x00ff00);
    expect_colours("4.png", 0xff0000, 0xff0000);
    expect_colours("5.png", 0x00ff00, 0x00ff00);
}

TEST(an_operand_that_is_shown_elsewhere_keeps_its_own_material_there) {
    struct test_result result = test_gray_scene(CSG "local c = gr.cube('shared') local u = gr.union('u', c, "
                                                    "gr.cube('x')) u:set_material(red) show(c, 'a.png')\n",
                                                "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.err, "node 'shared' has no material and is shown in plain gray"));
    expect_colours("a.png", 0x808080, 0x808080);
    test_free_result(&result);
}

/* --- images and patterns --- */

/* An image of w x h texels with distinct colours: red counts columns, green rows. */
static void write_texels(const char *name, uint32_t w, uint32_t h) {
    uint8_t *rgb = malloc(3 * (size_t)w * h);
    for (uint32_t k = 0; rgb && k < w * h; k++) {
        rgb[3 * k] = (uint8_t)(k % w * (255 / w));
        rgb[3 * k + 1] = (uint8_t)(k / w * (255 / h));
        rgb[3 * k + 2] = 77;
    }
    png_image image = {.version = PNG_IMAGE_VERSION, .width = w, .height = h, .format = PNG_FORMAT_RGB};
    CHECK(rgb && png_image_write_to_file(&image, test_path(name), 0, rgb, 0, NULL));
    free(rgb);
}

/* Counts pixels whose texel is not the one at fractions (u, v) of columns and rows; those near an edge are skipped.
 */
static int wrong_texel(const uint8_t *found, double u, double v, uint32_t w, uint32_t h) {
    double x = u * w, y = v * h;
    if (fabs(x - round(x)) < 1e-6 || fabs(y - round(y)) < 1e-6)
        return 0;
    return found[0] != (uint8_t)(floor(x) * (255 / w)) || found[1] != (uint8_t)(floor(y) * (255 / h)) || found[2] != 77;
}

static void check_cube_face(const char *name, double low, double high, int face) {
    static const struct {
        struct v eye, view, up;
    } cameras[6] = {
        {{0, 0, 9}, {0, 0, -1}, {0, 1, 0}}, {{0, 0, -9}, {0, 0, 1}, {0, 1, 0}},  {{9, 0, 0}, {-1, 0, 0}, {0, 1, 0}},
        {{-9, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 9, 0}, {0, -1, 0}, {0, 0, -1}}, {{0, -9, 0}, {0, 1, 0}, {0, 0, 1}},
    };
    struct v view = cameras[face].view, right = cross(view, cameras[face].up), up = cameras[face].up;
    struct test_picture p = test_read_picture(test_path(name));
    double distance = 9 - (face % 2 ? -low : high), half = tan(20 * 3.14159265358979323846 / 360);
    int wrong = 0, seen = 0;
    for (uint32_t y = 0; y < 40 && p.rgb; y++) {
        for (uint32_t x = 0; x < 40; x++) {
            struct v d = add(add(view, right, (x + .5 - 20) * half / 20), up, -(y + .5 - 20) * half / 20);
            struct v q = add(cameras[face].eye, d, distance); /* on the plane of the face */
            q.x = (q.x - low) / (high - low), q.y = (q.y - low) / (high - low), q.z = (q.z - low) / (high - low);
            double u[6] = {q.x, 1 - q.x, 1 - q.z, q.z, q.x, q.x};
            double v[6] = {1 - q.y, 1 - q.y, 1 - q.y, 1 - q.y, q.z, 1 - q.z};
            if (u[face] < 0 || u[face] > 1 || v[face] < 0 || v[face] > 1)
                continue;
            seen++;
            wrong += wrong_texel(pixel(&p, x, y), u[face], v[face], 5, 3);
        }
    }
    CHECK(seen > 150);
    CHECK_EQ_INT(wrong, 0);
    free(p.rgb);
}

TEST(images_on_cubes_lie_on_the_six_sides_as_the_table_says) {
    write_texels("t.png", 5, 3);
    renders(
        "local m = gr.material({1,1,1},{0,0,0},1)\n"
        "local function show(s, name) local r = gr.node('r') r:add_child(s)\n"
        "local eyes = {{0,0,9},{0,0,-9},{9,0,0},{-9,0,0},{0,9,0},{0,-9,0}}\n"
        "for k, e in ipairs(eyes) do gr.render{node=r, file=name..k..'.png', width=40, height=40, eye=e, "
        "target={0,0,0}, up=k==5 and {0,0,-1} or k==6 and {0,0,1} or {0,1,0}, fov=20, ambient={1,1,1}, "
        "side_tolerance=9, corner_tolerance=9} end end\n"
        "show(gr.geometry('c', gr.cube(gr.td_cube_material{material=m, png='t.png', filter='nearest'})), 'project')\n"
        "local box = gr.nh_box('b', {-1,-1,-1}, 2) box:set_material(m)\n"
        "box:set_texture(gr.texture{file='t.png', filter='nearest'})\n"
        "show(box, 'classic')\n",
        "");
    for (int face = 0; face < 6; face++) {
        char name[40];
        (void)snprintf(name, sizeof name, "project%d.png", face + 1);
        check_cube_face(name, 0, 1, face);
        (void)snprintf(name, sizeof name, "classic%d.png", face + 1);
        check_cube_face(name, -1, 1, face);
    }
}

enum sphere_mapping { PROJECT, FLIPPED, CLASSIC };

static void check_sphere(const char *name, double angle, enum sphere_mapping mapping) {
    const double pi = 3.14159265358979323846;
    struct test_picture p = test_read_picture(test_path(name));
    struct v view = {-sin(angle), 0, -cos(angle)}, right = cross(view, (struct v){0, 1, 0}), up = {0, 1, 0};
    struct v eye = {8 * sin(angle), 0, 8 * cos(angle)};
    double half = tan(15 * pi / 360);
    int wrong = 0, seen = 0;
    for (uint32_t y = 0; y < 50 && p.rgb; y++) {
        for (uint32_t x = 0; x < 50; x++) {
            struct v d = unit(add(add(view, right, (x + .5 - 25) * half / 25), up, -(y + .5 - 25) * half / 25));
            double b = dot(eye, d), q = b * b - 63;
            if (q < 0.01)
                continue;
            struct v at = add(eye, d, -b - sqrt(q));
            double u = (atan2(-at.z, -at.x) + pi) / (2 * pi), v = acos(at.y) / pi;
            if (mapping == FLIPPED)
                u = 1 - u;
            if (mapping == CLASSIC)
                u = .5 + atan2(at.z, at.x) / (2 * pi), v = .5 - asin(at.y) / pi;
            seen++;
            wrong += wrong_texel(pixel(&p, x, y), u, v, 51, 17);
        }
    }
    CHECK(seen > 1000);
    CHECK_EQ_INT(wrong, 0);
    free(p.rgb);
}

TEST(images_on_spheres_follow_both_formulas_from_every_side) {
    write_texels("t.png", 51, 17);
    renders(
        "local m = gr.material({1,1,1},{0,0,0},1)\n"
        "local function show(s, name) local r = gr.node('r') r:add_child(s)\n"
        "for k = 0, 3 do local a = k * 1.4\n"
        "gr.render{node=r, file=name..k..'.png', width=50, height=50, eye={8*math.sin(a), 0, 8*math.cos(a)}, "
        "target={0,0,0}, fov=15, ambient={1,1,1}, side_tolerance=9, corner_tolerance=9} end end\n"
        "show(gr.sphere(gr.td_sphere_material{material=m, png='t.png', filter='nearest'}), 'project')\n"
        "show(gr.sphere(gr.td_sphere_material{material=m, png='t.png', filter='nearest', flip_u=true}), 'flipped')\n"
        "local s = gr.sphere('s') s:set_material(m) s:set_texture(gr.texture{file='t.png', filter='nearest'})\n"
        "show(s, 'classic')\n",
        "");
    static const char *const names[] = {"project", "flipped", "classic"};
    for (int mapping = PROJECT; mapping <= CLASSIC; mapping++) {
        for (int k = 0; k < 4; k++) {
            char name[40];
            (void)snprintf(name, sizeof name, "%s%d.png", names[mapping], k);
            check_sphere(name, k * 1.4, (enum sphere_mapping)mapping);
        }
    }
}

/* The picture shows x and y from -2 to 2 of the plane z = 0. */
static void check_pattern(const char *name, bool wood, int interpolation, bool turned) {
    struct test_picture p = test_read_picture(test_path(name));
    int wrong = 0, seen = 0;
    for (uint32_t y = 0; y < 40 && p.rgb; y++) {
        for (uint32_t x = 0; x < 40; x++) {
            double wx = (x + .5) / 10 - 2, wy = 2 - (y + .5) / 10;
            struct v q = turned ? (struct v){wy / 2, -wx / 3, 1} : (struct v){wx + .5, wy + .5, 1};
            if (q.x < 0 || q.x > 1 || q.y < 0 || q.y > 1)
                continue;
            double ratio = wood ? noise_wood(q.x, q.y, q.z, 2.5, 6, interpolation)
                                : noise_marble(vec3_make(q.x, q.y, q.z), 1.5, 5, 4, interpolation);
            double want[3] = {ratio * .9 + (1 - ratio) * .1, ratio * .5 + (1 - ratio) * .2,
                              ratio * .1 + (1 - ratio) * .7};
            for (int k = 0; k < 3; k++)
                wrong += fabs(want[k] * 255 - pixel(&p, x, y)[k]) > 0.51;
            seen++;
        }
    }
    CHECK(seen >= 100);
    CHECK_EQ_INT(wrong, 0);
    free(p.rgb);
}

TEST(patterns_stick_to_the_object_before_any_transform_in_combined_solids_too) {
    renders(
        "local base = gr.material({.9,.5,.1},{0,0,0},1)\n"
        "for i = 0, 1 do\n"
        "local wood = gr.wood_pnd_material(base, 2.5, 6, i, {.1,.2,.7})\n"
        "local marble = gr.marble_pnd_material(base, 1.5, 5, 4, i, {.1,.2,.7})\n"
        "for name, m in pairs{wood=wood, marble=marble} do\n"
        "local function show(n, f) local r = gr.node('r') r:add_child(n) gr.render{node=r, file=name..i..f..'.png', "
        "width=40, height=40, eye={0,0,2}, fov=90, ambient={1,1,1}, side_tolerance=9, corner_tolerance=9} end\n"
        "local plain = gr.geometry('p', gr.cube(m)) plain:translate(-.5,-.5,-1) show(plain, 'plain')\n"
        "local turned = gr.geometry('t', gr.cube(m)) turned:scale(2,3,1) turned:rotate('z',90) "
        "turned:translate(0,0,-1) show(turned, 'turned')\n"
        "local a = gr.geometry('a', gr.cube(m)) a:scale(2,3,1)\n"
        "local far = gr.nh_sphere(base, {0,0,-9}, 1)\n"
        "local d = gr.csg_difference('d', a, far) d:rotate('z',90) d:translate(0,0,-1) show(d, 'solid')\n"
        "end end\n",
        "");
    for (int wood = 0; wood < 2; wood++) {
        for (int i = 0; i < 2; i++) {
            char name[60];
            (void)snprintf(name, sizeof name, "%s%dplain.png", wood ? "wood" : "marble", i);
            check_pattern(name, wood, i, false);
            (void)snprintf(name, sizeof name, "%s%dturned.png", wood ? "wood" : "marble", i);
            check_pattern(name, wood, i, true);
            (void)snprintf(name, sizeof name, "%s%dsolid.png", wood ? "wood" : "marble", i);
            check_pattern(name, wood, i, true);
        }
    }
}

/* --- nodes, switches, backgrounds --- */

static void expect_rgb(const char *name, uint32_t x, uint32_t y, double r, double g, double b) {
    struct test_picture p = test_read_picture(test_path(name));
    const double want[3] = {r, g, b};
    const uint8_t *found = pixel(&p, x, y);
    for (int k = 0; k < 3; k++)
        if (fabs(fmin(1, fmax(0, want[k])) * 255 - found[k]) > 0.51)
            test_fail(__FILE__, __LINE__, "%s: channel %d is %d, not %g", name, k, found[k], want[k] * 255);
    free(p.rgb);
}

/* The ray of the one pixel meets the plane z = 0 at the origin; l = (0, .6, .8), n = v = (0, 0, 1). */
#define ONE_PIXEL                                                                                                      \
    "local m = gr.material({.5,.25,.125}, {.2,.4,.6}, 3)\n"                                                            \
    "local r = gr.node('r') r:add_child(gr.nh_box(m, {-1,-1,-2}, 2))\n"                                                \
    "gr.render(r, 't.png', 1, 1, {0,0,5}, {0,0,-1}, {0,1,0}, 20, {.1,.2,.3}, {gr.light({0,3,4}, {.5,.6,.7}, "          \
    "{0,0,0})})\n"

TEST(switches_for_scenes_of_other_programs_do_what_they_say) {
    double phong = .8 * .8 * .8, n_h = 1.8 / sqrt(.36 + 1.8 * 1.8), blinn = n_h * n_h * n_h;
    renders(ONE_PIXEL, "");
    expect_rgb("t.png", 0, 0, .1 * .5 + .5 * (.5 * .8 + .2 * phong), .2 * .25 + .6 * (.25 * .8 + .4 * phong),
               .3 * .125 + .7 * (.125 * .8 + .6 * phong));
    renders(ONE_PIXEL, "--specular blinn");
    expect_rgb("t.png", 0, 0, .1 * .5 + .5 * (.5 * .8 + .2 * blinn), .2 * .25 + .6 * (.25 * .8 + .4 * blinn),
               .3 * .125 + .7 * (.125 * .8 + .6 * blinn));
    renders(ONE_PIXEL, "--ambient plain");
    expect_rgb("t.png", 0, 0, .1 + .5 * (.5 * .8 + .2 * phong), .2 + .6 * (.25 * .8 + .4 * phong),
               .3 + .7 * (.125 * .8 + .6 * phong));
    /* (0, 0, -1) as a target gives the same view here; from (3, 0, 4) it does not. */
    renders("local r = gr.node('r') r:add_child(gr.nh_sphere(gr.material({1,0,0}, {0,0,0}, 1), {1,2,3}, .1))\n"
            "gr.render(r, 't.png', 3, 3, {3,7,4}, {1,2,3}, {0,1,0}, 5, {1,1,1}, {})\n",
            "--view target -side-tolerance 9 -corner-tolerance 9");
    expect_rgb("t.png", 1, 1, 1, 0, 0);
}

TEST(colours_outside_0_and_1_are_used_as_they_are) {
    renders("local m = gr.material({2,-1,.5}, {-1,3,0}, 1)\n"
            "local r = gr.node('r') r:add_child(gr.nh_box(m, {-1,-1,-2}, 2))\n"
            "gr.render(r, 't.png', 1, 1, {0,0,5}, {0,0,-1}, {0,1,0}, 20, {.1,.1,-.2}, {gr.light({0,3,4}, {.3,.3,2}, "
            "{0,0,0}), gr.light({0,3,4}, {-.1,0,-1}, {0,0,0})})\n",
            "");
    expect_rgb("t.png", 0, 0, .2 + .2 * (1.6 - .8), -.1 + .3 * (-.8 + 2.4), -.1 + 1 * .4);
}

TEST(children_inherit_the_transform_of_a_shape_and_not_its_material) {
    renders("local red, green = gr.material({1,0,0},{0,0,0},1), gr.material({0,1,0},{0,0,0},1)\n"
            "local parent, child = gr.sphere('p'), gr.sphere('c')\n"
            "parent:add_child(child)\n"
            "child:translate(3,0,0) child:scale({.5,.5,.5}) child:set_material(green) parent:set_material(red)\n"
            "parent:rotate('Z', 90) parent:translate({0,-1,0})\n" /* all after add_child */
            "gr.render{node=parent, file='t.png', width=41, height=41, eye={0,0,30}, fov=20, ambient={1,1,1}, "
            "background={0,0,0}}\n",
            "");
    double per_unit = 41 / (2 * 30 * tan(10 * 3.14159265358979323846 / 180));
    expect_rgb("t.png", 20, (uint32_t)(20.5 + per_unit), 1, 0, 0);
    expect_rgb("t.png", 20, (uint32_t)(20.5 - .5 * per_unit), 0, 1, 0); /* (1.5, 0) turned, moved down by 1 */
    expect_rgb("t.png", (uint32_t)(20.5 + 1.5 * per_unit), 20, 0, 0, 0);
}

TEST(an_instance_follows_the_shape_it_is_of) {
    renders("local red, green = gr.material({1,0,0},{0,0,0},1), gr.material({0,1,0},{0,0,0},1)\n"
            "local ball = gr.sphere(red) local left, right, root = gr.node('l'), gr.node('r'), gr.node('t')\n"
            "left:add_child(ball) right:add_child(ball) root:add_child(left) root:add_child(right)\n"
            "left:translate(-3,0,0) right:translate(3,0,0)\n"
            "local function show(f) gr.render{node=root, file=f, width=41, height=41, eye={0,0,30}, fov=20, "
            "ambient={1,1,1}, background={0,0,0}} end\n"
            "show('1.png') ball:set_material(green) ball:translate(0,2,0) show('2.png')\n",
            "");
    double per_unit = 41 / (2 * 30 * tan(10 * 3.14159265358979323846 / 180));
    for (int side = -1; side <= 1; side += 2) {
        uint32_t x = (uint32_t)(20.5 + side * 3 * per_unit);
        expect_rgb("1.png", x, 20, 1, 0, 0);
        expect_rgb("2.png", x, 20, 0, 0, 0);
        expect_rgb("2.png", x, (uint32_t)(20.5 - 2 * per_unit), 0, 1, 0);
    }
}

TEST(a_joint_is_drawn_at_its_initial_angles) {
    renders("local j, s = gr.joint('j', {-10,90,120}, {0,0,0}), gr.sphere('s')\n"
            "s:set_material(gr.material({1,0,0},{0,0,0},1)) s:translate(0,0,2) j:add_child(s)\n"
            "local k, q = gr.joint('k', {0,0,0}, {-90,-90,0}), gr.sphere('q')\n"
            "q:set_material(gr.material({0,1,0},{0,0,0},1)) q:translate(0,0,2) k:add_child(q)\n"
            "local r = gr.node('r') r:add_child(j) r:add_child(k)\n"
            "gr.render{node=r, file='t.png', width=41, height=41, eye={0,0,30}, fov=20, ambient={1,1,1}, "
            "background={0,0,0}}\n",
            "");
    double per_unit = 41 / (2 * 30 * tan(10 * 3.14159265358979323846 / 180));
    expect_rgb("t.png", 20, (uint32_t)(20.5 + 2 * per_unit), 1, 0, 0); /* +z about x by 90: -y */
    expect_rgb("t.png", (uint32_t)(20.5 - 2 * per_unit), 20, 0, 1, 0); /* +z about y by -90: -x */
}

TEST(meshes_take_images_by_their_vt_with_v_counted_from_below) {
    test_write_text(test_path("q.obj"),
                    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    write_texels("t.png", 5, 3);
    renders("local q = gr.mesh('q', 'q.obj') q:set_material(gr.material({1,1,1},{0,0,0},1))\n"
            "q:set_texture(gr.texture{file='t.png', filter='nearest'})\n"
            "gr.render{node=q, file='p.png', width=40, height=40, eye={.5,.5,1}, fov=90, ambient={1,1,1}, "
            "background={0,0,0}, side_tolerance=9, corner_tolerance=9}\n",
            "");
    struct test_picture p = test_read_picture(test_path("p.png"));
    int wrong = 0;
    for (uint32_t y = 10; y < 30; y++)
        for (uint32_t x = 10; x < 30; x++)
            wrong += wrong_texel(pixel(&p, x, y), (x + .5 - 10) / 20, (y + .5 - 10) / 20, 5, 3);
    CHECK_EQ_INT(wrong, 0);
    free(p.rgb);
}

TEST(the_alpha_of_an_image_mixes_with_the_base_and_gamma_chunks_are_ignored) {
    static const uint8_t rgba[4] = {200, 100, 0, 102};
    png_image image = {.version = PNG_IMAGE_VERSION, .width = 1, .height = 1, .format = PNG_FORMAT_RGBA};
    CHECK(png_image_write_to_file(&image, test_path("a.png"), 0, rgba, 0, NULL)); /* writes an sRGB chunk, too */
    renders("local m = gr.td_cube_material(gr.material({0,.5,1},{0,0,0},1), 'a.png')\n"
            "local c = gr.cube(m)\n"
            "gr.render{node=c, file='t.png', width=1, height=1, eye={.5,.5,3}, ambient={1,1,1}}\n",
            "");
    expect_rgb("t.png", 0, 0, .4 * 200 / 255, .4 * 100 / 255 + .6 * .5, .6);
}

TEST(the_background_is_the_gradient_of_the_unit_direction_unless_the_scene_says_otherwise) {
    renders(
        "local n = gr.node('n')\n"
        "gr.render(n, 'a.png', 1, 1, {5,5,5}, {0,6,-8}, {0,1,0}, 50, {0,0,0}, {})\n"
        "gr.render{node=n, file='b.png', width=1, height=1, eye={0,0,0}, background={.1,.2,.3}}\n"
        "gr.render{node=gr.nh_sphere(gr.rr_material({0,0,0},{1,.5,1},1,.5,0,1), {0,0,0}, 1), file='c.png', width=1, "
        "height=1, eye={0,0,5}, background={.4,.8,.2}}\n",
        "");
    expect_rgb("a.png", 0, 0, 0, 0, .8);
    expect_rgb("b.png", 0, 0, .1, .2, .3);
    expect_rgb("c.png", 0, 0, .2, .2, .1);
}

TEST(every_spelling_of_a_shape_gives_the_same_picture) {
    static const char *const same[][6] = {
        {"gr.cube(m)", "gr.geometry('g', gr.cube(m))", "with(gr.cube('c'))", "with(gr.nh_box('b', {1,1,1}, -1))",
         "gr.nh_box(m, {0,0,0}, 1)", "gr.cube{material=m, corner={0,0,0}, size=1}"},
        {"gr.nh_sphere(m, {1,0,0}, .5)", "with(gr.nh_sphere('s', {1,0,0}, .5))",
         "gr.sphere{material=m, centre={1,0,0}, radius=.5}", "gr.geometry('g', gr.nh_sphere(m, {1,0,0}, .5))", NULL,
         NULL},
        {"gr.mesh(m, v, f)", "gr.fast_mesh(m, v, f)", "with(gr.mesh('n', v, f))", "with(gr.mesh('n', 'q.obj'))",
         "gr.geometry('g', gr.mesh{material=m, verts=v, faces=f})", "gr.mesh(m, 'q.obj')"},
        {"gr.vn_mesh(m, v, n, f, f)", "gr.fast_vn_mesh(m, v, n, f, f)", "with(gr.vn_mesh('n', v, n, f, f))",
         "gr.mesh{material=m, verts=v, normals=n, faces=f, face_normals=f}", "gr.vn_mesh(m, v, longer, f, f)", NULL},
    };
    char path[600], scene[6000];
    (void)snprintf(path, sizeof path, "%s/q.obj", test_folder());
    test_write_text(path, "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 .5 .2\nv 0 2 0\nf 1 2 3 4 5\n"); /* a concave pentagon */
    for (size_t k = 0; k < sizeof same / sizeof same[0]; k++) {
        int used = snprintf(scene, sizeof scene,
                            "local m = gr.material({.8,.3,.2}, {.4,.4,.4}, 9)\n"
                            "local function with(n) n:set_material(m) return n end\n"
                            "local v = {{0,0,0},{2,0,0},{2,2,0},{1,.5,.2},{0,2,0}} local f = {{0,1,2,3,4}}\n"
                            "local n = {{0,0,1},{.5,0,1},{.5,.5,1},{0,0,1},{0,.5,1}}\n"
                            "local longer = {} for i, a in ipairs(n) do longer[i] = {3*a[1], 3*a[2], 3*a[3]} end\n");
        for (int j = 0; j < 6 && same[k][j]; j++)
            used += snprintf(scene + used, sizeof scene - (size_t)used,
                             "do local r = gr.node('r') r:add_child(%s) gr.render(r, '%d.png', 40, 30, {2,2,5}, "
                             "{-1,-1,-4}, {0,1,0}, 40, {.2,.2,.2}, {gr.light({3,4,5}, {.9,.9,.9}, {1,0,0})}) end\n",
                             same[k][j], j);
        renders(scene, "--transform-order new");
        struct test_picture first = test_read_picture(test_path("0.png"));
        for (int j = 1; j < 6 && same[k][j]; j++) {
            char name[20];
            (void)snprintf(name, sizeof name, "%d.png", j);
            struct test_picture p = test_read_picture(test_path(name));
            if (!p.rgb || !first.rgb || memcmp(p.rgb, first.rgb, 3 * 40 * 30) != 0)
                test_fail(__FILE__, __LINE__, "%s and %s differ", same[k][0], same[k][j]);
            free(p.rgb);
        }
        free(first.rgb);
    }
}

/* Decorators that change different inputs commute; two patterns do not. */
TEST(decorators_compose_in_any_order) {
    renders(
        "local glass = gr.rr_material({.2,.3,.1}, {1,1,1}, 40, .2, .5, 1.5)\n"
        "local function wood(m) return gr.wood_pnd_material(m, 2, 5, 1, {.9,.5,.1}) end\n"
        "local function marble(m) return gr.marble_pnd_material(m, 2, 4, 3, 0, {.1,.5,.9}) end\n"
        "local fresnel = gr.difresnel_material\n"
        "local all = {fresnel(wood(marble(glass))), wood(fresnel(marble(glass))), wood(marble(fresnel(glass))), "
        "fresnel(fresnel(wood(marble(fresnel(glass))))), marble(wood(fresnel(glass))), wood(marble(glass))}\n"
        "for i, m in ipairs(all) do local r = gr.node('r') r:add_child(gr.sphere(m))\n"
        "gr.render(r, i .. '.png', 30, 30, {0,0,5}, {0,0,-1}, {0,1,0}, 25, {.6,.6,.6}, {gr.light({3,4,5}, {.5,.5,.5}, "
        "{1,0,0})}) end\n",
        "-ss 1");
    struct test_picture first = test_read_picture(test_path("1.png"));
    for (int i = 2; i <= 6; i++) {
        char name[20];
        (void)snprintf(name, sizeof name, "%d.png", i);
        struct test_picture p = test_read_picture(test_path(name));
        bool same = memcmp(p.rgb, first.rgb, 3 * 30 * 30) == 0;
        if (same != (i <= 4))
            test_fail(__FILE__, __LINE__, "picture %d is %s", i, same ? "the same" : "different");
        free(p.rgb);
    }
    free(first.rgb);
}
