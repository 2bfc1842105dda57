/* Bicubic patches. A patch of n x n equal steps is off the surface by at most (M1 + 2 M2 + M3) / (8 n^2), M being
 * bounds of the second derivatives (Filip, Magedson, Markot, "Surface algorithms using bounds on derivatives", CAGD
 * 1986), which the differences of the control points give. All patches take the largest n, and a border is evaluated
 * from its own four points, the same bits in either direction: the weights of a place i of n are (n - i) / n and i / n,
 * whose roles change when the border is run backwards, and every sum is of two terms. So common borders give the same
 * vertices, and vertices are found again by their bits. */
#include "mesh/patch.h"

#include <math.h>
#include <string.h>

enum { FINEST = 1024 };
#define MAX_CELLS 8.0e6

static struct vec3 point_of(const double (*points)[3], int i) {
    return vec3_make(points[i][0], points[i][1], points[i][2]);
}

/* Weights (n - i) / n and i / n applied to two points; exchanging both points and weights changes nothing. */
static struct vec3 mix(struct vec3 a, struct vec3 b, double wa, double wb) {
    return vec3_add(vec3_scale(a, wa), vec3_scale(b, wb));
}

/* de Casteljau; *slope is a third of the derivative. */
static struct vec3 curve_point(const struct vec3 c[4], double wa, double wb, struct vec3 *slope) {
    struct vec3 p = mix(c[0], c[1], wa, wb), q = mix(c[1], c[2], wa, wb), r = mix(c[2], c[3], wa, wb);
    struct vec3 s = mix(p, q, wa, wb), t = mix(q, r, wa, wb);
    *slope = vec3_sub(t, s);
    return mix(s, t, wa, wb);
}

static double second(struct vec3 a, struct vec3 b, struct vec3 c) {
    return vec3_length(vec3_add(vec3_sub(a, b), vec3_sub(c, b)));
}

/* Steps that one patch needs. */
static double steps_needed(const double (*points)[3], double tolerance) {
    double uu = 0, vv = 0, uv = 0;
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++) {
            struct vec3 p = point_of(points, 4 * j + i);
            if (i < 2)
                uu = math_max(uu, second(p, point_of(points, 4 * j + i + 1), point_of(points, 4 * j + i + 2)));
            if (j < 2)
                vv = math_max(vv, second(p, point_of(points, 4 * j + i + 4), point_of(points, 4 * j + i + 8)));
            if (i < 3 && j < 3)
                uv = math_max(uv, vec3_length(vec3_add(
                                      vec3_sub(p, point_of(points, 4 * j + i + 1)),
                                      vec3_sub(point_of(points, 4 * j + i + 5), point_of(points, 4 * j + i + 4)))));
        }
    return sqrt((6 * uu + 2 * 9 * uv + 6 * vv) / (8 * tolerance));
}

/* Position and normal at (i, j) of n steps. */
static struct vec3 patch_point(const double (*points)[3], uint32_t i, uint32_t j, uint32_t n, struct vec3 *normal) {
    double ua = (double)(n - i) / n, ub = (double)i / n, va = (double)(n - j) / n, vb = (double)j / n;
    struct vec3 along_u[4], along_v[4], row[4], column[4], du, dv, unused;
    for (int k = 0; k < 4; k++) {
        for (int m = 0; m < 4; m++) {
            row[m] = point_of(points, 4 * k + m);
            column[m] = point_of(points, 4 * m + k);
        }
        along_v[k] = curve_point(row, ua, ub, &unused);    /* a curve in v */
        along_u[k] = curve_point(column, va, vb, &unused); /* a curve in u */
    }
    struct vec3 by_v = curve_point(along_v, va, vb, &dv), by_u = curve_point(along_u, ua, ub, &du);
    *normal = vec3_cross(du, dv);
    /* On the borders u = 0 and u = 1 the curve in v has the border's own points, on the others the curve in u has. */
    return i == 0 || i == n ? by_v : by_u;
}

/* A border that is one point has no normal: the normal slightly further inside replaces it. */
static struct vec3 patch_normal(const double (*points)[3], uint32_t i, uint32_t j, uint32_t n) {
    struct vec3 normal;
    patch_point(points, i, j, n, &normal);
    double size = 0;
    for (int k = 1; k < 16; k++)
        size = math_max(size, vec3_length(vec3_sub(point_of(points, k), point_of(points, 0))));
    if (vec3_length(normal) > 0x1p-40 * size * size)
        return normal;
    const uint32_t fine = 4096;
    uint32_t fi = i * (fine / 2) / n * 2, fj = j * (fine / 2) / n * 2;
    fi = fi < 2 ? 2 : fi > fine - 2 ? fine - 2 : fi;
    fj = fj < 2 ? 2 : fj > fine - 2 ? fine - 2 : fj;
    patch_point(points, fi, fj, fine, &normal);
    return normal;
}

/* Vertices by their bits, open addressing. */
struct weld {
    double (*vertices)[3];
    uint32_t count;
    uint32_t *table; /* vertex + 1, or 0 */
    uint32_t mask;
};

static uint32_t weld_vertex(struct weld *weld, struct vec3 p) {
    const double v[3] = {p.x + 0.0, p.y + 0.0, p.z + 0.0}; /* no negative zeros */
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        uint64_t bits;
        memcpy(&bits, &v[k], sizeof bits);
        hash = (hash ^ bits) * UINT64_C(0x9e3779b97f4a7c15);
        hash ^= hash >> 29;
    }
    for (uint32_t at = (uint32_t)hash & weld->mask;; at = (at + 1) & weld->mask) {
        uint32_t found = weld->table[at];
        if (found == 0) {
            memcpy(weld->vertices[weld->count], v, sizeof v);
            weld->table[at] = ++weld->count;
            return weld->count - 1;
        }
        if (memcmp(weld->vertices[found - 1], v, sizeof v) == 0)
            return found - 1;
    }
}

bool patch_tessellate(struct arena *arena, const struct patch_input *in, struct mesh_input *out, struct error *error) {
    struct vec3 lo = vec3_all(INFINITY), hi = vec3_all(-INFINITY);
    if (in->count == 0)
        return error_set(error, ERROR_SCENE, "%s: there are no patches", in->name);
    for (size_t i = 0; i < (size_t)in->count * 16; i++) {
        struct vec3 p = vec3_make(in->points[i][0], in->points[i][1], in->points[i][2]);
        if (!(vec3_max_abs(p) < 0x1p300) || !vec3_finite(p))
            return error_set(error, ERROR_SCENE, "%s: point %zu of patch %zu is not a usable number", in->name,
                             i % 16 + 1, i / 16 + 1);
        lo = vec3_min(lo, p);
        hi = vec3_max(hi, p);
    }
    double size = vec3_length(vec3_sub(hi, lo)), tolerance = in->tolerance > 0 ? in->tolerance : size / 1000, steps = 1;
    if (!(size > 0))
        return error_set(error, ERROR_SCENE, "%s: all points of the patches are the same", in->name);
    for (uint32_t k = 0; k < in->count; k++)
        steps = math_max(steps, steps_needed(in->points + 16 * (size_t)k, tolerance));
    steps = ceil(steps);
    if (!(steps <= FINEST && steps * steps * in->count <= MAX_CELLS))
        return error_set(error, ERROR_SCENE,
                         "%s: a tolerance of %g would cut each of %u patches into %.0f x %.0f cells; that is too many",
                         in->name, tolerance, in->count, steps, steps);
    uint32_t n = (uint32_t)steps, side = n + 1, per_patch = side * side, cells = n * n;
    size_t total = (size_t)per_patch * in->count, faces = (size_t)cells * 2 * in->count;
    uint32_t capacity = 64;
    while (capacity < 2 * total)
        capacity *= 2;
    struct weld weld = {.vertices = arena_alloc_array(arena, total, sizeof *weld.vertices),
                        .table = arena_alloc_array(arena, capacity, sizeof *weld.table),
                        .mask = capacity - 1};
    double(*normals)[3] = arena_alloc_array(arena, total, sizeof *normals);
    double(*uvs)[2] = arena_alloc_array(arena, per_patch, sizeof *uvs);
    uint32_t *vertex_of = arena_alloc_array(arena, total, sizeof *vertex_of);
    uint32_t *starts = arena_alloc_array(arena, faces + 1, sizeof *starts);
    uint32_t *vertex = arena_alloc_array(arena, 3 * faces, sizeof *vertex);
    uint32_t *normal = arena_alloc_array(arena, 3 * faces, sizeof *normal);
    uint32_t *uv = arena_alloc_array(arena, 3 * faces, sizeof *uv);
    if (!weld.vertices || !weld.table || !normals || !uvs || !vertex_of || !starts || !vertex || !normal || !uv)
        return error_no_memory(error, "the mesh of a patch");

    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++)
            uvs[j * side + i][0] = (double)i / n, uvs[j * side + i][1] = (double)j / n;
    size_t next = 0;
    uint32_t face = 0;
    for (uint32_t k = 0; k < in->count; k++) {
        const double(*points)[3] = in->points + 16 * (size_t)k;
        uint32_t first = (uint32_t)next;
        for (uint32_t j = 0; j < side; j++)
            for (uint32_t i = 0; i < side; i++, next++) {
                struct vec3 unused, normal_here = vec3_normalize(patch_normal(points, i, j, n));
                if (in->flip)
                    normal_here = vec3_negate(normal_here);
                vertex_of[next] = weld_vertex(&weld, patch_point(points, i, j, n, &unused));
                normals[next][0] = normal_here.x, normals[next][1] = normal_here.y, normals[next][2] = normal_here.z;
            }
        /* Two triangles per cell; a triangle degenerated by a point-like border is left out. */
        for (uint32_t j = 0; j < n; j++)
            for (uint32_t i = 0; i < n; i++) {
                uint32_t a = j * side + i, b = a + 1, c = a + side + 1, d = a + side;
                const uint32_t corners[2][3] = {{a, b, c}, {a, c, d}};
                for (int t = 0; t < 2; t++) {
                    uint32_t v[3];
                    for (int m = 0; m < 3; m++)
                        v[m] = corners[t][in->flip ? 2 - m : m];
                    const uint32_t w[3] = {vertex_of[first + v[0]], vertex_of[first + v[1]], vertex_of[first + v[2]]};
                    if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0])
                        continue;
                    for (int m = 0; m < 3; m++) {
                        vertex[3 * face + (uint32_t)m] = w[m];
                        normal[3 * face + (uint32_t)m] = first + v[m];
                        uv[3 * face + (uint32_t)m] = v[m];
                    }
                    face++;
                }
            }
    }
    for (uint32_t i = 0; i <= face; i++)
        starts[i] = 3 * i;
    if (face == 0)
        return error_set(error, ERROR_SCENE, "%s: the patches have no area", in->name);
    *out = (struct mesh_input){.name = in->name,
                               .vertex_count = weld.count,
                               .face_count = face,
                               .vertices = (const double(*)[3])weld.vertices,
                               .face_start = starts,
                               .vertex_index = vertex,
                               .normal_count = (uint32_t)next,
                               .normals = (const double(*)[3])normals,
                               .normal_index = normal,
                               .uv_count = per_patch,
                               .uvs = (const double(*)[2])uvs,
                               .uv_index = uv};
    return true;
}
