#include "base/bundle.h"

#include "base/arena.h"
#include "base/key_map.h"
#include "base/mem.h"

#include <stdlib.h>
#include <string.h>

/* Elements in a row. */
struct piece {
    const void *source;
    char *copy; /* with the fields; NULL: the source is written */
    size_t size;
    uint64_t offset; /* in the bundle */
};

struct bundle {
    struct arena copies;
    struct piece *pieces; /* in the order of their offsets */
    size_t piece_count, piece_room;
    struct key_map known; /* by address of the source: the number of a piece */
    uint64_t *pointers;   /* offsets of the fields that are pointers */
    size_t pointer_count, pointer_room;
    uint64_t size;         /* of head and pieces */
    struct piece followed; /* whose fields are copied */
    bool failed;
};

/* What a bundle begins with. It ends with the offsets of its pointers, which ascend. */
struct head {
    char magic[8];
    uint64_t size, pointer_count, root_size; /* size: without the offsets at the end */
    uint64_t rest[4];
};
static const char bundle_magic[8] = "gray.bnd";
enum { ALIGNMENT = 64 };
_Static_assert(sizeof(struct head) == ALIGNMENT, "the root lies behind the head");

/* Room for one more item of a table that grows; false: no memory. */
static bool grow(void **table, size_t count, size_t *room, size_t size) {
    if (count < *room)
        return true;
    void *larger = mem_resize_array(*table, *room * 2 + ALIGNMENT, size);
    if (!larger)
        return false;
    *table = larger;
    *room = *room * 2 + ALIGNMENT;
    return true;
}

/* NULL: no memory. */
static const struct piece *add_piece(struct bundle *bundle, const void *source, size_t count, size_t size,
                                     bool has_fields) {
    const uint64_t key = (uint64_t)(uintptr_t)source;
    const uint32_t number = (uint32_t)bundle->piece_count;
    struct piece piece = {.source = source, .offset = bundle->size};
    uint64_t padded;
    if (__builtin_mul_overflow(count, size, &piece.size) ||
        __builtin_add_overflow(piece.size, ALIGNMENT - 1, &padded) ||
        __builtin_add_overflow(bundle->size, padded / ALIGNMENT * ALIGNMENT, &bundle->size))
        return NULL;
    if (has_fields && !(piece.copy = arena_alloc(&bundle->copies, piece.size)))
        return NULL;
    if (has_fields)
        memcpy(piece.copy, source, piece.size);
    uint32_t *known = key_map_find(&bundle->known, key);
    if (known)
        *known = number;
    else if (!key_map_add(&bundle->known, key, number))
        return NULL;
    if (!grow((void **)&bundle->pieces, number, &bundle->piece_room, sizeof piece))
        return NULL;
    bundle->pieces[bundle->piece_count++] = piece;
    return &bundle->pieces[number];
}

/* The piece from that address, at least so large; or NULL. */
static const struct piece *find_piece(const struct bundle *bundle, const void *source, size_t count, size_t size) {
    const uint32_t *number = key_map_find(&bundle->known, (uint64_t)(uintptr_t)source);
    const struct piece *piece = number ? &bundle->pieces[*number] : NULL;
    return piece && count <= piece->size / size ? piece : NULL;
}

/* The piece moves when others are added. */
static void follow(struct bundle *bundle, struct piece piece, size_t size, bundle_fields *fields) {
    const struct piece before = bundle->followed;
    bundle->followed = piece;
    for (size_t at = 0; at < piece.size && !bundle->failed; at += size)
        fields(bundle, piece.copy + at);
    bundle->followed = before;
}

static int by_offset(const void *left, const void *right) {
    const uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
    return (a > b) - (a < b);
}

struct bundle *bundle_create(const void *root, size_t size, bundle_fields *fields) {
    struct bundle *bundle = mem_alloc_zero(1, sizeof *bundle);
    if (!bundle)
        return NULL;
    bundle->size = sizeof(struct head);
    const struct piece *piece = add_piece(bundle, root, 1, size, true);
    if (piece)
        follow(bundle, *piece, size, fields);
    if (piece && !bundle->failed) {
        if (bundle->pointer_count > 0)
            qsort(bundle->pointers, bundle->pointer_count, sizeof *bundle->pointers, by_offset);
        return bundle;
    }
    bundle_destroy(bundle);
    return NULL;
}

void bundle_destroy(struct bundle *bundle) {
    if (!bundle)
        return;
    arena_destroy(&bundle->copies);
    key_map_destroy(&bundle->known);
    mem_free(bundle->pieces);
    mem_free(bundle->pointers);
    mem_free(bundle);
}

/* The field gets its offset in the bundle; a pointer to nothing that is not NULL stays one. */
static void set_field(struct bundle *bundle, char *field, uint64_t offset) {
    if (!grow((void **)&bundle->pointers, bundle->pointer_count, &bundle->pointer_room, sizeof *bundle->pointers)) {
        bundle->failed = true;
        return;
    }
    bundle->pointers[bundle->pointer_count++] = bundle->followed.offset + (uint64_t)(field - bundle->followed.copy);
    memcpy(field, &offset, sizeof offset);
}

void bundle_point(struct bundle *bundle, void *field, size_t count, size_t size, bundle_fields *fields) {
    const void *source;
    memcpy(&source, field, sizeof source);
    if (!source || bundle->failed)
        return;
    if (count == 0) {
        set_field(bundle, field, sizeof(struct head));
        return;
    }
    const struct piece *piece = find_piece(bundle, source, count, size);
    if (piece) {
        set_field(bundle, field, piece->offset);
        return;
    }
    piece = add_piece(bundle, source, count, size, fields != NULL);
    if (!piece) {
        bundle->failed = true;
        return;
    }
    set_field(bundle, field, piece->offset);
    if (fields)
        follow(bundle, *piece, size, fields);
}

size_t bundle_size(const struct bundle *bundle) {
    return (size_t)bundle->size + bundle->pointer_count * sizeof *bundle->pointers;
}

void bundle_write(const struct bundle *bundle, void *out) {
    struct head head = {
        .size = bundle->size, .pointer_count = bundle->pointer_count, .root_size = bundle->pieces[0].size};
    memcpy(head.magic, bundle_magic, sizeof head.magic);
    memcpy(out, &head, sizeof head);
    for (size_t i = 0; i < bundle->piece_count; i++) {
        const struct piece *piece = &bundle->pieces[i];
        const uint64_t end = i + 1 < bundle->piece_count ? bundle->pieces[i + 1].offset : bundle->size;
        char *at = (char *)out + piece->offset;
        memcpy(at, piece->copy ? piece->copy : piece->source, piece->size);
        memset(at + piece->size, 0, (size_t)(end - piece->offset) - piece->size);
    }
    memcpy((char *)out + bundle->size, bundle->pointers, bundle->pointer_count * sizeof *bundle->pointers);
}

void *bundle_open(void *bytes, size_t size, uint64_t address, size_t root_size, struct error *error) {
    struct head head;
    char *all = bytes;
    bool ok = size >= sizeof head;
    if (ok)
        memcpy(&head, all, sizeof head);
    ok = ok && memcmp(head.magic, bundle_magic, sizeof head.magic) == 0 && head.root_size == root_size &&
         head.size % ALIGNMENT == 0 && head.size <= size && head.size >= sizeof head + root_size &&
         head.pointer_count == (size - head.size) / sizeof(uint64_t) && (size - head.size) % sizeof(uint64_t) == 0;
    uint64_t before = 0;
    for (uint64_t i = 0; ok && i < head.pointer_count; i++) {
        uint64_t at, to = 0;
        memcpy(&at, all + head.size + i * sizeof at, sizeof at);
        ok = at >= sizeof head && at > before && at <= head.size - sizeof to && at % sizeof to == 0;
        if (ok)
            memcpy(&to, all + at, sizeof to);
        if (!(ok = ok && to >= sizeof head && to < head.size))
            break;
        to += address;
        memcpy(all + at, &to, sizeof to);
        before = at;
    }
    if (ok)
        return all + sizeof head;
    error_set(error, ERROR_MACHINE, "the data of a scene is damaged");
    return NULL;
}
