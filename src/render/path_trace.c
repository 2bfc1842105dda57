/* One path, whose light alone is of interest, in a scene without light inside of matter. */
#define PATH(name) path_##name##_plain
#define LAYERS 0
#define OBSERVED 0
#define MATTER 0
#include "render/path_pieces_internal.h"

struct colour path_trace(const struct path_tracer *tracer, struct integrator_state *state, const struct ray *ray,
                         const struct packet_answer *met, bool ask, uint64_t key) {
    if (state->observer)
        return path_trace_observed(tracer, state, ray, met, ask, key);
    if (state->parts)
        return path_trace_layers(tracer, state, ray, met, ask, key);
    if (tracer->has_matter)
        return path_trace_matter(tracer, state, ray, met, ask, key);
    return path_trace_plain(tracer, state, ray, met, ask, key);
}
