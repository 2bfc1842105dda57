/* Which pictures --device auto leaves to the threads. A thread of the test is the device process, and emulates. */
#include "base/mem.h"
#include "host/picture_device.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <pthread.h>
#include <string.h>

struct server {
    struct share *link;
    void *scene;
    size_t size;
    struct device_slots slots;
    pthread_t thread;
    bool began, served;
    char line[256]; /* the last one that the user would see */
};

static void *run_server(void *context) {
    struct server *server = context;
    struct error error;
    server->served = device_link_serve(server->link->block, NULL, server->scene, server->size, server->slots, &error);
    return NULL;
}

static bool begin_server(void *context, const struct bundle *scene, uint32_t slots, uint32_t room, struct share *link,
                         struct error *error) {
    struct server *server = context;
    server->slots = (struct device_slots){slots, room};
    CHECK(share_create(link, device_link_size(server->slots), error));
    server->size = bundle_size(scene);
    server->scene = mem_alloc_aligned(64, server->size);
    bundle_write(scene, server->scene);
    server->link = link;
    server->began = pthread_create(&server->thread, NULL, run_server, server) == 0;
    return server->began;
}

static void keep_line(void *context, enum line_kind kind, const char *text) {
    struct server *server = context;
    CHECK(kind == LINE_DETAIL);
    (void)snprintf(server->line, sizeof server->line, "%s", text);
}

/* Renders with so many samples of a pixel. began: with a device process, as if the picture needed hours. */
static void render(struct server *server, uint32_t samples, bool *is_same) {
    enum { WIDTH = 16, HEIGHT = 12 };
    struct stage s;
    stage_begin(&s, 2);
    s.settings.integrator = INTEGRATOR_PATH;
    s.settings.path_samples = (int)samples;
    s.sky.colour = colour_make(0.2, 0.3, 0.4);
    (void)stage_sphere(&s, s.root, stage_phong(&s, colour_all(0.7), colour_all(0), 1));
    CHECK(stage_render(&s, WIDTH, HEIGHT));
    struct render_job job = stage_job(&s, WIDTH, HEIGHT);
    const size_t size = (size_t)WIDTH * HEIGHT * job.film->record.floats * sizeof(float);
    float *floats = mem_alloc(size);
    memcpy(floats, job.film->floats, size);
    const struct host_services services = {.context = server, .device = begin_server, .line = keep_line};
    struct picture_device device = {.services = &services, .pool = s.pool, .kind = DEVICE_AUTO};
    struct path_device maker;
    CHECK(picture_device_init(&device, &job, &maker, &s.error));
    job.device = &maker;
    if (server->began)
        maker.is_worth = NULL;
    server->began = false;
    for (uint32_t i = 0; i < film_tile_count(job.film); i++)
        atomic_store(&job.film->tiles[i], FILM_TILE_WANTED);
    CHECK(render_run(&job, s.pool, &s.statistics, &s.error));
    *is_same = memcmp(floats, job.film->floats, size) == 0;
    if (server->began) {
        CHECK(!device_link_statistics(device.memory.block).name[0]);
        (void)pthread_join(server->thread, NULL);
    }
    picture_device_end(&device);
    mem_free(server->scene);
    mem_free(floats);
    stage_end(&s);
}

TEST(a_short_picture_starts_no_device_process_with_auto) {
    struct server server = {.began = false};
    bool is_same;
    render(&server, 4, &is_same);
    CHECK(is_same && !server.began);
    CHECK(strstr(server.line, "gray: the processor renders: it needs about ") == server.line);
}

/* The emulation has no rate. */
TEST(a_device_that_is_slower_than_the_threads_is_left_with_auto) {
    struct server server = {.began = true};
    bool is_same;
    render(&server, 4, &is_same);
    CHECK(is_same && server.began && server.served);
    CHECK(strstr(server.line, "gray: the processor renders: it makes ") == server.line &&
          strstr(server.line, " million samples a second, the card 0.000 million (trials)"));
}
