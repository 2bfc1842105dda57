/* Words of other programs and formats (POV-Ray, OpenSCAD, Blender, three.js, pbrt, Processing) that newcomers try, with
 * what gray calls the same thing. Messages about unknown names ask here before they suggest a name of similar spelling.
 */
#ifndef GRAY_SETTINGS_FOREIGN_WORDS_H
#define GRAY_SETTINGS_FOREIGN_WORDS_H

#include <stdbool.h>
#include <stddef.h>

/* What to use in place of the word, as it follows "use "; NULL: the word is not known. Words are compared without case,
 * '_' and '-'. */
const char *foreign_option(const char *word, size_t length);
const char *foreign_function(const char *word); /* of gr */
const char *foreign_method(const char *word);   /* of nodes */
/* Of a function for which has_field is true of the fields that it has. *is_name: it is the name of a field. */
const char *foreign_field(const char *word, bool (*has_field)(const void *function, const char *name),
                          const void *function, bool *is_name);
/* The rows one after the other, with these columns; ends with NULL. */
enum { FOREIGN_KIND, FOREIGN_USE, FOREIGN_WORDS, FOREIGN_COLUMNS };
extern const char *const foreign_words_txt[];

#endif
