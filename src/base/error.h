/* One error, as one complete line. Functions that can fail return bool and fill a struct error of the caller.
 * The kind decides the exit status of the program. */
#ifndef GRAY_BASE_ERROR_H
#define GRAY_BASE_ERROR_H

#include <stdbool.h>
#include <stdint.h>

enum error_kind {
    ERROR_NONE = 0,
    ERROR_SCENE = 1,       /* a scene or a file was wrong */
    ERROR_USAGE = 2,       /* the command line was wrong */
    ERROR_MACHINE = 3,     /* the machine failed: disk full, out of memory, no threads */
    ERROR_CANCELLED = 130, /* a request to stop */
};

struct error {
    enum error_kind kind;
    bool elsewhere; /* ERROR_SCENE: a name on the command line is wrong, not the script; the message has no script
                     * line */
    bool refused;   /* of ERROR_SCENE: a picture cannot be written under this name, which --lenient does not change */
    bool limit;     /* of ERROR_SCENE: a resource limit of scenes is reached, which no script can catch */
    char text[1024];
};

/* Fill and return false, so that `return error_set(...)` reads as a failure. Over-long text is cut with "...". Only a
 * format that begins with "gray:" makes a text that does: a name that does so is marked (base/terminal_text.h). */
bool error_set(struct error *error, enum error_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* "out of memory for WHAT"; with `limit` and the reason if the charged account (base/mem.h) has refused memory. */
bool error_no_memory(struct error *error, const char *what);
/* After a failure to read a file: makes it "PATH: needs more than the 64 MiB of --script-memory" if memory was refused
 * since mem_refusals() was `before`; a library may have given another reason. Returns false. */
bool error_of_file(struct error *error, const char *path, uint64_t before);
/* Like error_set, for a limit that is reached. */
bool error_set_limit(struct error *error, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Marks an error as one of the command line: see `elsewhere`. Returns false. */
bool error_elsewhere(struct error *error);
/* The kind of error for a file that cannot be read with this errno: no descriptor or memory is left, or the name is
 * wrong. */
enum error_kind error_kind_of_reading(int number);
/* Puts "PREFIX: " before the existing text. */
bool error_prefix(struct error *error, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Sizes of memory and files as text, "64 MiB", and parsing of "64M". */

#define KIBIBYTE (UINT64_C(1) << 10)
#define MEBIBYTE (UINT64_C(1) << 20)
#define GIBIBYTE (UINT64_C(1) << 30)

enum { SIZE_WORDS = 32 };
/* "64 MiB": in MiB, or in the unit above or below if that gives a short whole number. Returns `out`. */
const char *size_words(uint64_t bytes, char out[SIZE_WORDS]);
/* A whole number and a unit: K, M, G or T, powers of 1024, in either case, with or without "B" or "iB" behind it; a
 * blank may be between them. A plain number is in MiB. False for anything else, and for what exceeds 64 bits. */
bool size_parse(const char *text, uint64_t *bytes);

#endif
