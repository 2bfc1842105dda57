/* The only place that allocates. Every block comes from here, Lua's and libpng's included, so that a test build can
 * make allocation number k fail (environment variable GRAY_FAIL_ALLOC=k, builds with -DGRAY_FAULTS only). Sizes are in
 * bytes. Nothing here aborts: NULL means "no memory" and the caller reports it. Thread-safe. */
#ifndef GRAY_BASE_MEM_H
#define GRAY_BASE_MEM_H

#include <stddef.h>
#include <stdint.h>

void *mem_alloc(size_t size);                           /* uninitialised; a size of 0 gives a valid block */
void *mem_alloc_zero(size_t count, size_t size);        /* count * size zeroed bytes; NULL on overflow too */
void *mem_alloc_aligned(size_t alignment, size_t size); /* released with mem_free; alignment a power of two >= 8 */
/* An alignment of MEM_LARGE_PAGE or more also asks the system for large pages. */
#define MEM_LARGE_PAGE ((size_t)1 << 21)
void *mem_resize(void *block, size_t size);                     /* as realloc: the old block survives a failure */
void *mem_resize_array(void *block, size_t count, size_t size); /* the same with the product checked */
void mem_free(void *block);                                     /* NULL is fine */

/* Zeroed memory shared with child processes forked later. The film lives in such a block. */
void *mem_share(size_t size);
void mem_unshare(void *block, size_t size);

/* Fault injection: from now on allocation number `number` (1 is the next) fails once; 0 turns it off. A no-op in builds
 * without GRAY_FAULTS. mem_allocations counts the allocations asked for so far (0 without GRAY_FAULTS). */
void mem_fail_at(uint64_t number);
uint64_t mem_allocations(void);

#endif
