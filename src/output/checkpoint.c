/* The file is written anew each time, beside the old one, which stays until the new one is whole: a kill at any moment
 * leaves one of the two. So that this never costs much, the pause between two writings is at least twenty times what
 * the last one took. */
#include "output/checkpoint.h"

#include "base/mem.h"
#include "output/progress.h"

#include <stdio.h>
#include <string.h>

static const double pause_factor = 20;

void keeper_init(struct keeper *keeper, const struct options *options, const struct picture_files *files) {
    *keeper = (struct keeper){
        .on = options->checkpoint && !options->check, .resume = options->resume, .every = options->checkpoint_every};
    keeper->files = files;
}

static bool choose_path(struct keeper *keeper, const char *picture_name, struct error *error) {
    if (keeper->path[0] != '\0')
        return true;
    return picture_files_checkpoint(keeper->files, picture_name, keeper->path, error);
}

bool keeper_open(struct keeper *keeper, const char *picture_name, char notice[256], struct error *error) {
    notice[0] = '\0';
    if (keeper->refused.kind != ERROR_NONE) {
        *error = keeper->refused;
        return false;
    }
    if (!keeper->on || keeper->opened)
        return true;
    if (!choose_path(keeper, picture_name, error))
        return false;
    keeper->written_at = progress_clock();
    bool there = file_is_regular(keeper->path);
    if (there && !keeper->resume)
        return error_set(error, ERROR_USAGE,
                         "%.400s: this checkpoint of an earlier run is there already; --resume goes on with it, or "
                         "remove it",
                         keeper->path);
    keeper->opened = !there;
    if (!there && keeper->resume)
        (void)snprintf(notice, 256, "gray: notice: there is no %.150s, so the run starts from its beginning",
                       keeper->path);
    if (!there)
        return true;
    if (!tile_file_read(keeper->path, &keeper->old, error)) {
        keeper->refused = *error;
        return false;
    }
    keeper->opened = keeper->has_old = true;
    (void)file_identity_of(keeper->path, &keeper->file);
    keeper->old_number = keeper->old.has_picture ? keeper->old.picture.number : 0;
    for (size_t i = 0; i < keeper->old.done_count; i++) {
        if (keeper->old.done[i].number > keeper->old_number)
            keeper->old_number = keeper->old.done[i].number;
    }
    return true;
}

/* From then on nothing is written: the file stays what it is. */
static bool refuse(struct keeper *keeper, const char *why, struct error *error) {
    error_set(&keeper->refused, ERROR_SCENE, "%.400s: cannot be gone on with: %s", keeper->path, why);
    keeper->opened = false;
    *error = keeper->refused;
    return false;
}

static bool add_done(struct keeper *keeper, const struct tile_done *done, struct error *error) {
    struct tile_done *more = mem_resize_array(keeper->done, keeper->done_count + 1, sizeof *more);
    if (!more)
        return error_no_memory(error, "the checkpoint");
    keeper->done = more;
    more[keeper->done_count++] = *done;
    return true;
}

bool keeper_has_written(struct keeper *keeper, uint32_t number, const struct tile_key *key, const char *name,
                        bool *written, struct error *error) {
    *written = false;
    keeper->number = number;
    if (!keeper->has_old)
        return true;
    for (size_t i = 0; i < keeper->old.done_count; i++) {
        const struct tile_done *done = &keeper->old.done[i];
        struct digest digest;
        if (done->number != number)
            continue;
        const char *difference = tile_key_difference(&done->key, key);
        if (difference)
            return refuse(keeper, difference, error);
        *written = strcmp(done->name, name) == 0 && file_digest(name, &digest) && digest_equal(digest, done->written);
        return !*written || add_done(keeper, done, error);
    }
    return true;
}

bool keeper_restore(struct keeper *keeper, const struct tile_picture *picture, struct film *film, char notice[256],
                    struct error *error) {
    notice[0] = '\0';
    keeper->tiles_kept = 0;
    if (!keeper->has_old || !keeper->old.has_picture || keeper->old.picture.number != picture->number)
        return true;
    const char *difference = tile_picture_difference(&keeper->old.picture, picture);
    if (difference || keeper->old.picture.shard != picture->shard)
        return refuse(keeper, difference ? difference : "it is another part of the picture", error);
    uint32_t twice;
    tile_file_restore(&keeper->old, film, &keeper->tiles_kept, &twice);
    (void)snprintf(notice, 256, "gray: notice: %u of %u tiles of %.150s come from the checkpoint", keeper->tiles_kept,
                   film_tile_count(film), picture->name);
    return true;
}

static struct file_target target_of(struct keeper *keeper) {
    const struct picture_files *files = keeper->files;
    bool named = strcmp(files->options->checkpoint, "auto") != 0;
    return (struct file_target){keeper->path, named ? &files->named_checkpoint : &files->checkpoint, &keeper->file};
}

static bool remove_file(struct keeper *keeper, struct error *error) {
    const struct file_target target = target_of(keeper);
    return file_output_remove(&target, keeper->file, error);
}

bool keeper_tick(struct keeper *keeper, const struct tile_picture *picture, const struct film *film, bool now,
                 uint32_t *tiles, struct error *error) {
    if (!keeper->opened || keeper->number < keeper->old_number)
        return true;
    double clock = progress_clock(), pause = keeper->took * pause_factor;
    if (!now && clock - keeper->written_at < (keeper->every > pause ? keeper->every : pause))
        return true;
    uint32_t have = film ? film_tiles_in(film, FILM_TILE_DONE) : 0;
    if (!now && !keeper->pending && have == keeper->tiles_kept)
        return true;
    const struct file_target target = target_of(keeper);
    bool ok = tile_file_write(&target, keeper->done, keeper->done_count, film ? picture : NULL, film, error);
    keeper->written_at = progress_clock();
    keeper->took = keeper->written_at - clock;
    if (ok) {
        keeper->pending = false;
        keeper->tiles_kept = have;
        *tiles = have;
        return true;
    }
    bool tell = !keeper->failed || now;
    keeper->failed = true;
    return !tell;
}

bool keeper_note_written(struct keeper *keeper, uint32_t number, const struct tile_key *key, const char *name,
                         struct error *error) {
    struct tile_done done = {.number = number, .key = *key};
    if (!keeper->opened)
        return true;
    keeper->pending = true;
    keeper->tiles_kept = 0;
    if (!file_digest(name, &done.written)) /* a pipe cannot be looked at again */
        return true;
    (void)snprintf(done.name, sizeof done.name, "%s", name);
    return add_done(keeper, &done, error);
}

bool keeper_finish(struct keeper *keeper, bool all_written, struct error *error) {
    bool ok = true;
    uint32_t tiles;
    bool written = keeper->file.device || keeper->file.inode;
    if (keeper->opened && all_written)
        ok = !written || remove_file(keeper, error);
    else if (keeper->opened && keeper->pending)
        ok = keeper_tick(keeper, NULL, NULL, true, &tiles, error);
    tile_file_close(&keeper->old);
    mem_free(keeper->done);
    *keeper = (struct keeper){0};
    return ok;
}
