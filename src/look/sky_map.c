/* An image of the whole sphere, longitude along its rows and latitude down its columns. A texel left of the first is
 * the last of its row; a texel above the first row is the one of the first row on the other side of the pole. So a way
 * over the pole or round the back meets no seam. The mip level follows the rows, whose width on the sphere is the same
 * everywhere. */
#include "image/levels.h"
#include "look/sky_parts.h"
#include "math/elementary.h"

static struct rgba texel(const struct image *image, int level, int64_t x, int64_t y) {
    int64_t w = image->levels[level].width, h = image->levels[level].height;
    if (y < 0 || y >= h) {
        y = y < 0 ? -1 - y : 2 * h - 1 - y;
        x += w / 2;
    }
    x %= w;
    return image_level_texel(image, level, (uint32_t)(x < 0 ? x + w : x), (uint32_t)(y < 0 ? 0 : y >= h ? h - 1 : y));
}

static struct rgba bilinear(const struct image *image, int level, double u, double v) {
    double x = u * image->levels[level].width - 0.5, y = v * image->levels[level].height - 0.5;
    int64_t i = (int64_t)floor(x), j = (int64_t)floor(y);
    struct rgba top = image_mix(texel(image, level, i, j), texel(image, level, i + 1, j), x - floor(x));
    struct rgba bottom = image_mix(texel(image, level, i, j + 1), texel(image, level, i + 1, j + 1), x - floor(x));
    return image_mix(top, bottom, y - floor(y));
}

struct vec3 sky_map_colour(const struct image *image, struct vec3 d, double spread) {
    const double pi = 3.14159265358979323846;
    if (!vec3_finite(d))
        return vec3_all(0);
    double u = 0.5 + el_atan2(d.x, -d.z) / (2 * pi);
    double v = el_atan2(sqrt(d.x * d.x + d.z * d.z), d.y) / pi;
    double texels = spread / pi * image->levels[0].height;
    double level = texels > 1 ? image_level_for(texels, image->level_count - 1) : 0;
    int lower = (int)level;
    struct rgba c = bilinear(image, lower, u, v);
    if (level > lower)
        c = image_mix(c, bilinear(image, lower + 1, u, v), level - lower);
    c = image_from_units(c);
    return (struct vec3){c.r, c.g, c.b};
}
