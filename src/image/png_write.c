/* Writing PNG. The rows are divided into stripes of about 64 kB. Each is filtered and deflated separately, so that all
 * threads of a pool can work on one picture, and ends on a byte boundary (a sync flush), so that the concatenated
 * stripes are one zlib stream (RFC 1950, 1951; as in pigz). The first row of a stripe does not refer to the row above.
 * Stripes depend only on the size of the picture, and the file contains no time: the bytes are the same for any number
 * of threads. */
#include "image/png_write.h"

#include "base/mem.h"
#include "image/zlib_memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Measured on a picture of 1280 x 960 of spheres over a floor (size, time of one core): level 6 as one stream 529 kB in
 * 0.079 s; in stripes level 6 553 kB in 0.068 s, 5 564 kB in 0.050 s, 4 577 kB in 0.040 s, 1 635 kB in 0.027 s. */
enum { LEVEL = 5, WINDOW = -15, MEMORY_LEVEL = 9, STRIPE = 1 << 16, IN_FLIGHT = 4, SIDE_LIMIT = 0x7fffffff };

struct stripe {
    uint8_t *bytes;
    size_t size;
    uint32_t crc, adler; /* checksums: of the chunk's kind and these bytes; of the uncompressed data */
    size_t raw;          /* size of the uncompressed data */
};

/* Memory of one worker. */
struct packer {
    z_stream stream;
    bool begun;
    uint16_t *words;
    uint8_t *row, *above;
    uint8_t *filtered;
};

struct text_writer {
    const struct png_source *rows;
    size_t row_bytes, stripe_bytes, packed_limit;
    uint32_t stripe_rows, stripe_count, first; /* number of the first one in flight */
    int workers, in_flight;
    struct packer *packers;
    struct stripe *stripes; /* in flight */
    png_sink *put;
    void *sink;
    uint32_t adler;
};

static void fetch_row(const struct text_writer *writer, struct packer *packer, uint32_t y) {
    const struct png_source *rows = writer->rows;
    if (rows->bytes) {
        rows->bytes(rows->context, y, packer->row);
        return;
    }
    rows->words(rows->context, y, packer->words);
    for (size_t i = 0; i < writer->row_bytes / 2; i++) { /* the upper byte comes first */
        packer->row[2 * i] = (uint8_t)(packer->words[i] >> 8);
        packer->row[2 * i + 1] = (uint8_t)packer->words[i];
    }
}

static unsigned size_of(uint8_t difference) {
    return (unsigned)abs((int8_t)difference);
}

/* Chooses the filter, Sub or Up, with the smaller sum of differences (the heuristic of the standard). */
static void filter_row(const struct text_writer *writer, const struct packer *packer, bool has_above, uint8_t *out) {
    const uint8_t *row = packer->row, *above = packer->above;
    size_t pixel = writer->row_bytes / writer->rows->width, size = writer->row_bytes;
    uint64_t sub = 0, up = 0;
    for (size_t i = pixel; i < size && has_above; i++)
        sub += size_of((uint8_t)(row[i] - row[i - pixel]));
    for (size_t i = 0; i < pixel; i++)
        sub += size_of(row[i]);
    for (size_t i = 0; i < size && has_above; i++)
        up += size_of((uint8_t)(row[i] - above[i]));
    bool takes_sub = !has_above || sub <= up;
    *out++ = takes_sub ? 1 : 2;
    for (size_t i = 0; i < size; i++)
        out[i] = (uint8_t)(row[i] - (!takes_sub ? above[i] : i < pixel ? 0 : row[i - pixel]));
}

static void pack_stripe(void *context, uint32_t item, int index) {
    struct text_writer *writer = context;
    struct packer *packer = &writer->packers[index];
    struct stripe *stripe = &writer->stripes[item];
    uint32_t number = writer->first + item, height = writer->rows->height;
    uint32_t from = number * writer->stripe_rows;
    uint32_t to = height - from > writer->stripe_rows ? from + writer->stripe_rows : height;
    for (uint32_t y = from; y < to; y++) {
        fetch_row(writer, packer, y);
        filter_row(writer, packer, y > from, packer->filtered + (y - from) * (writer->row_bytes + 1));
        uint8_t *other = packer->above;
        packer->above = packer->row;
        packer->row = other;
    }
    /* A stripe ends at a byte and refers to nothing before it, so stripes are packed in any order. */
    z_stream *stream = &packer->stream;
    stripe->raw = (to - from) * (writer->row_bytes + 1);
    stripe->adler = (uint32_t)adler32_z(1, packer->filtered, stripe->raw);
    (void)deflateReset(stream);
    stream->next_in = packer->filtered;
    stream->avail_in = (uInt)stripe->raw;
    stream->next_out = stripe->bytes;
    stream->avail_out = (uInt)writer->packed_limit;
    (void)deflate(stream, number + 1 == writer->stripe_count ? Z_FINISH : Z_SYNC_FLUSH);
    stripe->size = writer->packed_limit - stream->avail_out;
    stripe->crc = (uint32_t)crc32_z(crc32_z(0, (const uint8_t *)"IDAT", 4), stripe->bytes, stripe->size);
}

static void put_word(uint8_t *out, uint32_t value) {
    out[0] = (uint8_t)(value >> 24);
    out[1] = (uint8_t)(value >> 16);
    out[2] = (uint8_t)(value >> 8);
    out[3] = (uint8_t)value;
}

static bool write_chunk(struct text_writer *writer, const char *kind, const uint8_t *bytes, size_t size, uint32_t crc,
                        struct error *error) {
    uint8_t head[8], tail[4];
    put_word(head, (uint32_t)size);
    memcpy(head + 4, kind, 4);
    put_word(tail, crc);
    return writer->put(writer->sink, head, sizeof head, error) && writer->put(writer->sink, bytes, size, error) &&
           writer->put(writer->sink, tail, sizeof tail, error);
}

static bool write_small(struct text_writer *writer, const char *kind, const uint8_t *bytes, size_t size,
                        struct error *error) {
    uint32_t crc = (uint32_t)crc32_z(crc32_z(0, (const uint8_t *)kind, 4), bytes, size);
    return write_chunk(writer, kind, bytes, size, crc, error);
}

/* A text chunk (keyword, zero, text), the first one after the header of 33 bytes. */
static const char unfinished[] = "Comment\0unfinished picture of gray";

bool png_is_unfinished(const uint8_t *head, size_t size) {
    return size >= 41 + sizeof unfinished - 1 && memcmp(head + 37, "tEXt", 4) == 0 &&
           memcmp(head + 41, unfinished, sizeof unfinished - 1) == 0;
}

static bool write_head(struct text_writer *writer, struct error *error) {
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    static const uint8_t stream_head[2] = {0x78, 0x5e}; /* deflate, a window of 32 kB, a fast level (RFC 1950) */
    static const uint8_t intent = 0;                    /* perceptual */
    uint8_t header[13] = {[8] = writer->rows->words ? 16 : 8, [9] = writer->rows->alpha ? 6 : 2 /* red, green, blue */};
    put_word(header, writer->rows->width);
    put_word(header + 4, writer->rows->height);
    return writer->put(writer->sink, signature, sizeof signature, error) &&
           write_small(writer, "IHDR", header, sizeof header, error) &&
           (!writer->rows->unfinished ||
            write_small(writer, "tEXt", (const uint8_t *)unfinished, sizeof unfinished - 1, error)) &&
           (!writer->rows->srgb || write_small(writer, "sRGB", &intent, 1, error)) &&
           write_small(writer, "IDAT", stream_head, sizeof stream_head, error);
}

static bool write_tail(struct text_writer *writer, struct error *error) {
    uint8_t sum[4];
    put_word(sum, writer->adler);
    return write_small(writer, "IDAT", sum, sizeof sum, error) && write_small(writer, "IEND", sum, 0, error);
}

static bool encode(struct text_writer *writer, struct pool *pool, struct error *error) {
    if (!write_head(writer, error))
        return false;
    writer->adler = 1;
    while (writer->first < writer->stripe_count) {
        uint32_t left = writer->stripe_count - writer->first;
        uint32_t count = left < (uint32_t)writer->in_flight ? left : (uint32_t)writer->in_flight;
        if (!pool)
            pack_stripe(writer, 0, 0);
        else if (!pool_run(pool, count, pack_stripe, writer))
            return error_set(error, ERROR_CANCELLED, "stopped while writing");
        for (uint32_t i = 0; i < count; i++) {
            const struct stripe *stripe = &writer->stripes[i];
            writer->adler = (uint32_t)adler32_combine(writer->adler, stripe->adler, (z_off_t)stripe->raw);
            if (!write_chunk(writer, "IDAT", stripe->bytes, stripe->size, stripe->crc, error))
                return false;
        }
        writer->first += count;
    }
    return write_tail(writer, error);
}

static bool begin_packer(const struct text_writer *writer, struct packer *packer) {
    packer->stream = (z_stream){.zalloc = zlib_alloc, .zfree = zlib_free};
    packer->words = writer->rows->words ? mem_alloc_zero(writer->row_bytes / 2, sizeof *packer->words) : NULL;
    packer->row = mem_alloc(writer->row_bytes);
    packer->above = mem_alloc(writer->row_bytes);
    packer->filtered = mem_alloc(writer->stripe_bytes);
    packer->begun = deflateInit2(&packer->stream, LEVEL, Z_DEFLATED, WINDOW, MEMORY_LEVEL, Z_DEFAULT_STRATEGY) == Z_OK;
    return (packer->words || !writer->rows->words) && packer->row && packer->above && packer->filtered && packer->begun;
}

/* Allocates everything before any thread works. */
static bool begin(struct text_writer *writer) {
    writer->packers = mem_alloc_zero((size_t)writer->workers, sizeof *writer->packers);
    writer->stripes = mem_alloc_zero((size_t)writer->in_flight, sizeof *writer->stripes);
    bool ok = writer->packers && writer->stripes;
    for (int i = 0; ok && i < writer->workers; i++)
        ok = begin_packer(writer, &writer->packers[i]);
    if (!ok)
        return false;
    /* The bound of deflate for a whole stream, plus the flush marker. */
    writer->packed_limit = (size_t)deflateBound(&writer->packers[0].stream, (uLong)writer->stripe_bytes) + 64;
    for (int i = 0; ok && i < writer->in_flight; i++)
        ok = (writer->stripes[i].bytes = mem_alloc(writer->packed_limit)) != NULL;
    return ok;
}

static void end(struct text_writer *writer) {
    for (int i = 0; writer->packers && i < writer->workers; i++) {
        struct packer *packer = &writer->packers[i];
        if (packer->begun)
            (void)deflateEnd(&packer->stream);
        mem_free(packer->words);
        mem_free(packer->row);
        mem_free(packer->above);
        mem_free(packer->filtered);
    }
    for (int i = 0; writer->stripes && i < writer->in_flight; i++)
        mem_free(writer->stripes[i].bytes);
    mem_free(writer->packers);
    mem_free(writer->stripes);
}

static uint32_t rows_of_stripe(size_t row_bytes) {
    return row_bytes + 1 < STRIPE ? (uint32_t)(STRIPE / (row_bytes + 1)) : 1;
}

uint32_t png_write_stripes(uint32_t width, uint32_t height, int bits) {
    return (height - 1) / rows_of_stripe((size_t)width * 3 * (size_t)bits / 8) + 1;
}

static struct text_writer writer_for(const struct png_source *rows, const struct pool *pool) {
    struct text_writer writer = {.rows = rows,
                                 .row_bytes = (size_t)rows->width * (rows->alpha ? 4 : 3) * (rows->words ? 2 : 1)};
    writer.stripe_rows = rows_of_stripe(writer.row_bytes);
    writer.stripe_count = (rows->height - 1) / writer.stripe_rows + 1;
    writer.stripe_bytes = writer.stripe_rows * (writer.row_bytes + 1);
    writer.workers = pool ? pool_workers(pool) : 1;
    writer.in_flight = pool ? IN_FLIGHT * writer.workers : 1;
    return writer;
}

bool png_encode(const struct png_source *rows, struct pool *pool, png_sink *put, void *sink, struct error *error) {
    struct text_writer writer = writer_for(rows, pool);
    writer.put = put;
    writer.sink = sink;
    bool ok = begin(&writer) ? encode(&writer, pool, error) : error_no_memory(error, "a PNG file");
    end(&writer);
    return ok;
}

static bool put_into_file(void *sink, const void *bytes, size_t size, struct error *error) {
    return file_output_write(sink, bytes, size, error);
}

bool png_write_from(const struct file_target *target, const struct png_source *rows, struct pool *pool,
                    struct error *error) {
    struct file_output output;
    if (rows->width == 0 || rows->height == 0 || rows->width > SIDE_LIMIT / 8 || rows->height > SIDE_LIMIT)
        return error_set(error, ERROR_SCENE, "%s: a PNG file cannot have %u x %u pixels", target->path, rows->width,
                         rows->height);
    if (!file_output_open(&output, target, error))
        return false;
    if (!png_encode(rows, pool, put_into_file, &output, error)) {
        file_output_abandon(&output);
        return false;
    }
    return file_output_commit(&output, error);
}

uint8_t png_write_byte(double c) {
    if (!(c > 0))
        return 0;
    return (uint8_t)(c < 1 ? floor(255 * c + 0.5) : 255);
}
