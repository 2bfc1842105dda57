/* The picture: its tiles as textures, whose bytes are copies, because those of a texture must not change. Input is read
 * from raw events: the gestures of GTK 4.8 lose drags of the middle and the right button under Wayland. */
#include "window/gtk_picture_internal.h"

#include "window/gtk_window_internal.h"

#include <math.h>
#include <string.h>

/* Textures. */

static void drop_textures(struct picture_tiles *tiles) {
    for (uint32_t i = 0; i < tiles->count; i++)
        g_clear_object(&tiles->textures[i]);
    g_clear_pointer(&tiles->textures, g_free);
    g_clear_pointer(&tiles->seen, g_free);
    tiles->count = 0;
}

void gui_picture_attach(struct gui *gui, const struct window_order *order, int descriptor) {
    struct picture_tiles *tiles = &gui->tiles;
    drop_textures(tiles);
    if (!window_picture_attach(&tiles->shared, order->width, order->height, descriptor))
        return;
    tiles->count = window_picture_tiles(&tiles->shared);
    tiles->textures = g_new0(GdkTexture *, tiles->count);
    tiles->seen = g_new0(uint32_t, tiles->count);
}

/* Where the tile is in a picture that is shown with so many pixels. Tiles begin and end at whole pixels, so that no
 * line shows between them. */
struct tile_rectangle {
    uint32_t left, top, right, bottom;
};
static struct tile_rectangle tile_rectangle(const struct picture_tiles *tiles, uint32_t tile, uint32_t width,
                                            uint32_t height) {
    const uint32_t full_width = tiles->shared.width, full_height = tiles->shared.height;
    uint32_t columns = (full_width + WINDOW_TILE - 1) / WINDOW_TILE;
    uint32_t x = tile % columns * WINDOW_TILE, y = tile / columns * WINDOW_TILE;
    uint32_t right = MIN(x + WINDOW_TILE, full_width), bottom = MIN(y + WINDOW_TILE, full_height);
    return (struct tile_rectangle){
        (uint32_t)((uint64_t)x * width / full_width), (uint32_t)((uint64_t)y * height / full_height),
        (uint32_t)((uint64_t)right * width / full_width), (uint32_t)((uint64_t)bottom * height / full_height)};
}

/* The pixels of the picture that a pixel of a smaller one covers, and how much of the first and the last one; all
 * others are covered completely. */
struct cover {
    uint32_t first, last;
    float begin, end;
};
static struct cover cover_of(uint32_t p, uint32_t full, uint32_t part) {
    uint64_t from = (uint64_t)p * full, to = from + full; /* in units of 1 / part pixels */
    uint32_t first = (uint32_t)(from / part), last = (uint32_t)((to - 1) / part);
    float unit = 1 / (float)part;
    return (struct cover){first, last, (float)(MIN(to, (uint64_t)(first + 1) * part) - from) * unit,
                          (float)(to - (uint64_t)last * part) * unit};
}
static float cover_weight(const struct cover *cover, uint32_t pixel) {
    return pixel == cover->first ? cover->begin : pixel == cover->last ? cover->end : 1;
}

/* A part of the picture that is shown smaller, with whole pixels: means by area. GTK would take several times as long.
 */
static void shrink(const struct window_picture *picture, const struct tile_rectangle *to, uint32_t width,
                   uint32_t height, uint8_t *out) {
    const uint8_t *pixels = window_picture_pixels(picture);
    struct cover *columns = g_new(struct cover, to->right - to->left);
    for (uint32_t x = to->left; x < to->right; x++)
        columns[x - to->left] = cover_of(x, picture->width, width);
    const uint32_t begin = columns[0].first, count = 3 * (columns[to->right - to->left - 1].last + 1 - begin);
    const float unit = (float)width * (float)height / ((float)picture->width * (float)picture->height);
    float *sums = g_new(float, count);
    for (uint32_t y = to->top; y < to->bottom; y++) {
        const struct cover rows = cover_of(y, picture->height, height);
        memset(sums, 0, count * sizeof *sums);
        for (uint32_t row = rows.first; row <= rows.last; row++) {
            const float weight = cover_weight(&rows, row) * unit;
            const uint8_t *from = pixels + 3 * ((size_t)row * picture->width + begin);
            for (uint32_t i = 0; i < count; i++)
                sums[i] += weight * (float)from[i];
        }
        for (uint32_t x = 0; x < to->right - to->left; x++) {
            float mean[3] = {0.5f, 0.5f, 0.5f};
            for (uint32_t column = columns[x].first; column <= columns[x].last; column++) {
                const float weight = cover_weight(&columns[x], column), *sum = sums + 3 * (column - begin);
                for (int c = 0; c < 3; c++)
                    mean[c] += weight * sum[c];
            }
            for (int c = 0; c < 3; c++)
                *out++ = (uint8_t)MIN(mean[c], 255);
        }
    }
    g_free(columns);
    g_free(sums);
}

static void copy(const struct window_picture *picture, const struct tile_rectangle *to, uint8_t *out) {
    const size_t row = 3 * (size_t)(to->right - to->left);
    for (uint32_t y = to->top; y < to->bottom; y++)
        memcpy(out + (y - to->top) * row, window_picture_pixels(picture) + 3 * ((size_t)y * picture->width + to->left),
               row);
}

static void make_texture(struct picture_tiles *tiles, uint32_t tile) {
    const struct window_picture *picture = &tiles->shared;
    const struct tile_rectangle to = tile_rectangle(tiles, tile, tiles->width, tiles->height);
    const uint32_t width = to.right - to.left, height = to.bottom - to.top;
    g_clear_object(&tiles->textures[tile]);
    if (width == 0 || height == 0)
        return;
    uint8_t *pixels = g_malloc(3 * (size_t)width * height);
    if (tiles->width == picture->width && tiles->height == picture->height)
        copy(picture, &to, pixels);
    else
        shrink(picture, &to, tiles->width, tiles->height, pixels);
    GBytes *owned = g_bytes_new_take(pixels, 3 * (size_t)width * height);
    tiles->textures[tile] =
        gdk_memory_texture_new((int)width, (int)height, GDK_MEMORY_R8G8B8, owned, 3 * (size_t)width);
    g_bytes_unref(owned);
}

void gui_picture_draw(struct gui *gui) {
    struct picture_tiles *tiles = &gui->tiles;
    uint32_t width = MIN(tiles->shared.width, (uint32_t)MAX(gui->state.shown_width, 1)),
             height = MIN(tiles->shared.height, (uint32_t)MAX(gui->state.shown_height, 1));
    bool resized = width != tiles->width || height != tiles->height;
    tiles->width = width;
    tiles->height = height;
    for (uint32_t tile = 0; tile < tiles->count; tile++) {
        uint32_t number = atomic_load_explicit(&window_picture_numbers(&tiles->shared)[tile], memory_order_acquire);
        if (number == tiles->seen[tile] && tiles->textures[tile] && !resized)
            continue;
        tiles->seen[tile] = number;
        make_texture(tiles, tile);
    }
    gtk_widget_queue_draw(gui->picture);
}

/* The widget. */

G_DECLARE_FINAL_TYPE(GrayPicture, gray_picture, GRAY, PICTURE, GtkWidget)
struct _GrayPicture {
    GtkWidget parent;
    struct gui *gui;
};
G_DEFINE_FINAL_TYPE(GrayPicture, gray_picture, GTK_TYPE_WIDGET)

static void draw_tiles(GtkSnapshot *snapshot, const struct gui *gui, double scale) {
    const struct window_state *state = &gui->state;
    for (uint32_t tile = 0; tile < gui->tiles.count; tile++) {
        struct tile_rectangle to = tile_rectangle(&gui->tiles, tile, (uint32_t)MAX(state->shown_width, 0),
                                                  (uint32_t)MAX(state->shown_height, 0));
        if (!gui->tiles.textures[tile] || to.left == to.right || to.top == to.bottom)
            continue;
        graphene_rect_t bounds = GRAPHENE_RECT_INIT(
            (float)((state->left + (double)to.left) / scale), (float)((state->top + (double)to.top) / scale),
            (float)((to.right - to.left) / scale), (float)((to.bottom - to.top) / scale));
        gtk_snapshot_append_texture(snapshot, gui->tiles.textures[tile], &bounds);
    }
}

/* Each with a dark border, so that it shows on any picture. */
static void draw_lines(cairo_t *cairo, const struct gui *gui) {
    static const double colours[][3] = {[LINE_COLOUR_SELECTED] = {1, 0.75, 0.25}, [LINE_COLOUR_LIGHT] = {1, 0.92, 0.47},
                                        [LINE_COLOUR_FAINT] = {0.78, 0.73, 0.43}, [LINE_COLOUR_X] = {0.95, 0.3, 0.3},
                                        [LINE_COLOUR_Y] = {0.4, 0.85, 0.3},       [LINE_COLOUR_Z] = {0.35, 0.55, 1}};
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_ROUND);
    for (int over = 0; over < 2; over++) {
        for (uint32_t i = 0; i < gui->state.line_count; i++) {
            const struct window_line *line = &gui->state.lines[i];
            cairo_move_to(cairo, (double)line->x0, (double)line->y0);
            cairo_line_to(cairo, (double)line->x1, (double)line->y1);
            if (i + 1 < gui->state.line_count && gui->state.lines[i + 1].colour == line->colour)
                continue;
            const double *colour = colours[line->colour % G_N_ELEMENTS(colours)];
            cairo_set_source_rgba(cairo, over ? colour[0] : 0, over ? colour[1] : 0, over ? colour[2] : 0,
                                  over ? 1 : 0.4);
            cairo_set_line_width(cairo, (over ? 1.5 : 3) * gtk_widget_get_scale_factor(gui->picture));
            cairo_stroke(cairo);
        }
    }
}

static void gray_picture_snapshot(GtkWidget *widget, GtkSnapshot *snapshot) {
    struct gui *gui = GRAY_PICTURE(widget)->gui;
    float width = (float)gtk_widget_get_width(widget), height = (float)gtk_widget_get_height(widget);
    double scale = gtk_widget_get_scale_factor(widget);
    graphene_rect_t whole = GRAPHENE_RECT_INIT(0, 0, width, height);
    gtk_snapshot_push_clip(snapshot, &whole);
    gtk_snapshot_append_color(snapshot, &(GdkRGBA){0.1f, 0.1f, 0.1f, 1}, &whole);
    draw_tiles(snapshot, gui, scale);
    if (gui->state.line_count > 0) {
        cairo_t *cairo = gtk_snapshot_append_cairo(snapshot, &whole);
        cairo_scale(cairo, 1 / scale, 1 / scale);
        draw_lines(cairo, gui);
        cairo_destroy(cairo);
    }
    gtk_snapshot_pop(snapshot);
}

void gui_picture_send_size(struct gui *gui) {
    int scale = gtk_widget_get_scale_factor(gui->picture);
    struct window_event event = {.kind = WINDOW_SIZE,
                                 .x = gtk_widget_get_width(gui->picture) * scale,
                                 .y = gtk_widget_get_height(gui->picture) * scale,
                                 .density = scale};
    if (event.x > 0 && event.y > 0)
        gui_send_event(gui, &event);
}

static void gray_picture_size_allocate(GtkWidget *widget, int width, int height, int baseline) {
    (void)width, (void)height, (void)baseline;
    gui_picture_send_size(GRAY_PICTURE(widget)->gui);
}

static void gray_picture_class_init(GrayPictureClass *class) {
    GTK_WIDGET_CLASS(class)->snapshot = gray_picture_snapshot;
    GTK_WIDGET_CLASS(class)->size_allocate = gray_picture_size_allocate;
    gtk_widget_class_set_accessible_role(GTK_WIDGET_CLASS(class), GTK_ACCESSIBLE_ROLE_IMG);
}
static void gray_picture_init(GrayPicture *picture) {
    GtkWidget *widget = GTK_WIDGET(picture);
    gtk_widget_set_focusable(widget, TRUE);
    gtk_widget_set_hexpand(widget, TRUE);
    gtk_widget_set_vexpand(widget, TRUE);
    gtk_widget_set_size_request(widget, 160, 120);
    gui_label(widget, "Picture");
}

/* The mouse. */

static void point_of(struct gui *gui, GdkEvent *event, double *x, double *y) {
    double left, top, scale = gtk_widget_get_scale_factor(gui->picture);
    GtkNative *native = gtk_widget_get_native(gui->picture);
    gdk_event_get_position(event, x, y); /* on the surface */
    gtk_native_get_surface_transform(native, &left, &top);
    gtk_widget_translate_coordinates(GTK_WIDGET(native), gui->picture, *x - left, *y - top, x, y);
    *x *= scale;
    *y *= scale;
}

static gboolean handle_pointer(GtkEventControllerLegacy *controller, GdkEvent *event, gpointer data) {
    struct gui *gui = data;
    GdkEventType type = gdk_event_get_event_type(event);
    GdkModifierType state = gdk_event_get_modifier_state(event);
    struct window_event out = {.control = (state & GDK_CONTROL_MASK) != 0, .shift = (state & GDK_SHIFT_MASK) != 0};
    (void)controller;
    if (type != GDK_BUTTON_PRESS && type != GDK_BUTTON_RELEASE && type != GDK_MOTION_NOTIFY)
        return GDK_EVENT_PROPAGATE;
    point_of(gui, event, &out.x, &out.y);
    out.dx = out.x - gui->mouse_x;
    out.dy = out.y - gui->mouse_y;
    gui->mouse_x = out.x;
    gui->mouse_y = out.y;
    out.kind = type == GDK_MOTION_NOTIFY ? WINDOW_MOVE : type == GDK_BUTTON_PRESS ? WINDOW_PRESS : WINDOW_RELEASE;
    if (type != GDK_MOTION_NOTIFY) {
        guint button = gdk_button_event_get_button(event);
        out.button = button == 1 ? WINDOW_LEFT : button == 2 ? WINDOW_MIDDLE : WINDOW_RIGHT;
        gtk_widget_grab_focus(gui->picture);
    }
    gui_send_event(gui, &out);
    return type == GDK_MOTION_NOTIFY ? GDK_EVENT_PROPAGATE : GDK_EVENT_STOP;
}

static gboolean handle_wheel(GtkEventControllerScroll *scroll, double dx, double dy, gpointer data) {
    struct gui *gui = data;
    GdkModifierType state = gtk_event_controller_get_current_event_state(GTK_EVENT_CONTROLLER(scroll));
    (void)dx;
    bool control = (state & GDK_CONTROL_MASK) != 0;
    gui_send_event(gui, &(struct window_event){.kind = WINDOW_WHEEL, .y = -dy, .control = control});
    return GDK_EVENT_STOP;
}

/* Keys. */

/* The key that flies, or -1; letters only while flying. */
static int held_key(const struct gui *gui, guint value) {
    static const struct {
        guint value;
        enum fly_camera_key key;
        bool letter;
    } keys[] = {{GDK_KEY_Up, FLY_FORWARD, false},
                {GDK_KEY_Down, FLY_BACK, false},
                {GDK_KEY_Left, FLY_LEFT, false},
                {GDK_KEY_Right, FLY_RIGHT, false},
                {GDK_KEY_Shift_L, FLY_FAST, false},
                {GDK_KEY_Shift_R, FLY_FAST, false},
                {GDK_KEY_Control_L, FLY_SLOW, false},
                {GDK_KEY_Control_R, FLY_SLOW, false},
                {GDK_KEY_w, FLY_FORWARD, true},
                {GDK_KEY_s, FLY_BACK, true},
                {GDK_KEY_a, FLY_LEFT, true},
                {GDK_KEY_d, FLY_RIGHT, true},
                {GDK_KEY_e, FLY_UP, true},
                {GDK_KEY_q, FLY_DOWN, true}};
    for (size_t i = 0; i < G_N_ELEMENTS(keys); i++) {
        if (keys[i].value == (keys[i].letter ? gdk_keyval_to_lower(value) : value) &&
            (gui->state.flies || !keys[i].letter))
            return (int)keys[i].key;
    }
    return -1;
}

static void send_held_key(struct gui *gui, int key, bool down) {
    gui_send_event(gui, &(struct window_event){.kind = WINDOW_KEY, .key = (enum fly_camera_key)key, .down = down});
}

/* What the key is without Shift: 0 in place of a parenthesis. */
static guint without_shift(const struct gui *gui, guint value, guint code) {
    GdkKeymapKey *keys = NULL;
    guint *values = NULL;
    int count = 0;
    if (gdk_display_map_keycode(gtk_widget_get_display(gui->window), code, &keys, &values, &count)) {
        for (int i = 0; i < count; i++)
            value = keys[i].level == 0 && keys[i].group == 0 ? values[i] : value;
    }
    g_free(keys);
    g_free(values);
    return value;
}

/* The action of a key in the chosen set, or -1. */
static int action_of(const struct gui *gui, guint value, guint code, GdkModifierType state) {
    guint plain = without_shift(gui, value, code);
    state &= GDK_CONTROL_MASK | GDK_SHIFT_MASK | GDK_ALT_MASK;
    for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
        char **keys = g_strsplit(window_action_table[i].keys[gui->key_set], " ", -1);
        bool found = false;
        for (char **key = keys; *key && !found; key++) {
            guint wanted;
            GdkModifierType with;
            /* Shift is part of the symbol of keys like plus. */
            bool symbol = value == gdk_keyval_to_lower(value) && value == gdk_keyval_to_upper(value) && value < 128;
            found = gtk_accelerator_parse(*key, &wanted, &with) &&
                    (wanted == gdk_keyval_to_lower(value) || (wanted == plain && with == state)) &&
                    (with == state || (symbol && with == (state & ~(guint)GDK_SHIFT_MASK)));
        }
        g_strfreev(keys);
        if (found)
            return i;
    }
    return -1;
}

/* The character of a key for a tool, or 0. */
static char typed_char(guint value) {
    guint32 c = gdk_keyval_to_unicode(value);
    if (value == GDK_KEY_BackSpace)
        return '\b';
    if (value == GDK_KEY_Return || value == GDK_KEY_KP_Enter)
        return '\r';
    c = c == ',' ? '.' : c;
    return c > 0 && c < 128 && strchr("xyz0123456789.-", (int)c) ? (char)c : '\0';
}

static gboolean press_key(GtkEventControllerKey *keys, guint value, guint code, GdkModifierType state, gpointer data) {
    struct gui *gui = data;
    /* Panes of GTK take function keys for themselves. */
    bool first = gtk_event_controller_get_propagation_phase(GTK_EVENT_CONTROLLER(keys)) == GTK_PHASE_CAPTURE;
    if (first && (value < GDK_KEY_F2 || value > GDK_KEY_F12))
        return GDK_EVENT_PROPAGATE;
    bool plain = (state & (GDK_CONTROL_MASK | GDK_ALT_MASK)) == 0 || gui->state.flies;
    int held = plain || value == GDK_KEY_Control_L ? held_key(gui, value) : -1;
    if (held >= 0 && gtk_widget_has_focus(gui->picture)) {
        send_held_key(gui, held, true);
        return held != FLY_FAST && held != FLY_SLOW;
    }
    bool types = gui->state.types || g_get_monotonic_time() - gui->tool_begun < 300000;
    char typed = types && plain ? typed_char(value) : '\0';
    if (typed != '\0') {
        gui_send_event(gui, &(struct window_event){.kind = WINDOW_TYPE, .typed = typed});
        return GDK_EVENT_STOP;
    }
    if (value == GDK_KEY_A && plain && (gui->state.action_on >> NEEDS_PICTURE & 1)) {
        g_action_group_activate_action(G_ACTION_GROUP(gui->window), "add", NULL);
        return GDK_EVENT_STOP;
    }
    int action = action_of(gui, value, code, state);
    if (action >= 0)
        gui_send_action(gui, (enum window_action)action);
    return action >= 0;
}

static void release_key(GtkEventControllerKey *keys, guint value, guint code, GdkModifierType state, gpointer data) {
    struct gui *gui = data;
    int held = held_key(gui, value);
    (void)keys, (void)code, (void)state;
    if (held >= 0)
        send_held_key(gui, held, false);
}

static void leave(GtkEventControllerFocus *focus, gpointer data) {
    (void)focus;
    gui_send_event(data, &(struct window_event){.kind = WINDOW_LEAVE});
}

void gui_add_keys(struct gui *gui) {
    GtkEventController *keys = gtk_event_controller_key_new(), *focus = gtk_event_controller_focus_new();
    g_signal_connect(keys, "key-pressed", G_CALLBACK(press_key), gui);
    g_signal_connect(keys, "key-released", G_CALLBACK(release_key), gui);
    g_signal_connect(focus, "leave", G_CALLBACK(leave), gui);
    gtk_event_controller_set_propagation_phase(keys, GTK_PHASE_BUBBLE);
    gtk_widget_add_controller(gui->window, keys);
    GtkEventController *first = gtk_event_controller_key_new();
    g_signal_connect(first, "key-pressed", G_CALLBACK(press_key), gui);
    gtk_event_controller_set_propagation_phase(first, GTK_PHASE_CAPTURE);
    gtk_widget_add_controller(gui->window, first);
    gtk_widget_add_controller(gui->picture, focus);
}

GtkWidget *gui_picture_new(struct gui *gui) {
    GrayPicture *picture = g_object_new(gray_picture_get_type(), NULL);
    GtkEventController *raw = gtk_event_controller_legacy_new();
    GtkEventController *scroll = gtk_event_controller_scroll_new(GTK_EVENT_CONTROLLER_SCROLL_VERTICAL);
    picture->gui = gui;
    g_signal_connect(raw, "event", G_CALLBACK(handle_pointer), gui);
    g_signal_connect(scroll, "scroll", G_CALLBACK(handle_wheel), gui);
    gtk_widget_add_controller(GTK_WIDGET(picture), raw);
    gtk_widget_add_controller(GTK_WIDGET(picture), scroll);
    return GTK_WIDGET(picture);
}
