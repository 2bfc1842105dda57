/* A light that stands somewhere is surrounded by a cube whose faces are quadtrees of cells, each cell a pyramid of
 * directions; a distant light by a square across its rays. A cell counts when its pyramid, widened by the light's own
 * extent, can meet the box of something specular. Cells are made as small as a budget of them allows, so a far small
 * thing is aimed at as well as a near large one.
 *
 * A cell is as important as its solid angle (area) times the strength of the strongest thing in it times the light's
 * own brightness there, and gets its share of the photons by systematic sampling; inside the cell they follow the
 * additive recurrence of the generalised golden ratio (Roberts, "The Unreasonable Effectiveness of Quasirandom
 * Sequences", 2018), moved by an offset of the cell. The weight of a photon is exactly the light's intensity over the
 * density of photons: no cell that light can pass may be missing, which is the invariant.
 *
 * A sky sends from all sides: its directions come from its own table, and each has its rectangle across.
 *
 * Units (docs/light.md): a light without body sends its colour per steradian, times d^2 fading(d) after the way d, so
 * that free light arrives as colour * fading(d) * cosine; a lamp sends radiance / pi per area and projected solid
 * angle, since a view factor is a cosine over pi. */
#include "render/photon_aim.h"

#include "base/random.h"
#include "light/sky_light.h"
#include "math/elementary.h"
#include "math/frame.h"

#include <string.h>

enum {
    BUDGET = 16384,
    LEAST_BUDGET = 128,
    PHOTONS_PER_CELL = 16,
    LEVEL_LEAST = 3,
    LEVEL_MOST = 14,
    PARTS = 4,
    CANCEL_EVERY = 256
};

static const double pi = 3.14159265358979323846;

/* --- what is specular --- */

struct caster {
    struct box box;
    struct vec3 middle;
    double radius; /* of a ball round the middle that holds it */
    double strength;
    uint32_t order;
};

struct casters {
    struct caster *list; /* the strongest first */
    uint32_t count;
    struct box all;     /* of them */
    struct vec3 middle; /* of that box */
    struct box scene;   /* of everything that is finite */
};

static double placed_strength(const struct world *world, uint32_t index) {
    const struct thing *thing = placed_thing(world, index);
    const struct csg *csg = thing->shape.kind == SHAPE_CSG ? thing->shape.csg : NULL;
    double most = 0;
    for (uint32_t leaf = 0; leaf < (csg ? csg->leaf_count : 1); leaf++) {
        uint32_t material = csg ? csg->leaves[leaf].material : thing->material;
        uint32_t slots = csg ? csg->leaves[leaf].slot_count : thing->slot_count;
        for (uint32_t slot = 0; slot < (slots > 1 ? slots : 1); slot++) {
            double strength = material_specular(world->materials[material + slot]);
            most = strength > most ? strength : most;
        }
    }
    return most < 1 ? most : 1;
}

static bool is_finite(const struct box *box) {
    return vec3_finite(box->min) && vec3_finite(box->max);
}

static struct caster caster_make(const struct world *world, uint32_t index, const struct box *box, double strength) {
    struct caster caster = {.box = *box, .strength = strength, .order = index};
    const struct shape *shape = placed_shape(world, index);
    uint32_t linear = world->placed[index].linear;
    bool still = linear == LINEAR_NONE || !(linear & LINEAR_MOVING);
    caster.middle = vec3_scale(vec3_add(box->min, box->max), 0.5);
    caster.radius = vec3_length(vec3_sub(box->max, caster.middle));
    if (shape->kind == SHAPE_SPHERE && still) {
        double stretch = linear == LINEAR_NONE ? 1 : world->linear_maps[linear].stretch;
        caster.radius = fmin(caster.radius, shape->sphere.radius * stretch * (1 + 0x1p-30));
    }
    return caster;
}

/* Things without end are meant as far as the finite ones reach, and as far again. */
static bool find_casters(struct casters *out, const struct world *world, struct arena *arena) {
    *out = (struct casters){.scene = box_empty()};
    uint32_t specular = 0;
    for (uint32_t i = 0; i < world->placed_count; i++) {
        specular += placed_strength(world, i) > 0;
        if (is_finite(&world->boxes[i]))
            out->scene = box_join(out->scene, world->boxes[i]);
    }
    if (specular == 0 || box_is_empty(&out->scene))
        return true;
    out->list = arena_alloc_array(arena, specular, sizeof *out->list);
    if (!out->list)
        return false;
    struct vec3 size = vec3_sub(out->scene.max, out->scene.min);
    struct box limit = {vec3_sub(out->scene.min, size), vec3_add(out->scene.max, size)};
    out->all = box_empty();
    for (uint32_t i = 0; i < world->placed_count; i++) {
        double strength = placed_strength(world, i);
        struct box box = box_meet(world->boxes[i], limit);
        if (!(strength > 0) || box_is_empty(&box))
            continue;
        out->all = box_join(out->all, box);
        out->list[out->count++] = caster_make(world, i, &box, strength);
    }
    if (out->count > 0)
        out->middle = vec3_scale(vec3_add(out->all.min, out->all.max), 0.5);
    return true;
}

/* Heap sort by strength, then by order. */
static bool is_weaker(const struct caster *a, const struct caster *b) {
    return a->strength != b->strength ? a->strength < b->strength : a->order > b->order;
}

static void sift(struct caster *list, uint32_t root, uint32_t count) {
    struct caster item = list[root];
    for (uint32_t child; (child = 2 * root + 1) < count; root = child) {
        child += child + 1 < count && is_weaker(&list[child + 1], &list[child]);
        if (!is_weaker(&list[child], &item))
            break;
        list[root] = list[child];
    }
    list[root] = item;
}

static void sort_casters(struct casters *casters) {
    for (uint32_t i = casters->count / 2; i-- > 0;)
        sift(casters->list, i, casters->count);
    for (uint32_t end = casters->count; end > 1; end--) {
        struct caster last = casters->list[end - 1];
        casters->list[end - 1] = casters->list[0];
        casters->list[0] = last;
        sift(casters->list, 0, end - 1);
    }
}

/* --- cells --- */

static bool is_distant(const struct photon_aim *aim) {
    return aim->light->kind == LIGHT_DIRECTIONAL || aim->light->kind == LIGHT_SKY;
}

/* The coordinate on a face of the cube from one that runs evenly over the angle. */
static double on_face(double a) {
    return el_tan(a * (pi / 4));
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
    *density = (pi / 4) * (pi / 4) * (1 + u * u) * (1 + v * v) / (squared * sqrt(squared));
    return vec3_add_scaled(vec3_add_scaled(major, right, u), up, v);
}

/* Half-spaces that hold the cell: normal . p <= reach for every point p that light of the cell may pass. */
struct fence {
    struct vec3 normal[5];
    double reach[5];
    int count;
};

static void fence_add(struct fence *fence, struct vec3 normal, double reach) {
    fence->normal[fence->count] = normal;
    fence->reach[fence->count++] = reach;
}

static void pyramid_fence(const struct photon_aim *aim, uint32_t face, uint32_t level, uint32_t i, uint32_t j,
                          struct fence *fence) {
    struct vec3 major, axes[2];
    double width = ldexp(2, -(int)level);
    uint32_t place[2] = {i, j};
    face_axes(face, &major, &axes[0], &axes[1]);
    fence->count = 0;
    for (int k = 0; k < 2; k++) {
        double low = on_face(-1 + width * place[k]), high = on_face(-1 + width * (place[k] + 1));
        struct vec3 below = vec3_normalize(vec3_sub(vec3_scale(major, low), axes[k]));
        struct vec3 above = vec3_normalize(vec3_sub(axes[k], vec3_scale(major, high)));
        fence_add(fence, below, vec3_dot(below, aim->centre) + aim->radius);
        fence_add(fence, above, vec3_dot(above, aim->centre) + aim->radius);
    }
}

static double box_least(const struct box *box, struct vec3 n) {
    return n.x * (n.x > 0 ? box->min.x : box->max.x) + n.y * (n.y > 0 ? box->min.y : box->max.y) +
           n.z * (n.z > 0 ? box->min.z : box->max.z);
}

static bool fence_meets(const struct fence *fence, const struct caster *caster) {
    for (int k = 0; k < fence->count; k++) {
        double by_box = box_least(&caster->box, fence->normal[k]);
        double by_ball = vec3_dot(fence->normal[k], caster->middle) - caster->radius;
        double least = by_box > by_ball ? by_box : by_ball;
        if (least > fence->reach[k] + fabs(fence->reach[k]) * 0x1p-40)
            return false;
    }
    return true;
}

/* Across a distant light: a square against the shadow of a ball, and of a box by the axes of both (separating axes). */
static bool square_meets(const struct photon_aim *aim, double x, double y, double half, const struct caster *caster) {
    struct vec3 middle = caster->middle, reach = vec3_sub(caster->box.max, middle);
    double off_x = fabs(vec3_dot(aim->right, middle) - x) - half, off_y = fabs(vec3_dot(aim->up, middle) - y) - half;
    off_x = off_x > 0 ? off_x : 0;
    off_y = off_y > 0 ? off_y : 0;
    if (off_x * off_x + off_y * off_y > caster->radius * caster->radius * (1 + 0x1p-30))
        return false;
    const struct vec3 r = aim->right, u = aim->up;
    const double axes[5][2] = {{1, 0}, {0, 1}, {-u.x, r.x}, {-u.y, r.y}, {-u.z, r.z}};
    for (int k = 0; k < 5; k++) {
        struct vec3 n = vec3_add_scaled(vec3_scale(r, axes[k][0]), u, axes[k][1]);
        double off = fabs(vec3_dot(n, middle) - x * axes[k][0] - y * axes[k][1]);
        double own = fabs(n.x) * reach.x + fabs(n.y) * reach.y + fabs(n.z) * reach.z;
        if (off > (own + half * (fabs(axes[k][0]) + fabs(axes[k][1]))) * (1 + 0x1p-30))
            return false;
    }
    return true;
}

/* The light's brightness in a direction, of its brightest. */
static double shine(const struct photon_aim *aim, struct vec3 direction) {
    const struct light *light = aim->light;
    if (light->kind == LIGHT_SPOT)
        return light_cone(light, direction);
    if (!light->emits || light->kind == LIGHT_SPHERE || light->kind == LIGHT_DIRECTIONAL || light->kind == LIGHT_MESH)
        return 1;
    struct vec3 normal =
        light->kind == LIGHT_DISC ? light->direction : vec3_normalize(vec3_cross(light->edge1, light->edge2));
    double cosine = vec3_dot(normal, direction);
    return cosine > 0 ? cosine : light->one_sided ? 0 : -cosine;
}

/* The brightness in the middle of a cell, or a little where only another part of it is lit; 0 where none is. */
static double cell_shine(const struct photon_aim *aim, uint32_t face, uint32_t i, uint32_t j, double *solid_angle) {
    double width = ldexp(2, -(int)aim->level), a = -1 + width * (i + 0.5), b = -1 + width * (j + 0.5), density;
    struct vec3 middle = vec3_normalize(face_direction(face, a, b, solid_angle));
    *solid_angle *= width * width;
    double own = shine(aim, middle), most = own, cos_half = 1;
    for (int k = 0; k < 4; k++) {
        struct vec3 corner =
            face_direction(face, a + width * (k & 1 ? 0.5 : -0.5), b + width * (k & 2 ? 0.5 : -0.5), &density);
        corner = vec3_normalize(corner);
        double at_corner = shine(aim, corner), cosine = vec3_dot(corner, middle);
        most = at_corner > most ? at_corner : most;
        cos_half = cosine < cos_half ? cosine : cos_half;
    }
    if (aim->light->kind == LIGHT_SPOT && most == 0) {
        /* The cone may still touch the cell between its corners. */
        double angle = el_acos(fmax(-1, fmin(1, vec3_dot(middle, aim->light->direction))));
        double outer = el_acos(fmax(-1, fmin(1, aim->light->cos_outer)));
        most = angle < outer + el_acos(cos_half) ? 1 : 0;
    }
    return most > 0 && own < 0.05 ? 0.05 : own;
}

/* --- the search for cells that count --- */

struct search {
    const struct casters *casters;
    struct photon_aim *aim;
    const struct pool *pool;
    uint32_t *stack; /* lists of casters, one behind the other down the tree */
    uint32_t level, found, limit, steps, budget;
    bool keep, stopped;
};

static void meet_cell(struct search *s, uint32_t face, uint32_t i, uint32_t j, uint32_t strongest) {
    struct photon_aim *aim = s->aim;
    double area = 1, bright = 1;
    if (!is_distant(aim) && (s->keep || aim->light->emits || aim->light->kind == LIGHT_SPOT))
        bright = cell_shine(aim, face, i, j, &area);
    if (!(bright > 0))
        return;
    if (s->keep) {
        double strength = s->casters->list[strongest].strength;
        aim->total += area * bright * strength;
        aim->cells[s->found] = (struct photon_cell){aim->total, face, i, j, (float)strength, (float)bright};
    }
    s->found++;
}

/* `list`: the casters that the parent may meet. */
static void visit(struct search *s, uint32_t face, uint32_t level, uint32_t i, uint32_t j, const uint32_t *list,
                  uint32_t count, uint32_t *free_room) {
    struct photon_aim *aim = s->aim;
    struct fence fence;
    double size = ldexp(aim->size, -(int)level), half = size / 2;
    s->stopped = s->stopped || ((++s->steps % CANCEL_EVERY == 0 || count > 1000) && pool_cancelled(s->pool));
    if (s->stopped || s->found > s->limit)
        return;
    if (!is_distant(aim))
        pyramid_fence(aim, face, level, i, j, &fence);
    uint32_t met = 0;
    for (uint32_t k = 0; k < count; k++) {
        const struct caster *caster = &s->casters->list[list[k]];
        bool meets = is_distant(aim) ? square_meets(aim, aim->corner[0] + i * size + half,
                                                    aim->corner[1] + j * size + half, half, caster)
                                     : fence_meets(&fence, caster);
        if (meets)
            free_room[met++] = list[k];
    }
    if (met == 0)
        return;
    if (level == s->level) {
        meet_cell(s, face, i, j, free_room[0]);
        return;
    }
    for (uint32_t k = 0; k < 4; k++)
        visit(s, face, level + 1, 2 * i + (k & 1), 2 * j + (k >> 1), free_room, met, free_room + met);
}

static bool search_level(struct search *s, uint32_t level) {
    s->level = s->aim->level = level;
    s->found = 0;
    for (uint32_t k = 0; k < s->casters->count; k++)
        s->stack[k] = k;
    for (uint32_t face = 0; face < (is_distant(s->aim) ? 1U : 6U); face++)
        visit(s, face, 0, 0, 0, s->stack, s->casters->count, s->stack + s->casters->count);
    return !s->stopped;
}

/* The finest level whose cells are within the budget. */
static bool find_cells(struct search *s, uint32_t budget, struct arena *arena) {
    uint32_t level = LEVEL_LEAST, cells = 0;
    s->keep = false;
    s->limit = UINT32_MAX;
    for (uint32_t next = LEVEL_LEAST; next <= LEVEL_MOST; next++) {
        if (!search_level(s, next))
            return true;
        if (next > LEVEL_LEAST && s->found > budget)
            break;
        level = next;
        cells = s->found;
        s->limit = budget;
    }
    if (cells == 0)
        return true;
    s->aim->cells = arena_alloc_array(arena, cells, sizeof *s->aim->cells);
    if (!s->aim->cells)
        return false;
    s->keep = true;
    s->limit = UINT32_MAX;
    (void)search_level(s, level);
    s->aim->cell_count = s->found;
    return true;
}

/* --- lights --- */

/* The square across a distant light that holds the shadows of all casters, and a plane before the whole scene. */
static void place_distant(struct photon_aim *aim, const struct casters *casters) {
    const struct light *light = aim->light;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    frame_tangents(light->direction, &aim->right, &aim->up);
    for (uint32_t i = 0; i < casters->count; i++) {
        const struct box *box = &casters->list[i].box;
        for (int k = 0; k < 2; k++) {
            struct vec3 axis = k == 0 ? aim->right : aim->up;
            double least = box_least(box, axis), most = -box_least(box, vec3_negate(axis));
            low[k] = least < low[k] ? least : low[k];
            high[k] = most > high[k] ? most : high[k];
        }
    }
    aim->size = fmax(high[0] - low[0], high[1] - low[1]);
    aim->corner[0] = low[0];
    aim->corner[1] = low[1];
    double depth = vec3_length(vec3_sub(casters->scene.max, casters->scene.min));
    aim->behind = box_least(&casters->scene, light->direction) - depth * 0x1p-6;
    for (uint32_t i = 0; i < casters->count; i++)
        aim->behind = fmin(aim->behind, box_least(&casters->list[i].box, light->direction) - depth * 0x1p-6);
}

/* Part (i, j) of `parts` x `parts` of a flat light: the ball that holds its places. */
static void place_part(struct photon_aim *aim, uint32_t i, uint32_t j, uint32_t parts) {
    const struct light *light = aim->light;
    aim->side = 1.0 / parts;
    aim->low[0] = i * aim->side;
    aim->low[1] = j * aim->side;
    if (light->kind == LIGHT_PARALLELOGRAM) {
        double u = aim->low[0] + aim->side / 2, v = aim->low[1] + aim->side / 2;
        aim->centre = vec3_add_scaled(vec3_add_scaled(light->corner, light->edge1, u), light->edge2, v);
        double one = vec3_length(vec3_add(light->edge1, light->edge2)) / 2;
        double other = vec3_length(vec3_sub(light->edge1, light->edge2)) / 2;
        aim->radius = (one > other ? one : other) * aim->side;
        return;
    }
    frame_tangents(light->direction, &aim->right, &aim->up);
    aim->centre = light->position;
    aim->radius = light->radius;
}

static void place_mesh(struct photon_aim *aim) {
    aim->centre = aim->light->mesh->centre;
    aim->radius = aim->light->mesh->radius;
}

/* Per unit of importance: what turns a solid angle into flux. */
static double unit_flux(const struct photon_aim *aim) {
    const struct light *light = aim->light;
    if (!light->emits || light->kind == LIGHT_DIRECTIONAL || light->kind == LIGHT_MESH)
        return aim->side * aim->side;
    if (light->kind == LIGHT_SPHERE)
        return light->radius * light->radius;
    double area = light->kind == LIGHT_DISC ? pi * light->radius * light->radius
                                            : vec3_length(vec3_cross(light->edge1, light->edge2));
    return area / pi * (aim->side * aim->side);
}

double photon_fading(const struct light *light, double length) {
    if (light->emits || light->kind == LIGHT_DIRECTIONAL || light->kind == LIGHT_SKY)
        return 1;
    return length * length * light_attenuation(light, length);
}

/* The mean over places and directions, about. */
static struct vec3 mesh_light(const struct light_mesh *mesh) {
    struct vec3 sum = {0, 0, 0};
    for (uint32_t i = 0; i < mesh->count; i++)
        sum = vec3_add_scaled(sum, mesh->triangles[i].light, mesh->until[i] - (i > 0 ? mesh->until[i - 1] : 0));
    return vec3_scale(sum, mesh->one_sided ? 0.25 : 0.5);
}

static void estimate_flux(struct photon_aim *aim, const struct casters *casters) {
    struct vec3 colour = aim->light->kind == LIGHT_MESH ? mesh_light(aim->light->mesh) : aim->light->colour;
    double way = vec3_length(vec3_sub(casters->middle, aim->centre));
    double fading = photon_fading(aim->light, way > aim->radius ? way : aim->radius);
    if (!(fading > 0)) /* beyond its range at the middle, but maybe not everywhere */
        fading = way * way * 0x1p-6;
    double cell_area = is_distant(aim) ? ldexp(aim->size * aim->size, -2 * (int)aim->level) : 1;
    double mean = (fabs(colour.x) + fabs(colour.y) + fabs(colour.z)) / 3;
    aim->flux = mean * fading * unit_flux(aim) * aim->total * cell_area;
    if (!isfinite(aim->flux))
        aim->flux = 0;
}

static bool make_aim(struct photon_aim *aim, struct search *search, uint32_t budget, struct arena *arena) {
    search->aim = aim;
    search->stopped = false;
    if (!find_cells(search, budget, arena))
        return false;
    estimate_flux(aim, search->casters);
    return true;
}

static uint32_t light_parts(const struct light *light, const struct casters *casters) {
    if (light->kind != LIGHT_PARALLELOGRAM)
        return 1;
    double extent = vec3_length(light->edge1) + vec3_length(light->edge2), nearest = INFINITY;
    for (uint32_t i = 0; i < casters->count; i++) {
        const struct box *box = &casters->list[i].box;
        struct vec3 inside = vec3_min(vec3_max(light->position, box->min), box->max);
        nearest = fmin(nearest, vec3_length(vec3_sub(inside, light->position)));
    }
    return extent > 0.1 * nearest ? PARTS : 1;
}

/* Light of a sky: a direction by its own table, then a place of the rectangle across it that holds the shadow of the
 * box of all casters, before the whole scene. Returns the power of a photon that stands for all. */
static struct vec3 start_in_sky(const struct photon_aim *aim, struct sample2 turn, struct sample2 place,
                                struct vec3 *origin, struct vec3 *direction) {
    const struct light *light = aim->light;
    struct vec3 target, axes[2];
    struct vec3 power = vec3_mul(sky_table_sample(light->sky, light->table, turn, &target), light->colour);
    *direction = vec3_negate(target);
    frame_tangents(*direction, &axes[0], &axes[1]);
    const double at[2] = {place.x, place.y};
    double area = 1, before = fmin(box_least(&aim->across, *direction), box_least(&aim->scene, *direction));
    *origin = vec3_scale(*direction, before - aim->size * 0x1p-6);
    for (int k = 0; k < 2; k++) {
        double low = box_least(&aim->across, axes[k]), width = -box_least(&aim->across, vec3_negate(axes[k])) - low;
        area *= width;
        *origin = vec3_add_scaled(*origin, axes[k], low + width * at[k]);
    }
    return vec3_scale(power, area);
}

/* One cell that is everything; its flux from a few hundred starts. */
static bool aim_sky(struct photon_aim *aim, const struct casters *casters, struct arena *arena) {
    enum { PROBES = 16 };
    aim->across = casters->all;
    aim->scene = casters->scene;
    aim->size = vec3_length(vec3_sub(casters->scene.max, casters->scene.min));
    aim->cells = arena_alloc_array(arena, 1, sizeof *aim->cells);
    if (!aim->cells)
        return false;
    float strength = (float)casters->list[0].strength;
    aim->total = (double)strength;
    aim->cells[0] = (struct photon_cell){.until = aim->total, .strength = strength, .shine = 1};
    aim->cell_count = 1;
    for (int i = 0; i < PROBES * PROBES; i++) {
        struct sample2 turn = {(i % PROBES + 0.5) / PROBES, (i / PROBES + 0.5) / PROBES};
        struct vec3 origin, direction, power = start_in_sky(aim, turn, (struct sample2){0, 0}, &origin, &direction);
        aim->flux += (fabs(power.x) + fabs(power.y) + fabs(power.z)) / (3 * PROBES * PROBES) * aim->total;
    }
    if (!isfinite(aim->flux))
        aim->flux = 0;
    return true;
}

static bool sends_photons(const struct light *light) {
    return light->kind != LIGHT_MESH || light->mesh->count > 0;
}

static bool aim_light(struct photon_aims *out, struct search *search, const struct light *light, uint32_t number,
                      struct arena *arena) {
    uint32_t parts = light_parts(light, search->casters), budget = search->budget;
    if (!sends_photons(light))
        return true;
    for (uint32_t part = 0; part < parts * parts && !search->stopped; part++) {
        struct photon_aim *aim = &out->aims[out->count];
        *aim = (struct photon_aim){
            .light = light, .number = number, .centre = light->position, .radius = light->radius, .side = 1};
        if (light->kind == LIGHT_DIRECTIONAL)
            place_distant(aim, search->casters);
        else if (light->kind == LIGHT_PARALLELOGRAM || light->kind == LIGHT_DISC)
            place_part(aim, part % parts, part / parts, parts);
        else if (light->kind == LIGHT_MESH)
            place_mesh(aim);
        else if (light->kind != LIGHT_SPHERE)
            aim->radius = 0;
        bool made = light->kind == LIGHT_SKY ? aim_sky(aim, search->casters, arena)
                                             : make_aim(aim, search, budget / (parts * parts), arena);
        if (!made)
            return false;
        out->count += aim->cell_count > 0 && aim->flux > 0;
    }
    return true;
}

/* The photons by flux; what rounding leaves goes to the last. */
static void share_photons(struct photon_aims *aims, uint32_t photons) {
    double all = 0, sum = 0;
    uint32_t first = 0;
    for (uint32_t i = 0; i < aims->count; i++)
        all += aims->aims[i].flux;
    for (uint32_t i = 0; i < aims->count; i++) {
        struct photon_aim *aim = &aims->aims[i];
        sum += aim->flux;
        double end = floor(photons * (sum / all) + 0.5);
        uint32_t until = i + 1 == aims->count || end > photons ? photons : (uint32_t)end;
        until = until < first ? first : until;
        aim->first = first;
        aim->count = until - first;
        first = until;
    }
}

/* What each light stands in, at its middle when the shutter opens. */
static bool find_media(struct photon_aims *aims, const struct world *world, struct arena *arena,
                       struct world_scratch *scratch) {
    for (uint32_t i = 0; i < aims->count; i++) {
        struct photon_aim *aim = &aims->aims[i];
        struct box here = {aim->centre, aim->centre};
        uint32_t count = is_distant(aim) ? 0 : world_closed_in(world, &here, NULL, 0);
        if (count == 0)
            continue;
        uint32_t *closed = arena_alloc_array(arena, count, sizeof *closed);
        if (!closed)
            return false;
        (void)world_closed_in(world, &here, closed, count);
        media_around(world, aim->centre, 0, closed, count, scratch, &aim->media);
    }
    return !scratch->failed;
}

bool photon_aims_make(struct photon_aims *out, const struct world *world, uint32_t photons, struct arena *arena,
                      struct world_scratch *scratch, struct pool *pool, struct error *error) {
    struct casters casters;
    *out = (struct photon_aims){0};
    if (!find_casters(&casters, world, arena))
        return error_no_memory(error, "the photons of the caustics");
    if (casters.count == 0 || world->light_count == 0)
        return true;
    sort_casters(&casters);
    struct search search = {.casters = &casters, .pool = pool};
    /* Enough photons in a cell for their sequence to show; many lights share the time. */
    uint32_t by_photons = photons / PHOTONS_PER_CELL / world->light_count, by_time = BUDGET * 8 / world->light_count;
    search.budget = by_photons < BUDGET ? by_photons : BUDGET;
    search.budget = by_time < search.budget ? by_time : search.budget;
    search.budget = search.budget > LEAST_BUDGET ? search.budget : LEAST_BUDGET;
    search.stack = arena_alloc_array(arena, casters.count, (LEVEL_MOST + 2) * sizeof *search.stack);
    out->aims = arena_alloc_array(arena, world->light_count, PARTS * PARTS * sizeof *out->aims);
    bool ok = search.stack && out->aims;
    for (uint32_t i = 0; ok && i < world->light_count && !search.stopped; i++)
        ok = aim_light(out, &search, &world->lights[i], i, arena);
    if (!ok)
        return error_no_memory(error, "the photons of the caustics");
    if (search.stopped)
        return error_set(error, ERROR_CANCELLED, "stopped while aiming photons");
    ok = find_media(out, world, arena, scratch);
    share_photons(out, photons);
    return ok || error_no_memory(error, "the photons of the caustics");
}

/* --- starting --- */

static double fraction(double x) {
    return x - floor(x);
}

/* A place on the light seen along the direction, for a light with an extent; the photon starts there. */
static struct vec3 start_on_light(const struct photon_aim *aim, struct vec3 direction, struct sample2 place) {
    const struct light *light = aim->light;
    struct sample2 part = {aim->low[0] + aim->side * place.x, aim->low[1] + aim->side * place.y};
    if (light->kind == LIGHT_PARALLELOGRAM)
        return vec3_add_scaled(vec3_add_scaled(light->corner, light->edge1, part.x), light->edge2, part.y);
    if (light->kind != LIGHT_DISC && light->kind != LIGHT_SPHERE)
        return aim->centre;
    struct sample2 round = sample_disc(part);
    struct vec3 right = aim->right, up = aim->up;
    if (light->kind == LIGHT_SPHERE)
        frame_tangents(direction, &right, &up);
    struct vec3 start =
        vec3_add_scaled(vec3_add_scaled(aim->centre, right, light->radius * round.x), up, light->radius * round.y);
    double height = 1 - round.x * round.x - round.y * round.y;
    if (light->kind == LIGHT_SPHERE && light->emits && height > 0)
        start = vec3_add_scaled(start, direction, light->radius * sqrt(height));
    return start;
}

/* A lamp that is a mesh: a place on one of its triangles, and what that sends in the direction. */
static void start_on_mesh(const struct light_mesh *mesh, struct sample2 place, double weight,
                          struct photon_start *start) {
    struct light_point point = light_mesh_point(mesh, place);
    const struct light_triangle *t = point.triangle;
    double cosine = vec3_dot(t->normal, start->direction), side = cosine > 0 ? t->offset : -t->offset;
    double shines = cosine > 0 || !mesh->one_sided ? fabs(cosine) : 0;
    start->origin = vec3_add_scaled(point.place, t->normal, side);
    start->power = vec3_scale(t->light, weight * shines);
}

static const struct photon_cell *cell_at(const struct photon_aim *aim, double at) {
    uint32_t low = 0, high = aim->cell_count - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (aim->cells[middle].until > at)
            high = middle;
        else
            low = middle + 1;
    }
    return &aim->cells[low];
}

struct photon_start photon_aim_start(const struct photon_aim *aim, uint32_t index, uint64_t seed) {
    uint64_t key = random_combine(seed, (uint64_t)aim->first + index);
    uint64_t key_of_aim = random_combine(random_combine(seed, UINT64_MAX), aim->first);
    /* Evenly spaced along the sum of importances: which cell, and how many photons of it came before. */
    double offset = random_unit(key_of_aim), spacing = aim->total / aim->count;
    const struct photon_cell *cell = cell_at(aim, (index + offset) * spacing);
    double before = cell == aim->cells ? 0 : cell[-1].until;
    double turn = index - ceil(before / spacing - offset);
    uint64_t key_of_cell = random_combine(key_of_aim, (uint64_t)(cell - aim->cells));
    /* Powers of 1 / 1.16730397826141868... (x^5 = x + 1): four dimensions that fill space evenly. */
    static const double steps[4] = {0.8566748838545029, 0.733891856627126, 0.6287067210378086, 0.53859725722361};
    double place[4];
    for (uint64_t k = 0; k < 4; k++)
        place[k] = fraction(random_unit(random_combine(key_of_cell, k)) + turn * steps[k]);

    struct photon_start start = {.strength = (double)cell->strength, .key = key};
    if (aim->light->kind == LIGHT_SKY) {
        struct vec3 power = start_in_sky(aim, (struct sample2){place[0], place[1]},
                                         (struct sample2){place[2], place[3]}, &start.origin, &start.direction);
        start.power = vec3_scale(power, spacing / (double)cell->strength);
        return start;
    }
    double width = ldexp(2, -(int)aim->level), weight = spacing / ((double)cell->strength * (double)cell->shine);
    if (is_distant(aim)) {
        double size = ldexp(aim->size, -(int)aim->level);
        double x = aim->corner[0] + (cell->i + place[0]) * size, y = aim->corner[1] + (cell->j + place[1]) * size;
        start.direction = aim->light->direction;
        start.origin = vec3_add_scaled(vec3_scale(aim->right, x), aim->up, y);
        start.origin = vec3_add_scaled(start.origin, start.direction, aim->behind);
        start.power = vec3_scale(aim->light->colour, weight * size * size);
        return start;
    }
    double density, middle_density;
    (void)face_direction(cell->face, -1 + width * (cell->i + 0.5), -1 + width * (cell->j + 0.5), &middle_density);
    start.direction =
        face_direction(cell->face, -1 + width * (cell->i + place[0]), -1 + width * (cell->j + place[1]), &density);
    start.direction = vec3_normalize(start.direction);
    if (aim->light->kind == LIGHT_MESH) {
        start_on_mesh(aim->light->mesh, (struct sample2){place[2], place[3]}, weight * density / middle_density,
                      &start);
        return start;
    }
    start.origin = start_on_light(aim, start.direction, (struct sample2){place[2], place[3]});
    weight *= density / middle_density * shine(aim, start.direction) * unit_flux(aim);
    start.power = vec3_scale(aim->light->colour, weight);
    return start;
}
