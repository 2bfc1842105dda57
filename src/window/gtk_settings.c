/* A file of the user's folder of settings keeps the sizes of the window and its panels, the keys and the theme. */
#include "window/gtk_settings_internal.h"

static char *settings_path(void) {
    return g_build_filename(g_get_user_config_dir(), "gray", "window.ini", NULL);
}

static int kept_number(GKeyFile *file, const char *name, int otherwise) {
    GError *error = NULL;
    int number = g_key_file_get_integer(file, "window", name, &error);
    bool ok = !error && number > 0 && number < 32768;
    g_clear_error(&error);
    return ok ? number : otherwise;
}

void gui_load_settings(struct gui *gui) {
    GKeyFile *file = g_key_file_new();
    char *path = settings_path(), *keys;
    (void)g_key_file_load_from_file(file, path, G_KEY_FILE_NONE, NULL);
    int width = kept_number(file, "width", 1280), inspector = kept_number(file, "inspector", 330);
    gtk_window_set_default_size(GTK_WINDOW(gui->window), width, kept_number(file, "height", 800));
    gtk_paned_set_position(GTK_PANED(gui->tree_pane), kept_number(file, "tree", 200));
    gtk_paned_set_position(GTK_PANED(gui->inspector_pane), MAX(width - inspector, 300));
    gtk_paned_set_position(GTK_PANED(gui->trace_pane), kept_number(file, "trace", 400));
    keys = g_key_file_get_string(file, "window", "keys", NULL);
    if (g_strcmp0(keys, "OpenSCAD") == 0)
        g_action_group_change_action_state(G_ACTION_GROUP(gui->window), "keys", g_variant_new_string(keys));
    if (g_key_file_get_boolean(file, "window", "dark", NULL))
        g_action_group_change_action_state(G_ACTION_GROUP(gui->window), "dark", g_variant_new_boolean(TRUE));
    g_free(keys);
    g_free(path);
    g_key_file_free(file);
}

void gui_save_settings(struct gui *gui) {
    static const char *const sets[] = {WINDOW_KEY_SETS(LIST_WORD)};
    GKeyFile *file = g_key_file_new();
    char *path = settings_path(), *folder = g_path_get_dirname(path);
    int width, height;
    gboolean dark;
    gtk_window_get_default_size(GTK_WINDOW(gui->window), &width, &height);
    g_object_get(gtk_settings_get_default(), "gtk-application-prefer-dark-theme", &dark, NULL);
    g_key_file_set_integer(file, "window", "width", width);
    g_key_file_set_integer(file, "window", "height", height);
    g_key_file_set_integer(file, "window", "tree", gtk_paned_get_position(GTK_PANED(gui->tree_pane)));
    g_key_file_set_integer(file, "window", "inspector", width - gtk_paned_get_position(GTK_PANED(gui->inspector_pane)));
    g_key_file_set_integer(file, "window", "trace", gtk_paned_get_position(GTK_PANED(gui->trace_pane)));
    g_key_file_set_string(file, "window", "keys", sets[gui->key_set]);
    g_key_file_set_boolean(file, "window", "dark", dark);
    if (g_mkdir_with_parents(folder, 0700) == 0)
        (void)g_key_file_save_to_file(file, path, NULL);
    g_free(folder);
    g_free(path);
    g_key_file_free(file);
}
