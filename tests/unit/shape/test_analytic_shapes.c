/* Quadrics, torus, superellipsoid, flat shapes: crossings lie on the surface and none is missed, normals are gradients,
 * boxes are tight, image coordinates move as their derivatives say, CSG agrees with point tests. The implicit functions
 * here are independent of the sources, in long double. */
#include "csg/csg.h"
#include "csg/csg_build.h"
#include "shape/planar.h"
#include "shape/revolved_quadric.h"
#include "shape/shape.h"
#include "tests/harness.h"
#include "tests/unit/csg_crossings.h"
#include "tests/unit/random_makers.h"

#include <math.h>
#include <string.h>

enum form {
    CYLINDER,
    OPEN_CYLINDER,
    CONE,
    FRUSTUM,
    OPEN_FRUSTUM,
    PARABOLOID,
    ONE_SHEET,
    TWO_SHEETS,
    OPEN_TWO_SHEETS,
    OBLIQUE_CYLINDER,
    ELLIPSOID,
    QUADRIC_BALL,
    QUADRIC_SADDLE,
    QUADRIC_OPEN,
    QUADRIC_ENDLESS,
    TORUS,
    THIN_TORUS,
    SPINDLE_TORUS,
    SUPER_ROUND,
    SUPER_SHARP,
    SUPER_STAR,
    SUPER_MIXED,
    HALF_SPACE,
    SQUARE,
    PARALLELOGRAM,
    DISC,
    ANNULUS,
    TRIANGLE,
    POLYGON,
    FORMS
};

static const char *const form_names[FORMS] = {"cylinder",
                                              "open cylinder",
                                              "cone",
                                              "frustum",
                                              "open frustum",
                                              "paraboloid",
                                              "one sheet",
                                              "two sheets",
                                              "two sheets, open",
                                              "oblique cylinder",
                                              "ellipsoid",
                                              "quadric ball",
                                              "quadric saddle",
                                              "quadric, open",
                                              "quadric without end",
                                              "torus",
                                              "thin torus",
                                              "spindle torus",
                                              "superellipsoid, round",
                                              "superellipsoid, sharp",
                                              "superellipsoid, star",
                                              "superellipsoid, mixed",
                                              "half-space",
                                              "square",
                                              "parallelogram",
                                              "disc",
                                              "annulus",
                                              "triangle",
                                              "polygon"};

static struct transform then(struct transform first, struct transform second) {
    return transform_compose(&second, &first);
}

static struct transform random_transform(struct test_random *random, double margin) {
    struct transform t = transform_identity();
    for (int i = 0; i < 3; i++) {
        struct vec3 logs = random_vec3(random, 0.5), factors = {exp(logs.x), exp(logs.y), exp(logs.z)};
        if (test_uniform(random, 0, 1) < 0.3)
            factors.y = -factors.y;
        t = then(t, transform_scale(factors));
        t = then(t, transform_rotate(i, test_uniform(random, 0, 360)));
    }
    return then(t, transform_translate(random_vec3(random, margin)));
}

/* A star with a hole, and a second outline beside it. */
static const struct vec3 outline_points[] = {
    {1, 0, 0},        {0.3, 0, -0.25},  {0.31, 0, -0.95}, {-0.12, 0, -0.36}, {-0.81, 0, -0.59}, {-0.39, 0, 0},
    {-0.81, 0, 0.59}, {-0.12, 0, 0.36}, {0.31, 0, 0.95},  {0.3, 0, 0.25},    {0.2, 0, 0.1},     {-0.2, 0, 0.15},
    {-0.1, 0, -0.2},  {0.15, 0, -0.1},  {0.7, 0, 0.5},    {0.9, 0, 0.5},     {0.8, 0, 0.8}};
static const uint32_t outline_ends[] = {10, 14, 17};

static struct shape random_shape(enum form form, struct test_random *random, struct arena *arena) {
    struct shape s = {.kind = SHAPE_REVOLVED_QUADRIC};
    double r = exp(test_uniform(random, -0.7, 0.7)), h = exp(test_uniform(random, -0.7, 0.7));
    double q = test_uniform(random, 0.1, 0.9);
    struct vec3 zero = {0, 0, 0};
    switch (form) {
    case CYLINDER:
    case OPEN_CYLINDER:
        s.revolved_quadric =
            revolved_quadric_cylinder(vec3_make(0, -1, 0), vec3_make(0, 1, 0), 1, form == OPEN_CYLINDER);
        break;
    case CONE:
        s.revolved_quadric = revolved_quadric_frustum(zero, 0, vec3_make(0, 1, 0), 1, false);
        break;
    case FRUSTUM:
    case OPEN_FRUSTUM: {
        struct vec3 from = random_vec3(random, 1), to = random_vec3(random, 2);
        s.revolved_quadric = revolved_quadric_frustum(from, r, to, q, form == OPEN_FRUSTUM);
        break;
    }
    case PARABOLOID:
        s.revolved_quadric = revolved_quadric_paraboloid(r, h, false);
        break;
    case ONE_SHEET:
        s.revolved_quadric = revolved_quadric_one_sheet(r * q, r, -h, h * q, false);
        break;
    case TWO_SHEETS:
    case OPEN_TWO_SHEETS:
        s.revolved_quadric = revolved_quadric_two_sheets(h * q, h, r, form == OPEN_TWO_SHEETS);
        break;
    case OBLIQUE_CYLINDER: {
        struct vec3 from = random_vec3(random, 1), to = random_vec3(random, 2);
        s.revolved_quadric = revolved_quadric_cylinder(from, to, q, false);
        break;
    }
    case ELLIPSOID:
        s.kind = SHAPE_ELLIPSOID;
        s.ellipsoid = (struct ellipsoid){random_vec3(random, 1), {r, h, q}};
        break;
    case QUADRIC_BALL:
    case QUADRIC_SADDLE:
    case QUADRIC_OPEN:
    case QUADRIC_ENDLESS: {
        struct quadric *quadric = arena_alloc(arena, sizeof *quadric);
        bool saddle = form != QUADRIC_BALL;
        struct box limits = {{-1, -1.5, -1.25}, {1, 0.75, 1.25}}, all = {vec3_all(-INFINITY), vec3_all(INFINITY)};
        *quadric = (struct quadric){.c = {1, saddle ? -h : 1 + h, saddle ? q : 1.5, 0.3, -0.2, 0.4, 0.2, 0.1, -0.3, -q},
                                    .limits = form == QUADRIC_BALL || form == QUADRIC_ENDLESS ? all : limits,
                                    .open = form == QUADRIC_OPEN};
        s.kind = SHAPE_QUADRIC;
        s.quadric = quadric;
        break;
    }
    case TORUS:
        s.kind = SHAPE_TORUS;
        s.torus = (struct torus){1, q};
        break;
    case THIN_TORUS:
        s.kind = SHAPE_TORUS;
        s.torus = (struct torus){1, 0.001};
        break;
    case SPINDLE_TORUS:
        s.kind = SHAPE_TORUS;
        s.torus = (struct torus){q, 1};
        break;
    case SUPER_ROUND:
        s.kind = SHAPE_SUPERELLIPSOID;
        s.superellipsoid.e = test_uniform(random, 0.3, 2);
        s.superellipsoid.n = test_uniform(random, 0.3, 2);
        break;
    case SUPER_SHARP:
        s.kind = SHAPE_SUPERELLIPSOID;
        s.superellipsoid.e = test_uniform(random, 0.02, 0.3);
        s.superellipsoid.n = test_uniform(random, 0.02, 0.3);
        break;
    case SUPER_STAR:
        s.kind = SHAPE_SUPERELLIPSOID;
        s.superellipsoid.e = test_uniform(random, 2, 4);
        s.superellipsoid.n = test_uniform(random, 2, 4);
        break;
    case SUPER_MIXED:
        s.kind = SHAPE_SUPERELLIPSOID;
        s.superellipsoid = (struct superellipsoid){q * 4, 3 - q * 3 + 0.05};
        break;
    case HALF_SPACE:
        s.kind = SHAPE_PLANAR;
        s.planar = planar_plane(random_vec3(random, 1), q - 0.5);
        break;
    case SQUARE:
        s.kind = SHAPE_PLANAR;
        s.planar = planar_square();
        break;
    case PARALLELOGRAM: {
        struct vec3 corner = random_vec3(random, 1), along = random_vec3(random, 1), up = random_vec3(random, 1);
        s.kind = SHAPE_PLANAR;
        s.planar = planar_parallelogram(corner, along, up);
        break;
    }
    case DISC:
    case ANNULUS: {
        struct vec3 centre = random_vec3(random, 1), normal = random_vec3(random, 1);
        s.kind = SHAPE_PLANAR;
        s.planar = planar_disc(centre, normal, r, form == DISC ? 0 : r * q);
        break;
    }
    case TRIANGLE: {
        struct vec3 a = random_vec3(random, 1), b = random_vec3(random, 1), c = random_vec3(random, 1);
        s.kind = SHAPE_PLANAR;
        s.planar = planar_triangle(a, b, c);
        break;
    }
    case POLYGON: {
        const char *why = NULL;
        s.kind = SHAPE_PLANAR;
        CHECK(planar_polygon(arena, outline_points, outline_ends, 3, &s.planar, &why));
        break;
    }
    case FORMS:
        break;
    }
    return s;
}

static struct ray line_through(struct vec3 origin, struct vec3 target) {
    return (struct ray){.origin = origin, .direction = vec3_sub(target, origin), .t_min = -INFINITY, .t_max = INFINITY};
}

/* A point near the shape, so that many rays meet it. */
static struct vec3 target_at(const struct shape *s, double size, struct test_random *random) {
    struct vec3 p = random_vec3(random, 0.9 * size);
    if (s->kind == SHAPE_TORUS && s->torus.minor < 0.01) {
        double x = p.x / hypot(p.x, p.z), z = p.z / hypot(p.x, p.z);
        return vec3_make(x, test_uniform(random, -1, 1) * s->torus.minor, z);
    }
    if (s->kind == SHAPE_PLANAR && s->planar.kind != PLANAR_PLANE) {
        double min = s->planar.kind == PLANAR_DISC ? -1.1 : -0.1;
        double a = test_uniform(random, min, 1.1), b = test_uniform(random, min, 1.1);
        return vec3_add_scaled(vec3_add_scaled(s->planar.origin, s->planar.u, a), s->planar.v, b);
    }
    return p;
}

/* ---- the surfaces, independently ---- */

struct point {
    long double x, y, z;
};

static struct point point_of(struct vec3 p) {
    return (struct point){p.x, p.y, p.z};
}

static long double dot_of(struct vec3 a, struct point p) {
    return (long double)a.x * p.x + (long double)a.y * p.y + (long double)a.z * p.z;
}

/* Negative inside, of the curved surface (flat: of the plane). */
static long double implicit(const struct shape *s, struct point p) {
    switch ((int)s->kind) { /* the analytic ones */
    case SHAPE_REVOLVED_QUADRIC: {
        const struct revolved_quadric *c = &s->revolved_quadric;
        struct point f = {p.x - c->base.x, p.y - c->base.y, p.z - c->base.z};
        long double h = dot_of(c->axis, f);
        struct point w = {f.x - h * c->axis.x, f.y - h * c->axis.y, f.z - h * c->axis.z};
        return w.x * w.x + w.y * w.y + w.z * w.z - (c->a * h * h + c->b * h + c->c);
    }
    case SHAPE_ELLIPSOID: {
        const struct ellipsoid *e = &s->ellipsoid;
        long double x = (p.x - e->centre.x) / e->radii.x, y = (p.y - e->centre.y) / e->radii.y;
        long double z = (p.z - e->centre.z) / e->radii.z;
        return x * x + y * y + z * z - 1;
    }
    case SHAPE_QUADRIC: {
        const double *c = s->quadric->c;
        return c[0] * p.x * p.x + c[1] * p.y * p.y + c[2] * p.z * p.z + c[3] * p.x * p.y + c[4] * p.x * p.z +
               c[5] * p.y * p.z + c[6] * p.x + c[7] * p.y + c[8] * p.z + c[9];
    }
    case SHAPE_TORUS: {
        long double across = sqrtl(p.x * p.x + p.z * p.z) - s->torus.major;
        return across * across + p.y * p.y - (long double)s->torus.minor * s->torus.minor;
    }
    case SHAPE_SUPERELLIPSOID: {
        long double e = s->superellipsoid.e, n = s->superellipsoid.n;
        long double planar = powl(powl(fabsl(p.x), 2 / e) + powl(fabsl(p.z), 2 / e), e / n);
        return powl(planar + powl(fabsl(p.y), 2 / n), n / 2) - 1;
    }
    case SHAPE_PLANAR: {
        const struct planar *f = &s->planar;
        return dot_of(f->normal, (struct point){p.x - f->origin.x, p.y - f->origin.y, p.z - f->origin.z});
    }
    case SHAPE_SPHERE:
        return p.x * p.x + p.y * p.y + p.z * p.z - 1;
    }
    return 0;
}

static struct point gradient(const struct shape *s, struct point p) {
    const long double h = 0x1p-22L;
    struct point a = p, b = p, g;
    a.x -= h, b.x += h;
    g.x = (implicit(s, b) - implicit(s, a)) / (2 * h);
    a = b = p;
    a.y -= h, b.y += h;
    g.y = (implicit(s, b) - implicit(s, a)) / (2 * h);
    a = b = p;
    a.z -= h, b.z += h;
    g.z = (implicit(s, b) - implicit(s, a)) / (2 * h);
    return g;
}

static double residual(const struct shape *s, struct vec3 p) {
    struct point g = gradient(s, point_of(p));
    long double length = sqrtl(g.x * g.x + g.y * g.y + g.z * g.z);
    long double value = fabsl(implicit(s, point_of(p)));
    return (double)(value == 0 ? 0 : value / length);
}

/* Whether p is inside the surface's limits by at least `room` (outside by as much if `room` is negative). */
static bool within_limits(const struct shape *s, struct vec3 p, double room) {
    if (s->kind == SHAPE_REVOLVED_QUADRIC) {
        double h = vec3_dot(vec3_sub(p, s->revolved_quadric.base), s->revolved_quadric.axis);
        return h > s->revolved_quadric.lo + room && h < s->revolved_quadric.hi - room;
    }
    if (s->kind == SHAPE_QUADRIC) {
        struct box b = s->quadric->limits;
        b.min = vec3_add(b.min, vec3_all(room));
        b.max = vec3_sub(b.max, vec3_all(room));
        return box_contains(&b, p);
    }
    return true;
}

static double size_of(const struct shape *s) {
    struct box b = shape_bounds(s);
    double size = fmax(vec3_max_abs(b.min), vec3_max_abs(b.max));
    return isfinite(size) ? size : 1;
}

static bool is_planar(const struct shape *s) {
    return s->kind == SHAPE_PLANAR && s->planar.kind != PLANAR_PLANE;
}

/* Whether a planar shape contains a point, by other formulas: by distances and areas in space, for a polygon by winding
 * numbers. */
static bool planar_has(const struct shape *s, enum form form, struct vec3 p, double *clearance) {
    const struct planar *f = &s->planar;
    switch ((int)form) { /* the flat ones */
    case DISC:
    case ANNULUS: {
        double far = vec3_length(vec3_sub(p, f->origin)) / vec3_length(f->u);
        *clearance = fmin(fabs(far - 1), form == ANNULUS ? fabs(far - f->inner) : 1);
        return far < 1 && (form == DISC || far > f->inner);
    }
    case SQUARE:
    case PARALLELOGRAM:
    case TRIANGLE: {
        struct vec3 corners[4] = {f->origin, vec3_add(f->origin, f->u), vec3_add(vec3_add(f->origin, f->u), f->v),
                                  vec3_add(f->origin, f->v)};
        int count = form == TRIANGLE ? 3 : 4, left = 0;
        if (form == TRIANGLE)
            corners[2] = corners[3];
        *clearance = INFINITY;
        for (int i = 0; i < count; i++) {
            struct vec3 edge = vec3_sub(corners[(i + 1) % count], corners[i]), route = vec3_sub(p, corners[i]);
            double side = vec3_dot(vec3_cross(edge, route), f->normal) / vec3_length(f->normal);
            left += side > 0;
            *clearance = fmin(*clearance, fabs(side));
        }
        return left == 0 || left == count;
    }
    case POLYGON: {
        int inside = 0;
        uint32_t first = 0;
        *clearance = INFINITY;
        for (int outline = 0; outline < 3; outline++) {
            double turned = 0;
            for (uint32_t i = first; i < outline_ends[outline]; i++) {
                uint32_t k = i + 1 < outline_ends[outline] ? i + 1 : first;
                struct vec3 a = vec3_sub(outline_points[i], p), b = vec3_sub(outline_points[k], p);
                double area = a.z * b.x - a.x * b.z;
                turned += atan2(area, a.x * b.x + a.z * b.z);
                *clearance = fmin(*clearance, fabs(area));
            }
            inside += fabs(turned) > 3;
            first = outline_ends[outline];
        }
        return inside % 2 == 1;
    }
    default:
        return true;
    }
}

/* ---- rays ---- */

struct counts {
    long rays, crossings, off, normals, order, missed, error, errors_checked;
    double worst;
};

static void check_crossing(const struct shape *s, const struct ray *ray, const struct ray *world,
                           const struct transform *map, const struct crossing *c, struct counts *n) {
    double size = size_of(s);
    struct vec3 p = affine_point(&map->inverse, ray_at(world, c->t));
    struct surface surface;
    shape_describe(s, ray, c, &surface);
    bool side = c->part == 0, tip = false;
    if (side) {
        double far = residual(s, p) / size;
        n->worst = fmax(n->worst, far);
        /* A tip has no gradient: there the distance to the tip is taken. */
        struct point g = gradient(s, point_of(p));
        tip = sqrtl(g.x * g.x + g.y * g.y + g.z * g.z) < 1e-3L;
        n->off += !(far < 1e-9) && !tip;
        n->off += !within_limits(s, p, -1e-9 * size);
        long double aligned = dot_of(vec3_normalize(surface.normal), g) / sqrtl(g.x * g.x + g.y * g.y + g.z * g.z);
        /* Where the surface bends sharply, the position itself is not accurate enough. */
        bool bent = s->kind == SHAPE_SUPERELLIPSOID && (fmin(fabs(p.x), fabs(p.z)) < 1e-3 || fabs(p.y) < 1e-3 ||
                                                        s->superellipsoid.e < 0.3 || s->superellipsoid.n < 0.3);
        n->normals += !tip && !bent && !(aligned > 1 - 1e-6L);
    } else {
        n->off +=
            !within_limits(s, p, -1e-9 * size) || within_limits(s, p, 1e-9 * size) || implicit(s, point_of(p)) > 1e-8L;
    }
    struct vec3 world_normal = transform_normal(map, surface.normal);
    double cosine =
        vec3_dot(world_normal, world->direction) / (vec3_length(world_normal) * vec3_length(world->direction));
    n->normals += fabs(cosine) > 1e-5 && (cosine < 0) != c->enter;
    n->off += !(vec3_length(vec3_sub(surface.point, p)) < 1e-6 * size) && !tip;
    if (side && !tip) {
        n->error += !(residual(s, surface.point) <= surface.error) || !(surface.error < 1e-4 * size);
        n->errors_checked++;
    }
    n->crossings++;
}

/* The list of crossings against point tests along the line. */
static void march(const struct shape *s, enum form form, const struct ray *ray, const struct crossing *list,
                  uint32_t count, struct counts *n) {
    if (is_planar(s)) {
        double height = (double)implicit(s, point_of(ray->origin)), climb = vec3_dot(s->planar.normal, ray->direction);
        struct vec3 p = ray_at(ray, -height / climb);
        double clearance = 0;
        bool has = planar_has(s, form, p, &clearance);
        n->missed += clearance > 1e-9 && has != (count == 1);
        return;
    }
    bool closed = shape_is_closed(s);
    enum { STEPS = 60 };
    double size = size_of(s), speed = vec3_length(ray->direction);
    double middle = -vec3_dot(ray->origin, ray->direction) / (speed * speed), margin = 2 * size / speed;
    bool was_negative = false, was_within = false;
    uint32_t passed = 0;
    bool odd_before = false;
    for (int i = 0; i <= STEPS; i++) {
        double t = middle + margin * (2.0 * i / STEPS - 1 + 1e-3);
        while (passed < count && list[passed].t < t)
            passed++;
        struct vec3 p = ray_at(ray, t);
        bool near = (passed > 0 && t - list[passed - 1].t < 1e-7 * margin) ||
                    (passed < count && list[passed].t - t < 1e-7 * margin);
        long double value = implicit(s, point_of(p));
        bool negative = value < 0, within = within_limits(s, p, 0), odd = passed % 2 == 1;
        near = near || fabsl(value) < 1e-9L;
        if (closed) {
            n->missed += !near && odd != (negative && within);
            struct geom_scratch none = {0};
            n->missed += !near && shape_contains(s, p, &none) != (negative && within);
        } else if (i > 0 && within && was_within && !near && s->kind == SHAPE_REVOLVED_QUADRIC) {
            n->missed += (odd != odd_before) != (negative != was_negative); /* the limits are convex */
        }
        was_negative = negative;
        was_within = within && !near;
        odd_before = odd;
    }
}

static void check_form(enum form form, int shapes, int rays, struct counts *n) {
    struct test_random random = {1000 + (uint64_t)form};
    struct arena arena = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    *n = (struct counts){0};
    for (int k = 0; k < shapes; k++) {
        struct shape s = random_shape(form, &random, &arena);
        struct transform map = random_transform(&random, 3);
        double size = size_of(&s);
        for (int i = 0; i < rays; i++) {
            struct vec3 origin = random_vec3(&random, i % 8 ? 20 : 1.5);
            struct vec3 at = target_at(&s, size, &random);
            struct ray world = line_through(origin, affine_point(&map.forward, at));
            struct ray ray = ray_transform(&map.inverse, &world);
            struct crossing_list list;
            CHECK(shape_crossings(&s, &ray, &scratch, &list));
            struct crossing *c = &scratch.items[list.first];
            n->rays++;
            n->order += list.count > shape_scratch_need(&s);
            if (shape_is_closed(&s))
                n->order += list.count % 2;
            for (uint32_t j = 0; j < list.count; j++) {
                n->order += j > 0 && !(c[j].t > c[j - 1].t);
                n->order += shape_is_closed(&s) && c[j].enter != (j % 2 == 0);
                if (isfinite(c[j].t))
                    check_crossing(&s, &ray, &world, &map, &c[j], n);
            }
            if (i % 8 == 0)
                march(&s, form, &ray, c, list.count, n);
            scratch.used = list.first;
        }
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST_TIMES(analytic_shapes_are_crossed_on_their_surface_and_no_crossing_is_missed, 20) {
    for (int form = 0; form < FORMS; form++) {
        struct counts n;
        check_form((enum form)form, 20 * times, form >= SUPER_ROUND && form <= SUPER_MIXED ? 80 : 200, &n);
        if (n.off || n.normals || n.order || n.missed || n.error || n.crossings < 300 * times)
            test_fail(
                __FILE__, __LINE__,
                "%s: %ld crossings on %ld rays; %ld off the surface (worst %g), %ld normals, %ld out of order, %ld "
                "missed, %ld of %ld beyond their error",
                form_names[form], n.crossings, n.rays, n.off, n.worst, n.normals, n.order, n.missed, n.error,
                n.errors_checked);
    }
}

/* Origins and directions from a lattice: along axes, edges, caps, generators, through tips and rims. */
TEST(analytic_shapes_alternate_on_degenerate_lines) {
    struct test_random random = {5};
    struct arena arena = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    const double steps[] = {-1, -0.5, 0, 0.25, 1};
    for (int form = 0; form < FORMS; form++) {
        struct shape s = random_shape((enum form)form, &random, &arena);
        if (s.kind == SHAPE_TORUS && form == TORUS)
            s.torus.minor = 0.25;
        bool closed = shape_is_closed(&s);
        long wrong = 0, order = 0, off = 0;
        for (int a = 0; a < 5 * 5 * 5; a++)
            for (int b = 0; b < 5 * 5 * 5; b++) {
                struct vec3 o = {steps[a % 5], steps[a / 5 % 5], steps[a / 25]};
                struct vec3 d = {steps[b % 5], steps[b / 5 % 5], steps[b / 25]};
                struct ray ray = {.origin = o, .direction = d, .t_min = -INFINITY, .t_max = INFINITY};
                struct crossing_list list;
                CHECK(shape_crossings(&s, &ray, &scratch, &list));
                struct crossing *c = &scratch.items[list.first];
                order += closed && list.count % 2;
                order += vec3_max_abs(d) == 0 && list.count > 0;
                for (uint32_t i = 0; i < list.count; i++) {
                    order +=
                        isnan(c[i].t) || (closed && c[i].enter != (i % 2 == 0)) || (i > 0 && !(c[i].t >= c[i - 1].t));
                    struct surface surface;
                    if (isfinite(c[i].t)) {
                        shape_describe(&s, &ray, &c[i], &surface);
                        off +=
                            !vec3_finite(surface.point) || !(vec3_length(surface.normal) > 0) || !(surface.error >= 0);
                        off += !vec3_finite(surface.dpdu) || !vec3_finite(surface.dpdv) || isnan(surface.u + surface.v);
                    }
                }
                for (uint32_t i = 0; closed && i + 1 < list.count; i++) {
                    if (!(c[i + 1].t - c[i].t > 1e-5) || !isfinite(c[i].t) || !isfinite(c[i + 1].t))
                        continue;
                    struct vec3 p = ray_at(&ray, c[i].t / 2 + c[i + 1].t / 2);
                    bool in = shape_contains(&s, p, &scratch);
                    wrong +=
                        in != (i % 2 == 0) && fabsl(implicit(&s, point_of(p))) > 1e-12L && within_limits(&s, p, 1e-12);
                }
                scratch.used = list.first;
            }
        if (wrong || order || off)
            test_fail(__FILE__, __LINE__, "%s: %ld out of order, %ld descriptions, %ld middles", form_names[form],
                      order, off, wrong);
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(cylinder_cone_torus_and_square_have_the_dimensions_of_the_specification) {
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    struct shape cylinder = {.kind = SHAPE_REVOLVED_QUADRIC}, cone = cylinder,
                 torus = {.kind = SHAPE_TORUS, .torus = {2, 0.5}};
    cylinder.revolved_quadric = revolved_quadric_cylinder(vec3_make(0, -1, 0), vec3_make(0, 1, 0), 1, false);
    cone.revolved_quadric = revolved_quadric_frustum(vec3_all(0), 0, vec3_make(0, 1, 0), 1, false);
    struct shape square = {.kind = SHAPE_PLANAR};
    square.planar = planar_square();
    const struct {
        const struct shape *shape;
        struct vec3 o, d;
        int count;
        double t[4];
    } table[] = {
        {&cylinder, {0, 5, 0}, {0, -1, 0}, 2, {4, 6}},
        {&cylinder, {-3, 0.5, 0}, {2, 0, 0}, 2, {1, 2}},
        {&cylinder, {-3, 1.5, 0}, {1, 0, 0}, 0, {0}},
        {&cylinder, {-2, -1.5, 0}, {1, 1, 0}, 2, {1, 2.5}},
        {&cone, {-3, 0.5, 0}, {1, 0, 0}, 2, {2.5, 3.5}},
        {&cone, {0, 3, 0}, {0, -1, 0}, 2, {2, 3}},
        {&cone, {0.5, 3, 0}, {0, -1, 0}, 2, {2, 2.5}},
        {&cone, {-3, -0.5, 0}, {1, 0, 0}, 0, {0}},
        {&torus, {-4, 0, 0}, {1, 0, 0}, 4, {1.5, 2.5, 5.5, 6.5}},
        {&torus, {0, 5, 0}, {0, -1, 0}, 0, {0}},
        {&torus, {2, 5, 0}, {0, -1, 0}, 2, {4.5, 5.5}},
        {&square, {0.25, 1, -0.25}, {0, -1, 0}, 1, {1}},
        {&square, {0.6, 1, 0}, {0, -1, 0}, 0, {0}},
    };
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        struct ray ray = {.origin = table[i].o, .direction = table[i].d, .t_min = -INFINITY, .t_max = INFINITY};
        struct crossing_list list;
        CHECK(shape_crossings(table[i].shape, &ray, &scratch, &list));
        CHECK_EQ_INT(list.count, table[i].count);
        for (uint32_t k = 0; k < list.count; k++)
            CHECK_NEAR(scratch.items[list.first + k].t, table[i].t[k], 1e-14);
        scratch.used = list.first;
    }
    struct ray down = line_through(vec3_make(0.25, 1, -0.125), vec3_make(0.25, 0, -0.125));
    struct crossing c;
    struct surface surface;
    CHECK(shape_nearest(&square, &down, &scratch, &c));
    shape_describe(&square, &down, &c, &surface);
    CHECK(surface.normal.y > 0 && surface.normal.x == 0 && surface.u == 0.75 && surface.v == 0.625);
    geom_scratch_destroy(&scratch);
}

/* Under any map the shape touches every side of its box within 1 % and does not reach beyond it. */
TEST(analytic_shapes_have_tight_world_boxes_under_any_affine_map) {
    struct arena arena = {0};
    struct test_random random = {6};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    for (int form = 0; form < FORMS; form++) {
        if (form == HALF_SPACE || form == QUADRIC_ENDLESS)
            continue;
        bool known = form != QUADRIC_SADDLE && form != QUADRIC_OPEN && form != POLYGON;
        for (int turn = 0; turn < 3; turn++) {
            struct shape s = random_shape((enum form)form, &random, &arena);
            struct transform map = turn == 0 ? transform_identity() : random_transform(&random, 3);
            struct box box = shape_bounds_under(&s, &map.forward), own = shape_bounds(&s), padded = box_pad(box);
            struct vec3 extent = vec3_sub(box.max, box.min);
            double size = vec3_max_abs(extent);
            struct vec3 best[6], target = vec3_all(0);
            double reached[6];
            for (int side = 0; side < 6; side++)
                reached[side] = -INFINITY;
            long outside = 0;
            int samples = form == SUPER_STAR || form == THIN_TORUS ? 20000 : 4000; /* thin tips are hard to hit */
            if (form == POLYGON) {
                struct box corners = box_empty();
                for (size_t i = 0; i < sizeof outline_points / sizeof outline_points[0]; i++)
                    corners = box_add_point(corners, affine_point(&map.forward, outline_points[i]));
                CHECK_NEAR(vec3_max_abs(vec3_sub(corners.min, box.min)), 0, 1e-12);
                CHECK_NEAR(vec3_max_abs(vec3_sub(corners.max, box.max)), 0, 1e-12);
            }
            for (int i = 0; i < samples; i++) {
                int side = i % 6;
                double noise =
                    i < 1500 || !(reached[side] > -INFINITY) ? 0 : 2 * size_of(&s) * exp(test_uniform(&random, -8, -1));
                struct vec3 share = random_vec3(&random, 0.5), origin = random_vec3(&random, 4 * size_of(&s));
                struct vec3 middle = vec3_scale(vec3_add(own.min, own.max), 0.5), all = vec3_sub(own.max, own.min);
                target = noise > 0 ? vec3_add_scaled(best[side], share, noise) : vec3_add(middle, vec3_mul(share, all));
                struct ray ray = line_through(origin, target);
                struct crossing_list list;
                CHECK(shape_crossings(&s, &ray, &scratch, &list));
                for (uint32_t k = 0; k < list.count; k++) {
                    struct vec3 p = ray_at(&ray, scratch.items[list.first + k].t), w = affine_point(&map.forward, p);
                    outside += !box_contains(&padded, w) || !box_contains(&own, vec3_scale(p, 1 - 0x1p-40));
                    for (int j = 0; j < 6; j++) {
                        double margin = j % 2 ? vec3_get(w, j / 2) : -vec3_get(w, j / 2);
                        if (margin > reached[j]) {
                            reached[j] = margin;
                            best[j] = p;
                        }
                    }
                }
                scratch.used = list.first;
            }
            double slack = 0;
            for (int j = 0; j < 6; j++)
                slack = fmax(slack, (j % 2 ? vec3_get(box.max, j / 2) : -vec3_get(box.min, j / 2)) - reached[j]);
            if (outside || (known && !(slack < 0.01 * size)))
                test_fail(__FILE__, __LINE__, "%s: %ld points outside, slack %g of %g", form_names[form], outside,
                          slack, size);
        }
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

/* u increases to the right and v upwards as seen from outside (planar shapes: from the front), or both are reversed. */
TEST(analytic_shapes_never_show_pictures_mirrored) {
    struct test_random random = {77};
    struct arena arena = {0};
    struct geom_scratch scratch = {0};
    for (int form = 0; form < FORMS; form++) {
        long checked = 0, mirrored = 0;
        struct shape s = random_shape((enum form)form, &random, &arena);
        for (int i = 0; i < 2000; i++) {
            struct ray ray = line_through(random_vec3(&random, 5), target_at(&s, 0.7, &random));
            struct crossing c;
            struct surface at;
            ray.t_min = 0;
            if (!shape_nearest(&s, &ray, &scratch, &c))
                continue;
            shape_describe(&s, &ray, &c, &at);
            struct vec3 both = vec3_cross(at.dpdu, at.dpdv);
            if (!at.has_uv || !(vec3_length(both) > 1e-9))
                continue;
            checked++;
            mirrored += vec3_dot(both, at.normal) < 0;
        }
        if (mirrored || (checked < 100 && form != THIN_TORUS))
            test_fail(__FILE__, __LINE__, "%s: %ld of %ld", form_names[form], mirrored, checked);
    }
    arena_destroy(&arena);
}

/* dpdu and dpdv agree with how the point moves when u and v do. */
TEST(analytic_shapes_have_image_coordinates_that_move_as_their_derivatives_say) {
    struct test_random random = {7};
    struct arena arena = {0};
    struct geom_scratch scratch = {0};
    for (int form = 0; form < FORMS; form++) {
        struct shape s = random_shape((enum form)form, &random, &arena);
        long checked = 0, wrong = 0, range = 0;
        if (form == SUPER_SHARP || form == SUPER_STAR || form == SUPER_MIXED)
            continue;
        for (int i = 0; i < 20000; i++) {
            struct vec3 origin = random_vec3(&random, 5);
            struct ray ray = line_through(origin, target_at(&s, 0.7, &random)), near = ray;
            near.direction = vec3_add(near.direction, random_vec3(&random, 1e-6));
            ray.t_min = near.t_min = 0;
            struct crossing a, b;
            if (!shape_nearest(&s, &ray, &scratch, &a) || !shape_nearest(&s, &near, &scratch, &b) || a.part != b.part)
                continue;
            struct surface p, q;
            shape_describe(&s, &ray, &a, &p);
            shape_describe(&s, &near, &b, &q);
            bool endless = form == HALF_SPACE || form == QUADRIC_ENDLESS;
            range += !p.has_uv || (!endless && !(p.u >= 0 && p.u <= 1 && p.v >= 0 && p.v <= 1));
            /* Seams, poles, grazing rays and sharp bends are not suitable for a test of derivatives. */
            struct vec3 moved = vec3_sub(q.point, p.point);
            if (fabs(p.u - q.u) > 0.5 || fabs(p.v - q.v) > 0.5 || vec3_length(moved) > 1e-4)
                continue;
            if (s.kind != SHAPE_PLANAR && form != QUADRIC_ENDLESS && (p.v < 0.05 || p.v > 0.95))
                continue;
            struct vec3 predicted = vec3_add(vec3_scale(p.dpdu, q.u - p.u), vec3_scale(p.dpdv, q.v - p.v));
            checked++;
            wrong += !(vec3_length(vec3_sub(moved, predicted)) <= 1e-2 * vec3_length(moved) + 1e-12);
        }
        if (range || wrong * 500 > checked || (checked < 300 && form != THIN_TORUS))
            test_fail(__FILE__, __LINE__, "%s: %ld of %ld wrong, %ld out of range", form_names[form], wrong, checked,
                      range);
    }
    arena_destroy(&arena);
}

/* A ray direction scaled by a power of two gives t divided by it, bit by bit. The same for shapes whose lengths can be
 * scaled. */
TEST(analytic_shapes_scaled_by_powers_of_two_give_the_same_t) {
    struct test_random random = {8};
    struct arena arena = {0};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 64));
    const int exponents[] = {-500, -30, 20, 300}, lengths[] = {-90, -10, 20, 90};
    for (int form = 0; form < FORMS; form++) {
        struct shape s = random_shape((enum form)form, &random, &arena);
        long wrong = 0, crossings = 0;
        for (int i = 0; i < 500; i++) {
            struct vec3 origin = random_vec3(&random, 3);
            struct ray ray = line_through(origin, target_at(&s, 0.7, &random));
            struct crossing_list list, other;
            CHECK(shape_crossings(&s, &ray, &scratch, &list));
            crossings += list.count;
            for (int e = 0; e < 4; e++) {
                struct ray longer = ray;
                longer.direction = vec3_scale(ray.direction, ldexp(1, exponents[e]));
                CHECK(shape_crossings(&s, &longer, &scratch, &other));
                wrong += other.count != list.count;
                for (uint32_t k = 0; k < list.count && other.count == list.count; k++)
                    wrong += ldexp(scratch.items[other.first + k].t, exponents[e]) != scratch.items[list.first + k].t;
                scratch.used = other.first;

                double f = ldexp(1, lengths[e]);
                struct shape big = s;
                struct ray big_ray = ray;
                big_ray.origin = vec3_scale(ray.origin, f);
                big_ray.direction = vec3_scale(ray.direction, f);
                if (s.kind == SHAPE_REVOLVED_QUADRIC) {
                    big.revolved_quadric.base = vec3_scale(s.revolved_quadric.base, f);
                    big.revolved_quadric.b *= f;
                    big.revolved_quadric.c *= f * f;
                    big.revolved_quadric.lo *= f;
                    big.revolved_quadric.hi *= f;
                } else if (s.kind == SHAPE_TORUS) {
                    big.torus = (struct torus){s.torus.major * f, s.torus.minor * f};
                } else if (s.kind == SHAPE_ELLIPSOID) {
                    big.ellipsoid =
                        (struct ellipsoid){vec3_scale(s.ellipsoid.centre, f), vec3_scale(s.ellipsoid.radii, f)};
                } else if (s.kind == SHAPE_PLANAR) {
                    big.planar.origin = vec3_scale(s.planar.origin, f);
                    big.planar.u = vec3_scale(s.planar.u, f);
                    big.planar.v = vec3_scale(s.planar.v, f);
                } else {
                    continue;
                }
                CHECK(shape_crossings(&big, &big_ray, &scratch, &other));
                wrong += other.count != list.count;
                for (uint32_t k = 0; k < list.count && other.count == list.count; k++)
                    wrong += scratch.items[other.first + k].t != scratch.items[list.first + k].t;
                scratch.used = other.first;
            }
            scratch.used = list.first;
        }
        if (wrong || crossings < 50)
            test_fail(__FILE__, __LINE__, "%s: %ld of %ld differ", form_names[form], wrong, crossings);
    }
    geom_scratch_destroy(&scratch);
    arena_destroy(&arena);
}

TEST(analytic_shapes_seen_from_far_away_are_hit_on_their_surface) {
    struct test_random random = {9};
    struct arena arena = {0};
    struct geom_scratch scratch = {0};
    for (int form = 0; form < FORMS; form++) {
        if (form == THIN_TORUS || form == SUPER_STAR)
            continue;
        long hits = 0, off = 0;
        double worst = 0;
        for (int i = 0; i < 3000; i++) {
            struct shape s = random_shape((enum form)form, &random, &arena);
            double far = exp(test_uniform(&random, 3, 14));
            struct vec3 origin = vec3_scale(vec3_normalize(random_vec3(&random, 1)), far);
            struct ray ray = line_through(origin, target_at(&s, 0.5 * size_of(&s), &random));
            struct crossing c;
            if (form == QUADRIC_ENDLESS || !shape_nearest(&s, &ray, &scratch, &c) || c.part != 0)
                continue;
            struct vec3 p = ray_at(&ray, c.t);
            struct point g = gradient(&s, point_of(p));
            if (sqrtl(g.x * g.x + g.y * g.y + g.z * g.z) < 1e-2L)
                continue;
            hits++;
            worst = fmax(worst, residual(&s, p) / far);
            off += !(residual(&s, p) < 8e-15 * far);
        }
        if (off || (form != QUADRIC_ENDLESS && hits < 200))
            test_fail(__FILE__, __LINE__, "%s: %ld of %ld hits off, worst %g of the distance", form_names[form], off,
                      hits, worst);
    }
    arena_destroy(&arena);
}

TEST(polygons_that_are_none_are_refused_with_the_reason) {
    struct arena arena = {0};
    struct planar planar;
    const char *why = NULL;
    const struct vec3 bent[] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0.5, 1}},
                      line[] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    const uint32_t four = 4, three = 3, two = 2;
    CHECK(!planar_polygon(&arena, bent, &four, 1, &planar, &why));
    CHECK_TEXT(why, "its points do not lie in one plane");
    CHECK(!planar_polygon(&arena, line, &three, 1, &planar, &why));
    CHECK_TEXT(why, "the first outline has no area");
    CHECK(!planar_polygon(&arena, line, &two, 1, &planar, &why));
    CHECK_TEXT(why, "an outline has fewer than three points");
    CHECK(!planar_polygon(&arena, line, &two, 0, &planar, &why));
    arena_destroy(&arena);
}

/* ---- CSG ---- */

TEST_TIMES(csg_of_all_analytic_solids_equals_point_by_point_evaluation, 30) {
    enum { MAX = 8 };
    struct test_random random = {10};
    struct geom_scratch scratch;
    CHECK(geom_scratch_init(&scratch, 1000));
    long segments = 0, insides = 0, wrong = 0, order = 0, inward = 0, unbounded = 0;
    for (int tree = 0; tree < 150 * times; tree++) {
        struct arena arena = {0};
        struct error error = {0};
        struct csg_leaf leaves[MAX];
        struct csg_token program[2 * MAX];
        uint32_t count = 1 + (uint32_t)test_uniform(&random, 0, MAX - 0.001);
        for (uint32_t i = 0; i < count;) {
            enum form form = (enum form)test_uniform(&random, 0, FORMS - 0.001);
            struct shape s = random_shape(form, &random, &arena);
            if (!shape_is_closed(&s) || form == THIN_TORUS)
                continue;
            leaves[i++] = (struct csg_leaf){.shape = s, .csg_from_leaf = random_transform(&random, 1)};
        }
        uint32_t length = random_program(&random, 0, count, 0, program);
        const struct csg *csg = csg_build(&arena, leaves, count, program, length, &error);
        CHECK(csg != NULL);
        for (int i = 0; csg && i < 300; i++) {
            struct vec3 origin = random_vec3(&random, 4);
            struct ray ray = line_through(origin, random_vec3(&random, 1));
            struct crossing_list list;
            CHECK(csg_crossings(csg, &ray, &scratch, &list));
            struct crossing *c = &scratch.items[list.first];
            order += list.count % 2;
            for (uint32_t k = 0; k < list.count; k++)
                order += c[k].enter != (k % 2 == 0) || (k > 0 && !(c[k].t > c[k - 1].t));
            for (uint32_t k = 0; k <= list.count; k++) {
                double from = k ? c[k - 1].t : -INFINITY, to = k < list.count ? c[k].t : INFINITY;
                unbounded += k < list.count && !isfinite(to);
                if ((k < list.count && to == -INFINITY) || (k && from == INFINITY))
                    continue;
                if (!isfinite(from))
                    from = isfinite(to) ? to - 1 : 0;
                if (!isfinite(to))
                    to = from + 1;
                bool inside = k % 2 == 1;
                insides += inside;
                segments++;
                struct vec3 p = ray_at(&ray, from / 2 + to / 2);
                if (to - from > 1e-6)
                    wrong += csg_contains(csg, p, &scratch) != inside;
                if (k == list.count)
                    break;
                if (!isfinite(c[k].t))
                    continue;
                struct surface surface;
                csg_describe(csg, &ray, &c[k], &surface);
                double cosine = vec3_dot(vec3_normalize(surface.normal), vec3_normalize(ray.direction));
                inward += fabs(cosine) > 1e-5 && c[k].enter != (cosine < 0);
            }
            scratch.used = list.first;
            struct crossing nearest;
            ray.t_min = 0;
            const struct crossing *expected = NULL;
            for (uint32_t k = 0; k < list.count && !expected; k++)
                expected = c[k].t > 0 && c[k].t < INFINITY ? &c[k] : NULL;
            struct crossing first = expected ? *expected : (struct crossing){0};
            bool found = csg_nearest(csg, &ray, &scratch, &nearest);
            order += found != (expected != NULL) || (found && (nearest.t != first.t || nearest.leaf != first.leaf));
        }
        arena_destroy(&arena);
    }
    CHECK_EQ_INT(wrong, 0);
    CHECK_EQ_INT(order, 0);
    CHECK_EQ_INT(inward, 0);
    CHECK(insides > 10000 * times && unbounded > 300 * times);
    geom_scratch_destroy(&scratch);
}
