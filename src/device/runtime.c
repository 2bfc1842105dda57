/* What a ray calls that a card does not have; compiled for cards alone (tools/device_scan.sh). */
#include "base/mem.h"
#include "base/pool.h"

#ifdef GRAY_DEVICE

/* A launch is too short to be ended. */
bool pool_cancelled(const struct pool *pool) {
    return (void)pool, false;
}

/* Memory does not grow: world_scratch.failed is set, and a processor does that pixel. */
void *mem_resize_array(void *memory, size_t count, size_t size) {
    return (void)memory, (void)count, (void)size, NULL;
}

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
uint32_t __atomic_fetch_add_4(volatile void *at, uint32_t more, int order) {
    return (void)order, (uint32_t)__nvvm_atom_add_gen_i((int *)at, (int)more);
}
uint64_t __atomic_fetch_add_8(volatile void *at, uint64_t more, int order) {
    return (void)order, (uint64_t)__nvvm_atom_add_gen_ll((long long *)at, (long long)more);
}
bool __atomic_compare_exchange_8(volatile void *at, void *expected, uint64_t wanted, int order, int order_else) {
    uint64_t *own = expected, before = *own;
    (void)order, (void)order_else;
    *own = (uint64_t)__nvvm_atom_cas_gen_ll((long long *)at, (long long)before, (long long)wanted);
    return *own == before;
}
/* Of the flags of faults: by one thread, when the others are done. */
uint8_t __atomic_exchange_1(volatile void *at, uint8_t value, int order) {
    const uint8_t before = *(volatile uint8_t *)at;
    (void)order;
    *(volatile uint8_t *)at = value;
    return before;
}
void __atomic_store_1(volatile void *at, uint8_t value, int order) {
    (void)order;
    *(volatile uint8_t *)at = value;
}
#endif

#endif
