/* Information about other processes. */
#include "base/process.h"
#include "tests/harness.h"

#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Polls for at most half a minute. */
static bool comes_to(pid_t child, enum process_state state) {
    for (int i = 0; i < 3000; i++) {
        if (process_state(child) == state)
            return true;
        const struct timespec pause = {0, 10000000};
        (void)nanosleep(&pause, NULL);
    }
    return false;
}

static pid_t start_child(bool works) {
    pid_t child = fork();
    if (child != 0)
        return child;
    for (volatile unsigned i = 0;;) {
        if (works)
            i++;
        else
            (void)pause();
    }
}

static void end_child(pid_t child) {
    (void)kill(child, SIGKILL);
    (void)waitpid(child, NULL, 0);
    CHECK_EQ_INT(process_state(child), PROCESS_UNKNOWN);
    CHECK(!(process_time(child) > 0));
}

TEST(a_process_that_works_waits_or_is_stopped_is_seen_as_such) {
    pid_t works = start_child(true), waits = start_child(false);
    CHECK(comes_to(works, PROCESS_RUNS));
    CHECK(comes_to(waits, PROCESS_WAITS));
    CHECK(kill(works, SIGSTOP) == 0 && comes_to(works, PROCESS_STOPPED));
    CHECK(kill(waits, SIGSTOP) == 0 && comes_to(waits, PROCESS_STOPPED));
    double used = process_time(works);
    CHECK(used > 0);
    CHECK_NEAR(process_time(works), used, 0);
    CHECK(kill(works, SIGCONT) == 0 && comes_to(works, PROCESS_RUNS));
    while (!(process_time(works) > used))
        (void)usleep(10000);
    end_child(works);
    end_child(waits);
}
