/* The commands of a window are executed with the world of the picture, and with one device for all its passes. */
#include "host/picture_in_window_internal.h"

#include "host/picture_device.h"
#include "host/render_reports.h"
#include "preview/preview_session.h"

static bool preview_build(void *context, const struct changed_scene *changed, struct error *error) {
    struct picture_work *work = context;
    world_destroy(&work->world);
    work->process->radiosity.patches.world = NULL;
    arena_reset(&work->process->job);
    return render_process_build_world(work, changed, error);
}

static void preview_fill_report(void *context, const struct film *film, struct picture_report *report) {
    render_process_fill_report(context, film, report);
}

static void preview_warn(void *context, const char *text) {
    const struct picture_work *work = context;
    render_process_warn(work->process, text);
}

static bool preview_walks(void *context, uint64_t pixels) {
    return picture_device_walks(context, pixels);
}

static void preview_forget(void *context) {
    picture_device_forget(context);
}

bool picture_in_window(struct picture_work *work, double build_seconds, struct error *error) {
    struct render_process *process = work->process;
    bool built = work->job.world != NULL;
    struct picture_device device = {.services = process->services,
                                    .pool = process->pool,
                                    .kind = (enum device)process->options->device,
                                    .in_window = true};
    struct path_device maker;
    work->job.world = &work->world;
    if (device.kind != DEVICE_CPU && work->job.settings.integrator == INTEGRATOR_PATH) {
        (void)picture_device_init(&device, &work->job, &maker, error);
        work->job.device = &maker;
    }
    struct preview_session preview = {.services = process->services,
                                      .pool = process->pool,
                                      .device = {preview_walks, preview_forget, &device},
                                      .request = work->request,
                                      .picture_request = &work->picture_request,
                                      .job = &work->job,
                                      .world = &work->world,
                                      .context = work,
                                      .build = preview_build,
                                      .fill = preview_fill_report,
                                      .warn = preview_warn};
    bool ok = preview_run(&preview, built, &work->report, build_seconds, error);
    work->job.device = NULL;
    picture_device_end(&device);
    return ok;
}
