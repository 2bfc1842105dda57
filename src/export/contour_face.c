/* Faces of cells. The crossings of its four edges, in their order around the face, alternate between entering and
 * leaving the solid; they are joined in pairs. Where an arc joins two smooth pieces of the surface, or the normal turns
 * much, the edge of the surface is looked for: the tangents at both ends are intersected in the face, a line is cast
 * through that point, and what it meets takes the place of the end on the same piece. This converges quadratically.
 *
 * A face is worked out once, so both of its cells have the same arcs. */
#include "export/contour_face_internal.h"
#include "export/contour_grid_internal.h"

enum { BOUNDARY_LIMIT = 64, EDGE_LIMIT = 16, FEATURE_LIMIT = 4, FEATURE_STEPS = 14, FEATURE_DEPTH = 3 };

/* Two normals whose cosine is above these are of a smooth surface: of one piece, of two that join. */
static const double smooth_cosine = 0.9, join_cosine = 0.9995;

/* Of the distance to another point: where parts of the surface touch, they are taken as so far apart. */
static const double touch_share = 1e-5;

static struct vec3 vec3_towards(struct vec3 from, struct vec3 to, double share) {
    return vec3_add_scaled(from, vec3_sub(to, from), share);
}

/* A place on the boundary of a face. */
struct boundary_point {
    uint32_t vertex;
    bool enter; /* in the direction around the face */
    int edge;
};
struct side {
    struct vec3 point, normal;
    uint32_t surface;
};
/* A place on an edge of the surface, with its two sides. */
struct feature {
    struct vec3 point;
    struct side before, behind;
};
struct face_search {
    struct contour *contour;
    int axis, u, v;
    double plane, low[2], size;
    bool lost; /* there is an edge that was not found */
    struct feature found[FEATURE_LIMIT];
    int count;
};

static struct side side_of(const struct contour *contour, uint32_t vertex) {
    const struct solid_vertex *at = contour_vertex(contour, vertex);
    return (struct side){at->point, at->normal[0], at->surface[0]};
}

static bool is_smooth(const struct side *a, const struct side *b) {
    return vec3_dot(a->normal, b->normal) > (a->surface == b->surface ? smooth_cosine : join_cosine);
}

/* The crossings of an edge of the face, in the direction around it. True: too many. */
static bool add_edge(struct contour *contour, int axis, const struct cell *from, int edge,
                     struct boundary_point *points, int *count) {
    const int *at = from->at;
    const struct grid_line line = grid_line(contour, axis, at[(axis + 1) % 3], at[(axis + 2) % 3]);
    const struct grid_crossing *crossings = (struct grid_crossing *)contour->grid.crossings.items + line.first;
    uint32_t low = 0, high = line.count;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (crossings[middle].unit < at[axis])
            low = middle + 1;
        else
            high = middle;
    }
    uint32_t end = low;
    while (end < line.count && crossings[end].unit < at[axis] + from->size)
        end++;
    bool backwards = edge >= 2;
    if (end - low > EDGE_LIMIT)
        return true;
    for (uint32_t i = low; i < end; i++) {
        const struct grid_crossing *crossing = &crossings[backwards ? low + end - 1 - i : i];
        points[(*count)++] = (struct boundary_point){crossing->vertex, crossing->enter != backwards, edge};
    }
    return false;
}

static bool collect_boundary(struct contour *contour, int axis, const int at[3], int size,
                             struct boundary_point *points, int *count) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const struct cell corner = {{at[0], at[1], at[2]}, size};
    struct cell right = corner, above = corner;
    right.at[u] += size;
    above.at[v] += size;
    *count = 0;
    if (add_edge(contour, u, &corner, 0, points, count) || add_edge(contour, v, &right, 1, points, count) ||
        add_edge(contour, u, &above, 2, points, count) || add_edge(contour, v, &corner, 3, points, count))
        return false;
    for (int i = 0; i < *count; i++)
        if (points[i].enter == points[(i + 1) % *count].enter)
            return false;
    return true;
}

/* Where the tangents of both sides meet in the face, and the direction between the two normals; else the middle
 * between the sides and the direction at right angles to the line through them. True: the tangents. */
static bool meet_tangents(const struct face_search *search, const struct side *a, const struct side *b,
                          struct vec3 *start, struct vec3 *direction) {
    int u = search->u, v = search->v;
    double au = vec3_get(a->normal, u), av = vec3_get(a->normal, v), bu = vec3_get(b->normal, u);
    double bv = vec3_get(b->normal, v), la = sqrt(au * au + av * av), lb = sqrt(bu * bu + bv * bv);
    double turn = au * bv - av * bu, margin = 0.2 * search->size;
    bool met = false;
    *start = vec3_with(vec3_scale(vec3_add(a->point, b->point), 0.5), search->axis, search->plane);
    *direction = vec3_all(0);
    if (la > 1e-6 && lb > 1e-6 && fabs(turn) > 1e-4 * la * lb) {
        double ra = au * vec3_get(a->point, u) + av * vec3_get(a->point, v);
        double rb = bu * vec3_get(b->point, u) + bv * vec3_get(b->point, v);
        double su = (ra * bv - rb * av) / turn - search->low[0], sv = (au * rb - bu * ra) / turn - search->low[1];
        met = su > -margin && su < search->size + margin && sv > -margin && sv < search->size + margin;
        if (met) {
            *start = vec3_with(vec3_with(*start, u, su + search->low[0]), v, sv + search->low[1]);
            *direction = vec3_with(vec3_with(*direction, u, au / la + bu / lb), v, av / la + bv / lb);
        }
    }
    if (vec3_length(*direction) < 0.05) {
        struct vec3 along = vec3_sub(b->point, a->point);
        *direction = vec3_with(vec3_with(*direction, u, -vec3_get(along, v)), v, vec3_get(along, u));
    }
    *direction = vec3_normalize(*direction);
    return met;
}

static bool is_within(const struct face_search *search, struct vec3 point) {
    double margin = 1e-7 * search->size;
    for (int i = 0; i < 2; i++) {
        double at = vec3_get(point, i == 0 ? search->u : search->v) - search->low[i];
        if (at < margin || at > search->size - margin)
            return false;
    }
    return true;
}

/* Where another part of the solid touches an edge, the line that looks for the edge goes from one part to the other. A
 * line beside it meets both sides near the edge. */
static bool is_touched_edge(struct face_search *search, const struct side *a, const struct side *b, struct vec3 at) {
    struct solid_probe *probe = &search->contour->probe;
    struct vec3 middle = vec3_scale(vec3_add(a->point, b->point), 0.5);
    double near = 20 * touch_share * vec3_length(vec3_sub(middle, at));
    bool found[2] = {false, false};
    solid_cast(probe, vec3_towards(at, middle, touch_share), vec3_normalize(vec3_sub(b->point, a->point)));
    for (uint32_t i = 0; i < probe->count; i++)
        for (int k = 0; k < 2; k++)
            found[k] =
                found[k] || (fabs(probe->found[i].t) < near && probe->found[i].surface == (k == 0 ? a : b)->surface);
    return found[0] && found[1];
}

/* One edge between the two sides. */
static bool find_feature(struct face_search *search, struct side a, struct side b, struct feature *out) {
    const struct contour *contour = search->contour;
    double turn = vec3_dot(a.normal, b.normal);
    bool same = a.surface == b.surface;
    if (is_smooth(&a, &b))
        return false;
    for (int step = 0; step < FEATURE_STEPS; step++) {
        struct vec3 start, direction;
        struct solid_crossing met;
        bool tangents = meet_tangents(search, &a, &b, &start, &direction);
        if (!(vec3_length(direction) > 0))
            return false;
        if (!solid_cast_near(&search->contour->probe, start, direction, search->size, &met)) {
            *out = (struct feature){start, a, b};
            return tangents && is_within(search, start) && is_touched_edge(search, &a, &b, start);
        }
        met.point = vec3_with(met.point, search->axis, search->plane);
        if (tangents && vec3_length(vec3_sub(met.point, start)) < 1e-10 * contour->size) {
            *out = (struct feature){start, a, b};
            return !is_smooth(&a, &b) && is_within(search, start);
        }
        /* What was met takes the place of the side that it belongs to. */
        bool first = same || (met.surface != a.surface && met.surface != b.surface)
                         ? vec3_dot(met.normal, a.normal) > vec3_dot(met.normal, b.normal)
                         : met.surface == a.surface;
        *(first ? &a : &b) = (struct side){met.point, met.normal, met.surface};
        double now = vec3_dot(a.normal, b.normal);
        bool steady = same && now > 0.5 + 0.5 * turn && now > smooth_cosine; /* it turns on the whole way */
        if (steady || (!same && now > 0.9998))
            return false;
    }
    search->lost = search->lost || vec3_dot(a.normal, b.normal) < 0.97;
    return false;
}

/* All edges between the two sides, in their order. */
static void find_features(struct face_search *search, const struct side *a, const struct side *b, int depth) {
    struct feature feature;
    if (search->count == FEATURE_LIMIT || depth > FEATURE_DEPTH || !find_feature(search, *a, *b, &feature))
        return;
    const struct side *before = &feature.before, *behind = &feature.behind;
    if (before->surface != a->surface || vec3_dot(before->normal, a->normal) < smooth_cosine)
        find_features(search, a, before, depth + 1);
    if (search->count < FEATURE_LIMIT)
        search->found[search->count++] = feature;
    if (behind->surface != b->surface || vec3_dot(behind->normal, b->normal) < smooth_cosine)
        find_features(search, behind, b, depth + 1);
}

/* Both ends on one edge of the face: a straight arc would lie in the edge, which other faces share. A point on the arc
 * inside of the face. */
static void bend_arc(struct face_search *search, const struct side *a, const struct side *b, int edge) {
    struct solid_probe *probe = &search->contour->probe;
    struct vec3 middle = vec3_scale(vec3_add(a->point, b->point), 0.5);
    double maximum = 0.9 * search->size, depth = 0.25 * vec3_length(vec3_sub(b->point, a->point));
    struct vec3 inward = vec3_with(vec3_all(0), edge % 2 == 0 ? search->v : search->u, edge == 0 || edge == 3 ? 1 : -1);
    solid_cast(probe, middle, inward);
    for (uint32_t i = 0; i < probe->count; i++) {
        if (probe->found[i].t > 0 && probe->found[i].t < maximum) {
            depth = probe->found[i].t;
            break;
        }
    }
    struct vec3 point = vec3_add_scaled(middle, inward, math_min(depth, maximum));
    search->found[0] = (struct feature){vec3_with(point, search->axis, search->plane), *a, *b};
    search->count = 1;
    search->lost = true;
}

static struct arc make_arc(struct face_search *search, struct boundary_point p, struct boundary_point q) {
    struct contour *contour = search->contour;
    struct boundary_point first = p.enter ? p : q, last = p.enter ? q : p;
    struct side a = side_of(contour, first.vertex), b = side_of(contour, last.vertex);
    search->count = 0;
    if (first.edge == last.edge || !is_smooth(&a, &b))
        find_features(search, &a, &b, 0);
    if (search->count == 0 && first.edge == last.edge)
        bend_arc(search, &a, &b, first.edge);
    struct arc arc = {first.vertex, last.vertex, (uint32_t)contour->vertices.count, (uint32_t)search->count,
                      first.edge == last.edge};
    for (int i = 0; i < search->count; i++) {
        const struct feature *feature = &search->found[i];
        const struct solid_vertex vertex = {feature->point,
                                            {feature->before.normal, feature->behind.normal},
                                            {feature->before.surface, feature->behind.surface},
                                            VERTEX_EDGE};
        (void)contour_add_vertex(contour, &vertex);
    }
    return arc;
}

/* Which of the two ways to join four points is right: is the place where their diagonals meet inside? Where parts touch
 * there, it is not: it is a little beside it, towards the points that are outside between two of the four. */
static bool joins_first(struct face_search *search, const struct boundary_point p[4]) {
    struct vec3 point[4];
    double x[4], y[4];
    for (int i = 0; i < 4; i++) {
        point[i] = contour_vertex(search->contour, p[i].vertex)->point;
        x[i] = vec3_get(point[i], search->u);
        y[i] = vec3_get(point[i], search->v);
    }
    double ax = x[2] - x[0], ay = y[2] - y[0], bx = x[3] - x[1], by = y[3] - y[1], turn = ax * by - ay * bx;
    double t = fabs(turn) > 1e-300 ? ((x[1] - x[0]) * by - (y[1] - y[0]) * bx) / turn : 0.5;
    struct vec3 middle = vec3_with(vec3_all(0), search->axis, search->plane);
    middle = vec3_with(vec3_with(middle, search->u, x[0] + t * ax), search->v, y[0] + t * ay);
    bool inside = solid_contains(&search->contour->probe, middle);
    for (int i = p[0].enter ? 1 : 0; inside && i < 4; i += 2) {
        struct vec3 outside = vec3_scale(vec3_add(point[i], point[(i + 1) % 4]), 0.5);
        inside = solid_contains(&search->contour->probe, vec3_towards(middle, outside, touch_share));
    }
    return inside != p[0].enter;
}

static double misfit(const struct contour *contour, const struct boundary_point *p, const struct boundary_point *q) {
    struct side a = side_of(contour, p->vertex), b = side_of(contour, q->vertex);
    double apart = vec3_length(vec3_sub(a.point, b.point)) * (a.surface == b.surface ? 1 : 1.5);
    return apart * (1.2 - vec3_dot(a.normal, b.normal));
}

/* Joins all points; more than four: neighbours that fit best first. Returns the number of arcs. */
static int join_points(struct face_search *search, struct boundary_point *p, int count, struct arc *arcs) {
    int made = 0;
    while (count > 4) {
        int best = 0;
        double minimum = INFINITY;
        for (int i = 0; i < count; i++) {
            double misfits = misfit(search->contour, &p[i], &p[(i + 1) % count]);
            best = misfits < minimum ? i : best;
            minimum = math_min(misfits, minimum);
        }
        int next = (best + 1) % count, kept = 0;
        arcs[made++] = make_arc(search, p[best], p[next]);
        for (int i = 0; i < count; i++)
            if (i != best && i != next)
                p[kept++] = p[i];
        count = kept;
    }
    int first = count == 4 && !joins_first(search, p) ? 1 : 0;
    for (int i = 0; i < count; i += 2)
        arcs[made++] = make_arc(search, p[(first + i) % count], p[(first + i + 1) % count]);
    return made;
}

/* --- arcs that cross --- */

static double turn_of(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* The points of an arc in the face; those on edges of the surface a little nearer to its ends, for arcs that touch do
 * not cross. */
static int arc_points(const struct face_search *search, const struct arc *arc, double out[FEATURE_LIMIT + 2][2]) {
    const struct contour *contour = search->contour;
    struct vec3 from = contour_vertex(contour, arc->from)->point, to = contour_vertex(contour, arc->to)->point;
    struct vec3 middle = vec3_scale(vec3_add(from, to), 0.5);
    int count = 0;
    for (uint32_t i = 0; i < arc->features + 2; i++) {
        uint32_t feature = arc->feature + i - 1;
        struct vec3 point = i == 0 ? from
                            : i > arc->features
                                ? to
                                : vec3_towards(contour_vertex(contour, feature)->point, middle, touch_share);
        out[count][0] = vec3_get(point, search->u);
        out[count++][1] = vec3_get(point, search->v);
    }
    return count;
}

static bool arcs_cross(const struct face_search *search, const struct arc *one, const struct arc *other) {
    double p[FEATURE_LIMIT + 2][2], q[FEATURE_LIMIT + 2][2];
    int p_count = arc_points(search, one, p), q_count = arc_points(search, other, q);
    if (one->features == 0 && other->features == 0)
        return false;
    for (int i = 0; i + 1 < p_count; i++)
        for (int j = 0; j + 1 < q_count; j++)
            if (turn_of(p[i], p[i + 1], q[j]) * turn_of(p[i], p[i + 1], q[j + 1]) <= 0 &&
                turn_of(q[j], q[j + 1], p[i]) * turn_of(q[j], q[j + 1], p[i + 1]) <= 0)
                return true;
    return false;
}

/* Straight arcs do not cross. True: some did. A bent one stays: straight, it would lie in an edge. */
static bool straighten_crossing(const struct face_search *search, struct arc *arcs, int count) {
    bool crossed = false;
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < i; j++) {
            if (!arcs_cross(search, &arcs[i], &arcs[j]))
                continue;
            crossed = true;
            arcs[i].features = arcs[i].bent ? arcs[i].features : 0;
            arcs[j].features = arcs[j].bent ? arcs[j].features : 0;
        }
    }
    return crossed;
}

static struct face make_face(struct contour *contour, int axis, const int at[3], int size) {
    struct boundary_point points[BOUNDARY_LIMIT];
    struct arc arcs[BOUNDARY_LIMIT / 2];
    int count;
    struct face face = {(uint32_t)contour->arcs.count, 0, true};
    if (!collect_boundary(contour, axis, at, size, points, &count))
        return face;
    struct face_search search = {.contour = contour,
                                 .axis = axis,
                                 .u = (axis + 1) % 3,
                                 .v = (axis + 2) % 3,
                                 .plane = grid_node(&contour->grid, axis, at[axis]),
                                 .low = {grid_node(&contour->grid, (axis + 1) % 3, at[(axis + 1) % 3]),
                                         grid_node(&contour->grid, (axis + 2) % 3, at[(axis + 2) % 3])},
                                 .size = contour->grid.step * size};
    count = join_points(&search, points, count, arcs);
    face.bad = straighten_crossing(&search, arcs, count) || search.lost;
    contour->failed = !list_add(&contour->arcs, arcs, (size_t)count, sizeof *arcs) || contour->failed;
    face.count = contour->failed ? 0 : (uint32_t)count;
    return face;
}

struct face face_arcs(struct contour *contour, int axis, const int at[3], int size) {
    uint64_t key = cell_key(at, size, axis + 1);
    uint32_t *number = key_map_find(&contour->face_numbers, key);
    if (number)
        return ((struct face *)contour->faces.items)[*number];
    struct face face = make_face(contour, axis, at, size);
    if (!list_add(&contour->faces, &face, 1, sizeof face) ||
        !key_map_add(&contour->face_numbers, key, (uint32_t)contour->faces.count - 1))
        contour->failed = true;
    return face;
}
