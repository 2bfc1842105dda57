/* The complete description of the crossing that a search has found. */
#include "world/world_describe.h"

#include "math/frame.h"
#include "shape/sphere.h"

#include <string.h>

static double row_sum(const struct affine *a, struct vec3 p) {
    double largest = 0;
    for (int i = 0; i < 3; i++) {
        double sum = fabs(a->m[i][0] * p.x) + fabs(a->m[i][1] * p.y) + fabs(a->m[i][2] * p.z) + fabs(a->m[i][3]);
        largest = sum > largest ? sum : largest;
    }
    return largest;
}

/* How far a secondary ray must start off the surface. The point is known up to the surface's own error and the rounding
 * of both transforms; everything scales with the numbers involved, so no length is built in. map NULL: identity. */
static double offset_of(const struct transform *map, double scale, const struct surface *surface, struct vec3 point) {
    double mapped = map ? row_sum(&map->forward, surface->point) : vec3_max_abs(surface->point);
    double back = map ? row_sum(&map->inverse, point) * scale : vec3_max_abs(point);
    return HIT_OFFSET_ERRORS * surface->error * scale + (mapped + back) * 0x1p-42;
}

/* The identity map of a vector, including the signs of zeros. */
static struct vec3 as_it_is(struct vec3 v) {
    return vec3_make(v.x + 0 * v.y + 0 * v.z, 0 * v.x + v.y + 0 * v.z, 0 * v.x + 0 * v.y + v.z);
}

/* Normals of most shapes are the same for shading. */
static bool same_vector(const struct vec3 *a, const struct vec3 *b) {
    return memcmp(a, b, sizeof *a) == 0;
}

bool world_disperses(const struct world *world) {
    bool disperses = false;
    for (uint32_t i = 0; i < world->material_count; i++)
        disperses = disperses || surface_disperses(&world->surfaces.materials[i]);
    return disperses;
}

bool world_needs_wavelength(const struct world *world, const struct hit *hit, const struct medium_stack *media) {
    if (media->wavelength > 0 || primitive_is_thin(world, hit->primitive))
        return false;
    return surface_disperses(&world->surfaces.materials[hit->material]) ||
           medium_stack_current(media)->dispersion.amount > 0;
}

bool world_native_uv(const struct world *world, const struct hit *hit, double *u, double *v) {
    return shape_native_uv(geometry_shape(primitive_geometry(world, hit->primitive), hit->leaf), hit, u, v);
}

/* Additional data for bumps and recorded functions: the world vectors of one unit along the operand's normal and along
 * its tangents, and on spheres the tangents of their coordinates. */
static void describe_tangents(const struct prototype *prototype, const struct affine *map, const struct csg_leaf *leaf,
                              struct hit *hit) {
    const struct shape *shape = geometry_shape(&prototype->geometry, hit->leaf);
    bool is_ball = shape_layout(shape) == LAYOUT_SPHERE;
    struct vec3 normal = vec3_normalize(hit->pattern_normal), raise = normal, u = {0}, v = {0}, a, b;
    frame_tangents(normal, &a, &b);
    if (is_ball)
        sphere_tangents(shape->sphere.radius, normal, &u, &v);
    if (leaf) {
        const struct affine *csg_from_leaf = &leaf->csg_from_leaf.forward;
        raise = affine_vector(csg_from_leaf, raise);
        u = affine_vector(csg_from_leaf, u);
        v = affine_vector(csg_from_leaf, v);
        a = affine_vector(csg_from_leaf, a);
        b = affine_vector(csg_from_leaf, b);
    }
    raise = affine_vector(map, raise);
    hit->along_a = affine_vector(map, a);
    hit->along_b = affine_vector(map, b);
    /* The surface of a subtracted operand has its outside inside the operand. */
    hit->raise = vec3_dot(raise, hit->normal_geometric) < 0 ? vec3_negate(raise) : raise;
    if (is_ball) {
        hit->curvature = 1 / shape->sphere.radius;
        hit->dpdu = affine_vector(map, u);
        hit->dpdv = affine_vector(map, v);
    }
}

static double stretch_of(const struct world *world, uint32_t index, const struct transform *map) {
    uint32_t linear = world->primitives[index].linear;
    return linear & LINEAR_MOVING ? transform_stretch(map) : world->linear_maps[linear].stretch;
}

static enum hit_convexity convexity_of(const struct prototype *prototype, const struct csg_leaf *leaf,
                                       const struct crossing *crossing) {
    if (!leaf)
        return prototype->convexity;
    return prototype->geometry.csg->convexity[crossing->leaf] && !crossing->flip ? CONVEXITY_BEHIND : CONVEXITY_NONE;
}

/* The surface of an object in the world; map NULL: the object's space is the world. Every field of the hit is written
 * once: clearing it as a whole would take longer than all the rest. */
static void surface_to_world(const struct surface *surface, const struct transform *map, struct hit *hit) {
    const struct vec3 zero = {0, 0, 0};
    if (map) {
        hit->point = affine_point(&map->forward, surface->point);
        hit->normal_geometric = vec3_normalize(transform_normal(map, surface->normal));
    } else {
        hit->point = vec3_add(as_it_is(surface->point), zero);
        hit->normal_geometric = vec3_normalize(as_it_is(surface->normal));
    }
    /* Most shapes have one normal, which is mapped once. */
    if (same_vector(&surface->normal, &surface->shading_normal))
        hit->normal = hit->normal_geometric;
    else
        hit->normal =
            vec3_normalize(map ? transform_normal(map, surface->shading_normal) : as_it_is(surface->shading_normal));
    hit->pattern_point = surface->pattern_point;
    hit->pattern_normal = surface->pattern_normal;
    hit->has_uv = surface->has_uv;
    hit->u = surface->u;
    hit->v = surface->v;
    hit->dpdu = hit->dpdv = hit->raise = hit->along_a = hit->along_b = zero;
    if (surface->has_uv) {
        hit->dpdu = map ? affine_vector(&map->forward, surface->dpdu) : as_it_is(surface->dpdu);
        hit->dpdv = map ? affine_vector(&map->forward, surface->dpdv) : as_it_is(surface->dpdv);
    }
    hit->has_second = surface->has_second;
    if (surface->has_second) {
        hit->second = surface->second;
        if (map) {
            hit->second.dpdu = affine_vector(&map->forward, surface->second.dpdu);
            hit->second.dpdv = affine_vector(&map->forward, surface->second.dpdv);
        }
    }
    hit->curvature = 0;
    hit->has_colour = surface->has_colour;
    hit->colour = surface->colour;
    hit->leaf = surface->leaf;
}

/* The footprint of the ray's cone on patterns, if an image needs it. */
static double pattern_scale(const struct transform *map, const struct csg_leaf *leaf, struct vec3 normal) {
    struct vec3 a, b;
    frame_tangents(normal, &a, &b);
    if (map) {
        a = affine_vector(&map->inverse, a);
        b = affine_vector(&map->inverse, b);
    }
    if (leaf) {
        a = affine_vector(&leaf->csg_from_leaf.inverse, a);
        b = affine_vector(&leaf->csg_from_leaf.inverse, b);
    }
    return math_max(vec3_length(a), vec3_length(b));
}

/* --- plain triangles of the group --- */

/* The material of a face of a mesh. */
static uint32_t material_of_slot(const struct prototype *prototype, uint32_t slot) {
    return prototype->material + (slot < prototype->slot_count ? slot : 0);
}

struct group_facet world_facet(const struct world *world, uint32_t primitive, uint32_t triangle) {
    const struct prototype *prototype = primitive_prototype(world, primitive);
    const struct mesh *mesh = geometry_mesh(&prototype->geometry);
    const struct ray no_direction = {.t_max = INFINITY}; /* becomes the normal of a triangle without area */
    struct surface surface;
    mesh_describe(mesh, &no_direction, &(struct crossing){.part = triangle}, &surface);
    uint32_t material = material_of_slot(prototype, surface.material_slot);
    if (!mesh_is_plain(mesh, triangle) || vec3_max_abs(surface.normal) == 0 || world->material_has_image[material] ||
        world->material_has_tangents[material])
        return (struct group_facet){.plain = false};
    return (struct group_facet){.normal = surface.normal,
                                .unit_normal = vec3_normalize(as_it_is(surface.normal)),
                                .error = surface.error,
                                .material = material,
                                .plain = true};
}

/* The same as for any other surface, with less to compute. */
static void describe_facet(const struct world *world, const struct ray *ray, uint32_t index,
                           const struct crossing *crossing, uint32_t number, struct hit *hit) {
    const struct group_facet *facet = &world->group.facets[number];
    const double(*v)[3] = world->group.set.vertices + (size_t)3 * number;
    const struct vec3 zero = {0, 0, 0}, a = {v[0][0], v[0][1], v[0][2]}, b = {v[1][0], v[1][1], v[1][2]},
                      c = {v[2][0], v[2][1], v[2][2]};
    double weight = 1 - crossing->u - crossing->v, length = vec3_length(ray->direction);
    struct vec3 point = vec3_add_scaled(vec3_add_scaled(vec3_scale(a, weight), b, crossing->u), c, crossing->v);
    /* The same as of a mesh in a primitive, without the maps: the bits are equal. */
    hit->t = crossing->t;
    hit->point = vec3_add(point, zero);
    hit->view = vec3_scale(ray->direction, -1 / length);
    hit->normal_geometric = hit->normal = facet->unit_normal;
    hit->pattern_point = point;
    hit->pattern_normal = facet->normal;
    hit->has_uv = hit->has_colour = hit->has_second = false;
    hit->dpdu = hit->dpdv = hit->raise = hit->along_a = hit->along_b = zero;
    hit->colour = colour_all(0);
    hit->u = hit->v = hit->curvature = hit->pattern_scale = 0;
    hit->offset = HIT_OFFSET_ERRORS * facet->error + (vec3_max_abs(point) + vec3_max_abs(hit->point)) * 0x1p-42;
    hit->behind = 0;
    hit->footprint = ray->footprint.width + ray->footprint.spread * crossing->t * length;
    hit->front = vec3_dot(hit->view, hit->normal_geometric) >= 0;
    hit->primitive = index;
    hit->leaf = 0;
    hit->part = crossing->part;
    hit->material = facet->material;
    hit->solid = world_solid(world, index, facet->material);
    hit->convexity = CONVEXITY_FACETS;
    hit->time = ray->time;
}

void world_describe(const struct world *world, const struct ray *ray, uint32_t index, const struct crossing *crossing,
                    struct hit *hit) {
    /* Plain triangles need no map. */
    const struct mesh_group *group = &world->group;
    if (group->index && mesh_group_run(group, index).count > 0 &&
        group->facets[group->first[index] + crossing->part].plain) {
        describe_facet(world, ray, index, crossing, group->first[index] + crossing->part, hit);
        return;
    }
    const struct prototype *prototype = primitive_prototype(world, index);
    struct transform world_from_object;
    struct ray ray_object;
    const struct transform *map = NULL;
    const struct ray *own_ray = ray;
    if (world->primitives[index].linear != LINEAR_NONE) {
        world_from_object = world_placement(world, index, ray->time);
        ray_object = ray_transform(&world_from_object.inverse, ray);
        map = &world_from_object;
        own_ray = &ray_object;
    }
    /* The surface in object space, then its material, then everything in the world. */
    struct surface surface;
    geometry_describe(&prototype->geometry, own_ray, crossing, &surface);
    double length = vec3_length(ray->direction);
    bool in_csg = prototype->geometry.csg != NULL;
    const struct csg_leaf *leaf = in_csg ? &prototype->geometry.csg->leaves[surface.leaf] : NULL;
    uint32_t material = in_csg ? leaf->material : prototype->material;
    uint32_t slot_count = in_csg ? leaf->slot_count : prototype->slot_count;
    if (surface.material_slot < slot_count)
        material += surface.material_slot;
    surface_to_world(&surface, map, hit);
    hit->t = crossing->t;
    hit->view = vec3_scale(ray->direction, -1 / length);
    hit->primitive = index;
    hit->part = crossing->part;
    hit->material = material;
    hit->solid = world_solid(world, index, material);
    hit->convexity = convexity_of(prototype, leaf, crossing);
    hit->time = ray->time;
    /* What costs more is computed only for materials that need it. */
    if (world->material_has_tangents[material]) {
        if (!map)
            world_from_object = transform_identity();
        describe_tangents(prototype, &world_from_object.forward, leaf, hit);
    }
    hit->front = vec3_dot(hit->view, hit->normal_geometric) >= 0;
    double stretch = map ? stretch_of(world, index, map) : 1;
    hit->offset = offset_of(map, stretch, &surface, hit->point);
    hit->behind = surface.behind * stretch;
    hit->footprint = ray->footprint.width + ray->footprint.spread * crossing->t * length;
    hit->pattern_scale = 0;
    if (hit->footprint > 0 && world->material_has_image[material])
        hit->pattern_scale = pattern_scale(map, leaf, hit->normal_geometric);
}

bool world_nearest_surface(const struct world *world, const struct ray *ray, struct world_scratch *scratch,
                           struct hit *hit) {
    uint32_t primitive;
    struct crossing crossing;
    if (!world_nearest_crossing(world, ray, scratch, &primitive, &crossing))
        return false;
    world_describe(world, ray, primitive, &crossing, hit);
    return true;
}
