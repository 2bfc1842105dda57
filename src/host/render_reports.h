/* What the render process reports about scenes and pictures. */
#ifndef GRAY_HOST_RENDER_REPORTS_H
#define GRAY_HOST_RENDER_REPORTS_H

#include "host/render_process_internal.h"

void render_process_finish_output(const struct render_process *process);
void render_process_report(const struct render_process *process, enum line_kind kind, const char *text);
/* A line whose beginning the scene may have chosen. */
void render_process_report_scene(const struct render_process *process, enum line_kind kind, const char *text);
/* The same with a format, cut after 2 * NAME_LIMIT bytes. */
void render_process_say(const struct render_process *process, enum line_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* context: the render process. Each warning is printed once in a script. */
void render_process_warn(void *context, const char *text);
/* The same about a picture; where: of its request. */
void render_process_warn_at(struct render_process *process, const char *where, const char *text);
/* Of `text`, once in a script for each key; the line has its mark. */
void render_process_notice_once(struct render_process *process, const char *key, const char *text);
void render_process_warn_of_nan(struct render_process *process, const struct world *world);
/* Likewise of a density above its bound. */
void render_process_warn_of_density(struct render_process *process, const struct world *world);
void render_process_fill_report(const struct picture_work *work, const struct film *film,
                                struct picture_report *report);
void render_process_report_world(const struct render_process *process, const char *file,
                                 const struct picture_report *report);
/* Counts a picture with these fields (render_request.replaced), and prints what was counted: a line for each option. */
void render_process_count_replaced(struct render_process *process, uint64_t fields);
void render_process_report_replaced(const struct render_process *process);
void render_process_report_samples(const struct picture_work *work);

void effects_note(struct picture_work *work);
/* Counts a finished frame; at the end of a run a notice about an animation of one frame, or of equal ones. */
void effects_count_frame(struct picture_work *work);
void effects_note_frames(struct render_process *process);

#endif
