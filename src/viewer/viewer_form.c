/* Each field of the form has a number, by which its change comes back; the rows of materials and settings are those of
 * their tables. */
#include "viewer/viewer_internal.h"

#include "light/light_edit.h"
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
    FIELD_LIGHT_NUMBER,
    FIELD_EXPOSURE,
    FIELD_FOV,
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
        viewer_material_now(viewer, part, field->numbers);
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
    if (!light)
        return;
    (void)snprintf(form->title, sizeof form->title, "Light %u of %u: %s", viewer->edit.selection.light,
                   viewer->lights.count, light_kind_name((enum light_kind)light->kind));
    add_pose(viewer, form, light->moves && light->has_position, light->turns, light->sizes);
    struct window_field *field = add(form, "Light", "brightness", FIELD_NUMBER, FIELD_LIGHT_STOPS);
    field->numbers[0] = viewer_light_stops_now(viewer);
    set_range(field, -10, 10, "stops");
    set_help(field, "Above the brightness that the script gives it");
    field = add(form, "Light", "colour", FIELD_COLOUR, FIELD_LIGHT_COLOUR);
    struct colour colour = viewer_light_colour_now(viewer);
    field->numbers[0] = colour.r;
    field->numbers[1] = colour.g;
    field->numbers[2] = colour.b;
    set_range(field, 0, HUGE_VAL, "");
}

/* Every setting of the picture that has an option, as script and command line have set it, but those that have a field
 * of their own or no single number. */
static void add_settings(const struct viewer *viewer, struct window_form *form) {
    for (int i = 0; i < setting_count; i++) {
        const struct setting *row = &setting_table[i];
        bool own = i == SETTING_INDEX(tone.exposure) || i == SETTING_INDEX(overlay);
        char name[32];
        if (!row->option || row->kind == SETTING_LAYERS || row->kind == SETTING_CROP || own)
            continue;
        size_t dashes = strspn(row->option, "-");
        (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(row->option + dashes, "|"), row->option + dashes);
        bool flag = row->kind == SETTING_FLAG, number = row->kind == SETTING_NUMBER;
        bool words = !flag && !number && row->words && row->words[0] != '\0';
        struct window_field *field = add(form, option_group_title(row->group), name,
                                         flag    ? FIELD_FLAG
                                         : words ? FIELD_CHOICE
                                                 : FIELD_NUMBER,
                                         FIELD_SETTING + (uint32_t)i);
        uint64_t bits = setting_bits(row, &viewer->request.settings);
        field->numbers[0] = (double)bits;
        if (number)
            memcpy(&field->numbers[0], &bits, sizeof bits);
        set_range(field, fmin(row->low, field->numbers[0]), fmax(row->high, field->numbers[0]), number ? "" : "#");
        if (words)
            (void)snprintf(field->text, sizeof field->text, "%s", row->words);
        set_help(field, row->help);
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
    if (viewer->lights.known > 0) {
        field = add(form, "Picture", "select light", FIELD_NUMBER, FIELD_LIGHT_NUMBER);
        field->numbers[0] = viewer->edit.selection.kind == SELECTED_LIGHT ? viewer->edit.selection.light : 0;
        set_range(field, 0, viewer->lights.known, "#");
    }
}

/* Another selection has other widgets. */
static uint64_t subject_of(const struct viewer *viewer) {
    const struct selection *selection = &viewer->edit.selection;
    bool node = selection->kind == SELECTED_NODE;
    uint64_t of = node ? selection->picked.serial : selection->light;
    of = of << 24 ^ (node ? (uint64_t)selection->picked.material_serial : viewer->lights.known);
    return of << 4 | (uint64_t)selection->kind << 1 | (viewer->block != NULL);
}

void viewer_make_form(const struct viewer *viewer, struct window_form *form) {
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

static struct vec3 vector_of(const struct window_event *event) {
    return vec3_make(event->numbers[0], event->numbers[1], event->numbers[2]);
}

/* Fields of the selection. */
static void set_selected(struct viewer *viewer, const struct window_event *event) {
    static const double no_turn[3] = {0, 0, 0};
    viewer->edit.joins = event->joins;
    switch (event->field) {
    case FIELD_POSITION:
        viewer_move_selection(viewer, vector_of(event));
        return;
    case FIELD_ROTATION:
        viewer_turn_selection(viewer, event->numbers, 1);
        return;
    case FIELD_SCALE:
        viewer_turn_selection(viewer, no_turn, event->numbers[0]);
        return;
    case FIELD_LIGHT_STOPS:
        viewer_brighten_light(viewer, event->numbers[0]);
        return;
    case FIELD_LIGHT_COLOUR:
        viewer_light_colour(viewer, colour_make(event->numbers[0], event->numbers[1], event->numbers[2]));
        return;
    default:
        if (event->field >= FIELD_MATERIAL && event->field < FIELD_SETTING)
            viewer_set_material(viewer, (enum material_part)(event->field - FIELD_MATERIAL), event->numbers);
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
    case FIELD_LIGHT_NUMBER:
        if (viewer->block && number >= 1 && number <= viewer->lights.known)
            viewer_select_light(viewer, (uint32_t)number);
        return;
    default:
        if (event->field >= FIELD_SETTING && event->field - FIELD_SETTING < (uint32_t)setting_count)
            change_setting(viewer, (int)(event->field - FIELD_SETTING), number);
        else if (viewer->block && viewer->edit.selection.kind != SELECTED_NOTHING)
            set_selected(viewer, event);
    }
}
