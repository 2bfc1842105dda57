/* Races: the folder changes just before any one system call (the program is stopped there with ptrace), or as fast as
 * another process can change it; the program is killed before any call. Files outside the folder must never be harmed,
 * and no special file opened. */
#define _GNU_SOURCE
#include "base/file_output.h"
#include "tests/attack_files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/fs.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/inotify.h>
#include <sys/ptrace.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* A scene, and the action of another process at one moment. */
struct race {
    const char *name;
    const char *before, *scene, *options;
    const char
        *change; /* "FROM TO; ...": renames in the working directory; "parts": links in place of temporary files */
    const char *stays; /* a file that must exist afterwards, under any name; or NULL */
};

static char root[512], in[700];
/* If names cannot be exchanged, a file that appears just before a rename is lost. */
static bool may_lose;

static void fresh_folder(const struct race *race, uid_t user) {
    static int number;
    char path[2000], line[4096];
    (void)snprintf(root, sizeof root, "%s/%d", test_folder(), ++number);
    (void)snprintf(in, sizeof in, "%s/in", root);
    (void)snprintf(path, sizeof path, "%s/out", root);
    (void)umask(022);
    CHECK(mkdir(root, 0755) == 0 && mkdir(in, 0755) == 0 && mkdir(path, 0755) == 0);
    CHECK(attack_prepare(in, "png ../out/canary.png; text ../out/canary.txt; fifo ../out/canary.fifo; dir ../out/e"));
    CHECK(attack_prepare(in, race->before));
    (void)snprintf(path, sizeof path, "%s/scene.lua", in);
    (void)snprintf(line, sizeof line, "%s %s\n", attack_prelude, race->scene);
    test_write_text(path, line);
    struct attack_tree tree = attack_tree(root);
    for (size_t i = 0; user && getuid() == 0 && i < tree.count; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", root, tree.entries[i].path);
        CHECK(lchown(path, user, user) == 0);
    }
    attack_tree_free(&tree);
}

static void link_parts(void) {
    DIR *stream = opendir(in);
    char path[1400];
    for (struct dirent *entry; stream && (entry = readdir(stream)) != NULL;) {
        if (strncmp(entry->d_name, ".gray.part-", 11) != 0)
            continue;
        (void)snprintf(path, sizeof path, "%s/%s", in, entry->d_name);
        (void)unlink(path);
        (void)symlink("../out/canary.txt", path);
    }
    if (stream)
        (void)closedir(stream);
}

/* flags: of renameat2. */
static void change(const struct race *race, unsigned flags) {
    char *copy = strdup(race->change), *rest = NULL;
    if (strcmp(copy, "parts") == 0)
        link_parts();
    for (char *one = strtok_r(copy, ";", &rest); one; one = strtok_r(NULL, ";", &rest)) {
        char from[1400], to[1400], a[200], b[200];
        if (sscanf(one, "%199s %199s", a, b) != 2)
            continue;
        (void)snprintf(from, sizeof from, "%s/%s", in, a);
        (void)snprintf(to, sizeof to, "%s/%s", in, b);
        (void)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, flags);
    }
    free(copy);
}

static bool is_about_names(unsigned long long number) {
    switch (number) {
#ifdef SYS_open
    case SYS_open:
    case SYS_rename:
    case SYS_link:
    case SYS_unlink:
    case SYS_mkdir:
    case SYS_stat:
    case SYS_lstat:
    case SYS_readlink:
    case SYS_access:
#endif
    case SYS_openat:
    case SYS_openat2:
    case SYS_renameat:
    case SYS_renameat2:
    case SYS_linkat:
    case SYS_unlinkat:
    case SYS_mkdirat:
    case SYS_newfstatat:
    case SYS_statx:
    case SYS_readlinkat:
    case SYS_faccessat:
    case SYS_faccessat2:
        return true;
    default:
        return false;
    }
}

static bool starts_process(unsigned long long number) {
    return number == SYS_clone || number == SYS_clone3
#ifdef SYS_fork
           || number == SYS_fork || number == SYS_vfork
#endif
        ;
}

/* The next stop of a traced program; false: it has ended. */
static bool next_stop(pid_t program, int *how) {
    double limit = attack_now() + ATTACK_PATIENCE;
    for (int i = 0;; i++) {
        pid_t found = waitpid(program, how, WNOHANG);
        if (found == program)
            return WIFSTOPPED(*how);
        if (found < 0)
            return false;
        if (attack_now() > limit) { /* it waits inside a call */
            (void)kill(program, SIGKILL);
            limit += ATTACK_PATIENCE;
        }
        if (i > 200)
            attack_rest(0.0002);
    }
}

struct ending {
    int status; /* 128 + signal */
    long calls; /* the number of calls with names */
    bool acted;
};

/* Runs the program; just before its call number `moment` with a name, counted from the start of its render process, the
 * race changes the folder (or kills the program if race->change is NULL). */
static struct ending run_traced(const struct race *race, long moment, uid_t user) {
    struct ending ending = {0};
    char words[1024];
    (void)snprintf(words, sizeof words, "-j 1 %s scene.lua", race->options ? race->options : "");
    pid_t program = attack_start_traced(in, words, user);
    bool counting = false;
    int how = 0;
    while (next_stop(program, &how)) {
        int signal = WSTOPSIG(how);
        if (signal == (SIGTRAP | 0x80)) {
            struct __ptrace_syscall_info info;
            signal = 0;
            if (ptrace(PTRACE_GET_SYSCALL_INFO, program, sizeof info, &info) > 0 &&
                info.op == PTRACE_SYSCALL_INFO_ENTRY) {
                counting = counting || starts_process(info.entry.nr);
                if (counting && is_about_names(info.entry.nr) && ++ending.calls == moment) {
                    ending.acted = true;
                    if (race->change)
                        change(race, 0);
                    else
                        (void)kill(program, SIGKILL);
                }
            }
        } else if (signal == SIGTRAP || signal == SIGSTOP) {
            signal = 0;
        }
        (void)ptrace(PTRACE_SYSCALL, program, NULL, signal);
    }
    ending.status = WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
    return ending;
}

static int leftovers(void) {
    DIR *stream = opendir(in);
    int count = 0;
    for (struct dirent *entry; stream && (entry = readdir(stream)) != NULL;)
        count += strncmp(entry->d_name, ".gray.part-", 11) == 0;
    if (stream)
        (void)closedir(stream);
    return count;
}

static bool is_there(const struct attack_tree *tree, const struct attack_entry *file) {
    for (size_t i = 0; i < tree->count; i++) {
        const struct attack_entry *entry = &tree->entries[i];
        if (entry->status.st_ino == file->status.st_ino && entry->size == file->size &&
            memcmp(entry->bytes, file->bytes, file->size) == 0)
            return true;
    }
    return false;
}

/* A forbidden change; NULL: none. */
static const char *harm(const struct race *race, const struct attack_tree *old, const struct attack_tree *new) {
    char path[300];
    for (size_t i = 0; i < new->count; i++) {
        const struct attack_entry *is = &new->entries[i], *was = attack_find(old, is->path);
        if (strncmp(is->path, "out/", 4) == 0 && (!was || attack_difference(was, is)))
            return "changes what is outside";
    }
    for (size_t i = 0; i < old->count; i++) {
        const struct attack_entry *was = &old->entries[i];
        if (strncmp(was->path, "out/", 4) == 0 && !attack_find(new, was->path))
            return "removes what is outside";
    }
    (void)snprintf(path, sizeof path, "in/%s", race->stays ? race->stays : "");
    const struct attack_entry *stays = race->stays ? attack_find(old, path) : NULL;
    return stays && !is_there(new, stays) ? "loses a file that is no picture" : NULL;
}

/* The FIFOs of a race: the test reads and watches them. */
struct fifo_pair {
    int readers[2], watcher;
};

static struct fifo_pair open_fifos(void) {
    static const char *const names[2] = {"../out/canary.fifo", "fifo"};
    struct fifo_pair fifos = {.watcher = inotify_init1(IN_NONBLOCK | IN_CLOEXEC)};
    char path[1024];
    for (int i = 0; i < 2; i++) {
        (void)snprintf(path, sizeof path, "%s/%s", in, names[i]);
        fifos.readers[i] = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        (void)inotify_add_watch(fifos.watcher, path, IN_OPEN | IN_MODIFY | IN_DELETE_SELF);
    }
    return fifos;
}

static const char *close_fifos(struct fifo_pair *fifos) {
    char bytes[512] __attribute__((aligned(8)));
    const char *harmed = NULL;
    for (int i = 0; i < 2; i++) {
        if (fifos->readers[i] >= 0 && read(fifos->readers[i], bytes, sizeof bytes) > 0)
            harmed = "writes into a FIFO";
        if (fifos->readers[i] >= 0)
            (void)close(fifos->readers[i]);
    }
    ssize_t size = read(fifos->watcher, bytes, sizeof bytes);
    for (ssize_t at = 0; !harmed && at < size;) {
        const struct inotify_event *event = (const struct inotify_event *)(const void *)(bytes + at);
        at += (ssize_t)(sizeof *event + event->len);
        if (event->mask & (IN_OPEN | IN_MODIFY))
            harmed = "opens a FIFO";
        else if ((event->mask & IN_DELETE_SELF) && !may_lose)
            harmed = "removes a FIFO";
    }
    (void)close(fifos->watcher);
    return harmed;
}

/* The moments of a race from `moment` on, every `stride`-th one. The first failure of a race ends it. */
static void run_race(const struct race *race, uid_t user, long moment, long stride) {
    char *reason = NULL;
    /* The user's rights make little difference, so every third of them is enough. */
    if (user && getuid() == 0)
        stride *= 3;
    for (bool acted = true; !reason && acted && moment < 400; moment += stride) {
        fresh_folder(race, user);
        struct attack_tree old = attack_tree(root);
        struct fifo_pair fifos = open_fifos();
        struct ending ending = run_traced(race, moment, user);
        struct attack_tree new = attack_tree(root);
        const char *opened = close_fifos(&fifos), *harmed = harm(race, &old, &new);
        const char *wrong = ending.status > 3                                       ? "does not end as it should"
                            : harmed                                                ? harmed
                            : opened                                                ? opened
                            : leftovers() > 0 && strcmp(race->change, "parts") != 0 ? "leaves a temporary file"
                                                                                    : NULL;
        char *said = attack_output("err.txt");
        if (wrong &&
            asprintf(&reason, "before call %ld: %s (status %d): %.200s", moment, wrong, ending.status, said) < 0)
            exit(1);
        acted = ending.acted;
        free(said);
        attack_tree_free(&old);
        attack_tree_free(&new);
    }
    attack_report(race->name, user, reason);
    free(reason);
}

/* Every fourth moment, each race from another one on; all of them in make test-long. */
static void run_races(const struct race *races, size_t count, bool all) {
    for (size_t i = 0; i < count; i++) {
        long first = all ? 1 : 1 + (long)i % 4, stride = all ? 1 : 4;
        if (getuid() == 0)
            run_race(&races[i], 0, first, stride);
        if (attack_user() && (getuid() != 0 || i % 2))
            run_race(&races[i], attack_user(), first, stride);
    }
}
#define RACES(races) run_races(races, sizeof(races) / sizeof *(races), times > 1)

TEST_TIMES(hostile_no_moment_lets_a_picture_out_by_its_own_name, 3) {
    static const struct race races[] = {
        {"a link to a picture appears", "link l ../out/canary.png", "p'x.png'", NULL, "l x.png", NULL},
        {"a picture becomes a link to text", "png x.png; link l ../out/canary.txt", "p'x.png'", NULL, "l x.png", NULL},
        {"a picture becomes a link to a free name", "png x.png; link l ../out/new.png", "p'x.png'", NULL, "l x.png",
         NULL},
        {"a picture becomes a second name of one outside", "png x.png; hard l ../out/canary.png", "p'x.png'", NULL,
         "l x.png", NULL},
        {"a picture becomes a link to another, by -o", "png x.png; link l ../out/canary.png", "p'y.png'", "-o x.png",
         "l x.png", NULL},
    };
    RACES(races);
}

TEST_TIMES(hostile_no_moment_lets_a_file_beside_a_picture_out_by_its_name, 3) {
    static const struct race races[] = {
        {"a link appears in a layer's place", "link l ../out/canary.png", "p'x.png'", "--aov depth", "l x.depth.png",
         NULL},
        {"a link appears in a part's place", "link l ../out/canary.txt", "p'x.png'", "--shard 1/2",
         "l x.png.1-of-2.part", NULL},
        {"a link appears in the checkpoint's place", "link l ../out/canary.txt", "p('x.png', 80, 80)",
         "--checkpoint auto --checkpoint-every 0", "l x.png.checkpoint", NULL},
        {"the folder of a checkpoint becomes a link", "dir d; link l ../out; text ../out/x.png.checkpoint",
         "p('d/x.png', 80, 80)", "--checkpoint auto --checkpoint-every 0", "d was; l d", NULL},
    };
    RACES(races);
}

TEST_TIMES(hostile_no_moment_loses_a_file_that_is_no_picture, 3) {
    static const struct race races[] = {
        {"text appears", "text note", "p'x.png'", NULL, "note x.png", "note"},
        {"a picture becomes text", "png x.png; text note", "p'x.png'", NULL, "note x.png", "note"},
        {"a picture becomes text, by -o", "png x.png; text note", "p'y.png'", "-o x.png", "note x.png", "note"},
        {"text appears in a part's place", "text note", "p'x.png'", "--shard 1/2", "note x.png.1-of-2.part", "note"},
        {"text appears in the checkpoint's place", "text note", "p('x.png', 80, 80)",
         "--checkpoint auto --checkpoint-every 0", "note x.png.checkpoint", "note"},
        {"temporary files become links", "png x.png", "p'x.png'", NULL, "parts", NULL},
    };
    RACES(races);
}

TEST_TIMES(hostile_no_moment_lets_a_picture_into_a_special_file, 3) {
    static const struct race races[] = {
        {"a FIFO appears", "fifo fifo", "p'x.png'", NULL, "fifo x.png", NULL},
        {"a picture becomes a FIFO", "png x.png; fifo fifo", "p'x.png'", NULL, "fifo x.png", NULL},
        {"a link to a FIFO appears", "link l ../out/canary.fifo", "p'x.pfm'", NULL, "l x.pfm", NULL},
        {"a picture becomes a link to a FIFO", "pfm x.pfm; link l ../out/canary.fifo", "p'x.pfm'", NULL, "l x.pfm",
         NULL},
    };
    RACES(races);
}

TEST_TIMES(hostile_no_moment_lets_a_file_beside_a_picture_into_a_special_file, 3) {
    static const struct race races[] = {
        {"a FIFO appears in a layer's place", "fifo fifo", "p'x.png'", "--aov depth", "fifo x.depth.png", NULL},
        {"a FIFO appears in the first pass's place", "fifo fifo", "p'x.png'", "-write-pre-aa A", "fifo Ax.png", NULL},
        {"a FIFO appears in a part's place", "fifo fifo", "p'x.png'", "--shard 1/2", "fifo x.png.1-of-2.part", NULL},
        {"a FIFO appears while tiles are kept", "fifo fifo", "p('x.png', 80, 80)",
         "--checkpoint auto --checkpoint-every 0", "fifo x.png", NULL},
        {"a FIFO appears in the checkpoint's place", "fifo fifo", "p('x.png', 80, 80)",
         "--checkpoint auto --checkpoint-every 0", "fifo x.png.checkpoint", NULL},
    };
    RACES(races);
}

TEST_TIMES(hostile_no_moment_lets_a_picture_out_by_its_folders, 3) {
    static const struct race races[] = {
        {"its folder becomes a link", "dir d; link l ../out", "p'd/x.png'", NULL, "d was; l d", NULL},
        {"the folder above becomes a link", "dir d; dir d/e; link l ../out", "p'd/e/x.png'", NULL, "d was; l d", NULL},
        {"a link appears where its folder is made", "link l ../out", "p'd/x.png'", NULL, "d was; l d", NULL},
        {"a link appears where the folder above is made", "link l ../out", "p'd/e/x.png'", NULL, "d was; l d", NULL},
        {"a link to nothing appears where its folder is made", "link l ../out/new", "p'd/x.png'", NULL, "d was; l d",
         NULL},
        {"its folder becomes a link, and the picture is there", "dir d; png d/canary.png; link l ../out",
         "p'd/canary.png'", NULL, "d was; l d", NULL},
    };
    RACES(races);
}

TEST_TIMES(hostile_no_moment_lets_a_file_beside_a_picture_out_by_its_folders, 3) {
    static const struct race races[] = {
        {"its folder becomes one with a FIFO", "dir d; dir f; fifo fifo; hard f/x.png fifo", "p'd/x.png'", NULL,
         "d was; f d", NULL},
        {"the folder of a part becomes a link", "dir d; link l ../out", "p'd/x.png'", "--shard 1/2", "d was; l d",
         NULL},
        {"the folder of layers becomes a link", "dir d; link l ../out", "p'd/x.png'", "--aov depth", "d was; l d",
         NULL},
    };
    RACES(races);
}

/* Repeated changes, as fast as a process can make them. */
TEST_TIMES(hostile_folders_that_change_all_the_time_let_no_picture_out, 3) {
    static const struct race races[] = {
        {"a picture, a link and a FIFO change places",
         "png a; link b ../out/canary.txt; fifo fifo; link c ../out/canary.fifo",
         "for i = 1, 60 do pcall(p, 'x.png') end", NULL,
         "a x.png; x.png a; b x.png; x.png b; fifo x.png; x.png fifo; c x.png; x.png c", NULL},
        {"a folder and a link change places", "dir a; link b ../out", "for i = 1, 60 do pcall(p, 'd/x.png') end", NULL,
         "a d; d a; b d; d b", NULL},
        {"checkpoints, links and FIFOs change places", "link b ../out/canary.txt; fifo fifo",
         "for i = 1, 20 do pcall(p, 'x.png', 70, 70) end", "--checkpoint auto --checkpoint-every 0",
         "b x.png.checkpoint; x.png.checkpoint b; fifo x.png.checkpoint; x.png.checkpoint fifo", NULL},
    };
    for (size_t i = 0; i < sizeof races / sizeof *races; i++) {
        const struct race *race = &races[i];
        uid_t user = i % 2 ? 0 : attack_user();
        fresh_folder(race, user);
        char words[256], *reason = NULL;
        struct attack_tree old = attack_tree(root);
        struct fifo_pair fifos = open_fifos();
        fflush(stdout);
        pid_t thrower = fork();
        if (thrower == 0) {
            for (double limit = attack_now() + ATTACK_PATIENCE; attack_now() < limit;)
                change(race, RENAME_NOREPLACE); /* never over a file that gray has restored: such a loss would look like
                                                a fault of gray */
            _exit(0);
        }
        (void)snprintf(words, sizeof words, "-q -j 1 %s scene.lua", race->options ? race->options : "");
        int status = 0;
        for (double limit = attack_now() + 0.9 * times; status >= 0 && status <= 3 && attack_now() < limit;)
            status = attack_wait(attack_start(in, words, user), ATTACK_PATIENCE);
        (void)kill(thrower, SIGKILL);
        (void)waitpid(thrower, NULL, 0);
        struct attack_tree new = attack_tree(root);
        const char *opened = close_fifos(&fifos), *harmed = harm(race, &old, &new);
        const char *wrong = status < 0 || status > 3 ? "does not end as it should" : harmed ? harmed : opened;
        if (wrong && asprintf(&reason, "%s (status %d)", wrong, status) < 0)
            exit(1);
        attack_report(race->name, user, reason);
        free(reason);
        attack_tree_free(&old);
        attack_tree_free(&new);
    }
}

/* The next run in the folder, two minutes later. */
static void check_later(uid_t user) {
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        struct file_guard guard = {0};
        const struct file_rules rules = {.guard = &guard, .role = FILE_ROLE_PICTURE};
        const struct file_target target = {.path = "x.png", .rules = &rules};
        struct error error;
        if ((user && getuid() == 0 && (setgid(user) != 0 || setuid(user) != 0)) || chdir(in) != 0)
            _exit(126);
        attack_set_clock(120);
        _exit(file_output_check(&target, &error) ? 0 : 1);
    }
    CHECK_EQ_INT(attack_wait(child, ATTACK_PATIENCE), 0);
}

static void kill_before_any_call(int times) {
    static const struct race kills[] = {
        {"a kill while a picture is replaced", "png x.png", "p'x.png'", NULL, NULL, NULL},
        {"a kill while a picture is made", "", "p'x.png'", NULL, NULL, NULL},
        {"a kill while tiles are kept", "", "p('x.png', 90, 90)", "--checkpoint auto --checkpoint-every 0", NULL, NULL},
    };
    for (size_t i = 0; i < sizeof kills / sizeof *kills; i++) {
        const struct race *race = &kills[i];
        char *reason = NULL;
        int left = 0;
        bool killed = true;
        for (long moment = times > 1 ? 1 : 1 + (long)i; killed && !reason && moment < 400; moment += 4 - times) {
            uid_t user = moment % 2 ? attack_user() : 0;
            fresh_folder(race, user);
            struct ending ending = run_traced(race, moment, user);
            killed = ending.acted;
            left += leftovers();
            check_later(user);
            struct attack_tree tree = attack_tree(root);
            const struct attack_entry *picture = attack_find(&tree, "in/x.png");
            const char *wrong = ending.status != (killed ? 137 : 0)                          ? "another end"
                                : leftovers() > 0                                            ? "a file for ever"
                                : picture && !attack_begins(picture, "\x89PNG\r\n\x1a\n", 8) ? "a broken picture"
                                : !picture && race->before[0]                                ? "no picture"
                                                                                             : NULL;
            if (wrong && asprintf(&reason, "a kill before call %ld leaves %s", moment, wrong) < 0)
                exit(1);
            attack_tree_free(&tree);
        }
        printf("    %s: %d kills left a file\n", race->name, left);
        attack_report(race->name, attack_user(), reason);
        free(reason);
    }
}

TEST_TIMES(hostile_a_kill_before_any_call_leaves_nothing_that_the_next_run_does_not_remove, 3) {
    kill_before_any_call(times);
}

TEST_TIMES(hostile_a_kill_on_a_file_system_without_nameless_files_leaves_nothing_for_ever, 3) {
    attack_set_system(ATTACK_SYSTEM_WITHOUT_TMPFILE);
    kill_before_any_call(times);
}

TEST_TIMES(hostile_a_kill_on_a_file_system_that_cannot_exchange_leaves_nothing_for_ever, 3) {
    attack_set_system(ATTACK_SYSTEM_WITHOUT_EXCHANGE);
    kill_before_any_call(times);
}

static void run_races_on(enum attack_system system, int times) {
    static const struct race races[] = {
        {"a FIFO appears", "fifo fifo", "p'x.png'", NULL, "fifo x.png", NULL},
        {"a picture becomes a link to a FIFO", "pfm x.pfm; link l ../out/canary.fifo", "p'x.pfm'", NULL, "l x.pfm",
         NULL},
        {"a link appears where its folder is made", "link l ../out", "p'd/x.png'", NULL, "d was; l d", NULL},
        {"its folder becomes a link, and the picture is there", "dir d; png d/canary.png; link l ../out",
         "p'd/canary.png'", NULL, "d was; l d", NULL},
    };
    attack_set_system(system);
    may_lose = system >= ATTACK_SYSTEM_WITHOUT_EXCHANGE;
    RACES(races);
}

TEST_TIMES(hostile_no_moment_lets_a_picture_out_without_nameless_files, 3) {
    run_races_on(ATTACK_SYSTEM_WITHOUT_TMPFILE, times);
}

TEST_TIMES(hostile_no_moment_lets_a_picture_out_without_exchange, 3) {
    run_races_on(ATTACK_SYSTEM_WITHOUT_EXCHANGE, times);
}

TEST_TIMES(hostile_no_moment_lets_a_picture_out_without_second_names, 3) {
    run_races_on(ATTACK_SYSTEM_WITHOUT_LINKS, times);
}

TEST_TIMES(hostile_several_runs_that_write_one_picture_leave_it_whole, 3) {
    static const struct race race = {"several runs", "png x.png", "for i = 1, 40 do p('x.png', 20 + i, 20) end",
                                     NULL,           NULL,        NULL};
    for (int round = 0; round < 4 * times; round++) {
        int system = round % 4;
        pid_t programs[4];
        char name[64], *reason = NULL;
        attack_set_system((enum attack_system)system);
        fresh_folder(&race, 0);
        for (int i = 0; i < 4; i++)
            programs[i] = attack_start(in, "-q -j 1 scene.lua", 0);
        int worst = 0;
        for (int i = 0; i < 4; i++) {
            int status = attack_wait(programs[i], ATTACK_PATIENCE);
            worst = status < 0 || status > worst ? status : worst;
        }
        struct attack_tree tree = attack_tree(root);
        const struct attack_entry *picture = attack_find(&tree, "in/x.png");
        const char *wrong = picture ? attack_wrong_picture(picture) : "is gone";
        char *said = attack_output("err.txt");
        if ((worst != 0 || wrong || (leftovers() > 0 && system < ATTACK_SYSTEM_WITHOUT_EXCHANGE)) &&
            asprintf(&reason, "status %d, %d temporary files, the picture %s: %.200s", worst, leftovers(),
                     wrong ? wrong : "is well", said) < 0)
            exit(1);
        (void)snprintf(name, sizeof name, "several runs that write one picture, system %d", system);
        attack_report(name, 0, reason);
        attack_tree_free(&tree);
        free(said);
        free(reason);
    }
}
