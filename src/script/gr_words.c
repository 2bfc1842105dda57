/* Short words for light and materials. Their rows are here, so that arguments are checked and documented as those of
 * all functions; lua/words.lua makes the result of other functions of gr. Only the position of the sun is computed
 * here. */
#include "script/gr_words_internal.h"

#include "call/arguments.h"
#include "call/context.h"
#include "material/metals.h"
#include "script/gr_materials_internal.h"
#include "script/rows_internal.h"
#include "script/script_internal.h"
#include "settings/setting.h"

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

static const struct script_parameter daylight_parameters[] = {
    {"sun", KIND_DIRECTION, OPTIONAL | OR_COMPASS, ANY, NULL, "{azimuth = 140, elevation = 40}",
     "Direction to the sun: azimuth from north over east, elevation above the horizon; -z is north."},
    {"place", KIND_TEXT, OPTIONAL | OR_PAIR, ANY, NULL, NULL,
     "Instead of sun: a city, or {latitude, longitude} in degrees, north and east positive."},
    {"time", KIND_NUMBERS, OPTIONAL, ANY, NULL, "{2025, 6, 21, 15, 0}",
     "With place: {year, month, day, hour, minute} of the clock there."},
    {"zone", KIND_NUMBER, OPTIONAL, IN_RANGE(-14, 14), "hours", "that of place, without summer time",
     "Difference of that clock to Greenwich; positive is east."},
    {"turbidity", KIND_NUMBER, OPTIONAL, IN_RANGE(1.7, 10), NULL, "2.5",
     "Turbidity of the air: 2 is very clear, 10 is hazy."},
    {"ground", KIND_COLOUR, OPTIONAL | OR_DISPLAY, ANY, NULL, "{0.15, 0.15, 0.15}", "Colour below the horizon."},
    FACTOR("intensity", "Factor of all light; with the default exposure it has no effect."),
};

static const struct script_parameter mirror_parameters[] = {COLOUR("{0.95, 0.95, 0.95}", "Colour of the reflection."),
                                                            ROUGHNESS("0")};
static const struct script_parameter glass_parameters[] = {
    {"colour", KIND_COLOUR, OPTIONAL | OR_DISPLAY, ABOVE(0), NULL, "{1, 1, 1}", "Colour of white light after depth."},
    ROUGHNESS("0"),
    {"ior", KIND_NUMBER, OPTIONAL, IN_RANGE(1, 4), NULL, "1.5", "Index of refraction."},
    {"depth", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), NULL, "1", "Distance inside after which light has colour."},
    {"thin", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false", "Whether the surface is a pane: nothing is inside."},
    GLASS_FIELD,
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

/* The direction to the sun, three numbers, of year, day of the year, hour, zone, latitude and longitude. */
static int sun_direction(lua_State *L) {
    struct script_context *context = context_of(L);
    const struct sky_time time = {.year = (int)lua_tointeger(L, 1),
                                  .day = lua_tonumber(L, 2),
                                  .hour = lua_tonumber(L, 3),
                                  .zone = lua_tonumber(L, 4)};
    struct vec3 sun = sky_sun(&time, lua_tonumber(L, 5), lua_tonumber(L, 6));
    if (sun.y < 0 && script_of(context)->animation.frame.number <= 1)
        context_warn_once(context, WARNED_OTHER, "the sun is below the horizon at that time: it is night");
    for (int i = 0; i < 3; i++)
        lua_pushnumber(L, vec3_get(sun, i));
    return 3;
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

int words_answer(lua_State *L, const struct script_function *function) {
    const struct script_options *options = sandbox_of(L)->options;
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
    lua_pushcfunction(L, sun_direction);
    const int integrator = SETTING_INDEX(integrator);
    lua_pushstring(L, script_option_given(options, integrator) ? options->given[integrator] : NULL);
    lua_call(L, 3, 1);
    return 1;
}

#define WORD(name, parameters, result, help, form, passes)                                                             \
    { name, OWNER_GR, parameters, COUNT(parameters), {form}, result, check_only, help, true, passes }

static const struct script_function rows[] = {
    WORD("mirror", mirror_parameters, RESULT_MATERIAL, "A mirror.", "colour? roughness?", NULL),
    WORD("glass", glass_parameters, RESULT_MATERIAL, "Clear, tinted or frosted glass.", "colour? roughness?", NULL),
    WORD("metal", metal_parameters, RESULT_MATERIAL, "A metal by its name or its colour.", "metal? roughness?", NULL),
    WORD("plastic", plastic_parameters, RESULT_MATERIAL, "Glossy or dull plastic.", "colour? roughness?", NULL),
    WORD("paint", paint_parameters, RESULT_MATERIAL, "Paint, matt to glossy, or that of a car.", "colour? finish?",
         NULL),
    WORD("cloth", cloth_parameters, RESULT_MATERIAL, "Cotton, velvet or silk.", "colour? weave?", NULL),
    WORD("studio", studio_parameters, RESULT_NOTHING,
         "The fields for gr.render of a picture in a studio: a sweep, three area lights, and a camera that fits; all "
         "other fields of gr.render are added.",
         "node", &render_functions),
    WORD("daylight", daylight_parameters, RESULT_NOTHING,
         "The fields for gr.render of a picture in daylight: the sun with its disc, the clear sky, and exposure; all "
         "other fields of gr.render are added.",
         "sun?", &render_functions),
};
const struct function_rows word_functions = {rows, COUNT(rows)};
