/* The processor's instruction set is queried once, when the program starts. */
#include "base/isa.h"

#include <string.h>

enum cpu_isa cpu_isa_chosen;

static bool has_avx2(void) {
#if CPU_ISA_CHOICE
    __builtin_cpu_init();
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    return false;
#endif
}

static bool has_avx512(void) {
#if CPU_ISA_CHOICE
    return has_avx2() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
#else
    return false;
#endif
}

static __attribute__((constructor)) void choose_at_start(void) {
    cpu_isa_chosen = has_avx512() ? CPU_ISA_AVX512 : has_avx2() ? CPU_ISA_AVX2 : CPU_ISA_BASE;
}

bool cpu_select_isa(const char *name) {
    if (strcmp(name, "auto") == 0)
        choose_at_start();
    else if (strcmp(name, "base") == 0)
        cpu_isa_chosen = CPU_ISA_BASE;
    else if (strcmp(name, "avx2") == 0 && has_avx2())
        cpu_isa_chosen = CPU_ISA_AVX2;
    else if (strcmp(name, "avx512") == 0 && has_avx512())
        cpu_isa_chosen = CPU_ISA_AVX512;
    else
        return false;
    return true;
}
