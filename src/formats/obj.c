/* Wavefront OBJ in one pass over the bytes.
 *
 * A line is a keyword and blank-separated words; `#` starts a comment, a backslash at the end of a line continues it.
 * Only v, vt, vn, f, usemtl, mtllib, g and o are read; other keywords must at least look like words, so that a binary
 * file is refused on its first line; one warning names those that would show something. What is wrong with normals,
 * texture coordinates and faces of two corners leaves out these; what is wrong with positions is an error, unless no
 * face uses them. The faces behind a usemtl have its material; in a file without any usemtl those of
 * a group (g, o) have a material slot of its name, so that a script can distinguish them. Source of the format:
 * Wavefront, "Object Files (.obj)", Appendix B1 of the Advanced Visualizer manual. Indices count from 1; negative ones
 * count back from the last element read so far. A positive index may point at an element that comes later in the file,
 * so these are checked at the end: for each of the three lists only indices above all before them need to be kept, with
 * their lines.
 * Invariant: the index lists of uvs and normals are either absent or as long as that of vertices; they appear with the
 * first corner that names one and say MISSING for all corners before. Memory: lists grow by half, and the shortest way
 * to cost much is a corner of two bytes in three lists, so nine times the file's size is an upper bound; two is
 * usual. */

#include "base/file.h"
#include "base/hash.h"
#include "formats/decimal_internal.h"
#include "formats/list.h"
#include "formats/model.h"
#include "math/range.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- names --- */

/* Numbers for names: the first name is 0, the next new one 1 and so on. Names are not copied. A hash table with open
 * addressing; the position of a name in it has no effect. Owner: the caller, names_destroy. Zero value except for
 * `max`: none. */
struct name {
    const char *text;
    size_t length;
};
struct names {
    struct list entries; /* struct name */
    uint32_t *table;     /* numbers by hash, at most half full */
    size_t capacity;
    size_t max; /* more names are reported as lack of memory */
};

#define EMPTY UINT32_MAX

static size_t slot_of(const struct names *names, const char *text, size_t length) {
    const struct name *entries = names->entries.items;
    size_t at = (size_t)hash_bytes(text, length, 0) & (names->capacity - 1);
    while (names->table[at] != EMPTY) {
        const struct name *name = &entries[names->table[at]];
        if (name->length == length && memcmp(name->text, text, length) == 0)
            break;
        at = (at + 1) & (names->capacity - 1);
    }
    return at;
}

static bool grow(struct names *names) {
    size_t capacity = names->capacity ? names->capacity * 2 : 32;
    uint32_t *table = mem_alloc(capacity * sizeof *table);
    if (!table)
        return false;
    memset(table, 0xff, capacity * sizeof *table);
    mem_free(names->table);
    names->table = table;
    names->capacity = capacity;
    const struct name *entries = names->entries.items;
    for (uint32_t i = 0; i < names->entries.count; i++)
        table[slot_of(names, entries[i].text, entries[i].length)] = i;
    return true;
}

/* False: no memory. *number is that of an equal name in the table, or a new one. */
static bool names_add(struct names *names, const char *text, size_t length, uint32_t *number) {
    if (names->entries.count * 2 >= names->capacity && !grow(names))
        return false;
    size_t at = slot_of(names, text, length);
    if (names->table[at] == EMPTY) {
        struct name *name = list_room(&names->entries, 1, sizeof *name);
        if (!name || names->entries.count >= names->max)
            return false;
        *name = (struct name){text, length};
        names->table[at] = (uint32_t)names->entries.count++;
    }
    *number = names->table[at];
    return true;
}

/* UINT32_MAX if the name is not in the table. */
static uint32_t names_find(const struct names *names, const char *text, size_t length) {
    return names->capacity ? names->table[slot_of(names, text, length)] : EMPTY;
}

static void names_destroy(struct names *names) {
    list_destroy(&names->entries);
    mem_free(names->table);
    *names = (struct names){0};
}

/* --- elements and faces --- */

#define MISSING UINT32_MAX
#define STRAY (UINT32_MAX - 1)   /* no such vertex; only where such faces are forgiven */
#define UNNAMED (UINT32_MAX - 1) /* faces before the first usemtl or g */
#define FILE_LIMIT ((size_t)1 << 36)

enum { VERTEX, UV, NORMAL, KINDS }; /* of elements: v, vt, vn */

/* The material slots of the faces for one kind of name. The list is absent while all faces have the same slot. */
struct slotting {
    struct names names;
    struct list faces; /* uint32_t per face */
    uint32_t current, first;
};

/* A vertex with a coordinate that is not finite, and the word; or an index of an element that may come later. */
struct doubt {
    size_t number, line;
    const char *word;
};

struct reader {
    const char *path;
    const char *at, *end;
    size_t line;
    struct error *error;
    struct list elements[KINDS]; /* double[3], double[2], double[3] */
    struct list indices[KINDS];  /* uint32_t per corner */
    struct list starts;          /* uint32_t per face: its first corner */
    struct list forward[KINDS];  /* struct doubt: indices that come before their elements, rising */
    struct list odd_vertices;    /* struct doubt: those that are not finite */
    const char *odd_word;        /* of the last line of numbers; NULL: all are finite */
    struct list colours;         /* float[3] per vertex, as written; NaN: none */
    float brightest;             /* number of a colour */
    struct left_out odd[KINDS];  /* vn and vt without finite numbers */
    struct left_out lost[KINDS]; /* indices of vn and vt that do not exist */
    struct left_out short_faces, odd_colours;
    struct unread unread;
    struct model *model;
    struct slotting materials, groups;
    struct file_set libraries; /* those that were read: a file may name one at every object */
};

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static bool is_line_end(char c) {
    return c == '\n' || c == '\r';
}

static void *room(struct reader *reader, struct list *list, size_t more, size_t size) {
    void *items = list_room(list, more, size);
    if (!items)
        error_no_memory(reader->error, reader->path);
    return items;
}

static bool fail_at(const struct reader *reader, size_t line, const char *what) {
    return error_set(reader->error, ERROR_SCENE, "%s:%zu: %s", reader->path, line, what);
}

static bool fail(const struct reader *reader, const char *what) {
    return fail_at(reader, reader->line, what);
}

/* The same with the quoted word at `at` in front: 'abc' is not a number. */
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

/* Skips one line end: LF, CR LF or CR. */
static void skip_line_end(struct reader *reader) {
    if (*reader->at == '\r' && reader->at + 1 < reader->end && reader->at[1] == '\n')
        reader->at++;
    reader->at++;
    reader->line++;
}

/* Whether this is a backslash that continues the line. At the end of the file the continuation is empty. */
static bool is_continuation(const struct reader *reader, const char *at) {
    return *at == '\\' && (at + 1 == reader->end || is_line_end(at[1]));
}

static void skip_continuation(struct reader *reader) {
    reader->at++;
    if (reader->at < reader->end)
        skip_line_end(reader);
}

/* Moves to the next word of this line; false if there is none. */
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

/* Moves past the end of the line. Comments are not continued, other lines are. */
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

/* The numbers of this line: the first of them into values, NaN for those that are not finite. Returns a word that is no
 * number, or NULL. */
static const char *read_numbers(struct reader *reader, double *values, int kept, int *count) {
    reader->odd_word = NULL;
    for (*count = 0; next_word(reader); ++*count) {
        double value;
        const char *word = reader->at, *after = decimal_read(word, reader->end, &value);
        bool whole = after && word_ends(reader, after);
        /* 1.#IND is not 1 and a comment. */
        if (!whole || (after < reader->end && *after == '#')) {
            const char *odd = decimal_skip_not_finite(word, reader->end);
            if (!odd && !whole)
                return word;
            value = odd ? NAN : value;
            after = odd ? odd : after;
            reader->odd_word = odd && !reader->odd_word ? word : reader->odd_word;
        }
        if (*count < kept)
            values[*count] = value;
        reader->at = after;
    }
    return NULL;
}

/* Colours begin with the first vertex that has one. */
static bool add_colour(struct reader *reader, const double *values, int count) {
    size_t vertices = reader->elements[VERTEX].count;
    const double *colour = values + (count == 6 ? 3 : 4);
    if (count < 6 && reader->colours.count == 0)
        return true;
    float *out = room(reader, &reader->colours, vertices - reader->colours.count, 3 * sizeof *out);
    if (!out)
        return false;
    bool fine = count >= 6;
    for (int k = 0; k < 3 && fine; k++)
        fine = number_in_range(colour[k]);
    if (count >= 6 && !fine)
        left_out_add(&reader->odd_colours, reader->line);
    for (; reader->colours.count < vertices; reader->colours.count++, out += 3)
        for (int k = 0; k < 3; k++) {
            bool given = fine && reader->colours.count + 1 == vertices;
            out[k] = given ? (float)colour[k] : NAN;
            reader->brightest = given && out[k] > reader->brightest ? out[k] : reader->brightest;
        }
    return true;
}

/* v: x y z, with w, r g b, or both; w is not used. */
static bool read_vertex(struct reader *reader) {
    double values[7];
    int count;
    const char *wrong = read_numbers(reader, values, 7, &count);
    double *vertex = room(reader, &reader->elements[VERTEX], 1, 3 * sizeof *vertex);
    if (!vertex)
        return false;
    if (wrong)
        return fail_word(reader, wrong, "is not a finite number");
    if (count < 3)
        return error_set(reader->error, ERROR_SCENE, "%s:%zu: v needs 3 numbers, not %d", reader->path, reader->line,
                         count);
    for (int k = 0; k < 3; k++)
        vertex[k] = values[k];
    if (reader->odd_word && isnan(values[0] + values[1] + values[2])) {
        struct doubt *odd = room(reader, &reader->odd_vertices, 1, sizeof *odd);
        if (!odd)
            return false;
        *odd = (struct doubt){reader->elements[VERTEX].count, reader->line, reader->odd_word};
        reader->odd_vertices.count++;
        vertex[0] = NAN;
    }
    if (++reader->elements[VERTEX].count > model_max(reader->model))
        return fail(reader, "more elements than an index can name");
    return add_colour(reader, values, count);
}

/* vt (a third number is not used) or vn. One that is wrong becomes NaN. */
static bool read_attribute(struct reader *reader, int kind) {
    double values[3] = {0};
    int count, width = kind == UV ? 2 : 3;
    const char *wrong = read_numbers(reader, values, width, &count);
    bool fine = !wrong && count >= (kind == UV ? 1 : 3);
    double *element = room(reader, &reader->elements[kind], 1, (size_t)width * sizeof *element);
    if (!element)
        return false;
    for (int k = 0; k < width; k++) {
        element[k] = values[k];
        fine = fine && number_in_range(values[k]);
    }
    if (!fine) {
        element[0] = NAN;
        left_out_add(&reader->odd[kind], reader->line);
    }
    return ++reader->elements[kind].count <= model_max(reader->model) ||
           fail(reader, "more elements than an index can name");
}

static size_t largest_forward(const struct reader *reader, int kind) {
    const struct doubt *forward = reader->forward[kind].items;
    return reader->forward[kind].count ? forward[reader->forward[kind].count - 1].number : 0;
}

/* The first index that stays without an element is one of those above all before it. */
static bool add_forward(struct reader *reader, int kind, size_t value) {
    if (value <= largest_forward(reader, kind))
        return true;
    struct doubt *forward = room(reader, &reader->forward[kind], 1, sizeof *forward);
    if (!forward)
        return false;
    *forward = (struct doubt){.number = value, .line = reader->line};
    reader->forward[kind].count++;
    return true;
}

/* The first index that has no element, at the end; NULL: there is none. */
static const struct doubt *first_beyond(const struct reader *reader, int kind) {
    const struct doubt *forward = reader->forward[kind].items;
    for (size_t i = 0; i < reader->forward[kind].count; i++)
        if (forward[i].number > reader->elements[kind].count)
            return &forward[i];
    return NULL;
}

/* Reads one index of a corner, 0-based, into *out. */
static bool read_index(struct reader *reader, int kind, const char *word, uint32_t *out) {
    const char *p = reader->at, *end = reader->end;
    assert(p < end); /* read_corner() has looked */
    bool negative = *p == '-';
    if (*p == '-' || *p == '+')
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
    if (value - 1 < count && !negative) { /* the usual case */
        *out = (uint32_t)(value - 1);
        return true;
    }
    bool exists = value != 0 && value < STRAY && (!negative || value <= count);
    if (!exists && kind != VERTEX) {
        left_out_add(&reader->lost[kind], reader->line);
        *out = MISSING;
        return true;
    }
    if (!exists && reader->model->options.forgive) {
        *out = STRAY;
        return true;
    }
    if (value == 0)
        return fail_word(reader, word, "has the index 0, but indices count from 1");
    if (negative) {
        if (value > count)
            return error_set(reader->error, ERROR_SCENE, "%s:%zu: vertex index -%llu, but only %zu were read so far",
                             reader->path, reader->line, (unsigned long long)value, count);
        *out = (uint32_t)(count - value);
        return true;
    }
    if (value >= STRAY)
        return fail_word(reader, word, "has an index that is too large");
    *out = (uint32_t)(value - 1);
    return add_forward(reader, kind, (size_t)value);
}

/* 7, 7/1, 7//3, 7/1/3. Some files have slashes with nothing after them, which mean nothing. */
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

/* Adds one corner to the index lists. The lists of uvs and normals are created with their first index. */
static bool add_corner(struct reader *reader, const uint32_t corner[KINDS]) {
    size_t before = reader->indices[VERTEX].count;
    if (before >= model_max(reader->model))
        return fail(reader, "more corners than an index can name");
    for (int kind = VERTEX; kind < KINDS; kind++) {
        struct list *list = &reader->indices[kind];
        if (kind != VERTEX && list->count == 0) {
            if (corner[kind] == MISSING)
                continue;
            uint32_t *missing = room(reader, list, before + 1, sizeof *missing);
            if (!missing)
                return false;
            memset(missing, 0xff, before * sizeof *missing);
            list->count = before;
        }
        uint32_t *index = room(reader, list, 1, sizeof *index);
        if (!index)
            return false;
        *index = corner[kind];
        list->count++;
    }
    return true;
}

static bool add_slot(struct reader *reader, struct slotting *slotting, size_t face) {
    if (face == 0)
        slotting->first = slotting->current;
    if (slotting->faces.count == 0) {
        if (slotting->current == slotting->first)
            return true;
        uint32_t *before = room(reader, &slotting->faces, face, sizeof *before);
        if (!before)
            return false;
        for (size_t i = 0; i < face; i++)
            before[i] = slotting->first;
        slotting->faces.count = face;
    }
    uint32_t *slot = room(reader, &slotting->faces, 1, sizeof *slot);
    if (!slot)
        return false;
    *slot = slotting->current;
    slotting->faces.count++;
    return true;
}

/* The rest of the line, without blanks at its ends: names may contain blanks. */
static size_t read_name(struct reader *reader, const char **name) {
    while (reader->at < reader->end && is_blank(*reader->at))
        reader->at++;
    *name = reader->at;
    while (reader->at < reader->end && !is_line_end(*reader->at) && !is_continuation(reader, reader->at))
        reader->at++;
    const char *end = reader->at;
    while (end > *name && is_blank(end[-1]))
        end--;
    return (size_t)(end - *name);
}

static bool read_slot(struct reader *reader, struct slotting *slotting) {
    const char *name;
    size_t length = read_name(reader, &name);
    if (length == 0) {
        slotting->current = UNNAMED;
        return true;
    }
    return names_add(&slotting->names, name, length, &slotting->current) ||
           error_no_memory(reader->error, reader->path);
}

/* Reads one library of materials; false only if it exists and is invalid. *found: whether it exists. */
static bool read_library(struct reader *reader, const char *name, size_t length, bool *found) {
    const char *path;
    struct file_bytes bytes;
    struct file_identity identity;
    if (!model_find(reader->model, name, length, &path, reader->error))
        return false;
    *found = path != NULL;
    bool known = path && file_identity_of(path, &identity);
    if (!path || (known && file_set_has(&reader->libraries, identity)))
        return true;
    if (!path_policy_map(reader->model->options.path_policy, path, FILE_LIMIT, &bytes, reader->error))
        return false;
    bool ok = mtl_load(reader->model, path, (const char *)bytes.data, bytes.size, reader->error);
    file_unmap(&bytes);
    return ok && (!known || file_set_add(&reader->libraries, identity) || error_no_memory(reader->error, reader->path));
}

/* One name with blanks in it, or several names. */
static bool read_libraries(struct reader *reader) {
    const char *name, *end;
    size_t length = read_name(reader, &name);
    bool found, all = true;
    if (reader->model->options.single_file)
        return true;
    if (!read_library(reader, name, length, &found))
        return false;
    if (found)
        return true;
    /* Names with blanks are tried whole first; then each word is a file. */
    end = name + length;
    for (const char *at = name; at < end;) {
        const char *word_end = at;
        while (word_end < end && !is_blank(*word_end))
            word_end++;
        if (!read_library(reader, at, (size_t)(word_end - at), &found))
            return false;
        all = all && found;
        for (at = word_end; at < end && is_blank(*at);)
            at++;
    }
    if (!all)
        model_warn(reader->model, "%s:%zu: the material library '%.*s' %s", reader->path, reader->line,
                   length < 200 ? (int)length : 200, name, model_why_missing(reader->model));
    return true;
}

/* The lists as they were before the first corner of the face of this line. */
static void forget_face(struct reader *reader, size_t corners, size_t line) {
    for (int kind = VERTEX; kind < KINDS; kind++) {
        const struct doubt *forward = reader->forward[kind].items;
        while (reader->forward[kind].count && forward[reader->forward[kind].count - 1].line >= line)
            reader->forward[kind].count--;
        if (reader->indices[kind].count > corners)
            reader->indices[kind].count = corners;
    }
}

static bool read_face(struct reader *reader) {
    size_t line = reader->line, first = reader->indices[VERTEX].count;
    uint32_t *start = room(reader, &reader->starts, 2, sizeof *start); /* the final end included */
    if (!start)
        return false;
    while (next_word(reader)) {
        uint32_t corner[KINDS];
        if (!read_corner(reader, corner) || !add_corner(reader, corner))
            return false;
    }
    if (reader->indices[VERTEX].count - first < 3) {
        forget_face(reader, first, line);
        left_out_add(&reader->short_faces, line);
        return true;
    }
    *start = (uint32_t)first;
    return add_slot(reader, &reader->materials, reader->starts.count) &&
           add_slot(reader, &reader->groups, reader->starts.count++);
}

/* What nothing visible depends on alone: smoothing groups, parameters of curves and surfaces, switches. */
static bool is_silent(const char *word, size_t length) {
    static const char *const words[] = {
        "s",  "mg",  "vp",  "cstype", "deg",      "bmat",     "step", "parm",  "trim",  "hole",       "scrv",
        "sp", "end", "con", "bevel",  "c_interp", "d_interp", "lod",  "ctech", "stech", "shadow_obj", "trace_obj"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strlen(words[i]) == length && memcmp(words[i], word, length) == 0)
            return true;
    return false;
}

/* Skips the rest of a line with an unknown keyword. */
static bool skip_unknown(struct reader *reader, const char *word) {
    size_t line = reader->line;
    for (; !word_ends(reader, reader->at); reader->at++) {
        unsigned char c = (unsigned char)*reader->at;
        if (c < 0x20 || c == 0x7f)
            return fail_word(reader, word, "is not an OBJ keyword: is this a text file?");
    }
    if (!is_silent(word, (size_t)(reader->at - word)))
        unread_add(&reader->unread, word, (size_t)(reader->at - word), line);
    skip_line(reader);
    return true;
}

/* Moves past the word if it is this one. */
static bool is_keyword(struct reader *reader, const char *word, const char *keyword) {
    size_t length = strlen(keyword);
    if ((size_t)(reader->end - word) < length || memcmp(word, keyword, length) != 0 ||
        !word_ends(reader, word + length))
        return false;
    reader->at = word + length;
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
        ok = read_vertex(reader);
    } else if (short_word && *word == 'f') {
        reader->at += 1;
        ok = read_face(reader);
    } else if (long_word && *word == 'v' && second == 't') {
        reader->at += 2;
        ok = read_attribute(reader, UV);
    } else if (long_word && *word == 'v' && second == 'n') {
        reader->at += 2;
        ok = read_attribute(reader, NORMAL);
    } else if (long_word && *word == 'f' && second == 'o') { /* a face in files older than version 3.0 */
        reader->at += 2;
        ok = read_face(reader);
    } else if (is_keyword(reader, word, "usemtl")) {
        ok = read_slot(reader, &reader->materials);
    } else if (is_keyword(reader, word, "g") || is_keyword(reader, word, "o")) {
        ok = read_slot(reader, &reader->groups);
    } else if (is_keyword(reader, word, "mtllib")) {
        ok = read_libraries(reader);
    } else {
        return skip_unknown(reader, word);
    }
    if (ok)
        skip_line(reader);
    return ok;
}

static bool is_stray(const struct reader *reader, size_t corner) {
    const double(*vertices)[3] = reader->elements[VERTEX].items;
    uint32_t vertex = ((const uint32_t *)reader->indices[VERTEX].items)[corner];
    return vertex >= reader->elements[VERTEX].count || isnan(vertices[vertex][0]);
}

/* A face with a vertex that does not exist or is not finite becomes one of no extent, in vertex 0. */
static void forgive_vertices(struct reader *reader) {
    const uint32_t *starts = reader->starts.items;
    size_t lost = 0, corners = reader->indices[VERTEX].count;
    for (size_t f = 0; f < reader->starts.count && reader->elements[VERTEX].count > 0; f++) {
        size_t begin = starts[f], end = f + 1 < reader->starts.count ? starts[f + 1] : corners;
        bool stray = false;
        for (size_t i = begin; i < end && !stray; i++)
            stray = is_stray(reader, i);
        lost += stray;
        for (int kind = VERTEX; stray && kind < KINDS; kind++)
            for (size_t i = begin; i < end && i < reader->indices[kind].count; i++)
                ((uint32_t *)reader->indices[kind].items)[i] = kind == VERTEX ? 0 : MISSING;
    }
    if (lost == 0)
        return;
    model_warn(reader->model, "%s: %zu faces have vertices that do not exist or are not finite, and are left out",
               reader->path, lost);
    double *first = reader->elements[VERTEX].items;
    first[0] = isnan(first[0]) ? 0 : first[0];
    reader->forward[VERTEX].count = 0;
}

static bool check_vertices(struct reader *reader) {
    const struct doubt *beyond = first_beyond(reader, VERTEX), *odd = reader->odd_vertices.items;
    const uint32_t *index = reader->indices[VERTEX].items;
    double(*vertices)[3] = reader->elements[VERTEX].items;
    if (beyond)
        return error_set(reader->error, ERROR_SCENE, "%s:%zu: vertex index %zu, but the file has only %zu",
                         reader->path, beyond->line, beyond->number, reader->elements[VERTEX].count);
    if (reader->elements[VERTEX].count == 0 && reader->starts.count > 0)
        return error_set(reader->error, ERROR_SCENE, "%s: the file has no vertices", reader->path);
    if (reader->odd_vertices.count == 0)
        return true;
    /* The first one that a face uses, or the first one of a file without faces. */
    bool used = reader->starts.count == 0;
    for (size_t i = 0; i < reader->indices[VERTEX].count && !used; i++)
        if (isnan(vertices[index[i]][0])) {
            used = true;
            while (odd->number != index[i])
                odd++;
        }
    reader->line = odd->line;
    if (used)
        return fail_word(reader, odd->word, "is not a finite number");
    struct left_out out = {reader->odd_vertices.count, odd->line};
    for (size_t i = 0; i < reader->odd_vertices.count; i++)
        memset(vertices[odd[i].number], 0, sizeof *vertices);
    model_warn_left_out(reader->model, reader->path, &out, false, "a vertex is not finite, and no face uses it");
    return true;
}

/* Corners lose the indices of uvs or normals that do not exist, or are not finite. */
static void leave_out_attributes(struct reader *reader, int kind) {
    const struct doubt *beyond = first_beyond(reader, kind);
    struct left_out *odd = &reader->odd[kind], *lost = &reader->lost[kind];
    size_t width = kind == UV ? 2 : 3, count = reader->elements[kind].count;
    double *elements = reader->elements[kind].items;
    uint32_t *index = reader->indices[kind].items;
    if (beyond && (lost->count == 0 || beyond->line < lost->at))
        lost->at = beyond->line;
    for (size_t i = 0; i < reader->indices[kind].count && (beyond || odd->count); i++) {
        bool stray = index[i] != MISSING && index[i] >= count;
        lost->count += stray;
        if (stray || (index[i] != MISSING && isnan(elements[width * index[i]])))
            index[i] = MISSING;
    }
    for (size_t i = 0; i < count && odd->count; i++)
        if (isnan(elements[width * i]))
            memset(elements + width * i, 0, width * sizeof *elements);
    model_warn_left_out(reader->model, reader->path, odd, false,
                        kind == UV ? "vt needs finite numbers: faces that use it have no texture coordinates"
                                   : "vn needs 3 finite numbers: faces that use it are flat");
    model_warn_left_out(reader->model, reader->path, lost, false,
                        kind == UV ? "an index of vt that does not exist: its face has no texture coordinates"
                                   : "an index of vn that does not exist: its face is flat");
}

/* Everything that could only be decided at the end of the file, and its warnings. */
static bool check_elements(struct reader *reader) {
    if (reader->model->options.forgive)
        forgive_vertices(reader);
    model_warn_unread(reader->model, reader->path, &reader->unread);
    model_warn_left_out(reader->model, reader->path, &reader->short_faces, false,
                        "f needs at least 3 corners: the face is left out");
    model_warn_left_out(reader->model, reader->path, &reader->odd_colours, false,
                        "a colour is not finite: it is white");
    leave_out_attributes(reader, UV);
    leave_out_attributes(reader, NORMAL);
    return check_vertices(reader);
}

/* From the range of the file, 0 to 1 or 0 to 255, to 0 to 1; white where there is none. */
static bool take_colours(struct reader *reader, struct model_mesh *mesh) {
    float *colours = reader->colours.items;
    for (size_t i = 0; i < 3 * reader->colours.count; i++) {
        float x = reader->brightest >= 2 ? colours[i] / 255 : colours[i];
        colours[i] = isnan(x) || x > 1 ? 1 : x < 0 ? 0 : x;
    }
    mesh->colours = reader->colours;
    reader->colours = (struct list){0};
    return mesh->colours.count == 0 || model_show_colours(reader->model, mesh, reader->error);
}

/* The slots of the faces and their materials: the last ones of their names in the libraries. */
static bool make_slots(struct reader *reader, struct model_mesh *mesh) {
    bool ok = true;
    /* A newmtl without a name has the faces of a usemtl without one. */
    bool by_material = reader->materials.names.entries.count > 0;
    for (size_t i = 0; i < reader->model->materials.count; i++)
        by_material = by_material || model_materials(reader->model)[i].name[0] == '\0';
    struct slotting *used = by_material ? &reader->materials : &reader->groups;
    struct names known = {.max = model_max(reader->model)};
    struct list last = {0}; /* uint32_t: the material of a known name */
    size_t unknown = 0;
    for (uint32_t i = 0; ok && i < reader->model->materials.count; i++) {
        const char *name = model_materials(reader->model)[i].name;
        uint32_t number;
        ok = names_add(&known, name, strlen(name), &number) && (number < last.count || list_add_index(&last, i));
        if (ok)
            ((uint32_t *)last.items)[number] = i;
    }
    uint32_t count = (uint32_t)used->names.entries.count;
    const struct name *names = used->names.entries.items;
    struct name first_unknown = {0};
    for (uint32_t i = 0; ok && i <= count; i++) {
        struct name name = i < count ? names[i] : (struct name){"", 0};
        uint32_t number = by_material ? names_find(&known, name.text, name.length) : MISSING;
        const char **slot_name = list_room(&mesh->slot_names, 1, sizeof *slot_name);
        ok = slot_name &&
             list_add_index(&mesh->slots, number == MISSING ? MODEL_NONE : ((uint32_t *)last.items)[number]);
        if (!ok)
            break;
        *slot_name = i < count ? arena_copy_text(&reader->model->arena, names[i].text, names[i].length) : "";
        ok = *slot_name != NULL;
        mesh->slot_names.count++;
        if (by_material && i < count && number == MISSING && reader->model->materials.count && unknown++ == 0)
            first_unknown = name;
    }
    if (unknown)
        model_warn(reader->model, "%s: the material '%.*s' is in no library (%zu such materials)", reader->path,
                   first_unknown.length < 200 ? (int)first_unknown.length : 200, first_unknown.text, unknown);
    names_destroy(&known);
    list_destroy(&last);
    if (!ok)
        return error_no_memory(reader->error, reader->path);
    /* The slot after the named ones is that of faces without a name. */
    if (used->faces.count == 0) {
        uint32_t only = used->first == UNNAMED ? count : used->first;
        ((uint32_t *)mesh->slots.items)[0] = ((uint32_t *)mesh->slots.items)[only];
        ((const char **)mesh->slot_names.items)[0] = ((const char **)mesh->slot_names.items)[only];
        mesh->slots.count = mesh->slot_names.count = 1;
        return true;
    }
    bool unnamed = false;
    for (size_t f = 0; f < used->faces.count; f++) {
        uint32_t *slot = (uint32_t *)used->faces.items + f;
        unnamed |= *slot == UNNAMED;
        *slot = *slot == UNNAMED ? count : *slot;
    }
    if (!unnamed)
        mesh->slots.count = mesh->slot_names.count = count;
    mesh->face_slot = used->faces;
    used->faces = (struct list){0};
    return true;
}

bool obj_load(struct model *model, const char *text, size_t size, struct error *error) {
    struct reader reader = {.path = model->path,
                            .at = text,
                            .end = text + size,
                            .line = 1,
                            .error = error,
                            .model = model,
                            .materials.current = UNNAMED,
                            .groups.current = UNNAMED,
                            .materials.names.max = model_max(model),
                            .groups.names.max = model_max(model)};
    if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0)
        reader.at += 3;

    /* Indices may refer to elements that come later, so they are checked at the end. */
    bool ok = true;
    while (ok && reader.at < reader.end)
        ok = read_line(&reader);
    ok = ok && check_elements(&reader);
    struct model_mesh *mesh = ok ? model_add_mesh(model, error) : NULL;
    /* The mesh takes over what was read. */
    if (mesh) {
        mesh->vertices = reader.elements[VERTEX], mesh->vertex_index = reader.indices[VERTEX];
        mesh->uvs = reader.elements[UV], mesh->uv_index = reader.indices[UV];
        mesh->normals = reader.elements[NORMAL], mesh->normal_index = reader.indices[NORMAL];
        mesh->starts = reader.starts;
        ok = make_slots(&reader, mesh) && take_colours(&reader, mesh);
    } else {
        for (int kind = VERTEX; kind < KINDS; kind++) {
            list_destroy(&reader.elements[kind]);
            list_destroy(&reader.indices[kind]);
        }
        list_destroy(&reader.starts);
    }
    for (int kind = VERTEX; kind < KINDS; kind++)
        list_destroy(&reader.forward[kind]);
    list_destroy(&reader.odd_vertices);
    list_destroy(&reader.colours);
    names_destroy(&reader.materials.names);
    names_destroy(&reader.groups.names);
    list_destroy(&reader.materials.faces);
    list_destroy(&reader.groups.faces);
    file_set_destroy(&reader.libraries);
    return mesh != NULL && ok;
}
