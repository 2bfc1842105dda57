/* Placements are turned into maps one by one while the scene is flattened, and only then. */
#include "scene/placements.h"

struct transform placement_transform(const struct placements *p, uint32_t i) {
    struct transform out = transform_identity();
    if (p->matrices) {
        (void)transform_from_affine(&p->matrices[i], &out); /* it was checked where it came in */
        return out;
    }
    if (p->size)
        out = transform_scale(vec3_all(p->size[p->one_size ? 0 : i]));
    if (p->turn) {
        struct transform turn = transform_rotate(p->axis, p->turn[p->one_turn ? 0 : i]);
        out = transform_compose(&turn, &out);
    }
    struct transform move = transform_translate(vec3_make(p->at[i][0], p->at[i][1], p->at[i][2]));
    return transform_compose(&move, &out);
}
