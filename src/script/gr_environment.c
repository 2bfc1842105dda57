/* Skies, and the light of the sun. */
#include "call/context.h"
#include "material/fog_field.h"
#include "math/elementary.h"
#include "record/record_bounds.h"
#include "script/gr_lights_internal.h"
#include "script/gr_materials_internal.h"
#include "script/rows_internal.h"
#include "script/script_internal.h"

enum { SKY_INTENSITY, SKY_ROTATION, SKY_OWN };
#define SKY_FIELDS                                                                                                     \
    [SKY_INTENSITY] = ROW("intensity", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "1", "Factor of its brightness."),       \
    [SKY_ROTATION] = ROW("rotation", KIND_NUMBER, OPTIONAL, ANY, "degrees", "0",                                       \
                         "Rotation about y, counterclockwise seen from above.")
#define SKY_FACE(text)                                                                                                 \
    { text, KIND_IMAGE, 0, ANY, NULL, NULL, "A square picture, as seen from the centre." }

/* The fields of the sun follow one another. */
enum { SUN_DIRECTION, SUN_HOUR, SUN_DAY, SUN_LATITUDE, SUN_LONGITUDE, SUN_ZONE, SUN_YEAR, SUN_FIELDS };
#define SUN(first)                                                                                                     \
    [(first) + SUN_DIRECTION] =                                                                                        \
        ROW("sun", KIND_DIRECTION, OPTIONAL, ANY, NULL, NULL, "Direction to the sun, instead of time and position."),  \
               [(first) + SUN_HOUR] =                                                                                  \
                   ROW("hour", KIND_NUMBER, OPTIONAL, IN_RANGE(0, 24), NULL, "12", "Local time of day."),              \
               [(first) + SUN_DAY] =                                                                                   \
                   ROW("day", KIND_WHOLE, OPTIONAL, IN_RANGE(1, 366), NULL, "172, 21 June", "Day of the year."),       \
               [(first) + SUN_LATITUDE] = ROW("latitude", KIND_NUMBER, OPTIONAL, IN_RANGE(-90, 90), "degrees", "45",   \
                                              "Positive is north; in the scene, -z is north and +x is east."),         \
               [(first) + SUN_LONGITUDE] =                                                                             \
                   ROW("longitude", KIND_NUMBER, OPTIONAL, IN_RANGE(-180, 180), "degrees", "0", "Positive is east."),  \
               [(first) + SUN_ZONE] = ROW("zone", KIND_NUMBER, OPTIONAL, IN_RANGE(-14, 14), "hours", "0",              \
                                          "Difference of the local time to Greenwich; positive is east."),             \
               [(first) + SUN_YEAR] =                                                                                  \
                   ROW("year", KIND_WHOLE, OPTIONAL, IN_RANGE(1901, 2099), NULL, "2025", "Year of the day.")

enum { FOG_COLOUR, FOG_CLEAR_SKY, FOG_OWN };
#define FOG_CLEAR_SKY_FIELD                                                                                            \
    [FOG_CLEAR_SKY] =                                                                                                  \
        ROW("clear_sky", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the fog leaves the sky unchanged.")
#define FOG_FIELDS                                                                                                     \
    [FOG_COLOUR] = ROW("colour", KIND_COLOUR, OPTIONAL | OR_DISPLAY, ANY, NULL, "{0.5, 0.5, 0.5}", "Its colour."),     \
    FOG_CLEAR_SKY_FIELD
#define FOG_DENSITY(text) [FOG_AMOUNT] = {"density", KIND_NUMBER, 0, ABOVE(0), NULL, NULL, text}

static bool give_sky(struct script_context *context, struct sky *sky, const struct script_value *args,
                     struct script_result *result, struct error *error) {
    struct sky *kept = arena_alloc(&context->scene.arena, sizeof *kept);
    if (!kept)
        return error_no_memory(error, "a sky");
    sky->adjusted = args[SKY_INTENSITY].given || args[SKY_ROTATION].given;
    sky->intensity = args[SKY_INTENSITY].given ? args[SKY_INTENSITY].number : 1;
    el_sincos(args[SKY_ROTATION].number * (PI / 180), &sky->turn_sine, &sky->turn_cosine);
    *kept = *sky;
    result->pointer = kept;
    return true;
}

enum { FACES_FRONT = SKY_OWN, FACES_RIGHT, FACES_BACK, FACES_LEFT, FACES_TOP, FACES_BOTTOM };
static const struct script_parameter sky_faces_parameters[] = {
    SKY_FIELDS,
    [FACES_FRONT] = SKY_FACE("front"),
    [FACES_RIGHT] = SKY_FACE("right"),
    [FACES_BACK] = SKY_FACE("back"),
    [FACES_LEFT] = SKY_FACE("left"),
    [FACES_TOP] = SKY_FACE("top"),
    [FACES_BOTTOM] = SKY_FACE("bottom"),
};

static bool gr_sky_faces(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    static const int fields[6] = {FACES_RIGHT, FACES_LEFT, FACES_BOTTOM, FACES_TOP, FACES_BACK, FACES_FRONT};
    struct image *images[6];
    struct sky sky;
    for (int i = 0; i < 6; i++) {
        images[i] = gr_find_image(context, &args[fields[i]], error);
        if (!images[i])
            return false;
    }
    return sky_from_faces(images, &sky, error) && give_sky(context, &sky, args, result, error);
}

enum { CROSS_IMAGE = SKY_OWN, CROSS_MIRROR };
static const struct script_parameter sky_cross_parameters[] = {
    SKY_FIELDS,
    [CROSS_IMAGE] = {"image", KIND_IMAGE, 0, ANY, NULL, NULL, "A picture file with six views in a 4 x 3 cross."},
    [CROSS_MIRROR] = {"mirror", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the cross is mirrored."},
};

static bool gr_sky_cross(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    struct image *image = gr_find_image(context, &args[CROSS_IMAGE], error);
    struct sky sky;
    return image && sky_from_cross(image, args[CROSS_MIRROR].boolean, &sky, error) &&
           give_sky(context, &sky, args, result, error);
}

enum { MAP_IMAGE = SKY_OWN };
static const struct script_parameter sky_map_parameters[] = {
    SKY_FIELDS,
    [MAP_IMAGE] = {"image", KIND_IMAGE, 0, ANY, NULL, NULL,
                   "Picture of the whole sphere, longitude by latitude, with -z in the middle and +x to the right. "
                   "Radiance HDR, PFM and EXR files hold values above 1."},
};

static bool gr_sky_map(struct script_context *context, const struct script_value *args, struct script_result *result,
                       struct error *error) {
    struct sky sky = {.kind = SKY_MAP, .image = gr_find_image(context, &args[MAP_IMAGE], error)};
    return sky.image && give_sky(context, &sky, args, result, error);
}

enum { GRADIENT_STOPS = SKY_OWN };
static const struct script_parameter sky_gradient_parameters[] = {
    SKY_FIELDS,
    [GRADIENT_STOPS] = {"stops", KIND_STOPS, 0, ANY, NULL, NULL,
                        "Colours by height, {y, r, g, b}; y of the unit direction, from -1 to 1; linear between."},
};

static bool gr_sky_gradient(struct script_context *context, const struct script_value *args,
                            struct script_result *result, struct error *error) {
    const struct script_value *given = &args[GRADIENT_STOPS];
    double(*stops)[4] = arena_alloc_array(&context->scene.arena, (size_t)given->count + 1, sizeof *stops);
    if (!stops)
        return error_no_memory(error, "a sky");
    if (given->count == 0)
        return error_set(error, ERROR_SCENE, "stops must not be empty");
    for (uint32_t i = 0; i < given->count; i++) {
        if (i > 0 && given->stops[i][0] < given->stops[i - 1][0])
            return error_set(error, ERROR_SCENE, "stops[%u][1] must be at least the height before it", i + 1);
        for (int k = 0; k < 4; k++)
            stops[i][k] = given->stops[i][k];
    }
    struct sky sky = {.kind = SKY_STOPS, .stops = (const double(*)[4])stops, .stop_count = given->count};
    return give_sky(context, &sky, args, result, error);
}

enum { SKYFUNCTION_F = SKY_OWN };
static const struct script_parameter sky_function_parameters[] = {
    SKY_FIELDS,
    [SKYFUNCTION_F] = {"f", KIND_FUNCTION, OR_PROFILE, ANY, NULL, NULL,
                       "A function of the unit direction; it returns a colour or a number."},
};

static bool gr_sky_function(struct script_context *context, const struct script_value *args,
                            struct script_result *result, struct error *error) {
    struct sky sky;
    return sky_from_function(args[SKYFUNCTION_F].program, &sky, error) && give_sky(context, &sky, args, result, error);
}

/* The unit direction to the sun, from a direction or from time and geographic position. `sun` points to the first of
 * the fields. */
static bool find_sun(struct script_context *context, const struct script_value *sun, struct vec3 *out,
                     struct error *error) {
    bool by_time = sun[SUN_HOUR].given || sun[SUN_DAY].given || sun[SUN_LATITUDE].given || sun[SUN_LONGITUDE].given ||
                   sun[SUN_ZONE].given || sun[SUN_YEAR].given;
    if (sun[SUN_DIRECTION].given && by_time)
        return error_set(error, ERROR_SCENE,
                         "sun excludes time and position (hour, day, latitude, longitude, zone, year)");
    if (sun[SUN_DIRECTION].given) {
        if (!(vec3_length(sun[SUN_DIRECTION].vector) > 0))
            return error_set(error, ERROR_SCENE, "sun must not be zero");
        *out = vec3_normalize(sun[SUN_DIRECTION].vector);
        return true;
    }
    const struct sky_time time = {.year = sun[SUN_YEAR].given ? (int)sun[SUN_YEAR].number : 2025,
                                  .day = sun[SUN_DAY].given ? sun[SUN_DAY].number : 172,
                                  .hour = sun[SUN_HOUR].given ? sun[SUN_HOUR].number : 12,
                                  .zone = sun[SUN_ZONE].number};
    *out = sky_sun(&time, sun[SUN_LATITUDE].given ? sun[SUN_LATITUDE].number : 45, sun[SUN_LONGITUDE].number);
    /* Nights of an animation are meant. */
    if (by_time && out->y < 0 && script_of(context)->animation.frame.number <= 1)
        context_warn_once(context, WARNED_OTHER, "the sun is below the horizon at that time: it is night");
    return true;
}

enum { CLEAR_SUN = SKY_OWN, CLEAR_TURBIDITY = CLEAR_SUN + SUN_FIELDS, CLEAR_GROUND };
static const struct script_parameter clear_sky_parameters[] = {
    SKY_FIELDS,
    SUN(CLEAR_SUN),
    [CLEAR_TURBIDITY] = {"turbidity", KIND_NUMBER, OPTIONAL, IN_RANGE(1.7, 10), NULL, "2.5",
                         "Turbidity of the air: 2 is very clear, 10 is hazy."},
    [CLEAR_GROUND] = {"ground", KIND_COLOUR, OPTIONAL | OR_DISPLAY, ANY, NULL, "{0.15, 0.15, 0.15}",
                      "Colour below the horizon."},
};

static bool gr_clear_sky(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    struct vec3 sun;
    struct sky sky;
    if (!find_sun(context, &args[CLEAR_SUN], &sun, error))
        return false;
    sky_make_clear(sun, args[CLEAR_TURBIDITY].given ? args[CLEAR_TURBIDITY].number : 2.5,
                   args[CLEAR_GROUND].given ? args[CLEAR_GROUND].colour : colour_all(0.15), &sky);
    sky.display = args[CLEAR_GROUND].display;
    return give_sky(context, &sky, args, result, error);
}

enum { SUNLIGHT_SUN = LIGHT_EXCLUDE + 1 };
static const struct script_parameter sun_light_parameters[] = {
    LIGHT_FIELDS(0),
    SUN(SUNLIGHT_SUN),
};

static bool gr_sun_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    struct script_value distant[DISTANT_COUNT];
    if (!find_sun(context, &args[SUNLIGHT_SUN], &distant[DISTANT_DIRECTION].vector, error))
        return false;
    for (int i = 0; i < DISTANT_DIRECTION; i++)
        distant[i] = args[i];
    distant[DISTANT_DIRECTION].vector = vec3_negate(distant[DISTANT_DIRECTION].vector);
    return gr_directional_light(context, distant, result, error);
}

/* Fogs. */

static bool give_fog(struct script_context *context, struct fog *fog, const struct script_value *args,
                     struct script_result *result, struct error *error) {
    struct fog *kept = arena_alloc(&context->scene.arena, sizeof *kept);
    if (!kept)
        return error_no_memory(error, "a fog");
    fog->colour = args[FOG_COLOUR].given ? args[FOG_COLOUR].colour : colour_all(0.5);
    fog->display = args[FOG_COLOUR].display;
    fog->clear_sky = args[FOG_CLEAR_SKY].boolean;
    *kept = *fog;
    result->pointer = kept;
    return true;
}

enum { FOG_AMOUNT = FOG_OWN, FOG_IS_SQUARED };
static const struct script_parameter fog_parameters[] = {
    FOG_FIELDS,
    FOG_DENSITY("Transmittance over distance d is exp(-density d)."),
    [FOG_IS_SQUARED] = {"squared", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                        "Transmittance is exp(-(density d)^2) instead."},
};

static bool gr_fog(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    struct fog fog = {.kind = args[FOG_IS_SQUARED].boolean ? FOG_SQUARED : FOG_EXPONENTIAL,
                      .density = args[FOG_AMOUNT].number};
    return give_fog(context, &fog, args, result, error);
}

enum { FOG_NEAR = FOG_OWN, FOG_FAR };
static const struct script_parameter linear_fog_parameters[] = {
    FOG_FIELDS,
    [FOG_NEAR] = {"near", KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "0", "Distance where the fog begins."},
    [FOG_FAR] = {"far", KIND_NUMBER, LOW_OPEN, ABOVE(0), NULL, NULL, "Distance where the transmittance is 0."},
};

static bool gr_linear_fog(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    struct fog fog = {.kind = FOG_LINEAR, .near = args[FOG_NEAR].number, .far = args[FOG_FAR].number};
    if (fog.near > fog.far)
        return error_set(error, ERROR_SCENE, "near must be at most far");
    return give_fog(context, &fog, args, result, error);
}

enum { FOG_BASE = FOG_AMOUNT + 1, FOG_SCALE };
static const struct script_parameter height_fog_parameters[] = {
    FOG_FIELDS,
    FOG_DENSITY("Density at the base."),
    [FOG_BASE] = {"base", KIND_NUMBER, OPTIONAL, ANY, NULL, "0", "Height y of the base."},
    [FOG_SCALE] = {"scale", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1",
                   "Height over which the density falls by the factor e."},
};

static bool gr_height_fog(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    struct fog fog = {.kind = FOG_HEIGHT,
                      .density = args[FOG_AMOUNT].number,
                      .base = args[FOG_BASE].number,
                      .scale = args[FOG_SCALE].given ? args[FOG_SCALE].number : 1};
    return give_fog(context, &fog, args, result, error);
}

enum { FOG_PROFILE_TABLE = FOG_OWN };
static const struct script_parameter fog_profile_parameters[] = {
    FOG_FIELDS,
    [FOG_PROFILE_TABLE] = {"profile", KIND_PAIRS, 0, ANY, NULL, NULL,
                           "Densities by height, {y, density}; linear between the entries, constant beyond them."},
};

enum { FOG_CORNER = FOG_OWN, FOG_SIZE, FOG_CELLS, FOG_DENSITIES };
enum { FOG_FIELD_DENSITY = FOG_SIZE + 1 }; /* after FOG_CORNER and FOG_SIZE */
static const struct script_parameter fog_field_parameters[] = {
    [FOG_COLOUR] = {"colour", KIND_COLOUR, OPTIONAL | OR_DISPLAY | OR_FUNCTION, ANY, NULL, "{0.5, 0.5, 0.5}",
                    "Its colour, or a function f(p, s) of the point, s.view and s.time."},
    FOG_CLEAR_SKY_FIELD,
    [FOG_CORNER] = {"corner", KIND_POINT, 0, ANY, NULL, NULL, "The corner with the smallest coordinates."},
    [FOG_SIZE] = {"size", KIND_SIZE, LOW_OPEN, ABOVE(0), NULL, NULL, "Length of the edges, one number or three."},
    [FOG_FIELD_DENSITY] = {"density", KIND_FUNCTION, 0, ANY, NULL, NULL,
                           "A function f(p, s) of the point and s.time; it returns a number of at least 0."},
};

static bool gr_fog_profile(struct script_context *context, const struct script_value *args,
                           struct script_result *result, struct error *error) {
    const struct script_value *table = &args[FOG_PROFILE_TABLE];
    uint32_t count = table->count;
    if (count == 0)
        return error_set(error, ERROR_SCENE, "profile must not be empty");
    double *rows = arena_alloc_array(&context->scene.arena, count, 3 * sizeof *rows);
    if (!rows)
        return error_no_memory(error, "a fog");
    double *heights = rows, *densities = rows + count, *sums = rows + 2 * (size_t)count;
    for (uint32_t i = 0; i < count; i++) {
        if (table->pairs[i][1] < 0)
            return error_set(error, ERROR_SCENE, "profile[%u][2] must be >= 0, it is a density", i + 1);
        if (i > 0 && table->pairs[i][0] < table->pairs[i - 1][0])
            return error_set(error, ERROR_SCENE, "profile[%u][1] must be at least the height before it", i + 1);
        heights[i] = table->pairs[i][0];
        densities[i] = table->pairs[i][1];
        sums[i] = i == 0 ? 0 : sums[i - 1] + (heights[i] - heights[i - 1]) * 0.5 * (densities[i] + densities[i - 1]);
    }
    struct fog fog = {.kind = FOG_PROFILE, .count = count, .heights = heights, .densities = densities, .sums = sums};
    return give_fog(context, &fog, args, result, error);
}

static const struct script_parameter fog_grid_parameters[] = {
    FOG_FIELDS,
    [FOG_CORNER] = {"corner", KIND_POINT, 0, ANY, NULL, NULL, "The corner with the smallest coordinates."},
    [FOG_SIZE] = {"size", KIND_SIZE, LOW_OPEN, ABOVE(0), NULL, NULL, "Length of the edges, one number or three."},
    [FOG_CELLS] = {"cells", KIND_TRIPLE, 0, 1, 1024, NULL, NULL, NULL, "Number of cells along x, y and z."},
    [FOG_DENSITIES] = {"densities", KIND_NUMBERS, 0, ABOVE(0), NULL, NULL,
                       "Density of each cell; x varies fastest, then y, then z."},
};

static bool gr_fog_grid(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    struct vec3 cells = args[FOG_CELLS].vector;
    struct fog fog = {.kind = FOG_GRID, .corner = args[FOG_CORNER].vector, .size = args[FOG_SIZE].vector};
    uint64_t count = 1;
    for (int axis = 0; axis < 3; axis++) {
        double n = vec3_get(cells, axis);
        if (n != (double)(uint32_t)n)
            return error_set(error, ERROR_SCENE, "cells[%d] must be a whole number", axis + 1);
        fog.cells[axis] = (uint32_t)n;
        count *= fog.cells[axis];
    }
    bool one = args[FOG_DENSITIES].single;
    if (!one && args[FOG_DENSITIES].count != count)
        return error_set(error, ERROR_SCENE, "densities must have %llu numbers, one for each cell, not %u",
                         (unsigned long long)count, args[FOG_DENSITIES].count);
    double *densities = arena_alloc_array(&context->scene.arena, (size_t)count, sizeof *densities);
    if (!densities)
        return error_no_memory(error, "a fog");
    for (uint64_t i = 0; i < count; i++)
        densities[i] = args[FOG_DENSITIES].numbers[one ? 0 : i];
    fog.densities = densities;
    return give_fog(context, &fog, args, result, error);
}

static bool gr_fog_field(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    const struct script_value *colour = &args[FOG_COLOUR];
    const struct fog_field_input in = {.density = args[FOG_FIELD_DENSITY].program,
                                       .source = args[FOG_FIELD_DENSITY].source,
                                       .colour = colour->program,
                                       .corner = args[FOG_CORNER].vector,
                                       .size = args[FOG_SIZE].vector};
    struct fog fog = {.kind = FOG_FIELD, .field = fog_field_build(&context->scene.arena, &in, error)};
    const struct box bounds = {in.corner, vec3_add(in.corner, in.size)};
    record_use(&context->sandbox, in.density, &bounds);
    if (in.colour)
        record_use(&context->sandbox, in.colour, &bounds);
    if (!fog.field || !give_fog(context, &fog, args, result, error))
        return false;
    if (colour->program)
        ((struct fog *)result->pointer)->colour = colour_all(fog_field_brightest(fog.field));
    return true;
}

static const struct script_function environment_rows[] = {
    GR("sun_light", sun_light_parameters, RESULT_LIGHT, gr_sun_light,
       "A directional light from the position of the sun.", "sun colour"),
    GR("sky_faces", sky_faces_parameters, RESULT_SKY, gr_sky_faces,
       "A sky of six pictures on a cube: front is +z, right is -x, back is -z, left is +x.",
       "front right back left top bottom"),
    GR("sky_cross", sky_cross_parameters, RESULT_SKY, gr_sky_cross, "A sky from a 4 x 3 cross of images.", "image"),
    GR("sky_map", sky_map_parameters, RESULT_SKY, gr_sky_map, "A sky from one picture of the whole sphere.", "image"),
    GR("sky_gradient", sky_gradient_parameters, RESULT_SKY, gr_sky_gradient, "A sky with colours by height.", "stops"),
    GR("sky_function", sky_function_parameters, RESULT_SKY, gr_sky_function,
       "A sky whose colour is a function of the direction.", "f"),
    GR("clear_sky", clear_sky_parameters, RESULT_SKY, gr_clear_sky,
       "The clear sky model of Preetham, Shirley and Smits (1999).", "sun turbidity?"),

    GR("uniform_fog", fog_parameters, RESULT_FOG, gr_fog, "Fog of constant density.", "density colour?"),
    GR("linear_fog", linear_fog_parameters, RESULT_FOG, gr_linear_fog,
       "Fog whose transmittance falls linearly with distance.", "near far colour?"),
    GR("height_fog", height_fog_parameters, RESULT_FOG, gr_height_fog,
       "Fog whose density falls exponentially with height.", "density base scale colour?"),
    GR("fog_profile", fog_profile_parameters, RESULT_FOG, gr_fog_profile, "Fog with a density by height.",
       "profile colour?"),
    GR("fog_grid", fog_grid_parameters, RESULT_FOG, gr_fog_grid, "Fog in the cells of a box; no fog outside.",
       "corner size cells densities colour?"),
    GR("fog_field", fog_field_parameters, RESULT_FOG, gr_fog_field,
       "Fog in a box whose density is a function of the point; no fog outside.", "corner size density colour?"),
};
const struct function_rows environment_functions = {environment_rows, COUNT(environment_rows)};
