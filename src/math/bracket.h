/* Newton's steps in a bracket: taken while they stay inside and shrink by half, else the caller halves the bracket, so
 * that the search ends wherever the slope leads (rtsafe of W. Press et al., "Numerical Recipes", section 9.4). */
#ifndef GRAY_MATH_BRACKET_H
#define GRAY_MATH_BRACKET_H

#include <math.h>
#include <stdbool.h>

struct bracket {
    double lo, hi;    /* the function has different signs there */
    double x, next;   /* in the bracket, and where the step leads */
    double step;      /* from next to x */
    double last_step; /* at first hi - lo */
    bool rising;      /* it is positive at hi */
};

/* Makes the bracket smaller by the value at x, which is not 0, and computes Newton's step. False: the step leaves the
 * bracket, or is more than half the last one (a slope of 0, an infinity or a NaN). */
static inline bool bracket_newton(struct bracket *b, double value, double slope) {
    if ((value > 0) == b->rising)
        b->hi = b->x;
    else
        b->lo = b->x;
    b->step = value / slope;
    b->next = b->x - b->step;
    return b->next > b->lo && b->next < b->hi && fabs(b->step) <= 0.5 * b->last_step;
}

/* In place of that step one to `middle`. False: that is an end of the bracket. */
static inline bool bracket_halve(struct bracket *b, double middle) {
    b->next = middle;
    b->step = b->x - middle;
    return middle != b->lo && middle != b->hi;
}

static inline void bracket_move(struct bracket *b) {
    b->last_step = fabs(b->step);
    b->x = b->next;
}

#endif
