/* Models: of node:export, of -o MODEL, and the reports of --check-print. */
#ifndef GRAY_HOST_MODEL_EXPORT_H
#define GRAY_HOST_MODEL_EXPORT_H

#include "host/render_process_internal.h"

/* For struct script_host; context: the render process. */
bool model_export_node(void *context, const struct export_request *request, struct error *error);
/* The scene of a picture as the model of the command line. Its bytes are kept until it is known that no other picture
 * comes, and until the picture is rendered that is its thumbnail. */
bool model_export_picture(struct render_process *process, const struct render_request *request, struct error *error);
/* A picture is rendered: the thumbnail, if its scene is the model, and it is complete. False: no memory. */
bool model_export_show(struct render_process *process, const struct film *film, const struct tone *tone,
                       struct error *error);
/* Solutions of radiosity, as the functions of struct radiosity_store; a file that cannot be written is a warning. */
bool model_export_load_solution(void *context, struct digest depends, struct list *bytes, struct error *error);
void model_export_save_solution(void *context, struct digest depends, const struct list *bytes);
/* --bake: the light of the picture that is rendered, once in a run. */
bool model_export_bake(struct render_process *process, const struct tone *tone, struct error *error);
/* After the script: writes the model that was kept. Forgets it in any case. */
bool model_export_finish(struct render_process *process, struct error *error);
void model_export_forget(struct render_process *process);

#endif
