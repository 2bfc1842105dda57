/* Files. Everything that leaves a name in a folder goes through struct file_output: the temporary file stands beside
 * the target (a rename works only inside one file system), has no name until it is whole, and then one by chance, so
 * that two runs cannot mix. */
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
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

/* Where file_set_witness and file_set_listener say: the two things here that outlive a call. */
static struct file_witness *file_witness;
static const struct file_listener *file_listener;

void file_set_witness(struct file_witness *witness) {
    file_witness = witness;
}

void file_set_listener(const struct file_listener *listener) {
    file_listener = listener;
}

static void note_content(struct digest content) {
    struct file_witness *witness = file_witness;
    for (size_t i = 0; i < witness->count; i++) {
        if (digest_equal(witness->contents[i], content))
            return;
    }
    if (witness->count == witness->room) {
        size_t room = witness->room ? 2 * witness->room : 16;
        struct digest *more = mem_resize(witness->contents, room * sizeof *more);
        if (!more) {
            witness->incomplete = true;
            return;
        }
        witness->contents = more;
        witness->room = room;
    }
    witness->contents[witness->count++] = content;
}

/* False: it could not be read to its end. */
static bool digest_of(int descriptor, struct digest *content) {
    char piece[1 << 16];
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
    return (struct file_version){.size = (uint64_t)status->st_size,
                                 .seconds = (int64_t)status->st_mtim.tv_sec,
                                 .nanoseconds = (int64_t)status->st_mtim.tv_nsec};
}

void file_note_read(int descriptor, const char *path) {
    struct stat status;
    if ((!file_witness && !file_listener) || MAY_FAIL(fstat(descriptor, &status)) != 0 || !S_ISREG(status.st_mode))
        return;
    struct file_version version = version_of(&status);
    bool whole = digest_of(descriptor, &version.content);
    if (file_witness && !whole)
        file_witness->incomplete = true;
    if (file_witness)
        note_content(version.content);
    if (file_listener)
        file_listener->heard(file_listener->context, path, &version);
}

bool file_version_of(const char *path, const struct file_version *known, struct file_version *out) {
    struct stat status;
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0)
        return false;
    bool ok = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
    if (ok) {
        *out = version_of(&status);
        bool same = known && known->size == out->size && known->seconds == out->seconds &&
                    known->nanoseconds == out->nanoseconds;
        out->content = same ? known->content : (struct digest){0};
        ok = same || digest_of(descriptor, &out->content);
    }
    (void)close(descriptor);
    return ok;
}

struct digest file_witness_sum(const struct file_witness *witness) {
    struct digest sum = {witness->count, 0};
    for (size_t i = 0; i < witness->count; i++) {
        struct digest one = digest_bytes(&witness->contents[i], sizeof witness->contents[i], (struct digest){0});
        sum.a += one.a;
        sum.b += one.b;
    }
    return sum;
}

void file_witness_destroy(struct file_witness *witness) {
    if (file_witness == witness)
        file_witness = NULL;
    mem_free(witness->contents);
    *witness = (struct file_witness){0};
}

bool file_map_descriptor(int descriptor, const char *path, size_t limit, struct file_bytes *out, struct error *error) {
    *out = (struct file_bytes){0};
    struct stat status;
    bool ok = false;
    if (MAY_FAIL(fstat(descriptor, &status)) != 0) {
        error_set(error, ERROR_SCENE, "%s: cannot be read: %s", path, strerror(errno));
    } else if (!S_ISREG(status.st_mode)) {
        error_set(error, ERROR_SCENE, "%s: is %s, not a regular file", path,
                  S_ISDIR(status.st_mode) ? "a folder" : "a pipe or device");
    } else if ((uint64_t)status.st_size > limit) {
        error_set(error, ERROR_SCENE, "%s: %lld bytes are more than the limit of %zu", path, (long long)status.st_size,
                  limit);
    } else if (status.st_size == 0) {
        out->data = (const uint8_t *)"";
        ok = true;
    } else {
        /* A private copy rather than a mapping: a file that shrinks while it is mapped would kill the process. */
        size_t size = (size_t)status.st_size, have = 0;
        uint8_t *data = mem_alloc(size);
        if (!data) {
            (void)close(descriptor);
            return error_no_memory(error, path);
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

bool file_map(const char *path, size_t limit, struct file_bytes *out, struct error *error) {
    *out = (struct file_bytes){0};
    /* O_NONBLOCK: opening a named pipe must not wait for a writer. */
    int descriptor = MAY_FAIL(open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (descriptor < 0)
        return error_set(error, ERROR_SCENE, "%s: cannot be read: %s", path, strerror(errno));
    return file_map_descriptor(descriptor, path, limit, out, error);
}

void file_unmap(struct file_bytes *bytes) {
    if (bytes->size)
        mem_free((void *)(uintptr_t)bytes->data);
    *bytes = (struct file_bytes){0};
}

bool file_is_regular(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && S_ISREG(status.st_mode);
}

bool file_is_folder(const char *path) {
    struct stat status;
    return stat(path, &status) == 0 && S_ISDIR(status.st_mode);
}

int file_open_place(const char *path) {
    return MAY_FAIL(open(path, O_PATH | O_CLOEXEC));
}

void file_fill_standard(void) {
    for (int descriptor = 0; descriptor <= 2; descriptor++) {
        /* The lowest free one is taken; opened for reading only, so that writing is the error it should be. */
        if (fcntl(descriptor, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0)
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
    const char *found = MAY_GIVE_NULL(realpath(path, resolved));
    if (!found || strlen(found) >= size)
        return false;
    memcpy(out, resolved, strlen(resolved) + 1);
    return true;
}

/* A place that cannot hold the file is a wrong name; a full disk is none. */
static enum error_kind kind_of_refusal(int number) {
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

bool file_remove(const char *path, struct error *error) {
    if (unlink(path) == 0 || errno == ENOENT)
        return true;
    return error_set(error, kind_of_refusal(errno), "%s: cannot be removed: %s", path, strerror(errno));
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
            return error_set(error, kind_of_refusal(errno), "%s: the folder %s cannot be made: %s", path, folder,
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
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        names[count] = mem_alloc(length + 1);
        if (!names[count])
            break;
        memcpy(names[count++], entry->d_name, length + 1);
    }
    (void)closedir(stream);
    if (names)
        qsort(names, count, sizeof *names, compare_names);
    bool go_on = names != NULL;
    for (size_t i = 0; i < count; i++) {
        go_on = go_on && fn(context, names[i]);
        mem_free(names[i]);
    }
    mem_free(names);
    return true;
}

static bool is_direct_target(const char *target) {
    struct stat status;
    return strcmp(target, "-") == 0 ||
           (stat(target, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode));
}

/* The folder of a path with its final slash, "" when it has none. */
static int folder_length(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? (int)(slash - path) + 1 : 0;
}

/* A name that nobody can have prepared, in the target's folder: the length of the target's own name does not matter. */
static void name_temporary(struct file_output *file) {
    uint64_t number = 0;
    if (getrandom(&number, sizeof number, 0) != (ssize_t)sizeof number)
        number = (uint64_t)getpid();
    (void)snprintf(file->temporary, sizeof file->temporary, "%.*s.gray.part-%016llx", folder_length(file->target),
                   file->target, (unsigned long long)number);
}

/* A file without a name, where the file system knows such files (O_TMPFILE, Linux 3.11): even a kill leaves nothing
 * behind. It gets its name when it is whole. Elsewhere a new file under a name of its own. */
static int open_temporary(struct file_output *file) {
    char folder[sizeof file->target + 2];
    (void)snprintf(folder, sizeof folder, "%.*s.", folder_length(file->target), file->target);
    int descriptor = MAY_FAIL(open(folder, O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666));
    if (descriptor >= 0) {
        file->nameless = true;
        return descriptor;
    }
    for (int i = 0; i < 100; i++) {
        name_temporary(file);
        descriptor = MAY_FAIL(open(file->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
        if (descriptor >= 0 || errno != EEXIST)
            break;
    }
    return descriptor;
}

/* False with errno. */
static bool give_name(struct file_output *file) {
    char link[64];
    (void)snprintf(link, sizeof link, "/proc/self/fd/%d", file->descriptor);
    for (int i = 0; i < 100; i++) {
        name_temporary(file);
        if (MAY_FAIL(linkat(AT_FDCWD, link, AT_FDCWD, file->temporary, AT_SYMLINK_FOLLOW)) == 0) {
            file->nameless = false;
            return true;
        }
        if (errno != EEXIST)
            return false;
    }
    return false;
}

bool file_output_open(struct file_output *file, const char *target, struct error *error) {
    memset(file, 0, sizeof *file);
    if (target[0] == '\0')
        return error_set(error, ERROR_SCENE, "the name of the output file is empty");
    if (strlen(target) >= sizeof file->target)
        return error_set(error, ERROR_SCENE, "%.100s...: the file name is longer than %zu bytes", target,
                         sizeof file->target - 1);
    const char *name = strcmp(target, "-") == 0 ? "standard output" : target;
    memcpy(file->target, name, strlen(name) + 1);
    if (file_is_folder(target))
        return error_set(error, ERROR_SCENE, "%s: is a folder, a picture cannot be written there", target);
    file->direct = is_direct_target(target);
    if (file->direct) {
        file->descriptor = MAY_FAIL(strcmp(target, "-") == 0 ? dup(STDOUT_FILENO) : open(target, O_WRONLY | O_CLOEXEC));
    } else {
        if (!file_make_folders_for(target, error))
            return false;
        file->descriptor = open_temporary(file);
    }
    if (file->descriptor < 0)
        return error_set(error, kind_of_refusal(errno), "%s: cannot be written: %s", target, strerror(errno));
    file->open = true;
    return true;
}

bool file_output_write(struct file_output *file, const void *data, size_t size, struct error *error) {
    const char *at = data;
    while (size > 0) {
        ssize_t done = MAY_FAIL(write(file->descriptor, at, size));
        if (done < 0 && errno == EINTR)
            continue;
        if (done <= 0)
            return error_set(error, ERROR_MACHINE, "%s: cannot be written: %s", file->target, strerror(errno));
        at += done;
        size -= (size_t)done;
        file->written += (uint64_t)done;
    }
    return true;
}

/* The rename is on disk only when the folder is. Some file systems refuse to sync a folder; that is no loss of ours. */
static void sync_folder_of(const char *target) {
    char folder[4096];
    const char *slash = strrchr(target, '/');
    size_t length = slash ? (size_t)(slash - target) : 0;
    if (!slash)
        memcpy(folder, ".", 2);
    else if (length == 0)
        memcpy(folder, "/", 2);
    else {
        memcpy(folder, target, length);
        folder[length] = '\0';
    }
    int descriptor = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor >= 0) {
        (void)fsync(descriptor);
        (void)close(descriptor);
    }
}

/* Closed in any case, also where the system reports a late failure of writing. */
static int close_reliably(int descriptor) {
    int result = close(descriptor);
    return MAY_FAIL(result);
}

bool file_output_commit(struct file_output *file, struct error *error) {
    bool ok = true;
    struct stat status;
    if (!file->direct) {
        if (stat(file->target, &status) == 0)
            (void)fchmod(file->descriptor, status.st_mode & 07777);
        ok = MAY_FAIL(fsync(file->descriptor)) == 0 && (!file->nameless || give_name(file));
    }
    int saved = errno;
    if (close_reliably(file->descriptor) != 0 && ok) {
        ok = false;
        saved = errno;
    }
    file->open = false;
    if (!file->direct && ok && MAY_FAIL(rename(file->temporary, file->target)) != 0) {
        ok = false;
        saved = errno;
    }
    if (!ok) {
        if (!file->direct && !file->nameless)
            (void)unlink(file->temporary);
        return error_set(error, ERROR_MACHINE, "%s: cannot be written: %s", file->target, strerror(saved));
    }
    if (!file->direct)
        sync_folder_of(file->target);
    return true;
}

void file_output_abandon(struct file_output *file) {
    if (!file->open)
        return;
    (void)close(file->descriptor);
    file->open = false;
    if (!file->direct && !file->nameless)
        (void)unlink(file->temporary);
}
