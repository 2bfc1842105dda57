/* Where recorded functions are used, and comparisons with Lua there. */
#ifndef GRAY_RECORD_RECORD_BOUNDS_H
#define GRAY_RECORD_RECORD_BOUNDS_H

#include "record/record.h"
#include "scene/node.h"

/* Stores the function at an absolute index. Raises an error: no memory. */
void record_remember(struct sandbox *sandbox, int index, const struct expr_program *program, enum record_domain domain);
/* Registers that a recorded function is used within these bounds of p. It is compared with Lua there before the next
 * picture. For any other program this does nothing. */
void record_use(struct sandbox *sandbox, const struct expr_program *program, const struct box *bounds);
/* Adds the bounds of the shapes at and below the node to the functions of their materials, and compares every function
 * whose bounds have grown. False: one differs from Lua. */
bool record_check(struct sandbox *sandbox, const struct scene *scene, const struct node *root, struct error *error);

#endif
