/* The film of a crop that is denoised has a rim that its files do not show (DENOISE_RIM). Denoising happens here, where
 * the picture is written, so that merged parts and resumed pictures are denoised as a whole. The film is shared with
 * the render process, whose numbers are not trusted: denoising is safe for all numbers. */
#include "output/picture_shown_internal.h"

#include "base/mem.h"
#include "output/oidn_internal.h"
#include "render/aov.h"
#include "render/path_film.h"

#include <string.h>

static bool denoise_film(const struct film *film, enum denoiser denoiser, struct pool *pool, float (*out)[3],
                         struct error *error) {
    struct film copy = *film;
    const struct denoise_source source = path_film_denoise_source(&copy);
    switch (denoiser) {
    case DENOISER_NONE:
        return true;
    case DENOISER_GRAY:
        return denoise(&source, pool, out, error);
    case DENOISER_OIDN:
        return oidn_run(&source, out, error);
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

/* The film of the part, its arrays in the memory of `out`. */
static bool cut_film(struct picture_shown *out, const struct film *film, const struct film_rectangle *part,
                     const void *colours) {
    size_t width = part->x1 - part->x0, height = part->y1 - part->y0, count = aov_layers(film->layer_mask);
    struct film *shown = &out->picture.film;
    out->pixels = mem_alloc(width * height * sizeof *out->pixels);
    out->layers = mem_alloc(width * height * count * sizeof *out->layers);
    if (!out->pixels || !out->layers) {
        picture_shown_destroy(out);
        return false;
    }
    cut(out->pixels, colours, sizeof *out->pixels, film, part);
    for (size_t i = 0; i < count; i++)
        cut(out->layers + i * width * height, film->layers + i * (size_t)film->width * film->height,
            sizeof *out->layers, film, part);
    *shown = (struct film){.width = (uint32_t)width,
                           .height = (uint32_t)height,
                           .x0 = part->x0,
                           .y0 = part->y0,
                           .full_width = film->full_width,
                           .full_height = film->full_height,
                           .pixels = out->pixels,
                           .layer_mask = film->layer_mask,
                           .layers = count > 0 ? out->layers : NULL};
    return true;
}

bool picture_shown_make(struct picture_shown *out, const struct picture *picture, enum denoiser denoiser,
                        struct pool *pool, struct error *error) {
    const struct film *film = &picture->film;
    struct film_rectangle part = picture->request.shown;
    if (part.x1 == 0)
        part = (struct film_rectangle){film->x0, film->y0, film->x0 + film->width, film->y0 + film->height};
    bool denoises = denoiser != DENOISER_NONE && path_film_parts(film->record) & PATH_PART_FEATURES;
    *out = (struct picture_shown){.picture = *picture};
    if (!denoises && is_whole(film, &part))
        return true;
    float(*denoised)[3] = NULL;
    if (denoises) {
        denoised = mem_alloc((size_t)film->width * film->height * sizeof *denoised);
        if (!denoised)
            return error_no_memory(error, "a picture that is denoised");
        if (!denoise_film(film, denoiser, pool, denoised, error)) {
            mem_free(denoised);
            return false;
        }
    }
    bool ok = cut_film(out, film, &part, denoised ? (const void *)denoised : (const void *)film->pixels);
    mem_free(denoised);
    if (!ok)
        return error_no_memory(error, "a picture that is denoised");
    struct picture_request *request = &out->picture.request;
    request->x0 = part.x0;
    request->y0 = part.y0;
    request->width = part.x1 - part.x0;
    request->height = part.y1 - part.y0;
    return true;
}

void picture_shown_destroy(struct picture_shown *shown) {
    mem_free(shown->pixels);
    mem_free(shown->layers);
    shown->pixels = NULL;
    shown->layers = NULL;
}
