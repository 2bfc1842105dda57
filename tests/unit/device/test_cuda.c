/* The driver of cards without a card: a played one has memory that this process cannot reach between its calls, and
 * runs the kernels thread by thread. It must give the bytes of threads, whatever fails. */
#define GRAY_PLAYED_CARD
#include "device/kernels.c"

#include "base/mem.h"
#include "device/cuda.h"
#include "device/emulation.h"
#include "device/kernels_file.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

enum { WIDTH = 40, HEIGHT = 30, BLOCKS_OF_CARD = 256 };

uint32_t played_thread, played_threads;

/* --- the card --- */

static struct {
    pthread_mutex_t mutex;
    struct {
        void *memory;
        size_t size;
    } blocks[BLOCKS_OF_CARD];
    int block_count;
    size_t idle;     /* memory */
    int capability;  /* the first number */
    int until_error; /* calls; below 0: none */
    _Atomic int calls;
    enum { RIGHT, WRONG_SAMPLE, WRONG_SINE } is_wrong; /* in a bit */
    uint32_t waiting; /* threads for it, beside those of the processor; 0: these wait for it */
    struct file_bytes kernels;
} card = {.mutex = PTHREAD_MUTEX_INITIALIZER};

/* What a file of kernels has. */
#define PLAYED_MODULE(kernel) kernel " 8\nkernels\0"
static const char played_kernels[] =
    "gray kernels\n" PLAYED_MODULE("kernel_lanes") PLAYED_MODULE("kernel_arithmetic") PLAYED_MODULE("kernel_begin")
        PLAYED_MODULE("kernel_extend") PLAYED_MODULE("kernel_sort_questions") PLAYED_MODULE("kernel_ask")
            PLAYED_MODULE("kernel_keep") PLAYED_MODULE("kernel_sort") PLAYED_MODULE("kernel_shade")
                PLAYED_MODULE("kernel_shadow") PLAYED_MODULE("kernel_add") PLAYED_MODULE("kernel_finish");

static void reset_card(void) {
    for (int i = 0; i < card.block_count; i++)
        (void)munmap(card.blocks[i].memory, card.blocks[i].size);
    card.block_count = 0;
    card.calls = 0;
    card.idle = 400 << 20;
    card.capability = 9;
    card.until_error = -1;
    card.is_wrong = RIGHT;
    card.waiting = 0;
    card.kernels = (struct file_bytes){(const uint8_t *)played_kernels, sizeof played_kernels - 1};
}

/* What every call begins with. */
static int answer(void) {
    return ++card.calls > card.until_error && card.until_error >= 0 ? 719 : 0;
}
static void enter(bool opened) {
    if (opened)
        (void)pthread_mutex_lock(&card.mutex);
    for (int i = 0; i < card.block_count; i++)
        (void)mprotect(card.blocks[i].memory, card.blocks[i].size, opened ? PROT_READ | PROT_WRITE : PROT_NONE);
    if (!opened)
        (void)pthread_mutex_unlock(&card.mutex);
}

static int play_init(unsigned flags) {
    return (void)flags, answer();
}
static int play_version(int *version) {
    *version = 12040;
    return answer();
}
static int play_device(int *device, int number) {
    *device = number;
    return answer();
}
static int play_name(char *name, int size, int device) {
    (void)device;
    (void)snprintf(name, (size_t)size, "played card");
    return answer();
}
static int play_attribute(int *value, int attribute, int device) {
    (void)device;
    *value = attribute == CUDA_PROCESSORS ? 1 : attribute == CUDA_MAJOR ? card.capability : 0;
    return answer();
}
static int play_context(void **context, unsigned flags, int device) {
    (void)flags, (void)device;
    *context = &card;
    return answer();
}
static int play_use(void *context) {
    CHECK(context == &card);
    return answer();
}
static int play_destroy(void *context) {
    CHECK(context == &card);
    return 0;
}
static int play_limit(int limit, size_t value) {
    CHECK(limit == CUDA_STACK && value >= 65536);
    return answer();
}
static int play_memory(size_t *idle, size_t *all) {
    *idle = card.idle;
    *all = 2 * card.idle;
    return answer();
}
static int play_take(uint64_t *address, size_t size) {
    int status = answer();
    (void)pthread_mutex_lock(&card.mutex);
    CHECK(card.block_count < BLOCKS_OF_CARD);
    void *memory = mmap(NULL, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    CHECK(memory != MAP_FAILED);
    card.blocks[card.block_count].memory = memory;
    card.blocks[card.block_count++].size = size;
    (void)pthread_mutex_unlock(&card.mutex);
    *address = (uint64_t)(uintptr_t)memory;
    return status;
}
static int play_upload(uint64_t to, const void *from, size_t size, void *stream) {
    int status = answer();
    (void)stream;
    enter(true);
    memcpy((void *)(uintptr_t)to, from, size);
    enter(false);
    return status;
}
static int play_download(void *to, uint64_t from, size_t size, void *stream) {
    int status = answer();
    (void)stream;
    enter(true);
    memcpy(to, (const void *)(uintptr_t)from, status ? size / 2 : size);
    enter(false);
    return status;
}
static int play_load(void **module, const void *image) {
    CHECK(strcmp(image, "kernels") == 0);
    *module = &card;
    return answer();
}

static const char *const kernel_names[] = {
    "kernel_lanes",          "kernel_arithmetic", "kernel_begin", "kernel_extend",
    "kernel_sort_questions", "kernel_ask",        "kernel_keep",  "kernel_sort",
    "kernel_shade",          "kernel_shadow",     "kernel_add",   "kernel_finish"};
static int play_function(void **function, void *module, const char *name) {
    (void)module;
    for (size_t i = 0; i < sizeof kernel_names / sizeof *kernel_names; i++)
        if (strcmp(name, kernel_names[i]) == 0) {
            *function = (void *)(uintptr_t)&kernel_names[i];
            return answer();
        }
    return 500;
}
static int play_stream(void **stream, unsigned flags) {
    (void)flags;
    *stream = &card;
    return answer();
}
static int play_wait(void *stream) {
    return (void)stream, answer();
}

/* Kernels that are compiled here, or from the bitcode for cards. */
struct kernels {
    void (*lanes)(uint64_t lanes, uint64_t scene, uint32_t crossings);
    void (*arithmetic)(uint64_t digests);
    void (*begin)(uint64_t wave, uint64_t lanes, uint32_t crossings);
    void (*extend)(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
    void (*sort_questions)(uint64_t wave);
    void (*ask)(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
    void (*keep)(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
    void (*sort)(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
    void (*shade)(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
    void (*shadow)(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t turn);
    void (*add)(uint64_t wave, uint64_t lanes, uint32_t crossings);
    void (*finish)(uint64_t wave, uint64_t lanes, uint32_t crossings, uint32_t count);
    uint32_t *thread, *threads;
};
static const struct kernels own = {kernel_lanes,          kernel_arithmetic, kernel_begin, kernel_extend,
                                   kernel_sort_questions, kernel_ask,        kernel_keep,  kernel_sort,
                                   kernel_shade,          kernel_shadow,     kernel_add,   kernel_finish,
                                   &played_thread,        &played_threads};
static struct kernels kernels;

enum { ARITHMETIC = 1, ADD = 10 };
static void run_kernel(int kernel, uint64_t first, uint64_t second, uint32_t crossings, uint32_t last) {
    switch (kernel) {
    case 0:
        kernels.lanes(first, second, crossings);
        break;
    case ARITHMETIC:
        kernels.arithmetic(first);
        break;
    case 2:
        kernels.begin(first, second, crossings);
        break;
    case 3:
        kernels.extend(first, second, crossings, last);
        break;
    case 4:
        kernels.sort_questions(first);
        break;
    case 5:
        kernels.ask(first, second, crossings, last);
        break;
    case 6:
        kernels.keep(first, second, crossings, last);
        break;
    case 7:
        kernels.sort(first, second, crossings, last);
        break;
    case 8:
        kernels.shade(first, second, crossings, last);
        break;
    case 9:
        kernels.shadow(first, second, crossings, last);
        break;
    case ADD:
        kernels.add(first, second, crossings);
        break;
    default:
        kernels.finish(first, second, crossings, last);
        break;
    }
}

/* The threads run from the last one to the first one. */
static int play_launch(void *function, unsigned blocks, unsigned y, unsigned z, unsigned threads, unsigned threads_y,
                       unsigned threads_z, unsigned shared, void *stream, void **arguments, void **extra) {
    int status = answer(), kernel = (int)((const char *const *)function - kernel_names);
    CHECK(y == 1 && z == 1 && threads_y == 1 && threads_z == 1 && shared == 0 && stream && !extra && blocks > 0);
    if (status != 0)
        return status;
    enter(true);
    *kernels.threads = blocks * threads;
    for (uint32_t i = *kernels.threads; i-- > 0;) {
        *kernels.thread = i;
        run_kernel(kernel, *(uint64_t *)arguments[0], *(uint64_t *)arguments[1], *(uint32_t *)arguments[2],
                   *(uint32_t *)arguments[3]);
    }
    if (kernel == ADD && card.is_wrong == WRONG_SAMPLE)
        ((struct path_pixel *)(void *)((struct wave *)(uintptr_t) * (uint64_t *)arguments[0])->pixels)->sums[0].r +=
            0x1p-30F;
    if (kernel == ARITHMETIC && card.is_wrong == WRONG_SINE)
        (*(uint64_t **)arguments[0])[ARITHMETIC_NUMBERS - 1] ^= 1;
    enter(false);
    return 0;
}
static int play_text(int error, const char **text) {
    *text = error == 719 ? "unspecified launch failure" : "other";
    return 0;
}

static const struct cuda_calls played = {play_init,    play_version, play_device,   play_name,  play_attribute,
                                         play_context, play_destroy, play_use,      play_limit, play_memory,
                                         play_take,    play_upload,  play_download, play_load,  play_function,
                                         play_stream,  play_wait,    play_launch,   play_text};

/* --- pictures --- */

static void begin_scene(struct stage *s) {
    stage_begin(s, 2);
    s->settings.integrator = INTEGRATOR_PATH;
    s->settings.path_samples = 4;
    s->settings.denoise = DENOISER_GRAY;
    s->camera = (struct camera){{0, 1, 6}, {0, -0.1, -1}, {0, 1, 0}, 50};
    s->sky.colour = colour_make(0.2, 0.3, 0.4);
    stage_point_light(s, vec3_make(3, 5, 4), colour_make(0.9, 0.8, 0.7));
    struct node *floor = stage_cube(s, s->root, stage_phong(s, colour_make(0.7, 0.5, 0.3), colour_all(0.2), 30));
    stage_scale(s, floor, 20, 1, 20);
    stage_move(s, floor, -10, -2, -10);
    stage_move(s, stage_sphere(s, s->root, stage_glass(s, 1, 1, 1.5)), 1.2, 0, 0);
    stage_lenses(s, stage_phong(s, colour_make(0.8, 0.2, 0.1), colour_all(0), 1), 3);
}

/* A card, and the emulation that the card is compared with. */
struct service {
    struct pool *pool;
    struct emulation *emulation;
    struct cuda *cuda;
    struct error error;
};
static bool begin_service(void *context, struct bundle *scene, bool *is_used, struct error *error) {
    struct service *service = context;
    const struct path_device here = emulation_device(service->emulation);
    const size_t size = bundle_size(scene);
    void *bytes = mem_alloc_aligned(64, size);
    CHECK(bytes && here.begin(here.context, scene, is_used, error));
    bundle_write(scene, bytes);
    service->cuda = cuda_create(&played, &card.kernels, true, &service->error);
    if (service->cuda &&
        !cuda_open_scene(service->cuda, bytes, size, emulation_scene(service->emulation), &here, &service->error)) {
        cuda_destroy(service->cuda);
        service->cuda = NULL;
    }
    mem_free(bytes);
    return true;
}
static bool make_by_card(void *context, const struct path_orders *orders, struct path_counts *counts) {
    struct service *service = context;
    if (!service->cuda)
        return true;
    const struct path_device device = cuda_device(service->cuda);
    return device.make(device.context, orders, counts);
}

/* Renders with the card, and compares with the threads; reason: why the card was not used, or was lost. */
static void check_picture(struct stage *s, const float *floats, size_t size, char *reason, size_t room) {
    struct service service = {s->pool, emulation_create(s->pool, 0, 0), NULL, {0}};
    const struct path_device device = {
        .begin = begin_service, .make = make_by_card, .context = &service, .waiting = card.waiting};
    struct render_job job = stage_job(s, WIDTH, HEIGHT);
    job.device = &device;
    for (uint32_t i = 0; i < film_tile_count(job.film); i++)
        atomic_store(&job.film->tiles[i], FILM_TILE_WANTED);
    CHECK(render_run(&job, s->pool, &s->statistics, &s->error));
    CHECK(memcmp(job.film->floats, floats, size) == 0);
    const char *lost = service.cuda ? cuda_lost(service.cuda) : service.error.text;
    (void)snprintf(reason, room, "%s", lost ? lost : "");
    cuda_destroy(service.cuda);
    emulation_destroy(service.emulation);
}

/* The bytes that threads give. A new card is there afterwards. */
static float *film_of_threads(struct stage *s, size_t *size) {
    CHECK(stage_render(s, WIDTH, HEIGHT));
    *size = (size_t)WIDTH * HEIGHT * s->film.record.floats * sizeof(float);
    float *floats = mem_alloc(*size);
    memcpy(floats, s->film.floats, *size);
    reset_card();
    kernels = own;
    return floats;
}

TEST(a_card_gives_the_bytes_of_threads) {
    struct stage s;
    size_t size;
    char reason[256];
    begin_scene(&s);
    float *floats = film_of_threads(&s, &size);
    check_picture(&s, floats, size, reason, sizeof reason);
    CHECK(reason[0] == '\0');
    reset_card();
    card.waiting = 3;
    check_picture(&s, floats, size, reason, sizeof reason);
    CHECK(reason[0] == '\0');
    mem_free(floats);
    stage_end(&s);
}

static enum path_device_answer show_card(void *context, const struct path_view *view) {
    struct service *service = context;
    if (!service->cuda)
        return PATH_DEVICE_BEGINS;
    CHECK(emulation_set_view(service->emulation, view));
    cuda_set_view(service->cuda, view);
    return PATH_DEVICE_TAKES;
}

/* The scene is uploaded once. */
TEST(a_card_gives_the_bytes_of_threads_for_view_after_view) {
    struct stage s;
    begin_scene(&s);
    struct service service = {s.pool, emulation_create(s.pool, 0, 0), NULL, {0}};
    const struct path_device device = {
        .take_view = show_card, .begin = begin_service, .make = make_by_card, .context = &service};
    reset_card();
    kernels = own;
    for (int i = 0; i < 3; i++) {
        s.camera.eye.x = 0.6 * i; /* the last one in the glass */
        s.camera.eye.z = 6 - 3 * i;
        CHECK(stage_render(&s, WIDTH, HEIGHT + (uint32_t)i));
        struct render_job job = stage_job(&s, WIDTH, HEIGHT + (uint32_t)i);
        const size_t size = (size_t)WIDTH * job.height * job.film->record.floats * sizeof(float);
        float *floats = mem_alloc(size);
        memcpy(floats, job.film->floats, size);
        job.device = &device;
        for (uint32_t k = 0; k < film_tile_count(job.film); k++)
            atomic_store(&job.film->tiles[k], FILM_TILE_WANTED);
        CHECK(render_run(&job, s.pool, &s.statistics, &s.error));
        CHECK(memcmp(job.film->floats, floats, size) == 0 && service.cuda && !cuda_lost(service.cuda));
        mem_free(floats);
    }
    cuda_destroy(service.cuda);
    emulation_destroy(service.emulation);
    stage_end(&s);
}

/* Looks a name up; objects and functions have addresses of one size. */
static void find_symbol(void *library, const char *name, void *pointer) {
    void *found = dlsym(library, name);
    CHECK(found);
    memcpy(pointer, &found, sizeof found);
}

TEST(what_a_ray_touches_compiles_for_cards_and_gives_the_bytes_of_threads) {
    char line[8400], *root = realpath(".", NULL);
    struct stage s;
    size_t size;
    test_need_tools("clang");
    (void)snprintf(line, sizeof line, "BUILD=$PWD '%s/tools/device_scan.sh' shared", root);
    free(root);
    test_shell(line, 0, "");
    char *output = test_read_file(test_path("out.txt"), NULL);
    if (strstr(output, "nothing was checked"))
        test_skip("%.100s", output);
    free(output);
    void *library = dlopen(test_path("device/kernels.so"), RTLD_NOW | RTLD_LOCAL);
    if (!library && strstr(dlerror(), "not supported")) /* by a C library that is linked statically */
        test_skip("no library can be loaded");
    CHECK(library);
    begin_scene(&s);
    float *floats = film_of_threads(&s, &size);
    find_symbol(library, "kernel_lanes", &kernels.lanes);
    find_symbol(library, "kernel_arithmetic", &kernels.arithmetic);
    find_symbol(library, "kernel_begin", &kernels.begin);
    find_symbol(library, "kernel_extend", &kernels.extend);
    find_symbol(library, "kernel_sort_questions", &kernels.sort_questions);
    find_symbol(library, "kernel_ask", &kernels.ask);
    find_symbol(library, "kernel_keep", &kernels.keep);
    find_symbol(library, "kernel_sort", &kernels.sort);
    find_symbol(library, "kernel_shade", &kernels.shade);
    find_symbol(library, "kernel_shadow", &kernels.shadow);
    find_symbol(library, "kernel_add", &kernels.add);
    find_symbol(library, "kernel_finish", &kernels.finish);
    find_symbol(library, "bitcode_thread", &kernels.thread);
    find_symbol(library, "bitcode_threads", &kernels.threads);
    check_picture(&s, floats, size, line, sizeof line);
    CHECK(line[0] == '\0' && *kernels.threads > 0);
    mem_free(floats);
    stage_end(&s);
}

TEST(a_card_that_fails_at_any_call_changes_no_byte) {
    struct stage s;
    size_t size;
    char reason[256];
    begin_scene(&s);
    s.settings.path_samples = 1;
    float *floats = film_of_threads(&s, &size);
    check_picture(&s, floats, size, reason, sizeof reason);
    const int calls = card.calls;
    for (int i = 0; i < calls; i += i < 60 ? 1 : 23) {
        reset_card();
        card.until_error = i;
        check_picture(&s, floats, size, reason, sizeof reason);
        /* How many orders measure its rate depends on the time, so the call may not be reached. */
        CHECK(card.calls <= i || (strstr(reason, "the card cannot be used: ") == reason &&
                                  strstr(reason, ": unspecified launch failure")));
    }
    mem_free(floats);
    stage_end(&s);
}

TEST(a_card_with_other_bits_or_too_little_memory_or_too_old_is_refused_with_the_reason) {
    struct stage s;
    size_t size;
    char reason[256];
    begin_scene(&s);
    s.settings.path_samples = 1;
    float *floats = film_of_threads(&s, &size);
    card.is_wrong = WRONG_SINE;
    check_picture(&s, floats, size, reason, sizeof reason);
    CHECK_TEXT(reason,
               "the card cannot be used: operations of played card (capability 9.0, driver 12.4) have other bits");
    reset_card();
    card.is_wrong = WRONG_SAMPLE;
    check_picture(&s, floats, size, reason, sizeof reason);
    CHECK_TEXT(reason, "the card cannot be used: samples of played card (capability 9.0, driver 12.4) have other bits");
    reset_card();
    card.idle = 3 << 20;
    check_picture(&s, floats, size, reason, sizeof reason);
    CHECK(strstr(reason, "it has 3 MB of memory free, and "));
    reset_card();
    card.kernels.size -= 20;
    check_picture(&s, floats, size, reason, sizeof reason);
    CHECK_TEXT(reason,
               "the kernels for a card are not complete: there is no kernel_finish; make gpu writes them again");
    reset_card();
    card.capability = 6;
    check_picture(&s, floats, size, reason, sizeof reason);
    CHECK(strstr(reason, "played card (capability 6.0, driver 12.4); gray needs capability 7.0"));
    mem_free(floats);
    stage_end(&s);
}

TEST(a_file_of_kernels_that_was_cut_has_those_that_are_complete) {
    for (size_t size = 0; size < sizeof played_kernels; size++) {
        uint8_t *bytes = mem_alloc(size + 1);
        memcpy(bytes, played_kernels, size);
        const struct file_bytes part = {bytes, size};
        size_t end = sizeof "gray kernels\n" - 1;
        for (size_t i = 0; i < sizeof kernel_names / sizeof *kernel_names; i++) {
            const char *found = kernels_file_find(&part, kernel_names[i]);
            end += strlen(kernel_names[i]) + sizeof " 8\nkernels" - 1 + 1;
            CHECK((found != NULL) == (size >= end));
            CHECK(!found || strcmp(found, "kernels") == 0);
        }
        CHECK(!kernels_file_find(&part, "kernel") && !kernels_file_find(&part, "kernels"));
        mem_free(bytes);
    }
}
