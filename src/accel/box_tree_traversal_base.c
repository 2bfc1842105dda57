/* The traversal for the baseline processor. */
#define TRAVERSAL(name) box_tree_traversal_##name##_base
#include "accel/box_tree_traversal_internal.h"
