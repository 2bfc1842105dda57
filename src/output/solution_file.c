/* A magic word, the digest, the bytes, and a hash of all that. */
#include "output/solution_file_internal.h"

static const char magic[8] = "GRAYRAD\x1a";

struct head {
    char magic[sizeof magic];
    struct digest depends;
};
enum { FIXED_SIZE = sizeof(struct head) + sizeof(uint64_t) };

static uint64_t check_of(const struct head *head, const struct share *bytes) {
    return hash_bytes(bytes->block, bytes->size, hash_bytes(head, sizeof *head, 0));
}

bool solution_file_is(const uint8_t *head, size_t size) {
    return size >= sizeof magic && memcmp(head, magic, sizeof magic) == 0;
}

static bool read_bytes(const struct file_source *source, const char *path, const struct head *head, struct share *out,
                       struct error *error) {
    uint64_t size = source->size - FIXED_SIZE, check;
    if (!share_create(out, size, error))
        return false;
    if (file_source_read(source, sizeof *head, out->block, size) &&
        file_source_read(source, sizeof *head + size, &check, sizeof check) && check == check_of(head, out))
        return true;
    share_destroy(out);
    return error_set(error, ERROR_SCENE, "%s: is damaged: its checksum is wrong", path);
}

bool solution_file_read(const char *path, struct digest depends, uint64_t limit, struct share *out,
                        struct error *error) {
    struct file_source source;
    struct head head;
    *out = (struct share){0};
    if (!file_source_open(&source, path, error))
        return false;
    bool ok = true;
    if (!file_source_read(&source, 0, &head, sizeof head) || !solution_file_is((const uint8_t *)&head, sizeof head))
        ok = error_set(error, ERROR_SCENE, "%s: is no solution of radiosity", path);
    else if (source.size <= FIXED_SIZE)
        ok = error_set(error, ERROR_SCENE, "%s: is damaged: it ends too early", path);
    else if (digest_equal(head.depends, depends))
        ok = source.size <= limit ? read_bytes(&source, path, &head, out, error)
                                  : error_set_limit(error, "%s: takes more than --script-memory allows", path);
    file_source_close(&source);
    return ok;
}

bool solution_file_write(const struct file_target *target, struct digest depends, const struct share *bytes,
                         struct error *error) {
    struct head head = {.depends = depends};
    struct file_output file;
    memcpy(head.magic, magic, sizeof magic);
    const uint64_t check = check_of(&head, bytes);
    if (!file_output_open(&file, target, error))
        return false;
    if (file_output_write(&file, &head, sizeof head, error) &&
        file_output_write(&file, bytes->block, bytes->size, error) &&
        file_output_write(&file, &check, sizeof check, error))
        return file_output_commit(&file, error);
    file_output_abandon(&file);
    return false;
}
