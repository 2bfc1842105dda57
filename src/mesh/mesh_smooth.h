/* Operations on the tables of a mesh before it is made: welding, reversal, normals with a crease angle. */
#ifndef GRAY_MESH_MESH_SMOOTH_H
#define GRAY_MESH_MESH_SMOOTH_H

#include "mesh/mesh.h"

/* Tables that replace those of a mesh_input; it points into them afterwards. Owner: the caller, mesh_tables_destroy,
 * once the input is not used any more. Zero value: none. */
struct mesh_tables {
    double (*vertices)[3], (*normals)[3], (*uvs)[2];
    float (*colours)[3];
    uint32_t *face_start, *vertex_index, *normal_index, *uv_index, *face_material;
};
void mesh_tables_destroy(struct mesh_tables *tables);

/* One vertex for each used position, or for vertices closer than a distance above 0 (mesh_topology.h); its colour is
 * that of the first vertex there. False: no memory. */
bool mesh_input_weld(struct mesh_input *input, struct mesh_tables *own, double distance, struct error *error);
/* Reverses every face, and its normals. */
bool mesh_input_flip(struct mesh_input *input, struct mesh_tables *own, struct error *error);
/* A normal for every corner: the mean of the faces at its vertex, weighted with their angles there (Thuermer and
 * Wuethrich, "Computing Vertex Normals from Polygonal Facets", Journal of Graphics Tools 3(1), 1998), over those faces
 * that are reached across edges where two faces meet at `degrees` or less. Vertices at equal positions count as one,
 * whatever their indices. Edges of three and more faces, and of faces that disagree about the outside, are sharp. 0
 * degrees: no normals at all, every face is flat. */
bool mesh_input_smooth(struct mesh_input *input, struct mesh_tables *own, double degrees, struct error *error);

#endif
