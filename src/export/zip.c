#include "export/zip_internal.h"

#include "image/zlib_memory.h"

#include <string.h>

/* 1980-01-01, 0:00: the bytes of a file depend on its contents only. */
enum { ZIP_DATE = 33, ZIP_VERSION = 20, ZIP_DEFLATED = 8 };
static const uint32_t zip_local = 0x04034b50, zip_central = 0x02014b50, zip_end = 0x06054b50;

/* Numbers of two bytes, or of four where the list of sizes says so. */
static bool put_numbers(struct list *out, const uint32_t *numbers, const char *sizes) {
    bool ok = true;
    for (int i = 0; sizes[i]; i++)
        ok = ok && list_add_number(out, numbers[i], sizes[i] == '4' ? 4 : 2);
    return ok;
}

/* What the header of an entry and its record in the directory have in common. */
static bool put_about(const struct zip_entry *entry, struct list *out) {
    const uint32_t about[] = {ZIP_VERSION,
                              0,
                              ZIP_DEFLATED,
                              0,
                              ZIP_DATE,
                              entry->crc,
                              entry->packed,
                              (uint32_t)entry->size,
                              (uint32_t)strlen(entry->name),
                              0};
    return put_numbers(out, about, "2222244422");
}

static bool compress_entry(struct zip_entry *entry, struct list *out) {
    z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
    if (entry->size > UINT32_MAX / 2 || deflateInit2(&stream, 6, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        return false;
    uLong bound = deflateBound(&stream, (uLong)entry->size);
    Bytef *room = list_room(out, bound, 1);
    stream.next_in = entry->data;
    stream.avail_in = (uInt)entry->size;
    stream.next_out = room;
    stream.avail_out = (uInt)bound;
    bool ok = room && deflate(&stream, Z_FINISH) == Z_STREAM_END;
    entry->packed = (uint32_t)stream.total_out;
    entry->crc = (uint32_t)crc32(0, entry->data, (uInt)entry->size);
    (void)deflateEnd(&stream);
    out->count += ok ? entry->packed : 0;
    return ok;
}

/* The header of an entry comes before its bytes, which are compressed first. */
static bool put_entry(struct zip_entry *entry, struct list *out) {
    struct list packed = {0};
    bool ok = compress_entry(entry, &packed);
    entry->offset = (uint32_t)out->count;
    ok = ok && list_add_number(out, zip_local, 4) && put_about(entry, out) &&
         list_add_bytes(out, entry->name, strlen(entry->name)) && list_add_bytes(out, packed.items, packed.count) &&
         out->count < UINT32_MAX;
    list_destroy(&packed);
    return ok;
}

bool zip_write(struct zip_entry *entries, int count, struct list *out) {
    bool ok = true;
    for (int i = 0; ok && i < count; i++)
        ok = put_entry(&entries[i], out);
    uint32_t directory = (uint32_t)out->count;
    for (int i = 0; ok && i < count; i++) {
        const uint32_t more[] = {0, 0, 0, 0, entries[i].offset};
        ok = list_add_number(out, zip_central, 4) && list_add_number(out, ZIP_VERSION, 2) &&
             put_about(&entries[i], out) && put_numbers(out, more, "22244") &&
             list_add_bytes(out, entries[i].name, strlen(entries[i].name));
    }
    uint32_t size = (uint32_t)out->count - directory, number = (uint32_t)count;
    const uint32_t end[] = {zip_end, 0, 0, number, number, size, directory, 0};
    return ok && put_numbers(out, end, "42222442");
}
