/* Half-edge collapses: a vertex is moved to a neighbour, and the two triangles between them disappear. So every vertex
 * that is left lies exactly on the solid. A vertex on an edge of the solid moves only along the edge, a corner never.
 * Removed vertices stay as samples, in lists of the triangles that are nearest to them; a collapse is refused if a
 * sample would be farther than the tolerance from the triangles around it (samples of edges: from the edge).
 *
 * Passes over all vertices, in a random order, with a growing limit of the length: first short edges everywhere. */
#include "export/simplify_internal.h"

#include "base/arena.h"
#include "base/key_map.h"
#include "base/random.h"
#include "export/triangles_internal.h"

enum { RING_LIMIT = 64, PASS_LIMIT = 60 };

static const double growth = 1.7;       /* of the limit of the length, in a pass */
static const double sliver_share = 0.3; /* of the tolerance, for triangles without a height */
static const double close_share = 0.1;  /* of the tolerance, for vertices near others of the surface */

struct sample {
    struct vec3 point;
    uint32_t next;
    bool crease, close;
};
/* A piece of the surface, as far as the vertices show: a plane if it is not curved. Vertices that receded from another
 * part lie in no plane. */
struct piece {
    struct vec3 point, normal;
    bool curved;
};
/* Corners are numbers: three times the triangle, and the place of the vertex in it. */
struct simplifier {
    struct solid_mesh *mesh;
    const struct simplify_input *input;
    struct arena arena;    /* of the arrays */
    double tolerance;      /* of this pass */
    uint32_t *head, *next; /* by vertex and corner: the corners at a vertex */
    uint16_t *degree;
    uint8_t *kind;          /* by vertex: as solid_vertex.sharp, by the creases that are there */
    uint8_t *crease;        /* by triangle: bit k: its edge from corner k is an edge of the solid */
    uint8_t *waiting;       /* by vertex: something has changed since it was refused */
    uint32_t *first_sample; /* by triangle */
    struct list samples;
    struct key_map piece_numbers; /* by surface + 1 */
    struct list pieces;
    uint32_t *piece; /* by triangle */
    uint32_t *mark, stamp;
    struct list moved; /* struct moved_sample */
};

struct ring_triangle {
    uint32_t triangle;
    struct vec3 point[3]; /* the new one: the vertex that stays first */
    uint8_t crease;
};
struct collapse {
    uint32_t from, to;
    uint32_t removed[2];
    int removed_count, count;
    struct ring_triangle ring[RING_LIMIT];
    bool is_planar; /* all of it lies in planes */
};
struct moved_sample {
    uint32_t sample;
    int target; /* in the ring */
};

static uint32_t *vertices_of(const struct simplifier *s, uint32_t triangle) {
    return solid_triangle_at(s->mesh, triangle)->vertex;
}
static uint32_t vertex_at(const struct simplifier *s, uint32_t corner) {
    return vertices_of(s, corner / 3)[corner % 3];
}
/* The vertex that follows a corner in its triangle by so many places. */
static uint32_t vertex_after(const struct simplifier *s, uint32_t corner, uint32_t steps) {
    return vertices_of(s, corner / 3)[(corner + steps) % 3];
}
static struct vec3 point_of(const struct simplifier *s, uint32_t vertex) {
    return solid_vertex_at(s->mesh, vertex)->point;
}
/* Corners and triangles: `corner % 3` of three times the triangle is the place. */
static uint32_t corner_after(uint32_t corner, uint32_t steps) {
    return corner / 3 * 3 + (corner + steps) % 3;
}
static bool is_removed(const struct simplifier *s, uint32_t triangle) {
    return vertices_of(s, triangle)[0] == vertices_of(s, triangle)[1];
}
static bool is_crease(const struct simplifier *s, uint32_t corner) {
    return s->crease[corner / 3] >> corner % 3 & 1;
}

static void attach(struct simplifier *s, uint32_t corner) {
    uint32_t vertex = vertex_at(s, corner);
    s->next[corner] = s->head[vertex];
    s->head[vertex] = corner;
    s->degree[vertex]++;
}

static void detach(struct simplifier *s, uint32_t corner) {
    uint32_t vertex = vertex_at(s, corner), *link = &s->head[vertex];
    while (*link != corner)
        link = &s->next[*link];
    *link = s->next[corner];
    s->degree[vertex]--;
}

/* --- pieces of the surface --- */

/* Distances from planes below it are rounding. */
static double plane_slack(const struct simplifier *s) {
    return 1e-6 * s->input->size + s->input->resolution;
}

static bool note_piece(struct simplifier *s, uint32_t surface, struct vec3 point, struct vec3 normal) {
    uint32_t *number = key_map_find(&s->piece_numbers, (uint64_t)surface + 1);
    if (number) {
        struct piece *piece = (struct piece *)s->pieces.items + *number;
        piece->curved = piece->curved || vec3_dot(piece->normal, normal) < 1 - 1e-9 ||
                        fabs(vec3_dot(piece->normal, vec3_sub(point, piece->point))) > plane_slack(s);
        return true;
    }
    const struct piece piece = {point, normal, false};
    return list_add(&s->pieces, &piece, 1, sizeof piece) &&
           key_map_add(&s->piece_numbers, (uint64_t)surface + 1, (uint32_t)s->pieces.count - 1);
}

/* The plane of a triangle's piece, or NULL. */
static const struct piece *plane_of(const struct simplifier *s, uint32_t triangle) {
    const struct piece *piece = (struct piece *)s->pieces.items + s->piece[triangle];
    return piece->curved ? NULL : piece;
}

static bool note_pieces(struct simplifier *s) {
    bool ok = true;
    for (uint32_t i = 0; i < s->mesh->vertices.count; i++) {
        const struct solid_vertex *vertex = solid_vertex_at(s->mesh, i);
        for (int k = 0; k <= vertex->sharp; k++)
            ok = ok && note_piece(s, vertex->surface[k], vertex->point, vertex->normal[k]);
    }
    /* A triangle may be of a piece that no vertex names: it counts as curved. */
    for (uint32_t i = 0; ok && i < s->mesh->triangles.count; i++) {
        uint32_t surface = solid_triangle_at(s->mesh, i)->surface;
        uint64_t key = (uint64_t)surface + 1;
        if (!key_map_find(&s->piece_numbers, key))
            ok = ok && note_piece(s, surface, vec3_all(0), vec3_all(0)) &&
                 note_piece(s, surface, vec3_all(0), vec3_all(0));
        if (ok)
            s->piece[i] = *key_map_find(&s->piece_numbers, key);
    }
    return ok;
}

/* --- creases --- */

static struct vec3 unit_normal(const struct simplifier *s, uint32_t triangle) {
    struct corners corners = corners_of(s->mesh, triangle);
    return vec3_normalize(triangle_normal(corners.point));
}

/* The edge from a corner is one of the solid: both ends are, and its triangles are of two pieces or at an angle. */
static bool is_edge_of_solid(const struct simplifier *s, uint32_t corner) {
    uint32_t from = vertex_at(s, corner), to = vertex_after(s, corner, 1);
    if (solid_vertex_at(s->mesh, from)->sharp == VERTEX_SMOOTH || solid_vertex_at(s->mesh, to)->sharp == VERTEX_SMOOTH)
        return false;
    for (uint32_t c = s->head[from]; c != NO_INDEX; c = s->next[c]) {
        if (vertex_after(s, c, 2) != to)
            continue;
        return solid_triangle_at(s->mesh, c / 3)->surface != solid_triangle_at(s->mesh, corner / 3)->surface ||
               vec3_dot(unit_normal(s, c / 3), unit_normal(s, corner / 3)) < 0.9;
    }
    return false;
}

static void find_creases(struct simplifier *s) {
    for (uint32_t corner = 0; corner < 3 * s->mesh->triangles.count; corner++)
        if (!is_removed(s, corner / 3) && is_edge_of_solid(s, corner))
            s->crease[corner / 3] |= (uint8_t)(1 << corner % 3);
    for (uint32_t i = 0; i < s->mesh->vertices.count; i++) {
        int creases = 0;
        for (uint32_t c = s->head[i]; c != NO_INDEX; c = s->next[c])
            creases += is_crease(s, c);
        bool corner = solid_vertex_at(s->mesh, i)->sharp == VERTEX_CORNER || s->input->keep[i] == KEEP_VERTEX ||
                      (creases != 0 && creases != 2);
        s->kind[i] = corner ? VERTEX_CORNER : creases ? VERTEX_EDGE : VERTEX_SMOOTH;
    }
}

/* --- the tests of a collapse --- */

/* The triangles around the vertex that moves: two are removed, the others change. False: it cannot be moved. */
static bool gather_ring(const struct simplifier *s, struct collapse *collapse) {
    collapse->removed_count = collapse->count = 0;
    for (uint32_t c = s->head[collapse->from]; c != NO_INDEX; c = s->next[c]) {
        bool removed = vertex_after(s, c, 1) == collapse->to || vertex_after(s, c, 2) == collapse->to;
        if (removed ? collapse->removed_count == 2 : collapse->count == RING_LIMIT)
            return false;
        if (removed)
            collapse->removed[collapse->removed_count++] = c;
        else
            collapse->ring[collapse->count++] = (struct ring_triangle){
                c,
                {point_of(s, collapse->to), point_of(s, vertex_after(s, c, 1)), point_of(s, vertex_after(s, c, 2))},
                (uint8_t)(is_crease(s, c) | is_crease(s, corner_after(c, 1)) << 1 |
                          is_crease(s, corner_after(c, 2)) << 2)};
    }
    return collapse->removed_count == 2;
}

/* The corner of a removed triangle whose edge joins the two vertices, and the third vertex. */
static uint32_t joining_corner(const struct simplifier *s, uint32_t corner, uint32_t to) {
    return vertex_after(s, corner, 1) == to ? corner : corner_after(corner, 2);
}
static uint32_t third_vertex(const struct simplifier *s, uint32_t corner, uint32_t to) {
    return vertex_after(s, corner, 1) == to ? vertex_after(s, corner, 2) : vertex_after(s, corner, 1);
}

/* The surface stays what it is: the vertices have two neighbours in common, and no vertex gets less than three
 * triangles (the link condition). */
static bool keeps_topology(struct simplifier *s, const struct collapse *collapse) {
    uint32_t from = collapse->from, to = collapse->to, common = 0;
    s->stamp++;
    for (uint32_t c = s->head[from]; c != NO_INDEX; c = s->next[c])
        s->mark[vertex_after(s, c, 1)] = s->stamp;
    for (uint32_t c = s->head[to]; c != NO_INDEX; c = s->next[c])
        common += s->mark[vertex_after(s, c, 1)] == s->stamp;
    for (int i = 0; i < 2; i++)
        if (s->degree[third_vertex(s, collapse->removed[i], to)] <= 3)
            return false;
    return common == 2 && s->degree[from] + s->degree[to] - 4 >= 3;
}

/* Edges of the solid are kept. New triangles take over those of the removed ones. */
static bool keeps_creases(const struct simplifier *s, struct collapse *collapse) {
    uint32_t to = collapse->to;
    if (s->kind[collapse->from] == VERTEX_EDGE && !is_crease(s, joining_corner(s, collapse->removed[0], to)))
        return false;
    for (int i = 0; i < 2; i++) {
        uint32_t corner = collapse->removed[i], third = third_vertex(s, corner, to);
        bool to_follows = vertex_after(s, corner, 1) == to;
        if (is_crease(s, to_follows ? corner_after(corner, 2) : corner))
            return false;
        if (!is_crease(s, corner_after(corner, 1)))
            continue;
        for (int k = 0; k < collapse->count; k++) {
            struct ring_triangle *ring = &collapse->ring[k];
            if (vertex_after(s, ring->triangle, 1) == third)
                ring->crease |= 1;
            if (vertex_after(s, ring->triangle, 2) == third)
                ring->crease |= 4;
        }
    }
    return true;
}

/* The normal of a piece at a vertex: of several, the one nearest to `about`. */
static bool normal_of(const struct simplifier *s, uint32_t vertex, uint32_t surface, struct vec3 about,
                      struct vec3 *out) {
    const struct solid_vertex *at = solid_vertex_at(s->mesh, vertex);
    bool found = false;
    for (int i = 0; i <= at->sharp; i++) {
        if (at->surface[i] != surface || (found && vec3_dot(at->normal[i], about) <= vec3_dot(*out, about)))
            continue;
        *out = at->normal[i];
        found = true;
    }
    if (!found && at->sharp == VERTEX_SMOOTH)
        *out = at->normal[0];
    return found || at->sharp == VERTEX_SMOOTH;
}

/* On a curved piece: the new triangle turns with the surface, and the surface is not high over its edges. */
static bool fits_curve(const struct simplifier *s, const struct collapse *collapse, const struct ring_triangle *ring,
                       struct vec3 normal) {
    const uint32_t vertex[3] = {collapse->to, vertex_after(s, ring->triangle, 1), vertex_after(s, ring->triangle, 2)};
    uint32_t surface = solid_triangle_at(s->mesh, ring->triangle / 3)->surface;
    struct vec3 normals[3];
    bool known[3];
    for (int i = 0; i < 3; i++) {
        known[i] = normal_of(s, vertex[i], surface, normal, &normals[i]);
        if (known[i] && solid_vertex_at(s->mesh, vertex[i])->sharp != VERTEX_CORNER &&
            vec3_dot(normal, normals[i]) < 0.7)
            return false;
    }
    for (int i = 0; i < 3; i++) {
        int k = (i + 1) % 3;
        struct vec3 along = vec3_sub(ring->point[i], ring->point[k]);
        if (known[i] && known[k] && fabs(vec3_dot(vec3_sub(normals[i], normals[k]), along)) > 8 * s->tolerance)
            return false;
    }
    return true;
}

static double longest_edge(const struct vec3 point[3]) {
    double a = vec3_length(vec3_sub(point[1], point[0])), b = vec3_length(vec3_sub(point[2], point[1]));
    return math_max(math_max(a, b), vec3_length(vec3_sub(point[0], point[2])));
}

static bool fits_surface(const struct simplifier *s, struct collapse *collapse, const struct ring_triangle *ring) {
    struct vec3 before[3] = {point_of(s, collapse->from), ring->point[1], ring->point[2]};
    struct vec3 normal = triangle_normal(ring->point), old_normal = triangle_normal(before);
    const struct piece *plane = plane_of(s, ring->triangle / 3);
    double twice_area = vec3_length(normal), twice_old = vec3_length(old_normal);
    double length = longest_edge(ring->point), height = twice_area / length;
    double old_length = longest_edge(before), old_height = old_length > 0 ? twice_old / old_length : 0;
    /* Not much thinner than before. */
    if ((height < 0.02 * s->input->tolerance && height < 0.5 * old_height) ||
        (height < s->input->resolution && height <= old_height) ||
        (!plane && height < 0.01 * length && height < 0.999 * old_height) || !(twice_area > 0))
        return false;
    normal = vec3_scale(normal, 1 / twice_area);
    if (plane) {
        double off = vec3_dot(plane->normal, vec3_sub(ring->point[0], ring->point[1]));
        return vec3_dot(normal, plane->normal) > 0.9 && fabs(off) < plane_slack(s);
    }
    collapse->is_planar = false;
    double fine = 0.05 * s->input->tolerance;
    if (twice_old > fine * fine && vec3_dot(normal, old_normal) < 0.5 * twice_old)
        return false;
    return fits_curve(s, collapse, ring, normal);
}

/* The new triangle that is nearest to a sample, or -1. */
static int nearest_target(const struct simplifier *s, const struct collapse *collapse, const struct sample *sample) {
    double distance_limit = s->tolerance * (sample->close ? close_share : 1), limit = distance_limit * distance_limit;
    double minimum = INFINITY;
    int best = -1;
    for (int i = 0; i < collapse->count && minimum > 1e-4 * limit; i++) {
        const struct ring_triangle *ring = &collapse->ring[i];
        double distance = sample->crease ? INFINITY : triangle_distance_squared(sample->point, ring->point);
        for (int k = 0; sample->crease && k < 3; k++)
            if (ring->crease >> k & 1)
                distance = math_min(distance,
                                    segment_distance_squared(sample->point, ring->point[k], ring->point[(k + 1) % 3]));
        if (distance < minimum) {
            minimum = distance;
            best = i;
        }
    }
    return minimum <= limit ? best : -1;
}

static bool move_sample(struct simplifier *s, const struct collapse *collapse, uint32_t sample) {
    const struct moved_sample moved = {sample, nearest_target(s, collapse, (struct sample *)s->samples.items + sample)};
    return moved.target >= 0 && list_add(&s->moved, &moved, 1, sizeof moved);
}

/* All samples around, and the vertex that moves, unless it is inside of a plane, are near enough to new triangles. */
static bool keeps_samples(struct simplifier *s, const struct collapse *collapse) {
    bool edge = s->kind[collapse->from] == VERTEX_EDGE, ok = true;
    const struct sample own = {point_of(s, collapse->from), NO_INDEX, edge,
                               s->input->keep[collapse->from] == KEEP_CLOSE};
    size_t count = s->samples.count;
    s->moved.count = 0;
    if (edge || !collapse->is_planar)
        ok = list_add(&s->samples, &own, 1, sizeof own) && move_sample(s, collapse, (uint32_t)count);
    for (uint32_t c = s->head[collapse->from]; c != NO_INDEX; c = s->next[c])
        for (uint32_t i = s->first_sample[c / 3]; i != NO_INDEX && ok; i = ((struct sample *)s->samples.items)[i].next)
            ok = move_sample(s, collapse, i);
    s->samples.count = ok ? s->samples.count : count;
    return ok;
}

/* --- the collapse --- */

static void apply(struct simplifier *s, const struct collapse *collapse) {
    uint32_t from = collapse->from, to = collapse->to;
    const struct moved_sample *moved = s->moved.items;
    struct sample *samples = s->samples.items;
    for (uint32_t c = s->head[from]; c != NO_INDEX; c = s->next[c])
        s->first_sample[c / 3] = NO_INDEX;
    for (size_t i = 0; i < s->moved.count; i++) {
        uint32_t *first = &s->first_sample[collapse->ring[moved[i].target].triangle / 3];
        samples[moved[i].sample].next = *first;
        *first = moved[i].sample;
    }
    for (int i = 0; i < 2; i++) {
        detach(s, corner_after(collapse->removed[i], 1));
        detach(s, corner_after(collapse->removed[i], 2));
        vertices_of(s, collapse->removed[i] / 3)[0] = vertices_of(s, collapse->removed[i] / 3)[1];
    }
    for (int i = 0; i < collapse->count; i++) {
        uint32_t corner = collapse->ring[i].triangle;
        vertices_of(s, corner / 3)[corner % 3] = to;
        attach(s, corner);
        s->crease[corner / 3] = 0;
        for (uint32_t k = 0; k < 3; k++)
            s->crease[corner / 3] |= (uint8_t)((collapse->ring[i].crease >> k & 1) << (corner + k) % 3);
        s->waiting[vertex_after(s, corner, 1)] = s->waiting[vertex_after(s, corner, 2)] = 1;
    }
    s->waiting[to] = 1;
    s->head[from] = NO_INDEX;
    s->degree[from] = 0;
}

static bool collapse_edge(struct simplifier *s, uint32_t from, uint32_t to) {
    struct collapse collapse = {.from = from, .to = to, .is_planar = true};
    if (!gather_ring(s, &collapse) || !keeps_creases(s, &collapse) || !keeps_topology(s, &collapse))
        return false;
    for (int i = 0; i < 2; i++)
        collapse.is_planar = collapse.is_planar && plane_of(s, collapse.removed[i] / 3);
    /* At the same place nothing changes. */
    bool moves = vec3_length(vec3_sub(point_of(s, from), point_of(s, to))) > 0;
    for (int i = 0; i < collapse.count; i++)
        if (moves && !fits_surface(s, &collapse, &collapse.ring[i]))
            return false;
    if (!keeps_samples(s, &collapse))
        return false;
    apply(s, &collapse);
    return true;
}

/* The neighbours that are near enough, the flattest way first. */
struct neighbour {
    double cost;
    uint32_t vertex;
};

static int sort_neighbours(const struct simplifier *s, uint32_t vertex, double limit, struct neighbour *out,
                           bool *all) {
    const struct solid_vertex *at = solid_vertex_at(s->mesh, vertex);
    int count = 0;
    *all = true;
    for (uint32_t c = s->head[vertex]; c != NO_INDEX; c = s->next[c]) {
        const struct solid_vertex *other = solid_vertex_at(s->mesh, vertex_after(s, c, 1));
        struct vec3 along = vec3_sub(other->point, at->point);
        double length = vec3_length(along);
        if (length >= limit) {
            *all = false;
            continue;
        }
        double cost = fabs(vec3_dot(vec3_sub(other->normal[0], at->normal[0]), along)) +
                      1e-3 * s->input->tolerance * length / limit;
        int rank = count++;
        for (; rank > 0 && out[rank - 1].cost > cost; rank--)
            out[rank] = out[rank - 1];
        out[rank] = (struct neighbour){cost, vertex_after(s, c, 1)};
    }
    return count;
}

/* A vertex that is refused waits until something around it changes. */
static bool remove_vertex(struct simplifier *s, uint32_t vertex, double limit, bool final) {
    struct neighbour neighbours[RING_LIMIT];
    bool all;
    if (s->degree[vertex] > RING_LIMIT - 4)
        return false;
    int count = sort_neighbours(s, vertex, limit, neighbours, &all);
    for (int i = 0; i < count; i++)
        if (collapse_edge(s, vertex, neighbours[i].vertex))
            return true;
    s->waiting[vertex] = !(all && final);
    return false;
}

/* Of two corners at one place the one with fewer pieces of the surface goes, also if it is kept: nothing moves. */
static bool join_corners(struct simplifier *s, const struct corners *c) {
    for (int k = 0; k < 3; k++) {
        for (int n = (k + 1) % 3; n != k; n = (n + 1) % 3) {
            bool fewer = solid_vertex_at(s->mesh, c->vertex[k])->sharp <= solid_vertex_at(s->mesh, c->vertex[n])->sharp;
            if (fewer && vec3_length(vec3_sub(c->point[k], c->point[n])) <= 0 &&
                collapse_edge(s, c->vertex[k], c->vertex[n]))
                return true;
        }
    }
    return false;
}

/* Triangles without a height lie along edges of the solid, and their normals mean nothing: the vertex in the middle of
 * the three goes, before creases are looked for. */
static void remove_slivers(struct simplifier *s) {
    s->tolerance = sliver_share * s->input->tolerance;
    for (uint32_t i = 0; i < s->mesh->triangles.count; i++) {
        if (is_removed(s, i))
            continue;
        struct corners c = corners_of(s->mesh, i);
        double length = longest_edge(c.point), twice_area = vec3_length(triangle_normal(c.point));
        if (twice_area > 8 * s->input->resolution * length || join_corners(s, &c))
            continue;
        for (int k = 0; k < 3; k++) {
            double opposite = vec3_length(vec3_sub(c.point[(k + 1) % 3], c.point[(k + 2) % 3]));
            if (opposite < length || s->input->keep[c.vertex[k]] == KEEP_VERTEX)
                continue;
            if (!collapse_edge(s, c.vertex[k], c.vertex[(k + 1) % 3]))
                (void)collapse_edge(s, c.vertex[k], c.vertex[(k + 2) % 3]);
            break;
        }
    }
}

static uint32_t *shuffled(struct arena *arena, uint32_t count) {
    uint32_t *order = arena_alloc_array(arena, count, sizeof *order);
    for (uint32_t i = 0; order && i < count; i++)
        order[i] = i;
    for (uint32_t i = count; order && i-- > 1;) {
        uint32_t other = (uint32_t)(random_mix(i) % (i + 1)), moved = order[i];
        order[i] = order[other];
        order[other] = moved;
    }
    return order;
}

static bool run_passes(struct simplifier *s) {
    uint32_t remaining = (uint32_t)s->mesh->vertices.count, *order = shuffled(&s->arena, remaining);
    double maximum = 4 * s->input->size, limit = s->input->size / 256, share = 0.8 * s->input->tolerance;
    if (!order)
        return false;
    for (int pass = 0; pass < PASS_LIMIT; pass++) {
        uint32_t removed = 0, kept = 0;
        s->tolerance = share * math_min(1, 0.4 + 0.2 * pass);
        bool final = pass >= 3;
        for (uint32_t i = 0; i < remaining; i++) {
            uint32_t vertex = order[i];
            if (s->degree[vertex] == 0 || s->kind[vertex] == VERTEX_CORNER)
                continue;
            bool gone = s->waiting[vertex] && remove_vertex(s, vertex, limit, final);
            removed += gone;
            if (!gone)
                order[kept++] = vertex;
        }
        remaining = kept;
        if (limit >= maximum && removed == 0)
            break;
        limit = math_min(maximum, limit * growth);
    }
    return true;
}

static bool begin(struct simplifier *s) {
    size_t vertices = s->mesh->vertices.count, triangles = s->mesh->triangles.count;
    s->head = arena_alloc_array(&s->arena, vertices, sizeof *s->head);
    s->next = arena_alloc_array(&s->arena, 3 * triangles, sizeof *s->next);
    s->degree = arena_alloc_array(&s->arena, vertices, sizeof *s->degree);
    s->kind = arena_alloc_array(&s->arena, vertices, 1);
    s->waiting = arena_alloc_array(&s->arena, vertices, 1);
    s->crease = arena_alloc_array(&s->arena, triangles, 1);
    s->piece = arena_alloc_array(&s->arena, triangles, sizeof *s->piece);
    s->first_sample = arena_alloc_array(&s->arena, triangles, sizeof *s->first_sample);
    s->mark = arena_alloc_array(&s->arena, vertices, sizeof *s->mark);
    if (!s->head || !s->next || !s->degree || !s->kind || !s->waiting || !s->crease || !s->piece || !s->first_sample ||
        !s->mark)
        return false;
    memset(s->head, 0xff, vertices * sizeof *s->head);
    memset(s->first_sample, 0xff, triangles * sizeof *s->first_sample);
    memset(s->waiting, 1, vertices);
    for (uint32_t corner = 0; corner < 3 * triangles; corner++)
        attach(s, corner);
    if (!note_pieces(s))
        return false;
    remove_slivers(s);
    find_creases(s);
    return true;
}

bool simplify_mesh(struct solid_mesh *mesh, const struct simplify_input *input) {
    struct simplifier s = {.mesh = mesh, .input = input};
    bool ok = begin(&s) && run_passes(&s);
    arena_destroy(&s.arena);
    list_destroy(&s.samples);
    list_destroy(&s.pieces);
    list_destroy(&s.moved);
    key_map_destroy(&s.piece_numbers);
    return ok && solid_mesh_compact(mesh);
}
