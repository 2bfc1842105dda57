/* node:bounds(). */
#include "scene/node_bounds.h"
#include "script/actions.h"
#include "script/context.h"

bool act_bounds(struct context *context, const struct value *args, struct result *result, struct error *error) {
    struct box *box = arena_alloc(&context->call, sizeof *box);
    if (!box)
        return error_no_memory(error, "a box");
    if (!node_bounds(args[SELF].node, box, error))
        return false;
    if (box_is_empty(box))
        return error_set(error, ERROR_SCENE, "no shape is below this node");
    result->pointer = box;
    return true;
}
