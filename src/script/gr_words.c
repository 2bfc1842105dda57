/* Short words for light and materials. Their rows are here, so that arguments are checked and documented as those of
 * all functions; lua/words.lua makes the result of other functions of gr. Only the position of the sun is computed
 * here. */
#include "script/gr_words_internal.h"

#include "call/arguments.h"
#include "call/context.h"
#include "material/metals.h"
#include "script/rows_internal.h"
#include "script/script_internal.h"

#include <lauxlib.h>

#define COLOUR(otherwise, help)                                                                                        \
    { "colour", KIND_COLOUR, OPTIONAL | OR_TEXTURE, ABOVE(0), NULL, otherwise, help }
#define ROUGHNESS(otherwise)                                                                                           \
    { "roughness", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, otherwise, "Roughness; 0 is polished." }
#define FACTOR(name, help)                                                                                             \
    { name, KIND_NUMBER, OPTIONAL, ABOVE(0), NULL, "1", help }

static const struct script_parameter studio_parameters[] = {
    {"node", KIND_NODE, 0, ANY, NULL, NULL, "What the picture shows; it stands on the floor."},
    {"sweep", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "true", "Whether there is a floor that bends up into a wall."},
    {"floor", KIND_COLOUR, OPTIONAL | OR_TEXTURE, ABOVE(0), NULL, "{0.6, 0.6, 0.6}", "Colour of floor and wall."},
    FACTOR("intensity", "Factor of all light."),
    FACTOR("key", "Factor of the large light from the left above."),
    FACTOR("fill", "Factor of the light from the right."),
    FACTOR("rim", "Factor of the light from behind."),
    {"turn", KIND_NUMBER, OPTIONAL, ANY, "degrees", "0", "Rotation of the lights about the vertical, to the right."},
};

/* Cities with latitude, longitude and time zone, without summer time. */
#define CITIES(X)                                                                                                      \
    X("berlin", 52.52, 13.40, 1)                                                                                       \
    X("cairo", 30.04, 31.24, 2)                                                                                        \
    X("cape_town", -33.92, 18.42, 2)                                                                                   \
    X("delhi", 28.61, 77.21, 5.5)                                                                                      \
    X("london", 51.51, -0.13, 0)                                                                                       \
    X("los_angeles", 34.05, -118.24, -8)                                                                               \
    X("moscow", 55.76, 37.62, 3)                                                                                       \
    X("nairobi", -1.29, 36.82, 3)                                                                                      \
    X("new_york", 40.71, -74.01, -5)                                                                                   \
    X("oslo", 59.91, 10.75, 1)                                                                                         \
    X("paris", 48.86, 2.35, 1)                                                                                         \
    X("rome", 41.90, 12.50, 1)                                                                                         \
    X("sao_paulo", -23.55, -46.63, -3)                                                                                 \
    X("singapore", 1.35, 103.82, 8)                                                                                    \
    X("sydney", -33.87, 151.21, 10)                                                                                    \
    X("tokyo", 35.68, 139.69, 9)
#define CITY_WORD(name, ...) " " name
#define CITY_NUMBERS(name, latitude, longitude, zone) {latitude, longitude, zone},

enum { DAY_SUN, DAY_CITY, DAY_TIME, DAY_ZONE, DAY_TURBIDITY, DAY_GROUND, DAY_INTENSITY };
static const struct script_parameter daylight_parameters[] = {
    [DAY_SUN] = {"sun", KIND_DIRECTION, OPTIONAL | OR_COMPASS, ANY, NULL, "{azimuth = 140, elevation = 40}",
                 "Direction to the sun: azimuth from north over east, elevation above the horizon; -z is north."},
    [DAY_CITY] = {"place", KIND_CHOICE, OPTIONAL | OR_PAIR, 0, 0, &(CITIES(CITY_WORD))[1], NULL, NULL,
                  "Instead of sun: a city, or {latitude, longitude} in degrees, north and east positive."},
    [DAY_TIME] = {"time", KIND_NUMBERS, OPTIONAL, ANY, NULL, "{2025, 6, 21, 15, 0}",
                  "With place: {year, month, day, hour, minute} of the clock there."},
    [DAY_ZONE] = {"zone", KIND_NUMBER, OPTIONAL, IN_RANGE(-14, 14), "hours", "that of place, without summer time",
                  "Difference of that clock to Greenwich; positive is east."},
    [DAY_TURBIDITY] = {"turbidity", KIND_NUMBER, OPTIONAL, IN_RANGE(1.7, 10), NULL, "2.5",
                       "Turbidity of the air: 2 is very clear, 10 is hazy."},
    [DAY_GROUND] = {"ground", KIND_COLOUR, OPTIONAL | OR_DISPLAY, ANY, NULL, "{0.15, 0.15, 0.15}",
                    "Colour below the horizon."},
    [DAY_INTENSITY] = FACTOR("intensity", "Factor of all light; with the default exposure it has no effect."),
};

static const struct script_parameter mirror_parameters[] = {COLOUR("{0.95, 0.95, 0.95}", "Colour of the reflection."),
                                                            ROUGHNESS("0")};
static const struct script_parameter glass_parameters[] = {
    {"colour", KIND_COLOUR, OPTIONAL | OR_DISPLAY, ABOVE(0), NULL, "{1, 1, 1}", "Colour of white light after depth."},
    ROUGHNESS("0"),
    {"ior", KIND_NUMBER, OPTIONAL, IN_RANGE(1, 4), NULL, "1.5", "Index of refraction."},
    {"depth", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1", "Distance inside after which light has colour."},
    {"thin", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the surface is a pane: nothing is inside."},
};
#define METAL_WORD(name, ...) " " name
static const struct script_parameter metal_parameters[] = {
    {"metal", KIND_CHOICE, OPTIONAL, 0, 0, &(METALS(METAL_WORD))[1], NULL, "'aluminium'", "Its name."},
    ROUGHNESS("0.15"),
    COLOUR(NULL, "Reflectance at normal incidence, instead of metal."),
    {"brushed", KIND_NUMBER, OPTIONAL | OR_TEXTURE, IN_RANGE(0, 1), NULL, "0",
     "How much smoother it is along the texture coordinate u, as after brushing."},
};
static const struct script_parameter plastic_parameters[] = {COLOUR("{0.8, 0.8, 0.8}", "Its colour."),
                                                             ROUGHNESS("0.15")};
static const struct script_parameter paint_parameters[] = {
    COLOUR("{0.8, 0.8, 0.8}", "Its colour."),
    {"finish", KIND_CHOICE, OPTIONAL, 0, 0, "matt satin gloss car", NULL, "'satin'",
     "Its gloss; car: metal flakes below a clear coat."},
};
static const struct script_parameter cloth_parameters[] = {
    COLOUR("{0.8, 0.8, 0.8}", "Its colour."),
    {"weave", KIND_CHOICE, OPTIONAL, 0, 0, "cotton velvet silk", NULL, "'cotton'", "The kind of cloth."},
};

/* The Lua function has the arguments; nothing is left to do. */
static bool check_only(struct script_context *context, const struct script_value *args, struct script_result *result,
                       struct error *error) {
    (void)context;
    (void)args;
    (void)result;
    (void)error;
    return true;
}

/* {year, month, day, hour, minute} as a time of the sky. */
static bool read_time(const struct script_value *time, struct sky_time *out, struct error *error) {
    static const char *const names[] = {"year", "month", "day", "hour", "minute"};
    static const double low[] = {1901, 1, 1, 0, 0}, usual[] = {2025, 6, 21, 15, 0};
    double high[] = {2099, 12, 31, 24, 60}, t[5];
    int day = 0;
    if (time->given && (time->single || time->count < 3 || time->count > 5))
        return error_set(error, ERROR_SCENE, "time must be {year, month, day, hour, minute}");
    for (uint32_t i = 0; i < 5; i++)
        t[i] = !time->given ? usual[i] : i < time->count ? time->numbers[i] : i == 3 ? 12 : 0;
    for (int month = 1; month <= 12; month++) {
        bool leap = (int)t[0] % 4 == 0; /* in this and the last century */
        int days = month == 2 ? 28 + leap : 30 + (month + (month > 7)) % 2;
        if (month == (int)t[1])
            high[2] = days;
        day += month < (int)t[1] ? days : 0;
    }
    for (int i = 0; i < 5; i++) {
        if (t[i] < low[i] || t[i] > high[i] || (i < 3 && t[i] != floor(t[i])))
            return error_set(error, ERROR_SCENE, "time[%d], the %s, must be a %snumber from %g to %g", i + 1, names[i],
                             i < 3 ? "whole " : "", low[i], high[i]);
    }
    *out = (struct sky_time){.year = (int)t[0], .day = day + t[2], .hour = t[3] + t[4] / 60};
    return true;
}

/* The direction to the sun. */
static bool gr_daylight(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    static const double cities[][3] = {CITIES(CITY_NUMBERS)};
    static const struct vec3 usual = {0.49240387650610398, 0.64278760968653936, 0.58682408883346515};
    const struct script_value *city = &args[DAY_CITY];
    struct vec3 *sun = arena_alloc(&context->sandbox.call, sizeof *sun);
    struct sky_time time;
    result->pointer = sun;
    if (!sun)
        return error_no_memory(error, "a sky");
    if (args[DAY_SUN].given && (city->given || args[DAY_TIME].given || args[DAY_ZONE].given))
        return error_set(error, ERROR_SCENE, "sun excludes place, time and zone");
    if (args[DAY_SUN].given && !(vec3_length(args[DAY_SUN].vector) > 0))
        return error_set(error, ERROR_SCENE, "sun must not be zero");
    *sun = args[DAY_SUN].given ? vec3_normalize(args[DAY_SUN].vector) : usual;
    if (!city->given)
        return !(args[DAY_TIME].given || args[DAY_ZONE].given) ||
               error_set(error, ERROR_SCENE, "time and zone need place");
    const double *known = cities[city->count == 2 ? 0 : city->choice];
    double latitude = city->count == 2 ? city->vector.x : known[0];
    double longitude = city->count == 2 ? city->vector.y : known[1];
    if (fabs(latitude) > 90 || fabs(longitude) > 180)
        return error_set(error, ERROR_SCENE, "place must be {latitude, longitude}, at most 90 and 180 degrees");
    if (!read_time(&args[DAY_TIME], &time, error))
        return false;
    time.zone = args[DAY_ZONE].given ? args[DAY_ZONE].number
                : city->count == 2   ? floor(longitude / 15 + 0.5)
                                     : known[2];
    *sun = sky_sun(&time, latitude, longitude);
    if (sun->y < 0 && script_of(context)->animation.frame.number <= 1)
        context_warn_once(context, WARNED_OTHER, "the sun is below the horizon at that time: it is night");
    return true;
}

/* Pushes the table of functions, which is made by the first call. */
static void push_words(lua_State *L) {
    static const char key = 0;
    struct sandbox *sandbox = sandbox_of(L);
    const char *folder = sandbox->options->library_folder;
    if (lua_rawgetp(L, LUA_REGISTRYINDEX, &key) == LUA_TTABLE)
        return;
    const char *path = folder ? arena_format(&sandbox->keep, "%s/words.lua", folder) : NULL;
    if (!path)
        sandbox_raise(sandbox, "it is a part of the Lua library, which is not installed");
    if (files_load(L, path) != LUA_OK)
        lua_error(L);
    lua_call(L, 0, 1);
    lua_pushvalue(L, -1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &key);
}

int words_answer(lua_State *L, const struct script_function *function, const struct script_result *result) {
    struct sandbox *sandbox = sandbox_of(L);
    int count = lua_gettop(L), parameter;
    bool named = arguments_have_names(L, function, 1, count), optional;
    luaL_checkstack(L, 10, NULL);
    if (named) {
        lua_pushvalue(L, 1);
    } else {
        const char *form = function->forms[0];
        lua_newtable(L);
        for (int i = 1; i <= count && form_next(function, &form, &parameter, &optional); i++) {
            lua_pushvalue(L, i);
            lua_setfield(L, -2, function->parameters[parameter].name);
        }
    }
    push_words(L);
    lua_getfield(L, -1, function->name);
    lua_pushvalue(L, count + 1);
    lua_newtable(L);
    const struct vec3 *direction = result->pointer;
    for (int i = 0; direction && i < 3; i++) {
        lua_pushnumber(L, vec3_get(*direction, i));
        lua_rawseti(L, -2, i + 1);
    }
    sandbox->running.name = NULL;
    lua_call(L, 2, 1);
    return 1;
}

#define WORD(name, parameters, result, run, help, form, passes)                                                        \
    { name, OWNER_GR, parameters, COUNT(parameters), {form}, result, run, help, true, passes }

static const struct script_function rows[] = {
    WORD("mirror", mirror_parameters, RESULT_MATERIAL, check_only, "A mirror.", "colour? roughness?", NULL),
    WORD("glass", glass_parameters, RESULT_MATERIAL, check_only, "Clear, tinted or frosted glass.",
         "colour? roughness?", NULL),
    WORD("metal", metal_parameters, RESULT_MATERIAL, check_only, "A metal by its name or its colour.",
         "metal? roughness?", NULL),
    WORD("plastic", plastic_parameters, RESULT_MATERIAL, check_only, "Glossy or dull plastic.", "colour? roughness?",
         NULL),
    WORD("paint", paint_parameters, RESULT_MATERIAL, check_only, "Paint, matt to glossy, or that of a car.",
         "colour? finish?", NULL),
    WORD("cloth", cloth_parameters, RESULT_MATERIAL, check_only, "Cotton, velvet or silk.", "colour? weave?", NULL),
    WORD("studio", studio_parameters, RESULT_NOTHING, check_only,
         "The fields for gr.render of a picture in a studio: a sweep, three area lights, and a camera that fits; all "
         "other fields of gr.render are added.",
         "node", &render_functions),
    WORD("daylight", daylight_parameters, RESULT_NOTHING, gr_daylight,
         "The fields for gr.render of a picture in daylight: the sun with its disc, the clear sky, and exposure; all "
         "other fields of gr.render are added.",
         "sun?", &render_functions),
};
const struct function_rows word_functions = {rows, COUNT(rows)};
