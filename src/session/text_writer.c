/* A piece is handed on when the next word does not fit. */
#include "session/text_writer.h"

#include "session/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void text_writer_flush(struct text_writer *writer) {
    if (writer->used == 0)
        return;
    writer->text[writer->used] = '\0';
    writer->put(writer->context, writer->text);
    writer->used = 0;
}

static void add(struct text_writer *writer, const char *bytes, size_t size) {
    if (writer->used + size >= sizeof writer->text)
        text_writer_flush(writer);
    memcpy(writer->text + writer->used, bytes, size);
    writer->used += size;
}

void text_writer_print(struct text_writer *writer, const char *format, ...) {
    char text[1000];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length > 0)
        add(writer, text, (size_t)length < sizeof text ? (size_t)length : sizeof text - 1);
}

void text_writer_name(struct text_writer *writer, const char *text) {
    char piece[8];
    for (size_t taken; *text; text += taken) {
        size_t size = text_clean_piece(text, piece, &taken);
        add(writer, piece, size);
    }
}

void text_writer_json(struct text_writer *writer, const char *text) {
    char piece[8];
    add(writer, "\"", 1);
    for (const char *at = text; *at;) {
        size_t taken, size = text_json_piece(at, piece, &taken);
        add(writer, piece, size);
        at += taken;
    }
    add(writer, "\"", 1);
}

void text_writer_json_number(struct text_writer *writer, double number) {
    if (isfinite(number))
        text_writer_print(writer, "%.17g", number);
    else
        text_writer_print(writer, "null");
}

void text_writer_json_vector(struct text_writer *writer, struct vec3 v) {
    for (int i = 0; i < 3; i++) {
        text_writer_print(writer, i > 0 ? "," : "[");
        text_writer_json_number(writer, vec3_get(v, i));
    }
    text_writer_print(writer, "]");
}
