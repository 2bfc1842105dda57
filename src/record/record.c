/* The paths of a function, one call each, depth first: `decisions` is the path; after a call the last answer that is
 * still `true` becomes `false`. The result of the paths under an answer `true` waits in its decision for that of the
 * paths under `false`, and both become one selection. So the selections nest as the branches of the function do.
 *
 * The recording is compared with the results of Lua at RECORD_POINTS points. This detects a function that depends on
 * more than its arguments. */
#include "record/record_internal.h"

#include "base/random.h"
#include "math/exact.h"
#include "record/record_bounds.h"
#include "record/record_interval_internal.h"
#include "record/symbol.h"
#include "sandbox/hints.h"

#include <float.h>
#include <lauxlib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* WORK: symbols made, about a quarter of a microsecond each. */
enum { RECORD_POINTS = 1000, WORK_BEFORE_COUNTING = 300000, WORK_OF_COUNTING = 1000000, FIRST_INPUT = 3 };

/* Indexing a table with a symbol, t[x], gives nil. */
#define TABLE_HINT "; a number of the recorded function cannot be the index of a table; use gr.lookup(t, i)"
#define NIL_HINT                                                                                                       \
    "; nil is the value of a field that does not exist, of tonumber(text), and of t[x] where x is a number of the "    \
    "recorded function: use gr.lookup(t, i)"
#define TEXT_HINT                                                                                                      \
    "; a number of the recorded function has no value yet, so it cannot become text or choose an argument; use "       \
    "operators, comparisons and the functions of math and gr"
#define FOR_HINT                                                                                                       \
    "; the bounds of a for loop must not depend on the arguments of the function, gr.loop(n, state, f) may end "       \
    "earlier"

/* Whether the function that runs is called again, for another path or a comparison. */
static bool is_silent(const struct recorder *recorder) {
    bool is_first = recorder->prints;
    for (uint32_t k = 1; recorder->active && k <= recorder->level; k++)
        is_first = is_first && recorder->frames[k].is_first;
    return recorder->busy && !is_first;
}

void record_open(lua_State *L) {
    struct sandbox *sandbox = sandbox_of(L);
    sandbox->recorder = arena_alloc(&sandbox->keep, sizeof *sandbox->recorder);
    if (!sandbox->recorder)
        sandbox_raise_no_memory(sandbox);
    sandbox->is_silent = is_silent;
    symbols_open(L);
    vectors_open(L);
}

void recorder_destroy(struct recorder *recorder) {
    if (!recorder)
        return;
    expr_graph_destroy(&recorder->graph);
    for (int k = 0; k < RECORD_LEVELS; k++) {
        mem_free(recorder->frames[k].decisions);
        recorder->frames[k].decisions = NULL;
    }
    mem_free(recorder->answers);
    record_interval_end(recorder);
    recorder->answers = NULL;
    recorder->active = recorder->busy = recorder->samples = false;
}

const char *record_activity(lua_State *L) {
    const struct recorder *recorder = recorder_of(L);
    if (!recorder->busy)
        return NULL;
    return recorder->samples ? "tone curve" : "function that is recorded";
}

/* --- calls --- */

/* Pushes {u =, v =, normal =, view =, world =, time =} of fifteen values below, in the order of EXPR_INPUTS, and before
 * it the point; they stay. */
static void push_arguments(lua_State *L, int first) {
    for (int k = 0; k < 3; k++)
        lua_pushvalue(L, first + EXPR_POINT_X + k);
    push_vector(L);
    lua_createtable(L, 0, 6);
    lua_pushvalue(L, first + EXPR_U);
    lua_setfield(L, -2, "u");
    lua_pushvalue(L, first + EXPR_V);
    lua_setfield(L, -2, "v");
    static const struct {
        const char *name;
        int input;
    } vectors[] = {{"normal", EXPR_NORMAL_X}, {"view", EXPR_VIEW_X}, {"world", EXPR_WORLD_X}};
    for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++) {
        for (int k = 0; k < 3; k++)
            lua_pushvalue(L, first + vectors[i].input + k);
        push_vector(L);
        lua_setfield(L, -2, vectors[i].name);
    }
    lua_pushvalue(L, first + EXPR_TIME);
    lua_setfield(L, -2, "time");
}

int record_add_position(lua_State *L) {
    struct sandbox *sandbox = sandbox_of(L);
    char where[PATH_SIZE + 32];
    if (sandbox_is_over(sandbox))
        return 1;
    const char *text = lua_type(L, 1) == LUA_TSTRING ? lua_tostring(L, 1) : NULL;
    if (!text) {
        lua_pushfstring(L, "the function raised %s", value_words(L, 1));
        text = lua_tostring(L, -1);
    }
    text = sandbox_relocate(L, text);
    const char *hint = hint_of_lua_error(L, text);
    if (strstr(text, ":") && strspn(strstr(text, ":") + 1, "0123456789") > 0) {
        lua_pushfstring(L, "%s%s", text, hint);
        return 1;
    }
    sandbox->lua = L;
    sandbox_where(sandbox, where, sizeof where);
    lua_pushfstring(L, "%s%s", where, text);
    return 1;
}

/* Replaces the sentence on top by "scene.lua:12: SENTENCE" with the line where the function begins; not for a C
 * function, such as math.log. */
static void name_function(lua_State *L, int function) {
    lua_Debug where;
    lua_pushvalue(L, function);
    (void)lua_getinfo(L, ">S", &where);
    if (where.linedefined < 0)
        return;
    lua_pushfstring(L, "%s:%d: %s", where.short_src, where.linedefined, lua_tostring(L, -1));
    lua_replace(L, -2);
}

/* The error is on top. Functions of modules have other parameters than the function that is wanted. */
static void advise_wrapper(lua_State *L, int function) {
    lua_Debug where;
    lua_pushvalue(L, function);
    if (!lua_getinfo(L, ">S", &where) || !sandbox_is_library(sandbox_of(L), where.source) ||
        lua_type(L, -1) != LUA_TSTRING)
        return;
    const char *module = strrchr(where.source, '/') + 1, *name = NULL;
    lua_pushlstring(L, module, strcspn(module, "."));
    module = lua_tostring(L, -1);
    int top = lua_gettop(L);
    if (lua_getfield(L, LUA_REGISTRYINDEX, LUA_LOADED_TABLE) == LUA_TTABLE && lua_getfield(L, -1, module) == LUA_TTABLE)
        for (lua_pushnil(L); !name && lua_next(L, -2); lua_pop(L, 1))
            name = lua_rawequal(L, -1, function) && lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : NULL;
    if (name)
        lua_pushfstring(L, "%s; write function(p) return %s.%s(p) end", lua_tostring(L, top - 1), module, name);
    else
        lua_pushvalue(L, top - 1);
    lua_replace(L, top - 1);
    lua_settop(L, top - 1);
}

/* Calls the function at `function` with the values from `first` on. Pushes its first result, or the error. */
static bool call_function(lua_State *L, int function, int first) {
    struct sandbox *sandbox = sandbox_of(L);
    lua_pushcfunction(L, record_add_position);
    int handler = lua_gettop(L);
    lua_pushvalue(L, function);
    push_arguments(L, first);
    int status = lua_pcall(L, 2, LUA_MULTRET, handler);
    sandbox->lua = L;
    if (sandbox_is_over(sandbox))
        limits_check(L);
    int results = lua_gettop(L) - handler;
    if (status == LUA_OK && results != 1) {
        lua_settop(L, handler - 1);
        lua_pushfstring(L, "the function returns %d values, not a number or a colour {r, g, b}", results);
        name_function(L, function);
        return false;
    }
    lua_remove(L, handler);
    if (status != LUA_OK)
        advise_wrapper(L, function);
    return status == LUA_OK;
}

/* What to return instead of the value at an index. */
static const char *result_hint(lua_State *L, int index) {
    switch (lua_type(L, index)) {
    case LUA_TNIL:
        return NIL_HINT;
    case LUA_TSTRING:
        return lua_tostring(L, index)[0] == '#' ? "; colour.hex of require 'colour' makes a colour from such a text"
                                                : "";
    case LUA_TBOOLEAN:
        return "; gr.where(condition, 1, 0) is a number";
    case LUA_TTABLE:
        return " that does not contain three numbers";
    default:
        return "";
    }
}

/* The count of numbers in the value on top: 1 for a number or symbol, 3 for three of them; else 0, and a sentence that
 * describes the value replaces it. */
static bool is_result(lua_State *L, int function, int *count) {
    int top = lua_gettop(L);
    /* A number of another recording. */
    if (is_symbol(L, top) && !recorder_of(L)->active) {
        lua_pushliteral(L, "a number of a recorded function is used outside the function");
        name_function(L, function);
        lua_replace(L, top);
        return false;
    }
    /* A number, or three of them. */
    *count = 1;
    if (lua_type(L, top) == LUA_TNUMBER || is_symbol(L, top))
        return true;
    *count = 3;
    if (lua_type(L, top) == LUA_TTABLE && lua_rawlen(L, top) == 3) {
        bool fine = true;
        for (int k = 1; k <= 3; k++) {
            lua_rawgeti(L, top, k);
            fine = fine && (lua_type(L, -1) == LUA_TNUMBER || is_symbol(L, -1));
        }
        lua_settop(L, top);
        if (fine)
            return true;
    }
    /* The error says what it is. */
    const char *words = value_words(L, top);
    lua_pushfstring(L, "the function must return a number or a colour {r, g, b}, not %s%s", words, result_hint(L, top));
    name_function(L, function);
    lua_replace(L, top);
    return false;
}

/* --- paths --- */

/* The node of output `k` of a result; NaN for an error. */
static uint32_t output_of(lua_State *L, const struct path_result *result, int k) {
    if (result->count == 0) {
        lua_pushnumber(L, (double)NAN);
        uint32_t node = number_at(L, -1).node;
        lua_pop(L, 1);
        return node;
    }
    return result->nodes[result->count == 1 ? 0 : k];
}

static struct path_result join(lua_State *L, const struct decision *decision, const struct path_result *if_false) {
    const struct path_result *if_true = &decision->if_true;
    struct path_result out = {.count = if_true->count > if_false->count ? if_true->count : if_false->count};
    for (int k = 0; k < out.count; k++)
        out.nodes[k] =
            record_operation(L, EXPR_SELECT, decision->condition, output_of(L, if_true, k), output_of(L, if_false, k));
    return out;
}

static const char *hint_of(const char *text) {
    if (strstr(text, "a nil value (field '?')") || strstr(text, "index is"))
        return TABLE_HINT;
    if (strstr(text, "bad 'for' "))
        return FOR_HINT;
    bool is_text = strstr(text, "number expected, got recorded number") ||
                   strstr(text, "string expected, got recorded number") ||
                   strstr(text, "concatenate a recorded number") || strstr(text, "in table for 'concat'");
    return is_text ? TEXT_HINT : "";
}

void record_keep_error(lua_State *L, int index) {
    struct recorder *recorder = recorder_of(L);
    const char *text = lua_type(L, index) == LUA_TSTRING ? lua_tostring(L, index) : "";
    if (!recorder->path_error[0])
        (void)snprintf(recorder->path_error, sizeof recorder->path_error, "%.300s%s", text, hint_of(text));
}

/* One call. The index `error` holds the first error of all calls. */
static struct path_result record_path(lua_State *L, int function, int first, int error) {
    struct recorder *recorder = recorder_of(L);
    struct path_result result = {.count = 0};
    int top = lua_gettop(L);
    record_begin_path(L);
    bool fine = call_function(L, function, first) && is_result(L, function, &result.count);
    recorder->prints = false;
    if (recorder->gave_up) /* even if the function caught the error */
        fine = false;
    if (!fine) {
        result.count = 0;
        record_keep_error(L, top + 1);
        if (lua_isnil(L, error))
            lua_copy(L, top + 1, error);
        lua_settop(L, top);
        return result;
    }
    for (int k = 0; k < result.count; k++) {
        if (result.count == 3)
            lua_rawgeti(L, top + 1, k + 1);
        else
            lua_pushvalue(L, top + 1);
        result.nodes[k] = record_node(L, number_float(recorder, number_at(L, -1)));
        lua_pop(L, 1);
    }
    lua_settop(L, top);
    return result;
}

/* Raises the text at an index, which contains its position. */
_Noreturn static void raise_text(lua_State *L, int index) {
    const char *text = lua_tostring(L, index);
    lua_pushfstring(L, "%s%s", text, hint_of(text));
    lua_error(L);
    __builtin_unreachable();
}

_Noreturn static void raise_too_many_paths(lua_State *L, int function) {
    lua_pushfstring(
        L,
        "the function has more than %d paths; gr.where(x, a, b), gr.step, gr.min and gr.max choose without a "
        "path each, and gr.loop(n, state, f) repeats",
        RECORD_PATHS);
    name_function(L, function);
    lua_error(L);
    __builtin_unreachable();
}

static void raise_if_given_up(lua_State *L) {
    const struct recorder *recorder = recorder_of(L);
    if (!recorder->gave_up)
        return;
    lua_pushstring(L, recorder->error);
    lua_error(L);
}

/* Records all paths. False: they are not finished after WORK_BEFORE_COUNTING, and `may_stop`. */
static bool record_paths(lua_State *L, int function, int first, bool may_stop, struct path_result *out) {
    struct recorder *recorder = recorder_of(L);
    struct record_frame *frame = &recorder->frames[0];
    lua_pushnil(L);
    int error = lua_gettop(L);
    for (frame->depth = 0; !may_stop || recorder->work < WORK_BEFORE_COUNTING;) {
        struct path_result result = record_path(L, function, first, error);
        raise_if_given_up(L);
        while (frame->depth > 0 && !frame->decisions[frame->depth - 1].answer)
            result = join(L, &frame->decisions[--frame->depth], &result);
        if (frame->depth == 0) {
            if (result.count == 0)
                raise_text(L, error);
            lua_settop(L, error - 1);
            *out = result;
            return true;
        }
        struct decision *last = &frame->decisions[frame->depth - 1];
        last->if_true = result;
        record_turn_last(recorder);
        if (frame->branches >= RECORD_PATHS)
            raise_too_many_paths(L, function);
    }
    return false;
}

/* --- the number of paths --- */

/* A decision of some path. */
struct branch {
    uint32_t condition, above, depth; /* above: the decision before it */
    bool side, answer;                /* the answer of that one; the answer that a call took */
};

/* Makes the path that ends with the other answer at the decision `at`. */
static void begin_with(struct recorder *recorder, const struct branch *branches, uint32_t at) {
    struct record_frame *frame = &recorder->frames[0];
    bool answer = !branches[at].answer;
    frame->depth = branches[at].depth + 1;
    for (uint32_t k = frame->depth; k-- > 0;) {
        frame->decisions[k] = (struct decision){
            .condition = branches[at].condition, .serial = ++recorder->decision_serial, .answer = answer};
        answer = branches[at].side;
        at = branches[at].above;
    }
}

/* Raises the error of too many paths if some calls show that there are more: each decision that they reach makes one
 * more path. Breadth first, because decisions near the beginning lead to the most others; depth first, thousands of
 * long paths would come before. Every other call answers `false`: where `true` ends a recursion, that call is long. */
static void count_paths(lua_State *L, int function, int first) {
    struct recorder *recorder = recorder_of(L);
    struct record_frame *frame = &recorder->frames[0];
    struct branch *branches = lua_newuserdatauv(L, RECORD_PATHS * sizeof *branches, 0);
    uint32_t count = 0, next = 0;
    lua_pushnil(L);
    int error = lua_gettop(L);
    frame->depth = 0;
    do {
        /* A call takes the decisions so far and finds new ones. */
        uint32_t known = frame->depth;
        (void)record_path(L, function, first, error);
        raise_if_given_up(L);
        /* Each new decision is a branch whose other side is to be taken. */
        for (uint32_t k = known; k < frame->depth; k++) {
            uint32_t above = k > known ? count - 1 : next - 1;
            if (count + 1 >= RECORD_PATHS)
                raise_too_many_paths(L, function);
            bool side = k > known ? branches[above].answer : k > 0 && !branches[above].answer;
            branches[count++] =
                (struct branch){frame->decisions[k].condition, above, k, side, frame->decisions[k].answer};
        }
        /* The next call takes the other side of the oldest branch. */
        if (next == count)
            break;
        begin_with(recorder, branches, next++);
        recorder->prefers_false = !recorder->prefers_false;
    } while (recorder->work < WORK_OF_COUNTING);
    recorder->prefers_false = false;
    lua_settop(L, error - 2);
}

/* --- comparison --- */

/* The inputs of point `i`: numbers of all sizes up to 100, whole and half ones, zeros of both signs, equal coordinates;
 * u, v and time between 0 and 1, unit vectors. */
static void test_point(uint32_t i, enum record_domain domain, double out[EXPR_INPUT_COUNT]) {
    uint64_t key = random_combine(18, i);
    for (int k = 0; k < EXPR_INPUT_COUNT; k++) {
        uint64_t bits = random_combine(key, (uint64_t)k);
        double x = 2 * random_unit(bits) - 1, scale = i % 4 == 0 ? 100 : i % 4 == 1 ? 10 : 1;
        out[k] = i % 5 == 4 ? floor(scale * x * 2 + 0.5) / 2 : scale * x;
        if (i % 29 == 28 && k % 3 != (int)(i % 3))
            out[k] = i % 2 ? 0.0 : -0.0;
        if (i % 31 == 30 && k > 0)
            out[k] = out[k - 1];
    }
    static const int units[] = {EXPR_U, EXPR_V, EXPR_TIME};
    const int directions[] = {EXPR_NORMAL_X, EXPR_VIEW_X, domain == RECORD_DIRECTIONS ? EXPR_POINT_X : EXPR_NORMAL_X};
    for (size_t n = 0; n < sizeof units / sizeof units[0]; n++)
        out[units[n]] = random_unit(random_combine(key, 100 + n));
    for (size_t n = 0; n < sizeof directions / sizeof directions[0]; n++) {
        double *d = &out[directions[n]];
        double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], length = sqrt(square);
        for (int k = 0; k < 3; k++)
            d[k] = square > 0 ? d[k] / length : k == 2;
    }
}

static bool same_number(double a, double b) {
    return to_bits(a) == to_bits(b) || (a != a && b != b);
}

static void describe_outputs(const double *values, int count, char *out, size_t size) {
    if (count == 1)
        (void)snprintf(out, size, "%.17g", values[0]);
    else
        (void)snprintf(out, size, "{%.17g, %.17g, %.17g}", values[0], values[1], values[2]);
}

struct comparison {
    const struct expr_program *program;
    enum record_domain domain;
    const struct box *bounds; /* of p; NULL: any */
    double sum[3], largest[3];
};

static double corner(const struct vec3 *p, int k) {
    return k == 0 ? p->x : k == 1 ? p->y : p->z;
}

/* A point within the bounds: whole and half numbers, zeros of both signs and equal coordinates, if the bounds contain
 * them. */
static void put_in_bounds(uint32_t i, const struct box *bounds, double out[3]) {
    for (int k = 0; k < 3; k++) {
        double low = corner(&bounds->min, k), high = corner(&bounds->max, k);
        double x = low + random_unit(random_combine(random_combine(19, i), (uint64_t)k)) * (high - low);
        double fitting = i % 5 == 4 ? floor(2 * x + 0.5) / 2 : i % 29 == 28 ? (i % 2 ? 0.0 : -0.0) : x;
        if (i % 31 == 30 && k > 0)
            fitting = out[k - 1];
        out[k] = fitting >= low && fitting <= high ? fitting : x < low ? low : x > high ? high : x;
    }
}

static void add_results(struct comparison *comparison, const double results[EXPR_OUTPUTS]) {
    for (int k = 0; k < comparison->program->output_count; k++) {
        comparison->sum[k] += isfinite(results[k]) ? results[k] : 0;
        comparison->largest[k] = results[k] > comparison->largest[k] ? results[k] : comparison->largest[k];
    }
}

static void compare_point(lua_State *L, int function, uint32_t i, struct comparison *comparison) {
    double inputs[EXPR_INPUT_COUNT], recorded[EXPR_OUTPUTS], called[3];
    int top = lua_gettop(L), count = 0, outputs = comparison->program->output_count;
    /* Lua is called with the inputs of point i. */
    test_point(i, comparison->domain, inputs);
    if (comparison->bounds)
        put_in_bounds(i, comparison->bounds, &inputs[EXPR_POINT_X]);
    for (int k = 0; k < EXPR_INPUT_COUNT; k++)
        lua_pushnumber(L, inputs[k]);
    if (!call_function(L, function, top + 1) || !is_result(L, function, &count))
        raise_text(L, lua_gettop(L));
    /* The program computes the same. */
    expr_evaluate(comparison->program, inputs, recorded);
    int result = lua_gettop(L);
    bool same = true;
    for (int k = 0; k < outputs; k++) {
        if (count == 3)
            lua_rawgeti(L, result, k + 1);
        else
            lua_pushvalue(L, result);
        called[k] = lua_tonumber(L, -1);
        lua_pop(L, 1);
        same = same && same_number(called[k], recorded[k]);
    }
    add_results(comparison, recorded);
    lua_settop(L, top);
    if (same && count <= outputs)
        return;
    /* The error says where they differ. */
    char a[128], b[128];
    describe_outputs(called, outputs, a, sizeof a);
    describe_outputs(recorded, outputs, b, sizeof b);
    lua_Debug where;
    lua_pushvalue(L, function);
    (void)lua_getinfo(L, ">S", &where);
    char text[2 * RECORD_ERROR];
    const char *path_error = comparison->bounds ? "" : recorder_of(L)->path_error;
    if (path_error[0])
        (void)snprintf(text, sizeof text,
                       "the function of line %d cannot be recorded: at p = {%.17g, %.17g, %.17g} it gives %s, recorded "
                       "%s; one of its paths ends with an error: %s",
                       where.linedefined, inputs[0], inputs[1], inputs[2], a, b, path_error);
    else
        (void)snprintf(
            text, sizeof text,
            "the function of line %d cannot be recorded: at p = {%.17g, %.17g, %.17g} it gives %s, recorded %s; "
            "it must depend only on its arguments, and x == 0 cannot be recorded (write x >= 0 and x <= 0), nor "
            "can t[x] = y and tostring(x)",
            where.linedefined, inputs[0], inputs[1], inputs[2], a, b);
    lua_pushstring(L, text);
    lua_error(L);
}

/* --- all of it --- */

static void begin(lua_State *L) {
    struct sandbox *sandbox = sandbox_of(L);
    struct recorder *recorder = sandbox->recorder;
    expr_graph_destroy(&recorder->graph);
    if (!recorder->frames[0].decisions)
        recorder->frames[0].decisions = mem_alloc_zero(RECORD_PATHS, sizeof *recorder->frames[0].decisions);
    if (!recorder->answers)
        recorder->answers = mem_alloc_zero(EXPR_NODES, sizeof *recorder->answers);
    if (!recorder->frames[0].decisions || !recorder->answers)
        sandbox_raise_no_memory(sandbox);
    memset(recorder->answers, 0, EXPR_NODES * sizeof *recorder->answers);
    recorder->serial++;
    recorder->level = recorder->calls = recorder->loop_depth = 0;
    recorder->work = 0;
    recorder->frames[0].branches = recorder->frames[0].taken = 0;
    recorder->frames[0].serial = recorder->decision_serial = 1;
    recorder->has_loop = false;
    recorder->gave_up = false;
    recorder->prefers_false = false;
    recorder->path_error[0] = '\0';
    recorder->active = true;
}

/* A recording on its way. */
struct work {
    struct arena *arena;
    enum record_domain domain;
    struct expr_program *program;
    const char *source;
    struct comparison comparison;
};

static void compile(lua_State *L, const struct path_result *result, struct work *work) {
    struct sandbox *sandbox = sandbox_of(L);
    struct arena *arena = work->arena;
    struct error error = {0};
    lua_Debug where;
    lua_pushvalue(L, 1);
    (void)lua_getinfo(L, ">S", &where);
    work->source = arena_format(arena, "%s:%d", where.short_src, where.linedefined);
    work->program = arena_alloc(arena, sizeof *work->program);
    if (!work->source || !work->program)
        sandbox_raise_no_memory(sandbox);
    if (!expr_compile(&sandbox->recorder->graph, result->nodes, result->count, arena, work->program, &error))
        sandbox_raise_error(sandbox, &error);
    work->program->source = work->source;
}

/* Begins with an empty graph. The inputs are the values from index 3 on. */
static void begin_with_inputs(lua_State *L) {
    struct recorder *recorder = recorder_of(L);
    lua_settop(L, FIRST_INPUT - 1);
    begin(L);
    for (int k = 0; k < EXPR_INPUT_COUNT; k++)
        push_symbol(L, (struct number){NUMBER_FLOAT, expr_input(&recorder->graph, (enum expr_input)k), EXPR_NONE});
}

/* Arguments: the function, and the struct recording. */
static int record_protected(lua_State *L) {
    struct recorder *recorder = recorder_of(L);
    struct work *work = lua_touserdata(L, 2);
    struct path_result result;
    luaL_checkstack(L, 2 * EXPR_INPUT_COUNT + 20, "a function");
    begin_with_inputs(L);
    if (!record_paths(L, 1, FIRST_INPUT, true, &result)) {
        begin_with_inputs(L);
        count_paths(L, 1, FIRST_INPUT);
        begin_with_inputs(L);
        (void)record_paths(L, 1, FIRST_INPUT, false, &result);
    }
    recorder->active = false;
    lua_settop(L, 2);
    compile(L, &result, work);
    work->comparison = (struct comparison){.program = work->program, .domain = work->domain, .largest = {1, 1, 1}};
    for (uint32_t i = 0; i < RECORD_POINTS; i++)
        compare_point(L, 1, i, &work->comparison);
    return 0;
}

void record_compare_in_bounds(lua_State *L, const struct recorded_function *function) {
    struct comparison comparison = {
        .program = function->program, .domain = function->domain, .bounds = &function->bounds};
    int index = lua_gettop(L);
    luaL_checkstack(L, 2 * EXPR_INPUT_COUNT + 20, "a function");
    for (uint32_t i = 0; i < RECORD_POINTS; i++)
        compare_point(L, index, i, &comparison);
}

static bool reads_coordinates(const struct expr_program *program) {
    for (int k = 0; k < program->input_count; k++)
        if (program->inputs[k].input == EXPR_U || program->inputs[k].input == EXPR_V)
            return true;
    return false;
}

/* Where no hit is known, the mean and the largest value at the points of the comparison represent the function. */
static struct texture texture_of(const struct expr_program *program, const char *source,
                                 const struct comparison *comparison) {
    int last = program->output_count - 1;
    struct colour sum = colour_make(comparison->sum[0], comparison->sum[last / 2], comparison->sum[last]);
    struct colour largest =
        colour_make(comparison->largest[0], comparison->largest[last / 2], comparison->largest[last]);
    struct texture out =
        texture_function(program, reads_coordinates(program), colour_scale(sum, 1.0 / RECORD_POINTS), largest);
    out.source = source;
    return out;
}

struct texture record_texture_of(const struct expr_program *program) {
    struct comparison comparison = {.program = program, .largest = {1, 1, 1}};
    for (uint32_t i = 0; i < RECORD_POINTS; i++) {
        double inputs[EXPR_INPUT_COUNT], outputs[EXPR_OUTPUTS];
        test_point(i, RECORD_POINTS_OF_SPACE, inputs);
        expr_evaluate(program, inputs, outputs);
        add_results(&comparison, outputs);
    }
    return texture_of(program, program->source, &comparison);
}

/* Calls `run` with the function at an absolute index and `data`. Leaves an error on top. */
static int run_once(struct sandbox *sandbox, lua_CFunction run, int index, void *data) {
    lua_State *L = sandbox->lua;
    struct recorder *recorder = sandbox->recorder;
    lua_pushcfunction(L, run);
    lua_pushvalue(L, index);
    lua_pushlightuserdata(L, data);
    int status = lua_pcall(L, 2, 0, 0);
    recorder->active = false;
    expr_graph_destroy(&recorder->graph);
    sandbox->lua = L;
    return status;
}

/* Calls `run` with the function at an absolute index and `data`. If a step of a loop does something that a symbol does
 * not support (it compares its number with ==), calls it again and records all steps one by one. Raises every error,
 * prefixed by the name of the argument. */
static void run_protected(struct sandbox *sandbox, lua_CFunction run, int index, void *data, const char *name) {
    lua_State *L = sandbox->lua;
    struct recorder *recorder = sandbox->recorder;
    recorder->busy = recorder->prints = true;
    recorder->unrolls = recorder->has_loop = false;
    int status = run_once(sandbox, run, index, data);
    bool is_final = recorder->gave_up || sandbox->fatal.kind != ERROR_NONE || sandbox->limits.memory_out;
    if (status != LUA_OK && recorder->has_loop && !is_final) {
        recorder->unrolls = true;
        if (run_once(sandbox, run, index, data) == LUA_OK)
            status = LUA_OK;
        bool is_fatal = sandbox->fatal.kind != ERROR_NONE || sandbox->limits.memory_out;
        lua_remove(L, status == LUA_OK || !is_fatal ? -1 : -2); /* of two errors, the first one is more useful */
    }
    recorder->busy = recorder->samples = recorder->prints = false;
    if (status != LUA_OK && lua_type(L, -1) == LUA_TSTRING && !sandbox->limits.memory_out)
        sandbox_raise(sandbox, "%s: %s", name, lua_tostring(L, -1));
    if (status != LUA_OK)
        lua_error(L); /* a fatal error, which the sandbox has recorded */
}

void record_function(struct sandbox *sandbox, int index, const char *name, enum record_domain domain,
                     struct arena *arena, struct recording *out) {
    struct work work = {.arena = arena, .domain = domain};
    run_protected(sandbox, record_protected, index, &work, name);
    record_remember(sandbox, index, work.program, domain);
    *out = (struct recording){.program = work.program,
                              .source = work.source,
                              .texture = texture_of(work.program, work.source, &work.comparison)};
}

/* --- tone curves --- */

/* Raises the sentence on top with the place of the function at index 1. */
static int raise_of_curve(lua_State *L) {
    name_function(L, 1);
    return lua_error(L);
}

/* One call at each light of the table, without the work of a protected call. Arguments: the function, the table. */
static int sample_curve(lua_State *L) {
    struct tone_table *table = lua_touserdata(L, 2);
    for (int i = 0; i < TONE_ENTRIES; i++) {
        /* The call. */
        lua_settop(L, 2);
        lua_pushvalue(L, 1);
        lua_pushnumber(L, tone_table_light(i));
        lua_call(L, 1, LUA_MULTRET);
        recorder_of(L)->prints = false;
        /* It must return one finite number. */
        int results = lua_gettop(L) - 2;
        if (results != 1) {
            lua_pushfstring(L, "the function returns %d values, not a number", results);
            return raise_of_curve(L);
        }
        if (lua_type(L, 3) != LUA_TNUMBER) {
            lua_pushfstring(L, "the function must return a number, not %s", value_words(L, 3));
            return raise_of_curve(L);
        }
        double value = lua_tonumber(L, 3);
        if (!(fabs(value) <= (double)FLT_MAX)) {
            char words[128];
            (void)snprintf(words, sizeof words, "the function must return finite numbers; at x = %.9g it returns %s",
                           tone_table_light(i), value != value ? "NaN (not a number)" : "a number that is too large");
            lua_pushstring(L, words);
            return raise_of_curve(L);
        }
        table->values[i] = (float)value;
    }
    return 0;
}

/* Errors in the function get their position while the stack still exists. */
static int sample_protected(lua_State *L) {
    lua_settop(L, 2);
    lua_pushcfunction(L, record_add_position);
    lua_pushcfunction(L, sample_curve);
    lua_pushvalue(L, 1);
    lua_pushvalue(L, 2);
    if (lua_pcall(L, 2, 0, 3) != LUA_OK)
        lua_error(L);
    return 0;
}

const struct tone_table *record_tone_curve(struct sandbox *sandbox, int index, const char *name) {
    struct tone_table *table = arena_alloc(&sandbox->call, sizeof *table);
    if (!table)
        sandbox_raise_no_memory(sandbox);
    sandbox->recorder->samples = true;
    run_protected(sandbox, sample_protected, index, table, name);
    return table;
}
