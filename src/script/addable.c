/* A call is scanned, not parsed: fields are divided by commas outside of brackets and strings. */
#include "script/addable.h"

#include "script/table_internal.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The first character of the fields; NULL: there is no "gr.NAME{...}". */
static const char *fields_of(const char *call) {
    const char *brace = strchr(call, '{');
    bool ok = brace && strncmp(call, "gr.", 3) == 0 && call[strlen(call) - 1] == '}';
    for (const char *c = call + 3; ok && c < brace; c++)
        ok = isalnum((unsigned char)*c) || *c == '_';
    return ok ? brace + 1 : NULL;
}

const struct script_function *call_function(const char *call) {
    const char *fields = fields_of(call);
    char name[64];
    if (!fields || (size_t)(fields - call) >= sizeof name + 4)
        return NULL;
    (void)snprintf(name, sizeof name, "%.*s", (int)(fields - call) - 4, call + 3);
    return function_find(OWNER_GR, name);
}

/* The comma, the closing bracket, or the end of the text, after the field that begins there. */
static const char *end_of(const char *at) {
    int depth = 0;
    char quote = '\0';
    for (; *at; at++) {
        if (quote && *at == '\\' && at[1])
            at++;
        else if (quote)
            quote = *at == quote ? '\0' : quote;
        else if (*at == '\'' || *at == '"')
            quote = *at;
        else if (strchr("({[", *at))
            depth++;
        else if (depth == 0 && strchr(",}", *at))
            return at;
        else if (strchr(")}]", *at))
            depth--;
    }
    return at;
}

/* Where a field, and its text, begin and end. */
struct call_part {
    const char *begin, *text, *end;
};

static bool find_field(const char *call, const char *name, struct call_part *part) {
    const char *at = fields_of(call);
    size_t length = strlen(name);
    for (; at && *at && *at != '}'; at += *at == ',') {
        at += strspn(at, " ");
        const char *word = at, *end = end_of(at), *equal = word + strcspn(word, " =");
        at = end;
        if ((size_t)(equal - word) != length || memcmp(word, name, length) != 0)
            continue;
        equal += strspn(equal, " ");
        *part = (struct call_part){word, *equal == '=' ? equal + 1 + strspn(equal + 1, " ") : word, end};
        return *equal == '=';
    }
    return false;
}

bool call_field(const char *call, const char *name, char *out, size_t size) {
    struct call_part part;
    if (!find_field(call, name, &part))
        return false;
    int length = snprintf(out, size, "%.*s", (int)(part.end - part.text), part.text);
    return length >= 0 && (size_t)length < size;
}

bool call_set_field(const char *call, const char *name, const char *text, char *out, size_t size) {
    struct call_part part = {0};
    const char *first = fields_of(call);
    if (!first)
        return false;
    /* Without the old one, and the comma and the blank behind it. */
    bool found = find_field(call, name, &part);
    const char *head = found ? part.begin : call + strlen(call) - 1, *tail = found ? part.end : head;
    if (text[0] == '\0') {
        tail += found && *tail == ',' ? 1 : 0;
        tail += found ? strspn(tail, " ") : 0;
        while (found && *tail == '}' && head > first && (head[-1] == ' ' || head[-1] == ','))
            head--;
    }
    const char *comma = text[0] != '\0' && !found && head > first ? ", " : "";
    int length = text[0] == '\0'
                     ? snprintf(out, size, "%.*s%s", (int)(head - call), call, tail)
                     : snprintf(out, size, "%.*s%s%s = %s%s", (int)(head - call), call, comma, name, text, tail);
    return length >= 0 && (size_t)length < size;
}

bool call_numbers(const char *text, double out[3]) {
    bool list = *text == '{';
    const char *at = text + list;
    int count = 0;
    for (; count < 3; count++) {
        char *end;
        at += strspn(at, " ,");
        if (!isdigit((unsigned char)at[at[0] == '-' || at[0] == '.']))
            break;
        out[count] = strtod(at, &end);
        at = end;
    }
    for (int i = count; count == 1 && i < 3; i++)
        out[i] = out[0];
    return count == 1 || count == 3;
}
