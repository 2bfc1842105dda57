/* Gives Lua the project's elementary functions.
 *
 * Lua's library and its ^ operator call libm, whose last bits differ between processors; scene scripts place things
 * with them, so pictures would differ too. Symbols defined by the executable come before those of shared libraries (ELF
 * interposition; System V ABI, "Shared Object Dependencies"), and before archive members when Lua is linked statically:
 * either way Lua finds these.
 *
 * Covered is every inexact libm function that Lua 5.4 refers to in any configuration (compatibility functions
 * included); floor, ceil, sqrt, fmod, frexp and ldexp are exact and stay the library's. Compile with -fno-builtin, so
 * that the compiler does not take these definitions for the functions it knows. Arguments and results as in <math.h>,
 * except that errno is left alone. */
#include "math/elementary.h"

/* Not <math.h>: its declarations carry attributes that these definitions need not have. */
#define LIBM_ONE(name)                                                                                                 \
    __attribute__((visibility("default"))) double name(double x);                                                      \
    double name(double x) {                                                                                            \
        return el_##name(x);                                                                                           \
    }
#define LIBM_TWO(name)                                                                                                 \
    __attribute__((visibility("default"))) double name(double x, double y);                                            \
    double name(double x, double y) {                                                                                  \
        return el_##name(x, y);                                                                                        \
    }

LIBM_ONE(sin)
LIBM_ONE(cos)
LIBM_ONE(tan)
LIBM_ONE(asin)
LIBM_ONE(acos)
LIBM_ONE(atan)
LIBM_TWO(atan2)
LIBM_ONE(exp)
LIBM_ONE(exp2)
LIBM_ONE(log)
LIBM_ONE(log2)
LIBM_ONE(log10)
LIBM_TWO(pow)
LIBM_ONE(sinh)
LIBM_ONE(cosh)
LIBM_ONE(tanh)
