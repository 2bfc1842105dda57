/* Allocation with failures on demand (base/fault.h) and with a limit.
 *
 * The expected size of a block is added to the account before malloc is called; the real size corrects the number
 * afterwards. So threads that allocate at the same time cannot exceed the limit together. The charged account belongs
 * to the process and not to a thread or a caller: libraries allocate through hooks that know neither. */
#include "base/mem.h"

#include "base/checked.h"
#include "base/fault.h"

#include <malloc.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* The charged account, or NULL. */
static _Atomic(struct mem_account *) charged;

struct mem_account *mem_charge(struct mem_account *account) {
    return atomic_exchange(&charged, account);
}

static struct mem_account *account_in_charge(void) {
    return atomic_load_explicit(&charged, memory_order_acquire);
}

uint64_t mem_refusals(void) {
    struct mem_account *account = account_in_charge();
    return account ? atomic_load(&account->refusals) : 0;
}

const struct mem_account *mem_charged(void) {
    return account_in_charge();
}

/* The memory that malloc uses for a block of this size: a header, rounded up to multiples of 16, at least 32 (glibc's
 * layout). */
static uint64_t block_cost(size_t size) {
    uint64_t whole = ((uint64_t)size + 8 + 15) & ~UINT64_C(15);
    return size > SIZE_MAX / 2 ? size : whole < 32 ? 32 : whole;
}

static uint64_t block_held(void *block) {
    return block ? malloc_usable_size(block) + 8 : 0;
}

static void account_add(struct mem_account *account, uint64_t more, uint64_t less) {
    (void)atomic_fetch_add_explicit(&account->held, (int64_t)(more - less), memory_order_relaxed);
}

/* False: refused and not counted. */
static bool account_take(struct mem_account *account, uint64_t size) {
    if (size <= account->limit) {
        int64_t held = atomic_fetch_add_explicit(&account->held, (int64_t)size, memory_order_relaxed);
        if (held <= (int64_t)(account->limit - size))
            return true;
        account_add(account, 0, size);
    }
    (void)atomic_fetch_add(&account->refusals, 1);
    return false;
}

bool mem_reserve(uint64_t size) {
    struct mem_account *account = account_in_charge();
    return !account || account_take(account, size);
}

void mem_unreserve(uint64_t size) {
    struct mem_account *account = account_in_charge();
    if (account)
        account_add(account, 0, size);
}

#ifdef GRAY_FAULTS
/* Bytes in blocks now, and their maximum since mem_peak_begin; counted only in builds with fault injection, for
 * tests. */
static _Atomic uint64_t bytes_held, bytes_max;

static void *taken(void *block) {
    uint64_t held = atomic_fetch_add(&bytes_held, block ? malloc_usable_size(block) : 0);
    uint64_t now = held + (block ? malloc_usable_size(block) : 0), max = atomic_load(&bytes_max);
    while (now > max && !atomic_compare_exchange_weak(&bytes_max, &max, now))
        continue;
    return block;
}

static void given_back(void *block) {
    if (block)
        atomic_fetch_sub(&bytes_held, malloc_usable_size(block));
}

uint64_t mem_peak_begin(void) {
    uint64_t held = atomic_load(&bytes_held);
    atomic_store(&bytes_max, held);
    return held;
}

uint64_t mem_peak(void) {
    return atomic_load(&bytes_max);
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

/* A new block for which account_take has counted `cost`. */
static void *account_new(struct mem_account *account, void *block, uint64_t cost) {
    if (account)
        account_add(account, block_held(block), cost);
    return taken(block);
}

void *mem_alloc(size_t size) {
    struct mem_account *account = account_in_charge();
    uint64_t cost = block_cost(size);
    if (allocation_fails() || (account && !account_take(account, cost)))
        return NULL;
    return account_new(account, malloc(size ? size : 1), cost);
}

void *mem_alloc_zero(size_t count, size_t size) {
    struct mem_account *account = account_in_charge();
    size_t bytes;
    if (allocation_fails() || !checked_mul(count, size, &bytes))
        return NULL;
    uint64_t cost = block_cost(bytes);
    if (account && !account_take(account, cost))
        return NULL;
    return account_new(account, calloc(1, bytes ? bytes : 1), cost);
}

void *mem_alloc_aligned(size_t alignment, size_t size) {
    struct mem_account *account = account_in_charge();
    uint64_t cost = block_cost(size);
    void *block = NULL;
    if (allocation_fails() || (account && !account_take(account, cost)))
        return NULL;
    if (posix_memalign(&block, alignment, size ? size : 1) != 0)
        block = NULL;
#ifdef MADV_HUGEPAGE
    if (block && alignment >= MEM_LARGE_PAGE)
        (void)madvise(block, size, MADV_HUGEPAGE);
#endif
    return account_new(account, block, cost);
}

void *mem_resize(void *block, size_t size) {
    struct mem_account *account = account_in_charge();
    uint64_t before = account ? block_held(block) : 0, cost = block_cost(size);
    if (allocation_fails() || (account && cost > before && !account_take(account, cost - before)))
        return NULL;
    given_back(block);
    void *resized = realloc(block, size ? size : 1);
    (void)taken(resized ? resized : block);
    if (account)
        account_add(account, resized ? block_held(resized) : before, cost > before ? cost : before);
    return resized;
}

/* Without atomic additions; false: refused and not counted. */
static bool account_change(struct mem_account *account, int64_t more) {
    int64_t held = atomic_load_explicit(&account->held, memory_order_relaxed) + more;
    if (more > 0 && held > (int64_t)account->limit) {
        (void)atomic_fetch_add(&account->refusals, 1);
        return false;
    }
    atomic_store_explicit(&account->held, held, memory_order_relaxed);
    return true;
}

void *mem_resize_known(void *block, size_t old_size, size_t size) {
    struct mem_account *account = account_in_charge();
    if (size > SIZE_MAX / 2 || (size > 0 && allocation_fails()))
        return NULL;
    int64_t more = (int64_t)(size > 0 ? block_cost(size) : 0) - (int64_t)(block ? block_cost(old_size) : 0);
    if (account && !account_change(account, more))
        return NULL;
    given_back(block);
    if (size == 0) {
        free(block);
        return NULL;
    }
    void *resized = realloc(block, size);
    (void)taken(resized ? resized : block);
    if (account && !resized)
        account_add(account, 0, (uint64_t)more);
    return resized;
}

void *mem_resize_array(void *block, size_t count, size_t size) {
    size_t bytes;
    return checked_mul(count, size, &bytes) ? mem_resize(block, bytes) : NULL;
}

void mem_free(void *block) {
    struct mem_account *account = account_in_charge();
    if (account)
        account_add(account, 0, block_held(block));
    given_back(block);
    free(block);
}

/* Otherwise glibc keeps blocks of up to 32 MiB in its heap once one of them was freed, and holes between growing lists
 * there count in no account: a tenth more than the blocks. */
void mem_return_large(void) {
#ifdef M_MMAP_THRESHOLD
    enum { LARGE = 1 << 20 };
    (void)mallopt(M_MMAP_THRESHOLD, LARGE);
    (void)mallopt(M_TRIM_THRESHOLD, LARGE);
#endif
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
