/* A file may have changed when its folder reports an event with its name; after a moment without events it is read, and
 * only a different content is a change. A removed folder is looked for again at every check. */
#define _GNU_SOURCE
#include "host/file_watch.h"

#include "base/fault.h"
#include "base/mem.h"

#include <errno.h>
#include <string.h>
#include <sys/inotify.h>
#include <unistd.h>

/* Seconds without any event before files are checked. */
static const double quiet_time = 0.06;
static const uint32_t wanted_events = IN_CLOSE_WRITE | IN_MODIFY | IN_CREATE | IN_DELETE | IN_MOVED_FROM | IN_MOVED_TO |
                                      IN_DELETE_SELF | IN_MOVE_SELF | IN_ATTRIB;

bool watch_open(struct watch *watch, struct error *error) {
    *watch = (struct watch){.descriptor = MAY_FAIL(inotify_init1(IN_NONBLOCK | IN_CLOEXEC))};
    if (watch->descriptor < 0)
        return error_set(error, ERROR_MACHINE, "--watch: files cannot be watched: %s", strerror(errno));
    watch->open = true;
    return true;
}

void watch_close(struct watch *watch) {
    if (watch->open)
        (void)close(watch->descriptor);
    for (size_t i = 0; i < watch->count; i++)
        mem_free(watch->files[i].path);
    mem_free(watch->files);
    *watch = (struct watch){0};
}

static void watch_folder(struct watch *watch, struct watched_file *file) {
    char folder[4096] = ".";
    size_t length = (size_t)(file->name - file->path);
    if (length >= sizeof folder)
        return;
    if (length > 0) {
        memcpy(folder, file->path, length);
        folder[length] = '\0';
    }
    file->folder = MAY_FAIL(inotify_add_watch(watch->descriptor, folder, wanted_events));
}

static struct watched_file *find(const struct watch *watch, const char *path) {
    for (size_t i = 0; i < watch->count; i++) {
        if (strcmp(watch->files[i].path, path) == 0)
            return &watch->files[i];
    }
    return NULL;
}

static bool add_one(struct watch *watch, const char *path, const struct file_version *version, double now) {
    struct watched_file *file = find(watch, path);
    size_t length = strlen(path);
    if (!file) {
        if (watch->count == watch->room) {
            size_t room = watch->room ? 2 * watch->room : 16;
            struct watched_file *more = mem_resize(watch->files, room * sizeof *more);
            if (!more)
                return false;
            watch->files = more;
            watch->room = room;
        }
        file = &watch->files[watch->count];
        *file = (struct watched_file){.path = mem_alloc(length + 1)};
        if (!file->path)
            return false;
        watch->count++;
        memcpy(file->path, path, length + 1);
        const char *slash = strrchr(file->path, '/');
        file->name = slash ? slash + 1 : file->path;
        watch_folder(watch, file);
    }
    if (version) {
        file->version = *version;
        file->there = true;
        /* It may have changed between reading it and watching it. */
        file->suspect = true;
        watch->last = now;
    }
    return true;
}

bool watch_add(struct watch *watch, const char *path, const struct file_version *version, double now) {
    char canonical[4096];
    if (!add_one(watch, path, version, now))
        return false;
    /* A link and its target may both change. */
    bool leads_on =
        path[0] != '\0' && file_canonical(path, canonical, sizeof canonical) && strcmp(path, canonical) != 0;
    return !leads_on || add_one(watch, canonical, version, now);
}

void watch_settle(struct watch *watch, bool any, double now) {
    watch_read(watch, now);
    watch->any = any;
    watch->stirred = false;
    for (size_t i = 0; i < watch->count; i++)
        watch->files[i].suspect = true;
    watch->last = now;
}

static void take_event(struct watch *watch, const struct inotify_event *event, double now) {
    bool gone = (event->mask & (IN_IGNORED | IN_DELETE_SELF | IN_MOVE_SELF)) != 0;
    bool lost = (event->mask & IN_Q_OVERFLOW) != 0;
    /* Editors' swap files and our own half-written pictures begin with a dot or end in a tilde. */
    size_t length = event->len > 0 ? strlen(event->name) : 0;
    bool appears = (event->mask & (IN_CREATE | IN_MOVED_TO)) != 0;
    if (appears && length > 0 && event->name[0] != '.' && event->name[length - 1] != '~') {
        watch->stirred = true;
        watch->last = watch->any ? now : watch->last;
    }
    for (size_t i = 0; i < watch->count; i++) {
        struct watched_file *file = &watch->files[i];
        bool here = file->folder == event->wd;
        if (!lost && !(here && (gone || (event->len > 0 && strcmp(file->name, event->name) == 0))))
            continue;
        file->suspect = true;
        watch->last = now;
        if (here && gone)
            file->folder = -1;
    }
}

void watch_read(struct watch *watch, double now) {
    _Alignas(struct inotify_event) char bytes[8192];
    ssize_t got;
    while ((got = read(watch->descriptor, bytes, sizeof bytes)) > 0) {
        for (ssize_t at = 0; at < got;) {
            const struct inotify_event *event = (const void *)(bytes + at);
            take_event(watch, event, now);
            at += (ssize_t)(sizeof *event + event->len);
        }
    }
}

static bool is_lua(const char *path) {
    size_t length = strlen(path);
    return length > 4 && strcmp(path + length - 4, ".lua") == 0;
}

bool watch_changed(struct watch *watch, double now) {
    if (watch->last == 0 || now - watch->last < quiet_time)
        return false;
    bool changed = watch->any && watch->stirred;
    watch->last = 0;
    watch->stirred = false;
    watch->assets_differ = changed;
    for (size_t i = 0; i < watch->count; i++) {
        struct watched_file *file = &watch->files[i];
        struct file_version version = {0};
        if (file->folder < 0)
            watch_folder(watch, file);
        if (!file->suspect)
            continue;
        bool there = file_version_of(file->path, file->there ? &file->version : NULL, &version);
        bool differs = there != file->there || (there && !digest_equal(version.content, file->version.content));
        /* A file may be missing for a moment: only a readable file is compared. */
        file->suspect = false;
        if (!there)
            continue;
        file->there = there;
        file->version = version;
        changed = changed || differs;
        watch->assets_differ = watch->assets_differ || (differs && !is_lua(file->path));
    }
    return changed;
}
