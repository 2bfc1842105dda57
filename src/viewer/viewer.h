/* A picture in a window: shows it while it is made, lets people walk and change things, and decides what the child does
 * next. The child renders one pass after the other (coarse ones first, and while somebody walks) and asks after each
 * what comes next; the answer is an order. Neither waits for the other: the window is drawn from the film as it is.
 * viewer.c decides, viewer_input.c reads what people do, viewer_edit.c and viewer_lights.c change the scene,
 * viewer_draw.c, viewer_hud.c and viewer_panel.c draw. */
#ifndef GRAY_VIEWER_VIEWER_H
#define GRAY_VIEWER_VIEWER_H

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
    VIEWER_SEND_COMMAND,  /* the child waits: send viewer->command */
    VIEWER_WRITE_PICTURE, /* the script's own picture is complete for the first time: write it */
    VIEWER_SAVE_IMAGE,    /* somebody wants what is shown in a file: viewer->image */
    VIEWER_SAVE_CAMERA,   /* somebody wants the camera in a file: fly_camera_camera(&viewer->fly_camera) */
    VIEWER_SAVE_EDITS,    /* somebody wants what was changed in a file */
    VIEWER_LOG_NOTE,      /* viewer->note is to be told where details are */
    VIEWER_NEXT_PICTURE,  /* the child waits, and this picture is done with: the script goes on */
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
    struct picked picked;    /* of a node, as it was when it was picked */
    struct transform placed; /* the change of its place at that time */
    uint32_t light;          /* number, from 1 */
    double x, y;             /* where it was clicked: pixels of the whole picture */
    int32_t up;              /* nodes above what was hit; below 0: operands below it */
};
/* What the mouse does with what is selected. */
enum edit_tool { TOOL_NONE, TOOL_MOVE, TOOL_TURN, TOOL_SIZE };

struct viewer {
    const struct window_driver *driver;
    const struct control *control; /* or NULL; set by the caller, not owned */
    struct fly_camera fly_camera;
    struct picture_request request;
    void *block;                    /* of the film; not owned; NULL: no picture is being made */
    char name[4096];                /* of the picture */
    unsigned number;                /* of the picture among those of a run, from 1; kept by the caller */
    char message[512];              /* what went wrong, or empty */
    struct pass_view view;          /* of the pass that runs or ran last */
    struct film film;               /* as that pass lays it out */
    struct preview_command command; /* for VIEWER_SEND_COMMAND */
    struct picture_report report;   /* of the last pass that was finished */
    uint8_t *image;                 /* what is shown: 3 bytes a pixel of the whole part */
    float *light;                   /* the same before exposure and tone */
    uint8_t *drawn;                 /* by tile: already on the canvas */
    size_t tiles;                   /* room in drawn */
    struct window_layout layout;
    struct panel panel; /* its paper is owned */
    bool hides_overlay; /* nothing is drawn over the picture */
    enum viewer_action action;

    struct edits edits;
    struct change_list pending; /* what the child has not been told yet: what holds now for these targets */
    struct preview_reply scene; /* lights and root, as the child told last */
    struct light_info *lights;  /* owned; those from lights_known on are not known yet */
    uint32_t light_room, light_count, lights_known;
    double light_colour_max; /* of the sliders of a light's colour */
    bool lists_lights;       /* a list of them is shown, from this one on: */
    uint32_t list_first;
    struct selection selection, asked; /* asked: a click that the child is to answer */
    bool asks;
    bool wants_trace;        /* of the pixel under the mouse */
    double trace_x, trace_y; /* pixels of the whole picture */
    char trace_text[16384];  /* of a pixel, in words; empty: none is shown */
    int trace_line;          /* the first one shown */
    enum edit_tool tool;
    enum look_part part;    /* of the material, that the panel has sliders for */
    int panel_height;       /* of the panel of the selection, as it was needed last */
    bool joins;             /* the next change by the mouse is part of the last one */
    double script_exposure; /* stops */

    bool open, running, stopping, waiting;
    bool moved;             /* the camera is not the one of the view that was sent last, or the scene was changed */
    bool camera_moved;      /* it is not the script's any more */
    bool again;             /* R */
    bool partial;           /* the last pass was stopped for a moment, and can go on */
    bool edited;            /* the last pass shows a changed scene */
    bool complete, written; /* the last pass was the finest; the script's picture was written */
    /* What lies over the picture and is made by the child (viewer_overlay.c). */
    enum overlay overlay;            /* what people want to see */
    float (*lines)[4];               /* over the canvas, where has_lines; owned */
    bool has_lines;                  /* some are shown, perhaps those of another view */
    bool lines_fresh, outline_fresh; /* those of the view, as fine as they can be; or asked for in vain */
    struct outline_side *sides;      /* the outline; owned */
    uint32_t side_count, side_room;

    bool halted;  /* somebody said stop: nothing is begun until something is wanted */
    bool unbuilt; /* the child has no world of what is wanted */
    bool grabbed, next, quit;
    bool keep; /* the scripts run again: the camera stays where somebody has flown, pictures before are left out */
    bool pressed, dragged;   /* the left button is down on the picture, and has moved since */
    double press_x, press_y; /* where */
    uint32_t divide;         /* of passes while somebody walks */
    double pass_began, stepped, shown, figures_at;
    double built, halted_at; /* 0: what was to be told of them has been told */
    bool logs_notes;         /* notes are wanted */
    char note[160];
    bool dirty;      /* the canvas was changed since it was shown */
    bool over_dirty; /* what is drawn over it is not right any more */
};

/* Opens the window. Owner: the caller; viewer_end gives everything back. */
bool viewer_begin(struct viewer *viewer, const struct window_driver *driver, const struct picture_request *request,
                  void *block, const char *name, double now, struct error *error);
void viewer_end(struct viewer *viewer);
/* The film goes away: what was shown last stays. */
void viewer_detach(struct viewer *viewer);
/* The scripts will run again for what is in the window. */
void viewer_keep(struct viewer *viewer);
/* Whether a picture of this number is left out, since people look at a later one. */
bool viewer_skips(const struct viewer *viewer, unsigned number);
/* Shows what went wrong until a picture begins; the first line is shown. */
void viewer_show_message(struct viewer *viewer, const char *text);
/* A piece of a story that was asked for. */
void viewer_add_pixel_trace(struct viewer *viewer, const char *text);
/* Something is done; the child waits for the next order. */
void viewer_take_reply(struct viewer *viewer, const struct preview_reply *reply, double now);
/* Takes events, draws, decides. To be called until it says VIEWER_NOTHING, every few milliseconds. */
enum viewer_action viewer_step(struct viewer *viewer, double now);

#endif
