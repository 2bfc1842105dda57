/* The order of tiles, the share of work done, drafts, and the files that Ctrl-C leaves. */
#include "tests/harness.h"

#include "base/random.h"
#include "film/film.h"
#include "render/time_estimate.h"
#include "tests/stage.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static struct film film_of(uint32_t width, uint32_t height) {
    return (struct film){.width = width, .height = height, .full_width = width, .full_height = height};
}

TEST(every_order_of_tiles_has_each_tile_once) {
    struct film film = film_of(700, 450);
    uint32_t count = film_tile_count(&film), order[1000];
    CHECK(count == 22 * 15);
    for (int kind = TILE_ORDER_SPREAD; kind <= TILE_ORDER_ROWS; kind++) {
        uint8_t seen[1000] = {0};
        CHECK(film_tile_order(&film, (enum tile_order)kind, order));
        for (uint32_t i = 0; i < count; i++) {
            CHECK(order[i] < count && !seen[order[i]]);
            seen[order[i]] = 1;
            CHECK(kind != TILE_ORDER_ROWS || order[i] == i);
        }
    }
}

TEST(tiles_from_the_centre_come_by_their_distance_from_it) {
    struct film film = film_of(352, 224); /* 11 x 7: one tile is in the middle */
    uint32_t order[77];
    CHECK(film_tile_order(&film, TILE_ORDER_CENTRE, order));
    CHECK_EQ_INT(order[0], 3 * 11 + 5);
    double before = 0;
    for (int i = 0; i < 77; i++) {
        double dx = ((double)(order[i] % 11) - 5) / 11, dy = ((double)(order[i] / 11) - 3) / 7;
        CHECK(dx * dx + dy * dy >= before - 1e-6);
        before = dx * dx + dy * dy;
    }
}

/* The share done of any rectangle of tiles equals that of the whole picture, within a few tiles. */
TEST(spread_tiles_represent_the_others_at_any_time) {
    struct film film = film_of(32 * 30, 32 * 20);
    uint32_t order[600];
    double worst = 0;
    CHECK(film_tile_order(&film, TILE_ORDER_SPREAD, order));
    for (int done = 50; done < 600; done += 50) {
        for (int part = 0; part < 4; part++) {
            int inside = 0;
            for (int i = 0; i < done; i++)
                inside += (int)(order[i] % 30 / 15) + 2 * (int)(order[i] / 30 / 10) == part;
            worst = fmax(worst, fabs(inside - done / 4.0));
        }
    }
    CHECK(worst < 12);
}

TEST(the_order_of_tiles_changes_no_byte) {
    float reference[100 * 80 * 3];
    struct stage s;
    stage_begin(&s, 3);
    stage_sphere(&s, s.root, stage_glass(&s, 0.3, 0.6, 1.4));
    stage_point_light(&s, vec3_make(3, 4, 5), colour_all(0.8));
    s.sky = (struct sky){.kind = SKY_GRADIENT};
    for (int kind = TILE_ORDER_SPREAD; kind <= TILE_ORDER_ROWS; kind++) {
        s.settings.tile_order = (enum tile_order)kind;
        CHECK(stage_render(&s, 100, 80));
        for (int i = 0; i < 100 * 80; i++) {
            if (kind == TILE_ORDER_SPREAD)
                memcpy(reference + 3 * i, s.film.pixels[i].rgb, 12);
            CHECK(memcmp(reference + 3 * i, s.film.pixels[i].rgb, 12) == 0);
        }
    }
    stage_end(&s);
}

/* A job with its own film, with or without a thread that polls its progress. */
static bool run_job(struct stage *s, struct film *film, struct progress_estimate *progress_estimate,
                    const _Atomic int *drain, struct render_statistics *statistics) {
    struct render_job job = {.world = &s->world,
                             .camera = s->camera,
                             .settings = s->settings,
                             .width = film->width,
                             .height = film->height,
                             .ambient = colour_all(0.3),
                             .film = film,
                             .progress_estimate = progress_estimate,
                             .drain = drain};
    return render_run(&job, s->pool, statistics, &s->error);
}

TEST(what_is_foretold_is_done_in_the_end_and_counts_for_nothing) {
    struct stage s;
    struct render_statistics plain = {0}, asked = {0};
    struct progress_estimate progress_estimate = {0};
    stage_begin(&s, 2);
    stage_sphere(&s, s.root, stage_glass(&s, 0.3, 0.6, 1.4));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    size_t bytes;
    CHECK(film_size(200, 150, stage_record(INTEGRATOR_WHITTED), &bytes, &s.error));
    void *blocks[2] = {calloc(1, bytes), calloc(1, bytes)};
    struct film films[2] = {film_of(200, 150), film_of(200, 150)};
    for (int i = 0; i < 2; i++)
        film_layout(&films[i], blocks[i], 200, 150, stage_record(INTEGRATOR_WHITTED));
    CHECK(progress_estimate_share(&progress_estimate) < 0 && progress_estimate_left(&progress_estimate, 1) < 0);
    CHECK(run_job(&s, &films[0], NULL, NULL, &plain));
    CHECK(run_job(&s, &films[1], &progress_estimate, NULL, &asked));
    CHECK(progress_estimate_share(&progress_estimate) == 1);
    CHECK(progress_estimate_left(&progress_estimate, 1e9) == 0);
    CHECK(memcmp(films[0].pixels, films[1].pixels, (size_t)200 * 150 * film_record_size(films[0].record)) == 0);
    CHECK_EQ_INT(plain.camera_rays, asked.camera_rays);
    CHECK_EQ_INT(plain.refracted_rays, asked.refracted_rays);
    CHECK_EQ_INT(plain.shape_tests, asked.shape_tests);
    CHECK_EQ_INT(plain.hierarchy_steps, asked.hierarchy_steps);
    free(blocks[0]);
    free(blocks[1]);
    stage_end(&s);
}

TEST(the_time_left_is_the_time_so_far_over_the_work_that_is_missing) {
    struct progress_estimate progress_estimate;
    progress_estimate_reset(&progress_estimate, true);
    CHECK(progress_estimate.wanted);
    CHECK(progress_estimate_share(&progress_estimate) < 0 && progress_estimate_left(&progress_estimate, 7) < 0);
    progress_estimate.begun = 5;
    progress_estimate_report(&progress_estimate, 0, 1, 5);
    CHECK(progress_estimate_share(&progress_estimate) == 0 && progress_estimate_left(&progress_estimate, 7) < 0);
    progress_estimate_report(&progress_estimate, 25, 75, 7);
    CHECK_NEAR(progress_estimate_share(&progress_estimate), 0.25, 1e-8);
    CHECK_NEAR(progress_estimate_left(&progress_estimate, 7), 6, 1e-6);
    CHECK_NEAR(progress_estimate_left(&progress_estimate, 9.5), 3.5, 1e-6); /* it falls with the clock */
    CHECK_NEAR(progress_estimate_left(&progress_estimate, 20), 0, 0);
    progress_estimate_report(&progress_estimate, 20, 80, 7); /* the share never decreases; the time left may grow */
    CHECK_NEAR(progress_estimate_share(&progress_estimate), 0.25, 1e-8);
    CHECK_NEAR(progress_estimate_left(&progress_estimate, 7), 8, 1e-6);
    progress_estimate_reset(&progress_estimate, false);
    CHECK(!progress_estimate.wanted && progress_estimate_left(&progress_estimate, 7) < 0);
}

/* --- the time left --- */

enum { ACROSS = 20, TILES = 200 };
static struct tile_cost costs[TILES];

static struct time_estimate new_estimate(uint32_t count, int waiting) {
    memset(costs, 0, sizeof costs);
    for (uint32_t tile = 0; tile < count; tile++)
        costs[tile].pixels = 1024;
    return (struct time_estimate){count, count < ACROSS ? count : ACROSS, costs, waiting};
}

static void set_tile(uint32_t tile, double cost, double part) {
    costs[tile].cost = (uint64_t)cost;
    costs[tile].part = (uint32_t)(part * TILE_COST_WHOLE);
}

/* A picture of 20 x 10 tiles whose left half costs ten times as much as the right one, and each tile up to a third more
 * or less than others. */
TEST(the_cost_of_tiles_is_that_of_finished_ones_if_these_are_spread_over_the_picture) {
    struct film film = film_of(ACROSS * 32, TILES / ACROSS * 32);
    struct time_estimate estimate = new_estimate(TILES, 1);
    uint32_t spread[TILES];
    double left = 0, cost[TILES];
    for (uint32_t i = 0; i < TILES; i++) {
        double scatter = 1 + (2 * random_unit(random_combine(7, i)) - 1) / 3;
        left += cost[i] = (i % ACROSS < ACROSS / 2 ? 1e6 : 1e5) * scatter;
    }
    CHECK(film_tile_order(&film, TILE_ORDER_SPREAD, spread));
    CHECK_NEAR(time_estimate_work(&estimate).done, 0, 0);
    for (int i = 0; i < TILES; i++) {
        set_tile(spread[i], cost[spread[i]], 1);
        left -= cost[spread[i]];
        double error = fabs(time_estimate_work(&estimate).left - left);
        CHECK(i < TILES / 3 || i > TILES * 95 / 100 || error < 0.2 * left);
    }
    CHECK_NEAR(time_estimate_work(&estimate).left, 0, 1);
}

TEST(a_tile_in_progress_costs_as_much_as_before_for_the_same_part) {
    struct time_estimate estimate = new_estimate(3, 1);
    set_tile(0, 1000, 0.25);
    set_tile(2, 600, 0.75);
    struct time_estimate_work work = time_estimate_work(&estimate);
    CHECK_NEAR(work.done, 1600, 1e-9);
    CHECK_NEAR(work.left, 3000 + 200 + 1600, 1e-3); /* the tile between them is an average one */
    costs[1].pixels = 0;                            /* of another shard */
    CHECK_NEAR(time_estimate_work(&estimate).left, 3000 + 200, 1e-3);
}

TEST(workers_that_wait_for_the_longest_tile_count) {
    struct time_estimate estimate = new_estimate(4, 3);
    for (uint32_t tile = 0; tile < 3; tile++)
        set_tile(tile, 1000, 1);
    set_tile(3, 500, 0.5);
    CHECK_NEAR(time_estimate_work(&estimate).left, 3 * 500, 1e-3);
}

/* Tiles in progress are finished, others are not started. */
static void stop_soon(void *context, uint32_t tile, uint32_t done, uint32_t count) {
    (void)tile, (void)count;
    if (done == 3)
        atomic_store((_Atomic int *)context, 1);
}

TEST(enough_tiles_end_a_render_with_whole_tiles) {
    struct stage s;
    _Atomic int drain = 0;
    struct render_statistics statistics = {0};
    stage_begin(&s, 1);
    stage_sphere(&s, s.root, stage_glass(&s, 0.3, 0.6, 1.4));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    size_t bytes;
    CHECK(film_size(200, 150, stage_record(INTEGRATOR_WHITTED), &bytes, &s.error));
    void *block = calloc(1, bytes);
    struct film film = film_of(200, 150);
    film_layout(&film, block, 200, 150, stage_record(INTEGRATOR_WHITTED));
    struct render_job job = {.world = &s.world,
                             .camera = s.camera,
                             .settings = s.settings,
                             .width = 200,
                             .height = 150,
                             .film = &film,
                             .drain = &drain,
                             .tile_done = stop_soon,
                             .context = &drain};
    CHECK(!render_run(&job, s.pool, &statistics, &s.error));
    CHECK_EQ_INT(s.error.kind, ERROR_CANCELLED);
    CHECK_EQ_INT(film_tiles_in(&film, FILM_TILE_DONE), 3);
    CHECK_EQ_INT(film_tiles_in(&film, FILM_TILE_WANTED), film_tile_count(&film) - 3);
    for (int i = 0; i < 200 * 150; i++)
        film.pixels[i].rgb[0] = 7;
    film_clear_unfinished(&film);
    for (uint32_t y = 0; y < 150; y++)
        for (uint32_t x = 0; x < 200; x++) {
            bool done = atomic_load(&film.tiles[y / 32 * film_tiles_across(&film) + x / 32]) == FILM_TILE_DONE;
            CHECK(film.pixels[y * 200 + x].rgb[0] == (done ? 7.0f : 0.0f));
        }
    free(block);
    stage_end(&s);
}

/* --- drafts --- */

static const char mirrors[] =
    "local r = gr.node('root')\n"
    "local m = gr.rr_material({0.1, 0.1, 0.1}, {1, 1, 1}, 50, 0.8, 0, 1)\n"
    "for i = -1, 1 do local s = gr.geometry('s' .. i, gr.sphere(m)) s:translate(2 * i, 0, 0) r:add_child(s) end\n"
    "gr.render(r, 'out.png', 130, 71, {0, 0, 9}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2},\n"
    "  {gr.area_light({-1, 5, 5}, {2, 0, 0}, {0, 0, 2}, {0.8, 0.8, 0.8}, {1, 0, 0})})\n";

static double number_of(const char *json, const char *name) {
    const char *at = strstr(json, name);
    if (!at)
        test_fail(__FILE__, __LINE__, "no %s in: %s", name, json);
    return at ? strtod(at + strlen(name), NULL) : -1;
}

static struct test_result statistics_of(const char *arguments) {
    struct test_result result = test_gray_scene(mirrors, arguments, NULL);
    CHECK_EQ_INT(result.status, 0);
    return result;
}

static void release(struct test_result result) {
    test_free_result(&result);
}

TEST(a_preview_is_a_quarter_of_the_size_with_one_sample_and_no_secondary_rays) {
    struct test_result result = statistics_of("--preview -full -ss 4 -reflect-limit 9 --stats=json scene.lua");
    CHECK_EQ_INT(number_of(result.out, "\"width\":"), 33);
    CHECK_EQ_INT(number_of(result.out, "\"height\":"), 18);
    CHECK_EQ_INT(number_of(result.out, "\"reflected_rays\":"), 0);
    CHECK_EQ_INT(number_of(result.out, "\"marked_pixels\":"), 0);
    release(result);
    result = statistics_of("--preview --size 50x40 --stats=json scene.lua");
    CHECK_EQ_INT(number_of(result.out, "\"width\":"), 50);
    release(result);
}

TEST(a_quick_picture_has_its_size_and_one_sample_a_pixel) {
    struct test_result result = statistics_of("--quick -full -ss 4 --stats=json scene.lua");
    CHECK_EQ_INT(number_of(result.out, "\"width\":"), 130);
    CHECK(number_of(result.out, "\"reflected_rays\":") > 0);
    CHECK_EQ_INT(number_of(result.out, "\"marked_pixels\":"), 0);
    release(result);
}

/* --- messages --- */

TEST(progress_as_json_has_the_share_of_the_work_and_the_time_left) {
    struct test_result result =
        test_gray_scene(mirrors, "--progress=json --size 700x400 -al-samples 8 -j 1 -reflect-limit 6 scene.lua", NULL);
    double before = 0;
    int lines = 0;
    CHECK_EQ_INT(result.status, 0);
    for (const char *at = result.err; (at = strstr(at, "\"share\":")); at++) {
        double share = strtod(at + 8, NULL);
        CHECK(share >= before && share <= 1);
        before = share;
        lines++;
    }
    if (lines > 1)
        CHECK(strstr(result.err, "\"left\":"));
    CHECK(strstr(result.err, "\"event\":\"written\""));
    CHECK(strstr(result.err, "\"processor\":"));
    release(result);
}

/* The clock of a busy machine may jump between two lines: the end does not. */
TEST(with_a_time_limit_the_time_left_is_that_of_the_limit) {
    struct test_result result = test_gray_scene(
        mirrors, "--progress=json --integrator path --time-limit 1.2 --size 300x200 -j 1 --denoise=none scene.lua",
        NULL);
    double first = 0;
    CHECK_EQ_INT(result.status, 0);
    for (char *line = strtok(result.err, "\n"); line; line = strtok(NULL, "\n")) {
        double left = strstr(line, "\"left\":") ? number_of(line, "\"left\":") : 0;
        if (left < 0.1)
            continue;
        double ends = number_of(line, "\"seconds\":") + left;
        first = first > 0 ? first : ends;
        CHECK_NEAR(ends, first, 0.01);
    }
    CHECK(first > 1.2);
    release(result);
}
