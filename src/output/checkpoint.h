/* The checkpoint of a run. While pictures are rendered it writes from time to time all finished tiles into one file
 * (render/tile_file.h), and with --resume it restores what an earlier run left there. */
#ifndef GRAY_OUTPUT_CHECKPOINT_H
#define GRAY_OUTPUT_CHECKPOINT_H

#include "output/picture_files.h"
#include "render/tile_file.h"
#include "session/options.h"

/* Zero value: no checkpoint is asked for, and every call does nothing. */
struct checkpoint {
    bool on, opened, resume;
    const struct picture_files *files; /* not owned */
    struct error refused;              /* why nothing may be made: said again for every picture */
    uint32_t number;                   /* of the picture that was begun last */
    double every;                      /* seconds */
    char path[TILE_FILE_NAME];         /* empty until the first picture has a name */
    bool has_old;
    struct tile_file old;   /* what the earlier run left; given back at the end */
    uint32_t old_number;    /* of the last picture it knows of: until then its file is not written again */
    struct tile_done *done; /* pictures that are written, of this run and the earlier one */
    size_t done_count;
    bool pending;              /* something is finished that the file does not have */
    uint32_t tiles_kept;       /* of the picture being made, that the file has */
    double written_at, took;   /* seconds: when the file was last written, and how long that took */
    struct file_identity file; /* of the checkpoint, once this run has written or taken it over; else 0 */
    bool failed;               /* it could not be written, which was reported once */
};

void checkpoint_init(struct checkpoint *checkpoint, const struct options *options, const struct picture_files *files);
/* Called for every picture before anything else; the first one decides the file. False: there is a file already and no
 * --resume, or it is damaged. *notice: a line to report, or empty. */
bool checkpoint_open(struct checkpoint *checkpoint, const char *picture_name, char notice[256], struct error *error);
/* Whether an earlier run has written this picture and its file still holds the same. False with error: the run before
 * made it of something else. */
bool checkpoint_has_written(struct checkpoint *checkpoint, uint32_t number, const struct tile_key *key,
                            const char *name, bool *written, struct error *error);
/* Puts finished tiles of this picture into its film. False: they are of something else. */
bool checkpoint_restore(struct checkpoint *checkpoint, const struct tile_picture *picture, struct film *film,
                        char notice[256], struct error *error);
/* Writes the file when it is time, or `now`; film: of the picture being made, or NULL. False with error: it could not
 * be written, reported once; the run goes on. *tiles: how many the file holds now; untouched when nothing was written.
 */
bool checkpoint_update(struct checkpoint *checkpoint, const struct tile_picture *picture, const struct film *film,
                       bool now, uint32_t *tiles, struct error *error);
/* The picture is written under its name. */
bool checkpoint_note_written(struct checkpoint *checkpoint, uint32_t number, const struct tile_key *key,
                             const char *name, struct error *error);
/* After all scripts. all_written: nothing is left to do, the file goes. Otherwise it gets what is pending. */
bool checkpoint_finish(struct checkpoint *checkpoint, bool all_written, struct error *error);

#endif
