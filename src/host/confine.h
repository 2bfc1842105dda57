/* Takes away from the process, before an untrusted scene runs, what it does not need: files outside the scene's folders
 * (Landlock), and system calls other than those of a program that computes (seccomp). Both stay for good and hold for
 * every thread made later. docs/security.md describes what is promised. */
#ifndef GRAY_HOST_CONFINE_H
#define GRAY_HOST_CONFINE_H

#include "base/error.h"
#include "session/options.h"

#include <stdbool.h>
#include <stddef.h>

/* Call while there is one thread. `keep` is a descriptor that stays open beside the standard streams. report: one line
 * on what is active; where Landlock or the filter is not, it begins with "gray: warning: " and the reason, and the part
 * before the semicolon is a warning for everyone (builds with sanitizers never have the filter and do not warn of it).
 * False: the folders of a scene cannot be listed, or what the kernel promised failed half-way. */
bool confine_process(const struct options *options, int keep, char *report, size_t size, struct error *error);
/* The same as on a kernel whose Landlock has at most that version; 0: none. */
bool confine_process_as(const struct options *options, int keep, long landlock_max, char *report, size_t size,
                        struct error *error);

#endif
