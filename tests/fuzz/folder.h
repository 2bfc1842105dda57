/* A folder of its own for targets that need files, below TMPDIR, else in memory where the system has such a place; the
 * whole program works in it from then on, and it goes at the end. And a way to keep what the code under test says from
 * the terminal, but not what a sanitizer says. */
#ifndef GRAY_TESTS_FUZZ_FOLDER_H
#define GRAY_TESTS_FUZZ_FOLDER_H

#include <stdbool.h>
#include <stddef.h>

/* Made at the first call. */
const char *fuzz_folder(void);
/* Files in it: written, removed all. */
void fuzz_write(const char *name, const void *bytes, size_t size);
void fuzz_empty_folder(void);
/* Nothing goes to standard output and standard error until it is called with false. */
void fuzz_hush(bool on);

#endif
