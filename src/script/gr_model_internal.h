/* What the nodes of model files have besides their shapes: cameras and lights. */
#ifndef GRAY_SCRIPT_GR_MODEL_INTERNAL_H
#define GRAY_SCRIPT_GR_MODEL_INTERNAL_H

#include "call/context.h"
#include "formats/model.h"

struct script;

/* Models of the command line have y up, as the sky and the studio: a model with z up is turned. */
struct transform models_turn(const struct script_context *context);
/* Remembers that the node was made from the model, and turns a model of the command line so that y is up. */
bool models_note(struct script_context *context, struct node *node, const struct model *model, struct error *error);
/* node.cameras and node.lights: pushes the table; false: the name is another one, or the node is of no file. */
bool models_push_field(lua_State *L, const struct node *node, const char *name);
/* The model that a node was made from, or NULL. */
const struct model *models_find(const struct script_context *context, const struct node *node);
/* About the light, as the colour of a white surface that faces all of it, at a point that is at least so near to lights
 * with a position. In the coordinates of the file. */
double models_light_at(const struct model *model, struct vec3 point, double near);
/* One notice for each file that has cameras or lights which the script has not looked at. */
void models_report_unused(const struct script *script);

#endif
