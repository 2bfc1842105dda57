/* From linear light to the values of a picture file with limited range: exposure, tone curve, transfer function. The
 * zero value changes nothing. */
#ifndef GRAY_IMAGE_TONE_H
#define GRAY_IMAGE_TONE_H

#include "base/list.h"

#include <stdbool.h>
#include <stdint.h>

#define TONE_CURVES(X)                                                                                                 \
    X(TONE_NONE, "none")                                                                                               \
    X(TONE_REINHARD, "reinhard")                                                                                       \
    X(TONE_FILMIC, "filmic")
enum tone_curve {
    TONE_CURVES(LIST_MEMBER) TONE_FUNCTION /* of a script: a table */
};

/* A function at TONE_ENTRIES lights: 0, then steps of 2^-22 to 2^-15, then 128 steps for each doubling, to 65280. All
 * are exact floats, so the table of f(x) = x is f. Between them it is linear: the error is h^2/8 max |f''|, for smooth
 * curves less than 1e-5 of the value. Above the last light the last value holds, below 0 the first. */
enum { TONE_ENTRIES = 4096 };
struct tone_table {
    float values[TONE_ENTRIES]; /* finite */
};
double tone_table_light(int entry);
/* The largest slope of the function between two lights, its sign ignored. */
double tone_table_slope(const struct tone_table *table);

struct tone {
    double exposure; /* stops: light is multiplied by 2^exposure */
    enum tone_curve curve;
    bool srgb;                      /* the transfer function of IEC 61966-2-1; else values stay linear */
    const struct tone_table *table; /* of TONE_FUNCTION; borrowed */
};

static inline bool tone_is_plain(const struct tone *tone) {
    return tone->exposure == 0 && tone->curve == TONE_NONE && !tone->srgb;
}
/* One channel; not clamped. NaN stays NaN. */
double tone_apply(const struct tone *tone, double c);
/* floor(65535 c + 0.5) after clamping to [0,1]; NaN gives 0. */
uint16_t tone_word(double c);
/* The bytes of a display, of lights from 2^-16 to 2^16 of the exposure, 128 for each doubling: without powers, and at
 * most one from those of a PNG file. */
enum { TONE_BYTES = 32 << 7 };
struct tone_bytes {
    float scale;
    uint8_t bytes[TONE_BYTES];
};
void tone_bytes_make(const struct tone *tone, struct tone_bytes *out);
uint8_t tone_byte(const struct tone_bytes *bytes, float light);

#endif
