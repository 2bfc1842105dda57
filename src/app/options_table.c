/* The table of options. Its order is that of --help; options_digest goes by its groups. */
#include "app/options_internal.h"

#include "accel/isa.h"
#include "render/aov.h"

#include <limits.h>
#include <math.h>
#include <stddef.h>

#define FIELD(name) offsetof(struct options, name), sizeof(((struct options *)NULL)->name)
#define NO_FIELD 0, 0
#define NO_RANGE 0, 0
/* The first choice is the best set that the processor has. */
#define ISA_CHOICES "auto" ACCEL_ISAS(LIST_BAR_WORD)
#define LAYER_NAME(aov, name, channels) " " name ","
#define SIZES 0x1p10, 0x1p50 /* 1 KiB to 1 PiB */

const char *const option_group_titles[GROUP_COUNT] = {
    [GROUP_PICTURE] = "Anti-aliasing and rays",        [GROUP_LOOK] = "Size, part and search", [GROUP_FILES] = "Files",
    [GROUP_OLD] = "Scenes written for other programs", [GROUP_TRUST] = "What scenes may do",   [GROUP_RUN] = "The run",
    [GROUP_PARTS] = "Long runs and many machines",     [GROUP_TALK] = "What is told",
};

const struct option option_table[] = {
    {GROUP_PICTURE, "--integrator", OPTION_CHOICE, LIST_BARS(INTEGRATORS), NO_RANGE, FIELD(settings.integrator),
     "whitted", "how light becomes a picture"},
    {GROUP_PICTURE, "-ss", OPTION_INTEGER, "N", 1, 64, FIELD(settings.samples), "3",
     "N x N samples for a marked pixel"},
    {GROUP_PICTURE, "-full", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.full), NULL,
     "N x N samples for every pixel, not only for marked ones"},
    {GROUP_PICTURE, "-side-tolerance", OPTION_NUMBER, "X", 0, HUGE_VAL, FIELD(settings.side_tolerance), "0.005",
     "a pixel is marked when the squared RGB distance to a side neighbour exceeds X"},
    {GROUP_PICTURE, "-corner-tolerance", OPTION_NUMBER, "X", 0, HUGE_VAL, FIELD(settings.corner_tolerance), "0.01",
     "the same for the corner neighbours"},
    {GROUP_PICTURE, "-reflect-limit", OPTION_INTEGER, "N", 0, 1000, FIELD(settings.reflect_limit), "2",
     "how often a path may reflect"},
    {GROUP_PICTURE, "-refract-limit", OPTION_INTEGER, "N", 0, 1000, FIELD(settings.refract_limit), "4",
     "how often a path may refract"},
    {GROUP_PICTURE, "-use-tir", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.use_tir), NULL,
     "beyond the critical angle the refracted share is reflected instead of lost"},
    {GROUP_PICTURE, "-al-samples|alsamples", OPTION_INTEGER, "N", 1, 64, FIELD(settings.area_samples), "4",
     "N x N shadow rays for each area light"},
    {GROUP_PICTURE, "--caustics", OPTION_INTEGER, "N", 0, PHOTONS_MOST, FIELD(settings.caustics.photons), "0",
     "N photons make the light that glass and mirrors throw"},
    {GROUP_PICTURE, "--cutoff", OPTION_NUMBER, "X", 0, 1, FIELD(settings.cutoff), "0.0001",
     "rays that can change a pixel by less than X (of 1) are not followed; 0: all are"},
    {GROUP_PICTURE, "--seed", OPTION_SEED, "N", NO_RANGE, NO_FIELD, "0",
     "start of all random numbers, the scripts' math.random included"},

    {GROUP_PICTURE, "--quick", OPTION_FLAG, NULL, NO_RANGE, FIELD(quick), NULL,
     "a draft: one sample a pixel, few shadow rays, no caustics, no blur by lens or motion, whatever else is asked "
     "for"},
    {GROUP_PICTURE, "--preview", OPTION_FLAG, NULL, NO_RANGE, FIELD(preview), NULL,
     "a smaller draft: a quarter of the width and height (unless --size is given), and neither reflections nor "
     "refractions"},

    {GROUP_LOOK, "--size", OPTION_SIZE, "WxH", NO_RANGE, NO_FIELD, "the script's", "size of the pictures in pixels"},
    {GROUP_LOOK, "--crop", OPTION_CROP, "X,Y,W,H", NO_RANGE, NO_FIELD, "all",
     "write a W x H picture, exactly that part of the whole; X,Y is its upper left pixel"},
    {GROUP_LOOK, "--accel", OPTION_CHOICE, LIST_BARS(ACCEL_KINDS), NO_RANGE, FIELD(settings.accel), "auto",
     "how rays find what they hit; the picture is the same"},
    {GROUP_LOOK, "--isa", OPTION_CHOICE, ISA_CHOICES, NO_RANGE, FIELD(isa), "auto",
     "instruction set of the kernels; the picture is the same"},

    {GROUP_LOOK, "--exposure", OPTION_NUMBER, "STOPS", -100, 100, FIELD(settings.tone.exposure), "0",
     "light is multiplied by 2^STOPS on its way into a PNG file"},
    {GROUP_LOOK, "--tone", OPTION_CHOICE, LIST_BARS(TONE_CURVES), NO_RANGE, FIELD(settings.tone.curve), "none",
     "the curve that brings bright light into the range of a PNG file"},
    {GROUP_LOOK, "--srgb", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.tone.srgb), NULL,
     "values of a PNG file follow the sRGB transfer function instead of light itself"},
    {GROUP_LOOK, "--deep", OPTION_FLAG, NULL, NO_RANGE, FIELD(settings.deep), NULL, "16 bits a channel in PNG files"},

    {GROUP_FILES, "-o", OPTION_TEXT, "FILE", NO_RANGE, FIELD(output), "the script's",
     "name of the picture (.png, or .pfm, .hdr and .exr for light as it is), '-' for standard output; with several "
     "pictures "
     "FILE needs %d (or %03d), which counts from "
     "1"},
    {GROUP_FILES, "--force", OPTION_FLAG, NULL, NO_RANGE, FIELD(force), NULL,
     "-o FILE also replaces a file that is no picture"},
    {GROUP_FILES, "-write-aa-targets", OPTION_TEXT, "X", NO_RANGE, FIELD(targets_prefix), NULL,
     "for dir/foo.png also write dir/Xfoo.png: the first pass with the marked pixels in red"},
    {GROUP_FILES, "-write-pre-aa", OPTION_TEXT, "X", NO_RANGE, FIELD(first_pass_prefix), NULL,
     "for dir/foo.png also write dir/Xfoo.png: the first pass, one sample for each pixel"},

    {GROUP_FILES, "--aov", OPTION_LAYERS, "LIST", NO_RANGE, NO_FIELD, NULL,
     "for dir/foo.png also write dir/foo.NAME.png for each NAME of LIST, parted by commas:" AOVS(LAYER_NAME) " or all"},

    {GROUP_FILES, "--overlay", OPTION_CHOICE, LIST_BARS(OVERLAYS), NO_RANGE, FIELD(settings.overlay), "none",
     "lines over the picture: the boxes of all that is placed, or the cells of what rays search (see --accel)"},

    {GROUP_OLD, "--transform-order", OPTION_CHOICE, LIST_BARS(SCRIPT_ORDERS), NO_RANGE, FIELD(script.transform_order),
     "auto",
     "new: transforms act in the order they are written; old: the last one acts first; separate: scale, rotate, "
     "translate are kept apart; auto: decided from the text of the script"},
    {GROUP_OLD, "--view", OPTION_CHOICE, "direction|target", NO_RANGE, FIELD(settings.view_is_target), "direction",
     "whether the view argument is a direction or a point to look at"},
    {GROUP_OLD, "--pixel-sample", OPTION_CHOICE, "centre|corner", NO_RANGE, FIELD(settings.pixel_corner), "centre",
     "where the first sample of a pixel lies"},
    {GROUP_OLD, "--specular", OPTION_CHOICE, LIST_BARS(SPECULAR_KINDS), NO_RANGE, FIELD(settings.specular), "phong",
     "formula of the highlight"},
    {GROUP_OLD, "--ambient", OPTION_CHOICE, "kd|plain", NO_RANGE, FIELD(settings.ambient_plain), "kd",
     "ambient light is multiplied with kd, or added as it is"},
    {GROUP_OLD, "--lenient", OPTION_FLAG, NULL, NO_RANGE, FIELD(script.lenient), NULL,
     "a gr function that does not exist is a warning and does nothing"},

    {GROUP_RUN, "-j", OPTION_INTEGER, "N", 1, 1024, FIELD(threads), "one for each processor",
     "number of threads; the picture is the same for any number"},
    {GROUP_RUN, "--tile-order", OPTION_CHOICE, LIST_BARS(TILE_ORDERS), NO_RANGE, FIELD(settings.order), "spread",
     "in which order tiles are made (in a window always from the centre); the picture is the same"},
    {GROUP_RUN, "-D", OPTION_DEFINE, "name=value", NO_RANGE, NO_FIELD, NULL,
     "set the Lua global `name` before the script runs: a Lua literal, else a string; may be repeated"},
    {GROUP_TRUST, "--allow-read", OPTION_FOLDER, "DIR", 0, 0, NO_FIELD, NULL,
     "scenes may read below DIR too; without it: below their own folder, the folder above it, the working directory "
     "and the library; may be repeated"},
    {GROUP_TRUST, "--allow-write", OPTION_FOLDER, "DIR", 1, 0, NO_FIELD, NULL,
     "scenes may write files below DIR; without it they write none (pictures are written by gray); may be repeated"},
    {GROUP_TRUST, "--script-memory", OPTION_BYTES, "SIZE", SIZES, FIELD(script.memory_limit), "4G",
     "memory a script and the files it reads may use, as in 512M or 2G (a plain number is MiB); a picture and "
     "the script together may use three quarters more"},
    {GROUP_TRUST, "--script-time", OPTION_NUMBER, "SECONDS", 0.001, HUGE_VAL, FIELD(script.time_limit), "60",
     "processor time a script may use for itself; rendering is not counted"},
    {GROUP_TRUST, "--script-output", OPTION_BYTES, "SIZE", SIZES, FIELD(script.output_limit), "64M",
     "how much a script may print and write (a plain number is MiB); pictures are not counted"},
    {GROUP_TRUST, "--picture-count", OPTION_INTEGER, "N", 1, INT_MAX, FIELD(picture_count), "100000",
     "how many pictures the scripts of a run may render, one that replaces another counted again"},
    {GROUP_TRUST, "--picture-bytes", OPTION_BYTES, "SIZE", SIZES, FIELD(picture_bytes), "64G",
     "how much is written into files of pictures in a run (a plain number is MiB)"},
    {GROUP_TRUST, "--no-sandbox", OPTION_FLAG, NULL, NO_RANGE, FIELD(script.no_sandbox), NULL,
     "scenes may do whatever the user may: read and write all files, start programs; for scenes you trust"},

    {GROUP_RUN, "--check", OPTION_FLAG, NULL, NO_RANGE, FIELD(check), NULL,
     "run the scripts and build their scenes, render nothing, report every problem"},
    {GROUP_RUN, "--no-fork", OPTION_FLAG, NULL, NO_RANGE, FIELD(no_fork), NULL,
     "render in this process (for debuggers)"},

    {GROUP_PARTS, "--checkpoint", OPTION_TEXT, "FILE", NO_RANGE, FIELD(checkpoint), NULL,
     "keep finished tiles in FILE while rendering, for --resume; auto: a file beside the first picture; SIGUSR1 writes "
     "it "
     "at once; it is removed when all pictures are written"},
    {GROUP_PARTS, "--checkpoint-every", OPTION_NUMBER, "SECONDS", 0, HUGE_VAL, FIELD(checkpoint_every), "10",
     "how often, at least; writing never takes more than a twentieth of the time"},
    {GROUP_PARTS, "--resume", OPTION_FLAG, NULL, NO_RANGE, FIELD(resume), NULL,
     "go on with what the checkpoint holds (--checkpoint auto, unless it is named); a changed scene is refused; a "
     "--shard whose part is there already is done"},
    {GROUP_PARTS, "--partial", OPTION_FLAG, NULL, NO_RANGE, FIELD(partial), NULL,
     "of a picture that is interrupted write dir/foo.partial.png: the tiles that are done, the others black"},
    {GROUP_PARTS, "--shard", OPTION_SHARD, "I/N", NO_RANGE, FIELD(shard), NULL,
     "make part I of N of every picture, a file of tiles beside it; `gray merge PART ...` puts the parts together"},
    {GROUP_PARTS, "--shard-pictures", OPTION_SHARD, "I/N", NO_RANGE, FIELD(shard_of_pictures), NULL,
     "of many pictures make every Nth, from the Ith on"},
    {GROUP_PARTS, "--mpi", OPTION_FLAG, NULL, NO_RANGE, FIELD(mpi), NULL,
     "under mpirun: all processes make each picture together, tiles are handed out on demand"},
    {GROUP_PARTS, "--farm-stall", OPTION_NUMBER, "SECONDS", 0, 1e9, FIELD(farm_stall), "30",
     "with --mpi: a rendering process that uses no processor time for so long, though none is missing, is killed, and "
     "another one makes its tiles; 0: never"},
    {GROUP_PARTS, "--farm-silence", OPTION_NUMBER, "SECONDS", 0, 1e9, FIELD(farm_silence), "60",
     "with --mpi: a process that is not heard for so long is regarded as lost, and others make its tiles; 0: never"},

    {GROUP_TALK, "-gui", OPTION_FLAG, NULL, NO_RANGE, FIELD(window), NULL,
     "show the picture in a window while it is made, and walk through the scene: R renders, S saves what is shown, V "
     "the camera, Space walks (W A S D Q E and the mouse, Esc leaves), N goes on, Q quits"},
    {GROUP_TALK, "--watch", OPTION_FLAG, NULL, NO_RANGE, FIELD(watch), NULL,
     "run the scripts again whenever one of them, or a file that they read, has changed; Ctrl-C ends it"},
    {GROUP_TALK, "-q|quiet", OPTION_FLAG, NULL, NO_RANGE, FIELD(quiet), NULL, "say nothing but errors"},
    {GROUP_TALK, "--verbose", OPTION_FLAG, NULL, NO_RANGE, FIELD(verbose), NULL, "say what is done and why"},
    {GROUP_TALK, "--stats", OPTION_STATS, "=text|json", NO_RANGE, NO_FIELD, NULL,
     "what each picture cost: a table on standard error, or one JSON line a picture on standard output"},
    {GROUP_TALK, "--progress", OPTION_CHOICE, LIST_BARS(PROGRESS_MODES), NO_RANGE, FIELD(progress), "auto",
     "how far the picture is and how long it will take, on standard error; auto: a bar on a terminal, else a line now "
     "and then when it takes long"},
    {GROUP_TALK, "--display", OPTION_TEXT, "WHERE", NO_RANGE, FIELD(display), NULL,
     "show the picture while it is made: tev[:HOST[:PORT]] in the image viewer tev (port 14158), term in the terminal "
     "(term:kitty, term:sixel or term:blocks if it does not find out itself)"},
    {GROUP_TALK, "--pixel", OPTION_PIXEL, "X,Y", NO_RANGE, NO_FIELD, NULL,
     "render nothing, but tell on standard output how this pixel of every picture comes about: its rays, what they "
     "meet, "
     "lights and weights, down to the byte; may be repeated"},
    {GROUP_TALK, "--dump-scene", OPTION_FLAG, NULL, NO_RANGE, FIELD(dump_scene), NULL,
     "render nothing, but tell what every picture's world is made of"},
    {GROUP_TALK, "--json", OPTION_FLAG, NULL, NO_RANGE, FIELD(json), NULL,
     "--pixel and --dump-scene as JSON, one line a picture"},
    {GROUP_TALK, "--help|h", OPTION_ACTION, NULL, ACTION_HELP, 0, NO_FIELD, NULL, "this text"},
    {GROUP_TALK, "--man", OPTION_ACTION, NULL, ACTION_MANUAL, 0, NO_FIELD, NULL,
     "this text and all functions of the scene language"},
    {GROUP_TALK, "--annotations", OPTION_ACTION, NULL, ACTION_ANNOTATIONS, 0, NO_FIELD, NULL,
     "the functions as an annotation file for editors (lua/gr.lua)"},
    {GROUP_TALK, "--version", OPTION_ACTION, NULL, ACTION_VERSION, 0, NO_FIELD, NULL,
     "version of this program and of its libraries"},
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
                   sizeof(enum overlay) == sizeof(int) && sizeof(enum integrator_kind) == sizeof(int),
               "choices are stored as int");
