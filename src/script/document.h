/* The table of functions as documents. */
#ifndef GRAY_SCRIPT_DOCUMENT_H
#define GRAY_SCRIPT_DOCUMENT_H

struct document;

/* The functions and methods of this name; all in the order of the manual if it is NULL. */
void script_describe_function(struct document *document, const char *name);
/* The arguments and fields of this name; functions with one description of it share an entry. */
void script_describe_field(struct document *document, const char *name);
/* Calls `visit` for functions and methods, whose owner is "gr." or "node:", and then for fields, whose owner is "". The
 * name of a field comes several times. */
void script_each_name(void (*visit)(void *context, const char *owner, const char *name, const char *help),
                      void *context);
void script_annotations(struct document *document); /* lua/gr.lua, LuaLS ---@meta */

#endif
