/* Draws over the picture: the outline of the selection, markers of the lights, the menu, the figures, and the
 * selection's properties. Everything is drawn again for every frame; a click has its effect immediately. */
#include "inspect/inspect.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct canvas_colour outline = {255, 190, 60, 255}, gray = {170, 176, 186, 255};

/* On the picture. */

static void draw_selection(struct viewer *viewer, const struct camera_frame *frame) {
    const struct picked *picked = &viewer->edit.selection.picked;
    struct vec3 corners[8];
    if (viewer->edit.selection.kind != SELECTED_NODE)
        return;
    double x, y;
    if (viewer_project(viewer, frame, viewer_moved_point(viewer, picked->position), &x, &y))
        canvas_ring(&viewer->window.panel.canvas, x, y, 3 * viewer->window.panel.canvas.scale, outline);
    /* Large parts of an operand may be invisible: its box shows its position. */
    if (viewer_draw_outline(viewer, outline) && picked->solid == 0)
        return;
    for (int i = 0; i < 8 && picked->has_box; i++)
        corners[i] = viewer_moved_point(viewer, picked->corners[i]);
    for (int i = 0; i < 8 && picked->has_box; i++) {
        for (int axis = 1; axis < 8; axis *= 2) {
            if (!(i & axis))
                viewer_draw_edge(viewer, frame, corners[i], corners[i | axis], outline);
        }
    }
}

/* The menu. */

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

static void draw_menu(struct viewer *viewer) {
    static const char *const words[] = {MENU(LIST_WORD)};
    struct panel *panel = &viewer->window.panel;
    bool used[LIST_COUNT(MENU)] = {false};
    unsigned on = (viewer->pass.halted ? 1u << MENU_STOP : 0) |
                  (viewer->overlay.kind == OVERLAY_OF_BOXES ? 1u << MENU_BOXES : 0) |
                  (viewer->overlay.kind == OVERLAY_OF_GRID ? 1u << MENU_GRID : 0);
    panel_ground(panel, 0, 0, panel->canvas.width, 15 * panel->canvas.scale);
    (void)panel_button_row(panel, 2 * panel->canvas.scale, words, LIST_COUNT(MENU), on, used);
    if (used[MENU_RENDER])
        viewer_render(viewer);
    viewer->quit = viewer->quit || used[MENU_QUIT];
    if (used[MENU_STOP])
        viewer_halt(viewer, !viewer->pass.halted);
    if (viewer->name[0] == '\0') /* no picture yet */
        used[MENU_SAVE_PICTURE] = used[MENU_SAVE_CHANGES] = false;
    if (used[MENU_SAVE_PICTURE])
        viewer->action = VIEWER_SAVE_IMAGE;
    else if (used[MENU_SAVE_VIEW] && viewer->block)
        viewer->action = VIEWER_SAVE_CAMERA;
    else if (used[MENU_SAVE_CHANGES])
        viewer->action = VIEWER_SAVE_EDITS;
    viewer->window.hides_hud = viewer->window.hides_hud || used[MENU_HIDE];
    if (used[MENU_BOXES] || used[MENU_GRID])
        viewer_choose_overlay(viewer, used[MENU_BOXES] ? OVERLAY_OF_BOXES : OVERLAY_OF_GRID);
    viewer->lights.listed = viewer->lights.listed != used[MENU_LIGHTS];
}

/* The animation: a row at the bottom. Its controls come first, because they also exist between two frames, when others
 * do not, and so keep their numbers. Returns its top. */
static int draw_timeline(struct viewer *viewer, const struct figures *figures) {
    struct panel *panel = &viewer->window.panel;
    struct viewer_player *player = &viewer->player;
    int scale = panel->canvas.scale, height = 15 * scale, top = panel->canvas.height - height, x = 2 * scale;
    if (player->count == 0)
        return panel->canvas.height;
    const char *const words[] = {player->playing ? "Pause" : "Play ", "Loop"};
    bool used[] = {false, false};
    panel_ground(panel, 0, top, panel->canvas.width, height);
    x = panel_button_row(panel, top + 2 * scale, words, 2, player->loops ? 2 : 0, used);
    if (used[0])
        viewer_play(viewer, !player->playing);
    if (used[1])
        viewer_player_loop(viewer);
    int words_width = (int)(strlen(figures->frame) + 2) * CANVAS_CELL * scale;
    int width = panel->canvas.width - x - words_width - 4 * scale;
    double index = viewer_frame_index(viewer);
    const struct panel_slider slider = {x + 2 * scale, top + 4 * scale, width, 0, player->count - 1.0, gray};
    if (width > 8 * CANVAS_CELL * scale && player->count > 1 && panel_slider(panel, &slider, &index))
        viewer_go_to_frame(viewer, viewer_frame_number(viewer, index));
    panel_text(panel, panel->canvas.width - words_width + CANVAS_CELL * scale, top + 4 * scale, figures->frame);
    return top;
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

static void draw_work(struct viewer *viewer) {
    static const char *const words[] = {WORK(LIST_WORD)};
    struct panel *panel = &viewer->window.panel;
    int scale = panel->canvas.scale, y = 17 * scale, wide = 10 * CANVAS_CELL * scale;
    bool used[LIST_COUNT(WORK)] = {false};
    panel_ground(panel, 0, 15 * scale, panel->canvas.width, 15 * scale);
    int x = panel_button_row(panel, y, words, LIST_COUNT(WORK), 0, used);
    if (used[WORK_UNDO] || used[WORK_REDO])
        viewer_undo(viewer, used[WORK_REDO]);
    if (used[WORK_SPHERE])
        viewer_add_node(viewer, ADDED_SPHERE);
    if (used[WORK_CUBE])
        viewer_add_node(viewer, ADDED_CUBE);
    if (used[WORK_CYLINDER])
        viewer_add_node(viewer, ADDED_CYLINDER);
    if (used[WORK_CONE])
        viewer_add_node(viewer, ADDED_CONE);
    if (used[WORK_TORUS])
        viewer_add_node(viewer, ADDED_TORUS);
    if (used[WORK_LIGHT])
        viewer_add_light(viewer);
    char text[48];
    double stops = viewer->request.settings.tone.exposure;
    (void)snprintf(text, sizeof text, "%+.2f stops", stops);
    if (x + 2 * wide > panel->canvas.width)
        return;
    const struct panel_slider slider = {x + 2 * scale, y + 2 * scale, wide, -4, 4, gray};
    if (panel_slider(panel, &slider, &stops))
        viewer_set_exposure(viewer, stops);
    panel_text(panel, x + 4 * scale + wide, y + 2 * scale, text);
}

static int draw_figures(struct viewer *viewer, const struct figures *figures, int top) {
    struct panel *panel = &viewer->window.panel;
    int scale = panel->canvas.scale, line = panel_line_height(panel), y = top + 2 * scale, x = 2 * scale;
    const char *const rows[] = {figures->rays, figures->triangles, figures->voxels, figures->frames};
    int count = panel->canvas.height >= 24 * line ? 4 : 0, width = 33 * CANVAS_CELL * scale;
    int height = (count + 1) * line + 3 * scale;
    panel_ground(panel, 0, top, width, height);
    panel_bar(panel, x, y, 8 * CANVAS_CELL * scale, figures->share);
    panel_text(panel, x + 9 * CANVAS_CELL * scale, y, figures->state);
    for (int i = 0; i < count; i++)
        panel_text(panel, x, y + (i + 1) * line, rows[i]);
    return top + height;
}

/* The trace of a pixel, from the scrolled line on; after the end it starts again. */
static void draw_pixel_trace(struct viewer *viewer, int top) {
    struct panel *panel = &viewer->window.panel;
    int scale = panel->canvas.scale, line = panel_line_height(panel), y = top + 2 * scale;
    const char *at = viewer->trace.text;
    if (at[0] == '\0')
        return;
    for (int i = 0; i < viewer->trace.line && *at; i++)
        at += strcspn(at, "\n") + (at[strcspn(at, "\n")] == '\n');
    if (*at == '\0') {
        viewer->trace.line = 0;
        at = viewer->trace.text;
    }
    panel_ground(panel, 0, top, panel->canvas.width, panel->canvas.height - top);
    for (; *at && y + line <= panel->canvas.height; y += line) {
        size_t length = strcspn(at, "\n");
        char row[400];
        (void)snprintf(row, sizeof row, "%.*s", (int)(length < sizeof row ? length : sizeof row - 1), at);
        panel_text(panel, 2 * scale, y, row);
        at += length + (at[length] == '\n');
    }
}

/* A text, broken into lines, above the line `bottom` of the canvas. Returns its top. */
static int draw_lines(struct panel *panel, const char *line, bool warns, int bottom) {
    int scale = panel->canvas.scale, height = panel_line_height(panel);
    int columns = (panel->canvas.width - 4 * scale) / (CANVAS_CELL * scale), length = (int)strlen(line);
    if (length == 0 || columns < 8)
        return bottom;
    int rows = (length + columns - 1) / columns, top = bottom - rows * height - 3 * scale;
    panel_ground(panel, 0, top, panel->canvas.width, bottom - top);
    for (int i = 0; i < rows; i++) {
        char text[512];
        (void)snprintf(text, sizeof text, "%.*s", columns, line + i * columns);
        if (warns)
            panel_warning(panel, 2 * scale, top + 2 * scale + i * height, text);
        else
            panel_text(panel, 2 * scale, top + 2 * scale + i * height, text);
    }
    return top;
}

void viewer_draw_hud(struct viewer *viewer, const struct figures *figures) {
    struct camera_frame frame;
    struct panel *panel = &viewer->window.panel;
    panel_begin(panel);
    int bottom = panel->canvas.height;
    if (!viewer->window.hides_hud) {
        bool room = viewer->window.panel.canvas.height >= 24 * panel_line_height(&viewer->window.panel);
        int top = (room && viewer->block ? 30 : 15) * viewer->window.panel.canvas.scale;
        if (viewer->block && viewer_camera_frame(viewer, &frame)) {
            draw_selection(viewer, &frame);
            viewer_draw_lights(viewer, &frame);
        }
        bottom = draw_timeline(viewer, figures);
        draw_menu(viewer);
        if (room && viewer->block)
            draw_work(viewer);
        int below = draw_figures(viewer, figures, top);
        if (viewer->block)
            viewer_draw_selection_panel(viewer, top);
        if (viewer->block && viewer->trace.text[0] == '\0')
            viewer_draw_light_list(viewer, below + viewer->window.panel.canvas.scale);
        draw_pixel_trace(viewer, below + viewer->window.panel.canvas.scale);
    }
    bottom = draw_lines(panel, viewer->message, true, bottom);
    (void)draw_lines(panel, viewer->window.notice.text, viewer->window.notice.warns, bottom);
    panel_end(&viewer->window.panel);
}
