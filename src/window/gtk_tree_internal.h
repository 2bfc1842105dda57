/* The tree of nodes. */
#ifndef GRAY_WINDOW_GTK_TREE_INTERNAL_H
#define GRAY_WINDOW_GTK_TREE_INTERNAL_H

#include "window/gtk_internal.h"

GtkWidget *gui_tree_new(struct gui *gui);
void gui_tree_show(struct gui *gui, const struct window_state *was);      /* what is selected and hidden */
void gui_tree_receive(struct gui *gui, const struct window_order *order); /* of ORDER_NODES */

#endif
