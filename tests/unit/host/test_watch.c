/* Watching: which changes count, and the program that renders again. The tests observe the program's files and
 * messages; nothing depends on its speed. */
#define _GNU_SOURCE
#include "base/mem.h"
#include "host/file_watch.h"
#include "tests/harness.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const char *at(const char *name) {
    return test_path(name);
}

struct output_of_tests {
    struct watch watch;
    double now;
};

static void watch_files(struct output_of_tests *t, const char *const *names) {
    struct error error;
    *t = (struct output_of_tests){.now = 10};
    CHECK(watch_open(&t->watch, &error));
    for (; *names; names++) {
        struct file_version version;
        CHECK(file_version_of(at(*names), NULL, &version));
        CHECK(watch_add(&t->watch, at(*names), &version, t->now));
    }
}

/* After a second without changes. */
static bool changed(struct output_of_tests *t) {
    watch_read(&t->watch, t->now);
    t->now += 1;
    return watch_changed(&t->watch, t->now);
}

TEST(watch_reports_another_content_once_and_the_same_content_never) {
    struct output_of_tests t;
    test_write_text(at("a.lua"), "one");
    test_write_text(at("b.obj"), "two");
    watch_files(&t, (const char *const[]){"a.lua", "b.obj", NULL});
    CHECK(!changed(&t));
    test_write_text(at("a.lua"), "one"); /* saved without a change */
    CHECK(!changed(&t));
    test_write_text(at("c.lua"), "of no interest");
    CHECK(!changed(&t));
    test_write_text(at("a.lua"), "other");
    CHECK(changed(&t) && !t.watch.assets_differ);
    CHECK(!changed(&t));
    test_write_text(at("b.obj"), "2");
    CHECK(changed(&t) && t.watch.assets_differ);
    CHECK(!changed(&t));
    watch_close(&t.watch);
}

TEST(watch_notices_files_that_are_renamed_over_and_files_behind_links) {
    struct output_of_tests t;
    CHECK(system(NULL) != 0);
    char line[9000];
    (void)snprintf(line, sizeof line, "cd '%s' && mkdir far && echo 1 >far/real.lua && ln -s far/real.lua link.lua",
                   test_folder());
    CHECK(system(line) == 0);
    test_write_text(at("a.lua"), "one");
    watch_files(&t, (const char *const[]){"a.lua", "link.lua", NULL});
    CHECK(!changed(&t));
    test_write_text(at("a.tmp"), "new");
    CHECK(rename(at("a.tmp"), at("a.lua")) == 0);
    CHECK(changed(&t));
    /* Of the same size, written within the same tick of the clock. */
    struct stat old;
    CHECK(stat(at("a.lua"), &old) == 0);
    test_write_text(at("a.tmp"), "now");
    CHECK(utimensat(AT_FDCWD, at("a.tmp"), (const struct timespec[]){old.st_atim, old.st_mtim}, 0) == 0);
    CHECK(rename(at("a.tmp"), at("a.lua")) == 0);
    CHECK(changed(&t));
    test_write_text(at("far/real.lua"), "2");
    CHECK(changed(&t));
    CHECK(!changed(&t));
    /* A folder that is replaced completely. */
    (void)snprintf(line, sizeof line, "cd '%s' && mv far old && mkdir far && echo 3 >far/real.lua", test_folder());
    CHECK(system(line) == 0);
    CHECK(changed(&t));
    test_write_text(at("far/real.lua"), "4");
    CHECK(changed(&t));
    watch_close(&t.watch);
}

TEST(watch_waits_until_editors_are_done_and_minds_what_changed_before_it_looked) {
    struct output_of_tests t;
    test_write_text(at("a.lua"), "one");
    struct file_version version;
    struct error error;
    CHECK(file_version_of(at("a.lua"), NULL, &version));
    test_write_text(at("a.lua"), "it changed while it was read");
    t = (struct output_of_tests){.now = 10};
    CHECK(watch_open(&t.watch, &error));
    CHECK(watch_add(&t.watch, at("a.lua"), &version, t.now));
    CHECK(!watch_changed(&t.watch, t.now + 0.01));
    CHECK(changed(&t));
    test_write_text(at("a.lua"), "first half");
    watch_read(&t.watch, t.now);
    CHECK(!watch_changed(&t.watch, t.now + 0.03));
    test_write_text(at("a.lua"), "first half and second half");
    watch_read(&t.watch, t.now + 0.03);
    CHECK(!watch_changed(&t.watch, t.now + 0.07));
    CHECK(watch_changed(&t.watch, t.now + 0.2));
    watch_close(&t.watch);
}

TEST(watch_of_a_run_that_failed_minds_files_that_appear) {
    struct output_of_tests t;
    test_write_text(at("a.lua"), "require 'b'");
    watch_files(&t, (const char *const[]){"a.lua", NULL});
    CHECK(!changed(&t));
    test_write_text(at("x.lua"), "");
    CHECK(!changed(&t));
    watch_settle(&t.watch, true, t.now);
    CHECK(!changed(&t));
    test_write_text(at(".b.lua.swp"), "");
    CHECK(!changed(&t));
    test_write_text(at("b.lua"), "");
    CHECK(changed(&t));
    watch_close(&t.watch);
}

/* The program. */

static pid_t start(const char *words) {
    char line[9000];
    (void)snprintf(line, sizeof line, "cd '%s' && exec '%s' %s >out.txt 2>err.txt", test_folder(), test_program(),
                   words);
    pid_t child = fork();
    if (child == 0) {
        (void)execl("/bin/sh", "sh", "-c", line, (char *)NULL);
        _exit(127);
    }
    return child;
}

static int count_of(const char *word) {
    char *text = test_read_file(at("err.txt"), NULL);
    int count = 0;
    for (const char *found = text; found && (found = strstr(found, word)) != NULL; found += strlen(word))
        count++;
    free(text);
    return count;
}

/* Waits until standard error contains `word` this many times; the harness ends a test that takes too long. */
static void wait_for(const char *word, int times) {
    const struct timespec pause = {0, 5000000};
    while (count_of(word) < times)
        (void)nanosleep(&pause, NULL);
    CHECK(count_of(word) == times);
}

static int end(pid_t child) {
    int how = 0;
    (void)kill(child, SIGTERM);
    CHECK(waitpid(child, &how, 0) == child);
    return WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
}

static void write_scene(const char *colour) {
    char text[512];
    (void)snprintf(text, sizeof text, "return %s\n", colour);
    test_write_text(at("colour.lua"), text);
    test_write_text(at("scene.lua"), "local r = gr.node('root')\n"
                                     "r:add_child(gr.geometry('b', gr.sphere(gr.material(dofile('colour.lua'), "
                                     "{0.5, 0.5, 0.5}, 20))))\n"
                                     "gr.render(r, 'out.png', 60, 40, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, "
                                     "{0.2, 0.2, 0.2}, {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})})\n");
}

static uint32_t middle(void) {
    struct test_picture picture = test_read_picture(at("out.png"));
    const uint8_t *rgb = picture.rgb + 3 * ((size_t)20 * picture.width + 30);
    uint32_t value = (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
    free(picture.rgb);
    return value;
}

static const char waiting[] = "waiting for changes";

TEST(watching_renders_again_keeps_the_old_picture_on_an_error_and_recovers) {
    write_scene("{0.8, 0.1, 0.1}");
    pid_t child = start("--watch scene.lua");
    wait_for(waiting, 1);
    uint32_t red = middle();
    CHECK((red >> 16) > (red & 255));
    /* Like editors: a new file, renamed over the old one. */
    test_write_text(at("colour.new"), "return {0.1, 0.1, 0.8}\n");
    CHECK(rename(at("colour.new"), at("colour.lua")) == 0);
    wait_for(waiting, 2);
    uint32_t blue = middle();
    CHECK((blue >> 16) < (blue & 255));
    test_write_text(at("colour.lua"), "return {0.1, 0.1\n");
    wait_for(waiting, 3);
    CHECK_EQ_INT(count_of("colour.lua:2:"), 1);
    CHECK_EQ_INT(middle(), blue);
    test_write_text(at("colour.lua"), "return {0.8, 0.1, 0.1}\n");
    wait_for(waiting, 4);
    CHECK_EQ_INT(middle(), red);
    CHECK_EQ_INT(end(child), 0);
}

TEST(watching_reads_a_mesh_again_that_has_changed_and_finds_one_that_was_missing) {
    test_write_text(at("scene.lua"), "local r = gr.node('root')\n"
                                     "r:add_child(gr.geometry('m', gr.mesh('m', 'm.obj')))\n"
                                     "gr.render(r, 'out.png', 60, 40, {0, 0, 3}, {0, 0, -1}, {0, 1, 0}, 40, "
                                     "{0.9, 0.9, 0.9}, {})\n");
    pid_t child = start("--watch scene.lua");
    wait_for(waiting, 1);
    CHECK(access(at("out.png"), F_OK) != 0);
    test_write_text(at("m.obj"), "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n");
    wait_for(waiting, 2);
    uint32_t seen = middle();
    test_write_text(at("m.obj"), "v -1 -1 0\nv 1 -1 0\nv 0 -0.9 0\nf 1 2 3\n");
    wait_for(waiting, 3);
    CHECK(middle() != seen);
    CHECK_EQ_INT(end(child), 0);
}

TEST(watching_stops_a_picture_whose_scene_has_changed) {
    test_write_text(at("scene.lua"), "gr.render(gr.node('nothing'), 'out.png', 1500, 1500, {0, 0, 6}, {0, 0, -1}, "
                                     "{0, 1, 0}, 40, {0.2, 0.2, 0.2}, {})\n");
    /* Minutes of work that is never finished. */
    pid_t child = start("--watch -full -ss 64 --progress=none --verbose scene.lua");
    wait_for("confine", 1);
    const struct timespec pause = {0, 100000000};
    (void)nanosleep(&pause, NULL);
    test_write_text(at("scene.lua"), "gr.render(gr.node('nothing'), 'out.png', 20, 10, {0, 0, 6}, {0, 0, -1}, "
                                     "{0, 1, 0}, 40, {0.2, 0.2, 0.2}, {})\n");
    wait_for(waiting, 1);
    CHECK(access(at("out.png"), F_OK) == 0);
    CHECK_EQ_INT(end(child), 0);
}

TEST(watching_goes_with_no_run_in_parts) {
    struct test_result result = test_gray_scene("", "--watch --shard 1/2 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 2);
    CHECK(strstr(result.err, "--watch cannot be combined with") != NULL);
    test_free_result(&result);
}
