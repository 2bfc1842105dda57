/* Whether a mesh is closed: every edge is used by exactly two triangles, in opposite directions; and how much of it is
 * missing. Vertices with equal positions count as the same, also with different indices. Edges are gathered at their
 * lower vertex: count, prefix sum, fill; then each vertex sorts its own few. */
#include "base/random.h"
#include "mesh/mesh_internal.h"

#include "base/mem.h"
#include "base/sort.h"
#include "mesh/mesh_topology.h"

#include <math.h>
#include <string.h>

/* Sorted uses of the edges at one vertex: (other vertex) * 2 + direction. The first edge not used once each way, or the
 * count when all are. */
static size_t first_unpaired(const uint64_t *uses, size_t count) {
    for (size_t i = 0; i < count; i += 2) {
        bool paired = i + 1 < count && uses[i + 1] == (uses[i] ^ 1) && !(uses[i] & 1);
        bool third = i + 2 < count && uses[i + 2] >> 1 == uses[i] >> 1;
        if (!paired || third)
            return i;
    }
    return count;
}

static struct vec3 position(const struct mesh *mesh, uint32_t vertex) {
    const double *v = mesh->vertices[vertex];
    return vec3_make(v[0], v[1], v[2]);
}

/* The edges at a vertex that are not used once each way, while there is room for them. */
static void note_open_edges(struct mesh *mesh, uint32_t vertex, const uint64_t *uses, size_t count) {
    for (size_t i = 0; (i += first_unpaired(uses + i, count - i)) < count;) {
        if (mesh->open_edge_count == MESH_OPEN_EDGES)
            return;
        uint64_t other = uses[i] >> 1;
        mesh->open_edges[mesh->open_edge_count][0] = position(mesh, vertex);
        mesh->open_edges[mesh->open_edge_count++][1] = position(mesh, (uint32_t)other);
        while (i < count && uses[i] >> 1 == other)
            i++;
    }
}

static double enclosed_volume(const struct mesh *mesh) {
    double volume = 0;
    if (mesh->triangle_count == 0)
        return 0;
    const double *base = mesh->vertices[mesh->corners[0][0]];
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        struct vec3 p[3];
        for (int j = 0; j < 3; j++) {
            const double *v = mesh->vertices[mesh->corners[i][j]];
            p[j] = vec3_make(v[0] - base[0], v[1] - base[1], v[2] - base[2]);
        }
        volume += vec3_dot(p[0], vec3_cross(p[1], p[2]));
    }
    return volume;
}

/* The uses of the edges whose lower vertex is v, from start[v] to start[v + 1]. */
struct edge_uses {
    size_t *start;
    uint64_t *uses;
};

static void edge_uses_free(struct edge_uses *edges) {
    mem_free(edges->start);
    mem_free(edges->uses);
}

/* False: no memory. The caller frees it in any case. */
static bool edge_uses_make(const struct mesh *mesh, struct edge_uses *out) {
    uint32_t *same = mem_alloc((size_t)mesh->vertex_count * sizeof *same);
    size_t *start = out->start = mem_alloc_zero((size_t)mesh->vertex_count + 2, sizeof *start);
    uint64_t *uses = out->uses = mem_alloc(3 * (size_t)mesh->triangle_count * sizeof *uses);
    bool has_memory = same && start && uses && mesh_weld((const double(*)[3])mesh->vertices, mesh->vertex_count, same);
    /* Count one place further on, so that filling turns starts into ends of the vertex before. */
    for (int pass = 0; has_memory && pass < 2; pass++) {
        for (uint32_t i = 0; i < mesh->triangle_count; i++)
            for (int j = 0; j < 3; j++) {
                uint64_t a = same[mesh->corners[i][j]], b = same[mesh->corners[i][(j + 1) % 3]];
                uint64_t low = a < b ? a : b, high = a < b ? b : a;
                if (pass == 0)
                    start[low + 2]++;
                else
                    uses[start[low + 1]++] = high << 1 | (a > b);
            }
        for (size_t v = 2; pass == 0 && v < (size_t)mesh->vertex_count + 2; v++)
            start[v] += start[v - 1];
    }
    mem_free(same);
    return has_memory;
}

bool mesh_find_topology(struct mesh *mesh) {
    struct edge_uses edges;
    bool has_memory = edge_uses_make(mesh, &edges);
    if (has_memory) {
        mesh->open_edge_count = 0;
        for (uint32_t v = 0; v < mesh->vertex_count && mesh->open_edge_count < MESH_OPEN_EDGES; v++) {
            uint64_t *uses = edges.uses + edges.start[v];
            sort_words(uses, edges.start[v + 1] - edges.start[v]);
            note_open_edges(mesh, v, uses, edges.start[v + 1] - edges.start[v]);
        }
        mesh->closed = mesh->triangle_count > 0 && mesh->open_edge_count == 0;
        mesh->outward = mesh->closed && enclosed_volume(mesh) > 0;
    }
    edge_uses_free(&edges);
    return has_memory;
}

/* --- the opening --- */

#define NONE UINT32_MAX
enum { LEAVES, ARRIVES };

/* The edges that one triangle alone uses, in its direction; for each vertex a list of those that leave it, and one of
 * those that arrive. Edges that were walked have no ends. */
struct boundary {
    uint32_t (*ends)[2], (*next)[2]; /* of each edge */
    uint32_t (*first)[2];            /* of each vertex */
    uint32_t count;
};

static void add_boundary_edge(struct boundary *boundary, uint32_t from, uint32_t to) {
    uint32_t edge = boundary->count++;
    const uint32_t ends[2] = {from, to};
    for (int k = 0; k < 2; k++) {
        boundary->ends[edge][k] = ends[k];
        boundary->next[edge][k] = boundary->first[ends[k]][k];
        boundary->first[ends[k]][k] = edge;
    }
}

/* The next edge at the vertex that was not walked, or NONE. */
static uint32_t take_edge(struct boundary *boundary, uint32_t vertex, int list) {
    uint32_t *first = &boundary->first[vertex][list], edge;
    while ((edge = *first) != NONE) {
        *first = boundary->next[edge][list];
        if (boundary->ends[edge][LEAVES] != NONE)
            break;
    }
    return edge;
}

/* The other end of the next edge at the vertex, which counts as walked. Where triangles disagree about their outside,
 * the edge is walked against its direction. NONE: there is none. */
static uint32_t step(struct boundary *boundary, uint32_t vertex) {
    for (int list = LEAVES; list <= ARRIVES; list++) {
        uint32_t edge = take_edge(boundary, vertex, list);
        if (edge == NONE)
            continue;
        uint32_t other = boundary->ends[edge][1 - list];
        boundary->ends[edge][LEAVES] = NONE;
        return other;
    }
    return NONE;
}

/* Twice the vector area of one walk from the vertex, until it is there again, or until it can go no further: a straight
 * line closes it then. */
static struct vec3 follow_boundary(const struct mesh *mesh, struct boundary *boundary, uint32_t begin) {
    struct vec3 base = position(mesh, begin), sum = {0, 0, 0}, before = sum;
    for (uint32_t at = begin; (at = step(boundary, at)) != NONE && at != begin;) {
        struct vec3 here = vec3_sub(position(mesh, at), base);
        sum = vec3_add(sum, vec3_cross(before, here));
        before = here;
    }
    return sum;
}

static double area_of(const struct mesh *mesh) {
    double area = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        struct vec3 p = position(mesh, mesh->corners[i][0]);
        struct vec3 e = vec3_sub(position(mesh, mesh->corners[i][1]), p);
        area += vec3_length(vec3_cross(e, vec3_sub(position(mesh, mesh->corners[i][2]), p))) / 2;
    }
    return area;
}

/* How often the edge is used whose first use this is. */
static size_t times_used(const uint64_t *uses, size_t count) {
    size_t times = 1;
    while (times < count && uses[times] >> 1 == uses[0] >> 1)
        times++;
    return times;
}

/* All edges of the boundary; with `boundary` NULL, only their number. The uses of every vertex are sorted. */
static uint32_t find_boundary(const struct mesh *mesh, const struct edge_uses *edges, struct boundary *boundary) {
    uint32_t count = 0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        for (size_t i = edges->start[v], times; i < edges->start[v + 1]; i += times) {
            uint64_t use = edges->uses[i];
            times = times_used(&edges->uses[i], edges->start[v + 1] - i);
            uint32_t other = (uint32_t)(use >> 1);
            if (times != 1 || other == v)
                continue;
            count++;
            if (boundary)
                add_boundary_edge(boundary, use & 1 ? other : v, use & 1 ? v : other);
        }
    return count;
}

/* The lowest vertex found so far of the connected part of the mesh. */
static uint32_t part_of(uint32_t *lower, uint32_t vertex) {
    while (lower[vertex] != vertex)
        vertex = lower[vertex] = lower[lower[vertex]];
    return vertex;
}

/* Connects the ends of all edges. */
static void find_parts(const struct mesh *mesh, const struct edge_uses *edges, uint32_t *lower) {
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        lower[v] = v;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        for (size_t i = edges->start[v]; i < edges->start[v + 1]; i++) {
            uint32_t a = part_of(lower, v), b = part_of(lower, (uint32_t)(edges->uses[i] >> 1));
            *(a < b ? &lower[b] : &lower[a]) = a < b ? a : b;
        }
}

/* The openings of a part: twice their vector areas, and the sum of the lengths of these. */
struct opening {
    struct vec3 sum;
    double lengths;
};

/* Walks along all edges. openings: zero, of the lowest vertex of each part. */
static double opening_of(const struct mesh *mesh, struct boundary *boundary, uint32_t *lower,
                         struct opening *openings) {
    struct vec3 all = {0, 0, 0};
    double lost = 0;
    for (uint32_t i = 0; i < boundary->count; i++)
        while (boundary->ends[i][LEAVES] != NONE) {
            uint32_t begin = boundary->ends[i][LEAVES];
            struct opening *opening = &openings[part_of(lower, begin)];
            struct vec3 loop = follow_boundary(mesh, boundary, begin);
            opening->sum = vec3_add(opening->sum, loop);
            opening->lengths += vec3_length(loop);
        }
    /* A part may close the opening of another one, as the lid of a pot; a tube does not close itself. */
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        all = vec3_add(all, openings[v].sum);
        lost += openings[v].lengths - vec3_length(openings[v].sum);
    }
    return (vec3_length(all) + lost) / 2;
}

/* False: no memory. */
static bool find_opening(const struct mesh *mesh, const struct edge_uses *edges, double *share) {
    uint32_t count = find_boundary(mesh, edges, NULL);
    struct boundary boundary = {.ends = mem_alloc((size_t)count * sizeof *boundary.ends),
                                .next = mem_alloc((size_t)count * sizeof *boundary.next),
                                .first = mem_alloc((size_t)mesh->vertex_count * sizeof *boundary.first)};
    uint32_t *lower = mem_alloc((size_t)mesh->vertex_count * sizeof *lower);
    struct opening *openings = mem_alloc_zero(mesh->vertex_count, sizeof *openings);
    bool has_memory = boundary.ends && boundary.next && boundary.first && lower && openings;
    if (has_memory) {
        double area = area_of(mesh);
        memset(boundary.first, 0xff, (size_t)mesh->vertex_count * sizeof *boundary.first);
        find_boundary(mesh, edges, &boundary);
        find_parts(mesh, edges, lower);
        *share = area > 0 ? opening_of(mesh, &boundary, lower, openings) / area : 0;
    }
    mem_free(boundary.ends);
    mem_free(boundary.next);
    mem_free(boundary.first);
    mem_free(lower);
    mem_free(openings);
    return has_memory;
}

bool mesh_find_opening(const struct mesh *mesh, double *share) {
    struct edge_uses edges;
    bool has_memory = edge_uses_make(mesh, &edges);
    for (uint32_t v = 0; has_memory && v < mesh->vertex_count; v++)
        sort_words(edges.uses + edges.start[v], edges.start[v + 1] - edges.start[v]);
    has_memory = has_memory && find_opening(mesh, &edges, share);
    edge_uses_free(&edges);
    return has_memory;
}

/* A hash table with open addressing, at most half full; it never leaves this function, so the order of its slots has no
 * effect: the lowest vertex is inserted first. */

static uint64_t position_hash(const double p[3]) {
    uint64_t key = 0;
    for (int k = 0; k < 3; k++) {
        double x = p[k] + 0.0; /* -0 becomes 0 */
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        key = (key ^ bits) * UINT64_C(0x9e3779b97f4a7c15);
        key ^= key >> 29;
    }
    return random_mix(key);
}

static bool same_position(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

bool mesh_weld(const double (*vertices)[3], uint32_t count, uint32_t *same) {
    size_t slots = 16;
    while (slots < 2 * (size_t)count)
        slots *= 2;
    uint32_t *table = mem_alloc(slots * sizeof *table);
    if (!table)
        return false;
    memset(table, 0xff, slots * sizeof *table);
    for (uint32_t v = 0; v < count; v++) {
        size_t at = (size_t)position_hash(vertices[v]) & (slots - 1);
        while (table[at] != NONE && !same_position(vertices[table[at]], vertices[v]))
            at = (at + 1) & (slots - 1);
        if (table[at] == NONE)
            table[at] = v;
        same[v] = table[at];
    }
    mem_free(table);
    return true;
}

/* Kept vertices by the cell of a grid of the distance that they are in, as lists: at most a few in each. */
struct cells {
    const double (*vertices)[3];
    double distance;
    uint32_t *first, *next; /* by hash; by vertex */
    size_t mask;
};

static size_t cell_at(const struct cells *cells, const double corner[3]) {
    return (size_t)position_hash(corner) & cells->mask;
}

/* The lowest kept vertex closer than the distance, in the cells around p; NONE. */
static uint32_t kept_near(const struct cells *cells, const double p[3], const double cell[3]) {
    uint32_t found = NONE;
    for (int k = 0; k < 27; k++) {
        const double neighbour[3] = {cell[0] + k % 3 - 1, cell[1] + k / 3 % 3 - 1, cell[2] + k / 9 - 1};
        for (uint32_t v = cells->first[cell_at(cells, neighbour)]; v != NONE; v = cells->next[v]) {
            const double *q = cells->vertices[v];
            struct vec3 offset = vec3_make(q[0] - p[0], q[1] - p[1], q[2] - p[2]);
            if (v < found && vec3_length(offset) < cells->distance)
                found = v;
        }
    }
    return found;
}

bool mesh_weld_near(const double (*vertices)[3], uint32_t count, double distance, uint32_t *same) {
    size_t slots = 16;
    double largest = 0;
    for (size_t i = 0; i < 3 * (size_t)count; i++)
        largest = math_max(largest, fabs(vertices[i / 3][i % 3]));
    /* Closer than the spacing of doubles is equal, and cells have no neighbours there. */
    if (distance < largest * 0x1p-50)
        return mesh_weld(vertices, count, same);
    while (slots < 2 * (size_t)count)
        slots *= 2;
    struct cells cells = {.vertices = vertices,
                          .distance = distance,
                          .first = mem_alloc(slots * sizeof *cells.first),
                          .next = mem_alloc((size_t)count * sizeof *cells.next),
                          .mask = slots - 1};
    bool has_memory = cells.first && cells.next;
    if (has_memory)
        memset(cells.first, 0xff, slots * sizeof *cells.first);
    for (uint32_t v = 0; v < count && has_memory; v++) {
        const double *p = vertices[v];
        const double cell[3] = {floor(p[0] / distance), floor(p[1] / distance), floor(p[2] / distance)};
        uint32_t near = kept_near(&cells, p, cell);
        same[v] = near == NONE ? v : near;
        if (near != NONE)
            continue;
        cells.next[v] = cells.first[cell_at(&cells, cell)];
        cells.first[cell_at(&cells, cell)] = v;
    }
    mem_free(cells.first);
    mem_free(cells.next);
    return has_memory;
}
