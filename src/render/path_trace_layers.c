/* One path that records light layers and features. */
#define PATH(name) path_##name##_layers
#define LAYERS 1
#define OBSERVED 0
#define MATTER 1
#include "render/path_pieces_internal.h"
