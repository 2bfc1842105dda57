/* Filling of struct error. Text that does not fit ends in "...", never in half a UTF-8 character. It is one line,
 * whatever names of files and nodes in it hold. */
#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void cut_text(char *text, size_t size) {
    size_t end = size - 4;
    while (end > 0 && ((unsigned char)text[end] & 0xc0) == 0x80)
        end--;
    memcpy(text + end, "...", 4);
}

bool error_set(struct error *error, enum error_kind kind, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    if (length >= (int)sizeof error->text)
        cut_text(error->text, sizeof error->text);
    for (char *end = error->text; (end = strpbrk(end, "\n\r"));)
        *end = '?';
    error->kind = kind;
    return false;
}

bool error_no_memory(struct error *error, const char *what) {
    return error_set(error, ERROR_MACHINE, "out of memory for %s", what);
}

bool error_prefix(struct error *error, const char *format, ...) {
    char text[sizeof error->text], prefix[sizeof error->text];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(prefix, sizeof prefix, format, arguments);
    va_end(arguments);
    memcpy(text, error->text, sizeof text);
    return error_set(error, error->kind, "%s: %s", prefix, text);
}
