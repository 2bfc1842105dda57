/* Each field of the form has a number, by which its change comes back; the rows of materials and settings are those of
 * their tables. */
#include "viewer/viewer_internal.h"

#include "light/light_edit.h"
#include "math/elementary.h"
#include "session/options_table.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum field_number {
    FIELD_NONE,
    FIELD_POSITION = WINDOW_FIELD_FRAME + 1,
    FIELD_ROTATION,
    FIELD_SCALE,
    FIELD_LIGHT_STOPS,
    FIELD_LIGHT_COLOUR,
    FIELD_EXPOSURE,
    FIELD_FOV,
    FIELD_EYE,
    FIELD_DIRECTION,
    FIELD_MATERIAL, /* and the parts of a material */
    FIELD_SETTING = FIELD_MATERIAL + MATERIAL_PART_PARTS,
};

static struct window_field *add(struct window_form *form, const char *group, const char *name,
                                enum window_field_kind kind, uint32_t number) {
    static struct window_field beyond; /* what has no room is not shown */
    struct window_field *field = form->count < FORM_FIELDS ? &form->fields[form->count++] : &beyond;
    *field = (struct window_field){.kind = kind, .number = number, .low = -HUGE_VAL, .high = HUGE_VAL};
    (void)snprintf(field->group, sizeof field->group, "%s", group);
    (void)snprintf(field->name, sizeof field->name, "%s", name);
    return field;
}

static void __attribute__((format(printf, 4, 5)))
add_text(struct window_form *form, const char *group, const char *name, const char *format, ...) {
    struct window_field *field = add(form, group, name, FIELD_TEXT, FIELD_NONE);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(field->text, sizeof field->text, format, arguments);
    va_end(arguments);
}

static void set_range(struct window_field *field, double low, double high, const char *unit) {
    field->low = low;
    field->high = high;
    (void)snprintf(field->unit, sizeof field->unit, "%s", unit);
}

static void set_help(struct window_field *field, const char *help) {
    (void)snprintf(field->help, sizeof field->help, "%s", help ? help : "");
}

static void set_vector(struct window_field *field, struct vec3 v) {
    field->numbers[0] = v.x;
    field->numbers[1] = v.y;
    field->numbers[2] = v.z;
}

/* Where it is, and two fields that act: they rotate and scale, and are 0 and 1 again. */
static void add_pose(const struct viewer *viewer, struct window_form *form, bool moves, bool turns, bool sizes) {
    struct window_field *field;
    if (moves) {
        field = add(form, "Position", "centre", FIELD_VECTOR, FIELD_POSITION);
        set_vector(field, viewer_selection_position(viewer));
        set_help(field, "Moves it there");
    }
    if (turns) {
        field = add(form, "Position", "rotate by", FIELD_VECTOR, FIELD_ROTATION);
        field->acts = true;
        set_range(field, -360, 360, "degrees");
        set_help(field, "Rotates it by this angle about the x, y or z axis through its middle");
    }
    if (sizes) {
        field = add(form, "Position", "scale by", FIELD_NUMBER, FIELD_SCALE);
        field->acts = true;
        field->numbers[0] = 1;
        set_range(field, 0.001, 1000, "");
        set_help(field, "Scales it about its middle by this factor");
    }
}

static void add_material(const struct viewer *viewer, struct window_form *form) {
    const struct picked *picked = &viewer->edit.selection.picked;
    for (int i = 0; picked->material_serial != 0 && i < MATERIAL_PART_PARTS; i++) {
        enum material_part part = (enum material_part)i;
        bool colour = material_part_count(part) == 3, idle = picked->idle_parts >> i & 1;
        struct window_field *field = add(form, "Material", material_part_name(part),
                                         colour ? FIELD_COLOUR : FIELD_NUMBER, FIELD_MATERIAL + (uint32_t)i);
        double low, high;
        struct change change = viewer_change(viewer, CHANGE_MATERIAL, part);
        memcpy(field->numbers, change.numbers, sizeof field->numbers);
        material_part_range(part, &low, &high);
        set_range(field, low, high, "");
        if (idle)
            set_help(field, "No effect at the point that was clicked: a texture replaces it");
    }
}

static void add_node(const struct viewer *viewer, struct window_form *form) {
    const struct picked *picked = &viewer->edit.selection.picked;
    (void)snprintf(form->title, sizeof form->title, "%.60s", picked->name);
    add_text(form, "Object", "path", "%.190s", picked->node_path);
    add_text(form, "Object", "shape", "%s", picked->shape);
    add_text(form, "Object", "material", "%s", picked->material);
    add_text(form, "Object", "distance", "%.5g", picked->distance);
    add_pose(viewer, form, true, true, true);
    add_material(viewer, form);
}

static void add_light(const struct viewer *viewer, struct window_form *form) {
    const struct light_info *light = viewer_light(viewer, viewer->edit.selection.light);
    struct change change = viewer_change(viewer, CHANGE_LIGHT, 0);
    if (!light)
        return;
    (void)snprintf(form->title, sizeof form->title, "Light %u of %u: %s", viewer->edit.selection.light,
                   viewer->lights.count, light_kind_name((enum light_kind)light->kind));
    add_pose(viewer, form, light->moves && light->has_position, light->turns, light->sizes);
    struct window_field *field = add(form, "Light", "brightness", FIELD_NUMBER, FIELD_LIGHT_STOPS);
    field->numbers[0] = el_log2(change.numbers[3]);
    set_range(field, -10, 10, "stops");
    set_help(field, "Above the brightness that the script gives it");
    field = add(form, "Light", "colour", FIELD_COLOUR, FIELD_LIGHT_COLOUR);
    /* Before it is brightened. */
    const double reported[3] = {light->colour.r, light->colour.g, light->colour.b};
    for (int i = 0; i < 3; i++)
        field->numbers[i] = change.colours              ? change.numbers[COLOUR_AT + i]
                            : change.numbers[3 + i] > 0 ? reported[i] / change.numbers[3 + i]
                                                        : 0;
    set_range(field, 0, HUGE_VAL, "");
}

/* As script and command line have set it. */
static void describe_setting(const struct viewer *viewer, int index, struct window_field *field) {
    const struct setting *row = &setting_table[index];
    size_t dashes = strspn(row->option, "-");
    bool flag = row->kind == SETTING_FLAG, number = row->kind == SETTING_NUMBER;
    bool words = !flag && !number && row->words && row->words[0] != '\0';
    uint64_t bits = setting_bits(row, &viewer->request.settings);
    *field = (struct window_field){.kind = flag    ? FIELD_FLAG
                                           : words ? FIELD_CHOICE
                                                   : FIELD_NUMBER,
                                   .number = FIELD_SETTING + (uint32_t)index,
                                   .numbers[0] = (double)bits};
    (void)snprintf(field->group, sizeof field->group, "%s", option_group_title(row->group));
    (void)snprintf(field->name, sizeof field->name, "%.*s", (int)strcspn(row->option + dashes, "|"),
                   row->option + dashes);
    if (number)
        memcpy(&field->numbers[0], &bits, sizeof bits);
    set_range(field, fmin(row->low, field->numbers[0]), fmax(row->high, field->numbers[0]), number ? "" : "#");
    if (words)
        (void)snprintf(field->text, sizeof field->text, "%s", row->words);
    set_help(field, row->help);
}

/* Every setting of the picture that has an option, but those that have a field of their own or no single number. */
static void add_settings(const struct viewer *viewer, struct window_form *form) {
    for (int i = 0; i < setting_count; i++) {
        const struct setting *row = &setting_table[i];
        bool own = i == SETTING_INDEX(tone.exposure) || i == SETTING_INDEX(overlay);
        if (row->option && row->kind != SETTING_LAYERS && row->kind != SETTING_CROP && !own)
            describe_setting(viewer, i, add(form, "", "", FIELD_TEXT, FIELD_NONE));
    }
}

/* The scripts run again, as with its option. */
static void change_setting(struct viewer *viewer, int index, double number) {
    const struct setting *row = &setting_table[index];
    if (row->kind == SETTING_NUMBER || row->kind == SETTING_WHOLE || row->kind == SETTING_CAUSTICS)
        number = fmin(fmax(number, row->low), row->high);
    viewer->setting = (struct viewer_setting){index, number};
    viewer->action = VIEWER_CHANGE_SETTING;
}

static void add_picture(const struct viewer *viewer, struct window_form *form) {
    struct window_field *field = add(form, "Picture", "exposure", FIELD_NUMBER, FIELD_EXPOSURE);
    field->numbers[0] = viewer->request.settings.tone.exposure;
    set_range(field, -100, 100, "stops");
    if (!viewer->block)
        return;
    field = add(form, "Picture", "angle of view", FIELD_NUMBER, FIELD_FOV);
    field->numbers[0] = viewer->fly_camera.pose.fov;
    set_range(field, 0.01, 170, "degrees");
    struct camera camera = fly_camera_current(&viewer->fly_camera);
    field = add(form, "Picture", "eye", FIELD_VECTOR, FIELD_EYE);
    set_vector(field, camera.eye);
    set_help(field, "Where the camera is");
    field = add(form, "Picture", "direction", FIELD_VECTOR, FIELD_DIRECTION);
    set_vector(field, camera.view);
    set_help(field, "The direction in which the camera looks");
}

/* Another selection has other widgets. */
static uint64_t subject_of(const struct viewer *viewer) {
    const struct selection *selection = &viewer->edit.selection;
    bool node = selection->kind == SELECTED_NODE;
    uint64_t of = node ? selection->picked.serial : selection->light;
    of = of << 24 ^ (node ? (uint64_t)selection->picked.material_serial : viewer->lights.known);
    return of << 4 | (uint64_t)selection->kind << 1 | (viewer->block != NULL);
}

void viewer_make_form(const struct viewer *viewer, struct window_state *state) {
    struct window_form *form = &state->form;
    state->integrator.number = FIELD_NONE;
    if (viewer->name[0] != '\0')
        describe_setting(viewer, SETTING_INDEX(integrator), &state->integrator);
    form->count = 0;
    form->subject = subject_of(viewer);
    form->title[0] = '\0';
    if (viewer->block && viewer->edit.selection.kind == SELECTED_NODE)
        add_node(viewer, form);
    else if (viewer->block && viewer->edit.selection.kind == SELECTED_LIGHT)
        add_light(viewer, form);
    if (viewer->name[0] != '\0')
        add_picture(viewer, form);
    if (viewer->name[0] != '\0' && viewer->edit.selection.kind == SELECTED_NOTHING)
        add_settings(viewer, form);
}

/* Fields of the selection. */
static void set_selected(struct viewer *viewer, const struct window_event *event) {
    static const struct vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double *numbers = event->numbers, factor = el_exp2(numbers[0]), factors[3] = {factor, factor, factor};
    viewer->edit.joins = event->joins;
    switch (event->field) {
    case FIELD_POSITION:
        viewer_move(viewer, vec3_sub(vec3_make(numbers[0], numbers[1], numbers[2]), viewer_selection_position(viewer)));
        return;
    case FIELD_ROTATION:
        for (int i = 0; i < 3; i++) {
            if (numbers[i] < 0 || numbers[i] > 0)
                viewer_turn(viewer, axes[i], numbers[i]);
        }
        return;
    case FIELD_SCALE:
        viewer_scale(viewer, vec3_all(numbers[0]));
        return;
    case FIELD_LIGHT_STOPS:
        viewer_set_numbers(viewer, CHANGE_LIGHT, 0, 3, factors);
        return;
    case FIELD_LIGHT_COLOUR:
        viewer_set_numbers(viewer, CHANGE_LIGHT, 0, COLOUR_AT, numbers);
        return;
    default:
        if (event->field >= FIELD_MATERIAL && event->field < FIELD_SETTING)
            viewer_set_numbers(viewer, CHANGE_MATERIAL, (enum material_part)(event->field - FIELD_MATERIAL), 0,
                               numbers);
    }
}

void viewer_set_field(struct viewer *viewer, const struct window_event *event) {
    double number = event->numbers[0];
    viewer->display.hud_dirty = true;
    switch (event->field) {
    case FIELD_EXPOSURE:
        viewer_set_exposure(viewer, number);
        return;
    case WINDOW_FIELD_FRAME:
        if (viewer->player.count > 0)
            viewer_go_to_frame(viewer, viewer_frame_number(viewer, number));
        return;
    case FIELD_FOV:
        if (viewer->block && number > 0 && number < 180) {
            viewer->fly_camera.pose.fov = number;
            viewer_change_view(viewer);
        }
        return;
    case FIELD_EYE:
    case FIELD_DIRECTION:
        if (viewer->block && fly_camera_put(&viewer->fly_camera, event->field == FIELD_EYE,
                                            vec3_make(number, event->numbers[1], event->numbers[2])))
            viewer_change_view(viewer);
        return;
    default:
        if (event->field >= FIELD_SETTING && event->field - FIELD_SETTING < (uint32_t)setting_count)
            change_setting(viewer, (int)(event->field - FIELD_SETTING), number);
        else if (viewer->block && viewer->edit.selection.kind != SELECTED_NOTHING)
            set_selected(viewer, event);
    }
}
