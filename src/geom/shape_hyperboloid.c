/* The hyperboloids: x^2 + z^2 = m y^2 + w^2 of one sheet, x^2 + z^2 = m (y^2 - g^2) of two, with the cone of slope
 * sqrt(m) as their asymptote (Wren, "Generatio corporis cylindroidis hyperbolici", 1669, found the lines on the first).
 * The slope follows from the rim; differences of squares are products, so that nothing cancels. */
#include "geom/shape_hyperboloid.h"

struct conic conic_one_sheet(double waist, double rim, double lo, double hi, bool open) {
    double reach = fmax(fabs(lo), fabs(hi)), slope = (rim - waist) / reach * ((rim + waist) / reach);
    return conic_upright(slope, 0, waist * waist, lo, hi, open);
}

struct conic conic_two_sheets(double gap, double reach, double rim, bool open) {
    double slope = rim / (reach - gap) * (rim / (reach + gap));
    return conic_upright(slope, 0, -slope * gap * gap, -reach, reach, open);
}
