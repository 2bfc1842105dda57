/* Writes the pictures beside the picture (--aov). */
#ifndef GRAY_OUTPUT_LAYERS_INTERNAL_H
#define GRAY_OUTPUT_LAYERS_INTERNAL_H

#include "base/file_output.h"
#include "film/film.h"
#include "image/tone.h"

/* The layers of the film in files of the picture's format: dir/foo.png with depth is dir/foo.depth.png. An EXR picture
 * contains them already (layers_write_exr). Depth is always written with 16 bits, the others with the bit depth of the
 * picture. In a PNG file the picture before denoising has the tone curve and the encoding of the picture. */
bool layers_write(const struct file_target *picture, const struct film *film, const struct tone *tone,
                  bool deep_picture, struct error *error);

/* Light as R, G, B, alpha as A (or NULL), and the layers as channels with their names: depth.Z, normal.X ... */
bool layers_write_exr(const struct file_target *target, const struct film *film, const float *alpha,
                      struct error *error);

enum { LAYER_NAME_LIMIT = 4096 };
/* dir/foo.png with the layer depth is dir/foo.depth.png. */
bool layers_name(const char *name, const char *layer, char out[LAYER_NAME_LIMIT], struct error *error);

#endif
