/* Landlock (linux/landlock.h, since Linux 5.13): a list of folders with the allowed operations below each; the kernel
 * refuses everything else, whatever path leads to it. Seccomp (man 2 seccomp): a filter in classic BPF over the number
 * and the first arguments of each system call, read from the table below: a call that is not listed fails with ENOSYS,
 * so a C library that tries a newer call falls back; a call that only an attack would make ends the process.
 *
 * The sanitizers need ptrace, personality and more of /proc than this leaves, so their builds run without the
 * filter. */
#define _GNU_SOURCE
#include "host/confine.h"

#include "compat/dialect.h"
#include "script/script.h"

#include "base/fault.h"
#include "base/file.h"
#include "base/path_policy.h"

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

/* Names that older headers may not define; values as in linux/landlock.h. */
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

/* A file or folder that the process itself reads; it may be missing. */
static bool add_path(int ruleset, const char *path, uint64_t rights) {
    int descriptor = file_open_folder_of(path);
    if (descriptor < 0)
        return true;
    bool added = add_rule(ruleset, descriptor, rights);
    (void)close(descriptor);
    return added;
}

static bool add_rules(int ruleset, const struct options *options, const struct path_policy *path_policy,
                      uint64_t known) {
    bool ok = true;
    for (size_t i = 0; i < path_policy->count; i++) {
        const struct path_policy_folder *folder = &path_policy->folders[i];
        uint64_t rights = folder->kind == PATH_POLICY_WRITE ? read_rights | write_rights : read_rights;
        ok = ok && add_rule(ruleset, folder->descriptor, rights & known);
    }
    /* A scene, or a dialect, that is a link to somewhere else. */
    char dialect[4096];
    if (dialect_file(&options->script, dialect, sizeof dialect) && file_is_regular(dialect))
        ok = ok && add_path(ruleset, dialect, LANDLOCK_ACCESS_FS_READ_FILE);
    for (int i = 0; i < options->script_count; i++) {
        if (file_is_regular(options->scripts[i]))
            ok = ok && add_path(ruleset, options->scripts[i], LANDLOCK_ACCESS_FS_READ_FILE);
    }
    /* The number of processors; memory maps for the reports of the sanitizers. */
    ok = ok && add_path(ruleset, "/sys/devices/system/cpu", read_rights);
#if SANITIZED
    ok = ok && add_path(ruleset, "/proc", read_rights) && add_path(ruleset, "/usr", read_rights) &&
         add_path(ruleset, "/lib", read_rights) && add_path(ruleset, "/proc/self/exe", LANDLOCK_ACCESS_FS_READ_FILE);
#endif
    return ok;
}

/* Version of the interface that is active; 0 when the kernel has none, with the reason in errno. -1: error. */
static long confine_files(const struct options *options, const struct path_policy *path_policy, long max_version,
                          struct error *error) {
    long version = MAY_FAIL(syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION));
    if (max_version <= 0 && version > 0) {
        version = 0;
        errno = ENOSYS;
    }
    version = version < max_version ? version : max_version;
    if (version <= 0)
        return 0;
    uint64_t known = known_rights(version);
    struct ruleset wanted = {known, NET_BIND | NET_CONNECT, SCOPE_ABSTRACT_SOCKET | SCOPE_SIGNAL};
    size_t size = version >= 6 ? sizeof wanted : version >= 4 ? 2 * sizeof(uint64_t) : sizeof(uint64_t);
    int ruleset = (int)MAY_FAIL(syscall(SYS_landlock_create_ruleset, &wanted, size, 0));
    bool ok = ruleset >= 0 && add_rules(ruleset, options, path_policy, known) &&
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
/* A test of one argument: these bits of it must have this value. The kernel reads an int from the low half of the
 * register whatever the high half holds, so a test of an int looks at the low half alone; the kernel reads a pointer or
 * a long whole, so a test of those needs a high half of 0 as well. */
enum width { NO_TEST, INT, LONG };
struct test {
    enum width width;
    uint8_t argument;
    uint32_t bits, value; /* of the low half; the high half of a LONG must be 0 */
};

enum rule_kind {
    RULE_ALLOW,   /* if the arguments pass the tests; otherwise EPERM */
    RULE_KILL,    /* only an attack would call it */
    RULE_OPEN,    /* with these flags, or with any flags if some folder may be written */
    RULE_WRITING, /* as RULE_ALLOW if some folder may be written */
    RULE_CARD,    /* as RULE_ALLOW; a process that serves a card may call it with any arguments */
    RULE_BENEATH, /* allowed when Landlock is active: its arguments lie in memory */
};

enum { TESTS = 2 };
struct rule {
    uint32_t call;
    enum rule_kind kind;
    struct test tests[TESTS];
};

/* Initialisers of struct test. */
#define IS(width, argument, value)                                                                                     \
    { width, argument, UINT32_MAX, value }
#define WITHOUT(width, argument, bits)                                                                                 \
    { width, argument, bits, 0 }

/* Not O_ACCMODE, which has O_PATH in musl. */
#define WRITING_FLAGS ((uint32_t)(O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND | (O_TMPFILE & ~O_DIRECTORY)))
/* The flags of a new thread of this process; no other flag is allowed, especially not a new namespace. */
#define THREAD_FLAGS ((uint32_t)(CLONE_VM | CLONE_THREAD | CLONE_SIGHAND))
#define OTHER_FLAGS                                                                                                    \
    (~(uint32_t)(CLONE_FS | CLONE_FILES | CLONE_SYSVSEM | CLONE_SETTLS | CLONE_PARENT_SETTID | CLONE_CHILD_CLEARTID |  \
                 CLONE_CHILD_SETTID | CLONE_DETACHED))
/* The clocks of other processes have negative numbers. */
#define OTHER_CLOCKS (UINT32_C(1) << 31)
/* Advice from 64 on concerns the machine (MADV_HWPOISON) instead of this memory. */
#define OTHER_ADVICE (~UINT32_C(63))

static const struct rule rules[] = {
    {.call = SYS_futex},
    {.call = SYS_clock_gettime, .tests = {WITHOUT(INT, 0, OTHER_CLOCKS)}},
    {.call = SYS_read},
    {.call = SYS_write},
    {.call = SYS_readv},
    {.call = SYS_writev},
    {.call = SYS_pread64},
    {.call = SYS_sendmsg},
    {.call = SYS_recvmsg},
    {.call = SYS_ppoll},
    {.call = SYS_close},
    {.call = SYS_lseek},
    {.call = SYS_fstat},
    {.call = SYS_newfstatat},
    {.call = SYS_statx},
    {.call = SYS_readlinkat},
    {.call = SYS_faccessat},
    {.call = SYS_getdents64},
    {.call = SYS_getcwd},
    {.call = SYS_dup},
    {.call = SYS_brk},
    {.call = SYS_munmap},
    {.call = SYS_mremap},
    {.call = SYS_madvise, .tests = {WITHOUT(INT, 2, OTHER_ADVICE)}},
    {.call = SYS_mmap, .tests = {WITHOUT(LONG, 2, PROT_EXEC)}},
    {.call = SYS_mprotect, .tests = {WITHOUT(LONG, 2, PROT_EXEC)}},
    {.call = SYS_set_robust_list},
    {.call = SYS_set_tid_address},
#ifdef SYS_rseq
    {.call = SYS_rseq},
#endif
    {.call = SYS_clone, .tests = {{LONG, 0, OTHER_FLAGS, THREAD_FLAGS}}},
    {.call = SYS_sched_yield},
    {.call = SYS_sched_getaffinity, .tests = {IS(INT, 0, 0)}},
    {.call = SYS_nanosleep},
    {.call = SYS_clock_nanosleep, .tests = {WITHOUT(INT, 0, OTHER_CLOCKS)}},
    {.call = SYS_clock_getres, .tests = {WITHOUT(INT, 0, OTHER_CLOCKS)}},
    {.call = SYS_gettimeofday},
    {.call = SYS_getrandom},
    {.call = SYS_rt_sigaction},
    {.call = SYS_rt_sigprocmask},
    {.call = SYS_rt_sigreturn},
    {.call = SYS_sigaltstack},
    {.call = SYS_restart_syscall},
    {.call = SYS_gettid},
    {.call = SYS_getpid},
    {.call = SYS_getppid},
    {.call = SYS_getuid},
    {.call = SYS_geteuid},
    {.call = SYS_getrusage},
    {.call = SYS_times},
    {.call = SYS_sysinfo},
    {.call = SYS_uname},
    {.call = SYS_exit},
    {.call = SYS_exit_group},
    {.call = SYS_openat, .kind = RULE_OPEN, .tests = {WITHOUT(INT, 2, WRITING_FLAGS)}},
    {.call = SYS_openat2, .kind = RULE_BENEATH},
    {.call = SYS_fcntl, .tests = {{INT, 1, ~UINT32_C(1), F_SETFD}}}, /* F_SETFD or F_GETFL, as fdopendir calls them */
    {.call = SYS_ioctl, .kind = RULE_CARD, .tests = {IS(INT, 1, TCGETS)}},
    /* Its own limits: reading only. */
    {.call = SYS_prlimit64, .tests = {IS(INT, 0, 0), IS(LONG, 2, 0)}},
    {.call = SYS_ftruncate, .kind = RULE_WRITING},
    {.call = SYS_fsync, .kind = RULE_WRITING},
    {.call = SYS_unlinkat, .kind = RULE_WRITING, .tests = {IS(INT, 2, 0)}},
    {.call = SYS_renameat, .kind = RULE_WRITING},
    {.call = SYS_renameat2, .kind = RULE_WRITING, .tests = {IS(INT, 4, 0)}},
#ifdef SYS_open /* calls that newer architectures do not have */
    {.call = SYS_open, .kind = RULE_OPEN, .tests = {WITHOUT(INT, 1, WRITING_FLAGS)}},
    {.call = SYS_stat},
    {.call = SYS_lstat},
    {.call = SYS_access},
    {.call = SYS_poll},
    {.call = SYS_readlink},
    {.call = SYS_time},
    {.call = SYS_unlink, .kind = RULE_WRITING},
    {.call = SYS_rename, .kind = RULE_WRITING},
    {.call = SYS_fork, .kind = RULE_KILL},
    {.call = SYS_vfork, .kind = RULE_KILL},
#endif
    {.call = SYS_execve, .kind = RULE_KILL},
    {.call = SYS_execveat, .kind = RULE_KILL},
    {.call = SYS_socket, .kind = RULE_KILL},
    {.call = SYS_socketpair, .kind = RULE_KILL},
    {.call = SYS_connect, .kind = RULE_KILL},
    {.call = SYS_bind, .kind = RULE_KILL},
    {.call = SYS_listen, .kind = RULE_KILL},
    {.call = SYS_ptrace, .kind = RULE_KILL},
    {.call = SYS_process_vm_readv, .kind = RULE_KILL},
    {.call = SYS_process_vm_writev, .kind = RULE_KILL},
    {.call = SYS_kill, .kind = RULE_KILL},
    {.call = SYS_tkill, .kind = RULE_KILL},
    {.call = SYS_mount, .kind = RULE_KILL},
    {.call = SYS_bpf, .kind = RULE_KILL},
    {.call = SYS_setuid, .kind = RULE_KILL},
    {.call = SYS_chroot, .kind = RULE_KILL},
    {.call = SYS_init_module, .kind = RULE_KILL},
    {.call = SYS_keyctl, .kind = RULE_KILL},
    {.call = SYS_perf_event_open, .kind = RULE_KILL},
    {.call = SYS_unshare, .kind = RULE_KILL},
    {.call = SYS_setns, .kind = RULE_KILL},
};
enum { RULE_COUNT = sizeof rules / sizeof *rules, STEPS = 16 + (2 + 7 * TESTS) * (RULE_COUNT + 1) };

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

/* One half of an argument; both architectures are little-endian. */
static void put_load(struct program *program, uint32_t argument, uint32_t half) {
    uint32_t at = (uint32_t)offsetof(struct seccomp_data, args) + 8 * argument + 4 * half;
    put(program, BPF_LD | BPF_W | BPF_ABS, at, 0, 0);
}

/* Refuses if the loaded number is not this one. */
static void put_equal(struct program *program, uint32_t value) {
    put(program, BPF_JMP | BPF_JEQ | BPF_K, value, 1, 0);
    put_answer(program, SECCOMP_RET_ERRNO | EPERM);
}

static void put_tests(struct program *program, const struct test tests[TESTS]) {
    for (int i = 0; i < TESTS && tests[i].width != NO_TEST; i++) {
        put_load(program, tests[i].argument, 0);
        if (tests[i].bits != UINT32_MAX)
            put(program, BPF_ALU | BPF_AND | BPF_K, tests[i].bits, 0, 0);
        put_equal(program, tests[i].value);
        if (tests[i].width == LONG) {
            put_load(program, tests[i].argument, 1);
            put_equal(program, 0);
        }
    }
}

/* One rule: if the loaded number is not this one, it jumps over its result. */
static void put_rule(struct program *program, const struct rule *rule, bool writing, bool landlock, bool card) {
    const uint32_t refuse = SECCOMP_RET_ERRNO | EPERM, allow = SECCOMP_RET_ALLOW;
    put(program, BPF_JMP | BPF_JEQ | BPF_K, rule->call, 0, 1);
    size_t jump = program->count - 1u;
    switch (rule->kind) {
    case RULE_ALLOW:
        put_tests(program, rule->tests);
        put_answer(program, allow);
        break;
    case RULE_KILL:
        put_answer(program, SECCOMP_RET_KILL_PROCESS);
        break;
    case RULE_OPEN:
        if (!writing)
            put_tests(program, rule->tests);
        put_answer(program, allow);
        break;
    case RULE_CARD:
        if (!card)
            put_tests(program, rule->tests);
        put_answer(program, allow);
        break;
    case RULE_WRITING:
        if (writing)
            put_tests(program, rule->tests);
        put_answer(program, writing ? allow : refuse);
        break;
    case RULE_BENEATH:
        put_answer(program, landlock ? allow : SECCOMP_RET_ERRNO | ENOSYS);
        break;
    }
    /* The jump to behind the result is known only now. */
    program->steps[jump].jf = (uint8_t)(program->count - 1u - jump);
}

static bool confine_calls(bool writing, bool landlock, bool card) {
    struct program program = {.count = 0};
    put(&program, BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, arch), 0, 0);
    put(&program, BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_HERE, 1, 0);
    put_answer(&program, SECCOMP_RET_KILL_PROCESS);
    put(&program, BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr), 0, 0);
    for (int i = 0; i < RULE_COUNT; i++)
        put_rule(&program, &rules[i], writing, landlock, card);
    /* abort() and pthread_kill signal the process itself. */
    const struct rule own_signals = {.call = SYS_tgkill, .tests = {IS(INT, 0, (uint32_t)getpid())}};
    put_rule(&program, &own_signals, writing, landlock, card);
    put_answer(&program, SECCOMP_RET_ERRNO | ENOSYS);
    struct sock_fprog filter = {.len = program.count, .filter = program.steps};
    return MAY_FAIL(prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter, 0, 0)) == 0;
}
#else
static bool confine_calls(bool writing, bool landlock, bool card) {
    (void)writing;
    (void)landlock;
    (void)card;
    errno = ENOSYS;
    return false;
}
#endif

/* Closes all descriptors inherited from the parent process, except the standard streams and the channel. */
void confine_descriptors(int keep) {
#ifdef SYS_close_range
    if (keep > 3)
        (void)syscall(SYS_close_range, 3u, (unsigned)keep - 1u, 0);
    (void)syscall(SYS_close_range, (unsigned)keep + 1u, ~0u, 0);
#else
    (void)keep;
#endif
}

struct confinement {
    const struct options *options;
    long landlock_max;
    bool card; /* the process serves one */
};

static bool confine(const struct confinement *confinement, char *report, size_t size, struct error *error) {
    const struct options *options = confinement->options;
    struct path_policy path_policy = {0};
    bool ok = true;
    /* Data that the C library reads only once must be read before: the time zone. */
    tzset();
    for (int i = 0; ok && i < options->script_count; i++)
        ok = script_path_policy(options->scripts[i], &options->script, &path_policy, error);
    ok = ok && (MAY_FAIL(prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)) == 0 ||
                error_set(error, ERROR_MACHINE, "gray: privileges cannot be dropped: %s", strerror(errno)));
    long landlock = ok ? confine_files(options, &path_policy, confinement->landlock_max, error) : -1;
    /* The report lists first what is missing, then what is active. */
    char missing[256] = "", files[64] = "checks of file names";
    const char *calls = ", seccomp";
    if (landlock > 0)
        (void)snprintf(files, sizeof files, "Landlock (version %ld)", landlock);
    else if (landlock == 0)
        (void)snprintf(missing, sizeof missing, "no Landlock in this kernel (%s)", strerror(errno));
    if (landlock >= 0 && SANITIZED) {
        calls = ", no seccomp filter in a build with sanitizers";
    } else if (landlock >= 0 &&
               !confine_calls(options->script.allow_write_count > 0, landlock > 0, confinement->card)) {
        size_t length = strlen(missing);
        (void)snprintf(missing + length, sizeof missing - length, "%sno seccomp filter (%s)", length > 0 ? ", " : "",
                       strerror(errno));
        calls = "";
    }
    int used = snprintf(report, size, "gray: %s%s%sconfined by %s%s; scenes may read below",
                        missing[0] ? "warning: " : "", missing, missing[0] ? ": " : "", files, calls);
    for (size_t i = 0; (size_t)used < size && i < path_policy.count; i++) {
        const struct path_policy_folder *folder = &path_policy.folders[i];
        used +=
            snprintf(report + used, size - (size_t)used, "%s %s%s", i > 0 ? "," : "",
                     folder->length > 0 ? folder->path : "/", folder->kind == PATH_POLICY_WRITE ? " (and write)" : "");
    }
    path_policy_destroy(&path_policy);
    return landlock >= 0;
}

bool confine_process_as(const struct options *options, int keep, long landlock_max, char *report, size_t size,
                        struct error *error) {
    confine_descriptors(keep);
    return confine(&(struct confinement){options, landlock_max, false}, report, size, error);
}

bool confine_process(const struct options *options, int keep, char *report, size_t size, struct error *error) {
    return confine_process_as(options, keep, LONG_MAX, report, size, error);
}

bool confine_device(bool card, char *report, size_t size, struct error *error) {
    static const struct options nothing;
    return confine(&(struct confinement){&nothing, LONG_MAX, card}, report, size, error);
}
