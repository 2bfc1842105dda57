/* Decimal numbers in text files: fast, correctly rounded, the same in every locale. */
#ifndef GRAY_FORMATS_DECIMAL_INTERNAL_H
#define GRAY_FORMATS_DECIMAL_INTERNAL_H

/* Reads [+-] digits [. digits] [(e|E) [+-] digits], with a digit before or after the point, as far as possible.
 * Returns the position after the number. Returns NULL if there is no number at `at`, or if it is too long or too
 * large for a double. Never reads at or after `end`; needs no final NUL. */
const char *decimal_read(const char *at, const char *end, double *out);

#endif
