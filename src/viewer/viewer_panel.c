/* The lights on the picture, the list of them, and the panel that tells of what is selected. */
#include "inspect/inspect.h"
#include "math/elementary.h"
#include "math/frame.h"
#include "viewer/viewer_internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct ink outline = {255, 190, 60, 255}, bulb = {255, 235, 120, 255}, dim = {200, 185, 110, 150};
static const struct ink parts_of_colour[3] = {{210, 70, 60, 255}, {80, 180, 80, 255}, {80, 110, 220, 255}};

/* On the picture. */

/* In short pieces, since a line is not straight in every projection, and may begin behind the camera. */
void live_draw_edge(struct live *live, const struct camera_frame *frame, struct vec3 a, struct vec3 b, struct ink ink) {
    enum { PIECES = 12 };
    double x0 = 0, y0 = 0, x1, y1;
    bool had = false;
    for (int i = 0; i <= PIECES; i++) {
        bool has = live_project(live, frame, vec3_add_scaled(a, vec3_sub(b, a), (double)i / PIECES), &x1, &y1);
        if (has && had)
            paper_line(&live->panel.paper, x0, y0, x1, y1, ink);
        had = has;
        x0 = x1;
        y0 = y1;
    }
}

/* A circle about an axis (unit). */
static void draw_circle(struct live *live, const struct camera_frame *frame, struct vec3 centre, struct vec3 axis,
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
        live_draw_edge(live, frame, from, to, outline);
        x = x1;
        y = y1;
    }
}

/* What the selected light is like: its extent, and where it shines to. */
static void draw_form(struct live *live, const struct camera_frame *frame, const struct told_light *light) {
    struct vec3 at = light->position, a = vec3_scale(light->edge1, 0.5), b = vec3_scale(light->edge2, 0.5);
    double reach = 0.2 * vec3_length(vec3_sub(at, frame->eye));
    struct vec3 corners[4] = {vec3_add(at, vec3_add(a, b)), vec3_add(at, vec3_sub(a, b)), vec3_sub(at, vec3_add(a, b)),
                              vec3_sub(at, vec3_sub(a, b))};
    uint32_t has = light->properties;
    for (int i = 0; (has & LIGHT_HAS_EDGES) && i < 4; i++)
        live_draw_edge(live, frame, corners[i], corners[(i + 1) % 4], outline);
    if (has & LIGHT_HAS_RADIUS) {
        struct vec3 to_eye = vec3_normalize(vec3_sub(frame->eye, at));
        draw_circle(live, frame, at, has & LIGHT_HAS_DIRECTION ? light->direction : to_eye, light->radius);
    }
    if (has & LIGHT_HAS_CONE) {
        double along = light->cos_outer, aside = sqrt(fmax(0, 1 - along * along));
        draw_circle(live, frame, vec3_add_scaled(at, light->direction, reach * along), light->direction, reach * aside);
    }
    if (light->placed && vec3_max_abs(light->direction) > 0)
        live_draw_edge(live, frame, at, vec3_add_scaled(at, light->direction, reach), outline);
    if (!light->placed && (has & LIGHT_HAS_DIRECTION)) { /* an arrow through the middle of what people look at */
        struct vec3 middle = live->walk.centre;
        double half = 0.15 * vec3_length(vec3_sub(middle, frame->eye));
        struct vec3 tip = vec3_add_scaled(middle, light->direction, half), right, up;
        frame_tangents(light->direction, &right, &up);
        live_draw_edge(live, frame, vec3_add_scaled(middle, light->direction, -half), tip, outline);
        struct vec3 back = vec3_add_scaled(tip, light->direction, -0.3 * half);
        live_draw_edge(live, frame, vec3_add_scaled(back, right, 0.12 * half), tip, outline);
        live_draw_edge(live, frame, vec3_add_scaled(back, right, -0.12 * half), tip, outline);
    }
}

void live_draw_lights(struct live *live, const struct camera_frame *frame) {
    const struct paper *paper = &live->panel.paper;
    double x, y, r = 4 * paper->scale;
    for (uint32_t i = 1; i <= live->lights_known; i++) {
        bool chosen = live->selection.kind == SELECTED_LIGHT && live->selection.light == i, seen;
        const struct told_light *light = live_light(live, i);
        if (!live_light_mark(live, frame, i, &x, &y, &seen))
            continue;
        struct ink ink = chosen ? outline : seen ? bulb : dim;
        paper_ring(paper, x, y, chosen ? 1.5 * r : r, ink);
        paper_line(paper, x - r / 2, y, x + r / 2, y, ink);
        if (!(light->properties & LIGHT_IS_ENVIRONMENT))
            paper_line(paper, x, y - r / 2, x, y + r / 2, ink);
        bool distant = !light->placed && (light->properties & LIGHT_HAS_DIRECTION);
        for (int ray = 0; distant && ray < 4; ray++) {
            double u = ray < 2 ? 1 : -1, v = ray % 2 ? 1 : -1;
            paper_line(paper, x + u * r, y + v * r, x + 1.6 * u * r, y + 1.6 * v * r, ink);
        }
    }
    if (live->selection.kind == SELECTED_LIGHT && live_light(live, live->selection.light))
        draw_form(live, frame, live_light(live, live->selection.light));
}

/* The list of the lights. */

void live_tell_lights(struct live *live, int top) {
    struct panel *panel = &live->panel;
    int scale = panel->paper.scale, step = panel_line_height(panel) + 3 * scale, width = 24 * PAPER_CELL * scale;
    int rows = (panel->paper.height - top - 2 * step) / step, y = top + 2 * scale;
    if (!live->lists_lights || rows < 2 || 2 * width > panel->paper.width)
        return;
    uint32_t count = live->lights_known, shown = (uint32_t)rows;
    bool paged = count > shown;
    live->list_first = live->list_first < count ? live->list_first : 0;
    uint32_t last = count - live->list_first < shown ? count : live->list_first + shown;
    panel_ground(panel, 0, top, width, ((int)(last - live->list_first) + paged) * step + 3 * scale);
    for (uint32_t i = live->list_first; i < last; i++, y += step) {
        char row[64];
        bool chosen = live->selection.kind == SELECTED_LIGHT && live->selection.light == i + 1;
        const char *words = light_kind_name((enum light_kind)live->lights[i].kind);
        (void)snprintf(row, sizeof row, "%u %s", i + 1, words);
        if (panel_button(panel, 2 * scale, y, row, chosen))
            live_select_light(live, i + 1);
    }
    if (paged && panel_button(panel, 2 * scale, y, "Back", false))
        live->list_first = live->list_first > shown ? live->list_first - shown : 0;
    if (paged && panel_button(panel, 32 * scale, y, "More", false) && last < count)
        live->list_first = last;
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

#define TOOL_BUTTONS(X)                                                                                                \
    X(BUTTON_MOVE, "Move")                                                                                             \
    X(BUTTON_TURN, "Turn")                                                                                             \
    X(BUTTON_SIZE, "Size")                                                                                             \
    X(BUTTON_UP, "Up")                                                                                                 \
    X(BUTTON_DOWN, "Down")                                                                                             \
    X(BUTTON_COPY, "Copy")                                                                                             \
    X(BUTTON_DELETE, "Delete")
enum tool_button { TOOL_BUTTONS(LIST_MEMBER) };

/* Whether it can be done with what is selected. */
static bool can_use(const struct live *live, enum tool_button button) {
    const struct told_light *light = live_light(live, live->selection.light);
    bool node = live->selection.kind == SELECTED_NODE;
    switch (button) {
    case BUTTON_MOVE:
        return node || (light && light->moves);
    case BUTTON_TURN:
        return node || (light && light->turns);
    case BUTTON_SIZE:
        return node || (light && light->sizes);
    case BUTTON_UP:
        return node;
    case BUTTON_DOWN:
        return node && live->selection.picked.below > 0;
    case BUTTON_COPY:
    case BUTTON_DELETE:
        break;
    }
    return true;
}

static enum live_tool tool_of(enum tool_button button) {
    switch (button) {
    case BUTTON_MOVE:
        return TOOL_MOVE;
    case BUTTON_TURN:
        return TOOL_TURN;
    case BUTTON_SIZE:
        return TOOL_SIZE;
    case BUTTON_UP:
    case BUTTON_DOWN:
    case BUTTON_COPY:
    case BUTTON_DELETE:
        break;
    }
    return TOOL_NONE;
}

static void use_button(struct live *live, enum tool_button button) {
    switch (button) {
    case BUTTON_MOVE:
    case BUTTON_TURN:
    case BUTTON_SIZE:
        live->tool = live->tool == tool_of(button) ? TOOL_NONE : tool_of(button);
        live->joins = false;
        return;
    case BUTTON_UP:
    case BUTTON_DOWN:
        live_select_up(live, button == BUTTON_DOWN);
        return;
    case BUTTON_COPY:
        live_add(live, ADDED_COPY);
        return;
    case BUTTON_DELETE:
        live_delete(live);
        return;
    }
}

static void tell_tools(struct live *live, struct column *column) {
    static const char *const words[] = {TOOL_BUTTONS(LIST_WORD)};
    struct panel *panel = &live->panel;
    int x = column->x;
    for (int i = 0; i < LIST_COUNT(TOOL_BUTTONS); i++) {
        enum tool_button button = (enum tool_button)i;
        enum live_tool tool = tool_of(button);
        if (!can_use(live, button))
            continue;
        bool used = panel_button(panel, x, column->y, words[i], tool != TOOL_NONE && live->tool == tool);
        x += panel_button_width(panel, words[i]) + 2 * panel->paper.scale;
        if (used)
            use_button(live, button);
    }
    column->y += panel_line_height(panel) + 4 * panel->paper.scale;
}

/* Three sliders. */
static bool tell_sliders(struct live *live, struct column *column, double top, struct vec3 *colour) {
    struct panel *panel = &live->panel;
    int width = column->columns * PAPER_CELL * panel->paper.scale;
    double parts[3] = {colour->x, colour->y, colour->z};
    bool changed = false;
    if (panel->pressed)
        live->joins = false;
    for (int i = 0; i < 3; i++) {
        changed = panel_slider(panel, column->x, column->y, width, 0, top, parts_of_colour[i], &parts[i]) || changed;
        column->y += panel_line_height(panel);
    }
    *colour = vec3_make(parts[0], parts[1], parts[2]);
    return changed;
}

/* One slider for a number that is no share: its logarithm, or from 1 on. */
static bool tell_number(struct live *live, struct column *column, enum look_part part, double *number) {
    struct panel *panel = &live->panel;
    int width = column->columns * PAPER_CELL * panel->paper.scale;
    double low, high, at = part == LOOK_SHININESS ? el_log2(1 + *number) : *number;
    look_part_range(part, &low, &high);
    double top = part == LOOK_SHININESS ? 12 : part == LOOK_IOR ? 3 : 1;
    bool changed = panel_slider(panel, column->x, column->y, width, low, top, bulb, &at);
    column->y += panel_line_height(panel);
    if (changed)
        *number = part == LOOK_SHININESS ? el_exp2(at) - 1 : at;
    return changed;
}

/* Rows of buttons, one for each part. */
static void choose_part(struct live *live, struct column *column) {
    struct panel *panel = &live->panel;
    int scale = panel->paper.scale, x = column->x, right = column->x + column->columns * PAPER_CELL * scale;
    for (int i = 0; i < LOOK_PARTS; i++) {
        const char *name = look_part_name((enum look_part)i);
        int width = panel_button_width(panel, name);
        if (x + width > right) {
            x = column->x;
            column->y += panel_line_height(panel) + 3 * scale;
        }
        if (panel_button(panel, x, column->y, name, live->part == (enum look_part)i))
            live->part = (enum look_part)i;
        x += width + 2 * scale;
    }
    column->y += panel_line_height(panel) + 4 * scale;
}

static void tell_look(struct live *live, struct column *column) {
    struct panel *panel = &live->panel;
    char row[128];
    double numbers[3];
    if (live->selection.picked.material_serial != 0) {
        choose_part(live, column);
        live_look_now(live, live->part, numbers);
        bool colour = look_part_count(live->part) == 3, changed;
        struct vec3 c = {numbers[0], numbers[1], numbers[2]};
        double top = live->part == LOOK_KD || live->part == LOOK_KS ? 1 : 4;
        if (panel->pressed)
            live->joins = false;
        changed = colour ? tell_sliders(live, column, top, &c) : tell_number(live, column, live->part, &numbers[0]);
        if (colour)
            numbers[0] = c.x, numbers[1] = c.y, numbers[2] = c.z;
        if (changed)
            live_look(live, live->part, numbers);
        (void)snprintf(row, sizeof row, colour ? "%s %.3g %.3g %.3g" : "%s %.4g", look_part_name(live->part),
                       numbers[0], numbers[1], numbers[2]);
        tell_text(live, column, row);
    }
    if (!live->selection.picked.can_own)
        return;
    if (panel_button(panel, column->x, column->y, "A material of its own", false))
        live_own(live);
    column->y += panel_line_height(panel) + 4 * panel->paper.scale;
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
        tell_look(live, column);
}

static void tell_light(struct live *live, struct column *column) {
    const struct told_light *light = live_light(live, live->selection.light);
    struct panel *panel = &live->panel;
    char row[128];
    if (!light)
        return;
    (void)snprintf(row, sizeof row, "light %u of %u: %s", live->selection.light, live->light_count,
                   light_kind_name((enum light_kind)light->kind));
    tell_text(live, column, row);
    if (light->placed)
        tell_point(live, column, "at", light->position);
    if (vec3_max_abs(light->direction) > 0)
        tell_point(live, column, "to", light->direction);
    tell_point(live, column, "colour", light->colour);
    tell_tools(live, column);
    if (live->selection.kind != SELECTED_LIGHT)
        return;
    double stops = live_stops_now(live);
    struct vec3 colour = live_light_colour_now(live);
    if (panel->pressed)
        live->joins = false;
    if (panel_slider(panel, column->x, column->y, column->columns * PAPER_CELL * panel->paper.scale, -5, 5, bulb,
                     &stops))
        live_brighten(live, stops);
    column->y += panel_line_height(panel);
    (void)snprintf(row, sizeof row, "%+.2f stops", stops);
    tell_text(live, column, row);
    if (tell_sliders(live, column, live->light_colour_max, &colour))
        live_light_colour(live, colour);
}

/* In a small window one line has to do. */
static void tell_shortly(struct live *live) {
    struct panel *panel = &live->panel;
    const struct picked *picked = &live->selection.picked;
    int scale = panel->paper.scale, line = panel_line_height(panel), top = panel->paper.height - line - 2 * scale;
    char row[256];
    const struct told_light *light = live_light(live, live->selection.light);
    if (live->selection.kind == SELECTED_NODE)
        (void)snprintf(row, sizeof row, "%.60s, %s, at %.4g", picked->name, picked->shape, picked->distance);
    else
        (void)snprintf(row, sizeof row, "light %u, %s", live->selection.light,
                       light ? light_kind_name((enum light_kind)light->kind) : "not known yet");
    panel_ground(panel, 0, top, panel->paper.width, line + 2 * scale);
    panel_text(panel, 2 * scale, top + 2 * scale, row);
}

void live_tell_selection(struct live *live, int top) {
    struct panel *panel = &live->panel;
    int scale = panel->paper.scale, columns = 38, width = (columns * PAPER_CELL + 4) * scale;
    int usual = 12 * panel_line_height(panel), height = live->panel_height > 0 ? live->panel_height : usual;
    if (live->selection.kind == SELECTED_NOTHING)
        return;
    if (5 * width > 2 * panel->paper.width || 2 * (top + usual) > panel->paper.height) {
        tell_shortly(live);
        return;
    }
    struct column column = {panel->paper.width - width + 2 * scale, top + 2 * scale, columns};
    panel_ground(panel, panel->paper.width - width, top, width, height);
    if (live->selection.kind == SELECTED_NODE)
        tell_node(live, &column);
    else
        tell_light(live, &column);
    /* How high it must be is known now: the next frame has it right. */
    live->over_dirty = live->over_dirty || live->panel_height != column.y - top;
    live->panel_height = column.y - top;
}
