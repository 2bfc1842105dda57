/* Adding to the scene. */
#ifndef GRAY_WINDOW_GTK_ADD_INTERNAL_H
#define GRAY_WINDOW_GTK_ADD_INTERNAL_H

#include "window/gtk_internal.h"

/* The actions win.add, which shows the list, and win.add-call; and a menu for each group. */
void gui_add_actions(struct gui *gui);
void gui_add_calls(GMenu *menu);

#endif
