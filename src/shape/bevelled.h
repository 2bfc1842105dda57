/* Solids with bevelled edges: what several simpler solids cover together, whose surfaces touch without an edge, or what
 * all of them cover. A rounded prism is the prism of the inset outline, a lower one of the outline, and balls that run
 * along the inset one; a rounded cylinder likewise; a chamfered one is where two frustums meet. Closed. Owner: the
 * arena it was built in. */
#ifndef GRAY_SHAPE_BEVELLED_H
#define GRAY_SHAPE_BEVELLED_H

#include "base/bundle.h"
#include "shape/prism.h"

struct bevelled;

/* A prism whose edges are rounded, but for those where the outline turns inwards. work: an arena for what is needed
 * meanwhile. Errors: those of prism_build; the radius is too large. */
const struct bevelled *bevelled_prism(struct arena *arena, struct arena *work, const struct prism_input *input,
                                      double radius, struct error *error);
/* 0 < edge < radius and less than half of the length. Chamfered: its ends are cut at 45 degrees. Errors: no memory. */
struct bevelled_cylinder {
    struct vec3 from, to;
    double radius, edge;
    bool chamfer;
};
const struct bevelled *bevelled_cylinder(struct arena *arena, const struct bevelled_cylinder *input,
                                         struct error *error);
/* A prism as bevelled_prism leaves it where edges are cut at 45 degrees: the corners and faces of a closed mesh. */
struct chamfered_prism {
    double (*vertices)[3];
    uint32_t vertex_count, face_count;
    uint32_t *face_start, *vertex_index;
};
bool chamfered_prism(struct arena *arena, const struct prism_input *input, double edge, struct chamfered_prism *out,
                     struct error *error);

struct box bevelled_bounds(const struct bevelled *bevelled);
/* The least and the greatest dot(g, p) over the shape. */
void bevelled_extent(const struct bevelled *bevelled, struct vec3 g, double *lo, double *hi);
bool bevelled_crossings(const struct bevelled *bevelled, const struct ray *ray, struct geom_scratch *scratch,
                        struct crossing_list *out);
bool bevelled_contains(const struct bevelled *bevelled, struct vec3 point);
/* Image coordinates are those of the prism, sweep or cylinder that makes the surface there. */
void bevelled_describe(const struct bevelled *bevelled, const struct ray *ray, const struct crossing *crossing,
                       struct surface *out);
uint32_t bevelled_scratch_need(const struct bevelled *bevelled);
/* Copies what *bevelled points to (base/bundle.h). */
void bevelled_bundle(struct bundle *bundle, const struct bevelled **bevelled);

#endif
