/* See outlook.h. */
#include "render/outlook.h"

#include <stddef.h>

double outlook_share(const struct outlook *outlook) {
    uint64_t all = atomic_load_explicit(&outlook->all, memory_order_acquire);
    uint64_t done = atomic_load_explicit(&outlook->done, memory_order_relaxed);
    if (all == 0)
        return -1;
    return done < all ? (double)done / (double)all : 1;
}

double outlook_left(const struct outlook *outlook, double now) {
    double share = outlook_share(outlook), begun = 1e-9 * (double)atomic_load(&outlook->begun);
    if (!(share > 0) || now < begun)
        return -1;
    return (now - begun) * (1 - share) / share;
}
