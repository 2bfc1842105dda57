/* Two steps. Deciding: the canonical path (realpath) must lie below a folder of the list. Opening: openat2 below that
 * folder's descriptor with RESOLVE_BENEATH and RESOLVE_NO_SYMLINKS (Linux 5.6, openat2(2)); a canonical path holds no
 * links, so one that is met was put there in between and is refused by the kernel. On kernels without openat2 the
 * opened descriptor is asked for its path instead. */
#define _GNU_SOURCE
#include "base/reach.h"

#include "base/fault.h"
#include "base/mem.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/openat2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static bool add_canonical(struct reach *reach, const char *canonical, enum reach_kind kind, struct error *error) {
    size_t length = strlen(canonical);
    if (length == 1)
        length = 0;
    for (size_t i = 0; i < reach->count; i++) {
        struct reach_folder *have = &reach->folders[i];
        if (have->length == length && memcmp(have->path, canonical, length) == 0) {
            have->kind = kind > have->kind ? kind : have->kind;
            return true;
        }
    }
    struct reach_folder *more = mem_resize_array(reach->folders, reach->count + 1, sizeof *more);
    if (!more)
        return error_no_memory(error, "the folders a scene may read");
    reach->folders = more;
    char *path = mem_alloc(length + 1);
    if (!path)
        return error_no_memory(error, "the folders a scene may read");
    memcpy(path, canonical, length);
    path[length] = '\0';
    int descriptor = MAY_FAIL(open(canonical, O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (descriptor < 0) {
        int why = errno;
        mem_free(path);
        return kind == REACH_IMPLIED ||
               error_set(error, ERROR_SCENE, "%s: cannot be opened: %s", canonical, strerror(why));
    }
    reach->folders[reach->count++] = (struct reach_folder){path, length, kind, descriptor};
    return true;
}

bool reach_add(struct reach *reach, const char *folder, enum reach_kind kind, struct error *error) {
    char canonical[PATH_MAX];
    bool there = realpath(folder, canonical) && file_is_folder(canonical);
    if (kind == REACH_IMPLIED && (!there || strcmp(canonical, "/") == 0))
        return true;
    if (!there)
        return error_set(error, ERROR_USAGE, "%s: is not a folder", folder);
    return add_canonical(reach, canonical, kind, error);
}

bool reach_add_scene(struct reach *reach, const char *scene, const char *library, struct error *error) {
    char folder[PATH_MAX + 4];
    const char *slash = strrchr(scene, '/');
    int length = slash ? (int)(slash - scene) + 1 : 0;
    if (length >= PATH_MAX)
        return error_set(error, ERROR_SCENE, "%.100s...: the path is too long", scene);
    (void)snprintf(folder, sizeof folder, "%.*s.", length, scene);
    if (!reach_add(reach, folder, REACH_IMPLIED, error))
        return false;
    (void)snprintf(folder, sizeof folder, "%.*s..", length, scene);
    return reach_add(reach, folder, REACH_IMPLIED, error) && reach_add(reach, ".", REACH_IMPLIED, error) &&
           (!library || reach_add(reach, library, REACH_READ, error));
}

void reach_destroy(struct reach *reach) {
    for (size_t i = 0; i < reach->count; i++) {
        (void)close(reach->folders[i].descriptor);
        mem_free(reach->folders[i].path);
    }
    mem_free(reach->folders);
    *reach = (struct reach){0};
}

/* What lies below the folder, or NULL. */
static const char *rest_below(const struct reach_folder *folder, const char *canonical) {
    if (memcmp(canonical, folder->path, folder->length) != 0 || canonical[folder->length] != '/')
        return NULL;
    const char *rest = canonical + folder->length + 1;
    bool hidden = rest[0] == '.' || strstr(rest, "/.");
    return folder->kind == REACH_IMPLIED && hidden ? NULL : rest;
}

static const struct reach_folder *find(const struct reach *reach, const char *canonical, bool write,
                                       const char **rest) {
    for (size_t i = 0; i < reach->count; i++) {
        const struct reach_folder *folder = &reach->folders[i];
        if (strlen(canonical) <= folder->length || (write && folder->kind != REACH_WRITE))
            continue;
        *rest = rest_below(folder, canonical);
        if (*rest)
            return folder;
    }
    return NULL;
}

bool reach_is_readable(const struct reach *reach, const char *path) {
    char canonical[PATH_MAX];
    const char *rest;
    if (!reach)
        return file_is_regular(path);
    return realpath(path, canonical) && find(reach, canonical, false, &rest) && file_is_regular(canonical);
}

bool reach_is_outside(const struct reach *reach, const char *path) {
    char whole[2 * PATH_MAX + 2], plain[2 * PATH_MAX + 2];
    const char *rest;
    if (!reach)
        return false;
    if (strlen(path) >= PATH_MAX)
        return true;
    if (path[0] == '/') {
        (void)snprintf(whole, sizeof whole, "%s", path);
    } else {
        char here[PATH_MAX];
        if (!getcwd(here, sizeof here))
            return true;
        (void)snprintf(whole, sizeof whole, "%s/%s", here, path);
    }
    /* "." and ".." by the letter. */
    size_t used = 0;
    for (const char *at = whole; *at;) {
        at += strspn(at, "/");
        size_t length = strcspn(at, "/");
        if (length == 2 && at[0] == '.' && at[1] == '.') {
            while (used > 0 && plain[--used] != '/')
                ;
        } else if (length > 0 && !(length == 1 && at[0] == '.')) {
            plain[used++] = '/';
            memcpy(plain + used, at, length);
            used += length;
        }
        at += length;
    }
    plain[used] = '\0';
    return !find(reach, plain, false, &rest);
}

/* The descriptor of a canonical path below a folder; the flags say what for. */
static int open_below(const struct reach_folder *folder, const char *rest, const char *canonical, int flags) {
    struct open_how how = {.flags = (unsigned)flags | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW,
                           .mode = flags & O_CREAT ? 0666u : 0u,
                           .resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS};
    long descriptor = MAY_FAIL(syscall(SYS_openat2, folder->descriptor, rest, &how, sizeof how));
    if (descriptor >= 0 || (errno != ENOSYS && errno != EPERM))
        return (int)descriptor;
    /* Opened by name, then asked where it is. */
    int opened = MAY_FAIL(open(canonical, (int)how.flags & ~O_TRUNC, 0666));
    char link[64], told[PATH_MAX];
    if (opened < 0)
        return -1;
    (void)snprintf(link, sizeof link, "/proc/self/fd/%d", opened);
    ssize_t length = MAY_FAIL(readlink(link, told, sizeof told - 1));
    bool same = length > 0 && (size_t)length == strlen(canonical) && memcmp(told, canonical, (size_t)length) == 0;
    if (!same || ((flags & O_TRUNC) && MAY_FAIL(ftruncate(opened, 0)) != 0)) {
        (void)close(opened);
        errno = EACCES;
        return -1;
    }
    return opened;
}

static bool is_regular(int descriptor) {
    struct stat status;
    return MAY_FAIL(fstat(descriptor, &status)) == 0 && S_ISREG(status.st_mode);
}

/* The canonical path of a name whose last part need not exist. */
static bool canonical_parent(const char *path, char canonical[PATH_MAX]) {
    char folder[PATH_MAX];
    const char *slash = strrchr(path, '/'), *last = slash ? slash + 1 : path;
    size_t length = slash ? (size_t)(slash - path) + 1 : 0;
    if (length + 2 >= sizeof folder || last[0] == '\0' || strcmp(last, ".") == 0 || strcmp(last, "..") == 0) {
        errno = EINVAL;
        return false;
    }
    memcpy(folder, path, length);
    memcpy(folder + length, ".", 2);
    if (!realpath(folder, canonical))
        return false;
    size_t used = strlen(canonical);
    used -= used == 1; /* "/" */
    if (used + 1 + strlen(last) >= PATH_MAX) {
        errno = ENAMETOOLONG;
        return false;
    }
    canonical[used] = '/';
    memcpy(canonical + used + 1, last, strlen(last) + 1);
    return true;
}

/* A descriptor of a regular file, or -1 with errno. */
static int open_checked(const struct reach *reach, const char *path, int flags) {
    char canonical[PATH_MAX];
    const char *rest = NULL;
    bool write = (flags & O_ACCMODE) != O_RDONLY;
    if (reach_is_outside(reach, path)) {
        errno = EACCES;
        return -1;
    }
    /* A link in the last place is followed to see where it leads; one that leads nowhere is not written through. */
    bool there = realpath(path, canonical) != NULL;
    if (!there && (!write || !canonical_parent(path, canonical)))
        return -1;
    const struct reach_folder *folder = find(reach, canonical, write, &rest);
    if (!folder) {
        errno = EACCES;
        return -1;
    }
    int descriptor = open_below(folder, rest, canonical, flags);
    if (descriptor >= 0 && !is_regular(descriptor)) {
        (void)close(descriptor);
        errno = EACCES;
        return -1;
    }
    return descriptor;
}

bool reach_map(const struct reach *reach, const char *path, size_t limit, struct file_bytes *out, struct error *error) {
    if (!reach)
        return file_map(path, limit, out, error);
    *out = (struct file_bytes){0};
    int descriptor = open_checked(reach, path, O_RDONLY);
    if (descriptor < 0)
        return error_set(error, ERROR_SCENE, "%s: cannot be read: %s", path, strerror(errno));
    return file_map_descriptor(descriptor, path, limit, out, error);
}

/* fopen's modes; -1 for what is none. */
static int flags_of(const char *mode) {
    bool plus = strchr(mode, '+') != NULL;
    int direction = plus ? O_RDWR : mode[0] == 'r' ? O_RDONLY : O_WRONLY;
    switch (mode[0]) {
    case 'r':
        return direction;
    case 'w':
        return direction | O_CREAT | O_TRUNC;
    case 'a':
        return direction | O_CREAT | O_APPEND;
    default:
        errno = EINVAL;
        return -1;
    }
}

FILE *reach_stream(const struct reach *reach, const char *path, const char *mode) {
    if (!reach) {
        FILE *open = MAY_GIVE_NULL(fopen(path, mode));
        if (open && mode[0] == 'r')
            file_note_read(fileno(open), path);
        return open;
    }
    int flags = flags_of(mode);
    int descriptor = flags < 0 ? -1 : open_checked(reach, path, flags);
    if (descriptor < 0)
        return NULL;
    if (mode[0] == 'r')
        file_note_read(descriptor, path);
    FILE *stream = MAY_GIVE_NULL(fdopen(descriptor, mode));
    if (!stream)
        (void)close(descriptor);
    return stream;
}

/* The folder's descriptor and the last name, for a file that may be changed. */
static const struct reach_folder *writable(const struct reach *reach, const char *path, char canonical[PATH_MAX],
                                           const char **rest) {
    if (!canonical_parent(path, canonical))
        return NULL;
    const struct reach_folder *folder = find(reach, canonical, true, rest);
    if (!folder)
        errno = EACCES;
    return folder;
}

/* The part that exists is looked at where it leads; what follows is taken as it is written. */
bool reach_may_create(const struct reach *reach, const char *path) {
    char folder[PATH_MAX], canonical[2 * PATH_MAX];
    size_t length = strlen(path), existing = length;
    const char *rest = NULL;
    if (length >= sizeof folder)
        return false;
    for (;;) {
        while (existing > 0 && path[existing - 1] != '/')
            existing--;
        memcpy(folder, path, existing);
        memcpy(folder + existing, existing == 0 ? "." : "", existing == 0 ? 2 : 1);
        if (realpath(folder, canonical))
            break;
        if (existing == 0 || errno != ENOENT)
            return false;
        existing--;
    }
    const char *missing = path + existing;
    if (missing[0] == '.' || strstr(missing, "/."))
        return false;
    size_t used = strlen(canonical);
    used -= used == 1;
    (void)snprintf(canonical + used, sizeof canonical - used, "/%s", missing);
    const struct reach_folder *found = find(reach, canonical, true, &rest);
    return found && rest[0] != '.' && !strstr(rest, "/.");
}

bool reach_remove(const struct reach *reach, const char *path) {
    char canonical[PATH_MAX];
    const char *rest;
    return writable(reach, path, canonical, &rest) && unlink(canonical) == 0;
}

bool reach_rename(const struct reach *reach, const char *from, const char *to) {
    char source[PATH_MAX], target[PATH_MAX];
    const char *rest;
    return writable(reach, from, source, &rest) && writable(reach, to, target, &rest) && rename(source, target) == 0;
}
