/* The radiance of rays that hit nothing: a function of the unit direction (docs/language.md 8). */
#ifndef GRAY_LIGHT_SKY_H
#define GRAY_LIGHT_SKY_H

#include "base/bundle.h"
#include "base/error.h"
#include "base/list.h"
#include "expr/expr_program.h"
#include "image/image.h"
#include "math/vec3.h"

/* Every kind with what listings call it. */
#define SKY_KINDS(X)                                                                                                   \
    X(SKY_GRADIENT, "the gradient")                                                                                    \
    X(SKY_CONSTANT, "one colour")                                                                                      \
    X(SKY_CROSS, "an image, a cross of cube faces")                                                                    \
    X(SKY_FACES, "six images")                                                                                         \
    X(SKY_MAP, "an image of all directions")                                                                           \
    X(SKY_STOPS, "colours by height")                                                                                  \
    X(SKY_CLEAR, "the clear sky")                                                                                      \
    X(SKY_FUNCTION, "a function")
enum sky_kind { SKY_KINDS(LIST_MEMBER) };
const char *sky_kind_name(enum sky_kind kind);

struct sky {
    enum sky_kind kind;
    struct colour colour; /* of SKY_CONSTANT */
    struct image *image;  /* of SKY_CROSS: a 4 x 3 cross `#T##` / `LFRK` / `#B##`, seen from inside */
    bool mirror;
    struct image *faces[6]; /* of SKY_FACES: -x, +x, -y, +y, -z, +z as seen from the centre */
    /* Of SKY_STOPS: {y of the unit direction, r, g, b}, y never decreasing; linear between, constant beyond. */
    const double (*stops)[4];
    uint32_t stop_count;
    struct clear_sky {
        struct vec3 sun;      /* unit, to it */
        struct colour ground; /* the colour of the part below the horizon */
        double perez[3][5];   /* for Y, x, y */
        double scale[3];      /* zenith over Perez' function there */
    } clear;
    const struct expr_program *program; /* of SKY_FUNCTION: of the unit direction alone */
    double largest;                     /* a bound of its components */
    /* A rotation of the whole sky about the y axis and a factor; used only if `adjusted`. */
    bool adjusted;
    double turn_sine, turn_cosine, intensity;
    bool display; /* `colour` and `ground` are colours of the screen */
};

/* Checks the proportions of the cross. */
bool sky_from_cross(struct image *image, bool mirror, struct sky *out, struct error *error);
/* Six square images of one size; SKY_MAP: longitude along the rows, -z in the middle and +x right of it. */
bool sky_from_faces(struct image *const faces[6], struct sky *out, struct error *error);
/* Turbidity: 2 is very clear, 10 hazy. sun: unit, at or above the horizon. */
void sky_make_clear(struct vec3 sun, double turbidity, struct colour ground, struct sky *out);
/* For a function with one output or three. Errors: it reads more than the direction, or no memory. */
bool sky_from_function(const struct expr_program *program, struct sky *out, struct error *error);
/* A time of the clock; it is `zone` hours ahead of Greenwich. */
struct sky_time {
    int year;               /* 1901 to 2099 */
    double day, hour, zone; /* day of the year, from 1 */
};
/* The unit direction to the sun: y up, -z north, +x east. Degrees, north and east positive. */
struct vec3 sky_sun(const struct sky_time *time, double latitude, double longitude);
/* Rotates it further about the y axis: light from +x then comes from (cosine, 0, -sine). */
void sky_turn(struct sky *sky, double sine, double cosine);
/* For linear colours: its images (image_colour_transfer) and colours of the screen are decoded. False: no memory. */
bool sky_decode(struct sky *sky, struct error *error);
/* Whether they are the same function, of the same images and stops. */
bool sky_same(const struct sky *a, const struct sky *b);
/* A bound of the largest component of its colours. */
double sky_brightest(const struct sky *sky);
/* Whether it is black in all directions. False where only its pictures or its function could show it. */
bool sky_is_black(const struct sky *sky);
/* `spread`: angle of the ray's cone in radians, for filtering; 0 = unknown. */
struct colour sky_colour(const struct sky *sky, struct vec3 direction, double spread);
/* What it points to (base/bundle.h). */
bundle_fields sky_bundle;

#endif
