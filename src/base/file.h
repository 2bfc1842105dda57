/* The only place that opens, maps or renames files. Reading takes whole files (mapped), writing puts a temporary file
 * beside the target, syncs it and renames it, so that an old file stays until the new one is whole. */
#ifndef GRAY_BASE_FILE_H
#define GRAY_BASE_FILE_H

#include "base/error.h"
#include "base/hash.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A whole file in memory, read-only. Owner: whoever called file_map; file_unmap gives it back. */
struct file_bytes {
    const uint8_t *data;
    size_t size;
};

/* Maps a regular file; an empty file gives size 0. A pipe or device is refused as "not a regular file".
 * A file larger than `limit` bytes is an error. Errors name the path. */
bool file_map(const char *path, size_t limit, struct file_bytes *out, struct error *error);
/* The same of an open descriptor, which is closed in any case; `path` is what it is called. */
bool file_map_descriptor(int descriptor, const char *path, size_t limit, struct file_bytes *out, struct error *error);
void file_unmap(struct file_bytes *bytes);

/* The contents of all files that this process has read, each once, whatever its name: whether a picture that was half
 * made elsewhere or earlier was made of the same. Zero-initialise; file_witness_destroy gives the list back. */
struct file_witness {
    struct digest *contents;
    size_t count, room;
    bool incomplete; /* no memory for one of them, or one could not be read again */
};
/* From now on every file that is read is noted in `witness`, which must stay; NULL: none is. Set once, before the first
 * scene, by the thread that reads files. */
void file_set_witness(struct file_witness *witness);
/* What a file held, and when: two versions that are told apart by size and time need not be read again. */
struct file_version {
    struct digest content;
    uint64_t size;
    int64_t seconds, nanoseconds; /* of its last change */
};
/* Is told every file that is read, under the name it was asked for by. */
struct file_listener {
    void (*heard)(void *context, const char *path, const struct file_version *version);
    void *context;
};
/* As file_set_witness. */
void file_set_listener(const struct file_listener *listener);
/* The version that stands under this name now; false: none that can be read. `known`, or NULL: when size and time are
 * its own the content is taken to be, too. */
bool file_version_of(const char *path, const struct file_version *known, struct file_version *out);
/* Notes the content of an open regular file without moving its position. For readers beside file_map. */
void file_note_read(int descriptor, const char *path);
/* Does not depend on the order in which the files were read. */
struct digest file_witness_sum(const struct file_witness *witness);
void file_witness_destroy(struct file_witness *witness);

bool file_is_regular(const char *path);
bool file_is_folder(const char *path);
/* A descriptor (O_PATH) that only stands for a place in the file system; -1 when there is none. */
int file_open_place(const char *path);
/* Standard input gives nothing from now on: a scene that waits for it would wait for ever. */
bool file_null_input(void);
/* Descriptors 0, 1 and 2 that whoever started us has closed are taken by something that gives nothing and takes
 * nothing: a file that is opened later must not get their place, and with it what is meant for the terminal. */
void file_fill_standard(void);
/* The canonical absolute path (realpath) into out; false when it does not exist or does not fit. */
bool file_canonical(const char *path, char *out, size_t size);
/* Removes one file; fine when there is none. */
bool file_remove(const char *path, struct error *error);
/* mkdir -p of the folder part of `path`. */
bool file_make_folders_for(const char *path, struct error *error);
/* Calls fn for every entry name of a folder in byte order, at most `limit` entries; stops early when fn returns false.
 */
bool file_list(const char *folder, size_t limit, bool (*fn)(void *context, const char *name), void *context);

/* A file being written. Zero value = closed. After file_output_open either commit or abandon must follow. */
struct file_output {
    int descriptor;
    bool open, direct; /* direct: target is a pipe, a device or "-" and is written in place */
    bool nameless;     /* the temporary file has no name yet */
    uint64_t written;
    char target[4096], temporary[4096 + 32];
};
bool file_output_open(struct file_output *file, const char *target, struct error *error); /* makes missing folders */
bool file_output_write(struct file_output *file, const void *data, size_t size, struct error *error);
/* fsync, rename over the target (mode bits of an existing file are kept), fsync of the folder. */
bool file_output_commit(struct file_output *file, struct error *error);
void file_output_abandon(struct file_output *file); /* removes the temporary file; fine on a closed one */

#endif
