/* The nodes of a glTF file, for the model. */
#ifndef GRAY_FORMATS_GLTF_NODE_INTERNAL_H
#define GRAY_FORMATS_GLTF_NODE_INTERNAL_H

#include "formats/gltf_internal.h"

bool gltf_read_nodes(struct gltf *g);

#endif
