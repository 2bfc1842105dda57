/* The triangles of mesh lights are collected from every instance of their meshes in the scene. A node that is not in
 * the scene is flattened separately, into a temporary world. */
#include "world/mesh_lights_internal.h"

#include "light/light_mesh.h"
#include "light/sky.h"
#include "material/material_eval.h"
#include "world/node_path.h"
#include "world/world_describe.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct mesh_light_collection {
    const struct world *world; /* the world of the meshes */
    const struct light *light;
    struct colour emission;  /* of the light, if it has one of its own; white if that is black */
    const struct node *node; /* of a light of the scene */
    const uint8_t *marked;   /* by its primitives: which of them belong to the light; NULL: all */
    struct light_mesh_builder mesh;
};

static void add_triangle(struct mesh_light_collection *g, const struct mesh *mesh, uint32_t number,
                         const struct transform *map, double sign, const struct prototype *prototype) {
    struct vec3 corners[3];
    struct colour emission = g->emission;
    uint32_t slot;
    mesh_triangle(mesh, number, corners, &slot);
    double size = 0;
    for (int i = 0; i < 3; i++) {
        size = math_max(size, vec3_max_abs(corners[i]) * transform_stretch(map));
        corners[i] = affine_point(&map->forward, corners[i]);
        size = math_max(size, vec3_max_abs(corners[i]));
    }
    if (!g->light->has_emission)
        emission = material_emission(
            g->world->authored.materials[prototype->material + (slot < prototype->slot_count ? slot : 0)]);
    light_mesh_add(&g->mesh, corners, sign, size, emission);
}

static void add_mesh(struct mesh_light_collection *g, uint32_t index) {
    const struct prototype *prototype = primitive_prototype(g->world, index);
    const struct mesh *mesh = prototype->geometry.shape.mesh;
    struct transform map =
        world_placement(g->world, index, 0.5); /* of moving primitives: in the middle of the shutter interval */
    bool mirrored = affine_determinant(&map.forward) < 0;
    double sign = mesh_is_closed(mesh) && mesh_is_outward(mesh) == mirrored ? -1 : 1;
    g->mesh.one_sided = g->mesh.one_sided && mesh_is_closed(mesh);
    g->mesh.primitive = index;
    for (uint32_t i = 0; i < mesh_triangle_count(mesh); i++) {
        g->mesh.part = i;
        add_triangle(g, mesh, i, &map, sign, prototype);
    }
}

static bool is_source(const struct mesh_light_collection *g, uint32_t index) {
    return (!g->marked || g->marked[index]) && geometry_mesh(primitive_geometry(g->world, index));
}

static uint64_t count_triangles(const struct mesh_light_collection *g) {
    uint64_t total = 0;
    for (uint32_t i = 0; i < g->world->primitive_count; i++)
        total += is_source(g, i) ? mesh_triangle_count(primitive_geometry(g->world, i)->shape.mesh) : 0;
    return total;
}

static bool collect(struct mesh_light_collection *g, uint64_t total, struct arena *arena, struct error *error) {
    if (total > UINT32_MAX / 2)
        return error_set(error, ERROR_SCENE, "the mesh light '%.100s' has too many triangles", g->node->name);
    if (!light_mesh_begin(&g->mesh, total, arena))
        return error_no_memory(error, "a mesh light");
    for (uint32_t i = 0; i < g->world->primitive_count; i++)
        if (is_source(g, i))
            add_mesh(g, i);
    return true;
}

bool mesh_lights_primitive(const struct world *world, uint32_t primitive, struct light *light, struct arena *arena,
                           struct error *error) {
    struct mesh_light_collection g = {.world = world, .light = light};
    struct light_mesh *mesh = arena_alloc(arena, sizeof *mesh);
    if (!mesh ||
        !light_mesh_begin(&g.mesh, mesh_triangle_count(primitive_geometry(world, primitive)->shape.mesh), arena))
        return error_no_memory(error, "a mesh light");
    add_mesh(&g, primitive);
    light_mesh_end(&g.mesh, light->colour, mesh);
    mesh->shown = true;
    light->mesh = mesh;
    return true;
}

/* --- emission that varies over a mesh --- */

/* Barycentric weights of vertices 1 and 2 at sample points of a triangle. */
static const double points[][2] = {{1.0 / 3, 1.0 / 3}, {0.2, 0.2},   {0.6, 0.2}, {0.2, 0.6},
                                   {0.45, 0.1},        {0.45, 0.45}, {0.1, 0.45}};
enum { POINTS = sizeof points / sizeof *points };
static const double min_share = 1.0 / 64; /* of the emission of the whole material */

/* The emission at a point, filtered over its part of the triangle. */
static struct colour emission_at(const struct world *world, const struct light_triangle *t, const double weights[2],
                                 double width) {
    struct vec3 at = vec3_add_scaled(vec3_add_scaled(t->corner, t->edge1, weights[0]), t->edge2, weights[1]);
    struct ray ray = {.origin = vec3_add(at, t->normal), .direction = vec3_negate(t->normal), .time = 0.5};
    struct crossing crossing = {.t = 1, .u = weights[0], .v = weights[1], .part = t->part, .enter = true};
    struct hit hit;
    struct bsdf bsdf;
    ray.footprint.width = width;
    world_describe(world, &ray, t->primitive, &crossing, &hit);
    material_eval(&world->surfaces, &hit, NULL, NULL, &bsdf);
    return colour_scale(bsdf.emission, math_min(bsdf.opacity, 1));
}

bool mesh_lights_estimate(const struct world *world, struct light *light, struct arena *arena, struct pool *pool,
                          struct error *error) {
    const struct light_mesh *old = light->mesh;
    struct light_mesh *mesh = arena_alloc(arena, sizeof *mesh);
    struct light_mesh_builder builder;
    if (!mesh || !light_mesh_begin(&builder, old->count, arena))
        return error_no_memory(error, "a mesh light");
    builder.one_sided = old->one_sided;
    for (uint32_t i = 0; i < old->count; i++) {
        const struct light_triangle *t = &old->triangles[i];
        if ((i & 255) == 0 && pool_cancelled(pool))
            return error_set(error, ERROR_CANCELLED, "stopped while the lights of the scene were gathered");
        /* The mean over some points, with a small share of the bound: a place that no point met stays possible. */
        struct vec3 across = vec3_cross(t->edge1, t->edge2);
        struct colour sum = {0, 0, 0};
        double width = sqrt(vec3_length(across) / (2 * POINTS));
        for (int k = 0; k < POINTS; k++)
            sum = colour_add_scaled(sum, emission_at(world, t, points[k], width), (1 - min_share) / POINTS);
        struct vec3 corners[3] = {t->corner, vec3_add(t->corner, t->edge1), vec3_add(t->corner, t->edge2)};
        builder.primitive = t->primitive;
        builder.part = t->part;
        sum = colour_add_scaled(colour_mul(sum, light->colour), light_triangle_radiance(t), min_share);
        light_mesh_add(&builder, corners, vec3_dot(across, t->normal) < 0 ? -1 : 1, t->offset * 0x1p40, sum);
    }
    light_mesh_end(&builder, colour_all(1), mesh);
    mesh->shown = old->shown;
    light->mesh = mesh;
    return true;
}

/* Rays do not hit it, so its materials are not evaluated at points. */
static void warn_of_average(const struct mesh_light_collection *g, struct flattening *f) {
    for (uint32_t i = 0; f->warn && !g->light->has_emission && i < g->world->primitive_count; i++) {
        const struct prototype *prototype = primitive_prototype(g->world, i);
        for (uint32_t slot = 0; is_source(g, i) && slot < (prototype->slot_count > 0 ? prototype->slot_count : 1);
             slot++) {
            if (!g->world->authored.materials[prototype->material + slot]->inputs[INPUT_EMISSION])
                continue;
            char text[256];
            (void)snprintf(text, sizeof text,
                           "node '%.100s' is a mesh light that is not in the scene: of the texture of its emission "
                           "only the average counts",
                           g->node->name);
            f->warn(f->warn_context, text);
            return;
        }
    }
}

/* For a node that is not in the scene. */
static bool collect_unseen(struct mesh_light_collection *g, struct flattening *f, struct error *error) {
    const struct node *node = g->node;
    struct world own = {.mesh_accel = f->world->mesh_accel, .shutter = f->world->shutter};
    struct flattening flattening = {
        .arena = f->arena, .scene = f->scene, .world = &own, .unqueried = true, .pool = f->pool, .error = error};
    bool ok = flatten_scene(&flattening, node);
    g->world = &own;
    g->marked = NULL;
    uint64_t total = ok ? count_triangles(g) : 0;
    if (ok && total == 0 && !(node->kind == NODE_GEOMETRY && node->shape.kind == SHAPE_MESH))
        ok = error_set(error, ERROR_SCENE, "node '%.100s' is a mesh light, but there is no mesh there or below it",
                       node->name);
    ok = ok && collect(g, total, f->arena, error);
    if (ok)
        warn_of_average(g, f);
    world_destroy(&own);
    return ok;
}

static bool resolve_mesh(struct flattening *f, const struct node *node, struct light *light, const struct node *root) {
    const struct world *world = f->world;
    struct light_mesh *mesh = arena_alloc(f->arena, sizeof *mesh);
    uint8_t *marked = arena_alloc_array(f->arena, (size_t)world->primitive_count + 1, 1);
    if (!mesh || !marked || !light_lists_mark(world, &node, 1, marked, 1, root))
        return error_no_memory(f->error, "a mesh light");
    /* Black emission of its own replaces that of the materials: the light keeps its triangles. */
    bool black = light->has_emission && colour_max_abs(light->emission) == 0;
    struct mesh_light_collection g = {.world = world,
                                      .light = light,
                                      .emission = black ? colour_all(1) : light->emission,
                                      .node = node,
                                      .marked = marked};
    uint64_t total = count_triangles(&g);
    if (!(total > 0 ? collect(&g, total, f->arena, f->error) : collect_unseen(&g, f, f->error)))
        return false;
    light_mesh_end(&g.mesh, black ? colour_all(0) : light->colour, mesh);
    mesh->shown = total > 0;
    if (mesh->count == 0 && f->warn) {
        char text[256];
        (void)snprintf(text, sizeof text, "node '%.100s' is a mesh light, but its materials have no emission",
                       node->name);
        f->warn(f->warn_context, text);
    }
    light->mesh = mesh;
    return true;
}

/* A sky that a change has rotated. The script's own does not change. */
static bool turn_sky(struct world *world, const struct sky *behind, const struct sky_turn *turn, struct light *light,
                     struct arena *arena, struct error *error) {
    struct sky *turned = arena_alloc(arena, sizeof *turned);
    if (!turned)
        return error_no_memory(error, "a sky");
    *turned = *light->sky;
    sky_turn(turned, turn->sine, turn->cosine);
    if (sky_same(light->sky, behind))
        world->sky = *turned;
    light->sky = turned;
    return true;
}

/* Likewise in linear colours. */
static bool decode_sky(struct light *light, struct arena *arena, struct error *error) {
    struct sky *decoded = arena_alloc(arena, sizeof *decoded);
    if (!decoded)
        return error_no_memory(error, "a sky");
    *decoded = *light->sky;
    light->sky = decoded;
    return sky_decode(decoded, error);
}

bool mesh_lights_resolve(struct flattening *f, const struct scene_light *authored, struct light *lights,
                         const struct node *root) {
    const struct sky behind = f->world->sky;
    for (uint32_t i = 0; i < f->world->light_count; i++) {
        struct light *light = &lights[i];
        const struct sky_turn *turn = &authored[i].sky_turn;
        if (turn->turned && !turn_sky(f->world, &behind, turn, light, f->arena, f->error))
            return false;
        if (f->linear_colours && light->sky && !decode_sky(light, f->arena, f->error))
            return false;
        if (authored[i].node && !resolve_mesh(f, authored[i].node, light, root))
            return false;
        if (!light_prepare(light, f->arena, f->pool, f->error))
            return false;
    }
    return true;
}

/* One traversal for each list; scenes without lists have no cost. */

static bool is_listed(const struct node *const *list, uint32_t count, const struct node *node) {
    for (uint32_t i = 0; i < count; i++)
        if (list[i] == node)
            return true;
    return false;
}

bool light_lists_mark(const struct world *world, const struct node *const *list, uint32_t list_count, uint8_t *lit,
                      uint8_t value, const struct node *root) {
    struct scene_traversal t = world_traversal(world, root, sizeof(bool));
    enum scene_event event;
    uint32_t next = 0;
    while ((event = scene_traversal_next(&t)) < SCENE_END) {
        if (event != SCENE_ENTER)
            continue;
        const struct node *node = scene_traversal_node(&t);
        const bool *above = t.depth > 1 ? scene_traversal_frame(&t, 1) : NULL;
        bool *listed = scene_traversal_frame(&t, 0);
        *listed = (above && *above) || is_listed(list, list_count, node);
        uint32_t count = world_primitives_of(world, node, next);
        if (*listed && count > 0)
            memset(lit + next, value, count);
        next += count;
    }
    scene_traversal_end(&t);
    return event == SCENE_END;
}

bool light_lists_resolve(const struct world *world, const struct scene_light *authored, struct light *lights,
                         struct arena *arena, const struct node *root, struct error *error) {
    for (uint32_t i = 0; i < world->light_count; i++) {
        const struct scene_light *light = &authored[i];
        lights[i].lit = NULL;
        if ((!light->include && !light->exclude) || world->primitive_count == 0)
            continue;
        uint8_t *lit = arena_alloc_array(arena, world->primitive_count, 1);
        bool ok = lit != NULL;
        if (ok)
            memset(lit, light->include == NULL, world->primitive_count);
        ok = ok && (!light->include || light_lists_mark(world, light->include, light->include_count, lit, 1, root)) &&
             (!light->exclude || light_lists_mark(world, light->exclude, light->exclude_count, lit, 0, root));
        if (!ok)
            return error_no_memory(error, "the lights of the scene");
        lights[i].lit = lit;
        lights[i].lit_count = world->primitive_count;
    }
    return true;
}
