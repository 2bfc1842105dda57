/* The runner: every test in a process of its own, several at a time, with a time limit. The environment
 * GRAY_TEST_BINARY names the program under test; without it, it is the one beside the folder of the runner.
 *
 * Between the runner and each test stands a reaper, the parent of the test. It adopts every process whose parent dies
 * below it, so that none can leave its tree, whatever group or session it moves to. When the test has ended, or the
 * runner is gone, the reaper kills the rest of the tree and removes the folder of the test. Invariant: no process and
 * no folder of a test outlives the runner by more than a moment, even when the runner is ended by SIGKILL. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include "base/fault.h"
#include "formats/json_text.h"
#include "image/exr.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <fnmatch.h>
#include <png.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { STATUS_PASSED = 0, STATUS_FAILED = 1, STATUS_SKIPPED = 77, LIMIT_SECONDS = 300, JOBS_MAX = 64 };

static struct test *all_tests;
static int test_count;
/* State inside the process of one test. */
static int failures;
static const char *current_name;
static char folder_path[404]; /* created when it is first needed */
static bool folder_made;
static pid_t test_process;
static bool *starts_program; /* shared with the runner; NULL: the test may start programs */

void test_register(struct test *test) {
    test->next = all_tests;
    all_tests = test;
    test_count++;
}

bool test_is_named(const char *pattern) {
    const struct test *test = all_tests;
    while (test && fnmatch(pattern, test->name, 0) != 0)
        test = test->next;
    return test != NULL;
}

void test_fail(const char *file, int line, const char *format, ...) {
    if (++failures > 20)
        return;
    va_list arguments;
    va_start(arguments, format);
    printf("    %s:%d: ", file, line);
    vprintf(format, arguments);
    printf("\n");
    va_end(arguments);
    fflush(stdout);
}

/* The runner reads the last line with these words as the reason. */
#define SKIPPED "    skipped: "

static _Noreturn void end_skipped(bool failed, const char *format, va_list arguments) {
    printf(SKIPPED);
    vprintf(format, arguments);
    printf("\n");
    fflush(stdout);
    _exit(failed || failures ? STATUS_FAILED : STATUS_SKIPPED);
}

void test_skip(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    end_skipped(false, format, arguments);
}

void test_lacks(const char *format, ...) {
    const char *ci = getenv("GRAY_CI");
    va_list arguments;
    va_start(arguments, format);
    end_skipped(ci && ci[0] != '\0', format, arguments);
}

/* Called before a program starts, in any process of the test. */
static void before_program(void) {
    if (!starts_program)
        return;
    *starts_program = true;
    (void)kill(test_process, SIGKILL);
    _exit(127);
}

/* The linker gives every call of these functions here (--wrap), so that --fast needs no list of tests. */
int __wrap_system(const char *line);
int __real_system(const char *line);
int __wrap_execv(const char *path, char *const words[]);
int __real_execv(const char *path, char *const words[]);
int __wrap_execl(const char *path, const char *word, ...);
int __wrap_posix_spawnp(pid_t *child, const char *name, const posix_spawn_file_actions_t *actions,
                        const posix_spawnattr_t *attributes, char *const words[], char *const environment[]);
int __real_posix_spawnp(pid_t *child, const char *name, const posix_spawn_file_actions_t *actions,
                        const posix_spawnattr_t *attributes, char *const words[], char *const environment[]);

int __wrap_system(const char *line) {
    before_program();
    return __real_system(line);
}

int __wrap_execv(const char *path, char *const words[]) {
    before_program();
    return __real_execv(path, words);
}

int __wrap_execl(const char *path, const char *word, ...) {
    char *words[32] = {(char *)(uintptr_t)word};
    va_list rest;
    va_start(rest, word);
    for (size_t i = 1; i + 1 < sizeof words / sizeof *words && (words[i] = va_arg(rest, char *)) != NULL; i++)
        continue;
    va_end(rest);
    return __wrap_execv(path, words);
}

int __wrap_posix_spawnp(pid_t *child, const char *name, const posix_spawn_file_actions_t *actions,
                        const posix_spawnattr_t *attributes, char *const words[], char *const environment[]) {
    before_program();
    return __real_posix_spawnp(child, name, actions, attributes, words, environment);
}

unsigned test_slowness(void) {
    const char *given = getenv("GRAY_TEST_SLOWNESS");
    const int times = given ? atoi(given) : 1;
    return times > 1 && times < 1000 ? (unsigned)times : 1;
}

static bool is_on_path(const char *name) {
    const char *path = getenv("PATH");
    char *folders = strdup(path ? path : ""), *rest = NULL, file[4096];
    bool found = false;
    for (char *folder = strtok_r(folders, ":", &rest); folder && !found; folder = strtok_r(NULL, ":", &rest)) {
        (void)snprintf(file, sizeof file, "%s/%s", folder, name);
        found = access(file, X_OK) == 0;
    }
    free(folders);
    return found;
}

void test_need_tools(const char *names) {
    before_program();
    char *copy = strdup(names), *rest = NULL;
    for (char *name = strtok_r(copy, " ", &rest); name; name = strtok_r(NULL, " ", &rest)) {
        if (!is_on_path(name))
            test_lacks("%s is not installed", name);
    }
    free(copy);
}

void test_need_json(void) {
    if (strcmp(json_text_library(), "none") == 0)
        test_lacks("gray was built without jansson");
}

void test_need_exr(void) {
    if (!exr_can_write())
        test_lacks("gray was built without OpenEXR");
}

/* A program that is built where its library is installed: gray-mpi, gray-gui. */
static void need_program_beside(const char *suffix, const char *library) {
    char path[4200];
    before_program();
    (void)snprintf(path, sizeof path, "%s%s", test_program(), suffix);
    if (access(path, X_OK) != 0)
        test_lacks("there is no gray%s beside the program, which needs %s", suffix, library);
}

void test_need_mpi(void) {
    need_program_beside("-mpi", "MPI");
    test_need_tools("mpirun");
}

void test_need_gui(void) {
    need_program_beside("-gui", "GTK 4");
}

/* The temporary folder of the test is its home; the address of a bus and other environment of a desktop are gone. */
void test_need_window(void) {
    char home[4200];
    test_need_gui();
    test_need_tools("Xvfb xvfb-run xdotool openbox");
    (void)snprintf(home, sizeof home, "%s", test_folder());
    static const char *const names[] = {"HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME",
                                        "XDG_RUNTIME_DIR"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        (void)setenv(names[i], home, 1);
    (void)unsetenv("DBUS_SESSION_BUS_ADDRESS");
    (void)setenv("GDK_DEBUG", "gl-disable", 1);
    (void)setenv("GSK_RENDERER", "cairo", 1);
    (void)setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
}

const char *test_name(void) {
    return current_name;
}

bool test_has_sanitizer(void) {
    return strcmp(GRAY_CONFIG, "asan") == 0 || strcmp(GRAY_CONFIG, "tsan") == 0;
}

const char *test_folder(void) {
    if (!folder_made && mkdir(folder_path, 0700) != 0) {
        printf("    cannot make the folder %s: %s\n", folder_path, strerror(errno));
        fflush(stdout);
        _exit(STATUS_FAILED);
    }
    folder_made = true;
    return folder_path;
}

const char *test_path(const char *name) {
    static char paths[8][4096];
    static int next;
    char *path = paths[next++ % 8];
    (void)snprintf(path, sizeof paths[0], "%s/%s", test_folder(), name);
    return path;
}

void test_write_file(const char *path, const void *data, size_t size) {
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0)
        test_fail(__FILE__, __LINE__, "cannot write %s: %s", path, strerror(errno));
}

void test_write_text(const char *path, const char *text) {
    test_write_file(path, text, strlen(text));
}

char *test_read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    char *data = NULL;
    size_t have = 0, room = 0;
    for (;;) {
        if (room - have < 65536)
            data = realloc(data, room += 65536 + room);
        size_t got = fread(data + have, 1, room - have - 1, file);
        have += got;
        if (got == 0)
            break;
    }
    (void)fclose(file);
    data[have] = '\0';
    if (size)
        *size = have;
    return data;
}

bool test_same_files(const char *one, const char *other) {
    size_t a = 0, b = 0;
    char *x = test_read_file(test_path(one), &a), *y = test_read_file(test_path(other), &b);
    bool same = x && y && a == b && memcmp(x, y, a) == 0;
    free(x);
    free(y);
    return same;
}

double test_clock(void) {
    struct timespec time;
    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static int shell_status(int how) {
    return WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
}

int test_status_of(pid_t child) {
    int how = 0;
    while (waitpid(child, &how, 0) < 0 && errno == EINTR)
        continue;
    return shell_status(how);
}

pid_t test_child_of(pid_t process) {
    char path[64];
    (void)snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)process, (int)process);
    char *text = test_read_file(path, NULL);
    pid_t child = text ? (pid_t)atoi(text) : 0;
    free(text);
    return child;
}

struct test_use test_children_used(void) {
    struct rusage used;
    (void)getrusage(RUSAGE_CHILDREN, &used);
    return (struct test_use){(double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                                 1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec),
                             used.ru_maxrss};
}

const char *test_program(void) {
    const char *binary = getenv("GRAY_TEST_BINARY");
    if (!binary || access(binary, X_OK) != 0) {
        test_fail(__FILE__, __LINE__, "the program under test is not there");
        _exit(STATUS_FAILED);
    }
    return binary;
}

int test_run_shell(const char *line, const char *redirections) {
    char *command = NULL;
    if (asprintf(&command,
                 "await() { until eval \"$1\"; do sleep 0.01; done; }\n"
                 "screen() { timeout 300 xvfb-run -a -n $((100 + $$ %% 30000)) -s '-screen 0 1400x900x24 -noreset' "
                 "\"$@\"; }\n"
                 "cd '%s' && export gray='%s' && { %s\n} %s",
                 test_folder(), test_program(), line, redirections) < 0)
        exit(1);
    (void)fflush(stdout);
    int how = system(command);
    free(command);
    return shell_status(how);
}

/* says: NULL: nothing may be printed. */
static void expect_shell(const char *line, int status, const char *says, const char *redirections, const char *name) {
    int got = test_run_shell(line, redirections);
    char *said = test_read_file(test_path(name), NULL);
    if (got != status || !said || (says ? !strstr(said, says) : said[0] != '\0'))
        test_fail(__FILE__, __LINE__, "%s\nstatus %d, not %d, or not \"%s\":\n%s", line, got, status, says ? says : "",
                  said ? said : "");
    free(said);
}

void test_shell(const char *line, int status, const char *says) {
    expect_shell(line, status, says, ">out.txt 2>&1", "out.txt");
}

void test_shell_errors(const char *line, int status, const char *says) {
    expect_shell(line, status, says, "2>err.txt", "err.txt");
}

/* Collects two streams of a child until both end. */
static void collect(int out, int err, struct test_result *result) {
    struct pollfd streams[2] = {{.fd = out, .events = POLLIN}, {.fd = err, .events = POLLIN}};
    char *text[2] = {calloc(1, 1), calloc(1, 1)};
    size_t size[2] = {0, 0};
    int left = 2;
    while (left > 0 && poll(streams, 2, -1) >= 0) {
        for (int i = 0; i < 2; i++) {
            if (streams[i].fd < 0 || !streams[i].revents)
                continue;
            char buffer[65536];
            ssize_t got = read(streams[i].fd, buffer, sizeof buffer);
            if (got <= 0) {
                (void)close(streams[i].fd);
                streams[i].fd = -1;
                left--;
                continue;
            }
            text[i] = realloc(text[i], size[i] + (size_t)got + 1);
            memcpy(text[i] + size[i], buffer, (size_t)got);
            size[i] += (size_t)got;
            text[i][size[i]] = '\0';
        }
    }
    result->out = text[0];
    result->err = text[1];
}

static struct test_result run_program(const char *folder, const char *arguments, const char *environment) {
    struct test_result result = {0};
    const char *binary = test_program();
    int out[2], err[2];
    if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0)
        _exit(STATUS_FAILED);
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        static char *words[4096];
        char *copy = strdup(arguments);
        int count = 0;
        words[count++] = (char *)(uintptr_t)binary;
        for (char *word = strtok(copy, " "); word && count < 4095; word = strtok(NULL, " "))
            words[count++] = word;
        words[count] = NULL;
        if (environment)
            (void)putenv(strdup(environment));
        (void)dup2(out[1], 1);
        (void)dup2(err[1], 2);
        int null = open("/dev/null", O_RDONLY);
        (void)dup2(null, 0);
        if (chdir(folder ? folder : test_folder()) != 0)
            _exit(126);
        (void)execv(binary, words);
        _exit(127);
    }
    (void)close(out[1]);
    (void)close(err[1]);
    collect(out[0], err[0], &result);
    result.status = test_status_of(child);
    return result;
}

struct test_result test_gray(const char *folder, const char *arguments) {
    if (!folder)
        folder = test_folder();
    return run_program(folder, arguments, NULL);
}

void test_free_result(struct test_result *result) {
    free(result->out);
    free(result->err);
    *result = (struct test_result){0};
}

struct test_result test_gray_scene(const char *scene_text, const char *arguments, const char *environment) {
    const char *folder = test_folder();
    if (scene_text) {
        char path[512];
        (void)snprintf(path, sizeof path, "%s/scene.lua", folder);
        test_write_text(path, scene_text);
    }
    return run_program(folder, arguments, environment);
}

struct test_picture test_read_picture(const char *path) {
    struct test_picture picture = {0};
    png_image image = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_file(&image, path)) {
        test_fail(__FILE__, __LINE__, "%s: %s", path, image.message);
        return picture;
    }
    /* RGB as stored: asking for the file's own encoding avoids any gamma. */
    image.format = PNG_FORMAT_RGB;
    image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
    picture.rgb = malloc(PNG_IMAGE_SIZE(image));
    picture.width = image.width;
    picture.height = image.height;
    if (!png_image_finish_read(&image, NULL, picture.rgb, 0, NULL))
        test_fail(__FILE__, __LINE__, "%s: %s", path, image.message);
    return picture;
}

double test_uniform(struct test_random *random, double lo, double hi) {
    uint64_t z = (random->state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    z ^= z >> 31;
    return lo + (hi - lo) * ((double)(z >> 11) * 0x1p-53);
}

static void pause_milliseconds(long milliseconds) {
    const struct timespec pause = {0, milliseconds * 1000000};
    (void)nanosleep(&pause, NULL);
}

/* Removes `name` in the folder of the descriptor `at`, with all that is in it. */
static void remove_at(int at, const char *name) {
    if (unlinkat(at, name, 0) == 0 || errno == ENOENT)
        return;
    int folder = openat(at, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (folder < 0 && fchmodat(at, name, 0700, 0) == 0)
        folder = openat(at, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (folder < 0)
        return;
    (void)fchmod(folder, 0700);
    DIR *stream = fdopendir(folder);
    if (!stream) {
        (void)close(folder);
        return;
    }
    for (struct dirent *entry; (entry = readdir(stream)) != NULL;) {
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            remove_at(dirfd(stream), entry->d_name);
    }
    (void)closedir(stream);
    (void)unlinkat(at, name, AT_REMOVEDIR);
}

/* Processes. */

struct process {
    pid_t pid, parent;
    bool below; /* descends from the calling process, but not from one that is spared */
};

static bool read_process(const char *digits, struct process *process) {
    char path[64], text[512];
    int parent;
    (void)snprintf(path, sizeof path, "/proc/%.20s/stat", digits);
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return false;
    ssize_t got = read(file, text, sizeof text - 1);
    (void)close(file);
    text[got > 0 ? got : 0] = '\0';
    const char *end = strrchr(text, ')'); /* the name before it may contain anything */
    if (!end || sscanf(end, ") %*c %d", &parent) != 1)
        return false;
    *process = (struct process){.pid = (pid_t)atoi(digits), .parent = (pid_t)parent};
    return true;
}

/* All existing processes, from malloc; NULL if they cannot be listed. */
static struct process *list_processes(size_t *count) {
    struct process *list = NULL;
    size_t room = 0;
    DIR *stream = opendir("/proc");
    *count = 0;
    if (!stream)
        return NULL;
    for (struct dirent *entry; (entry = readdir(stream)) != NULL;) {
        if (entry->d_name[0] < '0' || entry->d_name[0] > '9')
            continue;
        if (*count == room) {
            struct process *larger = realloc(list, (room = 2 * room + 256) * sizeof *list);
            if (!larger)
                break;
            list = larger;
        }
        *count += read_process(entry->d_name, &list[*count]);
    }
    (void)closedir(stream);
    return list;
}

static bool is_one_of(pid_t pid, const pid_t *list, int count) {
    for (int i = 0; i < count; i++) {
        if (list[i] == pid)
            return true;
    }
    return false;
}

/* Sends a signal to every process below this one, except those that are spared and their descendants. Returns how many
 * there were. */
static int signal_descendants(int number, const pid_t *spared, int spared_count) {
    size_t count;
    struct process *list = list_processes(&count);
    int found = 0;
    bool more = list != NULL;
    while (more) {
        more = false;
        for (size_t i = 0; i < count; i++) {
            bool below = list[i].parent == getpid();
            for (size_t k = 0; k < count && !below; k++)
                below = list[k].below && list[k].pid == list[i].parent;
            if (list[i].below || !below || is_one_of(list[i].pid, spared, spared_count))
                continue;
            list[i].below = more = true;
            (void)kill(list[i].pid, number);
            found++;
        }
    }
    free(list);
    return found;
}

/* Ends every process below this one, which adopts orphans: first with SIGTERM, for servers that have files to remove,
 * then with SIGKILL. Returns when none is left, or after 10 seconds. */
static void end_descendants(void) {
    double begun = test_clock();
    bool asked = false;
    while (test_clock() - begun < 10) {
        pid_t got;
        while ((got = waitpid(-1, NULL, WNOHANG)) > 0)
            continue;
        if (got < 0 && errno == ECHILD)
            return;
        if (!asked || test_clock() - begun > 0.3)
            (void)signal_descendants(asked ? SIGKILL : SIGTERM, NULL, 0);
        asked = true;
        pause_milliseconds(5);
    }
}

/* The state in which a test starts: every signal that was ignored has its default action again, none is blocked, and
 * standard input is empty. */
static void reset_inheritance(void) {
    for (int number = 1; number < NSIG; number++) {
        struct sigaction action;
        if (sigaction(number, NULL, &action) == 0 && action.sa_handler == SIG_IGN)
            (void)signal(number, SIG_DFL);
    }
    sigset_t none;
    (void)sigemptyset(&none);
    (void)sigprocmask(SIG_SETMASK, &none, NULL);
    int null = open("/dev/null", O_RDONLY);
    if (null > 0) {
        (void)dup2(null, STDIN_FILENO);
        (void)close(null);
    }
}

/* The runner. */

struct running {
    struct test *test;
    pid_t reaper;
    int output;
    double started;
};

/* Of the test in a slot; shared with its reaper and the test itself. */
struct outcome {
    int status;          /* as waitpid gives it; -1: none yet */
    double processor;    /* seconds of the test and its processes */
    bool starts_program; /* with --fast: it was about to start one, and was ended */
};

/* Why tests were skipped. */
struct reason {
    char *text;
    int count;
};

struct runner {
    char folder[256]; /* of this run */
    struct outcome *outcomes;
    sigset_t awaited; /* signals that the runner waits for, blocked otherwise */
    FILE *log;        /* or NULL */
    char *title;      /* the words of the command line, which ps shows; a reaper has another one */
    size_t title_size;
    bool keep;    /* folders of failed tests are kept */
    bool fast;    /* tests that start a program are left out */
    bool strays;  /* a reaper was killed: its descendants must be ended */
    int ended_by; /* a signal, or 0 */
    double begun, next_progress, progress_seconds;
    int chosen, begun_tests, ended, passed, failed, skipped, left_out;
    struct reason *reasons;
    int reason_count;
    struct running slots[JOBS_MAX];
};

/* quiet: if there is a log, this line does not go to the screen. */
static void print_text(struct runner *runner, bool quiet, const char *text, size_t size) {
    if (runner->log)
        (void)fwrite(text, 1, size, runner->log);
    if (!runner->log || !quiet)
        (void)fwrite(text, 1, size, stdout);
}

__attribute__((format(printf, 3, 4))) static void print_line(struct runner *runner, bool quiet, const char *format,
                                                             ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    print_text(runner, quiet, text, strlen(text));
}

/* The command line that ps shows for this process: a search for the runner's command line does not find its reapers. */
static void set_title(const struct runner *runner, const char *title) {
    (void)prctl(PR_SET_NAME, title);
    memset(runner->title, 0, runner->title_size);
    (void)snprintf(runner->title, runner->title_size, "%s", title);
}

static _Noreturn void run_test(const struct runner *runner, const struct running *slot, const char *above,
                               pid_t reaper) {
    if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || getppid() != reaper)
        _exit(STATUS_FAILED);
    (void)setpgid(0, 0);
    set_title(runner, slot->test->name);
    reset_inheritance();
    fault_apart(); /* a failure that this test requests must not occur in another test */
    (void)dup2(slot->output, STDOUT_FILENO);
    (void)dup2(slot->output, STDERR_FILENO);
    (void)alarm(LIMIT_SECONDS * test_slowness() * (slot->test->kind == TEST_SLOW ? 12 : 1));
    (void)snprintf(folder_path, sizeof folder_path, "%s/%.100s", above, slot->test->name);
    (void)setenv("TMPDIR", above, 1);
    if (runner->log)
        (void)fclose(runner->log);
    current_name = slot->test->name;
    test_process = getpid();
    if (runner->fast)
        starts_program = &runner->outcomes[slot - runner->slots].starts_program;
    slot->test->run();
    fflush(stdout);
    exit(failures ? STATUS_FAILED : STATUS_PASSED);
}

/* Waits until the test has ended or the runner asks to end it. Returns its status, or -1. */
static int await_test(pid_t test) {
    sigset_t awaited;
    (void)sigemptyset(&awaited);
    (void)sigaddset(&awaited, SIGCHLD);
    (void)sigaddset(&awaited, SIGTERM);
    for (;;) {
        int status;
        for (pid_t got; (got = waitpid(-1, &status, WNOHANG)) > 0;) {
            if (got == test)
                return status;
        }
        if (sigwaitinfo(&awaited, NULL) == SIGTERM)
            return -1;
    }
}

static double processor_of_children(void) {
    struct rusage usage = {0};
    (void)getrusage(RUSAGE_CHILDREN, &usage);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/* Never returns. SIGTERM, which is blocked, asks to end the test; the kernel sends it when the runner is gone. */
static _Noreturn void reap_test(struct runner *runner, int index, pid_t runner_pid) {
    struct running *slot = &runner->slots[index];
    char above[300];
    sigset_t blocked;
    (void)sigemptyset(&blocked);
    (void)sigaddset(&blocked, SIGCHLD);
    (void)sigaddset(&blocked, SIGTERM);
    (void)sigprocmask(SIG_BLOCK, &blocked, NULL);
    (void)prctl(PR_SET_PDEATHSIG, SIGTERM);
    (void)prctl(PR_SET_CHILD_SUBREAPER, 1);
    (void)setpgid(0, 0);
    set_title(runner, "test-reaper");
    int status = -1;
    (void)snprintf(above, sizeof above, "%s/%d", runner->folder, runner->begun_tests);
    /* The mode of /tmp: a test may become another user. */
    if (getppid() == runner_pid && mkdir(above, 0700) == 0 && chmod(above, 01777) == 0) {
        pid_t reaper = getpid(), test = fork();
        if (test == 0)
            run_test(runner, slot, above, reaper);
        if (test > 0)
            status = await_test(test);
    }
    runner->outcomes[index].status = status;
    end_descendants();
    runner->outcomes[index].processor = processor_of_children();
    bool passed = status >= 0 && WIFEXITED(status) && WEXITSTATUS(status) != STATUS_FAILED;
    if (passed || !runner->keep)
        remove_at(AT_FDCWD, above);
    if (getppid() != runner_pid)
        (void)rmdir(runner->folder); /* the last reaper finds it empty */
    _exit(0);
}

/* What the test has printed; from malloc. */
static char *read_output(const struct running *slot, size_t *size) {
    off_t end = lseek(slot->output, 0, SEEK_END);
    char *text = calloc(1, end > 0 ? (size_t)end + 1 : 1);
    ssize_t got = text && end > 0 ? pread(slot->output, text, (size_t)end, 0) : 0;
    *size = got > 0 ? (size_t)got : 0;
    return text;
}

static void note_reason(struct runner *runner, const char *output) {
    const char *found = NULL;
    for (const char *next = output; next && (next = strstr(next, SKIPPED)) != NULL;)
        found = next += sizeof SKIPPED - 1;
    if (!found)
        return;
    size_t length = strcspn(found, "\n");
    for (int i = 0; i < runner->reason_count; i++) {
        struct reason *reason = &runner->reasons[i];
        if (strlen(reason->text) == length && strncmp(reason->text, found, length) == 0) {
            reason->count++;
            return;
        }
    }
    struct reason *more = realloc(runner->reasons, (size_t)(runner->reason_count + 1) * sizeof *more);
    char *text = strndup(found, length);
    if (!more || !text)
        exit(1);
    runner->reasons = more;
    runner->reasons[runner->reason_count++] = (struct reason){text, 1};
}

/* One line for all skipped tests, and one for those that --fast leaves out. */
static void show_skipped(struct runner *runner) {
    char number[32];
    for (int i = 0; i < runner->reason_count; i++) {
        const struct reason *reason = &runner->reasons[i];
        if (i == 0)
            print_line(runner, false, "%d skipped: ", runner->skipped);
        print_text(runner, false, reason->text, strlen(reason->text));
        (void)snprintf(number, sizeof number, " (%d)%s", reason->count, i + 1 < runner->reason_count ? "; " : "\n");
        print_text(runner, false, number, strlen(number));
    }
    if (runner->fast)
        print_line(runner, false, "%d left out, which start a program\n", runner->left_out);
}

/* Prints how a test has ended, and counts it. */
static void report_test(struct runner *runner, const struct running *slot, const struct outcome *outcome) {
    int status = outcome->status, code = status >= 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    bool passed = code == STATUS_PASSED, skipped = code == STATUS_SKIPPED;
    size_t size;
    char *output = read_output(slot, &size);
    print_line(runner, passed || skipped, "%-8s %s (%.1f s, processor %.1f s)\n",
               passed    ? "ok"
               : skipped ? "skipped"
                         : "FAILED",
               slot->test->name, test_clock() - slot->started, outcome->processor);
    if (status < 0)
        print_line(runner, false, "    its reaper was killed, or could not start it\n");
    else if (code < 0)
        print_line(runner, false, "    ended by signal %d (%s)%s\n", WTERMSIG(status), strsignal(WTERMSIG(status)),
                   WTERMSIG(status) == SIGALRM ? ": over its time limit" : "");
    if (skipped)
        note_reason(runner, output);
    else if (output && (!passed || slot->test->kind == TEST_SLOW))
        print_text(runner, false, output, size);
    runner->passed += passed;
    runner->skipped += skipped;
    runner->failed += !passed && !skipped;
    free(output);
}

static void end_test(struct runner *runner, int index) {
    struct running *slot = &runner->slots[index];
    const struct outcome *outcome = &runner->outcomes[index];
    slot->reaper = 0;
    if (outcome->starts_program) {
        runner->left_out++;
        runner->ended++;
    } else if (runner->ended_by == 0 || outcome->status >= 0) {
        report_test(runner, slot, outcome);
        runner->ended++;
    }
    (void)close(slot->output);
    slot->test = NULL;
}

static void begin_test(struct runner *runner, struct test *test) {
    int index = 0;
    while (runner->slots[index].test)
        index++;
    struct running *slot = &runner->slots[index];
    pid_t runner_pid = getpid();
    *slot = (struct running){.test = test, .started = test_clock()};
    slot->output = memfd_create("output", MFD_CLOEXEC);
    runner->outcomes[index] = (struct outcome){.status = -1};
    runner->begun_tests++;
    (void)fflush(NULL);
    slot->reaper = fork();
    if (slot->reaper == 0)
        reap_test(runner, index, runner_pid);
    if (slot->reaper < 0)
        end_test(runner, index);
}

/* Collects ended reapers, and processes whose reaper is gone. */
static void reap(struct runner *runner) {
    int how;
    for (pid_t done; (done = waitpid(-1, &how, WNOHANG)) > 0;) {
        for (int i = 0; i < JOBS_MAX; i++) {
            if (runner->slots[i].test && runner->slots[i].reaper == done) {
                runner->strays = runner->strays || how != 0;
                end_test(runner, i);
            }
        }
    }
    if (!runner->strays)
        return;
    pid_t reapers[JOBS_MAX];
    for (int i = 0; i < JOBS_MAX; i++)
        reapers[i] = runner->slots[i].reaper;
    runner->strays = signal_descendants(SIGKILL, reapers, JOBS_MAX) > 0;
}

static int active_tests(const struct runner *runner) {
    int active = 0;
    for (int i = 0; i < JOBS_MAX; i++)
        active += runner->slots[i].test != NULL;
    return active;
}

static void show_progress(struct runner *runner) {
    if (test_clock() >= runner->next_progress) {
        printf("   %d of %d tests, %.0f s\n", runner->ended, runner->chosen, test_clock() - runner->begun);
        runner->next_progress = test_clock() + runner->progress_seconds;
    }
    if (runner->log)
        (void)fflush(runner->log);
    if (fflush(stdout) != 0 && !runner->ended_by) /* the reader is gone */
        runner->ended_by = SIGPIPE;
}

/* Until a child ends, a signal comes or a line of progress is due. */
static void await_signal(struct runner *runner) {
    double wait = runner->strays ? 0.01 : runner->next_progress - test_clock();
    wait = wait < 0 ? 0 : wait;
    const struct timespec timeout = {(time_t)wait, (long)((wait - (double)(time_t)wait) * 1e9)};
    int number = sigtimedwait(&runner->awaited, NULL, &timeout);
    if (number > 0 && number != SIGCHLD)
        runner->ended_by = number;
}

static void run_tests(struct runner *runner, struct test **tests, int jobs) {
    bool ending = false;
    runner->begun = test_clock();
    runner->next_progress = runner->begun + runner->progress_seconds;
    for (;;) {
        while (!runner->ended_by && runner->begun_tests < runner->chosen && active_tests(runner) < jobs)
            begin_test(runner, tests[runner->begun_tests]);
        for (int i = 0; i < JOBS_MAX && runner->ended_by && !ending; i++) {
            if (runner->slots[i].test)
                (void)kill(runner->slots[i].reaper, SIGTERM);
        }
        ending = runner->ended_by != 0;
        if (active_tests(runner) == 0 && !runner->strays)
            return;
        await_signal(runner);
        reap(runner);
        show_progress(runner);
    }
}

/* Signals that are ignored at the start (nohup, background jobs of a shell) stay ignored here, but not in the tests. */
static void listen_to_signals(struct runner *runner) {
    static const int ending[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT};
    (void)sigemptyset(&runner->awaited);
    (void)sigaddset(&runner->awaited, SIGCHLD);
    for (size_t i = 0; i < sizeof ending / sizeof *ending; i++) {
        struct sigaction action;
        if (sigaction(ending[i], NULL, &action) == 0 && action.sa_handler != SIG_IGN)
            (void)sigaddset(&runner->awaited, ending[i]);
    }
    (void)signal(SIGCHLD, SIG_DFL);
    (void)signal(SIGPIPE, SIG_IGN);
    (void)sigprocmask(SIG_BLOCK, &runner->awaited, NULL);
}

static bool start_runner(struct runner *runner) {
    const char *base = getenv("TMPDIR"), *progress = getenv("GRAY_TEST_PROGRESS");
    runner->progress_seconds = progress && atof(progress) > 0 ? atof(progress) : 15;
    runner->outcomes =
        mmap(NULL, JOBS_MAX * sizeof *runner->outcomes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    (void)snprintf(runner->folder, sizeof runner->folder, "%.200s/gray-XXXXXX", base && base[0] ? base : "/tmp");
    if (runner->outcomes == MAP_FAILED || !mkdtemp(runner->folder) || chmod(runner->folder, 0711) != 0) {
        (void)fprintf(stderr, "%s: cannot be made: %s\n", runner->folder, strerror(errno));
        return false;
    }
    (void)prctl(PR_SET_CHILD_SUBREAPER, 1);
    listen_to_signals(runner);
    return true;
}

/* The status of the program; a runner that was ended by a signal ends by that signal. */
static int finish_runner(struct runner *runner) {
    end_descendants();
    show_skipped(runner);
    if (runner->keep && runner->failed > 0 && rmdir(runner->folder) != 0)
        print_line(runner, false, "the folders of tests that failed are in %s\n", runner->folder);
    else
        remove_at(AT_FDCWD, runner->folder);
    if (runner->ended_by)
        print_line(runner, false, "ended by signal %d (%s) after %d of %d tests\n", runner->ended_by,
                   strsignal(runner->ended_by), runner->ended, runner->chosen);
    else
        print_line(runner, true, "%d passed, %d failed, %d skipped\n", runner->passed, runner->failed, runner->skipped);
    bool written = fflush(stdout) == 0 && (!runner->log || fclose(runner->log) == 0);
    if (runner->ended_by) {
        (void)signal(runner->ended_by, SIG_DFL);
        sigset_t none;
        (void)sigemptyset(&none);
        (void)raise(runner->ended_by);
        (void)sigprocmask(SIG_SETMASK, &none, NULL);
    }
    return runner->failed || runner->ended_by || !written ? 1 : 0;
}

static int by_name(const void *a, const void *b) {
    const struct test *x = *(struct test *const *)a, *y = *(struct test *const *)b;
    int order = strcmp(x->file, y->file);
    return order ? order : strcmp(x->name, y->name);
}

static bool has_word(const struct test *test, const char *word) {
    return strstr(test->name, word) || strstr(test->file, word) || fnmatch(word, test->name, 0) == 0;
}

/* The tests of a kind that match a pattern, or all, without those that match a pattern after a dash, in order of names;
 * from malloc. */
static struct test **choose_tests(enum test_kind kind, const char *const *patterns, int pattern_count, int *count) {
    struct test **chosen = calloc((size_t)test_count + 1, sizeof *chosen);
    *count = 0;
    for (struct test *test = all_tests; test && chosen; test = test->next) {
        bool wanted = false, all = true, left_out = false;
        for (int i = 0; i < pattern_count; i++) {
            if (patterns[i][0] == '-') {
                left_out = left_out || has_word(test, patterns[i] + 1);
            } else {
                all = false;
                wanted = wanted || has_word(test, patterns[i]);
            }
        }
        if ((wanted || all) && !left_out && test->kind == kind)
            chosen[(*count)++] = test;
    }
    if (chosen)
        qsort(chosen, (size_t)*count, sizeof *chosen, by_name);
    return chosen;
}

static const char help[] =
    "run [option ...] [word ...]: runs the tests whose name or file contains a word, or whose name matches it as a\n"
    "pattern of the shell, or all; without those of -WORD.\n"
    "  -j N        N tests at a time (2)\n"
    "  --fast      leaves out tests that start a program\n"
    "  --long      the tests of make test-long\n"
    "  --examples  the tests of this runner\n"
    "  --list      only prints names and files\n"
    "  --keep      keeps the folders of tests that fail\n"
    "  --log FILE  writes all lines into FILE, and on the screen what fails and is skipped\n"
    "  --help      prints this\n"
    "Environment: GRAY_TEST_BINARY=FILE is the program under test; GRAY_TEST_PROGRESS=S prints progress every S "
    "seconds;\n"
    "GRAY_TEST_SLOWNESS=N multiplies time limits, for an emulator;\n"
    "GRAY_CI=1 makes a test fail that lacks what tools/setup.sh --tests installs.\n"
    "Status: 0 nothing failed, 1 a test failed, 2 wrong usage.\n";

/* What the command line asks for. */
struct request {
    enum test_kind kind;
    const char **words;
    int word_count, jobs;
    const char *log;
    bool list, keep, fast, help;
};

/* One word, with its value where it has one: false if it is no option and no word for a test. */
static bool read_word(struct request *request, const char *word, const char *value, int *used) {
    char *end;
    *used = 1;
    if (strcmp(word, "-j") == 0 && value) {
        request->jobs = (int)strtol(value, &end, 10);
        *used = 2;
        return end != value && *end == '\0';
    }
    if (strcmp(word, "--log") == 0 && value) {
        request->log = value;
        *used = 2;
    } else if (strcmp(word, "--long") == 0) {
        request->kind = TEST_SLOW;
    } else if (strcmp(word, "--examples") == 0) {
        request->kind = TEST_EXAMPLE;
    } else if (strcmp(word, "--list") == 0) {
        request->list = true;
    } else if (strcmp(word, "--keep") == 0) {
        request->keep = true;
    } else if (strcmp(word, "--fast") == 0) {
        request->fast = true;
    } else if (strcmp(word, "--help") == 0) {
        request->help = true;
    } else if (strncmp(word, "--", 2) == 0 || (word[0] == '-' && strlen(word) <= 2)) {
        return false;
    } else {
        request->words[request->word_count++] = word;
    }
    return true;
}

/* The program under test is the one beside the folder of the runner (build/CONFIG/tests/run), unless the environment
 * names another. */
static void name_program(void) {
    const char *named = getenv("GRAY_TEST_BINARY");
    char beside[4096], path[4096];
    ssize_t length = readlink("/proc/self/exe", beside, sizeof beside - 16);
    beside[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(beside, '/');
    if (slash)
        (void)strcpy(slash, "/../gray");
    if (realpath(named ? named : beside, path))
        (void)setenv("GRAY_TEST_BINARY", path, 1);
}

static int run_chosen(struct runner *runner, const struct request *request, struct test **chosen) {
    if (request->list) {
        for (int i = 0; i < runner->chosen; i++)
            printf("%s\t%s\n", chosen[i]->name, chosen[i]->file);
        return 0;
    }
    if (request->log && !(runner->log = fopen(request->log, "we"))) {
        (void)fprintf(stderr, "%s: cannot be written: %s\n", request->log, strerror(errno));
        return 1;
    }
    name_program();
    if (!start_runner(runner))
        return 1;
    run_tests(runner, chosen, request->jobs < 1 ? 1 : request->jobs > JOBS_MAX ? JOBS_MAX : request->jobs);
    return finish_runner(runner);
}

int main(int argc, char **argv) {
    static struct runner runner;
    struct request request = {.jobs = 2, .words = calloc((size_t)argc, sizeof *request.words)};
    if (!request.words)
        return 1;
    for (int i = 1, used; i < argc; i += used) {
        if (!read_word(&request, argv[i], argv[i + 1], &used)) {
            (void)fprintf(stderr, "run: %s is no option, or its value is missing or wrong; --help lists them\n",
                          argv[i]);
            return 2;
        }
    }
    if (request.help) {
        (void)fputs(help, stdout);
        return 0;
    }
    struct test **chosen = choose_tests(request.kind, request.words, request.word_count, &runner.chosen);
    runner.keep = request.keep;
    runner.fast = request.fast;
    runner.title = argv[0];
    runner.title_size = (size_t)(argv[argc - 1] + strlen(argv[argc - 1]) - argv[0]);
    int status = chosen ? run_chosen(&runner, &request, chosen) : 1;
    free(request.words);
    free(chosen);
    return status;
}
