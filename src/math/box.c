/* Mapping by sums of interval ends (Arvo, "Transforming Axis-Aligned Bounding Boxes", Graphics Gems 1990) and
 * clipping by slabs (Kay and Kajiya 1986) with the factor of Ize, "Robust BVH Ray Traversal", JCGT 2013. */
#include "math/box.h"

struct box box_transform(const struct affine *to_from, const struct box *b) {
    if (box_is_empty(b))
        return *b;
    double lo[3], hi[3];
    const double b_lo[3] = {b->min.x, b->min.y, b->min.z}, b_hi[3] = {b->max.x, b->max.y, b->max.z};
    for (int i = 0; i < 3; i++) {
        lo[i] = hi[i] = to_from->m[i][3];
        for (int j = 0; j < 3; j++) {
            double factor = to_from->m[i][j];
            if (factor == 0)
                continue; /* 0 times infinity must not become NaN */
            double p = factor * b_lo[j], q = factor * b_hi[j];
            lo[i] += p < q ? p : q;
            hi[i] += p < q ? q : p;
        }
        /* Opposite infinities: nothing is known about this side. */
        if (isnan(lo[i]))
            lo[i] = -INFINITY;
        if (isnan(hi[i]))
            hi[i] = INFINITY;
    }
    return (struct box){{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

struct box box_pad(struct box b) {
    if (box_is_empty(&b))
        return b;
    double lo = vec3_max_abs(b.min), hi = vec3_max_abs(b.max), largest = lo > hi ? lo : hi;
    if (!isfinite(largest)) {
        largest = 0;
        const double all[6] = {b.min.x, b.min.y, b.min.z, b.max.x, b.max.y, b.max.z};
        for (int i = 0; i < 6; i++) {
            if (isfinite(all[i]) && fabs(all[i]) > largest)
                largest = fabs(all[i]);
        }
    }
    double pad = largest * 0x1p-46;
    return box_grow(b, pad);
}

bool box_clip(const struct box *b, const struct ray *ray, double *t_enter, double *t_exit) {
    double enter = ray->t_min, leave = ray->t_max;
    const double origin[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
    const double direction[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    const double lo[3] = {b->min.x, b->min.y, b->min.z}, hi[3] = {b->max.x, b->max.y, b->max.z};
    for (int i = 0; i < 3; i++) {
        if (direction[i] == 0) {
            if (origin[i] < lo[i] || origin[i] > hi[i])
                return false;
            continue;
        }
        double t0 = (lo[i] - origin[i]) / direction[i], t1 = (hi[i] - origin[i]) / direction[i];
        if (t0 > t1) {
            double swap = t0;
            t0 = t1;
            t1 = swap;
        }
        /* A few units in the last place outwards. */
        t0 -= fabs(t0) * 0x1p-50;
        t1 += fabs(t1) * 0x1p-50;
        if (t0 > enter)
            enter = t0;
        if (t1 < leave)
            leave = t1;
    }
    *t_enter = enter;
    *t_exit = leave;
    return enter <= leave;
}
