/* Drawing over a picture: letters, boxes and lines into red, green, blue, opacity. It has its own letters, 5 x 7 dots
 * in a cell of 6 x 10, printable ASCII. Everything is clipped at the edge of the canvas. */
#ifndef GRAY_VIEWER_CANVAS_H
#define GRAY_VIEWER_CANVAS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct canvas_colour {
    uint8_t red, green, blue, opacity;
};

struct canvas {
    uint8_t *rgba; /* not owned */
    int width, height;
    int scale; /* pixels per dot of a letter */
};

enum { CANVAS_CELL = 6, CANVAS_LINE = 10, CANVAS_LETTER = 7 }; /* dots */

void canvas_clear(const struct canvas *canvas);
/* Replaces earlier content: panels are as opaque as their ink. */
void canvas_box(const struct canvas *canvas, int x, int y, int width, int height, struct canvas_colour colour);
/* The text ends at NUL; other than printable ASCII becomes '?' (once for each character in UTF-8). */
void canvas_text(const struct canvas *canvas, int x, int y, const char *text, struct canvas_colour colour);
int canvas_text_width(const struct canvas *canvas, const char *text);
void canvas_line(const struct canvas *canvas, double x0, double y0, double x1, double y1, struct canvas_colour colour);
void canvas_ring(const struct canvas *canvas, double x, double y, double radius, struct canvas_colour colour);

#endif
