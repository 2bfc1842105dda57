/* Classes of characters: controls are C0, DEL, C1 (ECMA-48) and the marks of the bidirectional algorithm (Unicode
 * Standard Annex 9); invisible ones have the property Default_Ignorable_Code_Point or are combining marks (Unicode
 * 15.1). A terminal of eight bits takes a lone byte of 0x80 to 0x9f for a C1 control.
 *
 * The guard holds back text that could still become "gray:", at most a few bytes; everything else passes at once. */
#include "base/terminal_text.h"

#include <string.h>

static const char own[] = "gray:", mark[] = "scene: ";

size_t utf8_length(const unsigned char *at) {
    static const uint32_t min[] = {0, 0, 0x80, 0x800, 0x10000};
    size_t length = at[0] < 0x80 ? 1 : at[0] >> 5 == 6 ? 2 : at[0] >> 4 == 14 ? 3 : at[0] >> 3 == 30 ? 4 : 0;
    if (length < 2)
        return length;
    uint32_t code = at[0] & (0xffu >> (length + 1));
    for (size_t i = 1; i < length; i++) {
        if ((at[i] & 0xc0) != 0x80)
            return 0;
        code = code << 6 | (at[i] & 0x3fu);
    }
    return code < min[length] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000) ? 0 : length;
}

uint32_t utf8_code(const unsigned char *at, size_t length) {
    uint32_t code = length < 2 ? at[0] : at[0] & (0xffu >> (length + 1));
    for (size_t i = 1; i < length; i++)
        code = code << 6 | (at[i] & 0x3fu);
    return code;
}

struct range {
    uint32_t first, last;
};

static bool is_among(uint32_t code, const struct range *ranges, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (code >= ranges[i].first && code <= ranges[i].last)
            return true;
    }
    return false;
}

enum character_class character_class_of(const unsigned char *at) {
    static const struct range directions[] = {{0x61c, 0x61c}, {0x200e, 0x200f}, {0x202a, 0x202e}, {0x2066, 0x206f}};
    static const struct range invisible[] = {
        {0xad, 0xad},       {0x300, 0x36f},   {0x483, 0x489},     {0x591, 0x5bd},     {0x610, 0x61a},
        {0x64b, 0x65f},     {0x115f, 0x1160}, {0x17b4, 0x17b5},   {0x180b, 0x180f},   {0x1ab0, 0x1aff},
        {0x1dc0, 0x1dff},   {0x200b, 0x200d}, {0x2060, 0x2065},   {0x20d0, 0x20ff},   {0x302a, 0x302f},
        {0x3099, 0x309a},   {0x3164, 0x3164}, {0xfe00, 0xfe0f},   {0xfe20, 0xfe2f},   {0xfeff, 0xfeff},
        {0xffa0, 0xffa0},   {0xfff0, 0xfffb}, {0x1bca0, 0x1bca3}, {0x1d165, 0x1d169}, {0x1d16d, 0x1d182},
        {0xe0000, 0xe0fff},
    };
    size_t length = utf8_length(at);
    uint32_t code = utf8_code(at, length);
    if (length == 0)
        return code < 0xa0 ? CHARACTER_CONTROL : CHARACTER_SHOWN;
    if (code == '\n')
        return CHARACTER_LINE_END;
    if (code == '\r' || code == '\v' || code == '\f' || code == 0x85 || code == 0x2028 || code == 0x2029)
        return CHARACTER_BREAK;
    if ((code < 32 && code != '\t') || (code >= 127 && code < 0xa0) ||
        is_among(code, directions, sizeof directions / sizeof *directions))
        return CHARACTER_CONTROL;
    return is_among(code, invisible, sizeof invisible / sizeof *invisible) ? CHARACTER_INVISIBLE : CHARACTER_SHOWN;
}

const char *scene_mark(const char *text) {
    int matched = 0;
    for (const unsigned char *at = (const unsigned char *)text; *at;) {
        size_t length = utf8_length(at);
        if (*at == (unsigned char)own[matched]) {
            if (own[++matched] == '\0')
                return mark;
        } else if (character_class_of(at) != CHARACTER_INVISIBLE) {
            return "";
        }
        at += length ? length : 1;
    }
    return "";
}

static void put_ready(struct line_guard *guard) {
    if (guard->ready_size > 0)
        guard->put(guard->context, guard->ready, guard->ready_size);
    guard->ready_size = 0;
}

static void put(struct line_guard *guard, const char *text, size_t size) {
    if (size == 0)
        return;
    if (guard->ready_size + size > sizeof guard->ready)
        put_ready(guard);
    memcpy(guard->ready + guard->ready_size, text, size);
    guard->ready_size += size;
    guard->open = text[size - 1] != '\n';
}

/* The held letters belong to another word. */
static void release(struct line_guard *guard) {
    put(guard, guard->held, guard->held_size);
    guard->begun = guard->begun || guard->matched > 0;
    guard->held_size = 0;
    guard->matched = 0;
}

static void release_marked(struct line_guard *guard) {
    put(guard, mark, strlen(mark));
    release(guard);
}

static void end_line(struct line_guard *guard) {
    release(guard);
    put(guard, "\n", 1);
    guard->begun = guard->replaced = false;
}

static void take_shown(struct line_guard *guard, const char *text, size_t length) {
    if (guard->matched > 0 && *text != own[guard->matched])
        release(guard);
    bool may_begin = !guard->begun || guard->replaced;
    if (*text == own[guard->matched] && (guard->matched > 0 || may_begin)) {
        guard->held[guard->held_size++] = *text;
        if (own[++guard->matched] == '\0')
            release_marked(guard);
        return;
    }
    release(guard);
    put(guard, text, length);
    guard->begun = true;
}

static void take_character(struct line_guard *guard, const char *text, size_t length) {
    enum character_class class = character_class_of((const unsigned char *)text);
    bool after_return = guard->had_break && guard->begun, cut = guard->cut;
    guard->had_break = guard->cut = false;
    if ((after_return || cut) && class != CHARACTER_LINE_END)
        end_line(guard);
    switch (class) {
    case CHARACTER_SHOWN:
        take_shown(guard, text, length);
        break;
    case CHARACTER_INVISIBLE:
        if (guard->matched == 0) {
            put(guard, text, length);
        } else if (guard->held_size + length + strlen(own) <= sizeof guard->held) {
            memcpy(guard->held + guard->held_size, text, length);
            guard->held_size += length;
        } else { /* no word has so many of them */
            release_marked(guard);
            put(guard, text, length);
        }
        break;
    case CHARACTER_LINE_END:
        end_line(guard);
        break;
    case CHARACTER_BREAK:
        release(guard);
        if (*text == '\r')
            guard->had_break = true;
        else if (guard->begun)
            end_line(guard);
        break;
    case CHARACTER_CONTROL:
        release(guard);
        put(guard, "?", 1);
        guard->begun = guard->replaced = true;
        break;
    }
}

/* The length of the sequence that begins with this byte, if it is valid. */
static size_t promised_length(unsigned char first) {
    return first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : first >= 0xc0 ? 2 : 1;
}

static void take_byte(struct line_guard *guard, char byte) {
    char next[5] = {0};
    guard->partial[guard->partial_size++] = byte;
    while (guard->partial_size > 0) {
        memcpy(next, guard->partial, guard->partial_size);
        next[guard->partial_size] = '\0';
        size_t length = utf8_length((const unsigned char *)next);
        bool open = length == 0 && guard->partial_size < promised_length((unsigned char)next[0]);
        for (size_t i = 1; i < guard->partial_size; i++)
            open = open && ((unsigned char)next[i] & 0xc0) == 0x80;
        if (open)
            return;
        length = length ? length : 1;
        take_character(guard, next, length);
        guard->partial_size -= length;
        memmove(guard->partial, guard->partial + length, guard->partial_size);
    }
}

void line_guard_take(struct line_guard *guard, const char *text, size_t size) {
    for (size_t i = 0; i < size; i++)
        take_byte(guard, text[i]);
    put_ready(guard);
}

void line_guard_flush(struct line_guard *guard) {
    for (size_t i = 0; i < guard->partial_size; i++) {
        const char lone[] = {guard->partial[i], '\0'};
        take_character(guard, lone, 1);
    }
    guard->cut = guard->cut || guard->partial_size + guard->held_size > 0;
    guard->partial_size = 0;
    release(guard);
    put_ready(guard);
}

void line_guard_new_line(struct line_guard *guard) {
    guard->open = guard->begun = guard->replaced = guard->had_break = guard->cut = false;
}
