/* The folders a scene may read and write: a list, decided before the scene starts. The real path of a name decides
 * (symbolic links and ".." followed), and files are opened below the folder's own descriptor, so that no change in
 * between can lead out. A name that leads out at any component is refused before anything outside is accessed: neither
 * the result nor errno depends on what exists there. For reading and streams a NULL policy means "no limits". */
#ifndef GRAY_BASE_PATH_POLICY_H
#define GRAY_BASE_PATH_POLICY_H

#include "base/arena.h"
#include "base/error.h"
#include "base/file.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The origin of a folder in the list. Below a folder that the command line does not name, names that begin with a dot
 * cannot be read: the parent folder of a scene may be a home directory. */
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

/* Zero value: nothing may be read. Owner: the caller; path_policy_destroy frees everything. */
struct path_policy {
    struct path_policy_folder *folders;
    size_t count;
};

/* An implied folder that does not exist, or is "/", is left out; a requested one must exist. */
bool path_policy_add(struct path_policy *path_policy, const char *folder, enum path_policy_kind kind,
                     struct error *error);
/* From the library to the pictures that come with the program. */
#define PATH_POLICY_TEXTURES "/../textures"
/* The usual folders of a scene: its own, the one above it, the working directory, the library (may be NULL) and the
 * pictures beside it. */
bool path_policy_add_scene(struct path_policy *path_policy, const char *scene, const char *library,
                           struct error *error);
void path_policy_destroy(struct path_policy *path_policy);

/* A regular file that exists and may be read. */
bool path_policy_is_readable(const struct path_policy *path_policy, const char *path);
/* Whether the name as written, without following links, is outside all folders: for error messages. */
bool path_policy_is_outside(const struct path_policy *path_policy, const char *path);
/* Whether the name leads out of all folders, by itself, by ".." or by a link: never depends on what exists outside. */
bool path_policy_leads_out(const struct path_policy *path_policy, const char *path);

struct path_policy_entry {
    const char *name;
    bool is_folder; /* links are none */
};
/* The entries of a readable folder in byte order, without hidden ones: the first `limit` of them. The array and the
 * names are in the arena. 0: there are none, or the folder cannot be listed. */
size_t path_policy_list(const struct path_policy *path_policy, const char *folder, size_t limit, struct arena *arena,
                        struct path_policy_entry **entries);
/* As file_map. */
bool path_policy_map(const struct path_policy *path_policy, const char *path, size_t limit, struct file_bytes *out,
                     struct error *error);
/* A stream for fopen's modes r, w, a with + and b; NULL with errno: EACCES if it is outside. Only regular files;
 * nothing that could block. */
FILE *path_policy_stream(const struct path_policy *path_policy, const char *path, const char *mode);
/* Whether a file of this name, which need not exist and whose folders need not either, would be below a writable
 * folder, without a hidden component. */
bool path_policy_may_create(const struct path_policy *path_policy, const char *path);
/* Opens (O_PATH) the folder of a file with this name, and creates missing folders; no link created meanwhile can lead
 * elsewhere. -1 with errno: EACCES if path_policy_may_create refuses the name. */
int path_policy_open_folder(const struct path_policy *path_policy, const char *path);
/* remove and rename of files below folders that may be written; false with errno. */
bool path_policy_remove(const struct path_policy *path_policy, const char *path);
bool path_policy_rename(const struct path_policy *path_policy, const char *from, const char *to);

#endif
