/* Roots in Bernstein form. The number of sign changes among the coefficients is the number of roots in (0, 1), or more
 * by an even number (Descartes; Lane and Riesenfeld, "Bounds on a polynomial", BIT 1981). None: no root. One: exactly
 * one, which is bracketed and found by Newton's steps inside the bracket. More: de Casteljau halves the interval.
 * Halving stops if the piece is too short or the coefficients are only rounding errors: then only the signs at the ends
 * count. The sign at a midpoint is computed once and used by both halves, hence the parity. */
#include "geometry/bernstein.h"

#include "math/bracket.h"
#include "math/portable.h"

#include <math.h>
#include <stdbool.h>

enum { DEEPEST = 30 };
#define NOISE 0x1p-50

static const double binomial[BERNSTEIN_MAX_DEGREE + 1][BERNSTEIN_MAX_DEGREE + 1] = {
    {1},
    {1, 1},
    {1, 2, 1},
    {1, 3, 3, 1},
    {1, 4, 6, 4, 1},
    {1, 5, 10, 10, 5, 1},
    {1, 6, 15, 20, 15, 6, 1},
    {1, 7, 21, 35, 35, 21, 7, 1},
    {1, 8, 28, 56, 70, 56, 28, 8, 1},
    {1, 9, 36, 84, 126, 126, 84, 36, 9, 1},
    {1, 10, 45, 120, 210, 252, 210, 120, 45, 10, 1},
    {1, 11, 55, 165, 330, 462, 462, 330, 165, 55, 11, 1},
    {1, 12, 66, 220, 495, 792, 924, 792, 495, 220, 66, 12, 1},
};

/* Value and slope by de Casteljau's scheme. */
static double value_and_slope(const double *b, int degree, double x, double *slope) {
    double c[BERNSTEIN_MAX_DEGREE + 1];
    double y = 1 - x;
    for (int i = 0; i <= degree; i++)
        c[i] = b[i];
    for (int n = degree; n > 1; n--)
        for (int i = 0; i < n; i++)
            c[i] = y * c[i] + x * c[i + 1];
    if (degree == 0) {
        *slope = 0;
        return c[0];
    }
    *slope = degree * (c[1] - c[0]);
    return y * c[0] + x * c[1];
}

double bernstein_value(const double *b, int degree, double x) {
    double slope;
    return value_and_slope(b, degree, x, &slope);
}

void bernstein_split(const double *b, int degree, double x, double *left, double *right) {
    double y = 1 - x;
    for (int i = 0; i <= degree; i++)
        right[i] = b[i];
    left[0] = right[0];
    for (int n = degree; n > 0; n--) {
        for (int i = 0; i < n; i++)
            right[i] = y * right[i] + x * right[i + 1];
        left[degree + 1 - n] = right[0];
    }
}

void bernstein_multiply(const double *a, int m, const double *b, int n, double *out) {
    for (int k = 0; k <= m + n; k++)
        out[k] = 0;
    for (int i = 0; i <= m; i++)
        for (int j = 0; j <= n; j++)
            out[i + j] += binomial[m][i] * a[i] * (binomial[n][j] * b[j]);
    for (int k = 0; k <= m + n; k++)
        out[k] /= binomial[m + n][k];
}

void bernstein_derivative(const double *b, int degree, double *out) {
    for (int i = 0; i < degree; i++)
        out[i] = degree * (b[i + 1] - b[i]);
}

/* The one root in (0, 1); b[0] and b[degree] differ in sign. */
static double bracketed_root(const double *b, int degree) {
    if (degree == 1)
        return b[0] / (b[0] - b[1]);
    /* Does not start at an end: it may be a zero that counts as positive, with the root elsewhere. */
    struct bracket at = {.lo = 0, .hi = 1, .last_step = 1, .rising = b[0] < 0};
    at.x = math_min(math_max(fabs(b[0]) / (fabs(b[0]) + fabs(b[degree])), 0.0625), 0.9375);
    for (int i = 0; i < 100; i++) {
        double slope, value = value_and_slope(b, degree, at.x, &slope);
        if (value == 0)
            return at.x;
        bool good = bracket_newton(&at, value, slope);
        if (fabs(at.step) < 0x1p-54) /* no further improvement */
            return at.next > at.lo && at.next < at.hi ? at.next : at.x;
        if (!good && (!bracket_halve(&at, 0.5 * (at.lo + at.hi)) || at.hi - at.lo < 0x1p-54))
            return at.x;
        bracket_move(&at);
    }
    return at.x;
}

static int sign_changes(const double *b, int degree) {
    int changes = 0;
    for (int i = 0; i < degree; i++)
        changes += (b[i] < 0) != (b[i + 1] < 0);
    return changes;
}

int bernstein_roots(const double *b, int degree, double *out) {
    int changes = sign_changes(b, degree);
    if (changes == 0)
        return 0;
    if (changes == 1) {
        out[0] = bracketed_root(b, degree);
        return 1;
    }
    struct piece {
        double b[BERNSTEIN_MAX_DEGREE + 1], lo, width;
        int depth;
    } stack[DEEPEST + 2];
    double scale = 0;
    for (int i = 0; i <= degree; i++) {
        stack[0].b[i] = b[i];
        scale = math_max(scale, fabs(b[i]));
    }
    stack[0].lo = 0;
    stack[0].width = 1;
    stack[0].depth = 0;
    int depth = 1, count = 0;
    while (depth > 0) {
        struct piece piece = stack[--depth];
        changes = sign_changes(piece.b, degree);
        if (changes == 0)
            continue;
        double root = 0.5;
        if (changes > 1) {
            double largest = 0;
            for (int i = 0; i <= degree; i++)
                largest = math_max(largest, fabs(piece.b[i]));
            if (piece.depth < DEEPEST && largest > NOISE * scale) {
                struct piece *right = &stack[depth], *left = &stack[depth + 1];
                bernstein_split(piece.b, degree, 0.5, left->b, right->b);
                left->lo = piece.lo;
                left->width = right->width = piece.width / 2;
                right->lo = piece.lo + right->width;
                left->depth = right->depth = piece.depth + 1;
                depth += 2;
                continue;
            }
            if ((piece.b[0] < 0) == (piece.b[degree] < 0))
                continue;
        } else {
            root = bracketed_root(piece.b, degree);
        }
        if (count == degree) { /* rounding produced a pair: drop it, which keeps the parity */
            count--;
            continue;
        }
        out[count++] = piece.lo + piece.width * root;
    }
    return count;
}
