/* Implicit solids with a declared Lipschitz bound: against solids whose surface is found by bounds, and against their
 * functions at points all along lines. */
#include "scene/node.h"
#include "shape/shape.h"
#include "tests/unit/script_host.h"

#include <math.h>

static struct vec3 random_point(struct test_random *random, double half) {
    double x = test_uniform(random, -half, half), y = test_uniform(random, -half, half);
    return vec3_make(x, y, test_uniform(random, -half, half));
}

/* A line through two points of the bounds, which begins outside of them. */
static struct ray random_line(struct test_random *random, double half) {
    struct vec3 a = random_point(random, half), b = random_point(random, half);
    struct vec3 direction = vec3_scale(vec3_normalize(vec3_sub(b, a)), test_uniform(random, 0.3, 3));
    return (struct ray){vec3_add_scaled(a, direction, -20), direction, .t_min = 0, .t_max = INFINITY};
}

/* The solids of a script, in the order of the children of its node. */
static void see_solids(const char *text, void (*seen)(struct listener *listener, const struct render_request *request),
                       char *said, size_t size) {
    struct listener listener = {.seen = seen};
    struct error error;
    test_write_file(test_path("solids.lua"), text, strlen(text));
    CHECK(listen_to(&listener, test_path("solids.lua"), NULL, &error, NULL));
    CHECK_TEXT(error.text, "");
    CHECK_EQ_INT(listener.renders, 1);
    (void)snprintf(said, size, "%s", listener.said);
}

#define BEGIN "local abs, min, max, sqrt = math.abs, gr.min, gr.max, math.sqrt local root = gr.node 'root' "
#define END " gr.render{node = root, file = 'x.png', width = 4, height = 4, eye = {0, 0, 9}, lights = {}} "

/* --- distances --- */

enum { LIST = 256 };

/* The crossings of a line without pairs that are closer than the smallest steps; returns their number. */
static uint32_t read_crossings(const struct shape *shape, const struct ray *ray, struct geom_scratch *scratch,
                               double out[LIST]) {
    struct crossing_list list;
    uint32_t count = 0;
    double length = vec3_length(ray->direction);
    CHECK(shape_crossings(shape, ray, scratch, &list) && list.count < LIST);
    for (uint32_t k = 0; k < list.count; k++) {
        double t = scratch->items[list.first + k].t * length;
        CHECK(scratch->items[list.first + k].enter == (k % 2 == 0));
        if (count > 0 && t - out[count - 1] < 1e-3)
            count--;
        else
            out[count++] = t;
    }
    scratch->used = list.first;
    return count;
}

/* Every two children are the same solid. */
static void compare_pairs(struct listener *listener, const struct render_request *request) {
    struct geom_scratch scratch;
    struct test_random random = {18};
    int number = 0;
    (void)listener;
    CHECK(geom_scratch_init(&scratch, 100000));
    for (const struct node_child *link = request->root->first_child; link; link = link->next->next, number++) {
        const struct shape *bounded = &link->node->shape, *marched = &link->next->node->shape;
        long found = 0, wrong = 0;
        for (int i = 0; i < 150; i++) {
            struct ray ray = random_line(&random, 1.5);
            double a[LIST], b[LIST];
            uint32_t count = read_crossings(bounded, &ray, &scratch, a);
            bool same = read_crossings(marched, &ray, &scratch, b) == count;
            for (uint32_t k = 0; same && k < count; k++)
                same = fabs(a[k] - b[k]) < 1e-8;
            found += count;
            wrong += !same;
        }
        if (found < 20 || wrong > 0)
            test_fail(__FILE__, __LINE__, "solid %d: %ld crossings, %ld lines differ", number, found, wrong);
    }
    CHECK_EQ_INT(number, 24);
    geom_scratch_destroy(&scratch);
}

TEST(solids_with_declared_distances_are_crossed_where_bounds_find_them) {
    char said[8192];
    see_solids(BEGIN
               "local sdf = require 'sdf' local both = sdf.box{0.5, 0.8, 0.3} local ball = sdf.sphere(0.9) "
               "for _, f in ipairs{ball, both, sdf.torus(0.8, 0.3), sdf.cylinder(0.6, 0.7), sdf.capsule({-0.5, 0, 0}, "
               "{0.5, 0.4, 0.2}, 0.3), sdf.plane({1, 2, 0}, 0.2), sdf.ellipsoid{1, 0.6, 0.8}, "
               "sdf.extrude(sdf.polygon(5, 0.8), 0.4), sdf.extrude(sdf.rectangle(0.4, 0.7), 0.5), "
               "sdf.revolve(sdf.circle(0.3), 0.7), sdf.union(both, sdf.translate(ball, {0.6, 0, 0})), "
               "sdf.intersection(both, ball), sdf.difference(ball, both), "
               "sdf.smooth_union(0.2, both, sdf.translate(sdf.sphere(0.4), {0.7, 0.3, 0})), "
               "sdf.smooth_intersection(0.2, both, ball), sdf.smooth_difference(0.1, ball, both), "
               "sdf.round(both, 0.2), sdf.shell(ball, 0.05), sdf.shell(both, 0.01), sdf.rotate(both, 'x', 30), "
               "sdf.scale(sdf.torus(0.8, 0.3), 1.3), sdf.mirror(sdf.translate(ball, {0.4, 0, 0})), "
               "sdf.repeated(sdf.sphere(0.2), {0.6, 0.6, 0.6}, {1, 1, 1}), "
               "sdf.union(both, sdf.translate(sdf.sphere(0.2), {0, 0, 1.4}))} do "
               "for _, d in ipairs{false, true} do root:add_child(gr.implicit{f = f, bounds = {{-1.5, -1.5, -1.5}, "
               "{1.5, 1.5, 1.5}}, distance = d}) end end" END,
               compare_pairs, said, sizeof said);
    CHECK_TEXT(said, "");
}

/* --- a tolerance --- */

/* The nearest crossings with a tolerance, where the exact line is inside for more than twice as long. */
static void find_within_tolerance(struct listener *listener, const struct render_request *request) {
    const double share = 0x1p-10;
    struct geom_scratch scratch;
    struct test_random random = {19};
    (void)listener;
    CHECK(geom_scratch_init(&scratch, 100000));
    for (const struct node_child *link = request->root->first_child; link; link = link->next) {
        const struct shape *shape = &link->node->shape;
        int found = 0;
        for (int i = 0; i < 400; i++) {
            struct ray ray = random_line(&random, 1.5);
            struct crossing crossing;
            struct surface surface;
            double exact[LIST], length = vec3_length(ray.direction);
            scratch.tolerance = 0;
            const uint32_t count = read_crossings(shape, &ray, &scratch, exact);
            const double room = count == 0 ? 0 : 2 * share * exact[0];
            if (count < 2 || exact[1] - exact[0] <= room)
                continue;
            scratch.tolerance = (float)share;
            found++;
            CHECK(shape_nearest(shape, &ray, &scratch, &crossing) && crossing.enter);
            CHECK_NEAR(crossing.t * length, exact[0], room);
            shape_describe(shape, &ray, &crossing, &surface);
            /* A ball of radius 1: the step along the gradient leads to the surface. */
            CHECK_NEAR(vec3_length(surface.point), 1, room * room);
            CHECK(vec3_dot(surface.normal, vec3_normalize(surface.point)) > 1 - 1e-9);
        }
        CHECK(found > 100);
    }
    geom_scratch_destroy(&scratch);
}

TEST(crossings_with_a_tolerance_are_within_it_and_their_normals_are_those_of_the_surface) {
    char said[512];
    see_solids(BEGIN "for _, d in ipairs{false, true} do "
                     "root:add_child(gr.implicit{f = function(p) return gr.length(p) - 1 end, distance = d, "
                     "bounds = {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}}}) end "
                     /* an estimate that knows nothing of the inside */
                     "root:add_child(gr.implicit{f = function(p) return max(0.5 * (gr.length(p) - 0.998), 0) - 0.001 "
                     "end, distance = true, bounds = {{-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}}})" END,
               find_within_tolerance, said, sizeof said);
    CHECK_TEXT(said, "");
}

/* --- rays together --- */

/* Of rays that begin before, in and behind a solid: the exact nearest crossing; certain: the stretches before and
 * behind it are too long to be missed with the tolerance. Returns the rays that have one as bits. */
static uint64_t search_exactly(const struct shape *shape, const struct ray *rays, struct geom_scratch *scratch,
                               double share, struct crossing *out, uint64_t *certain) {
    uint64_t found = 0;
    *certain = 0;
    for (uint32_t i = 0; i < EXPR_BATCH; i++) {
        const bool met = shape_nearest(shape, &rays[i], scratch, &out[i]);
        const double room = met ? 2 * share * out[i].t : 0;
        const bool is_long =
            !met || (out[i].t - rays[i].t_min > room && rays[i].t_max - out[i].t > room &&
                     shape_contains(shape, ray_at(&rays[i], out[i].t + room), scratch) == out[i].enter);
        found |= (uint64_t)met << i;
        *certain |= (uint64_t)is_long << i;
    }
    return found;
}

static void search_together(struct listener *listener, const struct render_request *request) {
    const double share = 0x1p-11;
    struct geom_scratch scratch;
    struct test_random random = {20};
    int number = 0;
    (void)listener;
    CHECK(geom_scratch_init(&scratch, 100000));
    for (const struct node_child *link = request->root->first_child; link; link = link->next, number++) {
        const struct shape *shape = &link->node->shape;
        int compared = 0, wrong = 0;
        for (int round = 0; round < 20; round++) {
            struct ray rays[EXPR_BATCH];
            struct crossing exact[EXPR_BATCH], got[EXPR_BATCH];
            const uint64_t active = round == 0 ? 1 : ~(UINT64_C(1) << round);
            uint64_t certain;
            for (int i = 0; i < EXPR_BATCH; i++) {
                rays[i] = random_line(&random, 1.2);
                rays[i].t_min = i % 4 == 0 ? 20 + test_uniform(&random, -1, 1) : 0;
                rays[i].t_max = i % 5 == 0 ? 21 : INFINITY;
            }
            scratch.tolerance = 0;
            CHECK(!shape_takes_packets(shape, &scratch));
            const uint64_t want = search_exactly(shape, rays, &scratch, share, exact, &certain);
            scratch.tolerance = (float)share;
            CHECK(shape_takes_packets(shape, &scratch));
            const uint64_t found = shape_nearest_packet(shape, rays, active, &scratch, got);
            CHECK((found & ~active) == 0);
            for (int i = 0; i < EXPR_BATCH; i++) {
                if (!((active & certain) >> i & 1))
                    continue;
                const bool met = found >> i & 1;
                compared += met;
                wrong +=
                    met != (want >> i & 1) ||
                    (met && (fabs(got[i].t - exact[i].t) > 2 * share * exact[i].t || got[i].enter != exact[i].enter));
                if (met && number == 0) {
                    struct surface surface;
                    shape_describe(shape, &rays[i], &got[i], &surface);
                    CHECK_NEAR(vec3_length(surface.point), 0.9, 1e-6);
                    CHECK(vec3_dot(surface.normal, surface.point) > 0.9 * (1 - 1e-6));
                }
            }
        }
        if (compared < 100 || wrong > 0)
            test_fail(__FILE__, __LINE__, "solid %d: %d crossings, %d differ", number, compared, wrong);
    }
    CHECK_EQ_INT(number, 13);
    geom_scratch_destroy(&scratch);
}

/* --- fractals --- */

static long samples, wrong_samples, crossings;

/* Whether lines are inside where the function is below 0, at places all along them, and the nearest crossing from any
 * place is that of the list. */
static void check_sides(struct listener *listener, const struct render_request *request) {
    struct geom_scratch scratch;
    struct test_random random = {5};
    (void)listener;
    CHECK(geom_scratch_init(&scratch, 100000));
    samples = wrong_samples = crossings = 0;
    for (const struct node_child *link = request->root->first_child; link; link = link->next) {
        const struct shape *shape = &link->node->shape;
        for (int i = 0; i < 100; i++) {
            struct ray ray = random_line(&random, 1);
            struct crossing_list list;
            struct crossing nearest;
            CHECK(shape_crossings(shape, &ray, &scratch, &list));
            CHECK(list.count % 2 == 0);
            const struct crossing *items = &scratch.items[list.first];
            const double length = vec3_length(ray.direction), begin = 20 - 2.6 / length, end = 20 + 2.6 / length;
            crossings += list.count;
            for (uint32_t k = 0, before = 0; k < 1000; k++) {
                double t = begin + (end - begin) * (k + 0.5) / 1000;
                while (before < list.count && items[before].t < t)
                    before++;
                double back = before > 0 ? t - items[before - 1].t : INFINITY;
                double next = before < list.count ? items[before].t - t : INFINITY;
                if (fmin(back, next) * length < 1e-5)
                    continue;
                bool inside = shape_contains(shape, ray_at(&ray, t), &scratch);
                samples += inside || before % 2 == 1;
                wrong_samples += inside != (before % 2 == 1);
            }
            ray.t_min = begin + (end - begin) * test_uniform(&random, 0, 1);
            uint32_t first = 0;
            while (first < list.count && !(items[first].t > ray.t_min))
                first++;
            bool found = shape_nearest(shape, &ray, &scratch, &nearest);
            CHECK(found == (first < list.count));
            CHECK(!found || (nearest.t == items[first].t && nearest.part == items[first].part));
            CHECK(shape_any(shape, &ray, &scratch) == found);
            scratch.used = list.first;
        }
    }
    geom_scratch_destroy(&scratch);
}

#define CUBE "bounds = {{-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2}}"
/* The distance from a Menger sponge of some levels (I. Quilez, "Menger fractal", 2011). */
#define MENGER                                                                                                         \
    "local function menger(levels) return function(p) local x, y, z = abs(p.x), abs(p.y), abs(p.z) "                   \
    "local d, s = max(x, y, z) - 1, 1 for k = 1, levels do local function fold(u) u = (u * s) % 2 - 1 "                \
    "return abs(1 - 3 * abs(u)) end local a, b, c = fold(p.x), fold(p.y), fold(p.z) s = 3 * s "                        \
    "d = max(d, (min(max(a, b), max(b, c), max(c, a)) - 1) / s) end return d end end "

TEST(rays_that_are_searched_together_have_the_exact_crossings_within_the_tolerance) {
    char said[8192];
    see_solids(
        BEGIN MENGER
        "local sdf = require 'sdf' local ball = sdf.sphere(0.9) local box = sdf.box{0.5, 0.8, 0.3} local many = {} "
        "for i = 1, 30 do many[i] = sdf.translate(sdf.sphere(0.3), {math.sin(i), math.sin(2 * i), math.cos(3 * i)}) "
        "end "
        "for _, f in ipairs{ball, box, sdf.torus(0.8, 0.3), sdf.difference(ball, box), sdf.shell(ball, 0.1), "
        "sdf.union(table.unpack(many)), menger(2), "
        /* a jump, and an estimate that knows nothing of the inside */
        "function(p) return gr.where(gr.length(p) - 0.9, -0.5, gr.length(p) - 0.9) end, "
        "function(p) return max(0.5 * (gr.length(p) - 0.9), 0) - 0.001 end} do "
        "root:add_child(gr.implicit{f = f, " CUBE ", distance = true}) end "
        /* caps on the bounds, and none */
        "root:add_child(gr.implicit{f = sdf.plane({1, 2, 0}, 0.2), " CUBE ", distance = true}) "
        "root:add_child(gr.implicit{f = sdf.plane({1, 2, 0}, 0.2), radius = 1.2, lipschitz = 1}) "
        "root:add_child(gr.implicit{f = sdf.plane({1, 2, 0}, 0.2), radius = 1.2, lipschitz = 1, open = true}) "
        "root:add_child(gr.implicit{f = function(p) return 5 * (gr.length(p * gr.vec(1, 2, 3)) - 1) end, " CUBE
        ", lipschitz = 15})" END,
        search_together, said, sizeof said);
    CHECK_TEXT(said, "");
}

TEST(lines_are_inside_of_folded_fractals_where_their_distance_is_below_zero) {
    char said[8192];
    see_solids(
        BEGIN MENGER
        "root:add_child(gr.implicit{f = menger(2), " CUBE ", distance = true}) "
        "root:add_child(gr.implicit{f = menger(4), " CUBE ", lipschitz = 1}) "
        /* a tetrahedron of Sierpinski, by reflections; with a loop, which is not unrolled */
        "root:add_child(gr.implicit{f = function(p) local k, x, y, z = gr.loop(12, 1, p.x, p.y, p.z, function(i, _, x, "
        "y, z) x, y = max(x, -y), max(y, -x) x, z = max(x, -z), max(z, -x) y, z = max(y, -z), max(z, -y) "
        "return 1, 2 * x - 1, 2 * y - 1, 2 * z - 1 end) "
        "return (sqrt(x * x + y * y + z * z) - 2) / 2 ^ 12 end, " CUBE ", distance = true})" END,
        check_sides, said, sizeof said);
    CHECK_TEXT(said, "");
    CHECK(crossings > 1000 && samples > 10000);
    CHECK_EQ_INT(wrong_samples, 0);
}

TEST(estimates_of_the_distance_of_escaping_points_show_their_sets) {
    char said[8192];
    see_solids(
        BEGIN
        "local function bulb(p) local x, y, z, r, d = p.x, p.y, p.z, 0.0, 1.0 for i = 1, 4 do "
        "r = sqrt(x * x + y * y + z * z) if r > 2 then break end local a, b, q = 8 * math.acos(z / r), "
        "8 * math.atan(y, x), r ^ 7 d = 8 * q * d + 1 q = q * r x, y, z = q * math.sin(a) * math.cos(b) + p.x, "
        "q * math.sin(a) * math.sin(b) + p.y, q * math.cos(a) + p.z end return 0.5 * math.log(r) * r / d - 0.002 end "
        "root:add_child(gr.implicit{f = bulb, " CUBE ", lipschitz = 4}) "
        "local function julia(p) local x, y, z, w, d, r = p.x, p.y, p.z, 0.0, 1.0, 0.0 for i = 1, 8 do "
        "d = 2 * sqrt(x * x + y * y + z * z + w * w) * d x, y, z, w = x * x - y * y - z * z - w * w - 0.2, "
        "2 * x * y + 0.8, 2 * x * z, 2 * x * w end r = sqrt(x * x + y * y + z * z + w * w) "
        "return 0.5 * math.log(r) * r / d - 0.002 end "
        "root:add_child(gr.implicit{f = julia, " CUBE ", lipschitz = 4}) " END,
        check_sides, said, sizeof said);
    CHECK(crossings > 100 && samples > 5000);
    CHECK(wrong_samples < samples / 1000);
}

/* --- reports --- */

/* Runs `text` with the solid, and checks that a message has the words. */
static void reports(const char *fields, const char *words) {
    char text[2048];
    struct listener listener = {.renders = 0};
    struct error error;
    (void)snprintf(text, sizeof text, "gr.implicit{%s}", fields);
    bool done = listen_to_text(&listener, text, NULL, &error);
    const char *said = done ? listener.said : error.text;
    if (words ? !strstr(said, words) : said[0] != '\0')
        test_fail(__FILE__, __LINE__, "%s: %s", fields, said);
}

TEST(bounds_of_slopes_and_distances_that_do_not_hold_are_reported_with_a_point) {
    reports("f = function(p) return 3 * gr.length(p) - 1 end, radius = 1, lipschitz = 3.0001", NULL);
    reports("f = function(p) return 3 * gr.length(p) - 1 end, radius = 1, lipschitz = 2",
            "the slope of f is above lipschitz = 2 at ");
    reports("f = function(p) return 3 * gr.length(p) - 1 end, radius = 1, lipschitz = 2", "(3 at {");
    reports("f = function(p) return gr.length(p) - 0.5 end, radius = 1, distance = true", NULL);
    reports("f = function(p) return (gr.length(p) - 0.5) * 1.3 end, radius = 1, distance = true",
            "|f| is above the distance to the surface at ");
    /* steep, but not above the distance, far from the surface */
    reports("f = function(p) local d = gr.length(p) - 0.5 return d * (1 - 0.5 * math.sin(40 * d) ^ 2) end, radius = 1, "
            "distance = true",
            NULL);
    reports("f = function(p) return gr.length(p) + 0.1 end, radius = 1, distance = true",
            "f is negative at none of the points that were examined");
    reports("f = function(p) return gr.length(p) end, radius = 1, distance = true, lipschitz = 2",
            "lipschitz and distance exclude each other");
}

/* The second solid is as slow; the third has the value. */
TEST(slow_solids_are_warned_of_with_a_lipschitz_bound_that_their_slopes_support_once_in_a_script) {
    static const char scene[] =
        "local function rough(bound) gr.implicit{radius = 1, lipschitz = bound, f = function(p)\n"
        "  return gr.length(p) - .8 + .1 * gr.noise(p * 8) + .05 * gr.noise(p * 16) + "
        ".025 * gr.noise(p * 32) end} end\n"
        "rough() rough() rough(4.6)\n";
    struct test_result result = test_gray_scene(scene, "--check scene.lua", NULL);
    const char *said = strstr(result.err, "scene.lua:1: warning: gr.implicit: rays need ");
    unsigned before = 0, after = 0, points = 0;
    double bound = 0;
    CHECK(said && sscanf(said,
                         "scene.lua:1: warning: gr.implicit: rays need %u operations each, and %u with lipschitz = "
                         "%lf, which the slopes of f at %u points support",
                         &before, &after, &bound, &points) == 4);
    CHECK(2 * after < before && points > 1900 && points <= 2000 && bound > 3 && bound < 6);
    CHECK(said && !strstr(strchr(said, '\n'), "warning"));
    test_free_result(&result);
}

TEST(fractals_without_a_declared_bound_are_refused_with_advice) {
    reports("f = function(p) local x, y, z = p.x, p.y, p.z for i = 1, 10 do x, y, z = x * x - y * y - z * z - 0.2, "
            "2 * x * y + 0.8, 2 * x * z end return x * x + y * y + z * z - 4 end, radius = 1.5",
            "the bounds of f are too wide to find its surface in reasonable time, as of fractals: declare distance = "
            "true if |f| is at most the distance to the surface, or lipschitz = L");
}
