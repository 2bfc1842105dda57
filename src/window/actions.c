#include "window/actions.h"

#define ROW(action, name, title, menu, need, blender, openscad, help)                                                  \
    [action] = {name, title, menu, need, {blender, openscad}, help},
const struct window_action_row window_action_table[WINDOW_ACTION_COUNT] = {WINDOW_ACTIONS(ROW)};
