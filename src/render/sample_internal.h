/* Samples of a picture: from a position in it to the radiance. */
#ifndef GRAY_RENDER_SAMPLE_INTERNAL_H
#define GRAY_RENDER_SAMPLE_INTERNAL_H

#include "render/render_internal.h"

/* The camera at a ray's time. */
bool renderer_prepare_at(const struct render_job *job, double ray_time, struct camera_frame *out, char warning[256],
                         struct error *error);
/* The camera of a sample; `own` is for one that moves. NULL: the one moment in which a view turns through zero. */
const struct camera_frame *renderer_camera_of(const struct renderer *renderer, const struct sampler *sampler,
                                              struct camera_frame *own);
/* The camera ray through (x, y) and the centre of the lens, when the shutter opens. False: nothing is visible there. */
bool renderer_middle_ray(const struct renderer *renderer, double x, double y, struct ray *out);
/* The ray of a sample, with its time and footprint, but not of both eyes. False: nothing is visible there. */
bool renderer_camera_ray(const struct renderer *renderer, const struct camera_frame *camera,
                         const struct pixel_sample *at, const struct sampler *sampler, struct ray *out);
/* The media that contain the origin of a camera ray; `own` has room for them. */
const struct medium_stack *renderer_eye_media(const struct renderer *renderer, const struct ray *ray,
                                              struct world_scratch *scratch, struct medium_stack *own);
/* The first sample has number 0, at the centre or the corner of the pixel. */
struct pixel_sample renderer_first_sample(const struct renderer *renderer, int64_t x, int64_t y);
struct colour renderer_sample(struct renderer *renderer, struct worker *worker, const struct pixel_sample *position);
/* The samples of a batch, equal to those of renderer_sample. The hits of the camera rays are found together. */
void renderer_sample_batch(struct renderer *renderer, struct worker *worker);

#endif
