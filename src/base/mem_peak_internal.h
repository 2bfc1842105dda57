/* The memory of all blocks together, for tests. */
#ifndef GRAY_BASE_MEM_PEAK_INTERNAL_H
#define GRAY_BASE_MEM_PEAK_INTERNAL_H

#include <stdint.h>

/* Bytes of all blocks together: now, from where the peak is counted from now on, and at most since then. 0 in builds
 * without GRAY_FAULTS. A block that is resized counts once. */
uint64_t mem_peak_begin(void);
uint64_t mem_peak(void);

#endif
