/* Images as assets: creation, ownership, decoding, reading. */
#include "image/image.h"

#include "image/image_function.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/bmp_read_internal.h"
#include "image/exr.h"
#include "image/float_read_internal.h"
#include "image/jpeg_read.h"
#include "image/levels.h"
#include "image/png_read_internal.h"
#include "image/tga_read_internal.h"
#include "image/webp_read_internal.h"
#include "math/portable.h"

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
    return math_max(math_max(largest.r, largest.g), largest.b);
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

/* The choice of a reader. For unknown formats the PNG reader makes the error. */

#define FILE_LIMIT ((size_t)1 << 32)

/* The name of a format that gray does not read, or NULL. */
static const char *unread_kind(const uint8_t *data, size_t size) {
    static const struct {
        const char *kind, *bytes;
        size_t offset, length;
    } kinds[] = {
        {"GIF", "GIF8", 0, 4},
        {"TIFF", "II*\0", 0, 4},
        {"TIFF", "MM\0*", 0, 4},
        {"TIFF", "II+\0", 0, 4},
        {"TIFF", "MM\0+", 0, 4},
        {"Photoshop (PSD)", "8BPS", 0, 4},
        {"AVIF", "ftypavif", 4, 8},
        {"AVIF", "ftypavis", 4, 8},
        {"HEIC", "ftyphei", 4, 7},
        {"HEIC", "ftypmif1", 4, 8},
        {"KTX2", "\xabKTX 20", 0, 7},
        {"KTX", "\xabKTX 11", 0, 7},
        {"DDS", "DDS ", 0, 4},
        {"JPEG 2000", "\0\0\0\x0cjP  ", 0, 8},
        {"JPEG XL", "\0\0\0\x0cJXL ", 0, 8},
        {"JPEG XL", "\xff\x0a", 0, 2},
        {"Basis Universal", "sB", 0, 2},
        {"SVG or XML", "<", 0, 1},
        {"PNM", "P2", 0, 2},
        {"PNM", "P3", 0, 2},
        {"PNM", "P5", 0, 2},
        {"PNM", "P6", 0, 2},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (size >= kinds[i].offset + kinds[i].length &&
            memcmp(data + kinds[i].offset, kinds[i].bytes, kinds[i].length) == 0)
            return kinds[i].kind;
    return NULL;
}

struct image *image_parse(const char *path, const uint8_t *data, size_t size, struct error *error) {
    if (size >= 3 && memcmp(data, "\xff\xd8\xff", 3) == 0)
        return image_parse_jpeg(path, data, size, error);
    if (hdr_is(data, size))
        return image_parse_hdr(path, data, size, error);
    if (exr_is(data, size))
        return image_parse_exr(path, data, size, error);
    if (pfm_is(data, size))
        return image_parse_pfm(path, data, size, error);
    if (webp_is(data, size))
        return image_parse_webp(path, data, size, error);
    if (tga_is(path, data, size))
        return image_parse_tga(path, data, size, error);
    if (bmp_is(data, size))
        return image_parse_bmp(path, data, size, error);
    const char *kind = unread_kind(data, size);
    if (kind) {
        error_set(error, ERROR_SCENE,
                  "%s: this is a picture of the kind %s, which gray does not read: convert it to PNG", path, kind);
        return NULL;
    }
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

/* --- filtered lookups --- */

/* Filtered lookups.
 *
 * Texel (i, j) has its centre at ((i + .5) / width, (j + .5) / height), so u = 0 is the left edge of the first texel.
 * A footprint that is wider in one direction takes several samples along that direction, each from the level that fits
 * a piece of it (the axis-aligned case of Feline: McCormack, Perry, Farkas, Jouppi, "Feline: fast elliptical lines for
 * anisotropic texture mapping", SIGGRAPH 1999): a floor seen at a grazing angle stays sharp across, and the poles of a
 * sphere do not blur. Nothing outside the image is ever read, whatever u and v are. */

enum { MAX_TAPS = 8 };

/* The input of a lookup: the levels up to `last`. */
struct view {
    const struct image *image;
    int last;
    enum image_wrap wrap_u, wrap_v;
};

double image_level_for(double texels, int last) {
    if (!(texels > 1))
        return 0;
    if (!(texels < 0x1p40))
        return last;
    int exponent;
    double mantissa = math_frexp(texels, &exponent); /* in [.5, 1) */
    double level = (exponent - 1) + (2 * mantissa - 1);
    return level < last ? level : last;
}

/* u folded into [0, 1]. NaN gives 0. */
static double fold(double u, enum image_wrap wrap) {
    switch (wrap) {
    case IMAGE_CLAMP:
        break;
    case IMAGE_REPEAT:
        u -= floor(u);
        break;
    case IMAGE_MIRROR:
        u -= 2 * floor(u / 2);
        u = u > 1 ? 2 - u : u;
        break;
    }
    return u > 0 ? (u < 1 ? u : 1) : 0;
}

/* The texel at u in [0, 1]; u = 1 is the first one again if the image repeats. */
static uint32_t nearest(double u, uint32_t size, enum image_wrap wrap) {
    uint32_t i = (uint32_t)(u * size);
    return i < size ? i : wrap == IMAGE_REPEAT ? 0 : size - 1;
}

/* The two texels whose centres enclose u in [0, 1], and the weight of the second. */
static double neighbours(double u, uint32_t size, enum image_wrap wrap, uint32_t *first, uint32_t *second) {
    double x = u * size - 0.5, floor_x = floor(x);
    int64_t i = (int64_t)floor_x, n = size;
    *first = (uint32_t)(i >= 0 ? i : wrap == IMAGE_REPEAT ? n - 1 : 0);
    *second = (uint32_t)(i + 1 < n ? i + 1 : wrap == IMAGE_REPEAT ? 0 : n - 1);
    return x - floor_x;
}

static struct rgba bilinear(const struct view *view, int level, double u, double v) {
    const struct image_level *l = &view->image->levels[level];
    uint32_t x0, x1, y0, y1;
    double fx = neighbours(u, l->width, view->wrap_u, &x0, &x1), fy = neighbours(v, l->height, view->wrap_v, &y0, &y1);
    struct rgba top =
        image_mix(image_level_texel(view->image, level, x0, y0), image_level_texel(view->image, level, x1, y0), fx);
    struct rgba bottom =
        image_mix(image_level_texel(view->image, level, x0, y1), image_level_texel(view->image, level, x1, y1), fx);
    return image_mix(top, bottom, fy);
}

static struct rgba trilinear(const struct view *view, double level, double u, double v) {
    int lower = (int)level;
    u = fold(u, view->wrap_u), v = fold(v, view->wrap_v);
    struct rgba fine = bilinear(view, lower, u, v);
    if (lower >= view->last || level == lower)
        return fine;
    return image_mix(fine, bilinear(view, lower + 1, u, v), level - lower);
}

/* Several trilinear samples along the wider side of the footprint, each as wide as its share. */
static struct rgba mipmapped(const struct view *view, struct image_point at) {
    double texels_u = at.width_u * view->image->levels[0].width, texels_v = at.width_v * view->image->levels[0].height;
    double wide = math_max(texels_u, texels_v), narrow = math_min(texels_u, texels_v);
    if (!(wide > 1))
        return trilinear(view, 0, at.u, at.v);
    double ratio = wide / math_max(narrow, 1);
    int taps = ratio < MAX_TAPS ? (int)ceil(ratio) : MAX_TAPS;
    double level = image_level_for(wide / taps, view->last);
    double step_u = texels_u >= texels_v ? math_min(at.width_u, 1) / taps : 0;
    double step_v = texels_u >= texels_v ? 0 : math_min(at.width_v, 1) / taps;
    struct rgba sum = {0, 0, 0, 0};
    for (int i = 0; i < taps; i++) {
        double step = i - 0.5 * (taps - 1);
        struct rgba c = trilinear(view, level, at.u + step * step_u, at.v + step * step_v);
        sum.r += c.r, sum.g += c.g, sum.b += c.b, sum.a += c.a;
    }
    return (struct rgba){sum.r / taps, sum.g / taps, sum.b / taps, sum.a / taps};
}

static struct rgba lookup(const struct view *view, struct image_point at, enum image_filter filter) {
    switch (filter) {
    case IMAGE_NEAREST: {
        const struct image_level *l = &view->image->levels[0];
        uint32_t x = nearest(fold(at.u, view->wrap_u), l->width, view->wrap_u);
        uint32_t y = nearest(fold(at.v, view->wrap_v), l->height, view->wrap_v);
        return image_from_units(image_level_texel(view->image, 0, x, y));
    }
    case IMAGE_BILINEAR:
        return image_from_units(trilinear(view, 0, at.u, at.v));
    case IMAGE_MIPMAP:
        return image_from_units(mipmapped(view, at));
    }
    return (struct rgba){0, 0, 0, 0};
}

struct rgba image_lookup(const struct image *image, struct image_point at, struct image_sampling how) {
    int last = how.filter == IMAGE_MIPMAP ? image->level_count - 1 : 0;
    const struct view view = {image, last, how.wrap_u, how.wrap_v};
    return lookup(&view, at, how.filter);
}

/* The sign with which u is folded; 0 where it is clamped. */
static double fold_slope(double u, enum image_wrap wrap) {
    switch (wrap) {
    case IMAGE_CLAMP:
        return u >= 0 && u <= 1 ? 1 : 0;
    case IMAGE_REPEAT:
        return 1;
    case IMAGE_MIRROR:
        return u - 2 * floor(u / 2) > 1 ? -1 : 1;
    }
    return 0;
}

static struct rgba difference(struct rgba a, struct rgba b, double factor) {
    return image_from_units(
        (struct rgba){(b.r - a.r) * factor, (b.g - a.g) * factor, (b.b - a.b) * factor, (b.a - a.a) * factor});
}

void image_lookup_slopes(const struct image *image, struct image_point at, struct image_sampling how, struct rgba *by_u,
                         struct rgba *by_v) {
    const struct image_level *l = &image->levels[0];
    uint32_t x0, x1, y0, y1;
    *by_u = *by_v = (struct rgba){0, 0, 0, 0};
    if (how.filter == IMAGE_NEAREST || !isfinite(at.u) || !isfinite(at.v))
        return;
    double fx = neighbours(fold(at.u, how.wrap_u), l->width, how.wrap_u, &x0, &x1);
    double fy = neighbours(fold(at.v, how.wrap_v), l->height, how.wrap_v, &y0, &y1);
    struct rgba p = image_level_texel(image, 0, x0, y0), q = image_level_texel(image, 0, x1, y0);
    struct rgba r = image_level_texel(image, 0, x0, y1), s = image_level_texel(image, 0, x1, y1);
    *by_u = difference(image_mix(p, r, fy), image_mix(q, s, fy), l->width * fold_slope(at.u, how.wrap_u));
    *by_v = difference(image_mix(p, q, fx), image_mix(r, s, fx), l->height * fold_slope(at.v, how.wrap_v));
}

static void bundle_levels(struct bundle *bundle, void *levels) {
    struct image *image = levels;
    image->block = NULL;
    image->name = image->colours = NULL;
    image->decoded = NULL;
    for (int i = 0; i < image->level_count; i++) {
        struct image_level *level = &image->levels[i];
        const size_t texel = image->bits == 32 ? 16 : i == 0 && image->bits == 8 ? 4 : 8;
        bundle_point(bundle, &level->texels, (size_t)level->width * level->height, texel, NULL);
    }
    BUNDLE(bundle, image->memo, 1, NULL);
    image_ranges_bundle(bundle, &image->ranges);
}

void image_bundle(struct bundle *bundle, struct image **image) {
    BUNDLE(bundle, *image, 1, bundle_levels);
}
