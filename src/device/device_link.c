#include "device/device_link.h"

#include "base/mem.h"
#include "device/cuda.h"
#include "device/emulation.h"
#include "film/film.h"
#include "render/path_view.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

/* The render process writes the order (TAKEN) and asks for it (ASKED); a thread of the device makes it (WORKED, MADE);
 * the render process reads the records (TAKEN) and frees the slot. LEFT: the render has stopped before that. */
enum slot_state { SLOT_FREE, SLOT_TAKEN, SLOT_ASKED, SLOT_WORKED, SLOT_MADE, SLOT_LEFT };

struct slot {
    _Atomic uint32_t state;
    uint32_t view;  /* number of that of the orders; 0: that of the bundle */
    uint32_t count; /* orders */
    struct path_order orders[PATH_ORDERS];
    struct path_counts counts;
    char pixels[] __attribute__((aligned(16)));
};

/* Closed: before it was ready, or after. */
enum link_state { LINK_STARTS, LINK_READY, LINK_REFUSED, LINK_ENDED };
struct device_link {
    _Atomic uint32_t state;
    struct pool_event asked, answered;
    char reason[DEVICE_REASON];
    struct device_statistics statistics; /* but for these: */
    _Atomic uint64_t launches;
    _Atomic uint32_t view_number; /* it is stored before the view is written */
    struct path_view view;
    char slots[] __attribute__((aligned(64))); /* each with its room */
};

/* A request to stop is noticed so soon, in seconds. */
static const double patience = 0.01;
static const char damaged_view[] = "the data of a view is damaged";

static size_t slot_size(struct device_slots slots) {
    return (sizeof(struct slot) + slots.room + 63) / 64 * 64;
}

size_t device_link_size(struct device_slots slots) {
    return sizeof(struct device_link) + slots.count * slot_size(slots);
}

static struct slot *slot_of(struct device_link *link, struct device_slots slots, uint32_t i) {
    return (struct slot *)(void *)(link->slots + i * slot_size(slots));
}

void device_link_close(struct device_link *link) {
    uint32_t starts = LINK_STARTS, ready = LINK_READY;
    if (!atomic_compare_exchange_strong(&link->state, &starts, LINK_REFUSED))
        (void)atomic_compare_exchange_strong(&link->state, &ready, LINK_ENDED);
    pool_signal(&link->asked);
    pool_signal(&link->answered);
}

bool device_link_was_ready(struct device_link *link) {
    const uint32_t state = atomic_load(&link->state);
    return state == LINK_READY || state == LINK_ENDED;
}

bool device_link_is_closed(struct device_link *link) {
    const uint32_t state = atomic_load(&link->state);
    return state != LINK_STARTS && state != LINK_READY;
}

void device_link_refuse(struct device_link *link, const char *why) {
    (void)snprintf(link->reason, sizeof link->reason, "%s", why);
    device_link_close(link);
}

static void make_printable(char *text, size_t size) {
    text[size - 1] = '\0';
    for (char *c = text; *c; c++)
        *c = *c >= ' ' && *c != 0x7f ? *c : '.';
}

void device_link_reason(struct device_link *link, char out[DEVICE_REASON]) {
    memcpy(out, link->reason, DEVICE_REASON);
    make_printable(out, DEVICE_REASON);
}

struct device_statistics device_link_statistics(struct device_link *link) {
    struct device_statistics statistics = link->statistics;
    if (atomic_load(&link->state) != LINK_READY)
        return (struct device_statistics){0};
    make_printable(statistics.name, sizeof statistics.name);
    statistics.launches = atomic_load(&link->launches);
    return statistics;
}

/* --- the device process --- */

/* The view of the device; orders in work hold the lock. */
struct service_view {
    pthread_rwlock_t lock;
    uint32_t number;
    bool is_damaged;
};

struct service {
    struct device_link *link;
    struct device_slots slots;
    struct cuda *cuda; /* or NULL */
    struct path_device device;
    struct emulation *emulation;
    struct service_view *view;
};

/* Takes the view of the memory if it has that number, once no order is in work. It is copied, as orders are. */
static void take_view(const struct service *service, uint32_t number) {
    struct device_link *link = service->link;
    struct service_view *own = service->view;
    struct path_view view;
    (void)pthread_rwlock_wrlock(&own->lock);
    memcpy(&view, &link->view, sizeof view);
    atomic_thread_fence(memory_order_acquire);
    if (own->number != number && atomic_load(&link->view_number) == number && !own->is_damaged) {
        if (emulation_set_view(service->emulation, &view)) {
            own->number = number;
            if (service->cuda)
                cuda_set_view(service->cuda, &view);
        } else {
            own->is_damaged = true;
            device_link_refuse(link, damaged_view);
        }
    }
    (void)pthread_rwlock_unlock(&own->lock);
}

/* False: the order is of a view that is not the newest one. True: the caller unlocks the view after the order. */
static bool lock_view(const struct service *service, uint32_t number) {
    struct service_view *own = service->view;
    for (int tries = 0; tries < 2; tries++) {
        (void)pthread_rwlock_rdlock(&own->lock);
        if (own->number == number)
            return true;
        (void)pthread_rwlock_unlock(&own->lock);
        if (tries == 0)
            take_view(service, number);
    }
    return false;
}

static bool order_fits(const struct path_order *order) {
    return order->x0 < order->x1 && order->x1 - order->x0 <= FILM_TILE && order->y0 < order->y1 &&
           order->y1 - order->y0 <= FILM_TILE && order->begin < order->end;
}

/* The orders are copied: the other process may change them. */
static bool copy_orders(const struct slot *slot, struct path_order *copy, uint32_t *count) {
    *count = slot->count;
    if (*count < 1 || *count > PATH_ORDERS)
        return false;
    memcpy(copy, slot->orders, *count * sizeof *copy);
    for (uint32_t i = 0; i < *count; i++)
        if (!order_fits(&copy[i]))
            return false;
    return true;
}

static bool make_any(const struct service *service) {
    for (uint32_t i = 0; i < service->slots.count; i++) {
        struct slot *slot = slot_of(service->link, service->slots, i);
        uint32_t asked = SLOT_ASKED, worked = SLOT_WORKED;
        if (!atomic_compare_exchange_strong(&slot->state, &asked, SLOT_WORKED))
            continue;
        struct path_order copy[PATH_ORDERS];
        struct path_orders orders = {.all = copy, .pixels = slot->pixels};
        slot->counts = (struct path_counts){0};
        if (copy_orders(slot, copy, &orders.count) && lock_view(service, slot->view)) {
            orders.pixel_size = path_scene_pixel_size(emulation_scene(service->emulation));
            if (path_orders_pixels(&orders) * orders.pixel_size <= service->slots.room)
                (void)service->device.make(service->device.context, &orders, &slot->counts);
            (void)pthread_rwlock_unlock(&service->view->lock);
        }
        if (service->cuda)
            atomic_store(&service->link->launches, cuda_statistics(service->cuda).launches);
        if (!atomic_compare_exchange_strong(&slot->state, &worked, SLOT_MADE))
            atomic_store(&slot->state, SLOT_FREE);
        pool_signal(&service->link->answered);
        return true;
    }
    return false;
}

static void serve(void *context, uint32_t item, int worker) {
    const struct service *service = context;
    struct device_link *link = service->link;
    (void)item, (void)worker;
    while (atomic_load(&link->state) == LINK_READY && !(service->cuda && cuda_lost(service->cuda))) {
        const uint32_t seen = atomic_load(&link->asked.signals);
        if (!make_any(service))
            pool_wait(&link->asked, seen, 0.5);
    }
}

/* The card gets a copy of the scene; the emulation shows what its samples have to be. */
static bool open_scene(struct emulation *emulation, struct cuda *cuda, void *scene, size_t size, struct error *error) {
    const struct path_device here = emulation_device(emulation);
    void *copy = cuda ? mem_alloc_aligned(64, size) : NULL;
    if (cuda && !copy)
        return error_no_memory(error, "the scene for a card");
    if (copy)
        memcpy(copy, scene, size);
    bool ok = emulation_open(emulation, scene, size, error) &&
              (!cuda || cuda_open_scene(cuda, copy, size, emulation_scene(emulation), &here, error));
    mem_free(copy);
    return ok;
}

bool device_link_serve(struct device_link *link, struct cuda *cuda, void *scene, size_t size, struct device_slots slots,
                       struct error *error) {
    char ignored[256];
    struct pool *pool = pool_create((int)(cuda ? CUDA_STREAMS : slots.count), ignored);
    struct emulation *emulation = pool ? emulation_create(pool, 0, 0) : NULL;
    bool ok = emulation && open_scene(emulation, cuda, scene, size, error);
    if (!emulation)
        (void)error_no_memory(error, "the scene for a device");
    if (ok) {
        struct service_view view = {.number = 0};
        struct service service = {link,      slots, cuda, cuda ? cuda_device(cuda) : emulation_device(emulation),
                                  emulation, &view};
        uint32_t starts = LINK_STARTS;
        link->statistics = cuda ? cuda_statistics(cuda) : (struct device_statistics){.name = "emulation"};
        (void)pthread_rwlock_init(&view.lock, NULL);
        (void)atomic_compare_exchange_strong(&link->state, &starts, LINK_READY);
        pool_signal(&link->answered);
        (void)pool_run(pool, (uint32_t)pool_workers(pool), serve, &service);
        const char *lost = cuda ? cuda_lost(cuda) : NULL;
        lost = view.is_damaged ? damaged_view : lost;
        ok = !lost || error_set(error, ERROR_MACHINE, "%s", lost);
        (void)pthread_rwlock_destroy(&view.lock);
    }
    emulation_destroy(emulation);
    if (pool)
        pool_destroy(pool);
    return ok;
}

/* --- the render process --- */

bool device_client_wait(const struct device_client *client) {
    struct device_link *link = client->link;
    while (atomic_load(&link->state) == LINK_STARTS && !pool_cancelled(client->pool))
        pool_wait(&link->answered, atomic_load(&link->answered.signals), patience);
    return atomic_load(&link->state) == LINK_READY;
}

bool device_client_is_ready(const struct device_client *client) {
    return atomic_load(&client->link->state) == LINK_READY;
}

void device_client_set_view(struct device_client *client, const struct path_view *view) {
    atomic_store(&client->link->view_number, ++client->view);
    atomic_thread_fence(memory_order_release);
    client->link->view = *view;
}

/* There are as many slots as workers, but some may be left with an order of a render that was stopped. */
static struct slot *take_slot(const struct device_client *client) {
    while (atomic_load(&client->link->state) == LINK_READY && !pool_cancelled(client->pool)) {
        const uint32_t seen = atomic_load(&client->link->answered.signals);
        for (uint32_t i = 0; i < client->slots.count; i++) {
            struct slot *slot = slot_of(client->link, client->slots, i);
            uint32_t idle = SLOT_FREE;
            if (atomic_compare_exchange_strong(&slot->state, &idle, SLOT_TAKEN))
                return slot;
        }
        pool_wait(&client->link->answered, seen, patience);
    }
    return NULL;
}

/* The device frees it if it is at work. */
static void leave_slot(struct slot *slot) {
    uint32_t asked = SLOT_ASKED, worked = SLOT_WORKED;
    if (!atomic_compare_exchange_strong(&slot->state, &asked, SLOT_FREE) &&
        !atomic_compare_exchange_strong(&slot->state, &worked, SLOT_LEFT))
        atomic_store(&slot->state, SLOT_FREE);
}

bool device_client_make(struct device_client *client, const struct path_orders *orders, struct path_counts *counts) {
    struct device_link *link = client->link;
    const size_t size = (size_t)path_orders_pixels(orders) * orders->pixel_size;
    struct slot *slot = size <= client->slots.room ? take_slot(client) : NULL;
    if (!slot)
        return !pool_cancelled(client->pool);
    slot->view = client->view;
    slot->count = orders->count;
    memcpy(slot->orders, orders->all, orders->count * sizeof *orders->all);
    memcpy(slot->pixels, orders->pixels, size);
    atomic_store(&slot->state, SLOT_ASKED);
    pool_signal(&link->asked);
    for (;;) {
        const uint32_t seen = atomic_load(&link->answered.signals);
        uint32_t made = SLOT_MADE;
        if (atomic_compare_exchange_strong(&slot->state, &made, SLOT_TAKEN))
            break;
        bool cancelled = pool_cancelled(client->pool);
        if (cancelled || atomic_load(&link->state) != LINK_READY) {
            leave_slot(slot);
            return !cancelled;
        }
        pool_wait(&link->answered, seen, patience);
    }
    memcpy(orders->pixels, slot->pixels, size);
    path_counts_add(counts, &slot->counts);
    atomic_store(&slot->state, SLOT_FREE);
    return true;
}
