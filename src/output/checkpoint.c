/* The file is written anew each time, beside the old one, which is kept until the new one is complete: after a kill at
 * any moment one of the two exists. To limit the cost, the pause between two writes is at least twenty times the
 * duration of the last one.
 *
 * A checkpoint that was not requested (`late`) replaces only one of the same options, as of a scene that was changed
 * after an interruption: tiles of other options may be those of a larger picture, and could go on. */
#include "output/checkpoint.h"

#include "base/clock.h"
#include "base/mem.h"

#include <stdio.h>
#include <string.h>

static const double pause_factor = 20;
static const double long_run = 60; /* seconds */

void checkpoint_init(struct checkpoint *checkpoint, const struct options *options, const struct picture_files *files) {
    memset(checkpoint, 0, sizeof *checkpoint); /* no temporary of this size on the stack, as elsewhere */
    checkpoint->on = options->checkpoint && !options->check;
    checkpoint->late = options->keeps_tiles;
    checkpoint->resume = options->resume;
    checkpoint->every = options->checkpoint_every;
    checkpoint->files = files;
}

static bool choose_path(struct checkpoint *checkpoint, const char *picture_name, struct error *error) {
    if (checkpoint->path[0] != '\0')
        return true;
    return picture_files_checkpoint(checkpoint->files, picture_name, checkpoint->path, error);
}

bool checkpoint_open(struct checkpoint *checkpoint, const char *picture_name, char notice[256], struct error *error) {
    notice[0] = '\0';
    if (checkpoint->refused.kind != ERROR_NONE) {
        *error = checkpoint->refused;
        return false;
    }
    if (checkpoint->opened || (checkpoint->late ? checkpoint->path[0] != '\0' : !checkpoint->on))
        return true;
    if (!choose_path(checkpoint, picture_name, error))
        return checkpoint->late;
    checkpoint->written_at = clock_now();
    bool there = file_is_regular(checkpoint->path);
    if (checkpoint->late) {
        checkpoint->opened = true;
        checkpoint->has_old = there;
        return true;
    }
    if (there && !checkpoint->resume && checkpoint->files->options->checkpoint_implied)
        there = false; /* its frames are made again, and it is replaced */
    if (there && !checkpoint->resume)
        return error_set(error, ERROR_USAGE,
                         "%.400s: a checkpoint of an earlier run exists; continue it with --resume, or remove it",
                         checkpoint->path) ||
               error_elsewhere(error);
    checkpoint->opened = !there;
    if (!there && checkpoint->resume)
        (void)snprintf(notice, 256, "gray: notice: there is no %.150s: the run starts from the beginning",
                       checkpoint->path);
    if (!there)
        return true;
    if (!tile_file_read(checkpoint->path, &checkpoint->old, error)) {
        (void)error_elsewhere(error);
        checkpoint->refused = *error;
        return false;
    }
    checkpoint->opened = checkpoint->has_old = true;
    (void)file_identity_of(checkpoint->path, &checkpoint->file);
    checkpoint->old_number = checkpoint->old.has_picture ? checkpoint->old.picture.number : 0;
    for (size_t i = 0; i < checkpoint->old.done_count; i++) {
        if (checkpoint->old.done[i].number > checkpoint->old_number)
            checkpoint->old_number = checkpoint->old.done[i].number;
    }
    return true;
}

/* Nothing is written after that: the file does not change. */
static bool refuse(struct checkpoint *checkpoint, const char *why, struct error *error) {
    error_set(&checkpoint->refused, ERROR_SCENE, "%.400s: cannot be resumed: %s", checkpoint->path, why);
    (void)error_elsewhere(&checkpoint->refused);
    checkpoint->opened = false;
    *error = checkpoint->refused;
    return false;
}

static bool add_done(struct checkpoint *checkpoint, const struct tile_done *done, struct error *error) {
    struct tile_done *more = mem_resize_array(checkpoint->done, checkpoint->done_count + 1, sizeof *more);
    if (!more)
        return error_no_memory(error, "the checkpoint");
    checkpoint->done = more;
    more[checkpoint->done_count++] = *done;
    return true;
}

bool checkpoint_has_written(struct checkpoint *checkpoint, uint32_t number, const struct tile_key *key,
                            const char *name, bool *written, struct error *error) {
    *written = false;
    checkpoint->number = number;
    if (!checkpoint->has_old)
        return true;
    for (size_t i = 0; i < checkpoint->old.done_count; i++) {
        const struct tile_done *done = &checkpoint->old.done[i];
        struct digest digest;
        if (done->number != number)
            continue;
        const char *difference = tile_key_difference(&done->key, key);
        if (difference)
            return refuse(checkpoint, difference, error);
        *written = strcmp(done->name, name) == 0 && file_digest(name, &digest) && digest_equal(digest, done->written);
        return !*written || add_done(checkpoint, done, error);
    }
    return true;
}

/* The file of an earlier run that this one does not go on with; key: of its first picture. */
static void judge_old(struct checkpoint *checkpoint, const struct tile_key *key, char notice[256]) {
    struct tile_file *old = &checkpoint->old;
    struct error ignored;
    if (!tile_file_read(checkpoint->path, old, &ignored))
        return;
    const struct tile_key *had = old->done_count > 0 ? &old->done[0].key : &old->picture.key;
    checkpoint->opened = digest_equal(had->options, key->options);
    if (!checkpoint->opened)
        (void)snprintf(notice, 256, "gray: notice: %.150s is of a run with other options, and stays", checkpoint->path);
    else if (!tile_key_difference(had, key))
        (void)snprintf(notice, 256, "gray: notice: %.150s is of this picture: --resume would go on with it",
                       checkpoint->path);
    if (checkpoint->opened)
        (void)file_identity_of(checkpoint->path, &checkpoint->file);
    tile_file_close(old);
}

bool checkpoint_restore(struct checkpoint *checkpoint, const struct tile_picture *picture, struct film *film,
                        char notice[256], struct error *error) {
    notice[0] = '\0';
    checkpoint->tiles_kept = 0;
    if (checkpoint->late && digest_is_zero(picture->key.files))
        checkpoint->opened = checkpoint->has_old = false; /* not all files are known that the scene was made from */
    if (checkpoint->late && checkpoint->has_old) {
        judge_old(checkpoint, &picture->key, notice);
        checkpoint->has_old = false;
    }
    if (!checkpoint->has_old || !checkpoint->old.has_picture || checkpoint->old.picture.number != picture->number)
        return true;
    const char *difference = tile_picture_difference(&checkpoint->old.picture, picture);
    if (difference || checkpoint->old.picture.shard != picture->shard)
        return refuse(checkpoint, difference ? difference : "it is another part of the picture", error);
    uint32_t twice;
    tile_file_restore(&checkpoint->old, film, &checkpoint->tiles_kept, &twice);
    uint32_t begun = film_tiles_begun(film);
    int length = snprintf(notice, 256, "gray: notice: %u of %u tiles of %.150s", checkpoint->tiles_kept,
                          film_tile_count(film), picture->name);
    if (begun > 0)
        length += snprintf(notice + length, 256 - (size_t)length, ", and samples of %u more,", begun);
    (void)snprintf(notice + length, 256 - (size_t)length, " come from the checkpoint");
    return true;
}

static struct file_target target_of(struct checkpoint *checkpoint) {
    const struct picture_files *files = checkpoint->files;
    bool named = options_are_named(files->options->checkpoint);
    return (struct file_target){checkpoint->path, named ? &files->named_checkpoint : &files->checkpoint,
                                &checkpoint->file};
}

static bool remove_file(struct checkpoint *checkpoint, struct error *error) {
    const struct file_target target = target_of(checkpoint);
    return file_output_remove(&target, checkpoint->file, error);
}

bool checkpoint_update(struct checkpoint *checkpoint, const struct tile_picture *picture, const struct film *film,
                       bool now, struct checkpoint_tiles *tiles, struct error *error) {
    if (!checkpoint->opened || checkpoint->number < checkpoint->old_number)
        return true;
    /* Writing takes at most a fixed share of the time. */
    double clock = clock_now(), pause = checkpoint->took * pause_factor;
    if (!now && clock - checkpoint->written_at < (checkpoint->every > pause ? checkpoint->every : pause))
        return true;
    struct checkpoint_tiles have = {film ? film_tiles_in(film, FILM_TILE_DONE) : 0, film ? film_tiles_begun(film) : 0};
    bool empty = have.done + have.begun == 0 && checkpoint->done_count == 0;
    /* Without --checkpoint, only an interrupted long run writes one. */
    if (checkpoint->late && (!now || empty || clock - checkpoint->written_at < long_run))
        return true;
    /* Nothing is new. */
    if (!now && !checkpoint->pending && have.done == checkpoint->tiles_kept && have.begun == 0)
        return true;
    const struct file_target target = target_of(checkpoint);
    bool ok = tile_file_write(&target, checkpoint->done, checkpoint->done_count, film ? picture : NULL, film, error);
    checkpoint->written_at = clock_now();
    checkpoint->took = checkpoint->written_at - clock;
    if (ok) {
        checkpoint->pending = false;
        checkpoint->tiles_kept = have.done;
        *tiles = have;
        return true;
    }
    /* Only the first failure is reported; each update tries again. */
    bool report = !checkpoint->failed || now;
    checkpoint->failed = true;
    return !report;
}

bool checkpoint_note_written(struct checkpoint *checkpoint, uint32_t number, const struct tile_key *key,
                             const char *name, struct error *error) {
    struct tile_done done = {.number = number, .key = *key};
    if (!checkpoint->opened)
        return true;
    checkpoint->pending = true;
    checkpoint->tiles_kept = 0;
    if (!file_digest(name, &done.written)) /* a pipe cannot be checked again */
        return true;
    (void)snprintf(done.name, sizeof done.name, "%s", name);
    return add_done(checkpoint, &done, error);
}

bool checkpoint_finish(struct checkpoint *checkpoint, bool all_written, struct error *error) {
    bool ok = true;
    struct checkpoint_tiles tiles;
    bool written = checkpoint->file.device || checkpoint->file.inode;
    if (checkpoint->opened && all_written)
        ok = !written || remove_file(checkpoint, error);
    else if (checkpoint->opened && checkpoint->pending)
        ok = checkpoint_update(checkpoint, NULL, NULL, true, &tiles, error);
    tile_file_close(&checkpoint->old);
    mem_free(checkpoint->done);
    memset(checkpoint, 0, sizeof *checkpoint);
    return ok;
}
