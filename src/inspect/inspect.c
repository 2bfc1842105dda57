/* Names of kinds, and the two queries. */
#include "inspect/inspect.h"

#include "base/sort.h"

const char *inspect_ray(enum ray_kind kind) {
    switch (kind) {
    case RAY_CAMERA:
        return "camera";
    case RAY_REFLECTED:
        return "reflected";
    case RAY_REFRACTED:
        return "refracted";
    case RAY_HOLE:
        return "hole";
    case RAY_BELOW:
        return "below";
    }
    return "?";
}

const char *trace_path(const struct trace_report *report, uint32_t primitive) {
    uint32_t low = 0, high = report->names.count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (report->names.primitives[middle] < primitive)
            low = middle + 1;
        else
            high = middle;
    }
    bool found = low < report->names.count && report->names.primitives[low] == primitive && report->names.paths[low];
    return found ? report->names.paths[low] : primitive_node(report->picture->job->world, primitive)->name;
}

/* All primitives that the rays of a list and their child rays have hit: counts them, or lists them too. */
static size_t note_primitives(const struct pixel_trace_ray *ray, uint64_t *out, size_t count) {
    for (; ray; ray = ray->next) {
        if (ray->met) {
            if (out)
                out[count] = ray->hit.primitive;
            count++;
        }
        for (const struct pixel_trace_light *light = ray->lights; light; light = light->next) {
            uint32_t primitive = light->has_blocker ? light->blocker : light->primitive;
            if (primitive == OBSERVER_NO_BLOCKER)
                continue;
            if (out)
                out[count] = primitive;
            count++;
        }
        count = note_primitives(ray->first, out, count);
    }
    return count;
}

static bool find_names(struct pixel_trace *pixel_trace, const struct inspected *picture, struct trace_names *names,
                       struct error *error) {
    size_t count = 0, at = 0;
    for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next)
        count += note_primitives(sample->first, NULL, 0);
    uint64_t *all = arena_alloc_array(&pixel_trace->arena, count + 1, sizeof *all);
    names->primitives = arena_alloc_array(&pixel_trace->arena, count + 1, sizeof *names->primitives);
    names->paths = arena_alloc_array(&pixel_trace->arena, count + 1, sizeof *names->paths);
    if (!all || !names->primitives || !names->paths)
        return error_no_memory(error, "the trace of a pixel");
    for (const struct pixel_trace_sample *sample = pixel_trace->sample; sample; sample = sample->next)
        at = note_primitives(sample->first, all, at);
    sort_words(all, count);
    for (size_t i = 0; i < count; i++)
        if (i == 0 || all[i] != all[i - 1])
            names->primitives[names->count++] = (uint32_t)all[i];
    return world_find_node_paths(picture->job->world, picture->root,
                                 (struct primitive_list){names->primitives, names->count}, &pixel_trace->arena,
                                 names->paths, error);
}

struct trace_context {
    const struct inspected *picture;
    struct text_writer *writer;
};

static bool report_pixel(void *context, struct pixel_trace *pixel_trace, struct error *error) {
    const struct trace_context *trace_context = context;
    struct trace_report report = {trace_context->picture, pixel_trace, {0}};
    if (!find_names(pixel_trace, trace_context->picture, &report.names, error))
        return false;
    if (trace_context->picture->json)
        pixel_trace_print_json(&report, trace_context->writer);
    else
        pixel_trace_print(&report, trace_context->writer);
    return true;
}

bool inspect_pixels(const struct inspected *picture, const uint32_t (*pixels)[2], uint32_t count,
                    struct text_writer *writer, struct error *error) {
    const struct render_job *job = picture->job;
    struct trace_context trace_context = {picture, writer};
    /* With a noise or a time limit, the number of samples is known when the tile or the picture is finished. */
    struct render_job with_all_samples = *job;
    with_all_samples.settings.noise = 0;
    with_all_samples.settings.time_limit = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (pixels[i][0] >= job->width || pixels[i][1] >= job->height)
            return error_set(error, ERROR_USAGE, "--pixel %u,%u is not in the picture of %u x %u", pixels[i][0],
                             pixels[i][1], job->width, job->height);
    }
    bool ok = render_pixels(&with_all_samples, picture->pool, (struct pixel_list){pixels, count}, report_pixel,
                            &trace_context, error);
    text_writer_flush(writer);
    return ok;
}
