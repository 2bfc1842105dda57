/* Memory that two processes share through a descriptor, for blocks whose size is known only after the fork (the film).
 * The process that creates it sends the descriptor to the other; the size is sealed, so neither process can shrink it
 * while the other uses it. */
#ifndef GRAY_BASE_SHARE_H
#define GRAY_BASE_SHARE_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

/* Zeroed. Owner: the caller, share_destroy frees both the mapping and the descriptor. Zero value: nothing. */
struct share {
    void *block;
    size_t size;
    int descriptor; /* valid while block is not NULL */
};

/* Allocates the memory at once: if there is not enough, this is an error now and not a crash later. */
bool share_create(struct share *share, size_t size, struct error *error);
/* Maps what another process created; takes over the descriptor, also when it fails. Checks the size; 0: takes that of
 * the memory. */
bool share_attach(struct share *share, int descriptor, size_t size, struct error *error);
void share_destroy(struct share *share);

/* Memory for another process to fill. It is not mapped in this one. Returns its descriptor, or -1. */
int share_create_open(size_t size, struct error *error);
/* From here on it can only be read. False: a process still has it mapped for writing. */
bool share_freeze(int descriptor);
/* Maps a copy of it that only this process changes, for the rest of its life; takes over the descriptor. NULL: error.
 */
void *share_map_copy(int descriptor, size_t *size, struct error *error);

#endif
