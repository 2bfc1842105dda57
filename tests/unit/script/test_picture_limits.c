/* --picture-count and --picture-bytes: how many pictures the scripts of a run may render, and how much is written for
 * them. A limit ends the script with one error that cannot be caught, and finished pictures stay. */
#include "image/exr.h"
#include "session/options.h"
#include "tests/harness.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define RENDER(name) "gr.render{node=n, file=" name ", width=8, height=8, eye={0, 0, 9}}"

static void forget(struct test_result result) {
    test_free_result(&result);
}

static bool ends_in(const char *name, const char *ending) {
    size_t length = strlen(name), wanted = strlen(ending);
    return length >= wanted && strcmp(name + length - wanted, ending) == 0;
}

/* The number of files in the test's folder with this extension; *bytes: their total size. */
static int count_files(const char *ending, long long *bytes) {
    int count = 0;
    DIR *folder = opendir(test_folder());
    *bytes = 0;
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        struct stat status;
        if (!ends_in(entry->d_name, ending) || stat(test_path(entry->d_name), &status) != 0 || !S_ISREG(status.st_mode))
            continue;
        count++;
        *bytes += status.st_size;
    }
    if (folder)
        (void)closedir(folder);
    return count;
}

static void remove_pictures(void) {
    DIR *folder = opendir(test_folder());
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;)
        if (ends_in(entry->d_name, ".png") || ends_in(entry->d_name, ".part") || ends_in(entry->d_name, ".tiles"))
            (void)unlink(test_path(entry->d_name));
    if (folder)
        (void)closedir(folder);
}

/* One line with these words, status 1, and no incomplete files. */
static void check_limit(const char *text, const char *arguments, const char *words) {
    struct test_result result = test_gray_scene(text, arguments, NULL);
    long long bytes;
    const char *end = strchr(result.err, '\n');
    if (result.status != 1 || !strstr(result.err, words) || !end || end[1] != '\0')
        test_fail(__FILE__, __LINE__, "%s (%s): status %d: %.500s", text, arguments, result.status, result.err);
    DIR *folder = opendir(test_folder());
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;)
        if (strncmp(entry->d_name, ".gray", 5) == 0)
            test_fail(__FILE__, __LINE__, "%s (%s): %s is left", text, arguments, entry->d_name);
    if (folder)
        (void)closedir(folder);
    (void)count_files(".png", &bytes);
    forget(result);
}

#define AGAIN(arguments) "while true do pcall(gr.render, " arguments ") end"

static const char *const loops[] = {
    "local n = gr.node('n') while true do " RENDER("'a.png'") " end",
    "local n = gr.node('n') for i = 1, math.huge do " RENDER("i .. '.png'") " end",
    "local n = gr.node('n') while true do pcall(function() " RENDER("'a.png'") " end) end",
    "local n = gr.node('n') while true do xpcall(function() " RENDER(
        "'a.png'") " end, function() while true do end end) "
                   "end",
    "local n = gr.node('n') while true do coroutine.wrap(function() pcall(function() " RENDER(
        "'a.png'") " end) end)() end",
    "local n = gr.node('n') while true do local c <close> = setmetatable({}, {__close = function() " RENDER(
        "'a.png'") " end}) end",
    "local n = gr.node('n') local function again() pcall(again) " RENDER("'a.png'") " return again() end again()",
    /* a picture that cannot be made counts, too */
    "local n = gr.node('n') while true do pcall(function() " RENDER("'/outside.png'") " end) end",
    "local t = {gr.node('n'), 'a.png', 8, 8, {0,0,9}, {0,0,0}, {0,1,0}, 50, {1,1,1}, {}}\n" AGAIN("table.unpack(t)"),
    "local n = gr.node('n') while true do pcall(gr.render, {node=n, file='', width=8, height=8, eye={0, 0, 9}}) end",
    /* other functions do not avoid the limit */
    "local n = gr.node('n') while true do n:render{file='a.png', width=8, height=8, eye={0, 0, 9}} end",
};

static const char *const variants[] = {
    "",
    "-q",
    "-j 1",
    "-o p%d.png",
    "--check",
    "--shard 1/2",
    "--shard-pictures 1/3",
    "--shard-pictures 3/3",
    "--checkpoint c.tiles",
    "--checkpoint c.tiles --checkpoint-every 0",
    "--no-fork",
    "--pixel 1,1 -q",
    "--quick --size 2x2",
};

/* Endless render loops end, however they handle errors. */
TEST(a_loop_of_pictures_ends_at_the_picture_count) {
    for (size_t i = 0; i < sizeof loops / sizeof *loops; i++) {
        struct test_result result =
            test_gray_scene(loops[i], "-q --script-time 0.3 --picture-count 20 scene.lua", NULL);
        long long bytes;
        if (result.status != 1)
            test_fail(__FILE__, __LINE__, "%s: status %d: %.500s", loops[i], result.status, result.err);
        CHECK(count_files(".png", &bytes) <= 20);
        forget(result);
        remove_pictures();
    }
}

TEST(the_picture_count_is_one_line_and_is_caught_by_nothing) {
    for (size_t i = 0; i < 9; i++) {
        check_limit(loops[i], "-q --script-time 2 --picture-count 20 scene.lua",
                    "gr.render: the scripts render more than 20 pictures (--picture-count allows more)");
        remove_pictures();
    }
}

TEST(the_picture_count_holds_for_every_render_call) {
    char arguments[256];
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
        (void)snprintf(arguments, sizeof arguments, "%s --script-time 2 --picture-count 20 scene.lua", variants[i]);
        struct test_result result = test_gray_scene(loops[2], arguments, NULL);
        if (result.status != 1 || !strstr(result.err, "the scripts render more than 20 pictures"))
            test_fail(__FILE__, __LINE__, "%s: status %d: %.500s", variants[i], result.status, result.err);
        forget(result);
        remove_pictures();
    }
}

/* Pictures that --resume finds finished are counted as well: the second run ends at the same place. */
TEST(pictures_that_are_there_already_count) {
    static const char text[] = "local n = gr.node('n') for i = 1, math.huge do " RENDER("'p' .. i .. '.png'") " end";
    long long bytes;
    check_limit(text, "-q --picture-count 8 --checkpoint c.tiles scene.lua", "more than 8 pictures");
    CHECK_EQ_INT(count_files(".png", &bytes), 8);
    check_limit(text, "-q --picture-count 8 --checkpoint c.tiles --resume scene.lua", "more than 8 pictures");
    CHECK_EQ_INT(count_files(".png", &bytes), 8);
    check_limit(text, "-q --picture-count 12 --checkpoint c.tiles --resume scene.lua", "more than 12 pictures");
    CHECK_EQ_INT(count_files(".png", &bytes), 12);
}

TEST(as_many_pictures_as_are_allowed_are_made_and_stay) {
    static const char text[] = "local n = gr.node('n') for i = 1, 5 do " RENDER("'p' .. i .. '.png'") " end";
    long long bytes;
    struct test_result result = test_gray_scene(text, "-q --picture-count 5 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    forget(result);
    remove_pictures();
    check_limit(text, "-q --picture-count 4 scene.lua", "more than 4 pictures");
    CHECK_EQ_INT(count_files(".png", &bytes), 4);
    for (int i = 1; i <= 4; i++) {
        char name[32];
        (void)snprintf(name, sizeof name, "p%d.png", i);
        struct test_picture picture = test_read_picture(test_path(name));
        CHECK(picture.width == 8 && picture.height == 8);
        free(picture.rgb);
    }
    remove_pictures();
    check_limit(text, "-q --picture-count 1 scene.lua", "more than 1 picture (");
}

/* The run has one limit for all its scripts; each that exceeds it gets its line. */
TEST(the_scripts_of_a_run_share_the_picture_count) {
    long long bytes;
    test_write_text(test_path("a.lua"), "local n = gr.node('n') for i = 1, 3 do " RENDER("'a' .. i .. '.png'") " end");
    test_write_text(test_path("b.lua"), "local n = gr.node('n') for i = 1, 3 do " RENDER("'b' .. i .. '.png'") " end");
    struct test_result result = test_gray(NULL, "-q --picture-count 4 a.lua b.lua a.lua");
    CHECK_EQ_INT(result.status, 1);
    CHECK_TEXT(result.err,
               "b.lua:1: gr.render: the scripts render more than 4 pictures (--picture-count allows more)\n"
               "a.lua:1: gr.render: the scripts render more than 4 pictures (--picture-count allows more)\n");
    CHECK_EQ_INT(count_files(".png", &bytes), 4);
    forget(result);
}

TEST(the_limits_on_pictures_have_defaults_and_none_without_the_sandbox) {
    struct options standard = {.picture_count = 0}, trusted = {.script = {.no_sandbox = true}}, small = trusted;
    struct error error;
    small.picture_count = 3;
    small.picture_bytes = 1000;
    CHECK(options_allow_picture(&standard, 100000, &error) && !options_allow_picture(&standard, 100001, &error));
    CHECK(error.limit && error.kind == ERROR_SCENE);
    CHECK_TEXT(error.text, "the scripts render more than 100000 pictures (--picture-count allows more)");
    CHECK(options_allow_picture(&trusted, UINT64_MAX, &error) && !options_allow_picture(&small, 4, &error));
    CHECK(options_picture_bytes(&standard) == UINT64_C(64) << 30);
    CHECK(options_picture_bytes(&trusted) == UINT64_MAX && options_picture_bytes(&small) == 1000);
}

/* --- bytes --- */

/* 100 x 100 pixels of three floats: 120,000 bytes and a header. */
#define PFM(name) "gr.render{node=n, file=" name ", width=100, height=100, eye={0, 0, 9}}"

TEST(what_exceeds_the_picture_bytes_is_not_written_and_what_was_finished_stays) {
    static const char words[] =
        "is not written: the pictures of the run take more than 300 KiB (--picture-bytes allows "
        "more)";
    long long bytes;
    check_limit("local n = gr.node('n') for i = 1, 9 do " PFM("'p' .. i .. '.pfm'") " end",
                "-q --picture-bytes 300K scene.lua", words);
    CHECK_EQ_INT(count_files(".pfm", &bytes), 2);
    CHECK(bytes > 240000 && bytes < 241000);
    /* Replaced files count as written, too. */
    check_limit("local n = gr.node('n') while true do pcall(function() " PFM("'same.pfm'") " end) end",
                "-q --picture-bytes 300K scene.lua", words);
    CHECK_EQ_INT(count_files("same.pfm", &bytes), 1);
    CHECK(bytes > 120000);
    /* A single picture larger than the limit. */
    check_limit("local n = gr.node('n') " PFM("'large.pfm'"), "-q --picture-bytes 100K scene.lua",
                "large.pfm: is not written: the pictures of the run take more than 100 KiB");
    CHECK_EQ_INT(count_files("large.pfm", &bytes), 0);
}

/* Every format, and every file that is written beside a picture. */
TEST(every_file_of_a_picture_counts_towards_the_picture_bytes) {
    static const char *const files[] = {"hdr", "pfm", "exr", "png"};
    static const char *const more[] = {
        "--aov all",  "-write-pre-aa x",    "-write-aa-targets x", "--shard 1/1",     "-o p.pfm",
        "-o p%d.pfm", "-o p.pfm --no-fork", "--partial",           "--deep -o p.png",
    };
    char text[512], arguments[256];
    long long bytes;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        if (strcmp(files[i], "exr") == 0 && !exr_can_write())
            continue;
        (void)snprintf(text, sizeof text,
                       "local n = gr.node('n') n:add_child(gr.sphere{material=gr.material({1, 1, 1}, {0, 0, 0}, 1)})\n"
                       "while true do gr.render{node=n, file='p.%s', width=200, height=200, eye={0, 0, 9}} end",
                       files[i]);
        check_limit(text, "-q --picture-bytes 9K scene.lua", "--picture-bytes allows more");
    }
    check_limit("local n = gr.node('n') n:add_child(gr.sphere{material=gr.material({1, 1, 1}, {0, 0, 0}, 1)})\n"
                "gr.render{node=n, file='p.png', width=200, height=200, eye={0, 0, 9}}",
                "-q --picture-bytes 1K -o - scene.lua", "standard output: is not written: the pictures of the run");
    (void)snprintf(text, sizeof text, "local n = gr.node('n') " PFM("'q.pfm'"));
    for (size_t i = 0; i < sizeof more / sizeof *more; i++) {
        (void)snprintf(arguments, sizeof arguments, "-q %s --picture-bytes 2K scene.lua", more[i]);
        struct test_result result = test_gray_scene(text, arguments, NULL);
        if (result.status != 1 || !strstr(result.err, "--picture-bytes allows more"))
            test_fail(__FILE__, __LINE__, "%s: status %d: %.500s", more[i], result.status, result.err);
        forget(result);
        CHECK(count_files(".pfm", &bytes) == 0 || bytes < 2048);
        CHECK(count_files(".part", &bytes) == 0);
    }
}

TEST(exactly_as_many_bytes_as_are_allowed_are_written_and_then_nothing_is_begun) {
    static const char text[] = "local n = gr.node('n') for i = 1, 2 do gr.render{node=n, file=i .. '.pfm', width=100,\n"
                               "height=157, eye={0, 0, 9}} end"; /* 184 KiB each */
    long long bytes;
    check_limit(text, "-q --picture-bytes 184K scene.lua",
                "gr.render: the pictures of the run take more than 184 KiB (--picture-bytes allows more)");
    CHECK_EQ_INT(count_files(".pfm", &bytes), 1);
    CHECK_EQ_INT(bytes, 184 << 10);
    struct test_result result = test_gray_scene(text, "-q --picture-bytes 368K scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_EQ_INT(count_files(".pfm", &bytes), 2);
    CHECK_EQ_INT(bytes, 368 << 10);
    forget(result);
}

/* --script-output limits what scripts print and write. */
TEST(pictures_and_the_output_of_a_script_have_limits_of_their_own) {
    struct test_result result = test_gray_scene("local n = gr.node('n') for i = 1, 5 do " PFM("i .. '.pfm'") " end",
                                                "-q --script-output 1K scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    forget(result);
    result = test_gray_scene("for i = 1, 1000 do print(('x'):rep(100)) end", "-q --picture-bytes 1K scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    forget(result);
    check_limit("for i = 1, 1000 do print(('x'):rep(100)) end", "-q --script-output 10K scene.lua",
                "the script printed more than its 10 KiB (--script-output allows more)");
}
