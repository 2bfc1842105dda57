/* gray merge: merges the parts that --shard wrote and writes the pictures. */
#ifndef GRAY_OUTPUT_MERGE_H
#define GRAY_OUTPUT_MERGE_H

#include "session/options.h"

/* options->scripts are the parts, in any order, of one picture or of several. Returns the exit status: 1 when parts are
 * missing, damaged or do not belong together; then the picture they are of is not written. */
int merge_run(const struct options *options);

#endif
