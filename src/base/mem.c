/* Allocation with failures on demand (base/fault.h). */
#include "base/mem.h"

#include "base/checked.h"
#include "base/fault.h"
#include "base/mem_peak.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#ifdef GRAY_FAULTS
#include <malloc.h>
#include <stdatomic.h>

/* What blocks hold now, and at most since mem_peak_begin; only builds that inject faults count, and only tests read. */
static _Atomic uint64_t bytes_held, bytes_most;

static void *taken(void *block) {
    uint64_t held = atomic_fetch_add(&bytes_held, block ? malloc_usable_size(block) : 0);
    uint64_t now = held + (block ? malloc_usable_size(block) : 0), most = atomic_load(&bytes_most);
    while (now > most && !atomic_compare_exchange_weak(&bytes_most, &most, now))
        continue;
    return block;
}

static void given_back(void *block) {
    if (block)
        atomic_fetch_sub(&bytes_held, malloc_usable_size(block));
}

uint64_t mem_peak_begin(void) {
    uint64_t held = atomic_load(&bytes_held);
    atomic_store(&bytes_most, held);
    return held;
}

uint64_t mem_peak(void) {
    return atomic_load(&bytes_most);
}
#else
static void *taken(void *block) {
    return block;
}

static void given_back(const void *block) {
    (void)block;
}

uint64_t mem_peak_begin(void) {
    return 0;
}

uint64_t mem_peak(void) {
    return 0;
}
#endif

static bool allocation_fails(void) {
    return fault_now(FAULT_OF_ALLOCATION);
}

void mem_fail_at(uint64_t number) {
    fault_at(FAULT_OF_ALLOCATION, number);
}

uint64_t mem_allocations(void) {
    return fault_count(FAULT_OF_ALLOCATION);
}

void *mem_alloc(size_t size) {
    return allocation_fails() ? NULL : taken(malloc(size ? size : 1));
}

void *mem_alloc_zero(size_t count, size_t size) {
    if (allocation_fails())
        return NULL;
    return taken(count && size ? calloc(count, size) : calloc(1, 1));
}

void *mem_alloc_aligned(size_t alignment, size_t size) {
    void *block = NULL;
    if (allocation_fails() || posix_memalign(&block, alignment, size ? size : 1) != 0)
        return NULL;
#ifdef MADV_HUGEPAGE
    if (alignment >= MEM_LARGE_PAGE)
        (void)madvise(block, size, MADV_HUGEPAGE);
#endif
    return taken(block);
}

void *mem_resize(void *block, size_t size) {
    if (allocation_fails())
        return NULL;
    given_back(block);
    void *resized = realloc(block, size ? size : 1);
    (void)taken(resized ? resized : block);
    return resized;
}

void *mem_resize_array(void *block, size_t count, size_t size) {
    size_t bytes;
    return checked_mul(count, size, &bytes) ? mem_resize(block, bytes) : NULL;
}

void mem_free(void *block) {
    given_back(block);
    free(block);
}

void *mem_share(size_t size) {
    if (allocation_fails())
        return NULL;
    void *block = mmap(NULL, size ? size : 1, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return block == MAP_FAILED ? NULL : block;
}

void mem_unshare(void *block, size_t size) {
    if (block)
        (void)munmap(block, size ? size : 1);
}
