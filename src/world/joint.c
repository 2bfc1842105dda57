/* See joint.h. The surfaces of the partners are looked for in a short piece of the ray around the hit. */
#include "world/joint.h"

#include "world/world_describe.h"
#include "world/world_internal.h"

enum { FACES = 16, CROSSINGS = 4 }; /* of one junction, and of one partner there */
/* Partners are looked for so far away, in units of the error of the hit: errors of others may be larger. */
static const double range_errors = 64;

/* A surface of the junction. */
struct face {
    uint32_t primitive;
    struct crossing crossing; /* not set of the hit itself */
    double t, offset, rank;   /* rank: its roughness; 2 where some light is diffuse */
    bool passes;              /* not opaque */
    struct medium_boundary boundary;
};

struct junction {
    const struct world *world;
    struct world_scratch *scratch;
    const struct ray *ray;
    const struct hit *hit;
    struct face faces[FACES];
    int count;
};

/* Holes are no surface. Whitted's integrator knows thin walls of materials alone. */
static void add_face(struct junction *junction, const struct hit *hit, const struct crossing *crossing) {
    const struct world *world = junction->world;
    const struct material_context context = {.total_reflection = true,
                                             .thin = !world->classic && primitive_is_thin(world, hit->primitive)};
    struct bsdf bsdf;
    material_eval(&world->surfaces, hit, junction->ray->media, &context, &bsdf);
    struct medium_boundary invisible;
    bool filled = world_is_filled(junction->world, hit, &invisible);
    if ((!(bsdf.opacity > 0) && !filled) || junction->count == FACES)
        return;
    struct face *face = &junction->faces[junction->count++];
    *face = (struct face){.primitive = hit->primitive, .t = hit->t, .offset = hit->offset, .passes = bsdf.passes};
    if (crossing)
        face->crossing = *crossing;
    if (filled) {
        face->passes = true;
        face->rank = -1;
        face->boundary = invisible;
    } else if (bsdf.passes) {
        face->rank = bsdf.roughness;
        face->boundary = bsdf.boundary;
    }
}

/* The surfaces of a partner: those that are within the errors of both points, at right angles to the surface. */
static void add_partner(struct junction *junction, uint32_t partner, double range) {
    const struct hit *hit = junction->hit;
    struct ray piece = *junction->ray;
    piece.t_min = math_max(hit->t - range, piece.t_min);
    piece.t_max = math_min(hit->t + range, piece.t_max);
    for (int i = 0; i < CROSSINGS && !ray_skips(&piece, partner); i++) {
        struct ray ray_object = primitive_ray(junction->world, partner, &piece);
        struct crossing crossing;
        struct hit other;
        if (!world_ask_nearest(junction->world, partner, &ray_object, junction->scratch, &crossing))
            return;
        world_describe(junction->world, junction->ray, partner, &crossing, &other);
        double apart = vec3_dot(vec3_sub(other.point, hit->point), hit->normal_geometric);
        if (fabs(apart) <= hit->offset + other.offset && other.behind == 0)
            add_face(junction, &other, &crossing);
        piece.t_min = crossing.t;
    }
}

/* False: there is only the hit. */
static bool find_faces(struct junction *junction) {
    const struct hit *hit = junction->hit;
    double across = fabs(vec3_dot(hit->view, hit->normal_geometric)) * vec3_length(junction->ray->direction);
    double range = range_errors * hit->offset / math_max(across, 0x1p-20);
    const struct box box = joint_bounds(hit);
    struct touching_query query;
    uint32_t partner;
    junction->count = 0;
    touching_begin(&query, junction->world, hit->primitive, &box);
    while (touching_next(&query, &partner))
        add_partner(junction, partner, range);
    if (junction->count > 0)
        add_face(junction, hit, NULL);
    return junction->count > 1;
}

/* --- what the faces are together --- */

/* The first opaque one in flattening order, or NULL. */
static const struct face *opaque_face(const struct junction *junction) {
    const struct face *first = NULL;
    for (int i = 0; i < junction->count; i++)
        if (!junction->faces[i].passes && (!first || junction->faces[i].primitive < first->primitive))
            first = &junction->faces[i];
    return first;
}

/* Solids are left, then entered, the first one in flattening order last. */
static void cross_all(const struct junction *junction, const struct medium_stack *before, struct medium_stack *behind) {
    medium_stack_copy(behind, before);
    for (int i = 0; i < junction->count; i++)
        if (!junction->faces[i].boundary.entering)
            medium_stack_cross(behind, &junction->faces[i].boundary);
    uint32_t below = UINT32_MAX;
    for (int k = 0; k < junction->count; k++) {
        const struct face *next = NULL;
        for (int i = 0; i < junction->count; i++) {
            const struct face *face = &junction->faces[i];
            if (face->boundary.entering && face->primitive < below && (!next || face->primitive > next->primitive))
                next = face;
        }
        if (!next)
            return;
        medium_stack_cross(behind, &next->boundary);
        below = next->primitive;
    }
}

static bool has_thin_wall(const struct junction *junction) {
    for (int i = 0; i < junction->count; i++)
        if (junction->faces[i].boundary.thin)
            return true;
    return false;
}

/* The surface that scatters: one that is not invisible; one between media rather than a thin wall, the roughest, then
 * that of the solid that is entered, then the first one. */
static const struct face *roughest_face(const struct junction *junction) {
    const struct face *best = &junction->faces[0];
    for (int i = 1; i < junction->count; i++) {
        const struct face *face = &junction->faces[i];
        bool enters = face->boundary.entering && !best->boundary.entering;
        bool leaves = !face->boundary.entering && best->boundary.entering;
        if (face->rank < 0 || best->rank < 0)
            best = face->rank > best->rank ? face : best;
        else if (face->boundary.thin != best->boundary.thin)
            best = best->boundary.thin ? face : best;
        else if (face->rank > best->rank ||
                 (face->rank == best->rank && (enters || (!leaves && face->primitive < best->primitive))))
            best = face;
    }
    return best;
}

static void choose(const struct junction *junction, const struct face *face, struct hit *hit) {
    double offset = 0;
    if (face->primitive != hit->primitive || face->t != hit->t)
        world_describe(junction->world, junction->ray, face->primitive, &face->crossing, hit);
    for (int i = 0; i < junction->count; i++)
        offset = math_max(offset, junction->faces[i].offset);
    hit->offset = math_max(hit->offset, offset);
}

static void set_boundary(const struct junction *junction, const struct face *chosen, struct joint *joint) {
    joint->boundary.tint = colour_all(1);
    for (int i = 0; i < junction->count; i++)
        if (&junction->faces[i] != chosen)
            joint->boundary.tint = colour_mul(joint->boundary.tint, junction->faces[i].boundary.tint);
    joint->boundary.eta = medium_stack_ior(&joint->before) / medium_stack_ior(&joint->behind);
    joint->boundary.behind = &joint->behind;
}

/* The boundary of transparent faces together. False: there is none. */
static bool join_transparent(const struct junction *junction, struct hit *hit, struct joint *joint) {
    cross_all(junction, &joint->before, &joint->behind);
    if (!has_thin_wall(junction) && medium_stacks_equal(&joint->before, &joint->behind)) {
        joint->joined = JOINED_AWAY;
        return false;
    }
    const struct face *chosen = roughest_face(junction);
    set_boundary(junction, chosen, joint);
    choose(junction, chosen, hit);
    joint->joined = JOINED_TRANSPARENT;
    return true;
}

/* What the faces are together, for a ray in the media joint->before. */
static void join_faces(const struct junction *junction, struct hit *hit, struct joint *joint) {
    const struct face *opaque = opaque_face(junction);
    if (opaque) {
        choose(junction, opaque, hit);
        joint->joined = JOINED_OPAQUE;
    } else if (!join_transparent(junction, hit, joint)) {
        joint->past = hit->t;
        for (int i = 0; i < junction->count; i++)
            joint->past = math_max(joint->past, junction->faces[i].t);
    }
}

bool world_join(const struct world *world, const struct ray *ray, struct world_scratch *scratch, struct hit *hit,
                struct joint *joint) {
    struct junction junction = {.world = world, .ray = ray, .scratch = scratch, .hit = hit};
    joint->passed = false;
    for (;;) {
        joint->joined = JOINED_NOT;
        if (hit->behind > 0 || !find_faces(&junction))
            return true;
        if (!joint->passed) {
            joint->ray = *ray;
            joint->ray.media = &joint->before;
            joint->before.media = &world->media;
            joint->before.count = 0;
            joint->before.wavelength = 0;
            if (ray->media)
                medium_stack_copy(&joint->before, ray->media);
            junction.ray = &joint->ray;
        }
        join_faces(&junction, hit, joint);
        if (joint->joined != JOINED_AWAY)
            return true;
        /* On to what is behind. */
        joint->passed = true;
        joint->ray.t_min = math_max(joint->ray.t_min, joint->past);
        medium_stack_copy(&joint->before, &joint->behind);
        if (!world_nearest_surface(world, &joint->ray, scratch, hit))
            return false;
        if (!world_touches(world, hit)) {
            joint->joined = JOINED_NOT;
            return true;
        }
    }
}

void world_join_path(const struct world *world, struct ray *ray, struct medium_stack *media,
                     struct world_scratch *scratch, struct hit *hit, struct joint *joint) {
    struct junction junction = {.world = world, .ray = ray, .scratch = scratch, .hit = hit};
    joint->joined = JOINED_NOT;
    if (hit->behind > 0 || !find_faces(&junction))
        return;
    medium_stack_copy(&joint->before, media);
    join_faces(&junction, hit, joint);
    if (joint->joined != JOINED_AWAY)
        return;
    ray->t_min = math_max(ray->t_min, joint->past);
    medium_stack_copy(media, &joint->behind);
}

bool joint_pass_invisible(const struct world *world, const struct joint *joint, const struct hit *hit,
                          struct medium_stack *stack) {
    struct medium_boundary boundary;
    if (!world_is_filled(world, hit, &boundary))
        return false;
    if (joint->joined == JOINED_TRANSPARENT)
        medium_stack_copy(stack, &joint->behind);
    else
        medium_stack_cross(stack, &boundary);
    return true;
}

struct ray joint_ray_through_hole(const struct joint *joint, const struct hit *hit, const struct ray *ray,
                                  const struct medium_stack *media) {
    struct ray onward = hit_ray(hit, ray, vec3_negate(hit->view), media);
    if (joint->joined != JOINED_OPAQUE || (hit->convexity != CONVEXITY_PLANAR && hit->convexity != CONVEXITY_FACETS))
        return onward;
    double side = hit->front ? hit->offset : -hit->offset;
    onward.origin = vec3_add_scaled(hit->point, hit->normal_geometric, side);
    onward.skip_primitive = hit->primitive + 1;
    onward.skip_part = hit->convexity == CONVEXITY_FACETS ? hit->part + 1 : 0;
    return onward;
}
