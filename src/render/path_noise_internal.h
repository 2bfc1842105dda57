/* The noise of path-traced tiles, by which --noise decides: an estimate of the relative error of a tile against the
 * picture of infinitely many samples, from the records of its pixels (film/path_film.h). */
#ifndef GRAY_RENDER_PATH_NOISE_INTERNAL_H
#define GRAY_RENDER_PATH_NOISE_INTERNAL_H

#include "film/path_film.h"

struct path_noise {
    double noise; /* this decides: mostly from the halves of the samples */
    /* For time estimates: */
    double by_samples;    /* the same from the variance of the samples */
    double plain;         /* the same with the own mean of each pixel, without what is added for rare paths */
    double concentration; /* sqrt(sum of e^2) / sum of e over the pixels' e: 1 if all noise is in one pixel, 1/sqrt(n)
                             if n pixels have the same; 0: no noise */
};
/* Of the pixels of a tile, or of a part of one; pixels as in film_tile_rectangle. 0 with less than two samples. */
struct path_noise path_tile_noise(const struct film *film, struct film_rectangle tile);
/* Of one pixel without neighbours, the square of by_samples. */
double path_pixel_noise_of_samples(const struct path_pixel *pixel);

/* --noise checks a tile after 16, 24, 32, 48, 64 ... samples: returns the first of these numbers above `samples`. */
uint32_t path_next_check(uint32_t samples);
/* A tile with fewer samples is not finished: 16, or 1.25 / wanted. */
uint32_t path_minimum_samples(double wanted);
/* The expected number of samples, at most `limit`, at which a tile reaches the noise `wanted`, if it has `noise` after
 * `samples`. Noise is inversely proportional to the square root of the number, and a tile ends only at a check. wanted
 * > 0. 0: not known, because one sample has no noise estimate. */
uint32_t path_samples_expected(uint32_t samples, double noise, double wanted, uint32_t limit);

#endif
