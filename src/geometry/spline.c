/* The usual conversions: Catmull and Rom, "A class of local interpolating splines" (1974); the uniform cubic B-spline
 * by its Bezier points (Farin, "Curves and Surfaces for CAGD", chapter 8). An open B-spline gets its first and last
 * point three times, so that it begins and ends there. */
#include "geometry/spline.h"

#include "geometry/bernstein.h"
#include "math/portable.h"
#include <math.h>
#include <string.h>
static const double *point_at(const struct spline_input *in, int64_t i, double mirrored[4]) {
    int64_t count = in->count;
    if (in->closed)
        return in->points + (i % count + count) % count * in->dimensions;
    if (in->kind == SPLINE_B_SPLINE)
        i = i < 0 ? 0 : i >= count ? count - 1 : i;
    if (i >= 0 && i < count)
        return in->points + i * in->dimensions;
    if (i < 0 && in->before)
        return in->before;
    if (i >= count && in->after)
        return in->after;
    const double *end = in->points + (i < 0 ? 0 : count - 1) * in->dimensions;
    const double *next = in->points + (i < 0 ? 1 : count - 2) * in->dimensions;
    for (int d = 0; d < in->dimensions; d++)
        mirrored[d] = 2 * end[d] - next[d];
    return mirrored;
}

bool spline_build(struct arena *arena, const struct spline_input *in, struct spline_segment **segments, uint32_t *count,
                  struct error *error) {
    uint32_t min = in->closed ? 3 : 2, n = in->closed ? in->count : in->count - 1;
    if (in->kind == SPLINE_BEZIER) {
        if (in->count < 4 - (in->closed ? 1 : 0) || in->count % 3 != (in->closed ? 0 : 1))
            return error_set(error, ERROR_SCENE, "a Bezier spline%s needs 3 n%s points, not %u",
                             in->closed ? " that is closed" : "", in->closed ? "" : " + 1", in->count);
        n = in->count / 3;
    } else if (in->count < min) {
        return error_set(error, ERROR_SCENE, "at least %u points are needed, not %u", min, in->count);
    }
    bool uniform = in->kind == SPLINE_B_SPLINE;
    int64_t start = 0;
    if (uniform && !in->closed) { /* two more segments: the ends are triple points */
        start = -1;
        n += 2;
    }
    struct spline_segment *out = arena_alloc_array(arena, n, sizeof *out);
    if (!out)
        return error_no_memory(error, "a spline");
    for (uint32_t k = 0; k < n; k++) {
        double mirrored[2][4];
        int64_t i = start + k;
        const double *a = point_at(in, i, mirrored[0]), *b = point_at(in, i + 1, mirrored[0]);
        const double *before = NULL, *after = NULL;
        if (in->kind == SPLINE_CATMULL_ROM || uniform) {
            before = point_at(in, i - 1, mirrored[0]);
            after = point_at(in, i + 2, mirrored[1]);
        }
        for (int d = 0; d < in->dimensions; d++) {
            double *out_b = out[k].b[d];
            switch (in->kind) {
            case SPLINE_LINEAR:
                out_b[0] = a[d], out_b[1] = (2 * a[d] + b[d]) / 3, out_b[2] = (a[d] + 2 * b[d]) / 3, out_b[3] = b[d];
                break;
            case SPLINE_CATMULL_ROM:
                out_b[0] = a[d], out_b[1] = a[d] + (b[d] - before[d]) / 6, out_b[2] = b[d] - (after[d] - a[d]) / 6;
                out_b[3] = b[d];
                break;
            case SPLINE_B_SPLINE:
                out_b[0] = (before[d] + 4 * a[d] + b[d]) / 6, out_b[1] = (2 * a[d] + b[d]) / 3;
                out_b[2] = (a[d] + 2 * b[d]) / 3, out_b[3] = (a[d] + 4 * b[d] + after[d]) / 6;
                break;
            case SPLINE_BEZIER:
                for (int j = 0; j < 4; j++)
                    out_b[j] = point_at(in, 3 * (int64_t)k + j, mirrored[0])[d];
                break;
            }
        }
    }
    if (uniform && !in->closed) /* exactly there, without the rounding of (p + 4 p + p) / 6 */
        for (int d = 0; d < in->dimensions; d++) {
            out[0].b[d][0] = in->points[d];
            out[n - 1].b[d][3] = in->points[(size_t)(in->count - 1) * (size_t)in->dimensions + (size_t)d];
        }
    *segments = out;
    *count = n;
    return true;
}

/* A cubic is cut where p' or q' is zero, then halved until its inner Bezier points lie close to its chord. The number
 * of pieces is counted by the same recursion that writes them. */

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
    /* Cut where a coordinate turns, so that each piece is monotonic in both. */
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
    /* Each cut is a share of what is left of the segment. */
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
    /* Counted first, then stored. */
    uint32_t total = out->count;
    out->pieces = arena_alloc_array(arena, total, sizeof *out->pieces);
    if (!out->pieces)
        return error_no_memory(error, "an outline");
    out->count = 0;
    for (uint32_t i = 0; i < count; i++)
        cut(out, true, &segments[i], i, straight);
    /* By the length of the chords, for u. */
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
    double slope[3], stops[4] = {0, 1};
    bernstein_derivative(b, 3, slope);
    int count = 2 + bernstein_roots(slope, 2, stops + 2);
    for (int k = 0; k < count; k++) {
        double value = cubic_value(b, stops[k]);
        *lo = math_min(*lo, value);
        *hi = math_max(*hi, value);
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

void outline_bundle(struct bundle *bundle, void *spline) {
    struct outline *outline = spline;
    BUNDLE(bundle, outline->pieces, outline->count, NULL);
}
