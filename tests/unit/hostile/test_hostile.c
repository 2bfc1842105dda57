/* Malicious scenes: tests/hostile has one script each, with the expected result in its first lines.
 *   -- expect: FIRST LINE   of standard error. SCRIPT is the script's name; a star matches anything; empty: no output
 *   -- status: N            1 when there is none
 *   -- arguments: ...       beside the standard ones below
 * Beside the line and the status: no script exceeds its limits of time and memory by more than a tenth, none leaves a
 * file behind, and the kernel confines the render process as reported. */
#define _GNU_SOURCE
#include "host/confine.h"
#include "tests/harness.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define LIMITS "--script-time 0.1 --script-memory 64 --script-output 1 --transform-order new -j 1"
static const double time_limit = 0.1;
static const long memory_limit = 64 << 10; /* KiB, as ru_maxrss counts */

/* The header line, from malloc; NULL if there is none. */
static char *header(const char *text, const char *name) {
    char start[64];
    (void)snprintf(start, sizeof start, "-- %s:", name);
    const char *found = strstr(text, start);
    if (!found)
        return NULL;
    found += strlen(start);
    found += *found == ' ';
    return strndup(found, strcspn(found, "\n"));
}

/* Stars in the pattern match anything; SCRIPT stands for the name. */
static bool matches(const char *pattern, const char *name, const char *text) {
    if (strncmp(pattern, "SCRIPT", 6) == 0)
        return strncmp(text, name, strlen(name)) == 0 && matches(pattern + 6, name, text + strlen(name));
    if (*pattern == '*') {
        for (const char *at = text;; at++) {
            if (matches(pattern + 1, name, at) || pattern[1] == '\0')
                return true;
            if (*at == '\0')
                return false;
        }
    }
    if (*pattern == '\0' || *text == '\0')
        return *pattern == *text;
    return *pattern == *text && matches(pattern + 1, name, text + 1);
}

static void check_script(const char *folder, const char *name) {
    char path[1024], arguments[1024];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    char *text = test_read_file(path, NULL), *expect = header(text, "expect"), *status = header(text, "status");
    char *more = header(text, "arguments");
    (void)snprintf(arguments, sizeof arguments, LIMITS " %s %s", more ? more : "", name);
    double before = test_children_used().seconds;
    struct test_result result = test_gray(folder, arguments);
    double used = test_children_used().seconds - before;
    if (getenv("GRAY_TEST_TELL"))
        printf("    %s: %.3f s, %ld KiB at most so far: %.300s\n", name, used, test_children_used().kibibytes,
               result.err);
    char *line = result.err, first[2048];
    line += strspn(line, "x"); /* of those that write to standard error */
    (void)snprintf(first, sizeof first, "%.*s", (int)strcspn(line, "\n"), line);
    /* A run that takes longer than ten seconds reports its progress first. */
    while (strstr(first, ": building the scene, ") && strchr(line, '\n')) {
        line = strchr(line, '\n') + 1;
        (void)snprintf(first, sizeof first, "%.*s", (int)strcspn(line, "\n"), line);
    }
    if (strstr(first, ": no picture was rendered, because the script did not call gr.render"))
        first[0] = '\0';
    char pattern[1024];
    size_t length = expect ? strlen(expect) : 0;
    (void)snprintf(pattern, sizeof pattern, "%s%s", expect ? expect : "?", length > 0 && expect[0] == '*' ? "*" : "");
    if (length > 0 && strchr(expect, '*') && pattern[strlen(pattern) - 1] != '*')
        (void)strcat(pattern, "*");
    /* With sanitizers a script may reach its time limit before the tested line. */
    const char *claim = strstr(pattern, "the script used up");
    char anywhere[1024 + 8];
    (void)snprintf(anywhere, sizeof anywhere, "SCRIPT:*%s", claim ? claim : "");
    bool as_well = claim && test_has_sanitizer() && matches(anywhere, name, first);
    if (!as_well && !matches(pattern, name, first))
        test_fail(__FILE__, __LINE__, "%s says \"%s\", not \"%s\"", name, first, pattern);
    if (result.status != (status ? atoi(status) : 1))
        test_fail(__FILE__, __LINE__, "%s ends with %d", name, result.status);
    /* A tenth more, plus the start of two processes. */
    if (!more && !test_has_sanitizer() && used > time_limit * 1.1 + 0.08)
        test_fail(__FILE__, __LINE__, "%s took %.3f s of processor time", name, used);
    test_free_result(&result);
    free(text);
    free(expect);
    free(status);
    free(more);
}

/* A PNG that claims 30000 x 30000 pixels and holds none. */
static void write_huge_image(const char *path) {
    static const unsigned char start[] = {137, 80,  78, 71, 13, 10,  26, 10, 0, 0, 0, 13, 'I',  'H',  'D',  'R', 0,
                                          0,   117, 48, 0,  0,  117, 48, 16, 6, 0, 0, 0,  0x3b, 0x7c, 0x5f, 0x4e};
    test_write_file(path, start, sizeof start);
}

/* The scripts in a separate folder, with links that lead out of it. */
static const char *prepare(void) {
    static char folder[512];
    char to[1024];
    (void)snprintf(folder, sizeof folder, "%s/hostile", test_folder());
    CHECK(mkdir(folder, 0777) == 0);
    DIR *stream = opendir("tests/hostile");
    for (struct dirent *entry; stream && (entry = readdir(stream)) != NULL;) {
        if (entry->d_name[0] == '.')
            continue;
        char from[512];
        (void)snprintf(from, sizeof from, "tests/hostile/%.200s", entry->d_name);
        (void)snprintf(to, sizeof to, "%s/%.200s", folder, entry->d_name);
        size_t size = 0;
        char *bytes = test_read_file(from, &size);
        if (bytes)
            test_write_file(to, bytes, size);
        free(bytes);
    }
    if (stream)
        (void)closedir(stream);
    (void)snprintf(to, sizeof to, "%s/leads_out", folder);
    CHECK(symlink("/etc/passwd", to) == 0);
    (void)snprintf(to, sizeof to, "%s/leads_up", folder);
    CHECK(symlink("/", to) == 0);
    (void)snprintf(to, sizeof to, "%s/.hidden", folder);
    CHECK(mkdir(to, 0777) == 0);
    (void)snprintf(to, sizeof to, "%s/huge.png", folder);
    write_huge_image(to);
    return folder;
}

static int count_files(const char *folder) {
    int count = 0;
    DIR *stream = opendir(folder);
    while (stream && readdir(stream))
        count++;
    if (stream)
        (void)closedir(stream);
    return count;
}

static int run_scripts(const char *prefix) {
    const char *folder = prepare();
    int scripts = 0, files = count_files(folder), above = count_files(test_folder());
    struct dirent **names;
    int count = scandir(folder, &names, NULL, alphasort);
    for (int k = 0; k < count; k++) {
        if (strncmp(names[k]->d_name, prefix, strlen(prefix)) == 0 && strstr(names[k]->d_name, ".lua")) {
            check_script(folder, names[k]->d_name);
            scripts++;
        }
        free(names[k]);
    }
    free(names);
    CHECK_EQ_INT(count_files(folder), files);
    CHECK_EQ_INT(count_files(test_folder()), above);
    return scripts;
}

TEST(hostile_no_script_runs_longer_than_its_time_and_a_tenth) {
    CHECK(run_scripts("time_") >= 35);
}

TEST(hostile_no_script_takes_more_than_its_memory_and_a_tenth) {
    char *path = NULL;
    CHECK(asprintf(&path, "%s/plain.lua", test_folder()) > 0);
    test_write_text(path, "local x = 1");
    struct test_result plain = test_gray(NULL, "plain.lua");
    CHECK_EQ_INT(plain.status, 0);
    test_free_result(&plain);
    long without = test_children_used().kibibytes;
    CHECK(run_scripts("memory_") >= 15);
#ifdef __GLIBC__
    const long limit = memory_limit * 11 / 10;
#else
    const long limit = memory_limit * 12 / 10; /* the allocator of musl keeps more */
#endif
    if (!test_has_sanitizer() && test_children_used().kibibytes - without > limit)
        test_fail(__FILE__, __LINE__, "%ld KiB over the %ld of an empty script",
                  test_children_used().kibibytes - without, without);
    free(path);
}

TEST(hostile_no_script_prints_without_end) {
    CHECK(run_scripts("output_") >= 5);
}

TEST(hostile_no_script_overflows_a_stack) {
    CHECK(run_scripts("deep_") >= 5);
}

TEST(hostile_no_script_leaves_its_folders) {
    CHECK(run_scripts("escape_") >= 35);
}

TEST(hostile_sizes_are_one_line_before_memory_is_taken) {
    CHECK(run_scripts("size_") >= 4);
}

/* What a render process under a scene's control could try. Each function returns if it was not stopped. */
static void try_program(void) {
    (void)execl("/bin/true", "true", (char *)NULL);
}
static void try_socket(void) {
    (void)socket(AF_INET, SOCK_STREAM, 0);
}
static void try_fork(void) {
    if (fork() == 0)
        _exit(0);
}
static void try_trace(void) {
    (void)ptrace(PTRACE_ATTACH, getppid(), NULL, NULL);
}
static void try_signal(void) {
    (void)kill(getppid(), SIGCONT);
}

static void confine_here(void) {
    static const char *const scripts[] = {"tests/hostile/time_loop.lua"};
    struct options options = {.scripts = scripts, .script_count = 1};
    char report[4096];
    struct error error;
    if (!confine_process(&options, 1, report, sizeof report, &error)) {
        test_fail(__FILE__, __LINE__, "%s", error.text);
        _exit(1);
    }
    if (!strstr(report, "seccomp;"))
        _exit(77); /* not in this kernel or build: reported */
}

/* How a confined process ends after an action: the signal, or -1 if it continues, -2 without seccomp.
 */
static int end_of(void (*deed)(void)) {
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        confine_here();
        deed();
        _exit(0);
    }
    int how;
    (void)waitpid(child, &how, 0);
    if (WIFEXITED(how) && WEXITSTATUS(how) == 77)
        return -2;
    return WIFSIGNALED(how) ? WTERMSIG(how) : -1;
}

TEST(hostile_a_confined_process_is_ended_for_programs_sockets_forks_traces_and_signals) {
    if (end_of(try_socket) == -2)
        test_skip("no seccomp filter in this build or kernel");
    CHECK_EQ_INT(end_of(try_program), SIGSYS);
    CHECK_EQ_INT(end_of(try_socket), SIGSYS);
    CHECK_EQ_INT(end_of(try_trace), SIGSYS);
    CHECK_EQ_INT(end_of(try_signal), SIGSYS);
    /* Refused with an error, because threads need clone; musl calls fork itself. */
    int forked = end_of(try_fork);
    CHECK(forked == -1 || forked == SIGSYS);
}

static void *add_one(void *number) {
    ++*(int *)number;
    return number;
}

TEST(hostile_a_confined_process_reads_its_folders_only_writes_nothing_and_still_computes) {
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        confine_here();
        errno = 0;
        bool ok = open("/etc/passwd", O_RDONLY) < 0 && errno == EACCES;
        ok = ok && open("tests/hostile/time_loop.lua", O_RDONLY) >= 0;
        ok = ok && open("tests/hostile/harm.txt", O_WRONLY | O_CREAT, 0666) < 0;
        ok = ok && open("/proc/self/mem", O_RDWR) < 0 && open("/dev/null", O_WRONLY) < 0;
        ok = ok && unlink("tests/hostile/time_loop.lua") < 0 && mkdir("tests/hostile/harm", 0777) < 0;
        ok = ok &&
             mmap(NULL, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED;
        ok = ok && syscall(SYS_clone, SIGCHLD, NULL, NULL, NULL, 0) < 0;
        pthread_t thread;
        int number = 0;
        ok = ok && pthread_create(&thread, NULL, add_one, &number) == 0 && pthread_join(thread, NULL) == 0 &&
             number == 1;
        void *large = malloc(100 << 20);
        ok = ok && large;
        free(large);
        _exit(ok ? 0 : 1);
    }
    int how;
    (void)waitpid(child, &how, 0);
    if (WIFEXITED(how) && WEXITSTATUS(how) == 77)
        test_skip("no seccomp filter in this build or kernel");
    CHECK(WIFEXITED(how) && WEXITSTATUS(how) == 0);
    CHECK(access("tests/hostile/time_loop.lua", F_OK) == 0 && access("tests/hostile/harm.txt", F_OK) != 0);
}

TEST(hostile_verbose_says_what_confines_and_no_sandbox_is_one_warning) {
    struct test_result plain = test_gray_scene("print('x')", "--verbose scene.lua", NULL);
    CHECK(strstr(plain.err, "gray: confined by ") && strstr(plain.err, "; scenes may read below "));
    struct test_result without =
        test_gray_scene("assert(os.execute and io.open('/etc/passwd'))", "--no-sandbox scene.lua", NULL);
    CHECK_EQ_INT(without.status, 0);
    CHECK_TEXT(without.err, "gray: warning: --no-sandbox: scenes may read and write all your files and start programs\n"
                            "scene.lua: no picture was rendered, because the script did not call gr.render\n");
    test_free_result(&plain);
    test_free_result(&without);
}

TEST(hostile_folders_that_are_allowed_can_be_read_and_written_and_only_those) {
    char *arguments = NULL, *inner = NULL;
    CHECK(asprintf(&inner, "%s/inner", test_folder()) > 0 && mkdir(inner, 0777) == 0);
    CHECK(asprintf(&arguments, "--allow-write inner --allow-read /etc scene.lua") > 0);
    struct test_result result =
        test_gray_scene("assert(io.open('/etc/passwd')):close()\n"
                        "local f = assert(io.open('inner/a.txt', 'w')) f:write('well') f:close()\n"
                        "assert(io.open('inner/a.txt', 'r+')):close()\n"
                        "assert(os.rename('inner/a.txt', 'inner/b.txt'))\n"
                        "assert(io.open('inner/b.txt', 'a')):write('!')\n"
                        "assert(os.remove('inner/missing') == nil)\n"
                        "assert(io.open('a.txt', 'w') == nil and io.open('/etc/x', 'w') == nil)\n"
                        "assert(os.rename('inner/b.txt', 'b.txt') == nil)\n"
                        "assert(os.remove('scene.lua') == nil)",
                        arguments, NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "status %d: %s", result.status, result.err);
    test_free_result(&result);
    char path[1024];
    (void)snprintf(path, sizeof path, "%s/b.txt", inner);
    char *text = test_read_file(path, NULL);
    CHECK_TEXT(text, "well!");
    free(text);
    free(arguments);
    free(inner);
}
