/* Zip files: compressed entries one after the other, then their directory (PKWARE, "APPNOTE.TXT", 6.3). */
#ifndef GRAY_EXPORT_ZIP_INTERNAL_H
#define GRAY_EXPORT_ZIP_INTERNAL_H

#include "formats/list.h"

/* Adds an entry to the bytes of a file, and its record to the directory. False: no memory, or larger than 4 GB. */
bool zip_add(struct list *out, struct list *directory, const char *name, const void *data, size_t size);
/* Adds the directory, which ends the file. False: no memory. */
bool zip_end(struct list *out, const struct list *directory, uint32_t count);

#endif
