/* A shape with an axis or edges has one box along them. A curve or a sweep has one tube for each of its pieces, in
 * which the direction changes little. Every other shape has its bounds (shape_part in shape.c). */
#include "shape/shape_part.h"

#include "base/unreachable.h"
#include "geometry/bernstein.h"
#include "math/frame.h"

#include <math.h>
#include <string.h>

bool oriented_box_is_finite(const struct oriented_box *box) {
    bool finite = vec3_finite(box->corner);
    for (int k = 0; k < 3; k++)
        finite = finite && vec3_finite(box->edges[k]);
    return finite;
}

struct oriented_box oriented_box_of(const struct box *box) {
    struct vec3 size = vec3_sub(box->max, box->min);
    return (struct oriented_box){box->min, {{size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z}}};
}

/* From its extents along its axis and two directions across. */
struct oriented_box oriented_box_of_quadric(const struct revolved_quadric *quadric) {
    struct oriented_box box = {.corner = {0, 0, 0}};
    struct vec3 directions[3] = {quadric->axis};
    frame_tangents(quadric->axis, &directions[1], &directions[2]);
    for (int k = 0; k < 3; k++) {
        double low, high;
        revolved_quadric_extent(quadric, directions[k], &low, &high);
        box.corner = vec3_add_scaled(box.corner, directions[k], low);
        box.edges[k] = vec3_scale(directions[k], math_max(high - low, 0));
    }
    return box;
}

struct oriented_box oriented_box_of_planar(const struct planar *planar) {
    const struct vec3 zero = {0, 0, 0}, u = planar->u, v = planar->v;
    switch (planar->kind) {
    case PLANAR_PLANE:
        return (struct oriented_box){{INFINITY, INFINITY, INFINITY}, {zero, zero, zero}};
    case PLANAR_DISC:
        return (struct oriented_box){vec3_sub(vec3_sub(planar->origin, u), v),
                                     {vec3_scale(u, 2), vec3_scale(v, 2), zero}};
    case PLANAR_PARALLELOGRAM:
    case PLANAR_TRIANGLE:
    case PLANAR_POLYGON:
        return (struct oriented_box){planar->origin, {u, v, zero}};
    }
    UNREACHABLE("a planar shape of no kind");
}

static struct vec3 point_of_tube(const struct shape_part *part, int k) {
    return vec3_make(part->tube[0][k], part->tube[1][k], part->tube[2][k]);
}

/* Along the chord; the second direction is the one to which the curve bends, so that the box of a plane curve is flat.
 * */
static void directions_of_tube(const struct shape_part *part, struct vec3 out[3]) {
    struct vec3 begin = point_of_tube(part, 0), chord = vec3_sub(point_of_tube(part, 3), begin);
    struct vec3 inner = vec3_sub(vec3_add(point_of_tube(part, 1), point_of_tube(part, 2)), vec3_scale(begin, 2));
    if (!(vec3_length_squared(chord) > 0))
        chord = vec3_length_squared(inner) > 0 ? inner : vec3_make(1, 0, 0);
    out[0] = vec3_normalize(chord);
    struct vec3 bend = vec3_add_scaled(inner, out[0], -vec3_dot(inner, out[0]));
    frame_tangents(out[0], &out[1], &out[2]);
    if (!(vec3_length(bend) > 0x1p-30 * vec3_length(inner)))
        return;
    out[1] = vec3_normalize(bend);
    out[2] = vec3_cross(out[0], out[1]);
}

struct oriented_box shape_part_box(const struct shape_part *part) {
    if (part->kind == SHAPE_PART_BOX)
        return part->box;
    struct oriented_box box = {.corner = {0, 0, 0}};
    struct vec3 directions[3];
    double radius = 0;
    for (int k = 0; k < 4; k++)
        radius = math_max(radius, part->tube[3][k]);
    directions_of_tube(part, directions);
    for (int d = 0; d < 3; d++) {
        double low = INFINITY, high = -INFINITY;
        for (int k = 0; k < 4; k++) {
            double along = vec3_dot(point_of_tube(part, k), directions[d]);
            low = math_min(low, along);
            high = math_max(high, along);
        }
        box.corner = vec3_add_scaled(box.corner, directions[d], low - radius);
        box.edges[d] = vec3_scale(directions[d], high - low + 2 * radius);
    }
    return box;
}

static int longest_edge(const struct oriented_box *box, const struct affine *map) {
    double longest = -1;
    int edge = 0;
    for (int k = 0; k < 3; k++) {
        double length = vec3_length(affine_vector(map, box->edges[k]));
        if (length > longest) {
            longest = length;
            edge = k;
        }
    }
    return edge;
}

void shape_part_split(const struct shape_part *part, const struct affine *map, struct shape_part halves[2]) {
    halves[0] = halves[1] = *part;
    if (part->kind == SHAPE_PART_TUBE) {
        for (int d = 0; d < 4; d++)
            bernstein_split(part->tube[d], 3, 0.5, halves[0].tube[d], halves[1].tube[d]);
        return;
    }
    int edge = longest_edge(&part->box, map);
    struct vec3 half = vec3_scale(part->box.edges[edge], 0.5);
    halves[0].box.edges[edge] = halves[1].box.edges[edge] = half;
    halves[1].box.corner = vec3_add(part->box.corner, half);
}
