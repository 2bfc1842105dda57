/* Division in passes: each pass halves the edges that are too long, and cuts a triangle into two, three or four by the
 * number of such edges (red-green refinement without a hierarchy: R. Bank, A. Sherman, A. Weiser, "Some refinement
 * algorithms and data structures for regular local mesh refinement", 1983). Whether an edge is halved depends on its
 * ends alone, and its middle is found again by their numbers. Positions, texture coordinates and normals have numbers
 * of their own, so seams of coordinates stay seams without opening the surface. */
#include "mesh/mesh_displace.h"

#include "base/key_map.h"
#include "base/mem.h"
#include "expr/expr_field.h"
#include "math/elementary.h"
#include "mesh/mesh_internal.h"
#include "mesh/mesh_topology.h"

#include <string.h>

enum { MAX_PASSES = 64 };

struct corner {
    uint32_t vertex, uv, normal; /* MESH_NONE: it has none */
};

struct face {
    struct corner corners[3];
    uint32_t origin; /* the triangle of the mesh */
};

/* Numbers in rows of `width`; the midpoint of two rows is a new row. */
struct rows {
    double *numbers;
    uint32_t width, count, capacity;
};

struct division {
    struct rows vertices, uvs, normals, colours; /* colours have the numbers of the vertices; width 0: there are none */
    struct face *faces;
    uint32_t face_count;
    double edge; /* 0: all edges are too long */
};

static void division_destroy(struct division *d) {
    mem_free(d->vertices.numbers);
    mem_free(d->uvs.numbers);
    mem_free(d->normals.numbers);
    mem_free(d->colours.numbers);
    mem_free(d->faces);
}

/* --- the middles of edges --- */

struct pass {
    struct division *d;
    struct key_map vertices, uvs, normals; /* from two indices to that of the midpoint */
    struct face *faces;                    /* the new ones */
    uint32_t count;
    bool failed; /* no memory */
};

static bool rows_grow(struct rows *rows, size_t more) {
    size_t capacity = (size_t)rows->count + more;
    double *numbers =
        capacity < MESH_NONE ? mem_resize_array(rows->numbers, capacity * rows->width + 1, sizeof *numbers) : NULL;
    if (!numbers)
        return false;
    rows->numbers = numbers;
    rows->capacity = (uint32_t)capacity;
    return true;
}

/* There must be room for the rows. Both orders of a and b give the same bits. */
static void add_mean(struct rows *rows, uint32_t a, uint32_t b) {
    const double *p = rows->numbers + (size_t)a * rows->width, *q = rows->numbers + (size_t)b * rows->width;
    double *out = rows->numbers + (size_t)rows->count++ * rows->width;
    for (uint32_t k = 0; k < rows->width; k++)
        out[k] = p[k] / 2 + q[k] / 2;
}

/* The index of the midpoint of two rows; `also`: rows with the same indices, or NULL. */
static uint32_t middle_of(struct pass *pass, struct key_map *middles, struct rows *rows, struct rows *also, uint32_t a,
                          uint32_t b) {
    if (a == MESH_NONE || b == MESH_NONE)
        return MESH_NONE;
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    uint64_t key = ((uint64_t)low << 32 | high) + 1;
    const uint32_t *known = key_map_find(middles, key);
    if (known)
        return *known;
    pass->failed = !key_map_add(middles, key, rows->count) || pass->failed;
    add_mean(rows, low, high);
    if (also)
        add_mean(also, low, high);
    return rows->count - 1;
}

/* --- one pass --- */

static struct vec3 row_of(const struct rows *rows, uint32_t i) {
    const double *x = rows->numbers + 3 * (size_t)i;
    return vec3_make(x[0], x[1], x[2]);
}

static double edge_length(const struct division *d, uint32_t a, uint32_t b) {
    return vec3_length(vec3_sub(row_of(&d->vertices, a), row_of(&d->vertices, b)));
}

/* The edges of a face that are too long, as bits; edge k leads from corner k to the next one. */
static unsigned long_edges(const struct division *d, const struct face *face) {
    unsigned out = 0;
    for (unsigned k = 0; k < 3; k++) {
        uint32_t a = face->corners[k].vertex, b = face->corners[(k + 1) % 3].vertex;
        if (a != b && (d->edge == 0 || edge_length(d, a, b) > d->edge))
            out |= 1U << k;
    }
    return out;
}

static int bit_count(unsigned bits) {
    return (int)((bits & 1) + (bits >> 1 & 1) + (bits >> 2 & 1));
}

static struct corner middle_corner(struct pass *pass, struct corner a, struct corner b) {
    struct division *d = pass->d;
    return (struct corner){
        middle_of(pass, &pass->vertices, &d->vertices, d->colours.width ? &d->colours : NULL, a.vertex, b.vertex),
        d->uvs.width ? middle_of(pass, &pass->uvs, &d->uvs, NULL, a.uv, b.uv) : MESH_NONE,
        d->normals.width ? middle_of(pass, &pass->normals, &d->normals, NULL, a.normal, b.normal) : MESH_NONE};
}

static void add_face(struct pass *pass, uint32_t origin, struct corner a, struct corner b, struct corner c) {
    pass->faces[pass->count++] = (struct face){{a, b, c}, origin};
}

static void divide_face(struct pass *pass, const struct face *face, unsigned marked) {
    int count = bit_count(marked), first = 0;
    if (count == 1)
        first = marked == 1 ? 0 : marked == 2 ? 1 : 2; /* the edge that is halved */
    if (count == 2)
        first = marked == 6 ? 1 : marked == 5 ? 2 : 0; /* the first of the two in order */
    const struct corner a = face->corners[first], b = face->corners[(first + 1) % 3],
                        c = face->corners[(first + 2) % 3];
    if (count == 0) {
        add_face(pass, face->origin, a, b, c);
        return;
    }
    const struct corner ab = middle_corner(pass, a, b);
    if (count == 1) {
        add_face(pass, face->origin, a, ab, c);
        add_face(pass, face->origin, ab, b, c);
        return;
    }
    const struct corner bc = middle_corner(pass, b, c);
    if (count == 3) {
        const struct corner ca = middle_corner(pass, c, a);
        add_face(pass, face->origin, a, ab, ca);
        add_face(pass, face->origin, ab, b, bc);
        add_face(pass, face->origin, ca, bc, c);
        add_face(pass, face->origin, ab, bc, ca);
        return;
    }
    add_face(pass, face->origin, ab, b, bc);
    bool by_a = edge_length(pass->d, a.vertex, bc.vertex) <= edge_length(pass->d, ab.vertex, c.vertex);
    add_face(pass, face->origin, a, ab, by_a ? bc : c);
    add_face(pass, face->origin, by_a ? a : ab, bc, c);
}

/* At most `halved` edges are halved, and each of their faces is divided. `faces` is the exact number of faces
 * afterwards. */
static bool run_pass(struct division *d, uint64_t halved, uint64_t faces) {
    struct pass pass = {.d = d, .faces = mem_alloc((size_t)faces * sizeof *pass.faces)};
    struct rows *const all[] = {&d->vertices, &d->uvs, &d->normals, &d->colours};
    bool ok = pass.faces != NULL;
    for (size_t k = 0; ok && k < sizeof all / sizeof *all; k++)
        ok = !all[k]->width || rows_grow(all[k], (size_t)halved);
    for (uint32_t f = 0; ok && f < d->face_count; f++)
        divide_face(&pass, &d->faces[f], long_edges(d, &d->faces[f]));
    key_map_destroy(&pass.vertices);
    key_map_destroy(&pass.uvs);
    key_map_destroy(&pass.normals);
    if (!ok || pass.failed) {
        mem_free(pass.faces);
        return false;
    }
    mem_free(d->faces);
    d->faces = pass.faces;
    d->face_count = pass.count;
    return true;
}

static bool refuse(const struct division *d, const struct mesh_displacement *by, int passes, struct error *error) {
    double longest = 0;
    for (uint32_t f = 0; f < d->face_count; f++)
        for (int k = 0; k < 3; k++)
            longest = math_max(longest,
                               edge_length(d, d->faces[f].corners[k].vertex, d->faces[f].corners[(k + 1) % 3].vertex));
    if (by->edge > 0)
        return error_set(error, ERROR_SCENE, "edge = %g needs more than %d triangles; edge = %.3g is possible",
                         by->edge, DISPLACED_TRIANGLES, longest * 1.01);
    return error_set(error, ERROR_SCENE, "level = %d makes more than %d triangles; level = %d is possible", by->level,
                     DISPLACED_TRIANGLES, passes);
}

static bool divide(struct division *d, const struct mesh_displacement *by, struct error *error) {
    for (int pass = 0; by->edge > 0 ? pass < MAX_PASSES : pass < by->level; pass++) {
        uint64_t faces = 0, halved = 0;
        for (uint32_t f = 0; f < d->face_count; f++) {
            int count = bit_count(long_edges(d, &d->faces[f]));
            halved += (uint64_t)count;
            faces += 1 + (uint64_t)count;
        }
        if (halved == 0)
            break;
        if (faces > DISPLACED_TRIANGLES)
            return refuse(d, by, pass, error);
        if (!run_pass(d, halved, faces))
            return error_no_memory(error, "a displaced mesh");
    }
    return true;
}

/* --- from the mesh --- */

static bool copy_rows(struct rows *rows, const double *numbers, uint32_t width, uint32_t count) {
    *rows = (struct rows){.width = width};
    if (!rows_grow(rows, count))
        return false;
    memcpy(rows->numbers, numbers, (size_t)count * width * sizeof *numbers);
    rows->count = count;
    return true;
}

static bool division_init(struct division *d, const struct mesh *mesh) {
    uint32_t *same = mem_alloc((size_t)mesh->vertex_count * sizeof *same);
    d->face_count = mesh->triangle_count;
    d->faces = mem_alloc((size_t)mesh->triangle_count * sizeof *d->faces);
    bool ok = same && d->faces && mesh_weld((const double(*)[3])mesh->vertices, mesh->vertex_count, same) &&
              copy_rows(&d->vertices, mesh->vertices[0], 3, mesh->vertex_count) &&
              (!mesh->uvs || copy_rows(&d->uvs, mesh->uvs[0], 2, mesh->uv_count)) &&
              (!mesh->normals || copy_rows(&d->normals, mesh->normals[0], 3, mesh->normal_count));
    /* Colours are computed with like everything else, in double precision. */
    if (ok && mesh->colours && !mesh->colours_by_triangle) {
        d->colours.width = 3;
        ok = rows_grow(&d->colours, mesh->vertex_count);
        for (size_t i = 0; ok && i < (size_t)mesh->vertex_count * 3; i++)
            d->colours.numbers[i] = (double)mesh->colours[i / 3][i % 3];
        d->colours.count = mesh->vertex_count;
    }
    for (uint32_t f = 0; ok && f < mesh->triangle_count; f++) {
        d->faces[f].origin = f;
        for (int k = 0; k < 3; k++)
            /* Vertices at one place are one vertex, so that the surface does not tear. */
            d->faces[f].corners[k] =
                (struct corner){same[mesh->corners[f][k]], mesh->uvs ? mesh->uv_corners[f][k] : MESH_NONE,
                                mesh->normals ? mesh->normal_corners[f][k] : MESH_NONE};
    }
    mem_free(same);
    return ok;
}

/* --- moving the vertices --- */

struct movement {
    const struct division *d;
    double (*directions)[3]; /* of the vertices: unit, or 0 */
    double *weights;         /* of the vertices: the sums of the angles */
    bool reads_uv;           /* then there is a point for each corner, else one for each vertex */
};

static double angle_at(const struct division *d, const struct face *face, int k) {
    struct vec3 p = row_of(&d->vertices, face->corners[k].vertex);
    struct vec3 a = vec3_normalize(vec3_sub(row_of(&d->vertices, face->corners[(k + 1) % 3].vertex), p));
    struct vec3 b = vec3_normalize(vec3_sub(row_of(&d->vertices, face->corners[(k + 2) % 3].vertex), p));
    return el_atan2(vec3_length(vec3_cross(a, b)), vec3_dot(a, b));
}

static struct vec3 face_normal(const struct division *d, const struct face *face) {
    struct vec3 p = row_of(&d->vertices, face->corners[0].vertex);
    struct vec3 e = vec3_sub(row_of(&d->vertices, face->corners[1].vertex), p);
    struct vec3 f = vec3_sub(row_of(&d->vertices, face->corners[2].vertex), p);
    return vec3_normalize(vec3_cross(vec3_normalize(e), vec3_normalize(f)));
}

/* The means of the shading normals, or of the face normals if there are none. */
static void find_directions(struct movement *m) {
    const struct division *d = m->d;
    for (uint32_t f = 0; f < d->face_count; f++) {
        const struct face *face = &d->faces[f];
        struct vec3 of_face = face_normal(d, face);
        for (int k = 0; k < 3; k++) {
            uint32_t normal = face->corners[k].normal;
            struct vec3 n = normal == MESH_NONE ? of_face : vec3_normalize(row_of(&d->normals, normal));
            double angle = angle_at(d, face, k), *sum = m->directions[face->corners[k].vertex];
            sum[0] += angle * n.x;
            sum[1] += angle * n.y;
            sum[2] += angle * n.z;
            m->weights[face->corners[k].vertex] += angle;
        }
    }
    for (uint32_t v = 0; v < d->vertices.count; v++) {
        double *n = m->directions[v];
        struct vec3 unit = vec3_normalize(vec3_make(n[0], n[1], n[2]));
        n[0] = unit.x, n[1] = unit.y, n[2] = unit.z;
    }
}

static void inputs_at(const void *context, size_t i, double inputs[EXPR_INPUT_COUNT]) {
    const struct movement *m = context;
    const struct corner *corner = m->reads_uv ? &m->d->faces[i / 3].corners[i % 3] : NULL;
    uint32_t vertex = corner ? corner->vertex : (uint32_t)i;
    const double *p = m->d->vertices.numbers + 3 * (size_t)vertex, *n = m->directions[vertex];
    for (int k = 0; k < 3; k++) {
        inputs[EXPR_POINT_X + k] = p[k];
        inputs[EXPR_NORMAL_X + k] = n[k];
    }
    bool has_uv = corner && corner->uv != MESH_NONE;
    inputs[EXPR_U] = has_uv ? m->d->uvs.numbers[2 * (size_t)corner->uv] : 0;
    inputs[EXPR_V] = has_uv ? m->d->uvs.numbers[2 * (size_t)corner->uv + 1] : 0;
}

/* Adds the displacement of point i with its weight to that of the vertex. */
static void add_displacement(const struct movement *m, uint32_t vertex, const double *value, int outputs, double weight,
                             double *sum) {
    for (int k = 0; k < 3; k++)
        sum[3 * (size_t)vertex + (size_t)k] += weight * (outputs == 3 ? value[k] : value[0] * m->directions[vertex][k]);
}

/* values: of the points, `outputs` numbers each. */
static void gather(const struct movement *m, const double *values, int outputs, double *sum) {
    const struct division *d = m->d;
    for (uint32_t v = 0; !m->reads_uv && v < d->vertices.count; v++)
        add_displacement(m, v, values + (size_t)v * (size_t)outputs, outputs, 1, sum);
    for (uint32_t f = 0; m->reads_uv && f < d->face_count; f++)
        for (int k = 0; k < 3; k++) {
            uint32_t vertex = d->faces[f].corners[k].vertex;
            double share = m->weights[vertex] > 0 ? angle_at(d, &d->faces[f], k) / m->weights[vertex] : 0;
            add_displacement(m, vertex, values + (3 * (size_t)f + (size_t)k) * (size_t)outputs, outputs, share, sum);
        }
}

static bool move(struct division *d, const struct expr_program *program, struct error *error) {
    struct movement m = {.d = d, .reads_uv = expr_field_reads(program, EXPR_U) || expr_field_reads(program, EXPR_V)};
    size_t vertices = d->vertices.count, points = m.reads_uv ? 3 * (size_t)d->face_count : vertices;
    double *values = mem_alloc_zero(points * (size_t)program->output_count + 1, sizeof *values);
    double *sum = mem_alloc_zero(vertices * 3 + 1, sizeof *sum);
    m.directions = mem_alloc_zero(vertices + 1, sizeof *m.directions);
    m.weights = mem_alloc_zero(vertices + 1, sizeof *m.weights);
    bool ok = (values && sum && m.directions && m.weights) || error_no_memory(error, "a displaced mesh");
    if (ok) {
        find_directions(&m);
        const struct expr_points at = {points, inputs_at, &m};
        ok = expr_field_evaluate(program, &at, values, error);
    }
    if (ok) {
        gather(&m, values, program->output_count, sum);
        for (size_t i = 0; i < 3 * vertices; i++)
            d->vertices.numbers[i] += sum[i];
    }
    mem_free(values);
    mem_free(sum);
    mem_free(m.directions);
    mem_free(m.weights);
    return ok;
}

/* --- to tables --- */

static uint32_t *table_of(const struct division *d, int member) {
    uint32_t *out = mem_alloc((size_t)d->face_count * 3 * sizeof *out);
    for (uint32_t f = 0; out && f < d->face_count; f++)
        for (int k = 0; k < 3; k++)
            out[3 * (size_t)f + (size_t)k] = member == 0 ? d->faces[f].corners[k].vertex : d->faces[f].corners[k].uv;
    return out;
}

static bool write_tables(struct division *d, const struct mesh *mesh, struct mesh_input *input,
                         struct mesh_tables *own) {
    uint32_t faces = d->face_count;
    own->vertex_index = table_of(d, 0);
    own->face_start = mem_alloc(((size_t)faces + 1) * sizeof *own->face_start);
    /* The tables take over the memory of the division. */
    own->vertices = (double(*)[3])d->vertices.numbers;
    d->vertices.numbers = NULL;
    bool ok = own->vertex_index && own->face_start;
    *input = (struct mesh_input){.file = mesh->file,
                                 .vertex_count = d->vertices.count,
                                 .face_count = faces,
                                 .vertices = (const double(*)[3])own->vertices,
                                 .face_start = own->face_start,
                                 .vertex_index = own->vertex_index};
    for (uint32_t f = 0; ok && f <= faces; f++)
        own->face_start[f] = 3 * f;
    if (ok && d->uvs.width) {
        own->uvs = (double(*)[2])d->uvs.numbers;
        d->uvs.numbers = NULL;
        own->uv_index = table_of(d, 1);
        ok = own->uv_index != NULL;
        input->uv_count = d->uvs.count;
        input->uvs = (const double(*)[2])own->uvs;
        input->uv_index = own->uv_index;
    }
    if (ok && mesh->materials) {
        own->face_material = mem_alloc((size_t)faces * sizeof *own->face_material);
        ok = own->face_material != NULL;
        for (uint32_t f = 0; ok && f < faces; f++)
            own->face_material[f] = mesh->materials[d->faces[f].origin];
        input->face_material = own->face_material;
    }
    if (ok && d->colours.width) {
        own->colours = mem_alloc((size_t)d->colours.count * sizeof *own->colours);
        ok = own->colours != NULL;
        for (size_t i = 0; ok && i < 3 * (size_t)d->colours.count; i++)
            own->colours[i / 3][i % 3] = (float)d->colours.numbers[i];
        input->colours = (const float(*)[3])own->colours;
    }
    if (ok && mesh->colours_by_triangle) {
        own->colours = mem_alloc((size_t)faces * sizeof *own->colours);
        ok = own->colours != NULL;
        for (uint32_t f = 0; ok && f < faces; f++)
            memcpy(own->colours[f], mesh->colours[d->faces[f].origin], sizeof *own->colours);
        input->colours = (const float(*)[3])own->colours;
        input->colours_by_face = true;
    }
    return ok;
}

bool mesh_input_displace(const struct mesh *mesh, const struct mesh_displacement *by, struct mesh_input *input,
                         struct mesh_tables *own, struct error *error) {
    const unsigned coordinates = 1U << EXPR_U | 1U << EXPR_V;
    const unsigned readable =
        (unsigned)EXPR_POINT_INPUTS | coordinates | 1U << EXPR_NORMAL_X | 1U << EXPR_NORMAL_Y | 1U << EXPR_NORMAL_Z;
    struct division d = {.edge = by->edge};
    if (!expr_field_reads_only(by->program, readable, "a displacement may depend only on p, s.u, s.v and s.normal",
                               error) ||
        (!mesh->uvs &&
         !expr_field_reads_only(by->program, readable & ~coordinates, "the mesh has no texture coordinates", error)))
        return false;
    bool ok = (division_init(&d, mesh) || error_no_memory(error, "a displaced mesh")) && divide(&d, by, error) &&
              move(&d, by->program, error) &&
              (write_tables(&d, mesh, input, own) || error_no_memory(error, "a displaced mesh"));
    division_destroy(&d);
    return ok;
}
