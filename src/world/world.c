/* Nearest hit and any hit: one traversal of the accelerator, compiled for both searches, with the same tests of
 * primitives. A primitive in several cells is tested once per ray: a small mailbox remembers it. */
#include "world/world_internal.h"

#include "base/mem.h"
#include "material/material_eval.h"
#include "world/device_search.h"
#include "world/flatten_internal.h"
#include "world/flatten_material_internal.h"
#include "world/joint.h"
#include "world/mesh_lights_internal.h"
#include "world/solids_internal.h"
#include "world/world.h"
#include "world/world_cache.h"
#include "world/world_describe.h"

#include <string.h>

enum { MAILBOX = 32, SCRATCH_START = 256 };

bool world_scratch_init(struct world_scratch *scratch, const struct world *world) {
    *scratch = (struct world_scratch){0};
    for (int i = 0; i < WORLD_SHADOW_CACHE; i++)
        scratch->shadow_cache[i] = WORLD_NOTHING;
    uint32_t need = world->scratch_need > SCRATCH_START ? world->scratch_need : SCRATCH_START;
    return geom_scratch_init(&scratch->geom, need);
}

void world_scratch_destroy(struct world_scratch *scratch) {
    geom_scratch_destroy(&scratch->geom);
}

/* --- one primitive --- */

/* Culled faces are skipped: the search continues behind them. */
static bool nearest_of_mesh(const struct world *world, uint32_t index, const struct ray *ray_object,
                            struct geom_scratch *geom, struct crossing *out) {
    const struct prototype *prototype = primitive_prototype(world, index);
    const struct mesh *mesh = prototype->geometry.shape.mesh;
    if (ray_object->skip_part > 0 && index + 1 == ray_object->skip_primitive && prototype->cull == CULL_NONE)
        return mesh_nearest_but(mesh, ray_object, ray_object->skip_part - 1, world->mesh_accel, geom, out);
    bool found = mesh_nearest(mesh, ray_object, world->mesh_accel, geom, out);
    if (prototype->cull == CULL_NONE)
        return found;
    struct ray rest = *ray_object;
    while (found && out->enter == (prototype->cull == CULL_FRONT)) {
        rest.t_min = out->t;
        found = mesh_nearest(mesh, &rest, world->mesh_accel, geom, out);
    }
    return found;
}

static bool any_of_mesh(const struct mesh *mesh, uint32_t index, const struct ray *ray_object, enum accel_kind accel,
                        struct geom_scratch *geom) {
    if (ray_object->skip_part > 0 && index + 1 == ray_object->skip_primitive)
        return mesh_any_but(mesh, ray_object, ray_object->skip_part - 1, accel, geom);
    return mesh_any(mesh, ray_object, accel, geom);
}

/* Repeats a query of one primitive with more scratch memory until it fits; meshes need none. */
bool world_ask_nearest(const struct world *world, uint32_t index, const struct ray *ray_object,
                       struct world_scratch *scratch, struct crossing *out) {
    const struct geometry *geometry = primitive_geometry(world, index);
    struct geom_scratch *geom = &scratch->geom;
    if (geometry_mesh(geometry))
        return nearest_of_mesh(world, index, ray_object, geom, out);
    for (;;) {
        bool found = geometry_nearest(geometry, ray_object, geom, out);
        if (!geom->overflow)
            return found;
        if (!geom_scratch_grow(geom)) {
            scratch->failed = true;
            return false;
        }
    }
}

/* A surface with holes occludes where its opacity is at least one half: shadows are binary. */
static bool any_with_holes(const struct world *world, uint32_t index, const struct ray *ray,
                           struct world_scratch *scratch) {
    struct ray rest = *ray;
    for (;;) {
        struct ray ray_object = primitive_ray(world, index, &rest);
        struct crossing crossing;
        struct hit hit;
        struct bsdf bsdf;
        if (!world_ask_nearest(world, index, &ray_object, scratch, &crossing))
            return false;
        world_describe(world, ray, index, &crossing, &hit);
        material_eval(&world->surfaces, &hit, NULL, NULL, &bsdf);
        if (bsdf.opacity >= 0.5)
            return true;
        rest.t_min = crossing.t;
    }
}

bool world_ask_any(const struct world *world, uint32_t index, const struct ray *ray, struct world_scratch *scratch) {
    const struct prototype *prototype = primitive_prototype(world, index);
    if (ray_skips(ray, index))
        return false;
    if (prototype->holes)
        return any_with_holes(world, index, ray, scratch);
    struct ray ray_object = primitive_ray(world, index, ray);
    const struct mesh *mesh = geometry_mesh(&prototype->geometry);
    for (;;) {
        struct crossing ignored;
        bool found = mesh && prototype->cull != CULL_NONE
                         ? nearest_of_mesh(world, index, &ray_object, &scratch->geom, &ignored)
                     : mesh ? any_of_mesh(mesh, index, &ray_object, world->mesh_accel, &scratch->geom)
                            : geometry_any(&prototype->geometry, &ray_object, &scratch->geom);
        if (!scratch->geom.overflow)
            return found;
        if (!geom_scratch_grow(&scratch->geom)) {
            scratch->failed = true;
            return false;
        }
    }
}

/* --- the accelerator --- */

#ifdef GRAY_DEVICE /* worlds are those of bundles */

bool world_nearest_crossing(const struct world *world, const struct ray *ray, struct world_scratch *scratch,
                            uint32_t *primitive, struct crossing *crossing) {
    scratch->rays++;
    return device_search_crossing(&(struct device_query){world, ray, scratch}, primitive, crossing);
}

bool world_any(const struct world *world, const struct ray *ray, struct world_scratch *scratch) {
    scratch->any_rays++;
    return device_search_any(world, ray, scratch);
}

#else

/* Always a constant where it is passed, so that each search is compiled without the other. */
enum search_mode { SEARCH_NEAREST, SEARCH_ANY };
#define FOR_EACH_MODE static inline __attribute__((always_inline))

struct search {
    const struct world *world;
    const struct ray *ray;
    struct world_scratch *scratch;
    struct box_probe probe; /* not for the hierarchy, which has one of its own */
    bool found;
    uint32_t
        primitive; /* the primitive that was found; for SEARCH_ANY before that: one already tested, or WORLD_NOTHING */
    /* SEARCH_NEAREST: */
    struct ray limited; /* the ray with t_max just after the best hit, so that an equal t is still found */
    /* The best hit, if there is one, and the slot for the next: copying a struct just written in pieces is slow. */
    struct crossing *best, *next;
};

/* Keeps the crossing in the slot `next`, unless the best one is nearer. */
static void keep_nearest(struct search *s, uint32_t index) {
    struct crossing *crossing = s->next;
    if (s->found && !(crossing->t < s->best->t || (crossing->t == s->best->t && index < s->primitive)))
        return;
    s->next = s->best;
    s->best = crossing;
    s->primitive = index;
    s->found = true;
    double just_behind = crossing->t + fabs(crossing->t) * 0x1p-52;
    s->limited.t_max = just_behind < s->ray->t_max ? just_behind : s->ray->t_max;
}

static void try_nearest(struct search *s, uint32_t index) {
    if (ray_skips(s->ray, index))
        return;
    bool as_it_is = s->world->primitives[index].linear == LINEAR_NONE;
    struct ray ray_object;
    if (!as_it_is)
        ray_object = primitive_ray(s->world, index, &s->limited);
    if (world_ask_nearest(s->world, index, as_it_is ? &s->limited : &ray_object, s->scratch, s->next))
        keep_nearest(s, index);
}

/* Tests one primitive. True: the search is over. */
FOR_EACH_MODE bool try_primitive(struct search *s, uint32_t index, enum search_mode mode) {
    if (mode == SEARCH_NEAREST) {
        try_nearest(s, index);
        return false;
    }
    if (!world_ask_any(s->world, index, s->ray, s->scratch))
        return false;
    s->primitive = index;
    return s->found = true;
}

/* The current end of the ray. */
FOR_EACH_MODE double search_end(const struct search *s, enum search_mode mode) {
    return mode == SEARCH_NEAREST ? s->limited.t_max : s->ray->t_max;
}

FOR_EACH_MODE bool try_boxed(struct search *s, uint32_t index, enum search_mode mode) {
    s->scratch->geom.box_tests++;
    return box_probe_meets(&s->probe, &s->world->boxes[index], s->ray->t_min, search_end(s, mode)) &&
           try_primitive(s, index, mode);
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

FOR_EACH_MODE void mailbox_begin(struct mailbox *box, const struct search *s, enum search_mode mode) {
    memset(box, 0xff, sizeof *box);
    if (mode == SEARCH_ANY)
        (void)mailbox_first(box, s->primitive);
}

FOR_EACH_MODE bool try_list(struct search *s, const uint32_t *items, uint32_t count, struct mailbox *mailbox,
                            enum search_mode mode) {
    for (uint32_t i = 0; i < count; i++) {
        if (mailbox_first(mailbox, items[i]) && try_boxed(s, items[i], mode))
            return true;
    }
    return false;
}

FOR_EACH_MODE void search_grid(struct search *s, enum search_mode mode) {
    struct mailbox mailbox;
    s->probe = box_probe_make(s->ray);
    mailbox_begin(&mailbox, s, mode);
    struct grid_traversal traversal = {0};
    for (bool go_on = grid_traversal_begin(&traversal, &s->world->accel.grid, s->ray); go_on;
         go_on = grid_traversal_next(&traversal)) {
        if (try_list(s, traversal.items, traversal.count, &mailbox, mode))
            break;
        /* Strictly before the end of the voxel: an equal t may still wait in the next one. */
        if (mode == SEARCH_NEAREST && s->found && s->best->t < traversal.t_exit)
            break;
    }
    s->scratch->geom.cost.voxels += traversal.voxels;
}

/* Searches all members of the group together. */
static bool nearest_of_group(const struct world *world, const struct ray *ray, struct geom_scratch *geom,
                             uint32_t *primitive, struct crossing *out) {
    const struct mesh_group *group = &world->group;
    geom->shape_tests++;
    if (!triangle_index_nearest_but(group->index, &group->set, ray, mesh_group_skipped(group, ray), &out->on_mesh,
                                    &geom->cost))
        return false;
    uint32_t index = group->primitive[out->part];
    out->part -= group->first[index];
    out->leaf = 0;
    out->flip = false;
    *primitive = index;
    return true;
}

static bool any_of_group(const struct world *world, const struct ray *ray, struct geom_scratch *geom,
                         uint32_t *primitive) {
    const struct mesh_group *group = &world->group;
    uint32_t triangle;
    geom->shape_tests++;
    if (!triangle_index_any_but(group->index, &group->set, ray, mesh_group_skipped(group, ray), &triangle, &geom->cost))
        return false;
    *primitive = group->primitive[triangle];
    return true;
}

/* True: an occluder. */
FOR_EACH_MODE bool search_group(struct search *s, enum search_mode mode) {
    uint32_t index;
    if (mode == SEARCH_ANY)
        return s->found = any_of_group(s->world, s->ray, &s->scratch->geom, &s->primitive);
    if (nearest_of_group(s->world, &s->limited, &s->scratch->geom, &index, s->next))
        keep_nearest(s, index);
    return false;
}

/* Whether all primitives are members: then nothing else is searched. */
static bool is_group_only(const struct world *world) {
    return world->group.index && world->group.rest.item_count == 0;
}

FOR_EACH_MODE void search_tree(struct search *s, enum search_mode mode) {
    struct box_tree_traversal traversal;
    uint32_t index, tested = s->primitive;
    const struct box_tree *tree = &s->world->accel.tree;
    if (s->world->group.index) {
        tree = &s->world->group.rest;
        if (search_group(s, mode) || tree->item_count == 0)
            return;
    }
    box_tree_traversal_begin(&traversal, tree, s->ray);
    while (mode == SEARCH_NEAREST ? box_tree_traversal_next(&traversal, search_end(s, mode), &index)
                                  : box_tree_traversal_any(&traversal, search_end(s, mode), &index)) {
        if ((mode == SEARCH_NEAREST || index != tested) && try_primitive(s, index, mode))
            break;
    }
    s->scratch->geom.cost.hierarchy_steps += traversal.steps;
}

/* Boxes are padded so that they contain the computed points of their primitives: no slack is needed. */
FOR_EACH_MODE void search_kd_tree(struct search *s, enum search_mode mode) {
    struct mailbox mailbox;
    s->probe = box_probe_make(s->ray);
    mailbox_begin(&mailbox, s, mode);
    struct kd_traversal traversal;
    kd_traversal_begin(&traversal, &s->world->accel.kd_tree, s->ray, 0);
    while (kd_traversal_next(&traversal, search_end(s, mode))) {
        if (try_list(s, traversal.items, traversal.count, &mailbox, mode))
            break;
    }
    s->scratch->geom.cost.hierarchy_steps += traversal.steps;
    s->scratch->geom.cost.voxels += traversal.leaves;
}

/* The reference for the others: it has no state, so it does not store an occluder. */
FOR_EACH_MODE void search_all(struct search *s, enum search_mode mode) {
    s->probe = box_probe_make(s->ray);
    for (uint32_t i = 0; i < s->world->primitive_count; i++) {
        if (try_boxed(s, i, mode)) {
            s->primitive = WORLD_NOTHING;
            return;
        }
    }
}

/* The world of a bundle. */
FOR_EACH_MODE void search_for_device(struct search *s, enum search_mode mode) {
    if (mode == SEARCH_NEAREST) {
        s->best = s->next;
        s->found = device_search_crossing(&(struct device_query){s->world, s->ray, s->scratch}, &s->primitive, s->best);
        return;
    }
    s->found = device_search_any(s->world, s->ray, s->scratch);
    s->primitive = WORLD_NOTHING;
}

FOR_EACH_MODE void search_accel(struct search *s, enum search_mode mode) {
    switch (s->world->accel.kind) {
    case ACCEL_AUTO:
    case ACCEL_BVH:
        search_tree(s, mode);
        return;
    case ACCEL_GRID:
        search_grid(s, mode);
        return;
    case ACCEL_KDTREE:
        search_kd_tree(s, mode);
        return;
    case ACCEL_NONE:
        if (s->world->device)
            search_for_device(s, mode);
        else
            search_all(s, mode);
        return;
    }
}

bool world_nearest_crossing(const struct world *world, const struct ray *ray, struct world_scratch *scratch,
                            uint32_t *primitive, struct crossing *crossing) {
    struct search s;
    struct crossing other;
    scratch->rays++;
    if (is_group_only(world))
        return nearest_of_group(world, ray, &scratch->geom, primitive, crossing);
    s.world = world;
    s.ray = ray;
    s.scratch = scratch;
    s.limited = *ray;
    s.found = false;
    s.primitive = 0;
    s.next = crossing;
    s.best = &other;
    search_accel(&s, SEARCH_NEAREST);
    *primitive = s.primitive;
    if (s.found && s.best != crossing)
        *crossing = *s.best;
    return s.found;
}

bool world_any(const struct world *world, const struct ray *ray, struct world_scratch *scratch) {
    /* Neighbouring shadow rays mostly have the same occluder: it is tested first. The result does not depend on it. */
    uint32_t *blocker = &scratch->shadow_cache[scratch->light];
    scratch->any_rays++;
    if (is_group_only(world)) {
        *blocker = WORLD_NOTHING;
        return any_of_group(world, ray, &scratch->geom, blocker);
    }
    struct search s;
    s.world = world;
    s.ray = ray;
    s.scratch = scratch;
    s.found = false;
    s.primitive = *blocker;
    /* Searching a group takes about as long as searching one member. */
    bool known =
        *blocker < world->primitive_count && !(world->group.index && mesh_group_run(&world->group, *blocker).count > 0);
    if (known)
        s.probe = box_probe_make(ray);
    if (!known || !try_boxed(&s, *blocker, SEARCH_ANY))
        search_accel(&s, SEARCH_ANY);
    *blocker = s.found ? s.primitive : WORLD_NOTHING;
    return s.found;
}

#endif

bool world_nearest_of(const struct world *world, uint32_t primitive, const struct ray *ray,
                      struct world_scratch *scratch, struct crossing *crossing) {
    struct ray ray_object = primitive_ray(world, primitive, ray);
    scratch->rays++;
    return !ray_skips(ray, primitive) && world_ask_nearest(world, primitive, &ray_object, scratch, crossing);
}

bool world_nearest(const struct world *world, const struct ray *ray, struct world_scratch *scratch, struct hit *hit) {
    struct joint joint;
    return world_nearest_surface(world, ray, scratch, hit) &&
           (!world_touches(world, hit) || world_join(world, ray, scratch, hit, &joint));
}

void world_medium_stack(const struct world *world, const struct inside_query *query, struct world_scratch *scratch,
                        struct medium_stack *out) {
    uint32_t inside[MEDIUM_STACK_LIMIT];
    uint32_t count = world_containing(world, query, scratch, inside, MEDIUM_STACK_LIMIT);
    out->media = &world->media;
    out->count = 0;
    out->wavelength = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct prototype *prototype = primitive_prototype(world, inside[i]);
        uint32_t material = prototype->geometry.csg ? prototype->geometry.csg->leaves[0].material : prototype->material;
        if (!prototype->is_thin && world->material_has_medium[material])
            medium_stack_enter(out, world_solid(world, inside[i], material));
    }
}

/* The closed primitives that can contain a point, and those that do. */

/* Such a solid contains the points outside its box. */
static bool is_inside_out(const struct geometry *geometry) {
    return geometry->csg && geometry->csg->inside_out;
}

struct box world_finite_bounds(const struct world *world) {
    struct box bounds = box_empty();
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        if (vec3_finite(world->boxes[i].min) && vec3_finite(world->boxes[i].max))
            bounds = box_join(bounds, world->boxes[i]);
    }
    return bounds;
}

static bool any_slot(const struct world *world, uint32_t first, uint32_t slots, material_test *test) {
    bool any = false;
    for (uint32_t i = first; !any && i < first + (slots > 1 ? slots : 1); i++)
        any = test(world, i);
    return any;
}

bool primitive_has_material(const struct world *world, uint32_t primitive, material_test *test) {
    const struct prototype *prototype = primitive_prototype(world, primitive);
    const struct csg *csg = prototype->geometry.csg;
    bool any = !csg && any_slot(world, prototype->material, prototype->slot_count, test);
    for (uint32_t i = 0; csg && !any && i < csg->leaf_count; i++)
        any = any_slot(world, csg->leaves[i].material, csg->leaves[i].slot_count, test);
    return any;
}

uint32_t world_closed_in(const struct world *world, const struct box *region, uint32_t *out, uint32_t limit) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        struct box common = box_meet(world->boxes[i], *region);
        const struct geometry *geometry = primitive_geometry(world, i);
        if ((box_is_empty(&common) && !is_inside_out(geometry)) || !geometry_is_closed(geometry))
            continue;
        if (out && count < limit)
            out[count] = i;
        count++;
    }
    return count;
}

static bool contains(const struct world *world, uint32_t index, struct vec3 p_object, struct world_scratch *scratch) {
    const struct geometry *geometry = primitive_geometry(world, index);
    bool inside = geometry_contains(geometry, p_object, &scratch->geom);
    while (scratch->geom.overflow && geom_scratch_grow(&scratch->geom))
        inside = geometry_contains(geometry, p_object, &scratch->geom);
    scratch->failed = scratch->failed || scratch->geom.overflow;
    return inside && !scratch->geom.overflow;
}

uint32_t world_containing(const struct world *world, const struct inside_query *query, struct world_scratch *scratch,
                          uint32_t *primitive, uint32_t limit) {
    struct vec3 point = query->point;
    struct ray ray = {
        .origin = point, .direction = {0.5377, 0.6212, 0.5698}, .t_max = INFINITY, .time = query->ray_time};
    uint32_t count = 0;
    double ends[WORLD_NESTING];
    limit = limit < WORLD_NESTING ? limit : WORLD_NESTING;
    for (uint32_t k = 0; k < query->count; k++) {
        uint32_t i = query->candidates[k];
        if (!box_contains(&world->boxes[i], point) && !is_inside_out(primitive_geometry(world, i)))
            continue;
        struct ray ray_object = primitive_ray(world, i, &ray);
        if (!contains(world, i, ray_object.origin, scratch))
            continue;
        /* Innermost last: the solid the ray leaves first is the innermost. */
        struct crossing crossing = {.t = INFINITY};
        (void)world_ask_nearest(world, i, &ray_object, scratch, &crossing);
        uint32_t at = count;
        while (at > 0 && ends[at - 1] < crossing.t)
            at--;
        if (count < limit) {
            memmove(primitive + at + 1, primitive + at, (count - at) * sizeof *primitive);
            memmove(ends + at + 1, ends + at, (count - at) * sizeof *ends);
            count++;
        } else if (at > 0) {
            at--; /* the outermost is dropped */
            memmove(primitive, primitive + 1, at * sizeof *primitive);
            memmove(ends, ends + 1, at * sizeof *ends);
        } else {
            continue;
        }
        primitive[at] = i;
        ends[at] = crossing.t;
    }
    return count;
}

/* --- poses --- */

/* Poses of primitives: their maps, at a time if they move, and their boxes in the world. */

static struct transform moved(const struct world *world, const struct moving *moving, double ray_time) {
    double time = shutter_time(world->shutter, ray_time);
    struct transform out = moving->link_from_object;
    for (uint32_t number = moving->link; number != LINK_NONE; number = world->links[number].above) {
        const struct moving_link *link = &world->links[number];
        struct transform by = motion_at(&link->motion, time);
        out = transform_compose(&by, &out);
        out = transform_compose(&link->above_from_node, &out);
    }
    return out;
}

struct transform world_placement(const struct world *world, uint32_t primitive, double ray_time) {
    const struct primitive *p = &world->primitives[primitive];
    if (p->linear == LINEAR_NONE)
        return transform_identity();
    if (p->linear & LINEAR_MOVING)
        return moved(world, &world->moving[p->linear & ~LINEAR_MOVING], ray_time);
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

struct ray world_ray_of_moving(const struct world *world, uint32_t primitive, const struct ray *ray) {
    struct transform world_from_object = world_placement(world, primitive, ray->time);
    return ray_transform(&world_from_object.inverse, ray);
}

/* The box of everything that a moving primitive covers while the shutter is open: link by link, ignoring how the
 * motions of two links depend on each other, so the box may be too large, never too small. */
static struct box moving_bounds(const struct world *world, const struct geometry *geometry,
                                const struct moving *moving) {
    struct box box = box_pad(geometry_bounds_under(geometry, &moving->link_from_object.forward));
    for (uint32_t number = moving->link; number != LINK_NONE; number = world->links[number].above) {
        const struct moving_link *link = &world->links[number];
        box = box_pad(motion_bounds(&link->motion, &box, world->shutter));
        box = box_pad(box_transform(&link->above_from_node.forward, &box));
    }
    return box;
}

/* The tightest box of a mesh looks at all its corners: done for the first placements, until so many triangles have been
 * looked at; the others take the box of the mapped box. Polls for cancellation between two of them. */
enum { EXACT_AT_ONCE = 1 << 20, EXACT_IN_ALL = 1 << 22 };

static struct box primitive_bounds(const struct world *world, uint32_t primitive, uint32_t *exact) {
    const struct geometry *geometry = primitive_geometry(world, primitive);
    uint32_t linear = world->primitives[primitive].linear;
    if (linear != LINEAR_NONE && (linear & LINEAR_MOVING))
        return moving_bounds(world, geometry, &world->moving[linear & ~LINEAR_MOVING]);
    struct transform world_from_object = world_placement(world, primitive, 0);
    const struct mesh *mesh = geometry_mesh(geometry);
    uint32_t triangles = mesh ? mesh_triangle_count(mesh) : UINT32_MAX;
    if (linear != LINEAR_NONE && triangles <= EXACT_AT_ONCE && triangles <= *exact) {
        *exact -= triangles;
        return box_pad(mesh_bounds_under(mesh, &world_from_object.forward));
    }
    return box_pad(geometry_bounds_under(geometry, &world_from_object.forward));
}

bool world_update_box(struct world *world, uint32_t primitive) {
    bool exact = world->triangles <= EXACT_IN_ALL; /* then those of all meshes are, up to EXACT_AT_ONCE */
    uint32_t at_once = EXACT_AT_ONCE;
    if (!exact && geometry_mesh(primitive_geometry(world, primitive)))
        return false;
    struct box box = primitive_bounds(world, primitive, &at_once);
    world->boxes[primitive] = box_is_empty(&box) ? box_empty() : box;
    return true;
}

/* What a run over chunks of primitives and prototypes finds. */
enum { CHUNK = 4096 };
struct box_chunk {
    uint32_t scratch_need;
    bool has_meshes; /* their boxes are still to be made: they share EXACT_IN_ALL, in order */
};
struct box_run {
    struct world *world;
    const struct box *limits; /* or NULL */
    uint32_t chunks;          /* of primitives; those of prototypes follow */
    struct box_chunk *found;
};

static void set_box(const struct box_run *run, uint32_t primitive, struct box box) {
    if (run->limits)
        box = box_meet(box, box_pad(run->limits[primitive]));
    run->world->boxes[primitive] = box_is_empty(&box) ? box_empty() : box;
}

static uint32_t chunk_end(uint32_t chunk, uint32_t count) {
    return count - chunk * CHUNK < CHUNK ? count : (chunk + 1) * CHUNK;
}

static void measure_primitives(const struct box_run *run, uint32_t chunk) {
    const struct world *world = run->world;
    for (uint32_t i = chunk * CHUNK; i < chunk_end(chunk, world->primitive_count); i++) {
        uint32_t no_mesh = 0;
        if (geometry_mesh(primitive_geometry(world, i)))
            run->found[chunk].has_meshes = true;
        else
            set_box(run, i, primitive_bounds(world, i, &no_mesh));
    }
}

static void measure_prototypes(const struct box_run *run, uint32_t chunk) {
    struct world *world = run->world;
    uint32_t *need = &run->found[run->chunks + chunk].scratch_need;
    for (uint32_t i = chunk * CHUNK; i < chunk_end(chunk, world->prototype_count); i++) {
        uint32_t own = geometry_scratch_need(&world->prototypes[i].geometry);
        *need = own > *need ? own : *need;
        world->prototypes[i].convexity = geometry_convexity(&world->prototypes[i].geometry);
    }
}

static void measure_chunk(void *context, uint32_t item, int worker) {
    const struct box_run *run = context;
    (void)worker;
    if (item < run->chunks)
        measure_primitives(run, item);
    else
        measure_prototypes(run, item - run->chunks);
}

static bool measure_meshes(const struct box_run *run, uint32_t chunk, uint32_t *exact, const struct pool *pool) {
    struct world *world = run->world;
    for (uint32_t i = chunk * CHUNK; i < chunk_end(chunk, world->primitive_count); i++) {
        const struct mesh *mesh = geometry_mesh(primitive_geometry(world, i));
        uint32_t before = *exact;
        if (!mesh)
            continue;
        set_box(run, i, primitive_bounds(world, i, exact));
        world->triangles += mesh_triangle_count(mesh);
        if (before != *exact && pool_cancelled(pool))
            return false;
    }
    return true;
}

/* Small scenes are measured by this thread. */
static bool measure_all(const struct box_run *run, uint32_t items, struct pool *pool) {
    struct box_run own = *run;
    uint32_t exact = EXACT_IN_ALL;
    bool ok = true;
    if (items > 2)
        ok = pool_run(pool, items, measure_chunk, &own);
    else
        for (uint32_t item = 0; item < items; item++)
            measure_chunk(&own, item, 0);
    for (uint32_t chunk = 0; ok && chunk < run->chunks; chunk++)
        ok = !run->found[chunk].has_meshes || measure_meshes(run, chunk, &exact, pool);
    return ok;
}

bool world_primitive_boxes(struct world *world, const struct box *limits, struct pool *pool, struct error *error) {
    uint32_t chunks = (world->primitive_count + CHUNK - 1) / CHUNK;
    uint32_t items = chunks + (world->prototype_count + CHUNK - 1) / CHUNK;
    const struct box_run run = {world, limits, chunks, mem_alloc_zero((size_t)items + 1, sizeof *run.found)};
    world->moves = world->moving_count > 0;
    if (!run.found)
        return error_no_memory(error, "the boxes of the scene");
    bool ok = measure_all(&run, items, pool);
    for (uint32_t item = 0; item < items; item++)
        world->scratch_need =
            run.found[item].scratch_need > world->scratch_need ? run.found[item].scratch_need : world->scratch_need;
    mem_free(run.found);
    return ok || error_set(error, ERROR_CANCELLED, "stopped while the scene was measured");
}

/* --- building --- */

/* Builds a world: flattens the scene, works out lights and boxes, builds the accelerator; and destroys it. */

static void add_up_meshes(struct world *world, const struct assets *assets) {
    for (const struct asset_mesh *entry = assets ? assets->meshes : NULL; entry; entry = entry->next)
        world->mesh_memory += mesh_memory(entry->mesh);
}

static struct medium medium_of(const struct world *world, uint32_t material) {
    const struct medium *own = world->authored.materials[material]->medium;
    if (own && own->fills)
        return *own;
    struct medium medium = surface_medium(&world->surfaces.materials[material]);
    if (own)
        medium_put_inside(&medium, own);
    return medium;
}

void world_update_materials(struct world *world) {
    for (uint32_t i = 0; i < world->material_count; i++) {
        surface_material_update(&world->surfaces.materials[i], world->authored.materials[i], world->classic);
        world->media.all[i] = medium_of(world, i);
    }
    solids_update_media(world);
}

/* The tables of materials and of the media inside. */
static bool make_materials(struct flattening *f) {
    struct world *world = f->world;
    struct arena *arena = f->arena;
    uint32_t count = world->material_count;
    world->material_has_image = arena_alloc_array(arena, count, sizeof *world->material_has_image);
    world->material_has_tangents = arena_alloc_array(arena, count, sizeof *world->material_has_tangents);
    world->material_has_medium = arena_alloc_array(arena, count, sizeof *world->material_has_medium);
    world->media.all = arena_alloc_array(arena, (size_t)count + 1, sizeof *world->media.all);
    world->media.outside = count;
    if (!world->material_has_image || !world->material_has_tangents || !world->material_has_medium || !world->media.all)
        return error_no_memory(f->error, "the materials of the scene");
    if (!flatten_surfaces(f))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        const struct surface_material *material = &world->surfaces.materials[i];
        world->material_has_image[i] = material->needs_footprint;
        world->material_has_tangents[i] = material->needs_tangents;
        world->material_has_medium[i] = surface_is_transparent(material);
        world->media.all[i] = medium_of(world, i);
        struct colour emission = material_emission_bound(world->authored.materials[i]);
        world->emission_bound = math_max(world->emission_bound, math_max(math_max(emission.r, emission.g), emission.b));
    }
    return true;
}

static bool make_boxes(struct flattening *f) {
    struct world *world = f->world;
    world->boxes = arena_alloc_array(f->arena, world->primitive_count, sizeof *world->boxes);
    return world->boxes ? world_primitive_boxes(world, f->limits, f->pool, f->error)
                        : error_no_memory(f->error, "the boxes of the scene");
}

/* On failure the caller destroys partial results. */
static bool build(struct world *world, const struct world_input *input, struct arena *arena, struct pool *pool,
                  struct error *error) {
    struct light *copied = arena_alloc_array(arena, input->light_count, sizeof *copied);
    if (!copied)
        return error_no_memory(error, "the lights of the scene");
    /* The lights of the world are its own: flattening changes them. */
    for (uint32_t i = 0; i < input->light_count; i++) {
        copied[i] = input->lights[i].light;
        if (input->linear_colours)
            light_decode(&copied[i]);
    }
    struct flattening flattening = {.arena = arena,
                                    .scene = input->scene,
                                    .world = world,
                                    .pool = pool,
                                    .linear_colours = input->linear_colours,
                                    .encodes = input->encodes,
                                    .warn = input->warn,
                                    .warn_context = input->warn_context,
                                    .error = error};
    bool reused;
    if (!kept_tables_reuse(&flattening, input, &reused) || (!reused && !flatten_scene(&flattening, input->root)))
        return false;
    /* Lights and sky are made for each frame, in the arena of the job. */
    struct arena *of_tables = flattening.arena;
    flattening.arena = arena;
    world->lights = copied;
    if (!light_lists_resolve(world, input->lights, copied, arena, input->root, error) ||
        !mesh_lights_resolve(&flattening, input->lights, copied, input->root) ||
        (input->linear_colours && !sky_decode(&world->sky, error)))
        return false;
    flattening.arena = of_tables;
    if (!reused && (!make_boxes(&flattening) || !make_materials(&flattening) || !solids_make(&flattening)))
        return false;
    world->media.all[world->media.outside] = input->outside ? *input->outside : medium_outside(NULL);
    solids_update_media(world);
    add_up_meshes(world, input->scene->assets);
    /* The accelerator comes last, since it needs the boxes; that of the frame before fits if they are equal. */
    reused = input->cache && accel_cache_reuse(&input->cache->accel, world->mesh_accel, world->boxes,
                                               world->primitive_count, &world->accel);
    if (!reused &&
        !scene_accel_build(&world->accel, world->mesh_accel, world->boxes, world->primitive_count, pool, error))
        return false;
    flattening.arena = arena;
    if (!touching_find(world, &flattening))
        return false;
    return world->mesh_accel != ACCEL_AUTO || world->accel.kind != ACCEL_BVH ||
           mesh_group_build(&world->group, world, arena, pool, error);
}

bool world_build(struct world *world, const struct world_input *input, struct arena *arena, struct pool *pool,
                 struct error *error) {
    *world = (struct world){.mesh_accel = input->accel,
                            .classic = input->classic,
                            .sky = *input->sky,
                            .light_count = input->light_count,
                            .shutter = input->shutter};
    bool ok = build(world, input, arena, pool, error);
    if (!ok)
        world_destroy(world);
    return ok;
}

void world_destroy(struct world *world) {
    mem_free(world->prototypes);
    mem_free(world->authored.nodes);
    mem_free(world->linear_maps);
    mem_free(world->moving);
    mem_free(world->links);
    world->prototypes = NULL;
    world->authored.nodes = NULL;
    world->linear_maps = NULL;
    world->moving = NULL;
    world->links = NULL;
    scene_accel_destroy(&world->accel);
    mesh_group_destroy(&world->group);
    touching_destroy(&world->touching);
}

size_t world_primitive_memory(const struct world *world) {
    return world->primitive_count * (sizeof *world->primitives + sizeof *world->boxes) +
           world->prototype_count * (sizeof *world->prototypes + sizeof *world->authored.nodes) +
           world->linear_count * sizeof *world->linear_maps + world->moving_count * sizeof *world->moving +
           world->link_count * sizeof *world->links;
}

static void bundle_prototype(struct bundle *bundle, void *prototype) {
    geometry_bundle(bundle, &((struct prototype *)prototype)->geometry);
}

static void bundle_local_medium(struct bundle *bundle, void *local_medium) {
    medium_bundle(bundle, &((struct local_medium *)local_medium)->inner);
}

void world_bundle(struct bundle *bundle, void *flattened) {
    struct world *world = flattened;
    const uint32_t primitives = world->primitive_count, materials = world->material_count;
    const uint32_t solids = world->first_solid ? world->first_solid[primitives] : 0;
    world->authored = (struct authored){0};
    BUNDLE(bundle, world->primitives, primitives, NULL);
    BUNDLE(bundle, world->prototypes, world->prototype_count, bundle_prototype);
    BUNDLE(bundle, world->linear_maps, world->linear_count, NULL);
    BUNDLE(bundle, world->moving, world->moving_count, NULL);
    BUNDLE(bundle, world->links, world->link_count, NULL);
    BUNDLE(bundle, world->boxes, primitives, NULL);
    surface_tables_bundle(bundle, &world->surfaces, materials);
    BUNDLE(bundle, world->material_numbers, materials, NULL);
    BUNDLE(bundle, world->material_has_image, materials, NULL);
    BUNDLE(bundle, world->material_has_tangents, materials, NULL);
    BUNDLE(bundle, world->material_has_medium, materials, NULL);
    BUNDLE(bundle, world->local_media, world->local_media_count, bundle_local_medium);
    BUNDLE(bundle, world->media.all, world->media.outside + 1 + world->local_media_count, medium_bundle);
    BUNDLE(bundle, world->media.solids, solids, NULL);
    BUNDLE(bundle, world->first_solid, primitives + 1, NULL);
    BUNDLE(bundle, world->solid_materials, solids, NULL);
    BUNDLE(bundle, world->lights, world->light_count, light_bundle);
    sky_bundle(bundle, &world->sky);
    BUNDLE(bundle, world->device, 1, device_search_bundle);
    touching_bundle(bundle, &world->touching, primitives);
}
