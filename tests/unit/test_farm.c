/* Farms without machines: ranks in one process, messages in queues, tiles painted by the test. Whatever the order of
 * steps, whatever nonsense travels between true messages and whoever falls out, the first rank ends with every tile. */
#include "app/farm.h"
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RANKS = 4, WIDTH = 130, HEIGHT = 70, QUEUE = 4096 };
/* As in farm.c. */
enum { BEGIN = 1, TILE, LEAVE, LINE, BYE, ANSWER, ASSIGN, CLOSE, NO_KIND = 99 };

struct letter {
    int from, kind;
    size_t size;
    uint8_t *data;
};

struct post {
    struct letter letters[QUEUE];
    uint32_t begun, ended;
};

static struct post boxes[RANKS]; /* by the rank that they are for */
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
        transports[rank] = (struct farm_transport){
            .context = &ranks[rank], .rank = rank, .size = count, .send = send, .receive = receive};
        farms[rank] = farm_create(&transports[rank], 2, &controls[rank]);
        CHECK(farms[rank] != NULL && farm_is_first(farms[rank]) == (rank == 0));
        films[rank] = (struct film){.full_width = WIDTH, .full_height = HEIGHT};
        CHECK(film_size(WIDTH, HEIGHT, &bytes, &error));
        film_place(&films[rank], calloc(1, bytes), WIDTH, HEIGHT);
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
                                   .height = HEIGHT,
                                   .shard = 1,
                                   .shards = 1};
    (void)snprintf(picture.name, sizeof picture.name, "%s", name);
    return picture;
}

/* What a worker would do: the first tile that is wanted, a colour for each pixel. */
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
                    pixel->first[c] = (x + y) % 3 == 0 ? -pixel->rgb[c] : pixel->rgb[c];
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
            wrong += film->pixels[i].first[c] < value || film->pixels[i].first[c] > value;
        }
    }
    CHECK_EQ_INT(wrong, 0);
}

static void disturb(struct test_random *random) {
    int from = 1 + (int)test_uniform(random, 0, RANKS - 1);
    uint32_t pairs[][2] = {{1, 9999}, {7, 0}, {1, (uint32_t)test_uniform(random, 0, 15)}};
    uint8_t bytes[64] = {0};
    memcpy(bytes, pairs[(int)test_uniform(random, 0, 3)], 8);
    static const int to_first[] = {BEGIN, TILE, ANSWER, ASSIGN, CLOSE, NO_KIND};
    post(from, 0, to_first[(int)test_uniform(random, 0, 6)], bytes, (size_t)test_uniform(random, 0, 40));
    static const int to_others[] = {BEGIN, TILE, LEAVE, LINE, NO_KIND, ANSWER};
    post(0, from, to_others[(int)test_uniform(random, 0, 6)], bytes, test_uniform(random, 0, 1) < 0.5 ? 8 : 5);
    memcpy(bytes, pairs[(int)test_uniform(random, 0, 2)], 8); /* neither a tile nor a picture that there is */
    post(0, from, test_uniform(random, 0, 1) < 0.5 ? ASSIGN : CLOSE, bytes, bytes[0] == 1 && bytes[4] == 15 ? 5 : 8);
}

static bool is_open(int rank) {
    return controls[rank].gate == GATE_OPEN;
}

TEST(ranks_in_any_order_with_nonsense_between_make_every_tile_once) {
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
        /* On some turns rank 2 falls out after a while, or rank 3 has nothing to say any more. */
        for (int step = 0; step < 4000 && is_open(0); step++) {
            int rank = (int)test_uniform(&random, 0, RANKS);
            if (turn % 2)
                disturb(&random);
            if (turn % 3 == 1 && step > 20 && rank == 2) {
                if (is_open(2))
                    farm_end(farms[2], true);
                controls[2].gate = GATE_CLOSED;
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

static int told;
static void count_line(void *context, const char *line) {
    (void)context;
    CHECK(strncmp(line, "gray: rank ", 11) == 0);
    told++;
}

TEST(ranks_with_another_picture_late_ones_and_those_after_a_failure_are_told) {
    for (int well = 0; well <= 1; well++) {
        struct error error;
        struct tile_picture picture = picture_of(1, "a.png"), other = picture_of(1, "a.png"),
                            later = picture_of(2, "b.png");
        bool already = false;
        other.key.files.a = 5;
        begin_farm(2);
        CHECK(farm_begin(farms[0], &picture, &films[0], &already, &error));
        CHECK(!farm_begin(farms[1], &other, &films[1], &already, &error));
        CHECK(error.kind == ERROR_SCENE && strstr(error.text, "another picture than the first one"));
        /* Lines of a rank that the first one has told itself are not told again; too many are cut. */
        farm_tell(farms[0], "the same");
        farm_tell(farms[1], "the same");
        for (int i = 0; i < 20; i++)
            farm_tell(farms[i % 2], "something");
        farm_tell(farms[1], "another");
        farm_step(farms[0]);
        for (int i = 0; i < 3; i++) { /* a rank that is slow asks when all is over */
            post(1, 0, LINE, "foreign", 7);
            farm_step(farms[0]);
        }
        for (int i = 0; i < 40; i++)
            farm_tell(farms[i % 2], "more than there is room for");
        farm_end(farms[0], true);
        post(1, 0, BYE, "", 1);
        told = 0;
        farm_finish(farms[0], well, count_line, NULL);
        CHECK_EQ_INT(told, 4); /* another, and three times what is foreign */
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
    controls[0].cancel = 1; /* nobody says goodbye any more */
    farm_finish(farms[0], true, count_line, NULL);
    end_farm(2);
}
