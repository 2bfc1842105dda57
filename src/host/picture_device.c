#include "host/picture_device.h"

#include "device/emulation.h"

#include <stdio.h>

static bool begin(void *context, struct bundle *scene, struct error *error) {
    struct picture_device *device = context;
    const struct host_services *services = device->services;
    struct pool *pool = device->pool;
    const uint32_t slots = (uint32_t)pool_workers(pool);
    if (!services->device) {
        device->emulation = emulation_create(pool, 0, 0);
        if (!device->emulation)
            return error_no_memory(error, "the scene for a device");
        const struct path_device here = emulation_device(device->emulation);
        return here.begin(here.context, scene, error);
    }
    if (!services->device(services->context, scene, slots, &device->memory, error))
        return false;
    device->client = (struct device_client){device->memory.block, pool, slots};
    (void)device_client_wait(&device->client);
    return true;
}

static bool make(void *context, const struct path_order *order, struct path_pixel *pixels, struct path_counts *counts) {
    struct picture_device *device = context;
    if (!device->emulation)
        return device_client_make(&device->client, order, pixels, counts);
    const struct path_device here = emulation_device(device->emulation);
    return here.make(here.context, order, pixels, counts);
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
    return (struct path_device){leave, begin, make, device};
}

void picture_device_end(struct picture_device *device) {
    emulation_destroy(device->emulation);
    share_destroy(&device->memory);
}
