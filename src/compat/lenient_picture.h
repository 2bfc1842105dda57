/* What takes the place of a missing mesh, picture, camera or root with --lenient. */
#ifndef GRAY_COMPAT_LENIENT_PICTURE_H
#define GRAY_COMPAT_LENIENT_PICTURE_H

#include "call/context.h"

struct camera;

/* A unit cube in place of a missing mesh. */
struct node *lenient_placeholder(struct script_context *context, const char *name, const struct material *material,
                                 struct error *error);
/* A checker pattern in place of a missing picture: 4 x 3 squares, so that it can also be a sky. */
struct image *lenient_checks(struct script_context *context, struct error *error);
/* Makes scenes out of which no world can be built into ones that can be shown: combined solids of open or moving
 * operands become groups, the first operand alone for a difference. */
void lenient_simplify(struct script_context *context);
/* A camera that shows everything below the node. */
void lenient_camera(const struct node *root, struct camera *camera);
/* The root of a picture if the script names none, or NULL. */
struct node *lenient_root(struct script_context *context);

#endif
