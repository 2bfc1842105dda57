/* Fields of a form. The arguments of a call have widgets by the kinds of their parameters; what is neither a number nor
 * a word is Lua text. */
#include "window/call_form.h"

#include "script/addable.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct window_field *form_add(struct window_form *form, const char *group, const char *name,
                              enum window_field_kind kind, uint32_t number) {
    static struct window_field beyond; /* what has no room is not shown */
    struct window_field *field = form->count < FORM_FIELDS ? &form->fields[form->count++] : &beyond;
    *field = (struct window_field){.kind = kind, .number = number, .low = -HUGE_VAL, .high = HUGE_VAL};
    (void)snprintf(field->group, sizeof field->group, "%s", group);
    (void)snprintf(field->name, sizeof field->name, "%s", name);
    return field;
}

void form_set_range(struct window_field *field, double low, double high, const char *unit) {
    field->low = low;
    field->high = high;
    (void)snprintf(field->unit, sizeof field->unit, "%s", unit);
}

void form_set_help(struct window_field *field, const char *help) {
    (void)snprintf(field->help, sizeof field->help, "%s", help ? help : "");
}

/* How an argument is shown: as numbers, if its default has some or there is none. */
static enum window_field_kind kind_of(const struct script_parameter *parameter) {
    double ignored[3];
    const char *fallback = parameter->fallback ? parameter->fallback : "";
    bool known = !(parameter->flags & OPTIONAL) || call_numbers(fallback, ignored);
    switch (parameter->kind) {
    case KIND_NUMBER:
    case KIND_WHOLE:
        return known ? FIELD_NUMBER : FIELD_ENTRY;
    case KIND_POINT:
    case KIND_DIRECTION:
    case KIND_TRIPLE:
    case KIND_SIZE:
        return known ? FIELD_VECTOR : FIELD_ENTRY;
    case KIND_COLOUR:
        return known ? FIELD_COLOUR : FIELD_ENTRY;
    case KIND_BOOLEAN:
        return strcmp(fallback, "true") == 0 || strcmp(fallback, "false") == 0 ? FIELD_FLAG : FIELD_ENTRY;
    case KIND_CHOICE:
        return FIELD_CHOICE;
    case KIND_AXIS:
    case KIND_INTERVAL:
    case KIND_QUATERNION:
    case KIND_PAIR:
    case KIND_TEXT:
    case KIND_FILE:
    case KIND_OUTPUT:
    case KIND_NODE:
    case KIND_MATERIAL:
    case KIND_MATERIALS:
    case KIND_IMAGE:
    case KIND_BACKGROUND:
    case KIND_FOG:
    case KIND_MEDIUM:
    case KIND_CAUSTICS:
    case KIND_NODES:
    case KIND_LIGHTS:
    case KIND_POINTS:
    case KIND_PAIRS:
    case KIND_STOPS:
    case KIND_FACES:
    case KIND_NUMBERS:
    case KIND_ROWS:
    case KIND_CURVES:
    case KIND_FUNCTION:
    case KIND_CALLBACK:
    case KIND_COUNT:
        break;
    }
    return FIELD_ENTRY;
}

/* The words of a choice, divided by '|'; the number of the one in the text. */
static double find_word(const char *choices, const char *text, char *out, size_t size) {
    double found = 0, number = 0;
    size_t length = strlen(text);
    (void)snprintf(out, size, "%s", choices);
    for (char *word = out; *word; number++) {
        size_t end = strcspn(word, " ");
        if (length == end + 2 && strncmp(text + 1, word, end) == 0)
            found = number;
        word += end;
        if (*word)
            *word++ = '|';
    }
    return found;
}

static void add_argument(struct window_form *form, const struct script_function *function, int index, const char *call,
                         uint32_t first) {
    const struct script_parameter *row = &function->parameters[index];
    enum window_field_kind kind = kind_of(row);
    struct window_field *field = form_add(form, function->name, row->name, kind, first + (uint32_t)index);
    char text[FORM_TEXT] = "";
    bool given = call_field(call, row->name, text, sizeof text);
    const char *shown = given || !row->fallback ? text : row->fallback;
    bool any = !(row->low < 0 || row->low > 0 || row->high < 0 || row->high > 0);
    form_set_range(field, any ? -HUGE_VAL : row->low, any ? HUGE_VAL : row->high,
                   row->kind == KIND_WHOLE ? "#"
                   : row->unit             ? row->unit
                                           : "");
    form_set_help(field, row->help);
    if (kind == FIELD_CHOICE)
        field->numbers[0] = find_word(row->choices, shown, field->text, sizeof field->text);
    else if (kind == FIELD_FLAG)
        field->numbers[0] = strcmp(shown, "true") == 0;
    else if (kind == FIELD_ENTRY)
        (void)snprintf(field->text, sizeof field->text, "%s", text);
    else if (!call_numbers(shown, field->numbers) && row->fallback) /* something computed: not a number yet */
        (void)call_numbers(row->fallback, field->numbers);
    if (kind == FIELD_ENTRY && row->fallback)
        (void)snprintf(field->help, sizeof field->help, "%s Default: %s", row->help, row->fallback);
}

void call_form_add(struct window_form *form, const char *call, uint32_t first) {
    const struct script_function *function = call_function(call);
    for (int i = 0; function && i < function->parameter_count; i++) {
        if (function->parameters[i].kind != KIND_MATERIAL)
            add_argument(form, function, i, call, first);
    }
}

bool call_form_set(const char *call, const struct window_event *event, uint32_t first, char out[FORM_TEXT]) {
    const struct script_function *function = call_function(call);
    uint32_t index = event->field - first;
    const double *n = event->numbers;
    char text[FORM_TEXT];
    if (!function || index >= (uint32_t)function->parameter_count)
        return false;
    const struct script_parameter *row = &function->parameters[index];
    switch (kind_of(row)) {
    case FIELD_NUMBER:
        (void)snprintf(text, sizeof text, "%.12g", n[0]);
        break;
    case FIELD_VECTOR:
    case FIELD_COLOUR:
        (void)snprintf(text, sizeof text, "{%.9g, %.9g, %.9g}", n[0], n[1], n[2]);
        break;
    case FIELD_FLAG:
        (void)snprintf(text, sizeof text, "%s", n[0] != 0 ? "true" : "false");
        break;
    case FIELD_CHOICE: {
        const char *word = row->choices;
        for (int i = 0; i < (int)n[0] && strchr(word, ' '); i++)
            word = strchr(word, ' ') + 1;
        (void)snprintf(text, sizeof text, "'%.*s'", (int)strcspn(word, " "), word);
        break;
    }
    case FIELD_TEXT:
    case FIELD_ENTRY:
        (void)snprintf(text, sizeof text, "%.500s", event->text);
        break;
    }
    return call_set_field(call, row->name, text, out, FORM_TEXT);
}
