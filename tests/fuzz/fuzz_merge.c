/* Any bytes as parts of pictures for `gray merge`: they are cut wherever a file of tiles could begin. The result is
 * pictures, or status 1. If the last byte is odd, the checksums of all records are corrected first. */
#define _GNU_SOURCE
#include "output/merge.h"
#include "tests/fuzz/folder.h"
#include "tests/fuzz/tile_bytes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { PARTS = 6 };
static const char magic[] = "GRAYTILE";

/* A part must not claim a picture larger than a test can write. */
static bool is_small(const uint8_t *bytes, size_t size) {
    static const size_t full_width = 16 + 16 + 4 + 64; /* after the headers of file and record, number and key */
    for (size_t at = 16; size - at >= 24;) {
        uint64_t kind = tile_bytes_number(bytes + at, 4), length = tile_bytes_number(bytes + at + 8, 8);
        if (length > size - at - 24)
            return true;
        if (kind == 2 && length >= 92) {
            const uint8_t *numbers = bytes + at + full_width - 16;
            if (tile_bytes_number(numbers + 16, 4) * tile_bytes_number(numbers + 20, 4) > 1 << 16)
                return false;
        }
        at += 24 + (size_t)length;
        if (at > size)
            return true;
    }
    return true;
}

static bool write_part(int number, const uint8_t *data, size_t size, bool repair) {
    char name[32];
    uint8_t *bytes = malloc(size + 1);
    if (!bytes)
        return false;
    memcpy(bytes, data, size);
    if (repair)
        tile_bytes_repair(bytes, size);
    bool fine = size < 16 || is_small(bytes, size);
    (void)snprintf(name, sizeof name, "%d.part", number);
    if (fine)
        fuzz_write(name, bytes, size);
    free(bytes);
    return fine;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const names[PARTS] = {"0.part", "1.part", "2.part", "3.part", "4.part", "5.part"};
    struct options options = {.action = ACTION_MERGE, .quiet = true, .progress = PROGRESS_NONE, .scripts = names};
    bool repair = size > 0 && data[size - 1] % 2;
    (void)fuzz_folder();
    for (size_t at = 0; at < size && options.script_count < PARTS;) {
        const uint8_t *next = memmem(data + at + 1, size - at - 1, magic, 8);
        size_t length = next ? (size_t)(next - data) - at : size - at;
        if (!write_part(options.script_count, data + at, length, repair))
            return 0;
        options.script_count++;
        at += length;
    }
    if (options.script_count == 0)
        return 0;
    fuzz_hush(true);
    int status = merge_run(&options);
    fuzz_hush(false);
    if (status != 0 && status != ERROR_SCENE && status != ERROR_MACHINE)
        abort();
    fuzz_empty_folder();
    return 0;
}
