/* A cubic is cut where p' or q' is zero, then halved until its inner Bezier points lie close to its chord. The number
 * of pieces is counted by the same recursion that writes them. */
#include "geom/outline.h"

#include "geom/bernstein.h"

#include <math.h>
#include <string.h>

enum { DEEPEST = 10 };
#define FLAT 0.12 /* distance of the inner points from the chord over its length: turns of about 45 degrees */

static void emit(struct outline *out, bool write, const struct outline_piece *piece) {
    if (piece->p[0] == piece->p[3] && piece->q[0] == piece->q[3])
        return;
    if (write)
        out->pieces[out->count] = *piece;
    out->count++;
}

static bool is_flat(const struct outline_piece *c) {
    double dp = c->p[3] - c->p[0], dq = c->q[3] - c->q[0], length = sqrt(dp * dp + dq * dq);
    for (int i = 1; i <= 2; i++)
        if (!(fabs(dp * (c->q[i] - c->q[0]) - dq * (c->p[i] - c->p[0])) <= FLAT * length * length))
            return false;
    return true;
}

static void halve(struct outline *out, bool write, const struct outline_piece *piece, int depth) {
    if (depth == DEEPEST || is_flat(piece)) {
        emit(out, write, piece);
        return;
    }
    struct outline_piece left = *piece, right = *piece;
    bernstein_split(piece->p, 3, 0.5, left.p, right.p);
    bernstein_split(piece->q, 3, 0.5, left.q, right.q);
    halve(out, write, &left, depth + 1);
    halve(out, write, &right, depth + 1);
}

static void cut(struct outline *out, bool write, const struct spline_segment *segment, uint32_t index, bool straight) {
    struct outline_piece piece = {.segment = index, .straight = straight};
    memcpy(piece.p, segment->b[0], sizeof piece.p);
    memcpy(piece.q, segment->b[1], sizeof piece.q);
    if (straight) {
        emit(out, write, &piece);
        return;
    }
    double cuts[5], slope[3];
    int cut_count = 0;
    bernstein_derivative(piece.p, 3, slope);
    cut_count += bernstein_roots(slope, 2, cuts);
    bernstein_derivative(piece.q, 3, slope);
    cut_count += bernstein_roots(slope, 2, cuts + cut_count);
    for (int i = 1; i < cut_count; i++) {
        double moved = cuts[i];
        int j = i;
        for (; j > 0 && moved < cuts[j - 1]; j--)
            cuts[j] = cuts[j - 1];
        cuts[j] = moved;
    }
    double done = 0;
    for (int i = 0; i < cut_count; i++) {
        double x = (cuts[i] - done) / (1 - done);
        if (!(x > 0x1p-30 && x < 1 - 0x1p-30))
            continue;
        struct outline_piece left = piece, right = piece;
        bernstein_split(piece.p, 3, x, left.p, right.p);
        bernstein_split(piece.q, 3, x, left.q, right.q);
        halve(out, write, &left, 0);
        piece = right;
        done = cuts[i];
    }
    halve(out, write, &piece, 0);
}

bool outline_build(struct arena *arena, const struct spline_segment *segments, uint32_t count, bool straight,
                   struct outline *out, struct error *error) {
    *out = (struct outline){0};
    for (uint32_t i = 0; i < count; i++)
        cut(out, false, &segments[i], i, straight);
    uint32_t total = out->count;
    out->pieces = arena_alloc_array(arena, total, sizeof *out->pieces);
    if (!out->pieces)
        return error_no_memory(error, "an outline");
    out->count = 0;
    for (uint32_t i = 0; i < count; i++)
        cut(out, true, &segments[i], i, straight);
    for (uint32_t i = 0; i < total; i++) {
        struct outline_piece *c = &out->pieces[i];
        double dp = c->p[3] - c->p[0], dq = c->q[3] - c->q[0];
        c->from = out->length;
        out->length += sqrt(dp * dp + dq * dq);
        c->to = out->length;
    }
    for (uint32_t i = 0; i < total; i++) {
        out->pieces[i].from /= out->length;
        out->pieces[i].to /= out->length;
    }
    return true;
}

void outline_range(const double b[4], double *lo, double *hi) {
    double slope[3], places[4] = {0, 1};
    bernstein_derivative(b, 3, slope);
    int count = 2 + bernstein_roots(slope, 2, places + 2);
    for (int k = 0; k < count; k++) {
        double value = cubic_value(b, places[k]);
        *lo = fmin(*lo, value);
        *hi = fmax(*hi, value);
    }
}

void outline_tangent(const struct outline_piece *c, double x, double *dp, double *dq) {
    *dp = cubic_slope(c->p, x);
    *dq = cubic_slope(c->q, x);
    double p = c->p[3] - c->p[0], q = c->q[3] - c->q[0];
    if (c->straight || !(fabs(*dp) + fabs(*dq) > 0x1p-40 * (fabs(p) + fabs(q)))) {
        *dp = p;
        *dq = q;
    }
}
