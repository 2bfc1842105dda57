/* What a window can add to a scene (addable.txt), and the fields of the calls that make it: "gr.torus{minor = 0.1}". */
#ifndef GRAY_SCRIPT_ADDABLE_H
#define GRAY_SCRIPT_ADDABLE_H

#include "call/function.h"

/* Groups, titles and calls, ADDABLE_COLUMNS for each, up to NULL. */
enum { ADDABLE_GROUP, ADDABLE_TITLE, ADDABLE_CALL, ADDABLE_COLUMNS };
extern const char *const addable_txt[];

/* The row of the function; NULL: not a call of gr with a table of fields. */
const struct script_function *call_function(const char *call);
/* The text of a field. False: it is not given, or has no room. */
bool call_field(const char *call, const char *name, char *out, size_t size);
/* The call with that text of the field, or, if the text is empty, without the field. False: it has no room. */
bool call_set_field(const char *call, const char *name, const char *text, char *out, size_t size);
/* As many numbers of "2", "2, or more" or "{1, 2, 3}" as there are, up to three; one number counts for all three. */
bool call_numbers(const char *text, double out[3]);

#endif
