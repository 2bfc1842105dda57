/* Gradient noise: each lattice point has one of 16 gradients (the 12 edge directions of a cube, four of them twice),
 * chosen by a permutation of 0..255; the eight corners' ramps are blended by a fade curve without first and second
 * derivative at the corners. Ken Perlin, "Improving Noise", SIGGRAPH 2002; the permutation is the one published with
 * it, since the pictures depend on it.
 *
 * Invariant: only the lattice cell modulo 256 and the place inside the cell matter, and both are exact for every finite
 * double, so huge coordinates need no undefined conversion. */
#include "math/noise.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/random.h"
#include "math/elementary.h"
#include "math/exact.h"

static const double pi = 0x1.921fb54442d18p+1;

static const uint8_t permutation[256] = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,  69,  142,
    8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,  94,  252, 219, 203,
    117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136, 171, 168, 68,  175, 74,  165,
    71,  134, 139, 48,  27,  166, 77,  146, 158, 231, 83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,
    55,  46,  245, 40,  244, 102, 143, 54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,
    18,  169, 200, 196, 135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250,
    124, 123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,  182, 189,
    28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101, 155, 167, 43,  172, 9,
    129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104, 218, 246, 97,  228, 251, 34,
    242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,
    181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114,
    67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180,
};

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
    double turn = fmod(x, 256.0); /* exact; x is an integer */
    *cell = (unsigned)(int)(turn < 0.0 ? turn + 256.0 : turn);
    return 0.0;
}

static inline unsigned hash(unsigned i) {
    return permutation[i & 255];
}

static inline double fade(double t) {
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

/* The 12 edge directions of a cube, four of them twice, in the order of the published program. */
static const double gradients[16][3] = {
    {1, 1, 0}, {-1, 1, 0}, {1, -1, 0}, {-1, -1, 0}, {1, 0, 1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1},
    {0, 1, 1}, {0, -1, 1}, {0, 1, -1}, {0, -1, -1}, {1, 1, 0}, {0, -1, 1}, {-1, 1, 0}, {0, -1, -1},
};

/* The gradient times the offset. Products with 1 and 0 are exact, so this equals the reference's selection of signed
 * summands without its unpredictable branches. */
static inline double ramp(unsigned h, double x, double y, double z) {
    const double *g = gradients[h & 15];
    return g[0] * x + g[1] * y + g[2] * z;
}

static inline double mix(double weight, double a, double b) {
    return a + weight * (b - a);
}

static double cosine_weight(double t) {
    return (1.0 - el_cos(pi * t)) / 2.0;
}

double noise_cosine_mix(double t, double a, double b) {
    return mix(cosine_weight(t), a, b);
}

double noise_perlin(double x, double y, double z, int interpolation) {
    if (!isfinite(x) || !isfinite(y) || !isfinite(z))
        return 0.0;
    unsigned i, j, k;
    x = cell_of(x, &i);
    y = cell_of(y, &j);
    z = cell_of(z, &k);
    double u = fade(x), v = fade(y), w = fade(z);
    if (interpolation != 0) {
        /* The blend differs from the linear one only in its weight. */
        u = cosine_weight(u);
        v = cosine_weight(v);
        w = cosine_weight(w);
    }
    unsigned a = hash(i) + j, aa = hash(a) + k, ab = hash(a + 1) + k;
    unsigned b = hash(i + 1) + j, ba = hash(b) + k, bb = hash(b + 1) + k;
    double near_low = mix(u, ramp(hash(aa), x, y, z), ramp(hash(ba), x - 1, y, z));
    double near_high = mix(u, ramp(hash(ab), x, y - 1, z), ramp(hash(bb), x - 1, y - 1, z));
    double far_low = mix(u, ramp(hash(aa + 1), x, y, z - 1), ramp(hash(ba + 1), x - 1, y, z - 1));
    double far_high = mix(u, ramp(hash(ab + 1), x, y - 1, z - 1), ramp(hash(bb + 1), x - 1, y - 1, z - 1));
    return mix(w, mix(v, near_low, near_high), mix(v, far_low, far_high));
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
        weights[1][k] = fade(p[k]);
        weights[0][k] = 1 - weights[1][k];
        slope[k] = 30 * p[k] * p[k] * ((p[k] - 1) * (p[k] - 1));
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

static uint64_t hash_of_point(double x, double y, double z) {
    return random_combine(random_combine(to_bits(x + 0.0), to_bits(y + 0.0)), to_bits(z + 0.0));
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
