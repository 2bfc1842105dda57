/* Texts that come from scripts and file names, made fit for a terminal or for JSON. */
#ifndef GRAY_APP_TEXT_H
#define GRAY_APP_TEXT_H

#include <stdio.h>

/* The text and a newline; control characters other than newline and tab become '?', so that a scene cannot steer the
 * terminal. */
void text_print_line(FILE *stream, const char *text);
/* The text as a JSON string with its quotes; bytes that are no UTF-8 become U+FFFD. */
void text_print_json(FILE *stream, const char *text);

#endif
