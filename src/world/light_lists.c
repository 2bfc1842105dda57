/* The same walk as flattening's, in the same order, with a running count of placed primitives in the place of the
 * transforms: a node places its primitive before its children, always or never, so the next placed primitive is of
 * this node exactly when it was placed. One walk a list; scenes without lists pay nothing. */
#include "world/light_lists.h"

#include "base/mem.h"

#include <string.h>

struct walk {
    const struct world *world;
    const struct node *const *list;
    uint32_t list_count, placed;
    uint8_t *lit, value; /* what a listed primitive gets */
    struct walk_frame {
        const struct node *node;
        const struct node *operand; /* that is placed before the children */
        const struct node_child *next;
        uint32_t rounds; /* of the children that are still to come */
        bool listed;
    } * frames;
    size_t count, capacity;
};

static bool enter(struct walk *walk, const struct node *node, bool listed) {
    for (uint32_t i = 0; i < walk->list_count && !listed; i++)
        listed = walk->list[i] == node;
    const struct world *world = walk->world;
    uint32_t end = walk->placed;
    if (end < world->placed_count && placed_node(world, end) == node)
        end += world->things[world->placed[end].thing].parts;
    while (walk->placed < end) {
        if (listed)
            walk->lit[walk->placed] = walk->value;
        walk->placed++;
    }
    if (walk->count == walk->capacity) {
        size_t capacity = walk->capacity ? walk->capacity * 2 : 64;
        struct walk_frame *frames = mem_resize_array(walk->frames, capacity, sizeof *frames);
        if (!frames)
            return false;
        walk->frames = frames;
        walk->capacity = capacity;
    }
    uint32_t rounds = node->placements ? node->placements->count : 1;
    walk->frames[walk->count++] = (struct walk_frame){node, node_places_operand(node), NULL, rounds, listed};
    return true;
}

bool light_lists_mark(const struct world *world, const struct node *const *list, uint32_t list_count, uint8_t *lit,
                      uint8_t value, const struct node *root) {
    struct walk walk = {.world = world, .list = list, .list_count = list_count, .lit = lit, .value = value};
    bool ok = root->drawable == 0 || enter(&walk, root, false);
    while (ok && walk.count > 0) {
        struct walk_frame *frame = &walk.frames[walk.count - 1];
        const struct node *operand = frame->operand;
        if (operand) {
            frame->operand = NULL;
            ok = enter(&walk, operand, frame->listed);
            continue;
        }
        const struct node_child *link = frame->next;
        if (!link && frame->rounds > 0) {
            frame->rounds--;
            frame->next = frame->node->first_child;
            continue;
        }
        if (!link) {
            walk.count--;
            continue;
        }
        frame->next = link->next;
        if (link->node->drawable > 0)
            ok = enter(&walk, link->node, frame->listed);
    }
    mem_free(walk.frames);
    return ok;
}

bool light_lists_resolve(const struct world *world, struct light *lights, struct arena *arena, struct node *root,
                         struct error *error) {
    for (uint32_t i = 0; i < world->light_count; i++) {
        struct light *light = &lights[i];
        light->lit = NULL;
        if ((!light->include && !light->exclude) || world->placed_count == 0)
            continue;
        uint8_t *lit = arena_alloc_array(arena, world->placed_count, 1);
        bool ok = lit != NULL;
        if (ok)
            memset(lit, light->include == NULL, world->placed_count);
        ok = ok && (!light->include || light_lists_mark(world, light->include, light->include_count, lit, 1, root)) &&
             (!light->exclude || light_lists_mark(world, light->exclude, light->exclude_count, lit, 0, root));
        if (!ok)
            return error_no_memory(error, "the lights of the scene");
        light->lit = lit;
    }
    return true;
}
