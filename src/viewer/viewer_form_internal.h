/* What a window with widgets shows beside the picture: the state of the work, and a form with every input of the
 * selection and of the picture. */
#ifndef GRAY_VIEWER_VIEWER_FORM_INTERNAL_H
#define GRAY_VIEWER_VIEWER_FORM_INTERNAL_H

#include "viewer/viewer.h"

/* The form, and the integrator, as they are now. */
void viewer_make_form(const struct viewer *viewer, struct window_state *state);
void viewer_set_field(struct viewer *viewer, const struct window_event *event);

#endif
