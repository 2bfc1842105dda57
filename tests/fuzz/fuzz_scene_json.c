/* Any bytes as a scene in JSON, in a Lua state that is used for many, so that thousands are read in a second. In every
 * other state what is a scene is written, and its text is read and written again, with the same bytes. The mutator
 * exchanges values and names, so that most inputs are JSON. */
#include "script/dispatch_internal.h"
#include "script/scene_json_internal.h"
#include "script/script_internal.h"
#include "script/table_internal.h"
#include "tests/fuzz/folder.h"

#include <lauxlib.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size) __attribute__((weak)); /* of libFuzzer */

enum { INPUTS = 500, TICKS = 4 };

/* What one state needs. text: the last scene that was written. */
struct stage {
    struct script script;
    struct script_host host;
    struct assets assets;
    struct arena arena;
    struct path_policy path_policy;
    lua_State *L;
    char *text, error[1024];
    size_t size;
    int inputs;
};

static char path[300];
static volatile sig_atomic_t ticks;

static const struct script_options options = {
    .transform_order = SCRIPT_ORDER_NEW, .memory_limit = 64 << 20, .output_limit = 1 << 20};

static void tick(int number) {
    (void)number;
    ticks = ticks + 1;
}

static bool is_stopped(void *context) {
    (void)context;
    return ticks > TICKS;
}

static void hear(void *context, enum script_message kind, const char *text) {
    (void)context;
    (void)kind;
    if (text[0] == '\0' || strchr(text, '\n'))
        abort();
}

static bool render(void *context, const struct render_request *request, struct error *error) {
    (void)context;
    (void)error;
    if (!request->root)
        abort();
    return true;
}

static bool keep(void *context, const struct render_request *request, const char *text, size_t size,
                 struct error *error) {
    struct stage *stage = context;
    free(stage->text);
    stage->text = malloc(size);
    stage->size = size;
    if (!stage->text)
        abort();
    memcpy(stage->text, text, size);
    return render(context, request, error);
}

static int open_state(lua_State *L) {
    script_open(L);
    return 0;
}

static int read_scene(lua_State *L) {
    scene_json_run(L);
    return 0;
}

static void begin(struct stage *stage, bool writes) {
    struct error error = {0};
    struct sandbox *sandbox = &stage->script.context.sandbox;
    *stage = (struct stage){.host = {.context = stage,
                                     .assets = &stage->assets,
                                     .settings = settings_default(),
                                     .render = render,
                                     .write_scene = writes ? keep : NULL,
                                     .message = hear,
                                     .cancelled = is_stopped}};
    stage->script = (struct script){.host = &stage->host, .out = &stage->arena, .is_json = true};
    *sandbox = (struct sandbox){.options = &options,
                                .host = {.context = stage, .message = hear, .cancelled = is_stopped},
                                .path_policy = &stage->path_policy,
                                .files = {.path = path}};
    scene_init(&stage->script.context.scene, &stage->assets);
    if (!sandbox_begin(sandbox, &error) || !script_path_policy(path, &options, &stage->path_policy, &error))
        abort();
    stage->L = lua_newstate(limits_allocate, &sandbox->limits);
    if (!stage->L)
        abort();
    *(struct sandbox **)lua_getextraspace(stage->L) = sandbox;
    sandbox->lua = stage->L;
    lua_pushcfunction(stage->L, open_state);
    if (lua_pcall(stage->L, 0, 0, 0) != LUA_OK)
        abort();
}

static void end(struct stage *stage) {
    struct sandbox *sandbox = &stage->script.context.sandbox;
    sandbox->lua = NULL;
    lua_close(stage->L);
    path_policy_destroy(&stage->path_policy);
    scene_destroy(&stage->script.context.scene);
    (void)sandbox_end(sandbox);
    assets_destroy(&stage->assets);
    arena_destroy(&stage->arena);
    free(stage->text);
    stage->L = NULL;
}

/* Whether it is a scene. Otherwise the error is one line that begins with the name of the file. */
static bool run(struct stage *stage, const void *data, size_t size) {
    struct script_context *context = &stage->script.context;
    struct sandbox *sandbox = &context->sandbox;
    fuzz_write("scene.json", data, size);
    ticks = 0;
    stage->script.reader = NULL;
    stage->script.time = 0;
    stage->script.pictures = stage->script.unnamed = 0;
    context->scene.order = TRANSFORM_ORDER_NEW;
    context->function = NULL;
    sandbox->locate = NULL;
    sandbox->running = (struct running_function){0};
    sandbox->raised[0] = sandbox->refused[0] = '\0';
    limits_restart_time(&sandbox->limits);
    lua_pushcfunction(stage->L, read_scene);
    bool ok = lua_pcall(stage->L, 0, 0, 0) == LUA_OK;
    const char *text = sandbox->fatal.kind != ERROR_NONE ? sandbox->fatal.text : lua_tostring(stage->L, -1);
    if (!ok && !sandbox->limits.memory_out && (!text || strchr(text, '\n') || strncmp(text, path, strlen(path)) != 0))
        abort();
    (void)snprintf(stage->error, sizeof stage->error, "%s", ok || !text ? "" : text);
    sandbox->fatal = (struct error){0};
    lua_settop(stage->L, 0);
    return ok;
}

static bool is_over(const struct stage *stage) {
    const struct sandbox *sandbox = &stage->script.context.sandbox;
    return sandbox->limits.memory_out || stage->inputs >= INPUTS || sandbox->limits.account.held > 40 << 20;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static struct stage the_stage;
    static unsigned states;
    struct stage *stage = &the_stage;
    if (!path[0]) {
        struct itimerval timer = {.it_value = {0, 50000}, .it_interval = {0, 50000}};
        (void)snprintf(path, sizeof path, "%s/scene.json", fuzz_folder());
        (void)signal(SIGVTALRM, tick);
        (void)setitimer(ITIMER_VIRTUAL, &timer, NULL);
    }
    if (!stage->L)
        begin(stage, states++ % 2 == 0);
    stage->inputs++;
    if (run(stage, data, size) && stage->host.write_scene) {
        char *text = stage->text;
        size_t length = stage->size;
        stage->text = NULL;
        bool again = run(stage, text, length);
        bool same = again && stage->size == length && memcmp(text, stage->text, length) == 0;
        if (!same && !stage->script.context.sandbox.limits.memory_out && ticks <= TICKS) {
            (void)fprintf(stderr, "%.*s\n%s\n%.*s\n", (int)length, text, stage->error, again ? (int)stage->size : 0,
                          stage->text);
            abort();
        }
        free(text);
    }
    if (is_over(stage))
        end(stage);
    return 0;
}

/* --- mutations --- */

/* The end of the string, list, object or word that begins there. */
static size_t token_end(const char *text, size_t at, size_t size) {
    size_t end = at;
    int depth = 0;
    do {
        char c = text[end];
        if (c == '"')
            for (end++; end < size && text[end] != '"'; end++)
                end += text[end] == '\\';
        else if (!strchr("{[}],: \n", c))
            while (end + 1 < size && !strchr("{[}],: \n\"", text[end + 1]))
                end++;
        depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
        end++;
    } while (end < size && depth > 0);
    return end < size ? end : size;
}

/* A function or a field of gr, or another value. */
static void choose_word(unsigned *seed, char *out, size_t size) {
    static const char *const values[] = {"0",
                                         "-1",
                                         "1e300",
                                         "0.5",
                                         "-0.0",
                                         "9007199254740993",
                                         "1e-320",
                                         "[]",
                                         "{}",
                                         "null",
                                         "true",
                                         "[1, 2, 3]",
                                         "{\"ref\": \"a\"}",
                                         "\"x\"",
                                         "[[]]",
                                         "\"\\u00e9\"",
                                         "{\"type\": \"program\", \"code\": \"v0 = p.x; result v0\"}"};
    const struct script_function *function = function_at(rand_r(seed) % function_count());
    int choice = rand_r(seed) % 3;
    if (choice == 0)
        (void)snprintf(out, size, "%s", values[(size_t)rand_r(seed) % (sizeof values / sizeof *values)]);
    else if (choice == 1 && function->parameter_count > 0)
        (void)snprintf(out, size, "\"%s\"", function->parameters[rand_r(seed) % function->parameter_count].name);
    else
        (void)snprintf(out, size, "\"%s\"", function->name);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed) {
    enum { TOKENS = 1024, CHOICES = 6 };
    size_t starts[TOKENS], count = 0;
    char word[128], *text = (char *)data, *out = malloc(3 * size + sizeof word);
    if (out)
        for (size_t i = 0; i < size && count < TOKENS; i++) {
            if (strchr("}],: \n", text[i]))
                continue;
            starts[count++] = i;
            if (text[i] != '{' && text[i] != '[')
                i = token_end(text, i, size) - 1;
        }
    int choice = rand_r(&seed) % CHOICES;
    if (count == 0 || choice == 0) {
        free(out);
        return LLVMFuzzerMutate(data, size, max_size);
    }
    size_t at = starts[(size_t)rand_r(&seed) % count], end = token_end(text, at, size), length = at;
    size_t other = starts[(size_t)rand_r(&seed) % count], other_size = token_end(text, other, size) - other;
    choose_word(&seed, word, sizeof word);
    memcpy(out, text, at);
    if (choice <= 2) {
        memcpy(out + length, word, strlen(word));
        length += strlen(word);
    } else if (choice <= 4) { /* another part of the text, in its place or in front of it */
        memcpy(out + length, text + other, other_size);
        length += other_size;
        if (choice == 4) {
            out[length++] = ',';
            end = at;
        }
    } else if (end < size && text[end] == ',') {
        end++;
    }
    memcpy(out + length, text + end, size - end);
    length += size - end;
    length = length < max_size ? length : max_size;
    memcpy(data, out, length);
    free(out);
    return length;
}
