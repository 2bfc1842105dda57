/* Tile files with correct checksums and wrong contents: each is refused with its reason. The data that distinguish two
 * pictures; the writer of checkpoints, and its behaviour without memory, without disk space and with concurrent
 * changes. */
#include "base/fault.h"
#include "base/hash.h"
#include "film/tile_file.h"
#include "output/checkpoint.h"
#include "render/render.h"
#include "session/options.h"
#include "settings/setting.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { KEY = 32 + 32, SIDE = 40, TILES = 4, RECORDS = 8 }; /* 40 x 40 pixels: 2 x 2 tiles of 32 pixels */

/* A file under construction. */
struct maker {
    uint8_t *bytes;
    size_t size;
    uint64_t records;
};

static void add(struct maker *m, const void *bytes, size_t size) {
    m->bytes = realloc(m->bytes, m->size + size + 1);
    memcpy(m->bytes + m->size, bytes, size);
    m->size += size;
}

static void add_number(struct maker *m, uint64_t value, int size) {
    for (int i = 0; i < size; i++) {
        uint8_t byte = (uint8_t)(value >> 8 * i);
        add(m, &byte, 1);
    }
}

static void begin(struct maker *m) {
    *m = (struct maker){0};
    add(m, "GRAYTILE", 8);
    add_number(m, TILE_FILE_FORMAT, 4);
    add_number(m, FILM_TILE, 4);
}

static void add_record(struct maker *m, uint32_t kind, const struct maker *payload) {
    add_number(m, kind, 4);
    add_number(m, 0, 4);
    add_number(m, payload->size, 8);
    add(m, payload->bytes, payload->size);
    add_number(m, hash_bytes(payload->bytes, payload->size, m->records++ * 64 + kind), 8);
}

static void add_end(struct maker *m) {
    struct maker payload = {0};
    add_number(&payload, m->records, 8);
    add_record(m, 4, &payload);
    free(payload.bytes);
}

/* The file x has the bytes. */
static void refused(struct maker *m, const char *words) {
    struct tile_file file;
    struct error error = {0};
    const char *path = test_path("x");
    FILE *stream = fopen(path, "wb");
    CHECK(stream && fwrite(m->bytes, 1, m->size, stream) == m->size && fclose(stream) == 0);
    if (tile_file_read(path, &file, &error))
        test_fail(__FILE__, __LINE__, "taken, not refused with '%s'", words);
    else if (error.kind != ERROR_SCENE || strncmp(error.text, path, strlen(path)) != 0 || !strstr(error.text, words))
        test_fail(__FILE__, __LINE__, "%s, not '%s'", error.text, words);
    free(m->bytes);
}

/* A finished picture: number, key, digest, name. */
static void done_payload(struct maker *p, const char *name, size_t length) {
    static const uint8_t zeros[KEY + 16];
    *p = (struct maker){0};
    add_number(p, 1, 4);
    add(p, zeros, sizeof zeros);
    add(p, name, length);
}

/* The numbers of a picture in the order of its record. */
struct numbers {
    uint32_t number, full_width, full_height, x0, y0, width, height;
    double exposure;
    uint32_t curve, shard, shards;
};
static const struct numbers right = {1, SIDE, SIDE, 0, 0, SIDE, SIDE, 0, 0, 1, 1};

static void add_settings(struct maker *p, const struct numbers *n) {
    struct settings settings = settings_default();
    settings.tone.exposure = n->exposure;
    settings.tone.curve = (enum tone_curve)n->curve;
    for (int i = 0; i < setting_count; i++) {
        if (setting_table[i].changes == CHANGES_FINISH)
            add_number(p, setting_bits(&setting_table[i], &settings), 8);
    }
}

static void picture_payload(struct maker *p, const struct numbers *n, const char *name) {
    static const uint8_t zeros[KEY];
    const uint32_t sizes[] = {n->full_width, n->full_height, n->x0, n->y0, n->width, n->height};
    const uint32_t shown[] = {n->x0, n->y0, n->x0 + n->width, n->y0 + n->height};
    *p = (struct maker){0};
    add_number(p, n->number, 4);
    add(p, zeros, sizeof zeros);
    for (int i = 0; i < 6; i++)
        add_number(p, sizes[i], 4);
    for (int i = 0; i < 4; i++)
        add_number(p, shown[i], 4);
    add_number(p, 3, 4); /* the record */
    add_number(p, 1, 4);
    add_number(p, n->shard, 4);
    add_number(p, n->shards, 4);
    add_number(p, 1, 4);
    add_settings(p, n);
    add(p, name, strlen(name));
}

static void add_picture(struct maker *m, const struct numbers *n, const char *name) {
    struct maker p;
    picture_payload(&p, n, name);
    add_record(m, 2, &p);
    free(p.bytes);
}

static void add_tile(struct maker *m, uint32_t tile, size_t size) {
    struct maker p = {0};
    add_number(&p, tile, 4);
    for (size_t i = 0; i < size; i++)
        add_number(&p, 0, 1);
    add_record(m, 3, &p);
    free(p.bytes);
}

TEST(a_file_of_tiles_with_right_checks_and_wrong_pictures_is_refused) {
    const struct numbers wrongs[] = {
        {0, SIDE, SIDE, 0, 0, SIDE, SIDE, 0, 0, 1, 1},
        {1, (1 << 20) + 1, SIDE, 0, 0, SIDE, SIDE, 0, 0, 1, 1},
        {1, SIDE, (1 << 20) + 1, 0, 0, SIDE, SIDE, 0, 0, 1, 1},
        {1, SIDE, SIDE, SIDE, 0, 1, 1, 0, 0, 1, 1},
        {1, SIDE, SIDE, 0, SIDE, 1, 1, 0, 0, 1, 1},
        {1, SIDE, SIDE, 1, 0, SIDE, SIDE, 0, 0, 1, 1},
        {1, SIDE, SIDE, 0, 1, SIDE, SIDE, 0, 0, 1, 1},
        {1, 1 << 20, 1 << 20, 0, 0, 1 << 20, 1 << 20, 0, 0, 1, 1},
        {1, SIDE, SIDE, 0, 0, SIDE, SIDE, 0, 99, 1, 1},
        {1, SIDE, SIDE, 0, 0, SIDE, SIDE, (double)NAN, 0, 1, 1},
        {1, SIDE, SIDE, 0, 0, SIDE, SIDE, 0, 0, 0, 1},
        {1, SIDE, SIDE, 0, 0, SIDE, SIDE, 0, 0, 2, 1},
    };
    struct maker m, p;
    for (size_t i = 0; i < sizeof wrongs / sizeof wrongs[0]; i++) {
        begin(&m);
        add_picture(&m, &wrongs[i], "a.png");
        add_end(&m);
        refused(&m, "the description of the picture is invalid");
    }
    begin(&m);
    add_picture(&m, &right, "");
    add_end(&m);
    refused(&m, "the picture has an invalid name");
    begin(&m);
    picture_payload(&p, &right, "");
    p.size--;
    add_record(&m, 2, &p);
    free(p.bytes);
    refused(&m, "the description of the picture is too short");
    begin(&m);
    add_picture(&m, &right, "a.png");
    add_picture(&m, &right, "a.png");
    refused(&m, "there are two pictures");
    begin(&m);
    add_picture(&m, &right, "a.png");
    done_payload(&p, "a.png", 5);
    add_record(&m, 1, &p);
    free(p.bytes);
    refused(&m, "a finished picture is out of order");
}

TEST(a_file_of_tiles_with_right_checks_and_wrong_names_is_refused) {
    static const char nul[] = "a\0b";
    char *much = malloc(5000);
    struct maker m, p;
    memset(much, 'x', 5000);
    for (int i = 0; i < 4; i++) {
        begin(&m);
        done_payload(&p, i == 1 ? nul : much, i == 0 ? 0 : i == 1 ? 3 : i == 2 ? 4096 : 0);
        p.size -= i == 3;
        add_record(&m, 1, &p);
        free(p.bytes);
        add_end(&m);
        refused(&m, i == 3 ? "a finished picture is too short" : "a finished picture has an invalid name");
    }
    free(much);
}

TEST(a_file_of_tiles_with_right_checks_and_wrong_tiles_is_refused) {
    struct maker m, p = {0};
    begin(&m);
    add_tile(&m, 0, 0);
    refused(&m, "a tile comes before its picture");
    begin(&m);
    add_picture(&m, &right, "a.png");
    add_number(&p, 0, 3);
    add_record(&m, 3, &p);
    refused(&m, "a tile is too short");
    for (uint32_t tile = TILES; tile < TILES + 2; tile++) {
        begin(&m);
        add_picture(&m, &right, "a.png");
        add_tile(&m, tile, 0);
        refused(&m, "a tile is out of order");
    }
    begin(&m);
    add_picture(&m, &right, "a.png");
    add_tile(&m, 1, 1);
    refused(&m, "a tile has a wrong size");
    for (uint32_t tile = 2; tile <= 3; tile++) { /* the last one has 8 x 8 pixels, one of 32 x 8 comes before */
        begin(&m);
        add_picture(&m, &right, "a.png");
        add_tile(&m, 3, 8 + 64 * 12);
        add_tile(&m, tile, tile == 3 ? 8 + 64 * 12 : 32 + 256 * 12);
        refused(&m, "a tile is out of order");
    }
    begin(&m);
    add_record(&m, 77, &p);
    refused(&m, "a record has an unknown kind");
    free(p.bytes);
}

TEST(a_file_of_tiles_with_a_wrong_end_is_refused) {
    struct maker m, p = {0};
    begin(&m);
    refused(&m, "it ends too early");
    begin(&m);
    add_number(&p, 0, 7);
    add_record(&m, 4, &p);
    refused(&m, "records are missing");
    begin(&m);
    add_number(&p, 5, 1);
    add_record(&m, 4, &p);
    refused(&m, "records are missing");
    begin(&m);
    add_end(&m);
    add(&m, "x", 1);
    refused(&m, "data follow its end");
    begin(&m);
    add_end(&m);
    m.bytes[20] = 1; /* the reserved number */
    refused(&m, "a record has an impossible size");
    begin(&m);
    add_end(&m);
    m.bytes[31] = 1; /* the size */
    refused(&m, "a record has an impossible size");
    begin(&m);
    add_end(&m);
    m.bytes[24] = 9;
    refused(&m, "it ends too early");
    begin(&m);
    m.bytes[8] = 5;
    refused(&m, "is a file of tiles in another format");
    begin(&m);
    m.bytes[12] = 1;
    refused(&m, "is a file of tiles in another format");
    begin(&m);
    m.bytes[0] = 'g';
    refused(&m, "is not a file of tiles");
    free(p.bytes);
}

static struct tile_picture some_picture(void) {
    return (struct tile_picture){.number = 1,
                                 .key = {"1.2.3", {1, 2}, {3, 4}},
                                 .full_width = SIDE,
                                 .full_height = SIDE,
                                 .width = SIDE,
                                 .height = SIDE,
                                 .record = stage_record(INTEGRATOR_WHITTED),
                                 .shard = 1,
                                 .shards = 1,
                                 .name = "a.png"};
}

TEST(pictures_that_do_not_belong_together_differ_in_their_keys) {
    const struct tile_picture one = some_picture();
    CHECK(!tile_picture_difference(&one, &one));
#define DIFFERS(change, words)                                                                                         \
    do {                                                                                                               \
        struct tile_picture other = one;                                                                               \
        other.change;                                                                                                  \
        CHECK_TEXT(tile_picture_difference(&other, &one), words);                                                      \
    } while (0)
    DIFFERS(key.version[0] = '2', "it was made by a different version of gray");
    DIFFERS(key.options.b = 9, "it was made with different options");
    DIFFERS(key.files.a = 9, "the scene, or a file it reads, has changed");
    DIFFERS(number = 2, "it is of another picture of the run");
    DIFFERS(full_width = 9, "it is of a picture of another size");
    DIFFERS(full_height = 9, "it is of a picture of another size");
    DIFFERS(x0 = 9, "it is of a picture of another size");
    DIFFERS(y0 = 9, "it is of a picture of another size");
    DIFFERS(width = 9, "it is of a picture of another size");
    DIFFERS(height = 9, "it is of a picture of another size");
    DIFFERS(record.floats = 4, "its pixels have records of another size");
    DIFFERS(record.marks = 0, "its pixels have records of another size");
    DIFFERS(shards = 9, "the picture was divided differently");
    DIFFERS(settings.tone.exposure = 9, "it is finished differently");
    DIFFERS(settings.tone.curve = TONE_FILMIC, "it is finished differently");
    DIFFERS(settings.tone.srgb = true, "it is finished differently");
    DIFFERS(tone_table.values[9] = 1, "it is finished differently");
    DIFFERS(settings.deep = true, "it is finished differently");
    DIFFERS(settings.finish.bloom = 1, "it is finished differently");
    DIFFERS(settings.finish.vignette = 1, "it is finished differently");
    DIFFERS(settings.finish.gray = true, "it is finished differently");
    DIFFERS(settings.finish.edges = true, "it is finished differently");
    DIFFERS(settings.finish.fxaa = true, "it is finished differently");
    DIFFERS(settings.finish.dither = DITHER_BLUE, "it is finished differently");
}

/* A film with half of its tiles done, as in a checkpoint. */
static struct film half_film(void) {
    struct film film = {.full_width = SIDE, .full_height = SIDE};
    struct error error;
    size_t bytes;
    CHECK(film_size(SIDE, SIDE, stage_record(INTEGRATOR_WHITTED), &bytes, &error));
    film_layout(&film, calloc(1, bytes), SIDE, SIDE, stage_record(INTEGRATOR_WHITTED));
    atomic_store(&film.tiles[1], FILM_TILE_DONE);
    atomic_store(&film.tiles[2], FILM_TILE_DONE);
    return film;
}

/* After a failure the next try succeeds. */
TEST(any_allocation_or_call_may_fail_while_tiles_are_written_and_read) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    struct film film = half_film();
    const struct tile_picture picture = some_picture();
    const struct tile_done done = {.number = 1, .key = picture.key, .name = "first.png"};
    const char *path = test_path("x.tiles");
    struct error error;
    for (int kind = 0; kind < 2; kind++)
        for (uint64_t k = 1, over = 0; !over; k++) {
            struct tile_file file = {0};
            uint64_t before = fault_count((enum fault_kind)kind);
            fault_at((enum fault_kind)kind, k);
            bool ok = tile_file_write(FILE_AT(path), &done, 1, &picture, &film, &error);
            ok = ok && tile_file_read(path, &file, &error);
            fault_at((enum fault_kind)kind, 0);
            over = fault_count((enum fault_kind)kind) - before < k;
            CHECK(ok || error.text[0]);
            CHECK(!ok || (file.done_count == 1 && file.tiles == 2));
            if (ok)
                tile_file_close(&file);
        }
    free(film.pixels);
}

static struct options options_for(const char *path, bool resume) {
    return (struct options){.checkpoint = path, .resume = resume, .checkpoint_every = 0};
}

/* One test at a time; the names of these tests need not be related. */
static const struct picture_files *files_for(const struct options *options) {
    static struct picture_files files;
    files = (struct picture_files){.options = options};
    return &files;
}

TEST(without_an_option_or_with_check_there_is_no_checkpoint) {
    struct options options = options_for("auto", false);
    struct checkpoint checkpoint;
    struct error error;
    char notice[256];
    struct checkpoint_tiles tiles;
    bool written;
    const struct tile_picture picture = some_picture();
    for (int i = 0; i < 2; i++) {
        options.checkpoint = i ? "auto" : NULL;
        options.check = i;
        checkpoint_init(&checkpoint, &options, files_for(&options));
        CHECK(checkpoint_open(&checkpoint, "a.png", notice, &error) && !checkpoint.opened && notice[0] == '\0');
        CHECK(checkpoint_has_written(&checkpoint, 1, &picture.key, "a.png", &written, &error) && !written);
        CHECK(checkpoint_update(&checkpoint, &picture, NULL, true, &tiles, &error));
        CHECK(checkpoint_note_written(&checkpoint, 1, &picture.key, "a.png", &error));
        CHECK(checkpoint_finish(&checkpoint, true, &error));
    }
}

TEST(a_checkpoint_reports_names_that_are_too_long_and_files_that_are_damaged) {
    struct options options = options_for("auto", true);
    struct checkpoint checkpoint;
    struct error error;
    char notice[256], *name = malloc(4096);
    memset(name, 'x', 4095);
    name[4095] = '\0';
    checkpoint_init(&checkpoint, &options, files_for(&options));
    CHECK(!checkpoint_open(&checkpoint, name, notice, &error));
    CHECK(strstr(error.text, "the name of its checkpoint is longer than 4095 bytes") != NULL);
    free(name);
    const char *path = test_path("broken.tiles");
    test_write_text(path, "GRAYTILE and no more");
    options = options_for(path, true);
    checkpoint_init(&checkpoint, &options, files_for(&options));
    for (int i = 0; i < 2; i++) { /* repeated for every picture */
        error = (struct error){0};
        CHECK(!checkpoint_open(&checkpoint, "a.png", notice, &error));
        CHECK(strstr(error.text, "broken.tiles: is ") != NULL);
    }
    CHECK(checkpoint_finish(&checkpoint, false, &error));
    CHECK(access(path, F_OK) == 0); /* not ours */
}

/* A run that was stopped in its second picture, and its continuation. */
static void leave_checkpoint(const char *path, const char *first, struct film *film) {
    const struct tile_picture picture = some_picture();
    struct tile_picture second = picture;
    struct options options = options_for(path, false);
    struct checkpoint checkpoint;
    struct error error;
    char notice[256];
    struct checkpoint_tiles tiles = {0};
    bool written;
    (void)remove(path);
    checkpoint_init(&checkpoint, &options, files_for(&options));
    second.number = 2;
    CHECK(checkpoint_open(&checkpoint, first, notice, &error));
    CHECK(checkpoint_has_written(&checkpoint, 1, &picture.key, first, &written, &error) && !written);
    test_write_text(first, "a picture");
    CHECK(checkpoint_note_written(&checkpoint, 1, &picture.key, first, &error));
    CHECK(checkpoint_note_written(&checkpoint, 1, &picture.key, "/nothing/there.png",
                                  &error)); /* like a pipe: not kept */
    CHECK(checkpoint_has_written(&checkpoint, 2, &picture.key, "b.png", &written, &error) && !written);
    CHECK(checkpoint_update(&checkpoint, &second, film, true, &tiles, &error));
    CHECK_EQ_INT(tiles.done, 2);
    CHECK(checkpoint_finish(&checkpoint, false, &error));
    CHECK(access(path, F_OK) == 0);
}

TEST(a_checkpoint_resumes_only_the_same_picture) {
    const char *path = test_path("c.tiles"), *first = test_path("first.png");
    struct film film = half_film(), back = half_film();
    const struct tile_picture picture = some_picture();
    struct tile_picture second = picture;
    struct options options = options_for(path, true);
    struct error error;
    struct checkpoint checkpoint;
    char notice[256];
    bool written;
    struct checkpoint_tiles tiles;
    leave_checkpoint(path, first, &film);
    for (int what = 0; what < 8; what++) {
        struct tile_key key = picture.key;
        second = picture;
        second.number = 2;
        second.key.options.a = what == 6 ? 99 : second.key.options.a;
        second.shard = second.shards = 1;
        key.files.a = what == 1 ? 99 : key.files.a;
        test_write_text(first, what == 2 ? "another picture" : "a picture");
        if (what == 3)
            CHECK(remove(first) == 0);
        checkpoint_init(&checkpoint, &options, files_for(&options));
        CHECK(checkpoint_open(&checkpoint, first, notice, &error) && checkpoint.has_old && checkpoint.old_number == 2);
        CHECK(checkpoint_open(&checkpoint, first, notice, &error)); /* it is open */
        bool ok = checkpoint_has_written(&checkpoint, 1, &key, what == 4 ? "other.png" : first, &written, &error);
        CHECK(ok == (what != 1));
        CHECK(!ok || written == (what == 0 || what >= 5));
        if (!ok) {
            CHECK(strstr(error.text, "cannot be resumed: the scene, or a file it reads, has changed") != NULL);
            CHECK(!checkpoint_open(&checkpoint, first, notice, &error));
        }
        /* The first picture is not the one that has tiles; then the second, another shard of it, another picture. */
        if (ok)
            CHECK(checkpoint_restore(&checkpoint, &picture, &back, notice, &error) && notice[0] == '\0');
        second.shard = what == 5 ? 2 : 1;
        if (what == 5)
            second.shards = 1;
        if (ok) {
            bool restored = checkpoint_restore(&checkpoint, &second, &back, notice, &error);
            CHECK(restored == (what != 5 && what != 6));
            CHECK(!restored || strstr(notice, "of 4 tiles of ") != NULL);
            if (!restored)
                CHECK(strstr(error.text,
                             what == 5 ? "it is another part of the picture" : "it was made with different options"));
        }
        /* The file is not written again until the run has reached the state of the previous one. */
        CHECK(checkpoint_update(&checkpoint, &second, &film, true, &tiles, &error));
        CHECK(checkpoint_finish(&checkpoint, what == 7, &error));
        CHECK((access(path, F_OK) == 0) == (what != 7)); /* all pictures are written: the file is removed */
    }
    free(film.pixels);
    free(back.pixels);
}

TEST(a_checkpoint_of_another_run_is_refused) {
    const char *path = test_path("d.tiles"), *first = test_path("first.png");
    struct film film = half_film();
    struct options options = options_for(path, false);
    struct checkpoint checkpoint;
    struct error error;
    char notice[256];
    leave_checkpoint(path, first, &film);
    checkpoint_init(&checkpoint, &options, files_for(&options));
    CHECK(!checkpoint_open(&checkpoint, first, notice, &error));
    CHECK(error.kind == ERROR_USAGE && strstr(error.text, "continue it with --resume, or remove it"));
    options = options_for(test_path("none.tiles"), true);
    checkpoint_init(&checkpoint, &options, files_for(&options));
    CHECK(checkpoint_open(&checkpoint, first, notice, &error) && strstr(notice, "the run starts from the beginning"));
    free(film.pixels);
}

/* Without --checkpoint. began: seconds ago; options: their digest. */
static void interrupt(const char *path, double began, uint64_t options_digest, bool finishes, const char *says) {
    struct options options = {.keeps_tiles = true, .checkpoint_every = 0};
    struct film film = half_film();
    struct tile_picture picture = some_picture();
    struct checkpoint checkpoint;
    struct checkpoint_tiles tiles = {0};
    struct error error;
    char notice[256];
    picture.key.options.a = options_digest;
    checkpoint_init(&checkpoint, &options, files_for(&options));
    CHECK(checkpoint_open(&checkpoint, path, notice, &error) && notice[0] == '\0');
    CHECK(checkpoint_restore(&checkpoint, &picture, &film, notice, &error));
    CHECK(strstr(notice, says) && (notice[0] == '\0') == (says[0] == '\0'));
    CHECK(checkpoint_update(&checkpoint, &picture, &film, false, &tiles, &error) && tiles.done == 0);
    checkpoint.written_at -= began;
    CHECK(checkpoint_update(&checkpoint, &picture, &film, !finishes, &tiles, &error));
    CHECK(checkpoint_finish(&checkpoint, finishes, &error));
    free(film.pixels);
}

TEST(a_checkpoint_that_was_not_requested_is_written_after_a_minute_and_replaces_none_of_other_options) {
    const char *picture = test_path("l.png"), *path = test_path("l.png.checkpoint");
    struct file_identity first, second;
    interrupt(picture, 59, 1, false, "");
    CHECK(access(path, F_OK) != 0);
    interrupt(picture, 61, 1, false, "");
    CHECK(file_identity_of(path, &first));
    /* Other options: neither replaced nor removed. */
    interrupt(picture, 61, 2, false, "is of a run with other options, and stays");
    interrupt(picture, 61, 2, true, "stays");
    CHECK(file_identity_of(path, &second) && first.inode == second.inode);
    /* The same ones: kept by a short run, replaced by a long one, removed by a finished one. */
    interrupt(picture, 59, 1, false, "is of this picture: --resume would go on with it");
    CHECK(file_identity_of(path, &second) && first.inode == second.inode);
    interrupt(picture, 61, 1, false, "--resume");
    CHECK(file_identity_of(path, &second) && first.inode != second.inode);
    interrupt(picture, 1, 1, true, "--resume");
    CHECK(access(path, F_OK) != 0);
}

TEST(a_checkpoint_that_cannot_be_written_is_reported_once_and_on_request) {
    struct options options = options_for(test_path("no/such\x01/folder/c.tiles"), false);
    const char *file = test_path("no");
    struct film film = half_film();
    const struct tile_picture picture = some_picture();
    struct checkpoint checkpoint;
    struct error error;
    char notice[256];
    struct checkpoint_tiles tiles = {77, 0};
    bool written;
    test_write_text(file, "a file where a folder must be");
    checkpoint_init(&checkpoint, &options, files_for(&options));
    CHECK(checkpoint_open(&checkpoint, "a.png", notice, &error));
    CHECK(checkpoint_has_written(&checkpoint, 1, &picture.key, "a.png", &written, &error));
    CHECK(!checkpoint_update(&checkpoint, &picture, &film, false, &tiles, &error));
    checkpoint.took = checkpoint.written_at = 0; /* as if written long ago */
    CHECK(checkpoint_update(&checkpoint, &picture, &film, false, &tiles, &error));
    CHECK(!checkpoint_update(&checkpoint, &picture, &film, true, &tiles, &error));
    CHECK_EQ_INT(tiles.done, 77);
    free(film.pixels);
}

TEST(any_allocation_or_call_may_fail_in_a_checkpoint) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    const char *path = test_path("e.tiles"), *first = test_path("first.png");
    struct film film = half_film(), back = half_film();
    const struct tile_picture picture = some_picture();
    struct tile_picture second = picture;
    struct options options = options_for(path, true);
    struct error error;
    char notice[256];
    struct checkpoint_tiles tiles;
    second.number = 2;
    for (int kind = 0; kind < 2; kind++)
        for (uint64_t k = 1, over = 0; !over; k++) {
            struct checkpoint checkpoint;
            bool written;
            leave_checkpoint(path, first, &film);
            uint64_t before = fault_count((enum fault_kind)kind);
            fault_at((enum fault_kind)kind, k);
            checkpoint_init(&checkpoint, &options, files_for(&options));
            bool ok = checkpoint_open(&checkpoint, first, notice, &error) &&
                      checkpoint_has_written(&checkpoint, 1, &picture.key, first, &written, &error) &&
                      checkpoint_has_written(&checkpoint, 2, &picture.key, "b.png", &written, &error) &&
                      checkpoint_restore(&checkpoint, &second, &back, notice, &error) &&
                      checkpoint_update(&checkpoint, &second, &film, true, &tiles, &error) &&
                      checkpoint_note_written(&checkpoint, 2, &picture.key, first, &error);
            ok = checkpoint_finish(&checkpoint, false, &error) && ok;
            fault_at((enum fault_kind)kind, 0);
            over = fault_count((enum fault_kind)kind) - before < k;
            CHECK(ok || error.text[0]);
        }
    free(film.pixels);
    free(back.pixels);
}
