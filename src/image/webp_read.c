/* WebP in ("WebP Container Specification", Google). libwebp allocates by itself: its memory is computed from the
 * header and the file's size and counted before. The first frame of an animation lies somewhere on a clear canvas. */
#include "image/webp_read_internal.h"

#include <string.h>

bool webp_is(const uint8_t *data, size_t size) {
    return size >= 12 && memcmp(data, "RIFF", 4) == 0 && memcmp(data + 8, "WEBP", 4) == 0;
}

#ifndef HAVE_WEBP

struct image *image_parse_webp(const char *path, const uint8_t *data, size_t size, struct error *error) {
    (void)data, (void)size;
    error_set(error, ERROR_SCENE, "%s: this is a WebP, which this build cannot read (it was made without libwebp)",
              path);
    return NULL;
}

#else

#include "base/mem.h"

#include <webp/decode.h>
#include <webp/demux.h>

/* Of libwebp, at most: the pixels in its own form and rows of them, a multiple of what is compressed, and tables. One
 * byte of a picture without losses is some hundred pixels of one colour. */
enum { BYTES_PER_PIXEL = 6, BYTES_PER_BYTE = 16, TABLES = 1 << 20, PIXELS_PER_BYTE = 1 << 16 };

static struct image *decode(const char *path, const WebPDemuxer *demux, size_t size, struct error *error) {
    uint32_t width = WebPDemuxGetI(demux, WEBP_FF_CANVAS_WIDTH), height = WebPDemuxGetI(demux, WEBP_FF_CANVAS_HEIGHT);
    uint64_t pixels = (uint64_t)width * height, needed = pixels * BYTES_PER_PIXEL + size * BYTES_PER_BYTE + TABLES;
    WebPIterator frame;
    struct image *image = NULL;
    bool there = WebPDemuxGetFrame(demux, 1, &frame), ok = there && frame.complete;
    ok = ok && pixels / PIXELS_PER_BYTE <= size;
    if (ok)
        image = image_allocate(path, width, height, 8, error);
    bool reserved = image && mem_reserve(needed);
    if (image && !reserved)
        error_no_memory(error, path);
    if (reserved) {
        uint8_t *canvas = image->levels[0].texels;
        size_t offset = ((size_t)frame.y_offset * width + (size_t)frame.x_offset) * 4;
        memset(canvas, 0, (size_t)pixels * 4);
        ok = WebPDecodeRGBAInto(frame.fragment.bytes, frame.fragment.size, canvas + offset, (size_t)pixels * 4 - offset,
                                (int)width * 4) != NULL;
        mem_unreserve(needed);
    }
    if (there)
        WebPDemuxReleaseIterator(&frame);
    if (!ok)
        error_set(error, ERROR_SCENE, "%s: broken WebP: its picture cannot be decoded", path);
    if (reserved && ok)
        return image;
    image_release(image);
    return NULL;
}

struct image *image_parse_webp(const char *path, const uint8_t *data, size_t size, struct error *error) {
    WebPData file = {data, size};
    WebPDemuxer *demux = WebPDemux(&file);
    if (!demux) {
        error_set(error, ERROR_SCENE, "%s: broken WebP: the file is truncated or its parts do not fit", path);
        return NULL;
    }
    struct image *image = decode(path, demux, size, error);
    WebPDemuxDelete(demux);
    return image ? image_finish(image, true, error) : NULL;
}

#endif
