/* The file: a head, the views one after the other, their table, and the place of the table. It is written from front to
 * back, and read view by view. Numbers are little-endian.
 *
 * A view is a stream of zlib. In it, each channel is four planes of bytes, the highest first, and each byte is the
 * difference to the byte before it in its row: neighbouring pixels have the same exponents, so most bytes are 0. */
#include "image/light_field.h"

#include "base/bytes.h"
#include "base/mem.h"
#include "image/zlib_memory.h"
#include "math/portable.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <string.h>

static const char magic[8] = "GRAYLF\x1a\n";

enum {
    VERSION = 1,
    HAS_DEPTH = 1,
    HAS_SRGB = 2,
    WHOLE = 7, /* numbers of the head */
    NUMBERS = 4,
    HEAD_SIZE = 8 + 4 * WHOLE + 8 * NUMBERS,
    TABLE_OF_TONE = 4 * TONE_ENTRIES,
    ENTRY_SIZE = 8, /* the size of a view */
    TAIL_SIZE = 16, /* the place of the table, its CRC-32 and the first half of the magic word */
    SIDE_LIMIT = 1 << 20,
    GRID_LIMIT = 1024,
    COLOURS = 3,
    RATIO_LIMIT = 1100,  /* zlib makes no stream shorter than by a factor of 1032 */
    LEVEL = 5,           /* of zlib */
    VIEW_LIMIT = 1 << 28 /* pixels */
};

static uint32_t channels_of(const struct light_field_head *head) {
    return COLOURS + (uint32_t)head->depth;
}

static size_t raw_size(const struct light_field_head *head) {
    return (size_t)head->width * head->height * channels_of(head) * 4;
}

/* --- a row of a view as bytes --- */

/* `bytes`: where the highest byte of the row is; the others are a plane apart each. */
static void split_row(const float *values, uint32_t stride, uint32_t width, size_t plane, uint8_t *bytes) {
    uint32_t before = 0;
    for (uint32_t x = 0; x < width; x++) {
        uint32_t bits;
        memcpy(&bits, &values[(size_t)x * stride], sizeof bits);
        for (int k = 0; k < 4; k++) {
            int shift = 24 - 8 * k;
            bytes[(size_t)k * plane + x] = (uint8_t)((bits >> shift) - (before >> shift));
        }
        before = bits;
    }
}

static void join_row(const uint8_t *bytes, size_t plane, uint32_t width, float *values, uint32_t stride) {
    uint8_t now[4] = {0};
    for (uint32_t x = 0; x < width; x++) {
        uint32_t bits = 0;
        for (int k = 0; k < 4; k++) {
            now[k] = (uint8_t)(now[k] + bytes[(size_t)k * plane + x]);
            bits = bits << 8 | now[k];
        }
        memcpy(&values[(size_t)x * stride], &bits, sizeof bits);
    }
}

/* --- writing --- */

/* The views of a row of the grid. */
struct packing {
    const struct light_field_head *head;
    float *colours, *depths; /* rows of the grid, three numbers a pixel */
    uint8_t *raw, *packed;   /* of each worker; of each view */
    uint64_t *sizes;         /* of each view */
    size_t room;             /* of a packed view */
    _Atomic bool failed;
};

static void pack_view(void *context, uint32_t column, int worker) {
    struct packing *p = context;
    const struct light_field_head *head = p->head;
    size_t plane = (size_t)head->width * head->height, line = (size_t)head->columns * head->width * COLOURS;
    uint8_t *raw = p->raw + (size_t)worker * raw_size(head);
    for (uint32_t channel = 0; channel < channels_of(head); channel++) {
        const float *from = channel < COLOURS ? p->colours + channel : p->depths;
        for (uint32_t y = 0; y < head->height; y++)
            split_row(from + y * line + (size_t)column * head->width * COLOURS, COLOURS, head->width, plane,
                      raw + channel * 4 * plane + (size_t)y * head->width);
    }
    z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
    bool ok = deflateInit(&stream, LEVEL) == Z_OK;
    if (ok) {
        stream.next_in = raw;
        stream.avail_in = (uInt)raw_size(head);
        stream.next_out = p->packed + column * p->room;
        stream.avail_out = (uInt)p->room;
        ok = deflate(&stream, Z_FINISH) == Z_STREAM_END;
        p->sizes[column] = stream.total_out;
        (void)deflateEnd(&stream);
    }
    if (!ok)
        atomic_store(&p->failed, true);
}

/* The tone curve as well. */
static bool write_head(struct file_output *file, const struct light_field_head *head, struct error *error) {
    const uint32_t flags = (head->depth ? HAS_DEPTH : 0) | (head->tone.srgb ? HAS_SRGB : 0);
    const uint32_t whole[WHOLE] = {VERSION,      head->columns, head->rows,      head->width,
                                   head->height, flags,         head->tone.curve};
    const double numbers[NUMBERS] = {head->spacing, head->screen, head->fov, head->tone.exposure};
    uint8_t bytes[HEAD_SIZE + TABLE_OF_TONE], *at = bytes + sizeof magic;
    memcpy(bytes, magic, sizeof magic);
    for (int i = 0; i < WHOLE; i++)
        bytes_put(&at, whole[i], 4);
    for (int i = 0; i < NUMBERS; i++)
        bytes_put_number(&at, numbers[i]);
    for (int i = 0; i < TONE_ENTRIES && head->tone.curve == TONE_FUNCTION; i++) {
        uint32_t bits;
        memcpy(&bits, &head->tone.table->values[i], sizeof bits);
        bytes_put(&at, bits, 4);
    }
    return file_output_write(file, bytes, (size_t)(at - bytes), error);
}

/* Reads the rows of a row of the grid and packs its views. */
static bool pack_row(struct packing *p, const struct picture_source *source, uint32_t row, struct pool *pool) {
    const struct light_field_head *head = p->head;
    size_t line = (size_t)head->columns * head->width * COLOURS;
    for (uint32_t y = 0; y < head->height; y++) {
        source->light(source->context, row * head->height + y, p->colours + y * line);
        if (head->depth)
            source->light(source->context, (head->rows + row) * head->height + y, p->depths + y * line);
    }
    bool ok = true;
    for (uint32_t i = 0; i < head->columns && !pool; i++)
        pack_view(p, i, 0);
    if (pool)
        ok = pool_run(pool, head->columns, pack_view, p);
    return ok;
}

static bool write_views(struct file_output *file, struct packing *p, const struct picture_source *source,
                        struct pool *pool, struct error *error) {
    const struct light_field_head *head = p->head;
    uint64_t at = HEAD_SIZE + (head->tone.curve == TONE_FUNCTION ? TABLE_OF_TONE : 0);
    size_t size = (size_t)head->columns * head->rows * ENTRY_SIZE;
    uint8_t *table = mem_alloc(size + TAIL_SIZE), *entry = table;
    bool ok = table || error_no_memory(error, "a light field");
    for (uint32_t row = 0; ok && row < head->rows; row++) {
        if (!pack_row(p, source, row, pool))
            ok = error_set(error, ERROR_CANCELLED, "interrupted");
        else if (atomic_load(&p->failed))
            ok = error_no_memory(error, "a light field");
        for (uint32_t i = 0; ok && i < head->columns; i++) {
            bytes_put(&entry, p->sizes[i], 8);
            at += p->sizes[i];
            ok = file_output_write(file, p->packed + i * p->room, (size_t)p->sizes[i], error);
        }
    }
    if (ok) {
        bytes_put(&entry, at, 8);
        bytes_put(&entry, crc32(0, table, (uInt)size), 4);
        memcpy(entry, magic, 4);
        ok = file_output_write(file, table, size + TAIL_SIZE, error);
    }
    mem_free(table);
    return ok;
}

bool light_field_write(const struct file_target *target, const struct picture_source *source, struct pool *pool,
                       struct error *error) {
    const struct light_field_head single = {
        .columns = 1, .rows = 1, .width = source->width, .height = source->height, .screen = 1, .fov = LIGHT_FIELD_FOV};
    struct packing p = {.head = source->field ? source->field : &single};
    struct file_output file;
    if ((uint64_t)p.head->width * p.head->height > VIEW_LIMIT / 4)
        return error_set(error, ERROR_SCENE, "%s: a view of a light field has at most 2^26 pixels", target->path);
    const size_t line = (size_t)p.head->columns * p.head->width * COLOURS,
                 workers = pool ? (size_t)pool_workers(pool) : 1;
    p.room = compressBound((uLong)raw_size(p.head));
    p.colours = mem_alloc_zero(line * p.head->height, sizeof *p.colours);
    p.depths = mem_alloc_zero(p.head->depth ? line * p.head->height : 1, sizeof *p.depths);
    p.raw = mem_alloc(workers * raw_size(p.head));
    p.packed = mem_alloc(p.head->columns * p.room);
    p.sizes = mem_alloc_zero(p.head->columns, sizeof *p.sizes);
    bool ok = (p.colours && p.depths && p.raw && p.packed && p.sizes) || error_no_memory(error, target->path);
    if (ok) {
        ok = file_output_open(&file, target, error);
        if (ok && write_head(&file, p.head, error) && write_views(&file, &p, source, pool, error))
            ok = file_output_commit(&file, error);
        else if (ok)
            file_output_abandon(&file), ok = false;
    }
    mem_free(p.raw);
    mem_free(p.packed);
    mem_free(p.colours);
    mem_free(p.depths);
    mem_free(p.sizes);
    return ok;
}

/* --- reading --- */

bool light_field_is(const uint8_t *head, size_t size) {
    return size >= sizeof magic && memcmp(head, magic, sizeof magic) == 0;
}

static bool wrong(const struct light_field *field, const char *what, struct error *error) {
    return error_set(error, ERROR_SCENE, "%s: is damaged: %s", field->path, what);
}

static bool is_positive(double x) {
    return isfinite(x) && x > 0;
}

static bool read_head(struct light_field *field, struct error *error) {
    uint8_t bytes[HEAD_SIZE];
    const uint8_t *at = bytes + sizeof magic;
    struct light_field_head *head = &field->head;
    uint32_t whole[WHOLE];
    double numbers[NUMBERS];
    if (!file_source_read(&field->source, 0, bytes, sizeof magic) || !light_field_is(bytes, sizeof magic))
        return error_set(error, ERROR_SCENE, "%s: is no light field", field->path);
    if (!file_source_read(&field->source, 0, bytes, sizeof bytes))
        return wrong(field, "it ends too early", error);
    for (int i = 0; i < WHOLE; i++)
        whole[i] = (uint32_t)bytes_get(&at, 4);
    for (int i = 0; i < NUMBERS; i++)
        numbers[i] = bytes_get_number(&at);
    if (whole[0] != VERSION)
        return error_set(error, ERROR_SCENE, "%s: is a light field of version %u, and gray reads version %d",
                         field->path, whole[0], VERSION);
    const uint32_t flags = whole[5], curve = whole[6];
    *head = (struct light_field_head){
        whole[1],   whole[2],          whole[3],
        whole[4],   flags & HAS_DEPTH, numbers[0],
        numbers[1], numbers[2],        {numbers[3], (enum tone_curve)curve, flags & HAS_SRGB, NULL}};
    bool sizes = head->columns >= 1 && head->columns <= GRID_LIMIT && head->rows >= 1 && head->rows <= GRID_LIMIT &&
                 head->width >= 1 && head->width <= SIDE_LIMIT && head->height >= 1 && head->height <= SIDE_LIMIT &&
                 (uint64_t)head->width * head->height <= VIEW_LIMIT / 4;
    bool possible = is_positive(head->screen) && is_positive(head->fov) && head->fov < 180 && isfinite(head->spacing) &&
                    head->spacing >= 0 && fabs(head->tone.exposure) <= 1000;
    if (!sizes || !possible || flags > (HAS_DEPTH | HAS_SRGB) || curve > TONE_FUNCTION)
        return wrong(field, "its head has an impossible number", error);
    return true;
}

static bool read_tone(struct light_field *field, struct error *error) {
    uint8_t bytes[TABLE_OF_TONE];
    const uint8_t *at = bytes;
    if (field->head.tone.curve != TONE_FUNCTION)
        return true;
    if (!file_source_read(&field->source, HEAD_SIZE, bytes, sizeof bytes))
        return wrong(field, "it ends too early", error);
    for (int i = 0; i < TONE_ENTRIES; i++) {
        uint32_t bits = (uint32_t)bytes_get(&at, 4);
        memcpy(&field->table.values[i], &bits, sizeof bits);
        if (!isfinite(field->table.values[i]))
            return wrong(field, "its tone curve has an impossible number", error);
    }
    field->head.tone.table = &field->table;
    return true;
}

/* The table is at the end, so a file that is cut has none. */
static bool read_table(struct light_field *field, struct error *error) {
    const struct light_field_head *head = &field->head;
    size_t count = (size_t)head->columns * head->rows, size = count * ENTRY_SIZE;
    uint64_t first = HEAD_SIZE + (head->tone.curve == TONE_FUNCTION ? TABLE_OF_TONE : 0), end = field->source.size;
    uint8_t tail[TAIL_SIZE];
    const uint8_t *at = tail;
    if (end < first + size + TAIL_SIZE || !file_source_read(&field->source, end - TAIL_SIZE, tail, sizeof tail))
        return wrong(field, "it ends too early", error);
    uint64_t table = bytes_get(&at, 8);
    uint32_t check = (uint32_t)bytes_get(&at, 4);
    if (table != end - TAIL_SIZE - size || memcmp(at, magic, 4) != 0)
        return wrong(field, "it has no table of its views", error);
    uint8_t *bytes = mem_alloc(size);
    field->entries = mem_alloc_zero(count, sizeof *field->entries);
    field->views = mem_alloc_zero(count, sizeof *field->views);
    bool ok = (bytes && field->entries && field->views) || error_no_memory(error, field->path);
    ok = ok && (file_source_read(&field->source, table, bytes, size) || wrong(field, "it ends too early", error));
    ok = ok && (crc32(0, bytes, (uInt)size) == check || wrong(field, "the checksum of its table is wrong", error));
    at = bytes;
    /* The views lie one after the other: a file cannot show its bytes twice. */
    for (size_t i = 0; ok && i < count; i++) {
        struct light_field_entry *entry = &field->entries[i];
        entry->at = first;
        entry->size = bytes_get(&at, 8);
        ok = (entry->size <= table - first && raw_size(head) / RATIO_LIMIT <= entry->size) ||
             wrong(field, "a view has an impossible size", error);
        first += ok ? entry->size : 0;
    }
    ok = ok && (first == table || wrong(field, "its views have other sizes than its table says", error));
    mem_free(bytes);
    return ok;
}

bool light_field_open(struct light_field *field, const char *path, struct error *error) {
    *field = (struct light_field){.path = path};
    bool ok = file_source_open(&field->source, path, error) && read_head(field, error) && read_tone(field, error) &&
              read_table(field, error);
    if (!ok)
        light_field_close(field);
    return ok;
}

void light_field_close(struct light_field *field) {
    size_t count = (size_t)field->head.columns * field->head.rows;
    for (size_t i = 0; field->views && i < count; i++)
        mem_free(field->views[i]);
    mem_free(field->views);
    mem_free(field->entries);
    file_source_close(&field->source);
    *field = (struct light_field){0};
}

/* Unpacks a stream that must have exactly that size. */
static bool unpack(const uint8_t *packed, size_t size, uint8_t *raw, size_t wanted) {
    z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
    if (inflateInit(&stream) != Z_OK)
        return false;
    stream.next_in = packed;
    stream.avail_in = (uInt)size;
    stream.next_out = raw;
    stream.avail_out = (uInt)wanted;
    bool ok = inflate(&stream, Z_FINISH) == Z_STREAM_END && stream.total_out == wanted && stream.avail_in == 0;
    (void)inflateEnd(&stream);
    return ok;
}

static bool load_view(struct light_field *field, uint32_t view, struct error *error) {
    const struct light_field_head *head = &field->head;
    struct light_field_entry *entry = &field->entries[view];
    size_t plane = (size_t)head->width * head->height, raw_bytes = raw_size(head);
    if (field->views[view])
        return true;
    if (entry->size > compressBound((uLong)raw_bytes))
        return wrong(field, "a view has an impossible size", error);
    uint8_t *packed = mem_alloc((size_t)entry->size), *raw = mem_alloc(raw_bytes);
    float *values = mem_alloc_zero(plane, LIGHT_FIELD_NUMBERS * sizeof *values);
    bool ok = (packed && raw && values) || error_no_memory(error, field->path);
    ok = ok && (file_source_read(&field->source, entry->at, packed, (size_t)entry->size) ||
                wrong(field, "it ends too early", error));
    ok =
        ok && (unpack(packed, (size_t)entry->size, raw, raw_bytes) || wrong(field, "a view cannot be unpacked", error));
    for (uint32_t channel = 0; ok && channel < channels_of(head); channel++)
        for (uint32_t y = 0; y < head->height; y++)
            join_row(raw + channel * 4 * plane + (size_t)y * head->width, plane, head->width,
                     values + (size_t)y * head->width * LIGHT_FIELD_NUMBERS + channel, LIGHT_FIELD_NUMBERS);
    for (size_t i = 0; ok && i < plane * LIGHT_FIELD_NUMBERS; i++)
        ok = isfinite(values[i]) || wrong(field, "a view has a number that is not finite", error);
    mem_free(packed);
    mem_free(raw);
    if (!ok) {
        mem_free(values);
        return false;
    }
    entry->farthest = INFINITY;
    /* Depths become their reciprocals. */
    for (size_t i = 0; i < plane; i++) {
        float *last = values + i * LIGHT_FIELD_NUMBERS + COLOURS;
        *last = *last > 0 ? (float)math_min(1 / (double)*last, (double)FLT_MAX) : 0;
        entry->nearest = math_max(entry->nearest, (double)*last);
        entry->farthest = math_min(entry->farthest, (double)*last);
    }
    field->views[view] = values;
    return true;
}

struct loading {
    struct light_field *field;
    const struct light_field_part *part;
    _Atomic bool failed;
    struct error *error; /* of the first view that failed */
};

static void load_item(void *context, uint32_t item, int worker) {
    struct loading *l = context;
    uint32_t column = l->part->column + item % l->part->columns, row = l->part->row + item / l->part->columns;
    struct error error;
    (void)worker;
    if (!load_view(l->field, row * l->field->head.columns + column, &error) && !atomic_exchange(&l->failed, true))
        *l->error = error;
}

bool light_field_load_part(struct light_field *field, const struct light_field_part *part, struct pool *pool,
                           struct error *error) {
    struct loading l = {.field = field, .part = part, .error = error};
    return (pool_run(pool, part->columns * part->rows, load_item, &l) ||
            error_set(error, ERROR_CANCELLED, "interrupted")) &&
           !atomic_load(&l.failed);
}
