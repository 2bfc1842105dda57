/* Both forms use the same list of numbers, so they cannot differ. */
#include "output/statistics_internal.h"

#include "session/text.h"

#include <inttypes.h>

enum figure_form { FIGURE_COUNT, FIGURE_SECONDS, FIGURE_BYTES, FIGURE_RATE };

struct figure {
    const char *key, *title;
    enum figure_form form;
    double value; /* of seconds and rates */
    uint64_t count;
};

static uint64_t all_rays(const struct render_statistics *rays) {
    return rays->camera_rays + rays->reflected_rays + rays->refracted_rays + rays->shadow_rays + rays->photon_rays;
}

static double ratio(uint64_t a, uint64_t b) {
    return b > 0 ? (double)a / (double)b : 0;
}

static void print_figures(FILE *stream, const struct picture_report *report,
                          void (*print)(FILE *stream, const struct figure *figure)) {
    const struct render_statistics *rays = &report->rays;
    uint64_t sum = all_rays(rays);
    const struct figure all[] = {
        {"build_seconds", "build", FIGURE_SECONDS, rays->build_seconds, 0},
        {"render_seconds", "render", FIGURE_SECONDS, rays->render_seconds, 0},
        {"write_seconds", "write", FIGURE_SECONDS, report->write_seconds, 0},
        {"idle_seconds", "idle at the end", FIGURE_SECONDS, rays->idle_seconds, 0},
        {"build_processor_seconds", "processors: build", FIGURE_SECONDS, rays->build_processor_seconds, 0},
        {"render_processor_seconds", "render", FIGURE_SECONDS, rays->render_processor_seconds, 0},
        {"write_processor_seconds", "write", FIGURE_SECONDS, report->write_processor_seconds, 0},
        {"threads", "threads", FIGURE_COUNT, 0, (uint64_t)report->threads},
        {"pixels", "pixels", FIGURE_COUNT, 0, rays->pixels},
        {"marked_pixels", "marked pixels", FIGURE_COUNT, 0, rays->marked_pixels},
        {"samples", "samples", FIGURE_COUNT, 0, rays->samples},
        {"camera_rays", "camera rays", FIGURE_COUNT, 0, rays->camera_rays},
        {"reflected_rays", "reflected rays", FIGURE_COUNT, 0, rays->reflected_rays},
        {"refracted_rays", "refracted rays", FIGURE_COUNT, 0, rays->refracted_rays},
        {"shadow_rays", "shadow rays", FIGURE_COUNT, 0, rays->shadow_rays},
        {"medium_events", "scatterings in media", FIGURE_COUNT, 0, rays->medium_events},
        {"photons", "photons sent", FIGURE_COUNT, 0, rays->photons},
        {"photons_landed", "photons kept", FIGURE_COUNT, 0, rays->photons_landed},
        {"photon_rays", "rays of photons", FIGURE_COUNT, 0, rays->photon_rays},
        {"photon_seconds", "photons", FIGURE_SECONDS, rays->photon_seconds, 0},
        {"photon_map_seconds", "their map", FIGURE_SECONDS, rays->photon_map_seconds, 0},
        {"rays", "rays", FIGURE_COUNT, 0, sum},
        {"voxels", "voxels visited", FIGURE_COUNT, 0, rays->voxels},
        {"hierarchy_steps", "hierarchy steps", FIGURE_COUNT, 0, rays->hierarchy_steps},
        {"box_tests", "box tests", FIGURE_COUNT, 0, rays->box_tests},
        {"shape_tests", "shape tests", FIGURE_COUNT, 0, rays->shape_tests},
        {"triangle_tests", "triangle tests", FIGURE_COUNT, 0, rays->triangle_tests},
        {"voxels_per_ray", "voxels a ray", FIGURE_RATE, ratio(rays->voxels, sum), 0},
        {"hierarchy_steps_per_ray", "steps a ray", FIGURE_RATE, ratio(rays->hierarchy_steps, sum), 0},
        {"triangle_tests_per_ray", "triangles a ray", FIGURE_RATE, ratio(rays->triangle_tests, sum), 0},
        {"rays_per_pixel", "rays a pixel", FIGURE_RATE, ratio(sum, rays->pixels), 0},
        {"voxels_per_pixel", "voxels a pixel", FIGURE_RATE, ratio(rays->voxels, rays->pixels), 0},
        {"hierarchy_steps_per_pixel", "steps a pixel", FIGURE_RATE, ratio(rays->hierarchy_steps, rays->pixels), 0},
        {"triangle_tests_per_pixel", "triangles a pixel", FIGURE_RATE, ratio(rays->triangle_tests, rays->pixels), 0},
        {"primitives", "primitives", FIGURE_COUNT, 0, report->primitives},
        {"triangles", "triangles", FIGURE_COUNT, 0, report->triangles},
        {"node_bytes", "memory: nodes", FIGURE_BYTES, 0, report->node_bytes},
        {"mesh_bytes", "meshes", FIGURE_BYTES, 0, report->mesh_bytes},
        {"image_bytes", "images", FIGURE_BYTES, 0, report->image_bytes},
        {"placed_bytes", "placed things", FIGURE_BYTES, 0, report->primitive_bytes},
        {"search_bytes", "search of them", FIGURE_BYTES, 0, report->search_bytes},
        {"film_bytes", "film", FIGURE_BYTES, 0, report->film_bytes},
        {"peak_bytes", "peak memory", FIGURE_BYTES, 0, report->peak_bytes},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        print(stream, &all[i]);
}

static void print_device_figures(FILE *stream, const struct device_statistics *device,
                                 void (*print)(FILE *stream, const struct figure *figure)) {
    const struct figure all[] = {
        {"kernels_seconds", "its kernels", FIGURE_SECONDS, device->kernels_seconds, 0},
        {"device_start_seconds", "its start", FIGURE_SECONDS, device->start_seconds, 0},
        {"launches", "launches", FIGURE_COUNT, 0, device->launches},
        {"lanes", "lanes of an order", FIGURE_COUNT, 0, device->lanes},
        {"device_bytes", "its memory", FIGURE_BYTES, 0, device->bytes},
        {"device_rate", "in a trial, a second", FIGURE_COUNT, 0,
         (uint64_t)(device->rate > 0 ? device->rate : 0)}, /* of `auto` */
    };
    const size_t count = sizeof all / sizeof *all - (device->rate > 0 ? 0 : 1);
    for (size_t i = 0; i < count; i++)
        print(stream, &all[i]);
}

static void print_text(FILE *stream, const struct figure *figure) {
    switch (figure->form) {
    case FIGURE_COUNT:
        (void)fprintf(stream, "  %-20s %14" PRIu64 "\n", figure->title, figure->count);
        return;
    case FIGURE_SECONDS:
        (void)fprintf(stream, "  %-20s %14.3f s\n", figure->title, figure->value);
        return;
    case FIGURE_RATE:
        (void)fprintf(stream, "  %-20s %14.2f\n", figure->title, figure->value);
        return;
    case FIGURE_BYTES:
        (void)fprintf(stream, "  %-20s %14.1f MB\n", figure->title, 1e-6 * (double)figure->count);
        return;
    }
}

static void print_json(FILE *stream, const struct figure *figure) {
    if (figure->form == FIGURE_SECONDS || figure->form == FIGURE_RATE)
        (void)fprintf(stream, ",\"%s\":%.6f", figure->key, figure->value);
    else
        (void)fprintf(stream, ",\"%s\":%" PRIu64, figure->key, figure->count);
}

void statistics_print_text(FILE *stream, const char *name, const struct picture_request *request,
                           const struct picture_report *report) {
    text_print_scene_line(stream, name);
    (void)fprintf(stream, "  %-20s %14" PRIu32 " x %" PRIu32 "\n", "size", request->width, request->height);
    print_figures(stream, report, print_text);
    (void)fprintf(stream, "  %-20s %14" PRIu32 " x %" PRIu32 " x %" PRIu32 "\n", "voxels of the scene",
                  report->grid_cells[0], report->grid_cells[1], report->grid_cells[2]);
    if (report->rays.device.name[0]) {
        (void)fprintf(stream, "  %-20s %s\n", "device", report->rays.device.name);
        print_device_figures(stream, &report->rays.device, print_text);
    }
    if (report->rays.render_seconds > 0)
        (void)fprintf(stream, "  %-20s %14.0f\n", "rays per second",
                      (double)all_rays(&report->rays) / report->rays.render_seconds);
}

void statistics_print_json(FILE *stream, const char *name, const struct picture_request *request,
                           const struct picture_report *report) {
    (void)fputs("{\"picture\":", stream);
    text_print_json(stream, name);
    (void)fprintf(stream, ",\"width\":%" PRIu32 ",\"height\":%" PRIu32, request->width, request->height);
    print_figures(stream, report, print_json);
    if (report->rays.device.name[0]) {
        (void)fputs(",\"device\":", stream);
        text_print_json(stream, report->rays.device.name);
        print_device_figures(stream, &report->rays.device, print_json);
    }
    (void)fprintf(stream, ",\"grid_cells\":[%" PRIu32 ",%" PRIu32 ",%" PRIu32 "]}\n", report->grid_cells[0],
                  report->grid_cells[1], report->grid_cells[2]);
    (void)fflush(stream);
}
