/* Any bytes as the checkpoint that --resume continues: tiles in the film of the picture, or one line that names the
 * file. Whatever it contained, the checkpoint written next can be read again. If the last byte is odd, the checksums of
 * all records are corrected first. */
#include "base/mem.h"
#include "output/checkpoint.h"
#include "tests/fuzz/folder.h"
#include "tests/fuzz/tile_bytes.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void demand(bool condition) {
    if (!condition)
        abort();
}

static void check_error(const struct error *error) {
    demand(error->kind == ERROR_SCENE && strstr(error->text, "c.tiles") && !strchr(error->text, '\n'));
}

/* The picture that the run makes: the one of the file (a changed scene cannot continue), or another one. */
static void go_on(struct checkpoint *checkpoint, const struct tile_picture *picture) {
    struct error error = {0};
    char notice[256];
    bool written;
    struct checkpoint_tiles tiles = {0};
    size_t bytes;
    struct film film = {
        .x0 = picture->x0, .y0 = picture->y0, .full_width = picture->full_width, .full_height = picture->full_height};
    demand(film_size(picture->width, picture->height, picture->record, &bytes, &error));
    void *block = mem_alloc_zero(1, bytes);
    if (!block)
        return;
    film_layout(&film, block, picture->width, picture->height, picture->record);
    if (!checkpoint_has_written(checkpoint, picture->number, &picture->key, picture->name, &written, &error) ||
        !checkpoint_restore(checkpoint, picture, &film, notice, &error)) {
        check_error(&error);
    } else if (!written && checkpoint_update(checkpoint, picture, &film, true, &tiles, &error)) {
        struct tile_file file;
        if (picture->number >= checkpoint->old_number) {
            demand(tile_file_read("c.tiles", &file, &error) && file.tiles == tiles.done + tiles.begun);
            tile_file_close(&file);
        }
    }
    mem_free(block);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct options options = {.checkpoint = "c.tiles", .resume = true};
    struct checkpoint checkpoint;
    struct error error = {0};
    char notice[256];
    uint8_t *bytes = malloc(size + 1);
    if (!bytes)
        return 0;
    if (size)
        memcpy(bytes, data, size);
    if (size > 16 && data[size - 1] % 2)
        tile_bytes_repair(bytes, size);
    fuzz_write("c.tiles", bytes, size);
    free(bytes);
    const struct picture_files files = {.options = &options};
    checkpoint_init(&checkpoint, &options, &files);
    if (checkpoint_open(&checkpoint, "out.png", notice, &error)) {
        struct tile_picture picture = checkpoint.old.picture;
        if (!checkpoint.old.has_picture)
            picture = (struct tile_picture){.number = 1,
                                            .full_width = 9,
                                            .full_height = 9,
                                            .width = 9,
                                            .height = 9,
                                            .record = {3, 1},
                                            .shard = 1,
                                            .shards = 1,
                                            .name = "out.png"};
        if ((uint64_t)picture.width * picture.height <= 1 << 16)
            go_on(&checkpoint, &picture);
    } else {
        check_error(&error);
    }
    (void)checkpoint_finish(&checkpoint, false, &error);
    return 0;
}
