/* See beam.h; as in Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005. A box lies outside
 * of the beam when its corner nearest to one of the planes is outside. Slopes are widened by 2^-40, which is far more
 * than rounding moves anything that is not about the origin itself; slack is for that. */
#include "accel/beam.h"

bool beam_make(struct beam *out, const struct ray_packet *rays) {
    const double first[3] = {fabs(rays->direction[0][0]), fabs(rays->direction[1][0]), fabs(rays->direction[2][0])};
    int z = first[1] > first[0];
    z = first[2] > first[z] ? 2 : z;
    out->forward = z;
    out->side[0] = (z + 1) % 3;
    out->side[1] = (z + 2) % 3;
    out->backwards = rays->direction[z][0] < 0;
    double min = INFINITY, max = 0, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    double sign = out->backwards ? -1 : 1;
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
    double spread = fmax(fmax(-low[0], high[0]), fmax(-low[1], high[1]));
    if (!(min > 0 && max < 0x1p900 && min > 0x1p-900 && spread < 0x1p5))
        return false;
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

/* Which children the beam meets, and how far ahead each begins. A NaN, of infinite sides, is never outside. */
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
            /* What ends first comes first, as in box_tree_traversal_next. */
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
