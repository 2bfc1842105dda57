#include "inspect/node_list.h"

#include <stdio.h>
#include <string.h>

static const struct node_child *nth_child(const struct node *node, uint32_t n) {
    const struct node_child *child = node->first_child;
    while (child && n-- > 0)
        child = child->next;
    return child;
}

const struct node *node_list_find(const struct node *root, const struct node_query *query) {
    const struct node *node = query->depth > 0 && query->path[0] == 0 ? root : NULL;
    for (uint32_t i = 1; node && i < query->depth && i < NODE_LEVELS; i++) {
        const struct node_child *child = nth_child(node, query->path[i]);
        node = child ? child->node : NULL;
    }
    return node;
}

static const char *kind_of(const struct node *node) {
    switch (node->kind) {
    case NODE_GROUP:
        return node->placements ? "instances" : "group";
    case NODE_JOINT:
        return "joint";
    case NODE_GEOMETRY:
        return shape_kind_name(node->shape.kind);
    case NODE_CSG:
        return "solid";
    }
    return "";
}

static void add_row(struct node_rows *out, const struct node *node) {
    struct node_row *row = &out->rows[out->count++];
    *row = (struct node_row){.serial = node->serial, .children = node->child_count};
    (void)snprintf(row->name, sizeof row->name, "%s", node->name);
    (void)snprintf(row->kind, sizeof row->kind, "%s", kind_of(node));
    for (char *c = row->name; *c; c++)
        *c = (unsigned char)*c < 32 || *c == 127 ? '?' : *c;
}

void node_list_rows(const struct node *root, const struct node_query *query, struct node_rows *out) {
    const struct node *node = node_list_find(root, query);
    memset(out, 0, sizeof *out);
    if (query->depth == 0 && query->first == 0)
        add_row(out, root);
    for (const struct node_child *c = node ? nth_child(node, query->first) : NULL; c && out->count < NODE_ROWS;
         c = c->next)
        add_row(out, c->node);
}
