/* Skies, and the light of the sun. */
#include "call/context.h"
#include "material/fog_field.h"
#include "math/elementary.h"
#include "record/record_bounds.h"
#include "script/bindings_internal.h"

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

bool gr_sky_faces(struct script_context *context, const struct script_value *args, struct script_result *result,
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

bool gr_sky_cross(struct script_context *context, const struct script_value *args, struct script_result *result,
                  struct error *error) {
    struct image *image = gr_find_image(context, &args[CROSS_IMAGE], error);
    struct sky sky;
    return image && sky_from_cross(image, args[CROSS_MIRROR].boolean, &sky, error) &&
           give_sky(context, &sky, args, result, error);
}

bool gr_sky_map(struct script_context *context, const struct script_value *args, struct script_result *result,
                struct error *error) {
    struct sky sky = {.kind = SKY_MAP, .image = gr_find_image(context, &args[MAP_IMAGE], error)};
    return sky.image && give_sky(context, &sky, args, result, error);
}

bool gr_sky_gradient(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
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

bool gr_sky_function(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
    struct sky sky;
    return sky_from_function(args[SKYFUNCTION_F].program, &sky, error) && give_sky(context, &sky, args, result, error);
}

/* The unit direction to the sun, from a direction or from time and geographic position. `sun` points to the first of
 * the fields. */
static bool find_sun(const struct script_value *sun, struct vec3 *out, struct error *error) {
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
    return true;
}

bool gr_clear_sky(struct script_context *context, const struct script_value *args, struct script_result *result,
                  struct error *error) {
    struct vec3 sun;
    struct sky sky;
    if (!find_sun(&args[CLEAR_SUN], &sun, error))
        return false;
    sky_make_clear(sun, args[CLEAR_TURBIDITY].given ? args[CLEAR_TURBIDITY].number : 2.5,
                   args[CLEAR_GROUND].given ? args[CLEAR_GROUND].vector : vec3_all(0.15), &sky);
    sky.display = args[CLEAR_GROUND].display;
    return give_sky(context, &sky, args, result, error);
}

bool gr_sun_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                  struct error *error) {
    struct script_value distant[DISTANT_COUNT];
    if (!find_sun(&args[SUNLIGHT_SUN], &distant[DISTANT_DIRECTION].vector, error))
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
    fog->colour = args[FOG_COLOUR].given ? args[FOG_COLOUR].vector : vec3_all(0.5);
    fog->display = args[FOG_COLOUR].display;
    fog->clear_sky = args[FOG_CLEAR_SKY].boolean;
    *kept = *fog;
    result->pointer = kept;
    return true;
}

bool gr_fog(struct script_context *context, const struct script_value *args, struct script_result *result,
            struct error *error) {
    struct fog fog = {.kind = args[FOG_IS_SQUARED].boolean ? FOG_SQUARED : FOG_EXPONENTIAL,
                      .density = args[FOG_AMOUNT].number};
    return give_fog(context, &fog, args, result, error);
}

bool gr_linear_fog(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    struct fog fog = {.kind = FOG_LINEAR, .near = args[FOG_NEAR].number, .far = args[FOG_FAR].number};
    if (fog.near > fog.far)
        return error_set(error, ERROR_SCENE, "near must be at most far");
    return give_fog(context, &fog, args, result, error);
}

bool gr_height_fog(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    struct fog fog = {.kind = FOG_HEIGHT,
                      .density = args[FOG_AMOUNT].number,
                      .base = args[FOG_BASE].number,
                      .scale = args[FOG_SCALE].given ? args[FOG_SCALE].number : 1};
    return give_fog(context, &fog, args, result, error);
}

bool gr_fog_profile(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
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

bool gr_fog_grid(struct script_context *context, const struct script_value *args, struct script_result *result,
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

bool gr_fog_field(struct script_context *context, const struct script_value *args, struct script_result *result,
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
        ((struct fog *)result->pointer)->colour = vec3_all(fog_field_brightest(fog.field));
    return true;
}
