/* glTF 2.0 (Khronos Group, ISO/IEC 12113:2022), sections 3.6 and 4.4. Equal elements are written once: so instances
 * share their meshes, and materials that look alike are one. */
#define _GNU_SOURCE /* memmem */
#include "export/gltf_file_internal.h"

#include "base/bytes.h"
#include "base/hash.h"
#include "base/json_write.h"
#include "base/list.h"
#include "formats/model_format.h"

#include <stdarg.h>
#include <stdio.h>

static const char *const list_names[] = {GLTF_LISTS(LIST_WORD)};
static const char *const extensions[] = {
    "KHR_materials_ior",         "KHR_materials_specular",   "KHR_materials_transmission",
    "KHR_materials_volume",      "KHR_materials_clearcoat",  "KHR_materials_sheen",
    "KHR_materials_iridescence", "KHR_materials_dispersion", "KHR_materials_emissive_strength",
    "KHR_materials_unlit",       "KHR_texture_transform",    "KHR_lights_punctual",
};

/* --- JSON --- */

static void put(struct gltf_text *text, const char *bytes, size_t size) {
    text->failed = !list_add_bytes(&text->bytes, bytes, size) || text->failed;
}

static void put_quoted(struct gltf_text *text, const char *string) {
    char piece[JSON_PIECE];
    put(text, "\"", 1);
    for (size_t taken; *string; string += taken)
        put(text, piece, json_piece(string, piece, &taken));
    put(text, "\"", 1);
}

static void put_number(struct gltf_text *text, double number) {
    char digits[JSON_NUMBER];
    json_number(digits, number);
    put(text, digits, strlen(digits));
}

static void put_format(struct gltf_text *text, const char *format, va_list values) {
    const char last = text->bytes.count ? ((char *)text->bytes.items)[text->bytes.count - 1] : '{';
    if (!strchr("]}", format[0]) && !strchr("{[:", last))
        put(text, ",", 1);
    while (*format) {
        size_t length = strcspn(format, "'%");
        put(text, format, length);
        format += length;
        if (*format == '\'')
            put(text, "\"", 1);
        else if (*format && *++format == 's')
            put_quoted(text, va_arg(values, const char *));
        else if (*format == 'u')
            put_number(text, va_arg(values, uint32_t));
        else if (*format == 'g')
            put_number(text, va_arg(values, double));
        else if (*format) {
            const double *numbers = va_arg(values, const double *);
            for (int i = 0; i < *format - '0'; i++) {
                put(text, i ? "," : "[", 1);
                put_number(text, numbers[i]);
            }
            put(text, "]", 1);
        }
        format += *format != '\0';
    }
}

void gltf_put(struct gltf_text *text, const char *format, ...) {
    va_list values;
    va_start(values, format);
    put_format(text, format, values);
    va_end(values);
}

/* --- elements --- */

static uint64_t key_of(const void *bytes, size_t size) {
    return hash_bytes(bytes, size, 0) | 1;
}

uint32_t gltf_add(struct gltf_file *file, enum gltf_list list, struct gltf_text *text) {
    struct gltf_text *all = &file->lists[list].text;
    struct list *starts = &file->lists[list].starts;
    size_t size = text->bytes.count, end = all->bytes.count;
    uint64_t key = key_of(text->bytes.items, size);
    uint32_t number = (uint32_t)starts->count, *known = key_map_find(&file->lists[list].known, key);
    size_t start = known ? ((size_t *)starts->items)[*known] : end;
    file->failed = file->failed || text->failed || all->failed;
    text->bytes.count = 0;
    /* Nodes are places: equal ones are several. */
    if (known && list != GLTF_NODES && size <= end - start &&
        memcmp((char *)all->bytes.items + start, text->bytes.items, size) == 0)
        return *known;
    if (number > 0)
        put(all, ",", 1);
    start = all->bytes.count;
    put(all, text->bytes.items, size);
    if (!(known || key_map_add(&file->lists[list].known, key, number)) || !list_add(starts, &start, 1, sizeof start))
        file->failed = true;
    return number;
}

uint32_t gltf_element(struct gltf_file *file, enum gltf_list list, const char *format, ...) {
    struct gltf_text text = {0};
    va_list values;
    va_start(values, format);
    put_format(&text, format, values);
    va_end(values);
    uint32_t number = gltf_add(file, list, &text);
    list_destroy(&text.bytes);
    return number;
}

uint32_t gltf_add_view(struct gltf_file *file, const void *bytes, size_t size, enum gltf_target target) {
    uint64_t key = key_of(bytes, size);
    const uint32_t *known = key_map_find(&file->known_views, key);
    const struct gltf_view *views = file->views.items;
    if (known && views[*known].size == size && views[*known].target == target &&
        memcmp((char *)file->bytes.items + views[*known].start, bytes, size) == 0)
        return *known;
    const struct gltf_view view = {file->bytes.count, size, target};
    uint32_t number = (uint32_t)file->views.count;
    if (!list_add_bytes(&file->bytes, bytes, size) || !list_add_number(&file->bytes, 0, (size_t)-size % 4) ||
        !(known || key_map_add(&file->known_views, key, number)) || !list_add(&file->views, &view, 1, sizeof view))
        file->failed = true;
    return number;
}

uint32_t gltf_add_floats(struct gltf_file *file, const float *numbers, size_t count, int width,
                         enum gltf_target target) {
    static const char *const formats[] = {
        "{'type':'SCALAR','componentType':5126,'min':%1,'max':%1,'bufferView':%u,'count':%g}",
        "{'type':'VEC2','componentType':5126,'min':%2,'max':%2,'bufferView':%u,'count':%g}",
        "{'type':'VEC3','componentType':5126,'min':%3,'max':%3,'bufferView':%u,'count':%g}",
        "{'type':'VEC4','componentType':5126,'min':%4,'max':%4,'bufferView':%u,'count':%g}"};
    double low[4], high[4];
    for (size_t i = 0; i < count * (size_t)width; i++) {
        size_t k = i % (size_t)width;
        double x = (double)numbers[i];
        low[k] = i == k || x < low[k] ? x : low[k];
        high[k] = i == k || x > high[k] ? x : high[k];
    }
    uint32_t view = gltf_add_view(file, numbers, count * (size_t)width * sizeof *numbers, target);
    return gltf_element(file, GLTF_ACCESSORS, formats[width - 1], low, high, view, (double)count);
}

uint32_t gltf_add_indices(struct gltf_file *file, const uint32_t *indices, size_t count, uint32_t vertices) {
    struct list bytes = {0};
    size_t width = vertices < UINT16_MAX ? 2 : 4;
    for (size_t i = 0; i < count; i++)
        file->failed = !list_add_number(&bytes, indices[i], width) || file->failed;
    uint32_t view = gltf_add_view(file, bytes.items, bytes.count, GLTF_INDICES);
    list_destroy(&bytes);
    return gltf_element(file, GLTF_ACCESSORS, "{'type':'SCALAR','componentType':%u,'bufferView':%u,'count':%g}",
                        width == 2 ? 5123U : 5125U, view, (double)count);
}

/* --- the file --- */

static void put_list(struct gltf_text *text, const struct gltf_file *file, enum gltf_list list) {
    const struct list *elements = &file->lists[list].text.bytes;
    if (elements->count == 0)
        return;
    gltf_put(text, "%s:[", list_names[list]);
    put(text, elements->items, elements->count);
    gltf_put(text, "]");
}

/* No string of JSON ends with a quote before a colon, but keys do. */
static bool uses(const struct gltf_file *file, const char *extension) {
    char key[64];
    size_t size = (size_t)snprintf(key, sizeof key, "\"%s\":", extension);
    bool found = false;
    for (int i = 0; i < GLTF_LIST_COUNT && !found; i++) {
        const struct list *text = &file->lists[i].text.bytes;
        found = text->count > 0 && memmem(text->items, text->count, key, size);
    }
    return found;
}

static void put_buffer(struct gltf_text *text, const struct gltf_file *file, bool binary) {
    const struct gltf_view *views = file->views.items;
    if (file->bytes.count == 0)
        return;
    gltf_put(text, "'bufferViews':[");
    for (size_t i = 0; i < file->views.count; i++) {
        gltf_put(text, "{'buffer':0,'byteOffset':%g,'byteLength':%g", (double)views[i].start, (double)views[i].size);
        if (views[i].target != GLTF_NO_TARGET)
            gltf_put(text, "'target':%u", views[i].target);
        gltf_put(text, "}");
    }
    gltf_put(text, "]");
    gltf_put(text, "'buffers':[{'byteLength':%g", (double)file->bytes.count);
    if (!binary) {
        gltf_put(text, "'uri':");
        put(text, "\"data:application/octet-stream;base64,", 38);
        for (size_t i = 0; i < file->bytes.count; i += 3) {
            char four[4];
            bytes_base64((const uint8_t *)file->bytes.items + i, file->bytes.count - i, four);
            put(text, four, sizeof four);
        }
        put(text, "\"", 1);
    }
    gltf_put(text, "}]");
}

static void put_json(struct gltf_text *text, const struct gltf_file *file, bool binary, const struct list *roots) {
    const char *separator = "'extensionsUsed':[%s";
    put(text, model_glb_header, strlen(model_glb_header));
    put(text, "\"version\":\"2.0\"}", 16);
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (uses(file, extensions[i])) {
            gltf_put(text, separator, extensions[i]);
            separator = "%s";
        }
    gltf_put(text, separator[0] == '%' ? "],'scene':0,'scenes':[{" : "'scene':0,'scenes':[{");
    for (size_t i = 0; i < roots->count; i++)
        gltf_put(text, i ? "%u" : "'nodes':[%u", ((const uint32_t *)roots->items)[i]);
    gltf_put(text, roots->count ? "]}]" : "}]");
    for (int i = 0; i < (int)GLTF_LIGHTS; i++)
        put_list(text, file, (enum gltf_list)i);
    if (file->lists[GLTF_CHANNELS].starts.count) {
        gltf_put(text, "'animations':[{");
        put_list(text, file, GLTF_CHANNELS);
        put_list(text, file, GLTF_SAMPLERS);
        gltf_put(text, "}]");
    }
    if (file->lists[GLTF_LIGHTS].starts.count) {
        gltf_put(text, "'extensions':{'KHR_lights_punctual':{");
        put_list(text, file, GLTF_LIGHTS);
        gltf_put(text, "}}");
    }
    put_buffer(text, file, binary);
    gltf_put(text, "}");
}

bool gltf_file_write(struct gltf_file *file, bool binary, const struct list *roots, struct list *out) {
    struct gltf_text text = {0};
    put_json(&text, file, binary, roots);
    while (binary && text.bytes.count % 4)
        put(&text, " ", 1);
    size_t json = text.bytes.count, bytes = file->bytes.count, size = 20 + json + (bytes ? 8 + bytes : 0);
    bool ok = !text.failed && !file->failed && size <= UINT32_MAX;
    if (binary)
        ok = ok && list_add_bytes(out, "glTF", 4) && list_add_number(out, 2, 4) &&
             list_add_number(out, (uint32_t)size, 4) && list_add_number(out, (uint32_t)json, 4) &&
             list_add_bytes(out, "JSON", 4);
    ok = ok && list_add_bytes(out, text.bytes.items, json);
    if (binary && bytes)
        ok = ok && list_add_number(out, (uint32_t)bytes, 4) && list_add_bytes(out, "BIN", 4) &&
             list_add_bytes(out, file->bytes.items, bytes);
    list_destroy(&text.bytes);
    return ok;
}

void gltf_file_destroy(struct gltf_file *file) {
    for (int i = 0; i < GLTF_LIST_COUNT; i++) {
        list_destroy(&file->lists[i].text.bytes);
        list_destroy(&file->lists[i].starts);
        key_map_destroy(&file->lists[i].known);
    }
    list_destroy(&file->bytes);
    list_destroy(&file->views);
    key_map_destroy(&file->known_views);
}
