#include "base/bundle.h"
#include "base/mem.h"
#include "base/random.h"
#include "tests/harness.h"

#include <string.h>

/* A graph with what a scene has: arrays, shared nodes, cycles, pointers to nothing and to elements of their own. */
struct item {
    double value;
    struct item *next;
};
struct graph {
    struct item *items;
    uint32_t count, empty_count;
    struct graph *self;
    const struct item *first; /* of the items */
    const double *numbers, *nothing, *empty;
};

static void item_bundle(struct bundle *bundle, void *of_graph) {
    struct item *item = of_graph;
    BUNDLE(bundle, item->next, 1, item_bundle);
}

static void graph_bundle(struct bundle *bundle, void *any) {
    struct graph *graph = any;
    BUNDLE(bundle, graph->items, graph->count, item_bundle);
    BUNDLE(bundle, graph->self, 1, graph_bundle);
    BUNDLE(bundle, graph->first, 1, item_bundle);
    BUNDLE(bundle, graph->numbers, 3, NULL);
    BUNDLE(bundle, graph->nothing, 7, NULL);
    BUNDLE(bundle, graph->empty, graph->empty_count, NULL);
}

enum { ITEMS = 4 };
static double numbers[3] = {1, 2, 3};
static struct item shared, items[ITEMS];
static struct graph graph;

static struct bundle *make_bundle(void) {
    shared = (struct item){42, &shared};
    for (uint32_t i = 0; i < ITEMS; i++)
        items[i] = (struct item){i, i % 2 ? &shared : NULL};
    graph = (struct graph){items, ITEMS, 0, &graph, items, numbers, NULL, numbers};
    return bundle_create(&graph, sizeof graph, graph_bundle);
}

static void check_graph(const struct graph *g) {
    CHECK_EQ_INT(g->count, ITEMS);
    CHECK(g->self == g && g->first == g->items && !g->nothing && g->empty);
    for (uint32_t i = 0; i < ITEMS; i++) {
        CHECK(g->items[i].value == i);
        CHECK(i % 2 ? g->items[i].next == g->items[1].next : !g->items[i].next);
    }
    CHECK(g->items[1].next->value == 42 && g->items[1].next->next == g->items[1].next);
    CHECK(g->numbers[2] == 3);
}

TEST(a_bundle_has_what_its_root_points_to_once_and_works_where_it_lies) {
    struct error error;
    struct bundle *bundle = make_bundle();
    const size_t size = bundle_size(bundle);
    char *bytes = mem_alloc_aligned(64, size), *other = mem_alloc_aligned(64, size);
    bundle_write(bundle, bytes);
    memset(items, 1, sizeof items);
    memcpy(other, bytes, size);
    bundle_destroy(bundle);
    const struct graph *g = bundle_open(bytes, size, (uint64_t)(uintptr_t)bytes, sizeof graph, &error);
    check_graph(g);
    CHECK((const char *)g->items > bytes && (const char *)g->items < bytes + size);
    /* For another address, as that of a card, all pointers differ by the distance. */
    const uint64_t far = UINT64_C(0x7000000000);
    const struct graph *away = bundle_open(other, size, far, sizeof graph, &error);
    CHECK_EQ_INT((int64_t)((uint64_t)(uintptr_t)away->items - far), (char *)g->items - bytes);
    mem_free(bytes);
    mem_free(other);
}

/* So many times one to three bytes of a bundle are others. */
static void damage(uint64_t times) {
    struct error error;
    struct bundle *bundle = make_bundle();
    const size_t size = bundle_size(bundle);
    char *whole = mem_alloc_aligned(64, size), *bytes = mem_alloc_aligned(64, size);
    uint64_t refused = 0, outside = 0;
    bundle_write(bundle, whole);
    bundle_destroy(bundle);
    for (uint64_t i = 0; i < times; i++) {
        uint64_t random = random_combine(7, i);
        memcpy(bytes, whole, size);
        for (uint64_t k = 0; k <= i % 3; k++, random = random_combine(random, k))
            bytes[random % size] = (char)(random >> 32);
        const struct graph *g = bundle_open(bytes, size, (uint64_t)(uintptr_t)bytes, sizeof graph, &error);
        const char *at = g ? (const char *)g->items : bytes;
        refused += g == NULL;
        outside += !(at >= bytes && at < bytes + size);
    }
    CHECK_EQ_INT((int64_t)outside, 0);
    CHECK(refused > times / 20 && refused < times / 20 * 19);
    mem_free(whole);
    mem_free(bytes);
}

TEST(a_damaged_bundle_is_refused_or_points_into_itself) {
    damage(20000);
}

TEST_LONG(ten_million_damaged_bundles_are_refused_or_point_into_themselves) {
    damage(10000000);
}

TEST(a_bundle_that_is_cut_or_of_another_root_is_refused) {
    struct error error;
    struct bundle *bundle = make_bundle();
    const size_t size = bundle_size(bundle);
    char *bytes = mem_alloc_aligned(64, size);
    for (size_t cut = 0; cut < size; cut++) {
        bundle_write(bundle, bytes);
        CHECK(!bundle_open(bytes, cut, (uint64_t)(uintptr_t)bytes, sizeof graph, &error));
    }
    bundle_write(bundle, bytes);
    CHECK(!bundle_open(bytes, size, (uint64_t)(uintptr_t)bytes, sizeof graph + 8, &error));
    CHECK_EQ_INT(error.kind, ERROR_MACHINE);
    bundle_destroy(bundle);
    mem_free(bytes);
}
