/* The stack of crossings of one worker. It is grown only between rays, so that pointers and indices into it hold while
 * a ray is being answered. */
#include "geometry/crossing.h"

#include "base/mem.h"

bool geom_scratch_init(struct geom_scratch *scratch, uint32_t capacity) {
    *scratch = (struct geom_scratch){0};
    if (capacity < 16)
        capacity = 16;
    scratch->items = mem_resize_array(NULL, capacity, sizeof *scratch->items);
    if (!scratch->items)
        return false;
    scratch->capacity = capacity;
    return true;
}

void geom_scratch_destroy(struct geom_scratch *scratch) {
    mem_free(scratch->items);
    scratch->items = NULL;
    scratch->capacity = scratch->used = 0;
}

bool geom_scratch_grow(struct geom_scratch *scratch) {
    if (scratch->capacity > UINT32_MAX / 2)
        return false;
    uint32_t capacity = scratch->capacity ? scratch->capacity * 2 : 16;
    struct crossing *items = mem_resize_array(scratch->items, capacity, sizeof *items);
    if (!items)
        return false;
    scratch->items = items;
    scratch->capacity = capacity;
    scratch->used = 0;
    scratch->overflow = false;
    return true;
}

/* --- lines --- */

bool line_init(struct line *line, const struct ray *ray, struct vec3 centre) {
    double speed = vec3_length(ray->direction);
    if (!(speed > 0) || !isfinite(speed))
        return false;
    struct vec3 unit = vec3_normalize(ray->direction);
    line->t0 = vec3_dot(vec3_sub(centre, ray->origin), unit) / speed;
    line->origin = ray_at(ray, line->t0);
    line->direction = unit;
    line->speed = speed;
    return isfinite(line->t0) && vec3_finite(line->origin);
}

static bool comes_before(const struct crossing *a, const struct crossing *b) {
    if (a->t != b->t)
        return a->t < b->t;
    if (a->part != b->part)
        return a->part < b->part;
    return a->u < b->u;
}

void crossings_sort(struct crossing *items, uint32_t count) {
    crossings_sort_by(items, count, comes_before);
}

void line_finish_open(const struct line *line, struct geom_scratch *scratch, uint32_t first,
                      struct crossing_list *out) {
    uint32_t count = scratch->used - first;
    struct crossing *items = &scratch->items[first];
    crossings_sort(items, count);
    for (uint32_t i = 0; i < count; i++)
        items[i].t = line_t(line, items[i].t);
    *out = (struct crossing_list){first, count};
}

void line_finish_closed(const struct line *line, struct geom_scratch *scratch, uint32_t first,
                        struct crossing_list *out) {
    line_finish_open(line, scratch, first, out);
    struct crossing *items = &scratch->items[first];
    uint32_t kept = 0;
    for (uint32_t i = 0; i < out->count; i++) {
        if (kept > 0 && items[kept - 1].t == items[i].t) {
            kept--; /* in and out, or out and in, at one place */
            continue;
        }
        items[kept++] = items[i];
    }
    /* Root-finders keep parity by construction; should one fail, an unfinished last piece is not there. */
    kept -= kept % 2;
    for (uint32_t i = 0; i < kept; i++)
        items[i].enter = i % 2 == 0;
    out->count = kept;
    scratch->used = first + kept;
}
