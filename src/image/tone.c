/* Curves, channel by channel: Reinhard, Stark, Shirley, Ferwerda, "Photographic Tone Reproduction for Digital Images",
 * SIGGRAPH 2002 (equation 3), and the fit of Narkowicz, "ACES Filmic Tone Mapping Curve", 2015. */
#include "image/tone.h"

#include "math/elementary.h"

#include <math.h>

double tone_apply(const struct tone *tone, double c) {
    if (tone->exposure != 0)
        c *= el_exp2(tone->exposure);
    switch (tone->curve) {
    case TONE_NONE:
        break;
    case TONE_REINHARD:
        c = c > 0 ? c / (1 + c) : c;
        break;
    case TONE_FILMIC:
        c = c > 0 ? c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14) : c;
        break;
    }
    if (tone->srgb)
        c = c <= 0.0031308 ? 12.92 * c : 1.055 * el_pow(c, 1 / 2.4) - 0.055;
    return c;
}

uint16_t tone_word(double c) {
    if (!(c > 0))
        return 0;
    return c < 1 ? (uint16_t)floor(65535 * c + 0.5) : 65535;
}
