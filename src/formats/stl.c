/* STL, text and binary. Source of both: 3D Systems, "StereoLithography Interface Specification", 1988-1989 (binary:
 * any 80 bytes, a count, then per triangle twelve little-endian floats and two bytes of attributes). The file
 * repeats every corner. Corners at exactly the same position become one vertex, so that closed solids are closed.
 * The normals in the file are not used: they contain no more than the order of the corners, and are often zero or
 * wrong. */
#include "formats/decimal_internal.h"
#include "formats/model.h"
#include "formats/scan_internal.h"

#include "mesh/mesh_topology.h"

#include <assert.h>
#include <math.h>
#include <strings.h>

enum { HEADER = 84, FACET = 50 };

/* One vertex for each position, numbered by first use. mesh->vertices has a vertex for each corner. */
static bool weld(struct model *model, struct model_mesh *mesh, struct error *error) {
    size_t corners = mesh->vertices.count;
    double(*vertices)[3] = mesh->vertices.items;
    uint32_t *index = list_room(&mesh->vertex_index, corners, sizeof *index);
    uint32_t *starts = list_room(&mesh->starts, corners / 3 + 1, sizeof *starts), kept = 0;
    if (!index || !starts || !mesh_weld((const double(*)[3])vertices, (uint32_t)corners, index))
        return error_no_memory(error, model->path);
    for (size_t c = 0; c < corners; c++) {
        /* The first corner of a place is kept, and has its new number already. */
        if (index[c] != c) {
            index[c] = index[index[c]];
            continue;
        }
        memmove(vertices[kept], vertices[c], sizeof *vertices);
        index[c] = kept++;
    }
    for (uint32_t f = 0; f < corners / 3; f++)
        starts[f] = 3 * f;
    mesh->vertex_index.count = corners;
    mesh->starts.count = corners / 3;
    mesh->vertices.count = kept;
    double(*smaller)[3] = mem_resize_array(vertices, kept ? kept : 1, sizeof *vertices);
    if (smaller)
        mesh->vertices.items = smaller, mesh->vertices.capacity = kept ? kept : 1;
    return true;
}

static bool load_binary(struct model *model, struct model_mesh *mesh, const uint8_t *data, size_t size,
                        struct error *error) {
    if (size < HEADER)
        return error_set(error, ERROR_SCENE, "%s: byte %zu: a binary STL file has at least %d bytes", model->path, size,
                         HEADER);
    uint32_t count = scan_u32(data + 80, false);
    if (count > (size - HEADER) / FACET)
        return error_set(error, ERROR_SCENE, "%s: byte 80: %u triangles need %llu bytes, but the file has only %zu",
                         model->path, count, (unsigned long long)count * FACET + HEADER, size);
    if (3 * (size_t)count > model_max(model))
        return error_set(error, ERROR_SCENE, "%s: byte 80: %u triangles are too many", model->path, count);
    double(*vertices)[3] = list_room(&mesh->vertices, 3 * (size_t)count, sizeof *vertices);
    if (!vertices)
        return error_no_memory(error, model->path);
    /* Behind the normal of each triangle, which its corners give anyway. */
    const uint8_t *at = data + HEADER + 12;
    for (uint32_t i = 0; i < count; i++, at += FACET)
        for (unsigned k = 0; k < 9; k++) {
            double x = scan_f32(at + 4 * k, false);
            if (!isfinite(x))
                return error_set(error, ERROR_SCENE, "%s: byte %zu: a coordinate is not a finite number", model->path,
                                 (size_t)(at + 4 * k - data));
            vertices[3 * (size_t)i + k / 3][k % 3] = x;
        }
    mesh->vertices.count = 3 * (size_t)count;
    return true;
}

struct text {
    const char *path, *at, *end;
    size_t line;
    struct error *error;
};

static bool is_space(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* The next word of the file; its length is 0 at the end. */
static size_t next_word(struct text *t) {
    while (t->at < t->end && is_space(*t->at))
        t->line += *t->at++ == '\n';
    const char *p = t->at;
    while (p < t->end && !is_space(*p))
        p++;
    return (size_t)(p - t->at);
}

static bool is_word(const struct text *t, size_t length, const char *word) {
    return strlen(word) == length && strncasecmp(t->at, word, length) == 0;
}

static bool fail(struct text *t, size_t length, const char *wanted) {
    char word[40];
    size_t shown = length < sizeof word - 1 ? length : sizeof word - 1;
    for (size_t i = 0; i < shown; i++)
        word[i] = t->at[i] >= 0x20 && t->at[i] < 0x7f ? t->at[i] : '?';
    word[shown] = '\0';
    if (length == 0)
        return error_set(t->error, ERROR_SCENE, "%s:%zu: the file ends where %s must be", t->path, t->line, wanted);
    return error_set(t->error, ERROR_SCENE, "%s:%zu: '%s' is found where %s must be", t->path, t->line, word, wanted);
}

static bool expect(struct text *t, const char *word) {
    size_t length = next_word(t);
    if (!is_word(t, length, word))
        return fail(t, length, word);
    t->at += length;
    return true;
}

static bool read_point(struct text *t, double out[3]) {
    for (int k = 0; k < 3; k++) {
        size_t length = next_word(t);
        if (length == 0 || decimal_read(t->at, t->at + length, &out[k]) != t->at + length)
            return fail(t, length, "a finite number");
        t->at += length;
    }
    return true;
}

/* Skips three words: some exporters write nan there. */
static bool skip_normal(struct text *t) {
    for (int k = 0; k < 3; k++) {
        size_t length = next_word(t);
        if (length == 0)
            return fail(t, length, "a normal");
        t->at += length;
    }
    return true;
}

static bool read_facet(struct text *t, struct list *vertices) {
    double(*corner)[3] = list_room(vertices, 3, sizeof *corner);
    if (!corner)
        return error_no_memory(t->error, t->path);
    if (!expect(t, "normal") || !skip_normal(t) || !expect(t, "outer") || !expect(t, "loop"))
        return false;
    for (int i = 0; i < 3; i++)
        if (!expect(t, "vertex") || !read_point(t, corner[i]))
            return false;
    vertices->count += 3;
    return expect(t, "endloop") && expect(t, "endfacet");
}

static void skip_line(struct text *t) {
    while (t->at < t->end && *t->at != '\n')
        t->at++;
}

static bool load_text(struct model *model, struct model_mesh *mesh, const char *data, size_t size,
                      struct error *error) {
    struct text t = {.path = model->path, .at = data, .end = data + size, .line = 1, .error = error};
    assert(size >= 3); /* a text begins with "solid"; other texts are errors */
    if (memcmp(data, "\xef\xbb\xbf", 3) == 0)
        t.at += 3;
    bool inside = false;
    for (size_t length; (length = next_word(&t)) > 0;) {
        if (!inside && is_word(&t, length, "solid")) {
            skip_line(&t); /* its name */
            inside = true;
        } else if (inside && is_word(&t, length, "facet")) {
            t.at += length;
            if (!read_facet(&t, &mesh->vertices))
                return false;
        } else if (inside && is_word(&t, length, "endsolid")) {
            skip_line(&t);
            inside = false;
        } else {
            return fail(&t, length, inside ? "facet or endsolid" : "solid");
        }
        if (mesh->vertices.count > model_max(model))
            return error_set(error, ERROR_SCENE, "%s:%zu: too many triangles", model->path, t.line);
    }
    if (inside)
        return fail(&t, 0, "facet or endsolid");
    return true;
}

bool stl_load(struct model *model, const uint8_t *data, size_t size, bool binary, struct error *error) {
    struct model_mesh *mesh = model_add_mesh(model, error);
    if (!mesh)
        return false;
    bool ok =
        binary ? load_binary(model, mesh, data, size, error) : load_text(model, mesh, (const char *)data, size, error);
    return ok && weld(model, mesh, error);
}
