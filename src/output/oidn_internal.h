/* Denoising by Intel's Open Image Denoise: the program oidnDenoise, found on PATH. */
#ifndef GRAY_OUTPUT_OIDN_INTERNAL_H
#define GRAY_OUTPUT_OIDN_INTERNAL_H

#include "base/error.h"
#include "base/file_output.h"
#include "denoise/denoise.h"

#include <stdbool.h>

/* Passes colour, albedo and normal to the program as three PFM files in a new folder, waits for it, and reads its
 * picture into out[width * height]. Its arguments are fixed, it works in that folder, and its output is discarded.
 * Errors, each in one line: the program is not on PATH, it fails, its picture has another size, a file cannot be
 * written; it was interrupted. interrupt: or NULL. */
bool oidn_run(const struct denoise_source *source, const struct file_interrupt *interrupt, float (*out)[3],
              struct error *error);

#endif
