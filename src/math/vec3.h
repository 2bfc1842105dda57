/* Three numbers: a point, a direction or a normal; colours are struct colour. By value; evaluation order is as written,
 * so results are the same on every processor (build with -ffp-contract=off). */
#ifndef GRAY_MATH_VEC3_H
#define GRAY_MATH_VEC3_H

#include "math/portable.h"

#include <math.h>
#include <stdbool.h>

struct vec3 {
    double x, y, z;
};

static inline struct vec3 vec3_make(double x, double y, double z) {
    return (struct vec3){x, y, z};
}
static inline struct vec3 vec3_all(double value) {
    return (struct vec3){value, value, value};
}
static inline struct vec3 vec3_add(struct vec3 a, struct vec3 b) {
    return (struct vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline struct vec3 vec3_sub(struct vec3 a, struct vec3 b) {
    return (struct vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline struct vec3 vec3_mul(struct vec3 a, struct vec3 b) {
    return (struct vec3){a.x * b.x, a.y * b.y, a.z * b.z};
}
static inline struct vec3 vec3_scale(struct vec3 a, double s) {
    return (struct vec3){a.x * s, a.y * s, a.z * s};
}
static inline struct vec3 vec3_negate(struct vec3 a) {
    return (struct vec3){-a.x, -a.y, -a.z};
}
/* a + b * s */
static inline struct vec3 vec3_add_scaled(struct vec3 a, struct vec3 b, double s) {
    return (struct vec3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}
static inline double vec3_dot(struct vec3 a, struct vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline struct vec3 vec3_cross(struct vec3 a, struct vec3 b) {
    return (struct vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline double vec3_length_squared(struct vec3 a) {
    return vec3_dot(a, a);
}
static inline double vec3_max_abs(struct vec3 a) {
    double x = fabs(a.x), y = fabs(a.y), z = fabs(a.z), max = x > y ? x : y;
    return max > z ? max : z;
}
/* By comparison, which is one instruction; math_min and math_max also look for NaN. */
static inline struct vec3 vec3_min(struct vec3 a, struct vec3 b) {
    return (struct vec3){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
static inline struct vec3 vec3_max(struct vec3 a, struct vec3 b) {
    return (struct vec3){a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}
static inline double vec3_get(struct vec3 a, int axis) {
    return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}
static inline bool vec3_finite(struct vec3 a) {
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}
/* The exponent scaling keeps lengths of 1e-200 or 1e200 from under- and overflowing; it is exact. */
static inline double vec3_length(struct vec3 a) {
    double squared = vec3_dot(a, a);
    if (squared > 0x1p-900 && squared < 0x1p900)
        return sqrt(squared);
    double largest = vec3_max_abs(a);
    if (!(largest > 0) || !isfinite(largest))
        return largest;
    int exponent;
    (void)math_frexp(largest, &exponent);
    struct vec3 b = {math_ldexp(a.x, -exponent), math_ldexp(a.y, -exponent), math_ldexp(a.z, -exponent)};
    return math_ldexp(sqrt(vec3_dot(b, b)), exponent);
}
/* Unit vector of the same direction; the zero vector stays zero. Powers of two in the length do not change the
 * result. */
static inline struct vec3 vec3_normalize(struct vec3 a) {
    double length = vec3_length(a);
    if (!(length > 0) || !isfinite(length))
        return a;
    return (struct vec3){a.x / length, a.y / length, a.z / length};
}

#endif
