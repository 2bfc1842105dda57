/* The folders of a scene: which paths are below them and which are not, in every spelling; with old and new kernels,
 * and with a failure of each system call. */
#define _GNU_SOURCE
#include "base/path_policy.h"

#include "base/fault.h"
#include "host/confine.h"
#include "tests/harness.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* below/inner.txt, below/.hidden, below/link -> outside.txt, below/to -> inner.txt, below/gone -> nothing; outside.txt
 */
static void prepare(void) {
    CHECK(mkdir(test_path("below"), 0777) == 0 && mkdir(test_path("below/sub"), 0777) == 0);
    test_write_text(test_path("below/inner.txt"), "inner");
    test_write_text(test_path("below/.hidden"), "hidden");
    test_write_text(test_path("outside.txt"), "outside");
    test_write_text(test_path("below2.txt"), "beside");
    CHECK(symlink(test_path("outside.txt"), test_path("below/link")) == 0);
    CHECK(symlink("inner.txt", test_path("below/to")) == 0);
    CHECK(symlink("nothing", test_path("below/gone")) == 0);
    CHECK(mkfifo(test_path("below/pipe"), 0666) == 0);
}

static bool can_open(const struct path_policy *path_policy, const char *name, const char *mode) {
    FILE *stream = path_policy_stream(path_policy, test_path(name), mode);
    if (stream)
        (void)fclose(stream);
    return stream != NULL;
}

TEST(a_scene_reaches_what_lies_below_its_folders_by_any_spelling) {
    struct path_policy path_policy = {0};
    struct error error;
    prepare();
    CHECK(path_policy_add(&path_policy, test_path("below"), PATH_POLICY_IMPLIED, &error));
    CHECK(path_policy_is_readable(&path_policy, test_path("below/inner.txt")));
    CHECK(path_policy_is_readable(&path_policy, test_path("below/./sub/..//inner.txt")));
    CHECK(path_policy_is_readable(&path_policy, test_path("below/to")));
    CHECK(!path_policy_is_readable(&path_policy, test_path("below/.hidden")) &&
          !path_policy_is_readable(&path_policy, test_path("below/link")));
    CHECK(!path_policy_is_readable(&path_policy, test_path("outside.txt")) &&
          !path_policy_is_readable(&path_policy, test_path("below2.txt")));
    CHECK(!path_policy_is_readable(&path_policy, test_path("below")) &&
          !path_policy_is_readable(&path_policy, test_path("below/sub")));
    CHECK(path_policy_is_outside(&path_policy, test_path("outside.txt")) && path_policy_is_outside(&path_policy, "x") &&
          path_policy_is_outside(&path_policy, "../../../../../../../../../../..") &&
          !path_policy_is_outside(NULL, "/etc/passwd"));
    CHECK(!path_policy_is_outside(&path_policy, test_path("below/./x/")) &&
          !path_policy_is_outside(&path_policy, test_path("below/.x/../y")) == 1);
    CHECK(can_open(&path_policy, "below/inner.txt", "r") && can_open(&path_policy, "below/inner.txt", "rb"));
    CHECK(!can_open(&path_policy, "below/inner.txt", "w") && !can_open(&path_policy, "below/inner.txt", "r+"));
    CHECK(!can_open(&path_policy, "below/inner.txt", "x") && errno == EINVAL);
    CHECK(!can_open(&path_policy, "below/pipe", "r") && !can_open(&path_policy, "below/missing", "r"));
    CHECK(!can_open(&path_policy, "below/sub", "r") && !can_open(&path_policy, "below/link", "r"));
    char *much = malloc(6000);
    memset(much, 'x', 5999);
    much[5999] = '\0';
    CHECK(path_policy_is_outside(&path_policy, much) && !path_policy_is_readable(&path_policy, much));
    free(much);
    path_policy_destroy(&path_policy);
}

TEST(a_folder_that_may_be_written_takes_files_and_gives_none_away) {
    struct path_policy path_policy = {0};
    struct error error;
    prepare();
    CHECK(path_policy_add(&path_policy, test_path("below"), PATH_POLICY_WRITE, &error));
    CHECK(path_policy_add(&path_policy, test_path("below/sub/.."), PATH_POLICY_IMPLIED, &error) &&
          path_policy.count == 1);
    CHECK(can_open(&path_policy, "below/new.txt", "w") && can_open(&path_policy, "below/new.txt", "a+"));
    CHECK(can_open(&path_policy, "below/sub/x.txt", "w+") && can_open(&path_policy, "below/to", "r+"));
    CHECK(!can_open(&path_policy, "below/link", "w") && !can_open(&path_policy, "below/gone", "w"));
    CHECK(!can_open(&path_policy, "below/", "w") && !can_open(&path_policy, "below/.", "w") &&
          !can_open(&path_policy, "below/..", "w"));
    CHECK(!can_open(&path_policy, "below/no/x", "w") && !can_open(&path_policy, "outside.txt", "w"));
    char *much = malloc(6000);
    (void)snprintf(much, 6000, "%s/below/%0200d", test_folder(), 7);
    while (strlen(much) + 3 < PATH_MAX)
        (void)strcat(much, "x/");
    CHECK(!path_policy_stream(&path_policy, much, "w"));
    (void)snprintf(much, 6000, "%s/below/%04000d", test_folder(), 7);
    CHECK(!path_policy_stream(&path_policy, much, "w"));
    (void)snprintf(much, 6000, "%s", "./");
    memset(much + 2, 'y', 4090);
    much[4092] = '\0';
    CHECK(!path_policy_remove(&path_policy, much) &&
          !path_policy_may_create(&path_policy, strcat(much, "yyyyyyyyyyyyyyyy")));
    free(much);
    CHECK(path_policy_rename(&path_policy, test_path("below/new.txt"), test_path("below/other.txt")));
    CHECK(!path_policy_rename(&path_policy, test_path("below/other.txt"), test_path("outside.txt")));
    CHECK(!path_policy_rename(&path_policy, test_path("outside.txt"), test_path("below/x")));
    CHECK(!path_policy_rename(&path_policy, test_path("below/missing"), test_path("below/x")));
    CHECK(path_policy_remove(&path_policy, test_path("below/other.txt")) &&
          !path_policy_remove(&path_policy, test_path("below/other.txt")));
    CHECK(!path_policy_remove(&path_policy, test_path("outside.txt")) &&
          !path_policy_remove(&path_policy, test_path("no/such")));
    CHECK(!path_policy_remove(&path_policy, test_path("below/")) && errno == EINVAL);
    CHECK(!path_policy_remove(&path_policy, test_path("below/.")) && errno == EINVAL);
    CHECK(!path_policy_remove(&path_policy, test_path("below/..")) && errno == EINVAL);
    CHECK(path_policy_may_create(&path_policy, test_path("below/a/b/c.png")) &&
          path_policy_may_create(&path_policy, test_path("below/x.png")));
    CHECK(!path_policy_may_create(&path_policy, test_path("below/.x.png")) &&
          !path_policy_may_create(&path_policy, test_path("below/a/../x")));
    CHECK(!path_policy_may_create(&path_policy, test_path("below/a/.x")) &&
          !path_policy_may_create(&path_policy, test_path("x.png")));
    CHECK(!path_policy_may_create(&path_policy, test_path("below/no/../../x")) &&
          !path_policy_may_create(&path_policy, "../x"));
    CHECK(!path_policy_may_create(&path_policy, test_path("below/inner.txt/x")) &&
          !path_policy_may_create(&path_policy, "/x"));
    CHECK(!path_policy_may_create(&path_policy, test_path("below/a/..")) && !path_policy_may_create(&path_policy, "x"));
    /* hidden folders that exist */
    CHECK(mkdir(test_path("below/.own"), 0777) == 0 && mkdir(test_path("below/sub/.own"), 0777) == 0);
    CHECK(!path_policy_may_create(&path_policy, test_path("below/.own/x")) &&
          !path_policy_may_create(&path_policy, test_path("below/sub/.own/x")));
    FILE *everywhere = path_policy_stream(NULL, test_path("outside2.txt"), "w");
    CHECK(everywhere && fclose(everywhere) == 0);
    path_policy_destroy(&path_policy);
}

TEST(folders_that_are_none_are_reported_or_left_out) {
    struct path_policy path_policy = {0};
    struct error error = {0};
    char *much = malloc(6000);
    prepare();
    CHECK(path_policy_add(&path_policy, test_path("nothing"), PATH_POLICY_IMPLIED, &error) && path_policy.count == 0);
    CHECK(path_policy_add(&path_policy, "/", PATH_POLICY_IMPLIED, &error) && path_policy.count == 0);
    CHECK(!path_policy_add(&path_policy, test_path("nothing"), PATH_POLICY_READ, &error) && error.kind == ERROR_USAGE);
    CHECK(!path_policy_add(&path_policy, test_path("outside.txt"), PATH_POLICY_READ, &error) &&
          error.kind == ERROR_USAGE);
    CHECK(path_policy_add(&path_policy, "/", PATH_POLICY_READ, &error) && path_policy.count == 1 &&
          path_policy.folders[0].length == 0);
    CHECK(path_policy_is_readable(&path_policy, test_path("outside.txt")) &&
          path_policy_is_readable(&path_policy, test_path("below/.hidden")));
    memset(much, 'x', 5000);
    strcpy(much + 5000, "/scene.lua");
    CHECK(!path_policy_add_scene(&path_policy, much, NULL, &error) && strstr(error.text, "the path is too long"));
    CHECK(!path_policy_add_scene(&path_policy, "scene.lua", test_path("nothing"), &error));
    CHECK(path_policy_add_scene(&path_policy, test_path("below/scene.lua"), NULL, &error));
    CHECK(path_policy_is_readable(NULL, test_path("outside.txt")));
    free(much);
    path_policy_destroy(&path_policy);
}

TEST(any_allocation_or_call_may_fail_while_files_are_reached) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    prepare();
    for (int kind = 0; kind < 2; kind++)
        for (uint64_t k = 1, over = 0; !over; k++) {
            struct path_policy path_policy = {0};
            struct error error = {0};
            struct file_bytes bytes;
            uint64_t before = fault_count((enum fault_kind)kind);
            fault_at((enum fault_kind)kind, k);
            bool ok = path_policy_add_scene(&path_policy, test_path("below/scene.lua"), "lua", &error) &&
                      path_policy_add(&path_policy, test_path("below"), PATH_POLICY_WRITE, &error);
            CHECK(ok || error.text[0]);
            if (ok && path_policy_map(&path_policy, test_path("below/inner.txt"), 100, &bytes, &error))
                file_unmap(&bytes);
            (void)can_open(&path_policy, "below/new.txt", "w");
            (void)can_open(NULL, "below/new.txt", "r");
            fault_at((enum fault_kind)kind, 0);
            over = fault_count((enum fault_kind)kind) - before < k;
            path_policy_destroy(&path_policy);
        }
}

/* In a removed folder no path is valid. */
TEST(a_working_directory_that_is_gone_holds_nothing) {
    struct path_policy path_policy = {0};
    struct error error;
    prepare();
    CHECK(path_policy_add(&path_policy, test_path("below"), PATH_POLICY_WRITE, &error));
    CHECK(mkdir(test_path("gone"), 0777) == 0);
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        const char *gone = test_path("gone");
        if (chdir(gone) != 0 || rmdir(gone) != 0)
            _exit(1);
        _exit(path_policy_is_outside(&path_policy, "x") && !path_policy_may_create(&path_policy, "x") ? 0 : 2);
    }
    int how = 0;
    CHECK(waitpid(child, &how, 0) == child && WIFEXITED(how) && WEXITSTATUS(how) == 0);
    path_policy_destroy(&path_policy);
}

#ifdef GRAY_FAULTS
static char race_from[600], race_to[600], race_kept[600];

/* The file is moved away, and a link that leads out replaces it. */
static void exchange_names(void) {
    (void)rename(race_from, race_kept);
    (void)rename(race_to, race_from);
}

/* In below/sub or outer, which have names of the same length or not, with the kernel's openat2 refused for that reason
 * (0: it is there). */
static void race(const char *outer, const char *mode, int number) {
    struct path_policy path_policy = {0};
    struct error error;
    char line[600];
    CHECK(path_policy_add(&path_policy, test_path("below"), PATH_POLICY_WRITE, &error));
    CHECK(mkdir(test_path("below/sub"), 0777) == 0 || errno == EEXIST);
    CHECK(mkdir(test_path(outer), 0777) == 0 || errno == EEXIST);
    test_write_text(test_path("below/sub/f"), "inside");
    (void)snprintf(line, sizeof line, "%s/f", test_path(outer));
    test_write_text(line, "outside");
    (void)snprintf(race_from, sizeof race_from, "%s", test_path("below/sub"));
    (void)snprintf(race_to, sizeof race_to, "%s", test_path("link_to_outer"));
    (void)snprintf(race_kept, sizeof race_kept, "%s", test_path("kept"));
    CHECK(symlink(test_path(outer), race_to) == 0);
    int before = fault_errno(number);
    fault_at(FAULT_OF_CALL, number ? 1 : 0);
    fault_before(number ? 2 : 1, exchange_names);
    FILE *stream = path_policy_stream(&path_policy, test_path("below/sub/f"), mode);
    int why = errno;
    fault_at(FAULT_OF_CALL, 0);
    fault_before(0, exchange_names);
    (void)fault_errno(before);
    if (stream)
        test_fail(__FILE__, __LINE__, "%s was opened in the place of below/sub", outer);
    CHECK(why == EACCES || why == ELOOP || why == EXDEV);
    CHECK(unlink(race_from) == 0 && rename(race_kept, race_from) == 0);
    char *text = test_read_file(line, NULL);
    CHECK_TEXT(text, "outside"); /* it was not truncated either */
    free(text);
    path_policy_destroy(&path_policy);
}
#endif

TEST(a_folder_that_becomes_a_link_between_two_checks_leads_nowhere) {
#ifndef GRAY_FAULTS
    test_skip("what happens between two calls to the system is only in builds with GRAY_FAULTS");
#else
    prepare();
    race("outer", "r", 0);
    race("outer", "w", 0);
    /* without openat2: its real path is checked */
    race("outer", "r", ENOSYS);
    race("outer", "r", EPERM);
    race("outer", "w", ENOSYS);
    race("below/too", "r", ENOSYS);
#endif
}

TEST(any_call_may_fail_where_the_kernel_opens_no_file_below_a_folder) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    prepare();
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        static const char *const scripts[] = {"tests/hostile/time_loop.lua"};
        const char *const folders[] = {test_path("below")};
        struct options options = {.scripts = scripts, .script_count = 1};
        struct path_policy path_policy = {0};
        struct error error = {0};
        char report[4096] = "";
        int opened = 0;
        options.script.allow_write = folders;
        options.script.allow_write_count = 1;
        if (!path_policy_add(&path_policy, folders[0], PATH_POLICY_WRITE, &error) ||
            !confine_process_as(&options, 2, 0, report, sizeof report, &error))
            _exit(64);
        if (!strstr(report, ", seccomp; "))
            _exit(77);
        path_policy.folders[0].descriptor = open(folders[0], O_PATH | O_DIRECTORY); /* the others were closed */
        for (uint64_t k = 1; k <= 8; k++) {
            fault_at(FAULT_OF_CALL, k);
            opened += can_open(&path_policy, "below/inner.txt", k % 2 ? "w" : "r");
            fault_at(FAULT_OF_CALL, k);
            opened += can_open(&path_policy, "below/inner.txt", k % 2 ? "r" : "w");
        }
        fault_at(FAULT_OF_CALL, 0);
        _exit(opened > 0 && opened < 16 && can_open(&path_policy, "below/inner.txt", "w") ? 0 : 1);
    }
    int how = 0;
    CHECK(waitpid(child, &how, 0) == child && WIFEXITED(how));
    if (WEXITSTATUS(how) == 77)
        test_skip("no seccomp filter in this build or kernel");
    CHECK_EQ_INT(WEXITSTATUS(how), 0);
}

/* As on kernels without Landlock and with every version of it: the report states it, and what is refused by name is
 * refused there, too. The exit status has a bit for each failed check; 128 without seccomp. */
static int status_of_confined(long version, const char *allowed, size_t report_size) {
    static char report[4096];
    const char *folders[] = {allowed};
    static const char *const scripts[] = {"tests/hostile/time_loop.lua", "no/such.lua"};
    struct options options = {.scripts = scripts, .script_count = 2};
    struct path_policy path_policy = {0};
    struct error error = {0};
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        int bad = 0;
        options.script.allow_write = folders;
        options.script.allow_write_count = 1;
        (void)path_policy_add(&path_policy, allowed, PATH_POLICY_WRITE, &error);
        if (!confine_process_as(&options, 2, version, report, report_size, &error))
            _exit(64);
        bool calls = strstr(report, ", seccomp; ") != NULL;
        if (report_size == sizeof report)
            bad |= !strstr(report, version <= 0 ? "no Landlock in this kernel" : "Landlock (version ") ? 1 : 0;
        for (size_t i = 0; i < path_policy.count; i++)
            path_policy.folders[i].descriptor = open(allowed, O_PATH | O_DIRECTORY); /* the others were closed */
        bad |= path_policy.count != 1 || !can_open(&path_policy, "below/inner.txt", "r") ? 2 : 0;
        bad |= !can_open(&path_policy, "below/new.txt", "w") || !can_open(&path_policy, "below/new.txt", "r+") ? 4 : 0;
        bad |= can_open(&path_policy, "below/link", "r") || can_open(&path_policy, "outside.txt", "r") ? 8 : 0;
        _exit(bad | (calls || report_size < 200 ? 0 : 128));
    }
    int how = 0;
    CHECK(waitpid(child, &how, 0) == child && WIFEXITED(how));
    return WEXITSTATUS(how);
}

TEST(a_process_is_confined_as_on_kernels_of_every_age) {
    prepare();
    const char *below = test_path("below");
    for (long version = -1; version <= 7; version++) {
        int status = status_of_confined(version, below, 4096);
        if (status == 128)
            test_skip("no seccomp filter in this build or kernel");
        if (status != 0)
            test_fail(__FILE__, __LINE__, "Landlock version %ld: %d", version, status);
    }
    CHECK_EQ_INT(status_of_confined(LONG_MAX, below, 60), 0); /* a truncated report */
    CHECK_EQ_INT(status_of_confined(LONG_MAX, "/", 100) & 64, 0);
    CHECK_EQ_INT(status_of_confined(LONG_MAX, "/", 4096) & 64, 0);
}

TEST(a_process_that_cannot_be_confined_says_why) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    static const char *const scripts[] = {"tests/hostile/time_loop.lua"};
    struct options options = {.scripts = scripts, .script_count = 1};
    int refused = 0;
    for (int kind = 0; kind < 2; kind++)
        for (uint64_t k = 1, over = 0; !over; k++) {
            fflush(stdout);
            pid_t child = fork();
            if (child == 0) {
                char report[4096] = "";
                struct error error = {0};
                fault_apart();
                fault_at((enum fault_kind)kind, k);
                bool ok = confine_process(&options, 1, report, sizeof report, &error);
                bool reported = ok ? report[0] != '\0' : error.text[0] != '\0' && error.kind != ERROR_NONE;
                _exit(!reported ? 3 : fault_count((enum fault_kind)kind) < k ? 2 : ok ? 1 : 0);
            }
            int how = 0;
            CHECK(waitpid(child, &how, 0) == child && WIFEXITED(how) && WEXITSTATUS(how) != 3);
            over = !WIFEXITED(how) || WEXITSTATUS(how) >= 2;
            refused += WIFEXITED(how) && WEXITSTATUS(how) == 0;
        }
    CHECK(refused >= 4);
}
