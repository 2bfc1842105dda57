/* Pictures that look like drawings: shading in a style (settings.h), and lines over pictures of any integrator. */
#ifndef GRAY_RENDER_STYLE_INTERNAL_H
#define GRAY_RENDER_STYLE_INTERNAL_H

#include "render/render_internal.h"

/* In place of direct_light (direct_internal.h), which it is for STYLE_NONE.
 *
 * TOON: E is the light that a white matt surface would show of all lights, with shadows, and m its largest component.
 * The colour is kd ambient + kd E q / m, where q is m rounded to a multiple of 1 / toon_steps, at most 1; plus ks
 * where the highlight is more than half of ks.
 * GOOCH: A. Gooch, B. Gooch, P. Shirley, E. Cohen, "A Non-Photorealistic Lighting Model for Automatic Technical
 * Illustration", SIGGRAPH 1998: t warm + (1 - t) cool plus the highlight, with t = (1 + n.l) / 2, cool = (0, 0, 0.4) +
 * 0.2 kd, warm = (0.4, 0.4, 0) + 0.6 kd. No shadows. Of several lights t is the mean, weighted by their light at the
 * point; without lights l is the direction to the viewer.
 * INK: white. */
struct vec3 style_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf, uint64_t key);

/* Lines between neighbouring camera rays that hit different objects or materials, or surfaces whose normals differ by
 * more than 30 degrees, or where another part of the object that is more than 4 pixels nearer hides a surface. They are
 * computed for the time at which the shutter opens, and for the centre of the lens. After B. Choudhury and S. Parker,
 * "Ray Tracing NPR-Style Feature Lines", NPAR 2009; different from the paper, the pixels that edges cross are found
 * first, each once. */

struct contour_sample {
    struct vec3 point, normal; /* normal: unit, to the viewer */
    double pixel;              /* diameter of a pixel there, world units */
    uint32_t primitive, material;
    bool second; /* in the right picture of a pair */
};

/* State of one worker. Owns the samples. Zero: no lines. */
struct contour {
    double width; /* pixels; 0: no lines */
    int rim;      /* pixels around a tile that are sampled */
    struct contour_sample *samples;
    struct film_rectangle tile;
    float squared[FILM_TILE * FILM_TILE]; /* the distance of the nearest edge from the pixel's centre, pixels */
};

/* False: no memory. */
bool contour_init(struct contour *contour, double width);
void contour_destroy(struct contour *contour);
/* Finds the lines in a part of a tile. False: stopped. */
bool contour_find(struct contour *contour, const struct renderer *renderer, struct worker *worker,
                  const struct film_rectangle *tile);
/* The fraction of a pixel of that part that lines cover, 0..1. */
double contour_coverage(const struct contour *contour, int64_t x, int64_t y);

#endif
