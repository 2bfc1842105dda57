/* A hash table. A script cannot replace a file of the run, but another program can. So a picture is no longer a source
 * if its files have another identity, size or time. */
#include "output/picture_copies.h"

#include "base/mem.h"
#include "output/layers_internal.h"

#include <limits.h>
#include <string.h>

static struct finished_picture *slot_of(const struct picture_copies *copies, struct digest shows) {
    for (uint64_t at = shows.a;; at++) {
        struct finished_picture *slot = &copies->slots[at & (copies->room - 1)];
        if (digest_is_zero(slot->shows) || digest_equal(slot->shows, shows))
            return slot;
    }
}

static void free_name(struct finished_picture *picture) {
    mem_free((void *)(uintptr_t)picture->name);
}

static bool grow(struct picture_copies *copies) {
    struct picture_copies larger = {.room = copies->room ? copies->room * 2 : 64};
    larger.slots = mem_alloc_zero(larger.room, sizeof *larger.slots);
    if (!larger.slots)
        return false;
    for (uint32_t i = 0; i < copies->room; i++)
        if (!digest_is_zero(copies->slots[i].shows))
            *slot_of(&larger, copies->slots[i].shows) = copies->slots[i];
    larger.count = copies->count;
    mem_free(copies->slots);
    *copies = larger;
    return true;
}

/* False: one of the files is not a regular file. */
static bool versions_of(const struct picture_files *files, const char *name, uint32_t layers, struct digest *out) {
    struct picture_file file;
    struct file_version version;
    struct digest_sum sum = {.count = 0};
    for (int number = INT_MAX; picture_files_before(files, name, layers, &number, &file);) {
        if (!file_version_without_content(file.path, &version))
            return false;
        digest_sum_add(&sum, version.identity.device);
        digest_sum_add(&sum, version.identity.inode);
        digest_sum_add(&sum, version.size);
        digest_sum_add(&sum, (uint64_t)version.seconds);
        digest_sum_add(&sum, (uint64_t)version.nanoseconds);
    }
    *out = digest_sum_end(&sum);
    return true;
}

static bool is_unchanged(const struct finished_picture *picture, const struct picture_files *files) {
    struct digest versions;
    return versions_of(files, picture->name, picture->layers, &versions) && digest_equal(versions, picture->versions);
}

void picture_copies_add(struct picture_copies *copies, const struct picture_files *files,
                        const struct finished_picture *picture) {
    struct finished_picture kept = *picture;
    size_t size = strlen(picture->name) + 1;
    if (digest_is_zero(picture->shows) || (copies->count * 2 >= copies->room && !grow(copies)))
        return;
    struct finished_picture *slot = slot_of(copies, picture->shows);
    bool is_new = digest_is_zero(slot->shows);
    if ((!is_new && is_unchanged(slot, files)) || !versions_of(files, picture->name, picture->layers, &kept.versions))
        return;
    char *name = mem_alloc(size);
    if (!name)
        return;
    memcpy(name, picture->name, size);
    kept.name = name;
    free_name(slot);
    *slot = kept;
    copies->count += is_new;
}

const struct finished_picture *picture_copies_find(const struct picture_copies *copies,
                                                   const struct picture_files *files, struct digest shows,
                                                   const char *name, uint32_t layers) {
    if (digest_is_zero(shows) || copies->count == 0)
        return NULL;
    const struct finished_picture *slot = slot_of(copies, shows);
    bool fits = !digest_is_zero(slot->shows) && slot->layers == layers &&
                picture_format(slot->name) == picture_format(name) && strcmp(slot->name, name) != 0;
    return fits && is_unchanged(slot, files) ? slot : NULL;
}

static bool copy_bytes(const struct file_source *source, const char *from, struct file_output *to,
                       struct error *error) {
    enum { BLOCK = 1 << 18 };
    uint8_t *block = mem_alloc(BLOCK);
    bool ok = block || error_no_memory(error, "the copy of a frame");
    for (uint64_t at = 0; ok && at < source->size;) {
        size_t size = source->size - at < BLOCK ? (size_t)(source->size - at) : BLOCK;
        ok = file_source_read(source, at, block, size)
                 ? file_output_write(to, block, size, error)
                 : error_set(error, ERROR_MACHINE, "%.600s: has changed while it was copied", from);
        at += size;
    }
    mem_free(block);
    return ok;
}

static bool copy_file(const struct picture_file *from, const struct picture_file *to, struct error *error) {
    const struct file_target target = {.path = to->path, .rules = to->rules};
    struct file_source source = {0};
    struct file_output output = {0};
    bool ok = file_source_open(&source, from->path, error) && file_output_open(&output, &target, error) &&
              copy_bytes(&source, from->path, &output, error) && file_output_commit(&output, error);
    file_output_abandon(&output);
    file_source_close(&source);
    return ok;
}

bool picture_copies_write(const struct finished_picture *earlier, const struct picture_files *files, const char *name,
                          struct error *error) {
    struct picture_file from, to;
    int of_source = INT_MAX, of_copy = INT_MAX;
    while (picture_files_before(files, earlier->name, earlier->layers, &of_source, &from)) {
        if (!picture_files_before(files, name, earlier->layers, &of_copy, &to))
            return error_set(error, ERROR_MACHINE, "%.600s: has other files than %.600s", name, earlier->name);
        if (!copy_file(&from, &to, error))
            return false;
    }
    return true;
}

void picture_copies_clear(struct picture_copies *copies) {
    for (uint32_t i = 0; i < copies->room; i++)
        free_name(&copies->slots[i]);
    mem_free(copies->slots);
    *copies = (struct picture_copies){0};
}
