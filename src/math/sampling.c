/* The concentric map of Shirley and Chiu, "A Low Distortion Map Between Disk and Square", JGT 1997, and the keyed
 * permutation of Kensler, "Correlated Multi-Jittered Sampling", Pixar Technical Memo 13-01, 2013: bijective mixing
 * steps within the next power of two, repeated until the result is in range (cycle walking). Multi-jittered sets are
 * those of Chiu, Shirley, Wang, "Multi-Jittered Sampling", Graphics Gems IV, 1994, with a separate permutation for
 * every column and every row. */
#include "math/sampling.h"

#include "math/elementary.h"
#include "math/frame.h"

#include <math.h>

uint32_t sample_permute(uint32_t index, uint32_t count, uint64_t key) {
    uint32_t mask = count - 1, p = (uint32_t)key, q = (uint32_t)(key >> 32);
    mask |= mask >> 1;
    mask |= mask >> 2;
    mask |= mask >> 4;
    mask |= mask >> 8;
    mask |= mask >> 16;
    do {
        /* Each line is a bijection of the numbers under the mask: xor, odd factor, xor with own upper bits. */
        index ^= p;
        index *= 0xe170893du;
        index ^= q;
        index ^= (index & mask) >> 4;
        index ^= p >> 8;
        index *= 0x0929eb3fu;
        index ^= q >> 23;
        index ^= (index & mask) >> 1;
        index *= 1 | p >> 27;
        index *= 0x6935fa69u;
        index ^= (index & mask) >> 11;
        index *= 0x74dcb303u;
        index ^= (index & mask) >> 2;
        index *= 0x9e501cc3u;
        index ^= (index & mask) >> 2;
        index *= 0xc860a3dfu;
        index &= mask;
        index ^= index >> 5;
    } while (index >= count);
    return (index + (p & 0x7fffffffu) % count) % count;
}

struct sample2 sample_multi(uint64_t set, uint64_t key, struct sample_part part) {
    uint32_t side = part.side, m = part.n * side;
    uint32_t column = part.i * side + part.part % side, row = part.j * side + part.part / side;
    uint32_t inner_x = sample_permute(row, m, random_combine(set, 2 * (uint64_t)column));
    uint32_t inner_y = sample_permute(column, m, random_combine(set, 2 * (uint64_t)row + 1));
    uint64_t bits = random_combine(key, (uint64_t)row * m + column);
    double x = random_unit(bits), y = random_unit(random_mix(bits + UINT64_C(0x9e3779b97f4a7c15)));
    return (struct sample2){((double)column + ((double)inner_x + x) / (double)m) / (double)m,
                            ((double)row + ((double)inner_y + y) / (double)m) / (double)m};
}

struct sample2 sample_disc(struct sample2 square) {
    double x = 2 * square.x - 1, y = 2 * square.y - 1, radius, angle, sine, cosine;
    const double quarter = PI / 4;
    if (x == 0 && y == 0)
        return (struct sample2){0, 0};
    if (fabs(x) > fabs(y)) {
        radius = x;
        angle = quarter * (y / x);
    } else {
        radius = y;
        angle = 2 * quarter - quarter * (x / y);
    }
    el_sincos(angle, &sine, &cosine);
    return (struct sample2){radius * cosine, radius * sine};
}

struct vec3 sample_cosine(struct vec3 normal, struct sample2 square) {
    struct sample2 disc = sample_disc(square);
    struct vec3 a, b;
    frame_tangents(normal, &a, &b);
    double height = 1 - disc.x * disc.x - disc.y * disc.y;
    struct vec3 out = vec3_scale(normal, height > 0 ? sqrt(height) : 0);
    return vec3_add_scaled(vec3_add_scaled(out, a, disc.x), b, disc.y);
}

/* A rectangle sampled by its solid angle: Urena, Fajardo, King, "An Area-Preserving Parametrization for
 * Spherical Rectangles", EGSR 2013. The rectangle is at z = z0 < 0 of a frame whose origin is the viewing point; the
 * four planes through the point and an edge meet at the corners of a spherical polygon, whose area is the excess of its
 * angles. The first number of a sample selects the area to its left, the second the height. */

/* Below this solid angle the excess has lost half of its digits, and sampling by area is as good. */
static const double min_angle = 0x1p-12;

static double limited(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

/* The plane through the point and an edge: the z of its unit normal (x, 0, z) or (0, y, z). */
static double plane_z(double xy, double z) {
    return vec3_normalize((struct vec3){0, xy, z}).z;
}

/* The angle between two neighbouring planes, whose normals have only z in common. */
static double corner_angle(double a, double b) {
    return el_acos(limited(-(a * b), -1, 1));
}

struct rectangle_frame rectangle_frame_make(struct vec3 edge1, struct vec3 edge2) {
    struct rectangle_frame frame = {.width = vec3_length(edge1), .height = vec3_length(edge2)};
    if (!(frame.width > 0 && frame.height > 0) || fabs(vec3_dot(edge1, edge2)) > 0x1p-40 * frame.width * frame.height)
        return frame;
    frame.right = true;
    frame.x = vec3_scale(edge1, 1 / frame.width);
    frame.y = vec3_scale(edge2, 1 / frame.height);
    frame.z = vec3_cross(frame.x, frame.y);
    return frame;
}

bool spherical_rectangle_make(const struct rectangle_frame *frame, struct vec3 corner, struct vec3 from,
                              struct spherical_rectangle *out) {
    if (!frame->right)
        return false;
    out->from = from;
    out->x = frame->x;
    out->y = frame->y;
    out->z = frame->z;
    struct vec3 d = vec3_sub(corner, from);
    out->z0 = vec3_dot(d, out->z);
    if (out->z0 > 0) {
        out->z = vec3_negate(out->z);
        out->z0 = -out->z0;
    }
    out->x0 = vec3_dot(d, out->x);
    out->y0 = vec3_dot(d, out->y);
    out->x1 = out->x0 + frame->width;
    out->y1 = out->y0 + frame->height;
    if (!(out->z0 < 0))
        return false;
    double x0 = out->x0, x1 = out->x1, y0 = out->y0, y1 = out->y1, z0 = out->z0;
    /* Cross products of the corners, in the order in which they surround the rectangle. */
    double n0 = plane_z(z0 * x1 - x0 * z0, x0 * y0 - y0 * x1), n1 = plane_z(y0 * z0 - z0 * y1, x1 * y1 - y0 * x1);
    double n2 = plane_z(z0 * x0 - x1 * z0, x1 * y1 - y1 * x0), n3 = plane_z(y1 * z0 - z0 * y0, x0 * y0 - y1 * x0);
    double g0 = corner_angle(n0, n1), g1 = corner_angle(n1, n2), g2 = corner_angle(n2, n3), g3 = corner_angle(n3, n0);
    out->b0 = n0;
    out->b1 = n2;
    out->k = 2 * PI - g2 - g3;
    out->angle = g0 + g1 - out->k;
    return out->angle > min_angle;
}

struct vec3 spherical_rectangle_point(const struct spherical_rectangle *seen, struct sample2 xi) {
    double sine, cosine;
    el_sincos(xi.x * seen->angle + seen->k, &sine, &cosine);
    double f = (cosine * seen->b0 - seen->b1) / sine;
    double c = (f > 0 ? 1 : -1) / sqrt(f * f + seen->b0 * seen->b0);
    c = limited(c, -1, 1);
    double x = limited(-(c * seen->z0) / sqrt(1 - c * c), seen->x0, seen->x1);
    double d = sqrt(x * x + seen->z0 * seen->z0);
    double h0 = seen->y0 / sqrt(d * d + seen->y0 * seen->y0), h1 = seen->y1 / sqrt(d * d + seen->y1 * seen->y1);
    double h = h0 + xi.y * (h1 - h0);
    double y = h * h < 1 ? limited(h * d / sqrt(1 - h * h), seen->y0, seen->y1) : h > 0 ? seen->y1 : seen->y0;
    struct vec3 point = vec3_add_scaled(seen->from, seen->x, x);
    return vec3_add_scaled(vec3_add_scaled(point, seen->y, y), seen->z, seen->z0);
}

/* A triangle sampled by its solid angle (spherical_triangle.h): Arvo, "Stratified Sampling of Spherical Triangles",
 * SIGGRAPH 1995. The first number of a sample selects the triangle of a, b and a point of the arc from a to c, by its
 * area; the second one the distance from b on the arc to that point. The solid angle is that of Van Oosterom and
 * Strackee, "The Solid Angle of a Plane Triangle", IEEE Transactions on Biomedical Engineering 1983, which keeps its
 * digits for small triangles. */

/* Near a half-space the corners of the spherical triangle lie on one great circle. */
static const double max_angle = 6.2;

bool spherical_triangle_make(struct vec3 corner, struct vec3 edge1, struct vec3 edge2, struct vec3 from,
                             struct spherical_triangle *out) {
    struct vec3 to_corner = vec3_sub(corner, from);
    struct vec3 a = vec3_normalize(to_corner), b = vec3_normalize(vec3_add(to_corner, edge1));
    struct vec3 c = vec3_normalize(vec3_add(to_corner, edge2));
    struct vec3 across_ab = vec3_cross(a, b), across_ac = vec3_cross(a, c);
    double cos_ab = vec3_dot(a, b), cos_ac = vec3_dot(a, c), volume = fabs(vec3_dot(c, across_ab));
    out->angle = 2 * el_atan2(volume, 1 + cos_ab + cos_ac + vec3_dot(b, c));
    double sines = sqrt(vec3_length_squared(across_ab) * vec3_length_squared(across_ac));
    if (!(out->angle > min_angle && out->angle < max_angle && sines > 0))
        return false;
    out->from = from;
    out->corner = corner;
    out->edge1 = edge1;
    out->edge2 = edge2;
    out->a = a;
    out->b = b;
    out->across = vec3_normalize(vec3_add_scaled(c, a, -cos_ac));
    out->cos_ab = cos_ab;
    out->cos_ac = cos_ac;
    out->cos_alpha = vec3_dot(across_ab, across_ac) / sines;
    out->sin_alpha = volume / sines;
    return true;
}

/* The point in a direction (Moeller and Trumbore 1997). Rounding does not lead out of the triangle. */
static struct vec3 triangle_in_direction(const struct spherical_triangle *seen, struct vec3 direction) {
    struct vec3 p = vec3_cross(direction, seen->edge2), off = vec3_sub(seen->from, seen->corner);
    double scale = 1 / vec3_dot(seen->edge1, p);
    double u = limited(vec3_dot(off, p) * scale, 0, 1);
    double v = limited(vec3_dot(direction, vec3_cross(off, seen->edge1)) * scale, 0, 1 - u);
    return vec3_add_scaled(vec3_add_scaled(seen->corner, seen->edge1, u), seen->edge2, v);
}

struct vec3 spherical_triangle_point(const struct spherical_triangle *seen, struct sample2 xi) {
    double sine, cosine, cos_alpha = seen->cos_alpha, sin_alpha = seen->sin_alpha;
    el_sincos(xi.x * seen->angle, &sine, &cosine);
    double s = sine * cos_alpha - cosine * sin_alpha, t = cosine * cos_alpha + sine * sin_alpha;
    double u = t - cos_alpha, v = s + sin_alpha * seen->cos_ab;
    double q = ((v * t - u * s) * cos_alpha - v) / ((v * s + u * t) * sin_alpha);
    q = q < 1 ? limited(q, seen->cos_ac, 1) : 1; /* on the arc; at its end a, where q may be 0 / 0 */
    struct vec3 end = vec3_add_scaled(vec3_scale(seen->a, q), seen->across, sqrt(math_max(0, (1 - q) * (1 + q))));
    double cos_end = vec3_dot(end, seen->b), z = 1 - xi.y * (1 - cos_end);
    struct vec3 aside = vec3_add_scaled(end, seen->b, -cos_end);
    double length = vec3_length(aside), along = length > 0 ? sqrt(math_max(0, (1 - z) * (1 + z))) / length : 0;
    return triangle_in_direction(seen, vec3_add_scaled(vec3_scale(seen->b, z), aside, along));
}

/* See sampling.h. The line from the point enters the box through the face whose plane it crosses last (Kay and Kajiya,
 * "Ray Tracing Complex Scenes", SIGGRAPH 1986). */

/* The position of the point along an edge, relative to its length: below 0 or above 1 it is outside a face. */
static double along_edge(const struct light_box *box, int axis, struct vec3 point) {
    const struct vec3 *edge = &box->edges[axis];
    return vec3_dot(vec3_sub(point, box->corner), *edge) / vec3_length_squared(*edge);
}

bool spherical_box_make(const struct light_box *box, struct vec3 from, struct spherical_box *out) {
    out->count = 0;
    out->angle = 0;
    for (int axis = 0; axis < 3; axis++) {
        double along = along_edge(box, axis, from);
        if (!(along < 0) && !(along > 1))
            continue;
        struct vec3 corner = along > 1 ? vec3_add(box->corner, box->edges[axis]) : box->corner;
        struct spherical_rectangle *face = &out->faces[out->count];
        const struct rectangle_frame frame =
            rectangle_frame_make(box->edges[(axis + 1) % 3], box->edges[(axis + 2) % 3]);
        if (!spherical_rectangle_make(&frame, corner, from, face))
            continue;
        out->angle += face->angle;
        out->axes[out->count++] = axis;
    }
    return out->count > 0;
}

struct vec3 spherical_box_point(const struct spherical_box *seen, struct sample2 xi) {
    double angle = xi.x * seen->angle;
    uint32_t face = 0;
    while (face + 1 < seen->count && angle >= seen->faces[face].angle)
        angle -= seen->faces[face++].angle;
    double x = angle / seen->faces[face].angle;
    return spherical_rectangle_point(&seen->faces[face], (struct sample2){x < 1 ? x : 1, xi.y});
}

double spherical_box_pdf(const struct light_box *box, const struct spherical_box *seen, struct vec3 from,
                         struct vec3 direction) {
    double last = -INFINITY;
    int entered = 0;
    for (int axis = 0; axis < 3; axis++) {
        double along = along_edge(box, axis, from), step = vec3_dot(direction, box->edges[axis]);
        if (!(along < 0) && !(along > 1))
            continue;
        double t = ((along > 1 ? 1 : 0) - along) * vec3_length_squared(box->edges[axis]) / step;
        if (t > last) {
            last = t;
            entered = axis;
        }
    }
    for (uint32_t i = 0; i < seen->count; i++)
        if (seen->axes[i] == entered)
            return 1 / seen->angle;
    return 0;
}
