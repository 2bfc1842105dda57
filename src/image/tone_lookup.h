/* The bytes of lights in a PNG file, from a table that is filled as it is used: exact, and for most lights without the
 * functions of the tone. */
#ifndef GRAY_IMAGE_TONE_LOOKUP_H
#define GRAY_IMAGE_TONE_LOOKUP_H

#include "image/tone.h"

#include <stddef.h>

/* Lights of 2^-16 to 2^16, 2048 intervals for each doubling. */
enum { TONE_LOOKUPS = 32 << 11 };
struct tone_lookup {
    struct tone tone;
    uint8_t zero;                   /* the byte of no light */
    uint16_t entries[TONE_LOOKUPS]; /* 0: not known; 257: it has several bytes; else the byte, and 1 */
};
/* Before the first byte, and before others of another tone. `lookup` is zero-initialised. */
void tone_lookup_set(struct tone_lookup *lookup, const struct tone *tone);
/* Each equal to png_write_byte(tone_apply(tone, light)). */
void tone_lookup_bytes(struct tone_lookup *lookup, const float *lights, size_t count, uint8_t *out);

#endif
