/* How a function of gr or a method of nodes is described: name, arguments with type, range, unit and default, result,
 * help. Argument checking, suggestions, the manual page and the editor annotations are all read from it. Constant data,
 * in rows beside the functions. */
#ifndef GRAY_CALL_FUNCTION_H
#define GRAY_CALL_FUNCTION_H

#include "base/error.h"
#include "base/list.h"
#include "image/tone.h"
#include "light/light.h"
#include "light/sky.h"
#include "material/material.h"
#include "material/medium.h"
#include "mesh/mesh.h"
#include "scene/node.h"

#include <lua.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct script_context;

/* The kinds of arguments: name, what the script must pass, the type in annotations (NULL: the choices), and the Lua
 * types (argument.c). The plain C form is in the member of struct script_value that has the name of the kind; lists
 * also set `count`. The other kinds: number: KIND_WHOLE (a float with a whole value is fine); a word of
 * parameter.choices is the number of a setting vector: KIND_POINT, KIND_DIRECTION, KIND_COLOUR, KIND_TRIPLE (not a
 * position), KIND_SIZE (one number counts for all three), KIND_INTERVAL (x and y), KIND_PAIR (z = 0; one number counts
 * for both), KIND_QUATERNION (and number = w) choice: KIND_CHOICE (index into the words of parameter.choices),
 * KIND_AXIS (0, 1, 2) text: KIND_FILE (to be read, looked for beside the scene), KIND_OUTPUT (to be written)
 *   KIND_MATERIALS: names in byte order, too, or a list: names is NULL
 *   KIND_IMAGE: image, or text: the name of its file
 *   KIND_BACKGROUND: vector, or text = "gradient" or "transparent", or sky, or program
 *   KIND_CAUSTICS: number: photons, vector.x: radius; a number alone is the photons
 *   KIND_FACES: starts, indices; KIND_ROWS: starts, numbers; KIND_CURVES: starts, pairs
 *   KIND_FUNCTION: program; KIND_CALLBACK: stays on the stack of Lua, and is called */
#define KIND_LIST(X)                                                                                                   \
    X(KIND_NUMBER, "number", "a number", "number", LIKE_NUMBER)                                                        \
    X(KIND_WHOLE, "whole", "a whole number", "integer", LIKE_NUMBER)                                                   \
    X(KIND_BOOLEAN, "boolean", "true or false", "boolean", LIKE_BOOLEAN)                                               \
    X(KIND_TEXT, "text", "a string", "string", LIKE_TEXT)                                                              \
    X(KIND_FILE, "file", "the name of a file", "string", LIKE_TEXT)                                                    \
    X(KIND_OUTPUT, "output", "the name of a file", "string", LIKE_TEXT)                                                \
    X(KIND_CHOICE, "choice", "a word", NULL, LIKE_TEXT)                                                                \
    X(KIND_AXIS, "axis", "'x', 'y' or 'z'", NULL, LIKE_TEXT)                                                           \
    X(KIND_POINT, "point", "a point {x, y, z}", "gr.triple", LIKE_TABLE)                                               \
    X(KIND_DIRECTION, "direction", "a direction {x, y, z}", "gr.triple", LIKE_TABLE)                                   \
    X(KIND_COLOUR, "colour", "a colour {r, g, b}", "gr.triple|string", LIKE_TABLE | LIKE_TEXT)                         \
    X(KIND_TRIPLE, "triple", "a table of 3 numbers", "gr.triple", LIKE_TABLE)                                          \
    X(KIND_SIZE, "size", "a number or a table of 3 numbers", "number|gr.triple", LIKE_TABLE | LIKE_NUMBER)             \
    X(KIND_INTERVAL, "interval", "a table of two rising numbers", "number[]", LIKE_TABLE)                              \
    X(KIND_QUATERNION, "quaternion", "a table of 4 numbers {w, x, y, z}", "number[]", LIKE_TABLE)                      \
    X(KIND_PAIR, "pair", "a number or a table of 2 numbers", "number|number[]", LIKE_TABLE | LIKE_NUMBER)              \
    X(KIND_NODE, "node", "a node", "gr.node", 1 << HANDLE_NODE)                                                        \
    X(KIND_MATERIAL, "material", "a material", "gr.material", 1 << HANDLE_MATERIAL)                                    \
    X(KIND_MATERIALS, "materials", "a table of materials", "table<string|integer, gr.material>", LIKE_TABLE)           \
    X(KIND_IMAGE, "image", "the name of a picture file or a texture", "string|gr.texture",                             \
      LIKE_TEXT | 1 << HANDLE_TEXTURE)                                                                                 \
    X(KIND_BACKGROUND, "background", "a colour {r, g, b}, a sky, a function or 'gradient'",                            \
      "gr.triple|string|gr.sky|gr.texture|function|'gradient'",                                                        \
      LIKE_TABLE | LIKE_TEXT | LIKE_FUNCTION | 1 << HANDLE_SKY)                                                        \
    X(KIND_FOG, "fog", "a fog", "gr.fog", 1 << HANDLE_FOG)                                                             \
    X(KIND_MEDIUM, "medium", "a medium", "gr.medium", 1 << HANDLE_MEDIUM)                                              \
    X(KIND_CAUSTICS, "caustics", "a number of photons or {photons = ..., radius = ...}",                               \
      "integer|{photons?: integer, radius?: number}", LIKE_TABLE | LIKE_NUMBER)                                        \
    X(KIND_NODES, "nodes", "a table of nodes", "gr.node[]", LIKE_TABLE)                                                \
    X(KIND_LIGHTS, "lights", "a table of lights", "gr.light[]", LIKE_TABLE)                                            \
    X(KIND_POINTS, "points", "a table of points {x, y, z}", "gr.triple[]", LIKE_TABLE)                                 \
    X(KIND_PAIRS, "pairs", "a table of pairs {u, v}", "number[][]", LIKE_TABLE)                                        \
    X(KIND_STOPS, "stops", "a table of stops {height, r, g, b}", "number[][]", LIKE_TABLE)                             \
    X(KIND_FACES, "faces", "a table of tuples of indices", "integer[][]", LIKE_TABLE)                                  \
    X(KIND_NUMBERS, "numbers", "a number or a table of numbers", "number|number[]", LIKE_TABLE | LIKE_NUMBER)          \
    X(KIND_ROWS, "rows", "a table of tables of numbers", "number[][]", LIKE_TABLE)                                     \
    X(KIND_CURVES, "curves", "a table of tables of pairs {x, z}", "number[][][]", LIKE_TABLE)                          \
    X(KIND_FUNCTION, "function", "a function", "function|gr.texture", LIKE_FUNCTION | 1 << HANDLE_TEXTURE)             \
    X(KIND_CALLBACK, "callback", "a function", "function", LIKE_FUNCTION)
enum argument_kind { KIND_LIST(LIST_MEMBER) KIND_COUNT };

/* What gr.texture, gr.bump and their like made. */
struct script_texture {
    const struct texture *texture;
    struct image_function *function; /* for img:at, made by its first call */
    bool is_bump;
    struct bump bump; /* then, with that texture */
};

/* One argument in plain C. Text belongs to Lua and lives as long as the call, arrays to the call's arena. */
struct script_value {
    bool given;
    bool boolean;
    int choice;
    double number;
    /* Three numbers, which are the same by either name: a point, a direction, factors, or a colour. */
    union {
        struct vec3 vector;
        struct colour colour;
    };
    const char *text;
    struct node *node;
    const struct material *material;
    const struct material **materials;
    const struct script_texture *texture;
    const struct expr_program *program;
    const char *source; /* of the program: "scene.lua:12" */
    const char **names;
    struct image *image;
    uint32_t count;
    struct node **nodes;
    const struct scene_light *lights;
    const double (*points)[3];
    const double (*pairs)[2];
    const double (*stops)[4];
    const struct fog *fog;
    const struct sky *sky;
    const struct tone_table *curve;
    const uint32_t *starts, *indices;
    const double *numbers;
    bool display; /* `colour` is one of the screen */
    bool single;  /* a number alone; of a REST parameter: arguments behind a form */
};

enum {
    OPTIONAL = 1, /* may be left out of the table form */
    LOW_OPEN = 2, /* value > low, not >= */
    HIGH_OPEN = 4,
    NOT_ZERO = 8,
    OR_TEXTURE = 64, /* a texture is accepted, too: `texture` is set, numbers are 1; of KIND_IMAGE: one without image */
    /* Of KIND_CHOICE and KIND_BOOLEAN: a number is accepted, in the range of the parameter; `boolean` is true then. */
    OR_NUMBER = 256,
    OR_CURVE = 2048, /* of KIND_CHOICE: also accepts a function of the light, which sets `curve` */
    /* Of KIND_COLOUR: also accepts a function of the direction; then `program` is set, and colour is 1. Of
     * KIND_FUNCTION: it is a function of the direction. */
    OR_PROFILE = 512,
    /* Of KIND_COLOUR: also accepts a function of the point, in the same way; of KIND_NUMBERS: sets `program`. */
    OR_FUNCTION = 1024,
    OR_FILE = 65536,   /* of KIND_NUMBERS: also accepts the name of a file */
    OR_DISPLAY = 128,  /* of KIND_COLOUR without OR_TEXTURE: also accepts a display colour, which sets `display` */
    OR_COMPASS = 4096, /* of KIND_DIRECTION: also accepts {azimuth = ..., elevation = ...} in degrees */
    OR_PAIR = 8192,    /* of KIND_TEXT: also accepts two numbers */
    OR_SKY = 16384,    /* of KIND_IMAGE: also accepts a sky */
    REST = 32,         /* takes the arguments after a positional form, and entries without names of the table form */
    RARE = 32768,      /* hints of the usual fields leave it out */
    GHOST_IS_NONE = 16 /* with --lenient: a ghost is treated as missing, and the call continues */
};

struct script_parameter {
    const char *name;
    enum argument_kind kind;
    unsigned flags;
    double low, high;     /* of each number; both 0 = any finite number */
    const char *choices;  /* words separated by blanks */
    const char *unit;     /* or NULL */
    const char *fallback; /* the default in words, or NULL */
    const char *help;     /* one sentence */
};

enum function_owner { OWNER_GR, OWNER_NODE };
/* RESULT_FRAMES: nothing; calls the function of the animation. */
#define RESULT_KINDS(X)                                                                                                \
    X(RESULT_NOTHING, "nothing")                                                                                       \
    X(RESULT_SELF, "self")                                                                                             \
    X(RESULT_NODE, "node")                                                                                             \
    X(RESULT_MATERIAL, "material")                                                                                     \
    X(RESULT_LIGHT, "light")                                                                                           \
    X(RESULT_TEXTURE, "texture")                                                                                       \
    X(RESULT_BOUNDS, "bounds")                                                                                         \
    X(RESULT_FACES, "faces")                                                                                           \
    X(RESULT_FOG, "fog")                                                                                               \
    X(RESULT_MEDIUM, "medium")                                                                                         \
    X(RESULT_SKY, "sky")                                                                                               \
    X(RESULT_GLYPHS, "glyphs")                                                                                         \
    X(RESULT_FRAMES, "frames")
enum result_kind { RESULT_KINDS(LIST_MEMBER) };

struct script_result {
    void *pointer;           /* of the type of the result kind; owned by the scene or the assets */
    const struct mesh *mesh; /* RESULT_FACES, in its place */
};

enum { FORM_LIMIT = 5, PARAMETER_LIMIT = 96 };

/* The first argument of a method: the node before the colon. */
enum { SELF };

/* `run` is the C function of a row, which cannot raise. args[i] belongs to parameters[i]. */
struct script_function {
    const char *name;
    enum function_owner owner;
    const struct script_parameter *parameters;
    int parameter_count;
    /* The positional forms: parameter names in their order, separated by blanks; "name?" is optional at the end. The
     * form whose types match the arguments best is used. Parameters in no form exist in the table form only. */
    const char *forms[FORM_LIMIT];
    enum result_kind result;
    bool (*run)(struct script_context *context, const struct script_value *args, struct script_result *result,
                struct error *error);
    const char *help;
    bool in_lua; /* after `run`, the function of that name in lua/words.lua makes the result */
    /* Its first row: a function whose fields are accepted, too, and come back in a table. NULL: none. */
    const struct function_rows *passes;
};

/* The rows of one file. */
struct function_rows {
    const struct script_function *rows;
    int count;
};

/* "gr.sphere" or "node:scale". */
const char *function_title(const struct script_function *function, char out[96]);
/* Its part before the name. */
const char *owner_words(enum function_owner owner);
/* The parameter that takes any number of nodes, or NULL; and its index. */
const struct script_parameter *function_rest(const struct script_function *function, int *index);
/* Whether a call with one table of named fields is a form of it. Most methods take tuples or handles instead. Only
 * methods whose arguments are all optional, and node:render, have fields. */
bool function_takes_names(const struct script_function *function);
/* Whether it renders pictures: the only ones that write a file. Their positional form may end with a table of
 * fields. */
bool function_renders(const struct script_function *function);
/* Reads the next name of a form: false at its end. *index is its parameter. */
bool form_next(const struct script_function *function, const char **form, int *index, bool *optional);
/* Pushes a description for Lua of the program: name, owner ("gr" or "node"), result, whether it renders, `rest`, the
 * name of the parameter that takes any number of nodes, `row`, its address, and the parameters as entries, the first
 * argument at `first`, behind the node of a method. Each has name, kind, choices, help, low, high, `row`, and its flags
 * in lower case. */
void function_push(lua_State *L, const struct script_function *function);
/* What the script must pass: "a number", "a colour {r, g, b}". */
const char *kind_words(enum argument_kind kind);
/* "number", "colour". */
const char *kind_name(enum argument_kind kind);

#endif
