/* A stack of frames, each with the caller's memory behind it, beside the path as the caller sees it. */
#include "scene/traversal.h"

#include "base/mem.h"

struct frame {
    const struct node_child *next; /* of the children at the present placement */
    uint32_t operand, operands;    /* the next one, and how many are visited */
    uint32_t round, rounds;        /* how often the children were begun, and will be */
    uint32_t entered_as;           /* number of the operand, or SCENE_CHILD */
};

struct transform scene_step_map(const struct scene_step *step, const struct transform *from_node) {
    if (step->placement == 0)
        return *from_node;
    struct transform node_from_child = placement_transform(step->node->placements, step->placement - 1);
    return transform_compose(from_node, &node_from_child);
}

static size_t frame_bytes(const struct scene_traversal *t) {
    return sizeof(struct frame) + (t->frame_size + 7) / 8 * 8;
}

static struct frame *frame_at(const struct scene_traversal *t, uint32_t level) {
    return (struct frame *)(void *)(t->frames + level * frame_bytes(t));
}

void scene_traversal_begin(struct scene_traversal *t, const struct node *root) {
    t->root = root;
    t->depth = 0;
    t->leaving = false;
}

void scene_traversal_end(struct scene_traversal *t) {
    mem_free(t->frames);
    mem_free(t->steps);
    t->frames = NULL;
    t->steps = NULL;
    t->capacity = t->depth = 0;
}

void *scene_traversal_frame(const struct scene_traversal *t, uint32_t levels) {
    return frame_at(t, t->depth - 1 - levels) + 1;
}

uint32_t scene_traversal_operand(const struct scene_traversal *t) {
    return frame_at(t, t->depth - 1)->entered_as;
}

static uint32_t operands_of(const struct scene_traversal *t, const struct node *node) {
    if (node->kind != NODE_CSG)
        return 0;
    switch (t->operands) {
    case OPERANDS_AS_CHILD:
        return node_is_placing(node) ? 1 : 0;
    case OPERANDS_OF_SOLIDS:
        return node->operation == NODE_BOUNDED ? 1 : node->operand_count;
    case OPERANDS_ALL:
        return node->operand_count;
    }
    return 0;
}

static uint32_t rounds_of(const struct scene_traversal *t, const struct node *node) {
    if (!node->first_child || (t->inside && t->depth == 0))
        return 0;
    return node->placements && !t->distinct ? node->placements->count : 1;
}

static bool grow(struct scene_traversal *t) {
    uint32_t capacity = t->capacity ? t->capacity * 2 : 32;
    char *frames = mem_resize_array(t->frames, capacity, frame_bytes(t));
    if (!frames)
        return false;
    t->frames = frames;
    struct scene_step *steps = mem_resize_array(t->steps, capacity, sizeof *steps);
    if (!steps)
        return false;
    t->steps = steps;
    t->capacity = capacity;
    return true;
}

static enum scene_event enter(struct scene_traversal *t, const struct node *node, uint32_t entered_as) {
    if (t->depth == t->capacity && !grow(t))
        return SCENE_NO_MEMORY;
    *frame_at(t, t->depth) =
        (struct frame){.operands = operands_of(t, node), .rounds = rounds_of(t, node), .entered_as = entered_as};
    t->steps[t->depth++] = (struct scene_step){node, 0};
    return SCENE_ENTER;
}

static bool is_visited(const struct scene_traversal *t, const struct node *node) {
    return !t->draws || t->draws[node->index] != 0;
}

/* Nodes with many children do not fit into caches: the next child is fetched while this one is visited. */
static void fetch_early(const struct node *node) {
    enum { LINE = 64, LINES = 4 };
    for (int i = 0; i < LINES; i++)
        __builtin_prefetch((const char *)node + (ptrdiff_t)i * LINE);
}

void scene_traversal_skip(struct scene_traversal *t) {
    t->leaving = true;
}

enum scene_event scene_traversal_next(struct scene_traversal *t) {
    if (t->leaving) {
        t->leaving = false;
        t->depth--;
    }
    if (t->root) {
        const struct node *root = t->root;
        t->root = NULL;
        return is_visited(t, root) ? enter(t, root, SCENE_CHILD) : SCENE_END;
    }
    /* Operands first, then the children, once for each placement. */
    if (t->depth == 0)
        return SCENE_END;
    struct frame *frame = frame_at(t, t->depth - 1);
    struct scene_step *step = &t->steps[t->depth - 1];
    while (frame->operand < frame->operands) {
        const struct node *operand = step->node->operands[frame->operand++];
        if (is_visited(t, operand))
            return enter(t, operand, frame->operand - 1);
    }
    while (frame->next) {
        const struct node *child = frame->next->node;
        frame->next = frame->next->next;
        if (frame->next)
            fetch_early(frame->next->node);
        if (is_visited(t, child))
            return enter(t, child, SCENE_CHILD);
    }
    if (frame->round < frame->rounds) {
        frame->round++;
        frame->next = step->node->first_child;
        step->placement = step->node->placements && !t->distinct ? frame->round : 0;
        return SCENE_CHILDREN;
    }
    step->placement = 0;
    t->leaving = true;
    return SCENE_LEAVE;
}
