/* What can be added to the scene (script/addable.h): menus, and a list that is searched. */
#include "window/gtk_add_internal.h"

#include "script/addable.h"
#include "window/gtk_window_internal.h"

#include <string.h>

static gboolean filter_action(GtkListBoxRow *row, gpointer data) {
    const char *title = g_object_get_data(G_OBJECT(row), "title");
    char *text = g_utf8_casefold(gtk_editable_get_text(GTK_EDITABLE(data)), -1), *in = g_utf8_casefold(title, -1);
    bool found = strstr(in, text) != NULL;
    g_free(text);
    g_free(in);
    return found;
}

static void filter_changed(GtkSearchEntry *entry, gpointer list) {
    (void)entry;
    gtk_list_box_invalidate_filter(list);
}

static void send_call(struct gui *gui, const char *call) {
    struct window_event event = {.kind = WINDOW_ADD};
    (void)g_strlcpy(event.text, call, sizeof event.text);
    gui_send_event(gui, &event);
}

static void choose_row(GtkListBox *list, GtkListBoxRow *row, gpointer data) {
    GtkWidget *popover = gtk_widget_get_ancestor(GTK_WIDGET(list), GTK_TYPE_POPOVER);
    gtk_popover_popdown(GTK_POPOVER(popover));
    send_call(data, g_object_get_data(G_OBJECT(row), "call"));
}

static void choose_call(GSimpleAction *action, GVariant *value, gpointer data) {
    (void)action;
    send_call(data, g_variant_get_string(value, NULL));
}

/* Return takes the first row that is shown. */
static void choose_first(GtkSearchEntry *entry, gpointer list) {
    (void)entry;
    GtkListBoxRow *row = gtk_list_box_get_row_at_y(list, 4);
    if (row)
        g_signal_emit_by_name(list, "row-activated", row);
}

static void show_add_list(GSimpleAction *action, GVariant *value, gpointer data) {
    struct gui *gui = data;
    GtkWidget *popover = gtk_popover_new(), *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 4);
    GtkWidget *entry = gtk_search_entry_new(), *list = gtk_list_box_new(), *scrolled = gtk_scrolled_window_new();
    (void)action, (void)value;
    for (const char *const *add = addable_txt; *add; add += ADDABLE_COLUMNS) {
        char *title = g_strdup_printf("%s  (%s)", add[ADDABLE_TITLE], add[ADDABLE_GROUP]);
        GtkWidget *row = gtk_list_box_row_new(), *label = gtk_label_new(title);
        gtk_label_set_xalign(GTK_LABEL(label), 0);
        gtk_list_box_row_set_child(GTK_LIST_BOX_ROW(row), label);
        g_object_set_data(G_OBJECT(row), "call", (char *)(uintptr_t)add[ADDABLE_CALL]);
        g_object_set_data_full(G_OBJECT(row), "title", title, g_free);
        gtk_list_box_append(GTK_LIST_BOX(list), row);
    }
    gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scrolled), list);
    gtk_scrolled_window_set_policy(GTK_SCROLLED_WINDOW(scrolled), GTK_POLICY_NEVER, GTK_POLICY_AUTOMATIC);
    gtk_scrolled_window_set_min_content_height(GTK_SCROLLED_WINDOW(scrolled), 240);
    gui_name(entry, "Search what to add");
    gtk_list_box_set_filter_func(GTK_LIST_BOX(list), filter_action, entry, NULL);
    g_signal_connect(entry, "search-changed", G_CALLBACK(filter_changed), list);
    g_signal_connect(entry, "activate", G_CALLBACK(choose_first), list);
    g_signal_connect(list, "row-activated", G_CALLBACK(choose_row), gui);
    gtk_box_append(GTK_BOX(box), entry);
    gtk_box_append(GTK_BOX(box), scrolled);
    gtk_popover_set_child(GTK_POPOVER(popover), box);
    gtk_widget_set_parent(popover, gui->picture);
    gtk_popover_set_pointing_to(GTK_POPOVER(popover), &(GdkRectangle){(int)gui->mouse_x, (int)gui->mouse_y, 1, 1});
    g_signal_connect_after(popover, "closed", G_CALLBACK(gtk_widget_unparent), NULL);
    gtk_popover_popup(GTK_POPOVER(popover));
    gtk_widget_grab_focus(entry);
}

/* A menu for each group of what can be added. */
void gui_add_calls(GMenu *menu) {
    GMenu *group = NULL;
    const char *name = "";
    for (const char *const *add = addable_txt; *add; add += ADDABLE_COLUMNS) {
        group = strcmp(name, add[ADDABLE_GROUP]) == 0 ? group : gui_add_menu(menu, add[ADDABLE_GROUP]);
        name = add[ADDABLE_GROUP];
        GMenuItem *item = g_menu_item_new(add[ADDABLE_TITLE], NULL);
        g_menu_item_set_action_and_target(item, "win.add-call", "s", add[ADDABLE_CALL]);
        g_menu_append_item(group, item);
        g_object_unref(item);
    }
}

/* As a string of Lua. NULL: the name has control characters. Owner: the caller. */
static char *lua_name(const char *path) {
    GString *text = g_string_new("'");
    bool ok = true;
    for (const char *c = path; *c; c++) {
        ok = ok && (unsigned char)*c >= ' ' && *c != 127;
        if (strchr("'\\", *c))
            g_string_append_c(text, '\\');
        g_string_append_c(text, *c);
    }
    g_string_append_c(text, '\'');
    return g_string_free(text, !ok);
}

static bool ends_as(const char *path, const char *const endings[]) {
    const char *dot = strrchr(path, '.');
    for (int i = 0; dot && endings[i]; i++) {
        if (g_ascii_strcasecmp(dot, endings[i]) == 0)
            return true;
    }
    return false;
}

/* At this place of the window. False: the file is neither a picture nor a sky, or there is no scene. */
static bool drop_picture(struct gui *gui, const char *path, double x, double y) {
    static const char *const pictures[] = {".png", ".jpg", ".jpeg", NULL}, *const skies[] = {".hdr", ".exr", ".pfm",
                                                                                             NULL};
    bool sky = ends_as(path, skies);
    char *name = gui->state.has_scene && (sky || ends_as(path, pictures)) ? lua_name(path) : NULL;
    struct window_event event = {.kind = sky ? WINDOW_ADD : WINDOW_TEXTURE};
    if (!name)
        return false;
    if (gtk_widget_translate_coordinates(gui->window, gui->picture, x, y, &x, &y) &&
        gtk_widget_contains(gui->picture, x, y)) {
        event.down = true;
        event.x = x * gtk_widget_get_scale_factor(gui->picture);
        event.y = y * gtk_widget_get_scale_factor(gui->picture);
    }
    (void)g_snprintf(event.text, sizeof event.text,
                     sky ? "gr.sky_light{sky = gr.sky_map{image = %s}}" : "gr.texture(%s)", name);
    gui_send_event(gui, &event);
    g_free(name);
    return true;
}

static gboolean handle_drop(GtkDropTarget *target, const GValue *value, double x, double y, gpointer data) {
    GSList *files = gdk_file_list_get_files(g_value_get_boxed(value));
    char *path = files ? g_file_get_path(files->data) : NULL;
    (void)target;
    if (files && !(path && drop_picture(data, path, x, y)))
        gui_open_scene(data, files->data);
    g_free(path);
    bool any = files != NULL;
    g_slist_free(files);
    return any;
}

void gui_accept_drops(struct gui *gui) {
    GtkDropTarget *drop = gtk_drop_target_new(GDK_TYPE_FILE_LIST, GDK_ACTION_COPY);
    g_signal_connect(drop, "drop", G_CALLBACK(handle_drop), gui);
    gtk_widget_add_controller(gui->window, GTK_EVENT_CONTROLLER(drop));
}

void gui_add_actions(struct gui *gui) {
    static const GActionEntry entries[] = {{.name = "add", .activate = show_add_list},
                                           {.name = "add-call", .parameter_type = "s", .activate = choose_call}};
    g_action_map_add_action_entries(G_ACTION_MAP(gui->window), entries, G_N_ELEMENTS(entries), gui);
}
