/* Prints src/material/boundary_stretch_internal.h: how much more light boundaries of two widths lose in the mean than
 * boundaries of one width times albedo_stretch_average, by brute force over directions.
 *   cc -std=gnu11 -O2 -Isrc tools/boundary_stretch.c build/release/src/material/albedo.o \
 *      build/release/src/material/microfacet.o build/release/src/math/elementary.o build/release/src/math/sampling.o
 * -lm */
#include "material/rough_lobes.c"

#include <stdio.h>

static double mean_of(const struct facet_distribution *d, double eta) {
    enum { HEIGHTS = 40, TURNS = 24 };
    double sum = 0;
    for (int i = 0; i < HEIGHTS * TURNS; i++) {
        double c = sqrt((i % HEIGHTS + 0.5) / HEIGHTS), s = sqrt(1 - c * c),
               angle = PI / 2 * (i / HEIGHTS + 0.5) / TURNS;
        sum += stretched_boundary(d, vec3_make(s * cos(angle), s * sin(angle), c), eta).lack;
    }
    return sum / (HEIGHTS * TURNS);
}

int main(void) {
    printf("/* Printed by tools/boundary_stretch.c, which explains it. Axes: side of the light (behind the denser "
           "medium, in\n"
           " * it), index, square root of the larger width, square root of the ratio of widths. */\n"
           "#ifndef GRAY_MATERIAL_BOUNDARY_STRETCH_INTERNAL_H\n#define GRAY_MATERIAL_BOUNDARY_STRETCH_INTERNAL_H\n\n"
           "static const float boundary_stretches[2][STRETCH_INDICES][STRETCH_WIDTHS][STRETCH_RATIOS] = {\n");
    for (int side = 0; side < 2; side++) {
        printf("    {\n");
        for (int e = 0; e < STRETCH_INDICES; e++) {
            double index = stretch_min_index * pow(stretch_max_index / stretch_min_index, e / (STRETCH_INDICES - 1.0));
            double eta = side ? index : 1 / index;
            printf("        {\n");
            for (int w = 0; w < STRETCH_WIDTHS; w++) {
                printf("            {");
                for (int r = 0; r < STRETCH_RATIOS; r++) {
                    double root = stretch_min_width + (1 - stretch_min_width) * w / (STRETCH_WIDTHS - 1.0);
                    double ratio = r * r / (double)((STRETCH_RATIOS - 1) * (STRETCH_RATIOS - 1)), along = root * root;
                    const struct facet_distribution d = {
                        {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, along, fmax(along * ratio, 1e-6)};
                    double square = along * along * (1 + ratio * ratio), roughness = sqrt(sqrt(square / 2));
                    double one =
                        (1 - albedo_boundary_average(roughness, eta)) * albedo_stretch_average(along, d.alpha_across);
                    printf("%.4ff%s", mean_of(&d, eta) / one, r + 1 < STRETCH_RATIOS ? ", " : "},\n");
                }
            }
            printf("        },\n");
        }
        printf("    },\n");
    }
    printf("};\n\n#endif\n");
    return 0;
}
