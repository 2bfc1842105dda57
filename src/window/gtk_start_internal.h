/* The page without a scene. */
#ifndef GRAY_WINDOW_GTK_START_INTERNAL_H
#define GRAY_WINDOW_GTK_START_INTERNAL_H

#include "window/gtk_internal.h"

GtkWidget *gui_start_new(struct gui *gui);

#endif
