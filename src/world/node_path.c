/* The primitives of a node are the next ones in the list that name this node. */
#include "world/node_path.h"

#include "scene/change.h"

#include <stdio.h>
#include <string.h>

struct scene_traversal world_traversal(const struct world *world, const struct node *root, size_t frame_size) {
    struct scene_traversal t = {
        .operands = OPERANDS_AS_CHILD, .draws = world->authored.draws, .frame_size = frame_size};
    scene_traversal_begin(&t, root);
    return t;
}

uint32_t world_primitives_of(const struct world *world, const struct node *node, uint32_t next) {
    bool is_primitive_node = next < world->primitive_count && primitive_node(world, next) == node;
    return is_primitive_node ? primitive_prototype(world, next)->parts : 0;
}

bool world_visit_node_paths(const struct world *world, const struct node *root, node_path_visit *visit, void *context,
                            struct error *error) {
    struct scene_traversal t = world_traversal(world, root, 0);
    enum scene_event event = SCENE_END;
    uint32_t next = 0;
    bool go_on = true;
    while (go_on && next < world->primitive_count && (event = scene_traversal_next(&t)) < SCENE_END) {
        uint32_t count = event == SCENE_ENTER ? world_primitives_of(world, scene_traversal_node(&t), next) : 0;
        if (count > 0)
            go_on = visit(context, next, count, t.steps, t.depth);
        next += count;
    }
    scene_traversal_end(&t);
    return event != SCENE_NO_MEMORY || error_no_memory(error, "the paths to the nodes");
}

size_t node_path_text(const struct scene_step *steps, uint32_t depth, char *out, size_t size) {
    size_t used = 0;
    char suffix[16] = "";
    for (uint32_t i = 0; i < depth; i++) {
        if (steps[i].placement > 0)
            (void)snprintf(suffix, sizeof suffix, " [%u]", steps[i].placement);
        uint32_t added = added_number(steps[i].node->serial);
        int length = snprintf(used < size ? out + used : NULL, used < size ? size - used : 0, "%s%s%s#%u%s",
                              i > 0 ? " / " : "", added > 0 ? "added " : "", steps[i].node->name,
                              added > 0 ? added : steps[i].node->serial, steps[i].placement > 0 ? suffix : "");
        used += length > 0 ? (size_t)length : 0;
    }
    for (char *c = out; size > 0 && *c; c++)
        *c = (unsigned char)*c < 32 || *c == 127 ? '?' : *c;
    return used;
}

struct node_path_search {
    struct primitive_list primitives;
    uint32_t next;
    struct arena *arena;
    const char **out;
    bool failed;
};

static bool keep_node_path(void *context, uint32_t first, uint32_t count, const struct scene_step *steps,
                           uint32_t depth) {
    struct node_path_search *search = context;
    const char *text = NULL;
    while (search->next < search->primitives.count && search->primitives.numbers[search->next] < first + count) {
        if (search->primitives.numbers[search->next] >= first && !text) {
            size_t size = node_path_text(steps, depth, NULL, 0) + 1;
            char *copy = arena_alloc(search->arena, size);
            search->failed = !copy;
            if (!copy)
                return false;
            (void)node_path_text(steps, depth, copy, size);
            text = copy;
        }
        search->out[search->next++] = text;
    }
    return search->next < search->primitives.count;
}

bool world_find_node_paths(const struct world *world, const struct node *root, struct primitive_list primitives,
                           struct arena *arena, const char **out, struct error *error) {
    struct node_path_search search = {.primitives = primitives, .arena = arena, .out = out};
    for (uint32_t i = 0; i < primitives.count; i++)
        out[i] = NULL;
    if (primitives.count == 0)
        return true;
    if (!world_visit_node_paths(world, root, keep_node_path, &search, error))
        return false;
    return !search.failed || error_no_memory(error, "the paths to the nodes");
}

/* --- inside of combined solids --- */

bool world_visit_operands(const struct node *solid, world_operand_visit *visit, void *context) {
    struct scene_traversal t = {.operands = OPERANDS_OF_SOLIDS, .inside = true, .frame_size = sizeof(uint32_t)};
    enum scene_event event = SCENE_END;
    uint32_t met = 0; /* shapes so far */
    bool go_on = solid->kind == NODE_CSG;
    scene_traversal_begin(&t, solid);
    while (go_on && (event = scene_traversal_next(&t)) < SCENE_END) {
        const struct node *node = scene_traversal_node(&t);
        uint32_t *first = scene_traversal_frame(&t, 0);
        if (event == SCENE_ENTER && t.depth > 1 && node->singular) {
            scene_traversal_skip(&t);
        } else if (event == SCENE_ENTER) {
            *first = met;
            met += node_has_surface(node);
            go_on = t.depth - 1 <= OPERAND_DEPTH;
        } else if (event == SCENE_LEAVE && t.depth > 1) {
            go_on = visit(context, *first, met, t.steps + 1, t.depth - 1);
        }
    }
    scene_traversal_end(&t);
    return event != SCENE_NO_MEMORY;
}

struct operand_search {
    struct scene_step *steps;
    uint32_t capacity, origin, depth;
};

static bool keep_operand(void *context, uint32_t first, uint32_t end, const struct scene_step *steps, uint32_t depth) {
    struct operand_search *search = context;
    /* Shapes are reported after their descendants, so the first one with the leaf is its origin. */
    if (search->origin < first || search->origin >= end || depth > search->capacity)
        return search->origin >= end;
    memcpy(search->steps, steps, depth * sizeof *steps);
    search->depth = depth;
    return false;
}

bool world_operand_path(const struct node *solid, uint32_t origin, struct scene_step *steps, uint32_t capacity,
                        uint32_t *length) {
    struct operand_search search = {.steps = steps, .capacity = capacity, .origin = origin};
    bool ok = world_visit_operands(solid, keep_operand, &search);
    *length = search.depth;
    return ok;
}
