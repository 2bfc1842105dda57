/* The file of a solution of radiosity: the bytes that the render process made of it (radiosity_write), with a digest of
 * what it depends on. A checksum detects accidents; the render process checks what the bytes say. */
#ifndef GRAY_OUTPUT_SOLUTION_FILE_INTERNAL_H
#define GRAY_OUTPUT_SOLUTION_FILE_INTERNAL_H

#include "base/file_output.h"
#include "base/share.h"

/* Whether a file begins so. */
bool solution_file_is(const uint8_t *head, size_t size);
/* Its bytes, if it has that digest; else *out is empty. Errors: it is another file, damaged, or larger than `limit`. */
bool solution_file_read(const char *path, struct digest depends, uint64_t limit, struct share *out,
                        struct error *error);
bool solution_file_write(const struct file_target *target, struct digest depends, const struct share *bytes,
                         struct error *error);

#endif
