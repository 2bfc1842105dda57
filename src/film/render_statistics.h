/* What rendering a picture took, counted. */
#ifndef GRAY_FILM_RENDER_STATISTICS_H
#define GRAY_FILM_RENDER_STATISTICS_H

#include <stdbool.h>
#include <stdint.h>

/* Of a device process that makes samples. */
struct device_statistics {
    char name[128];         /* of the card; "": none made samples */
    double kernels_seconds; /* to load or compile them */
    double start_seconds;   /* from the driver to the last of the samples that try the card */
    double rate;            /* samples a second in a trial */
    uint64_t launches, lanes, bytes;
};

struct render_statistics {
    uint64_t camera_rays, reflected_rays, refracted_rays, shadow_rays;
    uint64_t pixels, marked_pixels, samples;
    uint64_t late_pixels; /* Whitted: the time limit was over, and they have fewer samples */
    uint64_t shape_tests, triangle_tests, box_tests, voxels, hierarchy_steps;
    uint64_t medium_events; /* where media scatter paths */
    uint64_t photons, photons_landed, photon_rays;
    uint64_t passes_samples; /* of each pixel where the samples came in passes, else 0 */
    bool noisy;              /* with --noise: a tile did not reach it, because of the limit of samples or time */
    bool out_of_time;        /* noisy because of the time */
    uint64_t clamped;        /* not 0: light beyond the largest float is clamped to it */
    /* Photons are part of the render, their map is part of them. */
    double build_seconds, render_seconds, photon_seconds, photon_map_seconds;
    double idle_seconds; /* of all threads: no tile was left, and others still made theirs */
    double build_processor_seconds, render_processor_seconds; /* of all threads of the process */
    struct device_statistics device; /* filled by the supervisor */
};

#endif
