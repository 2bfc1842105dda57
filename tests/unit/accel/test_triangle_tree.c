/* The binary hierarchies from which an index is made: reinsertion keeps them valid and makes them cheaper, the collapse
 * into nodes of eight children is optimal, and no set of triangles makes them deeper than the traversal allows. */
#include "accel/triangle_tree_internal.h"

#include "base/mem.h"
#include "tests/harness.h"
#include "tests/unit/mesh_makers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MANY = 3000 };

static struct reference box_at(struct test_random *random, float spread, float size, uint32_t triangle) {
    struct reference r = {.triangle = triangle};
    for (int k = 0; k < 3; k++) {
        r.min[k] = (float)test_uniform(random, -(double)spread, (double)spread);
        r.max[k] = r.min[k] + (float)test_uniform(random, 0, (double)size);
    }
    return r;
}

/* Tiny triangles; sheets; a cluster of small ones among large ones (a statue in a stadium); all at one point. */
enum mix { DUST, SHEETS, STATUE, ONE_POINT, MIXES };

static void fill(struct reference *references, uint32_t count, enum mix mix, struct test_random *random) {
    for (uint32_t i = 0; i < count; i++) {
        references[i] = box_at(random, 1, 0.02f, i);
        if (mix == SHEETS)
            references[i].max[i % 3] = references[i].min[i % 3];
        if (mix == STATUE)
            references[i] = i % 2 ? box_at(random, 0.02f, 0.001f, i) : box_at(random, 1, 0.2f, i);
        if (mix == ONE_POINT)
            references[i] = (struct reference){.triangle = i};
    }
}

static uint32_t tree_over(struct tree *tree, struct reference *references, uint32_t count) {
    struct range range = {.count = count};
    uint32_t root = NO_BRANCH;
    range_measure(references, &range);
    CHECK(tree_build(tree, references, &range, 0, NULL, &root));
    return root;
}

static double surface(const struct tree *tree) {
    double sum = 0;
    for (uint32_t i = 0; i < tree->count; i++)
        sum += tree->branches[i].height > 0 ? (double)tree->branches[i].area : 0;
    return sum;
}

/* Every box is that of its children, every count the sum of theirs. Returns the number of leaves; marks their
 * triangles. */
static uint32_t check_whole(const struct tree *tree, const struct reference *references, uint32_t number,
                            uint8_t *seen) {
    const struct branch *b = &tree->branches[number];
    if (b->height == 0) {
        CHECK(b->count > 0 && b->count <= WIDTH);
        for (uint32_t i = b->first; i < b->first + b->count; i++) {
            seen[i]++;
            for (int k = 0; k < 3; k++)
                CHECK(references[i].min[k] >= b->min[k] && references[i].max[k] <= b->max[k]);
        }
        return 1;
    }
    const struct branch *x = &tree->branches[b->child[0]], *y = &tree->branches[b->child[1]];
    CHECK(x->parent == number && y->parent == number);
    CHECK_EQ_INT(b->count, x->count + y->count);
    CHECK_EQ_INT(b->height, 1 + (x->height > y->height ? x->height : y->height));
    CHECK(b->height <= MAX_BRANCH_DEPTH);
    for (int k = 0; k < 3; k++)
        CHECK(b->min[k] == fminf(x->min[k], y->min[k]) && b->max[k] == fmaxf(x->max[k], y->max[k]));
    return check_whole(tree, references, b->child[0], seen) + check_whole(tree, references, b->child[1], seen);
}

TEST(reinsertion_keeps_a_hierarchy_whole_and_never_makes_its_surfaces_larger) {
    struct test_random random = {31};
    struct reference *references = malloc(MANY * sizeof *references);
    for (int round = 0; round < 5 * MIXES; round++) {
        enum mix mix = (enum mix)(round % MIXES);
        uint32_t count = round < MIXES ? 1 + (uint32_t)round : MANY / (1 + (uint32_t)round / MIXES);
        struct tree tree = {0};
        uint8_t seen[MANY] = {0};
        fill(references, count, mix, &random);
        uint32_t root = tree_over(&tree, references, count), leaves = 0;
        double before = surface(&tree);
        CHECK(tree_improve(&tree, NULL));
        leaves = check_whole(&tree, references, root, seen);
        CHECK_EQ_INT(tree.count, 2 * leaves - 1);
        CHECK(tree.branches[root].parent == NO_BRANCH);
        for (uint32_t i = 0; i < count; i++)
            CHECK_EQ_INT(seen[i], 1);
        CHECK(surface(&tree) <= before);
        CHECK(mix != STATUE || count < 1000 || surface(&tree) < 0.995 * before);
        mem_free(tree.branches);
    }
    free(references);
}

TEST(reinsertion_is_the_same_every_time) {
    struct test_random random = {32};
    struct reference *references = malloc(MANY * sizeof *references), *again = malloc(MANY * sizeof *again);
    struct tree tree = {0}, other = {0};
    fill(references, MANY, STATUE, &random);
    memcpy(again, references, MANY * sizeof *again);
    (void)tree_over(&tree, references, MANY);
    (void)tree_over(&other, again, MANY);
    CHECK(tree_improve(&tree, NULL) && tree_improve(&other, NULL));
    CHECK(tree.count == other.count && memcmp(tree.branches, other.branches, tree.count * sizeof *tree.branches) == 0);
    mem_free(tree.branches);
    mem_free(other.branches);
    free(references);
    free(again);
}

/* --- the collapse against all possible ones --- */

/* As in triangle_tree.c: a node costs its surface area, a block twice that. */
static double cheapest(const struct tree *tree, uint32_t number);

/* The minimal sum over all divisions of `open` (some nodes of it are final) into at most WIDTH parts. */
static double cheapest_parts(const struct tree *tree, const uint32_t *open, int count, int settled, double sum) {
    if (count > WIDTH)
        return INFINITY;
    if (settled == count)
        return sum;
    const struct branch *b = &tree->branches[open[settled]];
    double best = cheapest_parts(tree, open, count, settled + 1, sum + cheapest(tree, open[settled]));
    if (b->height > 0) {
        uint32_t more[WIDTH + 1];
        memcpy(more, open, (size_t)count * sizeof *more);
        more[settled] = b->child[0];
        more[count] = b->child[1];
        best = fmin(best, cheapest_parts(tree, more, count + 1, settled, sum));
    }
    return best;
}

static double cheapest(const struct tree *tree, uint32_t number) {
    const struct branch *b = &tree->branches[number];
    double block = b->count <= WIDTH ? 2 * (double)b->area : INFINITY;
    return b->height == 0 ? block : fmin(block, (double)b->area + cheapest_parts(tree, b->child, 2, 0, 0));
}

static double cost_as_cut(const struct tree *tree, uint32_t number) {
    const struct branch *b = &tree->branches[number];
    if (b->height == 0 || b->is_block) {
        CHECK(b->count <= WIDTH);
        return 2 * (double)b->area;
    }
    uint32_t children[WIDTH], count = tree_children(tree, number, children);
    double sum = (double)b->area;
    CHECK(count >= 2 && count <= WIDTH);
    for (uint32_t i = 0; i < count; i++)
        sum += cost_as_cut(tree, children[i]);
    return sum;
}

TEST(the_cut_into_nodes_of_eight_children_is_the_cheapest_of_all) {
    struct test_random random = {33};
    struct reference references[80];
    int nodes = 0;
    for (int round = 0; round < 60; round++) {
        uint32_t count = 1 + (uint32_t)test_uniform(&random, 0, 79);
        struct tree tree = {0};
        fill(references, count, (enum mix)(round % ONE_POINT), &random);
        uint32_t root = tree_over(&tree, references, count);
        double cost = (double)tree_weigh(&tree, root, 0, NULL).of[0], cut = cost_as_cut(&tree, root);
        CHECK_NEAR(cost, cheapest(&tree, root), 1e-5 * cost);
        CHECK_NEAR(cost, cut, 1e-5 * cost);
        nodes += !tree.branches[root].is_block;
        mem_free(tree.branches);
    }
    CHECK(nodes > 30);
}

/* Each triangle is half as large as the previous one, all with a corner at the origin: every split separates one from
 * the rest.
 */
TEST(triangles_in_one_another_down_to_the_smallest_are_searched_like_all_others) {
    enum { NESTED = 900 };
    struct maker m = {0};
    for (int i = 0; i < NESTED; i++) {
        double size = ldexp(1, -i / 8), lift = size * (1 + (i % 8) / 16.0);
        uint32_t a = maker_vertex(&m, 0, 0, 0), b = maker_vertex(&m, size, 0, lift),
                 c = maker_vertex(&m, 0, size, lift);
        maker_triangle(&m, a, b, c);
    }
    struct triangle_set set = set_of(&m);
    struct triangle_index *index = NULL;
    struct error error = {0};
    struct triangle_cost cost = {0};
    struct test_random random = {34};
    CHECK(triangle_index_build(&index, &set, 1, NULL, &error));
    for (int i = 0; i < 3000; i++) {
        double size = ldexp(1, -(int)test_uniform(&random, 0, NESTED / 8.0));
        struct vec3 to = {size * test_uniform(&random, 0, 1), size * test_uniform(&random, 0, 1),
                          size * test_uniform(&random, 0, 2)};
        struct ray ray = {
            .origin = {size * test_uniform(&random, -3, 3), size * test_uniform(&random, -3, 3), 3 * size},
            .t_max = INFINITY};
        ray.direction = vec3_sub(to, ray.origin);
        struct triangle_hit hit, expected;
        bool found = triangle_brute_nearest(&set, &ray, &expected, &cost);
        CHECK(triangle_index_nearest(index, &set, &ray, &hit, &cost) == found);
        CHECK(triangle_index_any(index, &set, &ray, &cost) == found);
        CHECK(!found || (hit.triangle == expected.triangle && hit.t == expected.t));
    }
    triangle_index_destroy(index);
    maker_free(&m);
}
