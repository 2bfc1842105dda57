/* Moving a line near a shape, and putting crossings in order. A list is mostly short and nearly sorted: insertion; long
 * ones go through a heap (Williams 1964), which needs no memory. The order is total, so neither has to be stable. */
#include "geom/line.h"

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

static void sift_down(struct crossing *items, uint32_t root, uint32_t count) {
    struct crossing moved = items[root];
    for (;;) {
        uint32_t child = 2 * root + 1;
        if (child >= count)
            break;
        if (child + 1 < count && comes_before(&items[child], &items[child + 1]))
            child++;
        if (!comes_before(&moved, &items[child]))
            break;
        items[root] = items[child];
        root = child;
    }
    items[root] = moved;
}

void crossings_sort(struct crossing *items, uint32_t count) {
    if (count <= 40) {
        for (uint32_t i = 1; i < count; i++) {
            struct crossing moved = items[i];
            uint32_t j = i;
            for (; j > 0 && comes_before(&moved, &items[j - 1]); j--)
                items[j] = items[j - 1];
            items[j] = moved;
        }
        return;
    }
    for (uint32_t i = count / 2; i-- > 0;)
        sift_down(items, i, count);
    for (uint32_t end = count; end-- > 1;) {
        struct crossing last = items[end];
        items[end] = items[0];
        items[0] = last;
        sift_down(items, 0, end);
    }
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
