/* The order of tiles, how far the work is, drafts, and what Ctrl-C leaves. */
#include "tests/harness.h"

#include "render/order.h"
#include "render/outlook.h"
#include "tests/stage.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* Of any rectangle of tiles as large a share is done as of all, within a few tiles. */
TEST(spread_tiles_stand_for_the_others_at_any_time) {
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

/* A job over a film of its own, with or without somebody who asks how far it is. */
static bool run_job(struct stage *s, struct film *film, struct outlook *outlook, const _Atomic int *enough,
                    struct render_statistics *statistics) {
    struct render_job job = {.world = &s->world,
                             .camera = s->camera,
                             .settings = s->settings,
                             .width = film->width,
                             .height = film->height,
                             .ambient = vec3_all(0.3),
                             .film = film,
                             .outlook = outlook,
                             .enough = enough};
    return render_run(&job, s->pool, statistics, &s->error);
}

TEST(what_is_foretold_is_done_in_the_end_and_counts_for_nothing) {
    struct stage s;
    struct render_statistics plain = {0}, asked = {0};
    struct outlook outlook = {0};
    stage_begin(&s, 2);
    stage_sphere(&s, s.root, stage_glass(&s, 0.3, 0.6, 1.4));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    size_t bytes;
    CHECK(film_size(200, 150, &bytes, &s.error));
    void *blocks[2] = {calloc(1, bytes), calloc(1, bytes)};
    struct film films[2] = {film_of(200, 150), film_of(200, 150)};
    for (int i = 0; i < 2; i++)
        film_place(&films[i], blocks[i], 200, 150);
    CHECK(outlook_share(&outlook) < 0 && outlook_left(&outlook, 1) < 0);
    CHECK(run_job(&s, &films[0], NULL, NULL, &plain));
    CHECK(run_job(&s, &films[1], &outlook, NULL, &asked));
    CHECK(outlook_share(&outlook) == 1);
    CHECK(outlook.all == outlook.done && outlook.all > 0);
    CHECK(memcmp(films[0].pixels, films[1].pixels, (size_t)200 * 150 * sizeof(struct film_pixel)) == 0);
    CHECK_EQ_INT(plain.camera_rays, asked.camera_rays);
    CHECK_EQ_INT(plain.refracted_rays, asked.refracted_rays);
    CHECK_EQ_INT(plain.shape_tests, asked.shape_tests);
    CHECK_EQ_INT(plain.hierarchy_steps, asked.hierarchy_steps);
    free(blocks[0]);
    free(blocks[1]);
    stage_end(&s);
}

TEST(the_time_left_is_the_time_so_far_over_the_work_that_is_missing) {
    struct outlook outlook = {.all = 1000, .done = 250, .begun = UINT64_C(5000000000)};
    CHECK_NEAR(outlook_share(&outlook), 0.25, 1e-12);
    CHECK_NEAR(outlook_left(&outlook, 7), 6, 1e-12);
    outlook.done = 1000;
    CHECK_NEAR(outlook_left(&outlook, 7), 0, 1e-12);
    outlook.done = 0;
    CHECK(outlook_left(&outlook, 7) < 0);
}

/* Tiles that are begun are finished, others are not begun. */
static void stop_soon(void *context, uint32_t tile, uint32_t done, uint32_t count) {
    (void)tile, (void)count;
    if (done == 3)
        atomic_store((_Atomic int *)context, 1);
}

TEST(enough_tiles_end_a_render_with_whole_tiles) {
    struct stage s;
    _Atomic int enough = 0;
    struct render_statistics statistics = {0};
    stage_begin(&s, 1);
    stage_sphere(&s, s.root, stage_glass(&s, 0.3, 0.6, 1.4));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    size_t bytes;
    CHECK(film_size(200, 150, &bytes, &s.error));
    void *block = calloc(1, bytes);
    struct film film = film_of(200, 150);
    film_place(&film, block, 200, 150);
    struct render_job job = {.world = &s.world,
                             .camera = s.camera,
                             .settings = s.settings,
                             .width = 200,
                             .height = 150,
                             .film = &film,
                             .enough = &enough,
                             .tile_done = stop_soon,
                             .context = &enough};
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
    free(result.out);
    free(result.err);
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

/* --- telling --- */

TEST(progress_as_json_tells_the_share_of_the_work_and_the_time_left) {
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
    release(result);
}
