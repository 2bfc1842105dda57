/* gray view: pictures of a light field or a panorama that is rendered, without its scene. */
#ifndef GRAY_OUTPUT_VIEW_H
#define GRAY_OUTPUT_VIEW_H

#include "session/options.h"

/* options->scripts is the file. Returns the exit status. */
int view_run(const struct options *options);

#endif
