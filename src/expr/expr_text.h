/* Programs as text, and back. Each value has a number, in the order in which they are made:
 *
 *     v0 = p.x; v1 = multiply v0 0.5; v2 = sin v1; result v2
 *
 * The operations and inputs have the names of expr_operations.h and expr_graph.h, the types of operands are theirs.
 * Truth values are `true` and `false`, the third operand of texel is image2.0: the second picture, its red channel.
 * A loop gives numbers to its step and its states, and `next` to the states after it:
 *
 *     loop v3 1 20 while float v0 integer 7; v6 = add v4 0.5; next v7 v6 v5
 *
 * is the steps 1 to 20 (`all` in the place of `while`: the first state does not end it), with v3 as the step, v4 and v5
 * as the states, and v7 and v8 as those after the loop. */
#ifndef GRAY_EXPR_EXPR_TEXT_H
#define GRAY_EXPR_EXPR_TEXT_H

#include "base/document.h"
#include "expr/expr_program.h"

/* The pictures of a program. */
enum { EXPR_IMAGES = 4 };
struct expr_images {
    const struct image_function *items[EXPR_IMAGES];
    int count;
};

/* Adds the text, and fills in its pictures. Errors: no memory, or too many pictures. */
bool expr_write_text(const struct expr_program *program, struct document *out, struct expr_images *images,
                     struct error *error);
/* Compiles a text. Any text is allowed: it gives a program that ends, or an error. */
bool expr_read_text(const char *text, const struct expr_images *images, struct arena *arena,
                    struct expr_program *program, struct error *error);

#endif
