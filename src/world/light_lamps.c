/* The triangles of a mesh lamp, gathered from every place where the scene shows one of its meshes. A triangle is drawn
 * in proportion to its area times the luminance of its emission, so the light of a sample is radiance over that
 * density. */
#include "world/light_lamps.h"

#include "base/mem.h"
#include "light/sky_light.h"
#include "world/light_lists.h"

#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

struct gathering {
    const struct world *world;
    const struct light *light;
    struct light_triangle *triangles;
    double *until;
    uint32_t count;
    bool one_sided;
    struct box bounds;
    double sum; /* of areas times luminances */
};

static double luminance(struct vec3 c) {
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

/* Below it a reciprocal is not finite. */
static const double dark = 1e-300;

/* Triangles without area or light are left out. */
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
    struct light_triangle *t = &g->triangles[g->count];
    t->corner = corners[0];
    t->edge1 = vec3_sub(corners[1], corners[0]);
    t->edge2 = vec3_sub(corners[2], corners[0]);
    struct vec3 across = vec3_cross(t->edge1, t->edge2);
    double area = vec3_length(across) / 2, weight = area * luminance(emission);
    if (!(weight > 0) || area < dark || luminance(emission) < dark)
        return;
    t->normal = vec3_scale(across, sign / (2 * area));
    t->light = vec3_scale(emission, 1 / (luminance(emission) * pi)); /* times the sum, once it is known */
    t->offset = size * 0x1p-40;
    for (int i = 0; i < 3; i++)
        g->bounds = box_add_point(g->bounds, corners[i]);
    g->sum += weight;
    g->until[g->count++] = g->sum;
}

static void add_mesh(struct gathering *g, const struct mesh *mesh, const struct transform *map,
                     const struct thing *thing) {
    bool mirrored = affine_determinant(&map->forward) < 0;
    double sign = mesh_is_closed(mesh) && mesh_is_outward(mesh) == mirrored ? -1 : 1;
    g->one_sided = g->one_sided && mesh_is_closed(mesh);
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
    g->triangles = arena_alloc_array(arena, total, sizeof *g->triangles);
    g->until = arena_alloc_array(arena, total, sizeof *g->until);
    if (!g->triangles || !g->until)
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
    struct gathering g = {.world = world, .light = light, .one_sided = true, .bounds = box_empty()};
    struct light_mesh *mesh = arena_alloc(arena, sizeof *mesh);
    uint8_t *marked = arena_alloc_array(arena, (size_t)world->placed_count + 1, 1);
    if (!mesh || !marked || !light_lists_mark(world, &light->node, 1, marked, 1, root))
        return error_no_memory(error, "a mesh light");
    if (!gather(&g, arena, marked, error))
        return false;
    for (uint32_t i = 0; i < g.count; i++) {
        g.until[i] = i + 1 < g.count ? g.until[i] / g.sum : 1;
        g.triangles[i].light = vec3_mul(vec3_scale(g.triangles[i].light, g.sum), light->colour);
    }
    if (g.count == 0 && warn) {
        char text[256];
        (void)snprintf(text, sizeof text, "node '%.100s' is a mesh light, but its materials have no emission",
                       light->node->name);
        warn(warn_context, text);
    }
    *mesh = (struct light_mesh){g.triangles, g.until, g.count, g.one_sided, vec3_all(0), 0};
    if (g.count > 0) {
        mesh->centre = vec3_scale(vec3_add(g.bounds.min, g.bounds.max), 0.5);
        mesh->radius = vec3_length(vec3_sub(g.bounds.max, mesh->centre)) * (1 + 0x1p-40);
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
        if (light->kind == LIGHT_SKY && light->sky_turned && !turn_sky(world, &behind, light, arena, error))
            return false;
        if (light->kind == LIGHT_MESH && !resolve_mesh(world, light, arena, root, warn, warn_context, error))
            return false;
        if (light->kind == LIGHT_SKY) {
            light->table = sky_table_build(light->sky, arena, pool);
            if (!light->table)
                return error_no_memory(error, "the light of the sky");
        }
    }
    return true;
}
