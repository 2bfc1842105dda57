/* Builds a world: flattens the scene, works out lights and boxes, builds the accelerator; and destroys it. */
#include "base/mem.h"
#include "world/flatten_internal.h"
#include "world/mesh_lights_internal.h"
#include "world/world_internal.h"

#include <string.h>

static void add_up_meshes(struct world *world, const struct assets *assets) {
    for (const struct asset_mesh *entry = assets ? assets->meshes : NULL; entry; entry = entry->next)
        world->mesh_memory += mesh_memory(entry->mesh);
}

void world_update_materials(struct world *world) {
    for (uint32_t i = 0; i < world->material_count; i++)
        world->materials[i].phong = material_flatten(world->authored.materials[i], world->classic).phong;
}

/* The tables of materials and of the media inside. */
static bool make_materials(struct flattening *f) {
    struct world *world = f->world;
    struct arena *arena = f->arena;
    uint32_t count = world->material_count;
    world->materials = arena_alloc_array(arena, count, sizeof *world->materials);
    world->material_has_image = arena_alloc_array(arena, count, sizeof *world->material_has_image);
    world->material_has_tangents = arena_alloc_array(arena, count, sizeof *world->material_has_tangents);
    world->material_medium = arena_alloc_array(arena, count, sizeof *world->material_medium);
    world->media = arena_alloc_array(arena, count, sizeof *world->media);
    if (!world->materials || !world->material_has_image || !world->material_has_tangents || !world->material_medium ||
        !world->media)
        return error_no_memory(f->error, "the materials of the scene");
    for (uint32_t i = 0; i < count; i++)
        world->materials[i] = material_flatten(world->authored.materials[i], world->classic);
    if (!flatten_textures(f))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        const struct material *material = &world->materials[i];
        struct medium medium = {.absorption = material_absorption(material)};
        world->material_has_image[i] = material_has_image(material);
        world->material_has_tangents[i] = material_has_bump(material) || material_has_function(material);
        world->material_medium[i] = MEDIUM_NONE;
        if (material_is_transparent(material, &medium.ior)) {
            world->material_medium[i] = world->medium_count;
            world->media[world->medium_count++] = medium;
        }
        struct vec3 emission = material_emission_bound(world->authored.materials[i]);
        world->emission_bound = fmax(world->emission_bound, fmax(fmax(emission.x, emission.y), emission.z));
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
    struct arena *of_tables = flattening.arena;
    flattening.arena = arena;
    world->lights = copied;
    if (!light_lists_resolve(world, input->lights, copied, arena, input->root, error) ||
        !mesh_lights_resolve(&flattening, input->lights, copied, input->root) ||
        (input->linear_colours && !sky_decode(&world->sky, error)))
        return false;
    flattening.arena = of_tables;
    if (!reused && (!make_boxes(&flattening) || !make_materials(&flattening)))
        return false;
    add_up_meshes(world, input->scene->assets);
    reused = input->cache && accel_cache_reuse(&input->cache->accel, world->mesh_accel, world->boxes,
                                               world->primitive_count, &world->accel);
    if (!reused &&
        !scene_accel_build(&world->accel, world->mesh_accel, world->boxes, world->primitive_count, pool, error))
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
}

size_t world_primitive_memory(const struct world *world) {
    return world->primitive_count * (sizeof *world->primitives + sizeof *world->boxes) +
           world->prototype_count * (sizeof *world->prototypes + sizeof *world->authored.nodes) +
           world->linear_count * sizeof *world->linear_maps + world->moving_count * sizeof *world->moving +
           world->link_count * sizeof *world->links;
}
