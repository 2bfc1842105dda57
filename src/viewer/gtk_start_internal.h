/* The page without a scene. */
#ifndef GRAY_VIEWER_GTK_START_INTERNAL_H
#define GRAY_VIEWER_GTK_START_INTERNAL_H

#include "viewer/gtk_internal.h"

GtkWidget *gui_start_new(struct gui *gui);

#endif
