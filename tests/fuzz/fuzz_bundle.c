/* Any bytes as a bundle: an error, or pointers that all lie in the bundle. */
#include "base/bundle.h"

#include <stdlib.h>
#include <string.h>

enum { ROOT = 24 }; /* bytes of the structure in tests/fuzz/corpus/bundle: a number and two pointers */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const uint64_t address = UINT64_C(0x7f0000000000);
    struct error error = {0};
    char *bytes = malloc(size + (size == 0)); /* of the exact size, so that a sanitizer detects a read past the end */
    if (!bytes)
        return 0;
    if (size)
        memcpy(bytes, data, size);
    const char *root = bundle_open(bytes, size, address, ROOT, &error);
    if (root && (root < bytes || root + ROOT > bytes + size))
        abort();
    if (!root && error.kind != ERROR_MACHINE)
        abort();
    for (size_t at = 0; root && at + 8 <= size; at += 8) {
        uint64_t now, before;
        memcpy(&now, bytes + at, 8);
        memcpy(&before, data + at, 8);
        if (now != before && (now != before + address || before >= size))
            abort();
    }
    free(bytes);
    return 0;
}
