/* Filling of struct error. Text that does not fit ends in "...", never in half a UTF-8 character. It is one line,
 * whatever names of files and nodes in it hold. */
#include "base/error.h"

#include "base/mem.h"
#include "base/size.h"
#include "base/terminal_text.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void cut_text(char *text, size_t size) {
    size_t end = size - 4;
    while (end > 0 && ((unsigned char)text[end] & 0xc0) == 0x80)
        end--;
    memcpy(text + end, "...", 4);
}

static bool fill(struct error *error, enum error_kind kind, const char *format, va_list arguments) {
    int length = vsnprintf(error->text, sizeof error->text, format, arguments);
    if (length >= (int)sizeof error->text)
        cut_text(error->text, sizeof error->text);
    for (char *end = error->text; (end = strpbrk(end, "\n\r"));)
        *end = '?';
    /* A name at the beginning must not look like the program's; a format says what it is. */
    const char *mark = strncmp(format, "gray:", 5) == 0 ? "" : scene_mark(error->text);
    if (mark[0] != '\0') {
        char text[sizeof error->text];
        memcpy(text, error->text, sizeof text);
        length = snprintf(error->text, sizeof error->text, "%s%s", mark, text);
        if (length >= (int)sizeof error->text)
            cut_text(error->text, sizeof error->text);
    }
    error->kind = kind;
    error->elsewhere = false;
    error->limit = false;
    return false;
}

bool error_set(struct error *error, enum error_kind kind, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    (void)fill(error, kind, format, arguments);
    va_end(arguments);
    return false;
}

bool error_set_limit(struct error *error, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    (void)fill(error, ERROR_SCENE, format, arguments);
    va_end(arguments);
    error->limit = true;
    return false;
}

bool error_elsewhere(struct error *error) {
    error->elsewhere = true;
    return false;
}

bool error_no_memory(struct error *error, const char *what) {
    if (mem_refusals() > 0)
        return error_set_limit(error, "out of memory for %s: %s", what, mem_charged()->words);
    return error_set(error, ERROR_MACHINE, "out of memory for %s", what);
}

enum error_kind error_kind_of_reading(int number) {
    switch (number) {
    case EMFILE:
    case ENFILE:
    case ENOMEM:
    case ENOBUFS:
        return ERROR_MACHINE;
    default:
        return ERROR_SCENE;
    }
}

bool error_of_file(struct error *error, const char *path, uint64_t before) {
    const struct mem_account *account = mem_charged();
    char size[SIZE_WORDS];
    if (mem_refusals() == before)
        return false;
    return error_set_limit(error, "%s: needs more than the %s of %s", path, size_words(account->limit, size),
                           account->option);
}

bool error_prefix(struct error *error, const char *format, ...) {
    char text[sizeof error->text], prefix[sizeof error->text];
    bool limit = error->limit;
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(prefix, sizeof prefix, format, arguments);
    va_end(arguments);
    memcpy(text, error->text, sizeof text);
    bool elsewhere = error->elsewhere;
    (void)error_set(error, error->kind, "%s: %s", prefix, text);
    error->limit = limit;
    error->elsewhere = elsewhere;
    return false;
}
