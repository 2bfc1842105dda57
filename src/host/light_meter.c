/* A light meter: a small draft of the whole picture is rendered first, and its luminances decide the exposure. The
 * draft depends neither on the crop nor on shards, threads and machines, so all parts of a picture have the same
 * exposure, and everything after it knows only the number. */
#include "host/light_meter_internal.h"

#include "base/mem.h"
#include "math/elementary.h"
#include "render/integrator.h"
#include "render/render.h"

#include <math.h>
#include <stdlib.h>

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Bright surfaces, brighter than 19 of 20 pixels, come to lie a little below white; but the mean of the picture is at
 * least dark gray, even if windows then lose their details. Black pixels do not count. A 64th of a stop is not seen. */
static double exposure_of(const struct film *film, double *luminances) {
    const double bright = 0.8, dark = 0.13;
    size_t count = 0;
    double sum = 0;
    for (size_t i = 0; i < (size_t)film->width * film->height; i++) {
        const float *rgb = film->pixels[i].rgb;
        double luminance = 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
        if (luminance > 1e-30)
            luminances[count++] = luminance;
    }
    if (count == 0)
        return 0;
    qsort(luminances, count, sizeof *luminances, compare);
    for (size_t i = 0; i < count; i++)
        sum += el_log2(luminances[i]);
    double mean = el_exp2(sum / (double)count), high = luminances[(count - 1) * 95 / 100];
    double stops = el_log2(math_max(bright / high, dark / mean));
    return floor(math_min(math_max(stops, -EXPOSURE_MAX), EXPOSURE_MAX) * 64 + 0.5) / 64;
}

static bool measure(const struct render_job *job, struct pool *pool, double *stops, struct error *error) {
    struct render_statistics ignored = {0};
    struct film *film = job->film;
    size_t bytes;
    struct film_record record = render_record(&job->settings);
    if (!film_size(job->width, job->height, record, &bytes, error))
        return false;
    void *block = mem_alloc_zero(1, bytes);
    double *luminances = mem_alloc(sizeof(double) * job->width * job->height);
    if (block && luminances)
        film_layout(film, block, job->width, job->height, record);
    film->full_width = job->width;
    film->full_height = job->height;
    bool ok = block && luminances ? render_run(job, pool, &ignored, error) : error_no_memory(error, "a light meter");
    if (ok)
        *stops = exposure_of(film, luminances);
    mem_free(block);
    mem_free(luminances);
    return ok;
}

bool light_meter_measure(struct picture_work *work, struct error *error) {
    enum { WIDTH = 96 };
    struct render_process *process = work->process;
    const struct options *options = process->options;
    double *stops = &work->job.settings.tone.exposure;
    if (*stops <= EXPOSURE_MAX)
        return true;
    /* What renders no picture needs no measurement. */
    *stops = 0;
    if (options->check || options->dump_scene || options->dump_expr)
        return true;
    struct film film = {.width = 0};
    struct world world;
    struct render_job job = {.world = &world,
                             .camera = work->job.camera,
                             .settings = work->job.settings,
                             .ambient = work->job.ambient,
                             .background_lights = work->job.background_lights,
                             .radiosity = work->job.radiosity,
                             .film = &film};
    /* A small, quick picture without what the brightness does not depend on. */
    struct lens *lens = &job.settings.lens;
    double width = work->job.width, height = work->job.height;
    if (lens->columns > 0) { /* the middle of a light field */
        width /= lens->columns;
        height /= (double)lens->rows * lens_grids(lens);
        lens->rows = lens->columns = 0;
    }
    double scale = math_min(1, (double)WIDTH / math_max(width, height));
    job.width = (uint32_t)math_max(width * scale, 1);
    job.height = (uint32_t)math_max(height * scale, 1);
    settings_set_draft(&job.settings, DRAFT_QUICK);
    job.settings.cropped = false;
    job.settings.noise = job.settings.time_limit = 0;
    job.settings.aov = 0;
    struct render_area area;
    char warning[256];
    if (!render_prepare(&job, &area, warning, error))
        return false;

    /* The world is charged to the scene, like that of the picture. */
    (void)mem_charge(process->account);
    const struct world_input input = render_process_world_input(work);
    bool ok = world_build(&world, &input, &process->job, process->pool, error);
    if (ok) {
        ok = measure(&job, process->pool, stops, error);
        world_destroy(&world);
    }
    arena_reset(&process->job);
    (void)mem_charge(NULL);
    return ok;
}
