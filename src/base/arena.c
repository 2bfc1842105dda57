/* Blocks in a list, newest first; each new block is at least twice the one before, so that n bytes cost O(log n)
 * allocations. Memory beyond `used` of a block is zero: a reset clears what was used. */
#include "base/arena.h"

#include "base/checked.h"
#include "base/fault.h"
#include "base/mem.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

struct arena_block {
    struct arena_block *next;
    size_t size, used;
    size_t padding; /* keeps data 16-byte aligned */
    unsigned char data[];
};

enum { ARENA_FIRST_BLOCK = 16 * 1024, ARENA_ALIGNMENT = 16 };

static bool arena_grow(struct arena *arena, size_t size) {
    size_t wanted = arena->head && arena->head->size < SIZE_MAX / 4 ? arena->head->size * 2 : ARENA_FIRST_BLOCK;
    if (wanted > (size_t)64 << 20)
        wanted = (size_t)64 << 20;
    if (wanted < size)
        wanted = size;
    size_t bytes;
    if (!checked_add(wanted, sizeof(struct arena_block), &bytes))
        return false;
    uint64_t refusals = mem_refusals();
    struct arena_block *block = mem_alloc_zero(1, bytes);
    if (!block && mem_refusals() != refusals && wanted > size && wanted > ARENA_FIRST_BLOCK) {
        /* Near a memory limit blocks stop growing, so that all of the memory can be used. */
        wanted = size > ARENA_FIRST_BLOCK ? size : ARENA_FIRST_BLOCK;
        block = mem_alloc_zero(1, wanted + sizeof(struct arena_block));
    }
    if (!block)
        return false;
    block->size = wanted;
    block->next = arena->head;
    arena->head = block;
    return true;
}

void *arena_alloc(struct arena *arena, size_t size) {
    size_t rounded;
    /* In builds with fault injection every allocation can fail, not only the few that need a new block. */
    if (fault_now(FAULT_OF_ALLOCATION))
        return NULL;
    if (!checked_add(size ? size : 1, ARENA_ALIGNMENT - 1, &rounded))
        return NULL;
    rounded &= ~(size_t)(ARENA_ALIGNMENT - 1);
    if (!arena->head || arena->head->size - arena->head->used < rounded) {
        if (!arena_grow(arena, rounded))
            return NULL;
    }
    void *out = arena->head->data + arena->head->used;
    arena->head->used += rounded;
    arena->total += rounded;
    return out;
}

void *arena_alloc_array(struct arena *arena, size_t count, size_t size) {
    size_t bytes;
    return checked_mul(count, size, &bytes) ? arena_alloc(arena, bytes) : NULL;
}

char *arena_copy_text(struct arena *arena, const char *text, size_t length) {
    char *copy = length < SIZE_MAX ? arena_alloc(arena, length + 1) : NULL;
    if (copy)
        memcpy(copy, text, length);
    return copy;
}

char *arena_format(struct arena *arena, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (length < 0)
        return NULL;
    char *text = arena_alloc(arena, (size_t)length + 1);
    if (!text)
        return NULL;
    va_start(arguments, format);
    (void)vsnprintf(text, (size_t)length + 1, format, arguments);
    va_end(arguments);
    return text;
}

struct arena_mark arena_mark(const struct arena *arena) {
    return (struct arena_mark){arena->head, arena->head ? arena->head->used : 0, arena->total};
}

void arena_rewind(struct arena *arena, struct arena_mark mark) {
    while (arena->head != mark.head) {
        struct arena_block *next = arena->head->next;
        mem_free(arena->head);
        arena->head = next;
    }
    if (arena->head) {
        memset(arena->head->data + mark.used, 0, arena->head->used - mark.used);
        arena->head->used = mark.used;
    }
    arena->total = mark.total;
}

void arena_reset(struct arena *arena) {
    struct arena_block *largest = NULL;
    for (struct arena_block *block = arena->head; block; block = block->next) {
        if (!largest || block->size > largest->size)
            largest = block;
    }
    for (struct arena_block *block = arena->head; block;) {
        struct arena_block *next = block->next;
        if (block != largest)
            mem_free(block);
        block = next;
    }
    arena->head = largest;
    arena->total = 0;
    if (largest) {
        memset(largest->data, 0, largest->used);
        largest->used = 0;
        largest->next = NULL;
    }
}

void arena_destroy(struct arena *arena) {
    for (struct arena_block *block = arena->head; block;) {
        struct arena_block *next = block->next;
        mem_free(block);
        block = next;
    }
    arena->head = NULL;
    arena->total = 0;
}
