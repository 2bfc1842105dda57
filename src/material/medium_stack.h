/* The stack of media a ray is inside of. Leaving a solid removes that solid wherever it is in the stack; the current
 * medium is the one entered last; outside of everything the index is 1. By value: a branch of the path copies and
 * changes it. */
#ifndef GRAY_MATERIAL_MEDIUM_STACK_H
#define GRAY_MATERIAL_MEDIUM_STACK_H

#include "math/vec3.h"

#include <stdbool.h>
#include <stdint.h>

enum { MEDIUM_STACK_LIMIT = 32 }; /* deeper nestings forget the outermost (docs/limits.md) */

/* The inside of one solid. */
struct medium {
    uint32_t primitive; /* the solid: number of its primitive */
    double ior;
    struct vec3 absorption; /* the logarithm of light falls by this per unit */
};

struct medium_stack {
    uint32_t count;
    struct medium entries[MEDIUM_STACK_LIMIT];
};

/* A surface between two media, as a ray meets it. */
struct medium_boundary {
    struct medium medium; /* on the inner side of the surface */
    bool entering;        /* the ray comes from the outer side */
};

static inline double medium_stack_ior(const struct medium_stack *stack) {
    return stack->count ? stack->entries[stack->count - 1].ior : 1;
}

/* Only the entries in use. */
void medium_stack_copy(struct medium_stack *to, const struct medium_stack *from);
void medium_stack_enter(struct medium_stack *stack, const struct medium *medium);
/* The latest entry of the solid goes; nothing happens when it is not there (an open surface, a camera on it). */
void medium_stack_leave(struct medium_stack *stack, uint32_t primitive);

/* The stack behind the surface. */
void medium_stack_cross(struct medium_stack *stack, const struct medium_boundary *boundary);
/* The index of refraction on the ray's side over the index behind the surface. */
double medium_stack_eta(const struct medium_stack *stack, const struct medium_boundary *boundary);

#endif
