/* Writing files. A file is written atomically and replaces only files that may be lost: a picture replaces pictures, a
 * checkpoint replaces checkpoints, nothing replaces a file that the run has read.
 *
 * The name is resolved once: the folder is opened and everything after that happens relative to its descriptor, so a
 * folder or link that is exchanged meanwhile cannot redirect the write. */
#ifndef GRAY_BASE_FILE_OUTPUT_H
#define GRAY_BASE_FILE_OUTPUT_H

#include "base/error.h"
#include "base/file.h"
#include "base/path_policy.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The role of a file that a run writes. */
enum file_role { FILE_ROLE_NONE, FILE_ROLE_PICTURE, FILE_ROLE_BESIDE, FILE_ROLES };

/* The files that a run must not replace, and those that it wrote itself. Zero-initialise; file_guard_destroy releases
 * the sets. */
struct file_guard {
    struct file_set kept; /* read, or written for another purpose: never replaced */
    struct file_set
        own[FILE_ROLES]; /* files that this run wrote: may be replaced in the same role, also after they were read */
    struct file_set cleaned; /* folders in which leftovers of earlier runs have been removed */
};
void file_guard_destroy(struct file_guard *guard);

/* Lets a wait for a pipe end early. `stopped` is called when `descriptor` is readable; true ends the wait. */
struct file_interrupt {
    int descriptor;
    bool (*stopped)(void *context);
    void *context;
};

/* Waits for so long at most; whether the run is to end. interrupt: or NULL. */
bool file_interrupted(const struct file_interrupt *interrupt, int milliseconds);

/* A limit on the bytes written into all files whose rules refer to it; exceeding it is an error with this text. */
struct file_quota {
    uint64_t written, limit; /* bytes */
    char words[128];
};

/* How a file may be written. The zero value replaces every regular file, in any folder. */
struct file_rules {
    /* Decides by the first FILE_HEAD_SIZE bytes of an existing file that is not empty; NULL: every regular file. */
    bool (*may_replace)(const uint8_t *head, size_t size);
    const char *expected; /* the kind of file that may_replace accepts, as in "a picture" */
    const char *advice;   /* added to a refusal: " (-o FILE chooses another one)", or NULL */
    enum file_role role;
    bool never_replace;                     /* any existing file is an error */
    bool is_direct;                         /* "-" is standard output; pipes and devices are written in place */
    bool named_by_user;                     /* the messages name --force */
    bool force;                             /* may_replace does not matter */
    struct file_quota *quota;               /* or NULL */
    const struct path_policy *folders;      /* folders that may be written; NULL: all */
    struct file_guard *guard;               /* or NULL */
    const struct file_interrupt *interrupt; /* or NULL */
};

enum { FILE_HEAD_SIZE = 80, FILE_NAME_SIZE = 4096 };

/* A name, and the rules for it (NULL: the zero value). */
struct file_target {
    const char *path;
    const struct file_rules *rules;
    struct file_identity *written; /* NULL, or receives the identity of the file once it has its name */
};
#define FILE_AT(name) (&(const struct file_target){.path = (name)})

/* Whether the file could be written now: folder, length of the name, file system, and the existing file. Creates
 * missing folders and nothing else. Removes leftovers of killed runs in the folder, once for each guard. */
bool file_output_check(const struct file_target *target, struct error *error);
/* Whether two names denote the same location: the same folder, under any name, and the same last component. The folders
 * must exist. */
bool file_is_same_folder(const char *a, const char *b);
/* Removes the file if it still has this identity and the rules allow its replacement. Succeeds if there is none. */
bool file_output_remove(const struct file_target *target, struct file_identity identity, struct error *error);

/* A file being written. Zero value = closed. After file_output_open either commit or abandon must follow. */
struct file_output {
    int descriptor, folder;
    bool open, direct;    /* direct: a pipe, a device or standard output, written in place */
    bool nameless, named; /* the state of the temporary name; neither: the file has its final name */
    uint64_t written;
    const struct file_rules *rules; /* not owned */
    struct file_identity *identity; /* target->written */
    char target[FILE_NAME_SIZE], temporary[40];
    const char *leaf; /* the last part of `target` */
};
bool file_output_open(struct file_output *file, const struct file_target *target, struct error *error);
bool file_output_write(struct file_output *file, const void *data, size_t size, struct error *error);
/* fsync, the final name (mode bits of a replaced file are kept, but for x, setuid and the like), fsync of the
 * folder. */
bool file_output_commit(struct file_output *file, struct error *error);
void file_output_abandon(struct file_output *file); /* removes the temporary file; may be called on a closed one */

/* A lock (flock) on an empty file, which ends with the process at the latest. Zero value: none. */
struct file_lock {
    int descriptor, folder;
    bool open;
    char name[32];
};
/* Creates the file, and waits for half a second. False: another process has the lock. True where files cannot be
 * created or locked, too. shared: several processes may have it together. */
bool file_lock_take(struct file_lock *lock, const struct file_target *target, bool shared);
/* The last process that has it removes the file, and what killed runs left in its folder. */
void file_lock_release(struct file_lock *lock);
void file_lock_forget(struct file_lock *lock); /* after a fork, in the process that does not have it */

#endif
