/* What people do with keys and the mouse. */
#include "viewer/viewer_internal.h"

#include <string.h>

void live_change_view(struct live *live) {
    live->moved = live->flown = true;
    live_halt(live, false);
}

void live_halt(struct live *live, bool on) {
    on = on && live->block && !live_is_idle(live);
    if (on == live->halted)
        return;
    live->halted = on;
    live->halted_at = on && !live->waiting ? live->stepped : 0;
    if (on && live->waiting) /* between two passes */
        live_note_stop(live, 0);
    live->over_dirty = true;
    live->told = 0;
}

void live_render(struct live *live) {
    if (!live->block)
        return;
    live->again = live->moved = true;
    live_halt(live, false);
}

static void grab(struct live *live, bool on) {
    live->grabbed = on;
    memset(live->walk.down, 0, sizeof live->walk.down);
    live->driver->grab(live->driver->context, on);
}

/* Keys that are held. True: it was one. */
static bool take_held_key(struct live *live, int key, bool down) {
    static const struct {
        int key;
        enum walk_key walk;
        bool only_grabbed; /* the letter is a command otherwise */
    } keys[] = {{WINDOW_ARROW_UP, WALK_FORWARD, false},
                {WINDOW_ARROW_DOWN, WALK_BACK, false},
                {WINDOW_ARROW_LEFT, WALK_LEFT, false},
                {WINDOW_ARROW_RIGHT, WALK_RIGHT, false},
                {WINDOW_SHIFT, WALK_FAST, false},
                {WINDOW_CONTROL, WALK_SLOW, false},
                {'w', WALK_FORWARD, true},
                {'s', WALK_BACK, true},
                {'a', WALK_LEFT, true},
                {'d', WALK_RIGHT, true},
                {'e', WALK_UP, true},
                {'q', WALK_DOWN, true}};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        if (keys[i].key == key && (live->grabbed || !keys[i].only_grabbed)) {
            live->walk.down[keys[i].walk] = down;
            return true;
        }
    }
    return false;
}

static void take_view_key(struct live *live, int key, bool control) {
    struct walk *walk = &live->walk;
    if (key >= '0' && key <= '9' && control) {
        walk_save(walk, key - '0');
        return;
    }
    switch (key) {
    case 'l':
        walk_level(walk);
        break;
    case '[':
        walk_roll(walk, -5);
        break;
    case ']':
        walk_roll(walk, 5);
        break;
    case WINDOW_HOME:
        walk_home(walk);
        live_change_view(live);
        live->flown = false;
        return;
    default:
        if (key < '0' || key > '9' || !walk_recall(walk, key - '0'))
            return;
    }
    live_change_view(live);
}

/* True: it was one of those that need no scene. */
static bool take_plain_key(struct live *live, int key) {
    switch (key) {
    case 'q':
        live->quit = true;
        return true;
    case 's':
        live->wish = LIVE_SAVE;
        return true;
    case 'c':
        live->wish = LIVE_CHANGES;
        return true;
    case '+':
    case '=':
    case '-':
        live_expose(live, live->request.exposure + (key == '-' ? -0.25 : 0.25));
        return true;
    case 'f':
        live->driver->full_screen(live->driver->context);
        return true;
    case 'b':
        live_choose_overlay(live, OVERLAY_OF_BOXES);
        return true;
    case 'g':
        live_choose_overlay(live, OVERLAY_OF_GRID);
        return true;
    case WINDOW_TAB:
        live->bare = !live->bare;
        live->over_dirty = true;
        return true;
    default:
        return false;
    }
}

static void choose_tool(struct live *live, enum live_tool tool) {
    live->tool = live->tool == tool ? TOOL_NONE : tool;
    live->joins = false;
    live->over_dirty = true;
}

/* Esc, while the mouse is free: what was chosen, and where nothing was, what is being made. */
static void put_away(struct live *live) {
    bool something = live->selection.kind != SELECTED_NOTHING || live->tool != TOOL_NONE || live->story[0] != '\0';
    if (!something)
        live_halt(live, true);
    live->selection.kind = SELECTED_NOTHING;
    live->tool = TOOL_NONE;
    live->story[0] = '\0';
    live->over_dirty = true;
}

/* True: it was one of those that change the scene. */
static bool take_edit_key(struct live *live, const struct window_event *event) {
    switch (event->key) {
    case 'z':
        if (event->control)
            live_undo(live, event->shift);
        else
            choose_tool(live, TOOL_SIZE);
        return true;
    case 'y':
        if (event->control)
            live_undo(live, true);
        return event->control;
    case 'm':
        choose_tool(live, TOOL_MOVE);
        return true;
    case 't':
        choose_tool(live, TOOL_TURN);
        return true;
    case 'p':
        live_ask_story(live, live->panel.mouse_x, live->panel.mouse_y);
        return true;
    case ',':
    case '.':
        live_next_light(live, event->key == ',');
        return true;
    case 'i':
        live->lists_lights = !live->lists_lights;
        live->over_dirty = true;
        return true;
    case WINDOW_PAGE_DOWN:
        if (live->story[0] == '\0')
            live_select_up(live, true);
        live->story_line += 10;
        live->over_dirty = true;
        return true;
    case WINDOW_DELETE:
        live_delete(live);
        return true;
    case WINDOW_PAGE_UP:
        live_select_up(live, false);
        return true;
    case WINDOW_ESCAPE:
        if (live->grabbed)
            return false;
        put_away(live);
        return true;
    default:
        return false;
    }
}

static void take_key(struct live *live, const struct window_event *event) {
    /* Without a scene there is nowhere to walk to. */
    if (live->block && take_held_key(live, event->key, event->down))
        return;
    if (!event->down || take_plain_key(live, event->key) || !live->block || take_edit_key(live, event))
        return;
    switch (event->key) {
    case 'r':
        live_render(live);
        return;
    case 'x':
        live_halt(live, !live->halted);
        return;
    case 'n':
        live->next = true;
        return;
    case 'v':
        live->wish = LIVE_RECORD;
        return;
    case WINDOW_SPACE:
        grab(live, !live->grabbed);
        return;
    case WINDOW_ESCAPE:
        grab(live, false);
        return;
    default:
        take_view_key(live, event->key, event->control);
        return;
    }
}

/* A little way is still a click. */
static bool is_drag(struct live *live) {
    double x = live->panel.mouse_x - live->press_x, y = live->panel.mouse_y - live->press_y;
    double limit = 3 * live->place.density;
    live->dragged = live->dragged || x * x + y * y > limit * limit;
    return live->dragged;
}

static void take_motion(struct live *live, const struct window_event *event) {
    double x = event->dx / live->place.shown_height, y = event->dy / live->place.shown_height;
    live->panel.mouse_x = event->x;
    live->panel.mouse_y = event->y;
    live->over_dirty = live->over_dirty || !live->grabbed;
    if (!live->block || (!live->grabbed && !(live->pressed && is_drag(live))))
        return;
    if (!live->grabbed && live->tool != TOOL_NONE && live->selection.kind != SELECTED_NOTHING) {
        live_drag(live, event->dx, event->dy);
        return;
    }
    if (live->grabbed)
        walk_look(&live->walk, x, y);
    else
        walk_orbit(&live->walk, x, y);
    live_change_view(live);
}

static void press_picture(struct live *live, const struct window_event *event) {
    if (event->button == WINDOW_RIGHT)
        grab(live, !live->grabbed);
    if (event->button != WINDOW_LEFT || live->grabbed)
        return;
    live->pressed = true;
    live->dragged = live->joins = false;
    live->press_x = event->x;
    live->press_y = event->y;
}

static void take_button(struct live *live, const struct window_event *event, bool down) {
    struct panel *panel = &live->panel;
    bool covered = panel_covers(panel, event->x, event->y);
    if (!live->grabbed) {
        panel->mouse_x = event->x;
        panel->mouse_y = event->y;
    }
    live->over_dirty = true;
    if (event->button == WINDOW_LEFT && !live->grabbed) {
        panel->down = down;
        panel->pressed = panel->pressed || (down && covered);
        panel->released = panel->released || !down;
    }
    if (!down && event->button == WINDOW_LEFT && live->pressed) {
        live->pressed = false;
        if (live->block && !is_drag(live))
            live_click(live, event->x, event->y, event->control);
    }
    if (down && !covered && live->block)
        press_picture(live, event);
}

static void take_wheel(struct live *live, double steps) {
    if (!live->block)
        return;
    if (live->tool == TOOL_MOVE && live->selection.kind != SELECTED_NOTHING && !live->grabbed) {
        live_push(live, steps);
        return;
    }
    walk_zoom(&live->walk, steps);
    live_change_view(live);
}

void live_take_event(struct live *live, const struct window_event *event) {
    switch (event->kind) {
    case WINDOW_CLOSE:
        live->quit = true;
        return;
    case WINDOW_KEY:
        take_key(live, event);
        return;
    case WINDOW_MOVE:
        take_motion(live, event);
        return;
    case WINDOW_WHEEL:
        take_wheel(live, event->y);
        return;
    case WINDOW_PRESS:
    case WINDOW_RELEASE:
        take_button(live, event, event->kind == WINDOW_PRESS);
        return;
    case WINDOW_LEAVE:
        memset(live->walk.down, 0, sizeof live->walk.down);
        live->pressed = false;
        live->panel.held = 0;
        return;
    case WINDOW_SIZE:
        if (!live_resize(live, (int)event->x, (int)event->y, event->density))
            live_tell(live, "gray: out of memory for a window of this size");
        return;
    }
}
