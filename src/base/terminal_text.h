/* Text as a terminal displays it, and the rule that only the program's own lines on standard error begin with "gray:":
 * a line whose beginning was chosen by a scene or a file is shown as "scene: gray: ...". */
#ifndef GRAY_BASE_TERMINAL_TEXT_H
#define GRAY_BASE_TERMINAL_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum character_class {
    CHARACTER_SHOWN,     /* including tab and bytes that are not UTF-8 */
    CHARACTER_INVISIBLE, /* has no width: zero-width characters, combining marks */
    CHARACTER_LINE_END,  /* \n */
    CHARACTER_BREAK,     /* other ends of lines: \r, \v, \f, U+0085, U+2028, U+2029 */
    CHARACTER_CONTROL,   /* controls the terminal or the writing direction */
};

/* Length of the well-formed UTF-8 sequence at `at`, which ends in NUL or has four bytes, or 0 (RFC 3629: no overlong
 * forms, no surrogates, up to U+10FFFF). */
size_t utf8_length(const unsigned char *at);
/* Its code point; `length` of 0: the byte. */
uint32_t utf8_code(const unsigned char *at, size_t length);
/* The character at `at`, of utf8_length bytes, or the single byte if that is 0. */
enum character_class character_class_of(const unsigned char *at);

/* "scene: " if the text would look like a line of the program, else "". */
const char *scene_mark(const char *text);

/* Scene-written text on its way to standard error. Ends of lines of every kind become \n, other control characters and
 * direction marks '?', so that the position of the cursor is known; a line that begins with "gray:", also in fragments
 * and with invisible characters, gets its mark. In a line with replaced characters every "gray:" gets it. Zero value:
 * at the beginning of a line. */
struct line_guard {
    bool open;      /* the line has bytes */
    bool begun;     /* the line has visible characters */
    bool replaced;  /* a control character was replaced on it */
    bool had_break; /* the last character was \r, whose meaning depends on the next */
    bool cut;       /* held text was printed: it must not be continued */
    int matched;    /* letters of "gray:" that are held back */
    size_t held_size, partial_size;
    char held[64];   /* these letters, and invisible characters among them */
    char partial[4]; /* the beginning of a UTF-8 sequence */
    char ready[1024];
    size_t ready_size;
    void *context;
    void (*put)(void *context, const char *text, size_t size); /* called with up to sizeof ready bytes */
};

void line_guard_take(struct line_guard *guard, const char *text, size_t size);
/* Prints the held text; the next text begins a new line, since it could complete "gray:". */
void line_guard_flush(struct line_guard *guard);
/* Another writer has ended the line and begun a new one. */
void line_guard_new_line(struct line_guard *guard);

#endif
