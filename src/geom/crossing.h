/* Crossings: what a ray meets, with just enough to compare and to find the place again. While searching only crossings
 * travel; normals, uv and materials are worked out once for the survivor (shape_describe). */
#ifndef GRAY_GEOM_CROSSING_H
#define GRAY_GEOM_CROSSING_H

#include "accel/triangle_index.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct crossing {
    union {
        struct {
            double t;
            double u, v;   /* barycentric weights of vertices 1 and 2 on a mesh; free for other shapes */
            uint32_t part; /* which face, triangle or nappe */
            bool enter;    /* the line goes from outside to inside here (geometric, after a CSG flip) */
            bool flip;     /* CSG difference or inverse turned the surface inside out */
            uint16_t leaf; /* which CSG operand made the surface; 0 outside CSG */
        };
        struct triangle_hit on_mesh; /* t to enter, so that a search of triangles writes them where they belong */
    };
};
_Static_assert(offsetof(struct crossing, part) == offsetof(struct triangle_hit, triangle) &&
                   offsetof(struct crossing, enter) == offsetof(struct triangle_hit, enter),
               "a hit on a mesh is a crossing but for what follows enter");

/* One worker's memory for lists of crossings, used as a stack. It grows between rays, never inside one: when it is too
 * small a push fails, `overflow` is set, and the caller of the whole ray calls geom_scratch_grow and asks again. */
struct geom_scratch {
    struct crossing *items;
    uint32_t capacity, used;
    bool overflow;
    /* what the searches cost; sums, never read by them */
    uint64_t shape_tests;
    uint64_t box_tests; /* of single boxes; a node of a hierarchy is one of cost.hierarchy_steps */
    struct triangle_cost cost;
};

/* A list on top of the scratch: items[first .. first + count - 1]. */
struct crossing_list {
    uint32_t first, count;
};

bool geom_scratch_init(struct geom_scratch *scratch, uint32_t capacity);
void geom_scratch_destroy(struct geom_scratch *scratch);
bool geom_scratch_grow(struct geom_scratch *scratch); /* doubles, clears overflow and used; false: no memory */

static inline bool geom_scratch_push(struct geom_scratch *scratch, struct crossing crossing) {
    if (scratch->used == scratch->capacity) {
        scratch->overflow = true;
        return false;
    }
    scratch->items[scratch->used++] = crossing;
    return true;
}

#endif
