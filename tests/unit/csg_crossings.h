/* All crossings of a line with a solid, by the search for the nearest one again and again: for tests of what the
 * searches find along a whole line. */
#ifndef GRAY_TESTS_CSG_CROSSINGS_H
#define GRAY_TESTS_CSG_CROSSINGS_H

#include "csg/geometry.h"

#include <math.h>

/* By ascending t, on the scratch. A solid without end is entered at -INFINITY and left at INFINITY. False: the scratch
 * is too small. */
static inline bool csg_crossings(const struct csg *csg, const struct ray *ray, struct geom_scratch *scratch,
                                 struct crossing_list *out) {
    enum { LIMIT = 4096 };
    static struct crossing found[LIMIT];
    const bool has_ends = !csg->clipped && !csg->open;
    struct ray rest = *ray;
    struct crossing end = {.flip = true};
    uint32_t count = 0;
    bool room = true;
    rest.t_min = -INFINITY;
    rest.t_max = INFINITY;
    *out = (struct crossing_list){scratch->used, 0};
    for (; count < LIMIT && csg_nearest(csg, &rest, scratch, &found[count]); count++)
        rest.t_min = found[count].t;
    bool is_inside = count > 0 ? !found[0].enter : csg_contains(csg, ray->origin, scratch);
    if (scratch->overflow)
        return false;
    if (count > 0)
        end = found[0];
    end.t = -INFINITY;
    end.enter = true;
    if (is_inside && has_ends)
        room = geom_scratch_push(scratch, end);
    for (uint32_t i = 0; i < count && room; i++) {
        room = geom_scratch_push(scratch, found[i]);
        is_inside = found[i].enter;
    }
    end.t = INFINITY;
    end.enter = false;
    if (is_inside && has_ends)
        room = room && geom_scratch_push(scratch, end);
    out->count = scratch->used - out->first;
    if (!room)
        scratch->used = out->first;
    return room;
}

static inline bool geometry_crossings(const struct geometry *geometry, const struct ray *ray,
                                      struct geom_scratch *scratch, struct crossing_list *out) {
    return geometry->csg ? csg_crossings(geometry->csg, ray, scratch, out)
                         : shape_crossings(&geometry->shape, ray, scratch, out);
}

#endif
