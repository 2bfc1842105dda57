/* glTF 2.0 (Khronos Group, ISO/IEC 12113:2022), sections 3.6 and 4.4. Equal elements are written once: so instances
 * share their meshes, and materials that look alike are one. */
#include "export/gltf_file_internal.h"

#include "base/hash.h"
#include "base/json_write.h"
#include "base/list.h"
#include "formats/model_format.h"

static const char *const list_names[] = {GLTF_LISTS(LIST_WORD)};
static const char *const extension_names[] = {GLTF_EXTENSIONS(LIST_WORD)};

/* --- JSON --- */

static void put(struct gltf_text *text, const char *bytes, size_t size) {
    text->failed = !list_add_bytes(&text->bytes, bytes, size) || text->failed;
}

static void put_word(struct gltf_text *text, const char *word) {
    put(text, word, strlen(word));
}

static void put_quoted(struct gltf_text *text, const char *string) {
    char piece[JSON_PIECE];
    put(text, "\"", 1);
    for (size_t taken; *string; string += taken)
        put(text, piece, json_piece(string, piece, &taken));
    put(text, "\"", 1);
}

static void put_key(struct gltf_text *text, const char *key) {
    char last = text->bytes.count ? ((char *)text->bytes.items)[text->bytes.count - 1] : '{';
    if (last != '{' && last != '[')
        put(text, ",", 1);
    if (key) {
        put_quoted(text, key);
        put(text, ":", 1);
    }
}

void gltf_open(struct gltf_text *text, const char *key, char bracket) {
    if (key || text->bytes.count)
        put_key(text, key);
    put(text, &bracket, 1);
}

void gltf_close(struct gltf_text *text, char bracket) {
    put(text, &bracket, 1);
}

void gltf_number(struct gltf_text *text, const char *key, double number) {
    char digits[JSON_NUMBER];
    json_number(digits, number);
    put_key(text, key);
    put_word(text, digits);
}

void gltf_tuple(struct gltf_text *text, const char *key, const double *numbers, int count) {
    gltf_open(text, key, '[');
    for (int i = 0; i < count; i++)
        gltf_number(text, NULL, numbers[i]);
    gltf_close(text, ']');
}

void gltf_string(struct gltf_text *text, const char *key, const char *string) {
    put_key(text, key);
    put_quoted(text, string);
}

void gltf_true(struct gltf_text *text, const char *key) {
    put_key(text, key);
    put_word(text, "true");
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

static uint32_t add_accessor(struct gltf_file *file, struct gltf_text *text, uint32_t view, size_t count) {
    gltf_number(text, "bufferView", view);
    gltf_number(text, "count", (double)count);
    gltf_close(text, '}');
    uint32_t number = gltf_add(file, GLTF_ACCESSORS, text);
    list_destroy(&text->bytes);
    return number;
}

uint32_t gltf_add_floats(struct gltf_file *file, const float *numbers, size_t count, int width,
                         enum gltf_target target) {
    static const char *const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    struct gltf_text text = {0};
    double low[4], high[4];
    for (size_t i = 0; i < count * (size_t)width; i++) {
        size_t k = i % (size_t)width;
        double x = (double)numbers[i];
        low[k] = i == k || x < low[k] ? x : low[k];
        high[k] = i == k || x > high[k] ? x : high[k];
    }
    gltf_open(&text, NULL, '{');
    gltf_string(&text, "type", types[width - 1]);
    gltf_number(&text, "componentType", 5126);
    gltf_tuple(&text, "min", low, width);
    gltf_tuple(&text, "max", high, width);
    uint32_t view = gltf_add_view(file, numbers, count * (size_t)width * sizeof *numbers, target);
    return add_accessor(file, &text, view, count);
}

uint32_t gltf_add_indices(struct gltf_file *file, const uint32_t *indices, size_t count, uint32_t vertices) {
    struct gltf_text text = {0};
    struct list bytes = {0};
    size_t width = vertices < UINT16_MAX ? 2 : 4;
    for (size_t i = 0; i < count; i++)
        file->failed = !list_add_number(&bytes, indices[i], width) || file->failed;
    gltf_open(&text, NULL, '{');
    gltf_string(&text, "type", "SCALAR");
    gltf_number(&text, "componentType", width == 2 ? 5123 : 5125);
    uint32_t view = gltf_add_view(file, bytes.items, bytes.count, GLTF_INDICES);
    list_destroy(&bytes);
    return add_accessor(file, &text, view, count);
}

void gltf_use(struct gltf_file *file, enum gltf_extension extension) {
    file->extensions |= 1U << extension;
}

void gltf_open_extension(struct gltf_file *file, struct gltf_text *text, enum gltf_extension extension) {
    gltf_use(file, extension);
    gltf_open(text, extension_names[extension], '{');
}

/* --- the file --- */

static void put_list(struct gltf_text *text, const struct gltf_file *file, enum gltf_list list) {
    const struct list *elements = &file->lists[list].text.bytes;
    if (elements->count == 0)
        return;
    gltf_open(text, list_names[list], '[');
    put(text, elements->items, elements->count);
    gltf_close(text, ']');
}

static void put_views(struct gltf_text *text, const struct gltf_file *file) {
    const struct gltf_view *views = file->views.items;
    gltf_open(text, "bufferViews", '[');
    for (size_t i = 0; i < file->views.count; i++) {
        gltf_open(text, NULL, '{');
        gltf_number(text, "buffer", 0);
        gltf_number(text, "byteOffset", (double)views[i].start);
        gltf_number(text, "byteLength", (double)views[i].size);
        if (views[i].target != GLTF_NO_TARGET)
            gltf_number(text, "target", views[i].target);
        gltf_close(text, '}');
    }
    gltf_close(text, ']');
}

static void put_base64(struct gltf_text *text, const uint8_t *bytes, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    put_word(text, "\"data:application/octet-stream;base64,");
    for (size_t i = 0; i < size; i += 3) {
        uint32_t word = (uint32_t)bytes[i] << 16;
        word |= i + 1 < size ? (uint32_t)bytes[i + 1] << 8 : 0;
        word |= i + 2 < size ? bytes[i + 2] : 0;
        const char four[4] = {digits[word >> 18], digits[word >> 12 & 63], i + 1 < size ? digits[word >> 6 & 63] : '=',
                              i + 2 < size ? digits[word & 63] : '='};
        put(text, four, sizeof four);
    }
    put(text, "\"", 1);
}

static void put_buffer(struct gltf_text *text, const struct gltf_file *file, bool binary) {
    if (file->bytes.count == 0)
        return;
    put_views(text, file);
    gltf_open(text, "buffers", '[');
    gltf_open(text, NULL, '{');
    gltf_number(text, "byteLength", (double)file->bytes.count);
    if (!binary) {
        put_key(text, "uri");
        put_base64(text, file->bytes.items, file->bytes.count);
    }
    gltf_close(text, '}');
    gltf_close(text, ']');
}

static void put_json(struct gltf_text *text, const struct gltf_file *file, bool binary, const struct list *roots) {
    put_word(text, model_glb_header);
    put_word(text, "\"version\":\"2.0\"}");
    if (file->extensions) {
        gltf_open(text, "extensionsUsed", '[');
        for (int i = 0; i < LIST_COUNT(GLTF_EXTENSIONS); i++)
            if (file->extensions & 1U << i)
                gltf_string(text, NULL, extension_names[i]);
        gltf_close(text, ']');
    }
    gltf_number(text, "scene", 0);
    gltf_open(text, "scenes", '[');
    gltf_open(text, NULL, '{');
    if (roots->count > 0) {
        gltf_open(text, "nodes", '[');
        for (size_t i = 0; i < roots->count; i++)
            gltf_number(text, NULL, ((const uint32_t *)roots->items)[i]);
        gltf_close(text, ']');
    }
    gltf_close(text, '}');
    gltf_close(text, ']');
    for (int i = 0; i < (int)GLTF_LIGHTS; i++)
        put_list(text, file, (enum gltf_list)i);
    if (file->lists[GLTF_CHANNELS].starts.count) {
        gltf_open(text, "animations", '[');
        gltf_open(text, NULL, '{');
        put_list(text, file, GLTF_CHANNELS);
        put_list(text, file, GLTF_SAMPLERS);
        gltf_close(text, '}');
        gltf_close(text, ']');
    }
    if (file->extensions & 1U << GLTF_PUNCTUAL) {
        gltf_open(text, "extensions", '{');
        gltf_open(text, extension_names[GLTF_PUNCTUAL], '{');
        put_list(text, file, GLTF_LIGHTS);
        gltf_close(text, '}');
        gltf_close(text, '}');
    }
    put_buffer(text, file, binary);
    gltf_close(text, '}');
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
