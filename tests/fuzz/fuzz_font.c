/* Any bytes as a font: letters, or one line that names the file. */
#include "formats/font.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct arena arena = {0};
    struct font_text text;
    struct error error = {0};
    if (!font_layout(&(struct font_file){"fuzz.ttf", data, size}, "Ag&8:\xc3\xa9", &arena, &text, &error) &&
        (error.kind == ERROR_NONE || !strstr(error.text, "fuzz.ttf") || strchr(error.text, '\n')))
        abort();
    arena_destroy(&arena);
    return 0;
}
