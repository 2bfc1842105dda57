/* Planar shapes: the line meets the plane at one t; an oblique coordinate system in the plane decides the rest. The
 * coordinates come from the triple products of Cramer's rule divided by normal . normal. Each shape decides which of
 * them belong to it, and its extent. */
#include "shape/planar.h"

#include "math/box.h"

void planar_across(struct vec3 n, struct vec3 *level, struct vec3 *up) {
    struct vec3 x = vec3_make(n.z, 0, -n.x); /* y cross n */
    x = vec3_max_abs(x) > 0x1p-26 ? vec3_normalize(x) : vec3_make(1, 0, 0);
    *up = vec3_normalize(vec3_cross(n, x));
    *level = vec3_cross(*up, n);
}

/* The plane, normal . p = distance (Hesse's normal form). A line is inside the half-space behind it on one side of its
 * only crossing, so in CSG there is a second one at infinity. */

struct planar planar_plane(struct vec3 normal, double distance) {
    struct planar f = {.kind = PLANAR_PLANE, .normal = vec3_normalize(normal)};
    f.origin = vec3_scale(f.normal, distance);
    planar_across(f.normal, &f.u, &f.v);
    return f;
}

/* The line crosses the plane at t = -height / climb (not finite: parallel to it), where `height` is the height of its
 * origin above the plane. Two crossings, one of them at infinity; 0 for a parallel line outside. */
static int plane_crossings(double t, bool enter, double height, const struct ray *ray, struct crossing out[2]) {
    /* A line along the plane is inside as a whole or not at all. */
    bool crosses = isfinite(t);
    if (!crosses && !(height < 0 && vec3_max_abs(ray->direction) > 0))
        return 0;
    out[0] = (struct crossing){.t = crosses && enter ? t : -INFINITY, .enter = true};
    out[1] = (struct crossing){.t = crosses && !enter ? t : INFINITY, .enter = false};
    return 2;
}

/* Takes the ends off [lo, hi] that the half-space does not have along g. */
static void plane_extent(struct vec3 normal, struct vec3 g, double *lo, double *hi) {
    /* Behind the plane everything is inside: only along the normal is there an end. */
    double along = vec3_dot(g, normal);
    struct vec3 rest = vec3_add_scaled(g, normal, -along);
    bool straight = vec3_max_abs(rest) == 0;
    if (!(straight && along >= 0))
        *hi = INFINITY;
    if (!(straight && along <= 0))
        *lo = -INFINITY;
}

/* The rectangle and its relatives: oblique coordinates along two edges, both from 0 to 1 (Moeller and Trumbore, "Fast,
 * minimum storage ray/triangle intersection", JGT 1997, without the diagonal). */

struct planar planar_parallelogram(struct vec3 corner, struct vec3 along, struct vec3 up) {
    return (struct planar){
        .kind = PLANAR_PARALLELOGRAM, .origin = corner, .u = along, .v = up, .normal = vec3_cross(along, up)};
}

struct planar planar_square(void) {
    return planar_parallelogram(vec3_make(-0.5, 0, 0.5), vec3_make(1, 0, 0), vec3_make(0, 0, -1));
}

static bool parallelogram_holds(double a, double b) {
    return a >= 0 && a <= 1 && b >= 0 && b <= 1;
}

/* The disc: of the plane's points those whose distance from the centre, by Pythagoras in units of the radius, lies
 * between that of the hole and 1. */

struct planar planar_disc(struct vec3 centre, struct vec3 normal, double radius, double inner) {
    struct planar f = {
        .kind = PLANAR_DISC, .origin = centre, .normal = vec3_normalize(normal), .inner = inner / radius};
    planar_across(f.normal, &f.u, &f.v);
    f.u = vec3_scale(f.u, radius);
    f.v = vec3_scale(f.v, radius);
    return f;
}

/* a and b count radii from the centre; inner is the hole's share of the radius. */
static bool disc_holds(double inner, double a, double b) {
    double square = a * a + b * b;
    return square <= 1 && square >= inner * inner;
}
/* How far it reaches along a direction whose parts along u and v are given. */
static double disc_extent(double u, double v) {
    return vec3_length(vec3_make(u, v, 0));
}

/* From radii to the image, which is the square around the disc. */
static void disc_image(const struct planar *f, struct surface *out) {
    out->u = (1 + out->u) / 2;
    out->v = (1 + out->v) / 2;
    out->dpdu = vec3_scale(f->u, 2);
    out->dpdv = vec3_scale(f->v, 2);
}

/* The triangle by its barycentric coordinates (Moebius, "Der barycentrische Calcul", 1827): none may be negative, the
 * third being 1 - a - b. Two triangles with a common edge are two shapes; what must be watertight is a mesh. */

struct planar planar_triangle(struct vec3 a, struct vec3 b, struct vec3 c) {
    struct vec3 u = vec3_sub(b, a), v = vec3_sub(c, a);
    return (struct planar){.kind = PLANAR_TRIANGLE, .origin = a, .u = u, .v = v, .normal = vec3_cross(u, v)};
}

static bool triangle_holds(double a, double b) {
    return a >= 0 && b >= 0 && a + b <= 1;
}

/* The polygon. A point is inside when a ray along +a crosses the outlines an odd number of times, each edge counted
 * with its lower end and without its upper one (Shimrat, "Algorithm 112: Position of point relative to polygon", CACM
 * 1962), so corners are counted once, and and polygons may be convex, concave or have holes. */

struct polygon {
    uint32_t outlines;
    const uint32_t *ends;
    const double (*points)[2]; /* in (a, b), all within 0 .. 1 */
    double largest;            /* coordinate of the points in space, for bounds of errors */
    const struct vec3 *corners;
};

/* Newell's normal of an outline, twice its area long (Sutherland, Sproull, Schumacker 1974). */
static struct vec3 outline_normal(const struct vec3 *points, uint32_t count) {
    struct vec3 sum = {0, 0, 0};
    for (uint32_t i = 1; i + 1 < count; i++)
        sum = vec3_add(sum, vec3_cross(vec3_sub(points[i], points[0]), vec3_sub(points[i + 1], points[0])));
    return sum;
}

bool planar_polygon(struct arena *arena, const struct vec3 *points, const uint32_t *ends, uint32_t outlines,
                    struct planar *out, const char **why) {
    uint32_t count = outlines ? ends[outlines - 1] : 0;
    for (uint32_t i = 0; i < outlines; i++)
        if (ends[i] < (i ? ends[i - 1] : 0) + 3) {
            *why = "an outline has fewer than three points";
            return false;
        }
    struct vec3 area = count ? outline_normal(points, ends[0]) : vec3_all(0), n = vec3_normalize(area);
    struct box box = box_empty();
    for (uint32_t i = 0; i < count; i++)
        box = box_add_point(box, points[i]);
    double size = count ? vec3_length(vec3_sub(box.max, box.min)) : 0;
    if (!(vec3_length(area) > 0x1p-40 * size * size)) {
        *why = count ? "the first outline has no area" : "there is no outline";
        return false;
    }
    double largest = math_max(vec3_max_abs(box.min), vec3_max_abs(box.max));
    for (uint32_t i = 0; i < count; i++)
        if (fabs(vec3_dot(n, vec3_sub(points[i], points[0]))) > 1e-6 * size) {
            *why = "its points do not lie in one plane";
            return false;
        }

    /* The image is the bounding rectangle of all points. */
    struct vec3 x, z;
    planar_across(n, &x, &z);
    double x_lo = INFINITY, x_hi = -INFINITY, z_lo = INFINITY, z_hi = -INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        struct vec3 p = vec3_sub(points[i], points[0]);
        x_lo = math_min(x_lo, vec3_dot(p, x)), x_hi = math_max(x_hi, vec3_dot(p, x));
        z_lo = math_min(z_lo, vec3_dot(p, z)), z_hi = math_max(z_hi, vec3_dot(p, z));
    }
    double(*planar_points)[2] = arena_alloc_array(arena, count, sizeof *planar_points);
    struct vec3 *corners = arena_alloc_array(arena, count, sizeof *corners);
    uint32_t *own_ends = arena_alloc_array(arena, outlines, sizeof *own_ends);
    struct polygon *polygon = arena_alloc(arena, sizeof *polygon);
    *why = NULL;
    if (!planar_points || !corners || !own_ends || !polygon)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        struct vec3 p = vec3_sub(points[i], points[0]);
        planar_points[i][0] = (vec3_dot(p, x) - x_lo) / (x_hi - x_lo);
        planar_points[i][1] = (vec3_dot(p, z) - z_lo) / (z_hi - z_lo);
        corners[i] = vec3_add_scaled(points[i], n, -vec3_dot(n, p));
    }
    for (uint32_t i = 0; i < outlines; i++)
        own_ends[i] = ends[i];
    *polygon = (struct polygon){outlines, own_ends, (const double(*)[2])planar_points, largest, corners};
    *out = (struct planar){.kind = PLANAR_POLYGON,
                           .origin = vec3_add_scaled(vec3_add_scaled(points[0], x, x_lo), z, z_lo),
                           .u = vec3_scale(x, x_hi - x_lo),
                           .v = vec3_scale(z, z_hi - z_lo),
                           .normal = n,
                           .polygon = polygon};
    return true;
}

const double (*planar_outline(const struct planar *polygon, uint32_t outline, uint32_t *count))[2] {
    const struct polygon *p = polygon->polygon;
    if (outline >= p->outlines)
        return NULL;
    uint32_t first = outline > 0 ? p->ends[outline - 1] : 0;
    *count = p->ends[outline] - first;
    return p->points + first;
}

static bool polygon_holds(const struct polygon *polygon, double a, double b) {
    bool inside = false;
    if (!(a > 0 && a < 1 && b > 0 && b < 1))
        return false;
    uint32_t first = 0;
    for (uint32_t i = 0; i < polygon->outlines; i++) {
        const double *p = polygon->points[polygon->ends[i] - 1];
        for (uint32_t k = first; k < polygon->ends[i]; k++) {
            const double *q = polygon->points[k];
            if ((p[1] > b) != (q[1] > b)) {
                /* From the lower end, so that both neighbours of an edge agree about it. */
                const double *low = p[1] < q[1] ? p : q, *high = p[1] < q[1] ? q : p;
                inside ^= (high[0] - low[0]) * (b - low[1]) > (a - low[0]) * (high[1] - low[1]);
            }
            p = q;
        }
        first = polygon->ends[i];
    }
    return inside;
}

static void polygon_extent(const struct polygon *polygon, struct vec3 g, double *lo, double *hi) {
    *lo = INFINITY;
    *hi = -INFINITY;
    for (uint32_t i = 0; i < polygon->ends[polygon->outlines - 1]; i++) {
        double at = vec3_dot(g, polygon->corners[i]);
        *lo = math_min(*lo, at);
        *hi = math_max(*hi, at);
    }
}

/* --- common functions --- */

static void coordinates(const struct planar *f, struct vec3 p, double *a, double *b) {
    struct vec3 w = vec3_sub(p, f->origin), n = vec3_cross(f->u, f->v);
    double nn = vec3_dot(n, n);
    *a = vec3_dot(vec3_cross(w, f->v), n) / nn;
    *b = vec3_dot(vec3_cross(f->u, w), n) / nn;
}

static bool holds(const struct planar *f, double a, double b) {
    switch (f->kind) {
    case PLANAR_PLANE:
        return true;
    case PLANAR_PARALLELOGRAM:
        return parallelogram_holds(a, b);
    case PLANAR_DISC:
        return disc_holds(f->inner, a, b);
    case PLANAR_TRIANGLE:
        return triangle_holds(a, b);
    case PLANAR_POLYGON:
        return polygon_holds(f->polygon, a, b);
    }
    return false;
}

int planar_crossings(const struct planar *f, const struct ray *ray, struct crossing out[2]) {
    double climb = vec3_dot(f->normal, ray->direction), height = vec3_dot(f->normal, vec3_sub(ray->origin, f->origin));
    double t = -height / climb;
    bool enter = climb < 0;
    if (f->kind == PLANAR_PLANE)
        return plane_crossings(t, enter, height, ray, out);
    if (!isfinite(t))
        return 0;
    double a, b;
    coordinates(f, ray_at(ray, t), &a, &b);
    if (!holds(f, a, b))
        return 0;
    out[0] = (struct crossing){.t = t, .enter = enter};
    return 1;
}

bool planar_contains(const struct planar *f, struct vec3 point) {
    return f->kind == PLANAR_PLANE && vec3_dot(f->normal, vec3_sub(point, f->origin)) < 0;
}

void planar_describe(const struct planar *f, const struct ray *ray, const struct crossing *crossing,
                     struct surface *out) {
    struct vec3 p = ray_at(ray, crossing->t), n = f->normal;
    double off = vec3_dot(n, vec3_sub(p, f->origin)) / vec3_dot(n, n);
    p = vec3_add_scaled(p, n, -off);
    *out = (struct surface){.point = p,
                            .normal = n,
                            .shading_normal = n,
                            .pattern_point = p,
                            .pattern_normal = n,
                            .has_uv = true,
                            .dpdu = f->u,
                            .dpdv = f->v};
    double largest = math_max(vec3_max_abs(f->origin), vec3_max_abs(p));
    if (f->kind == PLANAR_POLYGON)
        largest = math_max(largest, f->polygon->largest);
    out->error = 0x1p-48 * largest;
    coordinates(f, p, &out->u, &out->v);
    if (f->kind == PLANAR_DISC)
        disc_image(f, out);
}

void planar_extent(const struct planar *f, struct vec3 g, double *lo, double *hi) {
    double o = vec3_dot(g, f->origin), u = vec3_dot(g, f->u), v = vec3_dot(g, f->v);
    *lo = *hi = o;
    switch (f->kind) {
    case PLANAR_PLANE:
        plane_extent(f->normal, g, lo, hi);
        return;
    case PLANAR_PARALLELOGRAM:
        *lo += math_min(0, u) + math_min(0, v);
        *hi += math_max(u, 0) + math_max(v, 0);
        return;
    case PLANAR_DISC: {
        double extent = disc_extent(u, v);
        *lo -= extent;
        *hi += extent;
        return;
    }
    case PLANAR_TRIANGLE:
        *lo += math_min(0, math_min(u, v));
        *hi += math_max(math_max(u, v), 0);
        return;
    case PLANAR_POLYGON:
        polygon_extent(f->polygon, g, lo, hi);
        return;
    }
}

static void bundle_outlines(struct bundle *bundle, void *outlines) {
    struct polygon *polygon = outlines;
    const uint32_t points = polygon->ends[polygon->outlines - 1];
    BUNDLE(bundle, polygon->ends, polygon->outlines, NULL);
    BUNDLE(bundle, polygon->points, points, NULL);
    BUNDLE(bundle, polygon->corners, points, NULL);
}

void planar_bundle(struct bundle *bundle, void *shape) {
    struct planar *planar = shape;
    if (planar->kind == PLANAR_POLYGON)
        BUNDLE(bundle, planar->polygon, 1, bundle_outlines);
    else
        planar->polygon = NULL;
}
