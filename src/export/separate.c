/* Where parts of a solid touch or cross, a mesh cannot be both exact and free of intersections: they recede a little.
 */
#include "export/separate_internal.h"

#include "base/mem.h"
#include "export/triangles_internal.h"

#include <string.h>

enum { STEPS = 4 };

/* Shares of the tolerance: parts of the surface that are nearer than the first recede by the second. */
static const double touch_share = 0.05, recede_share = 0.15;

struct separation {
    struct solid_mesh *mesh;
    const struct solid_input *input;
    struct box_tree tree;
    double size;
    uint32_t *first, *next; /* by vertex and corner: the next corner at the vertex, or NO_INDEX */
    uint8_t *marked;        /* by vertex: it is to be moved */
    struct vec3 *before;    /* where it was */
    uint32_t hits;          /* triangles that intersect */
};

static void mark_hit(void *context, uint32_t one, uint32_t other) {
    struct separation *s = context;
    s->hits++;
    for (int i = 0; i < 6; i++)
        s->marked[solid_triangle_at(s->mesh, i < 3 ? one : other)->vertex[i % 3]] = 1;
}

/* The direction in which a vertex recedes: against its normals, of a corner those of its triangles. */
static struct vec3 outward_at(const struct separation *s, uint32_t vertex) {
    const struct solid_vertex *at = solid_vertex_at(s->mesh, vertex);
    if (at->sharp == VERTEX_SMOOTH)
        return at->normal[0];
    if (at->sharp == VERTEX_EDGE)
        return vec3_normalize(vec3_add(at->normal[0], at->normal[1]));
    struct vec3 sum = vec3_all(0);
    for (uint32_t i = s->first[vertex]; i != NO_INDEX; i = s->next[i]) {
        struct corners corners = corners_of(s->mesh, i / 3);
        sum = vec3_add(sum, triangle_normal(corners.point));
    }
    return vec3_normalize(sum);
}

static bool is_neighbour(const struct separation *s, uint32_t vertex, const struct corners *corners) {
    if (corners->vertex[0] == vertex || corners->vertex[1] == vertex || corners->vertex[2] == vertex)
        return true;
    for (uint32_t i = s->first[vertex]; i != NO_INDEX; i = s->next[i]) {
        const uint32_t *own = solid_triangle_at(s->mesh, i / 3)->vertex;
        for (int k = 0; k < 9; k++)
            if (own[k / 3] == corners->vertex[k % 3])
                return true;
    }
    return false;
}

/* Another part of the surface is within the distance; `opposite`: one that faces this one. */
static bool is_touched(const struct separation *s, uint32_t vertex, double distance, bool opposite) {
    struct vec3 point = solid_vertex_at(s->mesh, vertex)->point, outward = outward_at(s, vertex);
    struct box region = box_grow((struct box){point, point}, distance);
    struct box_tree_meeting meeting;
    uint32_t other;
    box_tree_meeting_begin(&meeting, &s->tree, &region);
    while (box_tree_meeting_next(&meeting, &other)) {
        struct corners corners = corners_of(s->mesh, other);
        if (triangle_distance_squared(point, corners.point) < distance * distance &&
            !is_neighbour(s, vertex, &corners) &&
            (!opposite || vec3_dot(outward, vec3_normalize(triangle_normal(corners.point))) < 0.3))
            return true;
    }
    return false;
}

static bool list_triangles(struct separation *s) {
    size_t vertices = s->mesh->vertices.count, corners = 3 * s->mesh->triangles.count;
    s->first = mem_alloc(vertices * sizeof *s->first);
    s->next = mem_alloc(corners * sizeof *s->next);
    if (!s->first || !s->next)
        return false;
    memset(s->first, 0xff, vertices * sizeof *s->first);
    for (uint32_t i = (uint32_t)corners; i-- > 0;) {
        uint32_t *first = &s->first[solid_triangle_at(s->mesh, i / 3)->vertex[i % 3]];
        s->next[i] = *first;
        *first = i;
    }
    return true;
}

/* Counts the intersections, and marks their vertices. */
static bool find_hits(struct separation *s, struct error *error) {
    box_tree_destroy(&s->tree);
    s->tree = (struct box_tree){0};
    s->hits = 0;
    memset(s->marked, 0, s->mesh->vertices.count);
    if (!triangle_tree_build(&s->tree, s->mesh, s->input->pool, error))
        return false;
    find_intersections(s->mesh, &s->tree, 1e-13 * s->size, mark_hit, s);
    return true;
}

/* Marks the vertices that another part is near to; how many there are. */
static uint32_t mark_touched(struct separation *s, double distance, bool opposite) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->mesh->vertices.count; i++) {
        bool touched = is_touched(s, i, distance, opposite);
        s->marked[i] = s->marked[i] || touched;
        count += touched;
    }
    return count;
}

/* Moves the marked vertices outwards. */
static uint32_t move_marked(struct separation *s, double distance, struct solid_findings *findings) {
    uint32_t count = (uint32_t)s->mesh->vertices.count, moved = 0;
    for (uint32_t i = 0; i < count; i++)
        s->before[i] = s->marked[i] ? outward_at(s, i) : vec3_all(0);
    for (uint32_t i = 0; i < count; i++) {
        struct vec3 *point = &solid_vertex_at(s->mesh, i)->point, outward = s->before[i];
        s->before[i] = *point;
        if (!s->marked[i])
            continue;
        *point = solid_round(s->input->csg, vec3_add_scaled(*point, outward, distance));
        findings->position = s->before[i];
        moved++;
    }
    return moved;
}

/* *better: fewer triangles intersect; else the vertices are where they were, and marked as before. */
static bool try_move(struct separation *s, double distance, bool *better, struct solid_findings *findings,
                     struct error *error) {
    uint32_t hits = s->hits, moved = move_marked(s, distance, findings);
    if (!find_hits(s, error))
        return false;
    *better = s->hits < hits || s->hits == 0;
    if (*better) {
        findings->separated += moved;
        return true;
    }
    for (uint32_t i = 0; i < s->mesh->vertices.count; i++)
        solid_vertex_at(s->mesh, i)->point = s->before[i];
    return find_hits(s, error);
}

/* First all that touch recede, then what still intersects: a gap that was too thin becomes wider, a wall thicker. */
static bool separate(struct separation *s, struct solid_findings *findings, struct error *error) {
    double tolerance = s->input->tolerance;
    bool better = true;
    if (!find_hits(s, error))
        return false;
    if (mark_touched(s, 1e-7 * s->size, false) == 0 && s->hits == 0)
        return true;
    memset(s->marked, 0, s->mesh->vertices.count);
    (void)mark_touched(s, touch_share * tolerance, true);
    if (!try_move(s, -recede_share * tolerance, &better, findings, error))
        return false;
    for (int step = 0; step < STEPS && s->hits > 0; step++) {
        if (!try_move(s, -recede_share * tolerance, &better, findings, error))
            return false;
        if (!better && !try_move(s, recede_share * tolerance, &better, findings, error))
            return false;
        if (!better)
            break;
    }
    return true;
}

bool separate_parts(struct solid_mesh *mesh, const struct solid_input *input, struct solid_findings *findings,
                    struct error *error) {
    struct separation s = {.mesh = mesh,
                           .input = input,
                           .size = vec3_max_abs(vec3_sub(input->csg->bounds.max, input->csg->bounds.min)),
                           .marked = mem_alloc_zero(mesh->vertices.count, 1),
                           .before = mem_alloc_zero(mesh->vertices.count, sizeof *s.before)};
    bool ok = (list_triangles(&s) && s.marked && s.before) || error_no_memory(error, "the mesh of a solid");
    ok = ok && separate(&s, findings, error);
    box_tree_destroy(&s.tree);
    mem_free(s.first);
    mem_free(s.next);
    mem_free(s.marked);
    mem_free(s.before);
    return ok;
}
