/* The device of a picture, in the render process: a process of its own makes the samples, or this one where there are
 * no others. */
#ifndef GRAY_HOST_PICTURE_DEVICE_H
#define GRAY_HOST_PICTURE_DEVICE_H

#include "base/share.h"
#include "device/device_link.h"
#include "session/options.h"
#include "session/services.h"

struct emulation;
/* Zero but for the first three fields. Owner: the caller, picture_device_end. */
struct picture_device {
    const struct host_services *services;
    struct pool *pool;
    enum device kind;
    struct emulation *emulation;
    struct share memory;
    struct device_client client;
    struct path_estimate threads; /* with DEVICE_AUTO */
};
/* It may be used until picture_device_end. */
struct path_device picture_device_maker(struct picture_device *device, enum integrator_kind integrator);
void picture_device_end(struct picture_device *device);

#endif
