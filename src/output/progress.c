/* The remaining time is the estimate for rendering (render/time_estimate.h) plus a usual time for denoising and
 * writing. The bar is erased with blanks, not with escape sequences, so that any terminal shows it. */
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

/* Seconds of one core for a pixel: of a PNG file, which is written after the last tile; of a film that is denoised. */
static const double usual_writing = 5e-8, usual_denoising = 4e-6;

void progress_init(struct progress *progress, enum progress_mode mode, bool quiet, int threads) {
    if (mode == PROGRESS_AUTO)
        mode = quiet ? PROGRESS_NONE : isatty(STDERR_FILENO) ? PROGRESS_BAR : PROGRESS_LINES;
    *progress = (struct progress){.mode = mode, .threads = threads > 0 ? threads : (int)sysconf(_SC_NPROCESSORS_ONLN)};
}

void progress_hide(struct progress *progress) {
    if (progress->columns == 0)
        return;
    (void)fprintf(standard_error(), "\r%*s\r", progress->columns, "");
    progress->columns = 0;
}

/* One column less than the terminal has: a full line would be broken. */
static int terminal_columns(void) {
    struct winsize size;
    int columns = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1 ? size.ws_col - 1 : 79;
    return columns < COLUMNS_LIMIT ? columns : COLUMNS_LIMIT - 1;
}

/* Without an estimate, tiles are counted: the share and the time left stay unknown, which is negative. */
struct state {
    double elapsed, share, left;
    uint32_t done, count;
    bool counts;   /* tiles */
    double unshot; /* share of the light of radiosity; 0: none is computed */
};

static void add_estimate(struct progress *progress, struct state *state, const struct progress_estimate *estimate,
                         double now) {
    state->share = progress_estimate_share(estimate);
    state->left = progress_estimate_left(estimate, now);
    if (!(state->share > 0) || state->left < 0)
        return;
    double whole = state->elapsed + state->left, last = progress->writing;
    state->share = progress->share = math_max(progress->share, state->share * whole / (whole + last));
    state->left += last;
}

/* "43 %  2 min 8 s, about 2 min 46 s left", of a farm "12 of 300 tiles  2 min 8 s"; on a line "43 % after 2 min 8
 * s". Radiosity: "40 % of the light is not yet shot". */
static void describe(const struct state *state, bool line, char out[160]) {
    char elapsed[48], left[48], rest[64] = "";
    const char *after = line ? " after " : "  ";
    text_duration(state->elapsed, elapsed, sizeof elapsed);
    text_duration(math_max(state->left, 0), left, sizeof left);
    if (state->left >= 0 && (line || state->elapsed > 1))
        (void)snprintf(rest, sizeof rest, ", about %s left", left);
    if (state->count == 0 && state->unshot > 0)
        (void)snprintf(out, 160, "%.3g %% of the light is not yet shot%s%s", 100 * state->unshot, after, elapsed);
    else if (state->count == 0)
        (void)snprintf(out, 160, "building the scene%s%s", line ? ", " : "  ", elapsed);
    else if (state->counts)
        (void)snprintf(out, 160, "%u of %u tiles%s%s", state->done, state->count, after, elapsed);
    else
        (void)snprintf(out, 160, "%*.0f %%%s%s%s", line ? 0 : 3, 100 * math_max(state->share, 0), after, elapsed, rest);
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

static void draw_bar(struct progress *progress, const struct state *state, const char *text) {
    char cells[BAR_CELLS + 1], line[4 * COLUMNS_LIMIT], name[64];
    double share =
        state->counts ? math_min((double)state->done / math_max(state->count, 1), 1) : math_max(state->share, 0);
    /* In a narrow terminal the remaining time is more useful than a long bar. */
    int limit = terminal_columns(), bar = limit < 78 ? BAR_CELLS / 3 : BAR_CELLS;
    memset(cells, '.', (size_t)bar);
    memset(cells, '#', (size_t)(share * bar));
    cells[bar] = '\0';
    short_name(progress->name, limit < 78 ? 14 : 30, name, sizeof name);
    if (state->count > 0)
        (void)snprintf(line, sizeof line, "%s [%s] %s", name, cells, text);
    else
        (void)snprintf(line, sizeof line, "%s: %s", name, text);
    int columns = (int)strlen(line) < limit ? (int)strlen(line) : limit;
    error_stream_begin_line(progress->stream);
    (void)fprintf(standard_error(), "\r%-*.*s", columns > progress->columns ? columns : progress->columns, columns,
                  line);
    (void)fflush(standard_error());
    progress->columns = columns;
}

static void print_line(const struct progress *progress, const char *after_name, const char *text) {
    char line[4096 + 160];
    (void)snprintf(line, sizeof line, "%s%s%s", progress->name, after_name, text);
    error_stream_begin_line(progress->stream);
    text_print_scene_line(standard_error(), line);
}

static void print_json(const struct progress *progress, const char *event, const struct state *state) {
    error_stream_begin_line(progress->stream);
    (void)fputs("{\"picture\":", standard_error());
    text_print_json(standard_error(), progress->name);
    (void)fprintf(standard_error(),
                  ",\"event\":\"%s\",\"width\":%u,\"height\":%u,\"tiles_done\":%u,\"tiles\":%u,\"seconds\":%.3f", event,
                  progress->width, progress->height, state->done, state->count, state->elapsed);
    if (state->share >= 0)
        (void)fprintf(standard_error(), ",\"share\":%.4f", state->share);
    if (state->unshot > 0)
        (void)fprintf(standard_error(), ",\"unshot\":%.4f", state->unshot);
    if (state->left >= 0)
        (void)fprintf(standard_error(), ",\"left\":%.3f", state->left);
    (void)fprintf(standard_error(), ",\"processor\":%.4f}\n", clock_seconds(CLOCK_PROCESS_CPUTIME_ID));
    (void)fflush(standard_error());
}

void progress_begin(struct progress *progress, const char *name, uint32_t width, uint32_t height, double denoised) {
    progress->name = name;
    progress->printed = progress->known = progress->elsewhere = false;
    progress->share = 0;
    progress->writing = (usual_writing + usual_denoising * denoised) * width * height / progress->threads;
    progress->width = width;
    progress->height = height;
    progress->begun = progress->shown = clock_now();
    if (progress->mode == PROGRESS_JSON)
        print_json(progress, "begin", &(struct state){.share = -1, .left = -1});
}

/* Seconds between two reports. Ten times a second is smooth; lines are for logs: the first after ten seconds, then one
 * whenever the time has grown by a tenth. */
static const double pauses[] = {
    [PROGRESS_NONE] = HUGE_VAL, [PROGRESS_BAR] = 0.1, [PROGRESS_LINES] = 10, [PROGRESS_JSON] = 0.2};

static double pause_of(const struct progress *progress, double now) {
    return math_max(pauses[progress->mode], progress->mode == PROGRESS_LINES ? 0.1 * (now - progress->begun) : 0);
}

void progress_update(struct progress *progress, uint32_t done, uint32_t count,
                     const struct progress_estimate *estimate) {
    double now = clock_now();
    bool first = progress->mode == PROGRESS_JSON && !progress->known && progress_estimate_share(estimate) >= 0;
    if (!progress->name || progress->elsewhere || (now - progress->shown < pause_of(progress, now) && !first) ||
        !text_stderr_is_ready())
        return;
    char text[160];
    struct state state = {now - progress->begun, -1, -1, done, count, !estimate->wanted, progress->unshot};
    if (count > 0 && estimate->wanted)
        add_estimate(progress, &state, estimate, now);
    describe(&state, progress->mode == PROGRESS_LINES, text);
    if (progress->mode == PROGRESS_BAR)
        draw_bar(progress, &state, text);
    else if (progress->mode == PROGRESS_LINES)
        print_line(progress, ": ", text);
    else
        print_json(progress, count > 0 ? "render" : "build", &state);
    progress->known = progress->known || first;
    progress->printed = true;
    progress->shown = now;
}

bool progress_script_line(struct progress *progress, const char *script, bool runs, char *line, size_t size) {
    double now = clock_now();
    char elapsed[48];
    runs = runs && progress->mode == PROGRESS_BAR;
    if (!runs || progress->script_since == 0) {
        progress->script_since = runs ? now : 0;
        progress->script_next = 2;
    }
    if (!runs || now - progress->script_since < progress->script_next)
        return false;
    text_duration(progress->script_next, elapsed, sizeof elapsed);
    (void)snprintf(line, size, "gray: notice: %s is still running after %s (Ctrl-C ends it)", script, elapsed);
    progress->script_next *= 2;
    return true;
}

void progress_end(struct progress *progress, enum progress_end how) {
    if (!progress->name)
        return;
    double elapsed = clock_now() - progress->begun;
    progress_hide(progress);
    if (progress->mode == PROGRESS_JSON)
        print_json(progress, how == PROGRESS_WRITTEN ? "written" : "given up",
                   &(struct state){elapsed, .share = -1, .left = -1});
    if (how == PROGRESS_WRITTEN && ((progress->mode == PROGRESS_BAR && !progress->elsewhere) ||
                                    (progress->mode == PROGRESS_LINES && progress->printed))) {
        char text[64];
        (void)snprintf(text, sizeof text, "%u x %u  %.1f s", progress->width, progress->height, elapsed);
        print_line(progress, "  ", text);
    }
    progress->name = NULL;
}
