/* One polygon into triangles. Corners are never dropped (that would tear the seam to the neighbours): a polygon of n
 * corners gives n - 2 triangles, of no area where it has none. Deterministic. */
#ifndef GRAY_MESH_TRIANGULATE_INTERNAL_H
#define GRAY_MESH_TRIANGULATE_INTERNAL_H

#include <stdbool.h>
#include <stdint.h>

/* Work memory, reused from polygon to polygon. Zero-initialise; owner: the caller, triangulate_scratch_destroy. */
struct triangulate_scratch {
    struct triangulate_corner *corners;
    uint32_t capacity;
};
void triangulate_scratch_destroy(struct triangulate_scratch *scratch);

/* vertex[0 .. count-1] index `vertices`, count >= 3. Writes count - 2 triples of positions in `vertex` (0 .. count-1),
 * in the polygon's winding. Convex polygons become a fan from corner 0; others are clipped ear by ear in the plane that
 * drops the axis along which the polygon's normal (Newell) is largest. Holes may be joined by a bridge (two corners
 * visited twice). A polygon that crosses itself gives some n - 2 triangles. False: no memory. */
bool triangulate_polygon(const double (*vertices)[3], const uint32_t *vertex, uint32_t count, uint32_t (*triangles)[3],
                         struct triangulate_scratch *scratch);

#endif
