/* Writing files: which files are replaced, which are refused, and which temporary files remain. The whole program is
 * attacked in test_hostile_writing.c; here is the mechanism itself. */
#define _GNU_SOURCE
#include "base/file_output.h"

#include "film/tile_file.h"
#include "image/picture_file.h"
#include "tests/harness.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char old_picture[] = "PF\n1 old", new_picture[] = "PF\n1 new";

static bool write_as(const char *path, const struct file_rules *rules, const char *text, struct error *error) {
    struct file_output file;
    if (!file_output_open(&file, &(struct file_target){.path = path, .rules = rules}, error))
        return false;
    if (file_output_write(&file, text, strlen(text), error))
        return file_output_commit(&file, error);
    file_output_abandon(&file);
    return false;
}

static void holds(const char *path, const char *text) {
    char *have = test_read_file(path, NULL);
    CHECK_TEXT(have, text);
    free(have);
}

static int entries;
static bool count_entry(void *context, const char *name) {
    (void)context, (void)name;
    entries++;
    return true;
}

static int entries_of(const char *folder) {
    entries = 0;
    CHECK(file_list(folder, 1000, count_entry, NULL));
    return entries;
}

TEST(a_picture_replaces_pictures_and_empty_files_and_nothing_else) {
    static const struct {
        const char *text;
        bool replaced;
    } all[] = {{"", true},
               {"\x89PNG\r\n\x1a\n rest", true},
               {"\xff\xd8\xff\xe0", true},
               {"#?RADIANCE\n", true},
               {"#?RGBE\n", true},
               {"PF\n1", true},
               {"Pf 2", true},
               {"\x76\x2f\x31\x01", true},
               {"#!/bin/sh\n", false},
               {"#?/bin/sh\n", false},
               {"\x89PNG", false},
               {"\xff\xd8", false},
               {"PF is no picture", false},
               {"P6\n1 1", false},
               {"GRAYTILE", false},
               {"x", false}};
    const char *path = test_path("a.png");
    const struct file_rules rules = {.may_replace = picture_file_is, .expected = "a picture"};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        struct error error = {0};
        test_write_text(path, all[i].text);
        CHECK(file_output_check(&(struct file_target){.path = path, .rules = &rules}, &error) == all[i].replaced);
        bool written = write_as(path, &rules, new_picture, &error);
        if (written != all[i].replaced)
            test_fail(__FILE__, __LINE__, "row %zu: %s", i, error.text);
        holds(path, written ? new_picture : all[i].text);
        CHECK(written || (error.kind == ERROR_SCENE && strstr(error.text, "a.png: exists already")));
        CHECK_EQ_INT(entries_of(test_folder()), 1);
    }
}

TEST(a_checkpoint_replaces_checkpoints_alone) {
    const char *path = test_path("c.tiles");
    const struct file_rules rules = {.may_replace = tile_file_is, .expected = "a checkpoint or part"};
    struct error error = {0};
    test_write_text(path, "GRAYTILE old");
    CHECK(write_as(path, &rules, "GRAYTILE new", &error));
    holds(path, "GRAYTILE new");
    test_write_text(path, old_picture);
    CHECK(!write_as(path, &rules, "GRAYTILE new", &error) && strstr(error.text, "is not a checkpoint or part"));
    holds(path, old_picture);
}

TEST(a_new_file_has_no_x_bit_and_a_replaced_one_loses_it) {
    const char *path = test_path("a.png");
    struct stat status;
    struct error error = {0};
    mode_t before = umask(0);
    CHECK(write_as(path, NULL, old_picture, &error) && stat(path, &status) == 0 && (status.st_mode & 07777) == 0666);
    CHECK(chmod(path, 06755) == 0);
    CHECK(write_as(path, NULL, new_picture, &error) && stat(path, &status) == 0 && (status.st_mode & 07777) == 0644);
    (void)umask(before);
}

TEST(files_that_were_read_stay_and_pictures_of_this_run_are_written_again) {
    const char *path = test_path("a.png"), *link_path = test_path("b.png");
    struct file_guard guard = {0};
    struct file_rules rules = {
        .may_replace = picture_file_is, .expected = "a picture", .role = FILE_ROLE_PICTURE, .guard = &guard};
    struct file_identity identity;
    struct error error = {0};
    test_write_text(path, old_picture);
    CHECK(link(path, link_path) == 0);
    CHECK(file_identity_of(path, &identity) && file_set_add(&guard.kept, identity));
    CHECK(!write_as(path, &rules, new_picture, &error) && strstr(error.text, "this run reads or uses"));
    CHECK(!write_as(link_path, &rules, new_picture, &error)); /* the same file under another name */
    rules.force = true;
    CHECK(!write_as(path, &rules, new_picture, &error));
    rules.force = false;
    const char *own = test_path("own.png");
    for (int i = 0; i < 3; i++) { /* written, read, written again */
        CHECK(write_as(own, &rules, new_picture, &error));
        CHECK(file_identity_of(own, &identity) && file_set_add(&guard.kept, identity));
    }
    file_guard_destroy(&guard);
}

TEST(what_is_no_regular_file_is_not_opened) {
    const char *path = test_path("x");
    struct error error = {0};
    struct stat status;
    CHECK(mkfifo(path, 0666) == 0);
    CHECK(!write_as(path, NULL, "x", &error) && strstr(error.text, "is a named pipe"));
    CHECK(stat(path, &status) == 0 && S_ISFIFO(status.st_mode) && remove(path) == 0);
    CHECK(symlink("nowhere", path) == 0);
    CHECK(!write_as(path, NULL, "x", &error) && strstr(error.text, "is a symbolic link"));
    CHECK(remove(path) == 0 && mkdir(path, 0777) == 0);
    CHECK(!write_as(path, NULL, "x", &error) && strstr(error.text, "is a folder"));
    CHECK(!write_as("/dev/null", NULL, "x", &error) && strstr(error.text, "is a device"));
    CHECK_EQ_INT(entries_of(test_folder()), 1);
}

TEST(a_name_that_must_be_new_replaces_nothing) {
    const char *path = test_path("a-view1.png");
    const struct file_rules rules = {.never_replace = true};
    struct error error = {0};
    CHECK(write_as(path, &rules, old_picture, &error));
    CHECK(!write_as(path, &rules, new_picture, &error) && strstr(error.text, "exists already"));
    holds(path, old_picture);
}

/* Names of temporary files, and their contents. */
static void leave(const char *name, long age) {
    const char *path = test_path(name);
    struct timespec times[2] = {{.tv_nsec = UTIME_OMIT}, {.tv_sec = time(NULL) - age}};
    test_write_text(path, "left");
    CHECK(utimensat(AT_FDCWD, path, times, 0) == 0);
}

static bool is_there(const char *name) {
    return file_exists(test_path(name));
}

/* The change time of a file cannot be set: the removal after a minute is tested in the long test below. */
TEST(leftovers_that_are_young_or_locked_or_no_leftovers_stay) {
    static const char *const names[] = {".gray.part-0123456789abcdef", ".gray.part-0123456789abcde",
                                        ".gray.part-0123456789abcdeg", ".gray.part-0123456789ABCDEF",
                                        ".gray.part-0123456789abcdef0"};
    struct file_guard guard = {0};
    const struct file_rules rules = {.guard = &guard};
    struct error error = {0};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        leave(names[i], 3600);
    CHECK(mkdir(test_path(".gray.part-1111111111111111"), 0777) == 0);
    CHECK(symlink("x", test_path(".gray.part-2222222222222222")) == 0);
    CHECK(mkfifo(test_path(".gray.part-3333333333333333"), 0666) == 0);
    CHECK(file_output_check(&(struct file_target){.path = test_path("a.png"), .rules = &rules}, &error));
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        CHECK(is_there(names[i])); /* the first one has just been changed */
    CHECK(is_there(".gray.part-1111111111111111") && is_there(".gray.part-2222222222222222") &&
          is_there(".gray.part-3333333333333333") && !is_there("a.png"));
    file_guard_destroy(&guard);
}

TEST_LONG(leftovers_of_killed_runs_are_removed_after_a_minute) {
    static const char *const names[] = {".gray.part-0000000000000000", ".gray.part-0123456789abcdef",
                                        ".gray.part-0123456789abcde", ".gray.part-ffffffffffffffff"};
    struct file_guard guard = {0};
    const struct file_rules rules = {.guard = &guard};
    struct error error = {0};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        leave(names[i], 3600);
    int locked = open(test_path(names[0]), O_RDWR);
    CHECK(locked >= 0 && flock(locked, LOCK_EX) == 0);
    bool foreign = chown(test_path(names[3]), 65534, 65534) == 0;
    struct timespec minute = {62, 0};
    (void)nanosleep(&minute, NULL);
    CHECK(file_output_check(&(struct file_target){.path = test_path("a.png"), .rules = &rules}, &error));
    CHECK(is_there(names[0]) && !is_there(names[1]) && is_there(names[2]));
    CHECK(is_there(names[3]) == foreign);
    (void)close(locked);
    file_guard_destroy(&guard);
}

TEST(the_last_one_that_had_a_lock_removes_what_killed_runs_left_in_the_folder) {
    static const char name[] = ".gray.part-0123456789abcdef";
    const struct file_target target = {.path = test_path("lock")};
    struct file_lock a, b;
    CHECK(file_lock_take(&a, &target, true) && file_lock_take(&b, &target, true));
    leave(name, 0);
    file_lock_release(&a);
    CHECK(is_there(name));
    file_lock_release(&b);
    CHECK(!is_there(name) && !is_there("lock"));
}

TEST(a_lock_is_taken_once_or_shared_and_its_file_goes_with_the_last_one) {
    const struct file_target target = {.path = test_path("lock")}, nowhere = {.path = "/proc/lock"};
    struct file_lock a, b, c;
    CHECK(file_lock_take(&a, &target, false) && a.open);
    CHECK(!file_lock_take(&b, &target, false) && !b.open);
    CHECK(!file_lock_take(&b, &target, true) && !b.open);
    file_lock_release(&b);
    holds(target.path, "");
    file_lock_release(&a);
    file_lock_release(&a);
    CHECK(!file_exists(target.path));
    CHECK(file_lock_take(&a, &target, true) && file_lock_take(&b, &target, true) && a.open && b.open);
    CHECK(!file_lock_take(&c, &target, false));
    file_lock_release(&a);
    holds(target.path, "");
    CHECK(!file_lock_take(&c, &target, false));
    file_lock_release(&b);
    CHECK(!file_exists(target.path));
    /* Without a lock, where there can be none. */
    CHECK(file_lock_take(&a, &nowhere, false) && !a.open);
    test_write_text(target.path, "a file of the user");
    CHECK(file_lock_take(&a, &target, false));
    file_lock_release(&a);
    holds(target.path, "a file of the user");
}

/* The file of the run before is removed between opening and locking it, as often as may be. */
TEST(processes_that_take_one_lock_in_turn_never_have_it_together) {
    char path[4096], single_path[4096];
    (void)snprintf(path, sizeof path, "%s", test_path("lock"));
    (void)snprintf(single_path, sizeof single_path, "%s", test_path("single"));
    const struct file_target target = {.path = path};
    enum { PROCESSES = 4, TURNS = 200 };
    pid_t children[PROCESSES];
    for (int k = 0; k < PROCESSES; k++) {
        children[k] = fork();
        if (children[k] != 0)
            continue;
        int failed = 0;
        for (int turn = 0; turn < TURNS; turn++) {
            struct file_lock lock;
            if (!file_lock_take(&lock, &target, false))
                continue;
            int single = open(single_path, O_CREAT | O_EXCL | O_WRONLY, 0600);
            failed += single < 0 || unlink(single_path) != 0;
            (void)close(single);
            file_lock_release(&lock);
        }
        _exit(failed != 0);
    }
    for (int k = 0; k < PROCESSES; k++) {
        int how = -1;
        CHECK(waitpid(children[k], &how, 0) == children[k] && WIFEXITED(how) && WEXITSTATUS(how) == 0);
    }
    CHECK(!file_exists(target.path));
}

TEST(a_set_of_files_holds_what_was_added_and_not_removed) {
    struct file_set set = {0};
    for (uint64_t i = 1; i <= 3000; i++)
        CHECK(file_set_add(&set, (struct file_identity){i % 7, i}) &&
              file_set_add(&set, (struct file_identity){i % 7, i}));
    CHECK_EQ_INT(set.count, 3000);
    for (uint64_t i = 1; i <= 3000; i += 3)
        file_set_remove(&set, (struct file_identity){i % 7, i});
    for (uint64_t i = 1; i <= 3000; i++)
        CHECK(file_set_has(&set, (struct file_identity){i % 7, i}) == (i % 3 != 1));
    CHECK_EQ_INT(set.count, 2000);
    file_set_destroy(&set);
}

/* Waits for the reader of a pipe. */

static struct test_result run_in_shell(const char *line) {
    return (struct test_result){.status = test_run_shell(line, "")};
}

#define BALL                                                                                                           \
    "local r = gr.node('r') r:add_child(gr.sphere(gr.material({1, 1, 1}, {0, 0, 0}, 1)))\n"                            \
    "gr.render(r, 'a.png', W, W, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 50, {1, 1, 1}, {})\n"

/* The program runs until it blocks, and ends at the signal, which it blocks, to read it, soon after its start. */
#define AWAIT_HANDLER "await 'grep -q \"SigBlk:.*[1-9a-f]\" /proc/$pid/status'; sleep 0.5; "
static void ends_at(const char *signal, const char *begin, const char *then) {
    char line[1024];
    (void)snprintf(line, sizeof line,
                   "env --default-signal=%s $gray -q %s & pid=$!; %s; " AWAIT_HANDLER "kill -%s $pid; wait $pid",
                   signal, begin, then, signal);
    CHECK_EQ_INT(run_in_shell(line).status, 130);
    CHECK_EQ_INT(run_in_shell("cat err.txt; test \"$(grep -c 'gray: interrupted, ' err.txt)\" = 1").status, 0);
}

TEST(a_pipe_without_a_reader_ends_at_a_signal) {
    test_write_text(test_path("scene.lua"), "W = 8\n" BALL);
    CHECK(mkfifo(test_path("pipe"), 0666) == 0);
    ends_at("INT", "-o pipe scene.lua 2>err.txt", "true");
    ends_at("TERM", "-o pipe scene.lua 2>err.txt", "true");
}

TEST(a_reader_that_stopped_reading_does_not_hold_the_run) {
    test_write_text(test_path("scene.lua"), "W = 2500\n" BALL);
    CHECK(mkfifo(test_path("pipe.pfm"), 0666) == 0);
    ends_at("TERM", "-o pipe.pfm scene.lua 2>err.txt", "(exec 3<pipe.pfm; exec sleep 1000) & true");
    CHECK_EQ_INT(run_in_shell("{ env --default-signal=INT $gray -q -o - scene.lua 2>err.txt & pid=$!; " AWAIT_HANDLER
                              "kill -INT $pid; wait $pid; echo $? >status.txt; } | await 'test -s status.txt'; "
                              "grep -q 130 status.txt && grep -q 'gray: interrupted, - is not written' err.txt")
                     .status,
                 0);
}
