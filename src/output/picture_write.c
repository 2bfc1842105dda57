/* Writes a film as files. Rows are tone-mapped while they are packed, so that there is no second picture in memory. */
#include "output/picture_write.h"

#include "base/mem.h"
#include "denoise/denoise.h"
#include "denoise/film_denoise.h"
#include "film/aov.h"
#include "film/path_film.h"
#include "image/light_field.h"
#include "image/picture_file.h"
#include "image/png_write.h"
#include "output/layers_internal.h"
#include "output/tool_internal.h"

#include <string.h>
#include <unistd.h>

struct rows {
    const struct film *film;
    enum film_view view;
    const struct tone *tone;
    const float (*display)[3]; /* or NULL */
    enum dither dither;
    const float *alpha; /* or NULL */
};

/* Pictures with alpha: the light of the film is multiplied by it, the numbers of PNG files are not. */
static double number_of(const struct rows *rows, size_t at, uint32_t channel) {
    double alpha = (double)rows->alpha[at];
    if (channel == 3 || alpha <= 0)
        return channel == 3 ? alpha : 0;
    return rows->display ? (double)rows->display[at][channel] / alpha
                         : tone_apply(rows->tone, (double)rows->film->pixels[at].rgb[channel] / alpha);
}

static void row_with_alpha(void *context, uint32_t y, uint8_t *line) {
    const struct rows *rows = context;
    const struct film *film = rows->film;
    for (uint32_t i = 0; i < 4 * film->width; i++) {
        double value = number_of(rows, (size_t)y * film->width + i / 4, i % 4);
        line[i] = dither_byte(i % 4 == 3 ? DITHER_NONE : rows->dither, film->x0 + i / 4, film->y0 + y, value);
    }
}

static void row_16_with_alpha(void *context, uint32_t y, uint16_t *line) {
    const struct rows *rows = context;
    for (uint32_t i = 0; i < 4 * rows->film->width; i++)
        line[i] = tone_word(number_of(rows, (size_t)y * rows->film->width + i / 4, i % 4));
}

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

/* Of the file of a light field. Any other picture is a grid of one view. */
static struct light_field_head field_of(const struct picture_request *request, const struct tone *tone) {
    const struct lens *lens = &request->settings.lens;
    struct light_field_head head = {.columns = 1,
                                    .rows = 1,
                                    .width = request->width,
                                    .height = request->height,
                                    .screen = lens->screen > 0 ? lens->screen : 1,
                                    .fov = lens->fov > 0 ? lens->fov : LIGHT_FIELD_FOV,
                                    .tone = *tone};
    if (lens_fits(lens, request->width, request->height)) {
        head.columns = (uint32_t)lens->columns;
        head.rows = (uint32_t)lens->rows;
        head.width /= head.columns;
        head.height /= head.rows * lens_grids(lens);
        head.depth = lens->depth;
        head.spacing = lens->spacing;
    }
    return head;
}

bool picture_write_view(const struct picture *picture, const struct file_target *target, enum film_view view,
                        struct pool *pool, struct error *error) {
    const struct picture_request *request = &picture->request;
    struct tone tone = picture_tone(request);
    const float *alpha = view == FILM_FINAL ? picture->alpha : NULL;
    struct rows rows = {&picture->film, view, &tone, picture->display, request->settings.finish.dither, alpha};
    const struct light_field_head field = field_of(request, &tone);
    struct picture_source source = {request->width,
                                    request->height,
                                    alpha ? row_with_alpha : row,
                                    alpha ? row_16_with_alpha : row_16,
                                    row_linear,
                                    &rows,
                                    request->settings.deep,
                                    tone.srgb,
                                    picture->unfinished,
                                    alpha != NULL,
                                    &field};
    if (picture_format(target->path) != PICTURE_LIGHT_FIELD && field.depth) /* without depths */
        source.height /= 2;
    if (view == FILM_FINAL && (picture->film.layer_mask || alpha) && picture_format(target->path) == PICTURE_EXR)
        return layers_write_exr(target, &picture->film, alpha, error);
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
    if (!merges && !settings_denoise(&picture->request.settings)) /* features for the window only */
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
        struct rows rows = {
            film, FILM_FINAL, &tone, shown->picture.display, shown->picture.request.settings.finish.dither, NULL};
        for (uint32_t y = 0; y < film->height; y++)
            row(&rows, y, rgb + (size_t)3 * film->width * y);
    }
    bool ok = shown != NULL;
    picture_shown_destroy(shown);
    pool_destroy(writing.pool);
    return ok;
}

/* --- what the files show --- */

/* If a crop is denoised or finished, its film has a rim that its files do not contain (DENOISE_RIM, finish_rim). Both
 * operations run here, when the picture is written, so that merged parts and resumed pictures are denoised and finished
 * as a whole. The film is shared with the render process, whose numbers are not trusted: both operations are safe for
 * all numbers. */

static bool denoise_film(const struct film *film, const struct denoising *by, float (*out)[3], struct error *error) {
    struct film copy = *film;
    const struct denoise_source source = film_denoise_source(&copy);
    switch (by->denoiser) {
    case DENOISER_AUTO:
    case DENOISER_NONE:
        return true;
    case DENOISER_GRAY:
        return denoise(&source, by->pool, out, error);
    case DENOISER_OIDN:
        return oidn_run(&source, by->interrupt, out, error);
    }
    return true;
}

/* Rows of a rectangle of the film, of elements of that size. */
static void cut(void *out, const void *in, size_t size, const struct film *film, const struct film_rectangle *part) {
    size_t width = part->x1 - part->x0;
    for (uint32_t y = part->y0; y < part->y1; y++) {
        size_t at = (size_t)(y - film->y0) * film->width + (part->x0 - film->x0);
        memcpy((char *)out + (y - part->y0) * width * size, (const char *)in + at * size, width * size);
    }
}

static bool is_whole(const struct film *film, const struct film_rectangle *part) {
    return part->x0 == film->x0 && part->y0 == film->y0 && part->x1 - part->x0 == film->width &&
           part->y1 - part->y0 == film->height;
}

/* The arrays of the film besides its pixels that the part has: values of marks (film/film.h), and layers. */
static bool cut_film(struct picture_shown *out, const struct film *film, const struct film_rectangle *part) {
    size_t width = part->x1 - part->x0, height = part->y1 - part->y0, count = aov_layers(film->layer_mask);
    size_t floats = film->record.marks ? film->record.floats : 0;
    /* Memory of size 0 is not NULL. */
    out->layers = mem_alloc(width * height * count * sizeof *out->layers);
    out->floats = mem_alloc(width * height * floats * sizeof *out->floats);
    out->marked = mem_alloc(width * height * film->record.marks);
    if (!out->layers || !out->floats || !out->marked)
        return false;
    /* The first pass and its marks belong together; other floats are not written. */
    if (film->record.marks) {
        cut(out->floats, film->floats, floats * sizeof *out->floats, film, part);
        cut(out->marked, film->marked, sizeof *out->marked, film, part);
    }
    for (size_t i = 0; i < count; i++)
        cut(out->layers + i * width * height, film->layers + i * (size_t)film->width * film->height,
            sizeof *out->layers, film, part);
    out->picture.film = (struct film){.width = (uint32_t)width,
                                      .height = (uint32_t)height,
                                      .x0 = part->x0,
                                      .y0 = part->y0,
                                      .full_width = film->full_width,
                                      .full_height = film->full_height,
                                      .record = {(uint32_t)floats, film->record.marks},
                                      .floats = out->floats,
                                      .marked = film->record.marks ? out->marked : NULL,
                                      .layer_mask = film->layer_mask,
                                      .layers = count > 0 ? out->layers : NULL};
    return true;
}

/* The alpha of the part, if the film has it. */
static bool add_alpha(struct picture_shown *out, const struct film *film, const struct film_rectangle *part) {
    size_t width = part->x1 - part->x0, height = part->y1 - part->y0;
    if (!film_has_alpha(film->record))
        return true;
    out->picture.alpha = out->alpha = mem_alloc(width * height * sizeof *out->alpha);
    for (size_t i = 0; out->alpha && i < width * height; i++)
        out->alpha[i] =
            film_alpha(film, (part->y0 - film->y0 + i / width) * film->width + part->x0 - film->x0 + i % width);
    return out->alpha != NULL;
}

static struct finish_area area_of(const struct film *film) {
    return (struct finish_area){film->x0, film->y0, film->width, film->height, film->full_width, film->full_height};
}

/* The colours of the film, denoised and finished as far as finishing changes light. */
static bool make_light(const struct picture *picture, const struct denoising *by, float (*out)[3],
                       struct error *error) {
    const struct film *film = &picture->film;
    const struct finish finish = picture->request.settings.finish;
    const struct finish_area area = area_of(film);
    if (by->denoiser == DENOISER_NONE)
        memcpy(out, film->pixels, (size_t)film->width * film->height * sizeof *out);
    else if (!denoise_film(film, by, out, error))
        return false;
    else
        path_film_draw_lines(film, out);
    return finish_light(&finish, picture->request.settings.tone.exposure, &area, out, error);
}

/* Finishes the numbers of a PNG file. */
static bool make_display(const struct picture *picture, const float (*light)[3], float (*out)[3], struct error *error) {
    const struct finish finish = picture->request.settings.finish;
    const struct finish_area area = area_of(&picture->film);
    const struct tone tone = picture_tone(&picture->request);
    for (size_t i = 0; i < (size_t)area.width * area.height; i++) {
        for (int c = 0; c < 3; c++) {
            double value = tone_apply(&tone, (double)light[i][c]);
            out[i][c] = value >= 1 ? 1 : value > 0 ? (float)value : 0; /* NaN: 0 */
        }
    }
    return finish_display(&finish, &area, out, error);
}

/* The part of an array of the film, which is freed. NULL: no memory. */
static void *cut_away(void *whole, const struct film *film, const struct film_rectangle *part) {
    size_t width = part->x1 - part->x0, height = part->y1 - part->y0;
    if (is_whole(film, part))
        return whole;
    void *out = mem_alloc(width * height * sizeof(struct film_pixel));
    if (out)
        cut(out, whole, sizeof(struct film_pixel), film, part);
    mem_free(whole);
    return out;
}

/* The colours of the film, and the numbers for PNG files unless display is NULL. */
static bool make_colours(const struct picture *picture, const struct denoising *by, float (*light)[3],
                         float (*display)[3], struct error *error) {
    return make_light(picture, by, light, error) &&
           (!display || make_display(picture, (const float(*)[3])light, display, error));
}

static void paste(float (*out)[3], const float (*in)[3], const struct film *film, const struct film_rectangle *part) {
    size_t width = part->x1 - part->x0;
    for (uint32_t y = part->y0; y < part->y1; y++)
        memcpy(out[(size_t)y * film->width + part->x0], in[(y - part->y0) * width], width * sizeof *out);
}

/* A view of a light field is a picture of its own; depths stay as they are. */
static bool make_view(const struct picture *picture, struct denoising by, const struct film_rectangle *part,
                      float (*light)[3], float (*display)[3], struct error *error) {
    const struct film *film = &picture->film;
    size_t pixels = (size_t)(part->x1 - part->x0) * (part->y1 - part->y0);
    struct picture view = *picture;
    view.film.width = view.film.full_width = part->x1 - part->x0;
    view.film.height = view.film.full_height = part->y1 - part->y0;
    view.film.pixels = mem_alloc(pixels * sizeof *view.film.pixels);
    view.film.floats = mem_alloc(pixels * film->record.floats * sizeof *view.film.floats);
    float(*own_light)[3] = mem_alloc(pixels * sizeof *own_light);
    float(*own_display)[3] = display ? mem_alloc(pixels * sizeof *own_display) : NULL;
    bool ok = view.film.pixels && view.film.floats && own_light && (!display || own_display);
    if (ok) {
        cut(view.film.pixels, film->pixels, sizeof *film->pixels, film, part);
        cut(view.film.floats, film->floats, film->record.floats * sizeof *film->floats, film, part);
        ok = make_colours(&view, &by, own_light, own_display, error);
    } else {
        (void)error_no_memory(error, "a picture that is finished");
    }
    if (ok)
        paste(light, (const float(*)[3])own_light, film, part);
    if (ok && display)
        paste(display, (const float(*)[3])own_display, film, part);
    mem_free(view.film.pixels);
    mem_free(view.film.floats);
    mem_free(own_light);
    mem_free(own_display);
    return ok;
}

static bool make_views(const struct picture *picture, const struct denoising *by, float (*light)[3],
                       float (*display)[3], struct error *error) {
    const struct tone tone = picture_tone(&picture->request);
    const struct light_field_head head = field_of(&picture->request, &tone);
    bool ok = true;
    for (uint32_t i = 0; ok && i < head.columns * head.rows * lens_grids(&picture->request.settings.lens); i++) {
        uint32_t x = i % head.columns * head.width, y = i / head.columns * head.height;
        struct picture own = *picture;
        struct denoising own_by = *by;
        if (i >= head.columns * head.rows) {
            own.request.settings.finish = (struct finish){0};
            own_by.denoiser = DENOISER_NONE;
        }
        ok = make_view(&own, own_by, &(struct film_rectangle){x, y, x + head.width, y + head.height}, light, display,
                       error);
    }
    return ok;
}

static bool fill_shown(struct picture_shown *out, const struct picture *picture, const struct film_rectangle *part,
                       const struct denoising *by, struct error *error) {
    const struct film *film = &picture->film;
    const struct finish finish = picture->request.settings.finish;
    size_t size = (size_t)film->width * film->height * sizeof(struct film_pixel);
    bool displays = finish_changes_display(&finish), whole = is_whole(film, part);
    out->pixels = mem_alloc(size);
    out->display = displays ? mem_alloc(size) : NULL;
    if (!out->pixels || (displays && !out->display))
        return error_no_memory(error, "a picture that is finished");
    float(*light)[3] = (float(*)[3])(void *)out->pixels;
    bool has_views = whole && lens_fits(&picture->request.settings.lens, film->width, film->height);
    if (!(has_views ? make_views : make_colours)(picture, by, light, out->display, error))
        return false;
    out->pixels = cut_away(out->pixels, film, part);
    out->display = displays ? cut_away(out->display, film, part) : NULL;
    if (!out->pixels || (displays && !out->display) || (!whole && !cut_film(out, film, part)))
        return error_no_memory(error, "a picture that is finished");
    out->picture.film.pixels = out->pixels;
    out->picture.display = (const float(*)[3])out->display;
    return true;
}

struct picture_shown *picture_shown_make(const struct picture *picture, struct denoising by, struct error *error) {
    const struct film *film = &picture->film;
    const struct finish finish = picture->request.settings.finish;
    struct film_rectangle part = picture->request.shown;
    /* A request without a part shows the whole film. */
    if (part.x1 == 0)
        part = (struct film_rectangle){film->x0, film->y0, film->x0 + film->width, film->y0 + film->height};
    if (!(path_film_parts(film->record) & PATH_PART_FEATURES))
        by.denoiser = DENOISER_NONE;
    struct picture_shown *out = mem_alloc_zero(1, sizeof *out);
    if (!out) {
        (void)error_no_memory(error, "a picture that is written");
        return NULL;
    }
    out->picture = *picture;
    if (!add_alpha(out, film, &part)) {
        (void)error_no_memory(error, "a picture that is written");
        picture_shown_destroy(out);
        return NULL;
    }
    /* A film that nothing changes is borrowed as it is. */
    bool changes = by.denoiser != DENOISER_NONE || finish_changes_light(&finish) || finish_changes_display(&finish);
    if (!changes && is_whole(film, &part))
        return out;
    if (!fill_shown(out, picture, &part, &by, error)) {
        picture_shown_destroy(out);
        return NULL;
    }
    struct picture_request *request = &out->picture.request;
    request->x0 = part.x0;
    request->y0 = part.y0;
    request->width = part.x1 - part.x0;
    request->height = part.y1 - part.y0;
    return out;
}

void picture_shown_destroy(struct picture_shown *shown) {
    if (!shown)
        return;
    mem_free(shown->pixels);
    mem_free(shown->display);
    mem_free(shown->floats);
    mem_free(shown->alpha);
    mem_free(shown->marked);
    mem_free(shown->layers);
    mem_free(shown);
}
