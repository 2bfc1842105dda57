/* A piece is handed on when the next word does not fit. */
#include "session/text_writer.h"

#include "session/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void sheet_flush(struct sheet *sheet) {
    if (sheet->used == 0)
        return;
    sheet->text[sheet->used] = '\0';
    sheet->put(sheet->context, sheet->text);
    sheet->used = 0;
}

static void add(struct sheet *sheet, const char *bytes, size_t size) {
    if (sheet->used + size >= sizeof sheet->text)
        sheet_flush(sheet);
    memcpy(sheet->text + sheet->used, bytes, size);
    sheet->used += size;
}

void sheet_print(struct sheet *sheet, const char *format, ...) {
    char text[1000];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length > 0)
        add(sheet, text, (size_t)length < sizeof text ? (size_t)length : sizeof text - 1);
}

void sheet_name(struct sheet *sheet, const char *text) {
    char piece[8];
    for (size_t taken; *text; text += taken) {
        size_t size = text_clean_piece(text, piece, &taken);
        add(sheet, piece, size);
    }
}

void sheet_json(struct sheet *sheet, const char *text) {
    char piece[8];
    add(sheet, "\"", 1);
    for (const char *at = text; *at;) {
        size_t taken, size = text_json_piece(at, piece, &taken);
        add(sheet, piece, size);
        at += taken;
    }
    add(sheet, "\"", 1);
}

void sheet_json_number(struct sheet *sheet, double number) {
    if (isfinite(number))
        sheet_print(sheet, "%.17g", number);
    else
        sheet_print(sheet, "null");
}

void sheet_json_vector(struct sheet *sheet, struct vec3 v) {
    for (int i = 0; i < 3; i++) {
        sheet_print(sheet, i > 0 ? "," : "[");
        sheet_json_number(sheet, vec3_get(v, i));
    }
    sheet_print(sheet, "]");
}
