/* The picture, and its input. */
#ifndef GRAY_WINDOW_GTK_PICTURE_INTERNAL_H
#define GRAY_WINDOW_GTK_PICTURE_INTERNAL_H

#include "window/gtk_internal.h"

GtkWidget *gui_picture_new(struct gui *gui);
void gui_picture_attach(struct gui *gui, const struct window_order *order, int descriptor);
void gui_picture_draw(struct gui *gui);
void gui_picture_send_size(struct gui *gui);
/* Keys of the whole window that no focused widget has used. */
void gui_add_keys(struct gui *gui);

#endif
