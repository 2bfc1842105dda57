/* The noise of path-traced tiles, by which --noise decides: an estimate of the relative error of a tile against the
 * picture of infinitely many samples, from the records of its pixels (film/path_film.h). */
#ifndef GRAY_RENDER_PATH_NOISE_INTERNAL_H
#define GRAY_RENDER_PATH_NOISE_INTERNAL_H

#include "film/path_film.h"

/* Of the pixels of a tile, or of a part of one; pixels as in film_tile_rectangle. 0 with less than two samples. */
double path_tile_noise(const struct film *film, struct film_rectangle tile);

/* --noise checks a tile after 16, 24, 32, 48, 64 ... samples: returns the first of these numbers above `samples`; and
 * whether `samples` is one of them. */
uint32_t path_next_check(uint32_t samples);
bool path_is_check(uint32_t samples);
/* The number of samples of each pixel of a tile that a checkpoint holds unfinished: a check below `limit`, or 0 if they
 * are of no use. */
uint32_t path_samples_kept(const struct film *film, struct film_rectangle tile, uint32_t limit);
/* A tile with fewer samples is not finished: 16, or 1.25 / wanted. */
uint32_t path_minimum_samples(double wanted);
/* The expected number of samples, at most `limit`, at which a tile reaches the noise `wanted`, if it has `noise` after
 * `samples`. Noise is inversely proportional to the square root of the number, and a tile ends only at a check. wanted
 * > 0. 0: not known, because one sample has no noise estimate. */
uint32_t path_samples_expected(uint32_t samples, double noise, double wanted, uint32_t limit);

#endif
