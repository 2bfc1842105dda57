/* Every value of a lookup is a mean of texels with weights between 0 and 1. So it is between the minimum and the
 * maximum of the texels that the lookups of a box can read. These texels are a rectangle, or whole rows and columns if
 * the box crosses an edge at which the image repeats. gray reads a small rectangle directly, and a larger one from the
 * level of the pyramid at which it covers a few blocks. */
#include "image/image_function.h"

#include "base/mem.h"
#include "image/levels.h"

#include <float.h>
#include <math.h>

/* BLOCK_SHIFT: the finest blocks have 8 x 8 texels. SPAN: blocks or texels on a side that a query reads at most. */
enum { BLOCK_SHIFT = 3, SPAN = 8, MAX_LEVELS = 13 };

struct value_range {
    double low[TEXEL_CHANNELS], high[TEXEL_CHANNELS]; /* as image_level_texel gives them */
};

struct range_level {
    uint32_t width, height; /* in blocks */
    struct value_range *blocks;
};

struct image_ranges {
    int level_count;
    bool has_nan; /* some texel is NaN */
    struct range_level levels[MAX_LEVELS];
};

/* --- the pyramid --- */

static struct value_range nothing(void) {
    struct value_range out;
    for (int k = 0; k < TEXEL_CHANNELS; k++) {
        out.low[k] = (double)INFINITY;
        out.high[k] = -(double)INFINITY;
    }
    return out;
}

static void add_value(struct value_range *range, int channel, double low, double high) {
    range->low[channel] = low < range->low[channel] ? low : range->low[channel];
    range->high[channel] = high > range->high[channel] ? high : range->high[channel];
}

static double channel_of(struct rgba texel, int channel) {
    return channel == 0 ? texel.r : channel == 1 ? texel.g : channel == 2 ? texel.b : texel.a;
}

static void add_texels(const struct image *image, struct image_ranges *ranges) {
    const struct image_level *texels = &image->levels[0];
    const struct range_level *level = &ranges->levels[0];
    for (uint32_t y = 0; y < texels->height; y++)
        for (uint32_t x = 0; x < texels->width; x++) {
            struct rgba texel = image_level_texel(image, 0, x, y);
            struct value_range *block = &level->blocks[(size_t)(y >> BLOCK_SHIFT) * level->width + (x >> BLOCK_SHIFT)];
            for (int k = 0; k < TEXEL_CHANNELS; k++) {
                double value = channel_of(texel, k);
                add_value(block, k, value, value);
                ranges->has_nan = ranges->has_nan || isnan(value);
            }
        }
}

static void add_blocks(const struct range_level *from, const struct range_level *to) {
    for (uint32_t y = 0; y < from->height; y++)
        for (uint32_t x = 0; x < from->width; x++) {
            const struct value_range *block = &from->blocks[(size_t)y * from->width + x];
            for (int k = 0; k < TEXEL_CHANNELS; k++)
                add_value(&to->blocks[(size_t)(y / 2) * to->width + x / 2], k, block->low[k], block->high[k]);
        }
}

/* The levels and their blocks are in one block of memory. */
bool image_make_ranges(struct image *image, struct error *error) {
    if (image->ranges)
        return true;
    struct image_ranges shape = {.level_count = 0};
    size_t count = 0;
    uint32_t side = 1U << BLOCK_SHIFT, width = (image->levels[0].width + side - 1) / side,
             height = (image->levels[0].height + side - 1) / side;
    /* A pyramid over blocks, up to a single one, in one piece of memory. */
    for (;; width = (width + 1) / 2, height = (height + 1) / 2) {
        shape.levels[shape.level_count++] = (struct range_level){width, height, NULL};
        count += (size_t)width * height;
        if (width == 1 && height == 1)
            break;
    }
    struct image_ranges *ranges = mem_alloc(sizeof *ranges + count * sizeof(struct value_range));
    if (!ranges)
        return error_no_memory(error, image->name);
    *ranges = shape;
    struct value_range *blocks = (struct value_range *)(void *)(ranges + 1);
    for (size_t i = 0; i < count; i++)
        blocks[i] = nothing();
    for (int k = 0; k < ranges->level_count; k++) {
        ranges->levels[k].blocks = blocks;
        blocks += (size_t)ranges->levels[k].width * ranges->levels[k].height;
        /* The lowest level from texels, the others from the one below. */
        if (k == 0)
            add_texels(image, ranges);
        else
            add_blocks(&ranges->levels[k - 1], &ranges->levels[k]);
    }
    image->ranges = ranges;
    return true;
}

/* --- values --- */

static double along(const struct image_function *function, int axis, double x) {
    double at = function->scale[axis] * x + function->offset[axis];
    return (axis == 0 && function->flip_u) || axis == 1 ? 1 - at : at;
}

static double factor(const struct image_function *function, int channel) {
    return channel < 3 ? function->tint[channel] : 1;
}

double image_function_value(const struct image_function *function, double u, double v, int channel) {
    const struct image_point at = {along(function, 0, u), along(function, 1, v), 0, 0};
    return channel_of(image_lookup(function->image, at, function->sampling), channel) * factor(function, channel);
}

void image_function_slopes(const struct image_function *function, double u, double v, int channel, double slopes[2]) {
    const struct image_point at = {along(function, 0, u), along(function, 1, v), 0, 0};
    struct rgba by_u, by_v;
    image_lookup_slopes(function->image, at, function->sampling, &by_u, &by_v);
    double tint = factor(function, channel);
    slopes[0] = channel_of(by_u, channel) * tint * (function->flip_u ? -function->scale[0] : function->scale[0]);
    slopes[1] = channel_of(by_v, channel) * tint * -function->scale[1];
}

/* --- bounds --- */

struct texel_span {
    uint32_t first, last;
};

/* The texels of an axis that lookups between low and high may read. */
static struct texel_span texels_in(double low, double high, uint32_t size, struct image_sampling how, int axis) {
    const struct texel_span all = {0, size - 1};
    const double slack = 1e-3; /* larger than the rounding errors of wrapping */
    enum image_wrap wrap = axis == 0 ? how.wrap_u : how.wrap_v;
    if (!(low >= -0x1p20 && high <= 0x1p20))
        return all;
    if (wrap != IMAGE_CLAMP) {
        double cell = floor(low);
        if (cell != floor(high))
            return all;
        bool is_mirrored = wrap == IMAGE_MIRROR && cell - 2 * floor(cell / 2) != 0;
        double a = low - cell, b = high - cell;
        low = is_mirrored ? 1 - b : a;
        high = is_mirrored ? 1 - a : b;
    }
    bool is_nearest = how.filter == IMAGE_NEAREST;
    double start = is_nearest ? 0 : 0.5;
    double first = floor(math_max(low, 0) * size - start - slack);
    double last = floor(math_min(high, 1) * size - start + slack) + (is_nearest ? 0 : 1);
    if (wrap == IMAGE_REPEAT && (first < 0 || last >= size))
        return all;
    first = math_min(math_max(first, 0), size - 1);
    last = math_min(math_max(last, first), size - 1);
    return (struct texel_span){(uint32_t)first, (uint32_t)last};
}

static struct value_range range_of(const struct image *image, int channel, struct texel_span x, struct texel_span y) {
    struct value_range out = nothing();
    if (x.last - x.first < SPAN && y.last - y.first < SPAN) {
        for (uint32_t j = y.first; j <= y.last; j++)
            for (uint32_t i = x.first; i <= x.last; i++) {
                double value = channel_of(image_level_texel(image, 0, i, j), channel);
                add_value(&out, channel, value, value);
            }
        return out;
    }
    int k = 0, shift = BLOCK_SHIFT;
    while ((x.last >> shift) - (x.first >> shift) >= SPAN || (y.last >> shift) - (y.first >> shift) >= SPAN) {
        k++;
        shift++;
    }
    const struct range_level *level = &image->ranges->levels[k];
    for (uint32_t j = y.first >> shift; j <= y.last >> shift; j++)
        for (uint32_t i = x.first >> shift; i <= x.last >> shift; i++) {
            const struct value_range *block = &level->blocks[(size_t)j * level->width + i];
            add_value(&out, channel, block->low[channel], block->high[channel]);
        }
    return out;
}

static struct texel_span texels_of(const struct image_function *function, int axis, struct image_interval x) {
    const struct image_level *level = &function->image->levels[0];
    uint32_t size = axis == 0 ? level->width : level->height;
    double a = along(function, axis, x.low), b = along(function, axis, x.high);
    if (x.may_be_nan || isnan(a) || isnan(b))
        return (struct texel_span){0, size - 1};
    return texels_in(math_min(a, b), math_max(a, b), size, function->sampling, axis);
}

/* Interpolation has errors of a few units in the last place of its texels. */
struct image_interval image_function_bounds(const struct image_function *function, struct image_interval u,
                                            struct image_interval v, int channel) {
    const struct image_interval any = {-(double)INFINITY, (double)INFINITY, true};
    const struct image *image = function->image;
    if (!image->ranges || image->ranges->has_nan)
        return any;
    struct value_range range = range_of(image, channel, texels_of(function, 0, u), texels_of(function, 1, v));
    double size = math_max(fabs(range.low[channel]), fabs(range.high[channel]));
    double error = function->sampling.filter == IMAGE_NEAREST ? 0 : 16 * DBL_EPSILON * size;
    struct rgba low = image_from_units((struct rgba){.a = range.low[channel] - error});
    struct rgba high = image_from_units((struct rgba){.a = range.high[channel] + error});
    double p = low.a * factor(function, channel), q = high.a * factor(function, channel);
    if (!isfinite(p) || !isfinite(q))
        return any;
    return (struct image_interval){math_min(p, q), math_max(p, q), false};
}

static void bundle_blocks(struct bundle *bundle, void *image_ranges) {
    struct image_ranges *ranges = image_ranges;
    for (int i = 0; i < ranges->level_count; i++) {
        struct range_level *level = &ranges->levels[i];
        BUNDLE(bundle, level->blocks, (size_t)level->width * level->height, NULL);
    }
}

void image_ranges_bundle(struct bundle *bundle, struct image_ranges **ranges) {
    BUNDLE(bundle, *ranges, 1, bundle_blocks);
}
