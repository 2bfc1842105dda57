/* The farm: several processes, on one machine or many, render one picture together. Each runs the whole scene itself,
 * so that only tiles are transferred; the first (rank 0) assigns tiles on demand, receives them finished and writes the
 * picture. The tiles of a lost rank are assigned again. So are those of a silent rank; if it continues, its versions of
 * tiles that were assigned to others are ignored. This file has the protocol; the transport moves the messages (MPI in
 * main_mpi.c). */
#ifndef GRAY_OUTPUT_FARM_H
#define GRAY_OUTPUT_FARM_H

#include "film/tile_file.h"
#include "session/control.h"

enum { FARM_MESSAGE_LIMIT = 2 * sizeof(struct tile_picture) + FILM_PACKED_LIMIT };

/* Messages between two ranks keep their order. Nothing waits for a rank: it may be stopped, or ended. */
struct farm_transport {
    void *context;
    int rank, size;
    /* The data is copied; it is no error if the rank does not receive it. */
    void (*send)(void *context, int to, int kind, const void *data, size_t size);
    /* The next message, if there is one. `data` has FARM_MESSAGE_LIMIT bytes. */
    bool (*receive)(void *context, int *from, int *kind, void *data, size_t *size);
    double (*clock)(void *context); /* seconds of a monotonic clock back */
    /* The farm has ended; `silent` ranks are silent. The wait for ranks that do not end is limited to this many
     * seconds, 0 for no limit. */
    void (*ended)(void *context, int silent, double patience);
};

struct farm;

/* NULL: no memory. slots: how many tiles to have in advance, twice the number of threads. silence: seconds without a
 * message after which a rank is regarded as lost, or 0 for never; time in which this process did not run does not
 * count. The transport must remain valid. */
struct farm *farm_create(const struct farm_transport *transport, uint32_t slots, double silence,
                         struct control *control);
/* `poll` is called every millisecond while the farm waits: in farm_begin and farm_finish. */
void farm_set_poll(struct farm *farm, void (*poll)(void *context), void *context);
bool farm_is_first(const struct farm *farm);
/* A picture begins. First rank: its tiles of a checkpoint are kept, the others wait to be assigned. Others:
 * waits until the first rank has begun the same picture. *already: this rank has no work. False: the first rank renders
 * another picture, or has cancelled. film may be NULL if the picture needs no work here (*already was true before). */
bool farm_begin(struct farm *farm, const struct tile_picture *picture, struct film *film, bool *already,
                struct error *error);
/* Receives and sends all pending messages; to be called every few milliseconds while a picture is rendered. */
void farm_step(struct farm *farm);
/* The picture is finished or cancelled. */
void farm_end(struct farm *farm, bool given_up);
/* The render process of this rank has ended, another one will continue with the picture: first rank only. Its tiles are
 * assigned again. */
void farm_take_back_own(struct farm *farm);
/* An error of this rank, which the first one reports. */
void farm_report(struct farm *farm, const char *line);
/* A message about a rank, which the first one shows at once. */
void farm_note(struct farm *farm, const char *text);
/* First rank: the next line to be shown, if there is one. */
bool farm_next_note(struct farm *farm, char *line, size_t size);
/* Another rank: the first one has been silent for ten times the limit, so this run has failed. */
bool farm_is_abandoned(const struct farm *farm);
/* After all scripts: the first rank waits for the others, except silent ones; the others wait for its message that the
 * farm has ended. `report` gets lines that only other ranks have. */
void farm_finish(struct farm *farm, bool well, void (*report)(void *context, const char *line), void *context);
/* How many tiles of the last picture each rank rendered, counted by the first rank: "12 9 14". */
void farm_shares(const struct farm *farm, char *out, size_t size);
void farm_destroy(struct farm *farm);

#endif
