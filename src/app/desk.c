/* A picture has three steps: begin, done or abandon, and (for one under -o) the end of the run. Under -o without %d the
 * first picture is kept in memory until it is known that no second one comes: two pictures under one name are wrong
 * usage, and then no file may have been touched. */
#include "app/desk.h"

#include "app/statistics.h"
#include "app/text.h"
#include "base/file.h"
#include "image/float_write.h"
#include "image/png_write.h"

#include <string.h>
#include <strings.h>

void desk_init(struct desk *desk, const struct options *options, struct control *control) {
    memset(desk, 0, sizeof *desk);
    desk->options = options;
    desk->control = control;
    progress_init(&desk->progress, options->progress, options->quiet);
    bool ok = reach_add(&desk->places, ".", REACH_WRITE, &desk->places_error);
    for (int i = 0; ok && i < options->script.allow_write_count; i++)
        ok = reach_add(&desk->places, options->script.allow_write[i], REACH_WRITE, &desk->places_error);
}

static bool one_name_for_all(const struct desk *desk) {
    return desk->options->output && !output_name_numbered(desk->options->output);
}

static bool choose_name(struct desk *desk, const char *from_script, char name[NAME_LIMIT], struct error *error) {
    const char *output = desk->options->output;
    if (one_name_for_all(desk) && desk->pictures > 1) {
        desk->several_under_one_name = true;
        return error_set(error, ERROR_USAGE, "-o %s: several pictures are rendered, so the name needs %%d", output);
    }
    if (!output && from_script[0] == '\0')
        return error_set(error, ERROR_SCENE, "the name of the picture is empty");
    size_t length = strlen(from_script);
    if (output ? !output_name(output, desk->pictures, name, NAME_LIMIT) : length >= NAME_LIMIT)
        return error_set(error, ERROR_SCENE, "the name of the picture is longer than %d bytes", NAME_LIMIT - 1);
    if (!output)
        memcpy(name, from_script, length + 1);
    if (!output && desk->places_error.kind != ERROR_NONE) {
        *error = desk->places_error;
        return false;
    }
    if (!output && !desk->options->script.no_sandbox && !reach_may_create(&desk->places, name))
        return error_set(error, ERROR_SCENE,
                         "%s: scripts have pictures written below the working directory only, and under no hidden name "
                         "(-o FILE or --allow-write DIR allow other places)",
                         name);
    if (file_is_folder(name) || name[strlen(name) - 1] == '/')
        return error_set(error, ERROR_SCENE, "%s: is a folder, a picture cannot be written there", name);
    return true;
}

/* dir/foo.png with prefix X is dir/Xfoo.png. */
static bool prefixed_name(const char *name, const char *prefix, char out[NAME_LIMIT], struct error *error) {
    const char *slash = strrchr(name, '/');
    size_t folder = slash ? (size_t)(slash - name) + 1 : 0;
    int length = snprintf(out, NAME_LIMIT, "%.*s%s%s", (int)folder, name, prefix, name + folder);
    if (length >= NAME_LIMIT)
        return error_set(error, ERROR_SCENE, "%s: with %s before it the name is longer than %d bytes", name, prefix,
                         NAME_LIMIT - 1);
    return true;
}

bool desk_begin(struct desk *desk, const struct picture_request *request, struct error *error) {
    struct picture *picture = &desk->current;
    desk->pictures++;
    size_t bytes;
    if (!choose_name(desk, request->file, picture->name, error) ||
        !film_size(request->width, request->height, &bytes, error))
        return false;
    picture->request = *request;
    picture->open = true;
    if (request->check)
        return true;
    if (!share_create(&picture->memory, bytes, error)) {
        picture->open = false;
        return error_prefix(error, "%s", picture->name);
    }
    film_place(&picture->film, picture->memory.block, request->width, request->height);
    atomic_store(&desk->control->tiles, 0);
    atomic_store(&desk->control->tiles_done, 0);
    progress_begin(&desk->progress, picture->name, request->width, request->height);
    return true;
}

static void close_picture(struct picture *picture) {
    share_destroy(&picture->memory);
    picture->open = false;
}

void desk_abandon(struct desk *desk) {
    progress_end(&desk->progress, PROGRESS_GIVEN_UP);
    close_picture(&desk->current);
}

struct rows {
    const struct film *film;
    enum film_view view;
    const struct tone *tone;
};

static void row(void *context, uint32_t y, uint8_t *line) {
    const struct rows *rows = context;
    film_row_toned(rows->film, rows->view, rows->tone, y, line);
}

static void row_16(void *context, uint32_t y, uint16_t *line) {
    const struct rows *rows = context;
    film_row_16(rows->film, rows->view, rows->tone, y, line);
}

static void row_linear(void *context, uint32_t y, float *line) {
    const struct rows *rows = context;
    film_row_linear(rows->film, rows->view, y, line);
}

static bool ends_in(const char *name, const char *extension) {
    size_t length = strlen(name), wanted = strlen(extension);
    return length >= wanted && strcasecmp(name + length - wanted, extension) == 0;
}

/* The extension says the format; whatever is not .pfm or .hdr is PNG. Tone is for PNG alone: the other two hold light.
 */
static bool write_view(const struct picture *picture, const char *name, enum film_view view, struct error *error) {
    const struct picture_request *request = &picture->request;
    struct tone tone = {request->exposure, (enum tone_curve)request->curve, request->srgb != 0};
    struct rows rows = {&picture->film, view, &tone};
    if (ends_in(name, ".pfm"))
        return pfm_write(name, request->width, request->height, row_linear, &rows, error);
    if (ends_in(name, ".hdr"))
        return hdr_write(name, request->width, request->height, row_linear, &rows, error);
    if (request->deep)
        return png_write_16(name, request->width, request->height, row_16, &rows, error);
    return png_write(name, request->width, request->height, row, &rows, error);
}

static bool write_prefixed(const struct picture *picture, const char *prefix, enum film_view view,
                           struct error *error) {
    char name[NAME_LIMIT];
    if (!prefix)
        return true;
    return prefixed_name(picture->name, prefix, name, error) && write_view(picture, name, view, error);
}

static bool write_picture(const struct desk *desk, const struct picture *picture, struct error *error) {
    return write_prefixed(picture, desk->options->targets_prefix, FILM_TARGETS, error) &&
           write_prefixed(picture, desk->options->first_pass_prefix, FILM_FIRST, error) &&
           write_view(picture, picture->name, FILM_FINAL, error);
}

static void tell_statistics(struct desk *desk, const struct picture_report *report) {
    const struct picture *picture = &desk->current;
    switch (desk->options->statistics) {
    case STATISTICS_NONE:
        return;
    case STATISTICS_TEXT:
        statistics_print_text(stderr, picture->name, &picture->request, report);
        return;
    case STATISTICS_JSON:
        statistics_print_json(stdout, picture->name, &picture->request, report);
        return;
    }
}

bool desk_done(struct desk *desk, const struct picture_report *report, struct error *error) {
    if (one_name_for_all(desk)) {
        /* Names of progress point into the picture, so it is told before the picture moves. */
        progress_end(&desk->progress, PROGRESS_WRITTEN);
        tell_statistics(desk, report);
        desk->held = desk->current;
        desk->current = (struct picture){0};
        return true;
    }
    bool ok = write_picture(desk, &desk->current, error);
    progress_end(&desk->progress, ok ? PROGRESS_WRITTEN : PROGRESS_GIVEN_UP);
    if (ok)
        tell_statistics(desk, report);
    close_picture(&desk->current);
    return ok;
}

void desk_show_progress(struct desk *desk) {
    progress_update(&desk->progress, atomic_load(&desk->control->tiles_done), atomic_load(&desk->control->tiles));
}

void desk_line(struct desk *desk, enum line_kind kind, const char *text) {
    bool shown = false;
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
    }
    if (!shown)
        return;
    progress_hide(&desk->progress);
    text_print_line(stderr, text);
}

bool desk_finish(struct desk *desk, struct error *error) {
    bool ok = true;
    if (desk->held.open && !desk->several_under_one_name)
        ok = write_picture(desk, &desk->held, error);
    close_picture(&desk->held);
    reach_destroy(&desk->places);
    return ok;
}
