/* Reading, listing and removing files; writing is in base/file_output.h. Only src/base opens, maps or renames files. */
#ifndef GRAY_BASE_FILE_H
#define GRAY_BASE_FILE_H

#include "base/error.h"
#include "base/hash.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A whole file in memory, read-only. Owner: the caller of file_map; file_unmap frees it. */
struct file_bytes {
    const uint8_t *data;
    size_t size;
};

/* The identity of a file, the same under all its names. */
struct file_identity {
    uint64_t device, inode;
};
/* A set of files. Zero-initialise; file_set_destroy releases it. */
struct file_set {
    struct file_identity *slots; /* open addressing; device and inode 0: free */
    size_t count, room;
};
bool file_set_add(struct file_set *set, struct file_identity identity); /* false: no memory */
bool file_set_has(const struct file_set *set, struct file_identity identity);
void file_set_remove(struct file_set *set, struct file_identity identity);
void file_set_destroy(struct file_set *set);
/* The identity of the file with this name, links followed; false: there is none. */
bool file_identity_of(const char *path, struct file_identity *out);
bool file_identity_of_descriptor(int descriptor, struct file_identity *out);

/* Maps a regular file; an empty file gives size 0. A pipe or device is refused as "not a regular file".
 * A file larger than `limit` bytes is an error. Errors name the path. */
bool file_map(const char *path, size_t limit, struct file_bytes *out, struct error *error);
/* The same for an open descriptor, which is always closed; `path` is its name in messages. */
bool file_map_descriptor(int descriptor, const char *path, size_t limit, struct file_bytes *out, struct error *error);
void file_unmap(struct file_bytes *bytes);

/* A regular file of any size that is read in blocks. Zero value: closed. */
struct file_source {
    int descriptor;
    bool open;
    uint64_t size; /* when it was opened */
};
bool file_source_open(struct file_source *source, const char *path, struct error *error); /* as file_map */
/* False: the file has fewer bytes. */
bool file_source_read(const struct file_source *source, uint64_t at, void *out, size_t size);
void file_source_close(struct file_source *source);

/* The content of a file and its time: versions with different size or time need not be compared byte by byte. */
struct file_version {
    struct file_identity identity;
    struct digest content; /* zero unless the listener needs contents */
    uint64_t size;
    int64_t seconds, nanoseconds; /* of its last change */
};
/* Digests of all files that this process has read, each once under any name. They show whether a partial picture was
 * made from the same files. Zero-initialise; file_read_log_destroy frees the list. */
struct file_read_log {
    struct digest *contents;
    size_t count, room;
    uint64_t limit;  /* of the bytes that are read again for it; 0: none */
    bool incomplete; /* no memory for one of them, one could not be read again, or they are larger than the limit */
    struct file_version *versions; /* files that were noted: they are read again only once */
    size_t version_count, version_room;
};
/* Receives every file that is read, with the name that was used, and every file that a script opens for writing; the
 * members may be NULL. */
struct file_listener {
    void (*searches)(void *context); /* before files are searched or opened by name */
    struct file_read_log *log;       /* of the files that are read */
    void (*heard)(void *context, const char *path, const struct file_version *version);
    void (*wrote)(void *context, const char *path, const struct file_version *version);
    bool contents; /* versions have digests */
    void *context;
};
/* From now on it receives all files, and must stay; NULL: none does. Set once, before the first scene, by the thread
 * that reads files. */
void file_set_listener(const struct file_listener *listener);
/* The current version of the file with this name; false: it cannot be read. `known` (or NULL): if size and time equal
 * its own, the content is assumed equal, too. */
bool file_version_of(const char *path, const struct file_version *known, struct file_version *out);
/* For functions outside of file.c that search files by name. */
void file_note_search(void);
/* Notes the content of an open regular file without moving its position. For readers beside file_map. */
void file_note_read(int descriptor, const char *path);
/* The same for a file that was opened for writing. */
void file_note_write(int descriptor, const char *path);
/* The content of a file, which is opened only if it is regular; false: it cannot be read. */
bool file_digest(const char *path, struct digest *digest);
/* Does not depend on the order in which the files were read. */
struct digest file_read_log_sum(const struct file_read_log *read_log);
void file_read_log_destroy(struct file_read_log *read_log);

/* Whether anything has this name, even a dangling link. */
bool file_exists(const char *path);
bool file_is_regular(const char *path);
bool file_is_folder(const char *path);
/* A descriptor (O_PATH) that only names a location in the file system; -1 if there is none. */
int file_open_folder_of(const char *path);
/* Makes standard input empty from now on: a scene that reads it would wait for ever. */
bool file_null_input(void);
/* If descriptors 0, 1 or 2 are closed at the start, they are replaced by one that is empty and cannot be written:
 * a file that is opened later must not get their number, and with it the output for the terminal. */
void file_fill_standard(void);
/* The canonical absolute path (realpath) into out; false when it does not exist or does not fit. */
bool file_canonical(const char *path, char *out, size_t size);
/* ERROR_SCENE for a location where no file can be created (a wrong name), ERROR_MACHINE otherwise (a full disk). */
enum error_kind file_refusal_kind(int number);
/* A new folder of this user alone, below TMPDIR or /tmp, and its name. */
bool file_make_temporary_folder(char *out, size_t size, struct error *error);
/* Removes it with the files in it. */
void file_remove_temporary_folder(const char *folder);
/* Removes an empty folder. False: it is not empty or cannot be removed. */
bool file_remove_empty_folder(const char *folder);
/* mkdir -p of the folder part of `path`. */
bool file_make_folders_for(const char *path, struct error *error);
/* Calls fn for every entry name of a folder in byte order, at most `limit` entries; stops early when fn returns false.
 * Hidden names, which begin with a dot, are left out and do not count. */
bool file_list(const char *folder, size_t limit, bool (*fn)(void *context, const char *name), void *context);

#endif
