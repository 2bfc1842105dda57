/* T. Lottes, "FXAA", NVIDIA white paper, 2009: see fxaa.c. */
#ifndef GRAY_IMAGE_FXAA_INTERNAL_H
#define GRAY_IMAGE_FXAA_INTERNAL_H

#include "image/finish.h"

/* in and out are different arrays of numbers in 0..1. */
enum { FXAA_RIM = 18 };
void fxaa_apply(const struct finish_area *area, const float (*in)[3], float (*out)[3]);

#endif
