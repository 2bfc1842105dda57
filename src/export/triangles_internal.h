/* Distances and intersections of triangles. */
#ifndef GRAY_EXPORT_TRIANGLES_INTERNAL_H
#define GRAY_EXPORT_TRIANGLES_INTERNAL_H

#include "accel/box_tree.h"
#include "export/solid_mesh_internal.h"
#include "math/box.h"

struct corners {
    struct vec3 point[3];
    uint32_t vertex[3];
};

double segment_distance_squared(struct vec3 p, struct vec3 a, struct vec3 b);
double triangle_distance_squared(struct vec3 p, const struct vec3 corners[3]);
struct vec3 triangle_normal(const struct vec3 corners[3]); /* twice the area long */
/* Whether two triangles have more in common than their common vertices: a point inside of one of them and on the other,
 * or they lie on each other. slack: distances below it are rounding. */
bool triangles_intersect(const struct corners *a, const struct corners *b, double slack);

struct corners corners_of(const struct solid_mesh *mesh, uint32_t triangle);
struct box corners_box(const struct corners *corners);
/* A tree over the boxes of the triangles; box_tree_destroy. */
bool triangle_tree_build(struct box_tree *tree, const struct solid_mesh *mesh, struct pool *pool, struct error *error);

/* Whether a triangle is nearer to the point. */
bool mesh_is_near(const struct solid_mesh *mesh, const struct box_tree *tree, struct vec3 point, double distance);

/* Calls `found` for each pair of triangles that intersect. */
typedef void intersection_found(void *context, uint32_t one, uint32_t other);
void find_intersections(const struct solid_mesh *mesh, const struct box_tree *tree, double slack,
                        intersection_found *found, void *context);

#endif
