/* Tile files: tiles of a picture, finished ones and those with some of their samples, for later (checkpoints) or for
 * merging (parts of a picture that several machines render). A file identifies the scene and options of its tiles, so
 * that foreign tiles are never merged. Every record has a checksum, and the file has an end record, so that damaged
 * files are refused. The checksums are not signatures: they detect accidents, not forgeries; reading any file is
 * safe. */
#ifndef GRAY_FILM_TILE_FILE_H
#define GRAY_FILM_TILE_FILE_H

#include "base/file.h"
#include "base/file_output.h"
#include "base/hash.h"
#include "film/film.h"

enum { TILE_FILE_NAME = 4096, TILE_FILE_VERSION_TEXT = 32, TILE_FILE_FORMAT = 6 };

/* The key of a picture: equal keys, equal bytes. */
struct tile_key {
    char version[TILE_FILE_VERSION_TEXT]; /* of the program, with its final NUL */
    struct digest options;                /* those that can change a picture */
    struct digest files;                  /* the script and all files that it read before this picture */
};

/* A picture that has tiles in the file. */
struct tile_picture {
    uint32_t number; /* counted over the run, from 1 */
    struct tile_key key;
    uint32_t full_width, full_height, x0, y0, width, height;
    struct film_rectangle shown; /* the part of it that is written; zero: all */
    struct settings settings; /* those that change the finished picture; the table of the tone curve is the next one */
    struct tone_table tone_table; /* of TONE_FUNCTION */
    struct film_record record;
    uint32_t shard, shards; /* 1 of 1: all tiles; both from 1 */
    bool whole;             /* all tiles of the shard are there */
    char name[TILE_FILE_NAME];
};

/* A picture that is finished and written: what its file held. */
struct tile_done {
    uint32_t number;
    struct tile_key key;
    struct digest written;
    char name[TILE_FILE_NAME];
};

/* Writes the done pictures, and of `picture` (or NULL) the finished tiles of `film` and those that are begun. The old
 * file stays until the new one is complete. */
bool tile_file_write(const struct file_target *target, const struct tile_done *done, size_t done_count,
                     const struct tile_picture *picture, const struct film *film, struct error *error);

/* A file that was read and checked as a whole. Its tiles stay in it until they are put into a film, so that a file of
 * any size takes the memory of one record. Owner: the caller, tile_file_close frees it. */
struct tile_file {
    struct file_source source;
    uint8_t *buffer; /* for one record */
    struct tile_done *done;
    size_t done_count;
    bool has_picture;
    struct tile_picture picture;
    uint64_t first_tile, first_record; /* where the records of tiles begin, and the number of the first one */
    size_t tiles;
};
/* Whether bytes begin like a file of tiles. */
bool tile_file_is(const uint8_t *head, size_t size);
/* False: `error` names the record and its fault; ERROR_SCENE unless there was no memory. */
bool tile_file_read(const char *path, struct tile_file *out, struct error *error);
void tile_file_close(struct tile_file *file);
/* Puts the tiles into a film of the picture's rectangle; its size, x0 and y0 must be set. *restored counts those that
 * are finished. Tiles that are there already count in *twice and are not put again; a file that has changed since it
 * was read gives those before the change. */
void tile_file_restore(const struct tile_file *file, struct film *film, uint32_t *restored, uint32_t *twice);

/* Why pictures with these keys and shapes do not belong together, as a phrase for messages, or NULL if they do.
 * Shards are not compared. */
const char *tile_key_difference(const struct tile_key *have, const struct tile_key *want);
const char *tile_picture_difference(const struct tile_picture *have, const struct tile_picture *want);

#endif
