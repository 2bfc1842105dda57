/* The record of a path-traced pixel in the film: sums over its samples, so that more samples can be added later and the
 * error can be estimated.
 *
 * Even and odd samples are two halves whose random numbers are scrambled independently (render/sampler.h): the
 * difference of their means measures the error of the pixel, including correlations within a half. Sums are rounded to
 * the precision of the record after every sample, so a pixel has the same bytes for any division of its samples into
 * passes. */
#ifndef GRAY_FILM_PATH_FILM_H
#define GRAY_FILM_PATH_FILM_H

#include "film/film.h"
#include "film/path_parts.h"
#include "math/colour.h"

/* The zero value is a pixel without samples. */
struct path_pixel {
    struct colour sums[2]; /* of the halves: weighted radiance */
    double weights[2];     /* of the halves: sums of the weights of the samples */
    double divisors[2];    /* of the halves: what all sums are divided by: the weights, each with `bright` times
                              1 / (1 + bright luminance) of its sample, as the sums have them */
    double bright;         /* 2^exposure with RESOLVE_BRIGHT, else 0; set by the caller that adds samples */
    struct colour squares; /* of the weighted radiance of all samples */
    uint32_t samples;      /* sample number k belongs to half k % 2 */
    /* Only in records with these parts (enum path_part). */
    float line;          /* the fraction of the pixel that black lines cover, 0..1 */
    double seen_through; /* weighted sum of the shares of the samples that see the background */
    /* Two thirds of the structure, which is left out where no sample has parts. */
    float features[2][PATH_FEATURES];       /* of the halves: weighted sums */
    struct colour light[PATH_LIGHT_GROUPS]; /* weighted sums of all samples */
};
/* Bytes of a pixel whose samples have parts, or have none. */
static inline size_t path_pixel_size(bool has_parts) {
    return has_parts ? sizeof(struct path_pixel) : offsetof(struct path_pixel, features);
}

/* The record of films with these parts, a mask of enum path_part; and the mask of a record, 0 for records of other
 * integrators. */
struct film_record path_film_record(unsigned parts);
unsigned path_film_parts(struct film_record record);

/* at: the index of the pixel in the film. Storing also sets the colour of the pixel, the mean below its line. */
struct path_pixel path_film_load(const struct film *film, size_t at);
void path_film_store(struct film *film, size_t at, const struct path_pixel *pixel);

/* Whether a film, also one of the integrator whitted, has the alpha of its pixels; that of a pixel of such a film. */
bool film_has_alpha(struct film_record record);
float film_alpha(const struct film *film, size_t at);

/* Adds sample number pixel->samples. weight: that of the reconstruction filter, 1 or -1. The parts of the sample are
 * added before it. */
void path_pixel_add_parts(struct path_pixel *pixel, const struct path_parts *parts, struct colour radiance,
                          double weight);
void path_pixel_add(struct path_pixel *pixel, struct colour radiance, double seen_through, double weight);

/* The mean of all samples, and the mean of one half (black if it has no samples); and a colour with the line of the
 * pixel drawn over it. */
struct colour path_pixel_mean(const struct path_pixel *pixel);
struct colour path_pixel_half(const struct path_pixel *pixel, int half);
struct colour path_pixel_below_line(const struct path_pixel *pixel, struct colour colour);
/* The mean of a feature over one half, and that of a group of light over all samples; 0 if the record does not
 * contain them. */
double path_pixel_feature(const struct path_pixel *pixel, int half, int feature);
struct colour path_pixel_light(const struct path_pixel *pixel, enum path_light_group group);
/* The variance of path_pixel_mean by channel. The first estimate uses the difference of the halves and is unbiased,
 * with one degree of freedom. The second one treats the samples as independent: it is smoother, but too large where
 * stratification helps. 0 with less than two samples. */
struct colour path_pixel_variance_of_halves(const struct path_pixel *pixel);
struct colour path_pixel_variance_of_samples(const struct path_pixel *pixel);

/* Draws the lines of the film (PATH_PART_LINE) over other colours of its pixels, for instance denoised ones. */
void path_film_draw_lines(const struct film *film, float (*colours)[3]);

#endif
