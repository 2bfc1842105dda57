/* Rotations are multiplied on the camera's side (about its own axes) or, around a centre, on the world's side. After
 * each one the quaternion is normalised, so errors do not accumulate. */
#include "render/fly_camera.h"

#include "math/elementary.h"

#include <math.h>
#include <string.h>

static const double degree = PI / 180;

static struct quaternion multiply(struct quaternion a, struct quaternion b) {
    struct quaternion q = {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                           a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                           a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
    double length = sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return (struct quaternion){q.w / length, q.x / length, q.y / length, q.z / length};
}

/* About a unit axis, by radians. */
static struct quaternion turn_about(struct vec3 axis, double angle) {
    double s = el_sin(angle / 2);
    return (struct quaternion){el_cos(angle / 2), s * axis.x, s * axis.y, s * axis.z};
}

static struct vec3 rotate(struct quaternion q, struct vec3 v) {
    struct vec3 u = {q.x, q.y, q.z};
    struct vec3 t = vec3_scale(vec3_cross(u, v), 2);
    return vec3_add(vec3_add_scaled(v, t, q.w), vec3_cross(u, t));
}

/* Of the rotation whose columns are right, up, back; the largest component first (Shepperd 1978). */
static struct quaternion of_axes(struct vec3 right, struct vec3 up, struct vec3 back) {
    double m[3][3] = {{right.x, up.x, back.x}, {right.y, up.y, back.y}, {right.z, up.z, back.z}};
    double trace = m[0][0] + m[1][1] + m[2][2];
    if (trace > m[0][0] && trace > m[1][1] && trace > m[2][2]) {
        double s = sqrt(1 + trace) * 2;
        return (struct quaternion){s / 4, (m[2][1] - m[1][2]) / s, (m[0][2] - m[2][0]) / s, (m[1][0] - m[0][1]) / s};
    }
    int i = m[1][1] > m[0][0] ? 1 : 0;
    i = m[2][2] > m[i][i] ? 2 : i;
    int j = (i + 1) % 3, k = (i + 2) % 3;
    double s = sqrt(1 + m[i][i] - m[j][j] - m[k][k]) * 2, v[3];
    v[i] = s / 4;
    v[j] = (m[j][i] + m[i][j]) / s;
    v[k] = (m[k][i] + m[i][k]) / s;
    return (struct quaternion){(m[k][j] - m[j][k]) / s, v[0], v[1], v[2]};
}

static struct vec3 any_across(struct vec3 direction) {
    struct vec3 axis = fabs(direction.y) < 0.9 ? vec3_make(0, 1, 0) : vec3_make(1, 0, 0);
    return vec3_normalize(vec3_cross(direction, axis));
}

static struct quaternion looking(struct vec3 view, struct vec3 up) {
    struct vec3 forward = vec3_normalize(view), right = vec3_cross(forward, up);
    right = vec3_length(right) > 1e-12 * vec3_length(up) ? vec3_normalize(right) : any_across(forward);
    return of_axes(right, vec3_cross(right, forward), vec3_negate(forward));
}

static struct vec3 forward_of(const struct pose *pose) {
    return rotate(pose->turn, vec3_make(0, 0, -1));
}

void fly_camera_begin(struct fly_camera *fly_camera, const struct camera *camera, const struct box *bounds) {
    memset(fly_camera, 0, sizeof *fly_camera);
    fly_camera->pose = (struct pose){camera->eye, looking(camera->view, camera->up), camera->fov};
    fly_camera->home = fly_camera->views[0] = fly_camera->pose;
    fly_camera->view_count = 1;
    fly_camera->changed_at = -HUGE_VAL;
    fly_camera_measure(fly_camera, bounds);
}

void fly_camera_measure(struct fly_camera *fly_camera, const struct box *bounds) {
    bool known = !box_is_empty(bounds) && vec3_finite(bounds->min) && vec3_finite(bounds->max);
    double size = known ? vec3_length(vec3_sub(bounds->max, bounds->min)) : 10;
    /* For a wide floor under a small scene the position of the camera is used, too. */
    fly_camera->centre = known ? vec3_scale(vec3_add(bounds->min, bounds->max), 0.5) : vec3_make(0, 0, 0);
    double away = vec3_length(vec3_sub(fly_camera->centre, fly_camera->home.position));
    fly_camera->speed = fly_camera->usual = (size < 2 * away || away == 0 ? size : 2 * away) / 4;
}

void fly_camera_near(struct fly_camera *fly_camera, double distance) {
    fly_camera->speed = math_min(math_max(0.7 * distance, 0.01 * fly_camera->usual), fly_camera->usual);
}

struct camera fly_camera_current(const struct fly_camera *fly_camera) {
    const struct pose *pose = &fly_camera->pose;
    return (struct camera){pose->position, forward_of(pose), rotate(pose->turn, vec3_make(0, 1, 0)), pose->fov};
}

bool fly_camera_step(struct fly_camera *fly_camera, double seconds) {
    const bool *down = fly_camera->down;
    struct vec3 route = {down[FLY_RIGHT] - down[FLY_LEFT], down[FLY_UP] - down[FLY_DOWN],
                         down[FLY_BACK] - down[FLY_FORWARD]};
    if (vec3_max_abs(route) == 0 || seconds <= 0)
        return false;
    double speed = fly_camera->speed * (down[FLY_FAST] ? 4 : 1) * (down[FLY_SLOW] ? 0.25 : 1);
    fly_camera->pose.position = vec3_add_scaled(fly_camera->pose.position,
                                                rotate(fly_camera->pose.turn, vec3_normalize(route)), speed * seconds);
    return true;
}

void fly_camera_turn(struct fly_camera *fly_camera, double x, double y) {
    double angle = fly_camera->pose.fov * degree;
    struct quaternion turn = fly_camera->pose.turn;
    turn = multiply(turn, turn_about(vec3_make(0, 1, 0), -x * angle));
    fly_camera->pose.turn = multiply(turn, turn_about(vec3_make(1, 0, 0), -y * angle));
}

/* A level camera keeps its horizon: it turns about the y axis, and not over the poles. */
void fly_camera_orbit(struct fly_camera *fly_camera, double x, double y) {
    struct pose *pose = &fly_camera->pose;
    struct vec3 right = rotate(pose->turn, vec3_make(1, 0, 0)), up = rotate(pose->turn, vec3_make(0, 1, 0));
    bool level = fabs(right.y) < 1e-6 && fabs(up.y) > 1e-3;
    struct quaternion pitch = turn_about(right, -y * 180 * degree);
    if (level && rotate(pitch, up).y * up.y < 1e-3 * up.y * up.y)
        pitch = turn_about(right, 0);
    struct quaternion by =
        multiply(turn_about(level ? vec3_make(0, up.y < 0 ? -1 : 1, 0) : up, -x * 180 * degree), pitch);
    pose->position = vec3_add(fly_camera->centre, rotate(by, vec3_sub(pose->position, fly_camera->centre)));
    pose->turn = multiply(by, pose->turn);
}

void fly_camera_zoom(struct fly_camera *fly_camera, double steps) {
    double fov = fly_camera->pose.fov * el_exp(-0.1 * steps);
    fly_camera->pose.fov = fov < 0.01 ? 0.01 : fov > 170 ? 170 : fov;
}

/* How far the centre is along the view, at least a little. */
static double depth_of_centre(const struct fly_camera *fly_camera) {
    struct vec3 to = vec3_sub(fly_camera->centre, fly_camera->pose.position);
    return math_max(vec3_dot(to, forward_of(&fly_camera->pose)), 0.01 * fly_camera->speed);
}

/* World units across the height of the picture, at the depth of the centre. */
static double height_at_centre(const struct fly_camera *fly_camera) {
    double half = 0.5 * fly_camera->pose.fov * degree;
    return 2 * depth_of_centre(fly_camera) * el_sin(half) / el_cos(half);
}

void fly_camera_pan(struct fly_camera *fly_camera, double x, double y) {
    double height = height_at_centre(fly_camera);
    struct vec3 route = rotate(fly_camera->pose.turn, vec3_make(-x * height, y * height, 0));
    fly_camera->pose.position = vec3_add(fly_camera->pose.position, route);
}

void fly_camera_dolly(struct fly_camera *fly_camera, double x, double y, double steps) {
    double depth = depth_of_centre(fly_camera), height = height_at_centre(fly_camera);
    struct vec3 to = rotate(fly_camera->pose.turn, vec3_make(x * height, -y * height, -depth));
    double share = 1 - el_exp(-0.1 * steps);
    fly_camera->pose.position = vec3_add_scaled(fly_camera->pose.position, to, share);
}

void fly_camera_face(struct fly_camera *fly_camera, struct vec3 direction) {
    struct pose *pose = &fly_camera->pose;
    double distance = vec3_length(vec3_sub(fly_camera->centre, pose->position));
    pose->turn = looking(direction, fabs(direction.y) > 0.99 ? vec3_make(0, 0, -1) : vec3_make(0, 1, 0));
    pose->position = vec3_add_scaled(fly_camera->centre, direction, -distance);
}

bool fly_camera_put(struct fly_camera *fly_camera, bool eye, struct vec3 v) {
    struct pose *pose = &fly_camera->pose;
    if (!vec3_finite(v) || (!eye && !(vec3_length(v) > 0)))
        return false;
    if (eye)
        pose->position = v;
    else
        pose->turn = looking(v, rotate(pose->turn, vec3_make(0, 1, 0)));
    return true;
}

void fly_camera_frame(struct fly_camera *fly_camera, const struct box *box, double aspect) {
    static const double room = 0.85; /* of the picture, for the box */
    struct pose *pose = &fly_camera->pose;
    struct vec3 right = rotate(pose->turn, vec3_make(1, 0, 0)), up = rotate(pose->turn, vec3_make(0, 1, 0));
    double radius = box_is_empty(box) ? 0 : 0.5 * vec3_length(vec3_sub(box->max, box->min)), distance = 0;
    double high = room * el_tan(0.5 * math_min(pose->fov, 120) * degree), wide = high * aspect;
    if (!(radius > 0) || !isfinite(radius))
        return;
    fly_camera->centre = vec3_scale(vec3_add(box->min, box->max), 0.5);
    for (unsigned i = 0; i < 8; i++) {
        struct vec3 from = vec3_sub(box_corner(box, i), fly_camera->centre);
        double aside = math_max(fabs(vec3_dot(from, right)) / wide, fabs(vec3_dot(from, up)) / high);
        distance = math_max(distance, aside - vec3_dot(from, forward_of(pose)));
    }
    pose->position = vec3_add_scaled(fly_camera->centre, forward_of(pose), -math_max(distance, 1.01 * radius));
}

void fly_camera_roll(struct fly_camera *fly_camera, double degrees) {
    fly_camera->pose.turn = multiply(fly_camera->pose.turn, turn_about(vec3_make(0, 0, -1), degrees * degree));
}

void fly_camera_level(struct fly_camera *fly_camera) {
    fly_camera->pose.turn = looking(forward_of(&fly_camera->pose), vec3_make(0, 1, 0));
}

void fly_camera_home(struct fly_camera *fly_camera) {
    fly_camera->pose = fly_camera->home;
}

void fly_camera_note(struct fly_camera *fly_camera, double now) {
    static const double still = 0.5; /* seconds */
    bool goes_on = now - fly_camera->changed_at < still;
    if (!goes_on && fly_camera->view == FLY_VIEWS - 1)
        memmove(fly_camera->views, fly_camera->views + 1, (FLY_VIEWS - 1) * sizeof *fly_camera->views);
    else if (!goes_on)
        fly_camera->view++;
    fly_camera->changed_at = now;
    fly_camera->views[fly_camera->view] = fly_camera->pose;
    fly_camera->view_count = fly_camera->view + 1;
}

bool fly_camera_recall(struct fly_camera *fly_camera, bool forth) {
    int view = fly_camera->view + (forth ? 1 : -1);
    if (view < 0 || view >= fly_camera->view_count)
        return false;
    fly_camera->view = view;
    fly_camera->changed_at = -HUGE_VAL; /* the next movement is another view */
    fly_camera->pose = fly_camera->views[view];
    return true;
}
