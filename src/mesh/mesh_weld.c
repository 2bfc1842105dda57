/* A hash table with open addressing, at most half full; it never leaves this function, so the order of its places shows
 * nowhere: the lowest vertex is the one met first. */
#include "mesh/mesh_weld.h"

#include "base/mem.h"
#include "base/random.h"

#include <string.h>

#define NONE UINT32_MAX

static uint64_t position_hash(const double p[3]) {
    uint64_t key = 0;
    for (int k = 0; k < 3; k++) {
        double x = p[k] + 0.0; /* -0 becomes 0 */
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        key = (key ^ bits) * UINT64_C(0x9e3779b97f4a7c15);
        key ^= key >> 29;
    }
    return random_mix(key);
}

static bool same_position(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

bool mesh_weld(const double (*vertices)[3], uint32_t count, uint32_t *same) {
    size_t slots = 16;
    while (slots < 2 * (size_t)count)
        slots *= 2;
    uint32_t *table = mem_alloc(slots * sizeof *table);
    if (!table)
        return false;
    memset(table, 0xff, slots * sizeof *table);
    for (uint32_t v = 0; v < count; v++) {
        size_t at = (size_t)position_hash(vertices[v]) & (slots - 1);
        while (table[at] != NONE && !same_position(vertices[table[at]], vertices[v]))
            at = (at + 1) & (slots - 1);
        if (table[at] == NONE)
            table[at] = v;
        same[v] = table[at];
    }
    mem_free(table);
    return true;
}
