/* Walking the kd-tree with a stack. The plane of a node is crossed at t = (split - origin) / direction, which is wrong
 * by less than 2^-50 of itself; and a point of the ray may be off the item it belongs to by the caller's slack, which
 * is slack / |direction| along the ray. Both sides of a plane therefore get the interval up to t plus, and from t
 * minus, these two: they overlap, nothing is lost between them, and where a ray keeps to a plane both sides are
 * visited. */
#include "accel/kd_tree.h"

static void push(struct kd_walk *walk, uint32_t node, double enter, double leave) {
    walk->stack[walk->top++] = (struct kd_pending){enter, leave, node};
}

/* The part of the ray's interval in which it may be within slack of the bounds. */
static bool clip_to_bounds(const struct kd_walk *walk, double *enter, double *leave) {
    const struct box *bounds = &walk->tree->bounds;
    for (int axis = 0; axis < 3; axis++) {
        double lo = vec3_get(bounds->min, axis) - walk->origin[axis];
        double hi = vec3_get(bounds->max, axis) - walk->origin[axis];
        if (!isfinite(walk->inverse[axis])) {
            if (walk->direction[axis] == 0 && (lo > walk->slack || hi < -walk->slack))
                return false;
            continue;
        }
        double a = (walk->direction[axis] > 0 ? lo : hi) * walk->inverse[axis];
        double b = (walk->direction[axis] > 0 ? hi : lo) * walk->inverse[axis];
        a -= fabs(a) * 0x1p-50 + walk->widen[axis];
        b += fabs(b) * 0x1p-50 + walk->widen[axis];
        *enter = a > *enter ? a : *enter;
        *leave = b < *leave ? b : *leave;
    }
    return *enter <= *leave;
}

void kd_walk_begin(struct kd_walk *walk, const struct kd_tree *tree, const struct ray *ray, double slack) {
    walk->tree = tree;
    walk->slack = slack;
    walk->steps = walk->leaves = 0;
    walk->top = 0;
    walk->unbounded_next = tree->unbounded_count > 0;
    for (int axis = 0; axis < 3; axis++) {
        walk->origin[axis] = vec3_get(ray->origin, axis);
        walk->direction[axis] = vec3_get(ray->direction, axis);
        walk->inverse[axis] = 1 / walk->direction[axis];
        walk->widen[axis] = slack > 0 ? slack * fabs(walk->inverse[axis]) : 0;
    }
    double enter = ray->t_min, leave = ray->t_max;
    if (tree->node_count > 0 && clip_to_bounds(walk, &enter, &leave))
        push(walk, 0, enter, leave);
}

/* From a node down to a leaf; what lies behind waits on the stack. */
static const struct kd_node *descend(struct kd_walk *walk, struct kd_pending at) {
    const struct kd_node *nodes = walk->tree->nodes, *node = &nodes[at.node];
    while (node->axis != KD_LEAF) {
        uint32_t axis = node->axis, lower = at.node + 1, upper = node->place;
        double from_origin = node->split - walk->origin[axis];
        walk->steps++;
        if (!isfinite(walk->inverse[axis])) { /* along the plane */
            bool below = from_origin > walk->slack, above = from_origin < -walk->slack;
            if (walk->direction[axis] != 0 || (!below && !above)) {
                push(walk, upper, at.enter, at.leave);
                above = false;
            }
            at.node = above ? upper : lower;
        } else {
            double t = from_origin * walk->inverse[axis], widen = fabs(t) * 0x1p-50 + walk->widen[axis];
            bool forward = walk->direction[axis] > 0;
            uint32_t first = forward ? lower : upper, second = forward ? upper : lower;
            if (t - widen > at.leave) {
                at.node = first;
            } else if (t + widen < at.enter) {
                at.node = second;
            } else {
                push(walk, second, t - widen > at.enter ? t - widen : at.enter, at.leave);
                at.node = first;
                at.leave = t + widen < at.leave ? t + widen : at.leave;
            }
        }
        node = &nodes[at.node];
    }
    return node;
}

bool kd_walk_next(struct kd_walk *walk, double t_max) {
    if (walk->unbounded_next) {
        walk->unbounded_next = false;
        walk->items = walk->tree->unbounded;
        walk->count = walk->tree->unbounded_count;
        return true;
    }
    while (walk->top > 0) {
        struct kd_pending at = walk->stack[--walk->top];
        if (at.enter > t_max)
            continue;
        const struct kd_node *leaf = descend(walk, at);
        walk->leaves++;
        if (leaf->count == 0)
            continue;
        walk->items = walk->tree->items + leaf->place;
        walk->count = (uint32_t)leaf->count;
        return true;
    }
    return false;
}
