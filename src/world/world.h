/* The flattened scene: primitives, a voxel grid over them, lights; immutable, flat arrays with 32-bit indices,
 * owned by the arena of one job. Answers ray queries. */
#ifndef GRAY_WORLD_WORLD_H
#define GRAY_WORLD_WORLD_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/pool.h"
#include "csg/geometry.h"
#include "geometry/hit.h"
#include "material/medium.h"
#include "material/surface_material.h"
#include "math/motion.h"
#include "scene/node.h"
#include "world/mesh_group.h"
#include "world/scene_accel.h"
#include "world/touching.h"

/* The map from a moving node to the world: after its own motion a fixed transform, then the next moving ancestor. */
struct moving_link {
    uint32_t above;                   /* number of a link, or LINK_NONE: the world itself */
    struct transform above_from_node; /* from the space its motion leads to, to the one that moves above it */
    struct motion motion;
};
#define LINK_NONE UINT32_MAX
/* The map of a primitive under moving nodes. */
struct moving {
    uint32_t link;
    struct transform link_from_object;
};

/* Data shared by all instances of one node. */
struct prototype {
    struct geometry geometry;
    uint32_t material;   /* unused for CSG: the leaves have their own */
    uint32_t slot_count; /* of a mesh: face slot k has material + k; below 2 all have `material` */
    enum node_cull cull; /* of a mesh */
    uint32_t parts;      /* of a union in parts: how many prototypes, from this one on, belong to its node; else 1 */
    bool is_later_part;  /* not the first of them */
    enum hit_convexity convexity; /* unused for CSG, like material */
    bool holes;                   /* some of its materials have an opacity texture */
    bool is_thin;                 /* a thin wall, for paths and photons; `by_shape`: because it is open */
    bool by_shape;
};

/* The authored objects, for inspection: searches and shading never read this. Borrows from the scene. */
struct authored {
    const struct node **nodes;             /* of each prototype; owned */
    const struct material **materials;     /* of each material, with the chain that it was derived from */
    const struct texture *const *textures; /* of each texture */
    const uint8_t *draws;                  /* by node->index: whether the node, or a descendant, has primitives */
};

/* The linear part of a placement's map and of its inverse; most placements share theirs with others. */
struct linear_map {
    double forward[3][3], inverse[3][3];
    double stretch; /* transform_stretch: bounds errors */
};

/* A primitive, kept small: a scene may have millions. world_placement computes its map. */
struct primitive {
    struct vec3 shift, shift_back; /* the last columns of world_from_object and of its inverse */
    uint32_t prototype;
    uint32_t linear; /* number of a linear map, or one of the following */
};
#define LINEAR_NONE UINT32_MAX            /* world_from_object changes nothing */
#define LINEAR_MOVING (UINT32_C(1) << 31) /* with the number of an entry in world->moving */

struct local_medium;
struct device_search;
struct world {
    const struct primitive *primitives;
    struct prototype *prototypes; /* owned, as are maps and moving */
    struct linear_map *linear_maps;
    struct moving *moving;
    struct moving_link *links;
    struct box *boxes; /* world box of each primitive */
    uint32_t primitive_count, prototype_count, linear_count, moving_count, link_count;
    struct shutter shutter;
    bool moves; /* something does */
    struct authored authored;
    /* By layout of shapes: a material whose images have another mapping on spheres or boxes is here several times, with
     * the same number. */
    struct surface_tables surfaces;
    const uint32_t *material_numbers;
    bool *material_has_image;    /* such materials need the footprint on the surface */
    bool *material_has_tangents; /* and such ones the tangents of the pattern: bumps and functions */
    bool *material_has_medium;   /* solids of the material have one inside: it is transparent */
    uint32_t material_count, material_number_count;
    struct media media;          /* by material; behind the outside those that are given by place, by solid */
    const uint32_t *first_solid; /* by primitive, one more at the end; NULL: light passes none */
    const uint32_t *solid_materials;
    struct local_medium *local_media; /* world/solids_internal.h */
    uint32_t local_media_count;
    double emission_bound; /* a bound of the largest component of emission */
    const struct light *lights;
    uint32_t light_count;
    struct sky sky;
    struct scene_accel accel;
    struct mesh_group group; /* single rays search it and its `rest` in place of accel.tree */
    /* In a bundle: searches read it in place of `accel` and `group`, which are empty (world/device_search.h). */
    const struct device_search *device;
    struct touching touching;
    enum accel_kind mesh_accel; /* of the meshes: as requested */
    bool classic;               /* as requested */
    bool has_thin_walls;        /* of prototypes */
    uint32_t scratch_need;
    uint64_t triangles; /* instances counted */
    size_t mesh_memory; /* bytes of the distinct meshes */
};

/* The medium around all solids. */
static inline const struct medium *world_outside(const struct world *world) {
    return &world->media.all[world->media.outside];
}

#define WORLD_NOTHING UINT32_MAX /* instead of a primitive's number */
enum { WORLD_SHADOW_CACHE = 8 };

/* One worker's mutable memory for queries. */
struct world_scratch {
    struct geom_scratch geom;
    bool failed; /* no memory to grow: the frame is abandoned with ERROR_MACHINE */
    uint64_t rays, any_rays;
    /* The occluder of the last shadow ray to a light (its number, modulo), or WORLD_NOTHING. */
    uint32_t shadow_cache[WORLD_SHADOW_CACHE], light;
};
bool world_scratch_init(struct world_scratch *scratch, const struct world *world);
void world_scratch_destroy(struct world_scratch *scratch);

/* Called with one line for warnings (a geometry node without material ...). */
typedef void world_warning(void *context, const char *text);

/* What a frame takes over from the frame before: the accelerator, and with keeps_tables the tables of everything that
 * has not changed. Zero value: nothing. Owner: the caller; world_cache_destroy frees it. */
struct world_cache {
    struct accel_cache accel;
    struct kept_tables *tables;
    uint64_t reused; /* number of worlds that took over tables */
};

/* The input of a world; it is only read, except that the scene records which nodes it has warned of, and with a cache
 * forgets the changes that the world now shows. */
struct world_input {
    struct scene *scene;
    const struct node *root; /* everything under it in its current state */
    const struct scene_light *lights;
    uint32_t light_count;
    const struct sky *sky;
    const struct medium *outside; /* around all solids; NULL: nothing */
    struct shutter shutter;
    enum accel_kind accel;     /* of the world and of the meshes */
    bool linear_colours;       /* pictures and display colours are decoded (docs/colour.md) */
    bool encodes;              /* the sRGB function is applied to the result */
    bool classic;              /* for Whitted's integrator: layers that want it become numbers of gr.material */
    struct world_cache *cache; /* of the frame before, or NULL */
    bool keeps_tables;         /* the scene has noted all its changes since then (scene/node.h) */
    world_warning *warn;       /* or NULL */
    void *warn_context;
};
/* Flattens the tree under the root; missing mesh indices are built. The world points into the scene's
 * arena (textures, names), so it must not outlive the script. Errors: cycles (naming the nodes), no memory, cancelled;
 * nothing is left to destroy then. Lights and sky are copied. */
bool world_build(struct world *world, const struct world_input *input, struct arena *arena, struct pool *pool,
                 struct error *error);
/* Copies the numbers of the scene's materials again, after changes that keep the world (change_keeps_world). */
void world_update_materials(struct world *world);
void world_destroy(struct world *world); /* memory outside the arena */
/* Bytes of placements with what they share and their boxes. */
size_t world_primitive_memory(const struct world *world);

static inline const struct prototype *primitive_prototype(const struct world *world, uint32_t primitive) {
    return &world->prototypes[world->primitives[primitive].prototype];
}
static inline const struct geometry *primitive_geometry(const struct world *world, uint32_t primitive) {
    return &primitive_prototype(world, primitive)->geometry;
}
/* Whether that holds for a material of it: of any slot, and of any operand of a combined solid. */
typedef bool material_test(const struct world *world, uint32_t material);
bool primitive_has_material(const struct world *world, uint32_t primitive, material_test *test);
/* Its pose depends on time. */
static inline bool primitive_moves(const struct world *world, uint32_t primitive) {
    uint32_t linear = world->primitives[primitive].linear;
    return linear != LINEAR_NONE && (linear & LINEAR_MOVING) != 0;
}
/* Its surface is a thin wall, for paths and photons. */
static inline bool primitive_is_thin(const struct world *world, uint32_t primitive) {
    return world->has_thin_walls && primitive_prototype(world, primitive)->is_thin;
}
/* The node that a primitive came from. */
static inline const struct node *primitive_node(const struct world *world, uint32_t primitive) {
    return world->authored.nodes[world->primitives[primitive].prototype];
}
/* world_from_object at a ray's time; for static primitives, the bits are those of the composed transforms of the
 * nodes. */
struct transform world_placement(const struct world *world, uint32_t primitive, double ray_time);
/* The ray in the space of a primitive that moves. */
struct ray world_ray_of_moving(const struct world *world, uint32_t primitive, const struct ray *ray);
/* The ray in object space. */
static inline struct ray primitive_ray(const struct world *world, uint32_t primitive, const struct ray *ray) {
    const struct primitive *p = &world->primitives[primitive];
    if (p->linear == LINEAR_NONE)
        return *ray;
    if (p->linear & LINEAR_MOVING)
        return world_ray_of_moving(world, primitive, ray);
    const struct linear_map *map = &world->linear_maps[p->linear];
    const double *x = map->inverse[0], *y = map->inverse[1], *z = map->inverse[2];
    struct vec3 o = ray->origin, d = ray->direction;
    struct ray out = *ray;
    out.origin = vec3_make(x[0] * o.x + x[1] * o.y + x[2] * o.z + p->shift_back.x,
                           y[0] * o.x + y[1] * o.y + y[2] * o.z + p->shift_back.y,
                           z[0] * o.x + z[1] * o.y + z[2] * o.z + p->shift_back.z);
    out.direction = vec3_make(x[0] * d.x + x[1] * d.y + x[2] * d.z, y[0] * d.x + y[1] * d.y + y[2] * d.z,
                              z[0] * d.x + z[1] * d.y + z[2] * d.z);
    return out;
}

/* Nearest hit in the ray's open interval, fully described. Of surfaces that coincide the one that is seen (joint.h); if
 * their t are equal, that of the primitive that comes first in flattening order. */
bool world_nearest(const struct world *world, const struct ray *ray, struct world_scratch *scratch, struct hit *hit);
/* Only the primitive and the crossing, both undefined if there is none; for tests and counters. */
bool world_nearest_crossing(const struct world *world, const struct ray *ray, struct world_scratch *scratch,
                            uint32_t *primitive, struct crossing *crossing);
/* The same with one primitive alone. */
bool world_nearest_of(const struct world *world, uint32_t primitive, const struct ray *ray,
                      struct world_scratch *scratch, struct crossing *crossing);
bool world_any(const struct world *world, const struct ray *ray, struct world_scratch *scratch);
/* The occluder of the last ray of world_any; WORLD_NOTHING: none, or ACCEL_NONE. */
static inline uint32_t world_blocker(const struct world_scratch *scratch) {
    return scratch->shadow_cache[scratch->light];
}
/* The box around all finite primitives. */
struct box world_finite_bounds(const struct world *world);
/* The closed primitives whose box meets `region`: all that can contain a point of it, in flattening order. `out` (or
 * NULL) has room for `limit`. Returns how many there are. */
uint32_t world_closed_in(const struct world *world, const struct box *region, uint32_t *out, uint32_t limit);
/* A point at a ray's time, and the primitives that may contain it (world_closed_in). */
struct inside_query {
    struct vec3 point;
    double ray_time;
    const uint32_t *candidates;
    uint32_t count;
};
/* The candidates that contain the point, innermost last; at most `limit`, which is at most
 * WORLD_NESTING. Returns how many there are. */
enum { WORLD_NESTING = 64 };
uint32_t world_containing(const struct world *world, const struct inside_query *query, struct world_scratch *scratch,
                          uint32_t *primitive, uint32_t limit);

/* The media of the transparent solids that contain the point, found by counting crossings. */
void world_medium_stack(const struct world *world, const struct inside_query *query, struct world_scratch *scratch,
                        struct medium_stack *out);
/* What a world of device_search_world points to (base/bundle.h), but for the authored objects. */
bundle_fields world_bundle;

#endif
