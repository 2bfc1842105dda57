/* The kernels that `make gpu` writes beside the program: a line with the digest of their sources, then of each kernel a
 * line with its name and its bytes, and a module of its own as the driver takes it. */
#ifndef GRAY_DEVICE_KERNELS_FILE_H
#define GRAY_DEVICE_KERNELS_FILE_H

#include "base/file.h"

/* Owner: the caller, file_unmap. Errors: no such file; other sources. */
bool kernels_file_open(const char *name, struct file_bytes *kernels, struct error *error);
/* The module of a kernel; NULL: the file has none, or a part of it. */
const void *kernels_file_find(const struct file_bytes *kernels, const char *kernel);

#endif
