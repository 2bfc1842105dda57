/* Cells. The arcs of the six faces of a cell make loops; each loop bounds a disc. A smooth loop is a polygon. A loop
 * that an edge of the surface crosses is divided along it. Other loops get a vertex where the planes at the
 * crossings and on both sides of the edges meet (minimum squares, then Newton's method by casts along the normals): a
 * corner or an edge of the surface.
 *
 * A diagonal between two points of one face, or a triangle in a face, is never made: the neighbour may make the same
 * one, and the edge would have four triangles. */
#include "export/contour_cell_internal.h"

#include "base/hash.h"
#include "export/contour_face_internal.h"
#include "export/triangles_internal.h"

enum { ARC_LIMIT = 512, LOOP_LIMIT = 60, REGION_LIMIT = 16, CELL_TRIANGLES = 400, NEWTON_STEPS = 6 };

/* Shares of the tolerance: sag of smooth parts between vertices, triangles at edges from the surface, points on the
 * surface from the triangles. */
static const double sag_share = 0.25, edge_share = 0.3, known_share = 0.5;

struct cell_arc {
    struct arc arc;
    bool reversed, used;
    uint8_t face; /* a bit */
};
struct loop_point {
    uint32_t vertex;
    uint8_t faces; /* that it is in */
    bool on_edge;  /* of the surface */
    uint8_t side;  /* else: which of the vertex's normals and surfaces it stands for */
};
struct loop {
    struct loop_point points[LOOP_LIMIT];
    int count;
};
struct cell_work {
    struct contour *contour;
    struct vec3 low;
    double size;
    bool bad; /* the cell is to be divided */
    struct cell_arc arcs[ARC_LIMIT];
    int count;
};

static const struct solid_vertex *vertex_of(const struct cell_work *work, const struct loop_point *point) {
    return contour_vertex(work->contour, point->vertex);
}
static uint32_t surface_of(const struct cell_work *work, const struct loop_point *point) {
    return vertex_of(work, point)->surface[point->side];
}

static bool is_inside(const struct cell_work *work, struct vec3 point, double margin) {
    for (int axis = 0; axis < 3; axis++) {
        double at = vec3_get(point, axis) - vec3_get(work->low, axis);
        if (at < margin * work->size || at > (1 - margin) * work->size)
            return false;
    }
    return true;
}

/* --- planes --- */

/* A plane of the surface, and the piece it is of. */
struct plane {
    struct vec3 point, normal;
    uint32_t surface;
};

/* Eigenvalues and eigenvectors of a symmetric matrix, by Jacobi's rotations; a becomes diagonal. */
static void diagonalise(double a[3][3], double vectors[3][3]) {
    for (int i = 0; i < 9; i++)
        vectors[i / 3][i % 3] = i / 3 == i % 3;
    for (int step = 0; step < 30; step++) {
        int p = 0, q = 1;
        if (fabs(a[0][2]) > fabs(a[p][q]))
            q = 2;
        if (fabs(a[1][2]) > fabs(a[p][q]))
            p = 1, q = 2;
        if (fabs(a[p][q]) < 1e-18)
            return;
        double ratio = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        double t = (ratio >= 0 ? 1 : -1) / (fabs(ratio) + sqrt(ratio * ratio + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; k++) {
            double x = a[k][p], y = a[k][q], e = vectors[k][p], f = vectors[k][q];
            a[k][p] = c * x - s * y, a[k][q] = s * x + c * y;
            vectors[k][p] = c * e - s * f, vectors[k][q] = s * e + c * f;
        }
        for (int k = 0; k < 3; k++) {
            double x = a[p][k], y = a[q][k];
            a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
        }
    }
}

/* The point nearest to `from` that is on the planes, by minimum squares; directions whose eigenvalue is less than `cut`
 * of the largest are left out. */
static struct vec3 meet_planes(struct vec3 from, const struct plane *planes, int count, double cut) {
    double a[3][3] = {{0}}, b[3] = {0}, vectors[3][3];
    for (int i = 0; i < count; i++) {
        double n[3] = {planes[i].normal.x, planes[i].normal.y, planes[i].normal.z};
        double rest = vec3_dot(planes[i].normal, vec3_sub(planes[i].point, from));
        for (int k = 0; k < 9; k++)
            a[k / 3][k % 3] += n[k / 3] * n[k % 3];
        for (int k = 0; k < 3; k++)
            b[k] += n[k] * rest;
    }
    diagonalise(a, vectors);
    double maximum = math_max(a[0][0], math_max(a[1][1], a[2][2]));
    for (int i = 0; i < 3; i++) {
        struct vec3 e = {vectors[0][i], vectors[1][i], vectors[2][i]};
        if (a[i][i] > cut * maximum)
            from = vec3_add_scaled(from, e, (e.x * b[0] + e.y * b[1] + e.z * b[2]) / a[i][i]);
    }
    return from;
}

/* The pieces of surface around a loop, one plane for each, and all planes that are known. */
struct loop_planes {
    struct plane all[3 * LOOP_LIMIT], regions[REGION_LIMIT];
    int count, region_count;
    struct vec3 mean_point, mean_normal;
    double turn;                       /* the smallest cosine between a normal and the mean */
    int edges[LOOP_LIMIT], edge_count; /* points on edges of the surface */
};

static void add_plane(struct loop_planes *planes, const struct solid_vertex *vertex, int side) {
    const struct plane plane = {vertex->point, vertex->normal[side], vertex->surface[side]};
    planes->all[planes->count++] = plane;
    for (int i = 0; i < planes->region_count; i++)
        if (planes->regions[i].surface == plane.surface && vec3_dot(planes->regions[i].normal, plane.normal) > 0.9)
            return;
    if (planes->region_count < REGION_LIMIT)
        planes->regions[planes->region_count++] = plane;
}

static void survey_loop(const struct cell_work *work, const struct loop *loop, struct loop_planes *planes) {
    planes->count = planes->region_count = planes->edge_count = 0;
    planes->mean_point = planes->mean_normal = vec3_all(0);
    for (int i = 0; i < loop->count; i++) {
        const struct solid_vertex *vertex = vertex_of(work, &loop->points[i]);
        planes->mean_point = vec3_add_scaled(planes->mean_point, vertex->point, 1.0 / loop->count);
        if (loop->points[i].on_edge) {
            planes->edges[planes->edge_count++] = i;
            continue;
        }
        planes->mean_normal = vec3_add(planes->mean_normal, vertex->normal[loop->points[i].side]);
        add_plane(planes, vertex, loop->points[i].side);
    }
    for (int i = 0; i < 2 * planes->edge_count; i++)
        add_plane(planes, vertex_of(work, &loop->points[planes->edges[i / 2]]), i % 2);
    planes->mean_normal = vec3_normalize(planes->mean_normal);
    planes->turn = 1;
    for (int i = 0; i < loop->count; i++) {
        const struct loop_point *point = &loop->points[i];
        if (!point->on_edge)
            planes->turn =
                math_min(planes->turn, vec3_dot(planes->mean_normal, vertex_of(work, point)->normal[point->side]));
    }
}

/* Each plane is taken where its piece of the surface is near to the point; from a little below the others, for a line
 * in a face would miss. */
static void move_planes(const struct cell_work *work, struct plane *planes, int count, struct vec3 at) {
    struct vec3 below = at;
    double depth = 1e-5 * work->size;
    for (int i = 0; i < count; i++)
        below = vec3_add_scaled(below, planes[i].normal, -depth);
    for (int i = 0; i < count; i++) {
        struct plane *region = &planes[i];
        struct vec3 origin = vec3_add_scaled(below, region->normal, depth);
        struct solid_crossing met;
        if (solid_cast_near(&work->contour->probe, origin, region->normal, work->size, &met) &&
            met.surface == region->surface && vec3_dot(met.normal, region->normal) > 0.7)
            *region = (struct plane){met.point, met.normal, met.surface};
    }
}

/* --- discs --- */

static uint32_t surface_of_loop(const struct cell_work *work, const struct loop_point *points, int count) {
    for (int i = 0; i < count; i++)
        if (!points[i].on_edge)
            return surface_of(work, &points[i]);
    return surface_of(work, &points[0]);
}

/* Cuts off the corner with the shortest diagonal again and again. False: it cannot be done; nothing is added. */
static bool add_polygon(const struct cell_work *work, const struct loop_point *points, int count) {
    struct contour *contour = work->contour;
    struct loop_point left[LOOP_LIMIT + 2];
    size_t before = contour->triangles.count;
    uint32_t surface = surface_of_loop(work, points, count);
    for (int i = 0; i < count; i++)
        left[i] = points[i];
    for (; count > 3; count--) {
        int best = -1;
        double minimum = INFINITY;
        for (int i = 0; i < count; i++) {
            const struct loop_point *a = &left[(i + count - 1) % count], *b = &left[(i + 1) % count];
            double length = vec3_length(vec3_sub(vertex_of(work, a)->point, vertex_of(work, b)->point));
            if (a->faces & b->faces || length >= minimum)
                continue;
            best = i;
            minimum = length;
        }
        if (best < 0)
            break;
        contour_add_triangle(contour, left[(best + count - 1) % count].vertex, left[best].vertex,
                             left[(best + 1) % count].vertex, surface);
        for (int i = best; i + 1 < count; i++)
            left[i] = left[i + 1];
    }
    if (count == 3 && !(left[0].faces & left[1].faces & left[2].faces)) {
        contour_add_triangle(contour, left[0].vertex, left[1].vertex, left[2].vertex, surface);
        return true;
    }
    contour->triangles.count = before;
    return false;
}

/* The piece of surface between two points that follow each other in a loop. */
static uint32_t surface_joining(const struct cell_work *work, const struct loop_point *a, const struct loop_point *b) {
    const struct solid_vertex *p = vertex_of(work, a), *q = vertex_of(work, b);
    if (!a->on_edge || !b->on_edge)
        return surface_of(work, !a->on_edge ? a : b);
    bool second = p->surface[1] == q->surface[0] || p->surface[1] == q->surface[1];
    return p->surface[second];
}

static void add_pyramid(const struct cell_work *work, const struct loop *loop, const struct solid_vertex *middle) {
    uint32_t vertex = contour_add_vertex(work->contour, middle);
    for (int i = 0; i < loop->count; i++) {
        const struct loop_point *a = &loop->points[i], *b = &loop->points[(i + 1) % loop->count];
        contour_add_triangle(work->contour, vertex, a->vertex, b->vertex, surface_joining(work, a, b));
    }
}

/* A fan around a point of the surface in the middle, where nothing better is known. */
static void add_middle(struct cell_work *work, const struct loop *loop, const struct loop_planes *planes,
                       uint8_t sharp) {
    struct solid_vertex middle = {.point = planes->mean_point, .sharp = sharp};
    struct solid_crossing met;
    for (int i = 0; i < 3; i++) {
        const struct plane *region = &planes->regions[i < planes->region_count ? i : 0];
        middle.normal[i] = sharp ? region->normal : planes->mean_normal;
        middle.surface[i] = sharp ? region->surface : surface_of_loop(work, loop->points, loop->count);
    }
    if (vec3_length(planes->mean_normal) > 0 &&
        solid_cast_near(&work->contour->probe, planes->mean_point, planes->mean_normal, work->size, &met) &&
        is_inside(work, met.point, 0.001)) {
        middle.point = met.point;
        if (!sharp) {
            middle.normal[0] = met.normal;
            middle.surface[0] = met.surface;
        }
    }
    work->bad = true;
    add_pyramid(work, loop, &middle);
}

/* Whether one edge of the surface goes through both points, and is straight enough between them. */
static bool is_straight_edge(const struct cell_work *work, const struct loop_point *a, const struct loop_point *b) {
    const struct solid_vertex *p = vertex_of(work, a), *q = vertex_of(work, b);
    struct vec3 middle = vec3_scale(vec3_add(p->point, q->point), 0.5), at = middle;
    struct plane planes[2] = {{p->point, p->normal[0], p->surface[0]}, {p->point, p->normal[1], p->surface[1]}};
    bool same = p->surface[0] == q->surface[0] && p->surface[1] == q->surface[1];
    bool crossed = p->surface[0] == q->surface[1] && p->surface[1] == q->surface[0];
    if (!same && !crossed)
        return false;
    for (int step = 0; step < 2; step++) {
        move_planes(work, planes, 2, at);
        at = meet_planes(at, planes, 2, 1e-6);
    }
    return vec3_length(vec3_sub(at, middle)) < 0.15 * work->contour->tolerance;
}

/* The points from one to another; both are of one piece of the surface in this part. */
static void part_of_loop(const struct cell_work *work, const struct loop *loop, int first, int last,
                         struct loop *part) {
    part->count = 0;
    for (int i = first;; i = (i + 1) % loop->count) {
        part->points[part->count++] = loop->points[i];
        if (i == last)
            break;
    }
    struct loop_point *ends[2] = {&part->points[0], &part->points[part->count - 1]};
    const struct loop_point inner[2] = {part->points[1], part->points[part->count - 2]};
    for (int i = 0; i < 2; i++) {
        const struct solid_vertex *end = vertex_of(work, ends[i]);
        struct vec3 beside = vertex_of(work, &inner[i])->normal[inner[i].side];
        if (end->surface[0] == end->surface[1]) /* an edge in a piece, as of a function: by the normals */
            ends[i]->side = vec3_dot(end->normal[1], beside) > vec3_dot(end->normal[0], beside);
        else
            ends[i]->side = end->surface[0] != surface_joining(work, ends[i], &inner[i]);
        ends[i]->on_edge = false;
    }
}

static void add_disc(struct cell_work *work, const struct loop *loop);

/* Along the first edge of the surface that goes through the loop. */
static bool divide_loop(struct cell_work *work, const struct loop *loop, const struct loop_planes *planes) {
    struct solid_crossing met;
    for (int i = 0; i < planes->edge_count; i++) {
        for (int k = 0; k < i; k++) {
            int first = planes->edges[k], last = planes->edges[i];
            const struct loop_point *a = &loop->points[first], *b = &loop->points[last];
            if (a->faces & b->faces || last - first < 2 || first + loop->count - last < 2)
                continue;
            struct vec3 middle = vec3_scale(vec3_add(vertex_of(work, a)->point, vertex_of(work, b)->point), 0.5);
            bool near = planes->edge_count == 2 && solid_cast_near(&work->contour->probe, middle, planes->mean_normal,
                                                                   0.02 * work->contour->tolerance, &met);
            if (!near && !is_straight_edge(work, a, b))
                continue;
            struct loop parts[2];
            part_of_loop(work, loop, first, last, &parts[0]);
            part_of_loop(work, loop, last, first, &parts[1]);
            add_disc(work, &parts[0]);
            add_disc(work, &parts[1]);
            return true;
        }
    }
    return false;
}

/* A vertex on an edge or at a corner of the surface, and a fan around it. */
static void add_corner(struct cell_work *work, const struct loop *loop, struct loop_planes *planes) {
    int edges = planes->edge_count, regions = planes->region_count;
    double cut = edges > 0 && edges <= 2 && regions <= 2 ? 0.02 : 0.005;
    struct vec3 at = meet_planes(planes->mean_point, planes->all, planes->count, cut);
    at = is_inside(work, at, 0.001) ? at : planes->mean_point;
    for (int step = 0; regions >= 2 && step < NEWTON_STEPS && is_inside(work, at, 0); step++) {
        struct vec3 before = at;
        move_planes(work, planes->regions, regions, at);
        at = meet_planes(at, planes->regions, regions, 1e-4);
        if (vec3_length(vec3_sub(at, before)) < 1e-12 * work->contour->size)
            break;
    }
    if (!is_inside(work, at, 0.0005)) {
        add_middle(work, loop, planes, VERTEX_CORNER);
        return;
    }
    struct solid_vertex corner = {.point = at, .sharp = regions >= 3 || edges != 2 ? VERTEX_CORNER : VERTEX_EDGE};
    if (edges == 0 && regions < 3)
        corner.sharp = planes->turn < 0.8 ? VERTEX_CORNER : VERTEX_SMOOTH;
    for (int i = 0; i < 3; i++) {
        const struct plane *region = &planes->regions[i < regions ? i : 0];
        corner.normal[i] = region->normal;
        corner.surface[i] = region->surface;
    }
    add_pyramid(work, loop, &corner);
}

static void add_disc(struct cell_work *work, const struct loop *loop) {
    struct loop_planes planes;
    if (loop->count < 3)
        return;
    survey_loop(work, loop, &planes);
    if (planes.edge_count == 0 && planes.turn > 0.8) {
        if (!add_polygon(work, loop->points, loop->count))
            add_middle(work, loop, &planes, VERTEX_SMOOTH);
        return;
    }
    if (!divide_loop(work, loop, &planes))
        add_corner(work, loop, &planes);
}

/* --- loops --- */

/* The arcs of a face from the side of a cell of this size: those of the smaller faces where cells beyond are smaller.
 */
static void collect_face(struct cell_work *work, int axis, const int at[3], int size, int side) {
    struct contour *contour = work->contour;
    struct cell beyond = {{at[0], at[1], at[2]}, size};
    if (side == 0)
        beyond.at[axis] -= size;
    bool outside = beyond.at[axis] < 0 || beyond.at[axis] >= contour->grid.count[axis];
    if (size > 1 && !outside && contour_is_divided(contour, &beyond)) {
        for (int i = 0; i < 4; i++) {
            int quarter[3] = {at[0], at[1], at[2]};
            quarter[(axis + 1) % 3] += (i & 1) * size / 2;
            quarter[(axis + 2) % 3] += (i >> 1) * size / 2;
            collect_face(work, axis, quarter, size / 2, side);
        }
        return;
    }
    struct face face = face_arcs(contour, axis, at, size);
    work->bad = work->bad || face.bad || work->count + (int)face.count > ARC_LIMIT;
    for (uint32_t i = 0; i < face.count && work->count < ARC_LIMIT; i++)
        work->arcs[work->count++] = (struct cell_arc){((struct arc *)contour->arcs.items)[face.first + i], side == 0,
                                                      false, (uint8_t)(1 << (2 * axis + side))};
}

static uint32_t start_of(const struct cell_arc *arc) {
    return arc->reversed ? arc->arc.to : arc->arc.from;
}

static void add_arc_points(const struct cell_arc *arc, uint8_t before, struct loop *loop) {
    loop->points[loop->count++] = (struct loop_point){start_of(arc), arc->face | before, false, 0};
    for (uint32_t i = 0; i < arc->arc.features; i++) {
        uint32_t vertex = arc->arc.feature + (arc->reversed ? arc->arc.features - 1 - i : i);
        loop->points[loop->count++] = (struct loop_point){vertex, arc->face, true, 0};
    }
}

/* The loop that begins with an arc. False: it does not close. */
static bool follow_loop(struct cell_work *work, int first, struct loop *loop) {
    int at = first;
    uint8_t before = 0;
    loop->count = 0;
    do {
        struct cell_arc *arc = &work->arcs[at];
        if (arc->used || loop->count + 1 + (int)arc->arc.features > LOOP_LIMIT)
            return false;
        arc->used = true;
        add_arc_points(arc, before, loop);
        before = arc->face;
        uint32_t end = arc->reversed ? arc->arc.from : arc->arc.to;
        for (at = 0; at < work->count && start_of(&work->arcs[at]) != end;)
            at++;
    } while (at != first && at < work->count);
    loop->points[0].faces |= before;
    return at == first;
}

/* --- tests of a cell's triangles --- */

static struct corners corners_at(const struct contour *contour, size_t triangle) {
    const struct solid_mesh mesh = {contour->vertices, contour->triangles};
    return corners_of(&mesh, (uint32_t)triangle);
}

static bool some_intersect(const struct contour *contour, size_t first) {
    size_t end = contour->triangles.count;
    if (end - first > CELL_TRIANGLES)
        return false;
    for (size_t i = first; i < end; i++) {
        struct corners a = corners_at(contour, i);
        for (size_t k = first; k < i; k++) {
            struct corners b = corners_at(contour, k);
            if (triangles_intersect(&a, &b, 1e-13 * contour->size))
                return true;
        }
    }
    return false;
}

/* The height of a smooth surface over an edge is about |dn . dp| / 8. */
static bool some_sag(const struct contour *contour, size_t first) {
    const struct solid_triangle *triangles = contour->triangles.items;
    for (size_t i = 3 * first; i < 3 * contour->triangles.count; i++) {
        const uint32_t *vertex = triangles[i / 3].vertex;
        const struct solid_vertex *a = contour_vertex(contour, vertex[i % 3]);
        const struct solid_vertex *b = contour_vertex(contour, vertex[(i + 1) % 3]);
        if (a->sharp || b->sharp || a->surface[0] != b->surface[0])
            continue;
        double sag = fabs(vec3_dot(vec3_sub(a->normal[0], b->normal[0]), vec3_sub(a->point, b->point))) / 8;
        if (sag > sag_share * contour->tolerance || vec3_dot(a->normal[0], b->normal[0]) < 0.8)
            return true;
    }
    return false;
}

static bool is_mixed(const struct contour *contour, size_t first) {
    const struct solid_triangle *triangles = contour->triangles.items;
    for (size_t i = 3 * first; i < 3 * contour->triangles.count; i++) {
        const struct solid_vertex *vertex = contour_vertex(contour, triangles[i / 3].vertex[i % 3]);
        if (vertex->sharp || vertex->surface[0] != triangles[first].surface)
            return true;
    }
    return false;
}

/* In a cell with an edge of the surface: middles of edges and triangles that are not near to the surface. */
static bool some_stray(struct contour *contour, size_t first) {
    for (size_t i = first; i < contour->triangles.count; i++) {
        struct corners c = corners_at(contour, i);
        struct vec3 normal = vec3_normalize(triangle_normal(c.point));
        for (int k = 0; k < 4 && vec3_length(normal) > 0; k++) {
            struct vec3 at = k < 3 ? vec3_scale(vec3_add(c.point[k], c.point[(k + 1) % 3]), 0.5)
                                   : vec3_scale(vec3_add(c.point[0], vec3_add(c.point[1], c.point[2])), 1.0 / 3);
            if (!solid_is_near(&contour->probe, at, normal, edge_share * contour->tolerance))
                return true;
        }
    }
    return false;
}

/* A known point of the surface in the cell that no triangle is near to. */
static bool some_missed(const struct cell_work *work, const struct cell *cell, size_t first) {
    const struct contour *contour = work->contour;
    const struct line_grid *grid = &contour->grid;
    const int base[3] = {cell->at[0] / grid->base, cell->at[1] / grid->base, cell->at[2] / grid->base};
    const struct known_point *known = grid->known.items;
    double limit = known_share * contour->tolerance;
    for (uint32_t i = grid->first_known[grid_base_index(grid, base)]; i != NO_INDEX; i = known[i].next) {
        double minimum = INFINITY;
        if (!is_inside(work, known[i].point, 0))
            continue;
        for (size_t t = first; t < contour->triangles.count && minimum > limit * limit; t++) {
            struct corners c = corners_at(contour, t);
            minimum = math_min(minimum, triangle_distance_squared(known[i].point, c.point));
        }
        if (minimum > limit * limit)
            return true;
    }
    return false;
}

/* The arcs of a cell change where cells beyond are divided. */
static uint32_t hash_arcs(const struct cell_work *work) {
    uint64_t hash = 0;
    for (int i = 0; i < work->count; i++)
        hash = hash_bytes(&work->arcs[i].arc.from, sizeof work->arcs[i].arc.from, hash);
    return (uint32_t)hash;
}

/* What was found good once stays good while its arcs are the same, but for new known points. */
static bool passes(const struct cell_work *work, const struct cell *cell, size_t first) {
    struct contour *contour = work->contour;
    uint64_t key = cell_key(cell->at, cell->size, 0);
    uint32_t *passed = key_map_find(&contour->passed, key), hash = hash_arcs(work);
    if (passed && *passed == hash)
        return !some_missed(work, cell, first);
    if ((is_mixed(contour, first) && some_stray(contour, first)) || some_missed(work, cell, first))
        return false;
    if (passed)
        *passed = hash;
    else
        contour->failed = contour->failed || !key_map_add(&contour->passed, key, hash);
    return true;
}

bool cell_mesh(struct contour *contour, const struct cell *cell) {
    struct cell_work work = {.contour = contour, .size = contour->grid.step * cell->size};
    size_t first = contour->triangles.count;
    struct loop loop;
    for (int axis = 0; axis < 3; axis++)
        work.low = vec3_with(work.low, axis, grid_node(&contour->grid, axis, cell->at[axis]));
    for (int i = 0; i < 6; i++) {
        int at[3] = {cell->at[0], cell->at[1], cell->at[2]};
        at[i / 2] += i % 2 * cell->size;
        collect_face(&work, i / 2, at, cell->size, i % 2);
    }
    bool last = cell->size <= contour->finest || (cell->size <= contour->grid.small && contour->divisions == 0);
    for (int i = 0; i < work.count && !contour->failed && !(work.bad && !last); i++) {
        if (work.arcs[i].used)
            continue;
        if (follow_loop(&work, i, &loop))
            add_disc(&work, &loop);
        else
            work.bad = true;
    }
    if (last || contour->failed)
        return true;
    if (!work.bad && !some_intersect(contour, first) && !some_sag(contour, first) && passes(&work, cell, first))
        return true;
    contour->divisions -= cell->size <= contour->grid.small;
    contour->triangles.count = first;
    return false;
}
