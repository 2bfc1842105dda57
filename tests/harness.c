/* The runner: every test in a process of its own, several at a time, with a time limit, results told in order of
 * names. The environment GRAY_TEST_BINARY names the program under test. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include "base/fault.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <fnmatch.h>
#include <png.h>
#include <poll.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { STATUS_PASSED = 0, STATUS_FAILED = 1, STATUS_SKIPPED = 77, LIMIT_SECONDS = 300 };

static struct test *all_tests;
static int test_count;
/* Inside the process of one test. */
static int failures;
static char folder_path[256];
static const char *current_name = "test";

void test_register(struct test *test) {
    test->next = all_tests;
    all_tests = test;
    test_count++;
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

void test_skip(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    printf("    skipped: ");
    vprintf(format, arguments);
    printf("\n");
    va_end(arguments);
    fflush(stdout);
    _exit(failures ? STATUS_FAILED : STATUS_SKIPPED);
}

static void remove_tree(const char *path) {
    DIR *stream = opendir(path);
    if (stream) {
        for (struct dirent *entry; (entry = readdir(stream)) != NULL;) {
            if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
                continue;
            char inner[1024];
            (void)snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name);
            struct stat status;
            if (lstat(inner, &status) == 0 && S_ISDIR(status.st_mode))
                remove_tree(inner);
            else
                (void)unlink(inner);
        }
        (void)closedir(stream);
    }
    (void)rmdir(path);
}

void test_need_window(void) {
    const char *named = getenv("GRAY_TEST_BINARY"), *options = getenv("ASAN_OPTIONS");
    char text[4096];
    (void)snprintf(
        text, sizeof text,
        "test -x '%s-gui' && for tool in Xvfb xvfb-run xdotool; do command -v $tool || exit 1; done >/dev/null",
        named ? named : "build/release/gray");
    if (system(text) != 0)
        test_skip("there is no gray-gui beside the program, or no Xvfb, xvfb-run or xdotool");
    (void)snprintf(text, sizeof text, "%s%sdetect_leaks=0", options ? options : "", options ? ":" : "");
    (void)setenv("ASAN_OPTIONS", text, 1);
    (void)setenv("SDL_RENDER_DRIVER", "software", 1);
    (void)setenv("SDL_FRAMEBUFFER_ACCELERATION", "0", 1);
}

const char *test_folder(void) {
    if (!folder_path[0]) {
        const char *base = getenv("TMPDIR");
        (void)snprintf(folder_path, sizeof folder_path, "%s/gray-%.100s-XXXXXX", base ? base : "/tmp", current_name);
        if (!mkdtemp(folder_path)) {
            printf("    cannot make a folder: %s\n", strerror(errno));
            _exit(STATUS_FAILED);
        }
    }
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
    char binary[4096];
    const char *named = getenv("GRAY_TEST_BINARY");
    if (!realpath(named ? named : "build/release/gray", binary)) {
        test_fail(__FILE__, __LINE__, "the program under test is not there");
        _exit(STATUS_FAILED);
    }
    int out[2], err[2];
    if (pipe2(out, O_CLOEXEC) != 0 || pipe2(err, O_CLOEXEC) != 0)
        _exit(STATUS_FAILED);
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        static char *words[4096];
        char *copy = strdup(arguments);
        int count = 0;
        words[count++] = binary;
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
    int status;
    (void)waitpid(child, &status, 0);
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
}

struct test_result test_gray(const char *folder, const char *arguments) {
    if (!folder)
        folder = test_folder();
    return run_program(folder, arguments, NULL);
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

/* The runner. */
struct running {
    struct test *test;
    pid_t pid;
    int output;
    double started;
};

static double now(void) {
    struct timespec time;
    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static int by_name(const void *a, const void *b) {
    const struct test *x = *(struct test *const *)a, *y = *(struct test *const *)b;
    int order = strcmp(x->file, y->file);
    return order ? order : strcmp(x->name, y->name);
}

static void begin(struct running *slot, struct test *test) {
    char name[] = "/tmp/gray-test-output-XXXXXX";
    slot->output = mkstemp(name);
    (void)unlink(name);
    slot->test = test;
    slot->started = now();
    fflush(stdout);
    slot->pid = fork();
    if (slot->pid == 0) {
        (void)setpgid(0, 0);
        fault_apart(); /* what this test makes fail is not to fail in the test beside it */
        (void)dup2(slot->output, 1);
        (void)alarm(LIMIT_SECONDS * (test->is_long ? 12 : 1));
        current_name = test->name;
        test->run();
        fflush(stdout);
        if (folder_path[0] && failures == 0)
            remove_tree(folder_path);
        exit(failures ? STATUS_FAILED : STATUS_PASSED);
    }
}

int main(int argc, char **argv) {
    int jobs = 2;
    bool run_long = false, list = false;
    const char **patterns = calloc((size_t)argc, sizeof *patterns);
    int pattern_count = 0;
    if (!patterns)
        return 1;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "-j") == 0 && i + 1 < argc)
            jobs = atoi(argv[++i]);
        else if (strcmp(argv[i], "--long") == 0)
            run_long = true;
        else if (strcmp(argv[i], "--list") == 0)
            list = true;
        else
            patterns[pattern_count++] = argv[i];
    }
    jobs = jobs < 1 ? 1 : jobs > 64 ? 64 : jobs;
    struct test **chosen = calloc((size_t)test_count + 1, sizeof *chosen);
    int count = 0;
    for (struct test *test = all_tests; test; test = test->next) {
        bool wanted = pattern_count == 0;
        for (int i = 0; i < pattern_count; i++)
            wanted = wanted || strstr(test->name, patterns[i]) || strstr(test->file, patterns[i]) ||
                     fnmatch(patterns[i], test->name, 0) == 0;
        if (wanted && test->is_long == run_long)
            chosen[count++] = test;
    }
    free(patterns);
    qsort(chosen, (size_t)count, sizeof *chosen, by_name);
    if (list) {
        for (int i = 0; i < count; i++)
            printf("%s\t%s\n", chosen[i]->name, chosen[i]->file);
        return 0;
    }
    struct running slots[64] = {0};
    int next = 0, active = 0, passed = 0, failed = 0, skipped = 0;
    while (next < count || active > 0) {
        while (active < jobs && next < count) {
            int free_slot = 0;
            while (slots[free_slot].test)
                free_slot++;
            begin(&slots[free_slot], chosen[next++]);
            active++;
        }
        int status;
        pid_t done = wait(&status);
        if (done < 0)
            break;
        for (int i = 0; i < 64; i++) {
            struct running *slot = &slots[i];
            if (!slot->test || slot->pid != done)
                continue;
            int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
            const char *word = code == STATUS_PASSED ? "ok" : code == STATUS_SKIPPED ? "skipped" : "FAILED";
            printf("%-8s %s (%.1f s)\n", word, slot->test->name, now() - slot->started);
            if (code != STATUS_PASSED) {
                if (code < 0)
                    printf("    ended by signal %d (%s)%s\n", WTERMSIG(status), strsignal(WTERMSIG(status)),
                           WTERMSIG(status) == SIGALRM ? ": over its time limit" : "");
                char buffer[4096];
                (void)lseek(slot->output, 0, SEEK_SET);
                for (ssize_t got; (got = read(slot->output, buffer, sizeof buffer)) > 0;)
                    (void)fwrite(buffer, 1, (size_t)got, stdout);
            }
            (void)kill(-done, SIGKILL); /* whatever the test left running */
            (void)close(slot->output);
            slot->test = NULL;
            active--;
            passed += code == STATUS_PASSED;
            skipped += code == STATUS_SKIPPED;
            failed += code != STATUS_PASSED && code != STATUS_SKIPPED;
        }
        fflush(stdout);
    }
    free(chosen);
    printf("%d passed, %d failed, %d skipped\n", passed, failed, skipped);
    return failed ? 1 : 0;
}
