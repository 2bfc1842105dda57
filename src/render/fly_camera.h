/* Flying through a scene: a position and an orientation that keys and the mouse change. The orientation is a quaternion
 * (Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985), so no direction is special. Independent of
 * the window: times are seconds, distances of the mouse are fractions of the window's height. */
#ifndef GRAY_RENDER_FLY_CAMERA_H
#define GRAY_RENDER_FLY_CAMERA_H

#include "math/box.h"
#include "settings/settings.h"

struct quaternion {
    double w, x, y, z;
};

struct pose {
    struct vec3 position;
    struct quaternion turn; /* world from camera: the camera looks along -z, y is up */
    double fov;             /* degrees */
};

enum { FLY_VIEWS = 64 };

/* Keys that move the camera while they are held. */
enum fly_camera_key { FLY_FORWARD, FLY_BACK, FLY_LEFT, FLY_RIGHT, FLY_UP, FLY_DOWN, FLY_FAST, FLY_SLOW, FLY_KEYS };

struct fly_camera {
    struct pose pose, home;
    double speed;                 /* world units a second ... */
    double usual;                 /* ... where nothing is in front */
    struct vec3 centre;           /* that orbits go round */
    bool down[FLY_KEYS];          /* which keys are held */
    struct pose views[FLY_VIEWS]; /* in the order of time */
    int view_count, view;         /* view: the one that the pose belongs to */
    double changed_at;
};

/* camera: its view is a direction. bounds: of the scene; a flight through it takes four seconds. */
void fly_camera_begin(struct fly_camera *fly_camera, const struct camera *camera, const struct box *bounds);
/* Sets speed and centre for other bounds; the camera does not move. */
void fly_camera_measure(struct fly_camera *fly_camera, const struct box *bounds);
/* The speed for what is in front at this distance: not faster than through the scene in four seconds. */
void fly_camera_near(struct fly_camera *fly_camera, double distance);
/* The camera at its current position. */
struct camera fly_camera_current(const struct fly_camera *fly_camera);
/* Applies the pressed keys for `seconds`. True: the camera has moved. */
bool fly_camera_step(struct fly_camera *fly_camera, double seconds);
/* Rotates the camera: a distance of one rotates by the angle of view. x to the right, y downwards. */
void fly_camera_turn(struct fly_camera *fly_camera, double x, double y);
/* Orbits the centre, which keeps its position in the picture. A distance of one is half a turn. */
void fly_camera_orbit(struct fly_camera *fly_camera, double x, double y);
/* Narrows (steps > 0) or widens the angle of view, by a tenth each. */
void fly_camera_zoom(struct fly_camera *fly_camera, double steps);
/* Moves it in the plane of the picture: the centre follows the mouse. */
void fly_camera_pan(struct fly_camera *fly_camera, double x, double y);
/* Moves it along the ray through a point of the picture (from its middle, in heights), by a tenth of the distance of
 * the centre for each step; never beyond the centre. */
void fly_camera_dolly(struct fly_camera *fly_camera, double x, double y, double steps);
/* Puts the eye there, or looks in that direction; false: it is none. */
bool fly_camera_put(struct fly_camera *fly_camera, bool eye, struct vec3 v);
/* Looks along a direction at the centre, from the same distance; up is y, or -z where that is the direction. */
void fly_camera_face(struct fly_camera *fly_camera, struct vec3 direction);
/* Moves until the box, whose middle becomes the centre, fills a picture with this ratio of width to height. A box
 * without a size: not at all. */
void fly_camera_frame(struct fly_camera *fly_camera, const struct box *box, double aspect);
/* Rolls to the right by degrees; fly_camera_level rolls until the horizon is level (y is up), and keeps the view
 * direction. */
void fly_camera_roll(struct fly_camera *fly_camera, double degrees);
void fly_camera_level(struct fly_camera *fly_camera);
void fly_camera_home(struct fly_camera *fly_camera);
/* The pose has changed: a view of its own, if the camera stood before, else a later one of the same movement. */
void fly_camera_note(struct fly_camera *fly_camera, double now);
/* Takes the view before this one, or, forth, the one after it. False: there is none. */
bool fly_camera_recall(struct fly_camera *fly_camera, bool forth);

#endif
