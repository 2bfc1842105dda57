/* One path with an observer. */
#define PATH(name) path_##name##_observed
#define LAYERS 1
#define OBSERVED 1
#define MATTER 1
#include "render/path_pieces_internal.h"
