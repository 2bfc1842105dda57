/* Writes the pictures beside the picture (--aov). */
#ifndef GRAY_OUTPUT_LAYERS_INTERNAL_H
#define GRAY_OUTPUT_LAYERS_INTERNAL_H

#include "base/file_output.h"
#include "base/list.h"
#include "film/film.h"
#include "image/tone.h"

/* The formats of pictures, with their extensions. PICTURE_OTHER, the last one, has none: PNG under any other name. */
#define PICTURE_FORMATS(X)                                                                                             \
    X(PICTURE_PNG, ".png")                                                                                             \
    X(PICTURE_PFM, ".pfm")                                                                                             \
    X(PICTURE_HDR, ".hdr")                                                                                             \
    X(PICTURE_EXR, ".exr")                                                                                             \
    X(PICTURE_OTHER, "")
enum picture_format { PICTURE_FORMATS(LIST_MEMBER) };
/* By the extension of the name, in upper or lower case. */
enum picture_format picture_format(const char *name);
/* All extensions in a sentence: ".png, .pfm or .exr". */
enum { PICTURE_EXTENSIONS_SIZE = 128 };
const char *picture_extensions(char out[PICTURE_EXTENSIONS_SIZE]);

/* The layers of the film in files of the picture's format: dir/foo.png with depth is dir/foo.depth.png. An EXR picture
 * contains them already (layers_write_exr). Depth is always written with 16 bits, the others with the bit depth of the
 * picture. In a PNG file the picture before denoising has the tone curve and the encoding of the picture. */
bool layers_write(const struct file_target *picture, const struct film *film, const struct tone *tone,
                  bool deep_picture, struct error *error);

/* Light as R, G, B, and the layers as channels with their names: depth.Z, normal.X ... */
bool layers_write_exr(const struct file_target *target, const struct film *film, struct error *error);

enum { LAYER_NAME_LIMIT = 4096 };
/* dir/foo.png with the layer depth is dir/foo.depth.png. */
bool layers_name(const char *name, const char *layer, char out[LAYER_NAME_LIMIT], struct error *error);

#endif
