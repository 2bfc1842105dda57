/* See medium.h. */
#include "material/medium.h"

#include "material/fog_field.h"
#include "material/glow.h"
#include "material/medium_mix.h"
#include "math/elementary.h"
#include "math/spectrum.h"

#include <string.h>

struct medium medium_outside(const struct fog *fog) {
    return (struct medium){.ior = 1, .tint = {1, 1, 1}, .fog = fog, .affects = fog ? MEDIUM_RAY_SIGHT : 0};
}

static bool has_some(struct colour c) {
    return c.r > 0 || c.g > 0 || c.b > 0;
}

static const unsigned affects_all = MEDIUM_RAY_SIGHT | MEDIUM_RAY_SCATTERED | MEDIUM_RAY_SHADOW | MEDIUM_RAY_PHOTON;

struct medium medium_scattering(const struct medium_input *in) {
    struct medium medium = {.ior = 1, .tint = {1, 1, 1}, .phase = in->phase, .scatters = has_some(in->scattering)};
    medium.scattering = in->scattering;
    medium.emission = in->emission;
    medium.extinction = colour_add(in->absorption, in->scattering);
    medium.density = in->density;
    medium.heat = in->heat;
    medium.mixed = in->density != NULL;
    medium.affects = has_some(medium.extinction) || has_some(in->emission) ? affects_all : 0;
    return medium;
}

struct medium medium_filling(const struct medium_input *in) {
    struct medium medium = medium_scattering(in);
    medium.fills = medium.mixed = true;
    medium.affects = affects_all;
    return medium;
}

struct medium medium_without_solid(const struct medium *filling) {
    struct medium medium = *filling;
    medium.fills = false;
    medium.mixed = medium.density != NULL;
    medium.affects = has_some(medium.extinction) || has_some(medium.emission) ? affects_all : 0;
    return medium;
}

void medium_put_inside(struct medium *medium, const struct medium *inner) {
    medium->inner = inner;
    medium->mixed = true;
    medium->affects = affects_all;
}

struct medium medium_inside(double ior, struct colour tint, const struct medium_input *in) {
    struct medium medium = medium_scattering(in);
    medium.ior = ior;
    medium.tint = tint;
    return medium;
}

/* The law of Beer, Lambert and Bouguer. */
static struct colour uniform_transmittance(struct colour a, double distance) {
    return (struct colour){a.r > 0 ? el_exp(-a.r * distance) : 1, a.g > 0 ? el_exp(-a.g * distance) : 1,
                           a.b > 0 ? el_exp(-a.b * distance) : 1};
}

/* The integral of the transmittance over the distance. */
static double depth_seen(double extinction, double distance) {
    return extinction > 0 ? -el_expm1(-extinction * distance) / extinction : distance;
}

struct colour medium_emission(const struct medium *medium, double distance) {
    struct colour e = medium->emission, s = medium->extinction;
    return colour_make(e.r > 0 ? e.r * depth_seen(s.r, distance) : 0, e.g > 0 ? e.g * depth_seen(s.g, distance) : 0,
                       e.b > 0 ? e.b * depth_seen(s.b, distance) : 0);
}

static bool fog_effect(const struct fog *fog, const struct ray *ray, double distance, struct medium_effect *out) {
    if (fog->clear_sky && distance == INFINITY)
        return false;
    struct vec3 direction = vec3_scale(ray->direction, 1 / vec3_length(ray->direction));
    out->source = fog->colour;
    if (fog->kind == FOG_FIELD) {
        const struct medium_line line = {ray->origin, direction, distance, ray->time};
        out->transmittance = colour_all(fog_field_transmittance(fog->field, &line, &out->source));
    } else {
        out->transmittance = colour_all(fog_transmittance(fog, ray->origin, direction, distance));
    }
    out->added = colour_mul(out->source, colour_sub(colour_all(1), out->transmittance));
    return true;
}

/* Emission over extinction. where_clear: of the channels without extinction. */
static struct colour source_of(const struct medium *medium, struct colour where_clear) {
    struct colour e = medium->emission, s = medium->extinction;
    return colour_make(s.r > 0 ? e.r / s.r : where_clear.r, s.g > 0 ? e.g / s.g : where_clear.g,
                       s.b > 0 ? e.b / s.b : where_clear.b);
}

double medium_brightest(const struct medium *medium) {
    struct colour source = medium->fog ? medium->fog->colour : source_of(medium, medium->emission);
    if (medium->heat)
        source = colour_mul(source, heat_brightest(medium->heat));
    return math_max(source.r, math_max(source.g, source.b));
}

/* That of one medium. */
static bool single_effect(const struct medium *medium, const struct ray *ray, double distance,
                          struct medium_effect *out) {
    if (medium->fog)
        return fog_effect(medium->fog, ray, distance, out);
    out->transmittance = uniform_transmittance(medium->extinction, distance);
    if (has_some(medium->emission)) {
        out->added = medium_emission(medium, distance);
        out->source = source_of(medium, out->added);
    }
    return true;
}

static bool mix_effect(const struct ray *ray, double distance, struct medium_effect *out) {
    struct medium_mix mix;
    medium_stack_mix(ray->media, &mix);
    if (mix.count == 0)
        return false;
    if (mix.count == 1 && !mix.media[0]->density)
        return single_effect(mix.media[0], ray, distance, out);
    const struct medium_line line = {ray->origin, vec3_normalize(ray->direction), distance, ray->time};
    out->transmittance = medium_mix_dimmed(&mix, &line);
    return true;
}

bool medium_transmittance(enum medium_ray kind, const struct ray *ray, double distance, struct medium_effect *out) {
    out->transmittance = colour_all(1);
    out->added = out->source = colour_all(0);
    if (!medium_affects(kind, ray))
        return false;
    const struct medium *medium = medium_stack_current(ray->media);
    if (medium->mixed)
        return mix_effect(ray, distance, out);
    return single_effect(medium, ray, distance, out);
}

static double quotient(double part, double all) {
    return all > 0 ? part / all : 0;
}

struct colour medium_albedo(const struct medium *medium) {
    struct colour s = medium->scattering, e = medium->extinction;
    return colour_make(quotient(s.r, e.r), quotient(s.g, e.g), quotient(s.b, e.b));
}

struct medium_flight medium_fly(struct colour extinction, struct colour throughput, struct sample2 u) {
    throughput = colour_abs(throughput); /* single wavelengths have negative components */
    double sum = throughput.r + throughput.g + throughput.b;
    struct colour shares = sum > 0 ? colour_scale(throughput, 1 / sum) : colour_all(1.0 / 3), e = extinction;
    double chosen = u.x < shares.r ? e.r : u.x < shares.r + shares.g ? e.g : e.b;
    return (struct medium_flight){chosen > 0 ? -el_log(1 - u.y) / chosen : INFINITY, shares};
}

double medium_flight_chance(const struct medium_flight *flight, struct colour extinction, struct colour left,
                            bool event) {
    return colour_dot(flight->shares, event ? colour_mul(extinction, left) : left);
}

struct medium_sample medium_sample(const struct medium *medium, double distance, struct colour throughput,
                                   struct sample2 u) {
    const struct medium_flight flight = medium_fly(medium->extinction, throughput, u);
    struct medium_sample sample = {.scatters = flight.distance < distance,
                                   .distance = math_min(flight.distance, distance)};
    struct colour left = uniform_transmittance(medium->extinction, sample.distance);
    double chance = medium_flight_chance(&flight, medium->extinction, left, sample.scatters);
    sample.weight =
        colour_scale(sample.scatters ? colour_mul(medium->scattering, left) : left, chance > 0 ? 1 / chance : 0);
    return sample;
}

void medium_stack_copy(struct medium_stack *to, const struct medium_stack *from) {
    to->media = from->media;
    to->count = from->count;
    to->wavelength = from->wavelength;
    memcpy(to->solids, from->solids, from->count * sizeof *from->solids);
}

/* Whether two media have the same effect on light. */
static bool are_equal(const struct medium *a, const struct medium *b) {
    return a->fog == b->fog && dispersion_equal(a->dispersion, b->dispersion) && a->density == b->density &&
           a->heat == b->heat && colour_equal(a->extinction, b->extinction) &&
           colour_equal(a->scattering, b->scattering) && colour_equal(a->emission, b->emission) &&
           a->phase.kind == b->phase.kind && a->phase.g == b->phase.g &&
           (!a->placement || !b->placement ? a->placement == b->placement
                                           : memcmp(a->placement, b->placement, sizeof *a->placement) == 0);
}

bool medium_stacks_equal(const struct medium_stack *a, const struct medium_stack *b) {
    const struct medium *x = medium_stack_current(a), *y = medium_stack_current(b);
    struct medium_mix of_a, of_b;
    if (medium_stack_ior(a) != medium_stack_ior(b) || !colour_equal(x->tint, y->tint))
        return false;
    if (!x->mixed && !y->mixed)
        return are_equal(x, y);
    medium_stack_mix(a, &of_a);
    medium_stack_mix(b, &of_b);
    bool equal = of_a.count == of_b.count;
    for (uint32_t i = 0; equal && i < of_a.count; i++)
        equal = are_equal(of_a.media[i], of_b.media[i]);
    return equal;
}

void medium_stack_enter(struct medium_stack *stack, uint32_t solid) {
    if (stack->count == MEDIUM_STACK_LIMIT) {
        memmove(stack->solids, stack->solids + 1, (MEDIUM_STACK_LIMIT - 1) * sizeof *stack->solids);
        stack->count--;
    }
    stack->solids[stack->count++] = solid;
}

/* One more than the index of the latest entry of the solid's primitive; 0: it has none. */
static uint32_t latest(const struct medium_stack *stack, uint32_t solid) {
    uint32_t i = stack->count;
    if (i == 0)
        return 0;
    const struct solid *solids = stack->media->solids;
    while (i > 0 && solids[stack->solids[i - 1]].primitive != solids[solid].primitive)
        i--;
    return i;
}

bool medium_stack_has(const struct medium_stack *stack, uint32_t solid) {
    return solid != SOLID_NONE && latest(stack, solid) > 0;
}

void medium_stack_leave(struct medium_stack *stack, uint32_t solid) {
    uint32_t end = latest(stack, solid);
    if (end == 0)
        return;
    memmove(stack->solids + end - 1, stack->solids + end, (stack->count - end) * sizeof *stack->solids);
    stack->count--;
}

struct colour medium_stack_choose_wavelength(struct medium_stack *stack, double u) {
    struct colour weight;
    stack->wavelength = (float)spectrum_sample(u, &weight);
    return weight;
}

void medium_stack_cross(struct medium_stack *stack, const struct medium_boundary *boundary) {
    if (boundary->thin)
        return;
    if (boundary->entering)
        medium_stack_enter(stack, boundary->solid);
    else
        medium_stack_leave(stack, boundary->solid);
}

double medium_stack_eta(const struct medium_stack *stack, const struct medium_boundary *boundary) {
    double here = medium_stack_ior(stack);
    if (boundary->entering)
        return here / boundary->ior;
    uint32_t end = latest(stack, boundary->solid);
    /* An open surface seen from behind: the ray is in this medium although it never entered it. */
    if (end == 0)
        return boundary->ior / here;
    /* Within another solid that has a surface. */
    if (medium_stack_below(stack, stack->count) > end)
        return 1;
    return here / medium_stack_ior_of(stack, end - 1);
}

void medium_bundle(struct bundle *bundle, void *any) {
    struct medium *medium = any;
    BUNDLE(bundle, medium->fog, 1, fog_bundle);
    density_bundle(bundle, &medium->density);
    heat_bundle(bundle, &medium->heat);
    BUNDLE(bundle, medium->placement, 1, NULL);
    BUNDLE(bundle, medium->inner, 1, medium_bundle);
}
