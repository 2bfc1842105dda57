/* See medium.h. */
#include "material/medium.h"

#include "material/fog_cells_internal.h"
#include "material/fog_field.h"
#include "math/elementary.h"

#include <string.h>

/* The law of Beer, Lambert and Bouguer. */
static struct vec3 absorption_transmittance(const struct medium *medium, double distance) {
    struct vec3 a = medium->absorption;
    return (struct vec3){a.x > 0 ? el_exp(-a.x * distance) : 1, a.y > 0 ? el_exp(-a.y * distance) : 1,
                         a.z > 0 ? el_exp(-a.z * distance) : 1};
}

bool medium_transmittance(enum medium_ray kind, const struct fog *fog, const struct ray *ray, double distance,
                          struct medium_effect *out) {
    out->transmittance = vec3_all(1);
    out->source = vec3_all(0);
    if (!medium_affects(kind, fog, ray))
        return false;
    if (ray->media && ray->media->count > 0) {
        out->transmittance = absorption_transmittance(medium_stack_at(ray->media, ray->media->count - 1), distance);
        return true;
    }
    if (fog->clear_sky && distance == INFINITY)
        return false;
    struct vec3 direction = vec3_scale(ray->direction, 1 / vec3_length(ray->direction));
    out->source = fog->colour;
    if (fog->kind == FOG_FIELD) {
        const struct fog_line line = {ray->origin, direction, distance, ray->time};
        out->transmittance = vec3_all(fog_field_transmittance(fog->field, &line, &out->source));
        return true;
    }
    out->transmittance = vec3_all(fog_transmittance(fog, ray->origin, direction, distance));
    return true;
}

/* Beer's law along a straight line, for densities that can be integrated exactly: no steps, no noise. The grid is
 * traversed cell by cell. */

/* exp(-depth); NaN comes from infinity times 0 in unbounded fog: the transmittance is 0. */
static double faded(double depth) {
    return depth <= 0 ? 1 : depth < 1e4 ? el_exp(-depth) : 0;
}

static double height_depth(const struct fog *fog, double y, double climb, double distance) {
    double here = fog->density * el_exp(-(y - fog->base) / fog->scale), k = climb / fog->scale;
    if (here == 0 && k >= 0)
        return 0;
    return k == 0 ? here * distance : here * (-el_expm1(-k * distance) / k);
}

/* Integral of the profile from its first height up to y; below it the sign is negative. */
static double profile_sum(const struct fog *fog, double y) {
    uint32_t last = fog->count - 1, low = 0, high = last;
    if (y <= fog->heights[0])
        return fog->densities[0] > 0 ? fog->densities[0] * (y - fog->heights[0]) : 0;
    if (y >= fog->heights[last])
        return fog->sums[last] + (fog->densities[last] > 0 ? fog->densities[last] * (y - fog->heights[last]) : 0);
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        *(fog->heights[middle] <= y ? &low : &high) = middle;
    }
    double step = y - fog->heights[low], share = step / (fog->heights[high] - fog->heights[low]);
    return fog->sums[low] + step * (fog->densities[low] + 0.5 * share * (fog->densities[high] - fog->densities[low]));
}

static double profile_at(const struct fog *fog, double y) {
    uint32_t i = 0;
    while (i + 1 < fog->count && fog->heights[i + 1] <= y)
        i++;
    if (y <= fog->heights[0] || i + 1 == fog->count)
        return fog->densities[i];
    double share = (y - fog->heights[i]) / (fog->heights[i + 1] - fog->heights[i]);
    return fog->densities[i] + share * (fog->densities[i + 1] - fog->densities[i]);
}

static double profile_depth(const struct fog *fog, double y, double climb, double distance) {
    double end = y + climb * distance, rise = end - y;
    /* Nearly horizontal: the difference of two sums would be noise; the density in the middle is accurate. */
    if (climb == 0 || (isfinite(end) && fabs(rise) <= 0x1p-26 * (fabs(y) + fabs(end)))) {
        double density = profile_at(fog, climb == 0 ? y : y + 0.5 * rise);
        return density > 0 ? density * distance : 0;
    }
    return (profile_sum(fog, end) - profile_sum(fog, y)) / climb;
}

static double grid_depth(const struct fog *fog, struct vec3 o, struct vec3 d, double distance) {
    const struct fog_cells cells = {fog->corner, fog->size, {fog->cells[0], fog->cells[1], fog->cells[2]}};
    struct fog_traversal traversal;
    uint64_t cell;
    double from, to, sum = 0;
    if (!fog_traversal_begin(&traversal, &cells, o, d, distance))
        return 0;
    while (fog_traversal_next(&traversal, &cell, &from, &to))
        sum += fog->densities[cell] * fmax(to - from, 0);
    return sum;
}

double fog_transmittance(const struct fog *fog, struct vec3 origin, struct vec3 direction, double distance) {
    double optical_depth;
    switch (fog->kind) {
    case FOG_EXPONENTIAL:
        return fog->density > 0 ? faded(fog->density * distance) : 1;
    case FOG_SQUARED:
        optical_depth = fog->density * distance;
        return fog->density > 0 ? faded(optical_depth * optical_depth) : 1;
    case FOG_LINEAR:
        if (distance <= fog->near)
            return 1;
        return distance >= fog->far ? 0 : (fog->far - distance) / (fog->far - fog->near);
    case FOG_HEIGHT:
        return faded(height_depth(fog, origin.y, direction.y, distance));
    case FOG_PROFILE:
        return faded(profile_depth(fog, origin.y, direction.y, distance));
    case FOG_GRID:
        return faded(grid_depth(fog, origin, direction, distance));
    case FOG_FIELD: {
        struct vec3 source;
        return fog_field_transmittance(fog->field, &(struct fog_line){origin, direction, distance, 0}, &source);
    }
    }
    return 1;
}

void medium_stack_copy(struct medium_stack *to, const struct medium_stack *from) {
    to->media = from->media;
    to->count = from->count;
    memcpy(to->solids, from->solids, from->count * sizeof *from->solids);
}

static bool vectors_equal(struct vec3 a, struct vec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

bool medium_stacks_equal(const struct medium_stack *a, const struct medium_stack *b) {
    static const struct medium air = {.ior = 1, .tint = {1, 1, 1}};
    const struct medium *x = a->count ? medium_stack_at(a, a->count - 1) : &air,
                        *y = b->count ? medium_stack_at(b, b->count - 1) : &air;
    return x->ior == y->ior && vectors_equal(x->absorption, y->absorption) && vectors_equal(x->tint, y->tint);
}

void medium_stack_enter(struct medium_stack *stack, uint32_t solid) {
    if (stack->count == MEDIUM_STACK_LIMIT) {
        memmove(stack->solids, stack->solids + 1, (MEDIUM_STACK_LIMIT - 1) * sizeof *stack->solids);
        stack->count--;
    }
    stack->solids[stack->count++] = solid;
}

/* One more than the index of the latest entry of the solid's primitive; 0: it has none. */
static uint32_t latest(const struct medium_stack *stack, uint32_t solid) {
    uint32_t i = stack->count;
    if (i == 0)
        return 0;
    const struct solid *solids = stack->media->solids;
    while (i > 0 && solids[stack->solids[i - 1]].primitive != solids[solid].primitive)
        i--;
    return i;
}

bool medium_stack_has(const struct medium_stack *stack, uint32_t solid) {
    return solid != SOLID_NONE && latest(stack, solid) > 0;
}

void medium_stack_leave(struct medium_stack *stack, uint32_t solid) {
    uint32_t end = latest(stack, solid);
    if (end == 0)
        return;
    memmove(stack->solids + end - 1, stack->solids + end, (stack->count - end) * sizeof *stack->solids);
    stack->count--;
}

void medium_stack_cross(struct medium_stack *stack, const struct medium_boundary *boundary) {
    if (boundary->thin)
        return;
    if (boundary->entering)
        medium_stack_enter(stack, boundary->solid);
    else
        medium_stack_leave(stack, boundary->solid);
}

double medium_stack_eta(const struct medium_stack *stack, const struct medium_boundary *boundary) {
    double here = medium_stack_ior(stack);
    if (boundary->entering)
        return here / boundary->ior;
    uint32_t end = latest(stack, boundary->solid);
    /* An open surface seen from behind: the ray is in this medium although it never entered it. */
    if (end == 0)
        return boundary->ior / here;
    if (end < stack->count)
        return 1;
    return here / (end > 1 ? medium_stack_at(stack, end - 2)->ior : 1);
}
