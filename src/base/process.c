/* The state of a process is that of its threads: /proc/PID/task/TID/stat has a letter for each. */
#define _GNU_SOURCE
#include "base/process.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* The letter, or '\0'. */
static char thread_state(int tasks, const char *thread) {
    char path[64], text[512];
    (void)snprintf(path, sizeof path, "%.32s/stat", thread);
    int file = openat(tasks, path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return '\0';
    ssize_t got = read(file, text, sizeof text - 1);
    (void)close(file);
    text[got > 0 ? got : 0] = '\0';
    const char *end = strrchr(text, ')'); /* the name before it may contain anything */
    return end && end[1] == ' ' ? end[2] : '\0';
}

enum process_state process_state(pid_t pid) {
    char path[64];
    int threads = 0, stopped = 0, running = 0;
    (void)snprintf(path, sizeof path, "/proc/%ld/task", (long)pid);
    DIR *tasks = opendir(path);
    if (!tasks)
        return PROCESS_UNKNOWN;
    for (const struct dirent *entry; (entry = readdir(tasks)) != NULL;) {
        char state = entry->d_name[0] == '.' ? '\0' : thread_state(dirfd(tasks), entry->d_name);
        threads += state != '\0';
        stopped += state == 'T' || state == 't';
        running += state == 'R';
    }
    (void)closedir(tasks);
    if (running > 0)
        return PROCESS_RUNS;
    return threads == 0 ? PROCESS_UNKNOWN : stopped == threads ? PROCESS_STOPPED : PROCESS_WAITS;
}

double process_time(pid_t pid) {
    clockid_t clock;
    struct timespec now;
    if (clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &now) != 0)
        return 0;
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
