/* The sky: a constant, the gradient {0, 0, (1 + y)/2}, or six faces cut from a 4 x 3 cross (docs/language.md 8).
 * The viewer is in the centre of a cube whose faces are printed on the inside. Looking along f with the picture's
 * upward direction u, the picture's right is r = f x u (right-handed). The sides L F R K are upright (u = +y); to the
 * right of F = +z is r = z x y = -x, so R = -x, K = -z, L = +x. T joins F's upper edge: its lower side points to +z, u
 * = -z; B joins F's lower edge: u = +z. This is the table below; everything follows from it, including the neighbours
 * across each edge.
 *
 * Filtering has no seams: a texel beyond the edge of a face is fetched from the face that lies there, and at a corner
 * of the cube, where three texels meet and the fourth is missing, their mean replaces it. Both faces at an edge then
 * mix the same texels with the same weights. The black corners of the cross are never read: no mip level mixes two
 * cells of the cross (see image.c). */
#include "light/sky.h"

#include "expr/expr_field.h"
#include "image/levels.h"
#include "math/elementary.h"

#include <math.h>
#include <string.h>

/* The clear sky of Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999: luminance and
 * chromaticity are Perez' function of the angles to the zenith and to the sun, with the coefficients of the paper's
 * appendix A.2. xyY is converted to linear sRGB by the matrix of IEC 61966-2-1. Luminance in kcd/m^2 is divided by 20,
 * so that a bright blue sky is near 1. */

static double perez(const double c[5], double cos_zenith, double cos_sun) {
    double cosine = cos_zenith > 1e-3 ? cos_zenith : 1e-3; /* the function is singular at the horizon */
    cos_sun = cos_sun > 1 ? 1 : cos_sun < -1 ? -1 : cos_sun;
    return (1 + c[0] * el_exp(c[1] / cosine)) * (1 + c[2] * el_exp(c[3] * el_acos(cos_sun)) + c[4] * cos_sun * cos_sun);
}

/* (T^2 T 1) M (theta^3 theta^2 theta 1) */
static double zenith_chromaticity(const double m[3][4], double turbidity, double theta) {
    double sum = 0, power = turbidity * turbidity;
    for (int i = 0; i < 3; i++) {
        sum += power * (((m[i][0] * theta + m[i][1]) * theta + m[i][2]) * theta + m[i][3]);
        power = i == 0 ? turbidity : 1;
    }
    return sum;
}

void sky_make_clear(struct vec3 sun, double turbidity, struct colour ground, struct sky *out) {
    static const double slope[3][5] = {{0.1787, -0.3554, -0.0227, 0.1206, -0.0670},
                                       {-0.0193, -0.0665, -0.0004, -0.0641, -0.0033},
                                       {-0.0167, -0.0950, -0.0079, -0.0441, -0.0109}};
    static const double start[3][5] = {{-1.4630, 0.4275, 5.3251, -2.5771, 0.3703},
                                       {-0.2592, 0.0008, 0.2125, -0.8989, 0.0452},
                                       {-0.2608, 0.0092, 0.2102, -1.6537, 0.0529}};
    static const double zenith_x[3][4] = {
        {0.00166, -0.00375, 0.00209, 0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}};
    static const double zenith_y[3][4] = {
        {0.00275, -0.00610, 0.00317, 0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}};
    *out = (struct sky){.kind = SKY_CLEAR};
    struct clear_sky *clear = &out->clear;
    clear->sun = sun;
    clear->ground = ground;
    /* Below the horizon the model has no values: the sun is at it then. */
    double cos_sun = sun.y < 0 ? 0 : sun.y > 1 ? 1 : sun.y, theta = el_acos(cos_sun);
    double chi = (4.0 / 9 - turbidity / 120) * (PI - 2 * theta);
    double luminance = (4.0453 * turbidity - 4.9710) * el_tan(chi) - 0.2155 * turbidity + 2.4192;
    double zenith[3] = {(luminance > 0 ? luminance : 0) / 20, zenith_chromaticity(zenith_x, turbidity, theta),
                        zenith_chromaticity(zenith_y, turbidity, theta)};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 5; k++)
            clear->perez[i][k] = slope[i][k] * turbidity + start[i][k];
        clear->scale[i] = zenith[i] / perez(clear->perez[i], 1, cos_sun);
    }
}

/* Never negative. */
static struct colour sky_clear_colour(const struct clear_sky *clear, struct vec3 d) {
    if (d.y < 0)
        return clear->ground;
    double cos_sun = vec3_dot(d, clear->sun), xyy[3];
    for (int i = 0; i < 3; i++)
        xyy[i] = clear->scale[i] * perez(clear->perez[i], d.y, cos_sun);
    double luminance = xyy[0] > 0 ? xyy[0] : 0;
    double x = xyy[1] / xyy[2] * luminance, z = (1 - xyy[1] - xyy[2]) / xyy[2] * luminance;
    struct colour c = {3.2406 * x - 1.5372 * luminance - 0.4986 * z, -0.9689 * x + 1.8758 * luminance + 0.0415 * z,
                       0.0557 * x - 0.2040 * luminance + 1.0570 * z};
    return colour_max(c, colour_all(0));
}

/* The Julian day of 0 h on the first of January (Gregorian calendar). */
static double january_first(int year) {
    int before = year - 1;
    return 1721425.5 + 365.0 * before + (before / 4 - before / 100 + before / 400);
}

/* The position of the sun by the Solar Calculator of NOAA (gml.noaa.gov/grad/solcalc, calcdetails.html), whose formulas
 * are those of J. Meeus, "Astronomical Algorithms", 2nd ed., chapters 25 and 28: angles in radians, without
 * refraction. */
struct vec3 sky_sun(const struct sky_time *time, double latitude, double longitude) {
    const double degree = PI / 180;
    double julian = january_first(time->year) + (time->day - 1) + (time->hour - time->zone) / 24;
    double t = (julian - 2451545) / 36525; /* centuries from 2000 */
    double mean_longitude = (280.46646 + t * (36000.76983 + t * 0.0003032)) * degree;
    double anomaly = (357.52911 + t * (35999.05029 - 0.0001537 * t)) * degree;
    double eccentricity = 0.016708634 - t * (0.000042037 + 0.0000001267 * t);
    double centre = el_sin(anomaly) * (1.914602 - t * (0.004817 + 0.000014 * t)) +
                    el_sin(2 * anomaly) * (0.019993 - 0.000101 * t) + el_sin(3 * anomaly) * 0.000289;
    double node = (125.04 - 1934.136 * t) * degree; /* of the moon's orbit, for the nutation */
    double apparent = mean_longitude + (centre - 0.00569 - 0.00478 * el_sin(node)) * degree;
    double obliquity = 23 + (26 + (21.448 - t * (46.815 + t * (0.00059 - t * 0.001813))) / 60) / 60;
    obliquity = (obliquity + 0.00256 * el_cos(node)) * degree;
    double half = el_sin(obliquity / 2) / el_cos(obliquity / 2), y = half * half;
    double equation = y * el_sin(2 * mean_longitude) - 2 * eccentricity * el_sin(anomaly) +
                      4 * eccentricity * y * el_sin(anomaly) * el_cos(2 * mean_longitude) -
                      0.5 * y * y * el_sin(4 * mean_longitude) -
                      1.25 * eccentricity * eccentricity * el_sin(2 * anomaly);
    double turn = (15 * (time->hour - time->zone - 12) + longitude) * degree + equation; /* from south to west */
    double s_lat, c_lat, s_turn, c_turn;
    double s_dec = el_sin(obliquity) * el_sin(apparent), c_dec = sqrt(1 - s_dec * s_dec);
    el_sincos(latitude * degree, &s_lat, &c_lat);
    el_sincos(turn, &s_turn, &c_turn);
    double north = c_lat * s_dec - s_lat * c_dec * c_turn;
    return (struct vec3){-c_dec * s_turn, s_lat * s_dec + c_lat * c_dec * c_turn, -north};
}

/* An image of the whole sphere, longitude along its rows and latitude down its columns. A texel left of the first is
 * the last of its row; a row above the first is the first again, turned by 180 degrees: it lies on the other side of
 * the pole. So there is no seam at the poles or at the back. The mip level follows the rows, whose width on
 * the sphere is the same everywhere. */

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

static struct rgba map_bilinear(const struct image *image, int level, double u, double v) {
    double x = u * image->levels[level].width - 0.5, y = v * image->levels[level].height - 0.5;
    int64_t j = (int64_t)floor(y);
    return image_mix(row_at(image, level, j, x), row_at(image, level, j + 1, x), y - floor(y));
}

static struct colour sky_map_colour(const struct image *image, struct vec3 d, double spread) {
    if (!vec3_finite(d))
        return colour_all(0);
    double u = 0.5 + el_atan2(d.x, -d.z) / (2 * PI);
    double v = el_atan2(sqrt(d.x * d.x + d.z * d.z), d.y) / PI;
    double texels = spread / PI * image->levels[0].height;
    double level = texels > 1 ? image_level_for(texels, image->level_count - 1) : 0;
    int lower = (int)level;
    struct rgba c = map_bilinear(image, lower, u, v);
    if (level > lower)
        c = image_mix(c, map_bilinear(image, lower + 1, u, v), level - lower);
    c = image_from_units(c);
    return (struct colour){c.r, c.g, c.b};
}

const char *sky_kind_name(enum sky_kind kind) {
    static const char *const names[] = {SKY_KINDS(LIST_WORD)};
    return names[kind];
}

struct face {
    uint32_t column, row; /* cell of the cross */
    struct vec3 right, up, forward;
};

static const struct face faces[6] = {
    {2, 1, {0, 0, -1}, {0, 1, 0}, {-1, 0, 0}}, /* R: -x */
    {0, 1, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}},   /* L: +x */
    {1, 2, {-1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, /* B: -y */
    {1, 0, {-1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, /* T: +y */
    {3, 1, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}},  /* K: -z */
    {1, 1, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}},  /* F: +z */
};

/* The face that a direction hits: twice its axis, plus one on the positive side. */
static int face_of(struct vec3 d) {
    double x = fabs(d.x), y = fabs(d.y), z = fabs(d.z);
    if (x >= y && x >= z)
        return d.x > 0;
    if (y >= z)
        return 2 + (d.y > 0);
    return 4 + (d.z > 0);
}

/* One level of the cross: its faces are `width` x `height` texels. */
struct level {
    const struct image *image;
    struct image *const *six; /* an image for every face, or NULL: cells of the cross */
    int index;
    uint32_t width, height;
};

static struct rgba face_texel(const struct level *level, int face, uint32_t x, uint32_t y) {
    if (level->six)
        return image_level_texel(level->six[face], level->index, x, y);
    return image_level_texel(level->image, level->index, faces[face].column * level->width + x,
                             faces[face].row * level->height + y);
}

static uint32_t index_at(double position, uint32_t size) {
    double x = floor((position + 1) / 2 * size);
    return x > 0 ? (x < size ? (uint32_t)x : size - 1) : 0;
}

/* The texel across an edge: right and up are in [-1, 1] on the face's plane, exactly one of them +-1 (the edge). */
static struct rgba texel_across(const struct level *level, int face, double right, double up) {
    const struct face *from = &faces[face];
    bool sideways = fabs(right) == 1;
    struct vec3 outward = vec3_scale(sideways ? from->right : from->up, sideways ? right : up);
    struct vec3 along = vec3_scale(sideways ? from->up : from->right, sideways ? up : right);
    int other = face_of(outward);
    struct vec3 p = vec3_add(from->forward, along); /* in the plane of the other face, on the common edge */
    uint32_t x = index_at(vec3_dot(p, faces[other].right), level->width);
    uint32_t y = index_at(-vec3_dot(p, faces[other].up), level->height);
    return face_texel(level, other, x, y);
}

static struct rgba mean_of_three(struct rgba a, struct rgba b, struct rgba c) {
    return (struct rgba){(a.r + b.r + c.r) / 3, (a.g + b.g + c.g) / 3, (a.b + b.b + c.b) / 3, (a.a + b.a + c.a) / 3};
}

/* Texel (x, y) of a face where either may be one off the face. */
static struct rgba texel_near(const struct level *level, int face, int64_t x, int64_t y) {
    int64_t w = level->width, h = level->height;
    bool off_x = x < 0 || x >= w, off_y = y < 0 || y >= h;
    if (!off_x && !off_y)
        return face_texel(level, face, (uint32_t)x, (uint32_t)y);
    int64_t in_x = x < 0 ? 0 : x >= w ? w - 1 : x, in_y = y < 0 ? 0 : y >= h ? h - 1 : y;
    double right = (double)(2 * in_x + 1 - w) / (double)w, up = (double)(h - 2 * in_y - 1) / (double)h;
    double edge_x = x < 0 ? -1 : 1, edge_y = y < 0 ? 1 : -1;
    if (!off_y)
        return texel_across(level, face, edge_x, up);
    if (!off_x)
        return texel_across(level, face, right, edge_y);
    return mean_of_three(face_texel(level, face, (uint32_t)in_x, (uint32_t)in_y), texel_across(level, face, edge_x, up),
                         texel_across(level, face, right, edge_y));
}

/* s from the left and t from the top, both in [0, 1]. */
static struct rgba bilinear(const struct level *level, int face, double s, double t) {
    double x = s * level->width - 0.5, y = t * level->height - 0.5;
    int64_t i = (int64_t)floor(x), j = (int64_t)floor(y);
    double fx = x - floor(x), fy = y - floor(y);
    struct rgba top = image_mix(texel_near(level, face, i, j), texel_near(level, face, i + 1, j), fx);
    struct rgba bottom = image_mix(texel_near(level, face, i, j + 1), texel_near(level, face, i + 1, j + 1), fx);
    return image_mix(top, bottom, fy);
}

static struct level level_at(const struct sky *sky, int index) {
    bool six = sky->kind == SKY_FACES;
    const struct image *image = six ? sky->faces[0] : sky->image;
    const struct image_level *l = &image->levels[index];
    return (struct level){.image = image,
                          .six = six ? sky->faces : NULL,
                          .index = index,
                          .width = six ? l->width : l->width / 4,
                          .height = six ? l->height : l->height / 3};
}

/* The last level whose faces are whole texels. */
static int last_level(const struct sky *sky) {
    const struct image *image = sky->image;
    int last = 0;
    if (sky->kind == SKY_FACES)
        return sky->faces[0]->level_count - 1;
    while (last + 1 < image->level_count && image->levels[last + 1].width >= 4 && image->levels[last + 1].height >= 3)
        last++;
    return last;
}

static struct colour cross_colour(const struct sky *sky, struct vec3 d, double spread) {
    if (sky->mirror)
        d.x = -d.x;
    double depth = vec3_max_abs(d);
    if (!(depth > 0) || !vec3_finite(d))
        return colour_all(0);
    int face = face_of(d);
    double s = (1 + vec3_dot(d, faces[face].right) / depth) / 2;
    double t = (1 - vec3_dot(d, faces[face].up) / depth) / 2;

    /* A cone of angle e around the unit direction d cuts the plane at distance 1 in an ellipse of about e / depth by
     * e / depth^2; the face is 2 wide there. */
    struct level fine = level_at(sky, 0);
    double texels = spread > 0 ? spread / (2 * depth * sqrt(depth)) * math_max(fine.width, fine.height) : 0;
    double level = texels > 1 ? image_level_for(texels, last_level(sky)) : 0;
    int lower = (int)level;
    fine = level_at(sky, lower);
    struct rgba c = bilinear(&fine, face, s, t);
    if (level > lower) {
        struct level coarse = level_at(sky, lower + 1);
        c = image_mix(c, bilinear(&coarse, face, s, t), level - lower);
    }
    c = image_from_units(c);
    return (struct colour){c.r, c.g, c.b};
}

bool sky_from_cross(struct image *image, bool mirror, struct sky *out, struct error *error) {
    uint32_t width = image_width(image), height = image_height(image);
    if (width % 4 != 0 || height % 3 != 0)
        return error_set(
            error, ERROR_SCENE,
            "%s: a sky image is a cross of 4 x 3 faces, so its width must be divisible by 4 and its height "
            "by 3; it is %u x %u; gr.sky_map takes pictures of the whole sphere",
            image_name(image), width, height);
    *out = (struct sky){.kind = SKY_CROSS, .image = image, .mirror = mirror};
    return true;
}

bool sky_from_faces(struct image *const images[6], struct sky *out, struct error *error) {
    *out = (struct sky){.kind = SKY_FACES};
    for (int i = 0; i < 6; i++) {
        uint32_t width = image_width(images[i]), height = image_height(images[i]);
        if (width != height || width != image_width(images[0]))
            return error_set(error, ERROR_SCENE,
                             "%s: the six faces of a sky must be square and of one size; this one is %u x %u",
                             image_name(images[i]), width, height);
        out->faces[i] = images[i];
    }
    return true;
}

bool sky_from_function(const struct expr_program *program, struct sky *out, struct error *error) {
    *out = (struct sky){.kind = SKY_FUNCTION, .program = program};
    return expr_field_reads_only(program, EXPR_POINT_INPUTS, "a sky may depend only on the direction", error) &&
           (expr_field_largest(program, &out->largest) || error_no_memory(error, "a sky"));
}

static struct colour stops_colour(const struct sky *sky, double y) {
    const double(*stops)[4] = sky->stops;
    uint32_t last = sky->stop_count - 1, i = 0;
    while (i < last && stops[i + 1][0] <= y)
        i++;
    if (y <= stops[0][0] || i == last)
        return colour_make(stops[i][1], stops[i][2], stops[i][3]);
    double share = (y - stops[i][0]) / (stops[i + 1][0] - stops[i][0]);
    struct colour low = {stops[i][1], stops[i][2], stops[i][3]};
    struct colour high = {stops[i + 1][1], stops[i + 1][2], stops[i + 1][3]};
    return colour_add_scaled(low, colour_sub(high, low), share);
}

static struct colour unturned_colour(const struct sky *sky, struct vec3 direction, double spread) {
    switch (sky->kind) {
    case SKY_GRADIENT:
        return colour_make(0, 0, (1 + direction.y) / 2);
    case SKY_CONSTANT:
        return sky->colour;
    case SKY_CROSS:
    case SKY_FACES:
        return cross_colour(sky, direction, spread);
    case SKY_MAP:
        return sky_map_colour(sky->image, direction, spread);
    case SKY_STOPS:
        return stops_colour(sky, direction.y);
    case SKY_CLEAR:
        return sky_clear_colour(&sky->clear, direction);
    case SKY_FUNCTION:
        return expr_field_at(sky->program, direction);
    }
    return colour_all(0);
}

static double largest(struct colour c) {
    double max = c.r > c.g ? c.r : c.g;
    return c.b > max ? c.b : max;
}

static double unturned_brightest(const struct sky *sky) {
    double max = 0;
    switch (sky->kind) {
    case SKY_GRADIENT:
        return 1;
    case SKY_CONSTANT:
        return largest(sky->colour);
    case SKY_CROSS:
    case SKY_MAP:
        return image_brightest(sky->image);
    case SKY_FACES:
        for (int i = 0; i < 6; i++)
            max = math_max(max, image_brightest(sky->faces[i]));
        return max;
    case SKY_STOPS:
        for (uint32_t i = 0; i < sky->stop_count; i++)
            max = math_max(max, largest(colour_make(sky->stops[i][1], sky->stops[i][2], sky->stops[i][3])));
        return max;
    case SKY_CLEAR:
        /* Brightest at the sun or at the horizon below it. */
        max = largest(sky_clear_colour(&sky->clear, sky->clear.sun));
        max = math_max(max, largest(sky_clear_colour(
                                &sky->clear, vec3_normalize(vec3_make(sky->clear.sun.x, 0, sky->clear.sun.z)))));
        return math_max(max, largest(sky->clear.ground));
    case SKY_FUNCTION:
        return sky->largest;
    }
    return 1;
}

double sky_brightest(const struct sky *sky) {
    return unturned_brightest(sky) * (sky->adjusted ? sky->intensity : 1);
}

bool sky_is_black(const struct sky *sky) {
    double max = 0;
    switch (sky->kind) {
    case SKY_CONSTANT:
        max = colour_max_abs(sky->colour);
        break;
    case SKY_STOPS:
        for (uint32_t i = 0; i < sky->stop_count; i++)
            max = math_max(max, colour_max_abs(colour_make(sky->stops[i][1], sky->stops[i][2], sky->stops[i][3])));
        break;
    case SKY_GRADIENT:
    case SKY_CROSS:
    case SKY_FACES:
    case SKY_MAP:
    case SKY_CLEAR:
    case SKY_FUNCTION:
        max = 1;
    }
    return max == 0 || (sky->adjusted && sky->intensity == 0);
}

void sky_turn(struct sky *sky, double sine, double cosine) {
    if (!sky->adjusted) {
        sky->adjusted = true;
        sky->intensity = sky->turn_cosine = 1;
        sky->turn_sine = 0;
    }
    double s = sky->turn_sine, c = sky->turn_cosine;
    sky->turn_sine = s * cosine + c * sine;
    sky->turn_cosine = c * cosine - s * sine;
}

static bool decode(struct image **image, struct error *error) {
    if (*image)
        *image = image_decode(*image, image_colour_transfer(*image), error);
    return *image != NULL;
}

bool sky_decode(struct sky *sky, struct error *error) {
    bool ok = true;
    if (sky->display) {
        const struct transfer_function srgb = {TRANSFER_SRGB, 0};
        sky->colour = transfer_decode_colour(srgb, sky->colour);
        sky->clear.ground = transfer_decode_colour(srgb, sky->clear.ground);
        sky->display = false;
    }
    switch (sky->kind) {
    case SKY_CROSS:
    case SKY_MAP:
        return decode(&sky->image, error);
    case SKY_FACES:
        for (int i = 0; i < 6; i++)
            ok = ok && decode(&sky->faces[i], error);
        return ok;
    case SKY_GRADIENT:
    case SKY_CONSTANT:
    case SKY_STOPS:
    case SKY_CLEAR:
    case SKY_FUNCTION:
        break;
    }
    return true;
}

bool sky_same(const struct sky *a, const struct sky *b) {
    bool adjusted = a->adjusted &&
                    (a->turn_sine != b->turn_sine || a->turn_cosine != b->turn_cosine || a->intensity != b->intensity);
    if (a->kind != b->kind || a->adjusted != b->adjusted || adjusted)
        return false;
    switch (a->kind) {
    case SKY_GRADIENT:
        return true;
    case SKY_CONSTANT:
        return memcmp(&a->colour, &b->colour, sizeof a->colour) == 0;
    case SKY_CROSS:
        return a->image == b->image && a->mirror == b->mirror;
    case SKY_FACES:
        return memcmp(a->faces, b->faces, sizeof a->faces) == 0;
    case SKY_MAP:
        return a->image == b->image;
    case SKY_STOPS:
        return a->stops == b->stops && a->stop_count == b->stop_count;
    case SKY_CLEAR:
        return memcmp(&a->clear, &b->clear, sizeof a->clear) == 0;
    case SKY_FUNCTION:
        return a->program == b->program;
    }
    return false;
}

struct colour sky_colour(const struct sky *sky, struct vec3 direction, double spread) {
    if (!sky->adjusted)
        return unturned_colour(sky, direction, spread);
    double s = sky->turn_sine, c = sky->turn_cosine;
    struct vec3 d = {c * direction.x - s * direction.z, direction.y, s * direction.x + c * direction.z};
    return colour_scale(unturned_colour(sky, d, spread), sky->intensity);
}

void sky_bundle(struct bundle *bundle, void *any) {
    struct sky *sky = any;
    image_bundle(bundle, &sky->image);
    for (int i = 0; i < 6; i++)
        image_bundle(bundle, &sky->faces[i]);
    BUNDLE(bundle, sky->stops, sky->stop_count, NULL);
    BUNDLE(bundle, sky->program, 1, expr_program_bundle);
}
