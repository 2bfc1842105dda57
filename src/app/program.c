/* The command line is read, and each action is handed on to its room. */
#define _GNU_SOURCE
#include "app/program.h"

#include "accel/isa.h"
#include "app/merge.h"
#include "app/options.h"
#include "app/supervisor.h"
#include "app/text.h"
#include "base/arena.h"
#include "base/file.h"
#include "base/version.h"
#include "formats/font.h"
#include "formats/model.h"
#include "image/exr.h"
#include "image/jpeg_read.h"
#include "script/script.h"

#include <lua.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The Lua library: $GRAY_LUA, else beside the program as it was installed (PREFIX/bin/gray and PREFIX/share/gray/lua),
 * else above it in the source tree (build/release/gray and lua). NULL when there is none. */
static const char *find_library(struct arena *arena) {
    static const char *const places[] = {"../share/gray/lua", "lua", "../lua", "../../lua"};
    char program[4096], folder[4096];
    const char *given = getenv("GRAY_LUA");
    if (given && given[0] != '\0')
        return file_canonical(given, folder, sizeof folder) ? arena_format(arena, "%s", folder) : NULL;
    if (!file_canonical("/proc/self/exe", program, sizeof program))
        return NULL;
    char *slash = strrchr(program, '/');
    if (!slash)
        return NULL;
    *slash = '\0';
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        const char *probe = arena_format(arena, "%s/%s/readobj.lua", program, places[i]);
        const char *candidate = arena_format(arena, "%s/%s", program, places[i]);
        if (probe && candidate && file_is_regular(probe) && file_canonical(candidate, folder, sizeof folder))
            return arena_format(arena, "%s", folder);
    }
    return NULL;
}

static void print_version(void) {
    (void)printf("gray %s\n%s\nlibpng %s\noptional: JPEG pictures by %s, glTF by %s, fonts by %s, EXR pictures by %s\n",
                 GRAY_VERSION, LUA_RELEASE, png_get_libpng_ver(NULL), jpeg_library(), gltf_library(), font_library(),
                 exr_library());
}

/* Text that the script layer makes of its table. */
static int print_document(const char *text) {
    if (!text) {
        (void)fputs("gray: out of memory for the text\n", stderr);
        return ERROR_MACHINE;
    }
    (void)fputs(text, stdout);
    return 0;
}

/* Where more than one process makes a picture, only the first one talks and keeps. */
static void help_only(struct options *options) {
    options->checkpoint = NULL;
    options->resume = false;
    options->statistics = STATISTICS_NONE;
    options->progress = PROGRESS_NONE;
}

static int render(struct options *options, const struct farm_transport *transport) {
    if (options->no_fork)
        return supervisor_run_without_fork(options);
    if (transport && transport->rank > 0)
        help_only(options);
    return supervisor_run(options, transport);
}

static int act(struct options *options, const struct farm_transport *transport, struct arena *arena) {
    switch (options->action) {
    case ACTION_HELP:
        options_print_help(stdout);
        return 0;
    case ACTION_MANUAL:
        options_print_help(stdout);
        (void)fputc('\n', stdout);
        return print_document(script_manual(arena));
    case ACTION_ANNOTATIONS:
        return print_document(script_annotations(arena));
    case ACTION_VERSION:
        print_version();
        return 0;
    case ACTION_MERGE:
        return merge_run(options);
    case ACTION_RENDER:
        break;
    }
    if (!accel_select_isa(options_isa_name(options))) {
        (void)fprintf(stderr, "gray: --isa %s: this processor does not have it\n", options_isa_name(options));
        return ERROR_USAGE;
    }
    options->script.library_folder = find_library(arena);
    return render(options, transport);
}

/* The program with MPI is one of its own beside this one, so that those who do not use it do not load it. */
static int become_mpi_program(char **argv) {
    char program[4096];
    size_t length = 0;
    if (file_canonical("/proc/self/exe", program, sizeof program - 8))
        length = strlen(program);
    memcpy(program + length, "-mpi", 5);
    (void)fflush(NULL);
    (void)execv(program, argv);
    (void)fprintf(stderr,
                  "gray: --mpi: %s is not there; it is built where pkg-config finds ompi-c (Debian: "
                  "libopenmpi-dev)\n",
                  length ? program : "the program with MPI");
    return ERROR_USAGE;
}

int program_run(int argc, char **argv, const struct farm_transport *transport) {
    struct arena arena = {0};
    struct options options;
    struct error error;
    int status;
    if (!options_parse(&options, argc, argv, &arena, &error)) {
        char line[sizeof error.text + 16];
        (void)snprintf(line, sizeof line, "gray: %s", error.text);
        text_print_line(stderr, line);
        if (error.kind == ERROR_USAGE)
            (void)fputs("usage: gray [options] [--] scene.lua ...; gray --help tells all options\n", stderr);
        status = (int)error.kind;
    } else if (options.mpi && options.action == ACTION_RENDER && !transport) {
        status = become_mpi_program(argv);
    } else {
        status = act(&options, options.mpi ? transport : NULL, &arena);
    }
    /* A full disk shows here when text was asked for. */
    if (fflush(stdout) != 0 && status == 0) {
        (void)fputs("gray: standard output cannot be written\n", stderr);
        status = ERROR_MACHINE;
    }
    arena_destroy(&arena);
    return status;
}
