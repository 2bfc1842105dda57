/* Shafts: what can be between a point and a parallelogram. Only ever conservative: an item is left out when its box
 * is certainly outside of one plane, with slack for the rounding of plane and box. */
#include "accel/box_tree.h"

static void add_plane(struct shaft *shaft, struct vec3 normal, struct vec3 on_plane, struct vec3 inside, double size) {
    double length = vec3_length(normal);
    if (!(length > 0) || !isfinite(length) || shaft->planes == 5)
        return;
    normal = vec3_scale(normal, 1 / length);
    double side = vec3_dot(normal, vec3_sub(inside, on_plane));
    if (side > 0) {
        normal = vec3_negate(normal);
        side = -side;
    }
    /* A plane that is not clearly on one side of the middle gives no information. */
    double slack = size * 0x1p-40;
    if (!(side < -slack))
        return;
    shaft->normal[shaft->planes] = normal;
    shaft->offset[shaft->planes++] = vec3_dot(normal, on_plane) + slack;
}

struct shaft shaft_make(struct vec3 from, struct vec3 corner, struct vec3 edge1, struct vec3 edge2) {
    struct shaft shaft = {.bounds = box_empty()};
    const struct vec3 corners[4] = {corner, vec3_add(corner, edge1), vec3_add(vec3_add(corner, edge1), edge2),
                                    vec3_add(corner, edge2)};
    shaft.bounds = box_add_point(shaft.bounds, from);
    struct vec3 middle = {0, 0, 0};
    for (int i = 0; i < 4; i++) {
        shaft.bounds = box_add_point(shaft.bounds, corners[i]);
        middle = vec3_add_scaled(middle, corners[i], 0.25);
    }
    double size = vec3_max_abs(shaft.bounds.min), other = vec3_max_abs(shaft.bounds.max);
    size = size > other ? size : other;
    shaft.bounds = box_pad(shaft.bounds);
    /* Halfway to the middle of the parallelogram is inside of all planes. */
    struct vec3 inside = vec3_scale(vec3_add(from, middle), 0.5);
    for (int i = 0; i < 4; i++) {
        struct vec3 a = vec3_sub(corners[i], from), b = vec3_sub(corners[(i + 1) & 3], from);
        add_plane(&shaft, vec3_cross(a, b), from, inside, size);
    }
    add_plane(&shaft, vec3_cross(edge1, edge2), corner, inside, size);
    return shaft;
}

bool shaft_meets(const struct shaft *shaft, const struct box *box) {
    if (box->min.x > shaft->bounds.max.x || box->max.x < shaft->bounds.min.x || box->min.y > shaft->bounds.max.y ||
        box->max.y < shaft->bounds.min.y || box->min.z > shaft->bounds.max.z || box->max.z < shaft->bounds.min.z)
        return false;
    for (int i = 0; i < shaft->planes; i++) {
        struct vec3 n = shaft->normal[i];
        /* The corner of the box farthest inside; an infinite side makes this infinite or NaN: not outside. */
        double innermost = n.x * (n.x > 0 ? box->min.x : box->max.x) + n.y * (n.y > 0 ? box->min.y : box->max.y) +
                           n.z * (n.z > 0 ? box->min.z : box->max.z);
        if (innermost > shaft->offset[i])
            return false;
    }
    return true;
}

uint32_t box_tree_in_shaft(const struct box_tree *tree, const struct shaft *shaft, uint32_t *items, uint32_t limit) {
    uint32_t stack[BOX_TREE_STACK], count = 0;
    int top = 0;
    if (tree->item_count > 0)
        stack[top++] = 0;
    while (top > 0) {
        const struct box_tree_node *node = &tree->nodes[stack[--top]];
        for (int i = 0; i < BOX_TREE_WIDTH; i++) {
            uint32_t child = node->child[i];
            struct box box = {{node->planes[0][0][i], node->planes[1][0][i], node->planes[2][0][i]},
                              {node->planes[0][1][i], node->planes[1][1][i], node->planes[2][1][i]}};
            if (child == BOX_TREE_NONE || !shaft_meets(shaft, &box))
                continue;
            if (!(child & BOX_TREE_ITEM))
                stack[top++] = child;
            else if (count == limit)
                return limit + 1;
            else
                items[count++] = child & ~BOX_TREE_ITEM;
        }
    }
    return count;
}
