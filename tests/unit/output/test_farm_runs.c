/* Real farms under mpirun, whose processes are stopped and killed: the pictures have the bytes of a single run, and the
 * status of gray is 0. Moments are measured in processor time of the renderer, so that a busy machine does not matter.
 */
#define _GNU_SOURCE
#include "base/process.h"
#include "tests/harness.h"

#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

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

/* Seconds after which a test gives up, also on a busy machine. */
enum { PATIENCE = 120 };

/* A line of shell in the folder of the test; $gray is the program. */
static char *command_line(const char *line) {
    char *command = NULL;
    if (asprintf(&command, "cd '%s' && export gray='%s' && { %s; }", test_folder(), test_program(), line) < 0)
        exit(1);
    return command;
}

static int shell(const char *line) {
    return test_run_shell(line, "");
}

static void need_mpi(const char *scene) {
    test_write_text(test_path("scene.lua"), scene);
    test_need_mpi();
}

/* The last result stays valid until the next call. */
static const char *said(void) {
    static char *text;
    free(text);
    text = test_read_file(test_path("said.txt"), NULL);
    return text ? text : "";
}

/* The status of the first rank goes into status.txt; every process has GRAY_TEST_FARM in its environment, and all ranks
 * but the first also have the contents of the variable `others`. */
static pid_t start_farm(const char *mpirun_options, int ranks, const char *words) {
    char line[2048];
    (void)snprintf(line, sizeof line,
                   "export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 GRAY_TEST_FARM=$PWD; "
                   "export OMPI_MCA_btl_vader_backing_directory=${TMPDIR:-/tmp}; " /* ends with the test */
                   "export words='--mpi -j 1 scene.lua %s'; rm -f status.txt; "
                   "exec mpirun %s --oversubscribe -n %d sh -c '"
                   "test $OMPI_COMM_WORLD_RANK = 0 || exec env $others $gray $words; $gray $words; "
                   "echo $? >status.txt' "
                   ">said.txt 2>&1",
                   words, mpirun_options, ranks);
    char *command = command_line(line);
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        (void)execl("/bin/sh", "sh", "-c", command, NULL);
        _exit(127);
    }
    free(command);
    return child;
}

static bool has_word(const char *environment, size_t size, const char *word) {
    for (const char *at = environment; at < environment + size; at += strlen(at) + 1) {
        if (strcmp(at, word) == 0)
            return true;
    }
    return false;
}

static pid_t parent_of(pid_t pid) {
    char path[64];
    int parent = 0;
    (void)snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
    char *text = test_read_file(path, NULL);
    const char *end = text ? strrchr(text, ')') : NULL;
    if (end)
        (void)sscanf(end, ") %*c %d", &parent);
    free(text);
    return (pid_t)parent;
}

/* Processes of gray of this rank in this test: at most two. */
static int processes_of(int rank, pid_t found[8]) {
    char mark[512], number[64], path[64], target[4096];
    int count = 0;
    (void)snprintf(mark, sizeof mark, "GRAY_TEST_FARM=%s", test_folder());
    (void)snprintf(number, sizeof number, "OMPI_COMM_WORLD_RANK=%d", rank);
    DIR *stream = opendir("/proc");
    for (struct dirent *entry; stream && (entry = readdir(stream)) != NULL && count < 8;) {
        (void)snprintf(path, sizeof path, "/proc/%.20s/exe", entry->d_name);
        ssize_t length = readlink(path, target, sizeof target - 1);
        target[length > 0 ? length : 0] = '\0';
        if (length < 8 || strcmp(target + length - 8, "gray-mpi") != 0)
            continue;
        size_t size = 0;
        (void)snprintf(path, sizeof path, "/proc/%.20s/environ", entry->d_name);
        char *text = test_read_file(path, &size);
        if (text && has_word(text, size, mark) && has_word(text, size, number))
            found[count++] = (pid_t)atoi(entry->d_name);
        free(text);
    }
    if (stream)
        (void)closedir(stream);
    return count;
}

/* The process that mpirun has started, or its renderer; 0: it does not exist. */
static pid_t process_of(int rank, bool renderer) {
    pid_t found[8];
    int count = processes_of(rank, found);
    for (int i = 0; i < count; i++) {
        bool below = false;
        for (int k = 0; k < count; k++)
            below = below || parent_of(found[i]) == found[k];
        if (below == renderer)
            return found[i];
    }
    return 0;
}

/* Waits until the renderer of the rank has used this processor time and a file exists (or NULL). */
static bool await_work(int rank, double seconds, const char *file) {
    for (double begun = test_clock(); test_clock() - begun < PATIENCE; (void)usleep(5000)) {
        pid_t renderer = process_of(rank, true);
        if (renderer > 0 && process_time(renderer) >= seconds && (!file || access(test_path(file), F_OK) == 0))
            return true;
    }
    test_fail(__FILE__, __LINE__, "rank %d did not work; said:\n%s", rank, said());
    return false;
}

static bool await_words(const char *words) {
    for (double begun = test_clock(); test_clock() - begun < PATIENCE; (void)usleep(5000)) {
        if (strstr(said(), words))
            return true;
    }
    return false;
}

/* The status of mpirun; a farm that does not end is killed. */
static int await_end(pid_t mpirun) {
    int how;
    for (double begun = test_clock(); test_clock() - begun < PATIENCE; (void)usleep(5000)) {
        if (waitpid(mpirun, &how, WNOHANG) == mpirun)
            return WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
    }
    test_fail(__FILE__, __LINE__, "the farm does not end");
    (void)kill(mpirun, SIGKILL);
    (void)waitpid(mpirun, &how, 0);
    return -1;
}

/* Status 0 of the first rank, the line, and the bytes of one run. */
static void expect_pictures(const char *line, const char *compare) {
    if (line && !strstr(said(), line))
        test_fail(__FILE__, __LINE__, "\"%s\" was not said, but:\n%s", line, said());
    if (shell("test \"$(cat status.txt)\" = 0") != 0)
        test_fail(__FILE__, __LINE__, "the status of the first rank is not 0; said:\n%s", said());
    if (shell(compare) != 0)
        test_fail(__FILE__, __LINE__, "other bytes, or none; said:\n%s", said());
}

#define ONE SCENE "picture('out.png', 330, 250)\n"
#define WORDS "-full -ss 6 --farm-stall 0.4 --farm-silence 1"
#define COMPARE "cmp out.png whole.png && rm out.png"

static void make_whole(void) {
    CHECK_EQ_INT(shell("$gray scene.lua -q -full -ss 6 -o whole.png"), 0);
}

static void stop_renderer(int rank) {
    pid_t farm = start_farm("", 3, WORDS);
    if (await_work(rank, 0.03, NULL))
        CHECK(kill(process_of(rank, true), SIGSTOP) == 0);
    CHECK_EQ_INT(await_end(farm), 0);
    char line[100];
    (void)snprintf(line, sizeof line, "rank %d has killed its render process, which hung for 0.4 s", rank);
    expect_pictures(line, COMPARE);
}

TEST(a_renderer_that_hangs_is_killed_by_its_rank_and_its_tiles_are_made_again) {
    need_mpi(ONE);
    make_whole();
    stop_renderer(0);
    stop_renderer(2);
}

TEST(a_farm_of_one_makes_the_tiles_of_a_renderer_that_hangs) {
    need_mpi(ONE);
    make_whole();
    pid_t farm = start_farm("", 1, WORDS);
    if (await_work(0, 0.1, NULL))
        CHECK(kill(process_of(0, true), SIGSTOP) == 0);
    CHECK_EQ_INT(await_end(farm), 0);
    expect_pictures("rank 0 has killed its render process", COMPARE);
}

TEST(a_renderer_that_hangs_before_its_picture_is_started_again) {
    need_mpi("local function spend(limit) local n = 0; for i = 1, limit do n = n + math.sin(i) end end\n"
             "spend(15e5)\n" ONE);
    make_whole();
    pid_t farm = start_farm("", 2, WORDS);
    if (await_work(1, 0.03, NULL))
        CHECK(kill(process_of(1, true), SIGSTOP) == 0);
    CHECK_EQ_INT(await_end(farm), 0);
    expect_pictures("rank 1 has killed its render process", COMPARE);
}

TEST(a_slow_tile_is_no_standstill) {
    need_mpi(SCENE "picture('out.png', 32, 32)\n");
    CHECK_EQ_INT(shell("$gray scene.lua -q -full -ss 14 -alsamples 48 -o whole.png"), 0);
    pid_t farm = start_farm("", 2, "-full -ss 14 -alsamples 48 --farm-stall 0.2");
    CHECK_EQ_INT(await_end(farm), 0);
    expect_pictures(NULL, COMPARE);
    CHECK(!strstr(said(), "render process"));
}

TEST(a_renderer_of_the_first_rank_that_is_killed_costs_no_picture) {
    need_mpi(SCENE "print('begun')\npicture('a.png', 60, 50)\npicture('b.png', 330, 250)\npicture('c.png', 70, 70)\n");
    CHECK_EQ_INT(shell("mkdir whole && $gray scene.lua -q -full -ss 6 && mv a.png b.png c.png whole"), 0);
    pid_t farm = start_farm("", 2, WORDS);
    if (await_work(0, 0.07, "a.png"))
        CHECK(kill(process_of(0, true), SIGKILL) == 0);
    CHECK_EQ_INT(await_end(farm), 0);
    expect_pictures("rank 0 has lost its render process, which was killed",
                    "for p in a b c; do cmp $p.png whole/$p.png || exit 1; done");
}

TEST(a_renderer_that_is_killed_again_and_again_is_given_up) {
    need_mpi(ONE);
    pid_t farm = start_farm("", 1, "-full -ss 30"), last = 0;
    for (int i = 0; i < 4; i++) {
        for (double begun = test_clock(); test_clock() - begun < PATIENCE; (void)usleep(2000)) {
            pid_t renderer = process_of(0, true);
            if (renderer > 0 && renderer != last && process_time(renderer) > 0.02) {
                last = renderer;
                CHECK(kill(renderer, SIGKILL) == 0);
                break;
            }
        }
    }
    CHECK_EQ_INT(await_end(farm), 0); /* of the shell that writes the status */
    CHECK_EQ_INT(shell("test \"$(cat status.txt)\" = 3"), 0);
    CHECK(strstr(said(), "the render process was killed while it rendered out.png, which is not written"));
}

TEST(a_rank_that_is_stopped_is_done_without) {
    need_mpi(ONE);
    make_whole();
    pid_t farm = start_farm("", 3, WORDS);
    if (await_work(2, 0.03, NULL))
        CHECK(kill(process_of(2, false), SIGSTOP) == 0);
    CHECK_EQ_INT(await_end(farm), 0); /* it is continued at the end, so that it ends with the others */
    expect_pictures("rank 2 has been silent for 1 s, others render its tiles", COMPARE);
    CHECK(process_of(2, false) == 0 && process_of(2, true) == 0);
}

TEST(a_rank_that_goes_on_after_a_silence_does_no_harm) {
    need_mpi(ONE);
    make_whole();
    pid_t farm = start_farm("", 3, "-full -ss 6 --farm-silence 0.5");
    if (await_work(1, 0.03, NULL)) {
        pid_t rank = process_of(1, false);
        CHECK(kill(rank, SIGSTOP) == 0);
        CHECK(await_words("rank 1 has been silent"));
        CHECK(kill(rank, SIGCONT) == 0);
    }
    CHECK(await_end(farm) >= 0);
    expect_pictures(NULL, COMPARE);
}

TEST(a_rank_that_is_killed_is_done_without_where_mpirun_lets_the_others_go_on) {
    need_mpi(ONE);
    make_whole();
    pid_t farm = start_farm("--enable-recovery", 3, WORDS);
    if (await_work(1, 0.03, NULL))
        CHECK(kill(process_of(1, false), SIGKILL) == 0);
    CHECK_EQ_INT(await_end(farm), 0);
    expect_pictures("rank 1 has been silent for 1 s", COMPARE);
}

TEST(a_rank_that_is_killed_leaves_the_first_one_time_for_its_checkpoint) {
    need_mpi(ONE);
    pid_t farm =
        start_farm("--mca odls_base_sigkill_timeout 2", 3, "-full -ss 60 --checkpoint c.tiles --checkpoint-every 1000");
    if (await_work(0, 0.3, NULL))
        CHECK(kill(process_of(2, false), SIGKILL) == 0);
    CHECK(await_end(farm) > 0); /* mpirun ends all processes */
    CHECK_EQ_INT(shell("! test -e out.png && test -s c.tiles"), 0);
}

TEST(ranks_end_when_the_first_one_was_killed) {
    need_mpi(ONE);
    pid_t farm = start_farm("--enable-recovery", 2, "-full -ss 60 --farm-silence 0.2");
    if (await_work(1, 0.03, NULL))
        CHECK(kill(process_of(0, false), SIGKILL) == 0);
    (void)await_end(farm);
    CHECK(strstr(said(), "gray: the first rank of the farm has been silent for too long"));
    CHECK(access(test_path("out.png"), F_OK) != 0);
}

/* --- noise --- */

#define NOISE "--integrator path --noise 0.02 --denoise=none"

#define FINE "--integrator path --noise 0.003 --denoise=none" /* takes a second */

static void make_noisy_whole(void) {
    CHECK_EQ_INT(shell("$gray scene.lua -q " NOISE " -o whole.png"), 0);
}

TEST(a_farm_with_noise_has_the_bytes_of_one_run_whatever_is_lost) {
    need_mpi(SCENE "picture('out.png', 220, 170)\n");
    make_noisy_whole();
    pid_t farm = start_farm("", 3, NOISE);
    CHECK_EQ_INT(await_end(farm), 0);
    expect_pictures(NULL, COMPARE);
    for (int rank = 0; rank < 3; rank += 2) {
        char line[100];
        farm = start_farm("", 3, NOISE " --farm-stall 0.4 --farm-silence 10");
        if (await_work(rank, 0.1, NULL))
            CHECK(kill(process_of(rank, true), rank ? SIGSTOP : SIGKILL) == 0);
        CHECK_EQ_INT(await_end(farm), 0);
        (void)snprintf(line, sizeof line, "rank %d has %s its render process", rank, rank ? "killed" : "lost");
        expect_pictures(line, COMPARE);
    }
    farm = start_farm("", 3, NOISE " --farm-silence 0.5");
    if (await_work(1, 0.1, NULL)) {
        pid_t rank = process_of(1, false);
        CHECK(kill(rank, SIGSTOP) == 0);
        CHECK(await_words("rank 1 has been silent"));
        CHECK(kill(rank, SIGCONT) == 0);
    }
    CHECK(await_end(farm) >= 0);
    expect_pictures(NULL, COMPARE);
}

/* SIGINT: mpirun ends all processes. */
TEST(a_farm_with_noise_goes_on_from_a_checkpoint_with_the_bytes_of_one_run) {
    need_mpi(SCENE "picture('out.png', 100, 80)\n");
    CHECK_EQ_INT(shell("$gray scene.lua -q " FINE " -o whole.png"), 0);
    pid_t farm = start_farm("", 3, FINE " --checkpoint c.tiles --checkpoint-every 1000");
    if (await_work(0, 0.08, NULL))
        CHECK(kill(process_of(0, false), SIGINT) == 0);
    CHECK(await_end(farm) > 0);
    CHECK_EQ_INT(shell("cp c.tiles d.tiles && $gray scene.lua " FINE " --checkpoint c.tiles --resume 2>>said.txt"), 0);
    CHECK_EQ_INT(shell(COMPARE), 0);
    CHECK_EQ_INT(await_end(start_farm("", 3, FINE " --checkpoint d.tiles --resume")), 0);
    expect_pictures("come from the checkpoint", COMPARE);
}

TEST(a_farm_shows_finished_tiles_and_no_time) {
    need_mpi(ONE);
    make_whole();
    CHECK_EQ_INT(await_end(start_farm("", 2, WORDS " --progress=json")), 0);
    expect_pictures("\"tiles_done\":", COMPARE);
    CHECK(!strstr(said(), "\"left\":") && !strstr(said(), "\"share\":"));
}

TEST(a_rank_that_fails_alone_is_a_line_and_no_status) {
    need_mpi("if os.getenv('GRAY_ODD') then error('odd') end\n" ONE);
    make_whole();
    (void)setenv("others", "GRAY_ODD=1", 1);
    CHECK_EQ_INT(await_end(start_farm("", 3, WORDS)), 0);
    expect_pictures("gray: rank 2: scene.lua:1: odd", COMPARE);
}

TEST(control_c_ends_a_run_whose_renderer_is_stopped) {
    test_write_text(test_path("scene.lua"), ONE);
    char *command = command_line("exec $gray scene.lua -q -full -ss 60 2>said.txt");
    fflush(stdout);
    pid_t run = fork();
    if (run == 0) {
        (void)execl("/bin/sh", "sh", "-c", command, NULL);
        _exit(127);
    }
    char path[64];
    int renderer = 0;
    (void)snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)run, (int)run);
    for (double begun = test_clock(); test_clock() - begun < PATIENCE; (void)usleep(5000)) {
        char *text = test_read_file(path, NULL);
        renderer = text ? atoi(text) : 0;
        free(text);
        if (renderer > 0 && process_time(renderer) > 0.1)
            break;
    }
    CHECK(renderer > 0 && kill(renderer, SIGSTOP) == 0 && kill(run, SIGINT) == 0);
    CHECK_EQ_INT(await_end(run), 130);
    CHECK(strstr(said(), "gray: interrupted, out.png is not written"));
    free(command);
}
