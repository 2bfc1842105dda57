#include "export/solid_cast_internal.h"

#include "base/mem.h"
#include "base/unreachable.h"
#include "math/frame.h"
#include "mesh/mesh.h"
#include "shape/height_field.h"

enum { FIRST_CROSSINGS = 64, FIRST_SCRATCH = 1024, FEW_FACETS = 4096 };
#define FEW_FACETS_STEP 0.03 /* about as many, of the unit square */

bool solid_probe_init(struct solid_probe *probe, const struct csg *csg) {
    *probe = (struct solid_probe){.csg = csg, .capacity = FIRST_CROSSINGS};
    probe->found = mem_alloc(FIRST_CROSSINGS * sizeof *probe->found);
    if (probe->found && geom_scratch_init(&probe->scratch, csg->max_crossings + FIRST_SCRATCH))
        return true;
    mem_free(probe->found);
    return false;
}

void solid_probe_destroy(struct solid_probe *probe) {
    geom_scratch_destroy(&probe->scratch);
    mem_free(probe->found);
}

struct solid_probe *solid_probes(const struct csg *csg, int count) {
    struct solid_probe *probes = mem_alloc_zero((size_t)count, sizeof *probes);
    for (int i = 0; probes && i < count; i++) {
        if (solid_probe_init(&probes[i], csg))
            continue;
        solid_probes_destroy(probes, i);
        return NULL;
    }
    return probes;
}

void solid_probes_destroy(struct solid_probe *probes, int count) {
    for (int i = 0; probes && i < count; i++)
        solid_probe_destroy(&probes[i]);
    mem_free(probes);
}

/* Whether the parts of a shape are smooth pieces that meet in edges. Those of implicit solids are none, those of
 * bevelled ones touch; of many facets most edges are to be forgotten: there an edge is where the normal turns much. */
static bool has_pieces(const struct shape *shape) {
    switch (shape->kind) {
    case SHAPE_IMPLICIT:
    case SHAPE_BEVELLED:
        return false;
    case SHAPE_MESH:
        return mesh_triangle_count(shape->mesh) <= FEW_FACETS;
    case SHAPE_HEIGHT_FIELD:
        return height_field_step(shape->height_field) > FEW_FACETS_STEP;
        ANALYTIC_SHAPES(LIST_LABEL)
    case SHAPE_LATHE:
    case SHAPE_PRISM:
    case SHAPE_SWEEP:
    case SHAPE_BLOB:
    case SHAPE_CURVE:
        return true;
    }
    UNREACHABLE("a shape has a kind");
}

static uint32_t surface_of(const struct csg *csg, const struct crossing *crossing) {
    bool pieces = has_pieces(&csg->leaves[crossing->leaf].shape);
    return (uint32_t)crossing->leaf << 16 | (pieces ? crossing->part & 0xffff : 0);
}

static bool make_room(struct solid_probe *probe, uint32_t count) {
    if (count <= probe->capacity)
        return true;
    struct solid_crossing *found = mem_resize_array(probe->found, 2 * (size_t)count, sizeof *found);
    if (!found)
        return false;
    probe->found = found;
    probe->capacity = 2 * count;
    return true;
}

void solid_cast(struct solid_probe *probe, struct vec3 origin, struct vec3 direction) {
    const struct ray ray = {.origin = origin, .direction = direction, .t_min = -INFINITY, .t_max = INFINITY};
    struct geom_scratch *scratch = &probe->scratch;
    struct crossing_list list;
    scratch->used = 0;
    probe->count = 0;
    while (!csg_list_crossings(probe->csg, &ray, scratch, &list)) {
        if (!geom_scratch_grow(scratch)) {
            probe->failed = true;
            return;
        }
    }
    if (!make_room(probe, list.count)) {
        probe->failed = true;
        return;
    }
    for (uint32_t i = 0; i < list.count; i++) {
        const struct crossing *crossing = &scratch->items[list.first + i];
        struct surface surface;
        csg_describe(probe->csg, &ray, crossing, &surface);
        probe->found[i] = (struct solid_crossing){.t = crossing->t,
                                                  .point = surface.point,
                                                  .normal = vec3_normalize(surface.normal),
                                                  .surface = surface_of(probe->csg, crossing),
                                                  .enter = crossing->enter};
    }
    probe->count = list.count;
    scratch->used = 0;
}

bool solid_cast_near(struct solid_probe *probe, struct vec3 origin, struct vec3 direction, double limit,
                     struct solid_crossing *nearest) {
    bool found = false;
    solid_cast(probe, origin, direction);
    for (uint32_t i = 0; i < probe->count; i++) {
        double t = fabs(probe->found[i].t);
        if (t < (found ? fabs(nearest->t) : limit)) {
            *nearest = probe->found[i];
            found = true;
        }
    }
    return found;
}

bool solid_contains(struct solid_probe *probe, struct vec3 point) {
    struct geom_scratch *scratch = &probe->scratch;
    bool inside;
    scratch->used = 0;
    do {
        inside = csg_contains(probe->csg, point, scratch);
    } while (scratch->overflow && geom_scratch_grow(scratch));
    probe->failed = probe->failed || scratch->overflow;
    return inside;
}

/* The directions 1 to 26 to the neighbours in a grid; the first two are along the normal. */
static struct vec3 direction_of(int number, struct vec3 normal, struct vec3 a, struct vec3 b) {
    static const double step[3] = {0, 1, -1};
    struct vec3 sum = vec3_scale(normal, step[number % 3]);
    sum = vec3_add_scaled(vec3_add_scaled(sum, a, step[number / 3 % 3]), b, step[number / 9]);
    return vec3_normalize(sum);
}
/* One of each pair of opposite directions. */
static bool is_first_of_pair(int number) {
    return number == 1 || (number >= 3 && number < 6) || (number >= 9 && number < 18);
}

/* A point inside and one outside that are both near enough prove it, and cost less than a line; between the two sides
 * of a thin wall lines are needed. */
bool solid_is_near(struct solid_probe *probe, struct vec3 point, struct vec3 normal, double distance) {
    struct vec3 a, b;
    struct solid_crossing at;
    bool inside = solid_contains(probe, point);
    frame_tangents(normal, &a, &b);
    for (int i = 1; i <= 26; i++)
        if (solid_contains(probe, vec3_add_scaled(point, direction_of(i, normal, a, b), distance)) != inside)
            return true;
    for (int i = 1; i <= 26; i++) {
        struct vec3 tilted = vec3_add_scaled(direction_of(i, normal, a, b), a, 0.01);
        if (is_first_of_pair(i) && solid_cast_near(probe, point, vec3_normalize(tilted), distance, &at))
            return true;
    }
    return false;
}

/* Points all around on the sphere, on a spiral that turns by the golden angle: near an edge only few are on the other
 * side of the surface. */
bool solid_is_near_for_sure(struct solid_probe *probe, struct vec3 point, struct vec3 normal, double distance) {
    enum { POINTS = 2000 };
    const double golden_cosine = -0.7373688780783197, golden_sine = 0.6754902942615238;
    if (solid_is_near(probe, point, normal, distance))
        return true;
    bool inside = solid_contains(probe, point);
    double cosine = 1, sine = 0;
    for (int i = 0; i < POINTS; i++) {
        double z = 1 - (2 * i + 1) / (double)POINTS, radius = sqrt(1 - z * z), turned = cosine * golden_cosine;
        struct vec3 direction = {radius * cosine, radius * sine, z};
        if (solid_contains(probe, vec3_add_scaled(point, direction, distance)) != inside)
            return true;
        turned -= sine * golden_sine;
        sine = sine * golden_cosine + cosine * golden_sine;
        cosine = turned;
    }
    return false;
}
