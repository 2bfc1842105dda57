/* The picture: its tiles as textures, whose bytes are copies, because those of a texture must not change. Input is read
 * from raw events: the gestures of GTK 4.8 lose drags of the middle and the right button under Wayland. */
#include "viewer/gtk_picture_internal.h"

#include "viewer/gtk_window_internal.h"

#include <math.h>
#include <string.h>

/* Textures. */

static void drop_textures(struct tile_layer *layer) {
    for (uint32_t i = 0; i < layer->count; i++)
        g_clear_object(&layer->textures[i]);
    g_clear_pointer(&layer->textures, g_free);
    g_clear_pointer(&layer->seen, g_free);
    layer->count = 0;
}

void gui_picture_set_layer(struct gui *gui, int which, const struct window_order *order, int descriptor) {
    struct tile_layer *layer = &gui->layers[which];
    drop_textures(layer);
    layer->shared.bytes = which == 0 ? 3 : 4;
    if (!window_layer_attach(&layer->shared, order->width, order->height, descriptor))
        return;
    layer->count = window_layer_tiles(&layer->shared);
    layer->textures = g_new0(GdkTexture *, layer->count);
    layer->seen = g_new0(uint32_t, layer->count);
}

static void tile_rectangle(const struct tile_layer *layer, uint32_t tile, uint32_t *x, uint32_t *y, int *width,
                           int *height) {
    uint32_t columns = (layer->shared.width + WINDOW_TILE - 1) / WINDOW_TILE;
    *x = tile % columns * WINDOW_TILE;
    *y = tile / columns * WINDOW_TILE;
    *width = (int)MIN(WINDOW_TILE, layer->shared.width - *x);
    *height = (int)MIN(WINDOW_TILE, layer->shared.height - *y);
}

/* Whether anything in these pixels of four bytes is visible. */
static bool is_visible(const uint8_t *pixels, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (pixels[4 * i + 3] != 0)
            return true;
    }
    return false;
}

static void make_texture(struct tile_layer *layer, uint32_t tile) {
    uint32_t x, y, bytes = layer->shared.bytes;
    int width, height;
    tile_rectangle(layer, tile, &x, &y, &width, &height);
    size_t row = (size_t)width * bytes;
    uint8_t *copy = g_malloc(row * (size_t)height);
    const uint8_t *pixels = window_layer_pixels(&layer->shared);
    for (int v = 0; v < height; v++)
        memcpy(copy + (size_t)v * row, pixels + ((size_t)(y + (uint32_t)v) * layer->shared.width + x) * bytes, row);
    g_clear_object(&layer->textures[tile]);
    if (bytes == 4 && !is_visible(copy, (size_t)width * (size_t)height)) {
        g_free(copy);
        return;
    }
    GBytes *owned = g_bytes_new_take(copy, row * (size_t)height);
    GdkMemoryFormat format = bytes == 3 ? GDK_MEMORY_R8G8B8 : GDK_MEMORY_R8G8B8A8;
    layer->textures[tile] = gdk_memory_texture_new(width, height, format, owned, row);
    g_bytes_unref(owned);
}

void gui_picture_draw(struct gui *gui, const struct window_order *order) {
    gui->picture_area = GRAPHENE_RECT_INIT((float)order->left, (float)order->top, (float)order->shown_width,
                                           (float)order->shown_height);
    for (int which = 0; which < 2; which++) {
        struct tile_layer *layer = &gui->layers[which];
        const _Atomic uint32_t *numbers = window_layer_numbers(&layer->shared);
        for (uint32_t tile = 0; tile < layer->count; tile++) {
            uint32_t number = atomic_load_explicit(&numbers[tile], memory_order_acquire);
            if (number == layer->seen[tile])
                continue;
            layer->seen[tile] = number;
            make_texture(layer, tile);
        }
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

/* Tiles of a scaled layer begin and end at whole pixels, so that no line shows between them. */
static void draw_layer(GtkSnapshot *snapshot, const struct tile_layer *layer, const graphene_rect_t *place,
                       double scale) {
    double zoom_x = (double)place->size.width / layer->shared.width;
    double zoom_y = (double)place->size.height / layer->shared.height;
    for (uint32_t tile = 0; tile < layer->count; tile++) {
        uint32_t x, y;
        int width, height;
        if (!layer->textures[tile])
            continue;
        tile_rectangle(layer, tile, &x, &y, &width, &height);
        double left = floor((double)place->origin.x + x * zoom_x), top = floor((double)place->origin.y + y * zoom_y);
        double right = floor((double)place->origin.x + (x + (uint32_t)width) * zoom_x);
        double bottom = floor((double)place->origin.y + (y + (uint32_t)height) * zoom_y);
        graphene_rect_t to = GRAPHENE_RECT_INIT((float)(left / scale), (float)(top / scale),
                                                (float)((right - left) / scale), (float)((bottom - top) / scale));
        gtk_snapshot_append_texture(snapshot, layer->textures[tile], &to);
    }
}

static void gray_picture_snapshot(GtkWidget *widget, GtkSnapshot *snapshot) {
    struct gui *gui = GRAY_PICTURE(widget)->gui;
    float width = (float)gtk_widget_get_width(widget), height = (float)gtk_widget_get_height(widget);
    double scale = gtk_widget_get_scale_factor(widget);
    const struct window_layer *over = &gui->layers[1].shared;
    graphene_rect_t whole = GRAPHENE_RECT_INIT(0, 0, width, height);
    graphene_rect_t overlay = GRAPHENE_RECT_INIT(0, 0, (float)over->width, (float)over->height);
    gtk_snapshot_push_clip(snapshot, &whole);
    gtk_snapshot_append_color(snapshot, &(GdkRGBA){0.1f, 0.1f, 0.1f, 1}, &whole);
    draw_layer(snapshot, &gui->layers[0], &gui->picture_area, scale);
    draw_layer(snapshot, &gui->layers[1], &overlay, scale);
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
    gtk_accessible_update_property(GTK_ACCESSIBLE(widget), GTK_ACCESSIBLE_PROPERTY_LABEL, "Picture", -1);
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

/* A key with an effect while it is pressed; letters only while flying. */
static int held_key(const struct gui *gui, guint value) {
    switch (value) {
    case GDK_KEY_Up:
        return WINDOW_ARROW_UP;
    case GDK_KEY_Down:
        return WINDOW_ARROW_DOWN;
    case GDK_KEY_Left:
        return WINDOW_ARROW_LEFT;
    case GDK_KEY_Right:
        return WINDOW_ARROW_RIGHT;
    case GDK_KEY_Shift_L:
    case GDK_KEY_Shift_R:
        return WINDOW_SHIFT;
    case GDK_KEY_Control_L:
    case GDK_KEY_Control_R:
        return WINDOW_CONTROL;
    default:
        value = gdk_keyval_to_lower(value);
        return gui->flies && value < 128 && value > 0 && strchr("wasdeq", (int)value) ? (int)value : 0;
    }
}

static void send_held_key(struct gui *gui, int key, bool down) {
    gui_send_event(gui, &(struct window_event){.kind = WINDOW_KEY, .key = key, .down = down});
}

/* The action of a key in the chosen set, or -1. */
static int action_of(const struct gui *gui, guint value, GdkModifierType state) {
    state &= GDK_CONTROL_MASK | GDK_SHIFT_MASK | GDK_ALT_MASK;
    for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
        char **keys = g_strsplit(window_action_table[i].keys[gui->key_set], " ", -1);
        bool found = false;
        for (char **key = keys; *key && !found; key++) {
            guint wanted;
            GdkModifierType with;
            /* Shift is part of the symbol of keys like plus. */
            bool symbol = value == gdk_keyval_to_lower(value) && value == gdk_keyval_to_upper(value) && value < 128;
            found = gtk_accelerator_parse(*key, &wanted, &with) && wanted == gdk_keyval_to_lower(value) &&
                    (with == state || (symbol && with == (state & ~(guint)GDK_SHIFT_MASK)));
        }
        g_strfreev(keys);
        if (found)
            return i;
    }
    return -1;
}

static gboolean press_key(GtkEventControllerKey *keys, guint value, guint code, GdkModifierType state, gpointer data) {
    struct gui *gui = data;
    (void)keys, (void)code;
    bool plain = (state & (GDK_CONTROL_MASK | GDK_ALT_MASK)) == 0 || gui->flies;
    int held = plain || value == GDK_KEY_Control_L ? held_key(gui, value) : 0;
    if (held > 0 && gtk_widget_has_focus(gui->picture)) {
        send_held_key(gui, held, true);
        return held != WINDOW_SHIFT && held != WINDOW_CONTROL;
    }
    int action = action_of(gui, value, state);
    if (action >= 0)
        gui_send_action(gui, (enum window_action)action);
    return action >= 0;
}

static void release_key(GtkEventControllerKey *keys, guint value, guint code, GdkModifierType state, gpointer data) {
    struct gui *gui = data;
    int held = held_key(gui, value);
    (void)keys, (void)code, (void)state;
    if (held > 0)
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
