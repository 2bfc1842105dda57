/* Decimal numbers in text files: fast, correctly rounded, the same in every locale. */
#ifndef GRAY_FORMATS_DECIMAL_INTERNAL_H
#define GRAY_FORMATS_DECIMAL_INTERNAL_H

/* Reads [+-] digits [. digits] [(e|E) [+-] digits], with a digit before or after the point, as far as it goes. Returns
 * the place after it, or NULL when there is no number at `at` or it is too long or too large for a double. Never reads
 * at or behind `end`; no final NUL needed. */
const char *decimal_read(const char *at, const char *end, double *out);

#endif
