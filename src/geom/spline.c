/* The usual conversions: Catmull and Rom, "A class of local interpolating splines" (1974); the uniform cubic B-spline
 * by its Bezier points (Farin, "Curves and Surfaces for CAGD", chapter 8). An open B-spline gets its first and last
 * point three times, so that it begins and ends there. */
#include "geom/spline.h"

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
    uint32_t least = in->closed ? 3 : 2, n = in->closed ? in->count : in->count - 1;
    if (in->kind == SPLINE_BEZIER) {
        if (in->count < 4 - (in->closed ? 1 : 0) || in->count % 3 != (in->closed ? 0 : 1))
            return error_set(error, ERROR_SCENE, "a Bezier spline%s needs 3 n%s points, not %u",
                             in->closed ? " that is closed" : "", in->closed ? "" : " + 1", in->count);
        n = in->count / 3;
    } else if (in->count < least) {
        return error_set(error, ERROR_SCENE, "at least %u points are needed, not %u", least, in->count);
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
    if (uniform && !in->closed) /* exactly there, whatever (p + 4 p + p) / 6 rounds to */
        for (int d = 0; d < in->dimensions; d++) {
            out[0].b[d][0] = in->points[d];
            out[n - 1].b[d][3] = in->points[(size_t)(in->count - 1) * (size_t)in->dimensions + (size_t)d];
        }
    *segments = out;
    *count = n;
    return true;
}
