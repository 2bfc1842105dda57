/* The search for crossings with an implicit solid. */
#ifndef GRAY_SHAPE_IMPLICIT_SEARCH_INTERNAL_H
#define GRAY_SHAPE_IMPLICIT_SEARCH_INTERNAL_H

#include "shape/implicit_internal.h"

/* The same as shape_crossings and shape_nearest. A crossing is at most 1e-9 of the size of the solid from the point
 * where the sign changes. Two crossings that are closer than 1e-7 of the size may be missed together. */
bool implicit_crossings(const struct implicit *solid, const struct ray *ray, struct geom_scratch *scratch,
                        struct crossing_list *out);
bool implicit_nearest(const struct implicit *solid, const struct ray *ray, struct geom_scratch *scratch,
                      struct crossing *out);
/* Whether there is a crossing in the ray's interval. Faster than implicit_nearest: it does not locate the crossing. */
bool implicit_any(const struct implicit *solid, const struct ray *ray, struct geom_scratch *scratch);
/* Of rays of a preview, at most EXPR_BATCH: the same as shape_takes_packets and shape_nearest_packet. */
bool implicit_takes_packets(const struct implicit *solid, const struct geom_scratch *scratch);
uint64_t implicit_nearest_packet(const struct implicit *solid, const struct ray *rays, uint64_t active,
                                 struct geom_scratch *scratch, struct crossing *out);
/* The operations that the search for all crossings of a line needs, beyond `limit` about that number. */
uint64_t implicit_line_work(const struct implicit *solid, const struct ray *ray, uint64_t limit,
                            struct geom_scratch *scratch);

#endif
