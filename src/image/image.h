/* A picture as a texture: an immutable asset with its mip levels. Texels have the values of the file (no gamma), 8 or
 * 16 bits per channel, always expanded to RGBA; lookups are in premultiplied doubles so that transparent texels have no
 * colour. u counts from the left edge to the right in [0,1], v from the top edge down. Owner: the asset store,
 * counted. */
#ifndef GRAY_IMAGE_IMAGE_H
#define GRAY_IMAGE_IMAGE_H

#include "base/bundle.h"
#include "base/error.h"
#include "base/list.h"
#include "image/transfer.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define IMAGE_FILTERS(X)                                                                                               \
    X(IMAGE_NEAREST, "nearest")                                                                                        \
    X(IMAGE_BILINEAR, "bilinear")                                                                                      \
    X(IMAGE_MIPMAP, "mipmap") /* trilinear where the footprint is known */
enum image_filter { IMAGE_FILTERS(LIST_MEMBER) };
#define IMAGE_WRAPS(X)                                                                                                 \
    X(IMAGE_CLAMP, "clamp")                                                                                            \
    X(IMAGE_REPEAT, "repeat")                                                                                          \
    X(IMAGE_MIRROR, "mirror")
enum image_wrap { IMAGE_WRAPS(LIST_MEMBER) };

struct rgba {
    double r, g, b, a; /* premultiplied where a function says so */
};

struct image;

/* From RGBA samples, row-major, top row first; `bits` 8 (uint8_t), 16 (uint16_t native) or 32 (float). Copies, builds
 * mips. */
struct image *image_create(const char *name, uint32_t width, uint32_t height, int bits, const void *rgba,
                           struct error *error);
/* How numbers of the picture that are colours become light: as the file states it, else 8 bits by sRGB, else as they
 * are. */
struct transfer_function image_colour_transfer(const struct image *image);
/* A colour space of the file that gray does not know and takes as sRGB, for a warning; NULL: none. */
const char *image_colours(const struct image *image);
/* The picture with its 8 or 16 bits decoded to light, 16 bits a channel; alpha stays. Pictures of light, and all for a
 * linear transfer function: themselves. The first call for a function makes it and is not thread-safe; the image owns
 * it. NULL: no memory. */
struct image *image_decode(struct image *image, struct transfer_function transfer, struct error *error);
struct image *image_share(struct image *image);
void image_release(struct image *image);
uint32_t image_width(const struct image *image);
uint32_t image_height(const struct image *image);
int image_bits(const struct image *image); /* of a channel: 8 or 16 */
size_t image_memory(const struct image *image);
const char *image_name(const struct image *image);
/* Level 0 texel, not premultiplied, 0..1 (more in high dynamic range images); x, y in range. */
struct rgba image_texel(const struct image *image, uint32_t x, uint32_t y);
/* The largest value of a colour channel; 1 except for high dynamic range images. */
double image_brightest(const struct image *image);
/* The largest red, green and blue of all texels, and the smallest alpha. The first call reads all texels;
 * thread-safe. */
struct rgba image_largest(const struct image *image);
/* Where a lookup is, u and v finite of any size, and how wide its footprint is in u and v (0: unknown, level 0 is
 * used). */
struct image_point {
    double u, v, width_u, width_v;
};
struct image_sampling {
    enum image_filter filter;
    enum image_wrap wrap_u, wrap_v;
};
/* Filtered, premultiplied. */
struct rgba image_lookup(const struct image *image, struct image_point at, struct image_sampling how);
/* The derivatives by u and v of a lookup with a footprint of size 0; 0 for IMAGE_NEAREST, and beyond the edges for
 * IMAGE_CLAMP. */
void image_lookup_slopes(const struct image *image, struct image_point at, struct image_sampling how, struct rgba *by_u,
                         struct rgba *by_v);
/* The mip level for a footprint of `texels` texels: its binary logarithm, linear between powers of two (0.09 off at
 * most, continuous, and the same on every machine), at least 0 and at most `last`. NaN gives 0. */
double image_level_for(double texels, int last);
/* Pictures of any format that this build reads; the first bytes select the format. */

/* Errors name the path. JPEG files have 8 bits per channel, without alpha. */
struct image *image_read(const char *path, struct error *error);
/* From memory; `path` is for messages. */
struct image *image_parse(const char *path, const uint8_t *data, size_t size, struct error *error);
/* Copies what *image points to (base/bundle.h), but for what only files need. */
void image_bundle(struct bundle *bundle, struct image **image);

#endif
