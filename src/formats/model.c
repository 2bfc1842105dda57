/* The common part of all mesh readers: recognising files, collecting tables, making meshes. Tables exist from the
 * reader until model_finish. At any time, a large file is in memory at most once as bytes, once as tables and once
 * as a mesh. */
#include "formats/model.h"
#include "formats/model_format.h"

#include "base/file.h"
#include "base/unreachable.h"
#include "formats/scan_internal.h"
#include "image/zlib_memory.h"
#include "math/range.h"
#include "mesh/mesh_smooth.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* gzip from memory into memory, through zlib (RFC 1951, 1952). Deflate can expand by a factor of a thousand, so the
 * result is limited to a reasonable size of mesh files: a small hostile file uses little memory. A file may consist
 * of several members in succession; zeros after the last one are padding. */

/* zlib counts in 32 bits: long files are processed in pieces (small ones in test builds). */
#ifdef GRAY_FAULTS
enum { PIECE = 1 << 12 };
#else
enum { PIECE = 1 << 30 };
#endif
enum { GROWTH = 64, START = 1 << 24 };

static size_t consumed(const z_stream *stream, const uint8_t *data) {
    return (size_t)(stream->next_in - data);
}

/* Appends one member, which starts at stream->next_in, to *out. */
static bool member(z_stream *stream, const char *path, struct file_bytes from, struct list *out, size_t limit,
                   struct error *error) {
    for (;;) {
        size_t left_in = from.size - consumed(stream, from.data), chunk = out->count / 2 + 65536;
        if (chunk > limit - out->count)
            chunk = limit - out->count;
        uint8_t *room = list_room(out, chunk, 1);
        if (!room)
            return error_no_memory(error, path);
        stream->avail_in = left_in < PIECE ? (uInt)left_in : PIECE;
        stream->next_out = room;
        stream->avail_out = chunk < PIECE ? (uInt)chunk : PIECE;
        int status = inflate(stream, Z_NO_FLUSH);
        size_t made = (size_t)(stream->next_out - room);
        out->count += made;
        if (status == Z_STREAM_END)
            return true;
        if (status == Z_MEM_ERROR)
            return error_no_memory(error, path);
        if (status != Z_OK && status != Z_BUF_ERROR) {
            assert(stream->msg); /* zlib states a reason for every error in the data */
            return error_set(error, ERROR_SCENE, "%s: byte %zu: the gzip data are broken: %s", path,
                             consumed(stream, from.data), stream->msg);
        }
        if (out->count == limit)
            return error_set(error, ERROR_SCENE,
                             "%s: byte %zu: the gzip data grow beyond %zu bytes, %d times the file: refused", path,
                             consumed(stream, from.data), limit, GROWTH);
        if (made == 0 && consumed(stream, from.data) == from.size)
            return error_set(error, ERROR_SCENE, "%s: byte %zu: the gzip data end too early", path, from.size);
    }
}

/* Unpacks gzip (RFC 1952) in memory; the result is from mem.h. It is refused if it grows more than 64 times beyond
 * 16 MB. */
static bool gunzip(const char *path, const uint8_t *data, size_t size, uint8_t **out, size_t *out_size,
                   struct error *error) {
    z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
    struct list bytes = {0};
    *out = NULL;
    if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK)
        return error_no_memory(error, path);
    stream.next_in = (z_const Bytef *)(uintptr_t)data;
    size_t limit = START + size * GROWTH, at = 0;
    bool ok = true, more = true;
    /* A gzip file may consist of several members, one behind the other. */
    while (ok && more) {
        ok = member(&stream, path, (struct file_bytes){data, size}, &bytes, limit, error);
        at = consumed(&stream, data);
        more = ok && size - at >= 2 && data[at] == 0x1f && data[at + 1] == 0x8b;
        if (more)
            (void)inflateReset(&stream);
    }
    (void)inflateEnd(&stream);
    /* Tapes and some programs pad with zeros. */
    for (size_t i = at; ok && i < size; i++)
        if (data[i] != 0)
            ok = error_set(error, ERROR_SCENE, "%s: byte %zu: other bytes follow the gzip data", path, i);
    if (!ok) {
        list_destroy(&bytes);
        return false;
    }
    *out = bytes.items;
    *out_size = bytes.count;
    return true;
}

#define FILE_LIMIT ((size_t)1 << 36)

struct model_mesh *model_add_mesh(struct model *model, struct error *error) {
    struct model_mesh *mesh = list_room(&model->meshes, 1, sizeof *mesh);
    if (!mesh) {
        error_no_memory(error, model->path);
        return NULL;
    }
    *mesh = (struct model_mesh){.name = model->path};
    model->meshes.count++;
    return mesh;
}

struct model_material *model_add_material(struct model *model, struct error *error) {
    static const struct model_texture none = {
        .scale = {1, 1}, .strength = 1, .wrap_u = IMAGE_REPEAT, .wrap_v = IMAGE_REPEAT, .filter = IMAGE_MIPMAP};
    struct model_material *material = list_room(&model->materials, 1, sizeof *material);
    if (!material) {
        error_no_memory(error, model->path);
        return NULL;
    }
    *material = (struct model_material){.name = "",
                                        .kd = {0.8, 0.8, 0.8},
                                        .filter = {1, 1, 1},
                                        .dissolve = 1,
                                        .ior = 1,
                                        .illum = -1,
                                        .map_kd = none,
                                        .map_ks = none,
                                        .map_ke = none,
                                        .map_d = none,
                                        .map_bump = none,
                                        .map_normal = none,
                                        .map_metal = none,
                                        .map_gloss = none,
                                        .map_coat_normal = none};
    for (int i = 0; i < MODEL_LAYER_MAPS; i++)
        material->layer_maps[i].map = none;
    model->materials.count++;
    return material;
}

struct model_texture *model_map(struct model_material *m, size_t index) {
    struct model_texture *const maps[] = {&m->map_kd,    &m->map_ks,    &m->map_ke,
                                          &m->map_d,     &m->map_bump,  &m->map_normal,
                                          &m->map_metal, &m->map_gloss, &m->map_coat_normal};
    const size_t count = sizeof maps / sizeof *maps;
    if (index < count)
        return maps[index];
    return index - count < m->layer_map_count ? &m->layer_maps[index - count].map : NULL;
}

struct model_node *model_add_node(struct model *model, struct error *error) {
    struct model_node *node = list_room(&model->nodes, 1, sizeof *node);
    if (!node) {
        error_no_memory(error, model->path);
        return NULL;
    }
    *node = (struct model_node){
        .name = "", .parent = MODEL_NONE, .mesh = MODEL_NONE, .parent_from_node = transform_identity()};
    model->nodes.count++;
    return node;
}

void model_warn(struct model *model, const char *format, ...) {
    if (model->warning_count == MODEL_WARNINGS)
        return;
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (model->warning_count == MODEL_WARNINGS - 1)
        (void)snprintf(text, sizeof text, "%s: more warnings are left out", model->path);
    for (char *c = text; *c; c++) /* names from the file may contain any bytes */
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = '?';
    for (int i = 0; i < model->warning_count; i++)
        if (strcmp(model->warnings[i], text) == 0)
            return;
    char *copy = arena_copy_text(&model->arena, text, strlen(text));
    if (copy)
        model->warnings[model->warning_count++] = copy;
}

/* --- what is left out --- */

void left_out_add(struct left_out *out, size_t at) {
    if (out->count++ == 0)
        out->at = at;
}

void model_warn_left_out(struct model *model, const char *path, const struct left_out *out, bool binary,
                         const char *what) {
    if (out->count == 1)
        model_warn(model, "%s:%s%zu: %s", path, binary ? " byte " : "", out->at, what);
    else if (out->count > 1)
        model_warn(model, "%s:%s%zu: %s (%zu times, the first here)", path, binary ? " byte " : "", out->at, what,
                   out->count);
}

void unread_add(struct unread *unread, const char *word, size_t length, size_t line) {
    left_out_add(&unread->lines, line);
    for (int i = 0; i < unread->word_count; i++)
        if (unread->words[i].length == length && memcmp(unread->words[i].text, word, length) == 0) {
            unread->words[i].count++;
            return;
        }
    if (unread->word_count == UNREAD_WORDS)
        return;
    unread->words[unread->word_count].text = word;
    unread->words[unread->word_count].length = length;
    unread->words[unread->word_count++].count = 1;
}

void model_warn_unread(struct model *model, const char *path, const struct unread *unread) {
    char list[UNREAD_WORDS * 128] = "";
    size_t used = 0, named = 0;
    if (unread->lines.count == 0)
        return;
    for (int i = 0; i < unread->word_count; i++) {
        char word[64] = "";
        size_t length = 0;
        /* Other bytes than those of ASCII by their numbers: a no-break space would not be seen. */
        for (size_t k = 0; k < unread->words[i].length && length < 40; k++) {
            unsigned char c = (unsigned char)unread->words[i].text[k];
            length += (size_t)snprintf(word + length, sizeof word - length, c > ' ' && c < 0x7f ? "%c" : "\\x%02x", c);
        }
        named += unread->words[i].count;
        used += (size_t)snprintf(list + used, sizeof list - used, "%s'%s' (%zu)", i ? ", " : "", word,
                                 unread->words[i].count);
    }
    if (named < unread->lines.count)
        (void)snprintf(list + used, sizeof list - used, " and others");
    model_warn(model, "%s:%zu: %zu line%s with a keyword that gray does not read, the first here: %s", path,
               unread->lines.at, unread->lines.count, unread->lines.count == 1 ? "" : "s", list);
}

bool model_show_colours(struct model *model, struct model_mesh *mesh, struct error *error) {
    uint32_t white = MODEL_NONE;
    for (size_t i = 0; i < model->materials.count; i++)
        model_materials(model)[i].by_vertex = true;
    if (mesh->slots.count == 0 && !list_add_index(&mesh->slots, MODEL_NONE))
        return error_no_memory(error, model->path);
    for (size_t i = 0; i < mesh->slots.count; i++) {
        uint32_t *slot = (uint32_t *)mesh->slots.items + i;
        if (*slot == MODEL_NONE && white == MODEL_NONE) {
            struct model_material *material = model_add_material(model, error);
            if (!material)
                return false;
            material->kd = colour_all(1);
            material->by_vertex = true;
            white = (uint32_t)model->materials.count - 1;
        }
        *slot = *slot == MODEL_NONE ? white : *slot;
    }
    return true;
}

/* --- files beside the model --- */

bool model_find(struct model *model, const char *name, size_t length, const char **path, struct error *error) {
    *path = NULL;
    model->refused = false;
    if (model->options.single_file || length == 0 || length > 4000 || memchr(name, '\0', length))
        return true;
    const char *slash = strrchr(model->path, '/');
    int folder = slash ? (int)(slash + 1 - model->path) : 0;
    char *plain = arena_copy_text(&model->arena, name, length);
    if (!plain)
        return error_no_memory(error, model->path);
    for (char *c = plain; *c; c++)
        if (*c == '\\')
            *c = '/';
    const char *last = strrchr(plain, '/');
    last = last ? last + 1 : plain;
    /* In the model's folder; at the stated path; with its bare name in the model's folder. */
    for (int attempt = 0; attempt < 3; attempt++) {
        char *tried =
            attempt == 1 ? plain : arena_format(&model->arena, "%.*s%s", folder, model->path, attempt ? last : plain);
        if (!tried)
            return error_no_memory(error, model->path);
        if (attempt == 1 && plain[0] != '/')
            continue;
        if (path_policy_is_readable(model->options.path_policy, tried)) {
            *path = tried;
            return true;
        }
    }
    if (!model->options.search)
        return true;
    char *beside = arena_format(&model->arena, "%.*s", folder, model->path);
    const char *found;
    if (!beside)
        return error_no_memory(error, model->path);
    if (!model->options.search(model->options.search_context, beside, plain, &found, &model->refused, error))
        return false;
    *path = found ? arena_copy_text(&model->arena, found, strlen(found)) : NULL;
    return *path || !found || error_no_memory(error, model->path);
}

const char *model_why_missing(const struct model *model) {
    return model->refused ? "lies outside the folders that scenes may read (--allow-read DIR adds one)"
                          : "is not there";
}

void model_warn_missing(struct model *model, const char *where, const char *name) {
    char text[512];
    if (model->options.single_file)
        return;
    (void)snprintf(text, sizeof text, "the picture '%.200s' %s", name, model_why_missing(model));
    for (int i = 0; i < model->warning_count; i++)
        if (strstr(model->warnings[i], text))
            return;
    model_warn(model, "%s: %s", where, text);
}

/* --- from tables to meshes --- */

static void tables_destroy(struct model_mesh *m) {
    struct list *lists[] = {&m->vertices, &m->normals,      &m->uvs,          &m->second_uvs, &m->colours,
                            &m->starts,   &m->vertex_index, &m->normal_index, &m->uv_index,   &m->face_slot};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++)
        list_destroy(lists[i]);
}

static struct mesh_input tables_input(const struct model_mesh *m) {
    struct mesh_input input = {
        .name = m->name,
        .vertex_count = (uint32_t)m->vertices.count,
        .vertices = m->vertices.items,
        .face_count = (uint32_t)m->starts.count,
        .face_start = m->starts.items,
        .vertex_index = m->vertex_index.items,
    };
    /* Normals and uv have indices of their own, or those of the vertices. */
    if (m->normals.count && (m->normals_by_vertex || m->normal_index.count)) {
        input.normal_count = (uint32_t)m->normals.count;
        input.normals = m->normals.items;
        input.normal_index = m->normals_by_vertex ? m->vertex_index.items : m->normal_index.items;
    }
    if (m->uvs.count && (m->uvs_by_vertex || m->uv_index.count)) {
        input.uv_count = (uint32_t)m->uvs.count;
        input.uvs = m->uvs.items;
        input.second_uvs = m->second_uvs.count ? m->second_uvs.items : NULL;
        input.uv_index = m->uvs_by_vertex ? m->vertex_index.items : m->uv_index.items;
    }
    if (m->face_slot.count && m->slots.count > 1)
        input.face_material = m->face_slot.items;
    assert(m->colours.count == 0 || m->colours.count == (m->colours_by_face ? m->starts : m->vertices).count);
    if (m->colours.count)
        input.colours = m->colours.items;
    input.colours_by_face = m->colours_by_face;
    return input;
}

static bool finish_mesh(struct model *model, struct model_mesh *m, struct error *error) {
    if (m->vertices.count > model_max(model) || m->vertex_index.count > model_max(model))
        return error_set(error, ERROR_SCENE, "%s: more than %zu vertices or corners", model->path, model_max(model));
    assert(m->starts.count <= m->vertex_index.count); /* no face without corners */
    uint32_t *start = list_room(&m->starts, 1, sizeof *start);
    if (!start)
        return error_no_memory(error, model->path);
    *start = (uint32_t)m->vertex_index.count;
    struct mesh_input input = tables_input(m);
    input.file = model->path;
    struct mesh_tables own = {0};
    bool ok = true;
    if (model->options.weld)
        ok = mesh_input_weld(&input, &own, model->options.weld_distance, error);
    if (ok && model->options.flip)
        ok = mesh_input_flip(&input, &own, error);
    if (ok && model->options.smooth)
        ok = mesh_input_smooth(&input, &own, model->options.smooth_angle, error);
    if (ok) {
        m->mesh = mesh_create(&input, error);
        ok = m->mesh != NULL;
    }
    mesh_tables_destroy(&own);
    tables_destroy(m);
    return ok;
}

/* --- the range of numbers --- */

/* The first row of that many doubles with one beyond the limit; SIZE_MAX: there is none. */
static size_t row_beyond(const struct list *rows, size_t width) {
    const double *numbers = rows->items;
    for (size_t i = 0; i < rows->count * width; i++)
        if (!number_in_range(numbers[i]))
            return i / width;
    return SIZE_MAX;
}

static bool check_tables(const struct model *model, const struct model_mesh *m, struct error *error) {
    const struct {
        const char *what;
        const struct list *rows;
        size_t width;
    } tables[] = {{"vertex", &m->vertices, 3},
                  {"normal", &m->normals, 3},
                  {"texture coordinate", &m->uvs, 2},
                  {"second texture coordinate", &m->second_uvs, 2}};
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
        size_t row = row_beyond(tables[i].rows, tables[i].width);
        if (row != SIZE_MAX)
            return error_set(error, ERROR_SCENE, "%s: a number of %s %zu is not between %g and %g", model->path,
                             tables[i].what, row + 1, -NUMBER_LIMIT, NUMBER_LIMIT);
    }
    return true;
}

static bool texture_in_range(const struct model_texture *map) {
    return number_in_range(map->scale[0]) && number_in_range(map->scale[1]) && number_in_range(map->offset[0]) &&
           number_in_range(map->offset[1]) && number_in_range(map->cross[0]) && number_in_range(map->cross[1]) &&
           number_in_range(map->strength);
}

static bool material_in_range(struct model_material *m) {
    const struct model_texture *map;
    for (size_t k = 0; (map = model_map(m, k)); k++)
        if (!texture_in_range(map))
            return false;
    return colour_within(m->ka, NUMBER_LIMIT) && colour_within(m->kd, NUMBER_LIMIT) &&
           colour_within(m->ks, NUMBER_LIMIT) && colour_within(m->ke, NUMBER_LIMIT) &&
           colour_within(m->filter, NUMBER_LIMIT) && number_in_range(m->shininess) &&
           colour_within(m->absorption, NUMBER_LIMIT) && number_in_range(m->layers.specular_ior) &&
           number_in_range(m->ior) && colour_within(m->gloss_colour, NUMBER_LIMIT);
}

static bool node_in_range(const struct model_node *node) {
    bool fine = transform_is_finite(&node->parent_from_node);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            fine = fine && number_in_range(node->parent_from_node.forward.m[i][j]);
    return fine;
}

/* For every format: numbers beyond the limit of scripts are errors in files, too. */
static bool check_numbers(const struct model *model, struct error *error) {
    for (size_t i = 0; i < model->meshes.count; i++)
        if (!check_tables(model, &model_meshes(model)[i], error))
            return false;
    for (size_t i = 0; i < model->materials.count; i++)
        if (!material_in_range(&model_materials(model)[i]))
            return error_set(error, ERROR_SCENE, "%s: a number of material %zu is not between %g and %g", model->path,
                             i + 1, -NUMBER_LIMIT, NUMBER_LIMIT);
    for (size_t i = 0; i < model->nodes.count; i++)
        if (!node_in_range(&model_nodes(model)[i]))
            return error_set(error, ERROR_SCENE,
                             "%s: the transform of node %zu has a number that is not between %g and %g, or no inverse",
                             model->path, i + 1, -NUMBER_LIMIT, NUMBER_LIMIT);
    return true;
}

#define EXTENSION(format, extension) (extension),
static const char *const extensions[] = {MODEL_FORMATS_BOTH(EXTENSION)};

/* The extension without ".gz", and its length. */
static const char *extension_of(const char *path, size_t *length) {
    size_t end = strlen(path);
    if (end > 3 && strcasecmp(path + end - 3, ".gz") == 0)
        end -= 3;
    size_t dot = end;
    while (dot > 0 && path[dot - 1] != '.' && path[dot - 1] != '/')
        dot--;
    *length = dot > 0 && path[dot - 1] == '.' ? end - dot : 0;
    return path + dot;
}

static bool is_word(const char *text, size_t length, const char *word) {
    return strlen(word) == length && strncasecmp(text, word, length) == 0;
}

bool model_is_named(const char *path) {
    size_t length;
    const char *extension = extension_of(path, &length);
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (is_word(extension, length, extensions[i] + 1))
            return true;
    return false;
}

bool model_is_stl(const char *path) {
    size_t length;
    const char *extension = extension_of(path, &length);
    return is_word(extension, length, "stl");
}

/* Makes meshes from the tables, and one node for files without nodes. */
static bool model_finish(struct model *model, struct error *error) {
    size_t faces = 0;
    for (size_t i = 0; i < model->meshes.count; i++)
        faces += model_meshes(model)[i].starts.count;
    if (faces == 0) {
        size_t length;
        (void)extension_of(model->path, &length);
        bool is_known = length == 0 || model_is_named(model->path);
        /* What was left out is the reason. */
        if (is_known && model->warning_count > 0)
            return error_set(error, ERROR_SCENE, "%s: no faces in this file (%s)", model->path, model->warnings[0]);
        return error_set(error, ERROR_SCENE, "%s: no faces in this file%s", model->path,
                         is_known ? "" : "; gray reads OBJ, PLY, STL and glTF files");
    }
    if (!check_numbers(model, error))
        return false;
    for (size_t i = 0; i < model->meshes.count; i++)
        if (!finish_mesh(model, &model_meshes(model)[i], error))
            return false;
    /* A file without nodes has its one mesh. */
    if (model->nodes.count == 0) {
        struct model_node *node = model_add_node(model, error);
        if (!node)
            return false;
        node->mesh = 0;
    }
    return true;
}

/* --- which kind of file --- */

enum model_kind { MODEL_OBJ, MODEL_PLY, MODEL_STL_TEXT, MODEL_STL_BINARY, MODEL_GLTF };

static bool holds(const uint8_t *data, size_t size, const char *word) {
    size_t length = strlen(word);
    for (size_t i = 0; i + length <= size; i++)
        if (strncasecmp((const char *)data + i, word, length) == 0)
            return true;
    return false;
}

static bool has_mark(const uint8_t *data, size_t size) {
    return size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0;
}

static bool begins_as_ply(const uint8_t *data, size_t size) {
    size_t at = has_mark(data, size) ? 3 : 0;
    return size - at >= 4 && memcmp(data + at, "ply", 3) == 0 && (data[at + 3] == '\n' || data[at + 3] == '\r');
}

/* A binary STL file says how long it is; no other file does by accident. */
static bool is_whole_stl(const uint8_t *data, size_t size) {
    uint64_t count = size >= 84 ? scan_u32(data + 80, false) : 0;
    return count > 0 && 84 + 50 * count == size;
}

static enum model_kind kind_of(const char *path, const uint8_t *data, size_t size) {
    size_t length, at = 0;
    const char *extension = extension_of(path, &length);
    if (size >= 4 && memcmp(data, "glTF", 4) == 0)
        return MODEL_GLTF;
    if (begins_as_ply(data, size))
        return MODEL_PLY;
    if (is_whole_stl(data, size))
        return MODEL_STL_BINARY;
    while (at < size && (data[at] <= ' ' || (at < 3 && has_mark(data, size))))
        at++;
    bool solid = size - at >= 6 && strncasecmp((const char *)data + at, "solid", 5) == 0 && data[at + 5] <= ' ';
    /* Binary STL files may begin with "solid", too, and text may lack it: what follows decides. */
    size_t head = size - at < 4096 ? size - at : 4096;
    if (is_word(extension, length, "stl")) {
        bool facets = holds(data + at, head, "facet") && (solid || holds(data + at, head, "vertex"));
        /* Without a triangle, a text is known by its lack of zeros. */
        return facets || (solid && !memchr(data + at, 0, head)) ? MODEL_STL_TEXT : MODEL_STL_BINARY;
    }
    if (solid && holds(data + at, head, "facet normal"))
        return MODEL_STL_TEXT;
    if (is_word(extension, length, "ply"))
        return MODEL_PLY;
    if (is_word(extension, length, "gltf") || is_word(extension, length, "glb") || (at < size && data[at] == '{'))
        return MODEL_GLTF;
    return MODEL_OBJ;
}

/* What a failed download leaves in place of a model. */
static const char *web_page_words(const uint8_t *data, size_t size) {
    static const char *const starts[][2] = {{"<!doctype html", "is a web page (HTML), not a model"},
                                            {"<html", "is a web page (HTML), not a model"},
                                            {"<?xml", "is an XML file; gray reads OBJ, PLY, STL and glTF files"},
                                            {"version https://git-lfs", "is a pointer of Git LFS, not the model"}};
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++)
        if (size >= strlen(starts[i][0]) && strncasecmp((const char *)data, starts[i][0], strlen(starts[i][0])) == 0)
            return starts[i][1];
    return NULL;
}

/* Two bytes a letter, in either order, with a mark or without one. */
static bool is_utf16(const uint8_t *data, size_t size) {
    if (size >= 2 && (memcmp(data, "\xff\xfe", 2) == 0 || memcmp(data, "\xfe\xff", 2) == 0))
        return true;
    if (size < 4)
        return false;
    uint8_t first = data[0] | data[1], second = data[2] | data[3];
    bool is_low = !data[1] && !data[3], is_high = !data[0] && !data[2];
    return (is_low || is_high) && first >= ' ' && first < 0x7f && second >= ' ' && second < 0x7f;
}

bool text_is_readable(const char *path, const void *data, size_t size, struct error *error) {
    return !is_utf16(data, size) ||
           error_set(error, ERROR_SCENE, "%s:1: this is UTF-16 text; gray reads plain ASCII and UTF-8", path);
}

static bool load(struct model *model, const uint8_t *data, size_t size, struct error *error) {
    const char *page = web_page_words(data, size);
    if (page)
        return error_set(error, ERROR_SCENE, "%s: %s", model->path, page);
    if (!is_whole_stl(data, size) && !text_is_readable(model->path, data, size, error))
        return false;
    enum model_kind kind = kind_of(model->path, data, size);
    if (kind != MODEL_GLTF && (model->options.animated || model->options.variant))
        model_warn(model, "%s: only glTF files have animations and variants of materials", model->path);
    switch (kind) {
    case MODEL_OBJ:
        return obj_load(model, (const char *)data, size, error);
    case MODEL_PLY:
        return ply_load(model, data, size, error);
    case MODEL_STL_TEXT:
        return stl_load(model, data, size, false, error);
    case MODEL_STL_BINARY:
        return stl_load(model, data, size, true, error);
    case MODEL_GLTF:
        return gltf_load(model, data, size, error);
    }
    UNREACHABLE("a file of no kind");
}

/* The bytes of file_map are unmapped before the meshes are made. */
static bool parse(struct model *model, const char *path, struct file_bytes file, bool is_mapped,
                  const struct model_options *options, struct error *error) {
    const uint8_t *data = file.data;
    size_t size = file.size;
    *model = (struct model){.options = *options};
    model->path = arena_copy_text(&model->arena, path, strlen(path));
    bool ok = model->path || error_no_memory(error, path);
    uint8_t *unpacked = NULL;
    if (ok && size >= 2 && data[0] == 0x1f && data[1] == 0x8b) {
        ok = gunzip(path, data, size, &unpacked, &size, error);
        data = unpacked;
    }
    ok = ok && load(model, data, size, error);
    mem_free(unpacked);
    if (is_mapped)
        file_unmap(&file);
    ok = ok && model_finish(model, error);
    model->options.search = NULL;
    model->options.animation = model->options.variant = NULL;
    if (!ok)
        model_destroy(model);
    return ok;
}

bool model_parse(struct model *model, const char *path, const uint8_t *data, size_t size,
                 const struct model_options *options, struct error *error) {
    return parse(model, path, (struct file_bytes){data, size}, false, options, error);
}

bool model_read(struct model *model, const char *path, const struct model_options *options, struct error *error) {
    struct file_bytes bytes;
    uint64_t refusals = mem_refusals();
    *model = (struct model){0};
    if (!path_policy_map(options->path_policy, path, FILE_LIMIT, &bytes, error))
        return false;
    return parse(model, path, bytes, true, options, error) || error_of_file(error, path, refusals);
}

void model_destroy(struct model *model) {
    for (size_t i = 0; i < model->meshes.count; i++) {
        struct model_mesh *m = &model_meshes(model)[i];
        tables_destroy(m);
        list_destroy(&m->slots);
        list_destroy(&m->slot_names);
        mesh_release(m->mesh);
    }
    for (size_t i = 0; i < model->materials.count; i++) {
        struct model_material *m = &model_materials(model)[i];
        const struct model_texture *map;
        for (size_t k = 0; (map = model_map(m, k)); k++)
            if (map->image)
                image_release(map->image);
    }
    list_destroy(&model->meshes);
    list_destroy(&model->materials);
    list_destroy(&model->nodes);
    list_destroy(&model->cameras);
    list_destroy(&model->lights);
    list_destroy(&model->animations);
    file_set_destroy(&model->broken);
    arena_destroy(&model->arena);
    *model = (struct model){0};
}
