/* A simulated farm: ranks in one process, messages in queues, tiles painted by the test. Whatever the order of steps,
 * whatever invalid messages arrive among valid ones and whichever rank fails or is silent, the first rank ends with
 * every tile. The test controls the clock. */
#include "output/farm.h"
#include "render/render.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RANKS = 4, WIDTH = 130, HEIGHT = 70, QUEUE = 4096 };
/* As in farm.c. */
enum { BEGIN = 1, TILE, LEAVE, LINE, BYE, ANSWER, ASSIGN, CLOSE, ALIVE, NOTE, END, NO_KIND = 99 };
#define SILENCE 8.0

struct letter {
    int from, kind;
    size_t size;
    uint8_t *data;
};

struct post {
    struct letter letters[QUEUE];
    uint32_t begun, ended;
};

static struct post boxes[RANKS]; /* by the receiving rank */
static struct farm *farms[RANKS];

static void post(int from, int to, int kind, const void *data, size_t size) {
    struct post *box = &boxes[to];
    struct letter *letter = &box->letters[box->ended++ % QUEUE];
    CHECK(box->ended - box->begun < QUEUE);
    *letter = (struct letter){from, kind, size, malloc(size ? size : 1)};
    memcpy(letter->data, data, size);
}

static void send(void *context, int to, int kind, const void *data, size_t size) {
    post(*(const int *)context, to, kind, data, size);
}

/* The other ranks wait for answers of the first one: it gets a turn whenever one of them has nothing to read. */
static bool receive(void *context, int *from, int *kind, void *data, size_t *size) {
    int rank = *(const int *)context;
    struct post *box = &boxes[rank];
    if (box->begun == box->ended && rank > 0 && farms[0])
        farm_step(farms[0]);
    if (box->begun == box->ended)
        return false;
    struct letter *letter = &box->letters[box->begun++ % QUEUE];
    *from = letter->from;
    *kind = letter->kind;
    *size = letter->size;
    memcpy(data, letter->data, letter->size);
    free(letter->data);
    return true;
}

static double time_now;
static double read_clock(void *context) {
    (void)context;
    return time_now;
}

static int silent_at_end[RANKS];
static void note_end(void *context, int silent, double patience) {
    silent_at_end[*(const int *)context] = silent;
    CHECK_NEAR(patience, SILENCE, 0);
}

static struct film films[RANKS];
static struct control controls[RANKS];
static int ranks[RANKS] = {0, 1, 2, 3};
static struct farm_transport transports[RANKS];

static void begin_farm(int count) {
    memset(boxes, 0, sizeof boxes);
    for (int rank = 0; rank < count; rank++) {
        struct error error;
        size_t bytes;
        controls[rank] = (struct control){0};
        transports[rank] = (struct farm_transport){.context = &ranks[rank],
                                                   .rank = rank,
                                                   .size = count,
                                                   .send = send,
                                                   .receive = receive,
                                                   .clock = read_clock,
                                                   .ended = note_end};
        farms[rank] = farm_create(&transports[rank], 2, SILENCE, &controls[rank]);
        CHECK(farms[rank] != NULL && farm_is_first(farms[rank]) == (rank == 0));
        films[rank] = (struct film){.full_width = WIDTH, .full_height = HEIGHT};
        CHECK(film_size(WIDTH, HEIGHT, stage_record(INTEGRATOR_WHITTED), &bytes, &error));
        film_layout(&films[rank], calloc(1, bytes), WIDTH, HEIGHT, stage_record(INTEGRATOR_WHITTED));
    }
}

static void end_farm(int count) {
    for (int rank = 0; rank < count; rank++) {
        farm_destroy(farms[rank]);
        farms[rank] = NULL;
        free(films[rank].pixels);
        for (; boxes[rank].begun < boxes[rank].ended; boxes[rank].begun++)
            free(boxes[rank].letters[boxes[rank].begun % QUEUE].data);
    }
}

static struct tile_picture picture_of(uint32_t number, const char *name) {
    struct tile_picture picture = {.number = number,
                                   .full_width = WIDTH,
                                   .full_height = HEIGHT,
                                   .width = WIDTH,
                                   .record = stage_record(INTEGRATOR_WHITTED),
                                   .height = HEIGHT,
                                   .shard = 1,
                                   .shards = 1};
    (void)snprintf(picture.name, sizeof picture.name, "%s", name);
    return picture;
}

/* The work of a worker: the first tile that is requested, a colour for each pixel. */
static void paint(struct film *film) {
    for (uint32_t tile = 0; tile < film_tile_count(film); tile++) {
        if (film->tiles[tile] != FILM_TILE_WANTED)
            continue;
        struct film_rectangle r = film_tile_rectangle(film, tile);
        for (uint32_t y = r.y0; y < r.y1; y++)
            for (uint32_t x = r.x0; x < r.x1; x++) {
                struct film_pixel *pixel = &film->pixels[y * WIDTH + x];
                film->marked[y * WIDTH + x] = (x + y) % 3 == 0;
                for (int c = 0; c < 3; c++) {
                    pixel->rgb[c] = (float)(x + 1000 * y + (uint32_t)c);
                    film->floats[3 * (y * WIDTH + x) + (uint32_t)c] = (x + y) % 3 == 0 ? -pixel->rgb[c] : pixel->rgb[c];
                }
            }
        film->tiles[tile] = FILM_TILE_DONE;
        return;
    }
}

static void check_film(const struct film *film) {
    int wrong = 0;
    CHECK_EQ_INT(film_tiles_in(film, FILM_TILE_DONE), film_tile_count(film));
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        uint32_t x = i % WIDTH, y = i / WIDTH;
        for (int c = 0; c < 3; c++) {
            float value = (float)(x + 1000 * y + (uint32_t)c);
            wrong += film->pixels[i].rgb[c] < value || film->pixels[i].rgb[c] > value;
            value = (x + y) % 3 == 0 ? -value : value;
            wrong += film->floats[3 * i + (uint32_t)c] < value || film->floats[3 * i + (uint32_t)c] > value;
        }
    }
    CHECK_EQ_INT(wrong, 0);
}

static void disturb(struct test_random *random) {
    int from = 1 + (int)test_uniform(random, 0, RANKS - 1);
    uint32_t pairs[][2] = {{1, 9999}, {7, 0}, {1, (uint32_t)test_uniform(random, 0, 15)}};
    uint8_t bytes[64] = {0};
    memcpy(bytes, pairs[(int)test_uniform(random, 0, 3)], 8);
    static const int to_first[] = {BEGIN, TILE, ANSWER, ASSIGN, CLOSE, ALIVE, NOTE, END, NO_KIND};
    post(from, 0, to_first[(int)test_uniform(random, 0, 9)], bytes, (size_t)test_uniform(random, 0, 40));
    static const int to_others[] = {BEGIN, TILE, LEAVE, LINE, NO_KIND, ANSWER, ALIVE, NOTE};
    post(0, from, to_others[(int)test_uniform(random, 0, 8)], bytes, test_uniform(random, 0, 1) < 0.5 ? 8 : 5);
    memcpy(bytes, pairs[(int)test_uniform(random, 0, 2)], 8); /* a tile and a picture that do not exist */
    post(0, from, test_uniform(random, 0, 1) < 0.5 ? ASSIGN : CLOSE, bytes, bytes[0] == 1 && bytes[4] == 15 ? 5 : 8);
}

static bool is_open(int rank) {
    return controls[rank].handout == HANDOUT_OPEN;
}

TEST(ranks_in_any_order_with_nonsense_messages_make_every_tile_once) {
    struct test_random random = {21};
    for (int turn = 0; turn < 30; turn++) {
        struct error error;
        struct tile_picture picture = picture_of(1, "a.png");
        char shares[100];
        begin_farm(RANKS);
        for (int rank = 0; rank < RANKS; rank++) {
            bool already = false;
            CHECK(farm_begin(farms[rank], &picture, &films[rank], &already, &error) && !already);
        }
        /* In some rounds rank 2 fails after a while, or rank 3 becomes silent. */
        for (int step = 0; step < 4000 && is_open(0); step++) {
            int rank = (int)test_uniform(&random, 0, RANKS);
            if (turn % 2)
                disturb(&random);
            if (turn % 3 == 1 && step > 20 && rank == 2) {
                if (is_open(2))
                    farm_end(farms[2], true);
                controls[2].handout = HANDOUT_CLOSED;
                continue;
            }
            if (turn % 5 == 2 && step == 15)
                post(3, 0, BYE, "", 1);
            if (turn % 5 == 2 && step >= 15 && rank == 3)
                continue;
            paint(&films[rank]);
            farm_step(farms[rank]);
        }
        CHECK(!is_open(0));
        check_film(&films[0]);
        unsigned made[RANKS], sum = 0;
        farm_shares(farms[0], shares, sizeof shares);
        CHECK(sscanf(shares, "%u %u %u %u", &made[0], &made[1], &made[2], &made[3]) == 4);
        for (int rank = 0; rank < RANKS; rank++)
            sum += made[rank];
        CHECK_EQ_INT(sum, film_tile_count(&films[0]));
        farm_shares(farms[0], shares, 3);
        CHECK(strlen(shares) < 3);
        for (int rank = 1; rank < RANKS; rank++) {
            farm_step(farms[rank]);
            CHECK(turn % 2 || turn % 3 == 1 || turn % 5 == 2 || !is_open(rank));
            farm_end(farms[rank], false);
        }
        farm_end(farms[0], false);
        end_farm(RANKS);
    }
}

/* Begins a picture on all ranks. */
static void begin_picture(int count) {
    struct error error;
    struct tile_picture picture = picture_of(1, "a.png");
    for (int rank = 0; rank < count; rank++) {
        bool already = false;
        CHECK(farm_begin(farms[rank], &picture, &films[rank], &already, &error) && !already);
    }
}

/* Time passes in small steps in which these ranks are alive. */
static void pass(double seconds, const char *there) {
    for (double end = time_now + seconds; time_now < end; time_now += 0.25) {
        if (strchr(there, '0') && !is_open(0))
            return;
        for (int rank = RANKS - 1; rank >= 0; rank--) {
            if (strchr(there, '0' + rank))
                farm_step(farms[rank]);
        }
    }
}

static uint32_t tiles_in(int rank, enum film_tile state) {
    return film_tiles_in(&films[rank], state);
}

static void expect_note(const char *part) {
    char line[256] = "";
    if (!farm_next_note(farms[0], line, sizeof line) || strncmp(line, "gray: warning: rank ", 20) != 0 ||
        !strstr(line, part))
        test_fail(__FILE__, __LINE__, "\"%s\" does not say \"%s\"", line, part);
}

/* Makes and sends tiles until the picture is complete. */
static void make_all(const char *makers) {
    for (int step = 0; step < 1000 && is_open(0); step++) {
        for (int rank = 0; rank < RANKS; rank++) {
            if (!strchr(makers, '0' + rank))
                continue;
            paint(&films[rank]);
            farm_step(farms[rank]);
        }
    }
    CHECK(!is_open(0));
    check_film(&films[0]);
}

TEST(tiles_of_a_silent_rank_are_made_by_others) {
    char line[256];
    begin_farm(3);
    begin_picture(3);
    pass(SILENCE * 0.9, "012");
    CHECK_EQ_INT(tiles_in(0, FILM_TILE_TAKEN), 4); /* of ranks 1 and 2 */
    pass(SILENCE * 3, "012");
    CHECK(!farm_next_note(farms[0], line, sizeof line)); /* all of them send heartbeats */
    pass(SILENCE * 1.2, "01");
    expect_note("rank 2 has been silent for 8 s");
    CHECK_EQ_INT(tiles_in(0, FILM_TILE_TAKEN), 2);
    make_all("01");
    end_farm(3);
}

TEST(a_rank_that_is_heard_again_makes_tiles_again_and_what_it_sends_is_harmless) {
    begin_farm(3);
    begin_picture(3);
    pass(1, "012");
    paint(&films[2]); /* finished, but not sent before the silence */
    paint(&films[2]);
    pass(SILENCE * 1.2, "01");
    expect_note("rank 2 has been silent");
    for (int i = 0; i < 5; i++) { /* one of its tiles is made by another rank */
        paint(&films[1]);
        pass(0.25, "01");
    }
    uint32_t done = tiles_in(0, FILM_TILE_DONE);
    pass(1, "012");
    expect_note("rank 2 is heard again");
    CHECK(tiles_in(0, FILM_TILE_DONE) >= done && is_open(0));
    CHECK(tiles_in(2, FILM_TILE_WANTED) > 0);
    make_all("012");
    end_farm(3);
}

TEST(a_tile_that_is_given_again_is_not_made_by_two_at_once) {
    begin_farm(2);
    begin_picture(2);
    pass(1, "01");
    uint32_t tile = 0;
    while (films[1].tiles[tile] != FILM_TILE_WANTED)
        tile++;
    films[1].tiles[tile] = FILM_TILE_TAKEN; /* a worker has it */
    pass(SILENCE * 1.2, "0");
    uint32_t again[2] = {1, tile};
    post(0, 1, ASSIGN, again, sizeof again);
    pass(1, "01");
    CHECK_EQ_INT(films[1].tiles[tile], FILM_TILE_TAKEN);
    films[1].tiles[tile] = FILM_TILE_WANTED;
    make_all("01");
    end_farm(2);
}

TEST(time_in_which_the_first_rank_did_not_run_is_no_silence_of_others) {
    char line[256];
    begin_farm(2);
    begin_picture(2);
    pass(1, "01");
    time_now += 1000 * SILENCE; /* it wrote a picture, was stopped, or the machine slept */
    pass(SILENCE / 2, "0");
    CHECK(!farm_next_note(farms[0], line, sizeof line));
    pass(SILENCE, "0");
    expect_note("rank 1 has been silent");
    end_farm(2);
}

TEST(tiles_of_a_renderer_that_is_gone_are_handed_out_again_on_the_first_rank) {
    begin_farm(2);
    begin_picture(2);
    pass(1, "01");
    for (uint32_t tile = 0; tile < film_tile_count(&films[0]); tile++) {
        if (films[0].tiles[tile] == FILM_TILE_WANTED)
            films[0].tiles[tile] = FILM_TILE_TAKEN;
    }
    CHECK_EQ_INT(tiles_in(0, FILM_TILE_TAKEN), 4);
    farm_take_back_own(farms[0]);
    CHECK_EQ_INT(tiles_in(0, FILM_TILE_TAKEN), 2);
    pass(0.25, "0");
    CHECK_EQ_INT(tiles_in(0, FILM_TILE_WANTED), 2);
    make_all("01");
    end_farm(2);
}

static void ignore_line(void *context, const char *line) {
    (void)context;
    (void)line;
}

static void let_time_pass(void *context) {
    (void)context;
    time_now += 0.25;
}

TEST(the_end_of_a_farm_waits_for_no_silent_rank) {
    begin_farm(3);
    post(1, 0, BYE, "", 1);
    farm_set_poll(farms[0], let_time_pass, NULL);
    farm_finish(farms[0], true, ignore_line, NULL);
    expect_note("rank 2 has been silent");
    CHECK_EQ_INT(silent_at_end[0], 2); /* rank 1 has said goodbye, and nothing since then */
    /* Both read the end message, the silent rank when it continues; it asks for a picture, which comes too late. */
    struct error error;
    struct tile_picture later = picture_of(2, "b.png");
    bool already = false;
    struct farm *first = farms[0];
    farms[0] = NULL; /* it is gone */
    CHECK(!farm_begin(farms[2], &later, &films[2], &already, &error) && error.kind == ERROR_CANCELLED);
    farm_finish(farms[2], true, ignore_line, NULL);
    farm_finish(farms[1], true, ignore_line, NULL);
    CHECK_EQ_INT(silent_at_end[1], 2);
    CHECK_EQ_INT(silent_at_end[2], 2);
    farms[0] = first;
    end_farm(3);
}

TEST(a_rank_that_missed_the_end_of_the_farm_gives_up_its_picture) {
    begin_farm(2);
    begin_picture(2);
    pass(1, "01");
    pass(SILENCE * 1.2, "0");
    make_all("0");
    farm_end(farms[0], false);
    farm_finish(farms[0], true, ignore_line, NULL); /* does not wait for it */
    CHECK_EQ_INT(controls[1].cancel, 0);
    pass(0.25, "1");
    CHECK_EQ_INT(controls[1].cancel, CANCEL_ALL);
    end_farm(2);
}

TEST(other_ranks_end_when_the_first_one_is_silent_for_very_long) {
    struct error error;
    struct tile_picture picture = picture_of(1, "a.png");
    bool already = false;
    begin_farm(2);
    struct farm *first = farms[0];
    farms[0] = NULL; /* it does nothing */
    farm_set_poll(farms[1], let_time_pass, NULL);
    double begun = time_now;
    CHECK(!farm_begin(farms[1], &picture, &films[1], &already, &error) && error.kind == ERROR_CANCELLED);
    CHECK(time_now - begun > 9 * SILENCE && farm_is_abandoned(farms[1]));
    farm_finish(farms[1], true, ignore_line, NULL); /* does not wait */
    farms[0] = first;
    end_farm(2);
}

static int reported;
static void count_line(void *context, const char *line) {
    (void)context;
    CHECK(strncmp(line, "gray: rank ", 11) == 0);
    reported++;
}

TEST(ranks_with_another_picture_late_ones_and_those_after_a_failure_are_answered) {
    for (int well = 0; well <= 1; well++) {
        struct error error;
        struct tile_picture picture = picture_of(1, "a.png"), other = picture_of(1, "a.png"),
                            later = picture_of(2, "b.png");
        bool already = false;
        other.key.files.a = 5;
        begin_farm(2);
        CHECK(farm_begin(farms[0], &picture, &films[0], &already, &error));
        CHECK(!farm_begin(farms[1], &other, &films[1], &already, &error));
        CHECK(error.kind == ERROR_SCENE && strstr(error.text, "a different picture from the first one"));
        /* Lines of a rank that the first rank has printed itself are not printed again; too many are cut. */
        farm_report(farms[0], "the same");
        farm_report(farms[1], "the same");
        for (int i = 0; i < 20; i++)
            farm_report(farms[i % 2], "something");
        farm_report(farms[1], "another");
        farm_step(farms[0]);
        for (int i = 0; i < 3; i++) { /* a rank that is slow asks when all is over */
            post(1, 0, LINE, "foreign", 7);
            farm_step(farms[0]);
        }
        for (int i = 0; i < 40; i++)
            farm_report(farms[i % 2], "more than there is room for");
        farm_end(farms[0], true);
        post(1, 0, BYE, "", 1);
        reported = 0;
        farm_finish(farms[0], well, count_line, NULL);
        CHECK_EQ_INT(reported, 4); /* another one, and three times an unknown message */
        bool asked = farm_begin(farms[1], &later, &films[1], &already, &error);
        CHECK(well ? asked && already : !asked && error.kind == ERROR_CANCELLED);
        farm_finish(farms[1], true, count_line, NULL);
        end_farm(2);
    }
}

TEST(a_rank_that_waits_is_stopped_by_an_interruption) {
    struct error error;
    struct tile_picture picture = picture_of(3, "c.png");
    bool already = false;
    begin_farm(2);
    controls[1].cancel = 1;
    CHECK(!farm_begin(farms[1], &picture, &films[1], &already, &error) && error.kind == ERROR_CANCELLED);
    controls[0].cancel = 1; /* no rank sends a goodbye any more */
    farm_finish(farms[0], true, count_line, NULL);
    end_farm(2);
}
