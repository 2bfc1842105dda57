/* Removes rights of the process that it does not need, before an untrusted scene runs: files outside the scene's
 * folders (Landlock), and system calls that rendering does not need (seccomp). Both are permanent and apply to every
 * thread created later. docs/security.md describes the guarantees. */
#ifndef GRAY_HOST_CONFINE_H
#define GRAY_HOST_CONFINE_H

#include "base/error.h"
#include "session/options.h"

#include <stdbool.h>
#include <stddef.h>

/* Call while there is one thread. `keep` is a descriptor that remains open besides the standard streams. report: one
 * line about what is active; if Landlock or the filter is not active, it begins with "gray: warning: " and the reason,
 * and the part before the semicolon is a warning for everyone (builds with sanitizers never have the filter and do not
 * warn of it). False: the folders of a scene cannot be listed, or a step that the kernel supports has failed. */
bool confine_process(const struct options *options, int keep, char *report, size_t size, struct error *error);
/* The same as on a kernel whose Landlock has at most that version; 0: none. */
bool confine_process_as(const struct options *options, int keep, long landlock_max, char *report, size_t size,
                        struct error *error);
/* Closes all descriptors but the standard streams and `keep`, as both of these do. */
void confine_descriptors(int keep);
/* A process that reads no file at all; card: it serves one, and keeps what its driver has opened. */
bool confine_device(bool card, char *report, size_t size, struct error *error);

#endif
