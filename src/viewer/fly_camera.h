/* Walking through a scene: a place and an orientation that keys and the mouse change. The orientation is a quaternion
 * (Shoemake, "Animating Rotation with Quaternion Curves", SIGGRAPH 1985), so no direction is special. Knows no window:
 * times are seconds, mouse ways are shares of the window's height. */
#ifndef GRAY_VIEWER_FLY_CAMERA_H
#define GRAY_VIEWER_FLY_CAMERA_H

#include "math/box.h"
#include "render/settings.h"

struct quaternion {
    double w, x, y, z;
};

struct pose {
    struct vec3 place;
    struct quaternion turn; /* world from camera: the camera looks along -z, y is up */
    double fov;             /* degrees */
};

enum walk_key { WALK_FORWARD, WALK_BACK, WALK_LEFT, WALK_RIGHT, WALK_UP, WALK_DOWN, WALK_FAST, WALK_SLOW, WALK_KEYS };
enum { WALK_VIEWS = 10 };

struct walk {
    struct pose pose, home;
    double speed;         /* world units a second */
    struct vec3 centre;   /* that orbits go round */
    bool down[WALK_KEYS]; /* which keys are held */
    bool saved[WALK_VIEWS];
    struct pose views[WALK_VIEWS];
};

/* camera: with a direction as its view. bounds: of the scene; a way through it takes four seconds. */
void walk_begin(struct walk *walk, const struct camera *camera, const struct box *bounds);
/* Speed and centre for other bounds; the camera and kept views stay. */
void walk_measure(struct walk *walk, const struct box *bounds);
/* The camera of where it stands now. */
struct camera walk_camera(const struct walk *walk);
/* What the held keys do in `seconds`. True: something moved. */
bool walk_step(struct walk *walk, double seconds);
/* Looks around: a way of one turns by the angle of view. x to the right, y downwards. */
void walk_look(struct walk *walk, double x, double y);
/* Goes round the centre, which stays where it is in the picture. A way of one is half a turn. */
void walk_orbit(struct walk *walk, double x, double y);
/* Narrows (steps > 0) or widens the angle of view, by a tenth each. */
void walk_zoom(struct walk *walk, double steps);
/* Rolls to the right by degrees; walk_level turns until the horizon is level (y is up), and keeps where it looks. */
void walk_roll(struct walk *walk, double degrees);
void walk_level(struct walk *walk);
void walk_home(struct walk *walk);
void walk_save(struct walk *walk, int number); /* 0..9 */
bool walk_recall(struct walk *walk, int number);

#endif
