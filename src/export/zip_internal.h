/* Zip files: compressed entries one after the other, then their directory (PKWARE, "APPNOTE.TXT", 6.3). */
#ifndef GRAY_EXPORT_ZIP_INTERNAL_H
#define GRAY_EXPORT_ZIP_INTERNAL_H

#include "formats/list.h"

struct zip_entry {
    const char *name;
    const void *data;
    size_t size;
    uint32_t crc, packed, offset; /* set by zip_write */
};

/* Adds the bytes of the file. False: no memory, or larger than 4 GB. */
bool zip_write(struct zip_entry *entries, int count, struct list *out);

#endif
