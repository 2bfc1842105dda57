/* Buffers, views and accessors of glTF: the positions and the meaning of numbers. Source: Khronos Group, "glTF 2.0
 * Specification" (ISO/IEC 12113:2022), sections 3.6 and 4.4. Every range is checked against the available bytes
 * once, when an accessor is made; reading then checks only the numbers. */
#ifdef HAVE_JANSSON

#include "formats/gltf_data_internal.h"

#include <math.h>
#include <stdio.h>

/* The size of all files together that one model may read. */
#define FETCH_LIMIT (UINT64_C(1) << 33)

/* Vertices and corners per byte of the file, and a minimum for every file. */
enum { MADE_PER_BYTE = 8, MADE_FREE = 1 << 20 };

bool gltf_produce(struct gltf *g, uint64_t count, const char *where) {
    uint64_t limit = g->bytes * MADE_PER_BYTE + MADE_FREE;
    if (count > limit || g->produced > limit - count)
        return gltf_fail(g, where, "more vertices than a file of %llu bytes can describe",
                         (unsigned long long)g->bytes);
    g->produced += count;
    return true;
}

static int digit64(char c) {
    return c >= 'A' && c <= 'Z'   ? c - 'A'
           : c >= 'a' && c <= 'z' ? c - 'a' + 26
           : c >= '0' && c <= '9' ? c - '0' + 52
           : c == '+' || c == '-' ? 62
           : c == '/' || c == '_' ? 63
                                  : -1;
}

/* data:TYPE;base64,... (RFC 2397, RFC 4648). */
bool gltf_decode_data(const struct gltf *g, const char *uri, uint8_t **out, size_t *size, const char *where) {
    const char *comma = strchr(uri, ',');
    if (!comma || comma - uri < 7 || strncmp(comma - 7, ";base64", 7) != 0)
        return gltf_fail(g, where, "a data URI that is not base64");
    const char *text = comma + 1;
    size_t length = strlen(text);
    /* Padding adds nothing. */
    while (length > 0 && text[length - 1] == '=')
        length--;
    uint8_t *bytes = mem_alloc(length / 4 * 3 + 4);
    if (!bytes)
        return error_no_memory(g->error, g->path);
    uint32_t bits = 0;
    size_t made = 0;
    for (size_t i = 0; i < length; i++) {
        int digit = digit64(text[i]);
        if (digit < 0) {
            mem_free(bytes);
            return gltf_fail(g, where, "a character that is not base64");
        }
        bits = bits << 6 | (uint32_t)digit;
        if (i % 4 == 3) {
            bytes[made++] = (uint8_t)(bits >> 16);
            bytes[made++] = (uint8_t)(bits >> 8);
            bytes[made++] = (uint8_t)bits;
        }
    }
    /* What is left over: two digits are one byte, three are two. */
    if (length % 4 >= 2)
        bytes[made++] = (uint8_t)(length % 4 == 2 ? bits >> 4 : bits >> 10);
    if (length % 4 == 3)
        bytes[made++] = (uint8_t)(bits >> 2);
    *out = bytes;
    *size = made;
    return true;
}

static int hex(char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

char *gltf_decode_uri(const struct gltf *g, const char *uri) {
    char *out = arena_copy_text(&g->model->arena, uri, strlen(uri)), *to = out;
    for (const char *from = uri; out && *from; from++) {
        int high = *from == '%' ? hex(from[1]) : -1, low = high >= 0 ? hex(from[2]) : -1;
        bool coded = low >= 0 && high + low > 0;
        *to++ = coded ? (char)(high * 16 + low) : *from;
        from += coded ? 2 : 0;
    }
    if (out)
        *to = '\0';
    return out;
}

static bool fetch(struct gltf *g, uint32_t index) {
    struct gltf_buffer *buffer = &g->buffers[index];
    if (buffer->fetched)
        return true;
    char where[64];
    (void)snprintf(where, sizeof where, "buffers[%u]", index);
    const json_t *object = json_array_get(gltf_array(g, "buffers"), index);
    const char *uri = json_string_value(json_object_get(object, "uri"));
    uint64_t length;
    if (!gltf_whole(g, object, "byteLength", UINT64_MAX, &length, where))
        return false;
    /* In the binary chunk, in the text, or in a file beside it. */
    if (!uri) {
        if (index != 0 || !g->binary)
            return gltf_fail(g, where, "it has no uri, and the file no binary chunk for it");
        buffer->data = g->binary;
        buffer->size = g->binary_size;
    } else if (strncmp(uri, "data:", 5) == 0) {
        if (!gltf_decode_data(g, uri, &buffer->decoded, &buffer->size, where))
            return false;
        buffer->data = buffer->decoded;
    } else {
        const char *name = gltf_decode_uri(g, uri), *path;
        if (!name)
            return error_no_memory(g->error, g->path);
        if (!model_find(g->model, name, strlen(name), &path, g->error))
            return false;
        if (!path)
            return gltf_fail(g, where, "the file '%.200s' %s", name, model_why_missing(g->model));
        if (!path_policy_map(g->model->options.path_policy, path, FETCH_LIMIT - g->bytes, &buffer->file, g->error))
            return false;
        buffer->data = buffer->file.data;
        buffer->size = buffer->file.size;
        g->bytes += buffer->size;
    }
    if (length != UINT64_MAX && length > buffer->size)
        return gltf_fail(g, where, "it promises %llu bytes, but there are only %zu", (unsigned long long)length,
                         buffer->size);
    buffer->fetched = true;
    return true;
}

bool gltf_view(struct gltf *g, uint32_t index, const uint8_t **data, size_t *size, size_t *stride) {
    char where[64];
    (void)snprintf(where, sizeof where, "bufferViews[%u]", index);
    const json_t *view = json_array_get(gltf_array(g, "bufferViews"), index);
    uint32_t buffer;
    uint64_t offset, length, step;
    if (!gltf_index(g, view, "buffer", "buffers", &buffer, where) ||
        !gltf_whole(g, view, "byteOffset", 0, &offset, where) ||
        !gltf_whole(g, view, "byteLength", 0, &length, where) || !gltf_whole(g, view, "byteStride", 0, &step, where))
        return false;
    if (buffer == MODEL_NONE)
        return gltf_fail(g, where, "it has no buffer");
    if (!fetch(g, buffer))
        return false;
    /* No sum of two numbers of the file, which could overflow. */
    size_t have = g->buffers[buffer].size;
    if (offset > have || length > have - offset)
        return gltf_fail(g, where, "bytes %llu to %llu of a buffer that has %zu", (unsigned long long)offset,
                         (unsigned long long)(offset + length), have);
    if (step > 252)
        return gltf_fail(g, where, "a stride of %llu bytes", (unsigned long long)step);
    *data = g->buffers[buffer].data + offset;
    *size = (size_t)length;
    *stride = (size_t)step;
    return true;
}

static bool type_of(const struct gltf *g, const json_t *object, enum number_type *out, const char *where) {
    static const enum number_type types[] = {NUMBER_I8,    NUMBER_U8,  NUMBER_I16, NUMBER_U16,
                                             NUMBER_TYPES, NUMBER_U32, NUMBER_F32};
    uint64_t code;
    if (!gltf_whole(g, object, "componentType", 0, &code, where))
        return false;
    if (code < 5120 || code > 5126 || code == 5124)
        return gltf_fail(g, where, "the componentType %llu is unknown", (unsigned long long)code);
    *out = types[code - 5120];
    return true;
}

/* `count` elements of `element` bytes from an offset on must be inside the view; *data is set to the first one. */
/* The elements that a view contains, and their positions in it. */
struct view_part {
    uint64_t count;
    size_t element; /* bytes of each */
    bool may_stride;
    const uint8_t *data; /* NULL: there is no view */
    size_t stride;
};

static bool find_part(struct gltf *g, const json_t *object, struct view_part *part, const char *where) {
    uint32_t view;
    uint64_t offset;
    size_t size, step;
    if (!gltf_index(g, object, "bufferView", "bufferViews", &view, where) ||
        !gltf_whole(g, object, "byteOffset", 0, &offset, where))
        return false;
    part->data = NULL;
    part->stride = part->element;
    if (view == MODEL_NONE)
        return true;
    if (!gltf_view(g, view, &part->data, &size, &step))
        return false;
    if (part->may_stride && step > 0)
        part->stride = step;
    if (part->stride < part->element)
        return gltf_fail(g, where, "its stride is smaller than its elements");
    /* The last element must lie inside, not only the first. */
    bool fits = part->count == 0 || (offset <= size && size - offset >= part->element &&
                                     part->count - 1 <= (size - (size_t)offset - part->element) / part->stride);
    if (!fits)
        return gltf_fail(g, where, "%llu elements of %zu bytes do not fit into its %zu bytes",
                         (unsigned long long)part->count, part->element, size);
    part->data += offset;
    return true;
}

static bool sparse_part(struct gltf *g, const json_t *sparse, struct gltf_accessor *out, const char *where) {
    const json_t *indices = json_object_get(sparse, "indices"), *values = json_object_get(sparse, "values");
    if (!gltf_whole(g, sparse, "count", 0, &out->sparse_count, where) || !type_of(g, indices, &out->sparse_type, where))
        return false;
    if (out->sparse_type != NUMBER_U8 && out->sparse_type != NUMBER_U16 && out->sparse_type != NUMBER_U32)
        return gltf_fail(g, where, "its sparse indices are not unsigned");
    struct view_part index_part = {.count = out->sparse_count, .element = number_size(out->sparse_type)};
    struct view_part value_part = {.count = out->sparse_count,
                                   .element = number_size(out->type) * (size_t)out->components};
    if (!find_part(g, indices, &index_part, where) || !find_part(g, values, &value_part, where))
        return false;
    out->sparse_indices = index_part.data;
    out->sparse_values = value_part.data;
    if (out->sparse_count && (!out->sparse_indices || !out->sparse_values))
        return gltf_fail(g, where, "its sparse part has no data");
    return true;
}

/* The element of a root array that another one names, or NULL. */
static const json_t *named_by(const struct gltf *g, const json_t *object, const char *key, const char *of) {
    const json_t *index = json_object_get(object, key);
    bool fine = json_is_integer(index) && json_integer_value(index) >= 0;
    return fine ? json_array_get(gltf_array(g, of), (size_t)json_integer_value(index)) : NULL;
}

bool gltf_has_bytes(const struct gltf *g, uint32_t index) {
    const json_t *accessor = json_array_get(gltf_array(g, "accessors"), index);
    if (!json_object_get(accessor, "bufferView"))
        return json_object_get(accessor, "sparse") != NULL;
    const json_t *view = named_by(g, accessor, "bufferView", "bufferViews");
    const json_t *buffer = named_by(g, view, "buffer", "buffers");
    bool is_packed = json_object_get(json_object_get(view, "extensions"), "EXT_meshopt_compression") ||
                     json_object_get(json_object_get(view, "extensions"), "KHR_meshopt_compression");
    return !is_packed || json_object_get(buffer, "uri") ||
           (g->binary && buffer == json_array_get(gltf_array(g, "buffers"), 0));
}

bool gltf_accessor(struct gltf *g, uint32_t index, struct gltf_accessor *out) {
    static const struct {
        const char *name;
        int components;
    } types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
    char where[64];
    (void)snprintf(where, sizeof where, "accessors[%u]", index);
    const json_t *object = json_array_get(gltf_array(g, "accessors"), index);
    const char *type = json_string_value(json_object_get(object, "type"));
    *out = (struct gltf_accessor){.normalized = json_is_true(json_object_get(object, "normalized"))};
    for (size_t i = 0; type && i < sizeof types / sizeof types[0]; i++)
        if (strcmp(type, types[i].name) == 0)
            out->components = types[i].components;
    if (out->components == 0)
        return gltf_fail(g, where, "its type is missing or unknown");
    if (!type_of(g, object, &out->type, where) || !gltf_whole(g, object, "count", 0, &out->count, where))
        return false;
    struct view_part part = {
        .count = out->count, .element = number_size(out->type) * (size_t)out->components, .may_stride = true};
    if (!find_part(g, object, &part, where))
        return false;
    out->data = part.data;
    out->stride = part.stride;
    /* An accessor may consist of sparse elements alone; the others are 0 then. */
    const json_t *sparse = json_object_get(object, "sparse");
    return !sparse || sparse_part(g, sparse, out, where);
}

/* Section 3.6.2.2: integers that represent 0..1 or -1..1; other numbers are not converted. */
static double value_of(const uint8_t *p, enum number_type type, bool normalized) {
    static const double one[NUMBER_TYPES] = {
        [NUMBER_I8] = 127, [NUMBER_U8] = 255, [NUMBER_I16] = 32767, [NUMBER_U16] = 65535};
    double x = scan_number(p, type, false);
    return normalized && one[type] > 0 ? math_max(x / one[type], -1) : x;
}

bool gltf_accessor_read(struct gltf *g, uint32_t index, const struct gltf_accessor *a, uint64_t first, uint64_t count,
                        double *out) {
    char where[64];
    (void)snprintf(where, sizeof where, "accessors[%u]", index);
    unsigned size = number_size(a->type);
    size_t width = (size_t)a->components;
    for (uint64_t i = 0; i < count; i++)
        for (size_t k = 0; k < width; k++)
            out[i * width + k] =
                a->data ? value_of(a->data + (first + i) * a->stride + k * size, a->type, a->normalized) : 0;
    /* Sparse elements replace some of the others. */
    for (uint64_t s = 0; s < a->sparse_count; s++) {
        double at = scan_number(a->sparse_indices + s * number_size(a->sparse_type), a->sparse_type, false);
        if (!(at < (double)a->count))
            return gltf_fail(g, where, "the sparse index %.0f, but there are only %llu elements", at,
                             (unsigned long long)a->count);
        if (at < (double)first || at >= (double)(first + count))
            continue;
        for (size_t k = 0; k < width; k++)
            out[((uint64_t)at - first) * width + k] =
                value_of(a->sparse_values + (s * width + k) * size, a->type, a->normalized);
    }
    for (uint64_t i = 0; i < count * width; i++)
        if (!isfinite(out[i]))
            return gltf_fail(g, where, "element %llu is not a finite number", (unsigned long long)(first + i / width));
    return true;
}

bool gltf_accessor_read_whole(struct gltf *g, uint32_t index, const struct gltf_accessor *a, uint32_t *out) {
    char where[64];
    (void)snprintf(where, sizeof where, "accessors[%u]", index);
    if (a->components != 1 || (a->type != NUMBER_U8 && a->type != NUMBER_U16 && a->type != NUMBER_U32) || !a->data ||
        a->sparse_count)
        return gltf_fail(g, where, "it cannot be the indices of vertices");
    for (uint64_t i = 0; i < a->count; i++) {
        const uint8_t *p = a->data + i * a->stride;
        out[i] = a->type == NUMBER_U32 ? scan_u32(p, false) : a->type == NUMBER_U16 ? scan_u16(p, false) : *p;
    }
    return true;
}

#else
/* This file is empty without jansson. */
typedef int gltf_data_is_empty;
#endif
