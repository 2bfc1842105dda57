/* Letters from font files by FreeType. Outlines are read in font units, neither scaled nor hinted: they are the
 * designer's numbers in every version of the library, and no program inside a font runs. Kerning is that of the
 * font's kern table. Source: Apple, "TrueType Reference Manual"; FreeType's documentation.
 *
 * FreeType allocates from base/mem.h through callbacks that count. They refuse memory to a file that requests more
 * than a generous multiple of what fonts need. */
#include "formats/font.h"

#ifndef HAVE_FREETYPE

bool font_layout(const struct font_file *file, const char *text, struct arena *arena, struct font_text *out,
                 struct error *error) {
    (void)text, (void)arena, (void)out;
    return error_set(error, ERROR_SCENE, "%s: this build cannot read fonts (it was made without FreeType)", file->path);
}

const char *font_library(void) {
    return "none";
}

#else

#include "base/fault.h"
#include "base/mem.h"

#include <assert.h>
#include <stdalign.h>
#include <string.h>

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_OUTLINE_H
#include FT_MODULE_H

enum { MEMORY_LIMIT = 1 << 28, HEADER = alignof(max_align_t) };

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

/* The size of each block is stored in front of it, because FreeType does not pass it when it frees the block. */
struct memory {
    struct FT_MemoryRec_ hooks;
    size_t used;
    bool beyond;  /* a request exceeded the limit */
    bool refused; /* there was no memory */
};

static void *take(FT_Memory hooks, long size) {
    struct memory *memory = hooks->user;
    assert(size > 0); /* FreeType requests no empty blocks */
    size_t wanted = (size_t)size;
    if (wanted > MEMORY_LIMIT - memory->used) {
        memory->beyond = true;
        return NULL;
    }
    uint8_t *block = mem_alloc(wanted + HEADER);
    if (!block) {
        memory->refused = true;
        return NULL;
    }
    memcpy(block, &wanted, sizeof wanted);
    memory->used += wanted;
    return block + HEADER;
}

static void give(FT_Memory hooks, void *block) {
    struct memory *memory = hooks->user;
    size_t size;
    assert(block);
    memcpy(&size, (uint8_t *)block - HEADER, sizeof size);
    memory->used -= size;
    mem_free((uint8_t *)block - HEADER);
}

static void *change(FT_Memory hooks, long old_size, long size, void *block) {
    void *other = take(hooks, size);
    if (!other)
        return NULL;
    assert(block && old_size > 0); /* otherwise FreeType allocates or frees a block */
    memcpy(other, block, (size_t)(old_size < size ? old_size : size));
    give(hooks, block);
    return other;
}

/* Everything that must be freed, and the result so far. */
struct setting {
    struct memory memory;
    FT_Library library;
    FT_Face face;
    const char *path;
    struct arena *arena;
    struct error *error;
    /* The glyph with the outline that FreeType reports. */
    double scale;
    double (*points)[2];
    uint32_t *starts;
    uint32_t point_count, contour_count;
    FT_Vector at;
};

static bool fail(struct setting *s, FT_Error code) {
    if (s->memory.beyond)
        return error_set(s->error, ERROR_SCENE, "%s: broken font: it asks for too much memory", s->path);
    if (s->memory.refused)
        return error_no_memory(s->error, s->path);
    return error_set(s->error, ERROR_SCENE,
                     "%s: not a font that can be read: it is broken or of an unknown kind (error %d of FreeType)",
                     s->path, code);
}

static void add(struct setting *s, double x, double y) {
    s->points[s->point_count][0] = x * s->scale;
    s->points[s->point_count][1] = y * s->scale;
    s->point_count++;
}

/* The piece from `at` to `to`: its first point and the two between; the last point is the first one of the next
 * piece. */
static void add_piece(struct setting *s, double ax, double ay, double bx, double by, const FT_Vector *to) {
    add(s, (double)s->at.x, (double)s->at.y);
    add(s, ax, ay);
    add(s, bx, by);
    s->at = *to;
}

/* The pieces so far become a contour, unless it has no length. */
static void end_contour(struct setting *s) {
    if (s->point_count > s->starts[s->contour_count])
        s->starts[++s->contour_count] = s->point_count;
}

static int on_move(const FT_Vector *to, void *user) {
    struct setting *s = user;
    end_contour(s);
    s->at = *to;
    return 0;
}

static int on_line(const FT_Vector *to, void *user) {
    struct setting *s = user;
    double x = (double)s->at.x, y = (double)s->at.y, dx = (double)to->x - x, dy = (double)to->y - y;
    if (dx != 0 || dy != 0)
        add_piece(s, x + dx / 3, y + dy / 3, x + dx * 2 / 3, y + dy * 2 / 3, to);
    return 0;
}

static int on_revolved_quadric(const FT_Vector *by, const FT_Vector *to, void *user) {
    struct setting *s = user;
    double x = (double)s->at.x, y = (double)s->at.y, u = (double)to->x, v = (double)to->y;
    double cx = (double)by->x, cy = (double)by->y;
    add_piece(s, x + (cx - x) * 2 / 3, y + (cy - y) * 2 / 3, u + (cx - u) * 2 / 3, v + (cy - v) * 2 / 3, to);
    return 0;
}

static int on_cubic(const FT_Vector *a, const FT_Vector *b, const FT_Vector *to, void *user) {
    add_piece(user, (double)a->x, (double)a->y, (double)b->x, (double)b->y, to);
    return 0;
}

static bool outline_of(struct setting *s, FT_UInt index, struct font_glyph *glyph) {
    static const FT_Outline_Funcs walk = {on_move, on_line, on_revolved_quadric, on_cubic, 0, 0};
    FT_Error code = FT_Load_Glyph(s->face, index, FT_LOAD_NO_SCALE | FT_LOAD_NO_BITMAP);
    if (code)
        return fail(s, code);
    FT_GlyphSlot slot = s->face->glyph;
    glyph->advance = (double)slot->metrics.horiAdvance * s->scale;
    assert(slot->format == FT_GLYPH_FORMAT_OUTLINE); /* FT_LOAD_NO_BITMAP needs a scalable face */
    FT_Outline *outline = &slot->outline;
    if (outline->n_points <= 0)
        return true;
    /* A point makes at most one piece, and one more closes a contour. */
    size_t pieces = (size_t)outline->n_points + (size_t)outline->n_contours;
    s->points = arena_alloc_array(s->arena, 3 * pieces, sizeof *s->points);
    s->starts = arena_alloc_array(s->arena, (size_t)outline->n_contours + 1, sizeof *s->starts);
    if (!s->points || !s->starts)
        return error_no_memory(s->error, s->path);
    s->point_count = s->contour_count = s->starts[0] = 0;
    code = MAY_FAIL(FT_Outline_Decompose(outline, &walk, s));
    if (code)
        return fail(s, code);
    end_contour(s);
    glyph->contour_count = s->contour_count;
    glyph->starts = s->starts;
    glyph->points = (const double(*)[2])s->points;
    return true;
}

/* The next letter of UTF-8 (RFC 3629); false if the bytes are not valid. */
static bool next_letter(const uint8_t **text, uint32_t *code) {
    static const uint32_t min[] = {0, 0x80, 0x800, 0x10000};
    const uint8_t *p = *text;
    int more = *p < 0x80                 ? 0
               : *p >= 0xc2 && *p < 0xe0 ? 1
               : *p >= 0xe0 && *p < 0xf0 ? 2
               : *p >= 0xf0 && *p < 0xf5 ? 3
                                         : -1;
    if (more < 0)
        return false;
    uint32_t c = more == 0 ? *p : *p & (0x3fu >> more);
    for (int k = 1; k <= more; k++) {
        if ((p[k] & 0xc0) != 0x80)
            return false;
        c = c << 6 | (p[k] & 0x3fu);
    }
    *code = c;
    *text = p + more + 1;
    return c >= min[more] && c <= 0x10ffff && (c < 0xd800 || c > 0xdfff);
}

static bool count_letters(struct setting *s, const char *text, uint32_t *count) {
    const uint8_t *p = (const uint8_t *)text;
    for (*count = 0; *p; ++*count) {
        uint32_t code;
        if (!next_letter(&p, &code))
            return error_set(s->error, ERROR_SCENE, "text is not UTF-8 at letter %u", *count + 1);
        if (code < 0x20 || code == 0x7f)
            return error_set(s->error, ERROR_SCENE, "text holds the control character %u at letter %u", code,
                             *count + 1);
        if (*count >= FONT_TEXT_LIMIT)
            return error_set(s->error, ERROR_SCENE, "text is longer than %d letters", FONT_TEXT_LIMIT);
    }
    return true;
}

static bool set_line(struct setting *s, const char *text, struct font_text *out) {
    struct font_glyph *glyphs = arena_alloc_array(s->arena, out->count, sizeof *glyphs);
    const uint8_t *p = (const uint8_t *)text;
    FT_UInt before = 0;
    double x = 0;
    if (!glyphs)
        return error_no_memory(s->error, s->path);
    for (uint32_t k = 0; k < out->count; k++) {
        struct font_glyph *glyph = &glyphs[k];
        (void)next_letter(&p, &glyph->code);
        FT_UInt index = FT_Get_Char_Index(s->face, glyph->code);
        FT_Vector kern = {0, 0};
        if (before && index && FT_HAS_KERNING(s->face))
            (void)FT_Get_Kerning(s->face, before, index, FT_KERNING_UNSCALED, &kern);
        x += (double)kern.x * s->scale;
        glyph->x = x;
        glyph->missing = index == 0;
        if (!outline_of(s, index, glyph))
            return false;
        x += glyph->advance;
        before = index;
    }
    out->glyphs = glyphs;
    out->width = x;
    return true;
}

static bool open_and_set(struct setting *s, const uint8_t *data, size_t size, const char *text, struct font_text *out) {
    if (size > (size_t)1 << 30)
        return error_set(s->error, ERROR_SCENE, "%s: the file is too large for a font", s->path);
    FT_Error code = FT_New_Library(&s->memory.hooks, &s->library);
    if (code)
        return fail(s, code);
    FT_Add_Default_Modules(s->library);
    code = FT_New_Memory_Face(s->library, data, (FT_Long)size, 0, &s->face);
    if (code)
        return fail(s, code);
    int units = MAY_FAIL(s->face->units_per_EM); /* FreeType is expected to refuse 0 */
    if (!FT_IS_SCALABLE(s->face) || units <= 0)
        return error_set(s->error, ERROR_SCENE, "%s: this font has pictures of its letters, not outlines", s->path);
    s->scale = 1.0 / units;
    out->ascender = s->face->ascender * s->scale;
    out->descender = s->face->descender * s->scale;
    out->line = s->face->height * s->scale;
    return count_letters(s, text, &out->count) && set_line(s, text, out);
}

bool font_layout(const struct font_file *file, const char *text, struct arena *arena, struct font_text *out,
                 struct error *error) {
    struct setting s = {.path = file->path, .arena = arena, .error = error};
    s.memory.hooks = (struct FT_MemoryRec_){.user = &s.memory, .alloc = take, .free = give, .realloc = change};
    *out = (struct font_text){0};
    bool done = open_and_set(&s, file->data, file->size, text, out);
    if (s.face)
        (void)FT_Done_Face(s.face);
    if (s.library)
        (void)FT_Done_Library(s.library);
    return done;
}

const char *font_library(void) {
    return "FreeType " TEXT(FREETYPE_MAJOR) "." TEXT(FREETYPE_MINOR) "." TEXT(FREETYPE_PATCH);
}

#endif
