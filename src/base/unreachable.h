/* Marks impossible cases: UNREACHABLE("why") ends the process with the position and the reason, in every build. For the
 * end of a function whose switch has handled all kinds, and for preconditions that callers guarantee; anything that a
 * script, a file or the machine can cause is an error instead. Coverage does not count it (tools/coverage.py). */
#ifndef GRAY_BASE_UNREACHABLE_H
#define GRAY_BASE_UNREACHABLE_H

#include <stdio.h>
#include <stdlib.h>

#define UNREACHABLE(why)                                                                                               \
    ((void)fprintf(stderr, "gray: %s:%d: this cannot happen: %s\n", __FILE__, __LINE__, (why)), abort())

#endif
