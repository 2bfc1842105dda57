/* Actions, keys and the mouse. */
#include "viewer/viewer_internal.h"

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
    if (!viewer->block && viewer->window.waits)
        viewer->action = VIEWER_RUN_AGAIN;
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

/* Ends what is going on, from the inside out: flying, the selection and the trace, rendering. */
static void escape(struct viewer *viewer) {
    bool something = viewer->edit.selection.kind != SELECTED_NOTHING || viewer->edit.tool != TOOL_NONE ||
                     viewer->trace.text[0] != '\0';
    if (viewer->input.flies) {
        fly(viewer, false);
        return;
    }
    if (!something)
        viewer_halt(viewer, true);
    viewer->edit.selection.kind = SELECTED_NOTHING;
    viewer->edit.tool = TOOL_NONE;
    viewer->trace.text[0] = '\0';
}

static void choose_tool(struct viewer *viewer, enum edit_tool tool) {
    viewer->edit.tool = viewer->edit.tool == tool ? TOOL_NONE : tool;
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
        viewer_add_node(viewer, ADDED_COPY);
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
        viewer_add_node(viewer, (enum added_kind)(ADDED_SPHERE + (action - DO_ADD_SPHERE)));
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
    /* What a selection must be is checked by each function: a tool may be chosen before. */
    enum action_need need = window_action_table[action].need;
    need = need == NEEDS_SELECTION ? NEEDS_PICTURE : need;
    if (!(viewer_needs_met(viewer) >> need & 1))
        return;
    viewer->edit.joins = false;
    viewer->display.hud_dirty = true;
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

static bool has_tool(const struct viewer *viewer) {
    return viewer->edit.tool != TOOL_NONE && viewer->edit.selection.kind != SELECTED_NOTHING && !viewer->input.flies;
}

static void handle_motion(struct viewer *viewer, const struct window_event *event) {
    double x = event->dx / viewer->window.layout.shown_height, y = event->dy / viewer->window.layout.shown_height;
    take_position(viewer, event);
    if (!viewer->block || !viewer->input.pressed || !is_drag(viewer))
        return;
    if (viewer->input.pressed == WINDOW_LEFT && has_tool(viewer)) {
        viewer_drag_selection(viewer, event->dx, event->dy);
        return;
    }
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
    if (viewer->block && clicks && !is_drag(viewer))
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
        if (viewer->block && viewer->nodes.count < NODE_QUERIES)
            viewer->nodes.wanted[viewer->nodes.count++] = event->node;
        return;
    case WINDOW_SELECT:
        viewer->edit.click = (struct selection){0};
        viewer->edit.node = event->node;
        viewer->edit.by_node = viewer->edit.click_waits = viewer->block != NULL;
        viewer->edit.probes = false;
        return;
    case WINDOW_FIELD:
        viewer_set_field(viewer, event);
        return;
    }
}
