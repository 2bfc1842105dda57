/* Ear clipping. An ear is a corner that turns left and whose triangle with its two neighbours holds no other corner; a
 * simple polygon has two of them (G. H. Meisters, "Polygons have ears", 1975), and only corners that do not turn left
 * can lie in the way. Cost: number of corners times number of those that do not turn left; nothing for convex polygons.
 *
 * Coordinates are those of the vertices, one axis left out: no rotation, so straight runs stay exactly straight and
 * scaling by a power of two changes nothing. A corner in the middle of a straight run is never skipped, because the
 * neighbouring polygon may use it. */
#include "mesh/triangulate_internal.h"

#include "accel/triangle.h"
#include "base/mem.h"

#include <math.h>

struct triangulate_corner {
    double x, y;
    uint32_t previous, next;
    uint32_t blocker; /* its index in the list of blockers, or NOT_LISTED */
    uint32_t listed;  /* the list itself: blockers[k] = corners[k].listed */
};

#define NOT_LISTED UINT32_MAX

/* The tolerance for an ear if a complete round found none. */
enum ear_class { EAR_CLEAN, EAR_TOUCHED, EAR_DEGENERATE, EAR_BLOCKED, EAR_ANY };

struct clipper {
    struct triangulate_corner *corners;
    uint32_t shadow_cache;
};

static double turn(const struct triangulate_corner *a, const struct triangulate_corner *b,
                   const struct triangulate_corner *c) {
    return triangle_edge(b->x - a->x, b->y - a->y, c->x - a->x, c->y - a->y);
}

static double turn_at(const struct clipper *clipper, uint32_t corner) {
    const struct triangulate_corner *c = clipper->corners;
    return turn(&c[c[corner].previous], &c[corner], &c[c[corner].next]);
}

static void blocker_add(struct clipper *clipper, uint32_t corner) {
    clipper->corners[corner].blocker = clipper->shadow_cache;
    clipper->corners[clipper->shadow_cache++].listed = corner;
}

static void blocker_remove(struct clipper *clipper, uint32_t corner) {
    struct triangulate_corner *c = clipper->corners;
    uint32_t at = c[corner].blocker;
    if (at == NOT_LISTED)
        return;
    uint32_t last = c[--clipper->shadow_cache].listed;
    c[at].listed = last;
    c[last].blocker = at;
    c[corner].blocker = NOT_LISTED;
}

static bool same_position(const struct triangulate_corner *a, const struct triangulate_corner *b) {
    return a->x == b->x && a->y == b->y;
}

/* Whether from `apex` the point lies strictly between the directions to `from` and to `to` (counter-clockwise). */
static bool strictly_inside(const struct triangulate_corner *apex, const struct triangulate_corner *from,
                            const struct triangulate_corner *to, const struct triangulate_corner *point) {
    return turn(apex, from, point) > 0 && turn(apex, point, to) > 0;
}

static bool blocks(const struct clipper *clipper, uint32_t corner, const struct triangulate_corner *const ear[3],
                   bool forgive_touch) {
    const struct triangulate_corner *q = &clipper->corners[corner];
    /* A second visit to a corner of the ear (a bridge) blocks the ear if one of its edges enters the ear. */
    for (int k = 0; k < 3; k++)
        if (same_position(q, ear[k])) {
            const struct triangulate_corner *from = ear[(k + 1) % 3], *to = ear[(k + 2) % 3];
            return strictly_inside(ear[k], from, to, &clipper->corners[q->next]) ||
                   strictly_inside(ear[k], from, to, &clipper->corners[q->previous]);
        }
    double a = turn(ear[0], ear[1], q), b = turn(ear[1], ear[2], q), c = turn(ear[2], ear[0], q);
    return forgive_touch ? a > 0 && b > 0 && c > 0 : a >= 0 && b >= 0 && c >= 0;
}

static bool is_ear(const struct clipper *clipper, uint32_t tip, enum ear_class ear_class) {
    const struct triangulate_corner *c = clipper->corners;
    const struct triangulate_corner *ear[3] = {&c[c[tip].previous], &c[tip], &c[c[tip].next]};
    double area = turn(ear[0], ear[1], ear[2]);
    if (ear_class >= EAR_DEGENERATE)
        return ear_class == EAR_ANY || area == 0 || (ear_class == EAR_BLOCKED && area > 0);
    if (!(area > 0))
        return false;
    double x0 = math_min(ear[0]->x, math_min(ear[1]->x, ear[2]->x)),
           x1 = math_max(ear[0]->x, math_max(ear[1]->x, ear[2]->x));
    double y0 = math_min(ear[0]->y, math_min(ear[1]->y, ear[2]->y)),
           y1 = math_max(ear[0]->y, math_max(ear[1]->y, ear[2]->y));
    for (uint32_t k = 0; k < clipper->shadow_cache; k++) {
        uint32_t q = c[k].listed;
        if (c[q].x < x0 || c[q].x > x1 || c[q].y < y0 || c[q].y > y1)
            continue;
        if (q == tip || q == c[tip].previous || q == c[tip].next)
            continue;
        if (blocks(clipper, q, ear, ear_class == EAR_TOUCHED))
            return false;
    }
    return true;
}

static void clip_all(struct clipper *clipper, uint32_t count, uint32_t (*triangles)[3]) {
    struct triangulate_corner *c = clipper->corners;
    enum ear_class ear_class = EAR_CLEAN;
    uint32_t left = count, tip = 0, tried = 0;
    while (left > 3) {
        if (!is_ear(clipper, tip, ear_class)) {
            tip = c[tip].next;
            if (++tried >= left) {
                tried = 0;
                ear_class++; /* EAR_ANY takes the first corner, so it never goes further */
            }
            continue;
        }
        uint32_t previous = c[tip].previous, next = c[tip].next;
        (*triangles)[0] = previous;
        (*triangles)[1] = tip;
        (*triangles)[2] = next;
        triangles++;
        left--;
        c[previous].next = next;
        c[next].previous = previous;
        blocker_remove(clipper, tip);
        for (int side = 0; side < 2; side++) {
            uint32_t corner = side ? next : previous;
            bool is_blocking = !(turn_at(clipper, corner) > 0);
            if (!is_blocking)
                blocker_remove(clipper, corner);
            else if (c[corner].blocker == NOT_LISTED)
                blocker_add(clipper, corner);
        }
        ear_class = EAR_CLEAN;
        tried = 0;
        tip = c[next].next; /* not the neighbour: fewer slivers */
    }
    (*triangles)[0] = c[tip].previous;
    (*triangles)[1] = tip;
    (*triangles)[2] = c[tip].next;
}

/* The axis the polygon's normal is largest along, and its sign there (Newell's sums over the edges, taken from corner 0
 * so that far from the origin nothing cancels). */
static int best_axis(const double (*vertices)[3], const uint32_t *vertex, uint32_t count, bool *negative) {
    double sum[3] = {0, 0, 0};
    const double *base = vertices[vertex[0]];
    for (uint32_t i = 1; i + 1 < count; i++) {
        const double *p = vertices[vertex[i]], *q = vertices[vertex[i + 1]];
        double a[3] = {p[0] - base[0], p[1] - base[1], p[2] - base[2]};
        double b[3] = {q[0] - base[0], q[1] - base[1], q[2] - base[2]};
        sum[0] += a[1] * b[2] - a[2] * b[1];
        sum[1] += a[2] * b[0] - a[0] * b[2];
        sum[2] += a[0] * b[1] - a[1] * b[0];
    }
    double x = fabs(sum[0]), y = fabs(sum[1]), z = fabs(sum[2]);
    int axis = x > y && x > z ? 0 : y > z ? 1 : 2;
    *negative = sum[axis] < 0;
    return axis;
}

static void fan(uint32_t count, uint32_t (*triangles)[3]) {
    for (uint32_t i = 0; i + 2 < count; i++) {
        triangles[i][0] = 0;
        triangles[i][1] = i + 1;
        triangles[i][2] = i + 2;
    }
}

bool triangulate_polygon(const double (*vertices)[3], const uint32_t *vertex, uint32_t count, uint32_t (*triangles)[3],
                         struct triangulate_scratch *scratch) {
    if (count == 3) {
        fan(count, triangles);
        return true;
    }
    if (count > scratch->capacity) {
        struct triangulate_corner *grown = mem_resize_array(scratch->corners, count, sizeof *grown);
        if (!grown)
            return false;
        scratch->corners = grown;
        scratch->capacity = count;
    }
    bool negative;
    int axis = best_axis(vertices, vertex, count, &negative);
    int x = (axis + (negative ? 2 : 1)) % 3, y = (axis + (negative ? 1 : 2)) % 3;
    struct clipper clipper = {scratch->corners, 0};
    struct triangulate_corner *c = clipper.corners;
    for (uint32_t i = 0; i < count; i++) {
        c[i].x = vertices[vertex[i]][x];
        c[i].y = vertices[vertex[i]][y];
        c[i].previous = i ? i - 1 : count - 1;
        c[i].next = i + 1 < count ? i + 1 : 0;
        c[i].blocker = NOT_LISTED;
    }
    /* Convex: it turns left everywhere and goes around once, that is, x increases once and decreases once. */
    uint32_t x_turns = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!(turn_at(&clipper, i) > 0))
            blocker_add(&clipper, i);
        bool forwards = c[c[i].next].x > c[i].x, before = c[i].x > c[c[i].previous].x;
        x_turns += forwards != before;
    }
    if (clipper.shadow_cache == 0 && x_turns <= 2)
        fan(count, triangles);
    else
        clip_all(&clipper, count, triangles);
    return true;
}

void triangulate_scratch_destroy(struct triangulate_scratch *scratch) {
    mem_free(scratch->corners);
    *scratch = (struct triangulate_scratch){0};
}
