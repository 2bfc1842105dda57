/* The limits of a script: memory, processor time, output. From limits_begin to limits_end an account of base/mem.h
 * counts every block of the process, as malloc rounds it: the Lua state, the scene, and readers of files and makers of
 * meshes. A hook reads the clock every few thousand steps. Lua's own C functions run without the hook, so the
 * supervisor watches the same clock from outside (host/supervisor.c): the hook gives a good message with a line number,
 * the supervisor ends the script in any case.
 *
 * An exceeded limit is a fatal error of the sandbox, which no script can catch. After it the hook raises it again at
 * every step, so that handlers of to-be-closed variables end too. */
#include "sandbox/limits.h"

#include "base/clock.h"
#include "sandbox/sandbox.h"

#include <lauxlib.h>
#include <stdio.h>

enum { HOOK_STEPS = 10000 }; /* some tenths of a millisecond */

void limits_begin(struct limits *limits, const struct script_options *options) {
    *limits = (struct limits){
        .account = {.limit = script_memory_limit(options), .option = "--script-memory", .words = limits->memory_words},
        .output_limit = script_output_limit(options),
        .time_limit = script_time_limit(options),
        .time_begun = clock_seconds(CLOCK_THREAD_CPUTIME_ID),
    };
    char size[SIZE_WORDS];
    (void)snprintf(limits->memory_words, sizeof limits->memory_words,
                   "the script used up its memory of %s (--script-memory allows more)",
                   size_words(limits->account.limit, size));
    limits->charged_before = mem_charge(limits->account.limit > 0 ? &limits->account : NULL);
}

uint64_t limits_end(struct limits *limits) {
    int64_t left = limits->account.held;
    (void)mem_charge(limits->charged_before);
    return left > 0 ? (uint64_t)left : 0;
}

/* A refused request is final, unless Lua repeats it after a garbage collection and it succeeds: the repetition follows
 * at once, so a later reader of `memory_out` sees the final state. Later requests, by the error handler, change
 * nothing, even if they have the same size. */
void *limits_allocate(void *user, void *block, size_t old_size, size_t size) {
    struct limits *limits = user;
    bool grows = !block || size > old_size;
    if (size == 0)
        return mem_resize_known(block, old_size, 0);
    uint64_t refusals = mem_refusals();
    void *moved = mem_resize_known(block, old_size, size);
    if (!moved && mem_refusals() != refusals) {
        limits->refused_for_good = limits->memory_out;
        limits->memory_out = true;
        limits->refused_size = size;
        limits->refused_block = block;
    }
    if (!moved)
        return NULL;
    bool again = limits->refused_size == size && limits->refused_block == block;
    if (limits->memory_out && grows && !limits->refused_for_good) {
        limits->memory_out = !again;
        limits->refused_for_good = !again;
    }
    return moved;
}

_Noreturn static void end_script(lua_State *L, enum error_kind kind, const char *what) {
    struct sandbox *sandbox = sandbox_of(L);
    char where[PATH_SIZE + 32];
    sandbox->lua = L;
    sandbox_where(sandbox, where, sizeof where);
    error_set(&sandbox->fatal, kind, "%s%s%s", where, what, sandbox->error_suffix);
    sandbox_raise_fatal(L);
}

void limits_end_for_memory(lua_State *L) {
    end_script(L, ERROR_SCENE, sandbox_of(L)->limits.memory_words);
}

void limits_check(lua_State *L) {
    struct sandbox *sandbox = sandbox_of(L);
    struct limits *limits = &sandbox->limits;
    if (sandbox->ended || sandbox->fatal.kind != ERROR_NONE)
        sandbox_raise_fatal(L);
    if (sandbox->host.cancelled && sandbox->host.cancelled(sandbox->host.context))
        end_script(L, ERROR_CANCELLED, "cancelled");
    if (limits->memory_out)
        limits_end_for_memory(L);
    if (limits->output_limit > 0 && limits->output > limits->output_limit)
        limits_output(L, 0);
    if (limits->time_limit > 0 && clock_seconds(CLOCK_THREAD_CPUTIME_ID) - limits->time_begun > limits->time_limit) {
        char what[128];
        snprintf(what, sizeof what, "the script used up its %g s of processor time (--script-time allows more)",
                 limits->time_limit);
        end_script(L, ERROR_SCENE, what);
    }
}

static void hook(lua_State *L, lua_Debug *frame) {
    (void)frame;
    const struct sandbox *sandbox = sandbox_of(L);
    if (sandbox->ended || sandbox->fatal.kind != ERROR_NONE)
        lua_sethook(L, hook, LUA_MASKCOUNT, 1);
    limits_check(L);
}

void limits_open(lua_State *L) {
    lua_sethook(L, hook, LUA_MASKCOUNT, HOOK_STEPS);
}

void limits_count_output(struct limits *limits, size_t size) {
    limits->output += size;
}

void limits_output(lua_State *L, size_t size) {
    const struct sandbox_host *host = &sandbox_of(L)->host;
    struct limits *limits = &sandbox_of(L)->limits;
    if (host->prints)
        host->prints(host->context);
    limits->output += size;
    if (limits->output_limit == 0 || limits->output <= limits->output_limit)
        return;
    char what[128], words[SIZE_WORDS];
    snprintf(what, sizeof what, "the script printed more than its %s (--script-output allows more)",
             size_words(limits->output_limit, words));
    end_script(L, ERROR_SCENE, what);
}

void limits_pause(struct limits *limits) {
    limits->time_begun -= clock_seconds(CLOCK_THREAD_CPUTIME_ID);
}

void limits_restart_time(struct limits *limits) {
    limits->time_begun = clock_seconds(CLOCK_THREAD_CPUTIME_ID);
}

void limits_resume(struct limits *limits) {
    limits->time_begun += clock_seconds(CLOCK_THREAD_CPUTIME_ID);
}
