/* Curves, channel by channel: Reinhard, Stark, Shirley, Ferwerda, "Photographic Tone Reproduction for Digital Images",
 * SIGGRAPH 2002 (equation 3), and the fit of Narkowicz, "ACES Filmic Tone Mapping Curve", 2015. */
#include "image/tone.h"

#include "math/elementary.h"
#include "math/portable.h"

#include <math.h>
#include <string.h>

enum { TONE_STEPS = 128 }; /* of a doubling */

double tone_table_light(int entry) {
    int doubling = entry < TONE_STEPS ? 0 : entry / TONE_STEPS - 1;
    return math_ldexp(entry - doubling * TONE_STEPS, doubling - 22);
}

double tone_table_slope(const struct tone_table *table) {
    double max = 0;
    for (int i = 1; i < TONE_ENTRIES; i++) {
        double rise = fabs((double)table->values[i] - (double)table->values[i - 1]);
        max = math_max(max, rise / (tone_table_light(i) - tone_table_light(i - 1)));
    }
    return max;
}

static double table_value(const struct tone_table *table, double c) {
    int exponent;
    if (!(c > 0))
        return c == c ? (double)table->values[0] : c;
    if (c >= tone_table_light(TONE_ENTRIES - 1))
        return (double)table->values[TONE_ENTRIES - 1];
    c = math_ldexp(c, 22);
    (void)math_frexp(c, &exponent);
    int doubling = exponent > 8 ? exponent - 8 : 0; /* c / 2^doubling is below 256, and from 128 on where it is not 0 */
    c = math_ldexp(c, -doubling);
    int step = (int)c, entry = doubling * TONE_STEPS + step;
    double low = (double)table->values[entry], high = (double)table->values[entry + 1];
    return low + (high - low) * (c - step);
}

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
    case TONE_FUNCTION:
        c = table_value(tone->table, c);
        break;
    }
    if (tone->srgb)
        c = c <= 0.0031308 ? 12.92 * c : 1.055 * el_pow(c, 1 / 2.4) - 0.055;
    return c;
}

uint16_t tone_word(double c) {
    if (!(c > 0))
        return 0;
    return (uint16_t)(c < 1 ? floor(65535 * c + 0.5) : 65535);
}

/* The upper 16 bits of a float: its exponent and 7 bits of its fraction. */
enum { FIRST_LIGHT = (127 - 16) << 7 };

void tone_bytes_make(const struct tone *tone, struct tone_bytes *out) {
    struct tone unexposed = *tone;
    unexposed.exposure = 0;
    out->scale = (float)el_exp2(tone->exposure);
    for (uint32_t i = 0; i < TONE_BYTES; i++) {
        uint32_t bits = (FIRST_LIGHT + i) << 16 | 0x8000; /* the middle */
        float light;
        memcpy(&light, &bits, sizeof light);
        double c = tone_apply(&unexposed, (double)light);
        out->bytes[i] = (uint8_t)(c > 0 ? floor(255 * math_min(c, 1) + 0.5) : 0);
    }
}

uint8_t tone_byte(const struct tone_bytes *bytes, float light) {
    uint32_t bits;
    light *= bytes->scale;
    light = light > 0x1p-16f ? light : 0x1p-16f; /* NaN too */
    light = light < 0x1.fep15f ? light : 0x1.fep15f;
    memcpy(&bits, &light, sizeof bits);
    return bytes->bytes[(bits >> 16) - FIRST_LIGHT];
}
