/* Meshes of solids: closed, without intersections by a test of their own, within the tolerance in both directions. A
 * table of solids in Lua, all shapes at random, and random trees. */
#include "csg/csg_build.h"
#include "export/model_build.h"
#include "export/simplify_internal.h"
#include "export/solid_cast_internal.h"
#include "export/solid_mesh_internal.h"
#include "export/triangles_internal.h"
#include "formats/model.h"
#include "math/elementary.h"
#include "math/frame.h"
#include "mesh/mesh_topology.h"
#include "tests/unit/random_makers.h"
#include "tests/unit/script_host.h"
#include "tests/unit/shape_makers.h"

/* --- makers --- */

static const struct csg *solid_of(struct arena *arena, const struct csg_leaf *leaves, uint32_t count,
                                  const enum csg_operation *operations) {
    struct csg_token program[64];
    struct error error = {0};
    uint32_t length = 0;
    for (uint32_t i = 0; i < count; i++) {
        program[length++] = (struct csg_token){CSG_LEAF, (uint16_t)i};
        if (i > 0)
            program[length++] = (struct csg_token){operations[i - 1], 0};
    }
    const struct csg *csg = csg_build(arena, leaves, count, program, length, &error);
    if (!csg)
        test_fail(__FILE__, __LINE__, "csg_build: %s", error.text);
    return csg;
}

static struct csg_leaf leaf_of(struct shape shape, struct transform map) {
    return (struct csg_leaf){.shape = shape, .csg_from_leaf = map};
}
static struct shape ball(double radius) {
    return (struct shape){.kind = SHAPE_SPHERE, .sphere = {{0, 0, 0}, radius}};
}
static struct shape block(struct vec3 min, struct vec3 max) {
    return (struct shape){.kind = SHAPE_BOX, .box = {min, max}};
}
static struct shape cylinder(struct vec3 from, struct vec3 to, double radius) {
    return (struct shape){.kind = SHAPE_REVOLVED_QUADRIC,
                          .revolved_quadric = revolved_quadric_cylinder(from, to, radius, false)};
}
static struct transform turned(double x, double y, double z) {
    struct transform a = transform_rotate(0, x), b = transform_rotate(1, y), c = transform_rotate(2, z);
    struct transform t = transform_compose(&b, &a);
    return transform_compose(&c, &t);
}

/* --- checks --- */

__extension__ typedef __int128 wide;

/* Coordinates of single precision are multiples of a small number: by integers, signs of volumes are exact. */
struct lattice {
    double scale;
};
static wide along(const struct lattice *lattice, double from, double to) {
    return (wide)(int64_t)(to * lattice->scale) - (int64_t)(from * lattice->scale);
}
static int turn(const struct lattice *lattice, struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 d) {
    wide x[3][3];
    for (int i = 0; i < 3; i++) {
        struct vec3 p = i == 0 ? b : i == 1 ? c : d;
        for (int axis = 0; axis < 3; axis++)
            x[i][axis] = along(lattice, vec3_get(a, axis), vec3_get(p, axis));
    }
    wide volume = x[0][0] * (x[1][1] * x[2][2] - x[1][2] * x[2][1]) -
                  x[0][1] * (x[1][0] * x[2][2] - x[1][2] * x[2][0]) + x[0][2] * (x[1][0] * x[2][1] - x[1][1] * x[2][0]);
    return (volume > 0) - (volume < 0);
}

static bool edge_meets(const struct lattice *lattice, struct vec3 a, struct vec3 b, const struct vec3 t[3]) {
    if (turn(lattice, t[0], t[1], t[2], a) * turn(lattice, t[0], t[1], t[2], b) >= 0)
        return false;
    int x = turn(lattice, a, b, t[0], t[1]), y = turn(lattice, a, b, t[1], t[2]), z = turn(lattice, a, b, t[2], t[0]);
    return x != 0 && x == y && y == z;
}

static bool meet(const struct lattice *lattice, const struct corners *a, const struct corners *b) {
    for (int i = 0; i < 3; i++) {
        int k = (i + 1) % 3;
        bool common = false, other = false;
        for (int n = 0; n < 3; n++) {
            common = common || a->vertex[i] == b->vertex[n] || a->vertex[k] == b->vertex[n];
            other = other || b->vertex[i] == a->vertex[n] || b->vertex[k] == a->vertex[n];
        }
        if ((!common && edge_meets(lattice, a->point[i], a->point[k], b->point)) ||
            (!other && edge_meets(lattice, b->point[i], b->point[k], a->point)))
            return true;
    }
    return false;
}

static int by_low_x(const void *one, const void *other) {
    double x = ((const struct box *)one)->min.x, y = ((const struct box *)other)->min.x;
    return (x > y) - (x < y);
}

struct swept {
    struct box box; /* the first member, for by_low_x */
    struct corners corners;
};

/* Pairs of triangles that intersect, by a sweep along x. */
static uint32_t intersections(const struct solid_mesh *mesh) {
    uint32_t count = (uint32_t)mesh->triangles.count, found = 0;
    struct swept *all = malloc(count * sizeof *all);
    double extent = 0;
    for (uint32_t i = 0; i < count; i++) {
        all[i].corners = corners_of(mesh, i);
        all[i].box = corners_box(&all[i].corners);
        extent = fmax(extent, fmax(vec3_max_abs(all[i].box.min), vec3_max_abs(all[i].box.max)));
    }
    const struct lattice lattice = {ldexp(1, 38 - ilogb(extent))};
    qsort(all, count, sizeof *all, by_low_x);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t k = i + 1; k < count && all[k].box.min.x <= all[i].box.max.x; k++) {
            struct box both = box_meet(all[i].box, all[k].box);
            found += !box_is_empty(&both) && meet(&lattice, &all[i].corners, &all[k].corners);
        }
    }
    free(all);
    return found;
}

static double volume_of(const struct solid_mesh *mesh, double *area) {
    double volume = 0;
    *area = 0;
    for (uint32_t i = 0; i < mesh->triangles.count; i++) {
        struct corners c = corners_of(mesh, i);
        volume += vec3_dot(c.point[0], vec3_cross(c.point[1], c.point[2])) / 6;
        *area += vec3_length(triangle_normal(c.point)) / 2;
    }
    return volume;
}

/* Vertices - edges + faces. */
static int euler_of(const struct solid_mesh *mesh) {
    return (int)mesh->vertices.count - (int)mesh->triangles.count / 2;
}

struct check {
    const char *what;
    const struct csg *csg;
    const struct solid_mesh *mesh;
    struct solid_probe probe;
    struct box_tree tree;
    struct pool *pool;
    struct vec3 middle;
    double radius; /* of a ball around the solid */
    struct test_random random;
};

static struct vec3 random_direction(struct check *check) {
    return vec3_normalize(random_vec3(&check->random, 1));
}

/* So many points of the solid, on random lines: those further than the distance from the mesh. */
static uint32_t far_of_solid(struct check *check, uint32_t points, double distance) {
    uint32_t far = 0;
    for (uint32_t found = 0, line = 0; found < points && line < 20 * points; line++) {
        solid_cast(&check->probe, vec3_add(check->middle, random_vec3(&check->random, check->radius)),
                   random_direction(check));
        for (uint32_t k = 0; k < check->probe.count; k++, found++)
            far += !mesh_is_near(check->mesh, &check->tree, check->probe.found[k].point, distance);
    }
    return far;
}

/* The same of the mesh, every other one evenly over the area, and of those that are not proved to be near. */
static uint32_t far_of_mesh(struct check *check, uint32_t points, double distance) {
    uint32_t count = (uint32_t)check->mesh->triangles.count, far = 0;
    double *areas = malloc((count + 1) * sizeof *areas);
    areas[0] = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct corners c = corners_of(check->mesh, i);
        areas[i + 1] = areas[i] + vec3_length(triangle_normal(c.point));
    }
    for (uint32_t i = 0; i < points; i++) {
        uint32_t low = (uint32_t)test_uniform(&check->random, 0, count), high = count;
        double at = test_uniform(&check->random, 0, areas[count]);
        for (low = i % 2 ? low : 0, high = i % 2 ? low + 1 : count; high - low > 1;) {
            uint32_t half = (low + high) / 2;
            if (areas[half] <= at)
                low = half;
            else
                high = half;
        }
        struct corners c = corners_of(check->mesh, low);
        double u = sqrt(test_uniform(&check->random, 0, 1)), v = test_uniform(&check->random, 0, 1);
        struct vec3 point = vec3_add_scaled(vec3_scale(c.point[0], 1 - u), c.point[1], u * (1 - v));
        point = vec3_add_scaled(point, c.point[2], u * v);
        far += !solid_is_near_for_sure(&check->probe, point, vec3_normalize(triangle_normal(c.point)), distance);
    }
    free(areas);
    return far;
}

static void check_begin(struct check *check, const char *what, const struct csg *csg, const struct solid_mesh *mesh) {
    char warning[256];
    struct error error = {0};
    *check = (struct check){.what = what,
                            .csg = csg,
                            .mesh = mesh,
                            .pool = pool_create(2, warning),
                            .random = {1},
                            .middle = vec3_scale(vec3_add(csg->bounds.min, csg->bounds.max), 0.5)};
    check->radius = vec3_length(vec3_sub(csg->bounds.max, check->middle));
    CHECK(solid_probe_init(&check->probe, csg) && triangle_tree_build(&check->tree, mesh, check->pool, &error));
}

static void check_end(struct check *check) {
    solid_probe_destroy(&check->probe);
    box_tree_destroy(&check->tree);
    pool_destroy(check->pool);
}

/* Vertices at the place of another one: a reader of the file takes them as one. */
static uint32_t twins(const struct solid_mesh *mesh) {
    uint32_t count = (uint32_t)mesh->vertices.count, found = 0, *same = malloc(count * sizeof *same);
    double(*positions)[3] = malloc(count * sizeof *positions);
    for (uint32_t i = 0; i < 3 * count; i++)
        positions[i / 3][i % 3] = vec3_get(solid_vertex_at(mesh, i / 3)->point, (int)(i % 3));
    CHECK(mesh_weld((const double(*)[3])positions, count, same));
    for (uint32_t i = 0; i < count; i++)
        found += same[i] != i;
    free(positions);
    free(same);
    return found;
}

/* What every mesh must be; `points` are tested in each direction, and so many of the solid may be in details that no
 * line of the grid meets. */
static void check_mesh(struct check *check, double tolerance, uint32_t points, uint32_t lost) {
    bool closed = false;
    struct error error = {0};
    CHECK(solid_mesh_is_closed(check->mesh, &closed, &error));
    if (!closed || twins(check->mesh) > 0)
        test_fail(__FILE__, __LINE__, "%s: the mesh is open, or vertices are at one place", check->what);
    uint32_t found = intersections(check->mesh);
    if (found > 0)
        test_fail(__FILE__, __LINE__, "%s: %u pairs of triangles intersect", check->what, found);
    uint32_t of_solid = far_of_solid(check, points, tolerance), of_mesh = far_of_mesh(check, points, tolerance);
    if (of_solid > lost || of_mesh > 0)
        test_fail(__FILE__, __LINE__, "%s: %u points of the solid and %u of the mesh of %u are too far", check->what,
                  of_solid, of_mesh, points);
}

/* The same for the mesh of a solid. False: there is none, and *error says why. */
static bool check_solid(const char *what, const struct csg *csg, double tolerance, uint32_t points,
                        struct solid_mesh *mesh, struct error *error) {
    char warning[256];
    struct pool *pool = pool_create(2, warning);
    const struct solid_input input = {.csg = csg, .name = what, .tolerance = tolerance, .pool = pool};
    struct solid_findings findings;
    struct check check;
    bool ok = solid_mesh_build(&input, mesh, &findings, error);
    pool_destroy(pool);
    if (!ok)
        return false;
    check_begin(&check, what, csg, mesh);
    check_mesh(&check, tolerance, points, points / 1000);
    check_end(&check);
    return true;
}

/* --- the table of solids --- */

#define ANY (-1000) /* an Euler characteristic that is not known */

struct solid_row {
    const char *name, *lua;
    double volume, area; /* in closed form, or NAN */
    int euler;
    double steps;  /* the size is so many tolerances; 0: 1000 */
    double fewest; /* triangles with vertices on the surface; 0: not known */
    bool flat;     /* all faces are planes, and no parts touch */
};

static const char prelude[] =
    "local function box(x, y, z, X, Y, Z) return gr.box{min = {x, y, z}, max = {X, Y, Z}} end\n"
    "local function rod(x, y, z, X, Y, Z, r) return gr.cylinder{from = {x, y, z}, to = {X, Y, Z}, radius = r} end\n"
    "local function ball(x, y, z, r) return gr.sphere{centre = {x, y, z}, radius = r} end\n"
    "local function turn(node) return node:rotate('x', 20):rotate('y', 30):rotate('z', 50) end\n"
    "local function field(f, r) return gr.implicit{f = f, bounds = {{-r, -r, -r}, {r, r, r}}} end\n"
    "local union, minus, both = gr.union, gr.difference, gr.intersection\n"
    "local sin, cos, abs, sqrt, max, min = math.sin, math.cos, math.abs, math.sqrt, math.max, math.min\n"
    "local function each(n, f, list) list = list or {} for i = 1, n do list[#list + 1] = f(i) end return list end\n"
    "local function star(r) return each(14, function(i) local a, q = i * math.pi / 7, i % 2 == 1 and r or 1\n"
    "    return {q * cos(a), q * sin(a)} end) end\n"
    "local function cell(f) return function(p) local q = p * 6 return f(q.x, q.y, q.z) end end\n"
    "local text = require 'text'\n";

/* The fewest triangles: of a ball 4.84 R / tolerance, of a cylinder those of regular polygons with sides at the
 * tolerance from the circle. */
static const struct solid_row rows[] = {
    /* shapes */
    {"cube", "turn(box(-.5, -.5, -.5, .5, .5, .5))", 1, 6, 2, 0, 12, true},
    {"slab of 3 tolerances", "turn(box(-1, -.7, -.003, 1, .7, .003))", 2 * 1.4 * .006, 5.6, 2, 0, 12, true},
    {"ball", "ball(0, 0, 0, 1)", 4 * M_PI / 3, 4 * M_PI, 2, 0, 2420, false},
    {"ellipsoid", "turn(gr.ellipsoid{radii = {1, .6, .3}})", 4 * M_PI / 3 * .18, NAN, 2, 0, 0, false},
    {"cylinder", "turn(rod(0, -.5, 0, 0, .5, 0, .5))", M_PI / 4, 1.5 * M_PI, 2, 0, 184, false},
    {"cone", "turn(gr.cone{from = {0, .6, 0}, to = {0, -.6, 0}, radius = .5})", M_PI * .1, NAN, 2, 0, 0, false},
    {"frustum", "turn(gr.cone{to = {0, 1, 0}, from_radius = .5, radius = .2})", M_PI * .13, NAN, 2, 0, 0, false},
    {"needle", "turn(gr.cone{from = {0, .9, 0}, to = {0, -.9, 0}, radius = .12})", M_PI * .00864, NAN, 2, 0, 0, false},
    {"paraboloid", "turn(gr.paraboloid{radius = .7, height = 1})", M_PI * .245, NAN, 2, 0, 0, false},
    {"hyperboloid", "turn(gr.hyperboloid{radius = .8, height = 1, waist = .4})", NAN, NAN, 2, 0, 0, false},
    {"two bowls", "turn(gr.hyperboloid{sheets = 2, radius = 1, height = 1, gap = .4})", NAN, NAN, 4, 0, 0, false},
    {"quadric", "gr.quadric{xx = 1, yy = 2, zz = 3, xy = .5, xz = .3, x = .2, constant = -1}", NAN, NAN, 2, 0, 0,
     false},
    {"saddle", "gr.quadric{xx = 1, zz = -1, y = -1, min = {-1, -1, -1}, max = {1, 1.5, 1}}", NAN, NAN, 2, 0, 0, false},
    {"torus", "turn(gr.torus{major = .7, minor = .25})", 2 * M_PI *M_PI * .04375, 4 * M_PI *M_PI * .175, 0, 0, 0,
     false},
    {"thin ring", "turn(gr.torus{major = 1, minor = .03})", 2 * M_PI *M_PI * .0009, 4 * M_PI *M_PI * .03, 0, 0, 0,
     false},
    {"round cube", "turn(gr.superellipsoid{e = .3, n = .2})", NAN, NAN, 2, 0, 0, false},
    {"pillow", "turn(gr.superellipsoid{e = .5, n = 1.5})", NAN, NAN, 2, 500, 0, false},
    {"turned profile",
     "turn(gr.lathe{points = {{0, 0}, {.5, 0}, {.3, .3}, {.6, .8}, {.25, 1.2}, {.3, 1.5}, {0, 1.5}}})", NAN, NAN, 2, 0,
     0, false},
    {"turned spline", "gr.lathe{points = {{0, 0}, {.5, .1}, {.3, .5}, {.4, 1}, {0, 1.2}}, spline = 'catmull-rom'}", NAN,
     NAN, 2, 0, 0, false},
    {"turned ring", "gr.lathe{points = {{.5, 0}, {.8, .1}, {.6, .4}}, loop = true}", NAN, NAN, 0, 0, 0, false},
    {"star", "turn(gr.prism{outline = star(.45), to = .4})", 7 * .45 * .43388373911755812 * .4, NAN, 2, 0, 52, true},
    {"frame",
     "gr.prism{outline = {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, holes = {{{.2, .2}, {.8, .2}, {.8, .8}, {.2, .8}}}, "
     "to = .2}",
     .64 * .2, 2 * .64 + 6.4 * .2, 0, 0, 32, true},
    {"spline prism", "gr.prism{outline = {{0, 0}, {1, .1}, {.8, .8}, {.3, .6}}, spline = 'catmull-rom', to = .4}", NAN,
     NAN, 2, 0, 0, false},
    {"pipe", "gr.sweep{points = {{0, 0, 0}, {.5, .6, 0}, {1, 0, .4}, {1.4, .5, .4}}, radii = .15}", NAN, NAN, 2, 0, 0,
     false},
    {"ring of balls",
     "gr.sweep{points = {{1, 0, 0}, {0, 0, 1}, {-1, .3, 0}, {0, 0, -1}}, radii = {.2, .3, .2, .1}, "
     "loop = true}",
     NAN, NAN, 0, 500, 0, false},
    {"mountains", "gr.height_field{heights = {{0, .3, 0, .1}, {.2, .5, .1, .3}, {.1, 0, .4, 0}}, floor = -.1}", NAN,
     NAN, 2, 0, 0, true},
    {"hills", "gr.height_field{f = function(p) return .1 * sin(9 * p.x) * cos(7 * p.z) end, columns = 90, floor = -.2}",
     NAN, NAN, 2, 500, 0, false},
    {"blob",
     "gr.blob{spheres = {{-.5, 0, 0, .8, 1}, {.4, .2, 0, .7, 1}}, cylinders = {{0, -.6, -.3, 0, .6, .3, .4, 1}}, "
     "threshold = .4}",
     NAN, NAN, ANY, 500, 0, false},
    {"letters", "text.node('B', {size = 1, depth = .2})", NAN, NAN, ANY, 0, 0, false},
    {"tetrahedron",
     "turn(gr.mesh{verts = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, "
     "faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}})",
     1.0 / 6, 1.5 + .86602540378443865, 2, 0, 4, true},
    /* trees */
    {"drilled plate", "minus{box(-1, -.6, -.4, 1, .6, .4), rod(0, 0, -1, 0, 0, 1, .35)}", 1.92 - M_PI * .098,
     9.92 - 2 * M_PI * .1225 + 2 * M_PI * .28, 0, 0, 0, false},
    {"part of 30 operations",
     "(function() local a, b, p = {box(0, 0, 0, 4, 3, .5)}, {}, {{.7, .7}, {3.3, .7}, {.7, 2.3}, {3.3, 2.3}}\n"
     "for _, c in ipairs(p) do local x, y = c[1], c[2] a[#a + 1] = rod(x, y, .25, x, y, 1.1, .3)\n"
     "    a[#a + 1] = minus{rod(x, y, .3, x, y, .62, .42), gr.torus{major = .42, minor = .12}:rotate('x', 90)"
     ":translate(x, y, .62)} end\n"
     "b[1] = union(a) for _, c in ipairs(p) do local x, y = c[1], c[2] b[#b + 1] = rod(x, y, -.2, x, y, 1.3, .15)\n"
     "    b[#b + 1] = rod(x, y, -.2, x, y, .15, .25) end\n"
     "each(8, function(i) local x, y = 2 + .75 * cos(i * math.pi / 4), 1.5 + .75 * sin(i * math.pi / 4)\n"
     "    return rod(x, y, -.2, x, y, .8, .09) end, b)\n"
     "b[#b + 1] = box(1.7, 1.2, .3, 2.3, 1.8, 1.3) b[#b + 1] = box(-.1, 1.35, -.1, .4, 1.65, .9) return minus(b) "
     "end)()",
     NAN, NAN, -22, 4000, 0, false},
    {"two cylinders in common", "both{rod(-1, 0, 0, 1, 0, 0, .8), rod(0, -1, 0, 0, 1, 0, .8)}", 16 * .512 / 3, 16 * .64,
     2, 0, 0, false},
    {"two cylinders crossing", "union{rod(-1, 0, 0, 1, 0, 0, .4), rod(0, -1, 0, 0, 1, 0, .4)}",
     4 * M_PI * .16 - 16 * .064 / 3, NAN, 2, 0, 0, false},
    {"shell of 3 tolerances", "minus{ball(0, 0, 0, 1), ball(0, 0, 0, .988)}", 4 * M_PI / 3 * (1 - .988 * .988 * .988),
     4 * M_PI *(1 + .988 * .988), 4, 500, 0, false},
    {"half a shell", "minus{ball(0, 0, 0, 1), ball(0, 0, 0, .988), box(-2, -2, .1, 2, 2, 2):rotate('x', 20)}", NAN, NAN,
     2, 500, 0, false},
    {"stadium",
     "union{box(-.6, -.4, -.3, .6, .4, .3), rod(-.6, 0, -.3, -.6, 0, .3, .4), rod(.6, 0, -.3, .6, 0, .3, .4)}",
     .6 * (.96 + M_PI * .16), 2 * (.96 + M_PI * .16) + .6 * (2.4 + M_PI * .8), 2, 0, 0, false},
    {"cylinders that touch", "union{rod(-.4, 0, -.7, -.4, 0, .7, .4), rod(.4, 0, -.7, .4, 0, .7, .4)}",
     2 * M_PI * .16 * 1.4, NAN, ANY, 0, 0, false},
    {"cubes that touch in an edge", "turn(union{box(-.8, -.8, -.5, 0, 0, .5), box(0, 0, -.5, .8, .8, .5)})", 1.28,
     4 * .64 + 8 * .8, 4, 0, 24, false},
    {"cubes that touch in a point", "union{box(-.8, -.8, -.8, 0, 0, 0), box(0, 0, 0, .8, .8, .8)}", 1.024, 12 * .64, 4,
     0, 24, false},
    {"plate of 60 holes",
     "minus(each(60, function(i) local x, y = -.9 + .25 * (i % 8), -.9 + .25 * (i // 8)\n"
     "return rod(x, y, -1, x, y, 1, .004 * 1.055 ^ i) end, {box(-1, -1, -.1, 1, 1, .1)}))",
     NAN, NAN, 2 - 120, 0, 0, false},
    {"engraved plate",
     "minus{box(-.2, -.4, -.3, 2.1, 1.1, 0), text.node('Gr3', {size = 1, depth = .3}):translate(0, 0, "
     "-.1)}",
     NAN, NAN, ANY, 0, 0, false},
    {"die",
     "minus{both{box(-1, -1, -1, 1, 1, 1), ball(0, 0, 0, 1.4)}, ball(0, 0, 1.1, .3), ball(1.1, .5, .5, .25), "
     "ball(1.1, -.5, -.5, .25), ball(.5, 1.1, .5, .25), ball(0, 1.1, 0, .25), ball(-.5, 1.1, -.5, .25)}",
     NAN, NAN, 2, 0, 0, false},
    {"lens", "both{ball(0, 0, -.8, 1), ball(0, 0, .8, 1)}", 2 * M_PI * .04 * (3 - .2) / 3, 4 * M_PI * .2, 2, 0, 0,
     false},
    {"elbow",
     "both{minus{gr.torus{major = .7, minor = .25}, gr.torus{major = .7, minor = .2}}, box(0, -1, 0, 1, 1, 1)}",
     .5 * M_PI *M_PI * .7 * .0225, NAN, 0, 0, 0, false},
    {"hollow cube", "minus{box(-1, -1, -1, 1, 1, 1), box(-.8, -.8, -.8, .8, .8, .8)}", 8 - 4.096, 24 + 15.36, 4, 0, 24,
     true},
    {"three beams", "union{box(-1, -.2, -.2, 1, .2, .2), box(-.2, -1, -.2, .2, 1, .2), box(-.2, -.2, -1, .2, .2, 1)}",
     3 * .32 - 2 * .064, 6 * .16 + 24 * .32, 2, 0, 60, true},
    {"frame of a cube",
     "minus{box(-1, -1, -1, 1, 1, 1), box(-2, -.7, -.7, 2, .7, .7), box(-.7, -2, -.7, .7, 2, .7), "
     "box(-.7, -.7, -2, .7, .7, 2)}",
     8 - 3 * 2 * 1.96 + 2 * 2.744, NAN, -8, 0, 144, true},
    {"star and ring", "minus{turn(gr.prism{outline = star(.45), to = .4}), turn(gr.torus{major = .5, minor = .1})}",
     NAN, NAN, ANY, 0, 0, false},
    {"cut mesh",
     "minus{gr.mesh{verts = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, "
     "faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}, ball(0, 0, 0, .5)}",
     1.0 / 6 - M_PI / 6 * .125, NAN, 2, 0, 0, false},
    /* functions */
    {"gyroid in a ball",
     "both{field(cell(function(x, y, z) return abs(sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x)) - .3 end), 1), "
     "ball(0, 0, 0, .95)}",
     NAN, NAN, ANY, 500, 0, false},
    {"primitive surface", "field(cell(function(x, y, z) return cos(x) + cos(y) + cos(z) - .4 end), 1)", NAN, NAN, ANY,
     500, 0, false},
    {"power of four", "field(function(p) return p.x ^ 4 + p.y ^ 4 + p.z ^ 4 - 1 end, 1.1)", NAN, NAN, 2, 0, 0, false},
    {"ball of a function", "field(function(p) return p.x ^ 2 + p.y ^ 2 + p.z ^ 2 - 1 end, 1.1)", 4 * M_PI / 3, 4 * M_PI,
     2, 0, 2420, false},
    {"torus of a function", "field(function(p) return (sqrt(p.x ^ 2 + p.z ^ 2) - .7) ^ 2 + p.y ^ 2 - .0625 end, 1)",
     2 * M_PI *M_PI * .04375, 4 * M_PI *M_PI * .175, 0, 0, 0, false},
    {"heart",
     "field(function(p) local q = p.x ^ 2 + 2.25 * p.z ^ 2 + p.y ^ 2 - 1\n"
     "return q ^ 3 - p.x ^ 2 * p.y ^ 3 - .1125 * p.z ^ 2 * p.y ^ 3 end, 1.3)",
     NAN, NAN, 2, 500, 0, false},
    {"tangles",
     "field(function(p) local q = p * 2.5 return q.x ^ 4 - 5 * q.x ^ 2 + q.y ^ 4 - 5 * q.y ^ 2 + q.z ^ 4 - 5 * "
     "q.z ^ 2 + 11.8 end, 1)",
     NAN, NAN, ANY, 500, 0, false},
    {"crease of two balls",
     "field(function(p) return max(sqrt(p.x ^ 2 + p.y ^ 2 + (p.z - .5) ^ 2), sqrt(p.x ^ 2 + p.y ^ 2 "
     "+ (p.z + .5) ^ 2)) - 1 end, 1)",
     2 * M_PI * .25 * 2.5 / 3, 2 * M_PI, 2, 500, 0, false},
    {"cut by its bounds", "field(function(p) return p.x ^ 2 + p.y ^ 2 + p.z ^ 2 - .5 end, .6)", NAN, NAN, 2, 0, 0,
     false},
    {"twisted bar",
     "field(function(p) local c, s = cos(2 * p.y), sin(2 * p.y)\n"
     "return max(abs(c * p.x - s * p.z) - .4, abs(s * p.x + c * p.z) - .3) end, 1)",
     .96, NAN, 2, 500, 0, false},
};
enum { ROWS = sizeof rows / sizeof *rows };

/* The exact solid at a place of the picture of it and of the mesh that a file has; the pictures only differ where the
 * outline of the solid is near. Each line is a pixel of another picture, from all sides: more than the pixels of one
 * camera, and without the half pixel that those may be off. */
static void check_outline(struct check *check, const struct csg *read, double tolerance, int lines) {
    struct solid_probe mesh;
    uint32_t wrong = 0;
    CHECK(solid_probe_init(&mesh, read));
    for (int i = 0; i < lines; i++) {
        struct vec3 direction = random_direction(check), u, v;
        struct vec3 origin = vec3_add(check->middle, random_vec3(&check->random, check->radius));
        solid_cast(&check->probe, origin, direction);
        solid_cast(&mesh, origin, direction);
        bool hit = check->probe.count > 0, near = hit == (mesh.count > 0);
        frame_tangents(direction, &u, &v);
        for (int k = 0; k < 64 && !near; k++) {
            double sine, cosine, distance = k < 32 ? tolerance : 0.5 * tolerance;
            el_sincos(PI * k / 16, &sine, &cosine);
            solid_cast(&check->probe,
                       vec3_add_scaled(vec3_add_scaled(origin, u, distance * cosine), v, distance * sine), direction);
            near = (check->probe.count > 0) != hit;
        }
        wrong += !near;
    }
    /* Some lines go through the gap between parts that touch. */
    if (wrong > (strstr(check->what, "touch") ? (uint32_t)lines / 10000 : 0))
        test_fail(__FILE__, __LINE__, "%s: %u of %d places are not as in the picture of the file", check->what, wrong,
                  lines);
    solid_probe_destroy(&mesh);
}

/* Writes the model, reads it again, and compares outlines. */
static void check_file(struct check *check, const struct export_model *model, int lines) {
    const struct model_write_options options = {.format = model_format_written("a.stl")};
    struct model_files files = {0};
    struct error error = {0};
    struct arena arena = {0};
    struct model read = {0};
    struct model_options standard = {0};
    CHECK(model_write(model, &options, &files, &error));
    FILE *file = fopen(test_path("a.stl"), "wb");
    CHECK(file && fwrite(files.model.items, 1, files.model.count, file) == files.model.count && fclose(file) == 0);
    model_files_destroy(&files);
    if (!model_read(&read, test_path("a.stl"), &standard, &error) ||
        !mesh_build_accel(model_meshes(&read)[0].mesh, ACCEL_GRID, check->pool, &error)) {
        test_fail(__FILE__, __LINE__, "%s: %s", check->what, error.text);
        return;
    }
    const struct csg_leaf leaf =
        leaf_of((struct shape){.kind = SHAPE_MESH, .mesh = model_meshes(&read)[0].mesh}, transform_identity());
    check_outline(check, solid_of(&arena, &leaf, 1, NULL), model->tolerance, lines);
    arena_destroy(&arena);
    model_destroy(&read);
}

static void check_numbers(struct check *check, const struct solid_row *row, double tolerance) {
    double area, volume = volume_of(check->mesh, &area),
                 size = vec3_max_abs(vec3_sub(check->csg->bounds.max, check->csg->bounds.min));
    if (fabs(volume - row->volume) > tolerance * area)
        test_fail(__FILE__, __LINE__, "%s: the volume is %g, not %g", row->name, volume, row->volume);
    if (fabs(area - row->area) > 0.01 * row->area)
        test_fail(__FILE__, __LINE__, "%s: the area is %g, not %g", row->name, area, row->area);
    if (row->euler != ANY && euler_of(check->mesh) != row->euler)
        test_fail(__FILE__, __LINE__, "%s: the Euler characteristic is %d, not %d", row->name, euler_of(check->mesh),
                  row->euler);
    double fewest = row->fewest, limit = row->flat ? 3 : 2.5, count = (double)check->mesh->triangles.count;
    if (fewest > 0 && count > limit * fewest)
        test_fail(__FILE__, __LINE__, "%s: %g triangles, more than %g times %g", row->name, count, limit, fewest);
    if (row->flat && (far_of_solid(check, 1000, 1e-6 * size) > 0 || far_of_mesh(check, 1000, 1e-6 * size) > 0))
        test_fail(__FILE__, __LINE__, "%s: its faces and edges are not exact", row->name);
}

struct solid_test {
    struct listener listener; /* the first member, for see_solid */
    const struct solid_row *row;
    uint32_t points;
};

static void see_solid(struct listener *listener, const struct render_request *request) {
    const struct solid_test *test = (const struct solid_test *)listener;
    const struct sky sky = {.kind = SKY_CONSTANT};
    const struct world_input world_input = {
        .scene = request->scene, .root = request->root, .sky = &sky, .accel = ACCEL_GRID};
    char warning[256];
    struct pool *pool = pool_create(2, warning);
    struct arena arena = {0};
    struct error error = {0};
    struct world world;
    struct export_model model;
    CHECK(world_build(&world, &world_input, &arena, pool, &error));
    struct box box = world.boxes[0];
    double size = vec3_max_abs(vec3_sub(box.max, box.min)), steps = test->row->steps > 0 ? test->row->steps : 1000;
    const struct model_build_input input = {
        .world = &world, .name = test->row->name, .tolerance = size / steps, .arena = &arena, .pool = pool};
    if (model_build(&input, &model, &error)) {
        const struct export_part *part = export_parts(&model);
        struct solid_mesh mesh = {0};
        struct check check;
        for (size_t i = 0; i < part->points.count; i++)
            *(struct solid_vertex *)list_room(&mesh.vertices, 1, sizeof(struct solid_vertex)) =
                (struct solid_vertex){.point = ((struct vec3 *)part->points.items)[i]},
                                                                               mesh.vertices.count++;
        for (size_t i = 0; i < part->triangles.count; i++) {
            const uint32_t *v = ((struct export_triangle *)part->triangles.items)[i].vertex;
            *(struct solid_triangle *)list_room(&mesh.triangles, 1, sizeof(struct solid_triangle)) =
                (struct solid_triangle){{v[0], v[1], v[2]}, 0};
            mesh.triangles.count++;
        }
        CHECK_EQ_INT(model.parts.count, 1);
        check_begin(&check, test->row->name, part->csg, &mesh);
        check_mesh(&check, model.tolerance, test->points, 0);
        check_numbers(&check, test->row, model.tolerance);
        check_file(&check, &model, (int)test->points);
        check_end(&check);
        solid_mesh_destroy(&mesh);
        export_model_destroy(&model);
    } else {
        test_fail(__FILE__, __LINE__, "%s: %s", test->row->name, error.text);
    }
    world_destroy(&world);
    arena_destroy(&arena);
    pool_destroy(pool);
}

static void check_row(const struct solid_row *row, uint32_t points) {
    struct solid_test test = {.listener = {.seen = see_solid}, .row = row, .points = points};
    struct error error = {0};
    char script[4096];
    (void)snprintf(script, sizeof script, "%sgr.render{node = %s, file = 'x.png', width = 8}\n", prelude, row->lua);
    if (!listen_to_text(&test.listener, script, NULL, &error))
        test_fail(__FILE__, __LINE__, "%s: %s", row->name, error.text);
}

/* --- tests --- */

TEST(some_solids_become_meshes_with_their_volume_genus_and_outline_and_few_triangles) {
    static const char *const names[] = {"cube",
                                        "ball",
                                        "drilled plate",
                                        "hollow cube",
                                        "cubes that touch in an edge",
                                        "shell of 3 tolerances",
                                        "ball of a function"};
    for (int i = 0; i < ROWS; i++)
        for (size_t k = 0; k < sizeof names / sizeof *names; k++)
            if (strcmp(rows[i].name, names[k]) == 0)
                check_row(&rows[i], 500);
}

TEST_LONG(sixty_solids_become_meshes_with_their_volume_genus_and_outline_and_few_triangles) {
    CHECK_EQ_INT(ROWS, 60);
    for (int i = 0; i < ROWS; i++)
        check_row(&rows[i], 100000);
}

TEST(sweeps_along_planar_paths_become_closed_meshes) {
    static const struct solid_row planar[] = {
        {"arc", "gr.sweep{points = {{-1, 0, 0}, {0, 1, 0}, {1, 0, 0}}, radii = .2}", NAN, NAN, 2, 300, 0, false},
        {"turned arc", "turn(gr.sweep{points = {{0, 1, 0}, {0, 0, -1}, {0, -1, 0}}, radii = .2})", NAN, NAN, 2, 300, 0,
         false},
        {"ring",
         "gr.sweep{points = each(8, function(i) return {cos(i * math.pi / 4), 0, sin(i * math.pi / 4)} end), radii = "
         ".25, loop = true}",
         NAN, NAN, 0, 300, 0, false},
    };
    for (size_t i = 0; i < sizeof planar / sizeof *planar; i++)
        check_row(&planar[i], 500);
}

TEST(solids_that_touch_in_an_edge_are_separated_there) {
    struct arena arena = {0};
    const struct csg_leaf leaves[2] = {
        leaf_of(block(vec3_make(-0.8, -0.8, -0.5), vec3_make(0, 0, 0.5)), transform_identity()),
        leaf_of(block(vec3_make(0, 0, -0.5), vec3_make(0.8, 0.8, 0.5)), transform_identity())};
    const enum csg_operation plus = CSG_UNION;
    char warning[256];
    struct pool *pool = pool_create(1, warning);
    const struct solid_input input = {
        .csg = solid_of(&arena, leaves, 2, &plus), .name = "cubes", .tolerance = 5e-3, .pool = pool};
    struct solid_mesh mesh;
    struct solid_findings findings;
    struct error error = {0};
    CHECK(solid_mesh_build(&input, &mesh, &findings, &error));
    CHECK(findings.separated > 0);
    CHECK_NEAR(findings.position.x, 0, 1e-2);
    CHECK_NEAR(findings.position.y, 0, 1e-2);
    solid_mesh_destroy(&mesh);
    pool_destroy(pool);
    arena_destroy(&arena);
}

/* An octahedron whose top is two vertices at one place, with two triangles between them. */
TEST(vertices_at_one_position_are_joined_although_they_are_kept) {
    static const double at[7][3] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 1}};
    static const uint32_t faces[10][3] = {{0, 1, 2}, {0, 4, 1}, {0, 2, 6}, {0, 6, 4}, {6, 2, 3},
                                          {6, 3, 4}, {5, 2, 1}, {5, 3, 2}, {5, 4, 3}, {5, 1, 4}};
    const uint8_t keep[7] = {KEEP_VERTEX, KEEP_VERTEX, KEEP_VERTEX, KEEP_VERTEX, KEEP_VERTEX, KEEP_VERTEX, KEEP_VERTEX};
    const struct simplify_input input = {.tolerance = 1e-2, .size = 2, .resolution = 1e-6, .keep = keep};
    struct solid_mesh mesh = {0};
    struct error error = {0};
    bool closed = false;
    for (int i = 0; i < 7; i++) {
        const struct solid_vertex vertex = {.point = {at[i][0], at[i][1], at[i][2]}};
        CHECK(list_add(&mesh.vertices, &vertex, 1, sizeof vertex));
    }
    for (uint32_t i = 0; i < 10; i++) {
        const struct solid_triangle triangle = {{faces[i][0], faces[i][1], faces[i][2]}, i};
        CHECK(list_add(&mesh.triangles, &triangle, 1, sizeof triangle));
    }
    CHECK(solid_mesh_is_closed(&mesh, &closed, &error) && closed);
    CHECK(simplify_mesh(&mesh, &input));
    CHECK(mesh.vertices.count == 6 && mesh.triangles.count == 8 && twins(&mesh) == 0);
    CHECK(solid_mesh_is_closed(&mesh, &closed, &error) && closed);
    solid_mesh_destroy(&mesh);
}

TEST(an_empty_solid_is_an_error) {
    struct arena arena = {0};
    const struct csg_leaf leaves[2] = {leaf_of(ball(1), transform_identity()), leaf_of(ball(2), transform_identity())};
    const enum csg_operation minus = CSG_DIFFERENCE;
    struct solid_mesh mesh = {0};
    struct error error = {0};
    CHECK(!check_solid("nothing", solid_of(&arena, leaves, 2, &minus), 1e-2, 10, &mesh, &error));
    CHECK_TEXT(error.text, "node 'nothing' is empty: there is nothing to write");
    arena_destroy(&arena);
}

TEST_TIMES(every_closed_shape_becomes_a_closed_mesh_within_the_tolerance, 12) {
    struct test_random random = {38};
    for (int kind = 0; kind < SHAPE_KIND_COUNT; kind++) {
        struct shape_makers makers = {0};
        for (int made = 0, tries = 0; made < times && tries < 40 * times; tries++) {
            struct made_shape shape = make_shape(&makers, (enum shape_kind)kind, &random);
            struct box bounds = shape_bounds(&shape.shape);
            if (!shape_is_closed(&shape.shape) || !vec3_finite(bounds.min) || !vec3_finite(bounds.max))
                continue;
            const struct csg_leaf leaf = leaf_of(shape.shape, turned(20, 30, 50));
            const struct csg *csg = solid_of(&makers.arena, &leaf, 1, NULL);
            double tolerance = vec3_max_abs(vec3_sub(csg->bounds.max, csg->bounds.min)) / (times > 1 ? 400 : 100), area;
            struct solid_mesh mesh = {0};
            struct error error = {0};
            made++;
            const char *name = shape_kind_name((enum shape_kind)kind);
            if (!check_solid(name, csg, tolerance, times > 1 ? 20000 : 500, &mesh, &error)) {
                test_fail(__FILE__, __LINE__, "%s: %s", name, error.text);
                continue;
            }
            double volume = volume_of(&mesh, &area);
            if (isfinite(shape.volume) && fabs(volume - shape.volume) > tolerance * area)
                test_fail(__FILE__, __LINE__, "%s: the volume is %g, not %g", name, volume, shape.volume);
            solid_mesh_destroy(&mesh);
        }
        shape_makers_destroy(&makers);
    }
}

static struct csg_leaf random_leaf(struct test_random *random, bool first) {
    double size = test_uniform(random, 0.25, 0.7), spread = first ? 0.1 : 0.7, kind = test_uniform(random, 0, 1);
    struct vec3 up = {0, size, 0};
    struct shape shape = ball(size);
    if (kind < 0.3)
        shape = block(vec3_make(-size, -size * test_uniform(random, 0.3, 1.3), -size * test_uniform(random, 0.3, 1.3)),
                      vec3_make(size, 0.7 * size, 0.6 * size));
    else if (kind < 0.5)
        shape = cylinder(vec3_negate(up), up, test_uniform(random, 0.1, 0.4));
    else if (kind < 0.65)
        shape = (struct shape){.kind = SHAPE_TORUS, .torus = {size, test_uniform(random, 0.08, 0.23)}};
    else if (kind < 0.8)
        shape = (struct shape){.kind = SHAPE_REVOLVED_QUADRIC,
                               .revolved_quadric = revolved_quadric_frustum(
                                   vec3_negate(up), test_uniform(random, 0.1, 0.55), up,
                                   test_uniform(random, 0, 1) < 0.5 ? 0 : test_uniform(random, 0, 0.2), false)};
    bool straight = test_uniform(random, 0, 1) < 0.4;
    struct transform turn_of =
        straight ? turned(90 * floor(test_uniform(random, 0, 2)), 90 * floor(test_uniform(random, 0, 2)), 0)
                 : turned(test_uniform(random, 0, 360), test_uniform(random, 0, 360), 0);
    struct transform move = transform_translate(random_vec3(random, spread));
    return leaf_of(shape, transform_compose(&move, &turn_of));
}

TEST_TIMES(random_solids_become_closed_meshes_without_intersections, 200) {
    int errors = 0;
    for (int tree = 0; tree < 5 * times; tree++) {
        struct arena arena = {0};
        struct test_random random = {(uint64_t)tree + 1000};
        struct csg_leaf leaves[14];
        enum csg_operation operations[14];
        uint32_t count = (uint32_t)test_uniform(&random, 3, 15);
        for (uint32_t i = 0; i < count; i++) {
            double operation = test_uniform(&random, 0, 1);
            leaves[i] = random_leaf(&random, i == 0);
            operations[i] = operation < 0.5 ? CSG_UNION : operation < 0.9 ? CSG_DIFFERENCE : CSG_INTERSECTION;
        }
        const struct csg *csg = solid_of(&arena, leaves, count, operations);
        struct solid_mesh mesh = {0};
        struct error error = {0};
        char name[32];
        (void)snprintf(name, sizeof name, "tree %d", tree);
        if (!check_solid(name, csg, times > 1 ? 3e-3 : 1e-2, times > 1 ? 10000 : 500, &mesh, &error) &&
            !strstr(error.text, "is empty"))
            errors++;
        solid_mesh_destroy(&mesh);
        arena_destroy(&arena);
    }
    if (errors > times * 5 / 1000)
        test_fail(__FILE__, __LINE__, "%d of %d trees have no mesh", errors, 5 * times);
}
