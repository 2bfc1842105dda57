/* Plain text is broken between words. Roff is broken by its reader: every character that could be a request or another
 * glyph there is escaped. */
#include "base/document.h"

#include "base/arena.h"

#include <assert.h>
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS = 100 };

/* How entries look in plain text: the column of the term, that of the text, and whether the text begins in its line. */
static const struct {
    int indent, hang;
    bool same_line;
} layouts[] = {
    [DOCUMENT_OPTION] = {2, 36, false},
    [DOCUMENT_FUNCTION] = {0, 4, false},
    [DOCUMENT_ARGUMENT] = {6, 10, true},
};

static void add_bytes(struct document *document, const char *bytes, size_t size) {
    if (document->used + size + 1 > document->capacity) {
        size_t capacity = 2 * document->capacity + size + DOCUMENT_LINE;
        char *grown = arena_alloc(document->arena, capacity);
        if (!grown) {
            document->failed = true;
            document->used = document->capacity = 0;
            return;
        }
        if (document->used > 0)
            memcpy(grown, document->text, document->used);
        document->text = grown;
        document->capacity = capacity;
    }
    memcpy(document->text + document->used, bytes, size);
    document->used += size;
    document->text[document->used] = '\0';
}

void document_add(struct document *document, const char *format, ...) {
    char line[DOCUMENT_LINE];
    va_list arguments;
    va_start(arguments, format);
    size_t size = (size_t)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    assert(size < sizeof line); /* the texts of the tables are constant, and tests write all of them */
    add_bytes(document, line, size);
}

/* Breaks words into lines of COLUMNS characters, every line but the first indented; `column` is the start of the first
 * one. */
static void add_filled(struct document *document, int indent, int column, const char *text) {
    for (bool first = true; *text; first = false) {
        size_t size = strcspn(text, " ");
        int length = (int)size;
        if (!first && column + 1 + length > COLUMNS) {
            document_add(document, "\n%*s", indent, "");
            column = indent;
        } else if (!first) {
            document_add(document, " ");
            column++;
        }
        document_add(document, "%.*s", length, text);
        column += length;
        text += size + strspn(text + size, " ");
    }
    document_add(document, "\n");
}

/* A line may break after the bars of a list of words. */
static void add_roff(struct document *document, const char *text, size_t size) {
    static const char special[] = "\\-'`^~";
    static const char *const escapes[] = {"\\e", "\\-", "\\(aq", "\\(ga", "\\(ha", "\\(ti"};
    if (size > 0 && text[0] == '.')
        document_add(document, "\\&");
    for (size_t i = 0; i < size; i++) {
        const char *found = strchr(special, text[i]);
        if (found)
            document_add(document, "%s", escapes[found - special]);
        else
            add_bytes(document, text + i, 1);
        if (text[i] == '|' && i > 0 && isalnum((unsigned char)text[i - 1]) && i + 1 < size)
            document_add(document, "\\:");
    }
}

void document_section(struct document *document, const char *title) {
    document_add(document, document->is_roff ? ".SH " : "\n");
    for (const char *at = title; *at; at++)
        document_add(document, "%c", document->is_roff ? toupper((unsigned char)*at) : *at);
    document_add(document, "\n");
}

void document_subsection(struct document *document, const char *title) {
    document_add(document, "%s%s\n", document->is_roff ? ".SS " : "\n", title);
}

void document_paragraph(struct document *document, const char *text) {
    if (!document->is_roff) {
        add_filled(document, 0, 0, text);
        return;
    }
    document_add(document, ".PP\n");
    add_roff(document, text, strlen(text));
    document_add(document, "\n");
}

void document_lines(struct document *document, const char *text) {
    if (!document->is_roff) {
        add_bytes(document, text, strlen(text));
        return;
    }
    document_add(document, ".PP\n.nf\n");
    for (size_t length; *text; text += length) {
        length = strcspn(text, "\n");
        add_roff(document, text, length);
        document_add(document, "\n");
        length += text[length] == '\n';
    }
    document_add(document, ".fi\n");
}

static void add_roff_entry(struct document *document, bool is_argument, const char *term, const char *text) {
    document_add(document, is_argument ? ".RS\n.PD 0\n" : "");
    for (const char *line = term, *macro = ".TP"; line; macro = ".TQ") {
        size_t length = strcspn(line, "\n");
        document_add(document, "%s\n\\f%c", macro, is_argument ? 'I' : 'B');
        add_roff(document, line, length);
        document_add(document, "\\fR\n");
        line = line[length] ? line + length + 1 : NULL;
    }
    add_roff(document, text, strlen(text));
    document_add(document, is_argument ? "\n.PD\n.RE\n" : "\n");
}

void document_entry(struct document *document, enum document_entry kind, const char *term, const char *text) {
    if (document->is_roff) {
        add_roff_entry(document, kind == DOCUMENT_ARGUMENT, term, text);
        return;
    }
    /* The forms, and where the last one ends. */
    int indent = layouts[kind].indent, hang = layouts[kind].hang, column = indent;
    for (const char *line = term; line;) {
        int length = (int)strcspn(line, "\n");
        document_add(document, "%s%*s%.*s", line == term ? "" : "\n", indent, "", length, line);
        column = indent + length;
        line = line[length] ? line + length + 1 : NULL;
    }
    if (layouts[kind].same_line) {
        document_add(document, " ");
        add_filled(document, hang, column + 1, text);
        return;
    }
    if (column >= hang) {
        document_add(document, "\n");
        column = 0;
    }
    document_add(document, "%*s", hang - column, "");
    add_filled(document, hang, hang, text);
}

void document_gap(struct document *document) {
    if (!document->is_roff)
        document_add(document, "\n");
}
