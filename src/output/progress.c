/* The remaining time is the estimate for rendering (render/time_estimate.h) plus that for writing. The
 * bar is erased with blanks, not with escape sequences, so that any terminal shows it. */
#define _GNU_SOURCE
#include "output/progress.h"
#include "base/clock.h"

#include "base/terminal_text.h"
#include "session/text.h"

#include <math.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

enum { BAR_CELLS = 24, COLUMNS_LIMIT = 200 };

/* Seconds of one core for a pixel of a PNG file, which is written after the last tile, until it is measured on finished
 * tiles: it depends on the picture. */
static const double usual_writing = 5e-8;
/* The same for denoising a pixel of the film. */
static const double usual_denoising = 8e-6;

double progress_clock(void) {
    return clock_seconds(CLOCK_MONOTONIC);
}

double progress_processor_clock(void) {
    return clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
}

void progress_init(struct progress *progress, enum progress_mode mode, bool quiet, int threads) {
    *progress = (struct progress){.mode = mode, .threads = threads > 0 ? threads : (int)sysconf(_SC_NPROCESSORS_ONLN)};
    if (mode == PROGRESS_AUTO)
        progress->mode = quiet ? PROGRESS_NONE : isatty(STDERR_FILENO) ? PROGRESS_BAR : PROGRESS_LINES;
}

/* Output of scenes to the same stream starts on a new line. */
static void begin_line(const struct progress *progress) {
    if (progress->stream)
        error_stream_begin_line(progress->stream);
}

void progress_hide(struct progress *progress) {
    if (progress->columns == 0)
        return;
    (void)fprintf(stderr, "\r%*s\r", progress->columns, "");
    progress->columns = 0;
}

/* One column less than the terminal has: a full line would be broken. */
static int terminal_columns(void) {
    struct winsize size;
    int columns = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col - 1 : 79;
    return columns < COLUMNS_LIMIT ? columns : COLUMNS_LIMIT - 1;
}

/* The finished share of the picture. Without an estimate, tiles are counted. */
struct state {
    double elapsed, share, left; /* share and left: negative while unknown */
    uint32_t done, count;
};

static struct state state_of(struct progress *progress, double now, uint32_t done, uint32_t count,
                             const struct progress_estimate *progress_estimate) {
    struct state state = {now - progress->begun, -1, -1, done, count};
    bool asked = progress_estimate_is_wanted(progress_estimate);
    if (count == 0)
        return state;
    state.share = asked ? progress_estimate_share(progress_estimate) : (double)done / (double)count;
    state.left = asked             ? progress_estimate_left(progress_estimate, now)
                 : state.share > 0 ? state.elapsed / state.share - state.elapsed
                                   : -1;
    if (asked && state.share > 0 && state.left >= 0) {
        /* After the last tile, all threads denoise and write the picture. */
        double pixels = (double)progress->width * progress->height;
        double last = progress->writing * progress_estimate_pace(progress_estimate) * pixels / progress->threads;
        double whole = state.elapsed + state.left;
        state.share = fmax(progress->share, state.share * whole / (whole + last));
        progress->share = state.share;
        state.left += last;
    }
    return state;
}

/* The last bytes of a long path, as a terminal may show them at the beginning of a line. */
static void short_name(const char *name, size_t shown, char *out, size_t size) {
    char clean[40];
    size_t length = strlen(name), used = 0;
    const char *at = length > shown ? name + length - shown : name;
    while (((unsigned char)*at & 0xc0) == 0x80 && at > name)
        at++; /* not inside a character */
    for (size_t taken; *at && used + 8 < sizeof clean; at += taken)
        used += text_clean_piece(at, clean + used, &taken);
    clean[used] = '\0';
    (void)snprintf(out, size, "%s%s", scene_mark(clean), clean);
}

static void draw_bar(struct progress *progress, const struct state *state) {
    char cells[BAR_CELLS + 1], line[4 * COLUMNS_LIMIT], left[80] = "", elapsed[48];
    double share = state->share > 0 ? state->share : 0;
    /* In a narrow terminal the remaining time is more useful than a long bar. */
    int limit = terminal_columns(), bar = limit < 78 ? BAR_CELLS / 3 : BAR_CELLS;
    memset(cells, '.', (size_t)bar);
    memset(cells, '#', (size_t)(share * bar));
    cells[bar] = '\0';
    text_duration(state->elapsed, elapsed, sizeof elapsed);
    if (state->left >= 0 && state->elapsed > 1) {
        char time[48];
        text_duration(state->left, time, sizeof time);
        (void)snprintf(left, sizeof left, ", about %s left", time);
    }
    char name[64];
    short_name(progress->name, limit < 78 ? 14 : 30, name, sizeof name);
    if (state->count > 0)
        (void)snprintf(line, sizeof line, "%s [%s] %3.0f %%  %s%s", name, cells, 100 * share, elapsed, left);
    else
        (void)snprintf(line, sizeof line, "%s: building the scene  %s", name, elapsed);
    int columns = (int)strlen(line);
    if (columns > limit)
        columns = limit;
    begin_line(progress);
    int blanks = progress->columns > columns ? progress->columns - columns : 0;
    (void)fprintf(stderr, "\r%.*s%*s", columns, line, blanks, "");
    (void)fflush(stderr);
    progress->columns = columns;
}

static void print_line(struct progress *progress, const struct state *state) {
    char line[4096 + 160], elapsed[48], left[48] = "";
    text_duration(state->elapsed, elapsed, sizeof elapsed);
    if (state->left >= 0)
        text_duration(state->left, left, sizeof left);
    if (state->count > 0)
        (void)snprintf(line, sizeof line, "%s: %.0f %% after %s%s%s%s", progress->name,
                       100 * (state->share > 0 ? state->share : 0), elapsed, left[0] ? ", about " : "", left,
                       left[0] ? " left" : "");
    else
        (void)snprintf(line, sizeof line, "%s: building the scene, %s", progress->name, elapsed);
    begin_line(progress);
    text_print_scene_line(stderr, line);
    progress->printed = true;
}

static void print_json(const struct progress *progress, const char *event, const struct state *state) {
    begin_line(progress);
    (void)fputs("{\"picture\":", stderr);
    text_print_json(stderr, progress->name);
    (void)fprintf(stderr,
                  ",\"event\":\"%s\",\"width\":%u,\"height\":%u,\"tiles_done\":%u,\"tiles\":%u,\"seconds\":%.3f", event,
                  progress->width, progress->height, state->done, state->count, state->elapsed);
    if (state->share >= 0)
        (void)fprintf(stderr, ",\"share\":%.4f", state->share);
    if (state->left >= 0)
        (void)fprintf(stderr, ",\"left\":%.3f", state->left);
    (void)fprintf(stderr, ",\"processor\":%.4f}\n", progress_processor_clock());
    (void)fflush(stderr);
}

void progress_begin(struct progress *progress, const char *name, uint32_t width, uint32_t height, double denoised) {
    progress->name = name;
    progress->printed = progress->elsewhere = false;
    progress->share = 0;
    progress->writing = usual_writing + usual_denoising * denoised;
    progress->tried = progress->known = false;
    progress->width = width;
    progress->height = height;
    progress->begun = progress->shown = progress_clock();
    if (progress->mode == PROGRESS_JSON)
        print_json(progress, "begin", &(struct state){0, -1, -1, 0, 0});
}

bool progress_wants_writing_time(const struct progress *progress) {
    return progress->mode != PROGRESS_NONE && !progress->tried && progress->share > 0.25;
}

void progress_note_writing_time(struct progress *progress, double seconds) {
    progress->tried = true;
    if (seconds > 0)
        progress->writing = seconds;
}

bool progress_wants_estimate(const struct progress *progress) {
    return progress->mode != PROGRESS_NONE;
}

/* Ten times a second is smooth; lines are for logs: the first after ten seconds, then one whenever the time has grown
 * by a tenth. */
static double pause_of(const struct progress *progress, double now) {
    switch (progress->mode) {
    case PROGRESS_BAR:
        return 0.1;
    case PROGRESS_JSON:
        return 0.2;
    case PROGRESS_LINES:
        return fmax(10, 0.1 * (now - progress->begun));
    case PROGRESS_AUTO:
    case PROGRESS_NONE:
        break;
    }
    return HUGE_VAL;
}

void progress_update(struct progress *progress, uint32_t done, uint32_t count,
                     const struct progress_estimate *progress_estimate) {
    double now = progress_clock();
    bool first = progress->mode == PROGRESS_JSON && !progress->known && progress_estimate_share(progress_estimate) >= 0;
    if (!progress->name || progress->elsewhere || (now - progress->shown < pause_of(progress, now) && !first) ||
        !text_stderr_is_ready())
        return;
    progress->known = progress->known || first;
    struct state state = state_of(progress, now, done, count, progress_estimate);
    progress->shown = now;
    if (progress->mode == PROGRESS_BAR)
        draw_bar(progress, &state);
    else if (progress->mode == PROGRESS_LINES)
        print_line(progress, &state);
    else
        print_json(progress, count > 0 ? "render" : "build", &state);
}

bool progress_script_line(struct progress *progress, const char *script, bool runs, char *line, size_t size) {
    double now = progress_clock();
    char elapsed[48];
    if (!runs || progress->mode != PROGRESS_BAR) {
        progress->script_since = 0;
        return false;
    }
    if (progress->script_since == 0) {
        progress->script_since = now;
        progress->script_next = 2;
    }
    if (now - progress->script_since < progress->script_next)
        return false;
    text_duration(progress->script_next, elapsed, sizeof elapsed);
    (void)snprintf(line, size, "gray: notice: %s is still running after %s (Ctrl-C ends it)", script, elapsed);
    progress->script_next *= 2;
    return true;
}

void progress_end(struct progress *progress, enum progress_end how) {
    if (!progress->name)
        return;
    double elapsed = progress_clock() - progress->begun;
    progress_hide(progress);
    if (progress->mode == PROGRESS_JSON)
        print_json(progress, how == PROGRESS_WRITTEN ? "written" : "given up", &(struct state){elapsed, -1, -1, 0, 0});
    bool reported = (progress->mode == PROGRESS_BAR && !progress->elsewhere) ||
                    (progress->mode == PROGRESS_LINES && progress->printed);
    if (reported && how == PROGRESS_WRITTEN) {
        char line[4096 + 64];
        (void)snprintf(line, sizeof line, "%s  %u x %u  %.1f s", progress->name, progress->width, progress->height,
                       elapsed);
        begin_line(progress);
        text_print_scene_line(stderr, line);
    }
    progress->name = NULL;
}
