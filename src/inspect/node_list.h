/* Children of a node of the authoring tree, as a window lists them: a part of them at a time, since there may be many.
 */
#ifndef GRAY_INSPECT_NODE_LIST_H
#define GRAY_INSPECT_NODE_LIST_H

#include "scene/node.h"

#include <stdint.h>

enum { NODE_LEVELS = 32, NODE_ROWS = 32, NODE_NAME = 64 };

/* A node by the numbers of children from the root on, which is child 0 of what has depth 0; and its first child that is
 * wanted. */
struct node_query {
    uint32_t depth, first, path[NODE_LEVELS];
};
struct node_row {
    uint32_t serial, children;
    char name[NODE_NAME], kind[16];
};
struct node_rows {
    uint32_t count;
    struct node_row rows[NODE_ROWS];
};

/* The node, or NULL: there is none, or it is what has depth 0. */
const struct node *node_list_find(const struct node *root, const struct node_query *query);
/* The rows from query->first on; count is 0 where there is no such child. Children of solids are not listed: they are
 * operands. */
void node_list_rows(const struct node *root, const struct node_query *query, struct node_rows *out);

#endif
