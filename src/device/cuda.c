#include "device/cuda.h"

#include "base/clock.h"
#include "base/mem.h"
#include "device/arithmetic_internal.h"
#include "device/kernels_file.h"
#include "device/wave_internal.h"
#include "film/film.h"
#include "render/path_view.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum {
    THREADS = 128,
    BLOCKS = 4 /* of a processor of the card */,
    STACK_BYTES = 1 << 16 /* frames of functions that call themselves are not known before */,
    SMALLEST_WAVE = 1 << 12,
    FIRST_WAVE = 1 << 16,
    LARGEST_WAVE = 1 << 22,
    PIXEL_BYTES = PATH_ORDERS * FILM_TILE * FILM_TILE * sizeof(struct path_pixel),
    ORDER_BYTES = PATH_ORDERS * sizeof(struct wave_order)
};
/* Of the free memory of the card, for orders. A launch lasts at most .05 s: waves shrink and grow between these. */
static const double memory_share = 0.8, longest_launch = 0.025, shortest_launch = 0.005;

#define KERNELS(X)                                                                                                     \
    X(LANES, "lanes")                                                                                                  \
    X(ARITHMETIC, "arithmetic")                                                                                        \
    X(BEGIN, "begin")                                                                                                  \
    X(EXTEND, "extend")                                                                                                \
    X(SORT_QUESTIONS, "sort_questions")                                                                                \
    X(ASK, "ask")                                                                                                      \
    X(KEEP, "keep")                                                                                                    \
    X(SORT, "sort")                                                                                                    \
    X(SHADE, "shade")                                                                                                  \
    X(SHADOW, "shadow")                                                                                                \
    X(ADD, "add")                                                                                                      \
    X(FINISH, "finish")
#define KERNEL_MEMBER(member, name) KERNEL_##member,
#define KERNEL_NAME(member, name) "kernel_" name,
enum kernel { KERNELS(KERNEL_MEMBER) KERNEL_COUNT };

/* Memory on the card for the waves of a thread. */
struct card_stream {
    _Atomic bool taken;
    void *handle;
    uint64_t wave, orders, paths, pixels, lanes; /* addresses on the card; 0: none yet */
};

struct cuda {
    const struct cuda_calls *calls;
    void *context, *kernels[KERNEL_COUNT];
    char name[256];
    double begun;
    bool measures;
    int processors;
    struct card_stream streams[CUDA_STREAMS];
    /* Of the scene. */
    const struct path_scene *scene;
    uint64_t scene_on_card, scene_block;
    struct path_scene *root;         /* with the addresses of the card */
    uint32_t crossings, room, lanes; /* paths and lanes of a stream */
    _Atomic uint32_t limit;          /* paths of a wave, by the measured time of launches */
    _Atomic uint64_t launches;
    struct device_statistics statistics; /* but for these */
    pthread_mutex_t mutex;               /* of the reason */
    _Atomic bool is_lost;
    char reason[256];
};

/* --- calls --- */

static const char *text_of(const struct cuda *cuda, int status) {
    const char *text = NULL;
    return cuda->calls->error_text(status, &text) == 0 && text ? text : "unknown error";
}

/* Makes a call; its name is in the error. */
#define CALL(cuda, error, member, ...) call_ended(cuda, #member, (cuda)->calls->member(__VA_ARGS__), error)
static bool call_ended(const struct cuda *cuda, const char *call, int status, struct error *error) {
    return status == 0 ||
           error_set(error, ERROR_MACHINE, "the card cannot be used: %s: %s", call, text_of(cuda, status));
}

static bool find_card(struct cuda *cuda, struct error *error) {
    int version = 0, device = 0, major = 0, minor = 0;
    char name[128] = "";
    if (!CALL(cuda, error, init, 0) || !CALL(cuda, error, version, &version) ||
        !CALL(cuda, error, device, &device, 0) || !CALL(cuda, error, device_name, name, (int)sizeof name, device) ||
        !CALL(cuda, error, attribute, &cuda->processors, CUDA_PROCESSORS, device) ||
        !CALL(cuda, error, attribute, &major, CUDA_MAJOR, device) ||
        !CALL(cuda, error, attribute, &minor, CUDA_MINOR, device))
        return false;
    (void)snprintf(cuda->name, sizeof cuda->name, "%s (capability %d.%d, driver %d.%d)", name, major, minor,
                   version / 1000, version % 1000 / 10);
    if (major < 7)
        return error_set(error, ERROR_MACHINE, "the card cannot be used: %s; gray needs capability 7.0", cuda->name);
    if (cuda->processors < 1)
        cuda->processors = 1;
    return CALL(cuda, error, context_create, &cuda->context, 0, device) &&
           CALL(cuda, error, context_limit, CUDA_STACK, STACK_BYTES);
}

static bool load_kernels(struct cuda *cuda, const struct file_bytes *kernels, struct error *error) {
    static const char *const names[] = {KERNELS(KERNEL_NAME)};
    const double begun = clock_now();
    bool ok = true;
    for (int i = 0; ok && i < KERNEL_COUNT; i++) {
        void *module = NULL;
        const void *image = kernels_file_find(kernels, names[i]);
        if (!image)
            return error_set(error, ERROR_MACHINE,
                             "the kernels for a card are not complete: there is no %s; make gpu writes them again",
                             names[i]);
        ok = CALL(cuda, error, module_load, &module, image) &&
             CALL(cuda, error, module_function, &cuda->kernels[i], module, names[i]);
    }
    cuda->statistics.kernels_seconds = clock_now() - begun;
    return ok;
}

struct cuda *cuda_create(const struct cuda_calls *calls, const struct file_bytes *kernels, bool measures,
                         struct error *error) {
    struct cuda *cuda = mem_alloc_zero(1, sizeof *cuda);
    if (!cuda) {
        (void)error_no_memory(error, "a card");
        return NULL;
    }
    *cuda = (struct cuda){.calls = calls, .measures = measures, .limit = FIRST_WAVE};
    (void)pthread_mutex_init(&cuda->mutex, NULL);
    cuda->begun = clock_now();
    if (find_card(cuda, error) && load_kernels(cuda, kernels, error))
        return cuda;
    cuda_destroy(cuda);
    return NULL;
}

void cuda_destroy(struct cuda *cuda) {
    if (!cuda)
        return;
    if (cuda->context) /* with all that it has */
        (void)cuda->calls->context_destroy(cuda->context);
    (void)pthread_mutex_destroy(&cuda->mutex);
    mem_free(cuda->root);
    mem_free(cuda);
}

const char *cuda_lost(struct cuda *cuda) {
    return atomic_load(&cuda->is_lost) ? cuda->reason : NULL;
}

/* --- streams --- */

/* A stream of its own for each thread. */
static struct card_stream *take_stream(struct cuda *cuda) {
    for (uint32_t i = 0; i < CUDA_STREAMS; i++)
        if (!atomic_exchange(&cuda->streams[i].taken, true))
            return &cuda->streams[i];
    return NULL;
}

/* Of so many paths in flight. */
static uint64_t path_bytes(const struct cuda *cuda, uint32_t count) {
    struct wave wave;
    return wave_lay(&wave, cuda->scene, 0, count);
}

static bool fill_stream(struct cuda *cuda, struct card_stream *stream, struct error *error) {
    if (stream->lanes)
        return true;
    return CALL(cuda, error, stream_create, &stream->handle, 1 /* no order with stream 0 */) &&
           CALL(cuda, error, take, &stream->wave, sizeof(struct wave)) &&
           CALL(cuda, error, take, &stream->paths, path_bytes(cuda, cuda->room)) &&
           CALL(cuda, error, take, &stream->pixels, PIXEL_BYTES) &&
           CALL(cuda, error, take, &stream->orders, ORDER_BYTES) &&
           CALL(cuda, error, take, &stream->lanes, cuda->lanes * path_lane_size(cuda->crossings));
}

/* Launches a kernel with a thread for each item, but not more than there are lanes. last: turn, or count of lanes. */
static bool launch(struct cuda *cuda, const struct card_stream *stream, enum kernel kernel, uint64_t items,
                   uint32_t last, struct error *error) {
    uint64_t first = kernel == KERNEL_LANES        ? stream->lanes
                     : kernel == KERNEL_ARITHMETIC ? stream->pixels
                                                   : stream->wave;
    uint64_t second = kernel == KERNEL_LANES ? cuda->scene_on_card : stream->lanes;
    void *arguments[] = {&first, &second, &cuda->crossings, &last};
    const uint64_t threads = items < cuda->lanes ? items : cuda->lanes;
    const unsigned blocks = (unsigned)((threads + THREADS - 1) / THREADS);
    atomic_fetch_add(&cuda->launches, 1);
    return CALL(cuda, error, launch, cuda->kernels[kernel], blocks, 1, 1, THREADS, 1, 1, 0, stream->handle, arguments,
                NULL);
}

/* --- the scene --- */

/* The most paths and lanes for which all streams fit into the memory of the card. */
static bool divide_memory(struct cuda *cuda, size_t idle, struct error *error) {
    const uint64_t state = path_bytes(cuda, SMALLEST_WAVE) / SMALLEST_WAVE + 1, lane = path_lane_size(cuda->crossings),
                   fixed = PIXEL_BYTES + ORDER_BYTES;
    const uint64_t budget = (uint64_t)(memory_share * (double)idle) / CUDA_STREAMS;
    const uint64_t wanted = (uint64_t)cuda->processors * THREADS * BLOCKS;
    const uint64_t needed = SMALLEST_WAVE * state + THREADS * lane + fixed;
    if (budget < needed)
        return error_set(
            error, ERROR_MACHINE, "the card cannot be used: it has %llu MB of memory free, and %llu MB are needed",
            (unsigned long long)idle >> 20, (unsigned long long)((double)(needed * CUDA_STREAMS) / memory_share) >> 20);
    const uint64_t lanes = (budget - fixed) / 2 / lane / THREADS * THREADS;
    cuda->lanes = (uint32_t)(lanes < THREADS ? THREADS : lanes < wanted ? lanes : wanted);
    const uint64_t paths = (budget - fixed - cuda->lanes * lane) / state;
    cuda->room = (uint32_t)(paths < LARGEST_WAVE ? paths : LARGEST_WAVE);
    return true;
}

/* Whether operations and elementary functions of the card have the bits that those of this processor have. Before the
 * memory is divided: at the first launch the driver takes the stacks of all threads. */
static bool try_arithmetic(struct cuda *cuda, struct error *error) {
    uint64_t *digests = mem_alloc(ARITHMETIC_NUMBERS * sizeof *digests);
    struct card_stream own = {.taken = false};
    uint32_t same = 0;
    if (!digests)
        return error_no_memory(error, "a card");
    cuda->lanes = ARITHMETIC_NUMBERS; /* until the memory is divided */
    bool ok = CALL(cuda, error, stream_create, &own.handle, 1) &&
              CALL(cuda, error, take, &own.pixels, ARITHMETIC_NUMBERS * sizeof *digests) &&
              launch(cuda, &own, KERNEL_ARITHMETIC, ARITHMETIC_NUMBERS, 0, error) &&
              CALL(cuda, error, download, digests, own.pixels, ARITHMETIC_NUMBERS * sizeof *digests, own.handle) &&
              CALL(cuda, error, stream_wait, own.handle);
    while (ok && same < ARITHMETIC_NUMBERS && digests[same] == arithmetic_digest(same))
        same++;
    mem_free(digests);
    return ok &&
           (same == ARITHMETIC_NUMBERS ||
            error_set(error, ERROR_MACHINE, "the card cannot be used: operations of %s have other bits", cuda->name));
}

/* Whether the card gives a few samples the bits that this processor gives them. */
static bool try_samples(struct cuda *cuda, const struct path_device *here, struct error *error) {
    enum { PIXELS = 64 };
    struct path_pixel pixels[2][PIXELS];
    struct path_counts counts = {0};
    const struct path_order order = path_scene_trial(cuda->scene, 8, 2);
    const size_t size = path_scene_pixel_size(cuda->scene);
    const struct path_orders of_card = {&order, 1, pixels[0], size}, of_here = {&order, 1, pixels[1], size};
    const struct path_device card = cuda_device(cuda);
    memset(pixels, 0, sizeof pixels);
    if (path_order_pixels(&order) > PIXELS || !here->make(here->context, &of_here, &counts) ||
        !card.make(card.context, &of_card, &counts))
        return error_set(error, ERROR_MACHINE, "the card could not be tried");
    const char *reason = cuda_lost(cuda);
    if (reason)
        return error_set(error, ERROR_MACHINE, "%s", reason);
    if (memcmp(pixels[0], pixels[1], sizeof pixels[0]) != 0)
        return error_set(error, ERROR_MACHINE, "the card cannot be used: samples of %s have other bits", cuda->name);
    return true;
}

/* Samples a second: orders of a tile, each time with four times as many paths, until .1 s are over. */
static bool measure(struct cuda *cuda, struct error *error) {
    static const double seconds = 0.1;
    const size_t tile = FILM_TILE * FILM_TILE * path_scene_pixel_size(cuda->scene);
    const struct path_device card = cuda_device(cuda);
    const double end = clock_now() + seconds;
    struct path_order all[PATH_ORDERS];
    struct path_orders orders = {all, 1, mem_alloc_zero(PATH_ORDERS, tile), path_scene_pixel_size(cuda->scene)};
    if (!orders.pixels)
        return error_no_memory(error, "a card");
    for (uint32_t more = 1; clock_now() < end && more <= 1 << 14 && !cuda_lost(cuda); more *= 4) {
        struct path_counts counts = {0};
        orders.count = more < PATH_ORDERS ? more : PATH_ORDERS;
        for (uint32_t i = 0; i < orders.count; i++)
            all[i] = path_scene_trial(cuda->scene, FILM_TILE, more / orders.count);
        memset(orders.pixels, 0, orders.count * tile);
        const double begun = clock_now();
        (void)card.make(card.context, &orders, &counts);
        cuda->statistics.rate = (double)path_orders_paths(&orders) / (clock_now() - begun + 1e-9);
    }
    mem_free(orders.pixels);
    const char *reason = cuda_lost(cuda);
    return !reason || error_set(error, ERROR_MACHINE, "%s", reason);
}

bool cuda_open_scene(struct cuda *cuda, void *bytes, size_t size, const struct path_scene *scene,
                     const struct path_device *here, struct error *error) {
    size_t idle = 0, all = 0;
    cuda->scene = scene;
    cuda->crossings = path_scene_crossings(scene);
    if (!CALL(cuda, error, context_use, cuda->context) || !CALL(cuda, error, take, &cuda->scene_block, size))
        return false;
    char *root = bundle_open(bytes, size, cuda->scene_block, path_scene_size(), error);
    if (!root)
        return false;
    cuda->scene_on_card = cuda->scene_block + (uint64_t)(root - (const char *)bytes);
    if (!(cuda->root = mem_alloc(path_scene_size())))
        return error_no_memory(error, "the scene for a card");
    memcpy(cuda->root, root, path_scene_size());
    if (!CALL(cuda, error, upload, cuda->scene_block, bytes, size, NULL) || !CALL(cuda, error, stream_wait, NULL) ||
        !try_arithmetic(cuda, error) || !CALL(cuda, error, memory, &idle, &all) || !divide_memory(cuda, idle, error) ||
        !try_samples(cuda, here, error) || (cuda->measures && !measure(cuda, error)))
        return false;
    struct device_statistics *statistics = &cuda->statistics;
    (void)snprintf(statistics->name, sizeof statistics->name, "%.*s", (int)sizeof statistics->name - 1, cuda->name);
    statistics->start_seconds = clock_now() - cuda->begun;
    statistics->lanes = cuda->lanes;
    const uint64_t stream =
        path_bytes(cuda, cuda->room) + cuda->lanes * path_lane_size(cuda->crossings) + PIXEL_BYTES + ORDER_BYTES;
    statistics->bytes = size + CUDA_STREAMS * stream;
    return true;
}

static void note_loss(struct cuda *cuda, const struct error *error) {
    (void)pthread_mutex_lock(&cuda->mutex);
    if (!atomic_load(&cuda->is_lost))
        (void)snprintf(cuda->reason, sizeof cuda->reason, "%.*s", (int)sizeof cuda->reason - 1, error->text);
    atomic_store(&cuda->is_lost, true);
    (void)pthread_mutex_unlock(&cuda->mutex);
}

void cuda_set_view(struct cuda *cuda, const struct path_view *view) {
    struct error error;
    path_view_set(cuda->root, view, cuda->scene_on_card);
    if (!CALL(cuda, &error, context_use, cuda->context) ||
        !CALL(cuda, &error, upload, cuda->scene_on_card, cuda->root, path_scene_size(), NULL) ||
        !CALL(cuda, &error, stream_wait, NULL))
        note_loss(cuda, &error);
}

struct device_statistics cuda_statistics(struct cuda *cuda) {
    struct device_statistics statistics = cuda->statistics;
    statistics.launches = atomic_load(&cuda->launches);
    return statistics;
}

/* --- orders --- */

/* All turns of a wave; the wave in memory is that on the card afterwards. */
static bool run_wave(struct cuda *cuda, const struct card_stream *stream, struct wave *wave, struct error *error) {
    double longest = 0;
    wave->living_count[0] = 0;
    bool ok = CALL(cuda, error, upload, stream->wave, wave, sizeof *wave, stream->handle) &&
              launch(cuda, stream, KERNEL_BEGIN, wave->count, 0, error) &&
              CALL(cuda, error, download, wave, stream->wave, sizeof *wave, stream->handle) &&
              CALL(cuda, error, stream_wait, stream->handle);
    for (uint32_t turn = 0; ok && wave->living_count[turn % 2] > 0; turn++) {
        const uint32_t count = wave->living_count[turn % 2];
        const double start = clock_now();
        ok = launch(cuda, stream, KERNEL_EXTEND, count, turn, error) &&
             (!path_scene_leaves_solids(cuda->scene) ||
              (launch(cuda, stream, KERNEL_SORT_QUESTIONS, count, turn, error) &&
               launch(cuda, stream, KERNEL_ASK, count, turn, error) &&
               launch(cuda, stream, KERNEL_KEEP, count, turn, error))) &&
             launch(cuda, stream, KERNEL_SORT, count, turn, error) &&
             launch(cuda, stream, KERNEL_SHADE, count, turn, error) &&
             launch(cuda, stream, KERNEL_SHADOW, count, turn, error) &&
             CALL(cuda, error, download, wave, stream->wave, sizeof *wave, stream->handle) &&
             CALL(cuda, error, stream_wait, stream->handle);
        const double seconds = clock_now() - start;
        longest = seconds > longest ? seconds : longest;
    }
    ok = ok && launch(cuda, stream, KERNEL_ADD, wave->count /* or fewer pixels */, 0, error) &&
         CALL(cuda, error, stream_wait, stream->handle);
    const uint32_t limit = atomic_load(&cuda->limit);
    if (longest > longest_launch && limit > SMALLEST_WAVE)
        atomic_store(&cuda->limit, limit / 2);
    else if (longest < shortest_launch && wave->count >= limit && limit < cuda->room)
        atomic_store(&cuda->limit, limit < cuda->room / 2 ? 2 * limit : cuda->room);
    return ok;
}

static bool run_orders(struct cuda *cuda, struct card_stream *stream, const struct path_orders *orders,
                       struct path_counts *counts, struct error *error) {
    const uint64_t paths = path_orders_paths(orders);
    const size_t size = (size_t)path_orders_pixels(orders) * orders->pixel_size;
    struct wave_order numbered[PATH_ORDERS];
    if (!CALL(cuda, error, context_use, cuda->context) || !fill_stream(cuda, stream, error))
        return false;
    wave_number_orders(orders, numbered);
    /* Addresses on the card have the size of those here. */
    struct wave wave = {.scene = (const struct path_scene *)(uintptr_t)cuda->scene_on_card,
                        .orders = (const struct wave_order *)(uintptr_t)stream->orders,
                        .order_count = orders->count,
                        .pixels = (char *)(uintptr_t)stream->pixels,
                        .pixel_size = orders->pixel_size};
    (void)wave_lay(&wave, cuda->scene, stream->paths, cuda->room);
    bool ok = CALL(cuda, error, upload, stream->pixels, orders->pixels, size, stream->handle) &&
              CALL(cuda, error, upload, stream->orders, numbered, orders->count * sizeof *numbered, stream->handle) &&
              launch(cuda, stream, KERNEL_LANES, cuda->lanes, 0, error);
    for (; ok && wave.first < paths; wave.first += wave.count) {
        uint32_t limit = atomic_load(&cuda->limit);
        limit = limit < cuda->room ? limit : cuda->room;
        wave.count = paths - wave.first < limit ? (uint32_t)(paths - wave.first) : limit;
        ok = run_wave(cuda, stream, &wave, error);
    }
    ok = ok && launch(cuda, stream, KERNEL_FINISH, cuda->lanes, cuda->lanes, error) &&
         CALL(cuda, error, download, &wave, stream->wave, sizeof wave, stream->handle) &&
         CALL(cuda, error, stream_wait, stream->handle) &&
         CALL(cuda, error, download, orders->pixels, stream->pixels, size, stream->handle) &&
         CALL(cuda, error, stream_wait, stream->handle);
    if (ok && wave.met_fault)
        wave_leave_pixels(orders);
    if (ok)
        path_counts_add(counts, &wave.counts);
    return ok;
}

/* What a lost card leaves, the threads of the render make. */
static bool make(void *context, const struct path_orders *orders, struct path_counts *counts) {
    struct cuda *cuda = context;
    struct error error;
    struct card_stream *stream = atomic_load(&cuda->is_lost) ? NULL : take_stream(cuda);
    if (!stream)
        return true;
    if (!run_orders(cuda, stream, orders, counts, &error)) {
        wave_leave_pixels(orders);
        note_loss(cuda, &error);
    }
    atomic_store(&stream->taken, false);
    return true;
}

struct path_device cuda_device(struct cuda *cuda) {
    return (struct path_device){.make = make, .context = cuda};
}
