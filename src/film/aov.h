/* Render layers (AOVs): the hit of the first sample of every pixel, and the cost of the pixel. Each layer has three
 * numbers per pixel; aov_colour converts them to colours, files of linear light (.pfm, .hdr, .exr) have them
 * unchanged. */
#ifndef GRAY_FILM_AOV_H
#define GRAY_FILM_AOV_H

#include "settings/settings.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

const char *aov_name(enum aov aov);
const char *aov_channels(enum aov aov); /* one to three letters, one for each number that means something */
/* Names separated by commas, or "all", as a mask. */
bool aov_parse(const char *text, uint32_t *mask);
/* The number of layers of a mask, and the index of a layer. */
uint32_t aov_layers(uint32_t mask);
uint32_t aov_layer(uint32_t mask, enum aov aov);

/* The colour of a value. nearest: the smallest depth of the picture; most: its largest number of samples. */
struct aov_scale {
    double nearest, max;
};
struct aov_scale aov_scale(enum aov aov, const float (*values)[3], size_t count);
void aov_colour(enum aov aov, const struct aov_scale *scale, const float value[3], double rgb[3]);

#endif
