/* The whole program behind its main functions: reads the command line and calls the module of each action. Tests have a
 * main function of their own, so they are linked without this file. */
#define _GNU_SOURCE
#include "host/program.h"

#include "base/arena.h"
#include "base/file.h"
#include "base/isa.h"
#include "base/version.h"
#include "formats/font.h"
#include "formats/json_text.h"
#include "formats/model.h"
#include "host/completion.h"
#include "host/first_scene.h"
#include "host/in_process.h"
#include "host/manual.h"
#include "host/supervisor.h"
#include "host/view_window.h"
#include "image/animation.h"
#include "image/exr.h"
#include "image/jpeg_read.h"
#include "output/compare.h"
#include "output/merge.h"
#include "output/picture_files.h"
#include "output/view.h"
#include "session/options.h"
#include "session/options_table.h"
#include "session/text.h"

#include <errno.h>
#include <lua.h>
#include <png.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The Lua library: $GRAY_LUA, else relative to the program as it is installed (PREFIX/bin/gray and
 * PREFIX/share/gray/lua), else above it in the source tree (build/release/gray and lua), else in the tree where it was
 * compiled. NULL when there is none. */
static const char *find_library(struct arena *arena) {
    static const char *const folders[] = {"../share/gray/lua", "lua", "../lua", "../../lua", GRAY_SOURCES "/lua"};
    char program[4096], folder[4096];
    const char *given = getenv("GRAY_LUA");
    if (given && given[0] != '\0')
        return file_canonical(given, folder, sizeof folder) ? arena_format(arena, "%s", folder) : NULL;
    if (!file_canonical("/proc/self/exe", program, sizeof program))
        return NULL;
    char *slash = strrchr(program, '/');
    if (!slash)
        return NULL;
    slash[1] = '\0';
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        const char *base = folders[i][0] == '/' ? "" : program;
        const char *probe = arena_format(arena, "%s%s/readobj.lua", base, folders[i]);
        const char *candidate = arena_format(arena, "%s%s", base, folders[i]);
        if (probe && candidate && file_is_regular(probe) && file_canonical(candidate, folder, sizeof folder))
            return arena_format(arena, "%s", folder);
    }
    return NULL;
}

static void print_version(void) {
#ifdef HAVE_GTK
    static const char window[] = "GTK 4 (gray-gui)";
#else
    static const char window[] = "none";
#endif
#ifdef HAVE_MPI
    static const char farm[] = "MPI (gray-mpi)";
#else
    static const char farm[] = "none";
#endif
    (void)printf("gray %s\n%s\nlibpng %s\noptional: JPEG pictures by %s, glTF by %s, fonts by %s, EXR pictures by %s, "
                 "WebP by %s, "
                 "windows by %s, farms by %s\n",
                 GRAY_VERSION, LUA_RELEASE, png_get_libpng_ver(NULL), jpeg_library(), json_text_library(),
                 font_library(), exr_library(), webp_library(), window, farm);
}

/* If several processes render a picture, only the first one reports and writes files. */
static void disable_output(struct options *options) {
    options->checkpoint = NULL;
    options->resume = false;
    options->statistics = STATISTICS_NONE;
    options->progress = PROGRESS_NONE;
    options->display = NULL;
}

/* The window is there before anything runs: without a scene the user opens one in it. */
static bool open_first(const struct window_driver *window, const struct options *options) {
    bool empty = options->script_count == 0;
    struct error error;
    window->state->has_scene = !empty;
    bool ok = window->open(window->context, &error);
    if (!ok)
        (void)fprintf(stderr, "gray: %s\n", error.text);
    else if (empty)
        window->close(window->context);
    return ok;
}

static int render(struct options *options, const struct program_parts *parts) {
    if (options->no_fork)
        return in_process_run(options);
    if (options->window && !open_first(parts->window, options))
        return ERROR_MACHINE;
    if (options->script_count == 0)
        return 0;
    options->watch = options->watch || (options->window && !options_output_is_stream(options));
    struct program_parts wanted = {.transport = options->mpi ? parts->transport : NULL,
                                   .window = options->window ? parts->window : NULL};
    if (wanted.transport && wanted.transport->rank > 0)
        disable_output(options);
    return supervisor_run(options, &wanted);
}

static bool choose_isa(const struct options *options) {
    const char *name = options_isa_name(options);
    bool chosen = cpu_select_isa(name);
    if (!chosen)
        (void)fprintf(stderr, "gray: --isa %s: this processor does not have it\n", name);
    return chosen;
}

static int perform(struct options *options, const struct program_parts *parts, struct arena *arena) {
    options->script.library_folder = find_library(arena);
    if (options->window && options->script_count == 1 && view_is(options->scripts[0]))
        options->action = ACTION_VIEW;
    switch (options->action) {
    case ACTION_HELP:
    case ACTION_MANUAL:
        return manual_print(options, options->script.library_folder, arena);
    case ACTION_ROFF:
        return manual_print_page(options, arena);
    case ACTION_SCHEMA:
        return manual_print_schema(arena);
    case ACTION_ANNOTATIONS:
        return manual_print_annotations(arena);
    case ACTION_INIT:
        return first_scene_write(options, options->script.library_folder);
    case ACTION_COMPLETE:
        completion_print(options);
        return 0;
    case ACTION_VERSION:
        print_version();
        return 0;
    case ACTION_MERGE:
        return choose_isa(options) ? merge_run(options) : ERROR_USAGE;
    case ACTION_COMPARE:
        return compare_run(options);
    case ACTION_VIEW:
        return options->window ? view_window_run(options, parts->window) : view_run(options);
    case ACTION_RENDER:
        break;
    }
    if (!choose_isa(options))
        return ERROR_USAGE;
    return render(options, parts);
}

/* The programs with MPI and with a window are separate programs beside this one, so that this one does not load their
 * libraries. */
static int exec_variant(const char *which, const char *missing, char **argv) {
    char program[4096];
    size_t length = 0;
    if (file_canonical("/proc/self/exe", program, sizeof program - 8))
        length = strlen(program);
    (void)snprintf(program + length, sizeof program - length, "-%s", which);
    (void)fflush(NULL);
    (void)execv(program, argv);
    (void)fprintf(stderr, "gray: %s: the program %s does not exist; it is built if pkg-config finds %s\n",
                  strcmp(which, "mpi") == 0 ? "--mpi" : "-gui", length ? program : "its program", missing);
    return ERROR_USAGE;
}

int program_run(int argc, char **argv, const struct program_parts *parts) {
    struct arena arena = {0};
    struct options options;
    struct error error;
    int status;
    file_fill_standard();
    /* A closed pipe and a limit on file sizes are write errors and do not end the process. */
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
    if (!options_parse(&options, argc, argv, &arena, &error) || !picture_files_check_output(&options, &error)) {
        status = text_print_error(&error);
        if (error.kind == ERROR_USAGE)
            (void)fputs("usage: gray [options] [--] scene.lua|model.glb ...; gray --help lists all options\n", stderr);
    } else if (options.mpi && options.action == ACTION_RENDER && !parts->transport) {
        status = exec_variant("mpi", "ompi-c (Debian: libopenmpi-dev)", argv);
    } else if (options.window && !parts->window && (options.action == ACTION_RENDER || options.action == ACTION_VIEW)) {
        status = exec_variant("gui", "gtk4 (Debian: libgtk-4-dev; tools/setup.sh --window)", argv);
    } else {
        status = perform(&options, parts, &arena);
    }
    /* Detects a full disk after text output; rendering has already checked it. A reader may have enough of a text. */
    if (options.action != ACTION_RENDER && (fflush(stdout) != 0 || ferror(stdout))) {
        if (errno != EPIPE)
            (void)fputs("gray: standard output cannot be written\n", stderr);
        status = ERROR_MACHINE;
    }
    arena_destroy(&arena);
    return status;
}

/* gray itself. main_gui.c and main_mpi.c replace this function in gray-gui and gray-mpi. */
__attribute__((weak)) int main(int argc, char **argv) {
    return program_run(argc, argv, &(struct program_parts){0});
}
