/* Adding to the scene. */
#ifndef GRAY_WINDOW_GTK_ADD_INTERNAL_H
#define GRAY_WINDOW_GTK_ADD_INTERNAL_H

#include "window/gtk_internal.h"

/* The actions win.add, which shows the list, and win.add-call; and a menu for each group. */
void gui_add_actions(struct gui *gui);
void gui_add_calls(GMenu *menu);
/* Files that are dropped on the window: a picture becomes a texture of what is there, or of the selection; a sky lights
 * the scene and is its background; anything else is opened. */
void gui_accept_drops(struct gui *gui);

#endif
