/* Each open node has a list model of its children. The row of the node states how many there are. The model asks the
 * viewer for rows when they come into view, NODE_ROWS at a time. Closed nodes have no model. */
#include "window/gtk_tree_internal.h"

#include "window/gtk_window_internal.h"

#include <string.h>

/* The children of a node. */

struct _GrayNodes {
    GObject parent;
    struct gui *gui;
    struct node_query query; /* the node */
    guint count;
    struct node_row *rows; /* count of them; those without a name are not known */
    guint8 *wanted;        /* by NODE_ROWS of them */
};
G_DECLARE_FINAL_TYPE(GrayNodes, gray_nodes, GRAY, NODES, GObject)

/* One of them. */
struct _GrayNode {
    GObject parent;
    GrayNodes *list;
    guint at;
};
G_DECLARE_FINAL_TYPE(GrayNode, gray_node, GRAY, NODE, GObject)
G_DEFINE_FINAL_TYPE(GrayNode, gray_node, G_TYPE_OBJECT)

static void gray_node_finalize(GObject *object) {
    g_object_unref(GRAY_NODE(object)->list);
    G_OBJECT_CLASS(gray_node_parent_class)->finalize(object);
}
static void gray_node_class_init(GrayNodeClass *class) {
    G_OBJECT_CLASS(class)->finalize = gray_node_finalize;
}
static void gray_node_init(GrayNode *node) {
    (void)node;
}

static GType nodes_item_type(GListModel *model) {
    (void)model;
    return gray_node_get_type();
}
static guint nodes_count(GListModel *model) {
    return GRAY_NODES(model)->count;
}
static gpointer nodes_item(GListModel *model, guint at) {
    GrayNodes *nodes = GRAY_NODES(model);
    if (at >= nodes->count)
        return NULL;
    GrayNode *node = g_object_new(gray_node_get_type(), NULL);
    node->list = g_object_ref(nodes);
    node->at = at;
    return node;
}
static void nodes_model_init(GListModelInterface *functions) {
    functions->get_item_type = nodes_item_type;
    functions->get_n_items = nodes_count;
    functions->get_item = nodes_item;
}
G_DEFINE_FINAL_TYPE_WITH_CODE(GrayNodes, gray_nodes, G_TYPE_OBJECT,
                              G_IMPLEMENT_INTERFACE(G_TYPE_LIST_MODEL, nodes_model_init))

static void gray_nodes_finalize(GObject *object) {
    GrayNodes *nodes = GRAY_NODES(object);
    g_ptr_array_remove_fast(nodes->gui->open_nodes, nodes);
    g_free(nodes->rows);
    g_free(nodes->wanted);
    G_OBJECT_CLASS(gray_nodes_parent_class)->finalize(object);
}
static void gray_nodes_class_init(GrayNodesClass *class) {
    G_OBJECT_CLASS(class)->finalize = gray_nodes_finalize;
}
static void gray_nodes_init(GrayNodes *nodes) {
    (void)nodes;
}

static GListModel *nodes_new(struct gui *gui, const struct node_query *query, guint count) {
    GrayNodes *nodes = g_object_new(gray_nodes_get_type(), NULL);
    nodes->gui = gui;
    nodes->query = *query;
    nodes->count = count;
    nodes->rows = g_new0(struct node_row, count);
    nodes->wanted = g_new0(guint8, count / NODE_ROWS + 1);
    g_ptr_array_add(gui->open_nodes, nodes);
    return G_LIST_MODEL(nodes);
}

/* The path of a node, or false: it is too deep. */
static bool query_of(const GrayNode *node, struct node_query *out) {
    *out = node->list->query;
    out->first = 0;
    if (out->depth == NODE_LEVELS)
        return false;
    out->path[out->depth++] = node->at;
    return true;
}

static GListModel *children_of(gpointer item, gpointer data) {
    const GrayNode *node = item;
    struct node_query query;
    guint count = node->list->rows[node->at].children;
    return count > 0 && query_of(node, &query) ? nodes_new(data, &query, count) : NULL;
}

/* Rows. */

static void want_rows(struct gui *gui, GrayNodes *nodes, guint at) {
    struct window_event event = {.kind = WINDOW_NODES, .node = nodes->query};
    guint part = at / NODE_ROWS;
    event.node.first = part * NODE_ROWS;
    if (!nodes->wanted[part])
        gui_send_event(gui, &event);
    nodes->wanted[part] = 1;
}

/* An eye for nodes: the scene's root and what is not of its tree has none. */
static bool can_hide(const GrayNode *node) {
    return node->list->query.depth > 0 && node->list->query.path[0] == SECTION_NODES;
}

static bool is_hidden(const struct gui *gui, uint32_t serial) {
    for (uint32_t i = 0; i < gui->state.hidden_count; i++) {
        if (gui->state.hidden[i] == serial)
            return true;
    }
    return false;
}

static void toggle_eye(GtkButton *button, gpointer data) {
    GtkTreeExpander *expander = GTK_TREE_EXPANDER(gtk_widget_get_ancestor(GTK_WIDGET(button), GTK_TYPE_TREE_EXPANDER));
    GrayNode *node = gtk_tree_expander_get_item(expander);
    const struct node_row *row = &node->list->rows[node->at];
    struct window_event event = {.kind = WINDOW_HIDE, .node.serial = row->serial};
    (void)g_strlcpy(event.text, row->name, sizeof event.text);
    gui_send_event(data, &event);
    g_object_unref(node);
}

static void make_row(GtkSignalListItemFactory *factory, GtkListItem *item, gpointer data) {
    GtkWidget *expander = gtk_tree_expander_new(), *label = gtk_label_new(NULL);
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_HORIZONTAL, 4), *eye = gtk_button_new();
    (void)factory;
    gtk_label_set_xalign(GTK_LABEL(label), 0);
    gtk_label_set_ellipsize(GTK_LABEL(label), PANGO_ELLIPSIZE_END);
    gtk_widget_set_hexpand(label, TRUE);
    gtk_button_set_has_frame(GTK_BUTTON(eye), FALSE);
    gtk_widget_add_css_class(eye, "eye");
    g_signal_connect(eye, "clicked", G_CALLBACK(toggle_eye), data);
    gtk_box_append(GTK_BOX(box), label);
    gtk_box_append(GTK_BOX(box), eye);
    gtk_tree_expander_set_child(GTK_TREE_EXPANDER(expander), box);
    gtk_list_item_set_child(item, expander);
}

static void show_eye(struct gui *gui, GtkListItem *item) {
    GtkTreeExpander *expander = GTK_TREE_EXPANDER(gtk_list_item_get_child(item));
    GrayNode *node = gtk_tree_expander_get_item(expander);
    GtkWidget *eye = gtk_widget_get_last_child(gtk_tree_expander_get_child(expander));
    const struct node_row *row = &node->list->rows[node->at];
    bool hidden = is_hidden(gui, row->serial);
    const char *name = hidden ? "Show the node" : "Hide the node";
    gtk_widget_set_visible(eye, can_hide(node));
    /* A new icon lays out the window again, and a new tooltip asks the display where the pointer is. */
    if (g_strcmp0(gtk_widget_get_tooltip_text(eye), name) != 0) {
        gtk_button_set_icon_name(GTK_BUTTON(eye), hidden ? "view-conceal-symbolic" : "view-reveal-symbolic");
        gui_name(eye, name);
    }
    g_object_unref(node);
}

static void show_row(GtkSignalListItemFactory *factory, GtkListItem *item, gpointer data) {
    struct gui *gui = data;
    GtkTreeListRow *row = gtk_list_item_get_item(item);
    GrayNode *node = gtk_tree_list_row_get_item(row);
    GtkTreeExpander *expander = GTK_TREE_EXPANDER(gtk_list_item_get_child(item));
    const struct node_row *known = &node->list->rows[node->at];
    char *text = g_strdup_printf("%s  %s", known->name, known->kind);
    (void)factory;
    gtk_tree_expander_set_list_row(expander, row);
    GtkWidget *label = gtk_widget_get_first_child(gtk_tree_expander_get_child(expander));
    gtk_label_set_text(GTK_LABEL(label), known->kind[0] ? text : "…");
    gtk_widget_set_tooltip_text(GTK_WIDGET(expander), known->kind[0] ? text : NULL);
    if (!known->kind[0])
        want_rows(gui, node->list, node->at);
    show_eye(gui, item);
    g_ptr_array_add(gui->node_items, item);
    g_free(text);
    g_object_unref(node);
}

static void forget_row(GtkSignalListItemFactory *factory, GtkListItem *item, gpointer data) {
    struct gui *gui = data;
    (void)factory;
    g_ptr_array_remove_fast(gui->node_items, item);
}

static void select_row(GtkSingleSelection *selection, GParamSpec *property, gpointer data) {
    GtkTreeListRow *row = gtk_single_selection_get_selected_item(selection);
    struct gui *gui = data;
    struct window_event event = {.kind = WINDOW_SELECT};
    (void)property;
    if (!row || gui->updates)
        return;
    GrayNode *node = gtk_tree_list_row_get_item(row);
    if (query_of(node, &event.node))
        gui_send_event(gui, &event);
    g_object_unref(node);
}

static GtkTreeListModel *model_of(struct gui *gui) {
    return GTK_TREE_LIST_MODEL(gtk_single_selection_get_model(gui->node_selection));
}

/* Opens the tree as far as the path of the selection is known, and goes on when more rows have come. */
static void reveal(struct gui *gui) {
    const struct node_query *path = &gui->revealed;
    bool known = true; /* else its row comes, and loses the mark */
    GtkTreeListRow *row = path->depth > 0 ? gtk_tree_list_model_get_child_row(model_of(gui), path->path[0]) : NULL;
    for (uint32_t i = 1; row && i < path->depth; i++) {
        gtk_tree_list_row_set_expanded(row, TRUE);
        GtkTreeListRow *child = gtk_tree_list_row_get_child_row(row, path->path[i]);
        GrayNode *node = child ? gtk_tree_list_row_get_item(child) : NULL;
        known = node && node->list->rows[node->at].kind[0];
        if (node && !known)
            want_rows(gui, node->list, node->at);
        g_clear_object(&node);
        g_object_unref(row);
        row = child;
    }
    if (!row)
        return;
    guint at = gtk_tree_list_row_get_position(row);
    gui->updates = true;
    gtk_single_selection_set_selected(gui->node_selection, at);
    gui->updates = false;
    (void)gtk_widget_activate_action(gui->node_list, "list.scroll-to-item", "u", at);
    gui->revealed.depth = known ? 0 : path->depth;
    g_object_unref(row);
}

void gui_tree_show(struct gui *gui, const struct window_state *was) {
    const struct node_query *selected = &gui->state.selected;
    for (guint i = 0; i < gui->node_items->len; i++)
        show_eye(gui, gui->node_items->pdata[i]);
    if (memcmp(&was->selected, selected, sizeof *selected) == 0)
        return;
    gui->revealed = *selected;
    if (gtk_single_selection_get_model(gui->node_selection))
        reveal(gui);
}

/* Another tree: its root, and the lists beside it. */
static void reset(struct gui *gui) {
    const struct node_query above = {0};
    GtkTreeListModel *model =
        gtk_tree_list_model_new(nodes_new(gui, &above, NODE_SECTIONS), FALSE, FALSE, children_of, gui, NULL);
    gui->updates = true;
    gtk_single_selection_set_model(gui->node_selection, G_LIST_MODEL(model));
    gui->updates = false;
    gui->revealed = gui->state.selected;
    g_object_unref(model);
}

/* Search: the rows that were found, each a button. */

static void select_found(GtkButton *button, gpointer data) {
    struct window_event event = {.kind = WINDOW_SELECT};
    event.node.serial = GPOINTER_TO_UINT(g_object_get_data(G_OBJECT(button), "serial"));
    gui_send_event(data, &event);
}

static void show_found(struct gui *gui, const struct node_rows *rows) {
    GtkWidget *child;
    while ((child = gtk_widget_get_first_child(gui->found)))
        gtk_box_remove(GTK_BOX(gui->found), child);
    for (uint32_t i = 0; i < rows->count; i++) {
        char *text = g_strdup_printf("%s  %s", rows->rows[i].name, rows->rows[i].kind);
        GtkWidget *button = gtk_button_new_with_label(text);
        gtk_button_set_has_frame(GTK_BUTTON(button), FALSE);
        gtk_label_set_xalign(GTK_LABEL(gtk_button_get_child(GTK_BUTTON(button))), 0);
        g_object_set_data(G_OBJECT(button), "serial", GUINT_TO_POINTER(rows->rows[i].serial));
        g_signal_connect(button, "clicked", G_CALLBACK(select_found), gui);
        gtk_box_append(GTK_BOX(gui->found), button);
        g_free(text);
    }
    GtkWidget *first = gtk_widget_get_first_child(gui->found);
    if (gui->takes_found && first) { /* the next keys are for the picture */
        select_found(GTK_BUTTON(first), gui);
        gtk_widget_grab_focus(gui->picture);
    }
    gui->takes_found = false;
    if (rows->count == 0 || rows->count == NODE_ROWS)
        gtk_box_append(GTK_BOX(gui->found), gtk_label_new(rows->count == 0 ? "No such node" : "… and others"));
}

static void search_changed(GtkSearchEntry *entry, gpointer data) {
    struct gui *gui = data;
    const char *text = gtk_editable_get_text(GTK_EDITABLE(entry));
    struct window_event event = {.kind = WINDOW_NODES};
    (void)g_strlcpy(event.node.search, text, sizeof event.node.search);
    gtk_stack_set_visible_child_name(GTK_STACK(gui->tree_pages), text[0] ? "found" : "tree");
    if (text[0])
        gui_send_event(gui, &event);
}

/* Return takes the first one that is found. */
static void search_done(GtkSearchEntry *entry, gpointer data) {
    struct gui *gui = data;
    gui->takes_found = true;
    search_changed(entry, gui);
}

void gui_tree_receive(struct gui *gui, const struct window_order *order) {
    const struct node_query *query = &order->query;
    const struct node_rows *rows = &order->rows;
    if (order->reset) {
        reset(gui);
        return;
    }
    if (query->search[0]) {
        show_found(gui, rows);
        return;
    }
    for (guint i = 0; i < gui->open_nodes->len; i++) {
        GrayNodes *nodes = gui->open_nodes->pdata[i];
        bool same = nodes->query.depth == query->depth &&
                    memcmp(nodes->query.path, query->path, query->depth * sizeof *query->path) == 0;
        guint count = same && query->first < nodes->count ? MIN(rows->count, nodes->count - query->first) : 0;
        if (count == 0)
            continue;
        memcpy(nodes->rows + query->first, rows->rows, count * sizeof *rows->rows);
        gui->updates = true;
        g_list_model_items_changed(G_LIST_MODEL(nodes), query->first, count, count);
        gui->updates = false;
        break; /* the change may open and close lists */
    }
    /* The children of the root are what one wants to see first. */
    GtkTreeListRow *root = gtk_tree_list_model_get_row(model_of(gui), 0);
    if (root && query->depth == 0)
        gtk_tree_list_row_set_expanded(root, TRUE);
    g_clear_object(&root);
    reveal(gui);
}

static GtkWidget *scrolled(GtkWidget *child) {
    GtkWidget *window = gtk_scrolled_window_new();
    gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(window), child);
    gtk_widget_set_vexpand(window, TRUE);
    return window;
}

GtkWidget *gui_tree_new(struct gui *gui) {
    GtkWidget *box = gtk_box_new(GTK_ORIENTATION_VERTICAL, 0), *search = gui->node_search = gtk_search_entry_new();
    GtkListItemFactory *factory = gtk_signal_list_item_factory_new();
    gui->open_nodes = g_ptr_array_new();
    gui->node_items = g_ptr_array_new();
    gui->node_selection = gtk_single_selection_new(NULL);
    gtk_single_selection_set_autoselect(gui->node_selection, FALSE);
    gtk_single_selection_set_can_unselect(gui->node_selection, TRUE);
    g_signal_connect(gui->node_selection, "notify::selected-item", G_CALLBACK(select_row), gui);
    g_signal_connect(factory, "setup", G_CALLBACK(make_row), gui);
    g_signal_connect(factory, "bind", G_CALLBACK(show_row), gui);
    g_signal_connect(factory, "unbind", G_CALLBACK(forget_row), gui);
    g_signal_connect(search, "search-changed", G_CALLBACK(search_changed), gui);
    g_signal_connect(search, "activate", G_CALLBACK(search_done), gui);
    gui->node_list = gtk_list_view_new(GTK_SELECTION_MODEL(gui->node_selection), factory);
    gui->found = gtk_box_new(GTK_ORIENTATION_VERTICAL, 0);
    gui->tree_pages = gtk_stack_new();
    gtk_stack_add_named(GTK_STACK(gui->tree_pages), scrolled(gui->node_list), "tree");
    gtk_stack_add_named(GTK_STACK(gui->tree_pages), scrolled(gui->found), "found");
    gui_name(gui->node_list, "Nodes");
    gui_name(search, "Search a node by its name or kind");
    gtk_box_append(GTK_BOX(box), search);
    gtk_box_append(GTK_BOX(box), gui->tree_pages);
    gtk_widget_set_size_request(box, 150, -1);
    return box;
}
