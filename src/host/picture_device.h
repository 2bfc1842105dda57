/* The device of a picture, in the render process: a process of its own makes the samples, or this one where there are
 * no others. */
#ifndef GRAY_HOST_PICTURE_DEVICE_H
#define GRAY_HOST_PICTURE_DEVICE_H

#include "base/share.h"
#include "device/device_link.h"
#include "render/path_view.h"
#include "render/render.h"
#include "session/options.h"
#include "session/services.h"

struct emulation;
/* Zero but for the first four fields. Owner: the caller, picture_device_end. */
struct picture_device {
    const struct host_services *services;
    struct pool *pool;
    enum device kind;
    bool in_window; /* it makes one picture after the other, until picture_device_forget */
    struct emulation *emulation;
    struct share memory;
    uint32_t room; /* of a slot of it */
    struct device_client client;
    struct path_estimate threads; /* with DEVICE_AUTO */
    /* In a window. */
    bool has_begun, was_ready, is_left; /* left: threads make all pictures of this world ... */
    bool is_absent, was_reported;       /* ... and of all others, as without a window; `leave` was called */
    struct path_view first;             /* of the bundle */
};
/* *out may be used until picture_device_end. False: with `gpu`, an integrator that devices do not have. */
bool picture_device_init(struct picture_device *device, const struct render_job *job, struct path_device *out,
                         struct error *error);
void picture_device_end(struct picture_device *device);
/* In a window: the world is another one, or there is none. */
void picture_device_forget(struct picture_device *device);
/* Whether it is there, and quick enough for one picture after the other while the camera moves. */
bool picture_device_walks(const struct picture_device *device, uint64_t pixels);

#endif
