/* See glow.h. The light of black bodies is a table over the logarithm of the temperature. */
#include "material/glow.h"

#include "material/density_internal.h"
#include "material/medium_mix.h"
#include "math/elementary.h"
#include "math/sampling.h"
#include "math/spectrum.h"

#include <math.h>

/* --- temperatures --- */

/* SPAN: temperatures below the highest over this one emit nothing. */
enum { HEAT_STEPS = 4096, HEAT_SPAN = 1024 };

struct heat {
    const struct density *kelvin;
    double top;
    struct colour light[HEAT_STEPS + 1];
};

const struct heat *heat_make(struct arena *arena, const struct density *kelvin, struct error *error) {
    struct heat *heat = arena_alloc(arena, sizeof *heat);
    struct fog_cells cells;
    if (!heat) {
        (void)error_no_memory(error, "a medium");
        return NULL;
    }
    heat->kelvin = kelvin;
    const float(*bounds)[2] = density_cells(kelvin, &cells);
    for (uint64_t i = 0; i < fog_cell_count(&cells); i++)
        heat->top = math_max(heat->top, (double)bounds[i][1]);
    for (int i = 0; i <= HEAT_STEPS && heat->top > 0; i++)
        heat->light[i] = spectrum_black_body(heat->top * el_exp(el_log(HEAT_SPAN) * ((double)i / HEAT_STEPS - 1)));
    return heat;
}

static struct colour light_of(const struct heat *heat, double kelvin) {
    double at = HEAT_STEPS * (1 + el_log(kelvin / heat->top) / el_log(HEAT_SPAN));
    if (!(at > 0))
        return colour_all(0);
    int step = at < HEAT_STEPS ? (int)at : HEAT_STEPS - 1;
    double share = math_min(at - step, 1);
    return colour_add(colour_scale(heat->light[step], 1 - share), colour_scale(heat->light[step + 1], share));
}

struct colour heat_at(const struct heat *heat, struct vec3 p, double time) {
    double kelvin = density_value(heat->kelvin, p, time);
    return kelvin > 0 ? light_of(heat, kelvin) : colour_all(0);
}

bool heat_fits(const struct heat *heat) {
    return density_fits(heat->kelvin);
}

struct colour heat_brightest(const struct heat *heat) {
    return heat->light[HEAT_STEPS];
}

/* --- cells --- */

struct glow_part {
    const struct medium *medium;
    struct fog_cells cells; /* in the space of the density */
    const double *until;    /* by cell: sum of the powers up to and with it, over that of all */
    double power;           /* up to and with this part */
    double per_length;      /* one over the edge of a cell in the world, when the shutter opens */
};

struct glow {
    const struct medium *first; /* number 0 of the media */
    uint32_t medium_count, count;
    const uint32_t *part_of; /* by number: one more than its part; 0: none */
    struct glow_part *parts;
};

static const struct density *cells_of(const struct medium *medium) {
    return medium->heat ? medium->heat->kelvin : medium->density;
}

static bool has_cells(const struct medium *medium) {
    struct fog_cells cells;
    return !medium->fog && !colour_is_black(medium->emission) && cells_of(medium) &&
           density_cells(cells_of(medium), &cells);
}

static struct vec3 point_in(const struct fog_cells *cells, uint64_t cell, double x, double y, double z) {
    const double share[3] = {x, y, z};
    double p[3];
    for (int k = 0; k < 3; k++) {
        double n = cells->count[k], i = (double)(cell % cells->count[k]);
        cell /= cells->count[k];
        p[k] = vec3_get(cells->corner, k) + vec3_get(cells->size, k) * ((i + share[k]) / n);
    }
    return vec3_make(p[0], p[1], p[2]);
}

/* The sum over eight points; where these have no light, only rays find it. */
static double cell_power(const struct medium *medium, const struct fog_cells *cells, uint64_t cell) {
    double sum = 0;
    for (int i = 0; i < 8; i++) {
        const struct vec3 p = point_in(cells, cell, i & 1 ? 0.75 : 0.25, i & 2 ? 0.75 : 0.25, i & 4 ? 0.75 : 0.25);
        struct colour light = medium->emission;
        if (medium->heat)
            light = colour_mul(light, heat_at(medium->heat, p, 0));
        sum += (light.r + light.g + light.b) * density_value(medium->density, p, 0);
    }
    return sum;
}

/* Neighbours with the same cells share their sums. */
static bool make_part(struct glow_part *part, const struct glow_part *before, struct arena *arena,
                      struct error *error) {
    const struct medium *medium = part->medium;
    const float(*bounds)[2] = density_cells(cells_of(medium), &part->cells);
    const uint64_t count = fog_cell_count(&part->cells);
    bool shared = before && before->medium->density == medium->density && before->medium->heat == medium->heat &&
                  colour_equal(before->medium->emission, medium->emission);
    double *until = NULL, sum = 0;
    part->until = shared ? before->until : (until = arena_alloc_array(arena, count, sizeof *until));
    if (!part->until)
        return error_no_memory(error, "a medium");
    for (uint64_t i = 0; i < count; i++) {
        sum += bounds[i][1] > 0 ? cell_power(medium, &part->cells, i) : 0;
        if (until)
            until[i] = sum;
    }
    for (uint64_t i = 0; i < count && until && sum > 0; i++)
        until[i] /= sum;
    struct vec3 size = part->cells.size;
    double volume = size.x * size.y * size.z / (double)count;
    if (medium->placement)
        volume /= fabs(affine_determinant(&medium->placement->open));
    part->power = sum * volume;
    part->per_length = 1 / el_cbrt(volume);
    return true;
}

bool glow_build(const struct glow **out, const struct medium *media, uint32_t count, struct arena *arena,
                struct error *error) {
    uint32_t parts = 0;
    double sum = 0;
    *out = NULL;
    for (uint32_t i = 0; i < count; i++)
        parts += has_cells(&media[i]);
    if (parts == 0)
        return true;
    struct glow *glow = arena_alloc(arena, sizeof *glow);
    uint32_t *part_of = arena_alloc_array(arena, count, sizeof *part_of);
    struct glow_part *list = arena_alloc_array(arena, parts, sizeof *list);
    if (!glow || !part_of || !list)
        return error_no_memory(error, "a medium");
    *glow = (struct glow){.first = media, .medium_count = count, .part_of = part_of, .parts = list};
    for (uint32_t i = 0; i < count; i++) {
        if (!has_cells(&media[i]))
            continue;
        struct glow_part *part = &list[glow->count++];
        part->medium = &media[i];
        part_of[i] = glow->count;
        if (!make_part(part, glow->count > 1 ? part - 1 : NULL, arena, error))
            return false;
        sum = part->power += sum;
    }
    *out = sum > 0 ? glow : NULL;
    return true;
}

/* --- samples --- */

static struct affine placement_at(const struct medium_placement *placement, double time) {
    if (!placement)
        return affine_identity();
    struct affine at = placement->open;
    for (int i = 0; i < 12; i++)
        at.m[i / 4][i % 4] += time * (placement->close.m[i / 4][i % 4] - at.m[i / 4][i % 4]);
    return at;
}

/* The probability of a cell per volume of its space. */
static double cell_pdf(const struct glow *glow, const struct glow_part *part, uint64_t cell) {
    double before = part > glow->parts ? part[-1].power : 0, all = glow->parts[glow->count - 1].power;
    struct vec3 size = part->cells.size;
    double share = part->until[cell] - (cell > 0 ? part->until[cell - 1] : 0);
    return (part->power - before) / all * share * (double)fog_cell_count(&part->cells) / (size.x * size.y * size.z);
}

bool glow_sample(const struct glow *glow, double time, struct sample2 u, struct sample2 v, struct glow_sample *out) {
    double all = glow->parts[glow->count - 1].power, wanted = u.x * all;
    uint32_t i = 0;
    while (i + 1 < glow->count && !(glow->parts[i].power > wanted))
        i++;
    const struct glow_part *part = &glow->parts[i];
    double before = i > 0 ? part[-1].power : 0, left = (wanted - before) / (part->power - before);
    uint64_t cell = sample_entry(part->until, fog_cell_count(&part->cells), left);
    *out = (struct glow_sample){part->medium, point_in(&part->cells, cell, u.y, v.x, v.y), cell_pdf(glow, part, cell)};
    if (!(out->pdf > 0) || !part->medium->placement)
        return out->pdf > 0;
    /* Out of the space of its solid. */
    struct affine map = placement_at(part->medium->placement, time);
    struct transform placement;
    if (!transform_from_affine(&map, &placement))
        return false;
    out->point = affine_point(&placement.inverse, out->point);
    out->pdf *= fabs(affine_determinant(&map));
    return true;
}

/* NULL: it has none. */
static const struct glow_part *find_part(const struct glow *glow, const struct medium *medium) {
    size_t number = medium >= glow->first ? (size_t)(medium - glow->first) : glow->medium_count;
    uint32_t part = number < glow->medium_count ? glow->part_of[number] : 0;
    return part > 0 ? &glow->parts[part - 1] : NULL;
}

double glow_pdf(const struct glow *glow, const struct medium *medium, struct vec3 point, double time) {
    const struct glow_part *part = find_part(glow, medium);
    if (!part)
        return 0;
    struct affine placement = placement_at(medium->placement, time);
    uint64_t cell = density_cell(cells_of(medium), affine_point(&placement, point));
    return cell_pdf(glow, part, cell) * fabs(affine_determinant(&placement));
}

/* A ray takes one point of each cell, so its density per length is about one over the edge. */
double glow_met_weight(const struct glow_met *met, const struct medium *medium, struct vec3 point, double time) {
    double found = glow_pdf(met->glow, medium, point, time);
    if (!(found > 0))
        return 1;
    struct vec3 off = vec3_sub(point, met->from);
    double by_ray = met->pdf * find_part(met->glow, medium)->per_length, by_cell = found * vec3_dot(off, off);
    return by_ray * by_ray / (by_ray * by_ray + by_cell * by_cell);
}

static void bundle_kelvin(struct bundle *bundle, void *heat) {
    density_bundle(bundle, &((struct heat *)heat)->kelvin);
}

void heat_bundle(struct bundle *bundle, const struct heat **heat) {
    BUNDLE(bundle, *heat, 1, bundle_kelvin);
}

static void bundle_part(struct bundle *bundle, void *glow_part) {
    struct glow_part *part = glow_part;
    BUNDLE(bundle, part->medium, 1, medium_bundle);
    BUNDLE(bundle, part->until, (size_t)fog_cell_count(&part->cells), NULL);
}

static void bundle_parts(struct bundle *bundle, void *glowing) {
    struct glow *glow = glowing;
    BUNDLE(bundle, glow->first, glow->medium_count, medium_bundle);
    BUNDLE(bundle, glow->part_of, glow->medium_count, NULL);
    BUNDLE(bundle, glow->parts, glow->count, bundle_part);
}

void glow_bundle(struct bundle *bundle, const struct glow **glow) {
    BUNDLE(bundle, *glow, 1, bundle_parts);
}
