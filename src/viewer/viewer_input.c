/* Actions, keys and the mouse. */
#include "viewer/viewer_internal.h"

#include "light/light_edit.h"
#include "math/elementary.h"
#include "script/addable.h"
#include "session/options_table.h"
#include "window/call_form.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void show_view(struct viewer *viewer) {
    const struct pose *pose = &viewer->fly_camera.pose, *home = &viewer->fly_camera.home;
    viewer_outdate(viewer);
    viewer->camera_moved = memcmp(pose, home, sizeof *pose) != 0;
    viewer_halt(viewer, false);
}

void viewer_change_view(struct viewer *viewer) {
    fly_camera_note(&viewer->fly_camera, viewer->stepped);
    show_view(viewer);
}

void viewer_halt(struct viewer *viewer, bool on) {
    on = on && viewer->block && !viewer_is_idle(viewer);
    if (on == viewer->pass.halted)
        return;
    if (on)
        viewer_play(viewer, false);
    viewer->pass.halted = on;
    viewer->pass.halted_at = on && viewer->pass.state != PASS_WAITING ? viewer->stepped : 0;
    if (on && viewer->pass.state == PASS_WAITING) /* between two passes */
        viewer_note_stop(viewer, 0);
    viewer->display.hud_dirty = true;
    viewer->display.figures_at = 0;
}

/* From coarse to fine; a script that has ended runs again. */
static void render_again(struct viewer *viewer) {
    if (viewer->window.changed || (!viewer->block && viewer->window.waits))
        viewer->action = VIEWER_RUN_AGAIN;
    viewer->window.changed = false;
    if (!viewer->block)
        return;
    viewer->pass.from_coarse = viewer->pass.outdated = true;
    viewer_halt(viewer, false);
}

static void release_keys(struct viewer *viewer) {
    memset(viewer->fly_camera.down, 0, sizeof viewer->fly_camera.down);
}

static void fly(struct viewer *viewer, bool on) {
    viewer->input.flies = on;
    release_keys(viewer);
}

static bool has_tool(const struct viewer *viewer) {
    return viewer_can(viewer, viewer->edit.tool) && !viewer->input.flies;
}

/* Keeps what the tool has done, or takes it back. */
static void end_tool(struct viewer *viewer, bool keeps) {
    if (viewer->edit.joins && !keeps)
        viewer_undo(viewer, false);
    viewer->edit.tool = TOOL_NONE;
    viewer->edit.axis = 0;
    viewer->edit.handle = viewer->edit.joins = false;
    viewer->edit.typed[0] = '\0';
    viewer->display.hud_dirty = true;
}

/* Until a click the selection follows the mouse. */
static void choose_tool(struct viewer *viewer, enum edit_tool tool) {
    bool other = viewer->edit.tool != tool;
    end_tool(viewer, true);
    if (other && viewer_can(viewer, tool))
        viewer->edit.tool = tool;
}

/* What the typed number does, in place of what the tool has done so far. */
static void apply_typed(struct viewer *viewer) {
    char *end;
    double value = strtod(viewer->edit.typed, &end), v[3] = {0, 0, 0};
    int axis = viewer->edit.axis > 0 ? viewer->edit.axis - 1 : 0;
    bool one = viewer->edit.tool == TOOL_SIZE && viewer->edit.axis > 0;
    if (viewer->edit.joins)
        viewer_undo(viewer, false);
    if (end == viewer->edit.typed || !isfinite(value))
        return;
    v[axis] = viewer->edit.tool == TOOL_TURN ? 1 : value;
    if (viewer->edit.tool == TOOL_MOVE)
        viewer_move(viewer, vec3_make(v[0], v[1], v[2]));
    else if (viewer->edit.tool == TOOL_TURN)
        viewer_turn(viewer, vec3_make(v[0], v[1], v[2]), value);
    else
        viewer_scale(viewer, one ? vec3_make(axis == 0 ? value : 1, axis == 1 ? value : 1, axis == 2 ? value : 1)
                                 : vec3_all(value));
}

/* As in "g x 2": an axis, or a part of a number. */
static void type(struct viewer *viewer, char c) {
    char *typed = viewer->edit.typed;
    size_t length = strlen(typed);
    if (!has_tool(viewer))
        return;
    if (c == '\r') {
        end_tool(viewer, true);
        return;
    }
    if (c >= 'x' && c <= 'z')
        viewer->edit.axis = viewer->edit.axis == c - 'x' + 1 ? 0 : c - 'x' + 1;
    else if (c == '\b' && length > 0)
        typed[length - 1] = '\0';
    else if (strchr("0123456789.-", c) && length + 1 < sizeof viewer->edit.typed)
        (void)snprintf(typed + length, 2, "%c", c);
    apply_typed(viewer);
    viewer->display.hud_dirty = true;
}

/* Ends what is going on, from the inside out: flying, the selection and the trace, rendering. */
static void escape(struct viewer *viewer) {
    if (!viewer->block) {
        viewer->action = viewer->window.waits ? VIEWER_NOTHING : VIEWER_END_SCRIPTS;
        return;
    }
    bool something = viewer->edit.selection.kind != SELECTED_NOTHING || viewer->trace.text[0] != '\0';
    if (viewer->input.flies || has_tool(viewer)) {
        fly(viewer, false);
        end_tool(viewer, false);
        return;
    }
    if (!something)
        viewer_halt(viewer, true);
    viewer->edit.selection.kind = SELECTED_NOTHING;
    viewer->trace.text[0] = '\0';
}

uint32_t viewer_needs_met(const struct viewer *viewer) {
    const bool met[] = {[NEEDS_NOTHING] = true,
                        [NEEDS_NAME] = viewer->name[0] != '\0',
                        [NEEDS_SCENE] = viewer->name[0] != '\0',
                        [NEEDS_VIEW] = viewer->block != NULL,
                        [NEEDS_PICTURE] = viewer->block != NULL,
                        [NEEDS_SELECTION] = viewer->block && viewer->edit.selection.kind != SELECTED_NOTHING,
                        [NEEDS_FRAMES] = viewer->player.count > 0};
    uint32_t bits = 0;
    for (size_t i = 0; i < sizeof met / sizeof *met; i++)
        bits |= (uint32_t)met[i] << i;
    return bits;
}

static void do_action(struct viewer *viewer, enum window_action action) {
    struct fly_camera *camera = &viewer->fly_camera;
    switch (action) {
    case DO_SAVE_PICTURE:
    case DO_SAVE_VIEW:
    case DO_SAVE_CHANGES:
    case DO_EXPORT_MODEL:
        viewer->action = (enum viewer_action)(VIEWER_SAVE_IMAGE + (action - DO_SAVE_PICTURE));
        return;
    case DO_NEXT_PICTURE: /* which comes after this one was written */
        viewer->next = true;
        if (viewer->window.mode.previews)
            viewer_choose_mode(viewer, (struct view_mode){0});
        return;
    case DO_QUIT:
        viewer->quit = true;
        return;

    case DO_UNDO:
    case DO_REDO:
        viewer_undo(viewer, action == DO_REDO);
        return;
    case DO_MOVE:
    case DO_TURN:
    case DO_SIZE:
        choose_tool(viewer, (enum edit_tool)(TOOL_MOVE + (action - DO_MOVE)));
        return;
    case DO_COPY:
        viewer_copy_selection(viewer);
        return;
    case DO_DELETE:
        viewer_delete_selection(viewer);
        return;
    case DO_SOLO:
        viewer_solo(viewer);
        return;
    case DO_OWN_MATERIAL:
        viewer_make_own_material(viewer);
        return;
    case DO_SELECT_PARENT:
    case DO_SELECT_OPERAND:
        viewer_select_up(viewer, action == DO_SELECT_OPERAND);
        return;
    case DO_NEXT_LIGHT:
    case DO_PREVIOUS_LIGHT:
        viewer_next_light(viewer, action == DO_PREVIOUS_LIGHT);
        return;
    case DO_ESCAPE:
        escape(viewer);
        return;

    case DO_CAMERA:
        fly_camera_home(camera);
        viewer_change_view(viewer);
        return;
    case DO_FRAME_ALL:
    case DO_FRAME:
        viewer_frame(viewer, action == DO_FRAME);
        viewer_change_view(viewer);
        return;
    case DO_VIEW_FRONT:
    case DO_VIEW_RIGHT:
    case DO_VIEW_TOP:
        fly_camera_face(camera, vec3_make(action == DO_VIEW_RIGHT ? -1 : 0, action == DO_VIEW_TOP ? -1 : 0,
                                          action == DO_VIEW_FRONT ? -1 : 0));
        viewer_change_view(viewer);
        return;
    case DO_LEVEL:
        fly_camera_level(camera);
        viewer_change_view(viewer);
        return;
    case DO_ROLL_LEFT:
    case DO_ROLL_RIGHT:
        fly_camera_roll(camera, action == DO_ROLL_LEFT ? -5 : 5);
        viewer_change_view(viewer);
        return;
    case DO_VIEW_BACK:
    case DO_VIEW_FORWARD:
        if (fly_camera_recall(camera, action == DO_VIEW_FORWARD))
            show_view(viewer);
        return;
    case DO_FLY:
        fly(viewer, !viewer->input.flies);
        return;
    case DO_SHOW_PICTURE:
        viewer_choose_mode(viewer, (struct view_mode){0});
        return;
    case DO_SHOW_PREVIEW:
    case DO_SHOW_NORMALS:
    case DO_SHOW_DEPTH:
    case DO_SHOW_COST:
        viewer_choose_mode(
            viewer, (struct view_mode){.previews = true, .shows = (enum headlight_shows)(action - DO_SHOW_PREVIEW)});
        return;
    case DO_SHOW_FACTORS:
        viewer_show_factors(viewer);
        return;
    case DO_BOXES:
    case DO_GRID:
    case DO_PATCHES:
        viewer_choose_overlay(viewer, (enum overlay)(OVERLAY_OF_BOXES + (action - DO_BOXES)));
        return;
    case DO_HIDE:
        viewer->window.hides_lines = !viewer->window.hides_lines;
        return;
    case DO_FULL_SCREEN:
        viewer->window.driver->state->full_screen = !viewer->window.driver->state->full_screen;
        return;

    case DO_RENDER:
        render_again(viewer);
        return;
    case DO_STOP:
        viewer_halt(viewer, !viewer->pass.halted);
        return;
    case DO_BRIGHTER:
    case DO_DARKER:
        viewer_set_exposure(viewer, viewer->request.settings.tone.exposure + (action == DO_DARKER ? -0.25 : 0.25));
        return;
    case DO_PIXEL_TRACE:
        viewer_request_pixel_trace(viewer, viewer->input.x, viewer->input.y);
        return;

    case DO_PLAY:
        viewer_play(viewer, !viewer->player.playing);
        return;
    case DO_PREVIOUS_FRAME:
    case DO_NEXT_FRAME:
        viewer_step_frames(viewer, action == DO_NEXT_FRAME ? 1 : -1);
        return;
    case DO_LOOP:
        viewer_player_loop(viewer);
        return;
    }
}

void viewer_do(struct viewer *viewer, enum window_action action) {
    if (!(viewer_needs_met(viewer) >> window_action_table[action].need & 1))
        return;
    if (action != DO_ESCAPE && action != DO_MOVE && action != DO_TURN && action != DO_SIZE)
        end_tool(viewer, true);
    viewer->display.hud_dirty = true;
    do_action(viewer, action);
    size_t used = strlen(viewer->note); /* what it did is noted first */
    (void)snprintf(viewer->note + used, sizeof viewer->note - used, "%swindow: %s", used > 0 ? "; " : "",
                   window_action_table[action].name);
}

/* The speed is that for what is in front. */
static void handle_key(struct viewer *viewer, const struct window_event *event) {
    const struct window_layout *layout = &viewer->window.layout;
    if (!viewer->block) /* without a scene the camera does not move */
        return;
    if (event->down && !viewer->fly_camera.down[event->key])
        viewer_probe(viewer, layout->left + layout->shown_width / 2, layout->top + layout->shown_height / 2);
    viewer->fly_camera.down[event->key] = event->down;
}

/* The mouse. */

static void take_position(struct viewer *viewer, const struct window_event *event) {
    viewer->input.x = event->x;
    viewer->input.y = event->y;
}

/* A movement over a short distance is still a click. */
static bool is_drag(struct viewer *viewer) {
    double x = viewer->input.x - viewer->input.press_x, y = viewer->input.y - viewer->input.press_y;
    double limit = 4 * viewer->window.layout.density;
    viewer->input.dragged = viewer->input.dragged || x * x + y * y >= limit * limit;
    return viewer->input.dragged;
}

static void handle_motion(struct viewer *viewer, const struct window_event *event) {
    double x = event->dx / viewer->window.layout.shown_height, y = event->dy / viewer->window.layout.shown_height;
    take_position(viewer, event);
    if (viewer->block && has_tool(viewer) && viewer->edit.typed[0] == '\0') {
        viewer_drag_selection(viewer, event->dx, event->dy);
        return;
    }
    if (!viewer->block || !viewer->input.pressed || !is_drag(viewer))
        return;
    if (viewer->input.flies || viewer->input.pressed == WINDOW_RIGHT)
        fly_camera_turn(&viewer->fly_camera, x, y);
    else if (viewer->input.shift)
        fly_camera_pan(&viewer->fly_camera, x, y);
    else
        fly_camera_orbit(&viewer->fly_camera, x, y);
    viewer_change_view(viewer);
}

static void handle_press(struct viewer *viewer, const struct window_event *event) {
    take_position(viewer, event);
    if (!viewer->block)
        return;
    if (has_tool(viewer)) {
        end_tool(viewer, event->button == WINDOW_LEFT);
        return;
    }
    if (event->button == WINDOW_LEFT && !viewer->input.flies && viewer_take_handle(viewer, event->x, event->y))
        return;
    if (event->button != WINDOW_LEFT)
        viewer_probe(viewer, event->x, event->y);
    viewer->input.pressed = event->button;
    viewer->input.shift = event->shift;
    viewer->input.dragged = viewer->edit.joins = false;
    viewer->input.press_x = event->x;
    viewer->input.press_y = event->y;
}

static void handle_release(struct viewer *viewer, const struct window_event *event) {
    bool clicks = event->button == WINDOW_LEFT && event->button == viewer->input.pressed && !viewer->input.flies;
    take_position(viewer, event);
    viewer->input.pressed = 0;
    if (viewer->edit.handle)
        end_tool(viewer, true);
    if (!viewer->block || !clicks || is_drag(viewer))
        return;
    if (viewer_click_cube(viewer, event->x, event->y))
        viewer_change_view(viewer);
    else
        viewer_click(viewer, event->x, event->y, event->control);
}

/* Towards what is under the cursor, as far as it was probed; with control the wheel changes the angle of view. */
static void handle_wheel(struct viewer *viewer, const struct window_event *event) {
    const struct window_layout *layout = &viewer->window.layout;
    if (!viewer->block)
        return;
    if (viewer->edit.tool == TOOL_MOVE && has_tool(viewer)) {
        viewer_push_selection(viewer, event->y);
        return;
    }
    if (event->control) {
        fly_camera_zoom(&viewer->fly_camera, event->y);
    } else {
        viewer_probe(viewer, viewer->input.x, viewer->input.y);
        double x = (viewer->input.x - layout->left - layout->shown_width / 2) / layout->shown_height;
        double y = (viewer->input.y - layout->top - layout->shown_height / 2) / layout->shown_height;
        fly_camera_dolly(&viewer->fly_camera, x, y, event->y);
    }
    viewer_change_view(viewer);
}

/* The tree: what the render process does not know. */

static void want_rows(struct viewer *viewer, const struct node_query *query) {
    struct node_rows rows = {0};
    if (!viewer->block)
        return;
    if (query->depth == 0 || query->path[0] != SECTION_LIGHTS) {
        if (viewer->nodes.count < NODE_QUERIES)
            viewer->nodes.wanted[viewer->nodes.count++] = *query;
        return;
    }
    for (uint32_t i = query->first; i < viewer->lights.known && rows.count < NODE_ROWS; i++) {
        struct node_row *row = &rows.rows[rows.count++];
        (void)snprintf(row->name, sizeof row->name, "%u", i + 1);
        (void)snprintf(row->kind, sizeof row->kind, "%s",
                       light_kind_name((enum light_kind)viewer->lights.items[i].kind));
    }
    viewer->window.driver->nodes(viewer->window.driver->context, query, &rows);
}

static void select_row(struct viewer *viewer, const struct node_query *query) {
    bool light = query->depth == 2 && query->path[0] == SECTION_LIGHTS;
    if (light && query->path[1] < viewer->lights.known)
        viewer_select_light(viewer, query->path[1] + 1);
    else if (query->serial != 0 || (query->depth > 0 && query->path[0] == SECTION_NODES) ||
             (query->depth == 2 && query->path[0] == SECTION_MATERIALS))
        viewer_select_node(viewer, query);
    else
        viewer->edit.selection.kind = SELECTED_NOTHING;
    viewer->display.hud_dirty = true;
}

/* Beside the root of the scene. */
void viewer_receive_nodes(struct viewer *viewer, const struct node_query *query, struct node_rows *rows) {
    if (query->depth == 0 && query->search[0] == '\0' && rows->count == 1) {
        rows->count = NODE_SECTIONS;
        rows->rows[SECTION_LIGHTS] = (struct node_row){.children = viewer->lights.count, .name = "Lights", .kind = " "};
        rows->rows[SECTION_CAMERA] = (struct node_row){.name = "Camera", .kind = " "};
    }
    viewer->window.driver->nodes(viewer->window.driver->context, query, rows);
}

/* --- The form --- */

/* Each field of the form has a number, by which its change comes back; the rows of materials and settings are those of
 * their tables. */

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
    FIELD_CALL = 1 << 16, /* the call that has added the selection, and its arguments */
    FIELD_ARGUMENT,
};

static void __attribute__((format(printf, 4, 5)))
add_text(struct window_form *form, const char *group, const char *name, const char *format, ...) {
    struct window_field *field = form_add(form, group, name, FIELD_TEXT, FIELD_NONE);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(field->text, sizeof field->text, format, arguments);
    va_end(arguments);
}

/* The fields that are not rows of other tables. Those that act rotate and scale, and are 0 and 1 again. */
static const struct {
    const char *group, *name, *unit, *help;
    enum window_field_kind kind;
    double low, high;
    bool acts;
} fields[] = {
    [FIELD_POSITION] = {"Position", "centre", "", "Moves it there", FIELD_VECTOR, -HUGE_VAL, HUGE_VAL, false},
    [FIELD_ROTATION] = {"Position", "rotate by", "degrees",
                        "Rotates it by this angle about the x, y or z axis through its middle", FIELD_VECTOR, -360, 360,
                        true},
    [FIELD_SCALE] = {"Position", "scale by", "", "Scales it about its middle by this factor", FIELD_NUMBER, 0.001, 1000,
                     true},
    [FIELD_LIGHT_STOPS] = {"Light", "brightness", "stops", "Above the brightness that the script gives it",
                           FIELD_NUMBER, -10, 10, false},
    [FIELD_LIGHT_COLOUR] = {"Light", "colour", "", "Before it is brightened", FIELD_COLOUR, 0, HUGE_VAL, false},
    [FIELD_EXPOSURE] = {"Picture", "exposure", "stops", "A stop doubles all light", FIELD_NUMBER, -100, 100, false},
    [FIELD_FOV] = {"Picture", "angle of view", "degrees", "From the upper to the lower edge", FIELD_NUMBER, 0.01, 170,
                   false},
    [FIELD_EYE] = {"Picture", "eye", "", "Where the camera is", FIELD_VECTOR, -HUGE_VAL, HUGE_VAL, false},
    [FIELD_DIRECTION] = {"Picture", "direction", "", "The direction in which the camera looks", FIELD_VECTOR, -HUGE_VAL,
                         HUGE_VAL, false}};

static void add_fixed(struct window_form *form, enum field_number number, double a, double b, double c) {
    struct window_field *field = form_add(form, fields[number].group, fields[number].name, fields[number].kind, number);
    field->acts = fields[number].acts;
    field->numbers[0] = a;
    field->numbers[1] = b;
    field->numbers[2] = c;
    form_set_range(field, fields[number].low, fields[number].high, fields[number].unit);
    form_set_help(field, fields[number].help);
}

static void add_pose(const struct viewer *viewer, struct window_form *form) {
    struct vec3 at = viewer_selection_position(viewer);
    const struct light_info *light = viewer_light(viewer, viewer->edit.selection.light);
    bool is_light = viewer->edit.selection.kind == SELECTED_LIGHT;
    if (viewer_can(viewer, TOOL_MOVE) && (!is_light || light->has_position))
        add_fixed(form, FIELD_POSITION, at.x, at.y, at.z);
    if (viewer_can(viewer, TOOL_TURN))
        add_fixed(form, FIELD_ROTATION, 0, 0, 0);
    if (viewer_can(viewer, TOOL_SIZE))
        add_fixed(form, FIELD_SCALE, 1, 0, 0);
}

static void add_material(const struct viewer *viewer, struct window_form *form) {
    const struct picked *picked = &viewer->edit.selection.picked;
    for (int i = 0; picked->material_serial != 0 && i < MATERIAL_PART_PARTS; i++) {
        enum material_part part = (enum material_part)i;
        bool colour = material_part_count(part) == 3, idle = picked->idle_parts >> i & 1;
        struct window_field *field = form_add(form, "Material", material_part_name(part),
                                              colour ? FIELD_COLOUR : FIELD_NUMBER, FIELD_MATERIAL + (uint32_t)i);
        double low, high;
        struct change change = viewer_change(viewer, CHANGE_MATERIAL, part);
        memcpy(field->numbers, change.numbers, sizeof field->numbers);
        material_part_range(part, &low, &high);
        form_set_range(field, low, high, "");
        if (idle)
            form_set_help(field, "No effect at the point that was clicked: a texture replaces it");
    }
}

/* The call that has added the selection, and what its function has; a material has fields of its own. */
static void add_call(const struct viewer *viewer, struct window_form *form) {
    struct change change;
    if (!viewer_added(viewer, &change))
        return;
    call_form_add(form, change.call, FIELD_ARGUMENT);
    struct window_field *field = form_add(form, "Call", "Lua", FIELD_ENTRY, FIELD_CALL);
    (void)snprintf(field->text, sizeof field->text, "%s", change.call);
    form_set_help(field, "The call of gr that makes it");
}

/* A changed argument. */
static void set_call(struct viewer *viewer, const struct window_event *event) {
    struct change change;
    char text[CHANGE_CALL];
    if (event->field == FIELD_CALL)
        viewer_set_call(viewer, event->text);
    else if (viewer_added(viewer, &change) && call_form_set(change.call, event, FIELD_ARGUMENT, text))
        viewer_set_call(viewer, text);
}

static void add_node(const struct viewer *viewer, struct window_form *form) {
    const struct picked *picked = &viewer->edit.selection.picked;
    (void)snprintf(form->title, sizeof form->title, "%.60s", picked->name);
    add_text(form, "Object", "path", "%.190s", picked->node_path);
    add_text(form, "Object", "shape", "%s", picked->shape);
    add_text(form, "Object", "material", "%s", picked->material);
    add_text(form, "Object", "distance", "%.5g", picked->distance);
    add_pose(viewer, form);
    add_call(viewer, form);
    add_material(viewer, form);
}

static void add_light(const struct viewer *viewer, struct window_form *form) {
    const struct light_info *light = viewer_light(viewer, viewer->edit.selection.light);
    struct change change = viewer_change(viewer, CHANGE_LIGHT, 0);
    if (!light)
        return;
    (void)snprintf(form->title, sizeof form->title, "Light %u of %u: %s", viewer->edit.selection.light,
                   viewer->lights.count, light_kind_name((enum light_kind)light->kind));
    add_pose(viewer, form);
    add_fixed(form, FIELD_LIGHT_STOPS, el_log2(change.numbers[3]), 0, 0);
    const double reported[3] = {light->colour.r, light->colour.g, light->colour.b};
    double now[3];
    for (int i = 0; i < 3; i++)
        now[i] = change.colours              ? change.numbers[COLOUR_AT + i]
                 : change.numbers[3 + i] > 0 ? reported[i] / change.numbers[3 + i]
                                             : 0;
    add_fixed(form, FIELD_LIGHT_COLOUR, now[0], now[1], now[2]);
    add_call(viewer, form);
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
                                   .numbers[0] = (double)bits,
                                   .resets = true,
                                   .initial = row->initial};
    (void)snprintf(field->group, sizeof field->group, "%s", option_group_title(row->group));
    (void)snprintf(field->name, sizeof field->name, "%.*s", (int)strcspn(row->option + dashes, "|"),
                   row->option + dashes);
    if (number)
        memcpy(&field->numbers[0], &bits, sizeof bits);
    form_set_range(field, math_min(row->low, field->numbers[0]), math_max(row->high, field->numbers[0]),
                   number ? "" : "#");
    if (words)
        (void)snprintf(field->text, sizeof field->text, "%s", row->words);
    form_set_help(field, row->help);
}

/* Every setting of the picture that has an option, but those that have a field of their own or no single number. */
static void add_settings(const struct viewer *viewer, struct window_form *form) {
    for (int i = 0; i < setting_count; i++) {
        const struct setting *row = &setting_table[i];
        bool own = i == SETTING_INDEX(tone.exposure) || i == SETTING_INDEX(overlay);
        if (row->option && row->kind != SETTING_LAYERS && row->kind != SETTING_CROP && !own)
            describe_setting(viewer, i, form_add(form, "", "", FIELD_TEXT, FIELD_NONE));
    }
}

/* The scripts run again, as with its option. */
static void change_setting(struct viewer *viewer, int index, double number) {
    const struct setting *row = &setting_table[index];
    if (row->kind == SETTING_NUMBER || row->kind == SETTING_WHOLE || row->kind == SETTING_CAUSTICS)
        number = math_min(math_max(number, row->low), row->high);
    viewer->setting = (struct viewer_setting){index, number};
    viewer->action = VIEWER_CHANGE_SETTING;
}

static void add_picture(const struct viewer *viewer, struct window_form *form) {
    struct camera camera = fly_camera_current(&viewer->fly_camera);
    add_fixed(form, FIELD_EXPOSURE, viewer->request.settings.tone.exposure, 0, 0);
    if (!viewer->block)
        return;
    add_fixed(form, FIELD_FOV, camera.fov, 0, 0);
    add_fixed(form, FIELD_EYE, camera.eye.x, camera.eye.y, camera.eye.z);
    add_fixed(form, FIELD_DIRECTION, camera.view.x, camera.view.y, camera.view.z);
}

/* Another selection has other widgets. */
static uint64_t subject_of(const struct viewer *viewer) {
    const struct selection *selection = &viewer->edit.selection;
    bool node = selection->kind == SELECTED_NODE || selection->kind == SELECTED_MATERIAL;
    uint64_t of = node ? selection->picked.serial : selection->light;
    of = of << 24 ^ (node ? (uint64_t)selection->picked.material_serial : viewer->lights.known);
    struct change change; /* another function has other inputs */
    of ^= viewer_added(viewer, &change) ? (uint64_t)(uintptr_t)call_function(change.call) << 5 : 0;
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
    else if (viewer->block && viewer->edit.selection.kind == SELECTED_MATERIAL) {
        const struct picked *picked = &viewer->edit.selection.picked;
        (void)snprintf(form->title, sizeof form->title, "Material %u", picked->material_serial);
        add_text(form, "Material", "kind", "%s", picked->material);
        add_material(viewer, form);
    } else if (viewer->block && viewer->edit.selection.kind == SELECTED_LIGHT)
        add_light(viewer, form);
    if (viewer->name[0] != '\0')
        add_picture(viewer, form);
    if (viewer->name[0] != '\0' && viewer->edit.selection.kind == SELECTED_NOTHING)
        add_settings(viewer, form);
    for (uint32_t i = 0; i < form->count; i++)
        form->fields[i].linear = settings_linear(&viewer->request.settings);
}

/* Fields of the selection. */
static void set_selected(struct viewer *viewer, const struct window_event *event) {
    static const struct vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double *numbers = event->numbers, factor = el_exp2(numbers[0]), factors[3] = {factor, factor, factor};
    viewer->edit.joins = event->joins;
    if (event->field >= FIELD_CALL)
        set_call(viewer, event);
    if (event->field >= FIELD_MATERIAL && event->field < FIELD_SETTING)
        viewer_set_numbers(viewer, CHANGE_MATERIAL, (enum material_part)(event->field - FIELD_MATERIAL), 0, numbers);
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
    }
}

static void set_field(struct viewer *viewer, const struct window_event *event) {
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
    }
    if (event->field >= FIELD_SETTING && event->field - FIELD_SETTING < (uint32_t)setting_count)
        change_setting(viewer, (int)(event->field - FIELD_SETTING), number);
    else if (viewer->block && viewer->edit.selection.kind != SELECTED_NOTHING)
        set_selected(viewer, event);
}

void viewer_handle_event(struct viewer *viewer, const struct window_event *event) {
    switch (event->kind) {
    case WINDOW_CLOSE:
        viewer->quit = true;
        return;
    case WINDOW_KEY:
        handle_key(viewer, event);
        return;
    case WINDOW_MOVE:
        handle_motion(viewer, event);
        return;
    case WINDOW_WHEEL:
        handle_wheel(viewer, event);
        return;
    case WINDOW_PRESS:
        handle_press(viewer, event);
        return;
    case WINDOW_RELEASE:
        handle_release(viewer, event);
        return;
    /* What happens outside is not reported: keys count as released. */
    case WINDOW_LEAVE:
        release_keys(viewer);
        viewer->input.pressed = 0;
        return;
    case WINDOW_SIZE:
        viewer_resize(viewer, (int)event->x, (int)event->y, event->density);
        return;
    case WINDOW_ACTION:
        take_position(viewer, event);
        (void)snprintf(viewer->save_as, sizeof viewer->save_as, "%s", event->text);
        viewer_do(viewer, event->action);
        return;
    case WINDOW_NODES:
        want_rows(viewer, &event->node);
        return;
    case WINDOW_SELECT:
        select_row(viewer, &event->node);
        return;
    case WINDOW_ADD:
    case WINDOW_TEXTURE:
        if (strlen(event->text) >= CHANGE_CALL)
            viewer_show_notice(viewer, "a call, with the names of its files, has at most 511 characters", true);
        else if (viewer->block && event->kind == WINDOW_ADD)
            viewer_add(viewer, event->text);
        else if (viewer->block)
            viewer_drop_texture(viewer, event);
        return;
    case WINDOW_HIDE:
        if (viewer->block)
            viewer_hide(viewer, event->node.serial, event->text);
        return;
    case WINDOW_TYPE:
        type(viewer, event->typed);
        return;
    case WINDOW_FIELD:
        set_field(viewer, event);
        return;
    }
}
