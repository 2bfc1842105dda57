/* Saving the image as it is shown, the camera, and the edits. */
#ifndef GRAY_VIEWER_VIEWER_SAVE_H
#define GRAY_VIEWER_VIEWER_SAVE_H

#include "viewer/viewer.h"

/* `picture` has the name of the picture and rules that replace nothing. Both choose a name that is still free:
 * dir/foo.png gives dir/foo-view1.png, dir/foo-view1.lua and so on; it is stored in `name` (4096 bytes). The Lua file
 * returns a table of eye, view, up and fov with every digit. */
bool viewer_save_image(const struct viewer *viewer, const struct file_target *picture, char *name, struct error *error);
bool viewer_save_camera(const struct viewer *viewer, const struct file_target *picture, char *name,
                        struct error *error);
/* dir/foo-changes1.lua: if the scene requires it, the picture has the camera, the exposure and all changes. */
bool viewer_save_edits(const struct viewer *viewer, const struct file_target *picture, char *name, struct error *error);

#endif
