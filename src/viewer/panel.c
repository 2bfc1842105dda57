/* A part is pressed when the mouse button goes down on it, and used when the button goes up on it again. Parts are
 * identified by their number in the frame; if a frame in between has other parts, the press is lost. */
#include "viewer/panel.h"

static const struct canvas_colour ground = {18, 20, 24, 200}, plain = {225, 228, 232, 255}, quiet = {66, 72, 82, 235};
static const struct canvas_colour lit = {96, 106, 122, 245}, chosen = {190, 120, 40, 245},
                                  warning = {255, 120, 90, 255};
static const struct canvas_colour filled = {90, 150, 220, 255};

void panel_begin(struct panel *panel) {
    canvas_clear(&panel->canvas);
    panel->ground_count = 0;
    panel->part = 0;
}

void panel_end(struct panel *panel) {
    if (panel->released)
        panel->held = 0;
    panel->pressed = panel->released = false;
}

int panel_line_height(const struct panel *panel) {
    return CANVAS_LINE * panel->canvas.scale;
}

int panel_button_width(const struct panel *panel, const char *text) {
    return canvas_text_width(&panel->canvas, text) + 6 * panel->canvas.scale;
}

static bool inside(const struct panel *panel, int x, int y, int width, int height) {
    return panel->mouse_x >= x && panel->mouse_y >= y && panel->mouse_x < x + width && panel->mouse_y < y + height;
}

bool panel_covers(const struct panel *panel, double x, double y) {
    struct panel there = {.mouse_x = x, .mouse_y = y};
    bool covers = false;
    for (int i = 0; i < panel->ground_count; i++)
        covers = covers || inside(&there, panel->grounds[i].x, panel->grounds[i].y, panel->grounds[i].width,
                                  panel->grounds[i].height);
    return covers;
}

void panel_ground(struct panel *panel, int x, int y, int width, int height) {
    if (panel->ground_count < PANEL_GROUNDS) {
        int i = panel->ground_count++;
        panel->grounds[i].x = x;
        panel->grounds[i].y = y;
        panel->grounds[i].width = width;
        panel->grounds[i].height = height;
    }
    canvas_box(&panel->canvas, x, y, width, height, ground);
}

void panel_text(struct panel *panel, int x, int y, const char *text) {
    canvas_text(&panel->canvas, x, y, text, plain);
}

void panel_warning(struct panel *panel, int x, int y, const char *text) {
    canvas_text(&panel->canvas, x, y, text, warning);
}

void panel_bar(struct panel *panel, int x, int y, int width, double share) {
    int scale = panel->canvas.scale, height = CANVAS_LETTER * scale;
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    canvas_box(&panel->canvas, x, y, width, height, quiet);
    canvas_box(&panel->canvas, x, y, (int)(width * share), height, filled);
}

bool panel_button(struct panel *panel, int x, int y, const char *text, bool on) {
    int scale = panel->canvas.scale, width = panel_button_width(panel, text), height = (CANVAS_LETTER + 4) * scale;
    int part = ++panel->part;
    bool in = inside(panel, x, y, width, height);
    if (in && panel->pressed)
        panel->held = part;
    canvas_box(&panel->canvas, x, y, width, height, on ? chosen : in ? lit : quiet);
    canvas_text(&panel->canvas, x + 3 * scale, y + 2 * scale, text, plain);
    return in && panel->released && panel->held == part;
}

bool panel_slider(struct panel *panel, const struct panel_slider *slider, double *value) {
    int x = slider->x, y = slider->y, width = slider->width;
    double low = slider->low, high = slider->high;
    int scale = panel->canvas.scale, height = CANVAS_LETTER * scale, part = ++panel->part;
    bool in = inside(panel, x, y - scale, width, height + 2 * scale), changed = false;
    if (in && panel->pressed)
        panel->held = part;
    if (panel->held == part && (panel->down || panel->released)) {
        double share = (panel->mouse_x - x) / width;
        share = share < 0 ? 0 : share > 1 ? 1 : share;
        double wanted = low + share * (high - low);
        changed = wanted < *value || wanted > *value;
        *value = wanted;
    }
    double share = (*value - low) / (high - low);
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    canvas_box(&panel->canvas, x, y, width, height, quiet);
    canvas_box(&panel->canvas, x, y, (int)(width * share), height, slider->colour);
    return changed;
}

int panel_button_row(struct panel *panel, int y, const char *const *words, int count, unsigned on, bool *used) {
    int scale = panel->canvas.scale, x = 2 * scale;
    for (int i = 0; i < count; i++) {
        int width = panel_button_width(panel, words[i]);
        if (x + width > panel->canvas.width)
            break;
        used[i] = panel_button(panel, x, y, words[i], on >> i & 1);
        x += width + 2 * scale;
    }
    return x;
}
