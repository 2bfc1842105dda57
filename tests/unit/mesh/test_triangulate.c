/* Triangulation: the triangles of a polygon cover it once, whatever its shape. */
#include "mesh/triangulate_internal.h"

#include "tests/harness.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct polygon {
    double (*points)[3];
    uint32_t *corners;
    uint32_t count, capacity;
};

static void add(struct polygon *p, double x, double y) {
    if (p->count == p->capacity) {
        p->capacity = 2 * p->capacity + 64;
        p->points = realloc(p->points, p->capacity * sizeof *p->points);
        p->corners = realloc(p->corners, p->capacity * sizeof *p->corners);
    }
    p->corners[p->count] = p->count;
    p->points[p->count][0] = x;
    p->points[p->count][1] = y;
    p->points[p->count++][2] = 0.25 * x - 0.5 * y;
}

static void clear(struct polygon *p) {
    free(p->points);
    free(p->corners);
    *p = (struct polygon){0};
}

static double area(const struct polygon *p, uint32_t a, uint32_t b, uint32_t c) {
    const double *u = p->points[a], *v = p->points[b], *w = p->points[c];
    return ((v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0])) / 2;
}

static double polygon_area(const struct polygon *p) {
    double sum = 0;
    for (uint32_t i = 1; i + 1 < p->count; i++)
        sum += area(p, 0, i, i + 1);
    return sum;
}

/* Areas have the sign of the polygon's winding and add up: so the triangles neither overlap nor leave a hole. */
static void check_cover(const struct polygon *p, const char *what) {
    uint32_t(*triangles)[3] = malloc(p->count * sizeof *triangles);
    struct triangulate_scratch scratch = {0};
    CHECK(triangulate_polygon((const double(*)[3])p->points, p->corners, p->count, triangles, &scratch));
    double whole = polygon_area(p), sum = 0;
    uint32_t *uses = calloc(p->count, sizeof *uses);
    for (uint32_t i = 0; i + 2 < p->count; i++) {
        double part = area(p, triangles[i][0], triangles[i][1], triangles[i][2]);
        if (part * whole < -1e-12 * whole * whole)
            test_fail(__FILE__, __LINE__, "%s: triangle %u is turned over (%g of %g)", what, i, part, whole);
        sum += part;
        for (int j = 0; j < 3; j++)
            uses[triangles[i][j]]++;
    }
    if (!(fabs(sum - whole) <= 1e-9 * fabs(whole)))
        test_fail(__FILE__, __LINE__, "%s: %u corners cover %.15g of %.15g", what, p->count, sum, whole);
    for (uint32_t i = 0; i < p->count; i++)
        if (!uses[i])
            test_fail(__FILE__, __LINE__, "%s: corner %u is in no triangle", what, i);
    free(uses);
    free(triangles);
    triangulate_scratch_destroy(&scratch);
}

/* Also reversed and starting at other corners. */
static void check_turns(struct polygon *p, const char *what) {
    check_cover(p, what);
    struct polygon q = {0};
    for (uint32_t i = 0; i < p->count; i++) {
        uint32_t k = (p->count - 1 - i + p->count / 3) % p->count;
        add(&q, p->points[k][0], p->points[k][1]);
    }
    check_cover(&q, what);
    clear(&q);
    clear(p);
}

TEST(convex_polygons_become_a_fan_from_the_first_corner) {
    struct polygon p = {0};
    for (int i = 0; i < 9; i++)
        add(&p, cos(i * 2 * M_PI / 9), sin(i * 2 * M_PI / 9));
    uint32_t triangles[7][3];
    struct triangulate_scratch scratch = {0};
    CHECK(triangulate_polygon((const double(*)[3])p.points, p.corners, 9, triangles, &scratch));
    for (uint32_t i = 0; i < 7; i++)
        CHECK(triangles[i][0] == 0 && triangles[i][1] == i + 1 && triangles[i][2] == i + 2);
    triangulate_scratch_destroy(&scratch);
    check_turns(&p, "nonagon");
}

TEST(triangles_of_concave_polygons_cover_them_once) {
    struct polygon p = {0};
    add(&p, 0, 0), add(&p, 2, -1), add(&p, 0, 3), add(&p, -2, -1);
    check_turns(&p, "dart");
    add(&p, 0, 0), add(&p, 4, 0), add(&p, 4, 1), add(&p, 1, 1), add(&p, 1, 4), add(&p, 0, 4);
    check_turns(&p, "L");
    for (int i = 0; i < 60; i++)
        add(&p, (i % 2 ? 1 : 3) * cos(i * M_PI / 30), (i % 2 ? 1 : 3) * sin(i * M_PI / 30));
    check_turns(&p, "star");
    add(&p, 0, 0);
    for (int i = 0; i < 50; i++)
        add(&p, i + 1, i % 2 ? 0.5 : 3);
    add(&p, 50, 10), add(&p, 0, 10);
    check_turns(&p, "saw");
    /* An outline with an additional full turn must not count as convex. */
    for (int i = 0; i < 14; i++)
        add(&p, (3 - 0.1 * i) * cos(i * 0.8), (3 - 0.1 * i) * sin(i * 0.8));
    uint32_t triangles[12][3];
    struct triangulate_scratch scratch = {0};
    CHECK(triangulate_polygon((const double(*)[3])p.points, p.corners, p.count, triangles, &scratch));
    triangulate_scratch_destroy(&scratch);
    clear(&p);
}

TEST(collinear_and_coincident_corners_are_kept) {
    struct polygon p = {0};
    for (int i = 0; i < 5; i++)
        add(&p, i, 0);
    for (int i = 1; i < 5; i++)
        add(&p, 4, i);
    for (int i = 1; i < 5; i++)
        add(&p, 4 - i, 4);
    for (int i = 1; i < 4; i++)
        add(&p, 0, 4 - i);
    check_turns(&p, "square with points on its sides");
    add(&p, 0, 0), add(&p, 1, 0), add(&p, 1, 0), add(&p, 1, 1), add(&p, 1, 1), add(&p, 1, 1), add(&p, 0, 1);
    check_turns(&p, "square with doubled corners");
    add(&p, 0, 0), add(&p, 1, 0), add(&p, 2, 0), add(&p, 3, 0);
    check_cover(&p, "a line");
    clear(&p);
}

static void ring(struct polygon *p, double x, double y, double r, int corners, int first, bool clockwise) {
    for (int i = 0; i <= corners; i++) {
        int k = (first + (clockwise ? corners - i : i)) % corners;
        add(p, x + r * cos(k * 2 * M_PI / corners), y + r * sin(k * 2 * M_PI / corners));
    }
}

TEST(holes_joined_by_bridges_stay_open) {
    struct polygon p = {0};
    ring(&p, 0, 0, 5, 24, 0, false); /* ends where it began: there the bridge starts */
    ring(&p, 2, 0, 1, 16, 0, true);  /* and back */
    check_turns(&p, "ring");
    /* A square with eight holes, each joined to the corner at the origin; seen from there, from left to right. */
    add(&p, 0, 0), add(&p, 10, 0), add(&p, 10, 10), add(&p, 0, 10), add(&p, 0, 0);
    for (int i = 0; i < 8; i++) {
        double a = (80 - 10 * i) * M_PI / 180;
        for (int k = 0; k <= 9; k++)
            add(&p, 8 * cos(a) - 0.4 * cos(a - k * 2 * M_PI / 9), 8 * sin(a) - 0.4 * sin(a - k * 2 * M_PI / 9));
        add(&p, 0, 0);
    }
    p.count--;
    check_cover(&p, "cheese");
    clear(&p);
}

TEST(a_spiral_of_thousands_of_corners_is_covered_in_reasonable_time) {
    struct polygon p = {0};
    enum { CORNERS = 2000 };
    for (int i = 0; i < CORNERS; i++) {
        double a = i * 0.02;
        add(&p, (1 + a) * cos(a), (1 + a) * sin(a));
    }
    for (int i = CORNERS - 1; i >= 0; i--) {
        double a = i * 0.02;
        add(&p, (2.5 + a) * cos(a), (2.5 + a) * sin(a));
    }
    check_turns(&p, "spiral");
}

TEST(random_star_shaped_polygons_are_covered) {
    struct test_random random = {5};
    for (int round = 0; round < 400; round++) {
        struct polygon p = {0};
        int corners = 4 + (int)test_uniform(&random, 0, round % 20 == 0 ? 2000 : 60);
        for (int i = 0; i < corners; i++) {
            double r = test_uniform(&random, 0.1, 1), a = 2 * M_PI * (i + test_uniform(&random, 0, 0.9)) / corners;
            add(&p, r * cos(a), r * sin(a));
        }
        check_turns(&p, "random star");
    }
}
