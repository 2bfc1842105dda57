/* See attack.h. A row compares the folders before and after the run: every change that the row does not name is a
 * failure. */
#define _GNU_SOURCE
#include "tests/attack_files.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/inotify.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { ORDINARY_USER = 65534 };

static time_t clock_offset;

/* Replaces the C library's function: the change time of a file cannot be set, so the clock of the test runs ahead. */
int clock_gettime(clockid_t clock, struct timespec *time) {
    long result = syscall(SYS_clock_gettime, clock, time);
    if (result == 0 && clock == CLOCK_REALTIME)
        time->tv_sec += clock_offset;
    return (int)result;
}

void attack_set_clock(time_t seconds) {
    clock_offset = seconds;
}

double attack_now(void) {
    return test_clock();
}

void attack_rest(double seconds) {
    struct timespec pause = {(time_t)seconds, (long)((seconds - (double)(time_t)seconds) * 1e9)};
    (void)nanosleep(&pause, NULL);
}

const char *attack_binary(void) {
    return test_program();
}

static enum attack_system attack_system;

static bool limit_system(void) {
#define DATA(member) (uint32_t) offsetof(struct seccomp_data, member)
#define REFUSE(number) BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | (number))
    /* The low halves of arguments on little-endian machines. */
    struct sock_filter without_tmpfile[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, DATA(nr)),
                                            BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_openat, 0, 3),
                                            BPF_STMT(BPF_LD | BPF_W | BPF_ABS, DATA(args[2])),
                                            BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, O_TMPFILE & ~O_DIRECTORY, 0, 1),
                                            REFUSE(EOPNOTSUPP),
                                            BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
    struct sock_filter without_exchange[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, DATA(nr)),
                                             BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_renameat2, 0, 3),
                                             BPF_STMT(BPF_LD | BPF_W | BPF_ABS, DATA(args[4])),
                                             BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 1, 0),
                                             REFUSE(EINVAL),
                                             BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
    struct sock_filter without_links[] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, DATA(nr)),
                                          BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_linkat, 0, 1), REFUSE(EPERM),
                                          BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW)};
#undef DATA
#undef REFUSE
    const struct sock_fprog programs[] = {
        {sizeof without_tmpfile / sizeof *without_tmpfile, without_tmpfile},
        {sizeof without_exchange / sizeof *without_exchange, without_exchange},
        {sizeof without_links / sizeof *without_links, without_links},
    };
    bool ok = attack_system == ATTACK_SYSTEM_WHOLE || prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0;
    for (int i = 0; ok && i < (int)attack_system; i++)
        ok = syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &programs[i]) == 0;
    return ok;
}

void attack_set_system(enum attack_system system) {
    attack_system = system;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0)
        _exit(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ && limit_system() ? 0 : 1);
    int how = 1;
    (void)waitpid(child, &how, 0);
    if (how != 0)
        test_skip("system calls cannot be made to fail here");
}

static void become(uid_t user) {
    if (user && (setgroups(0, NULL) != 0 || setgid(user) != 0 || setuid(user) != 0))
        _exit(126);
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (!limit_system())
        _exit(125);
}

/* Lets other users pass through the folders of the tests, which belong to the runner. */
static void open_folders(void) {
    char path[4096];
    struct stat status;
    (void)snprintf(path, sizeof path, "%s", test_folder());
    (void)chmod(path, 0755);
    for (char *slash; (slash = strrchr(path, '/')) != NULL && slash != path;) {
        *slash = '\0';
        if (stat(path, &status) == 0 && status.st_uid == getuid() && (status.st_mode & 07777) == 0700)
            (void)chmod(path, 0711);
    }
}

uid_t attack_user(void) {
    static uid_t user = UINT32_MAX;
    if (user != UINT32_MAX)
        return user;
    if (getuid() != 0)
        return user = getuid();
    open_folders();
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        become(ORDINARY_USER);
        _exit(access(attack_binary(), X_OK) == 0 && access(test_folder(), X_OK) == 0 ? 0 : 1);
    }
    int how = 1;
    (void)waitpid(child, &how, 0);
    return user = how == 0 ? ORDINARY_USER : 0;
}

/* One run of the program. */
struct program_run {
    int status; /* -1: it had to be killed */
    char *out, *err;
};

static char *bytes_of_descriptor(int descriptor) {
    off_t size = lseek(descriptor, 0, SEEK_END);
    char *text = calloc(1, (size_t)(size > 0 ? size : 0) + 1);
    if (text && size > 0 && pread(descriptor, text, (size_t)size, 0) != size)
        text[0] = '\0';
    (void)close(descriptor);
    return text;
}

static void execute(const struct attack *attack) {
    char *words[128] = {(char *)(uintptr_t)attack_binary(), (char *)(uintptr_t) "-j", (char *)(uintptr_t) "1"};
    int count = 3;
    if (attack->shell) {
        char *line = NULL;
        if (asprintf(&line, "gray='%s -j 1'; %s", attack_binary(), attack->shell) < 0)
            _exit(127);
        (void)execl("/bin/sh", "sh", "-c", line, (char *)NULL);
        _exit(127);
    }
    if (attack->flags & ATTACK_NO_RAY)
        words[count++] = (char *)(uintptr_t) "--progress=json";
    char *copy = strdup(attack->options ? attack->options : ""), *rest = NULL;
    bool named = false;
    for (char *word = strtok_r(copy, " ", &rest); word && count < 126; word = strtok_r(NULL, " ", &rest)) {
        words[count++] = word;
        named = named || strcmp(word, "scene.lua") == 0;
    }
    if (!named)
        words[count++] = (char *)(uintptr_t)(attack->scene_name ? attack->scene_name : "scene.lua");
    (void)execv(words[0], words);
    _exit(127);
}

/* 128 + signal; -1: it had to be killed. */
static int wait_up_to(pid_t program, double seconds) {
    int how = 0;
    double limit = attack_now() + seconds;
    while (waitpid(program, &how, WNOHANG) == 0) {
        if (attack_now() > limit) {
            (void)kill(-program, SIGKILL);
            (void)kill(program, SIGKILL);
            (void)waitpid(program, &how, 0);
            return -1;
        }
        attack_rest(0.001);
    }
    (void)kill(-program, SIGKILL);
    return WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
}

static struct program_run run_attack(struct attack_setup *setup) {
    int out = memfd_create("out", 0), err = memfd_create("err", 0);
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        (void)setpgid(0, 0);
        (void)dup2(out, 1);
        (void)dup2(err, 2);
        int null = open("/dev/null", O_RDONLY);
        (void)dup2(null, 0);
        for (int i = 3; i < 64; i++)
            (void)close(i);
        if (chdir(setup->in) != 0)
            _exit(126);
        become(getuid() == 0 ? setup->user : 0);
        if (setup->attack->inside)
            _exit(setup->attack->inside());
        execute(setup->attack);
    }
    (void)setpgid(child, child);
    struct program_run run = {.status = wait_up_to(child, ATTACK_PATIENCE)};
    run.out = bytes_of_descriptor(out);
    run.err = bytes_of_descriptor(err);
    return run;
}

/* The checks. The first reason of a row that fails is reported. */
static void blame(struct attack_setup *setup, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void blame(struct attack_setup *setup, const char *format, ...) {
    va_list arguments;
    if (setup->failures++ > 0)
        return;
    va_start(arguments, format);
    (void)vsnprintf(setup->reason, sizeof setup->reason, format, arguments);
    va_end(arguments);
    for (char *at = setup->reason; *at; at++) {
        if ((unsigned char)*at < ' ')
            *at = *at == '\n' ? '/' : '?';
    }
}

void attack_report(const char *name, uid_t user, const char *reason) {
    const char *log = getenv("GRAY_TEST_ATTACKS"), *who = user == 0 && getuid() == 0 ? "root" : "user";
    FILE *file = log ? fopen(log, "a") : NULL;
    if (reason)
        test_fail(__FILE__, __LINE__, "attack \"%s\" as %s: %s", name, who, reason);
    if (file) {
        (void)fprintf(file, "%s\t%s\t%s\t%.*s\n", reason ? "FAILED" : "ok", who, name,
                      (int)strcspn(reason ? reason : "", "\n"), reason ? reason : "");
        (void)fclose(file);
    }
}

static const char *line_of_interest(const struct program_run *run) {
    const char *line = run->err;
    while (run->status != 0 && *line) {
        size_t length = strcspn(line, "\n");
        char *copy = strndup(line, length);
        bool skip = length == 0 || line[0] == '{' || strstr(copy, "notice:") || strstr(copy, "warning:");
        free(copy);
        if (!skip)
            break;
        line += length + (line[length] == '\n');
    }
    return line;
}

static void check_words(struct attack_setup *setup, const struct program_run *run) {
    const char *line = line_of_interest(run);
    char *first = strndup(line, strcspn(line, "\n"));
    char *copy = strdup(setup->attack->says ? setup->attack->says : ""), *rest = NULL;
    for (char *part = strtok_r(copy, "|", &rest); part; part = strtok_r(NULL, "|", &rest)) {
        bool anywhere = part[0] == '*', nowhere = part[0] == '!';
        const char *text = part + (anywhere || nowhere);
        bool in_both = strstr(run->err, text) || strstr(run->out, text);
        if (nowhere ? in_both : anywhere ? !in_both : !strstr(first, text))
            blame(setup, "%s \"%s\" in: %.300s", nowhere ? "there is" : "no", text, anywhere ? run->err : first);
    }
    int notices = 0;
    for (const char *at = run->err; (at = strstr(at, "notice:")) != NULL; at++)
        notices++;
    int wanted = setup->attack->notices;
    if (wanted != 0 && notices != (wanted < 0 ? 0 : wanted))
        blame(setup, "%d notices: %.300s", notices, run->err);
    if ((setup->attack->flags & ATTACK_NO_RAY) && strstr(run->err, "\"event\":\"render\""))
        blame(setup, "a picture was rendered: %.300s", run->err);
    free(copy);
    free(first);
}

static void check_status(struct attack_setup *setup, const struct program_run *run) {
    int wanted = setup->attack->status;
    if (run->status < 0)
        blame(setup, "does not end within %d s", ATTACK_PATIENCE);
    else if (run->status >= 126 && run->status != 130)
        blame(setup, "ends with %d: %.300s", run->status, run->err);
    else if (wanted == ATTACK_WRONG ? run->status < 1 || run->status > 3
                                    : wanted != ATTACK_ANY && run->status != wanted)
        blame(setup, "ends with %d: %.300s", run->status, run->err);
}

static void expected(struct attack_setup *setup, const struct attack_tree *old, const struct attack_tree *new,
                     char *text) {
    char path[1200], *rest = NULL, *verb = strtok_r(text, " ", &rest), *name = strtok_r(NULL, " ", &rest);
    if (!verb || !name) {
        blame(setup, "no statement: %s", text);
        return;
    }
    (void)attack_decode(name);
    bool outside = strncmp(name, "../", 3) == 0;
    (void)snprintf(path, sizeof path, "%s%s", outside ? "" : "in/", name + (outside ? 3 : 0));
    struct attack_entry *was = attack_find(old, path), *is = attack_find(new, path);
    if (was)
        was->may_differ = true;
    if (is)
        is->may_differ = true;
    bool changed = is && (!was || was->status.st_ino != is->status.st_ino || attack_difference(was, is));
    const char *wrong = NULL;
    if (strcmp(verb, "opened") == 0) {
        wrong = !is ? "is gone" : was ? attack_difference(was, is) : NULL;
    } else if (strcmp(verb, "gone") == 0) {
        wrong = is ? "is there" : NULL;
    } else if (strcmp(verb, "maybe") == 0) {
        wrong = changed ? attack_wrong_picture(is) : was && !is ? "is gone" : NULL;
    } else if (strcmp(verb, "maybepart") == 0) {
        wrong = changed && !attack_begins(is, "GRAYTILE", 8) ? "is not a file of tiles" : NULL;
    } else if (strcmp(verb, "maybedir") == 0) {
        wrong = is && !S_ISDIR(is->status.st_mode) ? "is no folder" : NULL;
    } else if (!is) {
        wrong = "is not there";
    } else if (strcmp(verb, "picture") == 0) {
        wrong = changed ? attack_wrong_picture(is) : "was not written";
    } else if (strcmp(verb, "part") == 0) {
        wrong = changed && attack_begins(is, "GRAYTILE", 8) && !(is->status.st_mode & 07111) ? NULL
                                                                                             : "is not a file of tiles";
    } else if (strcmp(verb, "dir") == 0) {
        wrong = S_ISDIR(is->status.st_mode) ? NULL : "is no folder";
    } else if (strcmp(verb, "file") == 0) {
        wrong = S_ISREG(is->status.st_mode) ? NULL : "is no regular file";
    } else {
        wrong = "is in no statement";
    }
    if (wrong)
        blame(setup, "%s %s", path, wrong);
}

static void check_files(struct attack_setup *setup, struct attack_tree *old) {
    struct attack_tree new = attack_tree(setup->root);
    char *copy = strdup(setup->attack->after ? setup->attack->after : ""), *rest = NULL;
    for (char *one = strtok_r(copy, ";", &rest); one; one = strtok_r(NULL, ";", &rest)) {
        if (one[strspn(one, " ")] != '\0')
            expected(setup, old, &new, one);
    }
    for (size_t i = 0; i < old->count; i++) {
        const struct attack_entry *was = &old->entries[i], *is = attack_find(&new, was->path);
        const char *how = was->may_differ ? NULL : is ? attack_difference(was, is) : "is gone";
        if (how)
            blame(setup, "%s %s", was->path, how);
    }
    for (size_t i = 0; i < new.count; i++) {
        if (!new.entries[i].may_differ && !attack_find(old, new.entries[i].path))
            blame(setup, "%s is new", new.entries[i].path);
    }
    free(copy);
    attack_tree_free(&new);
}

/* Special files are watched with inotify, because opening and closing leaves no other trace. */
static void watch_special(struct attack_setup *setup, struct attack_tree *tree, int watcher) {
    for (size_t i = 0; i < tree->count; i++) {
        struct attack_entry *entry = &tree->entries[i];
        char path[2400];
        (void)snprintf(path, sizeof path, "%s/%s", setup->root, entry->path);
        bool terminal = S_ISLNK(entry->status.st_mode) && strncmp(entry->bytes, "/dev/pts/", 9) == 0;
        if (terminal ||
            !(S_ISREG(entry->status.st_mode) || S_ISDIR(entry->status.st_mode) || S_ISLNK(entry->status.st_mode)))
            entry->watch = inotify_add_watch(watcher, path, IN_OPEN | IN_MODIFY);
    }
}

static void check_special(struct attack_setup *setup, const struct attack_tree *tree, int watcher) {
    char events[8192] __attribute__((aligned(8)));
    ssize_t size = read(watcher, events, sizeof events);
    for (ssize_t at = 0; at < size;) {
        const struct inotify_event *event = (const struct inotify_event *)(const void *)(events + at);
        at += (ssize_t)(sizeof *event + event->len);
        for (size_t i = 0; i < tree->count; i++) {
            if (tree->entries[i].watch == event->wd && !tree->entries[i].may_differ) {
                blame(setup, "%s was %s", tree->entries[i].path, event->mask & IN_MODIFY ? "written to" : "opened");
                return;
            }
        }
    }
}

static void check_streams(struct attack_setup *setup) {
    char bytes[256];
    for (int i = 0; i < setup->reader_count; i++) {
        if (read(setup->readers[i], bytes, sizeof bytes) > 0)
            blame(setup, "a FIFO received bytes");
        (void)close(setup->readers[i]);
    }
    for (int i = 0; i < setup->terminal_count; i++) {
        if (read(setup->terminals[i], bytes, sizeof bytes) > 0)
            blame(setup, "a terminal received bytes");
        (void)close(setup->terminals[i]);
    }
}

static bool prepare(struct attack_setup *setup) {
    static const char outside[] = "png ../out/canary.png; text ../out/canary.txt; fifo ../out/canary.fifo";
    const struct attack *attack = setup->attack;
    char path[2048];
    (void)snprintf(path, sizeof path, "%s/out", setup->root);
    if (mkdir(setup->root, 0755) != 0 || mkdir(setup->in, 0755) != 0 || mkdir(path, 0755) != 0)
        return false;
    (void)snprintf(path, sizeof path, "%s/%s", setup->in, attack->scene_name ? attack->scene_name : "scene.lua");
    if (!attack_statements(setup, setup->in, outside, false) ||
        (attack->scene && !attack_put_scene(path, attack->scene)) ||
        !attack_statements(setup, setup->in, attack->before, false))
        return false;
    if (setup->user && getuid() == 0) {
        struct attack_tree all = attack_tree(setup->root);
        bool ok = true;
        for (size_t i = 0; i < all.count; i++) {
            (void)snprintf(path, sizeof path, "%s/%s", setup->root, all.entries[i].path);
            ok = ok && lchown(path, setup->user, setup->user) == 0;
        }
        attack_tree_free(&all);
        if (!ok)
            return false;
    }
    return attack_statements(setup, setup->in, attack->before, true);
}

/* True if the claim holds. */
static bool run_as(const struct attack *attack, uid_t user) {
    static int number;
    struct attack_setup setup = {.attack = attack, .user = user};
    (void)snprintf(setup.root, sizeof setup.root, "%s/%d", test_folder(), ++number);
    (void)snprintf(setup.in, sizeof setup.in, "%s/in", setup.root);
    if (!prepare(&setup)) {
        blame(&setup, "could not be prepared");
        attack_report(attack->name, user, setup.failures ? setup.reason : NULL);
        return false;
    }
    struct attack_tree old = attack_tree(setup.root);
    int watcher = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    watch_special(&setup, &old, watcher);
    struct program_run run = run_attack(&setup);
    check_status(&setup, &run);
    check_words(&setup, &run);
    check_files(&setup, &old);
    check_special(&setup, &old, watcher);
    check_streams(&setup);
    attack_report(attack->name, user, setup.failures ? setup.reason : NULL);
    (void)close(watcher);
    attack_tree_free(&old);
    free(run.out);
    free(run.err);
    return setup.failures == 0;
}

void attacks_run(const struct attack *rows, size_t count) {
    const uid_t user = attack_user();
    (void)attack_binary(); /* its name may be relative to the current folder */
    (void)umask(022);
    for (size_t i = 0; i < count; i++) {
        const struct attack *row = &rows[i];
        if (getuid() != 0) {
            if (row->flags & (ATTACK_BY_ROOT | ATTACK_AS_ROOT))
                printf("    ATTACK %s: not tried, only root can prepare it\n", row->name);
            else
                (void)run_as(row, user);
            continue;
        }
        bool held = (row->flags & ATTACK_AS_USER) || run_as(row, 0);
        if (user && held && !(row->flags & ATTACK_AS_ROOT))
            (void)run_as(row, user);
    }
}

static pid_t start(const char *in, const char *words, uid_t user, bool traced) {
    char out[1024], err[1024];
    (void)snprintf(out, sizeof out, "%s/out.txt", test_folder());
    (void)snprintf(err, sizeof err, "%s/err.txt", test_folder());
    (void)attack_binary();
    fflush(stdout);
    pid_t child = fork();
    if (child != 0) {
        (void)setpgid(child, child);
        return child;
    }
    (void)setpgid(0, 0);
    int to = open(out, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    (void)dup2(to, 1);
    to = open(err, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    (void)dup2(to, 2);
    to = open("/dev/null", O_RDONLY | O_CLOEXEC);
    (void)dup2(to, 0);
    char *all[64] = {(char *)(uintptr_t)attack_binary()}, *rest = NULL, *copy = strdup(words);
    int count = 1;
    for (char *word = strtok_r(copy, " ", &rest); word && count < 63; word = strtok_r(NULL, " ", &rest))
        all[count++] = word;
    if (chdir(in) != 0)
        _exit(126);
    become(getuid() == 0 ? user : 0);
    if (traced) {
        const char *options = getenv("ASAN_OPTIONS");
        char *more = NULL;
        if (asprintf(&more, "%s%sdetect_leaks=0", options ? options : "", options ? ":" : "") > 0)
            (void)setenv("ASAN_OPTIONS", more, 1); /* the leak checker does not work under ptrace */
        if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) != 0 || raise(SIGSTOP) != 0)
            _exit(125);
    }
    (void)execv(all[0], all);
    _exit(127);
}

pid_t attack_start(const char *in, const char *words, uid_t user) {
    return start(in, words, user, false);
}

pid_t attack_start_traced(const char *in, const char *words, uid_t user) {
    int how = 0;
    pid_t program = start(in, words, user, true);
    if (waitpid(program, &how, 0) != program || !WIFSTOPPED(how) ||
        ptrace(PTRACE_SETOPTIONS, program, NULL, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL) != 0)
        test_skip("processes cannot be traced here");
    (void)ptrace(PTRACE_SYSCALL, program, NULL, NULL);
    return program;
}

int attack_wait(pid_t program, double seconds) {
    return wait_up_to(program, seconds);
}

char *attack_output(const char *name) {
    char *text = test_read_file(test_path(name), NULL);
    return text ? text : calloc(1, 1);
}
