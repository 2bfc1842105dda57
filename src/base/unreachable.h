/* What cannot happen, said where it would: UNREACHABLE("why") ends the process with the place and the reason, in every
 * build. For the end of a function whose switch has answered all kinds, and for what callers have made sure of; what a
 * script, a file or the machine can bring about is an error instead. Coverage does not count it (tools/coverage.py).
 */
#ifndef GRAY_BASE_UNREACHABLE_H
#define GRAY_BASE_UNREACHABLE_H

#include <stdio.h>
#include <stdlib.h>

#define UNREACHABLE(why)                                                                                               \
    ((void)fprintf(stderr, "gray: %s:%d: this cannot happen: %s\n", __FILE__, __LINE__, (why)), abort())

#endif
