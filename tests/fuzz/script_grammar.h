/* Bytes become a scene: they choose calls, forms and arguments from the table of gr functions, so that nearly every
 * input passes the argument checks. Every call is protected: after a refused call the rest of the script runs. Some
 * arguments are wrong on purpose, tables whose metamethods lie or raise errors among them. The same bytes give the same
 * text. */
#ifndef GRAY_TESTS_FUZZ_SCRIPT_GRAMMAR_H
#define GRAY_TESTS_FUZZ_SCRIPT_GRAMMAR_H

#include <stddef.h>
#include <stdint.h>

enum { SCRIPT_GRAMMAR_SIZE = 1 << 16 };

/* Writes Lua text, with its final NUL, for a folder that holds the files of script_grammar_files. */
void script_grammar(const uint8_t *data, size_t size, char out[SCRIPT_GRAMMAR_SIZE]);

#endif
