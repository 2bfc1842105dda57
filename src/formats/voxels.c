/* See voxels.h. The header is lines "field: value", comments and "key:=value", up to an empty line; the data follow. */
#include "formats/voxels.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/zlib_memory.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#define FILE_LIMIT ((size_t)1 << 36)
enum { LINE_SIZE = 256 };

#define VOXEL_BYTES(type, word, more, bytes) [type] = (bytes),
static const size_t bytes_of[] = {VOXEL_TYPES(VOXEL_BYTES)};
#undef VOXEL_BYTES

/* --- values --- */

static float value_at(const uint8_t *data, enum voxel_type type, uint64_t i) {
    const uint8_t *at = data + i * bytes_of[type];
    switch (type) {
    case VOXEL_FLOAT: {
        float value;
        memcpy(&value, at, sizeof value);
        return value;
    }
    case VOXEL_DOUBLE: {
        double value;
        memcpy(&value, at, sizeof value);
        return (float)value;
    }
    case VOXEL_UINT8:
        return (float)at[0];
    case VOXEL_INT16:
        return (float)(int16_t)(at[0] | at[1] << 8);
    case VOXEL_UINT16:
        return (float)(at[0] | at[1] << 8);
    case VOXEL_TYPE_COUNT:
        break;
    }
    return NAN;
}

static uint64_t voxel_count(const struct voxels *voxels) {
    return (uint64_t)voxels->count[0] * voxels->count[1] * voxels->count[2];
}

/* From bytes that are all there. */
static bool convert(const char *path, const uint8_t *data, enum voxel_type type, struct arena *arena,
                    struct voxels *out, struct error *error) {
    uint64_t count = voxel_count(out);
    float *values = arena_alloc_array(arena, count, sizeof *values);
    if (!values)
        return error_no_memory(error, path);
    for (uint64_t i = 0; i < count; i++) {
        values[i] = value_at(data, type, i);
        if (!(values[i] >= 0) || !isfinite(values[i]))
            return error_set(error, ERROR_SCENE,
                             "%s: the value of voxel {%u, %u, %u} is %g; a density must be finite and at least 0", path,
                             (unsigned)(i % out->count[0]), (unsigned)(i / out->count[0] % out->count[1]),
                             (unsigned)(i / out->count[0] / out->count[1]), (double)values[i]);
    }
    out->values = values;
    return true;
}

static bool sizes_fit(const char *path, const struct voxels *voxels, enum voxel_type type, uint64_t size,
                      struct error *error) {
    uint64_t wanted = voxel_count(voxels) * bytes_of[type];
    return wanted == size ||
           error_set(error, ERROR_SCENE, "%s: %u x %u x %u voxels of %zu bytes are %llu bytes, but there are %llu",
                     path, voxels->count[0], voxels->count[1], voxels->count[2], bytes_of[type],
                     (unsigned long long)wanted, (unsigned long long)size);
}

bool voxels_read_raw(const char *path, enum voxel_type type, struct arena *arena, struct voxels *out,
                     struct error *error) {
    struct file_bytes file;
    if (!file_map(path, FILE_LIMIT, &file, error))
        return false;
    bool ok = sizes_fit(path, out, type, file.size, error) && convert(path, file.data, type, arena, out, error);
    file_unmap(&file);
    return ok;
}

/* --- the header --- */

struct header {
    const char *path;
    bool has_type, has_sizes, has_dimension, has_encoding, gzip, little;
    enum voxel_type type;
    uint32_t count[3];
};

/* Whether a word is one of those between bars. */
static bool is_one_of(const char *word, const char *words) {
    size_t length = strlen(word);
    for (const char *at = words; *at; at += strcspn(at, "|"), at += *at == '|')
        if (strcspn(at, "|") == length && strncasecmp(at, word, length) == 0)
            return true;
    return false;
}

static bool read_type(struct header *header, const char *value, struct error *error) {
#define VOXEL_WORDS(type, word, more, bytes) [type] = word "|" more,
    static const char *const words[] = {VOXEL_TYPES(VOXEL_WORDS)};
#undef VOXEL_WORDS
    for (int type = 0; type < VOXEL_TYPE_COUNT; type++) {
        if (!is_one_of(value, words[type]))
            continue;
        header->type = (enum voxel_type)type;
        header->has_type = true;
        return true;
    }
    return error_set(error, ERROR_SCENE,
                     "%s: values of type '%.40s' are not supported (float, double, uint8, int16, uint16)", header->path,
                     value);
}

static bool read_sizes(struct header *header, const char *value, struct error *error) {
    long long n[3];
    int end = 0;
    if (sscanf(value, "%lld %lld %lld%n", &n[0], &n[1], &n[2], &end) != 3 || value[end])
        return error_set(error, ERROR_SCENE, "%s: sizes must be three numbers, not '%.40s'", header->path, value);
    for (int i = 0; i < 3; i++) {
        if (n[i] < 1 || n[i] > VOXELS_LIMIT)
            return error_set(error, ERROR_SCENE, "%s: %lld voxels along an axis; 1 to %d are possible", header->path,
                             n[i], VOXELS_LIMIT);
        header->count[i] = (uint32_t)n[i];
    }
    header->has_sizes = true;
    return true;
}

/* Fields without an effect on the values are ignored: the scene says where the grid is. */
static bool read_field(struct header *header, const char *name, const char *value, struct error *error) {
    if (strcmp(name, "type") == 0)
        return read_type(header, value, error);
    if (strcmp(name, "sizes") == 0)
        return read_sizes(header, value, error);
    if (strcmp(name, "dimension") == 0) {
        header->has_dimension = strcmp(value, "3") == 0;
        return header->has_dimension ||
               error_set(error, ERROR_SCENE, "%s: dimension is %.40s; a grid of single numbers has 3", header->path,
                         value);
    }
    if (strcmp(name, "endian") == 0) {
        header->little = strcmp(value, "little") == 0;
        return header->little ||
               error_set(error, ERROR_SCENE, "%s: endian is '%.40s'; only little is supported", header->path, value);
    }
    if (strcmp(name, "encoding") == 0) {
        header->gzip = is_one_of(value, "gzip|gz");
        header->has_encoding = header->gzip || strcmp(value, "raw") == 0;
        return header->has_encoding ||
               error_set(error, ERROR_SCENE, "%s: encoding is '%.40s'; raw and gzip are supported", header->path,
                         value);
    }
    if (is_one_of(name, "data file|datafile|line skip|lineskip|byte skip|byteskip"))
        return error_set(error, ERROR_SCENE, "%s: the field '%s' is not supported; the data must follow the header",
                         header->path, name);
    return true;
}

/* One line without its end. */
static bool read_line(struct header *header, char *line, struct error *error) {
    char *colon = strstr(line, ": ");
    if (line[0] == '#' || strstr(line, ":=") || !colon)
        return true;
    char *value = colon + 2;
    value += strspn(value, " \t");
    for (size_t n = strlen(value); n > 0 && isspace((unsigned char)value[n - 1]); n--)
        value[n - 1] = 0;
    *colon = 0;
    return read_field(header, line, value, error);
}

/* *at: where the data begin. */
static bool read_header(struct header *header, const uint8_t *data, size_t size, size_t *at, struct error *error) {
    while (*at < size) {
        char line[LINE_SIZE];
        const uint8_t *end = memchr(data + *at, '\n', size - *at);
        if (!end)
            break;
        size_t length = (size_t)(end - (data + *at)), kept = length < LINE_SIZE - 1 ? length : LINE_SIZE - 1;
        memcpy(line, data + *at, kept);
        *at += length + 1;
        kept -= kept > 0 && line[kept - 1] == '\r';
        line[kept] = 0;
        if (kept == 0)
            return true;
        if (!read_line(header, line, error))
            return false;
    }
    return error_set(error, ERROR_SCENE, "%s: the header has no end: an empty line is missing", header->path);
}

static bool check_header(const struct header *header, struct error *error) {
    const char *missing = !header->has_type                               ? "type"
                          : !header->has_dimension                        ? "dimension"
                          : !header->has_sizes                            ? "sizes"
                          : !header->has_encoding                         ? "encoding"
                          : !header->little && bytes_of[header->type] > 1 ? "endian"
                                                                          : NULL;
    return !missing ||
           error_set(error, ERROR_SCENE, "%s: the field '%s' is missing in the header", header->path, missing);
}

/* --- data --- */

/* Unpacks exactly `wanted` bytes. zlib counts in 32 bits, so long data are processed in pieces. */
static bool unpack(const char *path, const uint8_t *data, size_t size, uint8_t *out, size_t wanted,
                   struct error *error) {
    enum { PIECE = 1 << 30 };
    z_stream stream = {.zalloc = zlib_alloc, .zfree = zlib_free};
    size_t used = 0, made = 0;
    int status = Z_OK;
    if (inflateInit2(&stream, 16 + MAX_WBITS) != Z_OK)
        return error_no_memory(error, path);
    while (status == Z_OK && made < wanted) {
        size_t in = size - used < PIECE ? size - used : PIECE, room = wanted - made < PIECE ? wanted - made : PIECE;
        stream.next_in = (z_const Bytef *)(uintptr_t)(data + used);
        stream.next_out = out + made;
        stream.avail_in = (uInt)in;
        stream.avail_out = (uInt)room;
        status = inflate(&stream, Z_NO_FLUSH);
        used += in - stream.avail_in;
        made += room - stream.avail_out;
    }
    (void)inflateEnd(&stream);
    if (status == Z_MEM_ERROR)
        return error_no_memory(error, path);
    return made == wanted || error_set(error, ERROR_SCENE, "%s: the gzip data are broken or end after %zu of %zu bytes",
                                       path, made, wanted);
}

static bool is_nrrd(const uint8_t *data, size_t size) {
    return size >= 8 && memcmp(data, "NRRD000", 7) == 0 && isdigit(data[7]);
}

bool voxels_parse_nrrd(const char *path, const uint8_t *data, size_t size, struct arena *arena, struct voxels *out,
                       struct error *error) {
    struct header header = {.path = path};
    size_t at = 0;
    if (!is_nrrd(data, size))
        return error_set(error, ERROR_SCENE, "%s is no NRRD file", path);
    if (!read_header(&header, data, size, &at, error) || !check_header(&header, error))
        return false;
    memcpy(out->count, header.count, sizeof out->count);
    if (!header.gzip)
        return sizes_fit(path, out, header.type, size - at, error) &&
               convert(path, data + at, header.type, arena, out, error);
    uint64_t wanted = voxel_count(out) * bytes_of[header.type];
    /* Deflate expands by at most 1,032: more cannot be there. */
    if (wanted / 1032 > size - at)
        return error_set(error, ERROR_SCENE, "%s: %zu bytes of gzip data cannot hold %llu bytes", path, size - at,
                         (unsigned long long)wanted);
    uint8_t *bytes = mem_alloc((size_t)wanted);
    bool ok = bytes ? unpack(path, data + at, size - at, bytes, (size_t)wanted, error) : error_no_memory(error, path);
    ok = ok && convert(path, bytes, header.type, arena, out, error);
    mem_free(bytes);
    return ok;
}

bool voxels_read_nrrd(const char *path, struct arena *arena, struct voxels *out, struct error *error) {
    struct file_bytes file;
    if (!file_map(path, FILE_LIMIT, &file, error))
        return false;
    bool ok = voxels_parse_nrrd(path, file.data, file.size, arena, out, error);
    file_unmap(&file);
    return ok;
}
