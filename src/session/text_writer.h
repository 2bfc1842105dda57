/* Text of any length on its way to people: gathered, and handed on in pieces. */
#ifndef GRAY_SESSION_TEXT_WRITER_H
#define GRAY_SESSION_TEXT_WRITER_H

#include "math/vec3.h"

#include <stddef.h>

struct text_writer {
    void (*put)(void *context, const char *text); /* pieces of up to TEXT_WRITER_PIECE bytes; `text` ends in NUL */
    void *context;
    size_t used;
    char text[8192];
};
enum { TEXT_WRITER_PIECE = sizeof(((struct text_writer *)0)->text) };

/* What is formatted at once is cut at 1,000 bytes; texts of scripts go through text_writer_name or text_writer_json. */
void text_writer_print(struct text_writer *writer, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Control characters become '?'. */
void text_writer_name(struct text_writer *writer, const char *text);
/* As a JSON string with its quotes; bytes that are no UTF-8 become U+FFFD. */
void text_writer_json(struct text_writer *writer, const char *text);
/* 17 digits, so that the number is exactly this one; null for what JSON has no number for. */
void text_writer_json_number(struct text_writer *writer, double number);
void text_writer_json_vector(struct text_writer *writer, struct vec3 v); /* [x,y,z] */
void text_writer_flush(struct text_writer *writer);

#endif
