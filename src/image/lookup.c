/* Filtered lookups.
 *
 * Texel (i, j) has its centre at ((i + .5) / width, (j + .5) / height), so u = 0 is the left edge of the first texel.
 * A footprint that is wider in one direction takes several samples along that direction, each from the level that fits
 * a piece of it (the axis-aligned case of Feline: McCormack, Perry, Farkas, Jouppi, "Feline: fast elliptical lines for
 * anisotropic texture mapping", SIGGRAPH 1999): a floor seen at a grazing angle stays sharp across, and the poles of a
 * sphere do not blur. Nothing outside the image is ever read, whatever u and v are. */
#include "image/levels.h"

#include <math.h>

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
    double mantissa = frexp(texels, &exponent); /* in [.5, 1) */
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
    double wide = fmax(texels_u, texels_v), narrow = fmin(texels_u, texels_v);
    if (!(wide > 1))
        return trilinear(view, 0, at.u, at.v);
    double ratio = wide / fmax(narrow, 1);
    int taps = ratio < MAX_TAPS ? (int)ceil(ratio) : MAX_TAPS;
    double level = image_level_for(wide / taps, view->last);
    double step_u = texels_u >= texels_v ? fmin(at.width_u, 1) / taps : 0;
    double step_v = texels_u >= texels_v ? 0 : fmin(at.width_v, 1) / taps;
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
