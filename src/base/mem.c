/* Allocation with failures on demand (base/fault.h). */
#include "base/mem.h"

#include "base/checked.h"
#include "base/fault.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

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
