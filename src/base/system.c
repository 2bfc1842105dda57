/* The state of a process is that of its threads: /proc/PID/task/TID/stat has a letter for each. */
#define _GNU_SOURCE
#include "base/process.h"
#include "base/fault.h"
#include "base/isa.h"
#include "base/share.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* The letter, or '\0'. */
static char thread_state(int tasks, const char *thread) {
    char path[64], text[512];
    (void)snprintf(path, sizeof path, "%.32s/stat", thread);
    int file = openat(tasks, path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return '\0';
    ssize_t got = read(file, text, sizeof text - 1);
    (void)close(file);
    text[got > 0 ? got : 0] = '\0';
    const char *end = strrchr(text, ')'); /* the name before it may contain anything */
    return end && end[1] == ' ' ? end[2] : '\0';
}

enum process_state process_state(pid_t pid) {
    char path[64];
    int threads = 0, stopped = 0, running = 0;
    (void)snprintf(path, sizeof path, "/proc/%ld/task", (long)pid);
    DIR *tasks = opendir(path);
    if (!tasks)
        return PROCESS_UNKNOWN;
    for (const struct dirent *entry; (entry = readdir(tasks)) != NULL;) {
        char state = entry->d_name[0] == '.' ? '\0' : thread_state(dirfd(tasks), entry->d_name);
        threads += state != '\0';
        stopped += state == 'T' || state == 't';
        running += state == 'R';
    }
    (void)closedir(tasks);
    if (running > 0)
        return PROCESS_RUNS;
    return threads == 0 ? PROCESS_UNKNOWN : stopped == threads ? PROCESS_STOPPED : PROCESS_WAITS;
}

double process_time(pid_t pid) {
    clockid_t clock;
    struct timespec now;
    if (clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &now) != 0)
        return 0;
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Sharing through memfd: a file without a name in memory. Its pages are allocated when it is created (fallocate), since
 * a missing page would later kill the process that touches it. */

static bool no_memory(struct error *error, size_t size, const char *why) {
    return error_set(error, ERROR_MACHINE, "out of memory: the picture needs %.1f MB: %s", 1e-6 * (double)size, why);
}

/* A size above the machine's memory would not fail in time: the kernel hands out pages until it has to kill a process.
 */
static bool fits_machine(size_t size) {
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    return pages <= 0 || page <= 0 || size / (size_t)page < (size_t)pages;
}

static bool map_block(struct share *share, struct error *error) {
    void *block = fault_now(FAULT_OF_CALL)
                      ? MAP_FAILED
                      : mmap(NULL, share->size, PROT_READ | PROT_WRITE, MAP_SHARED, share->descriptor, 0);
    if (block == MAP_FAILED) {
        no_memory(error, share->size, strerror(errno));
        (void)close(share->descriptor);
        *share = (struct share){0};
        return false;
    }
    /* Shared only through the descriptor, not with processes forked later. */
    (void)madvise(block, share->size, MADV_DONTFORK);
    share->block = block;
    return true;
}

bool share_create(struct share *share, size_t size, struct error *error) {
    *share = (struct share){.size = size ? size : 1};
    if (!fits_machine(share->size))
        return no_memory(error, size, "this machine has less in all");
    share->descriptor = MAY_FAIL(memfd_create("gray-film", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (share->descriptor < 0)
        return error_set(error, ERROR_MACHINE, "the memory of the picture cannot be shared: %s", strerror(errno));
    int failed;
    do {
        failed = MAY_FAIL(fallocate(share->descriptor, 0, 0, (off_t)share->size));
    } while (failed != 0 && errno == EINTR);
    if (failed != 0 || fcntl(share->descriptor, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
        no_memory(error, size, strerror(errno));
        (void)close(share->descriptor);
        return false;
    }
    return map_block(share, error);
}

bool share_attach(struct share *share, int descriptor, size_t size, struct error *error) {
    *share = (struct share){.size = size ? size : 1, .descriptor = descriptor};
    struct stat status;
    if (fstat(descriptor, &status) != 0 || (uint64_t)status.st_size < share->size) {
        (void)close(descriptor);
        return error_set(error, ERROR_MACHINE, "the shared picture has the wrong size");
    }
    return map_block(share, error);
}

void share_destroy(struct share *share) {
    if (!share->block)
        return;
    (void)munmap(share->block, share->size);
    (void)close(share->descriptor);
    *share = (struct share){0};
}

/* The processor's instruction set is queried once, when the program starts. */

enum cpu_isa cpu_isa_chosen;

static bool has_avx2(void) {
#if defined(__x86_64__)
    __builtin_cpu_init();
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    return false;
#endif
}

static bool has_avx512(void) {
#if defined(__x86_64__)
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
