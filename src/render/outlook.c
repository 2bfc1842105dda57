/* What is told is the moment of the end and not the time left: between two forecasts the latter falls as the clock
 * goes. See outlook.h. */
#include "render/outlook.h"

#include <stddef.h>

void outlook_reset(struct outlook *outlook, bool wanted) {
    atomic_store(&outlook->share, 0);
    atomic_store(&outlook->ends, 0);
    atomic_store(&outlook->pace, 0);
    atomic_store(&outlook->begun, wanted ? OUTLOOK_WANTED : 0);
}

bool outlook_is_asked(const struct outlook *outlook) {
    return atomic_load(&outlook->begun) != 0;
}

void outlook_tell(struct outlook *outlook, double done, double left, uint64_t now) {
    uint64_t begun = atomic_load_explicit(&outlook->begun, memory_order_relaxed);
    uint64_t before = atomic_load_explicit(&outlook->share, memory_order_relaxed);
    uint64_t share = 1 + (uint64_t)(1e9 * (done > 0 ? done / (done + left) : 0));
    if (share > before)
        atomic_store_explicit(&outlook->share, share, memory_order_relaxed);
    if (done > 0 && now > begun)
        atomic_store_explicit(&outlook->ends, now + (uint64_t)((double)(now - begun) * (left / done)),
                              memory_order_relaxed);
}

double outlook_pace(const struct outlook *outlook) {
    uint64_t pace = atomic_load_explicit(&outlook->pace, memory_order_relaxed);
    return pace > 0 && pace < 1000000 ? 1e-3 * (double)pace : 1;
}

double outlook_share(const struct outlook *outlook) {
    uint64_t share = atomic_load_explicit(&outlook->share, memory_order_relaxed);
    if (share == 0)
        return -1;
    return share < 1000000001 ? 1e-9 * (double)(share - 1) : 1;
}

double outlook_left(const struct outlook *outlook, double now) {
    uint64_t ends = atomic_load_explicit(&outlook->ends, memory_order_relaxed);
    if (ends == 0)
        return -1;
    double left = 1e-9 * (double)ends - now;
    return left > 0 ? left : 0;
}
