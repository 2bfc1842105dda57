#include "inspect/node_list.h"

#include <stdio.h>
#include <string.h>

static uint32_t operand_count(const struct node *node) {
    return node->kind == NODE_CSG ? node->operand_count : 0;
}

/* The children of a node from one on; linked ones first, then operands. */
struct child_iterator {
    const struct node *node;
    const struct node_child *link;
    uint32_t operand;
};

static struct child_iterator children_from(const struct node *node, uint32_t n) {
    struct child_iterator next = {node, node->first_child, n > node->child_count ? n - node->child_count : 0};
    while (next.link && n-- > 0)
        next.link = next.link->next;
    return next;
}

/* The next one, or NULL. */
static const struct node *next_child(struct child_iterator *next) {
    const struct node_child *link = next->link;
    if (link) {
        next->link = link->next;
        return link->node;
    }
    return next->operand < operand_count(next->node) ? next->node->operands[next->operand++] : NULL;
}

const struct node *node_list_find(const struct node *root, const struct node_query *query) {
    const struct node *node = query->depth > 0 && query->path[0] == 0 ? root : NULL;
    for (uint32_t i = 1; node && i < query->depth && i < NODE_LEVELS; i++) {
        struct child_iterator next = children_from(node, query->path[i]);
        node = next_child(&next);
    }
    return node;
}

uint32_t node_list_number(const struct node *node, const struct node *child) {
    struct child_iterator next = children_from(node, 0);
    uint32_t number = 0;
    for (const struct node *at; (at = next_child(&next)) && at != child;)
        number++;
    return number < node->child_count + operand_count(node) ? number : UINT32_MAX;
}

bool node_list_locate(const struct node *root, uint32_t serial, struct node_query *out) {
    struct child_iterator levels[NODE_LEVELS];
    uint32_t visited = 0;
    *out = (struct node_query){.depth = 1};
    levels[0] = children_from(root, 0);
    if (root->serial == serial)
        return true;
    for (; out->depth > 0 && visited < 1000000; visited++) {
        const struct node *node = next_child(&levels[out->depth - 1]);
        if (!node) {
            out->depth--;
            out->path[out->depth]++;
            continue;
        }
        if (out->depth == NODE_LEVELS) {
            continue;
        }
        levels[out->depth++] = children_from(node, 0);
        if (node->serial == serial)
            return true;
        if (out->depth < NODE_LEVELS)
            out->path[out->depth] = 0;
    }
    return false;
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
    *row = (struct node_row){.serial = node->serial, .children = node->child_count + operand_count(node)};
    (void)snprintf(row->name, sizeof row->name, "%s", node->name);
    (void)snprintf(row->kind, sizeof row->kind, "%s", kind_of(node));
    for (char *c = row->name; *c; c++)
        *c = (unsigned char)*c < 32 || *c == 127 ? '?' : *c;
}

/* Whether the text is in it, in any case of ASCII. */
static bool has_text(const char *name, const char *text) {
    size_t length = strlen(text);
    for (; *name; name++) {
        size_t i = 0;
        while (i < length && name[i] && (name[i] | 32) == (text[i] | 32))
            i++;
        if (i == length)
            return true;
    }
    return false;
}

/* The first nodes with the text, each once for its place in the tree, within a million nodes. */
static void search(const struct node *root, const char *text, struct node_rows *out) {
    struct child_iterator levels[NODE_LEVELS];
    uint32_t depth = 1, visited = 0;
    levels[0] = children_from(root, 0);
    while (depth > 0 && out->count < NODE_ROWS && visited++ < 1000000) {
        const struct node *node = next_child(&levels[depth - 1]);
        if (!node)
            depth--;
        else if (has_text(node->name, text) || has_text(kind_of(node), text))
            add_row(out, node);
        if (node && depth < NODE_LEVELS)
            levels[depth++] = children_from(node, 0);
    }
}

void node_list_rows(const struct node *root, const struct node_query *query, struct node_rows *out) {
    const struct node *node = node_list_find(root, query), *child;
    memset(out, 0, sizeof *out);
    if (query->search[0] != '\0') {
        search(root, query->search, out);
        return;
    }
    if (query->depth == 0 && query->first == 0)
        add_row(out, root);
    if (!node)
        return;
    for (struct child_iterator next = children_from(node, query->first);
         out->count < NODE_ROWS && (child = next_child(&next));)
        add_row(out, child);
}
