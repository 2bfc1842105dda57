/* The search of waves of paths (device/), for graphics cards: one loop over binary hierarchies with boxes in single
 * precision (accel/float_tree.h). Its top contains the primitives, and in the place of a plain mesh in world space the
 * mesh's triangles. Other plain meshes have a hierarchy over their triangles, which their instances share. Plain: no
 * culled sides and no holes. The test of accel/triangle.h decides triangles; world_ask_nearest and world_ask_any answer
 * for everything else. So all answers have the bits of the other searches.
 * It is made for a bundle alone: processors are quicker with their own. */
#ifndef GRAY_WORLD_DEVICE_SEARCH_H
#define GRAY_WORLD_DEVICE_SEARCH_H

#include "accel/float_tree.h"
#include "world/packet.h"

/* A triangle of a leaf, by its place there. */
struct device_triangle {
    double corners[9];
    uint32_t part, primitive; /* its number in the mesh; unused in the hierarchy of a mesh */
} __attribute__((aligned(16)));

/* Owner: the caller of device_search_build, device_search_destroy. */
struct device_search {
    struct float_node *nodes;
    struct device_triangle *triangles;
    uint32_t *roots; /* by prototype: of its mesh; FLOAT_TREE_NONE: it has no hierarchy of its own; DEVICE_SLOW */
    uint32_t node_count, triangle_count, prototype_count;
    uint32_t top; /* the root of the top */
    bool has_slow;
};
/* A root of a solid whose equations take long: combined solids, tori, solids of many parts. Threads of a card, of which
 * each meets another one, wait for each other. So a search may leave them to another kernel, for which rays are sorted
 * by what they ask. */
#define DEVICE_SLOW (UINT32_MAX - 2)
enum { DEVICE_QUESTIONS = 4 };
struct device_questions {
    uint32_t primitives[DEVICE_QUESTIONS], count;
};

/* More primitives than this have no numbers in leaves. */
enum { DEVICE_SEARCH_PRIMITIVES = FLOAT_TREE_MANY };

/* Errors: no memory, cancelled; nothing is left to destroy then. */
bool device_search_build(struct device_search *search, const struct world *world, struct pool *pool,
                         struct error *error);
void device_search_destroy(struct device_search *search);
bundle_fields device_search_bundle; /* what it points to (base/bundle.h) */
/* The world with this search in place of its own. Both are borrowed. */
struct world device_search_world(const struct device_search *search, const struct world *world);

struct device_query {
    const struct world *world;
    const struct ray *ray;
    struct world_scratch *scratch;
};
/* What a ray meets first in such a world; primitive WORLD_NOTHING: nothing. questions: or NULL; primitives that were
 * left. With the answer of each of them kept, in any order, it is that. */
void device_search_nearest(const struct device_query *query, struct packet_answer *answer,
                           struct device_questions *questions);
/* of: a primitive, alone; what it cannot change in the answer so far, `best`, it leaves out. */
void device_search_ask(const struct device_query *query, uint32_t of, const struct packet_answer *best,
                       struct packet_answer *answer);
void device_search_keep(struct packet_answer *best, const struct packet_answer *answer);
/* world_nearest_crossing and world_any of such a world. */
bool device_search_crossing(const struct device_query *query, uint32_t *primitive, struct crossing *crossing);
bool device_search_any(const struct world *world, const struct ray *ray, struct world_scratch *scratch);

#endif
