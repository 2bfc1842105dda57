/* A linear RGB colour: light, or what light is multiplied by. Points, directions and normals are struct vec3. By value;
 * evaluation order is as written, as of vectors. */
#ifndef GRAY_MATH_COLOUR_H
#define GRAY_MATH_COLOUR_H

#include "math/portable.h"

#include <math.h>
#include <stdbool.h>

struct colour {
    double r, g, b;
};

static inline struct colour colour_make(double r, double g, double b) {
    return (struct colour){r, g, b};
}
static inline struct colour colour_all(double value) {
    return (struct colour){value, value, value};
}
static inline struct colour colour_add(struct colour a, struct colour b) {
    return (struct colour){a.r + b.r, a.g + b.g, a.b + b.b};
}
static inline struct colour colour_sub(struct colour a, struct colour b) {
    return (struct colour){a.r - b.r, a.g - b.g, a.b - b.b};
}
static inline struct colour colour_mul(struct colour a, struct colour b) {
    return (struct colour){a.r * b.r, a.g * b.g, a.b * b.b};
}
static inline struct colour colour_scale(struct colour a, double s) {
    return (struct colour){a.r * s, a.g * s, a.b * s};
}
/* a + b * s */
static inline struct colour colour_add_scaled(struct colour a, struct colour b, double s) {
    return (struct colour){a.r + b.r * s, a.g + b.g * s, a.b + b.b * s};
}
/* The sum of the products: a mean, if one of them has shares that sum to 1. */
static inline double colour_dot(struct colour a, struct colour b) {
    return a.r * b.r + a.g * b.g + a.b * b.b;
}
static inline struct colour colour_abs(struct colour a) {
    return (struct colour){fabs(a.r), fabs(a.g), fabs(a.b)};
}
static inline double colour_max_abs(struct colour a) {
    double r = fabs(a.r), g = fabs(a.g), b = fabs(a.b), max = r > g ? r : g;
    return max > b ? max : b;
}
/* By comparison, as of vectors. */
static inline struct colour colour_min(struct colour a, struct colour b) {
    return (struct colour){a.r < b.r ? a.r : b.r, a.g < b.g ? a.g : b.g, a.b < b.b ? a.b : b.b};
}
static inline struct colour colour_max(struct colour a, struct colour b) {
    return (struct colour){a.r > b.r ? a.r : b.r, a.g > b.g ? a.g : b.g, a.b > b.b ? a.b : b.b};
}
static inline double colour_get(struct colour a, int channel) {
    return channel == 0 ? a.r : channel == 1 ? a.g : a.b;
}
static inline bool colour_is_black(struct colour a) {
    return a.r == 0 && a.g == 0 && a.b == 0;
}
static inline bool colour_equal(struct colour a, struct colour b) {
    return a.r == b.r && a.g == b.g && a.b == b.b;
}
/* The share of a part in the whole; 0 of black. */
static inline double channel_share(double part, double whole) {
    return whole != 0 ? part / whole : 0;
}
static inline struct colour colour_share(struct colour part, struct colour whole) {
    return (struct colour){channel_share(part.r, whole.r), channel_share(part.g, whole.g),
                           channel_share(part.b, whole.b)};
}
static inline bool colour_finite(struct colour a) {
    return isfinite(a.r) && isfinite(a.g) && isfinite(a.b);
}

#endif
