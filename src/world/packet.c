/* Rays of one origin together: the camera rays of a few pixels traverse the hierarchy over the primitives as one beam,
 * and the shadow rays of one hit towards one light test only primitives in the shaft between them. Meshes get all rays
 * that hit their box together (accel/triangle_packet.h), other shapes one after the other. The results are those of
 * single rays. */
#include "world/packet.h"

#include "accel/beam.h"
#include "math/lanes.h"
#include "world/world_internal.h"

#include <string.h>

struct packet_search {
    const struct world *world;
    const struct ray_packet *rays;
    struct world_scratch *scratch;
    _Alignas(64) double inverse[3][PACKET_RAYS];
    double limit[PACKET_RAYS]; /* just after the best hit, so that an equal t is still found */
    struct packet_answer *best;
    uint64_t found;
};

static uint32_t slot_count(const struct ray_packet *rays) {
    return (rays->count + PACKET_STEP - 1) / PACKET_STEP * PACKET_STEP;
}

/* The rays that may hit the box: box_probe_meets of every ray, two at a time. */
static uint64_t meet_box(const struct packet_search *s, const struct box *box) {
    const double low[3] = {box->min.x, box->min.y, box->min.z}, high[3] = {box->max.x, box->max.y, box->max.z};
    const double origin[3] = {s->rays->origin.x, s->rays->origin.y, s->rays->origin.z};
    uint64_t met = 0;
    uint32_t count = slot_count(s->rays);
    const double2 infinity = double2_all(INFINITY);
    for (uint32_t i = 0; i < count; i += 2) {
        double2 enter = double2_all(s->rays->t_min), leave = double2_load(&s->limit[i]);
        for (int axis = 0; axis < 3; axis++) {
            double2 inverse = double2_load(&s->inverse[axis][i]);
            double2 a = (low[axis] - origin[axis]) * inverse, b = (high[axis] - origin[axis]) * inverse;
            double2 near = double2_min(a, b), far = double2_max(a, b);
            near -= double2_size(near) * 0x1p-49;
            far += double2_size(far) * 0x1p-49;
            /* A NaN (the ray is in a plane) must not exclude: its slab is the whole line. */
            double2_mask unknown = double2_unordered(a, b);
            enter = double2_max(double2_choose(unknown, -infinity, near), enter);
            leave = double2_min(double2_choose(unknown, infinity, far), leave);
        }
        met |= (uint64_t)double2_bits(double2_less_equal(enter, leave)) << i;
    }
    return met & ray_packet_all(s->rays);
}

/* A mesh without culled faces, at rest: all rays may form a packet. */
static bool is_plain_mesh(const struct world *world, uint32_t index) {
    const struct prototype *prototype = primitive_prototype(world, index);
    uint32_t linear = world->primitives[index].linear;
    return geometry_mesh(&prototype->geometry) && prototype->cull == CULL_NONE &&
           (linear == LINEAR_NONE || !(linear & LINEAR_MOVING));
}

/* The rays in the space of a primitive, with the bits of primitive_ray. */
static const struct ray_packet *primitive_rays(const struct packet_search *s, uint32_t index, struct ray_packet *out) {
    const struct primitive *primitive = &s->world->primitives[index];
    const struct ray_packet *rays = s->rays;
    uint32_t count = slot_count(rays);
    out->t_min = rays->t_min;
    out->time = rays->time;
    out->count = rays->count;
    for (uint32_t i = 0; i < count; i++)
        out->t_max[i] = s->limit[i];
    if (primitive->linear == LINEAR_NONE) {
        out->origin = rays->origin;
        memcpy(out->direction, rays->direction, sizeof out->direction);
        return out;
    }
    /* The operations are those of primitive_ray, in their order: the bits are equal. */
    const struct linear_map *map = &s->world->linear_maps[primitive->linear];
    const double *x = map->inverse[0], *y = map->inverse[1], *z = map->inverse[2];
    struct vec3 o = rays->origin;
    out->origin = vec3_make(x[0] * o.x + x[1] * o.y + x[2] * o.z + primitive->shift_back.x,
                            y[0] * o.x + y[1] * o.y + y[2] * o.z + primitive->shift_back.y,
                            z[0] * o.x + z[1] * o.y + z[2] * o.z + primitive->shift_back.z);
    for (int k = 0; k < 3; k++) {
        const double *row = map->inverse[k];
        for (uint32_t i = 0; i < count; i++)
            out->direction[k][i] =
                row[0] * rays->direction[0][i] + row[1] * rays->direction[1][i] + row[2] * rays->direction[2][i];
    }
    return out;
}

static void better(struct packet_search *s, unsigned i, uint32_t index, const struct crossing *crossing) {
    uint64_t bit = UINT64_C(1) << i;
    struct packet_answer *best = &s->best[i];
    if ((s->found & bit) &&
        !(crossing->t < best->crossing.t || (crossing->t == best->crossing.t && index < best->primitive)))
        return;
    best->crossing = *crossing;
    best->primitive = index;
    s->found |= bit;
    double just_behind = crossing->t + fabs(crossing->t) * 0x1p-52;
    s->limit[i] = just_behind < s->rays->t_max[i] ? just_behind : s->rays->t_max[i];
}

static void try_mesh(struct packet_search *s, uint32_t index, uint64_t active) {
    struct ray_packet object;
    struct packet_hits hits;
    const struct mesh *mesh = primitive_geometry(s->world, index)->shape.mesh;
    uint64_t met = mesh_nearest_packet(mesh, primitive_rays(s, index, &object), active, s->world->mesh_accel,
                                       &s->scratch->geom, &hits);
    for (; met; met &= met - 1) {
        unsigned i = (unsigned)__builtin_ctzll(met);
        struct crossing crossing = {
            .t = hits.t[i], .u = hits.u[i], .v = hits.v[i], .part = hits.triangle[i], .enter = hits.enter[i]};
        better(s, i, index, &crossing);
    }
}

static void try_together(struct packet_search *s, uint32_t index, const struct shape *shape, uint64_t active) {
    struct ray rays[PACKET_RAYS];
    struct crossing crossings[PACKET_RAYS];
    for (uint64_t rest = active; rest; rest &= rest - 1) {
        unsigned i = (unsigned)__builtin_ctzll(rest);
        rays[i] = ray_packet_get(s->rays, i);
        rays[i].t_max = s->limit[i];
        rays[i] = primitive_ray(s->world, index, &rays[i]);
    }
    uint64_t met = shape_nearest_packet(shape, rays, active, &s->scratch->geom, crossings);
    for (; met; met &= met - 1) {
        unsigned i = (unsigned)__builtin_ctzll(met);
        better(s, i, index, &crossings[i]);
    }
}

static void try_shape(struct packet_search *s, uint32_t index, uint64_t active) {
    const struct geometry *geometry = primitive_geometry(s->world, index);
    if (!geometry->csg && shape_takes_packets(&geometry->shape, &s->scratch->geom)) {
        try_together(s, index, &geometry->shape, active);
        return;
    }
    for (; active; active &= active - 1) {
        unsigned i = (unsigned)__builtin_ctzll(active);
        struct crossing crossing;
        struct ray ray = ray_packet_get(s->rays, i);
        ray.t_max = s->limit[i];
        ray = primitive_ray(s->world, index, &ray);
        if (world_ask_nearest(s->world, index, &ray, s->scratch, &crossing))
            better(s, i, index, &crossing);
    }
}

/* The limit of the search. */
static double farthest(const struct packet_search *s) {
    double limit = -INFINITY;
    for (uint32_t i = 0; i < s->rays->count; i++)
        limit = s->limit[i] > limit ? s->limit[i] : limit;
    return limit;
}

uint64_t world_nearest_packet(const struct world *world, const struct ray_packet *rays, struct world_scratch *scratch,
                              struct packet_answer *out) {
    enum { FEWEST = 4 };
    struct beam beam;
    const struct box_tree *tree = scene_accel_hierarchy(&world->accel);
    if (!tree || rays->count < FEWEST || !beam_make(&beam, rays)) {
        uint64_t found = 0;
        for (uint32_t i = 0; i < rays->count; i++) {
            struct ray ray = ray_packet_get(rays, i);
            found |= (uint64_t)world_nearest_crossing(world, &ray, scratch, &out[i].primitive, &out[i].crossing) << i;
        }
        return found;
    }
    /* Too large to be zeroed: only what is read is set. */
    struct packet_search s;
    s.world = world;
    s.rays = rays;
    s.scratch = scratch;
    s.best = out;
    s.found = 0;
    for (uint32_t i = 0; i < slot_count(rays); i++) {
        for (int k = 0; k < 3; k++)
            s.inverse[k][i] = 1 / rays->direction[k][i];
        s.limit[i] = rays->t_max[i];
    }
    scratch->rays += rays->count;
    struct beam_traversal traversal;
    uint32_t index;
    double limit = farthest(&s);
    beam_traversal_begin(&traversal, tree, &beam);
    while (beam_traversal_next(&traversal, limit, &index)) {
        /* The beam may meet a box that none of its rays meets. */
        uint64_t active = meet_box(&s, &world->boxes[index]);
        if (!active)
            continue;
        if (is_plain_mesh(world, index))
            try_mesh(&s, index, active);
        else
            try_shape(&s, index, active);
        limit = s.found == ray_packet_all(rays) ? farthest(&s) : limit;
    }
    scratch->geom.cost.hierarchy_steps += traversal.steps;
    return s.found;
}

/* --- between a hit and a light --- */

/* The rays that one primitive occludes. */
static uint64_t stopped_by(const struct packet_search *s, uint32_t index, uint64_t active) {
    const struct prototype *prototype = primitive_prototype(s->world, index);
    if (is_plain_mesh(s->world, index) && !prototype->holes) {
        struct ray_packet object;
        return mesh_any_packet(prototype->geometry.shape.mesh, primitive_rays(s, index, &object), active,
                               s->world->mesh_accel, &s->scratch->geom);
    }
    uint64_t stopped = 0;
    for (; active; active &= active - 1) {
        unsigned i = (unsigned)__builtin_ctzll(active);
        struct ray ray = ray_packet_get(s->rays, i);
        stopped |= (uint64_t)world_ask_any(s->world, index, &ray, s->scratch) << i;
    }
    return stopped;
}

/* The rays of `active` that no candidate occludes; an occluder is tested first the next time. */
static uint64_t pass(struct packet_search *s, struct occluder_candidates *occluder_candidates) {
    uint64_t alive = ray_packet_all(s->rays);
    for (uint32_t i = 0; i < slot_count(s->rays); i++) {
        for (int k = 0; k < 3; k++)
            s->inverse[k][i] = 1 / s->rays->direction[k][i];
        s->limit[i] = s->rays->t_max[i];
    }
    for (uint32_t k = 0; k < occluder_candidates->count && alive; k++) {
        uint32_t item = occluder_candidates->items[k];
        uint64_t active = alive & meet_box(s, &s->world->boxes[item]), stopped;
        if (!active || !(stopped = stopped_by(s, item, active)))
            continue;
        alive &= ~stopped;
        occluder_candidates->items[k] = occluder_candidates->items[0];
        occluder_candidates->items[0] = item;
    }
    return alive;
}

struct occluder_candidates world_occluder_candidates(const struct world *world, struct vec3 from, struct vec3 corner,
                                                     struct vec3 edge1, struct vec3 edge2, uint32_t skip_primitive) {
    struct occluder_candidates occluder_candidates;
    occluder_candidates.count = 0;
    occluder_candidates.skip_primitive = skip_primitive;
    const struct box_tree *tree = scene_accel_hierarchy(&world->accel);
    occluder_candidates.known = tree != NULL;
    if (!occluder_candidates.known)
        return occluder_candidates;
    struct shaft shaft = shaft_make(from, corner, edge1, edge2);
    occluder_candidates.count = box_tree_in_shaft(tree, &shaft, occluder_candidates.items, OCCLUDER_CANDIDATES);
    occluder_candidates.known = occluder_candidates.count <= OCCLUDER_CANDIDATES;
    for (uint32_t i = 0; occluder_candidates.known && i < occluder_candidates.count; i++) {
        if (occluder_candidates.items[i] + 1 == skip_primitive) {
            occluder_candidates.items[i] = occluder_candidates.items[--occluder_candidates.count];
            break;
        }
    }
    return occluder_candidates;
}

uint32_t world_visible(const struct world *world, struct occluder_candidates *occluder_candidates,
                       const struct shadow_rays *shadow_rays, struct world_scratch *scratch, bool *visible) {
    struct vec3 from = shadow_rays->from;
    const struct vec3 *targets = shadow_rays->targets;
    uint32_t count = shadow_rays->count, seen = 0;
    if (occluder_candidates->known && occluder_candidates->count == 0) {
        for (uint32_t i = 0; i < count && visible; i++)
            visible[i] = true;
        return count;
    }
    /* Too many candidates: every ray searches alone. */
    if (!occluder_candidates->known) {
        for (uint32_t i = 0; i < count; i++) {
            struct ray ray = {.origin = from,
                              .direction = vec3_sub(targets[i], from),
                              .t_max = 1,
                              .time = shadow_rays->time,
                              .skip_primitive = occluder_candidates->skip_primitive};
            bool unoccluded = !world_any(world, &ray, scratch);
            seen += unoccluded;
            if (visible)
                visible[i] = unoccluded;
        }
        return seen;
    }
    scratch->any_rays += count;
    struct ray_packet rays;
    struct packet_search s;
    s.world = world;
    s.rays = &rays;
    s.scratch = scratch;
    rays.origin = from;
    rays.t_min = 0;
    rays.time = shadow_rays->time;
    /* A packet asks one candidate after the other, until no ray is left. */
    for (uint32_t first = 0; first < count; first += PACKET_RAYS) {
        rays.count = count - first < PACKET_RAYS ? count - first : PACKET_RAYS;
        for (uint32_t i = 0; i < rays.count; i++) {
            struct vec3 d = vec3_sub(targets[first + i], from);
            rays.direction[0][i] = d.x;
            rays.direction[1][i] = d.y;
            rays.direction[2][i] = d.z;
            rays.t_max[i] = 1;
        }
        ray_packet_pad(&rays);
        uint64_t alive = pass(&s, occluder_candidates);
        seen += (uint32_t)__builtin_popcountll(alive);
        for (uint32_t i = 0; i < rays.count && visible; i++)
            visible[first + i] = alive >> i & 1;
    }
    return seen;
}
