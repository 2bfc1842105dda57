/* Writes a film as files. Rows are tone-mapped while they are packed, so that there is no second picture in memory. */
#include "output/picture_write.h"

#include "base/clock.h"
#include "base/mem.h"
#include "denoise/denoise.h"
#include "film/path_film.h"
#include "image/picture_file.h"
#include "image/png_write.h"
#include "output/layers_internal.h"
#include "output/picture_shown_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

struct rows {
    const struct film *film;
    enum film_view view;
    const struct tone *tone;
    const float (*display)[3]; /* or NULL */
    enum dither dither;
};

static void row(void *context, uint32_t y, uint8_t *line) {
    const struct rows *rows = context;
    const struct film *film = rows->film;
    bool final = rows->view == FILM_FINAL;
    if (!final || (!rows->display && rows->dither == DITHER_NONE)) {
        film_row_toned(film, rows->view, rows->tone, y, line);
        return;
    }
    for (uint32_t x = 0; x < film->width; x++) {
        size_t at = (size_t)y * film->width + x;
        for (uint32_t c = 0; c < 3; c++) {
            double value =
                rows->display ? (double)rows->display[at][c] : tone_apply(rows->tone, (double)film->pixels[at].rgb[c]);
            line[3 * x + c] = dither_byte(rows->dither, film->x0 + x, film->y0 + y, value);
        }
    }
}

static void row_16(void *context, uint32_t y, uint16_t *line) {
    const struct rows *rows = context;
    if (rows->view == FILM_FINAL && rows->display) {
        const float *display = rows->display[(size_t)y * rows->film->width];
        for (size_t i = 0; i < (size_t)3 * rows->film->width; i++)
            line[i] = tone_word((double)display[i]);
        return;
    }
    film_row_16(rows->film, rows->view, rows->tone, y, line);
}

static void row_linear(void *context, uint32_t y, float *line) {
    const struct rows *rows = context;
    film_row_linear(rows->film, rows->view, y, line);
}

bool picture_write_view(const struct picture *picture, const struct file_target *target, enum film_view view,
                        struct pool *pool, struct error *error) {
    const struct picture_request *request = &picture->request;
    struct tone tone = picture_tone(request);
    struct rows rows = {&picture->film, view, &tone, picture->display, request->settings.finish.dither};
    struct picture_source source = {
        request->width, request->height,    row, row_16, row_linear, &rows, request->settings.deep,
        tone.srgb,      picture->unfinished};
    if (view == FILM_FINAL && picture->film.layer_mask && picture_format(target->path) == PICTURE_EXR)
        return layers_write_exr(target, &picture->film, error);
    return picture_file_write(target, &source, pool, error);
}

/* Threads for writing only: there must be none while a process is started. NULL: this thread alone. */
static struct pool *writing_pool(const struct options *options, const struct picture *picture, bool denoises) {
    const struct picture_request *request = &picture->request;
    uint32_t parts = png_write_stripes(request->width, request->height, request->settings.deep ? 16 : 8);
    int threads = options->threads > 0 ? options->threads : (int)sysconf(_SC_NPROCESSORS_ONLN);
    char warning[256];
    if (parts < (uint32_t)threads && !denoises)
        threads = (int)parts;
    return threads > 1 || denoises ? pool_create(threads, warning) : NULL;
}

static bool write_prefixed(const struct picture_files *files, const struct picture *picture, enum film_view view,
                           struct pool *pool, struct error *error) {
    const struct options *options = files->options;
    const char *prefix = view == FILM_TARGETS ? options->targets_prefix : options->first_pass_prefix;
    char name[NAME_LIMIT];
    const struct file_target target = {.path = name, .rules = &files->beside};
    if (!prefix)
        return true;
    return picture_files_prefixed(picture->name, prefix, name, error) &&
           picture_write_view(picture, &target, view, pool, error);
}

/* A film with features is there to be denoised; the command line of gray merge may choose the program that does it, or
 * none. */
static enum denoiser denoiser_of(const struct options *options, const struct picture *picture) {
    bool merges = options->action == ACTION_MERGE;
    enum denoiser denoiser = merges ? options->settings.denoise : picture->request.settings.denoise;
    if (!(path_film_parts(picture->film.record) & PATH_PART_FEATURES))
        return DENOISER_NONE;
    return denoiser == DENOISER_AUTO ? DENOISER_GRAY : denoiser;
}

double picture_denoised_pixels(const struct options *options, const struct picture *picture) {
    const struct film *film = &picture->film;
    const struct picture_request *request = &picture->request;
    if (options->shards || denoiser_of(options, picture) != DENOISER_GRAY)
        return 0;
    return (double)film->width * film->height / ((double)request->width * request->height);
}

static bool write_shown(const struct picture_files *files, const struct picture *picture, const char *name,
                        struct pool *pool, struct error *error) {
    const struct file_target target = {.path = name, .rules = &files->picture};
    const struct file_target beside = {.path = picture->name, .rules = &files->beside};
    struct tone tone = picture_tone(&picture->request);
    return write_prefixed(files, picture, FILM_TARGETS, pool, error) &&
           write_prefixed(files, picture, FILM_FIRST, pool, error) &&
           layers_write(&beside, &picture->film, &tone, picture->request.settings.deep, error) &&
           picture_write_view(picture, &target, FILM_FINAL, pool, error);
}

struct writing {
    struct pool *pool;
    const struct file_interrupt *interrupt;
};

static void poll_signals(void *context) {
    const struct writing *writing = context;
    if (file_interrupted(writing->interrupt, 0))
        pool_cancel(writing->pool);
}

/* The contents of the files of a picture. writing->pool: the threads for writing, or NULL for this thread only; the
 * caller destroys it, also after an error. It stops after an interrupt. */
static struct picture_shown *make_shown(const struct picture_files *files, const struct picture *picture,
                                        struct writing *writing, struct error *error) {
    enum denoiser denoiser = denoiser_of(files->options, picture);
    *writing = (struct writing){writing_pool(files->options, picture, denoiser == DENOISER_GRAY), &files->interrupt};
    if (writing->pool)
        pool_set_poll(writing->pool, poll_signals, writing);
    if (!writing->pool && denoiser == DENOISER_GRAY) {
        (void)error_no_memory(error, "a picture that is denoised");
        return NULL;
    }
    return picture_shown_make(picture, (struct denoising){denoiser, writing->pool, &files->interrupt}, error);
}

bool picture_write_files(const struct picture_files *files, const struct picture *picture, const char *name,
                         struct error *error) {
    if (files->options->shards) {
        struct tile_picture whole = picture->tiles;
        whole.whole = true;
        return tile_file_write(&(struct file_target){.path = name, .rules = &files->part}, NULL, 0, &whole,
                               &picture->film, error);
    }
    struct writing writing;
    struct picture_shown *shown = make_shown(files, picture, &writing, error);
    bool ok = shown && write_shown(files, &shown->picture, name, writing.pool, error);
    picture_shown_destroy(shown);
    pool_destroy(writing.pool);
    return ok;
}

bool picture_write_bytes(const struct picture_files *files, const struct picture *picture, uint8_t *rgb,
                         struct error *error) {
    struct writing writing;
    struct picture_shown *shown = make_shown(files, picture, &writing, error);
    if (shown) {
        struct tone tone = picture_tone(&shown->picture.request);
        const struct film *film = &shown->picture.film;
        struct rows rows = {film, FILM_FINAL, &tone, shown->picture.display,
                            shown->picture.request.settings.finish.dither};
        for (uint32_t y = 0; y < film->height; y++)
            row(&rows, y, rgb + (size_t)3 * film->width * y);
    }
    bool ok = shown != NULL;
    picture_shown_destroy(shown);
    pool_destroy(writing.pool);
    return ok;
}
