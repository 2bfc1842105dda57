/* Curves that are no functions of scripts rise with the light. So where the lights at both ends of an interval have one
 * byte, even if the values were a little less or more, all between them have it. */
#include "image/tone_lookup.h"

#include "image/png_write.h"

#include <string.h>

enum { SHIFT = 12, FIRST_ENTRY = (127 - 16) << 11, SEVERAL = 257 };

/* What rounding in the functions can do is less. */
static const double margin = 1e-9;

void tone_lookup_set(struct tone_lookup *lookup, const struct tone *tone) {
    const struct tone *before = &lookup->tone;
    const bool same_light = !(before->exposure < tone->exposure || before->exposure > tone->exposure);
    const bool is_same = same_light && before->curve == tone->curve && before->srgb == tone->srgb;
    lookup->tone = *tone;
    if (tone->curve == TONE_FUNCTION)
        return;
    if (!is_same)
        memset(lookup->entries, 0, sizeof lookup->entries);
    lookup->zero = png_write_byte(tone_apply(tone, 0));
}

static double value_at(const struct tone *tone, uint32_t bits) {
    float light;
    memcpy(&light, &bits, sizeof light);
    return tone_apply(tone, (double)light);
}

static uint16_t find_entry(const struct tone *tone, uint32_t interval) {
    const double low = value_at(tone, interval << SHIFT);
    const double high = value_at(tone, (interval << SHIFT) | ((1u << SHIFT) - 1));
    const uint8_t byte = png_write_byte(low - margin);
    return byte == png_write_byte(high + margin) ? (uint16_t)(byte + 1) : SEVERAL;
}

static uint8_t find_byte(struct tone_lookup *lookup, float light) {
    uint32_t bits;
    memcpy(&bits, &light, sizeof bits);
    const uint32_t interval = bits >> SHIFT, number = interval - FIRST_ENTRY;
    const bool rises = lookup->tone.curve != TONE_FUNCTION;
    if (bits == 0 && rises)
        return lookup->zero;
    if (number < TONE_LOOKUPS && rises) {
        uint16_t *entry = &lookup->entries[number];
        if (*entry == 0)
            *entry = find_entry(&lookup->tone, interval);
        if (*entry != SEVERAL)
            return (uint8_t)(*entry - 1);
    }
    return png_write_byte(tone_apply(&lookup->tone, (double)light));
}

void tone_lookup_bytes(struct tone_lookup *lookup, const float *lights, size_t count, uint8_t *out) {
    for (size_t i = 0; i < count; i++)
        out[i] = find_byte(lookup, lights[i]);
}
