/* The memory between the render process and a device process, of which neither relies on the other. */
#define device_link_size device_link_size_here
#define device_link_close device_link_close_here
#define device_link_serve device_link_serve_here
#define device_link_was_ready device_link_was_ready_here
#define device_link_refuse device_link_refuse_here
#define device_link_reason device_link_reason_here
#define device_link_statistics device_link_statistics_here
#define device_client_wait device_client_wait_here
#define device_client_make device_client_make_here
#define device_link_is_closed device_link_is_closed_here
#define device_client_is_ready device_client_is_ready_here
#define device_client_set_view device_client_set_view_here
#include "device/device_link.c"

#include "base/mem.h"
#include "base/random.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <pthread.h>

enum { WIDTH = 16, HEIGHT = 12 };
/* With room for three tiles. */
#define TWO_SLOTS ((struct device_slots){2, 3 * FILM_TILE * FILM_TILE * (uint32_t)sizeof(struct path_pixel)})
#define SMALL_PIXEL path_pixel_size(false) /* samples have no parts */

struct server {
    struct device_link *link;
    void *scene;
    size_t size;
    bool served;
    struct error error;
    struct path_view view;
    pthread_t thread;
};

static void *run_server(void *context) {
    struct server *server = context;
    server->served = device_link_serve(server->link, NULL, server->scene, server->size, TWO_SLOTS, &server->error);
    return NULL;
}

/* Keeps the bundle, and renders nothing. */
static bool keep_scene(void *context, struct bundle *scene, bool *is_used, struct error *error) {
    *is_used = false;
    struct server *server = context;
    server->size = bundle_size(scene);
    server->scene = mem_alloc_aligned(64, server->size);
    bundle_write(scene, server->scene);
    return error_set(error, ERROR_CANCELLED, "kept");
}

static enum path_device_answer keep_view(void *context, const struct path_view *view) {
    struct server *server = context;
    server->view = *view;
    return PATH_DEVICE_BEGINS;
}

static void begin_server(struct stage *s, struct server *server) {
    const struct path_device receiver = {.take_view = keep_view, .begin = keep_scene, .context = server};
    stage_begin(s, 1);
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = 4;
    s->sky.colour = colour_make(0.2, 0.3, 0.4);
    stage_point_light(s, vec3_make(3, 5, 4), colour_make(0.9, 0.8, 0.7));
    (void)stage_sphere(s, s->root, stage_phong(s, colour_all(0.7), colour_all(0), 1));
    CHECK(stage_render(s, WIDTH, HEIGHT));
    struct render_job job = stage_job(s, WIDTH, HEIGHT);
    job.device = &receiver;
    CHECK(!render_run(&job, s->pool, &s->statistics, &s->error));
    server->link = mem_alloc_zero(1, device_link_size(TWO_SLOTS));
    CHECK(pthread_create(&server->thread, NULL, run_server, server) == 0);
}

static void end_server(struct stage *s, struct server *server) {
    device_link_close(server->link);
    (void)pthread_join(server->thread, NULL);
    mem_free(server->link);
    mem_free(server->scene);
    stage_end(s);
}

static uint32_t bits(uint64_t *random, uint32_t limit) {
    *random = random_combine(*random, 1);
    return (uint32_t)(*random >> 32) % limit;
}

/* Orders of a render process that an attacker controls. They have few samples, so that the test is short. */
static struct path_order odd_order(uint64_t *random) {
    uint32_t x0 = bits(random, 4) ? bits(random, 64) : UINT32_MAX - bits(random, 64);
    uint32_t y0 = bits(random, 4) ? bits(random, 64) : UINT32_MAX - bits(random, 64);
    uint32_t begin = bits(random, 4) ? bits(random, 8) : UINT32_MAX - bits(random, 8);
    return (struct path_order){
        x0, y0, x0 + bits(random, 48) - 8, y0 + bits(random, 48) - 8, begin, begin + bits(random, 4)};
}

TEST(a_device_process_survives_every_order_and_goes_on) {
    struct stage s;
    struct server server = {.served = false};
    begin_server(&s, &server);
    const struct device_client client = {server.link, s.pool, TWO_SLOTS, 0};
    CHECK(device_client_wait(&client));
    uint64_t random = 9, made = 0;
    for (int i = 0; i < 500; i++) {
        struct slot *slot = take_slot(&client);
        CHECK(slot != NULL);
        slot->count = bits(&random, 8) ? 1 + bits(&random, 3) : bits(&random, 2) ? UINT32_MAX - bits(&random, 9) : 0;
        bool fits = slot->count > 0 && slot->count < 4;
        const struct path_orders orders = {slot->orders, slot->count, slot->pixels, SMALL_PIXEL};
        uint64_t pixel = 0;
        memset(slot->pixels, i % 3 ? 0 : 0xa5, sizeof(struct path_pixel) * 3 * FILM_TILE * FILM_TILE);
        for (uint32_t k = 0; k < 3; k++) {
            slot->orders[k] = odd_order(&random);
            fits = fits && (k >= slot->count || order_fits(&slot->orders[k]));
        }
        for (uint32_t k = 0; fits && k < slot->count; k++)
            for (uint64_t n = path_order_pixels(&slot->orders[k]); n > 0; n--)
                path_orders_pixel(&orders, pixel++)->samples = i % 2 ? slot->orders[k].begin : 77;
        atomic_store(&slot->state, SLOT_ASKED);
        pool_signal(&server.link->asked);
        while (atomic_load(&slot->state) != SLOT_MADE)
            pool_wait(&server.link->answered, atomic_load(&server.link->answered.signals), patience);
        made += fits && path_orders_pixel(&orders, 0)->samples == slot->orders[0].end;
        atomic_store(&slot->state, SLOT_FREE);
    }
    CHECK(made > 10);
    /* The next order is made as ever. */
    struct path_pixel pixels[WIDTH * HEIGHT] = {{.samples = 0}};
    struct path_counts counts = {0};
    struct device_client user = client;
    /* In two orders: rows above and below. */
    const struct path_order all[] = {{0, 0, WIDTH, 5, 0, 4}, {0, 5, WIDTH, HEIGHT, 0, 4}};
    const struct path_orders orders = {all, 2, pixels, SMALL_PIXEL};
    CHECK(device_client_make(&user, &orders, &counts));
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        struct path_pixel pixel = {.samples = 0};
        memcpy(&pixel, path_orders_pixel(&orders, i), SMALL_PIXEL);
        struct colour mean = path_pixel_mean(&pixel), seen = stage_pixel(&s, i % WIDTH, (uint32_t)(i / WIDTH));
        CHECK((float)mean.r == (float)seen.r && (float)mean.b == (float)seen.b);
    }
    CHECK_EQ_INT((int64_t)counts.camera_rays, WIDTH * HEIGHT * 4);
    end_server(&s, &server);
    CHECK(server.served);
}

TEST(a_render_process_does_not_wait_for_a_device_that_is_gone) {
    struct stage s;
    struct server server = {.served = false};
    begin_server(&s, &server);
    struct device_client client = {server.link, s.pool, TWO_SLOTS, 0};
    CHECK(device_client_wait(&client));
    device_link_close(server.link);
    struct path_pixel pixels[WIDTH * HEIGHT] = {{.samples = 0}};
    struct path_counts counts = {0};
    const struct path_order order = {0, 0, WIDTH, HEIGHT, 0, 4};
    CHECK(device_client_make(&client, &(struct path_orders){&order, 1, pixels, SMALL_PIXEL}, &counts));
    CHECK(pixels[0].samples == 0 && counts.camera_rays == 0);
    end_server(&s, &server);
    CHECK(server.served);
}

TEST(an_order_is_made_for_the_newest_view_alone_and_a_damaged_one_ends_the_device) {
    struct stage s;
    struct server server = {.served = false};
    begin_server(&s, &server);
    struct device_client client = {server.link, s.pool, TWO_SLOTS, 0};
    CHECK(device_client_wait(&client));
    const struct path_order order = {0, 0, WIDTH, HEIGHT, 0, 4};
    struct path_pixel pixels[3][WIDTH * HEIGHT] = {{{.samples = 0}}};
    struct path_counts counts = {0};
    CHECK(device_client_make(&client, &(struct path_orders){&order, 1, pixels[0], SMALL_PIXEL}, &counts) &&
          pixels[0][0].samples == 4);
    /* The view of the bundle once more, and then an order for the one before. */
    device_client_set_view(&client, &server.view);
    CHECK(device_client_make(&client, &(struct path_orders){&order, 1, pixels[1], SMALL_PIXEL}, &counts));
    CHECK(memcmp(pixels[0], pixels[1], sizeof pixels[0]) == 0);
    client.view = 0;
    CHECK(device_client_make(&client, &(struct path_orders){&order, 1, pixels[2], SMALL_PIXEL}, &counts) &&
          pixels[2][0].samples == 0);
    client.view = 7;
    CHECK(device_client_make(&client, &(struct path_orders){&order, 1, pixels[2], SMALL_PIXEL}, &counts) &&
          pixels[2][0].samples == 0);
    client.view = 1;
    CHECK(device_client_make(&client, &(struct path_orders){&order, 1, pixels[2], SMALL_PIXEL}, &counts) &&
          pixels[2][0].samples == 4);
    server.view.camera.eye.x = NAN;
    device_client_set_view(&client, &server.view);
    memset(pixels[2], 0, sizeof pixels[2]);
    CHECK(device_client_make(&client, &(struct path_orders){&order, 1, pixels[2], SMALL_PIXEL}, &counts) &&
          pixels[2][0].samples == 0);
    char reason[DEVICE_REASON];
    device_link_reason(server.link, reason);
    CHECK_TEXT(reason, "the data of a view is damaged");
    CHECK(device_link_is_closed(server.link));
    end_server(&s, &server);
    CHECK(!server.served);
    CHECK_TEXT(server.error.text, "the data of a view is damaged");
}

TEST(the_reason_of_a_device_process_is_one_line_whatever_the_memory_holds) {
    struct device_link *link = mem_alloc_zero(1, device_link_size((struct device_slots){1, 0}));
    char reason[DEVICE_REASON];
    device_link_reason(link, reason);
    CHECK_TEXT(reason, "");
    device_link_refuse(link, "no card\n\033[31mat all");
    device_link_reason(link, reason);
    CHECK_TEXT(reason, "no card..[31mat all");
    CHECK(!device_link_was_ready(link));
    memset(link->reason, 'x', sizeof link->reason);
    device_link_reason(link, reason);
    CHECK_EQ_INT(strlen(reason), DEVICE_REASON - 1);
    mem_free(link);
}
