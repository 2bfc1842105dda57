/* The meshes of a glTF file, for the model. */
#ifndef GRAY_FORMATS_GLTF_MESH_INTERNAL_H
#define GRAY_FORMATS_GLTF_MESH_INTERNAL_H

#include "formats/gltf_internal.h"

bool gltf_read_mesh(struct gltf *g, size_t number, const json_t *source);

#endif
