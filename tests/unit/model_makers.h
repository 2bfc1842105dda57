/* Bytes of mesh files made in the tests, and the comparison of what the readers return. Everything from malloc. */
#ifndef GRAY_TESTS_MODEL_MAKERS_H
#define GRAY_TESTS_MODEL_MAKERS_H

#include "base/mem.h"
#include "formats/model.h"
#include "tests/unit/mesh_makers.h"

#include <stdarg.h>

struct bytes {
    uint8_t *data;
    size_t size, capacity;
};

static inline void bytes_add(struct bytes *b, const void *data, size_t size) {
    if (b->size + size > b->capacity) {
        b->capacity = 2 * (b->size + size) + 256;
        b->data = realloc(b->data, b->capacity);
    }
    if (size)
        memcpy(b->data + b->size, data, size);
    b->size += size;
}

__attribute__((format(printf, 2, 3))) static inline void bytes_print(struct bytes *b, const char *format, ...) {
    char line[1024];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    bytes_add(b, line, (size_t)length);
}

/* A number of `size` bytes from its bits, in either order. */
static inline void bytes_number(struct bytes *b, uint64_t bits, int size, bool big) {
    for (int i = 0; i < size; i++) {
        uint8_t byte = (uint8_t)(bits >> 8 * (big ? size - 1 - i : i));
        bytes_add(b, &byte, 1);
    }
}

static inline void bytes_float(struct bytes *b, double x, bool big) {
    float f = (float)x;
    uint32_t bits;
    memcpy(&bits, &f, 4);
    bytes_number(b, bits, 4, big);
}

static inline void bytes_double(struct bytes *b, double x, bool big) {
    uint64_t bits;
    memcpy(&bits, &x, 8);
    bytes_number(b, bits, 8, big);
}

static inline void bytes_free(struct bytes *b) {
    free(b->data);
    *b = (struct bytes){0};
}

/* An OBJ square with texture coordinates, without its face. */
#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"

/* The path of a file in the test's folder; the last four results stay valid. */
static inline const char *in_folder(const char *name) {
    static char path[4][400];
    static int turn;
    char *out = path[turn++ % 4];
    (void)snprintf(out, sizeof path[0], "%s/%s", test_folder(), name);
    return out;
}

/* Parses a copy of exactly this size, so that the sanitizer detects every read outside it. True if there is a model. */
static inline bool parse_model(struct model *model, const char *path, const void *data, size_t size,
                               const struct model_options *options, struct error *error) {
    static const struct model_options none = {0};
    uint8_t *copy = malloc(size ? size : 1);
    if (size)
        memcpy(copy, data, size);
    *error = (struct error){0};
    bool ok = model_parse(model, path, copy, size, options ? options : &none, error);
    free(copy);
    return ok;
}

static inline struct mesh *only_mesh(const struct model *model) {
    return model_meshes(model)[0].mesh;
}

/* The message of a file that must not be read. */
static inline void check_refused(const char *path, const void *data, size_t size, const char *message) {
    struct model model;
    struct error error;
    if (parse_model(&model, path, data, size, NULL, &error)) {
        test_fail(__FILE__, __LINE__, "read, but should say: %s", message ? message : "an error");
        model_destroy(&model);
        return;
    }
    if (message && strcmp(error.text, message) != 0)
        test_fail(__FILE__, __LINE__, "says \"%s\", not \"%s\"", error.text, message);
    if (strncmp(error.text, path, strlen(path)) != 0 || strchr(error.text, '\n'))
        test_fail(__FILE__, __LINE__, "not one line that names the file: %s", error.text);
}

static inline void check_text_refused(const char *path, const char *text, const char *message) {
    check_refused(path, text, strlen(text), message);
}

/* Every prefix of the file is a mesh or one line that names it. */
static inline void check_cut_anywhere(const char *path, const struct bytes *b, size_t step) {
    for (size_t size = 0; size < b->size; size += step) {
        struct model model;
        struct error error;
        if (parse_model(&model, path, b->data, size, NULL, &error))
            model_destroy(&model);
        else if (error.kind != ERROR_SCENE || strncmp(error.text, path, strlen(path)) != 0 || strchr(error.text, '\n'))
            test_fail(__FILE__, __LINE__, "cut at %zu: %s", size, error.text);
    }
}

/* Any byte changed: a mesh or one line. */
static inline void check_changed_anywhere(const char *path, const struct bytes *b, int rounds) {
    struct test_random random = {99};
    uint8_t *copy = malloc(b->size);
    for (int i = 0; i < rounds; i++) {
        struct model model;
        struct error error;
        memcpy(copy, b->data, b->size);
        for (int k = 0; k < 1 + i % 3; k++)
            copy[(size_t)test_uniform(&random, 0, (double)b->size)] = (uint8_t)test_uniform(&random, 0, 256);
        if (parse_model(&model, path, copy, b->size, NULL, &error))
            model_destroy(&model);
        else if (strncmp(error.text, path, strlen(path)) != 0 || strchr(error.text, '\n'))
            test_fail(__FILE__, __LINE__, "round %d: %s", i, error.text);
    }
    free(copy);
}

static inline void check_failed_allocations(const char *path, const struct bytes *b) {
    struct model model;
    struct error error;
    uint64_t before = mem_allocations();
    if (parse_model(&model, path, b->data, b->size, NULL, &error))
        model_destroy(&model);
    uint64_t count = mem_allocations() - before;
    for (uint64_t k = 1; k <= count; k++) {
        mem_fail_at(k);
        bool ok = parse_model(&model, path, b->data, b->size, NULL, &error);
        mem_fail_at(0);
        if (ok)
            model_destroy(&model);
        else if (error.kind != ERROR_MACHINE)
            test_fail(__FILE__, __LINE__, "allocation %llu: %s", (unsigned long long)k, error.text);
    }
}

/* The same faces with the same corners at the same places, in the same order. */
static inline bool same_faces(const struct mesh *a, const struct mesh *b) {
    uint32_t ignored, p_count, q_count;
    const double(*v)[3] = mesh_vertices(a, &ignored), (*w)[3] = mesh_vertices(b, &ignored);
    if (mesh_face_count(a) != mesh_face_count(b))
        return false;
    for (uint32_t f = 0; f < mesh_face_count(a); f++) {
        const uint32_t *p = mesh_face(a, f, &p_count), *q = mesh_face(b, f, &q_count);
        if (p_count != q_count)
            return false;
        for (uint32_t k = 0; k < p_count; k++)
            for (int c = 0; c < 3; c++)
                if (v[p[k]][c] != w[q[k]][c])
                    return false;
    }
    return true;
}

/* Coordinates that are exact in float. */
static inline void maker_round(struct maker *m) {
    for (uint32_t i = 0; i < m->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            m->vertices[i][k] = (double)(float)m->vertices[i][k];
}

/* --- the formats --- */

static inline void write_obj(struct bytes *b, const struct maker *m) {
    for (uint32_t i = 0; i < m->vertex_count; i++)
        bytes_print(b, "v %.17g %.17g %.17g\n", m->vertices[i][0], m->vertices[i][1], m->vertices[i][2]);
    for (uint32_t f = 0; f < m->face_count; f++) {
        bytes_print(b, "f");
        for (uint32_t c = m->starts[f]; c < m->starts[f + 1]; c++)
            bytes_print(b, " %u", m->corners[c] + 1);
        bytes_print(b, "\n");
    }
}

enum ply_kind { PLY_ASCII, PLY_LITTLE, PLY_BIG };

static inline void write_ply(struct bytes *b, const struct maker *m, enum ply_kind kind) {
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    bool big = kind == PLY_BIG;
    bytes_print(b, "ply\nformat %s 1.0\ncomment made by a test\nelement vertex %u\n", names[kind], m->vertex_count);
    bytes_print(b, "property float x\nproperty float y\nproperty float z\nelement face %u\n", m->face_count);
    bytes_print(b, "property list uchar int vertex_indices\nend_header\n");
    for (uint32_t i = 0; i < m->vertex_count; i++) {
        if (kind == PLY_ASCII)
            bytes_print(b, "%.17g %.17g %.17g\n", m->vertices[i][0], m->vertices[i][1], m->vertices[i][2]);
        for (int k = 0; kind != PLY_ASCII && k < 3; k++)
            bytes_float(b, m->vertices[i][k], big);
    }
    for (uint32_t f = 0; f < m->face_count; f++) {
        uint32_t count = m->starts[f + 1] - m->starts[f];
        if (kind == PLY_ASCII)
            bytes_print(b, "%u", count);
        else
            bytes_number(b, count, 1, big);
        for (uint32_t c = m->starts[f]; c < m->starts[f + 1]; c++) {
            if (kind == PLY_ASCII)
                bytes_print(b, " %u", m->corners[c]);
            else
                bytes_number(b, m->corners[c], 4, big);
        }
        if (kind == PLY_ASCII)
            bytes_print(b, "\n");
    }
}

/* Triangles only. */
static inline void write_stl(struct bytes *b, const struct maker *m, bool binary, const char *name) {
    char header[80] = {0};
    (void)snprintf(header, sizeof header, "%s", name);
    if (binary) {
        bytes_add(b, header, 80);
        bytes_number(b, m->face_count, 4, false);
    } else {
        bytes_print(b, "%s\n", name);
    }
    for (uint32_t f = 0; f < m->face_count; f++) {
        if (!binary)
            bytes_print(b, "  facet normal 0 0 0\n    outer loop\n");
        for (int k = 0; binary && k < 3; k++)
            bytes_float(b, 0, false);
        for (uint32_t c = m->starts[f]; c < m->starts[f] + 3; c++) {
            const double *v = m->vertices[m->corners[c]];
            for (int k = 0; binary && k < 3; k++)
                bytes_float(b, v[k], false);
            if (!binary)
                bytes_print(b, "      vertex %.17g %.17g %.17g\n", v[0], v[1], v[2]);
        }
        if (binary)
            bytes_number(b, 0, 2, false);
        else
            bytes_print(b, "    endloop\n  endfacet\n");
    }
    if (!binary)
        bytes_print(b, "end%s\n", name);
}

static inline void write_base64(struct bytes *b, const struct bytes *from) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < from->size; i += 3) {
        size_t have = from->size - i;
        uint32_t bits = (uint32_t)from->data[i] << 16 | (have > 1 ? (uint32_t)from->data[i + 1] << 8 : 0) |
                        (have > 2 ? from->data[i + 2] : 0);
        char out[4] = {digits[bits >> 18], digits[bits >> 12 & 63], have > 1 ? digits[bits >> 6 & 63] : '=',
                       have > 2 ? digits[bits & 63] : '='};
        bytes_add(b, out, 4);
    }
}

/* The buffer of a triangle mesh: positions, then 4-byte indices. */
static inline void gltf_buffer_of(struct bytes *b, const struct maker *m) {
    for (uint32_t i = 0; i < m->vertex_count; i++)
        for (int k = 0; k < 3; k++)
            bytes_float(b, m->vertices[i][k], false);
    for (uint32_t c = 0; c < m->corner_count; c++)
        bytes_number(b, m->corners[c], 4, false);
}

static inline void gltf_head(struct bytes *b, const struct maker *m) {
    uint32_t positions = m->vertex_count * 12, indices = m->corner_count * 4;
    bytes_print(b,
                "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
                "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
                "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\"},"
                "{\"bufferView\":1,\"componentType\":5125,\"count\":%u,\"type\":\"SCALAR\"}],"
                "\"bufferViews\":[{\"buffer\":0,\"byteLength\":%u},{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":%u}],"
                "\"buffers\":[{\"byteLength\":%u",
                m->vertex_count, m->corner_count, positions, positions, indices, positions + indices);
}

static inline void write_gltf(struct bytes *b, const struct maker *m) {
    struct bytes buffer = {0};
    gltf_buffer_of(&buffer, m);
    gltf_head(b, m);
    bytes_print(b, ",\"uri\":\"data:application/octet-stream;base64,");
    write_base64(b, &buffer);
    bytes_print(b, "\"}]}");
    bytes_free(&buffer);
}

/* JSON and buffer as the two chunks. */
static inline void write_glb_of(struct bytes *b, const struct bytes *json, const struct bytes *buffer) {
    size_t text = (json->size + 3) / 4 * 4, binary = (buffer->size + 3) / 4 * 4;
    bytes_print(b, "glTF");
    bytes_number(b, 2, 4, false);
    bytes_number(b, 12 + 8 + text + 8 + binary, 4, false);
    bytes_number(b, text, 4, false);
    bytes_print(b, "JSON");
    bytes_add(b, json->data, json->size);
    bytes_add(b, "   ", text - json->size);
    bytes_number(b, binary, 4, false);
    bytes_add(b, "BIN", 4);
    bytes_add(b, buffer->data, buffer->size);
    bytes_add(b, "\0\0\0", binary - buffer->size);
}

static inline void write_glb(struct bytes *b, const struct maker *m) {
    struct bytes buffer = {0}, json = {0};
    gltf_buffer_of(&buffer, m);
    gltf_head(&json, m);
    bytes_print(&json, "}]}");
    write_glb_of(b, &json, &buffer);
    bytes_free(&buffer);
    bytes_free(&json);
}

#endif
