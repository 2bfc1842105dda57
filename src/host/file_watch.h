/* Watching files (--watch): which ones the scripts have read, and whether one of them holds something else now. Folders
 * are watched, not files (inotify(7)): editors write a new file and rename it over the old one. What decides is the
 * content, so that a picture which a scene writes and reads again does not start it for ever. */
#ifndef GRAY_HOST_FILE_WATCH_H
#define GRAY_HOST_FILE_WATCH_H

#include "base/error.h"
#include "base/file.h"

struct watched_file {
    char *path;
    const char *name; /* its last part */
    int folder;       /* inotify's number of its folder; -1: the folder is not there */
    bool there;       /* when it was looked at last */
    bool suspect;     /* something happened to it */
    struct file_version version;
};

/* Zero value: nothing is watched. Owner: the caller; watch_close gives everything back. */
struct watch {
    bool open;
    int descriptor; /* becomes readable when something happens */
    struct watched_file *files;
    size_t count, room;
    bool any;     /* files that appear in the folders count: the last run failed, perhaps for one that was not there */
    bool stirred; /* one has appeared since then */
    double last;  /* when something happened last; 0: nothing that was not looked at */
    bool assets_differ; /* of watch_changed: a file that is no Lua text was among them */
};

bool watch_open(struct watch *watch, struct error *error);
void watch_close(struct watch *watch);
/* The file was read, in this version; NULL: it is about to be. False: no memory. */
bool watch_add(struct watch *watch, const char *path, const struct file_version *version, double now);
/* From now on any: see there. Changes since the last look are found. */
void watch_settle(struct watch *watch, bool any, double now);
/* Takes what inotify has. */
void watch_read(struct watch *watch, double now);
/* True, once: a file differs from what was read, and nothing has happened for a moment (editors write in steps). */
bool watch_changed(struct watch *watch, double now);

#endif
