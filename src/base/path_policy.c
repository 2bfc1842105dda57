/* Two steps. Deciding: a name is resolved part by part, links included (path_resolution(7)), and as soon as it leaves
 * the folders of the list it is refused, before that part is looked up in the file system: the result does not depend
 * on what exists there. Opening: openat2 below that folder's descriptor with RESOLVE_BENEATH and RESOLVE_NO_SYMLINKS
 * (Linux 5.6, openat2(2)); a canonical path contains no links, so a link must have been created in between, and the
 * kernel refuses it. On kernels without openat2 the path of the opened descriptor is checked instead. */
#define _GNU_SOURCE
#include "base/path_policy.h"

#include "base/fault.h"
#include "base/mem.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/openat2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Textually, an absolute name without ".", ".." and double slashes; "" for the root. */
static bool make_plain(const char *path, char *plain, size_t size) {
    size_t used = 0;
    for (const char *at = path; *at;) {
        at += strspn(at, "/");
        size_t length = strcspn(at, "/");
        if (length == 2 && at[0] == '.' && at[1] == '.') {
            while (used > 0 && plain[--used] != '/')
                ;
        } else if (length > 0 && !(length == 1 && at[0] == '.')) {
            if (used + 1 + length >= size)
                return false;
            plain[used++] = '/';
            memcpy(plain + used, at, length);
            used += length;
        }
        at += length;
    }
    plain[used] = '\0';
    return true;
}

/* The name under which a folder was given if it is absolute and not canonical, such as a home directory behind a link.
 * Without memory it is left out, and names that begin with it are refused. */
static void add_spelling(struct path_policy_folder *folder, const char *given) {
    char plain[PATH_MAX], canonical[PATH_MAX];
    if (folder->spelling || given[0] != '/' || !make_plain(given, plain, sizeof plain) ||
        strcmp(plain, folder->path) == 0 || !realpath(plain, canonical) ||
        strcmp(canonical, folder->length > 0 ? folder->path : "/") != 0)
        return;
    folder->spelling = mem_alloc(strlen(plain) + 1);
    if (folder->spelling)
        memcpy(folder->spelling, plain, strlen(plain) + 1);
}

static bool add_canonical(struct path_policy *path_policy, const char *given, const char *canonical,
                          enum path_policy_kind kind, struct error *error) {
    size_t length = strlen(canonical);
    /* The root is the empty prefix. */
    if (length == 1)
        length = 0;
    for (size_t i = 0; i < path_policy->count; i++) {
        struct path_policy_folder *have = &path_policy->folders[i];
        if (have->length == length && memcmp(have->path, canonical, length) == 0) {
            have->kind = kind > have->kind ? kind : have->kind;
            add_spelling(have, given);
            return true;
        }
    }
    struct path_policy_folder *more = mem_resize_array(path_policy->folders, path_policy->count + 1, sizeof *more);
    if (!more)
        return error_no_memory(error, "the folders a scene may read");
    path_policy->folders = more;
    char *path = mem_alloc(length + 1);
    if (!path)
        return error_no_memory(error, "the folders a scene may read");
    memcpy(path, canonical, length);
    path[length] = '\0';
    /* The folder is kept open: later a link under its name cannot lead elsewhere. */
    int descriptor = MAY_FAIL(open(canonical, O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (descriptor < 0) {
        int why = errno;
        mem_free(path);
        enum error_kind failure = error_kind_of_reading(why);
        return (kind == PATH_POLICY_IMPLIED && failure == ERROR_SCENE) ||
               error_set(error, failure, "%s: cannot be opened: %s", canonical, strerror(why));
    }
    path_policy->folders[path_policy->count] = (struct path_policy_folder){path, length, kind, descriptor, NULL};
    add_spelling(&path_policy->folders[path_policy->count++], given);
    return true;
}

bool path_policy_add(struct path_policy *path_policy, const char *folder, enum path_policy_kind kind,
                     struct error *error) {
    char canonical[PATH_MAX];
    bool there = realpath(folder, canonical) && file_is_folder(canonical);
    if (kind == PATH_POLICY_IMPLIED && (!there || strcmp(canonical, "/") == 0))
        return true;
    if (!there)
        return error_set(error, ERROR_USAGE, "%s: is not a folder", folder);
    /* The shell's name for the working directory; add_spelling verifies it. */
    const char *shown = strcmp(folder, ".") == 0 ? getenv("PWD") : NULL;
    return add_canonical(path_policy, shown ? shown : folder, canonical, kind, error);
}

bool path_policy_add_scene(struct path_policy *path_policy, const char *scene, const char *library,
                           struct error *error) {
    char folder[PATH_MAX + sizeof PATH_POLICY_TEXTURES];
    const char *slash = strrchr(scene, '/');
    int length = slash ? (int)(slash - scene) + 1 : 0;
    if (length >= PATH_MAX)
        return error_set(error, ERROR_SCENE, "%.100s...: the path is too long", scene);
    (void)snprintf(folder, sizeof folder, "%.*s.", length, scene);
    if (!path_policy_add(path_policy, folder, PATH_POLICY_IMPLIED, error))
        return false;
    (void)snprintf(folder, sizeof folder, "%.*s..", length, scene);
    if (!path_policy_add(path_policy, folder, PATH_POLICY_IMPLIED, error) ||
        !path_policy_add(path_policy, ".", PATH_POLICY_IMPLIED, error))
        return false;
    (void)snprintf(folder, sizeof folder, "%.*s%s", PATH_MAX - 1, library ? library : "", PATH_POLICY_TEXTURES);
    return !library || (path_policy_add(path_policy, library, PATH_POLICY_READ, error) &&
                        path_policy_add(path_policy, folder, PATH_POLICY_IMPLIED, error));
}

void path_policy_destroy(struct path_policy *path_policy) {
    for (size_t i = 0; i < path_policy->count; i++) {
        (void)close(path_policy->folders[i].descriptor);
        mem_free(path_policy->folders[i].path);
        mem_free(path_policy->folders[i].spelling);
    }
    mem_free(path_policy->folders);
    *path_policy = (struct path_policy){0};
}

/* What lies below the folder, or NULL. */
static const char *rest_below(const struct path_policy_folder *folder, const char *canonical) {
    if (memcmp(canonical, folder->path, folder->length) != 0 || canonical[folder->length] != '/')
        return NULL;
    const char *rest = canonical + folder->length + 1;
    bool hidden = rest[0] == '.' || strstr(rest, "/.");
    return folder->kind == PATH_POLICY_IMPLIED && hidden ? NULL : rest;
}

static const struct path_policy_folder *find(const struct path_policy *path_policy, const char *canonical, bool write,
                                             const char **rest) {
    for (size_t i = 0; i < path_policy->count; i++) {
        const struct path_policy_folder *folder = &path_policy->folders[i];
        if (strlen(canonical) <= folder->length || (write && folder->kind != PATH_POLICY_WRITE))
            continue;
        *rest = rest_below(folder, canonical);
        if (*rest)
            return folder;
    }
    return NULL;
}

/* Whether this is a folder of the list, or an ancestor of one: it exists, and no component is a link. */
static bool leads_to_folder(const struct path_policy *path_policy, const char *canonical) {
    size_t length = strlen(canonical);
    for (size_t i = 0; i < path_policy->count; i++) {
        const struct path_policy_folder *folder = &path_policy->folders[i];
        if (length <= folder->length && memcmp(folder->path, canonical, length) == 0 &&
            (folder->path[length] == '/' || folder->path[length] == '\0'))
            return true;
    }
    return false;
}

/* The absolute name, in which the canonical path of a folder replaces the path under which it was given. */
static bool make_absolute(const struct path_policy *path_policy, const char *path, char whole[2 * PATH_MAX + 2]) {
    char here[PATH_MAX];
    size_t length = 0, begin = 0;
    if (path[0] == '\0' || strlen(path) >= PATH_MAX)
        return false;
    if (path[0] != '/') {
        if (!getcwd(here, sizeof here) || here[0] != '/')
            return false;
        (void)snprintf(whole, 2 * PATH_MAX + 2, "%s/%s", here, path);
        return true;
    }
    const struct path_policy_folder *found = NULL;
    for (size_t i = 0; i < path_policy->count; i++) {
        const struct path_policy_folder *folder = &path_policy->folders[i];
        length = folder->spelling ? strlen(folder->spelling) : 0;
        if (length > begin && strncmp(path, folder->spelling, length) == 0 &&
            (path[length] == '/' || path[length] == '\0')) {
            found = folder;
            begin = length;
        }
    }
    (void)snprintf(whole, 2 * PATH_MAX + 2, "%s%s", found ? found->path : "", path + begin);
    return true;
}

/* The state of a path resolution. */
struct resolution {
    char at[PATH_MAX];           /* canonical so far; "" for the root */
    char rest[2 * PATH_MAX + 2]; /* what follows */
    int links;
    bool last_is_link; /* a link in the last place was followed */
    bool is_out;       /* it ended where the name leaves the folders */
};

/* Replaces the name by the target of the link at `at` plus `name`. */
static bool follow_link(struct resolution *r, const char *link, const char *rest) {
    enum { LINKS = 40 }; /* like the kernel's limit */
    char target[PATH_MAX];
    ssize_t size = readlink(link, target, sizeof target - 1);
    if (size < 0)
        return false;
    if (++r->links > LINKS || size == 0) {
        errno = ELOOP;
        return false;
    }
    size_t length = strlen(rest);
    if (length + (size_t)size >= sizeof r->rest) {
        errno = ENAMETOOLONG;
        return false;
    }
    r->last_is_link = r->last_is_link || length == 0;
    if (target[0] == '/')
        r->at[0] = '\0';
    memmove(r->rest + size, rest, length + 1); /* `rest` is the end of r->rest */
    memcpy(r->rest, target, (size_t)size);
    return true;
}

/* Resolves one component. False with errno: EACCES outside, or the error of the file system inside. `rest` begins
 * with the slash after the part, or is empty. */
static bool take_part(const struct path_policy *path_policy, struct resolution *r, const char *part, size_t length,
                      const char *rest, bool follow) {
    char next[PATH_MAX];
    struct stat status;
    const char *below;
    int size = snprintf(next, sizeof next, "%s/%.*s", r->at, (int)length, part);
    if (size >= (int)sizeof next) {
        errno = ENAMETOOLONG;
        return false;
    }
    /* Parts on the way to a folder of the policy are not looked at: they may be unreadable. */
    bool known = leads_to_folder(path_policy, next);
    if (!known && !find(path_policy, next, false, &below)) {
        r->is_out = true;
        errno = EACCES;
        return false;
    }
    if (!known && lstat(next, &status) != 0)
        return false;
    if (!known && S_ISLNK(status.st_mode) && (follow || rest[0] != '\0'))
        return follow_link(r, next, rest);
    /* A file has nothing below it. */
    if (!known && rest[0] != '\0' && !S_ISDIR(status.st_mode)) {
        errno = ENOTDIR;
        return false;
    }
    memcpy(r->at, next, (size_t)size + 1);
    memmove(r->rest, rest, strlen(rest) + 1);
    return true;
}

/* Resolves components while they exist. True: all exist, and `at` is the canonical path. False with errno; with ENOENT
 * `at` is the existing part, inside the list or above it, and `rest` the first missing component and all after it.
 * follow: also follows a link in the last component. */
static bool resolve(const struct path_policy *path_policy, const char *path, bool follow, struct resolution *r) {
    file_note_search();
    r->at[0] = '\0';
    r->links = 0;
    r->last_is_link = r->is_out = false;
    if (!make_absolute(path_policy, path, r->rest)) {
        errno = strlen(path) >= PATH_MAX ? ENAMETOOLONG : path[0] == '\0' ? ENOENT : EACCES;
        return false;
    }
    /* Part by part, so that no link is followed out of the folders. */
    for (;;) {
        const char *part = r->rest + strspn(r->rest, "/");
        size_t length = strcspn(part, "/");
        if (length == 0)
            return true;
        if (length == 1 && part[0] == '.') {
            memmove(r->rest, part + length, strlen(part + length) + 1);
        } else if (length == 2 && part[0] == '.' && part[1] == '.') {
            char *slash = strrchr(r->at, '/');
            if (slash)
                *slash = '\0';
            memmove(r->rest, part + length, strlen(part + length) + 1);
        } else if (!take_part(path_policy, r, part, length, part + length, follow)) {
            memmove(r->rest, part, strlen(part) + 1);
            return false;
        }
    }
}

bool path_policy_is_readable(const struct path_policy *path_policy, const char *path) {
    struct resolution r;
    const char *rest;
    if (!path_policy)
        return file_is_regular(path);
    return resolve(path_policy, path, true, &r) && find(path_policy, r.at, false, &rest) && file_is_regular(r.at);
}

bool path_policy_is_outside(const struct path_policy *path_policy, const char *path) {
    char whole[2 * PATH_MAX + 2], plain[2 * PATH_MAX + 2];
    const char *rest;
    return path_policy && (!make_absolute(path_policy, path, whole) || !make_plain(whole, plain, sizeof plain) ||
                           !find(path_policy, plain, false, &rest));
}

bool path_policy_leads_out(const struct path_policy *path_policy, const char *path) {
    struct resolution r;
    char whole[3 * PATH_MAX + 4];
    const char *rest;
    if (path[0] == '\0')
        return false;
    if (!path_policy || resolve(path_policy, path, true, &r))
        return path_policy && !find(path_policy, r.at, false, &rest) && !leads_to_folder(path_policy, r.at);
    if (errno != ENOENT || r.is_out)
        return r.is_out;
    (void)snprintf(whole, sizeof whole, "%s/%s", r.at, r.rest); /* what is missing may still contain ".." */
    return !make_plain(whole, r.rest, sizeof r.rest) || !find(path_policy, r.rest, false, &rest);
}

/* Opens a canonical path below a folder with these flags. */
static int open_below(const struct path_policy_folder *folder, const char *rest, const char *canonical, int flags) {
    struct open_how how = {.flags = (unsigned)flags | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW,
                           .mode = flags & O_CREAT ? 0666u : 0u,
                           .resolve = RESOLVE_BENEATH | RESOLVE_NO_SYMLINKS};
    long descriptor = MAY_FAIL(syscall(SYS_openat2, folder->descriptor, rest, &how, sizeof how));
    if (descriptor >= 0 || (errno != ENOSYS && errno != EPERM))
        return (int)descriptor;
    /* Opens by name, then checks the real path of the descriptor. */
    int opened = MAY_FAIL(open(canonical, (int)how.flags & ~O_TRUNC, 0666));
    char link[64], reported[PATH_MAX];
    if (opened < 0)
        return -1;
    (void)snprintf(link, sizeof link, "/proc/self/fd/%d", opened);
    ssize_t length = MAY_FAIL(readlink(link, reported, sizeof reported - 1));
    bool same = length > 0 && (size_t)length == strlen(canonical) && memcmp(reported, canonical, (size_t)length) == 0;
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

/* The canonical path of a name whose last part need not exist and is not followed. */
static bool canonical_parent(const struct path_policy *path_policy, const char *path, char canonical[PATH_MAX]) {
    char folder[PATH_MAX];
    struct resolution r;
    const char *slash = strrchr(path, '/'), *last = slash ? slash + 1 : path;
    size_t length = slash ? (size_t)(slash - path) + 1 : 0;
    if (length + 2 >= sizeof folder || last[0] == '\0' || strcmp(last, ".") == 0 || strcmp(last, "..") == 0) {
        errno = EINVAL;
        return false;
    }
    memcpy(folder, path, length);
    memcpy(folder + length, ".", 2);
    if (!resolve(path_policy, folder, true, &r))
        return false;
    int size = snprintf(canonical, PATH_MAX, "%s/%s", r.at, last);
    if (size < PATH_MAX)
        return true;
    errno = ENAMETOOLONG;
    return false;
}

/* A descriptor of a regular file, or -1 with errno. */
static int open_checked(const struct path_policy *path_policy, const char *path, int flags) {
    struct resolution r;
    char canonical[PATH_MAX];
    const char *rest = NULL;
    bool write = (flags & (O_WRONLY | O_RDWR)) != 0;
    /* A link in the last component is followed to find its target; nothing is written through a dangling link. */
    bool there = resolve(path_policy, path, true, &r);
    if (!there && (errno != ENOENT || !write || r.last_is_link || !canonical_parent(path_policy, path, canonical)))
        return -1;
    if (there)
        memcpy(canonical, r.at, sizeof canonical);
    const struct path_policy_folder *folder = find(path_policy, canonical, write, &rest);
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

bool path_policy_map(const struct path_policy *path_policy, const char *path, size_t limit, struct file_bytes *out,
                     struct error *error) {
    if (!path_policy)
        return file_map(path, limit, out, error);
    *out = (struct file_bytes){0};
    int descriptor = open_checked(path_policy, path, O_RDONLY);
    if (descriptor < 0)
        return error_set(error, error_kind_of_reading(errno), "%s: cannot be read: %s", path, strerror(errno));
    return file_map_descriptor(descriptor, path, limit, out, error);
}

/* A descriptor of a folder for reading, or -1. */
static int open_listing(const struct path_policy *path_policy, const char *path) {
    const int flags = O_RDONLY | O_DIRECTORY;
    struct resolution r;
    const char *rest = ".";
    if (!path_policy)
        return MAY_FAIL(open(path, flags | O_CLOEXEC));
    if (!resolve(path_policy, path, true, &r))
        return -1;
    for (size_t i = 0; i < path_policy->count; i++)
        if (strcmp(path_policy->folders[i].path, r.at) == 0)
            return open_below(&path_policy->folders[i], rest, r.at, flags);
    const struct path_policy_folder *folder = find(path_policy, r.at, false, &rest);
    return folder ? open_below(folder, rest, r.at, flags) : -1;
}

static bool is_folder_entry(int descriptor, const struct dirent *entry) {
    struct stat status;
    if (entry->d_type != DT_UNKNOWN)
        return entry->d_type == DT_DIR;
    return MAY_FAIL(fstatat(descriptor, entry->d_name, &status, AT_SYMLINK_NOFOLLOW)) == 0 && S_ISDIR(status.st_mode);
}

static int compare_entries(const void *a, const void *b) {
    const struct path_policy_entry *left = a, *right = b;
    return strcmp(left->name, right->name);
}

/* The first `limit` names of a folder in byte order, whatever the order of the file system. Owner: read_entries. */
struct name_list {
    struct path_policy_entry *entries;
    size_t count, room, limit;
};

/* Sorts, and drops the entries beyond the limit. */
static void name_list_cut(struct name_list *list) {
    if (list->count > 0)
        qsort(list->entries, list->count, sizeof *list->entries, compare_entries);
    while (list->count > list->limit)
        mem_free((void *)(uintptr_t)list->entries[--list->count].name);
}

/* False: no memory. */
static bool name_list_add(struct name_list *list, const char *name, bool is_folder) {
    if (list->count >= 2 * list->limit)
        name_list_cut(list);
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : 64;
        struct path_policy_entry *more = mem_resize_array(list->entries, room, sizeof *more);
        if (!more)
            return false;
        list->entries = more;
        list->room = room;
    }
    size_t size = strlen(name) + 1;
    char *copy = mem_alloc(size);
    if (!copy)
        return false;
    memcpy(copy, name, size);
    list->entries[list->count++] = (struct path_policy_entry){copy, is_folder};
    return true;
}

/* Copied into the arena; NULL: no memory. */
static struct path_policy_entry *read_entries(DIR *stream, size_t limit, struct arena *arena, size_t *count) {
    struct name_list list = {.limit = limit};
    bool ok = true;
    for (struct dirent *entry; ok && limit > 0 && (entry = readdir(stream)) != NULL;)
        if (entry->d_name[0] != '.')
            ok = name_list_add(&list, entry->d_name, is_folder_entry(dirfd(stream), entry));
    name_list_cut(&list);
    struct path_policy_entry *kept = ok ? arena_alloc_array(arena, list.count ? list.count : 1, sizeof *kept) : NULL;
    for (size_t i = 0; kept && i < list.count; i++) {
        kept[i] = list.entries[i];
        kept[i].name = arena_copy_text(arena, list.entries[i].name, strlen(list.entries[i].name));
        if (!kept[i].name)
            kept = NULL;
    }
    *count = kept ? list.count : 0;
    list.limit = 0;
    name_list_cut(&list);
    mem_free(list.entries);
    return kept;
}

size_t path_policy_list(const struct path_policy *path_policy, const char *folder, size_t limit, struct arena *arena,
                        struct path_policy_entry **entries) {
    size_t count = 0;
    int descriptor = open_listing(path_policy, folder);
    DIR *stream = descriptor >= 0 ? MAY_GIVE_NULL(fdopendir(descriptor)) : NULL;
    *entries = NULL;
    if (stream) {
        *entries = read_entries(stream, limit, arena, &count);
        (void)closedir(stream);
    } else if (descriptor >= 0) {
        (void)close(descriptor);
    }
    return *entries ? count : 0;
}

/* fopen's modes; -1 for an unknown one. */
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

static void note_stream(int descriptor, const char *path, const char *mode) {
    if (mode[0] == 'r')
        file_note_read(descriptor, path);
    if (mode[0] != 'r' || strchr(mode, '+'))
        file_note_write(descriptor, path);
}

FILE *path_policy_stream(const struct path_policy *path_policy, const char *path, const char *mode) {
    if (!path_policy) {
        FILE *open = MAY_GIVE_NULL(fopen(path, mode));
        if (open)
            note_stream(fileno(open), path, mode);
        return open;
    }
    int flags = flags_of(mode);
    int descriptor = flags < 0 ? -1 : open_checked(path_policy, path, flags);
    if (descriptor < 0)
        return NULL;
    note_stream(descriptor, path, mode);
    FILE *stream = MAY_GIVE_NULL(fdopen(descriptor, mode));
    if (!stream)
        (void)close(descriptor);
    return stream;
}

/* The folder's descriptor and the last name, for a file that may be changed. */
static const struct path_policy_folder *writable(const struct path_policy *path_policy, const char *path,
                                                 char canonical[PATH_MAX], const char **rest) {
    if (!canonical_parent(path_policy, path, canonical))
        return NULL;
    const struct path_policy_folder *folder = find(path_policy, canonical, true, rest);
    if (!folder)
        errno = EACCES;
    return folder;
}

/* The state while the folder of a new file is resolved; too large for a small stack. */
struct new_name {
    char canonical[3 * PATH_MAX + 4];
    struct resolution r;
};

/* The folder below which a file of this name may be created, and the canonical name below it. Links are followed in the
 * existing part, except in the last component; the rest must be plain names. */
static const struct path_policy_folder *find_new(const struct path_policy *path_policy, const char *path,
                                                 struct new_name *name, const char **rest) {
    struct resolution *r = &name->r;
    bool there = resolve(path_policy, path, false, r);
    if (!there && (errno != ENOENT || r->rest[0] == '.' || strstr(r->rest, "/.")))
        return NULL;
    (void)snprintf(name->canonical, sizeof name->canonical, "%s%s%s", r->at, there ? "" : "/", there ? "" : r->rest);
    const struct path_policy_folder *found = find(path_policy, name->canonical, true, rest);
    return found && (*rest)[0] != '.' && !strstr(*rest, "/.") ? found : NULL;
}

bool path_policy_may_create(const struct path_policy *path_policy, const char *path) {
    struct new_name *name = mem_alloc(sizeof *name);
    const char *rest;
    bool may = name && find_new(path_policy, path, name, &rest);
    mem_free(name);
    return may;
}

/* One folder at a time, no links: openat2 is not needed for that. */
static int open_folders(int folder, const char *rest) {
    const int flags = O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC;
    for (const char *slash; folder >= 0 && (slash = strchr(rest, '/')) != NULL; rest = slash + 1) {
        char name[NAME_MAX + 1];
        size_t length = (size_t)(slash - rest);
        int next = -1;
        if (length == 0)
            continue;
        errno = ENAMETOOLONG;
        if (length < sizeof name) {
            memcpy(name, rest, length);
            name[length] = '\0';
            next = MAY_FAIL(openat(folder, name, flags));
            if (next < 0 && errno == ENOENT && (MAY_FAIL(mkdirat(folder, name, 0777)) == 0 || errno == EEXIST))
                next = MAY_FAIL(openat(folder, name, flags));
        }
        int saved = errno;
        (void)close(folder);
        errno = saved;
        folder = next;
    }
    return folder;
}

int path_policy_open_folder(const struct path_policy *path_policy, const char *path) {
    struct new_name *name = mem_alloc(sizeof *name);
    const char *rest = NULL;
    const struct path_policy_folder *found = name ? find_new(path_policy, path, name, &rest) : NULL;
    int folder = -1;
    if (!found)
        errno = name ? EACCES : ENOMEM;
    else
        folder = open_folders(MAY_FAIL(openat(found->descriptor, ".", O_PATH | O_DIRECTORY | O_CLOEXEC)), rest);
    int saved = errno;
    mem_free(name);
    errno = saved;
    return folder;
}

bool path_policy_remove(const struct path_policy *path_policy, const char *path) {
    char canonical[PATH_MAX];
    const char *rest;
    return writable(path_policy, path, canonical, &rest) && unlink(canonical) == 0;
}

bool path_policy_rename(const struct path_policy *path_policy, const char *from, const char *to) {
    char source[PATH_MAX], target[PATH_MAX];
    const char *rest;
    return writable(path_policy, from, source, &rest) && writable(path_policy, to, target, &rest) &&
           rename(source, target) == 0;
}
