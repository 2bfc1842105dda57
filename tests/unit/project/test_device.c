/* The text that cards will run, as far as it can be checked without one. */
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void scan(const char *what, const char *says) {
    char line[8400], *root = realpath(".", NULL);
    test_need_tools("clang");
    (void)snprintf(line, sizeof line, "BUILD=$PWD '%s/tools/device_scan.sh' %s", root, what);
    free(root);
    test_shell(line, 0, "");
    char *output = test_read_file(test_path("out.txt"), NULL);
    if (strstr(output, "nothing was checked"))
        test_skip("%.100s", output);
    if (!strstr(output, says))
        test_fail(__FILE__, __LINE__, "no \"%s\" in %.1000s", says, output);
    free(output);
}

TEST(what_a_ray_touches_compiles_for_cards_and_calls_nothing_else) {
    scan("calls", " functions");
}

TEST_LONG(every_operation_for_cards_is_rounded_and_none_is_fused) {
    scan("", " operations are rounded to nearest");
}
