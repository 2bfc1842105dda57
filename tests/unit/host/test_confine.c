/* What a render process under a scene's control could try with the arguments of its permitted system calls: numbers of
 * which a filter checks only one half, clocks and limits of other processes, threads with unusual flags. Also the
 * warning if the kernel supports less confinement. */
#define _GNU_SOURCE
#include "host/confine.h"
#include "tests/harness.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/fs.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { NO_FILTER = 77 };

/* The high half of an argument: zero, or an attacker's value. */
static const uint64_t garbage[] = {0, UINT64_C(1) << 32, UINT64_C(0xdeadbeef) << 32, UINT64_C(0xffffffff) << 32};
enum { GARBAGE = sizeof garbage / sizeof *garbage };

#define TRY(claim)                                                                                                     \
    do {                                                                                                               \
        errno = 0;                                                                                                     \
        if (!(claim)) {                                                                                                \
            (void)dprintf(1, "    %s:%d: %s (errno %d)\n", __FILE__, __LINE__, #claim, errno);                         \
            failed = 1;                                                                                                \
        }                                                                                                              \
    } while (0)

/* Runs `deed` in a confined process, with the test's folder writable or not; it returns 0 on success. */
static void check_confined(int (*deed)(void), bool writing) {
    static const char *const scripts[] = {"tests/hostile/time_loop.lua"};
    const char *folders[] = {test_folder()};
    /* A card gives rights to the device process alone. */
    struct options options = {.scripts = scripts, .script_count = 1, .device = DEVICE_GPU};
    options.script.allow_write = folders;
    options.script.allow_write_count = writing ? 1 : 0;
    (void)fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        char report[4096];
        struct error error;
        if (!confine_process(&options, 1, report, sizeof report, &error))
            _exit(64);
        _exit(strstr(report, "seccomp;") ? deed() : NO_FILTER);
    }
    int how = 0;
    CHECK(waitpid(child, &how, 0) == child);
    if (WIFEXITED(how) && WEXITSTATUS(how) == NO_FILTER)
        test_skip("no seccomp filter in this build or kernel");
    if (!WIFEXITED(how) || WEXITSTATUS(how) != 0)
        test_fail(__FILE__, __LINE__, "the confined process ended with %#x", how);
}

static bool refused(long answer) {
    return answer == -1 && errno == EPERM;
}

static int try_limits(void) {
    /* Addresses whose low half is 0. */
    static const uintptr_t addresses[] = {UINT64_C(0x100000000), UINT64_C(0x200000000), UINT64_C(0x7f0000000000)};
    struct rlimit64 old;
    int failed = 0;
    for (size_t i = 0; i < sizeof addresses / sizeof *addresses; i++) {
        void *wanted = (void *)addresses[i]; // NOLINT
        struct rlimit64 *page =
            mmap(wanted, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
        TRY(page == wanted);
        if (page != wanted)
            continue;
        *page = (struct rlimit64){64, 64};
        for (int g = 0; g < GARBAGE; g++) {
            TRY(refused(syscall(SYS_prlimit64, garbage[g], RLIMIT_NOFILE, page, NULL)));
            TRY(refused(syscall(SYS_prlimit64, garbage[g] | (uint64_t)getppid(), RLIMIT_NOFILE, page, NULL)));
            TRY(refused(syscall(SYS_prlimit64, garbage[g] | (uint64_t)getppid(), RLIMIT_NOFILE, NULL, &old)));
            TRY(syscall(SYS_prlimit64, garbage[g], RLIMIT_NOFILE, NULL, &old) == 0);
        }
    }
    struct rlimit plain;
    TRY(getrlimit(RLIMIT_STACK, &plain) == 0);
    TRY(refused(setrlimit(RLIMIT_STACK, &plain)));
    return failed;
}

TEST(hostile_a_confined_process_sets_no_limits_by_any_address) {
    struct rlimit before, after;
    CHECK(getrlimit(RLIMIT_NOFILE, &before) == 0);
    check_confined(try_limits, false);
    CHECK(getrlimit(RLIMIT_NOFILE, &after) == 0);
    CHECK(before.rlim_cur == after.rlim_cur && before.rlim_max == after.rlim_max);
}

static int try_memory(void) {
    int failed = 0;
    long size = sysconf(_SC_PAGESIZE);
    void *page = mmap(NULL, (size_t)size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    TRY(page != MAP_FAILED);
    for (int g = 0; g < GARBAGE; g++) {
        uint64_t execute = garbage[g] | PROT_READ | PROT_EXEC;
        TRY(refused(syscall(SYS_mmap, NULL, size, execute, (long)(MAP_PRIVATE | MAP_ANONYMOUS), -1L, 0L)));
        TRY(refused(syscall(SYS_mprotect, page, size, execute)));
        TRY(refused(syscall(SYS_madvise, page, size, garbage[g] | 100)));
        TRY(refused(syscall(SYS_madvise, page, size, garbage[g] | 101)));
        TRY(syscall(SYS_madvise, page, size, garbage[g] | MADV_DONTNEED) == 0);
    }
    TRY(mprotect(page, (size_t)size, PROT_READ) == 0);
    return failed;
}

TEST(hostile_a_confined_process_gets_no_executable_memory_by_any_number) {
    check_confined(try_memory, false);
}

static void *add_one(void *number) {
    ++*(int *)number;
    return number;
}

/* With CLONE_NEWUSER the kernel refuses what the filter passes, so no process is created: EINVAL. */
static int try_threads(void) {
    static const uint64_t foreign[] = {CLONE_NEWNET, CLONE_NEWNS,  CLONE_NEWIPC, CLONE_NEWUTS, CLONE_NEWPID,
                                       CLONE_PTRACE, CLONE_PARENT, CLONE_VFORK,  CLONE_IO,     SIGCHLD};
    uint64_t threads = CLONE_VM | CLONE_THREAD | CLONE_SIGHAND, whole = threads | CLONE_NEWUSER;
    int failed = 0;
    for (int g = 0; g < GARBAGE; g++) {
        TRY(refused(syscall(SYS_clone, garbage[g] | whole, NULL, NULL, NULL, NULL)));
        TRY(refused(syscall(SYS_clone, garbage[g] | CLONE_NEWUSER | CLONE_VM | CLONE_SIGHAND, NULL, NULL, NULL, NULL)));
        TRY(refused(syscall(SYS_clone, garbage[g] | CLONE_NEWUSER | SIGCHLD, NULL, NULL, NULL, NULL)));
        for (size_t i = 0; i < sizeof foreign / sizeof *foreign; i++)
            TRY(refused(syscall(SYS_clone, garbage[g] | whole | foreign[i], NULL, NULL, NULL, NULL)));
    }
    TRY(syscall(SYS_clone3, NULL, 0L) == -1 && errno == ENOSYS);
    pthread_t thread;
    int number = 0;
    TRY(pthread_create(&thread, NULL, add_one, &number) == 0 && pthread_join(thread, NULL) == 0 && number == 1);
    return failed;
}

TEST(hostile_a_confined_process_makes_threads_of_its_own_and_nothing_else) {
    check_confined(try_threads, false);
}

static int try_descriptors(void) {
    static const uint64_t writing[] = {O_WRONLY, O_RDWR, O_ACCMODE, O_CREAT, O_TRUNC, O_APPEND, O_TMPFILE | O_RDWR};
    const char *name = "tests/hostile/time_loop.lua";
    int failed = 0;
    int open_file = open(name, O_RDONLY);
    TRY(open_file >= 0);
    for (int g = 0; g < GARBAGE; g++) {
        for (size_t i = 0; i < sizeof writing / sizeof *writing; i++) {
            TRY(refused(syscall(SYS_openat, AT_FDCWD, name, garbage[g] | writing[i], 0666L)));
#ifdef SYS_open
            TRY(refused(syscall(SYS_open, name, garbage[g] | writing[i], 0666L)));
#endif
        }
        /* The kernel reads an int: here it is a plain read access. */
        TRY(syscall(SYS_openat, AT_FDCWD, name, garbage[g] | O_RDONLY, 0L) >= 0);
        TRY(refused(syscall(SYS_fcntl, open_file, garbage[g] | F_SETFL, (long)O_NONBLOCK)));
        TRY(refused(syscall(SYS_fcntl, open_file, garbage[g] | F_SETOWN, (long)getppid())));
        TRY(refused(syscall(SYS_fcntl, open_file, garbage[g] | F_DUPFD, 0L)));
        TRY(syscall(SYS_fcntl, open_file, garbage[g] | F_GETFL, 0L) >= 0);
        TRY(refused(syscall(SYS_ioctl, 0L, garbage[g] | TIOCSTI, "x")));
        TRY(refused(syscall(SYS_ioctl, open_file, garbage[g] | FIONBIO, &failed)));
        TRY(syscall(SYS_ioctl, open_file, garbage[g] | TCGETS, garbage) == -1 && errno == ENOTTY);
    }
    return failed;
}

TEST(hostile_a_confined_process_opens_nothing_for_writing_by_any_number) {
    check_confined(try_descriptors, false);
}

static int try_processes(void) {
    struct timespec now;
    cpu_set_t set;
    int failed = 0;
    uint64_t above = (uint64_t)getppid(), here = (uint64_t)getpid();
    for (int g = 0; g < GARBAGE; g++) {
        TRY(refused(syscall(SYS_tgkill, garbage[g] | above, above, 0L)));
        TRY(syscall(SYS_tgkill, garbage[g] | here, syscall(SYS_gettid), 0L) == 0);
        uint64_t clock = (uint32_t)(~(uint32_t)above << 3 | 2);
        TRY(refused(syscall(SYS_clock_gettime, garbage[g] | clock, &now)));
        TRY(refused(syscall(SYS_clock_getres, garbage[g] | clock, &now)));
        TRY(refused(syscall(SYS_clock_nanosleep, garbage[g] | clock, 0L, &now, NULL)));
        TRY(syscall(SYS_clock_gettime, garbage[g] | CLOCK_PROCESS_CPUTIME_ID, &now) == 0);
        TRY(refused(syscall(SYS_sched_getaffinity, garbage[g] | above, sizeof set, &set)));
        TRY(syscall(SYS_sched_getaffinity, garbage[g], sizeof set, &set) > 0);
    }
    TRY(sysconf(_SC_NPROCESSORS_ONLN) >= 1);
    return failed;
}

TEST(hostile_a_confined_process_finds_no_other_process) {
    check_confined(try_processes, false);
}

static int try_writing(void) {
    int failed = 0, folder = open(test_folder(), O_RDONLY | O_DIRECTORY);
    TRY(folder >= 0);
    for (int g = 0; g < GARBAGE; g++) {
        int file = openat(folder, "a", O_WRONLY | O_CREAT | O_TRUNC, 0666);
        TRY(file >= 0 && close(file) == 0);
        TRY(refused(syscall(SYS_unlinkat, folder, "inner", garbage[g] | AT_REMOVEDIR)));
        TRY(refused(syscall(SYS_renameat2, folder, "a", folder, "b", garbage[g] | RENAME_WHITEOUT)));
        TRY(refused(syscall(SYS_renameat2, folder, "a", folder, "inner", garbage[g] | RENAME_EXCHANGE)));
        TRY(syscall(SYS_renameat2, folder, "a", folder, "b", garbage[g]) == 0);
        TRY(syscall(SYS_unlinkat, folder, "b", garbage[g]) == 0);
    }
    return failed;
}

TEST(hostile_a_confined_process_that_may_write_changes_files_and_no_folders) {
    CHECK(mkdir(test_path("inner"), 0777) == 0);
    check_confined(try_writing, true);
    CHECK(access(test_path("inner"), F_OK) == 0);
}

/* From now on a system call returns an error in this process and its children, as on a kernel without it. value: of the
 * first argument, or -1 for any. */
static void forbid(unsigned call, int value, unsigned number) {
    struct sock_filter steps[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, value < 0 ? 1 : 3),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, args)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (unsigned)value, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | number),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    struct sock_filter any[] = {steps[0], BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1), steps[4], steps[5]};
    struct sock_fprog program = {6, steps};
    if (value < 0)
        program = (struct sock_fprog){4, any};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) != 0)
        test_skip("no seccomp filter in this kernel");
}

/* The program's message with these arguments begins like this and is one line; "": no message. The notice that there is
 * no picture follows. */
static void check_said(const char *arguments, const char *begin) {
    struct test_result result = test_gray_scene("x = 1", arguments, NULL);
    CHECK_EQ_INT(result.status, 0);
    char *notice =
        strstr(result.err, "scene.lua: no picture was rendered, because the script did not call gr.render\n");
    CHECK((notice != NULL) != (strstr(arguments, "-q") != NULL) && (!notice || strchr(notice, '\n')[1] == '\0'));
    if (notice)
        *notice = '\0';
    const char *end = strchr(result.err, '\n');
    bool good = begin[0] ? strncmp(result.err, begin, strlen(begin)) == 0 && end && end[1] == '\0' : !result.err[0];
    if (!good)
        test_fail(__FILE__, __LINE__, "%s says \"%s\", not \"%s\"", arguments, result.err, begin);
    test_free_result(&result);
}

TEST(hostile_a_kernel_without_landlock_is_one_warning) {
    forbid(SYS_landlock_create_ruleset, -1, ENOSYS);
    check_said("scene.lua", test_has_sanitizer()
                                ? "gray: warning: no Landlock in this kernel (Function not implemented): "
                                : "gray: warning: no Landlock in this kernel (Function not implemented): "
                                  "confined by checks of file names, seccomp\n");
    check_said("-q scene.lua", "");
    check_said("--verbose scene.lua", "gray: warning: no Landlock in this kernel (Function not implemented): ");
    check_said("--no-sandbox scene.lua", "gray: warning: --no-sandbox: ");
    /* A render process that dies is replaced by another one, which does not repeat the message. */
    test_write_text(test_path("dies.lua"), "string.find(string.rep('x', 200000), string.rep('x*', 8) .. 'y')");
    struct test_result result = test_gray_scene("x = 1", "--script-time 0.05 dies.lua scene.lua", NULL);
    const char *first = strstr(result.err, "no Landlock");
    CHECK(first && !strstr(first + 1, "no Landlock") && strstr(first, "dies.lua"));
    test_free_result(&result);
}

TEST(hostile_a_kernel_without_a_filter_is_one_warning) {
    if (test_has_sanitizer())
        test_skip("builds with sanitizers run without the filter");
    struct test_result plain = test_gray_scene("x = 1", "--verbose scene.lua", NULL);
    bool landlock = strstr(plain.err, "Landlock (version ");
    test_free_result(&plain);
    if (!landlock)
        test_skip("no Landlock in this kernel");
    check_said("scene.lua", "");
    forbid(SYS_prctl, PR_SET_SECCOMP, EINVAL);
    check_said("scene.lua", "gray: warning: no seccomp filter (Invalid argument): confined by Landlock (version ");
    check_said("-q scene.lua", "");
}

TEST(hostile_a_kernel_that_confines_nothing_is_one_warning) {
    if (test_has_sanitizer())
        test_skip("builds with sanitizers run without the filter");
    forbid(SYS_landlock_create_ruleset, -1, EOPNOTSUPP);
    forbid(SYS_prctl, PR_SET_SECCOMP, EINVAL);
    char said[256];
    (void)snprintf(said, sizeof said,
                   "gray: warning: no Landlock in this kernel (%s), no seccomp filter "
                   "(Invalid argument): confined by checks of file names\n",
                   strerror(EOPNOTSUPP));
    check_said("scene.lua", said);
}

TEST(hostile_without_a_process_of_its_own_a_scene_is_one_warning) {
    check_said("--no-fork scene.lua",
               "gray: warning: --no-fork: no Landlock, no seccomp filter: confined by checks of file names\n");
    check_said("--no-fork -q scene.lua", "");
}

static int serve_device(bool card) {
    char report[4096];
    struct error error;
    int ends[2], waiting, failed = 0;
    TRY(pipe(ends) == 0);
    TRY(confine_device(card, report, sizeof report, &error));
    if (!strstr(report, "seccomp;"))
        return NO_FILTER;
    TRY(card ? ioctl(ends[0], FIONREAD, &waiting) == 0 : refused(ioctl(ends[0], FIONREAD, &waiting)));
    TRY(open("/dev/null", O_RDONLY) < 0);
    TRY(open("tests/hostile/time_loop.lua", O_RDONLY) < 0);
    return failed;
}

TEST(hostile_only_a_device_process_with_a_card_calls_ioctl_and_none_opens_a_file) {
    for (int card = 0; card < 2; card++) {
        (void)fflush(stdout);
        pid_t child = fork();
        if (child == 0)
            _exit(serve_device(card != 0));
        int how = 0;
        CHECK(waitpid(child, &how, 0) == child);
        if (WIFEXITED(how) && WEXITSTATUS(how) == NO_FILTER)
            test_skip("no seccomp filter in this build or kernel");
        CHECK(WIFEXITED(how) && WEXITSTATUS(how) == 0);
    }
}
