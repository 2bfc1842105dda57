/* Finished pictures by the digests of their contents, so that an equal frame of an animation is copied and not rendered
 * again. All entries belong to one render process: digests of two processes cannot be compared. */
#ifndef GRAY_OUTPUT_PICTURE_COPIES_H
#define GRAY_OUTPUT_PICTURE_COPIES_H

#include "base/hash.h"
#include "output/picture_files.h"

struct finished_picture {
    struct digest shows;    /* picture_request.shows; zero: a free entry */
    struct digest versions; /* identities, sizes and times of its files */
    uint32_t number;        /* of the frame */
    uint32_t order;         /* of the picture in the run, as in tile files */
    uint32_t layers;
    const char *name; /* owned by the table */
};

/* Zero value: none. Owner: the caller; picture_copies_clear frees it. */
struct picture_copies {
    struct finished_picture *slots; /* open addressing; room is a power of two */
    uint32_t count, room;
};

/* Stores a picture whose files are complete: its number, order, layers and name. Does nothing without a digest, or if
 * the digest is that of an earlier picture with unchanged files. Without memory, the picture is not stored. */
void picture_copies_add(struct picture_copies *copies, const struct picture_files *files,
                        const struct finished_picture *picture);
/* An equal earlier picture with the same kind of files, which have not changed since; or NULL. */
const struct finished_picture *picture_copies_find(const struct picture_copies *copies,
                                                   const struct picture_files *files, struct digest shows,
                                                   const char *name, uint32_t layers);
/* Copies all files of an earlier picture; the result has the bytes that rendering would give. */
bool picture_copies_write(const struct finished_picture *earlier, const struct picture_files *files, const char *name,
                          struct error *error);
void picture_copies_clear(struct picture_copies *copies);

#endif
