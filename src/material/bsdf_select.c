/* Lobes by purpose. */
#include "material/bsdf_select.h"

/* Lobes with a weight: highlights, and the others. */
struct lobe_sets {
    uint32_t highlights, others;
    bool traced; /* there are traced lobes, whatever their weight */
};

static struct lobe_sets sets_of(const struct bsdf *bsdf) {
    struct lobe_sets sets = {0, 0, false};
    for (int i = 0; i < bsdf->count; i++) {
        const struct lobe *lobe = &bsdf->lobes[i];
        unsigned flags = lobe_flags(lobe->kind);
        sets.traced = sets.traced || (flags & BSDF_TRACED);
        if (!colour_is_black(lobe->weight))
            *(flags & BSDF_EXPONENT ? &sets.highlights : &sets.others) |= UINT32_C(1) << i;
    }
    return sets;
}

uint32_t bsdf_select_of_many(const struct bsdf *bsdf, enum bsdf_purpose purpose) {
    uint32_t all = (UINT32_C(1) << bsdf->count) - 1;
    struct lobe_sets sets;
    switch (purpose) {
    case BSDF_FOR_PATHS:
        sets = sets_of(bsdf);
        return sets.traced ? sets.others : sets.others | sets.highlights;
    case BSDF_FOR_UNSEEN_LIGHTS:
        if (bsdf->alpha != 0)
            return 0;
        sets = sets_of(bsdf);
        return sets.traced ? sets.highlights : 0;
    case BSDF_FOR_PHOTONS:
        return bsdf_lambert(bsdf) > 0 && !bsdf->dark ? bsdf_lobes_with(bsdf, BSDF_CLASSIC) : 0;
    case BSDF_FOR_DIFFUSE:
        return bsdf_lobes_with(bsdf, BSDF_DIFFUSE) & ~bsdf_lobes_with(bsdf, BSDF_TRANSMITS);
    case BSDF_FOR_SPECULAR:
        return all & ~bsdf_lobes_with(bsdf, BSDF_DIFFUSE | BSDF_TRANSMITS);
    case BSDF_FOR_TRANSMISSION:
        return bsdf_lobes_with(bsdf, BSDF_TRANSMITS);
    }
    return 0;
}

struct colour bsdf_weight_of(const struct bsdf *bsdf, uint32_t *lobes, bool *lambert) {
    struct colour sum = {0, 0, 0};
    uint32_t left = 0;
    *lambert = true;
    for (int i = 0; i < bsdf->count; i++) {
        const struct lobe *lobe = &bsdf->lobes[i];
        if (!(*lobes >> i & 1) || colour_is_black(lobe->weight))
            continue;
        left |= UINT32_C(1) << i;
        *lambert = *lambert && (lobe_flags(lobe->kind) & BSDF_LAMBERT);
        sum = colour_add(sum, lobe->weight);
    }
    *lobes = left;
    return sum;
}

struct colour bsdf_diffuse(const struct bsdf *bsdf) {
    struct colour sum = {0, 0, 0};
    for (int i = 0; i < bsdf->count && !bsdf->dark; i++)
        if ((lobe_flags(bsdf->lobes[i].kind) & (BSDF_CLASSIC | BSDF_DIFFUSE)) == (BSDF_CLASSIC | BSDF_DIFFUSE))
            sum = colour_add(sum, bsdf->lobes[i].weight);
    return sum;
}

double bsdf_lambert(const struct bsdf *bsdf) {
    double largest = 0;
    for (int i = 0; i < bsdf->count; i++)
        if (lobe_flags(bsdf->lobes[i].kind) & BSDF_LAMBERT)
            largest = math_max(largest, colour_max_abs(bsdf->lobes[i].weight));
    return largest;
}

bool bsdf_branch_is_layered(const struct bsdf *bsdf, const struct bsdf_branch *branch) {
    return lobe_flags(bsdf->lobes[branch->lobe].kind) & BSDF_ROUGH;
}

/* About what the lobe reflects and transmits of light from everywhere. The weights of layered lobes are those of light
 * that meets their facets: the white ones of a gloss would hide the colours below it. */
static struct colour expected_albedo(const struct bsdf *bsdf, const struct lobe *lobe) {
    const bool has_facets = lobe->kind == LOBE_METAL || lobe->kind == LOBE_FILM;
    if (has_facets && bsdf->facets[lobe->facets].kind == FACETS_METAL)
        return colour_mul(lobe->weight, bsdf->facets[lobe->facets].f0);
    return lobe->share > 0 ? colour_scale(lobe->weight, lobe->share) : lobe->weight;
}

struct bsdf_guide bsdf_guide(const struct bsdf *bsdf, struct colour glow) {
    struct bsdf_guide guide = {.albedo = glow};
    for (int i = 0; i < bsdf->count; i++) {
        const struct lobe *lobe = &bsdf->lobes[i];
        unsigned flags = lobe_flags(lobe->kind);
        if (flags & BSDF_EXPONENT)
            continue;
        bool smooth = ((flags & BSDF_DELTA) && !(flags & BSDF_BELOW)) ||
                      (!(flags & BSDF_ROUGH) && (flags & BSDF_TRACED) && bsdf->alpha == 0);
        guide.scatters = guide.scatters || (!smooth && !colour_is_black(lobe->weight));
        guide.albedo = colour_add(guide.albedo, expected_albedo(bsdf, lobe));
        *(flags & BSDF_TRANSMITS ? &guide.refracted : &guide.reflected) += colour_max_abs(lobe->weight);
    }
    return guide;
}

struct bsdf bsdf_matt_copy(const struct bsdf *bsdf) {
    struct bsdf matt = *bsdf;
    matt.count = 1;
    matt.lobes[0] = (struct lobe){.kind = LOBE_DIFFUSE, .weight = colour_all(1), .share = 1};
    matt.ambient = colour_all(0);
    return matt;
}

struct bsdf bsdf_shiny_copy(const struct bsdf *bsdf, struct colour *colour) {
    struct bsdf shiny = *bsdf;
    shiny.count = 0;
    shiny.ambient = colour_all(0);
    *colour = colour_all(0);
    for (int i = 0; i < bsdf->count; i++) {
        unsigned flags = lobe_flags(bsdf->lobes[i].kind);
        if (!(flags & BSDF_CLASSIC) || flags & BSDF_DIFFUSE)
            continue;
        shiny.lobes[shiny.count++] = bsdf->lobes[i];
        *colour = colour_add(*colour, bsdf->lobes[i].weight);
    }
    return shiny;
}
