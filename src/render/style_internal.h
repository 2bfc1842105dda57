/* Pictures that look like drawings: shading in a style (settings.h). */
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
struct colour style_light(struct integrator_state *state, const struct hit *hit, const struct bsdf *bsdf, uint64_t key);

#endif
