/* Reading files. A file is read as a private copy, so that it may shrink meanwhile without harm, and every read is
 * reported to the listener. */
#define _GNU_SOURCE
#include "base/file.h"

#include "base/fault.h"
#include "base/mem.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/stat.h>
#include <unistd.h>

/* The only state that outlives a call. It belongs to the process as its files do: scripts, readers of meshes and
 * pictures, and Lua's own functions read files, and none of them may leave the listener out. */
static const struct file_listener *file_listener;

void file_set_listener(const struct file_listener *listener) {
    file_listener = listener;
}

void file_note_search(void) {
    if (file_listener && file_listener->searches)
        file_listener->searches(file_listener->context);
}

/* Sets of files. */

static bool is_same(struct file_identity a, struct file_identity b) {
    return a.device == b.device && a.inode == b.inode;
}

/* The slot of the identity, or the free one where it belongs. `room` is a power of two and never full. */
static size_t slot_of(const struct file_set *set, struct file_identity identity) {
    static const struct file_identity free_slot;
    size_t at = (size_t)hash_bytes(&identity, sizeof identity, 0) & (set->room - 1);
    while (!is_same(set->slots[at], free_slot) && !is_same(set->slots[at], identity))
        at = (at + 1) & (set->room - 1);
    return at;
}

bool file_set_has(const struct file_set *set, struct file_identity identity) {
    return set->count > 0 && is_same(set->slots[slot_of(set, identity)], identity);
}

static bool set_grow(struct file_set *set) {
    struct file_set larger = {.room = set->room ? 2 * set->room : 16};
    larger.slots = mem_alloc_zero(larger.room, sizeof *larger.slots);
    if (!larger.slots)
        return false;
    for (size_t i = 0; i < set->room; i++) {
        if (set->slots[i].device || set->slots[i].inode)
            larger.slots[slot_of(&larger, set->slots[i])] = set->slots[i];
    }
    larger.count = set->count;
    mem_free(set->slots);
    *set = larger;
    return true;
}

bool file_set_add(struct file_set *set, struct file_identity identity) {
    if (file_set_has(set, identity))
        return true;
    if (2 * (set->count + 1) > set->room && !set_grow(set))
        return false;
    set->slots[slot_of(set, identity)] = identity;
    set->count++;
    return true;
}

/* Later entries of the same run of slots move up, so that no search has to pass a hole. */
void file_set_remove(struct file_set *set, struct file_identity identity) {
    if (!file_set_has(set, identity))
        return;
    size_t at = slot_of(set, identity);
    set->slots[at] = (struct file_identity){0};
    set->count--;
    for (size_t next = (at + 1) & (set->room - 1); set->slots[next].device || set->slots[next].inode;
         next = (next + 1) & (set->room - 1)) {
        struct file_identity moved = set->slots[next];
        set->slots[next] = (struct file_identity){0};
        set->slots[slot_of(set, moved)] = moved;
    }
}

void file_set_destroy(struct file_set *set) {
    mem_free(set->slots);
    *set = (struct file_set){0};
}

bool file_identity_of(const char *path, struct file_identity *out) {
    struct stat status;
    if (stat(path, &status) != 0)
        return false;
    *out = (struct file_identity){(uint64_t)status.st_dev, (uint64_t)status.st_ino};
    return true;
}

bool file_identity_of_descriptor(int descriptor, struct file_identity *out) {
    struct stat status;
    if (fstat(descriptor, &status) != 0)
        return false;
    *out = (struct file_identity){(uint64_t)status.st_dev, (uint64_t)status.st_ino};
    return true;
}

static void note_content(struct file_read_log *read_log, struct digest content) {
    for (size_t i = 0; i < read_log->count; i++) {
        if (digest_equal(read_log->contents[i], content))
            return;
    }
    if (read_log->count == read_log->room) {
        size_t room = read_log->room ? 2 * read_log->room : 16;
        struct digest *more = mem_resize(read_log->contents, room * sizeof *more);
        if (!more) {
            read_log->incomplete = true;
            return;
        }
        read_log->contents = more;
        read_log->room = room;
    }
    read_log->contents[read_log->count++] = content;
}

/* False: it could not be read to its end. */
static bool digest_of(int descriptor, struct digest *content) {
    char piece[1 << 14];
    *content = (struct digest){0};
    for (off_t at = 0;;) {
        ssize_t got = MAY_FAIL(pread(descriptor, piece, sizeof piece, at));
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return got == 0;
        *content = digest_bytes(piece, (size_t)got, *content);
        at += got;
    }
}

static struct file_version version_of(const struct stat *status) {
    return (struct file_version){.identity = {(uint64_t)status->st_dev, (uint64_t)status->st_ino},
                                 .size = (uint64_t)status->st_size,
                                 .seconds = (int64_t)status->st_mtim.tv_sec,
                                 .nanoseconds = (int64_t)status->st_mtim.tv_nsec};
}

static bool is_same_version(const struct file_version *a, const struct file_version *b) {
    return a->identity.device == b->identity.device && a->identity.inode == b->identity.inode && a->size == b->size &&
           a->seconds == b->seconds && a->nanoseconds == b->nanoseconds;
}

/* Whether the log has not got this version yet; notes it. */
static bool is_new_version(struct file_read_log *log, const struct file_version *version) {
    for (size_t i = log->version_count; i-- > 0;) {
        if (is_same_version(&log->versions[i], version))
            return false;
    }
    if (log->version_count == log->version_room) {
        size_t room = log->version_room ? 2 * log->version_room : 16;
        struct file_version *more = mem_resize(log->versions, room * sizeof *more);
        log->incomplete = log->incomplete || !more;
        if (!more)
            return true;
        log->versions = more;
        log->version_room = room;
    }
    log->versions[log->version_count++] = *version;
    return true;
}

/* Whether the log needs the content of this version: not again, and not beyond its limit. */
static bool log_needs(struct file_read_log *log, const struct file_version *version) {
    if (!is_new_version(log, version))
        return false;
    if (log->limit == 0)
        return true;
    log->incomplete = log->incomplete || version->size >= log->limit;
    if (log->incomplete)
        return false;
    log->limit -= version->size;
    return true;
}

void file_note_read(int descriptor, const char *path) {
    struct stat status;
    const struct file_listener *listener = file_listener;
    if (!listener || MAY_FAIL(fstat(descriptor, &status)) != 0 || !S_ISREG(status.st_mode))
        return;
    struct file_version version = version_of(&status);
    const bool is_logged = listener->log && log_needs(listener->log, &version);
    if (is_logged || listener->contents) {
        bool whole = digest_of(descriptor, &version.content);
        if (is_logged && !whole)
            listener->log->incomplete = true;
        if (is_logged)
            note_content(listener->log, version.content);
    }
    if (listener->heard)
        listener->heard(listener->context, path, &version);
}

void file_note_write(int descriptor, const char *path) {
    struct stat status;
    if (!file_listener || !file_listener->wrote || MAY_FAIL(fstat(descriptor, &status)) != 0)
        return;
    struct file_version version = version_of(&status);
    file_listener->wrote(file_listener->context, path, &version);
}

bool file_version_of(const char *path, const struct file_version *known, struct file_version *out) {
    struct stat status;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0)
        return false;
    bool ok = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
    if (ok) {
        *out = version_of(&status);
        bool same = known && is_same_version(known, out);
        out->content = same ? known->content : (struct digest){0};
        ok = same || digest_of(descriptor, &out->content);
    }
    (void)close(descriptor);
    return ok;
}

bool file_digest(const char *path, struct digest *digest) {
    struct stat status;
    char name[64];
    int handle = MAY_FAIL(open(path, O_PATH | O_CLOEXEC));
    if (handle < 0)
        return false;
    (void)snprintf(name, sizeof name, "/proc/self/fd/%d", handle);
    int descriptor = fstat(handle, &status) == 0 && S_ISREG(status.st_mode) ? open(name, O_RDONLY | O_CLOEXEC) : -1;
    bool ok = descriptor >= 0 && digest_of(descriptor, digest);
    if (descriptor >= 0)
        (void)close(descriptor);
    (void)close(handle);
    return ok;
}

struct digest file_read_log_sum(const struct file_read_log *read_log) {
    struct digest sum = {read_log->count, 0};
    for (size_t i = 0; i < read_log->count; i++) {
        struct digest one = digest_bytes(&read_log->contents[i], sizeof read_log->contents[i], (struct digest){0});
        sum.a += one.a;
        sum.b += one.b;
    }
    return sum;
}

void file_read_log_destroy(struct file_read_log *read_log) {
    mem_free(read_log->contents);
    mem_free(read_log->versions);
    *read_log = (struct file_read_log){0};
}

/* The size of an open regular file; anything else is an error. */
static bool regular_size(int descriptor, const char *path, uint64_t *size, struct error *error) {
    struct stat status;
    if (MAY_FAIL(fstat(descriptor, &status)) != 0)
        return error_set(error, error_kind_of_reading(errno), "%s: cannot be read: %s", path, strerror(errno));
    if (!S_ISREG(status.st_mode))
        return error_set(error, ERROR_SCENE, "%s: is %s, not a regular file", path,
                         S_ISDIR(status.st_mode) ? "a folder" : "a pipe or device");
    *size = (uint64_t)status.st_size;
    return true;
}

bool file_map_descriptor(int descriptor, const char *path, size_t limit, struct file_bytes *out, struct error *error) {
    *out = (struct file_bytes){0};
    uint64_t whole = 0;
    bool ok = regular_size(descriptor, path, &whole, error);
    if (!ok) {
        (void)close(descriptor);
        return false;
    }
    if (whole > limit) {
        ok = error_set(error, ERROR_SCENE, "%s: %llu bytes are more than the limit of %zu", path,
                       (unsigned long long)whole, limit);
    } else if (whole == 0) {
        out->data = (const uint8_t *)"";
    } else {
        /* A private copy rather than a mapping: a file that shrinks while it is mapped would kill the process. */
        size_t size = (size_t)whole, have = 0;
        uint64_t refusals = mem_refusals();
        uint8_t *data = mem_alloc(size);
        if (!data) {
            (void)close(descriptor);
            (void)error_no_memory(error, path);
            return error_of_file(error, path, refusals);
        }
        while (have < size) {
            ssize_t got = MAY_FAIL(read(descriptor, data + have, size - have));
            if (got < 0 && errno == EINTR)
                continue;
            if (got <= 0)
                break;
            have += (size_t)got;
        }
        ok = have == size;
        if (ok)
            file_note_read(descriptor, path);
        if (!ok) {
            error_set(error, ERROR_SCENE, "%s: ended after %zu of %zu bytes while it was read", path, have, size);
            mem_free(data);
        } else {
            out->data = data;
            out->size = size;
        }
    }
    (void)close(descriptor);
    return ok;
}

static int open_for_reading(const char *path, struct error *error) {
    file_note_search();
    /* O_NONBLOCK: opening a named pipe must not wait for a writer. */
    int descriptor = MAY_FAIL(open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (descriptor < 0)
        (void)error_set(error, error_kind_of_reading(errno), "%s: cannot be read: %s", path, strerror(errno));
    return descriptor;
}

bool file_map(const char *path, size_t limit, struct file_bytes *out, struct error *error) {
    *out = (struct file_bytes){0};
    int descriptor = open_for_reading(path, error);
    return descriptor >= 0 && file_map_descriptor(descriptor, path, limit, out, error);
}

bool file_source_open(struct file_source *source, const char *path, struct error *error) {
    *source = (struct file_source){.descriptor = open_for_reading(path, error)};
    if (source->descriptor < 0)
        return false;
    source->open = regular_size(source->descriptor, path, &source->size, error);
    if (!source->open)
        (void)close(source->descriptor);
    return source->open;
}

bool file_source_read(const struct file_source *source, uint64_t at, void *out, size_t size) {
    for (size_t have = 0; have < size;) {
        ssize_t got = MAY_FAIL(pread(source->descriptor, (char *)out + have, size - have, (off_t)(at + have)));
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        have += (size_t)got;
    }
    return true;
}

void file_source_close(struct file_source *source) {
    if (source->open)
        (void)close(source->descriptor);
    *source = (struct file_source){0};
}

void file_unmap(struct file_bytes *bytes) {
    if (bytes->size)
        mem_free((void *)(uintptr_t)bytes->data);
    *bytes = (struct file_bytes){0};
}

bool file_exists(const char *path) {
    struct stat status;
    return lstat(path, &status) == 0;
}

bool file_is_regular(const char *path) {
    struct stat status;
    file_note_search();
    return stat(path, &status) == 0 && S_ISREG(status.st_mode);
}

bool file_is_folder(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

int file_open_folder_of(const char *path) {
    return MAY_FAIL(open(path, O_PATH | O_CLOEXEC));
}

void file_fill_standard(void) {
    for (int descriptor = 0; descriptor <= 2; descriptor++) {
        /* The lowest free number each time. It is read-only, so that writing to it is an error; where there is no
         * /dev/null, an epoll descriptor needs no file and can be neither read nor written. */
        if (fcntl(descriptor, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0 && epoll_create1(0) < 0)
            return;
    }
}

bool file_null_input(void) {
    int descriptor = open("/dev/null", O_RDONLY | O_CLOEXEC);
    bool done = descriptor >= 0 && dup2(descriptor, STDIN_FILENO) == STDIN_FILENO;
    if (descriptor > STDIN_FILENO)
        (void)close(descriptor);
    return done;
}

bool file_canonical(const char *path, char *out, size_t size) {
    char resolved[PATH_MAX];
    file_note_search();
    const char *found = MAY_GIVE_NULL(realpath(path, resolved));
    if (!found || strlen(found) >= size)
        return false;
    memcpy(out, resolved, strlen(resolved) + 1);
    return true;
}

/* A location where the file cannot be created is a wrong name; a full disk is not. */
enum error_kind file_refusal_kind(int number) {
    switch (number) {
    case ENOENT:
    case ENOTDIR:
    case EISDIR:
    case EEXIST:
    case EACCES:
    case EPERM:
    case EROFS:
    case ELOOP:
    case ENAMETOOLONG:
        return ERROR_SCENE;
    default:
        return ERROR_MACHINE;
    }
}

bool file_make_temporary_folder(char *out, size_t size, struct error *error) {
    const char *parent = getenv("TMPDIR");
    int length = snprintf(out, size, "%s/gray-XXXXXX", parent && parent[0] == '/' ? parent : "/tmp");
    if (length < 0 || (size_t)length >= size)
        return error_set(error, ERROR_MACHINE, "the name of the temporary folder is too long");
    return mkdtemp(out) || error_set(error, ERROR_MACHINE, "%s: cannot be created: %s", out, strerror(errno));
}

static bool remove_entry(void *context, const char *name) {
    const int *folder = context;
    (void)unlinkat(*folder, name, 0);
    return true;
}

void file_remove_temporary_folder(const char *folder) {
    int descriptor = open(folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor >= 0) {
        file_list(folder, 64, remove_entry, &descriptor);
        (void)close(descriptor);
    }
    (void)rmdir(folder);
}

bool file_remove_empty_folder(const char *folder) {
    return rmdir(folder) == 0;
}

bool file_make_folders_for(const char *path, struct error *error) {
    char folder[4096];
    size_t length = strlen(path);
    if (length >= sizeof folder)
        return error_set(error, ERROR_SCENE, "%.100s...: the file name is longer than %zu bytes", path,
                         sizeof folder - 1);
    memcpy(folder, path, length + 1);
    for (char *at = folder + 1; (at = strchr(at, '/')) != NULL; at++) {
        *at = '\0';
        if (MAY_FAIL(mkdir(folder, 0777)) != 0 && errno != EEXIST)
            return error_set(error, file_refusal_kind(errno), "%s: the folder %s cannot be made: %s", path, folder,
                             strerror(errno));
        *at = '/';
    }
    return true;
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

bool file_list(const char *folder, size_t limit, bool (*fn)(void *context, const char *name), void *context) {
    DIR *stream = opendir(folder);
    if (!stream)
        return false;
    char **names = mem_alloc_zero(limit ? limit : 1, sizeof *names);
    size_t count = 0;
    for (struct dirent *entry; names && count < limit && (entry = readdir(stream)) != NULL;) {
        size_t length = strlen(entry->d_name);
        if (entry->d_name[0] == '.')
            continue;
        names[count] = mem_alloc(length + 1);
        if (!names[count])
            break;
        memcpy(names[count++], entry->d_name, length + 1);
    }
    (void)closedir(stream);
    /* The order of a folder differs between machines. */
    if (names)
        qsort(names, count, sizeof *names, compare_names);
    /* All names are freed, also after a refusal. */
    bool go_on = names != NULL;
    for (size_t i = 0; i < count; i++) {
        go_on = go_on && fn(context, names[i]);
        mem_free(names[i]);
    }
    mem_free(names);
    return true;
}
