/* Wavefront MTL: each line is a keyword and its values, which belong to the last newmtl. Source: D. Ramey, L. Rose,
 * L. Tyerman, "MTL material format (Lightwave, OBJ)", 1995, and the keywords of current exporters (map_bump, norm,
 * Ke, Pr). Unknown keywords are skipped. A name extends to the end of its line, including blanks; the name of a
 * picture follows its options. */
#include "formats/model.h"

#include "formats/decimal_internal.h"

#include <string.h>

enum { MATERIAL_LIMIT = 65536 };

struct library {
    struct model *model;
    const char *path;
    const char *at, *end; /* of the line */
    size_t line;
    struct error *error;
    struct model_material *material;
};

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f'; /* \r ends a line */
}

static bool fail(const struct library *l, const char *what) {
    return error_set(l->error, ERROR_SCENE, "%s:%zu: %s", l->path, l->line, what);
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

static bool read_number(struct library *l, double *out) {
    size_t length = next_word(l);
    if (!word_is_number(l, length, out)) {
        int shown = length < 40 ? (int)length : 40;
        char word[41];
        for (int i = 0; i < shown; i++)
            word[i] = l->at[i] >= 0x20 && l->at[i] < 0x7f ? l->at[i] : '?';
        word[shown] = '\0';
        return error_set(l->error, ERROR_SCENE, "%s:%zu: '%s' is not a finite number", l->path, l->line, word);
    }
    l->at += length;
    return true;
}

/* Reads one number for all three, or three numbers; false for other forms (spectral, xyz). */
static bool read_colour(struct library *l, struct vec3 *out) {
    size_t length = next_word(l);
    if (is_word(l, length, "spectral") || is_word(l, length, "xyz"))
        return true;
    double x, y, z;
    if (!read_number(l, &x))
        return false;
    y = z = x;
    if (next_word(l) && !read_number(l, &y))
        return false;
    if (next_word(l) && !read_number(l, &z))
        return false;
    *out = vec3_make(x, y, z);
    return true;
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
        model_warn(l->model, "%s:%zu: the name of a picture is missing, so the line has no effect", l->path, l->line);
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
    if (length == 0)
        return fail(l, "newmtl needs a name");
    if (l->model->materials.count == MATERIAL_LIMIT)
        return error_set(l->error, ERROR_SCENE, "%s:%zu: more than %d materials", l->path, l->line, MATERIAL_LIMIT);
    l->material = model_add_material(l->model, l->error);
    if (!l->material)
        return false;
    l->material->name = arena_copy_text(&l->model->arena, name, length);
    return l->material->name || error_no_memory(l->error, l->path);
}

static bool read_dissolve(struct library *l, double sign) {
    double value;
    size_t length = next_word(l);
    if (is_word(l, length, "-halo"))
        l->at += length;
    if (!read_number(l, &value))
        return false;
    value = sign > 0 ? value : 1 - value;
    l->material->dissolve = value < 0 ? 0 : value > 1 ? 1 : value;
    return true;
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
    /* Unknown statements are passed over: there are many dialects. */
    for (size_t i = 0; i < sizeof colours / sizeof colours[0]; i++)
        if (is_word(&word, length, colours[i].word))
            return read_colour(l, (struct vec3 *)(void *)((char *)m + colours[i].offset));
    for (size_t i = 0; i < sizeof maps / sizeof maps[0]; i++)
        if (is_word(&word, length, maps[i].word))
            return read_map(l, (struct model_texture *)(void *)((char *)m + maps[i].offset));
    if (is_word(&word, length, "Ns"))
        return read_number(l, &m->shininess) && (m->has_shininess = true);
    if (is_word(&word, length, "Ni"))
        return read_number(l, &m->ior) && (m->has_ior = true);
    if (is_word(&word, length, "d"))
        return read_dissolve(l, 1);
    if (is_word(&word, length, "Tr"))
        return read_dissolve(l, -1);
    if (is_word(&word, length, "illum")) {
        double value;
        if (!read_number(l, &value))
            return false;
        m->illum = value >= 0 && value <= 10 ? (int)value : -1;
    }
    return true;
}

bool mtl_load(struct model *model, const char *path, const char *text, size_t size, struct error *error) {
    struct library library = {.model = model, .path = path, .error = error};
    const char *end = text + size;
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
    return true;
}
