/* Writing the files of models, from bytes that the render process has put into shared memory. */
#ifndef GRAY_OUTPUT_MODEL_OUTPUT_H
#define GRAY_OUTPUT_MODEL_OUTPUT_H

#include "base/share.h"
#include "output/picture_files.h"
#include "session/messages.h"

/* Zero value: none. */
struct model_output {
    struct share memory; /* of the bytes */
    size_t size;
    bool by_user, is_beside;
    struct file_output beside; /* the materials of an OBJ file: they get their name with that file */
    char name[NAME_LIMIT];
    /* The solution of radiosity: the file of the run, chosen for its first picture; a later picture of another scene
     * does not replace it. */
    char solution[NAME_LIMIT];
    bool is_solution, is_later, stays;
    struct digest depends;
};

/* Whether the file can be written, and memory for its bytes if their number is known; of a solution else that with the
 * bytes of its file, if they are of the same scene. */
bool model_output_begin(struct model_output *model, struct picture_files *files, const struct model_request *request,
                        struct error *error);
/* Writes the file and releases the memory. The file of materials, which comes before its model, replaces none yet. */
bool model_output_write(struct model_output *model, struct picture_files *files, struct error *error);
void model_output_forget(struct model_output *model);

#endif
