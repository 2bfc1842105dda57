/* What a user can ask the window for, once: menus, keys, the list of keys and tooltips are made from these rows. */
#ifndef GRAY_WINDOW_ACTIONS_H
#define GRAY_WINDOW_ACTIONS_H

#include "base/list.h"

#include <stdbool.h>

#define WINDOW_MENUS(X)                                                                                                \
    X(MENU_FILE, "_File")                                                                                              \
    X(MENU_EDIT, "_Edit")                                                                                              \
    X(MENU_ADD, "_Add")                                                                                                \
    X(MENU_VIEW, "_View")                                                                                              \
    X(MENU_PICTURE, "_Picture")                                                                                        \
    X(MENU_ANIMATION, "A_nimation")
enum window_menu { WINDOW_MENUS(LIST_MEMBER) };

/* What an action needs: a picture that was begun, or one of a scene; the memory of a picture in progress, or a view
 * without a scene; this memory; a selection of any kind. */
enum action_need { NEEDS_NOTHING, NEEDS_NAME, NEEDS_SCENE, NEEDS_VIEW, NEEDS_PICTURE, NEEDS_SELECTION, NEEDS_FRAMES };

/* Name, title, menu, need, keys as in Blender and as in OpenSCAD (as GTK writes them, divided by blanks), help. */
#define WINDOW_ACTIONS(X)                                                                                              \
    X(DO_SAVE_PICTURE, "save-picture", "Save _Picture", MENU_FILE, NEEDS_NAME, "<Control><Shift>s",                    \
      "<Control><Shift>s", "Save the picture as it is shown")                                                          \
    X(DO_SAVE_VIEW, "save-view", "Save Vie_w", MENU_FILE, NEEDS_PICTURE, "<Control><Shift>v", "<Control><Shift>v",     \
      "Save the camera as a Lua file")                                                                                 \
    X(DO_SAVE_CHANGES, "save-changes", "_Save Edits", MENU_FILE, NEEDS_SCENE, "<Control>s", "<Control>s",              \
      "Save all edits, the camera and the exposure as a Lua file")                                                     \
    X(DO_EXPORT_MODEL, "export-model", "_Export Model…", MENU_FILE, NEEDS_SCENE, "<Control>e", "F7",                   \
      "Write the solids for printing: STL, 3MF, OBJ or PLY")                                                           \
    X(DO_NEXT_PICTURE, "next-picture", "_Next Picture", MENU_FILE, NEEDS_PICTURE, "<Control>n", "<Control>n",          \
      "Continue with the next picture of the script")                                                                  \
    X(DO_QUIT, "quit", "_Quit", MENU_FILE, NEEDS_NOTHING, "<Control>q", "<Control>q", "Close the window")              \
    X(DO_UNDO, "undo", "_Undo", MENU_EDIT, NEEDS_PICTURE, "<Control>z", "<Control>z", "Undo the last edit")            \
    X(DO_REDO, "redo", "_Redo", MENU_EDIT, NEEDS_PICTURE, "<Control><Shift>z <Control>y", "<Control>y",                \
      "Make the edit again that was undone")                                                                           \
    X(DO_MOVE, "move", "_Move", MENU_EDIT, NEEDS_SELECTION, "g", "m", "Drag the selection; the wheel pushes it away")  \
    X(DO_TURN, "turn", "_Turn", MENU_EDIT, NEEDS_SELECTION, "r", "t", "Rotate the selection by dragging")              \
    X(DO_SIZE, "size", "Si_ze", MENU_EDIT, NEEDS_SELECTION, "s", "z", "Scale the selection by dragging")               \
    X(DO_COPY, "copy", "_Copy", MENU_EDIT, NEEDS_SELECTION, "<Shift>d", "<Control>d", "Copy the selection")            \
    X(DO_DELETE, "delete", "_Delete", MENU_EDIT, NEEDS_SELECTION, "x Delete", "Delete", "Remove the selection")        \
    X(DO_SOLO, "solo", "Sh_ow It Alone", MENU_EDIT, NEEDS_PICTURE, "slash KP_Divide", "slash",                         \
      "Draw the selection only; again: draw everything")                                                               \
    X(DO_OWN_MATERIAL, "own-material", "Give It Its _Own Material", MENU_EDIT, NEEDS_SELECTION, "", "",                \
      "Edits of the material then change no other shape")                                                              \
    X(DO_SELECT_PARENT, "select-parent", "Select _Parent", MENU_EDIT, NEEDS_SELECTION, "Page_Up", "Page_Up",           \
      "Select the node above")                                                                                         \
    X(DO_SELECT_OPERAND, "select-operand", "Select _Operand", MENU_EDIT, NEEDS_SELECTION, "Page_Down", "Page_Down",    \
      "Select the operand one level below")                                                                            \
    X(DO_NEXT_LIGHT, "next-light", "Next _Light", MENU_EDIT, NEEDS_PICTURE, "l", "l", "Select the next light")         \
    X(DO_PREVIOUS_LIGHT, "previous-light", "Pre_vious Light", MENU_EDIT, NEEDS_PICTURE, "<Shift>l", "<Shift>l",        \
      "Select the previous light")                                                                                     \
    X(DO_ESCAPE, "escape", "Clear Selec_tion", MENU_EDIT, NEEDS_NOTHING, "Escape", "Escape",                           \
      "End a tool, the selection, rendering, or a script that makes no picture")                                       \
    X(DO_CAMERA, "camera", "Script's _Camera", MENU_VIEW, NEEDS_VIEW, "KP_0 0", "<Control>0",                          \
      "Return to the camera of the script")                                                                            \
    X(DO_FRAME_ALL, "frame-all", "Frame _All", MENU_VIEW, NEEDS_VIEW, "Home", "<Control><Shift>0 Home",                \
      "Show the whole scene")                                                                                          \
    X(DO_FRAME, "frame", "Frame Selec_tion", MENU_VIEW, NEEDS_SELECTION, "period KP_Decimal", "period",                \
      "Show the selection as large as possible")                                                                       \
    X(DO_VIEW_FRONT, "view-front", "_Front", MENU_VIEW, NEEDS_PICTURE, "1 KP_1", "<Control>8", "Look along -z")        \
    X(DO_VIEW_RIGHT, "view-right", "_Right", MENU_VIEW, NEEDS_PICTURE, "3 KP_3", "<Control>7", "Look along -x")        \
    X(DO_VIEW_TOP, "view-top", "_Top", MENU_VIEW, NEEDS_PICTURE, "7 KP_7", "<Control>4", "Look down")                  \
    X(DO_LEVEL, "level", "_Level the Horizon", MENU_VIEW, NEEDS_PICTURE, "<Control>l", "<Control>l",                   \
      "Roll until the horizon is level")                                                                               \
    X(DO_ROLL_LEFT, "roll-left", "Roll L_eft", MENU_VIEW, NEEDS_PICTURE, "bracketleft", "bracketleft", "By 5 degrees") \
    X(DO_ROLL_RIGHT, "roll-right", "Roll R_ight", MENU_VIEW, NEEDS_PICTURE, "bracketright", "bracketright",            \
      "By 5 degrees")                                                                                                  \
    X(DO_VIEW_BACK, "view-back", "_Previous View", MENU_VIEW, NEEDS_PICTURE, "<Alt>Left", "<Alt>Left",                 \
      "Return to where the camera was before")                                                                         \
    X(DO_VIEW_FORWARD, "view-forward", "_Next View", MENU_VIEW, NEEDS_PICTURE, "<Alt>Right", "<Alt>Right",             \
      "The view from which you returned")                                                                              \
    X(DO_FLY, "fly", "Fl_y", MENU_VIEW, NEEDS_PICTURE, "grave", "grave",                                               \
      "W, A, S, D, E and Q fly, a held button looks about; Shift is fast, Ctrl slow; Esc ends it")                     \
    X(DO_SHOW_PICTURE, "show-picture", "Show the _Picture", MENU_VIEW, NEEDS_PICTURE, "<Alt>1", "<Alt>1",              \
      "Show the picture of the integrator")                                                                            \
    X(DO_SHOW_PREVIEW, "show-preview", "Show the Previe_w", MENU_VIEW, NEEDS_PICTURE, "<Alt>2", "<Alt>2",              \
      "Show colours under a light at the eye; no picture is rendered")                                                 \
    X(DO_SHOW_NORMALS, "show-normals", "Show _Normals", MENU_VIEW, NEEDS_PICTURE, "<Alt>3", "<Alt>3",                  \
      "Show the directions of surfaces as colours")                                                                    \
    X(DO_SHOW_DEPTH, "show-depth", "Show the _Depth", MENU_VIEW, NEEDS_PICTURE, "<Alt>4", "<Alt>4",                    \
      "Show how near surfaces are")                                                                                    \
    X(DO_SHOW_COST, "show-cost", "Show the _Cost", MENU_VIEW, NEEDS_PICTURE, "<Alt>5", "<Alt>5",                       \
      "Show the work for each ray, from blue to red")                                                                  \
    X(DO_SHOW_FACTORS, "show-factors", "Show _Form Factors", MENU_VIEW, NEEDS_PICTURE, "<Alt>6", "<Alt>6",             \
      "Radiosity: how much of what surfaces see is the patch under the mouse")                                         \
    X(DO_BOXES, "boxes", "_Boxes of the Objects", MENU_VIEW, NEEDS_PICTURE, "b", "b", "Draw the box of every object")  \
    X(DO_GRID, "grid", "_Grid of the Accelerator", MENU_VIEW, NEEDS_PICTURE, "n", "g",                                 \
      "Draw the cells of the acceleration structure")                                                                  \
    X(DO_PATCHES, "patches", "P_atches of Radiosity", MENU_VIEW, NEEDS_PICTURE, "<Alt>b", "<Alt>b",                    \
      "Draw the patches that store light")                                                                             \
    X(DO_HIDE, "hide", "_Hide Symbols", MENU_VIEW, NEEDS_NOTHING, "h", "h", "Hide what is drawn over the picture")     \
    X(DO_FULL_SCREEN, "full-screen", "F_ull Screen", MENU_VIEW, NEEDS_NOTHING, "F11", "F11", "The whole screen")       \
    X(DO_RENDER, "render", "_Render Again", MENU_PICTURE, NEEDS_NOTHING, "F12 F5", "F6 F5",                            \
      "Render again, from coarse to fine")                                                                             \
    X(DO_STOP, "stop", "_Stop", MENU_PICTURE, NEEDS_PICTURE, "<Control>period", "<Control>period",                     \
      "Stop rendering or building; again, or an edit: continue")                                                       \
    X(DO_BRIGHTER, "brighter", "_Brighter", MENU_PICTURE, NEEDS_NOTHING, "plus KP_Add equal", "plus equal",            \
      "A quarter of a stop")                                                                                           \
    X(DO_DARKER, "darker", "_Darker", MENU_PICTURE, NEEDS_NOTHING, "minus KP_Subtract", "minus",                       \
      "A quarter of a stop")                                                                                           \
    X(DO_PIXEL_TRACE, "pixel-trace", "_Explain the Pixel", MENU_PICTURE, NEEDS_PICTURE, "p", "p",                      \
      "Show how the pixel under the mouse got its colour")                                                             \
    X(DO_PLAY, "play", "_Play or Pause", MENU_ANIMATION, NEEDS_FRAMES, "space", "space", "Play the animation")         \
    X(DO_PREVIOUS_FRAME, "previous-frame", "P_revious Frame", MENU_ANIMATION, NEEDS_FRAMES, "<Control>Left",           \
      "<Control>Left", "Go to the previous frame")                                                                     \
    X(DO_NEXT_FRAME, "next-frame", "_Next Frame", MENU_ANIMATION, NEEDS_FRAMES, "<Control>Right", "<Control>Right",    \
      "Go to the next frame")                                                                                          \
    X(DO_LOOP, "loop", "_Loop", MENU_ANIMATION, NEEDS_FRAMES, "<Control>k", "<Control>k", "Play it again at its end")
enum window_action { WINDOW_ACTIONS(LIST_MEMBER) };
enum { WINDOW_ACTION_COUNT = LIST_COUNT(WINDOW_ACTIONS) };

#define WINDOW_KEY_SETS(X) X(KEYS_BLENDER, "Blender") X(KEYS_OPENSCAD, "OpenSCAD")
enum window_key_set { WINDOW_KEY_SETS(LIST_MEMBER) };
enum { WINDOW_KEY_SET_COUNT = LIST_COUNT(WINDOW_KEY_SETS) };

struct window_action_row {
    const char *name, *title; /* the underscore is before the letter for the keyboard */
    enum window_menu menu;
    enum action_need need;
    const char *keys[WINDOW_KEY_SET_COUNT];
    const char *help;
};
extern const struct window_action_row window_action_table[WINDOW_ACTION_COUNT];

#endif
