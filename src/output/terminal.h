/* A film drawn in the terminal, as small as it takes to fit: by the graphics protocol of kitty, by sixels, or with half
 * blocks in 24-bit colours, which any terminal of today shows. On standard output. */
#ifndef GRAY_OUTPUT_TERMINAL_H
#define GRAY_OUTPUT_TERMINAL_H

#include "image/tone.h"
#include "render/film.h"
#include "session/options.h"

#include <stdbool.h>
#include <stdio.h>

struct terminal {
    enum terminal_graphics graphics; /* never AUTO once it is open */
    bool moves;                      /* a real terminal: the picture is drawn over itself while it is made */
    int columns, lines;              /* of the terminal */
    int cell_width, cell_height;     /* pixels, where the terminal reports them; else 8 x 16 */
    int rows;                        /* lines the picture covers above the cursor; 0: none is there */
};

/* AUTO: kitty if the environment names it, sixel if the terminal reports it, else half blocks. */
void terminal_open(struct terminal *terminal, enum terminal_graphics wanted);
void terminal_begin(struct terminal *terminal);
/* Without memory nothing is drawn. */
void terminal_draw(struct terminal *terminal, const struct film *film, const struct tone *tone);

/* The pieces: an image of RGB bytes as each of the three. */
void terminal_blocks(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height);
void terminal_kitty(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height, int columns, int rows);
void terminal_sixel(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height);
/* The film as width x height RGB bytes: means of the light of its pixels, toned. */
void terminal_shrink(const struct film *film, const struct tone *tone, uint32_t width, uint32_t height, uint8_t *rgb);

#endif
