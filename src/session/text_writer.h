/* Text of any length on its way to people: gathered, and handed on in pieces. */
#ifndef GRAY_SESSION_TEXT_WRITER_H
#define GRAY_SESSION_TEXT_WRITER_H

#include "math/vec3.h"

#include <stddef.h>

struct sheet {
    void (*put)(void *context, const char *text); /* pieces of up to SHEET_PIECE bytes; `text` ends in NUL */
    void *context;
    size_t used;
    char text[8192];
};
enum { SHEET_PIECE = sizeof(((struct sheet *)0)->text) };

/* What is formatted at once is cut at 1,000 bytes; texts of scripts go through sheet_name or sheet_json. */
void sheet_print(struct sheet *sheet, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Control characters become '?'. */
void sheet_name(struct sheet *sheet, const char *text);
/* As a JSON string with its quotes; bytes that are no UTF-8 become U+FFFD. */
void sheet_json(struct sheet *sheet, const char *text);
/* 17 digits, so that the number is exactly this one; null for what JSON has no number for. */
void sheet_json_number(struct sheet *sheet, double number);
void sheet_json_vector(struct sheet *sheet, struct vec3 v); /* [x,y,z] */
void sheet_flush(struct sheet *sheet);

#endif
