/* The signals that the supervisor gets. */
#ifndef GRAY_HOST_SUPERVISOR_SIGNALS_H
#define GRAY_HOST_SUPERVISOR_SIGNALS_H

#include "host/supervisor_internal.h"

bool supervisor_listen(struct supervisor *supervisor, struct error *error);
void supervisor_read_signals(struct supervisor *supervisor);
/* Ends everything: requests the child to stop, and kills it soon after; a second call kills it at once. */
void supervisor_interrupt(struct supervisor *supervisor);
/* While a picture waits for the reader of a pipe; context: the supervisor. */
bool supervisor_is_stopped(void *context);
/* Until standard error takes text; false: it does not, and the run is to end. context: the supervisor. */
bool supervisor_wait_for_reader(void *context);

#endif
