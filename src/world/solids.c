/* See solids_internal.h. A primitive is one solid for each material of its surface that light may pass: the parts of a
 * CSG solid and of a mesh can have several. */
#include "world/solids_internal.h"

#include "base/mem.h"
#include "material/medium_mix.h"

#include <string.h>

/* Appends a material of a prototype to those at `list`, unless it is there or light does not pass it. */
static uint32_t add_material(const struct world *world, uint32_t material, uint32_t *list, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        if (list[i] == material)
            return count;
    if (!surface_passes(&world->surfaces.materials[material]))
        return count;
    list[count] = material;
    return count + 1;
}

static uint32_t add_slots(const struct world *world, uint32_t material, uint32_t slots, uint32_t *list,
                          uint32_t count) {
    for (uint32_t i = material; i < material + (slots > 1 ? slots : 1); i++)
        count = add_material(world, i, list, count);
    return count;
}

/* The materials of a prototype that light may pass; `list` has room for all materials. */
static uint32_t materials_of(const struct world *world, const struct prototype *prototype, uint32_t *list) {
    const struct csg *csg = prototype->geometry.csg;
    uint32_t count = 0;
    if (!csg)
        return add_slots(world, prototype->material, prototype->slot_count, list, 0);
    for (uint32_t i = 0; i < csg->leaf_count; i++)
        count = add_slots(world, csg->leaves[i].material, csg->leaves[i].slot_count, list, count);
    return count;
}

/* The number of solids of each primitive, summed up. */
static bool count_solids(const struct world *world, uint32_t *list, uint32_t *of_prototype, uint32_t *first) {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < world->prototype_count; i++)
        of_prototype[i] = materials_of(world, &world->prototypes[i], list);
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        first[i] = (uint32_t)sum;
        sum += of_prototype[world->primitives[i].prototype];
    }
    first[world->primitive_count] = (uint32_t)sum;
    return sum < SOLID_NONE;
}

/* --- by place --- */

static bool has_density(const struct world *world, uint32_t material) {
    const struct medium *medium = &world->media.all[material];
    return medium->density || (medium->inner && medium->inner->density);
}

static bool is_fitted(const struct world *world, uint32_t material) {
    const struct medium *medium = &world->media.all[material];
    return medium_needs_solid(medium) || (medium->inner && medium_needs_solid(medium->inner));
}

/* The operand of a combined solid that has the material: the first one. */
static const struct csg_leaf *leaf_of(const struct csg *csg, uint32_t material) {
    const struct csg_leaf *leaf = csg->leaves;
    while (material - leaf->material >= (leaf->slot_count > 1 ? leaf->slot_count : 1))
        leaf++;
    return leaf;
}

/* Of the shape with the medium of a solid, in its own space. */
static struct box own_box(const struct world *world, uint32_t solid) {
    const struct geometry *geometry = primitive_geometry(world, world->media.solids[solid].primitive);
    return geometry->csg ? shape_bounds(&leaf_of(geometry->csg, world->solid_materials[solid])->shape)
                         : geometry_bounds(geometry);
}

/* Gives each solid with a density a medium of its own. Errors: no memory, a grid without a box. */
static bool make_local_media(struct flattening *f, uint32_t solid_count, struct solid *solids) {
    struct world *world = f->world;
    uint32_t count = 0, first = world->media.outside + 1;
    for (uint32_t i = 0; i < solid_count; i++)
        count += has_density(world, solids[i].medium);
    if (count == 0)
        return true;
    struct medium *all = arena_alloc_array(f->arena, (size_t)first + count, sizeof *all);
    world->local_media = arena_alloc_array(f->arena, count, sizeof *world->local_media);
    if (!all || !world->local_media)
        return error_no_memory(f->error, "the media of the scene");
    memcpy(all, world->media.all, first * sizeof *all);
    world->media.all = all;
    for (uint32_t i = 0; i < solid_count; i++) {
        struct box box;
        if (!has_density(world, solids[i].medium))
            continue;
        if (is_fitted(world, solids[i].medium) &&
            (box = own_box(world, i), !vec3_finite(box.min) || !vec3_finite(box.max)))
            return error_set(f->error, ERROR_SCENE,
                             "node '%.100s' has no end, so the grid of its medium needs corner and size",
                             primitive_node(world, solids[i].primitive)->name);
        world->local_media[world->local_media_count].solid = i;
        solids[i].medium = first + world->local_media_count++;
    }
    return true;
}

/* From the world to the space of the shape; the box that a grid fits becomes the unit box. */
static struct affine placement_of(const struct world *world, uint32_t solid, bool fits, double time) {
    uint32_t primitive = world->media.solids[solid].primitive;
    const struct csg *csg = primitive_geometry(world, primitive)->csg;
    struct affine map = world_placement(world, primitive, time).inverse;
    if (csg)
        map = affine_compose(&leaf_of(csg, world->solid_materials[solid])->csg_from_leaf.inverse, &map);
    if (!fits)
        return map;
    struct box box = own_box(world, solid);
    struct vec3 size = vec3_sub(box.max, box.min);
    for (int i = 0; i < 3; i++) {
        map.m[i][3] -= vec3_get(box.min, i);
        for (int k = 0; k < 4; k++)
            map.m[i][k] /= vec3_get(size, i);
    }
    return map;
}

void solids_update_media(struct world *world) {
    for (uint32_t i = 0; i < world->local_media_count; i++) {
        struct local_medium *local = &world->local_media[i];
        uint32_t material = world->solid_materials[local->solid];
        struct medium *medium = &world->media.all[world->media.outside + 1 + i];
        bool fits = is_fitted(world, material);
        local->placement = (struct medium_placement){placement_of(world, local->solid, fits, 0),
                                                     placement_of(world, local->solid, fits, 1)};
        *medium = world->media.all[material];
        medium->placement = &local->placement;
        if (!medium->inner)
            continue;
        local->inner = *medium->inner;
        local->inner.placement = &local->placement;
        medium->inner = &local->inner;
    }
}

bool solids_make(struct flattening *f) {
    struct world *world = f->world;
    bool passes = false;
    for (uint32_t i = 0; i < world->material_count; i++)
        passes = passes || surface_passes(&world->surfaces.materials[i]);
    if (!passes)
        return true;
    uint32_t *list = mem_resize_array(NULL, (size_t)world->material_count + 1, sizeof *list);
    uint32_t *of_prototype = mem_resize_array(NULL, (size_t)world->prototype_count + 1, sizeof *of_prototype);
    uint32_t *first = arena_alloc_array(f->arena, (size_t)world->primitive_count + 1, sizeof *first);
    bool ok = list && of_prototype && first && count_solids(world, list, of_prototype, first);
    size_t count = ok ? (size_t)first[world->primitive_count] : 0;
    struct solid *solids = ok ? arena_alloc_array(f->arena, count + 1, sizeof *solids) : NULL;
    uint32_t *materials = solids ? arena_alloc_array(f->arena, count + 1, sizeof *materials) : NULL;
    /* Primitives of one prototype have the same materials. */
    uint32_t last = UINT32_MAX;
    for (uint32_t i = 0; materials && i < world->primitive_count; i++) {
        uint32_t prototype = world->primitives[i].prototype, own = of_prototype[prototype];
        if (prototype != last && own > 0)
            (void)materials_of(world, &world->prototypes[prototype], list);
        last = own > 0 ? prototype : last;
        for (uint32_t k = 0; k < own; k++) {
            solids[first[i] + k] = (struct solid){i, list[k]};
            materials[first[i] + k] = list[k];
        }
    }
    world->media.solids = solids;
    world->solid_materials = materials;
    world->first_solid = materials ? first : NULL;
    mem_free(list);
    mem_free(of_prototype);
    return materials ? make_local_media(f, (uint32_t)count, solids)
                     : error_no_memory(f->error, "the solids of the scene");
}
