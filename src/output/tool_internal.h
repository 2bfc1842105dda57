/* Programs that the supervisor starts: found on PATH, with arguments that scenes cannot choose, in a new folder. */
#ifndef GRAY_OUTPUT_TOOL_INTERNAL_H
#define GRAY_OUTPUT_TOOL_INTERNAL_H

#include "base/error.h"
#include "base/file_output.h"
#include "denoise/denoise.h"
#include "image/animation.h"
#include "session/options.h"

#include <stdbool.h>
#include <sys/types.h>

/* Writes .mp4 (H.264) or .webm (VP9). The program reads Y4M frames from a pipe and writes into a separate folder; the
 * file is then copied to the target. The same frames and the same ffmpeg give the same bytes. Errors, each in one line:
 * ffmpeg is not on PATH, it fails, the file cannot be written. */
bool encoder_write(const struct file_target *target, const struct animation_source *source,
                   enum animation_format format, struct error *error);

/* Passes colour, albedo and normal to the program as three PFM files in a new folder, waits for it, and reads its
 * picture into out[width * height]. Its arguments are fixed, it works in that folder, and its output is discarded.
 * Errors, each in one line: the program is not on PATH, it fails, its picture has another size, a file cannot be
 * written; it was interrupted. interrupt: or NULL. */
bool oidn_run(const struct denoise_source *source, const struct file_interrupt *interrupt, float (*out)[3],
              struct error *error);

#endif
