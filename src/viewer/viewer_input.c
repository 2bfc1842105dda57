/* Actions, keys and the mouse. */
#include "viewer/viewer_internal.h"

#include "light/light_edit.h"

#include <math.h>
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
                        [NEEDS_PICTURE] = viewer->block != NULL,
                        [NEEDS_SELECTION] = viewer->block && viewer->edit.selection.kind != SELECTED_NOTHING,
                        [NEEDS_FRAMES] = viewer->player.count > 0};
    uint32_t bits = 0;
    for (size_t i = 0; i < sizeof met / sizeof *met; i++)
        bits |= (uint32_t)met[i] << i;
    return bits;
}

/* Looks along a direction. */
static void face(struct viewer *viewer, double x, double y, double z) {
    fly_camera_face(&viewer->fly_camera, vec3_make(x, y, z));
    viewer_change_view(viewer);
}

static void roll(struct viewer *viewer, double degrees) {
    fly_camera_roll(&viewer->fly_camera, degrees);
    viewer_change_view(viewer);
}

static void do_action(struct viewer *viewer, enum window_action action) {
    struct fly_camera *camera = &viewer->fly_camera;
    switch (action) {
    case DO_SAVE_PICTURE:
        viewer->action = VIEWER_SAVE_IMAGE;
        return;
    case DO_SAVE_VIEW:
        viewer->action = VIEWER_SAVE_CAMERA;
        return;
    case DO_SAVE_CHANGES:
        viewer->action = VIEWER_SAVE_EDITS;
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
        choose_tool(viewer, TOOL_MOVE);
        return;
    case DO_TURN:
        choose_tool(viewer, TOOL_TURN);
        return;
    case DO_SIZE:
        choose_tool(viewer, TOOL_SIZE);
        return;
    case DO_COPY:
        viewer_copy_selection(viewer);
        return;
    case DO_DELETE:
        viewer_delete_selection(viewer);
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

    case DO_ADD_SPHERE:
    case DO_ADD_CUBE:
    case DO_ADD_CYLINDER:
    case DO_ADD_CONE:
    case DO_ADD_TORUS:
        viewer_add_shape(viewer, (enum added_kind)(ADDED_SPHERE + (action - DO_ADD_SPHERE)));
        return;
    case DO_ADD_LIGHT:
        viewer_add_light(viewer);
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
        face(viewer, 0, 0, -1);
        return;
    case DO_VIEW_RIGHT:
        face(viewer, -1, 0, 0);
        return;
    case DO_VIEW_TOP:
        face(viewer, 0, -1, 0);
        return;
    case DO_LEVEL:
        fly_camera_level(camera);
        viewer_change_view(viewer);
        return;
    case DO_ROLL_LEFT:
        roll(viewer, -5);
        return;
    case DO_ROLL_RIGHT:
        roll(viewer, 5);
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
        viewer_choose_mode(viewer, (struct view_mode){true, (enum headlight_shows)(action - DO_SHOW_PREVIEW)});
        return;
    case DO_BOXES:
        viewer_choose_overlay(viewer, OVERLAY_OF_BOXES);
        return;
    case DO_GRID:
        viewer_choose_overlay(viewer, OVERLAY_OF_GRID);
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
        viewer_step_frames(viewer, -1);
        return;
    case DO_NEXT_FRAME:
        viewer_step_frames(viewer, 1);
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
    (void)snprintf(viewer->note, sizeof viewer->note, "window: %s", window_action_table[action].name);
    do_action(viewer, action);
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
    else if (query->serial != 0 || (query->depth > 0 && query->path[0] == SECTION_NODES))
        viewer_select_node(viewer, query);
    else
        viewer->edit.selection.kind = SELECTED_NOTHING;
    viewer->display.hud_dirty = true;
}

/* Beside the root of the scene. */
void viewer_receive_nodes(struct viewer *viewer, const struct node_query *query, struct node_rows *rows) {
    if (query->depth == 0 && query->search[0] == '\0' && rows->count == 1) {
        rows->count = WINDOW_SECTIONS;
        rows->rows[SECTION_LIGHTS] = (struct node_row){.children = viewer->lights.count, .name = "Lights", .kind = " "};
        rows->rows[SECTION_CAMERA] = (struct node_row){.name = "Camera", .kind = " "};
    }
    viewer->window.driver->nodes(viewer->window.driver->context, query, rows);
}

void viewer_handle_event(struct viewer *viewer, const struct window_event *event) {
    switch (event->kind) {
    case WINDOW_CLOSE:
        viewer->quit = true;
        return;
    case WINDOW_KEY:
        if (viewer->block) /* without a scene the camera does not move */
            viewer->fly_camera.down[event->key] = event->down;
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
        viewer_do(viewer, event->action);
        return;
    case WINDOW_NODES:
        want_rows(viewer, &event->node);
        return;
    case WINDOW_SELECT:
        select_row(viewer, &event->node);
        return;
    case WINDOW_HIDE:
        if (viewer->block)
            viewer_hide(viewer, event->node.serial, event->text);
        return;
    case WINDOW_TYPE:
        type(viewer, event->typed);
        return;
    case WINDOW_FIELD:
        viewer_set_field(viewer, event);
        return;
    }
}
