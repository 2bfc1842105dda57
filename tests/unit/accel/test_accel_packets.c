/* Packets of rays against the same rays one by one, to the bit, for every instruction set. */
#include "accel/triangle_packet.h"
#include "base/isa.h"
#include "tests/unit/mesh_makers.h"

static struct triangle_index *build(const struct triangle_set *set) {
    struct triangle_index *index = NULL;
    struct error error = {0};
    if (!triangle_index_build(&index, set, 0, NULL, &error)) {
        test_fail(__FILE__, __LINE__, "no index: %s", error.text);
        exit(1);
    }
    return index;
}

static struct vec3 some_vertex(const struct maker *m, struct test_random *random) {
    const double *v = m->vertices[(uint32_t)test_uniform(random, 0, m->vertex_count)];
    return vec3_make(v[0], v[1], v[2]);
}

static void set_direction(struct ray_packet *packet, uint32_t i, struct vec3 d) {
    packet->direction[0][i] = d.x;
    packet->direction[1][i] = d.y;
    packet->direction[2][i] = d.z;
}

enum { BEAM, FAN, AT_VERTICES, ALONG_AXES, ROUND_ABOUT, ODD_ONES, FORMS };

/* Rays of one origin in one of many patterns; unusual packets must be traced as single rays and not fail. */
static struct ray_packet any_packet(const struct maker *m, const struct mesh *mesh, struct test_random *random,
                                    int form) {
    struct box box = mesh_bounds(mesh);
    struct vec3 middle = vec3_scale(vec3_add(box.min, box.max), 0.5);
    double size = vec3_length(vec3_sub(box.max, box.min));
    const double distances[] = {0.1, 0.5, 2, 10, 40, 500};
    double away = size * distances[(int)test_uniform(random, 0, 6)];
    struct ray_packet packet = {.t_min = 0, .count = 1 + (uint32_t)test_uniform(random, 0, 64)};
    packet.origin = vec3_add_scaled(middle, test_point(random, 1), away);
    if (test_uniform(random, 0, 1) < 0.15)
        packet.origin = some_vertex(m, random);
    struct vec3 target = vec3_add_scaled(some_vertex(m, random), test_point(random, 1), 0.02 * size);
    struct vec3 route = vec3_sub(target, packet.origin);
    double length = vec3_length(route), width = test_uniform(random, 0, 0.3) * test_uniform(random, 0, 1);
    double scale = pow(2, floor(test_uniform(random, -40, 40)));
    for (uint32_t i = 0; i < packet.count; i++) {
        struct vec3 d = vec3_add_scaled(route, test_point(random, 1), width * length);
        if (form == FAN)
            d = vec3_add_scaled(route, test_point(random, 1), length);
        if (form == AT_VERTICES || (form == ODD_ONES && i % 3 == 1))
            d = vec3_sub(some_vertex(m, random), packet.origin);
        if (form == ALONG_AXES) {
            d = vec3_make(0, 0, route.z < 0 ? -1 : 1);
            if (i % 4)
                d = vec3_make(i % 4 == 1 ? 0x1p-70 : 0.0, i % 4 == 2 ? -0.01 * i : -0.0, d.z);
        }
        if (form == ROUND_ABOUT)
            d = test_point(random, 1);
        if (form == ODD_ONES && i == 7)
            d = test_uniform(random, 0, 1) < 0.5 ? vec3_all(0) : vec3_make(NAN, 1, INFINITY);
        set_direction(&packet, i, vec3_scale(d, scale));
        packet.t_max[i] = i % 3 ? INFINITY : test_uniform(random, 0, 2) / scale;
    }
    if (test_uniform(random, 0, 1) < 0.2)
        packet.t_min = test_uniform(random, 0, 1.2) / scale;
    ray_packet_pad(&packet);
    return packet;
}

static uint64_t check_packet(const struct triangle_index *index, const struct triangle_set *set,
                             const struct ray_packet *packet, uint64_t active, const char *what) {
    struct triangle_cost cost = {0};
    struct packet_hits hits;
    uint64_t found = triangle_packet_nearest(index, set, packet, active, &hits, &cost);
    uint64_t any = triangle_packet_any(index, set, packet, active, &cost);
    for (uint32_t i = 0; i < packet->count; i++) {
        struct ray ray = ray_packet_get(packet, i);
        struct triangle_hit hit = {0};
        bool expected = (active >> i & 1) && triangle_index_nearest(index, set, &ray, &hit, &cost);
        bool same = expected == (found >> i & 1) && expected == (any >> i & 1);
        if (same && expected)
            same = memcmp(&hits.t[i], &hit.t, 8) == 0 && memcmp(&hits.u[i], &hit.u, 8) == 0 &&
                   memcmp(&hits.v[i], &hit.v, 8) == 0 && hits.triangle[i] == hit.triangle && hits.enter[i] == hit.enter;
        if (!same)
            test_fail(__FILE__, __LINE__, "%s, instruction set %d: ray %u of %u differs from the same ray alone", what,
                      (int)cpu_isa(), i, packet->count);
    }
    CHECK((found & ~active) == 0 && (any & ~active) == 0);
    return found;
}

static void check_many(const struct maker *m, struct test_random *random, int packets, const char *what) {
    struct triangle_set set = set_of(m);
    struct triangle_index *index = build(&set);
    struct mesh *mesh = maker_mesh(m);
    uint64_t hits = 0;
    for (int i = 0; i < packets; i++) {
        struct ray_packet packet = any_packet(m, mesh, random, i % FORMS);
        uint64_t active = ray_packet_all(&packet);
        if (i % 5 == 4)
            active &= (uint64_t)test_uniform(random, 0, 0x1p62) * 5;
        hits += (uint64_t)__builtin_popcountll(check_packet(index, &set, &packet, active, what));
    }
    CHECK(hits > (uint64_t)packets / 2);
    mesh_release(mesh);
    triangle_index_destroy(index);
}

static const char *const sets[] = {"base", "avx2", "avx512"};

TEST(packets_answer_as_single_rays_for_every_instruction_set) {
    for (int isa = 0; isa < 3; isa++) {
        if (!cpu_select_isa(sets[isa]))
            continue;
        struct test_random random = {21};
        for (int kind = 0; kind < SOUP_KINDS; kind++) {
            struct maker m = {0};
            maker_soup(&m, (enum soup)kind, 600, &random);
            check_many(&m, &random, 150, "soup");
            maker_free(&m);
        }
        struct maker m = {0};
        maker_twisted_torus(&m, 60, 24, 1);
        check_many(&m, &random, 300, "torus");
        maker_free(&m);
        m = (struct maker){0};
        maker_sphere(&m, 40);
        check_many(&m, &random, 300, "sphere");
        maker_free(&m);
    }
    CHECK(cpu_select_isa("auto"));
}

/* Single precision resolves positions hardly better than the size of the ball's triangles. */
TEST(packets_from_near_a_tiny_dense_ball_in_a_wide_scene_answer_as_single_rays) {
    uint64_t hits = 0;
    for (int isa = 0; isa < 3; isa++) {
        if (!cpu_select_isa(sets[isa]))
            continue;
        struct test_random random = {22};
        for (int size = 1; size <= 6; size++) {
            struct maker m = {0};
            maker_tiny_ball(&m, pow(10, -size));
            struct triangle_set set = set_of(&m);
            struct triangle_index *index = build(&set);
            for (int i = 0; i < 60; i++) {
                struct ray_packet packet = {.t_min = 0, .count = 64};
                double away = pow(10, test_uniform(&random, -size, 1 - size));
                packet.origin = vec3_add_scaled(TINY_BALL_MIDDLE, test_point(&random, 1), away);
                for (uint32_t k = 0; k < packet.count; k++) {
                    const double *v = m.vertices[(uint32_t)test_uniform(&random, 0, m.vertex_count - 3)];
                    struct vec3 target = vec3_add_scaled(vec3_make(v[0], v[1], v[2]), test_point(&random, 1),
                                                         (k & 1) * 0.1 * pow(10, -size));
                    set_direction(&packet, k, vec3_sub(target, packet.origin));
                    packet.t_max[k] = INFINITY;
                }
                hits += (uint64_t)__builtin_popcountll(check_packet(index, &set, &packet, UINT64_MAX, "tiny ball"));
            }
            triangle_index_destroy(index);
            maker_free(&m);
        }
    }
    CHECK(cpu_select_isa("auto"));
    CHECK(hits > 10000);
}

/* Camera rays: edges that run through every pixel, frontal and oblique, and rays exactly through vertices. */
TEST(the_camera_rays_of_a_tile_answer_as_single_rays) {
    for (int isa = 0; isa < 3; isa++) {
        if (!cpu_select_isa(sets[isa]))
            continue;
        struct maker m = {0};
        enum { SIDE = 33 };
        for (int y = 0; y <= SIDE; y++)
            for (int x = 0; x <= SIDE; x++)
                maker_vertex(&m, x - SIDE / 2.0, y - SIDE / 2.0, (x * 7 + y * 5) % 3 * 0.25);
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t x = 0; x < SIDE; x++) {
                uint32_t a = y * (SIDE + 1) + x;
                maker_triangle(&m, a, a + 1, a + SIDE + 1);
                maker_triangle(&m, a + 1, a + SIDE + 2, a + SIDE + 1);
            }
        struct triangle_set set = set_of(&m);
        struct triangle_index *index = build(&set);
        for (int tile = 0; tile < 64; tile++) {
            struct ray_packet packet = {.origin = {0, tile % 2 ? 0.25 : 0, -20}, .count = 64};
            for (uint32_t i = 0; i < 64; i++) {
                double x = tile % 8 * 4 - 16 + i % 8 * 0.5, y = tile / 8.0 * 4 - 16 + i / 8 * 0.5;
                set_direction(&packet, i, vec3_make(x, y, 20));
                packet.t_max[i] = INFINITY;
            }
            CHECK(check_packet(index, &set, &packet, UINT64_MAX, "tile") != 0);
        }
        triangle_index_destroy(index);
        maker_free(&m);
    }
    CHECK(cpu_select_isa("auto"));
}
