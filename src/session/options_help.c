/* --help: the options with their defaults, in groups. */
#include "session/options_internal.h"

#include <string.h>

/* Prints words from `column` on, broken so that no line is longer than 100 columns. */
static void print_wrapped(FILE *stream, const char *text, int column) {
    enum { INDENT = 36, WIDTH = 100 };
    if (column >= INDENT) {
        (void)fputc('\n', stream);
        column = 0;
    }
    (void)fprintf(stream, "%*s", INDENT - column, "");
    column = INDENT;
    while (*text) {
        size_t length = strcspn(text, " ");
        if (column > INDENT && column + 1 + (int)length > WIDTH) {
            (void)fprintf(stream, "\n%*s", INDENT, "");
            column = INDENT;
        }
        column += fprintf(stream, "%s%.*s", column > INDENT ? " " : "", (int)length, text);
        text += length + (text[length] == ' ');
    }
    (void)fputc('\n', stream);
}

static void print_option(FILE *stream, const struct option *option) {
    int column = fprintf(stream, "  ");
    for (const char *rest = option->names; *rest;) {
        bool first = rest == option->names;
        struct piece name = option_next_piece(&rest);
        column += fprintf(stream, "%s%.*s", first ? "" : name.length > 1 ? ", --" : ", -", (int)name.length, name.text);
    }
    if (option->value && option->value[0] == '=')
        column += fprintf(stream, "[%s]", option->value);
    else if (option->value)
        column += fprintf(stream, " %s", option->value);
    char help[512];
    (void)snprintf(help, sizeof help, "%s%s%s%s", option->help, option->initial ? " (default: " : "",
                   option->initial ? option->initial : "", option->initial ? ")" : "");
    print_wrapped(stream, help, column);
}

void options_print_help(FILE *stream) {
    (void)fputs("gray renders scenes that are written as Lua scripts.\n"
                "usage: gray [options] [--] scene.lua ...\n"
                "       gray merge [-o FILE] [options] PART ...\n"
                "Long options take one dash or two, and '_' or '-' between words; a space or '=' precedes the value.\n",
                stream);
    for (int group = 0; group < OPTION_GROUP_COUNT; group++) {
        (void)fprintf(stream, "\n%s\n", option_group_titles[group]);
        for (int i = 0; i < option_count; i++) {
            if (option_table[i].group == (enum option_group)group)
                print_option(stream, &option_table[i]);
        }
    }
    (void)fputs("\nExit status: 0 all pictures written; 1 error in a scene or a file; 2 wrong usage; 3 error of the\n"
                "machine (disk full, out of memory, a crash); 130 interrupted. gray runs every script and returns the\n"
                "highest status. Wrong usage and an interruption end the run at once.\n"
                "Environment: GRAY_LUA is the folder of the Lua library, which require searches last.\n",
                stream);
}
