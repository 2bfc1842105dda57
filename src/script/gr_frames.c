/* gr.frames: an animation in one script. The frames are rendered one after the other inside the call, so only one of
 * them is in memory. `draw` is called for every frame from the first one on, also for frames that this run does not
 * render, so that a script may move its nodes a little in each call; math.random starts from a seed of the frame. */
#include "script/gr_frames_internal.h"

#include "script/dispatch_internal.h"
#include "script/rows_internal.h"
#include "script/script_internal.h"
#include "script/table_internal.h"

#include <lauxlib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FRAMES_COUNT, FRAMES_DRAW, FRAMES_SECONDS, FRAMES_FPS, FRAMES_LOOP, FRAMES_SHUTTER, FRAMES_PURE, FRAMES_END };

static const struct script_parameter frames_parameters[] = {
    [FRAMES_COUNT] = {"count", KIND_WHOLE, OPTIONAL, ABOVE(1), NULL, NULL,
                      "Number of frames; give either count or seconds."},
    [FRAMES_DRAW] = {"draw", KIND_CALLBACK, 0, ANY, NULL, NULL,
                     "draw(t, frame) returns the table of fields for gr.render; t is from 0 to 1, frame from 1."},
    [FRAMES_SECONDS] = {"seconds", KIND_NUMBER, OPTIONAL | LOW_OPEN, ABOVE(0), "seconds", NULL,
                        "Duration: seconds times fps is the number of frames, rounded."},
    [FRAMES_FPS] = {"fps", KIND_NUMBER, OPTIONAL, IN_RANGE(FRAME_RATE_MIN, FRAME_RATE_MAX), NULL, "30",
                    "Frames per second; --fps has priority."},
    [FRAMES_LOOP] = {"loop", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                     "After the last frame comes the first: t stays below 1, and players repeat the file without end."},
    [FRAMES_SHUTTER] = {"shutter", KIND_INTERVAL, OPTIONAL, ANY, "frames", "{0, 0}",
                        "When the shutter opens and closes; {0, 0.5} is half the time of a frame, 180 degrees."},
    [FRAMES_PURE] = {"pure", KIND_BOOLEAN, OPTIONAL, ANY, NULL, "false",
                     "draw depends only on its arguments, so it is called only for rendered frames."},
};

/* The arguments of one call of gr.frames. */
struct frame_plan {
    struct frame frame; /* its number is 0 */
    bool pure;
};

static bool count_frames(struct script_context *context, const struct script_value *args, struct frame_plan *plan,
                         struct error *error) {
    const struct frame_options *options = &context->sandbox.options->frames;
    const struct frame_selection *selection = &options->selection;
    double limit = script_of(context)->host->frame_limit > 0 ? script_of(context)->host->frame_limit : FRAMES_MAX;
    double rate = args[FRAMES_FPS].given ? args[FRAMES_FPS].number : FRAME_RATE_DEFAULT;
    plan->frame.rate = options->rate > 0 ? options->rate : rate;
    if (args[FRAMES_COUNT].given == args[FRAMES_SECONDS].given)
        return error_set(error, ERROR_SCENE,
                         args[FRAMES_COUNT].given ? "count and seconds exclude each other"
                                                  : "count or seconds is missing");
    double count = args[FRAMES_COUNT].given ? args[FRAMES_COUNT].number
                                            : math_max(1, floor(args[FRAMES_SECONDS].number * plan->frame.rate + 0.5));
    if (count > limit)
        return error_set(error, ERROR_SCENE, "%.15g frames are more than %.15g (--picture-count allows more)", count,
                         limit);
    plan->frame.count = (uint32_t)count;
    if (selection->step > 0 && selection->last > plan->frame.count)
        return error_set(error, ERROR_SCENE, "--frames selects frame %u, but the last frame is %u", selection->last,
                         plan->frame.count);
    return true;
}

static bool gr_frames(struct script_context *context, const struct script_value *args, struct script_result *result,
                      struct error *error) {
    if (script_of(context)->animation.runs)
        return error_set(error, ERROR_SCENE, "it is called while another gr.frames draws its frames");
    if (context->sandbox.options->frames.turntable > 0)
        return error_set(error, ERROR_SCENE, "--turntable is for scripts without gr.frames");
    if (script_of(context)->host->animates)
        script_of(context)->host->animates(script_of(context)->host->context);
    struct frame_plan *plan = arena_alloc(&context->sandbox.keep, sizeof *plan);
    if (!plan)
        return error_no_memory(error, "an animation");
    *plan = (struct frame_plan){.pure = args[FRAMES_PURE].boolean};
    plan->frame.loops = args[FRAMES_LOOP].boolean || context->sandbox.options->frames.loops;
    if (!count_frames(context, args, plan, error))
        return false;
    script_of(context)->animation.shutter =
        (struct shutter){args[FRAMES_SHUTTER].vector.x, args[FRAMES_SHUTTER].vector.y};
    result->pointer = plan;
    return true;
}

static const struct script_function rows[] = {
    GR("frames", frames_parameters, RESULT_FRAMES, gr_frames,
       "Renders an animation: calls draw for each frame, and renders what it returns.", "count draw"),
};
const struct function_rows frame_functions = {rows, COUNT(rows)};

/* --- calling draw --- */

/* Keys in the registry: Lua's table gr, and math.randomseed as it was before the script. */
static const char gr_key, seed_key;

static void set_frame(lua_State *L, const struct frame *frame) {
    struct script *script = script_of(context_of(L));
    script->animation.frame = *frame;
    /* With --frames, the first run of a script is a frame only if the script does not call gr.frames. An error before
     * or after the frames of gr.frames belongs to no frame. */
    char *suffix = script->context.sandbox.error_suffix;
    suffix[0] = '\0';
    if (script->animation.runs || script->host->repeats)
        (void)snprintf(suffix, SUFFIX_SIZE, " (frame %u)", frame->number);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &gr_key);
    lua_pushinteger(L, frame->number);
    lua_setfield(L, -2, "frame");
    lua_pushnumber(L, frame_time(frame));
    lua_setfield(L, -2, "time");
    lua_pushnumber(L, frame_clock(frame));
    lua_setfield(L, -2, "clock");
    lua_pop(L, 1);
}

static void seed_frame(lua_State *L, uint32_t number) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &seed_key);
    lua_pushinteger(L, (lua_Integer)sandbox_of(L)->options->seed);
    lua_pushinteger(L, number);
    lua_call(L, 2, 0);
}

/* Restores the state outside the animation, also after an error that the script has caught. */
static int leave_frames(lua_State *L) {
    struct script_context *context = context_of(L);
    script_of(context)->animation.runs = context->draws = false;
    context->handles.made = NULL;
    context->scene.kept_nodes = 0;
    set_frame(L, &script_of(context)->host->frame);
    return 0;
}

/* Copies the fields of the table on top into a new table; without a file, the name follows that of the script. */
static void push_fields(lua_State *L) {
    struct script_context *context = context_of(L);
    int given = lua_gettop(L);
    lua_newtable(L);
    lua_pushliteral(L, "file");
    if (lua_rawget(L, given) == LUA_TNIL) {
        char name[PATH_SIZE];
        context_picture_name(context, ".####.png", name, sizeof name);
        lua_pushstring(L, name);
        lua_setfield(L, given + 1, "file");
    }
    lua_pop(L, 1);
    for (lua_pushnil(L); lua_next(L, given);) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, given + 1);
    }
}

static void draw_frame(lua_State *L, int draw, const struct frame *frame, bool renders) {
    struct script_context *context = context_of(L);
    int top = lua_gettop(L);
    if (script_of(context)->host->frame_begins)
        script_of(context)->host->frame_begins(script_of(context)->host->context);
    /* Each frame has the time, the random numbers and the clock of a run of its own. */
    limits_restart_time(&context->sandbox.limits);
    set_frame(L, frame);
    seed_frame(L, frame->number);
    lua_pushvalue(L, draw);
    lua_pushnumber(L, frame_clock(frame));
    lua_pushinteger(L, frame->number);
    context->draws = true;
    lua_call(L, 2, 1);
    context->draws = false;
    /* Errors from here on are those of gr.frames. */
    context->sandbox.lua = L;
    context->sandbox.running = (struct running_function){.owner = "gr.", .name = "frames"};
    if (!lua_istable(L, -1))
        sandbox_raise(&context->sandbox, "draw returned %s, not the table of fields for gr.render", value_words(L, -1));
    if (renders) {
        push_fields(L);
        dispatch_push(L, function_find(OWNER_GR, "render"));
        lua_insert(L, -2);
        lua_call(L, 1, 0);
    }
    lua_settop(L, top);
}

/* --- the memory of frames --- */

/* Nodes, materials and other objects are in one arena of the script. After a frame, the arena is reset to its state
 * before the frame if Lua holds no newer handle (found by a weak table of them after a garbage collection), and if no
 * older object refers to the new ones. This is tried only when the arena has grown by half, so that garbage collections
 * cost little. */

static const char handles_key; /* of the weak table, in the registry */

enum { GROWTH_MIN = 1 << 20 };

static void list_handle(lua_State *L, uint32_t serial) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &handles_key);
    lua_pushvalue(L, -2);
    lua_rawseti(L, -2, (lua_Integer)serial + 1);
    lua_pop(L, 1);
}

static struct scene_snapshot begin_list(lua_State *L) {
    struct script_context *context = context_of(L);
    lua_newtable(L);
    lua_newtable(L);
    lua_pushliteral(L, "v");
    lua_setfield(L, -2, "__mode");
    lua_setmetatable(L, -2);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &handles_key);
    context->handles.made = list_handle;
    return scene_snapshot(&context->scene);
}

static bool holds_handles(lua_State *L) {
    (void)lua_gc(L, LUA_GCCOLLECT);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &handles_key);
    lua_pushnil(L);
    bool holds = lua_next(L, -2) != 0;
    lua_pop(L, holds ? 3 : 1);
    return holds;
}

/* Between two frames. */
static void free_frames(lua_State *L, struct scene_snapshot *snapshot) {
    struct script_context *context = context_of(L);
    struct scene *scene = &context->scene;
    size_t grown = scene->arena.total - snapshot->arena.total;
    if (grown < GROWTH_MIN || grown < snapshot->arena.total / 2)
        return;
    bool edited = script_of(context)->changes.count > 0 || scene->added || scene->own;
    if (!scene->escaped && !edited && !context->lenient && !context->noted && !holds_handles(L))
        scene_rewind(scene, snapshot);
    context->sandbox.running.subject = NULL; /* it may be the name of a node that is freed */
    context->line_source = NULL;
    *snapshot = begin_list(L);
}

/* --- all frames --- */

static void draw_selected(lua_State *L, int draw, const struct frame_plan *plan) {
    const struct frame_selection *selection = &sandbox_of(L)->options->frames.selection;
    struct frame frame = plan->frame;
    uint32_t last = selection->step > 0 ? selection->last : frame.count;
    struct scene_snapshot snapshot = begin_list(L);
    for (frame.number = 1; frame.number <= last; frame.number++) {
        bool renders = frame_is_selected(selection, frame.number);
        if (!plan->pure || renders)
            draw_frame(L, draw, &frame, renders);
        free_frames(L, &snapshot);
    }
}

/* Draws frames in the order that a window requests. The request may change while earlier frames are drawn. */
static void draw_wanted(lua_State *L, int draw, const struct frame_plan *plan) {
    struct script_context *context = context_of(L);
    const struct script_host *host = script_of(context)->host;
    struct frame frame = plan->frame;
    for (uint32_t wanted; (wanted = host->next_frame(host->context, &frame)) > 0;) {
        if (!plan->pure && wanted <= frame.number) {
            host->rewinds(host->context);
            context->sandbox.ended = true;
            sandbox_raise_fatal(L);
        }
        frame.number = plan->pure ? wanted : frame.number + 1;
        draw_frame(L, draw, &frame, frame.number == wanted);
    }
}

int frames_run(lua_State *L, const struct script_result *result) {
    struct script_context *context = context_of(L);
    const struct frame_plan *plan = result->pointer;
    if (lua_istable(L, 1)) {
        lua_pushliteral(L, "draw");
        (void)lua_rawget(L, 1);
    } else {
        lua_pushvalue(L, 2);
    }
    int draw = lua_gettop(L);
    script_of(context)->animation.runs = true;
    lua_newtable(L);
    lua_newtable(L);
    lua_pushcfunction(L, leave_frames);
    lua_setfield(L, -2, "__close");
    lua_setmetatable(L, -2);
    lua_toclose(L, -1);
    if (script_of(context)->host->next_frame)
        draw_wanted(L, draw, plan);
    else
        draw_selected(L, draw, plan);
    return 0;
}

void frames_open(lua_State *L) {
    lua_getglobal(L, "gr");
    lua_rawsetp(L, LUA_REGISTRYINDEX, &gr_key);
    lua_getglobal(L, "math");
    lua_getfield(L, -1, "randomseed");
    lua_rawsetp(L, LUA_REGISTRYINDEX, &seed_key);
    lua_pop(L, 1);
    const struct frame *frame = &script_of(context_of(L))->host->frame;
    set_frame(L, frame);
    if (frame->number > 0)
        seed_frame(L, frame->number);
}
