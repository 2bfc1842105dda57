/* The formats of models: one list of those that gray reads and writes. */
#ifndef GRAY_FORMATS_MODEL_FORMAT_H
#define GRAY_FORMATS_MODEL_FORMAT_H

#include "base/list.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* With their extensions. */
#define MODEL_FORMATS_BOTH(X)                                                                                          \
    X(FORMAT_STL, ".stl")                                                                                              \
    X(FORMAT_OBJ, ".obj")                                                                                              \
    X(FORMAT_PLY, ".ply")                                                                                              \
    X(FORMAT_GLTF, ".gltf")                                                                                            \
    X(FORMAT_GLB, ".glb")
#define MODEL_FORMATS(X) MODEL_FORMATS_BOTH(X) X(FORMAT_3MF, ".3mf")
enum model_format { MODEL_FORMATS(LIST_MEMBER) FORMAT_OTHER };
/* For help, after a colon. */
#define MODEL_FORMATS_HELP MODEL_FORMATS(LIST_BLANK_WORD)

/* The length of a number of a model, for files that have one. */
#define MODEL_UNITS(X) X(MODEL_MM, "mm") X(MODEL_CM, "cm") X(MODEL_M, "m") X(MODEL_IN, "in")
enum model_unit { MODEL_UNITS(LIST_MEMBER) };

/* By the extension, in upper or lower case; of formats that gray does not write FORMAT_OTHER. */
enum model_format model_format_written(const char *name);
/* Files that hold scenes, not solids alone. */
static inline bool model_format_is_scene(enum model_format format) {
    return format == FORMAT_GLTF || format == FORMAT_GLB;
}
/* The same for --bake, which writes PLY and GLB. */
enum model_format model_format_baked(const char *name);
/* The first line or bytes of files that gray writes. */
extern const char model_stl_header[], model_obj_header[], model_glb_header[], model_scene_header[];
/* Whether a file that begins so is a model of a format that gray writes, so that another may replace it. Binary STL and
 * OBJ files have no signature, and GLB files are models of others: only those of gray. */
bool model_file_is(const uint8_t *head, size_t size);

#endif
