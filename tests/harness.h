/* A small test harness. TEST(name) registers itself; CHECK and friends report and count. A test's name is its claim.
 * Run: build/CONFIG/tests/run [option ...] [word ...] (--help); the last line is "N passed, N failed, N skipped", and a
 * line before it has the reasons of what was skipped. Every test runs in a process of its own with a time limit, so
 * that a crash or a hang is one failed test; its standard input is empty and no signal is ignored. Its output is shown
 * if it fails. A line reports the progress of the run every 15 seconds, or every GRAY_TEST_PROGRESS seconds. With --log
 * all lines go to FILE; those of passed and skipped tests and the last line go only there. With --fast a test ends when
 * it is about to start a program, and does not count. */
#ifndef GRAY_TESTS_HARNESS_H
#define GRAY_TESTS_HARNESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

enum test_kind {
    TEST_FAST,
    TEST_SLOW,   /* only run by make test-long */
    TEST_EXAMPLE /* only run by the tests of the runner itself (run --examples) */
};
struct test {
    const char *name, *file;
    void (*run)(void);
    enum test_kind kind;
    struct test *next;
};
void test_register(struct test *test);
/* Whether the name of any test, of any kind, matches the pattern (fnmatch). */
bool test_is_named(const char *pattern);

#define TEST_DEFINE(test_name, test_kind)                                                                              \
    static void test_name(void);                                                                                       \
    static struct test test_entry_##test_name = {#test_name, __FILE__, test_name, test_kind, NULL};                    \
    __attribute__((constructor)) static void test_enter_##test_name(void) {                                            \
        test_register(&test_entry_##test_name);                                                                        \
    }                                                                                                                  \
    static void test_name(void)
#define TEST(test_name) TEST_DEFINE(test_name, TEST_FAST)
#define TEST_LONG(test_name) TEST_DEFINE(test_name, TEST_SLOW)
#define TEST_EXAMPLE(test_name) TEST_DEFINE(test_name, TEST_EXAMPLE)
/* A claim in two sizes: `times` is 1 in make test, and `factor` in make test-long, where the name ends in _many_times.
 */
#define TEST_TIMES(test_name, factor)                                                                                  \
    static void test_name##_of_size(int times);                                                                        \
    TEST(test_name) {                                                                                                  \
        test_name##_of_size(1);                                                                                        \
    }                                                                                                                  \
    TEST_LONG(test_name##_many_times) {                                                                                \
        test_name##_of_size(factor);                                                                                   \
    }                                                                                                                  \
    static void test_name##_of_size(int times)

void test_fail(const char *file, int line, const char *format, ...) __attribute__((format(printf, 3, 4)));
_Noreturn void test_skip(const char *format, ...) __attribute__((format(printf, 1, 2))); /* ends this test as skipped */
/* Ends this test because something is missing that tools/setup.sh --tests installs: as skipped, but as failed when
 * GRAY_CI is set and not empty. The text is the whole reason: "ffmpeg is not installed". */
_Noreturn void test_lacks(const char *format, ...) __attribute__((format(printf, 1, 2)));
/* The factor of time limits: GRAY_TEST_SLOWNESS, for an emulator or an old machine. */
unsigned test_slowness(void);
/* The test needs these programs (names with blanks between them) on PATH. */
void test_need_tools(const char *names);
/* The test needs a program that was built with jansson, or with OpenEXR. */
void test_need_json(void);
void test_need_exr(void);
/* The test needs gray-gui beside the program. */
void test_need_gui(void);
/* The test needs gray-mpi beside the program, and mpirun. */
void test_need_mpi(void);

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        if (!(condition))                                                                                              \
            test_fail(__FILE__, __LINE__, "%s", #condition);                                                           \
    } while (0)
#define CHECK_NEAR(a, b, tolerance)                                                                                    \
    do {                                                                                                               \
        double check_a = (double)(a), check_b = (double)(b), check_t = (double)(tolerance);                            \
        double check_d = check_a > check_b ? check_a - check_b : check_b - check_a;                                    \
        if (!(check_d <= check_t))                                                                                     \
            test_fail(__FILE__, __LINE__, "%s = %.17g, %s = %.17g, differ by %g > %g", #a, check_a, #b, check_b,       \
                      check_d, check_t);                                                                               \
    } while (0)
#define CHECK_EQ_INT(a, b)                                                                                             \
    do {                                                                                                               \
        long long check_a = (long long)(a), check_b = (long long)(b);                                                  \
        if (check_a != check_b)                                                                                        \
            test_fail(__FILE__, __LINE__, "%s = %lld, %s = %lld", #a, check_a, #b, check_b);                           \
    } while (0)
#define CHECK_TEXT(a, b)                                                                                               \
    do {                                                                                                               \
        const char *check_a = (a), *check_b = (b);                                                                     \
        if (!check_a || !check_b || __builtin_strcmp(check_a, check_b) != 0)                                           \
            test_fail(__FILE__, __LINE__, "%s is \"%s\", not \"%s\"", #a, check_a ? check_a : "(null)",                \
                      check_b ? check_b : "(null)");                                                                   \
    } while (0)

/* The name of the test that runs. */
const char *test_name(void);

/* For tests with the program in a real window, which need gray-gui, Xvfb, xvfb-run, xdotool and a window manager
 * (openbox). From then on the environment is that of a machine without a desktop. */
void test_need_window(void);

/* A new empty folder for this test; the working directory stays the repository root. The folder is removed when the
 * test ends, except that of a failed test under run --keep. TMPDIR names its parent folder, which also belongs to this
 * test.
 */
const char *test_folder(void);
/* The path of a name in it; the last eight results stay valid. */
const char *test_path(const char *name);
/* Whether the program under test was built with a sanitizer. */
bool test_has_sanitizer(void);
void test_write_file(const char *path, const void *data, size_t size);
void test_write_text(const char *path, const char *text);
/* Whole file, NUL-terminated, from malloc; NULL when it cannot be read. */
char *test_read_file(const char *path, size_t *size);

/* The program under test, as an absolute path: GRAY_TEST_BINARY, or the one that was built with the runner. */
const char *test_program(void);
/* Monotonic seconds, for limits after which a test gives up. */
double test_clock(void);
/* Waits for a child: its exit status, or 128 + signal. */
int test_status_of(pid_t child);
/* The one child of a process, or 0. */
pid_t test_child_of(pid_t process);
/* What the children that have ended used: processor time of all, and the largest memory of one. */
struct test_use {
    double seconds;
    long kibibytes;
};
struct test_use test_children_used(void);
/* Whether two files of test_folder() are there and have the same bytes. */
bool test_same_files(const char *one, const char *other);

/* Runs ./gray (of this config) in `folder` (NULL: test_folder()) with the words of `arguments` (split at blanks, no
 * quoting) and waits at most `seconds`. out and err are NUL-terminated, from malloc. */
struct test_result {
    int status; /* exit status, or 128 + signal */
    char *out, *err;
};
struct test_result test_gray(const char *folder, const char *arguments);
void test_free_result(struct test_result *result);
/* Runs a line of the shell in test_folder(), where $gray is the program under test, with redirections of the whole line
 * ("2>err.txt"); its exit status, or 128 + signal. In the line, await CONDITION waits until a command succeeds, as long
 * as the test may take; screen COMMAND runs it on a display of its own, whose number no other test tries at the same
 * time, and which does not reset when its first client goes before the second one is there (-noreset). */
int test_run_shell(const char *line, const char *redirections);
/* A line of the shell ends with `status`; out.txt has what it prints, `says` among it. */
void test_shell(const char *line, int status, const char *says);
/* A line of the shell ends with `status`; err.txt has what it prints on standard error, `says` among it, or nothing if
 * `says` is NULL. */
void test_shell_errors(const char *line, int status, const char *says);
/* The same with an environment addition "NAME=value" (or NULL) and a scene text written to scene.lua first (or NULL).
 */
struct test_result test_gray_scene(const char *scene_text, const char *arguments, const char *environment);

/* A picture read back through libpng: 8-bit RGB. */
struct test_picture {
    uint32_t width, height;
    uint8_t *rgb;
};
struct test_picture test_read_picture(const char *path);
/* Deterministic random numbers for tests. */
struct test_random {
    uint64_t state;
};
double test_uniform(struct test_random *random, double lo, double hi);

#endif
