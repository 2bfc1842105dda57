/* Traversal of the kd-tree with a stack. The plane of a node is crossed at t = (split - origin) / direction, which is
 * wrong by less than 2^-50 of itself; and a point of the ray may be off the item it belongs to by the caller's slack,
 * which is slack / |direction| along the ray. Both sides of a plane therefore get the interval up to t plus, and from t
 * minus, these two: they overlap, nothing is lost between them, and if a ray lies in a plane, both sides are
 * visited. */
#include "accel/kd_tree.h"

static void push(struct kd_traversal *traversal, uint32_t node, double enter, double leave) {
    traversal->stack[traversal->top++] = (struct kd_pending){enter, leave, node};
}

/* The part of the ray's interval in which it may be within slack of the bounds. */
static bool clip_to_bounds(const struct kd_traversal *traversal, double *enter, double *leave) {
    const struct box *bounds = &traversal->tree->bounds;
    for (int axis = 0; axis < 3; axis++) {
        double lo = vec3_get(bounds->min, axis) - traversal->origin[axis];
        double hi = vec3_get(bounds->max, axis) - traversal->origin[axis];
        if (!isfinite(traversal->inverse[axis])) {
            if (traversal->direction[axis] == 0 && (lo > traversal->slack || hi < -traversal->slack))
                return false;
            continue;
        }
        double a = (traversal->direction[axis] > 0 ? lo : hi) * traversal->inverse[axis];
        double b = (traversal->direction[axis] > 0 ? hi : lo) * traversal->inverse[axis];
        a -= fabs(a) * 0x1p-50 + traversal->widen[axis];
        b += fabs(b) * 0x1p-50 + traversal->widen[axis];
        *enter = a > *enter ? a : *enter;
        *leave = b < *leave ? b : *leave;
    }
    return *enter <= *leave;
}

void kd_traversal_begin(struct kd_traversal *traversal, const struct kd_tree *tree, const struct ray *ray,
                        double slack) {
    traversal->tree = tree;
    traversal->slack = slack;
    traversal->steps = traversal->leaves = 0;
    traversal->top = 0;
    traversal->unbounded_next = tree->unbounded_count > 0;
    for (int axis = 0; axis < 3; axis++) {
        traversal->origin[axis] = vec3_get(ray->origin, axis);
        traversal->direction[axis] = vec3_get(ray->direction, axis);
        traversal->inverse[axis] = 1 / traversal->direction[axis];
        traversal->widen[axis] = slack > 0 ? slack * fabs(traversal->inverse[axis]) : 0;
    }
    double enter = ray->t_min, leave = ray->t_max;
    if (tree->node_count > 0 && clip_to_bounds(traversal, &enter, &leave))
        push(traversal, 0, enter, leave);
}

/* Descends from a node to a leaf; farther children wait on the stack. */
static const struct kd_node *descend(struct kd_traversal *traversal, struct kd_pending at) {
    const struct kd_node *nodes = traversal->tree->nodes, *node = &nodes[at.node];
    while (node->axis != KD_LEAF) {
        uint32_t axis = node->axis, lower = at.node + 1, upper = node->offset;
        double from_origin = node->split - traversal->origin[axis];
        traversal->steps++;
        if (!isfinite(traversal->inverse[axis])) { /* along the plane */
            bool below = from_origin > traversal->slack, above = from_origin < -traversal->slack;
            if (traversal->direction[axis] != 0 || (!below && !above)) {
                push(traversal, upper, at.enter, at.leave);
                above = false;
            }
            at.node = above ? upper : lower;
        } else {
            double t = from_origin * traversal->inverse[axis], widen = fabs(t) * 0x1p-50 + traversal->widen[axis];
            bool forward = traversal->direction[axis] > 0;
            uint32_t first = forward ? lower : upper, second = forward ? upper : lower;
            if (t - widen > at.leave) {
                at.node = first;
            } else if (t + widen < at.enter) {
                at.node = second;
            } else {
                push(traversal, second, t - widen > at.enter ? t - widen : at.enter, at.leave);
                at.node = first;
                at.leave = t + widen < at.leave ? t + widen : at.leave;
            }
        }
        node = &nodes[at.node];
    }
    return node;
}

bool kd_traversal_next(struct kd_traversal *traversal, double t_max) {
    if (traversal->unbounded_next) {
        traversal->unbounded_next = false;
        traversal->items = traversal->tree->unbounded;
        traversal->count = traversal->tree->unbounded_count;
        return true;
    }
    while (traversal->top > 0) {
        struct kd_pending at = traversal->stack[--traversal->top];
        if (at.enter > t_max)
            continue;
        const struct kd_node *leaf = descend(traversal, at);
        traversal->leaves++;
        if (leaf->count == 0)
            continue;
        traversal->items = traversal->tree->items + leaf->offset;
        traversal->count = (uint32_t)leaf->count;
        return true;
    }
    return false;
}
