/* What people take home from the window: the picture as it is shown, and the camera as a Lua file. */
#ifndef GRAY_VIEWER_SAVED_VIEW_H
#define GRAY_VIEWER_SAVED_VIEW_H

#include "base/file_output.h"
#include "viewer/viewer.h"

/* `picture` has the name of the picture and rules that replace nothing. Both choose a name that is still free:
 * dir/foo.png gives dir/foo-view1.png, dir/foo-view1.lua and so on; it is put into `name` (4096 bytes). The Lua file
 * gives back a table of eye, view, up and fov with every digit. */
bool save_view_image(const struct viewer *viewer, const struct file_target *picture, char *name, struct error *error);
bool save_view_camera(const struct viewer *viewer, const struct file_target *picture, char *name, struct error *error);
/* dir/foo-changes1.lua: required by the scene, it gives the picture the camera, the exposure and all that was changed.
 */
bool save_edits(const struct viewer *viewer, const struct file_target *picture, char *name, struct error *error);

#endif
