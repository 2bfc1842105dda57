/* BSDFs: every lobe alone, several together, and which material has which lobes. Directions are binned on the sphere in
 * cells of equal solid angle about the geometric normal, so that the tangent plane is a border of cells. */
#include "tests/harness.h"
#include "tests/unit/surface_makers.h"

#include "material/material_inputs.h"
#include "material/microfacet_internal.h"
#include "material/openpbr.h"
#include "material/rough_lobes_internal.h"

#include <math.h>
#include <stdio.h>

static const double pi = 3.14159265358979323846;

/* One surface that is seen from wo. */
struct view {
    struct bsdf bsdf;
    struct vec3 wo;
};

static struct vec3 direction_at(double degrees, double turn) {
    double angle = degrees * pi / 180;
    return vec3_make(sin(angle) * cos(turn), sin(angle) * sin(turn), cos(angle));
}

/* A surface with normal +z; one angle tilts its shading normal, another one tilts wo. */
static struct view view_make(double lean, double degrees, double alpha, double eta) {
    struct view view = {.wo = direction_at(degrees, 0.7)};
    struct bsdf *bsdf = &view.bsdf;
    bsdf->geometric_side = vec3_make(0, 0, 1);
    bsdf->normal = bsdf->lit = bsdf->side = direction_at(lean, 2);
    if (!(vec3_dot(bsdf->side, view.wo) > 0))
        bsdf->side = bsdf->geometric_side;
    bsdf->opacity = 1;
    bsdf->alpha = alpha;
    bsdf->eta = eta;
    bsdf->fresnel = -1;
    bsdf->turns_back = true;
    struct vec3 through;
    bsdf->transmits = bsdf_refract(bsdf, view.wo, &through);
    return view;
}

static bool is_pane(enum lobe_kind kind) {
    return kind == LOBE_PANE || kind == LOBE_FILM_PANE || kind == LOBE_DIFFUSE_THROUGH;
}

/* Facets that are wider along one tangent than along the other, as the kind of lobe needs them. */
static void set_facets(struct bsdf *bsdf, enum lobe_kind kind, double alpha, double eta) {
    struct bsdf_facets *facets = &bsdf->facets[0];
    if (!(alpha > 0))
        return;
    bsdf_facets_shape(facets, bsdf->side, vec3_make(1, 2, 0.5), sqrt(alpha), 0.4);
    if (kind == LOBE_METAL)
        bsdf_facets_metal(facets, colour_make(0.9, 0.7, 0.3), colour_make(0.9, 1, 0.8));
    else if (is_pane(kind))
        bsdf_facets_pane(facets, eta);
    else
        bsdf_facets_glass(facets, eta);
    bsdf->film = (struct thin_film){0.8, 0.4, 1.35, eta > 1 ? eta : 1, 0};
}

static void add(struct view *view, enum lobe_kind kind, struct colour weight, double exponent) {
    set_facets(&view->bsdf, kind, view->bsdf.alpha, is_pane(kind) ? 1 / 1.5 : view->bsdf.eta);
    view->bsdf.lobes[view->bsdf.count++] = (struct lobe){.kind = kind, .weight = weight, .exponent = exponent};
}

static struct sample2 xi_of(uint64_t key, uint32_t i) {
    uint64_t bits = random_combine(key, i);
    return (struct sample2){random_unit(bits), random_unit(random_combine(bits, 1))};
}

/* --- sampling against density --- */

enum { ROWS = 16, COLUMNS = 24, CELLS = ROWS * COLUMNS };

static int cell_of(struct vec3 direction) {
    double row = (direction.z + 1) / 2 * ROWS, column = (atan2(direction.y, direction.x) / (2 * pi) + 0.5) * COLUMNS;
    int r = row >= ROWS ? ROWS - 1 : row > 0 ? (int)row : 0;
    int c = column >= COLUMNS ? COLUMNS - 1 : column > 0 ? (int)column : 0;
    return r * COLUMNS + c;
}

/* A direction in part (i, j) of n x n parts of the cell. */
static struct vec3 direction_in(int cell, int i, int j, int n) {
    double z = -1 + 2 * (cell / COLUMNS + (i + 0.5) / n) / ROWS;
    double turn = 2 * pi * ((cell % COLUMNS + (j + 0.5) / n) / COLUMNS - 0.5), across = sqrt(1 - z * z);
    return vec3_make(across * cos(turn), across * sin(turn), z);
}

/* The integral of the density over the cell: refined until two steps agree. */
static double integral_over(const struct view *view, int cell) {
    double before = -1, solid_angle = 4 * pi / CELLS;
    for (int n = 4;; n *= 2) {
        double sum = 0;
        for (int k = 0; k < n * n; k++)
            sum += bsdf_pdf(&view->bsdf, BSDF_ALL, view->wo, direction_in(cell, k / n, k % n, n));
        sum *= solid_angle / (n * n);
        if (fabs(sum - before) <= 2e-4 * sum + 1e-8 || n == 128)
            return sum;
        before = sum;
    }
}

struct tally {
    double counts[CELLS], expected[CELLS];
    double lost, delta; /* shares */
};

/* Chi-square of the counts against the integrals; cells with few expected samples are joined. */
static void check_distribution(const char *what, const struct view *view, uint32_t samples) {
    struct tally t = {.lost = 0};
    for (uint32_t i = 0; i < samples; i++) {
        struct bsdf_sample sample;
        if (!bsdf_sample(&view->bsdf, BSDF_ALL, BSDF_IMPORTANCE, view->wo, xi_of(17, i), &sample))
            t.lost += 1;
        else if (sample.flags & BSDF_DELTA)
            t.delta += 1;
        else
            t.counts[cell_of(sample.direction)] += 1;
    }
    double integral = 0, chi2 = 0, few = 0, few_expected = 0;
    int degrees = -1;
    for (int cell = 0; cell < CELLS; cell++) {
        double share = integral_over(view, cell), expected = share * samples;
        integral += share;
        if (expected < 20) {
            few += t.counts[cell];
            few_expected += expected;
            continue;
        }
        chi2 += (t.counts[cell] - expected) * (t.counts[cell] - expected) / expected;
        degrees++;
    }
    if (few_expected >= 5) {
        chi2 += (few - few_expected) * (few - few_expected) / few_expected;
        degrees++;
    } else if (few > 30)
        test_fail(__FILE__, __LINE__, "%s: %g samples where none are expected", what, few);
    double sum = integral + (t.lost + t.delta) / samples;
    if (!(fabs(sum - 1) < 4e-3))
        test_fail(__FILE__, __LINE__, "%s: density, lost and single directions are %.5f together", what, sum);
    /* A normal approximation (Wilson and Hilferty): a correct density is rejected once in 10^5 tests. */
    double n = degrees > 0 ? degrees : 1, z = (cbrt(chi2 / n) - (1 - 2 / (9 * n))) / sqrt(2 / (9 * n));
    if (!(z < 4.3))
        test_fail(__FILE__, __LINE__, "%s: chi-square %.1f for %d degrees of freedom", what, chi2, degrees);
}

/* Directions wo that are hard to sample in different ways. */
struct situation {
    double lean, degrees, alpha, eta, exponent;
};
static const struct situation situations[] = {
    {0, 0, 0.5, 1 / 1.5, 1},  {0, 50, 0.3, 1 / 1.5, 20}, {25, 60, 0.6, 1.5, 5},
    {0, 82, 0.8, 1 / 1.3, 0}, {40, 30, 1, 1.5, 40},
};
enum { SITUATIONS = sizeof situations / sizeof *situations };

static void check_all_kinds(int k, uint32_t samples) {
    const struct situation *s = &situations[k];
    for (int kind = 0; kind < LOBE_KINDS; kind++) {
        struct view view = view_make(s->lean, s->degrees, s->alpha, s->eta);
        char what[64];
        if (lobe_flags((enum lobe_kind)kind) & BSDF_DELTA)
            continue;
        (void)snprintf(what, sizeof what, "%s, situation %d", lobe_name((enum lobe_kind)kind), k);
        add(&view, (enum lobe_kind)kind, colour_make(0.7, 0.5, 0.2), s->exponent);
        check_distribution(what, &view, samples);
    }
}

TEST(every_lobe_is_sampled_by_its_density_head_on) {
    check_all_kinds(0, 150000);
}
TEST(every_lobe_is_sampled_by_its_density_at_grazing_angles) {
    check_all_kinds(3, 150000);
}
TEST_LONG(every_lobe_is_sampled_by_its_density_in_every_situation) {
    for (int k = 0; k < SITUATIONS; k++)
        check_all_kinds(k, 1000000);
}

TEST(several_lobes_are_sampled_by_the_sum_of_their_densities) {
    struct view view = view_make(10, 40, 0.5, 1 / 1.5);
    add(&view, LOBE_DIFFUSE, colour_make(0.5, 0.1, 0.2), 0);
    add(&view, LOBE_PHONG, colour_all(0.3), 12);
    add(&view, LOBE_GGX_REFLECTION, colour_all(0.1), 0);
    add(&view, LOBE_GGX_TRANSMISSION, colour_all(0.6), 0);
    check_distribution("four lobes", &view, 1000000);
    view.bsdf.lobes[3].kind = LOBE_REFRACTION;
    view.bsdf.lobes[2].kind = LOBE_MIRROR;
    check_distribution("two of four lobes with one direction", &view, 1000000);
}

/* --- weights --- */

TEST(the_weight_of_a_sample_is_f_times_cosine_over_density) {
    for (int kind = 0; kind < LOBE_KINDS; kind++) {
        for (int k = 0; k < SITUATIONS; k++) {
            const struct situation *s = &situations[k];
            struct view view = view_make(s->lean, s->degrees, s->alpha, s->eta);
            struct colour weight = colour_make(0.7, 0.5, 0.2);
            add(&view, (enum lobe_kind)kind, weight, s->exponent);
            for (int mode = 0; mode < 2; mode++) {
                for (uint32_t i = 0; i < 2000; i++) {
                    struct bsdf_sample sample;
                    if (!bsdf_sample(&view.bsdf, BSDF_ALL, (enum bsdf_mode)mode, view.wo, xi_of(3, i), &sample))
                        continue;
                    CHECK_NEAR(vec3_length(sample.direction), 1, 1e-9);
                    bool through = vec3_dot(sample.direction, view.bsdf.geometric_side) < 0;
                    if (lobe_flags((enum lobe_kind)kind) & BSDF_TRACED)
                        CHECK(through == ((sample.flags & BSDF_TRANSMITS) != 0));
                    double n2 = mode == BSDF_RADIANCE && (sample.flags & BSDF_TRANSMITS) ? s->eta * s->eta : 1;
                    if (sample.flags & BSDF_DELTA) {
                        CHECK_NEAR(sample.pdf, 1, 0);
                        CHECK_NEAR(sample.weight.r, weight.r * n2, 1e-12);
                        continue;
                    }
                    struct colour f = bsdf_eval(&view.bsdf, BSDF_ALL, (enum bsdf_mode)mode, view.wo, sample.direction);
                    double pdf = bsdf_pdf(&view.bsdf, BSDF_ALL, view.wo, sample.direction);
                    CHECK_NEAR(sample.pdf, pdf, 1e-12 * pdf);
                    CHECK_NEAR(sample.weight.r * pdf, f.r, 1e-9 * f.r);
                    CHECK_NEAR(sample.weight.b * pdf, f.b, 1e-9 * f.b);
                    if (lobe_flags((enum lobe_kind)kind) & BSDF_LAMBERT)
                        CHECK_NEAR(sample.weight.g, weight.g * n2, 1e-9);
                    if (lobe_flags((enum lobe_kind)kind) & BSDF_TRACED) /* masking takes some of it */
                        CHECK(sample.weight.g > 0 && sample.weight.g < weight.g * n2 * (1 + 1e-12));
                }
            }
        }
    }
}

TEST(classic_lobes_answer_lights_by_pi_times_f_times_cosine) {
    struct view view = view_make(20, 35, 0, 1);
    add(&view, LOBE_DIFFUSE, colour_make(0.5, 0.1, 0.2), 0);
    add(&view, LOBE_PHONG, colour_make(0.2, 0.3, 0.4), 7);
    add(&view, LOBE_MIRROR, colour_all(0.5), 0);
    struct vec3 n = view.bsdf.lit;
    for (uint32_t i = 0; i < 1000; i++) {
        struct vec3 l = direction_in((int)(i % CELLS), 0, (int)(i % 3), 3), r = dielectric_mirror(n, l);
        double n_l = vec3_dot(n, l), r_v = vec3_dot(r, view.wo), highlight = r_v > 0 ? pow(r_v, 7) : 0;
        bool before =
            n_l > 0 && l.z > 0; /* light from behind the surface contributes nothing although the normal is tilted */
        double red = before ? 0.5 * n_l + 0.2 * highlight : 0, blue = before ? 0.2 * n_l + 0.4 * highlight : 0;
        struct colour light = bsdf_classic(&view.bsdf, BSDF_ALL, view.wo, l);
        CHECK_NEAR(light.r, red, 1e-14);
        CHECK_NEAR(light.b, blue, 1e-14);
        struct colour f = bsdf_eval(&view.bsdf, BSDF_ALL, BSDF_RADIANCE, view.wo, l);
        CHECK_NEAR(f.r * pi, red, 1e-14);
        CHECK_NEAR(bsdf_classic(&view.bsdf, 1, view.wo, l).b, before ? 0.2 * n_l : 0, 1e-15);
    }
    view.bsdf.dark = true;
    CHECK_NEAR(bsdf_eval(&view.bsdf, BSDF_ALL, BSDF_RADIANCE, view.wo, n).r, 0, 0);
    for (int kind = 0; kind < LOBE_KINDS; kind++) {
        view = view_make(20, 35, 0.5, 1 / 1.5);
        add(&view, (enum lobe_kind)kind, colour_make(0.2, 0.3, 0.4), 7);
        bool classic = lobe_flags((enum lobe_kind)kind) & BSDF_CLASSIC;
        for (uint32_t i = 0; i < 1000; i++) {
            struct vec3 l = direction_in((int)(i % CELLS), 0, (int)(i % 3), 3);
            struct colour light = bsdf_classic(&view.bsdf, BSDF_ALL, view.wo, l);
            struct colour f = bsdf_eval(&view.bsdf, BSDF_ALL, BSDF_RADIANCE, view.wo, l);
            CHECK_NEAR(light.g, classic ? f.g * pi : 0, 1e-14);
        }
    }
}

/* The quotients of the formulas of docs/language.md 5.2 and the densities of power cosines about r and n. */
TEST(weights_of_highlights_are_closed_forms) {
    for (double exponent = 0; exponent < 100; exponent = 2 * exponent + 1) {
        struct view phong = view_make(0, 35, 0, 1), blinn = phong;
        add(&phong, LOBE_PHONG, colour_all(0.5), exponent);
        add(&blinn, LOBE_BLINN, colour_all(0.5), exponent);
        for (uint32_t i = 0; i < 1000; i++) {
            struct bsdf_sample sample;
            if (bsdf_sample(&phong.bsdf, BSDF_ALL, BSDF_RADIANCE, phong.wo, xi_of(5, i), &sample))
                CHECK_NEAR(sample.weight.r, 0.5 * 2 / (exponent + 1), 1e-12);
            if (bsdf_sample(&blinn.bsdf, BSDF_ALL, BSDF_RADIANCE, blinn.wo, xi_of(6, i), &sample)) {
                double v_h = vec3_dot(blinn.wo, vec3_normalize(vec3_add(blinn.wo, sample.direction)));
                CHECK_NEAR(sample.weight.r, 0.5 * 8 * v_h / (exponent + 1), 1e-12);
            }
        }
    }
}

/* --- reciprocity --- */

TEST(the_diffuse_lobe_is_reciprocal) {
    struct view view = view_make(0, 50, 0, 1);
    add(&view, LOBE_DIFFUSE, colour_make(0.5, 0.1, 0.2), 0);
    for (uint32_t i = 0; i < 200; i++) {
        struct vec3 a = direction_at(89 * xi_of(1, i).x, 6 * xi_of(1, i).y);
        struct vec3 b = direction_at(89 * xi_of(2, i).x, 6 * xi_of(2, i).y);
        double ab = bsdf_eval(&view.bsdf, BSDF_ALL, BSDF_RADIANCE, a, b).r / b.z;
        double ba = bsdf_eval(&view.bsdf, BSDF_ALL, BSDF_RADIANCE, b, a).r / a.z;
        CHECK_NEAR(ab, ba, 1e-14);
        CHECK_NEAR(ab, 0.5 / pi, 1e-14);
    }
}

/* --- rough boundaries, by formulas of their own --- */

/* Smith's masking of one direction by the distribution of Trowbridge and Reitz: Lambda. */
static double masked(struct vec3 v, double alpha) {
    double tangent2 = (1 - v.z * v.z) / (v.z * v.z);
    return (sqrt(1 + alpha * alpha * tangent2) - 1) / 2;
}

/* f |cos wi| of Walter et al. 2007, equations 20 and 21, in the frame of the surface; eta = index at wo / at wi. */
static double walter(struct vec3 wo, struct vec3 wi, double alpha, double eta, bool fresnel) {
    bool through = wi.z < 0;
    struct vec3 h = vec3_normalize(through ? vec3_add_scaled(wi, wo, eta) : vec3_add(wo, wi));
    h = h.z < 0 ? vec3_negate(h) : h;
    double o = vec3_dot(wo, h), i = vec3_dot(wi, h), c2 = h.z * h.z, slope = c2 * alpha * alpha + 1 - c2;
    if (o <= 0 || (i < 0) != through)
        return 0;
    double d = alpha * alpha / (pi * slope * slope), g = 1 / (1 + masked(wo, alpha) + masked(wi, alpha));
    double sine2 = eta * eta * (1 - o * o), t = sine2 < 1 ? sqrt(1 - sine2) : 0;
    double rs = (eta * o - t) / (eta * o + t), rp = (o - eta * t) / (o + eta * t);
    double f = sine2 < 1 ? (rs * rs + rp * rp) / 2 : 1;
    if (!through)
        return (fresnel ? f : 1) * d * g / (4 * wo.z);
    double sum = eta * o + i;
    return (fresnel ? 1 - f : 1) * o * -i / (wo.z * sum * sum) * d * g;
}

static struct view rough_view(double degrees, double alpha, double eta) {
    struct view view = view_make(0, degrees, alpha, eta);
    view.bsdf.fresnel_of_facets = true;
    view.bsdf.fresnel = dielectric_fresnel(view.wo.z, eta);
    add(&view, LOBE_GGX_REFLECTION, colour_all(1), 0);
    add(&view, LOBE_GGX_TRANSMISSION, colour_all(1), 0);
    return view;
}

TEST(rough_boundaries_are_those_of_walter_with_fresnel_s_share_of_each_facet) {
    static const double etas[] = {1 / 1.5, 1.5, 1 / 1.33, 2.4};
    for (int e = 0; e < 4; e++)
        for (int k = 0; k < 40; k++) {
            double degrees = 2 + 2.1 * k, alpha = 0.05 + 0.95 * xi_of(4, (uint32_t)k).x;
            struct view view = rough_view(degrees, alpha, etas[e]);
            for (int cell = 0; cell < CELLS; cell++) {
                struct vec3 wi = direction_in(cell, 1, 1, 3);
                double f = bsdf_eval(&view.bsdf, BSDF_ALL, BSDF_IMPORTANCE, view.wo, wi).r;
                double expected = walter(view.wo, wi, alpha, etas[e], true);
                CHECK_NEAR(f, expected, 1e-9 * expected + 1e-14);
            }
        }
}

/* The share of light that facets reflect, by quadrature over the visible facets, and what of it leaves the surface
 * (docs/design/light.md). */
TEST(grazing_light_meets_facets_that_do_not_graze) {
    static const struct {
        double degrees, roughness, share, leaves;
    } rows[] = {{85, 0.3, 0.4161, 0.3402},
                {85, 0.7, 0.1324, 0.1048},
                {85, 1, 0.0885, 0.0611},
                {0, 0.3, 0.0405, 0.0397},
                {0, 0.7, 0.0559, 0.0286}};
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        struct view view = rough_view(rows[r].degrees, rows[r].roughness * rows[r].roughness, 1 / 1.5);
        struct bsdf_branch branches[BSDF_LOBES];
        CHECK_EQ_INT(bsdf_branches(&view.bsdf, branches), 2);
        double reflected = 0, leaving = 0;
        enum { N = 1000 };
        for (int i = 0; i < N * N; i++) {
            struct sample2 u = {(i % N + 0.5) / N, (i / N + 0.5) / N};
            struct bsdf_draw position = bsdf_draw(&view.bsdf, view.wo, u);
            struct vec3 h = position.facet;
            double fresnel = dielectric_fresnel(vec3_dot(view.wo, h), 1 / 1.5);
            double cosine = dielectric_mirror(h, view.wo).z;
            reflected += fresnel / ((double)N * N);
            if (cosine > 0)
                leaving += fresnel * microfacet_escape(view.wo.z, cosine, view.bsdf.alpha) / ((double)N * N);
            for (int b = 0; b < 2 && i % 101 == 0; b++) {
                struct bsdf_branch_direction sample;
                if (!bsdf_branch_sample(&view.bsdf, &branches[b], view.wo, &position, &sample))
                    continue;
                double escape = microfacet_escape(view.wo.z, fabs(sample.direction.z), view.bsdf.alpha);
                CHECK_NEAR(sample.weight.r / escape, sample.transmits ? 1 - fresnel : fresnel, 1e-9);
            }
        }
        CHECK_NEAR(reflected, rows[r].share, 4e-4);
        CHECK_NEAR(leaving, rows[r].leaves, 4e-4);
    }
}

/* f of one lobe, for light that comes from wi, on either side; n is the index below the surface. */
static double f_of(enum lobe_kind kind, bool fresnel, double alpha, double n, struct vec3 wo, struct vec3 wi) {
    struct view view = view_make(0, 0, alpha, wo.z > 0 ? 1 / n : n);
    if (wo.z < 0)
        view.bsdf.geometric_side = view.bsdf.normal = view.bsdf.lit = view.bsdf.side = vec3_make(0, 0, -1);
    view.bsdf.fresnel_of_facets = fresnel;
    add(&view, kind, colour_all(1), 0.7);
    bsdf_facets_see(&view.bsdf.facets[0], wo);
    return bsdf_eval(&view.bsdf, BSDF_ALL, BSDF_RADIANCE, wo, wi).r / fabs(wi.z);
}

/* Highlights of docs/language.md 5.2 have no cosine, so they are not reciprocal (docs/design/light.md); delta lobes
 * have tests of their own. */
TEST(every_lobe_but_classic_highlights_is_reciprocal_with_the_square_of_the_index) {
    for (int kind = 0; kind < LOBE_KINDS; kind++) {
        double sum = 0, n = is_pane((enum lobe_kind)kind) ? 1 : 1.5; /* a thin wall has the same medium on both sides */
        if (lobe_flags((enum lobe_kind)kind) & (BSDF_DELTA | BSDF_EXPONENT))
            continue;
        for (uint32_t k = 0; k < 4000; k++) {
            struct sample2 a = xi_of(21, k), b = xi_of(22, k), c = xi_of(23, k);
            double alpha = 0.1 + 0.9 * c.x;
            struct vec3 wo = direction_at(1 + 87 * a.x, 6.28 * a.y), wi = direction_at(1 + 87 * b.x, 6.28 * b.y);
            bool through = c.y < 0.5, fresnel = k & 1;
            wi.z = through ? -wi.z : wi.z;
            double there = f_of((enum lobe_kind)kind, fresnel, alpha, n, wo, wi);
            double back = f_of((enum lobe_kind)kind, fresnel, alpha, n, wi, wo);
            CHECK_NEAR(there * (through ? n * n : 1), back, 1e-9 * back);
            sum += there;
        }
        if (!(sum > 1))
            test_fail(__FILE__, __LINE__, "lobe %d (%s) gives nothing", kind, lobe_name((enum lobe_kind)kind));
    }
}

TEST(lobes_with_facets_are_drawn_as_often_as_they_are_expected_to_give_light) {
    struct view view = rough_view(20, 0.4, 1 / 1.5);
    int reflected = 0;
    for (uint32_t i = 0; i < 20000; i++) {
        struct bsdf_sample sample;
        if (bsdf_sample(&view.bsdf, BSDF_ALL, BSDF_RADIANCE, view.wo, xi_of(31, i), &sample))
            reflected += sample.flags & BSDF_REFLECTS ? 1 : 0;
    }
    CHECK(reflected > 500 && reflected < 2500); /* a smooth surface reflects a twenty-fifth */
}

/* --- materials --- */

/* Seen from outside (or inside) at an angle to the normal +z. */
static struct hit hit_at(double degrees, bool front) {
    struct hit hit = {.view = direction_at(degrees, 0.3), .front = front, .primitive = 4};
    hit.normal = hit.normal_geometric = vec3_make(0, 0, 1);
    if (!front)
        hit.view.z = -hit.view.z;
    return hit;
}

static struct material glass_of(double ior) {
    struct material base;
    material_derive(&base, MATERIAL_PHONG, NULL);
    base.phong.ks = colour_all(1);
    base.phong.ior = ior;
    base.phong.has_ior = true;
    base.phong.reflect = 0.25;
    base.phong.refract = 0.75;
    return base;
}

TEST(smooth_boundaries_send_light_where_snell_says_with_the_square_of_the_index) {
    const struct material_context tir = {.total_reflection = true};
    struct material glass = glass_of(1.5);
    const struct media media = {&(struct solid){4, 0}, &(struct medium){.ior = 1.5}, 0};
    struct medium_stack inside = {.media = &media};
    medium_stack_enter(&inside, 0);
    for (double degrees = 1; degrees < 90; degrees += 4) {
        for (int front = 0; front < 2; front++) {
            struct hit hit = hit_at(degrees, front);
            struct bsdf bsdf;
            struct bsdf_sample sample;
            struct bsdf_branch branches[BSDF_LOBES];
            surface_eval(&glass, &hit, front ? NULL : &inside, &tir, &bsdf);
            double eta = front ? 1 / 1.5 : 1.5, sine = eta * sin(degrees * pi / 180), up = front ? 1 : -1;
            CHECK_NEAR(bsdf.eta, eta, 1e-15);
            CHECK_EQ_INT(bsdf.transmits, sine < 1);
            CHECK_EQ_INT(bsdf_branches(&bsdf, branches), sine < 1 ? 2 : 1);
            CHECK_NEAR(branches[0].weight.r, sine < 1 ? 0.25 : 1, 0);
            uint32_t mirror = bsdf_lobes_with(&bsdf, BSDF_REFLECTS) & bsdf_lobes_with(&bsdf, BSDF_TRACED);
            CHECK(bsdf_sample(&bsdf, mirror, BSDF_RADIANCE, hit.view, (struct sample2){0, 0}, &sample));
            CHECK(sample.flags == (BSDF_REFLECTS | BSDF_DELTA));
            CHECK_NEAR(sample.direction.z, hit.view.z, 1e-15);
            CHECK_NEAR(sample.direction.x, -hit.view.x, 1e-15);
            CHECK_NEAR(sample.weight.r, 0.25, 0);
            uint32_t refraction = bsdf_lobes_with(&bsdf, BSDF_TRANSMITS);
            CHECK(bsdf_sample(&bsdf, refraction, BSDF_RADIANCE, hit.view, (struct sample2){0, 0}, &sample));
            double cosine = sine < 1 ? sqrt(1 - sine * sine) : -hit.view.z * up;
            /* An error of the sine is divided by the cosine: near the critical angle the cosine has fewer digits. */
            CHECK_NEAR(sample.direction.z * up, -cosine, 1e-15 / fabs(cosine));
            CHECK_NEAR(sample.weight.r, sine < 1 ? 0.75 * eta * eta : 0.75, 1e-15);
            CHECK(bsdf_sample(&bsdf, refraction, BSDF_IMPORTANCE, hit.view, (struct sample2){0, 0}, &sample));
            CHECK_NEAR(sample.weight.r, 0.75, 0);
        }
    }
}

/* Through the boundary and back: the direction and Fresnel's share are the same. The weights are eta^2 times that
 * share, with eta of either way: f / n^2 is the same (Veach 1997, equation 5.14), and a beam is wider in the thin
 * medium by n^2. */
TEST(smooth_refraction_is_reciprocal_with_the_square_of_the_index) {
    struct material base = glass_of(1.5), glass;
    material_derive(&glass, MATERIAL_FRESNEL, &base);
    const struct media media = {&(struct solid){4, 0}, &(struct medium){.ior = 1.5}, 0};
    struct medium_stack inside = {.media = &media};
    medium_stack_enter(&inside, 0);
    for (double degrees = 2; degrees < 88; degrees += 5) {
        struct hit there = hit_at(degrees, true), back = there;
        struct bsdf bsdf;
        struct bsdf_sample in, out;
        struct sample2 u = {0, 0};
        surface_eval(&glass, &there, NULL, NULL, &bsdf);
        CHECK(bsdf_sample(&bsdf, bsdf_lobes_with(&bsdf, BSDF_TRANSMITS), BSDF_RADIANCE, there.view, u, &in));
        double reflected = bsdf.fresnel;
        back.view = in.direction;
        back.front = false;
        surface_eval(&glass, &back, &inside, NULL, &bsdf);
        CHECK(bsdf_sample(&bsdf, bsdf_lobes_with(&bsdf, BSDF_TRANSMITS), BSDF_RADIANCE, back.view, u, &out));
        CHECK_NEAR(vec3_length(vec3_sub(out.direction, there.view)), 0, 1e-12);
        CHECK_NEAR(bsdf.fresnel, reflected, 1e-12);
        CHECK_NEAR(in.weight.r * 1.5 * 1.5, 1 - reflected, 1e-12);
        CHECK_NEAR(out.weight.r / (1.5 * 1.5), 1 - reflected, 1e-12);
    }
}

TEST(what_is_reflected_totally_joins_the_mirror_or_is_lost) {
    struct material glass = glass_of(1.5);
    const struct media media = {&(struct solid){4, 0}, &(struct medium){.ior = 1.5}, 0};
    struct medium_stack inside = {.media = &media};
    medium_stack_enter(&inside, 0);
    struct hit hit = hit_at(60, false);
    for (int rough = 0; rough < 2; rough++) {
        for (int total = 0; total < 2; total++) {
            const struct material_context context = {.total_reflection = total};
            struct bsdf bsdf;
            struct bsdf_branch branches[BSDF_LOBES];
            struct bsdf_sample sample;
            glass.phong.roughness = rough * 0.5;
            surface_eval(&glass, &hit, &inside, &context, &bsdf);
            CHECK(!bsdf.transmits);
            uint32_t refraction = bsdf_lobes_with(&bsdf, BSDF_TRANSMITS);
            CHECK_EQ_INT(bsdf_branches(&bsdf, branches), rough ? 2 : 1);
            CHECK(branches[0].rough == rough);
            CHECK_NEAR(branches[0].weight.g, total && !rough ? 1 : 0.25, 0);
            int back = 0, out = 0;
            for (uint32_t i = 0; i < 1000; i++) {
                if (!bsdf_sample(&bsdf, refraction, BSDF_RADIANCE, hit.view, xi_of(9, i), &sample))
                    continue;
                CHECK((sample.direction.z < 0) == ((sample.flags & BSDF_REFLECTS) != 0));
                *(sample.flags & BSDF_REFLECTS ? &back : &out) += 1;
            }
            /* Some facets of a rough surface are tilted so far that light gets through. */
            CHECK(rough ? out > 50 : out == 0);
            CHECK(total ? back > 500 : back == 0);
        }
    }
}

TEST(every_kind_of_lobe_is_made_by_some_material) {
    int made[LOBE_KINDS] = {0};
    for (int i = 0; i < 64; i++) {
        struct material base = glass_of(1.5), over;
        struct hit hit = hit_at(30, true);
        struct bsdf bsdf;
        base.phong.kd = colour_all(0.5);
        base.phong.shininess = 10;
        base.phong.reflect = i & 1 ? 0.5 : 0;
        base.phong.refract = i & 2 ? 0.5 : 0;
        base.phong.roughness = i & 4 ? 0.5 : 0;
        base.phong.highlight = i & 8 ? HIGHLIGHT_BLINN : HIGHLIGHT_PHONG;
        base.phong.unlit = i & 16;
        material_derive(&over, MATERIAL_FRESNEL, &base);
        surface_eval(i & 32 ? &over : &base, &hit, NULL, NULL, &bsdf);
        for (int k = 0; k < bsdf.count; k++)
            made[bsdf.lobes[k].kind]++;
    }
    for (int i = 0; i < 128; i++) {
        struct openpbr numbers = openpbr_defaults();
        struct material layered = {.kind = MATERIAL_OPENPBR, .depth = 1, .openpbr = &numbers};
        struct hit hit = hit_at(30, true);
        struct bsdf bsdf;
        layered.phong.kd = layered.phong.ks = colour_all(0.5);
        layered.phong.roughness = i & 1 ? 0.5 : 0;
        layered.phong.refract = i & 2 ? 0.5 : 0;
        numbers.thin_walled = i & 4;
        numbers.base_metalness = i & 8 ? 0.5 : 0;
        numbers.base_diffuse_roughness = numbers.fuzz_weight = i & 16 ? 0.5 : 0;
        numbers.film_weight = i & 32 ? 1 : 0;
        numbers.coat_weight = i & 1;
        struct texture flat = texture_constant(colour_make(0.5, 0.5, 1));
        struct bump bump = {.kind = MATERIAL_NORMAL, .height = 1, .texture = &flat, .of_coat = true};
        layered.bump = &bump;
        numbers.subsurface_weight = i & 64 ? 0.5 : 0;
        surface_eval(&layered, &hit, NULL, &(struct material_context){.walks = true}, &bsdf);
        for (int k = 0; k < bsdf.count; k++)
            made[bsdf.lobes[k].kind]++;
    }
    for (int kind = 0; kind < LOBE_KINDS; kind++)
        if (made[kind] == 0)
            test_fail(__FILE__, __LINE__, "no material makes lobe %d (%s)", kind, lobe_name((enum lobe_kind)kind));
}
