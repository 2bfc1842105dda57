/* From the contour of a solid to its mesh. Triangles are removed without tests for intersections, which would take most
 * of the time; afterwards all are tested, points of them against the solid, and points of the solid against them. Where
 * something is wrong the vertices around it are kept, and it is done again. The last resort is another grid. */
#include "export/solid_mesh_internal.h"

#include "base/key_map.h"
#include "base/mem.h"
#include "export/contour_internal.h"
#include "export/separate_internal.h"
#include "export/simplify_internal.h"
#include "export/solid_cast_internal.h"
#include "export/triangles_internal.h"
#include "math/exact.h"
#include "mesh/mesh.h"
#include "mesh/mesh_topology.h"

enum { ROUNDS = 6, MANY_FAULTS = 200, GRIDS = 4, GRIDS_WITH_FAULTS = 2, MIN_CELLS = 24, MAX_CELLS = 64 };

void solid_mesh_destroy(struct solid_mesh *mesh) {
    list_destroy(&mesh->vertices);
    list_destroy(&mesh->triangles);
}

bool solid_mesh_compact(struct solid_mesh *mesh) {
    uint32_t *numbers = mem_alloc_zero(mesh->vertices.count, sizeof *numbers), count = 0;
    struct solid_vertex *vertices = mesh->vertices.items;
    size_t kept = 0;
    if (!numbers)
        return false;
    for (uint32_t i = 0; i < mesh->triangles.count; i++) {
        const struct solid_triangle triangle = *solid_triangle_at(mesh, i);
        const uint32_t *vertex = triangle.vertex;
        if (vertex[0] == vertex[1] || vertex[1] == vertex[2] || vertex[2] == vertex[0])
            continue;
        for (int k = 0; k < 3; k++)
            numbers[vertex[k]] = 1;
        *solid_triangle_at(mesh, (uint32_t)kept++) = triangle;
    }
    mesh->triangles.count = kept;
    for (size_t i = 0; i < mesh->vertices.count; i++) {
        if (!numbers[i])
            continue;
        vertices[count] = vertices[i];
        numbers[i] = count++;
    }
    mesh->vertices.count = count;
    for (size_t i = 0; i < 3 * mesh->triangles.count; i++) {
        uint32_t *vertex = &solid_triangle_at(mesh, (uint32_t)(i / 3))->vertex[i % 3];
        *vertex = numbers[*vertex];
    }
    mem_free(numbers);
    return true;
}

double solid_grain(const struct csg *csg) {
    return 0x1p-23 * math_max(vec3_max_abs(csg->bounds.min), vec3_max_abs(csg->bounds.max));
}

struct vec3 solid_round(const struct csg *csg, struct vec3 point) {
    double step = two_to(ilogb(solid_grain(csg)));
    return vec3_scale(vec3_make(rint(point.x / step), rint(point.y / step), rint(point.z / step)), step);
}

bool solid_mesh_of_triangles(const struct mesh *mesh, const struct affine *map, struct solid_mesh *out) {
    size_t corners = 3 * (size_t)mesh_triangle_count(mesh);
    double(*positions)[3] = mem_alloc(corners * sizeof *positions);
    uint32_t *same = mem_alloc(corners * sizeof *same);
    bool ok = positions && same, turned = mesh_is_outward(mesh) == (affine_determinant(map) < 0);
    for (size_t i = 0; ok && i < corners; i += 3) {
        struct solid_triangle triangle = {{(uint32_t)i, (uint32_t)i + 1, (uint32_t)i + 2}, 0};
        struct vec3 points[3];
        mesh_triangle(mesh, (uint32_t)(i / 3), points, &triangle.surface);
        for (int k = 0; k < 9; k++)
            positions[i + (size_t)k / 3][k % 3] =
                (float)vec3_get(affine_point(map, points[turned ? 2 - k / 3 : k / 3]), k % 3);
        ok = list_add(&out->triangles, &triangle, 1, sizeof triangle);
    }
    ok = ok && mesh_weld((const double(*)[3])positions, (uint32_t)corners, same);
    /* Equal positions are one vertex. */
    for (size_t i = 0; ok && i < corners; i++) {
        const double *at = positions[i];
        const struct solid_vertex vertex = {.point = {at[0], at[1], at[2]}};
        uint32_t first = same[i];
        same[i] = first == i ? (uint32_t)out->vertices.count : same[first];
        solid_triangle_at(out, (uint32_t)(i / 3))->vertex[i % 3] = same[i];
        ok = first < i || list_add(&out->vertices, &vertex, 1, sizeof vertex);
    }
    mem_free(positions);
    mem_free(same);
    return ok && solid_mesh_compact(out);
}

static bool solid_mesh_copy(const struct solid_mesh *from, struct solid_mesh *out) {
    return list_add(&out->vertices, from->vertices.items, from->vertices.count, sizeof(struct solid_vertex)) &&
           list_add(&out->triangles, from->triangles.items, from->triangles.count, sizeof(struct solid_triangle));
}

static uint64_t edge_key(const struct solid_mesh *mesh, uint32_t corner, uint32_t end) {
    const uint32_t *vertex = solid_triangle_at(mesh, corner / 3)->vertex;
    return ((uint64_t)vertex[corner % 3] << 32 | vertex[(corner + end) % 3]) + 1;
}

/* From one triangle at a vertex to the next over their common edge, until the first one is reached again: such a ring
 * has all triangles of its vertex if there are as many rings as vertices. */
bool solid_mesh_is_closed(const struct solid_mesh *mesh, bool *closed, struct error *error) {
    uint32_t corners = 3 * (uint32_t)mesh->triangles.count;
    uint8_t *seen = mem_alloc_zero(corners, 1);
    struct key_map edges = {0};
    size_t rings = 0;
    bool ok = true, memory = seen != NULL;
    for (uint32_t i = 0; ok && memory && i < corners; i++) {
        ok = !key_map_find(&edges, edge_key(mesh, i, 1));
        memory = !ok || key_map_add(&edges, edge_key(mesh, i, 1), i);
    }
    for (uint32_t i = 0; ok && memory && i < corners; i++) {
        rings += !seen[i];
        for (uint32_t at = i; ok && !seen[at];) {
            const uint32_t *next = key_map_find(&edges, edge_key(mesh, at, 2));
            seen[at] = 1;
            ok = next != NULL;
            at = ok ? *next : at;
        }
    }
    *closed = ok && memory && rings == mesh->vertices.count;
    key_map_destroy(&edges);
    mem_free(seen);
    return memory || error_no_memory(error, "the edges of a mesh");
}

/* --- tests of a mesh --- */

/* Of the tolerance: known points that are further away are too far, for others beside them may be a little further. */
static const double far_share = 0.98;

/* Faults of a mesh, by the boxes in which vertices are kept. */
struct verification {
    const struct solid_input *input;
    const struct solid_mesh *mesh;
    struct list known; /* struct known_point */
    double size;
    int round;
    struct solid_probe *probes; /* of the workers */
    uint64_t *stray;            /* by triangle, bits */
    struct list boxes;
    size_t faults[ROUNDS]; /* of each round */
    bool failed;
};

static void add_fault(struct verification *v, struct box box, double margin) {
    box = box_grow(box, margin);
    v->failed = !list_add(&v->boxes, &box, 1, sizeof box) || v->failed;
}

static void add_far_point(struct verification *v, struct vec3 point) {
    add_fault(v, (struct box){point, point}, 10 * v->input->tolerance * (1 << v->round));
}

static void add_intersection(void *context, uint32_t one, uint32_t other) {
    struct verification *v = context;
    struct corners a = corners_of(v->mesh, one), b = corners_of(v->mesh, other);
    add_fault(v, box_meet(corners_box(&a), corners_box(&b)), 2 * v->input->tolerance + 0.02 * v->size * v->round);
}

enum { CHUNK = 256, TEST_POINTS = 6, KNOWN_TESTS = 200000 };

/* Points of a regular grid on a triangle, and the same on its edges, which the triangle beyond has too: one of them is
 * enough. */
static bool test_point(const struct corners *c, int number, struct vec3 *out) {
    int i = number / TEST_POINTS, k = number % TEST_POINTS, rest = TEST_POINTS - i - k;
    const int share[3] = {i, k, rest};
    *out = vec3_all(0);
    for (int n = 0; n < 3; n++) {
        int next = (n + 1) % 3;
        if (share[n] < 0 || share[n] == TEST_POINTS || (share[n] == 0 && c->vertex[next] > c->vertex[(n + 2) % 3]))
            return false;
        *out = vec3_add_scaled(*out, c->point[n], (double)share[n] / TEST_POINTS);
    }
    return true;
}

/* Bits of the points that are not near to the solid. */
static uint64_t strays(struct solid_probe *probe, const struct corners *c, double tolerance) {
    struct vec3 normal = vec3_normalize(triangle_normal(c->point)), at;
    uint64_t out = 0;
    if (!(vec3_length(normal) > 0)) /* the corners are in a line */
        normal = vec3_make(0, 0, 1);
    for (int i = 0; i < TEST_POINTS * TEST_POINTS; i++)
        if (test_point(c, i, &at) && !solid_is_near_for_sure(probe, at, normal, tolerance))
            out |= UINT64_C(1) << i;
    return out;
}

static void test_chunk(void *context, uint32_t item, int worker) {
    struct verification *v = context;
    uint32_t end = (item + 1) * CHUNK, count = (uint32_t)v->mesh->triangles.count;
    for (uint32_t i = item * CHUNK; i < end && i < count; i++) {
        struct corners corners = corners_of(v->mesh, i);
        v->stray[i] = strays(&v->probes[worker], &corners, v->input->tolerance);
    }
}

static bool find_strays(struct verification *v, struct error *error) {
    uint32_t count = (uint32_t)v->mesh->triangles.count;
    v->stray = mem_alloc_zero(count, sizeof *v->stray);
    if (!v->stray)
        return error_no_memory(error, "the mesh of a solid");
    bool ok = pool_run(v->input->pool, (count + CHUNK - 1) / CHUNK, test_chunk, v) ||
              error_set(error, ERROR_CANCELLED, "stopped while a mesh was tested");
    for (uint32_t i = 0; ok && i < count; i++) {
        struct corners corners = corners_of(v->mesh, i);
        struct vec3 at;
        for (int k = 0; k < TEST_POINTS * TEST_POINTS; k++)
            if ((v->stray[i] >> k & 1) && test_point(&corners, k, &at))
                add_far_point(v, at);
    }
    mem_free(v->stray);
    return ok;
}

static bool verify(struct verification *v, struct error *error) {
    struct box_tree tree;
    const struct known_point *known = v->known.items;
    if (!triangle_tree_build(&tree, v->mesh, v->input->pool, error))
        return false;
    find_intersections(v->mesh, &tree, 1e-13 * v->size, add_intersection, v);
    for (size_t i = 0, step = 1 + v->known.count / KNOWN_TESTS; i < v->known.count; i += step)
        if (!mesh_is_near(v->mesh, &tree, known[i].point, far_share * v->input->tolerance))
            add_far_point(v, known[i].point);
    box_tree_destroy(&tree);
    if (!find_strays(v, error))
        return false;
    for (int i = 0; i < pool_workers(v->input->pool); i++)
        v->failed = v->failed || v->probes[i].failed;
    return !v->failed || error_no_memory(error, "the mesh of a solid");
}

/* --- rounds --- */

/* Readers of files take vertices at one place as one. False: no memory. */
static bool some_coincide(const struct solid_mesh *mesh, bool *found) {
    uint32_t count = (uint32_t)mesh->vertices.count;
    double(*positions)[3] = mem_alloc(count * sizeof *positions);
    uint32_t *same = mem_alloc(count * sizeof *same);
    for (uint32_t i = 0; positions && i < 3 * count; i++)
        positions[i / 3][i % 3] = vec3_get(solid_vertex_at(mesh, i / 3)->point, (int)(i % 3));
    bool ok = positions && same && mesh_weld((const double(*)[3])positions, count, same);
    *found = false;
    for (uint32_t i = 0; ok && i < count; i++)
        *found = *found || same[i] != i;
    mem_free(positions);
    mem_free(same);
    return ok;
}

static void round_coordinates(const struct csg *csg, struct solid_mesh *mesh) {
    for (uint32_t i = 0; i < mesh->vertices.count; i++) {
        struct vec3 *point = &solid_vertex_at(mesh, i)->point;
        *point = solid_round(csg, *point);
    }
}

/* Vertices near the faults of the last round are kept better than before. */
static void mark_kept(struct verification *v, const struct solid_mesh *mesh, uint8_t *keep) {
    const struct box *boxes = v->boxes.items;
    for (uint32_t i = 0; i < mesh->vertices.count; i++) {
        bool found = false;
        for (size_t k = 0; k < v->boxes.count && !found && keep[i] != KEEP_VERTEX; k++)
            found = box_contains(&boxes[k], solid_vertex_at(mesh, i)->point);
        keep[i] = (uint8_t)(keep[i] + found);
    }
    v->boxes.count = 0;
}

/* Many faults that two rounds have not halved will stay. */
static bool goes_on(const struct verification *v) {
    return v->round < ROUNDS && (v->round < 3 || v->faults[v->round - 1] < MANY_FAULTS ||
                                 v->faults[v->round - 1] < v->faults[v->round - 3] / 2);
}

static bool simplify(const struct verification *v, const struct solid_mesh *fine, struct solid_mesh *out,
                     const uint8_t *keep, struct error *error) {
    const struct simplify_input input = {
        .tolerance = v->input->tolerance, .size = v->size, .resolution = 2 * solid_grain(v->input->csg), .keep = keep};
    solid_mesh_destroy(out);
    return (solid_mesh_copy(fine, out) && simplify_mesh(out, &input)) || error_no_memory(error, "the mesh of a solid");
}

/* *good: it has no faults. */
static bool simplify_and_test(struct verification *v, const struct solid_mesh *fine, struct solid_mesh *out,
                              uint8_t *keep, bool *good, struct error *error) {
    *good = false;
    for (v->round = 0; goes_on(v) && !*good; v->round++) {
        if (pool_cancelled(v->input->pool))
            return error_set(error, ERROR_CANCELLED, "stopped while a solid was meshed");
        mark_kept(v, fine, keep);
        if (!simplify(v, fine, out, keep, error))
            return false;
        v->mesh = out;
        if (!verify(v, error))
            return false;
        v->faults[v->round] = v->boxes.count;
        *good = v->boxes.count == 0;
    }
    bool closed = false, coincide = false;
    if (!solid_mesh_is_closed(out, &closed, error))
        return false;
    bool memory = some_coincide(out, &coincide) || error_no_memory(error, "the mesh of a solid");
    *good = *good && closed && !coincide;
    return memory;
}

static bool is_empty(const struct solid_input *input, struct error *error) {
    return error_set(error, ERROR_SCENE, "node '%.100s' is empty: there is nothing to write", input->name);
}

static bool try_grid(const struct solid_input *input, uint32_t cells, struct solid_mesh *out,
                     struct solid_findings *findings, bool *is_coarse, struct error *error) {
    double size = vec3_max_abs(vec3_sub(input->csg->bounds.max, input->csg->bounds.min));
    int workers = pool_workers(input->pool);
    struct verification v = {.input = input, .size = size};
    struct solid_mesh fine;
    bool good = false, ok = contour_build(input, cells, &fine, &v.known, is_coarse, error);
    if (ok && fine.triangles.count == 0)
        ok = is_empty(input, error);
    round_coordinates(input->csg, &fine);
    uint8_t *keep = mem_alloc_zero(fine.vertices.count, 1);
    ok = ok && separate_parts(&fine, input, findings, error);
    v.probes = solid_probes(input->csg, workers);
    ok = ok && ((keep && v.probes) || error_no_memory(error, "the mesh of a solid"));
    ok = ok &&
         (*is_coarse ? simplify(&v, &fine, out, keep, error) : simplify_and_test(&v, &fine, out, keep, &good, error));
    findings->has_faults = !good;
    solid_probes_destroy(v.probes, workers);
    mem_free(keep);
    list_destroy(&v.boxes);
    list_destroy(&v.known);
    solid_mesh_destroy(&fine);
    return ok;
}

bool solid_mesh_build(const struct solid_input *input, struct solid_mesh *out, struct solid_findings *findings,
                      struct error *error) {
    *out = (struct solid_mesh){0};
    *findings = (struct solid_findings){.has_faults = true};
    if (box_is_empty(&input->csg->bounds))
        return is_empty(input, error);
    double size = vec3_max_abs(vec3_sub(input->csg->bounds.max, input->csg->bounds.min));
    double wanted = math_min(math_max(sqrt(size / input->tolerance), MIN_CELLS), MAX_CELLS);
    int grids = input->may_have_faults ? GRIDS_WITH_FAULTS : GRIDS;
    bool is_coarse = false;
    for (int i = 0; i < grids && findings->has_faults && !is_coarse; i++) {
        uint32_t cells = (uint32_t)(wanted * (1 + 0.37 * i));
        solid_mesh_destroy(out);
        if (!try_grid(input, cells, out, findings, &is_coarse, error)) {
            solid_mesh_destroy(out);
            return false;
        }
    }
    if (!findings->has_faults || input->may_have_faults)
        return true;
    solid_mesh_destroy(out);
    return error_set(error, ERROR_SCENE,
                     "node '%.100s': no mesh without faults was found within %g of the solid; another tolerance may "
                     "help",
                     input->name, input->tolerance);
}
