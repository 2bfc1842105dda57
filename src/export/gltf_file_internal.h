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

#define GLTF_EXTENSIONS(X)                                                                                             \
    X(GLTF_IOR, "KHR_materials_ior")                                                                                   \
    X(GLTF_SPECULAR, "KHR_materials_specular")                                                                         \
    X(GLTF_TRANSMISSION, "KHR_materials_transmission")                                                                 \
    X(GLTF_VOLUME, "KHR_materials_volume")                                                                             \
    X(GLTF_COAT, "KHR_materials_clearcoat")                                                                            \
    X(GLTF_SHEEN, "KHR_materials_sheen")                                                                               \
    X(GLTF_FILM, "KHR_materials_iridescence")                                                                          \
    X(GLTF_DISPERSION, "KHR_materials_dispersion")                                                                     \
    X(GLTF_STRENGTH, "KHR_materials_emissive_strength")                                                                \
    X(GLTF_UNLIT, "KHR_materials_unlit")                                                                               \
    X(GLTF_TEXTURE_TRANSFORM, "KHR_texture_transform")                                                                 \
    X(GLTF_PUNCTUAL, "KHR_lights_punctual")
enum gltf_extension { GLTF_EXTENSIONS(LIST_MEMBER) };

/* JSON; commas are put where they belong. Zero value: empty. Owner: its holder, list_destroy of bytes. */
struct gltf_text {
    struct list bytes;
    bool failed; /* no memory */
};
/* key: NULL in a list. bracket: '{' or '['. */
void gltf_open(struct gltf_text *text, const char *key, char bracket);
void gltf_close(struct gltf_text *text, char bracket);
/* The shortest decimal number that reads back equal. */
void gltf_number(struct gltf_text *text, const char *key, double number);
void gltf_tuple(struct gltf_text *text, const char *key, const double *numbers, int count);
/* Quoted; bytes that are no UTF-8 become U+FFFD. */
void gltf_string(struct gltf_text *text, const char *key, const char *string);
void gltf_true(struct gltf_text *text, const char *key);

/* Zero value: empty. Owner: its holder, gltf_file_destroy. */
struct gltf_file {
    struct {
        struct gltf_text text;
        struct list starts; /* size_t: of its elements */
        struct key_map known;
    } lists[GLTF_LIST_COUNT];
    struct list bytes, views; /* struct gltf_view */
    struct key_map known_views;
    unsigned extensions; /* bits */
    bool failed;         /* no memory */
};
void gltf_file_destroy(struct gltf_file *file);
/* Adds an element, whose text is emptied, or finds the equal one; its number. */
uint32_t gltf_add(struct gltf_file *file, enum gltf_list list, struct gltf_text *text);
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
void gltf_use(struct gltf_file *file, enum gltf_extension extension);
/* "KHR_...": an object that is opened. */
void gltf_open_extension(struct gltf_file *file, struct gltf_text *text, enum gltf_extension extension);
/* The bytes of a GLB, or else of a glTF file whose buffer is a data URI. roots: the nodes of the scene. False: no
 * memory, or 4 GiB and more. */
bool gltf_file_write(struct gltf_file *file, bool binary, const struct list *roots, struct list *out);

#endif
