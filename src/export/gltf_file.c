/* glTF 2.0 (Khronos Group, ISO/IEC 12113:2022), sections 3.6 and 4.4. Equal arrays are written once, so instances share
 * their meshes. */
#include "export/gltf_file_internal.h"

#include "base/bytes.h"
#include "base/hash.h"

#include <lauxlib.h>

bool gltf_add_view(struct gltf_buffer *buffer, const void *bytes, size_t size, enum gltf_target target,
                   uint32_t *number) {
    uint64_t key = hash_bytes(bytes, size, 0) | 1;
    const uint32_t *known = key_map_find(&buffer->known, key);
    const struct gltf_view *views = buffer->views.items, view = {buffer->bytes.count, size, target};
    *number = known ? *known : 0;
    if (known && views[*known].size == size && views[*known].target == target &&
        memcmp((char *)buffer->bytes.items + views[*known].start, bytes, size) == 0)
        return true;
    *number = (uint32_t)buffer->views.count;
    return list_add_bytes(&buffer->bytes, bytes, size) && list_add_number(&buffer->bytes, 0, (size_t)-size % 4) &&
           (known || key_map_add(&buffer->known, key, *number)) && list_add(&buffer->views, &view, 1, sizeof view);
}

bool gltf_add_indices(struct gltf_buffer *buffer, const uint32_t *indices, size_t count, size_t vertices,
                      uint32_t *number) {
    const size_t width = gltf_index_component(vertices) == 5123 ? 2 : 4;
    struct list bytes = {0};
    bool ok = true;
    for (size_t i = 0; ok && i < count; i++)
        ok = list_add_number(&bytes, indices[i], width);
    ok = ok && gltf_add_view(buffer, bytes.items, bytes.count, GLTF_INDICES, number);
    list_destroy(&bytes);
    return ok;
}

void gltf_buffer_destroy(struct gltf_buffer *buffer) {
    list_destroy(&buffer->bytes);
    list_destroy(&buffer->views);
    key_map_destroy(&buffer->known);
}

/* --- for Lua --- */

void gltf_push_view(lua_State *L, const struct gltf_buffer *buffer, uint32_t number) {
    const struct gltf_view *view = (const struct gltf_view *)buffer->views.items + number;
    lua_createtable(L, 0, 4);
    field_number(L, "buffer", 0);
    field_number(L, "byteOffset", (double)view->start);
    field_number(L, "byteLength", (double)view->size);
    if (view->target != GLTF_NO_TARGET)
        field_number(L, "target", view->target);
}

/* Pushes an accessor, with the number of the constant of its components. */
static void push_accessor(lua_State *L, int width, double component, size_t count) {
    static const char *const types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    lua_createtable(L, 0, 6);
    field_text(L, "type", types[width - 1]);
    field_number(L, "componentType", component);
    field_number(L, "count", (double)count);
}

int gltf_push_floats(lua_State *L, struct gltf_buffer *buffer, const float *numbers, size_t count, int width,
                     enum gltf_target target) {
    double low[4], high[4];
    for (size_t i = 0; i < count * (size_t)width; i++) {
        size_t k = i % (size_t)width;
        double x = (double)numbers[i];
        low[k] = i == k || x < low[k] ? x : low[k];
        high[k] = i == k || x > high[k] ? x : high[k];
    }
    push_accessor(L, width, 5126, count);
    field_numbers(L, "min", low, width);
    field_numbers(L, "max", high, width);
    uint32_t number;
    if (!gltf_add_view(buffer, numbers, count * (size_t)width * sizeof *numbers, target, &number))
        return luaL_error(L, GLTF_NO_MEMORY);
    gltf_push_view(L, buffer, number);
    return 2;
}

int gltf_push_indices(lua_State *L, struct gltf_buffer *buffer, const uint32_t *indices, size_t count,
                      size_t vertices) {
    uint32_t number;
    push_accessor(L, 1, gltf_index_component(vertices), count);
    if (!gltf_add_indices(buffer, indices, count, vertices, &number))
        return luaL_error(L, GLTF_NO_MEMORY);
    gltf_push_view(L, buffer, number);
    return 2;
}

void gltf_push_buffer(lua_State *L, const struct gltf_buffer *buffer, bool binary) {
    const size_t size = buffer->bytes.count;
    luaL_Buffer uri;
    if (size == 0) {
        lua_pushnil(L);
        return;
    }
    lua_createtable(L, 0, 2);
    field_number(L, "byteLength", (double)size);
    if (binary)
        return;
    luaL_buffinit(L, &uri);
    luaL_addstring(&uri, "data:application/octet-stream;base64,");
    for (size_t i = 0; i < size; i += 3) {
        bytes_base64((const uint8_t *)buffer->bytes.items + i, size - i, luaL_prepbuffsize(&uri, 4));
        luaL_addsize(&uri, 4);
    }
    luaL_pushresult(&uri);
    lua_setfield(L, -2, "uri");
}

/* --- the file --- */

bool gltf_file_write(const struct gltf_buffer *buffer, const struct list *text, bool binary, struct list *out,
                     struct error *error) {
    const size_t padding = binary ? (size_t)-text->count % 4 : 0, json = text->count + padding,
                 bytes = buffer->bytes.count, size = 20 + json + (bytes ? 8 + bytes : 0);
    if (size > UINT32_MAX)
        return error_set(error, ERROR_SCENE, "the model is larger than 4 GiB, which glTF cannot hold");
    bool ok = !binary || (list_add_bytes(out, "glTF", 4) && list_add_number(out, 2, 4) &&
                          list_add_number(out, (uint32_t)size, 4) && list_add_number(out, (uint32_t)json, 4) &&
                          list_add_bytes(out, "JSON", 4));
    ok = ok && list_add_bytes(out, text->items, text->count) && list_add_bytes(out, "   ", padding);
    ok = ok && (!binary || bytes == 0 ||
                (list_add_number(out, (uint32_t)bytes, 4) && list_add_bytes(out, "BIN", 4) &&
                 list_add_bytes(out, buffer->bytes.items, bytes)));
    return ok || error_no_memory(error, "a model");
}
