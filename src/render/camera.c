/* The frame of the camera. view, up and eye may have any length; what matters is the plane they span. */
#include "render/camera.h"

#include "math/elementary.h"

#include <stdio.h>

/* up is parallel to view: the coordinate axis most at right angles to the view takes its place. */
static struct vec3 nearest_axis(struct vec3 forward) {
    double x = fabs(forward.x), y = fabs(forward.y), z = fabs(forward.z);
    if (y <= x && y <= z)
        return vec3_make(0, 1, 0);
    return z <= x ? vec3_make(0, 0, 1) : vec3_make(1, 0, 0);
}

bool camera_prepare(const struct camera *camera, const struct settings *settings, double width, double height,
                    struct camera_frame *out, char warning[256], struct error *error) {
    warning[0] = '\0';
    struct vec3 view = settings->view_is_target ? vec3_sub(camera->view, camera->eye) : camera->view;
    if (!vec3_finite(view) || !(vec3_length(view) > 0))
        return error_set(error, ERROR_SCENE, "%s",
                         settings->view_is_target ? "view: the point to look at must not be the eye itself"
                                                  : "view: the direction must not be zero");
    out->eye = camera->eye;
    out->forward = vec3_normalize(view);
    struct vec3 up = vec3_normalize(camera->up);
    struct vec3 right = vec3_cross(out->forward, up);
    /* Both are unit vectors: below this sine their plane is rounding noise. */
    if (!(vec3_length(right) > 0x1p-40)) {
        up = nearest_axis(out->forward);
        right = vec3_cross(out->forward, up);
        (void)snprintf(warning, 256, "up is parallel to view (or zero): the axis (%g, %g, %g) is used instead", up.x, up.y,
                       up.z);
    }
    right = vec3_normalize(right);
    struct vec3 down = vec3_cross(out->forward, right);
    double half = el_tan(camera->fov * (3.14159265358979323846 / 360)); /* of the window's height, at distance 1 */
    double pixel = 2 * half / height;
    out->right = vec3_scale(right, pixel);
    out->down = vec3_scale(vec3_normalize(down), pixel);
    out->width = width;
    out->height = height;
    out->spread = pixel;
    return true;
}

struct ray camera_ray(const struct camera_frame *frame, double x, double y) {
    struct vec3 direction = vec3_add_scaled(frame->forward, frame->right, x - frame->width / 2);
    direction = vec3_add_scaled(direction, frame->down, y - frame->height / 2);
    return (struct ray){.origin = frame->eye,
                        .direction = direction,
                        .t_min = 0,
                        .t_max = INFINITY,
                        .footprint = {0, frame->spread}};
}
