/* Edits of the window, as calls: they are recorded, and applied to every picture that is rendered afterwards. The
 * script's own tree is not changed permanently. */
#include "script/gr_changes_internal.h"

#include "script/rows_internal.h"
#include "script/script_internal.h"

#include <lauxlib.h>
#include <math.h>
#include <string.h>

#define SERIAL_HELP "Its number in order of creation, from 0; nodes added in the window count down from 4294967295."
#define CHANGED_NAME "Name of the node; gray ignores a node with another name."
#define SERIALS IN_RANGE(0, 4294967295.0)
#define PICTURE_HELP "The file name that gr.render has for the picture."

/* gr.change_view and gr.change_exposure: of the picture of that file name. */
struct changed_view {
    const char *picture;
    bool has_camera, has_exposure;
    struct camera camera;
    double exposure;
    struct changed_view *next;
};

/* Adds an entry, set to zero. */
static struct change *note(struct script_context *context, enum change_kind kind, const char *name, double serial,
                           struct error *error) {
    struct script_changes *changes = &script_of(context)->changes;
    if (changes->count == changes->room) {
        /* The old list stays in the arena; it is at most as large as the new one. */
        uint32_t room = changes->room ? 2 * changes->room : 16;
        struct change *more =
            room <= CHANGE_LIMIT ? arena_alloc_array(&context->sandbox.keep, room, sizeof *more) : NULL;
        if (!more) {
            if (room > CHANGE_LIMIT)
                error_set(error, ERROR_SCENE, "a script makes more than %d changes", CHANGE_LIMIT);
            else
                error_no_memory(error, "the changes of the scene");
            return NULL;
        }
        if (changes->count > 0)
            memcpy(more, changes->list, changes->count * sizeof *more);
        changes->list = more;
        changes->room = room;
    }
    struct change *change = &changes->list[changes->count++];
    *change = (struct change){.kind = kind, .serial = (uint32_t)serial};
    size_t length = name ? strlen(name) : 0;
    memcpy(change->name, name ? name : "", length < sizeof change->name ? length : sizeof change->name - 1);
    return change;
}

static void put_colour(double *numbers, struct colour c) {
    numbers[0] = c.r;
    numbers[1] = c.g;
    numbers[2] = c.b;
}

static void put(double *numbers, struct vec3 v) {
    numbers[0] = v.x;
    numbers[1] = v.y;
    numbers[2] = v.z;
}

enum { CHANGENODE_NAME, CHANGENODE_SERIAL, CHANGENODE_MATRIX };
static const struct script_parameter change_node_parameters[] = {
    [CHANGENODE_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, CHANGED_NAME},
    [CHANGENODE_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
    [CHANGENODE_MATRIX] =
        {"matrix", KIND_NUMBERS, 0, ANY, NULL, NULL,
         "Three rows of a matrix, 12 numbers, applied after its own transforms, in the space of its parent."},
};

static bool gr_change_node(struct script_context *context, const struct script_value *args,
                           struct script_result *result, struct error *error) {
    (void)result;
    const struct script_value *matrix = &args[CHANGENODE_MATRIX];
    struct affine map;
    struct transform ignored;
    if (matrix->count != 12)
        return error_set(error, ERROR_SCENE, "matrix has %u numbers, not 12", matrix->count);
    memcpy(map.m, matrix->numbers, sizeof map.m);
    if (!transform_from_affine(&map, &ignored))
        return error_set(error, ERROR_SCENE, "matrix is singular: it has no inverse");
    struct change *change =
        note(context, CHANGE_TRANSFORM, args[CHANGENODE_NAME].text, args[CHANGENODE_SERIAL].number, error);
    if (change)
        memcpy(change->numbers, map.m, sizeof map.m);
    return change != NULL;
}

enum { CHANGEGONE_NAME, CHANGEGONE_SERIAL };
static const struct script_parameter change_delete_parameters[] = {
    [CHANGEGONE_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, CHANGED_NAME},
    [CHANGEGONE_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
};

static bool gr_change_delete(struct script_context *context, const struct script_value *args,
                             struct script_result *result, struct error *error) {
    (void)result;
    return note(context, CHANGE_GONE, args[CHANGEGONE_NAME].text, args[CHANGEGONE_SERIAL].number, error) != NULL;
}

/* Making what is added: a Lua call, which runs in the state of the script while a picture is made. */

struct making {
    struct script_context *context;
    const char *call;
    enum handle_type type;
    void *object;
};

static int run_call(lua_State *L) {
    struct making *making = lua_touserdata(L, 1);
    const char *text = lua_pushfstring(L, "return %s", making->call);
    if (luaL_loadbufferx(L, text, strlen(text), "=added", "t") != LUA_OK)
        return lua_error(L);
    lua_call(L, 0, 1);
    const struct handle *handle = handle_at(L, -1);
    if (!handle || handle->type != making->type)
        return luaL_error(L, "%s makes %s, not %s", making->call,
                          handle ? handle_words(handle->type) : "something else", handle_words(making->type));
    const struct script_texture *texture = handle->type == HANDLE_TEXTURE ? handle->pointer : NULL;
    making->object = texture ? (void *)(uintptr_t)texture->texture : handle->pointer;
    if (!making->object || (texture && texture->is_bump))
        return luaL_error(L, "%s makes no texture of colours", making->call);
    return 0;
}

/* The arguments of the call that renders stay: those of a call in the text are in another arena. Numbers of nodes and
 * materials of the script are not used up. */
static bool make_object(void *user, const struct change *change, void **object, struct error *error) {
    const enum handle_type type = change->kind == CHANGE_ADD         ? HANDLE_NODE
                                  : change->kind == CHANGE_ADD_LIGHT ? HANDLE_LIGHT
                                                                     : HANDLE_TEXTURE;
    struct script_context *context = user;
    struct sandbox *sandbox = &context->sandbox;
    lua_State *L = sandbox->lua;
    struct making making = {context, change->call, type, NULL};
    const struct script_function *function = context->function;
    struct running_function running = sandbox->running;
    struct arena arguments = sandbox->call;
    uint32_t nodes = context->scene.node_count, materials = context->scene.material_count;
    if (!lua_checkstack(L, 8))
        return error_no_memory(error, "an added object");
    sandbox->call = (struct arena){0};
    context->scene.node_count = ADDED_PART_SERIAL + change->number * ADDED_PARTS;
    context->scene.material_count = ADDED_MATERIAL_SERIAL + change->number * ADDED_PARTS;
    lua_pushcfunction(L, run_call);
    lua_pushlightuserdata(L, &making);
    bool ok = lua_pcall(L, 1, 0, 0) == LUA_OK;
    arena_destroy(&sandbox->call);
    sandbox->call = arguments;
    sandbox->lua = L;
    sandbox->running = running;
    context->function = function;
    context->scene.node_count = nodes;
    context->scene.material_count = materials;
    *object = making.object;
    if (sandbox->fatal.kind != ERROR_NONE)
        *error = sandbox->fatal;
    else if (!ok)
        (void)error_set(error, ERROR_SCENE, "%s", lua_tostring(L, -1) ? lua_tostring(L, -1) : "an error");
    if (!ok)
        lua_pop(L, 1);
    return ok;
}

/* While the limits of the script are paused. */
static bool make_in_window(void *user, const struct change *change, void **object, struct error *error) {
    struct script_context *context = user;
    limits_resume(&context->sandbox.limits);
    bool ok = make_object(context, change, object, error);
    limits_pause(&context->sandbox.limits);
    return ok;
}

/* The call for a word of files that earlier versions have written. */
static const char *call_of(const char *shape) {
    static const char *const words[][2] = {
        {"copy", ""},
        {"sphere", "gr.sphere{}"},
        {"cube", "gr.box{min = {-1, -1, -1}, max = {1, 1, 1}}"},
        {"cylinder", "gr.cylinder{}"},
        {"cone", "gr.cone{from = {0, -1, 0}, to = {0, 1, 0}, from_radius = 1, radius = 0}"},
        {"torus", "gr.torus{major = 0.75, minor = 0.25}"}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (strcmp(words[i][0], shape) == 0)
            return words[i][1];
    }
    return shape;
}

static bool set_call(struct change *change, const char *call, struct error *error) {
    if (strlen(call) >= sizeof change->call)
        return error_set(error, ERROR_SCENE, "the call has more than %d characters", CHANGE_CALL - 1);
    memcpy(change->call, call, strlen(call) + 1);
    return true;
}

enum { CHANGEADD_NAME, CHANGEADD_SERIAL, CHANGEADD_SHAPE, CHANGEADD_COLOUR, CHANGEADD_SOURCE };
static const struct script_parameter change_add_parameters[] = {
    [CHANGEADD_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, "Name of the parent node."},
    [CHANGEADD_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
    [CHANGEADD_SHAPE] = {"shape", KIND_TEXT, 0, ANY, NULL, NULL,
                         "The call that makes the new node, such as 'gr.torus{minor = 0.1}', or 'copy'."},
    [CHANGEADD_COLOUR] = {"colour", KIND_COLOUR, OPTIONAL, ANY, NULL, "{0.7, 0.7, 0.7}",
                          "Colour of a shape whose call gives it no material."},
    [CHANGEADD_SOURCE] = {"source", KIND_WHOLE, OPTIONAL, SERIALS, NULL, "0",
                          "For a copy: the number of the node to copy."},
};

static bool gr_change_add(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    (void)result;
    struct change *change = note(context, CHANGE_ADD, args[CHANGEADD_NAME].text, args[CHANGEADD_SERIAL].number, error);
    if (!change)
        return false;
    change->number = script_of(context)->changes.added++;
    change->source = (uint32_t)args[CHANGEADD_SOURCE].number;
    put_colour(change->numbers, args[CHANGEADD_COLOUR].given ? args[CHANGEADD_COLOUR].colour : colour_all(0.7));
    return set_call(change, call_of(args[CHANGEADD_SHAPE].text), error);
}

enum { CHANGEMATERIAL_SERIAL, CHANGEMATERIAL_COLOUR };
static const struct script_parameter change_material_parameters[] = {
    [CHANGEMATERIAL_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL,
                               "Number of the material in order of creation, from 1."},
    [CHANGEMATERIAL_COLOUR] = {"colour", KIND_COLOUR, 0, ANY, NULL, NULL, "New kd of its base material."},
};

static bool gr_change_material(struct script_context *context, const struct script_value *args,
                               struct script_result *result, struct error *error) {
    (void)result;
    struct change *change = note(context, CHANGE_MATERIAL, NULL, args[CHANGEMATERIAL_SERIAL].number, error);
    if (change)
        put_colour(change->numbers, args[CHANGEMATERIAL_COLOUR].colour);
    return change != NULL;
}

enum { CHANGELOOK_SERIAL, CHANGELOOK_PART, CHANGELOOK_VALUE };
static const struct script_parameter change_look_parameters[] = {
    [CHANGELOOK_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL,
                           "Number of the material in order of creation, from 1."},
    [CHANGELOOK_PART] = {"part", KIND_CHOICE, 0, 0, 0, LIST_BLANKS(MATERIAL_PART_LIST), NULL, NULL,
                         "Argument of gr.material to change in its base material."},
    [CHANGELOOK_VALUE] = {"value", KIND_NUMBERS, 0, ANY, NULL, NULL,
                          "New value: three numbers for a colour, else one."},
};

static bool gr_change_look(struct script_context *context, const struct script_value *args,
                           struct script_result *result, struct error *error) {
    (void)result;
    enum material_part part = (enum material_part)args[CHANGELOOK_PART].choice;
    const struct script_value *value = &args[CHANGELOOK_VALUE];
    uint32_t wanted = (uint32_t)material_part_count(part);
    double low, high;
    material_part_range(part, &low, &high);
    if (value->count != wanted)
        return error_set(error, ERROR_SCENE, "value has %u number%s, but %s has %u", value->count,
                         value->count == 1 ? "" : "s", material_part_name(part), wanted);
    for (uint32_t i = 0; i < wanted; i++) {
        if (!(value->numbers[i] >= low && value->numbers[i] <= high))
            return error_set(error, ERROR_SCENE, "value of %s must be from %g to %g, not %g", material_part_name(part),
                             low, high, value->numbers[i]);
    }
    struct change *change = note(context, CHANGE_MATERIAL, NULL, args[CHANGELOOK_SERIAL].number, error);
    if (!change)
        return false;
    change->part = part;
    memcpy(change->numbers, value->numbers, wanted * sizeof *value->numbers);
    return true;
}

enum { CHANGETEXTURE_SERIAL, CHANGETEXTURE_CALL };
static const struct script_parameter change_texture_parameters[] = {
    [CHANGETEXTURE_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL,
                              "Number of the material in order of creation, from 1."},
    [CHANGETEXTURE_CALL] = {"call", KIND_TEXT, 0, ANY, NULL, NULL,
                            "The call that makes the texture, such as 'gr.texture(\"wood.png\")'."},
};

static bool gr_change_texture(struct script_context *context, const struct script_value *args,
                              struct script_result *result, struct error *error) {
    (void)result;
    struct change *change = note(context, CHANGE_TEXTURE, NULL, args[CHANGETEXTURE_SERIAL].number, error);
    return change && set_call(change, args[CHANGETEXTURE_CALL].text, error);
}

enum { CHANGEOWN_NAME, CHANGEOWN_SERIAL, CHANGEOWN_LIKE };
static const struct script_parameter change_own_parameters[] = {
    [CHANGEOWN_NAME] = {"name", KIND_TEXT, 0, ANY, NULL, NULL, CHANGED_NAME},
    [CHANGEOWN_SERIAL] = {"serial", KIND_WHOLE, 0, SERIALS, NULL, NULL, SERIAL_HELP},
    [CHANGEOWN_LIKE] = {"like", KIND_WHOLE, OPTIONAL, SERIALS, NULL, "0",
                        "For a shape without a material: number of the material to copy; 0: plain gray."},
};

static bool gr_change_own(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    (void)result;
    struct change *change = note(context, CHANGE_OWN, args[CHANGEOWN_NAME].text, args[CHANGEOWN_SERIAL].number, error);
    if (!change)
        return false;
    change->number = script_of(context)->changes.owned++;
    change->source = (uint32_t)args[CHANGEOWN_LIKE].number;
    return true;
}

enum { CHANGELIGHT_NUMBER, CHANGELIGHT_MOVE, CHANGELIGHT_FACTOR, CHANGELIGHT_TURN, CHANGELIGHT_COLOUR };
static const struct script_parameter change_light_parameters[] = {
    [CHANGELIGHT_NUMBER] = {"number", KIND_WHOLE, 0, 1, 4294967295.0, NULL, NULL, NULL,
                            "Index in the list of lights of gr.render, from 1."},
    [CHANGELIGHT_MOVE] = {"move", KIND_TRIPLE, 0, ANY, NULL, NULL, "Translation."},
    [CHANGELIGHT_FACTOR] = {"factor", KIND_TRIPLE, OPTIONAL, ANY, NULL, "{1, 1, 1}", "Factor of its colour."},
    [CHANGELIGHT_TURN] = {"linear", KIND_NUMBERS, OPTIONAL, ANY, NULL, "none",
                          "Three rows of a matrix, 9 numbers: rotation and scale about its position."},
    [CHANGELIGHT_COLOUR] = {"colour", KIND_COLOUR, OPTIONAL, ANY, NULL, "its own", "New colour, before the factor."},
};

static bool gr_change_light(struct script_context *context, const struct script_value *args,
                            struct script_result *result, struct error *error) {
    (void)result;
    const struct script_value *turn = &args[CHANGELIGHT_TURN], *colour = &args[CHANGELIGHT_COLOUR];
    if (turn->given && turn->count != TURN_NUMBERS)
        return error_set(error, ERROR_SCENE, "linear has %u numbers, not %d", turn->count, TURN_NUMBERS);
    if (turn->given && !(fabs(light_turn_volume(turn->numbers)) > 0))
        return error_set(error, ERROR_SCENE, "linear is singular: it has no inverse");
    struct change *change = note(context, CHANGE_LIGHT, NULL, args[CHANGELIGHT_NUMBER].number, error);
    if (!change)
        return false;
    put(change->numbers, args[CHANGELIGHT_MOVE].vector);
    put_colour(change->numbers + 3, args[CHANGELIGHT_FACTOR].given ? args[CHANGELIGHT_FACTOR].colour : colour_all(1));
    change->turns = turn->given;
    change->colours = colour->given;
    if (turn->given)
        memcpy(change->numbers + TURN_AT, turn->numbers, TURN_NUMBERS * sizeof *turn->numbers);
    if (colour->given)
        put_colour(change->numbers + COLOUR_AT, colour->colour);
    return true;
}

enum { CHANGEDARK_NUMBER };
static const struct script_parameter change_delete_light_parameters[] = {
    [CHANGEDARK_NUMBER] = {"number", KIND_WHOLE, 0, 1, 4294967295.0, NULL, NULL, NULL,
                           "Index in the list of lights of gr.render, from 1."},
};

static bool gr_change_delete_light(struct script_context *context, const struct script_value *args,
                                   struct script_result *result, struct error *error) {
    (void)result;
    return note(context, CHANGE_DARK, NULL, args[CHANGEDARK_NUMBER].number, error) != NULL;
}

enum { CHANGENEWLIGHT_POSITION, CHANGENEWLIGHT_COLOUR, CHANGENEWLIGHT_CALL };
#define PLAIN_LIGHT "gr.light{position = {0, 0, 0}, colour = {1, 1, 1}}"
static const struct script_parameter change_add_light_parameters[] = {
    [CHANGENEWLIGHT_POSITION] = {"position", KIND_POINT, 0, ANY, NULL, NULL, "Translation of the light."},
    [CHANGENEWLIGHT_COLOUR] = {"colour", KIND_COLOUR, 0, ANY, NULL, NULL, "Factor of its colour."},
    [CHANGENEWLIGHT_CALL] = {"call", KIND_TEXT, OPTIONAL, ANY, NULL, "a white point light at the origin",
                             "The call that makes it, such as 'gr.spot_light{...}'."},
};

static bool gr_change_add_light(struct script_context *context, const struct script_value *args,
                                struct script_result *result, struct error *error) {
    (void)result;
    struct change *change = note(context, CHANGE_ADD_LIGHT, NULL, 0, error);
    if (!change)
        return false;
    put(change->numbers, args[CHANGENEWLIGHT_POSITION].vector);
    put_colour(change->numbers + 3, args[CHANGENEWLIGHT_COLOUR].colour);
    return set_call(change, args[CHANGENEWLIGHT_CALL].given ? args[CHANGENEWLIGHT_CALL].text : PLAIN_LIGHT, error);
}

enum { CHANGECOPYLIGHT_NUMBER, CHANGECOPYLIGHT_MOVE, CHANGECOPYLIGHT_FACTOR };
static const struct script_parameter change_copy_light_parameters[] = {
    [CHANGECOPYLIGHT_NUMBER] = {"number", KIND_WHOLE, 0, 1, 4294967295.0, NULL, NULL, NULL,
                                "Index in the list of lights of gr.render, from 1."},
    [CHANGECOPYLIGHT_MOVE] = {"move", KIND_TRIPLE, 0, ANY, NULL, NULL, "Translation of the copy."},
    [CHANGECOPYLIGHT_FACTOR] = {"factor", KIND_TRIPLE, OPTIONAL, ANY, NULL, "{1, 1, 1}",
                                "Factor of the colour of the copy."},
};

static bool gr_change_copy_light(struct script_context *context, const struct script_value *args,
                                 struct script_result *result, struct error *error) {
    const struct script_value *factor = &args[CHANGECOPYLIGHT_FACTOR];
    (void)result;
    struct change *change = note(context, CHANGE_ADD_LIGHT, NULL, 0, error);
    if (!change)
        return false;
    change->source = (uint32_t)args[CHANGECOPYLIGHT_NUMBER].number;
    put(change->numbers, args[CHANGECOPYLIGHT_MOVE].vector);
    put_colour(change->numbers + 3, factor->given ? factor->colour : colour_all(1));
    return true;
}

static struct changed_view *note_view(struct script_context *context, const char *picture, struct error *error) {
    struct changed_view *view = arena_alloc(&context->sandbox.keep, sizeof *view);
    const char *name = arena_copy_text(&context->sandbox.keep, picture, strlen(picture));
    if (!view || !name) {
        error_no_memory(error, "the changes of the scene");
        return NULL;
    }
    *view = (struct changed_view){.picture = name, .next = script_of(context)->changes.views};
    script_of(context)->changes.views = view;
    return view;
}

enum { CHANGEVIEW_PICTURE, CHANGEVIEW_EYE, CHANGEVIEW_VIEW, CHANGEVIEW_UP, CHANGEVIEW_FOV };
static const struct script_parameter change_view_parameters[] = {
    [CHANGEVIEW_PICTURE] = {"picture", KIND_TEXT, 0, ANY, NULL, NULL, PICTURE_HELP},
    [CHANGEVIEW_EYE] = {"eye", KIND_POINT, 0, ANY, NULL, NULL, "Position of the camera."},
    [CHANGEVIEW_VIEW] = {"view", KIND_DIRECTION, 0, ANY, NULL, NULL, "Direction of view."},
    [CHANGEVIEW_UP] = {"up", KIND_DIRECTION, 0, ANY, NULL, NULL, "Direction that is up in the picture."},
    [CHANGEVIEW_FOV] = {"fov", KIND_NUMBER, LOW_OPEN | HIGH_OPEN, IN_RANGE(0, 180), "degrees", NULL,
                        "Full vertical angle of view."},
};

static bool gr_change_view(struct script_context *context, const struct script_value *args,
                           struct script_result *result, struct error *error) {
    (void)result;
    struct changed_view *view = note_view(context, args[CHANGEVIEW_PICTURE].text, error);
    if (!view)
        return false;
    view->has_camera = true;
    view->camera = (struct camera){args[CHANGEVIEW_EYE].vector, args[CHANGEVIEW_VIEW].vector,
                                   args[CHANGEVIEW_UP].vector, args[CHANGEVIEW_FOV].number};
    return true;
}

enum { CHANGEEXPOSURE_PICTURE, CHANGEEXPOSURE_STOPS };
static const struct script_parameter change_exposure_parameters[] = {
    [CHANGEEXPOSURE_PICTURE] = {"picture", KIND_TEXT, 0, ANY, NULL, NULL, PICTURE_HELP},
    [CHANGEEXPOSURE_STOPS] = {"stops", KIND_NUMBER, 0, IN_RANGE(-100, 100), "stops", NULL, "New exposure."},
};

static bool gr_change_exposure(struct script_context *context, const struct script_value *args,
                               struct script_result *result, struct error *error) {
    (void)result;
    struct changed_view *view = note_view(context, args[CHANGEEXPOSURE_PICTURE].text, error);
    if (!view)
        return false;
    view->has_exposure = true;
    view->exposure = args[CHANGEEXPOSURE_STOPS].number;
    return true;
}

/* The latest of each kind is used. */
static void change_views(const struct script_context *context, struct render_request *request) {
    bool camera = false, exposure = false;
    for (const struct changed_view *view = script_of(context)->changes.views; view; view = view->next) {
        if (strcmp(view->picture, request->file) != 0)
            continue;
        if (view->has_camera && !camera) {
            request->camera = view->camera;
            settings_move_camera(&request->settings, &view->camera);
        }
        if (view->has_exposure && !exposure)
            request->settings.tone.exposure = view->exposure;
        camera = camera || view->has_camera;
        exposure = exposure || view->has_exposure;
    }
}

static void warn_once(void *user, const char *text) {
    struct script_context *context = user;
    if (!script_of(context)->changes.reported)
        sandbox_warn(&context->sandbox, "%s", text);
}

bool changes_begin(struct script_context *context, struct render_request *request, struct changed_scene *changed,
                   struct error *error) {
    struct script_changes *changes = &script_of(context)->changes;
    *changed = (struct changed_scene){0};
    request->added = changes->added;
    request->owned = changes->owned;
    request->maker = (struct change_maker){make_in_window, context};
    change_views(context, request);
    if (changes->count == 0)
        return true;
    const struct change_maker maker = {make_object, context};
    if (!changes_lay_over(
            (struct change_range){changes->list, changes->count},
            &(struct change_target){&maker, request->scene, request->root, request->lights, request->light_count},
            warn_once, context, changed, error))
        return false;
    changes->reported = true;
    request->lights = changed->lights;
    request->light_count = changed->light_count;
    if (changed->sky)
        request->sky = *changed->sky;
    return true;
}

static const struct script_function change_rows[] = {
    GR("change_node", change_node_parameters, RESULT_NOTHING, gr_change_node,
       "Transforms a node in all later pictures. The window saves edits as a file of such calls; require loads it.",
       "name serial matrix"),
    GR("change_delete", change_delete_parameters, RESULT_NOTHING, gr_change_delete,
       "Removes a node and its children from all later pictures.", "name serial"),
    GR("change_add", change_add_parameters, RESULT_NOTHING, gr_change_add,
       "Adds a node to all later pictures; gr.change_node places it.", "name serial shape colour? source?"),
    GR("change_material", change_material_parameters, RESULT_NOTHING, gr_change_material,
       "Changes the colour of a material in all later pictures.", "serial colour"),
    GR("change_look", change_look_parameters, RESULT_NOTHING, gr_change_look,
       "Changes an input of a base material in all later pictures.", "serial part value"),
    GR("change_texture", change_texture_parameters, RESULT_NOTHING, gr_change_texture,
       "Makes a texture the kd of a base material in all later pictures.", "serial call"),
    GR("change_own", change_own_parameters, RESULT_NOTHING, gr_change_own,
       "Gives a shape its own copy of its material in all later pictures. The copies are numbered 2147483647, "
       "2147483646 and so on.",
       "name serial like?"),
    GR("change_light", change_light_parameters, RESULT_NOTHING, gr_change_light,
       "Moves, rotates, scales or recolours a light in all later pictures.", "number move factor? linear? colour?"),
    GR("change_delete_light", change_delete_light_parameters, RESULT_NOTHING, gr_change_delete_light,
       "Removes a light from all later pictures.", "number"),
    GR("change_add_light", change_add_light_parameters, RESULT_NOTHING, gr_change_add_light,
       "Adds a light to all later pictures.", "position colour call?"),
    GR("change_copy_light", change_copy_light_parameters, RESULT_NOTHING, gr_change_copy_light,
       "Adds a copy of a light to all later pictures.", "number move factor?"),
    GR("change_view", change_view_parameters, RESULT_NOTHING, gr_change_view, "Changes the camera of a picture.",
       "picture eye view up fov"),
    GR("change_exposure", change_exposure_parameters, RESULT_NOTHING, gr_change_exposure,
       "Changes the exposure of a picture.", "picture stops"),
};
const struct function_rows change_functions = {change_rows, COUNT(change_rows)};
