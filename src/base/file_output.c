/* A file is written without a name (O_TMPFILE, Linux 3.11), synced, and then given its name. A new name is given by
 * linkat(2), which fails if the name exists; an existing file is exchanged with the new one (RENAME_EXCHANGE,
 * Linux 3.15), inspected again under the temporary name, and only then removed. So whatever another process does to the
 * name in between, nothing is removed that was not inspected.
 *
 * A temporary name exists only between linkat and the removal of the old file. A kill in between leaves it; the
 * next run that writes into the folder removes it after a minute, and one that has the folder for itself (a lock) at
 * its end. Every temporary file is locked (flock) by the process that writes it, so
 * that an unlocked one is a leftover, from any machine. */
#define _GNU_SOURCE
#include "base/file_output.h"

#include "base/fault.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/fs.h>
#include <linux/stat.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static const struct file_rules no_rules;
static const char temporary_prefix[] = ".gray.part-";
/* As renameat2(2), which not every C library has a function for. */
static int rename_in(int folder, const char *from, const char *to, unsigned flags) {
    return (int)syscall(SYS_renameat2, folder, from, folder, to, flags);
}

enum { TEMPORARY_DIGITS = 16, LEFTOVER_SECONDS = 60, TRIES = 100 };

void file_guard_destroy(struct file_guard *guard) {
    file_set_destroy(&guard->kept);
    for (int role = 0; role < FILE_ROLES; role++)
        file_set_destroy(&guard->own[role]);
    file_set_destroy(&guard->cleaned);
}

static const struct file_rules *rules_of(const struct file_target *target) {
    return target->rules ? target->rules : &no_rules;
}

static struct file_identity identity_of(const struct stat *status) {
    return (struct file_identity){(uint64_t)status->st_dev, (uint64_t)status->st_ino};
}

static bool same_file(struct file_identity a, struct file_identity b) {
    return a.device == b.device && a.inode == b.inode;
}

static const char *advice_of(const struct file_rules *rules) {
    return rules->advice ? rules->advice : "";
}

static bool refuse(struct error *error, const struct file_output *file, const char *what) {
    return error_set(error, ERROR_SCENE, "%.600s: %s%s", file->target, what, advice_of(file->rules));
}

static bool cannot_write(struct error *error, const struct file_output *file, int number) {
    return error_set(error, file_refusal_kind(number), "%.600s: cannot be written: %s", file->target, strerror(number));
}

/* The position of the file. */

static bool set_target(struct file_output *file, const struct file_target *target, struct error *error) {
    memset(file, 0, sizeof *file);
    file->descriptor = file->folder = -1;
    file->rules = rules_of(target);
    file->identity = target->written;
    if (target->path[0] == '\0')
        return error_set(error, ERROR_SCENE, "the name of the output file is empty");
    if (strlen(target->path) >= sizeof file->target)
        return error_set(error, ERROR_SCENE, "%.100s...: the file name is longer than %zu bytes", target->path,
                         sizeof file->target - 1);
    memcpy(file->target, target->path, strlen(target->path) + 1);
    const char *slash = strrchr(file->target, '/');
    file->leaf = slash ? slash + 1 : file->target;
    return true;
}

/* The folder part with a final "."; false: too long. */
static bool folder_of(const char *path, char folder[FILE_NAME_SIZE]) {
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) + 1 : 0;
    if (length + 2 > FILE_NAME_SIZE)
        return false;
    memcpy(folder, path, length);
    memcpy(folder + length, ".", 2);
    return true;
}

static bool open_folder(struct file_output *file, struct error *error) {
    const struct file_rules *rules = file->rules;
    char folder[FILE_NAME_SIZE];
    if (file->leaf[0] == '\0' || strcmp(file->leaf, ".") == 0 || strcmp(file->leaf, "..") == 0)
        return error_set(error, ERROR_SCENE, "%.600s: is a folder, a picture cannot be written there", file->target);
    if (rules->folders) {
        file->folder = path_policy_open_folder(rules->folders, file->target);
    } else {
        if (!file_make_folders_for(file->target, error))
            return false;
        file->folder = folder_of(file->target, folder) ? MAY_FAIL(open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC))
                                                       : (errno = ENAMETOOLONG, -1);
    }
    return file->folder >= 0 || cannot_write(error, file, errno);
}

bool file_is_same_folder(const char *a, const char *b) {
    const char *paths[2] = {a, b}, *leaves[2];
    struct stat status[2];
    for (int i = 0; i < 2; i++) {
        char folder[FILE_NAME_SIZE];
        const char *slash = strrchr(paths[i], '/');
        leaves[i] = slash ? slash + 1 : paths[i];
        if (!folder_of(paths[i], folder) || stat(folder, &status[i]) != 0)
            return strcmp(a, b) == 0;
    }
    return same_file(identity_of(&status[0]), identity_of(&status[1])) && strcmp(leaves[0], leaves[1]) == 0;
}

/* The existing file. */

/* The first bytes of the regular file of `handle` (O_PATH); -1: it cannot be read. */
static ssize_t read_head(int handle, uint8_t head[FILE_HEAD_SIZE]) {
    char name[64];
    (void)snprintf(name, sizeof name, "/proc/self/fd/%d", handle);
    int descriptor = MAY_FAIL(open(name, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
    if (descriptor < 0)
        return -1;
    ssize_t got = MAY_FAIL(pread(descriptor, head, FILE_HEAD_SIZE, 0));
    (void)close(descriptor);
    return got;
}

static bool is_standard_stream(struct file_identity identity) {
    struct file_identity stream;
    return (file_identity_of_descriptor(STDOUT_FILENO, &stream) && same_file(stream, identity)) ||
           (file_identity_of_descriptor(STDERR_FILENO, &stream) && same_file(stream, identity));
}

/* A file that this run wrote in the same role may be replaced even after it was read. */
static bool is_kept(const struct file_rules *rules, struct file_identity identity) {
    const struct file_guard *guard = rules->guard;
    if (rules->role != FILE_ROLE_NONE && file_set_has(&guard->own[rules->role], identity))
        return false;
    for (int role = 0; role < FILE_ROLES; role++) {
        if (file_set_has(&guard->own[role], identity))
            return true;
    }
    return file_set_has(&guard->kept, identity) || is_standard_stream(identity);
}

/* Whether a regular file may be replaced. */
static bool may_replace(const struct file_output *file, int handle, const struct stat *status, struct error *error) {
    const struct file_rules *rules = file->rules;
    struct file_identity identity = identity_of(status);
    uint8_t head[FILE_HEAD_SIZE] = {0};
    if (rules->never_replace)
        return error_set(error, ERROR_SCENE, "%.600s: exists already", file->target);
    if (rules->guard && is_kept(rules, identity))
        return refuse(error, file, "is a file that this run reads or uses for another purpose, and is not replaced");
    if (!rules->may_replace || status->st_size == 0 || rules->force)
        return true;
    ssize_t size = read_head(handle, head);
    if (size < 0)
        return error_set(error, ERROR_SCENE, "%.600s: cannot be read (%s), so it may be something else than %s%s",
                         file->target, strerror(errno), rules->expected, advice_of(rules));
    if (rules->may_replace(head, (size_t)size))
        return true;
    return error_set(error, ERROR_SCENE, "%.600s: exists already and is not %s%s", file->target, rules->expected,
                     rules->named_by_user ? "; --force replaces it" : advice_of(rules));
}

/* Whether this process could later exchange or remove the file with this name, as far as can be known. */
static bool can_be_renamed(const struct file_output *file, const struct stat *status, struct error *error) {
    struct statx more;
    struct stat folder;
    const uint64_t fixed = STATX_ATTR_IMMUTABLE | STATX_ATTR_APPEND;
    uid_t user = geteuid();
    if (syscall(SYS_statx, file->folder, file->leaf, AT_SYMLINK_NOFOLLOW, 0, &more) == 0) {
        if (more.stx_attributes & fixed)
            return cannot_write(error, file, EPERM);
        if (more.stx_attributes & STATX_ATTR_MOUNT_ROOT)
            return cannot_write(error, file, EBUSY);
    }
    bool sticky = fstat(file->folder, &folder) == 0 && (folder.st_mode & S_ISVTX);
    if (sticky && user != 0 && user != status->st_uid && user != folder.st_uid)
        return cannot_write(error, file, EPERM);
    return true;
}

static const char *kind_of_file(mode_t mode) {
    return S_ISFIFO(mode) ? "a named pipe" : S_ISSOCK(mode) ? "a socket" : "a device";
}

/* Inspects the file with this name; opens only regular files. *there: there is a file that may be replaced, with this
 * status. */
static bool inspect(const struct file_output *file, bool *there, struct stat *status, struct error *error) {
    char text[96];
    *there = false;
    int handle = MAY_FAIL(openat(file->folder, file->leaf, O_PATH | O_NOFOLLOW | O_CLOEXEC));
    if (handle < 0)
        return errno == ENOENT || cannot_write(error, file, errno);
    bool ok = MAY_FAIL(fstat(handle, status)) == 0;
    if (!ok) {
        (void)cannot_write(error, file, errno);
    } else if (S_ISDIR(status->st_mode)) {
        ok = error_set(error, ERROR_SCENE, "%.600s: is a folder, a picture cannot be written there", file->target);
    } else if (S_ISLNK(status->st_mode)) {
        ok = refuse(error, file, "is a symbolic link, which is not replaced and not followed");
    } else if (!S_ISREG(status->st_mode)) {
        (void)snprintf(text, sizeof text, "is %s, and nothing is written to it", kind_of_file(status->st_mode));
        ok = refuse(error, file, text);
    } else {
        ok = may_replace(file, handle, status, error) && can_be_renamed(file, status, error);
    }
    (void)close(handle);
    *there = ok;
    return ok;
}

/* Leftovers. */

static bool is_temporary_name(const char *name) {
    size_t prefix = sizeof temporary_prefix - 1;
    if (strncmp(name, temporary_prefix, prefix) != 0 || strlen(name) != prefix + TEMPORARY_DIGITS)
        return false;
    for (const char *at = name + prefix; *at; at++) {
        if (!(*at >= '0' && *at <= '9') && !(*at >= 'a' && *at <= 'f'))
            return false;
    }
    return true;
}

static bool is_old_and_ours(const struct stat *status, time_t seconds) {
    struct timespec now;
    if (!S_ISREG(status->st_mode) || status->st_uid != geteuid() || clock_gettime(CLOCK_REALTIME, &now) != 0)
        return false;
    time_t changed = status->st_ctim.tv_sec > status->st_mtim.tv_sec ? status->st_ctim.tv_sec : status->st_mtim.tv_sec;
    return now.tv_sec - changed >= seconds;
}

/* The lock decides: the process that writes the file holds it, on any machine. */
static void remove_leftover(int folder, const char *name, time_t seconds) {
    struct stat before, after;
    if (fstatat(folder, name, &before, AT_SYMLINK_NOFOLLOW) != 0 || !is_old_and_ours(&before, seconds))
        return;
    int descriptor = openat(folder, name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (descriptor < 0)
        return;
    bool same = fstat(descriptor, &after) == 0 && same_file(identity_of(&before), identity_of(&after));
    if (same && flock(descriptor, LOCK_EX | LOCK_NB) == 0 && fstatat(folder, name, &after, AT_SYMLINK_NOFOLLOW) == 0 &&
        same_file(identity_of(&before), identity_of(&after)))
        (void)unlinkat(folder, name, 0);
    (void)close(descriptor);
}

static void remove_leftovers(int folder, time_t seconds) {
    int descriptor = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *stream = descriptor < 0 ? NULL : fdopendir(descriptor);
    if (!stream) {
        if (descriptor >= 0)
            (void)close(descriptor);
        return;
    }
    for (struct dirent *entry; (entry = readdir(stream)) != NULL;) {
        if (is_temporary_name(entry->d_name))
            remove_leftover(folder, entry->d_name, seconds);
    }
    (void)closedir(stream);
}

static void clean_folder(const struct file_output *file) {
    struct file_guard *guard = file->rules->guard;
    struct file_identity identity;
    if (guard && file_identity_of_descriptor(file->folder, &identity) && !file_set_has(&guard->cleaned, identity) &&
        file_set_add(&guard->cleaned, identity))
        remove_leftovers(file->folder, LEFTOVER_SECONDS);
}

/* The temporary file. */

static void choose_temporary_name(struct file_output *file) {
    uint64_t number = 0;
    if (getrandom(&number, sizeof number, 0) != (ssize_t)sizeof number)
        number = (uint64_t)getpid();
    (void)snprintf(file->temporary, sizeof file->temporary, "%s%016llx", temporary_prefix, (unsigned long long)number);
}

/* False with errno. A file system without O_TMPFILE gets a new file under a temporary name. */
static bool open_temporary(struct file_output *file) {
    file->descriptor = MAY_FAIL(openat(file->folder, ".", O_TMPFILE | O_RDWR | O_CLOEXEC, 0666));
    file->nameless = file->descriptor >= 0;
    for (int i = 0; i < TRIES && file->descriptor < 0; i++) {
        choose_temporary_name(file);
        file->descriptor =
            MAY_FAIL(openat(file->folder, file->temporary, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
        file->named = file->descriptor >= 0;
        if (file->descriptor < 0 && errno != EEXIST)
            break;
    }
    if (file->descriptor >= 0)
        (void)flock(file->descriptor, LOCK_EX | LOCK_NB);
    return file->descriptor >= 0;
}

static bool link_as(struct file_output *file, const char *name) {
    char source[64];
    (void)snprintf(source, sizeof source, "/proc/self/fd/%d", file->descriptor);
    return MAY_FAIL(linkat(AT_FDCWD, source, file->folder, name, AT_SYMLINK_FOLLOW)) == 0;
}

/* False with errno. */
static bool name_temporary(struct file_output *file) {
    for (int i = 0; i < TRIES && !file->named; i++) {
        choose_temporary_name(file);
        file->named = link_as(file, file->temporary);
        if (!file->named && errno != EEXIST)
            return false;
    }
    file->nameless = file->nameless && !file->named;
    return file->named;
}

static void remove_temporary(struct file_output *file) {
    if (file->named)
        (void)unlinkat(file->folder, file->temporary, 0);
    file->named = false;
}

static void close_all(struct file_output *file) {
    remove_temporary(file);
    if (file->descriptor >= 0)
        (void)close(file->descriptor);
    if (file->folder >= 0)
        (void)close(file->folder);
    file->descriptor = file->folder = -1;
    file->open = file->nameless = false;
}

/* Pipes and devices. */

enum wait_end { WAIT_READY, WAIT_TIME, WAIT_STOPPED };

/* Waits until the descriptor is ready (-1: only the time counts), the time is over, or the run must end. */
static enum wait_end wait_for(const struct file_output *file, short events, int milliseconds) {
    const struct file_interrupt *interrupt = file->rules->interrupt;
    for (;;) {
        struct pollfd watched[2] = {{.fd = file->descriptor, .events = events},
                                    {.fd = interrupt ? interrupt->descriptor : -1, .events = POLLIN}};
        int ready = poll(watched, 2, milliseconds);
        if (ready < 0 && errno != EINTR)
            return WAIT_READY; /* the write reports the error */
        if (ready > 0 && watched[1].revents && interrupt->stopped(interrupt->context))
            return WAIT_STOPPED;
        if (ready > 0 && watched[0].revents)
            return WAIT_READY;
        if (ready == 0)
            return WAIT_TIME;
    }
}

bool file_interrupted(const struct file_interrupt *interrupt, int milliseconds) {
    struct pollfd watched = {.fd = interrupt && interrupt->stopped ? interrupt->descriptor : -1, .events = POLLIN};
    return poll(&watched, 1, milliseconds) > 0 && watched.revents && interrupt->stopped(interrupt->context);
}

static bool interrupted(struct error *error, const struct file_output *file) {
    return error_set(error, ERROR_CANCELLED, "%.600s: interrupted while it was written", file->target);
}

/* Waits for the reader of a named pipe. */
static bool open_direct(struct file_output *file, struct error *error) {
    struct stat status;
    for (;;) {
        file->descriptor = MAY_FAIL(open(file->target, O_WRONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
        if (file->descriptor >= 0)
            break;
        bool waits = errno == ENXIO && stat(file->target, &status) == 0 && S_ISFIFO(status.st_mode);
        if (!waits)
            return cannot_write(error, file, errno);
        if (wait_for(file, 0, 20) == WAIT_STOPPED)
            return interrupted(error, file);
    }
    if (fstat(file->descriptor, &status) == 0 && !S_ISREG(status.st_mode))
        return true;
    (void)close(file->descriptor);
    file->descriptor = -1;
    return error_set(error, ERROR_SCENE, "%.600s: has become a regular file while it was opened", file->target);
}

/* Opens the target of -o: standard output, or the pipe or device at the end of its links. */
static bool find_direct(struct file_output *file, const struct file_target *target, struct error *error) {
    struct stat status, link;
    struct file_identity stream;
    if (!file->rules->is_direct)
        return true;
    bool standard = strcmp(target->path, "-") == 0;
    if (!standard && stat(target->path, &status) == 0) {
        bool is_link = lstat(target->path, &link) == 0 && S_ISLNK(link.st_mode);
        /* /dev/stdout leads to a file: the shell has already opened it. */
        standard = is_link && S_ISREG(status.st_mode) && file_identity_of_descriptor(STDOUT_FILENO, &stream) &&
                   same_file(stream, identity_of(&status));
        if (S_ISSOCK(status.st_mode))
            return refuse(error, file, "is a socket, and nothing is written to it");
        file->direct = !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
    }
    if (standard) {
        file->direct = true;
        (void)snprintf(file->target, sizeof file->target, "standard output");
        /* If standard output was closed, another descriptor may have its number (a library's epoll). */
        int flags = fcntl(STDOUT_FILENO, F_GETFL);
        if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY || fstat(STDOUT_FILENO, &status) != 0 ||
            (status.st_mode & S_IFMT) == 0)
            return cannot_write(error, file, EBADF);
    }
    return true;
}

/* Opening, checking. */

bool file_output_check(const struct file_target *target, struct error *error) {
    struct file_output file;
    struct stat status;
    bool there;
    if (!set_target(&file, target, error) || !find_direct(&file, target, error))
        return false;
    if (file.direct) {
        bool ok = strcmp(file.target, "standard output") == 0 || access(file.target, W_OK) == 0;
        return ok || cannot_write(error, &file, errno);
    }
    if (!open_folder(&file, error))
        return false;
    clean_folder(&file);
    bool ok = inspect(&file, &there, &status, error) && (open_temporary(&file) || cannot_write(error, &file, errno));
    close_all(&file);
    return ok;
}

bool file_output_open(struct file_output *file, const struct file_target *target, struct error *error) {
    struct stat status;
    bool there, ok;
    if (!set_target(file, target, error) || !find_direct(file, target, error))
        return false;
    if (file->direct && strcmp(file->target, "standard output") == 0) {
        file->descriptor = MAY_FAIL(fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3));
        ok = file->descriptor >= 0 || cannot_write(error, file, errno);
    } else if (file->direct) {
        ok = open_direct(file, error);
    } else {
        ok = open_folder(file, error) && inspect(file, &there, &status, error) &&
             (open_temporary(file) || cannot_write(error, file, errno));
    }
    if (!ok)
        close_all(file);
    file->open = ok;
    return ok;
}

/* The size that a pipe accepts without blocking once poll reports it writable, so that a blocking descriptor does not
 * block here. */
static size_t piece_of(const struct file_output *file, size_t size) {
    return file->direct && size > PIPE_BUF ? PIPE_BUF : size;
}

bool file_output_write(struct file_output *file, const void *data, size_t size, struct error *error) {
    const char *at = data;
    struct file_quota *quota = file->rules->quota;
    if (quota && size > quota->limit - quota->written)
        return error_set_limit(error, "%.600s: is not written: %s", file->target, quota->words);
    if (quota)
        quota->written += size;
    while (size > 0) {
        if (file->direct && wait_for(file, POLLOUT, -1) == WAIT_STOPPED)
            return interrupted(error, file);
        ssize_t done = MAY_FAIL(write(file->descriptor, at, piece_of(file, size)));
        if (done < 0 && (errno == EINTR || (file->direct && errno == EAGAIN)))
            continue;
        if (done <= 0)
            return error_set(error, ERROR_MACHINE, "%.600s: cannot be written: %s", file->target, strerror(errno));
        at += done;
        size -= (size_t)done;
        file->written += (uint64_t)done;
    }
    return true;
}

/* The final name. */

static void sync_folder(const struct file_output *file) {
    /* Some file systems refuse to sync a folder; gray ignores that. */
    int descriptor = openat(file->folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor >= 0) {
        (void)fsync(descriptor);
        (void)close(descriptor);
    }
}

/* Network file systems report a late failure only when a descriptor is closed; the lock needs the other one. */
static bool flush(const struct file_output *file) {
    if (MAY_FAIL(fsync(file->descriptor)) != 0)
        return false;
    int copy = fcntl(file->descriptor, F_DUPFD_CLOEXEC, 3);
    return copy < 0 || MAY_FAIL(close(copy)) == 0;
}

enum step { STEP_DONE, STEP_AGAIN, STEP_FAILED /* errno */, STEP_REFUSED /* error is set */ };

/* Links the file to a name that does not exist. */
static enum step publish_new(struct file_output *file) {
    if (file->nameless) {
        if (link_as(file, file->leaf)) {
            file->nameless = false;
            return STEP_DONE;
        }
        return errno == EEXIST ? STEP_AGAIN : STEP_FAILED;
    }
    if (MAY_FAIL(rename_in(file->folder, file->temporary, file->leaf, RENAME_NOREPLACE)) == 0) {
        file->named = false;
        return STEP_DONE;
    }
    if (errno == EEXIST)
        return STEP_AGAIN;
    if (errno != EINVAL && errno != ENOSYS)
        return STEP_FAILED;
    /* The file system does not support such a rename. */
    if (MAY_FAIL(linkat(file->folder, file->temporary, file->folder, file->leaf, 0)) == 0)
        return STEP_DONE; /* file_output_commit removes the temporary name */
    if (errno == EEXIST)
        return STEP_AGAIN;
    if (MAY_FAIL(renameat(file->folder, file->temporary, file->folder, file->leaf)) != 0)
        return STEP_FAILED;
    file->named = false;
    return STEP_DONE;
}

/* Whether the name is that of the file being written. */
static bool is_at(const struct file_output *file, const char *name) {
    struct stat there, own;
    return fstatat(file->folder, name, &there, AT_SYMLINK_NOFOLLOW) == 0 && fstat(file->descriptor, &own) == 0 &&
           same_file(identity_of(&there), identity_of(&own));
}

/* A file that was not inspected is under the temporary name: exchange both again. If another process has meanwhile
 * removed the new file, there is nothing to exchange with, and the new file has no name. */
static void put_back(struct file_output *file) {
    for (int i = 0; i < 1000 * TRIES; i++) {
        if (rename_in(file->folder, file->temporary, file->leaf, RENAME_EXCHANGE) == 0) {
            if (is_at(file, file->temporary))
                return;
            continue; /* another file came back: exchange again */
        }
        if (errno != ENOENT)
            break;
        if (rename_in(file->folder, file->temporary, file->leaf, RENAME_NOREPLACE) == 0)
            break;
    }
    file->named = false; /* the file that has this name now must not be removed */
}

/* Replaces the inspected file by the new one; *old: the replaced file. */
static enum step publish_over(struct file_output *file, struct stat *old, struct error *error) {
    struct stat now;
    bool there;
    if (!file->named && !name_temporary(file))
        return STEP_FAILED;
    if (MAY_FAIL(rename_in(file->folder, file->temporary, file->leaf, RENAME_EXCHANGE)) == 0) {
        bool same = fstatat(file->folder, file->temporary, &now, AT_SYMLINK_NOFOLLOW) == 0 &&
                    same_file(identity_of(&now), identity_of(old));
        /* Another run may have written the same picture meanwhile: the file that was exchanged may be replaced, too. */
        struct file_output out = *file;
        struct error ignored;
        out.leaf = file->temporary;
        if (same || (inspect(&out, &there, &now, &ignored) && there)) {
            *old = now;
            return STEP_DONE; /* file_output_commit removes the old file */
        }
        put_back(file);
        return STEP_AGAIN;
    }
    if (errno == ENOENT)
        return STEP_AGAIN;
    /* Without exchange a short moment remains between inspection and rename. */
    if (!inspect(file, &there, &now, error))
        return STEP_REFUSED;
    if (!there || !same_file(identity_of(&now), identity_of(old)))
        return STEP_AGAIN;
    if (MAY_FAIL(renameat(file->folder, file->temporary, file->folder, file->leaf)) != 0)
        return STEP_FAILED;
    file->named = false;
    return STEP_DONE;
}

static enum step publish(struct file_output *file, struct error *error) {
    struct file_guard *guard = file->rules->guard;
    enum step step = STEP_AGAIN;
    for (int i = 0; i < TRIES && step == STEP_AGAIN; i++) {
        struct stat old;
        bool there;
        if (!inspect(file, &there, &old, error))
            return STEP_REFUSED;
        if (there) /* a picture needs no x or setuid bits */
            (void)fchmod(file->descriptor, old.st_mode & 0666);
        step = there ? publish_over(file, &old, error) : publish_new(file);
        for (int role = 0; step == STEP_DONE && there && guard && role < FILE_ROLES; role++)
            file_set_remove(&guard->own[role], identity_of(&old));
    }
    if (step == STEP_AGAIN) {
        errno = EBUSY;
        step = STEP_FAILED;
    }
    return step;
}

bool file_output_commit(struct file_output *file, struct error *error) {
    if (file->direct) {
        int result = close(file->descriptor), failed = MAY_FAIL(result);
        int number = errno;
        file->descriptor = -1;
        close_all(file);
        return failed == 0 ||
               error_set(error, ERROR_MACHINE, "%.600s: cannot be written: %s", file->target, strerror(number));
    }
    struct stat status;
    enum step step = flush(file) && fstat(file->descriptor, &status) == 0 ? publish(file, error) : STEP_FAILED;
    if (step == STEP_FAILED)
        (void)error_set(error, ERROR_MACHINE, "%.600s: cannot be written: %s", file->target, strerror(errno));
    if (step == STEP_DONE) {
        const struct file_rules *rules = file->rules;
        if (file->identity)
            *file->identity = identity_of(&status);
        if (rules->guard && rules->role != FILE_ROLE_NONE)
            (void)file_set_add(&rules->guard->own[rules->role], identity_of(&status));
        remove_temporary(
            file); /* before the folder is synced, which may take long: after a kill then, no file remains */
        sync_folder(file);
    }
    close_all(file);
    return step == STEP_DONE;
}

void file_output_abandon(struct file_output *file) {
    if (file->open)
        close_all(file);
}

/* It gets a temporary name first, which no other process uses, so that the inspected file is the one that is
 * removed. */
bool file_output_remove(const struct file_target *target, struct file_identity identity, struct error *error) {
    struct file_output file;
    struct stat status;
    bool there,
        ok = set_target(&file, target, error) && open_folder(&file, error) && inspect(&file, &there, &status, error);
    if (ok && there) {
        choose_temporary_name(&file);
        ok = same_file(identity_of(&status), identity) ||
             error_set(error, ERROR_SCENE, "%.600s: is another file now, and is not removed", file.target);
        bool moved = ok && MAY_FAIL(rename_in(file.folder, file.leaf, file.temporary, RENAME_NOREPLACE)) == 0;
        if (moved && fstatat(file.folder, file.temporary, &status, AT_SYMLINK_NOFOLLOW) == 0 &&
            !same_file(identity_of(&status), identity)) {
            (void)rename_in(file.folder, file.temporary, file.leaf, RENAME_NOREPLACE);
            ok = error_set(error, ERROR_SCENE, "%.600s: is another file now, and is not removed", file.target);
        } else if (ok) {
            ok = MAY_FAIL(unlinkat(file.folder, moved ? file.temporary : file.leaf, 0)) == 0 || errno == ENOENT ||
                 error_set(error, file_refusal_kind(errno), "%.600s: cannot be removed: %s", file.target,
                           strerror(errno));
            if (!ok && moved) /* a file that stays keeps its name */
                (void)rename_in(file.folder, file.temporary, file.leaf, RENAME_NOREPLACE);
        }
    }
    close_all(&file);
    return ok;
}

/* Locks. */

/* Whether the name still denotes the open file: the process that had the lock may have removed it. */
static bool is_named(const struct file_lock *lock) {
    struct stat here, there;
    return fstat(lock->descriptor, &here) == 0 && S_ISREG(here.st_mode) && here.st_size == 0 &&
           fstatat(lock->folder, lock->name, &there, AT_SYMLINK_NOFOLLOW) == 0 &&
           same_file(identity_of(&here), identity_of(&there));
}

void file_lock_forget(struct file_lock *lock) {
    if (lock->open) {
        (void)close(lock->descriptor);
        (void)close(lock->folder);
    }
    lock->open = false;
}

void file_lock_release(struct file_lock *lock) {
    bool last = lock->open && (flock(lock->descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK);
    if (last && is_named(lock)) {
        remove_leftovers(lock->folder, 0);
        (void)unlinkat(lock->folder, lock->name, 0);
    }
    file_lock_forget(lock);
}

enum lock_state { LOCK_TAKEN, LOCK_BUSY, LOCK_LOST };

static enum lock_state try_lock(struct file_lock *lock, int how) {
    const int flags = O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;
    lock->descriptor = MAY_FAIL(openat(lock->folder, lock->name, flags, 0666));
    if (lock->descriptor < 0)
        return LOCK_TAKEN; /* the error of the first file that is written names the reason */
    bool taken = MAY_FAIL(flock(lock->descriptor, how | LOCK_NB)) == 0, busy = !taken && errno == EWOULDBLOCK;
    if (!busy && (!taken || is_named(lock))) {
        lock->open = true;
        return LOCK_TAKEN;
    }
    (void)close(lock->descriptor);
    return busy ? LOCK_BUSY : LOCK_LOST;
}

bool file_lock_take(struct file_lock *lock, const struct file_target *target, bool shared) {
    enum { LOCK_TRIES = 50 };
    const struct timespec pause = {0, 10 * 1000 * 1000};
    struct file_output file;
    struct error ignored;
    *lock = (struct file_lock){0};
    if (!set_target(&file, target, &ignored) || strlen(file.leaf) >= sizeof lock->name || !open_folder(&file, &ignored))
        return true;
    lock->folder = file.folder;
    memcpy(lock->name, file.leaf, strlen(file.leaf) + 1);
    enum lock_state state = LOCK_BUSY;
    for (int i = 0; state != LOCK_TAKEN && i < LOCK_TRIES; i++) {
        state = try_lock(lock, shared ? LOCK_SH : LOCK_EX);
        if (state == LOCK_BUSY)
            (void)nanosleep(&pause, NULL);
    }
    if (!lock->open)
        (void)close(lock->folder);
    return state != LOCK_BUSY;
}
