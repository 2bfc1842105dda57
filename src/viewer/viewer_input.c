/* Keys and the mouse. */
#include "viewer/viewer_internal.h"

#include <string.h>

void viewer_change_view(struct viewer *viewer) {
    viewer->pass.outdated = viewer->camera_moved = true;
    viewer_halt(viewer, false);
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

void viewer_render(struct viewer *viewer) {
    if (!viewer->block)
        return;
    viewer->pass.from_coarse = viewer->pass.outdated = true;
    viewer_halt(viewer, false);
}

static void grab(struct viewer *viewer, bool on) {
    viewer->input.grabbed = on;
    memset(viewer->fly_camera.down, 0, sizeof viewer->fly_camera.down);
    viewer->window.driver->grab(viewer->window.driver->context, on);
}

/* Keys with an effect while they are pressed. True: it was one. */
static bool handle_held_key(struct viewer *viewer, int key, bool down) {
    static const struct {
        int key;
        enum fly_camera_key fly_camera;
        bool only_grabbed; /* otherwise the letter is a command */
    } keys[] = {{WINDOW_ARROW_UP, FLY_FORWARD, false},
                {WINDOW_ARROW_DOWN, FLY_BACK, false},
                {WINDOW_ARROW_LEFT, FLY_LEFT, false},
                {WINDOW_ARROW_RIGHT, FLY_RIGHT, false},
                {WINDOW_SHIFT, FLY_FAST, false},
                {WINDOW_CONTROL, FLY_SLOW, false},
                {'w', FLY_FORWARD, true},
                {'s', FLY_BACK, true},
                {'a', FLY_LEFT, true},
                {'d', FLY_RIGHT, true},
                {'e', FLY_UP, true},
                {'q', FLY_DOWN, true}};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        if (keys[i].key == key && (viewer->input.grabbed || !keys[i].only_grabbed)) {
            viewer->fly_camera.down[keys[i].fly_camera] = down;
            return true;
        }
    }
    return false;
}

/* Views. */

/* A digit stores a view, or returns to the one that is stored under it. */
static void handle_digit(struct viewer *viewer, int digit, bool stores) {
    if (stores)
        fly_camera_save(&viewer->fly_camera, digit);
    else if (fly_camera_recall(&viewer->fly_camera, digit))
        viewer_change_view(viewer);
}

static void go_home(struct viewer *viewer) {
    fly_camera_home(&viewer->fly_camera);
    viewer_change_view(viewer);
    viewer->camera_moved = false;
}

static void do_view(struct viewer *viewer, enum window_action action) {
    struct fly_camera *fly_camera = &viewer->fly_camera;
    switch ((int)action) {
    case DO_CAMERA:
        go_home(viewer);
        return;
    case DO_FLY:
        grab(viewer, !viewer->input.grabbed);
        return;
    case DO_LEVEL:
        fly_camera_level(fly_camera);
        break;
    case DO_ROLL_LEFT:
    case DO_ROLL_RIGHT:
        fly_camera_roll(fly_camera, action == DO_ROLL_LEFT ? -5 : 5);
        break;
    case DO_VIEW_FRONT:
        fly_camera_face(fly_camera, vec3_make(0, 0, -1));
        break;
    case DO_VIEW_RIGHT:
        fly_camera_face(fly_camera, vec3_make(-1, 0, 0));
        break;
    case DO_VIEW_TOP:
        fly_camera_face(fly_camera, vec3_make(0, -1, 0));
        break;
    case DO_FRAME:
    case DO_FRAME_ALL:
        viewer_frame(viewer, action == DO_FRAME);
        break;
    default:
        return;
    }
    viewer_change_view(viewer);
}

void viewer_choose_tool(struct viewer *viewer, enum edit_tool tool) {
    viewer->edit.tool = viewer->edit.tool == tool ? TOOL_NONE : tool;
    viewer->edit.joins = false;
    viewer->display.hud_dirty = true;
}

/* Esc, while the mouse is not grabbed: ends the selection; without a selection, stops the pass. */
static void clear_selection(struct viewer *viewer) {
    bool something = viewer->edit.selection.kind != SELECTED_NOTHING || viewer->edit.tool != TOOL_NONE ||
                     viewer->trace.text[0] != '\0';
    if (!something)
        viewer_halt(viewer, true);
    viewer->edit.selection.kind = SELECTED_NOTHING;
    viewer->edit.tool = TOOL_NONE;
    viewer->trace.text[0] = '\0';
    viewer->display.hud_dirty = true;
}

static void do_edit(struct viewer *viewer, enum window_action action) {
    viewer->edit.joins = false;
    switch ((int)action) {
    case DO_UNDO:
    case DO_REDO:
        viewer_undo(viewer, action == DO_REDO);
        return;
    case DO_MOVE:
        viewer_choose_tool(viewer, TOOL_MOVE);
        return;
    case DO_TURN:
        viewer_choose_tool(viewer, TOOL_TURN);
        return;
    case DO_SIZE:
        viewer_choose_tool(viewer, TOOL_SIZE);
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
    case DO_NEXT_LIGHT:
    case DO_PREVIOUS_LIGHT:
        viewer_next_light(viewer, action == DO_PREVIOUS_LIGHT);
        return;
    case DO_ADD_LIGHT:
        viewer_add_light(viewer);
        return;
    /* The list of a pixel scrolls; without one the selection goes down. */
    case DO_SELECT_OPERAND:
        if (viewer->trace.text[0] == '\0')
            viewer_select_up(viewer, true);
        viewer->trace.line += 10;
        viewer->display.hud_dirty = true;
        return;
    case DO_SELECT_PARENT:
        viewer_select_up(viewer, false);
        return;
    case DO_ESCAPE:
        if (viewer->input.grabbed)
            grab(viewer, false);
        else
            clear_selection(viewer);
        return;
    default:
        viewer_add_node(viewer, (enum added_kind)(ADDED_SPHERE + (action - DO_ADD_SPHERE)));
    }
}

static void do_animation(struct viewer *viewer, enum window_action action) {
    if (action == DO_PLAY)
        viewer_play(viewer, !viewer->player.playing);
    else if (action == DO_LOOP)
        viewer_player_loop(viewer);
    else
        viewer_step_frames(viewer, action == DO_NEXT_FRAME ? 1 : -1);
}

static void do_picture(struct viewer *viewer, enum window_action action) {
    switch ((int)action) {
    case DO_RENDER:
        if (!viewer->block && viewer->window.waits)
            viewer->action = VIEWER_RUN_AGAIN;
        viewer_render(viewer);
        return;
    case DO_STOP:
        viewer_halt(viewer, !viewer->pass.halted);
        return;
    case DO_PIXEL_TRACE:
        viewer_request_pixel_trace(viewer, viewer->window.panel.mouse_x, viewer->window.panel.mouse_y);
        return;
    default:
        viewer_set_exposure(viewer, viewer->request.settings.tone.exposure + (action == DO_DARKER ? -0.25 : 0.25));
    }
}

/* Files, the window, and what is drawn over the picture. */
static void do_window(struct viewer *viewer, enum window_action action) {
    switch ((int)action) {
    case DO_SAVE_PICTURE:
        viewer->action = VIEWER_SAVE_IMAGE;
        return;
    case DO_SAVE_VIEW:
        viewer->action = VIEWER_SAVE_CAMERA;
        return;
    case DO_SAVE_CHANGES:
        viewer->action = VIEWER_SAVE_EDITS;
        return;
    case DO_NEXT_PICTURE:
        viewer->next = true;
        return;
    case DO_QUIT:
        viewer->quit = true;
        return;
    case DO_BOXES:
    case DO_GRID:
        viewer_choose_overlay(viewer, action == DO_BOXES ? OVERLAY_OF_BOXES : OVERLAY_OF_GRID);
        return;
    case DO_FULL_SCREEN:
        viewer->window.driver->full_screen(viewer->window.driver->context);
        return;
    default:
        viewer->window.hides_hud = !viewer->window.hides_hud;
        viewer->display.hud_dirty = true;
    }
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

void viewer_do(struct viewer *viewer, enum window_action action) {
    const struct window_action_row *row = &window_action_table[action];
    /* What a selection must be is checked by each function: a tool may be chosen before. */
    enum action_need need = row->need == NEEDS_SELECTION ? NEEDS_PICTURE : row->need;
    if (!(viewer_needs_met(viewer) >> need & 1))
        return;
    bool is_view = row->menu == MENU_VIEW && row->need != NEEDS_NOTHING && action != DO_BOXES && action != DO_GRID;
    if (is_view)
        do_view(viewer, action);
    else if (row->menu == MENU_EDIT || row->menu == MENU_ADD)
        do_edit(viewer, action);
    else if (row->menu == MENU_ANIMATION)
        do_animation(viewer, action);
    else if (row->menu == MENU_PICTURE)
        do_picture(viewer, action);
    else
        do_window(viewer, action);
}

/* Keys of a window without widgets; with control first. */
static const struct {
    int key;
    bool control;
    enum window_action action;
} action_keys[] = {{'z', true, DO_UNDO},
                   {'y', true, DO_REDO},
                   {'q', false, DO_QUIT},
                   {'s', false, DO_SAVE_PICTURE},
                   {'c', false, DO_SAVE_CHANGES},
                   {'v', false, DO_SAVE_VIEW},
                   {'n', false, DO_NEXT_PICTURE},
                   {'+', false, DO_BRIGHTER},
                   {'=', false, DO_BRIGHTER},
                   {'-', false, DO_DARKER},
                   {'f', false, DO_FULL_SCREEN},
                   {'b', false, DO_BOXES},
                   {'g', false, DO_GRID},
                   {WINDOW_TAB, false, DO_HIDE},
                   {'k', false, DO_PLAY},
                   {'j', false, DO_NEXT_FRAME},
                   {'h', false, DO_PREVIOUS_FRAME},
                   {'o', false, DO_LOOP},
                   {'z', false, DO_SIZE},
                   {'m', false, DO_MOVE},
                   {'t', false, DO_TURN},
                   {'p', false, DO_PIXEL_TRACE},
                   {'.', false, DO_NEXT_LIGHT},
                   {',', false, DO_PREVIOUS_LIGHT},
                   {WINDOW_PAGE_DOWN, false, DO_SELECT_OPERAND},
                   {WINDOW_PAGE_UP, false, DO_SELECT_PARENT},
                   {WINDOW_DELETE, false, DO_DELETE},
                   {WINDOW_ESCAPE, false, DO_ESCAPE},
                   {'r', false, DO_RENDER},
                   {'x', false, DO_STOP},
                   {'l', false, DO_LEVEL},
                   {'[', false, DO_ROLL_LEFT},
                   {']', false, DO_ROLL_RIGHT},
                   {WINDOW_HOME, false, DO_CAMERA},
                   {WINDOW_SPACE, false, DO_FLY}};

static void handle_key(struct viewer *viewer, const struct window_event *event) {
    /* Without a scene the camera does not move. */
    if ((viewer->block && handle_held_key(viewer, event->key, event->down)) || !event->down)
        return;
    if (viewer->block && event->key >= '0' && event->key <= '9')
        handle_digit(viewer, event->key - '0', event->control);
    if (viewer->block && event->key == 'i') {
        viewer->lights.listed = !viewer->lights.listed;
        viewer->display.hud_dirty = true;
    }
    for (size_t i = 0; i < sizeof action_keys / sizeof *action_keys; i++) {
        bool redoes = action_keys[i].action == DO_UNDO && event->shift;
        if (action_keys[i].key != event->key || (action_keys[i].control && !event->control))
            continue;
        viewer_do(viewer, redoes ? DO_REDO : action_keys[i].action);
        return;
    }
}

/* A movement over a short distance is still a click. */
static bool is_drag(struct viewer *viewer) {
    double x = viewer->window.panel.mouse_x - viewer->input.press_x,
           y = viewer->window.panel.mouse_y - viewer->input.press_y;
    double limit = 3 * viewer->window.layout.density;
    viewer->input.dragged = viewer->input.dragged || x * x + y * y > limit * limit;
    return viewer->input.dragged;
}

/* The mouse turns the camera without a button. */
static bool turns_freely(const struct viewer *viewer) {
    return viewer->input.grabbed && !viewer_has_widgets(viewer);
}

static void handle_motion(struct viewer *viewer, const struct window_event *event) {
    double x = event->dx / viewer->window.layout.shown_height, y = event->dy / viewer->window.layout.shown_height;
    viewer->window.panel.mouse_x = event->x;
    viewer->window.panel.mouse_y = event->y;
    viewer->display.hud_dirty = viewer->display.hud_dirty || !viewer->input.grabbed;
    if (!viewer->block || !(viewer->input.pressed ? is_drag(viewer) : turns_freely(viewer)))
        return;
    bool edits = viewer->edit.tool != TOOL_NONE && viewer->edit.selection.kind != SELECTED_NOTHING;
    if (viewer->input.pressed == WINDOW_LEFT && !viewer->input.grabbed && edits) {
        viewer_drag_selection(viewer, event->dx, event->dy);
        return;
    }
    if (viewer->input.grabbed || viewer->input.pressed == WINDOW_RIGHT)
        fly_camera_turn(&viewer->fly_camera, x, y);
    else if (viewer->input.shift && viewer_has_widgets(viewer))
        fly_camera_pan(&viewer->fly_camera, x, y);
    else
        fly_camera_orbit(&viewer->fly_camera, x, y);
    viewer_change_view(viewer);
}

static void press_picture(struct viewer *viewer, const struct window_event *event) {
    if (event->button == WINDOW_RIGHT && !viewer_has_widgets(viewer))
        grab(viewer, !viewer->input.grabbed);
    bool navigates = event->button != WINDOW_LEFT && viewer_has_widgets(viewer);
    if (navigates)
        viewer_probe(viewer, event->x, event->y);
    if (!navigates && (event->button != WINDOW_LEFT || viewer->input.grabbed))
        return;
    viewer->input.pressed = event->button;
    viewer->input.shift = event->shift;
    viewer->input.dragged = viewer->edit.joins = false;
    viewer->input.press_x = event->x;
    viewer->input.press_y = event->y;
}

static void handle_button(struct viewer *viewer, const struct window_event *event, bool down) {
    struct panel *panel = &viewer->window.panel;
    bool covered = panel_covers(panel, event->x, event->y);
    if (!viewer->input.grabbed) {
        panel->mouse_x = event->x;
        panel->mouse_y = event->y;
    }
    viewer->display.hud_dirty = true;
    if (event->button == WINDOW_LEFT && !viewer->input.grabbed) {
        panel->down = down;
        panel->pressed = panel->pressed || (down && covered);
        panel->released = panel->released || !down;
    }
    if (!down && event->button == viewer->input.pressed) {
        viewer->input.pressed = 0;
        if (viewer->block && event->button == WINDOW_LEFT && !is_drag(viewer))
            viewer_click(viewer, event->x, event->y, event->control);
    }
    if (down && !covered && viewer->block)
        press_picture(viewer, event);
}

/* Towards what is under the cursor, as far as it was probed; in a window without widgets, and with control, the wheel
 * changes the angle of view. */
static void handle_wheel(struct viewer *viewer, const struct window_event *event) {
    const struct window_layout *layout = &viewer->window.layout;
    double steps = event->y;
    if (!viewer->block)
        return;
    if (viewer->edit.tool == TOOL_MOVE && viewer->edit.selection.kind != SELECTED_NOTHING && !viewer->input.grabbed) {
        viewer_push_selection(viewer, steps);
        return;
    }
    if (!viewer_has_widgets(viewer) || event->control) {
        fly_camera_zoom(&viewer->fly_camera, steps);
    } else {
        const struct panel *panel = &viewer->window.panel;
        viewer_probe(viewer, panel->mouse_x, panel->mouse_y);
        double x = (panel->mouse_x - layout->left - layout->shown_width / 2) / layout->shown_height;
        double y = (panel->mouse_y - layout->top - layout->shown_height / 2) / layout->shown_height;
        fly_camera_dolly(&viewer->fly_camera, x, y, steps);
    }
    viewer_change_view(viewer);
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
    case WINDOW_RELEASE:
        handle_button(viewer, event, event->kind == WINDOW_PRESS);
        return;
    /* What happens outside is not reported: keys count as released. */
    case WINDOW_LEAVE:
        memset(viewer->fly_camera.down, 0, sizeof viewer->fly_camera.down);
        viewer->input.pressed = 0;
        viewer->window.panel.held = 0;
        return;
    case WINDOW_SIZE:
        if (!viewer_resize(viewer, (int)event->x, (int)event->y, event->density))
            viewer_show_message(viewer, "gray: out of memory for a window of this size");
        return;
    case WINDOW_ACTION:
        viewer->window.panel.mouse_x = event->x;
        viewer->window.panel.mouse_y = event->y;
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
