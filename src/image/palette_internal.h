/* Palettes of at most 256 colours for pictures with 8 bits per channel. */
#ifndef GRAY_IMAGE_PALETTE_INTERNAL_H
#define GRAY_IMAGE_PALETTE_INTERNAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PALETTE_COLOURS = 256 };

struct palette {
    uint8_t colours[PALETTE_COLOURS][3];
    int count;
    int spread; /* amplitude of the dither in levels; 0: every colour of the pictures is in the palette, up to 4
                 * levels */
};

/* Counts the colours of pictures; one is several megabytes. */
struct palette_count;
struct palette_count *palette_count_create(void); /* NULL: no memory */
void palette_count_destroy(struct palette_count *count);
void palette_count_clear(struct palette_count *count);
void palette_count_add(struct palette_count *count, const uint8_t *rgb, size_t pixels);
/* The palette of the counted colours by median cut. False: no memory. */
bool palette_make(const struct palette_count *count, struct palette *out);

/* Finds colours of a palette, and caches them. */
struct palette_search;
struct palette_search *palette_search_create(void); /* NULL: no memory */
void palette_search_destroy(struct palette_search *search);
void palette_search_begin(struct palette_search *search, const struct palette *palette);
/* The index of the colour for a byte triple at a pixel: the nearest one after ordered dithering. The dithering depends
 * only on the position, so parts of an animation without motion do not change. */
uint8_t palette_find(struct palette_search *search, const uint8_t rgb[3], uint32_t x, uint32_t y);
/* The threshold of the dither at a pixel, from -127 to 127 128ths of half the spread: Bayer's matrix of 8 x 8. */
int palette_threshold(uint32_t x, uint32_t y);

#endif
