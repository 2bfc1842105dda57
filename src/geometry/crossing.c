/* The stack of crossings of one worker. It is grown only between rays, so that pointers and indices into it stay valid
 * during a query. */
#include "geometry/crossing.h"

#include "base/mem.h"
#include "math/elementary.h"

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
    if (scratch->fixed || scratch->capacity > UINT32_MAX / 2)
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

static bool comes_before(const void *one, const void *other) {
    const struct crossing *a = one, *b = other;
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
            kept--; /* in and out, or out and in, at one t */
            continue;
        }
        items[kept++] = items[i];
    }
    /* Root finders keep parity by construction; if one fails, an unfinished last piece is dropped. */
    kept -= kept % 2;
    for (uint32_t i = 0; i < kept; i++)
        items[i].enter = i % 2 == 0;
    out->count = kept;
    scratch->used = first + kept;
}

/* Image coordinates of a surface as functions of space with gradients: on the surface the point moves with u at
 * constant v and with v at constant u. Both derivatives are in the tangent plane, the dual basis of the two gradients
 * there (any book on tensors): with the normal n, dp/du = grad v x n / d, dp/dv = n x grad u / d,   d = n . (grad u x
 * grad v). Where the surface is parallel to the direction of projection, d is 0 and the image is stretched infinitely;
 * d is kept off 0, so that all numbers stay finite. surface_mapping_axes: Duff et al., "Building an Orthonormal Basis,
 * Revisited", JCGT 2017. */

#define STEEPEST 0x1p-20

void surface_mapping_axes(struct vec3 n, struct vec3 *x, struct vec3 *z) {
    double sign = n.y < 0 ? -1 : 1, s = -1 / (sign + n.y), c = n.x * n.z * s;
    *x = vec3_make(1 + sign * n.x * n.x * s, -sign * n.x, sign * c);
    *z = vec3_make(c, -n.z, sign + n.z * n.z * s);
}

/* u or v: its value, the unit direction in which it increases, and the length > 0 of one unit of it where the surface
 * faces the centre of projection. */
struct mapped {
    double at;
    struct vec3 along;
    double size;
};

/* The directions are at right angles. */
static void take(struct mapped u, struct mapped v, struct surface *out) {
    struct vec3 along_u = u.along, along_v = v.along;
    struct vec3 n = vec3_normalize(out->normal);
    double facing = vec3_dot(n, vec3_cross(along_u, along_v));
    bool away = facing >= 0;
    if (!away) {
        along_u = vec3_negate(along_u);
        facing = -facing;
    }
    facing = math_max(facing, STEEPEST);
    out->has_uv = true;
    out->u = away ? u.at : 1 - u.at;
    out->v = v.at;
    out->dpdu = vec3_scale(vec3_cross(along_v, n), u.size / facing);
    out->dpdv = vec3_scale(vec3_cross(n, along_u), v.size / facing);
}

void surface_mapping_sphere(struct vec3 centre, struct surface *out) {
    struct vec3 arm = vec3_sub(out->point, centre);
    double far = vec3_length(arm);
    if (!(far > 0)) { /* at the centre every direction is as good */
        arm = vec3_normalize(out->normal);
        far = vec3_length(arm);
    }
    struct vec3 n = vec3_scale(arm, 1 / far);
    double ring = sqrt(n.x * n.x + n.z * n.z), y = n.y < -1 ? -1 : n.y > 1 ? 1 : n.y;
    double cosine = ring > 0 ? n.x / ring : 1, sine = ring > 0 ? n.z / ring : 0;
    struct vec3 along_u = vec3_make(sine, 0, -cosine), along_v = vec3_make(-y * cosine, ring, -y * sine);
    take((struct mapped){0.5 - el_atan2(n.z, n.x) / TURN, along_u, TURN * ring * far},
         (struct mapped){0.5 + el_asin(y) / (TURN / 2), along_v, TURN / 2 * far}, out);
}

void surface_mapping_label(struct vec3 base, struct vec3 axis, double length, struct surface *out) {
    struct vec3 arm = vec3_sub(out->point, base), x, z;
    surface_mapping_axes(axis, &x, &z);
    double height = vec3_dot(arm, axis), p = vec3_dot(arm, x), q = vec3_dot(arm, z), radius = sqrt(p * p + q * q);
    double cosine = radius > 0 ? p / radius : 1, sine = radius > 0 ? q / radius : 0;
    struct vec3 along_u = vec3_sub(vec3_scale(x, sine), vec3_scale(z, cosine));
    take((struct mapped){0.5 - el_atan2(q, p) / TURN, along_u, TURN * radius},
         (struct mapped){height / length, axis, length}, out);
}
