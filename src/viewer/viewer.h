/* A picture in a window: shows it while it is rendered, takes input, and decides what the render process does next. The
 * render process renders one pass after the other (coarse ones first, and while the camera moves), replies after each,
 * and waits for the next command. The supervisor does not wait: it draws the window from the film in its current state.
 * viewer.c decides, viewer_input.c reads keys and mouse, viewer_form.c has the inputs of the inspector, viewer_edit.c
 * and viewer_lights.c change the scene, viewer_player.c plays animations, viewer_draw.c and viewer_overlay.c draw. */
#ifndef GRAY_VIEWER_VIEWER_H
#define GRAY_VIEWER_VIEWER_H

#include "base/file_output.h"
#include "base/share.h"
#include "film/film.h"
#include "image/tone_lookup.h"
#include "preview/preview_messages.h"
#include "render/fly_camera.h"
#include "scene/edits.h"
#include "session/control.h"
#include "window/window.h"

enum viewer_action {
    VIEWER_NOTHING,
    VIEWER_STOP_PASS,      /* the current pass is obsolete */
    VIEWER_SEND_COMMAND,   /* viewer->command must be sent */
    VIEWER_WRITE_PICTURE,  /* the script's own picture is complete for the first time: write it */
    VIEWER_SAVE_IMAGE,     /* the displayed image must be saved: viewer->window.image */
    VIEWER_SAVE_CAMERA,    /* the camera must be saved */
    VIEWER_SAVE_EDITS,     /* the edits must be saved */
    VIEWER_EXPORT_MODEL,   /* a model must be written: viewer->save_as */
    VIEWER_CHANGE_SETTING, /* the scripts must run again with viewer->setting */
    VIEWER_RUN_AGAIN,      /* the scripts must run again */
    VIEWER_END_SCRIPTS,    /* they must end */
    VIEWER_LOG_NOTE,       /* viewer->note is a line for the log */
    VIEWER_NEXT_FRAME,     /* the same, and the animation goes to viewer_next_frame */
    VIEWER_NEXT_PICTURE,   /* this picture is finished: the script continues */
    VIEWER_QUIT,           /* the window was closed, or Q */
};

/* The window, and the position of the picture in it, in pixels of the screen. */
struct window_layout {
    int width, height;
    double density;
    double left, top, shown_width, shown_height;
};

/* What was clicked on. */
enum selected { SELECTED_NOTHING, SELECTED_NODE, SELECTED_LIGHT, SELECTED_MATERIAL };
struct selection {
    enum selected kind;
    struct picked picked;     /* of a node, as it was when it was picked */
    struct transform applied; /* the change of its pose at that time */
    uint32_t light;           /* number, from 1 */
    double x, y;              /* the clicked position: pixels of the whole picture */
    struct node_query node;   /* where it was chosen in the tree; depth 0: by a click */
    int32_t up;               /* levels above the node that was hit; if negative, levels of operands below it */
};
/* The action of the mouse on the selection. */
enum edit_tool { TOOL_NONE, TOOL_MOVE, TOOL_TURN, TOOL_SIZE };

/* The work of the render process for the window. */
enum pass_state {
    PASS_BUSY,     /* no pass: it builds the world, or executes another command */
    PASS_RUNNING,  /* it renders a pass */
    PASS_STOPPING, /* a stop was requested */
    PASS_WAITING,  /* for a command */
};
/* The result of the last pass. */
enum pass_result {
    RESULT_NONE,     /* nothing useful */
    RESULT_STOPPED,  /* some of its tiles: it can continue */
    RESULT_COARSE,   /* a picture with few samples */
    RESULT_COMPLETE, /* the picture with the settings of the script */
};

struct viewer_pass {
    enum pass_state state;
    enum pass_result result;
    struct pass_view view;        /* of the current or last pass */
    struct film film;             /* as that pass lays it out */
    struct picture_report report; /* of the last pass that was finished */
    bool edited;                  /* for a changed scene */
    uint32_t divide;              /* of passes while the camera moves */
    bool walks;                   /* a device makes these, with all pixels */
    double began;
    bool outdated;    /* the camera is not that of `view`, or the scene was changed */
    bool from_coarse; /* the next pass is a coarse one (R) */
    bool halted;      /* by the user: no pass starts until the user does something */
    bool unbuilt;     /* the render process has no world of the current changes */
    double halted_at; /* 0: the time of the stop was reported */
};

/* A movement of the camera, for the log. */
struct viewer_motion {
    double began, last, first_shown; /* the first and the last change of the view, and the first picture after them */
    uint32_t pictures, divide;       /* shown while it moved, the last one with this resolution */
};

/* Rows of the tree that the window wants; later ones are dropped, and wanted again when they come into view. */
enum { NODE_QUERIES = 64 };
struct viewer_nodes {
    struct node_query wanted[NODE_QUERIES];
    uint32_t count, added; /* added: nodes that edits have added to the tree */
};

/* The changes of the scene, and the state for making them. */
struct viewer_edit {
    struct edits steps;
    uint32_t saved_at;          /* steps.at when the edits were saved last */
    struct change_list pending; /* not sent yet: the current changes of these targets */
    struct selection selection;
    struct selection click; /* the position of the click, while click_waits: it was not sent yet */
    bool click_waits;
    bool by_node;              /* the click is on this node in the tree */
    char texture[CHANGE_CALL]; /* the call of one for what was clicked, or empty */
    struct node_query node;
    bool probes; /* the click only asks what is under the mouse: the point that orbits go round */
    enum edit_tool tool;
    int axis;       /* that the tool is for, from 1; 0: it is free */
    bool handle;    /* the tool ends when the button is released */
    char typed[24]; /* the number for the tool */
    bool joins;     /* the next change by the mouse is part of the last one */
};

/* Lights of the scene as they are reported, in parts. */
struct viewer_lights {
    struct light_info *items; /* owned; those from `known` on were not reported yet */
    uint32_t count, known;
};

/* The trace of a pixel. */
struct viewer_trace {
    bool requested;          /* of the pixel x, y of the whole picture; it was not sent yet */
    double x, y;             /* pixels of the whole picture */
    char text[WINDOW_TRACE]; /* empty: none is shown */
};

/* What is drawn over the picture (viewer_draw.c): the render process makes lines of pixels, and the outline. */
struct viewer_overlay {
    enum overlay kind;               /* which lines are wanted */
    float (*lines)[4];               /* over the image, where has_lines; owned */
    bool has_lines;                  /* lines are visible, possibly those of another view */
    bool lines_fresh, outline_fresh; /* those of the view in full detail, or a failed request */
    struct window_line *outline;     /* in pixels of the picture; owned */
    uint32_t outline_count;          /* 0: there is none, or it is too long */
};

/* The content of the screen, of this picture. */
struct viewer_display {
    size_t tiles;   /* room in window.drawn */
    bool hud_dirty; /* the lines over the image, and the widgets, are out of date */
    double shown_at, figures_at;
};

/* The mouse. */
struct viewer_input {
    double x, y;             /* where it is */
    bool flies;              /* letters move the camera, and a held button turns it */
    int pressed;             /* the button that is down on the picture, or 0 */
    bool dragged, shift;     /* the mouse has moved since; shift was held */
    double press_x, press_y; /* where */
};

/* The frames of an animation (viewer_player.c). Zero value: the picture is not one of an animation. */
struct viewer_player {
    uint32_t first, step, count; /* the frames that can be shown: first, first + step ... */
    bool playing, loops;
    uint32_t target;     /* the frame to go to, or 0 */
    bool seeking;        /* it was requested, and its pass has not begun */
    bool shown;          /* playing: this frame is on the screen */
    double requested_at; /* when it was requested; 0: not measured */
    bool restarts_clock; /* the next frame is due immediately */
    bool forgives_delay; /* do not skip frames, even if the next one comes late */
    double origin;       /* when the frame with the index origin_index was due */
    uint32_t origin_index;
    double late, shown_at, began; /* seconds after its time, when it was shown, when playing began */
    double rate;                  /* frames per second, of the last ones */
    uint32_t played, left_out;    /* since playing began */
};

/* The view at the resolution of the window (viewer_large.c). */
struct viewer_large {
    struct share memory;    /* of its film; owned */
    uint32_t width, height; /* of the part that is rendered */
    uint8_t *image;         /* 3 bytes for each pixel; owned */
    uint8_t *drawn;         /* by tile, as in the display; owned */
    size_t tiles;
    bool shown;                             /* displayed instead of the image of the display */
    bool stale;                             /* the image must be drawn again */
    uint32_t refused_width, refused_height; /* there was no memory for this size */
};

/* A line that is shown for some seconds: the name of a saved file, or an error. */
struct viewer_notice {
    char text[512];
    bool warns;
    double until; /* 0: it is new */
};

/* A setting that the user has changed, as if its option were given. */
struct viewer_setting {
    int index; /* of setting_table */
    double number;
};

/* What the view shows when the camera stands: the picture, or the preview of all pixels. */
struct view_mode {
    bool previews;
    enum headlight_shows shows;
    struct view_point patch; /* of HEADLIGHT_FACTORS */
};

/* The window and its state: what stays from one picture to the next. */
struct viewer_window {
    const struct window_driver *driver;
    bool open;
    const struct control *control; /* or NULL; set by the caller, not owned */
    unsigned number;               /* of the picture among those of a run, from 1; kept by the caller */
    bool logs_notes;               /* whether to make notes; set by the caller */
    bool waits;                    /* no script runs; set by the caller */
    struct view_mode mode;
    bool changed;                  /* a file has changed that an older picture was made of */
    double script_began;           /* when the scripts began to run; set by the caller */
    bool sends_memory;             /* whether a larger pass has sent memory; set by the caller */
    struct frame_selection frames; /* of animations; set by the caller */
    uint8_t *image;                /* 3 bytes for each pixel of the whole part; owned */
    struct tone_lookup *tones;     /* owned */
    float *light;                  /* the same before exposure and tone; owned */
    uint8_t *drawn;                /* by tile: the state in which it is on the image, or 0; owned */
    bool dirty;                    /* the image was changed since it was shown */
    struct window_layout layout;
    bool hides_lines; /* over the picture */
    struct viewer_notice notice;
    struct viewer_large large;
};

/* Zero value: no window. The members after `window` begin anew with each picture. */
struct viewer {
    struct viewer_window window;
    bool keep; /* the scripts run again: camera and edits are kept, earlier pictures are skipped */

    struct picture_request request;
    void *block;                /* of the film; not owned; NULL: no picture in progress */
    char name[4096];            /* of the picture */
    double script_exposure;     /* stops */
    struct preview_reply scene; /* its root, as reported last */
    bool written;               /* the script's picture is written */
    char message[512];          /* an error, or empty */
    char note[160];             /* for the log, or empty */
    double built;               /* when the world was built; 0: already reported */
    double begun, finished;     /* the picture; 0: not yet */

    struct fly_camera fly_camera;
    bool camera_moved; /* it differs from the script's */
    struct viewer_pass pass;
    struct viewer_motion motion; /* began 0: reported */
    struct viewer_edit edit;
    struct viewer_nodes nodes;
    struct node_rows rows; /* the last ones that have come */
    struct viewer_lights lights;
    struct viewer_trace trace;
    struct viewer_overlay overlay;
    struct viewer_display display;
    struct viewer_input input;
    struct viewer_player player;

    double stepped;                 /* time of the last call of viewer_step */
    struct preview_command command; /* for VIEWER_SEND_COMMAND */
    struct viewer_setting setting;  /* for VIEWER_CHANGE_SETTING */
    enum viewer_action action;      /* requested by a key or a button */
    bool next, quit;                /* likewise: the next picture, the end */
    char save_as[1024];             /* the file for an action that saves; empty: a new name */
};

/* A picture to be rendered. */
struct viewer_picture {
    const struct picture_request *request;
    void *block; /* of its film; valid until viewer_detach */
    const char *name;
};
/* Opens the window. Owner: the caller; viewer_end releases everything. */
bool viewer_begin(struct viewer *viewer, const struct window_driver *driver, const struct viewer_picture *picture,
                  double now, struct error *error);
void viewer_end(struct viewer *viewer);
/* Opens it before the first picture, with the probable size of that picture. */
bool viewer_open(struct viewer *viewer, const struct window_driver *driver, const char *title, uint32_t width,
                 uint32_t height, struct error *error);
/* The film is removed: the last image remains visible. */
void viewer_detach(struct viewer *viewer);
/* Whether the film holds tiles of the picture of the script, not of another view or a coarse pass. */
bool viewer_has_tiles(const struct viewer *viewer);
/* The scripts will run again for the picture in the window. */
void viewer_keep(struct viewer *viewer);
/* Whether the picture with this number is skipped, since a later one is in the window. */
bool viewer_skips(const struct viewer *viewer, unsigned number);
/* Whether a changed file must wait until the user wants the picture to be made again: it has taken long. */
bool viewer_delays_change(struct viewer *viewer, double now);
/* Nothing happens before the user does something. */
bool viewer_rests(const struct viewer *viewer);
/* For control.next_frame: the requested or visible frame; FRAMES_OVER if the script is to continue after the animation;
 * or 0. */
uint32_t viewer_next_frame(const struct viewer *viewer);
/* Shows the first line of an error until a picture begins. */
void viewer_show_message(struct viewer *viewer, const char *text);
/* Shows it for some seconds, also in the title. */
void viewer_show_notice(struct viewer *viewer, const char *text, bool warns);
/* A piece of the pixel trace that was requested. */
void viewer_add_pixel_trace(struct viewer *viewer, const char *text);
/* A command has been executed; the render process waits for the next one. */
void viewer_receive_reply(struct viewer *viewer, const struct preview_reply *reply, double now);
/* Handles events, draws, and returns the next action. To be called every few milliseconds, repeatedly until it returns
 * VIEWER_NOTHING. */
enum viewer_action viewer_step(struct viewer *viewer, double now);

#endif
