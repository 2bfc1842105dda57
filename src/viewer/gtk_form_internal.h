/* The inspector. */
#ifndef GRAY_VIEWER_GTK_FORM_INTERNAL_H
#define GRAY_VIEWER_GTK_FORM_INTERNAL_H

#include "viewer/gtk_internal.h"

GtkWidget *gui_inspector_new(struct gui *gui);
void gui_form_show(struct gui *gui); /* state.form */ /* of ORDER_FIELD and ORDER_FORM */

#endif
