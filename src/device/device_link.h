/* Memory that the render process shares with a device process: orders of samples in one direction, records of pixels in
 * both. Neither process relies on what the other one writes there: what is not made as it was ordered, a thread of the
 * render makes. */
#ifndef GRAY_DEVICE_DEVICE_LINK_H
#define GRAY_DEVICE_DEVICE_LINK_H

#include "base/pool.h"
#include "render/path_wave.h"

struct device_link;
/* So many groups of orders at a time, each with so many bytes for pixels. */
struct device_slots {
    uint32_t count, room;
};
/* Bytes; they are zero at the start. */
size_t device_link_size(struct device_slots slots);
/* Ends the exchange. Calls that wait for the other process return, and later calls do not wait. Both processes may
 * close the link. */
void device_link_close(struct device_link *link);

/* The device process: opens the bundle of a scene and makes orders until the link is closed, with a thread for each
 * stream of the card, or for each slot. cuda: the card; NULL: the emulation. False: the bundle or a view is damaged, no
 * memory, or the card was lost; what is not made then, threads make. */
struct cuda;
bool device_link_serve(struct device_link *link, struct cuda *cuda, void *scene, size_t size, struct device_slots slots,
                       struct error *error);
/* Whether it has begun to make orders. */
bool device_link_was_ready(struct device_link *link);
bool device_link_is_closed(struct device_link *link);
/* Instead: it cannot begin, for this reason, or cannot go on. */
void device_link_refuse(struct device_link *link, const char *why);
/* The reason; "": none was given. Control characters are dots, here and in names. */
enum { DEVICE_REASON = 512 };
void device_link_reason(struct device_link *link, char out[DEVICE_REASON]);
/* Zero before it is ready, and after it was closed. */
struct device_statistics device_link_statistics(struct device_link *link);

/* The render process. Owner: the caller. */
struct device_client {
    struct device_link *link;
    const struct pool *pool;
    struct device_slots slots;
    uint32_t view; /* the number of the last one; 0: that of the bundle */
};
bool device_client_is_ready(const struct device_client *client);
/* Orders that follow are for this view (render/path_view.h), and the caller waits for none. */
struct path_view;
void device_client_set_view(struct device_client *client, const struct path_view *view);
/* Waits until the device is ready. False: it is not; the link is closed. */
bool device_client_wait(const struct device_client *client);
/* Its `make`, of struct path_device. */
bool device_client_make(struct device_client *client, const struct path_orders *orders, struct path_counts *counts);

#endif
