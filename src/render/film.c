/* Film storage and its way to bytes. */
#include "render/film.h"

#include "base/checked.h"
#include "image/png_write.h"

#include <string.h>

bool film_size(uint32_t width, uint32_t height, size_t *bytes, struct error *error) {
    size_t pixels, size;
    if (width == 0 || height == 0 || !checked_mul(width, height, &pixels) || pixels > (size_t)1 << 31)
        return error_set(error, ERROR_SCENE, "a picture of %u x %u pixels is more than gray can hold (2^31 pixels)",
                         width, height);
    if (!checked_mul(pixels, sizeof(struct film_pixel) + 1, &size))
        return error_no_memory(error, "the picture");
    *bytes = size;
    return true;
}

void film_place(struct film *film, void *block, uint32_t width, uint32_t height) {
    film->width = width;
    film->height = height;
    film->pixels = block;
    film->marked = (uint8_t *)(film->pixels + (size_t)width * height);
}

static const float *colour_at(const struct film *film, enum film_view view, size_t at) {
    return view == FILM_FINAL ? film->pixels[at].rgb : film->pixels[at].first;
}

void film_row_toned(const struct film *film, enum film_view view, const struct tone *tone, uint32_t y, uint8_t *line) {
    for (uint32_t x = 0; x < film->width; x++) {
        size_t at = (size_t)y * film->width + x;
        const float *rgb = colour_at(film, view, at);
        for (int c = 0; c < 3; c++)
            line[3 * x + (uint32_t)c] = png_write_byte(tone_apply(tone, (double)rgb[c]));
        if (view == FILM_TARGETS && film->marked[at]) {
            line[3 * x] = 255;
            line[3 * x + 1] = line[3 * x + 2] = 0;
        }
    }
}

void film_row(const struct film *film, enum film_view view, uint32_t y, uint8_t *line) {
    film_row_toned(film, view, &(struct tone){0}, y, line);
}

void film_row_16(const struct film *film, enum film_view view, const struct tone *tone, uint32_t y, uint16_t *line) {
    for (uint32_t x = 0; x < film->width; x++) {
        size_t at = (size_t)y * film->width + x;
        const float *rgb = colour_at(film, view, at);
        bool red = view == FILM_TARGETS && film->marked[at];
        for (int c = 0; c < 3; c++)
            line[3 * x + (uint32_t)c] = tone_word(red ? c == 0 : tone_apply(tone, (double)rgb[c]));
    }
}

void film_row_linear(const struct film *film, enum film_view view, uint32_t y, float *line) {
    for (uint32_t x = 0; x < film->width; x++) {
        size_t at = (size_t)y * film->width + x;
        const float *rgb = colour_at(film, view, at);
        bool red = view == FILM_TARGETS && film->marked[at];
        for (int c = 0; c < 3; c++)
            line[3 * x + (uint32_t)c] = red ? (float)(c == 0) : rgb[c];
    }
}
