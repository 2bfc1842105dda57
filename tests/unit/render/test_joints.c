/* Solids that touch (world/joint.h): what is seen through them, beside Snell's law, one solid in place of two, and a
 * white furnace. */
#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The pixels of NAME.pfm in the folder of the test, row by row from the bottom. */
static float *pixels_of(const char *name, int width, int height) {
    char file[64];
    (void)snprintf(file, sizeof file, "%s.pfm", name);
    size_t size, count = (size_t)width * (size_t)height * 3;
    char *bytes = test_read_file(test_path(file), &size);
    float *pixels = malloc(count * sizeof *pixels);
    CHECK(bytes && pixels && size > count * sizeof *pixels);
    memcpy(pixels, bytes + size - count * sizeof *pixels, count * sizeof *pixels);
    free(bytes);
    return pixels;
}

static void run_with(const char *scene, const char *arguments) {
    struct test_result result = test_gray_scene(scene, arguments, NULL);
    CHECK_EQ_INT(result.status, 0);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s", result.err);
    test_free_result(&result);
}

static void run(const char *scene) {
    run_with(scene, "scene.lua");
}

/* --- Snell's law --- */

struct vector {
    double x, y, z;
};

static double dot(struct vector a, struct vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static struct vector along(struct vector a, struct vector b, double s) {
    return (struct vector){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static struct vector unit(struct vector a) {
    double length = sqrt(dot(a, a));
    return (struct vector){a.x / length, a.y / length, a.z / length};
}
static struct vector cross(struct vector a, struct vector b) {
    return (struct vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* The direction behind a surface with the unit normal n on the side of the ray, from index a to index b. */
static struct vector refracted(struct vector d, struct vector n, double a, double b) {
    double eta = a / b, cosine = -dot(d, n), rest = 1 - eta * eta * (1 - cosine * cosine);
    return along((struct vector){eta * d.x, eta * d.y, eta * d.z}, n, eta * cosine - sqrt(rest));
}

/* A doublet on the z axis, seen from above: crown with a front of radius 61, flint with a back of radius 130, and a
 * common face of radius 46 between them. */
enum { WIDE = 41, HIGH = 37 };
static const double crown = 1.517, flint = 1.649, picture_height = 10;
static const struct cap {
    double vertex, radius; /* on the axis; > 0: the centre is above */
} caps[] = {{3, -61}, {0, 46}, {-1.5, 130}};
static const double indices[] = {1, crown, flint, 1};

static double height_of(const struct cap *cap, double r) {
    return cap->vertex + cap->radius - copysign(sqrt(cap->radius * cap->radius - r * r), cap->radius);
}

/* The next crossing of a sphere below the point. */
static struct vector meet_cap(const struct cap *cap, struct vector p, struct vector d, struct vector *normal) {
    struct vector centre = {0, 0, cap->vertex + cap->radius}, o = along(p, centre, -1);
    double b = dot(o, d), c = dot(o, o) - cap->radius * cap->radius, root = sqrt(b * b - c);
    double t = cap->radius > 0 ? -b + root : -b - root;
    struct vector at = along(p, d, t);
    *normal = unit(along(at, centre, -1));
    if (dot(*normal, d) > 0)
        *normal = (struct vector){-normal->x, -normal->y, -normal->z};
    return at;
}

typedef struct vector meet_surface(const struct cap *cap, struct vector p, struct vector d, struct vector *normal);

/* The direction of a ray from above behind all three surfaces. */
static struct vector through(meet_surface *meet, struct vector p) {
    struct vector d = {0, 0, -1}, n;
    for (int i = 0; i < 3; i++) {
        p = meet(&caps[i], p, d, &n);
        d = refracted(d, n, indices[i], indices[i + 1]);
    }
    return d;
}

/* The caps as facets, in rings about the axis; the rim is outside of the picture. */
enum { RINGS = 7, SECTORS = 30, POINTS = RINGS * SECTORS + 1, FACETS = SECTORS * (2 * RINGS - 1) };
static struct vector cap_point(const struct cap *cap, int number) {
    if (number == 0) /* off the ray in the middle */
        return (struct vector){0.013, 0.007, height_of(cap, hypot(0.013, 0.007))};
    double r = 10.0 * ((number - 1) / SECTORS + 1) / RINGS,
           angle = 0.1 + 2 * acos(-1.0) * ((number - 1) % SECTORS) / SECTORS;
    return (struct vector){r * cos(angle), r * sin(angle), height_of(cap, r)};
}

/* Numbers of the corners, counter-clockwise from above. */
static void facet_corners(int facet, int out[3]) {
    int ring = facet < SECTORS ? 0 : 1 + (facet - SECTORS) / (2 * SECTORS);
    int k = facet < SECTORS ? facet : (facet - SECTORS) % (2 * SECTORS), sector = k % SECTORS;
    int here = 1 + ring * SECTORS + sector, next = 1 + ring * SECTORS + (sector + 1) % SECTORS;
    if (ring == 0) {
        out[0] = 0, out[1] = here, out[2] = next;
    } else if (k < SECTORS) {
        out[0] = here - SECTORS, out[1] = here, out[2] = next;
    } else {
        out[0] = here - SECTORS, out[1] = next, out[2] = next - SECTORS;
    }
}

/* The facet of a cap that the ray meets. */
static struct vector meet_facets(const struct cap *cap, struct vector p, struct vector d, struct vector *normal) {
    for (int facet = 0; facet < FACETS; facet++) {
        int corner[3];
        facet_corners(facet, corner);
        struct vector a = cap_point(cap, corner[0]), u = along(cap_point(cap, corner[1]), a, -1),
                      v = along(cap_point(cap, corner[2]), a, -1), n = cross(u, v);
        struct vector at = along(p, d, dot(along(a, p, -1), n) / dot(d, n)), from = along(at, a, -1);
        double area = dot(n, n), s = dot(cross(from, v), n) / area, t = dot(cross(u, from), n) / area;
        if (s < 0 || t < 0 || s + t > 1)
            continue;
        *normal = unit(n);
        return at;
    }
    CHECK(false);
    return p;
}

static const char lens_frame[] =
    "local function glass(n) return gr.rr_material({0,0,0}, {1,1,1}, 100, 0, 1, n) end\n"
    "local root = gr.node('root')\n%s\n"
    "gr.render{node = root, file = 'x.pfm', width = 41, height = 37, eye = {0, 0, 60}, view = {0, 0, -1}, up = {0, 1, "
    "0},\n  projection = 'orthographic', view_height = 10, lights = {}, side_tolerance = 3, corner_tolerance = 3,\n"
    "  background = function(d) return gr.vec(d.x + .5, d.y + .5, d.z + 2) end}\n";

/* Renders the solids and compares each ray with the direction that is right. */
static void check_lens(const char *solids, meet_surface *meet) {
    size_t length = strlen(solids) + sizeof lens_frame;
    char *scene = malloc(length);
    CHECK(scene);
    (void)snprintf(scene, length, lens_frame, solids);
    run(scene);
    free(scene);
    float *pixels = pixels_of("x", WIDE, HIGH);
    int wrong = 0;
    for (int y = 0; y < HIGH; y++) {
        for (int x = 0; x < WIDE; x++) {
            const double pixel = picture_height / HIGH;
            struct vector d =
                through(meet, (struct vector){(x + 0.5 - WIDE / 2.0) * pixel, (y + 0.5 - HIGH / 2.0) * pixel, 60});
            const float *seen = pixels + 3 * (y * WIDE + x);
            double off = fmax(fmax(fabs((double)seen[0] - (d.x + 0.5)), fabs((double)seen[1] - (d.y + 0.5))),
                              fabs((double)seen[2] - (d.z + 2)));
            wrong += off > 2e-7;
        }
    }
    CHECK_EQ_INT(wrong, 0);
    free(pixels);
}

#define CSG_DOUBLET                                                                                                    \
    "local function front() return gr.sphere{centre = {0,0,-58}, radius = 61} end\n"                                   \
    "local function common() return gr.sphere{centre = {0,0,46}, radius = 46} end\n"                                   \
    "local function back() return gr.sphere{centre = {0,0,128.5}, radius = 130} end\n"                                 \
    "local cylinder = gr.cylinder{from = {0,0,-10}, to = {0,0,5}, radius = 10}\n"                                      \
    "local a = gr.intersection(front(), common()) a:set_material(glass(1.517))\n"                                      \
    "local b = gr.difference(gr.intersection(back(), cylinder), common()) b:set_material(glass(1.649))\n"

TEST(a_cemented_doublet_of_spheres_refracts_by_snells_law) {
    check_lens(CSG_DOUBLET "root:add_child(a) root:add_child(b)", meet_cap);
    check_lens(CSG_DOUBLET "root:add_child(b) root:add_child(a)", meet_cap);
}

TEST(a_cemented_doublet_under_different_transforms_refracts_by_snells_law) {
    check_lens("local function placed(n, s, angle, dz)\n"
               "  n:scale(1/s, 1/s, 1/s) n:rotate('z', -angle) n:translate(0, 0, -dz)\n"
               "  local m = gr.node('m') m:translate(0, 0, dz) m:rotate('z', angle) m:scale(s, s, s)\n"
               "  m:add_child(n) root:add_child(m)\nend\n" CSG_DOUBLET "placed(a, 3, 33, .7) placed(b, .7, -71, 11.3)",
               meet_cap);
}

/* A closed mesh between two caps, whose rims are joined, as a table of the script. */
static size_t write_mesh(char *out, size_t size, const char *name, const char *index, const struct cap *above,
                         const struct cap *below, double scale) {
    size_t used = (size_t)snprintf(out, size, "local %s = gr.mesh(glass(%s), {", name, index);
    const struct cap *both[2] = {above, below};
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < POINTS; k++) {
            struct vector p = cap_point(both[i], k);
            used += (size_t)snprintf(out + used, size - used, "{%.17g,%.17g,%.17g},", p.x / scale, p.y / scale,
                                     p.z / scale);
        }
    }
    used += (size_t)snprintf(out + used, size - used, "}, {");
    for (int facet = 0; facet < FACETS; facet++) {
        int c[3];
        facet_corners(facet, c);
        used += (size_t)snprintf(out + used, size - used, "{%d,%d,%d},{%d,%d,%d},", c[0], c[1], c[2], c[0] + POINTS,
                                 c[2] + POINTS, c[1] + POINTS);
    }
    for (int sector = 0; sector < SECTORS; sector++) {
        int a = POINTS - SECTORS + sector, b = POINTS - SECTORS + (sector + 1) % SECTORS;
        used += (size_t)snprintf(out + used, size - used, "{%d,%d,%d},{%d,%d,%d},", a, a + POINTS, b + POINTS, a,
                                 b + POINTS, b);
    }
    return used + (size_t)snprintf(out + used, size - used, "})\n%s:scale(%g,%g,%g) root:add_child(%s)\n", name, scale,
                                   scale, scale, name);
}

static void check_mesh_lens(double first_scale, double second_scale) {
    enum { ROOM = 1 << 18 };
    char *solids = malloc(ROOM);
    CHECK(solids);
    size_t used = write_mesh(solids, ROOM, "a", "1.517", &caps[0], &caps[1], first_scale);
    used += write_mesh(solids + used, ROOM - used, "b", "1.649", &caps[1], &caps[2], second_scale);
    CHECK(used < ROOM);
    check_lens(solids, meet_facets);
    free(solids);
}

TEST(a_cemented_doublet_of_meshes_refracts_by_snells_law) {
    check_mesh_lens(1, 1);
    check_mesh_lens(3, 0.7);
}

/* --- one solid in place of two --- */

/* Boxes of the same glass, and one box in their place. */
static const char box_frame[] =
    "local function glass(m) return gr.difresnel_material(gr.rr_material({0,0,0}, {%s}, 100, 1, 1, 1.5)) end\n"
    "local g = glass() %s\n"
    "local function box(x, w) return gr.cube{material = g, corner = {x, -1, -1}, size = {w, 2, 2}} end\n"
    "for name, parts in pairs{a = {{-1, 2}}, b = {%s}} do\n"
    "  local r = gr.node('r') for _, p in ipairs(parts) do r:add_child(box(p[1], p[2])) end\n"
    "  r:rotate('x', 15):rotate('y', 30)\n"
    "  gr.render{node = r, file = name .. '.pfm', width = 60, height = 45, eye = {0, 0, 8}, fov = 30, lights = {},\n"
    "    background = function(d) return gr.vec(.5 + .5 * d.x, .5 + .5 * d.y, .5 + .5 * d.z) end, use_tir = true,\n"
    "    reflect_limit = 12, refract_limit = 12, side_tolerance = 3, corner_tolerance = 3}\nend\n";

/* Two pictures of one script, 60 x 45 pixels: the number of pixels that differ by more than .02, and the difference of
 * the means. */
static int different_pixels(const char *scene, double *mean_difference) {
    enum { COUNT = 60 * 45 };
    run(scene);
    float *a = pixels_of("a", 60, 45), *b = pixels_of("b", 60, 45);
    int differ = 0;
    double sum = 0;
    for (int i = 0; i < COUNT; i++) {
        double off = 0;
        for (int c = 0; c < 3; c++) {
            double d = (double)a[3 * i + c] - (double)b[3 * i + c];
            off = fmax(off, fabs(d));
            sum += d;
        }
        differ += off > 0.02;
    }
    free(a);
    free(b);
    *mean_difference = fabs(sum) / (3 * COUNT);
    return differ;
}

static void check_boxes(const char *tint, const char *more, const char *parts, double limit) {
    char scene[2048];
    int length = snprintf(scene, sizeof scene, box_frame, tint, more, parts);
    CHECK(length > 0 && (size_t)length < sizeof scene);
    double difference;
    CHECK(different_pixels(scene, &difference) <= 5);
    CHECK(difference <= limit);
}

TEST(flush_boxes_of_one_glass_equal_one_box) {
    check_boxes("1,1,1", "", "{-1, 1}, {0, 1}", 1e-4);
    check_boxes(".9,.7,.5", "", "{-1, 1}, {0, 1}", 1e-4);
    check_boxes(".9,.7,.5", "", "{.3, .7}, {-1, .9}, {-.1, .4}", 1e-4);
}

TEST(flush_boxes_of_absorbing_glass_equal_one_box) {
    const char *glass = "g = gr.difresnel_material(gr.material{kd={0,0,0}, ks={1,1,1}, reflect=1, refract=1,"
                        " ior=1.5, absorption={.1,.4,.9}})";
    check_boxes("1,1,1", glass, "{-1, 1}, {0, 1}", 1e-6);
    check_boxes("1,1,1", glass, "{.3, .7}, {-1, .9}, {-.1, .4}", 1e-6);
}

TEST(a_lamp_in_front_of_a_common_face_is_seen_as_in_one_box) {
    static const char scene[] =
        "local g = gr.difresnel_material(gr.material{kd={0,0,0}, ks={1,1,1}, reflect=1, refract=1, ior=1.5})\n"
        "local function box(z, d) return gr.cube{material = g, corner = {-2, -2, z}, size = {4, 4, d}} end\n"
        "local lamp = gr.disc_light{position = {0, 0, 1}, normal = {0, 0, 1}, radius = 1, emission = {3, 2, 1},\n"
        "  visible = true}\n"
        "for name, parts in pairs{a = {{-2, 4}}, b = {{0, 2}, {-2, 2}}} do\n"
        "  local r = gr.node('r') for _, p in ipairs(parts) do r:add_child(box(p[1], p[2])) end\n"
        "  gr.render{node = r, file = name .. '.pfm', width = 60, height = 45, eye = {1, 1, 8}, fov = 40,\n"
        "    lights = {lamp}, side_tolerance = 3, corner_tolerance = 3, integrator = INTEGRATOR, spp = 4}\nend\n";
    static const char *const integrators[] = {"'whitted'", "'path'"};
    for (int i = 0; i < 2; i++) {
        char whole[2048], *at = strstr(strcpy(whole, scene), "INTEGRATOR");
        (void)snprintf(at, sizeof whole - (size_t)(at - whole), "%s%s", integrators[i],
                       strstr(scene, "INTEGRATOR") + strlen("INTEGRATOR"));
        double difference;
        CHECK(different_pixels(whole, &difference) <= 5);
        CHECK(difference <= 1e-4);
    }
}

#define PAIR_OF_PICTURES                                                                                               \
    "local function picture(name, r)\n"                                                                                \
    "  r:rotate('x', 15):rotate('y', 30)\n"                                                                            \
    "  gr.render{node = r, file = name .. '.pfm', width = 60, height = 45, eye = {0, 0, 8}, fov = 30, lights = {},\n"  \
    "    background = function(d) return gr.vec(.5 + .5 * d.x, .5 + .5 * d.y, .5 + .5 * d.z) end, use_tir = true,\n"   \
    "    reflect_limit = 9, refract_limit = 12, side_tolerance = 3, corner_tolerance = 3}\nend\n"                      \
    "local function glass(n, t)\n"                                                                                     \
    "  return gr.difresnel_material(gr.rr_material({0,0,0}, t or {1,1,1}, 100, 1, 1, n)) end\n"                        \
    "local function box(m, x, y, w, h)\n"                                                                              \
    "  return gr.cube{material = m, corner = {x, y, -1}, size = {w, h, 2}} end\n"                                      \
    "local function scene(...) local r = gr.node('r') for _, n in ipairs{...} do r:add_child(n) end return r end\n"

TEST(the_order_of_transparent_solids_that_touch_changes_nothing) {
    double difference;
    CHECK(different_pixels(PAIR_OF_PICTURES
                           "local a, b, c = box(glass(1.5), -1, -1, 1, 2), box(glass(1.3, {.9,.5,.7}), 0, -1, 1, 1),\n"
                           "  box(glass(1.8, {.6,.9,.9}), 0, 0, 1, 1)\n"
                           "picture('a', scene(a, b, c)) picture('b', scene(c, b, a))\n",
                           &difference) <= 5);
}

/* As if the wall began in the glass, and the sheet were on both sides of its face. */
TEST(an_opaque_surface_at_a_transparent_one_is_what_is_seen) {
    double difference;
    CHECK(different_pixels(
              PAIR_OF_PICTURES
              "local blue, green = gr.material{kd = {0,0,1}, lit = false}, gr.material{kd = {0,1,0}, lit = false}\n"
              "local g = glass(1.5)\n"
              "local function wall(x) return box(blue, x, -1, 1, 2) end\n"
              "local function sheet(x)\n"
              "  return gr.rectangle{material = green, corner = {x,-1,1}, along = {0,0,-2}, up = {0,2,0}} end\n"
              "picture('a', scene(box(g, -1, -1, 1, 2), wall(0), sheet(-1)))\n"
              "picture('b', scene(sheet(-1 - 1e-7), sheet(-1 + 1e-7), box(g, -1, -1, 1, 2), wall(-1e-7)))\n",
              &difference) <= 5);
}

/* The first one in the tree: boxes, a rectangle, a mesh and a CSG solid on one face, each of them once. Flat ones are
 * seen as if they were a little in front. */
TEST(of_opaque_surfaces_that_coincide_the_first_one_is_seen_without_speckle) {
    for (int first = 0; first < 5; first++) {
        char text[4096];
        int length =
            snprintf(text, sizeof text,
                     PAIR_OF_PICTURES
                     "local function plain(r, g, b) return gr.material{kd = {r,g,b}, lit = false} end\n"
                     "local function all()\n"
                     "  local red = plain(1,0,0)\n"
                     "  local m = gr.mesh(plain(0,1,0), {{-3,-3,3},{3,-3,3},{3,3,3},{-3,3,3}}, {{0,1,2,3}})\n"
                     "  m:scale(1/3, 1/3, 1/3)\n"
                     "  return {box(red, -1, -1, 2, 2),\n"
                     "    gr.rectangle{material = plain(0,0,1), corner = {-1,-1,1}, along = {2,0,0}, up = {0,2,0}},\n"
                     "    m, gr.difference(gr.cube{material = plain(1,1,0), corner = {-1,-1,-1}, size = {2,2,4}},\n"
                     "      gr.cube{material = plain(1,1,0), corner = {-2,-2,1}, size = 4}),\n"
                     "    gr.cube{material = plain(1,0,1), corner = {-7,-7,-7}, size = 14}:scale(1/7,1/7,1/7)}\nend\n"
                     "local parts = all()\n"
                     "table.insert(parts, 1, table.remove(parts, %d))\n"
                     "picture('a', scene(table.unpack(parts)))\n"
                     "picture('b', %s)\n",
                     first + 1,
                     first == 1 || first == 2 ? "scene(gr.node{children = {parts[1]}}:translate(0, 0, 1e-6), "
                                                "table.unpack(parts, 2))"
                                              : "scene(parts[1])");
        CHECK(length > 0 && (size_t)length < sizeof text);
        double difference;
        int differ = different_pixels(text, &difference);
        if (differ > 5)
            test_fail(__FILE__, __LINE__, "%d first: %d pixels", first, differ);
    }
}

/* The means of the channels of a picture of 8 x 8 pixels. */
static void means_of(const char *name, double out[3]) {
    float *pixels = pixels_of(name, 8, 8);
    for (int c = 0; c < 3; c++) {
        out[c] = 0;
        for (int i = 0; i < 64; i++)
            out[c] += (double)pixels[3 * i + c] / 64;
    }
    free(pixels);
}

TEST(of_solids_that_are_entered_at_one_point_the_first_one_counts_as_entered_last) {
    static const char scene[] =
        "local function glass(a) return gr.material{kd={0,0,0}, ks={1,1,1}, refract=1, ior=1.5, absorption=a} end\n"
        "for i, name in ipairs{'a', 'b'} do\n"
        "  local one = gr.cube{material = glass{1,0,0}, corner = {-2,-2,-1}, size = {3,4,2}}\n"
        "  local two = gr.cube{material = glass{0,0,1}, corner = {-1,-2,-1}, size = {3,4,2}}\n"
        "  local r = gr.node('r') r:add_child(i == 1 and one or two) r:add_child(i == 1 and two or one)\n"
        "  gr.render{node = r, file = name .. '.pfm', width = 8, height = 8, eye = {0,0,8}, view = {0,0,-1},\n"
        "    projection = 'orthographic', view_height = 1, background = {1,1,1}, lights = {}}\nend\n";
    double means[3];
    run(scene);
    means_of("a", means);
    CHECK_NEAR(means[0], exp(-2), 1e-6);
    CHECK_NEAR(means[2], 1, 1e-6);
    means_of("b", means);
    CHECK_NEAR(means[0], 1, 1e-6);
    CHECK_NEAR(means[2], exp(-2), 1e-6);
}

/* A floor that hundreds of boxes stand on, seen from below through them: each touches it, and some other boxes. */
TEST(a_floor_that_hundreds_of_solids_touch_is_seen_through_each_of_them) {
    static const char scene[] =
        "local floor = gr.material{kd = {.2,.5,.9}, lit = false}\n"
        "local g = gr.material{kd={0,0,0}, ks={1,1,1}, refract=1, ior=1.5}\n"
        "local r = gr.node('r')\n"
        "for x = -10, 9 do for z = -10, 9 do r:add_child(gr.cube{material = g, corner = {x,0,z}, size = 1}) end end\n"
        "r:add_child(gr.cube{material = floor, corner = {-20,-1,-20}, size = {40,1,40}})\n"
        "gr.render{node = r, file = 'x.pfm', width = 8, height = 8, eye = {.3,30,.4}, view = {.01,-1,.02}, up = "
        "{0,0,-1},\n"
        "  fov = 30, background = {1,1,1}, lights = {}}\n";
    double means[3];
    run(scene);
    means_of("x", means);
    CHECK_NEAR(means[0], 0.2, 1e-6);
    CHECK_NEAR(means[1], 0.5, 1e-6);
    CHECK_NEAR(means[2], 0.9, 1e-6);
}

/* A floor with many partners and boxes with few, whose partners each accelerator finds in its own way. */
TEST(surfaces_that_touch_are_found_with_every_accelerator) {
    static const char scene[] =
        "local g = gr.difresnel_material(gr.rr_material({0,0,0}, {.9,1,.8}, 100, 1, 1, 1.5))\n"
        "local r = gr.node('r')\n"
        "for x = -4, 3 do for z = -4, 3 do r:add_child(gr.cube{material = g, corner = {x,0,z}, size = 1}) end end\n"
        "r:add_child(gr.cube{material = gr.material{kd = {.2,.5,.9}, lit = false}, corner = {-9,-1,-9}, size = "
        "{18,1,18}})\n"
        "gr.render{node = r, file = 'x.pfm', width = 24, height = 18, eye = {3,6,9}, target = {0,0,0}, fov = 40,\n"
        "  background = {1,1,1}, lights = {}}\n";
    static const char *const kinds[] = {"none", "grid", "bvh", "kdtree"};
    float *first = NULL;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        char arguments[64];
        (void)snprintf(arguments, sizeof arguments, "--accel %s scene.lua", kinds[i]);
        run_with(scene, arguments);
        float *pixels = pixels_of("x", 24, 18);
        if (first && memcmp(first, pixels, 24 * 18 * 3 * sizeof *pixels) != 0)
            test_fail(__FILE__, __LINE__, "%s", kinds[i]);
        if (first)
            free(pixels);
        else
            first = pixels;
    }
    free(first);
}

/* Photons through two flush boxes, and through one box in their place. */
TEST(photons_pass_a_common_face_as_if_it_were_not_there) {
    static const char scene[] =
        "local g = gr.difresnel_material(gr.rr_material({0,0,0}, {1,1,1}, 100, 1, 1, 1.5))\n"
        "for name, parts in pairs{a = {{-1, 2}}, b = {{-1, .7}, {-.3, 1.3}}} do\n"
        "  local r = gr.node('r')\n"
        "  r:add_child(gr.plane{normal = {0,1,0}, material = gr.material({1,1,1}, {0,0,0}, 1)})\n"
        "  for _, p in ipairs(parts) do\n"
        "    r:add_child(gr.cube{material = g, corner = {p[1],.5,-1}, size = {p[2],1,2}}) end\n"
        "  gr.render{node = r, file = name .. '.pfm', width = 8, height = 8, eye = {0,.4,6}, target = {0,0,0}, fov = "
        "24,\n"
        "    background = {0,0,0}, lights = {gr.light({.4,6,.3}, {40,40,40}, {0,0,1})}, caustics = 20000}\nend\n";
    double one[3], two[3];
    run(scene);
    means_of("a", one);
    means_of("b", two);
    CHECK(one[0] > 0.05);
    CHECK_NEAR(two[0] / one[0], 1, 0.01);
}

TEST(a_flat_surface_that_another_one_hides_is_named_with_how_far_to_move_it) {
    static const char scene[] =
        "local r = gr.node('r')\n"
        "local m = gr.material{kd = {1,1,1}, lit = false}\n"
        "r:add_child(gr.cube{name = 'crate', material = m, corner = {-1,-1,-1}, size = 2})\n"
        "r:add_child(gr.%s)\n"
        "r:rotate('x', 15):rotate('y', 30)\n"
        "gr.render{node = r, file = 'x.png', width = 8, height = 8, eye = {0,0,8}, fov = 30, lights = {}}\n";
    static const struct {
        const char *node;
        bool hidden;
    } rows[] = {
        {"rectangle{name = 'decal', material = m, corner = {-.6,-.6,1}, along = {1.2,0,0}, up = {0,1.2,0}}", true},
        {"rectangle{name = 'decal', material = m, corner = {-.6,-.6,1.000001}, along = {1.2,0,0}, up = {0,1.2,0}}",
         false},
        {"rectangle{name = 'decal', material = m, corner = {-.6,-.6,1}, along = {2.2,0,0}, up = {0,1.2,0}}", false},
        {"disc{name = 'decal', material = m, centre = {.2,1,.1}, normal = {0,1,0}, radius = .5}", true},
        {"disc{name = 'decal', material = m, centre = {.8,1,.1}, normal = {0,1,0}, radius = .5}", false},
        {"mesh{name = 'decal', material = m, verts = {{-1,-1,1},{1,-1,1},{1,1,1}}, faces = {{0,1,2}}}", true}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[1024];
        (void)snprintf(text, sizeof text, scene, rows[i].node);
        struct test_result result = test_gray_scene(text, "scene.lua", NULL);
        CHECK_EQ_INT(result.status, 0);
        bool named =
            strstr(result.err, "'decal' lies in a face of 'crate'") && strstr(result.err, "move it out by 1e-06");
        if (named != rows[i].hidden)
            test_fail(__FILE__, __LINE__, "%s: %s", rows[i].node, result.err);
        test_free_result(&result);
    }
}

/* --- a white furnace --- */

/* A stack along z of slabs from z = -k to -k + 1, of four kinds of glass in turn, with a white sky on all sides. */
static const char furnace_frame[] =
    "local smooth = gr.openpbr_material{transmission_weight = 1, specular_roughness = 0, specular_ior = 1.5}\n"
    "local rough = gr.openpbr_material{transmission_weight = 1, specular_roughness = .4, specular_ior = 1.33}\n"
    "local classic = gr.difresnel_material(gr.rr_material({0,0,0}, {1,1,1}, 100, 1, 1, 1.7))\n"
    "local glasses = {smooth, classic, smooth, rough}\n"
    "local r = gr.node('r')\n"
    "local solids = {\n"
    "  box = function(m, z) return gr.cube{material = m, corner = {-1,-1,z}, size = {2,2,1}} end,\n"
    "  mesh = function(m, z)\n"
    "    local v = {} for i = 0, 7 do v[#v + 1] = {i & 1, i >> 1 & 1, z + (i >> 2)} end\n"
    "    return gr.mesh(m, v, {{0,2,3,1},{4,5,7,6},{0,1,5,4},{2,6,7,3},{0,4,6,2},{1,3,7,5}}):translate(-.5,-.5,0) "
    "end,\n"
    "  instance = function(m, z)\n"
    "    return gr.instances{of = gr.cube{material = m, corner = {-3,-3,0}, size = {6,6,3}}:scale(1/3,1/3,1/3), at = "
    "{{0,0,z}}} end,\n"
    "  cylinder = function(m, z) return gr.cylinder{material = m, from = {0,0,z}, to = {0,0,z+1}, radius = 1} end,\n"
    "  csg = function(m, z)\n"
    "    return gr.difference(gr.cube{material = m, corner = {-1,-1,z}, size = {2,2,3}},\n"
    "      gr.cube{material = m, corner = {-2,-2,z+1}, size = 4}) end,\n"
    "  prism = function(m, z)\n"
    "    return gr.prism{material = m, outline = {{-1,-1},{1,-1},{1,1},{-1,1}}, from = 0, to = 1}:rotate('x', "
    "90):translate(0,0,z) end,\n"
    "  implicit = function(m, z)\n"
    "    return gr.implicit{material = m, f = function(p) return math.abs(p.z - (z + .5)) - .5 end,\n"
    "      bounds = {{-1,-1,z-.5}, {1,1,z+1.5}}} end}\n"
    "local kinds, number = {%s}, %d\n"
    "for k = 1, number do r:add_child(solids[kinds[(k - 1) %% #kinds + 1]](glasses[(k - 1) %% 4 + 1], -k)) end\n"
    "r:rotate('y', 30)\n"
    "gr.render{node = r, file = 'x.pfm', width = 16, height = 12, eye = {0,0,9}, fov = 18, background = {1,1,1},\n"
    "  lights = {}, integrator = 'path', spp = %d, max_depth = 200}\n";

/* 1 within .005, or four standard errors of the mean if that is more. */
static void check_furnace(const char *kinds, int number, int samples) {
    char scene[8192];
    int length = snprintf(scene, sizeof scene, furnace_frame, kinds, number, samples);
    CHECK(length > 0 && (size_t)length < sizeof scene);
    run(scene);
    enum { COUNT = 16 * 12 };
    float *pixels = pixels_of("x", 16, 12);
    double sum = 0, squares = 0;
    for (int i = 0; i < COUNT; i++) {
        double value = (double)pixels[3 * i];
        sum += value;
        squares += value * value;
    }
    double mean = sum / COUNT, error = sqrt((squares / COUNT - mean * mean) / COUNT);
    CHECK(error < 0.005);
    if (fabs(mean - 1) > fmax(4 * error, 0.005))
        test_fail(__FILE__, __LINE__, "%d of %s: %.4f +- %.4f", number, kinds, mean, error);
    free(pixels);
}

/* Stacks of one kind, and of different kinds in turn. */
TEST_TIMES(a_stack_of_flush_solids_of_any_kind_in_a_white_furnace_is_white, 16) {
    static const char *const kinds[] = {"'box'",      "'mesh'",
                                        "'instance'", "'csg'",
                                        "'cylinder'", "'prism', 'box', 'mesh', 'csg', 'implicit', 'instance'",
                                        "'prism'",    "'implicit'"};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        check_furnace(kinds[i], 2, 64 * times);
        check_furnace(kinds[i], 8, 200 * times);
    }
}
