/* Each open node has a list model of its children. The row of the node states how many there are. The model asks the
 * viewer for rows when they come into view, NODE_ROWS at a time. Closed nodes have no model. */
#include "viewer/gtk_tree_internal.h"

#include "viewer/gtk_window_internal.h"

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

static void make_row(GtkSignalListItemFactory *factory, GtkListItem *item, gpointer data) {
    GtkWidget *expander = gtk_tree_expander_new(), *label = gtk_label_new(NULL);
    (void)factory, (void)data;
    gtk_label_set_xalign(GTK_LABEL(label), 0);
    gtk_label_set_ellipsize(GTK_LABEL(label), PANGO_ELLIPSIZE_END);
    gtk_tree_expander_set_child(GTK_TREE_EXPANDER(expander), label);
    gtk_list_item_set_child(item, expander);
}

static void show_row(GtkSignalListItemFactory *factory, GtkListItem *item, gpointer data) {
    GtkTreeListRow *row = gtk_list_item_get_item(item);
    GrayNode *node = gtk_tree_list_row_get_item(row);
    GtkTreeExpander *expander = GTK_TREE_EXPANDER(gtk_list_item_get_child(item));
    const struct node_row *known = &node->list->rows[node->at];
    char *text = g_strdup_printf("%s  %s", known->name, known->kind);
    (void)factory;
    gtk_tree_expander_set_list_row(expander, row);
    gtk_label_set_text(GTK_LABEL(gtk_tree_expander_get_child(expander)), known->kind[0] ? text : "…");
    gtk_widget_set_tooltip_text(GTK_WIDGET(expander), known->kind[0] ? text : NULL);
    if (!known->kind[0])
        want_rows(data, node->list, node->at);
    g_free(text);
    g_object_unref(node);
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

/* Another tree: its root alone. */
static void reset(struct gui *gui) {
    const struct node_query above = {0};
    GtkTreeListModel *model = gtk_tree_list_model_new(nodes_new(gui, &above, 1), FALSE, FALSE, children_of, gui, NULL);
    gui->updates = true;
    gtk_single_selection_set_model(gui->node_selection, G_LIST_MODEL(model));
    gui->updates = false;
    g_object_unref(model);
}

void gui_tree_receive(struct gui *gui, const struct window_order *order) {
    const struct node_query *query = &order->query;
    const struct node_rows *rows = &order->rows;
    if (order->reset) {
        reset(gui);
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
    GtkTreeListRow *root =
        gtk_tree_list_model_get_row(GTK_TREE_LIST_MODEL(gtk_single_selection_get_model(gui->node_selection)), 0);
    if (root && query->depth == 0)
        gtk_tree_list_row_set_expanded(root, TRUE);
    g_clear_object(&root);
}

GtkWidget *gui_tree_new(struct gui *gui) {
    GtkWidget *scrolled = gtk_scrolled_window_new();
    GtkListItemFactory *factory = gtk_signal_list_item_factory_new();
    gui->open_nodes = g_ptr_array_new();
    gui->node_selection = gtk_single_selection_new(NULL);
    gtk_single_selection_set_autoselect(gui->node_selection, FALSE);
    gtk_single_selection_set_can_unselect(gui->node_selection, TRUE);
    g_signal_connect(gui->node_selection, "notify::selected-item", G_CALLBACK(select_row), gui);
    g_signal_connect(factory, "setup", G_CALLBACK(make_row), gui);
    g_signal_connect(factory, "bind", G_CALLBACK(show_row), gui);
    GtkWidget *list = gtk_list_view_new(GTK_SELECTION_MODEL(gui->node_selection), factory);
    gtk_accessible_update_property(GTK_ACCESSIBLE(list), GTK_ACCESSIBLE_PROPERTY_LABEL, "Nodes", -1);
    gtk_scrolled_window_set_child(GTK_SCROLLED_WINDOW(scrolled), list);
    gtk_widget_set_size_request(scrolled, 150, -1);
    return scrolled;
}
