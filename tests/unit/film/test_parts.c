/* Pictures made in several runs: checkpoints, --resume, --shard and gray merge. However the work was interrupted or
 * divided, the bytes are those of one complete run; parts that do not belong together are refused. */
#define _GNU_SOURCE
#include "film/tile_file.h"
#include "render/render.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Two balls, a mirror and soft light. */
#define SCENE                                                                                                          \
    "local r = gr.node('root')\n"                                                                                      \
    "r:add_child(gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20))))\n"                 \
    "local m = gr.geometry('box', gr.cube(gr.rr_material({0.1, 0.1, 0.1}, {1, 1, 1}, 50, 0.7, 0, 1)))\n"               \
    "m:translate(0.4, -1.4, 0.3)\n"                                                                                    \
    "r:add_child(m)\n"                                                                                                 \
    "local l = gr.area_light({4, 5, 6}, {1, 0, 0}, {0, 1, 0}, {0.9, 0.9, 0.9}, {1, 0, 0})\n"                           \
    "local function picture(name, w, h)\n"                                                                             \
    "  gr.render(r, name, w, h, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, {l})\n"                         \
    "end\n"
#define ONE SCENE "picture('out.png', 330, 250)\n"
#define THREE SCENE "picture('a.png', 130, 70)\npicture('b.png', 90, 110)\npicture('c.png', 100, 100)\n"

/* err.txt takes standard error of the whole line. */
static int shell(const char *line) {
    return test_run_shell(line, "2>err.txt");
}

static void put(const char *name, const char *text) {
    test_write_text(test_path(name), text);
}

static bool exists(const char *name) {
    return access(test_path(name), F_OK) == 0;
}

static void gives(const char *line, int status, const char *says) {
    test_shell_errors(line, status, says);
}

TEST(any_number_of_shards_gives_the_bytes_of_one_run) {
    put("scene.lua", ONE);
    gives("$gray scene.lua -q", 0, NULL);
    for (int shards = 1; shards <= 16; shards += shards < 4 ? 1 : 6) {
        char line[1024];
        (void)snprintf(line, sizeof line,
                       "for i in $(seq %d); do $gray scene.lua -q -j $((i %% 3 + 1)) -o new.png --shard $i/%d || exit; "
                       "done; $gray merge new.png.*-of-%d.part && cmp new.png out.png && rm new.png*",
                       shards, shards, shards);
        gives(line, 0, NULL);
    }
}

TEST(shards_of_a_crop_with_every_sample_give_its_bytes) {
    put("scene.lua", ONE);
    gives("$gray scene.lua -q -full --crop 61,30,150,99 --tone filmic --deep", 0, NULL);
    gives("for i in 1 2 3; do $gray scene.lua -q -full --crop 61,30,150,99 --tone filmic --deep -o n.png --shard $i/3; "
          "done; $gray merge -o n2.png n.png.*.part && cmp n2.png out.png",
          0, NULL);
}

TEST(shards_of_several_pictures_are_merged_picture_by_picture) {
    put("scene.lua", THREE);
    gives("$gray scene.lua -q && mkdir whole && mv a.png b.png c.png whole", 0, NULL);
    gives("for i in 1 2; do $gray scene.lua --shard $i/2; done; $gray merge *.part && "
          "for p in a b c; do cmp $p.png whole/$p.png || exit 1; done",
          0, NULL);
    gives("rm *.png; $gray scene.lua --shard-pictures 2/2 && cmp b.png whole/b.png && ! test -e a.png && "
          "$gray scene.lua --shard-pictures 1/2 && cmp a.png whole/a.png && cmp c.png whole/c.png",
          0, NULL);
}

TEST(shards_have_tiles_of_about_the_same_number) {
    put("scene.lua", ONE);
    gives("for i in 1 2 3 4 5; do $gray scene.lua --shard $i/5; done", 0, NULL);
    size_t min = SIZE_MAX, max = 0;
    for (int i = 1; i <= 5; i++) {
        char name[64];
        (void)snprintf(name, sizeof name, "out.png.%d-of-5.part", i);
        const char *path = test_path(name);
        struct tile_file file;
        struct error error;
        CHECK(tile_file_read(path, &file, &error));
        min = file.tiles < min ? file.tiles : min;
        max = file.tiles > max ? file.tiles : max;
        tile_file_close(&file);
    }
    CHECK_EQ_INT(min, 17); /* 11 x 8 tiles */
    CHECK_EQ_INT(max, 18);
}

TEST(merge_says_which_parts_are_missing_double_or_foreign) {
    put("scene.lua", SCENE "picture('out.png', 100, 70)\n");
    put("other.lua", SCENE "picture('out.png', 100, 70) --\n");
    gives("for i in 1 2 3 4; do $gray scene.lua --shard $i/4; done", 0, NULL);
    gives("$gray merge out.png.[14]-of-4.part", 1, "out.png: parts 2 and 3 of 4 are missing");
    gives("$gray merge out.png.[134]-of-4.part", 1, "out.png: part 2 of 4 is missing");
    gives("cp out.png.1-of-4.part again.part; $gray merge *.part", 1, "is part 1 of 4, and so is ");
    gives("rm again.part; mkdir o; $gray other.lua --shard 2/4 -o o/out.png; $gray merge out.png.[134]*.part o/*.part",
          1, "the scene, or a file it reads, has changed");
    gives("$gray scene.lua -ss 2 --shard 2/4 -o o/out.png; $gray merge out.png.[134]*.part o/*.part", 1,
          "it was made with different options");
    gives("$gray scene.lua --shard 1/3; $gray merge out.png.[234]-of-4.part out.png.1-of-3.part", 1,
          "the picture was divided differently");
    gives("$gray merge nowhere.part", 1, "nowhere.part: cannot be read");
    gives("$gray merge scene.lua", 1, "scene.lua: is not a file of tiles");
    gives("echo > scene.png; $gray merge scene.png scene.png -o x.png", 2,
          "gray: scene.png is a picture: gray merge makes animations of pictures (-o x.gif), and pictures of parts ");
    gives("$gray merge", 2, "gray: no parts to merge were given");
    CHECK(!exists("out.png"));
    gives("$gray merge out.png.[1234]-of-4.part", 0, NULL);
    CHECK(exists("out.png"));
}

TEST(merge_takes_parts_in_any_order_and_counts_many_that_are_missing) {
    put("scene.lua", SCENE "picture('a.png', 40, 30)\npicture('b.png', 30, 40)\n");
    gives("mkdir whole; $gray scene.lua -o whole/%d.png && $gray scene.lua --shard 1/2 && $gray scene.lua --shard 2/2",
          0, NULL);
    gives("$gray merge b.png.2*.part a.png.2*.part b.png.1*.part a.png.1*.part && cmp a.png whole/1.png && "
          "cmp b.png whole/2.png",
          0, NULL);
    gives("$gray scene.lua -o %d.png --shard 2/2; $gray merge a.png.1*.part 2.png.2*.part b.png.1*.part 1.png.2*.part",
          1, "it is of 1.png, not of a.png");
    gives("$gray scene.lua --shard 1/12; $gray merge a.png.1-of-12.part", 1,
          "a.png: parts 2, 3, 4, 5, 6, 7, 8, 9 and 3 more of 12 are missing");
    gives("$gray scene.lua --shard 12/12; $gray merge a.png.*-of-12.part", 1,
          "a.png: parts 2, 3, 4, 5, 6, 7, 8, 9 and 2 more of 12 are missing");
    gives("for i in 3 4 5 6 7 8 9; do $gray scene.lua --shard $i/12; done; $gray merge a.png.*-of-12.part", 1,
          "a.png: parts 2, 10 and 11 of 12 are missing");
}

TEST(merge_writes_only_where_a_script_might) {
    put("scene.lua", SCENE "picture('out.png', 40, 40)\n");
    gives("mkdir in; $gray scene.lua -o ../up.png --shard 1/1; cd in; $gray merge ../../up.png.1-of-1.part", 1,
          "../up.png: pictures of scripts must be below the working directory");
    gives("mv ../up.png.1-of-1.part .; $gray merge -o here.png up.png.1-of-1.part", 0, NULL);
    CHECK(exists("here.png"));
}

/* Kills the run after a moment, again and again, until it finishes. */
static void resume_until_done(const char *options, int tries, double from, double step) {
    char line[1024];
    (void)snprintf(line, sizeof line,
                   "at=%g; for i in $(seq %d); do "
                   "$gray scene.lua -q -j 1 %s --resume --checkpoint c.tiles --checkpoint-every 0 & pid=$!; "
                   "sleep $at; kill -9 $pid 2>kill.txt; wait $pid; "
                   "at=$(awk \"BEGIN{print $at+%g}\"); test -e out.png && exit 0; done; "
                   "$gray scene.lua -q -j 1 %s --resume --checkpoint c.tiles",
                   from, tries, options, step, options);
    int status = shell(line);
    CHECK_EQ_INT(status, 0);
}

/* A kill between link and rename leaves a temporary file; a run that finds it older than a minute removes it. */
#define NO_LEFTOVERS "! ls -A | grep part- || { sleep 62; $gray scene.lua -q -o last.png; ! ls -A | grep part-; }"

TEST(killed_runs_that_go_on_give_the_bytes_of_one_run) {
    put("scene.lua", ONE);
    gives("$gray scene.lua -q -full -ss 3 -o whole.png", 0, NULL);
    resume_until_done("-full -ss 3", 20, 0.02, 0.01);
    CHECK(shell("cmp out.png whole.png") == 0);
    CHECK(shell(NO_LEFTOVERS) == 0);
}

TEST(killed_runs_of_paths_that_go_on_give_the_bytes_of_one_run) {
    put("scene.lua", ONE);
    gives("$gray scene.lua -q --integrator path --spp 4 -o whole.png", 0, NULL);
    resume_until_done("--integrator path --spp 4", 20, 0.05, 0.02);
    CHECK(shell("cmp out.png whole.png") == 0);
}

/* Starts the program in the folder of the test; its words as in test_gray. */
static pid_t start_gray(const char *arguments) {
    char *words[64] = {(char *)(uintptr_t)test_program()}, *copy = strdup(arguments);
    int count = 1;
    for (char *word = strtok(copy, " "); word && count < 63; word = strtok(NULL, " "))
        words[count++] = word;
    words[count] = NULL;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        if (chdir(test_folder()) == 0)
            (void)execv(words[0], words);
        _exit(127);
    }
    free(copy);
    return child;
}

/* The moment of a kill: before anything was saved, between tiles, or after the picture was written. */
struct kills {
    int before, among, after;
};

#define KILLED_RUN "scene.lua -q -j 1 -full -ss 5 --resume --checkpoint c.tiles --checkpoint-every 0"

/* One picture: killed at a moment of its run, from 0 to 1, and resumed. *length: the current duration of a complete run
 * on this machine; updated. */
static void kill_once(double moment, double *length, struct kills *kills) {
    int how;
    double at = moment * *length, begun = test_clock();
    const struct timespec pause = {(time_t)at, (long)((at - floor(at)) * 1e9)};
    pid_t run = start_gray(KILLED_RUN);
    (void)nanosleep(&pause, NULL);
    (void)kill(run, SIGKILL);
    (void)waitpid(run, &how, 0);
    bool done = exists("out.png"), kept = exists("c.tiles");
    kills->before += !done && !kept;
    kills->among += !done && kept;
    kills->after += done;
    double resumed = test_clock(), rest = done ? 0 : kept ? 1 - moment : 1;
    run = start_gray(KILLED_RUN);
    (void)waitpid(run, &how, 0);
    CHECK(WIFEXITED(how) && WEXITSTATUS(how) == 0);
    /* A run that starts again takes the complete duration; one that ended before the kill took less than the moment. */
    if (rest == 1)
        *length += 0.2 * (test_clock() - resumed - *length);
    else if (done)
        *length += 0.05 * ((resumed - begun) * 0.8 - *length);
    else
        *length += 0.05 * ((resumed - begun + test_clock() - resumed) * 0.95 - *length);
}

TEST_LONG(a_thousand_killed_runs_that_go_on_give_the_bytes_of_one_run) {
    struct test_random random = {2024};
    struct kills kills = {0};
    put("scene.lua", SCENE "picture('out.png', 200, 160)\n");
    gives("$gray scene.lua -q -full -ss 5 -j 1 -o whole.png", 0, NULL);
    double length = test_clock();
    gives("$gray " KILLED_RUN " && rm out.png", 0, NULL);
    length = test_clock() - length;
    for (int i = 0; i < 1000; i++) {
        kill_once(test_uniform(&random, 0, 1), &length, &kills);
        if (!test_same_files("out.png", "whole.png"))
            test_fail(__FILE__, __LINE__, "picture %d differs", i);
        CHECK(!exists("c.tiles"));
        (void)unlink(test_path("out.png"));
    }
    CHECK(shell(NO_LEFTOVERS) == 0);
    fprintf(stderr, "    %d kills came before a checkpoint was there, %d among the tiles, %d after the picture\n",
            kills.before, kills.among, kills.after);
    CHECK(kills.among > 500);
}

/* The table of docs/lab/reliability.md. */
static void check_one_hash(const char *options) {
    char *folder = getcwd(NULL, 0), *line = NULL;
    CHECK(folder && asprintf(&line, "bash %s/tools/one_hash.sh $gray %s/tests/scripts/one_hash.lua %s >table.txt",
                             folder, folder, options) > 0);
    gives(line, 0, NULL);
    char *table = test_read_file(test_path("table.txt"), NULL);
    fprintf(stderr, "%s", table ? table : "");
    CHECK(table && strstr(table, "\none hash: "));
    free(table);
    free(line);
    free(folder);
}

TEST_LONG(one_picture_made_with_every_option_has_one_hash) {
    check_one_hash("");
}
TEST_LONG(one_picture_of_paths_made_with_every_option_has_one_hash) {
    check_one_hash("--integrator path --spp 4");
}

/* Leaves a checkpoint behind: the picture takes seconds, the signal comes as soon as there is one tile. */
static void leave_checkpoint(const char *options) {
    char line[1024];
    (void)snprintf(line, sizeof line,
                   "$gray scene.lua -q -full -ss 9 --checkpoint c.tiles --checkpoint-every 0 %s & pid=$!; "
                   "await 'test -s c.tiles'; kill -9 $pid; wait $pid; "
                   "test -s c.tiles",
                   options);
    CHECK_EQ_INT(shell(line), 0);
}

TEST(a_checkpoint_of_something_else_is_refused_and_stays) {
    put("scene.lua", "local h = io.open('data.txt') ; h:close()\n" SCENE "picture('out.png', 330, 250)\n");
    put("data.txt", "one");
    leave_checkpoint("");
    gives("$gray scene.lua -full -ss 9 --checkpoint c.tiles", 2, "c.tiles: a checkpoint of an earlier run exists");
    gives("cp c.tiles kept; $gray scene.lua -full -ss 8 --checkpoint c.tiles --resume", 1,
          "c.tiles: cannot be resumed: it was made with different options");
    gives("$gray scene.lua -full -ss 9 -D x=1 --checkpoint c.tiles --resume", 1, "it was made with different options");
    /* One line: the script is not to blame. */
    gives("$gray scene.lua -full -ss 8 --checkpoint c.tiles --resume 2>said; test $? = 1 && test $(wc -l <said) = 1 && "
          "head -c 100 c.tiles >half.tiles && $gray scene.lua --checkpoint half.tiles --resume 2>said; test $? = 1 && "
          "test $(wc -l <said) = 1 && $gray scene.lua --checkpoint c.tiles 2>said; test $? = 2 && grep -c . said",
          0, NULL);
    put("data.txt", "two");
    gives("$gray scene.lua -full -ss 9 --checkpoint c.tiles --resume", 1, "the scene, or a file it reads, has changed");
    put("data.txt", "one");
    put("scene.lua", "local h = io.open('data.txt') ; h:close()\n" SCENE "picture('out.png', 331, 250)\n");
    gives("$gray scene.lua -full -ss 9 --checkpoint c.tiles --resume", 1, "the scene, or a file it reads, has changed");
    CHECK_EQ_INT(shell("cmp c.tiles kept"), 0);
    CHECK(!exists("out.png"));
    /* Catching the error does not avoid it. */
    put("scene.lua", SCENE "pcall(picture, 'a.png', 64, 64)\npicture('b.png', 64, 64)\n");
    gives("$gray scene.lua -full -ss 9 --checkpoint c.tiles --resume", 1, "cannot be resumed");
    CHECK_EQ_INT(shell("cmp c.tiles kept"), 0);
    CHECK(!exists("a.png") && !exists("b.png"));
}

TEST(finished_pictures_are_not_made_again) {
    put("scene.lua", THREE "error('stop here')\n");
    gives("$gray scene.lua --checkpoint c.tiles", 1, "stop here");
    CHECK(exists("c.tiles"));
    put("keep.sh", "stat -c '%i %Y %y' a.png b.png c.png\n");
    gives("sh keep.sh >before; $gray scene.lua --checkpoint c.tiles --resume --stats", 1, "stop here");
    CHECK_EQ_INT(shell("sh keep.sh >after; cmp before after"), 0);
    /* A picture that has changed is made again. */
    gives("cp b.png whole.png; echo x >>b.png; $gray scene.lua --checkpoint c.tiles --resume", 1, "stop here");
    CHECK_EQ_INT(shell("cmp b.png whole.png"), 0);
}

/* The speed of the machine decides when a picture is half finished: the delay grows until it fits. */
#define MOMENTS "0.02 0.04 0.06 0.1 0.15 0.25 0.4 0.6 1 1.6 2.5 4 6"

TEST(a_signal_writes_the_checkpoint_at_once) {
    put("scene.lua", ONE);
    gives("for moment in " MOMENTS "; do "
          "$gray scene.lua -full -ss 24 --checkpoint c.tiles --checkpoint-every 1000 2>said.txt & pid=$!; "
          "sleep $moment; kill -USR1 $pid; "
          "for i in $(seq 50); do test -s c.tiles && break; sleep 0.02; done; "
          "test -s c.tiles && written=1; kill -TERM $pid; wait $pid; status=$?; test $written && break; rm -f c.tiles; "
          "done; cat said.txt >&2; test $written && exit $status",
          130, "c.tiles holds ");
    CHECK(exists("c.tiles"));
    gives("rm c.tiles; for moment in " MOMENTS "; do $gray scene.lua -full -ss 24 2>said.txt & pid=$!; sleep $moment; "
          "kill -USR1 $pid; sleep 0.1; kill -TERM $pid; wait $pid; status=$?; test $status = 130 && break; done; "
          "cat said.txt >&2; exit $status",
          130, "SIGUSR1 writes a checkpoint only with --checkpoint");
}

TEST(an_interrupted_run_keeps_what_is_finished) {
    put("scene.lua", ONE);
    gives("$gray scene.lua -full -ss 3 -o whole.png; for moment in " MOMENTS "; do "
          "$gray scene.lua -full -ss 3 --checkpoint auto --checkpoint-every 1000 2>said.txt & pid=$!; sleep $moment; "
          "kill -TERM $pid 2>kill.txt; wait $pid; status=$?; test -s out.png.checkpoint && ! test -e out.png && break; "
          "rm -f out.png out.png.checkpoint; done; cat said.txt >&2; test -s out.png.checkpoint && exit $status",
          130, "out.png.checkpoint holds ");
    gives("$gray scene.lua -q -full -ss 3 --resume && cmp out.png whole.png && ! test -e out.png.checkpoint", 0, NULL);
}

/* A checkpoint keeps the samples of tiles that are begun; a run in one go continues from it, and so does a shard. */
TEST(killed_runs_with_noise_that_go_on_give_the_bytes_of_one_run) {
    put("scene.lua", ONE);
    gives("$gray scene.lua -q --integrator path --noise 0.03 -o whole.png", 0, NULL);
    resume_until_done("--integrator path --noise 0.03", 20, 0.05, 0.04);
    CHECK(shell("cmp out.png whole.png") == 0);
    gives("for moment in " MOMENTS "; do rm -f out.png c.tiles; "
          "$gray scene.lua -j 1 --integrator path --noise 0.03 --checkpoint c.tiles --partial 2>said.txt & pid=$!; "
          "sleep $moment; kill -TERM $pid 2>kill.txt; wait $pid; "
          "test -s c.tiles && grep -q 'c.tiles holds .*samples of' said.txt && break; done; "
          "cat said.txt >&2; grep -q 'out.partial.png holds .* tiles, and samples of' said.txt && "
          "$gray scene.lua --integrator path --noise 0.03 --checkpoint c.tiles --resume && cmp out.png whole.png",
          0, "more, come from the checkpoint");
}

/* Ctrl-C finishes the tiles in progress and saves them as requested: a checkpoint, a partial picture. (Shells start
 * background children with SIGINT ignored: env resets it.) */
TEST(control_c_finishes_tiles_and_writes_every_output) {
    put("scene.lua", ONE);
    gives("$gray scene.lua -full -ss 3 -o whole.png; printf 'PF\\n1 old' >out.png; for moment in " MOMENTS "; do "
          "env --default-signal=INT $gray scene.lua -full -ss 3 --checkpoint auto --checkpoint-every 1000 --partial "
          "2>said.txt & pid=$!; sleep $moment; kill -INT $pid 2>kill.txt; wait $pid; status=$?; "
          "test -s out.partial.png && break; rm -f out.png.checkpoint; printf 'PF\\n1 old' >out.png; done; cat "
          "said.txt >&2; "
          "test -s out.png.checkpoint && grep -q old out.png && exit $status",
          130, "tiles under way are finished");
    gives("cat said.txt >&2; rm out.png", 0, "gray: notice: out.partial.png holds ");
    gives("$gray scene.lua -q -full -ss 3 --resume && cmp out.png whole.png", 0, NULL);
}

/* Tiles that take minutes: the second Ctrl-C does not wait for them. */
TEST(a_second_control_c_stops_at_once) {
    put("scene.lua", ONE);
    gives("for moment in " MOMENTS
          "; do env --default-signal=INT $gray scene.lua -j 1 -full -ss 64 --checkpoint auto 2>said.txt & "
          "pid=$!; sleep $moment; kill -INT $pid; sleep $moment; kill -INT $pid; wait $pid; status=$?; "
          "grep -q 'tiles under way' said.txt && break; done; cat said.txt >&2; exit $status",
          130, "gray: interrupted, out.png is not written");
    CHECK(!exists("out.png"));
}

TEST(a_checkpoint_that_cannot_be_written_is_a_warning) {
    put("scene.lua", SCENE "picture('out.png', 100, 70)\n");
    gives("$gray scene.lua -full -ss 16 -o b.png --checkpoint d/c --checkpoint-every 0 & "
          "for i in 1 2 3 4 5 6 7 8 9 10; do sleep 0.1; test -e d/c && break; done; "
          "until { rm -r d; echo >d; } 2>/dev/null; do :; done; wait $!",
          0, "gray: warning: the checkpoint: d/c: ");
    CHECK(exists("b.png"));
}

TEST(a_run_that_ends_before_its_first_checkpoint_leaves_none) {
    put("scene.lua", SCENE "picture('out.png', 20, 14)\n");
    gives("$gray scene.lua --checkpoint auto", 0, "");
    CHECK(exists("out.png") && !exists("out.png.checkpoint"));
}

TEST(a_checkpoint_with_a_name_that_cannot_be_written_ends_the_run_before_it_renders) {
    put("scene.lua", SCENE "picture('out.png', 4000, 4000)\n");
    gives("mkdir d; timeout 20 $gray scene.lua -full -ss 16 --checkpoint d", 1, "d: is a folder");
    gives("timeout 20 $gray scene.lua -full -ss 16 --checkpoint /dev/full/x", 1,
          "/dev/full/x: cannot be written: Not a directory");
    CHECK(!exists("out.png"));
}

TEST(a_part_that_is_there_is_not_made_again) {
    put("scene.lua", SCENE "picture('out.png', 100, 70)\n");
    gives("$gray scene.lua --shard 1/2 && stat -c '%i %y' out.png.1-of-2.part >before && "
          "$gray scene.lua -q --resume --shard 1/2 && stat -c '%i %y' out.png.1-of-2.part >after && cmp before after",
          0, NULL);
    gives("$gray scene.lua -q -ss 2 --resume --shard 1/2; stat -c '%i %y' out.png.1-of-2.part >after; "
          "! cmp -s before after",
          0, NULL);
}

/* Several processes, if the program with MPI was built and mpirun is installed. */

static void need_mpi(void) {
    test_need_mpi();
    put("farm.sh", "ranks=$1; shift\n"
                   "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
                   "OMPI_MCA_btl_vader_backing_directory=${TMPDIR:-/tmp} "
                   "mpirun --oversubscribe -n $ranks $gray --mpi -q -j 1 \"$@\"\n");
}

TEST(one_to_four_ranks_give_the_bytes_of_one_run) {
    need_mpi();
    put("scene.lua", SCENE "picture('a.png', 330, 250)\npicture('b.png', 70, 50)\n");
    gives("$gray scene.lua -q -o whole%d.png", 0, NULL);
    for (int ranks = 1; ranks <= 4; ranks += ranks < 2 ? 1 : 2) {
        char line[256];
        (void)snprintf(
            line, sizeof line,
            "export gray; sh farm.sh %d scene.lua && cmp a.png whole1.png && cmp b.png whole2.png && rm a.png "
            "b.png",
            ranks);
        gives(line, 0, "");
    }
}

TEST(ranks_draw_and_finish_a_picture_with_the_bytes_of_one_run) {
    need_mpi();
    put("scene.lua", SCENE "picture('a.png', 330, 250)\n");
    gives("o='scene.lua --style toon --bloom .5 --vignette .4 --fxaa --dither blue'; $gray -q $o -o whole.png && "
          "export gray; sh farm.sh 3 $o && cmp a.png whole.png",
          0, "");
}

/* The picture through a tone curve that is a function. */
#define TONED                                                                                                          \
    SCENE "gr.render{node = r, file = 'out.png', width = 330, height = 250, eye = {0, 0, 6}, lights = {l},\n"          \
          "  ambient = {.2, .2, .2}, tone = function(x) return x < .3 and 3 * x ^ 2 or 1 - .73 * math.exp(.3 - x) "    \
          "end}\n"

TEST(pictures_through_a_tone_function_have_the_same_bytes_for_threads_shards_and_kills) {
    put("scene.lua", TONED);
    gives("$gray scene.lua -q -j 1 -o whole.png && $gray scene.lua -q -j 5 && cmp out.png whole.png && "
          "$gray scene.lua -q --tone none -o none.png && ! cmp -s none.png whole.png",
          0, NULL);
    gives("for i in 1 2 3; do $gray scene.lua -q -o new.png --shard $i/3 || exit; done; "
          "$gray merge new.png.*.part && cmp new.png whole.png",
          0, NULL);
    gives("rm out.png; $gray scene.lua -q --shard 1/2 && $gray scene.lua -q --tone none --shard 2/2; "
          "$gray merge out.png.[12]-of-2.part",
          1, "it was made with different options");
    resume_until_done("-full -ss 3", 20, 0.02, 0.01);
    gives("$gray scene.lua -q -full -ss 3 -o whole.png && cmp out.png whole.png", 0, NULL);
}

TEST(ranks_make_a_picture_through_a_tone_function_with_the_bytes_of_one_run) {
    need_mpi();
    put("scene.lua", TONED);
    gives("$gray scene.lua -q -o whole.png && export gray; sh farm.sh 3 scene.lua && cmp out.png whole.png", 0, "");
}

TEST(ranks_trace_paths_to_the_bytes_of_one_run) {
    need_mpi();
    put("scene.lua", ONE);
    gives("$gray scene.lua -q --integrator path --spp 4 -o whole.png", 0, NULL);
    gives("export gray; sh farm.sh 3 scene.lua --integrator path --spp 4 && cmp out.png whole.png", 0, "");
}

TEST(a_rank_that_falls_out_is_done_without) {
    need_mpi();
    put("scene.lua", ONE);
    gives("$gray scene.lua -q -full -ss 6 -o whole.png", 0, NULL);
    /* The newest render process is killed, not its supervisor, which returns its tiles. */
    gives("export gray; sh farm.sh 3 scene.lua -full -ss 6 & pid=$!; "
          "await 'c=; for p in $(pgrep -P $pid); do c=$(pgrep -P $p | head -n 1); done; test \"$c\"'; sleep 0.2; kill "
          "-9 $c; wait $pid; status=$?; "
          "cmp out.png whole.png && exit 0; exit $status",
          0, "");
}

TEST(a_farm_that_was_killed_goes_on_from_its_checkpoint) {
    need_mpi();
    put("scene.lua", ONE);
    gives("$gray scene.lua -q -full -ss 6 -o whole.png", 0, NULL);
    gives("export gray; sh farm.sh 3 scene.lua -full -ss 6 --checkpoint c.tiles --checkpoint-every 0 & pid=$!; "
          "await 'test -s c.tiles'; kill -9 $(pgrep -P $pid | tail -n 1); "
          "wait $pid; test -e out.png || test -s c.tiles",
          0, "");
    gives("export gray; test -e out.png || sh farm.sh 2 scene.lua -full -ss 6 --checkpoint c.tiles --resume; "
          "cmp out.png whole.png",
          0, "");
}

/* The picture takes long enough for the other rank to begin. */
TEST(ranks_with_other_options_are_refused_and_the_picture_is_made_without_them) {
    need_mpi();
    put("scene.lua", SCENE "picture('out.png', 800, 560)\n");
    gives("$gray scene.lua -o whole.png; export gray; sed -i 's/ -q / /' farm.sh; "
          "sh farm.sh 1 scene.lua : -n 1 $gray --mpi -ss 2 scene.lua; cmp out.png whole.png",
          0, "gray: rank 1: ");
}

/* In memory. */

static struct film some_film(uint32_t x0, uint32_t y0, uint32_t width, uint32_t height, struct test_random *random) {
    struct film film = {.x0 = x0, .y0 = y0, .full_width = x0 + width + 5, .full_height = y0 + height + 3};
    struct error error;
    size_t bytes;
    CHECK(film_size(width, height, stage_record(INTEGRATOR_WHITTED), &bytes, &error));
    film_layout(&film, calloc(1, bytes), width, height, stage_record(INTEGRATOR_WHITTED));
    for (size_t i = 0; i < (size_t)width * height; i++) {
        film.marked[i] = test_uniform(random, 0, 1) < 0.3;
        for (int c = 0; c < 3; c++) {
            film.pixels[i].rgb[c] = (float)test_uniform(random, -1, 2);
            film.floats[3 * i + (size_t)c] =
                film.marked[i] ? (float)test_uniform(random, -1, 2) : film.pixels[i].rgb[c];
        }
    }
    return film;
}

static struct tile_picture picture_of(const struct film *film) {
    return (struct tile_picture){.number = 3,
                                 .key = {"1.2.3", {1, 2}, {3, 4}},
                                 .full_width = film->full_width,
                                 .full_height = film->full_height,
                                 .x0 = film->x0,
                                 .y0 = film->y0,
                                 .width = film->width,
                                 .height = film->height,
                                 .record = film->record,
                                 .settings = {.tone = {-1.5, TONE_FILMIC, true, NULL}, .deep = true},
                                 .shard = 2,
                                 .shards = 5,
                                 .name = "some/picture.png"};
}

TEST(a_file_of_tiles_gives_back_what_was_put_in) {
    struct test_random random = {7};
    const char *path = test_path("x.tiles");
    for (int round = 0; round < 20; round++) {
        uint32_t x0 = (uint32_t)test_uniform(&random, 0, 70), y0 = (uint32_t)test_uniform(&random, 0, 70);
        uint32_t width = (uint32_t)test_uniform(&random, 1, 140), height = (uint32_t)test_uniform(&random, 1, 90);
        struct film film = some_film(x0, y0, width, height, &random), back = film;
        struct tile_picture picture = picture_of(&film);
        if (round % 2)
            picture.settings.finish = (struct finish){0.25, 0.75, round % 4 == 1, round % 4 == 3, true, DITHER_BLUE};
        if (round % 3 == 0) {
            picture.settings.tone.curve = TONE_FUNCTION;
            for (int i = 0; i < TONE_ENTRIES; i++)
                picture.tone_table.values[i] = (float)test_uniform(&random, -1, 2);
        }
        struct tile_done done = {1, picture.key, {5, 6}, "first.png"};
        struct tile_file file;
        struct error error;
        uint32_t kept = 0, restored, twice;
        for (uint32_t i = 0; i < film_tile_count(&film); i++) {
            bool keep = test_uniform(&random, 0, 1) < 0.6;
            int other = i % 3 == 0 ? FILM_TILE_BEGUN + 7 : i % 3 == 1 ? FILM_TILE_WANTED : FILM_TILE_ELSEWHERE;
            atomic_store(&film.tiles[i], keep ? FILM_TILE_DONE : (uint8_t)other);
            kept += keep;
        }
        CHECK(tile_file_write(FILE_AT(path), &done, 1, &picture, &film, &error));
        CHECK(tile_file_read(path, &file, &error));
        CHECK_EQ_INT(file.done_count, 1);
        CHECK_TEXT(file.done[0].name, "first.png");
        CHECK(digest_equal(file.done[0].written, done.written));
        CHECK(!tile_picture_difference(&file.picture, &picture) && file.picture.shard == 2);
        CHECK_TEXT(file.picture.name, picture.name);
        size_t bytes;
        CHECK(film_size(width, height, stage_record(INTEGRATOR_WHITTED), &bytes, &error));
        film_layout(&back, calloc(1, bytes), width, height, stage_record(INTEGRATOR_WHITTED));
        tile_file_restore(&file, &back, &restored, &twice);
        CHECK_EQ_INT(restored, kept);
        CHECK_EQ_INT(twice, 0);
        for (uint32_t tile = 0; tile < film_tile_count(&film); tile++) {
            struct film_rectangle r = film_tile_rectangle(&film, tile);
            bool done_there = atomic_load(&film.tiles[tile]) == FILM_TILE_DONE,
                 begun_there = film_tile_is_begun(atomic_load(&film.tiles[tile])), is = done_there || begun_there;
            CHECK((atomic_load(&back.tiles[tile]) == FILM_TILE_DONE) == done_there);
            CHECK(film_tile_is_begun(atomic_load(&back.tiles[tile])) == begun_there);
            for (uint32_t y = r.y0; is && y < r.y1; y++) {
                size_t at = (size_t)(y - y0) * width + (r.x0 - x0), count = r.x1 - r.x0;
                CHECK(memcmp(film.pixels + at, back.pixels + at, count * sizeof *film.pixels) == 0);
                CHECK(memcmp(film.floats + 3 * at, back.floats + 3 * at, count * 3 * sizeof *film.floats) == 0);
                CHECK(memcmp(film.marked + at, back.marked + at, count) == 0);
            }
        }
        tile_file_restore(&file, &back, &restored, &twice);
        CHECK_EQ_INT(twice, kept);
        tile_file_close(&file);
        free(film.pixels);
        free(back.pixels);
    }
}

/* Whether a file of these bytes is read; if not, the error names it. */
static bool is_taken(const char *path, const char *bytes, size_t size) {
    struct tile_file file;
    struct error error;
    FILE *stream = fopen(path, "wb");
    CHECK(stream && fwrite(bytes, 1, size, stream) == size && fclose(stream) == 0);
    bool taken = tile_file_read(path, &file, &error);
    if (taken)
        tile_file_close(&file);
    CHECK(taken || (error.kind == ERROR_SCENE && strncmp(error.text, path, strlen(path)) == 0));
    return taken;
}

TEST(a_file_of_tiles_that_is_cut_or_changed_anywhere_is_refused) {
    struct test_random random = {9};
    struct film film = some_film(40, 0, 50, 40, &random);
    struct tile_picture picture = picture_of(&film);
    struct error error;
    size_t size;
    for (uint32_t i = 0; i < film_tile_count(&film); i++)
        atomic_store(&film.tiles[i], FILM_TILE_DONE);
    const char *path = test_path("x.tiles");
    CHECK(tile_file_write(FILE_AT(path), NULL, 0, &picture, &film, &error));
    char *bytes = test_read_file(path, &size);
    int accepted = 0;
    const char *changed = test_path("y.tiles");
    for (size_t cut = 0; cut < size; cut += cut < 2000 ? 1 : 97)
        accepted += is_taken(changed, bytes, cut);
    for (size_t at = 0; at < size; at += at < 2000 || at + 200 > size ? 1 : 31) {
        bytes[at] = (char)(bytes[at] ^ (1 << at % 8));
        accepted += is_taken(changed, bytes, size);
        bytes[at] = (char)(bytes[at] ^ (1 << at % 8));
    }
    CHECK_EQ_INT(accepted, 0);
    free(bytes);
    free(film.pixels);
}
