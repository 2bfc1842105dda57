/* The buffer of a glTF file and its container, and what Lua gets of both (gltf_scene.lua). */
#ifndef GRAY_EXPORT_GLTF_FILE_INTERNAL_H
#define GRAY_EXPORT_GLTF_FILE_INTERNAL_H

#include "base/error.h"
#include "base/key_map.h"
#include "base/lua_fields.h"
#include "formats/list.h"

#define GLTF_NONE UINT32_MAX /* in place of the number of a view */

/* Equal bytes are in the buffer once. Zero value: empty. Owner: its holder, gltf_buffer_destroy. */
struct gltf_buffer {
    struct list bytes, views; /* struct gltf_view */
    struct key_map known;
};
#define GLTF_NO_MEMORY "not enough memory" /* what Lua raises, too */
enum gltf_target { GLTF_NO_TARGET, GLTF_VERTICES = 34962, GLTF_INDICES = 34963 };
struct gltf_view {
    size_t start, size;
    enum gltf_target target;
};
void gltf_buffer_destroy(struct gltf_buffer *buffer);
/* Adds bytes, or finds the equal ones: the number of their view. False: no memory. */
bool gltf_add_view(struct gltf_buffer *buffer, const void *bytes, size_t size, enum gltf_target target,
                   uint32_t *number);

/* Likewise indices, of 16 bits if that is enough; the constant of their components. */
bool gltf_add_indices(struct gltf_buffer *buffer, const uint32_t *indices, size_t count, size_t vertices,
                      uint32_t *number);
static inline unsigned gltf_index_component(size_t vertices) {
    return vertices < UINT16_MAX ? 5123 : 5125;
}

/* The rest may raise; what they need for a while is Lua's. Each pushes a table for the JSON: of a view; of an accessor,
 * without its view, and of the view: of vectors of 1 to 4 numbers as floats, or of indices. */
void gltf_push_view(lua_State *L, const struct gltf_buffer *buffer, uint32_t number);
int gltf_push_floats(lua_State *L, struct gltf_buffer *buffer, const float *numbers, size_t count, int width,
                     enum gltf_target target);
int gltf_push_indices(lua_State *L, struct gltf_buffer *buffer, const uint32_t *indices, size_t count, size_t vertices);
/* The element of `buffers`, or nil; with a data URI unless the file is binary. */
void gltf_push_buffer(lua_State *L, const struct gltf_buffer *buffer, bool binary);
/* The bytes of a GLB, or the text. Errors: no memory, 4 GiB and more. */
bool gltf_file_write(const struct gltf_buffer *buffer, const struct list *text, bool binary, struct list *out,
                     struct error *error);

#endif
