/* A text of sections, paragraphs and entries: plain, at most 100 columns wide, or the source of a manual page (roff,
 * the macros man). It grows in the arena by doubling; abandoned blocks stay there, at most as much again. */
#ifndef GRAY_BASE_DOCUMENT_H
#define GRAY_BASE_DOCUMENT_H

#include <stdbool.h>
#include <stddef.h>

struct arena;

struct document {
    struct arena *arena;
    bool is_roff;
    char *text; /* NULL: nothing was added */
    size_t used, capacity;
    bool failed; /* no memory */
};
/* What the text of an entry explains. */
enum document_entry { DOCUMENT_OPTION, DOCUMENT_FUNCTION, DOCUMENT_ARGUMENT };

/* The text as it is, at most DOCUMENT_LINE - 1 bytes. */
enum { DOCUMENT_LINE = 1024 };
void document_add(struct document *document, const char *format, ...) __attribute__((format(printf, 2, 3)));
void document_section(struct document *document, const char *title);
void document_subsection(struct document *document, const char *title); /* in plain text the same */
void document_paragraph(struct document *document, const char *text);
void document_lines(struct document *document, const char *text); /* lines with their ends, not filled */
/* Each line of the term is a form of it. */
void document_entry(struct document *document, enum document_entry kind, const char *term, const char *text);
/* An empty line after what belongs together; roff has its own. */
void document_gap(struct document *document);

#endif
