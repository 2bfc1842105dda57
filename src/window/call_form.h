/* Making the fields of a form (window.h). */
#ifndef GRAY_WINDOW_CALL_FORM_H
#define GRAY_WINDOW_CALL_FORM_H

#include "window/window.h"

/* A new field at the end, without limits. What has no room is not shown. */
struct window_field *form_add(struct window_form *form, const char *group, const char *name,
                              enum window_field_kind kind, uint32_t number);
void form_set_range(struct window_field *field, double low, double high, const char *unit);
void form_set_help(struct window_field *field, const char *help); /* or NULL */

/* A field for each argument of a call such as "gr.torus{minor = 0.1}", by the row of its function, but not for its
 * material; their numbers are those from `first` on. */
void call_form_add(struct window_form *form, const char *call, uint32_t first);
/* The call after the change of such a field. False: there is no such field, or the call would be too long. */
bool call_form_set(const char *call, const struct window_event *event, uint32_t first, char out[FORM_TEXT]);

#endif
