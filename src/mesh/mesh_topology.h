/* Vertices at the same position, bit for bit (-0 and 0 are equal), and edges. */
#ifndef GRAY_MESH_MESH_TOPOLOGY_H
#define GRAY_MESH_MESH_TOPOLOGY_H

#include <stdbool.h>
#include <stdint.h>

struct mesh;

/* same[v] becomes the lowest vertex at the position of v. Linear. False: no memory. */
bool mesh_weld(const double (*vertices)[3], uint32_t count, uint32_t *same);
/* Fills closed, outward and open_edge. False: no memory. */
bool mesh_find_topology(struct mesh *mesh);

#endif
