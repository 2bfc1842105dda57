/* Vectors of the processor against numbers, one lane after the other. */
#include "tests/harness.h"

#include "math/lanes.h"

#include <string.h>

enum { ROOM = 16, RUNS = 2000 };

/* Often one of the numbers for which an instruction may have a rule of its own. */
static double odd_number(struct test_random *random) {
    static const double special[] = {0, -0.0, 1, -1, 0.5, -2.5, INFINITY, -INFINITY, NAN, 0x1p-140, 0x1p-1040, 3};
    if (test_uniform(random, 0, 1) < 0.5)
        return special[(int)test_uniform(random, 0, 12)];
    return test_uniform(random, -4, 4);
}

/* Equal bits; every NaN is as good as another. */
#define SAME(x, y) ((isnan(x) && isnan(y)) || memcmp(&(x), &(y), sizeof(x)) == 0)

#define EACH_LANE(type, element, count, vector, expression)                                                            \
    {                                                                                                                  \
        type##_store(out, vector);                                                                                     \
        for (unsigned i = 0; i < (count); i++) {                                                                       \
            element x = a[i], y = b[i], wanted = (element)(expression);                                                \
            (void)x, (void)y;                                                                                          \
            if (!SAME(out[i], wanted))                                                                                 \
                test_fail(__FILE__, __LINE__, #vector " of %g and %g is %g", (double)x, (double)y, (double)out[i]);    \
        }                                                                                                              \
    }
#define EACH_BIT(count, bits, expression)                                                                              \
    for (unsigned i = 0; i < (count); i++) {                                                                           \
        element x = a[i], y = b[i];                                                                                    \
        (void)x, (void)y;                                                                                              \
        if (((bits) >> i & 1) != (unsigned)((expression) != 0))                                                        \
            test_fail(__FILE__, __LINE__, #bits " of %g and %g", (double)x, (double)y);                                \
    }
#define TEST_TYPE(type, number, count)                                                                                 \
    static void test_##type(struct test_random *random) {                                                              \
        typedef number element;                                                                                        \
        _Alignas(64) element a[ROOM], b[ROOM], out[ROOM];                                                              \
        for (int k = 0; k < ROOM; k++) {                                                                               \
            a[k] = (element)odd_number(random);                                                                        \
            b[k] = test_uniform(random, 0, 1) < 0.2 ? a[k] : (element)odd_number(random);                              \
        }                                                                                                              \
        const type va = type##_load(a), vb = type##_load_any(b);                                                       \
        EACH_LANE(type, element, count, type##_add(va, vb), x + y)                                                     \
        EACH_LANE(type, element, count, type##_sub(va, vb), x - y)                                                     \
        EACH_LANE(type, element, count, type##_mul(va, vb), x *y)                                                      \
        EACH_LANE(type, element, count, type##_div(va, vb), x / y)                                                     \
        EACH_LANE(type, element, count, type##_min(va, vb), x < y ? x : y)                                             \
        EACH_LANE(type, element, count, type##_max(va, vb), x > y ? x : y)                                             \
        EACH_LANE(type, element, count, type##_size(va), fabs(x))                                                      \
        EACH_LANE(type, element, count, type##_sign(va), copysign(0, x))                                               \
        EACH_LANE(type, element, count, type##_flip(va, type##_sign(vb)), copysign(1, (double)y) < 0 ? -x : x)         \
        EACH_LANE(type, element, count, type##_all(a[0]), a[0])                                                        \
        const unsigned less = (unsigned)type##_bits(type##_less(va, vb));                                              \
        const unsigned less_equal = (unsigned)type##_bits(type##_less_equal(va, vb));                                  \
        const unsigned negative = (unsigned)type##_negative(va);                                                       \
        EACH_BIT(count, less, x < y)                                                                                   \
        EACH_BIT(count, less_equal, x <= y)                                                                            \
        EACH_BIT(count, negative, copysign(1, (double)x) < 0)                                                          \
        CHECK(((less | less_equal | negative) >> (count)) == 0);                                                       \
    }
TEST_TYPE(float4, float, 4)
TEST_TYPE(float8, float, 8)
TEST_TYPE(float_lanes, float, FLOAT_LANES)
TEST_TYPE(double2, double, 2)
TEST_TYPE(double4, double, 4)
TEST_TYPE(double_lanes, double, DOUBLE_LANES)

/* Special numbers among them: +0 and -0, infinities, NaN. */
TEST(vectors_of_every_type_have_the_bits_of_their_lanes) {
    struct test_random random = {31};
    for (int k = 0; k < RUNS; k++) {
        test_float4(&random);
        test_float8(&random);
        test_float_lanes(&random);
        test_double2(&random);
        test_double4(&random);
        test_double_lanes(&random);
    }
}

TEST(roots_whole_numbers_and_choices_of_vectors_are_those_of_their_lanes) {
    struct test_random random = {32};
    for (int k = 0; k < RUNS; k++) {
        _Alignas(64) double a[DOUBLE_LANES], b[DOUBLE_LANES], out[DOUBLE_LANES];
        for (int i = 0; i < DOUBLE_LANES; i++) {
            a[i] = odd_number(&random);
            b[i] = odd_number(&random);
        }
        const double_lanes va = double_lanes_load(a), vb = double_lanes_load(b);
        const uint64_t bits = (uint64_t)test_uniform(&random, 0, 0x1p40);
        EACH_LANE(double_lanes, double, DOUBLE_LANES, double_lanes_root(va), sqrt(x))
        EACH_LANE(double_lanes, double, DOUBLE_LANES, double_lanes_floor(va), floor(x))
        EACH_LANE(double_lanes, double, DOUBLE_LANES, double_lanes_ceil(va), ceil(x))
        EACH_LANE(double_lanes, double, DOUBLE_LANES, double_lanes_choose(double_lanes_mask_of_bits(bits), va, vb),
                  bits >> i & 1 ? x : y)
        EACH_LANE(double_lanes, double, DOUBLE_LANES, double_lanes_choose(double_lanes_unordered(va, vb), va, vb),
                  isnan(x) || isnan(y) ? x : y)
    }
}
