/* glTF 2.0, as JSON with buffers in other files or inside it, and as GLB. Source: Khronos Group, "glTF 2.0
 * Specification" (ISO/IEC 12113:2022). jansson parses the JSON. The reader takes the nodes of the scene with their
 * transforms at rest or at a time of an animation, their meshes (triangles, strips, fans; position, normal, two texture
 * coordinates, first colour) with skins and morphs, materials, pictures, cameras and lights. A required extension that
 * the reader does not know is an error.
 *
 * Any number of primitives may use one accessor, so a small file can request very large meshes. A multiple of the
 * size of the file bounds everything that is made from it. */
#include "formats/gltf_animation_internal.h"
#include "formats/gltf_material_internal.h"
#include "formats/gltf_node_internal.h"

#ifndef HAVE_JANSSON

bool gltf_load(struct model *model, const uint8_t *data, size_t size, struct error *error) {
    (void)data, (void)size;
    return error_set(error, ERROR_SCENE, "%s: this build cannot read glTF (it was made without jansson)", model->path);
}

#else

#include "formats/gltf_internal.h"
#include "formats/json_text.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

bool gltf_fail(const struct gltf *g, const char *where, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = '?';
    return error_set(g->error, ERROR_SCENE, "%s: %s: %s", g->path, where, text);
}

void gltf_lacks(struct gltf *g, const char *where, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    struct gltf_lack *lacks = g->lacks.items;
    for (size_t i = 0; i < g->lacks.count; i++)
        if (strcmp(lacks[i].what, text) == 0) {
            lacks[i].count += strcmp(lacks[i].last, where) != 0; /* some elements are read twice */
            (void)snprintf(lacks[i].last, sizeof lacks[i].last, "%s", where);
            return;
        }
    if (g->lacks.count == MODEL_WARNINGS)
        return;
    lacks = list_room(&g->lacks, 1, sizeof *lacks);
    const char *what = lacks ? arena_copy_text(&g->model->arena, text, strlen(text)) : NULL;
    if (!what)
        return;
    lacks->what = what;
    lacks->count = 1;
    (void)snprintf(lacks->first, sizeof lacks->first, "%s", where);
    (void)snprintf(lacks->last, sizeof lacks->last, "%s", where);
    g->lacks.count++;
}

static void report_lacks(struct gltf *g) {
    const struct gltf_lack *lacks = g->lacks.items;
    for (size_t i = 0; i < g->lacks.count; i++)
        if (lacks[i].count == 1)
            model_warn(g->model, "%s: %s: %s", g->path, lacks[i].first, lacks[i].what);
        else
            model_warn(g->model, "%s: %s and %zu more: %s", g->path, lacks[i].first, lacks[i].count - 1, lacks[i].what);
    list_destroy(&g->lacks);
}

bool gltf_choice_fails(const struct gltf *g, const char *kind, const json_t *list, const char *wanted) {
    char names[300] = "";
    size_t length = 0;
    for (size_t i = 0; i < json_array_size(list) && length < sizeof names; i++) {
        const char *name = json_string_value(json_object_get(json_array_get(list, i), "name"));
        length += (size_t)snprintf(names + length, sizeof names - length, "%s'%s'", i ? ", " : "", name ? name : "");
    }
    if (length >= sizeof names)
        memcpy(names + sizeof names - 4, "...", 4);
    return gltf_fail(g, kind, "the file has no '%.100s'%s%s", wanted, length ? "; it has " : "", names);
}

const char *gltf_name(const struct gltf *g, const json_t *object) {
    const char *name = json_string_value(json_object_get(object, "name"));
    if (!name)
        return "";
    name = arena_copy_text(&g->model->arena, name, strlen(name));
    if (!name)
        error_no_memory(g->error, g->path);
    return name;
}

json_t *gltf_array(const struct gltf *g, const char *name) {
    json_t *array = json_object_get(g->root, name);
    return json_is_array(array) ? array : NULL;
}

bool gltf_whole(const struct gltf *g, const json_t *object, const char *key, uint64_t otherwise, uint64_t *out,
                const char *where) {
    const json_t *value = json_object_get(object, key);
    *out = otherwise;
    if (!value)
        return true;
    double x = json_number_value(value);
    if (!json_is_number(value) || !(x >= 0 && x <= 0x1p53 && x == floor(x)))
        return gltf_fail(g, where, "%s is not a whole number >= 0", key);
    *out = (uint64_t)x;
    return true;
}

bool gltf_index(const struct gltf *g, const json_t *object, const char *key, const char *of, uint32_t *out,
                const char *where) {
    uint64_t index, count = json_array_size(gltf_array(g, of));
    if (!gltf_whole(g, object, key, UINT64_MAX, &index, where))
        return false;
    *out = MODEL_NONE;
    if (index == UINT64_MAX)
        return true;
    if (index >= count)
        return gltf_fail(g, where, "%s is %llu, but there are only %llu %s", key, (unsigned long long)index,
                         (unsigned long long)count, of);
    *out = (uint32_t)index;
    return true;
}

bool gltf_numbers(const struct gltf *g, const json_t *object, const char *key, double *out, int count,
                  const char *where) {
    const json_t *array = json_object_get(object, key);
    if (!array)
        return true;
    if (!json_is_array(array) || json_array_size(array) != (size_t)count)
        return gltf_fail(g, where, "%s is not an array of %d numbers", key, count);
    for (int i = 0; i < count; i++) {
        const json_t *value = json_array_get(array, (size_t)i);
        assert(isfinite(json_number_value(value))); /* JSON has only finite numbers; 0 if it is not a number */
        if (!json_is_number(value))
            return gltf_fail(g, where, "%s[%d] is not a finite number", key, i);
        out[i] = json_number_value(value);
    }
    return true;
}

/* --- the file --- */

/* Extensions that gray reads; then those whose loss only changes how a surface looks, so that a file may require them.
 */
static const char *const read_extensions[] = {
    "KHR_materials_ior",           "KHR_materials_transmission", "KHR_materials_specular",
    "KHR_materials_volume",        "KHR_materials_unlit",        "KHR_materials_emissive_strength",
    "KHR_materials_clearcoat",     "KHR_materials_sheen",        "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_iridescence",   "KHR_materials_dispersion",   "KHR_materials_variants",
    "KHR_texture_transform",       "KHR_mesh_quantization",      "KHR_lights_punctual",
    "EXT_mesh_gpu_instancing",     "EXT_texture_webp",           "KHR_materials_diffuse_transmission",
    "KHR_materials_volume_scatter"};
static const char *const without_effect[] = {"KHR_materials_anisotropy"};

static bool is_one_of(const char *name, const char *const *list, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (strcmp(name, list[i]) == 0)
            return true;
    return false;
}

/* A required extension must be known; the others that are not read have one warning each. */
static bool check_extensions(struct gltf *g) {
    const size_t read = sizeof read_extensions / sizeof *read_extensions;
    const size_t known = sizeof without_effect / sizeof *without_effect;
    const json_t *required = gltf_array(g, "extensionsRequired"), *used = gltf_array(g, "extensionsUsed");
    for (size_t i = 0; i < json_array_size(required); i++) {
        const char *name = json_string_value(json_array_get(required, i));
        if (!name || (!is_one_of(name, read_extensions, read) && !is_one_of(name, without_effect, known)))
            return gltf_fail(g, "extensionsRequired", "the file needs '%.100s', which is not supported%s",
                             name ? name : "something without a name",
                             name && strstr(name, "compression") ? "; export it without compression" : "");
    }
    for (size_t i = 0; i < json_array_size(used); i++) {
        const char *name = json_string_value(json_array_get(used, i));
        if (name && !is_one_of(name, read_extensions, read))
            model_warn(g->model, "%s: %.100s is not read", g->path, name);
    }
    return true;
}

/* KHR_materials_variants: the number of the one that the options name. */
static bool choose_variant(struct gltf *g) {
    const char *wanted = g->model->options.variant;
    const json_t *extension = json_object_get(json_object_get(g->root, "extensions"), "KHR_materials_variants");
    const json_t *variants = json_object_get(extension, "variants");
    g->variant = MODEL_NONE;
    for (size_t i = 0; wanted && i < json_array_size(variants); i++) {
        const char *name = json_string_value(json_object_get(json_array_get(variants, i), "name"));
        if (name && strcmp(name, wanted) == 0)
            g->variant = (uint32_t)i;
    }
    return !wanted || g->variant != MODEL_NONE || gltf_choice_fails(g, "variant", variants, wanted);
}

static bool load(struct gltf *g) {
    const char *version = json_string_value(json_object_get(json_object_get(g->root, "asset"), "version"));
    if (!version || version[0] != '2')
        return gltf_fail(g, "asset", "glTF of version 2 is read, this file is of version '%.20s'",
                         version ? version : "none");
    if (!check_extensions(g) || !choose_variant(g))
        return false;
    g->buffer_count = json_array_size(gltf_array(g, "buffers"));
    g->buffers = mem_alloc_zero(g->buffer_count ? g->buffer_count : 1, sizeof *g->buffers);
    if (!g->buffers)
        return error_no_memory(g->error, g->path);
    if (!gltf_read_materials(g))
        return false;
    if (!gltf_list_animations(g) || !gltf_read_nodes(g))
        return false;
    /* Without a face, the reason why the first one is missing is the error. */
    const struct gltf_lack *lack = g->lacks.count ? g->lacks.items : NULL;
    for (size_t i = 0; lack && i < g->model->meshes.count; i++)
        if (model_meshes(g->model)[i].starts.count)
            lack = NULL;
    return !lack || gltf_fail(g, lack->first, "%s", lack->what);
}

/* The two chunks of a GLB (section 4.4); a file with another start is JSON as a whole. */
static bool split(struct gltf *g, const uint8_t *data, size_t size, const char **text, size_t *length) {
    *text = (const char *)data;
    *length = size;
    if (size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0)
        *text += 3, *length -= 3;
    if (size < 4 || memcmp(data, "glTF", 4) != 0)
        return true;
    if (size < 20)
        return gltf_fail(g, "byte 0", "a GLB has at least 20 bytes, this has %zu", size);
    uint32_t version = scan_u32(data + 4, false), whole = scan_u32(data + 8, false);
    if (version != 2)
        return gltf_fail(g, "byte 4", "GLB of version 2 is read, this is of version %u", version);
    if (whole > size)
        return gltf_fail(g, "byte 8", "the file promises %u bytes, but has only %zu", whole, size);
    /* The chunks: JSON, then at most one of bytes; others are skipped. */
    size_t at = 12;
    for (int chunk = 0; at + 8 <= whole; chunk++) {
        size_t bytes = scan_u32(data + at, false);
        uint32_t kind = scan_u32(data + at + 4, false);
        if (bytes > whole - at - 8) {
            char where[40];
            (void)snprintf(where, sizeof where, "byte %zu", at);
            return gltf_fail(g, where, "a chunk of %zu bytes, but only %zu follow", bytes, whole - at - 8);
        }
        if (chunk == 0 && kind != 0x4e4f534a)
            return gltf_fail(g, "byte 12", "the first chunk is not JSON");
        if (chunk == 0) {
            *text = (const char *)data + at + 8;
            *length = bytes;
        } else if (kind == 0x004e4942 && !g->binary) {
            g->binary = data + at + 8;
            g->binary_size = bytes;
        }
        at += 8 + bytes;
    }
    return true;
}

bool gltf_load(struct model *model, const uint8_t *data, size_t size, struct error *error) {
    struct gltf g = {.model = model, .path = model->path, .error = error, .bytes = size};
    const char *text;
    size_t length;
    struct arena json = {0};
    bool ok = split(&g, data, size, &text, &length) &&
              (g.root = json_text_parse(g.path, text, length, false, &json, error)) && load(&g);
    for (size_t i = 0; g.buffers && i < g.buffer_count; i++) {
        mem_free(g.buffers[i].decoded);
        file_unmap(&g.buffers[i].file);
    }
    for (size_t i = 0; g.images && i < g.image_count; i++)
        image_release(g.images[i]);
    mem_free(g.buffers);
    mem_free(g.images);
    mem_free(g.plain);
    arena_destroy(&json);
    report_lacks(&g);
    return ok;
}

#endif
