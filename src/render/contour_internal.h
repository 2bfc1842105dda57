/* Lines between neighbouring camera rays that hit different objects or materials, or surfaces whose normals differ by
 * more than 30 degrees, or where another part of the object that is more than 4 pixels nearer hides a surface. They are
 * computed for the time at which the shutter opens, and for the centre of the lens. After B. Choudhury and S. Parker,
 * "Ray Tracing NPR-Style Feature Lines", NPAR 2009; different from the paper, the pixels that edges cross are found
 * first, each once. */
#ifndef GRAY_RENDER_CONTOUR_INTERNAL_H
#define GRAY_RENDER_CONTOUR_INTERNAL_H

#include "render/render_internal.h"

struct contour_sample {
    struct vec3 point, normal; /* normal: unit, to the viewer */
    double pixel;              /* diameter of a pixel there, world units */
    uint32_t primitive, material;
    uint32_t view; /* its number (struct camera_view) */
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
