/* What stays from one run to the next. */
#ifndef GRAY_WINDOW_GTK_SETTINGS_INTERNAL_H
#define GRAY_WINDOW_GTK_SETTINGS_INTERNAL_H

#include "window/gtk_internal.h"

void gui_load_settings(struct gui *gui);
void gui_save_settings(struct gui *gui);

#endif
