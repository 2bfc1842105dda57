/* What a frame of an animation takes over from the frame before. The tables of a world (primitives, prototypes, boxes,
 * materials, textures) have their own arena, which outlives the picture. They fit the next frame if it has the same
 * scene, root and settings, if only transforms of nodes have changed, and if these change nothing but the poses of
 * primitives: without moving nodes, clips and bounds. Everything else of a world is made for each frame. */
#include "world/world_cache.h"

#include "base/mem.h"
#include "world/flatten_internal.h"

struct kept_tables {
    struct arena arena;
    struct flatten_log log;
    bool full; /* `world` has the tables; else a world outside has them, or there are none */
    struct world world;
    /* What they were made of. */
    uint64_t epoch;
    const struct node *root;
    enum accel_kind accel;
    bool linear_colours, encodes, classic;
};

/* The next tables may need blocks of other sizes. */
static void empty(struct kept_tables *tables) {
    enum { LARGE = 64 << 20 };
    if (tables->full)
        world_destroy(&tables->world);
    tables->full = false;
    if (tables->arena.total > LARGE)
        arena_destroy(&tables->arena);
    else
        arena_reset(&tables->arena);
}

static bool fits(const struct kept_tables *tables, const struct world_input *input) {
    return tables->full && tables->epoch == input->scene->epoch && tables->root == input->root &&
           tables->accel == input->accel && tables->linear_colours == input->linear_colours &&
           tables->encodes == input->encodes && tables->classic == input->classic;
}

/* Lights that are meshes add materials and textures of their own. */
static bool has_mesh_light(const struct world_input *input) {
    for (uint32_t i = 0; i < input->light_count; i++)
        if (input->lights[i].node)
            return true;
    return false;
}

/* What the input of this frame decides stays as it is. */
static void take_world(struct kept_tables *tables, struct world *world) {
    const struct world own = *world;
    *world = tables->world;
    world->mesh_memory = 0;
    world->sky = own.sky;
    world->shutter = own.shutter;
    world->light_count = own.light_count;
    tables->full = false;
    for (uint32_t i = 0; i < world->surfaces.textures.count; i++)
        if (world->surfaces.textures.operations[i].kind == TEXTURE_FUNCTION)
            world->surfaces.textures.operations[i].recorded.nan->found = false;
}

bool kept_tables_reuse(struct flattening *f, const struct world_input *input, bool *reused) {
    struct world_cache *cache = input->cache;
    *reused = false;
    if (!cache)
        return true;
    if (!input->keeps_tables || has_mesh_light(input))
        world_cache_drop_tables(cache);
    else if (!cache->tables)
        cache->tables = mem_alloc_zero(1, sizeof *cache->tables);
    struct kept_tables *tables = cache->tables;
    /* Nothing is kept: the next world sees all changes anew. */
    if (!tables) {
        scene_forget_changes(input->scene);
        return true;
    }
    /* The world as it is if the tables do not fit. */
    const struct world begun = *f->world;
    f->log = &tables->log;
    bool ok = true;
    if (fits(tables, input)) {
        take_world(tables, f->world);
        ok = flatten_update(f, &input->scene->changes, reused);
        if (!*reused || !ok) {
            world_destroy(f->world);
            *f->world = begun;
        }
    }
    scene_forget_changes(input->scene);
    cache->reused += *reused;
    if (*reused || !ok)
        return ok;
    /* New tables, which the next frame may take over. */
    empty(tables);
    f->arena = &tables->arena;
    tables->epoch = input->scene->epoch;
    tables->root = input->root;
    tables->accel = input->accel;
    tables->linear_colours = input->linear_colours;
    tables->encodes = input->encodes;
    tables->classic = input->classic;
    return true;
}

void world_keep(struct world *world, struct world_cache *cache) {
    struct kept_tables *tables = cache->tables;
    accel_cache_keep(&cache->accel, world->mesh_accel, world->boxes, world->primitive_count, &world->accel);
    if (!tables || !tables->log.on) {
        world_destroy(world);
        if (tables)
            empty(tables);
        return;
    }
    mesh_group_destroy(&world->group);
    scene_accel_destroy(&world->accel);
    touching_destroy(&world->touching);
    world->lights = NULL;
    tables->world = *world;
    tables->full = true;
    *world = (struct world){.primitives = NULL};
}

void world_cache_drop_tables(struct world_cache *cache) {
    if (cache->tables) {
        empty(cache->tables);
        flatten_log_clear(&cache->tables->log);
        arena_destroy(&cache->tables->arena);
    }
    mem_free(cache->tables);
    cache->tables = NULL;
}

void world_cache_destroy(struct world_cache *cache) {
    world_cache_drop_tables(cache);
    accel_cache_destroy(&cache->accel);
}
