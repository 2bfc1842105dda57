/* Edits of the window, as calls: they are recorded, and applied to every picture that is rendered afterwards. The
 * script's own tree is not changed permanently. */
#include "script/gr_changes_internal.h"

#include "script/bindings_internal.h"
#include "script/script_internal.h"

#include <math.h>
#include <string.h>

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

static void put(double *numbers, struct vec3 v) {
    numbers[0] = v.x;
    numbers[1] = v.y;
    numbers[2] = v.z;
}

bool gr_change_node(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
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

bool gr_change_delete(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    (void)result;
    return note(context, CHANGE_GONE, args[CHANGEGONE_NAME].text, args[CHANGEGONE_SERIAL].number, error) != NULL;
}

bool gr_change_add(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    (void)result;
    struct change *change = note(context, CHANGE_ADD, args[CHANGEADD_NAME].text, args[CHANGEADD_SERIAL].number, error);
    if (!change)
        return false;
    change->added = (enum added_kind)args[CHANGEADD_SHAPE].choice;
    change->number = script_of(context)->changes.added++;
    change->source = (uint32_t)args[CHANGEADD_SOURCE].number;
    put(change->numbers, args[CHANGEADD_COLOUR].given ? args[CHANGEADD_COLOUR].vector : vec3_all(0.7));
    return true;
}

bool gr_change_material(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
    (void)result;
    struct change *change = note(context, CHANGE_MATERIAL, NULL, args[CHANGEMATERIAL_SERIAL].number, error);
    if (change)
        put(change->numbers, args[CHANGEMATERIAL_COLOUR].vector);
    return change != NULL;
}

bool gr_change_look(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
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

bool gr_change_own(struct script_context *context, const struct script_value *args, struct script_result *result,
                   struct error *error) {
    (void)result;
    struct change *change = note(context, CHANGE_OWN, args[CHANGEOWN_NAME].text, args[CHANGEOWN_SERIAL].number, error);
    if (!change)
        return false;
    change->number = script_of(context)->changes.owned++;
    change->source = (uint32_t)args[CHANGEOWN_LIKE].number;
    return true;
}

bool gr_change_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                     struct error *error) {
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
    put(change->numbers + 3, args[CHANGELIGHT_FACTOR].given ? args[CHANGELIGHT_FACTOR].vector : vec3_all(1));
    change->turns = turn->given;
    change->colours = colour->given;
    if (turn->given)
        memcpy(change->numbers + TURN_AT, turn->numbers, TURN_NUMBERS * sizeof *turn->numbers);
    if (colour->given)
        put(change->numbers + COLOUR_AT, colour->vector);
    return true;
}

bool gr_change_delete_light(struct script_context *context, const struct script_value *args,
                            struct script_result *result, struct error *error) {
    (void)result;
    return note(context, CHANGE_DARK, NULL, args[CHANGEDARK_NUMBER].number, error) != NULL;
}

bool gr_change_add_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                         struct error *error) {
    (void)result;
    struct change *change = note(context, CHANGE_ADD_LIGHT, NULL, 0, error);
    if (!change)
        return false;
    put(change->numbers, args[CHANGENEWLIGHT_POSITION].vector);
    put(change->numbers + 3, args[CHANGENEWLIGHT_COLOUR].vector);
    return true;
}

bool gr_change_copy_light(struct script_context *context, const struct script_value *args, struct script_result *result,
                          struct error *error) {
    const struct script_value *factor = &args[CHANGECOPYLIGHT_FACTOR];
    (void)result;
    struct change *change = note(context, CHANGE_ADD_LIGHT, NULL, 0, error);
    if (!change)
        return false;
    change->source = (uint32_t)args[CHANGECOPYLIGHT_NUMBER].number;
    put(change->numbers, args[CHANGECOPYLIGHT_MOVE].vector);
    put(change->numbers + 3, factor->given ? factor->vector : vec3_all(1));
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

bool gr_change_view(struct script_context *context, const struct script_value *args, struct script_result *result,
                    struct error *error) {
    (void)result;
    struct changed_view *view = note_view(context, args[CHANGEVIEW_PICTURE].text, error);
    if (!view)
        return false;
    view->has_camera = true;
    view->camera = (struct camera){args[CHANGEVIEW_EYE].vector, args[CHANGEVIEW_VIEW].vector,
                                   args[CHANGEVIEW_UP].vector, args[CHANGEVIEW_FOV].number};
    return true;
}

bool gr_change_exposure(struct script_context *context, const struct script_value *args, struct script_result *result,
                        struct error *error) {
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
            request->settings.view_is_target = false;
            request->settings.motion = (struct camera_motion){0};
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
    change_views(context, request);
    if (changes->count == 0)
        return true;
    if (!changes_lay_over((struct change_range){changes->list, changes->count},
                          &(struct change_target){request->scene, request->root, request->lights, request->light_count},
                          warn_once, context, changed, error))
        return false;
    changes->reported = true;
    request->lights = changed->lights;
    request->light_count = changed->light_count;
    return true;
}
