/* The frame of the camera. view, up and eye may have any length; what matters is the plane they span.
 *
 * Planar projections keep a direction whose part along the view is 1, so a plane at distance D is met at t = D. A thin
 * lens (Potmesil and Chakravarty, "A Lens and Aperture Camera Model", SIGGRAPH 1981) moves the origin by `a` over the
 * lens and the direction by -a / focus: all rays of a point of the picture meet again in the plane in focus. A second
 * eye is the same with the plane of the screen. A point at depth z is then blurred to a disc of radius
 * aperture * |1 / focus - 1 / z| on the window, and seen by the two eyes eye_distance * (1 / z - 1 / screen) apart. */
#include "render/camera.h"

#include "math/elementary.h"
#include "math/portable.h"
#include "math/range.h"

#include <stdio.h>

/* up is parallel to view: it is replaced by the coordinate axis most perpendicular to the view. */
static struct vec3 nearest_axis(struct vec3 forward) {
    double x = fabs(forward.x), y = fabs(forward.y), z = fabs(forward.z);
    if (y <= x && y <= z)
        return vec3_make(0, 1, 0);
    return z <= x ? vec3_make(0, 0, 1) : vec3_make(1, 0, 0);
}

/* What is wrong with a camera; CAMERA_TURNED: its up was replaced, which is no error. */
enum camera_fault {
    CAMERA_FINE,
    CAMERA_TURNED,
    CAMERA_VIEW,
    CAMERA_APERTURE,
    CAMERA_STEREO,
    CAMERA_FIELD_LENS,
    CAMERA_FIELD_SIZE,
    CAMERA_FIELD_PART,
    CAMERA_WIDTH,
    CAMERA_FOCUS_BEHIND,
    CAMERA_FOCUS_SMALL,
    CAMERA_SCREEN_SMALL
};
enum { FILM_SIDE = 1 << 20 };

/* The parts of the frame that only a lens, another projection or a second eye needs. */
static enum camera_fault set_lens(const struct camera *camera, const struct settings *settings,
                                  struct picture_size size, struct camera_frame *out) {
    const struct lens *lens = &settings->lens;
    bool planar = lens->projection == PROJECTION_PERSPECTIVE || lens->projection == PROJECTION_ORTHOGRAPHIC;
    out->lens = *lens;
    if (lens->aperture > 0 && !planar)
        return CAMERA_APERTURE;
    if (lens->stereo != STEREO_NONE && lens->projection != PROJECTION_PERSPECTIVE)
        return CAMERA_STEREO;
    if (lens->columns > 0 && (lens->projection != PROJECTION_PERSPECTIVE || lens->aperture > 0 || lens->shift_x != 0 ||
                              lens->shift_y != 0 || lens->stereo != STEREO_NONE))
        return CAMERA_FIELD_LENS;
    if (lens->columns > 0 && (size.width > FILM_SIDE || size.height > FILM_SIDE))
        return CAMERA_FIELD_SIZE;
    if (lens->columns > 0 && (settings->cropped || settings->overlay != OVERLAY_NONE))
        return CAMERA_FIELD_PART;
    /* Each picture of a pair has half of the width. */
    if (lens->stereo == STEREO_SIDE) {
        if (floor(out->width / 2) != out->width / 2)
            return CAMERA_WIDTH;
        out->width /= 2;
    }
    /* The plane in focus is given by its distance or by a point of it. */
    out->focus = lens->focus > 0 ? lens->focus : vec3_dot(vec3_sub(lens->focus_point, camera->eye), out->forward);
    if (lens->aperture > 0 && !(out->focus > 0))
        return CAMERA_FOCUS_BEHIND;
    if (lens->aperture > 0 && out->focus < NUMBER_SMALLEST)
        return CAMERA_FOCUS_SMALL;
    if (camera_has_views(out) && lens->screen < NUMBER_SMALLEST)
        return CAMERA_SCREEN_SMALL;
    /* How wide a pixel is, in the unit of the projection: a length, or an angle. */
    if (lens->projection == PROJECTION_ORTHOGRAPHIC) {
        double pixel = lens->view_height / out->height;
        out->right = vec3_scale(out->unit_right, pixel);
        out->down = vec3_scale(out->unit_down, pixel);
        out->spread = pixel;
    }
    if (lens->projection == PROJECTION_FISHEYE) {
        out->radian = lens->angle * (PI / 360);
        out->spread = 2 * out->radian / out->height;
    }
    if (lens->projection == PROJECTION_PANORAMA)
        out->spread = PI / out->height;
    return CAMERA_FINE;
}

static enum camera_fault set_frame(const struct camera *camera, const struct settings *settings,
                                   struct picture_size size, struct camera_frame *out) {
    const struct lens *lens = &settings->lens;
    enum camera_fault fault = CAMERA_FINE;
    double width = size.width, height = size.height;
    if (lens->columns > 0) {
        width /= lens->columns;
        height /= (double)lens->rows * lens_grids(lens);
    }
    struct vec3 view = settings->view_is_target ? vec3_sub(camera->view, camera->eye) : camera->view;
    if (!vec3_finite(view) || !(vec3_length(view) > 0))
        return CAMERA_VIEW;
    out->eye = camera->eye;
    out->forward = vec3_normalize(view);
    struct vec3 up = vec3_normalize(camera->up);
    struct vec3 right = vec3_cross(out->forward, up);
    /* Both are unit vectors: below this sine their plane is rounding noise. */
    if (!(vec3_length(right) > 0x1p-40)) {
        right = vec3_cross(out->forward, nearest_axis(out->forward));
        fault = CAMERA_TURNED;
    }
    right = vec3_normalize(right);
    struct vec3 down = vec3_cross(out->forward, right);
    double half = el_tan(camera->fov * (PI / 360)); /* of the window's height, at distance 1 */
    double pixel = 2 * half / height;
    out->right = vec3_scale(right, pixel);
    out->down = vec3_scale(vec3_normalize(down), pixel);
    out->width = width;
    out->height = height;
    out->spread = pixel;
    out->unit_right = right;
    out->unit_down = vec3_normalize(down);
    const enum camera_fault of_lens = set_lens(camera, settings, size, out);
    return of_lens == CAMERA_FINE ? fault : of_lens;
}

bool camera_prepare_quietly(const struct camera *camera, const struct settings *settings, struct picture_size size,
                            struct camera_frame *out) {
    return set_frame(camera, settings, size, out) <= CAMERA_TURNED;
}

bool camera_prepare(const struct camera *camera, const struct settings *settings, struct picture_size size,
                    struct camera_frame *out, char warning[256], struct error *error) {
    warning[0] = '\0';
    switch (set_frame(camera, settings, size, out)) {
    case CAMERA_FINE:
        return true;
    case CAMERA_TURNED: {
        struct vec3 up = nearest_axis(out->forward);
        (void)snprintf(warning, 256, "up is parallel to view (or zero): the axis (%g, %g, %g) is used instead", up.x,
                       up.y, up.z);
        return true;
    }
    case CAMERA_VIEW:
        return error_set(error, ERROR_SCENE, "%s",
                         settings->view_is_target ? "view: the point to look at must differ from the eye"
                                                  : "view: the direction must not be zero");
    case CAMERA_APERTURE:
        return error_set(error, ERROR_SCENE, "a lens (aperture) works only with perspective and orthographic pictures");
    case CAMERA_STEREO:
        return error_set(error, ERROR_SCENE, "stereo works only with perspective pictures");
    case CAMERA_FIELD_LENS:
        return error_set(error, ERROR_SCENE,
                         "the views of a light field are perspective pictures through pinholes: they have no aperture, "
                         "shift or stereo");
    case CAMERA_FIELD_SIZE:
        return error_set(error, ERROR_SCENE, "a light field of %.0f x %.0f pixels; its grid has at most %d on a side",
                         size.width, size.height, FILM_SIDE);
    case CAMERA_FIELD_PART:
        return error_set(error, ERROR_SCENE, "a light field cannot be combined with --crop or --overlay");
    case CAMERA_WIDTH:
        return error_set(error, ERROR_SCENE, "a stereo pair side by side needs an even width");
    case CAMERA_FOCUS_BEHIND:
        return error_set(error, ERROR_SCENE, "the point in focus must be in front of the camera");
    case CAMERA_FOCUS_SMALL:
        return error_set(error, ERROR_SCENE, "focus is too small: %g", out->focus);
    case CAMERA_SCREEN_SMALL:
        return error_set(error, ERROR_SCENE, "screen is too small: %g", settings->lens.screen);
    }
    return true;
}

struct camera camera_at(const struct camera *camera, const struct camera_motion *motion, double time) {
    struct camera out = *camera;
    out.eye = vec3_add_scaled(camera->eye, vec3_sub(motion->eye, camera->eye), time);
    out.view = vec3_add_scaled(camera->view, vec3_sub(motion->view, camera->view), time);
    out.up = vec3_add_scaled(camera->up, vec3_sub(motion->up, camera->up), time);
    return out;
}

struct box camera_origins(const struct camera_frame *frame) {
    const struct lens *lens = &frame->lens;
    double radius = lens->aperture;
    if (lens->stereo != STEREO_NONE)
        radius += lens->eye_distance / 2;
    if (lens->columns > 0)
        radius += lens->spacing * (lens->rows + lens->columns - 2) / 2;
    if (lens->projection == PROJECTION_ORTHOGRAPHIC)
        radius += vec3_length(frame->right) * frame->width * (0.5 + fabs(lens->shift_x)) +
                  vec3_length(frame->down) * frame->height * (0.5 + fabs(lens->shift_y));
    struct box box = {vec3_sub(frame->eye, vec3_all(radius)), vec3_add(frame->eye, vec3_all(radius))};
    return box_pad(box);
}

struct ray camera_ray(const struct camera_frame *frame, double x, double y) {
    struct vec3 direction = vec3_add_scaled(frame->forward, frame->right, x - frame->width / 2);
    direction = vec3_add_scaled(direction, frame->down, y - frame->height / 2);
    return (struct ray){
        .origin = frame->eye, .direction = direction, .t_min = 0, .t_max = INFINITY, .footprint = {0, frame->spread}};
}

/* A place of the unit square on the lens: a disc, or a regular polygon of triangles around the centre. */
static struct sample2 point_on_lens(const struct lens *lens, struct sample2 position) {
    if (lens->blades < 3)
        return sample_disc(position);
    double turn = 2 * PI / lens->blades, sector = floor(position.x * lens->blades);
    double along = position.x * lens->blades - sector, out = sqrt(position.y), s0, c0, s1, c1;
    double start = lens->blade_angle * (PI / 180) + sector * turn;
    el_sincos(start, &s0, &c0);
    el_sincos(start + turn, &s1, &c1);
    return (struct sample2){out * (c0 + along * (c1 - c0)), out * (s0 + along * (s1 - s0))};
}

/* Equidistant: the angle from the axis grows with the distance from the middle; black outside of the circle. */
static bool fisheye_direction(const struct camera_frame *frame, double x, double y, struct vec3 *direction) {
    double px = (x - frame->width / 2) / (frame->height / 2), py = (y - frame->height / 2) / (frame->height / 2);
    double r = sqrt(px * px + py * py), sine, cosine;
    if (r > 1)
        return false;
    el_sincos(r * frame->radian, &sine, &cosine);
    *direction = vec3_scale(frame->forward, cosine);
    if (r > 0) {
        *direction = vec3_add_scaled(*direction, frame->unit_right, sine * px / r);
        *direction = vec3_add_scaled(*direction, frame->unit_down, sine * py / r);
    }
    return true;
}

/* Longitude along the rows, the view in the middle; latitude down the columns. */
static struct vec3 panorama_direction(const struct camera_frame *frame, double x, double y) {
    double s_lon, c_lon, s_lat, c_lat;
    el_sincos((x / frame->width - 0.5) * 2 * PI, &s_lon, &c_lon);
    el_sincos((y / frame->height - 0.5) * PI, &s_lat, &c_lat);
    struct vec3 level = vec3_add_scaled(vec3_scale(frame->forward, c_lon), frame->unit_right, s_lon);
    return vec3_add_scaled(vec3_scale(level, c_lat), frame->unit_down, s_lat);
}

struct camera_view camera_view_of_eye(const struct camera_frame *frame, int eye) {
    return (struct camera_view){.right = 0.5 * eye * frame->lens.eye_distance};
}

/* The step of `count` of that length that `x` is in; what is beyond the last one belongs to it. */
static double step_at(double x, double length, double count) {
    return math_min(math_max(floor(x / length), 0), count - 1);
}

struct camera_view camera_view_at(const struct camera_frame *frame, double x, double y) {
    const struct lens *lens = &frame->lens;
    if (lens->columns > 0) {
        double column = step_at(x, frame->width, lens->columns);
        double row = step_at(y, frame->height, (double)lens->rows * lens_grids(lens));
        double own = math_fmod(row, lens->rows); /* in its grid */
        return (struct camera_view){.x = column * frame->width,
                                    .y = row * frame->height,
                                    .right = (column - (lens->columns - 1) / 2.0) * lens->spacing,
                                    .down = (own - (lens->rows - 1) / 2.0) * lens->spacing,
                                    .number = (uint32_t)(row * lens->columns + column),
                                    .depth = row >= lens->rows};
    }
    if (lens->stereo != STEREO_SIDE)
        return (struct camera_view){0};
    /* The right half of a pair belongs to the right eye. */
    bool is_right = x >= frame->width;
    struct camera_view view = camera_view_of_eye(frame, is_right ? 1 : -1);
    view.x = is_right ? frame->width : 0;
    view.number = is_right;
    return view;
}

bool camera_ray_through(const struct camera_frame *frame, double x, double y, struct sample2 position,
                        const struct camera_view *view, struct ray *out) {
    const struct lens *lens = &frame->lens;
    struct camera_view at = view ? *view : camera_view_at(frame, x, y);
    x -= at.x;
    y -= at.y;
    x += lens->shift_x * frame->width;
    y -= lens->shift_y * frame->height;
    switch (lens->projection) {
    case PROJECTION_PERSPECTIVE:
        *out = camera_ray(frame, x, y);
        break;
    case PROJECTION_ORTHOGRAPHIC:
        out->origin = vec3_add_scaled(frame->eye, frame->right, x - frame->width / 2);
        out->origin = vec3_add_scaled(out->origin, frame->down, y - frame->height / 2);
        *out = (struct ray){
            .origin = out->origin, .direction = frame->forward, .t_max = INFINITY, .footprint = {frame->spread, 0}};
        break;
    case PROJECTION_FISHEYE:
    case PROJECTION_PANORAMA:
        *out = (struct ray){.origin = frame->eye, .t_max = INFINITY, .footprint = {0, frame->spread}};
        if (lens->projection == PROJECTION_FISHEYE)
            return fisheye_direction(frame, x, y, &out->direction);
        out->direction = panorama_direction(frame, x, y);
        return true;
    }
    /* The rays of all eyes meet on the screen. */
    if (at.right != 0 || at.down != 0) {
        struct vec3 offset = vec3_add_scaled(vec3_scale(frame->unit_right, at.right), frame->unit_down, at.down);
        out->origin = vec3_add(out->origin, offset);
        out->direction = vec3_add_scaled(out->direction, offset, -1 / lens->screen);
    }
    /* Rays through all points of the lens meet in the plane in focus. */
    if (lens->aperture > 0) {
        struct sample2 p = point_on_lens(lens, position);
        struct vec3 offset = vec3_scale(frame->unit_right, lens->aperture * p.x);
        offset = vec3_add_scaled(offset, frame->unit_down, lens->aperture * p.y);
        out->origin = vec3_add(out->origin, offset);
        out->direction = vec3_add_scaled(out->direction, offset, -1 / frame->focus);
    }
    return true;
}

bool camera_project(const struct camera_frame *frame, struct vec3 point, double *x, double *y) {
    const struct lens *lens = &frame->lens;
    struct vec3 to = vec3_sub(point, frame->eye);
    double depth = vec3_dot(to, frame->forward), right = vec3_dot(to, frame->unit_right),
           down = vec3_dot(to, frame->unit_down), pixel = vec3_length(frame->right);
    /* Cylindrical coordinates about the direction of view. */
    double across = sqrt(right * right + down * down), distance = sqrt(across * across + depth * depth);
    switch (lens->projection) {
    case PROJECTION_PERSPECTIVE:
        if (!(depth > 0))
            return false;
        *x = frame->width / 2 + right / (depth * pixel);
        *y = frame->height / 2 + down / (depth * pixel);
        break;
    case PROJECTION_ORTHOGRAPHIC:
        *x = frame->width / 2 + right / pixel;
        *y = frame->height / 2 + down / pixel;
        break;
    case PROJECTION_FISHEYE: {
        double angle = el_atan2(across, depth), r = angle / frame->radian * (frame->height / 2);
        *x = frame->width / 2 + (across > 0 ? r * right / across : 0);
        *y = frame->height / 2 + (across > 0 ? r * down / across : 0);
        if (angle > frame->radian)
            return false;
        break;
    }
    case PROJECTION_PANORAMA:
        if (!(distance > 0))
            return false;
        *x = (el_atan2(right, depth) / (2 * PI) + 0.5) * frame->width;
        *y = (el_atan2(down, sqrt(right * right + depth * depth)) / PI + 0.5) * frame->height;
        break;
    }
    *x -= lens->shift_x * frame->width;
    *y += lens->shift_y * frame->height;
    return true;
}
