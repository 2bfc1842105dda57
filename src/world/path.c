/* The walk of flatten.c without its transforms. What a node has placed is what comes next in the list and says that it
 * is of this node. */
#include "world/path.h"

#include "base/mem.h"

#include <stdio.h>
#include <string.h>

struct walk_frame {
    const struct node *node;
    const struct node *operand; /* of a clipped or bounded node, before the children */
    const struct node_child *next;
    uint32_t place;
};

struct walk {
    const struct world *world;
    world_path_visit *visit;
    void *context;
    struct walk_frame *frames;
    struct path_step *steps; /* as many as there are frames, and one for a node without */
    uint32_t depth, capacity;
    uint32_t at; /* the next primitive */
    bool ended;
};

static bool walk_grow(struct walk *walk) {
    uint32_t capacity = walk->capacity ? walk->capacity * 2 : 32;
    struct walk_frame *frames = mem_resize_array(walk->frames, capacity, sizeof *frames);
    if (frames)
        walk->frames = frames;
    struct path_step *steps = frames ? mem_resize_array(walk->steps, (size_t)capacity + 1, sizeof *steps) : NULL;
    if (steps) {
        walk->steps = steps;
        walk->capacity = capacity;
    }
    return steps != NULL;
}

/* What the node itself has placed. */
static void walk_tell(struct walk *walk, const struct node *node) {
    const struct world *world = walk->world;
    bool draws = node->kind == NODE_GEOMETRY ||
                 (node->kind == NODE_CSG && node->operation != NODE_CLIPPED && node->operation != NODE_BOUNDED);
    if (!draws || walk->at >= world->placed_count || placed_node(world, walk->at) != node)
        return;
    uint32_t count = placed_thing(world, walk->at)->parts;
    walk->ended = !walk->visit(walk->context, walk->at, count, walk->steps, walk->depth + 1);
    walk->at += count;
}

static bool walk_enter(struct walk *walk, const struct node *node) {
    if (walk->depth == walk->capacity && !walk_grow(walk))
        return false;
    walk->steps[walk->depth] = (struct path_step){node, 0};
    walk_tell(walk, node);
    const struct node *operand = node_places_operand(node);
    const struct node_child *first = node->first_child;
    if (node->placements && node->placements->count == 0)
        first = NULL;
    if (!first && !operand)
        return true;
    walk->frames[walk->depth] = (struct walk_frame){node, operand, first, 0};
    walk->depth++;
    return true;
}

bool world_walk_paths(const struct world *world, const struct node *root, world_path_visit *visit, void *context,
                      struct error *error) {
    struct walk walk = {.world = world, .visit = visit, .context = context};
    bool ok = root->drawable == 0 || walk_enter(&walk, root);
    while (ok && walk.depth > 0 && !walk.ended && walk.at < world->placed_count) {
        struct walk_frame *frame = &walk.frames[walk.depth - 1];
        struct path_step *step = &walk.steps[walk.depth - 1];
        const struct placements *placements = frame->node->placements;
        if (frame->operand) {
            const struct node *operand = frame->operand;
            frame->operand = NULL;
            step->place = 0;
            ok = walk_enter(&walk, operand);
        } else if (frame->next) {
            const struct node *child = frame->next->node;
            frame->next = frame->next->next;
            step->place = placements ? frame->place + 1 : 0;
            ok = child->drawable == 0 || walk_enter(&walk, child);
        } else if (placements && frame->place + 1 < placements->count) {
            frame->place++;
            frame->next = frame->node->first_child;
        } else {
            walk.depth--;
        }
    }
    mem_free(walk.frames);
    mem_free(walk.steps);
    return ok || error_no_memory(error, "the ways to the nodes");
}

size_t world_path_text(const struct path_step *steps, uint32_t depth, char *out, size_t size) {
    size_t used = 0;
    char place[16] = "";
    for (uint32_t i = 0; i < depth; i++) {
        if (steps[i].place > 0)
            (void)snprintf(place, sizeof place, " [%u]", steps[i].place);
        int length =
            snprintf(used < size ? out + used : NULL, used < size ? size - used : 0, "%s%s#%u%s", i > 0 ? " / " : "",
                     steps[i].node->name, steps[i].node->serial, steps[i].place > 0 ? place : "");
        used += length > 0 ? (size_t)length : 0;
    }
    for (char *c = out; size > 0 && *c; c++)
        *c = (unsigned char)*c < 32 || *c == 127 ? '?' : *c;
    return used;
}

struct wanted_paths {
    const uint32_t *wanted;
    uint32_t count, next;
    struct arena *arena;
    const char **out;
    bool failed;
};

static bool keep_path(void *context, uint32_t first, uint32_t count, const struct path_step *steps, uint32_t depth) {
    struct wanted_paths *paths = context;
    const char *text = NULL;
    while (paths->next < paths->count && paths->wanted[paths->next] < first + count) {
        if (paths->wanted[paths->next] >= first && !text) {
            size_t size = world_path_text(steps, depth, NULL, 0) + 1;
            char *copy = arena_alloc(paths->arena, size);
            paths->failed = !copy;
            if (!copy)
                return false;
            (void)world_path_text(steps, depth, copy, size);
            text = copy;
        }
        paths->out[paths->next++] = text;
    }
    return paths->next < paths->count;
}

bool world_find_paths(const struct world *world, const struct node *root, const uint32_t *wanted, uint32_t count,
                      struct arena *arena, const char **out, struct error *error) {
    struct wanted_paths paths = {.wanted = wanted, .count = count, .arena = arena, .out = out};
    for (uint32_t i = 0; i < count; i++)
        out[i] = NULL;
    if (count == 0)
        return true;
    if (!world_walk_paths(world, root, keep_path, &paths, error))
        return false;
    return !paths.failed || error_no_memory(error, "the ways to the nodes");
}

/* --- inside of combined solids --- */

struct operand_walk {
    world_operand_visit *visit;
    void *context;
    struct path_step steps[OPERAND_DEPTH];
    uint32_t met; /* shapes so far */
    bool ended;
};

static void walk_operand(struct operand_walk *walk, const struct node *node, uint32_t level);

static void walk_operands(struct operand_walk *walk, const struct node *node, uint32_t level) {
    uint32_t count = node->operation == NODE_BOUNDED ? 1 : node->operand_count; /* the bound is no part of it */
    for (uint32_t i = 0; i < count && !walk->ended; i++)
        walk_operand(walk, node->operands[i], level);
}

/* In the order of flatten_csg.c: the node's own surface, its operands, its children at every place. */
static void walk_operand(struct operand_walk *walk, const struct node *node, uint32_t level) {
    uint32_t first = walk->met;
    if (node->singular)
        return;
    if (level == OPERAND_DEPTH) {
        walk->ended = true;
        return;
    }
    walk->steps[level] = (struct path_step){node, 0};
    bool nothing =
        node->kind == NODE_GEOMETRY && node->shape.kind == SHAPE_MESH && mesh_triangle_count(node->shape.mesh) == 0;
    walk->met += node->kind == NODE_GEOMETRY && !nothing;
    if (node->kind == NODE_CSG)
        walk_operands(walk, node, level + 1);
    uint32_t rounds = node->placements ? node->placements->count : 1;
    for (uint32_t i = 0; i < rounds && node->first_child; i++) {
        walk->steps[level].place = node->placements ? i + 1 : 0;
        for (const struct node_child *child = node->first_child; child && !walk->ended; child = child->next)
            walk_operand(walk, child->node, level + 1);
    }
    walk->steps[level].place = 0;
    walk->ended = walk->ended || !walk->visit(walk->context, first, walk->met, walk->steps, level + 1);
}

void world_walk_operands(const struct node *solid, world_operand_visit *visit, void *context) {
    struct operand_walk walk = {.visit = visit, .context = context};
    if (solid->kind == NODE_CSG)
        walk_operands(&walk, solid, 0);
}

struct wanted_operand {
    struct path_step *steps;
    uint32_t capacity, origin, depth;
};

static bool keep_operand(void *context, uint32_t first, uint32_t end, const struct path_step *steps, uint32_t depth) {
    struct wanted_operand *wanted = context;
    /* What is below a shape was told before it, so the first one that has the leaf is what it was made of. */
    if (wanted->origin < first || wanted->origin >= end || depth > wanted->capacity)
        return wanted->origin >= end;
    memcpy(wanted->steps, steps, depth * sizeof *steps);
    wanted->depth = depth;
    return false;
}

uint32_t world_operand_way(const struct node *solid, uint32_t origin, struct path_step *steps, uint32_t capacity) {
    struct wanted_operand wanted = {.steps = steps, .capacity = capacity, .origin = origin};
    world_walk_operands(solid, keep_operand, &wanted);
    return wanted.depth;
}
