#include "host/picture_device.h"

#include "device/emulation.h"

#include <stdio.h>

/* There is no card. With `auto` the threads go on: nothing makes orders. */
static bool go_without(const struct picture_device *device, const char *reason, struct error *error) {
    char line[DEVICE_REASON + 64];
    if (device->kind == DEVICE_GPU)
        return error_set(error, ERROR_MACHINE, "--device gpu: %s", reason);
    (void)snprintf(line, sizeof line, "gray: the processor renders: %s", reason);
    device->services->line(device->services->context, LINE_DETAIL, line);
    return true;
}

/* Without processes of its own, gray emulates a device in this one. */
static bool begin_here(struct picture_device *device, struct bundle *scene, bool *is_used, struct error *error) {
    *is_used = false;
    if (device->kind != DEVICE_EMULATE)
        return go_without(device, "a card needs a process of its own, and there is none (--no-fork)", error);
    device->emulation = emulation_create(device->pool, 0, 0);
    if (!device->emulation)
        return error_no_memory(error, "the scene for a device");
    const struct path_device here = emulation_device(device->emulation);
    return here.begin(here.context, scene, is_used, error);
}

/* Of `auto`. */
static const double shortest_work = 3; /* seconds of the threads */
static bool is_worth(void *context, const struct path_estimate *threads) {
    struct picture_device *device = context;
    char reason[80];
    device->threads = *threads;
    if (device->in_window) /* it has many pictures */
        return true;
    if (threads->samples >= shortest_work * threads->rate)
        return true;
    (void)snprintf(reason, sizeof reason, "it needs about %.1f s", threads->samples / threads->rate);
    (void)go_without(device, reason, NULL);
    return false;
}

/* The card goes if its trial says that it is not quicker. */
static bool is_quicker(struct picture_device *device) {
    const double card = device_link_statistics(device->memory.block).rate, threads = device->threads.rate;
    char reason[128];
    if (card > threads)
        return true;
    (void)snprintf(reason, sizeof reason, "it makes %.3f million samples a second, the card %.3f million (trials)",
                   1e-6 * threads, 1e-6 * card);
    (void)go_without(device, reason, NULL);
    device_link_close(device->memory.block);
    return false;
}

/* Copying pixels for a card takes more than one thread. */
static uint32_t waiting_threads(const struct picture_device *device) {
    const uint32_t threads = (uint32_t)pool_workers(device->pool);
    return device->kind == DEVICE_EMULATE ? threads : threads < 4 ? 4 : threads < 16 ? threads : 16;
}

static bool begin(void *context, struct bundle *scene, bool *is_used, struct error *error) {
    struct picture_device *device = context;
    const struct host_services *services = device->services;
    const struct device_slots slots = {waiting_threads(device), device->room};
    device->has_begun = true;
    if (!services->device)
        return begin_here(device, scene, is_used, error);
    if (!services->device(services->context, scene, slots.count, slots.room, &device->memory, error))
        return false;
    device->client = (struct device_client){device->memory.block, device->pool, slots, 0};
    *is_used = true;
    if (device->in_window)
        return true;
    const bool is_ready = device_client_wait(&device->client);
    *is_used = is_ready && (device->kind != DEVICE_AUTO || is_quicker(device));
    if (is_ready || device->kind == DEVICE_EMULATE || pool_cancelled(device->pool))
        return true;
    char reason[DEVICE_REASON];
    device_link_reason(device->memory.block, reason);
    device->is_absent = true;
    return go_without(device, reason[0] ? reason : "the device process is gone", error);
}

/* --- in a window --- */

/* Whether it makes orders now. The window does not wait for a card. */
static bool is_ready(struct picture_device *device) {
    if (device->kind == DEVICE_EMULATE)
        (void)device_client_wait(&device->client);
    const bool ready = device_client_is_ready(&device->client);
    if (ready && !device->was_ready && device->kind == DEVICE_AUTO)
        (void)is_quicker(device);
    device->was_ready = device->was_ready || ready;
    return device_client_is_ready(&device->client);
}

/* Once; what is lost later, the supervisor reports. */
static void report_refusal(struct picture_device *device) {
    char reason[DEVICE_REASON], line[DEVICE_REASON + 64];
    device->is_left = true;
    device_link_reason(device->memory.block, reason);
    if (device->was_ready || device->kind == DEVICE_EMULATE)
        return;
    device->is_absent = true;
    (void)snprintf(line, sizeof line, "gray: %sthe processor renders: %s",
                   device->kind == DEVICE_GPU ? "warning: " : "", reason[0] ? reason : "the device process is gone");
    device->services->line(device->services->context, device->kind == DEVICE_GPU ? LINE_WARNING : LINE_DETAIL, line);
}

static enum path_device_answer take_view(void *context, const struct path_view *view) {
    struct picture_device *device = context;
    if (device->is_absent)
        return PATH_DEVICE_LEAVES;
    if (!device->has_begun || !path_view_follows(&device->first, view)) {
        picture_device_forget(device);
        device->first = *view;
        return PATH_DEVICE_BEGINS;
    }
    if (device->emulation)
        return emulation_set_view(device->emulation, view) ? PATH_DEVICE_TAKES : PATH_DEVICE_LEAVES;
    if (!device->memory.block || device->is_left)
        return PATH_DEVICE_LEAVES;
    if (is_ready(device)) {
        device_client_set_view(&device->client, view);
        return PATH_DEVICE_TAKES;
    }
    if (device_link_is_closed(device->memory.block))
        report_refusal(device);
    return PATH_DEVICE_LEAVES;
}

bool picture_device_walks(const struct picture_device *device, uint64_t pixels) {
    static const double slowest = 10; /* pictures a second */
    if (device->emulation)
        return true;
    if (!device->memory.block || device->is_left || !device_client_is_ready(&device->client))
        return false;
    return device->kind != DEVICE_AUTO || device_link_statistics(device->memory.block).rate >= slowest * (double)pixels;
}

void picture_device_forget(struct picture_device *device) {
    if (device->memory.block)
        device_link_close(device->memory.block);
    picture_device_end(device);
    *device = (struct picture_device){.services = device->services,
                                      .pool = device->pool,
                                      .kind = device->kind,
                                      .in_window = device->in_window,
                                      .room = device->room,
                                      .is_absent = device->is_absent,
                                      .was_reported = device->was_reported};
}

static bool make(void *context, const struct path_orders *orders, struct path_counts *counts) {
    struct picture_device *device = context;
    if (!device->emulation)
        return device_client_make(&device->client, orders, counts);
    const struct path_device here = emulation_device(device->emulation);
    return here.make(here.context, orders, counts);
}

/* A window goes on with the threads. */
static bool leave(void *context, const char *what, struct error *error) {
    struct picture_device *device = context;
    const bool is_wanted = device->kind == DEVICE_GPU;
    char line[256];
    if (is_wanted && !device->in_window)
        return error_set(error, ERROR_SCENE, "--device gpu: a device has no %s", what);
    if (device->was_reported)
        return true;
    device->was_reported = device->in_window;
    (void)snprintf(line, sizeof line, "gray: %sthe processor renders: a device has no %s", is_wanted ? "warning: " : "",
                   what);
    device->services->line(device->services->context, is_wanted ? LINE_WARNING : LINE_DETAIL, line);
    return true;
}

/* Tiles that a thread orders in a go: a card gets the whole film from all threads together. */
static uint32_t tiles_at_once(const struct picture_device *device, const struct film *film) {
    enum { OF_EMULATION = 4 };
    const uint32_t waiting = waiting_threads(device), share = (film_tile_count(film) + waiting - 1) / waiting;
    const uint32_t limit = device->kind == DEVICE_EMULATE ? OF_EMULATION : PATH_ORDERS;
    return share < limit ? share : limit;
}

bool picture_device_init(struct picture_device *device, const struct render_job *job, struct path_device *out,
                         struct error *error) {
    const uint32_t tiles = tiles_at_once(device, job->film);
    const bool has_parts = (path_film_parts(job->film->record) & (PATH_PART_FEATURES | PATH_PART_LIGHT)) != 0;
    device->room = tiles * FILM_TILE * FILM_TILE * (uint32_t)path_pixel_size(has_parts);
    *out = (struct path_device){.leave = leave,
                                .is_worth = device->kind == DEVICE_AUTO ? is_worth : NULL,
                                .take_view = device->in_window ? take_view : NULL,
                                .begin = begin,
                                .make = make,
                                .context = device,
                                .waiting = device->kind == DEVICE_EMULATE ? 0 : waiting_threads(device),
                                .tiles = tiles};
    return job->settings.integrator == INTEGRATOR_PATH || leave(device, "integrator but path", error);
}

void picture_device_end(struct picture_device *device) {
    emulation_destroy(device->emulation);
    share_destroy(&device->memory);
}
