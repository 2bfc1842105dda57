/* Wavefront OBJ in one pass over the bytes.
 *
 * A line is a keyword and blank-separated words; `#` starts a comment, a backslash at the end of a line continues it.
 * Only v, vt, vn and f are read; other keywords must at least look like words, so that a binary file is refused on its
 * first line. Source of the format: Wavefront, "Object Files (.obj)", Appendix B1 of the Advanced Visualizer manual.
 * Indices count from 1; negative ones count back from the last element read so far. A positive index may point at an
 * element that comes later in the file, so these are checked at the end: for each of the three lists only the largest
 * index and its line need to be kept.
 * Invariant: the index lists of uvs and normals are either absent or as long as that of vertices; they appear with the
 * first corner that names one and say MISSING for all corners before. Memory: lists grow by half, and the shortest way to
 * cost much is a corner of two bytes in three lists, so nine times the file's size is an upper bound; two is usual. */
#include "formats/obj.h"

#include "base/file.h"
#include "base/mem.h"
#include "formats/decimal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MISSING UINT32_MAX
#define FILE_LIMIT ((size_t)1 << 36)

/* A growing array. */
struct list {
    void *items;
    size_t count, capacity;
};

enum { VERTEX, UV, NORMAL, KINDS };

struct reader {
    const char *path;
    const char *at, *end;
    size_t line;
    struct error *error;
    struct list elements[KINDS]; /* double[3], double[2], double[3] */
    struct list indices[KINDS];  /* uint32_t per corner */
    struct list starts;          /* uint32_t per face: its first corner */
    size_t largest[KINDS], largest_line[KINDS];
};

static const char *const kind_names[KINDS] = {"vertex", "vt", "vn"};

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static bool is_line_end(char c) {
    return c == '\n' || c == '\r';
}

/* Room for `more` items behind the last one; NULL without memory. */
static void *list_room(struct reader *reader, struct list *list, size_t more, size_t size) {
    if (list->capacity - list->count < more) {
        size_t capacity = list->capacity ? list->capacity : 64;
        while (capacity - list->count < more)
            capacity += capacity / 2;
        void *items = mem_resize_array(list->items, capacity, size);
        if (!items) {
            error_no_memory(reader->error, reader->path);
            return NULL;
        }
        list->items = items;
        list->capacity = capacity;
    }
    return (char *)list->items + list->count * size;
}

static bool fail_at(const struct reader *reader, size_t line, const char *what) {
    return error_set(reader->error, ERROR_SCENE, "%s:%zu: %s", reader->path, line, what);
}

static bool fail(const struct reader *reader, const char *what) {
    return fail_at(reader, reader->line, what);
}

/* The same with the word at `at` in front: 'abc' is not a number. */
static bool fail_word(const struct reader *reader, const char *at, const char *what) {
    char word[40];
    size_t length = 0;
    while (at < reader->end && !is_blank(*at) && !is_line_end(*at) && length < sizeof word - 4) {
        unsigned char c = (unsigned char)*at++;
        word[length++] = c >= 0x20 && c < 0x7f ? (char)c : '?';
    }
    bool cut = at < reader->end && !is_blank(*at) && !is_line_end(*at);
    (void)snprintf(word + length, sizeof word - length, "%s", cut ? "..." : "");
    return error_set(reader->error, ERROR_SCENE, "%s:%zu: '%s' %s", reader->path, reader->line, word, what);
}

/* Over one line end: LF, CR LF or CR. */
static void skip_line_end(struct reader *reader) {
    if (*reader->at == '\r' && reader->at + 1 < reader->end && reader->at[1] == '\n')
        reader->at++;
    reader->at++;
    reader->line++;
}

/* Is this a backslash that continues the line? At the end of the file it continues with nothing. */
static bool is_continuation(const struct reader *reader, const char *at) {
    return *at == '\\' && (at + 1 == reader->end || is_line_end(at[1]));
}

static void skip_continuation(struct reader *reader) {
    reader->at++;
    if (reader->at < reader->end)
        skip_line_end(reader);
}

/* To the next word of this line; false when there is none. */
static bool next_word(struct reader *reader) {
    while (reader->at < reader->end) {
        if (is_blank(*reader->at)) {
            reader->at++;
        } else if (is_continuation(reader, reader->at)) {
            skip_continuation(reader);
        } else {
            return !is_line_end(*reader->at) && *reader->at != '#';
        }
    }
    return false;
}

/* Does a word end here? */
static bool word_ends(const struct reader *reader, const char *at) {
    return at >= reader->end || is_blank(*at) || is_line_end(*at) || *at == '#' || is_continuation(reader, at);
}

/* Behind the end of the line. Comments are not continued, other lines are. */
static void skip_line(struct reader *reader) {
    bool comment = false;
    while (reader->at < reader->end && !is_line_end(*reader->at)) {
        comment |= *reader->at == '#';
        if (!comment && is_continuation(reader, reader->at))
            skip_continuation(reader);
        else
            reader->at++;
    }
    if (reader->at < reader->end)
        skip_line_end(reader);
}

static bool read_number(struct reader *reader, double *out) {
    const char *after = decimal_read(reader->at, reader->end, out);
    if (!after || !word_ends(reader, after))
        return fail_word(reader, reader->at, "is not a finite number");
    reader->at = after;
    return true;
}

/* The numbers of a v, vt or vn: at least `least`, the first `kept` of them into a new element (0 where missing); what
 * follows (weights, vertex colours, a third texture coordinate) must be numbers too. */
static bool read_element(struct reader *reader, int kind, int least, int kept) {
    double *element = list_room(reader, &reader->elements[kind], 1, (size_t)kept * sizeof *element);
    if (!element)
        return false;
    for (int i = 0; i < kept; i++)
        element[i] = 0;
    int count = 0;
    for (; next_word(reader); count++) {
        double value;
        if (!read_number(reader, &value))
            return false;
        if (count < kept)
            element[count] = value;
    }
    if (count < least)
        return error_set(reader->error, ERROR_SCENE, "%s:%zu: %s needs %d number%s, not %d", reader->path, reader->line,
                         kind == VERTEX ? "v" : kind_names[kind], least, least == 1 ? "" : "s", count);
    if (++reader->elements[kind].count >= MISSING)
        return fail(reader, "more than 4294967294 elements");
    return true;
}

/* One index of a corner, 0-based into *out. */
static bool read_index(struct reader *reader, int kind, const char *word, uint32_t *out) {
    const char *p = reader->at, *end = reader->end;
    bool negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+'))
        p++;
    const char *first = p;
    uint64_t value = 0;
    for (; p < end && (unsigned)(unsigned char)*p - '0' <= 9; p++)
        if (value < UINT64_C(1) << 40)
            value = value * 10 + (uint64_t)(*p - '0');
    if (p == first)
        return fail_word(reader, word, "is not a corner of a face (7, 7/1, 7//3 or 7/1/3)");
    reader->at = p;
    size_t count = reader->elements[kind].count;
    if (value == 0)
        return fail_word(reader, word, "has the index 0, but indices count from 1");
    if (negative) {
        if (value > count)
            return error_set(reader->error, ERROR_SCENE, "%s:%zu: %s index -%llu, but only %zu were read so far",
                             reader->path, reader->line, kind_names[kind], (unsigned long long)value, count);
        *out = (uint32_t)(count - value);
        return true;
    }
    if (value >= MISSING)
        return fail_word(reader, word, "has an index that is too large");
    if (value > count && value > reader->largest[kind]) {
        reader->largest[kind] = value;
        reader->largest_line[kind] = reader->line;
    }
    *out = (uint32_t)(value - 1);
    return true;
}

/* 7, 7/1, 7//3, 7/1/3; slashes with nothing behind them are met in real files and mean nothing. */
static bool read_corner(struct reader *reader, uint32_t corner[KINDS]) {
    const char *word = reader->at;
    corner[UV] = corner[NORMAL] = MISSING;
    if (!read_index(reader, VERTEX, word, &corner[VERTEX]))
        return false;
    for (int kind = UV; kind <= NORMAL && reader->at < reader->end && *reader->at == '/'; kind++) {
        reader->at++;
        bool empty = word_ends(reader, reader->at) || *reader->at == '/';
        if (!empty && !read_index(reader, kind, word, &corner[kind]))
            return false;
    }
    if (!word_ends(reader, reader->at))
        return fail_word(reader, word, "is not a corner of a face (7, 7/1, 7//3 or 7/1/3)");
    return true;
}

/* One more corner in the index lists; those of uvs and normals come into being with the first index that they hold. */
static bool add_corner(struct reader *reader, const uint32_t corner[KINDS]) {
    size_t before = reader->indices[VERTEX].count;
    if (before >= MISSING - 1)
        return fail(reader, "more than 4294967294 corners");
    for (int kind = VERTEX; kind < KINDS; kind++) {
        struct list *list = &reader->indices[kind];
        if (kind != VERTEX && list->count == 0) {
            if (corner[kind] == MISSING)
                continue;
            uint32_t *missing = list_room(reader, list, before + 1, sizeof *missing);
            if (!missing)
                return false;
            memset(missing, 0xff, before * sizeof *missing);
            list->count = before;
        }
        uint32_t *index = list_room(reader, list, 1, sizeof *index);
        if (!index)
            return false;
        *index = corner[kind];
        list->count++;
    }
    return true;
}

static bool read_face(struct reader *reader) {
    size_t line = reader->line, first = reader->indices[VERTEX].count;
    uint32_t *start = list_room(reader, &reader->starts, 2, sizeof *start); /* the final end included */
    if (!start)
        return false;
    while (next_word(reader)) {
        uint32_t corner[KINDS];
        if (!read_corner(reader, corner) || !add_corner(reader, corner))
            return false;
    }
    if (reader->indices[VERTEX].count - first < 3)
        return fail_at(reader, line, "f needs at least 3 corners");
    *start = (uint32_t)first;
    reader->starts.count++;
    return true;
}

/* The rest of a line whose keyword means nothing to us. */
static bool skip_unknown(struct reader *reader, const char *word) {
    for (; !word_ends(reader, reader->at); reader->at++) {
        unsigned char c = (unsigned char)*reader->at;
        if (c < 0x20 || c == 0x7f)
            return fail_word(reader, word, "is not an OBJ keyword: is this a text file?");
    }
    skip_line(reader);
    return true;
}

static bool read_line(struct reader *reader) {
    if (!next_word(reader)) {
        skip_line(reader);
        return true;
    }
    const char *word = reader->at;
    char second = word + 1 < reader->end ? word[1] : '\n';
    bool short_word = word_ends(reader, word + 1);
    bool long_word = !short_word && word_ends(reader, word + 2);
    bool ok;
    if (short_word && *word == 'v') {
        reader->at += 1;
        ok = read_element(reader, VERTEX, 3, 3);
    } else if (short_word && *word == 'f') {
        reader->at += 1;
        ok = read_face(reader);
    } else if (long_word && *word == 'v' && second == 't') {
        reader->at += 2;
        ok = read_element(reader, UV, 1, 2);
    } else if (long_word && *word == 'v' && second == 'n') {
        reader->at += 2;
        ok = read_element(reader, NORMAL, 3, 3);
    } else if (long_word && *word == 'f' && second == 'o') { /* a face in files older than version 3.0 */
        reader->at += 2;
        ok = read_face(reader);
    } else {
        return skip_unknown(reader, word);
    }
    if (ok)
        skip_line(reader);
    return ok;
}

static bool check_indices(const struct reader *reader) {
    for (int kind = VERTEX; kind < KINDS; kind++)
        if (reader->largest[kind] > reader->elements[kind].count)
            return error_set(reader->error, ERROR_SCENE, "%s:%zu: %s index %zu, but the file has only %zu",
                             reader->path, reader->largest_line[kind], kind_names[kind], reader->largest[kind],
                             reader->elements[kind].count);
    return true;
}

static struct mesh *make_mesh(const struct reader *reader) {
    uint32_t *starts = reader->starts.items;
    starts[reader->starts.count] = (uint32_t)reader->indices[VERTEX].count;
    struct mesh_input input = {
        .name = reader->path,
        .vertex_count = (uint32_t)reader->elements[VERTEX].count,
        .vertices = reader->elements[VERTEX].items,
        .face_count = (uint32_t)reader->starts.count,
        .face_start = starts,
        .vertex_index = reader->indices[VERTEX].items,
    };
    if (reader->indices[NORMAL].count) {
        input.normal_count = (uint32_t)reader->elements[NORMAL].count;
        input.normals = reader->elements[NORMAL].items;
        input.normal_index = reader->indices[NORMAL].items;
    }
    if (reader->indices[UV].count) {
        input.uv_count = (uint32_t)reader->elements[UV].count;
        input.uvs = reader->elements[UV].items;
        input.uv_index = reader->indices[UV].items;
    }
    return mesh_create(&input, reader->error);
}

struct mesh *obj_parse(const char *path, const char *text, size_t size, struct error *error) {
    struct reader reader = {.path = path, .at = text, .end = text + size, .line = 1, .error = error};
    if (size >= 2 && (memcmp(text, "\xff\xfe", 2) == 0 || memcmp(text, "\xfe\xff", 2) == 0)) {
        fail(&reader, "this is UTF-16 text; an OBJ file is plain ASCII or UTF-8");
        return NULL;
    }
    if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0)
        reader.at += 3;

    bool ok = true;
    while (ok && reader.at < reader.end)
        ok = read_line(&reader);
    ok = ok && check_indices(&reader);
    if (ok && reader.starts.count == 0)
        ok = error_set(error, ERROR_SCENE, "%s: no faces in this file", path);
    struct mesh *mesh = ok ? make_mesh(&reader) : NULL;

    for (int kind = VERTEX; kind < KINDS; kind++) {
        mem_free(reader.elements[kind].items);
        mem_free(reader.indices[kind].items);
    }
    mem_free(reader.starts.items);
    return mesh;
}

struct mesh *obj_read(const char *path, struct error *error) {
    struct file_bytes bytes;
    if (!file_map(path, FILE_LIMIT, &bytes, error))
        return NULL;
    struct mesh *mesh = obj_parse(path, (const char *)bytes.data, bytes.size, error);
    file_unmap(&bytes);
    return mesh;
}
