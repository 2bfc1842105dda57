/* A picture has three steps: begin, done or abandon, and (for one under -o) the end of the run. Under -o without %d the
 * first picture is kept in memory until it is known that no second one comes: two pictures under one name are wrong
 * usage, and then no file may have been touched. */
#include "output/output_session.h"

#include "base/clock.h"
#include "base/error.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/terminal_text.h"
#include "base/version.h"
#include "image/exr.h"
#include "image/picture_file.h"
#include "output/statistics_internal.h"
#include "session/standard_streams.h"
#include "session/text.h"

#include <stdarg.h>
#include <string.h>

/* A viewer that is gone is a warning; the picture does not depend on it. */
static void report_display(struct output_session *output, bool ok, const struct error *error) {
    if (ok)
        return;
    output_say(output, LINE_WARNING, "gray: warning: %s", error->text);
}

/* False: standard error takes nothing, and the run is to end; nothing more is shown. */
static bool wait_for_text(struct output_session *output) {
    if (!output->wait_for_text || output->wait_for_text(output->wait_context))
        return true;
    output->progress.mode = PROGRESS_NONE;
    output->progress.columns = 0;
    return false;
}

/* Around what the program prints on standard error: the scene waits, and its unfinished line is ended. False: it is not
 * to be printed. */
static bool begin_report(struct output_session *output) {
    if (!wait_for_text(output))
        return false;
    if (output->control) {
        error_stream_take(&output->control->error_stream, ERROR_STREAM_PROGRAM);
        error_stream_begin_line(&output->control->error_stream);
    }
    return true;
}

static void end_report(struct output_session *output) {
    if (output->control)
        error_stream_give(&output->control->error_stream, ERROR_STREAM_PROGRAM);
}

void output_init(struct output_session *output, const struct options *options, struct control *control) {
    struct error error;
    memset(output, 0, sizeof *output);
    output->options = options;
    output->control = control;
    picture_files_init(&output->files, options);
    checkpoint_init(&output->checkpoint, options, &output->files);
    animation_init(&output->animation, options, &output->files);
    progress_init(&output->progress, options->progress, options->quiet, options->threads);
    output->progress.stream = control ? &control->error_stream : NULL;
    report_display(output, display_open(&output->display, options->display, &error), &error);
}

static bool one_name_for_all(const struct output_session *output) {
    const struct options *options = output->options;
    return options->output && options->animation == ANIMATION_NONE && !output_name_numbered(options->output);
}

/* The number in -o: the number of the frame, or else of the picture. */
static unsigned number_of(const struct output_session *output, const struct picture_request *request) {
    return request->frame.number > 0 ? request->frame.before + request->frame.number : output->pictures;
}

/* The same for a picture that has begun. */
static uint32_t frame_number(const struct picture *picture) {
    return picture->request.frame.number > 0 ? picture->request.frame.number : picture->tiles.number;
}

/* The name of the picture, also of one that is only checked. */
static bool choose_name(struct output_session *output, const struct picture_request *request, char name[NAME_LIMIT],
                        struct error *error) {
    char notice[NAME_LIMIT + 128];
    const struct picture_label label = {request->file, number_of(output, request), request->frame.number};
    if (one_name_for_all(output) && output->pictures > 1 && !animation_streams(&output->animation, request)) {
        output->several_under_one_name = true;
        return error_set(
            error, ERROR_USAGE,
            "-o %s: several pictures are rendered, so the name needs %%d, or an ending of animations such as "
            ".gif or .mp4",
            output->options->output);
    }
    if (!picture_files_name(&output->files, &label, name, notice, error))
        return false;
    if (notice[0] != '\0')
        output_report(output, LINE_NOTICE, notice);
    return true;
}

/* Whether the files of the picture can be written. The first picture decides the name of the checkpoint. In a farm only
 * the first rank writes. */
static bool check_files(struct output_session *output, const struct picture *picture, struct error *error) {
    if (picture->request.keep && file_is_regular(picture->name))
        return error_set(error, ERROR_SCENE, "%s: exists, and is not replaced", picture->name);
    bool keeps = output->options->checkpoint != NULL;
    char *checkpoint = output->checkpoint.path;
    bool first = keeps && checkpoint[0] == '\0';
    if (output->farm && !farm_is_first(output->farm))
        return true;
    return (picture->request.check || animation_lock(&output->animation, error)) &&
           (!first || picture_files_checkpoint(&output->files, picture->name, checkpoint, error)) &&
           picture_files_check(&output->files, picture->name, picture->request.layers & AOV_ALL,
                               keeps ? checkpoint : NULL, first, error);
}

/* --check prints the names of the pictures that a run would write. */
static bool check_only(struct output_session *output, const struct picture *picture, struct error *error) {
    char line[NAME_LIMIT + 96];
    if (!output->options->check)
        return true; /* --pixel and --dump-scene write nothing and make no folders */
    if (!check_files(output, picture, error))
        return false;
    (void)snprintf(line, sizeof line, "%s: %u x %u\n", picture->name,
                   picture->request.shown.x1 - picture->request.shown.x0,
                   picture->request.shown.y1 - picture->request.shown.y0);
    if (!output->options->quiet)
        output_report(output, LINE_OUTPUT, line);
    return true;
}

static void describe_tiles(const struct output_session *output, struct picture *picture) {
    const struct picture_request *request = &picture->request;
    const struct options *options = output->options;
    struct tile_picture *tiles = &picture->tiles;
    memset(tiles, 0, sizeof *tiles); /* no temporary of this size on the stack */
    tiles->number = output->pictures;
    tiles->key = (struct tile_key){GRAY_VERSION, options_digest(options), request->files};
    tiles->full_width = request->full_width;
    tiles->full_height = request->full_height;
    tiles->x0 = request->x0;
    tiles->y0 = request->y0;
    tiles->width = request->width;
    tiles->height = request->height;
    tiles->shown = request->shown;
    tiles->settings = request->settings;
    tiles->record = request->record;
    tiles->shard = options->shards ? options->shard : 1;
    tiles->shards = options->shards ? options->shards : 1;
    tiles->settings.tone.table = NULL;
    tiles->tone_table = request->tone_table;
    memcpy(tiles->name, picture->name, sizeof tiles->name);
}

/* The command line may choose any size. The renderer counts more exactly, but it may have been taken over. */
static bool allow_film(const struct output_session *output, size_t bytes, struct error *error) {
    const struct options *options = output->options;
    char size[SIZE_WORDS];
    if (options->width || options->action == ACTION_MERGE || bytes <= script_picture_memory(&options->script))
        return true;
    return error_set_limit(error, "the picture takes more than the %s that --script-memory leaves for it",
                           size_words(script_picture_memory(&options->script), size));
}

static void close_picture(struct picture *picture) {
    share_destroy(&picture->memory);
    picture->open = false;
}

static bool make_film(struct output_session *output, struct picture *picture, struct error *error) {
    const struct picture_request *request = &picture->request;
    size_t bytes;
    char notice[256];
    close_picture(&output->previous); /* no two films of frames in memory */
    if (!picture_film_size(request, &bytes, error) || !allow_film(output, bytes, error))
        return false;
    if (!share_create(&picture->memory, bytes, error))
        return error_prefix(error, "%s", picture->name);
    picture_film_layout(request, picture->memory.block, &picture->film);
    if (!checkpoint_restore(&output->checkpoint, &picture->tiles, &picture->film, notice, error)) {
        share_destroy(&picture->memory);
        return false;
    }
    if (notice[0] != '\0')
        output_report(output, LINE_NOTICE, notice);
    return true;
}

/* A part, or NULL if it cannot be read. It is not on the stack, which may be small. */
static struct tile_file *open_part(const char *name) {
    struct error ignored;
    struct tile_file *file = mem_alloc_zero(1, sizeof *file);
    if (file && tile_file_read(name, file, &ignored))
        return file;
    mem_free(file);
    return NULL;
}

static void close_part(struct tile_file *file) {
    tile_file_close(file);
    mem_free(file);
}

/* With --resume: whether the part exists, is finished, and belongs to this picture. */
static bool part_is_written(const struct output_session *output, const char *name) {
    const struct tile_picture *want = &output->current.tiles;
    bool exists = output->options->shards && output->options->resume && file_is_regular(name);
    struct tile_file *file = exists ? open_part(name) : NULL;
    if (!file)
        return false;
    const struct tile_picture *have = &file->picture;
    bool there = file->has_picture && have->whole && have->shard == want->shard && !tile_picture_difference(have, want);
    close_part(file);
    return there;
}

/* In a farm: compares the picture with those of the other ranks. */
static bool join_farm(struct output_session *output, bool *already, struct error *error) {
    struct picture *picture = &output->current;
    if (!output->farm)
        return true;
    bool was_written = *already;
    bool ok = farm_begin(output->farm, &picture->tiles, was_written ? NULL : &picture->film, already, error);
    if (!was_written && (!ok || *already))
        share_destroy(&picture->memory);
    return ok;
}

static bool is_played(const struct picture_request *request) {
    return request->in_window && request->frame.number > 0;
}

unsigned output_number_of(const struct output_session *output, const struct picture_request *request) {
    return output->plays && is_played(request) ? output->pictures : output->pictures + 1;
}

/* Limits of the run. *already: another process has this picture (--shard-pictures). */
static bool count_picture(struct output_session *output, const struct picture_request *request, bool *already,
                          struct error *error) {
    const struct options *options = output->options;
    output->pictures = output_number_of(output, request);
    output->plays = is_played(request);
    if (!options_allow_picture(options, output->pictures, error))
        return false;
    if (output->files.quota.written == output->files.quota.limit)
        return error_set_limit(error, "%s", output->files.quota.words);
    *already = *already || (options->shards_of_pictures &&
                            (output->pictures - 1) % options->shards_of_pictures != options->shard_of_pictures - 1);
    return true;
}

/* Of an earlier run. True. */
static bool remove_partial(struct output_session *output, const struct picture *picture) {
    picture_files_remove_partial(&output->files, picture->name);
    return true;
}

static bool write_picture(struct output_session *output, const struct picture *picture, struct error *error) {
    char name[NAME_LIMIT];
    if (animation_streams(&output->animation, &picture->request))
        return animation_put(&output->animation, picture, error);
    return picture_files_written(&output->files, picture->name, name, error) &&
           picture_write_files(&output->files, picture, name, error) && remove_partial(output, picture) &&
           (output->options->shards || animation_add(&output->animation, name, error)) &&
           checkpoint_note_written(&output->checkpoint, picture->tiles.number, &picture->tiles.key, name, error);
}

static bool write_timed(struct output_session *output, struct picture *picture, struct error *error) {
    double begun = clock_now(), worked = clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    bool ok = output->interrupted ? error_set(error, ERROR_CANCELLED, "%.600s: interrupted", picture->name)
                                  : write_picture(output, picture, error);
    picture->write_seconds = clock_now() - begun;
    picture->write_processor_seconds = clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - worked;
    return ok;
}

/* The picture is equal to the previous one, which is written again under the new name. Its own request describes its
 * film. In a farm the first rank decides. */
static bool write_again(struct output_session *output, bool *already, struct error *error) {
    const struct picture *picture = &output->current;
    struct picture *again = &output->previous;
    if (!picture->request.repeats || !again->open || (output->farm && !farm_is_first(output->farm)))
        return true;
    output_say(output, LINE_DETAIL, "%s%s: frame %u is a copy of frame %u", scene_mark(picture->name), picture->name,
               frame_number(picture), frame_number(again));
    memcpy(again->name, picture->name, sizeof again->name);
    memcpy(again->tiles.name, picture->name, sizeof again->tiles.name);
    again->tiles.number = picture->tiles.number;
    again->tiles.key = picture->tiles.key;
    again->request.frame = picture->request.frame;
    return *already = write_timed(output, again, error);
}

/* Uses existing results for the picture: a part, a file of an earlier run, the film of an equal frame, tiles of a
 * checkpoint or of the farm. */
static bool prepare_film(struct output_session *output, const char *written, bool *already, struct error *error) {
    struct picture *picture = &output->current;
    char notice[256];
    *already = part_is_written(output, written);
    if (*already)
        return true;
    if (!checkpoint_open(&output->checkpoint, picture->name, notice, error))
        return false;
    if (notice[0] != '\0')
        output_report(output, LINE_NOTICE, notice);
    if (!checkpoint_has_written(&output->checkpoint, output->pictures, &picture->tiles.key, written, already, error))
        return false;
    bool existed = *already;
    if (!existed && !write_again(output, already, error))
        return false;
    if ((!*already && !make_film(output, picture, error)) || !join_farm(output, already, error))
        return false;
    if (*already)
        picture_files_own(&output->files, written);
    return !existed || output->options->shards || animation_add(&output->animation, written, error);
}

/* The picture is open from here on: progress and displays show it. */
static void start_picture(struct output_session *output) {
    struct picture *picture = &output->current;
    const struct picture_request *request = &picture->request;
    struct tone tone = picture_tone(request);
    picture->open = true;
    atomic_store(&output->control->tiles, 0);
    atomic_store(&output->control->tiles_done, 0);
    atomic_store(&output->control->unshot, 0.0F);
    progress_estimate_reset(&output->control->progress_estimate,
                            output->progress.mode != PROGRESS_NONE && !request->in_window && !output->farm);
    (void)wait_for_text(output);
    if (!output->plays)
        progress_begin(&output->progress, picture->name, request->width, request->height,
                       picture_denoised_pixels(output->options, picture));
    output->progress.elsewhere = request->in_window != 0;
    if (!request->in_window)
        display_begin(&output->display, picture->name, &picture->film, &tone);
}

/* A picture whose name this run has used already. Names of -o have only the number of a frame, so a second picture of
 * the frame is an error; the names of a script are its own choice. */
static bool check_own(struct output_session *output, const struct picture_request *request, const char *written,
                      struct error *error) {
    /* With --watch, and after a crash in a farm, scripts render their pictures again. */
    bool again = request->in_window || output->options->watch || output->farm;
    if (again || !picture_files_is_own(&output->files, written))
        return true;
    if (request->frame.number > 0 && output->options->output)
        return error_set(error, ERROR_USAGE,
                         "-o %.600s: %.600s, the only name for frame %u, is already another picture of this run; "
                         "without -o, pictures have the names of the script",
                         output->options->output, written, request->frame.number);
    output_say(output, LINE_NOTICE,
               "gray: notice: %s replaces a picture that this run wrote before under the same name", written);
    return true;
}

/* The file of a solution is named once. */
bool output_begin_model(struct output_session *output, const struct model_request *request, struct error *error) {
    struct model_output *model = &output->model;
    const struct picture_label label = {request->file, output->pictures + !output->current.open, 0};
    char name[NAME_LIMIT], notice[NAME_LIMIT + 128];
    model->is_later = label.number > 1;
    if (request->role == MODEL_SOLUTION && model->solution[0] == '\0' && options_keep_solution(output->options) &&
        (!picture_files_name(&output->files, &label, name, notice, error) ||
         !picture_files_solution(&output->files, name, model->solution, error)))
        return false;
    return model_output_begin(model, &output->files, request, error);
}

bool output_begin(struct output_session *output, const struct picture_request *request, bool *already,
                  struct error *error) {
    struct picture *picture = &output->current;
    char written[NAME_LIMIT];
    if (!count_picture(output, request, already, error))
        return false;
    if (*already)
        return true;
    /* Its name, and whether that can be written, before anything is rendered. */
    if (!choose_name(output, request, picture->name, error) ||
        !picture_files_written(&output->files, picture->name, written, error))
        return false;
    if (picture_format(written) == PICTURE_EXR && !exr_can_write())
        return error_set(error, ERROR_SCENE, "%s: EXR pictures need OpenEXR, and this build was made without it",
                         written);
    if (request->settings.transparent &&
        (picture_format(written) == PICTURE_PFM || picture_format(written) == PICTURE_HDR ||
         picture_format(written) == PICTURE_LIGHT_FIELD || output->options->animation != ANIMATION_NONE))
        return error_set(error, ERROR_SCENE, "%s: background 'transparent' needs a file with alpha: .png or .exr",
                         written);
    if (request->settings.lens.depth &&
        (output->options->animation != ANIMATION_NONE || animation_streams(&output->animation, request)))
        return error_set(error, ERROR_SCENE, "%s: a light field with depths cannot be a frame of an animation",
                         written);
    if (!animation_begin(&output->animation, request, number_of(output, request), error))
        return false;
    /* Frames of an animation have 8 bits a channel. */
    picture->request = *request;
    picture->request.settings.deep = request->settings.deep && output->options->animation == ANIMATION_NONE;
    picture->written = output->plays;
    picture->write_seconds = picture->write_processor_seconds = 0;
    if (request->check) {
        picture->open = check_only(output, picture, error);
        return picture->open;
    }
    if (!output->plays && !check_files(output, picture, error))
        return false;
    if (!check_own(output, request, written, error))
        return false;
    /* The film, or what an earlier run has left of the picture. */
    describe_tiles(output, picture);
    if (!prepare_film(output, written, already, error))
        return false;
    if (!*already)
        start_picture(output);
    return true;
}

/* The picture whose tiles a checkpoint would hold, or NULL. */
static const struct picture *kept_picture(const struct output_session *output) {
    const struct picture *current = &output->current;
    if (current->open && !current->request.check && !current->written)
        return current;
    return output->held.open ? &output->held : NULL;
}

/* True when the file was written just now. */
static bool update_checkpoint(struct output_session *output, bool now, struct checkpoint_tiles *tiles) {
    const struct picture *picture = kept_picture(output);
    struct error error;
    const uint32_t nothing = UINT32_MAX;
    tiles->done = nothing;
    if (!checkpoint_update(&output->checkpoint, picture ? &picture->tiles : NULL, picture ? &picture->film : NULL, now,
                           tiles, &error))
        output_say(output, LINE_WARNING, "gray: warning: the checkpoint: %s", error.text);
    return tiles->done != nothing;
}

/* ", and samples of 20 more", or nothing. */
static void describe_begun(uint32_t begun, char out[48]) {
    out[0] = '\0';
    if (begun > 0)
        (void)snprintf(out, 48, ", and samples of %u more", begun);
}

static void report_checkpoint(struct output_session *output, struct checkpoint_tiles tiles) {
    char begun[48];
    const struct picture *picture = kept_picture(output);
    describe_begun(tiles.begun, begun);
    if (picture)
        output_say(output, LINE_NOTICE, "gray: notice: %.3000s holds %u of %u tiles of %.3000s%s (--resume continues)",
                   output->checkpoint.path, tiles.done, film_tile_count(&picture->film), picture->name, begun);
    else
        output_say(output, LINE_NOTICE, "gray: notice: %.3000s holds %zu finished pictures", output->checkpoint.path,
                   output->checkpoint.done_count);
}

void output_write_checkpoint(struct output_session *output) {
    struct checkpoint_tiles tiles;
    if (!output->checkpoint.on)
        output_report(output, LINE_NOTICE, "gray: notice: SIGUSR1 writes a checkpoint only with --checkpoint FILE");
    else if (update_checkpoint(output, true, &tiles))
        report_checkpoint(output, tiles);
}

/* Writes the finished part of an interrupted picture under a separate name. */
static void write_partial(struct output_session *output, struct picture *picture, bool keeps_tiles) {
    uint32_t done = film_tiles_in(&picture->film, FILM_TILE_DONE), begun = film_tiles_begun(&picture->film);
    struct error error;
    char name[NAME_LIMIT], of_begun[48];
    const struct file_target target = {.path = name, .rules = &output->files.partial};
    if (done + begun == 0 || !picture_files_partial(&output->files, picture->name, name))
        return;
    film_clear_unfinished(&picture->film);
    struct picture_shown *shown = NULL;
    picture->unfinished = true;
    bool ok = (shown = picture_shown_make(picture, (struct denoising){DENOISER_NONE, NULL, NULL}, &error)) &&
              picture_write_view(&shown->picture, &target, FILM_FINAL, NULL, &error);
    picture_shown_destroy(shown);
    if (!ok) {
        output_report(output, LINE_ERROR, error.text);
        return;
    }
    describe_begun(begun, of_begun);
    output_say(output, LINE_NOTICE, "gray: notice: %s holds %u of %u tiles%s%s", name, done,
               film_tile_count(&picture->film), of_begun,
               output->options->keeps_tiles && !keeps_tiles ? " (--checkpoint auto keeps them for --resume)" : "");
}

/* A picture that is not written: its tiles go into the checkpoint and the partial picture. */
static void keep_tiles(struct output_session *output, struct picture *picture) {
    struct checkpoint_tiles tiles;
    bool kept = update_checkpoint(output, true, &tiles);
    if (kept)
        report_checkpoint(output, tiles);
    write_partial(output, picture, kept);
}

void output_abandon(struct output_session *output) {
    model_output_forget(&output->model);
    const struct picture *current = &output->current;
    display_forget(&output->display);
    progress_end(&output->progress, PROGRESS_GIVEN_UP);
    if (output->farm)
        farm_end(output->farm, true);
    if (current->open && !current->request.check && !current->written &&
        film_tiles_in(&current->film, FILM_TILE_DONE) + film_tiles_begun(&current->film) > 0)
        keep_tiles(output, &output->current);
    close_picture(&output->current);
}

/* A picture is complete, but was not written. After an interrupt its tiles are kept, as those of an unfinished one. */
static void keep_unwritten(struct output_session *output, struct picture *picture, const struct error *error) {
    if (error->kind == ERROR_CANCELLED)
        keep_tiles(output, picture);
}

static void report_statistics(struct output_session *output, const struct picture *picture,
                              const struct picture_report *of_render) {
    struct picture_report report = *of_render;
    report.write_seconds = picture->write_seconds;
    report.write_processor_seconds = picture->write_processor_seconds;
    switch (output->options->statistics) {
    case STATISTICS_NONE:
        return;
    case STATISTICS_TEXT:
        if (begin_report(output)) {
            statistics_print_text(standard_error(), picture->name, &picture->request, &report);
            end_report(output);
        }
        return;
    case STATISTICS_JSON:
        statistics_print_json(standard_output(), picture->name, &picture->request, &report);
        return;
    }
}

/* True: this process only helps, and the picture is written by another one. */
static bool leave_to_first_rank(struct output_session *output) {
    char shares[512];
    if (!output->farm)
        return false;
    farm_end(output->farm, false);
    if (!farm_is_first(output->farm)) {
        close_picture(&output->current);
        return true;
    }
    farm_shares(output->farm, shares, sizeof shares);
    output_say(output, LINE_DETAIL, "%s%s: tiles made by each rank: %s", scene_mark(output->current.name),
               output->current.name, shares);
    return false;
}

bool output_write(struct output_session *output, struct error *error) {
    output->current.written = write_timed(output, &output->current, error);
    progress_end(&output->progress, output->current.written ? PROGRESS_WRITTEN : PROGRESS_GIVEN_UP);
    return output->current.written;
}

/* Tiles of a farm come from other ranks as well, those of a checkpoint from an earlier run. */
static void warn_of_clamped(struct output_session *output, const struct picture_report *report) {
    if (!report->rays.clamped && !film_holds_largest(&output->current.film))
        return;
    output_say(output, LINE_WARNING,
               "gray: warning: %s: light beyond the largest float is clamped to it, undefined values are 0",
               output->current.name);
}

/* The progress has pointers into the picture, so it must have ended. */
static void move_picture(struct picture *to, struct picture *from) {
    *to = *from;
    memset(from, 0, sizeof *from);
}

bool output_done(struct output_session *output, const struct picture_report *report, struct error *error) {
    struct error gone;
    if (leave_to_first_rank(output))
        return true;
    if (output->plays) {
        close_picture(&output->current);
        return true;
    }
    progress_hide(&output->progress);
    report_display(output, display_end(&output->display, &gone), &gone);
    warn_of_clamped(output, report);
    /* The window has written it already. */
    if (output->current.written) {
        report_statistics(output, &output->current, report);
        close_picture(&output->current);
        return true;
    }
    /* A second picture would be wrong usage, so the first one waits in memory. */
    if (one_name_for_all(output) && !animation_streams(&output->animation, &output->current.request)) {
        progress_end(&output->progress, PROGRESS_WRITTEN);
        output->held_report = *report;
        move_picture(&output->held, &output->current);
        return true;
    }
    bool ok = write_timed(output, &output->current, error);
    progress_end(&output->progress, ok ? PROGRESS_WRITTEN : PROGRESS_GIVEN_UP);
    if (ok)
        report_statistics(output, &output->current, report);
    else
        keep_unwritten(output, &output->current, error);
    /* The next frame may be equal to this one, and is then written from its film. */
    if (ok && (output->current.request.frame.number > 0 || output->options->animation != ANIMATION_NONE))
        move_picture(&output->previous, &output->current);
    close_picture(&output->current);
    return ok;
}

void output_show_progress(struct output_session *output) {
    struct checkpoint_tiles ignored;
    uint32_t done = atomic_load(&output->control->tiles_done), count = atomic_load(&output->control->tiles);
    struct error error;
    (void)update_checkpoint(output, false, &ignored);
    if (output->farm) {
        farm_step(output->farm);
        if (output->current.open && count > 0)
            done = film_tiles_in(&output->current.film, FILM_TILE_DONE);
    }
    if (display_draws(&output->display, clock_now()))
        progress_hide(&output->progress);
    report_display(output, display_step(&output->display, clock_now(), &error), &error);
    output->progress.unshot = (double)atomic_load(&output->control->unshot);
    progress_update(&output->progress, done, count, &output->control->progress_estimate);
}

void output_report(struct output_session *output, enum line_kind kind, const char *text) {
    bool shown = false;
    if (output->farm && kind == LINE_ERROR)
        farm_report(output->farm, text);
    if (output->farm && !farm_is_first(output->farm))
        return; /* the first rank has the same line, or prints it at the end */
    switch (kind) {
    case LINE_ERROR:
        shown = true;
        break;
    case LINE_WARNING:
    case LINE_NOTICE:
        shown = !output->options->quiet;
        break;
    case LINE_DETAIL:
        shown = output->options->verbose;
        break;
    case LINE_OUTPUT:
        text_print(standard_output(), text);
        (void)fflush(standard_output());
        return;
    }
    if (!shown || !begin_report(output))
        return;
    progress_hide(&output->progress);
    if (kind == LINE_DETAIL)
        text_print_line(standard_error(), text);
    else
        text_print_message(standard_error(),
                           kind == LINE_ERROR     ? TEXT_ERROR
                           : kind == LINE_WARNING ? TEXT_WARNING
                                                  : TEXT_NOTICE,
                           text);
    end_report(output);
}

void output_say(struct output_session *output, enum line_kind kind, const char *format, ...) {
    char text[2 * NAME_LIMIT];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    output_report(output, kind, text);
}

bool output_flush_streams(struct output_session *output, struct error *error) {
    bool written = fflush(standard_output()) == 0 && !ferror(standard_output()) &&
                   (!output->control || !atomic_load(&output->control->lost));
    return written || error_set(error, ERROR_MACHINE, "gray: standard output cannot be written");
}

void output_warn_no_sandbox(struct output_session *output) {
    if (output->options->script.no_sandbox)
        output_report(output, LINE_WARNING,
                      "gray: warning: --no-sandbox: scenes may read and write all your files and start programs");
}

void output_set_interrupt(struct output_session *output, const struct file_interrupt *interrupt) {
    output->files.interrupt = *interrupt;
}

bool output_write_held(struct output_session *output, struct error *error) {
    bool ok = true;
    close_picture(&output->previous); /* it is the end of a run */
    if (output->held.open && !output->several_under_one_name)
        ok = write_timed(output, &output->held, error);
    if (output->held.open && ok)
        report_statistics(output, &output->held, &output->held_report);
    else if (!ok)
        keep_unwritten(output, &output->held, error);
    close_picture(&output->held);
    return ok;
}

void output_restart(struct output_session *output) {
    close_picture(&output->held);
    output->pictures = 0;
    output->plays = false;
    animation_restart(&output->animation);
    output->files.quota.written = 0;
    output->several_under_one_name = output->interrupted = false;
}

bool output_assemble(struct output_session *output, struct error *error) {
    bool helps = output->farm && !farm_is_first(output->farm);
    return helps || animation_finish(&output->animation, error);
}

/* Frames of an animation that was not written remain, for --resume or gray merge. */
static void close_animation(struct output_session *output) {
    uint32_t left;
    bool kept = output->options->keep_frames && output->animation.count == 0;
    animation_destroy(&output->animation, &left);
    if (left == 0 || kept || output->options->action != ACTION_RENDER)
        return;
    output_say(output, LINE_NOTICE, "gray: notice: %.3800s.frames holds %u frame%s%s", output->options->output, left,
               left > 1 ? "s" : "", output->options->checkpoint ? " (--resume continues)" : "");
}

bool output_finish(struct output_session *output, bool all_well, struct error *error) {
    struct error kept;
    bool ok = output_write_held(output, error) && (!all_well || output_assemble(output, error));
    if (output->checkpoint.late && !output->interrupted) /* a changed scene could not go on with it */
        output->checkpoint.pending = false;
    if (!checkpoint_finish(&output->checkpoint, ok && all_well, &kept))
        output_say(output, LINE_WARNING, "gray: warning: the checkpoint: %s", kept.text);
    close_animation(output);
    picture_files_destroy(&output->files);
    display_close(&output->display);
    return ok;
}
