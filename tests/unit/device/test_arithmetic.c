/* What a card is compared with must itself be the same everywhere. */
#include "device/arithmetic_internal.h"
#include "tests/harness.h"

TEST(operations_and_functions_have_the_bits_of_every_compiler_and_processor) {
    uint64_t all = 0;
    for (uint32_t i = 0; i < ARITHMETIC_NUMBERS; i++)
        all ^= arithmetic_digest(i);
    CHECK_EQ_INT((int64_t)all, INT64_C(0x3b635eb32a345822));
}
