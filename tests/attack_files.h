/* The files of a row: statements that make them, and listings of what exists. For tests/attack.c. */
#ifndef GRAY_TESTS_ATTACK_FILES_H
#define GRAY_TESTS_ATTACK_FILES_H

#include "tests/attack.h"

#include <sys/stat.h>

enum { MAX_STREAMS = 16 };

/* The preparation of a row. */
struct attack_setup {
    const struct attack *attack;
    uid_t user;
    char root[512], in[600];
    int failures;
    char reason[1200];
    int readers[MAX_STREAMS], terminals[MAX_STREAMS], reader_count, terminal_count;
};

/* A listing of the row's folders. */
struct attack_entry {
    char path[1200]; /* below the row's folder */
    struct stat status;
    char *bytes; /* of a regular file, or where a link leads */
    size_t size;
    int watch; /* of a special file */
    bool may_differ;
};
struct attack_tree {
    struct attack_entry *entries;
    size_t count;
};

/* %XX is a byte; the length counts zeros. */
size_t attack_decode(char *text);
bool attack_put_scene(const char *path, const char *text);
/* Executes the statements of a row: those about modes, owners and ages if `late`, else the others. */
bool attack_statements(struct attack_setup *setup, const char *in, const char *all, bool late);

/* Everything below "in" and "out". */
struct attack_tree attack_tree(const char *root);
void attack_tree_free(struct attack_tree *tree);
struct attack_entry *attack_find(const struct attack_tree *tree, const char *path);
/* The first difference, or NULL. */
const char *attack_difference(const struct attack_entry *a, const struct attack_entry *b);
bool attack_begins(const struct attack_entry *entry, const char *bytes, size_t size);
/* Why this is not a picture as gray should write it, or NULL. */
const char *attack_wrong_picture(const struct attack_entry *entry);

#endif
