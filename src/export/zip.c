#include "export/zip_internal.h"

#include "image/zlib_memory.h"

#include <string.h>

static bool put(struct list *out, const void *bytes, size_t size) {
    char *room = list_room(out, size, 1);
    if (!room)
        return false;
    memcpy(room, bytes, size);
    out->count += size;
    return true;
}

/* 1980-01-01, 0:00: the bytes of a file depend on its contents only. */
enum { ZIP_DATE = 33, ZIP_VERSION = 20, ZIP_DEFLATED = 8 };

/* A record: numbers of two bytes, or of four where the list of sizes says so. */
static bool put_record(struct list *out, const uint32_t *numbers, const char *sizes) {
    bool ok = true;
    for (int i = 0; sizes[i]; i++) {
        uint8_t little[4] = {(uint8_t)numbers[i], (uint8_t)(numbers[i] >> 8), (uint8_t)(numbers[i] >> 16),
                             (uint8_t)(numbers[i] >> 24)};
        ok = ok && put(out, little, sizes[i] == '4' ? 4 : 2);
    }
    return ok;
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
    uint32_t name = (uint32_t)strlen(entry->name);
    bool ok = compress_entry(entry, &packed);
    entry->offset = (uint32_t)out->count;
    const uint32_t header[] = {
        0x04034b50, ZIP_VERSION, 0, ZIP_DEFLATED, 0, ZIP_DATE, entry->crc, entry->packed, (uint32_t)entry->size, name,
        0};
    ok = ok && put_record(out, header, "42222244422") && put(out, entry->name, name) &&
         put(out, packed.items, packed.count) && out->count < UINT32_MAX;
    list_destroy(&packed);
    return ok;
}

bool zip_write(struct zip_entry *entries, int count, struct list *out) {
    bool ok = true;
    for (int i = 0; ok && i < count; i++)
        ok = put_entry(&entries[i], out);
    uint32_t directory = (uint32_t)out->count;
    for (int i = 0; ok && i < count; i++) {
        const struct zip_entry *entry = &entries[i];
        uint32_t name = (uint32_t)strlen(entry->name);
        const uint32_t record[] = {0x02014b50,
                                   ZIP_VERSION,
                                   ZIP_VERSION,
                                   0,
                                   ZIP_DEFLATED,
                                   0,
                                   ZIP_DATE,
                                   entry->crc,
                                   entry->packed,
                                   (uint32_t)entry->size,
                                   name,
                                   0,
                                   0,
                                   0,
                                   0,
                                   0,
                                   entry->offset};
        ok = put_record(out, record, "42222224442222244") && put(out, entry->name, name);
    }
    const uint32_t end[] = {0x06054b50, 0, 0, (uint32_t)count, (uint32_t)count, (uint32_t)out->count - directory,
                            directory,  0};
    return ok && put_record(out, end, "42222442");
}
