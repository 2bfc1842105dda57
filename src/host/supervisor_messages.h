/* The answers of the supervisor to the render process. */
#ifndef GRAY_HOST_SUPERVISOR_MESSAGES_H
#define GRAY_HOST_SUPERVISOR_MESSAGES_H

#include "host/supervisor_internal.h"

void supervisor_handle_message(struct supervisor *supervisor, const struct message *message);
void supervisor_send_answer(struct supervisor *supervisor, enum message_kind kind, bool ok, bool already,
                            const struct error *error, int descriptor);
void supervisor_step_window(struct supervisor *supervisor);
/* The window without a picture. */
void supervisor_open_window(struct supervisor *supervisor);
/* The scripts are ended, to run again. */
void supervisor_restart(struct supervisor *supervisor);

#endif
