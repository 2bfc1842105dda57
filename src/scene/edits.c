/* A step stores the state before and after, so undoing applies the state before; the list of current changes is never
 * computed from the beginning. */
#include "scene/edits.h"

#include "base/mem.h"

#include <stdio.h>
#include <string.h>

enum { STEP_LIMIT = 1 << 20, LINE = 8192 };

void edits_destroy(struct edits *edits) {
    mem_free(edits->steps);
    change_list_destroy(&edits->now);
    *edits = (struct edits){0};
}

static struct edit *new_step(struct edits *edits) {
    if (edits->at == edits->room) {
        uint32_t room = edits->room ? 2 * edits->room : 64;
        struct edit *more = room <= STEP_LIMIT ? mem_resize_array(edits->steps, room, sizeof *more) : NULL;
        if (!more)
            return NULL;
        edits->steps = more;
        edits->room = room;
    }
    return &edits->steps[edits->at];
}

bool edits_make(struct edits *edits, const struct change *change, bool present, bool join) {
    const struct change *found = change_list_find(&edits->now, change);
    struct edit *last = edits->at > 0 ? &edits->steps[edits->at - 1] : NULL;
    struct edit step = {.before = found ? *found : *change, .after = *change, .had = found != NULL, .has = present};
    bool joined = join && last && change_same_target(&last->after, change);
    struct edit *at = joined ? last : new_step(edits);
    if (!at || !change_list_set(&edits->now, change, present))
        return false;
    if (joined) {
        at->after = *change;
        at->has = present;
    } else {
        *at = step;
        edits->at++;
    }
    edits->count = edits->at;
    return true;
}

bool edits_differ(const struct edits *edits, uint32_t from) {
    uint32_t first = from < edits->at ? from : edits->at, end = from < edits->at ? edits->at : from;
    bool differ = first < end && end > edits->count; /* what was undone is no longer known */
    for (uint32_t i = first; i < end && i < edits->count; i++) {
        enum change_kind kind = edits->steps[i].after.kind;
        differ = differ || (kind != CHANGE_HIDDEN && kind != CHANGE_SOLO);
    }
    return differ;
}

bool edits_undo(struct edits *edits, struct change *target) {
    if (edits->at == 0)
        return false;
    const struct edit *step = &edits->steps[edits->at - 1];
    if (!change_list_set(&edits->now, &step->before, step->had))
        return false;
    edits->at--;
    *target = step->before;
    return true;
}

bool edits_redo(struct edits *edits, struct change *target) {
    if (edits->at == edits->count)
        return false;
    const struct edit *step = &edits->steps[edits->at];
    if (!change_list_set(&edits->now, &step->after, step->has))
        return false;
    edits->at++;
    *target = step->after;
    return true;
}

/* As a Lua string: characters other than printable ASCII become escapes. */
static void quote(char *out, size_t size, const char *text) {
    size_t used = 0;
    out[used++] = '\'';
    for (; *text && used + 6 < size; text++) {
        unsigned char c = (unsigned char)*text;
        bool plain = c >= 32 && c != 127 && c != '\'' && c != '\\';
        used += (size_t)snprintf(out + used, size - used, plain ? "%c" : "\\%03d", c);
    }
    out[used++] = '\'';
    out[used] = '\0';
}

static void format_numbers(char *out, size_t size, const double *numbers, int count) {
    size_t used = (size_t)snprintf(out, size, "{");
    for (int i = 0; i < count; i++)
        used += (size_t)snprintf(out + used, size - used, "%s%.17g", i > 0 ? ", " : "", numbers[i]);
    (void)snprintf(out + used, size - used, "}");
}

static void format_light(const struct change *c, char *line, size_t size) {
    char move[120], factor[120], turn[300] = "nil", colour[120] = "";
    bool more = c->turns || c->colours;
    format_numbers(move, sizeof move, c->numbers, 3);
    format_numbers(factor, sizeof factor, c->numbers + 3, 3);
    if (c->turns)
        format_numbers(turn, sizeof turn, c->numbers + TURN_AT, TURN_NUMBERS);
    if (c->colours)
        format_numbers(colour, sizeof colour, c->numbers + COLOUR_AT, 3);
    (void)snprintf(line, size, "gr.change_light(%u, %s, %s%s%s%s%s)\n", c->serial, move, factor, more ? ", " : "",
                   more ? turn : "", c->colours ? ", " : "", colour);
}

static void format_change(const struct change *c, char *line, size_t size) {
    char name[8 * CHANGE_NAME], call[4 * CHANGE_CALL + 8], a[400], b[120];
    quote(name, sizeof name, c->name);
    switch (c->kind) {
    case CHANGE_TRANSFORM:
        format_numbers(a, sizeof a, c->numbers, 12);
        (void)snprintf(line, size, "gr.change_node(%s, %u, %s)\n", name, c->serial, a);
        return;
    case CHANGE_GONE:
        (void)snprintf(line, size, "gr.change_delete(%s, %u)\n", name, c->serial);
        return;
    case CHANGE_ADD:
        format_numbers(a, sizeof a, c->numbers, 3);
        quote(call, sizeof call, c->call[0] ? c->call : "copy");
        (void)snprintf(line, size, "gr.change_add(%s, %u, %s, %s, %u)\n", name, c->serial, call, a, c->source);
        return;
    case CHANGE_OWN:
        (void)snprintf(line, size, "gr.change_own(%s, %u, %u)\n", name, c->serial, c->source);
        return;
    case CHANGE_MATERIAL:
        format_numbers(a, sizeof a, c->numbers, material_part_count(c->part));
        if (c->part == MATERIAL_PART_KD)
            (void)snprintf(line, size, "gr.change_material(%u, %s)\n", c->serial, a);
        else
            (void)snprintf(line, size, "gr.change_look(%u, '%s', %s)\n", c->serial, material_part_name(c->part), a);
        return;
    case CHANGE_TEXTURE:
        quote(call, sizeof call, c->call);
        (void)snprintf(line, size, "gr.change_texture(%u, %s)\n", c->serial, call);
        return;
    case CHANGE_LIGHT:
        format_light(c, line, size);
        return;
    case CHANGE_DARK:
        (void)snprintf(line, size, "gr.change_delete_light(%u)\n", c->serial);
        return;
    case CHANGE_ADD_LIGHT:
        format_numbers(a, sizeof a, c->numbers, 3);
        format_numbers(b, sizeof b, c->numbers + 3, 3);
        quote(call, sizeof call, c->call);
        if (c->call[0] == '\0')
            (void)snprintf(line, size, "gr.change_copy_light(%u, %s, %s)\n", c->source, a, b);
        else
            (void)snprintf(line, size, "gr.change_add_light(%s, %s, %s)\n", a, b, call);
        return;
    case CHANGE_HIDDEN:
    case CHANGE_SOLO:
    case CHANGE_KINDS:
        break;
    }
    line[0] = '\0';
}

bool edits_write_lua(const struct change_list *changes, const char *picture, const struct camera *camera,
                     const double *exposure, bool (*put)(void *context, const char *line), void *context) {
    char line[LINE], name[LINE / 2];
    quote(name, sizeof name, picture);
    for (uint32_t i = 0; i < changes->count; i++) {
        format_change(&changes->items[i], line, sizeof line);
        if (!put(context, line))
            return false;
    }
    /* All digits, so that the file gives the same picture. */
    if (camera) {
        const struct camera *c = camera;
        (void)snprintf(line, sizeof line,
                       "gr.change_view(%s, {%.17g, %.17g, %.17g}, {%.17g, %.17g, %.17g}, {%.17g, %.17g, %.17g}, "
                       "%.17g)\n",
                       name, c->eye.x, c->eye.y, c->eye.z, c->view.x, c->view.y, c->view.z, c->up.x, c->up.y, c->up.z,
                       c->fov);
        if (!put(context, line))
            return false;
    }
    if (exposure) {
        (void)snprintf(line, sizeof line, "gr.change_exposure(%s, %.17g)\n", name, *exposure);
        return put(context, line);
    }
    return true;
}
