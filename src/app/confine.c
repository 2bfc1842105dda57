/* Landlock (linux/landlock.h, since Linux 5.13): a list of folders with what may be done below each; everything else is
 * refused by the kernel wherever a path leads. Seccomp (man 2 seccomp): a filter in classic BPF over the number and the
 * first arguments of each system call, read from the table below: what is not listed does not exist (ENOSYS), so a C
 * library that tries something newer falls back; what only an attack would call ends the process.
 *
 * The sanitizers need ptrace, personality and more of /proc than this leaves, so their builds run without the filter.
 */
#define _GNU_SOURCE
#include "app/confine.h"

#include "base/fault.h"
#include "base/file.h"
#include "base/reach.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
#define SANITIZED 1
#elif defined __has_feature
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SANITIZED 1
#endif
#endif
#ifndef SANITIZED
#define SANITIZED 0
#endif

#if defined __x86_64__
#define AUDIT_ARCH_HERE AUDIT_ARCH_X86_64
#elif defined __aarch64__
#define AUDIT_ARCH_HERE AUDIT_ARCH_AARCH64
#endif

/* Names that the headers of the build machine may not know yet; values as in linux/landlock.h. */
#ifndef LANDLOCK_ACCESS_FS_REFER
#define LANDLOCK_ACCESS_FS_REFER (1ULL << 13)
#endif
#ifndef LANDLOCK_ACCESS_FS_TRUNCATE
#define LANDLOCK_ACCESS_FS_TRUNCATE (1ULL << 14)
#endif
enum { SCOPE_ABSTRACT_SOCKET = 1, SCOPE_SIGNAL = 2, NET_BIND = 1, NET_CONNECT = 2 };

/* struct landlock_ruleset_attr in its newest form: older kernels take its beginning. */
struct ruleset {
    uint64_t files, net, scoped;
};

static const uint64_t read_rights = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
static const uint64_t write_rights = LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_MAKE_REG |
                                     LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_REFER |
                                     LANDLOCK_ACCESS_FS_TRUNCATE;

/* All rights over files that a version of the interface knows. */
static uint64_t known_rights(long version) {
    int bits = version >= 5 ? 16 : version >= 3 ? 15 : version >= 2 ? 14 : 13;
    return (UINT64_C(1) << bits) - 1;
}

static bool add_rule(int ruleset, int folder, uint64_t rights) {
    struct landlock_path_beneath_attr rule = {.allowed_access = rights, .parent_fd = folder};
    return MAY_FAIL(syscall(SYS_landlock_add_rule, ruleset, LANDLOCK_RULE_PATH_BENEATH, &rule, 0)) == 0;
}

/* A file or folder that the process itself reads; one that is not there is no loss. */
static bool add_path(int ruleset, const char *path, uint64_t rights) {
    int descriptor = file_open_place(path);
    if (descriptor < 0)
        return true;
    bool added = add_rule(ruleset, descriptor, rights);
    (void)close(descriptor);
    return added;
}

static bool add_rules(int ruleset, const struct options *options, const struct reach *reach, uint64_t known) {
    bool ok = true;
    for (size_t i = 0; i < reach->count; i++) {
        const struct reach_folder *folder = &reach->folders[i];
        uint64_t rights = folder->kind == REACH_WRITE ? read_rights | write_rights : read_rights;
        ok = ok && add_rule(ruleset, folder->descriptor, rights & known);
    }
    /* A scene that is a link to somewhere else. */
    for (int i = 0; i < options->script_count; i++) {
        if (file_is_regular(options->scripts[i]))
            ok = ok && add_path(ruleset, options->scripts[i], LANDLOCK_ACCESS_FS_READ_FILE);
    }
    /* How many processors there are; memory maps for the sanitizers' reports. */
    ok = ok && add_path(ruleset, "/sys/devices/system/cpu", read_rights);
#if SANITIZED
    ok = ok && add_path(ruleset, "/proc", read_rights) && add_path(ruleset, "/usr", read_rights) &&
         add_path(ruleset, "/lib", read_rights) && add_path(ruleset, "/proc/self/exe", LANDLOCK_ACCESS_FS_READ_FILE);
#endif
    return ok;
}

/* Version of the interface that is active; 0 when the kernel has none. -1: error. */
static long confine_files(const struct options *options, const struct reach *reach, long at_most, struct error *error) {
    long version = MAY_FAIL(syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION));
    version = version < at_most ? version : at_most;
    if (version <= 0)
        return 0;
    uint64_t known = known_rights(version);
    struct ruleset wanted = {known, NET_BIND | NET_CONNECT, SCOPE_ABSTRACT_SOCKET | SCOPE_SIGNAL};
    size_t size = version >= 6 ? sizeof wanted : version >= 4 ? 2 * sizeof(uint64_t) : sizeof(uint64_t);
    int ruleset = (int)MAY_FAIL(syscall(SYS_landlock_create_ruleset, &wanted, size, 0));
    bool ok = ruleset >= 0 && add_rules(ruleset, options, reach, known) &&
              MAY_FAIL(syscall(SYS_landlock_restrict_self, ruleset, 0)) == 0;
    int why = errno;
    if (ruleset >= 0)
        (void)close(ruleset);
    if (ok)
        return version;
    error_set(error, ERROR_MACHINE, "gray: the files that scenes may read cannot be limited (Landlock: %s)",
              strerror(why));
    return -1;
}

#ifdef AUDIT_ARCH_HERE
/* What a system call is allowed for. */
enum rule_kind {
    RULE_ALLOW,
    RULE_KILL,    /* only an attack calls it */
    RULE_CLEAR,   /* allowed when the bits `bits` of argument `argument` are all 0 */
    RULE_SET,     /* allowed when the bits are all 1 */
    RULE_EQUAL,   /* allowed when the low half of the argument is `bits` */
    RULE_WRITING, /* allowed when some folder may be written */
    RULE_BENEATH, /* allowed when Landlock is active: its arguments lie in memory */
};

struct rule {
    uint32_t call;
    enum rule_kind kind;
    uint32_t argument, bits;
};

static const uint32_t writing_flags = O_ACCMODE | O_CREAT | O_TRUNC | O_APPEND | (O_TMPFILE & ~O_DIRECTORY);
enum { EXECUTABLE = PROT_EXEC };

static const struct rule rules[] = {
    {SYS_futex, RULE_ALLOW, 0, 0},
    {SYS_clock_gettime, RULE_ALLOW, 0, 0},
    {SYS_read, RULE_ALLOW, 0, 0},
    {SYS_write, RULE_ALLOW, 0, 0},
    {SYS_readv, RULE_ALLOW, 0, 0},
    {SYS_writev, RULE_ALLOW, 0, 0},
    {SYS_pread64, RULE_ALLOW, 0, 0},
    {SYS_sendmsg, RULE_ALLOW, 0, 0},
    {SYS_recvmsg, RULE_ALLOW, 0, 0},
    {SYS_ppoll, RULE_ALLOW, 0, 0},
    {SYS_close, RULE_ALLOW, 0, 0},
    {SYS_lseek, RULE_ALLOW, 0, 0},
    {SYS_fstat, RULE_ALLOW, 0, 0},
    {SYS_newfstatat, RULE_ALLOW, 0, 0},
    {SYS_statx, RULE_ALLOW, 0, 0},
    {SYS_readlinkat, RULE_ALLOW, 0, 0},
    {SYS_faccessat, RULE_ALLOW, 0, 0},
    {SYS_getdents64, RULE_ALLOW, 0, 0},
    {SYS_getcwd, RULE_ALLOW, 0, 0},
    {SYS_dup, RULE_ALLOW, 0, 0},
    {SYS_brk, RULE_ALLOW, 0, 0},
    {SYS_munmap, RULE_ALLOW, 0, 0},
    {SYS_mremap, RULE_ALLOW, 0, 0},
    {SYS_madvise, RULE_ALLOW, 0, 0},
    {SYS_mmap, RULE_CLEAR, 2, EXECUTABLE},
    {SYS_mprotect, RULE_CLEAR, 2, EXECUTABLE},
    {SYS_set_robust_list, RULE_ALLOW, 0, 0},
    {SYS_set_tid_address, RULE_ALLOW, 0, 0},
#ifdef SYS_rseq
    {SYS_rseq, RULE_ALLOW, 0, 0},
#endif
    {SYS_clone, RULE_SET, 0, CLONE_VM | CLONE_THREAD | CLONE_SIGHAND},
    {SYS_sched_yield, RULE_ALLOW, 0, 0},
    {SYS_sched_getaffinity, RULE_ALLOW, 0, 0},
    {SYS_nanosleep, RULE_ALLOW, 0, 0},
    {SYS_clock_nanosleep, RULE_ALLOW, 0, 0},
    {SYS_clock_getres, RULE_ALLOW, 0, 0},
    {SYS_gettimeofday, RULE_ALLOW, 0, 0},
    {SYS_getrandom, RULE_ALLOW, 0, 0},
    {SYS_rt_sigaction, RULE_ALLOW, 0, 0},
    {SYS_rt_sigprocmask, RULE_ALLOW, 0, 0},
    {SYS_rt_sigreturn, RULE_ALLOW, 0, 0},
    {SYS_sigaltstack, RULE_ALLOW, 0, 0},
    {SYS_restart_syscall, RULE_ALLOW, 0, 0},
    {SYS_gettid, RULE_ALLOW, 0, 0},
    {SYS_getpid, RULE_ALLOW, 0, 0},
    {SYS_getppid, RULE_ALLOW, 0, 0},
    {SYS_getuid, RULE_ALLOW, 0, 0},
    {SYS_geteuid, RULE_ALLOW, 0, 0},
    {SYS_getrusage, RULE_ALLOW, 0, 0},
    {SYS_times, RULE_ALLOW, 0, 0},
    {SYS_sysinfo, RULE_ALLOW, 0, 0},
    {SYS_uname, RULE_ALLOW, 0, 0},
    {SYS_exit, RULE_ALLOW, 0, 0},
    {SYS_exit_group, RULE_ALLOW, 0, 0},
    {SYS_openat, RULE_CLEAR, 2, 0},
    {SYS_openat2, RULE_BENEATH, 0, 0},
    {SYS_fcntl, RULE_EQUAL, 1, F_GETFL},
    {SYS_ioctl, RULE_EQUAL, 1, TCGETS},
    {SYS_prlimit64, RULE_EQUAL, 2, 0}, /* asks, does not set */
    {SYS_ftruncate, RULE_WRITING, 0, 0},
    {SYS_fsync, RULE_WRITING, 0, 0},
    {SYS_unlinkat, RULE_WRITING, 0, 0},
    {SYS_renameat, RULE_WRITING, 0, 0},
    {SYS_renameat2, RULE_WRITING, 0, 0},
#ifdef SYS_open /* what newer architectures have left out */
    {SYS_open, RULE_CLEAR, 1, 0},
    {SYS_stat, RULE_ALLOW, 0, 0},
    {SYS_lstat, RULE_ALLOW, 0, 0},
    {SYS_access, RULE_ALLOW, 0, 0},
    {SYS_poll, RULE_ALLOW, 0, 0},
    {SYS_readlink, RULE_ALLOW, 0, 0},
    {SYS_time, RULE_ALLOW, 0, 0},
    {SYS_unlink, RULE_WRITING, 0, 0},
    {SYS_rename, RULE_WRITING, 0, 0},
    {SYS_fork, RULE_KILL, 0, 0},
    {SYS_vfork, RULE_KILL, 0, 0},
#endif
    {SYS_execve, RULE_KILL, 0, 0},
    {SYS_execveat, RULE_KILL, 0, 0},
    {SYS_socket, RULE_KILL, 0, 0},
    {SYS_socketpair, RULE_KILL, 0, 0},
    {SYS_connect, RULE_KILL, 0, 0},
    {SYS_bind, RULE_KILL, 0, 0},
    {SYS_listen, RULE_KILL, 0, 0},
    {SYS_ptrace, RULE_KILL, 0, 0},
    {SYS_process_vm_readv, RULE_KILL, 0, 0},
    {SYS_process_vm_writev, RULE_KILL, 0, 0},
    {SYS_kill, RULE_KILL, 0, 0},
    {SYS_tkill, RULE_KILL, 0, 0},
    {SYS_mount, RULE_KILL, 0, 0},
    {SYS_bpf, RULE_KILL, 0, 0},
    {SYS_setuid, RULE_KILL, 0, 0},
    {SYS_chroot, RULE_KILL, 0, 0},
    {SYS_init_module, RULE_KILL, 0, 0},
    {SYS_keyctl, RULE_KILL, 0, 0},
    {SYS_perf_event_open, RULE_KILL, 0, 0},
    {SYS_unshare, RULE_KILL, 0, 0},
    {SYS_setns, RULE_KILL, 0, 0},
};
enum { RULE_COUNT = sizeof rules / sizeof *rules, STEPS = 16 + 6 * (RULE_COUNT + 1) };

struct program {
    struct sock_filter steps[STEPS];
    unsigned short count;
};

static void put(struct program *program, uint16_t code, uint32_t k, uint8_t yes, uint8_t no) {
    program->steps[program->count++] = (struct sock_filter){code, yes, no, k};
}

static void put_answer(struct program *program, uint32_t what) {
    put(program, BPF_RET | BPF_K, what, 0, 0);
}

/* The low half of an argument; all that is tested here fits (little-endian, as both architectures are). */
static void put_load(struct program *program, uint32_t argument) {
    put(program, BPF_LD | BPF_W | BPF_ABS, (uint32_t)(offsetof(struct seccomp_data, args) + 8 * argument), 0, 0);
}

/* One rule: when the number is not this one, jump over its answer; the number is loaded before. */
static void put_rule(struct program *program, struct rule rule, bool writing, bool landlock) {
    const uint32_t refuse = SECCOMP_RET_ERRNO | EPERM, allow = SECCOMP_RET_ALLOW;
    bool opens = rule.kind == RULE_CLEAR && rule.bits == 0;
    if (opens && !writing)
        rule.bits = writing_flags;
    put(program, BPF_JMP | BPF_JEQ | BPF_K, rule.call, 0, 1);
    size_t jump = program->count - 1u;
    switch (rule.kind) {
    case RULE_ALLOW:
        put_answer(program, allow);
        break;
    case RULE_KILL:
        put_answer(program, SECCOMP_RET_KILL_PROCESS);
        break;
    case RULE_CLEAR:
        put_load(program, rule.argument);
        put(program, BPF_JMP | BPF_JSET | BPF_K, rule.bits, 0, 1);
        put_answer(program, refuse);
        put_answer(program, allow);
        break;
    case RULE_SET:
        put_load(program, rule.argument);
        put(program, BPF_ALU | BPF_AND | BPF_K, rule.bits, 0, 0);
        put(program, BPF_JMP | BPF_JEQ | BPF_K, rule.bits, 1, 0);
        put_answer(program, refuse);
        put_answer(program, allow);
        break;
    case RULE_EQUAL:
        put_load(program, rule.argument);
        put(program, BPF_JMP | BPF_JEQ | BPF_K, rule.bits, 1, 0);
        put_answer(program, refuse);
        put_answer(program, allow);
        break;
    case RULE_WRITING:
        put_answer(program, writing ? allow : refuse);
        break;
    case RULE_BENEATH:
        put_answer(program, landlock ? allow : SECCOMP_RET_ERRNO | ENOSYS);
        break;
    }
    program->steps[jump].jf = (uint8_t)(program->count - 1u - jump);
}

static bool confine_calls(bool writing, bool landlock) {
    struct program program = {.count = 0};
    put(&program, BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, arch), 0, 0);
    put(&program, BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_HERE, 1, 0);
    put_answer(&program, SECCOMP_RET_KILL_PROCESS);
    put(&program, BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr), 0, 0);
    for (int i = 0; i < RULE_COUNT; i++)
        put_rule(&program, rules[i], writing, landlock);
    /* abort() and pthread_kill signal the process itself. */
    put_rule(&program, (struct rule){SYS_tgkill, RULE_EQUAL, 0, (uint32_t)getpid()}, writing, landlock);
    put_answer(&program, SECCOMP_RET_ERRNO | ENOSYS);
    struct sock_fprog filter = {.len = program.count, .filter = program.steps};
    return MAY_FAIL(prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter, 0, 0)) == 0;
}
#else
static bool confine_calls(bool writing, bool landlock) {
    (void)writing;
    (void)landlock;
    errno = ENOSYS;
    return false;
}
#endif

/* Everything that was open before but the standard streams and the channel: descriptors of whoever started us. */
static void close_others(int keep) {
#ifdef SYS_close_range
    if (keep > 3)
        (void)syscall(SYS_close_range, 3u, (unsigned)keep - 1u, 0);
    (void)syscall(SYS_close_range, (unsigned)keep + 1u, ~0u, 0);
#else
    (void)keep;
#endif
}

bool confine_process_as(const struct options *options, int keep, long landlock_at_most, char *report, size_t size,
                        struct error *error) {
    struct reach reach = {0};
    bool ok = true;
    close_others(keep);
    /* What the C library reads once must be read before: the time zone. */
    tzset();
    for (int i = 0; ok && i < options->script_count; i++)
        ok = script_reach(options->scripts[i], &options->script, &reach, error);
    ok = ok && (MAY_FAIL(prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)) == 0 ||
                error_set(error, ERROR_MACHINE, "gray: privileges cannot be given up: %s", strerror(errno)));
    long landlock = ok ? confine_files(options, &reach, landlock_at_most, error) : -1;
    char files[64] = "no Landlock in this kernel (file names are still checked)", calls[96] = "seccomp";
    if (landlock > 0)
        (void)snprintf(files, sizeof files, "Landlock (version %ld)", landlock);
    if (landlock >= 0 && SANITIZED)
        (void)snprintf(calls, sizeof calls, "no seccomp filter in a build with sanitizers");
    else if (landlock >= 0 && !confine_calls(options->script.allow_write_count > 0, landlock > 0))
        (void)snprintf(calls, sizeof calls, "no seccomp filter (%s)", strerror(errno));
    int used = snprintf(report, size, "gray: confined by %s, %s; scenes may read below", files, calls);
    for (size_t i = 0; (size_t)used < size && i < reach.count; i++) {
        const struct reach_folder *folder = &reach.folders[i];
        used += snprintf(report + used, size - (size_t)used, "%s %s%s", i > 0 ? "," : "",
                         folder->length > 0 ? folder->path : "/", folder->kind == REACH_WRITE ? " (and write)" : "");
    }
    reach_destroy(&reach);
    return landlock >= 0;
}

bool confine_process(const struct options *options, int keep, char *report, size_t size, struct error *error) {
    return confine_process_as(options, keep, LONG_MAX, report, size, error);
}
