/* Scenes that are written as text, --to-json and --to-lua. */
#ifndef GRAY_HOST_SCENE_TEXT_H
#define GRAY_HOST_SCENE_TEXT_H

#include "host/render_process.h"
#include "script/script.h"

struct render_process;

/* `write_scene` of struct script_host. The text of the only picture waits for the end of the script. */
bool scene_text_write(void *render_process, const struct render_request *request, const char *text, size_t size,
                      struct error *error);
/* After a script without an error: writes it. */
bool scene_text_finish(struct render_process *process, struct error *error);

#endif
