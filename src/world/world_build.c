/* Builds a world: flattens the scene, works out lights and boxes, builds the accelerator; and destroys it. */
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

/* Leaves it to the caller to destroy what there is when it fails. */
static bool build(struct world *world, struct arena *arena, struct scene *scene, const struct node *root,
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
        !light_lamps_resolve(&flattening, copied, root))
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
    return scene_accel_build(&world->accel, world->mesh_accel, world->boxes, world->placed_count, pool, error);
}

bool world_build(struct world *world, struct arena *arena, struct scene *scene, const struct node *root,
                 const struct light *lights, uint32_t light_count, const struct sky *sky, struct shutter shutter,
                 enum accel_kind accel, struct pool *pool, world_warning *warn, void *warn_context,
                 struct error *error) {
    *world = (struct world){.mesh_accel = accel, .sky = *sky, .light_count = light_count, .shutter = shutter};
    bool ok = build(world, arena, scene, root, lights, pool, warn, warn_context, error);
    if (!ok)
        world_destroy(world);
    return ok;
}

void world_destroy(struct world *world) {
    mem_free(world->things);
    mem_free(world->authored.nodes);
    mem_free(world->linear_maps);
    mem_free(world->moving);
    world->things = NULL;
    world->authored.nodes = NULL;
    world->linear_maps = NULL;
    world->moving = NULL;
    scene_accel_destroy(&world->accel);
}

size_t world_placed_memory(const struct world *world) {
    return world->placed_count * (sizeof *world->placed + sizeof *world->boxes) +
           world->thing_count * (sizeof *world->things + sizeof *world->authored.nodes) +
           world->linear_count * sizeof *world->linear_maps + world->moving_count * sizeof *world->moving;
}
