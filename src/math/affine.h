/* Affine maps kept with their inverse. A transform is named by its two spaces: world_from_object.forward takes object
 * coordinates to world coordinates, .inverse back. Built by composition, so the inverse is never computed by
 * elimination unless a map comes from outside as a matrix. */
#ifndef GRAY_MATH_AFFINE_H
#define GRAY_MATH_AFFINE_H

#include "math/vec3.h"

#include <stdbool.h>

struct affine {
    double m[3][4]; /* row-major; column 3 is the translation */
};

struct transform {
    struct affine forward, inverse;
};

static inline struct vec3 affine_point(const struct affine *a, struct vec3 p) {
    return (struct vec3){a->m[0][0] * p.x + a->m[0][1] * p.y + a->m[0][2] * p.z + a->m[0][3],
                         a->m[1][0] * p.x + a->m[1][1] * p.y + a->m[1][2] * p.z + a->m[1][3],
                         a->m[2][0] * p.x + a->m[2][1] * p.y + a->m[2][2] * p.z + a->m[2][3]};
}
static inline struct vec3 affine_vector(const struct affine *a, struct vec3 v) {
    return (struct vec3){a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z,
                         a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z,
                         a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z};
}
/* v times the linear part from the left: transforms a normal if `a` is the inverse of the point map. */
static inline struct vec3 affine_transpose_vector(const struct affine *a, struct vec3 v) {
    return (struct vec3){a->m[0][0] * v.x + a->m[1][0] * v.y + a->m[2][0] * v.z,
                         a->m[0][1] * v.x + a->m[1][1] * v.y + a->m[2][1] * v.z,
                         a->m[0][2] * v.x + a->m[1][2] * v.y + a->m[2][2] * v.z};
}

struct affine affine_identity(void);
struct affine affine_compose(const struct affine *outer, const struct affine *inner); /* outer after inner */
double affine_determinant(const struct affine *a);                                    /* of the linear part */

struct transform transform_identity(void);
struct transform transform_compose(const struct transform *outer, const struct transform *inner);
struct transform transform_invert(const struct transform *t);
struct transform transform_translate(struct vec3 by);
struct transform transform_scale(struct vec3 factors); /* factors finite and not 0 */
/* Right-handed turn by `degrees` about axis 0, 1, 2. Multiples of 90 degrees are exact. */
struct transform transform_rotate(int axis, double degrees);
/* Turn about any axis (not zero; Rodrigues' formula). */
struct transform transform_rotate_about(struct vec3 axis, double degrees);
/* The turn of the quaternion w + x i + y j + z k of any length but 0: about {x, y, z} by 2 atan2(|xyz|, w). */
struct transform transform_rotate_quaternion(double w, struct vec3 xyz);
/* The quaternion of a turn, not of unit length; the largest component is computed first (Shepperd, "Quaternion from
 * Rotation Matrix", 1978). */
void affine_quaternion(const struct affine *turn, double xyzw[4]);
/* The largest row sum of absolute values of the linear part: a bound on the growth of any coordinate. */
double transform_stretch(const struct transform *t);
/* Whether all numbers of the map and of its inverse are finite. */
bool transform_is_finite(const struct transform *t);
/* From a matrix; false when it is singular or not finite. */
bool transform_from_affine(const struct affine *forward, struct transform *out);

static inline struct vec3 transform_normal(const struct transform *t, struct vec3 normal) {
    return affine_transpose_vector(&t->inverse, normal); /* not normalised */
}

#endif
