/* The estimate is the moment of the end and not the time left: between two forecasts the latter falls as the clock
 * goes. See progress_estimate.h. */
#include "render/progress_estimate.h"

#include <stddef.h>

void progress_estimate_reset(struct progress_estimate *progress_estimate, bool wanted) {
    atomic_store(&progress_estimate->share, 0);
    atomic_store(&progress_estimate->ends, 0);
    atomic_store(&progress_estimate->pace, 0);
    atomic_store(&progress_estimate->begun, wanted ? PROGRESS_ESTIMATE_WANTED : 0);
}

bool progress_estimate_is_wanted(const struct progress_estimate *progress_estimate) {
    return atomic_load(&progress_estimate->begun) != 0;
}

void progress_estimate_report(struct progress_estimate *progress_estimate, double done, double left, uint64_t now) {
    uint64_t begun = atomic_load_explicit(&progress_estimate->begun, memory_order_relaxed);
    uint64_t before = atomic_load_explicit(&progress_estimate->share, memory_order_relaxed);
    uint64_t share = 1 + (uint64_t)(1e9 * (done > 0 ? done / (done + left) : 0));
    if (share > before)
        atomic_store_explicit(&progress_estimate->share, share, memory_order_relaxed);
    if (done > 0 && now > begun)
        atomic_store_explicit(&progress_estimate->ends, now + (uint64_t)((double)(now - begun) * (left / done)),
                              memory_order_relaxed);
}

double progress_estimate_pace(const struct progress_estimate *progress_estimate) {
    uint64_t pace = atomic_load_explicit(&progress_estimate->pace, memory_order_relaxed);
    return pace > 0 && pace < 1000000 ? 1e-3 * (double)pace : 1;
}

double progress_estimate_share(const struct progress_estimate *progress_estimate) {
    uint64_t share = atomic_load_explicit(&progress_estimate->share, memory_order_relaxed);
    if (share == 0)
        return -1;
    return share < 1000000001 ? 1e-9 * (double)(share - 1) : 1;
}

double progress_estimate_left(const struct progress_estimate *progress_estimate, double now) {
    uint64_t ends = atomic_load_explicit(&progress_estimate->ends, memory_order_relaxed);
    if (ends == 0)
        return -1;
    double left = 1e-9 * (double)ends - now;
    return left > 0 ? left : 0;
}
