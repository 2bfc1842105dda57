/* Temporary files of killed runs: which ones the next run in the folder removes. The rows are attacks: see attack.h.
 * The change time of a file cannot be set, so the check runs inside the test, whose clock is ahead.
 */
#define _GNU_SOURCE
#include "base/file_output.h"
#include "tests/attack.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define LEFT ".gray.part-0123456789abcdef"

/* The check of a picture's name that every run makes before rendering. */
static int check_later(const char *picture, time_t seconds) {
    struct file_guard guard = {0};
    const struct file_rules rules = {.guard = &guard, .role = FILE_ROLE_PICTURE};
    const struct file_target target = {.path = picture, .rules = &rules};
    struct error error;
    attack_set_clock(seconds);
    bool ok = file_output_check(&target, &error);
    file_guard_destroy(&guard);
    return ok ? 0 : 1;
}

static int an_hour_later(void) {
    return check_later("x.png", 3600);
}

static int half_a_minute_later(void) {
    return check_later("x.png", 30);
}

static int an_hour_later_in_a_folder(void) {
    return check_later("d/x.png", 3600);
}

TEST(hostile_the_next_run_removes_only_what_a_kill_has_left) {
    static const struct attack rows[] = {
        {.name = "a file that was left", .before = "png " LEFT, .inside = an_hour_later, .after = "gone " LEFT},
        {.name = "an empty one without rights",
         .before = "empty " LEFT "; mode " LEFT " 600",
         .inside = an_hour_later,
         .after = "gone " LEFT},
        {.name = "several, in a folder",
         .inside = an_hour_later_in_a_folder,
         .before = "dir d; empty d/.gray.part-0000000000000000; png d/" LEFT,
         .after = "gone d/.gray.part-0000000000000000; gone d/" LEFT},
        {.name = "in another folder than the picture's", .before = "dir d; png d/" LEFT, .inside = an_hour_later},
        {.name = "in the folder above the picture's",
         .before = "dir d; png " LEFT,
         .inside = an_hour_later_in_a_folder},
        {.name = "younger than a minute", .before = "png " LEFT, .inside = half_a_minute_later},
        {.name = "from a time to come", .before = "png " LEFT "; age " LEFT " -7200", .inside = an_hour_later},
        {.name = "with an old date that was just given to it",
         .before = "png " LEFT "; age " LEFT " 3600",
         .inside = half_a_minute_later},
        {.name = "another user's",
         .before = "png " LEFT "; owner " LEFT " 12345",
         .inside = an_hour_later,
         .flags = ATTACK_BY_ROOT},
        {.name = "a link", .before = "link " LEFT " ../out/canary.png", .inside = an_hour_later},
        {.name = "a link that leads nowhere", .before = "link " LEFT " nowhere", .inside = an_hour_later},
        {.name = "a folder", .before = "dir " LEFT, .inside = an_hour_later},
        {.name = "a FIFO", .before = "fifo " LEFT, .inside = an_hour_later},
        {.name = "a FIFO with a reader", .before = "fifo " LEFT "; reader " LEFT, .inside = an_hour_later},
        {.name = "a socket", .before = "socket " LEFT, .inside = an_hour_later},
        {.name = "a device", .before = "null " LEFT, .inside = an_hour_later, .flags = ATTACK_BY_ROOT},
        {.name = "a link to a terminal", .before = "tty " LEFT, .inside = an_hour_later},
        {.name = "a second name of a file outside goes, and the file stays",
         .before = "hard " LEFT " ../out/canary.png",
         .inside = an_hour_later,
         .after = "gone " LEFT},
        {.name = "the folder is a link",
         .before = "dir e; link d e; png e/" LEFT,
         .inside = an_hour_later_in_a_folder,
         .after = "gone e/" LEFT},
    };
    ATTACKS(rows);
}

TEST(hostile_the_next_run_removes_only_files_with_names_of_temporary_files) {
    static const struct attack rows[] = {
        {.name = "a digit too few", .before = "png .gray.part-0123456789abcde", .inside = an_hour_later},
        {.name = "a digit too many", .before = "png " LEFT "0", .inside = an_hour_later},
        {.name = "no digits", .before = "png .gray.part-0123456789abcdeg", .inside = an_hour_later},
        {.name = "nothing after the dash", .before = "png .gray.part-", .inside = an_hour_later},
        {.name = "capitals", .before = "png .gray.part-0123456789ABCDEF", .inside = an_hour_later},
        {.name = "a blank among the digits", .before = "png .gray.part-%20123456789abcdef", .inside = an_hour_later},
        {.name = "a sign among the digits", .before = "png .gray.part--123456789abcdef", .inside = an_hour_later},
        {.name = "a prefix of another base", .before = "png .gray.part-0x23456789abcdef", .inside = an_hour_later},
        {.name = "a line end after the digits", .before = "png " LEFT "%0a", .inside = an_hour_later},
        {.name = "another beginning",
         .before = "png x.gray.part-0123456789abcdef; png .grey.part-0123456789abcdef",
         .inside = an_hour_later},
        {.name = "a backup of one", .before = "png " LEFT "~", .inside = an_hour_later},
        {.name = "digits of another script",
         .before = "png .gray.part-\xd9\xa1\xd9\xa1\xd9\xa1\xd9\xa1\xd9\xa1\xd9\xa1\xd9\xa1\xd9\xa1",
         .inside = an_hour_later},
    };
    ATTACKS(rows);
}

/* Two runs that do not use the folder: the check of a scene outside, and a scene that is refused. */
TEST(hostile_a_scene_cannot_have_files_removed_elsewhere) {
    static const struct attack rows[] = {
        {.name = "the folder is a link outside",
         .before = "link d ../out; png ../out/" LEFT "; age ../out/" LEFT " 90",
         .scene = "p'd/x.png'",
         .status = 1},
        {.name = "the folder above", .before = "png ../out/" LEFT, .scene = "p'../out/x.png'", .status = 1},
        {.name = "a picture named as one", .scene = "p'" LEFT "'", .status = 1},
        {.name = "a picture named as one under --lenient", .options = "--lenient", .scene = "p'" LEFT "'", .status = 1},
    };
    ATTACKS(rows);
}

static void spared(const char *what, int lock) {
    char in[600], path[700];
    (void)snprintf(in, sizeof in, "%s/%d", test_folder(), lock);
    (void)snprintf(path, sizeof path, "%s/%s", in, LEFT);
    CHECK(mkdir(in, 0755) == 0 && attack_prepare(in, "png " LEFT));
    int owner = open(path, O_RDWR | O_CLOEXEC), here = open(".", O_PATH | O_DIRECTORY | O_CLOEXEC);
    CHECK(owner >= 0 && flock(owner, lock | LOCK_NB) == 0 && chdir(in) == 0);
    (void)an_hour_later();
    bool stays = access(LEFT, F_OK) == 0;
    (void)close(owner);
    (void)an_hour_later();
    bool goes = access(LEFT, F_OK) != 0;
    CHECK(fchdir(here) == 0);
    (void)close(here);
    attack_report(what, 0, !stays ? "it was removed while it was locked" : !goes ? "it was not removed later" : NULL);
}

TEST(hostile_the_next_run_spares_a_file_that_a_process_still_writes) {
    spared("a file with the lock of its writer", LOCK_EX);
    spared("a file with a shared lock", LOCK_SH);
}

/* The whole program with a real minute. */
TEST_LONG(hostile_a_run_removes_what_was_left_more_than_a_minute_ago) {
    char in[600], path[700];
    (void)snprintf(in, sizeof in, "%s/in", test_folder());
    (void)snprintf(path, sizeof path, "%s/scene.lua", in);
    CHECK(mkdir(in, 0755) == 0 && attack_prepare(in, "png " LEFT));
    char *scene = NULL;
    CHECK(asprintf(&scene, "%sp'x.png'\n", attack_prelude) > 0);
    test_write_text(path, scene);
    free(scene);
    (void)snprintf(path, sizeof path, "%s/%s", in, LEFT);
    CHECK_EQ_INT(attack_wait(attack_start(in, "-q scene.lua", 0), ATTACK_PATIENCE), 0);
    CHECK(access(path, F_OK) == 0);
    attack_rest(63);
    CHECK_EQ_INT(attack_wait(attack_start(in, "-q scene.lua", 0), ATTACK_PATIENCE), 0);
    CHECK(access(path, F_OK) != 0);
}
