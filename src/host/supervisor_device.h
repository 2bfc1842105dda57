/* The life of the device process: one for each picture that asks for it. */
#ifndef GRAY_HOST_SUPERVISOR_DEVICE_H
#define GRAY_HOST_SUPERVISOR_DEVICE_H

#include "host/supervisor_internal.h"

/* Answers MESSAGE_DEVICE. */
void supervisor_answer_device(struct supervisor *supervisor, const struct device_request *request);
/* Notices when the process is gone before its time: one warning; the threads of the child go on. */
void supervisor_watch_device(struct supervisor *supervisor);
/* Until now; zero if there is no device process. */
struct device_statistics supervisor_device_statistics(const struct supervisor *supervisor);
/* The picture is over. */
void supervisor_end_device(struct supervisor *supervisor);

#endif
