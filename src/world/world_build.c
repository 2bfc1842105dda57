/* Builds a world: flattens the scene, works out lights and boxes, and builds what searches go through.
 *
 * How many voxels has the frame? A voxel spares a ray that passes it the upper levels of the hierarchy and costs it a
 * step. In a cloud of alike primitives without anything round it, with three voxels to each of them, steps win by a
 * tenth (10,000 spheres) to a fifth (200,000) of the whole picture. But one floor round the cloud makes voxels of the
 * floor's size, which hold everything at once: 25 times slower at 10,000, 190 times at 200,000. No resolution that is
 * the same everywhere suits both. ACCEL_AUTO asks the cost model of accel/frame_cost.c, which knows from a sample of
 * the boxes how many voxels a line visits, how long their lists are, and how long for somebody who looks at the
 * crowd: voxels with lists where they cost clearly less, else one voxel with the hierarchy of box_tree.c in it, which
 * also lets packets and shafts through. ACCEL_GRID and ACCEL_BVH pin it. docs/performance.md has the measurements. */
#include "accel/frame_cost.h"
#include "base/mem.h"
#include "world/flatten.h"
#include "world/light_lamps.h"
#include "world/light_lists.h"
#include "world/world_internal.h"

#include <string.h>

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
    if (!world_place_boxes(world, flattening.limits, pool, error))
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
