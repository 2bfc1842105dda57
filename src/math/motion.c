/* A linear part M is a rotation R times a symmetric stretch S: the polar decomposition, found by Newton's
 * iteration R <- (g R + (g R)^-T) / 2 with the factor g of Higham, "Computing the Polar Decomposition - with
 * Applications", SIAM J. Sci. Stat. Comput. 1986. Stretches with positive eigenvalues are interpolated linearly and
 * never become singular; the rotation turns about one axis at constant speed (Shoemake and Duff, "Matrix Animation and
 * Polar Decomposition", Graphics Interface 1992), so the object never collapses. A mirror image is a rotation times a
 * stretch whose eigenvalues are all negative.
 *
 * Bounds: a point of the box moves on a straight line under the stretch and the translation, so the box of both ends
 * contains its path; under a rotation it leaves the chord between two moments by at most r (1 - cos(angle / 2)). */
#include "math/motion.h"

#include "math/elementary.h"
#include "math/portable.h"

enum { POLAR_STEPS = 40 };

static const double degree = PI / 180;
static const double bounds_step = 5; /* degrees between the moments that bounds look at */

/* --- the two parts of a linear map --- */

static double norm_product(const struct affine *a) {
    double rows = 0, columns = 0;
    for (int i = 0; i < 3; i++) {
        rows = math_max(rows, fabs(a->m[i][0]) + fabs(a->m[i][1]) + fabs(a->m[i][2]));
        columns = math_max(columns, fabs(a->m[0][i]) + fabs(a->m[1][i]) + fabs(a->m[2][i]));
    }
    return rows * columns;
}

/* The rotation of a linear map with positive determinant. */
static struct affine polar_turn(const struct affine *linear) {
    struct affine turn = *linear;
    for (int step = 0; step < POLAR_STEPS; step++) {
        struct transform both;
        if (!transform_from_affine(&turn, &both))
            break;
        double g = sqrt(sqrt(norm_product(&both.inverse) / norm_product(&turn))), change = 0;
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                double next = 0.5 * (g * turn.m[i][j] + both.inverse.m[j][i] / g);
                change = math_max(change, fabs(next - turn.m[i][j]));
                turn.m[i][j] = next;
            }
        }
        /* Entries of a turn are at most 1. The first step removes the scale and gives no information. */
        if (step > 0 && change < 0x1p-50)
            break;
    }
    return turn;
}

static struct affine transposed(const struct affine *a) {
    struct affine out = affine_identity();
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out.m[i][j] = a->m[j][i];
    return out;
}

static struct affine linear_part(const struct affine *a) {
    struct affine out = *a;
    out.m[0][3] = out.m[1][3] = out.m[2][3] = 0;
    return out;
}

static struct affine scaled(const struct affine *a, double factor) {
    struct affine out = *a;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            out.m[i][j] *= factor;
    return out;
}

/* Axis and angle of a rotation. */
static double turn_about(const struct affine *turn, struct vec3 *axis) {
    double q[4];
    affine_quaternion(turn, q);
    /* The shorter one of the two ways around. */
    double sign = q[3] < 0 ? -1 : 1;
    struct vec3 v = {sign * q[0], sign * q[1], sign * q[2]};
    double sine = vec3_length(v);
    *axis = sine > 0 ? vec3_scale(v, 1 / sine) : vec3_make(0, 1, 0);
    return 2 * el_atan2(sine, sign * q[3]) / degree;
}

/* --- motions --- */

struct motion motion_of_velocity(struct vec3 velocity) {
    return (struct motion){.velocity = velocity};
}

struct motion motion_of_spin(const struct transform *pose, struct vec3 velocity, struct vec3 axis, double degrees) {
    return (struct motion){.velocity = velocity, .rest = *pose, .spins = true, .spin_axis = axis, .spin = degrees};
}

bool motion_interpolate(const struct transform *from, const struct transform *to, struct vec3 velocity,
                        struct motion *out) {
    double det0 = affine_determinant(&from->forward), det1 = affine_determinant(&to->forward);
    if (!(det0 * det1 > 0))
        return false;
    double sign = det0 < 0 ? -1 : 1;
    struct affine linear0 = linear_part(&from->forward), linear1 = linear_part(&to->forward);
    struct affine positive0 = scaled(&linear0, sign), positive1 = scaled(&linear1, sign);
    struct affine turn0 = polar_turn(&positive0), turn1 = polar_turn(&positive1);
    struct affine back0 = transposed(&turn0), back1 = transposed(&turn1);
    struct affine stretch0 = affine_compose(&back0, &linear0), stretch1 = affine_compose(&back1, &linear1);
    struct affine has_end = affine_compose(&turn1, &back0);
    *out = (struct motion){.velocity = velocity, .has_end = true, .rest = *from, .first = linear0};
    out->from = vec3_make(from->forward.m[0][3], from->forward.m[1][3], from->forward.m[2][3]);
    out->to = vec3_make(to->forward.m[0][3], to->forward.m[1][3], to->forward.m[2][3]);
    out->degrees = turn_about(&has_end, &out->axis);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            out->change.m[i][j] = stretch1.m[i][j] - stretch0.m[i][j];
    }
    out->change = affine_compose(&turn0, &out->change);
    return true;
}

static double clamped(double time) {
    return time > 0 ? (time < 1 ? time : 1) : 0;
}

/* The first rotation times the stretch at a moment. */
static struct affine stretch_at(const struct motion *motion, double share) {
    struct affine out = motion->first;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out.m[i][j] += share * motion->change.m[i][j];
    return out;
}

static struct vec3 translation_at(const struct motion *motion, double time) {
    struct vec3 by = vec3_scale(motion->velocity, time);
    if (!motion->has_end)
        return by;
    struct vec3 offset = vec3_scale(vec3_sub(motion->to, motion->from), clamped(time));
    return vec3_add(by, vec3_add(motion->from, offset));
}

/* All but the spin. */
static struct transform pose_at(const struct motion *motion, double time) {
    struct transform moved = transform_translate(translation_at(motion, time));
    if (!motion->has_end)
        return motion->spins ? transform_compose(&moved, &motion->rest) : moved;
    double share = clamped(time);
    struct affine linear = stretch_at(motion, share);
    struct transform stretch;
    /* Interpolated stretches of one sign keep that sign; only rounding near the limits of double can fail. */
    if (!transform_from_affine(&linear, &stretch))
        stretch = motion->rest;
    if (motion->degrees > 0) {
        struct transform turn = transform_rotate_about(motion->axis, share * motion->degrees);
        stretch = transform_compose(&turn, &stretch);
    }
    return transform_compose(&moved, &stretch);
}

struct transform motion_at(const struct motion *motion, double time) {
    struct transform pose = pose_at(motion, time);
    if (!motion->spins)
        return pose;
    struct transform spin =
        transform_rotate_about(motion->spin_axis, math_fmod(motion->spin_start + motion->spin * time, 360));
    return transform_compose(&pose, &spin);
}

static bool is_finite(const struct box *box) {
    return vec3_finite(box->min) && vec3_finite(box->max);
}

/* The box of the region that a box covers while it rotates about an axis through the origin. */
static struct box turned_bounds(const struct box *box, struct vec3 axis, double from, double to) {
    double radius = 0;
    for (unsigned i = 0; i < 8; i++)
        radius = math_max(radius, vec3_length(vec3_cross(axis, box_corner(box, i))));
    int steps = 1 + (int)(fabs(to - from) / bounds_step);
    double step = (to - from) / steps, half_sine = el_sin(step * degree / 4);
    double off = radius * 2 * half_sine * half_sine; /* 1 - cos(x) = 2 sin(x / 2)^2 */
    struct box out = box_empty();
    for (int i = 0; i <= steps; i++) {
        struct transform turn = transform_rotate_about(axis, from + i * step);
        out = box_join(out, box_transform(&turn.forward, box));
    }
    out.min = vec3_sub(out.min, vec3_all(off));
    out.max = vec3_add(out.max, vec3_all(off));
    return out;
}

struct box motion_bounds(const struct motion *motion, const struct box *box, struct shutter shutter) {
    struct box out = *box, spun;
    if (box_is_empty(box))
        return out;
    if ((motion->has_end || motion->spins) && !is_finite(box)) {
        out = (struct box){vec3_all(-INFINITY), vec3_all(INFINITY)};
    } else if (motion->spins) {
        double length = vec3_length(motion->spin_axis), from = motion->spin_start + motion->spin * shutter.open;
        double to = motion->spin_start + motion->spin * shutter.close;
        bool whole = fabs(to - from) >= 360;
        spun = turned_bounds(box, vec3_scale(motion->spin_axis, 1 / length), whole ? 0 : from, whole ? 360 : to);
        if (motion->has_end) {
            struct motion still = *motion;
            still.spins = false;
            return motion_bounds(&still, &spun, shutter);
        }
        out = box_transform(&motion->rest.forward, &spun);
    } else if (motion->has_end) {
        double open = clamped(shutter.open), close = clamped(shutter.close);
        struct affine at_open = stretch_at(motion, open), at_close = stretch_at(motion, close);
        out = box_join(box_transform(&at_open, box), box_transform(&at_close, box));
        if (motion->degrees > 0)
            out = turned_bounds(&out, motion->axis, open * motion->degrees, close * motion->degrees);
    }
    struct vec3 low = translation_at(motion, shutter.open), high = low;
    /* A motion between poses begins at 0 and ends at 1: two more corners of the path if the shutter is open then. */
    const double moments[3] = {shutter.close, 0, 1};
    for (int i = 0; i < 3; i++) {
        if (moments[i] >= shutter.open && moments[i] <= shutter.close) {
            struct vec3 by = translation_at(motion, moments[i]);
            low = vec3_min(low, by);
            high = vec3_max(high, by);
        }
    }
    return (struct box){vec3_add(out.min, low), vec3_add(out.max, high)};
}
