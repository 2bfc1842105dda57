/* A private folder for targets that need files: below TMPDIR, else in memory where the system has such a place. It
 * becomes the working directory of the program and is removed at the end. Also hides the messages of the code under
 * test from the terminal, but not those of a sanitizer. */
#ifndef GRAY_TESTS_FUZZ_FOLDER_H
#define GRAY_TESTS_FUZZ_FOLDER_H

#include <stdbool.h>
#include <stddef.h>

/* Created by the first call. */
const char *fuzz_folder(void);
/* Writes a file in it; removes all files in it. */
void fuzz_write(const char *name, const void *bytes, size_t size);
void fuzz_empty_folder(void);
/* Discards standard output and standard error until it is called with false. */
void fuzz_hush(bool on);

#endif
