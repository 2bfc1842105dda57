/* Affine maps. Rotations by multiples of 90 degrees use exact sines; others use math/elementary.h. */
#include "math/affine.h"

#include "math/elementary.h"
#include "math/portable.h"

struct affine affine_identity(void) {
    return (struct affine){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
}

struct affine affine_compose(const struct affine *outer, const struct affine *inner) {
    struct affine out;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            out.m[i][j] = outer->m[i][0] * inner->m[0][j] + outer->m[i][1] * inner->m[1][j] +
                          outer->m[i][2] * inner->m[2][j] + (j == 3 ? outer->m[i][3] : 0);
        }
    }
    return out;
}

double affine_determinant(const struct affine *a) {
    return a->m[0][0] * (a->m[1][1] * a->m[2][2] - a->m[1][2] * a->m[2][1]) -
           a->m[0][1] * (a->m[1][0] * a->m[2][2] - a->m[1][2] * a->m[2][0]) +
           a->m[0][2] * (a->m[1][0] * a->m[2][1] - a->m[1][1] * a->m[2][0]);
}

struct transform transform_identity(void) {
    return (struct transform){affine_identity(), affine_identity()};
}

struct transform transform_compose(const struct transform *outer, const struct transform *inner) {
    return (struct transform){affine_compose(&outer->forward, &inner->forward),
                              affine_compose(&inner->inverse, &outer->inverse)};
}

struct transform transform_invert(const struct transform *t) {
    return (struct transform){t->inverse, t->forward};
}

struct transform transform_translate(struct vec3 by) {
    struct transform out = transform_identity();
    out.forward.m[0][3] = by.x;
    out.forward.m[1][3] = by.y;
    out.forward.m[2][3] = by.z;
    out.inverse.m[0][3] = -by.x;
    out.inverse.m[1][3] = -by.y;
    out.inverse.m[2][3] = -by.z;
    return out;
}

struct transform transform_scale(struct vec3 factors) {
    struct transform out = transform_identity();
    out.forward.m[0][0] = factors.x;
    out.forward.m[1][1] = factors.y;
    out.forward.m[2][2] = factors.z;
    out.inverse.m[0][0] = 1 / factors.x;
    out.inverse.m[1][1] = 1 / factors.y;
    out.inverse.m[2][2] = 1 / factors.z;
    return out;
}

static void sine_cosine(double degrees, double *sine, double *cosine) {
    double turned = math_fmod(degrees, 360); /* exact */
    double quarters = turned / 90;
    if (quarters == floor(quarters)) {
        static const double table[4] = {0, 1, 0, -1};
        int k = ((int)quarters + 4) & 3;
        *sine = table[k];
        *cosine = table[(k + 1) & 3];
        return;
    }
    el_sincos(turned * (PI / 180), sine, cosine);
}

struct transform transform_rotate(int axis, double degrees) {
    double s, c;
    sine_cosine(degrees, &s, &c);
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    struct transform out = transform_identity();
    out.forward.m[a][a] = c;
    out.forward.m[a][b] = -s;
    out.forward.m[b][a] = s;
    out.forward.m[b][b] = c;
    out.inverse.m[a][a] = c;
    out.inverse.m[a][b] = s;
    out.inverse.m[b][a] = -s;
    out.inverse.m[b][b] = c;
    return out;
}

struct transform transform_rotate_about(struct vec3 axis, double degrees) {
    double s, c;
    sine_cosine(degrees, &s, &c);
    struct vec3 k = vec3_normalize(axis);
    double n = 1 - c;
    struct transform out = transform_identity();
    out.forward = (struct affine){{{c + k.x * k.x * n, k.x * k.y * n - k.z * s, k.x * k.z * n + k.y * s, 0},
                                   {k.y * k.x * n + k.z * s, c + k.y * k.y * n, k.y * k.z * n - k.x * s, 0},
                                   {k.z * k.x * n - k.y * s, k.z * k.y * n + k.x * s, c + k.z * k.z * n, 0}}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            out.inverse.m[i][j] = out.forward.m[j][i];
    }
    return out;
}

/* Euler and Rodrigues; W. R. Hamilton, "On Quaternions", 1844. Divided by the square of the length, so that the length
 * of q does not matter. */
struct transform transform_rotate_quaternion(double w, struct vec3 v) {
    double max = math_max(fabs(w), vec3_max_abs(v));
    int exponent;
    (void)math_frexp(max, &exponent);
    w = math_ldexp(w, -exponent);
    v = vec3_make(math_ldexp(v.x, -exponent), math_ldexp(v.y, -exponent), math_ldexp(v.z, -exponent));
    double s = 2 / (w * w + vec3_dot(v, v));
    struct transform out = transform_identity();
    out.forward =
        (struct affine){{{1 - s * (v.y * v.y + v.z * v.z), s * (v.x * v.y - w * v.z), s * (v.x * v.z + w * v.y), 0},
                         {s * (v.x * v.y + w * v.z), 1 - s * (v.x * v.x + v.z * v.z), s * (v.y * v.z - w * v.x), 0},
                         {s * (v.x * v.z - w * v.y), s * (v.y * v.z + w * v.x), 1 - s * (v.x * v.x + v.y * v.y), 0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out.inverse.m[i][j] = out.forward.m[j][i];
    return out;
}

void affine_quaternion(const struct affine *turn, double xyzw[4]) {
    const double(*m)[4] = turn->m;
    double trace = m[0][0] + m[1][1] + m[2][2], largest = trace;
    int k = 3;
    for (int i = 0; i < 3; i++) {
        if (m[i][i] > largest) {
            largest = m[i][i];
            k = i;
        }
    }
    if (k == 3) {
        xyzw[3] = 1 + trace;
        xyzw[0] = m[2][1] - m[1][2];
        xyzw[1] = m[0][2] - m[2][0];
        xyzw[2] = m[1][0] - m[0][1];
    } else {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        xyzw[k] = 1 + m[k][k] - m[a][a] - m[b][b];
        xyzw[a] = m[a][k] + m[k][a];
        xyzw[b] = m[b][k] + m[k][b];
        xyzw[3] = m[b][a] - m[a][b];
    }
}

double transform_stretch(const struct transform *t) {
    double stretch = 0;
    for (int i = 0; i < 3; i++) {
        const double *row = t->forward.m[i];
        stretch = math_max(stretch, fabs(row[0]) + fabs(row[1]) + fabs(row[2]));
    }
    return stretch;
}

bool transform_is_finite(const struct transform *t) {
    double sum = 0; /* 0 times infinity or NaN is NaN */
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            sum += 0 * t->forward.m[i][j] + 0 * t->inverse.m[i][j];
    return sum == 0;
}

bool transform_from_affine(const struct affine *forward, struct transform *out) {
    double determinant = affine_determinant(forward);
    if (!isfinite(determinant) || determinant == 0)
        return false;
    const double(*m)[4] = forward->m;
    out->forward = *forward;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            out->inverse.m[i][j] = (m[a][c] * m[b][d] - m[a][d] * m[b][c]) / determinant;
        }
        out->inverse.m[i][3] = 0;
    }
    /* The inverse undoes the translation first. */
    struct vec3 moved = affine_vector(&out->inverse, vec3_make(m[0][3], m[1][3], m[2][3]));
    out->inverse.m[0][3] = -moved.x;
    out->inverse.m[1][3] = -moved.y;
    out->inverse.m[2][3] = -moved.z;
    /* A tiny determinant may leave the range of doubles. */
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            if (!isfinite(out->inverse.m[i][j]))
                return false;
        }
    }
    return true;
}
