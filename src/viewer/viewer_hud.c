/* What lies over the picture: the outline of what is selected, marks of the lights, the menu, the figures, and what is
 * known of the selection. Everything is told anew for every frame; what is clicked is done at once. */
#include "inspect/inspect.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct ink outline = {255, 190, 60, 255}, gray = {170, 176, 186, 255};

/* On the picture. */

static void draw_selection(struct live *live, const struct camera_frame *frame) {
    const struct picked *picked = &live->selection.picked;
    struct vec3 corners[8];
    if (live->selection.kind != SELECTED_NODE)
        return;
    double x, y;
    if (live_project(live, frame, live_moved_point(live, picked->position), &x, &y))
        paper_ring(&live->panel.paper, x, y, 3 * live->panel.paper.scale, outline);
    /* Of an operand much may not be seen at all: its box shows where it is. */
    if (live_draw_outline(live, outline) && picked->solid == 0)
        return;
    for (int i = 0; i < 8 && picked->has_box; i++)
        corners[i] = live_moved_point(live, picked->corners[i]);
    for (int i = 0; i < 8 && picked->has_box; i++) {
        for (int axis = 1; axis < 8; axis *= 2) {
            if (!(i & axis))
                live_draw_edge(live, frame, corners[i], corners[i | axis], outline);
        }
    }
}

/* The menu. */

/* on: by bit, which of them are drawn as chosen. */
static int tell_buttons(struct live *live, int y, const char *const *words, int count, unsigned on, bool *used) {
    struct panel *panel = &live->panel;
    int scale = panel->paper.scale, x = 2 * scale;
    for (int i = 0; i < count; i++) {
        int width = panel_button_width(panel, words[i]);
        if (x + width > panel->paper.width)
            break;
        used[i] = panel_button(panel, x, y, words[i], on >> i & 1);
        x += width + 2 * scale;
    }
    return x;
}

#define MENU(X)                                                                                                        \
    X(MENU_RENDER, "Render")                                                                                           \
    X(MENU_QUIT, "Quit")                                                                                               \
    X(MENU_STOP, "Stop")                                                                                               \
    X(MENU_SAVE_PICTURE, "Save picture")                                                                               \
    X(MENU_SAVE_VIEW, "Save view")                                                                                     \
    X(MENU_SAVE_CHANGES, "Save changes")                                                                               \
    X(MENU_HIDE, "Hide")                                                                                               \
    X(MENU_LIGHTS, "Lights")                                                                                           \
    X(MENU_BOXES, "Boxes")                                                                                             \
    X(MENU_GRID, "Grid")
enum { MENU(LIST_MEMBER) };

static void tell_menu(struct live *live) {
    static const char *const words[] = {MENU(LIST_WORD)};
    struct panel *panel = &live->panel;
    bool used[LIST_COUNT(MENU)] = {false};
    unsigned on = (live->halted ? 1u << MENU_STOP : 0) | (live->overlay == OVERLAY_OF_BOXES ? 1u << MENU_BOXES : 0) |
                  (live->overlay == OVERLAY_OF_GRID ? 1u << MENU_GRID : 0);
    panel_ground(panel, 0, 0, panel->paper.width, 15 * panel->paper.scale);
    (void)tell_buttons(live, 2 * panel->paper.scale, words, LIST_COUNT(MENU), on, used);
    if (used[MENU_RENDER])
        live_render(live);
    live->quit = live->quit || used[MENU_QUIT];
    if (used[MENU_STOP])
        live_halt(live, !live->halted);
    if (used[MENU_SAVE_PICTURE])
        live->wish = LIVE_SAVE;
    else if (used[MENU_SAVE_VIEW] && live->block)
        live->wish = LIVE_RECORD;
    else if (used[MENU_SAVE_CHANGES])
        live->wish = LIVE_CHANGES;
    live->bare = live->bare || used[MENU_HIDE];
    if (used[MENU_BOXES] || used[MENU_GRID])
        live_choose_overlay(live, used[MENU_BOXES] ? OVERLAY_OF_BOXES : OVERLAY_OF_GRID);
    live->lists_lights = live->lists_lights != used[MENU_LIGHTS];
}

/* Undoing, adding, exposure: a second row. */
#define WORK(X)                                                                                                        \
    X(WORK_UNDO, "Undo")                                                                                               \
    X(WORK_REDO, "Redo")                                                                                               \
    X(WORK_SPHERE, "Sphere")                                                                                           \
    X(WORK_CUBE, "Cube")                                                                                               \
    X(WORK_CYLINDER, "Cylinder")                                                                                       \
    X(WORK_CONE, "Cone")                                                                                               \
    X(WORK_TORUS, "Torus")                                                                                             \
    X(WORK_LIGHT, "Light")
enum { WORK(LIST_MEMBER) };

static void tell_work(struct live *live) {
    static const char *const words[] = {WORK(LIST_WORD)};
    struct panel *panel = &live->panel;
    int scale = panel->paper.scale, y = 17 * scale, wide = 10 * PAPER_CELL * scale;
    bool used[LIST_COUNT(WORK)] = {false};
    panel_ground(panel, 0, 15 * scale, panel->paper.width, 15 * scale);
    int x = tell_buttons(live, y, words, LIST_COUNT(WORK), 0, used);
    if (used[WORK_UNDO] || used[WORK_REDO])
        live_undo(live, used[WORK_REDO]);
    if (used[WORK_SPHERE])
        live_add(live, ADDED_SPHERE);
    if (used[WORK_CUBE])
        live_add(live, ADDED_CUBE);
    if (used[WORK_CYLINDER])
        live_add(live, ADDED_CYLINDER);
    if (used[WORK_CONE])
        live_add(live, ADDED_CONE);
    if (used[WORK_TORUS])
        live_add(live, ADDED_TORUS);
    if (used[WORK_LIGHT])
        live_add_light(live);
    char text[48];
    double stops = live->request.exposure;
    (void)snprintf(text, sizeof text, "%+.2f stops", stops);
    if (x + 2 * wide > panel->paper.width)
        return;
    if (panel_slider(panel, x + 2 * scale, y + 2 * scale, wide, -4, 4, gray, &stops))
        live_expose(live, stops);
    panel_text(panel, x + 4 * scale + wide, y + 2 * scale, text);
}

static int tell_figures(struct live *live, const struct figures *figures, int top) {
    struct panel *panel = &live->panel;
    int scale = panel->paper.scale, line = panel_line_height(panel), y = top + 2 * scale, x = 2 * scale;
    const char *const rows[] = {figures->rays, figures->triangles, figures->voxels, figures->frames};
    int count = panel->paper.height >= 24 * line ? 4 : 0, width = 33 * PAPER_CELL * scale;
    int height = (count + 1) * line + 3 * scale;
    panel_ground(panel, 0, top, width, height);
    panel_bar(panel, x, y, 8 * PAPER_CELL * scale, figures->share);
    panel_text(panel, x + 9 * PAPER_CELL * scale, y, figures->state);
    for (int i = 0; i < count; i++)
        panel_text(panel, x, y + (i + 1) * line, rows[i]);
    return top + height;
}

/* The story of a pixel, from the line on that was scrolled to; after its end it begins again. */
static void tell_story(struct live *live, int top) {
    struct panel *panel = &live->panel;
    int scale = panel->paper.scale, line = panel_line_height(panel), y = top + 2 * scale;
    const char *at = live->story;
    if (at[0] == '\0')
        return;
    for (int i = 0; i < live->story_line && *at; i++)
        at += strcspn(at, "\n") + (at[strcspn(at, "\n")] == '\n');
    if (*at == '\0') {
        live->story_line = 0;
        at = live->story;
    }
    panel_ground(panel, 0, top, panel->paper.width, panel->paper.height - top);
    for (; *at && y + line <= panel->paper.height; y += line) {
        size_t length = strcspn(at, "\n");
        char row[400];
        (void)snprintf(row, sizeof row, "%.*s", (int)(length < sizeof row ? length : sizeof row - 1), at);
        panel_text(panel, 2 * scale, y, row);
        at += length + (at[length] == '\n');
    }
}

/* What went wrong, broken into lines at the bottom. */
static void tell_message(struct live *live) {
    struct panel *panel = &live->panel;
    int scale = panel->paper.scale, line = panel_line_height(panel);
    int columns = (panel->paper.width - 4 * scale) / (PAPER_CELL * scale), length = (int)strlen(live->message);
    if (length == 0 || columns < 8)
        return;
    int rows = (length + columns - 1) / columns, top = panel->paper.height - rows * line - 3 * scale;
    panel_ground(panel, 0, top, panel->paper.width, rows * line + 3 * scale);
    for (int i = 0; i < rows; i++) {
        char text[512];
        (void)snprintf(text, sizeof text, "%.*s", columns, live->message + i * columns);
        panel_warning(panel, 2 * scale, top + 2 * scale + i * line, text);
    }
}

void live_tell_over(struct live *live, const struct figures *figures) {
    struct camera_frame frame;
    panel_begin(&live->panel);
    if (!live->bare) {
        bool room = live->panel.paper.height >= 24 * panel_line_height(&live->panel);
        int top = (room && live->block ? 30 : 15) * live->panel.paper.scale;
        if (live->block && live_frame(live, &frame)) {
            draw_selection(live, &frame);
            live_draw_lights(live, &frame);
        }
        tell_menu(live);
        if (room && live->block)
            tell_work(live);
        int below = tell_figures(live, figures, top);
        if (live->block)
            live_tell_selection(live, top);
        if (live->block && live->story[0] == '\0')
            live_tell_lights(live, below + live->panel.paper.scale);
        tell_story(live, below + live->panel.paper.scale);
    }
    tell_message(live);
    panel_end(&live->panel);
}
