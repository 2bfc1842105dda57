/* Denoising of a path-traced film with its features. */
#ifndef GRAY_DENOISE_FILM_DENOISE_H
#define GRAY_DENOISE_FILM_DENOISE_H

#include "denoise/denoise.h"
#include "film/path_film.h"

/* For films whose record has features (PATH_PART_FEATURES). The pixels of the film for the denoiser; borrows the
 * film. */
struct denoise_source film_denoise_source(struct film *film);
/* Replaces the colours of the film by denoised ones, for display. Its sums do not change: more samples may follow, and
 * files are written from the sums. Errors: no memory, cancelled; then the film is unchanged. */
bool film_show_denoised(struct film *film, struct pool *pool, struct error *error);

#endif
