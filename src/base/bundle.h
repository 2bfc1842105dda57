/* A bundle: structures that point to each other, copied into one block of bytes that works at any address.
 *
 * Each module says what its structures point to: a bundle_fields for one that is in the bundle, itself or as a part of
 * another. It copies what the fields point to, in turn; fields that the reader does not need are set to NULL.
 *
 *     void part_tree_bundle(struct bundle *bundle, void *part_tree) {
 *         struct part_tree *tree = part_tree;
 *         BUNDLE(bundle, tree->nodes, tree->node_count, NULL);
 *     }
 *
 * What has been copied, from that address and no smaller, is not copied again, so that what was shared stays so. */
#ifndef GRAY_BASE_BUNDLE_H
#define GRAY_BASE_BUNDLE_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct bundle;
typedef void bundle_fields(struct bundle *bundle, void *element);

/* The bundle of one structure and of all that it points to. What has no fields of its own is borrowed until
 * bundle_write. NULL: no memory. */
struct bundle *bundle_create(const void *root, size_t size, bundle_fields *fields);
void bundle_destroy(struct bundle *bundle); /* NULL is fine */
/* Called by a bundle_fields: copies the `count` elements that the pointer in `field` points to, unless it is NULL.
 * fields: of each; NULL: they point to nothing. */
void bundle_point(struct bundle *bundle, void *field, size_t count, size_t size, bundle_fields *fields);
#define BUNDLE(bundle, pointer, count, fields) bundle_point(bundle, &(pointer), count, sizeof *(pointer), fields)

size_t bundle_size(const struct bundle *bundle);
/* The bytes, from 8 bytes on at a multiple of 64. */
void bundle_write(const struct bundle *bundle, void *out);
/* The structure at the root of bytes that bundle_write wrote, to be called once: pointers get their values for bytes
 * that lie at `address` when they are followed. Everything is checked but what the structures contain. Errors: these
 * are not a bundle of such a root. */
void *bundle_open(void *bytes, size_t size, uint64_t address, size_t root_size, struct error *error);

#endif
