/* Injected failures: every allocation and every system call that can fail fails once in a complete run of the program,
 * with a scene that reads scripts, meshes and pictures and writes several files. Whatever fails, the program ends by
 * itself with one line and the right status, leaves complete pictures or none, and keeps old ones. */
#define _GNU_SOURCE
#include "base/fault.h"
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const char scene[] =
    "local shapes = require('shapes')\n"
    "local h = assert(io.open('numbers.txt')); local n = h:read('n'); h:close()\n"
    "local red = gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20)\n"
    "local r = gr.node('root')\n"
    "r:add_child(gr.geometry('ball', gr.sphere(gr.td_sphere_material(red, 'image.png'))))\n"
    "r:add_child(gr.mesh{name='file', file='mesh.obj', material=red})\n"
    "r:add_child(gr.csg_difference('cut', gr.geometry('a', gr.cube(red)), gr.geometry('b', gr.sphere(red))))\n"
    "for i = 1, n do r:add_child(shapes.some(red, i)) end\n"
    "local lights = {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0}),\n"
    "  gr.area_light({4, 5, 6}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.3}, {1, 0, 0})}\n"
    "gr.render(r, 'sub/a.png', 40, 30, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, lights)\n"
    "gr.render(r, 'b.pfm', 20, 30, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, lights)\n";
static const char module[] = "local shapes = {}\n"
                             "function shapes.some(m, i)\n"
                             "  local n = gr.geometry('c' .. i, gr.cylinder{material=m, radius=0.2})\n"
                             "  n:translate(i / 2 - 1.5, 1.4, 0)\n"
                             "  return n\n"
                             "end\n"
                             "return shapes\n";
static const char mesh[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

/* Tests run in parallel: each has failures of its own. */
TEST(processes_that_count_apart_do_not_fail_for_each_other) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    int ready[2], done[2], how = 0;
    char byte = 0;
    CHECK(pipe(ready) == 0 && pipe(done) == 0);
    fault_at(FAULT_OF_ALLOCATION, 2);
    pid_t child = fork();
    if (child == 0) {
        fault_apart();
        bool own = fault_count(FAULT_OF_ALLOCATION) == 0 && !fault_now(FAULT_OF_ALLOCATION);
        own = own && !fault_now(FAULT_OF_ALLOCATION); /* the parent's number */
        fault_at(FAULT_OF_ALLOCATION, 1);
        _exit(write(ready[1], "x", 1) == 1 && read(done[0], &byte, 1) == 1 && own && fault_now(FAULT_OF_ALLOCATION)
                  ? 0
                  : 1);
    }
    CHECK(read(ready[0], &byte, 1) == 1);
    CHECK(!fault_now(FAULT_OF_ALLOCATION)); /* not the child's */
    CHECK(fault_now(FAULT_OF_ALLOCATION));
    CHECK(write(done[1], "x", 1) == 1);
    CHECK(waitpid(child, &how, 0) == child && WIFEXITED(how) && WEXITSTATUS(how) == 0);
}

static int shell(const char *line) {
    return test_run_shell(line, "");
}

static char *content(const char *name, size_t *size) {
    return test_read_file(test_path(name), size);
}

static void put(const char *name, const char *text) {
    test_write_text(test_path(name), text);
}

static void prepare(uint64_t counts[2]) {
    unsigned long long a = 0, b = 0;
    if (fault_count(FAULT_OF_ALLOCATION) == 0 &&
        (fault_now(FAULT_OF_ALLOCATION), fault_count(FAULT_OF_ALLOCATION) == 0))
        test_skip("failures on demand are only in builds with GRAY_FAULTS");
    put("scene.lua", scene);
    put("shapes.lua", module);
    put("mesh.obj", mesh);
    put("numbers.txt", "3\n");
    CHECK_EQ_INT(shell("cp \"$OLDPWD\"/textures/$(ls \"$OLDPWD\"/textures | grep png | head -n 1) image.png"), 0);
    /* The old pictures have the bytes that a run without failures makes: they are kept or replaced by equal ones. */
    CHECK_EQ_INT(shell("GRAY_FAULT_COUNT=$PWD/counts $gray -j 2 -write-pre-aa p- --checkpoint c.tiles "
                       "--checkpoint-every 0 scene.lua"),
                 0);
    CHECK_EQ_INT(shell("mkdir whole && cp sub/a.png sub/p-a.png b.pfm whole"), 0);
    char *text = content("counts", NULL);
    CHECK(text && sscanf(text, "%llu %llu", &a, &b) == 2);
    free(text);
    counts[0] = a;
    counts[1] = b;
    CHECK(a > 300 && b > 30);
}

/* One run with one failure. */
static void survive(const char *variable, uint64_t number) {
    char line[1024];
    (void)snprintf(line, sizeof line,
                   "rm -rf sub b.pfm p-b.pfm c.tiles; mkdir sub; printf 'PF\\n1 old' >sub/a.png; "
                   "%s=%llu timeout 60 $gray -j 2 -write-pre-aa p- --checkpoint c.tiles --checkpoint-every 0 scene.lua "
                   ">out.txt 2>err.txt",
                   variable, (unsigned long long)number);
    int status = shell(line);
    size_t size = 0;
    char *said = content("err.txt", &size), *picture = content("sub/a.png", NULL);
    bool known = status == 0 || status == 1 || status == 3;
    bool reported = status == 0 || (said && size > 10 && strncmp(said, "  ", 2) != 0);
    /* The leak checker does not work in a confined process that cannot read /proc. */
    bool blind = said && strstr(said, "LeakSanitizer has encountered a fatal error");
    bool clean = !said || blind || (!strstr(said, "Sanitizer") && !strstr(said, "runtime error"));
    bool old = picture && strcmp(picture, "PF\n1 old") == 0;
    bool whole = shell("cmp -s sub/a.png whole/a.png") == 0;
    bool second = shell("test ! -e b.pfm || cmp -s b.pfm whole/b.pfm") == 0;
    bool all = status != 0 || (whole && shell("test -e b.pfm") == 0);
    bool tidy = shell("ls -A . sub | grep -q 'part-'") != 0;
    if (!known || !reported || !clean || !(old || whole) || !second || !all || !tidy)
        test_fail(__FILE__, __LINE__, "%s=%llu: status %d%s%s%s%s%s; standard error:\n%s", variable,
                  (unsigned long long)number, status, reported ? "" : ", no line", clean ? "" : ", a report",
                  (old || whole) && second ? "" : ", a harmed picture", all ? "" : ", a missing picture",
                  tidy ? "" : ", something left behind", said ? said : "");
    free(said);
    free(picture);
}

TEST(faults_any_call_to_the_system_may_fail_in_a_whole_run) {
    uint64_t counts[2];
    prepare(counts);
    for (uint64_t number = 1; number <= counts[1]; number++)
        survive("GRAY_FAIL_CALL", number);
}

TEST(faults_some_allocations_fail_in_a_whole_run) {
    uint64_t counts[2];
    prepare(counts);
    for (uint64_t number = 1; number <= counts[0]; number += 97)
        survive("GRAY_FAIL_ALLOC", number);
}

TEST_LONG(faults_any_allocation_may_fail_in_a_whole_run) {
    uint64_t counts[2];
    prepare(counts);
    for (uint64_t number = 1; number <= counts[0]; number++)
        survive("GRAY_FAIL_ALLOC", number);
}

/* The same for other uses of the program, with a smaller scene: `line` runs with the variable set; each file that it
 * makes (`names`) has the bytes of a run without failures or is absent. */
static void survive_line(const char *variable, uint64_t step, const char *line, const char *names) {
    static const char kind_of[] = "GRAY_FAIL_CALL";
    char text[2048];
    unsigned long long counts[2] = {0, 0};
    (void)snprintf(text, sizeof text,
                   "rm -rf whole; mkdir whole; GRAY_FAULT_COUNT=$PWD/counts $gray %s >whole/out.txt && mv %s whole",
                   line, names);
    CHECK_EQ_INT(shell(text), 0);
    char *reported = content("counts", NULL);
    CHECK(reported && sscanf(reported, "%llu %llu", &counts[0], &counts[1]) == 2);
    free(reported);
    uint64_t last = counts[strcmp(variable, kind_of) == 0];
    CHECK(last > 5);
    for (uint64_t number = 1; number <= last; number += step) {
        size_t size = 0;
        (void)snprintf(text, sizeof text, "rm -f %s; %s=%llu timeout 60 $gray %s >out.txt 2>err.txt", names, variable,
                       (unsigned long long)number, line);
        int status = shell(text);
        char *said = content("err.txt", &size);
        bool known = status == 0 || status == 1 || status == 3, sound = status == 0 || size > 10;
        bool blind = said && strstr(said, "LeakSanitizer has encountered a fatal error");
        bool clean = !said || blind || (!strstr(said, "Sanitizer") && !strstr(said, "runtime error"));
        (void)snprintf(text, sizeof text,
                       "for f in %s; do test ! -e $f || cmp -s $f whole/$f || exit 1; done; ! ls -A | grep -q 'part-'",
                       names);
        bool whole = shell(text) == 0;
        (void)snprintf(text, sizeof text, "for f in %s; do test -e $f || exit 1; done", names);
        bool all = status != 0 || shell(text) == 0;
        if (!known || !sound || !clean || !whole || !all)
            test_fail(__FILE__, __LINE__, "%s=%llu gray %s: status %d%s%s%s; standard error:\n%s", variable,
                      (unsigned long long)number, line, status, clean ? "" : ", a report",
                      whole ? "" : ", a harmed file", all ? "" : ", a missing file", said ? said : "");
        free(said);
    }
}

static const char small_scene[] =
    "local red, root = gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20), gr.node('root')\n"
    "root:add_child(gr.sphere{name = 'ball', material = red})\n"
    "gr.render{node = root, file = 'a.png', width = 40, height = 34, eye = {0, 0, 6}, fov = 40, ambient = {0.2, 0.2, "
    "0.2}, lights = {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})}}\n";

TEST(faults_some_allocations_fail_while_a_scene_is_written_as_gltf) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    put("scene.lua", small_scene);
    survive_line("GRAY_FAIL_ALLOC", 29, "-q -j 1 --force -o a.glb scene.lua", "a.glb");
}

TEST(faults_any_call_may_fail_while_parts_are_made_and_merged) {
    static const char call[] = "GRAY_FAIL_CALL", allocation[] = "GRAY_FAIL_ALLOC";
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    put("scene.lua", small_scene);
    survive_line(call, 1, "-q -j 1 --shard 1/2 scene.lua", "a.png.1-of-2.part");
    CHECK_EQ_INT(shell("$gray -q --shard 1/2 scene.lua; $gray -q --shard 2/2 scene.lua"), 0);
    survive_line(call, 1, "merge a.png.1-of-2.part a.png.2-of-2.part", "a.png");
    survive_line(allocation, 3, "merge a.png.1-of-2.part a.png.2-of-2.part", "a.png");
}

TEST(faults_any_call_may_fail_while_layers_are_written) {
    static const char call[] = "GRAY_FAIL_CALL";
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    put("scene.lua", small_scene);
    survive_line(call, 3, "-q -j 1 --aov depth,normal --overlay boxes -write-aa-targets t- --deep scene.lua",
                 "a.png a.depth.png a.normal.png t-a.png");
    survive_line(call, 3, "-q -j 1 --aov depth -o a.hdr scene.lua", "a.hdr a.depth.hdr");
}
