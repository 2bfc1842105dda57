/* Shared by the files with rows of the table of gr functions: the macros of its columns. */
#ifndef GRAY_SCRIPT_ROWS_INTERNAL_H
#define GRAY_SCRIPT_ROWS_INTERNAL_H

#include "script/gr_medium_internal.h"
#include "script/table_internal.h"

#include <math.h>

/* The range of a parameter, and no choices. */
#define ANY 0, 0, NULL
#define ABOVE(low) (low), (double)INFINITY, NULL
#define IN_RANGE(low, high) (low), (high), NULL

/* A row of a list, which clang-format does not break at every comma. */
#define ROW(...)                                                                                                       \
    { __VA_ARGS__ }

#define NAME_HELP "Name of the node, for messages."
#define MATERIAL_HELP "Material of the surface."

#define COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))
#define GR(name, parameters, result, run, help, ...)                                                                   \
    { name, OWNER_GR, parameters, COUNT(parameters), {__VA_ARGS__}, result, run, help, false, NULL }
#define NODE(name, parameters, result, run, help, ...)                                                                 \
    { name, OWNER_NODE, parameters, COUNT(parameters), {__VA_ARGS__}, result, run, help, false, NULL }

/* The first parameter of every method. */
#define SELF_PARAMETER [SELF] = {"self", KIND_NODE, 0, ANY, NULL, NULL, "The node."}

/* Every shape begins with these parameters; its own start at SHAPE_FIRST. */
enum { SHAPE_NAME, SHAPE_MATERIAL, SHAPE_THIN_WALLED, SHAPE_MEDIUM, SHAPE_FIRST };
#define THIN_WALLED_HELP                                                                                               \
    "Whether a transparent surface is a thin wall, which light passes straight on, for paths and photons."
#define THIN_WALLED                                                                                                    \
    { "thin_walled", KIND_BOOLEAN, OPTIONAL | RARE, ANY, NULL, "whether it is open", THIN_WALLED_HELP }
#define MEDIUM                                                                                                         \
    {                                                                                                                  \
        "medium", KIND_MEDIUM, OPTIONAL | RARE, ANY, NULL, "none",                                                     \
            "Fills the solid, instead of a material or behind its surface."                                            \
    }
#define SHAPE(otherwise)                                                                                               \
    [SHAPE_NAME] = {"name", KIND_TEXT, OPTIONAL, ANY, NULL, "'" otherwise "'", NAME_HELP},                             \
    [SHAPE_MATERIAL] = {"material", KIND_MATERIAL, OPTIONAL | GHOST_IS_NONE, ANY, NULL, "plain gray", MATERIAL_HELP},  \
    [SHAPE_THIN_WALLED] = THIN_WALLED, [SHAPE_MEDIUM] = MEDIUM
/* What every shape takes from them. */
static inline enum node_walls walls_of(const struct script_value *thin_walled) {
    return !thin_walled->given ? WALLS_BY_SHAPE : thin_walled->boolean ? WALLS_THIN : WALLS_OF_SOLID;
}
static inline bool set_shape_fields(struct script_context *context, const struct script_value *args, struct node *node,
                                    struct error *error) {
    node->walls = walls_of(&args[SHAPE_THIN_WALLED]);
    return choose_material(context, &args[SHAPE_MATERIAL], &args[SHAPE_MEDIUM], &node->material, error);
}

#endif
