/* The life of the render process. */
#ifndef GRAY_HOST_SUPERVISOR_CHILD_H
#define GRAY_HOST_SUPERVISOR_CHILD_H

#include "host/supervisor_internal.h"

/* In a process that was forked: forgets what only the supervisor uses. */
void supervisor_leave(struct supervisor *supervisor);
/* The same in one that ends with this process and leaves its signals to it. */
void supervisor_begin_child(struct supervisor *supervisor, pid_t parent);
bool supervisor_start_child(struct supervisor *supervisor, struct error *error);
/* Its status as of waitpid, when it is gone. */
int supervisor_reap_child(struct supervisor *supervisor);
/* What the end of the child means for the scripts that are left. */
void supervisor_judge_end(struct supervisor *supervisor, int how);
/* The picture that is open, if any, will not be finished. */
void supervisor_abandon_picture(struct supervisor *supervisor);
void supervisor_stop_script_clock(struct supervisor *supervisor);
void supervisor_start_script_clock(struct supervisor *supervisor);
/* Milliseconds until the script could have used up its time; -1: no limit; 0: it has. */
int supervisor_script_patience(const struct supervisor *supervisor);
/* Whether the child of a farm has hung for too long. */
bool supervisor_child_is_stalled(struct supervisor *supervisor);

#endif
