/* Small files that users of other programs reported, with what is right for each: ../shared/cases/check.py. */
#include "tests/harness.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Lines about surfaces at the same place, which are no matter of files. */
static const char *const known[] = {"flush boxes, whitted", "flush boxes, path, furnace", "four flush slabs, furnace",
                                    "a decal flush on a box"};

static bool is_known(const char *line) {
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strncmp(line, known[k], strlen(known[k])) == 0)
            return true;
    return false;
}

TEST(files_that_users_of_other_programs_reported_are_read_or_named) {
    char script[PATH_MAX], command[PATH_MAX + 256];
    if (!realpath("../shared/cases/check.py", script))
        test_skip("../shared/cases is not there");
    static const char find[] =
        "for p in python3 /usr/bin/python3; do $p -c 'import numpy, PIL' 2>err.txt && break; done";
    if (test_run_shell(find, "") != 0)
        test_skip("python3 has no numpy or no PIL");
    (void)snprintf(command, sizeof command, "%s; $p '%s' $gray; true", find, script);
    test_shell(command, 0, " checks, ");
    char *output = test_read_file(test_path("out.txt"), NULL);
    for (char *line = output; line && *line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL)
        if (strncmp(line, "FAIL  ", 6) == 0 && !is_known(line + 6))
            test_fail(__FILE__, __LINE__, "%.*s", (int)strcspn(line, "\n"), line);
    free(output);
}
