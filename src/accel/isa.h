/* Which instruction set the kernels use: the best the processor has, unless pinned. The answers do not depend on it. */
#ifndef GRAY_ACCEL_ISA_H
#define GRAY_ACCEL_ISA_H

#include "base/list.h"

#include <stdbool.h>

#define ACCEL_ISAS(X)                                                                                                  \
    X(ACCEL_ISA_BASE, "base")                                                                                          \
    X(ACCEL_ISA_AVX2, "avx2")                                                                                          \
    X(ACCEL_ISA_AVX512, "avx512")
enum accel_isa { ACCEL_ISAS(LIST_MEMBER) };

/* "auto", "base", "avx2" or "avx512"; false when the name is unknown or the processor lacks it (nothing changes then).
 * Call before the first search and from one thread. */
bool accel_select_isa(const char *name);
const char *accel_isa_name(void);
/* Written by accel_select_isa alone. */
extern enum accel_isa accel_isa_chosen;
static inline enum accel_isa accel_isa(void) {
    return accel_isa_chosen;
}

#endif
