/* What the compiler calls where a card has no instruction; compiled for cards alone (tools/device_scan.sh). */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

int memcmp(const void *a, const void *b, size_t size) {
    const uint8_t *x = a, *y = b;
    for (; size > 0; size--, x++, y++)
        if (*x != *y)
            return *x < *y ? -1 : 1;
    return 0;
}

#ifdef __NVPTX__
uint64_t __atomic_load_8(const volatile void *from, int order) {
    return (void)order, *(const volatile uint64_t *)from;
}
uint32_t __atomic_load_4(const volatile void *from, int order) {
    return (void)order, *(const volatile uint32_t *)from;
}
void __atomic_store_4(volatile void *to, uint32_t value, int order) {
    (void)order, *(volatile uint32_t *)to = value;
}
bool __atomic_compare_exchange_8(volatile void *at, void *expected, uint64_t wanted, int order, int order_else) {
    uint64_t *own = expected, before = *own;
    (void)order, (void)order_else;
    *own = (uint64_t)__nvvm_atom_cas_gen_ll((long long *)at, (long long)before, (long long)wanted);
    return *own == before;
}
bool __atomic_compare_exchange_4(volatile void *at, void *expected, uint32_t wanted, int order, int order_else) {
    uint32_t *own = expected, before = *own;
    (void)order, (void)order_else;
    *own = (uint32_t)__nvvm_atom_cas_gen_i((int *)at, (int)before, (int)wanted);
    return *own == before;
}
#endif
