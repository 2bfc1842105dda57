/* Letters from font files (TrueType, OpenType, Type 1), as outlines. */
#ifndef GRAY_FORMATS_FONT_H
#define GRAY_FORMATS_FONT_H

#include "base/arena.h"
#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One letter at its position. All lengths are in ems: a font of size 1. Contour c has the points starts[c] up to,
 * but not including, starts[c + 1]: closed cubic Bezier pieces of three points each. The first point of the next
 * contour, or the contour's own first point, follows the last two. Straight and quadratic pieces are converted to
 * cubic ones. */
struct font_glyph {
    uint32_t code; /* Unicode */
    bool missing;  /* the font does not have this letter and shows its box instead */
    double x;      /* its start, after advances and kerning so far */
    double advance;
    uint32_t contour_count;
    const uint32_t *starts;
    const double (*points)[2];
};

struct font_text {
    uint32_t count;
    const struct font_glyph *glyphs;
    double width;                     /* sum of the advances with kerning */
    double ascender, descender, line; /* of the font: above the base line, below it (negative), between lines */
};

enum { FONT_TEXT_LIMIT = 100000 }; /* letters */

struct font_file {
    const char *path; /* for errors */
    const uint8_t *data;
    size_t size;
};
/* Sets one line of UTF-8 text, from x = 0. The bytes of the font are read in place. Everything in `out` is in the
 * arena. Invalid fonts and texts are scene errors. */
bool font_layout(const struct font_file *file, const char *text, struct arena *arena, struct font_text *out,
                 struct error *error);

/* Whether this build can read fonts. */
#ifdef HAVE_FREETYPE
enum { FONTS_READABLE = 1 };
#else
enum { FONTS_READABLE = 0 };
#endif
/* "FreeType 2.13.0", or "none". */
const char *font_library(void);

#endif
