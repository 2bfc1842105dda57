/* The stack of media a ray is inside of. Leaving a solid removes that solid wherever it stands; the current medium is
 * the one entered last; outside of everything the index is 1. By value: a branch of the path copies and changes it. */
#ifndef GRAY_RENDER_MEDIA_H
#define GRAY_RENDER_MEDIA_H

#include "world/world.h"

#include <stdint.h>
#include <string.h>

enum { MEDIA_LIMIT = 32 }; /* deeper nestings forget the outermost (docs/limits.md) */

struct media {
    uint32_t count;
    struct medium {
        uint32_t placed;
        double ior;
        struct vec3 absorption; /* the logarithm of light falls by this per unit */
    } entries[MEDIA_LIMIT];
};

static inline double media_ior(const struct media *media) {
    return media->count ? media->entries[media->count - 1].ior : 1;
}

static inline void media_copy(struct media *to, const struct media *from) {
    to->count = from->count;
    memcpy(to->entries, from->entries, from->count * sizeof *from->entries);
}

static inline void media_enter(struct media *media, uint32_t placed, double ior) {
    if (media->count == MEDIA_LIMIT) {
        memmove(media->entries, media->entries + 1, (MEDIA_LIMIT - 1) * sizeof *media->entries);
        media->count--;
    }
    media->entries[media->count++] = (struct medium){.placed = placed, .ior = ior};
}

static inline void media_enter_absorbing(struct media *media, uint32_t placed, double ior, struct vec3 absorption) {
    media_enter(media, placed, ior);
    media->entries[media->count - 1].absorption = absorption;
}

/* The latest entry of the solid goes; nothing happens when it is not there (an open surface, a camera on it). */
static inline void media_leave(struct media *media, uint32_t placed) {
    for (uint32_t i = media->count; i-- > 0;) {
        if (media->entries[i].placed != placed)
            continue;
        memmove(media->entries + i, media->entries + i + 1, (media->count - i - 1) * sizeof *media->entries);
        media->count--;
        return;
    }
}

/* The law of Beer, Lambert and Bouguer over a way inside the current medium: what is left of white light. The stack is
 * not empty. */
struct vec3 media_left(const struct media *media, double distance);
/* The media round a point at a ray's time, found by counting crossings; closed[0 .. closed_count-1] are the solids in
 * question (world_closed_in). */
void media_around(const struct world *world, struct vec3 point, double ray_time, const uint32_t *closed,
                  uint32_t closed_count, struct world_scratch *scratch, struct media *out);

#endif
