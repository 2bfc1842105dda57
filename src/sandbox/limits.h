/* The limits of a script: memory, processor time, output. */
#ifndef GRAY_SANDBOX_LIMITS_H
#define GRAY_SANDBOX_LIMITS_H

#include "base/mem.h"
#include "settings/script_options.h"

#include <lua.h>

struct sandbox;

/* How much of its limits the script has used. */
struct limits {
    struct mem_account account; /* of everything allocated for the script; a limit of 0 means no limit */
    struct mem_account *charged_before;
    char memory_words[128];
    const void *refused_block; /* the last request that was refused: Lua repeats it after a garbage collection */
    size_t refused_size;
    bool memory_out;               /* a request was refused: the script ends, unless its repetition succeeds at once */
    bool refused_for_good;         /* the repetition, or another request, failed too */
    double time_begun, time_limit; /* seconds of this thread's processor time; a limit of 0 means no limit */
    uint64_t output, output_limit; /* bytes printed and written */
};

void limits_begin(struct limits *limits, const struct script_options *options);
/* Returns the bytes that are still allocated. */
uint64_t limits_end(struct limits *limits);
void *limits_allocate(void *limits, void *block, size_t old_size, size_t size); /* a lua_Alloc */
void limits_open(lua_State *L);                                                 /* sets the hook */
void limits_check(lua_State *L); /* raises when time or memory is used up or a stop is requested */
_Noreturn void limits_end_for_memory(lua_State *L);
void limits_output(lua_State *L, size_t size); /* to be called before this many bytes are written; may raise */
void limits_count_output(struct limits *limits, size_t size); /* the same without raising; the next check raises */
/* Pause and resume the limits during work that is not the script's. */
void limits_pause(struct limits *limits);
void limits_resume(struct limits *limits);
/* The time limit starts here. */
void limits_restart_time(struct limits *limits);

#endif
