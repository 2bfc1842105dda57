/* Watching files (--watch): which ones the scripts have read, and whether the content of one has changed. Folders
 * are watched, not files (inotify(7)): editors write a new file and rename it over the old one. Changes are found by
 * content, so that a scene that writes a picture and reads it again does not run again endlessly. */
#ifndef GRAY_HOST_FILE_WATCH_H
#define GRAY_HOST_FILE_WATCH_H

#include "base/error.h"
#include "base/file.h"

struct watched_file {
    char *path;
    const char *name; /* its last part */
    int folder;       /* inotify's number of its folder; -1: the folder does not exist */
    bool there;       /* time of the last check */
    bool suspect;     /* something happened to it */
    struct file_version version;
};

/* Zero value: nothing is watched. Owner: the caller; watch_close releases everything. */
struct watch {
    bool open;
    int descriptor; /* becomes readable on an event */
    struct watched_file *files;
    size_t count, room;
    bool any;     /* new files in the folders are changes: the last run failed, possibly because a file was missing */
    bool stirred; /* one has appeared since then */
    double last;  /* time of the last event; 0: all events were checked */
    bool assets_differ; /* of watch_changed: a file that is no Lua text has changed */
};

bool watch_open(struct watch *watch, struct error *error);
void watch_close(struct watch *watch);
/* The file was read, in this version; NULL: it will be read. False: no memory. */
bool watch_add(struct watch *watch, const char *path, const struct file_version *version, double now);
/* Sets `any`. Changes since the last check are found. */
void watch_settle(struct watch *watch, bool any, double now);
/* Takes what inotify has. */
void watch_read(struct watch *watch, double now);
/* True, once: the content of a file differs from what was read, and there were no events for a moment (editors write in
 * steps). */
bool watch_changed(struct watch *watch, double now);

#endif
