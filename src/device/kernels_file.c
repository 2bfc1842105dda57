#include "device/kernels_file.h"

#include "base/file.h"
#include "base/mem.h"

#include <string.h>

char *kernels_file_read(const char *name, struct error *error) {
    static const char head[] = "gray kernels " GRAY_KERNELS_DIGEST "\n";
    enum { MAX_BYTES = 1 << 28, HEAD = sizeof head - 1 };
    struct file_bytes bytes;
    struct error why;
    if (!file_map(name, MAX_BYTES, &bytes, &why)) {
        (void)error_set(error, ERROR_MACHINE, "there are no kernels for a card: %.900s; make gpu writes them",
                        why.text);
        return NULL;
    }
    const bool fits = bytes.size >= HEAD && memcmp(bytes.data, head, HEAD) == 0;
    char *text = fits ? mem_alloc(bytes.size - HEAD + 1) : NULL;
    if (text) {
        memcpy(text, bytes.data + HEAD, bytes.size - HEAD);
        text[bytes.size - HEAD] = '\0';
    } else if (fits) {
        (void)error_no_memory(error, "the kernels of a card");
    } else {
        (void)error_set(error, ERROR_MACHINE,
                        "%.900s was made from other sources than this program; make gpu writes it again", name);
    }
    file_unmap(&bytes);
    return text;
}
