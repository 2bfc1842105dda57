/* Which instruction set the kernels use: the best the processor has, unless pinned. The results do not depend on it. */
#ifndef GRAY_BASE_ISA_H
#define GRAY_BASE_ISA_H

#include "base/list.h"

#include <stdbool.h>

#define CPU_ISAS(X)                                                                                                    \
    X(CPU_ISA_BASE, "base")                                                                                            \
    X(CPU_ISA_AVX2, "avx2")                                                                                            \
    X(CPU_ISA_AVX512, "avx512")
enum cpu_isa { CPU_ISAS(LIST_MEMBER) };

/* Whether there are kernels for more than CPU_ISA_BASE: not for other processors than x86-64, nor for cards. */
#if defined(__x86_64__) && !defined(GRAY_DEVICE)
#define CPU_ISA_CHOICE 1
#else
#define CPU_ISA_CHOICE 0
#endif

/* "auto", "base", "avx2" or "avx512"; false when the name is unknown or the processor lacks it (nothing changes then).
 * Call before the first search and from one thread. */
bool cpu_select_isa(const char *name);
/* Written by cpu_select_isa alone. */
extern enum cpu_isa cpu_isa_chosen;
static inline enum cpu_isa cpu_isa(void) {
    return CPU_ISA_CHOICE ? cpu_isa_chosen : CPU_ISA_BASE;
}

/* Calls the kernel of the instruction set: name_base, name_avx2 or name_avx512. */
#if CPU_ISA_CHOICE
#define CPU_ISA_CALL(name, ...)                                                                                        \
    switch (cpu_isa()) {                                                                                               \
    case CPU_ISA_BASE:                                                                                                 \
        name##_base(__VA_ARGS__);                                                                                      \
        break;                                                                                                         \
    case CPU_ISA_AVX2:                                                                                                 \
        name##_avx2(__VA_ARGS__);                                                                                      \
        break;                                                                                                         \
    case CPU_ISA_AVX512:                                                                                               \
        name##_avx512(__VA_ARGS__);                                                                                    \
        break;                                                                                                         \
    }
#else
#define CPU_ISA_CALL(name, ...) name##_base(__VA_ARGS__);
#endif

#endif
