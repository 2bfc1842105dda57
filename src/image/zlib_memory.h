/* zlib's memory comes from mem.h like everything else's. */
#ifndef GRAY_IMAGE_ZLIB_MEMORY_H
#define GRAY_IMAGE_ZLIB_MEMORY_H

#include "base/mem.h"

#define ZLIB_CONST /* input is not written */
#include <zlib.h>

static inline voidpf zlib_alloc(voidpf context, uInt count, uInt size) {
    (void)context;
    return mem_alloc_zero(count, size);
}

static inline void zlib_free(voidpf context, voidpf block) {
    (void)context;
    mem_free(block);
}

#endif
