/* Queries of a finished mesh. Every search ends in the one watertight triangle test of accel/triangle.h; the index only
 * selects the triangles to test. */
#include "mesh/mesh.h"

#include "base/hash.h"
#include "base/mem.h"
#include "mesh/mesh_internal.h"
#include "mesh/mesh_topology.h"
#include "mesh/triangulate_internal.h"

#include <stdio.h>
#include <string.h>

struct mesh *mesh_share(struct mesh *mesh) {
    mesh->references++;
    return mesh;
}

void mesh_release(struct mesh *mesh) {
    if (!mesh || --mesh->references > 0)
        return;
    if (mesh->accel) {
        triangle_index_destroy(mesh->accel->index);
        triangle_index_destroy(mesh->accel->grid);
        kd_triangles_destroy(mesh->accel->kd_tree);
    }
    mem_free(mesh->accel);
    mem_free(mesh->file);
    mem_free(mesh->vertices);
    mem_free(mesh->corners);
    mem_free(mesh->normals);
    mem_free(mesh->normal_corners);
    mem_free(mesh->uvs);
    mem_free(mesh->second_uvs);
    mem_free(mesh->uv_corners);
    mem_free(mesh->colours);
    mem_free(mesh->materials);
    mem_free(mesh->face_start);
    mem_free(mesh->face_vertex);
    mem_free(mesh);
}

static uint32_t grid_voxels(const struct mesh *mesh) {
    enum { TRIANGLES_PER_VOXEL = 8, MAX_VOXELS = 1 << 18 };
    uint32_t voxels = mesh->set.count / TRIANGLES_PER_VOXEL;
    return voxels < 1 ? 1 : voxels > MAX_VOXELS ? MAX_VOXELS : voxels;
}

bool mesh_build_accel(const struct mesh *mesh, enum accel_kind kind, struct pool *pool, struct error *error) {
    struct mesh_accel *accel = mesh->accel;
    switch (kind) {
    case ACCEL_GRID:
        return accel->grid || triangle_index_build(&accel->grid, &mesh->set, grid_voxels(mesh), pool, error);
    case ACCEL_KDTREE:
        return accel->kd_tree || kd_triangles_build(&accel->kd_tree, &mesh->set, pool, error);
    case ACCEL_AUTO:
    case ACCEL_BVH:
    case ACCEL_NONE: /* but insides of solids are needed anyway */
        return accel->index || triangle_index_build(&accel->index, &mesh->set, 0, pool, error);
    }
    return true;
}

struct box mesh_bounds(const struct mesh *mesh) {
    return mesh->bounds;
}

struct box mesh_bounds_under(const struct mesh *mesh, const struct affine *map) {
    struct box box = box_empty();
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const double *v = mesh->vertices[mesh->corners[t][k]];
            box = box_add_point(box, affine_point(map, vec3_make(v[0], v[1], v[2])));
        }
    return box;
}

bool mesh_is_closed(const struct mesh *mesh) {
    return mesh->closed;
}

bool mesh_is_open(const struct mesh *mesh) {
    return mesh->open_edge_count > 0;
}

bool mesh_opening(const struct mesh *mesh, double *share) {
    struct mesh_accel *kept = mesh->accel;
    kept->opening_is_known = kept->opening_is_known || mesh->closed || mesh_find_opening(mesh, &kept->opening);
    *share = kept->opening;
    return kept->opening_is_known;
}

void mesh_describe_open_edges(const struct mesh *mesh, char *text, size_t size) {
    int used =
        snprintf(text, size, "the first open edges (of one face, or of faces that disagree about the outside) go");
    for (uint32_t i = 0; i < mesh->open_edge_count; i++) {
        const struct vec3 *a = &mesh->open_edges[i][0], *b = &mesh->open_edges[i][1];
        used += snprintf(text + used, size - (size_t)used, "%s from {%.6g, %.6g, %.6g} to {%.6g, %.6g, %.6g}",
                         i ? "," : "", a->x, a->y, a->z, b->x, b->y, b->z);
    }
    /* A hundred thousandth of the size: the seams of exporters are narrower, details are wider. */
    double length = vec3_length(vec3_sub(mesh->bounds.max, mesh->bounds.min));
    (void)snprintf(text + used, size - (size_t)used,
                   "; weld = %.0e in gr.mesh joins vertices closer than that, which closes seams but no holes",
                   1e-5 * length);
}

bool mesh_is_outward(const struct mesh *mesh) {
    return mesh->closed && mesh->outward;
}

void mesh_triangle(const struct mesh *mesh, uint32_t triangle, struct vec3 corners[3], uint32_t *slot) {
    for (int i = 0; i < 3; i++) {
        const double *v = mesh->vertices[mesh->corners[triangle][i]];
        corners[i] = vec3_make(v[0], v[1], v[2]);
    }
    *slot = mesh->materials ? mesh->materials[triangle] : 0;
}

const char *mesh_file(const struct mesh *mesh) {
    return mesh->file;
}

uint32_t mesh_triangle_count(const struct mesh *mesh) {
    return mesh->triangle_count;
}

uint32_t mesh_dropped_faces(const struct mesh *mesh) {
    return mesh->dropped_faces;
}

bool mesh_has_uv(const struct mesh *mesh) {
    return mesh->uvs != NULL;
}

const double (*mesh_vertices(const struct mesh *mesh, uint32_t *count))[3] {
    *count = mesh->vertex_count;
    return (const double(*)[3])mesh->vertices;
}

uint32_t mesh_face_count(const struct mesh *mesh) {
    return mesh->face_count;
}

const uint32_t *mesh_face(const struct mesh *mesh, uint32_t face, uint32_t *corners) {
    if (!mesh->face_start) { /* nothing but triangles, none dropped */
        *corners = 3;
        return mesh->corners[face];
    }
    *corners = mesh->face_start[face + 1] - mesh->face_start[face];
    return mesh->face_vertex + mesh->face_start[face];
}

size_t mesh_memory(const struct mesh *mesh) {
    size_t triangles = mesh->triangle_count, bytes = sizeof *mesh;
    bytes += mesh->vertex_count * sizeof *mesh->vertices + triangles * sizeof *mesh->corners;
    if (mesh->normals)
        bytes += mesh->normal_count * sizeof *mesh->normals + triangles * sizeof *mesh->normal_corners;
    if (mesh->uvs)
        bytes += mesh->uv_count * sizeof *mesh->uvs + triangles * sizeof *mesh->uv_corners;
    if (mesh->second_uvs)
        bytes += mesh->uv_count * sizeof *mesh->second_uvs;
    if (mesh->colours)
        bytes += (mesh->colours_by_triangle ? mesh->triangle_count : mesh->vertex_count) * sizeof *mesh->colours;
    if (mesh->materials)
        bytes += triangles * sizeof *mesh->materials;
    if (mesh->face_start)
        bytes += ((size_t)mesh->face_count + 1 + mesh->face_start[mesh->face_count]) * sizeof(uint32_t);
    bytes += mesh->accel->grid ? triangle_index_memory(mesh->accel->grid) : 0;
    bytes += mesh->accel->kd_tree ? kd_triangles_memory(mesh->accel->kd_tree) : 0;
    return bytes + (mesh->accel->index ? triangle_index_memory(mesh->accel->index) : 0);
}

/* The counters of the search are the scratch's own. */
static struct triangle_cost *count_search(struct geom_scratch *scratch, uint64_t rays) {
    scratch->shape_tests += rays;
    return &scratch->cost;
}

static struct crossing crossing_from(const struct triangle_hit *hit) {
    return (struct crossing){.t = hit->t, .u = hit->u, .v = hit->v, .part = hit->triangle, .enter = hit->enter};
}

/* The structures for searches; without them every triangle is tested. */
struct search_structure {
    const struct triangle_index *index;
    const struct kd_triangles *kd_tree;
};

static inline struct search_structure search_structure_for(const struct mesh *mesh, enum accel_kind kind) {
    const struct mesh_accel *accel = mesh->accel;
    if (kind == ACCEL_AUTO && accel->index) /* nearly always */
        return (struct search_structure){.index = accel->index};
    switch (kind) {
    case ACCEL_GRID:
        return (struct search_structure){.index = accel->grid ? accel->grid : accel->index};
    case ACCEL_AUTO:
    case ACCEL_BVH:
        return (struct search_structure){.index = accel->index ? accel->index : accel->grid, .kd_tree = accel->kd_tree};
    case ACCEL_KDTREE:
        return (struct search_structure){.index = accel->kd_tree ? NULL : accel->index, .kd_tree = accel->kd_tree};
    case ACCEL_NONE:
        return (struct search_structure){0};
    }
    return (struct search_structure){0};
}

bool mesh_nearest(const struct mesh *mesh, const struct ray *ray, enum accel_kind accel, struct geom_scratch *scratch,
                  struct crossing *out) {
    struct triangle_cost *cost = count_search(scratch, 1);
    struct search_structure search_structure = search_structure_for(mesh, accel);
    bool found = search_structure.index
                     ? triangle_index_nearest(search_structure.index, &mesh->set, ray, &out->on_mesh, cost)
                 : search_structure.kd_tree
                     ? kd_triangles_nearest(search_structure.kd_tree, &mesh->set, ray, &out->on_mesh, cost)
                     : triangle_brute_nearest(&mesh->set, ray, &out->on_mesh, cost);
    if (found) {
        out->leaf = 0;
        out->flip = false;
    }
    return found;
}

bool mesh_any(const struct mesh *mesh, const struct ray *ray, enum accel_kind accel, struct geom_scratch *scratch) {
    struct triangle_cost *cost = count_search(scratch, 1);
    struct search_structure search_structure = search_structure_for(mesh, accel);
    return search_structure.index     ? triangle_index_any(search_structure.index, &mesh->set, ray, cost)
           : search_structure.kd_tree ? kd_triangles_any(search_structure.kd_tree, &mesh->set, ray, cost)
                                      : triangle_brute_any(&mesh->set, ray, cost);
}

bool mesh_nearest_but(const struct mesh *mesh, const struct ray *ray, uint32_t triangle, enum accel_kind accel,
                      struct geom_scratch *scratch, struct crossing *out) {
    const struct triangle_index *index = search_structure_for(mesh, accel).index;
    if (!index)
        return mesh_nearest(mesh, ray, accel, scratch, out);
    struct triangle_run run = {triangle, 1};
    if (!triangle_index_nearest_but(index, &mesh->set, ray, run, &out->on_mesh, count_search(scratch, 1)))
        return false;
    out->leaf = 0;
    out->flip = false;
    return true;
}

bool mesh_any_but(const struct mesh *mesh, const struct ray *ray, uint32_t triangle, enum accel_kind accel,
                  struct geom_scratch *scratch) {
    const struct triangle_index *index = search_structure_for(mesh, accel).index;
    uint32_t ignored;
    if (!index)
        return mesh_any(mesh, ray, accel, scratch);
    return triangle_index_any_but(index, &mesh->set, ray, (struct triangle_run){triangle, 1}, &ignored,
                                  count_search(scratch, 1));
}

uint64_t mesh_nearest_packet(const struct mesh *mesh, const struct ray_packet *rays, uint64_t active,
                             enum accel_kind accel, struct geom_scratch *scratch, struct packet_hits *out) {
    const struct triangle_index *index = search_structure_for(mesh, accel).index;
    uint64_t found = 0;
    if (index)
        return triangle_packet_nearest(index, &mesh->set, rays, active, out,
                                       count_search(scratch, (uint64_t)__builtin_popcountll(active)));
    for (; active; active &= active - 1) {
        unsigned i = (unsigned)__builtin_ctzll(active);
        struct ray ray = ray_packet_get(rays, i);
        struct crossing c;
        if (!mesh_nearest(mesh, &ray, accel, scratch, &c))
            continue;
        packet_hits_set(out, i, &(struct triangle_hit){c.t, c.u, c.v, c.part, c.enter});
        found |= UINT64_C(1) << i;
    }
    return found;
}

uint64_t mesh_any_packet(const struct mesh *mesh, const struct ray_packet *rays, uint64_t active, enum accel_kind accel,
                         struct geom_scratch *scratch) {
    const struct triangle_index *index = search_structure_for(mesh, accel).index;
    uint64_t found = 0;
    if (index)
        return triangle_packet_any(index, &mesh->set, rays, active,
                                   count_search(scratch, (uint64_t)__builtin_popcountll(active)));
    for (; active; active &= active - 1) {
        unsigned i = (unsigned)__builtin_ctzll(active);
        struct ray ray = ray_packet_get(rays, i);
        found |= (uint64_t)mesh_any(mesh, &ray, accel, scratch) << i;
    }
    return found;
}

static bool before(const void *one, const void *other) {
    const struct crossing *a = one, *b = other;
    return a->t != b->t ? a->t < b->t : a->part < b->part;
}

/* The signs of the triangle test make a line enter a closed mesh as often as it leaves it, but where it touches an edge
 * or passes a thin wall the two t are equal up to rounding and may be in the wrong order. Within that rounding error,
 * this makes entries and exits alternate. */
static void alternate(struct crossing *items, uint32_t count, bool enter_first, double slack) {
    for (uint32_t i = 0; i < count; i++) {
        bool want = i ? !items[i - 1].enter : enter_first;
        if (items[i].enter == want)
            continue;
        for (uint32_t j = i + 1; j < count && items[j].t - items[i].t <= slack; j++) {
            if (items[j].enter != want)
                continue;
            struct crossing moved = items[j];
            moved.t = items[i].t;
            memmove(&items[i + 1], &items[i], (j - i) * sizeof *items);
            items[i] = moved;
            break;
        }
    }
}

static void push(void *context, const struct triangle_hit *hit) {
    geom_scratch_push(context, crossing_from(hit));
}

bool mesh_crossings(const struct mesh *mesh, const struct ray *ray, enum accel_kind accel, struct geom_scratch *scratch,
                    struct crossing_list *out) {
    struct triangle_cost *cost = count_search(scratch, 1);
    *out = (struct crossing_list){scratch->used, 0};
    struct search_structure search_structure = search_structure_for(mesh, accel);
    if (search_structure.index)
        triangle_index_all(search_structure.index, &mesh->set, ray, push, scratch, cost);
    else if (search_structure.kd_tree)
        kd_triangles_all(search_structure.kd_tree, &mesh->set, ray, push, scratch, cost);
    else
        triangle_brute_all(&mesh->set, ray, push, scratch, cost);
    if (scratch->overflow) {
        scratch->used = out->first;
        return false;
    }
    /* An index may report a triangle several times. */
    struct crossing *items = scratch->items + out->first;
    uint32_t count = scratch->used - out->first, kept = 0;
    crossings_sort_by(items, count, before);
    for (uint32_t i = 0; i < count; i++)
        if (i == 0 || items[i].part != items[kept - 1].part)
            items[kept++] = items[i];
    /* On a closed mesh entries and exits alternate, whatever was rounded. */
    if (mesh->closed) {
        double size = math_max(vec3_max_abs(ray->origin),
                               math_max(vec3_max_abs(mesh->bounds.min), vec3_max_abs(mesh->bounds.max)));
        alternate(items, kept, mesh->outward, size * 0x1p-46 / vec3_max_abs(ray->direction));
    }
    scratch->used = out->first + kept;
    out->count = kept;
    return true;
}

static struct vec3 load(const double v[3]) {
    return vec3_make(v[0], v[1], v[2]);
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

/* uvs: those of the corners; at: the barycentric coordinates; e1, e2: the edges from the first corner. */
static void describe_uv(const double (*uvs)[2], const uint32_t corner[3], struct vec3 at, struct vec3 e1,
                        struct vec3 e2, struct second_uv *out) {
    const double *a = uvs[corner[0]], *b = uvs[corner[1]], *c = uvs[corner[2]];
    out->u = at.x * a[0] + at.y * b[0] + at.z * c[0];
    out->v = at.x * a[1] + at.y * b[1] + at.z * c[1];
    double du1 = b[0] - a[0], dv1 = b[1] - a[1], du2 = c[0] - a[0], dv2 = c[1] - a[1];
    double area = triangle_edge(du1, dv1, du2, dv2);
    if (area == 0)
        return;
    out->dpdu = vec3_scale(vec3_sub(vec3_scale(e1, dv2), vec3_scale(e2, dv1)), 1 / area);
    out->dpdv = vec3_scale(vec3_sub(vec3_scale(e2, du1), vec3_scale(e1, du2)), 1 / area);
}

static void describe_all_uvs(const struct mesh *mesh, uint32_t triangle, struct vec3 at, struct vec3 e1, struct vec3 e2,
                             struct surface *out) {
    const uint32_t *corner = mesh->uv_corners[triangle];
    struct second_uv first = {0};
    describe_uv((const double(*)[2])mesh->uvs, corner, at, e1, e2, &first);
    out->has_uv = true;
    out->u = first.u;
    out->v = first.v;
    out->dpdu = first.dpdu;
    out->dpdv = first.dpdv;
    out->has_second = mesh->second_uvs != NULL;
    if (!out->has_second)
        return;
    out->second = (struct second_uv){0};
    describe_uv((const double(*)[2])mesh->second_uvs, corner, at, e1, e2, &out->second);
}

bool mesh_is_plain(const struct mesh *mesh, uint32_t triangle) {
    return !mesh->colours && (!mesh->normals || mesh->normal_corners[triangle][0] == MESH_NONE) &&
           (!mesh->uvs || mesh->uv_corners[triangle][0] == MESH_NONE);
}

void mesh_describe(const struct mesh *mesh, const struct ray *ray, const struct crossing *crossing,
                   struct surface *out) {
    uint32_t triangle = crossing->part;
    const uint32_t *corner = mesh->corners[triangle];
    struct vec3 a = load(mesh->vertices[corner[0]]), b = load(mesh->vertices[corner[1]]),
                c = load(mesh->vertices[corner[2]]);
    struct vec3 e1 = vec3_sub(b, a), e2 = vec3_sub(c, a);
    double u = crossing->u, v = crossing->v, w = 1 - u - v;
    struct vec3 normal = mesh_normal_of_edges(e1, e2);
    /* A triangle without area represents the seam it closes: it faces the ray. */
    if (vec3_max_abs(normal) == 0)
        normal = crossing->enter ? vec3_negate(ray->direction) : ray->direction;
    surface_make(out, vec3_add_scaled(vec3_add_scaled(vec3_scale(a, w), b, u), c, v), normal,
                 0x1p-49 * larger(vec3_max_abs(a), larger(vec3_max_abs(b), vec3_max_abs(c))));
    if (mesh->normals && mesh->normal_corners[triangle][0] != MESH_NONE) {
        const uint32_t *n = mesh->normal_corners[triangle];
        struct vec3 mixed = vec3_scale(load(mesh->normals[n[0]]), w);
        mixed = vec3_add_scaled(vec3_add_scaled(mixed, load(mesh->normals[n[1]]), u), load(mesh->normals[n[2]]), v);
        /* Opposite normals cancel; the remainder is only rounding error. */
        if (vec3_length_squared(mixed) > 0x1p-60)
            out->shading_normal = mixed;
    }
    if (mesh->uvs && mesh->uv_corners[triangle][0] != MESH_NONE)
        describe_all_uvs(mesh, triangle, vec3_make(w, u, v), e1, e2, out);
    if (mesh->colours) {
        bool whole = mesh->colours_by_triangle;
        const float *p = mesh->colours[whole ? triangle : corner[0]], *q = mesh->colours[whole ? triangle : corner[1]],
                    *r = mesh->colours[whole ? triangle : corner[2]];
        out->has_colour = true;
        out->colour = colour_make(w * (double)p[0] + u * (double)q[0] + v * (double)r[0],
                                  w * (double)p[1] + u * (double)q[1] + v * (double)r[1],
                                  w * (double)p[2] + u * (double)q[2] + v * (double)r[2]);
    }
    if (mesh->materials)
        out->material_slot = mesh->materials[triangle];
}

/* --- creation --- */

/* Makes a mesh of polygons. A polygon of n corners becomes n - 2 triangles; those with two coincident corners are
 * dropped at once (their neighbours then share the edge). Some closed meshes are closed only by triangles without area
 * but with three different corners, so these are dropped only from open meshes. */

uint64_t mesh_input_hash(const struct mesh_input *input) {
    uint32_t corners = input->face_count ? input->face_start[input->face_count] : 0;
    uint32_t counts[7] = {input->vertex_count,
                          input->face_count,
                          input->normals ? input->normal_count : MESH_NONE,
                          input->uvs ? input->uv_count : MESH_NONE,
                          input->face_material != NULL,
                          input->colours != NULL,
                          input->colours_by_face};
    uint64_t h = hash_bytes(counts, sizeof counts, 0);
    /* The counts come first, so that no table can be taken for another one. */
    h = hash_bytes(input->vertices, input->vertex_count * sizeof *input->vertices, h);
    if (input->face_count)
        h = hash_bytes(input->face_start, ((size_t)input->face_count + 1) * sizeof *input->face_start, h);
    h = hash_bytes(input->vertex_index, corners * sizeof *input->vertex_index, h);
    if (input->normals && input->normal_index) {
        h = hash_bytes(input->normals, input->normal_count * sizeof *input->normals, h);
        h = hash_bytes(input->normal_index, corners * sizeof *input->normal_index, h);
    }
    if (input->uvs && input->uv_index) {
        h = hash_bytes(input->uvs, input->uv_count * sizeof *input->uvs, h);
        h = hash_bytes(input->uv_index, corners * sizeof *input->uv_index, h);
    }
    if (input->second_uvs)
        h = hash_bytes(input->second_uvs, input->uv_count * sizeof *input->second_uvs, h);
    if (input->face_material)
        h = hash_bytes(input->face_material, input->face_count * sizeof *input->face_material, h);
    if (input->colours)
        h = hash_bytes(input->colours,
                       (input->colours_by_face ? input->face_count : input->vertex_count) * sizeof *input->colours, h);
    return h;
}

/* Whether the triangles determine the polygons: nothing but triangles, none dropped. */
static bool triangles_are_faces(const struct mesh *mesh) {
    return mesh->face_start == NULL;
}

bool mesh_equals_input(const struct mesh *mesh, const struct mesh_input *input) {
    if (mesh->vertex_count != input->vertex_count || mesh->face_count != input->face_count)
        return false;
    if (mesh->input_hash != mesh_input_hash(input))
        return false;
    if (mesh->vertex_count && memcmp(mesh->vertices, input->vertices, mesh->vertex_count * sizeof *mesh->vertices) != 0)
        return false;
    if (mesh->face_count == 0)
        return true;
    uint32_t corners = input->face_start[input->face_count];
    if (triangles_are_faces(mesh)) {
        for (uint32_t f = 0; f <= input->face_count; f++)
            if (input->face_start[f] != 3 * f)
                return false;
        return memcmp(mesh->corners, input->vertex_index, corners * sizeof *input->vertex_index) == 0;
    }
    return memcmp(mesh->face_start, input->face_start, ((size_t)mesh->face_count + 1) * sizeof *mesh->face_start) ==
               0 &&
           memcmp(mesh->face_vertex, input->vertex_index, corners * sizeof *input->vertex_index) == 0;
}

bool mesh_equals(const struct mesh *a, const struct mesh *b) {
    return a->input_hash == b->input_hash && a->triangle_count > 0 && a->triangle_count == b->triangle_count &&
           a->vertex_count == b->vertex_count &&
           memcmp(a->vertices, b->vertices, a->vertex_count * sizeof *a->vertices) == 0 &&
           memcmp(a->corners, b->corners, a->triangle_count * sizeof *a->corners) == 0;
}

static struct vec3 edge_of(const struct mesh *mesh, const uint32_t corners[3], int end) {
    const double *a = mesh->vertices[corners[0]], *b = mesh->vertices[corners[end]];
    return vec3_make(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
}

static bool is_degenerate(const struct mesh *mesh, uint32_t triangle) {
    const uint32_t *corners = mesh->corners[triangle];
    return vec3_max_abs(mesh_normal_of_edges(edge_of(mesh, corners, 1), edge_of(mesh, corners, 2))) == 0;
}

static bool same_position(const struct mesh *mesh, uint32_t a, uint32_t b) {
    const double *p = mesh->vertices[a], *q = mesh->vertices[b];
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
}

/* A table with random access: on large pages if it is large. */
static void *alloc_searched(size_t size) {
    return mem_alloc_aligned(size < MEM_LARGE_PAGE ? 64 : MEM_LARGE_PAGE, size);
}

static bool copy_tables(struct mesh *mesh, const struct mesh_input *input, size_t triangles) {
    mesh->vertices = alloc_searched(input->vertex_count * sizeof *mesh->vertices);
    mesh->corners = alloc_searched(triangles * sizeof *mesh->corners);
    if (!mesh->vertices || !mesh->corners)
        return false;
    if (input->vertex_count)
        memcpy(mesh->vertices, input->vertices, input->vertex_count * sizeof *mesh->vertices);
    if (input->normals && input->normal_index) {
        mesh->normals = mem_alloc(input->normal_count * sizeof *mesh->normals);
        mesh->normal_corners = mem_alloc(triangles * sizeof *mesh->normal_corners);
        if (!mesh->normals || !mesh->normal_corners)
            return false;
        mesh->normal_count = input->normal_count;
        /* Normals are stored as unit vectors. */
        for (uint32_t i = 0; i < input->normal_count; i++) {
            const double *n = input->normals[i];
            struct vec3 unit = vec3_normalize(vec3_make(n[0], n[1], n[2]));
            mesh->normals[i][0] = unit.x;
            mesh->normals[i][1] = unit.y;
            mesh->normals[i][2] = unit.z;
        }
    }
    if (input->uvs && input->uv_index) {
        mesh->uvs = mem_alloc(input->uv_count * sizeof *mesh->uvs);
        mesh->uv_corners = mem_alloc(triangles * sizeof *mesh->uv_corners);
        if (!mesh->uvs || !mesh->uv_corners)
            return false;
        mesh->uv_count = input->uv_count;
        if (input->uv_count)
            memcpy(mesh->uvs, input->uvs, input->uv_count * sizeof *mesh->uvs);
        if (input->second_uvs) {
            mesh->second_uvs = mem_alloc(input->uv_count * sizeof *mesh->second_uvs);
            if (!mesh->second_uvs)
                return false;
            if (input->uv_count)
                memcpy(mesh->second_uvs, input->second_uvs, input->uv_count * sizeof *mesh->second_uvs);
        }
    }
    if (input->colours) {
        mesh->colours_by_triangle = input->colours_by_face;
        mesh->colours = mem_alloc((input->colours_by_face ? triangles : input->vertex_count) * sizeof *mesh->colours);
        if (!mesh->colours)
            return false;
        if (input->vertex_count && !input->colours_by_face)
            memcpy(mesh->colours, input->colours, input->vertex_count * sizeof *mesh->colours);
    }
    if (input->face_material) {
        mesh->materials = mem_alloc(triangles * sizeof *mesh->materials);
        if (!mesh->materials)
            return false;
    }
    return true;
}

static bool copy_polygons(struct mesh *mesh, const struct mesh_input *input) {
    size_t corners = input->face_start[input->face_count];
    mesh->face_start = mem_alloc(((size_t)input->face_count + 1) * sizeof *mesh->face_start);
    mesh->face_vertex = mem_alloc(corners * sizeof *mesh->face_vertex);
    if (!mesh->face_start || !mesh->face_vertex)
        return false;
    memcpy(mesh->face_start, input->face_start, ((size_t)input->face_count + 1) * sizeof *mesh->face_start);
    memcpy(mesh->face_vertex, input->vertex_index, corners * sizeof *mesh->face_vertex);
    return true;
}

static bool all_given(const uint32_t *index, uint32_t first, uint32_t end) {
    for (uint32_t i = first; i < end; i++)
        if (index[i] == MESH_NONE)
            return false;
    return true;
}

/* Appends the triangles of one face; local[k] are corner positions in the face. */
static void add_face(struct mesh *mesh, const struct mesh_input *input, uint32_t face, const uint32_t (*local)[3],
                     uint32_t *face_of) {
    uint32_t first = input->face_start[face], end = input->face_start[face + 1];
    bool has_normals = mesh->normals && all_given(input->normal_index, first, end);
    bool has_uv = mesh->uvs && all_given(input->uv_index, first, end);
    for (uint32_t i = 0; i + 2 < end - first; i++) {
        const uint32_t corner[3] = {first + local[i][0], first + local[i][1], first + local[i][2]};
        uint32_t a = input->vertex_index[corner[0]], b = input->vertex_index[corner[1]],
                 c = input->vertex_index[corner[2]];
        if (same_position(mesh, a, b) || same_position(mesh, b, c) || same_position(mesh, c, a))
            continue;
        uint32_t at = mesh->triangle_count++;
        face_of[at] = face;
        for (int j = 0; j < 3; j++) {
            mesh->corners[at][j] = input->vertex_index[corner[j]];
            if (mesh->normals)
                mesh->normal_corners[at][j] = has_normals ? input->normal_index[corner[j]] : MESH_NONE;
            if (mesh->uvs)
                mesh->uv_corners[at][j] = has_uv ? input->uv_index[corner[j]] : MESH_NONE;
        }
        if (mesh->materials)
            mesh->materials[at] = input->face_material[face];
        if (mesh->colours_by_triangle)
            memcpy(mesh->colours[at], input->colours[face], sizeof *mesh->colours);
    }
}

static bool add_faces(struct mesh *mesh, const struct mesh_input *input, uint32_t *face_of) {
    struct triangulate_scratch scratch = {0};
    uint32_t(*local)[3] = NULL;
    uint32_t capacity = 0;
    bool good = true;
    for (uint32_t f = 0; f < input->face_count && good; f++) {
        uint32_t first = input->face_start[f], count = input->face_start[f + 1] - first;
        if (count > capacity) {
            uint32_t(*grown)[3] = mem_resize_array(local, count, sizeof *grown);
            good = grown != NULL;
            if (!good)
                break;
            local = grown;
            capacity = count;
        }
        good = triangulate_polygon(input->vertices, input->vertex_index + first, count, local, &scratch);
        if (good)
            add_face(mesh, input, f, (const uint32_t(*)[3])local, face_of);
    }
    mem_free(local);
    triangulate_scratch_destroy(&scratch);
    return good;
}

static uint32_t drop_degenerate(struct mesh *mesh, uint32_t *face_of) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        if (is_degenerate(mesh, i))
            continue;
        memmove(mesh->corners[kept], mesh->corners[i], sizeof *mesh->corners);
        if (mesh->normals)
            memmove(mesh->normal_corners[kept], mesh->normal_corners[i], sizeof *mesh->normal_corners);
        if (mesh->uvs)
            memmove(mesh->uv_corners[kept], mesh->uv_corners[i], sizeof *mesh->uv_corners);
        if (mesh->materials)
            mesh->materials[kept] = mesh->materials[i];
        if (mesh->colours_by_triangle)
            memmove(mesh->colours[kept], mesh->colours[i], sizeof *mesh->colours);
        face_of[kept++] = face_of[i];
    }
    uint32_t dropped = mesh->triangle_count - kept;
    mesh->triangle_count = kept;
    return dropped;
}

static void find_bounds(struct mesh *mesh) {
    mesh->bounds = box_empty();
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        for (int j = 0; j < 3; j++) {
            const double *v = mesh->vertices[mesh->corners[i][j]];
            mesh->bounds = box_add_point(mesh->bounds, vec3_make(v[0], v[1], v[2]));
        }
}

static uint32_t faces_without_triangles(const struct mesh *mesh, const uint32_t *face_of) {
    uint32_t used = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        used += i == 0 || face_of[i] != face_of[i - 1];
    return mesh->face_count - used;
}

static void *shrink(void *block, size_t size) {
    void *smaller = block ? mem_resize(block, size ? size : 1) : NULL;
    return smaller ? smaller : block;
}

/* Everything except the index; false without memory: the caller then frees partial results. */
static bool fill(struct mesh *mesh, const struct mesh_input *input, size_t triangles, uint32_t *face_of) {
    if (!copy_tables(mesh, input, triangles) || !add_faces(mesh, input, face_of) || !mesh_find_topology(mesh))
        return false;
    /* Where every face is one triangle, the triangles are the polygons, too. */
    bool whole = mesh->triangle_count == input->face_count && triangles == input->face_count;
    if (!mesh->closed && drop_degenerate(mesh, face_of) > 0) {
        whole = false;
        if (!mesh_find_topology(mesh))
            return false;
    }
    if (!whole && input->face_count && !copy_polygons(mesh, input))
        return false;
    mesh->dropped_faces = faces_without_triangles(mesh, face_of);
    /* What was dropped needs no memory. */
    size_t count = mesh->triangle_count;
    if (count < triangles) {
        mesh->corners = shrink(mesh->corners, count * sizeof *mesh->corners);
        mesh->normal_corners = shrink(mesh->normal_corners, count * sizeof *mesh->normal_corners);
        mesh->uv_corners = shrink(mesh->uv_corners, count * sizeof *mesh->uv_corners);
        mesh->materials = shrink(mesh->materials, count * sizeof *mesh->materials);
        if (mesh->colours_by_triangle)
            mesh->colours = shrink(mesh->colours, count * sizeof *mesh->colours);
    }
    find_bounds(mesh);
    mesh->set = (struct triangle_set){(const double(*)[3])mesh->vertices, (const uint32_t(*)[3])mesh->corners,
                                      mesh->triangle_count, mesh->bounds};
    mesh->input_hash = mesh_input_hash(input);
    return true;
}

static bool keep_file(struct mesh *mesh, const struct mesh_input *input) {
    if (!input->file)
        return true;
    size_t size = strlen(input->file) + 1;
    mesh->file = mem_alloc(size);
    if (mesh->file)
        memcpy(mesh->file, input->file, size);
    return mesh->file != NULL;
}

struct mesh *mesh_create(const struct mesh_input *input, struct error *error) {
    const char *name = input->name ? input->name : "a mesh";
    size_t triangles = 0;
    for (uint32_t f = 0; f < input->face_count; f++)
        triangles += (size_t)(input->face_start[f + 1] - input->face_start[f]) - 2;
    if (triangles > (size_t)1 << 31) {
        error_set(error, ERROR_SCENE, "%s: %zu triangles are too many for one mesh (at most 2^31)", name, triangles);
        return NULL;
    }
    struct mesh *mesh = mem_alloc_zero(1, sizeof *mesh);
    if (mesh)
        mesh->accel = mem_alloc_zero(1, sizeof *mesh->accel);
    /* The references exist before the mesh is filled, so that a failure can release it. */
    uint32_t *face_of = mem_alloc(triangles * sizeof *face_of);
    if (mesh) {
        mesh->references = 1;
        mesh->vertex_count = input->vertex_count;
        mesh->face_count = input->face_count;
    }
    if (!mesh || !mesh->accel || !face_of || !keep_file(mesh, input) || !fill(mesh, input, triangles, face_of)) {
        error_no_memory(error, name);
        mesh_release(mesh);
        mesh = NULL;
    }
    mem_free(face_of);
    return mesh;
}

static void bundle_accel(struct bundle *bundle, void *mesh_accel) {
    struct mesh_accel *accel = mesh_accel;
    triangle_index_bundle(bundle, &accel->index);
    triangle_index_bundle(bundle, &accel->grid);
    kd_triangles_bundle(bundle, &accel->kd_tree);
}

static void bundle_tables(struct bundle *bundle, void *tables) {
    struct mesh *mesh = tables;
    mesh->file = NULL;
    mesh->face_start = mesh->face_vertex = NULL;
    BUNDLE(bundle, mesh->vertices, mesh->vertex_count, NULL);
    BUNDLE(bundle, mesh->corners, mesh->triangle_count, NULL);
    BUNDLE(bundle, mesh->normals, mesh->normal_count, NULL);
    BUNDLE(bundle, mesh->normal_corners, mesh->triangle_count, NULL);
    BUNDLE(bundle, mesh->uvs, mesh->uv_count, NULL);
    BUNDLE(bundle, mesh->second_uvs, mesh->uv_count, NULL);
    BUNDLE(bundle, mesh->uv_corners, mesh->triangle_count, NULL);
    BUNDLE(bundle, mesh->colours, mesh->colours_by_triangle ? mesh->triangle_count : mesh->vertex_count, NULL);
    BUNDLE(bundle, mesh->materials, mesh->triangle_count, NULL);
    triangle_set_bundle(bundle, &mesh->set);
    BUNDLE(bundle, mesh->accel, 1, bundle_accel);
}

void mesh_bundle(struct bundle *bundle, const struct mesh **mesh) {
    BUNDLE(bundle, *mesh, 1, bundle_tables);
}
