/* Texts that come from scripts and file names, made fit for a terminal or for JSON. */
#ifndef GRAY_SESSION_TEXT_H
#define GRAY_SESSION_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The text as one line and a newline; control characters other than tab become '?', line ends, those of the upper half
 * (U+0080 to U+009F) and the marks that turn the direction of writing (U+202E and its like) too, so that a scene cannot
 * steer the terminal. */
void text_print_line(FILE *stream, const char *text);
/* The same of a line whose beginning a scene or a file has chosen, such as the name of a picture: it is not shown as a
 * line of the program (base/terminal_text.h). */
void text_print_scene_line(FILE *stream, const char *text);
/* The same of an error with its traceback: line ends stay where the next line is indented by two blanks. */
void text_print_lines(FILE *stream, const char *text);
/* The text as a JSON string with its quotes; bytes that are no UTF-8 become U+FFFD, the characters above escapes. */
void text_print_json(FILE *stream, const char *text);

/* The beginning of such a string: the bytes for the next *taken bytes of a text that has not ended; returns how many.
 */
size_t text_json_piece(const char *text, char piece[8], size_t *taken);
/* The same for a terminal: '?' for the same characters. */
size_t text_clean_piece(const char *text, char piece[8], size_t *taken);
/* A text of several lines of our own, cleaned like that but for its line ends. */
void text_print(FILE *stream, const char *text);
/* Seconds as people say them: 40 s, 3 min 20 s, 2 h 5 min. */
void text_duration(double seconds, char *out, size_t size);

/* Whether standard error takes text now: a pipe or a terminal whose reader has stopped does not. */
bool text_stderr_is_ready(void);

#endif
