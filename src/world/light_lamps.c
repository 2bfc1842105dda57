/* What lamps need to know about the scene: the triangles of a lamp that is a mesh are gathered from every place where
 * the scene shows one of its meshes. */
#include "world/light_lamps.h"

#include "base/mem.h"
#include "light/light_mesh.h"
#include "light/sky.h"
#include "world/light_lists.h"

#include <stdio.h>
#include <string.h>

struct gathering {
    const struct world *world;
    const struct light *light;
    struct light_mesh_builder mesh;
};

static void add_triangle(struct gathering *g, const struct mesh *mesh, uint32_t number, const struct transform *map,
                         double sign, const struct thing *thing) {
    struct vec3 corners[3], emission = g->light->emission;
    uint32_t slot;
    mesh_triangle(mesh, number, corners, &slot);
    double size = 0;
    for (int i = 0; i < 3; i++) {
        size = fmax(size, vec3_max_abs(corners[i]) * transform_stretch(map));
        corners[i] = affine_point(&map->forward, corners[i]);
        size = fmax(size, vec3_max_abs(corners[i]));
    }
    if (!g->light->has_emission && thing)
        emission = material_emission(g->world->materials[thing->material + (slot < thing->slot_count ? slot : 0)]);
    light_mesh_add(&g->mesh, corners, sign, size, emission);
}

static void add_mesh(struct gathering *g, const struct mesh *mesh, const struct transform *map,
                     const struct thing *thing) {
    bool mirrored = affine_determinant(&map->forward) < 0;
    double sign = mesh_is_closed(mesh) && mesh_is_outward(mesh) == mirrored ? -1 : 1;
    g->mesh.one_sided = g->mesh.one_sided && mesh_is_closed(mesh);
    for (uint32_t i = 0; i < mesh_triangle_count(mesh); i++)
        add_triangle(g, mesh, i, map, sign, thing);
}

static bool is_lamp(const struct world *world, const uint8_t *marked, uint32_t index) {
    return marked[index] && placed_shape(world, index)->kind == SHAPE_MESH;
}

static bool gather(struct gathering *g, struct arena *arena, const uint8_t *marked, struct error *error) {
    const struct node *node = g->light->node;
    uint64_t total = 0;
    for (uint32_t i = 0; i < g->world->placed_count; i++)
        total += is_lamp(g->world, marked, i) ? mesh_triangle_count(placed_shape(g->world, i)->mesh) : 0;
    bool alone = total == 0;
    if (alone && node->kind == NODE_GEOMETRY && node->shape.kind == SHAPE_MESH)
        total = mesh_triangle_count(node->shape.mesh);
    if (total == 0)
        return error_set(error, ERROR_SCENE,
                         "node '%.100s' is a mesh light, but there is no mesh there or below it in the scene",
                         node->name);
    if (total > UINT32_MAX / 2)
        return error_set(error, ERROR_SCENE, "the mesh light '%.100s' has too many triangles", node->name);
    if (!light_mesh_begin(&g->mesh, total, arena))
        return error_no_memory(error, "a mesh light");
    for (uint32_t i = 0; i < g->world->placed_count && !alone; i++) {
        if (!is_lamp(g->world, marked, i))
            continue;
        struct transform map =
            world_placement(g->world, i, 0.5); /* of what moves: in the middle of the shutter's time */
        add_mesh(g, placed_shape(g->world, i)->mesh, &map, placed_thing(g->world, i));
    }
    if (alone) {
        struct transform map = node_parent_from_node(node);
        add_mesh(g, node->shape.mesh, &map, NULL);
    }
    return true;
}

static bool resolve_mesh(const struct world *world, struct light *light, struct arena *arena, const struct node *root,
                         world_warning *warn, void *warn_context, struct error *error) {
    struct gathering g = {.world = world, .light = light};
    struct light_mesh *mesh = arena_alloc(arena, sizeof *mesh);
    uint8_t *marked = arena_alloc_array(arena, (size_t)world->placed_count + 1, 1);
    if (!mesh || !marked || !light_lists_mark(world, &light->node, 1, marked, 1, root))
        return error_no_memory(error, "a mesh light");
    if (!gather(&g, arena, marked, error))
        return false;
    light_mesh_end(&g.mesh, light->colour, mesh);
    if (mesh->count == 0 && warn) {
        char text[256];
        (void)snprintf(text, sizeof text, "node '%.100s' is a mesh light, but its materials have no emission",
                       light->node->name);
        warn(warn_context, text);
    }
    light->mesh = mesh;
    return true;
}

/* A sky that was turned by a change. The script's own stays as it is. */
static bool turn_sky(struct world *world, const struct sky *behind, struct light *light, struct arena *arena,
                     struct error *error) {
    struct sky *turned = arena_alloc(arena, sizeof *turned);
    if (!turned)
        return error_no_memory(error, "a sky");
    *turned = *light->sky;
    sky_turn(turned, light->turn_sine, light->turn_cosine);
    if (sky_same(light->sky, behind))
        world->sky = *turned;
    light->sky = turned;
    light->sky_turned = false;
    return true;
}

bool light_lamps_resolve(struct world *world, struct light *lights, struct arena *arena, const struct node *root,
                         struct pool *pool, world_warning *warn, void *warn_context, struct error *error) {
    const struct sky behind = world->sky;
    for (uint32_t i = 0; i < world->light_count; i++) {
        struct light *light = &lights[i];
        if (light->sky_turned && !turn_sky(world, &behind, light, arena, error))
            return false;
        if (light->node && !resolve_mesh(world, light, arena, root, warn, warn_context, error))
            return false;
        if (!light_prepare(light, arena, pool, error))
            return false;
    }
    return true;
}
