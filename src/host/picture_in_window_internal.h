/* A picture in a window. */
#ifndef GRAY_HOST_PICTURE_IN_WINDOW_INTERNAL_H
#define GRAY_HOST_PICTURE_IN_WINDOW_INTERNAL_H

#include "host/render_process_internal.h"

/* Until it is finished there. False: the window was closed, or an error. */
bool picture_in_window(struct picture_work *work, double build_seconds, struct error *error);

#endif
