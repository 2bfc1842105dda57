/* Vertices at the same position, bit for bit (-0 and 0 are equal), or close to each other, and edges. */
#ifndef GRAY_MESH_MESH_TOPOLOGY_H
#define GRAY_MESH_MESH_TOPOLOGY_H

#include <stdbool.h>
#include <stdint.h>

struct mesh;

/* same[v] becomes the lowest vertex at the position of v. Linear. False: no memory. */
bool mesh_weld(const double (*vertices)[3], uint32_t count, uint32_t *same);
/* In their order, each vertex becomes the lowest kept one that is closer than `distance` (above 0), or is kept. So kept
 * vertices are at least that far apart, and few of them are near any point. Linear. False: no memory. */
bool mesh_weld_near(const double (*vertices)[3], uint32_t count, double distance, uint32_t *same);
/* Fills closed, outward and open_edges. False: no memory. */
bool mesh_find_topology(struct mesh *mesh);
/* mesh_opening, worked out. False: no memory. */
bool mesh_find_opening(const struct mesh *mesh, double *share);

#endif
