/* PLY: a header in text names elements and their properties; then follow the elements, as text or as binary numbers
 * of either byte order. Source: G. Turk, "The PLY Polygon File Format", 1994, and the type names of its reference
 * reader.
 *
 * The header becomes a list of properties per element, each with its meaning for the mesh. One loop over elements,
 * rows and properties then reads everything, and skips data without meaning by its size. A row of text is one line.
 * Numbers that are not finite are allowed while they are read: normals, texture coordinates and colours without finite
 * numbers are left out, and a vertex without is an error if a face uses it, which is known at the end.
 * Counts are checked before memory is allocated: each count needs a minimum number of bytes, and the file is refused
 * if it has fewer. So memory is a small multiple of the file's size. */
#include "formats/decimal_internal.h"
#include "formats/model.h"
#include "formats/scan_internal.h"
#include "math/range.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>

enum { ELEMENTS = 64, PROPERTIES = 512 };

/* The meaning of a property. Up to BLUE: a number of a vertex; faces have colours, too. */
enum ply_property {
    NOTHING,
    X,
    Y,
    Z,
    NX,
    NY,
    NZ,
    U,
    V,
    RED,
    GREEN,
    BLUE,
    SCALARS,
    CORNERS = SCALARS,
    CORNER_UVS,
    STRIPS
};

struct property {
    bool is_list;
    enum number_type count_type, type;
    enum ply_property meaning;
};

enum element_kind { OTHER, VERTICES, FACES };

struct element {
    char name[32];
    enum element_kind kind;
    uint64_t count;
    int first, property_count; /* in ply.properties */
    uint64_t min;              /* bytes of the smallest row */
    bool has[SCALARS];
    double colour_scale; /* from the range of the type to 0 .. 1 */
};

/* A vertex that is not finite: its line, or its byte. */
struct odd_vertex {
    size_t number, at;
};

enum format { ASCII, LITTLE, BIG };

struct ply {
    struct model *model;
    const char *path;
    const uint8_t *data, *at, *end;
    size_t line; /* of text */
    enum format format;
    struct error *error;
    struct element elements[ELEMENTS];
    int element_count;
    struct property properties[PROPERTIES];
    int property_count;
    struct model_mesh *mesh;
    bool has[SCALARS]; /* of the vertices */
    bool is_mac;       /* a lone CR ends the lines of the header */
    struct {
        const char *text;
        size_t length;
    } picture;                /* of a comment TextureFile, or NULL */
    struct list odd_vertices; /* struct odd_vertex */
    struct left_out odd_normals, odd_uvs, odd_colours, short_faces, unseen_colours;
    double numbers[SCALARS]; /* of one face */
    struct list values;      /* uint32_t: the last list read */
    struct list pending;     /* double: the texture coordinates of one face */
    uint64_t vertex_total;   /* what the header says */
};

static bool fail(const struct ply *ply, const char *what) {
    if (ply->format == ASCII)
        return error_set(ply->error, ERROR_SCENE, "%s:%zu: %s", ply->path, ply->line, what);
    return error_set(ply->error, ERROR_SCENE, "%s: byte %zu: %s", ply->path, (size_t)(ply->at - ply->data), what);
}

static bool no_memory(const struct ply *ply) {
    return error_no_memory(ply->error, ply->path);
}

/* --- the header --- */

struct words {
    const char *text[8];
    size_t length[8];
    int count;
};

/* The next line of the header, split into words; false at the end of the file. */
static bool header_line(struct ply *ply, struct words *words) {
    *words = (struct words){0};
    if (ply->at >= ply->end)
        return false;
    ply->line++;
    const uint8_t *p = ply->at;
    while (p < ply->end && *p != '\n' && *p != '\r') {
        if (*p == ' ' || *p == '\t') {
            p++;
            continue;
        }
        /* A control character that is no blank is a word, so that the message names it. */
        const uint8_t *first = p;
        while (p<ply->end && * p> ' ')
            p++;
        if (p == first)
            p++;
        if (words->count < 8) {
            words->text[words->count] = (const char *)first;
            words->length[words->count++] = (size_t)(p - first);
        }
    }
    /* Binary data may begin with the byte of LF. */
    bool is_pair = p < ply->end && *p == '\r' && p + 1 < ply->end && p[1] == '\n' && !ply->is_mac;
    if (ply->line == 1)
        ply->is_mac = p < ply->end && *p == '\r' && !is_pair;
    p += is_pair;
    ply->at = p < ply->end ? p + 1 : p;
    return true;
}

static bool word_is(const struct words *words, int i, const char *word) {
    return i < words->count && words->length[i] == strlen(word) && memcmp(words->text[i], word, words->length[i]) == 0;
}

static bool header_fail(const struct ply *ply, const struct words *words, int i, const char *what) {
    int length = i < words->count ? words->length[i] < 40 ? (int)words->length[i] : 40 : 0;
    char word[41] = "";
    for (int k = 0; k < length; k++)
        word[k] = words->text[i][k] >= 0x20 && words->text[i][k] < 0x7f ? words->text[i][k] : '?';
    return error_set(ply->error, ERROR_SCENE, "%s:%zu: '%s' %s", ply->path, ply->line, word, what);
}

static bool read_type(const struct ply *ply, const struct words *words, int i, enum number_type *out) {
    static const char *const names[NUMBER_TYPES][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                                       {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                                       {"float", "float32"}, {"double", "float64"}};
    for (int t = 0; t < NUMBER_TYPES; t++)
        if (word_is(words, i, names[t][0]) || word_is(words, i, names[t][1])) {
            *out = (enum number_type)t;
            return true;
        }
    return header_fail(ply, words, i, "is not a type of number (char, uchar, short, ushort, int, uint, float, double)");
}

static enum ply_property property_of(const struct words *words, int i, const char *element, bool is_list) {
    static const struct {
        const char *name;
        enum ply_property meaning;
    } scalars[] = {{"x", X},
                   {"y", Y},
                   {"z", Z},
                   {"nx", NX},
                   {"ny", NY},
                   {"nz", NZ},
                   {"s", U},
                   {"t", V},
                   {"u", U},
                   {"v", V},
                   {"texture_u", U},
                   {"texture_v", V},
                   {"texture_s", U},
                   {"texture_t", V},
                   {"red", RED},
                   {"green", GREEN},
                   {"blue", BLUE},
                   {"r", RED},
                   {"g", GREEN},
                   {"b", BLUE},
                   {"diffuse_red", RED},
                   {"diffuse_green", GREEN},
                   {"diffuse_blue", BLUE}};
    /* Programs use many names for the same numbers; unknown ones are skipped. */
    bool indices = word_is(words, i, "vertex_indices") || word_is(words, i, "vertex_index");
    if (is_list && strcmp(element, "face") == 0)
        return indices ? CORNERS : word_is(words, i, "texcoord") ? CORNER_UVS : NOTHING;
    if (is_list)
        return indices && strcmp(element, "tristrips") == 0 ? STRIPS : NOTHING;
    bool of_vertex = strcmp(element, "vertex") == 0, of_face = strcmp(element, "face") == 0;
    for (size_t k = 0; (of_vertex || of_face) && k < sizeof scalars / sizeof scalars[0]; k++)
        if (word_is(words, i, scalars[k].name))
            return of_vertex || scalars[k].meaning >= RED ? scalars[k].meaning : NOTHING;
    return NOTHING;
}

static bool read_property(struct ply *ply, const struct words *words) {
    if (ply->element_count == 0)
        return header_fail(ply, words, 0, "comes before the first element");
    if (ply->property_count == PROPERTIES)
        return header_fail(ply, words, 0, "is one too many");
    struct element *element = &ply->elements[ply->element_count - 1];
    struct property p = {.is_list = word_is(words, 1, "list")};
    int name = p.is_list ? 4 : 2;
    if (words->count <= name)
        return header_fail(ply, words, 0, "needs a type and a name");
    if (p.is_list && !read_type(ply, words, 2, &p.count_type))
        return false;
    if (!read_type(ply, words, name - 1, &p.type))
        return false;
    p.meaning = property_of(words, name, element->name, p.is_list);
    bool whole = p.type < NUMBER_F32;
    if (p.is_list && p.count_type >= NUMBER_F32)
        return header_fail(ply, words, 2, "cannot count the entries of a list");
    if ((p.meaning == CORNERS || p.meaning == STRIPS) && !whole)
        return header_fail(ply, words, name, "must be whole numbers");
    for (int k = element->first; k < ply->property_count && p.meaning != NOTHING; k++)
        if (ply->properties[k].meaning == p.meaning)
            return header_fail(ply, words, name, "repeats an earlier property");
    if (p.meaning > NOTHING && p.meaning < SCALARS)
        element->has[p.meaning] = true;
    if (p.meaning == RED)
        element->colour_scale = !whole ? 1 : p.type == NUMBER_U16 ? 1 / 65535.0 : 1 / 255.0;
    ply->properties[ply->property_count++] = p;
    element->property_count++;
    /* In text every number needs at least a digit and a blank or line end. */
    element->min += ply->format == ASCII ? 2 : number_size(p.is_list ? p.count_type : p.type);
    return true;
}

static bool read_element(struct ply *ply, const struct words *words) {
    if (words->count != 3 || words->length[1] >= sizeof ply->elements[0].name)
        return header_fail(ply, words, 0, "needs a name and a count");
    if (ply->element_count == ELEMENTS)
        return header_fail(ply, words, 0, "is one too many");
    struct element *element = &ply->elements[ply->element_count++];
    *element = (struct element){.first = ply->property_count};
    memcpy(element->name, words->text[1], words->length[1]);
    element->kind = word_is(words, 1, "vertex") ? VERTICES : word_is(words, 1, "face") ? FACES : OTHER;
    for (int k = 0; k < ply->element_count - 1; k++)
        if (strcmp(ply->elements[k].name, element->name) == 0)
            return header_fail(ply, words, 1, "is the name of an earlier element");
    for (size_t k = 0; k < words->length[2]; k++) {
        unsigned digit = (unsigned)(unsigned char)words->text[2][k] - '0';
        if (digit > 9 || element->count > UINT64_C(1000000000000000000))
            return header_fail(ply, words, 2, "is not a count");
        element->count = element->count * 10 + digit;
    }
    return true;
}

static bool read_header(struct ply *ply) {
    struct words words;
    bool has_format = false;
    (void)header_line(ply, &words);
    if (!word_is(&words, 0, "ply"))
        return error_set(ply->error, ERROR_SCENE, "%s:1: a PLY file begins with the line 'ply'", ply->path);
    while (header_line(ply, &words)) {
        if (word_is(&words, 0, "comment") && word_is(&words, 1, "TextureFile") && words.count > 2 &&
            !ply->picture.text) {
            ply->picture.text = words.text[2];
            ply->picture.length = (size_t)(words.text[words.count - 1] + words.length[words.count - 1] - words.text[2]);
        }
        if (words.count == 0 || word_is(&words, 0, "comment") || word_is(&words, 0, "obj_info"))
            continue;
        if (word_is(&words, 0, "end_header")) {
            if (!has_format)
                return header_fail(ply, &words, 0, "comes before the format");
            return true;
        }
        if (word_is(&words, 0, "format")) {
            if (has_format)
                return header_fail(ply, &words, 0, "is given a second time");
            if (word_is(&words, 1, "ascii"))
                ply->format = ASCII;
            else if (word_is(&words, 1, "binary_little_endian"))
                ply->format = LITTLE;
            else if (word_is(&words, 1, "binary_big_endian"))
                ply->format = BIG;
            else
                return header_fail(ply, &words, 1, "is none of ascii, binary_little_endian, binary_big_endian");
            has_format = true;
        } else if (!has_format) {
            return header_fail(ply, &words, 0, "comes before the format");
        } else if (word_is(&words, 0, "element")) {
            if (!read_element(ply, &words))
                return false;
        } else if (word_is(&words, 0, "property")) {
            if (!read_property(ply, &words))
                return false;
        } else {
            return header_fail(ply, &words, 0, "is not a word of a PLY header");
        }
    }
    /* Errors name a line, as in text. */
    ply->format = ASCII;
    return fail(ply, "the file ends before end_header");
}

/* --- numbers --- */

static bool is_blank(uint8_t c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

/* Text: moves to the next word of this line; false if the line ends first. */
static bool on_word(struct ply *ply) {
    while (ply->at < ply->end && is_blank(*ply->at))
        ply->at++;
    return ply->at < ply->end && *ply->at != '\n' && *ply->at != '\r';
}

static void over_line_end(struct ply *ply) {
    if (ply->at >= ply->end)
        return;
    if (*ply->at == '\r' && ply->at + 1 < ply->end && ply->at[1] == '\n')
        ply->at++;
    ply->at++;
    ply->line++;
}

static bool read_text_number(struct ply *ply, double *out) {
    if (!on_word(ply))
        return fail(ply, ply->at < ply->end ? "the line ends too early" : "the file ends too early");
    const char *first = (const char *)ply->at, *after = decimal_read(first, (const char *)ply->end, out);
    if (!after || (after < (const char *)ply->end && (uint8_t)*after > ' ')) {
        after = decimal_skip_not_finite(first, (const char *)ply->end);
        if (!after)
            return fail(ply, "not a finite number");
        *out = NAN;
    }
    ply->at = (const uint8_t *)after;
    return true;
}

static bool read_number(struct ply *ply, enum number_type type, double *out) {
    if (ply->format == ASCII)
        return read_text_number(ply, out);
    unsigned size = number_size(type);
    if ((size_t)(ply->end - ply->at) < size)
        return fail(ply, "the file ends too early");
    *out = scan_number(ply->at, type, ply->format == BIG);
    ply->at += size;
    return true;
}

/* Counts and vertices in text are nearly always a few digits and a blank. False: it is something else, and nothing
 * was read. */
static bool read_quick_whole(struct ply *ply, uint32_t *out) {
    const uint8_t *p = ply->at, *end = ply->end;
    while (p < end && is_blank(*p))
        p++;
    const uint8_t *first = p;
    uint32_t value = 0;
    for (; p < end && (unsigned)*p - '0' <= 9; p++) {
        if (p - first == 9)
            return false;
        value = value * 10 + (*p - '0');
    }
    if (p == first || p == end || *p > ' ')
        return false;
    ply->at = p;
    *out = value;
    return true;
}

/* The number of entries of a list; the rest of the file can contain as many. */
static bool read_count(struct ply *ply, const struct property *p, uint32_t *out) {
    double count;
    uint32_t whole;
    const uint8_t *before = ply->at;
    if (ply->format == ASCII && read_quick_whole(ply, &whole))
        count = whole;
    else if (ply->format != ASCII && p->count_type == NUMBER_U8 && ply->at < ply->end)
        count = *ply->at++;
    else if (!read_number(ply, p->count_type, &count))
        return false;
    uint64_t each = ply->format == ASCII ? 2 : number_size(p->type), left = (uint64_t)(ply->end - ply->at);
    if (!(count >= 0 && count == floor(count) && count <= UINT32_MAX / 2) || count > (double)(left / each + 1)) {
        ply->at = before;
        return error_set(ply->error, ERROR_SCENE,
                         ply->format == ASCII ? "%s:%zu: a list of %.15g entries does not fit into the file"
                                              : "%s: byte %zu: a list of %.15g entries does not fit into the file",
                         ply->path, ply->format == ASCII ? ply->line : (size_t)(before - ply->data), count);
    }
    *out = (uint32_t)count;
    return true;
}

static bool skip_list(struct ply *ply, const struct property *p) {
    uint32_t count;
    if (!read_count(ply, p, &count))
        return false;
    if (ply->format != ASCII) {
        uint64_t bytes = (uint64_t)count * number_size(p->type);
        if ((uint64_t)(ply->end - ply->at) < bytes)
            return fail(ply, "the file ends too early");
        ply->at += bytes;
        return true;
    }
    double ignored;
    for (uint32_t i = 0; i < count; i++)
        if (!read_text_number(ply, &ignored))
            return false;
    return true;
}

/* --- elements --- */

static bool note_odd_vertex(struct ply *ply, const uint8_t *number) {
    struct odd_vertex *odd = list_room(&ply->odd_vertices, 1, sizeof *odd);
    if (!odd)
        return no_memory(ply);
    odd->number = ply->mesh->vertices.count;
    odd->at = ply->format == ASCII ? ply->line : (size_t)(number - ply->data);
    ply->odd_vertices.count++;
    return true;
}

static bool read_vertex(struct ply *ply, const struct element *element, double value[SCALARS]) {
    const uint8_t *odd = NULL;
    for (int k = 0; k < element->property_count; k++) {
        const struct property *p = &ply->properties[element->first + k];
        if (p->is_list) {
            if (!skip_list(ply, p))
                return false;
            continue;
        }
        const uint8_t *before = ply->at;
        if (!read_number(ply, p->type, &value[p->meaning]))
            return false;
        if (!isfinite(value[p->meaning]) && p->meaning >= X && p->meaning <= Z && !odd)
            odd = before;
    }
    return !odd || note_odd_vertex(ply, odd);
}

/* The line of the row that is read, or the byte after it. */
static size_t position_of_row(const struct ply *ply) {
    return ply->format == ASCII ? ply->line : (size_t)(ply->at - ply->data);
}

/* A row of numbers that the mesh can use, or NaN. */
static bool add_numbers(struct ply *ply, struct list *list, const double *values, int width, struct left_out *odd) {
    double *out = list_room(list, 1, (size_t)width * sizeof *out);
    if (!out)
        return no_memory(ply);
    bool fine = true;
    for (int k = 0; k < width; k++) {
        out[k] = values[k];
        fine = fine && number_in_range(values[k]);
    }
    list->count++;
    if (!fine) {
        out[0] = NAN;
        left_out_add(odd, position_of_row(ply));
    }
    return true;
}

static bool add_colour(struct ply *ply, const double value[SCALARS], double scale) {
    float *c = list_room(&ply->mesh->colours, 1, 3 * sizeof *c);
    if (!c)
        return no_memory(ply);
    bool fine = isfinite(value[RED]) && isfinite(value[GREEN]) && isfinite(value[BLUE]);
    for (int k = 0; k < 3; k++)
        c[k] = fine ? (float)number_clamped(math_max(value[RED + k] * scale, 0), 1) : 1;
    ply->mesh->colours.count++;
    if (!fine)
        left_out_add(&ply->odd_colours, position_of_row(ply));
    return true;
}

static bool has_colour(const struct element *element) {
    return element->has[RED] && element->has[GREEN] && element->has[BLUE];
}

static bool add_vertex(struct ply *ply, const struct element *element, const double value[SCALARS]) {
    struct model_mesh *mesh = ply->mesh;
    double *v = list_room(&mesh->vertices, 1, 3 * sizeof *v);
    assert(v); /* of the capacity that reserve() allocated */
    v[0] = value[X], v[1] = value[Y], v[2] = value[Z];
    mesh->vertices.count++;
    return (!mesh->normals_by_vertex || add_numbers(ply, &mesh->normals, value + NX, 3, &ply->odd_normals)) &&
           (!mesh->uvs_by_vertex || add_numbers(ply, &mesh->uvs, value + U, 2, &ply->odd_uvs)) &&
           (!has_colour(element) || add_colour(ply, value, element->colour_scale));
}

static bool add_face(struct ply *ply, const uint32_t *corners, uint32_t count) {
    struct model_mesh *mesh = ply->mesh;
    uint32_t *start = list_room(&mesh->starts, 2, sizeof *start);
    uint32_t *index = start ? list_room(&mesh->vertex_index, count, sizeof *index) : NULL;
    if (!index)
        return no_memory(ply);
    if (mesh->vertex_index.count + count > model_max(ply->model))
        return fail(ply, "more corners than an index can name");
    *start = (uint32_t)mesh->vertex_index.count;
    mesh->starts.count++;
    memcpy(index, corners, count * sizeof *index);
    mesh->vertex_index.count += count;
    return true;
}

/* Reads a list of vertices into ply->values; MODEL_NONE stands for -1 where that is allowed. */
static bool read_indices(struct ply *ply, const struct property *p, bool restarts) {
    uint32_t count;
    if (!read_count(ply, p, &count))
        return false;
    ply->values.count = 0;
    uint32_t *out = list_room(&ply->values, count ? count : 1, sizeof *out);
    if (!out)
        return no_memory(ply);
    /* A fast path for the usual case: 4-byte numbers in the byte order of this machine. */
    unsigned size = number_size(p->type);
    bool quick = ply->format != ASCII && size == 4;
    uint32_t whole;
    if (quick && (uint64_t)(ply->end - ply->at) < (uint64_t)count * size)
        return fail(ply, "the file ends too early");
    for (uint32_t i = 0; i < count; i++) {
        const uint8_t *before = ply->at;
        double value;
        if (quick) {
            uint32_t bits = scan_u32(ply->at, ply->format == BIG);
            value = p->type == NUMBER_I32 ? (double)(int32_t)bits : (double)bits;
            ply->at += 4;
        } else if (ply->format == ASCII && read_quick_whole(ply, &whole)) {
            value = whole;
        } else if (!read_number(ply, p->type, &value)) {
            return false;
        }
        if (restarts && value == -1) {
            out[i] = MODEL_NONE;
            continue;
        }
        if (!(value >= 0 && value < (double)ply->vertex_total && value == floor(value))) {
            size_t position = ply->format == ASCII ? ply->line : (size_t)(before - ply->data);
            return error_set(ply->error, ERROR_SCENE,
                             ply->format == ASCII ? "%s:%zu: vertex %.15g, but the file has %llu, counted from 0"
                                                  : "%s: byte %zu: vertex %.15g, but the file has %llu, counted from 0",
                             ply->path, position, value, (unsigned long long)ply->vertex_total);
        }
        out[i] = (uint32_t)value;
    }
    ply->values.count = count;
    return true;
}

/* (u, v) for each corner of the face. */
static bool read_corner_uvs(struct ply *ply, const struct property *p) {
    uint32_t count;
    if (!read_count(ply, p, &count))
        return false;
    ply->pending.count = 0;
    double *out = list_room(&ply->pending, count ? count : 1, sizeof *out);
    if (!out)
        return no_memory(ply);
    bool fine = true;
    for (uint32_t i = 0; i < count; i++) {
        if (!read_number(ply, p->type, &out[i]))
            return false;
        fine = fine && number_in_range(out[i]);
    }
    ply->pending.count = fine ? count : 0;
    if (!fine)
        left_out_add(&ply->odd_uvs, position_of_row(ply));
    return true;
}

/* The corners of triangles from strips have no texture coordinates of their own: fills the list up to this corner. */
static bool pad_corner_uvs(struct ply *ply, size_t corner) {
    struct list *index = &ply->mesh->uv_index;
    while (index->count < corner)
        if (!list_add_index(index, MODEL_NONE))
            return no_memory(ply);
    return true;
}

static bool add_corner_uvs(struct ply *ply, uint32_t corners) {
    struct model_mesh *mesh = ply->mesh;
    if (!pad_corner_uvs(ply, mesh->vertex_index.count - corners))
        return false;
    bool given = ply->pending.count == 2 * (size_t)corners;
    double *uv = list_room(&mesh->uvs, corners, 2 * sizeof *uv);
    uint32_t *index = uv ? list_room(&mesh->uv_index, corners, sizeof *index) : NULL;
    if (!index)
        return no_memory(ply);
    for (uint32_t i = 0; i < corners; i++)
        index[i] = given ? (uint32_t)(mesh->uvs.count + i) : MODEL_NONE;
    mesh->uv_index.count += corners;
    if (given) {
        memcpy(uv, ply->pending.items, 2 * (size_t)corners * sizeof *uv);
        mesh->uvs.count += corners;
    }
    return true;
}

/* White, for the faces of strips. */
static bool pad_colours(struct ply *ply, size_t count) {
    static const double white[SCALARS] = {[RED] = 1, [GREEN] = 1, [BLUE] = 1};
    while (ply->mesh->colours.count < count)
        if (!add_colour(ply, white, 1))
            return false;
    return true;
}

static bool read_face(struct ply *ply, const struct element *element, bool corner_uvs) {
    bool any = false;
    double *value = ply->numbers;
    ply->pending.count = 0;
    for (int k = 0; k < element->property_count; k++) {
        const struct property *p = &ply->properties[element->first + k];
        bool ok = p->meaning == CORNERS      ? read_indices(ply, p, false)
                  : p->meaning == CORNER_UVS ? read_corner_uvs(ply, p)
                  : p->is_list               ? skip_list(ply, p)
                                             : read_number(ply, p->type, &value[p->meaning]);
        if (!ok)
            return false;
        any |= p->meaning == CORNERS;
    }
    if (!any)
        return true;
    if (ply->values.count < 3) {
        left_out_add(&ply->short_faces, position_of_row(ply));
        return true;
    }
    uint32_t count = (uint32_t)ply->values.count;
    return add_face(ply, ply->values.items, count) && (!corner_uvs || add_corner_uvs(ply, count)) &&
           (!ply->mesh->colours_by_face || !has_colour(element) ||
            (pad_colours(ply, ply->mesh->starts.count - 1) && add_colour(ply, value, element->colour_scale)));
}

/* Each vertex from the third on makes a triangle; every second triangle is reversed. */
static bool add_strips(struct ply *ply) {
    const uint32_t *v = ply->values.items;
    size_t first = 0;
    for (size_t i = 0; i < ply->values.count; i++) {
        if (v[i] == MODEL_NONE) {
            first = i + 1;
            continue;
        }
        if (i < first + 2)
            continue;
        bool odd = (i - first) % 2;
        const uint32_t corners[3] = {v[i - 2], odd ? v[i] : v[i - 1], odd ? v[i - 1] : v[i]};
        /* Degenerate triangles join strips. */
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[0] != corners[2] &&
            !add_face(ply, corners, 3))
            return false;
    }
    return true;
}

static bool read_row(struct ply *ply, const struct element *element, bool corner_uvs) {
    if (element->kind == VERTICES) {
        double value[SCALARS] = {0};
        return read_vertex(ply, element, value) && add_vertex(ply, element, value);
    }
    if (element->kind == FACES)
        return read_face(ply, element, corner_uvs);
    double ignored;
    for (int k = 0; k < element->property_count; k++) {
        const struct property *p = &ply->properties[element->first + k];
        bool ok = p->meaning == STRIPS ? read_indices(ply, p, true) && add_strips(ply)
                  : p->is_list         ? skip_list(ply, p)
                                       : read_number(ply, p->type, &ignored);
        if (!ok)
            return false;
    }
    return true;
}

/* Skips rows of binary numbers without lists and without meaning for the mesh all at once. */
static bool skip_at_once(struct ply *ply, const struct element *element) {
    for (int k = 0; k < element->property_count; k++)
        if (ply->properties[element->first + k].is_list)
            return false;
    return ply->format != ASCII && element->kind == OTHER;
}

/* Reserves memory for the number of elements that the header states and the remaining bytes can contain, so that
 * lists need not grow. */
static bool reserve(struct ply *ply, const struct element *element) {
    struct model_mesh *mesh = ply->mesh;
    if (element->kind == VERTICES)
        return list_room(&mesh->vertices, element->count, 3 * sizeof(double)) != NULL;
    if (element->kind == OTHER)
        return true;
    uint64_t left = (uint64_t)(ply->end - ply->at), corners = 3 * element->count;
    return list_room(&mesh->starts, element->count + 2, sizeof(uint32_t)) &&
           list_room(&mesh->vertex_index, corners < left / 2 ? corners : left / 2, sizeof(uint32_t));
}

static bool read_rows(struct ply *ply, const struct element *element) {
    uint64_t left = (uint64_t)(ply->end - ply->at);
    if (element->property_count == 0)
        return true;
    /* The last line of a text needs no line end. */
    if (element->count > (left + 1) / element->min)
        return error_set(ply->error, ERROR_SCENE,
                         ply->format == ASCII
                             ? "%s:%zu: the header promises %llu of '%s', but the file is too short for them"
                             : "%s: byte %zu: the header promises %llu of '%s', but the file is too short for them",
                         ply->path, ply->format == ASCII ? ply->line : (size_t)(ply->at - ply->data),
                         (unsigned long long)element->count, element->name);
    if (skip_at_once(ply, element)) {
        if (element->count > left / element->min)
            return fail(ply, "the file ends too early");
        ply->at += element->count * element->min;
        return true;
    }
    if (!reserve(ply, element))
        return no_memory(ply);
    bool corner_uvs = false;
    for (int k = 0; k < element->property_count; k++)
        corner_uvs |= ply->properties[element->first + k].meaning == CORNER_UVS && !ply->mesh->uvs_by_vertex;
    for (uint64_t row = 0; row < element->count; row++) {
        while (ply->format == ASCII && !on_word(ply) && ply->at < ply->end)
            over_line_end(ply); /* empty lines */
        if (!read_row(ply, element, corner_uvs))
            return false;
        if (ply->format == ASCII && on_word(ply))
            return fail(ply, "more numbers on this line than the header says");
        if (ply->format == ASCII)
            over_line_end(ply);
    }
    return true;
}

/* Corners whose normal or texture coordinates were odd have none: the index list of the vertices becomes one of them.
 */
static bool leave_out_odd(struct ply *ply, struct list *rows, size_t width, bool *by_vertex, struct list *index) {
    double *numbers = rows->items;
    size_t corners = ply->mesh->vertex_index.count;
    const uint32_t *vertex = ply->mesh->vertex_index.items;
    uint32_t *out = list_room(index, corners, sizeof *out);
    if (!out)
        return no_memory(ply);
    for (size_t i = 0; i < corners; i++)
        out[i] = isnan(numbers[width * vertex[i]]) ? MODEL_NONE : vertex[i];
    index->count = corners;
    *by_vertex = false;
    for (size_t i = 0; i < rows->count; i++)
        if (isnan(numbers[width * i]))
            memset(numbers + width * i, 0, width * sizeof *numbers);
    return true;
}

/* A vertex that is not finite is an error if a face uses it. */
static bool check_vertices(struct ply *ply) {
    double(*vertices)[3] = ply->mesh->vertices.items;
    const uint32_t *index = ply->mesh->vertex_index.items;
    const struct odd_vertex *odd = ply->odd_vertices.items;
    for (size_t i = 0; i < ply->odd_vertices.count; i++)
        vertices[odd[i].number][0] = NAN;
    for (size_t i = 0; i < ply->mesh->vertex_index.count && ply->odd_vertices.count; i++) {
        if (!isnan(vertices[index[i]][0]))
            continue;
        while (odd->number != index[i])
            odd++;
        ply->line = odd->at;
        ply->at = ply->data + (ply->format == ASCII ? 0 : odd->at);
        return fail(ply, "not a finite number");
    }
    for (size_t i = 0; i < ply->odd_vertices.count; i++)
        memset(vertices[odd[i].number], 0, sizeof *vertices);
    return true;
}

static void warn_of(struct ply *ply, const struct left_out *out, const char *what) {
    model_warn_left_out(ply->model, ply->path, out, ply->format != ASCII, what);
}

/* Elements that have no meaning for the mesh: edges, cameras and others. */
static void warn_of_elements(struct ply *ply) {
    char names[400] = "";
    size_t used = 0;
    for (int i = 0; i < ply->element_count && used < 300; i++) {
        const struct element *e = &ply->elements[i];
        if (e->kind == OTHER && e->count > 0 && strcmp(e->name, "tristrips") != 0)
            used += (size_t)snprintf(names + used, sizeof names - used, "%s'%s' (%llu)", used ? ", " : "", e->name,
                                     (unsigned long long)e->count);
    }
    if (used)
        model_warn(ply->model, "%s: elements that gray does not show: %s", ply->path, names);
}

/* Everything that is decided at the end of the file, and its warnings. */
static bool finish(struct ply *ply) {
    struct model_mesh *mesh = ply->mesh;
    struct left_out unused = {ply->odd_vertices.count, 0};
    if (unused.count)
        unused.at = ((const struct odd_vertex *)ply->odd_vertices.items)->at;
    if (!check_vertices(ply) ||
        (ply->odd_normals.count &&
         !leave_out_odd(ply, &mesh->normals, 3, &mesh->normals_by_vertex, &mesh->normal_index)) ||
        (ply->odd_uvs.count && mesh->uvs_by_vertex &&
         !leave_out_odd(ply, &mesh->uvs, 2, &mesh->uvs_by_vertex, &mesh->uv_index)) ||
        (mesh->uv_index.count && !pad_corner_uvs(ply, mesh->vertex_index.count)) ||
        (mesh->colours_by_face && !pad_colours(ply, mesh->starts.count)))
        return false;
    warn_of(ply, &unused, "a vertex is not finite, and no face uses it");
    warn_of(ply, &ply->odd_normals, "a normal is not finite: faces that use it are flat");
    warn_of(ply, &ply->odd_uvs, "texture coordinates are not finite: faces that use them have none");
    warn_of(ply, &ply->odd_colours, "a colour is not finite: it is white");
    warn_of(ply, &ply->short_faces, "a face needs at least 3 corners: it is left out");
    warn_of(ply, &ply->unseen_colours, "the faces have colours, which are not shown: the vertices have colours");
    warn_of_elements(ply);
    return true;
}

/* The picture of a comment: TextureFile NAME, as MeshLab writes it. */
static bool add_picture(struct ply *ply) {
    struct model_material *material = model_add_material(ply->model, ply->error);
    if (!material || !list_add_index(&ply->mesh->slots, 0))
        return no_memory(ply);
    struct model_texture *map = &material->map_kd;
    material->kd = colour_all(1);
    map->name = arena_copy_text(&ply->model->arena, ply->picture.text, ply->picture.length);
    if (!map->name)
        return no_memory(ply);
    if (!model_find(ply->model, map->name, ply->picture.length, &map->path, ply->error))
        return false;
    if (!map->path && !ply->model->options.single_file)
        model_warn(ply->model, "%s: the picture '%.200s' %s", ply->path, map->name, model_why_missing(ply->model));
    return true;
}

static bool load(struct ply *ply) {
    if (!read_header(ply))
        return false;
    ply->line++;
    struct model_mesh *mesh = ply->mesh;
    for (int i = 0; i < ply->element_count; i++)
        if (ply->elements[i].kind == VERTICES) {
            ply->vertex_total = ply->elements[i].count;
            memcpy(ply->has, ply->elements[i].has, sizeof ply->has);
        }
    for (int i = 0; i < ply->element_count; i++)
        if (ply->elements[i].kind == FACES && has_colour(&ply->elements[i])) {
            mesh->colours_by_face = !(ply->has[RED] && ply->has[GREEN] && ply->has[BLUE]);
            if (!mesh->colours_by_face)
                left_out_add(&ply->unseen_colours, position_of_row(ply));
        }
    if (ply->vertex_total >= UINT32_MAX - 1)
        return error_set(ply->error, ERROR_SCENE, "%s: %llu vertices are too many", ply->path,
                         (unsigned long long)ply->vertex_total);
    if (ply->vertex_total && !(ply->has[X] && ply->has[Y] && ply->has[Z]))
        return error_set(ply->error, ERROR_SCENE, "%s: the vertices have no x, y and z", ply->path);
    mesh->normals_by_vertex = ply->has[NX] && ply->has[NY] && ply->has[NZ];
    mesh->uvs_by_vertex = ply->has[U] && ply->has[V];
    for (int i = 0; i < ply->element_count; i++)
        if (!read_rows(ply, &ply->elements[i]))
            return false;
    return finish(ply);
}

bool ply_load(struct model *model, const uint8_t *data, size_t size, struct error *error) {
    struct ply ply = {
        .model = model, .path = model->path, .data = data, .at = data, .end = data + size, .error = error};
    if (size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0)
        ply.at += 3;
    ply.mesh = model_add_mesh(model, error);
    if (!ply.mesh)
        return false;
    bool ok = load(&ply);
    list_destroy(&ply.values);
    list_destroy(&ply.pending);
    list_destroy(&ply.odd_vertices);
    return ok && (!ply.picture.text || ply.mesh->uvs.count == 0 || add_picture(&ply)) &&
           (ply.mesh->colours.count == 0 || model_show_colours(model, ply.mesh, error));
}
