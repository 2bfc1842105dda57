/* See finish.h. Bloom: light above white, blurred by three sizes of Gaussians, each as three box filters (P. Kovesi,
 * "Fast Almost-Gaussian Filtering", DICTA 2010). The filters add integers, so that a part of a picture has the bits of
 * the whole. */
#include "image/finish.h"

#include "base/mem.h"
#include "image/blue_noise_internal.h"
#include "image/fxaa_internal.h"
#include "image/png_write.h"
#include "math/elementary.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* --- bloom --- */

/* Standard deviations of the Gaussians, in heights of the picture. Three boxes of radius r have a standard deviation of
 * about r + 1/2. */
static const double bloom_sizes[] = {0.004, 0.012, 0.04};
enum { BLOOM_SIZES = sizeof bloom_sizes / sizeof *bloom_sizes, BLOOM_BOXES = 3 };
/* Light above this multiple of white counts as this multiple. */
static const double bloom_limit = 16;
static const double bloom_unit = 0x1p24;

static uint32_t bloom_radius(int size, uint32_t full_height) {
    double radius = floor(bloom_sizes[size] * full_height);
    return radius < 1 ? 1 : (uint32_t)radius;
}

/* Sums of boxes of 2 * radius + 1 elements over lines of `count` elements. Elements beyond the ends count as 0. A line
 * has three interleaved channels, and its elements are `step` numbers apart. */
static void box_line(const uint32_t *in, uint32_t *out, uint32_t count, size_t step, uint32_t radius) {
    uint64_t sums[3] = {0, 0, 0}, width = 2 * (uint64_t)radius + 1;
    for (uint32_t i = 0; i < radius && i < count; i++)
        for (size_t c = 0; c < 3; c++)
            sums[c] += in[i * step + c];
    for (uint32_t i = 0; i < count; i++) {
        for (size_t c = 0; c < 3; c++) {
            if (count - i > radius)
                sums[c] += in[(size_t)(i + radius) * step + c];
            out[i * step + c] = (uint32_t)((sums[c] + width / 2) / width);
            if (i >= radius)
                sums[c] -= in[(size_t)(i - radius) * step + c];
        }
    }
}

/* The result is in `a`. */
static void blur(uint32_t *a, uint32_t *b, const struct finish_area *area, uint32_t radius) {
    size_t row = (size_t)3 * area->width;
    for (int box = 0; box < BLOOM_BOXES; box++) {
        for (uint32_t y = 0; y < area->height; y++)
            box_line(a + y * row, b + y * row, area->width, 3, radius);
        for (uint32_t x = 0; x < area->width; x++)
            box_line(b + (size_t)3 * x, a + (size_t)3 * x, area->height, row, radius);
    }
}

/* The light of a pixel above white, in integer units; true if there is any. */
static bool above_white(const float rgb[3], double scale, uint32_t out[3]) {
    double light[3], max = 0;
    for (int c = 0; c < 3; c++) {
        double value = (double)rgb[c] * scale;
        light[c] = value > 0 ? value : 0; /* NaN too */
        max = light[c] > max ? light[c] : max;
    }
    double limited = max < bloom_limit ? max : bloom_limit;
    for (int c = 0; c < 3; c++) {
        /* Infinite light is white. */
        double share = max < HUGE_VAL ? light[c] / max : 1;
        out[c] = max > 1 ? (uint32_t)(share * (limited - 1) * bloom_unit) : 0;
    }
    return max > 1;
}

static bool add_bloom(double strength, double exposure, const struct finish_area *area, float (*rgb)[3],
                      struct error *error) {
    size_t pixels = (size_t)area->width * area->height;
    double scale = el_exp2(exposure), back = strength / (BLOOM_SIZES * bloom_unit * scale);
    uint32_t *a = mem_alloc_zero(3 * pixels, sizeof *a), *b = mem_alloc_zero(3 * pixels, sizeof *b);
    double *sums = mem_alloc_zero(3 * pixels, sizeof *sums);
    bool ok = (a && b && sums) || error_no_memory(error, "a picture with bloom"), any = false;
    for (int size = 0; ok && size < BLOOM_SIZES; size++) {
        for (size_t i = 0; i < pixels; i++)
            any = above_white(rgb[i], scale, a + 3 * i) || any;
        if (!any)
            break;
        blur(a, b, area, bloom_radius(size, area->full_height));
        for (size_t i = 0; i < 3 * pixels; i++)
            sums[i] += a[i];
    }
    for (size_t i = 0; ok && any && i < pixels; i++)
        for (size_t c = 0; c < 3; c++)
            rgb[i][c] = (float)((double)rgb[i][c] + sums[3 * i + c] * back);
    mem_free(a);
    mem_free(b);
    mem_free(sums);
    return ok;
}

/* --- vignette, gray, edges --- */

/* The cos^4 law of a lens whose picture has its corners at 45 degrees. */
static double vignette_factor(double strength, const struct finish_area *area, uint32_t x, uint32_t y) {
    double w = area->full_width, h = area->full_height;
    double dx = 2 * ((double)area->x0 + x + 0.5) - w, dy = 2 * ((double)area->y0 + y + 0.5) - h;
    double squared = 1 + (dx * dx + dy * dy) / (w * w + h * h);
    return 1 - strength * (1 - 1 / (squared * squared));
}

/* Of ITU-R BT.709. */
static double luminance(const float rgb[3]) {
    return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

bool finish_light(const struct finish *finish, double exposure, const struct finish_area *area, float (*rgb)[3],
                  struct error *error) {
    if (finish->bloom > 0 && !add_bloom(finish->bloom, exposure, area, rgb, error))
        return false;
    for (uint32_t y = 0; y < area->height && (finish->vignette > 0 || finish->gray); y++) {
        for (uint32_t x = 0; x < area->width; x++) {
            float *pixel = rgb[(size_t)y * area->width + x];
            double factor = finish->vignette > 0 ? vignette_factor(finish->vignette, area, x, y) : 1;
            double gray = luminance(pixel);
            for (int c = 0; c < 3; c++)
                pixel[c] = (float)((finish->gray ? gray : (double)pixel[c]) * factor);
        }
    }
    return true;
}

/* I. Sobel's operator: the gradient of the luminance; a step from 0 to 1 along an axis gives 1. Pixels beyond the
 * border have the values of the border. */
static void sobel(const struct finish_area *area, const float (*in)[3], float (*out)[3]) {
    static const int weights[3] = {1, 2, 1};
    for (uint32_t y = 0; y < area->height; y++) {
        for (uint32_t x = 0; x < area->width; x++) {
            uint32_t columns[3] = {x > 0 ? x - 1 : 0, x, x + 1 < area->width ? x + 1 : x};
            uint32_t rows[3] = {y > 0 ? y - 1 : 0, y, y + 1 < area->height ? y + 1 : y};
            double gx = 0, gy = 0;
            for (int i = 0; i < 3; i++) {
                const float(*middle)[3] = in + (size_t)rows[i] * area->width;
                gx += weights[i] * (luminance(middle[columns[2]]) - luminance(middle[columns[0]]));
                gy += weights[i] * (luminance(in[(size_t)rows[2] * area->width + columns[i]]) -
                                    luminance(in[(size_t)rows[0] * area->width + columns[i]]));
            }
            double edge = sqrt(gx * gx + gy * gy) / 4;
            for (int c = 0; c < 3; c++)
                out[(size_t)y * area->width + x][c] = (float)(edge < 1 ? edge : 1);
        }
    }
}

bool finish_display(const struct finish *finish, const struct finish_area *area, float (*rgb)[3], struct error *error) {
    size_t size = (size_t)area->width * area->height * sizeof *rgb;
    float(*copy)[3] = mem_alloc(size);
    if (!copy)
        return error_no_memory(error, "a picture that is finished");
    if (finish->edges) {
        memcpy(copy, rgb, size);
        sobel(area, (const float(*)[3])copy, rgb);
    }
    if (finish->fxaa) {
        memcpy(copy, rgb, size);
        fxaa_apply(area, (const float(*)[3])copy, rgb);
    }
    mem_free(copy);
    return true;
}

uint32_t finish_rim(const struct finish *finish, uint32_t full_height) {
    uint32_t bloom = BLOOM_BOXES * bloom_radius(BLOOM_SIZES - 1, full_height);
    return (finish->bloom > 0 ? bloom : 0) + finish->edges + (finish->fxaa ? FXAA_RIM : 0);
}

/* --- dithering --- */

/* For numbers 0..63: interleaves the bits of x ^ y and of y, lowest bits first. */
static uint32_t bayer(uint32_t x, uint32_t y) {
    uint32_t rank = 0;
    for (int bit = 0; bit < 3; bit++)
        rank = rank << 2 | ((x ^ y) >> bit & 1) << 1 | (y >> bit & 1);
    return rank;
}

uint8_t dither_byte(enum dither dither, uint32_t x, uint32_t y, double c) {
    double threshold = 0.5;
    switch (dither) {
    case DITHER_NONE:
        return png_write_byte(c);
    case DITHER_ORDERED:
        threshold = (bayer(x & 7, y & 7) + 0.5) / 64;
        break;
    case DITHER_BLUE:
        threshold = (blue_noise[y % BLUE_NOISE_SIDE * BLUE_NOISE_SIDE + x % BLUE_NOISE_SIDE] + 0.5) /
                    (BLUE_NOISE_SIDE * BLUE_NOISE_SIDE);
        break;
    }
    if (!(c > 0))
        return 0;
    return (uint8_t)(c < 1 ? 255 * c + threshold : 255);
}
