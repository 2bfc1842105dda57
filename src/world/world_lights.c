/* See world_lights.h. A sphere, a planar shape and a mesh become a light of a kind that samples them; everything else
 * is sampled by the solid angle of its bound, a ball or a box, and the ray decides whether it hits an emitting surface.
 * The same holds for moving primitives: the bound contains their whole motion. Unbounded primitives cannot be sampled;
 * rays hit them. */
#include "world/world_lights.h"
#include "light/light_edit.h"
#include "math/elementary.h"

#include "base/mem.h"
#include "light/light_mesh.h"
#include "material/classic.h"
#include "material/material_eval.h"
#include "world/mesh_lights_internal.h"

#include <string.h>

/* --- emission --- */

/* Of a prototype: its brightest material. */
struct emission {
    struct colour colour;
    bool emissive, varies;
};

static void collect_emission(const struct world *world, uint32_t first, uint32_t slots, struct emission *out) {
    for (uint32_t i = first; i < first + (slots > 1 ? slots : 1); i++) {
        const struct surface_material *material = &world->surfaces.materials[i];
        struct colour colour = surface_emission(&world->surfaces, material);
        struct colour bound = surface_emission_bound(&world->surfaces, material);
        bool brighter = colour_max_abs(colour) > colour_max_abs(out->colour);
        out->emissive = out->emissive || colour_max_abs(colour) > 0 || colour_max_abs(bound) > 0;
        out->varies = out->varies || surface_emission_varies(material);
        out->colour = brighter ? colour : out->colour;
    }
}

static struct emission emission_of_prototype(const struct world *world, const struct prototype *prototype) {
    struct emission out = {.varies = prototype->holes || prototype->cull != CULL_NONE};
    if (!prototype->geometry.csg) {
        collect_emission(world, prototype->material, prototype->slot_count, &out);
        return out;
    }
    for (uint32_t i = 0; i < prototype->geometry.csg->leaf_count; i++) {
        const struct csg_leaf *leaf = &prototype->geometry.csg->leaves[i];
        collect_emission(world, leaf->material, leaf->slot_count, &out);
    }
    return out;
}

/* --- lights of shapes --- */

static struct vec3 column(const struct affine *map, int i) {
    return vec3_make(map->m[0][i], map->m[1][i], map->m[2][i]);
}

static bool keeps_right_angles(const struct affine *map) {
    for (int i = 0; i < 3; i++) {
        struct vec3 a = column(map, i), b = column(map, (i + 1) % 3);
        if (!(fabs(vec3_dot(a, b)) <= 0x1p-40 * vec3_length(a) * vec3_length(b)))
            return false;
    }
    return true;
}

/* The factor of lengths of a map; 0: it differs between directions. */
static double similarity(const struct affine *map) {
    double squared = vec3_length_squared(column(map, 0));
    for (int i = 1; i < 3; i++)
        if (!(fabs(vec3_length_squared(column(map, i)) - squared) <= 0x1p-40 * squared))
            return 0;
    return keeps_right_angles(map) ? sqrt(squared) : 0;
}

/* A light that represents a primitive. */
struct derived {
    const struct world *world;
    uint32_t primitive;
    struct transform map; /* world from object */
    struct light light;
    struct emitter emitter;
    bool varies; /* the emission of its materials */
    struct arena *arena;
    struct pool *pool;
    struct error *error;
};

/* The transformed box of its shape if it keeps its right angles, else its box in the world. */
static struct light_box bounding_box(const struct derived *d, bool moves) {
    struct box box = geometry_bounds(primitive_geometry(d->world, d->primitive));
    bool own = !moves && keeps_right_angles(&d->map.forward) && vec3_finite(box.min) && vec3_finite(box.max);
    if (!own)
        box = d->world->boxes[d->primitive];
    /* Planar shapes also get a box with faces on all sides. */
    double margin = 0x1p-20 * vec3_max_abs(vec3_sub(box.max, box.min));
    box.min = vec3_sub(box.min, vec3_all(margin));
    box.max = vec3_add(box.max, vec3_all(margin));
    struct vec3 size = vec3_sub(box.max, box.min);
    struct light_box out = {box.min, {{size.x, 0, 0}, {0, size.y, 0}, {0, 0, size.z}}};
    if (own)
        out.corner = affine_point(&d->map.forward, out.corner);
    for (int i = 0; i < 3 && own; i++)
        out.edges[i] = affine_vector(&d->map.forward, out.edges[i]);
    return out;
}

/* The bound with the smaller mean projected area (a quarter of its surface, Cauchy). False: it is unbounded. */
static bool derive_bound(struct derived *d, bool moves, bool *ok) {
    struct light_box box = bounding_box(d, moves);
    struct vec3 diagonal = vec3_add(vec3_add(box.edges[0], box.edges[1]), box.edges[2]);
    double sides[3], radius = vec3_length(diagonal) / 2;
    for (int i = 0; i < 3; i++)
        sides[i] = vec3_length(box.edges[i]);
    double of_box = (sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0]) / 2;
    d->light.kind = LIGHT_SPHERE;
    d->light.position = vec3_add_scaled(box.corner, diagonal, 0.5);
    d->light.radius = radius * (1 + 0x1p-30);
    d->emitter.decided = true;
    if (!vec3_finite(d->light.position) || !(radius > 0) || !isfinite(radius))
        return false;
    if (of_box >= PI * radius * radius)
        return true;
    struct light_box *kept = arena_alloc(d->arena, sizeof *kept);
    *ok = kept || error_no_memory(d->error, "the bound of a light");
    if (kept)
        *kept = box;
    d->emitter.bound = kept;
    return *ok;
}

static bool derive_sphere(struct derived *d, bool *ok) {
    const struct shape *shape = &primitive_geometry(d->world, d->primitive)->shape;
    double factor = similarity(&d->map.forward);
    if (!(factor > 0))
        return derive_bound(d, false, ok);
    d->light.kind = LIGHT_SPHERE;
    d->light.position = affine_point(&d->map.forward, shape->sphere.centre);
    d->light.radius = shape->sphere.radius * factor;
    return true;
}

/* The parallelogram of the points origin + a u + b v. */
static bool derive_parallelogram(struct derived *d, const struct planar *planar, double a0, double b0, double a1,
                                 double b1) {
    struct vec3 corner = vec3_add_scaled(vec3_add_scaled(planar->origin, planar->u, a0), planar->v, b0);
    d->light.kind = LIGHT_PARALLELOGRAM;
    d->light.corner = affine_point(&d->map.forward, corner);
    d->light.edge1 = affine_vector(&d->map.forward, vec3_scale(planar->u, a1 - a0));
    d->light.edge2 = affine_vector(&d->map.forward, vec3_scale(planar->v, b1 - b0));
    d->light.position = vec3_add_scaled(vec3_add_scaled(d->light.corner, d->light.edge1, 0.5), d->light.edge2, 0.5);
    return vec3_length(vec3_cross(d->light.edge1, d->light.edge2)) > 0;
}

static bool derive_disc(struct derived *d, const struct planar *planar) {
    struct vec3 u = affine_vector(&d->map.forward, planar->u), v = affine_vector(&d->map.forward, planar->v);
    double squared = vec3_length_squared(u);
    bool round =
        fabs(vec3_length_squared(v) - squared) <= 0x1p-40 * squared && fabs(vec3_dot(u, v)) <= 0x1p-40 * squared;
    d->emitter.decided = d->emitter.decided || !round || planar->inner > 0;
    if (!round)
        return derive_parallelogram(d, planar, -1, -1, 1, 1);
    d->light.kind = LIGHT_DISC;
    d->light.position = affine_point(&d->map.forward, planar->origin);
    d->light.direction = vec3_normalize(vec3_cross(u, v));
    d->light.radius = sqrt(squared);
    return d->light.radius > 0;
}

static bool derive_triangle(struct derived *d, const struct planar *planar, bool *ok) {
    struct light_mesh *mesh = arena_alloc(d->arena, sizeof *mesh);
    struct light_mesh_builder builder;
    struct vec3 corners[3] = {planar->origin, vec3_add(planar->origin, planar->u), vec3_add(planar->origin, planar->v)};
    double size = 0;
    *ok = (mesh && light_mesh_begin(&builder, 1, d->arena)) || error_no_memory(d->error, "a triangle as a light");
    if (!*ok)
        return false;
    for (int i = 0; i < 3; i++) {
        size = math_max(size, vec3_max_abs(corners[i]) * transform_stretch(&d->map));
        corners[i] = affine_point(&d->map.forward, corners[i]);
        size = math_max(size, vec3_max_abs(corners[i]));
    }
    builder.one_sided = false;
    builder.primitive = d->primitive;
    light_mesh_add(&builder, corners, 1, size, d->light.colour);
    light_mesh_end(&builder, colour_all(1), mesh);
    d->light.kind = LIGHT_MESH;
    d->light.mesh = mesh;
    d->emitter.by_triangle = true;
    return mesh->count > 0;
}

/* The rectangle around a polygon, along its own axes. */
static bool derive_polygon(struct derived *d, const struct planar *planar) {
    struct vec3 n = vec3_cross(planar->u, planar->v);
    double squared = vec3_length_squared(n), low[2], high[2];
    const struct vec3 rows[2] = {vec3_scale(vec3_cross(planar->v, n), 1 / squared),
                                 vec3_scale(vec3_cross(n, planar->u), 1 / squared)};
    for (int i = 0; i < 2; i++) {
        double start = vec3_dot(rows[i], planar->origin);
        planar_extent(planar, rows[i], &low[i], &high[i]);
        low[i] -= start;
        high[i] -= start;
    }
    d->emitter.decided = true;
    return derive_parallelogram(d, planar, low[0], low[1], high[0], high[1]);
}

static bool derive_planar(struct derived *d, bool *ok) {
    const struct planar *planar = &primitive_geometry(d->world, d->primitive)->shape.planar;
    switch (planar->kind) {
    case PLANAR_PLANE:
        break;
    case PLANAR_PARALLELOGRAM:
        return derive_parallelogram(d, planar, 0, 0, 1, 1);
    case PLANAR_DISC:
        return derive_disc(d, planar);
    case PLANAR_TRIANGLE:
        return derive_triangle(d, planar, ok);
    case PLANAR_POLYGON:
        return derive_polygon(d, planar);
    }
    return false;
}

static bool derive_mesh(struct derived *d, bool *ok) {
    d->light.kind = LIGHT_MESH;
    d->emitter.by_triangle = true;
    struct light unit = {.colour = {1, 1, 1}};
    *ok = mesh_lights_primitive(d->world, d->primitive, &unit, d->arena, d->error) &&
          (!d->varies || mesh_lights_estimate(d->world, &unit, d->arena, d->pool, d->error));
    d->light.mesh = unit.mesh;
    return *ok && unit.mesh->count > 0;
}

/* False: the primitive cannot be sampled, or *ok says that memory ran out. */
static bool derive(struct derived *d, bool *ok) {
    *ok = true;
    if (primitive_moves(d->world, d->primitive))
        return derive_bound(d, true, ok);
    d->map = world_placement(d->world, d->primitive, 0.5);
    switch (geometry_area(primitive_geometry(d->world, d->primitive))) {
    case SHAPE_AREA_SPHERE:
        return derive_sphere(d, ok);
    case SHAPE_AREA_PLANAR:
        return derive_planar(d, ok);
    case SHAPE_AREA_TRIANGLES:
        return derive_mesh(d, ok);
    case SHAPE_AREA_UNKNOWN:
        break;
    }
    return derive_bound(d, false, ok);
}

/* --- building --- */

struct building {
    struct world_lights *out;
    struct light *lights;
    struct emitter *emitters;
    uint32_t *of_primitive;
    uint32_t *owner_of; /* by moving primitive: the first mesh light over it, or LIGHT_NONE; NULL: all of them */
    struct emission *of_prototype;
    struct arena *arena;
    struct pool *pool;
    struct error *error;
};

/* A light of the scene. If several lights use one primitive, it belongs to the first. The triangles of a mesh light
 * have one position; primitives that move become lights of their own (take_primitive). */
static bool take_light(struct building *b, uint32_t number) {
    static const struct light_mesh no_triangles = {.shown = true};
    const struct world *world = b->out->world;
    struct light *light = &b->lights[number];
    bool varies = false, rests = !light->mesh || !light->mesh->shown || light->mesh->count == 0;
    struct emitter *emitter = &b->emitters[number];
    *emitter = (struct emitter){
        .primitive = WORLD_NOTHING, .owner = LIGHT_NONE, .unmet = light_is_delta(light), .emission = light->colour};
    /* A light of a mesh is met by rays where its triangles are. */
    if (!light->mesh)
        return true;
    emitter->shown = light->mesh->shown;
    emitter->by_triangle = true;
    emitter->has_own = light->has_emission;
    if (light->has_emission)
        emitter->emission = colour_mul(light->emission, light->colour);
    for (uint32_t i = 0; i < light->mesh->count && light->mesh->shown; i++) {
        uint32_t primitive = light->mesh->triangles[i].primitive;
        if (primitive_moves(world, primitive))
            continue;
        rests = true;
        if (b->of_primitive[primitive] != LIGHT_NONE)
            continue;
        const struct prototype *prototype = primitive_prototype(world, primitive);
        b->of_primitive[primitive] = number;
        varies = varies || (!light->has_emission && b->of_prototype[world->primitives[primitive].prototype].varies);
        emitter->decided = emitter->decided || prototype->holes || prototype->cull != CULL_NONE || varies;
    }
    /* All of its triangles move: each of them is a light of its own. */
    if (!rests)
        light->mesh = &no_triangles;
    return !emitter->decided || !varies || mesh_lights_estimate(world, light, b->arena, b->pool, b->error);
}

static bool has_moving_triangle(const struct world *world, const struct light_mesh *mesh) {
    for (uint32_t k = 0; mesh && mesh->shown && k < mesh->count; k++)
        if (primitive_moves(world, mesh->triangles[k].primitive))
            return true;
    return false;
}

/* One pass over the triangles of all mesh lights. */
static bool find_owners(struct building *b) {
    const struct world *world = b->out->world;
    for (uint32_t i = world->light_count; i-- > 0;) {
        const struct light_mesh *mesh = world->lights[i].mesh;
        if (!has_moving_triangle(world, mesh))
            continue;
        if (!b->owner_of) {
            b->owner_of = mem_alloc((size_t)world->primitive_count * sizeof *b->owner_of);
            for (uint32_t k = 0; b->owner_of && k < world->primitive_count; k++)
                b->owner_of[k] = LIGHT_NONE;
        }
        if (!b->owner_of)
            return false;
        for (uint32_t k = 0; k < mesh->count; k++)
            b->owner_of[mesh->triangles[k].primitive] = i;
    }
    return true;
}

/* The first mesh light over a moving primitive; LIGHT_NONE: none. */
static uint32_t moving_owner(const struct building *b, uint32_t primitive) {
    return b->owner_of && primitive_moves(b->out->world, primitive) ? b->owner_of[primitive] : LIGHT_NONE;
}

/* The light of a moving primitive has the lists, the emission and the colour of its mesh light. */
static void take_over(struct derived *d, const struct light *owner, const struct emitter *of_owner) {
    bool own = of_owner->has_own;
    d->light.lit = owner->lit;
    d->light.lit_count = owner->lit_count;
    d->light.colour = own ? of_owner->emission : colour_mul(d->light.colour, owner->colour);
    d->emitter.has_own = own;
    d->emitter.emission = own ? of_owner->emission : owner->colour;
}

static bool take_primitive(struct building *b, uint32_t primitive) {
    const struct world *world = b->out->world;
    const struct emission *emission = &b->of_prototype[world->primitives[primitive].prototype];
    uint32_t owner = moving_owner(b, primitive);
    if ((!emission->emissive && owner == LIGHT_NONE) || b->of_primitive[primitive] != LIGHT_NONE)
        return true;
    struct derived d = {.world = world,
                        .primitive = primitive,
                        .light = {.emissive = true, .colour = emission->colour},
                        .emitter = {.primitive = primitive, .owner = owner, .shown = true, .decided = emission->varies},
                        .varies = emission->varies,
                        .arena = b->arena,
                        .pool = b->pool,
                        .error = b->error};
    /* Of a mesh light that moves, or of the material. */
    d.emitter.emission = colour_all(1);
    if (owner != LIGHT_NONE)
        take_over(&d, &world->lights[owner], &b->emitters[owner]);
    bool ok;
    if (!derive(&d, &ok))
        return ok;
    if (!light_prepare(&d.light, b->arena, b->pool, b->error))
        return false;
    uint32_t number = b->out->count++;
    b->lights[number] = d.light;
    b->emitters[number] = d.emitter;
    b->of_primitive[primitive] = number;
    return true;
}

/* Unless it is black. */
static bool take_background(struct building *b) {
    struct light *light = &b->lights[b->out->count];
    if (sky_is_black(&b->out->world->sky))
        return true;
    for (uint32_t i = 0; i < b->out->count; i++)
        if (light_properties(&b->lights[i]) & LIGHT_IS_ENVIRONMENT)
            return true;
    *light = (struct light){.kind = LIGHT_SKY, .emissive = true, .colour = {1, 1, 1}, .sky = &b->out->world->sky};
    b->emitters[b->out->count++] = (struct emitter){.primitive = WORLD_NOTHING, .owner = LIGHT_NONE};
    return light_prepare(light, b->arena, b->pool, b->error);
}

/* How many parts of a light of the scene rays find in the tree of area lights. */
static uint32_t surfaces_of(const struct light *light) {
    struct box box;
    if (light->mesh)
        return light->mesh->shown ? 0 : light->mesh->count;
    return (!light_is_delta(light) || light->visible) && light_surface_box(light, &box);
}

static struct box box_of_part(const struct light *light, uint32_t part) {
    struct box box = box_empty();
    if (light->mesh)
        return light_triangle_box(light->mesh, part);
    (void)light_surface_box(light, &box);
    return box;
}

/* Rays meet a lamp a little before its plane. */
static struct box box_met(const struct light *light, uint32_t part) {
    struct box box = box_of_part(light, part);
    double gap = 0x1p-38 * math_max(vec3_max_abs(box.min), vec3_max_abs(box.max));
    return box_grow(box, gap);
}

/* And before the surface in which they end. */
static double end_met(double t_max) {
    return t_max * (1 + 0x1p-38);
}

static bool build_area_lights(struct building *b) {
    struct world_lights *out = b->out;
    uint64_t total = 0;
    for (uint32_t i = 0; i < out->world->light_count; i++)
        total += surfaces_of(&b->lights[i]);
    if (total >= BOX_TREE_ITEM)
        return error_set(b->error, ERROR_SCENE, "the scene has too many emitting triangles");
    struct light_part *area_lights = arena_alloc_array(b->arena, total, sizeof *area_lights);
    struct box *boxes = mem_alloc_zero(total + 1, sizeof *boxes);
    bool ok = (area_lights && boxes) || error_no_memory(b->error, "the lights of the scene");
    for (uint32_t i = 0; ok && i < out->world->light_count; i++) {
        for (uint32_t part = 0; part < surfaces_of(&b->lights[i]); part++) {
            boxes[out->area_light_count] = box_met(&b->lights[i], part);
            area_lights[out->area_light_count++] = (struct light_part){i, part};
        }
    }
    out->area_lights = area_lights;
    ok = ok && (out->area_light_count == 0 ||
                box_tree_build(&out->surfaces, boxes, out->area_light_count, b->pool, b->error));
    mem_free(boxes);
    return ok;
}

static bool allocate(struct building *b) {
    const struct world *world = b->out->world;
    uint32_t emitting = 0;
    b->of_prototype = arena_alloc_array(b->arena, (size_t)world->prototype_count + 1, sizeof *b->of_prototype);
    b->of_primitive = arena_alloc_array(b->arena, (size_t)world->primitive_count + 1, sizeof *b->of_primitive);
    if (!b->of_prototype || !b->of_primitive || !find_owners(b))
        return false;
    for (uint32_t i = 0; i < world->prototype_count; i++) {
        b->of_prototype[i] = emission_of_prototype(world, &world->prototypes[i]);
        b->out->holes = b->out->holes || world->prototypes[i].holes;
        b->out->met = b->out->met || b->of_prototype[i].emissive || b->of_prototype[i].varies;
    }
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        b->of_primitive[i] = LIGHT_NONE;
        emitting += b->of_prototype[world->primitives[i].prototype].emissive || moving_owner(b, i) != LIGHT_NONE;
    }
    size_t max = (size_t)world->light_count + emitting + 1;
    b->lights = arena_alloc_array(b->arena, max, sizeof *b->lights);
    b->emitters = arena_alloc_array(b->arena, max, sizeof *b->emitters);
    return b->lights && b->emitters;
}

static bool build(struct building *b, struct world_lights_options options) {
    struct world_lights *out = b->out;
    const struct world *world = out->world;
    if (!allocate(b))
        return error_no_memory(b->error, "the lights of the scene");
    out->lights = b->lights;
    out->emitters = b->emitters;
    out->of_primitive = b->of_primitive;
    if (world->light_count > 0)
        memcpy(b->lights, world->lights, world->light_count * sizeof *b->lights);
    out->count = world->light_count;
    /* The lights of the script first, so that they keep their numbers; then emissive surfaces. */
    for (uint32_t i = 0; i < world->light_count; i++)
        if (!take_light(b, i))
            return false;
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        if ((i & 1023) == 0 && pool_cancelled(b->pool))
            return error_set(b->error, ERROR_CANCELLED, "stopped while the lights of the scene were gathered");
        if (!take_primitive(b, i))
            return false;
    }
    /* The sampler needs all of them. */
    const struct light_sampler_options choice = {options.choice, b->pool};
    if ((options.background && !take_background(b)) || !build_area_lights(b))
        return false;
    out->met = out->met || out->area_light_count > 0;
    for (uint32_t i = 0; i < out->count; i++)
        out->met = out->met || !light_is_delta(&out->lights[i]);
    return light_sampler_build(&out->sampler, choice, out->lights, out->count, b->arena, b->error);
}

bool world_lights_build(struct world_lights *out, const struct world *world, struct world_lights_options options,
                        struct arena *arena, struct pool *pool, struct error *error) {
    struct building b = {.out = out, .arena = arena, .pool = pool, .error = error};
    *out = (struct world_lights){.world = world};
    bool ok = build(&b, options);
    mem_free(b.owner_of);
    if (!ok)
        world_lights_destroy(out);
    return ok;
}

void world_lights_destroy(struct world_lights *lights) {
    box_tree_destroy(&lights->surfaces);
}

/* --- sampling --- */

/* Whether a mesh light has a triangle: of several over one primitive the first has it. */
static bool is_own_triangle(const struct world_lights *lights, uint32_t light, uint32_t triangle) {
    const struct emitter *emitter = &lights->emitters[light];
    if (!emitter->shown || !emitter->by_triangle)
        return true;
    return lights->of_primitive[lights->lights[light].mesh->triangles[triangle].primitive] == light;
}

/* A part of a light as a receiver sees it: a triangle, the context of a light, or the bound that is sampled instead. */
struct view {
    const struct light *light;
    struct light_context context;
    struct spherical_box bound;
    bool by_triangle, by_bound;
};

static bool view_make(const struct world_lights *lights, const struct light_receiver *receiver, uint32_t light,
                      struct view *out) {
    const struct light_box *bound = lights->emitters[light].bound;
    out->light = &lights->lights[light];
    out->by_triangle = lights->emitters[light].by_triangle;
    out->by_bound = bound && spherical_box_make(bound, receiver->from, &out->bound);
    return out->by_triangle || out->by_bound ||
           light_context_make(out->light, receiver->point, receiver->from, &out->context);
}

static struct light_sample view_sample(const struct view *view, uint32_t triangle,
                                       const struct light_receiver *receiver, struct sample2 xi) {
    if (view->by_triangle)
        return light_triangle_sample(view->light->mesh, triangle, receiver->point, receiver->from, xi);
    if (!view->by_bound)
        return light_sample(view->light, &view->context, xi);
    struct light_sample sample = {.pdf = 1 / view->bound.angle};
    sample.target.at = spherical_box_point(&view->bound, xi);
    sample.direction = vec3_normalize(vec3_sub(sample.target.at, receiver->point));
    return sample;
}

/* A light without extent, whose samples for a receiver are equal. */
static bool sample_point_light(const struct light *light, struct vec3 point, struct world_light_sample *out) {
    struct light_arrival arrival;
    if (!light_arrive(light, point, &arrival))
        return false;
    out->direction = arrival.direction;
    out->target = arrival.middle;
    out->radiance = colour_scale(colour_scale(arrival.colour, arrival.strength), radiance_of(1));
    out->pdf = 1;
    out->is_delta = true;
    out->decided = false;
    out->triangle = 0;
    out->skip_primitive = 0;
    return !colour_is_black(out->radiance);
}

/* Separate, so that lights without extent need not prepare for it. */
static __attribute__((noinline)) bool sample_extended_light(const struct world_lights *lights,
                                                            const struct light_receiver *receiver,
                                                            struct light_part part, struct sample2 xi,
                                                            struct world_light_sample *out) {
    uint32_t number = part.light;
    const struct emitter *emitter = &lights->emitters[number];
    struct view view;
    if (!view_make(lights, receiver, number, &view))
        return false;
    struct light_sample sample = view_sample(&view, part.triangle, receiver, xi);
    if (!(sample.pdf > 0) || !is_own_triangle(lights, number, part.triangle))
        return false;
    bool own = emitter->shown && receiver->primitive == emitter->primitive && receiver->primitive != WORLD_NOTHING;
    out->direction = sample.direction;
    out->target = sample.target;
    out->radiance = sample.is_delta ? colour_scale(sample.intensity, radiance_of(1)) : sample.radiance;
    out->pdf = sample.pdf;
    out->is_delta = emitter->unmet;
    out->decided = emitter->decided || own;
    out->triangle = part.triangle;
    bool single = emitter->shown && !emitter->by_triangle && !out->decided;
    out->skip_primitive = single ? emitter->primitive + 1 : 0;
    return out->decided || !colour_is_black(out->radiance);
}

bool world_lights_sample(const struct world_lights *lights, const struct light_receiver *receiver,
                         struct light_part part, struct sample2 xi, struct world_light_sample *out) {
    const struct light *light = &lights->lights[part.light];
    out->light = part.light;
    if (!world_lights_illuminate(lights, part.light, receiver->primitive))
        return false;
    if (light_is_point(light))
        return sample_point_light(light, receiver->point, out);
    return sample_extended_light(lights, receiver, part, xi, out);
}

static uint32_t triangle_of_hit(const struct world_lights *lights, uint32_t light, const struct hit *hit) {
    bool by_triangle = lights->emitters[light].by_triangle;
    return by_triangle ? light_mesh_find(lights->lights[light].mesh, hit->primitive, hit->part) : 0;
}

bool world_lights_shows(const struct world_lights *lights, const struct world_light_sample *sample,
                        const struct hit *hit) {
    if (lights->of_primitive[hit->primitive] != sample->light)
        return false;
    return triangle_of_hit(lights, sample->light, hit) == sample->triangle;
}

struct colour world_lights_radiance(const struct world_lights *lights, uint32_t primitive, const struct hit *hit,
                                    struct colour emission) {
    uint32_t light = lights->of_primitive[hit->primitive];
    if (light == LIGHT_NONE)
        return emission;
    const struct emitter *emitter = &lights->emitters[light];
    if (emitter->unmet || !world_lights_illuminate(lights, light, primitive))
        return colour_all(0);
    return emitter->has_own ? emitter->emission : colour_mul(emission, emitter->emission);
}

double world_lights_pdf(const struct world_lights *lights, const struct light_receiver *receiver, uint32_t light,
                        struct vec3 direction, const struct light_hit *hit) {
    struct view view;
    if (lights->emitters[light].unmet || !world_lights_illuminate(lights, light, receiver->primitive))
        return 0;
    const struct light_part part = {light, lights->emitters[light].by_triangle ? hit->triangle : 0};
    double pmf = light_sampler_pmf(&lights->sampler, receiver->point, receiver->normal, part);
    if (!(pmf > 0) || !view_make(lights, receiver, light, &view))
        return 0;
    if (view.by_triangle)
        return pmf * light_triangle_pdf(view.light->mesh, receiver->from, hit);
    if (view.by_bound)
        return pmf * spherical_box_pdf(lights->emitters[light].bound, &view.bound, receiver->from, direction);
    return pmf * light_pdf(view.light, &view.context, direction, hit);
}

double world_lights_pdf_of_hit(const struct world_lights *lights, const struct light_receiver *receiver,
                               struct vec3 direction, const struct hit *hit) {
    uint32_t light = lights->of_primitive[hit->primitive];
    uint32_t triangle = light != LIGHT_NONE ? triangle_of_hit(lights, light, hit) : LIGHT_NONE;
    if (triangle == LIGHT_NONE)
        return 0;
    struct light_hit met = {.t = hit->t, .point = hit->point, .triangle = triangle};
    return world_lights_pdf(lights, receiver, light, direction, &met);
}

/* --- shadow rays --- */

enum { HOLE_LIMIT = 1000 };

/* The next hit of the rest of a ray, with its BSDF. */
static bool next_surface(const struct world *world, const struct ray *rest, struct world_scratch *scratch,
                         struct hit *hit, struct bsdf *bsdf) {
    if (!world_nearest(world, rest, scratch, hit))
        return false;
    material_eval(&world->surfaces, hit, NULL, NULL, bsdf);
    return true;
}

double world_lights_visible(const struct world_lights *lights, const struct ray *ray, struct world_scratch *scratch) {
    if (!lights->holes)
        return !world_any(lights->world, ray, scratch);
    struct ray rest = *ray;
    struct hit hit;
    struct bsdf bsdf;
    double share = 1;
    for (int i = 0; i < HOLE_LIMIT && share > 0 && next_surface(lights->world, &rest, scratch, &hit, &bsdf); i++) {
        share *= 1 - math_min(bsdf.opacity, 1);
        rest.t_min = hit.t;
    }
    return share;
}

struct colour world_lights_seen_by(const struct world_lights *lights, const struct light_receiver *receiver,
                                   const struct world_light_sample *sample, const struct ray *ray,
                                   struct world_scratch *scratch, double *t) {
    struct ray rest = *ray;
    struct hit hit;
    struct bsdf bsdf;
    struct colour sum = {0, 0, 0};
    double share = 1;
    *t = 0;
    for (int i = 0; i < HOLE_LIMIT && share > 0 && next_surface(lights->world, &rest, scratch, &hit, &bsdf); i++) {
        double opacity = math_min(bsdf.opacity, 1);
        if (opacity > 0 && world_lights_shows(lights, sample, &hit)) {
            struct colour radiance = world_lights_radiance(lights, receiver->primitive, &hit, bsdf.emission);
            sum = colour_add_scaled(sum, radiance, share * opacity);
            *t = hit.t;
        }
        share *= 1 - opacity;
        rest.t_min = hit.t;
    }
    return sum;
}

/* --- lamps --- */

void world_lights_met_begin(struct world_lights_traversal *traversal, const struct world_lights *lights,
                            const struct ray *ray) {
    traversal->lights = lights;
    traversal->ray = ray;
    traversal->tree.top = 0;
    if (lights->area_light_count > 0)
        box_tree_traversal_begin(&traversal->tree, &lights->surfaces, ray);
}

bool world_lights_met_next(struct world_lights_traversal *traversal, uint32_t *light, struct light_hit *hit) {
    uint32_t item;
    while (box_tree_traversal_next(&traversal->tree, end_met(traversal->ray->t_max), &item)) {
        struct light_part part = traversal->lights->area_lights[item];
        const struct light *area_light = &traversal->lights->lights[part.light];
        *light = part.light;
        if (area_light->mesh ? light_triangle_meets_ray(area_light->mesh, part.triangle, traversal->ray, hit)
                             : !light_is_delta(area_light) && light_meets_ray(area_light, traversal->ray, hit))
            return true;
    }
    return false;
}

bool world_lights_seen(const struct world_lights *lights, const struct ray *ray, uint32_t *light,
                       struct light_hit *hit) {
    struct box_tree_traversal traversal;
    struct ray limited = *ray;
    struct light_hit met;
    uint32_t item;
    bool found = false;
    if (lights->area_light_count == 0)
        return false;
    box_tree_traversal_begin(&traversal, &lights->surfaces, ray);
    while (box_tree_traversal_next(&traversal, end_met(limited.t_max), &item)) {
        uint32_t number = lights->area_lights[item].light;
        if (!lights->lights[number].visible || !light_meets_ray(&lights->lights[number], &limited, &met))
            continue;
        *light = number;
        *hit = met;
        limited.t_max = met.t;
        found = true;
    }
    return found;
}

static void bundle_bound(struct bundle *bundle, void *emitter) {
    BUNDLE(bundle, ((struct emitter *)emitter)->bound, 1, NULL);
}

void world_lights_bundle(struct bundle *bundle, void *world_lights) {
    struct world_lights *lights = world_lights;
    BUNDLE(bundle, lights->of_primitive, lights->world->primitive_count, NULL);
    BUNDLE(bundle, lights->world, 1, world_bundle);
    BUNDLE(bundle, lights->lights, lights->count, light_bundle);
    light_sampler_bundle(bundle, &lights->sampler, lights->count);
    BUNDLE(bundle, lights->emitters, lights->count, bundle_bound);
    box_tree_bundle(bundle, &lights->surfaces);
    BUNDLE(bundle, lights->area_lights, lights->area_light_count, NULL);
}
