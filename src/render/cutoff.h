/* When a ray no longer counts. */
#ifndef GRAY_RENDER_CUTOFF_H
#define GRAY_RENDER_CUTOFF_H

#include "render/render.h"

/* The weight of a ray in its pixel below which it changes the picture by less than settings.cutoff of white: that, over
 * how bright things can be in this scene, and over how much the tone of the picture file raises small differences. 0:
 * every ray counts. */
double cutoff_weight(const struct render_job *job);

#endif
