/* node:bounds(). */
#include "scene/node_bounds.h"
#include "script/bindings_internal.h"
#include "script/context.h"

bool gr_bounds(struct script_context *context, const struct script_value *args, struct script_result *result,
               struct error *error) {
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
