/* JSON by jansson, for glTF and for scenes. */
#ifndef GRAY_FORMATS_JSON_TEXT_H
#define GRAY_FORMATS_JSON_TEXT_H

#include "base/arena.h"
#include "base/error.h"

#include <stddef.h>

/* The version of the parser for --version: "jansson 2.14" or "none". */
const char *json_text_library(void);

#ifdef HAVE_JANSSON
#include <jansson.h>

/* What stands in the text, an object, which lives as long as the arena. NULL: an error that names the file and the
 * line. Names that stand twice in an object are an error if `strict` is set. */
json_t *json_text_parse(const char *path, const char *text, size_t size, bool strict, struct arena *arena,
                        struct error *error);
#endif

#endif
