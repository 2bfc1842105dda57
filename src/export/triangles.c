#include "export/triangles_internal.h"

#include "base/mem.h"

double segment_distance_squared(struct vec3 p, struct vec3 a, struct vec3 b) {
    struct vec3 along = vec3_sub(b, a);
    double length = vec3_dot(along, along), t = length > 0 ? vec3_dot(vec3_sub(p, a), along) / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return vec3_length_squared(vec3_sub(p, vec3_add_scaled(a, along, t)));
}

/* By the region of the plane that the point is over (Ericson, "Real-Time Collision Detection", 2005, 5.1.5). */
double triangle_distance_squared(struct vec3 p, const struct vec3 corners[3]) {
    struct vec3 a = corners[0], b = corners[1], c = corners[2];
    struct vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a), ap = vec3_sub(p, a);
    double a1 = vec3_dot(ab, ap), a2 = vec3_dot(ac, ap);
    if (a1 <= 0 && a2 <= 0)
        return vec3_dot(ap, ap);
    struct vec3 bp = vec3_sub(p, b), cp = vec3_sub(p, c);
    double b1 = vec3_dot(ab, bp), b2 = vec3_dot(ac, bp);
    if (b1 >= 0 && b2 <= b1)
        return vec3_dot(bp, bp);
    if (a1 * b2 - b1 * a2 <= 0 && a1 >= 0 && b1 <= 0)
        return segment_distance_squared(p, a, b);
    double c1 = vec3_dot(ab, cp), c2 = vec3_dot(ac, cp);
    if (c2 >= 0 && c1 <= c2)
        return vec3_dot(cp, cp);
    if (c1 * a2 - a1 * c2 <= 0 && a2 >= 0 && c2 <= 0)
        return segment_distance_squared(p, a, c);
    if (b1 * c2 - c1 * b2 <= 0 && b2 - b1 >= 0 && c1 - c2 >= 0)
        return segment_distance_squared(p, b, c);
    struct vec3 normal = vec3_cross(ab, ac);
    double height = vec3_dot(normal, ap);
    return height * height / vec3_dot(normal, normal);
}

struct vec3 triangle_normal(const struct vec3 corners[3]) {
    return vec3_cross(vec3_sub(corners[1], corners[0]), vec3_sub(corners[2], corners[0]));
}

/* Whether the segment goes through the inside of the triangle. */
static bool pierces(struct vec3 a, struct vec3 b, const struct vec3 corners[3], double slack) {
    struct vec3 normal = triangle_normal(corners), p = vec3_sub(corners[0], a), q = vec3_sub(corners[1], a);
    struct vec3 r = vec3_sub(corners[2], a), along = vec3_sub(b, a);
    double limit = slack * vec3_length(normal), from = -vec3_dot(normal, p);
    double to = vec3_dot(normal, vec3_sub(b, corners[0]));
    if (!(from > limit && to < -limit) && !(from < -limit && to > limit))
        return false;
    double x = vec3_dot(along, vec3_cross(p, q)), y = vec3_dot(along, vec3_cross(q, r)),
           z = vec3_dot(along, vec3_cross(r, p));
    return (x > 0 && y > 0 && z > 0) || (x < 0 && y < 0 && z < 0);
}

static bool has(const uint32_t vertices[3], uint32_t vertex) {
    return vertices[0] == vertex || vertices[1] == vertex || vertices[2] == vertex;
}

/* An edge of one that has no vertex of the other goes through the other. */
static bool edges_pierce(const struct corners *a, const struct corners *b, double slack) {
    for (int i = 0; i < 3; i++) {
        int next = (i + 1) % 3;
        if (!has(b->vertex, a->vertex[i]) && !has(b->vertex, a->vertex[next]) &&
            pierces(a->point[i], a->point[next], b->point, slack))
            return true;
    }
    return false;
}

/* Two triangles at one edge, folded onto each other. */
static bool is_folded(const struct corners *a, const struct corners *b) {
    struct vec3 n = vec3_normalize(triangle_normal(a->point)), m = vec3_normalize(triangle_normal(b->point));
    return vec3_dot(n, m) < -1 + 1e-12;
}

bool triangles_intersect(const struct corners *a, const struct corners *b, double slack) {
    int common = has(b->vertex, a->vertex[0]) + has(b->vertex, a->vertex[1]) + has(b->vertex, a->vertex[2]);
    if (common >= 2)
        return common == 3 || is_folded(a, b);
    return edges_pierce(a, b, slack) || edges_pierce(b, a, slack);
}

struct corners corners_of(const struct solid_mesh *mesh, uint32_t triangle) {
    const uint32_t *vertex = solid_triangle_at(mesh, triangle)->vertex;
    struct corners corners;
    for (int i = 0; i < 3; i++) {
        corners.vertex[i] = vertex[i];
        corners.point[i] = solid_vertex_at(mesh, vertex[i])->point;
    }
    return corners;
}

struct box corners_box(const struct corners *corners) {
    return (struct box){vec3_min(corners->point[0], vec3_min(corners->point[1], corners->point[2])),
                        vec3_max(corners->point[0], vec3_max(corners->point[1], corners->point[2]))};
}

bool triangle_tree_build(struct box_tree *tree, const struct solid_mesh *mesh, struct pool *pool, struct error *error) {
    uint32_t count = (uint32_t)mesh->triangles.count;
    struct box *boxes = mem_alloc(count * sizeof *boxes);
    for (uint32_t i = 0; boxes && i < count; i++) {
        struct corners corners = corners_of(mesh, i);
        boxes[i] = corners_box(&corners);
    }
    bool ok = boxes ? box_tree_build(tree, boxes, count, pool, error) : error_no_memory(error, "a tree of triangles");
    mem_free(boxes);
    return ok;
}

bool mesh_is_near(const struct solid_mesh *mesh, const struct box_tree *tree, struct vec3 point, double distance) {
    struct box region = box_grow((struct box){point, point}, distance);
    struct box_tree_meeting meeting;
    uint32_t triangle;
    box_tree_meeting_begin(&meeting, tree, &region);
    while (box_tree_meeting_next(&meeting, &triangle)) {
        struct corners corners = corners_of(mesh, triangle);
        if (triangle_distance_squared(point, corners.point) < distance * distance)
            return true;
    }
    return false;
}

void find_intersections(const struct solid_mesh *mesh, const struct box_tree *tree, double slack,
                        intersection_found *found, void *context) {
    for (uint32_t i = 0; i < mesh->triangles.count; i++) {
        struct corners corners = corners_of(mesh, i);
        struct box box = corners_box(&corners);
        struct box_tree_meeting meeting;
        uint32_t other;
        box_tree_meeting_begin(&meeting, tree, &box);
        while (box_tree_meeting_next(&meeting, &other)) {
            struct corners others = corners_of(mesh, other);
            if (other > i && triangles_intersect(&corners, &others, slack))
                found(context, i, other);
        }
    }
}
