/* Decimal numbers in text files: fast, correctly rounded, the same in every locale. */
#ifndef GRAY_FORMATS_DECIMAL_INTERNAL_H
#define GRAY_FORMATS_DECIMAL_INTERNAL_H

/* Reads [+-] digits [. digits] [(e|E) [+-] digits], with a digit before or after the point, as far as possible.
 * Returns the position after the number. Returns NULL if there is no number at `at`, or if it is too long or too
 * large for a double. Never reads at or after `end`; needs no final NUL. */
const char *decimal_read(const char *at, const char *end, double *out);

/* The end of a word that means a number, but no finite one, as printf and other programs write it: nan, -inf, 1.#IND,
 * 1e999. NULL: it is another word. */
const char *decimal_skip_not_finite(const char *at, const char *end);

#endif
