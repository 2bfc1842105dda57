/* Chooses one light of many, approximately in proportion to their contributions at a point: a hierarchy over the lights
 * with their power, their bounds and the cone of directions in which they shine (A. Conty Estevez and C. Kulla,
 * "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018; the vocabulary is that of M. Pharr, W.
 * Jakob, G. Humphreys, "Physically Based Rendering", 4th edition, section 12.6.3). The descent is random, at every node
 * in proportion to the importance of its two children. Lights without a position (skies, directional lights) are
 * separate from the tree; each of them is chosen as often as the whole tree. A mesh enters the tree by its triangles,
 * each of which is chosen for itself. The choice ignores visibility. A light with probability 0 contributes nothing at
 * the point. Equal lights in equal order give equal samplers. */
#ifndef GRAY_LIGHT_LIGHT_SAMPLER_H
#define GRAY_LIGHT_LIGHT_SAMPLER_H

#include "base/arena.h"
#include "base/bundle.h"
#include "base/list.h"
#include "base/pool.h"
#include "light/light.h"
#include "light/light_bounds.h"
#include "settings/settings.h"

/* A light, and of a mesh the triangle; 0 of others. */
struct light_part {
    uint32_t light, triangle;
};

struct light_tree_node {
    struct light_bounds bounds;
    uint32_t parent;        /* LIGHT_NONE: the root */
    uint32_t second;        /* of an inner node: its second child; the first one follows it. 0: a leaf */
    struct light_part part; /* of a leaf */
};

/* Parts have numbers: those of a light follow each other, in the order of the lights. */
struct light_sampler {
    enum light_choice choice;
    uint32_t count;           /* of parts that can be chosen: all that emit */
    const uint32_t *infinite; /* lights */
    uint32_t infinite_count;
    const struct light_tree_node *nodes; /* node 0 is the root */
    uint32_t node_count;
    const uint32_t *first_part;          /* by light: its first part */
    const uint32_t *leaf_of;             /* by part: its leaf; LIGHT_NONE: it cannot be chosen; LIGHT_LEAF_INFINITE */
    const struct light_part *candidates; /* of POWER and UNIFORM */
    const double *until;                 /* of POWER: share of the unit interval up to and with a candidate */
    const double *share;                 /* of POWER and UNIFORM, by part */
};
#define LIGHT_LEAF_INFINITE (LIGHT_NONE - 1)

/* pool: to be asked for cancelling, or NULL. */
struct light_sampler_options {
    enum light_choice choice;
    const struct pool *pool;
};
/* For lights that are prepared (light_prepare) and do not change. Everything is in the arena. Errors: no memory, too
 * many lights, cancelled. */
bool light_sampler_build(struct light_sampler *out, struct light_sampler_options options, const struct light *lights,
                         uint32_t light_count, struct arena *arena, struct error *error);
/* A part for a point whose surface has that normal ({0,0,0}: none), by a number u of [0, 1), and its probability. Its
 * light is LIGHT_NONE if the importance became 0 during the descent. */
struct light_part light_sampler_sample(const struct light_sampler *sampler, struct vec3 point, struct vec3 normal,
                                       double u, double *pmf);
/* The probability with which it chooses that part. */
double light_sampler_pmf(const struct light_sampler *sampler, struct vec3 point, struct vec3 normal,
                         struct light_part part);
/* What it points to (base/bundle.h). */
void light_sampler_bundle(struct bundle *bundle, struct light_sampler *sampler, uint32_t light_count);

#endif
