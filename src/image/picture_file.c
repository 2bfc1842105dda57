/* The extension of a name selects the format of a picture. */
#include "image/picture_file.h"

#include "image/exr.h"
#include "image/float_read_internal.h"
#include "image/float_write.h"
#include "image/light_field.h"
#include "image/png_write.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static const char *const extensions[] = {PICTURE_FORMATS(LIST_WORD)};

const char *picture_extensions(char out[PICTURE_EXTENSIONS_SIZE]) {
    size_t at = 0;
    for (int i = 0; i < PICTURE_OTHER && at < PICTURE_EXTENSIONS_SIZE; i++) {
        const char *separator = i == 0 ? "" : i + 1 < PICTURE_OTHER ? ", " : " or ";
        at += (size_t)snprintf(out + at, PICTURE_EXTENSIONS_SIZE - at, "%s%s", separator, extensions[i]);
    }
    return out;
}

enum picture_format picture_format(const char *name) {
    const char *dot = strrchr(name, '.');
    for (int i = 0; dot && i < PICTURE_OTHER; i++) {
        if (strcasecmp(dot, extensions[i]) == 0)
            return (enum picture_format)i;
    }
    return PICTURE_OTHER;
}

/* "PF" or "Pf", the end of the line, and the width. */
static bool is_pfm(const uint8_t *head, size_t size) {
    return pfm_is(head, size) && size >= 4 && (head[3] == '\n' || (head[3] >= '0' && head[3] <= '9'));
}

bool picture_file_is(const uint8_t *head, size_t size) {
    static const struct {
        size_t size;
        const char *bytes;
    } signatures[] = {
        {8, "\x89PNG\r\n\x1a\n"}, {3, "\xff\xd8\xff"}, {10, "#?RADIANCE"}, {6, "#?RGBE"}, {4, "\x76\x2f\x31\x01"},
    };
    for (size_t i = 0; i < sizeof signatures / sizeof *signatures; i++) {
        if (size >= signatures[i].size && memcmp(head, signatures[i].bytes, signatures[i].size) == 0)
            return true;
    }
    return is_pfm(head, size) || light_field_is(head, size);
}

bool picture_file_write(const struct file_target *target, const struct picture_source *source, struct pool *pool,
                        struct error *error) {
    uint32_t width = source->width, height = source->height;
    switch (picture_format(target->path)) {
    case PICTURE_PFM:
        return pfm_write(target, width, height, source->light, source->context, error);
    case PICTURE_HDR:
        return hdr_write(target, width, height, source->light, source->context, error);
    case PICTURE_EXR:
        return exr_write(target, width, height, source->light, source->context, error);
    case PICTURE_LIGHT_FIELD:
        return light_field_write(target, source, pool, error);
    case PICTURE_PNG:
    case PICTURE_OTHER:
        break;
    }
    struct png_source png = {.width = width,
                             .height = height,
                             .context = source->context,
                             .alpha = source->alpha,
                             .srgb = source->srgb,
                             .unfinished = source->unfinished};
    if (source->deep)
        png.words = source->words;
    else
        png.bytes = source->bytes;
    return png_write_from(target, &png, pool, error);
}
