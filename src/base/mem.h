/* The only place that allocates. Every block comes from here, Lua's and libpng's included, so that a test build can
 * make allocation number k fail (environment variable GRAY_FAIL_ALLOC=k, builds with -DGRAY_FAULTS only). Sizes are in
 * bytes. Nothing here aborts: NULL means "no memory" and the caller reports it. Thread-safe. */
#ifndef GRAY_BASE_MEM_H
#define GRAY_BASE_MEM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

void *mem_alloc(size_t size);                           /* uninitialised; a size of 0 gives a valid block */
void *mem_alloc_zero(size_t count, size_t size);        /* count * size zeroed bytes; NULL on overflow too */
void *mem_alloc_aligned(size_t alignment, size_t size); /* released with mem_free; alignment a power of two >= 8 */
/* An alignment of MEM_LARGE_PAGE or more also requests large pages from the system. */
#define MEM_LARGE_PAGE ((size_t)1 << 21)
void *mem_resize(void *block, size_t size);                     /* as realloc: the old block survives a failure */
void *mem_resize_array(void *block, size_t count, size_t size); /* the same with the product checked */
void mem_free(void *block);                                     /* NULL is fine */
/* A cheaper mem_resize, or mem_free with a size of 0, for a caller that knows the old size (0 for NULL) and is the only
 * thread that allocates while its account is charged. Its blocks must use only this function. */
void *mem_resize_known(void *block, size_t old_size, size_t size);

/* A limit on the memory of this process. While an account is charged, every block that is allocated, resized or
 * freed counts in it, whatever thread or library the call comes from; requests beyond the limit are refused, as if
 * there were no memory. Owner: the caller, who keeps it while it is charged. */
struct mem_account {
    uint64_t limit;            /* bytes; above 0 */
    const char *option;        /* that sets it, for errors */
    const char *words;         /* the whole reason, as in "the script used up its memory of 64 MiB" */
    _Atomic int64_t held;      /* bytes, rounded like malloc does; below 0 if older blocks were freed */
    _Atomic uint64_t refusals; /* requests beyond the limit */
};
/* Charges this account from now on; NULL: none. Returns the previous one. No other thread may allocate meanwhile. */
struct mem_account *mem_charge(struct mem_account *account);
/* How often the charged account has refused memory; 0 without one. */
uint64_t mem_refusals(void);
const struct mem_account *mem_charged(void); /* the charged account, or NULL */
/* Counts memory from elsewhere: a library's own, a film. False: refused. */
bool mem_reserve(uint64_t size);
void mem_unreserve(uint64_t size);

/* For a process with limits: from now on freed large blocks return to the system at once. */
void mem_return_large(void);

/* Zeroed memory shared with child processes forked later. */
void *mem_share(size_t size);
void mem_unshare(void *block, size_t size);

/* Fault injection: from now on allocation number `number` (1 is the next) fails once; 0 turns it off. A no-op in builds
 * without GRAY_FAULTS. mem_allocations counts the requested allocations so far (0 without GRAY_FAULTS). */
void mem_fail_at(uint64_t number);
uint64_t mem_allocations(void);
/* For tests, bytes of all blocks together: now, from where the peak is counted from now on, and at most since then. 0
 * in builds without GRAY_FAULTS. A block that is resized counts once. */
uint64_t mem_peak_begin(void);
uint64_t mem_peak(void);

#endif
