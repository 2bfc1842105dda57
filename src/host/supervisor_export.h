/* The model that the window writes: what `gray SCRIPT -o MODEL` writes with the edits, by a process like that one. */
#ifndef GRAY_HOST_SUPERVISOR_EXPORT_H
#define GRAY_HOST_SUPERVISOR_EXPORT_H

#include "host/supervisor_internal.h"

/* Starts it for the picture in the window; the name is that of the viewer. */
void supervisor_begin_export(struct supervisor *supervisor);
/* Shows how it goes on, and how it has ended. */
void supervisor_show_export(struct supervisor *supervisor);
/* Stops it: an older file stays. */
void supervisor_stop_export(struct supervisor *supervisor);

#endif
