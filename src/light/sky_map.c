/* An image of the whole sphere, longitude along its rows and latitude down its columns. A texel left of the first is
 * the last of its row; a row above the first is the first again, turned by 180 degrees: it lies on the other side of
 * the pole. So a path over the pole or around the back meets no seam. The mip level follows the rows, whose width on
 * the sphere is the same everywhere. */
#include "image/levels.h"
#include "light/sky_parts.h"
#include "math/elementary.h"

/* One row at x texels from the left, linear between its texels. */
static struct rgba row_at(const struct image *image, int level, int64_t y, double x) {
    int64_t w = image->levels[level].width, h = image->levels[level].height;
    if (y < 0 || y >= h) {
        y = y < 0 ? -1 - y : 2 * h - 1 - y;
        x += (double)w / 2;
    }
    int64_t row = y < 0 ? 0 : y >= h ? h - 1 : y, i = (int64_t)floor(x) % w;
    i = i < 0 ? i + w : i;
    struct rgba left = image_level_texel(image, level, (uint32_t)i, (uint32_t)row);
    return image_mix(left, image_level_texel(image, level, (uint32_t)((i + 1) % w), (uint32_t)row), x - floor(x));
}

static struct rgba bilinear(const struct image *image, int level, double u, double v) {
    double x = u * image->levels[level].width - 0.5, y = v * image->levels[level].height - 0.5;
    int64_t j = (int64_t)floor(y);
    return image_mix(row_at(image, level, j, x), row_at(image, level, j + 1, x), y - floor(y));
}

struct vec3 sky_map_colour(const struct image *image, struct vec3 d, double spread) {
    if (!vec3_finite(d))
        return vec3_all(0);
    double u = 0.5 + el_atan2(d.x, -d.z) / (2 * PI);
    double v = el_atan2(sqrt(d.x * d.x + d.z * d.z), d.y) / PI;
    double texels = spread / PI * image->levels[0].height;
    double level = texels > 1 ? image_level_for(texels, image->level_count - 1) : 0;
    int lower = (int)level;
    struct rgba c = bilinear(image, lower, u, v);
    if (level > lower)
        c = image_mix(c, bilinear(image, lower + 1, u, v), level - lower);
    c = image_from_units(c);
    return (struct vec3){c.r, c.g, c.b};
}
