/* The table of options, and --help, which prints it in this order. options_digest uses its groups. */
#include "session/options_internal.h"

#include "base/isa.h"
#include "render/aov.h"

#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#define FIELD(name) offsetof(struct options, name), sizeof(((struct options *)NULL)->name)
#define NO_FIELD 0, 0
#define NO_RANGE 0, 0
/* The first choice is the best set that the processor has. */
#define ISA_CHOICES "auto" CPU_ISAS(LIST_BAR_WORD)
#define LAYER_NAME(aov, name, channels) " " name ","
#define SIZES 0x1p10, 0x1p50 /* 1 KiB to 1 PiB */

const char *const option_group_titles[OPTION_GROUP_COUNT] = {
    [OPTION_GROUP_PICTURE] = "Anti-aliasing and rays",
    [OPTION_GROUP_SHADING] = "Size, acceleration and colour",
    [OPTION_GROUP_FINISH] = "Styles and finishing",
    [OPTION_GROUP_FILES] = "Files",
    [OPTION_GROUP_FRAMES] = "Animation",
    [OPTION_GROUP_COMPATIBILITY] = "Scenes written for other programs",
    [OPTION_GROUP_SANDBOX] = "Sandbox",
    [OPTION_GROUP_RUN] = "Execution",
    [OPTION_GROUP_PARTS] = "Long runs and many machines",
    [OPTION_GROUP_REPORTS] = "Display and messages",
};

const struct option option_table[] = {
    {OPTION_GROUP_PICTURE, "--integrator", OPTION_CHOICE, LIST_BARS(INTEGRATORS), NO_RANGE, FIELD(settings.integrator),
     "whitted", "the algorithm that computes light"},
    {OPTION_GROUP_PICTURE, "-ss", OPTION_INTEGER, "N", 1, 64, FIELD(settings.samples), "3",
     "N x N samples for a marked pixel"},
    {OPTION_GROUP_PICTURE, "-full", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.full), NULL,
     "N x N samples for every pixel, not only for marked ones"},
    {OPTION_GROUP_PICTURE, "-side-tolerance", OPTION_NUMBER, "X", 0, HUGE_VAL, FIELD(settings.side_tolerance), "0.005",
     "a pixel is marked when the squared RGB distance to a side neighbour exceeds X"},
    {OPTION_GROUP_PICTURE, "-corner-tolerance", OPTION_NUMBER, "X", 0, HUGE_VAL, FIELD(settings.corner_tolerance),
     "0.01", "the same for the corner neighbours"},
    {OPTION_GROUP_PICTURE, "-reflect-limit", OPTION_INTEGER, "N", 0, 1000, FIELD(settings.reflect_limit), "2",
     "how often a path may reflect"},
    {OPTION_GROUP_PICTURE, "-refract-limit", OPTION_INTEGER, "N", 0, 1000, FIELD(settings.refract_limit), "4",
     "how often a path may refract"},
    {OPTION_GROUP_PICTURE, "-use-tir", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.use_tir), NULL,
     "at total internal reflection, add the refracted amount to the reflected one; without it, that light is lost"},
    {OPTION_GROUP_PICTURE, "-al-samples|alsamples", OPTION_INTEGER, "N", 1, 64, FIELD(settings.area_samples), "4",
     "N x N shadow rays for each area light"},
    {OPTION_GROUP_PICTURE, "--caustics", OPTION_INTEGER, "N", 0, PHOTONS_MAX, FIELD(settings.caustics.photons), "0",
     "trace N photons for caustics, the light that glass and mirrors focus; 0: none"},
    {OPTION_GROUP_PICTURE, "--cutoff", OPTION_NUMBER, "X", 0, 1, FIELD(settings.cutoff), "0.0001",
     "do not trace rays that can change a pixel by less than X, where white is 1; 0: trace all rays"},
    {OPTION_GROUP_PICTURE, "--spp", OPTION_INTEGER, "N", 1, PATH_SAMPLES_MAX, FIELD(settings.path_samples), "64",
     "N samples for a pixel, with --integrator path"},
    {OPTION_GROUP_PICTURE, "--max-depth", OPTION_INTEGER, "N", 0, DEPTH_MAX, FIELD(settings.max_depth), "16",
     "a path is scattered at most N times: 0 shows emission only, 1 direct light, 2 one indirect bounce"},
    {OPTION_GROUP_PICTURE, "--roulette-depth", OPTION_INTEGER, "N", 0, DEPTH_MAX, FIELD(settings.roulette_depth), "2",
     "Russian roulette may end a path after N scattering events"},
    {OPTION_GROUP_PICTURE, "--noise", OPTION_NUMBER, "X", 1e-6, 10, FIELD(settings.noise), "all samples",
     "with --integrator path, a tile of 32 x 32 pixels gets samples (at least 16, at most --spp) until its relative "
     "standard error is X"},
    {OPTION_GROUP_PICTURE, "--time-limit", OPTION_NUMBER, "SECONDS", 0.001, 1e9, FIELD(settings.time_limit), "none",
     "with --integrator path, add samples to all pixels for SECONDS and print their number; --spp with this number "
     "makes the same picture"},
    {OPTION_GROUP_PICTURE, "--clamp", OPTION_NUMBER, "X", 0, HUGE_VAL, FIELD(settings.clamp), "0",
     "with --integrator path, no component of a sample is larger than X, 0: no limit; less noise, but the picture "
     "becomes darker than it should be (bias)"},
    {OPTION_GROUP_PICTURE, "--filter", OPTION_CHOICE, LIST_BARS(FILTERS), NO_RANGE, FIELD(settings.filter), "box",
     "reconstruction filter of a pixel"},
    {OPTION_GROUP_PICTURE, "--aa-pattern", OPTION_CHOICE, LIST_BARS(AA_PATTERNS), NO_RANGE, FIELD(settings.aa_pattern),
     "rotated",
     "which pixels are marked, and where their samples are; rotated: marked by colours, surfaces and thin primitives, "
     "samples on a rotated grid; grid: marked by colours only, samples at the centres of N x N cells"},
    {OPTION_GROUP_PICTURE, "--denoise", OPTION_DENOISE, "=gray|oidn|none", NO_RANGE, NO_FIELD, NULL,
     "remove noise, with --integrator path; oidn: by the program oidnDenoise of Open Image Denoise, which must be on "
     "PATH; none: do not remove noise, even if a scene requests it"},
    {OPTION_GROUP_PICTURE, "--seed", OPTION_SEED, "N", NO_RANGE, NO_FIELD, "0",
     "seed of all random numbers, including math.random in scripts"},

    {OPTION_GROUP_PICTURE, "--quick", OPTION_FLAG, NULL, NO_RANGE, FIELD(quick), NULL,
     "draft: one sample per pixel, few shadow rays, no caustics, no depth of field, no motion blur; overrides other "
     "options"},
    {OPTION_GROUP_PICTURE, "--preview", OPTION_FLAG, NULL, NO_RANGE, FIELD(preview), NULL,
     "smaller draft: a quarter of the width and height (unless --size is given), no reflections, no refractions"},

    {OPTION_GROUP_SHADING, "--size", OPTION_SIZE, "WxH", NO_RANGE, NO_FIELD, "the script's",
     "size of the pictures in pixels"},
    {OPTION_GROUP_SHADING, "--crop", OPTION_CROP, "X,Y,W,H", NO_RANGE, NO_FIELD, "all",
     "write a W x H picture, exactly that part of the whole; X,Y is its upper left pixel"},
    {OPTION_GROUP_SHADING, "--accel", OPTION_CHOICE, LIST_BARS(ACCEL_KINDS), NO_RANGE, FIELD(settings.accel), "auto",
     "acceleration structure; the picture is the same"},
    {OPTION_GROUP_SHADING, "--isa", OPTION_CHOICE, ISA_CHOICES, NO_RANGE, FIELD(isa), "auto",
     "instruction set of the kernels; the picture is the same"},

    {OPTION_GROUP_SHADING, "--exposure", OPTION_NUMBER, "STOPS", -100, 100, FIELD(settings.tone.exposure), "0",
     "multiply light by 2^STOPS when a PNG file is written"},
    {OPTION_GROUP_SHADING, "--tone", OPTION_TONE, LIST_BARS(TONE_CURVES), NO_RANGE, FIELD(settings.tone.curve), "none",
     "tone curve that maps bright light into the range of a PNG file; has priority over functions of scenes"},
    {OPTION_GROUP_SHADING, "--srgb", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.tone.srgb), NULL,
     "encode PNG files with the sRGB transfer function; without it, values are linear"},
    {OPTION_GROUP_SHADING, "--colour", OPTION_CHOICE, LIST_BARS(COLOUR_PIPELINES), NO_RANGE, FIELD(settings.colour),
     "auto",
     "linear: decode colour pictures from sRGB and encode PNG files as sRGB; classic: use all numbers unchanged; auto: "
     "linear with --integrator path"},
    {OPTION_GROUP_SHADING, "--deep", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.deep), NULL,
     "16 bits per channel in PNG files"},

    {OPTION_GROUP_FINISH, "--style", OPTION_CHOICE, LIST_BARS(STYLES), NO_RANGE, FIELD(settings.style), "none",
     "pictures that look like drawings, with --integrator whitted; ink: lines on white paper; toon: a few levels of "
     "light; gooch: cool to warm colours"},
    {OPTION_GROUP_FINISH, "--line-width", OPTION_NUMBER, "PIXELS", 0, LINE_WIDTH_MAX, FIELD(settings.line_width),
     "2 with a style, else 0", "width of the lines where objects, normals and depths change"},
    {OPTION_GROUP_FINISH, "--toon-steps", OPTION_INTEGER, "N", 1, TOON_STEPS_MAX, FIELD(settings.toon_steps), "3",
     "number of levels of light of --style toon, not counting shadow"},
    {OPTION_GROUP_FINISH, "--bloom", OPTION_NUMBER, "X", 0, 1, FIELD(settings.finish.bloom), "0",
     "spread light above white to the pixels around it, with the weight X"},
    {OPTION_GROUP_FINISH, "--vignette", OPTION_NUMBER, "X", 0, 1, FIELD(settings.finish.vignette), "0",
     "darken the corners; with X = 1 they have a quarter of their light"},
    {OPTION_GROUP_FINISH, "--gray", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.finish.gray), NULL,
     "a gray picture: the luminance"},
    {OPTION_GROUP_FINISH, "--edges", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.finish.edges), NULL,
     "a picture of the edges of the picture, white on black (Sobel); PNG files only"},
    {OPTION_GROUP_FINISH, "--fxaa", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.finish.fxaa), NULL,
     "smooth the edges of the finished picture (FXAA); PNG files only"},
    {OPTION_GROUP_FINISH, "--dither", OPTION_CHOICE, LIST_BARS(DITHERS), NO_RANGE, FIELD(settings.finish.dither),
     "none", "round to 8 bits by a pattern, which removes bands: ordered, or blue noise; PNG files of 8 bits only"},

    {OPTION_GROUP_FILES, "-o", OPTION_TEXT, "FILE", NO_RANGE, FIELD(output), "the script's",
     "name of the picture: .png, or .pfm, .hdr and .exr for linear light; '-' is standard output; for several "
     "pictures, FILE must contain %d (or %03d, or ####), their number from 1, or it must be an animation: .apng, .gif, "
     ".webp, .y4m, .mp4 or .webm"},
    {OPTION_GROUP_FILES, "--force", OPTION_FLAG, NULL, NO_RANGE, FIELD(force), NULL,
     "let -o FILE replace a file that is not a picture"},
    {OPTION_GROUP_FILES, "-write-aa-targets", OPTION_TEXT, "X", NO_RANGE, FIELD(targets_prefix), NULL,
     "for dir/foo.png also write dir/Xfoo.png: the first pass with the marked pixels in red"},
    {OPTION_GROUP_FILES, "-write-pre-aa", OPTION_TEXT, "X", NO_RANGE, FIELD(first_pass_prefix), NULL,
     "for dir/foo.png also write dir/Xfoo.png: the first pass, one sample for each pixel"},

    {OPTION_GROUP_FILES, "--aov", OPTION_LAYERS, "LIST", NO_RANGE, NO_FIELD, NULL,
     "for dir/foo.png also write dir/foo.NAME.png for each NAME of LIST, separated by commas:" AOVS(
         LAYER_NAME) " or all"},

    {OPTION_GROUP_FILES, "--overlay", OPTION_CHOICE, LIST_BARS(OVERLAYS), NO_RANGE, FIELD(settings.overlay), "none",
     "draw lines over the picture: bounding boxes of all primitives, or the cells of the acceleration structure (see "
     "--accel)"},

    {OPTION_GROUP_FRAMES, "--frames", OPTION_FRAMES, "N|A-B|A-B/STEP", NO_RANGE, FIELD(script.frames.selection), "all",
     "render the frames 1 to N, or A to B, or every STEPth of these; gray runs a script without gr.frames once for "
     "each of them, with the gr.frame, gr.time and gr.clock of the frame"},
    {OPTION_GROUP_FRAMES, "--fps", OPTION_NUMBER, "X", FRAME_RATE_MIN, FRAME_RATE_MAX, FIELD(script.frames.rate),
     "the script's, or 30", "frames per second"},
    {OPTION_GROUP_FRAMES, "--loop", OPTION_FLAG, NULL, NO_RANGE, FIELD(script.frames.loops), NULL,
     "after the last frame comes the first: gr.clock stays below 1, and players repeat the file without end"},
    {OPTION_GROUP_FRAMES, "--turntable", OPTION_INTEGER, "N", 1, FRAMES_MAX, FIELD(script.frames.turntable), NULL,
     "render every picture N times, from a camera that moves once around the scene; implies --loop"},
    {OPTION_GROUP_FRAMES, "--palette", OPTION_CHOICE, "all|frame", NO_RANGE, FIELD(frame_palettes), "all",
     "the 256 colours of a GIF file: one palette for all frames, so that parts without motion do not flicker, or one "
     "for each frame"},
    {OPTION_GROUP_FRAMES, "--keep-frames", OPTION_FLAG, NULL, NO_RANGE, FIELD(keep_frames), NULL,
     "keep the frames of the animation FILE as PNG files in the folder FILE.frames"},
    {OPTION_GROUP_FRAMES, "--contact-sheet", OPTION_FLAG, NULL, NO_RANGE, FIELD(contact_sheet), NULL,
     "for the animation dir/foo.gif also write dir/foo.sheet.png: small pictures of all frames"},

    {OPTION_GROUP_COMPATIBILITY, "--transform-order", OPTION_CHOICE, LIST_BARS(SCRIPT_ORDERS), NO_RANGE,
     FIELD(script.transform_order), "auto",
     "order of transforms; new: in the order in which they are written; old: the last one acts first; separate: scale, "
     "then rotate, then translate; auto: gray decides from the text of the script"},
    {OPTION_GROUP_COMPATIBILITY, "--view", OPTION_CHOICE, "direction|target", NO_RANGE, FIELD(settings.view_is_target),
     "direction", "meaning of the view argument: a direction, or a point to look at"},
    {OPTION_GROUP_COMPATIBILITY, "--pixel-sample", OPTION_CHOICE, "centre|corner", NO_RANGE,
     FIELD(settings.pixel_corner), "centre", "position of the first sample of a pixel"},
    {OPTION_GROUP_COMPATIBILITY, "--specular", OPTION_CHOICE, LIST_BARS(SPECULAR_KINDS), NO_RANGE,
     FIELD(settings.specular), "phong", "formula of the highlight"},
    {OPTION_GROUP_COMPATIBILITY, "--ambient", OPTION_CHOICE, "kd|plain", NO_RANGE, FIELD(settings.ambient_plain), "kd",
     "multiply ambient light by kd, or add it unchanged"},
    {OPTION_GROUP_COMPATIBILITY, "--lenient", OPTION_FLAG, NULL, NO_RANGE, FIELD(script.lenient), NULL,
     "turn errors in calls of gr into warnings, and render as much of the scene as possible"},
    {OPTION_GROUP_COMPATIBILITY, "--dialect", OPTION_TEXT, "NAME|FILE.lua", NO_RANGE, FIELD(script.dialect), "none",
     "before the scene, run lua/dialects/NAME.lua, or FILE.lua, which defines the functions of another program"},

    {OPTION_GROUP_RUN, "-j", OPTION_INTEGER, "N", 1, 1024, FIELD(threads), "one for each processor",
     "number of threads; the picture does not depend on it"},
    {OPTION_GROUP_RUN, "--tile-order", OPTION_CHOICE, LIST_BARS(TILE_ORDERS), NO_RANGE, FIELD(settings.order), "spread",
     "order in which tiles are rendered (in a window always from the centre); the picture is the same"},
    {OPTION_GROUP_RUN, "-D", OPTION_DEFINE, "name=value", NO_RANGE, NO_FIELD, NULL,
     "set the Lua global `name` before the script runs; value is a Lua literal, else a string; may be repeated"},
    {OPTION_GROUP_SANDBOX, "--allow-read", OPTION_FOLDER, "DIR", 0, 0, NO_FIELD, NULL,
     "let scenes read below DIR too; they always read below their own folder, its parent, the working directory and "
     "the library; may be repeated"},
    {OPTION_GROUP_SANDBOX, "--allow-write", OPTION_FOLDER, "DIR", 1, 0, NO_FIELD, NULL,
     "let scenes write files below DIR; without this option they cannot write files, because gray itself writes the "
     "pictures; may be repeated"},
    {OPTION_GROUP_SANDBOX, "--script-memory", OPTION_BYTES, "SIZE", SIZES, FIELD(script.memory_limit), "4G",
     "memory limit of a script and the files that it reads, such as 512M or 2G (a plain number is in MiB); script and "
     "picture together may use 1.75 times as much"},
    {OPTION_GROUP_SANDBOX, "--script-time", OPTION_NUMBER, "SECONDS", 0.001, HUGE_VAL, FIELD(script.time_limit), "60",
     "limit of the processor time of a script; rendering does not count"},
    {OPTION_GROUP_SANDBOX, "--script-output", OPTION_BYTES, "SIZE", SIZES, FIELD(script.output_limit), "64M",
     "limit of what a script prints and writes (a plain number is in MiB); pictures do not count"},
    {OPTION_GROUP_SANDBOX, "--picture-count", OPTION_INTEGER, "N", 1, INT_MAX, FIELD(picture_count), "100000",
     "limit of the pictures in a run; a picture that replaces another one counts again"},
    {OPTION_GROUP_SANDBOX, "--picture-bytes", OPTION_BYTES, "SIZE", SIZES, FIELD(picture_bytes), "64G",
     "limit of the bytes in picture files of a run (a plain number is in MiB)"},
    {OPTION_GROUP_SANDBOX, "--no-sandbox", OPTION_FLAG, NULL, NO_RANGE, FIELD(script.no_sandbox), NULL,
     "turn the sandbox off: scenes may read and write all your files and start programs; only for scenes you trust"},

    {OPTION_GROUP_RUN, "--check", OPTION_FLAG, NULL, NO_RANGE, FIELD(check), NULL,
     "run the scripts and build their scenes without rendering; report every problem"},
    {OPTION_GROUP_RUN, "--no-fork", OPTION_FLAG, NULL, NO_RANGE, FIELD(no_fork), NULL,
     "render in one process (for debuggers)"},

    {OPTION_GROUP_PARTS, "--checkpoint", OPTION_TEXT, "FILE", NO_RANGE, FIELD(checkpoint), NULL,
     "save finished tiles to FILE while rendering, for --resume; auto: a file beside the first picture; SIGUSR1 saves "
     "at once; gray removes the file when all pictures are written"},
    {OPTION_GROUP_PARTS, "--checkpoint-every", OPTION_NUMBER, "SECONDS", 0, HUGE_VAL, FIELD(checkpoint_every), "10",
     "shortest time between two checkpoints; saving takes at most a twentieth of the run"},
    {OPTION_GROUP_PARTS, "--resume", OPTION_FLAG, NULL, NO_RANGE, FIELD(resume), NULL,
     "continue from the checkpoint (--checkpoint auto unless another file is given); an error if the scene has "
     "changed; with --shard, skip a part that exists already"},
    {OPTION_GROUP_PARTS, "--partial", OPTION_FLAG, NULL, NO_RANGE, FIELD(partial), NULL,
     "if rendering dir/foo.png is interrupted, write dir/foo.partial.png: finished tiles, and black for the others"},
    {OPTION_GROUP_PARTS, "--shard", OPTION_SHARD, "I/N", NO_RANGE, FIELD(shard), NULL,
     "render part I of N of every picture into a file of tiles beside it; `gray merge PART ...` joins the parts"},
    {OPTION_GROUP_PARTS, "--shard-pictures", OPTION_SHARD, "I/N", NO_RANGE, FIELD(shard_of_pictures), NULL,
     "render only every Nth picture, starting with the Ith"},
    {OPTION_GROUP_PARTS, "--mpi", OPTION_FLAG, NULL, NO_RANGE, FIELD(mpi), NULL,
     "under mpirun: all processes render each picture together; the first one assigns tiles on demand"},
    {OPTION_GROUP_PARTS, "--farm-stall", OPTION_NUMBER, "SECONDS", 0, 1e9, FIELD(farm_stall), "30",
     "with --mpi: kill a render process that could run but uses no processor time for this long; another one "
     "renders its tiles; 0: never"},
    {OPTION_GROUP_PARTS, "--farm-silence", OPTION_NUMBER, "SECONDS", 0, 1e9, FIELD(farm_silence), "60",
     "with --mpi: regard a process that sends nothing for this long as lost; others render its tiles; 0: never"},

    {OPTION_GROUP_REPORTS, "-gui", OPTION_FLAG, NULL, NO_RANGE, FIELD(window), NULL,
     "show the picture in a window during rendering and fly through the scene: R renders, S saves the view, V saves "
     "the camera, Space flies (W A S D Q E and the mouse, Esc stops), N is the next picture, Q quits; in animations, K "
     "plays and pauses, H and J go to the previous and the next frame, O turns the loop on or off"},
    {OPTION_GROUP_REPORTS, "--watch", OPTION_FLAG, NULL, NO_RANGE, FIELD(watch), NULL,
     "run the scripts again when a script, or a file that it reads, changes; Ctrl-C ends gray"},
    {OPTION_GROUP_REPORTS, "-q|quiet", OPTION_FLAG, NULL, NO_RANGE, FIELD(quiet), NULL, "print errors only"},
    {OPTION_GROUP_REPORTS, "--verbose", OPTION_FLAG, NULL, NO_RANGE, FIELD(verbose), NULL, "print details and reasons"},
    {OPTION_GROUP_REPORTS, "--stats", OPTION_STATS, "=text|json", NO_RANGE, NO_FIELD, NULL,
     "statistics of each picture: a table on standard error, or one line of JSON per picture on standard output"},
    {OPTION_GROUP_REPORTS, "--progress", OPTION_CHOICE, LIST_BARS(PROGRESS_MODES), NO_RANGE, FIELD(progress), "auto",
     "progress and time left, on standard error; auto: a bar on a terminal, otherwise a line from time to time in long "
     "runs"},
    {OPTION_GROUP_REPORTS, "--display", OPTION_TEXT, "WHERE", NO_RANGE, FIELD(display), NULL,
     "show the picture during rendering: tev[:HOST[:PORT]] in the image viewer tev (port 14158), term in the terminal "
     "(term:kitty, term:sixel or term:blocks choose the protocol)"},
    {OPTION_GROUP_REPORTS, "--pixel", OPTION_PIXEL, "X,Y", NO_RANGE, NO_FIELD, NULL,
     "do not render; explain this pixel of every picture on standard output: its rays, their hits, lights and weights, "
     "and the final bytes; may be repeated"},
    {OPTION_GROUP_REPORTS, "--dump-scene", OPTION_FLAG, NULL, NO_RANGE, FIELD(dump_scene), NULL,
     "do not render; list the primitives, materials and lights of every picture"},
    {OPTION_GROUP_REPORTS, "--dump-expr", OPTION_FLAG, NULL, NO_RANGE, FIELD(dump_expr), NULL,
     "do not render; list the operations of every recorded Lua function of a picture"},
    {OPTION_GROUP_REPORTS, "--json", OPTION_FLAG, NULL, NO_RANGE, FIELD(json), NULL,
     "print --pixel, --dump-scene and --dump-expr as JSON, one line per picture"},
    {OPTION_GROUP_REPORTS, "--help|h", OPTION_ACTION, NULL, ACTION_HELP, 0, NO_FIELD, NULL, "print this text"},
    {OPTION_GROUP_REPORTS, "--man", OPTION_ACTION, NULL, ACTION_MANUAL, 0, NO_FIELD, NULL,
     "print this text and all functions of the scene language"},
    {OPTION_GROUP_REPORTS, "--annotations", OPTION_ACTION, NULL, ACTION_ANNOTATIONS, 0, NO_FIELD, NULL,
     "print the functions as an annotation file for editors (lua/gr.lua)"},
    {OPTION_GROUP_REPORTS, "--version", OPTION_ACTION, NULL, ACTION_VERSION, 0, NO_FIELD, NULL,
     "print the versions of the program and of its libraries"},
};
const int option_count = sizeof option_table / sizeof *option_table;

_Static_assert(offsetof(struct options, shards) == offsetof(struct options, shard) + sizeof(uint32_t) &&
                   offsetof(struct options, shards_of_pictures) ==
                       offsetof(struct options, shard_of_pictures) + sizeof(uint32_t),
               "a shard is two numbers in a row");

/* Values are stored through their size: an enum is an int here. */
_Static_assert(sizeof(enum specular_kind) == sizeof(int) && sizeof(enum accel_kind) == sizeof(int) &&
                   sizeof(enum script_order) == sizeof(int) && sizeof(enum tone_curve) == sizeof(int) &&
                   sizeof(enum progress_mode) == sizeof(int) && sizeof(enum order) == sizeof(int) &&
                   sizeof(enum overlay) == sizeof(int) && sizeof(enum dither) == sizeof(int) &&
                   sizeof(enum style) == sizeof(int) && sizeof(enum integrator_kind) == sizeof(int),
               "choices are stored as int");

/* --help */

/* Prints words from `column` on, broken so that no line is longer than 100 columns. */
static void print_wrapped(FILE *stream, const char *text, int column) {
    enum { INDENT = 36, WIDTH = 100 };
    if (column >= INDENT) {
        (void)fputc('\n', stream);
        column = 0;
    }
    (void)fprintf(stream, "%*s", INDENT - column, "");
    column = INDENT;
    while (*text) {
        size_t length = strcspn(text, " ");
        if (column > INDENT && column + 1 + (int)length > WIDTH) {
            (void)fprintf(stream, "\n%*s", INDENT, "");
            column = INDENT;
        }
        column += fprintf(stream, "%s%.*s", column > INDENT ? " " : "", (int)length, text);
        text += length + (text[length] == ' ');
    }
    (void)fputc('\n', stream);
}

static void print_option(FILE *stream, const struct option *option) {
    int column = fprintf(stream, "  ");
    for (const char *rest = option->names; *rest;) {
        bool first = rest == option->names;
        struct piece name = option_next_piece(&rest);
        column += fprintf(stream, "%s%.*s", first ? "" : name.length > 1 ? ", --" : ", -", (int)name.length, name.text);
    }
    if (option->value && option->value[0] == '=')
        column += fprintf(stream, "[%s]", option->value);
    else if (option->value)
        column += fprintf(stream, " %s", option->value);
    char help[512];
    (void)snprintf(help, sizeof help, "%s%s%s%s", option->help, option->initial ? " (default: " : "",
                   option->initial ? option->initial : "", option->initial ? ")" : "");
    print_wrapped(stream, help, column);
}

void options_print_help(FILE *stream) {
    (void)fputs("gray renders scenes that are written as Lua scripts.\n"
                "usage: gray [options] [--] scene.lua ...\n"
                "       gray merge [-o FILE] [options] PART ...\n"
                "Long options take one dash or two, and '_' or '-' between words; a space or '=' precedes the value.\n",
                stream);
    for (int group = 0; group < OPTION_GROUP_COUNT; group++) {
        (void)fprintf(stream, "\n%s\n", option_group_titles[group]);
        for (int i = 0; i < option_count; i++) {
            if (option_table[i].group == (enum option_group)group)
                print_option(stream, &option_table[i]);
        }
    }
    (void)fputs("\nExit status: 0 all pictures written; 1 error in a scene or a file; 2 wrong usage; 3 error of the\n"
                "machine (disk full, out of memory, a crash); 130 interrupted. gray runs every script and returns the\n"
                "highest status. Wrong usage and an interruption end the run at once.\n"
                "Environment: GRAY_LUA is the folder of the Lua library, which require searches last.\n",
                stream);
}
