/* The supervisor starts the programs, never the process that runs scenes. The arguments are fixed: one thread, and no
 * times or versions in the file, so that its bytes can be compared. Odd sides are padded by one pixel, because both
 * formats have half the resolution for colour. */
#define _GNU_SOURCE
#include "output/tool_internal.h"

#include "base/fault.h"
#include "base/file.h"
#include "base/mem.h"
#include "image/float_write.h"
#include "image/image.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/close_range.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* --- programs --- */

struct tool {
    const char *purpose;                    /* begins its messages */
    char *const *arguments;                 /* the name of the program first; NULL after the last one */
    const char *folder;                     /* its working directory */
    int input;                              /* its standard input; -1: empty */
    const struct file_interrupt *interrupt; /* or NULL */
};

/* It inherits no descriptor from 3 on. */
static int leave_others(posix_spawn_file_actions_t *actions) {
#if defined(__GLIBC__)
    return posix_spawn_file_actions_addclosefrom_np(actions, 3);
#else
    (void)actions;
    return syscall(SYS_close_range, 3u, ~0u, CLOSE_RANGE_CLOEXEC) == 0 ? 0 : errno;
#endif
}

static int describe(const struct tool *tool, posix_spawn_file_actions_t *actions) {
    int failure = posix_spawn_file_actions_addchdir_np(actions, tool->folder);
    if (failure == 0 && tool->input >= 0)
        failure = posix_spawn_file_actions_adddup2(actions, tool->input, STDIN_FILENO);
    for (int descriptor = tool->input >= 0; descriptor <= 2 && failure == 0; descriptor++)
        failure = posix_spawn_file_actions_addopen(actions, descriptor, "/dev/null", O_RDWR, 0);
    return failure ? failure : leave_others(actions);
}

/* Its output is discarded, and signals have their default actions. PATH is that of the user; a relative entry refers to
 * the new folder, which contains no program. Errors: it is not on PATH, it cannot be started. */
static bool start(const struct tool *tool, pid_t *child, struct error *error) {
    const char *name = tool->arguments[0];
    posix_spawn_file_actions_t actions;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return error_no_memory(error, name);
    posix_spawnattr_t attributes;
    sigset_t none, all;
    if (posix_spawnattr_init(&attributes) != 0) {
        (void)posix_spawn_file_actions_destroy(&actions);
        return error_no_memory(error, name);
    }
    /* The child has no signal blocked or ignored. */
    (void)sigemptyset(&none);
    (void)sigfillset(&all);
    (void)posix_spawnattr_setsigmask(&attributes, &none);
    (void)posix_spawnattr_setsigdefault(&attributes, &all);
    (void)posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    int failure = describe(tool, &actions);
    if (failure == 0)
        failure = posix_spawnp(child, name, &actions, &attributes, tool->arguments, environ);
    (void)posix_spawn_file_actions_destroy(&actions);
    (void)posix_spawnattr_destroy(&attributes);
    if (failure == ENOENT)
        return error_set(error, ERROR_MACHINE, "%.600s: there is no program %s on PATH", tool->purpose, name);
    return failure == 0 ||
           error_set(error, ERROR_MACHINE, "%.600s: %s cannot be started: %s", tool->purpose, name, strerror(failure));
}

/* Waits until it ends; after an interrupt it is killed. Errors: it failed, interrupted. */
static bool wait_for(const struct tool *tool, pid_t child, struct error *error) {
    const char *name = tool->arguments[0];
    int status = 0;
    bool stopped = false;
    for (pid_t ended = 0; ended != child;) {
        ended = waitpid(child, &status, stopped ? 0 : WNOHANG);
        if (ended < 0 && errno != EINTR)
            return error_set(error, ERROR_MACHINE, "%.600s: %s: %s", tool->purpose, name, strerror(errno));
        stopped = stopped || (ended == 0 && file_interrupted(tool->interrupt, 5));
        if (stopped && ended != child)
            (void)kill(child, SIGKILL);
    }
    if (stopped)
        return error_set(error, ERROR_CANCELLED, "%.600s: interrupted", tool->purpose);
    if (WIFSIGNALED(status))
        return error_set(error, ERROR_MACHINE, "%.600s: %s was ended by signal %d", tool->purpose, name,
                         WTERMSIG(status));
    return WEXITSTATUS(status) == 0 ||
           error_set(error, ERROR_MACHINE, "%.600s: %s failed (status %d)", tool->purpose, name, WEXITSTATUS(status));
}

/* --- ffmpeg --- */

#define WORD(text) ((char[]){text})
#define INPUT                                                                                                          \
    WORD("ffmpeg"), WORD("-nostdin"), WORD("-v"), WORD("error"), WORD("-threads"), WORD("1"), WORD("-f"),              \
        WORD("yuv4mpegpipe"), WORD("-i"), WORD("pipe:0"), WORD("-vf"),                                                 \
        WORD("pad=ceil(iw/2)*2:ceil(ih/2)*2,format=yuv420p"), WORD("-threads"), WORD("1"), WORD("-fflags"),            \
        WORD("+bitexact"), WORD("-flags:v"), WORD("+bitexact"), WORD("-map_metadata"), WORD("-1"),                     \
        WORD("-color_range"), WORD("tv"), WORD("-colorspace"), WORD("smpte170m"), WORD("-color_primaries"),            \
        WORD("bt709"), WORD("-color_trc"), WORD("bt709")

static char *const mp4_arguments[] = {INPUT,      WORD("-c:v"),      WORD("libx264"),    WORD("-crf"),
                                      WORD("18"), WORD("-movflags"), WORD("+faststart"), WORD("video.mp4"),
                                      NULL};
static char *const webm_arguments[] = {INPUT,        WORD("-c:v"), WORD("libvpx-vp9"), WORD("-crf"), WORD("24"),
                                       WORD("-b:v"), WORD("0"),    WORD("video.webm"), NULL};

static bool send(int pipe, const uint8_t *bytes, size_t size) {
    while (size > 0) {
        ssize_t sent = MAY_FAIL(write(pipe, bytes, size));
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return false;
        bytes += sent;
        size -= (size_t)sent;
    }
    return true;
}

/* Whether the program has taken all frames; an error only for frames that cannot be read. */
static bool send_frames(int pipe, const struct animation_source *source, bool *taken, struct error *error) {
    size_t pixels = (size_t)source->width * source->height;
    char head[Y4M_HEAD_SIZE];
    uint8_t *rgb = mem_alloc(3 * pixels), *frame = mem_alloc(Y4M_FRAME_HEAD + 3 * pixels);
    bool ok = (rgb && frame) || error_no_memory(error, "a frame");
    *taken = ok && send(pipe, (const uint8_t *)head, y4m_head(source, head));
    for (uint32_t index = 0; ok && *taken && index < source->count; index++) {
        ok = source->frame(source->context, index, rgb, error);
        if (ok)
            y4m_frame(rgb, pixels, frame);
        *taken = ok && send(pipe, frame, Y4M_FRAME_HEAD + 3 * pixels);
    }
    mem_free(rgb);
    mem_free(frame);
    return ok;
}

static bool copy_file(const char *from, const struct file_target *target, struct error *error) {
    enum { PIECE = 1 << 16 };
    struct file_source source;
    struct file_output output;
    uint8_t *piece = mem_alloc(PIECE);
    if (!piece)
        return error_no_memory(error, target->path);
    if (!file_source_open(&source, from, error) || !file_output_open(&output, target, error)) {
        file_source_close(&source);
        mem_free(piece);
        return false;
    }
    /* In pieces, because films are larger than memory should be. */
    bool ok = true;
    for (uint64_t at = 0; ok && at < source.size; at += PIECE) {
        size_t size = source.size - at < PIECE ? (size_t)(source.size - at) : PIECE;
        ok = file_source_read(&source, at, piece, size) ||
             error_set(error, ERROR_MACHINE, "%.600s: the file of ffmpeg cannot be read", target->path);
        ok = ok && file_output_write(&output, piece, size, error);
    }
    file_source_close(&source);
    mem_free(piece);
    if (ok)
        return file_output_commit(&output, error);
    file_output_abandon(&output);
    return false;
}

static bool encode(const struct tool *program, const struct animation_source *source, struct error *error) {
    struct tool tool = *program;
    int ends[2];
    pid_t child = 0;
    bool taken = false;
    if (MAY_FAIL(pipe2(ends, O_CLOEXEC)) != 0)
        return error_set(error, ERROR_MACHINE, "%.600s: %s", tool.purpose, strerror(errno));
    tool.input = ends[0];
    bool started = start(&tool, &child, error);
    (void)close(ends[0]);
    bool sent = started && send_frames(ends[1], source, &taken, error);
    (void)close(ends[1]);
    struct error failure;
    if (!started)
        return false;
    if (!sent)
        (void)kill(child, SIGKILL);
    bool ended = wait_for(&tool, child, sent ? error : &failure);
    return sent && ended &&
           (taken || error_set(error, ERROR_MACHINE, "%.600s: ffmpeg has not read all frames", tool.purpose));
}

bool encoder_write(const struct file_target *target, const struct animation_source *source,
                   enum animation_format format, struct error *error) {
    char folder[FILE_NAME_SIZE], file[FILE_NAME_SIZE + 16];
    bool webm = format == ANIMATION_WEBM;
    if (!file_make_temporary_folder(folder, sizeof folder, error))
        return false;
    const struct tool tool = {target->path, webm ? webm_arguments : mp4_arguments, folder, -1,
                              target->rules ? target->rules->interrupt : NULL};
    (void)snprintf(file, sizeof file, "%s/video.%s", folder, webm ? "webm" : "mp4");
    bool ok = encode(&tool, source, error) && copy_file(file, target, error);
    file_remove_temporary_folder(folder);
    return ok;
}

/* --- oidnDenoise --- */

static char *const oidn_arguments[] = {WORD("oidnDenoise"),  WORD("--hdr"), WORD("colour.pfm"), WORD("--alb"),
                                       WORD("albedo.pfm"),   WORD("--nrm"), WORD("normal.pfm"), WORD("-o"),
                                       WORD("denoised.pfm"), NULL};

enum input { INPUT_COLOUR, INPUT_ALBEDO, INPUT_NORMAL, INPUTS };
static const char *const input_names[INPUTS] = {"colour.pfm", "albedo.pfm", "normal.pfm"};

struct input_rows {
    const struct denoise_source *source;
    struct denoise_pixel *row;
    enum input input;
};

static float value_of(const struct denoise_pixel *pixel, enum input input, int channel) {
    static const int first[] = {[INPUT_ALBEDO] = DENOISE_ALBEDO, [INPUT_NORMAL] = DENOISE_NORMAL};
    float of_half[2];
    for (int h = 0; h < 2; h++)
        of_half[h] = input == INPUT_COLOUR ? pixel->colour[h][channel] : pixel->features[h][first[input] + channel];
    return pixel->share * of_half[0] + (1 - pixel->share) * of_half[1];
}

static void input_row(void *context, uint32_t y, float *line) {
    struct input_rows *rows = context;
    rows->source->row(rows->source->context, y, rows->row);
    for (uint32_t x = 0; x < rows->source->width; x++)
        for (int c = 0; c < 3; c++)
            line[3 * x + (uint32_t)c] = value_of(&rows->row[x], rows->input, c);
}

enum { PATH_LIMIT = 4096 };

static bool join(const char *folder, const char *name, char out[PATH_LIMIT], struct error *error) {
    return snprintf(out, PATH_LIMIT, "%s/%s", folder, name) < PATH_LIMIT ||
           error_set(error, ERROR_MACHINE, "%.200s...: the name of the temporary folder is too long", folder);
}

static bool write_inputs(const struct denoise_source *source, const char *folder, struct error *error) {
    struct input_rows rows = {.source = source, .row = mem_alloc_zero(source->width, sizeof *rows.row)};
    bool ok = rows.row || error_no_memory(error, "a picture that is denoised");
    for (int i = 0; i < INPUTS && ok; i++) {
        char path[PATH_LIMIT];
        const struct file_target target = {.path = path};
        rows.input = (enum input)i;
        ok = join(folder, input_names[i], path, error) &&
             pfm_write(&target, source->width, source->height, input_row, &rows, error);
    }
    mem_free(rows.row);
    return ok;
}

static bool read_output(const struct denoise_source *source, const char *folder, float (*out)[3], struct error *error) {
    char path[PATH_LIMIT];
    struct error reason = {0};
    if (!join(folder, "denoised.pfm", path, error))
        return false;
    struct image *image = image_read(path, &reason);
    /* Out of memory is said as it is; a file that is no picture is the fault of the program. */
    if (!image && reason.kind == ERROR_MACHINE) {
        *error = reason;
        return false;
    }
    if (!image)
        return error_set(error, ERROR_MACHINE, "--denoise=oidn: oidnDenoise wrote no PFM file that gray can read");
    uint32_t width = image_width(image), height = image_height(image);
    bool fits = width == source->width && height == source->height;
    for (uint32_t y = 0; y < height && fits; y++) {
        for (uint32_t x = 0; x < width; x++) {
            struct rgba texel = image_texel(image, x, y);
            float *rgb = out[(size_t)y * width + x];
            rgb[0] = (float)texel.r;
            rgb[1] = (float)texel.g;
            rgb[2] = (float)texel.b;
        }
    }
    image_release(image);
    return fits || error_set(error, ERROR_MACHINE,
                             "--denoise=oidn: oidnDenoise made a picture of %u x %u pixels instead of %u x %u", width,
                             height, source->width, source->height);
}

bool oidn_run(const struct denoise_source *source, const struct file_interrupt *interrupt, float (*out)[3],
              struct error *error) {
    char folder[PATH_LIMIT];
    if (!file_make_temporary_folder(folder, sizeof folder, error))
        return false;
    const struct tool tool = {"--denoise=oidn", oidn_arguments, folder, -1, interrupt};
    pid_t child = 0;
    bool ok = write_inputs(source, folder, error) && start(&tool, &child, error) && wait_for(&tool, child, error) &&
              read_output(source, folder, out, error);
    file_remove_temporary_folder(folder);
    return ok;
}
