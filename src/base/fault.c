/* The number of a failure counts over all processes of a run, so the counters are in memory that they share. */
#include "base/fault.h"

#ifdef GRAY_FAULTS
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

/* The counters are in a page that the processes of one run share; it exists before the first allocation. */
struct fault_counters {
    _Atomic uint64_t count[2], failing[2];
    _Atomic int error;
    uint64_t acting; /* of calls; 0: none */
    void (*interfere)(void);
    pid_t first; /* the process that reports the counts */
};

static struct fault_counters own, *counters = &own;

void fault_apart(void) {
    void *page = mmap(NULL, sizeof own, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page != MAP_FAILED)
        counters = page;
    atomic_store(&counters->error, EIO);
    counters->first = getpid();
}

__attribute__((constructor)) static void read_environment(void) {
    static const char *const names[] = {"GRAY_FAIL_ALLOC", "GRAY_FAIL_CALL"};
    fault_apart();
    for (int kind = 0; kind < 2; kind++) {
        const char *text = getenv(names[kind]);
        if (text)
            fault_at((enum fault_kind)kind, strtoull(text, NULL, 10));
    }
    const char *number = getenv("GRAY_FAIL_ERRNO");
    (void)fault_errno(number ? atoi(number) : 0);
}

__attribute__((destructor)) static void report_counts(void) {
    const char *path = getenv("GRAY_FAULT_COUNT");
    if (!path || counters->first != getpid())
        return;
    FILE *stream = fopen(path, "w");
    if (!stream)
        return;
    (void)fprintf(stream, "%llu %llu\n", (unsigned long long)counters->count[0],
                  (unsigned long long)counters->count[1]);
    (void)fclose(stream);
}

bool fault_now(enum fault_kind kind) {
    uint64_t number = atomic_fetch_add(&counters->count[kind], 1) + 1;
    if (kind == FAULT_OF_CALL && number == counters->acting)
        counters->interfere();
    return number == atomic_load(&counters->failing[kind]);
}

void fault_before(uint64_t number, void (*interfere)(void)) {
    counters->interfere = interfere;
    counters->acting = atomic_load(&counters->count[FAULT_OF_CALL]) + number;
}

void fault_at(enum fault_kind kind, uint64_t number) {
    atomic_store(&counters->failing[kind], number == 0 ? 0 : atomic_load(&counters->count[kind]) + number);
}

int fault_errno(int number) {
    return number == 0 ? atomic_load(&counters->error) : atomic_exchange(&counters->error, number);
}

uint64_t fault_count(enum fault_kind kind) {
    return atomic_load(&counters->count[kind]);
}
#endif
