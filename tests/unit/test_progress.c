/* The order of tiles, the share of work done, drafts, and the files that Ctrl-C leaves. */
#include "tests/harness.h"

#include "base/clock.h"
#include "base/random.h"
#include "film/film.h"
#include "output/picture_shown_internal.h"
#include "render/noise_estimate_internal.h"
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
    for (int kind = ORDER_SPREAD; kind <= ORDER_ROWS; kind++) {
        uint8_t seen[1000] = {0};
        CHECK(tile_order(&film, (enum order)kind, order));
        for (uint32_t i = 0; i < count; i++) {
            CHECK(order[i] < count && !seen[order[i]]);
            seen[order[i]] = 1;
            CHECK(kind != ORDER_ROWS || order[i] == i);
        }
    }
}

TEST(tiles_from_the_centre_come_by_their_distance_from_it) {
    struct film film = film_of(352, 224); /* 11 x 7: one tile is in the middle */
    uint32_t order[77];
    CHECK(tile_order(&film, ORDER_CENTRE, order));
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
    CHECK(tile_order(&film, ORDER_SPREAD, order));
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
    stage_point_light(&s, vec3_make(3, 4, 5), vec3_all(0.8));
    s.sky = (struct sky){.kind = SKY_GRADIENT};
    for (int kind = ORDER_SPREAD; kind <= ORDER_ROWS; kind++) {
        s.settings.order = (enum order)kind;
        CHECK(stage_render(&s, 100, 80));
        for (int i = 0; i < 100 * 80; i++) {
            if (kind == ORDER_SPREAD)
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
                             .ambient = vec3_all(0.3),
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
    const uint64_t second = 1000000000;
    progress_estimate_reset(&progress_estimate, true);
    CHECK(progress_estimate_is_wanted(&progress_estimate));
    CHECK(progress_estimate_share(&progress_estimate) < 0 && progress_estimate_left(&progress_estimate, 7) < 0);
    atomic_store(&progress_estimate.begun, 5 * second);
    progress_estimate_report(&progress_estimate, 0, 1, 5 * second);
    CHECK(progress_estimate_share(&progress_estimate) == 0 && progress_estimate_left(&progress_estimate, 7) < 0);
    progress_estimate_report(&progress_estimate, 25, 75, 7 * second);
    CHECK_NEAR(progress_estimate_share(&progress_estimate), 0.25, 1e-8);
    CHECK_NEAR(progress_estimate_left(&progress_estimate, 7), 6, 1e-6);
    CHECK_NEAR(progress_estimate_left(&progress_estimate, 9.5), 3.5, 1e-6); /* it falls with the clock */
    CHECK_NEAR(progress_estimate_left(&progress_estimate, 20), 0, 0);
    progress_estimate_report(&progress_estimate, 20, 80,
                             7 * second); /* the share never decreases; the time left may grow */
    CHECK_NEAR(progress_estimate_share(&progress_estimate), 0.25, 1e-8);
    CHECK_NEAR(progress_estimate_left(&progress_estimate, 7), 8, 1e-6);
    progress_estimate_reset(&progress_estimate, false);
    CHECK(!progress_estimate_is_wanted(&progress_estimate) && progress_estimate_left(&progress_estimate, 7) < 0);
}

/* A picture of 20 x 10 tiles whose left half costs ten times as much as the right one, rendered row by row or column by
 * column. The rays of the pre-pass estimate costs exactly, not at all, or with errors of up to half per tile. */
static double cost_of(uint32_t tile) {
    return tile % 20 < 10 ? 1000 : 100;
}

static double scatter(uint32_t tile, double width) {
    return 1 + width * (2 * random_unit(random_combine(7, tile)) - 1);
}

static void sample_halves(struct time_estimate *time_estimate, double reported, double width) {
    for (uint32_t tile = 0; tile < 200; tile++)
        time_estimate_probe(time_estimate, tile, 1024,
                            (reported * cost_of(tile) + (1 - reported) * 500) * 0.01 * scatter(tile, width), 0.1);
    time_estimate_begin_tiles(time_estimate, false);
}

/* The largest relative error of the time left, from `from` tiles on until `until`. */
static double worst_error(struct time_estimate *time_estimate, const uint32_t *order, int from, int until) {
    double left = 0, done = 0, worst = 0;
    for (int i = 0; i < 200; i++)
        left += cost_of(order[i]);
    for (int i = 0; i < until; i++) {
        time_estimate_begin(time_estimate, i % time_estimate->workers, order[i], 1);
        time_estimate_done(time_estimate, i % time_estimate->workers, cost_of(order[i]), 0.3 * cost_of(order[i]));
        left -= cost_of(order[i]);
        done += cost_of(order[i]);
        struct time_estimate_work work = time_estimate_work(time_estimate, NULL);
        if (i + 1 >= from)
            worst = fmax(worst, fabs(done * work.left / work.done - left) / left);
    }
    return worst;
}

TEST(time_estimate_of_a_picture_whose_left_half_costs_ten_times_the_right_one) {
    struct film film = film_of(20 * 32, 10 * 32);
    struct time_estimate time_estimate;
    uint32_t rows[200], columns[200], spread[200];
    for (uint32_t i = 0; i < 200; i++) {
        rows[i] = i;
        columns[i] = i % 10 * 20 + i / 10;
    }
    CHECK(tile_order(&film, ORDER_SPREAD, spread));
    /* Exact rays: good estimates from the first tiles on, with any number of workers. Column by column all expensive
     * tiles come first, and the estimates for cheap ones are not tested. */
    for (int workers = 1; workers <= 3; workers++) {
        const uint32_t *orders[3] = {rows, columns, spread};
        for (int i = 0; i < 3; i++) {
            CHECK(time_estimate_create(&time_estimate, 200, 20, workers));
            sample_halves(&time_estimate, 1, 0);
            CHECK(worst_error(&time_estimate, orders[i], 10, 199) < (i == 1 ? 1 : 0.1));
            time_estimate_destroy(&time_estimate);
        }
    }
    /* Rays without information: tiles spread over the picture represent the others. */
    CHECK(time_estimate_create(&time_estimate, 200, 20, 2));
    sample_halves(&time_estimate, 0, 0);
    CHECK(worst_error(&time_estimate, spread, 66, 180) < 0.2);
    time_estimate_destroy(&time_estimate);
    /* Half of each: the model learns the costs that the rays do not show. */
    CHECK(time_estimate_create(&time_estimate, 200, 20, 2));
    sample_halves(&time_estimate, 0.5, 0);
    CHECK(worst_error(&time_estimate, spread, 66, 190) < 0.1);
    time_estimate_destroy(&time_estimate);
    /* Each tile's rays wrong by up to half. */
    CHECK(time_estimate_create(&time_estimate, 200, 20, 2));
    sample_halves(&time_estimate, 1, 0.5);
    CHECK(worst_error(&time_estimate, spread, 66, 180) < 0.15);
    time_estimate_destroy(&time_estimate);
}

/* A cost that rays cannot measure: tiles cost only by their edges. */
TEST(time_estimate_learns_what_edges_cost) {
    struct time_estimate time_estimate;
    double left = 0, done = 0;
    CHECK(time_estimate_create(&time_estimate, 400, 20, 1));
    for (uint32_t tile = 0; tile < 400; tile++) {
        double edges = tile % 7 == 0 ? 0.8 : 0.05;
        time_estimate_probe(&time_estimate, tile, 1024, 10, edges);
        left += 1 + 20 * edges;
    }
    time_estimate_begin_tiles(&time_estimate, false);
    for (uint32_t tile = 0; tile < 390; tile++) { /* in rows of 20 */
        double cost = 1 + 20 * (tile % 7 == 0 ? 0.8 : 0.05);
        time_estimate_begin(&time_estimate, 0, tile, 1);
        time_estimate_done(&time_estimate, 0, cost, 1);
        left -= cost;
        done += cost;
        struct time_estimate_work work = time_estimate_work(&time_estimate, NULL);
        CHECK(tile < 130 || fabs(done * work.left / work.done - left) < 0.05 * left);
    }
    time_estimate_destroy(&time_estimate);
}

/* With --noise: rays of equal cost, but the tiles of a corner need up to 64 times as many samples. They come last, and
 * what a few samples say of each is wrong by up to half. */
TEST(tiles_that_need_more_samples_are_expected_to_cost_more) {
    struct time_estimate time_estimate;
    double left = 0, done = 0;
    CHECK(time_estimate_create(&time_estimate, 400, 20, 1));
    for (uint32_t tile = 0; tile < 400; tile++) {
        double samples = tile % 20 + tile / 20 > 28 ? 1024 : 16;
        time_estimate_probe(&time_estimate, tile, 1024, 10, samples * scatter(tile, 0.5));
        left += samples;
    }
    time_estimate_begin_tiles(&time_estimate, true);
    for (uint32_t tile = 0; tile < 360; tile++) {
        double samples = tile % 20 + tile / 20 > 28 ? 1024 : 16;
        time_estimate_begin(&time_estimate, 0, tile, 1);
        time_estimate_done(&time_estimate, 0, samples, 0);
        left -= samples;
        done += samples;
        struct time_estimate_work work = time_estimate_work(&time_estimate, NULL);
        CHECK(done < left / 2 || fabs(done * work.left / work.done - left) < 0.2 * left);
    }
    time_estimate_destroy(&time_estimate);
}

TEST(time_estimate_counts_unfinished_tiles_and_those_of_others) {
    struct film film = film_of(4 * 32, 32);
    size_t bytes;
    struct error error;
    struct time_estimate time_estimate;
    CHECK(film_size(128, 32, stage_record(INTEGRATOR_WHITTED), &bytes, &error));
    void *block = calloc(1, bytes);
    film_layout(&film, block, 128, 32, stage_record(INTEGRATOR_WHITTED));
    CHECK(time_estimate_create(&time_estimate, 4, 4, 1));
    for (uint32_t tile = 0; tile < 4; tile++)
        time_estimate_probe(&time_estimate, tile, 1024, 10, 0);
    time_estimate_begin_tiles(&time_estimate, false);
    for (int quarter = 0; quarter < 4; quarter++) {
        time_estimate_begin(&time_estimate, 0, 0, 0.25);
        time_estimate_done(&time_estimate, 0, 25, 10);
    }
    struct time_estimate_work work = time_estimate_work(&time_estimate, NULL);
    CHECK_NEAR(work.left / work.done, 3, 1e-6);
    time_estimate_begin(&time_estimate, 0, 1, 1);
    time_estimate_part(&time_estimate, 0, 0,
                       1); /* all of the first pass, which is 0.4 of a tile, and half of the second */
    time_estimate_part(&time_estimate, 0, 1, 0.5);
    work = time_estimate_work(&time_estimate, NULL);
    CHECK_NEAR(work.left / work.done, (4 - 1.7) / 1.7, 1e-6);
    atomic_store(&film.tiles[0], FILM_TILE_DONE);
    atomic_store(&film.tiles[3], FILM_TILE_DONE); /* made elsewhere */
    work = time_estimate_work(&time_estimate, &film);
    CHECK_NEAR(work.left / work.done, (4 - 2.7) / 2.7, 1e-6);
    time_estimate_destroy(&time_estimate);
    free(block);
}

/* --- tiles that get their samples level by level --- */

/* A tile whose number of samples grows by `growth` (natural logarithm) from 16 samples to 32, and by three quarters of
 * the growth before in each further doubling. */
static double needed_after(double needed, double growth, uint32_t samples) {
    return needed * exp(growth * 4 * (1 - pow(0.75, log2(samples / 16.0))));
}

/* The number of samples at which it is quiet. */
static uint32_t end_of(double needed, double growth, uint32_t limit) {
    uint32_t samples = 16;
    while (samples < limit && needed_after(needed, growth, samples) > samples)
        samples = noise_next_level(samples, limit);
    return samples;
}

static const struct noise_limits many_samples = {16, 4096};

static struct noise_history history_of(double needed, double growth, uint32_t samples, double concentration) {
    struct noise_history history = {0};
    for (uint32_t n = 2; n <= samples; n = noise_next_level(n, 4096)) {
        struct noise_point point = {
            .samples = n, .needed = needed_after(needed, growth, n), .concentration = concentration};
        noise_history_add(&history, &point);
    }
    return history;
}

TEST(a_tile_needs_more_samples_if_those_that_it_needed_so_far_grew) {
    struct noise_history same = history_of(100, 0, 16, 0.05), grows = history_of(100, 0.4, 16, 0.05),
                         falls = history_of(100, -0.2, 16, 0.05);
    struct noise_limits forty = {16, 40};
    double further = noise_further_samples(&same, 0, many_samples).samples;
    CHECK(further > 96 - 16 && further < 128 - 16);
    CHECK(noise_further_samples(&grows, 0, many_samples).samples > 1.1 * further);
    CHECK(noise_further_samples(&falls, 0, many_samples).samples < 0.9 * further);
    CHECK_NEAR(noise_further_samples(&same, 0, forty).samples, 24, 1); /* no tile gets more than the limit */
    CHECK_EQ_INT(noise_next_level(0, 9), 2);
    CHECK_EQ_INT(noise_next_level(8, 9), 9);
    CHECK_EQ_INT(noise_next_level(16, 4096), 24);
}

TEST(the_further_samples_of_a_tile_are_less_certain_if_its_noise_is_that_of_few_pixels_or_changes) {
    struct noise_history same = history_of(100, 0, 16, 0.05), few = history_of(100, 0, 16, 0.7),
                         grows = history_of(100, 0.4, 16, 0.05), late = history_of(100, 0, 64, 0.05);
    double deviation = noise_further_samples(&same, 0, many_samples).deviation;
    CHECK(noise_further_samples(&few, 0, many_samples).deviation > 3 * deviation);
    CHECK(noise_further_samples(&grows, 0, many_samples).deviation > 1.5 * deviation);
    CHECK(noise_further_samples(&late, 0, many_samples).deviation < deviation);
}

/* One path in a dark tile: after 8 samples the noise says 2,169, although 48 are enough. */
TEST(one_bright_path_in_a_dark_tile_does_not_make_the_tile_need_what_its_noise_says) {
    struct noise_point before = {.samples = 4, .needed = 4, .rare = 0.6, .settled = -0.6, .concentration = 0.22},
                       now = {.samples = 8, .needed = 2169, .rare = 6.2, .settled = 0, .concentration = 0.7};
    struct noise_history history = {0};
    noise_history_add(&history, &before);
    noise_history_add(&history, &now);
    CHECK(noise_further_samples(&history, 0, many_samples).samples < 2169 / 2.0);
    CHECK(noise_further_samples(&history, 0, many_samples).deviation > 200);
}

/* --noise .03 asks for 42 samples. */
TEST(tiles_without_noise_are_expected_to_end_at_the_minimum_of_samples) {
    struct noise_history none = history_of(0, 0, 16, 0);
    struct noise_limits limits = noise_limits_for(0.03, 4096);
    CHECK_EQ_INT(limits.minimum, 42);
    CHECK_NEAR(noise_further_samples(&none, 0, limits).samples, 48 - 16, 1e-6);
    CHECK_EQ_INT(noise_limits_for(0, 7).minimum, 0);
}

/* The tile with the largest urgency, as in render/sample_levels.c; -1: all are final. */
static int urgent_tile(const struct noise_estimate *estimate, const uint32_t *samples, const uint32_t *last) {
    int first = -1;
    for (int i = 0; i < (int)estimate->count; i++) {
        if (samples[i] < last[i] && (first < 0 || noise_estimate_urgency(estimate, (uint32_t)i) >
                                                      noise_estimate_urgency(estimate, (uint32_t)first)))
            first = i;
    }
    return first;
}

/* Levels of all tiles, with tiles of one noise, tiles with caustics that few samples do not find, and quiet ones. The
 * growth of a third of the tiles, .3, gives .09 for each of the first two doublings in the mean of the picture;
 * recorded pictures have -.4 to .2. Each estimate of the noise is wrong by up to `width`. The largest relative error of
 * the time left, from a third of the whole on until 1 % is left. */
static double worst_error_of_levels(int count, double width, uint32_t limit, int workers) {
    struct noise_estimate estimate;
    double needed[400], growth[400], all = 0, done = 0, worst = 0;
    uint32_t samples[400] = {0}, ends[400];
    CHECK(noise_estimate_create(&estimate, (uint32_t)count, (struct noise_limits){16, limit}, workers));
    for (int i = 0; i < count; i++) {
        needed[i] = i % 4 == 0 ? 4 : 30 * scatter((uint32_t)i, 0.9);
        growth[i] = i % 3 == 0 ? 0.3 : 0;
        ends[i] = end_of(needed[i], growth[i], limit);
        all += ends[i];
        noise_estimate_expect(&estimate, (uint32_t)i, 1024, 0);
    }
    for (int step = 0, next = 0; (next = urgent_tile(&estimate, samples, ends)) >= 0; step++) {
        uint32_t i = (uint32_t)next, end = noise_next_level(samples[i], limit), last = ends[i];
        double now = needed_after(needed[i], growth[i], end), cost = end - samples[i];
        struct noise_point seen = {
            .samples = end, .needed = now * scatter(1000 * i + end, width), .concentration = 0.05};
        struct noise_level level = {seen, cost, end == last};
        noise_estimate_begin(&estimate, step % workers, i, end);
        noise_estimate_done(&estimate, step % workers, i, &level);
        samples[i] = end;
        done += cost;
        struct time_estimate_work work = noise_estimate_work(&estimate);
        if (done > all / 3 && all - done > all / 100)
            worst = fmax(worst, fabs(work.left - (all - done)) / (all - done));
    }
    CHECK_NEAR(done, all, 0);
    CHECK_NEAR(noise_estimate_work(&estimate).left, 0, 1e-6);
    noise_estimate_destroy(&estimate);
    return worst;
}

TEST(the_time_left_of_a_picture_with_noise_is_known_within_a_fifth_from_a_third_on) {
    CHECK(worst_error_of_levels(400, 0.05, 65536, 1) < 0.2);
    CHECK(worst_error_of_levels(400, 0.05, 64, 3) < 0.2);
    CHECK(worst_error_of_levels(130, 0.1, 128, 1) < 0.2);
    CHECK(worst_error_of_levels(35, 0.05, 64, 1) < 0.2);
    /* Only a quarter without a limit of samples, if each estimate of the noise is wrong by up to a tenth. */
    CHECK(worst_error_of_levels(400, 0.1, 65536, 1) < 0.25);
}

TEST(tiles_without_samples_count_as_the_mean_of_the_others_and_workers_wait_for_the_longest) {
    struct noise_estimate estimate;
    CHECK(noise_estimate_create(&estimate, 4, (struct noise_limits){16, 16}, 2));
    for (uint32_t i = 0; i < 3; i++)
        noise_estimate_expect(&estimate, i, 100, 0);
    CHECK_NEAR(noise_estimate_work(&estimate).done, 0, 0);
    struct noise_level level = {{.samples = 2, .needed = 1}, 20, false};
    noise_estimate_done(&estimate, 0, 0, &level);
    struct time_estimate_work work = noise_estimate_work(&estimate); /* 16 samples of each tile */
    CHECK_NEAR(work.done, 20, 1e-9);
    CHECK_NEAR(work.left, 3 * 160 - 20, 1e-9);
    level.point.samples = 1; /* without noise: not known yet */
    noise_estimate_done(&estimate, 1, 1, &level);
    CHECK_NEAR(noise_estimate_work(&estimate).left, 3 * 160 - 20, 1e-9);
    level = (struct noise_level){{.samples = 16, .needed = 1}, 140, true};
    noise_estimate_done(&estimate, 1, 1, &level);
    noise_estimate_done(&estimate, 1, 2, &level);
    CHECK_NEAR(noise_estimate_work(&estimate).left, 140, 1e-9);
    level = (struct noise_level){{.samples = 14, .needed = 1}, 120, false};
    noise_estimate_begin(&estimate, 0, 0, 14);
    noise_estimate_part(&estimate, 0, 0.5);
    CHECK_NEAR(noise_estimate_work(&estimate).left, 80, 1e-9);
    noise_estimate_done(&estimate, 0, 0, &level);
    CHECK_NEAR(noise_estimate_work(&estimate).left, 40, 1e-9); /* 20 for one worker, while the other waits */
    noise_estimate_destroy(&estimate);
}

static void end_pass(struct noise_estimate *estimate, uint32_t tile, uint32_t samples, double cost, bool final) {
    struct noise_level level = {{.samples = samples, .needed = noise_endless}, cost, final};
    noise_estimate_begin(estimate, 0, tile, samples);
    noise_estimate_part(estimate, 0, 0.5);
    noise_estimate_done(estimate, 0, tile, &level);
}

TEST(the_time_left_of_passes_follows_the_cost_of_each_tile_from_the_first_tile_of_the_first_pass) {
    struct noise_estimate estimate;
    CHECK(noise_estimate_create(&estimate, 2, noise_limits_for(0, 7), 1));
    for (uint32_t i = 0; i < 2; i++)
        noise_estimate_expect(&estimate, i, 100, 0);
    end_pass(&estimate, 0, 1, 10, false);
    CHECK_NEAR(noise_estimate_work(&estimate).left, 2 * 70 - 10, 1e-6);
    end_pass(&estimate, 1, 1, 30, false);
    CHECK_NEAR(noise_estimate_work(&estimate).left, 6 * 40, 1e-6);
    end_pass(&estimate, 0, 3, 20, false);
    CHECK_NEAR(noise_estimate_work(&estimate).left, 40 + 180, 1e-6);
    noise_estimate_begin(&estimate, 0, 1, 3); /* a half of a pass counts */
    noise_estimate_part(&estimate, 0, 0.5);
    CHECK_NEAR(noise_estimate_work(&estimate).left, 40 + 150, 1e-6);
    CHECK_NEAR(noise_estimate_work(&estimate).done, 60 + 30, 1e-6);
    end_pass(&estimate, 1, 3, 60, false);
    end_pass(&estimate, 0, 7, 40, true);
    end_pass(&estimate, 1, 7, 120, true);
    CHECK_NEAR(noise_estimate_work(&estimate).left, 0, 1e-6);
    noise_estimate_destroy(&estimate);
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

/* --aov cost traces all samples again. While it does, no further tile is done. */
TEST(the_share_of_the_work_includes_the_layers_after_the_tiles) {
    struct test_result result = test_gray_scene(mirrors,
                                                "--progress=json --integrator path --spp 12 --size 600x500 -j 1 "
                                                "--denoise=none --aov cost scene.lua",
                                                NULL);
    double lowest = 1;
    CHECK_EQ_INT(result.status, 0);
    for (char *line = strtok(result.err, "\n"); line; line = strtok(NULL, "\n")) {
        if (strstr(line, "\"share\":") && number_of(line, "\"tiles_done\":") == number_of(line, "\"tiles\":"))
            lowest = fmin(lowest, number_of(line, "\"share\":"));
    }
    CHECK(lowest > 0.2 && lowest < 0.9);
    release(result);
}

/* Bloom and FXAA of a whole picture, in one thread after the tiles, against what is measured before on a few tiles. */
TEST(the_time_of_finishing_a_picture_is_measured_on_some_of_its_tiles) {
    enum { SIDE = 768 };
    const struct options options = {0};
    struct picture *picture = calloc(1, sizeof *picture);
    struct error error;
    size_t bytes;
    picture->film = film_of(SIDE, SIDE);
    CHECK(film_size(SIDE, SIDE, stage_record(INTEGRATOR_WHITTED), &bytes, &error));
    void *block = calloc(1, bytes);
    film_layout(&picture->film, block, SIDE, SIDE, stage_record(INTEGRATOR_WHITTED));
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        for (int c = 0; c < 3; c++)
            picture->film.pixels[i].rgb[c] = (float)(i % 7 * (i / SIDE % 5)) / 8;
    CHECK(picture_writing_time(&options, picture, 1) < 0); /* no tile is finished */
    for (uint32_t tile = 0; tile < film_tile_count(&picture->film); tile += 2)
        picture->film.tiles[tile] = FILM_TILE_DONE;
    double plain = picture_writing_time(&options, picture, 1);
    picture->request.settings.finish.bloom = 0.3;
    picture->request.settings.finish.fxaa = true;
    double one = picture_writing_time(&options, picture, 1) - plain;
    double four = picture_writing_time(&options, picture, 4) - plain;
    double begun = clock_seconds(CLOCK_THREAD_CPUTIME_ID);
    picture_shown_destroy(picture_shown_make(picture, (struct denoising){DENOISER_NONE, NULL, NULL}, &error));
    double took = (clock_seconds(CLOCK_THREAD_CPUTIME_ID) - begun) / (SIDE * SIDE);
    CHECK(plain > 0 && one > took / 3 && one < 3 * took);
    CHECK(four > 2 * one); /* other threads wait */
    free(block);
    free(picture);
}

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
