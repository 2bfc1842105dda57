/* Writes src/material/albedo_tables_internal.h: what rough surfaces send on after one facet, and what fuzz reflects, of
 * light from one direction.
 *
 *     cc -O2 tools/albedo_tables.c -lm -o build/albedo_tables && build/albedo_tables
 * >src/material/albedo_tables_internal.h
 *
 * Facets: the distribution of Trowbridge and Reitz with the masking of both directions together, summed over the
 * normals that are visible (Heitz, "Sampling the GGX Distribution of Visible Normals", JCGT 2018). Points of the unit
 * disc lie dense at its rim, where the steep facets are. Fuzz: Estevez and Kulla, "Production Friendly Microfacet Sheen
 * BRDF", SIGGRAPH 2017 courses, with the visibility of Neubelt and Pettineo, "Crafting a Next-Gen Material Pipeline for
 * The Order: 1886", 2013; a closed sum over the hemisphere. tests/unit/material/test_openpbr.c does the sums again. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>

enum { COSINES = 17, ROUGHNESSES = 24, INDICES = 8, POINTS = 128 };
static const double pi = 3.14159265358979323846;

static double fresnel(double cosine, double eta) {
    double sine2 = eta * eta * (1 - cosine * cosine);
    if (sine2 >= 1)
        return 1;
    double other = sqrt(1 - sine2);
    double s = (eta * cosine - other) / (eta * cosine + other), p = (cosine - eta * other) / (cosine + eta * other);
    return (s * s + p * p) / 2;
}

static double lambda(double cosine, double alpha) {
    return (sqrt(1 + alpha * alpha * (1 - cosine * cosine) / (cosine * cosine)) - 1) / 2;
}

struct shares {
    double reflected, transmitted; /* with Fresnel's shares of each facet */
    double mirrored;               /* by facets that reflect all */
};

static struct shares facets(double mu, double alpha, double eta) {
    struct shares sum = {0, 0, 0};
    double across = sqrt(1 - mu * mu), vx = alpha * across, length = sqrt(vx * vx + mu * mu), vz = mu / length;
    double seen = 1 + lambda(mu, alpha), all = 0;
    vx /= length;
    if (alpha == 0) {
        sum.reflected = fresnel(mu, eta);
        return (struct shares){sum.reflected, 1 - sum.reflected, 1};
    }
    for (int i = 0; i < POINTS; i++) {
        double p = (i + 0.5) / POINTS, q = p * p, weight = p * p * p, r = sqrt(1 - q * q);
        for (int j = 0; j < POINTS; j++) {
            double turn = 2 * pi * (j + 0.5) / POINTS, x = r * cos(turn), s = (1 + vz) / 2;
            double y = (1 - s) * sqrt(1 - x * x) + s * r * sin(turn), z = sqrt(fmax(0, 1 - x * x - y * y));
            double hx = alpha * (vx * z - vz * y), hy = alpha * x, hz = fmax(0, vx * y + vz * z);
            double size = sqrt(hx * hx + hy * hy + hz * hz), towards = (across * hx + mu * hz) / size;
            all += weight;
            hz /= size;
            if (!(towards > 0))
                continue;
            double share = fresnel(towards, eta), out = 2 * towards * hz - mu,
                   sine2 = eta * eta * (1 - towards * towards);
            if (out > 0) {
                double escape = weight * seen / (seen + lambda(out, alpha));
                sum.mirrored += escape;
                sum.reflected += escape * share;
            }
            out = sine2 < 1 ? eta * mu - (eta * towards - sqrt(1 - sine2)) * hz : 0;
            if (out > 0)
                sum.transmitted += weight * (1 - share) * seen / (seen + lambda(fmin(out, 1), alpha));
        }
    }
    return (struct shares){sum.reflected / all, sum.transmitted / all, sum.mirrored / all};
}

/* --- facets of two widths --- */

static double stretched_lambda(const double v[3], double along, double across) {
    double x = along * v[0], y = across * v[1];
    return (sqrt(1 + (x * x + y * y) / (v[2] * v[2])) - 1) / 2;
}

/* Of facets that reflect all: the share that does not leave after one facet, for an azimuth to the wide direction. */
static double stretched_lack(double mu, double azimuth, double along, double across) {
    double side = sqrt(1 - mu * mu), view[3] = {side * cos(azimuth), side * sin(azimuth), mu};
    double v[3] = {along * view[0], across * view[1], mu}, length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    double across_view = sqrt(v[0] * v[0] + v[1] * v[1]),
           t[2] = {across_view > 0 ? -v[1] / across_view : 1, across_view > 0 ? v[0] / across_view : 0};
    double up[3] = {-v[2] * t[1], v[2] * t[0], v[0] * t[1] - v[1] * t[0]}, s = (1 + v[2]) / 2;
    double seen = 1 + stretched_lambda(view, along, across), sum = 0, all = 0;
    for (int i = 0; i < POINTS; i++) {
        double p = (i + 0.5) / POINTS, q = p * p, weight = p * p * p, r = sqrt(1 - q * q);
        for (int j = 0; j < POINTS; j++) {
            double turn = 2 * pi * (j + 0.5) / POINTS, x = r * cos(turn);
            double y = (1 - s) * sqrt(1 - x * x) + s * r * sin(turn), z = sqrt(fmax(0, 1 - x * x - y * y));
            double h[3] = {along * (t[0] * x + up[0] * y + v[0] * z), across * (t[1] * x + up[1] * y + v[1] * z),
                           fmax(0, up[2] * y + v[2] * z)};
            double size = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
            double towards = (view[0] * h[0] + view[1] * h[1] + view[2] * h[2]) / size, out[3];
            for (int k = 0; k < 3; k++)
                out[k] = 2 * towards * h[k] / size - view[k];
            all += weight;
            if (towards > 0 && out[2] > 0)
                sum += weight * seen / (seen + stretched_lambda(out, along, across));
        }
    }
    return 1 - sum / all;
}

enum { STRETCH_WIDTHS = 12, STRETCHES = 7, STRETCH_WAVES = 4, STRETCH_COSINES = 13, AZIMUTHS = 8 };

/* The lack relative to that of facets of one width with the same mean square: as a series of cosines of multiples of
 * twice the azimuth, and in the mean over directions with the cosine. */
struct stretched {
    double wave[STRETCH_COSINES][STRETCH_WAVES], mean;
};

static void stretched_make(double along, double across, struct stretched *out) {
    enum { N = 24 };
    double round = sqrt((along * along + across * across) / 2), mean = 0, round_mean = 0;
    for (int m = 0; m < STRETCH_COSINES; m++) {
        double x = (double)m / (STRETCH_COSINES - 1), mu = m > 0 ? x * x : 1e-4;
        double reference = stretched_lack(mu, 0, round, round);
        for (int w = 0; w < STRETCH_WAVES; w++)
            out->wave[m][w] = 0;
        for (int k = 0; k < AZIMUTHS; k++) {
            double azimuth = (k + 0.5) * pi / 2 / AZIMUTHS, lack = stretched_lack(mu, azimuth, along, across);
            for (int w = 0; w < STRETCH_WAVES; w++)
                out->wave[m][w] += lack / reference * cos(2 * w * azimuth) * (w > 0 ? 2.0 : 1.0) / AZIMUTHS;
        }
    }
    for (int i = 0; i < N; i++) {
        double mu = (i + 0.5) / N;
        round_mean += mu * stretched_lack(mu, 0, round, round);
        for (int k = 0; k < AZIMUTHS; k++)
            mean += mu * stretched_lack(mu, (k + 0.5) * pi / 2 / AZIMUTHS, along, across) / AZIMUTHS;
    }
    out->mean = mean / round_mean;
}

static void print_stretched(void) {
    static struct stretched all[STRETCH_WIDTHS][STRETCHES];
    for (int q = 1; q < STRETCH_WIDTHS; q++)
        for (int s = 0; s < STRETCHES; s++) {
            double along = (double)q * q / (STRETCH_WIDTHS - 1) / (STRETCH_WIDTHS - 1);
            stretched_make(along, fmax(along * s / (STRETCHES - 1), 1e-6), &all[q][s]);
        }
    for (int s = 0; s < STRETCHES; s++) {
        all[0][s].mean = 2 * all[1][s].mean - all[2][s].mean;
        for (int m = 0; m < STRETCH_COSINES; m++)
            for (int w = 0; w < STRETCH_WAVES; w++)
                all[0][s].wave[m][w] = 2 * all[1][s].wave[m][w] - all[2][s].wave[m][w];
    }
    printf(
        "\n/* Facets of two widths: what stays after one facet, relative to facets of one width with the same mean "
        "square; units\n * of 1 / 8192. By the square root of the larger width, the ratio of the widths, and multiples "
        "of twice the azimuth. */\n"
        "enum { STRETCH_WIDTHS = %d, STRETCHES = %d, STRETCH_WAVES = %d, STRETCH_COSINES = %d };\n"
        "static const int16_t stretch_table[STRETCH_WIDTHS][STRETCHES][STRETCH_WAVES][STRETCH_COSINES] = {\n",
        STRETCH_WIDTHS, STRETCHES, STRETCH_WAVES, STRETCH_COSINES);
    for (int q = 0; q < STRETCH_WIDTHS; q++) {
        printf("{\n");
        for (int s = 0; s < STRETCHES; s++) {
            printf("{");
            for (int w = 0; w < STRETCH_WAVES; w++)
                for (int m = 0; m < STRETCH_COSINES; m++)
                    printf("%s%ld%s", m == 0 ? "{" : "", lround(8192 * all[q][s].wave[m][w]),
                           m + 1 < STRETCH_COSINES ? ", "
                           : w + 1 < STRETCH_WAVES ? "},\n"
                                                   : "}");
            printf("},\n");
        }
        printf("},\n");
    }
    printf("};\nstatic const int16_t stretch_average_table[STRETCH_WIDTHS][STRETCHES] = {\n");
    for (int q = 0; q < STRETCH_WIDTHS; q++)
        for (int s = 0; s < STRETCHES; s++)
            printf("%s%ld%s", s == 0 ? "{" : "", lround(8192 * all[q][s].mean), s + 1 < STRETCHES ? ", " : "},\n");
    printf("};\n");
}

/* Nodes of the tables. eta = index on the side of the direction / index behind: from inside, half of the nodes are
 * beyond the angle of total reflection, and they are dense on both sides of it. */
static double cosine_of(int i, double eta) {
    double x = (double)i / (COSINES - 1), critical = eta > 1 ? sqrt(1 - 1 / (eta * eta)) : 0, t = 1 - 2 * x;
    if (eta <= 1)
        return i > 0 ? x * x : 1e-4;
    if (x >= 0.5)
        return fmin(critical + t * t * (1 - critical), 1);
    return fmax(critical * (t < 0.5 ? 1 - 2 * t * t : 2 * (1 - t) * (1 - t)), 1e-4);
}
static double alpha_of(int i) {
    double roughness = (double)i / (ROUGHNESSES - 1);
    return roughness * roughness;
}
static double index_of(int i) {
    double x = (double)i / (INDICES - 1), s = x * x / 2;
    return (1 + s) / (1 - s);
}

/* Of fuzz of the width alpha. */
static double fuzz(double mu, double alpha) {
    enum { N = 400 };
    double sum = 0, across = sqrt(1 - mu * mu), exponent = 1 / alpha;
    for (int i = 0; i < N; i++) {
        double q = (i + 0.5) / N, out = q * q, side = sqrt(1 - out * out); /* dense where it is grazing */
        for (int j = 0; j < N; j++) {
            double turn = pi * (j + 0.5) / N, hx = across + side * cos(turn), hy = side * sin(turn), hz = mu + out;
            double sine2 = (hx * hx + hy * hy) / (hx * hx + hy * hy + hz * hz);
            double d = (2 + exponent) * pow(sine2, exponent / 2) / (2 * pi);
            sum += 2 * q * d / (4 * (out + mu - out * mu)) * out;
        }
    }
    return sum * 2 * pi / ((double)N * N);
}
static double fuzz_alpha(int i) {
    double roughness = (double)i / (ROUGHNESSES - 1);
    return 0.25 + 0.75 * roughness;
}

static void print_row(const double *values, int count, const char *end) {
    for (int i = 0; i < count; i++)
        printf("%s%.0f%s", i == 0 ? "{" : "", 65535 * fmin(values[i], 1), i + 1 < count ? ", " : "}");
    printf("%s", end);
}

/* The mean over directions with the cosine, by a sum that is finer than the table. */
static double average(double alpha, double eta, bool mirrored) {
    enum { N = 48 };
    double sum = 0, all = 0;
    for (int i = 0; i < N; i++) {
        double mu = (i + 0.5) / N;
        struct shares shares = facets(mu, alpha, eta);
        sum += mu * (mirrored ? shares.mirrored : shares.reflected + shares.transmitted);
        all += mu;
    }
    return sum / all;
}

int main(void) {
    static const char *const sides[] = {"outside", "inside"};
    double row[COSINES > ROUGHNESSES ? COSINES : ROUGHNESSES], greatest = 0;
    printf("/* Generated by tools/albedo_tables.c, which documents them; units of 1 / 65535. */\n"
           "#ifndef GRAY_MATERIAL_ALBEDO_TABLES_INTERNAL_H\n#define GRAY_MATERIAL_ALBEDO_TABLES_INTERNAL_H\n\n#include "
           "<stdint.h>\n\n"
           "enum { ALBEDO_COSINES = %d, ALBEDO_ROUGHNESSES = %d, ALBEDO_INDICES = %d };\n\n",
           COSINES, ROUGHNESSES, INDICES);
    printf("/* clang-format off */\n/* Facets that reflect all. */\n"
           "static const uint16_t mirror_table[ALBEDO_ROUGHNESSES][ALBEDO_COSINES] = {\n");
    for (int r = 0; r < ROUGHNESSES; r++) {
        for (int m = 0; m < COSINES; m++)
            row[m] = facets(cosine_of(m, 1), alpha_of(r), 1).mirrored;
        print_row(row, COSINES, ",\n");
    }
    for (int r = 0; r < ROUGHNESSES; r++)
        row[r] = average(alpha_of(r), 1, true);
    printf("};\nstatic const uint16_t mirror_average_table[ALBEDO_ROUGHNESSES] =\n");
    print_row(row, ROUGHNESSES, ";\n");
    for (int what = 0; what < 2; what++) {
        printf("\n/* Of a boundary, seen from outside and from inside: %s. */\n"
               "static const uint16_t %s_table[2][ALBEDO_INDICES][ALBEDO_ROUGHNESSES][ALBEDO_COSINES] = {\n",
               what == 0 ? "what is reflected; from outside (1 + r - s) / 2 for the shares r and s\n"
                           " * that a rough and a smooth boundary reflect"
                         : "what is reflected or transmitted",
               what == 0 ? "reflection" : "boundary");
        for (int side = 0; side < 2; side++) {
            printf("{ /* %s */\n", sides[side]);
            for (int k = 0; k < INDICES; k++) {
                printf("{\n");
                for (int r = 0; r < ROUGHNESSES; r++) {
                    for (int m = 0; m < COSINES; m++) {
                        double eta = side == 0 ? 1 / index_of(k) : index_of(k), cosine = cosine_of(m, eta);
                        struct shares shares = facets(cosine, alpha_of(r), eta);
                        row[m] = shares.reflected + (what == 0 ? 0 : shares.transmitted);
                        if (what == 0 && side == 0)
                            row[m] = (1 + shares.reflected - fresnel(cosine, eta)) / 2;
                    }
                    print_row(row, COSINES, ",\n");
                }
                printf("},\n");
            }
            printf("},\n");
        }
        printf("};\n");
    }
    printf("static const uint16_t boundary_average_table[2][ALBEDO_INDICES][ALBEDO_ROUGHNESSES] = {\n");
    for (int side = 0; side < 2; side++) {
        printf("{\n");
        for (int k = 0; k < INDICES; k++) {
            for (int r = 0; r < ROUGHNESSES; r++)
                row[r] = average(alpha_of(r), side == 0 ? 1 / index_of(k) : index_of(k), false);
            print_row(row, ROUGHNESSES, ",\n");
        }
        printf("},\n");
    }
    printf("};\n\n/* Fuzz. */\nstatic const uint16_t fuzz_table[ALBEDO_ROUGHNESSES][ALBEDO_COSINES] = {\n");
    for (int r = 0; r < ROUGHNESSES; r++) {
        for (int m = 0; m < COSINES; m++) {
            row[m] = fuzz(cosine_of(m, 1), fuzz_alpha(r));
            greatest = fmax(greatest, row[m]);
        }
        print_row(row, COSINES, ",\n");
    }
    printf("};\n");
    print_stretched();
    printf("/* clang-format on */\n\n#endif\n");
    fprintf(stderr, "fuzz reflects %.4f at most\n", greatest);
    return 0;
}
