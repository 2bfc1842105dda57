/* Children of a node of the authoring tree, as a window lists them: a part of them at a time, since there may be many.
 */
#ifndef GRAY_INSPECT_NODE_LIST_H
#define GRAY_INSPECT_NODE_LIST_H

#include "scene/node.h"

#include <stdint.h>

enum { NODE_LEVELS = 32, NODE_ROWS = 32, NODE_NAME = 64, NODE_SEARCH = 32 };

/* The first rows of a tree: the root, and lists of the lights, of the camera and of the materials. */
enum node_section { SECTION_NODES, SECTION_LIGHTS, SECTION_CAMERA, SECTION_MATERIALS, NODE_SECTIONS };

/* A node by the numbers of children from the root on, which is child 0 of what has depth 0; or, with depth 0, by its
 * serial, if that is not 0; and its first child that is wanted. Operands of solids are children after the others. With
 * a text the rows are the nodes whose name or kind has it, in any case. */
struct node_query {
    uint32_t depth, serial, first, path[NODE_LEVELS];
    char search[NODE_SEARCH];
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
/* The number of a child of a node; UINT32_MAX: it is none. */
uint32_t node_list_number(const struct node *node, const struct node *child);
/* The path of the first node with this serial; false: there is none within a million nodes. */
bool node_list_locate(const struct node *root, uint32_t serial, struct node_query *out);
/* The rows from query->first on; count is 0 where there is no such child. */
void node_list_rows(const struct node *root, const struct node_query *query, struct node_rows *out);

#endif
