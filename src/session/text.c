/* The printing functions process one character after the other and write at once, so they need no memory and have no
 * limit. A text_writer passes its piece on if the next word does not fit. */
#define _GNU_SOURCE
#include "session/text.h"
#include "math/colour.h"

#include "base/json_write.h"
#include "base/terminal_text.h"
#include "session/standard_streams.h"

#include <poll.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool is_control(const unsigned char *at) {
    enum character_class class = character_class_of(at);
    return class == CHARACTER_CONTROL || class == CHARACTER_BREAK || class == CHARACTER_LINE_END;
}

/* The text up to `end`. continued: line ends before two blanks stay. */
static void put_cleaned(FILE *stream, const char *text, const char *end, bool continued) {
    for (const unsigned char *at = (const unsigned char *)text; at < (const unsigned char *)end;) {
        size_t length = utf8_length(at), whole = length > 0 ? length : 1;
        bool next_line = continued && at[0] == '\n' && at[1] == ' ' && at[2] == ' ';
        if (is_control(at) && !next_line)
            (void)fputc('?', stream);
        else
            (void)fwrite(at, 1, whole, stream);
        at += whole;
    }
}

static void print_cleaned(FILE *stream, const char *text, bool continued) {
    put_cleaned(stream, text, text + strlen(text), continued);
    (void)fputc('\n', stream);
}

size_t text_clean_piece(const char *text, char piece[8], size_t *taken) {
    const unsigned char *at = (const unsigned char *)text;
    size_t length = utf8_length(at);
    *taken = length ? length : 1;
    if (is_control(at)) {
        piece[0] = '?';
        return 1;
    }
    memcpy(piece, text, *taken);
    return *taken;
}

void text_print(FILE *stream, const char *text) {
    char piece[8];
    for (size_t taken; *text; text += taken) {
        size_t size = text_clean_piece(text, piece, &taken);
        (void)fwrite(*text == '\n' ? text : piece, 1, size, stream);
    }
}

void text_print_line(FILE *stream, const char *text) {
    print_cleaned(stream, text, false);
}

void text_print_scene_line(FILE *stream, const char *text) {
    (void)fputs(scene_mark(text), stream);
    print_cleaned(stream, text, false);
}

/* https://no-color.org and the conventions of CLICOLOR. */
static bool has_colour(bool is_terminal) {
    const char *none = getenv("NO_COLOR"), *force = getenv("CLICOLOR_FORCE"), *colour = getenv("CLICOLOR");
    if (none && none[0])
        return false;
    if (force && force[0] && strcmp(force, "0") != 0)
        return true;
    return is_terminal && !(colour && strcmp(colour, "0") == 0);
}

void text_print_message(FILE *stream, enum text_kind kind, const char *text) {
    static const struct {
        const char *word;
        int colour; /* of ECMA-48 */
    } kinds[] = {[TEXT_ERROR] = {"error: ", 31}, [TEXT_WARNING] = {"warning: ", 33}, [TEXT_NOTICE] = {"notice: ", 36}};
    size_t line = strcspn(text, "\n");
    const char *word = kinds[kind].word, *at = memmem(text, line, word, strlen(word)),
               *rest = at ? at + strlen(word) : NULL;
    bool is_terminal = stream == standard_error() && isatty(STDERR_FILENO), continued = kind == TEXT_ERROR;
    bool coloured = has_colour(is_terminal);
    if (!coloured && (at || !is_terminal)) {
        print_cleaned(stream, text, continued);
        return;
    }
    if (!at) { /* the word stands behind the place: "scene.lua:3: " */
        const char *colon = memmem(text, line, ": ", 2);
        at = rest = colon ? colon + 2 : text;
    }
    put_cleaned(stream, text, at, continued);
    if (coloured)
        (void)fprintf(stream, "\033[1;%dm%s\033[0m", kinds[kind].colour, word);
    else
        (void)fputs(word, stream);
    print_cleaned(stream, rest, continued);
}

int text_print_error(const struct error *error) {
    char line[sizeof error->text + 16];
    (void)snprintf(line, sizeof line, "gray: %s", error->text);
    text_print_message(stderr, TEXT_ERROR, line);
    return (int)error->kind;
}

void text_print_json(FILE *stream, const char *text) {
    char piece[JSON_PIECE];
    (void)fputc('"', stream);
    for (size_t taken; *text; text += taken) {
        size_t size = json_piece(text, piece, &taken);
        (void)fwrite(piece, 1, size, stream);
    }
    (void)fputc('"', stream);
}

void text_duration(double seconds, char *out, size_t size) {
    unsigned long whole = seconds < 1e9 ? (unsigned long)(seconds + 0.5) : 1000000000;
    if (whole < 60)
        (void)snprintf(out, size, "%lu s", whole);
    else if (whole < 3600)
        (void)snprintf(out, size, "%lu min %lu s", whole / 60, whole % 60);
    else
        (void)snprintf(out, size, "%lu h %lu min", whole / 3600, whole / 60 % 60);
}

/* poll may not support other kinds of descriptors; writing to them does not wait. */
bool text_stderr_is_ready(void) {
    struct stat status;
    struct pollfd watched = {.fd = STDERR_FILENO, .events = POLLOUT};
    bool waits = fstat(STDERR_FILENO, &status) == 0 &&
                 (S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode) || S_ISSOCK(status.st_mode));
    return !waits || poll(&watched, 1, 0) != 0;
}

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

static void add_name(struct text_writer *writer, const char *text) {
    char piece[8];
    for (size_t taken; *text; text += taken) {
        size_t size = text_clean_piece(text, piece, &taken);
        add(writer, piece, size);
    }
}

static void add_json(struct text_writer *writer, const char *text) {
    char piece[8];
    add(writer, "\"", 1);
    for (const char *at = text; *at;) {
        size_t taken, size = json_piece(at, piece, &taken);
        add(writer, piece, size);
        at += taken;
    }
    add(writer, "\"", 1);
}

static void add_number(struct text_writer *writer, double number) {
    text_writer_print(writer, isfinite(number) ? "%.17g" : "null", number);
}

static void add_three(struct text_writer *writer, double a, double b, double c) {
    add(writer, "[", 1);
    add_number(writer, a);
    add(writer, ",", 1);
    add_number(writer, b);
    add(writer, ",", 1);
    add_number(writer, c);
    add(writer, "]", 1);
}

void text_writer_put(struct text_writer *writer, const char *format, ...) {
    va_list list;
    struct vec3 v;
    struct colour c;
    va_start(list, format);
    for (const char *at = format; *at; at++) {
        if (*at != '%') {
            add(writer, at, 1);
            continue;
        }
        /* The compiler does not check these arguments: each has the type that the header names. */
        switch (*++at) {
        case 's':
            text_writer_print(writer, "%s", va_arg(list, const char *));
            break;
        case 'n':
            add_name(writer, va_arg(list, const char *));
            break;
        case 'q':
            add_json(writer, va_arg(list, const char *));
            break;
        case 'u':
            text_writer_print(writer, "%u", va_arg(list, unsigned));
            break;
        case 'd':
            text_writer_print(writer, "%d", va_arg(list, int));
            break;
        case 'g':
            text_writer_print(writer, "%.6g", va_arg(list, double));
            break;
        case 'v':
            v = va_arg(list, struct vec3);
            text_writer_print(writer, "(%.6g, %.6g, %.6g)", v.x, v.y, v.z);
            break;
        case 'c':
            c = va_arg(list, struct colour);
            text_writer_print(writer, "(%.6g, %.6g, %.6g)", c.r, c.g, c.b);
            break;
        case 'j':
            add_number(writer, va_arg(list, double));
            break;
        case 'a':
            v = va_arg(list, struct vec3);
            add_three(writer, v.x, v.y, v.z);
            break;
        case 'r':
            c = va_arg(list, struct colour);
            add_three(writer, c.r, c.g, c.b);
            break;
        case 'b':
            text_writer_print(writer, va_arg(list, int) ? "true" : "false");
            break;
        case 'i':
            text_writer_print(writer, "%*s", va_arg(list, int), "");
            break;
        }
    }
    va_end(list);
}
