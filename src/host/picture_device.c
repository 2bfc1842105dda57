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
    const uint32_t slots = waiting_threads(device);
    if (!services->device)
        return begin_here(device, scene, is_used, error);
    if (!services->device(services->context, scene, slots, &device->memory, error))
        return false;
    device->client = (struct device_client){device->memory.block, device->pool, slots};
    const bool is_ready = device_client_wait(&device->client);
    *is_used = is_ready && (device->kind != DEVICE_AUTO || is_quicker(device));
    if (is_ready || device->kind == DEVICE_EMULATE || pool_cancelled(device->pool))
        return true;
    char reason[DEVICE_REASON];
    device_link_reason(device->memory.block, reason);
    return go_without(device, reason[0] ? reason : "the device process is gone", error);
}

static bool make(void *context, const struct path_orders *orders, struct path_counts *counts) {
    struct picture_device *device = context;
    if (!device->emulation)
        return device_client_make(&device->client, orders, counts);
    const struct path_device here = emulation_device(device->emulation);
    return here.make(here.context, orders, counts);
}

static void leave(void *context, const char *what) {
    const struct picture_device *device = context;
    char line[256];
    (void)snprintf(line, sizeof line, "gray: the processor renders: a device has no %s", what);
    device->services->line(device->services->context, LINE_DETAIL, line);
}

struct path_device picture_device_maker(struct picture_device *device, enum integrator_kind integrator) {
    if (integrator != INTEGRATOR_PATH)
        leave(device, "integrator but path");
    return (struct path_device){leave,  device->kind == DEVICE_AUTO ? is_worth : NULL,
                                begin,  make,
                                device, device->kind == DEVICE_EMULATE ? 0 : waiting_threads(device)};
}

void picture_device_end(struct picture_device *device) {
    emulation_destroy(device->emulation);
    share_destroy(&device->memory);
}
