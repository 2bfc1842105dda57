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
enum tone_curve { TONE_CURVES(LIST_MEMBER) };

struct tone {
    double exposure; /* stops: light is multiplied by 2^exposure */
    enum tone_curve curve;
    bool srgb; /* the transfer function of IEC 61966-2-1; else values stay linear */
};

static inline bool tone_is_plain(const struct tone *tone) {
    return tone->exposure == 0 && tone->curve == TONE_NONE && !tone->srgb;
}
/* One channel; not clamped. NaN stays NaN. */
double tone_apply(const struct tone *tone, double c);
/* floor(65535 c + 0.5) after clamping to [0,1]; NaN gives 0. */
uint16_t tone_word(double c);

#endif
