/* The record of a pixel has a size that the picture states: any record survives tiles and files, files of the first
 * format keep their bytes, and pixels with different records are never mixed. */
#include "film/path_film.h"
#include "film/tile_file.h"
#include "output/checkpoint.h"
#include "render/render.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = FILM_TILE + 7 };
static const struct film_record plain = {5, 0};

static struct film film_of(struct film_record record) {
    struct film film = {.full_width = SIDE, .full_height = SIDE};
    struct error error;
    size_t bytes;
    CHECK(film_size(SIDE, SIDE, record, &bytes, &error));
    film_layout(&film, calloc(1, bytes), SIDE, SIDE, record);
    return film;
}

/* Every tile is done; the floats of an unmarked pixel are its colour. */
static struct film painted(struct film_record record) {
    struct film film = film_of(record);
    struct test_random random = {7};
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        bool marked = record.marks && test_uniform(&random, 0, 1) < 0.3;
        if (record.marks)
            film.marked[i] = marked;
        for (int c = 0; c < 3; c++)
            film.pixels[i].rgb[c] = (float)test_uniform(&random, -1, 2);
        for (uint32_t k = 0; k < record.floats; k++)
            film.floats[i * record.floats + k] =
                marked || !record.marks ? (float)test_uniform(&random, -1, 2) : film.pixels[i].rgb[k % 3];
    }
    for (uint32_t tile = 0; tile < film_tile_count(&film); tile++)
        atomic_store(&film.tiles[tile], FILM_TILE_DONE);
    return film;
}

static void check_same(const struct film *a, const struct film *b) {
    size_t bytes = (size_t)SIDE * SIDE * film_record_size(a->record);
    CHECK(film_record_equal(a->record, b->record) && memcmp(a->pixels, b->pixels, bytes) == 0);
}

static struct tile_picture picture_of(struct film_record record, uint32_t shard, uint32_t shards) {
    return (struct tile_picture){.number = 1,
                                 .key = {"1.2.3", {1, 2}, {3, 4}},
                                 .full_width = SIDE,
                                 .full_height = SIDE,
                                 .width = SIDE,
                                 .height = SIDE,
                                 .record = record,
                                 .shard = shard,
                                 .shards = shards,
                                 .whole = true,
                                 .name = "a.png"};
}

TEST(a_pixel_takes_its_colour_its_floats_and_its_mark) {
    CHECK_EQ_INT(film_record_size(plain), 12 + 20);
    CHECK_EQ_INT(film_record_size(stage_record(INTEGRATOR_WHITTED)), 12 + 12 + 1);
    CHECK(film_record_valid((struct film_record){FILM_RECORD_FLOATS, 1}));
    CHECK(!film_record_valid((struct film_record){FILM_RECORD_FLOATS + 1, 0}));
    CHECK(!film_record_valid((struct film_record){0, 2}));
}

TEST(tiles_of_any_record_come_back_with_the_bytes_that_the_record_asks_for) {
    static const struct film_record all[] = {{0, 0}, {5, 0}, {FILM_RECORD_FLOATS, 0}, {3, 1}, {0, 1}, {16, 1}};
    static uint8_t bytes[FILM_PACKED_LIMIT];
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        struct film film = painted(all[i]), back = film_of(all[i]);
        for (uint32_t tile = 0; tile < film_tile_count(&film); tile++) {
            struct film_rectangle r = film_tile_rectangle(&film, tile);
            size_t pixels = (size_t)(r.x1 - r.x0) * (r.y1 - r.y0), size = film_tile_pack(&film, tile, bytes);
            CHECK(size <= FILM_PACKED_LIMIT);
            CHECK(all[i].marks || size == pixels * film_record_size(all[i]));
            CHECK(!film_tile_unpack(&back, tile, bytes, size - 1) && back.tiles[tile] == FILM_TILE_WANTED);
            CHECK(film_tile_unpack(&back, tile, bytes, size) && back.tiles[tile] == FILM_TILE_DONE);
        }
        check_same(&film, &back);
        free(film.pixels);
        free(back.pixels);
    }
}

TEST(a_film_without_marks_shows_its_colours_as_first_pass_and_no_red) {
    struct film film = painted(plain);
    uint8_t lines[3][3 * SIDE];
    for (int view = FILM_FINAL; view <= FILM_TARGETS; view++)
        film_row_toned(&film, (enum film_view)view, &(struct tone){0}, 3, lines[view]);
    CHECK(memcmp(lines[0], lines[1], sizeof lines[0]) == 0 && memcmp(lines[0], lines[2], sizeof lines[0]) == 0);
    atomic_store(&film.tiles[0], FILM_TILE_WANTED);
    film_clear_unfinished(&film);
    for (uint32_t k = 0; k < plain.floats; k++)
        CHECK(film.floats[k] == 0 && film.floats[(SIDE * SIDE - 1) * plain.floats + k] != 0);
    free(film.pixels);
}

TEST(files_state_the_record_of_their_picture) {
    static const struct film_record all[] = {{3, 1}, {5, 0}, {0, 0}};
    const char *path = test_path("x.part");
    struct error error;
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        struct film film = painted(all[i]), back = film_of(all[i]);
        struct tile_picture picture = picture_of(all[i], 1, 1);
        struct tile_file file;
        uint32_t restored, twice;
        CHECK(tile_file_write(FILE_AT(path), NULL, 0, &picture, &film, &error));
        CHECK(tile_file_read(path, &file, &error));
        CHECK(!tile_picture_difference(&file.picture, &picture));
        tile_file_restore(&file, &back, &restored, &twice);
        CHECK_EQ_INT(restored, film_tile_count(&film));
        check_same(&film, &back);
        tile_file_close(&file);
        free(film.pixels);
        free(back.pixels);
    }
}

TEST(a_record_that_cannot_be_is_refused) {
    const char *path = test_path("x.part");
    struct film film = painted(plain);
    struct error error;
    for (int i = 0; i < 2; i++) {
        struct tile_picture picture = picture_of(plain, 1, 1);
        struct tile_file file;
        picture.record = i == 0 ? (struct film_record){FILM_RECORD_FLOATS + 1, 0} : (struct film_record){3, 2};
        CHECK(tile_file_write(FILE_AT(path), NULL, 0, &picture, &film, &error));
        CHECK(!tile_file_read(path, &file, &error) && strstr(error.text, "the description of the picture is invalid"));
        picture.record = (struct film_record){4, 0}; /* one float less than its tiles have */
        CHECK(tile_file_write(FILE_AT(path), NULL, 0, &picture, &film, &error));
        CHECK(!tile_file_read(path, &file, &error) && strstr(error.text, "a tile has a wrong size"));
    }
    free(film.pixels);
}

TEST(a_checkpoint_of_another_record_is_not_gone_on_with) {
    const char *path = test_path("c.tiles");
    const struct options options = {.checkpoint = path, .resume = true};
    const struct picture_files files = {.options = &options};
    struct film old = painted(plain), film = film_of(stage_record(INTEGRATOR_WHITTED));
    struct tile_picture before = picture_of(plain, 1, 1), now = picture_of(film.record, 1, 1);
    struct checkpoint checkpoint;
    struct error error;
    char notice[256];
    CHECK(tile_file_write(FILE_AT(path), NULL, 0, &before, &old, &error));
    checkpoint_init(&checkpoint, &options, &files);
    CHECK(checkpoint_open(&checkpoint, "a.png", notice, &error));
    CHECK(!checkpoint_restore(&checkpoint, &now, &film, notice, &error));
    CHECK(strstr(error.text, "cannot be resumed: its pixels have records of another size") != NULL);
    CHECK_EQ_INT(film_tiles_in(&film, FILM_TILE_DONE), 0);
    (void)checkpoint_finish(&checkpoint, false, &error);
    free(old.pixels);
    free(film.pixels);
}

/* Part `shard` of two, with every second tile of a painted film. */
static void write_part(const char *name, struct film_record record, uint32_t shard) {
    struct film film = painted(record);
    struct tile_picture picture = picture_of(record, shard, 2);
    struct error error;
    for (uint32_t tile = shard - 1; tile < film_tile_count(&film); tile += 2)
        atomic_store(&film.tiles[tile], FILM_TILE_ELSEWHERE);
    CHECK(tile_file_write(FILE_AT(test_path(name)), NULL, 0, &picture, &film, &error));
    free(film.pixels);
}

TEST(merge_refuses_parts_of_another_record_and_takes_those_of_one) {
    write_part("1.part", plain, 1);
    write_part("2.part", plain, 2);
    write_part("other.part", stage_record(INTEGRATOR_WHITTED), 2);
    struct test_result result = test_gray(NULL, "merge 1.part other.part");
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.err, "does not belong to 1.part: its pixels have records of another size") != NULL);
    test_free_result(&result);
    result = test_gray(NULL, "merge 1.part 2.part");
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    struct test_picture picture = test_read_picture(test_path("a.png"));
    struct film film = painted(plain);
    uint8_t line[3 * SIDE];
    for (uint32_t y = 0; y < SIDE; y++) {
        film_row_toned(&film, FILM_FINAL, &(struct tone){0}, y, line);
        CHECK(memcmp(line, picture.rgb + (size_t)3 * SIDE * y, sizeof line) == 0);
    }
    free(picture.rgb);
    free(film.pixels);
}

TEST(a_count_of_samples_that_no_pixel_can_have_is_none) {
    static const float counts[] = {1e30F, 0x1p32F, -1, -INFINITY, INFINITY, NAN};
    const struct path_pixel stored = {.samples = 12345};
    struct film film = film_of(stage_record(INTEGRATOR_PATH));
    uint32_t at = 0;
    path_film_store(&film, 0, &stored);
    CHECK_EQ_INT(path_film_load(&film, 0).samples, 12345);
    while (at + 1 < film.record.floats && film.floats[at] != 12345)
        at++;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        film.floats[at] = counts[i];
        CHECK_EQ_INT(path_film_load(&film, 0).samples, 0);
    }
    free(film.pixels);
}
