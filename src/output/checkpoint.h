/* The checkpoint of a run. While pictures are rendered it writes from time to time all finished tiles, and those that
 * are begun, into one file (film/tile_file.h), and with --resume it restores the tiles of an earlier run. */
#ifndef GRAY_OUTPUT_CHECKPOINT_H
#define GRAY_OUTPUT_CHECKPOINT_H

#include "film/tile_file.h"
#include "output/picture_files.h"
#include "session/options.h"

/* Zero value: no checkpoint is requested, and every call does nothing. */
struct checkpoint {
    bool on, opened, resume;
    bool late; /* it is not requested: written only when a run of more than a minute is interrupted */
    const struct picture_files *files; /* not owned */
    struct error refused;              /* why pictures must not be rendered: reported for every picture */
    uint32_t number;                   /* of the current picture */
    double every;                      /* seconds */
    char path[TILE_FILE_NAME];         /* empty until the first picture has a name */
    bool has_old;
    struct tile_file old;   /* the data of the earlier run; freed at the end */
    uint32_t old_number;    /* of the last picture of the earlier run: until then its file is not written again */
    struct tile_done *done; /* written pictures, of this run and the earlier one */
    size_t done_count;
    bool pending;              /* there are finished tiles that the file does not contain */
    uint32_t tiles_kept;       /* of the current picture, that the file contains */
    double written_at, took;   /* seconds: when the file was last written, and how long that took */
    struct file_identity file; /* of the checkpoint, once this run has written or taken it over; else 0 */
    bool failed;               /* a failed write was reported */
};

void checkpoint_init(struct checkpoint *checkpoint, const struct options *options, const struct picture_files *files);
/* Called for every picture before anything else; the first one decides the file. False: there is a file already and no
 * --resume, or it is damaged. *notice: a line to report, or empty. */
bool checkpoint_open(struct checkpoint *checkpoint, const char *picture_name, char notice[256], struct error *error);
/* Whether an earlier run has written this picture and its file still holds the same. False with error: the earlier run
 * rendered another scene under this name. */
bool checkpoint_has_written(struct checkpoint *checkpoint, uint32_t number, const struct tile_key *key,
                            const char *name, bool *written, struct error *error);
/* Copies finished tiles of this picture into its film. False: they belong to another scene. */
bool checkpoint_restore(struct checkpoint *checkpoint, const struct tile_picture *picture, struct film *film,
                        char notice[256], struct error *error);
/* Tiles of the current picture: those that are done, and those that are begun. */
struct checkpoint_tiles {
    uint32_t done, begun;
};
/* Writes the file when it is due, or if `now` is set; film: of the current picture, or NULL. False with error: it could
 * not be written, reported once; the run continues. *tiles: those in the file now; unchanged if nothing was written. */
bool checkpoint_update(struct checkpoint *checkpoint, const struct tile_picture *picture, const struct film *film,
                       bool now, struct checkpoint_tiles *tiles, struct error *error);
/* The picture is written under its name. */
bool checkpoint_note_written(struct checkpoint *checkpoint, uint32_t number, const struct tile_key *key,
                             const char *name, struct error *error);
/* Called after all scripts. all_written: nothing is left to do, and the file is removed. Otherwise the pending tiles
 * are written. */
bool checkpoint_finish(struct checkpoint *checkpoint, bool all_written, struct error *error);

#endif
