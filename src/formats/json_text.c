/* jansson allocates from an arena, which is faster than a block for each value, and its memory is bounded before it
 * starts. It refuses NaN, infinities, numbers that do not fit, zero bytes, text that is not UTF-8, and more than 2048
 * values in each other. */
#include "formats/json_text.h"

#ifndef HAVE_JANSSON

const char *json_text_library(void) {
    return "none";
}

#else

#include "base/hash.h"

#include <string.h>

/* jansson needs about 40 bytes for a number, 130 for a list and 300 for an object. */
enum { OBJECT_LIMIT = 1 << 23, VALUE_LIMIT = 1 << 24 };

const char *json_text_library(void) {
    return "jansson " JANSSON_VERSION;
}

static bool check_size(const char *path, const char *text, size_t size, struct error *error) {
    size_t objects = 0, values = 0;
    bool string = false;
    for (size_t i = 0; i < size; i++) {
        if (string && text[i] == '\\')
            i++;
        else if (text[i] == '"')
            string = !string;
        else if (!string) {
            objects += text[i] == '{' || text[i] == '[';
            values += text[i] == ',';
        }
    }
    return (objects <= OBJECT_LIMIT && values <= VALUE_LIMIT) ||
           error_set(error, ERROR_SCENE, "%s: its JSON: more than %d lists and objects or %d values", path,
                     OBJECT_LIMIT, VALUE_LIMIT);
}

/* jansson reports lack of memory as a syntax error, and its allocator has no context. Hence these variables; they are
 * valid from the start of a parse to its end. */
static _Thread_local struct arena *memory;
static _Thread_local bool memory_failed;

static void *allocate(size_t size) {
    void *block = arena_alloc(memory, size);
    memory_failed |= block == NULL;
    return block;
}

static void keep(void *block) {
    (void)block;
}

/* What others call JSON. */
static const char *hint_of(const char *fault) {
    static const char *const hints[][2] = {
        {"near '/'", "; JSON has no comments"},
        {"near '#'", "; JSON has no comments"},
        {"near '''", "; strings stand in double quotes"},
        {"near ']'", "; a comma may be too many"},
        {"near '}'", "; a comma may be too many"},
        {"invalid token near", "; words are only true, false and null, and numbers are finite"},
        {"decode byte", "; the text must be UTF-8"},
    };
    for (size_t i = 0; i < sizeof hints / sizeof *hints; i++)
        if (strstr(fault, hints[i][0]))
            return hints[i][1];
    return "";
}

json_t *json_text_parse(const char *path, const char *text, size_t size, bool strict, struct arena *arena,
                        struct error *error) {
    if (!check_size(path, text, size, error))
        return NULL;
    /* The hash seed depends on all bytes of the file, so that a file cannot contain names that collide, and the library
     * needs no random numbers. */
    json_set_alloc_funcs(allocate, keep);
    json_object_seed((size_t)hash_bytes(text, size, 1) | 1);
    json_error_t fault;
    memory = arena;
    memory_failed = false;
    json_t *root = json_loadb(text, size, strict ? JSON_REJECT_DUPLICATES : 0, &fault);
    if (memory_failed) { /* characters may be missing then even if the text seems complete */
        (void)error_no_memory(error, path);
        return NULL;
    }
    if (root && json_is_object(root))
        return root;
    for (char *c = fault.text; !root && *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = '?';
    if (root)
        (void)error_set(error, ERROR_SCENE, "%s: its JSON: an object must be at the top", path);
    else
        (void)error_set(error, ERROR_SCENE, "%s:%d: broken JSON: %s (column %d)%s", path, fault.line, fault.text,
                        fault.column, hint_of(fault.text));
    return NULL;
}

#endif
