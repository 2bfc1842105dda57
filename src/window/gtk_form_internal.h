/* The inspector. */
#ifndef GRAY_WINDOW_GTK_FORM_INTERNAL_H
#define GRAY_WINDOW_GTK_FORM_INTERNAL_H

#include "window/gtk_internal.h"

GtkWidget *gui_inspector_new(struct gui *gui);
void gui_form_show(struct gui *gui); /* state.form */ /* of ORDER_FIELD and ORDER_FORM */

#endif
