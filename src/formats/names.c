/* A hash table with open addressing. The position of a name in it has no effect: numbers are given in order of arrival.
 */
#include "formats/names.h"

#include "base/hash.h"

#include <string.h>

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

bool names_add(struct names *names, const char *text, size_t length, uint32_t *number) {
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

uint32_t names_find(const struct names *names, const char *text, size_t length) {
    return names->capacity ? names->table[slot_of(names, text, length)] : EMPTY;
}

void names_destroy(struct names *names) {
    list_destroy(&names->entries);
    mem_free(names->table);
    *names = (struct names){0};
}
