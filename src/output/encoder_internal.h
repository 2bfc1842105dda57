/* Video files by the program ffmpeg, found on PATH. */
#ifndef GRAY_OUTPUT_ENCODER_INTERNAL_H
#define GRAY_OUTPUT_ENCODER_INTERNAL_H

#include "base/file_output.h"
#include "image/animation.h"
#include "session/options.h"

#include <stdbool.h>

/* Writes .mp4 (H.264) or .webm (VP9). The program reads Y4M frames from a pipe and writes into a separate folder; the
 * file is then copied to the target. The same frames and the same ffmpeg give the same bytes. Errors, each in one line:
 * ffmpeg is not on PATH, it fails, the file cannot be written. */
bool encoder_write(const struct file_target *target, const struct animation_source *source,
                   enum animation_format format, struct error *error);

#endif
