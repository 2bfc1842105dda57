/* A region of memory that is released all at once. Zero-initialise to create; memory comes back zeroed, aligned to 16.
 * Not thread-safe. Sizes are checked for overflow; NULL means "no memory" and is reported by the caller. */
#ifndef GRAY_BASE_ARENA_H
#define GRAY_BASE_ARENA_H

#include <stddef.h>

struct arena_block;
struct arena {
    struct arena_block *head;
    size_t total; /* bytes handed out since the last reset */
};

void *arena_alloc(struct arena *arena, size_t size);
void *arena_alloc_array(struct arena *arena, size_t count, size_t size);
char *arena_copy_text(struct arena *arena, const char *text, size_t length); /* adds the final NUL */
char *arena_format(struct arena *arena, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The state of an arena, for a reset: everything that was allocated later is freed. */
struct arena_mark {
    struct arena_block *head;
    size_t used, total;
};
struct arena_mark arena_mark(const struct arena *arena);
void arena_rewind(struct arena *arena, struct arena_mark mark);
void arena_reset(struct arena *arena);   /* forgets everything, keeps the largest block for reuse */
void arena_destroy(struct arena *arena); /* frees everything; the arena may be used again */

#endif
