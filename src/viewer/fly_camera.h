/* Flying through a scene: a position and an orientation that keys and the mouse change. The orientation is a quaternion
 * (Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985), so no direction is special. Knows no window:
 * times are seconds, distances of the mouse are fractions of the window's height. */
#ifndef GRAY_VIEWER_FLY_CAMERA_H
#define GRAY_VIEWER_FLY_CAMERA_H

#include "math/box.h"
#include "render/settings.h"

struct quaternion {
    double w, x, y, z;
};

struct pose {
    struct vec3 position;
    struct quaternion turn; /* world from camera: the camera looks along -z, y is up */
    double fov;             /* degrees */
};

enum fly_camera_key { FLY_FORWARD, FLY_BACK, FLY_LEFT, FLY_RIGHT, FLY_UP, FLY_DOWN, FLY_FAST, FLY_SLOW, FLY_KEYS };
enum { FLY_VIEWS = 10 };

struct fly_camera {
    struct pose pose, home;
    double speed;        /* world units a second */
    struct vec3 centre;  /* that orbits go round */
    bool down[FLY_KEYS]; /* which keys are held */
    bool saved[FLY_VIEWS];
    struct pose views[FLY_VIEWS];
};

/* camera: with a direction as its view. bounds: of the scene; a way through it takes four seconds. */
void fly_camera_begin(struct fly_camera *fly_camera, const struct camera *camera, const struct box *bounds);
/* Speed and centre for other bounds; the camera and kept views stay. */
void fly_camera_measure(struct fly_camera *fly_camera, const struct box *bounds);
/* The camera at its current position. */
struct camera fly_camera_current(const struct fly_camera *fly_camera);
/* What the held keys do in `seconds`. True: something moved. */
bool fly_camera_step(struct fly_camera *fly_camera, double seconds);
/* Looks around: a way of one turns by the angle of view. x to the right, y downwards. */
void fly_camera_turn(struct fly_camera *fly_camera, double x, double y);
/* Goes round the centre, which stays where it is in the picture. A way of one is half a turn. */
void fly_camera_orbit(struct fly_camera *fly_camera, double x, double y);
/* Narrows (steps > 0) or widens the angle of view, by a tenth each. */
void fly_camera_zoom(struct fly_camera *fly_camera, double steps);
/* Rolls to the right by degrees; fly_camera_level turns until the horizon is level (y is up), and keeps where it looks.
 */
void fly_camera_roll(struct fly_camera *fly_camera, double degrees);
void fly_camera_level(struct fly_camera *fly_camera);
void fly_camera_home(struct fly_camera *fly_camera);
void fly_camera_save(struct fly_camera *fly_camera, int number); /* 0..9 */
bool fly_camera_recall(struct fly_camera *fly_camera, int number);

#endif
