/* Pipes, FIFOs and terminals without a reader: whatever the program waits for, a signal ends it with status 130. */
#define _GNU_SOURCE
#include "tests/attack.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *in;

/* Without a separate render process (--no-fork, for debuggers) the signal itself may end the program. */
static const char *end_of(pid_t program, int signal, bool single) {
    (void)kill(program, signal);
    int status = attack_wait(program, ATTACK_PATIENCE);
    return status == 130 || (single && status == 128 + signal) ? NULL
           : status < 0                                        ? "it does not end at the signal"
                                                               : "it does not end with 130";
}

/* The program must still run after a while, and end at the signal. */
static void interrupt(const char *name, const char *words, int signal, uid_t user) {
    pid_t program = attack_start(in, words, user);
    for (int i = 0; i < 8; i++) {
        int how;
        attack_rest(0.1);
        if (waitpid(program, &how, WNOHANG) == program) {
            char *said = attack_output("err.txt");
            printf("    %s\n", said);
            free(said);
            attack_report(name, user, "it ended before the signal");
            return;
        }
    }
    attack_report(name, user, end_of(program, signal, strstr(words, "--no-fork") != NULL));
}

TEST(hostile_opening_a_fifo_without_a_reader_ends_at_a_signal) {
    in = attack_folder("fifo f; link l f", "p'x.png'");
    interrupt("a FIFO without a reader, SIGINT", "-j 1 -o f scene.lua", SIGINT, 0);
    interrupt("a FIFO without a reader, SIGTERM", "-j 1 -o f scene.lua", SIGTERM, 0);
    interrupt("a FIFO without a reader, SIGHUP", "-j 1 -o f scene.lua", SIGHUP, 0);
    interrupt("a link to a FIFO without a reader", "-j 1 -o l scene.lua", SIGINT, 0);
    interrupt("a FIFO without a reader, without a process of its own", "--no-fork -j 1 -o f scene.lua", SIGINT, 0);
    in = attack_folder("fifo f2", "p'x.png' p'y.png'");
    interrupt("a FIFO without a reader for the second picture", "-j 1 -o f%d scene.lua", SIGINT, 0);
    if (attack_user()) {
        in = attack_folder("fifo f; mode f 666", "p'x.png'");
        interrupt("a FIFO without a reader, SIGTERM", "-j 1 -o f scene.lua", SIGTERM, attack_user());
    }
}

TEST(hostile_writing_to_a_reader_that_stopped_ends_at_a_signal) {
    static const struct {
        const char *name, *words;
        int signal;
    } attempts[] = {
        {"a FIFO whose reader stopped, SIGINT", "-j 1 -o f.pfm scene.lua", SIGINT},
        {"a FIFO whose reader stopped, SIGTERM", "-j 1 -o f.pfm scene.lua", SIGTERM},
        {"a FIFO whose reader stopped, without a process of its own", "--no-fork -j 1 -o f.pfm scene.lua", SIGINT},
        {"a FIFO whose reader stopped, with threads", "-j 3 -o f.pfm scene.lua", SIGTERM},
        {"a terminal whose reader stopped", "-j 1 -o t.pfm scene.lua", SIGINT},
    };
    for (size_t i = 0; i < sizeof attempts / sizeof *attempts; i++) {
        char path[1024];
        in = attack_folder("fifo f.pfm; tty t.pfm", "p('x.pfm', 200, 200)");
        (void)snprintf(path, sizeof path, "%s/f.pfm", in);
        int reader = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        CHECK(reader >= 0);
        interrupt(attempts[i].name, attempts[i].words, attempts[i].signal, 0);
        (void)close(reader);
    }
}

/* A pipe is full if nothing has been added to it for a while. */
static bool is_full(int pipe, pid_t program) {
    int before = -1, now = 0, how;
    for (;;) {
        attack_rest(0.4);
        if (waitpid(program, &how, WNOHANG) == program)
            return false;
        if (ioctl(pipe, FIONREAD, &now) != 0)
            return false;
        if (now == before && now > 0)
            return true;
        before = now;
    }
}

/* One of the program's standard streams is a pipe of this test, which nobody reads. */
static void interrupt_stream(const char *name, const char *scene, const char *options, int stream) {
    static int tried;
    int ends[2], signal = tried++ % 2 ? SIGTERM : SIGINT;
    char line[512];
    in = attack_folder("", scene);
    CHECK(pipe2(ends, O_CLOEXEC) == 0);
    (void)snprintf(line, sizeof line, "exec '%s' -j 1 %s scene.lua", attack_binary(), options);
    fflush(stdout);
    pid_t program = fork();
    if (program == 0) {
        (void)setpgid(0, 0);
        int null = open("/dev/null", O_RDWR);
        for (int to = 0; to < 3; to++)
            (void)dup2(to == stream ? ends[1] : null, to);
        if (chdir(in) == 0)
            (void)execl("/bin/sh", "sh", "-c", line, (char *)NULL);
        _exit(127);
    }
    (void)close(ends[1]);
    bool full = is_full(ends[0], program), single = strstr(options, "--no-fork") != NULL;
    attack_report(name, 0, full ? end_of(program, signal, single) : "it ended, or never filled the pipe");
    (void)close(ends[0]);
}

TEST(hostile_pictures_on_a_standard_output_that_nobody_reads_end_at_a_signal) {
    interrupt_stream("a picture on standard output", "p('x.png', 1500, 1500)", "-o - --deep -ss 1", 1);
    interrupt_stream("a picture on standard output, without a process of its own", "p('x.png', 1500, 1500)",
                     "--no-fork -o - --deep -ss 1", 1);
    interrupt_stream("a picture on a pipe by its name", "p('x.png', 1500, 1500)", "-o /dev/stdout --deep -ss 1", 1);
}

TEST(hostile_text_on_standard_streams_that_nobody_reads_ends_at_a_signal) {
    interrupt_stream("what a script prints", "while true do print(string.rep('x', 1000)) end", "", 1);
    interrupt_stream("what a script writes", "while true do io.write(string.rep('x', 1000), '\\n') end", "", 1);
    interrupt_stream("what a script writes as errors",
                     "while true do io.stderr:write(string.rep('x', 1000), '\\n') end", "", 2);
    interrupt_stream("what a script prints under -o -", "while true do print(string.rep('x', 1000)) end p'x.png'",
                     "-o -", 2);
    interrupt_stream("statistics", "while true do p'x.png' end", "--stats=json --script-time 1000", 1);
    interrupt_stream("progress", "while true do p'x.png' end", "--progress=json --script-time 1000", 2);
    interrupt_stream("lines of --verbose", "while true do p'x.png' end",
                     "--verbose --progress=lines --script-time 1000", 2);
    interrupt_stream("the traces of pixels", "while true do p'x.png' end", "--pixel 1,1 --script-time 1000", 1);
}
