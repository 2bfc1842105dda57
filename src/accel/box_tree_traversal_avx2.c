/* The traversal with vectors of four doubles. This file is compiled for AVX2, and nothing in it runs before isa.c
 * has detected AVX2. */
#if defined(__AVX2__)
#define TRAVERSAL(name) box_tree_traversal_##name##_avx2
#include "accel/box_tree_traversal_internal.h"
#else
#include "accel/box_tree.h"
#endif
