/* Texts that come from scripts and file names, made safe for a terminal or for JSON: printed to a stream, or passed on
 * in pieces. */
#ifndef GRAY_SESSION_TEXT_H
#define GRAY_SESSION_TEXT_H

#include "base/error.h"
#include "math/vec3.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The text as one line and a newline; control characters other than tab become '?', line ends, those of the upper half
 * (U+0080 to U+009F) and the marks that change the direction of writing (U+202E and its like) too, so that a scene
 * cannot control the terminal. */
void text_print_line(FILE *stream, const char *text);
/* The same for a line whose beginning a scene or a file has chosen, such as the name of a picture: it is not shown as a
 * line of the program (base/terminal_text.h). */
void text_print_scene_line(FILE *stream, const char *text);
/* A message. On a terminal it has the word of its kind, in colour unless the environment forbids it. In an error, which
 * may have a traceback, line ends remain if the next line is indented by two blanks. */
enum text_kind { TEXT_ERROR, TEXT_WARNING, TEXT_NOTICE };
void text_print_message(FILE *stream, enum text_kind kind, const char *text);
/* The message of an error of gray; returns its kind, an exit status. */
int text_print_error(const struct error *error);
/* The text as a JSON string with its quotes; bytes that are no UTF-8 become U+FFFD, the characters above escapes. */
void text_print_json(FILE *stream, const char *text);

/* The beginning of such a text for a terminal: the bytes for the next *taken bytes of a text that has not ended, with
 * '?' for the same characters; returns how many. */
size_t text_clean_piece(const char *text, char piece[8], size_t *taken);
/* A text of our own with several lines, in the same way but with its line ends. */
void text_print(FILE *stream, const char *text);
/* Seconds in words: 40 s, 3 min 20 s, 2 h 5 min. */
void text_duration(double seconds, char *out, size_t size);

/* Whether standard error accepts text now: a pipe or a terminal whose reader has stopped does not. */
bool text_stderr_is_ready(void);

/* Text of any length: collected, and passed on in pieces. */
struct text_writer {
    void (*put)(void *context, const char *text); /* pieces of up to TEXT_WRITER_PIECE bytes; `text` ends in NUL */
    void *context;
    size_t used;
    char text[8192];
};
enum { TEXT_WRITER_PIECE = sizeof(((struct text_writer *)0)->text) };

/* A formatted text is cut at 1,000 bytes. */
void text_writer_print(struct text_writer *writer, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The same with conversions for words and JSON:
 *   %s  text of the program              %u %d  numbers of these types
 *   %n  text of a script: control        %g %v %c  a double, a struct vec3, a struct colour: (x, y, z), with 6 digits
 *       characters become '?'            %j %a %r  the same in JSON with 17 digits: exact; null for infinities and NaN
 *   %q  a JSON string with its quotes    %b     true or false
 *                                        %i     an int: so many blanks */
void text_writer_put(struct text_writer *writer, const char *format, ...);
void text_writer_flush(struct text_writer *writer);

#endif
