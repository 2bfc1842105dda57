/* A light with a position is surrounded by a cube whose faces are quadtrees of cells, each cell a pyramid of
 * directions; a distant light by a square across its rays. A cell is active if its pyramid, extended by the extent of
 * the light, can intersect the box of a specular object. Cells are as small as the maximum number of cells allows, so
 * photons find small distant objects as well as large near ones.
 *
 * The importance of a cell is its solid angle (area), times the strength of its most specular object, times the
 * brightness of the light in its direction. Systematic sampling gives each cell its share of the photons. Inside the
 * cell they follow the additive recurrence of the generalised golden ratio (Roberts, "The Unreasonable Effectiveness of
 * Quasirandom Sequences", 2018), moved by an offset of the cell. The weight of a photon is exactly the intensity of the
 * light divided by the density of photons. Invariant: every cell that light can pass to a specular object is active.
 *
 * An environment emits from all sides: it chooses directions itself, and each has its rectangle across.
 *
 * Units (docs/design/light.md): a light without an extent emits its colour per steradian, times d^2 attenuation(d)
 * after the distance d, so that unblocked light arrives as colour * attenuation(d) * cosine. A lamp emits radiance / pi
 * per area and projected solid angle, because a view factor is a cosine over pi. */
#include "photon/photon_target_internal.h"

#include "base/random.h"
#include "math/elementary.h"
#include "math/frame.h"
#include "math/portable.h"

#include <string.h>

enum {
    BUDGET = 16384,
    MIN_BUDGET = 128,
    PHOTONS_PER_CELL = 16,
    LEVEL_MIN = 3,
    LEVEL_MAX = 14,
    PARTS = 4,
    CANCEL_EVERY = 256
};

/* --- what is specular --- */

struct specular_object {
    struct box box;
    struct vec3 middle;
    double radius; /* of a bounding ball around its centre */
    double strength;
    uint32_t order;
};

struct specular_objects {
    struct specular_object *list; /* the strongest first */
    uint32_t count;
    struct box all;     /* of them */
    struct vec3 middle; /* of that box */
    struct box scene;   /* of everything that is finite */
};

static double primitive_strength(const struct world *world, uint32_t index) {
    const struct prototype *prototype = primitive_prototype(world, index);
    const struct csg *csg = prototype->geometry.csg;
    double max = 0;
    for (uint32_t leaf = 0; leaf < (csg ? csg->leaf_count : 1); leaf++) {
        uint32_t material = csg ? csg->leaves[leaf].material : prototype->material;
        uint32_t slots = csg ? csg->leaves[leaf].slot_count : prototype->slot_count;
        for (uint32_t slot = 0; slot < (slots > 1 ? slots : 1); slot++) {
            double strength = surface_specular(&world->surfaces.materials[material + slot]);
            max = strength > max ? strength : max;
        }
    }
    return max < 1 ? max : 1;
}

static bool is_finite(const struct box *box) {
    return vec3_finite(box->min) && vec3_finite(box->max);
}

static struct specular_object specular_object_make(const struct world *world, uint32_t index, const struct box *box,
                                                   double strength) {
    struct specular_object specular_object = {.box = *box, .strength = strength, .order = index};
    const struct geometry *geometry = primitive_geometry(world, index);
    uint32_t linear = world->primitives[index].linear;
    bool still = linear == LINEAR_NONE || !(linear & LINEAR_MOVING);
    specular_object.middle = vec3_scale(vec3_add(box->min, box->max), 0.5);
    specular_object.radius = vec3_length(vec3_sub(box->max, specular_object.middle));
    if (!geometry->csg && geometry->shape.kind == SHAPE_SPHERE && still) {
        double stretch = linear == LINEAR_NONE ? 1 : world->linear_maps[linear].stretch;
        specular_object.radius =
            math_min(specular_object.radius, geometry->shape.sphere.radius * stretch * (1 + 0x1p-30));
    }
    return specular_object;
}

/* Photons hit infinite objects within twice the extent of the finite ones. */
static bool find_specular_objects(struct specular_objects *out, const struct world *world, struct arena *arena) {
    *out = (struct specular_objects){.scene = box_empty()};
    uint32_t specular = 0;
    /* First their number, and how large the scene is. */
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        specular += primitive_strength(world, i) > 0;
        if (is_finite(&world->boxes[i]))
            out->scene = box_join(out->scene, world->boxes[i]);
    }
    if (specular == 0 || box_is_empty(&out->scene))
        return true;
    out->list = arena_alloc_array(arena, specular, sizeof *out->list);
    if (!out->list)
        return false;
    /* Infinite objects are cut at three times that size. */
    struct vec3 size = vec3_sub(out->scene.max, out->scene.min);
    struct box limit = {vec3_sub(out->scene.min, size), vec3_add(out->scene.max, size)};
    out->all = box_empty();
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        double strength = primitive_strength(world, i);
        struct box box = box_meet(world->boxes[i], limit);
        if (!(strength > 0) || box_is_empty(&box))
            continue;
        out->all = box_join(out->all, box);
        out->list[out->count++] = specular_object_make(world, i, &box, strength);
    }
    if (out->count > 0)
        out->middle = vec3_scale(vec3_add(out->all.min, out->all.max), 0.5);
    return true;
}

/* By strength, the strongest first, then by order. */
static bool is_stronger(const void *one, const void *other) {
    const struct specular_object *a = one, *b = other;
    return a->strength != b->strength ? a->strength > b->strength : a->order < b->order;
}

/* --- cells --- */

static bool is_distant(const struct photon_target *target) {
    return target->emitter.domain != LIGHT_DOMAIN_LOCAL;
}

/* The coordinate on a face of the cube from one that runs evenly over the angle. */
static double on_face(double a) {
    return el_tan(a * (PI / 4));
}

static void face_axes(uint32_t face, struct vec3 *major, struct vec3 *a, struct vec3 *b) {
    double sign = face & 1 ? -1 : 1;
    *major = vec3_make(face / 2 == 0 ? sign : 0, face / 2 == 1 ? sign : 0, face / 2 == 2 ? sign : 0);
    *a = vec3_make(0, face / 2 != 1, face / 2 == 1);
    *b = vec3_cross(*major, *a);
}

/* A direction of a face (not unit) for (a, b) in -1..1, and its solid angle per area of (a, b). */
static struct vec3 face_direction(uint32_t face, double a, double b, double *density) {
    struct vec3 major, right, up;
    face_axes(face, &major, &right, &up);
    double u = on_face(a), v = on_face(b), squared = 1 + u * u + v * v;
    *density = (PI / 4) * (PI / 4) * (1 + u * u) * (1 + v * v) / (squared * sqrt(squared));
    return vec3_add_scaled(vec3_add_scaled(major, right, u), up, v);
}

/* Half-spaces that hold the cell: normal . p <= reach for every point p that light of the cell may pass. */
struct plane_set {
    struct vec3 normal[5];
    double plane_offset[5];
    int count;
};

static void plane_set_add(struct plane_set *planes, struct vec3 normal, double plane_offset) {
    planes->normal[planes->count] = normal;
    planes->plane_offset[planes->count++] = plane_offset;
}

static void pyramid_planes(const struct photon_target *target, uint32_t face, uint32_t level, uint32_t i, uint32_t j,
                           struct plane_set *planes) {
    struct vec3 major, axes[2];
    double width = math_ldexp(2, -(int)level);
    uint32_t cell[2] = {i, j};
    face_axes(face, &major, &axes[0], &axes[1]);
    planes->count = 0;
    for (int k = 0; k < 2; k++) {
        double low = on_face(-1 + width * cell[k]), high = on_face(-1 + width * (cell[k] + 1));
        struct vec3 below = vec3_normalize(vec3_sub(vec3_scale(major, low), axes[k]));
        struct vec3 above = vec3_normalize(vec3_sub(axes[k], vec3_scale(major, high)));
        plane_set_add(planes, below, vec3_dot(below, target->emitter.centre) + target->emitter.radius);
        plane_set_add(planes, above, vec3_dot(above, target->emitter.centre) + target->emitter.radius);
    }
}

static double box_min(const struct box *box, struct vec3 n) {
    return n.x * (n.x > 0 ? box->min.x : box->max.x) + n.y * (n.y > 0 ? box->min.y : box->max.y) +
           n.z * (n.z > 0 ? box->min.z : box->max.z);
}

static bool plane_set_meets(const struct plane_set *planes, const struct specular_object *specular_object) {
    for (int k = 0; k < planes->count; k++) {
        double by_box = box_min(&specular_object->box, planes->normal[k]);
        double by_ball = vec3_dot(planes->normal[k], specular_object->middle) - specular_object->radius;
        double min = by_box > by_ball ? by_box : by_ball;
        if (min > planes->plane_offset[k] + fabs(planes->plane_offset[k]) * 0x1p-40)
            return false;
    }
    return true;
}

/* Across a distant light: a square against the shadow of a ball, and of a box by the axes of both (separating axes). */
static bool square_meets(const struct photon_target *target, double x, double y, double half,
                         const struct specular_object *specular_object) {
    struct vec3 middle = specular_object->middle, plane_offset = vec3_sub(specular_object->box.max, middle);
    const struct vec3 r = target->emitter.right, u = target->emitter.up;
    double off_x = fabs(vec3_dot(r, middle) - x) - half, off_y = fabs(vec3_dot(u, middle) - y) - half;
    off_x = off_x > 0 ? off_x : 0;
    off_y = off_y > 0 ? off_y : 0;
    if (off_x * off_x + off_y * off_y > specular_object->radius * specular_object->radius * (1 + 0x1p-30))
        return false;
    const double axes[5][2] = {{1, 0}, {0, 1}, {-u.x, r.x}, {-u.y, r.y}, {-u.z, r.z}};
    for (int k = 0; k < 5; k++) {
        struct vec3 n = vec3_add_scaled(vec3_scale(r, axes[k][0]), u, axes[k][1]);
        double off = fabs(vec3_dot(n, middle) - x * axes[k][0] - y * axes[k][1]);
        double own = fabs(n.x) * plane_offset.x + fabs(n.y) * plane_offset.y + fabs(n.z) * plane_offset.z;
        if (off > (own + half * (fabs(axes[k][0]) + fabs(axes[k][1]))) * (1 + 0x1p-30))
            return false;
    }
    return true;
}

/* A square of a face of the sphere of directions: face / 2^level in each direction. */
struct target_square {
    uint32_t face, level, i, j;
};

/* The brightness in the middle of a cell, or a little where only another part of it is lit; 0 where none is. */
static double cell_shine(const struct photon_target *target, struct target_square cell, double *solid_angle) {
    double width = math_ldexp(2, -(int)cell.level), a = -1 + width * (cell.i + 0.5), b = -1 + width * (cell.j + 0.5),
           density;
    uint32_t face = cell.face;
    struct vec3 middle = vec3_normalize(face_direction(face, a, b, solid_angle));
    *solid_angle *= width * width;
    double own = light_emitter_shine(&target->emitter, middle), max = own, cos_half = 1;
    for (int k = 0; k < 4; k++) {
        struct vec3 corner =
            face_direction(face, a + width * (k & 1 ? 0.5 : -0.5), b + width * (k & 2 ? 0.5 : -0.5), &density);
        corner = vec3_normalize(corner);
        double at_corner = light_emitter_shine(&target->emitter, corner), cosine = vec3_dot(corner, middle);
        max = at_corner > max ? at_corner : max;
        cos_half = cosine < cos_half ? cosine : cos_half;
    }
    if (max == 0)
        max = light_emitter_shines_near(&target->emitter, middle, cos_half) ? 1 : 0;
    return max > 0 && own < 0.05 ? 0.05 : own;
}

/* --- the search for cells that count --- */

struct search {
    const struct specular_objects *specular_objects;
    struct photon_target *target;
    const struct pool *pool;
    uint32_t *stack; /* lists of casters, one behind the other down the tree */
    uint32_t level, found, limit, steps, budget;
    bool keep, stopped;
};

static void meet_cell(struct search *s, struct target_square cell, uint32_t strongest) {
    struct photon_target *target = s->target;
    double area = 1, bright = 1;
    if (!is_distant(target) && (s->keep || !target->emitter.even))
        bright = cell_shine(target, cell, &area);
    if (!(bright > 0))
        return;
    if (s->keep) {
        double strength = s->specular_objects->list[strongest].strength;
        target->total += area * bright * strength;
        target->cells[s->found] =
            (struct photon_cell){target->total, cell.face, cell.i, cell.j, (float)strength, (float)bright};
    }
    s->found++;
}

/* The light does not shine in any direction of the square, nor of its parts. */
static bool is_dark(const struct photon_target *target, struct target_square square) {
    double area;
    return !is_distant(target) && !target->emitter.even && !(cell_shine(target, square, &area) > 0);
}

/* `list`: the specular objects that the parent square may contain. */
static void visit(struct search *s, struct target_square square, const uint32_t *list, uint32_t count,
                  uint32_t *free_room) {
    uint32_t face = square.face, level = square.level, i = square.i, j = square.j;
    struct photon_target *target = s->target;
    struct plane_set planes;
    double size = math_ldexp(target->size, -(int)level), half = size / 2;
    s->stopped = s->stopped || ((++s->steps % CANCEL_EVERY == 0 || count > 1000) && pool_cancelled(s->pool));
    if (s->stopped || s->found > s->limit)
        return;
    if (!is_distant(target))
        pyramid_planes(target, face, level, i, j, &planes);
    /* What the square meets is what its four parts can meet. */
    uint32_t met = 0;
    for (uint32_t k = 0; k < count; k++) {
        const struct specular_object *specular_object = &s->specular_objects->list[list[k]];
        bool meets = is_distant(target) ? square_meets(target, target->corner[0] + i * size + half,
                                                       target->corner[1] + j * size + half, half, specular_object)
                                        : plane_set_meets(&planes, specular_object);
        if (meets)
            free_room[met++] = list[k];
    }
    if (met == 0 || (level < s->level && is_dark(target, square)))
        return;
    if (level == s->level) {
        meet_cell(s, square, free_room[0]);
        return;
    }
    for (uint32_t k = 0; k < 4; k++)
        visit(s, (struct target_square){face, level + 1, 2 * i + (k & 1), 2 * j + (k >> 1)}, free_room, met,
              free_room + met);
}

static bool search_level(struct search *s, uint32_t level) {
    s->level = s->target->level = level;
    s->found = 0;
    for (uint32_t k = 0; k < s->specular_objects->count; k++)
        s->stack[k] = k;
    for (uint32_t face = 0; face < (is_distant(s->target) ? 1U : 6U); face++)
        visit(s, (struct target_square){face, 0, 0, 0}, s->stack, s->specular_objects->count,
              s->stack + s->specular_objects->count);
    return !s->stopped;
}

/* The finest level whose cells are within the budget. */
static bool find_cells(struct search *s, uint32_t budget, struct arena *arena) {
    uint32_t level = LEVEL_MIN, cells = 0;
    s->keep = false;
    s->limit = UINT32_MAX;
    for (uint32_t next = LEVEL_MIN; next <= LEVEL_MAX; next++) {
        if (!search_level(s, next))
            return true;
        if (next > LEVEL_MIN && s->found > budget)
            break;
        level = next;
        cells = s->found;
        s->limit = budget;
    }
    if (cells == 0)
        return true;
    s->target->cells = arena_alloc_array(arena, cells, sizeof *s->target->cells);
    if (!s->target->cells)
        return false;
    s->keep = true;
    s->limit = UINT32_MAX;
    (void)search_level(s, level);
    s->target->cell_count = s->found;
    return true;
}

/* --- lights --- */

/* The square across a distant light that holds the shadows of all casters, and a plane before the whole scene. */
static void fit_distant_target(struct photon_target *target, const struct specular_objects *specular_objects) {
    struct vec3 direction = light_photon(&target->emitter, vec3_all(0), (struct sample2){0, 0}).direction;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (uint32_t i = 0; i < specular_objects->count; i++) {
        const struct box *box = &specular_objects->list[i].box;
        for (int k = 0; k < 2; k++) {
            struct vec3 axis = k == 0 ? target->emitter.right : target->emitter.up;
            double min = box_min(box, axis), max = -box_min(box, vec3_negate(axis));
            low[k] = min < low[k] ? min : low[k];
            high[k] = max > high[k] ? max : high[k];
        }
    }
    target->size = math_max(high[0] - low[0], high[1] - low[1]);
    target->corner[0] = low[0];
    target->corner[1] = low[1];
    double depth = vec3_length(vec3_sub(specular_objects->scene.max, specular_objects->scene.min));
    target->behind = box_min(&specular_objects->scene, direction) - depth * 0x1p-6;
    for (uint32_t i = 0; i < specular_objects->count; i++)
        target->behind = math_min(target->behind, box_min(&specular_objects->list[i].box, direction) - depth * 0x1p-6);
}

static void estimate_flux(struct photon_target *target, const struct specular_objects *specular_objects) {
    const struct light_emitter *emitter = &target->emitter;
    struct colour colour = light_emitter_colour(emitter);
    double distance = vec3_length(vec3_sub(specular_objects->middle, emitter->centre));
    double attenuation =
        light_photon_attenuation(emitter->light, distance > emitter->radius ? distance : emitter->radius);
    if (!(attenuation > 0)) /* beyond its range at the middle, but maybe not everywhere */
        attenuation = distance * distance * 0x1p-6;
    double cell_area = is_distant(target) ? math_ldexp(target->size * target->size, -2 * (int)target->level) : 1;
    double mean = (fabs(colour.r) + fabs(colour.g) + fabs(colour.b)) / 3;
    target->flux = mean * attenuation * light_emitter_unit(emitter) * target->total * cell_area;
    if (!isfinite(target->flux))
        target->flux = 0;
}

static bool make_target(struct photon_target *target, struct search *search, uint32_t budget, struct arena *arena) {
    search->target = target;
    search->stopped = false;
    if (!find_cells(search, budget, arena))
        return false;
    estimate_flux(target, search->specular_objects);
    return true;
}

static uint32_t light_parts(const struct light *light, const struct specular_objects *specular_objects) {
    double extent = light_divided_extent(light), nearest = INFINITY;
    if (!(extent > 0))
        return 1;
    for (uint32_t i = 0; i < specular_objects->count; i++) {
        const struct box *box = &specular_objects->list[i].box;
        struct vec3 inside = vec3_min(vec3_max(light->position, box->min), box->max);
        nearest = math_min(nearest, vec3_length(vec3_sub(inside, light->position)));
    }
    return extent > 0.1 * nearest ? PARTS : 1;
}

/* Light of an environment: a direction by its own choice, then a place of the rectangle across it that holds the shadow
 * of the box of all casters, before the whole scene. Its power is that of a photon that represents all. */
static struct light_photon start_from_environment(const struct photon_target *target, struct sample2 turn,
                                                  struct sample2 xi) {
    struct light_photon photon = light_photon(&target->emitter, vec3_all(0), turn);
    struct vec3 axes[2], direction = photon.direction;
    frame_tangents(direction, &axes[0], &axes[1]);
    const double at[2] = {xi.x, xi.y};
    double area = 1, before = math_min(box_min(&target->across, direction), box_min(&target->scene, direction));
    photon.origin = vec3_scale(direction, before - target->size * 0x1p-6);
    for (int k = 0; k < 2; k++) {
        double low = box_min(&target->across, axes[k]), width = -box_min(&target->across, vec3_negate(axes[k])) - low;
        area *= width;
        photon.origin = vec3_add_scaled(photon.origin, axes[k], low + width * at[k]);
    }
    photon.power = colour_scale(photon.power, area);
    return photon;
}

/* One cell that is everything; its flux from a few hundred starts. */
static bool target_environment(struct photon_target *target, const struct specular_objects *specular_objects,
                               struct arena *arena) {
    enum { PROBES = 16 };
    target->across = specular_objects->all;
    target->scene = specular_objects->scene;
    target->size = vec3_length(vec3_sub(specular_objects->scene.max, specular_objects->scene.min));
    target->cells = arena_alloc_array(arena, 1, sizeof *target->cells);
    if (!target->cells)
        return false;
    float strength = (float)specular_objects->list[0].strength;
    target->total = (double)strength;
    target->cells[0] = (struct photon_cell){.until = target->total, .strength = strength, .shine = 1};
    target->cell_count = 1;
    for (int i = 0; i < PROBES * PROBES; i++) {
        struct sample2 turn = {(i % PROBES + 0.5) / PROBES, (i / PROBES + 0.5) / PROBES};
        struct colour power = start_from_environment(target, turn, (struct sample2){0, 0}).power;
        target->flux += (fabs(power.r) + fabs(power.g) + fabs(power.b)) / (3 * PROBES * PROBES) * target->total;
    }
    if (!isfinite(target->flux))
        target->flux = 0;
    return true;
}

static bool target_part(struct photon_target *target, struct search *search, uint32_t budget, struct arena *arena) {
    switch (target->emitter.domain) {
    case LIGHT_DOMAIN_ENVIRONMENT:
        return target_environment(target, search->specular_objects, arena);
    case LIGHT_DOMAIN_PARALLEL:
        fit_distant_target(target, search->specular_objects);
        break;
    case LIGHT_DOMAIN_LOCAL:
        break;
    }
    return make_target(target, search, budget, arena);
}

static bool target_light(struct photon_targets *out, struct search *search, const struct light *light, uint32_t number,
                         struct arena *arena) {
    uint32_t parts = light_parts(light, search->specular_objects), budget = search->budget;
    for (uint32_t part = 0; part < parts * parts && !search->stopped; part++) {
        struct photon_target *target = &out->targets[out->count];
        *target = (struct photon_target){.number = number};
        if (!light_emitter_make(light, part % parts, part / parts, parts, &target->emitter))
            continue;
        if (!target_part(target, search, budget / (parts * parts), arena))
            return false;
        out->count += target->cell_count > 0 && target->flux > 0;
    }
    return true;
}

/* The photons by flux; what rounding leaves goes to the last. */
static void share_photons(struct photon_targets *targets, uint32_t photons) {
    double all = 0, sum = 0;
    uint32_t first = 0;
    for (uint32_t i = 0; i < targets->count; i++)
        all += targets->targets[i].flux;
    for (uint32_t i = 0; i < targets->count; i++) {
        struct photon_target *target = &targets->targets[i];
        sum += target->flux;
        double end = floor(photons * (sum / all) + 0.5);
        uint32_t until = i + 1 == targets->count || end > photons ? photons : (uint32_t)end;
        until = until < first ? first : until;
        target->first = first;
        target->count = until - first;
        first = until;
    }
}

/* The media around the centre of each light when the shutter opens. */
static bool find_medium_stacks(struct photon_targets *targets, const struct world *world, struct arena *arena,
                               struct world_scratch *scratch) {
    for (uint32_t i = 0; i < targets->count; i++) {
        struct photon_target *target = &targets->targets[i];
        struct vec3 centre = target->emitter.centre;
        struct box here = {centre, centre};
        uint32_t count = is_distant(target) ? 0 : world_closed_in(world, &here, NULL, 0);
        target->media.media = &world->media;
        if (count == 0)
            continue;
        uint32_t *closed = arena_alloc_array(arena, count, sizeof *closed);
        if (!closed)
            return false;
        (void)world_closed_in(world, &here, closed, count);
        world_medium_stack(world, &(struct inside_query){centre, 0, closed, count}, scratch, &target->media);
    }
    return !scratch->failed;
}

bool photon_targets_make(struct photon_targets *out, const struct world *world, uint32_t photons, struct arena *arena,
                         struct pool *pool, struct error *error) {
    struct specular_objects specular_objects;
    *out = (struct photon_targets){0};
    if (!find_specular_objects(&specular_objects, world, arena))
        return error_no_memory(error, "the photons of the caustics");
    if (specular_objects.count == 0 || world->light_count == 0)
        return true;
    sort_items(specular_objects.list, specular_objects.count, sizeof *specular_objects.list, is_stronger);
    struct search search = {.specular_objects = &specular_objects, .pool = pool};
    /* Enough photons in a cell for their sequence to show; many lights share the time. */
    uint32_t by_photons = photons / PHOTONS_PER_CELL / world->light_count, by_time = BUDGET * 8 / world->light_count;
    search.budget = by_photons < BUDGET ? by_photons : BUDGET;
    search.budget = by_time < search.budget ? by_time : search.budget;
    search.budget = search.budget > MIN_BUDGET ? search.budget : MIN_BUDGET;
    search.stack = arena_alloc_array(arena, specular_objects.count, (LEVEL_MAX + 2) * sizeof *search.stack);
    out->targets = arena_alloc_array(arena, world->light_count, PARTS * PARTS * sizeof *out->targets);
    bool ok = search.stack && out->targets;
    for (uint32_t i = 0; ok && i < world->light_count && !search.stopped; i++)
        ok = target_light(out, &search, &world->lights[i], i, arena);
    if (!ok)
        return error_no_memory(error, "the photons of the caustics");
    if (search.stopped)
        return error_set(error, ERROR_CANCELLED, "stopped while aiming photons");
    struct world_scratch scratch;
    ok = world_scratch_init(&scratch, world) && find_medium_stacks(out, world, arena, &scratch);
    world_scratch_destroy(&scratch);
    share_photons(out, photons);
    return ok || error_no_memory(error, "the photons of the caustics");
}

/* --- starting --- */

static double fraction(double x) {
    return x - floor(x);
}

static const struct photon_cell *cell_at(const struct photon_target *target, double at) {
    uint32_t low = 0, high = target->cell_count - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (target->cells[middle].until > at)
            high = middle;
        else
            low = middle + 1;
    }
    return &target->cells[low];
}

/* A point in the part of a square that belongs to a cell. */
static struct light_photon start_across(const struct photon_target *target, const struct photon_cell *cell,
                                        struct sample2 xi, double *weight) {
    struct light_photon photon = light_photon(&target->emitter, vec3_all(0), xi);
    double size = math_ldexp(target->size, -(int)target->level);
    double x = target->corner[0] + (cell->i + xi.x) * size, y = target->corner[1] + (cell->j + xi.y) * size;
    photon.origin = vec3_add_scaled(vec3_scale(target->emitter.right, x), target->emitter.up, y);
    photon.origin = vec3_add_scaled(photon.origin, photon.direction, target->behind);
    *weight = *weight * size * size;
    return photon;
}

/* A unit direction within a cell; *share: the solid angle there for that in the cell's middle. */
static struct vec3 cell_direction(const struct photon_target *target, const struct photon_cell *cell, struct sample2 xi,
                                  double *share) {
    double width = math_ldexp(2, -(int)target->level), density, middle_density;
    (void)face_direction(cell->face, -1 + width * (cell->i + 0.5), -1 + width * (cell->j + 0.5), &middle_density);
    struct vec3 direction =
        face_direction(cell->face, -1 + width * (cell->i + xi.x), -1 + width * (cell->j + xi.y), &density);
    *share = density / middle_density;
    return vec3_normalize(direction);
}

struct photon_start photon_target_start(const struct photon_target *target, uint32_t index, uint64_t seed) {
    uint64_t key = random_combine(seed, (uint64_t)target->first + index);
    uint64_t key_of_target = random_combine(random_combine(seed, UINT64_MAX), target->first);
    /* Evenly spaced along the sum of importances: which cell, and how many photons of it came before. */
    double offset = random_unit(key_of_target), spacing = target->total / target->count;
    const struct photon_cell *cell = cell_at(target, (index + offset) * spacing);
    double before = cell == target->cells ? 0 : cell[-1].until;
    double turn = index - ceil(before / spacing - offset);
    uint64_t key_of_cell = random_combine(key_of_target, (uint64_t)(cell - target->cells));
    /* Powers of 1 / 1.16730397826141868... (x^5 = x + 1): four dimensions that fill space evenly. */
    static const double steps[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378086, 0.53859725722361};
    double u[4];
    for (uint64_t k = 0; k < 4; k++)
        u[k] = fraction(random_unit(random_combine(key_of_cell, k)) + turn * steps[k]);

    const struct light_emitter *emitter = &target->emitter;
    struct photon_start start = {.strength = (double)cell->strength, .key = key};
    double weight = spacing / ((double)cell->strength * (double)cell->shine);
    struct light_photon photon;
    switch (emitter->domain) {
    case LIGHT_DOMAIN_ENVIRONMENT:
        photon = start_from_environment(target, (struct sample2){u[0], u[1]}, (struct sample2){u[2], u[3]});
        start.from_afar = true;
        break;
    case LIGHT_DOMAIN_PARALLEL:
        photon = start_across(target, cell, (struct sample2){u[0], u[1]}, &weight);
        break;
    case LIGHT_DOMAIN_LOCAL: {
        double share;
        struct vec3 direction = cell_direction(target, cell, (struct sample2){u[0], u[1]}, &share);
        photon = light_photon(emitter, direction, (struct sample2){u[2], u[3]});
        weight *= share;
        break;
    }
    }
    start.origin = photon.origin;
    start.direction = photon.direction;
    start.power = colour_scale(photon.power, weight);
    return start;
}
