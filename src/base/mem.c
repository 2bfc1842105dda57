/* Allocation with failures on demand. The fault counter is the one piece of state: it exists only in builds with
 * GRAY_FAULTS, where tests run the program once for every allocation it makes. */
#include "base/mem.h"

#include "base/checked.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#ifdef GRAY_FAULTS
#include <stdatomic.h>

static _Atomic uint64_t allocation_count;
static _Atomic uint64_t failing_allocation;

__attribute__((constructor)) static void read_environment(void) {
    const char *text = getenv("GRAY_FAIL_ALLOC");
    if (text)
        mem_fail_at(strtoull(text, NULL, 10));
}

static bool allocation_fails(void) {
    uint64_t number = atomic_fetch_add(&allocation_count, 1) + 1;
    return number == atomic_load(&failing_allocation);
}

void mem_fail_at(uint64_t number) {
    atomic_store(&failing_allocation, number == 0 ? 0 : atomic_load(&allocation_count) + number);
}

uint64_t mem_allocations(void) {
    return atomic_load(&allocation_count);
}
#else
static bool allocation_fails(void) {
    return false;
}

void mem_fail_at(uint64_t number) {
    (void)number;
}

uint64_t mem_allocations(void) {
    return 0;
}
#endif

void *mem_alloc(size_t size) {
    return allocation_fails() ? NULL : malloc(size ? size : 1);
}

void *mem_alloc_zero(size_t count, size_t size) {
    if (allocation_fails())
        return NULL;
    return count && size ? calloc(count, size) : calloc(1, 1);
}

void *mem_alloc_aligned(size_t alignment, size_t size) {
    void *block = NULL;
    if (allocation_fails() || posix_memalign(&block, alignment, size ? size : 1) != 0)
        return NULL;
#ifdef MADV_HUGEPAGE
    if (alignment >= MEM_LARGE_PAGE)
        (void)madvise(block, size, MADV_HUGEPAGE);
#endif
    return block;
}

void *mem_resize(void *block, size_t size) {
    return allocation_fails() ? NULL : realloc(block, size ? size : 1);
}

void *mem_resize_array(void *block, size_t count, size_t size) {
    size_t bytes;
    return checked_mul(count, size, &bytes) ? mem_resize(block, bytes) : NULL;
}

void mem_free(void *block) {
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
