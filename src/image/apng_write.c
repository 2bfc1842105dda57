/* Writes APNG. A frame after the first one is the smallest rectangle that contains all changes; a frame without changes
 * is one pixel. Filters and compression are those of png_write.c, in one stream for each frame. */
#include "image/animation.h"

#include "base/mem.h"
#include "image/zlib_memory.h"

#include <stdlib.h>
#include <string.h>

enum { LEVEL = 5, SIDE_LIMIT = 0x7fffffff, BLEND_SOURCE = 0, DISPOSE_NONE = 0 };

struct rectangle {
    uint32_t x, y, width, height;
};

struct apng {
    const struct animation_source *source;
    struct file_output output;
    z_stream stream;
    uint8_t *frame, *before; /* this frame and the previous one */
    uint8_t *raw, *packed;
    size_t packed_room;
    uint32_t sequence; /* of fcTL and fdAT chunks */
};

static void put_word(uint8_t *out, uint32_t value) {
    out[0] = (uint8_t)(value >> 24);
    out[1] = (uint8_t)(value >> 16);
    out[2] = (uint8_t)(value >> 8);
    out[3] = (uint8_t)value;
}

enum { NUMBER_SIZE = 4 };

/* number: the four bytes at the start of the data of an fdAT chunk, or NULL. */
static bool write_chunk(struct apng *apng, const char *kind, const uint8_t *number, const uint8_t *bytes, size_t size,
                        struct error *error) {
    size_t before = number ? NUMBER_SIZE : 0;
    uint8_t head[8], tail[4];
    uLong crc = crc32_z(0, (const uint8_t *)kind, 4);
    crc = number ? crc32_z(crc, number, NUMBER_SIZE) : crc;
    crc = size > 0 ? crc32_z(crc, bytes, size) : crc;
    put_word(head, (uint32_t)(before + size));
    memcpy(head + 4, kind, 4);
    put_word(tail, (uint32_t)crc);
    return file_output_write(&apng->output, head, sizeof head, error) &&
           (!number || file_output_write(&apng->output, number, NUMBER_SIZE, error)) &&
           file_output_write(&apng->output, bytes, size, error) &&
           file_output_write(&apng->output, tail, sizeof tail, error);
}

static bool write_small(struct apng *apng, const char *kind, const uint8_t *bytes, size_t size, struct error *error) {
    return write_chunk(apng, kind, NULL, bytes, size, error);
}

static bool write_head(struct apng *apng, struct error *error) {
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}, intent = 0;
    const struct animation_source *source = apng->source;
    uint8_t header[13] = {[8] = 8, [9] = 2}, control[8];
    put_word(header, source->width);
    put_word(header + 4, source->height);
    put_word(control, source->count);
    put_word(control + 4, source->loops ? 0 : 1);
    return file_output_write(&apng->output, signature, sizeof signature, error) &&
           write_small(apng, "IHDR", header, sizeof header, error) &&
           (!source->srgb || write_small(apng, "sRGB", &intent, 1, error)) &&
           write_small(apng, "acTL", control, sizeof control, error);
}

static bool write_control(struct apng *apng, const struct rectangle *rectangle, struct error *error) {
    struct frame_rate rate = frame_rate_fraction(apng->source->rate);
    while (rate.over > UINT16_MAX || rate.under > UINT16_MAX) { /* less exact, in 16 bits */
        rate.over = (rate.over + 5) / 10;
        rate.under = (rate.under + 5) / 10;
    }
    uint8_t control[26] = {[24] = DISPOSE_NONE, [25] = BLEND_SOURCE};
    put_word(control, apng->sequence++);
    put_word(control + 4, rectangle->width);
    put_word(control + 8, rectangle->height);
    put_word(control + 12, rectangle->x);
    put_word(control + 16, rectangle->y);
    put_word(control + 20, (rate.under > 0 ? rate.under : 1) << 16 | rate.over);
    return write_small(apng, "fcTL", control, sizeof control, error);
}

static struct rectangle changes(const struct apng *apng) {
    uint32_t width = apng->source->width, height = apng->source->height;
    uint32_t left = width, right = 0, top = height, bottom = 0;
    for (uint32_t y = 0; y < height; y++) {
        const uint8_t *a = apng->frame + (size_t)y * width * 3, *b = apng->before + (size_t)y * width * 3;
        if (memcmp(a, b, (size_t)width * 3) == 0)
            continue;
        uint32_t from = 0, to = width;
        while (memcmp(a + 3 * (size_t)from, b + 3 * (size_t)from, 3) == 0)
            from++;
        while (memcmp(a + 3 * (size_t)(to - 1), b + 3 * (size_t)(to - 1), 3) == 0)
            to--;
        left = from < left ? from : left;
        right = to > right ? to : right;
        top = y < top ? y : top;
        bottom = y + 1;
    }
    if (bottom == 0)
        return (struct rectangle){0, 0, 1, 1};
    return (struct rectangle){left, top, right - left, bottom - top};
}

/* Chooses the filter, Sub or Up, with the smaller sum of differences. */
static void filter_row(const uint8_t *row, const uint8_t *above, size_t size, uint8_t *out) {
    uint64_t sub = 0, up = 0;
    for (size_t i = 0; i < size && above; i++) {
        sub += (unsigned)abs((int8_t)(row[i] - (i < 3 ? 0 : row[i - 3])));
        up += (unsigned)abs((int8_t)(row[i] - above[i]));
    }
    bool takes_sub = !above || sub <= up;
    *out++ = takes_sub ? 1 : 2;
    for (size_t i = 0; i < size; i++)
        out[i] = (uint8_t)(row[i] - (!takes_sub ? above[i] : i < 3 ? 0 : row[i - 3]));
}

static size_t pack(struct apng *apng, const struct rectangle *rectangle) {
    size_t row_size = (size_t)rectangle->width * 3, stride = (size_t)apng->source->width * 3;
    for (uint32_t y = 0; y < rectangle->height; y++) {
        const uint8_t *row = apng->frame + (rectangle->y + y) * stride + (size_t)rectangle->x * 3;
        filter_row(row, y > 0 ? row - stride : NULL, row_size, apng->raw + y * (row_size + 1));
    }
    z_stream *stream = &apng->stream;
    (void)deflateReset(stream);
    stream->next_in = apng->raw;
    stream->avail_in = (uInt)((row_size + 1) * rectangle->height);
    stream->next_out = apng->packed;
    stream->avail_out = (uInt)apng->packed_room;
    (void)deflate(stream, Z_FINISH);
    return apng->packed_room - stream->avail_out;
}

static bool write_frame(struct apng *apng, uint32_t index, struct error *error) {
    const struct animation_source *source = apng->source;
    struct rectangle rectangle = {0, 0, source->width, source->height};
    if (!source->frame(source->context, index, apng->frame, error))
        return false;
    if (index > 0)
        rectangle = changes(apng);
    size_t size = pack(apng, &rectangle);
    uint8_t number[NUMBER_SIZE];
    if (!write_control(apng, &rectangle, error))
        return false;
    if (index > 0)
        put_word(number, apng->sequence++);
    bool ok = index == 0 ? write_small(apng, "IDAT", apng->packed, size, error)
                         : write_chunk(apng, "fdAT", number, apng->packed, size, error);
    uint8_t *other = apng->before;
    apng->before = apng->frame;
    apng->frame = other;
    return ok;
}

static bool begin(struct apng *apng) {
    const struct animation_source *source = apng->source;
    size_t size = (size_t)source->width * source->height * 3, raw = size + source->height;
    apng->stream = (z_stream){.zalloc = zlib_alloc, .zfree = zlib_free};
    apng->frame = mem_alloc(size);
    apng->before = mem_alloc(size);
    apng->raw = mem_alloc(raw);
    if (!apng->frame || !apng->before || !apng->raw || deflateInit(&apng->stream, LEVEL) != Z_OK)
        return false;
    apng->packed_room = (size_t)deflateBound(&apng->stream, (uLong)raw);
    apng->packed = mem_alloc(apng->packed_room);
    return apng->packed != NULL;
}

static void end(struct apng *apng) {
    if (apng->stream.state)
        (void)deflateEnd(&apng->stream);
    mem_free(apng->frame);
    mem_free(apng->before);
    mem_free(apng->raw);
    mem_free(apng->packed);
}

bool apng_write(const struct file_target *target, const struct animation_source *source, struct error *error) {
    struct apng apng = {.source = source};
    if ((uint64_t)source->width * source->height > SIDE_LIMIT / 4)
        return error_set(error, ERROR_SCENE, "%.600s: an APNG file cannot have %u x %u pixels", target->path,
                         source->width, source->height);
    if (!file_output_open(&apng.output, target, error))
        return false;
    bool ok = begin(&apng) ? write_head(&apng, error) : error_no_memory(error, target->path);
    for (uint32_t index = 0; ok && index < source->count; index++)
        ok = write_frame(&apng, index, error);
    ok = ok && write_small(&apng, "IEND", NULL, 0, error);
    end(&apng);
    if (ok)
        return file_output_commit(&apng.output, error);
    file_output_abandon(&apng.output);
    return false;
}
