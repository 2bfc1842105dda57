/* What a printer asks of a model: --check-print. */
#ifndef GRAY_EXPORT_PRINT_CHECK_H
#define GRAY_EXPORT_PRINT_CHECK_H

#include "base/pool.h"
#include "export/model_write.h"
#include "math/box.h"

/* z is up, and the model stands on the plane of its lowest point. */
struct print_report {
    bool closed;
    double volume, area;
    struct box box;
    double thinnest; /* of the thicknesses along the normal at 10,000 points of the surface */
    struct vec3 thinnest_at;
    double overhang, overhang_area; /* degrees from the vertical of the steepest face that nothing supports; the area of
                                     * those above 45 degrees */
    struct vec3 overhang_at;
    double contact_area; /* on the plate */
    bool is_standing;    /* the centre of mass is above the contact */
};

/* Errors: no memory, cancelled. */
bool print_check(const struct export_model *model, struct pool *pool, struct print_report *out, struct error *error);

#endif
