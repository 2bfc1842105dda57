/* Texts that come from scripts and file names, made fit for a terminal or for JSON. */
#ifndef GRAY_APP_TEXT_H
#define GRAY_APP_TEXT_H

#include <stdio.h>

/* The text as one line and a newline; control characters other than tab become '?', line ends and those of the upper
 * half (U+0080 to U+009F) too, so that a scene can neither steer the terminal nor speak in the name of the program. */
void text_print_line(FILE *stream, const char *text);
/* The same of an error with its traceback: line ends stay where the next line is indented by two blanks. */
void text_print_lines(FILE *stream, const char *text);
/* The text as a JSON string with its quotes; bytes that are no UTF-8 become U+FFFD. */
void text_print_json(FILE *stream, const char *text);

#endif
