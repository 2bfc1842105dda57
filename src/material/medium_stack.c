/* See medium_stack.h. */
#include "material/medium_stack.h"

#include <string.h>

void medium_stack_copy(struct medium_stack *to, const struct medium_stack *from) {
    to->count = from->count;
    memcpy(to->entries, from->entries, from->count * sizeof *from->entries);
}

void medium_stack_enter(struct medium_stack *stack, const struct medium *medium) {
    if (stack->count == MEDIUM_STACK_LIMIT) {
        memmove(stack->entries, stack->entries + 1, (MEDIUM_STACK_LIMIT - 1) * sizeof *stack->entries);
        stack->count--;
    }
    stack->entries[stack->count++] = *medium;
}

/* One more than the place of the solid's latest entry; 0: it has none. */
static uint32_t latest(const struct medium_stack *stack, uint32_t primitive) {
    uint32_t i = stack->count;
    while (i > 0 && stack->entries[i - 1].primitive != primitive)
        i--;
    return i;
}

void medium_stack_leave(struct medium_stack *stack, uint32_t primitive) {
    uint32_t end = latest(stack, primitive);
    if (end == 0)
        return;
    memmove(stack->entries + end - 1, stack->entries + end, (stack->count - end) * sizeof *stack->entries);
    stack->count--;
}

void medium_stack_cross(struct medium_stack *stack, const struct medium_boundary *boundary) {
    if (boundary->entering)
        medium_stack_enter(stack, &boundary->medium);
    else
        medium_stack_leave(stack, boundary->medium.primitive);
}

double medium_stack_eta(const struct medium_stack *stack, const struct medium_boundary *boundary) {
    double here = medium_stack_ior(stack);
    if (boundary->entering)
        return here / boundary->medium.ior;
    uint32_t end = latest(stack, boundary->medium.primitive);
    /* An open surface seen from behind: the ray is in this medium although it never entered it. */
    if (end == 0)
        return boundary->medium.ior / here;
    if (end < stack->count)
        return 1;
    return here / (end > 1 ? stack->entries[end - 2].ior : 1);
}
