/* New views of a light field, without its scene: M. Levoy, P. Hanrahan, "Light field rendering", SIGGRAPH 1996;
 * refocused by a synthetic aperture: A. Isaksen, L. McMillan, S. Gortler, "Dynamically reparameterized light fields",
 * SIGGRAPH 2000. */
#ifndef GRAY_IMAGE_LIGHT_FIELD_VIEW_H
#define GRAY_IMAGE_LIGHT_FIELD_VIEW_H

#include "image/light_field.h"

/* A camera in the field, with the direction of its cameras. It shows what they show, as far as a picture of its
 * proportions has room for it. */
struct light_field_camera {
    double x, y, z;  /* from the middle of the grid to the right, upwards and along the view, world units */
    double focus;    /* distance of the plane in focus from the eye */
    double aperture; /* radius of the lens, world units */
    uint32_t width, height;
    bool quick; /* a lens looks at everything as if it were in the plane in focus: depths take long */
};

/* Moves an eye on the plane of the cameras into the grid. True: it is outside, or its rays come from outside. */
bool light_field_clamp(const struct light_field_head *head, struct light_field_camera *camera);
/* Draws its picture, light without limits. Loads the views that it needs. An eye at a camera, without aperture and with
 * its size, gives the numbers of that view. Errors: those of light_field_load_part. */
bool light_field_draw(struct light_field *field, const struct light_field_camera *camera, struct pool *pool,
                      float (*out)[3], struct error *error);
/* How far from the eye the surface is that a pixel of the picture shows: by the depths of the field, else where the
 * cameras around the eye agree best. Loads their views. False: nothing is there, or an error (error->text). */
bool light_field_distance(struct light_field *field, const struct light_field_camera *camera, const double pixel[2],
                          struct pool *pool, double *out, struct error *error);

#endif
