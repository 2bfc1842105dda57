/* The switch over shapes. A new shape adds one case to every function here; the compiler names those it forgot. */
#include "geom/shape.h"

#include "geom/csg.h"
#include "geom/mesh.h"
#include "geom/shape_box.h"
#include "geom/shape_sphere.h"

/* What a mesh is expected to put on the scratch; when it is more the scratch grows between rays. */
#define MESH_CROSSINGS_GUESS 256

struct box shape_bounds(const struct shape *shape) {
    switch (shape->kind) {
    case SHAPE_SPHERE: {
        struct vec3 c = shape->sphere.centre, r = vec3_all(shape->sphere.radius);
        return box_pad((struct box){vec3_sub(c, r), vec3_add(c, r)});
    }
    case SHAPE_BOX:
        return shape->box;
    case SHAPE_MESH:
        return mesh_bounds(shape->mesh);
    case SHAPE_CSG:
        return shape->csg->bounds;
    }
    return box_empty();
}

bool shape_is_closed(const struct shape *shape) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return true;
    case SHAPE_BOX:
        return true;
    case SHAPE_MESH:
        return mesh_is_closed(shape->mesh);
    case SHAPE_CSG:
        return true;
    }
    return false;
}

/* The crossing pair of a convex analytic shape. */
static bool pair_crossings(const struct shape *shape, const struct ray *ray, struct crossing pair[2]) {
    return shape->kind == SHAPE_SPHERE ? sphere_crossings(shape->sphere.centre, shape->sphere.radius, ray, pair)
                                       : box_shape_crossings(&shape->box, ray, pair);
}

static bool pair_nearest(const struct shape *shape, const struct ray *ray, struct crossing *out) {
    struct crossing pair[2];
    if (!pair_crossings(shape, ray, pair))
        return false;
    for (int i = 0; i < 2; i++)
        if (pair[i].t > ray->t_min && pair[i].t < ray->t_max) {
            *out = pair[i];
            return true;
        }
    return false;
}

bool shape_nearest(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                   struct crossing *out) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
    case SHAPE_BOX:
        scratch->shape_tests++;
        return pair_nearest(shape, ray, out);
    case SHAPE_MESH:
        return mesh_nearest(shape->mesh, ray, ACCEL_GRID, scratch, out);
    case SHAPE_CSG:
        return csg_nearest(shape->csg, ray, scratch, out);
    }
    return false;
}

bool shape_any(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
    case SHAPE_BOX: {
        struct crossing ignored;
        scratch->shape_tests++;
        return pair_nearest(shape, ray, &ignored);
    }
    case SHAPE_MESH:
        return mesh_any(shape->mesh, ray, ACCEL_GRID, scratch);
    case SHAPE_CSG:
        return csg_any(shape->csg, ray, scratch);
    }
    return false;
}

bool shape_crossings(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                     struct crossing_list *out) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
    case SHAPE_BOX: {
        struct crossing pair[2];
        scratch->shape_tests++;
        *out = (struct crossing_list){scratch->used, 0};
        if (!pair_crossings(shape, ray, pair))
            return true;
        if (!geom_scratch_push(scratch, pair[0]) || !geom_scratch_push(scratch, pair[1])) {
            scratch->used = out->first;
            return false;
        }
        out->count = 2;
        return true;
    }
    case SHAPE_MESH:
        return mesh_crossings(shape->mesh, ray, ACCEL_GRID, scratch, out);
    case SHAPE_CSG:
        return csg_crossings(shape->csg, ray, scratch, out);
    }
    return false;
}

/* Parity along one fixed direction, oblique to everything people model; crossings ahead of the point are counted. */
static bool mesh_contains(const struct mesh *mesh, struct vec3 point, struct geom_scratch *scratch) {
    struct box bounds = mesh_bounds(mesh);
    if (!box_contains(&bounds, point))
        return false;
    struct ray ray = {.origin = point,
                      .direction = {0.5773128394, 0.2138497211, 0.7881094327},
                      .t_min = -INFINITY,
                      .t_max = INFINITY};
    struct crossing_list list;
    if (!mesh_crossings(mesh, &ray, ACCEL_GRID, scratch, &list))
        return false;
    bool inside = false;
    for (uint32_t i = 0; i < list.count; i++)
        inside ^= scratch->items[list.first + i].t > 0;
    scratch->used = list.first;
    return inside;
}

bool shape_contains(const struct shape *shape, struct vec3 point, struct geom_scratch *scratch) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return sphere_contains(shape->sphere.centre, shape->sphere.radius, point);
    case SHAPE_BOX:
        return box_shape_contains(&shape->box, point);
    case SHAPE_MESH:
        return mesh_contains(shape->mesh, point, scratch);
    case SHAPE_CSG:
        return csg_contains(shape->csg, point, scratch);
    }
    return false;
}

void shape_describe(const struct shape *shape, const struct ray *ray, const struct crossing *crossing,
                    struct surface *out) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
        sphere_describe(shape->sphere.centre, shape->sphere.radius, ray, crossing, out);
        return;
    case SHAPE_BOX:
        box_shape_describe(&shape->box, ray, crossing, out);
        return;
    case SHAPE_MESH:
        mesh_describe(shape->mesh, ray, crossing, out);
        return;
    case SHAPE_CSG:
        csg_describe(shape->csg, ray, crossing, out);
        return;
    }
}

uint32_t shape_scratch_need(const struct shape *shape) {
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return 2;
    case SHAPE_BOX:
        return 2;
    case SHAPE_MESH:
        return MESH_CROSSINGS_GUESS;
    case SHAPE_CSG:
        return shape->csg->max_crossings;
    }
    return 0;
}
