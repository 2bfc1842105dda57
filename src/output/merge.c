/* Parts are sorted by their picture; each picture then goes through the output session like one that a scene rendered,
 * so that names, formats and the protection of old files are the same. A part is read twice, once for its header and
 * once for its tiles, so that at most one part is in memory. */
#include "output/merge.h"

#include "base/mem.h"
#include "film/path_film.h"
#include "output/output_session.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct part {
    const char *path;
    struct tile_picture picture;
    size_t tiles;
};

static int by_picture_and_shard(const void *a, const void *b) {
    const struct part *x = a, *y = b;
    if (x->picture.number != y->picture.number)
        return x->picture.number < y->picture.number ? -1 : 1;
    if (x->picture.shard != y->picture.shard)
        return x->picture.shard < y->picture.shard ? -1 : 1;
    return 0;
}

static bool read_part(const char *path, struct part *part, struct error *error) {
    struct tile_file file;
    if (!tile_file_read(path, &file, error))
        return false;
    bool ok = file.has_picture;
    *part = (struct part){path, file.picture, file.tiles};
    tile_file_close(&file);
    return ok || error_set(error, ERROR_SCENE, "%.400s: holds no tiles of a picture", path);
}

/* "part 3", "parts 3 and 4", "parts 3, 4 and 9 more". */
static void list_missing(const struct part *parts, size_t count, char out[256]) {
    uint32_t shards = parts[0].picture.shards, missing = shards - (uint32_t)count, shown = 0;
    size_t at = 0, length = 0;
    for (uint32_t shard = 1; shard <= shards && shown < 8; shard++) {
        if (at < count && parts[at].picture.shard == shard) {
            at++;
            continue;
        }
        const char *before = shown == 0 ? (missing > 1 ? "parts " : "part ") : shown + 1 == missing ? " and " : ", ";
        length += (size_t)snprintf(out + length, 256 - length, "%s%u", before, shard);
        shown++;
    }
    if (shown < missing)
        (void)snprintf(out + length, 256 - length, " and %u more", missing - shown);
}

/* Checks that the parts have all tiles of the picture: the size comes from a part, the film from the tiles. */
static bool check_tiles(const struct part *parts, size_t count, struct error *error) {
    const struct tile_picture *picture = &parts[0].picture;
    const struct film film = {.width = picture->width, .height = picture->height, .x0 = picture->x0, .y0 = picture->y0};
    uint64_t tiles = 0, wanted = film_tile_count(&film);
    for (size_t i = 0; i < count; i++)
        tiles += parts[i].tiles;
    return tiles >= wanted || error_set(error, ERROR_SCENE, "%.400s: %llu tiles are in no part", picture->name,
                                        (unsigned long long)(wanted - tiles));
}

/* Checks that the parts of one picture belong together and none is missing or present twice. */
static bool check_parts(const struct part *parts, size_t count, struct error *error) {
    const struct tile_picture *first = &parts[0].picture;
    /* Parts are sorted by their numbers: equal ones are neighbours. */
    for (size_t i = 1; i < count; i++) {
        const char *difference = tile_picture_difference(&parts[i].picture, first);
        if (difference)
            return error_set(error, ERROR_SCENE, "%.300s: does not belong to %.300s: %s", parts[i].path, parts[0].path,
                             difference);
        if (strcmp(parts[i].picture.name, first->name) != 0)
            return error_set(error, ERROR_SCENE, "%.300s: does not belong to %.300s: it is of %.200s, not of %.200s",
                             parts[i].path, parts[0].path, parts[i].picture.name, first->name);
        if (parts[i].picture.shard == parts[i - 1].picture.shard)
            return error_set(error, ERROR_SCENE, "%.300s: is part %u of %u, and so is %.300s", parts[i].path,
                             parts[i].picture.shard, first->shards, parts[i - 1].path);
    }
    /* Each part is complete. */
    for (size_t i = 0; i < count; i++) {
        if (!parts[i].picture.whole)
            return error_set(error, ERROR_SCENE, "%.300s: part %u of %u is not finished (%zu tiles are)", parts[i].path,
                             parts[i].picture.shard, first->shards, parts[i].tiles);
    }
    /* And none is missing. */
    if (count == first->shards)
        return check_tiles(parts, count, error);
    char missing[256] = "";
    list_missing(parts, count, missing);
    return error_set(error, ERROR_SCENE, "%.400s: %s of %u %s missing", first->name, missing, first->shards,
                     first->shards - count == 1 ? "is" : "are");
}

static bool fill_film(const struct part *parts, size_t count, struct film *film, struct error *error) {
    for (size_t i = 0; i < count; i++) {
        struct tile_file file;
        uint32_t restored = 0, twice = 0;
        if (!tile_file_read(parts[i].path, &file, error))
            return false;
        bool same = file.has_picture && !tile_picture_difference(&file.picture, &parts[i].picture);
        if (same)
            tile_file_restore(&file, film, &restored, &twice);
        tile_file_close(&file);
        if (!same)
            return error_set(error, ERROR_SCENE, "%.400s: has changed while it was read", parts[i].path);
        if (twice > 0)
            return error_set(error, ERROR_SCENE, "%.400s: %u of its tiles are in other parts too", parts[i].path,
                             twice);
    }
    uint32_t missing = film_tile_count(film) - film_tiles_in(film, FILM_TILE_DONE);
    if (missing > 0)
        return error_set(error, ERROR_SCENE, "%.400s: %u tiles are in no part", parts[0].picture.name, missing);
    return true;
}

/* --denoise needs the features that only renders with --denoise record. */
static bool check_denoise(const struct options *options, const struct tile_picture *picture, struct error *error) {
    return !settings_denoise(&options->settings) || (path_film_parts(picture->record) & PATH_PART_FEATURES) ||
           error_set(error, ERROR_USAGE, "%.400s: its parts cannot be denoised: they were rendered without --denoise",
                     picture->name);
}

static bool merge_picture(struct output_session *output, const struct part *parts, size_t count, struct error *error) {
    const struct tile_picture *first = &parts[0].picture;
    struct picture_request request = {.full_width = first->full_width,
                                      .full_height = first->full_height,
                                      .x0 = first->x0,
                                      .y0 = first->y0,
                                      .width = first->width,
                                      .height = first->height,
                                      .shown = first->shown,
                                      .settings = first->settings,
                                      .record = first->record,
                                      .tone_table = first->tone_table};
    memcpy(request.file, first->name, sizeof request.file);
    bool already = false;
    if (!check_parts(parts, count, error) || !check_denoise(output->options, first, error) ||
        !output_begin(output, &request, &already, error))
        return false;
    const struct picture_report report = {0};
    if (fill_film(parts, count, &output->current.film, error))
        return output_done(output, &report, error);
    output_abandon(output);
    return false;
}

static int report_error(struct output_session *output, const struct error *error, int status) {
    output_report(output, LINE_ERROR, error->text);
    return (int)error->kind > status ? (int)error->kind : status;
}

/* `gray merge -o x.gif frame.png ...`: frames of --shard-pictures or of other runs. */
static bool are_frames(const struct options *options) {
    const char *dot = strrchr(options->scripts[0], '.');
    return dot && strcmp(dot, ".png") == 0;
}

static int merge_frames(const struct options *options, struct output_session *output) {
    struct error error;
    int status = 0;
    if (!animation_take_files(&output->animation, options->scripts, (uint32_t)options->script_count, &error))
        status = report_error(output, &error, status);
    if (!output_finish(output, status == 0, &error))
        status = report_error(output, &error, status);
    return status;
}

static int refuse_frames(const struct options *options, struct output_session *output) {
    struct error error;
    (void)error_set(&error, ERROR_USAGE,
                    "gray: %.600s is a picture: gray merge makes animations of pictures (-o x.gif), and pictures of "
                    "parts (.part)",
                    options->scripts[0]);
    int status = report_error(output, &error, 0);
    (void)output_finish(output, false, &error);
    return status;
}

static int merge_parts(const struct options *options, struct output_session *output) {
    struct error error = {0};
    size_t count = (size_t)options->script_count, first = 0;
    int status = 0;
    struct part *parts = mem_alloc_zero(count, sizeof *parts);
    if (!parts) {
        (void)error_no_memory(&error, "the parts");
        status = report_error(output, &error, status);
        count = 0;
    }
    for (size_t i = 0; i < count; i++) {
        if (!read_part(options->scripts[i], &parts[i], &error))
            status = report_error(output, &error, status);
    }
    /* A part that cannot be read may belong to any picture: no picture is merged without it. */
    if (status != 0)
        count = 0;
    if (count > 0)
        qsort(parts, count, sizeof *parts, by_picture_and_shard);
    for (size_t end; first < count; first = end) {
        for (end = first + 1; end < count && parts[end].picture.number == parts[first].picture.number;)
            end++;
        if (!merge_picture(output, parts + first, end - first, &error))
            status = report_error(output, &error, status);
    }
    mem_free(parts);
    if (!output_finish(output, status == 0, &error))
        status = report_error(output, &error, status);
    return status;
}

int merge_run(const struct options *options) {
    struct control control = {0};
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
    /* Not on the stack, which may be small. */
    struct output_session *output = mem_alloc_zero(1, sizeof *output);
    if (!output) {
        (void)fputs("gray: out of memory\n", stderr);
        return ERROR_MACHINE;
    }
    output_init(output, options, &control);
    bool animates = options->animation != ANIMATION_NONE;
    int status = !are_frames(options) ? merge_parts(options, output)
                 : animates           ? merge_frames(options, output)
                                      : refuse_frames(options, output);
    mem_free(output);
    return status;
}
