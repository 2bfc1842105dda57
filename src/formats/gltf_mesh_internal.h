/* The meshes of a glTF file, for the model. */
#ifndef GRAY_FORMATS_GLTF_MESH_INTERNAL_H
#define GRAY_FORMATS_GLTF_MESH_INTERNAL_H

#include "formats/gltf_internal.h"

/* How a node changes the vertices of its mesh; zero: not at all. */
struct gltf_deformation {
    const double *weights; /* of morph targets */
    size_t weight_count;
    const struct affine *joints; /* the model's space from that of the mesh, for each joint of a skin; NULL: no skin */
    size_t joint_count;
    const struct affine *projection; /* a map without an inverse, or NULL */
};

/* Makes one more mesh of the model, of meshes[number]. */
bool gltf_read_mesh(struct gltf *g, uint32_t number, const struct gltf_deformation *by);

#endif
