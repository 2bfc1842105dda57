/* A device that is no card: the pieces of paths in waves over the bundle of a scene, by the thread that asks. */
#ifndef GRAY_DEVICE_EMULATION_H
#define GRAY_DEVICE_EMULATION_H

#include "base/pool.h"
#include "render/path_wave.h"

struct emulation;
/* wave: paths at a time; crossings: of a line, in the memory of a query; 0: as many as are usual. NULL: no memory. */
struct emulation *emulation_create(const struct pool *pool, uint32_t wave, uint32_t crossings);
void emulation_destroy(struct emulation *emulation);
/* Opens the bundle of a scene, which must outlive the emulation, in place of `begin` of the device. Errors: as
 * bundle_open. */
bool emulation_open(struct emulation *emulation, void *bytes, size_t size, struct error *error);
/* The opened scene. Both may be used until the emulation is destroyed. */
const struct path_scene *emulation_scene(const struct emulation *emulation);
/* Orders that follow are for this view, and none is in work. False: it does not fit the scene (path_view_fits). */
bool emulation_set_view(struct emulation *emulation, const struct path_view *view);
struct path_device emulation_device(struct emulation *emulation);

#endif
