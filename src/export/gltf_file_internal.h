/* A glTF file in the making: the elements of its lists as text, and the bytes of its buffer. */
#ifndef GRAY_EXPORT_GLTF_FILE_INTERNAL_H
#define GRAY_EXPORT_GLTF_FILE_INTERNAL_H

#include "base/key_map.h"
#include "base/list.h"
#include "formats/list.h"
#include "math/vec3.h"

#define GLTF_NONE UINT32_MAX /* in place of the number of an element */

/* The lists of a file; channels and samplers are those of its animation, lights those of KHR_lights_punctual. */
#define GLTF_LISTS(X)                                                                                                  \
    X(GLTF_ACCESSORS, "accessors")                                                                                     \
    X(GLTF_CAMERAS, "cameras")                                                                                         \
    X(GLTF_IMAGES, "images")                                                                                           \
    X(GLTF_MATERIALS, "materials")                                                                                     \
    X(GLTF_MESHES, "meshes")                                                                                           \
    X(GLTF_NODES, "nodes")                                                                                             \
    X(GLTF_TEXTURE_SAMPLERS, "samplers")                                                                               \
    X(GLTF_TEXTURES, "textures")                                                                                       \
    X(GLTF_LIGHTS, "lights")                                                                                           \
    X(GLTF_CHANNELS, "channels")                                                                                       \
    X(GLTF_SAMPLERS, "samplers")
enum gltf_list { GLTF_LISTS(LIST_MEMBER) };
enum { GLTF_LIST_COUNT = LIST_COUNT(GLTF_LISTS) };

/* Zero value: empty. Owner: its holder, list_destroy of bytes. */
struct gltf_text {
    struct list bytes;
    bool failed; /* no memory */
};
/* Adds JSON, with a comma before it where one belongs. ' stands for a quote, %u for a uint32_t, %g for the shortest
 * number that reads back equal to a double, %s for a string in quotes (bytes that are no UTF-8 become U+FFFD), and %1
 * to %4 for a list of so many doubles. */
void gltf_put(struct gltf_text *text, const char *format, ...);

/* Zero value: empty. Owner: its holder, gltf_file_destroy. */
struct gltf_file {
    struct {
        struct gltf_text text;
        struct list starts; /* size_t: of its elements */
        struct key_map known;
    } lists[GLTF_LIST_COUNT];
    struct list bytes, views; /* struct gltf_view */
    struct key_map known_views;
    bool failed; /* no memory */
};
void gltf_file_destroy(struct gltf_file *file);
/* Adds an element, whose text is emptied, or finds the equal one; its number. */
uint32_t gltf_add(struct gltf_file *file, enum gltf_list list, struct gltf_text *text);
/* Likewise, of JSON in the format of gltf_put. */
uint32_t gltf_element(struct gltf_file *file, enum gltf_list list, const char *format, ...);
enum gltf_target { GLTF_NO_TARGET, GLTF_VERTICES = 34962, GLTF_INDICES = 34963 };
struct gltf_view {
    size_t start, size;
    enum gltf_target target;
};
/* Likewise bytes. */
uint32_t gltf_add_view(struct gltf_file *file, const void *bytes, size_t size, enum gltf_target target);
/* Vectors of 1 to 4 numbers as floats. */
uint32_t gltf_add_floats(struct gltf_file *file, const float *numbers, size_t count, int width,
                         enum gltf_target target);
uint32_t gltf_add_indices(struct gltf_file *file, const uint32_t *indices, size_t count, uint32_t vertices);
/* The bytes of a GLB, or else of a glTF file whose buffer is a data URI. roots: the nodes of the scene. False: no
 * memory, or 4 GiB and more. */
bool gltf_file_write(struct gltf_file *file, bool binary, const struct list *roots, struct list *out);

#endif
