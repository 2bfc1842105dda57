/* Waves of paths on a card of NVIDIA: the driver is found when the program runs, the kernels are made by `make gpu`. */
#ifndef GRAY_DEVICE_CUDA_H
#define GRAY_DEVICE_CUDA_H

#include "base/file.h"
#include "device/cuda_calls.h"
#include "film/render_statistics.h"
#include "render/path_wave.h"

struct cuda;

/* The driver, the first card, and the kernels of a file (kernels_file_open). measures: each scene begins with a trial
 * of the rate. calls must outlive it. Errors name the call of the driver and what it said. NULL. */
struct cuda *cuda_create(const struct cuda_calls *calls, const struct file_bytes *kernels, bool measures,
                         struct error *error);
void cuda_destroy(struct cuda *cuda);
/* Copies a scene to the card, and lets the card make a few samples of the middle of the picture, which must have the
 * bits that `here` gives them, a device of this process. bytes: of the bundle, not opened; they are not needed
 * afterwards. scene: the same, opened for this process; it must outlive cuda. Errors: as bundle_open; of the driver;
 * memory needed and free; other bits. */
bool cuda_open_scene(struct cuda *cuda, void *bytes, size_t size, const struct path_scene *scene,
                     const struct path_device *here, struct error *error);
/* So many threads may use it at a time: while one ends its last paths, the others fill the card. What more threads
 * want is left. */
enum { CUDA_STREAMS = 4 };
/* Orders that follow are for this view, which fits the scene, and none is in work. */
void cuda_set_view(struct cuda *cuda, const struct path_view *view);
/* Its orders; `begin` is NULL. It may be used until the end of cuda. */
struct path_device cuda_device(struct cuda *cuda);
/* Until now. */
struct device_statistics cuda_statistics(struct cuda *cuda);
/* Why the card makes no more orders; NULL: it does. */
const char *cuda_lost(struct cuda *cuda);

#endif
