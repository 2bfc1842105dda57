/* A picture has three steps: begin, done or abandon, and (for one under -o) the end of the run. Under -o without %d the
 * first picture is kept in memory until it is known that no second one comes: two pictures under one name are wrong
 * usage, and then no file may have been touched. */
#include "output/output_session.h"

#include "base/file.h"
#include "base/size.h"
#include "base/terminal_text.h"
#include "base/version.h"
#include "image/exr.h"
#include "output/layers.h"
#include "output/statistics.h"
#include "render/aov.h"
#include "session/text.h"

#include <string.h>

/* A viewer that is gone is told of; the picture does not depend on it. */
static void show_elsewhere(struct desk *desk, bool ok, const struct error *error) {
    char line[sizeof error->text + 32];
    if (ok)
        return;
    (void)snprintf(line, sizeof line, "gray: warning: %s", error->text);
    desk_line(desk, LINE_WARNING, line);
}

/* False: standard error takes nothing, and the run is to end; nothing more is shown. */
static bool takes_text(struct desk *desk) {
    if (!desk->takes_text || desk->takes_text(desk->takes_context))
        return true;
    desk->progress.mode = PROGRESS_NONE;
    desk->progress.columns = 0;
    return false;
}

/* Around what the program prints on standard error: the scene waits, and its unfinished line is ended. False: it is not
 * to be printed. */
static bool begin_words(struct desk *desk) {
    if (!takes_text(desk))
        return false;
    if (desk->control) {
        error_stream_take(&desk->control->error_stream, ERROR_STREAM_PROGRAM);
        error_stream_begin_line(&desk->control->error_stream);
    }
    return true;
}

static void end_words(struct desk *desk) {
    if (desk->control)
        error_stream_give(&desk->control->error_stream, ERROR_STREAM_PROGRAM);
}

void desk_init(struct desk *desk, const struct options *options, struct control *control) {
    struct error error;
    memset(desk, 0, sizeof *desk);
    desk->options = options;
    desk->control = control;
    picture_files_init(&desk->files, options);
    keeper_init(&desk->keeper, options, &desk->files);
    progress_init(&desk->progress, options->progress, options->quiet, options->threads);
    desk->progress.stream = control ? &control->error_stream : NULL;
    show_elsewhere(desk, display_open(&desk->display, options->display, &error), &error);
}

static bool one_name_for_all(const struct desk *desk) {
    return desk->options->output && !output_name_numbered(desk->options->output);
}

/* The name of the picture, also of one that is only checked. */
static bool choose_name(struct desk *desk, const char *from_script, char name[NAME_LIMIT], struct error *error) {
    char notice[NAME_LIMIT + 128];
    if (one_name_for_all(desk) && desk->pictures > 1) {
        desk->several_under_one_name = true;
        return error_set(error, ERROR_USAGE, "-o %s: several pictures are rendered, so the name needs %%d",
                         desk->options->output);
    }
    if (!picture_files_name(&desk->files, from_script, desk->pictures, name, notice, error))
        return false;
    if (notice[0] != '\0')
        desk_line(desk, LINE_NOTICE, notice);
    return true;
}

/* Whether the files of the picture can be written. The first picture decides the name of the checkpoint. In a farm only
 * the first rank writes. */
static bool check_files(struct desk *desk, const struct picture *picture, struct error *error) {
    bool keeps = desk->options->checkpoint != NULL;
    char *checkpoint = desk->keeper.path;
    bool first = keeps && checkpoint[0] == '\0';
    if (desk->farm && !farm_is_first(desk->farm))
        return true;
    return (!first || picture_files_checkpoint(&desk->files, picture->name, checkpoint, error)) &&
           picture_files_check(&desk->files, picture->name, picture->request.layers & AOV_ALL,
                               keeps ? checkpoint : NULL, first, error);
}

/* --check prints the names of the pictures that a run would write. */
static bool check_only(struct desk *desk, const struct picture *picture, struct error *error) {
    char line[NAME_LIMIT + 96];
    if (!desk->options->check)
        return true; /* --pixel and --dump-scene write nothing and make no folders */
    if (!check_files(desk, picture, error))
        return false;
    (void)snprintf(line, sizeof line, "%s: %u x %u\n", picture->name, picture->request.width, picture->request.height);
    if (!desk->options->quiet)
        desk_line(desk, LINE_OUTPUT, line);
    return true;
}

static void describe_tiles(const struct desk *desk, struct picture *picture) {
    const struct picture_request *request = &picture->request;
    const struct options *options = desk->options;
    struct tile_picture *tiles = &picture->tiles;
    *tiles = (struct tile_picture){.number = desk->pictures,
                                   .key = {GRAY_VERSION, options_digest(options), request->files},
                                   .full_width = request->full_width,
                                   .full_height = request->full_height,
                                   .x0 = request->x0,
                                   .y0 = request->y0,
                                   .width = request->width,
                                   .height = request->height,
                                   .tone = picture_tone(request),
                                   .deep = request->deep != 0,
                                   .record = request->record,
                                   .shard = options->shards ? options->shard : 1,
                                   .shards = options->shards ? options->shards : 1};
    memcpy(tiles->name, picture->name, sizeof tiles->name);
}

/* The command line may choose any size. The renderer counts more exactly, but it may have been taken over. */
static bool allow_film(const struct desk *desk, size_t bytes, struct error *error) {
    const struct options *options = desk->options;
    char size[SIZE_WORDS];
    if (options->width || options->action == ACTION_MERGE || bytes <= script_picture_memory(&options->script))
        return true;
    return error_set_limit(error, "the picture takes more than the %s that --script-memory leaves for it",
                           size_words(script_picture_memory(&options->script), size));
}

static bool make_film(struct desk *desk, struct picture *picture, struct error *error) {
    const struct picture_request *request = &picture->request;
    size_t bytes;
    char notice[256];
    if (!film_size_layered(request->width, request->height, request->record, marks_layers(request), &bytes, error) ||
        !allow_film(desk, bytes, error))
        return false;
    if (!share_create(&picture->memory, bytes, error))
        return error_prefix(error, "%s", picture->name);
    film_place(&picture->film, picture->memory.block, request->width, request->height, request->record);
    film_place_layers(&picture->film, picture->memory.block, request->layers & AOV_ALL);
    picture->film.x0 = request->x0;
    picture->film.y0 = request->y0;
    picture->film.full_width = request->full_width;
    picture->film.full_height = request->full_height;
    if (!keeper_restore(&desk->keeper, &picture->tiles, &picture->film, notice, error)) {
        share_destroy(&picture->memory);
        return false;
    }
    if (notice[0] != '\0')
        desk_line(desk, LINE_NOTICE, notice);
    return true;
}

/* With --resume: whether the part is there, finished, and of this very picture. */
static bool part_is_there(const struct desk *desk, const char *name) {
    struct tile_file file;
    struct error ignored;
    const struct tile_picture *want = &desk->current.tiles, *have = &file.picture;
    if (!desk->options->shards || !desk->options->resume || !file_is_regular(name) ||
        !tile_file_read(name, &file, &ignored))
        return false;
    bool there = file.has_picture && have->whole && have->shard == want->shard && !tile_picture_difference(have, want);
    tile_file_close(&file);
    return there;
}

/* In a farm: what the others say to it. */
static bool join_farm(struct desk *desk, bool *already, struct error *error) {
    struct picture *picture = &desk->current;
    if (!desk->farm)
        return true;
    bool was_written = *already;
    bool ok = farm_begin(desk->farm, &picture->tiles, was_written ? NULL : &picture->film, already, error);
    if (!was_written && (!ok || *already))
        share_destroy(&picture->memory);
    return ok;
}

bool desk_begin(struct desk *desk, const struct picture_request *request, bool *already, struct error *error) {
    struct picture *picture = &desk->current;
    const struct options *options = desk->options;
    char notice[256], written[NAME_LIMIT];
    desk->pictures++;
    if (!options_allow_picture(options, desk->pictures, error))
        return false;
    if (desk->files.quota.written == desk->files.quota.limit)
        return error_set_limit(error, "%s", desk->files.quota.words);
    *already = *already || (options->shards_of_pictures &&
                            (desk->pictures - 1) % options->shards_of_pictures != options->shard_of_pictures - 1);
    if (*already)
        return true;
    if (!choose_name(desk, request->file, picture->name, error) ||
        !picture_files_written(&desk->files, picture->name, written, error))
        return false;
    if (picture_name_ends_in(written, ".exr") && !exr_can_write())
        return error_set(error, ERROR_SCENE, "%s: EXR pictures need OpenEXR, without which this gray was made",
                         written);
    picture->request = *request;
    picture->written = false;
    if (request->check) {
        picture->open = check_only(desk, picture, error);
        return picture->open;
    }
    if (!check_files(desk, picture, error))
        return false;
    describe_tiles(desk, picture);
    *already = part_is_there(desk, written);
    if (*already)
        return true;
    if (!keeper_open(&desk->keeper, picture->name, notice, error))
        return false;
    if (notice[0] != '\0')
        desk_line(desk, LINE_NOTICE, notice);
    if (!keeper_has_written(&desk->keeper, desk->pictures, &picture->tiles.key, written, already, error) ||
        (!*already && !make_film(desk, picture, error)) || !join_farm(desk, already, error))
        return false;
    if (*already) {
        picture_files_own(&desk->files, written);
        return true;
    }
    picture->open = true;
    atomic_store(&desk->control->tiles, 0);
    atomic_store(&desk->control->tiles_done, 0);
    bool helps = desk->farm && !farm_is_first(desk->farm);
    outlook_reset(&desk->control->outlook, progress_wants_outlook(&desk->progress) && !request->in_window && !helps);
    (void)takes_text(desk);
    progress_begin(&desk->progress, picture->name, request->width, request->height);
    struct tone tone = picture_tone(request);
    if (!request->in_window)
        display_begin(&desk->display, picture->name, &picture->film, &tone);
    return true;
}

static void close_picture(struct picture *picture) {
    share_destroy(&picture->memory);
    picture->open = false;
}

/* The picture whose tiles a checkpoint would hold, or NULL. */
static const struct picture *kept_picture(const struct desk *desk) {
    const struct picture *current = &desk->current;
    if (current->open && !current->request.check)
        return current;
    return desk->held.open ? &desk->held : NULL;
}

/* True when the file was written just now. */
static bool tick(struct desk *desk, bool now, uint32_t *tiles) {
    const struct picture *picture = kept_picture(desk);
    struct error error;
    const uint32_t nothing = UINT32_MAX;
    *tiles = nothing;
    if (!keeper_tick(&desk->keeper, picture ? &picture->tiles : NULL, picture ? &picture->film : NULL, now, tiles,
                     &error)) {
        char line[sizeof error.text + 64];
        (void)snprintf(line, sizeof line, "gray: warning: the checkpoint: %s", error.text);
        desk_line(desk, LINE_WARNING, line);
    }
    return *tiles != nothing;
}

static void tell_checkpoint(struct desk *desk, uint32_t tiles) {
    char line[2 * NAME_LIMIT];
    const struct picture *picture = kept_picture(desk);
    if (picture)
        (void)snprintf(line, sizeof line, "gray: notice: %.3000s holds %u of %u tiles of %.3000s (--resume goes on)",
                       desk->keeper.path, tiles, film_tile_count(&picture->film), picture->name);
    else
        (void)snprintf(line, sizeof line, "gray: notice: %.3000s holds %zu finished pictures", desk->keeper.path,
                       desk->keeper.done_count);
    desk_line(desk, LINE_NOTICE, line);
}

void desk_checkpoint(struct desk *desk) {
    uint32_t tiles;
    if (!desk->keeper.on)
        desk_line(desk, LINE_NOTICE, "gray: notice: SIGUSR1 writes a checkpoint only with --checkpoint FILE");
    else if (tick(desk, true, &tiles))
        tell_checkpoint(desk, tiles);
}

static bool write_picture(struct desk *desk, const struct picture *picture, struct error *error) {
    char name[NAME_LIMIT];
    return picture_files_written(&desk->files, picture->name, name, error) &&
           picture_write_files(&desk->files, picture, name, error) &&
           keeper_note_written(&desk->keeper, picture->tiles.number, &picture->tiles.key, name, error);
}

/* --partial: what is there of a picture that ends early, under a name of its own. */
static void write_partial(struct desk *desk) {
    struct picture *picture = &desk->current;
    uint32_t done = film_tiles_in(&picture->film, FILM_TILE_DONE);
    struct error error;
    char name[NAME_LIMIT], line[NAME_LIMIT + 80];
    const struct file_target target = {.path = name, .rules = &desk->files.beside};
    if (done == 0)
        return;
    film_clear_unfinished(&picture->film);
    if (!layers_name(picture->name, "partial", name, &error) ||
        !picture_write_view(picture, &target, FILM_FINAL, NULL, &error)) {
        desk_line(desk, LINE_ERROR, error.text);
        return;
    }
    (void)snprintf(line, sizeof line, "gray: notice: %s holds %u of %u tiles", name, done,
                   film_tile_count(&picture->film));
    desk_line(desk, LINE_NOTICE, line);
}

void desk_abandon(struct desk *desk) {
    uint32_t tiles;
    display_forget(&desk->display);
    progress_end(&desk->progress, PROGRESS_GIVEN_UP);
    if (desk->farm)
        farm_end(desk->farm, true);
    if (desk->current.open && !desk->current.request.check && film_tiles_in(&desk->current.film, FILM_TILE_DONE) > 0 &&
        tick(desk, true, &tiles))
        tell_checkpoint(desk, tiles);
    if (desk->options->partial && desk->current.open && !desk->current.request.check)
        write_partial(desk);
    close_picture(&desk->current);
}

static void tell_statistics(struct desk *desk, const struct picture_report *report) {
    const struct picture *picture = &desk->current;
    switch (desk->options->statistics) {
    case STATISTICS_NONE:
        return;
    case STATISTICS_TEXT:
        if (begin_words(desk)) {
            statistics_print_text(stderr, picture->name, &picture->request, report);
            end_words(desk);
        }
        return;
    case STATISTICS_JSON:
        statistics_print_json(stdout, picture->name, &picture->request, report);
        return;
    }
}

/* True: this process only helps, and the picture is written by another one. */
static bool leave_to_others(struct desk *desk) {
    char shares[512], line[NAME_LIMIT + 600];
    if (!desk->farm)
        return false;
    farm_end(desk->farm, false);
    if (!farm_is_first(desk->farm)) {
        close_picture(&desk->current);
        return true;
    }
    farm_shares(desk->farm, shares, sizeof shares);
    (void)snprintf(line, sizeof line, "%s%s: tiles made by each rank: %s", scene_mark(desk->current.name),
                   desk->current.name, shares);
    desk_line(desk, LINE_DETAIL, line);
    return false;
}

bool desk_write(struct desk *desk, struct error *error) {
    desk->current.written = write_picture(desk, &desk->current, error);
    return desk->current.written;
}

/* Tiles of a farm come from other ranks as well, those of a checkpoint from an earlier run. */
static void warn_of_clamped(struct desk *desk, const struct picture_report *report) {
    char line[NAME_LIMIT + 128];
    if (!report->rays.clamped && !film_holds_largest(&desk->current.film))
        return;
    (void)snprintf(line, sizeof line,
                   "gray: warning: %s: light beyond the largest float is clamped to it, undefined values are 0",
                   desk->current.name);
    desk_line(desk, LINE_WARNING, line);
}

bool desk_done(struct desk *desk, const struct picture_report *report, struct error *error) {
    struct error gone;
    if (leave_to_others(desk))
        return true;
    progress_hide(&desk->progress);
    show_elsewhere(desk, display_end(&desk->display, &gone), &gone);
    warn_of_clamped(desk, report);
    if (desk->current.written) {
        progress_end(&desk->progress, PROGRESS_WRITTEN);
        tell_statistics(desk, report);
        close_picture(&desk->current);
        return true;
    }
    if (one_name_for_all(desk)) {
        /* Names of progress point into the picture, so it is told before the picture moves. */
        progress_end(&desk->progress, PROGRESS_WRITTEN);
        tell_statistics(desk, report);
        desk->held = desk->current;
        desk->current = (struct picture){0};
        return true;
    }
    struct picture_report whole = *report;
    double begun = progress_clock(), worked = progress_processor_clock();
    bool ok = write_picture(desk, &desk->current, error);
    whole.write_seconds = progress_clock() - begun;
    whole.write_processor_seconds = progress_processor_clock() - worked;
    progress_end(&desk->progress, ok ? PROGRESS_WRITTEN : PROGRESS_GIVEN_UP);
    if (ok)
        tell_statistics(desk, &whole);
    close_picture(&desk->current);
    return ok;
}

void desk_show_progress(struct desk *desk) {
    uint32_t ignored, done = atomic_load(&desk->control->tiles_done), count = atomic_load(&desk->control->tiles);
    struct error error;
    (void)tick(desk, false, &ignored);
    if (desk->farm) {
        farm_step(desk->farm);
        if (desk->current.open && count > 0)
            done = film_tiles_in(&desk->current.film, FILM_TILE_DONE);
    }
    if (display_draws(&desk->display, progress_clock()))
        progress_hide(&desk->progress);
    show_elsewhere(desk, display_step(&desk->display, progress_clock(), &error), &error);
    progress_update(&desk->progress, done, count, &desk->control->outlook);
    if (desk->current.open && !desk->current.request.in_window && progress_wants_trial(&desk->progress)) {
        uint32_t pixels;
        double seconds = picture_write_trial(&desk->current, &pixels);
        progress_note_trial(&desk->progress, seconds, pixels);
    }
}

void desk_line(struct desk *desk, enum line_kind kind, const char *text) {
    bool shown = false;
    if (desk->farm && kind == LINE_ERROR)
        farm_tell(desk->farm, text);
    if (desk->farm && !farm_is_first(desk->farm))
        return; /* the first one says the same, or passes it on at the end */
    switch (kind) {
    case LINE_ERROR:
        shown = true;
        break;
    case LINE_WARNING:
    case LINE_NOTICE:
        shown = !desk->options->quiet;
        break;
    case LINE_DETAIL:
        shown = desk->options->verbose;
        break;
    case LINE_OUTPUT:
        text_print(stdout, text);
        (void)fflush(stdout);
        return;
    }
    if (!shown || !begin_words(desk))
        return;
    progress_hide(&desk->progress);
    if (kind == LINE_ERROR)
        text_print_lines(stderr, text);
    else
        text_print_line(stderr, text);
    end_words(desk);
}

bool desk_finish_output(struct desk *desk, struct error *error) {
    bool written = fflush(stdout) == 0 && !ferror(stdout) && (!desk->control || !atomic_load(&desk->control->lost));
    return written || error_set(error, ERROR_MACHINE, "gray: standard output cannot be written");
}

void desk_tell_trust(struct desk *desk) {
    if (desk->options->script.no_sandbox)
        desk_line(desk, LINE_WARNING,
                  "gray: warning: --no-sandbox: scenes may read and write all your files and start programs");
}

void desk_set_interrupt(struct desk *desk, const struct file_interrupt *interrupt) {
    desk->files.interrupt = *interrupt;
}

bool desk_settle(struct desk *desk, struct error *error) {
    bool ok = true;
    if (desk->held.open && !desk->several_under_one_name)
        ok = write_picture(desk, &desk->held, error);
    close_picture(&desk->held);
    return ok;
}

void desk_restart(struct desk *desk) {
    close_picture(&desk->held);
    desk->pictures = 0;
    desk->files.quota.written = 0;
    desk->several_under_one_name = false;
}

bool desk_finish(struct desk *desk, bool all_well, struct error *error) {
    struct error kept;
    bool ok = desk_settle(desk, error);
    if (!keeper_finish(&desk->keeper, ok && all_well, &kept)) {
        char line[sizeof kept.text + 64];
        (void)snprintf(line, sizeof line, "gray: warning: the checkpoint: %s", kept.text);
        desk_line(desk, LINE_WARNING, line);
    }
    picture_files_destroy(&desk->files);
    display_close(&desk->display);
    return ok;
}
