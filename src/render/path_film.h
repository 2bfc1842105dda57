/* The record of a path-traced pixel in the film: sums over its samples, so that more samples can be added later and the
 * error can be estimated.
 *
 * Even and odd samples are two halves whose random numbers are scrambled independently (render/sampler.h): the
 * difference of their means measures the error of the pixel, including correlations within a half. Sums are rounded to
 * the precision of the record after every sample, so a pixel has the same bytes for any division of its samples into
 * passes. */
#ifndef GRAY_RENDER_PATH_FILM_H
#define GRAY_RENDER_PATH_FILM_H

#include "math/vec3.h"
#include "render/film.h"
#include "render/path_parts.h"

/* The zero value is a pixel without samples. */
struct path_pixel {
    struct vec3 sums[2]; /* of the halves: weighted radiance */
    double weights[2];   /* of the halves: sums of the samples' weights */
    struct vec3 squares; /* of the weighted radiance of all samples */
    uint32_t samples;    /* sample number k belongs to half k % 2 */
    /* Only of records with these parts (enum path_part). */
    float features[2][PATH_FEATURES];     /* of the halves: weighted sums */
    struct vec3 light[PATH_LIGHT_GROUPS]; /* weighted sums of all samples */
};

/* The record of films with these parts, a mask of enum path_part; and back: 0 of all other records. */
struct film_record path_film_record(unsigned parts);
unsigned path_film_parts(struct film_record record);

/* at: index of the pixel in the film. Storing sets the colour of the pixel, too. */
struct path_pixel path_film_load(const struct film *film, size_t at);
void path_film_store(struct film *film, size_t at, const struct path_pixel *pixel);

/* Adds sample number pixel->samples; weight: of the reconstruction filter, 1 or -1. Its parts are added before. */
void path_pixel_add_parts(struct path_pixel *pixel, const struct path_parts *parts, double weight);
void path_pixel_add(struct path_pixel *pixel, struct vec3 radiance, double weight);

/* The mean of all samples, and of one half (black if it has none). */
struct vec3 path_pixel_mean(const struct path_pixel *pixel);
struct vec3 path_pixel_half(const struct path_pixel *pixel, int half);
/* The mean of a feature over one half, and of a group of light over all samples; 0 where the record has none. */
double path_pixel_feature(const struct path_pixel *pixel, int half, int feature);
struct vec3 path_pixel_light(const struct path_pixel *pixel, enum path_light_group group);
/* The variance of path_pixel_mean by channel: from the difference of the halves, unbiased with one degree of freedom;
 * and from the samples as if they were independent, which is smoother, and too large where stratification helps. 0 with
 * less than two samples. */
struct vec3 path_pixel_variance_of_halves(const struct path_pixel *pixel);
struct vec3 path_pixel_variance_of_samples(const struct path_pixel *pixel);

/* The contribution of a pixel to the noise of its tile: the mean over the channels of Var / (mean^2 + .01), Var from
 * the halves. The noise of a tile is the square root of the mean over its pixels, an estimate of its relative error. */
double path_pixel_noise(const struct path_pixel *pixel);

#endif
