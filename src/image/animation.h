/* Files of animations, from frames of 8 bits per channel: APNG, GIF, WebP, Y4M. Writers request the frames in order, so
 * only one or two frames are in memory. */
#ifndef GRAY_IMAGE_ANIMATION_H
#define GRAY_IMAGE_ANIMATION_H

#include "base/error.h"
#include "base/file_output.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct animation_source {
    uint32_t width, height, count; /* of frames, from 1 */
    double rate;                   /* frames per second, as FRAME_RATE_MIN to FRAME_RATE_MAX */
    bool loops;                    /* plays without end; false: once */
    bool srgb;                     /* the numbers are encoded with the sRGB function: APNG files state it */
    /* Fills 3 * width * height bytes, RGB; row 0 on top. index: from 0. False: error. */
    bool (*frame)(void *context, uint32_t index, uint8_t *rgb, struct error *error);
    void *context;
};

/* APNG (PNG specification, third edition, 2025; acTL, fcTL, fdAT). Each frame after the first one contains only the
 * rectangle of pixels that differ from the previous frame. Lossless: a decoder gives the bytes of the frames. */
bool apng_write(const struct file_target *target, const struct animation_source *source, struct error *error);

/* GIF89a. 256 colours for all frames or for each frame, with ordered dithering. The sum of the delays does not drift
 * from the duration. Sides up to 65535. */
bool gif_write(const struct file_target *target, const struct animation_source *source, bool palette_for_each,
               struct error *error);
/* The delay of frame `index`, from 0, in hundredths of a second: 3, 3, 4 for 30 frames per second. */
uint32_t gif_delay(double rate, uint32_t index);

/* WebP, lossless: a decoder gives the bytes of the frames. Sides up to 16383. Successive equal frames become one.
 * Without libwebp it is an error. */
bool webp_write(const struct file_target *target, const struct animation_source *source, struct error *error);
#define WEBP_MISSING "%.600s: WebP files need libwebp, and this build was made without it"
bool webp_can_write(void);
/* "libwebp" or "none". */
const char *webp_library(void);

/* YUV4MPEG2 with 4:4:4 samples of 8 bits, limited range, matrix of BT.601. */
bool y4m_write(const struct file_target *target, const struct animation_source *source, struct error *error);
/* The parts of a Y4M stream: the first line, and a frame of Y4M_FRAME_HEAD + 3 * width * height bytes. */
enum { Y4M_HEAD_SIZE = 128, Y4M_FRAME_HEAD = 6 };
size_t y4m_head(const struct animation_source *source, char out[Y4M_HEAD_SIZE]);
void y4m_frame(const uint8_t *rgb, size_t pixels, uint8_t *out);

/* Frames per second as a fraction of whole numbers. */
struct frame_rate {
    uint32_t over, under;
};
struct frame_rate frame_rate_fraction(double rate);

/* Whether a file begins like an animation of any kind, including video formats. */
bool animation_is(const uint8_t *head, size_t size);

/* A PNG file with 8 bits per channel, RGB, without interlacing, as png_write_from writes them: reading gives exactly
 * its bytes. */
struct png_frame {
    uint32_t width, height;
    bool srgb; /* the file has an sRGB chunk */
};
bool png_frame_head(const char *path, struct png_frame *out, struct error *error);
/* The file must have this size; rgb: 3 * width * height bytes. */
bool png_frame_read(const char *path, uint32_t width, uint32_t height, uint8_t *rgb, struct error *error);

#endif
