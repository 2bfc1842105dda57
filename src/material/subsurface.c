/* See subsurface.h. */
#include "material/subsurface.h"

#include "material/subsurface_table_internal.h"

#include <math.h>

double subsurface_albedo(double colour, double g) {
    if (!(colour > 0) || colour >= 1)
        return colour > 0;
    /* The fit by Kulla and Conty, 2017, is where the table is read. */
    double fit = 4.09712 + 4.20863 * colour - sqrt(9.59217 + 41.6808 * colour + 17.7126 * colour * colour);
    double x = math_min(math_max(fit, 0), 1) * (SUBSURFACE_COLOURS - 1);
    double y = math_min(math_max(g / subsurface_max_cosine, -1), 1) / 2 * (SUBSURFACE_COSINES - 1) +
               (SUBSURFACE_COSINES - 1) / 2.0;
    int column = (int)math_min(x, SUBSURFACE_COLOURS - 2), row = (int)math_min(y, SUBSURFACE_COSINES - 2);
    double s[2];
    for (int i = 0; i < 2; i++) {
        const float *near = &subsurface_table[row + i][column];
        s[i] = (double)near[0] + (x - column) * (double)(near[1] - near[0]);
    }
    double mixed = s[0] + (y - row) * (s[1] - s[0]), square = mixed * mixed;
    return (1 - square) / (1 - g * square);
}
