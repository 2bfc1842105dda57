/* The window: menus, header, panels around the picture, and what comes from the viewer. Numbers and letters are those
 * of the C locale; only texts of GTK are translated. */
#define _GNU_SOURCE
#include "window/gtk_window.h"

#include "window/gtk_add_internal.h"
#include "window/gtk_form_internal.h"
#include "window/gtk_picture_internal.h"
#include "window/gtk_settings_internal.h"
#include "window/gtk_start_internal.h"
#include "window/gtk_tree_internal.h"
#include "window/gtk_window_internal.h"

#include <glib-unix.h>
#include <locale.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void gui_label(GtkWidget *widget, const char *name) {
    gtk_accessible_update_property(GTK_ACCESSIBLE(widget), GTK_ACCESSIBLE_PROPERTY_LABEL, name, -1);
    if (GTK_IS_DROP_DOWN(widget)) /* its button */
        gui_label(gtk_widget_get_first_child(widget), name);
}

void gui_name(GtkWidget *widget, const char *name) {
    gtk_widget_set_tooltip_text(widget, name);
    gui_label(widget, name);
}

/* To the viewer. */

/* Without a viewer there is nothing to show. */
static void end_process(struct gui *gui) {
    if (gui->window)
        gui_save_settings(gui);
    if (gui->window)
        gtk_window_destroy(GTK_WINDOW(gui->window));
    gui->window = NULL;
    g_application_quit(G_APPLICATION(gui->application));
}

void gui_send_event(struct gui *gui, const struct window_event *event) {
    if (!window_send_note(&gui->channel, NOTE_EVENT, event, ""))
        end_process(gui);
}

/* Ends the scene: opens the next one, or, if that is NULL, closes the window. */
static void leave_scene(struct gui *gui) {
    char *path = gui->next_scene ? g_file_get_path(gui->next_scene) : NULL;
    if (path)
        (void)window_send_note(&gui->channel, NOTE_OPEN_SCENE, NULL, path);
    else
        gui_send_event(gui, &(struct window_event){.kind = WINDOW_CLOSE});
    g_clear_object(&gui->next_scene);
    g_free(path);
}

static void answer_unsaved(GtkDialog *dialog, int answer, gpointer data) {
    struct gui *gui = data;
    gtk_window_destroy(GTK_WINDOW(dialog));
    if (answer == GTK_RESPONSE_ACCEPT)
        gui_send_action(gui, DO_SAVE_CHANGES);
    if (answer == GTK_RESPONSE_ACCEPT || answer == GTK_RESPONSE_REJECT)
        leave_scene(gui);
}

/* Not without a question if edits would be lost. */
static void ask_to_leave(struct gui *gui, GFile *next) {
    g_set_object(&gui->next_scene, next);
    if (!gui->state.unsaved) {
        leave_scene(gui);
        return;
    }
    GtkWidget *dialog = gtk_message_dialog_new(GTK_WINDOW(gui->window), GTK_DIALOG_MODAL, GTK_MESSAGE_QUESTION,
                                               GTK_BUTTONS_NONE, "There are edits that are not saved.");
    gtk_dialog_add_buttons(GTK_DIALOG(dialog), "_Discard", GTK_RESPONSE_REJECT, "_Cancel", GTK_RESPONSE_CANCEL, "_Save",
                           GTK_RESPONSE_ACCEPT, NULL);
    gtk_dialog_set_default_response(GTK_DIALOG(dialog), GTK_RESPONSE_ACCEPT);
    g_signal_connect(dialog, "response", G_CALLBACK(answer_unsaved), gui);
    gtk_window_present(GTK_WINDOW(dialog));
}

static void choose_model(struct gui *gui);

void gui_send_action(struct gui *gui, enum window_action action) {
    struct window_event event = {.kind = WINDOW_ACTION, .action = action, .x = gui->mouse_x, .y = gui->mouse_y};
    bool tool = action == DO_MOVE || action == DO_TURN || action == DO_SIZE;
    if (tool && (gui->state.action_on >> NEEDS_SELECTION & 1))
        gui->tool_begun = g_get_monotonic_time();
    if (action == DO_QUIT)
        ask_to_leave(gui, NULL);
    else if (action == DO_EXPORT_MODEL)
        choose_model(gui);
    else
        gui_send_event(gui, &event);
}

void gui_open_scene(struct gui *gui, GFile *file) {
    char *uri = g_file_get_uri(file);
    GtkRecentData recent = {.mime_type = "text/x-lua", .app_name = "gray", .app_exec = "gray -gui %f"};
    gtk_recent_manager_add_full(gtk_recent_manager_get_default(), uri, &recent);
    g_free(uri);
    ask_to_leave(gui, file);
}

/* Menus and actions. */

static void choose_action(GSimpleAction *action, GVariant *value, gpointer data) {
    const char *name = g_action_get_name(G_ACTION(action));
    (void)value;
    for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
        if (strcmp(window_action_table[i].name, name) == 0)
            gui_send_action(data, (enum window_action)i);
    }
}

/* It begins where gray was started. */
static void show_dialog(GtkFileChooserNative *dialog) {
    GFile *here = g_file_new_for_path(".");
    (void)gtk_file_chooser_set_current_folder(GTK_FILE_CHOOSER(dialog), here, NULL);
    g_object_unref(here);
    gtk_native_dialog_show(GTK_NATIVE_DIALOG(dialog));
}

static void finish_open(GtkNativeDialog *dialog, int answer, gpointer data) {
    if (answer == GTK_RESPONSE_ACCEPT) {
        GFile *file = gtk_file_chooser_get_file(GTK_FILE_CHOOSER(dialog));
        gui_open_scene(data, file);
        g_object_unref(file);
    }
    g_object_unref(dialog);
}

static void choose_scene(GSimpleAction *action, GVariant *value, gpointer data) {
    static const char *const suffixes[] = {"lua", "glb", "gltf", "obj", "ply", "stl", "lf"};
    struct gui *gui = data;
    GtkFileChooserNative *dialog = gtk_file_chooser_native_new("Open a Scene", GTK_WINDOW(gui->window),
                                                               GTK_FILE_CHOOSER_ACTION_OPEN, "_Open", "_Cancel");
    GtkFileFilter *filter = gtk_file_filter_new();
    (void)action, (void)value;
    gtk_file_filter_set_name(filter, "Scenes, models, light fields");
    for (size_t i = 0; i < G_N_ELEMENTS(suffixes); i++)
        gtk_file_filter_add_suffix(filter, suffixes[i]);
    gtk_file_chooser_add_filter(GTK_FILE_CHOOSER(dialog), filter);
    g_signal_connect(dialog, "response", G_CALLBACK(finish_open), gui);
    show_dialog(dialog);
}

/* A name for what is saved; the viewer replaces no file but models. */

static void finish_save(GtkNativeDialog *dialog, int answer, gpointer data) {
    struct gui *gui = data;
    struct window_event event = {.kind = WINDOW_ACTION, .x = gui->mouse_x, .y = gui->mouse_y};
    event.action = (enum window_action)GPOINTER_TO_INT(g_object_get_data(G_OBJECT(dialog), "action"));
    if (answer == GTK_RESPONSE_ACCEPT) {
        GFile *file = gtk_file_chooser_get_file(GTK_FILE_CHOOSER(dialog));
        char *path = g_file_get_path(file);
        if (path && g_strlcpy(event.text, path, sizeof event.text) < sizeof event.text)
            gui_send_event(gui, &event);
        g_free(path);
        g_object_unref(file);
    }
    g_object_unref(dialog);
}

static void ask_name(struct gui *gui, const char *title, const char *name, enum window_action action) {
    static const char *const models[] = {"stl", "3mf", "obj", "ply"};
    GtkFileChooserNative *dialog =
        gtk_file_chooser_native_new(title, GTK_WINDOW(gui->window), GTK_FILE_CHOOSER_ACTION_SAVE, "_Save", "_Cancel");
    gtk_file_chooser_set_current_name(GTK_FILE_CHOOSER(dialog), name);
    if (action == DO_EXPORT_MODEL) {
        GtkFileFilter *filter = gtk_file_filter_new();
        gtk_file_filter_set_name(filter, "Models: .stl, .3mf, .obj, .ply");
        for (size_t i = 0; i < G_N_ELEMENTS(models); i++)
            gtk_file_filter_add_suffix(filter, models[i]);
        gtk_file_chooser_add_filter(GTK_FILE_CHOOSER(dialog), filter);
    }
    g_object_set_data(G_OBJECT(dialog), "action", GINT_TO_POINTER(action));
    g_signal_connect(dialog, "response", G_CALLBACK(finish_save), gui);
    show_dialog(dialog);
}

static void choose_name(GSimpleAction *action, GVariant *value, gpointer data) {
    (void)value;
    if (strcmp(g_action_get_name(G_ACTION(action)), "save-picture-as") == 0)
        ask_name(data, "Save the Picture", "view.png", DO_SAVE_PICTURE);
    else
        ask_name(data, "Save the Edits", "changes.lua", DO_SAVE_CHANGES);
}

/* The kind of the file follows from its name. */
static void choose_model(struct gui *gui) {
    char *file = g_path_get_basename(gui->state.file), *dot = strrchr(file, '.');
    char *name = g_strdup_printf("%.*s.stl", (int)(dot ? dot - file : (gssize)strlen(file)), file);
    ask_name(gui, "Export a Model", name, DO_EXPORT_MODEL);
    g_free(name);
    g_free(file);
}

static void choose_dark(GSimpleAction *action, GVariant *value, gpointer data) {
    (void)data;
    g_simple_action_set_state(action, value);
    g_object_set(gtk_settings_get_default(), "gtk-application-prefer-dark-theme", g_variant_get_boolean(value), NULL);
}

static void make_menus(struct gui *gui);
static void make_key_list(struct gui *gui);

static void choose_keys(GSimpleAction *action, GVariant *value, gpointer data) {
    static const char *const sets[] = {WINDOW_KEY_SETS(LIST_WORD)};
    struct gui *gui = data;
    g_simple_action_set_state(action, value);
    for (int i = 0; i < WINDOW_KEY_SET_COUNT; i++) {
        if (strcmp(sets[i], g_variant_get_string(value, NULL)) == 0)
            gui->key_set = (enum window_key_set)i;
    }
    make_menus(gui);
    make_key_list(gui);
}

static void find_node(GSimpleAction *action, GVariant *value, gpointer data) {
    struct gui *gui = data;
    (void)action, (void)value;
    gtk_widget_grab_focus(gui->node_search);
}

static void show_keys(GSimpleAction *action, GVariant *value, gpointer data) {
    struct gui *gui = data;
    (void)action, (void)value;
    g_action_group_activate_action(G_ACTION_GROUP(gui->window), "show-help-overlay", NULL);
}

/* The first key of an action, or NULL. Owner: the caller. */
static char *first_key(const struct gui *gui, enum window_action action) {
    const char *keys = window_action_table[action].keys[gui->key_set];
    return keys[0] ? g_strndup(keys, strcspn(keys, " ")) : NULL;
}

static void add_item(GMenu *menu, const char *title, const char *action, const char *key) {
    GMenuItem *item = g_menu_item_new(title, action);
    if (key)
        g_menu_item_set_attribute(item, "accel", "s", key);
    g_menu_append_item(menu, item);
    g_object_unref(item);
}

GMenu *gui_add_menu(GMenu *bar, const char *title) {
    GMenu *menu = g_menu_new();
    g_menu_append_submenu(bar, title, G_MENU_MODEL(menu));
    g_object_unref(menu);
    return menu;
}

static void make_menus(struct gui *gui) {
    static const char *const titles[] = {WINDOW_MENUS(LIST_WORD)};
    GMenu *bar = g_menu_new(), *menus[G_N_ELEMENTS(titles)];
    for (size_t i = 0; i < G_N_ELEMENTS(titles); i++)
        menus[i] = gui_add_menu(bar, titles[i]);
    add_item(menus[MENU_FILE], "_Open…", "win.open", "<Control>o");
    add_item(menus[MENU_FILE], "Save Picture _As…", "win.save-picture-as", NULL);
    add_item(menus[MENU_FILE], "Save E_dits As…", "win.save-edits-as", NULL);
    for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
        char *name = g_strdup_printf("win.%s", window_action_table[i].name),
             *key = first_key(gui, (enum window_action)i);
        add_item(menus[window_action_table[i].menu], window_action_table[i].title, name, key);
        g_free(name);
        g_free(key);
    }
    add_item(menus[MENU_ADD], "_Search…", "win.add", "<Shift>a");
    gui_add_calls(menus[MENU_ADD]);
    add_item(menus[MENU_EDIT], "_Find a Node", "win.find", "<Control>f");
    add_item(menus[MENU_VIEW], "_Dark Theme", "win.dark", NULL);
    GMenu *help = gui_add_menu(bar, "_Help");
    add_item(help, "_Keys and Mouse", "win.keys-help", "F1");
    add_item(help, "Keys as in _Blender", "win.keys::Blender", NULL);
    add_item(help, "Keys as in _OpenSCAD", "win.keys::OpenSCAD", NULL);
    gtk_application_set_menubar(gui->application, G_MENU_MODEL(bar));
    g_object_unref(bar);
}

static void add_actions(struct gui *gui) {
    static const GActionEntry entries[] = {
        {.name = "open", .activate = choose_scene},
        {.name = "save-picture-as", .activate = choose_name},
        {.name = "save-edits-as", .activate = choose_name},
        {.name = "keys-help", .activate = show_keys},
        {.name = "find", .activate = find_node},
        {.name = "dark", .state = "false", .change_state = choose_dark},
        {.name = "keys", .parameter_type = "s", .state = "'Blender'", .change_state = choose_keys}};
    g_action_map_add_action_entries(G_ACTION_MAP(gui->window), entries, G_N_ELEMENTS(entries), gui);
    gui_add_actions(gui);
    for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
        GSimpleAction *action = g_simple_action_new(window_action_table[i].name, NULL);
        g_signal_connect(action, "activate", G_CALLBACK(choose_action), gui);
        g_simple_action_set_enabled(action, window_action_table[i].need == NEEDS_NOTHING);
        g_action_map_add_action(G_ACTION_MAP(gui->window), G_ACTION(action));
        g_object_unref(action);
    }
    gtk_application_set_accels_for_action(gui->application, "win.open", (const char *[]){"<Control>o", NULL});
    gtk_application_set_accels_for_action(gui->application, "win.find", (const char *[]){"<Control>f", NULL});
    gtk_application_set_accels_for_action(gui->application, "win.keys-help", (const char *[]){"F1", NULL});
}

/* The list of keys can be built from XML only, in GTK 4.8. */

static void add_key(GString *xml, const char *keys, const char *title) {
    char *key = g_markup_escape_text(keys, -1), *words = g_markup_escape_text(title, -1);
    g_string_append_printf(xml,
                           "<child><object class='GtkShortcutsShortcut'><property name='accelerator'>%s</property>"
                           "<property name='title'>%s</property></object></child>",
                           key, words);
    g_free(key);
    g_free(words);
}

static void begin_key_group(GString *xml, const char *title) {
    char **words = g_strsplit(title, "_", -1), *plain = g_strjoinv("", words);
    g_string_append_printf(xml, "<child><object class='GtkShortcutsGroup'><property name='title'>%s</property>", plain);
    g_strfreev(words);
    g_free(plain);
}

static void add_mouse(GString *xml) {
    static const char *const lines[][2] = {{"", "Click: select; with Ctrl: the operand of a combined solid"},
                                           {"", "Left, or middle button: orbit about what is there"},
                                           {"", "Shift and middle button: move sideways"},
                                           {"", "Right button: look about"},
                                           {"", "Wheel: towards the cursor; with Ctrl: angle of view"},
                                           {"Up Down Left Right", "Fly; Shift is fast, Ctrl slow"}};
    begin_key_group(xml, "Mouse");
    for (size_t i = 0; i < G_N_ELEMENTS(lines); i++)
        add_key(xml, lines[i][0], lines[i][1]);
    g_string_append(xml, "</object></child>");
}

static void make_key_list(struct gui *gui) {
    static const char *const titles[] = {WINDOW_MENUS(LIST_WORD)};
    GString *xml = g_string_new("<interface><object class='GtkShortcutsWindow' id='keys'><property name='modal'>1"
                                "</property><child><object class='GtkShortcutsSection'><property name='section-name'>"
                                "keys</property><property name='max-height'>14</property>");
    for (size_t menu = 0; menu < G_N_ELEMENTS(titles); menu++) {
        begin_key_group(xml, titles[menu]);
        for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
            const struct window_action_row *row = &window_action_table[i];
            char **words = g_strsplit(row->title, "_", -1), *title = g_strjoinv("", words);
            if (row->menu == (enum window_menu)menu && row->keys[gui->key_set][0])
                add_key(xml, row->keys[gui->key_set], title);
            g_strfreev(words);
            g_free(title);
        }
        g_string_append(xml, "</object></child>");
    }
    add_mouse(xml);
    g_string_append(xml, "</object></child></object></interface>");
    GtkBuilder *builder = gtk_builder_new_from_string(xml->str, -1);
    gtk_application_window_set_help_overlay(GTK_APPLICATION_WINDOW(gui->window),
                                            GTK_SHORTCUTS_WINDOW(gtk_builder_get_object(builder, "keys")));
    g_object_unref(builder);
    g_string_free(xml, TRUE);
}

/* Widgets. */

static GtkWidget *action_button(const struct gui *gui, const char *icon, const char *name, const char *tip) {
    GtkWidget *button = gtk_button_new_from_icon_name(icon);
    char *full = g_strdup_printf("win.%s", name);
    (void)gui;
    gui_name(button, tip);
    gtk_actionable_set_action_name(GTK_ACTIONABLE(button), full);
    gtk_widget_set_focus_on_click(button, FALSE);
    g_free(full);
    return button;
}

static void choose_integrator(GtkDropDown *choice, GParamSpec *property, gpointer data) {
    struct gui *gui = data;
    struct window_event event = {
        .kind = WINDOW_FIELD, .field = gui->state.integrator.number, .numbers[0] = gtk_drop_down_get_selected(choice)};
    (void)property;
    if (!gui->updates)
        gui_send_event(gui, &event);
}

static GtkWidget *make_header(struct gui *gui) {
    static const struct {
        const char *icon, *name, *tip;
    } buttons[] = {{"document-open-symbolic", "open", "Open a scene or a model (Ctrl O)"},
                   {"view-refresh-symbolic", "render", "Render again (F12)"},
                   {"process-stop-symbolic", "stop", "Stop; again: continue"},
                   {"edit-undo-symbolic", "undo", "Undo"},
                   {"edit-redo-symbolic", "redo", "Redo"},
                   {"document-save-symbolic", "save-changes", "Save the edits as a Lua file (Ctrl S)"}};
    GtkWidget *bar = gtk_header_bar_new();
    for (size_t i = 0; i < G_N_ELEMENTS(buttons); i++)
        gtk_header_bar_pack_start(GTK_HEADER_BAR(bar),
                                  action_button(gui, buttons[i].icon, buttons[i].name, buttons[i].tip));
    gui->integrator = gtk_drop_down_new_from_strings((const char *const[]){NULL});
    gui_name(gui->integrator, "Integrator");
    gtk_widget_set_visible(gui->integrator, FALSE);
    g_signal_connect(gui->integrator, "notify::selected", G_CALLBACK(choose_integrator), gui);
    gtk_header_bar_pack_start(GTK_HEADER_BAR(bar), gui->integrator);
    gtk_header_bar_pack_end(GTK_HEADER_BAR(bar),
                            action_button(gui, "help-browser-symbolic", "keys-help", "Keys and mouse (F1)"));
    return bar;
}

static void frame_moved(GtkRange *range, gpointer data) {
    struct gui *gui = data;
    struct window_event event = {.kind = WINDOW_FIELD, .field = WINDOW_FIELD_FRAME};
    event.numbers[0] = gtk_range_get_value(range);
    if (!gui->updates)
        gui_send_event(gui, &event);
}

static GtkWidget *make_timeline(struct gui *gui) {
    gui->timeline = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 8);
    gui->play_button = action_button(gui, "media-playback-start-symbolic", "play", "Play or pause");
    gui->frame_scale = gtk_scale_new_with_range(GTK_ORIENTATION_HORIZONTAL, 0, 1, 1);
    gui->frame_label = gtk_label_new("");
    gtk_widget_set_hexpand(gui->frame_scale, TRUE);
    gui_label(gui->frame_scale, "Frame");
    g_signal_connect(gui->frame_scale, "value-changed", G_CALLBACK(frame_moved), gui);
    gtk_box_append(GTK_BOX(gui->timeline), gui->play_button);
    gtk_box_append(GTK_BOX(gui->timeline),
                   action_button(gui, "media-playlist-repeat-symbolic", "loop", "Loop, or play once"));
    gtk_box_append(GTK_BOX(gui->timeline), gui->frame_scale);
    gtk_box_append(GTK_BOX(gui->timeline), gui->frame_label);
    gtk_widget_add_css_class(gui->timeline, "bar");
    gtk_widget_set_visible(gui->timeline, FALSE);
    return gui->timeline;
}

/* The file and line of a message "FILE:LINE: text"; NULL: it has none. Owner: the caller. */
static char *source_position(const char *message, int *line) {
    const char *text = g_str_has_prefix(message, "gray: ") ? message + 6 : message;
    for (const char *colon = strchr(text, ':'); colon; colon = strchr(colon + 1, ':')) {
        char *end;
        long number = strtol(colon + 1, &end, 10);
        if (end == colon + 1 || *end != ':' || number <= 0)
            continue;
        *line = (int)number;
        return g_strndup(text, (gsize)(colon - text));
    }
    return NULL;
}

/* In the editor of $VISUAL with the line, else in the desktop's editor. */
static void go_to_line(GtkButton *button, gpointer data) {
    struct gui *gui = data;
    int line = 0;
    char *path = source_position(gui->state.message, &line), *at = g_strdup_printf("+%d", line);
    const char *editor = g_getenv("VISUAL");
    (void)button;
    if (path && editor && editor[0]) {
        char *words[] = {(char *)(uintptr_t)editor, at, path, NULL};
        (void)g_spawn_async(NULL, words, NULL, G_SPAWN_SEARCH_PATH, NULL, NULL, NULL, NULL);
    } else if (path) {
        GFile *file = g_file_new_for_path(path);
        char *uri = g_file_get_uri(file);
        (void)g_app_info_launch_default_for_uri(uri, NULL, NULL);
        g_free(uri);
        g_object_unref(file);
    }
    g_free(path);
    g_free(at);
}

static GtkWidget *text_label(const char *text) {
    GtkWidget *label = gtk_label_new(text);
    gtk_label_set_wrap(GTK_LABEL(label), TRUE);
    gtk_label_set_selectable(GTK_LABEL(label), TRUE);
    gtk_label_set_xalign(GTK_LABEL(label), 0);
    gtk_widget_set_hexpand(label, TRUE);
    return label;
}

/* A bar below the picture with an icon, a text and buttons. */
static GtkWidget *make_bar(const char *icon, GtkWidget *text, GtkWidget *first, GtkWidget *second) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 8), *bar = gtk_revealer_new();
    GtkWidget *image = gtk_image_new_from_icon_name(icon);
    gui_label(image, second ? "Problem" : "Notice");
    gtk_box_append(GTK_BOX(box), image);
    gtk_box_append(GTK_BOX(box), text);
    gtk_box_append(GTK_BOX(box), first);
    if (second)
        gtk_box_append(GTK_BOX(box), second);
    gtk_widget_add_css_class(box, "bar");
    gtk_widget_add_css_class(box, second ? "problem" : "offer");
    gtk_revealer_set_child(GTK_REVEALER(bar), box);
    return bar;
}

static GtkWidget *render_button(void) {
    GtkWidget *button = gtk_button_new_with_label("Render Again");
    gtk_actionable_set_action_name(GTK_ACTIONABLE(button), "win.render");
    gtk_widget_set_valign(button, GTK_ALIGN_CENTER);
    return button;
}

static void make_bars(struct gui *gui, GtkWidget *box) {
    gui->error_text = text_label("");
    gui->error_line = gtk_button_new_with_label("Go to Line");
    gui->error_render = render_button();
    gtk_widget_set_valign(gui->error_line, GTK_ALIGN_CENTER);
    g_signal_connect(gui->error_line, "clicked", G_CALLBACK(go_to_line), gui);
    gui->error_bar = make_bar("dialog-error-symbolic", gui->error_text, gui->error_line, gui->error_render);
    gui->change_bar =
        make_bar("view-refresh-symbolic", text_label("A file of the scene has changed."), render_button(), NULL);
    gtk_box_append(GTK_BOX(box), gui->error_bar);
    gtk_box_append(GTK_BOX(box), gui->change_bar);
}

/* Over the picture while a script runs that has made none yet. */
static GtkWidget *make_busy(struct gui *gui) {
    GtkWidget *spinner = gtk_spinner_new(), *button = gtk_button_new_with_label("End the Script (Esc)");
    gui->busy = gtk_box_new(GTK_ORIENTATION_VERTICAL, 12);
    gui->busy_text = gtk_label_new("");
    gtk_widget_set_size_request(spinner, 32, 32);
    gtk_spinner_start(GTK_SPINNER(spinner));
    gtk_actionable_set_action_name(GTK_ACTIONABLE(button), "win.escape");
    gtk_box_append(GTK_BOX(gui->busy), spinner);
    gtk_box_append(GTK_BOX(gui->busy), gui->busy_text);
    gtk_box_append(GTK_BOX(gui->busy), button);
    gtk_widget_set_halign(gui->busy, GTK_ALIGN_CENTER);
    gtk_widget_set_valign(gui->busy, GTK_ALIGN_CENTER);
    gtk_widget_add_css_class(gui->busy, "busy");
    gtk_widget_set_visible(gui->busy, FALSE);
    return gui->busy;
}

static GtkWidget *make_bottom(struct gui *gui) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 0), *line = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 12);
    gui->progress = gtk_progress_bar_new();
    gui->figures = gtk_label_new("");
    gui->notice = gtk_label_new("");
    gtk_progress_bar_set_show_text(GTK_PROGRESS_BAR(gui->progress), TRUE);
    gtk_progress_bar_set_ellipsize(GTK_PROGRESS_BAR(gui->progress), PANGO_ELLIPSIZE_END);
    gtk_widget_set_size_request(gui->progress, 260, -1);
    gtk_widget_set_valign(gui->progress, GTK_ALIGN_CENTER);
    gtk_widget_set_visible(gui->progress, FALSE);
    gtk_label_set_ellipsize(GTK_LABEL(gui->figures), PANGO_ELLIPSIZE_END);
    gtk_label_set_ellipsize(GTK_LABEL(gui->notice), PANGO_ELLIPSIZE_MIDDLE);
    gtk_label_set_xalign(GTK_LABEL(gui->figures), 0);
    gtk_widget_set_hexpand(gui->figures, TRUE);
    gtk_widget_add_css_class(gui->figures, "dim-label");
    gtk_box_append(GTK_BOX(line), gui->progress);
    gtk_box_append(GTK_BOX(line), gui->figures);
    gtk_box_append(GTK_BOX(line), gui->notice);
    gtk_widget_add_css_class(line, "bar");
    gtk_box_append(GTK_BOX(box), make_timeline(gui));
    make_bars(gui, box);
    gtk_box_append(GTK_BOX(box), line);
    return box;
}

/* The trace of a pixel, below the picture. */
static GtkWidget *make_trace(struct gui *gui) {
    GtkWidget *view = gtk_text_view_new();
    gui->trace_box = gtk_scrolled_window_new();
    gui->trace_text = gtk_text_view_get_buffer(GTK_TEXT_VIEW(view));
    gtk_text_view_set_editable(GTK_TEXT_VIEW(view), FALSE);
    gtk_text_view_set_monospace(GTK_TEXT_VIEW(view), TRUE);
    gtk_text_view_set_left_margin(GTK_TEXT_VIEW(view), 8);
    gtk_text_view_set_top_margin(GTK_TEXT_VIEW(view), 6);
    gui_label(view, "How the pixel got its colour");
    gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(gui->trace_box), view);
    gtk_widget_set_size_request(gui->trace_box, -1, 180);
    gtk_widget_set_visible(gui->trace_box, FALSE);
    return gui->trace_box;
}

static GtkWidget *make_pane(GtkOrientation orientation, GtkWidget *start, GtkWidget *end, bool start_grows) {
    GtkWidget *pane = gtk_paned_new(orientation);
    gtk_paned_set_start_child(GTK_PANED(pane), start);
    gtk_paned_set_end_child(GTK_PANED(pane), end);
    gtk_paned_set_resize_start_child(GTK_PANED(pane), start_grows);
    gtk_paned_set_resize_end_child(GTK_PANED(pane), !start_grows);
    gtk_paned_set_shrink_start_child(GTK_PANED(pane), FALSE);
    gtk_paned_set_shrink_end_child(GTK_PANED(pane), FALSE);
    return pane;
}

static GtkWidget *make_body(struct gui *gui) {
    GtkWidget *overlay = gtk_overlay_new();
    gtk_overlay_set_child(GTK_OVERLAY(overlay), gui->picture);
    gtk_overlay_add_overlay(GTK_OVERLAY(overlay), make_busy(gui));
    gui->trace_pane = make_pane(GTK_ORIENTATION_VERTICAL, overlay, make_trace(gui), true);
    gui->tree_pane = make_pane(GTK_ORIENTATION_HORIZONTAL, gui_tree_new(gui), gui->trace_pane, false);
    gui->inspector_pane = make_pane(GTK_ORIENTATION_HORIZONTAL, gui->tree_pane, gui_inspector_new(gui), true);
    return gui->inspector_pane;
}

static gboolean ask_close(GtkWindow *window, gpointer data) {
    (void)window;
    ask_to_leave(data, NULL);
    return TRUE; /* the viewer ends this process */
}

static void make_window(struct gui *gui) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 0);
    GtkCssProvider *css = gtk_css_provider_new();
    gui->window = gtk_application_window_new(gui->application);

    gtk_window_set_title(GTK_WINDOW(gui->window), "gray");
    gtk_window_set_titlebar(GTK_WINDOW(gui->window), make_header(gui));
    add_actions(gui);
    make_menus(gui);
    make_key_list(gui);
    gtk_application_window_set_show_menubar(GTK_APPLICATION_WINDOW(gui->window), TRUE);
    gui->pages = gtk_stack_new();
    gui->picture = gui_picture_new(gui);
    gui->start = gui_start_new(gui);
    gtk_widget_set_vexpand(gui->pages, TRUE);
    gtk_stack_add_named(GTK_STACK(gui->pages), gui->start, "start");
    gtk_stack_add_named(GTK_STACK(gui->pages), make_body(gui), "scene");
    gtk_box_append(GTK_BOX(box), gui->pages);
    gtk_box_append(GTK_BOX(box), make_bottom(gui));
    gtk_window_set_child(GTK_WINDOW(gui->window), box);
    gtk_css_provider_load_from_data(css,
                                    ".bar { padding: 4px 8px; border-top: 1px solid @borders; }"
                                    ".problem { background: alpha(@error_color, 0.2); }"
                                    ".offer { background: alpha(@accent_color, 0.2); }"
                                    ".busy { padding: 18px; border-radius: 8px; background: @theme_bg_color; }"
                                    ".eye { padding: 0 4px; min-height: 18px; min-width: 18px; }"
                                    ".card { padding: 8px; }",
                                    -1);
    gtk_style_context_add_provider_for_display(gdk_display_get_default(), GTK_STYLE_PROVIDER(css),
                                               GTK_STYLE_PROVIDER_PRIORITY_APPLICATION);
    g_object_unref(css);
    g_signal_connect(gui->window, "close-request", G_CALLBACK(ask_close), gui);
    gui_accept_drops(gui);
    gui_add_keys(gui);
    gui_load_settings(gui);
}

/* From the viewer. */

static void enable_actions(struct gui *gui, uint32_t needs) {
    for (int i = 0; i < WINDOW_ACTION_COUNT; i++) {
        GAction *action = g_action_map_lookup_action(G_ACTION_MAP(gui->window), window_action_table[i].name);
        g_simple_action_set_enabled(G_SIMPLE_ACTION(action), (needs >> window_action_table[i].need & 1) != 0);
    }
}

static void show_timeline(struct gui *gui) {
    const struct window_state *state = &gui->state;
    gtk_widget_set_visible(gui->timeline, state->frame_count > 0);
    if (state->frame_count == 0)
        return;
    gui->updates = true;
    gtk_range_set_range(GTK_RANGE(gui->frame_scale), 0, MAX(1, state->frame_count - 1));
    gtk_range_set_value(GTK_RANGE(gui->frame_scale), state->frame_index);
    gui->updates = false;
    gtk_label_set_text(GTK_LABEL(gui->frame_label), state->frame);
    const char *icon = state->playing ? "media-playback-pause-symbolic" : "media-playback-start-symbolic";
    if (g_strcmp0(gtk_button_get_icon_name(GTK_BUTTON(gui->play_button)), icon) != 0)
        gtk_button_set_icon_name(GTK_BUTTON(gui->play_button), icon);
}

static void show_page(struct gui *gui) {
    gtk_stack_set_visible_child_name(GTK_STACK(gui->pages), gui->state.has_scene ? "scene" : "start");
    gtk_widget_set_visible(gui->progress, gui->state.has_scene);
    if (!gui->state.has_scene)
        return;
    gtk_widget_grab_focus(gui->picture);
    gui_picture_send_size(gui);
}

/* The choice in the header. */
static void show_integrator(struct gui *gui, const struct window_state *was) {
    const struct window_field *field = &gui->state.integrator;
    GtkDropDown *choice = GTK_DROP_DOWN(gui->integrator);
    gtk_widget_set_visible(gui->integrator, field->number != 0);
    gui->updates = true;
    if (strcmp(was->integrator.text, field->text) != 0) {
        char **words = g_strsplit(field->text, "|", -1);
        GtkStringList *list = gtk_string_list_new((const char *const *)words);
        gtk_drop_down_set_model(choice, G_LIST_MODEL(list));
        g_object_unref(list);
        g_strfreev(words);
    }
    if (field->number != 0)
        gtk_drop_down_set_selected(choice, (guint)field->numbers[0]);
    gui->updates = false;
}

static void show_state(struct gui *gui) {
    static struct window_state was; /* large */
    struct window_state *state = &gui->state;
    was = *state;
    window_shared_read(gui->memory.block, state);
    if (was.has_scene != state->has_scene)
        show_page(gui);
    gtk_widget_set_visible(gtk_paned_get_start_child(GTK_PANED(gui->tree_pane)), !state->lacks_nodes);
    if (was.action_on != state->action_on)
        enable_actions(gui, state->action_on | 1u << NEEDS_NOTHING);
    if (was.full_screen != state->full_screen)
        (state->full_screen ? gtk_window_fullscreen : gtk_window_unfullscreen)(GTK_WINDOW(gui->window));
    char *title = state->file[0] ? g_strdup_printf("%s%s - %s", state->file, state->unsaved ? "*" : "", state->state)
                                 : g_strdup("gray");
    gtk_window_set_title(GTK_WINDOW(gui->window), title);
    g_free(title);
    gtk_progress_bar_set_fraction(GTK_PROGRESS_BAR(gui->progress), CLAMP(state->share, 0, 1));
    gtk_progress_bar_set_text(GTK_PROGRESS_BAR(gui->progress), state->state);
    gtk_label_set_text(GTK_LABEL(gui->figures), state->figures);
    gtk_label_set_text(GTK_LABEL(gui->notice), state->types ? state->tool : state->notice);
    gtk_label_set_text(GTK_LABEL(gui->error_text), state->message);
    int line;
    char *source = source_position(state->message, &line);
    gtk_revealer_set_reveal_child(GTK_REVEALER(gui->error_bar), state->message[0] != '\0');
    gtk_widget_set_visible(gui->error_line, source != NULL);
    gtk_widget_set_visible(gui->error_render, state->waits);
    gtk_revealer_set_reveal_child(GTK_REVEALER(gui->change_bar), state->changed);
    gtk_widget_set_visible(gui->busy, state->runs);
    gtk_label_set_text(GTK_LABEL(gui->busy_text), state->state);
    show_integrator(gui, &was);
    g_free(source);
    show_timeline(gui);
    if (strcmp(was.trace, state->trace) != 0)
        gtk_text_buffer_set_text(gui->trace_text, state->trace, -1);
    gtk_widget_set_visible(gui->trace_box, state->trace[0] != '\0');
    gui_tree_show(gui, &was);
    gui_form_show(gui);
    gui_picture_draw(gui);
}

/* Until then no order to show comes, so that a viewer that has much to show leaves time for drawing. */
static const guint show_pause = 15; /* milliseconds */

static gboolean allow_show(gpointer data);

static void show_now(struct gui *gui) {
    gui->number = atomic_load(&((struct window_shared *)gui->memory.block)->number);
    show_state(gui);
    (void)g_timeout_add(show_pause, allow_show, gui);
}

static gboolean allow_show(gpointer data) {
    struct gui *gui = data;
    struct window_shared *shared = gui->memory.block;
    atomic_store(&shared->announced, 0);
    if (gui->window && atomic_load(&shared->number) != gui->number && atomic_exchange(&shared->announced, 1) == 0)
        show_now(gui);
    return G_SOURCE_REMOVE;
}

static void obey(struct gui *gui, const struct window_order *order, int descriptor) {
    struct error ignored;
    switch (order->kind) {
    case ORDER_STATE:
        if (!share_attach(&gui->memory, descriptor, sizeof(struct window_shared), &ignored))
            end_process(gui);
        return;
    case ORDER_PICTURE:
        gui_picture_attach(gui, order, descriptor);
        return;
    case ORDER_SHOW:
        if (gui->memory.block)
            show_now(gui);
        return;
    case ORDER_NODES:
        gui_tree_receive(gui, order);
        return;
    }
}

static gboolean receive(int descriptor, GIOCondition condition, gpointer data) {
    static struct message message; /* large */
    static struct window_order order;
    struct gui *gui = data;
    (void)descriptor, (void)condition;
    if (!gui->window)
        return G_SOURCE_REMOVE;
    if (channel_receive(&gui->channel, &message) != CHANNEL_MESSAGE || message.kind != MESSAGE_WINDOW) {
        end_process(gui);
        return G_SOURCE_REMOVE;
    }
    memset(&order, 0, sizeof order);
    memcpy(&order, message.body.bytes, MIN(message.size, sizeof order));
    obey(gui, &order, message.descriptor);
    return G_SOURCE_CONTINUE;
}

static void activate(GtkApplication *application, gpointer data) {
    struct gui *gui = data;
    (void)application;
    make_window(gui);
    gtk_window_present(GTK_WINDOW(gui->window));
    (void)g_unix_fd_add(gui->channel.descriptor, G_IO_IN | G_IO_HUP, receive, gui);
}

/* GL by software is slower than Cairo. */
static void choose_renderer(void) {
    GError *error = NULL;
    GdkGLContext *context = gdk_display_create_gl_context(gdk_display_get_default(), &error);
    if (context)
        g_object_unref(context);
    else
        (void)g_setenv("GSK_RENDERER", "cairo", FALSE);
    g_clear_error(&error);
}

/* Without one, GTK gives its widgets sizes without sense. */
static bool has_font(void) {
    PangoFontMap *map = pango_cairo_font_map_get_default();
    PangoContext *context = pango_font_map_create_context(map);
    PangoFontDescription *any = pango_font_description_from_string("Sans 10");
    PangoFont *font = pango_font_map_load_font(map, context, any);
    bool has = font != NULL;
    g_clear_object(&font);
    pango_font_description_free(any);
    g_object_unref(context);
    return has;
}

int gtk_window_run(struct channel channel) {
    static struct gui gui;
    sigset_t none;
    gui = (struct gui){.channel = channel, .mouse_x = 0};
    (void)sigemptyset(&none);
    (void)sigprocmask(SIG_SETMASK, &none, NULL);
    (void)signal(SIGINT, SIG_IGN); /* the viewer ends this process */
    gtk_disable_setlocale();
    (void)setlocale(LC_MESSAGES, "");
    (void)setlocale(LC_CTYPE, "C.UTF-8");
    if (!g_getenv("DBUS_SESSION_BUS_ADDRESS"))
        (void)g_setenv("GSETTINGS_BACKEND", "memory", FALSE); /* choices of colours are not kept */
    (void)g_setenv("GTK_A11Y", g_getenv("DBUS_SESSION_BUS_ADDRESS") ? "atspi" : "none", FALSE);
    if (!gtk_init_check()) {
        (void)window_send_note(&gui.channel, NOTE_FAILED, NULL, "there is no display (DISPLAY or WAYLAND_DISPLAY)");
        return 1;
    }
    if (!has_font()) {
        (void)window_send_note(&gui.channel, NOTE_FAILED, NULL, "fontconfig finds no font (Debian: fonts-dejavu-core)");
        return 1;
    }
    choose_renderer();
    if (!window_send_note(&gui.channel, NOTE_READY, NULL, ""))
        return 1;
    gui.application = gtk_application_new("org.gray.Window", G_APPLICATION_NON_UNIQUE);
    g_signal_connect(gui.application, "activate", G_CALLBACK(activate), &gui);
    int status = g_application_run(G_APPLICATION(gui.application), 0, NULL);
    g_object_unref(gui.application);
    return status;
}
