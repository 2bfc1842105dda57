/* Gradient noise: each lattice point has one of 16 gradients (the 12 edge directions of a cube, four of them twice),
 * chosen by a permutation of 0..255; the eight corners' ramps are blended by a fade curve without first and second
 * derivative at the corners. Ken Perlin, "Improving Noise", SIGGRAPH 2002; the permutation is the one published with
 * it, since the pictures depend on it.
 *
 * Invariant: only the lattice cell modulo 256 and the place inside the cell matter, and both are exact for every finite
 * double, so huge coordinates need no undefined conversion. */
#include "math/noise.h"

#include <math.h>
#include <stdint.h>

#include "base/random.h"
#include "math/elementary.h"
#include "math/exact.h"
#include "math/noise_lanes.h"
#include "math/portable.h"

static const double pi = 0x1.921fb54442d18p+1;

/* clang-format off */
#define PERMUTATION(X)                                                                                                \
    X(151) X(160) X(137) X(91) X(90) X(15) X(131) X(13) X(201) X(95) X(96) X(53) X(194) X(233) X(7) X(225)             \
    X(140) X(36) X(103) X(30) X(69) X(142) X(8) X(99) X(37) X(240) X(21) X(10) X(23) X(190) X(6) X(148)                \
    X(247) X(120) X(234) X(75) X(0) X(26) X(197) X(62) X(94) X(252) X(219) X(203) X(117) X(35) X(11) X(32)             \
    X(57) X(177) X(33) X(88) X(237) X(149) X(56) X(87) X(174) X(20) X(125) X(136) X(171) X(168) X(68) X(175)           \
    X(74) X(165) X(71) X(134) X(139) X(48) X(27) X(166) X(77) X(146) X(158) X(231) X(83) X(111) X(229) X(122)          \
    X(60) X(211) X(133) X(230) X(220) X(105) X(92) X(41) X(55) X(46) X(245) X(40) X(244) X(102) X(143) X(54)           \
    X(65) X(25) X(63) X(161) X(1) X(216) X(80) X(73) X(209) X(76) X(132) X(187) X(208) X(89) X(18) X(169)              \
    X(200) X(196) X(135) X(130) X(116) X(188) X(159) X(86) X(164) X(100) X(109) X(198) X(173) X(186) X(3) X(64)        \
    X(52) X(217) X(226) X(250) X(124) X(123) X(5) X(202) X(38) X(147) X(118) X(126) X(255) X(82) X(85) X(212)          \
    X(207) X(206) X(59) X(227) X(47) X(16) X(58) X(17) X(182) X(189) X(28) X(42) X(223) X(183) X(170) X(213)           \
    X(119) X(248) X(152) X(2) X(44) X(154) X(163) X(70) X(221) X(153) X(101) X(155) X(167) X(43) X(172) X(9)           \
    X(129) X(22) X(39) X(253) X(19) X(98) X(108) X(110) X(79) X(113) X(224) X(232) X(178) X(185) X(112) X(104)         \
    X(218) X(246) X(97) X(228) X(251) X(34) X(242) X(193) X(238) X(210) X(144) X(12) X(191) X(179) X(162) X(241)       \
    X(81) X(51) X(145) X(235) X(249) X(14) X(239) X(107) X(49) X(192) X(214) X(31) X(181) X(199) X(106) X(157)         \
    X(184) X(84) X(204) X(176) X(115) X(121) X(50) X(45) X(127) X(4) X(150) X(254) X(138) X(236) X(205) X(93)          \
    X(222) X(114) X(67) X(29) X(24) X(72) X(243) X(141) X(128) X(195) X(78) X(66) X(215) X(61) X(156) X(180)
/* clang-format on */
#define BYTE(n) n,
const uint8_t noise_permutation_bytes[264] = {PERMUTATION(BYTE) 151, 160, 137, 91, 90, 15, 131, 13};

/* The cell modulo 256 and the place in it. */
static inline double cell_of(double x, unsigned *cell) {
    if (fabs(x) < 0x1.0p62) {
        int64_t whole = (int64_t)x; /* towards zero; one more step down for negative fractions */
        if ((double)whole > x) {
            whole--;
        }
        *cell = (unsigned)(whole & 255);
        return x - (double)whole;
    }
    double turn = math_fmod(x, 256.0); /* exact; x is an integer */
    *cell = (unsigned)(int)(turn < 0.0 ? turn + 256.0 : turn);
    return 0.0;
}

static inline unsigned hash(unsigned i) {
    return noise_permutation_bytes[i & 255];
}

/* The 12 edge directions of a cube, four of them twice, in the order of the published program. */
static const double gradients[16][3] = {
    {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
    {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1},
};

/* The upper 12 bits of a coordinate (0, 1 or -1) as a double, from the directions where it is not 0 or negative. */
#define COORDINATE(n, there, negative)                                                                                 \
    (((uint64_t)(there) >> ((n)&15) & 1) * 0x3ff | ((uint64_t)(negative) >> ((n)&15) & 1) * 0x800)
#define WORD(n)                                                                                                        \
    COORDINATE(n, 0x50ff, 0x40aa) << 52 | COORDINATE(n, 0xff0f, 0xaa0c) << 40 | COORDINATE(n, 0xaff0, 0x8cc0) << 28,
#define HALF_WORD(n)                                                                                                   \
    (uint32_t)(COORDINATE(n, 0x50ff, 0x40aa) << 20 | COORDINATE(n, 0xff0f, 0xaa0c) << 8 |                              \
               COORDINATE(n, 0xaff0, 0x8cc0) >> 4),
const uint32_t noise_gradient_words[257] = {PERMUTATION(HALF_WORD) HALF_WORD(151)};
const uint64_t noise_directions[16] = {WORD(0) WORD(1) WORD(2) WORD(3) WORD(4) WORD(5) WORD(6) WORD(7) WORD(8) WORD(9)
                                           WORD(10) WORD(11) WORD(12) WORD(13) WORD(14) WORD(15)};

/* The gradient times the offset. Products with 1 and 0 are exact, so this equals the reference's selection of signed
 * summands without its unpredictable branches. */
static inline double ramp(unsigned h, double x, double y, double z) {
    const double *g = gradients[h & 15];
    return g[0] * x + g[1] * y + g[2] * z;
}

static double cosine_weight(double t) {
    return (1.0 - el_cos(pi * t)) / 2.0;
}

double noise_cosine_mix(double t, double a, double b) {
    return noise_mix(cosine_weight(t), a, b);
}

double noise_perlin(double x, double y, double z, int interpolation) {
    if (!isfinite(x) || !isfinite(y) || !isfinite(z))
        return 0.0;
    unsigned i, j, k;
    x = cell_of(x, &i);
    y = cell_of(y, &j);
    z = cell_of(z, &k);
    double u = noise_fade(x), v = noise_fade(y), w = noise_fade(z);
    if (interpolation != 0) {
        /* The blend differs from the linear one only in its weight. */
        u = cosine_weight(u);
        v = cosine_weight(v);
        w = cosine_weight(w);
    }
    unsigned a = hash(i) + j, aa = hash(a) + k, ab = hash(a + 1) + k;
    unsigned b = hash(i + 1) + j, ba = hash(b) + k, bb = hash(b + 1) + k;
    double near_low = noise_mix(u, ramp(hash(aa), x, y, z), ramp(hash(ba), x - 1, y, z));
    double near_high = noise_mix(u, ramp(hash(ab), x, y - 1, z), ramp(hash(bb), x - 1, y - 1, z));
    double far_low = noise_mix(u, ramp(hash(aa + 1), x, y, z - 1), ramp(hash(ba + 1), x - 1, y, z - 1));
    double far_high = noise_mix(u, ramp(hash(ab + 1), x, y - 1, z - 1), ramp(hash(bb + 1), x - 1, y - 1, z - 1));
    return noise_mix(w, noise_mix(v, near_low, near_high), noise_mix(v, far_low, far_high));
}

static inline double fade_slope(double t) {
    return 30 * t * t * ((t - 1) * (t - 1));
}

/* The sum over the corners of weight * ramp, by the product rule. */
void noise_perlin_gradient(double x, double y, double z, double gradient[3]) {
    double p[3] = {x, y, z}, weights[2][3], slope[3];
    unsigned cell[3];
    gradient[0] = gradient[1] = gradient[2] = 0;
    if (!isfinite(x) || !isfinite(y) || !isfinite(z))
        return;
    for (int k = 0; k < 3; k++) {
        p[k] = cell_of(p[k], &cell[k]);
        weights[1][k] = noise_fade(p[k]);
        weights[0][k] = 1 - weights[1][k];
        slope[k] = fade_slope(p[k]);
    }
    for (unsigned corner = 0; corner < 8; corner++) {
        unsigned far[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
        unsigned h = hash(hash(hash(cell[0] + far[0]) + cell[1] + far[1]) + cell[2] + far[2]);
        double w[3], height = ramp(h, p[0] - far[0], p[1] - far[1], p[2] - far[2]);
        for (int k = 0; k < 3; k++)
            w[k] = weights[far[k]][k];
        for (int k = 0; k < 3; k++) {
            double others = w[(k + 1) % 3] * w[(k + 2) % 3];
            gradient[k] += others * (w[k] * gradients[h & 15][k] + (far[k] ? slope[k] : -slope[k]) * height);
        }
    }
}

/* A number and its gradient. */
struct blend {
    double value, slopes[3];
};

static inline struct blend blend_ramp(unsigned h, double x, double y, double z) {
    const double *g = gradients[h & 15];
    return (struct blend){ramp(h, x, y, z), {g[0], g[1], g[2]}};
}

/* slope: of the weight, along the axis. */
static inline struct blend blend_mix(int axis, double weight, double slope, struct blend a, struct blend b) {
    struct blend out = {noise_mix(weight, a.value, b.value), {0, 0, 0}};
    for (int k = 0; k < 3; k++)
        out.slopes[k] = noise_mix(weight, a.slopes[k], b.slopes[k]);
    out.slopes[axis] += slope * (b.value - a.value);
    return out;
}

/* noise_perlin with the gradient of each blend. */
double noise_perlin_with_gradient(double x, double y, double z, double gradient[3]) {
    unsigned i, j, k;
    gradient[0] = gradient[1] = gradient[2] = 0;
    if (!isfinite(x) || !isfinite(y) || !isfinite(z))
        return 0;
    x = cell_of(x, &i);
    y = cell_of(y, &j);
    z = cell_of(z, &k);
    double u = noise_fade(x), v = noise_fade(y), w = noise_fade(z), du = fade_slope(x), dv = fade_slope(y);
    unsigned a = hash(i) + j, aa = hash(a) + k, ab = hash(a + 1) + k;
    unsigned b = hash(i + 1) + j, ba = hash(b) + k, bb = hash(b + 1) + k;
    struct blend low[2], high[2], sides[2];
    for (unsigned far = 0; far < 2; far++) {
        double d = z - far;
        low[far] = blend_mix(0, u, du, blend_ramp(hash(aa + far), x, y, d), blend_ramp(hash(ba + far), x - 1, y, d));
        high[far] =
            blend_mix(0, u, du, blend_ramp(hash(ab + far), x, y - 1, d), blend_ramp(hash(bb + far), x - 1, y - 1, d));
        sides[far] = blend_mix(1, v, dv, low[far], high[far]);
    }
    struct blend all = blend_mix(2, w, fade_slope(z), sides[0], sides[1]);
    for (int axis = 0; axis < 3; axis++)
        gradient[axis] = all.slopes[axis];
    return all.value;
}

/* Rounding may exceed [0, 1] by a last bit, and NaN is outside. */
static double share(double ratio) {
    if (!(ratio < 1.0))
        return 1.0;
    return ratio > 0.0 ? ratio : 0.0;
}

double noise_wood(double x, double y, double z, double factor, double density, int interpolation) {
    double t = density * noise_perlin(factor * x, factor * y, factor * z, interpolation);
    t -= floor(t);
    return share(noise_cosine_mix(0.5 + 0.5 * t, 0.0, 1.0));
}

double noise_marble(struct vec3 p, double factor, double multiplier, double vein_frequency, int interpolation) {
    double sum = 0.0, scale = 1.0;
    for (int octave = 0; octave < 4; octave++) {
        double f = factor * scale;
        sum += noise_perlin(f * p.x, f * p.y, f * p.z, interpolation) / scale;
        scale *= 4.0;
    }
    double vein = el_cos(vein_frequency * p.y + multiplier * sum);
    return share(noise_cosine_mix((1.0 + vein) / 2.0, 0.0, 1.0));
}

/* --- points in cells --- */

/* Equal numbers have equal bits: -0 those of 0, and every NaN those of one. */
static uint64_t bits_of_number(double x) {
    return isnan(x) ? UINT64_C(0x7ff8000000000000) : to_bits(x + 0.0);
}

static uint64_t hash_of_point(double x, double y, double z) {
    return random_combine(random_combine(bits_of_number(x), bits_of_number(y)), bits_of_number(z));
}

double noise_hash(double x, double y, double z) {
    return random_unit(hash_of_point(x, y, z));
}

/* The squared distance from a position in a cell (0 to 1) to the cell that is `step` cells further. */
static double gap(double position, int step) {
    double d = step > 0 ? step - position : step < 0 ? position - (step + 1) : 0;
    return d * d;
}

/* A point, as seen from the place. */
struct cell_point {
    double square, offset[3];
    uint64_t key;
};

/* The nearest two points, if the place is finite. The second nearest point is nearer than 2: one cell of the neighbours
 * touches the place or is within 1/2 of it, and the far corner of both is at most sqrt(3) away. So cells two steps
 * further suffice, and most of these are skipped. */
static inline void search_cells(double x, double y, double z, struct cell_point *nearest, struct cell_point *next) {
    static const int steps[5] = {0, -1, 1, -2, 2};
    double cx = floor(x), cy = floor(y), cz = floor(z), px = x - cx, py = y - cy, pz = z - cz;
    nearest->square = next->square = INFINITY;
    for (int i = 0; i < 5; i++) {
        for (int j = 0; j < 5; j++) {
            /* Cells that are farther away than the second point are not looked at. */
            double across = gap(px, steps[i]) + gap(py, steps[j]);
            for (int k = 0; k < 5 && across < next->square; k++) {
                if (across + gap(pz, steps[k]) >= next->square)
                    continue;
                uint64_t key = hash_of_point(cx + steps[i], cy + steps[j], cz + steps[k]);
                double dx = steps[i] + random_unit(random_combine(key, 0)) - px;
                double dy = steps[j] + random_unit(random_combine(key, 1)) - py;
                double dz = steps[k] + random_unit(random_combine(key, 2)) - pz;
                double distance = dx * dx + dy * dy + dz * dz;
                if (distance < nearest->square) {
                    *next = *nearest;
                    *nearest = (struct cell_point){distance, {dx, dy, dz}, key};
                } else if (distance < next->square) {
                    *next = (struct cell_point){distance, {dx, dy, dz}, key};
                }
            }
        }
    }
}

struct noise_cells noise_cells(double x, double y, double z) {
    struct cell_point nearest = {.key = 0}, second = {.key = 0};
    if (!isfinite(x) || !isfinite(y) || !isfinite(z))
        return (struct noise_cells){0, 0, 0};
    search_cells(x, y, z, &nearest, &second);
    return (struct noise_cells){sqrt(nearest.square), sqrt(second.square), random_unit(random_combine(nearest.key, 3))};
}

void noise_cells_gradients(double x, double y, double z, double nearest[3], double second[3]) {
    struct cell_point points[2] = {{.square = 0}, {.square = 0}};
    if (isfinite(x) && isfinite(y) && isfinite(z))
        search_cells(x, y, z, &points[0], &points[1]);
    for (int k = 0; k < 3; k++) {
        nearest[k] = points[0].square > 0 ? -points[0].offset[k] / sqrt(points[0].square) : 0;
        second[k] = points[1].square > 0 ? -points[1].offset[k] / sqrt(points[1].square) : 0;
    }
}
