#include "device/kernels_file.h"

#include <stdlib.h>
#include <string.h>

bool kernels_file_open(const char *name, struct file_bytes *kernels, struct error *error) {
    static const char head[] = "gray kernels " GRAY_KERNELS_DIGEST "\n";
    enum { MAX_BYTES = 1 << 28, HEAD = sizeof head - 1 };
    struct error why;
    if (!file_map(name, MAX_BYTES, kernels, &why))
        return error_set(error, ERROR_MACHINE, "there are no kernels for a card: %.900s; make gpu writes them",
                         why.text);
    if (kernels->size >= HEAD && memcmp(kernels->data, head, HEAD) == 0)
        return true;
    file_unmap(kernels);
    return error_set(error, ERROR_MACHINE,
                     "%.900s was made from other sources than this program; make gpu writes it again", name);
}

const void *kernels_file_find(const struct file_bytes *kernels, const char *kernel) {
    enum { LINE = 80 };
    const char *bytes = (const char *)kernels->data, *end = bytes + kernels->size;
    const size_t name_size = strlen(kernel);
    const char *at = kernels->size > 0 ? memchr(bytes, '\n', kernels->size) : NULL;
    for (at = at ? at + 1 : end; at < end;) {
        const size_t room = (size_t)(end - at) < LINE ? (size_t)(end - at) : LINE;
        const char *line_end = memchr(at, '\n', room), *space = memchr(at, ' ', room);
        if (!line_end || !space || space > line_end)
            break;
        const unsigned long long size = strtoull(space, NULL, 10);
        if (size > (size_t)(end - line_end - 1))
            break;
        if ((size_t)(space - at) == name_size && memcmp(at, kernel, name_size) == 0)
            return line_end + 1;
        at = line_end + 1 + size;
    }
    return NULL;
}
