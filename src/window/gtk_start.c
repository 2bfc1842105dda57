/* The page without a scene: files that were opened lately, and the demos, as cards. */
#include "window/gtk_start_internal.h"

#include "window/gtk_window_internal.h"

#include <string.h>

enum { RECENT_FILES = 8 };

static void open_card(GtkButton *button, gpointer data) {
    GFile *file = g_file_new_for_path(g_object_get_data(G_OBJECT(button), "path"));
    gui_open_scene(data, file);
    g_object_unref(file);
}

/* What the script says about itself in its first lines ("-- TITLE: ..."), or NULL. Owner: the caller. */
static char *title_of(const char *path) {
    char *text = NULL, *title = NULL;
    if (!g_file_get_contents(path, &text, NULL, NULL))
        return NULL;
    const char *found = strstr(text, "-- TITLE: ");
    if (found)
        title = g_strndup(found + 10, strcspn(found + 10, "\n"));
    g_free(text);
    return title;
}

static GtkWidget *make_card(struct gui *gui, const char *path) {
    GtkWidget *button = gtk_button_new(), *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 2);
    char *name = g_path_get_basename(path), *title = g_str_has_suffix(path, ".lua") ? title_of(path) : NULL;
    GtkWidget *heading = gtk_label_new(title ? title : name), *file = gtk_label_new(name);
    gtk_widget_add_css_class(heading, "heading");
    gtk_widget_add_css_class(file, "dim-label");
    gtk_label_set_wrap(GTK_LABEL(heading), TRUE);
    gtk_label_set_max_width_chars(GTK_LABEL(heading), 24);
    gtk_label_set_justify(GTK_LABEL(heading), GTK_JUSTIFY_CENTER);
    gtk_box_append(GTK_BOX(box), heading);
    gtk_box_append(GTK_BOX(box), file);
    gtk_widget_set_size_request(box, 180, 52);
    gtk_button_set_child(GTK_BUTTON(button), box);
    gtk_widget_set_tooltip_text(button, path);
    gtk_widget_add_css_class(button, "card");
    gui_label(button, title ? title : name);
    g_object_set_data_full(G_OBJECT(button), "path", g_strdup(path), g_free);
    g_signal_connect(button, "clicked", G_CALLBACK(open_card), gui);
    g_free(title);
    g_free(name);
    return button;
}

/* A heading and a box for cards. */
static GtkWidget *add_section(GtkWidget *page, const char *title) {
    GtkWidget *label = gtk_label_new(title), *cards = gtk_flow_box_new();
    gtk_label_set_xalign(GTK_LABEL(label), 0);
    gtk_widget_add_css_class(label, "title-4");
    gui_label(cards, title);
    gtk_flow_box_set_selection_mode(GTK_FLOW_BOX(cards), GTK_SELECTION_NONE);
    gtk_flow_box_set_max_children_per_line(GTK_FLOW_BOX(cards), 12);
    gtk_flow_box_set_homogeneous(GTK_FLOW_BOX(cards), TRUE);
    gtk_box_append(GTK_BOX(page), label);
    gtk_box_append(GTK_BOX(page), cards);
    return cards;
}

static bool add_recent(struct gui *gui, GtkWidget *cards) {
    GList *items = gtk_recent_manager_get_items(gtk_recent_manager_get_default());
    int count = 0;
    for (GList *at = items; at && count < RECENT_FILES; at = at->next) {
        char *path = g_filename_from_uri(gtk_recent_info_get_uri(at->data), NULL, NULL);
        if (path && gtk_recent_info_has_application(at->data, "gray") && g_file_test(path, G_FILE_TEST_IS_REGULAR)) {
            gtk_flow_box_append(GTK_FLOW_BOX(cards), make_card(gui, path));
            count++;
        }
        g_free(path);
    }
    g_list_free_full(items, (GDestroyNotify)gtk_recent_info_unref);
    return count > 0;
}

/* Beside the program as it is installed, or above it in the source tree. Owner: the caller; NULL: not found. */
static char *demo_folder(void) {
    static const char *const folders[] = {"../share/gray/data", "data", "../data", "../../data"};
    char *program = g_file_read_link("/proc/self/exe", NULL), *found = NULL;
    char *beside = program ? g_path_get_dirname(program) : g_strdup(".");
    for (size_t i = 0; i < G_N_ELEMENTS(folders) && !found; i++) {
        char *path = g_build_filename(beside, folders[i], NULL);
        if (g_file_test(path, G_FILE_TEST_IS_DIR))
            found = g_canonicalize_filename(path, NULL);
        g_free(path);
    }
    g_free(program);
    g_free(beside);
    return found;
}

static int compare_paths(gconstpointer a, gconstpointer b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static void add_demos(struct gui *gui, GtkWidget *cards, const char *folder, const char *sub) {
    char *path = g_build_filename(folder, sub, NULL);
    GDir *directory = g_dir_open(path, 0, NULL);
    GPtrArray *files = g_ptr_array_new_with_free_func(g_free);
    const char *name;
    while (directory && (name = g_dir_read_name(directory))) {
        if (g_str_has_suffix(name, sub[0] ? ".lua" : "demo.lua") && !g_str_has_prefix(name, "make_"))
            g_ptr_array_add(files, g_build_filename(path, name, NULL));
    }
    g_ptr_array_sort(files, compare_paths);
    for (guint i = 0; i < files->len; i++)
        gtk_flow_box_append(GTK_FLOW_BOX(cards), make_card(gui, files->pdata[i]));
    g_ptr_array_free(files, TRUE);
    if (directory)
        g_dir_close(directory);
    g_free(path);
}

GtkWidget *gui_start_new(struct gui *gui) {
    static const struct {
        const char *title, *folder;
    } sections[] = {{"Demos", ""}, {"Path tracing", "path"}, {"Animations", "animation"}, {"Solids", "csg"}};
    GtkWidget *scrolled = gtk_scrolled_window_new(), *page = gtk_box_new(GTK_ORIENTATION_VERTICAL, 12);
    char *folder = demo_folder();
    gtk_widget_set_margin_start(page, 24);
    gtk_widget_set_margin_end(page, 24);
    gtk_widget_set_margin_top(page, 18);
    gtk_widget_set_margin_bottom(page, 18);
    GtkWidget *hint = gtk_label_new("Open a scene or a model with Ctrl O, or drop it here");
    gtk_label_set_xalign(GTK_LABEL(hint), 0);
    gtk_box_append(GTK_BOX(page), hint);
    GtkWidget *recent = add_section(page, "Recent");
    if (!add_recent(gui, recent))
        gtk_flow_box_append(GTK_FLOW_BOX(recent), gtk_label_new("No files yet"));
    for (size_t i = 0; folder && i < G_N_ELEMENTS(sections); i++)
        add_demos(gui, add_section(page, sections[i].title), folder, sections[i].folder);
    g_free(folder);
    gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scrolled), page);
    return scrolled;
}
