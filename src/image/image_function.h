/* A picture as a function of two numbers, with bounds and slopes, for img:at(u, v) of a recorded function. u counts
 * from the left edge, v upwards from the lower edge, like the coordinates of hits. The image is borrowed. */
#ifndef GRAY_IMAGE_IMAGE_FUNCTION_H
#define GRAY_IMAGE_IMAGE_FUNCTION_H

#include "base/bundle.h"
#include "image/image.h"

/* The lookup reads the image at scale * (u, v) + offset; then flip_u mirrors u. IMAGE_MIPMAP has no footprint here: it
 * is IMAGE_BILINEAR. */
struct image_function {
    const struct image *image;
    struct image_sampling sampling;
    double scale[2], offset[2];
    bool flip_u;
    double tint[3]; /* factors of red, green and blue */
};

/* Channels: red, green and blue, multiplied by alpha, and alpha. */
enum { TEXEL_CHANNELS = 4 };
double image_function_value(const struct image_function *function, double u, double v, int channel);
/* The derivatives by u and v; 0 for IMAGE_NEAREST, and one-sided between two texels. */
void image_function_slopes(const struct image_function *function, double u, double v, int channel, double slopes[2]);

/* Values of u or v: all numbers between low and high, and perhaps NaN. */
struct image_interval {
    double low, high;
    bool may_be_nan;
};
/* Bounds of the values. They come from a pyramid of minimum and maximum values of blocks (as in A. Tevs, I. Ihrke and
 * H.-P. Seidel, "Maximum mipmaps", I3D 2008), which image_make_ranges builds. Without the pyramid they are the bounds
 * of any image. */
struct image_interval image_function_bounds(const struct image_function *function, struct image_interval u,
                                            struct image_interval v, int channel);
/* The pyramid of the image, which owns it. The first call for an image is not thread-safe. False: no memory. */
bool image_make_ranges(struct image *image, struct error *error);
struct image_ranges;
/* Copies what *ranges points to (base/bundle.h). */
void image_ranges_bundle(struct bundle *bundle, struct image_ranges **ranges);

#endif
