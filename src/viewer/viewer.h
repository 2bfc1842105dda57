/* A picture in a window: shows it while it is rendered, takes input, and decides what the render process does next. The
 * render process renders one pass after the other (coarse ones first, and while the camera moves), replies after each,
 * and waits for the next command. Neither waits otherwise: the window is drawn from the film as it is.
 * viewer.c decides, viewer_input.c reads keys and mouse, viewer_edit.c and viewer_lights.c change the scene,
 * viewer_draw.c, viewer_hud.c and viewer_panel.c draw. */
#ifndef GRAY_VIEWER_VIEWER_H
#define GRAY_VIEWER_VIEWER_H

#include "base/file_output.h"
#include "render/film.h"
#include "session/control.h"
#include "session/messages.h"
#include "viewer/edits.h"
#include "viewer/fly_camera.h"
#include "viewer/panel.h"
#include "viewer/window.h"

/* A side between a pixel that shows what is selected and one that does not: of the pixel (x, y), its left one or its
 * upper one. */
struct outline_side {
    uint32_t x, y;
    bool upright;
};

enum viewer_action {
    VIEWER_NOTHING,
    VIEWER_STOP_PASS,     /* the pass that runs is of no use any more */
    VIEWER_SEND_COMMAND,  /* viewer->command is to be sent */
    VIEWER_WRITE_PICTURE, /* the script's own picture is complete for the first time: write it */
    VIEWER_SAVE_IMAGE,    /* what is shown is to be saved: viewer->display.image */
    VIEWER_SAVE_CAMERA,   /* the camera is to be saved */
    VIEWER_SAVE_EDITS,    /* the edits are to be saved */
    VIEWER_LOG_NOTE,      /* viewer->note is a detail for the log */
    VIEWER_NEXT_PICTURE,  /* this picture is done with: the script goes on */
    VIEWER_QUIT,          /* the window was closed, or Q */
};

/* The window, and where the picture is in it: pixels of the screen. */
struct window_layout {
    int width, height;
    double density;
    double left, top, shown_width, shown_height;
};

/* What was clicked on. */
enum selected { SELECTED_NOTHING, SELECTED_NODE, SELECTED_LIGHT };
struct selection {
    enum selected kind;
    struct picked picked;     /* of a node, as it was when it was picked */
    struct transform applied; /* the change of its pose at that time */
    uint32_t light;           /* number, from 1 */
    double x, y;              /* where it was clicked: pixels of the whole picture */
    int32_t up;               /* nodes above what was hit; below 0: operands below it */
};
/* What the mouse does with what is selected. */
enum edit_tool { TOOL_NONE, TOOL_MOVE, TOOL_TURN, TOOL_SIZE };

/* What the render process does for the window. */
enum pass_state {
    PASS_BUSY,     /* no pass: it builds the world, or answers another command */
    PASS_RUNNING,  /* it renders a pass */
    PASS_STOPPING, /* a stop was requested */
    PASS_WAITING,  /* for a command */
};
/* What the last pass has left. */
enum pass_result {
    RESULT_NONE,     /* nothing that counts any more */
    RESULT_STOPPED,  /* some of its tiles: it can go on */
    RESULT_COARSE,   /* a picture with few samples */
    RESULT_COMPLETE, /* the picture as the script wants it */
};

struct viewer_pass {
    enum pass_state state;
    enum pass_result result;
    struct pass_view view;        /* of the pass that runs or ran last */
    struct film film;             /* as that pass lays it out */
    struct picture_report report; /* of the last pass that was finished */
    bool edited;                  /* it shows a changed scene */
    uint32_t divide;              /* of passes while the camera moves */
    double began;
    bool outdated;    /* the camera is not that of `view`, or the scene was changed */
    bool from_coarse; /* the next pass is a coarse one (R) */
    bool halted;      /* by the user: nothing is begun until something is wanted */
    bool unbuilt;     /* the render process has no world of what is wanted */
    double halted_at; /* 0: the time of the stop was reported */
};

/* What is changed in the scene, and what it is changed by. */
struct viewer_edit {
    struct edits steps;
    struct change_list pending; /* not sent yet: what holds now for these targets */
    struct selection selection;
    struct selection click; /* where something is to be selected, while click_waits: it was not sent yet */
    bool click_waits;
    enum edit_tool tool;
    enum material_part part; /* of the material, that the panel has sliders for */
    bool joins;              /* the next change by the mouse is part of the last one */
};

/* Lights of the scene as they are reported, in parts. */
struct viewer_lights {
    struct light_info *items; /* owned; those from `known` on are not known yet */
    uint32_t room, count, known;
    double colour_max;   /* of the sliders of a light's colour */
    bool listed;         /* a list of them is shown ... */
    uint32_t list_first; /* ... from this one on */
};

/* How the colour of a pixel came about. */
struct viewer_trace {
    bool wanted;      /* of the pixel x, y of the whole picture; it was not sent yet */
    double x, y;      /* pixels of the whole picture */
    char text[16384]; /* empty: none is shown */
    int line;         /* the first one shown */
};

/* What lies over the picture and is made by the render process (viewer_overlay.c). */
struct viewer_overlay {
    enum overlay kind;               /* which lines are wanted */
    float (*lines)[4];               /* over the image, where has_lines; owned */
    bool has_lines;                  /* some are shown, perhaps those of another view */
    bool lines_fresh, outline_fresh; /* those of the view, as fine as they can be; or asked for in vain */
    struct outline_side *sides;      /* the outline; owned */
    uint32_t side_count, side_room;
};

/* What is on the screen. */
struct viewer_display {
    uint8_t *image; /* 3 bytes a pixel of the whole part; owned */
    float *light;   /* the same before exposure and tone; owned */
    uint8_t *drawn; /* by tile: the state in which it is on the image, or 0; owned */
    size_t tiles;   /* room in drawn */
    struct window_layout layout;
    struct panel panel; /* its canvas is owned */
    int panel_height;   /* of the panel of the selection, as it was needed last */
    bool hides_hud;     /* nothing is drawn over the picture */
    bool dirty;         /* the image was changed since it was shown */
    bool hud_dirty;     /* what is drawn over it is out of date */
    double shown_at, figures_at;
};

/* The mouse. */
struct viewer_input {
    bool grabbed;            /* it turns the camera */
    bool pressed, dragged;   /* the left button is down on the picture, and has moved since */
    double press_x, press_y; /* where */
};

/* Zero value: no window. */
struct viewer {
    const struct window_driver *driver;
    const struct control *control; /* or NULL; set by the caller, not owned */
    unsigned number;               /* of the picture among those of a run, from 1; kept by the caller */
    bool logs_notes;               /* notes are wanted; set by the caller */
    bool open;
    bool keep; /* the scripts run again: camera and edits stay, pictures before are left out */

    struct picture_request request;
    void *block;                /* of the film; not owned; NULL: no picture is being made */
    char name[4096];            /* of the picture */
    double script_exposure;     /* stops */
    struct preview_reply scene; /* its root, as reported last */
    bool written;               /* the script's picture is in its file */
    char message[512];          /* an error, or empty */
    char note[160];             /* for the log, or empty */
    double built;               /* when the world was; 0: that was reported */

    struct fly_camera fly_camera;
    bool camera_moved; /* it is not the script's any more */
    struct viewer_pass pass;
    struct viewer_edit edit;
    struct viewer_lights lights;
    struct viewer_trace trace;
    struct viewer_overlay overlay;
    struct viewer_display display;
    struct viewer_input input;

    double stepped;                 /* when viewer_step was called last */
    struct preview_command command; /* for VIEWER_SEND_COMMAND */
    enum viewer_action action;      /* wanted by a key or a button */
    bool next, quit;                /* the same: the next picture, the end */
};

/* A picture that is about to be made. */
struct viewer_picture {
    const struct picture_request *request;
    void *block; /* of its film; it stays until viewer_detach */
    const char *name;
};
/* Opens the window. Owner: the caller; viewer_end gives everything back. */
bool viewer_begin(struct viewer *viewer, const struct window_driver *driver, const struct viewer_picture *picture,
                  double now, struct error *error);
void viewer_end(struct viewer *viewer);
/* The film goes away: what was shown last stays. */
void viewer_detach(struct viewer *viewer);
/* The scripts will run again for what is in the window. */
void viewer_keep(struct viewer *viewer);
/* Whether a picture of this number is left out, since a later one is in the window. */
bool viewer_skips(const struct viewer *viewer, unsigned number);
/* Shows what went wrong until a picture begins; the first line is shown. */
void viewer_show_message(struct viewer *viewer, const char *text);
/* A piece of the pixel trace that was requested. */
void viewer_add_pixel_trace(struct viewer *viewer, const char *text);
/* A command is done; the render process waits for the next one. */
void viewer_take_reply(struct viewer *viewer, const struct preview_reply *reply, double now);
/* Takes events, draws, decides. To be called until it says VIEWER_NOTHING, every few milliseconds. */
enum viewer_action viewer_step(struct viewer *viewer, double now);

/* Saving the image as it is shown, the camera, and the edits (viewer_edit.c). */
/* `picture` has the name of the picture and rules that replace nothing. Both choose a name that is still free:
 * dir/foo.png gives dir/foo-view1.png, dir/foo-view1.lua and so on; it is put into `name` (4096 bytes). The Lua file
 * gives back a table of eye, view, up and fov with every digit. */
bool viewer_save_image(const struct viewer *viewer, const struct file_target *picture, char *name, struct error *error);
bool viewer_save_camera(const struct viewer *viewer, const struct file_target *picture, char *name,
                        struct error *error);
/* dir/foo-changes1.lua: required by the scene, it gives the picture the camera, the exposure and all that was changed.
 */
bool viewer_save_edits(const struct viewer *viewer, const struct file_target *picture, char *name, struct error *error);

#endif
