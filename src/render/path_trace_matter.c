/* One path in a scene with light inside of matter. */
#define PATH(name) path_##name##_matter
#define LAYERS 0
#define OBSERVED 0
#define MATTER 1
#include "render/path_pieces_internal.h"
