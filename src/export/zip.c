#include "export/zip_internal.h"

#include "image/zlib_memory.h"

#include <string.h>

/* 1980-01-01, 0:00: the bytes of a file depend on its contents only. */
enum { ZIP_DATE = 33, ZIP_VERSION = 20, ZIP_DEFLATED = 8 };
static const uint32_t zip_local = 0x04034b50, zip_central = 0x02014b50, zip_end_mark = 0x06054b50;

/* Numbers of two bytes, or of four where the list of sizes says so. */
static bool put_numbers(struct list *out, const uint32_t *numbers, const char *sizes) {
    bool ok = true;
    for (int i = 0; sizes[i]; i++)
        ok = ok && list_add_number(out, numbers[i], sizes[i] == '4' ? 4 : 2);
    return ok;
}

/* Adds the compressed bytes; *crc and *packed are of them. */
static bool add_deflated(struct list *out, const void *data, size_t size, uint32_t *crc, uint32_t *packed) {
    z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
    if (size > UINT32_MAX / 2 || deflateInit2(&stream, 6, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return false;
    uLong bound = deflateBound(&stream, (uLong)size);
    Bytef *room = list_room(out, bound, 1);
    stream.next_in = data;
    stream.avail_in = (uInt)size;
    stream.next_out = room;
    stream.avail_out = (uInt)bound;
    bool ok = room && deflate(&stream, Z_FINISH) == Z_STREAM_END;
    *packed = (uint32_t)stream.total_out;
    *crc = (uint32_t)crc32(0, data, (uInt)size);
    (void)deflateEnd(&stream);
    out->count += ok ? *packed : 0;
    return ok;
}

/* The header of an entry comes before its bytes, which are compressed first. */
bool zip_add(struct list *out, struct list *directory, const char *name, const void *data, size_t size) {
    struct list packed = {0};
    uint32_t crc = 0, packed_size = 0, offset = (uint32_t)out->count, length = (uint32_t)strlen(name);
    bool ok = add_deflated(&packed, data, size, &crc, &packed_size);
    /* What the header and the record in the directory have in common. */
    const uint32_t about[] = {ZIP_VERSION, 0, ZIP_DEFLATED, 0, ZIP_DATE, crc, packed_size, (uint32_t)size, length, 0};
    const uint32_t more[] = {0, 0, 0, 0, offset};
    ok = ok && list_add_number(out, zip_local, 4) && put_numbers(out, about, "2222244422") &&
         list_add_bytes(out, name, length) && list_add_bytes(out, packed.items, packed.count) &&
         out->count < UINT32_MAX && list_add_number(directory, zip_central, 4) &&
         list_add_number(directory, ZIP_VERSION, 2) && put_numbers(directory, about, "2222244422") &&
         put_numbers(directory, more, "22244") && list_add_bytes(directory, name, length);
    list_destroy(&packed);
    return ok;
}

bool zip_end(struct list *out, const struct list *directory, uint32_t count) {
    const uint32_t end[] = {zip_end_mark, 0, 0, count, count, (uint32_t)directory->count, (uint32_t)out->count, 0};
    return list_add_bytes(out, directory->items, directory->count) && put_numbers(out, end, "42222442");
}
