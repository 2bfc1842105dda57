/* The random numbers of a picture: functions of their indices, with fixed values, stratified over the samples of a
 * pixel. */
#include "render/sampler.h"

#include "tests/harness.h"

enum { SIDE = 3, ALL = SIDE * SIDE };

static struct sampler sample_of_pixel(uint64_t number) {
    return sampler_make(7, 1234, number, SIDE);
}

/* The definition, written out: keys are chains of random_combine, and pictures depend on every link. */
TEST(sampler_keys_are_chains_of_seed_pixel_and_sample) {
    uint64_t pixel = random_combine(random_combine(7, 0), 1234);
    for (uint64_t number = 0; number <= ALL; number++) {
        struct sampler s = sample_of_pixel(number);
        CHECK(s.key == random_combine(pixel, number));
        CHECK(s.pixel_key == random_combine(pixel, 1));
        CHECK_EQ_INT(s.cell, number > 0 ? number - 1 : 0);
        CHECK_EQ_INT(s.side, number > 0 ? SIDE : 1);
        CHECK(sampler_right_eye(&s) == random_combine(s.key, UINT64_MAX));
        CHECK(sampler_branch(s.key, SAMPLER_REFLECTED) == random_combine(s.key, UINT32_MAX));
        CHECK(sampler_branch(s.key, SAMPLER_REFRACTED) == random_combine(s.key, UINT64_C(0x100000000)));
        CHECK(sampler_branch(s.key, SAMPLER_ROUGH) == random_combine(s.key, UINT64_C(0x100000001)));
        CHECK(sampler_branch(s.key, SAMPLER_HOLE) == random_combine(s.key, UINT64_C(0x100000002)));
        CHECK(sampler_light(s.key, 5) == random_combine(s.key, 5) &&
              sampler_facet(s.key, 6) == random_combine(s.key, 6));
    }
    /* As numbers, so that a change of random_combine is detected, too. */
    CHECK(sample_of_pixel(0).key == UINT64_C(0x51fc99a03bf636c1));
    CHECK(sample_of_pixel(5).key == UINT64_C(0x62d7cec3d5e8bb5b));
}

TEST(sampler_draws_the_numbers_that_pictures_were_made_of) {
    struct sampler s = sample_of_pixel(5);
    uint32_t turn = sample_permute(4, ALL, random_combine(s.pixel_key, UINT64_MAX));
    struct sample2 lens = sampler_lens(&s),
                   own = sample_cell(random_combine(s.pixel_key, 2), turn % SIDE, turn / SIDE, SIDE);
    CHECK(lens.x == own.x && lens.y == own.y);
    turn = sample_permute(4, ALL, random_combine(s.pixel_key, UINT64_MAX - 1));
    CHECK(sampler_time(&s) == (turn + random_unit(random_combine(s.key, UINT64_MAX - 1))) / ALL);

    uint64_t ray = random_mix(99), rough = sampler_branch(ray, SAMPLER_ROUGH), light = sampler_light(ray, 2);
    struct sample_set facets = sampler_facets(&s, ray, rough, 4),
                      single = sampler_facets(&(struct sampler){.side = 1}, ray, rough, 4);
    struct sample_set shared = sampler_on_light(&s, light, 2, 4, true),
                      jittered = sampler_on_light(&s, light, 2, 4, false);
    for (uint32_t cell = 0; cell < 16; cell++) {
        uint32_t i = cell % 4, j = cell / 4;
        struct sample2 p = sample_set_point(&facets, cell);
        turn = sample_permute(4, ALL, random_combine(s.pixel_key, ray));
        own = sample_cell_part(rough, i, j, 4, turn, SIDE);
        CHECK(p.x == own.x && p.y == own.y);
        p = sample_set_point(&single, cell);
        own = sample_cell(rough, i, j, 4);
        CHECK(p.x == own.x && p.y == own.y);
        p = sample_set_point(&shared, cell);
        turn = sample_permute(4, ALL, random_combine(s.pixel_key, 2));
        own =
            sample_multi(random_combine(s.pixel_key, UINT64_MAX - 4), light, (struct sample_part){i, j, 4, turn, SIDE});
        CHECK(p.x == own.x && p.y == own.y);
        p = sample_set_point(&jittered, cell);
        own = sample_cell(light, i, j, 4);
        CHECK(p.x == own.x && p.y == own.y);
    }
}

TEST(the_samples_of_a_pixel_visit_each_cell_of_lens_and_shutter_once) {
    uint8_t lens[ALL] = {0}, times[ALL] = {0};
    for (uint64_t number = 1; number <= ALL; number++) {
        struct sampler s = sample_of_pixel(number);
        struct sample2 p = sampler_lens(&s);
        lens[(uint32_t)(p.y * SIDE) * SIDE + (uint32_t)(p.x * SIDE)]++;
        times[(uint32_t)(sampler_time(&s) * ALL)]++;
    }
    for (int i = 0; i < ALL; i++)
        CHECK(lens[i] == 1 && times[i] == 1);
}

/* n x n facets of each of N x N samples: one in each of nN x nN parts. On a light one in each row and column, too. */
TEST(the_samples_of_a_pixel_share_facets_and_lights_without_gaps) {
    enum { N = 4, PARTS = N * SIDE, POINTS = PARTS * PARTS };
    for (int on_light = 0; on_light <= 1; on_light++) {
        uint8_t parts[POINTS] = {0}, rows[POINTS] = {0}, columns[POINTS] = {0};
        for (uint64_t number = 1; number <= ALL; number++) {
            struct sampler s = sample_of_pixel(number);
            uint64_t ray = 42, key = random_combine(s.key, 1);
            struct sample_set set = on_light ? sampler_on_light(&s, key, 3, N, true) : sampler_facets(&s, ray, key, N);
            for (uint32_t cell = 0; cell < N * N; cell++) {
                struct sample2 p = sample_set_point(&set, cell);
                CHECK((uint32_t)(p.x * N) == cell % N && (uint32_t)(p.y * N) == cell / N);
                parts[(uint32_t)(p.y * PARTS) * PARTS + (uint32_t)(p.x * PARTS)]++;
                columns[(uint32_t)(p.x * POINTS)]++;
                rows[(uint32_t)(p.y * POINTS)]++;
            }
        }
        for (int i = 0; i < POINTS; i++)
            CHECK(parts[i] == 1 && (!on_light || (rows[i] == 1 && columns[i] == 1)));
    }
}

TEST(a_lone_sample_has_one_cell_and_lights_of_the_specification_share_none) {
    struct sampler first = sample_of_pixel(0), fifth = sample_of_pixel(5), sixth = sample_of_pixel(6);
    double time = sampler_time(&first);
    CHECK(time >= 0 && time < 1);
    CHECK_EQ_INT(sampler_facets(&first, 1, 2, 4).kind, SAMPLE_SET_JITTERED);
    struct sample_set a = sampler_on_light(&fifth, 77, 0, 4, false), b = sampler_on_light(&sixth, 77, 0, 4, false);
    for (uint32_t cell = 0; cell < 16; cell++) {
        struct sample2 p = sample_set_point(&a, cell), q = sample_set_point(&b, cell);
        CHECK(p.x == q.x && p.y == q.y); /* a function of the light's key only */
    }
}

TEST(no_two_uses_below_a_ray_have_the_same_key) {
    enum { LIGHTS = 1000 };
    uint64_t keys[LIGHTS + 4], ray = sample_of_pixel(1).key;
    for (uint32_t i = 0; i < LIGHTS; i++)
        keys[i] = sampler_light(ray, i);
    for (int i = 0; i < 4; i++)
        keys[LIGHTS + i] = sampler_branch(ray, (enum sampler_branch)i);
    for (int i = 0; i < LIGHTS + 4; i++)
        for (int j = 0; j < i; j++)
            CHECK(keys[i] != keys[j]);
}
