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

static void handle_view_key(struct viewer *viewer, int key, bool control) {
    struct fly_camera *fly_camera = &viewer->fly_camera;
    if (key >= '0' && key <= '9' && control) {
        fly_camera_save(fly_camera, key - '0');
        return;
    }
    switch (key) {
    case 'l':
        fly_camera_level(fly_camera);
        break;
    case '[':
        fly_camera_roll(fly_camera, -5);
        break;
    case ']':
        fly_camera_roll(fly_camera, 5);
        break;
    case WINDOW_HOME:
        fly_camera_home(fly_camera);
        viewer_change_view(viewer);
        viewer->camera_moved = false;
        return;
    /* A digit goes to the view that was saved under it. */
    default:
        if (key < '0' || key > '9' || !fly_camera_recall(fly_camera, key - '0'))
            return;
    }
    viewer_change_view(viewer);
}

/* True: it was a key of animations. */
static bool handle_player_key(struct viewer *viewer, int key) {
    switch (key) {
    case 'k':
        viewer_play(viewer, !viewer->player.playing);
        return true;
    case 'j':
        viewer_step_frames(viewer, 1);
        return true;
    case 'h':
        viewer_step_frames(viewer, -1);
        return true;
    case 'o':
        viewer_player_loop(viewer);
        return true;
    default:
        return false;
    }
}

/* True: it was one of those that need no scene. */
static bool handle_plain_key(struct viewer *viewer, int key) {
    switch (key) {
    case 'q':
        viewer->quit = true;
        return true;
    case 's':
    case 'c':
        if (viewer->name[0] != '\0') /* there was a picture */
            viewer->action = key == 's' ? VIEWER_SAVE_IMAGE : VIEWER_SAVE_EDITS;
        return true;
    case '+':
    case '=':
    case '-':
        viewer_set_exposure(viewer, viewer->request.settings.tone.exposure + (key == '-' ? -0.25 : 0.25));
        return true;
    case 'f':
        viewer->window.driver->full_screen(viewer->window.driver->context);
        return true;
    case 'b':
        viewer_choose_overlay(viewer, OVERLAY_OF_BOXES);
        return true;
    case 'g':
        viewer_choose_overlay(viewer, OVERLAY_OF_GRID);
        return true;
    case WINDOW_TAB:
        viewer->window.hides_hud = !viewer->window.hides_hud;
        viewer->display.hud_dirty = true;
        return true;
    default:
        return false;
    }
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

/* True: it was one of those that change the scene. */
static bool handle_edit_key(struct viewer *viewer, const struct window_event *event) {
    switch (event->key) {
    case 'z':
        if (event->control)
            viewer_undo(viewer, event->shift);
        else
            viewer_choose_tool(viewer, TOOL_SIZE);
        return true;
    case 'y':
        if (event->control)
            viewer_undo(viewer, true);
        return event->control;
    case 'm':
        viewer_choose_tool(viewer, TOOL_MOVE);
        return true;
    case 't':
        viewer_choose_tool(viewer, TOOL_TURN);
        return true;
    case 'p':
        viewer_request_pixel_trace(viewer, viewer->window.panel.mouse_x, viewer->window.panel.mouse_y);
        return true;
    case ',':
    case '.':
        viewer_next_light(viewer, event->key == ',');
        return true;
    case 'i':
        viewer->lights.listed = !viewer->lights.listed;
        viewer->display.hud_dirty = true;
        return true;
    /* The list of a pixel scrolls; without one the selection goes down. */
    case WINDOW_PAGE_DOWN:
        if (viewer->trace.text[0] == '\0')
            viewer_select_up(viewer, true);
        viewer->trace.line += 10;
        viewer->display.hud_dirty = true;
        return true;
    case WINDOW_DELETE:
        viewer_delete_selection(viewer);
        return true;
    case WINDOW_PAGE_UP:
        viewer_select_up(viewer, false);
        return true;
    case WINDOW_ESCAPE:
        if (viewer->input.grabbed)
            return false;
        clear_selection(viewer);
        return true;
    default:
        return false;
    }
}

static void handle_key(struct viewer *viewer, const struct window_event *event) {
    /* Without a scene the camera does not move. */
    if (viewer->block && handle_held_key(viewer, event->key, event->down))
        return;
    if (!event->down || handle_plain_key(viewer, event->key) || handle_player_key(viewer, event->key) ||
        !viewer->block || handle_edit_key(viewer, event))
        return;
    switch (event->key) {
    case 'r':
        viewer_render(viewer);
        return;
    case 'x':
        viewer_halt(viewer, !viewer->pass.halted);
        return;
    case 'n':
        viewer->next = true;
        return;
    case 'v':
        viewer->action = VIEWER_SAVE_CAMERA;
        return;
    case WINDOW_SPACE:
        grab(viewer, !viewer->input.grabbed);
        return;
    case WINDOW_ESCAPE:
        grab(viewer, false);
        return;
    default:
        handle_view_key(viewer, event->key, event->control);
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

static void handle_motion(struct viewer *viewer, const struct window_event *event) {
    double x = event->dx / viewer->window.layout.shown_height, y = event->dy / viewer->window.layout.shown_height;
    viewer->window.panel.mouse_x = event->x;
    viewer->window.panel.mouse_y = event->y;
    viewer->display.hud_dirty = viewer->display.hud_dirty || !viewer->input.grabbed;
    if (!viewer->block || (!viewer->input.grabbed && !(viewer->input.pressed && is_drag(viewer))))
        return;
    if (!viewer->input.grabbed && viewer->edit.tool != TOOL_NONE && viewer->edit.selection.kind != SELECTED_NOTHING) {
        viewer_drag_selection(viewer, event->dx, event->dy);
        return;
    }
    if (viewer->input.grabbed)
        fly_camera_turn(&viewer->fly_camera, x, y);
    else
        fly_camera_orbit(&viewer->fly_camera, x, y);
    viewer_change_view(viewer);
}

static void press_picture(struct viewer *viewer, const struct window_event *event) {
    if (event->button == WINDOW_RIGHT)
        grab(viewer, !viewer->input.grabbed);
    if (event->button != WINDOW_LEFT || viewer->input.grabbed)
        return;
    viewer->input.pressed = true;
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
    if (!down && event->button == WINDOW_LEFT && viewer->input.pressed) {
        viewer->input.pressed = false;
        if (viewer->block && !is_drag(viewer))
            viewer_click(viewer, event->x, event->y, event->control);
    }
    if (down && !covered && viewer->block)
        press_picture(viewer, event);
}

static void handle_wheel(struct viewer *viewer, double steps) {
    if (!viewer->block)
        return;
    if (viewer->edit.tool == TOOL_MOVE && viewer->edit.selection.kind != SELECTED_NOTHING && !viewer->input.grabbed) {
        viewer_push_selection(viewer, steps);
        return;
    }
    fly_camera_zoom(&viewer->fly_camera, steps);
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
        handle_wheel(viewer, event->y);
        return;
    case WINDOW_PRESS:
    case WINDOW_RELEASE:
        handle_button(viewer, event, event->kind == WINDOW_PRESS);
        return;
    /* What happens outside is not reported: keys count as released. */
    case WINDOW_LEAVE:
        memset(viewer->fly_camera.down, 0, sizeof viewer->fly_camera.down);
        viewer->input.pressed = false;
        viewer->window.panel.held = 0;
        return;
    case WINDOW_SIZE:
        if (!viewer_resize(viewer, (int)event->x, (int)event->y, event->density))
            viewer_show_message(viewer, "gray: out of memory for a window of this size");
        return;
    }
}
