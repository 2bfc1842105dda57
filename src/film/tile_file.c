/* The file is a magic word, a format number, the side of a tile and a row of records: kind, size, payload, check. The
 * check covers kind, size, place in the row and payload, so that swapped or missing records are detected; the
 * last record counts them. All numbers are little-endian. Reading first checks everything (every checksum, every size,
 * every tile number) and only then returns data. It has one record in memory at a time: neither the claims nor the size
 * of a file cost memory.
 *
 * Tiles that are begun have some of their samples; gray continues them.
 *
 * A picture has the values of the settings that change the finished picture, in the order of their list. */
#include "film/tile_file.h"

#include "base/bytes.h"
#include "base/mem.h"
#include "settings/setting.h"

#include <math.h>
#include <string.h>

static const char magic[8] = "GRAYTILE";

enum {
    RECORD_DONE = 1,
    RECORD_PICTURE = 2,
    RECORD_TILE = 3,
    RECORD_END = 4,
    RECORD_BEGUN = 5,
    RECORD_HEAD = 16, /* kind, reserved, size */
    RECORD_CHECK = 8,
    KEY_SIZE = TILE_FILE_VERSION_TEXT + 32,
    DONE_FIXED = 4 + KEY_SIZE + 16,
    PICTURE_FIXED = 4 + KEY_SIZE + 24 + 16 + 8 + 12,
    SETTINGS_LIMIT = 8 * LIST_COUNT(SETTINGS),
    TONE_TABLE_SIZE = 4 * TONE_ENTRIES, /* of TONE_FUNCTION */
    PAYLOAD_LIMIT = 4 + FILM_PACKED_LIMIT + TILE_FILE_NAME + PICTURE_FIXED + SETTINGS_LIMIT + TONE_TABLE_SIZE,
    DONE_LIMIT = 1 << 18, /* finished pictures are kept in memory, 4 KiB each */
};

static struct film_rectangle shown_of(const struct tile_picture *picture) {
    const struct film_rectangle whole = {picture->x0, picture->y0, picture->x0 + picture->width,
                                         picture->y0 + picture->height};
    return picture->shown.x1 == 0 ? whole : picture->shown;
}

static bool rectangles_equal(struct film_rectangle a, struct film_rectangle b) {
    return a.x0 == b.x0 && a.y0 == b.y0 && a.x1 == b.x1 && a.y1 == b.y1;
}

/* Numbers as bytes. */

struct byte_writer {
    uint8_t *at;
};

static void put(struct byte_writer *output, const void *bytes, size_t size) {
    memcpy(output->at, bytes, size);
    output->at += size;
}

static void put_u32(struct byte_writer *output, uint32_t value) {
    bytes_put(&output->at, value, 4);
}

static void put_u64(struct byte_writer *output, uint64_t value) {
    bytes_put(&output->at, value, 8);
}

static void put_table(struct byte_writer *output, const struct tone_table *table) {
    for (int i = 0; i < TONE_ENTRIES; i++) {
        uint32_t bits;
        memcpy(&bits, &table->values[i], sizeof bits);
        put_u32(output, bits);
    }
}

static void put_settings(struct byte_writer *output, const struct settings *settings) {
    for (int i = 0; i < setting_count; i++) {
        if (setting_table[i].changes == CHANGES_FINISH)
            put_u64(output, setting_bits(&setting_table[i], settings));
    }
}

static void put_rectangle(struct byte_writer *output, struct film_rectangle r) {
    put_u32(output, r.x0);
    put_u32(output, r.y0);
    put_u32(output, r.x1);
    put_u32(output, r.y1);
}

static void put_digest(struct byte_writer *output, struct digest digest) {
    put_u64(output, digest.a);
    put_u64(output, digest.b);
}

static void put_key(struct byte_writer *output, const struct tile_key *key) {
    put(output, key->version, sizeof key->version);
    put_digest(output, key->options);
    put_digest(output, key->files);
}

struct byte_reader {
    const uint8_t *at;
};

static void get(struct byte_reader *input, void *out, size_t size) {
    memcpy(out, input->at, size);
    input->at += size;
}

static uint32_t get_u32(struct byte_reader *input) {
    return (uint32_t)bytes_get(&input->at, 4);
}

static uint64_t get_u64(struct byte_reader *input) {
    return bytes_get(&input->at, 8);
}

static struct digest get_digest(struct byte_reader *input) {
    uint64_t a = get_u64(input);
    return (struct digest){a, get_u64(input)};
}

static struct tile_key get_key(struct byte_reader *input) {
    struct tile_key key;
    get(input, key.version, sizeof key.version);
    key.version[sizeof key.version - 1] = '\0';
    key.options = get_digest(input);
    key.files = get_digest(input);
    return key;
}

static struct film_record get_film_record(struct byte_reader *input) {
    uint32_t floats = get_u32(input);
    return (struct film_record){floats, get_u32(input)};
}

static size_t settings_size(void) {
    size_t size = 0;
    for (int i = 0; i < setting_count; i++)
        size += setting_table[i].changes == CHANGES_FINISH ? 8 : 0;
    return size;
}

/* False: a value is not valid. */
static bool get_settings(struct byte_reader *input, struct settings *out) {
    bool valid = true;
    *out = settings_default();
    for (int i = 0; i < setting_count; i++) {
        if (setting_table[i].changes == CHANGES_FINISH)
            valid = setting_set_bits(&setting_table[i], out, get_u64(input)) && valid;
    }
    return valid;
}

/* False: a number is not finite. */
static bool get_table(struct byte_reader *input, struct tone_table *out) {
    bool fine = true;
    for (int i = 0; i < TONE_ENTRIES; i++) {
        uint32_t bits = get_u32(input);
        memcpy(&out->values[i], &bits, sizeof bits);
        fine = fine && isfinite(out->values[i]);
    }
    return fine;
}

static struct film_rectangle get_rectangle(struct byte_reader *input) {
    uint32_t x0 = get_u32(input), y0 = get_u32(input), x1 = get_u32(input);
    return (struct film_rectangle){x0, y0, x1, get_u32(input)};
}

static uint64_t check_of(uint64_t position, uint32_t kind, const uint8_t *payload, size_t size) {
    return hash_bytes(payload, size, position * 64 + kind);
}

/* Writing. */

struct text_writer {
    struct file_output file;
    uint64_t records;
    uint8_t *buffer; /* RECORD_HEAD, payload, RECORD_CHECK */
};

static bool write_record(struct text_writer *writer, uint32_t kind, size_t size, struct error *error) {
    struct byte_writer output = {writer->buffer};
    put_u32(&output, kind);
    put_u32(&output, 0);
    put_u64(&output, size);
    output.at += size;
    put_u64(&output, check_of(writer->records++, kind, writer->buffer + RECORD_HEAD, size));
    return file_output_write(&writer->file, writer->buffer, RECORD_HEAD + size + RECORD_CHECK, error);
}

static bool write_done(struct text_writer *writer, const struct tile_done *done, struct error *error) {
    struct byte_writer output = {writer->buffer + RECORD_HEAD};
    put_u32(&output, done->number);
    put_key(&output, &done->key);
    put_digest(&output, done->written);
    put(&output, done->name, strlen(done->name));
    return write_record(writer, RECORD_DONE, (size_t)(output.at - writer->buffer) - RECORD_HEAD, error);
}

static bool write_picture(struct text_writer *writer, const struct tile_picture *picture, struct error *error) {
    struct byte_writer output = {writer->buffer + RECORD_HEAD};
    put_u32(&output, picture->number);
    put_key(&output, &picture->key);
    put_u32(&output, picture->full_width);
    put_u32(&output, picture->full_height);
    put_u32(&output, picture->x0);
    put_u32(&output, picture->y0);
    put_u32(&output, picture->width);
    put_u32(&output, picture->height);
    put_rectangle(&output, shown_of(picture));
    put_u32(&output, picture->record.floats);
    put_u32(&output, picture->record.marks);
    put_u32(&output, picture->shard);
    put_u32(&output, picture->shards);
    put_u32(&output, picture->whole);
    put_settings(&output, &picture->settings);
    if (picture->settings.tone.curve == TONE_FUNCTION)
        put_table(&output, &picture->tone_table);
    put(&output, picture->name, strlen(picture->name));
    return write_record(writer, RECORD_PICTURE, (size_t)(output.at - writer->buffer) - RECORD_HEAD, error);
}

/* A tile whose state is the same afterwards did not change meanwhile. */
static bool write_tiles(struct text_writer *writer, const struct film *film, struct error *error) {
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        uint8_t state = atomic_load_explicit(&film->tiles[tile], memory_order_acquire);
        if (state != FILM_TILE_DONE && !film_tile_is_begun(state))
            continue;
        struct byte_writer output = {writer->buffer + RECORD_HEAD};
        put_u32(&output, tile);
        size_t size = film_tile_pack(film, tile, output.at);
        atomic_thread_fence(memory_order_acquire); /* the pixels are loaded before the state */
        if (atomic_load_explicit(&film->tiles[tile], memory_order_relaxed) != state)
            continue;
        if (!write_record(writer, state == FILM_TILE_DONE ? RECORD_TILE : RECORD_BEGUN, 4 + size, error))
            return false;
    }
    return true;
}

static bool write_all(struct text_writer *writer, const struct tile_done *done, size_t done_count,
                      const struct tile_picture *picture, const struct film *film, struct error *error) {
    struct byte_writer output = {writer->buffer};
    put(&output, magic, sizeof magic);
    put_u32(&output, TILE_FILE_FORMAT);
    put_u32(&output, FILM_TILE);
    bool ok = file_output_write(&writer->file, writer->buffer, sizeof magic + 8, error);
    for (size_t i = 0; ok && i < done_count; i++)
        ok = write_done(writer, &done[i], error);
    ok = ok && (!picture || (write_picture(writer, picture, error) && write_tiles(writer, film, error)));
    output.at = writer->buffer + RECORD_HEAD;
    put_u64(&output, writer->records);
    return ok && write_record(writer, RECORD_END, 8, error);
}

bool tile_file_write(const struct file_target *target, const struct tile_done *done, size_t done_count,
                     const struct tile_picture *picture, const struct film *film, struct error *error) {
    struct text_writer writer = {.buffer = mem_alloc(RECORD_HEAD + PAYLOAD_LIMIT + RECORD_CHECK)};
    if (!writer.buffer)
        return error_no_memory(error, target->path);
    bool ok = file_output_open(&writer.file, target, error);
    if (ok) {
        ok = write_all(&writer, done, done_count, picture, film, error);
        if (ok)
            ok = file_output_commit(&writer.file, error);
        else
            file_output_abandon(&writer.file);
    }
    mem_free(writer.buffer);
    return ok;
}

/* Reading. */

bool tile_file_is(const uint8_t *head, size_t size) {
    return size >= sizeof magic && memcmp(head, magic, sizeof magic) == 0;
}

struct record {
    uint32_t kind;
    size_t size;
    const uint8_t *payload;
};

struct reader {
    const char *path;
    const struct tile_file *file;
    uint64_t size, at, records;
};

static bool wrong(const struct reader *reader, struct error *error, const char *what) {
    return error_set(error, ERROR_SCENE, "%s: is damaged: %s (record %llu, byte %llu)", reader->path, what,
                     (unsigned long long)reader->records, (unsigned long long)reader->at);
}

/* The next bytes, which are valid until the next call; NULL when they cannot be read. */
static const uint8_t *fetch(const struct reader *reader, size_t size) {
    const struct tile_file *file = reader->file;
    return file_source_read(&file->source, reader->at, file->buffer, size) ? file->buffer : NULL;
}

static bool next_record(struct reader *reader, struct record *out, struct error *error) {
    uint64_t left = reader->size - reader->at;
    struct byte_reader input = {left < RECORD_HEAD + RECORD_CHECK ? NULL : fetch(reader, RECORD_HEAD)};
    if (!input.at)
        return wrong(reader, error, "it ends too early");
    out->kind = get_u32(&input);
    uint32_t reserved = get_u32(&input);
    uint64_t size = get_u64(&input);
    if (size > PAYLOAD_LIMIT || reserved != 0)
        return wrong(reader, error, "a record has an impossible size");
    const uint8_t *whole =
        size > left - RECORD_HEAD - RECORD_CHECK ? NULL : fetch(reader, RECORD_HEAD + (size_t)size + RECORD_CHECK);
    if (!whole)
        return wrong(reader, error, "it ends too early");
    out->size = (size_t)size;
    out->payload = whole + RECORD_HEAD;
    input.at = out->payload + size;
    if (get_u64(&input) != check_of(reader->records, out->kind, out->payload, out->size))
        return wrong(reader, error, "the checksum of a record is wrong");
    reader->at += RECORD_HEAD + out->size + RECORD_CHECK;
    reader->records++;
    return true;
}

static bool get_name(struct byte_reader *input, const uint8_t *end, char name[TILE_FILE_NAME]) {
    size_t length = (size_t)(end - input->at);
    if (length == 0 || length >= TILE_FILE_NAME || memchr(input->at, '\0', length))
        return false;
    get(input, name, length);
    name[length] = '\0';
    return true;
}

static bool read_done(const struct reader *reader, const struct record *record, struct tile_done *out,
                      struct error *error) {
    struct byte_reader input = {record->payload};
    if (record->size < DONE_FIXED)
        return wrong(reader, error, "a finished picture is too short");
    out->number = get_u32(&input);
    out->key = get_key(&input);
    out->written = get_digest(&input);
    return get_name(&input, record->payload + record->size, out->name) ||
           wrong(reader, error, "a finished picture has an invalid name");
}

static bool is_part(const struct film_rectangle *part, const struct tile_picture *picture) {
    return part->x0 >= picture->x0 && part->x1 > part->x0 && part->x1 <= picture->x0 + picture->width &&
           part->y0 >= picture->y0 && part->y1 > part->y0 && part->y1 <= picture->y0 + picture->height;
}

static bool read_picture(const struct reader *reader, const struct record *record, struct tile_picture *out,
                         struct error *error) {
    struct byte_reader input = {record->payload};
    if (record->size < PICTURE_FIXED + settings_size())
        return wrong(reader, error, "the description of the picture is too short");
    out->number = get_u32(&input);
    out->key = get_key(&input);
    out->full_width = get_u32(&input);
    out->full_height = get_u32(&input);
    out->x0 = get_u32(&input);
    out->y0 = get_u32(&input);
    out->width = get_u32(&input);
    out->height = get_u32(&input);
    out->shown = get_rectangle(&input);
    out->record = get_film_record(&input);
    out->shard = get_u32(&input);
    out->shards = get_u32(&input);
    out->whole = get_u32(&input) != 0;
    /* The table of a tone curve follows the settings, if they have one. */
    bool settings_fit = get_settings(&input, &out->settings);
    if (out->settings.tone.curve == TONE_FUNCTION)
        settings_fit = record->size >= PICTURE_FIXED + settings_size() + TONE_TABLE_SIZE &&
                       get_table(&input, &out->tone_table) && settings_fit;
    /* Nothing in the file is trusted: later code computes sizes and indices from these numbers. */
    size_t bytes;
    struct error size_error;
    bool fits = out->full_width <= 1U << 20 && out->full_height <= 1U << 20 && out->x0 < out->full_width &&
                out->y0 < out->full_height && out->width <= out->full_width - out->x0 &&
                out->height <= out->full_height - out->y0 && film_record_valid(out->record) &&
                is_part(&out->shown, out) && film_size(out->width, out->height, out->record, &bytes, &size_error);
    if (!fits || !settings_fit || out->number == 0 || out->shard == 0 || out->shard > out->shards)
        return wrong(reader, error, "the description of the picture is invalid");
    return get_name(&input, record->payload + record->size, out->name) ||
           wrong(reader, error, "the picture has an invalid name");
}

/* A film of the picture's rectangle without any memory: enough to know its tiles. */
static struct film outline(const struct tile_picture *picture) {
    return (struct film){.width = picture->width,
                         .height = picture->height,
                         .x0 = picture->x0,
                         .y0 = picture->y0,
                         .full_width = picture->full_width,
                         .full_height = picture->full_height,
                         .record = picture->record};
}

static bool check_tile(const struct reader *reader, const struct tile_file *file, const struct record *record,
                       int64_t *last, struct error *error) {
    if (!file->has_picture)
        return wrong(reader, error, "a tile comes before its picture");
    struct byte_reader input = {record->payload};
    struct film film = outline(&file->picture);
    if (record->size < 4)
        return wrong(reader, error, "a tile is too short");
    uint32_t tile = get_u32(&input);
    if (tile >= film_tile_count(&film) || (int64_t)tile <= *last)
        return wrong(reader, error, "a tile is out of order");
    if (!film_tile_fits(&film, tile, input.at, record->size - 4))
        return wrong(reader, error, "a tile has a wrong size, or a colour that is not finite");
    *last = tile;
    return true;
}

static bool add_done(struct tile_file *file, const struct reader *reader, const struct record *record,
                     struct error *error) {
    if (file->done_count == DONE_LIMIT)
        return wrong(reader, error, "it has too many finished pictures");
    struct tile_done *more = mem_resize_array(file->done, file->done_count + 1, sizeof *more);
    if (!more)
        return error_no_memory(error, reader->path);
    file->done = more;
    if (!read_done(reader, record, &more[file->done_count], error))
        return false;
    file->done_count++;
    return true;
}

static bool read_records(struct tile_file *file, struct reader *reader, struct error *error) {
    int64_t last = -1;
    for (;;) {
        struct record record;
        uint64_t start = reader->at;
        if (!next_record(reader, &record, error))
            return false;
        bool ok = false;
        switch (record.kind) {
        case RECORD_DONE:
            ok = !file->has_picture ? add_done(file, reader, &record, error)
                                    : wrong(reader, error, "a finished picture is out of order");
            break;
        case RECORD_PICTURE:
            ok = !file->has_picture ? read_picture(reader, &record, &file->picture, error)
                                    : wrong(reader, error, "there are two pictures");
            file->has_picture = true;
            file->first_tile = reader->at;
            file->first_record = reader->records;
            break;
        case RECORD_TILE:
        case RECORD_BEGUN:
            ok = check_tile(reader, file, &record, &last, error);
            file->tiles++;
            break;
        /* The number of records shows that the file is whole. */
        case RECORD_END: {
            struct byte_reader input = {record.payload};
            if (record.size != 8 || get_u64(&input) != reader->records - 1)
                return wrong(reader, error, "records are missing");
            if (reader->at != reader->size)
                return wrong(reader, error, "data follow its end");
            return true;
        }
        default:
            reader->at = start;
            return wrong(reader, error, "a record has an unknown kind");
        }
        if (!ok)
            return false;
    }
}

static bool read_file(const char *path, uint64_t size, struct tile_file *out, struct error *error) {
    struct reader reader = {.path = path, .file = out, .size = size};
    struct byte_reader input = {size < sizeof magic + 8 ? NULL : fetch(&reader, sizeof magic + 8)};
    if (!input.at || memcmp(input.at, magic, sizeof magic) != 0)
        return error_set(error, ERROR_SCENE, "%s: is not a file of tiles", path);
    input.at += sizeof magic;
    if (get_u32(&input) != TILE_FILE_FORMAT || get_u32(&input) != FILM_TILE)
        return error_set(error, ERROR_SCENE, "%s: is a file of tiles in another format, of another version of gray",
                         path);
    reader.at = sizeof magic + 8;
    return read_records(out, &reader, error);
}

bool tile_file_read(const char *path, struct tile_file *out, struct error *error) {
    memset(out, 0, sizeof *out);
    out->buffer = mem_alloc(RECORD_HEAD + PAYLOAD_LIMIT + RECORD_CHECK);
    bool ok = out->buffer ? file_source_open(&out->source, path, error) : error_no_memory(error, path);
    ok = ok && read_file(path, out->source.size, out, error);
    if (!ok)
        tile_file_close(out);
    return ok;
}

void tile_file_close(struct tile_file *file) {
    file_source_close(&file->source);
    mem_free(file->buffer);
    mem_free(file->done);
    memset(file, 0, sizeof *file);
}

void tile_file_restore(const struct tile_file *file, struct film *film, uint32_t *restored, uint32_t *twice) {
    struct reader reader = {
        .path = "", .file = file, .size = UINT64_MAX, .at = file->first_tile, .records = file->first_record};
    int64_t last = -1;
    *restored = *twice = 0;
    for (size_t i = 0; i < file->tiles; i++) {
        struct record record;
        struct error changed;
        if (!next_record(&reader, &record, &changed) || (record.kind != RECORD_TILE && record.kind != RECORD_BEGUN) ||
            !check_tile(&reader, file, &record, &last, &changed))
            return;
        struct byte_reader input = {record.payload};
        uint32_t tile = get_u32(&input);
        if (atomic_load_explicit(&film->tiles[tile], memory_order_relaxed) == FILM_TILE_DONE)
            *twice += record.kind == RECORD_TILE;
        else if (record.kind == RECORD_TILE)
            *restored += film_tile_unpack(film, tile, input.at, record.size - 4);
        else if (film_tile_unpack(film, tile, input.at, record.size - 4))
            atomic_store_explicit(&film->tiles[tile], FILM_TILE_BEGUN, memory_order_release);
    }
}

const char *tile_key_difference(const struct tile_key *have, const struct tile_key *want) {
    if (strcmp(have->version, want->version) != 0)
        return "it was made by a different version of gray";
    if (!digest_equal(have->options, want->options))
        return "it was made with different options";
    if (!digest_equal(have->files, want->files))
        return "the scene, or a file it reads, has changed";
    return NULL;
}

const char *tile_picture_difference(const struct tile_picture *have, const struct tile_picture *want) {
    const char *difference = tile_key_difference(&have->key, &want->key);
    if (difference)
        return difference;
    if (have->number != want->number)
        return "it is of another picture of the run";
    if (have->full_width != want->full_width || have->full_height != want->full_height || have->x0 != want->x0 ||
        have->y0 != want->y0 || have->width != want->width || have->height != want->height ||
        !rectangles_equal(shown_of(have), shown_of(want)))
        return "it is of a picture of another size";
    if (!film_record_equal(have->record, want->record))
        return "its pixels have records of another size";
    if (have->shards != want->shards)
        return "the picture was divided differently";
    if (!settings_finish_equal(&have->settings, &want->settings) ||
        memcmp(&have->tone_table, &want->tone_table, sizeof have->tone_table) != 0)
        return "it is finished differently";
    return NULL;
}
