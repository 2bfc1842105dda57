/* The options that are no settings of a picture, and --help, which prints all options by group: settings first. */
#include "session/options_internal.h"

#include "base/document.h"
#include "base/isa.h"
#include "formats/model_format.h"
#include "image/picture_file.h"
#include "math/range.h"
#include "session/options_table.h"

#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

/* The designator allows rows without the last column. */
#define FIELD(name) .offset = offsetof(struct options, name), sizeof(((struct options *)NULL)->name)
#define NO_FIELD .offset = 0, 0
/* The first choice is the best set that the processor has. */
#define ISA_CHOICES "auto" CPU_ISAS(LIST_BAR_WORD)
#define SIZES 0x1p10, 0x1p50 /* 1 KiB to 1 PiB */

static const char *const group_titles[OPTION_GROUP_COUNT] = {
    [OPTION_GROUP_RAYS] = "Anti-aliasing and rays",
    [OPTION_GROUP_SIZE_AND_COLOUR] = "Size, acceleration and colour",
    [OPTION_GROUP_FINISH] = "Styles and finishing",
    [OPTION_GROUP_FILES] = "Files",
    [OPTION_GROUP_ANIMATION] = "Animation",
    [OPTION_GROUP_MODELS] = "Models",
    [OPTION_GROUP_VIEWS] = "Light fields and panoramas (gray view)",
    [OPTION_GROUP_OTHER_PROGRAMS] = "Scenes written for other programs",
    [OPTION_GROUP_SANDBOX] = "Sandbox",
    [OPTION_GROUP_EXECUTION] = "Execution",
    [OPTION_GROUP_MACHINES] = "Long runs and many machines",
    [OPTION_GROUP_REPORTS] = "Display and messages",
};

const char *option_group_title(enum option_group group) {
    return group_titles[group];
}

/* The columns are those of struct setting; defaults other than 0 are set by options_parse. */
static const struct setting options_table[] = {
    {SETTING_FLAG, CHANGES_SAMPLES, OPTION_GROUP_RAYS, "--quick", NULL, "", NULL, FIELD(quick), 0, 0, 0, NULL,
     "Draft: one sample per pixel, few shadow rays, no caustics, no depth of field, no motion blur; overrides other "
     "options."},
    {SETTING_FLAG, CHANGES_SAMPLES, OPTION_GROUP_RAYS, "--preview", NULL, "", NULL, FIELD(preview), 0, 0, 0, NULL,
     "Smaller draft: a quarter of the width and height (unless --size is given), no reflections, no refractions."},
    {SETTING_SIZE, CHANGES_SAMPLES, OPTION_GROUP_SIZE_AND_COLOUR, "--size", "WxH", "", NULL, FIELD(width), 0, 0, 0,
     "the script's", "Size of the pictures in pixels."},
    {SETTING_TEXT, CHANGES_SAMPLES, OPTION_GROUP_MODELS, "--camera", "NAME|N", "", NULL, FIELD(script.camera), 0, 0, 0,
     "the first, or one that fits", "The camera in the file of a model; --check lists its cameras."},
    {SETTING_CHOICE, CHANGES_SAMPLES, OPTION_GROUP_MODELS, "--up", NULL, LIST_BARS(MODEL_UPS), NULL, FIELD(script.up),
     0, 0, 0, "auto", "The axis of a model that points up; auto: z of STL, y of others."},
    {SETTING_TEXT, CHANGES_SAMPLES, OPTION_GROUP_MODELS, "--edits", "FILE.lua", "", NULL, FIELD(script.edits), 0, 0, 0,
     NULL, "A file of edits that the window has saved, of a model or a script; it runs before the script."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_MODELS, "--sky", "FILE.hdr", "", NULL, FIELD(script.sky), 0, 0, 0, NULL,
     "A picture of the whole sphere that is background and light of all pictures, also of scripts, in place of their "
     "sky and background."},
    {SETTING_CHOICE, CHANGES_RUN, OPTION_GROUP_SIZE_AND_COLOUR, "--isa", NULL, ISA_CHOICES, NULL, FIELD(isa), 0, 0, 0,
     "auto", "Instruction set of the kernels; the picture is the same."},
    {SETTING_CHOICE, CHANGES_RUN, OPTION_GROUP_EXECUTION, "--device", NULL, LIST_BARS(DEVICES), NULL, FIELD(device), 0,
     0, 0, "cpu",
     "Who makes the samples of integrator path; gpu: a graphics card of NVIDIA beside the processor, or an error; "
     "auto: the "
     "card, if more than 3 s of work are left to it and a trial says that it is quicker; emulate: a process of its "
     "own, in waves, as a card would; the picture is the same."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_FILES, "-o", "FILE", "", NULL, FIELD(output), 0, 0, 0, "the script's",
     "Name of the picture:" PICTURE_FORMATS_HELP "; '-' is standard output; for several "
     "pictures, FILE must contain %d (or %03d, or ####), their number from 1, or it must be an animation: .apng, .gif, "
     ".webp, .y4m, .mp4 or .webm. Or a model of the scene:" MODEL_FORMATS_HELP "; -o twice writes a picture and a "
     "model."},
    {SETTING_NUMBER, CHANGES_RUN, OPTION_GROUP_MODELS, "--tolerance", "LENGTH", "", NULL, FIELD(tolerance), 0, 1e-9,
     HUGE_VAL, "1/1000 of the size", "Largest distance of a written model from the exact surface."},
    {SETTING_CHOICE, CHANGES_RUN, OPTION_GROUP_MODELS, "--unit", NULL, LIST_BARS(MODEL_UNITS), NULL, FIELD(unit), 0, 0,
     0, "mm", "Unit of the numbers in a written model, for files that name it (3MF)."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_MODELS, "--node", "NAME", "", NULL, FIELD(node), 0, 0, 0, "all",
     "Write only the node of this name as a model."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_MODELS, "--bake", "FILE.ply|FILE.glb", "", NULL, FIELD(bake), 0, 0, 0,
     NULL,
     "Write the patches of the first picture, with the light that integrator radiosity has stored as colours of their "
     "vertices.",
     EFFECT_RADIOSITY},
    {SETTING_WHOLE, CHANGES_RUN, OPTION_GROUP_MODELS, "--picture", "N", "", NULL, FIELD(picture), 0, 1, INT_MAX,
     "the only one", "The picture of a script whose scene is written as a model, counted from 1."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_MODELS, "--check-print", NULL, "", NULL, FIELD(check_print), 0, 0, 0, NULL,
     "Render nothing; report volume, size, thinnest wall, steepest overhang and stand of the solids as for a printer."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_FILES, "--to-json", NULL, "", NULL, FIELD(to_json), 0, 0, 0, NULL,
     "Render nothing; write the scene of the picture as JSON, to standard output or -o FILE.json."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_FILES, "--to-lua", NULL, "", NULL, FIELD(to_lua), 0, 0, 0, NULL,
     "Render nothing; write the scene of the picture as a script, to standard output or -o FILE.lua."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_FILES, "--force", NULL, "", NULL, FIELD(force), 0, 0, 0, NULL,
     "Let -o FILE replace a file that is not a picture, and write a PNG file under a name with any ending."},
    {SETTING_NUMBER, CHANGES_RUN, OPTION_GROUP_FILES, "--threshold", "LEVEL", "", NULL, FIELD(threshold), 0, 0, 1e9,
     NULL,
     "With gray compare: the largest difference of a pixel with which the status is 0, in levels of 255, or in light "
     "of "
     "PFM, HDR and EXR."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_FILES, "-write-aa-targets", "X", "", NULL, FIELD(targets_prefix), 0, 0, 0,
     NULL, "For dir/foo.png also write dir/Xfoo.png: the first pass with the marked pixels in red."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_FILES, "-write-pre-aa", "X", "", NULL, FIELD(first_pass_prefix), 0, 0, 0,
     NULL, "For dir/foo.png also write dir/Xfoo.png: the first pass, one sample for each pixel."},
    {SETTING_FRAMES, CHANGES_SAMPLES, OPTION_GROUP_ANIMATION, "--frames", "N|A-B|A-B/STEP", "", NULL,
     FIELD(script.frames.selection), 0, 0, 0, "all",
     "Render the frames 1 to N, or A to B, or every STEPth of these; gray runs a script without gr.frames once for "
     "each of them, with the gr.frame, gr.time and gr.clock of the frame."},
    {SETTING_NUMBER, CHANGES_SAMPLES, OPTION_GROUP_ANIMATION, "--fps", "X", "", NULL, FIELD(script.frames.rate), 0,
     FRAME_RATE_MIN, FRAME_RATE_MAX, "the script's, or 30", "Frames per second.", EFFECT_FRAMES},
    {SETTING_FLAG, CHANGES_SAMPLES, OPTION_GROUP_ANIMATION, "--loop", NULL, "", NULL, FIELD(script.frames.loops), 0, 0,
     0, NULL, "After the last frame comes the first: gr.clock stays below 1, and players repeat the file without end.",
     EFFECT_FRAMES},
    {SETTING_WHOLE, CHANGES_SAMPLES, OPTION_GROUP_ANIMATION, "--turntable", "N", "", NULL,
     FIELD(script.frames.turntable), 0, 1, FRAMES_MAX, NULL,
     "Render every picture N times, from a camera that moves once around the scene; implies --loop."},
    {SETTING_CHOICE, CHANGES_RUN, OPTION_GROUP_ANIMATION, "--palette", NULL, "all|frame", NULL, FIELD(frame_palettes),
     0, 0, 0, "all",
     "The 256 colours of a GIF file: one palette for all frames, so that parts without motion do not flicker, or one "
     "for each frame.",
     EFFECT_GIF},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_ANIMATION, "--keep-frames", NULL, "", NULL, FIELD(keep_frames), 0, 0, 0,
     NULL, "Keep the frames of the animation FILE as PNG files in the folder FILE.frames."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_ANIMATION, "--contact-sheet", NULL, "", NULL, FIELD(contact_sheet), 0, 0,
     0, NULL,
     "For the animation dir/foo.gif also write dir/foo.sheet.png: small pictures of all frames. With gray view: one "
     "picture of all views."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_VIEWS, "--eye", "X,Y,Z[:X,Y,Z...]", "", NULL, FIELD(eyes), 0, 0, 0,
     "0,0,0",
     "Where the eye is in a light field: from the middle of its cameras to the right, up and along the view; several "
     "are a path for --frames."},
    {SETTING_NUMBER, CHANGES_RUN, OPTION_GROUP_VIEWS, "--focus", "DISTANCE", "", NULL, FIELD(focus), 0, NUMBER_SMALLEST,
     HUGE_VAL, "where all views show the same", "Distance of the plane in focus."},
    {SETTING_NUMBER, CHANGES_RUN, OPTION_GROUP_VIEWS, "--aperture", "RADIUS", "", NULL, FIELD(aperture), 0, 0, HUGE_VAL,
     NULL, "Radius of the lens."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_VIEWS, "--direction", "LON,LAT[:LON,LAT...]", "", NULL, FIELD(directions),
     0, 0, 0, "0,0",
     "Where to look in a panorama, degrees to the right and up from its middle; several are a path for --frames."},
    {SETTING_NUMBER, CHANGES_RUN, OPTION_GROUP_VIEWS, "--fov", "DEGREES", "", NULL, FIELD(fov), 0, 1, 179, "50",
     "Full vertical angle of the view of a panorama."},
    {SETTING_CHOICE, CHANGES_SAMPLES, OPTION_GROUP_OTHER_PROGRAMS, "--transform-order", NULL, LIST_BARS(SCRIPT_ORDERS),
     NULL, FIELD(script.transform_order), 0, 0, 0, "auto",
     "Order of transforms; new: in the order in which they are written; old: the last one acts first; separate: scale, "
     "then rotate, then translate; auto: gray decides from the text of the script."},
    {SETTING_FLAG, CHANGES_SAMPLES, OPTION_GROUP_OTHER_PROGRAMS, "--lenient", NULL, "", NULL, FIELD(script.lenient), 0,
     0, 0, NULL, "Turn errors in calls of gr into warnings, and render as much of the scene as possible."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_OTHER_PROGRAMS, "--dialect", "NAME|FILE.lua", "", NULL,
     FIELD(script.dialect), 0, 0, 0, "none",
     "Before the scene, run lua/dialects/NAME.lua, or FILE.lua, which defines the functions of another program."},
    {SETTING_WHOLE, CHANGES_RUN, OPTION_GROUP_EXECUTION, "-j", "N", "", NULL, FIELD(threads), 0, 1, 1024,
     "one for each processor", "Number of threads; the picture does not depend on it."},
    {SETTING_DEFINE, CHANGES_RUN, OPTION_GROUP_EXECUTION, "-D", "name=value", "", NULL, NO_FIELD, 0, 0, 0, NULL,
     "Set the Lua global `name` before the script runs; value is a Lua literal, else a string; may be repeated."},
    {SETTING_DEFAULT, CHANGES_RUN, OPTION_GROUP_EXECUTION, "--default", "FIELD=VALUE", "", NULL, NO_FIELD, 0, 0, 0,
     NULL,
     "Set what a picture has whose script does not set FIELD of gr.render, such as samples=2; VALUE as for its option, "
     "yes or no of one without a value; may be repeated."},
    {SETTING_FOLDER, CHANGES_RUN, OPTION_GROUP_SANDBOX, "--allow-read", "DIR", "", NULL, NO_FIELD, 0, 0, 0, NULL,
     "Let scenes read below DIR too; they always read below their own folder, its parent, the working directory and "
     "the library; may be repeated."},
    {SETTING_FOLDER, CHANGES_RUN, OPTION_GROUP_SANDBOX, "--allow-write", "DIR", "", NULL, NO_FIELD, 0, 1, 0, NULL,
     "Let scenes write files below DIR; without this option they cannot write files, because gray itself writes the "
     "pictures; may be repeated."},
    {SETTING_BYTES, CHANGES_RUN, OPTION_GROUP_SANDBOX, "--script-memory", "SIZE", "", NULL, FIELD(script.memory_limit),
     0, 0x1p10, 0x1p50, "4G",
     "Memory limit of a script and the files that it reads, such as 512M or 2G (a plain number is in MiB); script and "
     "picture together may use 1.75 times as much."},
    {SETTING_NUMBER, CHANGES_RUN, OPTION_GROUP_SANDBOX, "--script-time", "SECONDS", "", NULL, FIELD(script.time_limit),
     0, 0.001, HUGE_VAL, "60", "Limit of the processor time of a script; rendering does not count."},
    {SETTING_BYTES, CHANGES_RUN, OPTION_GROUP_SANDBOX, "--script-output", "SIZE", "", NULL, FIELD(script.output_limit),
     0, 0x1p10, 0x1p50, "64M",
     "Limit of what a script prints and writes (a plain number is in MiB); pictures do not count."},
    {SETTING_WHOLE, CHANGES_RUN, OPTION_GROUP_SANDBOX, "--picture-count", "N", "", NULL, FIELD(picture_count), 0, 1,
     INT_MAX, "100000", "Limit of the pictures in a run; a picture that replaces another one counts again."},
    {SETTING_BYTES, CHANGES_RUN, OPTION_GROUP_SANDBOX, "--picture-bytes", "SIZE", "", NULL, FIELD(picture_bytes), 0,
     0x1p10, 0x1p50, "64G", "Limit of the bytes in picture files of a run (a plain number is in MiB)."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_SANDBOX, "--no-sandbox", NULL, "", NULL, FIELD(script.no_sandbox), 0, 0, 0,
     NULL,
     "Turn the sandbox off: scenes may read and write all your files and start programs; only for scenes you trust."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_EXECUTION, "--check", NULL, "", NULL, FIELD(check), 0, 0, 0, NULL,
     "Run the scripts and build their scenes without rendering; report every problem."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_EXECUTION, "--no-fork", NULL, "", NULL, FIELD(no_fork), 0, 0, 0, NULL,
     "Render in one process (for debuggers)."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_MACHINES, "--checkpoint", "FILE", "", NULL, FIELD(checkpoint), 0, 0, 0,
     NULL,
     "Save finished tiles to FILE while rendering, for --resume; auto: a file beside the first picture; SIGUSR1 saves "
     "at once; gray removes the file when all pictures are written."},
    {SETTING_NUMBER, CHANGES_RUN, OPTION_GROUP_MACHINES, "--checkpoint-every", "SECONDS", "", NULL,
     FIELD(checkpoint_every), 0, 0, HUGE_VAL, "10",
     "Shortest time between two checkpoints; saving takes at most a twentieth of the run."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_MACHINES, "--resume", NULL, "", NULL, FIELD(resume), 0, 0, 0, NULL,
     "Continue from the checkpoint (--checkpoint auto unless another file is given); an error if the scene has "
     "changed; with --shard, skip a part that exists already."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_MACHINES, "--radiosity-file", "FILE", "", NULL, FIELD(radiosity_file), 0,
     0, 0, NULL,
     "Keep the solution of integrator radiosity in FILE, or with auto in a file beside the first picture, as "
     "--checkpoint "
     "does: runs with other cameras use it; with --resume another scene is an error.",
     EFFECT_RADIOSITY},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_MACHINES, "--partial", NULL, "", NULL, FIELD(partial), 0, 0, 0, "yes",
     "If rendering dir/foo.png is interrupted, write dir/foo.partial.png: finished tiles, and black for the others; "
     "after a minute also the checkpoint for --resume."},
    {SETTING_SHARD, CHANGES_RUN, OPTION_GROUP_MACHINES, "--shard", "I/N", "", NULL, FIELD(shard), 0, 0, 0, NULL,
     "Render part I of N of every picture into a file of tiles beside it; `gray merge PART ...` joins the parts."},
    {SETTING_SHARD, CHANGES_RUN, OPTION_GROUP_MACHINES, "--shard-pictures", "I/N", "", NULL, FIELD(shard_of_pictures),
     0, 0, 0, NULL, "Render only every Nth picture, starting with the Ith."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_MACHINES, "--mpi", NULL, "", NULL, FIELD(mpi), 0, 0, 0, NULL,
     "Under mpirun: all processes render each picture together; the first one assigns tiles on demand."},
    {SETTING_NUMBER, CHANGES_RUN, OPTION_GROUP_MACHINES, "--farm-stall", "SECONDS", "", NULL, FIELD(farm_stall), 0, 0,
     1e9, "30",
     "With --mpi: kill a render process that could run but uses no processor time for this long; another one renders "
     "its tiles; 0: never."},
    {SETTING_NUMBER, CHANGES_RUN, OPTION_GROUP_MACHINES, "--farm-silence", "SECONDS", "", NULL, FIELD(farm_silence), 0,
     0, 1e9, "60",
     "With --mpi: regard a process that sends nothing for this long as lost; others render its tiles; 0: never."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_REPORTS, "-gui", NULL, "", NULL, FIELD(window), 0, 0, 0, NULL,
     "Show the picture in a window during rendering, walk through the scene and edit it; F1 lists the keys. Files are "
     "watched as with --watch. Without a script the window shows recent files and the demos. A light field or a "
     "panorama is shown as with gray view."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_REPORTS, "--watch", NULL, "", NULL, FIELD(watch), 0, 0, 0, NULL,
     "Run the scripts again when a script, or a file that it reads, changes; Ctrl-C ends gray."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_REPORTS, "-q|quiet", NULL, "", NULL, FIELD(quiet), 0, 0, 0, NULL,
     "Print errors only."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_REPORTS, "--verbose", NULL, "", NULL, FIELD(verbose), 0, 0, 0, NULL,
     "Print details and reasons."},
    {SETTING_STATS, CHANGES_RUN, OPTION_GROUP_REPORTS, "--stats", "text", "none|text|json", NULL, FIELD(statistics), 0,
     0, 0, NULL,
     "Statistics of each picture: a table on standard error, or one line of JSON per picture on standard output."},
    {SETTING_CHOICE, CHANGES_RUN, OPTION_GROUP_REPORTS, "--progress", NULL, LIST_BARS(PROGRESS_MODES), NULL,
     FIELD(progress), 0, 0, 0, "auto",
     "Progress and time left, on standard error; auto: a bar on a terminal, otherwise a line from time to time in long "
     "runs."},
    {SETTING_TEXT, CHANGES_RUN, OPTION_GROUP_REPORTS, "--display", "WHERE", "", NULL, FIELD(display), 0, 0, 0, NULL,
     "Show the picture during rendering: tev[:HOST[:PORT]] in the image viewer tev (port 14158), term in the terminal "
     "(term:kitty, term:sixel or term:blocks choose the protocol)."},
    {SETTING_PIXEL, CHANGES_RUN, OPTION_GROUP_REPORTS, "--pixel", "X,Y", "", NULL, NO_FIELD, 0, 0, 0, NULL,
     "Do not render; explain this pixel of every picture on standard output: its rays, their hits, lights and weights, "
     "and the final bytes; may be repeated."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_REPORTS, "--dump-scene", NULL, "", NULL, FIELD(dump_scene), 0, 0, 0, NULL,
     "Do not render; list the primitives, materials and lights of every picture."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_REPORTS, "--dump-expr", NULL, "", NULL, FIELD(dump_expr), 0, 0, 0, NULL,
     "Do not render; list the operations of every recorded Lua function of a picture."},
    {SETTING_FLAG, CHANGES_RUN, OPTION_GROUP_REPORTS, "--json", NULL, "", NULL, FIELD(json), 0, 0, 0, NULL,
     "Print --pixel, --dump-scene and --dump-expr as JSON, one line per picture."},
    {SETTING_ACTION, CHANGES_RUN, OPTION_GROUP_REPORTS, "--help|h", NULL, "", NULL, FIELD(action), 0, ACTION_HELP, 0,
     NULL, "Print this text."},
    {SETTING_ACTION, CHANGES_RUN, OPTION_GROUP_REPORTS, "--man", "[TOPIC ...]", "", NULL, FIELD(action), 0,
     ACTION_MANUAL, 0, NULL,
     "Print what is known of a function, method, option, field, module of the library or word; without TOPIC, this "
     "text and all functions of the scene language."},
    {SETTING_ACTION, CHANGES_RUN, OPTION_GROUP_REPORTS, "--init", "[FOLDER]", "", NULL, FIELD(action), 0, ACTION_INIT,
     0, NULL, "Write a first scene and the settings of editors (.luarc.json) into FOLDER; replaces no file."},
    {SETTING_ACTION, CHANGES_RUN, OPTION_GROUP_REPORTS, "--annotations", NULL, "", NULL, FIELD(action), 0,
     ACTION_ANNOTATIONS, 0, NULL, "Print the functions as an annotation file for editors (lua/gr.lua)."},
    {SETTING_ACTION, CHANGES_RUN, OPTION_GROUP_REPORTS, "--json-schema", NULL, "", NULL, FIELD(action), 0,
     ACTION_SCHEMA, 0, NULL, "Print the JSON Schema of scenes in JSON."},
    {SETTING_ACTION, CHANGES_RUN, OPTION_GROUP_REPORTS, "--roff", "gray|gray-scene", "", NULL, FIELD(action), 0,
     ACTION_ROFF, 0, NULL, "Print a manual page for man: of the program, or of the scene language."},
    {SETTING_ACTION, CHANGES_RUN, OPTION_GROUP_REPORTS, "--complete", "WORD ...", "", NULL, FIELD(action), 0,
     ACTION_COMPLETE, 0, NULL,
     "For shells: print which kind of file may be the last WORD of a command line, and then the words that it may be."},
    {SETTING_ACTION, CHANGES_RUN, OPTION_GROUP_REPORTS, "--version", NULL, "", NULL, FIELD(action), 0, ACTION_VERSION,
     0, NULL, "Print the versions of the program and of its libraries."},
};

_Static_assert(LIST_COUNT(SETTINGS) + sizeof options_table / sizeof *options_table < OPTIONS_LIMIT,
               "the limit of all options");
int option_count(void) {
    return setting_count + (int)(sizeof options_table / sizeof *options_table);
}

const struct setting *option_at(int index) {
    return index < setting_count ? &setting_table[index] : &options_table[index - setting_count];
}

bool option_is_setting(const struct setting *option) {
    return option >= setting_table && option < setting_table + setting_count;
}

void *option_base(const struct setting *option, struct options *options) {
    return option_is_setting(option) ? (void *)&options->settings : (void *)options;
}

bool option_may_lack_value(const struct setting *option) {
    return option->kind == SETTING_DENOISE || option->kind == SETTING_STATS;
}

const char *option_value(const struct setting *option) {
    return option->words[0] && option->kind != SETTING_NUMBER ? option->words : option->value;
}

/* The default in words, or NULL: that of the row, or of a setting its default. */
static const char *option_initial(const struct setting *option, char out[64]) {
    return option_is_setting(option) ? setting_initial_words(option, out) : option->initial_words;
}

_Static_assert(offsetof(struct options, shards) == offsetof(struct options, shard) + sizeof(uint32_t) &&
                   offsetof(struct options, shards_of_pictures) ==
                       offsetof(struct options, shard_of_pictures) + sizeof(uint32_t),
               "a shard is two numbers in a row");
_Static_assert(offsetof(struct options, height) == offsetof(struct options, width) + sizeof(int),
               "a size is two numbers in a row");

/* --help */

void option_describe(const struct setting *option, struct document *document) {
    char names[256], help[512], word[64];
    const char *initial = option_initial(option, word);
    size_t used = 0;
    for (const char *rest = option->option; *rest;) {
        struct piece name = option_next_piece(&rest);
        used += (size_t)snprintf(names + used, sizeof names - used, "%s%.*s",
                                 used == 0         ? ""
                                 : name.length > 1 ? ", --"
                                                   : ", -",
                                 (int)name.length, name.text);
    }
    if (option_may_lack_value(option))
        (void)snprintf(names + used, sizeof names - used, "[=%s]", option->words);
    else if (option_value(option))
        (void)snprintf(names + used, sizeof names - used, " %s", option_value(option));
    (void)snprintf(help, sizeof help, "%s%s%s%s", option->help, initial ? " (default: " : "", initial ? initial : "",
                   initial ? ")" : "");
    document_entry(document, DOCUMENT_OPTION, names, help);
}

void options_describe(struct document *document) {
    document_paragraph(document,
                       "Long options take one dash or two, and '_' or '-' between words; a space or '=' precedes the "
                       "value. Options without a value take =yes and =no. Options have priority over fields of "
                       "gr.render, except --seed; --default sets what a script leaves open.");
    for (int group = 0; group < OPTION_GROUP_COUNT; group++) {
        document_subsection(document, group_titles[group]);
        for (int i = 0; i < option_count(); i++) {
            if (option_at(i)->option && option_at(i)->group == (enum option_group)group)
                option_describe(option_at(i), document);
        }
    }
    document_section(document, "Exit status");
    document_paragraph(document,
                       "0 all pictures written; 1 error in a scene or a file; 2 wrong usage; 3 error of the "
                       "machine (disk full, out of memory, a crash); 130 interrupted. gray runs every script "
                       "and returns the highest status. Wrong usage and an interruption end the run at once.");
    document_section(document, "Environment");
    document_entry(document, DOCUMENT_OPTION, "GRAY_LUA",
                   "The folder of the Lua library, which require searches last.");
    document_entry(document, DOCUMENT_OPTION, "GRAY_DEVICE", "The device without the option --device.");
    document_entry(document, DOCUMENT_OPTION, "PAGER", "The program that shows --man on a terminal; else less.");
    document_entry(document, DOCUMENT_OPTION, "NO_COLOR, CLICOLOR, CLICOLOR_FORCE",
                   "Messages on a terminal are in colour unless NO_COLOR is set or CLICOLOR is 0; CLICOLOR_FORCE=1: "
                   "everywhere.");
}
