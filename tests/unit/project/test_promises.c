/* Claims of docs/security.md and docs/lab/reliability.md that no other test would refute; the table "Promises and
 * attacks" in docs/lab/reliability.md names all of them. */
#define _GNU_SOURCE
#include "tests/attack_files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

static const char *in;

/* Runs a scene in a fresh folder as root (or whoever runs the tests) and as a user; the first line of standard error
 * begins like this. */
static void expect(const char *files, const char *scene, const char *words, int status, const char *says) {
    uid_t users[2] = {0, getuid() == 0 ? attack_user() : 0};
    for (int i = 0; i < (users[1] ? 2 : 1); i++) {
        in = attack_folder(files, scene);
        int how = attack_wait(attack_start(in, words, users[i]), ATTACK_PATIENCE);
        char *said = attack_output("err.txt");
        if (how != status || strncmp(said, says, strlen(says)) != 0)
            test_fail(__FILE__, __LINE__, "%s as %d: %d, %.300s", scene, (int)users[i], how, said);
        free(said);
    }
}

/* The render process of a program. */
static pid_t wait_for_child(pid_t program) {
    pid_t child = 0;
    for (double limit = attack_now() + ATTACK_PATIENCE; child <= 0 && attack_now() < limit; attack_rest(0.01))
        child = test_child_of(program);
    CHECK(child > 0);
    return child;
}

/* --- limits --- */

TEST(rendering_is_not_counted_as_time_of_the_script) {
    in = attack_folder("", "p('x.png', 80, 80) p('y.png', 80, 80)");
    double before = test_children_used().seconds;
    CHECK_EQ_INT(attack_wait(attack_start(in, "-q -j 1 -full -ss 16 --script-time 0.2 scene.lua", 0), ATTACK_PATIENCE),
                 0);
    CHECK(test_children_used().seconds - before > 0.3); /* otherwise it is not displayed */
    expect("", "p('x.png', 9, 9) while true do end", "-q --script-time 0.2 scene.lua", 1, "scene.lua:");
}

TEST(a_limit_that_ends_a_script_leaves_its_finished_pictures) {
    static const char *const ends[] = {
        "while true do pcall(function() while true do end end) end",
        "local t = {} while true do pcall(function() for i = 1, 1e9 do t[#t + 1] = {} end end) end",
        "while true do pcall(print, string.rep('x', 1000)) end",
    };
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        char *scene = NULL, path[1024];
        CHECK(asprintf(&scene, "p('x.png', 9, 9) p('y.pfm', 9, 9) %s", ends[i]) > 0);
        expect("", scene, "-q --script-time 0.2 --script-memory 64 --script-output 1 scene.lua", 1, "scene.lua");
        static const char *const names[] = {"x.png", "y.pfm"};
        for (int k = 0; k < 2; k++) {
            (void)snprintf(path, sizeof path, "%s/%s", in, names[k]);
            CHECK(access(path, R_OK) == 0);
        }
        struct attack_tree tree = attack_tree(test_folder());
        for (size_t k = 0; k < tree.count; k++) {
            const char *dot = strrchr(tree.entries[k].path, '.');
            if (dot && (strcmp(dot, ".png") == 0 || strcmp(dot, ".pfm") == 0))
                CHECK(attack_wrong_picture(&tree.entries[k]) == NULL);
        }
        attack_tree_free(&tree);
        free(scene);
    }
}

TEST(scripts_print_64_mebibytes_at_most_and_without_a_sandbox_all) {
    if (test_has_sanitizer())
        test_skip("134 MiB are checked byte by byte, which takes minutes in this build");
    static const char *const scene = "local s = string.rep('x', 2^20) for i = 1, 70 do io.write(s) end";
    struct test_result result = test_gray_scene(scene, "-q scene.lua", NULL);
    CHECK(result.status == 1 && strlen(result.out) <= 64 << 20 && strlen(result.out) > 60 << 20);
    test_free_result(&result);
    result = test_gray_scene(scene, "-q --no-sandbox scene.lua", NULL);
    CHECK(result.status == 0 && strlen(result.out) == 70 << 20);
    test_free_result(&result);
}

/* --- what a scene may read --- */

TEST(hidden_files_beside_and_above_a_scene_cannot_be_read) {
    static const char *const scene =
        "local function opens(n) local f = io.open(n) if f then f:close() end return f ~= nil end\n"
        "assert(opens'seen.lua' and opens'../seen.lua' and opens'd/seen.lua')\n"
        "for _, n in ipairs{'.hid.lua', './.hid.lua', 'd/.hid.lua', '.h/in.lua', '../.hid.lua', '../.h/in.lua',\n"
        "  'd/../.h/in.lua', 'link.lua', 'folder/in.lua'} do\n"
        "  assert(not opens(n) and not pcall(dofile, n) and not loadfile(n) and not pcall(require, n), n)\n"
        "  assert(not pcall(io.lines, n) and not pcall(gr.mesh, {file = n}) and not pcall(t, n), n)\n"
        "end\n";
    static const char *const files =
        "dir d; dir .h; dir ../.h; text seen.lua; text .hid.lua; text d/seen.lua; text d/.hid.lua; text .h/in.lua; "
        "text ../seen.lua; text ../.hid.lua; text ../.h/in.lua; link link.lua .hid.lua; link folder .h";
    in = attack_folder(files, scene);
    int status = attack_wait(attack_start(in, "-q scene.lua", 0), ATTACK_PATIENCE);
    char *said = attack_output("err.txt");
    if (status != 0)
        test_fail(__FILE__, __LINE__, "%d: %s", status, said);
    free(said);
    /* A hidden folder that the command line names is reached. */
    test_write_text(test_path("other.lua"), "assert(io.open('1/.h/in.lua')):close()");
    status = attack_wait(attack_start(test_folder(), "-q --allow-read 1/.h other.lua", 0), ATTACK_PATIENCE);
    CHECK_EQ_INT(status, 0);
}

TEST(the_root_is_no_folder_of_a_scene) {
    char words[1024];
    in = attack_folder("", "assert(io.open('etc/passwd') == nil and "
                           "io.open('/etc/passwd') == nil and io.open('../etc/passwd') == nil)");
    (void)snprintf(words, sizeof words, "-q %s/scene.lua", in);
    CHECK_EQ_INT(attack_wait(attack_start("/", words, 0), ATTACK_PATIENCE), 0);
    (void)snprintf(words, sizeof words, "-q --allow-read / %s/scene.lua", in);
    CHECK_EQ_INT(attack_wait(attack_start("/", words, 0), ATTACK_PATIENCE), 1);
}

TEST(only_regular_files_are_read_and_nothing_waits) {
    static const char *const scene =
        "for _, base in ipairs{'pipe', 'sock', 'null', 'full', 'to_pipe'} do\n"
        "  for _, ending in ipairs{'', '.lua', '.obj', '.png', '.hdr', '.mtl'} do\n"
        "    local n = base .. ending\n"
        "    for _, mode in ipairs{'r', 'rb', 'r+', 'a+'} do assert(io.open(n, mode) == nil, n) end\n"
        "    for _, f in ipairs{io.lines, io.input, dofile, require, t, gr.texture, gr.bump} do\n"
        "      assert(not pcall(f, n), n)\n"
        "    end\n"
        "    assert(not loadfile(n) and not pcall(gr.mesh, {file = n}), n)\n"
        "    assert(not pcall(gr.glyphs, {font = n, text = 'a'}), n)\n"
        "  end\n"
        "end\n"
        "pcall(gr.mesh, {file = 'own.obj'})\n";
    char *files = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&files, &size);
    static const char *const endings[] = {"", ".lua", ".obj", ".png", ".hdr", ".mtl"};
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        (void)fprintf(stream, "fifo pipe%s; socket sock%s; link to_pipe%s pipe%s; ", endings[i], endings[i], endings[i],
                      endings[i]);
        if (getuid() == 0)
            (void)fprintf(stream, "null null%s; full full%s; ", endings[i], endings[i]);
    }
    (void)fprintf(stream, "bytes own.obj mtllib%%20pipe.mtl%%0av%%200%%200%%200%%0a");
    CHECK(fclose(stream) == 0);
    expect(files, scene, "-q scene.lua", 0, "");
    free(files);
}

/* A process exchanges a folder and a link that leads out as fast as it can. */
TEST(links_that_are_exchanged_all_the_time_lead_no_reader_out) {
    static const char *const scene = "local good, bad = 0, 0\n"
                                     "for i = 1, 4000 do\n"
                                     "  local f = io.open('d/x.lua')\n"
                                     "  local s = f and f:read('a') or ''\n"
                                     "  if f then f:close() end\n"
                                     "  if s:find('inner') then good = good + 1 elseif s ~= '' then bad = bad + 1 end\n"
                                     "  local g = loadfile('d/x.lua')\n"
                                     "  if g and g() ~= 'inner' then bad = bad + 1 end\n"
                                     "end\n"
                                     "print(good, bad) assert(bad == 0)\n";
    uid_t users[2] = {0, getuid() == 0 ? attack_user() : 0};
    for (int i = 0; i < (users[1] ? 2 : 1); i++) {
        char path[1024], outer[1024], a[1024], b[1024], d[1024];
        in = attack_folder("dir a", scene);
        (void)snprintf(path, sizeof path, "%s/a/x.lua", in);
        test_write_text(path, "return 'inner'\n");
        (void)snprintf(outer, sizeof outer, "%s/outer", test_folder());
        CHECK(mkdir(outer, 0755) == 0 || errno == EEXIST);
        (void)snprintf(path, sizeof path, "%s/outer/.x", test_folder());
        CHECK(mkdir(path, 0755) == 0 || errno == EEXIST);
        (void)snprintf(path, sizeof path, "%s/outer/.x/x.lua", test_folder());
        test_write_text(path, "return 'secret'\n");
        (void)snprintf(a, sizeof a, "%s/a", in);
        (void)snprintf(b, sizeof b, "%s/b", in);
        (void)snprintf(d, sizeof d, "%s/d", in);
        CHECK(symlink("../outer/.x", b) == 0);
        (void)fflush(stdout);
        pid_t thrower = fork();
        if (thrower == 0) {
            for (double limit = attack_now() + ATTACK_PATIENCE; attack_now() < limit;) {
                (void)rename(a, d);
                (void)rename(d, a);
                (void)rename(b, d);
                (void)rename(d, b);
            }
            _exit(0);
        }
        int status = attack_wait(attack_start(in, "-q --transform-order new scene.lua", users[i]), ATTACK_PATIENCE);
        (void)kill(thrower, SIGKILL);
        (void)waitpid(thrower, NULL, 0);
        char *said = attack_output("err.txt"), *printed = attack_output("out.txt");
        attack_report("a folder that is read and a link change places", users[i], status == 0 ? NULL : said);
        printf("    found and misled: %s", printed);
        free(said);
        free(printed);
    }
}

TEST(scenes_can_read_only_variables_that_begin_as_the_program_s) {
    struct test_result result =
        test_gray_scene("assert(os.getenv('GRAY_OF_A_TEST') == 'seen')\n"
                        "for _, n in ipairs{'HOME', 'PATH', 'USER', 'PWD', 'OF_A_TEST', 'GRAY', 'gray_x', ''} do\n"
                        "  assert(os.getenv(n) == nil, n)\n"
                        "end\n",
                        "-q scene.lua", "GRAY_OF_A_TEST=seen");
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    test_free_result(&result);
}

TEST(what_a_script_prints_is_printed_as_it_is) {
    struct test_result result =
        test_gray_scene("io.write('a\\27[2J\\r\\8\\7\\127\\xff\\n') print('b')", "scene.lua", NULL);
    CHECK_TEXT(result.out, "a\33[2J\r\b\a\177\xff\nb\n");
    test_free_result(&result);
}

/* --- the processes --- */

static long number_in(const char *text, const char *key) {
    const char *found = text ? strstr(text, key) : NULL;
    return found ? strtol(found + strlen(key), NULL, 10) : -1;
}

TEST(a_rendering_process_keeps_nothing_it_inherited_and_gains_no_privileges) {
    char path[1100], name[300], to[1024];
    in = attack_folder("text inherited.txt; dir folder", "io.open('scene.lua') while true do end");
    (void)snprintf(path, sizeof path, "%s/inherited.txt", in);
    int file = open(path, O_RDWR), folder = open("/", O_RDONLY | O_DIRECTORY); // NOLINT: both are to be inherited
    CHECK(file >= 0 && folder >= 0);
    CHECK(dup2(file, 77) == 77 && dup2(folder, 200) == 200);
    pid_t program = attack_start(in, "-q scene.lua", 0), child = wait_for_child(program);
    for (int i = 0; i < 200 && child > 0; i++) { /* until it is confined */
        (void)snprintf(path, sizeof path, "/proc/%d/status", (int)child);
        char *text = test_read_file(path, NULL);
        bool ready =
            number_in(text, "\nNoNewPrivs:") == 1 && (test_has_sanitizer() || number_in(text, "\nSeccomp:") == 2);
        free(text);
        if (ready)
            break;
        attack_rest(0.05);
    }
    (void)snprintf(path, sizeof path, "/proc/%d/status", (int)child);
    char *text = test_read_file(path, NULL);
    CHECK_EQ_INT(number_in(text, "\nNoNewPrivs:"), 1);
    if (!test_has_sanitizer())
        CHECK_EQ_INT(number_in(text, "\nSeccomp:"), 2);
    free(text);
    (void)snprintf(path, sizeof path, "/proc/%d/fd", (int)child);
    DIR *stream = opendir(path);
    int count = 0;
    for (struct dirent *entry; stream && (entry = readdir(stream)) != NULL;) {
        (void)snprintf(name, sizeof name, "%d", atoi(entry->d_name));
        if (strcmp(name, entry->d_name) != 0)
            continue;
        (void)snprintf(path, sizeof path, "/proc/%d/fd/%s", (int)child, name);
        ssize_t length = readlink(path, to, sizeof to - 1);
        to[length > 0 ? length : 0] = '\0';
        count++;
        if (strcmp(to, "/") == 0 || strstr(to, "inherited.txt"))
            test_fail(__FILE__, __LINE__, "descriptor %s is %s", name, to);
    }
    CHECK(stream && count >= 3);
    if (stream)
        (void)closedir(stream);
    (void)kill(program, SIGINT);
    CHECK_EQ_INT(attack_wait(program, ATTACK_PATIENCE), 130);
}

TEST(a_build_with_sanitizers_says_that_it_has_no_filter) {
    if (!test_has_sanitizer())
        test_skip("a build without sanitizers");
    struct test_result result = test_gray_scene("x = 1", "--verbose scene.lua", NULL);
    CHECK(strstr(result.err, ", no seccomp filter in a build with sanitizers"));
    test_free_result(&result);
}

/* Appends the bytes that a terminal outputs in these seconds. */
static size_t read_terminal(int terminal, char *bytes, size_t size, size_t used, double seconds) {
    for (double limit = attack_now() + seconds; attack_now() < limit && used + 1 < size;) {
        ssize_t more = read(terminal, bytes + used, size - used - 1);
        if (more > 0)
            used += (size_t)more;
        else
            attack_rest(0.01);
    }
    bytes[used] = '\0';
    return used;
}

static int count_of(const char *text, const char *part) {
    int count = 0;
    for (const char *at = text; (at = strstr(at, part)) != NULL; at++)
        count++;
    return count;
}

TEST(a_crash_of_the_rendering_process_leaves_the_terminal_as_it_was) {
    if (test_has_sanitizer())
        test_skip("a sanitizer reports the crash on the terminal");
    static char bytes[1 << 18];
    in = attack_folder("", "p('x.png', 2500, 2500)");
    int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0)
        test_skip("no terminals here");
    int slave = open(ptsname(master), O_RDWR | O_NOCTTY | O_CLOEXEC);
    struct termios before, after;
    CHECK(slave >= 0 && tcgetattr(slave, &before) == 0);
    const char *binary = attack_binary();
    (void)fflush(stdout);
    pid_t program = fork();
    if (program == 0) {
        (void)setsid();
        int own = open(ptsname(master), O_RDWR); // NOLINT
        for (int i = 0; i < 3; i++)
            (void)dup2(own, i);
        if (chdir(in) == 0)
            (void)execl(binary, binary, "-j", "1", "-full", "-ss", "16", "scene.lua", (char *)NULL);
        _exit(127);
    }
    pid_t child = wait_for_child(program);
    size_t used = read_terminal(master, bytes, sizeof bytes, 0, 0.5);
    CHECK(child > 0 && kill(child, SIGSEGV) == 0);
    int status = -1;
    for (double limit = attack_now() + ATTACK_PATIENCE;
         status < 0 && attack_now() < limit;) { /* it may wait for its reader */
        used = read_terminal(master, bytes, sizeof bytes, used, 0.1);
        int how;
        if (waitpid(program, &how, WNOHANG) == program)
            status = WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
    }
    CHECK_EQ_INT(status, 3);
    if (status < 0)
        (void)kill(program, SIGKILL);
    used = read_terminal(master, bytes, sizeof bytes, used, 0.1);
    CHECK(tcgetattr(slave, &after) == 0 && before.c_iflag == after.c_iflag && before.c_oflag == after.c_oflag &&
          before.c_lflag == after.c_lflag && before.c_cflag == after.c_cflag);
    if (used == 0 || bytes[used - 1] != '\n' || !strstr(bytes, "crashed (signal 11"))
        test_fail(__FILE__, __LINE__, "%.300s", used > 300 ? bytes + used - 300 : bytes);
    CHECK_EQ_INT(count_of(bytes, "\33[?25l"), count_of(bytes, "\33[?25h")); /* the cursor */
    CHECK_EQ_INT(count_of(bytes, "\33[?1049h"), count_of(bytes, "\33[?1049l"));
    char path[1024];
    (void)snprintf(path, sizeof path, "%s/x.png", in);
    CHECK(access(path, F_OK) != 0);
    (void)close(slave);
    (void)close(master);
}

/* --- how a picture file gets its name --- */

/* Calls of the supervisor, in their order: L locks a file, S syncs a file, D syncs the folder, N gives a name. */
static void record_calls(char *calls, size_t size) {
    char path[1100], to[1024];
    size_t used = 0;
    int how = 0;
    pid_t program = attack_start_traced(in, "-q -j 1 scene.lua", 0);
    for (double limit = attack_now() + ATTACK_PATIENCE; attack_now() < limit;) {
        pid_t found = waitpid(program, &how, WNOHANG);
        if (found < 0 || (found == program && !WIFSTOPPED(how)))
            break;
        if (found == 0) {
            attack_rest(0.0002);
            continue;
        }
        int signal = WSTOPSIG(how);
        if (signal == (SIGTRAP | 0x80)) {
            struct __ptrace_syscall_info info;
            signal = 0;
            char call = 0;
            if (ptrace(PTRACE_GET_SYSCALL_INFO, program, sizeof info, &info) > 0 &&
                info.op == PTRACE_SYSCALL_INFO_ENTRY) {
                if (info.entry.nr == SYS_flock)
                    call = 'L';
                if (info.entry.nr == SYS_linkat || info.entry.nr == SYS_renameat2)
                    call = 'N';
                if (info.entry.nr == SYS_fsync) {
                    (void)snprintf(path, sizeof path, "/proc/%d/fd/%d", (int)program, (int)info.entry.args[0]);
                    ssize_t length = readlink(path, to, sizeof to - 1);
                    to[length > 0 ? length : 0] = '\0';
                    call = strcmp(to, in) == 0 ? 'D' : 'S';
                }
            }
            if (call && used + 1 < size)
                calls[used++] = call;
        } else if (signal == SIGTRAP || signal == SIGSTOP) {
            signal = 0;
        }
        (void)ptrace(PTRACE_SYSCALL, program, NULL, signal);
    }
    calls[used] = '\0';
    CHECK(WIFEXITED(how) && WEXITSTATUS(how) == 0);
}

TEST(a_picture_is_locked_and_synced_before_it_has_its_name_and_its_folder_after) {
    static const char *const states[] = {"", "png x.png"};
    for (int system = ATTACK_SYSTEM_WHOLE; system <= ATTACK_SYSTEM_WITHOUT_TMPFILE; system++) {
        attack_set_system((enum attack_system)system);
        for (int i = 0; i < 2; i++) {
            char calls[256];
            in = attack_folder(states[i], "p('x.png', 20, 20)");
            record_calls(calls, sizeof calls);
            const char *synced = strchr(calls, 'S'), *named = strchr(calls, 'N'), *last = strrchr(calls, 'N');
            if (!synced || !named || synced > named || !strchr(last, 'D') ||
                !memchr(calls, 'L', (size_t)(synced - calls)))
                test_fail(__FILE__, __LINE__, "system %d, %s: %s", system, states[i], calls);
        }
    }
}
