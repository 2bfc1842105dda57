/* See solids_internal.h. A primitive is one solid for each material of its surface that light may pass: the parts of a
 * CSG solid and of a mesh can have several. */
#include "world/solids_internal.h"

#include "base/mem.h"

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
    struct solid *solids =
        ok ? arena_alloc_array(f->arena, (size_t)first[world->primitive_count] + 1, sizeof *solids) : NULL;
    /* Primitives of one prototype have the same materials. */
    uint32_t last = UINT32_MAX;
    for (uint32_t i = 0; solids && i < world->primitive_count; i++) {
        uint32_t prototype = world->primitives[i].prototype, count = of_prototype[prototype];
        if (prototype != last && count > 0)
            (void)materials_of(world, &world->prototypes[prototype], list);
        last = count > 0 ? prototype : last;
        for (uint32_t k = 0; k < count; k++)
            solids[first[i] + k] = (struct solid){i, list[k]};
    }
    world->media.solids = solids;
    world->first_solid = solids ? first : NULL;
    mem_free(list);
    mem_free(of_prototype);
    return solids || error_no_memory(f->error, "the solids of the scene");
}
