/* Edges of solids that are not sharp. */
#ifndef GRAY_SCRIPT_GR_BEVEL_INTERNAL_H
#define GRAY_SCRIPT_GR_BEVEL_INTERNAL_H

#include "call/context.h"
#include "script/rows_internal.h"
#include "shape/bevelled.h"

#define EDGE                                                                                                           \
    { "edge", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "0", "Radius of its rounded edges; 0: they are sharp." }
#define CHAMFER                                                                                                        \
    {                                                                                                                  \
        "chamfer", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",                                                         \
            "Whether edges are cut at 45 degrees instead, so far from them."                                           \
    }

/* A prism with the parameter EDGE, which is given and not 0, and CHAMFER. */
bool bevel_prism(struct script_context *context, const struct prism_input *input, const struct script_value *edge,
                 const struct script_value *chamfer, struct shape *shape, struct error *error);
bool bevel_box(struct script_context *context, const struct box *box, const struct script_value *edge,
               const struct script_value *chamfer, struct shape *shape, struct error *error);
bool bevel_cylinder(struct script_context *context, struct bevelled_cylinder *input, const struct script_value *edge,
                    const struct script_value *chamfer, struct shape *shape, struct error *error);
static inline bool has_bevel(const struct script_value *edge) {
    return edge->given && edge->number > 0;
}

#endif
