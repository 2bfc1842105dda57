/* Layers and their colours. Colours do not depend on the picture where that can be avoided, so that two pictures can be
 * compared: cost goes by its logarithm from black (1) over blue, red and yellow to white (2^20); numbers of nodes and
 * materials get colours by a hash. Depth is nearest / distance, as in depth buffers. */
#include "film/aov.h"

#include "base/random.h"
#include "math/elementary.h"

#include <math.h>
#include <string.h>

#define AOV_NAME(aov, name, channels) [aov] = (name),
#define AOV_CHANNELS(aov, name, channels) [aov] = (channels),
static const char *const names[] = {AOVS(AOV_NAME)};

const char *aov_name(enum aov aov) {
    return names[aov];
}

const char *aov_channels(enum aov aov) {
    static const char *const all[] = {AOVS(AOV_CHANNELS)};
    return all[aov];
}

bool aov_parse(const char *text, uint32_t *mask) {
    *mask = 0;
    for (const char *at = text;; at++) {
        size_t size = strcspn(at, ",");
        uint32_t found = size == 3 && memcmp(at, "all", 3) == 0 ? AOV_ALL : 0;
        for (int i = 0; i < AOV_COUNT; i++)
            if (strlen(names[i]) == size && memcmp(at, names[i], size) == 0)
                found = UINT32_C(1) << i;
        if (found == 0)
            return false;
        *mask |= found;
        at += size;
        if (*at == '\0')
            return true;
    }
}

uint32_t aov_layers(uint32_t mask) {
    return (uint32_t)__builtin_popcount(mask & AOV_ALL);
}

uint32_t aov_layer(uint32_t mask, enum aov aov) {
    return aov_layers(mask & ((UINT32_C(1) << aov) - 1));
}

struct aov_scale aov_scale(enum aov aov, const float (*values)[3], size_t count) {
    struct aov_scale scale = {INFINITY, 1};
    for (size_t i = 0; i < count && (aov == AOV_DEPTH || aov == AOV_SAMPLES); i++) {
        double value = (double)values[i][0];
        scale.nearest = value > 0 && value < scale.nearest ? value : scale.nearest;
        scale.max = value > scale.max ? value : scale.max;
    }
    return scale;
}

static double clamp01(double x) {
    return x >= 1 ? 1 : x > 0 ? x : 0;
}

/* Black, blue, red, yellow, white at 0, 1/4 ... 1. */
static void heat(double x, double rgb[3]) {
    static const double stops[5][3] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
    double position = clamp01(x) * 4;
    int below = position >= 3 ? 3 : (int)position;
    for (int c = 0; c < 3; c++)
        rgb[c] = stops[below][c] + (position - below) * (stops[below + 1][c] - stops[below][c]);
}

static double fraction(double x) {
    return x - floor(x);
}

void aov_colour(enum aov aov, const struct aov_scale *scale, const float value[3], double rgb[3]) {
    const double v[3] = {(double)value[0], (double)value[1], (double)value[2]};
    for (int c = 0; c < 3; c++)
        rgb[c] = clamp01(v[c]);
    switch (aov) {
    case AOV_DEPTH:
        rgb[0] = rgb[1] = rgb[2] = v[0] > 0 ? clamp01(scale->nearest / v[0]) : 0;
        break;
    case AOV_NORMAL:
        for (int c = 0; c < 3 && (v[0] != 0 || v[1] != 0 || v[2] != 0); c++)
            rgb[c] = clamp01((v[c] + 1) / 2);
        break;
    case AOV_UV:
        rgb[0] = fraction(v[0]);
        rgb[1] = fraction(v[1]);
        break;
    case AOV_NODE:
    case AOV_MATERIAL:
        for (uint32_t c = 0; c < 3 && v[0] > 0; c++)
            rgb[c] = 0.25 + 0.75 * random_unit(random_combine((uint64_t)v[0], c));
        break;
    case AOV_COST:
        heat(v[0] > 0 ? el_log(v[0]) / (20 * 0.69314718055994530942) : 0, rgb);
        break;
    case AOV_SAMPLES:
        rgb[0] = rgb[1] = rgb[2] = v[0] / scale->max;
        break;
    case AOV_ALBEDO: /* this and the others are colours */
    case AOV_LIGHTS:
    case AOV_RAW:
    case AOV_VARIANCE:
    case AOV_EMISSION:
    case AOV_DIFFUSE_DIRECT:
    case AOV_DIFFUSE_INDIRECT:
    case AOV_SPECULAR_DIRECT:
    case AOV_SPECULAR_INDIRECT:
    case AOV_TRANSMISSION_DIRECT:
    case AOV_TRANSMISSION_INDIRECT:
    case AOV_VOLUME_DIRECT:
    case AOV_VOLUME_INDIRECT:
        break;
    }
}
