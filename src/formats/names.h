/* Numbers for names: the first name is 0, the next new one 1 ... Names are not copied. */
#ifndef GRAY_FORMATS_NAMES_H
#define GRAY_FORMATS_NAMES_H

#include "formats/list.h"

struct name {
    const char *text;
    size_t length;
};

/* Owner: the caller, names_destroy. Zero value but for `max`: none. */
struct names {
    struct list entries; /* struct name */
    uint32_t *table;     /* numbers by hash, open addressing, at most half full */
    size_t capacity;
    size_t max; /* more names are reported as lack of memory */
};
/* False: no memory. *number is the one of the equal name that was there, or a new one. */
bool names_add(struct names *names, const char *text, size_t length, uint32_t *number);
/* UINT32_MAX when it is not there. */
uint32_t names_find(const struct names *names, const char *text, size_t length);
void names_destroy(struct names *names);

#endif
