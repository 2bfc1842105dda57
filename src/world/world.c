/* The world: flattening, the frame over the placed primitives, and the three questions a renderer asks.
 *
 * How many voxels has the frame? A voxel spares a ray that passes it the upper levels of the hierarchy and costs it a
 * step. In a cloud of alike primitives without anything round it, with three voxels to each of them, steps win by a
 * tenth (10,000 spheres) to a fifth (200,000) of the whole picture. But one floor round the cloud makes voxels of the
 * floor's size, which hold everything at once: 25 times slower at 10,000, 190 times at 200,000. No resolution that is
 * the same everywhere suits both. ACCEL_AUTO asks the cost model of accel/frame_cost.c, which knows from a sample of
 * the boxes how many voxels a line visits, how long their lists are, and how long for somebody who looks at the
 * crowd: voxels with lists where they cost clearly less, else one voxel with the hierarchy of box_tree.c in it, which
 * also lets packets and shafts through. ACCEL_GRID and ACCEL_BVH pin it. docs/performance.md has the measurements.
 *
 * Where a primitive stands in several cells it is tried once per ray all the same (a small mailbox remembers). */
#include "world/world.h"

#include "accel/frame_cost.h"
#include "base/mem.h"
#include "geom/shape_sphere.h"
#include "math/frame.h"
#include "world/flatten.h"
#include "world/light_lamps.h"
#include "world/light_lists.h"
#include "world/world_parts.h"

#include <string.h>

enum { MAILBOX = 32, SCRATCH_START = 256 };

bool world_scratch_init(struct world_scratch *scratch, const struct world *world) {
    *scratch = (struct world_scratch){0};
    for (int i = 0; i < WORLD_BLOCKERS; i++)
        scratch->blockers[i] = UINT32_MAX;
    uint32_t need = world->scratch_need > SCRATCH_START ? world->scratch_need : SCRATCH_START;
    return geom_scratch_init(&scratch->geom, need);
}

void world_scratch_destroy(struct world_scratch *scratch) {
    geom_scratch_destroy(&scratch->geom);
}

static struct transform moved(const struct moving *moving, struct shutter shutter, double ray_time) {
    double time = shutter_time(shutter, ray_time);
    struct transform out = moving->link_from_object;
    for (const struct moving_link *link = moving->link; link; link = link->above) {
        struct transform by = motion_at(&link->motion, time);
        out = transform_compose(&by, &out);
        out = transform_compose(&link->above_from_node, &out);
    }
    return out;
}

struct transform world_placement(const struct world *world, uint32_t placed, double ray_time) {
    const struct placed *p = &world->placed[placed];
    if (p->linear == LINEAR_NONE)
        return transform_identity();
    if (p->linear & LINEAR_MOVING)
        return moved(&world->moving[p->linear & ~LINEAR_MOVING], world->shutter, ray_time);
    const struct linear_map *map = &world->linear_maps[p->linear];
    struct transform out;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out.forward.m[i][j] = map->forward[i][j];
            out.inverse.m[i][j] = map->inverse[i][j];
        }
        out.forward.m[i][3] = vec3_get(p->shift, i);
        out.inverse.m[i][3] = vec3_get(p->shift_back, i);
    }
    return out;
}

struct ray world_ray_of_moving(const struct world *world, uint32_t placed, const struct ray *ray) {
    struct transform world_from_object = world_placement(world, placed, ray->time);
    return ray_transform(&world_from_object.inverse, ray);
}

/* Everything that a moving primitive covers while the shutter is open: link by link, so that what the moves of two
 * links have to do with each other is forgotten and the box may be too large, never too small. */
static struct box moving_bounds(const struct shape *shape, const struct moving *moving, struct shutter shutter) {
    struct box box = box_pad(shape_bounds_under(shape, &moving->link_from_object.forward));
    for (const struct moving_link *link = moving->link; link; link = link->above) {
        box = box_pad(motion_bounds(&link->motion, &box, shutter));
        box = box_pad(box_transform(&link->above_from_node.forward, &box));
    }
    return box;
}

/* The tightest box of a mesh looks at all its corners: done for the first placements, until so many triangles have been
 * looked at; the others take the box of the mapped box. Between two of them it is asked whether to stop. */
enum { EXACT_AT_ONCE = 1 << 20, EXACT_IN_ALL = 1 << 22 };

static struct box placed_bounds(const struct world *world, uint32_t placed, uint32_t *exact) {
    const struct shape *shape = placed_shape(world, placed);
    uint32_t linear = world->placed[placed].linear;
    if (linear != LINEAR_NONE && (linear & LINEAR_MOVING))
        return moving_bounds(shape, &world->moving[linear & ~LINEAR_MOVING], world->shutter);
    struct transform world_from_object = world_placement(world, placed, 0);
    uint32_t triangles = shape->kind == SHAPE_MESH ? mesh_triangle_count(shape->mesh) : UINT32_MAX;
    if (linear != LINEAR_NONE && triangles <= EXACT_AT_ONCE && triangles <= *exact) {
        *exact -= triangles;
        return box_pad(mesh_bounds_under(shape->mesh, &world_from_object.forward));
    }
    return box_pad(shape_bounds_under(shape, &world_from_object.forward));
}

static bool place_boxes(struct world *world, const struct box *limits, struct pool *pool, struct error *error) {
    uint32_t exact = EXACT_IN_ALL;
    world->moves = world->moving_count > 0;
    for (uint32_t i = 0; i < world->placed_count; i++) {
        const struct shape *shape = placed_shape(world, i);
        uint32_t before = exact;
        world->boxes[i] = placed_bounds(world, i, &exact);
        if (limits)
            world->boxes[i] = box_meet(world->boxes[i], box_pad(limits[i]));
        if (box_is_empty(&world->boxes[i]))
            world->boxes[i] = box_empty();
        if (before != exact && pool_cancelled(pool))
            return error_set(error, ERROR_CANCELLED, "stopped while the scene was measured");
        if (shape->kind == SHAPE_MESH)
            world->triangles += mesh_triangle_count(shape->mesh);
    }
    for (uint32_t i = 0; i < world->thing_count; i++) {
        uint32_t need = shape_scratch_need(&world->things[i].shape);
        world->scratch_need = need > world->scratch_need ? need : world->scratch_need;
        world->things[i].hull = shape_hull(&world->things[i].shape);
    }
    return true;
}

static void add_up_meshes(struct world *world, const struct assets *assets) {
    for (const struct asset_mesh *entry = assets ? assets->meshes : NULL; entry; entry = entry->next)
        world->mesh_memory += mesh_memory(entry->mesh);
}

static struct box box_of_placed(const void *context, uint32_t i) {
    return ((const struct world *)context)->boxes[i];
}

/* Voxels only where the account is clear: packets and shafts, which the hierarchy alone can answer, are worth about a
 * third of it, and few primitives cost little either way. */
static enum accel_kind choose_frame(const struct world *world) {
    enum { FEW = 1000, SAMPLES = 4096 };
    const double clear = 0.6;
    if (world->accel != ACCEL_AUTO || world->placed_count < FEW)
        return world->accel == ACCEL_AUTO ? ACCEL_BVH : world->accel;
    struct box bounds = box_empty();
    for (uint32_t i = 0; i < world->placed_count; i++) {
        const struct box *box = &world->boxes[i];
        if (!box_is_empty(box) && vec3_finite(box->min) && vec3_finite(box->max))
            bounds = box_join(bounds, *box);
    }
    if (box_is_empty(&bounds))
        return ACCEL_BVH;
    struct frame_census census;
    frame_census_take(&census, &bounds, box_of_placed, world, world->placed_count, SAMPLES, FRAME_LEVELS);
    struct frame_choice cost = frame_lists_or_hierarchy(&census);
    return cost.lists < clear * cost.hierarchy ? ACCEL_GRID : ACCEL_BVH;
}

static bool build_accel(struct world *world, struct pool *pool, struct error *error) {
    world->frame = choose_frame(world);
    switch (world->frame) {
    case ACCEL_GRID:
        return grid_build(&world->grid, world->boxes, world->placed_count, pool, error);
    case ACCEL_AUTO:
    case ACCEL_BVH:
        return box_tree_build(&world->tree, world->boxes, world->placed_count, pool, error);
    case ACCEL_KDTREE:
        return kd_tree_build(&world->kd_tree, world->boxes, world->placed_count, NULL, NULL, pool, error);
    case ACCEL_NONE:
        return true;
    }
    return true;
}

/* Leaves it to the caller to destroy what there is when it fails. */
static bool build(struct world *world, struct arena *arena, struct scene *scene, struct node *root,
                  const struct light *lights, struct pool *pool, world_warning *warn, void *warn_context,
                  struct error *error) {
    uint32_t light_count = world->light_count;
    struct light *copied = arena_alloc_array(arena, light_count, sizeof *copied);
    if (!copied)
        return error_no_memory(error, "the lights of the scene");
    if (light_count)
        memcpy(copied, lights, light_count * sizeof *copied);
    world->lights = copied;
    struct flattening flattening = {.arena = arena,
                                    .scene = scene,
                                    .world = world,
                                    .pool = pool,
                                    .warn = warn,
                                    .warn_context = warn_context,
                                    .error = error};
    if (!flatten_scene(&flattening, root) || !light_lists_resolve(world, copied, arena, root, error) ||
        !light_lamps_resolve(world, copied, arena, root, pool, warn, warn_context, error))
        return false;
    world->boxes = arena_alloc_array(arena, world->placed_count, sizeof *world->boxes);
    if (!world->boxes)
        return error_no_memory(error, "the boxes of the scene");
    world->material_has_image = arena_alloc_array(arena, world->material_count, sizeof *world->material_has_image);
    world->material_has_relief = arena_alloc_array(arena, world->material_count, sizeof *world->material_has_relief);
    if (!world->material_has_image || !world->material_has_relief)
        return error_no_memory(error, "the materials of the scene");
    for (uint32_t i = 0; i < world->material_count; i++) {
        world->material_has_image[i] = material_has_image(world->materials[i]);
        world->material_has_relief[i] = material_has_relief(world->materials[i]);
    }
    if (!place_boxes(world, flattening.limits, pool, error))
        return false;
    add_up_meshes(world, scene->assets);
    return build_accel(world, pool, error);
}

bool world_build(struct world *world, struct arena *arena, struct scene *scene, struct node *root,
                 const struct light *lights, uint32_t light_count, const struct sky *sky, struct shutter shutter,
                 enum accel_kind accel, struct pool *pool, world_warning *warn, void *warn_context,
                 struct error *error) {
    *world = (struct world){.accel = accel, .sky = *sky, .light_count = light_count, .shutter = shutter};
    bool ok = build(world, arena, scene, root, lights, pool, warn, warn_context, error);
    if (!ok)
        world_destroy(world);
    return ok;
}

void world_destroy(struct world *world) {
    mem_free(world->things);
    mem_free(world->linear_maps);
    mem_free(world->moving);
    world->things = NULL;
    world->linear_maps = NULL;
    world->moving = NULL;
    grid_destroy(&world->grid);
    box_tree_destroy(&world->tree);
    kd_tree_destroy(&world->kd_tree);
}

size_t world_placed_memory(const struct world *world) {
    return world->placed_count * (sizeof *world->placed + sizeof *world->boxes) +
           world->thing_count * sizeof *world->things + world->linear_count * sizeof *world->linear_maps +
           world->moving_count * sizeof *world->moving;
}

size_t world_search_memory(const struct world *world) {
    switch (world->frame) {
    case ACCEL_GRID:
        return grid_memory(&world->grid);
    case ACCEL_AUTO:
    case ACCEL_BVH:
        return box_tree_memory(&world->tree);
    case ACCEL_KDTREE:
        return kd_tree_memory(&world->kd_tree);
    case ACCEL_NONE:
        return 0;
    }
    return 0;
}

/* --- searching --- */

struct search {
    const struct world *world;
    const struct ray *ray;
    struct world_scratch *scratch;
    struct box_probe probe;
    struct ray limited; /* the ray with t_max just behind the best answer, so that an equal t is still found */
    /* The best answer, if there is one, and where the next goes: what was just written in pieces is slow to copy. */
    struct crossing *best, *next;
    uint32_t placed;
    bool found;
};

/* Faces that are not seen are passed: the search goes on behind them. */
static bool nearest_of_mesh(const struct world *world, uint32_t index, const struct ray *ray_object,
                            struct geom_scratch *geom, struct crossing *out) {
    const struct thing *thing = placed_thing(world, index);
    bool found = mesh_nearest(thing->shape.mesh, ray_object, world->accel, geom, out);
    if (thing->cull == CULL_NONE)
        return found;
    struct ray rest = *ray_object;
    while (found && out->enter == (thing->cull == CULL_FRONT)) {
        rest.t_min = out->t;
        found = mesh_nearest(thing->shape.mesh, &rest, world->accel, geom, out);
    }
    return found;
}

/* Runs one question about one placed primitive again with more scratch until it fits. */
bool world_ask_nearest(const struct world *world, uint32_t index, const struct ray *ray_object,
                       struct world_scratch *scratch, struct crossing *out) {
    const struct shape *shape = placed_shape(world, index);
    struct geom_scratch *geom = &scratch->geom;
    for (;;) {
        bool found = shape->kind == SHAPE_MESH ? nearest_of_mesh(world, index, ray_object, geom, out)
                                               : shape_nearest(shape, ray_object, geom, out);
        if (!geom->overflow)
            return found;
        if (!geom_scratch_grow(geom)) {
            scratch->failed = true;
            return false;
        }
    }
}

static void try_placed(struct search *s, uint32_t index) {
    if (index + 1 == s->ray->passes)
        return;
    bool as_it_is = s->world->placed[index].linear == LINEAR_NONE;
    struct ray ray_object;
    struct crossing *crossing = s->next;
    if (!as_it_is)
        ray_object = placed_ray(s->world, index, &s->limited);
    if (!world_ask_nearest(s->world, index, as_it_is ? &s->limited : &ray_object, s->scratch, crossing))
        return;
    if (s->found && !(crossing->t < s->best->t || (crossing->t == s->best->t && index < s->placed)))
        return;
    s->next = s->best;
    s->best = crossing;
    s->placed = index;
    s->found = true;
    double just_behind = crossing->t + fabs(crossing->t) * 0x1p-52;
    s->limited.t_max = just_behind < s->ray->t_max ? just_behind : s->ray->t_max;
}

static void try_boxed(struct search *s, uint32_t index) {
    s->scratch->geom.box_tests++;
    if (box_probe_meets(&s->probe, &s->world->boxes[index], s->limited.t_min, s->limited.t_max))
        try_placed(s, index);
}

struct mailbox {
    uint32_t seen[MAILBOX];
};

static bool mailbox_first(struct mailbox *box, uint32_t index) {
    uint32_t *slot = &box->seen[index % MAILBOX];
    if (*slot == index)
        return false;
    *slot = index;
    return true;
}

static void search_grid(struct search *s) {
    struct mailbox mailbox;
    memset(&mailbox, 0xff, sizeof mailbox);
    struct grid_walk walk = {0};
    for (bool go_on = grid_walk_begin(&walk, &s->world->grid, s->ray); go_on; go_on = grid_walk_next(&walk)) {
        for (uint32_t i = 0; i < walk.count; i++) {
            if (mailbox_first(&mailbox, walk.items[i]))
                try_boxed(s, walk.items[i]);
        }
        /* Strictly before the end of the voxel: an equal t may still wait in the next one. */
        if (s->found && s->best->t < walk.t_exit)
            break;
    }
    s->scratch->geom.cost.voxels += walk.voxels;
}

static void search_tree(struct search *s) {
    struct box_tree_walk walk;
    uint32_t index;
    box_tree_walk_begin(&walk, &s->world->tree, s->ray);
    while (box_tree_walk_next(&walk, s->limited.t_max, &index))
        try_placed(s, index);
    s->scratch->geom.cost.hierarchy_steps += walk.steps;
}

/* Boxes are padded, so that the points of their primitives as they are computed lie inside: no slack is needed. */
static void search_kd_tree(struct search *s) {
    struct mailbox mailbox;
    memset(&mailbox, 0xff, sizeof mailbox);
    struct kd_walk walk;
    kd_walk_begin(&walk, &s->world->kd_tree, s->ray, 0);
    while (kd_walk_next(&walk, s->limited.t_max)) {
        for (uint32_t i = 0; i < walk.count; i++) {
            if (mailbox_first(&mailbox, walk.items[i]))
                try_boxed(s, walk.items[i]);
        }
    }
    s->scratch->geom.cost.hierarchy_steps += walk.steps;
    s->scratch->geom.cost.voxels += walk.leaves;
}

bool world_nearest_crossing(const struct world *world, const struct ray *ray, struct world_scratch *scratch,
                            uint32_t *placed, struct crossing *crossing) {
    struct search s;
    struct crossing other;
    s.world = world;
    s.ray = ray;
    s.scratch = scratch;
    s.limited = *ray;
    s.found = false;
    s.placed = 0;
    s.next = crossing;
    s.best = &other;
    if (world->frame != ACCEL_BVH)
        s.probe = box_probe_make(ray); /* the hierarchy has one of its own */
    scratch->rays++;
    switch (world->frame) {
    case ACCEL_AUTO:
    case ACCEL_BVH:
        search_tree(&s);
        break;
    case ACCEL_GRID:
        search_grid(&s);
        break;
    case ACCEL_KDTREE:
        search_kd_tree(&s);
        break;
    case ACCEL_NONE:
        for (uint32_t i = 0; i < world->placed_count; i++)
            try_boxed(&s, i);
        break;
    }
    *placed = s.placed;
    if (s.found && s.best != crossing)
        *crossing = *s.best;
    return s.found;
}

/* --- anything in the way --- */

/* A surface with holes stands in the way where at least half of it is there: shadows have two values. */
static bool any_with_holes(const struct world *world, uint32_t index, const struct ray *ray,
                           struct world_scratch *scratch) {
    struct ray rest = *ray;
    for (;;) {
        struct ray ray_object = placed_ray(world, index, &rest);
        struct crossing crossing;
        struct hit hit;
        struct surface_look look;
        if (!world_ask_nearest(world, index, &ray_object, scratch, &crossing))
            return false;
        world_describe(world, ray, index, &crossing, &hit);
        material_look(world->materials[hit.material], &hit, &look);
        if (look.opacity >= 0.5)
            return true;
        rest.t_min = crossing.t;
    }
}

bool world_ask_any(const struct world *world, uint32_t index, const struct ray *ray, struct world_scratch *scratch) {
    const struct thing *thing = placed_thing(world, index);
    if (index + 1 == ray->passes)
        return false;
    if (thing->holes)
        return any_with_holes(world, index, ray, scratch);
    struct ray ray_object = placed_ray(world, index, ray);
    for (;;) {
        struct crossing ignored;
        bool found = thing->shape.kind == SHAPE_MESH && thing->cull != CULL_NONE
                         ? nearest_of_mesh(world, index, &ray_object, &scratch->geom, &ignored)
                     : thing->shape.kind == SHAPE_MESH
                         ? mesh_any(thing->shape.mesh, &ray_object, world->accel, &scratch->geom)
                         : shape_any(&thing->shape, &ray_object, &scratch->geom);
        if (!scratch->geom.overflow)
            return found;
        if (!geom_scratch_grow(&scratch->geom)) {
            scratch->failed = true;
            return false;
        }
    }
}

static bool any_boxed(const struct world *world, uint32_t index, const struct ray *ray, const struct box_probe *probe,
                      struct world_scratch *scratch) {
    scratch->geom.box_tests++;
    return box_probe_meets(probe, &world->boxes[index], ray->t_min, ray->t_max) &&
           world_ask_any(world, index, ray, scratch);
}

static bool any_in_grid(const struct world *world, const struct ray *ray, const struct box_probe *probe,
                        struct world_scratch *scratch) {
    struct mailbox mailbox;
    memset(&mailbox, 0xff, sizeof mailbox);
    (void)mailbox_first(&mailbox, scratch->blockers[scratch->light]);
    struct grid_walk walk = {0};
    bool found = false;
    for (bool go_on = grid_walk_begin(&walk, &world->grid, ray); go_on && !found; go_on = grid_walk_next(&walk)) {
        for (uint32_t i = 0; i < walk.count && !found; i++) {
            uint32_t index = walk.items[i];
            found = mailbox_first(&mailbox, index) && any_boxed(world, index, ray, probe, scratch);
            if (found)
                scratch->blockers[scratch->light] = index;
        }
        if (found)
            break;
    }
    scratch->geom.cost.voxels += walk.voxels;
    return found;
}

static bool any_in_tree(const struct world *world, const struct ray *ray, struct world_scratch *scratch) {
    struct box_tree_walk walk;
    uint32_t index, asked = scratch->blockers[scratch->light];
    bool found = false;
    box_tree_walk_begin(&walk, &world->tree, ray);
    while (!found && box_tree_walk_any(&walk, ray->t_max, &index)) {
        found = index != asked && world_ask_any(world, index, ray, scratch);
        if (found)
            scratch->blockers[scratch->light] = index;
    }
    scratch->geom.cost.hierarchy_steps += walk.steps;
    return found;
}

static bool any_in_kd_tree(const struct world *world, const struct ray *ray, const struct box_probe *probe,
                           struct world_scratch *scratch) {
    struct mailbox mailbox;
    memset(&mailbox, 0xff, sizeof mailbox);
    (void)mailbox_first(&mailbox, scratch->blockers[scratch->light]);
    struct kd_walk walk;
    bool found = false;
    kd_walk_begin(&walk, &world->kd_tree, ray, 0);
    while (!found && kd_walk_next(&walk, ray->t_max)) {
        for (uint32_t i = 0; i < walk.count && !found; i++) {
            uint32_t index = walk.items[i];
            found = mailbox_first(&mailbox, index) && any_boxed(world, index, ray, probe, scratch);
            if (found)
                scratch->blockers[scratch->light] = index;
        }
    }
    scratch->geom.cost.hierarchy_steps += walk.steps;
    scratch->geom.cost.voxels += walk.leaves;
    return found;
}

bool world_any(const struct world *world, const struct ray *ray, struct world_scratch *scratch) {
    scratch->any_rays++;
    struct box_probe probe = box_probe_make(ray);
    if (world->frame == ACCEL_NONE) {
        for (uint32_t i = 0; i < world->placed_count; i++) {
            if (any_boxed(world, i, ray, &probe, scratch))
                return true;
        }
        return false;
    }
    /* Neighbouring shadow rays mostly end at the same thing: it is asked first. The answer cannot depend on it. */
    uint32_t *blocker = &scratch->blockers[scratch->light];
    if (*blocker < world->placed_count && any_boxed(world, *blocker, ray, &probe, scratch))
        return true;
    bool found = world->frame == ACCEL_KDTREE ? any_in_kd_tree(world, ray, &probe, scratch)
                 : world->frame == ACCEL_GRID ? any_in_grid(world, ray, &probe, scratch)
                                              : any_in_tree(world, ray, scratch);
    *blocker = found ? *blocker : UINT32_MAX;
    return found;
}

/* --- describing --- */

static double row_sum(const struct affine *a, struct vec3 p) {
    double largest = 0;
    for (int i = 0; i < 3; i++) {
        double sum = fabs(a->m[i][0] * p.x) + fabs(a->m[i][1] * p.y) + fabs(a->m[i][2] * p.z) + fabs(a->m[i][3]);
        largest = sum > largest ? sum : largest;
    }
    return largest;
}

/* How far a secondary ray must start off the surface. The point is known up to the surface's own error and the rounding
 * of both transforms; everything scales with the numbers involved, so no length is wired in. map NULL: as it is. */
static double offset_of(const struct transform *map, double scale, const struct surface *surface, struct vec3 point) {
    double mapped = map ? row_sum(&map->forward, surface->point) : vec3_max_abs(surface->point);
    double back = map ? row_sum(&map->inverse, point) * scale : vec3_max_abs(point);
    return 16 * surface->error * scale + (mapped + back) * 0x1p-42;
}

/* What the identity makes of a vector, down to the signs of zeros. */
static struct vec3 as_it_is(struct vec3 v) {
    return vec3_make(v.x + 0 * v.y + 0 * v.z, 0 * v.x + v.y + 0 * v.z, 0 * v.x + 0 * v.y + v.z);
}

/* Normals of most shapes are the same for shading. */
static bool same_vector(const struct vec3 *a, const struct vec3 *b) {
    return memcmp(a, b, sizeof *a) == 0;
}

/* What bumps need: the world's vector of one unit along the operand's normal, and on spheres the tangents that other
 * materials do not ask for. */
static void describe_relief(const struct thing *thing, const struct affine *map, const struct csg_leaf *leaf,
                            struct hit *hit) {
    const struct shape *shape = leaf ? &leaf->shape : &thing->shape;
    struct vec3 normal = vec3_normalize(hit->pattern_normal), raise = normal, u = {0}, v = {0};
    if (hit->on_sphere)
        sphere_tangents(shape->sphere.radius, normal, &u, &v);
    if (leaf) {
        const struct affine *csg_from_leaf = &leaf->csg_from_leaf.forward;
        raise = affine_vector(csg_from_leaf, raise);
        u = affine_vector(csg_from_leaf, u);
        v = affine_vector(csg_from_leaf, v);
    }
    raise = affine_vector(map, raise);
    /* The hollow that an operand leaves has its outside in the operand. */
    hit->raise = vec3_dot(raise, hit->normal_geometric) < 0 ? vec3_negate(raise) : raise;
    if (hit->on_sphere) {
        hit->dpdu = affine_vector(map, u);
        hit->dpdv = affine_vector(map, v);
    }
}

static double stretch_of(const struct world *world, uint32_t index, const struct transform *map) {
    uint32_t linear = world->placed[index].linear;
    return linear & LINEAR_MOVING ? transform_stretch(map) : world->linear_maps[linear].stretch;
}

static enum hit_hull hull_of(const struct thing *thing, const struct csg_leaf *leaf, const struct crossing *crossing) {
    if (!leaf)
        return thing->hull;
    return thing->shape.csg->hull[crossing->leaf] && !crossing->flip ? HULL_BEHIND : HULL_NONE;
}

/* The surface of an object in the world; map NULL: the object's space is the world. Every field of the hit is written
 * once: clearing it as a whole would take longer than all the rest. */
static void place_surface(const struct surface *surface, const struct transform *map, struct hit *hit) {
    const struct vec3 zero = {0, 0, 0};
    if (map) {
        hit->point = affine_point(&map->forward, surface->point);
        hit->normal_geometric = vec3_normalize(transform_normal(map, surface->normal));
    } else {
        hit->point = vec3_add(as_it_is(surface->point), zero);
        hit->normal_geometric = vec3_normalize(as_it_is(surface->normal));
    }
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
    hit->dpdu = hit->dpdv = hit->raise = zero;
    if (surface->has_uv) {
        hit->dpdu = map ? affine_vector(&map->forward, surface->dpdu) : as_it_is(surface->dpdu);
        hit->dpdv = map ? affine_vector(&map->forward, surface->dpdv) : as_it_is(surface->dpdv);
    }
    hit->has_colour = surface->has_colour;
    hit->colour = surface->colour;
    hit->leaf = surface->leaf;
}

/* How the ray's cone falls on patterns, where a picture asks. */
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
    return fmax(vec3_length(a), vec3_length(b));
}

void world_describe(const struct world *world, const struct ray *ray, uint32_t index, const struct crossing *crossing,
                    struct hit *hit) {
    const struct thing *thing = placed_thing(world, index);
    struct transform world_from_object;
    struct ray ray_object;
    const struct transform *map = NULL;
    const struct ray *own_ray = ray;
    if (world->placed[index].linear != LINEAR_NONE) {
        world_from_object = world_placement(world, index, ray->time);
        ray_object = ray_transform(&world_from_object.inverse, ray);
        map = &world_from_object;
        own_ray = &ray_object;
    }
    struct surface surface;
    shape_describe(&thing->shape, own_ray, crossing, &surface);
    double length = vec3_length(ray->direction);
    bool in_csg = thing->shape.kind == SHAPE_CSG;
    const struct csg_leaf *leaf = in_csg ? &thing->shape.csg->leaves[surface.leaf] : NULL;
    uint32_t material = in_csg ? leaf->material : thing->material;
    uint32_t slot_count = in_csg ? leaf->slot_count : thing->slot_count;
    if (surface.material_slot < slot_count)
        material += surface.material_slot;
    enum shape_kind kind = in_csg ? leaf->shape.kind : thing->shape.kind;
    place_surface(&surface, map, hit);
    hit->t = crossing->t;
    hit->view = vec3_scale(ray->direction, -1 / length);
    hit->placed = index;
    hit->part = crossing->part;
    hit->material = material;
    hit->hull = hull_of(thing, leaf, crossing);
    hit->on_sphere = kind == SHAPE_SPHERE;
    hit->on_box = kind == SHAPE_BOX;
    hit->time = ray->time;
    if (world->material_has_relief[material]) {
        if (!map)
            world_from_object = transform_identity();
        describe_relief(thing, &world_from_object.forward, leaf, hit);
    }
    hit->front = vec3_dot(hit->view, hit->normal_geometric) >= 0;
    hit->offset = offset_of(map, map ? stretch_of(world, index, map) : 1, &surface, hit->point);
    hit->footprint = ray->footprint.width + ray->footprint.spread * crossing->t * length;
    hit->pattern_scale = 0;
    if (hit->footprint > 0 && world->material_has_image[material])
        hit->pattern_scale = pattern_scale(map, leaf, hit->normal_geometric);
}

bool world_nearest(const struct world *world, const struct ray *ray, struct world_scratch *scratch, struct hit *hit) {
    uint32_t placed;
    struct crossing crossing;
    if (!world_nearest_crossing(world, ray, scratch, &placed, &crossing))
        return false;
    world_describe(world, ray, placed, &crossing, hit);
    return true;
}

/* Such a solid holds what is outside of its box. */
static bool is_inside_out(const struct shape *shape) {
    return shape->kind == SHAPE_CSG && shape->csg->inside_out;
}

uint32_t world_closed_in(const struct world *world, const struct box *region, uint32_t *out, uint32_t limit) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < world->placed_count; i++) {
        struct box common = box_meet(world->boxes[i], *region);
        const struct shape *shape = placed_shape(world, i);
        if ((box_is_empty(&common) && !is_inside_out(shape)) || !shape_is_closed(shape))
            continue;
        if (out && count < limit)
            out[count] = i;
        count++;
    }
    return count;
}

static bool contains(const struct world *world, uint32_t index, struct vec3 p_object, struct world_scratch *scratch) {
    const struct shape *shape = placed_shape(world, index);
    bool inside = shape_contains(shape, p_object, &scratch->geom);
    while (scratch->geom.overflow && geom_scratch_grow(&scratch->geom))
        inside = shape_contains(shape, p_object, &scratch->geom);
    scratch->failed = scratch->failed || scratch->geom.overflow;
    return inside && !scratch->geom.overflow;
}

uint32_t world_containing(const struct world *world, struct vec3 point, double ray_time, const uint32_t *candidates,
                          uint32_t candidate_count, struct world_scratch *scratch, uint32_t *placed, uint32_t limit) {
    struct ray ray = {.origin = point, .direction = {0.5377, 0.6212, 0.5698}, .t_max = INFINITY, .time = ray_time};
    uint32_t count = 0;
    double ends[WORLD_NESTING];
    limit = limit < WORLD_NESTING ? limit : WORLD_NESTING;
    for (uint32_t k = 0; k < candidate_count; k++) {
        uint32_t i = candidates[k];
        if (!box_contains(&world->boxes[i], point) && !is_inside_out(placed_shape(world, i)))
            continue;
        struct ray ray_object = placed_ray(world, i, &ray);
        if (!contains(world, i, ray_object.origin, scratch))
            continue;
        /* Innermost last: the solid the ray leaves first is the innermost. */
        struct crossing crossing = {.t = INFINITY};
        (void)world_ask_nearest(world, i, &ray_object, scratch, &crossing);
        uint32_t at = count;
        while (at > 0 && ends[at - 1] < crossing.t)
            at--;
        if (count < limit) {
            memmove(placed + at + 1, placed + at, (count - at) * sizeof *placed);
            memmove(ends + at + 1, ends + at, (count - at) * sizeof *ends);
            count++;
        } else if (at > 0) {
            at--; /* the outermost falls off */
            memmove(placed, placed + 1, at * sizeof *placed);
            memmove(ends, ends + 1, at * sizeof *ends);
        } else {
            continue;
        }
        placed[at] = i;
        ends[at] = crossing.t;
    }
    return count;
}
