/* The inspector. */
#ifndef GRAY_VIEWER_GTK_FORM_INTERNAL_H
#define GRAY_VIEWER_GTK_FORM_INTERNAL_H

#include "viewer/gtk_internal.h"

GtkWidget *gui_inspector_new(struct gui *gui);
void gui_form_receive(struct gui *gui, const struct window_order *order); /* of ORDER_FIELD and ORDER_FORM */

#endif
