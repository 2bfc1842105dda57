/* The mip levels of an image.
 *
 * Idea: a level halves the one below with a box filter. Sizes need not be powers of two: texel i of the smaller level
 * averages exactly the interval of the larger one that it covers, with fractional weights at both ends (as integers, so
 * nothing is rounded before the final division). Colours are averaged weighted by alpha. Invariant: a size divisible by
 * 4 (width) or 3 (height) stays so until a quarter or third is a single texel. So the faces of a sky cross are whole
 * texels in every level, and no level mixes two of them. */
#include "image/levels.h"

#include "base/mem.h"

#include <string.h>

/* Half of a size that is made of `parts` equal parts, if it is; plain half (at least 1) otherwise. */
static uint32_t halve(uint32_t size, uint32_t parts) {
    if (size % parts == 0 && size / parts > 1)
        return size / parts / 2 * parts;
    return size > 1 ? size / 2 : 1;
}

struct image *image_allocate(const char *name, uint32_t width, uint32_t height, int bits, struct error *error) {
    if (width == 0 || height == 0) {
        error_set(error, ERROR_SCENE, "%s: an image needs at least one pixel", name);
        return NULL;
    }
    if (width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE || (uint64_t)width * height > IMAGE_MAX_TEXELS) {
        error_set(error, ERROR_SCENE, "%s: %u x %u pixels are too many (at most %d a side and %d in all)", name, width,
                  height, IMAGE_MAX_SIDE, IMAGE_MAX_TEXELS);
        return NULL;
    }
    struct image *image = mem_alloc_zero(1, sizeof *image);
    if (!image) {
        error_no_memory(error, name);
        return NULL;
    }
    atomic_init(&image->owners, 1);
    image->bits = bits;

    /* Sizes first, then one block for all. Offsets are multiples of 8 bytes because a texel is 4, 8 or 16 bytes long
     * and level 0 is padded. */
    size_t offsets[IMAGE_MAX_LEVELS], total = 0;
    uint32_t w = width, h = height;
    for (;;) {
        int level = image->level_count++;
        size_t texel = bits == 32 ? 16 : level == 0 && bits == 8 ? 4 : 8;
        image->levels[level] = (struct image_level){.width = w, .height = h};
        offsets[level] = total;
        total += ((size_t)w * h * texel + 7) / 8 * 8;
        if (w == 1 && h == 1)
            break;
        w = halve(w, 4), h = halve(h, 3);
    }
    image->block = mem_alloc(total);
    image->memo = mem_alloc_zero(1, sizeof *image->memo);
    size_t length = strlen(name);
    image->name = mem_alloc(length + 1);
    if (!image->block || !image->memo || !image->name) {
        image_release(image);
        error_no_memory(error, name);
        return NULL;
    }
    atomic_init(&image->memo->state, IMAGE_MEMO_UNKNOWN);
    image->block_size = total;
    memcpy(image->name, name, length + 1);
    for (int level = 0; level < image->level_count; level++)
        image->levels[level].texels = (char *)image->block + offsets[level];
    return image;
}

/* Adds a row of the larger level, times its weight, to the sums of the smaller level's row: premultiplied colour and
 * alpha. In units of 1 / (large * small) of the width, large texel j covers [j*small, (j+1)*small) and small texel i
 * covers [i*large, (i+1)*large). Sums stay below 2^62: weights add up to width * height <= 2^28 texels. */
static void add_row(const struct image *image, int level, uint32_t y, uint64_t weight_y, uint32_t small,
                    uint64_t *sums) {
    const struct image_level *from = &image->levels[level];
    uint32_t large = from->width, j = 0;
    size_t row = (size_t)y * large * 4;
    const uint8_t *bytes = level == 0 && image->bits == 8 ? (const uint8_t *)from->texels + row : NULL;
    const uint16_t *words = bytes ? NULL : (const uint16_t *)from->texels + row;
    for (uint32_t i = 0; i < small; i++) {
        uint64_t start = (uint64_t)i * large, end = start + large, r = 0, g = 0, b = 0, a = 0;
        for (;; j++) {
            uint64_t left = (uint64_t)j * small, right = left + small;
            uint64_t weight = (right < end ? right : end) - (left > start ? left : start);
            uint64_t t[4];
            for (int k = 0; k < 4; k++)
                t[k] = bytes ? bytes[(size_t)j * 4 + (size_t)k] * UINT64_C(257) : words[(size_t)j * 4 + (size_t)k];
            uint64_t alpha = t[3] * weight;
            r += t[0] * alpha, g += t[1] * alpha, b += t[2] * alpha, a += alpha;
            if (right >= end) {
                j += right == end; /* a texel that extends beyond the end is also used by the next one */
                break;
            }
        }
        sums[4 * i] += r * weight_y, sums[4 * i + 1] += g * weight_y, sums[4 * i + 2] += b * weight_y;
        sums[4 * i + 3] += a * weight_y;
    }
}

/* Turns the sums of one row, of total weight `area`, into texels. */
static void finish_row(const uint64_t *sums, uint32_t width, uint64_t area, uint16_t *texels) {
    for (size_t i = 0; i < (size_t)width * 4; i += 4) {
        uint64_t alpha = sums[i + 3];
        for (size_t k = 0; k < 3; k++)
            texels[i + k] = (uint16_t)(alpha ? (sums[i + k] + alpha / 2) / alpha : 0);
        texels[i + 3] = (uint16_t)((alpha + area / 2) / area);
    }
}

/* One level from the one below. `sums` has room for four numbers per texel of one row. */
static void build_level(struct image *image, int level, uint64_t *sums) {
    const struct image_level *from = &image->levels[level - 1], *to = &image->levels[level];
    uint64_t area = (uint64_t)from->width * from->height;
    uint32_t j = 0;
    for (uint32_t i = 0; i < to->height; i++) {
        uint64_t start = (uint64_t)i * from->height, end = start + from->height;
        memset(sums, 0, (size_t)to->width * 4 * sizeof *sums);
        for (;; j++) {
            uint64_t top = (uint64_t)j * to->height, bottom = top + to->height;
            uint64_t weight = (bottom < end ? bottom : end) - (top > start ? top : start);
            add_row(image, level - 1, j, weight, to->width, sums);
            if (bottom >= end) {
                j += bottom == end;
                break;
            }
        }
        finish_row(sums, to->width, area, (uint16_t *)to->texels + (size_t)i * to->width * 4);
    }
}

/* The overlap of texel j of `large` with texel i of `small`, in units of 1 / (large * small). */
static double overlap(uint32_t i, uint32_t j, uint32_t small, uint32_t large) {
    uint64_t start = (uint64_t)i * large, end = start + large, left = (uint64_t)j * small, right = left + small;
    return (double)((right < end ? right : end) - (left > start ? left : start));
}

/* The same for floats, without precautions: a double has twice their digits. */
static void build_float_level(struct image *image, int level) {
    const struct image_level *from = &image->levels[level - 1], *to = &image->levels[level];
    for (uint32_t y = 0; y < to->height; y++) {
        uint32_t y0 = (uint32_t)((uint64_t)y * from->height / to->height);
        for (uint32_t x = 0; x < to->width; x++) {
            double sum[4] = {0, 0, 0, 0};
            uint32_t x0 = (uint32_t)((uint64_t)x * from->width / to->width);
            for (uint32_t j = y0; j < from->height && (uint64_t)j * to->height < (y + 1ull) * from->height; j++) {
                for (uint32_t i = x0; i < from->width && (uint64_t)i * to->width < (x + 1ull) * from->width; i++) {
                    const float *t = (const float *)from->texels + ((size_t)j * from->width + i) * 4;
                    double weight = overlap(y, j, to->height, from->height) * overlap(x, i, to->width, from->width);
                    for (int k = 0; k < 4; k++)
                        sum[k] += weight * (double)t[k];
                }
            }
            for (int k = 0; k < 4; k++)
                ((float *)to->texels)[((size_t)y * to->width + x) * 4 + (size_t)k] =
                    (float)(sum[k] / ((double)from->width * from->height));
        }
    }
}

bool image_build_levels(struct image *image, struct error *error) {
    if (image->level_count == 1)
        return true;
    if (image->bits == 32) {
        for (int level = 1; level < image->level_count; level++)
            build_float_level(image, level);
        return true;
    }
    uint64_t *sums = mem_alloc((size_t)image->levels[1].width * 4 * sizeof *sums);
    if (!sums)
        return error_no_memory(error, image->name);
    for (int level = 1; level < image->level_count; level++)
        build_level(image, level, sums);
    mem_free(sums);
    return true;
}

struct image *image_finish(struct image *image, bool ok, struct error *error) {
    if (ok && image_build_levels(image, error))
        return image;
    image_release(image);
    return NULL;
}

void image_fill_empty_alpha(struct image *image) {
    uint8_t *texels = image->levels[0].texels;
    size_t size = (size_t)image->levels[0].width * image->levels[0].height * 4;
    for (size_t i = 3; i < size; i += 4)
        if (texels[i] > 0)
            return;
    for (size_t i = 3; i < size; i += 4)
        texels[i] = 255;
}
