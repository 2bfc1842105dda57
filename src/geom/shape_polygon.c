/* The polygon. A point is inside when a ray along +a crosses the outlines an odd number of times, each edge counted
 * with its lower end and without its upper one (Shimrat, "Algorithm 112: Position of point relative to polygon", CACM
 * 1962), so corners are counted once, and convex, concave and pierced ones are the same to it. */
#include "geom/shape_polygon.h"

#include "math/box.h"

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

bool flat_polygon(struct arena *arena, const struct vec3 *points, const uint32_t *ends, uint32_t outlines,
                  struct flat *out, const char **why) {
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
    double largest = fmax(vec3_max_abs(box.min), vec3_max_abs(box.max));
    for (uint32_t i = 0; i < count; i++)
        if (fabs(vec3_dot(n, vec3_sub(points[i], points[0]))) > 1e-6 * size) {
            *why = "its points do not lie in one plane";
            return false;
        }

    /* The image is the rectangle round all points. */
    struct vec3 x, z;
    flat_across(n, &x, &z);
    double x_lo = INFINITY, x_hi = -INFINITY, z_lo = INFINITY, z_hi = -INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        struct vec3 p = vec3_sub(points[i], points[0]);
        x_lo = fmin(x_lo, vec3_dot(p, x)), x_hi = fmax(x_hi, vec3_dot(p, x));
        z_lo = fmin(z_lo, vec3_dot(p, z)), z_hi = fmax(z_hi, vec3_dot(p, z));
    }
    double(*flat_points)[2] = arena_alloc_array(arena, count, sizeof *flat_points);
    struct vec3 *corners = arena_alloc_array(arena, count, sizeof *corners);
    uint32_t *own_ends = arena_alloc_array(arena, outlines, sizeof *own_ends);
    struct polygon *polygon = arena_alloc(arena, sizeof *polygon);
    *why = NULL;
    if (!flat_points || !corners || !own_ends || !polygon)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        struct vec3 p = vec3_sub(points[i], points[0]);
        flat_points[i][0] = (vec3_dot(p, x) - x_lo) / (x_hi - x_lo);
        flat_points[i][1] = (vec3_dot(p, z) - z_lo) / (z_hi - z_lo);
        corners[i] = vec3_add_scaled(points[i], n, -vec3_dot(n, p));
    }
    for (uint32_t i = 0; i < outlines; i++)
        own_ends[i] = ends[i];
    *polygon = (struct polygon){outlines, own_ends, (const double(*)[2])flat_points, largest, corners};
    *out = (struct flat){.kind = FLAT_POLYGON,
                         .origin = vec3_add_scaled(vec3_add_scaled(points[0], x, x_lo), z, z_lo),
                         .u = vec3_scale(x, x_hi - x_lo),
                         .v = vec3_scale(z, z_hi - z_lo),
                         .normal = n,
                         .polygon = polygon};
    return true;
}

bool polygon_holds(const struct polygon *polygon, double a, double b) {
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

double polygon_largest(const struct polygon *polygon) {
    return polygon->largest;
}

void polygon_extent(const struct polygon *polygon, struct vec3 g, double *lo, double *hi) {
    *lo = INFINITY;
    *hi = -INFINITY;
    for (uint32_t i = 0; i < polygon->ends[polygon->outlines - 1]; i++) {
        double at = vec3_dot(g, polygon->corners[i]);
        *lo = fmin(*lo, at);
        *hi = fmax(*hi, at);
    }
}
