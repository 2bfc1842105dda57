/* gray compare: by how much two pictures differ. */
#ifndef GRAY_OUTPUT_COMPARE_H
#define GRAY_OUTPUT_COMPARE_H

#include "session/options.h"

/* options->scripts are two pictures; -o: a picture of their difference. Returns the exit status: 0 if no pixel differs
 * by more than the threshold, 1 if one does, 2 if they cannot be compared. */
int compare_run(const struct options *options);

#endif
