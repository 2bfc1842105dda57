/* The pixels of a path-traced film for the denoiser. */
#include "denoise/film_denoise.h"

#include "base/mem.h"

#include <string.h>

/* Features of the film are in the order of enum denoise_feature; glow follows them. */
static void film_row(void *context, uint32_t y, struct denoise_pixel *row) {
    const struct film *film = context;
    for (uint32_t x = 0; x < film->width; x++) {
        struct path_pixel pixel = path_film_load(film, (size_t)y * film->width + x);
        double divisor = pixel.divisors[0] + pixel.divisors[1];
        for (int half = 0; half < 2; half++) {
            int from = pixel.weights[half] != 0 ? half : 1 - half; /* with one sample there is only one half */
            struct colour colour = path_pixel_half(&pixel, from);
            row[x].colour[half][0] = (float)colour.r;
            row[x].colour[half][1] = (float)colour.g;
            row[x].colour[half][2] = (float)colour.b;
            for (int i = 0; i < DENOISE_FEATURES; i++)
                row[x].features[half][i] = (float)path_pixel_feature(&pixel, from, PATH_ALBEDO + i);
            for (int i = 0; i < 3; i++)
                row[x].glow[half][i] = (float)path_pixel_feature(&pixel, from, PATH_GLOW + i);
        }
        struct colour variance = path_pixel_variance_of_samples(&pixel);
        row[x].variance[0] = (float)variance.r;
        row[x].variance[1] = (float)variance.g;
        row[x].variance[2] = (float)variance.b;
        row[x].share = divisor != 0 ? (float)(pixel.divisors[0] / divisor) : 0.5F;
    }
}

struct denoise_source film_denoise_source(struct film *film) {
    return (struct denoise_source){film->width, film->height, film->x0, film->y0, film_row, film};
}

bool film_show_denoised(struct film *film, struct pool *pool, struct error *error) {
    const struct denoise_source source = film_denoise_source(film);
    size_t count = (size_t)film->width * film->height;
    float(*colours)[3] = mem_alloc(count * sizeof *colours);
    if (!colours)
        return error_no_memory(error, "a picture that is denoised");
    bool ok = denoise(&source, pool, colours, error);
    if (ok)
        path_film_draw_lines(film, colours);
    for (size_t i = 0; ok && i < count; i++)
        memcpy(film->pixels[i].rgb, colours[i], sizeof colours[i]);
    mem_free(colours);
    return ok;
}
