/* See folder.h. */
#define _GNU_SOURCE
#include "tests/fuzz/folder.h"

#include <fcntl.h>
#include <ftw.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Exists with sanitizers only. */
void __sanitizer_set_report_fd(void *descriptor) __attribute__((weak));

static char folder[256];
static pid_t owner;

static int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *entry) {
    (void)status;
    (void)kind;
    return entry->level == 0 ? 0 : remove(path);
}

void fuzz_empty_folder(void) {
    if (folder[0])
        (void)nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

static void remove_folder(void) {
    if (getpid() != owner) /* a process forked for one input */
        return;
    fuzz_empty_folder();
    (void)rmdir(folder);
}

const char *fuzz_folder(void) {
    if (folder[0])
        return folder;
    const char *base = getenv("TMPDIR");
    if (!base)
        base = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    (void)snprintf(folder, sizeof folder, "%.200s/gray-fuzz-XXXXXX", base);
    if (!mkdtemp(folder) || chdir(folder) != 0)
        abort();
    owner = getpid();
    (void)atexit(remove_folder);
    return folder;
}

void fuzz_write(const char *name, const void *bytes, size_t size) {
    char path[512];
    (void)snprintf(path, sizeof path, "%s/%s", fuzz_folder(), name);
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0 || write(file, bytes, size) != (ssize_t)size)
        abort();
    (void)close(file);
}

void fuzz_hush(bool on) {
    static int kept[2];
    if (on && !kept[1]) {
        kept[0] = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 10);
        kept[1] = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 10);
        if (__sanitizer_set_report_fd)
            __sanitizer_set_report_fd((void *)(intptr_t)kept[1]);
    }
    (void)fflush(stdout);
    (void)fflush(stderr);
    int nothing = on ? open("/dev/null", O_WRONLY | O_CLOEXEC) : -1;
    for (int i = 0; i < 2; i++)
        (void)dup2(on ? nothing : kept[i], STDOUT_FILENO + i);
    if (nothing >= 0)
        (void)close(nothing);
}
