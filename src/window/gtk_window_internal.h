/* What other widgets report to the viewer. */
#ifndef GRAY_WINDOW_GTK_WINDOW_INTERNAL_H
#define GRAY_WINDOW_GTK_WINDOW_INTERNAL_H

#include "window/gtk_internal.h"

/* The name for screen readers; gui_name also sets the tooltip. */
void gui_label(GtkWidget *widget, const char *name);
void gui_name(GtkWidget *widget, const char *name);
void gui_send_event(struct gui *gui, const struct window_event *event);
void gui_send_action(struct gui *gui, enum window_action action);
void gui_open_scene(struct gui *gui, GFile *file);
/* A menu under this title; it belongs to the bar. */
GMenu *gui_add_menu(GMenu *bar, const char *title);

#endif
