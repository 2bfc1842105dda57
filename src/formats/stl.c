/* STL, text and binary. Source of both: 3D Systems, "StereoLithography Interface Specification", 1988-1989 (binary:
 * any 80 bytes, a count, then per triangle twelve little-endian floats and two bytes of attributes). The file
 * repeats every corner. Corners at exactly the same position become one vertex, so that closed solids are closed.
 * The normals in the file are not used: they contain no more than the order of the corners, and are often zero or
 * wrong.
 *
 * The attributes may be colours, 5 bits each: by VisCAM and SolidView with bit 15 set and blue lowest, or by
 * Materialise Magics, whose header has "COLOR=" and four bytes, the colour of triangles with bit 15 set; the others
 * have their own, red lowest. */
#include "formats/decimal_internal.h"
#include "formats/model.h"
#include "formats/scan_internal.h"
#include "math/range.h"

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

/* --- binary --- */

/* Behind "COLOR=" in the header; NULL: there is none. */
static const uint8_t *header_colour(const uint8_t *data) {
    for (size_t at = 0; at + 10 <= 80; at++)
        if (memcmp(data + at, "COLOR=", 6) == 0)
            return data + at + 6;
    return NULL;
}

static bool read_colours(struct model *model, struct model_mesh *mesh, const uint8_t *facets, struct error *error) {
    size_t count = mesh->vertices.count / 3;
    const uint8_t *all = header_colour(facets - HEADER);
    bool given = false, own = false;
    for (size_t i = 0; i < count; i++) {
        uint16_t bits = scan_u16(facets + FACET * (i + 1) - 2, false);
        given |= bits >> 15;
        own |= bits != 0;
    }
    /* Without any attribute, the header's colour is that of all triangles. */
    if (!given && !all)
        return true;
    float(*colours)[3] = list_room(&mesh->colours, count, sizeof *colours);
    if (!colours)
        return error_no_memory(error, model->path);
    for (size_t i = 0; i < count; i++) {
        unsigned bits = scan_u16(facets + FACET * (i + 1) - 2, false);
        for (unsigned k = 0; k < 3; k++) {
            float mine = (float)(bits >> 5 * (all ? k : 2 - k) & 31) / 31;
            bool is_common = all ? bits >> 15 || !own : !(bits >> 15);
            colours[i][k] = !is_common ? mine : all ? (float)all[k] / 255 : 0.8F;
        }
    }
    mesh->colours.count = count;
    mesh->colours_by_face = true;
    return model_show_colours(model, mesh, error);
}

/* The number of triangles that are read. Some writers state fewer than there are, or are cut off in the last one. */
static bool count_facets(struct model *model, const uint8_t *data, size_t size, uint32_t *out, struct error *error) {
    uint32_t count = scan_u32(data + 80, false);
    size_t there = (size - HEADER) / FACET, rest = (size - HEADER) % FACET;
    *out = count;
    if (count > there + 1 || (count > there && rest == 0))
        return error_set(error, ERROR_SCENE, "%s: byte 80: %u triangles need %llu bytes, but the file has only %zu",
                         model->path, count, (unsigned long long)count * FACET + HEADER, size);
    if (count > there) {
        model_warn(model, "%s: byte %zu: the file ends in the last triangle, which is left out", model->path, size);
        *out = (uint32_t)there;
    } else if (there > count && rest == 0) {
        bool fine = true;
        for (size_t i = count; i < there; i++)
            for (unsigned k = 0; k < 12; k++)
                fine = fine && number_in_range(scan_f32(data + HEADER + FACET * i + 4 * k, false));
        model_warn(model, "%s: byte 80: the file states %u triangles, but has bytes for %zu: %s", model->path, count,
                   there, fine ? "all are shown" : "the others are left out");
        *out = fine && there <= UINT32_MAX ? (uint32_t)there : count;
    } else if (size - HEADER > (size_t)count * FACET) {
        model_warn(model, "%s: byte %zu: %zu bytes follow the %u triangles and are left out", model->path,
                   HEADER + (size_t)count * FACET, size - HEADER - (size_t)count * FACET, count);
    }
    return true;
}

static bool load_binary(struct model *model, struct model_mesh *mesh, const uint8_t *data, size_t size,
                        struct error *error) {
    uint32_t count;
    if (size < HEADER)
        return error_set(error, ERROR_SCENE, "%s: byte %zu: a binary STL file has at least %d bytes", model->path, size,
                         HEADER);
    if (!count_facets(model, data, size, &count, error))
        return false;
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
    return read_colours(model, mesh, data + HEADER, error);
}

/* --- text --- */

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
    for (; t->at < t->end && is_space(*t->at); t->at++)
        t->line += *t->at == '\n' || (*t->at == '\r' && (t->at + 1 == t->end || t->at[1] != '\n'));
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

/* endloop, or end loop. */
static bool expect_end(struct text *t, const char *whole) {
    if (is_word(t, next_word(t), "end")) {
        t->at += 3;
        return expect(t, whole + 3);
    }
    return expect(t, whole);
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
    if (!expect_end(t, "endloop") || !expect_end(t, "endfacet"))
        return false;
    vertices->count += 3;
    return true;
}

static void skip_line(struct text *t) {
    while (t->at < t->end && *t->at != '\n' && *t->at != '\r')
        t->at++;
}

/* What writers of tapes and of CP/M left behind: zeros and ^Z. */
static bool is_padding(const struct text *t, size_t length) {
    for (size_t i = 0; i < length; i++)
        if (t->at[i] != '\0' && t->at[i] != 0x1a)
            return false;
    return true;
}

/* Whether the last triangle failed at the last word of the file: then it is left out. */
static bool is_cut_off(struct model *model, struct text *t) {
    size_t length = next_word(t);
    if (t->at + length < t->end || t->error->kind != ERROR_SCENE)
        return false;
    *t->error = (struct error){0};
    t->at = t->end;
    model_warn(model, "%s:%zu: the file ends in a triangle, which is left out", t->path, t->line);
    return true;
}

static bool load_text(struct model *model, struct model_mesh *mesh, const char *data, size_t size,
                      struct error *error) {
    struct text t = {.path = model->path, .at = data, .end = data + size, .line = 1, .error = error};
    assert(size >= 3); /* a text has a facet or a solid */
    if (memcmp(data, "\xef\xbb\xbf", 3) == 0)
        t.at += 3;
    struct unread unread = {0};
    for (size_t length; (length = next_word(&t)) > 0;) {
        if (is_word(&t, length, "facet")) {
            t.at += length;
            if (!read_facet(&t, &mesh->vertices) && !is_cut_off(model, &t))
                return false;
        } else {
            /* Names may follow; solids need neither a beginning nor an end. */
            bool known = (length >= 3 && strncasecmp(t.at, "end", 3) == 0) || is_word(&t, length, "solid");
            if (!known && !is_padding(&t, length))
                unread_add(&unread, t.at, length, t.line);
            skip_line(&t);
        }
        if (mesh->vertices.count > model_max(model))
            return error_set(error, ERROR_SCENE, "%s:%zu: too many triangles", model->path, t.line);
    }
    model_warn_unread(model, model->path, &unread);
    /* What was left out is the reason otherwise. */
    return mesh->vertices.count > 0 || model->warning_count > 0 ||
           error_set(error, ERROR_SCENE, "%s: no triangles in this STL text", model->path);
}

bool stl_load(struct model *model, const uint8_t *data, size_t size, bool binary, struct error *error) {
    struct model_mesh *mesh = model_add_mesh(model, error);
    if (!mesh)
        return false;
    bool ok =
        binary ? load_binary(model, mesh, data, size, error) : load_text(model, mesh, (const char *)data, size, error);
    return ok && weld(model, mesh, error);
}
