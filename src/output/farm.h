/* The farm: several processes, on one machine or many, make one picture together. Each runs the whole scene by itself,
 * so that nothing but tiles travels; the first (rank 0) hands tiles out on demand, takes them back finished and writes
 * the picture. Whoever falls out is done without: its tiles are handed out again. So are those of a rank that is
 * silent; if it comes back, tiles that others have are not taken from it. This file has the protocol; the
 * transport moves the messages (MPI in main_mpi.c). */
#ifndef GRAY_OUTPUT_FARM_H
#define GRAY_OUTPUT_FARM_H

#include "render/tile_file.h"
#include "session/control.h"

enum { FARM_MESSAGE_LIMIT = 2 * sizeof(struct tile_picture) + FILM_PACKED_LIMIT };

/* Messages between two ranks keep their order. Nothing waits for a rank: it may be stopped, or gone. */
struct farm_transport {
    void *context;
    int rank, size;
    /* The data is copied; a rank that does not receive is no failure. */
    void (*send)(void *context, int to, int kind, const void *data, size_t size);
    /* The next message, if there is one. `data` has FARM_MESSAGE_LIMIT bytes. */
    bool (*receive)(void *context, int *from, int *kind, void *data, size_t *size);
    double (*clock)(void *context); /* seconds of a clock that never jumps back */
    /* The farm has ended; so many ranks are silent. Others that do not take part in the end of all are waited for so
     * many seconds, 0 for ever. */
    void (*ended)(void *context, int silent, double patience);
};

struct farm;

/* NULL: no memory. slots: tiles to have at hand, twice the number of threads. silence: seconds without a message after
 * which a rank is regarded as lost, or 0 for never; time in which this process did not run does not count. The
 * transport must stay. */
struct farm *farm_create(const struct farm_transport *transport, uint32_t slots, double silence,
                         struct control *control);
/* `poll` is called every millisecond where the farm waits: in farm_begin and farm_finish. */
void farm_set_poll(struct farm *farm, void (*poll)(void *context), void *context);
bool farm_is_first(const struct farm *farm);
/* A picture begins. First rank: its finished tiles (of a checkpoint) stay, the others wait to be handed out. Others:
 * waits until the first rank has begun the same picture. *already: it does not need us. False: the first rank makes
 * another picture, or has given up. film may be NULL when the picture needs no work here (*already was true before). */
bool farm_begin(struct farm *farm, const struct tile_picture *picture, struct film *film, bool *already,
                struct error *error);
/* Takes and sends what there is to take and send; to be called every few milliseconds while a picture is made. */
void farm_step(struct farm *farm);
/* The picture is finished or given up. */
void farm_end(struct farm *farm, bool given_up);
/* The render process of this rank is gone, another one will go on with the picture: first rank only. Its tiles are
 * handed out again. */
void farm_take_back_own(struct farm *farm);
/* An error of this rank, which the first one reports. */
void farm_report(struct farm *farm, const char *line);
/* What happened to a rank, to be shown by the first one at once. */
void farm_note(struct farm *farm, const char *text);
/* First rank: the next line to be shown, if there is one. */
bool farm_next_note(struct farm *farm, char *line, size_t size);
/* Another rank: the first one has been silent for ten times the limit, so that nothing will come of this run. */
bool farm_is_abandoned(const struct farm *farm);
/* After all scripts: the first rank waits for the others, except silent ones; the others wait for its word that the
 * farm has ended. `report` gets lines that are only of other ranks. */
void farm_finish(struct farm *farm, bool well, void (*report)(void *context, const char *line), void *context);
/* How many tiles of the last picture each rank made, first rank's view: "12 9 14". */
void farm_shares(const struct farm *farm, char *out, size_t size);
void farm_destroy(struct farm *farm);

#endif
