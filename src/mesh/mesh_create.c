/* Makes a mesh of polygons. A polygon of n corners becomes n - 2 triangles; those with two coincident corners are
 * dropped at once (their neighbours then share the edge). Some closed meshes are closed only by triangles without area
 * but with three different corners, so these are dropped only from open meshes. */
#include "mesh/mesh_internal.h"
#include "mesh/mesh_topology.h"

#include "base/hash.h"
#include "base/mem.h"
#include "mesh/triangulate_internal.h"

#include <string.h>

uint64_t mesh_input_hash(const struct mesh_input *input) {
    uint32_t corners = input->face_count ? input->face_start[input->face_count] : 0;
    uint32_t counts[6] = {input->vertex_count,
                          input->face_count,
                          input->normals ? input->normal_count : MESH_NONE,
                          input->uvs ? input->uv_count : MESH_NONE,
                          input->face_material != NULL,
                          input->colours != NULL};
    uint64_t h = hash_bytes(counts, sizeof counts, 0);
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
    if (input->face_material)
        h = hash_bytes(input->face_material, input->face_count * sizeof *input->face_material, h);
    if (input->colours)
        h = hash_bytes(input->colours, input->vertex_count * sizeof *input->colours, h);
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
    }
    if (input->colours) {
        mesh->colours = mem_alloc(input->vertex_count * sizeof *mesh->colours);
        if (!mesh->colours)
            return false;
        if (input->vertex_count)
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
    bool whole = mesh->triangle_count == input->face_count && triangles == input->face_count;
    if (!mesh->closed && drop_degenerate(mesh, face_of) > 0) {
        whole = false;
        if (!mesh_find_topology(mesh))
            return false;
    }
    if (!whole && input->face_count && !copy_polygons(mesh, input))
        return false;
    mesh->dropped_faces = faces_without_triangles(mesh, face_of);
    size_t count = mesh->triangle_count;
    if (count < triangles) {
        mesh->corners = shrink(mesh->corners, count * sizeof *mesh->corners);
        mesh->normal_corners = shrink(mesh->normal_corners, count * sizeof *mesh->normal_corners);
        mesh->uv_corners = shrink(mesh->uv_corners, count * sizeof *mesh->uv_corners);
        mesh->materials = shrink(mesh->materials, count * sizeof *mesh->materials);
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
