/* The program from a user's view: exit statuses, names of pictures, signals, crashes, full disks, and the promise that
 * an old picture is never damaged. */
#define _GNU_SOURCE
#include "image/exr.h"
#include "image/picture_file.h"
#include "tests/harness.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* It begins like a picture: other files are never replaced. */
#define OLD_PICTURE "PF\n1 an old picture"

/* A lit ball and a mirror: edges, highlights, reflections. %s is the call of gr.render. */
#define BALL                                                                                                           \
    "local r = gr.node('root')\n"                                                                                      \
    "r:add_child(gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20))))\n"                 \
    "local m = gr.geometry('box', gr.cube(gr.rr_material({0.1, 0.1, 0.1}, {1, 1, 1}, 50, 0.7, 0, 1)))\n"               \
    "m:translate(0.4, -1.4, 0.3)\n"                                                                                    \
    "r:add_child(m)\n"                                                                                                 \
    "local l = gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})\n"                                                      \
    "local function picture(name, w, h)\n"                                                                             \
    "  gr.render(r, name, w, h, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, {l})\n"                         \
    "end\n"
#define SMALL BALL "picture('out.png', 70, 50)\n"
/* Takes minutes: every test that uses it ends it. */
#define ENDLESS BALL "picture('out.png', 1500, 1500)\n"

static char *path_in(const char *folder, const char *name) {
    char *path = NULL;
    if (asprintf(&path, "%s/%s", folder, name) < 0)
        exit(1);
    return path;
}

static void write_in_folder(const char *name, const char *text) {
    char *path = path_in(test_folder(), name);
    test_write_text(path, text);
    free(path);
}

static bool exists(const char *name) {
    char *path = path_in(test_folder(), name);
    bool there = access(path, F_OK) == 0;
    free(path);
    return there;
}

static char *bytes_of(const char *name, size_t *size) {
    char *path = path_in(test_folder(), name), *bytes = test_read_file(path, size);
    if (!bytes)
        test_fail(__FILE__, __LINE__, "%s is not there", name);
    free(path);
    return bytes;
}

static void same_bytes(const char *a, const char *b) {
    size_t size_a = 0, size_b = 0;
    char *x = bytes_of(a, &size_a), *y = bytes_of(b, &size_b);
    if (!x || !y || size_a != size_b || memcmp(x, y, size_a) != 0)
        test_fail(__FILE__, __LINE__, "%s and %s differ", a, b);
    free(x);
    free(y);
}

static void holds_text(const char *name, const char *text) {
    char *have = bytes_of(name, NULL);
    CHECK_TEXT(have, text);
    free(have);
}

/* Files of the folder with ".part-" in their names: remaining temporary files. */
static int leftovers(const char *folder) {
    DIR *stream = opendir(folder);
    int count = 0;
    for (struct dirent *entry; stream && (entry = readdir(stream)) != NULL;)
        count += strstr(entry->d_name, ".part-") != NULL;
    if (stream)
        (void)closedir(stream);
    return count;
}

static struct test_picture picture_of(const char *name) {
    char *path = path_in(test_folder(), name);
    struct test_picture picture = test_read_picture(path);
    free(path);
    return picture;
}

static void ends(struct test_result result, int status) {
    if (result.status != status)
        test_fail(__FILE__, __LINE__, "status %d, not %d; standard error:\n%s", result.status, status, result.err);
    test_free_result(&result);
}

static void ends_saying(struct test_result result, int status, const char *text) {
    if (!strstr(result.err, text))
        test_fail(__FILE__, __LINE__, "no \"%s\" in standard error:\n%s", text, result.err);
    ends(result, status);
}

/* Programs that are still running. Words are taken as they are; standard error goes to err.txt in the folder. */
static pid_t start(const char *const *words, void (*prepare)(void)) {
    const char *binary = test_program(), *folder = test_folder();
    fflush(stdout);
    pid_t child = fork();
    if (child != 0)
        return child;
    const char *all[32] = {binary};
    for (int i = 0; words[i] && i < 30; i++)
        all[i + 1] = words[i];
    if (chdir(folder) != 0)
        _exit(126);
    int out = open("out.txt", O_WRONLY | O_CREAT | O_TRUNC, 0666);
    int err = open("err.txt", O_WRONLY | O_CREAT | O_TRUNC, 0666);
    (void)dup2(out, 1);
    (void)dup2(err, 2);
    if (prepare)
        prepare();
    (void)execv(binary, (char *const *)(uintptr_t)all);
    _exit(127);
}

static void rest(void) {
    struct timespec pause = {0, 5000000};
    (void)nanosleep(&pause, NULL);
}

/* Seconds after which a test gives up, also on a busy machine. */
enum { PATIENCE = 120 };

static int finish(pid_t program) {
    int how = 0;
    double limit = test_clock() + PATIENCE;
    while (waitpid(program, &how, WNOHANG) == 0) {
        if (test_clock() > limit) {
            test_fail(__FILE__, __LINE__, "the program does not end");
            (void)kill(program, SIGKILL);
            limit += PATIENCE;
        }
        rest();
    }
    return WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
}

/* Until standard error holds the text. */
static bool wait_for(const char *text) {
    char *path = path_in(test_folder(), "err.txt");
    bool found = false;
    for (double limit = test_clock() + PATIENCE; !found && test_clock() < limit; rest()) {
        char *have = test_read_file(path, NULL);
        found = have && strstr(have, text);
        free(have);
    }
    if (!found)
        test_fail(__FILE__, __LINE__, "\"%s\" never appears on standard error", text);
    free(path);
    return found;
}

/* Starts an endless picture over an old file and waits until tiles are rendered. */
static pid_t start_endless(void) {
    static const char *const words[] = {"-full", "-ss", "16", "-q", "--progress=json", "scene.lua", "second.lua", NULL};
    write_in_folder("scene.lua", ENDLESS);
    write_in_folder("second.lua", BALL "picture('second.png', 20, 20)\n");
    write_in_folder("out.png", OLD_PICTURE);
    pid_t program = start(words, NULL);
    (void)wait_for("\"event\":\"render\"");
    return program;
}

static int shell(const char *line) {
    return test_run_shell(line, "");
}

TEST(program_ends_with_0_when_all_pictures_are_written) {
    struct test_result result = test_gray_scene(SMALL, "scene.lua", NULL);
    CHECK_TEXT(result.err, "");
    CHECK_TEXT(result.out, "");
    ends(result, 0);
    struct test_picture picture = picture_of("out.png");
    CHECK_EQ_INT(picture.width, 70);
    CHECK_EQ_INT(picture.height, 50);
    free(picture.rgb);
}

TEST(program_ends_with_1_and_a_traceback_when_the_script_is_wrong) {
    struct test_result result =
        test_gray_scene("local function deep()\n  error('no such luck')\nend\ndeep()\n", "scene.lua", NULL);
    CHECK(strncmp(result.err, "scene.lua:2: no such luck\n  ", 28) == 0);
    ends(result, 1);
}

TEST(program_ends_with_2_when_it_is_called_wrongly) {
    ends_saying(test_gray(NULL, ""), 2, "gray: no scene script was given");
    ends_saying(test_gray(NULL, "--fulll scene.lua"), 2, "did you mean -full?");
    ends_saying(test_gray_scene(SMALL, "--crop 60,40,20,20 scene.lua", NULL), 2,
                "gray: --crop 60,40,20,20 does not lie inside the picture of 70 x 50");
    CHECK(!exists("out.png"));
}

TEST(program_ends_with_1_when_the_script_cannot_be_read) {
    ends_saying(test_gray(NULL, "nowhere.lua"), 1, "nowhere.lua");
    char *folder = path_in(test_folder(), "folder.lua");
    CHECK(mkdir(folder, 0777) == 0);
    free(folder);
    ends_saying(test_gray(NULL, "folder.lua"), 1, "folder.lua");
    write_in_folder("secret.lua", SMALL);
    char *secret = path_in(test_folder(), "secret.lua");
    CHECK(chmod(secret, 0) == 0);
    if (access(secret, R_OK) != 0)
        ends_saying(test_gray(NULL, "secret.lua"), 1, "secret.lua");
    free(secret);
}

TEST(later_scripts_are_rendered_after_a_failed_one_and_the_worst_status_wins) {
    write_in_folder("bad.lua", "error('broken')\n");
    write_in_folder("good.lua", BALL "picture('good.png', 20, 20)\n");
    struct test_result result = test_gray_scene(SMALL, "scene.lua bad.lua good.lua", NULL);
    CHECK(strstr(result.err, "bad.lua:1: broken"));
    ends(result, 1);
    CHECK(exists("out.png") && exists("good.png"));
}

TEST(numbered_output_counts_over_all_scripts) {
    write_in_folder("two.lua", BALL "picture('a.png', 20, 20)\npicture('b.png', 30, 20)\n");
    ends(test_gray_scene(SMALL, "-o deep/er/p%02d.png two.lua scene.lua", NULL), 0);
    CHECK(exists("deep/er/p01.png") && exists("deep/er/p02.png") && exists("deep/er/p03.png"));
    CHECK(!exists("a.png") && !exists("b.png") && !exists("out.png"));
    struct test_picture picture = picture_of("deep/er/p03.png");
    CHECK_EQ_INT(picture.width, 70);
    free(picture.rgb);
}

TEST(several_pictures_under_one_name_are_refused_before_anything_is_overwritten) {
    static const char *const arguments[] = {"-o keep.png scene.lua", "-o keep.png --no-fork scene.lua",
                                            "-o keep.png --check scene.lua"};
    for (int i = 0; i < 3; i++) {
        write_in_folder("keep.png", OLD_PICTURE);
        ends_saying(test_gray_scene(BALL "picture('a.png', 20, 20)\npicture('b.png', 20, 20)\n", arguments[i], NULL), 2,
                    "gray: -o keep.png: several pictures are rendered, so the name needs %d");
        holds_text("keep.png", OLD_PICTURE);
    }
}

TEST(one_picture_may_be_named_without_a_number) {
    ends(test_gray_scene(SMALL, "-o named.png scene.lua", NULL), 0);
    CHECK(exists("named.png") && !exists("out.png"));
    ends(test_gray_scene(SMALL, "-o alone.png --no-fork scene.lua", NULL), 0);
    same_bytes("named.png", "alone.png");
    struct test_result result = test_gray_scene(SMALL, "-o - scene.lua", NULL);
    CHECK(memcmp(result.out, "\x89PNG", 4) == 0);
    ends(result, 0);
}

TEST(any_number_of_threads_gives_the_same_bytes) {
    ends(test_gray_scene(SMALL, "-j 1 -o one.png scene.lua", NULL), 0);
    ends(test_gray_scene(NULL, "-j 2 -o two.png scene.lua", NULL), 0);
    ends(test_gray_scene(NULL, "-j 7 -o seven.png scene.lua", NULL), 0);
    ends(test_gray_scene(NULL, "--no-fork -o nofork.png scene.lua", NULL), 0);
    ends(test_gray_scene(NULL, "--accel none -o none.png scene.lua", NULL), 0);
    same_bytes("one.png", "two.png");
    same_bytes("one.png", "seven.png");
    same_bytes("one.png", "nofork.png");
    same_bytes("one.png", "none.png");
}

TEST(a_crop_is_exactly_that_part_of_the_whole) {
    ends(test_gray_scene(SMALL, "scene.lua", NULL), 0);
    ends(test_gray_scene(NULL, "--crop 23,7,41,37 -o crop.png scene.lua", NULL), 0);
    struct test_picture whole = picture_of("out.png"), part = picture_of("crop.png");
    CHECK_EQ_INT(part.width, 41);
    CHECK_EQ_INT(part.height, 37);
    for (uint32_t y = 0; y < part.height; y++)
        CHECK(memcmp(part.rgb + 3 * 41 * y, whole.rgb + 3 * (70 * (y + 7) + 23), 3 * 41) == 0);
    free(whole.rgb);
    free(part.rgb);
}

/* A second run replaces the picture and its layers: the files begin as files of their format do, and differently from
 * those of other formats. */
TEST(every_format_of_pictures_is_written_and_may_be_replaced) {
    static const char *const extensions[] = {PICTURE_FORMATS(LIST_WORD)};
    uint8_t heads[LIST_COUNT(PICTURE_FORMATS)][4] = {{0}};
    for (int i = 0; i < PICTURE_OTHER; i++) {
        char scene[2000], name[32], layer[32];
        if (i == PICTURE_EXR && !exr_can_write())
            continue;
        (void)snprintf(name, sizeof name, "out%s", extensions[i]);
        (void)snprintf(layer, sizeof layer, "out.normal%s", extensions[i]);
        (void)snprintf(scene, sizeof scene, BALL "picture('%s', 20, 20)\n", name);
        for (int run = 0; run < 2; run++) {
            struct test_result result = test_gray_scene(scene, "-q -j 1 --aov normal scene.lua", NULL);
            CHECK_EQ_INT(result.status, 0);
            if (result.status != 0)
                test_fail(__FILE__, __LINE__, "%s: %s", name, result.err);
            test_free_result(&result);
        }
        uint8_t head[FILE_HEAD_SIZE] = {0};
        const char *files[2] = {name, i == PICTURE_EXR ? name : layer};
        for (int k = 0; k < 2; k++) {
            char *path = path_in(test_folder(), files[k]);
            FILE *file = fopen(path, "rb");
            CHECK(file && fread(head, 1, sizeof head, file) == sizeof head && picture_file_is(head, sizeof head));
            if (file)
                (void)fclose(file);
            free(path);
            for (int other = 0; k == 0 && other < i; other++)
                CHECK(memcmp(head, heads[other], sizeof heads[other]) != 0);
            if (k == 0)
                memcpy(heads[i], head, sizeof heads[i]);
            CHECK(memcmp(head, heads[i], sizeof heads[i]) == 0);
        }
    }
}

TEST(size_replaces_the_size_of_the_script) {
    ends(test_gray_scene(SMALL, "--size 33x44 scene.lua", NULL), 0);
    struct test_picture picture = picture_of("out.png");
    CHECK_EQ_INT(picture.width, 33);
    CHECK_EQ_INT(picture.height, 44);
    free(picture.rgb);
}

TEST(debug_pictures_are_written_beside_the_picture) {
    ends(test_gray_scene(BALL "picture('sub/out.png', 70, 50)\n", "-write-aa-targets aa- -write-pre-aa pre- scene.lua",
                         NULL),
         0);
    struct test_picture final = picture_of("sub/out.png"), targets = picture_of("sub/aa-out.png");
    struct test_picture first = picture_of("sub/pre-out.png");
    int marked = 0, changed = 0;
    for (uint32_t i = 0; i < 70 * 50; i++) {
        const uint8_t *t = targets.rgb + 3 * i, *f = first.rgb + 3 * i;
        bool red = t[0] == 255 && t[1] == 0 && t[2] == 0, different = memcmp(final.rgb + 3 * i, f, 3) != 0;
        CHECK(red || memcmp(t, f, 3) == 0);
        CHECK(red || !different);
        marked += red;
        changed += different;
    }
    CHECK(marked > 20 && marked < 2000);
    CHECK(changed > 10);
    free(final.rgb);
    free(targets.rgb);
    free(first.rgb);
}

TEST(layers_are_written_beside_the_picture_in_its_format) {
    ends(test_gray_scene(BALL "picture('layers/out.png', 31, 21)\npicture('layers/light.pfm', 31, 21)\n",
                         "--aov depth,normal,cost scene.lua", NULL),
         0);
    struct test_picture normal = picture_of("layers/out.normal.png"), cost = picture_of("layers/out.cost.png");
    CHECK_EQ_INT(normal.width, 31);
    CHECK_EQ_INT(cost.height, 21);
    bool dark = true;
    for (uint32_t i = 0; i < 3 * 31 * 21; i++)
        dark = dark && normal.rgb[i] == 0;
    CHECK(!dark);
    CHECK(exists("layers/out.depth.png") && exists("layers/light.depth.pfm") && exists("layers/light.cost.pfm"));
    CHECK(!exists("layers/out.uv.png"));
    free(normal.rgb);
    free(cost.rgb);
    ends_saying(test_gray_scene(NULL, "--aov cost -o - scene.lua", NULL), 2, "there is no file name for --aov");
    ends_saying(test_gray_scene(NULL, "--aov cost --shard 1/2 scene.lua", NULL), 2, "one process");
}

static double figure_of(const char *json, const char *key) {
    char quoted[64];
    (void)snprintf(quoted, sizeof quoted, "\"%s\":", key);
    const char *at = strstr(json, quoted);
    CHECK(at != NULL);
    return at ? strtod(at + strlen(quoted), NULL) : NAN;
}

TEST(figures_of_the_statistics_agree_with_one_another) {
    static const char *const accels[] = {"auto", "grid", "bvh", "kdtree", "none"};
    for (int i = 0; i < 5; i++) {
        char arguments[128];
        (void)snprintf(arguments, sizeof arguments, "--stats=json --accel %s scene.lua", accels[i]);
        struct test_result result = test_gray_scene(BALL "picture('s.png', 40, 30)\n", arguments, NULL);
        const char *json = result.out;
        double rays = figure_of(json, "rays");
        CHECK(rays == figure_of(json, "camera_rays") + figure_of(json, "reflected_rays") +
                          figure_of(json, "refracted_rays") + figure_of(json, "shadow_rays") +
                          figure_of(json, "photon_rays"));
        CHECK(fabs(figure_of(json, "rays_per_pixel") * 1200 - rays) < 1);
        CHECK(fabs(figure_of(json, "hierarchy_steps_per_ray") * rays - figure_of(json, "hierarchy_steps")) < 1);
        CHECK(fabs(figure_of(json, "voxels_per_pixel") * 1200 - figure_of(json, "voxels")) < 1);
        CHECK(figure_of(json, "film_bytes") >= 1200 * 25 && figure_of(json, "node_bytes") > 0);
        CHECK(figure_of(json, "peak_bytes") > figure_of(json, "film_bytes") + figure_of(json, "placed_bytes"));
        ends(result, 0);
    }
}

/* Under one name the picture is written after the script. */
TEST(statistics_have_the_time_of_writing) {
    static const char *const names[] = {"-o one.png ", "-o each%d.png ", ""};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char arguments[64];
        (void)snprintf(arguments, sizeof arguments, "%s--stats=json scene.lua", names[i]);
        struct test_result result = test_gray_scene(BALL "picture('s.png', 200, 200)\n", arguments, NULL);
        CHECK(figure_of(result.out, "write_seconds") > 0);
        ends(result, 0);
    }
}

TEST(names_with_blanks_dashes_and_signs_work) {
    static const char *const words[] = {"-o", "-out put/\xc3\xa9 100%% 'x'.png", "--", "-my scene.lua", NULL};
    write_in_folder("-my scene.lua", SMALL);
    CHECK_EQ_INT(finish(start(words, NULL)), 0);
    CHECK(exists("-out put/\xc3\xa9 100% 'x'.png"));
    static const char *const script_names[] = {"name it.lua", NULL};
    write_in_folder("name it.lua", BALL "picture('a b/-c.png', 10, 10)\n");
    CHECK_EQ_INT(finish(start(script_names, NULL)), 0);
    CHECK(exists("a b/-c.png"));
}

TEST(a_folder_with_the_name_of_the_picture_is_an_error_before_rendering) {
    char *folder = path_in(test_folder(), "out.png");
    CHECK(mkdir(folder, 0777) == 0);
    free(folder);
    struct test_result result = test_gray_scene(ENDLESS, "-full -ss 16 --progress=json scene.lua", NULL);
    CHECK(!strstr(result.err, "\"event\":\"render\""));
    ends_saying(result, 1, "out.png");
    ends_saying(test_gray_scene(BALL "picture('new/', 5, 5)\n", "scene.lua", NULL), 1, "scene.lua:");
}

TEST(a_full_device_is_an_error_of_the_machine) {
    ends_saying(test_gray_scene(SMALL, "-o /dev/full scene.lua", NULL), 3, "No space left");
    ends_saying(test_gray_scene(BALL "picture('/dev/full', 9, 9)\n", "scene.lua", NULL), 1,
                "below the working directory");
}

/* A file system of eight kilobytes, visible only to this process and its children, with an old picture on it. The
 * program runs there; the picture is checked before the file system is removed. */
enum { NO_SMALL_DISK = 99, PICTURE_HARMED = 98 };

/* An ordinary user mounts in a user namespace, where only users that it maps can create files. */
static bool enter_namespace(void) {
    char map[64];
    uid_t user = geteuid();
    gid_t group = getegid();
    if (unshare(CLONE_NEWNS) == 0)
        return true;
    if (unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0)
        return false;
    test_write_text("/proc/self/setgroups", "deny");
    (void)snprintf(map, sizeof map, "%u %u 1", (unsigned)user, (unsigned)user);
    test_write_text("/proc/self/uid_map", map);
    (void)snprintf(map, sizeof map, "%u %u 1", (unsigned)group, (unsigned)group);
    test_write_text("/proc/self/gid_map", map);
    return true;
}

static void viewer_on_tiny_disk(void) {
    if (!enter_namespace())
        _exit(NO_SMALL_DISK);
    (void)mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL);
    if (mount("tiny", "disk", "tmpfs", 0, "size=8k,nr_inodes=8") != 0)
        _exit(NO_SMALL_DISK);
    test_write_text("disk/out.png", OLD_PICTURE);
    pid_t program = fork();
    if (program == 0)
        return;
    int how = 0;
    (void)waitpid(program, &how, 0);
    char *text = test_read_file("disk/out.png", NULL);
    bool harmed = !text || strcmp(text, OLD_PICTURE) != 0 || leftovers("disk") > 0;
    _exit(harmed ? PICTURE_HARMED : WEXITSTATUS(how));
}

TEST(a_full_disk_leaves_the_old_picture_and_no_temporary_file) {
    static const char *const words[] = {"-q", "scene.lua", NULL};
    char *disk = path_in(test_folder(), "disk");
    CHECK(mkdir(disk, 0777) == 0);
    free(disk);
    write_in_folder("scene.lua", BALL "picture('disk/out.png', 300, 200)\n");
    int status = finish(start(words, viewer_on_tiny_disk));
    if (status == NO_SMALL_DISK)
        test_skip("this user may not mount a small file system");
    CHECK_EQ_INT(status, 3);
    char *text = bytes_of("err.txt", NULL);
    CHECK(text && strstr(text, "No space left"));
    free(text);
}

static void limit_file_size(void) {
    struct rlimit limit = {100000, 100000};
    (void)setrlimit(RLIMIT_FSIZE, &limit);
}

TEST(a_limit_on_file_sizes_is_an_error_not_a_signal) {
    static const char *const words[] = {"scene.lua", NULL};
    write_in_folder("scene.lua", BALL "picture('out.png', 700, 500)\n");
    write_in_folder("out.png", OLD_PICTURE);
    CHECK_EQ_INT(finish(start(words, limit_file_size)), 3);
    holds_text("out.png", OLD_PICTURE);
    CHECK_EQ_INT(leftovers(test_folder()), 0);
}

TEST(a_killed_rendering_process_leaves_the_old_picture_and_the_next_script_runs) {
    pid_t program = start_endless(), child = test_child_of(program);
    CHECK(child > 0 && kill(child, SIGKILL) == 0);
    CHECK_EQ_INT(finish(program), 3);
    holds_text("out.png", OLD_PICTURE);
    CHECK(exists("second.png"));
    CHECK_EQ_INT(leftovers(test_folder()), 0);
    (void)wait_for("scene.lua: the render process was killed while it rendered out.png, which is not written");
}

TEST(a_crash_is_reported_in_one_line_with_its_signal) {
    pid_t program = start_endless(), child = test_child_of(program);
    CHECK(child > 0 && kill(child, SIGABRT) == 0);
    CHECK_EQ_INT(finish(program), 3);
    holds_text("out.png", OLD_PICTURE);
    CHECK_EQ_INT(leftovers(test_folder()), 0);
    (void)wait_for("scene.lua: the render process crashed (signal 6, Aborted) while it rendered out.png");
}

static void interrupted_by(int signal_number) {
    pid_t program = start_endless();
    CHECK(kill(program, signal_number) == 0);
    CHECK_EQ_INT(finish(program), 130);
    holds_text("out.png", OLD_PICTURE);
    CHECK(!exists("second.png"));
    CHECK_EQ_INT(leftovers(test_folder()), 0);
    (void)wait_for("gray: interrupted, out.png is not written");
}

TEST(control_c_ends_the_run_with_130_and_the_old_picture_stays) {
    interrupted_by(SIGINT);
}

TEST(a_request_to_terminate_ends_the_run_with_130_and_keeps_the_old_picture) {
    interrupted_by(SIGTERM);
}

static void interrupted_script(const char *script) {
    static const char *const words[] = {"scene.lua", NULL};
    char text[512];
    (void)snprintf(text, sizeof text, "io.stderr:write('begun\\n')\n%s", script);
    write_in_folder("scene.lua", text);
    pid_t program = start(words, NULL);
    CHECK(wait_for("begun"));
    struct timespec pause = {0, 200000000};
    (void)nanosleep(&pause, NULL);
    CHECK(kill(program, SIGINT) == 0);
    CHECK_EQ_INT(finish(program), 130);
}

TEST(a_hang_up_ends_the_run_with_130_and_the_old_picture_stays) {
    interrupted_by(SIGHUP);
}

TEST(the_mode_bits_of_a_picture_that_was_there_stay) {
    struct stat status;
    char *path = path_in(test_folder(), "out.png");
    write_in_folder("out.png", OLD_PICTURE);
    CHECK(chmod(path, 0640) == 0);
    ends(test_gray_scene(SMALL, "scene.lua", NULL), 0);
    CHECK(stat(path, &status) == 0 && (status.st_mode & 07777) == 0640);
    struct test_picture picture = picture_of("out.png");
    CHECK_EQ_INT(picture.width, 70);
    free(picture.rgb);
    free(path);
}

TEST(a_name_as_long_as_the_file_system_allows_can_be_written) {
    char name[256], arguments[512];
    memset(name, 'n', 251);
    memcpy(name + 251, ".png", 5);
    (void)snprintf(arguments, sizeof arguments, "-o %s scene.lua", name);
    ends(test_gray_scene(SMALL, arguments, NULL), 0);
    struct test_picture picture = picture_of(name);
    CHECK_EQ_INT(picture.width, 70);
    free(picture.rgb);
}

TEST(a_folder_that_cannot_hold_a_file_is_one_line_and_status_1) {
    struct test_result result = test_gray_scene(SMALL, "-o /proc/out.png scene.lua", NULL);
    CHECK(strchr(result.err, '\n') == strrchr(result.err, '\n'));
    ends_saying(result, 1, "/proc/out.png: cannot be written: ");
}

TEST(a_reader_of_the_picture_that_goes_away_is_one_line_and_status_3) {
    write_in_folder("scene.lua", BALL "picture('out.png', 700, 500)\n");
    CHECK_EQ_INT(shell("(\"$gray\" -o - scene.lua 2>err.txt; echo $? >status.txt) | head -c 8 >start.txt"), 0);
    holds_text("status.txt", "3\n");
    holds_text("err.txt", "standard output: cannot be written: Broken pipe\n");
}

TEST(a_picture_on_standard_output_is_the_picture_and_nothing_a_script_prints) {
    ends(test_gray_scene(SMALL, "scene.lua", NULL), 0);
    write_in_folder("scene.lua", "print('hello')\n" SMALL "io.write('end')\n");
    CHECK_EQ_INT(shell("\"$gray\" -o - scene.lua >piped.png 2>err.txt"), 0);
    same_bytes("out.png", "piped.png");
    holds_text("err.txt", "hello\nend");
}

TEST(a_kill_while_the_picture_is_written_leaves_the_old_one_and_no_other_file) {
    static const char *const words[] = {"-q", "scene.lua", NULL};
    write_in_folder("scene.lua", BALL "picture('out.png', 1000, 1000)\n");
    for (int i = 0; i < 12; i++) {
        write_in_folder("out.png", OLD_PICTURE);
        pid_t program = start(words, NULL);
        for (double limit = test_clock() + 0.05 + 0.03 * i; test_clock() < limit;)
            rest();
        (void)kill(program, SIGKILL);
        (void)finish(program);
        char *bytes = bytes_of("out.png", NULL);
        CHECK(bytes && (strcmp(bytes, OLD_PICTURE) == 0 || memcmp(bytes, "\x89PNG", 4) == 0));
        free(bytes);
    }
    /* Between link and rename the file has a name; a run that finds it older than a minute removes it. */
    if (leftovers(test_folder()) > 0) {
        (void)sleep(62);
        ends(test_gray(NULL, "-q scene.lua"), 0);
        CHECK_EQ_INT(leftovers(test_folder()), 0);
    }
}

TEST(a_script_in_an_endless_loop_can_be_interrupted) {
    interrupted_script("while true do pcall(error, 1) end\n");
}

TEST(a_script_inside_a_function_of_lua_itself_can_be_interrupted) {
    interrupted_script("string.find(string.rep('a', 200), string.rep('a*', 100) .. 'b')\n");
}

/* A pixel of it takes longer than a test may. */
TEST(a_rendering_in_long_pixels_is_interrupted_within_a_pixel) {
    static const char *const words[] = {"-full",           "-ss",       "64", "-al-samples", "64", "-q",
                                        "--progress=json", "scene.lua", NULL};
    write_in_folder("scene.lua", BALL
                    "local l = {} for k = 1, 500 do l[k] = gr.area_light({4, 5, 6}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}, "
                    "{1, 0, 0}) end\n"
                    "gr.render(r, 'out.png', 200, 200, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {1, 1, 1}, l)\n");
    pid_t program = start(words, NULL);
    (void)wait_for("\"event\":\"render\"");
    rest();
    CHECK(kill(program, SIGINT) == 0);
    CHECK_EQ_INT(finish(program), 130);
}

TEST(a_build_that_is_interrupted_ends_before_the_rendering) {
    static const char *const words[] = {"-q", "--progress=json", "scene.lua", NULL};
    write_in_folder("scene.lua",
                    "local v, f = {}, {}\n"
                    "for k = 1, 600000 do local a = k * 0.61 v[k] = {a % 7, a * a % 5, k % 13 + a % 1} end\n"
                    "for k = 1, 599997 do f[k] = {k - 1, k, k + 1} end\n"
                    "local m, r = gr.mesh(gr.material({1, 1, 1}, {0, 0, 0}, 1), v, f), gr.node('r')\n"
                    "r:add_child(gr.geometry('m', m))\n"
                    "io.stderr:write('made\\n')\n"
                    "gr.render(r, 'out.png', 2000, 2000, {0, 0, 60}, {0, 0, -1}, {0, 1, 0}, 40, {1, 1, 1}, {})\n");
    pid_t program = start(words, NULL);
    (void)wait_for("made");
    CHECK(kill(program, SIGINT) == 0);
    CHECK_EQ_INT(finish(program), 130);
    char *said = bytes_of("err.txt", NULL);
    CHECK(said && !strstr(said, "\"event\":\"render\""));
    free(said);
}

TEST(the_rendering_process_goes_with_its_supervisor) {
    pid_t program = start_endless(), child = test_child_of(program);
    CHECK(child > 0 && kill(program, SIGKILL) == 0);
    CHECK_EQ_INT(finish(program), 128 + SIGKILL);
    /* It has ended, or is a zombie. */
    char path[64];
    bool gone = false;
    (void)snprintf(path, sizeof path, "/proc/%d/stat", (int)child);
    for (double limit = test_clock() + PATIENCE; !gone && test_clock() < limit; rest()) {
        char *text = test_read_file(path, NULL);
        gone = !text || !text[0] || strstr(text, ") Z ");
        free(text);
    }
    CHECK(gone);
    holds_text("out.png", OLD_PICTURE);
}

TEST(check_builds_every_scene_and_writes_nothing) {
    struct test_result result = test_gray_scene(SMALL, "--check scene.lua", NULL);
    CHECK_TEXT(result.err, "");
    ends(result, 0);
    CHECK(!exists("out.png"));
    /* Two scenes with an open operand, and between them one that is correct except for its material. */
    ends_saying(
        test_gray_scene(
            "local function open(name) return gr.mesh(name, {{0,0,0}, {1,0,0}, {0,1,0}}, {{0,1,2}}) end\n"
            "local a = gr.difference('a', gr.cube('ca'), gr.node('ga'):add_child(open('oa')))\n"
            "local b = gr.difference('b', gr.cube('cb'), gr.node('gb'):add_child(open('ob')))\n"
            "local plain = gr.sphere('plain')\n"
            "local function picture(n) gr.render(n, 'x.png', 9, 9, {0,0,5}, {0,0,-1}, {0,1,0}, 40, {1,1,1}, {}) end\n"
            "picture(a)\npicture(plain)\npicture(b)\nerror('last')\n",
            "--check scene.lua", NULL),
        1, "plain");
    result = test_gray_scene(NULL, "--check scene.lua", NULL);
    const char *first = strstr(result.err, "mesh is open"), *second = first ? strstr(first + 5, "mesh is open") : NULL;
    CHECK(first && second && strstr(second, "scene.lua:9: last"));
    ends(result, 1);
    CHECK(!exists("x.png"));
}

TEST(statistics_as_json_are_one_line_a_picture_on_standard_output) {
    struct test_result result =
        test_gray_scene(BALL "picture('a\"b.png', 20, 10)\npicture('c.png', 20, 10)\n", "--stats=json scene.lua", NULL);
    CHECK(strncmp(result.out, "{\"picture\":\"a\\\"b.png\",\"width\":20,\"height\":10,", 43) == 0);
    const char *second = strchr(result.out, '\n');
    CHECK(second && strncmp(second + 1, "{\"picture\":\"c.png\"", 18) == 0);
    CHECK(strstr(result.out, "\"pixels\":200,") && strstr(result.out, "\"primitives\":2,"));
    CHECK_TEXT(result.err, "");
    ends(result, 0);
    result = test_gray_scene(NULL, "--stats scene.lua", NULL);
    CHECK_TEXT(result.out, "");
    CHECK(strstr(result.err, "shadow rays"));
    ends(result, 0);
}

TEST(quiet_leaves_errors_only) {
    const char *odd = "gr.render(gr.sphere('plain'), 'x.png', 9, 9, {0,0,5}, {0,0,-1}, {0,1,0}, 40, {1,1,1}, {})\n";
    ends_saying(test_gray_scene(odd, "scene.lua", NULL), 0, "warning");
    struct test_result result = test_gray_scene(NULL, "-q scene.lua", NULL);
    CHECK_TEXT(result.err, "");
    ends(result, 0);
    ends_saying(test_gray_scene("error('x')", "-q scene.lua", NULL), 1, "scene.lua:1: x");
}

TEST(texts_of_a_scene_cannot_steer_the_terminal) {
    struct test_result result = test_gray_scene("error('\\27[2J\\rgone\\8')", "scene.lua", NULL);
    CHECK(strstr(result.err, "?[2J?gone?"));
    CHECK(!strchr(result.err, '\33') && !strchr(result.err, '\r') && !strchr(result.err, '\b'));
    ends(result, 1);
}

TEST(a_reader_of_standard_output_that_goes_away_does_the_picture_no_harm) {
    write_in_folder("scene.lua", "for i = 1, 20000 do print(i) end\n" SMALL);
    CHECK_EQ_INT(shell("{ \"$gray\" scene.lua 2>err.txt; echo $? >status; } | true"), 0);
    holds_text("status", "3\n");
    holds_text("err.txt", "gray: standard output cannot be written\n");
    CHECK(exists("out.png"));
}

TEST(closed_standard_streams_do_not_spoil_a_picture) {
    write_in_folder("scene.lua", "print('words')\nio.stderr:write('more words')\n" SMALL);
    CHECK_EQ_INT(shell("\"$gray\" scene.lua >out.txt 2>&1 && mv out.png open.png && \"$gray\" scene.lua <&- >&- 2>&-"),
                 3); /* the messages are lost */
    same_bytes("open.png", "out.png");
    CHECK_EQ_INT(shell("\"$gray\" --help >&- 2>err.txt"), 3);
    holds_text("err.txt", "gray: standard output cannot be written\n");
    CHECK_EQ_INT(shell("\"$gray\" --help >/dev/full 2>err.txt"), 3);
    CHECK_EQ_INT(shell("\"$gray\" --pixel 3,3 scene.lua >/dev/full 2>err.txt"), 3);
    CHECK_EQ_INT(shell("grep -q 'standard output cannot be written' err.txt"), 0);
    CHECK_EQ_INT(shell("\"$gray\" --dump-scene --no-fork scene.lua >/dev/full 2>err.txt"), 3);
}

TEST(the_library_is_found_from_any_folder_and_through_the_environment) {
    ends(test_gray_scene("assert(require('readobj'))\n", "scene.lua", NULL), 0);
    char *folder = path_in(test_folder(), "my lib"), *variable = NULL;
    CHECK(mkdir(folder, 0777) == 0);
    write_in_folder("my lib/mine.lua", "return 42\n");
    if (asprintf(&variable, "GRAY_LUA=%s", folder) < 0)
        exit(1);
    ends(test_gray_scene("assert(require('mine') == 42)\n", "scene.lua", variable), 0);
    ends(test_gray_scene("print(1)\n", "scene.lua", "GRAY_LUA=/nowhere/at/all"), 0);
    free(folder);
    free(variable);
}

TEST(a_copied_program_finds_the_library_of_the_tree_where_it_was_built) {
    write_in_folder("scene.lua", "assert(require 'easing')\n");
    CHECK_EQ_INT(shell("mkdir elsewhere && cp \"$gray\" elsewhere/program && elsewhere/program -q scene.lua"), 0);
}

TEST(a_moved_installation_finds_its_own_library) {
    write_in_folder("scene.lua", "assert(require 'easing' == 'moved')\n");
    CHECK_EQ_INT(
        shell("mkdir -p moved/bin moved/share/gray/lua && cp \"$gray\" moved/bin && cd moved/share/gray/lua && "
              "echo \"return 'moved'\" >easing.lua && touch readobj.lua && cd ../../../.. && "
              "moved/bin/gray -q scene.lua"),
        0);
}

TEST(definitions_reach_every_script) {
    write_in_folder("other.lua", "assert(n == 3 and word == 'a b')\n");
    static const char *const words[] = {"-D", "n=3", "-Dword=a b", "scene.lua", "other.lua", NULL};
    write_in_folder("scene.lua", "assert(n == 3 and word == 'a b')\nn = 4\n");
    CHECK_EQ_INT(finish(start(words, NULL)), 0);
}

TEST(a_warning_about_a_scene_comes_once_for_many_frames) {
    struct test_result result =
        test_gray_scene("local n = gr.sphere('plain')\nfor i = 1, 5 do\n"
                        "gr.render(n, i .. '.png', 9, 9, {0,0,5}, {0,0,-1}, {0,1,0}, 40, {1,1,1}, {})\nend\n",
                        "scene.lua", NULL);
    const char *first = strstr(result.err, "warning");
    CHECK(first && !strstr(first + 1, "warning"));
    ends(result, 0);
    CHECK(exists("1.png") && exists("5.png"));
}

TEST(progress_can_be_a_bar_or_json_lines) {
    write_in_folder("scene.lua", BALL "picture('out.png', 400, 400)\n");
    static const char *const bar[] = {"--progress=bar", "-full", "-ss", "8", "scene.lua", NULL};
    CHECK_EQ_INT(finish(start(bar, NULL)), 0);
    char *text = bytes_of("err.txt", NULL);
    CHECK(text && strstr(text, "\rout.png [") && strstr(text, "\rout.png  400 x 400  "));
    free(text);
    static const char *const json[] = {"--progress=json", "scene.lua", NULL};
    CHECK_EQ_INT(finish(start(json, NULL)), 0);
    text = bytes_of("err.txt", NULL);
    CHECK(text && strstr(text, "{\"picture\":\"out.png\",\"event\":\"begin\",\"width\":400,") == text);
    CHECK(text && strstr(text, "\"event\":\"written\"") && text[strlen(text) - 2] == '}');
    free(text);
}

TEST(help_names_every_option_of_the_manual_and_version_the_libraries) {
    static const char *const names[] = {"-ss",
                                        "-full",
                                        "-reflect-limit",
                                        "-refract-limit",
                                        "-write-aa-targets",
                                        "-write-pre-aa",
                                        "-side-tolerance",
                                        "-corner-tolerance",
                                        "-use-tir",
                                        "-al-samples",
                                        "-alsamples",
                                        "-j",
                                        "-o",
                                        "--size",
                                        "--seed",
                                        "--crop",
                                        "-D",
                                        "--transform-order",
                                        "--view",
                                        "--pixel-sample",
                                        "--specular",
                                        "--ambient",
                                        "--lenient",
                                        "-gui",
                                        "-q",
                                        "--verbose",
                                        "--stats",
                                        "--progress",
                                        "--check",
                                        "--version",
                                        "--help",
                                        "--man"};
    struct test_result result = test_gray(NULL, "--help");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (!strstr(result.out, names[i]))
            test_fail(__FILE__, __LINE__, "--help does not tell of %s", names[i]);
    }
    ends(result, 0);
    result = test_gray(NULL, "--version");
    CHECK(strncmp(result.out, "gray ", 5) == 0 && strstr(result.out, "Lua 5.4") && strstr(result.out, "libpng 1."));
    ends(result, 0);
    result = test_gray(NULL, "--man");
    CHECK(strstr(result.out, "-refract-limit") && strstr(result.out, "gr.sphere"));
    ends(result, 0);
}

TEST(the_scene_of_the_readme_is_the_file_beside_its_picture_and_renders) {
    char *readme = test_read_file("README.md", NULL), *scene = test_read_file("docs/first.lua", NULL);
    char *begin = readme ? strstr(readme, "```lua\n") : NULL, *end = begin ? strstr(begin + 7, "```\n") : NULL;
    CHECK(end && scene);
    if (!end || !scene)
        return;
    *end = '\0';
    CHECK_TEXT(begin + 7, scene);
    ends(test_gray_scene(scene, "scene.lua", NULL), 0);
    struct test_picture picture = picture_of("first.png");
    CHECK_EQ_INT(picture.width, 480);
    free(picture.rgb);
    free(readme);
    free(scene);
}

TEST(names_with_line_ends_and_control_characters_cannot_speak_for_the_program) {
    /* In a warning about the scene, in an error of an argument, in a name of a file, in Lua's own error. */
    struct test_result result =
        test_gray_scene("local r = gr.node('r') r:add_child(gr.sphere('a\\ngray: notice: b\\27[2J\\u{9b}2J\\x9b'))\n"
                        "gr.render(r, 'out.png', 8, 8, {0, 0, 10}, {0, 0, -1}, {0, 1, 0}, 50, {0.3, 0.3, 0.3}, {})\n",
                        "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err,
               "scene.lua: warning: node 'a?gray: notice: b?[2J?2J?' has no material and is shown in plain gray "
               "(made at scene.lua:1)\n");
    test_free_result(&result);
    result = test_gray_scene("gr.superellipsoid{name = 'a\\n  b\\ngray: c', e = 0}\n", "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.err, "(node 'a?  b?gray: c')\n  stack traceback:\n") && !strstr(result.err, "\ngray"));
    test_free_result(&result);
    result = test_gray_scene("gr.mesh{file = 'a\\ngray: c'}\n", "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.err, "a?gray: c") && !strstr(result.err, "\ngray"));
    test_free_result(&result);
    result = test_gray_scene("error('a\\ngray: c')\n", "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.err, "scene.lua:1: a\n  gray: c\n  stack traceback:\n") == result.err);
    test_free_result(&result);
}

TEST(descriptors_that_are_closed_at_the_start_do_not_become_those_of_other_files) {
    struct test_result whole = test_gray_scene(
        "print('x') local r = gr.node('r') r:add_child(gr.sphere('plain'))\n"
        "gr.render(r, 'whole.png', 20, 16, {0, 0, 10}, {0, 0, -1}, {0, 1, 0}, 50, {0.3, 0.3, 0.3}, {})\n",
        "scene.lua", NULL);
    CHECK_EQ_INT(whole.status, 0);
    CHECK(strstr(whole.err, "has no material"));
    CHECK_EQ_INT(
        shell("for k in '<&-' '>&-' '2>&-' '<&- >&- 2>&-' '>&- 2>&-'; do "
              "case $k in *'>&- 2'*|'>&-') want=3;; *) want=0;; esac; " /* what is printed is lost */
              "eval $gray scene.lua -o out.png $k >said.txt; test $? = $want && cmp out.png whole.png || exit 1; "
              "rm out.png; done"),
        0);
    CHECK_EQ_INT(shell("$gray scene.lua -o - >&- 2>said.txt"), 3);
    CHECK_EQ_INT(shell("grep -q 'standard output: cannot be written: ' said.txt"), 0);
    test_free_result(&whole);
}

TEST(a_thousand_reflections_fit_whatever_the_limit_of_the_stack) {
    struct test_result plain = test_gray_scene(
        "local m = gr.rr_material({0.01, 0.01, 0.01}, {1, 1, 1}, 10, 1, 0, 1)\n"
        "local r = gr.node('r') r:add_child(gr.cube{material = m, corner = {-10, -10, -10}, size = 20})\n"
        "gr.render{node = r, file = 'whole.png', width = 8, height = 6, eye = {0, 0, 9}, view = {0, 0, -1}, fov = 50,\n"
        "  lights = {gr.light({0, 5, 0}, {1, 1, 1}, {1, 0, 0})}, fog = gr.uniform_fog{density = 0}, cutoff = 0}\n",
        "scene.lua -j 2 -ss 1 -reflect-limit 1000", NULL);
    CHECK_EQ_INT(plain.status, 0);
    CHECK_EQ_INT(shell("for limit in 256 1024 unlimited; do for threads in 1 2; do "
                       "(ulimit -S -s $limit && $gray scene.lua -q -o out.png -j $threads -ss 1 -reflect-limit 1000) "
                       "&& cmp out.png whole.png || exit 1; rm out.png; done; done"),
                 0);
    test_free_result(&plain);
}

TEST(verbose_names_the_voxels_of_a_grid_only) {
    static const char scene[] = "local s = gr.sphere('s', gr.material({1,1,1}, {0,0,0}, 1))\n"
                                "gr.render{node=s, file='x.png', width=8, height=8, eye={0,0,5}}\n";
    static const char *const accels[] = {"grid", "bvh", "kdtree", "none"};
    for (int i = 0; i < 4; i++) {
        char options[64];
        (void)snprintf(options, sizeof options, "--verbose --accel %s scene.lua", accels[i]);
        struct test_result result = test_gray_scene(scene, options, NULL);
        const char *out = result.out, *err = result.err;
        CHECK_EQ_INT(result.status, 0);
        CHECK(strstr(out, ": 1 primitives, 0 triangles,") || strstr(err, ": 1 primitives, 0 triangles,"));
        CHECK((strstr(out, "grid of 1 x 1 x 1") || strstr(err, "grid of 1 x 1 x 1")) == (i == 0));
        CHECK(!strstr(out, "grid of 0") && !strstr(err, "grid of 0"));
        test_free_result(&result);
    }
}

/* The same voxels as a table, a plain file, and NRRD. */
TEST(grids_of_a_medium_from_a_table_and_from_files_give_the_same_bytes) {
    static const char scene[] =
        "local box = {scattering = {2, 2, 2}, corner = {-1, -1, -1}, size = 2}\n"
        "local function smoke(name, fields)\n"
        "  for k, v in pairs(box) do fields[k] = v end\n"
        "  gr.render{node = gr.sphere{medium = gr.medium(fields)}, file = name, width = 16, height = 16,\n"
        "            eye = {0, 0, 4}, background = {1, 1, 1}, integrator = 'path', spp = 4}\n"
        "end\n"
        "smoke('table.png', {cells = {2, 1, 3}, density = {0, 1, 2, 3, 4, 5}})\n"
        "smoke('plain.png', {cells = {2, 1, 3}, type = 'uint8', density = 'plain.raw'})\n"
        "smoke('nrrd.png', {density = 'grid.nrrd'})\n";
    static const uint8_t voxels[6] = {0, 1, 2, 3, 4, 5};
    static const char nrrd[] = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 3\nencoding: raw\n\n\0\1\2\3\4\5";
    char path[512];
    (void)snprintf(path, sizeof path, "%s/plain.raw", test_folder());
    test_write_file(path, voxels, sizeof voxels);
    (void)snprintf(path, sizeof path, "%s/grid.nrrd", test_folder());
    test_write_file(path, nrrd, sizeof nrrd - 1);
    ends(test_gray_scene(scene, "-q scene.lua", NULL), 0);
    same_bytes("table.png", "plain.png");
    same_bytes("table.png", "nrrd.png");
}

TEST(a_density_above_its_bound_is_one_warning_that_names_the_point) {
    static const char scene[] =
        "local m = gr.medium{scattering = {1, 1, 1}, corner = {-1, -1, -1}, size = 2, bound = 1,\n"
        "                    density = function(p) return 2 + p.x end}\n"
        "gr.render{node = gr.sphere{medium = m}, file = 'a.png', width = 16, height = 16, eye = {0, 0, 4},\n"
        "          background = {1, 1, 1}, integrator = 'path', spp = 4}\n";
    struct test_result result = test_gray_scene(scene, "-j 1 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    const char *warning = strstr(result.err, "warning: the density of a medium is ");
    CHECK(warning && strstr(warning, "between p = {-0.125, "));
    CHECK(warning && !strstr(warning + 20, "the density of a medium is "));
    test_free_result(&result);
}
