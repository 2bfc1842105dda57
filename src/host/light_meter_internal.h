/* exposure = 'auto'. */
#ifndef GRAY_HOST_LIGHT_METER_INTERNAL_H
#define GRAY_HOST_LIGHT_METER_INTERNAL_H

#include "host/render_process_internal.h"

/* Replaces EXPOSURE_AUTO in the settings of the job by the exposure that it measures. Errors: as building and rendering
 * have. Under --check and --dump-... nothing is measured. */
bool light_meter_measure(struct picture_work *work, struct error *error);

#endif
