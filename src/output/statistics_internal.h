/* The statistics of a picture, as a table or as one JSON line. */
#ifndef GRAY_OUTPUT_STATISTICS_INTERNAL_H
#define GRAY_OUTPUT_STATISTICS_INTERNAL_H

#include "session/messages.h"

#include <stdio.h>

void statistics_print_text(FILE *stream, const char *name, const struct picture_request *request,
                           const struct picture_report *report);
void statistics_print_json(FILE *stream, const char *name, const struct picture_request *request,
                           const struct picture_report *report);

#endif
