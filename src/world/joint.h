/* A joint: the place where a ray meets several surfaces that coincide, within the bounds of the errors of both. The ray
 * goes from the medium before all of them to the medium behind all of them, through one boundary. If one of them is
 * opaque, it is what is seen; of several opaque ones the first in flattening order. If the media before and behind are
 * equal there is no boundary: the ray goes on as if nothing were there. */
#ifndef GRAY_WORLD_JOINT_H
#define GRAY_WORLD_JOINT_H

#include "material/material_eval.h"
#include "world/world.h"

/* Whether several surfaces are at the hit. */
enum joined {
    JOINED_NOT,
    JOINED_OPAQUE,
    JOINED_TRANSPARENT,
    JOINED_AWAY /* the media before and behind are equal: nothing is there */
};

/* What belongs to a hit where surfaces touch; if there is no other surface, only `joined` and `passed` are set. */
struct joint {
    enum joined joined;
    bool passed;                        /* the ray has passed boundaries without effect, so it is `ray` now */
    double past;                        /* of JOINED_AWAY: the last t of the surfaces */
    struct bsdf_joint boundary;         /* of JOINED_TRANSPARENT */
    struct ray ray;                     /* begins behind them, in the media `before` */
    struct medium_stack before, behind; /* the hit */
};

/* Resolves a hit of the ray (in the media ray->media) where world_touches says so: `hit` becomes that of the
 * surface that is seen, with the offset of them all. False: behind boundaries without effect the ray hits nothing. */
bool world_join(const struct world *world, const struct ray *ray, struct world_scratch *scratch, struct hit *hit,
                struct joint *joint);

/* The same for the ray of a path, in its own media, at one place: after JOINED_AWAY the ray begins behind it, and is to
 * be followed again. */
void world_join_path(const struct world *world, struct ray *ray, struct medium_stack *media,
                     struct world_scratch *scratch, struct hit *hit, struct joint *joint);

/* The bounds of the point of a hit, with its error. */
static inline struct box joint_bounds(const struct hit *hit) {
    struct vec3 margin = vec3_all(hit->offset);
    return (struct box){vec3_sub(hit->point, margin), vec3_add(hit->point, margin)};
}

/* Whether a hit needs world_join: another surface may be at its place. */
static inline bool world_touches(const struct world *world, const struct hit *hit) {
    if (!touching_has(&world->touching, hit->primitive))
        return false;
    struct box bounds = joint_bounds(hit);
    return touching_any(world, hit->primitive, &bounds);
}

/* For material_eval, or NULL. */
static inline const struct bsdf_joint *joint_boundary(const struct joint *joint) {
    return joint->joined == JOINED_TRANSPARENT ? &joint->boundary : NULL;
}

/* The media behind the invisible surface of a medium at the hit, and behind all that touch it. False: it is none. */
bool joint_pass_invisible(const struct world *world, const struct joint *joint, const struct hit *hit,
                          struct medium_stack *stack);

/* The ray that continues through a hole of the surface at the hit of `ray`: past all surfaces there, or on to the next
 * one of them. */
struct ray joint_ray_through_hole(const struct joint *joint, const struct hit *hit, const struct ray *ray,
                                  const struct medium_stack *media);

#endif
