/* See beam.h; as in Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005. A box lies outside
 * of the beam when its corner nearest to one of the planes is outside. Slopes are widened by 2^-40, far more than
 * rounding errors away from the origin; `slack` covers those near it. */
#include "accel/beam.h"

bool beam_make(struct beam *out, const struct ray_packet *rays) {
    const double first[3] = {fabs(rays->direction[0][0]), fabs(rays->direction[1][0]), fabs(rays->direction[2][0])};
    /* The axis along which the first ray goes furthest. */
    int z = first[1] > first[0];
    z = first[2] > first[z] ? 2 : z;
    out->forward = z;
    out->side[0] = (z + 1) % 3;
    out->side[1] = (z + 2) % 3;
    out->backwards = rays->direction[z][0] < 0;
    double min = INFINITY, max = 0, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    double sign = out->backwards ? -1 : 1;
    /* The slopes of all rays to that axis. */
    for (uint32_t i = 0; i < rays->count; i++) {
        double main_slope = rays->direction[z][i] * sign, over = 1 / main_slope;
        min = main_slope < min ? main_slope : min;
        max = main_slope > max ? main_slope : max;
        for (int k = 0; k < 2; k++) {
            double slope = rays->direction[out->side[k]][i] * over;
            low[k] = slope < low[k] ? slope : low[k];
            high[k] = slope > high[k] ? slope : high[k];
        }
    }
    /* Directions that diverge too much, or turn back, make no beam. */
    double spread = math_max(math_max(-low[0], high[0]), math_max(-low[1], high[1]));
    if (!(min > 0 && max < 0x1p900 && min > 0x1p-900 && spread < 0x1p5))
        return false;
    /* Wider than the rounding of the slopes. */
    for (int k = 0; k < 2; k++) {
        out->slope_min[k] = low[k] - (fabs(low[k]) + 1) * 0x1p-40;
        out->slope_max[k] = high[k] + (fabs(high[k]) + 1) * 0x1p-40;
    }
    out->soonest = (1 - 0x1p-50) / max;
    out->origin[0] = rays->origin.x;
    out->origin[1] = rays->origin.y;
    out->origin[2] = rays->origin.z;
    out->slack = vec3_max_abs(rays->origin) * 0x1p-44;
    return isfinite(out->slack);
}

void beam_traversal_begin(struct beam_traversal *traversal, const struct box_tree *tree, const struct beam *beam) {
    traversal->tree = tree;
    traversal->beam = beam;
    traversal->steps = 0;
    traversal->top = 0;
    if (tree->item_count > 0) {
        traversal->child[traversal->top] = 0;
        traversal->enter[traversal->top++] = 0;
    }
}

/* The children that intersect the beam, and the distance to each. A NaN, from infinite sides, is never outside. */
static unsigned meet_children(const struct beam *b, const struct box_tree_node *node, double forward[BOX_TREE_WIDTH],
                              double behind[BOX_TREE_WIDTH]) {
    unsigned met = 0;
    const double *near_planes = node->planes[b->forward][b->backwards],
                 *far_planes = node->planes[b->forward][!b->backwards];
    double sign = b->backwards ? -1 : 1, origin = b->origin[b->forward];
    for (int i = 0; i < BOX_TREE_WIDTH; i++) {
        double near = (near_planes[i] - origin) * sign - b->slack, far = (far_planes[i] - origin) * sign + b->slack;
        bool outside = far < 0;
        for (int k = 0; k < 2; k++) {
            const double(*planes)[BOX_TREE_WIDTH] = node->planes[b->side[k]];
            double low = planes[0][i] - b->origin[b->side[k]] - b->slack;
            double high = planes[1][i] - b->origin[b->side[k]] + b->slack;
            outside |= low > b->slope_max[k] * (b->slope_max[k] > 0 ? far : near);
            outside |= high < b->slope_min[k] * (b->slope_min[k] > 0 ? near : far);
        }
        forward[i] = near;
        behind[i] = far;
        met |= (unsigned)(!outside && node->child[i] != BOX_TREE_NONE) << i;
    }
    return met;
}

bool beam_traversal_next(struct beam_traversal *traversal, double t_max, uint32_t *item) {
    while (traversal->top > 0) {
        uint32_t child = traversal->child[--traversal->top];
        if (traversal->enter[traversal->top] > t_max)
            continue;
        if (child & BOX_TREE_ITEM) {
            *item = child & ~BOX_TREE_ITEM;
            return true;
        }
        const struct box_tree_node *node = &traversal->tree->nodes[child];
        double forward[BOX_TREE_WIDTH], behind[BOX_TREE_WIDTH], order[BOX_TREE_WIDTH];
        unsigned met = meet_children(traversal->beam, node, forward, behind);
        traversal->steps++;
        int base = traversal->top;
        for (; met; met &= met - 1) {
            int i = __builtin_ctz(met), at = traversal->top++;
            double enter = forward[i] > 0 ? forward[i] * traversal->beam->soonest : 0;
            /* The child whose box ends first comes first, as in box_tree_traversal_next. */
            for (; at > base && order[at - 1 - base] < behind[i]; at--) {
                order[at - base] = order[at - 1 - base];
                traversal->enter[at] = traversal->enter[at - 1];
                traversal->child[at] = traversal->child[at - 1];
            }
            order[at - base] = behind[i];
            traversal->enter[at] = enter;
            traversal->child[at] = node->child[i];
        }
    }
    return false;
}

/* Shafts: the items that can be between a point and a parallelogram. Always conservative: an item is excluded only if
 * its box is certainly outside one plane, with a tolerance for the rounding of plane and box. */

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

static bool shaft_meets(const struct shaft *shaft, const struct box *box) {
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
