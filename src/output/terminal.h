/* A film drawn in the terminal, reduced to fit: by the graphics protocol of kitty, by sixels, or with half blocks in
 * 24-bit colours, which any modern terminal shows. On standard output. */
#ifndef GRAY_OUTPUT_TERMINAL_H
#define GRAY_OUTPUT_TERMINAL_H

#include "film/film.h"
#include "image/tone.h"
#include "session/options.h"

#include <stdbool.h>
#include <stdio.h>

struct terminal {
    enum terminal_graphics graphics; /* never AUTO once it is open */
    bool moves;                      /* a real terminal: the picture is redrawn in place while it is rendered */
    int columns, lines;              /* of the terminal */
    int cell_width, cell_height;     /* pixels, if the terminal reports them; else 8 x 16 */
    int rows;                        /* lines of the picture above the cursor; 0: no picture */
};

/* AUTO: kitty if the environment names it, sixel if the terminal reports it, else half blocks. */
void terminal_open(struct terminal *terminal, enum terminal_graphics wanted);
void terminal_begin(struct terminal *terminal);
/* Without memory it draws nothing. */
void terminal_draw(struct terminal *terminal, const struct film *film, const struct tone *tone);

/* An image of RGB bytes in each of the three forms. */
void terminal_blocks(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height);
void terminal_kitty(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height, int columns, int rows);
void terminal_sixel(FILE *stream, const uint8_t *rgb, uint32_t width, uint32_t height);

#endif
