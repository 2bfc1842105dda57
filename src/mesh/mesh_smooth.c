/* Corners are united across smooth edges (union-find over corners), then every set of corners has one normal. Edges are
 * gathered at their lower vertex: count, prefix sum, fill; then each vertex sorts its own few. All sums run in the
 * order of the corners, so nothing depends on the shape of the forest. Lengths are first scaled by a power of two to
 * about 1, so that no product under- or overflows and a scaled mesh has the same normals bit for bit. */
#include "mesh/mesh_smooth.h"

#include "base/mem.h"
#include "base/sort.h"
#include "math/elementary.h"
#include "math/portable.h"
#include "mesh/mesh_topology.h"

#include <string.h>

#define NONE UINT32_MAX

void mesh_tables_destroy(struct mesh_tables *tables) {
    mem_free(tables->vertices);
    mem_free(tables->normals);
    mem_free(tables->uvs);
    mem_free(tables->colours);
    mem_free(tables->face_start);
    mem_free(tables->face_material);
    mem_free(tables->vertex_index);
    mem_free(tables->normal_index);
    mem_free(tables->uv_index);
    *tables = (struct mesh_tables){0};
}

static const char *name_of(const struct mesh_input *input) {
    return input->name ? input->name : "a mesh";
}

static uint32_t corner_count(const struct mesh_input *input) {
    return input->face_count ? input->face_start[input->face_count] : 0;
}

/* --- welding --- */

bool mesh_input_weld(struct mesh_input *input, struct mesh_tables *own, double distance, struct error *error) {
    uint32_t corners = corner_count(input), count = input->vertex_count, kept = 0;
    uint32_t *same = mem_alloc((size_t)count * sizeof *same), *index = mem_alloc((size_t)corners * sizeof *index);
    double(*vertices)[3] = mem_alloc((size_t)count * sizeof *vertices);
    bool by_vertex = input->colours && !input->colours_by_face;
    float(*colours)[3] = by_vertex ? mem_alloc((size_t)count * sizeof *colours) : NULL;
    bool ok = same && index && vertices && (colours || !by_vertex) &&
              (distance > 0 ? mesh_weld_near(input->vertices, count, distance, same)
                            : mesh_weld(input->vertices, count, same));
    if (!ok) {
        mem_free(vertices);
        mem_free(colours);
        mem_free(index);
        mem_free(same);
        return error_no_memory(error, name_of(input));
    }
    for (uint32_t c = 0; c < corners; c++)
        index[c] = same[input->vertex_index[c]];
    /* The first vertex of each place that a face uses keeps its order; same[] becomes the new number. */
    for (uint32_t v = 0; v < count; v++)
        same[v] = NONE;
    for (uint32_t c = 0; c < corners; c++)
        same[index[c]] = 0;
    for (uint32_t v = 0; v < count; v++) {
        if (same[v] == NONE)
            continue;
        memcpy(vertices[kept], input->vertices[v], sizeof *vertices);
        if (colours)
            memcpy(colours[kept], input->colours[v], sizeof *colours);
        same[v] = kept++;
    }
    for (uint32_t c = 0; c < corners; c++)
        index[c] = same[index[c]];
    mem_free(same);
    own->vertices = vertices;
    own->colours = colours;
    own->vertex_index = index;
    /* Normals and uvs that shared the vertices' indices keep the old ones. */
    input->vertices = (const double(*)[3])vertices;
    if (by_vertex)
        input->colours = (const float(*)[3])colours;
    input->vertex_count = kept;
    input->vertex_index = index;
    return true;
}

/* --- reversing --- */

/* The index lists of all corners with each face backwards; equal pointers stay equal. */
static uint32_t *reversed(const struct mesh_input *input, const uint32_t *index) {
    uint32_t corners = corner_count(input), *out = mem_alloc((size_t)corners * sizeof *out);
    for (uint32_t f = 0; out && f < input->face_count; f++) {
        uint32_t first = input->face_start[f], end = input->face_start[f + 1];
        for (uint32_t c = first; c < end; c++)
            out[c] = index[end - 1 - (c - first)];
    }
    return out;
}

static bool replace(uint32_t **own, const uint32_t **used, uint32_t *made) {
    mem_free(*own);
    *own = made;
    *used = made;
    return made != NULL;
}

bool mesh_input_flip(struct mesh_input *input, struct mesh_tables *own, struct error *error) {
    bool ok = true;
    if (input->normals && input->normal_index)
        ok = replace(&own->normal_index, &input->normal_index, reversed(input, input->normal_index));
    if (ok && input->uvs && input->uv_index)
        ok = replace(&own->uv_index, &input->uv_index, reversed(input, input->uv_index));
    ok = ok && replace(&own->vertex_index, &input->vertex_index, reversed(input, input->vertex_index));
    if (ok && input->normals) {
        double(*normals)[3] = mem_alloc((size_t)input->normal_count * sizeof *normals);
        ok = normals != NULL;
        for (uint32_t i = 0; ok && i < input->normal_count; i++)
            for (int k = 0; k < 3; k++)
                normals[i][k] = -input->normals[i][k];
        mem_free(own->normals);
        own->normals = normals;
        input->normals = (const double(*)[3])normals;
    }
    return ok || error_no_memory(error, name_of(input));
}

/* --- normals with a crease angle --- */

/* Everything that mesh_input_smooth works with; freed as a whole. */
struct smoothing {
    const struct mesh_input *input;
    double unit; /* power of two that scales lengths to about 1 */
    uint32_t *same, *face_of, *set, *start;
    struct vec3 *normals; /* of faces: unit, or zero if the face has no area */
    uint64_t *uses;       /* edges: (other vertex) << 32 | corner it starts at */
};

static struct vec3 position(const struct smoothing *s, uint32_t corner) {
    const double *v = s->input->vertices[s->input->vertex_index[corner]];
    return vec3_make(v[0] * s->unit, v[1] * s->unit, v[2] * s->unit);
}

static double unit_of(const struct mesh_input *input) {
    double largest = 0;
    for (uint32_t i = 0; i < input->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            largest = math_max(largest, fabs(input->vertices[i][k]));
    int exponent = 0;
    if (largest > 0)
        (void)math_frexp(largest, &exponent);
    /* Both ends of the range of doubles are possible results of ldexp. */
    return math_ldexp(1, exponent < -1000 ? 1000 : -exponent);
}

static uint32_t next_corner(const struct smoothing *s, uint32_t corner) {
    uint32_t f = s->face_of[corner];
    return corner + 1 < s->input->face_start[f + 1] ? corner + 1 : s->input->face_start[f];
}

static uint32_t previous_corner(const struct smoothing *s, uint32_t corner) {
    uint32_t f = s->face_of[corner];
    return corner > s->input->face_start[f] ? corner - 1 : s->input->face_start[f + 1] - 1;
}

/* Coordinates are about 1, so a face with less height than this is not distinguishable from a degenerate one. */
static const double no_height = 0x1p-46;

/* The sum over a fan from the first corner: twice the area vector, for any polygon. */
static void face_normals(struct smoothing *s) {
    const struct mesh_input *input = s->input;
    for (uint32_t f = 0; f < input->face_count; f++) {
        uint32_t first = input->face_start[f], end = input->face_start[f + 1];
        struct vec3 base = position(s, first), sum = {0};
        double length = 0;
        for (uint32_t c = first; c < end; c++) {
            s->face_of[c] = f;
            length = math_max(length, vec3_max_abs(vec3_sub(position(s, c), base)));
        }
        for (uint32_t c = first + 1; c + 1 < end; c++)
            sum = vec3_add(sum, vec3_cross(vec3_sub(position(s, c), base), vec3_sub(position(s, c + 1), base)));
        s->normals[f] = vec3_max_abs(sum) > no_height * length ? vec3_normalize(sum) : vec3_all(0);
    }
}

static uint32_t find(uint32_t *set, uint32_t corner) {
    while (set[corner] != corner) {
        set[corner] = set[set[corner]];
        corner = set[corner];
    }
    return corner;
}

/* The lower corner becomes the root. */
static void unite(uint32_t *set, uint32_t a, uint32_t b) {
    a = find(set, a);
    b = find(set, b);
    if (a < b)
        set[b] = a;
    else
        set[a] = b;
}

/* Edges at their lower vertex: uses[start[v]] .. uses[start[v + 1] - 1]. */
static void gather_edges(struct smoothing *s) {
    uint32_t corners = corner_count(s->input);
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t c = 0; c < corners; c++) {
            uint32_t a = s->same[s->input->vertex_index[c]], b = s->same[s->input->vertex_index[next_corner(s, c)]];
            uint32_t low = a < b ? a : b, high = a < b ? b : a;
            if (pass == 0)
                s->start[low + 2]++;
            else
                s->uses[s->start[low + 1]++] = (uint64_t)high << 32 | c;
        }
        for (size_t v = 2; pass == 0 && v < (size_t)s->input->vertex_count + 2; v++)
            s->start[v] += s->start[v - 1];
    }
}

static void unite_across(struct smoothing *s, uint32_t c, uint32_t d, double min_cosine) {
    const struct mesh_input *input = s->input;
    uint32_t c_next = next_corner(s, c), d_next = next_corner(s, d);
    bool opposite = s->same[input->vertex_index[c]] == s->same[input->vertex_index[d_next]] &&
                    s->same[input->vertex_index[c_next]] == s->same[input->vertex_index[d]];
    struct vec3 n = s->normals[s->face_of[c]], m = s->normals[s->face_of[d]];
    if (!opposite || s->face_of[c] == s->face_of[d] || !(vec3_dot(n, m) >= min_cosine))
        return;
    unite(s->set, c, d_next);
    unite(s->set, c_next, d);
}

static void unite_smooth_edges(struct smoothing *s, double degrees) {
    /* A little more than the angle, so that rounding splits no edge of exactly this angle; 180 includes every edge. */
    double min = degrees >= 180 ? -2 : el_cos(degrees * (PI / 180)) - 0x1p-40;
    for (uint32_t v = 0; v < s->input->vertex_count; v++) {
        uint64_t *uses = s->uses + s->start[v];
        size_t count = s->start[v + 1] - s->start[v], end;
        sort_words(uses, count);
        for (size_t i = 0; i < count; i = end) {
            for (end = i + 1; end < count && uses[end] >> 32 == uses[i] >> 32; end++)
                continue;
            if (end == i + 2 && uses[i] >> 32 != v)
                unite_across(s, (uint32_t)uses[i], (uint32_t)uses[i + 1], min);
        }
    }
}

static double corner_angle(const struct smoothing *s, uint32_t corner) {
    struct vec3 p = position(s, corner);
    struct vec3 a = vec3_normalize(vec3_sub(position(s, next_corner(s, corner)), p));
    struct vec3 b = vec3_normalize(vec3_sub(position(s, previous_corner(s, corner)), p));
    return el_atan2(vec3_length(vec3_cross(a, b)), vec3_dot(a, b));
}

/* Sums over the sets, in the order of corners; set[root] must be final. */
static bool sum_normals(struct smoothing *s, struct mesh_tables *own, uint32_t *count) {
    uint32_t corners = corner_count(s->input), sets = 0;
    own->normal_index = mem_alloc((size_t)corners * sizeof *own->normal_index);
    if (!own->normal_index)
        return false;
    for (uint32_t c = 0; c < corners; c++) /* roots come before their members */
        own->normal_index[c] = find(s->set, c) == c ? sets++ : own->normal_index[find(s->set, c)];
    own->normals = mem_alloc_zero(sets ? sets : 1, sizeof *own->normals);
    if (!own->normals)
        return false;
    for (uint32_t c = 0; c < corners; c++) {
        struct vec3 n = s->normals[s->face_of[c]];
        double weight = corner_angle(s, c), *sum = own->normals[own->normal_index[c]];
        sum[0] += weight * n.x;
        sum[1] += weight * n.y;
        sum[2] += weight * n.z;
    }
    for (uint32_t c = 0; c < corners; c++) {
        /* Opposite faces cancel (a sheet folded back): then the corner has its face's own normal. */
        double *sum = own->normals[own->normal_index[c]];
        if (vec3_length(vec3_make(sum[0], sum[1], sum[2])) < 0x1p-30) {
            struct vec3 n = s->normals[s->face_of[c]];
            sum[0] = n.x, sum[1] = n.y, sum[2] = n.z;
        }
    }
    for (uint32_t i = 0; i < sets; i++) {
        double *sum = own->normals[i];
        struct vec3 unit = vec3_normalize(vec3_make(sum[0], sum[1], sum[2]));
        sum[0] = unit.x, sum[1] = unit.y, sum[2] = unit.z;
    }
    /* A face without area has no normal, and then none at all. */
    for (uint32_t c = 0; c < corners; c++) {
        const double *n = own->normals[own->normal_index[c]];
        if (n[0] == 0 && n[1] == 0 && n[2] == 0)
            own->normal_index[c] = NONE;
    }
    *count = sets;
    return true;
}

bool mesh_input_smooth(struct mesh_input *input, struct mesh_tables *own, double degrees, struct error *error) {
    mem_free(own->normals);
    mem_free(own->normal_index);
    own->normals = NULL;
    own->normal_index = NULL;
    input->normals = NULL;
    input->normal_index = NULL;
    input->normal_count = 0;
    if (!(degrees > 0))
        return true;
    /* Corners at one vertex share a normal if smooth edges connect their faces. */
    size_t corners = corner_count(input), vertices = input->vertex_count;
    struct smoothing s = {.input = input, .unit = unit_of(input)};
    s.same = mem_alloc(vertices * sizeof *s.same);
    s.face_of = mem_alloc(corners * sizeof *s.face_of);
    s.set = mem_alloc(corners * sizeof *s.set);
    s.start = mem_alloc_zero(vertices + 2, sizeof *s.start);
    s.normals = mem_alloc((size_t)input->face_count * sizeof *s.normals);
    s.uses = mem_alloc(corners * sizeof *s.uses);
    uint32_t count = 0;
    bool ok = s.same && s.face_of && s.set && s.start && s.normals && s.uses &&
              mesh_weld(input->vertices, input->vertex_count, s.same);
    if (ok) {
        for (uint32_t c = 0; c < corners; c++)
            s.set[c] = c;
        face_normals(&s);
        gather_edges(&s);
        unite_smooth_edges(&s, degrees);
        ok = sum_normals(&s, own, &count);
    }
    mem_free(s.same);
    mem_free(s.face_of);
    mem_free(s.set);
    mem_free(s.start);
    mem_free(s.normals);
    mem_free(s.uses);
    if (!ok)
        return error_no_memory(error, name_of(input));
    input->normal_count = count;
    input->normals = (const double(*)[3])own->normals;
    input->normal_index = own->normal_index;
    return true;
}
