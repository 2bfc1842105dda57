/* The lights on the picture, their list, and the panel of the selection. */
#include "viewer/viewer_internal.h"

#include "light/light_edit.h"
#include "math/elementary.h"
#include "math/frame.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const struct canvas_colour outline = {255, 190, 60, 255}, bulb = {255, 235, 120, 255},
                                  dim = {200, 185, 110, 150};
static const struct canvas_colour parts_of_colour[3] = {{210, 70, 60, 255}, {80, 180, 80, 255}, {80, 110, 220, 255}};

/* On the picture. */

/* In short pieces, since a line is not straight in every projection, and may begin behind the camera. */
void viewer_draw_edge(struct viewer *viewer, const struct camera_frame *frame, struct vec3 a, struct vec3 b,
                      struct canvas_colour colour) {
    enum { PIECES = 12 };
    double x0 = 0, y0 = 0, x1, y1;
    bool had = false;
    for (int i = 0; i <= PIECES; i++) {
        bool has = viewer_project(viewer, frame, vec3_add_scaled(a, vec3_sub(b, a), (double)i / PIECES), &x1, &y1);
        if (has && had)
            canvas_line(&viewer->window.panel.canvas, x0, y0, x1, y1, colour);
        had = has;
        x0 = x1;
        y0 = y1;
    }
}

/* A circle about an axis (unit). */
static void draw_circle(struct viewer *viewer, const struct camera_frame *frame, struct vec3 centre, struct vec3 axis,
                        double radius) {
    /* Cosine and sine of 15 degrees: a circle of 24 pieces. */
    const double c = 0.96592582628906831, s = 0.25881904510252074;
    struct vec3 right, up;
    frame_tangents(axis, &right, &up);
    double x = radius, y = 0;
    for (int i = 0; i < 24; i++) {
        double x1 = c * x - s * y, y1 = s * x + c * y;
        struct vec3 from = vec3_add_scaled(vec3_add_scaled(centre, right, x), up, y);
        struct vec3 to = vec3_add_scaled(vec3_add_scaled(centre, right, x1), up, y1);
        viewer_draw_edge(viewer, frame, from, to, outline);
        x = x1;
        y = y1;
    }
}

/* Draws the selected light: its extent and direction. */
static void draw_form(struct viewer *viewer, const struct camera_frame *frame, const struct light_info *light) {
    struct vec3 at = light->position, a = vec3_scale(light->edge1, 0.5), b = vec3_scale(light->edge2, 0.5);
    double extent = 0.2 * vec3_length(vec3_sub(at, frame->eye));
    struct vec3 corners[4] = {vec3_add(at, vec3_add(a, b)), vec3_add(at, vec3_sub(a, b)), vec3_sub(at, vec3_add(a, b)),
                              vec3_sub(at, vec3_sub(a, b))};
    uint32_t has = light->properties;
    for (int i = 0; (has & LIGHT_HAS_EDGES) && i < 4; i++)
        viewer_draw_edge(viewer, frame, corners[i], corners[(i + 1) % 4], outline);
    if (has & LIGHT_HAS_RADIUS) {
        struct vec3 to_eye = vec3_normalize(vec3_sub(frame->eye, at));
        draw_circle(viewer, frame, at, has & LIGHT_HAS_DIRECTION ? light->direction : to_eye, light->radius);
    }
    if (has & LIGHT_HAS_CONE) {
        double along = light->cos_outer, aside = sqrt(fmax(0, 1 - along * along));
        draw_circle(viewer, frame, vec3_add_scaled(at, light->direction, extent * along), light->direction,
                    extent * aside);
    }
    if (light->has_position && vec3_max_abs(light->direction) > 0)
        viewer_draw_edge(viewer, frame, at, vec3_add_scaled(at, light->direction, extent), outline);
    if (!light->has_position && (has & LIGHT_HAS_DIRECTION)) { /* an arrow through the middle of the view */
        struct vec3 middle = viewer->fly_camera.centre;
        double half = 0.15 * vec3_length(vec3_sub(middle, frame->eye));
        struct vec3 tip = vec3_add_scaled(middle, light->direction, half), right, up;
        frame_tangents(light->direction, &right, &up);
        viewer_draw_edge(viewer, frame, vec3_add_scaled(middle, light->direction, -half), tip, outline);
        struct vec3 back = vec3_add_scaled(tip, light->direction, -0.3 * half);
        viewer_draw_edge(viewer, frame, vec3_add_scaled(back, right, 0.12 * half), tip, outline);
        viewer_draw_edge(viewer, frame, vec3_add_scaled(back, right, -0.12 * half), tip, outline);
    }
}

void viewer_draw_lights(struct viewer *viewer, const struct camera_frame *frame) {
    const struct canvas *canvas = &viewer->window.panel.canvas;
    double x, y, r = 4 * canvas->scale;
    for (uint32_t i = 1; i <= viewer->lights.known; i++) {
        bool chosen = viewer->edit.selection.kind == SELECTED_LIGHT && viewer->edit.selection.light == i, seen;
        const struct light_info *light = viewer_light(viewer, i);
        if (!viewer_light_marker(viewer, frame, i, &x, &y, &seen))
            continue;
        struct canvas_colour colour = chosen ? outline : seen ? bulb : dim;
        canvas_ring(canvas, x, y, chosen ? 1.5 * r : r, colour);
        canvas_line(canvas, x - r / 2, y, x + r / 2, y, colour);
        if (!(light->properties & LIGHT_IS_ENVIRONMENT))
            canvas_line(canvas, x, y - r / 2, x, y + r / 2, colour);
        bool distant = !light->has_position && (light->properties & LIGHT_HAS_DIRECTION);
        for (int ray = 0; distant && ray < 4; ray++) {
            double u = ray < 2 ? 1 : -1, v = ray % 2 ? 1 : -1;
            canvas_line(canvas, x + u * r, y + v * r, x + 1.6 * u * r, y + 1.6 * v * r, colour);
        }
    }
    if (viewer->edit.selection.kind == SELECTED_LIGHT && viewer_light(viewer, viewer->edit.selection.light))
        draw_form(viewer, frame, viewer_light(viewer, viewer->edit.selection.light));
}

/* The list of the lights. */

void viewer_draw_light_list(struct viewer *viewer, int top) {
    struct panel *panel = &viewer->window.panel;
    int scale = panel->canvas.scale, step = panel_line_height(panel) + 3 * scale, width = 24 * CANVAS_CELL * scale;
    int rows = (panel->canvas.height - top - 2 * step) / step, y = top + 2 * scale;
    if (!viewer->lights.listed || rows < 2 || 2 * width > panel->canvas.width)
        return;
    uint32_t count = viewer->lights.known, shown = (uint32_t)rows;
    bool paged = count > shown;
    viewer->lights.list_first = viewer->lights.list_first < count ? viewer->lights.list_first : 0;
    uint32_t last = count - viewer->lights.list_first < shown ? count : viewer->lights.list_first + shown;
    panel_ground(panel, 0, top, width, ((int)(last - viewer->lights.list_first) + paged) * step + 3 * scale);
    for (uint32_t i = viewer->lights.list_first; i < last; i++, y += step) {
        char row[64];
        bool chosen = viewer->edit.selection.kind == SELECTED_LIGHT && viewer->edit.selection.light == i + 1;
        const char *words = light_kind_name((enum light_kind)viewer->lights.items[i].kind);
        (void)snprintf(row, sizeof row, "%u %s", i + 1, words);
        if (panel_button(panel, 2 * scale, y, row, chosen))
            viewer_select_light(viewer, i + 1);
    }
    if (paged && panel_button(panel, 2 * scale, y, "Back", false))
        viewer->lights.list_first = viewer->lights.list_first > shown ? viewer->lights.list_first - shown : 0;
    if (paged && panel_button(panel, 32 * scale, y, "More", false) && last < count)
        viewer->lights.list_first = last;
}

/* The selection. */

struct column {
    int x, y, columns;
};

/* Broken into lines; long texts keep their end. */
static void __attribute__((format(printf, 3, 4)))
draw_text(struct viewer *viewer, struct column *column, const char *format, ...) {
    enum { LINES = 4 };
    char all[4096], *text = all;
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(all, sizeof all, format, arguments);
    va_end(arguments);
    int length = (int)strlen(text), room = LINES * column->columns;
    for (text += length > room ? length - room : 0; *text;
         text += (int)strlen(text) < column->columns ? (int)strlen(text) : column->columns) {
        char row[128];
        (void)snprintf(row, sizeof row, "%.*s", column->columns, text);
        panel_text(&viewer->window.panel, column->x, column->y, row);
        column->y += panel_line_height(&viewer->window.panel);
    }
}

static void draw_point(struct viewer *viewer, struct column *column, const char *what, struct vec3 p) {
    draw_text(viewer, column, "%s %.4g %.4g %.4g", what, p.x, p.y, p.z);
}

static bool is_node(const struct viewer *viewer) {
    return viewer->edit.selection.kind == SELECTED_NODE;
}

static void copy(struct viewer *viewer) {
    viewer_add_node(viewer, ADDED_COPY);
}

static void select_above(struct viewer *viewer) {
    viewer_select_up(viewer, false);
}

static void select_below(struct viewer *viewer) {
    viewer_select_up(viewer, true);
}

/* What the buttons are for: a tool, or a function that is called at once. */
static const struct tool_button {
    const char *word;
    enum edit_tool tool;
    void (*use)(struct viewer *viewer);
    bool for_nodes_only;
} tool_buttons[] = {{"Move", TOOL_MOVE, NULL, false},
                    {"Turn", TOOL_TURN, NULL, false},
                    {"Size", TOOL_SIZE, NULL, false},
                    {"Up", TOOL_NONE, select_above, true},
                    {"Down", TOOL_NONE, select_below, true},
                    {"Copy", TOOL_NONE, copy, false},
                    {"Delete", TOOL_NONE, viewer_delete_selection, false}};

/* Whether the selection supports it. */
static bool can_use(const struct viewer *viewer, const struct tool_button *button) {
    const struct light_info *light = viewer_light(viewer, viewer->edit.selection.light);
    if (button->for_nodes_only)
        return is_node(viewer) && (button->use != select_below || viewer->edit.selection.picked.below > 0);
    switch (button->tool) {
    case TOOL_MOVE:
        return is_node(viewer) || (light && light->moves);
    case TOOL_TURN:
        return is_node(viewer) || (light && light->turns);
    case TOOL_SIZE:
        return is_node(viewer) || (light && light->sizes);
    case TOOL_NONE:
        break;
    }
    return true;
}

static void draw_tools(struct viewer *viewer, struct column *column) {
    struct panel *panel = &viewer->window.panel;
    int x = column->x;
    for (size_t i = 0; i < sizeof tool_buttons / sizeof *tool_buttons; i++) {
        const struct tool_button *button = &tool_buttons[i];
        bool is_tool = button->tool != TOOL_NONE;
        if (!can_use(viewer, button))
            continue;
        bool used = panel_button(panel, x, column->y, button->word, is_tool && viewer->edit.tool == button->tool);
        x += panel_button_width(panel, button->word) + 2 * panel->canvas.scale;
        if (used && is_tool)
            viewer_choose_tool(viewer, button->tool);
        else if (used)
            button->use(viewer);
    }
    column->y += panel_line_height(panel) + 4 * panel->canvas.scale;
}

/* Three sliders. */
static bool draw_sliders(struct viewer *viewer, struct column *column, double top, struct colour *colour) {
    struct panel *panel = &viewer->window.panel;
    int width = column->columns * CANVAS_CELL * panel->canvas.scale;
    double parts[3] = {colour->r, colour->g, colour->b};
    bool changed = false;
    if (panel->pressed)
        viewer->edit.joins = false;
    for (int i = 0; i < 3; i++) {
        const struct panel_slider slider = {column->x, column->y, width, 0, top, parts_of_colour[i]};
        changed = panel_slider(panel, &slider, &parts[i]) || changed;
        column->y += panel_line_height(panel);
    }
    *colour = colour_make(parts[0], parts[1], parts[2]);
    return changed;
}

/* One slider for a number that is no share: logarithmic, or from 1 on. */
static bool draw_number(struct viewer *viewer, struct column *column, enum material_part part, double *number) {
    struct panel *panel = &viewer->window.panel;
    int width = column->columns * CANVAS_CELL * panel->canvas.scale;
    double low, high, at = part == MATERIAL_PART_SHININESS ? el_log2(1 + *number) : *number;
    material_part_range(part, &low, &high);
    double top = part == MATERIAL_PART_SHININESS ? 12 : part == MATERIAL_PART_IOR ? 3 : 1;
    const struct panel_slider slider = {column->x, column->y, width, low, top, bulb};
    bool changed = panel_slider(panel, &slider, &at);
    column->y += panel_line_height(panel);
    if (changed)
        *number = part == MATERIAL_PART_SHININESS ? el_exp2(at) - 1 : at;
    return changed;
}

/* Rows of buttons, one for each part. */
static void choose_part(struct viewer *viewer, struct column *column) {
    struct panel *panel = &viewer->window.panel;
    int scale = panel->canvas.scale, x = column->x, right = column->x + column->columns * CANVAS_CELL * scale;
    for (int i = 0; i < MATERIAL_PART_PARTS; i++) {
        const char *name = material_part_name((enum material_part)i);
        int width = panel_button_width(panel, name);
        if (x + width > right) {
            x = column->x;
            column->y += panel_line_height(panel) + 3 * scale;
        }
        if (panel_button(panel, x, column->y, name, viewer->edit.part == (enum material_part)i))
            viewer->edit.part = (enum material_part)i;
        x += width + 2 * scale;
    }
    column->y += panel_line_height(panel) + 4 * scale;
}

static void draw_inputs(struct viewer *viewer, struct column *column) {
    struct panel *panel = &viewer->window.panel;
    double numbers[3];
    if (viewer->edit.selection.picked.material_serial != 0) {
        choose_part(viewer, column);
        viewer_material_now(viewer, viewer->edit.part, numbers);
        /* Three sliders for a colour, one for a number. */
        bool colour = material_part_count(viewer->edit.part) == 3, changed;
        struct colour c = {numbers[0], numbers[1], numbers[2]};
        double top = viewer->edit.part == MATERIAL_PART_KD || viewer->edit.part == MATERIAL_PART_KS ? 1 : 4;
        if (panel->pressed)
            viewer->edit.joins = false;
        changed = colour ? draw_sliders(viewer, column, top, &c)
                         : draw_number(viewer, column, viewer->edit.part, &numbers[0]);
        if (colour)
            numbers[0] = c.r, numbers[1] = c.g, numbers[2] = c.b;
        if (changed)
            viewer_set_material(viewer, viewer->edit.part, numbers);
        draw_text(viewer, column, colour ? "%s %.3g %.3g %.3g" : "%s %.4g", material_part_name(viewer->edit.part),
                  numbers[0], numbers[1], numbers[2]);
        if (viewer->edit.selection.picked.idle_parts >> viewer->edit.part & 1)
            draw_text(viewer, column, "no effect here: a texture replaces it");
    }
    if (!viewer->edit.selection.picked.can_own)
        return;
    if (panel_button(panel, column->x, column->y, "A material of its own", false))
        viewer_make_own_material(viewer);
    column->y += panel_line_height(panel) + 4 * panel->canvas.scale;
}

static void draw_node(struct viewer *viewer, struct column *column) {
    const struct picked *picked = &viewer->edit.selection.picked;
    struct vec3 layout = viewer_moved_point(viewer, picked->position);
    draw_text(viewer, column, "%s", picked->node_path);
    draw_text(viewer, column, "%s, %s", picked->shape, picked->material);
    draw_point(viewer, column, "at", layout);
    draw_text(viewer, column, "distance %.5g", vec3_length(vec3_sub(layout, viewer->pass.view.camera.eye)));
    draw_tools(viewer, column);
    if (viewer->edit.selection.kind == SELECTED_NODE)
        draw_inputs(viewer, column);
}

static void draw_light(struct viewer *viewer, struct column *column) {
    const struct light_info *light = viewer_light(viewer, viewer->edit.selection.light);
    struct panel *panel = &viewer->window.panel;
    if (!light)
        return;
    draw_text(viewer, column, "light %u of %u: %s", viewer->edit.selection.light, viewer->lights.count,
              light_kind_name((enum light_kind)light->kind));
    if (light->has_position)
        draw_point(viewer, column, "at", light->position);
    if (vec3_max_abs(light->direction) > 0)
        draw_point(viewer, column, "to", light->direction);
    draw_text(viewer, column, "colour %.4g %.4g %.4g", light->colour.r, light->colour.g, light->colour.b);
    draw_tools(viewer, column);
    if (viewer->edit.selection.kind != SELECTED_LIGHT)
        return;
    /* Brightness first, since it keeps the colour. */
    double stops = viewer_light_stops_now(viewer);
    struct colour colour = viewer_light_colour_now(viewer);
    if (panel->pressed)
        viewer->edit.joins = false;
    int width = column->columns * CANVAS_CELL * panel->canvas.scale;
    const struct panel_slider slider = {column->x, column->y, width, -5, 5, bulb};
    if (panel_slider(panel, &slider, &stops))
        viewer_brighten_light(viewer, stops);
    column->y += panel_line_height(panel);
    draw_text(viewer, column, "%+.2f stops", stops);
    if (draw_sliders(viewer, column, viewer->lights.colour_max, &colour))
        viewer_light_colour(viewer, colour);
}

/* In a small window there is only one line. */
static void draw_shortly(struct viewer *viewer) {
    struct panel *panel = &viewer->window.panel;
    const struct picked *picked = &viewer->edit.selection.picked;
    int scale = panel->canvas.scale, line = panel_line_height(panel), top = panel->canvas.height - line - 2 * scale;
    char row[256];
    const struct light_info *light = viewer_light(viewer, viewer->edit.selection.light);
    if (viewer->edit.selection.kind == SELECTED_NODE)
        (void)snprintf(row, sizeof row, "%.60s, %s, at %.4g", picked->name, picked->shape, picked->distance);
    else
        (void)snprintf(row, sizeof row, "light %u, %s", viewer->edit.selection.light,
                       light ? light_kind_name((enum light_kind)light->kind) : "not known yet");
    panel_ground(panel, 0, top, panel->canvas.width, line + 2 * scale);
    panel_text(panel, 2 * scale, top + 2 * scale, row);
}

void viewer_draw_selection_panel(struct viewer *viewer, int top) {
    struct panel *panel = &viewer->window.panel;
    int scale = panel->canvas.scale, columns = 38, width = (columns * CANVAS_CELL + 4) * scale;
    int usual = 12 * panel_line_height(panel),
        height = viewer->display.panel_height > 0 ? viewer->display.panel_height : usual;
    if (viewer->edit.selection.kind == SELECTED_NOTHING)
        return;
    if (5 * width > 2 * panel->canvas.width || 2 * (top + usual) > panel->canvas.height) {
        draw_shortly(viewer);
        return;
    }
    struct column column = {panel->canvas.width - width + 2 * scale, top + 2 * scale, columns};
    panel_ground(panel, panel->canvas.width - width, top, width, height);
    if (viewer->edit.selection.kind == SELECTED_NODE)
        draw_node(viewer, &column);
    else
        draw_light(viewer, &column);
    /* The necessary height is known now: the next frame uses it. */
    viewer->display.hud_dirty = viewer->display.hud_dirty || viewer->display.panel_height != column.y - top;
    viewer->display.panel_height = column.y - top;
}
