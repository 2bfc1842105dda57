/* Drawing over a picture: letters, boxes and lines into red, green, blue, opacity. The letters are our own, 5 x 7 dots
 * in a cell of 6 x 10, printable ASCII. Everything is cut at the paper's edge. */
#ifndef GRAY_VIEWER_CANVAS_H
#define GRAY_VIEWER_CANVAS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct ink {
    uint8_t red, green, blue, opacity;
};

struct paper {
    uint8_t *rgba; /* not owned */
    int width, height;
    int scale; /* pixels for a dot of a letter */
};

enum { PAPER_CELL = 6, PAPER_LINE = 10, PAPER_LETTER = 7 }; /* dots */

void paper_clear(const struct paper *paper);
/* What was there goes away: panels are opaque as far as their ink is. */
void paper_box(const struct paper *paper, int x, int y, int width, int height, struct ink ink);
void paper_frame(const struct paper *paper, int x, int y, int width, int height, struct ink ink);
/* The text ends at NUL; other than printable ASCII becomes '?' (once for each character in UTF-8). */
void paper_text(const struct paper *paper, int x, int y, const char *text, struct ink ink);
int paper_text_width(const struct paper *paper, const char *text);
void paper_line(const struct paper *paper, double x0, double y0, double x1, double y1, struct ink ink);
void paper_ring(const struct paper *paper, double x, double y, double radius, struct ink ink);

#endif
