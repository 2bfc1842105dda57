/* Writes src/material/subsurface_table_internal.h: the single-scattering albedo under a surface that shows a colour.
 *
 *     cc -O2 -ffp-contract=off tools/subsurface_table.c -lm -o build/subsurface_table && build/subsurface_table \
 *         >src/material/subsurface_table_internal.h && clang-format -i src/material/subsurface_table_internal.h
 *
 * Under the surface is a half space of a medium that scatters by Henyey and Greenstein's function, with the same index
 * on both sides of the surface. Adding and doubling (van de Hulst, "A New Look at Multiple Scattering", 1963; Hansen
 * and Travis, "Light scattering in planetary atmospheres", 1974): the reflection and transmission of a layer that is
 * so thin that light is scattered once, doubled until nothing passes. Directions are Gauss's points of a hemisphere;
 * the mean over azimuths is all that light from every side needs. For each colour and mean cosine g the albedo is
 * found by secants. The table has s = sqrt((1 - albedo) / (1 - albedo g)), which is nearly a function of the colour
 * alone. tests/unit/material/test_subsurface.c solves some half spaces in other ways. */
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { POINTS = 48, COLOURS = 33, COSINES = 20, ORDERS = 2 * POINTS };
static const double max_cosine = 0.95;

static double points[POINTS], weights[POINTS];               /* of cosines in (0, 1) */
static double legendre[ORDERS][POINTS];                      /* P_l of the points */
static double forward[POINTS][POINTS], back[POINTS][POINTS]; /* the phase function, times the weight of the column */

/* Gauss's points by Newton's method on the Legendre polynomial of that order. */
static void make_points(void) {
    for (int i = 0; i < POINTS; i++) {
        double x = cos(3.14159265358979323846 * (i + 0.75) / (POINTS + 0.5)), slope = 1;
        for (int turn = 0; turn < 60; turn++) {
            double p = 1, below = 0;
            for (int l = 0; l < POINTS; l++) {
                double next = ((2 * l + 1) * x * p - l * below) / (l + 1);
                below = p;
                p = next;
            }
            slope = POINTS * (x * p - below) / (x * x - 1);
            x -= p / slope;
        }
        points[i] = (1 + x) / 2;
        weights[i] = 1 / ((1 - x * x) * slope * slope);
    }
    for (int i = 0; i < POINTS; i++) {
        legendre[0][i] = 1;
        legendre[1][i] = points[i];
        for (int l = 1; l + 1 < ORDERS; l++)
            legendre[l + 1][i] = ((2 * l + 1) * points[i] * legendre[l][i] - l * legendre[l - 1][i]) / (l + 1);
    }
}

/* The mean over azimuths, with the integral 1 over all cosines for each direction: what the points miss of that goes
 * straight on. */
static void make_phase(double g) {
    for (int i = 0; i < POINTS; i++) {
        double all = 0;
        for (int j = 0; j < POINTS; j++) {
            double sum = 0, sum_back = 0, power = 1;
            for (int l = 0; l < ORDERS; l++, power *= g) {
                double term = (2 * l + 1) * power * legendre[l][i] * legendre[l][j];
                sum += term;
                sum_back += l & 1 ? -term : term;
            }
            forward[i][j] = sum / 2 * weights[j];
            back[i][j] = sum_back / 2 * weights[j];
            all += forward[i][j] + back[i][j];
        }
        forward[i][i] += 1 - all;
    }
}

typedef double matrix[POINTS][POINTS];

static void multiply(matrix a, matrix b, matrix out) {
    static matrix result;
    memset(result, 0, sizeof result);
    for (int i = 0; i < POINTS; i++)
        for (int k = 0; k < POINTS; k++)
            for (int j = 0; j < POINTS; j++)
                result[i][j] += a[i][k] * b[k][j];
    memcpy(out, result, sizeof result);
}

/* out = a^-1 b; a is diagonally dominant. */
static void divide(matrix a, matrix b, matrix out) {
    static matrix left;
    memcpy(left, a, sizeof left);
    memmove(out, b, sizeof left);
    for (int k = 0; k < POINTS; k++) {
        for (int i = k + 1; i < POINTS; i++) {
            double factor = left[i][k] / left[k][k];
            for (int j = k; j < POINTS; j++)
                left[i][j] -= factor * left[k][j];
            for (int j = 0; j < POINTS; j++)
                out[i][j] -= factor * out[k][j];
        }
    }
    for (int k = POINTS - 1; k >= 0; k--)
        for (int j = 0; j < POINTS; j++) {
            for (int i = k + 1; i < POINTS; i++)
                out[k][j] -= left[k][i] * out[i][j];
            out[k][j] /= left[k][k];
        }
}

/* What a half space reflects of light from all sides. Rows are directions of light that leaves. The first layer is a
 * quarter of the depth that rounding allows; its error is that of a second scattering in it. */
static double reflected(double albedo) {
    static matrix r, t, rr, one, rt;
    const double thin = ldexp(1, -26);
    for (int i = 0; i < POINTS; i++)
        for (int j = 0; j < POINTS; j++) {
            double depth = thin / points[i];
            r[i][j] = albedo * depth * back[i][j];
            t[i][j] = albedo * depth * forward[i][j] + (i == j ? 1 - depth : 0);
        }
    for (int doubling = 0; doubling < 60; doubling++) {
        /* r' = r + t (1 - r r)^-1 r t, t' = t (1 - r r)^-1 t */
        multiply(r, r, rr);
        for (int i = 0; i < POINTS; i++)
            for (int j = 0; j < POINTS; j++)
                one[i][j] = (i == j) - rr[i][j];
        divide(one, t, rt);
        static matrix next, both;
        multiply(r, rt, both);
        multiply(t, both, next);
        for (int i = 0; i < POINTS; i++)
            for (int j = 0; j < POINTS; j++)
                r[i][j] += next[i][j];
        multiply(t, rt, next);
        memcpy(t, next, sizeof t);
        double largest = 0;
        for (int i = 0; i < POINTS; i++)
            for (int j = 0; j < POINTS; j++)
                largest = fmax(largest, fabs(t[i][j]));
        if (largest < 1e-12)
            break;
    }
    double sum = 0;
    for (int i = 0; i < POINTS; i++)
        for (int j = 0; j < POINTS; j++)
            sum += 2 * weights[i] * points[i] * r[i][j];
    return sum;
}

/* The parameter of a colour's column: Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", 2017, fit
 * of van de Hulst's tables, between 0 for white and 1 for black. */
static double colour_of(double s) {
    return (1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s);
}

static double albedo_of(double s, double g) {
    return (1 - s * s) / (1 - g * s * s);
}

static double solve(double colour, double g, double s) {
    double low = s - 0.01, at_low = reflected(albedo_of(low, g)), at = reflected(albedo_of(s, g));
    for (int turn = 0; turn < 12 && fabs(at - colour) > 1e-9; turn++) {
        double next = s - (at - colour) * (s - low) / (at - at_low);
        low = s;
        at_low = at;
        s = fmin(fmax(next, 1e-5), 1);
        at = reflected(albedo_of(s, g));
    }
    return s;
}

int main(void) {
    make_points();
    printf("/* Written by tools/subsurface_table.c, which says what it is: by g from -%g to %g, by the fit's parameter "
           "of\n"
           " * the colour from 0 to 1. */\n"
           "enum { SUBSURFACE_COSINES = %d, SUBSURFACE_COLOURS = %d };\n"
           "static const double subsurface_max_cosine = %g;\n"
           "static const float subsurface_table[SUBSURFACE_COSINES][SUBSURFACE_COLOURS] = {\n",
           max_cosine, max_cosine, COSINES, COLOURS, max_cosine);
    for (int c = 0; c < COSINES; c++) {
        double g = max_cosine * (2.0 * c / (COSINES - 1) - 1), s = 0;
        make_phase(g);
        printf("    {0.0F");
        for (int i = 1; i + 1 < COLOURS; i++) {
            double fit = (double)i / (COLOURS - 1);
            s = solve(colour_of(fit), g, fmin(i > 1 ? s + 1.0 / (COLOURS - 1) : fit, 0.999));
            printf(",%s%.7fF", i % 10 == 0 ? "\n     " : " ", s);
        }
        printf(", 1.0F}%s\n", c + 1 < COSINES ? "," : "");
        fflush(stdout);
    }
    printf("};\n");
    return 0;
}
