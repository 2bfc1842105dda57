/* The error of a few shadow rays: lamps of each kind over a floor, with no occluder, an edge or a ball, for several
 * sample patterns (independent, in cells, in cells with stratified rows and columns) and, for a rectangle, by area or
 * by solid angle. Prints a table for docs/design/light.md: root mean square of the relative error over many keys. */
#include "light/light.h"

#include <math.h>
#include <stdio.h>

enum {
    KEYS = 400,
};
enum pattern { PATTERN_RANDOM, PATTERN_CELLS, PATTERN_MULTI, PATTERN_COUNT };

static struct sample2 sample_position(enum pattern pattern, uint64_t key, uint32_t i, uint32_t j, uint32_t n) {
    if (pattern == PATTERN_RANDOM)
        return sample_cell(random_combine(key, (uint64_t)j * n + i), 0, 0, 1);
    return pattern == PATTERN_CELLS ? sample_cell(key, i, j, n)
                                    : sample_multi(key, random_mix(key), (struct sample_part){i, j, n, 0, 1});
}

/* 0: nothing; 1: everything beyond a slanted plane is hidden; 2: a ball. */
static bool hidden(int blocker, struct vec3 from, struct vec3 target) {
    struct vec3 d = vec3_sub(target, from);
    if (blocker == 1)
        return target.x + 0.3 * target.z > 0.1;
    if (blocker == 2) {
        struct vec3 o = vec3_add_scaled(from, d, 0.5);
        return (o.x - 0.1) * (o.x - 0.1) + o.z * o.z < 0.04;
    }
    return false;
}

static double estimate(const struct light *light, enum pattern pattern, int blocker, uint32_t n, uint64_t key) {
    struct light_context context;
    struct vec3 from = {0, 0, 0};
    double sum = 0;
    if (!light_context_make(light, from, from, &context))
        return 0;
    for (uint32_t c = 0; c < n * n; c++) {
        struct light_sample s = light_sample(light, &context, sample_position(pattern, key, c % n, c / n, n));
        if (!hidden(blocker, from, s.target.at))
            sum += s.intensity.r * fmax(s.direction.y, 0);
    }
    return sum / ((double)n * n);
}

static double error_of(const struct light *light, enum pattern pattern, int blocker, uint32_t n) {
    double exact = 0, squares = 0;
    for (uint64_t k = 0; k < 4; k++)
        exact += estimate(light, PATTERN_CELLS, blocker, 600, 77 + k) / 4;
    for (uint64_t k = 0; k < KEYS; k++) {
        double off = estimate(light, pattern, blocker, n, random_mix(k + 1)) / exact - 1;
        squares += off * off / KEYS;
    }
    return 100 * sqrt(squares);
}

static struct light area_light(int kind, double height) {
    struct light light = {.emissive = true, .colour = {1, 1, 1}, .position = {0.2, height, 0.1}, .radius = 0.5};
    light.direction = (struct vec3){0, -1, 0};
    /* Kind 3 is a slightly skewed rectangle, which is sampled by area. */
    light.kind = kind == 1 ? LIGHT_DISC : kind == 2 ? LIGHT_SPHERE : LIGHT_PARALLELOGRAM;
    light.edge1 = (struct vec3){1, 0, 0};
    light.edge2 = (struct vec3){kind == 3 ? 1e-6 : 0, 0, 1};
    light.corner = (struct vec3){-0.3, height, -0.4};
    return light;
}

int main(void) {
    static const char *const names[] = {"rectangle, solid angle", "disc, area", "sphere, solid angle",
                                        "rectangle, area"};
    static const char *const variants[] = {"nothing", "an edge", "a ball"};
    printf("| lamp | in the way | rays | independent | in cells | rows and columns too |\n| --- | --- | --- | --- | "
           "--- | --- |\n");
    for (int kind = 0; kind < 4; kind++)
        for (int blocker = 0; blocker < 3; blocker++) {
            struct light light = area_light(kind, 1);
            printf("| %s | %s | 16 |", names[kind], variants[blocker]);
            for (int p = 0; p < PATTERN_COUNT; p++)
                printf(" %.1f %% |", error_of(&light, (enum pattern)p, blocker, 4));
            printf("\n");
        }
    printf("\n| height of a 1 x 1 lamp | rectangle by area | by solid angle | disc of radius 1/2 |\n| --- | "
           "--- | --- | --- |\n");
    static const double heights[] = {0.02, 0.1, 0.3, 1, 3};
    for (int i = 0; i < 5; i++) {
        struct light area = area_light(3, heights[i]), angle = area_light(0, heights[i]),
                     disc = area_light(1, heights[i]);
        printf("| %g | %.1f %% | %.1f %% | %.1f %% |\n", heights[i], error_of(&area, PATTERN_CELLS, 0, 4),
               error_of(&angle, PATTERN_CELLS, 0, 4), error_of(&disc, PATTERN_CELLS, 0, 4));
    }
    return 0;
}
