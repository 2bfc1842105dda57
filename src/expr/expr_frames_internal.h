/* Loops of programs, and loops in them, without recursion. An evaluator has a frame for the program that it evaluates
 * and one for each loop that it is in, the innermost last. */
#ifndef GRAY_EXPR_EXPR_FRAMES_INTERNAL_H
#define GRAY_EXPR_EXPR_FRAMES_INTERNAL_H

#include "expr/expr_program.h"

enum { EXPR_FRAMES = EXPR_DEPTH + 1 };

/* Defines name_run(frames): evaluates frames[0] to its end. A struct name_frame has the members `loop`, NULL for a
 * program that is no body of a loop, and `in`, the next instruction. Of a frame f
 *     name_continue(f)      runs the instructions up to the next EXPR_LOOP, which it returns, or to the end: NULL,
 *     name_begin_loop(f, g) makes the frame g of the loop that starts at f->in,
 *     name_begin_step(f)    prepares the next step; false: the loop has ended,
 *     name_end_step(f)      writes the states after a step. */
#define EXPR_DEFINE_RUN(name)                                                                                          \
    static void name##_run(struct name##_frame frames[EXPR_FRAMES]) {                                                  \
        struct name##_frame *f = frames;                                                                               \
        for (;;) {                                                                                                     \
            /* To the end of the program, or into a loop. */                                                           \
            f->in = name##_continue(f);                                                                                \
            if (f->in) {                                                                                               \
                name##_begin_loop(f, f + 1);                                                                           \
                f++;                                                                                                   \
            } else if (f->loop) {                                                                                      \
                name##_end_step(f);                                                                                    \
            }                                                                                                          \
            /* A step of it, or what follows it. */                                                                    \
            if (f->loop && name##_begin_step(f))                                                                       \
                continue;                                                                                              \
            if (f == frames)                                                                                           \
                return;                                                                                                \
            f--;                                                                                                       \
            f->in++;                                                                                                   \
        }                                                                                                              \
    }

#endif
