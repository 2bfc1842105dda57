/* The walk for the processor every build runs on. */
#define WALK(name) box_tree_walk_##name##_base
#include "accel/box_tree_walk.h"
