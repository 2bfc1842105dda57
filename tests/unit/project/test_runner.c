/* The runner of these tests and make test: what they reset, print, end and clean up. The examples are tests that only
 * the runs below select. Every process of such a run has a word in its environment, by which it is found in /proc in
 * any session or group. */
#define _GNU_SOURCE
#include "tests/harness.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Examples. */

TEST_EXAMPLE(example_passes) {
    CHECK(test_folder()[0] == '/');
}

/* The output of the run has a line of progress. */
TEST_EXAMPLE(example_waits_for_a_line) {
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/said.txt", getenv("GRAY_EXAMPLE_RUN"));
    for (bool found = false; !found; (void)usleep(10000)) {
        char *text = test_read_file(path, NULL);
        found = text && (strstr(text, "\n   1 of 2 tests, ") || strstr(text, "\n   0 of 1 tests, "));
        free(text);
    }
}

/* A private folder that contains a read-only folder, and a file in TMPDIR. */
static void leave_files(void) {
    test_write_text(test_path("file.txt"), "text");
    CHECK(mkdir(test_path("locked"), 0700) == 0);
    test_write_text(test_path("locked/file.txt"), "text");
    CHECK(chmod(test_path("locked"), 0500) == 0);
    CHECK(system("mktemp -d >/dev/null") == 0);
}

TEST_EXAMPLE(example_skips) {
    leave_files();
    test_skip("as it should");
}

TEST_EXAMPLE(example_lacks_a_tool) {
    test_need_tools("sh a-tool-that-no-machine-has");
}

TEST_EXAMPLE(example_starts_a_program) {
    CHECK(system("exit 3") != 0);
    test_fail(__FILE__, __LINE__, "it went on");
}

/* In another process, as tests do that talk to the program. */
TEST_EXAMPLE(example_starts_a_program_itself) {
    pid_t child = fork();
    if (child == 0) {
        (void)execl("/bin/false", "false", (char *)NULL);
        _exit(127);
    }
    CHECK_EQ_INT(test_status_of(child), 0);
}

TEST_EXAMPLE(example_fails) {
    leave_files();
    CHECK(false);
}

TEST_EXAMPLE(example_crashes) {
    leave_files();
    (void)raise(SIGKILL);
}

TEST_EXAMPLE(example_finds_signals_at_their_defaults) {
    sigset_t blocked;
    CHECK(sigprocmask(SIG_SETMASK, NULL, &blocked) == 0);
    for (int number = 1; number < NSIG; number++) {
        struct sigaction action;
        if (sigaction(number, NULL, &action) == 0 && action.sa_handler == SIG_IGN)
            test_fail(__FILE__, __LINE__, "signal %d is ignored", number);
        if (sigismember(&blocked, number) == 1)
            test_fail(__FILE__, __LINE__, "signal %d is blocked", number);
    }
    int how = system("kill -s HUP $$");
    CHECK(WIFSIGNALED(how) && WTERMSIG(how) == SIGHUP);
    struct test_result result = test_gray_scene("while true do end", "scene.lua --script-time 0.1", NULL);
    CHECK_EQ_INT(result.status, 1);
    test_free_result(&result);
}

/* An ordinary child, one in its own session, an orphan that ignores every signal that can be ignored, a stopped one,
 * and the program with its render process. */
static void leave_processes(void) {
    test_write_text(test_path("scene.lua"), "gr.render(gr.node('n'), 'out.png', 8000, 8000, {0, 0, 1}, {0, 0, -1}, "
                                            "{0, 1, 0}, 40, {1, 1, 1}, {})");
    char *command;
    CHECK(asprintf(&command,
                   "cd '%s'; sleep 1000 & setsid sleep 1001 & (trap '' TERM HUP INT; setsid sleep 1002 &) & "
                   "sh -c 'kill -s STOP $$' & '%s' -q -full -ss 60 scene.lua & sleep 0.1",
                   test_folder(), test_program()) > 0);
    CHECK(system(command) == 0);
    free(command);
}

TEST_EXAMPLE(example_leaves_processes) {
    leave_processes();
    (void)usleep(200000);
}

TEST_EXAMPLE(example_waits_with_processes) {
    leave_files();
    leave_processes();
    const char *ready = getenv("GRAY_EXAMPLE_READY");
    if (ready)
        test_write_text(ready, "");
    for (;;)
        (void)pause();
}

/* Runs of the examples. */

/* Processes that have the word of this test. */
static int marked_processes(void) {
    char mark[512], path[64];
    int found = 0;
    (void)snprintf(mark, sizeof mark, "GRAY_EXAMPLE_RUN=%s", test_folder());
    DIR *stream = opendir("/proc");
    for (struct dirent *entry; stream && (entry = readdir(stream)) != NULL;) {
        if (entry->d_name[0] < '1' || entry->d_name[0] > '9')
            continue;
        (void)snprintf(path, sizeof path, "/proc/%.20s/environ", entry->d_name);
        size_t size = 0;
        char *text = test_read_file(path, &size);
        found += text && memmem(text, size, mark, strlen(mark)) != NULL;
        free(text);
    }
    if (stream)
        (void)closedir(stream);
    return found;
}

static int files_in(const char *path) {
    int count = 0;
    DIR *stream = opendir(path);
    while (stream && readdir(stream) != NULL)
        count++;
    if (stream)
        (void)closedir(stream);
    return count - 2;
}

/* The folder used as /tmp. */
static const char *temporary(void) {
    static char path[512];
    (void)snprintf(path, sizeof path, "%s/tmp", test_folder());
    (void)mkdir(path, 0700);
    return path;
}

static const char *this_program(void) {
    static char path[4096];
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - 1);
    path[length > 0 ? length : 0] = '\0';
    return path;
}

/* Starts a shell command; `$run` is the runner. Its output goes to said.txt. It leads its own process group. */
static pid_t start(const char *line) {
    (void)unsetenv("GRAY_CI"); /* a run that is to have it sets it */
    char text[8192];
    (void)snprintf(text, sizeof text, "%s", test_path("said.txt"));
    const char *below = temporary(), *run = this_program();
    fflush(stdout);
    pid_t child = fork();
    if (child != 0)
        return child;
    int out = open(text, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    (void)dup2(out, STDOUT_FILENO);
    (void)dup2(out, STDERR_FILENO);
    (void)close(out);
    (void)setpgid(0, 0);
    (void)setenv("TMPDIR", below, 1);
    (void)setenv("run", run, 1);
    (void)setenv("GRAY_EXAMPLE_RUN", test_folder(), 1);
    (void)unsetenv("MAKELEVEL");
    (void)unsetenv("MAKEFLAGS");
    (void)execl("/bin/sh", "sh", "-c", line, NULL);
    _exit(127);
}

static int wait_for(pid_t child) {
    return test_status_of(child);
}

/* The last result stays valid until the next call. */
static const char *said(void) {
    static char *text;
    free(text);
    text = test_read_file(test_path("said.txt"), NULL);
    return text ? text : "";
}

static void expect(bool is, const char *what, const char *when) {
    if (!is)
        test_fail(__FILE__, __LINE__, "%s (%s); said:\n%s", what, when, said());
}

/* No process may remain, after some seconds or immediately. */
static void expect_nothing_left(double seconds, const char *when) {
    double begun = test_clock();
    while ((marked_processes() > 0 || files_in(temporary()) > 0) && test_clock() - begun < seconds)
        (void)usleep(20000);
    int processes = marked_processes(), files = files_in(temporary());
    if (processes > 0 || files > 0)
        test_fail(__FILE__, __LINE__, "%s: %d processes and %d folders are left", when, processes, files);
}

static bool await_file(const char *path) {
    double begun = test_clock();
    while (access(path, F_OK) != 0 && test_clock() - begun < 120)
        (void)usleep(5000);
    return access(path, F_OK) == 0;
}

static bool ends_with(const char *text, const char *end) {
    size_t length = strlen(text), size = strlen(end);
    return length >= size && strcmp(text + length - size, end) == 0;
}

/* Starts the command with signals ignored and blocked. */
static pid_t start_ignoring(const char *line) {
    static const int ignored[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGPIPE, SIGCHLD, SIGUSR1, SIGALRM, SIGXFSZ};
    const size_t count = sizeof ignored / sizeof *ignored;
    sigset_t all, before;
    void (*handlers[sizeof ignored / sizeof *ignored])(int);
    (void)sigfillset(&all);
    (void)sigprocmask(SIG_BLOCK, &all, &before);
    for (size_t i = 0; i < count; i++)
        handlers[i] = signal(ignored[i], SIG_IGN);
    pid_t child = start(line);
    for (size_t i = 0; i < count; i++)
        (void)signal(ignored[i], handlers[i]);
    (void)sigprocmask(SIG_SETMASK, &before, NULL);
    return child;
}

TEST(a_runner_resets_signals_that_arrive_ignored_or_blocked) {
    (void)temporary();
    CHECK_EQ_INT(wait_for(start_ignoring("exec $run --examples example_finds_signals")), 0);
    CHECK_EQ_INT(
        wait_for(start("to=$GRAY_EXAMPLE_RUN/nohup.txt; nohup $run --examples example_finds_signals >$to 2>&1; "
                       "s=$?; cat $to; exit $s")),
        0);
    CHECK_EQ_INT(wait_for(start("$run --examples example_finds_signals & wait $!")), 0);
    expect_nothing_left(0, "after runs with ignored signals");
}

TEST(a_runner_leaves_no_folder_whether_tests_pass_skip_fail_or_crash) {
    static const char *const words[] = {"example_passes", "example_skips", "example_fails", "example_crashes"};
    static const char *const ends[] = {"1 passed, 0 failed, 0 skipped\n", "0 passed, 0 failed, 1 skipped\n",
                                       "0 passed, 1 failed, 0 skipped\n", "0 passed, 1 failed, 0 skipped\n"};
    for (int i = 0; i < 4; i++) {
        char line[100];
        (void)snprintf(line, sizeof line, "exec $run --examples %s", words[i]);
        CHECK_EQ_INT(wait_for(start(line)), i >= 2);
        expect(ends_with(said(), ends[i]), "another last line", words[i]);
        expect_nothing_left(0, words[i]);
    }
    CHECK_EQ_INT(wait_for(start("exec $run --examples --keep -j 4 example_passes example_skips example_fails")), 1);
    expect(files_in(temporary()) == 1 && strstr(said(), "the folders of tests that failed are in "),
           "no folder was kept", "--keep");
}

TEST(a_runner_ends_what_its_tests_leave_running) {
    CHECK_EQ_INT(wait_for(start("exec $run --examples -j 3 example_leaves_processes example_crashes")), 1);
    expect(ends_with(said(), "\n1 passed, 1 failed, 0 skipped\n"), "another last line", "leaving processes");
    expect_nothing_left(0, "after tests that left processes");
}

/* Sends a signal to the children of a process whose command line holds a word, as pkill does, which is not installed
 * everywhere. True: there was one. */
static bool signal_children(pid_t parent, const char *word, int number) {
    bool found = false;
    DIR *stream = opendir("/proc");
    for (struct dirent *entry; stream && (entry = readdir(stream)) != NULL;) {
        char path[64];
        size_t size = 0;
        int of = 0;
        if (entry->d_name[0] < '1' || entry->d_name[0] > '9')
            continue;
        (void)snprintf(path, sizeof path, "/proc/%.20s/stat", entry->d_name);
        char *stat = test_read_file(path, NULL), *after = stat ? strrchr(stat, ')') : NULL;
        bool child = after && sscanf(after, ") %*c %d", &of) == 1 && of == (int)parent;
        free(stat);
        if (!child)
            continue;
        (void)snprintf(path, sizeof path, "/proc/%.20s/cmdline", entry->d_name);
        char *words = test_read_file(path, &size);
        if (words && memmem(words, size, word, strlen(word)) && kill((pid_t)atoi(entry->d_name), number) == 0)
            found = true;
        free(words);
    }
    if (stream)
        (void)closedir(stream);
    return found;
}

static void end_runner(int number, bool reaper) {
    char when[64], *ready = strdup(test_path("ready"));
    (void)snprintf(when, sizeof when, "signal %d%s", number, reaper ? " to reapers" : "");
    (void)unlink(ready);
    (void)setenv("GRAY_EXAMPLE_READY", ready, 1);
    pid_t runner = start("exec $run --examples -j 3 example_waits example_crashes");
    expect(await_file(ready), "the test did not start", when);
    while (marked_processes() < 8)
        (void)usleep(20000);
    if (reaper) { /* the runner continues without them */
        CHECK(signal_children(runner, "", SIGKILL));
        CHECK_EQ_INT(wait_for(runner), 1);
    } else {
        CHECK(kill(runner, number) == 0);
        CHECK_EQ_INT(wait_for(runner), 128 + number);
    }
    /* After SIGKILL the reapers end the tests on their own. */
    expect_nothing_left(number == SIGKILL && !reaper ? 120 : 0, when);
    free(ready);
}

TEST(a_runner_that_is_ended_by_a_signal_leaves_no_process_and_no_folder) {
    end_runner(SIGINT, false);
    end_runner(SIGTERM, false);
    end_runner(SIGHUP, false);
    end_runner(SIGQUIT, false);
}

TEST(a_runner_or_its_reapers_that_are_killed_leave_no_process_and_no_folder) {
    end_runner(SIGKILL, false);
    end_runner(SIGKILL, true);
}

TEST(a_runner_whose_reader_is_gone_ends) {
    CHECK_EQ_INT(wait_for(start("export GRAY_TEST_PROGRESS=0.05; { $run --examples example_waits_with_processes; "
                                "echo $? >$GRAY_EXAMPLE_RUN/status.txt; } | true; "
                                "test \"$(cat $GRAY_EXAMPLE_RUN/status.txt)\" = 141")),
                 0);
    expect_nothing_left(0, "no reader");
}

TEST(a_runner_says_how_far_it_is) {
    CHECK_EQ_INT(wait_for(start("export GRAY_TEST_PROGRESS=0.2; exec $run --examples -j 2 waits_for_a_line passes")),
                 0);
    expect(strstr(said(), "\n   1 of 2 tests, ") != NULL, "no line of progress", "0.2 s");
    expect(ends_with(said(), "\n2 passed, 0 failed, 0 skipped\n"), "another last line", "0.2 s");
    char line[1024];
    (void)snprintf(line, sizeof line, "exec $run --examples --log %s example_passes example_fails",
                   test_path("tests.log"));
    CHECK_EQ_INT(wait_for(start(line)), 1);
    const char *shown = said();
    char *log = test_read_file(test_path("tests.log"), NULL);
    expect(strstr(shown, "FAILED   example_fails") && !strstr(shown, "ok  ") && !strstr(shown, "passed, "),
           "what passed is shown, or what failed is not", "--log");
    expect(log && strstr(log, "ok       example_passes") && ends_with(log, "\n1 passed, 1 failed, 0 skipped\n"),
           "the log is not whole", "--log");
    free(log);
}

TEST(skipped_tests_are_one_line_with_their_reasons) {
    CHECK_EQ_INT(
        wait_for(start("exec $run --examples --log $GRAY_EXAMPLE_RUN/log example_skips example_lacks example_p")), 0);
    CHECK_TEXT(said(), "2 skipped: a-tool-that-no-machine-has is not installed (1); as it should (1)\n");
    char *log = test_read_file(test_path("log"), NULL);
    CHECK(log && strstr(log, "skipped  example_skips") && ends_with(log, "\n1 passed, 0 failed, 2 skipped\n"));
    free(log);
}

TEST(a_missing_tool_fails_in_continuous_integration_and_another_skip_does_not) {
    CHECK_EQ_INT(wait_for(start("export GRAY_CI=1; exec $run --examples example_skips example_lacks")), 1);
    expect(strstr(said(), "FAILED   example_lacks_a_tool") != NULL, "not failed", "GRAY_CI=1");
    expect(ends_with(said(), "\n1 skipped: as it should (1)\n0 passed, 1 failed, 1 skipped\n"), "another end",
           "GRAY_CI=1");
}

TEST(a_fast_run_leaves_out_every_test_that_starts_a_program) {
    CHECK_EQ_INT(wait_for(start("exec $run --examples --fast example_starts example_passes example_finds")), 0);
    expect(ends_with(said(), "\n3 left out, which start a program\n1 passed, 0 failed, 0 skipped\n"), "another end",
           "--fast");
    expect_nothing_left(0, "--fast");
    CHECK_EQ_INT(wait_for(start("exec $run --examples example_starts")), 1);
    expect(ends_with(said(), "\n0 passed, 2 failed, 0 skipped\n"), "another end", "without --fast");
}

TEST(a_runner_explains_its_options_and_refuses_others_in_one_line) {
    CHECK_EQ_INT(wait_for(start("exec $run --help")), 0);
    CHECK(strstr(said(), "--fast") && strstr(said(), "--long") && strstr(said(), "-WORD"));
    static const char *const wrong[] = {"--slow", "-q", "-j", "-j many", "--log"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char line[100];
        (void)snprintf(line, sizeof line, "exec $run --examples example_passes %s", wrong[i]);
        CHECK_EQ_INT(wait_for(start(line)), 2);
        const char *text = said();
        expect(strchr(text, '\n') == text + strlen(text) - 1 && strstr(text, "--help"), "not one line", wrong[i]);
    }
}

/* make test, with a makefile and a runner that the test controls. */

static void make_tree(void) {
    CHECK(
        wait_for(start(
            "d=$GRAY_EXAMPLE_RUN/tree; mkdir -p $d/tools $d/build/release/tests $d/build/asan/tests && "
            "cp tools/test.sh tools/test_steps.sh tools/test_session.sh $d/tools && "
            "printf '#!/bin/sh\\n' >$d/tools/setup.sh && cp $d/tools/setup.sh $d/tools/layers.sh && "
            "printf '#!/bin/sh\\nexec $run --examples $example $1 $2 $3 $4\\n' "
            ">$d/build/release/tests/run && cp $d/build/release/tests/run $d/build/asan/tests/run && "
            "printf 'test:\\n\\t@tools/test.sh\\nall:\\nread-sources:\\n\\t@$(clang)\\nbuild-tests:\\n\\t@$(build)\\n' "
            ">$d/Makefile && mkdir $d/bin && ln -sf /bin/* /usr/bin/* $d/bin && "
            "printf '#!/bin/sh\\n' >$d/clang && chmod +x $d/clang && ln -sf ../clang $d/bin/clang && "
            "chmod +x $d/tools/setup.sh $d/tools/layers.sh $d/build/*/tests/run && "
            "ln -s $GRAY_TEST_BINARY $d/build/release/gray && "
            "ln -s ../release/gray $d/build/asan/gray")) == 0);
}

TEST(make_test_says_how_far_it_is_while_building_and_testing) {
    make_tree();
    CHECK_EQ_INT(wait_for(start("cd $GRAY_EXAMPLE_RUN/tree; export example=example_waits_for_a_line "
                                "build='until grep -q building $$GRAY_EXAMPLE_RUN/said.txt; do sleep 0.05; done' "
                                "GRAY_TEST_PROGRESS=0.3; exec make -s test")),
                 0);
    const char *text = said();
    const char *building = strstr(text, "   building release, "), *testing = strstr(text, "   0 of 1 tests, ");
    expect(building && testing && building < testing, "no lines of progress", "make test");
    expect(strstr(text, "\n   1 passed, 0 failed, 0 skipped\n") && ends_with(text, "\n4 passed, 0 failed, 0 skipped\n"),
           "another last line", "make test");
    expect_nothing_left(0, "make test");
}

TEST(make_test_passes_under_nohup_and_in_the_background) {
    make_tree();
    int status = wait_for(start("cd $GRAY_EXAMPLE_RUN/tree; export build=: example=example_finds_signals; "
                                "nohup make -s test >nohup.txt 2>&1 & wait $!; s=$?; cat nohup.txt; exit $s"));
    expect(status == 0 && ends_with(said(), "\n4 passed, 0 failed, 0 skipped\n"), "not passed", "nohup make test");
    expect_nothing_left(0, "nohup make test");
}

TEST(make_test_counts_what_clang_refuses_and_says_what_it_leaves_out_without_clang) {
    make_tree();
    CHECK(wait_for(start("cd $GRAY_EXAMPLE_RUN/tree; export build=: example=example_passes clang=false PATH=$PWD/bin; "
                         "exec make -s test")) != 0);
    expect(strstr(said(), "\n3 passed, 1 failed, 0 skipped\n") != NULL, "not one failure", "make test, clang fails");
    CHECK_EQ_INT(wait_for(start("cd $GRAY_EXAMPLE_RUN/tree; export build=: example=example_passes clang=false "
                                "PATH=$PWD/bin; rm bin/clang; exec make -s test")),
                 0);
    expect(strstr(said(), "clang, which is not installed\n") && ends_with(said(), "\n3 passed, 0 failed, 1 skipped\n"),
           "not skipped", "make test without clang");
    CHECK(wait_for(start("cd $GRAY_EXAMPLE_RUN/tree; export build=: example=example_passes GRAY_CI=1 PATH=$PWD/bin; "
                         "exec make -s test")) != 0);
    expect(strstr(said(), "\n3 passed, 1 failed, 0 skipped\n") != NULL, "not failed", "GRAY_CI=1, no clang");
}

TEST(make_test_sets_up_the_machine_except_with_setup_0) {
    make_tree();
    const char *line = "cd $GRAY_EXAMPLE_RUN/tree; export build=: example=example_passes; "
                       "echo 'echo set up \"$@\"' >tools/setup.sh; exec make -s test";
    CHECK_EQ_INT(wait_for(start(line)), 0);
    expect(strncmp(said(), "set up --tests\n", 15) == 0, "no set-up", "make test");
    CHECK(setenv("SETUP", "0", 1) == 0);
    CHECK_EQ_INT(wait_for(start(line)), 0);
    expect(!strstr(said(), "set up"), "a set-up", "SETUP=0 make test");
}

/* Compiles a source of a separate tree with the project's makefile. */
static int compile(const char *words) {
    char line[300];
    (void)snprintf(line, sizeof line, "cd $GRAY_EXAMPLE_RUN/warned && exec make -s BUILD=out %s out/src/base/it.o",
                   words);
    return wait_for(start(line));
}

TEST(a_switch_that_forgets_a_kind_compiles_in_make_and_not_in_make_test) {
    const char *source = "enum argument_kind { ONE, TWO };\nint it(enum argument_kind kind);\n"
                         "int it(enum argument_kind kind) {\n    switch (kind) {\n    case ONE:\n        return 1;\n%s"
                         "    default:\n        return 0;\n    }\n}\n";
    char forgets[400], whole[400];
    (void)snprintf(forgets, sizeof forgets, source, "");
    (void)snprintf(whole, sizeof whole, source, "    case TWO:\n");
    CHECK(wait_for(start("mkdir -p $GRAY_EXAMPLE_RUN/warned/src/base; cp Makefile $GRAY_EXAMPLE_RUN/warned")) == 0);
    test_write_text(test_path("warned/src/base/it.c"), forgets);
    CHECK_EQ_INT(compile(""), 0);
    expect(strstr(said(), "TWO") != NULL, "not named", "make");
    CHECK(compile("WERROR=1") != 0); /* although the object exists */
    expect(strstr(said(), "TWO") != NULL, "not named", "make WERROR=1");
    test_write_text(test_path("warned/src/base/it.c"), whole);
    CHECK_EQ_INT(compile("WERROR=1"), 0);
    /* The second make compiles nothing: the object stays the same file. */
    struct stat before, after;
    CHECK(stat(test_path("warned/out/src/base/it.o"), &before) == 0);
    CHECK_EQ_INT(compile(""), 0);
    CHECK_EQ_INT(compile("WERROR=1"), 0);
    CHECK(stat(test_path("warned/out/src/base/it.o"), &after) == 0);
    CHECK(before.st_ino == after.st_ino && before.st_mtim.tv_sec == after.st_mtim.tv_sec &&
          before.st_mtim.tv_nsec == after.st_mtim.tv_nsec);
}

/* A tree with the project's makefile, and programs of one line. */
static void make_sources(void) {
    CHECK(wait_for(start("mkdir -p $GRAY_EXAMPLE_RUN/own/src/host $GRAY_EXAMPLE_RUN/own/lua; "
                         "cp Makefile $GRAY_EXAMPLE_RUN/own; cd $GRAY_EXAMPLE_RUN/own; "
                         "echo 'int main(void) { return 0; }' >src/host/program.c; "
                         "for f in gui gtk mpi; do echo \"extern int $f;\" >src/host/main_$f.c; done; "
                         "touch lua/a.lua; find . | sort >../before")) == 0);
}

TEST(a_build_in_another_folder_leaves_the_sources_as_they_were) {
    make_sources();
    CHECK_EQ_INT(wait_for(start("cd $GRAY_EXAMPLE_RUN/own; make -s BUILD=$GRAY_EXAMPLE_RUN/b || exit 1; "
                                "find . | sort | cmp - ../before && ../b/gray && test -e ../b/lua/a.lua && "
                                "test -e ../b/src/host/program.o && make -s clean BUILD=$GRAY_EXAMPLE_RUN/b && "
                                "find . | sort | cmp - ../before && test -z \"$(ls -A ../b)\"")),
                 0);
    CHECK_TEXT(said(), "");
    CHECK_EQ_INT(wait_for(start("cd $GRAY_EXAMPLE_RUN/own; make -s && ./gray && ./rt && make -s clean && "
                                "find . | sort | cmp - ../before")),
                 0);
    CHECK(wait_for(start("cd $GRAY_EXAMPLE_RUN/own; exec make -s BUILD=.")) != 0);
    expect(strstr(said(), "BUILD is the folder of the sources") != NULL, "not refused", "BUILD=.");
}

/* Files of others in the same folders stay, and the folders of gray alone go when they are empty. */
TEST(uninstalling_removes_what_installing_has_written) {
    const char *lines =
        "make='make -s -o all BUILD='$(dirname $GRAY_TEST_BINARY)' PREFIX=/usr DESTDIR='$GRAY_EXAMPLE_RUN; "
        "test -e $GRAY_TEST_BINARY-gui || make=\"$make GTK_LIBS=\"; "
        "test -e $GRAY_TEST_BINARY-mpi || make=\"$make MPI_LIBS=\"; "
        "to=$GRAY_EXAMPLE_RUN/usr; "
        "mkdir -p $to/bin && touch $to/bin/other && $make install && $to/bin/gray --version && "
        "test -e $to/share/gray/lua/readobj.lua && test -e $to/share/doc/gray/LICENSE && "
        "grep -q gr.sphere $to/share/man/man5/gray-scene.5 && test -s $to/share/man/man1/gray.1 && "
        "cmp -s textures/painting.png $to/share/gray/textures/painting.png && "
        "cmp -s data/path/dining.lua $to/share/gray/data/path/dining.lua && "
        "cmp -s docs/start/2-bowl.png $to/share/doc/gray/docs/start/2-bowl.png && "
        "test -e $to/share/bash-completion/completions/gray && test -e $to/share/zsh/site-functions/_gray && "
        "test -e $to/share/fish/vendor_completions.d/gray.fish && "
        "touch $to/share/gray/lua/own.lua && $make uninstall && (cd $to && find . -type f | sort) && "
        "test ! -e $to/share/doc/gray && test ! -e $to/share/gray/lua/dialects && test ! -e $to/share/gray/data && "
        "rm $to/share/gray/lua/own.lua && $make install && $make uninstall && test ! -e $to/share/gray && "
        "(cd $to && find . -type f)";
    CHECK_EQ_INT(wait_for(start(lines)), 0);
    expect(ends_with(said(), "\n./bin/other\n./share/gray/lua/own.lua\n./bin/other\n"), "other files", "uninstall");
}

/* Kills make, or the script it runs, during the build or the tests. */
static void end_make_test(const char *command, bool builds, int number, bool group, bool script) {
    char when[200], *ready = strdup(test_path("ready")), line[1024];
    (void)snprintf(when, sizeof when, "%s, %s, signal %d to %s", command, builds ? "building" : "testing", number,
                   script  ? "the script"
                   : group ? "the group"
                           : "it");
    (void)unlink(ready);
    (void)setenv("GRAY_EXAMPLE_READY", ready, 1);
    (void)snprintf(line, sizeof line, "cd $GRAY_EXAMPLE_RUN/tree; export example=example_waits build='%s'; exec %s",
                   builds ? "touch $$GRAY_EXAMPLE_READY; sleep 1000 & sleep 1001" : ":", command);
    pid_t run = start(line);
    expect(await_file(ready), "did not begin", when);
    if (script) {
        CHECK(signal_children(run, "tools/test.sh", number));
    } else {
        CHECK(kill(group ? -run : run, number) == 0);
    }
    CHECK(wait_for(run) != 0);
    expect_nothing_left(script || number == SIGKILL ? 120 : 0, when);
    free(ready);
}

TEST(make_test_that_is_ended_by_a_signal_leaves_no_process) {
    make_tree();
    for (int builds = 0; builds <= 1; builds++) {
        end_make_test("make -s test", builds, SIGINT, true, false); /* like Ctrl-C */
        end_make_test("make -s test", builds, SIGTERM, false, false);
        end_make_test("tools/test.sh", builds, SIGHUP, false, false);
    }
}

TEST(make_test_that_is_killed_leaves_no_process) {
    make_tree();
    for (int builds = 0; builds <= 1; builds++) {
        end_make_test("make -s test", builds, SIGKILL, false, false);
        end_make_test("make -s test", builds, SIGKILL, true, false);
        end_make_test("make -s test", builds, SIGKILL, false, true);
        end_make_test("tools/test.sh", builds, SIGKILL, false, false);
    }
}
