/* The inspector: widgets for the fields of a form. Another subject makes them anew; else only values change, and not in
 * a widget in which the user types. */
#include "window/gtk_form_internal.h"

#include "image/tone.h"
#include "image/transfer.h"
#include "window/gtk_window_internal.h"

#include <math.h>
#include <string.h>

/* Microseconds: changes of one field that follow faster are one edit. */
static const gint64 same_edit = 1000000;

static void send_field(struct gui *gui, struct form_row *row) {
    gint64 now = g_get_monotonic_time();
    struct window_event event = {.kind = WINDOW_FIELD,
                                 .field = row->field.number,
                                 .joins = gui->last_field == row->field.number && now - gui->last_change < same_edit};
    memcpy(event.numbers, row->field.numbers, sizeof event.numbers);
    (void)g_strlcpy(event.text, row->field.text, sizeof event.text);
    gui->last_field = row->field.number;
    gui->last_change = now;
    gui_send_event(gui, &event);
}

/* Values from the program into the widgets. */
static void show_values(struct gui *gui, struct form_row *row) {
    const struct window_field *field = &row->field;
    int count = field->kind == FIELD_VECTOR ? 3 : 1;
    gui->updates = true;
    gtk_widget_set_sensitive(row->reset, field->numbers[0] < field->initial || field->numbers[0] > field->initial);
    switch (field->kind) {
    case FIELD_TEXT:
        gtk_label_set_text(GTK_LABEL(row->inputs[0]), field->text);
        break;
    case FIELD_ENTRY:
        gtk_editable_set_text(GTK_EDITABLE(row->inputs[0]), field->text);
        break;
    case FIELD_NUMBER:
    case FIELD_VECTOR:
        for (int i = 0; i < count; i++)
            gtk_spin_button_set_value(GTK_SPIN_BUTTON(row->inputs[i]), field->numbers[i]);
        break;
    case FIELD_COLOUR: {
        double top = math_max(1, math_max(field->numbers[0], math_max(field->numbers[1], field->numbers[2])));
        const struct tone srgb = {.srgb = true};
        double shown[3];
        for (int i = 0; i < 3; i++)
            shown[i] = field->linear ? tone_apply(&srgb, field->numbers[i] / top) : field->numbers[i] / top;
        GdkRGBA colour = {(float)shown[0], (float)shown[1], (float)shown[2], 1};
        gtk_color_chooser_set_rgba(GTK_COLOR_CHOOSER(row->inputs[0]), &colour);
        gtk_spin_button_set_value(GTK_SPIN_BUTTON(row->inputs[1]), top);
        break;
    }
    case FIELD_CHOICE:
        gtk_drop_down_set_selected(GTK_DROP_DOWN(row->inputs[0]), (guint)field->numbers[0]);
        break;
    case FIELD_FLAG:
        gtk_switch_set_active(GTK_SWITCH(row->inputs[0]), field->numbers[0] != 0);
        break;
    }
    gui->updates = false;
}

static void number_changed(GtkSpinButton *button, gpointer data) {
    struct gui *gui = g_object_get_data(G_OBJECT(button), "gui");
    struct form_row *row = data;
    if (gui->updates)
        return;
    double before[3];
    memcpy(before, row->field.numbers, sizeof before);
    for (int i = 0; i < 3; i++) {
        if (row->inputs[i])
            row->field.numbers[i] = gtk_spin_button_get_value(GTK_SPIN_BUTTON(row->inputs[i]));
    }
    send_field(gui, row);
    if (!row->field.acts)
        return;
    memcpy(row->field.numbers, before, sizeof before); /* it was done, and is not a state */
    show_values(gui, row);
}

/* The colour of the button, and a factor for colours brighter than white. */
static void colour_changed(GtkWidget *widget, gpointer data) {
    struct gui *gui = g_object_get_data(G_OBJECT(widget), "gui");
    struct form_row *row = data;
    const struct transfer_function srgb = {TRANSFER_SRGB, 0};
    GdkRGBA colour;
    if (gui->updates)
        return;
    gtk_color_chooser_get_rgba(GTK_COLOR_CHOOSER(row->inputs[0]), &colour);
    double factor = gtk_spin_button_get_value(GTK_SPIN_BUTTON(row->inputs[1]));
    const double parts[3] = {(double)colour.red, (double)colour.green, (double)colour.blue};
    for (int i = 0; i < 3; i++)
        row->field.numbers[i] = math_min(
            math_max((row->field.linear ? transfer_decode(srgb, parts[i]) : parts[i]) * factor, row->field.low),
            row->field.high);
    send_field(gui, row);
}

/* When Return is pressed, or the keyboard leaves it. */
static void text_changed(GtkWidget *entry, gpointer data) {
    struct gui *gui = g_object_get_data(G_OBJECT(entry), "gui");
    struct form_row *row = data;
    const char *text = gtk_editable_get_text(GTK_EDITABLE(entry));
    if (gui->updates || strcmp(text, row->field.text) == 0)
        return;
    (void)g_strlcpy(row->field.text, text, sizeof row->field.text);
    send_field(gui, row);
}

static void text_left(GtkEventControllerFocus *focus, gpointer data) {
    text_changed(gtk_event_controller_get_widget(GTK_EVENT_CONTROLLER(focus)), data);
}

static GtkWidget *text_input(struct gui *gui, struct form_row *row) {
    GtkWidget *entry = gtk_entry_new();
    GtkEventController *focus = gtk_event_controller_focus_new();
    gtk_editable_set_width_chars(GTK_EDITABLE(entry), 8);
    gtk_entry_set_max_length(GTK_ENTRY(entry), FORM_TEXT - 1);
    gtk_widget_set_hexpand(entry, TRUE);
    g_object_set_data(G_OBJECT(entry), "gui", gui);
    g_signal_connect(entry, "activate", G_CALLBACK(text_changed), row);
    g_signal_connect(focus, "leave", G_CALLBACK(text_left), row);
    gtk_widget_add_controller(entry, focus);
    return entry;
}

/* Of a choice or a flag: the property that has changed. */
static void choice_changed(GObject *widget, GParamSpec *property, gpointer data) {
    struct gui *gui = g_object_get_data(widget, "gui");
    struct form_row *row = data;
    (void)property;
    if (gui->updates)
        return;
    if (row->field.kind == FIELD_FLAG)
        row->field.numbers[0] = gtk_switch_get_active(GTK_SWITCH(widget));
    else
        row->field.numbers[0] = gtk_drop_down_get_selected(GTK_DROP_DOWN(widget));
    send_field(gui, row);
}

static void reset_number(GtkButton *button, gpointer data) {
    struct gui *gui = g_object_get_data(G_OBJECT(button), "gui");
    struct form_row *row = data;
    row->field.numbers[0] = row->field.initial;
    show_values(gui, row);
    send_field(gui, row);
}

/* Back to the default; nothing where there is none. */
static GtkWidget *reset_button(struct gui *gui, struct form_row *row) {
    GtkWidget *button = gtk_button_new_from_icon_name("edit-undo-symbolic");
    char *name = g_strdup_printf("Default of %s", row->field.name);
    gtk_button_set_has_frame(GTK_BUTTON(button), FALSE);
    gtk_widget_add_css_class(button, "eye");
    gtk_widget_set_visible(button, row->field.resets);
    gtk_widget_set_valign(button, GTK_ALIGN_CENTER);
    gui_name(button, name);
    g_object_set_data(G_OBJECT(button), "gui", gui);
    g_signal_connect(button, "clicked", G_CALLBACK(reset_number), row);
    g_free(name);
    return button;
}

static GtkWidget *choice_input(struct gui *gui, struct form_row *row) {
    bool flag = row->field.kind == FIELD_FLAG;
    char **words = g_strsplit(row->field.text, "|", -1);
    GtkWidget *input = flag ? gtk_switch_new() : gtk_drop_down_new_from_strings((const char *const *)words);
    g_strfreev(words);
    gtk_widget_set_halign(input, GTK_ALIGN_START);
    g_object_set_data(G_OBJECT(input), "gui", gui);
    g_signal_connect(input, flag ? "notify::active" : "notify::selected", G_CALLBACK(choice_changed), row);
    return input;
}

/* A comma is accepted, too; what is no number keeps the old value. */
static int parse_number(GtkSpinButton *button, double *out, gpointer data) {
    char *text = g_strdelimit(g_strdup(gtk_editable_get_text(GTK_EDITABLE(button))), ",", '.'), *end;
    (void)data;
    *out = g_ascii_strtod(text, &end);
    bool ok = end != text && g_strstrip(end)[0] == '\0' && isfinite(*out);
    g_free(text);
    return ok ? TRUE : GTK_INPUT_ERROR;
}

/* As few digits as the number needs. */
static gboolean show_number(GtkSpinButton *button, gpointer data) {
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    double value = gtk_spin_button_get_value(button);
    (void)data;
    gtk_editable_set_text(GTK_EDITABLE(button),
                          g_ascii_formatd(text, sizeof text, "%.6g", fabs(value) < 1e-9 ? 0 : value));
    return TRUE;
}

static GtkWidget *number_input(struct gui *gui, struct form_row *row, double low, double high) {
    bool share = high - low <= 1, whole = row->field.unit[0] == '#';
    double step = whole ? 1 : share ? 0.05 : 0.1;
    GtkWidget *button = gtk_spin_button_new_with_range(math_max(low, -1e9), math_min(high, 1e9), step);
    gtk_spin_button_set_digits(GTK_SPIN_BUTTON(button), whole ? 0 : 12);
    gtk_editable_set_width_chars(GTK_EDITABLE(button), 5);
    gtk_widget_set_hexpand(button, TRUE);
    g_object_set_data(G_OBJECT(button), "gui", gui);
    g_signal_connect(button, "input", G_CALLBACK(parse_number), NULL);
    g_signal_connect(button, "output", G_CALLBACK(show_number), NULL);
    return button;
}

/* The widgets of a field in a box; *row has those with values. */
static GtkWidget *make_inputs(struct gui *gui, struct form_row *row) {
    const struct window_field *field = &row->field;
    bool numbers = field->kind == FIELD_NUMBER || field->kind == FIELD_VECTOR;
    GtkWidget *box =
        gtk_box_new(field->kind == FIELD_VECTOR ? GTK_ORIENTATION_VERTICAL : GTK_ORIENTATION_HORIZONTAL, 2);
    memset(row->inputs, 0, sizeof row->inputs);
    for (int i = 0; numbers && i < (field->kind == FIELD_VECTOR ? 3 : 1); i++) {
        row->inputs[i] = number_input(gui, row, field->low, field->high);
        g_signal_connect(row->inputs[i], "value-changed", G_CALLBACK(number_changed), row);
    }
    if (field->kind == FIELD_NUMBER && field->high - field->low <= 1 && field->unit[0] != '#') {
        GtkAdjustment *adjustment = gtk_spin_button_get_adjustment(GTK_SPIN_BUTTON(row->inputs[0]));
        GtkWidget *slider = gtk_scale_new(GTK_ORIENTATION_HORIZONTAL, adjustment);
        gtk_widget_set_size_request(slider, 70, -1);
        gtk_widget_set_hexpand(slider, TRUE);
        gtk_box_append(GTK_BOX(box), slider);
        gui_label(slider, field->name);
    }
    if (field->kind == FIELD_COLOUR) {
        row->inputs[0] = gtk_color_button_new();
        row->inputs[1] = number_input(gui, row, 0, 1e6);
        gtk_widget_set_tooltip_text(row->inputs[1], "A factor, for colours brighter than white");
        g_object_set_data(G_OBJECT(row->inputs[0]), "gui", gui);
        g_signal_connect(row->inputs[0], "color-set", G_CALLBACK(colour_changed), row);
        g_signal_connect(row->inputs[1], "value-changed", G_CALLBACK(colour_changed), row);
    }
    if (field->kind == FIELD_CHOICE || field->kind == FIELD_FLAG)
        row->inputs[0] = choice_input(gui, row);
    if (field->kind == FIELD_ENTRY)
        row->inputs[0] = text_input(gui, row);
    if (!row->inputs[0]) {
        row->inputs[0] = gtk_label_new(NULL);
        gtk_label_set_xalign(GTK_LABEL(row->inputs[0]), 0);
        gtk_label_set_wrap(GTK_LABEL(row->inputs[0]), TRUE);
        gtk_label_set_wrap_mode(GTK_LABEL(row->inputs[0]), PANGO_WRAP_WORD_CHAR);
        gtk_label_set_selectable(GTK_LABEL(row->inputs[0]), TRUE);
        gtk_widget_set_can_focus(row->inputs[0], FALSE);
    }
    for (int i = 0; i < 3 && row->inputs[i]; i++)
        gtk_box_append(GTK_BOX(box), row->inputs[i]);
    return box;
}

static void add_row(struct gui *gui, GtkGrid *grid, int at, struct form_row *row) {
    static const char *const axes[] = {"x", "y", "z"};
    const struct window_field *field = &row->field;
    bool has_unit = field->unit[0] != '\0' && field->unit[0] != '#';
    char *text = has_unit ? g_strdup_printf("%s (%s)", field->name, field->unit) : g_strdup(field->name);
    GtkWidget *label = gtk_label_new(text), *inputs = make_inputs(gui, row);
    gtk_label_set_xalign(GTK_LABEL(label), 0);
    gtk_widget_set_valign(label, GTK_ALIGN_START);
    gtk_widget_set_margin_top(label, field->kind == FIELD_TEXT ? 0 : 7);
    gtk_widget_add_css_class(label, "dim-label");
    for (int i = 0; i < 3 && row->inputs[i] && field->kind != FIELD_TEXT; i++) {
        char *name = field->kind == FIELD_VECTOR ? g_strdup_printf("%s %s", text, axes[i]) : g_strdup(text);
        gui_label(row->inputs[i], name);
        g_free(name);
    }
    if (field->help[0] != '\0') {
        gtk_widget_set_tooltip_text(label, field->help);
        gtk_widget_set_tooltip_text(inputs, field->help);
    }
    gtk_grid_attach(grid, label, 0, at, 1, 1);
    row->reset = reset_button(gui, row);
    gtk_grid_attach(grid, inputs, 1, at, 1, 1);
    gtk_grid_attach(grid, row->reset, 2, at, 1, 1);
    g_free(text);
    show_values(gui, row);
}

/* Groups are folded as the user has left them. */
static void note_fold(GtkExpander *expander, GParamSpec *spec, gpointer folded) {
    (void)spec;
    const char *name = gtk_expander_get_label(expander);
    if (gtk_expander_get_expanded(expander))
        g_hash_table_remove(folded, name);
    else
        g_hash_table_add(folded, g_strdup(name));
}

static GtkGrid *add_group(GtkBox *box, const char *name) {
    static GHashTable *folded;
    GtkWidget *expander = gtk_expander_new(name), *grid = gtk_grid_new();
    folded = folded ? folded : g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
    gtk_grid_set_row_spacing(GTK_GRID(grid), 3);
    gtk_grid_set_column_spacing(GTK_GRID(grid), 8);
    gtk_widget_set_margin_top(grid, 4);
    gtk_widget_set_margin_start(grid, 12);
    gtk_expander_set_child(GTK_EXPANDER(expander), grid);
    gui_label(expander, name);
    gtk_expander_set_expanded(GTK_EXPANDER(expander), !g_hash_table_contains(folded, name));
    g_signal_connect(expander, "notify::expanded", G_CALLBACK(note_fold), folded);
    gtk_box_append(box, expander);
    return GTK_GRID(grid);
}

static void make_form(struct gui *gui, uint32_t count) {
    GtkBox *box = GTK_BOX(gui->inspector);
    GtkWidget *child;
    const char *group = "";
    GtkGrid *grid = NULL;
    GtkWidget *focus = gtk_window_get_focus(GTK_WINDOW(gui->window));
    if (focus && gtk_widget_is_ancestor(focus, gui->inspector))
        gtk_widget_grab_focus(gui->picture);
    while ((child = gtk_widget_get_first_child(gui->inspector)))
        gtk_box_remove(box, child);
    for (uint32_t i = 0; i < count; i++) {
        struct form_row *row = &gui->rows[i];
        if (strcmp(row->field.group, group) != 0)
            grid = add_group(box, row->field.group);
        group = row->field.group;
        add_row(gui, grid, (int)i, row);
    }
    gui->row_count = count;
}

void gui_form_show(struct gui *gui) {
    const struct window_form *form = &gui->state.form;
    bool other = form->subject != gui->form_subject || form->count != gui->row_count;
    gtk_label_set_text(GTK_LABEL(gui->inspector_title), form->title[0] != '\0' ? form->title : "Picture");
    for (uint32_t i = 0; i < form->count; i++) {
        struct form_row *row = &gui->rows[i];
        bool changed = memcmp(&row->field, &form->fields[i], sizeof row->field) != 0;
        row->field = form->fields[i];
        if (other || !changed)
            continue;
        GtkWidget *focus = gtk_window_get_focus(GTK_WINDOW(gui->window));
        bool used = focus && gtk_widget_is_ancestor(focus, gtk_widget_get_parent(row->inputs[0]));
        if (!used || row->field.kind == FIELD_COLOUR)
            show_values(gui, row);
    }
    gui->form_subject = form->subject;
    if (other)
        make_form(gui, form->count);
}

GtkWidget *gui_inspector_new(struct gui *gui) {
    GtkWidget *scrolled = gtk_scrolled_window_new(), *outer = gtk_box_new(GTK_ORIENTATION_VERTICAL, 6);
    gui->inspector = gtk_box_new(GTK_ORIENTATION_VERTICAL, 8);
    gui->inspector_title = gtk_label_new("");
    gtk_label_set_xalign(GTK_LABEL(gui->inspector_title), 0);
    gtk_label_set_ellipsize(GTK_LABEL(gui->inspector_title), PANGO_ELLIPSIZE_MIDDLE);
    gtk_widget_add_css_class(gui->inspector_title, "heading");
    gtk_box_append(GTK_BOX(outer), gui->inspector_title);
    gtk_box_append(GTK_BOX(outer), gui->inspector);
    gtk_widget_set_margin_start(outer, 8);
    gtk_widget_set_margin_end(outer, 12);
    gtk_widget_set_margin_top(outer, 8);
    gtk_widget_set_margin_bottom(outer, 8);
    gtk_scrolled_window_set_policy(GTK_SCROLLED_WINDOW(scrolled), GTK_POLICY_NEVER, GTK_POLICY_AUTOMATIC);
    gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scrolled), outer);
    gtk_widget_set_size_request(scrolled, 320, -1);
    return scrolled;
}
