/* Images as assets: creation, mip levels, ownership.
 *
 * Idea: a level halves the one below with a box filter. Sizes need not be powers of two: texel i of the smaller level
 * averages exactly the interval of the larger one that it covers, with fractional weights at both ends (as integers, so
 * nothing is rounded before the final division). Colours are averaged weighted by alpha. Invariant: a size divisible by
 * 4 (width) or 3 (height) stays so until a quarter or third is a single texel. So the faces of a sky cross are whole
 * texels in every level, and no level mixes two of them. */
#include "base/file.h"
#include "image/exr.h"
#include "image/float_read_internal.h"
#include "image/jpeg_read.h"
#include "image/levels.h"
#include "image/tone.h"
#include "math/elementary.h"

#include "base/mem.h"
#include "image/image.h"

#include <math.h>
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

struct image *image_create(const char *name, uint32_t width, uint32_t height, int bits, const void *rgba,
                           struct error *error) {
    struct image *image = image_allocate(name, width, height, bits, error);
    if (!image)
        return NULL;
    memcpy(image->levels[0].texels, rgba, (size_t)width * height * (bits == 32 ? 16 : bits == 8 ? 4 : 8));
    if (!image_build_levels(image, error)) {
        image_release(image);
        return NULL;
    }
    return image;
}

static uint16_t decoded(struct transfer_function transfer, uint32_t units) {
    double light = transfer_decode(transfer, units / 65535.0);
    return (uint16_t)(65535 * light + 0.5);
}

static struct image *decode(const struct image *image, struct transfer_function transfer, struct error *error) {
    const struct image_level *from = &image->levels[0];
    size_t count = (size_t)from->width * from->height * 4;
    struct image *out = image_allocate(image->name, from->width, from->height, 16, error);
    if (!out)
        return NULL;
    const uint8_t *bytes = from->texels;
    const uint16_t *words = from->texels;
    uint16_t *texels = out->levels[0].texels, of_byte[256];
    for (uint32_t i = 0; i < 256; i++)
        of_byte[i] = decoded(transfer, i * 257);
    for (size_t i = 0; i < count; i++) {
        bool alpha = i % 4 == 3;
        if (image->bits == 8)
            texels[i] = alpha ? (uint16_t)(bytes[i] * 257) : of_byte[bytes[i]];
        else
            texels[i] = alpha ? words[i] : decoded(transfer, words[i]);
    }
    out->transfer = transfer;
    if (image_build_levels(out, error))
        return out;
    image_release(out);
    return NULL;
}

struct image *image_decode(struct image *image, struct transfer_function transfer, struct error *error) {
    if (image->bits == 32 || transfer_is_linear(transfer))
        return image;
    for (struct image *known = image->decoded; known; known = known->decoded)
        if (transfer_same(known->transfer, transfer))
            return known;
    struct image *out = decode(image, transfer, error);
    if (!out)
        return NULL;
    out->decoded = image->decoded;
    return image->decoded = out;
}

struct transfer_function image_transfer(const struct image *image) {
    return image->transfer;
}

struct transfer_function image_colour_transfer(const struct image *image) {
    if (image->transfer.kind != TRANSFER_UNSTATED || image->bits != 8)
        return image->transfer;
    return (struct transfer_function){TRANSFER_SRGB, 0};
}

const char *image_colours(const struct image *image) {
    return image->colours;
}

struct image *image_share(struct image *image) {
    atomic_fetch_add_explicit(&image->owners, 1, memory_order_relaxed);
    return image;
}

void image_release(struct image *image) {
    if (!image || atomic_fetch_sub_explicit(&image->owners, 1, memory_order_acq_rel) != 1)
        return;
    image_release(image->decoded);
    mem_free(image->ranges);
    mem_free(image->colours);
    mem_free(image->memo);
    mem_free(image->block);
    mem_free(image->name);
    mem_free(image);
}

uint32_t image_width(const struct image *image) {
    return image->levels[0].width;
}

uint32_t image_height(const struct image *image) {
    return image->levels[0].height;
}

int image_bits(const struct image *image) {
    return image->bits;
}

size_t image_memory(const struct image *image) {
    size_t decoded_memory = image->decoded ? image_memory(image->decoded) : 0;
    return sizeof *image + sizeof *image->memo + image->block_size + strlen(image->name) + 1 + decoded_memory;
}

const char *image_name(const struct image *image) {
    return image->name;
}

double image_brightest(const struct image *image) {
    if (image->bits != 32)
        return 1;
    struct rgba largest = image_largest(image);
    return fmax(fmax(largest.r, largest.g), largest.b);
}

struct rgba image_texel(const struct image *image, uint32_t x, uint32_t y) {
    size_t at = ((size_t)y * image->levels[0].width + x) * 4;
    if (image->bits == 8) {
        const uint8_t *t = (const uint8_t *)image->levels[0].texels + at;
        return (struct rgba){t[0] / 255.0, t[1] / 255.0, t[2] / 255.0, t[3] / 255.0};
    }
    if (image->bits == 32) {
        const float *t = (const float *)image->levels[0].texels + at;
        return (struct rgba){(double)t[0], (double)t[1], (double)t[2], (double)t[3]};
    }
    const uint16_t *t = (const uint16_t *)image->levels[0].texels + at;
    return (struct rgba){t[0] / 65535.0, t[1] / 65535.0, t[2] / 65535.0, t[3] / 65535.0};
}

static struct rgba find_largest(const struct image *image) {
    struct rgba max = {0, 0, 0, 1};
    for (uint32_t y = 0; y < image->levels[0].height; y++) {
        for (uint32_t x = 0; x < image->levels[0].width; x++) {
            struct rgba t = image_texel(image, x, y);
            max.r = t.r > max.r ? t.r : max.r;
            max.g = t.g > max.g ? t.g : max.g;
            max.b = t.b > max.b ? t.b : max.b;
            max.a = t.a < max.a ? t.a : max.a;
        }
    }
    return max;
}

struct rgba image_largest(const struct image *image) {
    struct image_memo *memo = image->memo;
    int unknown = IMAGE_MEMO_UNKNOWN;
    if (atomic_load_explicit(&memo->state, memory_order_acquire) == IMAGE_MEMO_KNOWN)
        return memo->largest;
    struct rgba largest = find_largest(image);
    if (atomic_compare_exchange_strong(&memo->state, &unknown, IMAGE_MEMO_SETTING)) {
        memo->largest = largest;
        atomic_store_explicit(&memo->state, IMAGE_MEMO_KNOWN, memory_order_release);
    }
    return largest;
}

/* The choice of a reader. For unknown formats the PNG reader makes the error; it names the probable format. */

#define FILE_LIMIT ((size_t)1 << 32)

struct image *image_parse(const char *path, const uint8_t *data, size_t size, struct error *error) {
    if (size >= 3 && memcmp(data, "\xff\xd8\xff", 3) == 0)
        return image_parse_jpeg(path, data, size, error);
    if (hdr_is(data, size))
        return image_parse_hdr(path, data, size, error);
    if (exr_is(data, size))
        return image_parse_exr(path, data, size, error);
    if (pfm_is(data, size))
        return image_parse_pfm(path, data, size, error);
    return image_parse_png(path, data, size, error);
}

struct image *image_read(const char *path, struct error *error) {
    struct file_bytes file;
    uint64_t refusals = mem_refusals();
    if (!file_map(path, FILE_LIMIT, &file, error))
        return NULL;
    struct image *image = image_parse(path, file.data, file.size, error);
    file_unmap(&file);
    if (!image)
        (void)error_of_file(error, path, refusals);
    return image;
}

/* Curves, channel by channel: Reinhard, Stark, Shirley, Ferwerda, "Photographic Tone Reproduction for Digital Images",
 * SIGGRAPH 2002 (equation 3), and the fit of Narkowicz, "ACES Filmic Tone Mapping Curve", 2015. */

enum { TONE_STEPS = 128 }; /* of a doubling */

double tone_table_light(int entry) {
    int doubling = entry < TONE_STEPS ? 0 : entry / TONE_STEPS - 1;
    return ldexp(entry - doubling * TONE_STEPS, doubling - 22);
}

double tone_table_slope(const struct tone_table *table) {
    double max = 0;
    for (int i = 1; i < TONE_ENTRIES; i++) {
        double rise = fabs((double)table->values[i] - (double)table->values[i - 1]);
        max = fmax(max, rise / (tone_table_light(i) - tone_table_light(i - 1)));
    }
    return max;
}

static double table_value(const struct tone_table *table, double c) {
    int exponent;
    if (!(c > 0))
        return c == c ? (double)table->values[0] : c;
    if (c >= tone_table_light(TONE_ENTRIES - 1))
        return (double)table->values[TONE_ENTRIES - 1];
    c = ldexp(c, 22);
    (void)frexp(c, &exponent);
    int doubling = exponent > 8 ? exponent - 8 : 0; /* c / 2^doubling is below 256, and from 128 on where it is not 0 */
    c = ldexp(c, -doubling);
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
    return c < 1 ? (uint16_t)floor(65535 * c + 0.5) : 65535;
}
