/* One traversal for each list; scenes without lists pay nothing. */
#include "world/light_lists.h"

#include "world/path.h"

#include <string.h>

static bool is_listed(const struct node *const *list, uint32_t count, const struct node *node) {
    for (uint32_t i = 0; i < count; i++)
        if (list[i] == node)
            return true;
    return false;
}

bool light_lists_mark(const struct world *world, const struct node *const *list, uint32_t list_count, uint8_t *lit,
                      uint8_t value, const struct node *root) {
    struct scene_traversal t = world_traversal(world, root, sizeof(bool));
    enum scene_event event;
    uint32_t next = 0;
    while ((event = scene_traversal_next(&t)) < SCENE_END) {
        if (event != SCENE_ENTER)
            continue;
        const struct node *node = scene_traversal_node(&t);
        const bool *above = t.depth > 1 ? scene_traversal_frame(&t, 1) : NULL;
        bool *listed = scene_traversal_frame(&t, 0);
        *listed = (above && *above) || is_listed(list, list_count, node);
        uint32_t count = world_primitives_of(world, node, next);
        if (*listed && count > 0)
            memset(lit + next, value, count);
        next += count;
    }
    scene_traversal_end(&t);
    return event == SCENE_END;
}

bool light_lists_resolve(const struct world *world, struct light *lights, struct arena *arena, const struct node *root,
                         struct error *error) {
    for (uint32_t i = 0; i < world->light_count; i++) {
        struct light *light = &lights[i];
        light->lit = NULL;
        if ((!light->include && !light->exclude) || world->primitive_count == 0)
            continue;
        uint8_t *lit = arena_alloc_array(arena, world->primitive_count, 1);
        bool ok = lit != NULL;
        if (ok)
            memset(lit, light->include == NULL, world->primitive_count);
        ok = ok && (!light->include || light_lists_mark(world, light->include, light->include_count, lit, 1, root)) &&
             (!light->exclude || light_lists_mark(world, light->exclude, light->exclude_count, lit, 0, root));
        if (!ok)
            return error_no_memory(error, "the lights of the scene");
        light->lit = lit;
    }
    return true;
}
