/* The animations of a glTF file, for its nodes. */
#ifndef GRAY_FORMATS_GLTF_ANIMATION_INTERNAL_H
#define GRAY_FORMATS_GLTF_ANIMATION_INTERNAL_H

#include "formats/gltf_internal.h"

/* What an animation moves of a node. */
enum gltf_path { GLTF_TRANSLATION, GLTF_ROTATION, GLTF_SCALE, GLTF_WEIGHTS };
enum { GLTF_PATHS = GLTF_WEIGHTS + 1 };

/* The lists of the model: names and durations. */
bool gltf_list_animations(struct gltf *g);
/* The samplers of the chosen animation by node and path, NULL for what it does not move; *out is NULL if nothing moves,
 * and is freed by the caller. */
bool gltf_choose_animation(struct gltf *g, const json_t *(**out)[GLTF_PATHS]);
/* The `width` numbers of a sampler at the time of the options. */
bool gltf_sample(struct gltf *g, const json_t *sampler, enum gltf_path path, double *out, size_t width);

#endif
