/* The window's own process. */
#ifndef GRAY_WINDOW_GTK_WINDOW_H
#define GRAY_WINDOW_GTK_WINDOW_H

#include "session/messages.h"

/* Opens the window and serves the channel to the viewer until that is closed. Returns the status of the process, which
 * must have no thread yet. */
int gtk_window_run(struct channel channel);

#endif
