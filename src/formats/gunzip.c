/* gzip out of memory into memory, through zlib (RFC 1951, 1952). Deflate can grow a thousandfold, so what comes out is
 * bounded by what a mesh file can reasonably be: a small hostile file costs little memory. A file may be several
 * members one behind the other; zeros behind the last one are padding. */
#include "formats/model.h"

#include "image/zlib_memory.h"

#include <assert.h>

/* zlib counts in 32 bits: long files go through it piece by piece (small ones in test builds). */
#ifdef GRAY_FAULTS
enum { PIECE = 1 << 12 };
#else
enum { PIECE = 1 << 30 };
#endif
enum { GROWTH = 64, START = 1 << 24 };

static size_t consumed(const z_stream *stream, const uint8_t *data) {
    return (size_t)(stream->next_in - data);
}

/* One member from stream->next_in on, appended to *out. */
static bool member(z_stream *stream, const char *path, const uint8_t *data, size_t size, struct list *out, size_t limit,
                   struct error *error) {
    for (;;) {
        size_t left_in = size - consumed(stream, data), chunk = out->count / 2 + 65536;
        if (chunk > limit - out->count)
            chunk = limit - out->count;
        uint8_t *room = list_room(out, chunk, 1);
        if (!room)
            return error_no_memory(error, path);
        stream->avail_in = left_in < PIECE ? (uInt)left_in : PIECE;
        stream->next_out = room;
        stream->avail_out = chunk < PIECE ? (uInt)chunk : PIECE;
        int status = inflate(stream, Z_NO_FLUSH);
        size_t made = (size_t)(stream->next_out - room);
        out->count += made;
        if (status == Z_STREAM_END)
            return true;
        if (status == Z_MEM_ERROR)
            return error_no_memory(error, path);
        if (status != Z_OK && status != Z_BUF_ERROR) {
            assert(stream->msg); /* zlib gives the reason of every error in the data */
            return error_set(error, ERROR_SCENE, "%s: byte %zu: the gzip data are broken: %s", path,
                             consumed(stream, data), stream->msg);
        }
        if (out->count == limit)
            return error_set(error, ERROR_SCENE,
                             "%s: byte %zu: the gzip data grow beyond %zu bytes, %d times the file: refused", path,
                             consumed(stream, data), limit, GROWTH);
        if (made == 0 && consumed(stream, data) == size)
            return error_set(error, ERROR_SCENE, "%s: byte %zu: the gzip data end too early", path, size);
    }
}

bool gunzip(const char *path, const uint8_t *data, size_t size, uint8_t **out, size_t *out_size, struct error *error) {
    z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
    struct list bytes = {0};
    *out = NULL;
    if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK)
        return error_no_memory(error, path);
    stream.next_in = (z_const Bytef *)(uintptr_t)data;
    size_t limit = START + size * GROWTH, at = 0;
    bool ok = true, more = true;
    while (ok && more) {
        ok = member(&stream, path, data, size, &bytes, limit, error);
        at = consumed(&stream, data);
        more = ok && size - at >= 2 && data[at] == 0x1f && data[at + 1] == 0x8b;
        if (more)
            (void)inflateReset(&stream);
    }
    (void)inflateEnd(&stream);
    for (size_t i = at; ok && i < size; i++)
        if (data[i] != 0)
            ok = error_set(error, ERROR_SCENE, "%s: byte %zu: other bytes follow the gzip data", path, i);
    if (!ok) {
        list_destroy(&bytes);
        return false;
    }
    *out = bytes.items;
    *out_size = bytes.count;
    return true;
}
