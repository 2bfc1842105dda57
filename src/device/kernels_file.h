/* The kernels that `make gpu` writes beside the program: a line with the digest of their sources, then PTX. */
#ifndef GRAY_DEVICE_KERNELS_FILE_H
#define GRAY_DEVICE_KERNELS_FILE_H

#include "base/error.h"

/* The kernels of the file, with a zero at the end. Owner: the caller, mem_free. Errors: no such file; other sources.
 * NULL. */
char *kernels_file_read(const char *name, struct error *error);

#endif
