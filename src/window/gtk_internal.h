/* The process of the window: GTK 4.8. It holds widgets only; what they show comes as orders of the viewer, and what the
 * user does goes there as notes (window_channel.h). gtk_window.c has the window and its menus, gtk_picture.c the
 * picture and its input, gtk_form.c the inspector, gtk_tree.c the tree of nodes, gtk_start.c the page without a scene.
 */
#ifndef GRAY_WINDOW_GTK_INTERNAL_H
#define GRAY_WINDOW_GTK_INTERNAL_H

#define GDK_VERSION_MIN_REQUIRED GDK_VERSION_4_8
#define GDK_VERSION_MAX_ALLOWED GDK_VERSION_4_8

#include "window/window_channel.h"

#include <gtk/gtk.h>

/* The picture: a texture for each tile, so that only those that have changed are drawn again. */
struct picture_tiles {
    struct window_picture shared;
    GdkTexture **textures; /* NULL: not made yet */
    uint32_t *seen;        /* the number of each tile when its texture was made */
    uint32_t count;
    uint32_t width, height; /* of the picture as its textures show it: at most its own */
};

/* The widgets of a field of the form. */
struct form_row {
    struct window_field field;
    GtkWidget *inputs[3], *reset;
};

struct gui {
    struct channel channel;
    GtkApplication *application;
    GtkWidget *window, *pages, *picture, *start, *inspector, *inspector_title;
    GtkWidget *progress, *figures, *notice, *timeline, *frame_scale, *frame_label, *play_button;
    GtkWidget *error_bar, *error_text, *error_line, *error_render, *change_bar, *busy, *busy_text, *integrator;
    GtkWidget *tree_pane, *inspector_pane, *trace_pane;
    GtkWidget *trace, *trace_box;
    GtkTextBuffer *trace_text;
    GtkSingleSelection *node_selection; /* its model is the tree */
    GPtrArray *open_nodes;              /* the lists of children; not owned */
    GPtrArray *node_items;              /* the rows on the screen; not owned */
    GtkWidget *node_list, *node_search, *found, *tree_pages;
    struct node_query revealed; /* the node to which the tree is to be opened; depth 0: none */
    struct picture_tiles tiles;
    struct share memory;       /* of the shared state ... */
    struct window_state state; /* ... and what it was last, ... */
    uint32_t number;           /* ... with this number */
    double mouse_x, mouse_y;   /* in those of the picture's widget, times the scale */
    GFile *next_scene;         /* the scene to open if the user agrees to lose the edits; else NULL */

    enum window_key_set key_set;
    gint64 tool_begun; /* when a tool was chosen: what is typed at once is for it */
    bool takes_found;  /* the first node that is found will be selected */
    bool updates;      /* widgets are set by the program, not by the user */
    struct form_row rows[FORM_FIELDS];
    uint32_t row_count;
    uint64_t form_subject;
    uint32_t last_field; /* that was changed, and when: the next change of it may be part of the same edit */
    gint64 last_change;
};

#endif
