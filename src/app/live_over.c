/* What lies over the picture: the outline of what is selected, marks of the lights, the menu, the figures, and what is
 * known of the selection. Everything is told anew for every frame; what is clicked is done at once. */
#include "app/inspect.h"
#include "app/live_parts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct ink outline = {255, 190, 60, 255}, bulb = {255, 235, 120, 255}, gray = {170, 176, 186, 255};

/* On the picture. */

/* In short pieces, since a line is not straight in every projection, and may begin behind the camera. */
static void draw_edge(struct live *live, const struct camera_frame *frame, struct vec3 a, struct vec3 b) {
    enum { PIECES = 12 };
    double x0 = 0, y0 = 0, x1, y1;
    bool had = false;
    for (int i = 0; i <= PIECES; i++) {
        bool has = live_project(live, frame, vec3_add_scaled(a, vec3_sub(b, a), (double)i / PIECES), &x1, &y1);
        if (has && had)
            paper_line(&live->panel.paper, x0, y0, x1, y1, outline);
        had = has;
        x0 = x1;
        y0 = y1;
    }
}

static void draw_selection(struct live *live, const struct camera_frame *frame) {
    const struct picked *picked = &live->selection.picked;
    struct vec3 corners[8];
    if (live->selection.kind != SELECTED_NODE)
        return;
    double x, y;
    if (live_project(live, frame, live_moved_point(live, picked->position), &x, &y))
        paper_ring(&live->panel.paper, x, y, 3 * live->panel.paper.scale, outline);
    for (int i = 0; i < 8 && picked->has_box; i++)
        corners[i] = live_moved_point(live, picked->corners[i]);
    for (int i = 0; i < 8 && picked->has_box; i++) {
        for (int axis = 1; axis < 8; axis *= 2) {
            if (!(i & axis))
                draw_edge(live, frame, corners[i], corners[i | axis]);
        }
    }
}

static void draw_lights(struct live *live, const struct camera_frame *frame) {
    const struct paper *paper = &live->panel.paper;
    double x, y, r = 4 * paper->scale;
    for (uint32_t i = 0; i < live->scene.light_count && i < TOLD_LIGHTS; i++) {
        const struct told_light *light = &live->scene.lights[i];
        if (!light->placed || !live_project(live, frame, light->position, &x, &y))
            continue;
        bool chosen = live->selection.kind == SELECTED_LIGHT && live->selection.light == i + 1;
        struct ink ink = chosen ? outline : bulb;
        paper_ring(paper, x, y, chosen ? 1.5 * r : r, ink);
        paper_line(paper, x - r / 2, y, x + r / 2, y, ink);
        paper_line(paper, x, y - r / 2, x, y + r / 2, ink);
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

static void tell_menu(struct live *live) {
    static const char *const words[] = {"Render", "Quit", "Stop", "Save picture", "Save view", "Save changes", "Hide"};
    struct panel *panel = &live->panel;
    bool used[7] = {false};
    panel_ground(panel, 0, 0, panel->paper.width, 15 * panel->paper.scale);
    (void)tell_buttons(live, 2 * panel->paper.scale, words, 7, live->halted ? 1 << 2 : 0, used);
    if (used[0])
        live_render(live);
    live->quit = live->quit || used[1];
    if (used[2])
        live_halt(live, !live->halted);
    if (used[3])
        live->wish = LIVE_SAVE;
    else if (used[4] && live->block)
        live->wish = LIVE_RECORD;
    else if (used[5])
        live->wish = LIVE_CHANGES;
    live->bare = live->bare || used[6];
}

/* Undoing, adding, exposure: a second row. */
static void tell_work(struct live *live) {
    static const char *const words[] = {"Undo", "Redo", "Sphere", "Cube", "Cylinder", "Cone", "Torus", "Light"};
    static const enum added_kind kinds[] = {ADDED_SPHERE, ADDED_CUBE, ADDED_CYLINDER, ADDED_CONE, ADDED_TORUS};
    struct panel *panel = &live->panel;
    int scale = panel->paper.scale, y = 17 * scale, wide = 10 * PAPER_CELL * scale;
    bool used[8] = {false};
    panel_ground(panel, 0, 15 * scale, panel->paper.width, 15 * scale);
    int x = tell_buttons(live, y, words, 8, 0, used);
    if (used[0] || used[1])
        live_undo(live, used[1]);
    for (int i = 0; i < 5; i++) {
        if (used[2 + i])
            live_add(live, kinds[i]);
    }
    if (used[7])
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
    int count = panel->paper.height >= 24 * line ? 4 : 0, width = 30 * PAPER_CELL * scale;
    int height = (count + 1) * line + 3 * scale;
    panel_ground(panel, 0, top, width, height);
    panel_bar(panel, x, y, 8 * PAPER_CELL * scale, figures->share);
    panel_text(panel, x + 9 * PAPER_CELL * scale, y, figures->state);
    for (int i = 0; i < count; i++)
        panel_text(panel, x, y + (i + 1) * line, rows[i]);
    return top + height;
}

/* The selection. */

struct column {
    int x, y, columns;
};

/* Broken into lines; of long texts the end is what counts. */
static void tell_text(struct live *live, struct column *column, const char *text) {
    enum { LINES = 4 };
    int length = (int)strlen(text), room = LINES * column->columns;
    for (text += length > room ? length - room : 0; *text;
         text += (int)strlen(text) < column->columns ? (int)strlen(text) : column->columns) {
        char row[128];
        (void)snprintf(row, sizeof row, "%.*s", column->columns, text);
        panel_text(&live->panel, column->x, column->y, row);
        column->y += panel_line_height(&live->panel);
    }
}

static void tell_point(struct live *live, struct column *column, const char *what, struct vec3 p) {
    char row[128];
    (void)snprintf(row, sizeof row, "%s %.4g %.4g %.4g", what, p.x, p.y, p.z);
    tell_text(live, column, row);
}

static void tell_tools(struct live *live, struct column *column) {
    static const char *const words[] = {"Move", "Turn", "Size", "Up", "Copy", "Delete"};
    struct panel *panel = &live->panel;
    bool node = live->selection.kind == SELECTED_NODE;
    int x = column->x;
    for (int i = 0; i < 6; i++) {
        enum live_tool tool = i < 3 ? (enum live_tool)(i + 1) : TOOL_NONE;
        if (!node && i != 0 && i != 5)
            continue;
        bool used = panel_button(panel, x, column->y, words[i], tool != TOOL_NONE && live->tool == tool);
        x += panel_button_width(panel, words[i]) + 2 * panel->paper.scale;
        if (!used)
            continue;
        if (tool != TOOL_NONE) {
            live->tool = live->tool == tool ? TOOL_NONE : tool;
            live->joins = false;
        } else if (i == 3) {
            live_select_parent(live);
        } else if (i == 4) {
            live_add(live, ADDED_COPY);
        } else {
            live_delete(live);
        }
    }
    column->y += panel_line_height(panel) + 4 * panel->paper.scale;
}

static void tell_colour(struct live *live, struct column *column) {
    static const struct ink inks[3] = {{210, 70, 60, 255}, {80, 180, 80, 255}, {80, 110, 220, 255}};
    struct panel *panel = &live->panel;
    int width = column->columns * PAPER_CELL * panel->paper.scale;
    struct vec3 colour = live_colour_now(live);
    double parts[3] = {colour.x, colour.y, colour.z};
    bool changed = false;
    if (live->selection.picked.material_serial == 0)
        return;
    if (panel->pressed)
        live->joins = false;
    for (int i = 0; i < 3; i++) {
        changed = panel_slider(panel, column->x, column->y, width, 0, 1, inks[i], &parts[i]) || changed;
        column->y += panel_line_height(panel);
    }
    if (changed)
        live_colour(live, vec3_make(parts[0], parts[1], parts[2]));
}

static void tell_node(struct live *live, struct column *column) {
    const struct picked *picked = &live->selection.picked;
    struct vec3 place = live_moved_point(live, picked->position);
    char row[256];
    tell_text(live, column, picked->path);
    (void)snprintf(row, sizeof row, "%s, %s", picked->shape, picked->material);
    tell_text(live, column, row);
    tell_point(live, column, "at", place);
    (void)snprintf(row, sizeof row, "distance %.5g", vec3_length(vec3_sub(place, live->view.camera.eye)));
    tell_text(live, column, row);
    tell_tools(live, column);
    if (live->selection.kind == SELECTED_NODE)
        tell_colour(live, column);
}

static void tell_light(struct live *live, struct column *column) {
    uint32_t i = live->selection.light - 1;
    if (i >= TOLD_LIGHTS)
        return;
    const struct told_light *light = &live->scene.lights[i];
    struct panel *panel = &live->panel;
    char row[128];
    (void)snprintf(row, sizeof row, "light %u: %s", i + 1, inspect_light((enum light_kind)light->kind));
    tell_text(live, column, row);
    tell_point(live, column, "at", light->position);
    tell_point(live, column, "colour", light->colour);
    tell_tools(live, column);
    if (live->selection.kind != SELECTED_LIGHT)
        return;
    double stops = live_stops_now(live);
    if (panel->pressed)
        live->joins = false;
    (void)snprintf(row, sizeof row, "%+.2f stops", stops);
    if (panel_slider(panel, column->x, column->y, column->columns * PAPER_CELL * panel->paper.scale, -5, 5, bulb,
                     &stops))
        live_brighten(live, stops);
    column->y += panel_line_height(panel);
    panel_text(panel, column->x, column->y, row);
}

/* In a small window one line has to do. */
static void tell_shortly(struct live *live) {
    struct panel *panel = &live->panel;
    const struct picked *picked = &live->selection.picked;
    int scale = panel->paper.scale, line = panel_line_height(panel), top = panel->paper.height - line - 2 * scale;
    char row[256];
    if (live->selection.kind == SELECTED_NODE)
        (void)snprintf(row, sizeof row, "%.60s, %s, at %.4g", picked->name, picked->shape, picked->distance);
    else
        (void)snprintf(row, sizeof row, "light %u", live->selection.light);
    panel_ground(panel, 0, top, panel->paper.width, line + 2 * scale);
    panel_text(panel, 2 * scale, top + 2 * scale, row);
}

static void tell_selection(struct live *live, int top) {
    struct panel *panel = &live->panel;
    int scale = panel->paper.scale, columns = 38, width = (columns * PAPER_CELL + 4) * scale;
    int height = 12 * panel_line_height(panel);
    if (live->selection.kind == SELECTED_NOTHING)
        return;
    if (5 * width > 2 * panel->paper.width || 2 * (top + height) > panel->paper.height) {
        tell_shortly(live);
        return;
    }
    struct column column = {panel->paper.width - width + 2 * scale, top + 2 * scale, columns};
    panel_ground(panel, panel->paper.width - width, top, width, height);
    if (live->selection.kind == SELECTED_NODE)
        tell_node(live, &column);
    else
        tell_light(live, &column);
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
            draw_lights(live, &frame);
        }
        tell_menu(live);
        if (room && live->block)
            tell_work(live);
        int below = tell_figures(live, figures, top);
        if (live->block)
            tell_selection(live, top);
        tell_story(live, below + live->panel.paper.scale);
    }
    tell_message(live);
    panel_end(&live->panel);
}
