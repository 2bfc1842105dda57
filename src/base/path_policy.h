/* The folders a scene may read and write: a list, decided before the scene starts. A name is looked at where it really
 * leads (symbolic links and ".." followed), and what is opened is opened below the folder's own descriptor, so that
 * nothing changed in between can lead out. A name that leads out, at its end or on its way, is refused before anything
 * outside is looked at: whether something is there changes neither the answer nor errno. For reading and streams NULL
 * in the place of a path policy means "no limits". */
#ifndef GRAY_BASE_PATH_POLICY_H
#define GRAY_BASE_PATH_POLICY_H

#include "base/error.h"
#include "base/file.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* How a folder came into the list. Below a folder that the command line does not name, names that begin with a dot
 * cannot be read: the parent folder of a scene may be a home. */
enum path_policy_kind {
    PATH_POLICY_IMPLIED, /* read; not below "/", no hidden names */
    PATH_POLICY_READ,    /* read */
    PATH_POLICY_WRITE,   /* read and write */
};

struct path_policy_folder {
    char *path; /* canonical, without a final slash; "" for the root */
    size_t length;
    enum path_policy_kind kind;
    int descriptor;
    char *spelling; /* another absolute name by which the folder was given, or NULL */
};

/* Zero value: nothing may be read. Owner: the caller; path_policy_destroy gives everything back. */
struct path_policy {
    struct path_policy_folder *folders;
    size_t count;
};

/* An implied folder that does not exist, or is "/", is left out; one that was asked for must be there. */
bool path_policy_add(struct path_policy *path_policy, const char *folder, enum path_policy_kind kind,
                     struct error *error);
/* The usual folders of a scene: its own, the one above it, the working directory, the library (may be NULL). */
bool path_policy_add_scene(struct path_policy *path_policy, const char *scene, const char *library,
                           struct error *error);
void path_policy_destroy(struct path_policy *path_policy);

/* A regular file that exists and may be read. */
bool path_policy_is_readable(const struct path_policy *path_policy, const char *path);
/* Whether the name as it is written, links not followed, lies outside of everything: for the words of an error. */
bool path_policy_is_outside(const struct path_policy *path_policy, const char *path);
/* As file_map. */
bool path_policy_map(const struct path_policy *path_policy, const char *path, size_t limit, struct file_bytes *out,
                     struct error *error);
/* A stream for fopen's modes r, w, a with + and b; NULL with errno: EACCES when it is out of reach. Only regular files;
 * nothing that could block. */
FILE *path_policy_stream(const struct path_policy *path_policy, const char *path, const char *mode);
/* Whether a file of this name, which need not exist and whose folders need not either, would lie below a folder that
 * may be written, with no hidden name on the way. */
bool path_policy_may_create(const struct path_policy *path_policy, const char *path);
/* Opens (O_PATH) the folder in which a file of this name would stand, and makes folders that are missing; no link that
 * is put there meanwhile leads elsewhere. -1 with errno: EACCES when the name is not one for path_policy_may_create. */
int path_policy_open_folder(const struct path_policy *path_policy, const char *path);
/* remove and rename of files below folders that may be written; false with errno. */
bool path_policy_remove(const struct path_policy *path_policy, const char *path);
bool path_policy_rename(const struct path_policy *path_policy, const char *from, const char *to);

#endif
