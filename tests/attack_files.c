/* See attack_files.h and the statements in attack.h. */
#define _GNU_SOURCE
#include "tests/attack_files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

const char attack_prelude[] =
    "local r = gr.node('root') r:add_child(gr.sphere(gr.material({.8, .3, .2}, {.5, .5, .5}, 20))) "
    "local l = gr.light({4, 5, 6}, {.9, .9, .9}, {1, 0, 0}) "
    "function p(name, w, h) gr.render(r, name, w or 4, h or 3, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {.2, .2, .2}, "
    "{l}) end "
    "function t(name) return gr.texture(name) end ";

/* 4 x 3 pixels. */
const uint8_t attack_png[95] = {137, 80,  78,  71,  13,  10,  26,  10,  0,   0,   0,   13,  73,  72,  68,  82,
                                0,   0,   0,   4,   0,   0,   0,   3,   8,   2,   0,   0,   0,   59,  150, 57,
                                145, 0,   0,   0,   38,  73,  68,  65,  84,  120, 218, 99,  136, 98,  136, 138,
                                210, 136, 138, 10,  136, 138, 170, 0,   50,  69,  162, 162, 108, 162, 162, 82,
                                162, 162, 122, 128, 28,  152, 112, 212, 130, 40,  0,   222, 167, 12,  49,  144,
                                194, 100, 192, 0,   0,   0,   0,   73,  69,  78,  68,  174, 66,  96,  130};
static const char poly_hdr[] = "#?RADIANCE\n", poly_pfm[] = "PF\n= 1 ";

/* %XX is a byte; the length counts zeros. */
size_t attack_decode(char *text) {
    char *to = text;
    for (const char *at = text; *at; at++) {
        unsigned byte;
        if (*at == '%' && sscanf(at + 1, "%2x", &byte) == 1) {
            *to++ = (char)byte;
            at += 2;
        } else {
            *to++ = *at;
        }
    }
    *to = '\0';
    return (size_t)(to - text);
}

static bool is_fail(const char *what, const char *path) {
    test_fail(__FILE__, __LINE__, "%s %s: %s", what, path, strerror(errno));
    return false;
}

static bool put(const char *path, const void *data, size_t size) {
    test_write_file(path, data, size);
    return true;
}

bool attack_put_scene(const char *path, const char *text) {
    const char *ending = strrchr(path, '.');
    char *whole = NULL;
    const char *head = ending && strcmp(ending, ".hdr") == 0   ? poly_hdr
                       : ending && strcmp(ending, ".pfm") == 0 ? poly_pfm
                                                               : "";
    if (asprintf(&whole, "%s%s%s\n", head, attack_prelude, text ? text : "") < 0)
        return false;
    test_write_text(path, whole);
    free(whole);
    return true;
}

/* Through the descriptor of its folder: an address has room for 108 bytes only. */
static bool make_socket(const char *path) {
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    int made = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const char *name = strrchr(path, '/') + 1;
    char *folder = strndup(path, (size_t)(name - path));
    int descriptor = open(folder, O_PATH | O_CLOEXEC);
    free(folder);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "/proc/self/fd/%d/%.60s", descriptor, name);
    bool ok = made >= 0 && bind(made, (const struct sockaddr *)&address, sizeof address) == 0 && listen(made, 1) == 0;
    (void)close(descriptor);
    return ok;
}

/* On a machine without pseudo-terminals (a bare chroot) a link to a FIFO stands in for a link to one. */
static bool make_terminal(struct attack_setup *setup, const char *path) {
    int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    char name[256], fifo[2400];
    if (master < 0 && (errno == ENOENT || errno == ENODEV || errno == ENXIO)) {
        (void)snprintf(fifo, sizeof fifo, "%s.fifo", path);
        return mkfifo(fifo, 0666) == 0 && symlink(strrchr(fifo, '/') + 1, path) == 0;
    }
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 || ptsname_r(master, name, sizeof name) != 0)
        return false;
    if (setup && setup->user && getuid() == 0 && chown(name, setup->user, setup->user) != 0)
        return false;
    if (setup && setup->terminal_count < MAX_STREAMS)
        setup->terminals[setup->terminal_count++] = master;
    return symlink(name, path) == 0;
}

static bool set_age(const char *path, double seconds) {
    struct timespec now, times[2];
    (void)clock_gettime(CLOCK_REALTIME, &now);
    now.tv_sec -= (time_t)seconds;
    times[0] = times[1] = now;
    return utimensat(AT_FDCWD, path, times, AT_SYMLINK_NOFOLLOW) == 0;
}

/* Statements that make files with contents; false: the statement is not one of them. */
static bool made_file(const char *verb, const char *path, const char *argument, size_t length, bool *ok) {
#define KIND(verb, bytes)                                                                                              \
    { verb, bytes, sizeof bytes - 1 }
    static const struct {
        const char *verb, *bytes;
        size_t size;
    } kinds[] = {
        {"png", (const char *)attack_png, sizeof attack_png},
        KIND("empty", ""),
        KIND("jpeg", "\xff\xd8\xff\xe0\0\x10JFIF"),
        KIND("hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x80\x80\x80\x80\x80"),
        KIND("pfm", "PF\n1 1\n-1.0\n\0\0\x80?\0\0\x80?\0\0\x80?"),
        KIND("exr", "\x76\x2f\x31\x01\2\0\0\0"),
        KIND("sh", "#!/bin/sh\necho harm\n"),
        KIND("text", "a letter to nobody\n"),
        KIND("poly", "#?RADIANCE\nreturn 1\n"),
        KIND("polyp", "PF\n= 1 return 1\n"),
    };
#undef KIND
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (strcmp(verb, kinds[i].verb) == 0) {
            *ok = put(path, kinds[i].bytes, kinds[i].size);
            return true;
        }
    }
    if (strcmp(verb, "bytes") != 0)
        return false;
    *ok = put(path, argument, length);
    return true;
}

static bool made_special(struct attack_setup *setup, const char *verb, const char *path, bool *ok) {
    if (strcmp(verb, "dir") == 0)
        *ok = mkdir(path, 0777) == 0;
    else if (strcmp(verb, "fifo") == 0)
        *ok = mkfifo(path, 0666) == 0;
    else if (strcmp(verb, "socket") == 0)
        *ok = make_socket(path);
    else if (strcmp(verb, "null") == 0)
        *ok = mknod(path, S_IFCHR | 0666, makedev(1, 3)) == 0;
    else if (strcmp(verb, "full") == 0)
        *ok = mknod(path, S_IFCHR | 0666, makedev(1, 7)) == 0;
    else if (strcmp(verb, "block") == 0)
        *ok = mknod(path, S_IFBLK | 0666, makedev(1, 250)) == 0;
    else if (strcmp(verb, "tty") == 0)
        *ok = make_terminal(setup, path);
    else if (strcmp(verb, "reader") == 0 && setup && setup->reader_count < MAX_STREAMS)
        *ok = (setup->readers[setup->reader_count++] = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC)) >= 0;
    else
        return false;
    return true;
}

/* chown comes after everything else that the user owns, so it has a pass of its own. */
static bool statement(struct attack_setup *setup, const char *in, char *text, bool late) {
    char path[2048], *rest = NULL, *verb = strtok_r(text, " ", &rest);
    char *name = strtok_r(NULL, " ", &rest), *argument = strtok_r(NULL, " ", &rest);
    bool ok = true;
    if (!verb || !name) {
        test_fail(__FILE__, __LINE__, "no statement: %s", text);
        return false;
    }
    if (late != (strcmp(verb, "owner") == 0 || strcmp(verb, "mode") == 0 || strcmp(verb, "age") == 0))
        return true;
    (void)attack_decode(name);
    size_t length = argument ? attack_decode(argument) : 0;
    (void)snprintf(path, sizeof path, "%s/%s", in, name);
    if (made_file(verb, path, argument ? argument : "", length, &ok) || made_special(setup, verb, path, &ok))
        return ok || is_fail(verb, path);
    if (strcmp(verb, "scene") == 0)
        return attack_put_scene(path, setup ? setup->attack->second : "");
    if (argument && strcmp(verb, "link") == 0)
        return symlink(argument, path) == 0 || is_fail(verb, path);
    if (argument && strcmp(verb, "hard") == 0) {
        char target[2048];
        (void)snprintf(target, sizeof target, "%s/%s", in, argument);
        return link(target, path) == 0 || is_fail(verb, path);
    }
    if (argument && strcmp(verb, "mode") == 0)
        return chmod(path, (mode_t)strtol(argument, NULL, 8)) == 0 || is_fail(verb, path);
    if (argument && strcmp(verb, "owner") == 0)
        return lchown(path, (uid_t)atoi(argument), (gid_t)atoi(argument)) == 0 || is_fail(verb, path);
    if (argument && strcmp(verb, "age") == 0)
        return set_age(path, atof(argument)) || is_fail(verb, path);
    test_fail(__FILE__, __LINE__, "no statement: %s", verb);
    return false;
}

bool attack_statements(struct attack_setup *setup, const char *in, const char *all, bool late) {
    char *copy = strdup(all ? all : ""), *rest = NULL;
    bool ok = copy != NULL;
    for (char *one = ok ? strtok_r(copy, ";", &rest) : NULL; ok && one; one = strtok_r(NULL, ";", &rest)) {
        if (one[strspn(one, " ")] != '\0')
            ok = statement(setup, in, one, late);
    }
    free(copy);
    return ok;
}

bool attack_prepare(const char *in, const char *all) {
    return attack_statements(NULL, in, all, false) && attack_statements(NULL, in, all, true);
}

const char *attack_folder(const char *statements, const char *scene) {
    static char in[700];
    static int number;
    char path[1024], *text = NULL;
    (void)snprintf(in, sizeof in, "%s/%d", test_folder(), ++number);
    (void)snprintf(path, sizeof path, "%s/scene.lua", in);
    CHECK(mkdir(in, 0777) == 0 && chmod(in, 0777) == 0 && attack_prepare(in, statements));
    CHECK(asprintf(&text, "%s%s\n", attack_prelude, scene) > 0);
    test_write_text(path, text);
    free(text);
    return in;
}

void attack_tree_free(struct attack_tree *tree) {
    for (size_t i = 0; i < tree->count; i++)
        free(tree->entries[i].bytes);
    free(tree->entries);
    *tree = (struct attack_tree){0};
}

static void tree_add(struct attack_tree *tree, const char *root, const char *below) {
    char path[2400];
    if (tree->count % 256 == 0)
        tree->entries = realloc(tree->entries, (tree->count + 256) * sizeof *tree->entries);
    if (!tree->entries)
        exit(1);
    struct attack_entry *entry = &tree->entries[tree->count];
    memset(entry, 0, sizeof *entry);
    entry->watch = -1;
    (void)snprintf(entry->path, sizeof entry->path, "%s", below);
    (void)snprintf(path, sizeof path, "%s/%s", root, below);
    if (lstat(path, &entry->status) != 0)
        return;
    tree->count++;
    if (S_ISREG(entry->status.st_mode)) {
        entry->bytes = test_read_file(path, &entry->size);
    } else if (S_ISLNK(entry->status.st_mode)) {
        char target[4096] = {0};
        entry->size = (size_t)readlink(path, target, sizeof target - 1);
        entry->bytes = strdup(target);
    } else if (S_ISDIR(entry->status.st_mode)) {
        DIR *stream = opendir(path);
        for (struct dirent *inner; stream && (inner = readdir(stream)) != NULL;) {
            char name[1200];
            if (strcmp(inner->d_name, ".") == 0 || strcmp(inner->d_name, "..") == 0)
                continue;
            if (snprintf(name, sizeof name, "%s/%s", below, inner->d_name) < (int)sizeof name)
                tree_add(tree, root, name);
        }
        if (stream)
            (void)closedir(stream);
    }
}

struct attack_tree attack_tree(const char *root) {
    struct attack_tree tree = {NULL, 0};
    tree_add(&tree, root, "in");
    tree_add(&tree, root, "out");
    return tree;
}

struct attack_entry *attack_find(const struct attack_tree *tree, const char *path) {
    for (size_t i = 0; i < tree->count; i++) {
        if (strcmp(tree->entries[i].path, path) == 0)
            return &tree->entries[i];
    }
    return NULL;
}

const char *attack_difference(const struct attack_entry *a, const struct attack_entry *b) {
    if (a->status.st_mode != b->status.st_mode)
        return (a->status.st_mode & S_IFMT) != (b->status.st_mode & S_IFMT) ? "is another kind of file"
                                                                            : "has another mode";
    if (a->status.st_ino != b->status.st_ino)
        return "is another file";
    if (a->status.st_uid != b->status.st_uid)
        return "has another owner";
    if (S_ISDIR(a->status.st_mode))
        return NULL;
    if (a->size != b->size || (a->bytes && b->bytes && memcmp(a->bytes, b->bytes, a->size) != 0))
        return "holds other bytes";
    bool touched = S_ISREG(a->status.st_mode) && (a->status.st_mtim.tv_sec != b->status.st_mtim.tv_sec ||
                                                  a->status.st_mtim.tv_nsec != b->status.st_mtim.tv_nsec);
    return touched ? "was written" : NULL;
}

bool attack_begins(const struct attack_entry *entry, const char *bytes, size_t size) {
    return entry->bytes && entry->size >= size && memcmp(entry->bytes, bytes, size) == 0;
}

const char *attack_wrong_picture(const struct attack_entry *entry) {
    const char *ending = strrchr(entry->path, '.');
    if (!S_ISREG(entry->status.st_mode))
        return "is no regular file";
    if (entry->status.st_mode & 07111)
        return "can be executed, or has a special bit";
    bool right = ending && strcasecmp(ending, ".pfm") == 0   ? attack_begins(entry, "PF\n", 3)
                 : ending && strcasecmp(ending, ".hdr") == 0 ? attack_begins(entry, "#?RADIANCE\n", 11)
                 : ending && strcasecmp(ending, ".exr") == 0
                     ? attack_begins(entry, "\x76\x2f\x31\x01", 4)
                     : attack_begins(entry, "\x89PNG\r\n\x1a\n", 8) && entry->size > 60 &&
                           memcmp(entry->bytes + entry->size - 8, "IEND", 4) == 0;
    return right ? NULL : "is no whole picture of its ending";
}
