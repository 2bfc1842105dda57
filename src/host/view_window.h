/* gray view in a window: a light field is seen from where the mouse drags the eye, a panorama is turned. */
#ifndef GRAY_HOST_VIEW_WINDOW_H
#define GRAY_HOST_VIEW_WINDOW_H

#include "session/options.h"
#include "window/window.h"

/* options->scripts is the file, and the options say how it is seen first. Returns the exit status when the window is
 * closed or another file is opened in it. */
int view_window_run(const struct options *options, const struct window_driver *driver);

#endif
