/* The film: one picture in memory that supervisor and child share. The child's workers write pixels, the supervisor
 * reads whole tiles. Colours are linear floats, nothing is clamped. */
#ifndef GRAY_RENDER_FILM_H
#define GRAY_RENDER_FILM_H

#include "base/error.h"
#include "image/tone.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FILM_TILE = 32 };

/* Header at the start of the shared block; arrays follow. Width and height are those of the part that is rendered (the
 * crop), x0, y0 its place in the whole picture. */
struct film_pixel {
    float rgb[3];   /* final */
    float first[3]; /* first pass, one sample */
};
struct film {
    uint32_t width, height;
    uint32_t x0, y0, full_width, full_height;
    struct film_pixel *pixels; /* width * height, row-major, top row first */
    uint8_t *marked;           /* 1 = resampled */
};

/* Bytes for the arrays of a film; false when the numbers are too large (over 2^31 pixels). */
bool film_size(uint32_t width, uint32_t height, size_t *bytes, struct error *error);
/* Lays the arrays into a zeroed block of film_size bytes. */
void film_place(struct film *film, void *block, uint32_t width, uint32_t height);

enum film_view { FILM_FINAL, FILM_FIRST, FILM_TARGETS }; /* TARGETS: first pass with marked pixels in pure red */
/* 3 * width bytes of row y. */
void film_row(const struct film *film, enum film_view view, uint32_t y, uint8_t *line);
/* The same through a tone, with 8 or 16 bits; and as the film has it. */
void film_row_toned(const struct film *film, enum film_view view, const struct tone *tone, uint32_t y, uint8_t *line);
void film_row_16(const struct film *film, enum film_view view, const struct tone *tone, uint32_t y, uint16_t *line);
void film_row_linear(const struct film *film, enum film_view view, uint32_t y, float *line);

#endif
