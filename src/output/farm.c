/* State of a tile in a farm: LATER until it may be rendered, WANTED when a worker of this process may, TAKEN when one
 * does, DONE when it is finished; a rank that has sent a finished tile to the first rank marks it ELSEWHERE. The first
 * rank stores the owner of every tile, so that the tiles of a lost rank can be assigned again; a tile with samples of a
 * checkpoint is its own. Pictures of a run are numbered; messages about other pictures are late and are ignored.
 *
 * All ranks send heartbeats, so that silence means that a rank is stopped, dead or cut off. A silent rank gets no tiles
 * and is not waited for, but it remains a member: it receives the missed messages when it continues. */
#include "output/farm.h"

#include "base/mem.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

enum farm_message_kind {
    FARM_BEGIN = 1, /* to the first rank: struct begin */
    FARM_TILE,      /* to the first rank: number, tile, packed tile */
    FARM_LEAVE,     /* to the first rank: number; no more tiles of this picture */
    FARM_LINE,      /* to the first rank: an error line */
    FARM_BYE,       /* to the first rank: all scripts have ended */
    FARM_ANSWER,    /* from the first rank: number, enum farm_answer */
    FARM_ASSIGN,    /* from the first rank: number, tile */
    FARM_CLOSE,     /* from the first rank: number; all tiles are there */
    FARM_ALIVE,     /* to and from the first rank: a heartbeat */
    FARM_NOTE,      /* to the first rank: a line to be shown at once */
    FARM_END,       /* from the first rank: number, how many ranks are silent; the farm has ended */
};

enum farm_answer { FARM_ANSWER_GO, FARM_ANSWER_SKIP, FARM_ANSWER_OTHER, FARM_ANSWER_STOP };

struct begin {
    struct tile_picture picture;
    uint32_t slots;
};

struct pair {
    uint32_t number, value;
};

enum { LINES_LIMIT = 32, LINE_LIMIT = 1024, NOTES_LIMIT = 16, NOBODY = UINT16_MAX };
/* The number of heartbeats in the time after which a rank is regarded as lost; and the number of these times that the
 * first rank may be silent (it writes pictures, which takes long) before the others end. */
enum { HEARTBEATS = 8, PATIENCE = 10 };

struct peer {
    bool waiting; /* for an answer to `begin` */
    bool joined;  /* renders tiles of the current picture */
    bool gone;
    bool silent;
    double last_heard; /* when, on farm.time */
    struct begin begin;
    uint32_t made;
};

struct farm {
    const struct farm_transport *transport;
    struct control *control;
    uint32_t slots;
    struct peer *peers; /* of the first rank, by rank */
    struct tile_picture picture;
    struct film *film; /* of the current picture, or NULL */
    uint16_t *owner;   /* of every tile; on the first rank */
    uint32_t number;   /* of the current picture */
    uint32_t from;     /* no tile before it has the state LATER */
    bool over, failed; /* the first rank's scripts have ended; with an error */
    char (*lines)[LINE_LIMIT];
    int line_count, own_lines;
    char (*notes)[LINE_LIMIT];
    int note_count;
    uint8_t *message;
    double silence;    /* the limit */
    double time;       /* seconds in which this process ran, measured at regular calls */
    double clock;      /* of the transport, at the last reading */
    double sent;       /* on `time`: when the last heartbeat was sent */
    double last_heard; /* on `time`: from the first rank */
    bool ended;        /* the first rank has reported it */
    int silent;        /* ranks, when the farm ended */
    void (*poll)(void *context);
    void *poll_context;
};

struct farm *farm_create(const struct farm_transport *transport, uint32_t slots, double silence,
                         struct control *control) {
    struct farm *farm = mem_alloc_zero(1, sizeof *farm);
    if (!farm)
        return NULL;
    *farm = (struct farm){.transport = transport, .slots = slots, .silence = silence, .control = control};
    farm->clock = transport->clock(transport->context);
    farm->peers = mem_alloc_zero((size_t)transport->size, sizeof *farm->peers);
    farm->lines = mem_alloc_zero(LINES_LIMIT, sizeof *farm->lines);
    farm->notes = mem_alloc_zero(NOTES_LIMIT, sizeof *farm->notes);
    farm->message = mem_alloc(FARM_MESSAGE_LIMIT);
    if (farm->peers && farm->lines && farm->notes && farm->message)
        return farm;
    farm_destroy(farm);
    return NULL;
}

void farm_destroy(struct farm *farm) {
    if (!farm)
        return;
    mem_free(farm->peers);
    mem_free(farm->lines);
    mem_free(farm->notes);
    mem_free(farm->message);
    mem_free(farm->owner);
    mem_free(farm);
}

void farm_set_poll(struct farm *farm, void (*poll)(void *context), void *context) {
    farm->poll = poll;
    farm->poll_context = context;
}

bool farm_is_first(const struct farm *farm) {
    return farm->transport->rank == 0;
}

static void send(const struct farm *farm, int to, enum farm_message_kind kind, const void *data, size_t size) {
    farm->transport->send(farm->transport->context, to, (int)kind, data, size);
}

static void send_pair(const struct farm *farm, int to, enum farm_message_kind kind, uint32_t value) {
    struct pair pair = {farm->number, value};
    send(farm, to, kind, &pair, sizeof pair);
}

static void rest(const struct farm *farm) {
    const struct timespec pause = {0, 1000000};
    if (farm->poll)
        farm->poll(farm->poll_context);
    (void)nanosleep(&pause, NULL);
}

/* A time in which this process was stopped, slept with its machine or wrote a picture is counted as short: the messages
 * of that time are read before a rank is regarded as lost. */
static void pass_time(struct farm *farm) {
    double now = farm->transport->clock(farm->transport->context), passed = now - farm->clock;
    farm->clock = now;
    farm->time += passed > farm->silence / HEARTBEATS ? farm->silence / HEARTBEATS : passed;
}

static bool heartbeat_is_due(struct farm *farm) {
    if (farm->silence <= 0 || farm->time - farm->sent < farm->silence / HEARTBEATS)
        return false;
    farm->sent = farm->time;
    return true;
}

static enum film_tile state_of(const struct film *film, uint32_t tile) {
    return (enum film_tile)atomic_load_explicit(&film->tiles[tile], memory_order_acquire);
}

static void set_state(struct film *film, uint32_t tile, enum film_tile state) {
    atomic_store_explicit(&film->tiles[tile], (uint8_t)state, memory_order_release);
}

/* To the workers of this process, which may wait. */
static void hand_out(const struct farm *farm, uint32_t tile) {
    set_state(farm->film, tile, FILM_TILE_WANTED);
    pool_signal(&farm->control->handed);
}

static void close_handout(const struct farm *farm) {
    atomic_store(&farm->control->handout, HANDOUT_CLOSED);
    pool_signal(&farm->control->handed);
}

/* The first rank. */

static void add_note(struct farm *farm, int rank, const char *text, int length) {
    if (farm->note_count < NOTES_LIMIT)
        (void)snprintf(farm->notes[farm->note_count++], LINE_LIMIT, "rank %d %.*s", rank, length, text);
}

/* The next tile that no rank has, or UINT32_MAX. */
static uint32_t next_tile(struct farm *farm) {
    uint32_t count = film_tile_count(farm->film);
    while (farm->from < count && state_of(farm->film, farm->from) != FILM_TILE_LATER)
        farm->from++;
    return farm->from < count ? farm->from : UINT32_MAX;
}

/* A tile of another rank is TAKEN here until it is returned. */
static bool assign(struct farm *farm, int rank) {
    uint32_t tile = next_tile(farm);
    if (tile == UINT32_MAX)
        return false;
    farm->owner[tile] = (uint16_t)rank;
    if (rank == 0)
        hand_out(farm, tile);
    else
        set_state(farm->film, tile, FILM_TILE_TAKEN);
    if (rank > 0)
        send_pair(farm, rank, FARM_ASSIGN, tile);
    return true;
}

static void take_back(struct farm *farm, int rank) {
    for (uint32_t tile = 0; farm->film && tile < film_tile_count(farm->film); tile++) {
        enum film_tile state = state_of(farm->film, tile);
        if (farm->owner[tile] != rank || state == FILM_TILE_DONE || film_tile_is_begun((uint8_t)state))
            continue;
        farm->owner[tile] = NOBODY;
        set_state(farm->film, tile, FILM_TILE_LATER);
        farm->from = tile < farm->from ? tile : farm->from;
    }
}

static void give_slots(struct farm *farm, int rank) {
    const struct peer *peer = &farm->peers[rank];
    for (uint32_t i = 0; peer->joined && !peer->silent && i < peer->begin.slots && assign(farm, rank); i++)
        continue;
}

/* A message of this rank was received. */
static void receive_all(struct farm *farm, int rank) {
    struct peer *peer = &farm->peers[rank];
    static const char text[] = "is heard again";
    peer->last_heard = farm->time;
    if (!peer->silent)
        return;
    peer->silent = false;
    if (!peer->gone)
        add_note(farm, rank, text, sizeof text - 1);
    if (farm->film)
        give_slots(farm, rank);
}

static void find_silent(struct farm *farm) {
    for (int rank = 1; rank < farm->transport->size && farm->silence > 0; rank++) {
        struct peer *peer = &farm->peers[rank];
        char text[LINE_LIMIT];
        if (peer->silent || farm->time - peer->last_heard < farm->silence)
            continue;
        peer->silent = true;
        if (peer->gone)
            continue;
        int length = snprintf(text, sizeof text, "has been silent for %g s, others render its tiles (--farm-silence)",
                              farm->silence);
        add_note(farm, rank, text, length);
        take_back(farm, rank);
    }
}

static void send_heartbeats(struct farm *farm) {
    if (!heartbeat_is_due(farm))
        return;
    for (int rank = 1; rank < farm->transport->size; rank++) {
        if (!farm->peers[rank].silent)
            send(farm, rank, FARM_ALIVE, "", 1);
    }
}

static void answer_waiting(struct farm *farm) {
    for (int rank = 1; rank < farm->transport->size; rank++) {
        struct peer *peer = &farm->peers[rank];
        const struct tile_picture *picture = &peer->begin.picture;
        if (!peer->waiting || (picture->number > farm->number && !farm->over))
            continue;
        enum farm_answer farm_answer = farm->over && farm->failed ? FARM_ANSWER_STOP : FARM_ANSWER_SKIP;
        if (farm->film && picture->number == farm->number)
            farm_answer = tile_picture_difference(picture, &farm->picture) ? FARM_ANSWER_OTHER : FARM_ANSWER_GO;
        struct pair pair = {picture->number, farm_answer};
        send(farm, rank, FARM_ANSWER, &pair, sizeof pair);
        peer->waiting = false;
        peer->joined = farm_answer == FARM_ANSWER_GO;
        give_slots(farm, rank);
    }
}

static void close_picture(struct farm *farm) {
    for (int rank = 1; rank < farm->transport->size; rank++) {
        if (farm->peers[rank].joined)
            send_pair(farm, rank, FARM_CLOSE, 0);
        farm->peers[rank].joined = false;
    }
    close_handout(farm);
    farm->film = NULL;
}

static void take_tile(struct farm *farm, int from, const uint8_t *data, size_t size) {
    struct pair pair;
    memcpy(&pair, data, sizeof pair);
    if (!farm->film || pair.number != farm->number || pair.value >= film_tile_count(farm->film))
        return;
    /* From a rank that was silent: a tile that was not assigned to another rank is still useful. */
    enum film_tile state = state_of(farm->film, pair.value);
    if (state == FILM_TILE_DONE || (state != FILM_TILE_LATER && farm->owner[pair.value] != from))
        return;
    if (!film_tile_unpack(farm->film, pair.value, data + sizeof pair, size - sizeof pair))
        return;
    farm->owner[pair.value] = (uint16_t)from;
    farm->peers[from].made++;
    (void)assign(farm, from);
}

static void take_message(struct farm *farm, int from, int kind, const uint8_t *data, size_t size) {
    struct peer *peer = &farm->peers[from];
    switch ((enum farm_message_kind)kind) {
    case FARM_BEGIN:
        if (size == sizeof peer->begin) {
            memcpy(&peer->begin, data, size);
            peer->waiting = true;
        }
        return;
    case FARM_TILE:
        if (size > sizeof(struct pair))
            take_tile(farm, from, data, size);
        return;
    case FARM_LEAVE:
        take_back(farm, from);
        peer->joined = false;
        return;
    case FARM_LINE:
        if (farm->line_count < LINES_LIMIT)
            (void)snprintf(farm->lines[farm->line_count++], LINE_LIMIT, "%d %.*s", from, (int)size, (const char *)data);
        return;
    case FARM_BYE:
        take_back(farm, from);
        peer->joined = false;
        peer->gone = true;
        return;
    case FARM_NOTE:
        add_note(farm, from, (const char *)data, (int)size);
        return;
    case FARM_ALIVE:
    case FARM_ANSWER:
    case FARM_ASSIGN:
    case FARM_CLOSE:
    case FARM_END:
        return;
    }
}

static void step_first(struct farm *farm) {
    int from, kind;
    size_t size;
    pass_time(farm);
    while (farm->transport->receive(farm->transport->context, &from, &kind, farm->message, &size)) {
        receive_all(farm, from);
        take_message(farm, from, kind, farm->message, size);
    }
    find_silent(farm);
    send_heartbeats(farm);
    answer_waiting(farm);
    if (!farm->film)
        return;
    for (uint32_t waiting = film_tiles_in(farm->film, FILM_TILE_WANTED); waiting < farm->slots; waiting++) {
        if (!assign(farm, 0))
            break;
    }
    if (film_tiles_in(farm->film, FILM_TILE_DONE) == film_tile_count(farm->film)) {
        farm->peers[0].made = 0;
        for (uint32_t tile = 0; tile < film_tile_count(farm->film); tile++)
            farm->peers[0].made += farm->owner[tile] == 0;
        close_picture(farm);
    }
}

/* The others. */

static void send_finished(struct farm *farm) {
    for (uint32_t tile = 0; tile < film_tile_count(farm->film); tile++) {
        if (state_of(farm->film, tile) != FILM_TILE_DONE)
            continue;
        struct pair pair = {farm->number, tile};
        memcpy(farm->message, &pair, sizeof pair);
        size_t size = film_tile_pack(farm->film, tile, farm->message + sizeof pair);
        set_state(farm->film, tile, FILM_TILE_ELSEWHERE);
        send(farm, 0, FARM_TILE, farm->message, sizeof pair + size);
    }
}

/* The next message of the first rank, if there is one; sends heartbeats meanwhile. */
static bool listen(struct farm *farm, int *kind, struct pair *pair) {
    int from;
    size_t size;
    pass_time(farm);
    if (heartbeat_is_due(farm))
        send(farm, 0, FARM_ALIVE, "", 1);
    while (farm->transport->receive(farm->transport->context, &from, kind, farm->message, &size)) {
        if (from != 0)
            continue;
        farm->last_heard = farm->time;
        if (size != sizeof *pair)
            continue;
        memcpy(pair, farm->message, sizeof *pair);
        if (*kind != FARM_END)
            return true;
        farm->ended = true;
        farm->silent = (int)pair->value;
    }
    return false;
}

bool farm_is_abandoned(const struct farm *farm) {
    return !farm_is_first(farm) && farm->silence > 0 && farm->time - farm->last_heard > PATIENCE * farm->silence;
}

/* After a silence a tile may be assigned that is still being rendered here: it is sent when it is finished. */
static void want_tile(const struct farm *farm, uint32_t tile) {
    const struct film *film = farm->film;
    enum film_tile state = state_of(film, tile);
    if (state != FILM_TILE_TAKEN && state != FILM_TILE_DONE && !film_tile_is_begun((uint8_t)state))
        hand_out(farm, tile);
}

static void step_other(struct farm *farm) {
    struct pair pair;
    int kind;
    while (listen(farm, &kind, &pair)) {
        if (!farm->film || pair.number != farm->number)
            continue;
        if (kind == FARM_ASSIGN && pair.value < film_tile_count(farm->film))
            want_tile(farm, pair.value);
        if (kind == FARM_CLOSE)
            close_handout(farm);
    }
    if (farm->ended) /* without this rank, which was silent: its work is of no use */
        atomic_store(&farm->control->cancel, CANCEL_ALL);
    if (farm->film)
        send_finished(farm);
}

/* Waits for the answer to the beginning of a picture. */
static bool await_answer(struct farm *farm, struct pair *farm_answer, struct error *error) {
    int kind;
    for (;; rest(farm)) {
        if (atomic_load(&farm->control->cancel))
            return error_set(error, ERROR_CANCELLED, "interrupted");
        if (farm_is_abandoned(farm))
            return error_set(error, ERROR_CANCELLED, "the first rank is silent");
        while (listen(farm, &kind, farm_answer)) {
            if (kind == FARM_ANSWER && farm_answer->number == farm->number)
                return true;
        }
        if (farm->ended) {
            *farm_answer = (struct pair){farm->number, FARM_ANSWER_STOP};
            return true;
        }
    }
}

static bool join(struct farm *farm, bool *already, struct error *error) {
    struct begin begin = {farm->picture, farm->slots};
    struct pair farm_answer;
    send(farm, 0, FARM_BEGIN, &begin, sizeof begin);
    if (!await_answer(farm, &farm_answer, error))
        return false;
    *already = farm_answer.value == FARM_ANSWER_SKIP;
    if (farm_answer.value == FARM_ANSWER_OTHER)
        return error_set(
            error, ERROR_SCENE,
            "this rank renders a different picture from the first one: its files, options or version differ");
    if (farm_answer.value == FARM_ANSWER_STOP)
        return error_set(error, ERROR_CANCELLED, "the first rank has stopped");
    return true;
}

/* All. */

bool farm_begin(struct farm *farm, const struct tile_picture *picture, struct film *film, bool *already,
                struct error *error) {
    farm->picture = *picture;
    farm->number = picture->number;
    farm->from = 0;
    if (!farm_is_first(farm) && !join(farm, already, error))
        return false;
    if (*already || !film)
        return true;
    uint32_t count = film_tile_count(film);
    /* Nobody owns a tile yet. */
    if (farm_is_first(farm)) {
        uint16_t *owner = mem_resize_array(farm->owner, count, sizeof *owner);
        if (!owner)
            return error_no_memory(error, "the tiles of a farm");
        farm->owner = owner;
        memset(owner, 0xff, count * sizeof *owner);
        for (int rank = 0; rank < farm->transport->size; rank++)
            farm->peers[rank].made = 0;
    }
    /* Tiles with samples of a checkpoint stay with the first rank; all others are handed out. */
    for (uint32_t tile = 0; tile < count; tile++) {
        enum film_tile state = state_of(film, tile);
        bool begun = film_tile_is_begun((uint8_t)state);
        if (begun && farm_is_first(farm))
            farm->owner[tile] = 0;
        else if (begun || state == FILM_TILE_WANTED)
            set_state(film, tile, FILM_TILE_LATER);
    }
    farm->film = film;
    atomic_store(&farm->control->handout, HANDOUT_OPEN);
    farm_step(farm);
    return true;
}

void farm_step(struct farm *farm) {
    if (farm_is_first(farm))
        step_first(farm);
    else
        step_other(farm);
}

void farm_end(struct farm *farm, bool given_up) {
    bool open = farm->film != NULL;
    if (farm_is_first(farm)) {
        if (open)
            close_picture(farm);
    } else if (open) {
        if (given_up)
            send_pair(farm, 0, FARM_LEAVE, 0);
        else
            send_finished(farm);
    }
    farm->film = NULL;
}

void farm_take_back_own(struct farm *farm) {
    take_back(farm, 0);
}

void farm_note(struct farm *farm, const char *text) {
    int length = (int)strnlen(text, LINE_LIMIT - 16);
    if (farm_is_first(farm))
        add_note(farm, 0, text, length);
    else
        send(farm, 0, FARM_NOTE, text, (size_t)length);
}

bool farm_next_note(struct farm *farm, char *line, size_t size) {
    if (farm->note_count == 0)
        return false;
    (void)snprintf(line, size, "gray: warning: %s", farm->notes[0]);
    farm->note_count--;
    memmove(farm->notes, farm->notes + 1, (size_t)farm->note_count * sizeof *farm->notes);
    return true;
}

void farm_report(struct farm *farm, const char *line) {
    if (!farm_is_first(farm))
        send(farm, 0, FARM_LINE, line, strnlen(line, LINE_LIMIT - 16));
    else if (farm->line_count < LINES_LIMIT)
        (void)snprintf(farm->lines[farm->line_count++], LINE_LIMIT, "0 %s", line);
}

/* Lines of other ranks that the first one has not printed itself: the same script error happens on all. */
static void report_foreign(const struct farm *farm, void (*report)(void *context, const char *line), void *context) {
    for (int i = 0; i < farm->line_count; i++) {
        const char *text = strchr(farm->lines[i], ' ') + 1;
        bool known = farm->lines[i][0] == '0';
        for (int k = 0; k < farm->line_count && !known; k++)
            known = farm->lines[k][0] == '0' && strcmp(strchr(farm->lines[k], ' ') + 1, text) == 0;
        char line[LINE_LIMIT + 32];
        (void)snprintf(line, sizeof line, "gray: rank %.*s: %s", (int)(text - 1 - farm->lines[i]), farm->lines[i],
                       text);
        if (!known)
            report(context, line);
    }
}

/* The first rank: waits until all others have reported their end or are silent. */
static void await_others(struct farm *farm) {
    for (bool all_gone = false; !all_gone; rest(farm)) {
        step_first(farm);
        if (atomic_load(&farm->control->cancel))
            return; /* the others were interrupted, too, and may have ended without a message */
        all_gone = true;
        farm->silent = 0;
        for (int rank = 1; rank < farm->transport->size; rank++) {
            all_gone = all_gone && (farm->peers[rank].gone || farm->peers[rank].silent);
            farm->silent += farm->peers[rank].silent;
        }
    }
    /* A silent rank can still read it when it continues. */
    for (int rank = 1; rank < farm->transport->size; rank++)
        send_pair(farm, rank, FARM_END, (uint32_t)farm->silent);
}

static void await_end(struct farm *farm) {
    struct pair pair;
    int kind;
    send(farm, 0, FARM_BYE, "", 1);
    for (; !farm->ended && !atomic_load(&farm->control->cancel) && !farm_is_abandoned(farm); rest(farm)) {
        while (listen(farm, &kind, &pair))
            continue;
    }
}

void farm_finish(struct farm *farm, bool well, void (*report)(void *context, const char *line), void *context) {
    farm->film = NULL;
    farm->over = true;
    farm->failed = !well;
    if (farm_is_first(farm)) {
        await_others(farm);
        report_foreign(farm, report, context);
    } else {
        await_end(farm);
    }
    farm->transport->ended(farm->transport->context, farm->silent, farm->silence);
}

void farm_shares(const struct farm *farm, char *out, size_t size) {
    size_t length = 0;
    out[0] = '\0';
    for (int rank = 0; rank < farm->transport->size && length < size; rank++)
        length += (size_t)snprintf(out + length, size - length, "%s%u", rank ? " " : "", farm->peers[rank].made);
}
