/* What a script may use up: memory, processor time, output. The allocator counts every byte of the Lua state as malloc
 * rounds it; a hook looks at the clock every few thousand steps. Lua's own C functions run without the hook, so the
 * supervisor watches the same clock from outside (app/supervisor.c): here the good message with its line, there the
 * certain end.
 *
 * A used-up limit is a fatal error of the context, which no script can catch. Once there is one the hook raises it
 * again at every step: handlers of to-be-closed variables get no further. */
#include "script/context.h"

#include "base/mem.h"

#include <lauxlib.h>
#include <stdio.h>
#include <time.h>

enum {
    HOOK_STEPS = 10000, /* some tenths of a millisecond */
    STANDARD_MEMORY = 4096,
    STANDARD_TIME = 60,
    STANDARD_OUTPUT = 64,
    MEBIBYTE = 1 << 20,
};

static double processor_time(void) {
    struct timespec now;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double script_time_limit(const struct script_options *options) {
    return options->time_limit > 0 || options->no_sandbox ? options->time_limit : STANDARD_TIME;
}

/* 0: no limit. */
static uint64_t mebibytes(int given, int standard, bool unlimited) {
    int chosen = given > 0 ? given : unlimited ? 0 : standard;
    return (uint64_t)chosen * MEBIBYTE;
}

void limits_begin(struct context *context) {
    const struct script_options *options = context->options;
    context->limits = (struct limits){
        .memory_limit = mebibytes(options->memory_limit, STANDARD_MEMORY, options->no_sandbox),
        .output_limit = mebibytes(options->output_limit, STANDARD_OUTPUT, options->no_sandbox),
        .time_limit = script_time_limit(options),
        .time_begun = processor_time(),
        .known_meshes = context->scene.assets->mesh_count,
        .known_images = context->scene.assets->image_count,
    };
}

/* What malloc takes for a block: its header, multiples of 16, 32 at least (glibc's layout). */
static uint64_t cost(size_t size) {
    uint64_t whole = ((uint64_t)size + 8 + 15) & ~UINT64_C(15);
    return size == 0 ? 0 : whole < 32 ? 32 : whole;
}

/* What is refused is refused for good, unless Lua asks for the same again after it has collected its garbage and gets
 * it: that comes at once, so whoever looks at `memory_out` later sees what became of it. What is asked for later, by
 * whoever handles the error, changes nothing, even if it is of the same size. */
void *limits_allocate(void *user, void *block, size_t old_size, size_t size) {
    struct limits *limits = &((struct context *)user)->limits;
    uint64_t before = block ? cost(old_size) : 0, after = cost(size);
    if (size == 0) {
        mem_free(block);
        limits->memory -= before;
        return NULL;
    }
    if (limits->memory_limit > 0 && after > before && limits->memory - before + after > limits->memory_limit) {
        limits->refused_for_good = limits->memory_out;
        limits->memory_out = true;
        limits->refused_size = size;
        limits->refused_block = block;
        return NULL;
    }
    void *moved = mem_resize(block, size);
    if (!moved)
        return NULL;
    limits->memory = limits->memory - before + after;
    bool again = limits->refused_size == size && limits->refused_block == block;
    if (limits->memory_out && after > before && !limits->refused_for_good) {
        limits->memory_out = !again;
        limits->refused_for_good = !again;
    }
    return moved;
}

static uint64_t scene_memory(struct context *context) {
    struct limits *limits = &context->limits;
    const struct assets *assets = context->scene.assets;
    const struct asset_mesh *mesh = assets->meshes;
    for (; mesh && limits->known_meshes < assets->mesh_count; mesh = mesh->next, limits->known_meshes++)
        limits->asset_memory += mesh_memory(mesh->mesh);
    const struct asset_image *image = assets->images;
    for (; image && limits->known_images < assets->image_count; image = image->next, limits->known_images++)
        limits->asset_memory += image_memory(image->image);
    return limits->asset_memory + context->scene.arena.total + context->keep.total + context->call.total;
}

_Noreturn static void end_script(lua_State *L, enum error_kind kind, const char *what) {
    struct context *context = context_of(L);
    char where[PATH_SIZE + 32];
    context->lua = L;
    context_where(context, where, sizeof where);
    error_set(&context->fatal, kind, "%s%s", where, what);
    context_raise_fatal(L);
}

static void end_for_memory(lua_State *L) {
    char what[128];
    snprintf(what, sizeof what, "the script used up its memory of %llu MiB (--script-memory allows more)",
             (unsigned long long)(context_of(L)->limits.memory_limit / MEBIBYTE));
    end_script(L, ERROR_SCENE, what);
}

void limits_check_memory(lua_State *L) {
    struct context *context = context_of(L);
    const struct limits *limits = &context->limits;
    if (limits->memory_limit > 0 && limits->memory + scene_memory(context) > limits->memory_limit)
        end_for_memory(L);
}

void limits_check(lua_State *L) {
    struct context *context = context_of(L);
    struct limits *limits = &context->limits;
    if (context->ended || context->fatal.kind != ERROR_NONE)
        context_raise_fatal(L);
    if (context->host->cancelled && context->host->cancelled(context->host->context))
        end_script(L, ERROR_CANCELLED, "cancelled");
    if (limits->memory_out)
        end_for_memory(L);
    limits_check_memory(L);
    if (limits->output_limit > 0 && limits->output > limits->output_limit)
        limits_output(L, 0);
    if (limits->time_limit > 0 && processor_time() - limits->time_begun > limits->time_limit) {
        char what[128];
        snprintf(what, sizeof what, "the script used up its %g s of processor time (--script-time allows more)",
                 limits->time_limit);
        end_script(L, ERROR_SCENE, what);
    }
}

static void hook(lua_State *L, lua_Debug *place) {
    (void)place;
    const struct context *context = context_of(L);
    if (context->ended || context->fatal.kind != ERROR_NONE)
        lua_sethook(L, hook, LUA_MASKCOUNT, 1);
    limits_check(L);
}

void limits_open(lua_State *L) {
    lua_sethook(L, hook, LUA_MASKCOUNT, HOOK_STEPS);
}

void limits_count_output(struct context *context, size_t size) {
    context->limits.output += size;
}

void limits_output(lua_State *L, size_t size) {
    struct limits *limits = &context_of(L)->limits;
    limits->output += size;
    if (limits->output_limit == 0 || limits->output <= limits->output_limit)
        return;
    char what[128];
    snprintf(what, sizeof what, "the script printed more than its %llu MiB (--script-output allows more)",
             (unsigned long long)(limits->output_limit / MEBIBYTE));
    end_script(L, ERROR_SCENE, what);
}

void limits_pause(struct context *context) {
    context->limits.time_begun -= processor_time();
}

void limits_resume(struct context *context) {
    context->limits.time_begun += processor_time();
}
