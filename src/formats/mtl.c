/* Wavefront MTL: each line is a keyword and its values, which belong to the last newmtl. Source: D. Ramey, L. Rose,
 * L. Tyerman, "MTL material format (Lightwave, OBJ)", 1995, and the keywords of current exporters (map_bump, norm,
 * Ke, Pr). One warning names the keywords that are not read; a statement whose value is wrong is left out, with a
 * warning. A name extends to the end of its line, including blanks; the name of a picture follows its options. */
#include "formats/model.h"

#include "formats/decimal_internal.h"
#include "math/range.h"

#include <math.h>
#include <string.h>

enum { MATERIAL_LIMIT = 65536 };

struct library {
    struct model *model;
    const char *path;
    const char *at, *end; /* of the line */
    size_t line;
    struct error *error;
    struct model_material *material;
    size_t first_material; /* of the library, in the model */
    bool has_dissolve;     /* the material has a d, which wins over Tr */
    struct unread unread;
    struct left_out wrong, nameless, transparencies;
};

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f'; /* \r ends a line */
}

/* The next word of the line; its length is 0 at the end. */
static size_t next_word(struct library *l) {
    while (l->at < l->end && is_blank(*l->at))
        l->at++;
    const char *p = l->at;
    while (p < l->end && !is_blank(*p))
        p++;
    return (size_t)(p - l->at);
}

static bool is_word(const struct library *l, size_t length, const char *word) {
    if (strlen(word) != length)
        return false;
    for (size_t i = 0; i < length; i++) {
        char a = l->at[i], b = word[i];
        if ((a >= 'A' && a <= 'Z' ? a + 32 : a) != (b >= 'A' && b <= 'Z' ? b + 32 : b))
            return false;
    }
    return true;
}

static bool word_is_number(const struct library *l, size_t length, double *out) {
    return length > 0 && decimal_read(l->at, l->at + length, out) == l->at + length;
}

/* Up to `max` numbers; false, and nothing changes, if one is wrong or fewer than `min` are there. */
static bool read_numbers(struct library *l, double *out, int min, int max) {
    double values[3];
    int count = 0;
    for (size_t length; count < max && (length = next_word(l)) > 0 && *l->at != '#'; count++) {
        if (!word_is_number(l, length, &values[count]) || !number_in_range(values[count])) {
            count = 0;
            break;
        }
        l->at += length;
    }
    if (count < min)
        left_out_add(&l->wrong, l->line);
    else
        memcpy(out, values, (size_t)count * sizeof *out);
    return count >= min;
}

/* One number for all three, or three numbers; other forms (spectral, xyz) are not read. */
static void read_colour(struct library *l, const struct library *keyword, size_t keyword_length, struct colour *out) {
    size_t length = next_word(l);
    double rgb[3] = {0, NAN, NAN};
    if (is_word(l, length, "spectral") || is_word(l, length, "xyz")) {
        unread_add(&l->unread, keyword->at, keyword_length, l->line);
        return;
    }
    if (read_numbers(l, rgb, 1, 3))
        *out = colour_make(rgb[0], isnan(rgb[1]) ? rgb[0] : rgb[1], isnan(rgb[2]) ? rgb[0] : rgb[2]);
}

/* The rest of the line without blanks at its ends. */
static const char *rest(struct library *l, size_t *length) {
    (void)next_word(l);
    const char *end = l->end;
    while (end > l->at && is_blank(end[-1]))
        end--;
    *length = (size_t)(end - l->at);
    return l->at;
}

/* Reads up to three numbers after an option; they replace the first ones in `out`. */
static void option_numbers(struct library *l, double out[3], int max) {
    for (int i = 0; i < max; i++) {
        size_t length = next_word(l);
        double value;
        if (!word_is_number(l, length, &value))
            return;
        out[i] = value;
        l->at += length;
    }
}

static bool option_on(struct library *l) {
    size_t length = next_word(l);
    bool on = is_word(l, length, "on");
    l->at += length;
    return on;
}

static bool read_map(struct library *l, struct model_texture *map) {
    double scale[3] = {1, 1, 1}, offset[3] = {0, 0, 0}, strength[3] = {1}, ignored[3];
    bool clamp = false;
    for (size_t length; (length = next_word(l)) > 1 && *l->at == '-';) {
        const char *option = l->at;
        l->at += length;
        struct library word = *l;
        word.at = option;
        if (is_word(&word, length, "-s"))
            option_numbers(l, scale, 3);
        else if (is_word(&word, length, "-o"))
            option_numbers(l, offset, 3);
        else if (is_word(&word, length, "-t"))
            option_numbers(l, ignored, 3);
        else if (is_word(&word, length, "-bm"))
            option_numbers(l, strength, 1);
        else if (is_word(&word, length, "-mm"))
            option_numbers(l, ignored, 2);
        else if (is_word(&word, length, "-boost") || is_word(&word, length, "-texres"))
            option_numbers(l, ignored, 1);
        else if (is_word(&word, length, "-clamp"))
            clamp = option_on(l);
        else if (is_word(&word, length, "-blendu") || is_word(&word, length, "-blendv") ||
                 is_word(&word, length, "-cc") || is_word(&word, length, "-imfchan") || is_word(&word, length, "-type"))
            (void)option_on(l);
        else {
            l->at = option; /* a name that begins with a dash */
            break;
        }
    }
    size_t length;
    const char *name = rest(l, &length);
    if (length == 0) {
        left_out_add(&l->nameless, l->line);
        return true;
    }
    map->scale[0] = scale[0], map->scale[1] = scale[1];
    map->offset[0] = offset[0], map->offset[1] = offset[1];
    map->strength = strength[0];
    map->wrap_u = map->wrap_v = clamp ? IMAGE_CLAMP : IMAGE_REPEAT;
    map->name = arena_copy_text(&l->model->arena, name, length);
    if (!map->name)
        return error_no_memory(l->error, l->path);
    /* Names in a library are relative to the library, which is usually in the model's folder. */
    const char *slash = strrchr(l->path, '/');
    if (slash && !l->model->options.single_file && name[0] != '/') {
        int folder = (int)(slash + 1 - l->path);
        char *beside = arena_format(&l->model->arena, "%.*s%s", folder, l->path, map->name);
        if (!beside)
            return error_no_memory(l->error, l->path);
        for (char *c = beside + folder; *c; c++)
            *c = *c == '\\' ? '/' : *c;
        if (path_policy_is_readable(l->model->options.path_policy, beside)) {
            map->path = beside;
            return true;
        }
    }
    if (!model_find(l->model, name, length, &map->path, l->error))
        return false;
    const char *where = map->path ? "" : arena_format(&l->model->arena, "%s:%zu", l->path, l->line);
    if (!where)
        return error_no_memory(l->error, l->path);
    if (!map->path)
        model_warn_missing(l->model, where, map->name);
    return true;
}

static bool new_material(struct library *l) {
    size_t length;
    const char *name = rest(l, &length);
    if (l->model->materials.count == MATERIAL_LIMIT)
        return error_set(l->error, ERROR_SCENE, "%s:%zu: more than %d materials", l->path, l->line, MATERIAL_LIMIT);
    l->material = model_add_material(l->model, l->error);
    if (!l->material)
        return false;
    l->has_dissolve = false;
    l->material->name = arena_copy_text(&l->model->arena, name, length);
    return l->material->name || error_no_memory(l->error, l->path);
}

static void read_dissolve(struct library *l, bool is_transparency) {
    double value;
    size_t length = next_word(l);
    if (is_word(l, length, "-halo"))
        l->at += length;
    if (!read_numbers(l, &value, 1, 1) || (is_transparency && l->has_dissolve))
        return;
    value = is_transparency ? 1 - value : value;
    l->has_dissolve = !is_transparency;
    l->material->dissolve = value < 0 ? 0 : value > 1 ? 1 : value;
    l->material->dissolve_of_tr = is_transparency;
    if (is_transparency)
        left_out_add(&l->transparencies, l->line);
}

/* Nothing of it is seen: neither refraction nor a coloured filter. */
static bool is_invisible(const struct model_material *m) {
    bool bends = m->has_ior && m->ior != 1 && (m->illum < 0 || m->illum == 6 || m->illum == 7);
    return m->dissolve == 0 && !bends && colour_max_abs(colour_sub(m->filter, colour_all(1))) == 0;
}

/* MeshLab wrote Tr 1 for opaque materials until 2023. */
static void show_invisible(struct library *l) {
    struct model_material *materials = model_materials(l->model);
    size_t count = l->model->materials.count;
    struct left_out opaque = {0};
    for (size_t i = l->first_material; i < count; i++)
        if (!is_invisible(&materials[i]))
            return;
    for (size_t i = l->first_material; i < count; i++)
        if (materials[i].dissolve_of_tr) {
            materials[i].dissolve = 1;
            left_out_add(&opaque, l->transparencies.at);
        }
    model_warn_left_out(l->model, l->path, &opaque, false,
                        "Tr makes every material of this file invisible: it is opaque instead");
}

/* What changes nothing visible, or nothing that Kd and its picture do not show. */
static bool is_silent(const struct library *word, size_t length) {
    static const char *const words[] = {"map_Ka", "Km", "sharpness", "map_aat"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (is_word(word, length, words[i]))
            return true;
    return false;
}

static bool read_statement(struct library *l) {
    size_t length = next_word(l);
    const struct library word = *l;
    if (length == 0 || *l->at == '#')
        return true;
    l->at += length;
    if (is_word(&word, length, "newmtl"))
        return new_material(l);
    /* Statements before the first material belong to none. */
    struct model_material *m = l->material;
    if (!m)
        return true;
    static const struct {
        const char *word;
        size_t offset;
    } colours[] = {{"Ka", offsetof(struct model_material, ka)},
                   {"Kd", offsetof(struct model_material, kd)},
                   {"Ks", offsetof(struct model_material, ks)},
                   {"Ke", offsetof(struct model_material, ke)},
                   {"Tf", offsetof(struct model_material, filter)}},
      maps[] = {{"map_Kd", offsetof(struct model_material, map_kd)},
                {"map_Ks", offsetof(struct model_material, map_ks)},
                {"map_Ke", offsetof(struct model_material, map_ke)},
                {"map_d", offsetof(struct model_material, map_d)},
                {"map_bump", offsetof(struct model_material, map_bump)},
                {"bump", offsetof(struct model_material, map_bump)},
                {"norm", offsetof(struct model_material, map_normal)},
                {"map_Kn", offsetof(struct model_material, map_normal)}};
    for (size_t i = 0; i < sizeof colours / sizeof colours[0]; i++)
        if (is_word(&word, length, colours[i].word)) {
            read_colour(l, &word, length, (struct colour *)(void *)((char *)m + colours[i].offset));
            return true;
        }
    for (size_t i = 0; i < sizeof maps / sizeof maps[0]; i++)
        if (is_word(&word, length, maps[i].word))
            return read_map(l, (struct model_texture *)(void *)((char *)m + maps[i].offset));
    if (is_word(&word, length, "Ns")) {
        m->has_shininess |= read_numbers(l, &m->shininess, 1, 1);
    } else if (is_word(&word, length, "Ni")) {
        m->has_ior |= read_numbers(l, &m->ior, 1, 1);
    } else if (is_word(&word, length, "d")) {
        read_dissolve(l, false);
    } else if (is_word(&word, length, "Tr")) {
        read_dissolve(l, true);
    } else if (is_word(&word, length, "illum")) {
        double value;
        if (read_numbers(l, &value, 1, 1))
            m->illum = value >= 0 && value <= 10 ? (int)value : -1;
    } else if (!is_silent(&word, length)) {
        unread_add(&l->unread, word.at, length, l->line);
    }
    return true;
}

bool mtl_load(struct model *model, const char *path, const char *text, size_t size, struct error *error) {
    struct library library = {.model = model, .path = path, .error = error, .first_material = model->materials.count};
    const char *end = text + size;
    if (!text_is_readable(path, text, size, error))
        return false;
    if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0)
        text += 3;
    while (text < end) {
        library.line++;
        const char *line_end = text;
        while (line_end < end && *line_end != '\n' && *line_end != '\r')
            line_end++;
        library.at = text;
        library.end = line_end;
        if (!read_statement(&library))
            return false;
        text = line_end + 1;
        if (line_end + 1 < end && line_end[0] == '\r' && line_end[1] == '\n')
            text++;
    }
    show_invisible(&library);
    model_warn_unread(model, path, &library.unread);
    model_warn_left_out(model, path, &library.wrong, false, "a value is not a finite number: it is left out");
    model_warn_left_out(model, path, &library.nameless, false, "the name of a picture is missing");
    return true;
}
