/* Queries of a finished mesh. Every search ends in the one watertight triangle test of accel/triangle.h; the index only
 * selects the triangles to test. */
#include "mesh/mesh.h"

#include "base/mem.h"
#include "mesh/mesh_internal.h"

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

bool mesh_open_edge(const struct mesh *mesh, struct vec3 *a, struct vec3 *b) {
    if (mesh->closed || mesh->triangle_count == 0)
        return false;
    *a = mesh->open_edge[0];
    *b = mesh->open_edge[1];
    return true;
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
    if (mesh->colours)
        bytes += mesh->vertex_count * sizeof *mesh->colours;
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
    struct crossing *items = scratch->items + out->first;
    uint32_t count = scratch->used - out->first, kept = 0;
    crossings_sort_by(items, count, before);
    for (uint32_t i = 0; i < count; i++)
        if (i == 0 || items[i].part != items[kept - 1].part)
            items[kept++] = items[i];
    if (mesh->closed) {
        double size =
            fmax(vec3_max_abs(ray->origin), fmax(vec3_max_abs(mesh->bounds.min), vec3_max_abs(mesh->bounds.max)));
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

/* at: the barycentric coordinates; e1, e2: the edges from the first corner. */
static void describe_uv(const struct mesh *mesh, uint32_t triangle, struct vec3 at, struct vec3 e1, struct vec3 e2,
                        struct surface *out) {
    const uint32_t *corner = mesh->uv_corners[triangle];
    const double *a = mesh->uvs[corner[0]], *b = mesh->uvs[corner[1]], *c = mesh->uvs[corner[2]];
    out->has_uv = true;
    out->u = at.x * a[0] + at.y * b[0] + at.z * c[0];
    out->v = at.x * a[1] + at.y * b[1] + at.z * c[1];
    double du1 = b[0] - a[0], dv1 = b[1] - a[1], du2 = c[0] - a[0], dv2 = c[1] - a[1];
    double area = triangle_edge(du1, dv1, du2, dv2);
    if (area == 0)
        return;
    out->dpdu = vec3_scale(vec3_sub(vec3_scale(e1, dv2), vec3_scale(e2, dv1)), 1 / area);
    out->dpdv = vec3_scale(vec3_sub(vec3_scale(e2, du1), vec3_scale(e1, du2)), 1 / area);
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
        describe_uv(mesh, triangle, vec3_make(w, u, v), e1, e2, out);
    if (mesh->colours) {
        const float *p = mesh->colours[corner[0]], *q = mesh->colours[corner[1]], *r = mesh->colours[corner[2]];
        out->has_colour = true;
        out->colour = vec3_make(w * (double)p[0] + u * (double)q[0] + v * (double)r[0],
                                w * (double)p[1] + u * (double)q[1] + v * (double)r[1],
                                w * (double)p[2] + u * (double)q[2] + v * (double)r[2]);
    }
    if (mesh->materials)
        out->material_slot = mesh->materials[triangle];
}
