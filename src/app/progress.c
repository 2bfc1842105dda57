/* The estimate of the time left is the time so far, stretched over the tiles that are missing. The bar is erased with
 * blanks, not with escape sequences, so that any terminal shows it. */
#define _GNU_SOURCE
#include "app/progress.h"

#include "app/text.h"

#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

enum { BAR_CELLS = 24, COLUMNS_LIMIT = 200 };

double progress_clock(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void progress_init(struct progress *progress, enum progress_mode mode, bool quiet) {
    *progress = (struct progress){.mode = mode};
    if (mode == PROGRESS_AUTO)
        progress->mode = !quiet && isatty(STDERR_FILENO) ? PROGRESS_BAR : PROGRESS_NONE;
}

void progress_hide(struct progress *progress) {
    if (progress->columns == 0)
        return;
    (void)fprintf(stderr, "\r%*s\r", progress->columns, "");
    progress->columns = 0;
}

/* One column less than the terminal has: a full line would wrap. */
static int terminal_columns(void) {
    struct winsize size;
    int columns = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col - 1 : 79;
    return columns < COLUMNS_LIMIT ? columns : COLUMNS_LIMIT - 1;
}

static void draw_bar(struct progress *progress, double elapsed, uint32_t done, uint32_t count) {
    char cells[BAR_CELLS + 1], line[COLUMNS_LIMIT], left[48] = "";
    double share = count > 0 ? (double)done / count : 0;
    int filled = (int)(share * BAR_CELLS);
    memset(cells, '.', BAR_CELLS);
    memset(cells, '#', (size_t)filled);
    cells[BAR_CELLS] = '\0';
    if (done > 0 && elapsed > 1)
        (void)snprintf(left, sizeof left, ", about %.0f s left", elapsed / share - elapsed);
    /* A long path shows its end. */
    size_t length = strlen(progress->name);
    const char *name = length > 30 ? progress->name + length - 30 : progress->name;
    if (count > 0)
        (void)snprintf(line, sizeof line, "%s [%s] %3.0f %%  %.0f s%s", name, cells, 100 * share, elapsed, left);
    else
        (void)snprintf(line, sizeof line, "%s: building the scene  %.0f s", name, elapsed);
    int columns = (int)strlen(line), limit = terminal_columns();
    if (columns > limit)
        columns = limit;
    for (int i = 0; i < columns; i++)
        line[i] = (unsigned char)line[i] < 32 || line[i] == 127 ? '?' : line[i];
    int blanks = progress->columns > columns ? progress->columns - columns : 0;
    (void)fprintf(stderr, "\r%.*s%*s", columns, line, blanks, "");
    (void)fflush(stderr);
    progress->columns = columns;
}

static void print_json(const struct progress *progress, const char *event, double elapsed, uint32_t done,
                       uint32_t count) {
    (void)fputs("{\"picture\":", stderr);
    text_print_json(stderr, progress->name);
    (void)fprintf(stderr,
                  ",\"event\":\"%s\",\"width\":%u,\"height\":%u,\"tiles_done\":%u,\"tiles\":%u,\"seconds\":%.3f}\n",
                  event, progress->width, progress->height, done, count, elapsed);
    (void)fflush(stderr);
}

void progress_begin(struct progress *progress, const char *name, uint32_t width, uint32_t height) {
    progress->name = name;
    progress->width = width;
    progress->height = height;
    progress->begun = progress->shown = progress_clock();
    if (progress->mode == PROGRESS_JSON)
        print_json(progress, "begin", 0, 0, 0);
}

void progress_update(struct progress *progress, uint32_t done, uint32_t count) {
    if (!progress->name || progress->mode == PROGRESS_NONE)
        return;
    double now = progress_clock(), pause = progress->mode == PROGRESS_BAR ? 0.1 : 0.5;
    if (now - progress->shown < pause)
        return;
    progress->shown = now;
    if (progress->mode == PROGRESS_BAR)
        draw_bar(progress, now - progress->begun, done, count);
    else
        print_json(progress, count > 0 ? "render" : "build", now - progress->begun, done, count);
}

void progress_end(struct progress *progress, enum progress_end how) {
    if (!progress->name)
        return;
    double elapsed = progress_clock() - progress->begun;
    progress_hide(progress);
    if (progress->mode == PROGRESS_JSON)
        print_json(progress, how == PROGRESS_WRITTEN ? "written" : "given up", elapsed, 0, 0);
    if (progress->mode == PROGRESS_BAR && how == PROGRESS_WRITTEN) {
        char line[4096 + 64];
        (void)snprintf(line, sizeof line, "%s  %u x %u  %.1f s", progress->name, progress->width, progress->height,
                       elapsed);
        text_print_line(stderr, line);
    }
    progress->name = NULL;
}
