/* Images as assets: creation, ownership, decoding, reading. */
#include "image/image.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/exr.h"
#include "image/float_read_internal.h"
#include "image/jpeg_read.h"
#include "image/levels.h"

#include <math.h>
#include <string.h>

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
