/* Intervals of a line, for solids that a polynomial of degree two bounds. Along a line it is negative on one interval
 * or outside of one; the limits of the solid are an interval as well. The solid's part of the line is what both have in
 * common: at most two intervals, whose ends are the crossings. So they alternate by construction, caps need no test of
 * their own, and an edge cannot leak.
 *
 * The polynomial is formed about the point of the line nearest to the middle of the shape, so its coefficients have
 * errors of a few last places of the shape's size however far away the ray begins; roots_quadratic adds two more.
 * (Intervals of a line as the way to combine solids: Roth, "Ray casting for modeling solids", 1982.) In a header,
 * because a call would cost as much as the function. */
#ifndef GRAY_SHAPE_SPAN_INTERNAL_H
#define GRAY_SHAPE_SPAN_INTERNAL_H

#include "geometry/crossing.h"
#include "math/roots.h"
#include "math/vec3.h"

struct span_end {
    double t;
    uint32_t part;
};

struct span {
    struct span_end enter, leave;
};

/* Where a t^2 + b t + c is negative, t shifted; at most two spans, whose ends belong to part 0. The touch of two spans
 * is not a gap. */
static inline int negative_spans(double a, double b, double c, double shift, struct span out[2]) {
    const struct span_end begin = {-INFINITY, 0}, end = {INFINITY, 0};
    double roots[2];
    int count = roots_quadratic(a, b, c, roots);
    struct span_end first = {count > 0 ? shift + roots[0] : 0, 0}, second = {count > 1 ? shift + roots[1] : 0, 0};
    if (count == 2 && a > 0) {
        out[0] = (struct span){first, second};
        return first.t < second.t;
    }
    if (count == 2 && first.t < second.t) {
        out[0] = (struct span){begin, first};
        out[1] = (struct span){second, end};
        return 2;
    }
    if (count == 1) {
        bool rising = 2 * a * roots[0] + b > 0;
        out[0] = rising ? (struct span){begin, first} : (struct span){first, end};
        return 1;
    }
    out[0] = (struct span){begin, end};
    return a < 0 || (a == 0 && c < 0);
}

/* The crossings of the solid: spans cut by the limits. */
static inline int closed_crossings(const struct span *spans, int count, const struct span *limits,
                                   struct crossing *out) {
    int found = 0;
    for (int i = 0; i < count; i++) {
        struct span_end enter = limits->enter.t > spans[i].enter.t ? limits->enter : spans[i].enter;
        struct span_end leave = limits->leave.t < spans[i].leave.t ? limits->leave : spans[i].leave;
        if (!(enter.t < leave.t))
            continue;
        out[found++] = (struct crossing){.t = enter.t, .part = enter.part, .enter = true};
        out[found++] = (struct crossing){.t = leave.t, .part = leave.part, .enter = false};
    }
    return found;
}

/* Only the ends that the surface itself makes. */
static inline int open_crossings(const struct span *spans, int count, const struct span *limits, struct crossing *out) {
    int found = 0;
    for (int i = 0; i < count; i++) {
        const double t[2] = {spans[i].enter.t, spans[i].leave.t};
        for (int k = 0; k < 2; k++)
            if (isfinite(t[k]) && t[k] >= limits->enter.t && t[k] <= limits->leave.t)
                out[found++] = (struct crossing){.t = t[k], .enter = k == 0};
    }
    return found;
}

/* The region between two parallel planes, and the parts of the surface in them. */
struct slab {
    double lo, hi;
    uint32_t lo_part, hi_part;
};

/* Cuts the limits by lo < o + t d < hi; false when nothing remains. */
static inline bool cut_by_slab(double o, double d, struct slab slab, struct span *limits) {
    if (d == 0)
        return o > slab.lo && o < slab.hi;
    struct span_end low = {(slab.lo - o) / d, slab.lo_part}, high = {(slab.hi - o) / d, slab.hi_part};
    struct span_end enter = d > 0 ? low : high, leave = d > 0 ? high : low;
    if (enter.t > limits->enter.t)
        limits->enter = enter;
    if (leave.t < limits->leave.t)
        limits->leave = leave;
    return limits->enter.t < limits->leave.t;
}

/* Directions whose squares leave the range of doubles are brought to size by a power of two; t is divided by it. */
static inline double direction_unit(struct vec3 d) {
    double largest = vec3_max_abs(d);
    if (largest > 0x1p-250 && largest < 0x1p250)
        return 1;
    int exponent;
    (void)math_frexp(largest, &exponent);
    return largest > 0 && isfinite(largest) ? math_ldexp(1, exponent > 1000    ? -1000
                                                            : exponent < -1000 ? 1000
                                                                               : -exponent)
                                            : 0;
}

static inline int scale_back(struct crossing *crossings, int count, double unit) {
    for (int i = 0; i < count; i++)
        crossings[i].t *= unit;
    return count;
}

/* 0 where there is no end. */
static inline double middle_of(double lo, double hi) {
    return isfinite(lo) && isfinite(hi) ? lo / 2 + hi / 2 : 0;
}

#endif
